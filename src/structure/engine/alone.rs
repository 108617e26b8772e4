//! The series of a coordinate that slips while all other coordinates are held at constant
//! velocities. Its equation is that of a mass on a belt, so its series is computed by the same
//! code.

use super::ALL;
use super::edge::side_of;
use super::model::Model;
use super::series::{CoordinateSeries, Role, Series};
use crate::clock::Time;
use crate::friction::slip::{Equation, Expansion, SlipPoint};

/// All orders after the first, of the coordinate and the contact that slip alone; returns false if
/// the law has no such series.
pub(super) fn expand_alone(model: &Model<'_>, series: &mut Series, [i, c]: [usize; 2]) -> bool {
    let Some(law) = model.contacts[c].law.dry() else {
        return false;
    };
    let Series {
        coordinates,
        contacts,
        expander,
        ..
    } = series;
    // Of order 1.
    let pull = |springs: &[(usize, f64)], coordinates: &[CoordinateSeries]| -> f64 {
        let terms = springs.iter();
        let terms = terms.map(|&(j, a)| a * coordinates[j].course.displacement(1));
        terms.sum()
    };
    let side = contacts[c].side;
    let (spring, springs) = model.stiffness.row(i);
    let equation = Equation {
        stiffness: spring,
        damping: model.damping.row(i).0,
        load: contacts[c].load[0],
        belt: side * contacts[c].surface[0],
        drift: side * pull(springs, coordinates),
    };
    let from = SlipPoint {
        direction: side_of(side),
        displacement: coordinates[i].course.displacement(0),
        speed: contacts[c].speeds[0],
        rate: Some(contacts[c].speeds[1]),
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
    let of = &mut contacts[c];
    (of.speeds, of.friction) = (expander.series.speed, expander.series.friction);
    for k in 1..=ALL {
        let velocity = side * of.speeds[k];
        coordinates[i].course.set_velocity(k, velocity);
    }
    for j in 0..model.len() {
        let (Role::Held(c) | Role::Slips(c)) = coordinates[j].role else {
            continue;
        };
        let carried = &mut contacts[c].carried;
        let entry = |(diagonal, beside): (f64, &[(usize, f64)])| {
            if i == j {
                return diagonal;
            }
            let place = beside.binary_search_by_key(&i, |&(column, _)| column);
            place.map_or(0.0, |place| beside[place].1)
        };
        let (spring, damper) = (entry(model.stiffness.row(j)), entry(model.damping.row(j)));
        let course = &coordinates[i].course;
        for k in 1..ALL {
            carried[k] = -spring * course.displacement(k) - damper * course.velocity(k);
        }
        let (spring, springs) = model.stiffness.row(j);
        let own = spring * coordinates[j].course.displacement(1);
        carried[1] = -damper * course.velocity(1) - own - pull(springs, coordinates);
    }
    true
}

/// The coordinate that slips while all others are held, and its contact.
pub(super) fn slips_alone(series: &Series) -> Option<[usize; 2]> {
    let mut found = None;
    for (i, coordinate) in series.coordinates.iter().enumerate() {
        match coordinate.role {
            Role::Held(_) => {}
            Role::Slips(c) if found.is_none() => found = Some([i, c]),
            _ => return None,
        }
    }
    found
}
