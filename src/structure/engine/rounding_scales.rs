//! The sizes of the terms of the equations of motion: rounding errors are in proportion to them.

use super::model::Model;
use super::series::Series;
use super::state::{Phase, Situation};

/// Sum of the sizes of all terms of the acceleration of a coordinate.
pub(super) fn terms(model: &Model<'_>, situation: &Situation, series: &Series, i: usize) -> f64 {
    let (spring, springs) = model.stiffness.row(i);
    let (damper, dampers) = model.damping.row(i);
    let motion = |j: usize| &series.coordinates[j].motion;
    let surface = model.owner[i].map_or(0.0, |c| match situation.contacts[c].phase {
        Phase::Open => 0.0,
        Phase::Stick { .. } | Phase::Slip { .. } => series.contacts[c].surface[1].abs(),
    });
    let mut sum = series.coordinates[i].force[0].abs()
        + surface
        + (spring * motion(i).displacement(0)).abs()
        + (damper * motion(i).velocity(0)).abs();
    for &(j, a) in springs {
        sum += (a * motion(j).displacement(0)).abs();
    }
    for &(j, a) in dampers {
        sum += (a * motion(j).velocity(0)).abs();
    }
    sum + spring_size(model, series, i)
}

/// Sum of the sizes of all terms of a contact's relative acceleration, without the forces of
/// contacts.
pub(super) fn contact_terms(
    model: &Model<'_>,
    situation: &Situation,
    series: &Series,
    c: usize,
) -> f64 {
    let contact = &model.contacts[c];
    // If a contact has its own coordinate, the terms of the coordinate already include its surface.
    let of_surface = match model.owner_of(c) {
        Some(_) => 0.0,
        None => series.contacts[c].surface[1].abs(),
    };
    contact.size_along(|j| terms(model, situation, series, j)) + of_surface
}

/// Sum of the sizes of all terms of the load of a contact.
pub(super) fn load_terms(
    model: &Model<'_>,
    situation: &Situation,
    series: &Series,
    c: usize,
) -> f64 {
    let contact = &model.contacts[c];
    let linear = contact.load_size(|j| situation.coordinates[j].displacement);
    let laws = std::iter::zip(
        model.load_laws(c),
        &series.elements[contact.load_laws.clone()],
    );
    let size = laws.fold(linear, |sum, (law, of)| sum + of.size(law, 0));
    size * contact.compliance
}

/// Size of the force of all springs on a coordinate at the start, for rounding errors.
fn spring_size(model: &Model<'_>, series: &Series, coordinate: usize) -> f64 {
    let place = model.sprung.binary_search(&coordinate);
    place.map_or(0.0, |place| series.spring_sizes[place])
}
