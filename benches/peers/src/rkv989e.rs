//! `differential-equations`: Verner's 9(8) pair with its interpolant of order 9 (`rkv989e`),
//! stepped by hand.
//!
//! By hand, because the solution that `solve` collects is not needed, and the contact is found to
//! round-off by Newton's method on the interpolant. Not `dop853`: its interpolant is far worse than
//! its steps.

use differential_equations::interpolate::Interpolation;
use differential_equations::methods::ExplicitRungeKutta;
use differential_equations::ode::{ODE, OrdinaryNumericalMethod};
use stick_slip::FrictionLaw;

use crate::phases::{Contact, Slip};

/// Longer than any slip phase.
const HORIZON: f64 = 100.0;

/// A change of the contact time that ends its search.
const ROUND_OFF: f64 = 1e-14;

struct OverTime<L>(Slip<L>);

impl<L: FrictionLaw + Copy> ODE<f64, [f64; 2]> for OverTime<L> {
    #[inline]
    fn diff(&self, _time: f64, y: &[f64; 2], dydt: &mut [f64; 2]) {
        *dydt = self.0.derivative(y[0], y[1]);
    }
}

pub fn contact<L: FrictionLaw + Copy>(
    slip: Slip<L>,
    tolerance: f64,
) -> impl FnMut(f64, f64) -> Contact {
    let ode = OverTime(slip);
    let mut method = ExplicitRungeKutta::rkv989e()
        .rtol(tolerance)
        .atol(tolerance)
        // They are counted over all phases.
        .max_steps(usize::MAX);
    move |displacement, relative_velocity| {
        let start = [displacement, relative_velocity];
        method.init(&ode, 0.0, HORIZON, &start).expect("start");
        // At a release w = 0: the first step leads away from there. A rejected step leaves the time
        // as it is.
        while method.t() == 0.0 || method.y()[1] < 0.0 {
            method.step(&ode).expect("slip");
        }
        // Newton's method, kept inside the step.
        let (mut before, mut after) = (method.t_prev(), method.t());
        let fraction = method.y_prev()[1] / (method.y_prev()[1] - method.y()[1]);
        let mut time = before + fraction * (after - before);
        loop {
            let [displacement, relative_velocity] =
                method.interpolate(time).expect("inside the step");
            if relative_velocity < 0.0 {
                before = time;
            } else {
                after = time;
            }
            let [_, acceleration] = slip.derivative(displacement, relative_velocity);
            let next = time - relative_velocity / acceleration;
            let next = if next > before && next < after {
                next
            } else {
                0.5 * (before + after)
            };
            if (next - time).abs() <= ROUND_OFF || relative_velocity == 0.0 {
                return Contact { time, displacement };
            }
            time = next;
        }
    }
}
