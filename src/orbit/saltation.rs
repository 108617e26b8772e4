//! Saltation: the jump of perturbations at events.
//!
//! An event happens where h(x, t) = 0. The motion continues from g(x), with the vector field f₊ in
//! place of f₋:
//!
//! ```text
//! δt = −∇h·δx/(∇h·f₋ + ∂h/∂t)                          how much later it happens
//! δx₊ = Dg (δx₋ + f₋ δt) + ∂g/∂t δt − f₊ δt
//! ```
//!
//! | event | h | g |
//! |---|---|---|
//! | stick | r | v = w, and what the law makes of its memory |
//! | crossing | r | nothing changes |
//! | release | σR − N μ_s | what the law makes of its memory |
//! | a load that opens or closes | N | nothing changes; rest ends with the load |
//! | a drive that jumps | a time | δt = 0; rest ends with the load |
//! | a stop whose force jumps | δ | nothing changes |
//!
//! At an event the field f jumps only in v' and z' of the contacts of this event. All other
//! perturbations are continuous. v' jumps with a load that ends, too, if stick had no limit: a
//! contact that slips in one direction only carries any force until then. Contacts that share
//! coordinates are coupled: the event of one changes v' of all these coordinates, and perhaps the
//! modes of the others, at the time at which that contact reached its limit. v' just after the
//! event is that of the next step.
//!
//! If several contacts reach their limits at one instant, each has its own δt, computed from δx₋
//! and f₋ before all of these events. This is the derivative if no event changes ∇h·δx or ∇h·f of
//! another one; otherwise the motion has other derivatives on each side.

use nalgebra::{DMatrix, RowDVector};

use super::tangent::TangentFlow;
use super::variational_equations::{Linear, load_at_end};
use crate::clock::Clock;
use crate::error::Element;
use crate::force::stop::OPEN;
use crate::friction::memory::object::LawObject;
use crate::friction::memory::{Motion, Slip};
use crate::motion::{Event, EventKind, Mode, Segment};
use crate::series::PowerSeries;
use crate::state::Direction;
use crate::state::structure::State;
use crate::structure::engine::cholesky::Holding;
use crate::structure::engine::contact_data::{ContactData, entry};
use crate::structure::{Step, Trigger};

/// A contact with its own coordinate at the time of an event; all numbers are divided by the mass.
struct Instant {
    coordinate: usize,
    /// The load N.
    load: f64,
    load_rate: f64,
    /// dr/dt just before.
    rate: f64,
    /// dR/dt just before.
    carried_rate: f64,
    memory: Vec<f64>,
}

/// Delay with which a contact reaches a limit, and the coordinates of the contacts connected with
/// it.
struct Delay {
    contacts: Vec<usize>,
    later: RowDVector<f64>,
    coordinates: Vec<bool>,
}

/// Delay with which the force of a stop jumps, and the coordinates on which it acts, directly or by
/// contacts.
struct StopJump {
    later: RowDVector<f64>,
    coordinates: Vec<bool>,
}

impl StopJump {
    fn reaches(&self, contact: &ContactData<'_>) -> bool {
        let mut along = contact.direction.iter();
        along.any(|&(j, _)| self.coordinates[j])
    }
}

/// The law of one contact, and the load N under which its memory changes.
#[derive(Clone, Copy)]
struct LawAt<'l> {
    law: &'l dyn LawObject,
    load: f64,
}

impl LawAt<'_> {
    /// μ with the sign of r, at the begin or end of slip.
    fn coefficient(self, side: Direction, memory: &[f64]) -> f64 {
        self.law.coefficient(at_zero(side), &|j| memory[j])
    }

    fn rates(self, motion: Motion<f64>, memory: &[f64]) -> Vec<f64> {
        let mut rates = vec![0.0; memory.len()];
        let take = &mut |j: usize, rate| rates[j] = rate;
        self.law.rates(motion, self.load, &|j| memory[j], take);
        rates
    }

    /// The rates of the memory at the begin or end of slip.
    fn slipping(self, side: Direction, memory: &[f64]) -> Vec<f64> {
        self.rates(Motion::Slip(at_zero(side)), memory)
    }

    fn caught(self, memory: &[f64]) -> Vec<f64> {
        let mut caught = memory.to_vec();
        self.law.caught(&mut caught);
        caught
    }

    /// The jump −f₊ + Dg f₋ + ∂g/∂t of v' by the event of a contact in a mode that reached its
    /// limit, for the load divided by the mass; 0 if it sticks, as δv is then projected out, and
    /// without a load.
    fn jump(self, mode: Mode, kind: EventKind, load: f64, memory: &[f64]) -> f64 {
        match kind {
            EventKind::Open | EventKind::Close | EventKind::Stick => 0.0,
            EventKind::Crossing(to) => {
                let side = match mode {
                    Mode::Slip(side) => side,
                    _ => Direction::Leading,
                };
                let [before, after] = [side, to].map(|side| self.coefficient(side, memory));
                load * (after - before)
            }
            EventKind::Release(to) => {
                let coefficient = self.coefficient(to, &self.caught(memory));
                let surplus = self.limit(to, memory).0 - to.sign() * coefficient;
                -to.sign() * (load * surplus).max(0.0)
            }
        }
    }

    /// μ_s against slip to a side, and its slopes over the memory.
    fn limit(self, side: Direction, memory: &[f64]) -> (f64, Vec<f64>) {
        let values = self.law.limits(&|j| memory[j]);
        let slope = |j: usize| self.law.limit_slopes(memory, j)[side.place()];
        (
            values.map_or(f64::NAN, |values| values[side.place()]),
            (0..memory.len()).map(slope).collect(),
        )
    }
}

fn at_zero(side: Direction) -> Slip<f64> {
    Slip {
        speed: 0.0,
        direction: side.sign(),
        piece: 0,
    }
}

/// The jump of the memory of a contact at an event.
struct Passage {
    /// True if the law resets the memory, as after stick or slip.
    caught: bool,
    /// The rates of the memory before and after.
    before: Vec<f64>,
    after: Vec<f64>,
}

impl Passage {
    /// The jump for a contact that was in a mode.
    fn of(law: LawAt<'_>, mode: Mode, kind: EventKind, memory: &[f64]) -> Self {
        let none = || vec![0.0; memory.len()];
        let side = match mode {
            Mode::Slip(side) => side,
            _ => Direction::Leading,
        };
        let (caught, before, after) = match kind {
            EventKind::Open => (mode == Mode::Stick, none(), none()),
            EventKind::Close => (false, none(), none()),
            EventKind::Stick => {
                let after = law.rates(Motion::Stick, &law.caught(memory));
                (true, law.slipping(side, memory), after)
            }
            EventKind::Crossing(to) => {
                let [before, after] = [side, to].map(|side| law.slipping(side, memory));
                (false, before, after)
            }
            EventKind::Release(to) => {
                let before = law.rates(Motion::Stick, memory);
                (true, before, law.slipping(to, &law.caught(memory)))
            }
        };
        Self {
            caught,
            before,
            after,
        }
    }
}

impl TangentFlow<'_> {
    /// The law of a contact at the end of a step.
    fn law(&self, step: &Step, contact: usize) -> LawAt<'_> {
        let data = &self.form.model.contacts[contact];
        LawAt {
            law: data.law,
            load: load_at_end(&self.form.model, contact, step)[0],
        }
    }

    /// The rows of the tangents for the memory of a contact.
    fn memory_rows(&self, contact: usize) -> std::ops::Range<usize> {
        let variables = self.form.model.memory(contact);
        let first = 2 * self.form.len();
        first + variables.start..first + variables.end
    }

    pub(super) fn row(&self, row: usize) -> RowDVector<f64> {
        self.tangents.row(row).into_owned()
    }

    /// Transforms the tangents at the start of the motion: the law of a contact that slips from r =
    /// 0, or is open, has reset its memory.
    pub(super) fn begin(&mut self, step: &Step) {
        self.limit_elastic(step.modes());
        let model = &self.form.model;
        for (number, contact) in model.contacts.iter().enumerate() {
            if contact.is_elastic() {
                continue;
            }
            let surface = contact.belt_velocity.at(step.clock());
            let velocity = |j: usize| self.start.velocities[j];
            let rests = step.modes()[number] == Mode::Stick;
            let time = step.start_time();
            if rests || contact.sliding_velocity(velocity, surface, time) != 0.0 {
                continue;
            }
            let variable = |j: usize| self.start.memory.get(j).copied().unwrap_or(0.0);
            let memory: Vec<f64> = model.memory(number).map(variable).collect();
            let caught = |memory: &[f64]| {
                let mut caught = memory.to_vec();
                contact.law.caught(&mut caught);
                caught
            };
            let slopes = slopes_of(&caught, &memory);
            let rows = self.memory_rows(number);
            let (first, count) = (rows.start, rows.len());
            let before = self.tangents.rows(first, count).into_owned();
            for j in 0..count {
                let mut row = self.tangents.row_mut(first + j);
                row.fill(0.0);
                for l in 0..count {
                    row += before.row(l) * slopes[(j, l)];
                }
            }
        }
    }

    /// Transforms the tangents at the events at the end of a step.
    pub(super) fn pass(&mut self, step: &Step, linear: Option<&Linear>) {
        if step.series().is_empty() {
            return;
        }
        let model = &self.form.model;
        let mut changes = Vec::new();
        let mut shared = Vec::new();
        let jumps = self.stop_jumps(step);
        for event in step.events() {
            let Some(contact) = event.contact() else {
                continue;
            };
            let data = &model.contacts[contact];
            let mut causes = jumps.iter().filter(|jump| jump.reaches(data));
            if let (EventKind::Release(_), false, Some(jump)) =
                (event.kind, data.is_elastic(), causes.next())
            {
                let memory = &event.state.memory[model.memory(contact)];
                let passage = self.passage(step, contact, event.kind, memory);
                changes.extend(self.changed_memory((step, contact), &passage, memory, &jump.later));
            } else if model.is_shared(contact) {
                shared.push((contact, event));
            } else if let Some(owned) = model.owner_of(contact) {
                changes.extend(self.changed(step, (contact, owned), event.kind));
            } else if event.kind == EventKind::Close {
                let change = self.closed(step, contact);
                changes.push((self.form.carried_row(contact), change));
            }
        }
        if let (Some(linear), false) = (linear, shared.is_empty()) {
            changes.extend(self.changed_together(step, linear, &shared));
        }
        for jump in &jumps {
            changes.extend(self.thrown(step, jump));
        }
        for (row, change) in changes {
            self.tangents.row_mut(row).copy_from(&change);
        }
        for &(contact, side) in &step.after().limited {
            self.limit_carried(contact, side.sign());
        }
    }

    /// The stops whose forces jump at the end of a step: they touch with a damper, or an adhesive
    /// stop opens.
    fn stop_jumps(&self, step: &Step) -> Vec<StopJump> {
        let model = &self.form.model;
        let velocities = || step.end_state().velocities;
        let jumps = step.events().iter().filter_map(|event| {
            let Element::Stop(number) = event.element else {
                return None;
            };
            let element = &model.stops()[number];
            let law = element.stop.filter(|law| law.damping != 0.0)?;
            let is_jump = match event.kind {
                EventKind::Close => step.stops()[number] == OPEN,
                _ => law.is_adhesive,
            };
            let rate = element.along(&|j| velocities()[j])[0];
            if !is_jump || rate == 0.0 {
                return None;
            }
            let zero = self.row(0) * 0.0;
            let direction = element.directions[0].iter();
            let position = direction.fold(zero, |sum, &(j, a)| sum + self.row(j) * a);
            let mut coordinates = vec![false; self.form.len()];
            for &(j, _) in &element.responses[0] {
                coordinates[j] = true;
            }
            for &c in &model.shared {
                let mut along = model.contacts[c].direction.iter();
                if along.any(|&(j, _)| entry(&element.responses[0], j) != 0.0) {
                    let connected = model.connected(c);
                    for (reached, connected) in std::iter::zip(&mut coordinates, connected) {
                        *reached |= connected;
                    }
                }
            }
            Some(StopJump {
                later: position * -rate.recip(),
                coordinates,
            })
        });
        jumps.collect()
    }

    /// The velocities whose rates jump with the force of a stop. A contact that has stuck and still
    /// does holds its coordinate, and the own event of a contact that comes to rest at the same
    /// instant has its own delay.
    fn thrown(&self, step: &Step, jump: &StopJump) -> Vec<(usize, RowDVector<f64>)> {
        let (model, n) = (&self.form.model, self.form.len());
        let has_own_event = |c: usize| {
            let mut events = step
                .events()
                .iter()
                .filter(|event| event.contact() == Some(c));
            match events.next() {
                None => step.modes()[c] == Mode::Stick,
                Some(event) => !matches!(event.kind, EventKind::Release(_)),
            }
        };
        let reached = (0..n).filter(|&i| jump.coordinates[i]);
        let free = reached.filter(|&i| !model.owner[i].is_some_and(has_own_event));
        let changes = free.map(|i| {
            let change = lost_acceleration(step, i);
            (n + i, self.row(n + i) + &jump.later * change)
        });
        changes.collect()
    }

    /// The rows of the tangents that change at an event of a contact with its own coordinate.
    fn changed(
        &self,
        step: &Step,
        (contact, owned): (usize, usize),
        kind: EventKind,
    ) -> Vec<(usize, RowDVector<f64>)> {
        let law = self.law(step, contact);
        let at = self.instant(step, (contact, owned));
        let velocity = self.form.len() + at.coordinate;
        let never = self.row(velocity) * 0.0;
        let jump = match (kind, step.modes()[contact]) {
            (EventKind::Open, Mode::Stick) => lost_acceleration(step, owned),
            (_, mode) => law.jump(mode, kind, at.load, &at.memory),
        };
        let later = match kind {
            EventKind::Open | EventKind::Close => self.load_later(step, contact),
            EventKind::Stick | EventKind::Crossing(_) => self.row(velocity) * -at.rate.recip(),
            EventKind::Release(_) if step.is_forced(contact) => never.clone(),
            EventKind::Release(to) => {
                let (limit, slopes) = law.limit(to, &at.memory);
                let before = law.rates(Motion::Stick, &at.memory);
                self.later((step, contact), to.sign(), (limit, &slopes, &before), &at)
            }
        };
        let mut changes = Vec::new();
        if kind == EventKind::Stick {
            changes.push((velocity, never));
        } else if jump != 0.0 {
            changes.push((velocity, self.row(velocity) + &later * jump));
        }
        let passage = self.passage(step, contact, kind, &at.memory);
        changes.extend(self.changed_memory((step, contact), &passage, &at.memory, &later));
        changes
    }

    /// The jump of the memory of a contact at an event.
    fn passage(&self, step: &Step, contact: usize, kind: EventKind, memory: &[f64]) -> Passage {
        let (law, mode) = (self.law(step, contact), step.modes()[contact]);
        let mut passage = Passage::of(law, mode, kind, memory);
        let (closed, open) = match kind {
            EventKind::Open => (&mut passage.before, &mut passage.after),
            EventKind::Close => (&mut passage.after, &mut passage.before),
            _ => return passage,
        };
        let data = &self.form.model.contacts[contact];
        let velocities = step.end_state().velocities;
        let time = step.end_time();
        let surface = data.belt_velocity.at(Clock::at(time));
        let velocity = data.sliding_velocity(|j| velocities[j], surface, time);
        let motion = match Direction::of(velocity).filter(|_| mode != Mode::Stick) {
            None => Motion::Stick,
            Some(direction) => Motion::Slip(Slip {
                speed: velocity.abs(),
                direction: direction.sign(),
                piece: data.piece_above(velocity.abs()),
            }),
        };
        *closed = law.rates(motion, memory);
        // Other memories stop with the load.
        if law.law.changes_while_open() {
            *open = match motion {
                Motion::Stick if passage.caught => {
                    law.slipping(Direction::Leading, &law.caught(memory))
                }
                Motion::Stick => law.slipping(Direction::Leading, memory),
                Motion::Slip(_) => closed.clone(),
            };
        }
        passage
    }

    /// The rows of a contact's memory that change at an event delayed by δt.
    fn changed_memory(
        &self,
        (step, contact): (&Step, usize),
        passage: &Passage,
        memory: &[f64],
        later: &RowDVector<f64>,
    ) -> Vec<(usize, RowDVector<f64>)> {
        let (law, rows) = (self.law(step, contact), self.memory_rows(contact));
        let (first, count) = (rows.start, rows.len());
        let slopes = if passage.caught {
            slopes_of(&|memory| law.caught(memory), memory)
        } else {
            DMatrix::identity(count, count)
        };
        let change = |j: usize| {
            let mut change = later * 0.0;
            let mut jump = -passage.after[j];
            for l in 0..count {
                let slope = slopes[(j, l)];
                if slope != 0.0 {
                    change += self.row(first + l) * slope;
                    jump += slope * passage.before[l];
                }
            }
            if jump != 0.0 {
                change += later * jump;
            }
            (first + j, change)
        };
        (0..count).map(change).collect()
    }

    /// The rows that change at events of contacts that share coordinates. Connected contacts have
    /// their events at the time of the first contact of them that reaches a limit, or opens in
    /// stick. If several do so at this instant, each has its own time, and the others follow the
    /// first.
    fn changed_together(
        &self,
        step: &Step,
        linear: &Linear,
        events: &[(usize, &Event<State>)],
    ) -> Vec<(usize, RowDVector<f64>)> {
        let (model, n) = (&self.form.model, self.form.len());
        let triggers = step.after().triggers.iter();
        let delays = triggers.map(|trigger| {
            let contacts: Vec<usize> = trigger.contacts().collect();
            Delay {
                later: self.triggered_later(step, linear, trigger),
                coordinates: contacts.first().map_or(Vec::new(), |&c| model.connected(c)),
                contacts,
            }
        });
        let opening = events.iter().filter(|(contact, event)| {
            event.kind == EventKind::Open && step.modes()[*contact] == Mode::Stick
        });
        let openings = opening.map(|&(contact, _)| Delay {
            later: self.load_later(step, contact),
            coordinates: model.connected(contact),
            contacts: vec![contact],
        });
        let delays: Vec<Delay> = delays.chain(openings).collect();
        let never = self.row(0) * 0.0;
        let first_on = |i: usize| match &delays[..] {
            [] => None,
            [only] => Some(only),
            several => several
                .iter()
                .find(|delay| delay.coordinates.get(i) == Some(&true)),
        };
        let mut changes = Vec::new();
        for i in 0..n {
            let jump = lost_acceleration(step, i);
            let owner = model.owner.get(i).copied().flatten();
            if owner.is_none() && jump != 0.0 {
                let later = first_on(i).map_or(&never, |delay| &delay.later);
                changes.push((n + i, self.row(n + i) + later * jump));
            }
        }
        for &(contact, event) in events {
            let data = &model.contacts[contact];
            let memory = &event.state.memory[model.memory(contact)];
            let passage = self.passage(step, contact, event.kind, memory);
            let first = data.direction.first().and_then(|&(i, _)| first_on(i));
            let own = delays
                .iter()
                .find(|delay| delay.contacts.contains(&contact));
            let later = match (event.kind, own.or(first)) {
                (EventKind::Open | EventKind::Close, _) => &self.load_later(step, contact),
                (_, delay) => delay.map_or(&never, |delay| &delay.later),
            };
            changes.extend(self.changed_memory((step, contact), &passage, memory, later));
            let (Some(own), Some(first)) = (own, first) else {
                continue;
            };
            if own.contacts == first.contacts {
                continue;
            }
            // Its own part of the jump has its own delay.
            let (law, mode) = (self.law(step, contact), step.modes()[contact]);
            let jump = law.jump(mode, event.kind, law.load * data.compliance, memory);
            let apart = &own.later - &first.later;
            for (row, change) in &mut changes {
                let part = row.checked_sub(n).map_or(0.0, |j| data.response(j));
                if part != 0.0 {
                    *change += &apart * (part * jump);
                }
            }
        }
        changes
    }

    /// The delay δt of the event that triggers other events of contacts that share coordinates.
    fn triggered_later(&self, step: &Step, linear: &Linear, trigger: &Trigger) -> RowDVector<f64> {
        let (model, n, h) = (&self.form.model, self.form.len(), step.duration());
        match trigger {
            Trigger::Rest(number) => {
                let contact = &model.contacts[*number];
                let surface = contact.belt_velocity.series(step.clock());
                let slope = |series: &PowerSeries| series.derivative().at(h);
                let rate = contact.along(|j| slope(&step.series()[j])) - slope(&surface);
                let zero = self.row(0) * 0.0;
                let direction = contact.direction.iter();
                let slip = direction.fold(zero, |sum, &(j, b)| sum + self.row(n + j) * b);
                slip * -rate.recip()
            }
            Trigger::Bound(parts, rate) => {
                let state = step.end_state();
                let mut gradient = self.row(0) * 0.0;
                for &(number, weight) in parts {
                    let contact = &model.contacts[number];
                    let law = self.law(step, number);
                    let side = Direction::of(weight).unwrap_or(Direction::Leading);
                    let memory = &state.memory[model.memory(number)];
                    let (limit, slopes) = law.limit(side, memory);
                    gradient += self.carried_gradient(step, linear, number) * weight;
                    let scale = weight.abs() * contact.compliance;
                    for &(j, a) in &contact.load_gradient {
                        gradient += self.row(j) * (-limit * a * scale);
                    }
                    self.add_load_laws(&mut gradient, step, number, -limit * scale);
                    for (row, slope) in std::iter::zip(self.memory_rows(number), slopes) {
                        gradient += self.row(row) * (-law.load * scale * slope);
                    }
                }
                gradient * -rate.recip()
            }
        }
    }

    /// The gradient of the force in stick, with all contacts that stick: ∇λ = G⁻¹ B (M⁻¹∂p),
    /// multiplied by G_cc.
    fn carried_gradient(&self, step: &Step, linear: &Linear, number: usize) -> RowDVector<f64> {
        let (model, n, h) = (&self.form.model, self.form.len(), step.duration());
        let rates = (0..n).map(|i| self.free_gradient(step, i));
        let mut rates: Vec<RowDVector<f64>> = rates.collect();
        for (c, joint) in linear.contacts.iter().enumerate() {
            let contact = &model.contacts[c];
            if joint.friction.is_empty() || contact.is_elastic() {
                continue;
            }
            let direction = contact.direction.iter();
            let slip = direction.fold(self.row(0) * 0.0, |sum, &(j, b)| sum + self.row(n + j) * b);
            let inputs = std::iter::once(slip).chain(self.memory_rows(c).map(|row| self.row(row)));
            let mut force = self.row(0) * 0.0;
            for (coefficient, input) in std::iter::zip(&joint.friction, inputs) {
                force += input * coefficient.series.at(h);
            }
            if let Some(by_load) = &joint.by_load {
                for &(j, a) in &contact.load_gradient {
                    force += self.row(j) * (a * by_load.series.at(h));
                }
                self.add_load_laws(&mut force, step, c, by_load.series.at(h));
            }
            for &(j, x) in contact.responses() {
                rates[j] -= &force * x;
            }
        }
        let Holding { contacts, factor } = &linear.holding;
        let Some(place) = contacts.iter().position(|&c| c == number) else {
            return self.row(0) * 0.0;
        };
        // Row `place` of G⁻¹B: G is symmetric.
        let root = |c: usize| model.contacts[c].compliance.sqrt();
        let mut weights = vec![0.0; contacts.len()];
        weights[place] = root(number);
        factor.solve(&mut weights);
        let mut gradient = self.row(0) * 0.0;
        for (&c, weight) in std::iter::zip(contacts, &weights) {
            for &(j, b) in model.contacts[c].direction.iter() {
                gradient += &rates[j] * (b * weight / root(c));
            }
        }
        gradient
    }

    /// The gradient of the acceleration of a coordinate without friction.
    fn free_gradient(&self, step: &Step, i: usize) -> RowDVector<f64> {
        let (model, n) = (&self.form.model, self.form.len());
        let mut gradient = self.by_springs(step, i);
        for (first, (diagonal, beside)) in [(0, model.stiffness.row(i)), (n, model.damping.row(i))]
        {
            gradient += self.row(first + i) * -diagonal;
            for &(j, a) in beside {
                gradient += self.row(first + j) * -a;
            }
        }
        gradient
    }

    /// The delay δt of a release, from h = σR − N μ_s.
    fn later(
        &self,
        (step, contact): (&Step, usize),
        sign: f64,
        (limit, slopes, rates): (f64, &[f64], &[f64]),
        at: &Instant,
    ) -> RowDVector<f64> {
        let model = &self.form.model;
        let i = at.coordinate;
        let mut gradient = self.free_gradient(step, i) * sign;
        let data = &model.contacts[contact];
        for &(j, a) in &data.load_gradient {
            gradient += self.row(j) * (-limit * a * data.compliance);
        }
        self.add_load_laws(&mut gradient, step, contact, -limit * data.compliance);
        let mut rate = sign * at.carried_rate - at.load_rate * limit;
        for (j, place) in self.memory_rows(contact).enumerate() {
            gradient += self.row(place) * (-at.load * slopes[j]);
            rate -= at.load * slopes[j] * rates[j];
        }
        gradient * -rate.recip()
    }

    /// Just before the event of a contact that owns coordinate i.
    fn instant(&self, step: &Step, (number, i): (usize, usize)) -> Instant {
        let model = &self.form.model;
        let contact = &model.contacts[number];
        let h = step.duration();
        let state = step.end_state();
        // Just before the event, with the drives of the step before.
        let slope = |series: &PowerSeries| series.derivative().at(h);
        let surface = contact.belt_velocity.series(step.clock());
        let force = model.forces[i].series(step.clock());
        let acceleration = |j: usize| slope(&step.series()[j]);
        let velocity = |j: usize| state.velocities[j];
        let own = [velocity(i), acceleration(i)];
        let carried_rate = slope(&force) * contact.compliance - slope(&surface.derivative())
            + model.restoring(i, own, velocity, acceleration)
            + self.spring_rate(step, i);
        let [load, load_rate] =
            load_at_end(model, number, step).map(|load| load * contact.compliance);
        Instant {
            coordinate: i,
            load,
            load_rate,
            rate: acceleration(i) - slope(&surface),
            carried_rate,
            memory: state.memory[model.memory(number)].to_vec(),
        }
    }
}

/// v' of a coordinate just before the events at the end of a step, minus v' just after; 0 after an
/// event that does not keep v'.
fn lost_acceleration(step: &Step, i: usize) -> f64 {
    let before = step.series()[i].derivative().at(step.duration());
    let after = step.after().rates.get(i);
    after.map_or(0.0, |after| before - after)
}

/// The slopes of a map by differences of fourth order; exact for a linear map.
fn slopes_of(map: &dyn Fn(&[f64]) -> Vec<f64>, at: &[f64]) -> DMatrix<f64> {
    /// The step: about the fifth root of ε, and a power of two.
    const PART: f64 = 1.0 / 1024.0;
    let mut slopes = DMatrix::zeros(at.len(), at.len());
    for (j, value) in at.iter().enumerate() {
        let step = if *value == 0.0 {
            PART
        } else {
            value.abs() * PART
        };
        let difference = |width: f64| {
            let [mut low, mut high] = [at.to_vec(), at.to_vec()];
            low[j] -= width;
            high[j] += width;
            let (below, above, apart) = (map(&low), map(&high), high[j] - low[j]);
            let pairs = std::iter::zip(below, above);
            pairs.map(|(a, b)| (b - a) / apart).collect::<Vec<f64>>()
        };
        let pairs = std::iter::zip(difference(step), difference(2.0 * step));
        for (i, (near, far)) in pairs.enumerate() {
            slopes[(i, j)] = near + (near - far) / 3.0;
        }
    }
    slopes
}
