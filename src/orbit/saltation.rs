//! What events do to changes of a motion.
//!
//! An event happens where h(x, t) = 0. The motion goes on from g(x), with the field f₊ in the place
//! of f₋:
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
//! | a load that opens or closes, a drive that jumps | a time | δt = 0; rest ends with the load |
//!
//! At one instant f jumps for the contacts of the events alone, in v' and z'. Where it does not,
//! the changes go on as they are.

use nalgebra::{DMatrix, RowDVector};

use super::linear::LawDerivatives;
use super::tangent::TangentFlow;
use crate::friction::memory::{Motion, Slip};
use crate::motion::{EventKind, Mode, Segment};
use crate::series::PowerSeries;
use crate::state::Direction;
use crate::structure::Step;
use crate::structure::laws::Laws;

/// A contact at the time of an event, all divided by its mass.
struct Instant {
    coordinate: usize,
    /// N.
    load: f64,
    load_rate: f64,
    /// dr/dt just before.
    rate: f64,
    /// dR/dt just before.
    carried_rate: f64,
    memory: Vec<f64>,
}

/// The law of one contact.
#[derive(Clone, Copy)]
struct LawAt<'l> {
    laws: &'l dyn Laws,
    linear: &'l dyn LawDerivatives,
    contact: usize,
}

impl LawAt<'_> {
    /// μ with the sign of r where slip begins or ends.
    fn coefficient(self, side: Direction, memory: &[f64]) -> f64 {
        self.laws
            .coefficient(self.contact, at_zero(side), &|j| memory[j])
    }

    fn rates(self, motion: Motion<f64>, memory: &[f64]) -> Vec<f64> {
        let mut rates = vec![0.0; memory.len()];
        let take = &mut |j: usize, rate| rates[j] = rate;
        self.laws.rates(self.contact, motion, &|j| memory[j], take);
        rates
    }

    /// Where slip begins or ends.
    fn slipping(self, side: Direction, memory: &[f64]) -> Vec<f64> {
        self.rates(Motion::Slip(at_zero(side)), memory)
    }

    fn caught(self, memory: &[f64]) -> Vec<f64> {
        let mut caught = memory.to_vec();
        self.laws.caught(self.contact, &mut caught);
        caught
    }

    /// μ_s and its slopes over the memory.
    fn limit(self, memory: &[f64]) -> (f64, Vec<f64>) {
        let value = self.laws.limit(self.contact, &|j| memory[j]);
        let slope = |j: usize| self.linear.limit_slope(self.contact, memory, j);
        (
            value.unwrap_or(f64::NAN),
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

impl TangentFlow<'_> {
    fn law(&self, contact: usize) -> LawAt<'_> {
        LawAt {
            laws: &*self.form.model.laws,
            linear: &*self.form.laws,
            contact,
        }
    }

    /// Takes the tangents across the start itself: a contact that slips from r = 0, or is open, has
    /// had its memory set by its law.
    pub(super) fn begin(&mut self, step: &Step) {
        let (n, count) = (self.form.len(), self.form.model.laws.memory());
        for (number, contact) in self.form.model.contacts.iter().enumerate() {
            let surface = contact.belt_velocity.at(step.clock())[0];
            let rests = step.modes()[number] == Mode::Stick;
            if rests || self.start.velocities[contact.coordinate] != surface {
                continue;
            }
            let first = 2 * n + number * count;
            let memory = |j: usize| self.start.memory.get(number * count + j).copied();
            let memory: Vec<f64> = (0..count).map(|j| memory(j).unwrap_or(0.0)).collect();
            let law = self.law(number);
            let slopes = slopes_of(&|memory| law.caught(memory), &memory);
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

    /// Takes the tangents across the events at the end of a step.
    pub(super) fn pass(&mut self, step: &Step) {
        if step.series().is_empty() {
            return;
        }
        let events = step.events().iter();
        let changes: Vec<_> = events
            .flat_map(|event| self.changed(step, event.contact, event.kind))
            .collect();
        for (row, change) in changes {
            self.tangents.row_mut(row).copy_from(&change);
        }
    }

    /// The rows of the tangents that an event changes.
    fn changed(
        &self,
        step: &Step,
        contact: usize,
        kind: EventKind,
    ) -> Vec<(usize, RowDVector<f64>)> {
        let (law, count) = (self.law(contact), self.form.model.laws.memory());
        let at = self.instant(step, contact);
        let n = self.form.len();
        let velocity = n + at.coordinate;
        let row = |row: usize| -> RowDVector<f64> { self.tangents.row(row).into_owned() };
        let side = match step.modes()[contact] {
            Mode::Slip(side) => side,
            _ => Direction::Leading,
        };
        // δt, the jump −f₊ + Dg f₋ + ∂g/∂t of v', and z' before and after.
        let (later, jump, caught, before, after) = match kind {
            EventKind::Open if step.modes()[contact] == Mode::Stick => {
                let never = row(velocity) * 0.0;
                (never, 0.0, true, vec![0.0; count], vec![0.0; count])
            }
            EventKind::Open | EventKind::Close => return Vec::new(),
            EventKind::Stick => {
                let rates = law.rates(Motion::Stick, &law.caught(&at.memory));
                let later = row(velocity) * -at.rate.recip();
                (later, 0.0, true, law.slipping(side, &at.memory), rates)
            }
            EventKind::Crossing(to) => {
                let [before, after] = [side, to].map(|side| law.coefficient(side, &at.memory));
                let jump = at.load * (after - before);
                let [before, after] = [side, to].map(|side| law.slipping(side, &at.memory));
                let later = row(velocity) * -at.rate.recip();
                (later, jump, false, before, after)
            }
            EventKind::Release(to) => {
                let (limit, slopes) = law.limit(&at.memory);
                let before = law.rates(Motion::Stick, &at.memory);
                let after = law.slipping(to, &law.caught(&at.memory));
                let coefficient = law.coefficient(to, &at.memory);
                let surplus = at.load * (limit - to.sign() * coefficient);
                let later = if step.is_forced(contact) {
                    row(velocity) * 0.0
                } else {
                    self.later(contact, to.sign(), (limit, &slopes, &before), &at)
                };
                (later, -to.sign() * surplus.max(0.0), true, before, after)
            }
        };
        let mut changes = Vec::new();
        if kind == EventKind::Stick {
            changes.push((velocity, row(velocity) * 0.0));
        } else if jump != 0.0 {
            changes.push((velocity, row(velocity) + &later * jump));
        }
        let first = 2 * n + contact * count;
        let slopes = if caught {
            slopes_of(&|memory| law.caught(memory), &at.memory)
        } else {
            DMatrix::identity(count, count)
        };
        for j in 0..count {
            let mut change = row(first) * 0.0;
            let mut jump = -after[j];
            for l in 0..count {
                let slope = slopes[(j, l)];
                if slope != 0.0 {
                    change += row(first + l) * slope;
                    jump += slope * before[l];
                }
            }
            if jump != 0.0 {
                change += &later * jump;
            }
            changes.push((first + j, change));
        }
        changes
    }

    /// δt of a release, from h = σR − N μ_s.
    fn later(
        &self,
        contact: usize,
        sign: f64,
        (limit, slopes, rates): (f64, &[f64], &[f64]),
        at: &Instant,
    ) -> RowDVector<f64> {
        let model = &self.form.model;
        let (n, i) = (model.len(), at.coordinate);
        let row = |row: usize| self.tangents.row(row);
        let [(spring, springs), (damper, dampers)] = [model.stiffness.row(i), model.damping.row(i)];
        let mut gradient: RowDVector<f64> = row(i) * (-sign * spring);
        gradient += row(n + i) * (-sign * damper);
        for (first, beside) in [(0, springs), (n, dampers)] {
            for &(j, a) in beside {
                gradient += row(first + j) * (-sign * a);
            }
        }
        let mass = model.masses[i];
        for &(j, a) in model.contacts[contact].load_gradient {
            gradient += row(j) * (-limit * a / mass);
        }
        let mut rate = sign * at.carried_rate - at.load_rate * limit;
        for j in 0..slopes.len() {
            gradient += row(2 * n + contact * slopes.len() + j) * (-at.load * slopes[j]);
            rate -= at.load * slopes[j] * rates[j];
        }
        gradient * -rate.recip()
    }

    fn instant(&self, step: &Step, number: usize) -> Instant {
        let (model, count) = (&self.form.model, self.form.model.laws.memory());
        let contact = &model.contacts[number];
        let (n, i, h) = (model.len(), contact.coordinate, step.duration());
        let state = step.end_state();
        let mass = model.masses[i];
        // Just before: the drives go on as they did.
        let slope = |series: &PowerSeries| series.derivative().at(h);
        let surface = contact.belt_velocity.series(step.clock());
        let force = model.forces[i].series(step.clock());
        let load = contact.load.series(step.clock());
        let acceleration = |j: usize| slope(&step.series()[j]);
        let velocity = |j: usize| state.velocities[j];
        let [(spring, springs), (damper, dampers)] = [model.stiffness.row(i), model.damping.row(i)];
        let mut carried_rate = slope(&force) / mass
            - slope(&surface.derivative())
            - spring * velocity(i)
            - damper * acceleration(i);
        for &(j, a) in springs {
            carried_rate -= a * velocity(j);
        }
        for &(j, a) in dampers {
            carried_rate -= a * acceleration(j);
        }
        let gradient = contact.load_gradient.iter();
        let from_displacements: f64 = gradient.map(|&(j, a)| a * velocity(j)).sum();
        let load_now = load.at(h) + contact.displacement_load(&state.displacements);
        let memory = |j: usize| state.memory.get(number * count + j).copied().unwrap_or(0.0);
        debug_assert_eq!(step.series().len(), n + model.remembered());
        Instant {
            coordinate: i,
            load: load_now / mass,
            load_rate: (slope(&load) + from_displacements) / mass,
            rate: acceleration(i) - slope(&surface),
            carried_rate,
            memory: (0..count).map(memory).collect(),
        }
    }
}

/// The slopes of a map by differences of fourth order; exact for one that is linear.
fn slopes_of(map: &dyn Fn(&[f64]) -> Vec<f64>, at: &[f64]) -> DMatrix<f64> {
    /// About the fifth root of ε, and a power of two.
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
