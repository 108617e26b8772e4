//! The series of a coordinate that slips while all other coordinates are held at constant
//! velocities. Its equation is that of a mass on a belt under given forces, so its series is
//! computed by the same code. Order k of the force of an element is given, too, once order k of the
//! velocity is known.

use std::cell::RefCell;

use super::contact_series::StepMode;
use super::coordinate_series::{ALL, CoordinateSeries, Role};
use super::element_forces::Pushing;
use super::model::Model;
use super::series::Series;
use super::stick_band_edge::side_of;
use crate::clock::Time;
use crate::friction::slip_series::{Equation, Expansion, Known, SlipPoint};
use crate::series::{INTEGRAL, PowerSeries};

/// Computes all orders of the coordinate and the contact that slip alone, and all after the first
/// of those that are held; returns false if the law gives no number or no slope.
pub(super) fn expand_alone(model: &Model<'_>, series: &mut Series, [i, c]: [usize; 2]) -> bool {
    let is_pushed = series.is_pushed();
    let side = series.contacts[c].side;
    let Some(law) = model.contacts[c].law.dry_slip(side) else {
        return false;
    };
    let Series {
        coordinates,
        contacts,
        elements,
        given: forces,
        expander,
        ..
    } = series;
    let pull = |springs: &[(usize, f64)], coordinates: &[CoordinateSeries], order: usize| {
        let terms = springs.iter();
        let terms = terms.map(|&(j, a)| a * coordinates[j].motion.displacement(order));
        terms.sum::<f64>()
    };
    let (spring, springs) = model.stiffness.row(i);
    let (damping, dampers) = model.damping.row(i);
    let braking = dampers.iter();
    let braking = braking.map(|&(j, a)| a * coordinates[j].motion.velocity(0));
    let held = pull(springs, coordinates, 0) + braking.sum::<f64>();
    let (force, surface) = (&coordinates[i].force, &contacts[c].surface);
    let equation = Equation {
        stiffness: spring,
        damping,
        load: contacts[c].load[0],
        belt: side * surface[0],
        pull: side * (held - (force[0] - surface[1])),
        drift: side * pull(springs, coordinates, 1),
    };
    let from = SlipPoint {
        direction: side_of(side),
        displacement: coordinates[i].motion.displacement(0),
        speed: contacts[c].speeds[0],
        rate: contacts[c].rate,
    };
    // Without the forces of elements.
    let unpushed = is_pushed.then(|| model.sprung.binary_search(&i).ok());
    let unpushed = unpushed.flatten().map(|place| &forces[place]);
    let force = unpushed.unwrap_or(force);
    // With v = σy + w: f − w' − dw, and the force of the spring on the way of w after order 1.
    let is_driven = model.is_driven[i] || unpushed.is_some();
    let given = is_driven.then(|| {
        let mut given = PowerSeries::ZERO;
        for k in 1..ALL {
            let way = if k > 1 {
                surface[k - 1] * INTEGRAL[k - 1]
            } else {
                0.0
            };
            let inertia = (k + 1) as f64 * surface[k + 1];
            given[k] = side * (force[k] - inertia - damping * surface[k] - spring * way);
        }
        given
    });
    let mut expand = |known: Known<'_>| {
        law.expand_slip(Expansion {
            expander,
            piece: contacts[c].piece,
            equation: &equation,
            from: &from,
            time: Time::Forward,
            known,
        })
    };
    let expanded = match (&given, unpushed) {
        (None, _) => expand(Known::Nothing),
        (Some(given), None) => expand(Known::Force(given)),
        (Some(given), Some(unpushed)) => {
            // They act on no coordinate that is held: see `role`.
            let acceleration = &mut coordinates[i].force;
            let elements = Pushing::new(&model.elements, elements, i);
            let pushing = RefCell::new((elements, acceleration));
            expand(Known::Push(&|k, speed| {
                let (elements, acceleration) = &mut *pushing.borrow_mut();
                let against = elements.order(side * speed + surface[k], k);
                acceleration[k] = unpushed[k] - against;
                given[k] - side * against
            }))
        }
    };
    if expanded.is_err() {
        return false;
    }
    let found = &expander.series;
    let of = &mut contacts[c];
    (of.speeds, of.friction, of.slope) = (found.speed, found.friction, found.slope);
    for series in &mut of.memories {
        *series = PowerSeries::of(series[0]);
    }
    if is_driven {
        // Without springs, the time in which it changes is the unit of time.
        for k in 1..ALL {
            let moved = (k + 1) as f64 * found.speed[k + 1];
            of.carried[k] = side * (moved + of.load[0] * found.friction[k]);
        }
    }
    coordinates[i]
        .motion
        .follow(side, &found.speed, &of.surface);
    for j in 0..model.len() {
        let Role::Held(held_by) = coordinates[j].role else {
            continue;
        };
        let surface = contacts[c].surface;
        let carried = &mut contacts[held_by].carried;
        let entry = |(_, beside): (f64, &[(usize, f64)])| {
            let place = beside.binary_search_by_key(&i, |&(column, _)| column);
            place.map_or(0.0, |place| beside[place].1)
        };
        let (spring, damper) = (entry(model.stiffness.row(j)), entry(model.damping.row(j)));
        // From the series as it was found: a copy would have to be waited for.
        for k in 2..ALL {
            let velocity = |k: usize| side * found.speed[k] + surface[k];
            let displacement = velocity(k - 1) * INTEGRAL[k - 1];
            carried[k] = -spring * displacement - damper * velocity(k);
        }
        let (spring, springs) = model.stiffness.row(j);
        let own = spring * coordinates[j].motion.displacement(1);
        carried[1] =
            -damper * coordinates[i].motion.velocity(1) - own - pull(springs, coordinates, 1);
    }
    true
}

/// The coordinate that slips under a constant load while all others are held, and its contact, if
/// the law of this contact has a series without memory.
pub(super) fn slips_alone(model: &Model<'_>, series: &Series) -> Option<[usize; 2]> {
    let mut found = None;
    for (i, coordinate) in series.coordinates.iter().enumerate() {
        if let Role::Held(_) = coordinate.role {
            continue;
        }
        let c = model.owner[i].filter(|_| found.is_none())?;
        let of = &series.contacts[c];
        let is_simple = of.mode == StepMode::Slip && !of.load_varies;
        if !is_simple || model.contacts[c].law.dry_slip(of.side).is_none() {
            return None;
        }
        found = Some([i, c]);
    }
    found
}
