use nalgebra::{DMatrix, DVector};

use super::{ContactLaw, Motion, Slip};
use crate::scalar::Scalar;
use crate::scalar::jet::Tape;

/// A contact that slides steadily: its coefficient with the memory that stays as it is, and what
/// small deviations of sliding speed and memory change.
#[derive(Debug, Clone)]
pub(crate) struct Sliding<const Z: usize> {
    /// μ, with the sign of the direction of slip.
    pub(crate) coefficient: f64,
    /// ∂μ/∂s.
    pub(crate) slope: f64,
    /// ∂μ/∂z_j.
    pub(crate) by_memory: [f64; Z],
    /// ∂z_i'/∂s.
    pub(crate) rates_by_speed: [f64; Z],
    /// ∂z_i'/∂z_j, in row i.
    pub(crate) rates_by_memory: [[f64; Z]; Z],
}

impl<const Z: usize> Sliding<Z> {
    /// Finds the memory whose rates are 0, by Newton's method from 0; `None` if there is none.
    pub(crate) fn of<L: ContactLaw<Z>>(law: &L, slip: Slip<f64>) -> Option<Self> {
        /// Bristles take one.
        const MOST_ITERATIONS: usize = 100;
        let mut memory = [0.0; Z];
        if Z == 0 {
            return Some(Self::at(law, slip, memory).0);
        }
        for _ in 0..MOST_ITERATIONS {
            let (here, rates) = Self::at(law, slip, memory);
            // What never changes in slip, as the clock of rest, stays as it is.
            let matrix = DMatrix::from_fn(Z, Z, |i, j| {
                let alone = if i == j { 1.0 } else { 0.0 };
                if here.changes(i) {
                    here.rates_by_memory[i][j]
                } else {
                    alone
                }
            });
            let change = matrix.lu().solve(&DVector::from_column_slice(&rates))?;
            let mut settled = true;
            for (number, change) in std::iter::zip(&mut memory, change.iter()) {
                *number -= change;
                settled &= change.abs() <= 4.0 * f64::EPSILON * number.abs();
            }
            if settled {
                return Some(Self::at(law, slip, memory).0);
            }
        }
        None
    }

    /// Whether memory number i is ever changed by slip.
    fn changes(&self, i: usize) -> bool {
        let mut row = self.rates_by_memory[i].iter();
        self.rates_by_speed[i] != 0.0 || row.any(|rate| *rate != 0.0)
    }

    /// Whether memory number i neither changes in slip nor acts on anything.
    pub(crate) fn is_idle(&self, i: usize) -> bool {
        let mut column = self.rates_by_memory.iter().map(|row| row[i]);
        !self.changes(i) && self.by_memory[i] == 0.0 && column.all(|rate| rate == 0.0)
    }

    /// All derivatives with this memory, and its rates.
    fn at<L: ContactLaw<Z>>(law: &L, slip: Slip<f64>, memory: [f64; Z]) -> (Self, [f64; Z]) {
        let by_speed = derivatives(law, slip, memory, None);
        let by_memory: [_; Z] = std::array::from_fn(|j| derivatives(law, slip, memory, Some(j)));
        let sliding = Self {
            coefficient: by_speed.coefficient[0],
            slope: by_speed.coefficient[1],
            by_memory: std::array::from_fn(|j| by_memory[j].coefficient[1]),
            rates_by_speed: by_speed.rates.map(|[_, slope]| slope),
            rates_by_memory: std::array::from_fn(|i| {
                std::array::from_fn(|j| by_memory[j].rates[i][1])
            }),
        };
        (sliding, by_speed.rates.map(|[rate, _]| rate))
    }
}

/// Values and derivatives by one number.
struct Derivatives<const Z: usize> {
    coefficient: [f64; 2],
    rates: [[f64; 2]; Z],
}

/// By memory number `by`, or else by the sliding speed.
fn derivatives<const Z: usize, L: ContactLaw<Z>>(
    law: &L,
    slip: Slip<f64>,
    memory: [f64; Z],
    by: Option<usize>,
) -> Derivatives<Z> {
    Tape::new().run(0, |run| {
        let number = |which: Option<usize>, value: f64| {
            if which == by {
                run.variable(value)
            } else {
                run.input(value)
            }
        };
        let slip = Slip {
            speed: number(None, slip.speed),
            direction: slip.direction,
            piece: slip.piece,
        };
        let memory: [_; Z] = std::array::from_fn(|j| number(Some(j), memory[j]));
        let coefficient = law.coefficient(slip, memory);
        let rates = law.rates(Motion::Slip(slip), memory);
        Derivatives {
            coefficient: [coefficient.value(), coefficient.derivative()],
            rates: rates.map(|rate| [rate.value(), rate.derivative()]),
        }
    })
}
