//! `ode_solvers`: Dop853 to the first step beyond an event, then Hénon's step.
//!
//! Its dense output is no use to a stop function, so the contact is reached with the velocity as
//! the independent variable: u and τ over w, from the nearer end of the last step to w = 0. Of two
//! blocks, the margin of the one that changes its mode takes the place of w. Only steps are kept
//! (`OutputType::Sparse`). A first step size of one's own, in place of the solver's guess, changes
//! the time by less than it varies.

use ode_solvers::{Dop853, OutputType, SVector, System, Vector2, Vector3, Vector4, Vector5};
use stick_slip::FrictionLaw;

use crate::blocks::{End, Phase, Point};
use crate::phases::{Contact, Slip};

/// The defaults of `Dop853::new`.
const SAFETY: f64 = 0.9;
const BETA: f64 = 0.0;
const LEAST_FACTOR: f64 = 0.333;
const LARGEST_FACTOR: f64 = 6.0;
const MAX_STEPS: u32 = 100_000;
const STIFFNESS_TEST: u32 = 1000;

/// Longer than any phase.
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

struct BlocksOverTime<L>(Phase<L>);

impl<L: FrictionLaw + Copy> System<f64, Vector4<f64>> for BlocksOverTime<L> {
    #[inline]
    fn system(&self, _time: f64, y: &Vector4<f64>, dy: &mut Vector4<f64>) {
        *dy = self.0.derivative(y.as_ref()).into();
    }
    fn solout(&mut self, _time: f64, y: &Vector4<f64>, _dy: &Vector4<f64>) -> bool {
        (0..2).any(|i| self.0.margin(i, y.as_ref()) < 0.0)
    }
}

/// d(u, w, τ) over the margin of a block.
struct BlocksOverMargin<L>(Phase<L>, usize);

impl<L: FrictionLaw + Copy> System<f64, Vector5<f64>> for BlocksOverMargin<L> {
    #[inline]
    fn system(&self, _: f64, y: &Vector5<f64>, dy: &mut Vector5<f64>) {
        let Self(phase, block) = self;
        let point = [y[0], y[1], y[2], y[3]];
        let [a, b, c, d] = phase.derivative(&point);
        let pace = 1.0 / phase.margin_rate(*block, &point);
        *dy = Vector5::new(a * pace, b * pace, c * pace, d * pace, pace);
    }
}

pub fn end<L: FrictionLaw + Copy>(tolerance: f64) -> impl FnMut(Phase<L>, Point) -> End {
    move |phase, start| {
        let over_time = BlocksOverTime(phase);
        let mut steps = solver(over_time, [0.0, HORIZON], start.into(), tolerance, 0.0);
        steps.integrate().expect("a phase");
        let ([.., time_before, time_after], [.., before, after]) =
            (&steps.x_out()[..], &steps.y_out()[..])
        else {
            unreachable!("the start and one step at least")
        };
        let first = phase.first(before.as_ref(), after.as_ref());
        let (block, part) = first.expect("the last step is beyond an event");
        let (time, near) = if part < 0.5 {
            (time_before, before)
        } else {
            (time_after, after)
        };
        let margin = phase.margin(block, near.as_ref());
        let mut last = solver(
            BlocksOverMargin(phase, block),
            [margin, 0.0],
            near.push(*time),
            tolerance,
            -margin,
        );
        last.integrate().expect("an event");
        let end = last.y_out().last().expect("one step at least");
        End {
            block,
            time: end[4],
            point: [end[0], end[1], end[2], end[3]],
        }
    }
}
