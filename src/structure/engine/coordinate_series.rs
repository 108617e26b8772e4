//! The power series of one coordinate in a step.

use crate::series::{INTEGRAL, PowerSeries, TERMS};

/// Number of orders of a step.
pub(super) const ALL: usize = TERMS - 1;

/// The series of one displacement q: its value, then the coefficients of the velocity v = q', so
/// that number k is q_0 or k q_k.
#[derive(Debug, Clone)]
pub(super) struct DisplacementSeries {
    numbers: [f64; TERMS + 1],
    /// The coefficient of the velocity that was set last, stored separately. If it were stored next
    /// to the one before it, the processor would load both at once, and would have to wait for the
    /// store.
    newest: f64,
}

impl DisplacementSeries {
    pub(super) const ZERO: Self = Self {
        numbers: [0.0; TERMS + 1],
        newest: 0.0,
    };

    /// The factors of coefficient k in the displacement: 1/k, and 1 for its value.
    const WEIGHTS: [f64; TERMS + 1] = {
        let mut weights = [1.0; TERMS + 1];
        let mut k = 1;
        while k <= TERMS {
            weights[k] = INTEGRAL[k - 1];
            k += 1;
        }
        weights
    };

    pub(super) fn start(&mut self, displacement: f64, velocity: f64) {
        [self.numbers[0], self.numbers[1]] = [displacement, velocity];
        self.newest = velocity;
    }

    #[inline(always)]
    pub(super) fn displacement(&self, k: usize) -> f64 {
        self.numbers[k] * Self::WEIGHTS[k]
    }

    #[inline(always)]
    pub(super) fn velocity(&self, k: usize) -> f64 {
        self.numbers[k + 1]
    }

    /// The velocity coefficient of the highest order so far.
    #[inline(always)]
    pub(super) fn newest_velocity(&self) -> f64 {
        self.newest
    }

    #[inline(always)]
    pub(super) fn set_velocity(&mut self, k: usize, coefficient: f64) {
        self.numbers[k + 1] = coefficient;
        self.newest = coefficient;
    }

    /// Takes the velocity coefficient of order k for the highest one again.
    pub(super) fn begin_order(&mut self, k: usize) {
        self.newest = self.velocity(k);
    }

    /// Takes v = σy + w from the series of y and w, from coefficient 1 on.
    pub(super) fn follow(&mut self, side: f64, speeds: &PowerSeries, surface: &PowerSeries) {
        for k in 1..TERMS {
            self.numbers[k + 1] = side * speeds[k] + surface[k];
        }
        self.newest = self.numbers[TERMS];
    }

    /// Sets all numbers.
    #[inline(always)]
    pub(super) fn set(&mut self, number: impl Fn(usize) -> f64) {
        for (k, own) in self.numbers.iter_mut().enumerate() {
            *own = number(k);
        }
        self.newest = self.numbers[TERMS];
    }

    /// v(t).
    pub(super) fn at(&self, t: f64) -> f64 {
        self.velocities().at(t)
    }

    /// Returns true if v is constant.
    pub(super) fn is_straight(&self) -> bool {
        self.numbers[2..].iter().all(|&c| c == 0.0)
    }

    /// The series of v.
    pub(super) fn velocities(&self) -> PowerSeries {
        PowerSeries::from_fn(|k| self.velocity(k))
    }
}

/// The series of one coordinate.
#[derive(Debug, Clone)]
pub(super) struct CoordinateSeries {
    pub(super) motion: DisplacementSeries,
    /// (M⁻¹f)_i.
    pub(super) force: PowerSeries,
    /// The rule for the later orders of its velocity in the step.
    pub(super) role: Role,
}

/// The role of a coordinate in a step, if it is simple.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Role {
    /// The coordinate sticks in this contact, which has a constant bound and a constant velocity.
    Held(usize),
    /// The coordinate slips in this contact, which has no memory, with a constant load on a
    /// constant belt.
    Slips(usize),
    /// Something else.
    Other,
}

impl CoordinateSeries {
    pub(super) fn new(force: PowerSeries) -> Self {
        Self {
            motion: DisplacementSeries::ZERO,
            force,
            role: Role::Other,
        }
    }
}
