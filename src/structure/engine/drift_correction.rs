//! Coordinates that contacts share, after a step: the relative velocities of contacts are
//! integrated separately, and the velocities of the coordinates are adjusted to them.

use super::cholesky::{Pivot, ROUNDING};
use super::directions::Dependent;
use super::model::Model;
use super::series::Series;
use super::shared_contact_orders::unless_rounding;
use super::state::{Closed, Entry, Phase, Situation};
use crate::numerics::sort::sort_by;
use crate::state::Direction;

/// Contacts that come to rest because others do: r_d = Σ α_c (r_c + w_c) − w_d of a direction
/// b_d = Σ α_c b_c is 0 to the rounding of its terms. The roots of all these speeds are one, but
/// each is integrated by itself, and rounding errors of many steps separate them.
pub(super) fn arrive_with_others(model: &Model<'_>, situation: &mut Situation, series: &Series) {
    let shared = || model.shared.iter().copied();
    if !shared().any(|c| situation.contacts[c].has_arrived()) {
        return;
    }
    let mut is_covered = vec![false; model.len()];
    let resting: Vec<usize> = shared()
        .filter(|&c| situation.contacts[c].rests())
        .collect();
    for &c in &resting {
        for &(j, _) in model.contacts[c].direction.iter() {
            is_covered[j] = true;
        }
    }
    let may_depend = |&c: &usize| {
        let state = &situation.contacts[c];
        let mut direction = model.contacts[c].direction.iter();
        !state.rests() && !state.phase_is_open() && direction.all(|&(j, _)| is_covered[j])
    };
    let candidates: Vec<usize> = shared().filter(may_depend).collect();
    if candidates.is_empty() {
        return;
    }
    // A direction depends on contacts that are connected with its own coordinates alone.
    let connected = Connected::of(model, resting);
    let surface = |c: usize| series.contacts[c].surface[0];
    let size = |c: usize| {
        let along = model.contacts[c].size_along(|j| situation.coordinates[j].velocity);
        along + surface(c).abs()
    };
    let rests = |&c: &usize| {
        let holding = model.independent(connected.around(model, c), &|_| 0.0);
        let Some(parts) = model.dependence(c, &holding) else {
            return false;
        };
        let parts = parts.into_iter();
        let (velocity, size) = parts.fold((-surface(c), size(c)), |(sum, sizes), (d, part)| {
            (sum + part * surface(d), sizes + part.abs() * size(d))
        });
        velocity.abs() <= ROUNDING * size
    };
    let arriving: Vec<usize> = candidates.into_iter().filter(rests).collect();
    for c in arriving {
        let state = &mut situation.contacts[c];
        if let Phase::Slip { speed, .. } = &mut state.phase {
            (*speed, state.entry) = (0.0, Entry::Arrived(None));
        }
    }
}

/// Contacts, grouped by the coordinates that they connect.
struct Connected {
    /// A coordinate of the same group, the same for all of them.
    roots: Vec<usize>,
    /// The contacts of a group, by that coordinate.
    contacts: Vec<Vec<usize>>,
}

impl Connected {
    fn of(model: &Model<'_>, contacts: Vec<usize>) -> Self {
        let mut near: Vec<usize> = (0..model.len()).collect();
        let root = |near: &mut [usize], mut j: usize| {
            while near[j] != j {
                near[j] = near[near[j]];
                j = near[j];
            }
            j
        };
        for &c in &contacts {
            let mut direction = model.contacts[c].direction.iter();
            let Some(&(first, _)) = direction.next() else {
                continue;
            };
            for &(j, _) in direction {
                let [a, b] = [first, j].map(|j| root(&mut near, j));
                near[a.max(b)] = a.min(b);
            }
        }
        let mut groups = Self {
            roots: (0..model.len()).map(|j| root(&mut near, j)).collect(),
            contacts: vec![Vec::new(); model.len()],
        };
        for c in contacts {
            if let Some(&(j, _)) = model.contacts[c].direction.first() {
                groups.contacts[groups.roots[j]].push(c);
            }
        }
        groups
    }

    /// The contacts of all groups to which coordinates of this contact belong.
    fn around(&self, model: &Model<'_>, contact: usize) -> Vec<usize> {
        let direction = model.contacts[contact].direction.iter();
        let mut roots: Vec<usize> = direction.map(|&(j, _)| self.roots[j]).collect();
        roots.sort_unstable();
        roots.dedup();
        let contacts = roots.iter().flat_map(|&root| &self.contacts[root]);
        contacts.copied().collect()
    }
}

/// Creeping contacts whose directions depend on those of slower ones: rounding errors of many steps
/// would separate their velocities.
fn agree(model: &Model<'_>, situation: &mut Situation, series: &Series) {
    let slips = |&c: &usize| model.is_shared(c) && situation.contacts[c].speed() > 0.0;
    let mut creeping: Vec<usize> = model.creeping.iter().copied().filter(slips).collect();
    if creeping.len() < 2 {
        return;
    }
    sort_by(&mut creeping, |&c| situation.contacts[c].speed());
    let held = situation.holding.contacts.iter().chain(&creeping);
    let holding = model.independent(held.copied().collect(), &|_| 0.0);
    creeping.retain(|c| !holding.contacts.contains(c));
    for c in creeping {
        let Some(dependent) = Dependent::on(model, &holding, c) else {
            continue;
        };
        let relative = |c: usize| situation.contacts[c].relative();
        let sum = dependent.relative(relative, |c| series.contacts[c].surface[0]);
        if let Phase::Slip {
            direction, speed, ..
        } = &mut situation.contacts[c].phase
        {
            (*direction, *speed) = (Direction::of(sum).unwrap_or(*direction), sum.abs());
        }
    }
}

/// Sets the velocities of shared coordinates from the relative velocities of their contacts, which
/// are integrated separately, and the displacements from the positions of contacts that stick. The
/// changes have the least kinetic energy. Without them rounding errors would accumulate.
pub(super) fn reconcile(model: &Model<'_>, situation: &mut Situation, series: &Series) {
    agree(model, situation, series);
    let closed = situation.closed.take();
    let has_arrived = |&c: &usize| situation.contacts[c].has_arrived();
    let closed = closed.filter(|_| !model.shared.iter().any(has_arrived));
    let closed = closed.unwrap_or_else(|| closed_contacts(model, situation));
    let velocity = |situation: &Situation, c: usize| match situation.contacts[c].phase {
        Phase::Slip {
            direction, speed, ..
        } => series.contacts[c].surface[0] + direction.sign() * speed,
        Phase::Open | Phase::Stick { .. } => series.contacts[c].surface[0],
    };
    let apart = |c: usize| {
        let along = model.contacts[c].along(|j| situation.coordinates[j].velocity);
        along - velocity(situation, c)
    };
    let carried = |c: usize| match situation.contacts[c].phase {
        Phase::Stick { since, from } => {
            let contact = &model.contacts[c];
            let way = contact.belt_velocity.integral(since, situation.clock);
            situation.displacement_along(contact) - (from + way)
        }
        Phase::Open | Phase::Slip { .. } => 0.0,
    };
    let velocities = model.corrections(&closed.holding, &apart);
    let displacements = model.corrections(&situation.holding, &carried);
    let before = |&j: &usize| (j, situation.coordinates[j].velocity);
    let before: Vec<_> = model.shared_coordinates.iter().map(before).collect();
    for (j, correction) in velocities {
        situation.coordinates[j].velocity -= correction;
    }
    for (j, before) in before {
        let velocity = &mut situation.coordinates[j].velocity;
        *velocity = unless_rounding(*velocity, before);
    }
    for (j, correction) in displacements {
        situation.coordinates[j].displacement -= correction;
    }
    hold(situation, series, &closed.pivots);
    situation.closed = Some(closed);
}

/// Sets the velocities of contacts that turn out to stick, and that were left out before because
/// they might slip. Returns false if there are none.
pub(super) fn hold_left_out(
    model: &Model<'_>,
    situation: &mut Situation,
    series: &Series,
    left_out: &[usize],
) -> bool {
    if !left_out.iter().any(|&c| situation.contacts[c].sticks()) {
        return false;
    }
    let pivots = model.pivots(&situation.holding.contacts);
    hold(situation, series, &pivots);
    true
}

/// Sets the velocities of contacts at rest to those of their surfaces, to the bit.
fn hold(situation: &mut Situation, series: &Series, pivots: &[Pivot]) {
    for pivot in pivots {
        let surface = |c: usize| series.contacts[c].surface[0];
        let velocity = pivot.velocity(surface, |j| situation.coordinates[j].velocity);
        situation.coordinates[pivot.coordinate].velocity = velocity;
    }
}

/// The shared contacts that are closed.
///
/// Only contacts that stick are satisfied exactly. The others get a small compliance, because
/// rounding errors would be magnified if their directions nearly depend on others. A contact that
/// reaches r = 0 counts as one that sticks, because it may stick from now on.
fn closed_contacts(model: &Model<'_>, situation: &Situation) -> Closed {
    const SLIDING: f64 = 1.0 / 64.0;
    const ARRIVING: f64 = 1.0 / 4096.0;
    let shared = model.shared.iter().copied();
    let contacts = shared.filter(|&c| !situation.contacts[c].phase_is_open());
    let softness = |c: usize| match &situation.contacts[c] {
        state if state.sticks() => 0.0,
        state if state.rests() => ARRIVING,
        _ => SLIDING,
    };
    let holding = model.independent(contacts.collect(), &softness);
    // Contacts that stick already come first: an arrival that depends on them adds only rounding.
    let resting = holding.contacts.iter().copied();
    let mut resting: Vec<usize> = resting.filter(|&c| situation.contacts[c].rests()).collect();
    sort_by(&mut resting, |&c| {
        f64::from(!situation.contacts[c].sticks())
    });
    // One that nearly depends on them would magnify that rounding, and may slip.
    let margin = |c: usize| match situation.contacts[c].sticks() {
        true => 0.0,
        false => -ARRIVING,
    };
    let exact = model.independent(resting.clone(), &margin).contacts;
    // Both are in the same order.
    let mut set = exact.iter().peekable();
    resting.retain(|c| set.next_if_eq(&c).is_none());
    Closed {
        holding,
        pivots: model.pivots(&exact),
        left_out: resting,
    }
}
