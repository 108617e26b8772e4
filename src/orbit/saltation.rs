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

use nalgebra::RowDVector;

use super::tangent::TangentFlow;
use crate::friction::memory::{ContactLaw, Motion, Slip};
use crate::motion::{EventKind, Mode, Segment};
use crate::scalar::dual::{Dual, Tangent};
use crate::series::PowerSeries;
use crate::state::Direction;
use crate::structure::Step;

/// A contact at the time of an event, all divided by its mass.
struct Instant<const Z: usize> {
    coordinate: usize,
    /// N.
    load: f64,
    load_rate: f64,
    /// dr/dt just before.
    rate: f64,
    /// dR/dt just before.
    carried_rate: f64,
    memory: [f64; Z],
}

impl<L: ContactLaw<Z>, const Z: usize> TangentFlow<'_, L, Z> {
    /// Takes the tangents across the start itself: a contact that slips from r = 0, or is open, has
    /// had its memory set by its law.
    pub(super) fn begin(&mut self, step: &Step) {
        let n = self.structure.len();
        for (number, contact) in self.structure.contacts().iter().enumerate() {
            let surface = contact.belt_velocity().at(step.clock())[0];
            let rests = step.modes()[number] == Mode::Stick;
            if rests || self.start.velocities[contact.coordinate()] != surface {
                continue;
            }
            let first = 2 * n + number * Z;
            let memory = |j: usize| self.start.memory.get(number * Z + j).copied();
            let memory = std::array::from_fn(|j| memory(j).unwrap_or(0.0));
            let slopes = slopes_of(|memory| contact.law().caught(memory), memory);
            let before = self.tangents.rows(first, Z).into_owned();
            for (j, slopes) in slopes.into_iter().enumerate() {
                let mut row = self.tangents.row_mut(first + j);
                row.fill(0.0);
                for (l, slope) in slopes.into_iter().enumerate() {
                    row += before.row(l) * slope;
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
        let law = self.structure.contacts()[contact].law();
        let at = self.instant(step, contact);
        let n = self.structure.len();
        let velocity = n + at.coordinate;
        let row = |row: usize| -> RowDVector<f64> { self.tangents.row(row).into_owned() };
        let side = match step.modes()[contact] {
            Mode::Slip(side) => side,
            _ => Direction::Leading,
        };
        let at_zero = |side: Direction| Slip {
            speed: 0.0,
            direction: side.sign(),
            piece: 0,
        };
        // With the sign of r; of the law, not divided by anything.
        let coefficient = |side: Direction| law.coefficient(at_zero(side), at.memory);
        let slipping = |side, memory| law.rates(Motion::Slip(at_zero(side)), memory);
        // δt, the jump −f₊ + Dg f₋ + ∂g/∂t of v', and z' before and after.
        let (later, jump, caught, before, after) = match kind {
            EventKind::Open if step.modes()[contact] == Mode::Stick => {
                let never = row(velocity) * 0.0;
                (never, 0.0, true, [0.0; Z], [0.0; Z])
            }
            EventKind::Open | EventKind::Close => return Vec::new(),
            EventKind::Stick => {
                let after = law.caught(at.memory);
                let rates = law.rates(Motion::Stick, after);
                let later = row(velocity) * -at.rate.recip();
                (later, 0.0, true, slipping(side, at.memory), rates)
            }
            EventKind::Crossing(to) => {
                let jump = at.load * (coefficient(to) - coefficient(side));
                let rates = [side, to].map(|side| slipping(side, at.memory));
                let later = row(velocity) * -at.rate.recip();
                (later, jump, false, rates[0], rates[1])
            }
            EventKind::Release(to) => {
                let (limit, slopes) = limit(law, at.memory);
                let before = law.rates(Motion::Stick, at.memory);
                let after = slipping(to, law.caught(at.memory));
                let surplus = at.load * (limit - to.sign() * coefficient(to));
                let later = if step.is_forced(contact) {
                    row(velocity) * 0.0
                } else {
                    self.later(contact, to.sign(), (limit, slopes, before), &at)
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
        let first = 2 * n + contact * Z;
        let slopes = if caught {
            slopes_of(|memory| law.caught(memory), at.memory)
        } else {
            std::array::from_fn(|i| std::array::from_fn(|j| f64::from(u8::from(i == j))))
        };
        for (j, slopes) in slopes.into_iter().enumerate() {
            let mut change = row(first) * 0.0;
            let mut jump = -after[j];
            for (l, slope) in slopes.into_iter().enumerate() {
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
        (limit, slopes, rates): (f64, [f64; Z], [f64; Z]),
        at: &Instant<Z>,
    ) -> RowDVector<f64> {
        let (n, i) = (self.structure.len(), at.coordinate);
        let row = |row: usize| self.tangents.row(row);
        let [(spring, springs), (damper, dampers)] = [self.stiffness.row(i), self.damping.row(i)];
        let mut gradient: RowDVector<f64> = row(i) * (-sign * spring);
        gradient += row(n + i) * (-sign * damper);
        for (first, beside) in [(0, springs), (n, dampers)] {
            for &(j, a) in beside {
                gradient += row(first + j) * (-sign * a);
            }
        }
        let mass = self.structure.masses()[i];
        for &(j, a) in self.structure.contacts()[contact].load_gradient() {
            gradient += row(j) * (-limit * a / mass);
        }
        let mut rate = sign * at.carried_rate - at.load_rate * limit;
        for j in 0..Z {
            gradient += row(2 * n + contact * Z + j) * (-at.load * slopes[j]);
            rate -= at.load * slopes[j] * rates[j];
        }
        gradient * -rate.recip()
    }

    fn instant(&self, step: &Step, number: usize) -> Instant<Z> {
        let contact = &self.structure.contacts()[number];
        let (n, i, h) = (self.structure.len(), contact.coordinate(), step.duration());
        let state = step.end_state();
        let mass = self.structure.masses()[i];
        // Just before: the drives go on as they did.
        let slope = |series: &PowerSeries| series.derivative().at(h);
        let surface = contact.belt_velocity().series(step.clock());
        let force = self.structure.forces()[i].series(step.clock());
        let load = contact.load().series(step.clock());
        let acceleration = |j: usize| slope(&step.series()[j]);
        let velocity = |j: usize| state.velocities[j];
        let [(spring, springs), (damper, dampers)] = [self.stiffness.row(i), self.damping.row(i)];
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
        let gradient = contact.load_gradient().iter();
        let from_displacements: f64 = gradient.map(|&(j, a)| a * velocity(j)).sum();
        let load_now = load.at(h) + contact.support().displacement_load(&state.displacements);
        let memory = |j: usize| state.memory.get(number * Z + j).copied().unwrap_or(0.0);
        debug_assert_eq!(step.series().len(), n + Z * self.structure.contacts().len());
        Instant {
            coordinate: i,
            load: load_now / mass,
            load_rate: (slope(&load) + from_displacements) / mass,
            rate: acceleration(i) - slope(&surface),
            carried_rate,
            memory: std::array::from_fn(memory),
        }
    }
}

/// μ_s and its slopes over the memory.
fn limit<L: ContactLaw<Z>, const Z: usize>(law: &L, memory: [f64; Z]) -> (f64, [f64; Z]) {
    let along = |j: usize| {
        let inputs = std::array::from_fn(|l| {
            let component = if j == l { 1.0 } else { 0.0 };
            Dual::along(memory[l], component)
        });
        law.limit(Dual::along(0.0, 0.0), inputs)
    };
    let value = law.limit(0.0, memory).unwrap_or(f64::NAN);
    let slopes = std::array::from_fn(|j| match along(j).map(|limit| limit.tangent) {
        Some(Tangent::Constant(slope) | Tangent::Varying(slope)) => slope,
        None => f64::NAN,
    });
    (value, slopes)
}

/// The slopes of a map by differences of fourth order; exact for one that is linear.
fn slopes_of<const Z: usize>(map: impl Fn([f64; Z]) -> [f64; Z], at: [f64; Z]) -> [[f64; Z]; Z] {
    /// About the fifth root of ε, and a power of two.
    const PART: f64 = 1.0 / 1024.0;
    let mut slopes = [[0.0; Z]; Z];
    for j in 0..Z {
        let step = if at[j] == 0.0 {
            PART
        } else {
            at[j].abs() * PART
        };
        let difference = |width: f64| {
            let [mut low, mut high] = [at; 2];
            low[j] -= width;
            high[j] += width;
            let (below, above, apart) = (map(low), map(high), high[j] - low[j]);
            std::array::from_fn::<_, Z, _>(|i| (above[i] - below[i]) / apart)
        };
        let (near, far) = (difference(step), difference(2.0 * step));
        for i in 0..Z {
            slopes[i][j] = near[i] + (near[i] - far[i]) / 3.0;
        }
    }
    slopes
}
