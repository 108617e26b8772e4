//! Contacts that never slip. Each of them makes a periodic motion a member of a continuous family.

use nalgebra::DVector;

use super::multipliers::DEPENDENT;
use super::type_erased_system::GeneralForm;
use crate::motion::{Mode, Segment};
use crate::state::Direction;
use crate::state::structure::State;
use crate::structure::Step;

/// A contact that never slips has b·δq = 0, or δT = k_t b·δq if it is elastic. One entry of a
/// perturbation therefore follows from displacements that do not themselves follow from another
/// such contact.
#[derive(Debug, Clone)]
pub(super) struct Unslipped {
    pub(super) contact: usize,
    /// The number that follows: a displacement, or T.
    pub(super) row: usize,
    /// Derivatives of this number by the displacements.
    pub(super) slopes: Vec<(usize, f64)>,
}

/// The steps that last.
fn lasting(steps: &[Step]) -> impl Iterator<Item = &Step> {
    steps.iter().filter(|step| step.duration() > 0.0)
}

/// Returns true for a contact that sticks in all of these steps.
pub(super) fn never_slips(steps: &[Step]) -> impl Fn(usize) -> bool {
    move |c| lasting(steps).all(|step| step.modes()[c] == Mode::Stick)
}

/// The first contact of some that slips in these steps, and the direction, if it slips in this
/// direction only.
pub(super) fn slips_one_way(
    steps: &[Step],
    of: impl Fn(usize) -> bool,
) -> Option<(usize, Direction)> {
    let mut slips = lasting(steps).flat_map(|step| {
        let modes = step.modes().iter().enumerate();
        modes.filter_map(|(c, mode)| match mode {
            Mode::Slip(direction) if of(c) => Some((c, *direction)),
            _ => None,
        })
    });
    let (contact, direction) = slips.next()?;
    let turns_back = slips.any(|(c, to)| c == contact && to != direction);
    (!turns_back).then_some((contact, direction))
}

/// Contacts that stick in all of these steps to surfaces that return to their positions. Each rigid
/// contact determines one displacement, the one with the largest coefficient; one whose direction
/// depends on those before it none, and it is left out. Elastic contacts come last, because they
/// determine no displacement.
pub(super) fn unslipped(
    form: &GeneralForm<'_>,
    steps: &[Step],
    [start, end]: [&State; 2],
) -> Vec<Unslipped> {
    /// The apparent displacement, in parts of the displacements, of a surface that comes back.
    const ROUNDING: f64 = 1e-9;
    let never_slips = never_slips(steps);
    let comes_back = |c: &usize| {
        let contact = &form.model.contacts[*c];
        let [from, to] = [start, end].map(|state| &state.displacements);
        let size = contact.size_along(|j| from[j].abs().max(to[j].abs()));
        contact.along(|j| to[j] - from[j]).abs() <= ROUNDING * size
    };
    let (held, elastic): (Vec<usize>, Vec<usize>) = (0..form.contacts())
        .filter(|&c| never_slips(c))
        .partition(|&c| form.holds(c));
    let held = held.into_iter().filter(comes_back);
    let mut unslipped: Vec<Unslipped> = Vec::new();
    let along = |contact: usize, unslipped: &[Unslipped]| {
        let mut row = DVector::zeros(form.len());
        for &(j, b) in form.model.contacts[contact].direction.iter() {
            row[j] = b;
        }
        for known in unslipped {
            let share = std::mem::replace(&mut row[known.row], 0.0);
            known.slopes.iter().for_each(|&(j, k)| row[j] += share * k);
        }
        row
    };
    let entries = |row: &DVector<f64>, factor: f64| -> Vec<(usize, f64)> {
        let row = row.iter().enumerate().filter(|(_, x)| **x != 0.0);
        row.map(|(j, x)| (j, factor * x)).collect()
    };
    for contact in held {
        let mut direction = along(contact, &unslipped);
        let row = direction.icamax();
        let share = std::mem::replace(&mut direction[row], 0.0);
        let own = form.model.contacts[contact].direction.iter();
        if share.abs() <= DEPENDENT * own.fold(0.0, |most, &(_, b)| f64::max(most, b.abs())) {
            continue;
        }
        for known in &mut unslipped {
            let place = known.slopes.iter().position(|&(j, _)| j == row);
            if let Some((_, k)) = place.map(|place| known.slopes.swap_remove(place)) {
                known.slopes.extend(entries(&direction, -k / share));
            }
        }
        let slopes = entries(&direction, -1.0 / share);
        unslipped.push(Unslipped {
            contact,
            row,
            slopes,
        });
    }
    let carried = elastic.into_iter().filter_map(|contact| {
        let stiffness = form.model.contacts[contact].tangential_stiffness?;
        Some(Unslipped {
            contact,
            row: form.carried_row(contact),
            slopes: entries(&along(contact, &unslipped), stiffness),
        })
    });
    let carried: Vec<_> = carried.collect();
    unslipped.extend(carried);
    unslipped
}

/// Contacts that stick and slip, but slip in one direction only, although they return to their
/// positions, if the motion is closed up to a translation.
///
/// The length of their slip is therefore 0: the force only touches its limit, as at the border of
/// the family of motions without slip (shakedown). Rounding decides whether there are events.
pub(super) fn slip_by_rounding(
    form: &GeneralForm<'_>,
    steps: &[Step],
    translation: &DVector<f64>,
) -> Vec<usize> {
    /// The largest apparent way of a contact that returns, in parts of the way of its surface and
    /// of the displacements.
    const ROUNDING: f64 = 1e-9;
    let is_ever = |c: usize, mode: Mode| lasting(steps).any(|step| step.modes()[c] == mode);
    let may_only_touch = |&c: &usize| {
        is_ever(c, Mode::Stick)
            && !is_ever(c, Mode::Open)
            && slips_one_way(steps, |of| of == c).is_some()
    };
    let comes_back = |c: &usize| {
        let contact = &form.model.contacts[*c];
        let surface = &contact.belt_velocity;
        let moved = lasting(steps)
            .map(|step| surface.integral(step.clock(), step.clock().after(step.duration())));
        let [moved, way] = moved.fold([0.0, 0.0], |[sum, way], x| [sum + x, way + f64::abs(x)]);
        let states =
            lasting(steps).map(|step| contact.size_along(|j| step.state().displacements[j]));
        let size = states.fold(way, f64::max);
        (contact.along(|j| translation[j]) - moved).abs() <= ROUNDING * size
    };
    let contacts = (0..form.contacts()).filter(may_only_touch);
    contacts.filter(comes_back).collect()
}
