//! The power series of all coordinates about one time, order by order.

use std::ops::Range;

use super::model::{ContactData, Model, Target};
use super::state::{ContactSeries, ContactState, Phase, Series, Situation};
use crate::error::{Error, Reached};
use crate::friction::memory::Slip;
use crate::scalar::mul_add;
use crate::series::{INTEGRAL, PowerSeries, TERMS};

/// A law that gives no number, or no series.
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
}

/// The first `orders` orders of all series, [`ALL`] of them or fewer. Order by order, of every
/// coordinate: first the law of its contact, from the sliding speed of that order; then the forces,
/// which give the velocity of the next.
///
/// Order k of a coordinate needs order k of those that act on it, no more. So where masses act
/// on near ones alone, some masses are brought to the last order before the next ones are
/// begun: all that one reads and writes lies in the processor's nearest memory. With every
/// order the masses in work are shifted, to those of which all neighbours are ready. Contacts that
/// share coordinates hold each other at once, so with them each order is that of all masses.
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
    let n = model.len();
    for i in 0..n {
        let velocity = situation.velocity(model, series, i);
        let displacement = situation.coordinates[i].displacement;
        series.coordinates[i].course.start(displacement, velocity);
    }
    for (contact, state) in std::iter::zip(&mut series.contacts, &situation.contacts) {
        contact.speeds[0] = match state.phase {
            Phase::Slip { speed, .. } => speed,
            Phase::Open | Phase::Stick { .. } => 0.0,
        };
    }
    if model.shared.is_empty() {
        let shift = model.bandwidth;
        for start in (0..n + orders * shift).step_by(AT_A_TIME) {
            for k in 0..orders {
                let place = |i: usize| i.saturating_sub(k * shift).min(n);
                let coordinates = place(start)..place(start + AT_A_TIME);
                order(model, situation, series, k, coordinates);
            }
        }
    } else {
        for k in 0..orders {
            order(model, situation, series, k, 0..n);
            shared_order(model, situation, series, k);
        }
    }
    law_fault(situation, series).map_or(Ok(()), Err)
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

/// Order k + 1 of the velocities of some coordinates, without what shared contacts do to them.
fn order(
    model: &Model<'_>,
    situation: &Situation,
    series: &mut Series,
    k: usize,
    range: Range<usize>,
) {
    for i in range {
        let owner = model.owner[i].map(|c| (c, &situation.contacts[c]));
        let mut slip = None;
        let mut sticks = false;
        let mut surface = 0.0;
        if let Some((c, state)) = owner {
            let contact = &mut series.contacts[c];
            contact.load_order(&model.contacts[c], &series.coordinates, k);
            match state.phase {
                Phase::Open => {}
                Phase::Slip {
                    direction, rate, ..
                } => {
                    let resistance = contact.slip_order(&model.contacts[c], state, k);
                    slip = Some((direction.sign(), rate, resistance));
                    surface = contact.surface[k + 1];
                }
                Phase::Stick { .. } => {
                    contact.stick_order(&model.contacts[c], state, k);
                    sticks = true;
                    surface = contact.surface[k + 1];
                }
            }
        }
        let mut carried = free_rate(model, &series.coordinates, i, k);
        if model.is_driven[i] {
            carried += series.coordinates[i].force[k] - (k + 1) as f64 * surface;
        } else if k == 0 {
            carried += series.coordinates[i].force[0];
        }
        if let Some((c, _)) = owner {
            series.contacts[c].carried[k] = carried;
        }
        let velocity = if let (Some((side, rate, resistance)), Some((c, _))) = (slip, owner) {
            let equation = (side * carried - resistance) * INTEGRAL[k];
            let speed = rate.filter(|_| k == 0).unwrap_or(equation);
            series.contacts[c].speeds[k + 1] = speed;
            mul_add(side, speed, surface)
        } else if sticks {
            surface
        } else {
            series.rates[i] = carried;
            carried * INTEGRAL[k]
        };
        series.coordinates[i].course.set_velocity(k + 1, velocity);
    }
}

/// (−M⁻¹K q − M⁻¹C v)_i of order k.
fn free_rate(model: &Model<'_>, coordinates: &[CoordinateSeries], i: usize, k: usize) -> f64 {
    let own = &coordinates[i].course;
    let ((spring, springs), (damper, dampers)) = (model.stiffness.row(i), model.damping.row(i));
    let mut rate = -damper * own.velocity(k) - spring * own.displacement(k);
    for &(j, a) in springs {
        rate -= a * coordinates[j].course.displacement(k);
    }
    for &(j, a) in dampers {
        rate -= a * coordinates[j].course.velocity(k);
    }
    rate
}

/// What shared contacts do to order k + 1 of the velocities: friction of those that slip, then what
/// those that stick carry, G_SS λ = B_S a − w'.
fn shared_order(model: &Model<'_>, situation: &Situation, series: &mut Series, k: usize) {
    for &c in &model.shared {
        let (contact, state) = (&model.contacts[c], &situation.contacts[c]);
        let of = &mut series.contacts[c];
        of.load_order(contact, &series.coordinates, k);
        match state.phase {
            Phase::Open => {}
            Phase::Stick { .. } => of.stick_order(contact, state, k),
            Phase::Slip { direction, .. } => {
                let friction = direction.sign() * of.slip_order(contact, state, k);
                for &(j, x) in contact.responses() {
                    series.rates[j] -= x * friction;
                }
            }
        }
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
        let velocity = series.rates[j] * INTEGRAL[k];
        series.coordinates[j].course.set_velocity(k + 1, velocity);
    }
    for &c in &model.shared {
        if let Phase::Slip {
            direction, rate, ..
        } = situation.contacts[c].phase
        {
            let equation = direction.sign() * pull(&model.contacts[c], series, c, k) * INTEGRAL[k];
            series.contacts[c].speeds[k + 1] = rate.filter(|_| k == 0).unwrap_or(equation);
        }
    }
}

/// A difference, or 0 if it is but the rounding of the number that something was taken away from:
/// what is held is at rest to the bit, and nothing is measured by how little it moves.
pub(super) fn unless_rounding(difference: f64, from: f64) -> f64 {
    const ROUNDING: f64 = 8.0 * f64::EPSILON;
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

/// b·a⁰ − w' of each shared contact at the start: its relative acceleration if none of those that
/// stick carried anything. Those that slip have their friction.
pub(super) fn free_accelerations(model: &Model<'_>, situation: &Situation, series: &mut Series) {
    let n = model.len();
    for i in 0..n {
        let velocity = situation.velocity(model, series, i);
        let displacement = situation.coordinates[i].displacement;
        series.coordinates[i].course.start(displacement, velocity);
    }
    for &j in &model.shared_coordinates {
        let force = series.coordinates[j].force[0];
        series.rates[j] = free_rate(model, &series.coordinates, j, 0) + force;
    }
    for &c in &model.shared {
        let (contact, state) = (&model.contacts[c], &situation.contacts[c]);
        let of = &mut series.contacts[c];
        of.load_order(contact, &series.coordinates, 0);
        match state.phase {
            Phase::Open => {}
            Phase::Stick { .. } => of.stick_order(contact, state, 0),
            Phase::Slip {
                direction, speed, ..
            } => {
                of.speeds[0] = speed;
                let friction = direction.sign() * of.slip_order(contact, state, 0);
                for &(j, x) in contact.responses() {
                    series.rates[j] -= x * friction;
                }
            }
        }
    }
    series.held.clear();
    for &c in &model.shared {
        let pull = pull(&model.contacts[c], series, c, 0);
        series.held.push(pull);
    }
}

/// How many masses of a long chain are brought from order to order together.
const AT_A_TIME: usize = 32;

/// The series of one displacement q: its value, then the coefficients of the velocity v = q', so
/// that number k is q_0 or k q_k.
#[derive(Debug, Clone)]
pub(super) struct Course([f64; TERMS + 1]);

impl Course {
    pub(super) const ZERO: Self = Self([0.0; TERMS + 1]);

    pub(super) fn start(&mut self, displacement: f64, velocity: f64) {
        [self.0[0], self.0[1]] = [displacement, velocity];
    }

    #[inline(always)]
    pub(super) fn displacement(&self, k: usize) -> f64 {
        const WEIGHTS: [f64; TERMS + 1] = {
            let mut weights = [1.0; TERMS + 1];
            let mut k = 1;
            while k <= TERMS {
                weights[k] = INTEGRAL[k - 1];
                k += 1;
            }
            weights
        };
        self.0[k] * WEIGHTS[k]
    }

    #[inline(always)]
    pub(super) fn velocity(&self, k: usize) -> f64 {
        self.0[k + 1]
    }

    #[inline(always)]
    fn set_velocity(&mut self, k: usize, coefficient: f64) {
        self.0[k + 1] = coefficient;
    }

    /// v(t).
    pub(super) fn at(&self, t: f64) -> f64 {
        self.velocities().at(t)
    }

    /// Whether v is constant.
    pub(super) fn is_straight(&self) -> bool {
        self.0[2..].iter().all(|&c| c == 0.0)
    }

    /// The series of v.
    pub(super) fn velocities(&self) -> PowerSeries {
        PowerSeries::from_fn(|k| self.velocity(k))
    }
}

/// The series of one coordinate.
#[derive(Debug, Clone)]
pub(super) struct CoordinateSeries {
    pub(super) course: Course,
    /// (M⁻¹f)_i.
    pub(super) force: PowerSeries,
}

impl CoordinateSeries {
    pub(super) fn new(force: PowerSeries) -> Self {
        Self {
            course: Course::ZERO,
            force,
        }
    }
}

impl ContactSeries {
    /// Coefficient k of the load.
    #[inline(always)]
    fn load_order(
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
    #[inline(always)]
    fn slip_order(&mut self, contact: &ContactData<'_>, state: &ContactState, k: usize) -> f64 {
        let Some(slip) = state.slip(self.speeds[k]) else {
            return 0.0;
        };
        let relaxes = self.relaxation > 0.0;
        if !relaxes {
            self.begin_memory(state, k);
        } else {
            // The law runs twice: for the memory, then with it.
            self.run_law(contact, slip, k);
            for (series, rate) in std::iter::zip(&mut self.memories, &self.rates) {
                series[k] += (rate - (k + 1) as f64 * series[k + 1]) / self.relaxation;
            }
        }
        let coefficient = self.run_law(contact, slip, k);
        if !relaxes {
            self.set_memories(k);
        }
        self.friction[k] = coefficient;
        if self.load_varies {
            (0..=k).map(|l| self.load[l] * self.friction[k - l]).sum()
        } else {
            self.load[0] * coefficient
        }
    }

    /// Coefficient k of σμ; notes the slope and coefficient k of the rates of the memory.
    #[inline(always)]
    fn run_law(&mut self, contact: &ContactData<'_>, slip: Slip<f64>, k: usize) -> f64 {
        let (memories, rates) = (&self.memories, &mut self.rates);
        let (coefficient, slope) = contact
            .law
            .slip_order(&mut self.tape, k, slip, memories, rates);
        self.slope = slope;
        coefficient
    }

    /// Coefficient k of the bound N μ_s in stick, and k + 1 of the memory.
    #[inline]
    fn stick_order(&mut self, contact: &ContactData<'_>, state: &ContactState, k: usize) {
        if self.memories.is_empty() {
            // μ_s is a constant.
            self.bound[k] = if k == 0 || self.load_varies {
                self.load[k] * state.static_coefficient()
            } else {
                0.0
            };
            return;
        }
        self.begin_memory(state, k);
        let (memories, rates) = (&self.memories, &mut self.rates);
        self.limits[k] = contact.law.stick_order(&mut self.tape, k, memories, rates);
        self.bound[k] = (0..=k).map(|l| self.load[l] * self.limits[k - l]).sum();
        self.set_memories(k);
    }

    fn begin_memory(&mut self, state: &ContactState, k: usize) {
        if k == 0 {
            for (series, memory) in std::iter::zip(&mut self.memories, &state.memory) {
                series[0] = *memory;
            }
        }
    }

    #[inline(always)]
    fn set_memories(&mut self, k: usize) {
        for (series, rate) in std::iter::zip(&mut self.memories, &self.rates) {
            series[k + 1] = rate * INTEGRAL[k];
        }
    }
}
