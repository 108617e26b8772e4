//! `differential-equations`: Verner's 9(8) pair with its interpolant of order 9 (`rkv989e`),
//! stepped by hand.
//!
//! By hand, because the solution that `solve` collects is not needed, and an event is found to
//! round-off by Newton's method on the interpolant. Not `dop853`: its interpolant is far worse than
//! its steps.

use differential_equations::interpolate::Interpolation;
use differential_equations::methods::ExplicitRungeKutta;
use differential_equations::ode::{ODE, OrdinaryNumericalMethod};
use stick_slip::FrictionLaw;

use crate::blocks::{End, Phase, Point};
use crate::phases::{Contact, Slip};

/// Longer than any phase.
const HORIZON: f64 = 100.0;

/// A change of an event's time that ends its search.
const ROUND_OFF: f64 = 1e-14;

struct OverTime<L>(Slip<L>);

impl<L: FrictionLaw + Copy> ODE<f64, [f64; 2]> for OverTime<L> {
    #[inline]
    fn diff(&self, _time: f64, y: &[f64; 2], dydt: &mut [f64; 2]) {
        *dydt = self.0.derivative(y[0], y[1]);
    }
}

struct Modes<L>(Phase<L>);

impl<L: FrictionLaw + Copy> ODE<f64, Point> for Modes<L> {
    #[inline]
    fn diff(&self, _time: f64, y: &Point, dydt: &mut Point) {
        *dydt = self.0.derivative(y);
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
        let span = [method.t_prev(), method.t()];
        let part = method.y_prev()[1] / (method.y_prev()[1] - method.y()[1]);
        let (time, [displacement, _]) = newton(span, part, |time| {
            let y: [f64; 2] = method.interpolate(time).expect("inside the step");
            let [_, acceleration] = slip.derivative(y[0], y[1]);
            (y, -y[1], -acceleration)
        });
        Contact { time, displacement }
    }
}

pub fn end<L: FrictionLaw + Copy>(tolerance: f64) -> impl FnMut(Phase<L>, Point) -> End {
    let mut method = ExplicitRungeKutta::rkv989e()
        .rtol(tolerance)
        .atol(tolerance)
        .max_steps(usize::MAX);
    move |phase, start| {
        let ode = Modes(phase);
        method.init(&ode, 0.0, HORIZON, &start).expect("start");
        let (block, part) = loop {
            method.step(&ode).expect("a phase");
            if let Some(first) = phase.first(method.y_prev(), method.y()) {
                break first;
            }
        };
        let span = [method.t_prev(), method.t()];
        let (time, point) = newton(span, part, |time| {
            let y: Point = method.interpolate(time).expect("inside the step");
            (y, phase.margin(block, &y), phase.margin_rate(block, &y))
        });
        End { block, time, point }
    }
}

/// Where a margin falls to 0 in a step: Newton's method, kept inside the step. `at` gives the
/// state, the margin and its rate.
fn newton<Y>(
    [mut before, mut after]: [f64; 2],
    part: f64,
    mut at: impl FnMut(f64) -> (Y, f64, f64),
) -> (f64, Y) {
    let mut time = before + part * (after - before);
    loop {
        let (state, margin, rate) = at(time);
        if margin > 0.0 {
            before = time;
        } else {
            after = time;
        }
        let next = time - margin / rate;
        let next = if next > before && next < after {
            next
        } else {
            0.5 * (before + after)
        };
        if (next - time).abs() <= ROUND_OFF || margin == 0.0 {
            return (time, state);
        }
        time = next;
    }
}
