//! The series of a coordinate that slips while all other coordinates are held at constant
//! velocities. Its equation is that of a mass on a belt with a given force, so its series is
//! computed by the same code.

use super::ALL;
use super::edge::side_of;
use super::model::Model;
use super::series::{CoordinateSeries, Role, Series, StepMode};
use crate::clock::Time;
use crate::friction::slip::{Equation, Expansion, SlipPoint};
use crate::series::{INTEGRAL, PowerSeries};

/// All orders of the coordinate and the contact that slip alone, and all after the first of those
/// that are held; returns false if the law has no such series.
pub(super) fn expand_alone(model: &Model<'_>, series: &mut Series, [i, c]: [usize; 2]) -> bool {
    let Some(law) = model.contacts[c].law.dry_slip() else {
        return false;
    };
    let Series {
        coordinates,
        contacts,
        expander,
        ..
    } = series;
    let pull = |springs: &[(usize, f64)], coordinates: &[CoordinateSeries], order: usize| {
        let terms = springs.iter();
        let terms = terms.map(|&(j, a)| a * coordinates[j].motion.displacement(order));
        terms.sum::<f64>()
    };
    let side = contacts[c].side;
    let (spring, springs) = model.stiffness.row(i);
    let (damping, dampers) = model.damping.row(i);
    let braking = dampers.iter();
    let braking = braking.map(|&(j, a)| a * coordinates[j].motion.velocity(0));
    let held = pull(springs, coordinates, 0) + braking.sum::<f64>();
    let equation = Equation {
        stiffness: spring,
        damping,
        load: contacts[c].load[0],
        belt: side * contacts[c].surface[0],
        pull: side * (held - coordinates[i].force[0]),
        drift: side * pull(springs, coordinates, 1),
    };
    let from = SlipPoint {
        direction: side_of(side),
        displacement: coordinates[i].motion.displacement(0),
        speed: contacts[c].speeds[0],
        rate: contacts[c].rate,
    };
    let expanded = law.expand_slip(Expansion {
        expander,
        piece: contacts[c].piece,
        equation: &equation,
        from: &from,
        time: Time::Forward,
        along: None,
    });
    if expanded.is_err() {
        return false;
    }
    let found = &expander.series;
    let of = &mut contacts[c];
    (of.speeds, of.friction, of.slope) = (found.speed, found.friction, found.slope);
    for series in &mut of.memories {
        let memory = series[0];
        *series = PowerSeries::ZERO;
        series[0] = memory;
    }
    coordinates[i].motion.follow(side, &found.speed);
    for j in 0..model.len() {
        let Role::Held(c) = coordinates[j].role else {
            continue;
        };
        let carried = &mut contacts[c].carried;
        let entry = |(_, beside): (f64, &[(usize, f64)])| {
            let place = beside.binary_search_by_key(&i, |&(column, _)| column);
            place.map_or(0.0, |place| beside[place].1)
        };
        let (spring, damper) = (entry(model.stiffness.row(j)), entry(model.damping.row(j)));
        // From the series as it was found: a copy would have to be waited for.
        for k in 2..ALL {
            let velocity = side * found.speed[k];
            let displacement = side * found.speed[k - 1] * INTEGRAL[k - 1];
            carried[k] = -spring * displacement - damper * velocity;
        }
        let (spring, springs) = model.stiffness.row(j);
        let own = spring * coordinates[j].motion.displacement(1);
        carried[1] = -damper * (side * found.speed[1]) - own - pull(springs, coordinates, 1);
    }
    true
}

/// The coordinate that slips under a constant load, without a drive, while all others are held, and
/// its contact.
pub(super) fn slips_alone(model: &Model<'_>, series: &Series) -> Option<[usize; 2]> {
    let mut found = None;
    for (i, coordinate) in series.coordinates.iter().enumerate() {
        if let Role::Held(_) = coordinate.role {
            continue;
        }
        let c = model.owner[i].filter(|_| found.is_none())?;
        let of = &series.contacts[c];
        if of.mode != StepMode::Slip || of.load_varies || model.is_driven[i] {
            return None;
        }
        found = Some([i, c]);
    }
    found
}
