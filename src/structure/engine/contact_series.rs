//! The power series at one contact in a step.

use super::cholesky::ROUNDING;
use super::contact_data::ContactData;
use super::limits::larger_finite;
use crate::scalar::jet::Tape;
use crate::series::PowerSeries;
use crate::state::Direction;

/// The mode of a contact in a step, for its series.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum StepMode {
    Open,
    Stick,
    Slip,
}

/// The series at one contact. All forces are accelerations of r: multiplied by G_cc.
#[derive(Debug, Clone)]
pub(super) struct ContactSeries {
    /// The mode of the contact in the step.
    pub(super) mode: StepMode,
    /// σ in slip; 0 in stick, and 1 for one that is open.
    pub(super) side: f64,
    /// The piece of the law that holds in slip.
    pub(super) piece: usize,
    /// dy/dt at the start, where it is known.
    pub(super) rate: Option<f64>,
    /// μ_s at the start, backward and forward.
    pub(super) limits: [f64; 2],
    /// y.
    pub(super) speeds: PowerSeries,
    /// w.
    pub(super) surface: PowerSeries,
    /// Σ b_j v_j, and Σ n_j v_j of the load, over coordinates without a contact of their own, where
    /// contacts that stick determine them: see `Guided` in `state.rs`.
    pub(super) guided: Option<PowerSeries>,
    pub(super) guided_load: Option<PowerSeries>,
    /// The force in stick. For a contact with its own coordinate, also in slip, unless it slips
    /// alone without a drive: the force that stick would need, from order 1 on.
    pub(super) carried: PowerSeries,
    /// Bounds of its rounding errors, where the sign of the first nonzero coefficient decides.
    pub(super) carried_rounding: PowerSeries,
    /// N μ_s backward and forward; without terms beyond the first for a constant load and a law
    /// without memory, and where it is infinite.
    pub(super) bounds: [PowerSeries; 2],
    /// N; 0 while the contact is lifted.
    pub(super) load: PowerSeries,
    /// N ≤ 0 while the contact is lifted.
    pub(super) lifted: Option<PowerSeries>,
    /// The part of N that is given in time.
    pub(super) drive_load: PowerSeries,
    /// True if N varies.
    pub(super) load_varies: bool,
    /// r' at the start of the step without the forces of all shared contacts at r = 0.
    pub(super) free: f64,
    /// σμ in slip.
    pub(super) friction: PowerSeries,
    /// Derivative of σμ by the sliding speed, at the start of the step.
    pub(super) slope: f64,
    /// μ_s backward and forward, if the law has a memory.
    pub(super) limit_series: [PowerSeries; 2],
    pub(super) memories: Vec<PowerSeries>,
    /// One order of the rates of the memory.
    pub(super) rates: Vec<f64>,
    /// D, the rate at which the memory relaxes, if its series is that of the slow manifold;
    /// otherwise 0.
    pub(super) relaxation: f64,
    /// D, the rate at which the sliding speed settles, if its series is that of the slow manifold;
    /// otherwise 0.
    pub(super) settling: f64,
    pub(super) tape: Tape,
}

impl ContactSeries {
    /// The series before the first step from a time.
    pub(super) fn new(contact: &ContactData<'_>, time: f64) -> Self {
        let load = PowerSeries::of(contact.load.value(time) * contact.compliance);
        let count = contact.memory.len();
        Self {
            mode: StepMode::Open,
            side: 1.0,
            piece: 0,
            rate: None,
            limits: [0.0; 2],
            speeds: PowerSeries::ZERO,
            guided: None,
            guided_load: None,
            surface: PowerSeries::of(contact.belt_velocity.value(time)),
            carried: PowerSeries::ZERO,
            carried_rounding: PowerSeries::ZERO,
            bounds: [PowerSeries::ZERO; 2],
            load,
            lifted: None,
            drive_load: load,
            load_varies: !contact.load.is_constant() || contact.load_follows(),
            free: 0.0,
            friction: PowerSeries::ZERO,
            slope: 0.0,
            limit_series: [PowerSeries::ZERO; 2],
            memories: vec![PowerSeries::ZERO; count],
            rates: vec![0.0; count],
            relaxation: 0.0,
            settling: 0.0,
            tape: Tape::new(),
        }
    }

    /// N, also where it does not act.
    pub(super) fn normal(&self) -> &PowerSeries {
        self.lifted.as_ref().unwrap_or(&self.load)
    }

    pub(super) fn normal_mut(&mut self) -> &mut PowerSeries {
        self.lifted.as_mut().unwrap_or(&mut self.load)
    }

    /// Lifts the contact, or lets it down.
    pub(super) fn lift(&mut self, is_lifted: bool) {
        if is_lifted && self.lifted.is_none() {
            self.lifted = Some(std::mem::replace(&mut self.load, PowerSeries::ZERO));
        } else if !is_lifted && let Some(load) = self.lifted.take() {
            self.load = load;
        }
    }

    /// N μ_s against slip to a side.
    pub(super) fn bound(&self, side: Direction) -> &PowerSeries {
        &self.bounds[side.place()]
    }

    /// The larger bound at the start that is finite: the scale of the force in stick.
    pub(super) fn largest_bound(&self) -> f64 {
        larger_finite(self.bounds.each_ref().map(|bound| bound[0].abs()))
    }

    /// Returns true if both bounds at the start, and this force, are 0 to rounding.
    pub(super) fn has_no_band(&self, carried: f64, rounding: f64) -> bool {
        let bounds = self.bounds.iter().map(|bound| bound[0]);
        bounds.fold(carried.abs(), f64::max) <= rounding
    }

    /// Bound of the rounding error of coefficient k of the distance from an edge of the band.
    pub(super) fn rounding(&self, side: Direction, k: usize) -> f64 {
        self.carried_rounding[k] + ROUNDING * self.bound(side)[k].abs()
    }

    /// Sets the bounds to 0.
    #[inline]
    pub(super) fn clear_bounds(&mut self) {
        let is_constant = self.memories.is_empty() && !self.load_varies;
        for bound in &mut self.bounds {
            if is_constant {
                // It has no other terms.
                bound[0] = 0.0;
            } else {
                *bound = PowerSeries::ZERO;
            }
        }
    }

    /// Keeps the memory constant.
    pub(super) fn hold_memory(&mut self, memory: &[f64]) {
        for (series, memory) in std::iter::zip(&mut self.memories, memory) {
            *series = PowerSeries::of(*memory);
        }
    }
}

/// The correction that a pass adds to coefficient k of a memory that relaxes, from its rate and
/// from coefficients k and k + 1 of the pass before.
#[inline(always)]
pub(super) fn correction(relaxation: f64, k: usize, rate: f64, [own, next]: [f64; 2]) -> f64 {
    let correction = (rate - (k + 1) as f64 * next) / relaxation;
    // A correction that consists of rounding errors only would change the later coefficients again
    // and again.
    if correction.abs() > 2.0 * f64::EPSILON * own.abs() {
        correction
    } else {
        0.0
    }
}
