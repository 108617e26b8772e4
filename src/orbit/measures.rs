//! Measures of a periodic motion: extremes as roots of its power series, means as integrals over
//! them.

use std::ops::ControlFlow;

use nalgebra::DVector;

use super::form::GeneralForm;
use crate::clock::Clock;
use crate::motion::sealed::Part as _;
use crate::motion::{EnergyBudget, Mode, Segment};
use crate::numerics::gauss::gauss_nodes;
use crate::numerics::power_of_two;
use crate::series::PowerSeries;
use crate::structure::Step;

/// Measures taken once a motion is found.
#[derive(Debug, Clone)]
pub(super) struct Measures {
    pub(super) coordinates: Vec<Coordinate>,
    pub(super) contacts: Vec<Contact>,
    pub(super) energy: EnergyBudget,
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Coordinate {
    /// Least and largest displacement (minus the translation), velocity and acceleration.
    pub(super) ranges: [(f64, f64); 3],
    pub(super) mean: f64,
    pub(super) mean_velocity: f64,
    pub(super) rms_velocity: f64,
    pub(super) rms_acceleration: f64,
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Contact {
    pub(super) stick_duration: f64,
    pub(super) max_sliding_speed: f64,
}

impl Measures {
    /// The measures of one period, from the steps and the translation in this period.
    pub(super) fn of(
        form: &GeneralForm<'_>,
        (steps, translation): (&[Step], &DVector<f64>),
        period: f64,
        energy: EnergyBudget,
    ) -> Self {
        let coordinate = |i: usize| Coordinate::of(steps, i, (translation[i], period));
        let coordinates = (0..form.len()).map(coordinate);
        Self {
            coordinates: coordinates.collect(),
            contacts: (0..form.contacts())
                .map(|c| Contact::of(steps, c))
                .collect(),
            energy,
        }
    }
}

impl Coordinate {
    fn of(steps: &[Step], coordinate: usize, (translation, period): (f64, f64)) -> Self {
        let mean_velocity = translation / period;
        let ranges = extremes(steps, coordinate, mean_velocity);
        let largest = |(least, most): (f64, f64)| f64::max(-least, most);
        let series = |step: &Step| step.series().get(coordinate).copied();
        // In units of the largest value, so that squares do not overflow.
        let rms = |which: usize, value: fn(&PowerSeries, f64) -> f64| {
            let unit = largest(ranges[which]);
            if unit == 0.0 {
                return 0.0;
            }
            let squares = steps.iter().filter_map(|step| {
                let series = series(step)?;
                let square = |t: f64| (value(&series, t) / unit).powi(2);
                let nodes = gauss_nodes(0.0, step.duration());
                Some(nodes.map(|(t, weight)| weight * square(t)).sum::<f64>())
            });
            unit * (squares.sum::<f64>() / period).sqrt()
        };
        // Products with a long period do not overflow in this unit.
        let unit = power_of_two(largest(ranges[0]).max(1.0));
        let integrals = steps.iter().filter_map(|step| {
            let (h, velocity) = (step.duration(), series(step)?);
            // ∫∫v = h² Σ v_k h^k/((k + 1)(k + 2))
            let twice = PowerSeries::from_fn(|k| velocity[k] / ((k + 1) * (k + 2)) as f64);
            let middle = step.start_time() + 0.5 * h;
            let start = step.state().displacements[coordinate] - mean_velocity * middle;
            Some((start + twice.at(h) * h) / unit * h)
        });
        Self {
            mean: unit * (integrals.sum::<f64>() / period),
            mean_velocity,
            rms_velocity: rms(1, PowerSeries::at),
            rms_acceleration: rms(2, PowerSeries::slope_at),
            ranges,
        }
    }
}

impl Contact {
    fn of(steps: &[Step], number: usize) -> Self {
        let mut clock = Clock::default();
        let mut max_sliding_speed = 0.0_f64;
        for step in steps {
            if step.modes()[number] == Mode::Stick {
                clock = clock.after(step.duration());
            }
            if !matches!(step.modes()[number], Mode::Slip(_)) {
                continue;
            }
            let Some(relative) = step.relative_velocity(number) else {
                continue;
            };
            let mut meet = |t: f64| max_sliding_speed = max_sliding_speed.max(relative.at(t).abs());
            meet(0.0);
            meet(step.duration());
            at_extremes(&relative.derivative(), step.duration(), &mut meet);
        }
        Self {
            stick_duration: clock.time,
            max_sliding_speed,
        }
    }
}

/// Calls `meet` where a series changes its sign in a step.
fn at_extremes(rate: &PowerSeries, h: f64, meet: &mut dyn FnMut(f64)) {
    let _ = rate.sign_changes(h, &mut |t, _| {
        meet(t);
        ControlFlow::Continue(())
    });
}

/// Least and largest displacement (minus the translation), velocity and acceleration of a
/// coordinate, among the ends of steps and the zeros of the derivatives.
fn extremes(steps: &[Step], coordinate: usize, mean_velocity: f64) -> [(f64, f64); 3] {
    let mut ranges = [(f64::INFINITY, f64::NEG_INFINITY); 3];
    let mut meet = |which: usize, value: f64| {
        let (least, largest): &mut (f64, f64) = &mut ranges[which];
        (*least, *largest) = (least.min(value), largest.max(value));
    };
    for step in steps {
        let ends = [step.start_time(), step.end_time()];
        for (time, state) in std::iter::zip(ends, [step.state(), &step.end_state()]) {
            meet(0, state.displacements[coordinate] - mean_velocity * time);
            meet(1, state.velocities[coordinate]);
        }
        let Some(velocity) = step.series().get(coordinate) else {
            continue;
        };
        let h = step.duration();
        let start = step.state().displacements[coordinate] - mean_velocity * step.start_time();
        let mut relative = *velocity;
        relative[0] -= mean_velocity;
        let acceleration = velocity.derivative();
        meet(2, acceleration.at(0.0));
        meet(2, acceleration.at(h));
        at_extremes(&relative, h, &mut |t| meet(0, start + t * relative.mean(t)));
        at_extremes(&acceleration, h, &mut |t| meet(1, velocity.at(t)));
        at_extremes(&acceleration.derivative(), h, &mut |t| {
            meet(2, acceleration.at(t));
        });
    }
    ranges
}
