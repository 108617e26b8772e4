//! Phases: steps in a row along which the variational equations have the same constant
//! coefficients, as between two events of a linear structure with constant friction. One matrix
//! exponential carries perturbations over all steps of a phase.

use nalgebra::DMatrix;

use super::perturbation_series::{LONG, matrix};
use super::type_erased_system::GeneralForm;
use super::variational_equations::Linear;
use crate::error::Reached;
use crate::motion::{Mode, Segment};
use crate::numerics::exponential::Exponent;
use crate::structure::Step;

/// Steps along which x' = A x with constant A.
#[derive(Debug)]
pub(super) struct Phase {
    pub(super) linear: Linear,
    pub(super) modes: Vec<Mode>,
    pub(super) duration: f64,
    pub(super) begins: Reached,
}

impl Phase {
    pub(super) fn new(linear: Linear, step: &Step) -> Self {
        Self {
            linear,
            modes: step.modes().to_vec(),
            duration: step.duration(),
            begins: Reached::new(step.start_time(), step.state().clone()),
        }
    }

    /// Adds a step; returns false if it does not belong to the phase.
    pub(super) fn extend(&mut self, form: &GeneralForm<'_>, step: &Step) -> bool {
        let belongs = self.modes == step.modes()
            && (form.model.is_linear(step.modes()) || self.linear == Linear::of(&form.model, step));
        if belongs {
            self.duration += step.duration();
        }
        belongs
    }

    /// e^{At} over the phase; `None` if power series for so many perturbations take fewer
    /// multiplications, as in long chains.
    pub(super) fn exponential(
        &self,
        form: &GeneralForm<'_>,
        perturbations: usize,
    ) -> Option<DMatrix<f64>> {
        /// The norm of A t over which series reach.
        const REACH: f64 = 2.8;
        let matrix = matrix(form, &self.linear) * self.duration;
        let order = matrix.nrows() as f64;
        let entries = matrix.iter().filter(|x| **x != 0.0).count();
        let exponent = Exponent::new(matrix);
        let series = (exponent.norm / REACH).ceil() * (LONG * entries * perturbations) as f64;
        (exponent.products() * order.powi(3) < series).then(|| exponent.exponential())
    }
}

/// Returns true if perturbations may jump at the end of a step. The load of an elastic contact that
/// slips limits its force at the end of each step, too, but in slip nothing depends on this force.
pub(super) fn ends_phase(step: &Step) -> bool {
    let slips = |c: usize| matches!(step.modes()[c], Mode::Slip(_));
    !step.events().is_empty() || step.after().limited.iter().any(|&(c, _)| !slips(c))
}
