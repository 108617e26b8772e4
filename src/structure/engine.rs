//! One step of a structure.
//!
//! Expand, order by order, first every slipping contact's law, then every drive, then the free
//! coordinates; form the watches; take h from the last coefficients of all coordinates; find the
//! first watch to reach zero within h; check the defect of every slipping contact there and inside,
//! halve or accept; move the state there and set what the watch says to the bit (sliding speed 0,
//! or load = limit); decide the modes of the contacts whose watches fired, in their order, until
//! nothing changes; emit the step and its events in the order of the contacts.

use super::expansion::{Course, LawFault};
use super::model::Model;
use super::parts::{Body, Edge, Firing, Joint};
use super::step::Step;
use crate::clock::Clock;
use crate::error::{Error, Reached};
use crate::motion::step_control::Allowance;
use crate::motion::{Event, EventKind, Mode};
use crate::series::PowerSeries;
use crate::state::Direction;
use crate::state::structure::State;

/// A structure in motion.
#[derive(Debug, Clone)]
pub(super) struct Engine<'s> {
    pub(super) model: Model<'s>,
    pub(super) tolerance: f64,
    pub(super) clock: Clock,
    pub(super) bodies: Vec<Body>,
    pub(super) joints: Vec<Joint>,
    /// Series of all displacements.
    pub(super) courses: Vec<Course>,
    /// What a step is long or short by.
    pub(super) unit: f64,
    /// What each coordinate may leave out in the step under way.
    pub(super) allowances: Vec<Allowance>,
    /// The series of the last pass to the slow motion.
    pub(super) pass_before: Vec<PowerSeries>,
    /// Scale of each velocity, and the size of the terms of its equation.
    pub(super) scales: Vec<(f64, f64)>,
    /// Limit of the next step: twice the last one, if that had to be cut below what its
    /// coefficients promised; else none.
    pub(super) longest: f64,
    /// Steps until the slow motion of stiff memories is tried again, and how many they were the
    /// last time that it was not worth it.
    pub(super) steps_to_trial: u32,
    pub(super) pause: u32,
    /// Steps of no length, one after the other.
    idle: usize,
    /// Why the motion cannot go on.
    ending: Option<Error>,
}

/// How far the series are used.
#[derive(Debug, Clone, Copy)]
pub(super) struct Settled {
    pub(super) duration: f64,
    /// The time where pieces of a drive meet, if the step ends there.
    pub(super) at_break: Option<f64>,
}

impl<'s> Engine<'s> {
    /// The structure at its start, with the events of that very time.
    pub(super) fn start(
        model: Model<'s>,
        tolerance: f64,
        clock: Clock,
        start: &State,
    ) -> Result<(Self, Option<Step>), Error> {
        let forces = model.forces.iter().zip(&model.inverse_mass);
        let forces = forces.map(|(force, inverse_mass)| force.value(clock.time) * inverse_mass);
        let bodies = std::iter::zip(&start.displacements, &start.velocities).zip(forces);
        let mut bodies: Vec<Body> = bodies
            .map(|((&q, &v), force)| Body::new(q, v, force))
            .collect();
        for (c, contact) in model.contacts.iter().enumerate() {
            bodies[contact.coordinate].contact = Some(c);
        }
        let contacts = model.contacts.iter().enumerate();
        let joints = contacts.map(|(c, contact)| {
            let count = model.laws.memory();
            let memory = |j: usize| start.memory.get(c * count + j).copied().unwrap_or(0.0);
            let load = contact.load.value(clock.time) * model.inverse_mass[contact.coordinate];
            Joint::new(&model, c, load, (0..count).map(memory).collect())
        });
        let mut engine = Self {
            joints: joints.collect(),
            courses: vec![Course::ZERO; bodies.len()],
            bodies,
            unit: model.time_unit,
            tolerance,
            clock,
            allowances: Vec::new(),
            pass_before: Vec::with_capacity(model.len() + model.remembered()),
            model,
            scales: Vec::new(),
            longest: f64::INFINITY,
            steps_to_trial: 0,
            pause: 0,
            idle: 0,
            ending: None,
        };
        for c in 0..engine.joints.len() {
            engine.close(c);
        }
        engine.expand_drives();
        let state = engine.state();
        let before: Vec<Mode> = engine.modes();
        engine.decide()?;
        // A start beyond the band slips at once, without an event; one on its edge, growing, is a
        // release.
        let edges = engine.joints.iter().map(|joint| joint.edge != Edge::Away);
        let released: Vec<bool> = edges.collect();
        let events = engine.events(&before, &state);
        let events: Vec<_> = events
            .into_iter()
            .filter(|event| matches!(event.kind, EventKind::Release(_)) && released[event.contact])
            .collect();
        let first = (!events.is_empty()).then(|| {
            Step::new(
                clock,
                (0.0, clock),
                before,
                state.clone(),
                Vec::new(),
                events,
                state,
            )
        });
        Ok((engine, first))
    }

    /// One step; afterwards the structure stands at its end.
    pub(super) fn step(&mut self) -> Result<Step, Error> {
        if let Some(error) = self.ending.take() {
            return Err(error);
        }
        let (start, from, modes) = (self.clock, self.state(), self.modes());
        let settled = self.settle()?;
        let series = self.series();
        if settled.duration.is_infinite() {
            let end = (settled.duration, start.after(settled.duration));
            return Ok(Step::new(
                start,
                end,
                modes,
                from.clone(),
                series,
                Vec::new(),
                from,
            ));
        }
        self.idle = if settled.duration > 0.0 {
            0
        } else {
            self.idle + 1
        };
        if self.idle > 4 * (self.joints.len() + 2) {
            return Err(self.undecided());
        }
        self.land(settled);
        let end = self.state();
        let events = match self.decide() {
            Ok(()) => self.events(&modes, &end),
            // The step is good; what cannot be followed begins at its end.
            Err(error) => {
                self.ending = Some(error);
                Vec::new()
            }
        };
        let forced = events.iter().filter(|event| self.is_forced(event));
        let forced = forced.map(|event| event.contact).collect();
        let span = (settled.duration, self.clock);
        Ok(Step::new(start, span, modes, from, series, events, end).forcing(forced))
    }

    /// Whether a contact was released without its load having come to the bound: a drive jumped.
    fn is_forced(&self, event: &Event<State>) -> bool {
        matches!(event.kind, EventKind::Release(_)) && self.joints[event.contact].edge == Edge::Away
    }

    /// Where the series lead after the step's duration, and what its end says to the bit.
    fn land(&mut self, settled: Settled) {
        let h = settled.duration;
        for body in &mut self.bodies {
            body.displacement += h * body.mean_velocity(h);
            body.rate = None;
            if body.side != 0.0 {
                body.speed = body.speeds.at(h);
            }
        }
        self.clock = match settled.at_break {
            Some(time) => Clock::at(time),
            None => self.clock.after(h),
        };
        let clock = self.clock;
        for (joint, contact) in std::iter::zip(&mut self.joints, &self.model.contacts) {
            let body = &mut self.bodies[joint.body];
            for (memory, series) in std::iter::zip(&mut joint.memory, &joint.memories) {
                *memory = series.at(h);
            }
            joint.relaxation = 0.0;
            (joint.edge, joint.load_edge) = (Edge::Away, Edge::Away);
            (joint.fresh, joint.arrived_from) = (false, None);
            let is_behind = joint.direction().is_some() && body.speed <= 0.0;
            let firing = joint.firing.take().map(|(_, firing)| firing);
            match firing.or(is_behind.then_some(Firing::Arrival)) {
                None => {}
                Some(Firing::Arrival) => {
                    (body.speed, joint.fresh) = (0.0, true);
                }
                Some(Firing::Breakpoint(number, rising)) => {
                    body.speed = joint.breakpoints[number];
                    joint.piece = number + usize::from(rising);
                }
                // Behind a break they may have jumped.
                Some(Firing::Bound(_) | Firing::Load) if settled.at_break.is_some() => {}
                Some(Firing::Bound(side)) => joint.edge = Edge::On(Some(side)),
                Some(Firing::Load) => joint.load_edge = Edge::On(None),
            }
            if joint.mode == Mode::Stick {
                let (since, displacement) = joint.carried_from;
                let way = contact.belt_velocity.integral(since, clock);
                body.displacement = displacement + way;
            }
        }
        self.expand_drives();
    }

    /// The state, with what contacts remember.
    pub(super) fn state(&self) -> State {
        let mut memory = Vec::with_capacity(self.model.remembered());
        memory.extend(self.joints.iter().flat_map(|joint| &joint.memory));
        State {
            displacements: self.bodies.iter().map(|body| body.displacement).collect(),
            velocities: self.bodies.iter().map(Body::velocity).collect(),
            memory,
        }
    }

    /// What every contact does.
    pub(super) fn modes(&self) -> Vec<Mode> {
        self.joints.iter().map(|joint| joint.mode).collect()
    }

    /// Series of all velocities, then of the memory.
    fn series(&self) -> Vec<PowerSeries> {
        let mut series = Vec::with_capacity(self.bodies.len() + self.model.remembered());
        series.extend(self.courses.iter().map(Course::velocities));
        series.extend(self.joints.iter().flat_map(|joint| &joint.memories));
        series
    }

    /// What has happened between the modes before and those of now, in the order of the contacts.
    fn events(&self, before: &[Mode], state: &State) -> Vec<Event<State>> {
        let kinds = std::iter::zip(before, &self.joints).enumerate();
        let kinds = kinds.filter_map(|(contact, (&before, joint))| {
            Some((contact, kind_of(before, joint.mode)?))
        });
        let mut events = Vec::with_capacity(kinds.clone().count());
        events.extend(kinds.map(|(contact, kind)| Event {
            time: self.clock.time,
            contact,
            kind,
            state: state.clone(),
        }));
        events
    }

    pub(super) fn reached(&self) -> Reached {
        Reached::new(self.clock.time, self.state())
    }

    /// The error for a law that gave no number here.
    pub(super) fn fault(&self, fault: LawFault) -> Error {
        let reached = Some(self.reached());
        match fault {
            LawFault::NonFinite { speed, value } => Error::NonFiniteFriction {
                speed,
                value,
                reached,
            },
            LawFault::NotAnalytic { speed } => Error::NotAnalytic { speed, reached },
        }
    }

    fn undecided(&self) -> Error {
        Error::StepUnderflow {
            step: 0.0,
            reached: self.reached(),
        }
    }
}

/// The event that leads from one mode to another.
fn kind_of(before: Mode, after: Mode) -> Option<EventKind> {
    match (before, after) {
        (Mode::Open, Mode::Open) | (Mode::Stick, Mode::Stick) => None,
        (_, Mode::Open) => Some(EventKind::Open),
        (Mode::Open, _) => Some(EventKind::Close),
        (Mode::Stick, Mode::Slip(side)) => Some(EventKind::Release(side)),
        (Mode::Slip(_), Mode::Stick) => Some(EventKind::Stick),
        (Mode::Slip(from), Mode::Slip(to)) => (from != to).then_some(EventKind::Crossing(to)),
    }
}

/// The direction of slip with a sign; leading for 0.
pub(super) fn side_of(sign: f64) -> Direction {
    if sign < 0.0 {
        Direction::Lagging
    } else {
        Direction::Leading
    }
}
