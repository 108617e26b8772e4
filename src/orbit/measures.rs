//! Measures of a periodic motion: extremes as roots of its power series, means as integrals over
//! them.

use nalgebra::DVector;

use super::type_erased_system::GeneralForm;
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
            let middle = step.start_time() + 0.5 * h;
            let start = step.state().displacements[coordinate] - mean_velocity * middle;
            Some((start + velocity.twice_integrated(h) * h) / unit * h)
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
        let mode = |step: &&Step| step.modes()[number];
        let sticks = steps.iter().filter(|step| mode(step) == Mode::Stick);
        let slips = steps
            .iter()
            .filter(|step| matches!(mode(step), Mode::Slip(_)));
        let speeds = slips.filter_map(|step| {
            let relative = step.relative_velocity(number)?;
            Some(largest(relative.extremes(step.duration())))
        });
        Self {
            stick_duration: Clock::sum(sticks.map(Segment::duration)),
            max_sliding_speed: speeds.fold(0.0, f64::max),
        }
    }
}

/// Largest absolute value in a range.
fn largest((least, most): (f64, f64)) -> f64 {
    f64::max(-least, most)
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
        relative.sign_changes(h, &mut |t, _| meet(0, start + t * relative.mean(t)));
        acceleration.sign_changes(h, &mut |t, _| meet(1, velocity.at(t)));
        let (least, most) = acceleration.extremes(h);
        meet(2, least);
        meet(2, most);
    }
    ranges
}
