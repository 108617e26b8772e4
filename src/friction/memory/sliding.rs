use nalgebra::{DMatrix, DVector};

use super::{ContactLaw, Motion, Slip, Variables};
use crate::scalar::Scalar;
use crate::scalar::jet::Tape;

/// An input of a law.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Input {
    /// The sliding speed.
    Speed,
    /// The load N.
    Load,
    /// A variable of the memory.
    Memory(usize),
}

/// Steady sliding of a contact: its coefficient with the stationary memory, and the derivatives by
/// sliding speed and memory.
#[derive(Debug, Clone)]
pub(crate) struct Sliding {
    /// The stationary memory.
    pub(crate) memory: Vec<f64>,
    /// μ, with the sign of the direction of slip.
    pub(crate) coefficient: f64,
    /// ∂μ/∂s.
    pub(crate) slope: f64,
    /// ∂μ/∂z_j.
    pub(crate) by_memory: Vec<f64>,
    /// ∂z_i'/∂s.
    pub(crate) rates_by_speed: Vec<f64>,
    /// ∂z_i'/∂N.
    pub(crate) rates_by_load: Vec<f64>,
    /// ∂z_i'/∂z_j.
    pub(crate) rates_by_memory: DMatrix<f64>,
}

/// Values of a law with a memory, and derivatives by an input.
type Slopes<'l> = dyn Fn(&[f64], Input) -> Derivatives + 'l;

/// Values and derivatives by one variable.
pub(super) struct Derivatives {
    /// The coefficient and its derivative, with the sign of the direction of slip.
    pub(super) coefficient: [f64; 2],
    pub(super) rates: Vec<[f64; 2]>,
}

impl Sliding {
    /// Finds the memory whose rates are 0, by Newton's method from 0; `None` if there is none.
    pub(crate) fn of<L: ContactLaw>(law: &L, slip: Slip<f64>, load: f64) -> Option<Self> {
        let count = L::Memory::<f64>::COUNT;
        Self::find(count, &|memory, by| {
            derivatives(law, (slip, load), memory, by)
        })
    }

    fn find(count: usize, law: &Slopes<'_>) -> Option<Self> {
        /// Bristles take one, a rate-and-state law one for each factor e between its speeds.
        const MOST_ITERATIONS: usize = 400;
        /// Halvings of a change, after which it is below rounding.
        const MOST_HALVINGS: i32 = 60;
        let mut memory = vec![0.0; count];
        let (mut here, mut rates) = Self::at(law, &memory);
        if count == 0 {
            return Some(here);
        }
        for _ in 0..MOST_ITERATIONS {
            let size = sum_of_squares(&rates);
            let change = here.memory_for(rates)?;
            // In full, or the longest part of it that makes the rates smaller.
            let parts = (0..MOST_HALVINGS).map(|halvings| 0.5_f64.powi(halvings));
            let mut tried = parts.map(|part| {
                let mut changed = memory.clone();
                for (number, change) in std::iter::zip(&mut changed, &change) {
                    *number -= part * change;
                }
                let is_settled =
                    (0..count).all(|i| here.is_rounding(i, part * change[i], changed[i]));
                (is_settled, Self::at(law, &changed))
            });
            let (is_settled, found) = tried
                .find(|(is_settled, (_, rates))| *is_settled || sum_of_squares(rates) < size)?;
            (here, rates) = found;
            if is_settled {
                return Some(here);
            }
            memory.clone_from(&here.memory);
        }
        None
    }

    /// The change of the memory that changes its rates by these. Variables that never change in
    /// slip, such as the clock of `Dwell`, stay as they are.
    fn memory_for(&self, rates: Vec<f64>) -> Option<DVector<f64>> {
        let count = rates.len();
        if count == 0 {
            return Some(DVector::zeros(0));
        }
        let matrix = DMatrix::from_fn(count, count, |i, j| {
            let alone = if i == j { 1.0 } else { 0.0 };
            if self.changes(i) {
                self.rates_by_memory[(i, j)]
            } else {
                alone
            }
        });
        matrix.lu().solve(&DVector::from_vec(rates))
    }

    /// The derivative of the coefficient by the load, while the memory stays stationary.
    pub(crate) fn by_load(&self) -> Option<f64> {
        let change = self.memory_for(self.rates_by_load.clone())?;
        let parts = std::iter::zip(&self.by_memory, &change);
        Some(-parts.map(|(slope, change)| slope * change).sum::<f64>())
    }

    /// Returns true if a change of memory variable i to a number is rounding, of the number itself
    /// or of the coefficient.
    fn is_rounding(&self, i: usize, change: f64, number: f64) -> bool {
        let effect = (self.by_memory[i] * change).abs();
        change.abs() <= 4.0 * f64::EPSILON * number.abs()
            || effect > 0.0 && effect <= f64::EPSILON * self.coefficient.abs()
    }

    /// Returns true if slip changes memory variable i.
    fn changes(&self, i: usize) -> bool {
        let row = self.rates_by_memory.row(i);
        self.rates_by_speed[i] != 0.0
            || self.rates_by_load[i] != 0.0
            || row.iter().any(|rate| *rate != 0.0)
    }

    /// Returns true if memory variable i neither changes in slip nor influences anything.
    pub(crate) fn is_idle(&self, i: usize) -> bool {
        let column = self.rates_by_memory.column(i);
        !self.changes(i) && self.by_memory[i] == 0.0 && column.iter().all(|rate| *rate == 0.0)
    }

    /// Computes all derivatives with this memory, and the rates of the memory.
    fn at(law: &Slopes<'_>, memory: &[f64]) -> (Self, Vec<f64>) {
        let count = memory.len();
        let by_speed = law(memory, Input::Speed);
        let by_memory = (0..count).map(|j| law(memory, Input::Memory(j)));
        let by_memory: Vec<_> = by_memory.collect();
        let by_load = (count > 0).then(|| law(memory, Input::Load));
        let by_load = by_load.iter().flat_map(|by| &by.rates);
        let (rates, rates_by_speed) = by_speed.rates.iter().map(|&[rate, by]| (rate, by)).unzip();
        let sliding = Self {
            memory: memory.to_vec(),
            coefficient: by_speed.coefficient[0],
            slope: by_speed.coefficient[1],
            by_memory: by_memory.iter().map(|by| by.coefficient[1]).collect(),
            rates_by_speed,
            rates_by_load: by_load.map(|&[_, by]| by).collect(),
            rates_by_memory: DMatrix::from_fn(count, count, |i, j| by_memory[j].rates[i][1]),
        };
        (sliding, rates)
    }
}

fn sum_of_squares(numbers: &[f64]) -> f64 {
    numbers.iter().map(|number| number * number).sum()
}

/// Values and derivatives by an input, in slip under a load.
pub(super) fn derivatives<L: ContactLaw>(
    law: &L,
    (slip, load): (Slip<f64>, f64),
    memory: &[f64],
    by: Input,
) -> Derivatives {
    Tape::new().run(0, |run| {
        let number = |which: Input, value: f64| {
            if which == by {
                run.variable(value)
            } else {
                run.input(value)
            }
        };
        let slip = Slip {
            speed: number(Input::Speed, slip.speed),
            direction: slip.direction,
            piece: slip.piece,
        };
        let memory = L::Memory::from_fn(|j| number(Input::Memory(j), memory[j]));
        let load = number(Input::Load, load);
        let coefficient = law.coefficient(slip, memory);
        let rates = law.rates(Motion::Slip(slip), load, memory);
        let rates = rates.as_ref().iter();
        Derivatives {
            coefficient: [coefficient.value(), coefficient.derivative()],
            rates: rates
                .map(|rate| [rate.value(), rate.derivative()])
                .collect(),
        }
    })
}
