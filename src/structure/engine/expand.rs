//! The power series of all coordinates about one time, order by order.

use std::ops::Range;

use super::alone::{expand_alone, slips_alone};
use super::contact::ContactData;
use super::edge::Edge;
use super::factor::Holding;
use super::groups::expand_groups;
use super::model::{Model, Target};
use super::series::{
    ContactCourse, ContactSeries, CoordinateSeries, DisplacementSeries, Role, Series,
};
use super::springs::spring_order;
use super::state::{Phase, Situation};
use crate::error::{Error, Reached};
use crate::friction::memory::Slip;
use crate::friction::memory::object::MemoryOrder;
use crate::scalar::mul_add;
use crate::series::{INTEGRAL, PowerSeries, TERMS};

/// A law that returns NaN, an infinity or no series.
#[derive(Debug, Clone, Copy)]
pub(super) enum LawFault {
    NonFinite { speed: f64, value: f64 },
    NotAnalytic { speed: f64 },
}

impl LawFault {
    /// The error for it.
    pub(super) fn at(self, reached: Reached) -> Error {
        let reached = Some(reached);
        match self {
            Self::NonFinite { speed, value } => Error::NonFiniteFriction {
                speed,
                value,
                reached,
            },
            Self::NotAnalytic { speed } => Error::NotAnalytic { speed, reached },
        }
    }
}

/// The series of every drive that varies, from the time of the clock on.
pub(super) fn expand_drives(model: &Model<'_>, situation: &Situation, series: &mut Series) {
    let clock = situation.clock;
    let mut forces_vary = false;
    for &target in &model.varying {
        match target {
            Target::Force(_) => forces_vary = true,
            Target::Surface(c) => {
                series.contacts[c].surface = model.drive(target).series(clock);
            }
            // With its part from displacements, order by order.
            Target::Load(c) => {
                let load = model.drive(target).series(clock);
                let contact = &mut series.contacts[c];
                contact.load = load.scaled(model.contacts[c].compliance);
                contact.drive_load = contact.load;
            }
        }
    }
    if !forces_vary {
        return;
    }
    for (i, coordinate) in series.coordinates.iter_mut().enumerate() {
        if !model.is_driven[i] {
            continue;
        }
        let (diagonal, beside) = model.inverse_mass.row(i);
        let own = &model.forces[i];
        coordinate.force = if own.is_constant() {
            let mut constant = PowerSeries::ZERO;
            constant[0] = own.value(0.0) * diagonal;
            constant
        } else {
            own.series(clock).scaled(diagonal)
        };
        for &(j, a) in beside {
            let force = model.forces[j].series(clock);
            coordinate.force.add(a, &force);
        }
    }
    for (given, &j) in std::iter::zip(&mut series.given, &model.sprung) {
        *given = series.coordinates[j].force;
    }
}

/// The first `orders` orders of all series, [`ALL`] of them or fewer. Order by order, of every
/// coordinate: first the law of its contact, from the sliding speed of that order; then the forces,
/// which give the velocity of the next.
///
/// Order k of a coordinate needs only order k of the coordinates that act on it. Where masses act
/// on near ones alone, a group of masses is therefore expanded to the last order before the next
/// group is begun: the data of a group stay in the processor's nearest memory. With every order the
/// group is shifted to masses whose neighbours are complete. Contacts that share coordinates, and
/// springs of contacts, couple all masses: each order is then computed for all masses at once.
///
/// What is simple is computed faster, to rounding the same: a coordinate that slips while all
/// others are held in `alone.rs`, several in `groups.rs`.
///
/// # Errors
///
/// The first law that gave no number, or no slope.
pub(super) fn expand(
    model: &Model<'_>,
    situation: &Situation,
    series: &mut Series,
    orders: usize,
) -> Result<(), LawFault> {
    if orders < ALL {
        // Orders that are not computed now must not keep those of the step before.
        for of in &mut series.contacts {
            (of.speeds, of.carried, of.bound) =
                (PowerSeries::ZERO, PowerSeries::ZERO, PowerSeries::ZERO);
            if of.load_varies {
                of.load = PowerSeries::ZERO;
            }
        }
    }
    start(model, situation, series);
    all_orders(model, situation, series, 0..orders);
    law_fault(situation, series).map_or(Ok(()), Err)
}

/// All orders that come after the first ones, which [`expand`] has found.
pub(super) fn expand_further(
    model: &Model<'_>,
    situation: &Situation,
    series: &mut Series,
    first: usize,
) {
    all_orders(model, situation, series, first..ALL);
}

fn all_orders(model: &Model<'_>, situation: &Situation, series: &mut Series, orders: Range<usize>) {
    let n = model.len();
    if orders.end == ALL && is_simple(model, series) {
        if orders.start == 0 {
            all_of(model, series, 0..1, 0..n);
        }
        let alone = slips_alone(series);
        if !alone.is_some_and(|alone| expand_alone(model, series, alone)) {
            expand_groups(model, series);
        }
        return;
    }
    if model.shared.is_empty() && model.springs.is_empty() {
        in_waves([n, AT_A_TIME, model.bandwidth], orders, |coordinates, k| {
            all_of(model, series, k..k + 1, coordinates);
        });
    } else {
        let is_delicate = is_delicate(model, situation);
        for k in orders {
            if k > 0 {
                spring_order(model, series, k);
            }
            all_of(model, series, k..k + 1, 0..n);
            shared_order(model, situation, series, k, is_delicate);
        }
    }
}

/// True if all coordinates are held, are free, or slip on contacts of their own, which have
/// constant loads and laws without memory.
fn is_simple(model: &Model<'_>, series: &Series) -> bool {
    model.shared.is_empty()
        && model.springs.is_empty()
        && series
            .contacts
            .iter()
            .all(|of| of.memories.is_empty() && !of.load_varies && of.course != ContactCourse::Open)
}

/// Number of masses of a long chain in a group.
const AT_A_TIME: usize = 16;

/// Calls `expand` for all places below `count` and all orders: group by group, if there are more
/// than `at_a_time`. An order of a place needs those before of the places within `shift`.
#[inline(always)]
pub(super) fn in_waves(
    [count, at_a_time, shift]: [usize; 3],
    orders: Range<usize>,
    mut expand: impl FnMut(Range<usize>, usize),
) {
    let (at_a_time, shift) = if count <= at_a_time {
        (count.max(1), 0)
    } else {
        (at_a_time, shift)
    };
    for start in (0..count + orders.len() * shift).step_by(at_a_time) {
        for k in orders.clone() {
            let behind = (k - orders.start) * shift;
            let place = |i: usize| i.saturating_sub(behind).min(count);
            expand(place(start)..place(start + at_a_time), k);
        }
    }
}

/// All orders that a step has.
pub(super) const ALL: usize = TERMS - 1;

fn law_fault(situation: &Situation, series: &Series) -> Option<LawFault> {
    let contacts = std::iter::zip(&situation.contacts, &series.contacts);
    contacts.into_iter().find_map(|(state, series)| {
        let Phase::Slip { speed, .. } = state.phase else {
            return None;
        };
        let value = series.friction[0];
        if !value.is_finite() {
            Some(LawFault::NonFinite { speed, value })
        } else if !series.friction[1].is_finite() && series.speeds[1].is_finite() {
            Some(LawFault::NotAnalytic { speed })
        } else {
            None
        }
    })
}

/// Order 0 of the unknowns, and the mode of every contact.
pub(super) fn start(model: &Model<'_>, situation: &Situation, series: &mut Series) {
    for i in 0..model.len() {
        let velocity = situation.velocity(model, series, i);
        let displacement = situation.coordinates[i].displacement;
        let role = role(model, situation, series, i);
        let coordinate = &mut series.coordinates[i];
        if let (Role::Held(c), true) = (role, role != coordinate.role) {
            // These series are not computed again.
            coordinate.course = DisplacementSeries::ZERO;
            let of = &mut series.contacts[c];
            (of.speeds, of.bound) = (PowerSeries::ZERO, PowerSeries::ZERO);
        }
        coordinate.role = role;
        coordinate.course.start(displacement, velocity);
    }
    for (of, state) in std::iter::zip(&mut series.contacts, &situation.contacts) {
        (of.rate, of.limit) = (None, state.static_coefficient());
        (of.course, of.side, of.speeds[0]) = match state.phase {
            Phase::Open => (ContactCourse::Open, 1.0, 0.0),
            Phase::Stick { .. } => (ContactCourse::Stick, 0.0, 0.0),
            Phase::Slip {
                direction,
                speed,
                rate,
                piece,
            } => {
                (of.piece, of.rate) = (piece, rate);
                (ContactCourse::Slip, direction.sign(), speed)
            }
        };
        if of.course != ContactCourse::Open && of.relaxation == 0.0 {
            for (series, memory) in std::iter::zip(&mut of.memories, &state.memory) {
                series[0] = *memory;
            }
        }
    }
    spring_order(model, series, 0);
}

/// The role of a coordinate in the step that begins.
fn role(model: &Model<'_>, situation: &Situation, series: &Series, i: usize) -> Role {
    let Some(c) = model.owner[i] else {
        return if model.is_driven[i] {
            Role::Other
        } else {
            Role::Free
        };
    };
    let of = &series.contacts[c];
    let is_simple = of.memories.is_empty() && !of.load_varies && !model.is_driven[i];
    match situation.contacts[c].phase {
        Phase::Stick { .. } if is_simple => Role::Held(c),
        Phase::Slip { .. } if is_simple => Role::Slips(c),
        _ => Role::Other,
    }
}

/// Orders k + 1 of the velocities of some coordinates, without what shared contacts do to them.
pub(super) fn all_of(
    model: &Model<'_>,
    series: &mut Series,
    orders: Range<usize>,
    range: Range<usize>,
) {
    let nothing = &mut MemoryOrder::none();
    // Tells the compiler which coefficients there are.
    #[expect(clippy::needless_range_loop, reason = "k is the order of all series")]
    for k in orders.start..orders.end.min(ALL) {
        for i in range.clone() {
            let (coordinates, contacts) = (&mut series.coordinates[..], &mut series.contacts);
            let rate = free_rate(model, coordinates, i, k);
            let coordinate = &mut coordinates[i];
            match coordinate.role {
                Role::Held(c) if k > 0 => contacts[c].carried[k] = rate,
                Role::Slips(c) if k > 0 => {
                    let of = &mut contacts[c];
                    of.carried[k] = rate;
                    let friction = of.load[0] * of.law_order(&model.contacts[c], k, nothing);
                    let speed = (of.side * rate - friction) * INTEGRAL[k];
                    of.speeds[k + 1] = speed;
                    coordinate.course.set_velocity(k + 1, of.side * speed);
                }
                _ => order(model, series, k, i, rate),
            }
        }
    }
}

/// The same for a coordinate that may do anything.
#[inline(never)]
fn order(model: &Model<'_>, series: &mut Series, k: usize, i: usize, rate: f64) {
    let Series {
        coordinates,
        contacts,
        rates,
        ..
    } = series;
    let is_driven = model.is_driven[i];
    let given = if is_driven || k == 0 {
        coordinates[i].force[k]
    } else {
        0.0
    };
    let velocity = match model.owner[i] {
        None => {
            rates[i] = rate + given;
            rates[i] * INTEGRAL[k]
        }
        Some(c) => {
            let (contact, of) = (&model.contacts[c], &mut contacts[c]);
            if of.load_varies {
                of.load_order(contact, coordinates, k);
            }
            let surface = if is_driven && of.course != ContactCourse::Open {
                of.surface[k + 1]
            } else {
                0.0
            };
            of.carried[k] = rate + (given - (k + 1) as f64 * surface);
            of.order(contact, k, surface)
        }
    };
    coordinates[i].course.set_velocity(k + 1, velocity);
}

/// (−M⁻¹K q − M⁻¹C v)_i of order k, the newest of the coordinate.
#[inline(always)]
fn free_rate(model: &Model<'_>, coordinates: &[CoordinateSeries], i: usize, k: usize) -> f64 {
    let course = |j: usize| &coordinates[j].course;
    let own = [course(i).displacement(k), course(i).newest_velocity()];
    let displacement = |j: usize| course(j).displacement(k);
    let velocity = |j: usize| course(j).velocity(k);
    model.linear.minus_products(i, own, displacement, velocity)
}

/// Contribution of shared contacts to order k + 1 of the velocities: friction of those that slip,
/// then the forces of those that stick, G_SS λ = B_S a − w'.
fn shared_order(
    model: &Model<'_>,
    situation: &Situation,
    series: &mut Series,
    k: usize,
    is_delicate: bool,
) {
    for &c in &model.shared {
        series.friction_order(model, c, k);
    }
    let holding = &situation.holding;
    series.held.clear();
    for &c in &holding.contacts {
        let pull = pull(&model.contacts[c], series, c, k);
        series.held.push(pull / model.contacts[c].compliance.sqrt());
    }
    holding.factor.solve(&mut series.held);
    if !holding.contacts.is_empty() {
        for &j in &model.shared_coordinates {
            series.unheld[j] = series.rates[j];
        }
    }
    if is_delicate {
        note_rounding(model, situation, series, k);
    }
    for (&c, &force) in std::iter::zip(&holding.contacts, &series.held) {
        let contact = &model.contacts[c];
        let carried = force * contact.compliance.sqrt();
        series.contacts[c].carried[k] = carried;
        for &(j, x) in contact.responses() {
            series.rates[j] -= x * carried;
        }
    }
    for &j in &model.shared_coordinates {
        if !holding.contacts.is_empty() {
            series.rates[j] = unless_rounding(series.rates[j], series.unheld[j]);
        }
        if is_delicate && series.rates[j].abs() <= series.rounding[j] {
            series.rates[j] = 0.0;
        }
        let velocity = series.rates[j] * INTEGRAL[k];
        series.coordinates[j].course.set_velocity(k + 1, velocity);
    }
    for &c in &model.shared {
        if let ContactCourse::Slip = series.contacts[c].course {
            let contact = &model.contacts[c];
            let mut pull = pull(contact, series, c, k);
            if is_delicate && pull.abs() <= contact.size_along(|j| series.rounding[j]) {
                pull = 0.0;
            }
            let of = &mut series.contacts[c];
            let equation = of.side * pull * INTEGRAL[k];
            of.speeds[k + 1] = of.rate.filter(|_| k == 0).unwrap_or(equation);
        }
    }
}

/// Returns true if a contact is on an edge or on a breakpoint of its law, or slip begins without an
/// acceleration: the sign of the first nonzero coefficient then decides.
fn is_delicate(model: &Model<'_>, situation: &Situation) -> bool {
    model.shared.iter().any(|&c| {
        let state = &situation.contacts[c];
        match state.phase {
            Phase::Open => false,
            Phase::Stick { .. } => state.edge != Edge::Away,
            Phase::Slip { speed, rate, .. } => {
                rate == Some(0.0) || model.contacts[c].breakpoints.contains(&speed)
            }
        }
    })
}

/// Notes the bound of rounding of order k of the accelerations, and sets forces of contacts on an
/// edge to 0 if they are rounding.
fn note_rounding(model: &Model<'_>, situation: &Situation, series: &mut Series, k: usize) {
    let mut sizes = std::mem::take(&mut series.rounding);
    for &j in &model.shared_coordinates {
        sizes[j] =
            free_size(model, &series.coordinates, j, k) + series.coordinates[j].force[k].abs();
    }
    for &c in &model.shared {
        let of = &series.contacts[c];
        if of.course == ContactCourse::Slip {
            let friction: f64 = (0..=k)
                .map(|l| (of.load[l] * of.friction[k - l]).abs())
                .sum();
            for &(j, x) in model.contacts[c].responses() {
                sizes[j] += x.abs() * friction;
            }
        }
    }
    let Holding { contacts, factor } = &situation.holding;
    let root = |c: usize| model.contacts[c].compliance.sqrt();
    let size = |&c: &usize| {
        let of_surface = (k + 1) as f64 * series.contacts[c].surface[k + 1];
        (model.contacts[c].size_along(|j| sizes[j]) + of_surface.abs()) / root(c)
    };
    let mut of_forces: Vec<f64> = contacts.iter().map(size).collect();
    factor.magnify(&mut of_forces);
    for (place, (&c, size)) in std::iter::zip(contacts, of_forces).enumerate() {
        if situation.contacts[c].edge != Edge::Away {
            series.held[place] = unless_rounding(series.held[place], size);
        }
        for &(j, x) in model.contacts[c].responses() {
            sizes[j] += x.abs() * size * root(c);
        }
    }
    for &j in &model.shared_coordinates {
        sizes[j] *= ROUNDING;
    }
    series.rounding = sizes;
}

/// The sum of the sizes of the terms of [`free_rate`].
fn free_size(model: &Model<'_>, coordinates: &[CoordinateSeries], i: usize, k: usize) -> f64 {
    let ((spring, springs), (damper, dampers)) = (model.stiffness.row(i), model.damping.row(i));
    let of_springs = springs
        .iter()
        .map(|&(j, a)| a * coordinates[j].course.displacement(k));
    let of_dampers = dampers
        .iter()
        .map(|&(j, a)| a * coordinates[j].course.velocity(k));
    let own = &coordinates[i].course;
    (damper * own.velocity(k)).abs()
        + (spring * own.displacement(k)).abs()
        + of_springs.chain(of_dampers).map(f64::abs).sum::<f64>()
}

/// The rounding error of a sum, in parts of the sizes of its terms.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// A difference, or 0 if it is the rounding of the minuend: held coordinates are at rest to the
/// bit, and their motion is no measure of anything.
pub(super) fn unless_rounding(difference: f64, from: f64) -> f64 {
    if difference.abs() <= ROUNDING * from.abs() {
        0.0
    } else {
        difference
    }
}

/// b·a − w' of order k.
fn pull(contact: &ContactData<'_>, series: &Series, c: usize, k: usize) -> f64 {
    contact.along(|j| series.rates[j]) - (k + 1) as f64 * series.contacts[c].surface[k + 1]
}

/// Notes b·a⁰ − w' of each shared contact at the start: its relative acceleration without the
/// forces of those that stick. Those that slip have their friction.
pub(super) fn free_accelerations(model: &Model<'_>, situation: &Situation, series: &mut Series) {
    start(model, situation, series);
    for &j in &model.shared_coordinates {
        let force = series.coordinates[j].force[0];
        series.rates[j] = free_rate(model, &series.coordinates, j, 0) + force;
    }
    for &c in &model.shared {
        series.friction_order(model, c, 0);
    }
    for &c in &model.shared {
        series.contacts[c].free = pull(&model.contacts[c], series, c, 0);
    }
}

impl Series {
    /// Order k of the law of a contact that shares coordinates, and the contribution of its
    /// friction in slip.
    fn friction_order(&mut self, model: &Model<'_>, c: usize, k: usize) {
        let (contact, of) = (&model.contacts[c], &mut self.contacts[c]);
        of.load_order(contact, &self.coordinates, k);
        match of.course {
            ContactCourse::Open => {}
            ContactCourse::Stick => of.stick_order(contact, k),
            ContactCourse::Slip => {
                let friction = of.side * of.slip_order(contact, k);
                for &(j, x) in contact.responses() {
                    self.rates[j] -= x * friction;
                }
            }
        }
    }
}

impl ContactSeries {
    /// Order k of a contact with a coordinate to itself, from that of all else that accelerates it
    /// against the surface, and k + 1 of the sliding speed. Returns that of the coordinate's
    /// velocity.
    fn order(&mut self, contact: &ContactData<'_>, k: usize, surface: f64) -> f64 {
        let friction = match self.course {
            ContactCourse::Open => 0.0,
            ContactCourse::Stick => {
                self.stick_order(contact, k);
                0.0
            }
            ContactCourse::Slip => self.slip_order(contact, k),
        };
        let mut speed = (self.side * self.carried[k] - friction) * INTEGRAL[k];
        if k == 0 {
            speed = self.rate.unwrap_or(speed);
        }
        self.speeds[k + 1] = speed;
        mul_add(self.side, speed, surface)
    }

    /// Coefficient k of the load.
    #[inline(always)]
    pub(super) fn load_order(
        &mut self,
        contact: &ContactData<'_>,
        coordinates: &[CoordinateSeries],
        k: usize,
    ) {
        if self.load_varies {
            let by_displacements =
                contact.displacement_load(|j| coordinates[j].course.displacement(k));
            self.load[k] = self.drive_load[k] + by_displacements * contact.compliance;
        }
    }

    /// Coefficient k of Nσμ in slip, and k + 1 of the memory; on the slow manifold k of the memory,
    /// from k + 1 of the pass before.
    fn slip_order(&mut self, contact: &ContactData<'_>, k: usize) -> f64 {
        let coefficient = if self.memories.is_empty() {
            self.law_order(contact, k, &mut MemoryOrder::none())
        } else {
            self.with_memory(contact, k)
        };
        if self.load_varies {
            (0..=k).map(|l| self.load[l] * self.friction[k - l]).sum()
        } else {
            self.load[0] * coefficient
        }
    }

    /// Coefficient k of σμ, and k + 1 of the memory, or k.
    fn with_memory(&mut self, contact: &ContactData<'_>, k: usize) -> f64 {
        if self.relaxation > 0.0 {
            // The law runs twice: for the memory, then with it.
            self.with_rates(contact, k);
            for (series, rate) in std::iter::zip(&mut self.memories, &self.rates) {
                let correction = (rate - (k + 1) as f64 * series[k + 1]) / self.relaxation;
                // A correction that only rounds to and fro would change the later coefficients for
                // ever.
                if correction.abs() > 2.0 * f64::EPSILON * series[k].abs() {
                    series[k] += correction;
                }
            }
            return self.with_rates(contact, k);
        }
        let coefficient = self.with_rates(contact, k);
        self.set_memories(k);
        coefficient
    }

    /// Coefficient k of σμ; notes that of the rates of the memory.
    fn with_rates(&mut self, contact: &ContactData<'_>, k: usize) -> f64 {
        let memories = std::mem::take(&mut self.memories);
        let mut rates = std::mem::take(&mut self.rates);
        let mut memory = MemoryOrder {
            series: &memories,
            rates: &mut rates,
        };
        let coefficient = self.law_order(contact, k, &mut memory);
        (self.memories, self.rates) = (memories, rates);
        coefficient
    }

    /// The same with the memory apart.
    #[inline(always)]
    fn law_order(
        &mut self,
        contact: &ContactData<'_>,
        k: usize,
        memory: &mut MemoryOrder<'_>,
    ) -> f64 {
        let slip = Slip {
            speed: self.speeds[k],
            direction: self.side,
            piece: self.piece,
        };
        let (coefficient, slope) = contact.law.slip_order(&mut self.tape, k, slip, memory);
        (self.friction[k], self.slope) = (coefficient, slope);
        coefficient
    }

    /// Coefficient k of the bound N μ_s in stick, and k + 1 of the memory.
    #[inline]
    fn stick_order(&mut self, contact: &ContactData<'_>, k: usize) {
        if self.memories.is_empty() {
            // μ_s is a constant.
            self.bound[k] = if k == 0 || self.load_varies {
                self.load[k] * self.limit
            } else {
                0.0
            };
            return;
        }
        let (memories, rates) = (&self.memories, &mut self.rates);
        self.limits[k] = contact.law.stick_order(&mut self.tape, k, memories, rates);
        self.bound[k] = (0..=k).map(|l| self.load[l] * self.limits[k - l]).sum();
        self.set_memories(k);
    }

    #[inline(always)]
    fn set_memories(&mut self, k: usize) {
        for (series, rate) in std::iter::zip(&mut self.memories, &self.rates) {
            series[k + 1] = rate * INTEGRAL[k];
        }
    }
}
