//! The decision on stick or slip of contacts that share coordinates. At r = 0 the force in one
//! contact depends on the others, so the modes of all are decided together, at every event of any
//! of them.
//!
//! Let B_c be the limits, a_c = r_c', and a = a⁰ − G λ. The forces λ satisfy |λ_c| ≤ B_c for each
//! contact with a_c = 0, and λ_c = B_c sgn a_c for the others. This is a convex programme with a
//! unique a. It is solved by pivoting: beginning with a guess of the contacts that stick, the modes
//! that violate their condition are changed until no condition is violated.
//!
//! At first the limits are the static limits. As long as contacts slip whose kinetic limit is
//! smaller, the one with the largest |a_c|/(G_cc B_c) gets its kinetic limit, and the programme is
//! solved again: *the fastest yields first*. If both coefficients are equal, the first solution is
//! the result.
//!
//! A contact on the edge of its stick band (λ_c = B_c and a_c = 0) is first assumed to stick; then
//! the sign of the first nonzero derivative of its distance from the edge decides, as for a single
//! contact.

use super::edge::{EDGE_ROUNDING, Edge, side_of};
use super::expand::free_accelerations;
use super::factor::Holding;
use super::model::Model;
use super::series::Series;
use super::sizes::{contact_terms, load_terms};
use super::state::{ContactState, Entry, Phase, Situation};
use crate::error::Error;
use crate::state::Direction;

/// A decision under way.
#[derive(Debug)]
pub(super) struct Decision {
    candidates: Vec<Candidate>,
    /// Rounding excess of the force of contacts that reached the edge of their band.
    beyond: Vec<(usize, f64)>,
    /// Number of contacts on an edge that violated their condition in the last round.
    broken: usize,
    /// True if the candidates must be gathered again.
    is_stale: bool,
}

/// A contact with r = 0. Accelerations and forces are divided by √G_cc, so that G has a unit
/// diagonal.
#[derive(Debug, Clone)]
struct Candidate {
    contact: usize,
    /// Its state in stick.
    resting: ContactState,
    /// a⁰ and the sum of the sizes of its terms.
    free: f64,
    terms: f64,
    /// The static limit, and the kinetic ones backward and forward.
    limit: f64,
    kinetic: [f64; 2],
    has_yielded: bool,
    choice: Choice,
    /// The last solution: λ, a, and the rounding error of the unknown of these two (a in slip, λ in
    /// stick).
    force: f64,
    acceleration: f64,
    rounding: f64,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Choice {
    Stick,
    Slip(Direction),
    /// Slip that begins with the force of stick and without acceleration.
    Leave(Direction),
}

impl Decision {
    /// Called before contacts that reach r = 0 are processed: until then, an excess of contacts at
    /// the edge of their bands is a rounding error.
    pub(super) fn new(model: &Model<'_>, situation: &Situation, series: &mut Series) -> Self {
        let mut beyond = Vec::new();
        let at_edge = |&c: &usize| {
            let state = &situation.contacts[c];
            state.sticks() && state.edge != Edge::Away
        };
        if model.shared.iter().any(at_edge) {
            free_accelerations(model, situation, series);
            let Holding { contacts, factor } = &situation.holding;
            let root = |c: usize| model.contacts[c].compliance.sqrt();
            let pulls = contacts.iter().map(|&c| series.contacts[c].free / root(c));
            let mut forces: Vec<f64> = pulls.collect();
            factor.solve(&mut forces);
            for (&c, force) in std::iter::zip(contacts, forces) {
                if let Edge::On(Some(side), 1) = situation.contacts[c].edge {
                    let bound = side.sign() * series.contacts[c].bound[0] / root(c);
                    beyond.push((c, force - bound));
                }
            }
        }
        Self {
            candidates: Vec::new(),
            beyond,
            broken: usize::MAX,
            is_stale: false,
        }
    }

    /// Restarts the decision after another contact has opened or closed.
    pub(super) fn restart(&mut self) {
        self.is_stale = true;
    }

    /// Solves for the modes of all candidates, and sets them.
    pub(super) fn settle(
        &mut self,
        model: &Model<'_>,
        situation: &mut Situation,
        series: &mut Series,
    ) -> Result<(), Error> {
        self.gather(model, situation, series);
        let mut are_on_edges = false;
        loop {
            self.solve(model, situation, series)?;
            let Some(fastest) = self.fastest() else {
                if !are_on_edges && self.put_on_edges() {
                    are_on_edges = true;
                    continue;
                }
                break;
            };
            /// Mirrored contacts yield together.
            const TIE: f64 = 1.0 - 64.0 * f64::EPSILON;
            for candidate in &mut self.candidates {
                candidate.has_yielded |= candidate.eagerness() >= TIE * fastest;
            }
        }
        if let Some(contacts) = self.undetermined(model) {
            return Err(Error::Undetermined {
                contacts,
                reached: situation.reached(model, series),
            });
        }
        self.set(model, situation);
        Ok(())
    }

    /// The candidates: shared contacts that stick until something else is decided.
    fn gather(&mut self, model: &Model<'_>, situation: &mut Situation, series: &mut Series) {
        let mut decides = vec![false; situation.contacts.len()];
        for candidate in &self.candidates {
            decides[candidate.contact] = true;
        }
        let is_new = |&c: &usize| situation.contacts[c].sticks() && !decides[c];
        if !self.is_stale && !model.shared.iter().any(is_new) {
            return;
        }
        (self.is_stale, self.broken) = (false, usize::MAX);
        // From the beginning, with all at rest.
        for candidate in self.candidates.drain(..) {
            let state = &mut situation.contacts[candidate.contact];
            if !state.phase_is_open() {
                *state = candidate.resting;
            }
        }
        for &c in &model.shared {
            let state = &mut situation.contacts[c];
            if state.sticks() && state.limit.is_none() {
                let from = match state.entry {
                    Entry::Arrived(Some(from)) => from,
                    _ => Direction::Leading,
                };
                state.pass_through(from);
            }
        }
        free_accelerations(model, situation, series);
        for &c in &model.shared {
            let (contact, state, of) = (
                &model.contacts[c],
                &situation.contacts[c],
                &series.contacts[c],
            );
            if !state.sticks() {
                continue;
            }
            let root = contact.compliance.sqrt();
            let load_terms = load_terms(contact, situation) * state.static_coefficient();
            let forces =
                contact.size_along(|j| model.acceleration_by(j, |l| model.forces[l].size()).abs());
            let kinetic = [Direction::Lagging, Direction::Leading].map(|side| {
                let coefficient = side.sign() * state.start_coefficient(contact.law, side);
                (of.load[0] * coefficient).min(of.bound[0]) / root
            });
            self.candidates.push(Candidate {
                contact: c,
                resting: state.clone(),
                free: of.free / root,
                terms: (contact_terms(model, situation, series, c) + forces + load_terms) / root,
                limit: of.bound[0] / root,
                kinetic,
                has_yielded: false,
                choice: Choice::Stick,
                force: 0.0,
                acceleration: 0.0,
                rounding: 0.0,
            });
        }
        // The rounding excess beyond an edge is subtracted from the forces that drive the contacts.
        for i in 0..self.candidates.len() {
            let c = self.candidates[i].contact;
            let mut excess = 0.0;
            for &(d, beyond) in &self.beyond {
                let coupled = model.contacts[c].coupled();
                let coupling = coupled.iter().find(|&&(other, _)| other == d);
                let coupling = coupling.map_or(0.0, |&(_, g)| g);
                excess += if c == d { beyond } else { coupling * beyond };
            }
            self.candidates[i].free -= excess;
        }
    }

    /// Pivots until no candidate breaks its condition.
    fn solve(
        &mut self,
        model: &Model<'_>,
        situation: &Situation,
        series: &Series,
    ) -> Result<(), Error> {
        /// Changing the contact with the least number first always ends, but it can take 2ⁿ
        /// changes. The usual number is below n; the largest seen is 299, for eleven contacts on
        /// six coordinates.
        const MOST_CHANGES: usize = 1 << 14;
        let mut least_broken = usize::MAX;
        for _ in 0..MOST_CHANGES {
            self.evaluate(model);
            let broken: Vec<usize> = (0..self.candidates.len())
                .filter(|&i| self.candidates[i].is_broken())
                .collect();
            if broken.is_empty() {
                return Ok(());
            }
            // While the number of violations falls, all of them are changed together; otherwise
            // only the first.
            let count = if broken.len() < least_broken {
                broken.len()
            } else {
                1
            };
            least_broken = least_broken.min(broken.len());
            for &i in &broken[..count] {
                self.candidates[i].change();
            }
        }
        Err(situation.undecided(model, series))
    }

    /// The contacts that stick, with their factor. Contacts with dependent directions get a small
    /// compliance: they share the force, and their forces exceed the limits by far if they cannot
    /// all stick.
    fn hold(&self, model: &Model<'_>) -> Holding {
        let sticking = self.candidates.iter();
        let sticking = sticking.filter(|candidate| candidate.choice == Choice::Stick);
        let contacts: Vec<usize> = sticking.map(|candidate| candidate.contact).collect();
        let factor = model.factor(&contacts);
        let factor = factor.unwrap_or_else(|_| model.soft_factor(&contacts));
        Holding { contacts, factor }
    }

    /// Forces and accelerations of the choices.
    fn evaluate(&mut self, model: &Model<'_>) {
        let Holding { contacts, factor } = self.hold(model);
        let mut places = vec![None; model.contacts.len()];
        for (i, candidate) in self.candidates.iter_mut().enumerate() {
            places[candidate.contact] = Some(i);
            candidate.rounding = 0.0;
            candidate.force = match candidate.choice {
                Choice::Stick => 0.0,
                Choice::Slip(side) | Choice::Leave(side) => side.sign() * candidate.most(side),
            };
        }
        let pulls = self.accelerations(model, &places);
        let sticking = || contacts.iter().filter_map(|&c| places[c]);
        let mut forces: Vec<f64> = sticking().map(|i| pulls[i].0).collect();
        let mut rounding: Vec<f64> = sticking().map(|i| pulls[i].1).collect();
        factor.solve(&mut forces);
        factor.magnify(&mut rounding);
        for ((i, force), rounding) in sticking().zip(forces).zip(rounding) {
            let candidate = &mut self.candidates[i];
            (candidate.force, candidate.rounding) = (force, rounding);
            candidate.acceleration = 0.0;
        }
        let pulls = self.accelerations(model, &places);
        for (candidate, (pull, rounding)) in std::iter::zip(&mut self.candidates, pulls) {
            if candidate.choice != Choice::Stick {
                (candidate.acceleration, candidate.rounding) = (pull, rounding);
            }
        }
    }

    /// a⁰ − G λ of every candidate, and how far rounding may have moved it.
    fn accelerations(&self, model: &Model<'_>, places: &[Option<usize>]) -> Vec<(f64, f64)> {
        let sum = |candidate: &Candidate| {
            let mut pull = candidate.free - candidate.force;
            let mut terms = candidate.terms + candidate.force.abs();
            let mut moved = 0.0;
            for &(d, g) in model.contacts[candidate.contact].coupled() {
                let Some(i) = places[d] else { continue };
                let other = &self.candidates[i];
                pull -= g * other.force;
                terms += (g * other.force).abs();
                if other.choice == Choice::Stick {
                    moved += g.abs() * other.rounding;
                }
            }
            (pull, EDGE_ROUNDING * f64::EPSILON * terms + moved)
        };
        self.candidates.iter().map(sum).collect()
    }

    /// The largest `eagerness` of the contacts that may still get their kinetic limit.
    fn fastest(&self) -> Option<f64> {
        let eager = self.candidates.iter().map(Candidate::eagerness);
        eager.filter(|eagerness| *eagerness > 0.0).reduce(f64::max)
    }

    /// Sets contacts that would slip with the force of stick and without acceleration to stick on
    /// the edge of their band; returns true if there are any.
    fn put_on_edges(&mut self) -> bool {
        let mut changed = false;
        for candidate in &mut self.candidates {
            let is_slip = matches!(candidate.choice, Choice::Slip(_)) && !candidate.has_yielded;
            if is_slip && candidate.acceleration.abs() <= candidate.rounding {
                candidate.choice = Choice::Stick;
                changed = true;
            }
        }
        changed
    }

    /// The contacts with dependent directions that are at rest at the same time, if any: the force
    /// in each of them is not determined.
    fn undetermined(&self, model: &Model<'_>) -> Option<Vec<usize>> {
        let rests = |candidate: &&Candidate| {
            let sticks = candidate.choice == Choice::Stick;
            sticks || candidate.acceleration.abs() <= candidate.rounding
        };
        let resting = self.candidates.iter().filter(rests);
        let contacts: Vec<usize> = resting.map(|candidate| candidate.contact).collect();
        model.factor(&contacts).is_err().then_some(contacts)
    }

    /// Sets the modes that were chosen.
    fn set(&mut self, model: &Model<'_>, situation: &mut Situation) {
        situation.holding = self.hold(model);
        let elastic = model
            .springs
            .iter()
            .filter(|&&c| model.contacts[c].is_elastic());
        let parts = |&c: &usize| Some((c, model.dependence(c, &situation.holding)?));
        situation.guided = elastic.filter_map(parts).collect();
        for candidate in &self.candidates {
            let contact = &model.contacts[candidate.contact];
            let mut state = candidate.resting.clone();
            match candidate.choice {
                Choice::Stick => state.edge = candidate.edge(),
                Choice::Slip(side) | Choice::Leave(side) => {
                    let rate = if candidate.acceleration.abs() > candidate.rounding {
                        side.sign() * candidate.acceleration * contact.compliance.sqrt()
                    } else {
                        0.0
                    };
                    state.begin_slip(contact.law, side, Some(rate));
                    state.entry = Entry::Held;
                }
            }
            situation.contacts[candidate.contact] = state;
        }
    }

    /// After an expansion: contacts on an edge that leave it or return to it, and contacts
    /// whose law never sticks that continue in the other direction. Returns true if there are any.
    pub(super) fn revise(
        &mut self,
        model: &Model<'_>,
        situation: &mut Situation,
        series: &Series,
    ) -> bool {
        let mut changed = false;
        for &c in &model.shared {
            let state = &mut situation.contacts[c];
            let speeds = &series.contacts[c].speeds;
            if let (Phase::Slip { direction, .. }, None) = (&mut state.phase, state.limit)
                && matches!(state.entry, Entry::Arrived(_))
                && speeds.first_nonzero().is_some_and(|c| c < 0.0)
            {
                *direction = direction.opposite();
                state.entry = Entry::Held;
                changed = true;
            }
        }
        let mut broken = Vec::new();
        for (i, candidate) in self.candidates.iter().enumerate() {
            let state = &mut situation.contacts[candidate.contact];
            let of = &series.contacts[candidate.contact];
            match (candidate.choice, state.edge) {
                (Choice::Stick, Edge::On(None, _)) => {
                    let side = side_of(candidate.force);
                    let sides = [side, side.opposite()];
                    let mut out = sides
                        .into_iter()
                        .filter(|&side| Edge::leaving(of, side).1 < 0.0);
                    broken.extend(out.next().map(|side| (i, Some(side))));
                }
                (Choice::Stick, Edge::On(Some(side), _)) => {
                    let (edge, sign) = Edge::leaving(of, side);
                    state.edge = edge;
                    broken.extend((sign < 0.0).then_some((i, Some(side))));
                }
                (Choice::Leave(_), _) => {
                    let returns = of.speeds.first_nonzero().is_some_and(|c| c < 0.0);
                    broken.extend(returns.then_some((i, None)));
                }
                _ => {}
            }
        }
        let count = if broken.len() < self.broken {
            broken.len()
        } else {
            1
        };
        self.broken = self.broken.min(broken.len());
        for &(i, side) in broken.iter().take(count) {
            let candidate = &mut self.candidates[i];
            if side.is_some() {
                candidate.resting.edge = Edge::reached(side);
            }
            candidate.choice = match side {
                None => Choice::Stick,
                Some(side) if candidate.falls(side) => {
                    candidate.has_yielded = true;
                    Choice::Slip(side)
                }
                Some(side) => Choice::Leave(side),
            };
        }
        changed || !broken.is_empty()
    }
}

impl Candidate {
    /// The largest force against slip in a direction.
    fn most(&self, side: Direction) -> f64 {
        if self.has_yielded {
            self.kinetic[usize::from(side == Direction::Leading)]
        } else {
            self.limit
        }
    }

    /// Returns true if the kinetic limit is below the static limit for slip in a direction.
    fn falls(&self, side: Direction) -> bool {
        let kinetic = self.kinetic[usize::from(side == Direction::Leading)];
        self.limit - kinetic > 4.0 * f64::EPSILON * self.limit
    }

    /// Excess of the force in stick over its limit.
    fn excess(&self) -> f64 {
        self.force.abs() - self.most(side_of(self.force))
    }

    fn is_broken(&self) -> bool {
        match self.choice {
            Choice::Stick => self.excess() > self.rounding,
            Choice::Slip(side) | Choice::Leave(side) => {
                side.sign() * self.acceleration < -self.rounding
            }
        }
    }

    /// Changes the mode that violates its condition.
    fn change(&mut self) {
        self.choice = match self.choice {
            Choice::Stick => Choice::Slip(side_of(self.force)),
            Choice::Slip(_) | Choice::Leave(_) => Choice::Stick,
        };
    }

    /// |a_c|/(G_cc B_c) of a contact that slips with its static limit although its kinetic limit is
    /// smaller; 0 for other contacts.
    fn eagerness(&self) -> f64 {
        match self.choice {
            Choice::Slip(side)
                if !self.has_yielded
                    && self.falls(side)
                    && self.acceleration.abs() > self.rounding =>
            {
                self.acceleration.abs() / self.limit
            }
            _ => 0.0,
        }
    }

    /// The edge of its band at which it is, in stick.
    fn edge(&self) -> Edge {
        let excess = self.excess();
        let has_arrived = self.resting.has_arrived();
        if has_arrived && self.limit.max(self.force.abs()) <= self.rounding {
            // No band yet, for the load begins: on both of its bounds.
            return Edge::reached(None);
        }
        let is_known = self.resting.edge != Edge::Away;
        let is_on_edge =
            excess.abs() <= self.rounding && (is_known || has_arrived || excess >= 0.0);
        if is_on_edge {
            Edge::reached(Some(side_of(self.force)))
        } else {
            Edge::Away
        }
    }
}
