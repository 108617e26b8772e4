//! The check of a start.

use super::contact_data::ContactData;
use super::model::Model;
use crate::error::Error;
use crate::state::structure::State;

/// Checks the sizes and the numbers of a start.
pub(in crate::structure) fn check_start(
    model: &Model<'_>,
    time: f64,
    start: &State,
) -> Result<(), Error> {
    check_sizes(model, start)?;
    let coordinates = std::iter::zip(&start.displacements, &start.velocities);
    for (&displacement, &velocity) in coordinates {
        if !(displacement.is_finite() && velocity.is_finite()) {
            return Err(Error::InvalidState {
                displacement,
                velocity,
            });
        }
    }
    for &(contact, relative_velocity) in start.sliding() {
        let is_rigid = model
            .contacts
            .get(contact)
            .is_some_and(|contact| !contact.is_elastic());
        let allowed = "a contact of the structure that is not elastic";
        Error::check(
            "State",
            "contact of sliding",
            contact as f64,
            is_rigid,
            allowed,
        )?;
        Error::check("State", "sliding", relative_velocity, true, "any size")?;
    }
    if !start
        .sliding()
        .is_sorted_by(|(one, _), (other, _)| one < other)
    {
        let contacts = start.sliding().iter().map(|&(contact, _)| contact as f64);
        let contact = contacts.fold(f64::NAN, f64::max);
        let allowed = "contacts in ascending order; use `with_sliding`";
        Error::check("State", "contact of sliding", contact, false, allowed)?;
    }
    for &value in &start.memory {
        Error::check("Structure", "memory", value, true, "any size")?;
    }
    if !start.memory.is_empty() {
        for (c, contact) in model.contacts.iter().enumerate() {
            if contact.is_elastic() {
                check_carried(c, contact, time, start, start.memory[model.memory(c).start])?;
                continue;
            }
            let memory = &start.memory[model.memory(c)];
            let limits = contact.law.limits(&|j| memory[j]).into_iter().flatten();
            for limit in limits.filter(|limit| *limit != f64::INFINITY) {
                let allowed = "a memory at the start with which static_coefficient ≥ 0";
                let is_allowed = limit >= 0.0;
                Error::check(
                    "Structure",
                    "static_coefficient",
                    limit,
                    is_allowed,
                    allowed,
                )?;
            }
        }
    }
    Ok(())
}

/// Checks the sizes of a start.
pub(crate) fn check_sizes(model: &Model<'_>, start: &State) -> Result<(), Error> {
    let n = model.len();
    let memory = model.remembered();
    let sizes = [
        ("displacements", start.displacements.len(), n),
        ("velocities", start.velocities.len(), n),
    ];
    let remembered = start.memory.len();
    let memory = (remembered > 0).then_some(("memory", remembered, memory));
    for (name, found, expected) in sizes.into_iter().chain(memory) {
        if found != expected {
            return Err(Error::WrongSize {
                name,
                found,
                expected,
            });
        }
    }
    Ok(())
}

/// Checks that an elastic contact can carry its force at a start. Where its load jumps, it may
/// carry what it could before. A motion begins with the limit itself if the force is hardly above
/// it: a state after many periods of a drive is a start at time 0, where the drive differs by
/// rounding of the time.
fn check_carried(
    c: usize,
    contact: &ContactData<'_>,
    time: f64,
    start: &State,
    carried: f64,
) -> Result<(), Error> {
    const ROUNDING: f64 = 1e-12;
    let displacement = |j: usize| start.displacements[j];
    let mut limit = contact.limit_at(time, displacement);
    if contact.load.jumps_at(time) {
        limit = limit.max(contact.limit_before(time, displacement));
    }
    let rounding = ROUNDING * contact.constant_coefficient() * contact.load_size(displacement);
    if carried.abs() <= limit + rounding {
        return Ok(());
    }
    Err(Error::OverLimit {
        contact: c,
        carried,
        limit,
    })
}
