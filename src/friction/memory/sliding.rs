use nalgebra::{DMatrix, DVector};

use super::{ContactLaw, Motion, Slip, Variables};
use crate::scalar::Scalar;
use crate::scalar::jet::Tape;

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
    /// ∂z_i'/∂z_j.
    pub(crate) rates_by_memory: DMatrix<f64>,
}

/// Values of a law with a memory, and derivatives by memory variable j, or by the sliding speed for
/// `None`.
type Slopes<'l> = dyn Fn(&[f64], Option<usize>) -> Derivatives + 'l;

/// Values and derivatives by one variable.
pub(super) struct Derivatives {
    /// The coefficient and its derivative, with the sign of the direction of slip.
    pub(super) coefficient: [f64; 2],
    pub(super) rates: Vec<[f64; 2]>,
}

impl Sliding {
    /// Finds the memory whose rates are 0, by Newton's method from 0; `None` if there is none.
    pub(crate) fn of<L: ContactLaw>(law: &L, slip: Slip<f64>) -> Option<Self> {
        let count = L::Memory::<f64>::COUNT;
        Self::find(count, &|memory, by| derivatives(law, slip, memory, by))
    }

    fn find(count: usize, law: &Slopes<'_>) -> Option<Self> {
        /// Bristles take one.
        const MOST_ITERATIONS: usize = 100;
        let mut memory = vec![0.0; count];
        if count == 0 {
            return Some(Self::at(law, &memory).0);
        }
        for _ in 0..MOST_ITERATIONS {
            let (here, rates) = Self::at(law, &memory);
            // Variables that never change in slip, such as the clock of `Dwell`, stay as they are.
            let matrix = DMatrix::from_fn(count, count, |i, j| {
                let alone = if i == j { 1.0 } else { 0.0 };
                if here.changes(i) {
                    here.rates_by_memory[(i, j)]
                } else {
                    alone
                }
            });
            let change = matrix.lu().solve(&DVector::from_vec(rates))?;
            let mut settled = true;
            for (number, change) in std::iter::zip(&mut memory, change.iter()) {
                *number -= change;
                settled &= change.abs() <= 4.0 * f64::EPSILON * number.abs();
            }
            if settled {
                return Some(Self::at(law, &memory).0);
            }
        }
        None
    }

    /// Returns true if slip changes memory variable i.
    fn changes(&self, i: usize) -> bool {
        let row = self.rates_by_memory.row(i);
        self.rates_by_speed[i] != 0.0 || row.iter().any(|rate| *rate != 0.0)
    }

    /// Returns true if memory variable i neither changes in slip nor influences anything.
    pub(crate) fn is_idle(&self, i: usize) -> bool {
        let column = self.rates_by_memory.column(i);
        !self.changes(i) && self.by_memory[i] == 0.0 && column.iter().all(|rate| *rate == 0.0)
    }

    /// All derivatives with this memory, and its rates.
    fn at(law: &Slopes<'_>, memory: &[f64]) -> (Self, Vec<f64>) {
        let count = memory.len();
        let by_speed = law(memory, None);
        let by_memory: Vec<_> = (0..count).map(|j| law(memory, Some(j))).collect();
        let (rates, rates_by_speed) = by_speed.rates.iter().map(|&[rate, by]| (rate, by)).unzip();
        let sliding = Self {
            memory: memory.to_vec(),
            coefficient: by_speed.coefficient[0],
            slope: by_speed.coefficient[1],
            by_memory: by_memory.iter().map(|by| by.coefficient[1]).collect(),
            rates_by_speed,
            rates_by_memory: DMatrix::from_fn(count, count, |i, j| by_memory[j].rates[i][1]),
        };
        (sliding, rates)
    }
}

/// Values and derivatives by memory variable `by`, or by the sliding speed for `None`.
pub(super) fn derivatives<L: ContactLaw>(
    law: &L,
    slip: Slip<f64>,
    memory: &[f64],
    by: Option<usize>,
) -> Derivatives {
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
        let memory = L::Memory::from_fn(|j| number(Some(j), memory[j]));
        let coefficient = law.coefficient(slip, memory);
        let rates = law.rates(Motion::Slip(slip), memory);
        let rates = rates.as_ref().iter();
        Derivatives {
            coefficient: [coefficient.value(), coefficient.derivative()],
            rates: rates
                .map(|rate| [rate.value(), rate.derivative()])
                .collect(),
        }
    })
}
