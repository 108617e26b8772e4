//! The power series of up to four recorded functions side by side, order by order.
//!
//! Compiled once for all functions: see `recorded.rs`. A row holds the coefficients of four
//! functions, one in each lane of a vector register, so that sums of products need no shuffling.

use super::fused::mul_add_in;
use super::products::by_order;
use super::recorded::{ARGUMENT, INPUTS, Operation, Output, Recorder, Sum, Weight};
use super::{INVERSE, LONGEST};

/// Number of functions side by side.
pub(crate) const LANES: usize = 4;

/// A number of each function.
pub(crate) type Lanes = [f64; LANES];

/// The coefficients of one operation; of order 0 none.
pub(crate) type Row = [Lanes; LONGEST];

/// Functions with the same operations.
#[derive(Debug, Clone)]
pub(crate) struct Chunk {
    /// Each with its f, α, β and slope.
    operations: Vec<(Operation, [Lanes; 4])>,
    /// The rows of 0, the argument, the further inputs, and the operations.
    rows: Vec<Row>,
    /// Each row's newest coefficient without slope·s_k.
    rests: Vec<Lanes>,
    /// Row and factor of the result; the factor is 0 in a lane that is not in use.
    output: (u16, Lanes),
    /// Number of the inputs beside the argument.
    inputs: usize,
    /// Row and factor of the rate of each input that has one.
    rates: Vec<(u16, Lanes)>,
}

impl Chunk {
    pub(crate) fn new() -> Self {
        Self {
            operations: Vec::new(),
            rows: Vec::new(),
            rests: Vec::new(),
            output: (0, [0.0; LANES]),
            inputs: 0,
            rates: Vec::new(),
        }
    }

    /// Takes the function that was recorded into a lane, after all others are removed.
    pub(crate) fn begin(&mut self, lane: usize, recorder: &mut Recorder, output: Output) {
        self.inputs = recorder.inputs();
        let rates = recorder.rates().iter();
        self.rates.clear();
        self.rates
            .extend(rates.map(|rate| (rate.row, [0.0; LANES])));
        let notes = recorder.notes();
        self.operations.clear();
        let operations = notes.iter().map(|note| note.operation);
        self.operations
            .extend(operations.map(|operation| (operation, [[0.0; LANES]; 4])));
        let rows = self.first() + notes.len();
        if self.rows.len() < rows {
            self.rows.resize(rows, [[0.0; LANES]; LONGEST]);
            self.rests.resize(rows, [0.0; LANES]);
        }
        self.inputs_mut().fill([[0.0; LANES]; LONGEST]);
        self.output = (output.row, [0.0; LANES]);
        self.put(lane, recorder, output);
    }

    /// Takes a recorded law into a lane beside others, if it has their operations; returns false
    /// otherwise.
    pub(crate) fn take(&mut self, lane: usize, recorder: &mut Recorder, output: Output) -> bool {
        let rates = recorder.rates().iter().map(|rate| rate.row);
        let has_rates = rates.eq(self.rates.iter().map(|&(row, _)| row));
        let inputs = recorder.inputs();
        let notes = recorder.notes();
        let is_same = self.output.0 == output.row
            && self.inputs == inputs
            && has_rates
            && self.operations.len() == notes.len()
            && std::iter::zip(&self.operations, notes).all(|(own, note)| own.0 == note.operation);
        if is_same {
            self.put(lane, recorder, output);
        }
        is_same
    }

    fn put(&mut self, lane: usize, recorder: &mut Recorder, output: Output) {
        for ((_, own), note) in std::iter::zip(&mut self.operations, recorder.notes()) {
            let [f, alpha, beta] = note.factors;
            for (own, factor) in std::iter::zip(own, [f, alpha, beta, note.slope]) {
                own[lane] = factor;
            }
        }
        for ((_, scale), rate) in std::iter::zip(&mut self.rates, recorder.rates()) {
            scale[lane] = rate.scale;
        }
        self.output.1[lane] = output.scale;
    }

    /// Number of the inputs that have rates.
    pub(crate) fn rates(&self) -> usize {
        self.rates.len()
    }

    /// The coefficients of an input.
    pub(crate) fn input(&self, number: usize) -> &Row {
        &self.rows[usize::from(INPUTS) + number]
    }

    pub(crate) fn inputs_mut(&mut self) -> &mut [Row] {
        &mut self.rows[usize::from(INPUTS)..][..self.inputs]
    }

    /// Coefficient k of the rate of an input.
    pub(crate) fn rate(&self, number: usize, k: usize) -> Lanes {
        let (row, scale) = self.rates[number];
        times(scale, self.rows[usize::from(row)][k])
    }

    /// The row of the first operation.
    #[inline(always)]
    fn first(&self) -> usize {
        usize::from(INPUTS) + self.inputs
    }

    /// Coefficient k > 0 of the functions from that of their arguments and inputs, added to
    /// `others`. Orders 1 to k − 1 come before. `CHOSEN`: see [`mul_add_in`]. `HAS_INPUTS`: false
    /// for functions of the argument alone; their code is faster.
    ///
    /// Sums have an order that the compiler knows: at run time they would cost twice as much.
    #[inline(always)]
    pub(crate) fn order<const CHOSEN: bool, const HAS_INPUTS: bool>(
        &mut self,
        k: usize,
        arguments: Lanes,
        others: Lanes,
    ) -> Lanes {
        let inputs = if HAS_INPUTS { self.inputs } else { 0 };
        let first = usize::from(INPUTS) + inputs;
        let (rows, rests) = (&mut self.rows[..], &mut self.rests[..]);
        rows[usize::from(ARGUMENT)][k] = arguments;
        for input in usize::from(INPUTS)..first {
            rests[input] = rows[input][k];
        }
        for (row, (operation, [f, alpha, beta, slope])) in (first..).zip(&self.operations) {
            let [a, b] = operation.rows.map(usize::from);
            let rest = match operation.sum {
                Sum::Weight => {
                    // Only the sums of later orders read it, so it needs no rest.
                    rows[row][k] = times([k as f64; LANES], times(*alpha, rows[a][k]));
                    continue;
                }
                Sum::Nothing => mul_add::<CHOSEN>(*alpha, rests[a], times(*beta, rests[b])),
                Sum::Square(x) => {
                    let sum = by_order!([0.0; LANES], square::<CHOSEN>, k, &rows[usize::from(x)]);
                    mul_add::<CHOSEN>(*f, sum, times(*alpha, rests[a]))
                }
                Sum::Product(x, y, weight) => {
                    let pair = (&rows[usize::from(x)], &rows[usize::from(y)]);
                    let sum = by_order!([0.0; LANES], product::<CHOSEN>, k, pair);
                    let weight = match weight {
                        Weight::One => 1.0,
                        Weight::Integral => INVERSE[k],
                    };
                    let linear = mul_add::<CHOSEN>(*alpha, rests[a], times(*beta, rests[b]));
                    // The factors first: the sum is ready last.
                    mul_add::<CHOSEN>(times([weight; LANES], *f), sum, linear)
                }
            };
            rests[row] = rest;
            rows[row][k] = mul_add::<CHOSEN>(*slope, arguments, rest);
        }
        let (row, scale) = self.output;
        mul_add::<CHOSEN>(scale, rows[usize::from(row)][k], others)
    }
}

// Written out, not with closures or loops: those are not always compiled to one instruction.

/// a·b.
#[inline(always)]
pub(crate) fn times(a: Lanes, b: Lanes) -> Lanes {
    [a[0] * b[0], a[1] * b[1], a[2] * b[2], a[3] * b[3]]
}

/// a + b.
#[inline(always)]
pub(crate) fn plus(a: Lanes, b: Lanes) -> Lanes {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3]]
}

/// a·b + c.
#[inline(always)]
pub(crate) fn mul_add<const CHOSEN: bool>(a: Lanes, b: Lanes, c: Lanes) -> Lanes {
    [
        mul_add_in::<CHOSEN>(a[0], b[0], c[0]),
        mul_add_in::<CHOSEN>(a[1], b[1], c[1]),
        mul_add_in::<CHOSEN>(a[2], b[2], c[2]),
        mul_add_in::<CHOSEN>(a[3], b[3], c[3]),
    ]
}

/// Σ x_i y_{k−i} for 0 < i < k.
///
/// From the middle outward, so that the newest coefficients come last.
#[inline(always)]
fn product<const CHOSEN: bool>(k: usize, (x, y): (&Row, &Row)) -> Lanes {
    let mut sums = [[0.0; LANES]; 2];
    let mut distance = k % 2;
    while distance + 1 < k {
        let (low, high) = ((k - distance) / 2, (k + distance) / 2);
        sums[0] = mul_add::<CHOSEN>(x[low], y[high], sums[0]);
        if distance > 0 {
            sums[1] = mul_add::<CHOSEN>(x[high], y[low], sums[1]);
        }
        distance += 2;
    }
    plus(sums[0], sums[1])
}

/// Σ x_i x_{k−i} for 0 < i < k.
#[inline(always)]
fn square<const CHOSEN: bool>(k: usize, x: &Row) -> Lanes {
    let mut sum = [0.0; LANES];
    let mut distance = 2 - k % 2;
    while distance + 1 < k {
        sum = mul_add::<CHOSEN>(x[(k - distance) / 2], x[(k + distance) / 2], sum);
        distance += 2;
    }
    let twice = plus(sum, sum);
    if k.is_multiple_of(2) {
        mul_add::<CHOSEN>(x[k / 2], x[k / 2], twice)
    } else {
        twice
    }
}
