//! `diffsol`: Tsitouras 5(4) with the crate's own root finding.
//!
//! The solver is kept over all phases; a new phase changes its state in place, and the derivative
//! with it, which the crate does not recompute. `NalgebraMat` takes 0.6 of the time of `FaerMat`.

use std::cell::Cell;
use std::rc::Rc;

use diffsol::{
    NalgebraContext, NalgebraMat, NalgebraVec, OdeBuilder, OdeSolverMethod, OdeSolverStopReason,
    Vector,
};
use stick_slip::FrictionLaw;

use crate::blocks::{Blocks, End, Phase, Point};
use crate::phases::{Contact, Slip};

pub fn contact<L: FrictionLaw + Copy + 'static>(
    slip: Slip<L>,
    tolerance: f64,
) -> impl FnMut(f64, f64) -> Contact {
    let problem = OdeBuilder::<NalgebraMat<f64>>::new()
        .rtol(tolerance)
        .atol([tolerance])
        .rhs(move |y, _, _, dy| dy.copy_from_slice(&slip.derivative(y[0], y[1])))
        .init(|_, _, y| y.fill(0.0), 2)
        .root(|y, _, _, root| root[0] = y[1], 1)
        .build()
        .expect("problem");
    // The solver borrows the problem; both live as long as the program.
    let problem = Box::leak(Box::new(problem));
    let mut solver = problem.tsit45().expect("solver");
    let mut end = NalgebraVec::zeros(2, NalgebraContext::default());
    move |displacement, relative_velocity| {
        let [velocity, acceleration] = slip.derivative(displacement, relative_velocity);
        let state = solver.state_mut();
        state.y[0] = displacement;
        state.y[1] = relative_velocity;
        state.dy[0] = velocity;
        state.dy[1] = acceleration;
        *state.t = 0.0;
        let time = loop {
            if let OdeSolverStopReason::RootFound(time, _) = solver.step().expect("slip") {
                break time;
            }
        };
        solver
            .interpolate_inplace(time, &mut end)
            .expect("inside the step");
        Contact {
            time,
            displacement: end[0],
        }
    }
}

pub fn end<L: FrictionLaw + Copy + 'static>(
    blocks: Blocks<L>,
    tolerance: f64,
) -> impl FnMut(Phase<L>, Point) -> End {
    let current = Rc::new(Cell::new(Phase::behind(blocks)));
    let [of_rates, of_roots] = [current.clone(), current.clone()];
    let problem = OdeBuilder::<NalgebraMat<f64>>::new()
        .rtol(tolerance)
        .atol([tolerance])
        .rhs(move |y, _, _, dy| dy.copy_from_slice(&of_rates.get().derivative(&point(y))))
        .init(|_, _, y| y.fill(0.0), 4)
        .root(
            move |y, _, _, roots| {
                let phase = of_roots.get();
                for (block, root) in roots.iter_mut().enumerate() {
                    *root = phase.margin(block, &point(y));
                }
            },
            2,
        )
        .build()
        .expect("problem");
    let problem = Box::leak(Box::new(problem));
    let mut solver = problem.tsit45().expect("solver");
    let mut end = NalgebraVec::zeros(4, NalgebraContext::default());
    move |phase, start| {
        current.set(phase);
        let state = solver.state_mut();
        for (i, rate) in phase.derivative(&start).into_iter().enumerate() {
            state.y[i] = start[i];
            state.dy[i] = rate;
        }
        *state.t = 0.0;
        let (time, block) = loop {
            if let OdeSolverStopReason::RootFound(time, block) = solver.step().expect("a phase") {
                break (time, block);
            }
        };
        solver
            .interpolate_inplace(time, &mut end)
            .expect("inside the step");
        let point = [end[0], end[1], end[2], end[3]];
        End { block, time, point }
    }
}

fn point(y: &[f64]) -> Point {
    [y[0], y[1], y[2], y[3]]
}
