//! Whether the series of a step hold between their coefficients: what is missing in the equations
//! of motion.

use super::model::{ContactData, Model};
use super::plan::Plan;
use super::series::{ContactSeries, Series};
use super::state::{ContactState, Situation};
use crate::friction::memory::{Motion, Slip};
use crate::motion::step_control::{Allowance, LONG, MOST_FOURS};
use crate::series::quarters;

/// Whether a step of length h leaves out no more than it may, at every contact that slips: at its
/// quarters, about the places where the sliding speed is least, and, in a long step, at least every
/// quarter of a radian. Coefficients alone miss what lies hidden behind an underflow, such as the
/// flank of a narrow Gaussian.
pub(super) fn is_accepted(
    model: &Model<'_>,
    situation: &Situation,
    series: &Series,
    plan: &Plan,
    h: f64,
) -> bool {
    let contacts = std::iter::zip(&situation.contacts, &series.contacts);
    let mut contacts = contacts.zip(&model.contacts).zip(&plan.contacts);
    contacts.all(|(((state, series), contact), allowance)| {
        let Some(slip) = state.slip(()) else {
            return true;
        };
        let defects = defects(contact, series, slip, h, plan.unit);
        allowance.accepts(defects, h) && memory_is_accepted(contact, state, series, h)
    })
}

/// Whether a step of length h leaves out no more of a contact's memory than it may, at its
/// quarters.
fn memory_is_accepted(
    contact: &ContactData<'_>,
    state: &ContactState,
    series: &ContactSeries,
    h: f64,
) -> bool {
    if series.memories.is_empty() {
        return true;
    }
    let times = quarters(h);
    std::iter::zip(times, series.speeds.at_some(times)).all(|(time, speed)| {
        let Some(slip) = state.slip(speed.max(0.0)) else {
            return true;
        };
        let mut accepted = true;
        let mut take = |j: usize, rate: f64| {
            let memory = &series.memories[j];
            let scale = memory[0].abs().max(memory[1].abs() * h);
            let missing = (memory.derivative().at(time) - rate).abs();
            let largest = rate.abs().max(memory[1].abs());
            // What is missing on a slow manifold moves it aside by as much divided by D.
            let (largest, h) = if series.relaxation > 0.0 {
                (series.relaxation * scale, series.relaxation.recip())
            } else {
                (largest, h)
            };
            let allowance = Allowance::new(f64::EPSILON * scale, largest);
            accepted &= allowance.accepts([missing; 3], h);
        };
        let memory = &|j: usize| series.memories[j].at(time);
        contact.law.rates(Motion::Slip(slip), memory, &mut take);
        accepted
    })
}

/// The defects of a step of length h at a contact that slips: at its quarters, about the places
/// where the speed is least, and between them in a long step.
fn defects(
    contact: &ContactData<'_>,
    series: &ContactSeries,
    slip: Slip<()>,
    h: f64,
    unit: f64,
) -> [f64; 3] {
    let speeds = &series.speeds;
    let look = |times: [f64; 4], speeds: [f64; 4]| defect(contact, series, slip, times, speeds);
    let times = quarters(h);
    let at_times = speeds.at_four(times);
    let at_quarters = look(times, at_times);
    let mut at_minima = 0.0;
    speeds.about_minima(h, at_times, &mut |times| {
        at_minima += look(times, speeds.at_four(times));
    });
    let mut between = 0.0;
    if h > LONG * unit {
        let fours = (h / unit).ceil().min(MOST_FOURS);
        let part = 0.25 * h / fours;
        for i in 0..fours as usize {
            let start = i as f64 * 4.0 * part;
            let times = [0.5, 1.5, 2.5, 3.5].map(|place| start + place * part);
            between += look(times, speeds.at_four(times));
        }
    }
    [at_quarters, at_minima, between]
}

/// Largest N·|μ(s(t)) − μ(t)| at four times, where s(t) has the values `speeds`: the defect of the
/// series, up to terms as small as its last.
fn defect(
    contact: &ContactData<'_>,
    series: &ContactSeries,
    slip: Slip<()>,
    times: [f64; 4],
    speeds: [f64; 4],
) -> f64 {
    let friction = series.friction.at_four(times);
    let slip = Slip {
        speed: speeds.map(|speed| speed.max(0.0)),
        direction: slip.direction,
        piece: slip.piece,
    };
    let memory = &|i: usize, j: usize| series.memories[j].at(times[i]);
    let values = contact.law.at_four(slip, memory);
    let mut largest = 0.0;
    for i in 0..4 {
        let value = values[i] * slip.direction;
        let mut difference = (value - friction[i]).abs();
        if series.load_varies {
            difference *= series.load.at(times[i]).abs();
        }
        // Not f64::max, which would drop a NaN.
        largest = if largest >= difference {
            largest
        } else {
            difference + 0.0 * largest
        };
    }
    if series.load_varies {
        largest
    } else {
        series.load[0].abs() * largest
    }
}
