//! `ode_solvers`: Dop853 to the first step beyond contact, then Hénon's step.
//!
//! Its dense output is no use to a stop function, so the contact is reached with the velocity as
//! the independent variable: u and τ over w, from the nearer end of the last step to w = 0. Only
//! steps are kept (`OutputType::Sparse`). A first step size of one's own, in place of the solver's
//! guess, changes the time by less than it varies.

use ode_solvers::{Dop853, OutputType, SVector, System, Vector2, Vector3};
use stick_slip::FrictionLaw;

use crate::phases::{Contact, Slip};

/// The defaults of `Dop853::new`.
const SAFETY: f64 = 0.9;
const BETA: f64 = 0.0;
const LEAST_FACTOR: f64 = 0.333;
const LARGEST_FACTOR: f64 = 6.0;
const MAX_STEPS: u32 = 100_000;
const STIFFNESS_TEST: u32 = 1000;

/// Longer than any slip phase.
const HORIZON: f64 = 100.0;

struct OverTime<L>(Slip<L>);

impl<L: FrictionLaw + Copy> System<f64, Vector2<f64>> for OverTime<L> {
    #[inline]
    fn system(&self, _time: f64, y: &Vector2<f64>, dy: &mut Vector2<f64>) {
        *dy = self.0.derivative(y[0], y[1]).into();
    }
    fn solout(&mut self, _time: f64, y: &Vector2<f64>, _dy: &Vector2<f64>) -> bool {
        y[1] >= 0.0
    }
}

/// Hénon: d(u, τ, w)/dw. With w a variable too it is autonomous: the node c12 of this Dop853 is
/// wrong, and without that the whole run took 30 times as long.
struct OverVelocity<L>(Slip<L>);

impl<L: FrictionLaw + Copy> System<f64, Vector3<f64>> for OverVelocity<L> {
    #[inline]
    fn system(&self, _: f64, y: &Vector3<f64>, dy: &mut Vector3<f64>) {
        let [velocity, acceleration] = self.0.derivative(y[0], y[2]);
        let pace = 1.0 / acceleration;
        *dy = Vector3::new(velocity * pace, pace, 1.0);
    }
}

fn solver<const N: usize, F: System<f64, SVector<f64, N>>>(
    system: F,
    [from, to]: [f64; 2],
    start: SVector<f64, N>,
    tolerance: f64,
    step: f64,
) -> Dop853<f64, SVector<f64, N>, F> {
    Dop853::from_param(
        system,
        from,
        to,
        0.0,
        start,
        tolerance,
        tolerance,
        SAFETY,
        BETA,
        LEAST_FACTOR,
        LARGEST_FACTOR,
        to - from,
        step,
        MAX_STEPS,
        STIFFNESS_TEST,
        OutputType::Sparse,
    )
}

pub fn contact<L: FrictionLaw + Copy>(
    slip: Slip<L>,
    tolerance: f64,
) -> impl FnMut(f64, f64) -> Contact {
    move |displacement, relative_velocity| {
        let start = Vector2::new(displacement, relative_velocity);
        let mut phase = solver(OverTime(slip), [0.0, HORIZON], start, tolerance, 0.0);
        phase.integrate().expect("slip");
        let ([.., time_before, time_after], [.., before, after]) =
            (&phase.x_out()[..], &phase.y_out()[..])
        else {
            unreachable!("the start and one step at least")
        };
        let (time, near) = if -before[1] < after[1] {
            (time_before, before)
        } else {
            (time_after, after)
        };
        let mut last = solver(
            OverVelocity(slip),
            [near[1], 0.0],
            Vector3::new(near[0], *time, near[1]),
            tolerance,
            -near[1],
        );
        last.integrate().expect("contact");
        let end = last.y_out().last().expect("one step at least");
        Contact {
            time: end[1],
            displacement: end[0],
        }
    }
}
