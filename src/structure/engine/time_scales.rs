//! The time unit in which step lengths are measured, and the rates at which velocities settle.

use super::contact_data::ContactData;
use super::contact_series::ContactSeries;
use super::convergence_radius::{CoordinateMotion, motion};
use super::model::Model;
use super::rounding_scales::load_terms;
use super::series::Series;
use super::state::{ContactState, Phase, Situation};
use crate::friction::memory::{Motion, Slip};

/// Ulps of the clock below which no time is a unit.
const TOLD: f64 = 1024.0;

/// The model's time unit. Without springs and dampers it is the time in which forces change by
/// their own size, or, if forces are constant, the time in which they change a velocity by its
/// size.
pub(super) fn time_unit(
    model: &Model<'_>,
    situation: &Situation,
    series: &Series,
    scales: &[(f64, f64)],
) -> f64 {
    let tangents = |e: usize| &series.elements[e].tangents[..];
    let of_springs = model.time_unit_with(|c| situation.contacts[c].mode(), tangents);
    if of_springs.is_finite() {
        return of_springs;
    }
    let least = |times: &mut dyn Iterator<Item = f64>| {
        times
            .filter(|&time| time > 0.0)
            .fold(f64::INFINITY, f64::min)
    };
    let size = |(i, &(_, terms)): (usize, &(f64, f64))| {
        terms + model.acceleration_by(i, |j| model.forces[j].size()).abs()
    };
    let acceleration = |i: usize, k: usize| {
        let moved = (k + 1) as f64 * motion(model, situation, series, i).speed(k + 1);
        let carried = model.owner[i].map_or(0.0, |c| series.contacts[c].carried[k]);
        moved.abs().max(carried.abs())
    };
    // Measured without the present drives and loads, which may be about to change their signs.
    let mut sizes: Vec<f64> = scales.iter().enumerate().map(size).collect();
    for (c, contact) in model.contacts.iter().enumerate() {
        let coefficient = match situation.contacts[c].phase {
            Phase::Open => continue,
            Phase::Slip { .. } => series.contacts[c].friction[0].abs(),
            Phase::Stick { .. } => situation.contacts[c].static_coefficient(),
        };
        for &(j, x) in contact.responses() {
            sizes[j] += x.abs() * load_terms(model, situation, series, c) * coefficient;
        }
    }
    let changing = sizes.iter().enumerate().flat_map(|(i, size)| {
        (1..4).map(move |k| (size / acceleration(i, k)).powf(1.0 / k as f64))
    });
    let slipping = model.shared.iter().flat_map(|&c| {
        let of = &series.contacts[c];
        let size = model.contacts[c].size_along(|j| sizes[j]) + of.surface[1].abs();
        let slips = matches!(situation.contacts[c].phase, Phase::Slip { .. });
        let change = move |k: usize| (k + 1) as f64 * of.speeds[k + 1].abs();
        let orders = if slips { 1..4 } else { 0..0 };
        orders.map(move |k| (size / change(k)).powf(1.0 / k as f64))
    });
    let changing = least(&mut changing.chain(slipping));
    if changing.is_finite() {
        return changing;
    }
    let stopping = least(&mut sizes.iter().enumerate().map(|(i, size)| {
        let velocity = series.coordinates[i].motion.velocity(0).abs();
        match motion(model, situation, series, i) {
            // A mass that moves with a belt may pass through a velocity of 0.
            CoordinateMotion::Sticks(_) => f64::INFINITY,
            // A held coordinate has no acceleration, and its velocity may be mere rounding.
            free @ CoordinateMotion::Free(_) if model.owner[i].is_none() => {
                velocity / free.speed(1).abs()
            }
            slips => velocity.max(slips.surface(0).abs()) / size,
        }
    }));
    // Not a time below the resolution of the clock.
    stopping.max(TOLD * f64::EPSILON * situation.clock.time.abs())
}

/// The rates at which perturbations of the velocities of coordinates decay by damping and friction;
/// 0 unless a contact of the coordinate slips.
pub(super) fn closings(
    model: &Model<'_>,
    situation: &Situation,
    series: &Series,
    closings: &mut Vec<f64>,
) {
    closings.clear();
    closings.resize(model.len(), 0.0);
    for (c, contact) in model.contacts.iter().enumerate() {
        let Phase::Slip { .. } = situation.contacts[c].phase else {
            continue;
        };
        if contact.is_elastic() {
            continue;
        }
        let slope = series.contacts[c].load[0] * series.contacts[c].slope;
        if let Some(i) = model.owner_of(c) {
            closings[i] = model.damping.row(i).0 + slope;
            continue;
        }
        let responses = contact.responses();
        for &(j, b) in contact.direction.iter() {
            if closings[j] == 0.0 {
                closings[j] = model.damping.row(j).0;
            }
            if let Ok(place) = responses.binary_search_by_key(&j, |&(j, _)| j) {
                closings[j] += slope * b * responses[place].1;
            }
        }
    }
}

/// D of a contact that slips: the rate at which its sliding speed settles by friction and damping;
/// otherwise 0.
pub(super) fn settling(model: &Model<'_>, situation: &Situation, series: &Series, c: usize) -> f64 {
    let (contact, of) = (&model.contacts[c], &series.contacts[c]);
    match situation.contacts[c].phase {
        Phase::Slip { .. } if !contact.is_elastic() => {
            let damping = model.owner_of(c).map_or(0.0, |i| model.damping.row(i).0);
            of.load[0] * of.slope + damping
        }
        _ => 0.0,
    }
}

/// |N G Σ_j ∂μ/∂z_j ∂z_j'/∂s| of a contact that slips: its memory carries forces as a spring does,
/// by which the sliding speed vibrates unless it settles faster, at the rate D > 0.
pub(super) fn springiness(
    contact: &ContactData<'_>,
    (state, of): (&ContactState, &ContactSeries),
    rate: f64,
) -> f64 {
    /// Increments in parts of what is increased: differences have half the digits.
    const PART: f64 = 1.0 / (1 << 26) as f64;
    let Some(slip) = state.slip(state.speed()) else {
        return 0.0;
    };
    let sizes = [slip.speed, of.surface[0].abs(), of.speeds[1].abs() / rate];
    let step = PART * sizes.into_iter().fold(f64::MIN_POSITIVE / PART, f64::max);
    let memory = |j: usize| state.memory[j];
    let rates = |speed: f64| {
        let mut rates = vec![0.0; state.memory.len()];
        let (motion, load) = (
            Motion::Slip(Slip { speed, ..slip }),
            of.load[0] / contact.compliance,
        );
        contact
            .law
            .rates(motion, load, &memory, &mut |j, rate| rates[j] = rate);
        rates
    };
    let force = |memory: &dyn Fn(usize) -> f64| of.load[0] * contact.law.coefficient(slip, memory);
    let by_memory = |j: usize| {
        let step = PART * memory(j).abs().max(PART);
        let there = |l: usize| memory(l) + if l == j { step } else { 0.0 };
        (force(&there) - force(&memory)) / step
    };
    let [now, faster] = [0.0, step].map(|step| rates(slip.speed + step));
    let changes = std::iter::zip(now, faster).map(|(now, faster)| (faster - now) / step);
    let forces = changes
        .enumerate()
        .map(|(j, by_speed)| by_speed * by_memory(j));
    forces.sum::<f64>().abs()
}
