//! The decision on stick or slip of contacts that share coordinates. At r = 0 the force in one
//! contact depends on the others, so the modes of all are decided together, at every event of any
//! of them.
//!
//! The forces and accelerations are those of the programme in `complementarity.rs`. At first its
//! bounds are the static limits. As long as contacts slip whose kinetic limit is smaller, the one
//! with the largest |a_c|/(G_cc B_c) gets its kinetic limit, and the programme is solved again:
//! *the fastest yields first*. If both coefficients are equal, the first solution is the result.
//!
//! A contact on the edge of its stick band (λ_c = B_c and a_c = 0) is first assumed to stick, and
//! all series are expanded. The programme is solved again for the coefficients of the first order
//! at which a distance from an edge would become negative. Contacts that slip in its solution have
//! r ≠ 0, in proportion to a power of the time; of those whose kinetic limit is smaller, the
//! fastest yields. Contacts without r stick, and remain on their edge if all orders are 0.

use super::cholesky::Holding;
use super::complementarity::{Choice, Unknown, Unsolved, evaluate, excess_of, hold, solve};
use super::contact_data::Entries;
use super::expand::free_accelerations;
use super::model::Model;
use super::redundant_contacts::{MOST_SUBSETS, Mechanism, Resting, TooMany};
use super::rounding_scales::{contact_terms, load_terms};
use super::series::Series;
use super::state::{ContactState, Entry, Guided, Phase, Situation};
use super::stick_band_edge::{EDGE_ROUNDING, Edge, deciding_distance, side_of};
use crate::error::Error;
use crate::series::{PowerSeries, TERMS};
use crate::state::Direction;

/// A decision under way.
#[derive(Debug)]
pub(super) struct Decision {
    candidates: Vec<Candidate>,
    /// The programme of the candidates.
    unknowns: Vec<Unknown>,
    /// Rounding excess of the force of contacts that reached the edge of their band.
    beyond: Vec<(usize, f64)>,
    /// True if the candidates must be gathered again.
    is_stale: bool,
    /// True if the programme is solved.
    is_solved: bool,
    /// True if the directions of the candidates are dependent.
    is_dependent: bool,
}

/// A contact with r = 0, in the units of its [`Unknown`].
#[derive(Debug, Clone)]
struct Candidate {
    /// The state of the contact in stick.
    resting: ContactState,
    /// The static limits and the kinetic ones, backward and forward.
    limits: [f64; 2],
    kinetic: [f64; 2],
    has_yielded: bool,
    /// The direction of slip that begins with the force of stick and without acceleration.
    leaves: Option<Direction>,
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
        let mut mechanisms = situation.mechanisms.iter();
        if model.shared.iter().any(at_edge) || mechanisms.any(|m| m.edge != Edge::Away) {
            free_accelerations(model, situation, series);
            let Holding { contacts, factor } = &situation.holding;
            let root = |c: usize| model.contacts[c].compliance.sqrt();
            let pulls = contacts.iter().map(|&c| series.contacts[c].free / root(c));
            let mut forces: Vec<f64> = pulls.collect();
            factor.solve(&mut forces);
            for (&c, force) in std::iter::zip(contacts, &forces) {
                if let Edge::On(Some(side), 1) = situation.contacts[c].edge {
                    let bound = side.sign() * series.contacts[c].bound(side)[0] / root(c);
                    beyond.push((c, force - bound));
                }
            }
            beyond.extend(beyond_mechanisms(model, situation, series, forces));
        }
        Self {
            candidates: Vec::new(),
            unknowns: Vec::new(),
            beyond,
            is_stale: false,
            is_solved: false,
            is_dependent: false,
        }
    }

    /// Restarts the decision after another contact has opened or closed.
    pub(super) fn restart(&mut self) {
        self.is_stale = true;
    }

    /// Asks again which contacts leave their edges: other forces have changed.
    pub(super) fn ask_rates_again(&mut self) {
        for candidate in &mut self.candidates {
            candidate.leaves = None;
        }
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
        while !self.is_solved {
            let solved = solve(model, series, &mut self.unknowns);
            solved.map_err(|reason| unsolved(reason, model, situation, series))?;
            let moving = self.unknowns.iter().enumerate();
            let slipping = moving.filter_map(|(place, unknown)| {
                Some(Slipping {
                    place,
                    side: unknown.moves()?,
                    acceleration: unknown.acceleration,
                })
            });
            if self.let_fastest_yield(&slipping.collect::<Vec<_>>()) {
                continue;
            }
            // In the second solution, too: forces in stick and accelerations in slip do not count
            // as rounding within the same bounds. Surfaces of dependent contacts may part without
            // an acceleration.
            let changed = !(are_on_edges && self.is_dependent) && self.put_on_edges();
            self.is_solved = are_on_edges || !changed;
            are_on_edges = true;
        }
        self.set(model, situation, series)
    }

    /// The candidates: shared contacts that stick until something else is decided.
    fn gather(&mut self, model: &Model<'_>, situation: &mut Situation, series: &mut Series) {
        let mut decides = vec![false; situation.contacts.len()];
        for unknown in &self.unknowns {
            decides[unknown.contact] = true;
        }
        let is_new = |&c: &usize| situation.contacts[c].sticks() && !decides[c];
        if !self.is_stale && !model.shared.iter().any(is_new) {
            return;
        }
        (self.is_stale, self.is_solved) = (false, false);
        // From the beginning, with all at rest.
        let candidates = std::iter::zip(self.candidates.drain(..), self.unknowns.drain(..));
        for (candidate, unknown) in candidates {
            let state = &mut situation.contacts[unknown.contact];
            if !state.phase_is_open() {
                *state = candidate.resting;
            }
        }
        for &c in &model.shared {
            let state = &mut situation.contacts[c];
            if state.sticks() && state.limits.is_none() {
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
            let load_terms = load_terms(model, situation, series, c) * state.static_coefficient();
            let forces =
                contact.size_along(|j| model.acceleration_by(j, |l| model.forces[l].size()).abs());
            let kinetic = [Direction::Lagging, Direction::Leading].map(|side| {
                let bound = of.bound(side)[0];
                if bound == f64::INFINITY {
                    return bound;
                }
                let coefficient = side.sign() * state.start_coefficient(contact.law, side);
                (of.load[0] * coefficient).min(bound) / root
            });
            let limits = of.bounds.each_ref().map(|bound| bound[0] / root);
            self.candidates.push(Candidate {
                resting: state.clone(),
                limits,
                kinetic,
                has_yielded: false,
                leaves: None,
            });
            let terms = contact_terms(model, situation, series, c) + forces + load_terms;
            let free = of.free / root;
            self.unknowns
                .push(Unknown::new(c, [free, terms / root], limits));
        }
        let contacts: Vec<usize> = self.unknowns.iter().map(|u| u.contact).collect();
        self.is_dependent = model.factor(&contacts).is_err();
        // The rounding excess beyond an edge is subtracted from the forces that drive the contacts.
        for unknown in &mut self.unknowns {
            let c = unknown.contact;
            let mut excess = 0.0;
            for &(d, beyond) in &self.beyond {
                let coupled = model.contacts[c].coupled();
                let coupling = coupled.iter().find(|&&(other, _)| other == d);
                let coupling = coupling.map_or(0.0, |&(_, g)| g);
                excess += if c == d { beyond } else { coupling * beyond };
            }
            unknown.free -= excess;
        }
    }

    /// Gives the kinetic limit to the fastest of these contacts, which are those that slip in the
    /// solution of a programme; mirrored contacts yield together. Returns false if none of them has
    /// a kinetic limit below its static one.
    fn let_fastest_yield(&mut self, slipping: &[Slipping]) -> bool {
        const TIE: f64 = 1.0 - 64.0 * f64::EPSILON;
        let eagerness = |slipping: &Slipping| {
            let candidate = &self.candidates[slipping.place];
            let may_yield = !candidate.has_yielded && candidate.falls(slipping.side);
            let limit = candidate.limits[slipping.side.place()];
            may_yield.then_some(slipping.acceleration.abs() / limit)
        };
        let eagerness: Vec<Option<f64>> = slipping.iter().map(eagerness).collect();
        let Some(fastest) = eagerness.iter().flatten().copied().reduce(f64::max) else {
            return false;
        };
        for (slipping, eagerness) in std::iter::zip(slipping, eagerness) {
            if eagerness.is_some_and(|eagerness| eagerness >= TIE * fastest) {
                let candidate = &mut self.candidates[slipping.place];
                candidate.has_yielded = true;
                let unknown = &mut self.unknowns[slipping.place];
                unknown.choice = Choice::Slip(slipping.side);
                unknown.most = candidate.kinetic;
            }
        }
        true
    }

    /// Sets contacts that would slip with the force of stick and without acceleration to stick on
    /// the edge of their band; returns true if there are any.
    fn put_on_edges(&mut self) -> bool {
        let mut changed = false;
        for (candidate, unknown) in std::iter::zip(&self.candidates, &mut self.unknowns) {
            if !candidate.has_yielded && !unknown.sticks() && unknown.moves().is_none() {
                unknown.choice = Choice::Stick;
                changed = true;
            }
        }
        changed
    }

    /// Sets the modes that were chosen.
    fn set(
        &mut self,
        model: &Model<'_>,
        situation: &mut Situation,
        series: &mut Series,
    ) -> Result<(), Error> {
        let resting = hold(model, &self.remaining());
        let unknowns = self.at_start(model, &resting);
        let mechanisms = resting.mechanisms();
        let too_many = |reason| unsolved(Unsolved::TooMany(reason), model, situation, series);
        situation.mechanisms = mechanisms.map_err(too_many)?;
        for mechanism in &mut situation.mechanisms {
            mechanism.edge = self.edge_of(mechanism, &unknowns);
        }
        for (candidate, unknown) in std::iter::zip(&self.candidates, &unknowns) {
            let contact = &model.contacts[unknown.contact];
            let mut state = candidate.resting.clone();
            let slip = match (unknown.choice, candidate.leaves) {
                (_, Some(side)) => Some((side, 0.0)),
                (Choice::Slip(side), _) => {
                    let rate = unknown.moves().map_or(0.0, |_| unknown.acceleration);
                    Some((side, side.sign() * rate * contact.compliance.sqrt()))
                }
                (Choice::Stick, None) => None,
            };
            state.is_in_group = false;
            match slip {
                None => {
                    state.is_in_group = resting.groups.iter().any(|g| g.has(unknown.contact));
                    state.edge = if state.is_in_group {
                        Edge::Away
                    } else {
                        candidate.edge(unknown)
                    };
                    series.contacts[unknown.contact].carried = PowerSeries::ZERO;
                }
                Some((side, rate)) => {
                    state.begin_slip(contact.law, side, |_| rate);
                    state.entry = Entry::Held;
                }
            }
            situation.contacts[unknown.contact] = state;
        }
        situation.holding = resting.holding;
        situation.guided = guided(model, situation);
        Ok(())
    }

    /// The solution of the programme; if contacts with dependent directions leave their edges, the
    /// forces of those that remain are found from another base.
    fn at_start(&self, model: &Model<'_>, resting: &Resting) -> Vec<Unknown> {
        let mut unknowns = self.unknowns.clone();
        let leaves = |candidate: &Candidate| candidate.leaves.is_some();
        if self.is_dependent && self.candidates.iter().any(leaves) {
            for (candidate, unknown) in std::iter::zip(&self.candidates, &mut unknowns) {
                if let Some(side) = candidate.leaves {
                    unknown.choice = Choice::Slip(side);
                }
            }
            evaluate(model, &mut unknowns, &resting.holding);
        }
        unknowns
    }

    /// The contacts that stick, and do not leave their edges.
    fn remaining(&self) -> Vec<Unknown> {
        let all = std::iter::zip(&self.candidates, &self.unknowns);
        let remaining =
            all.filter(|(candidate, unknown)| unknown.sticks() && candidate.leaves.is_none());
        remaining.map(|(_, unknown)| unknown.clone()).collect()
    }

    /// The place of a contact among the candidates.
    fn place(&self, contact: usize) -> Option<usize> {
        let mut unknowns = self.unknowns.iter();
        unknowns.position(|unknown| unknown.contact == contact)
    }

    /// The parts of a mechanism by the places of its contacts.
    fn parts_of(&self, mechanism: &Mechanism) -> Vec<(usize, f64)> {
        let parts = mechanism.parts.iter();
        let parts = parts.filter_map(|&(c, part)| Some((self.place(c)?, part)));
        parts.collect()
    }

    /// The bound at which a mechanism is.
    fn edge_of(&self, mechanism: &Mechanism, unknowns: &[Unknown]) -> Edge {
        let parts = self.parts_of(mechanism);
        let is_at = |&side: &Direction| {
            let (excess, rounding) = excess_of(unknowns, &parts, side);
            excess >= -rounding
        };
        let sides = [Direction::Lagging, Direction::Leading];
        match sides.into_iter().filter(is_at).collect::<Vec<_>>()[..] {
            [] => Edge::Away,
            [side] => Edge::reached(Some(side)),
            // No bound yet, for all loads begin.
            _ => Edge::reached(None),
        }
    }

    /// Turns contacts whose law never sticks, and that continue in the other direction after an
    /// expansion. Returns true if there are any.
    pub(super) fn turn_back(model: &Model<'_>, situation: &mut Situation, series: &Series) -> bool {
        let mut changed = false;
        for &c in &model.shared {
            let state = &mut situation.contacts[c];
            let speeds = &series.contacts[c].speeds;
            if let (Phase::Slip { direction, .. }, None) = (&mut state.phase, state.limits)
                && matches!(state.entry, Entry::Arrived(_))
                && speeds.first_nonzero().is_some_and(|c| c < 0.0)
            {
                *direction = direction.opposite();
                state.entry = Entry::Held;
                changed = true;
            }
        }
        changed
    }

    /// Revises contacts on an edge that leave it after an expansion. Returns true if there are any.
    pub(super) fn revise(
        &mut self,
        model: &Model<'_>,
        situation: &mut Situation,
        series: &Series,
    ) -> Result<bool, Error> {
        let on_edge = self.on_edges(model, situation, series);
        for order in 1..TERMS {
            let leaves = |on: &OnEdge| on.distance.is_some_and(|(at, d)| at == order && d < 0.0);
            if !on_edge.iter().any(leaves) {
                continue;
            }
            let slipping = self.rates(model, series, order, &on_edge);
            let slipping = slipping.map_err(|reason| unsolved(reason, model, situation, series))?;
            if slipping.is_empty() {
                continue;
            }
            for slipping in &slipping {
                self.candidates[slipping.place].resting.edge = Edge::reached(Some(slipping.side));
            }
            if self.let_fastest_yield(&slipping) {
                self.is_solved = false;
                self.ask_rates_again();
            } else {
                for slipping in slipping {
                    self.candidates[slipping.place].leaves = Some(slipping.side);
                }
            }
            return Ok(true);
        }
        for on in on_edge {
            let edge = match on.of {
                Of::Contact(c) => &mut situation.contacts[c].edge,
                Of::Mechanism(number) => &mut situation.mechanisms[number].edge,
            };
            if let Edge::On(Some(side), _) = *edge {
                let along = Edge::Along(side);
                *edge = on
                    .distance
                    .map_or(along, |(order, _)| Edge::On(Some(side), order));
            }
        }
        Ok(false)
    }

    /// Returns all contacts and mechanisms on their edges.
    fn on_edges(&self, model: &Model<'_>, situation: &Situation, series: &Series) -> Vec<OnEdge> {
        let mut on_edge = Vec::new();
        for (place, unknown) in self.unknowns.iter().enumerate() {
            let state = &situation.contacts[unknown.contact];
            let (Edge::On(at, _), true) = (state.edge, state.sticks()) else {
                continue;
            };
            let first = side_of(unknown.force);
            for side in [first, first.opposite()] {
                if at.is_none_or(|at| at == side) {
                    on_edge.push(OnEdge {
                        of: Of::Contact(unknown.contact),
                        parts: vec![(place, 1.0)],
                        side,
                        distance: deciding_distance(&series.contacts[unknown.contact], side),
                    });
                }
            }
        }
        for (number, mechanism) in situation.mechanisms.iter().enumerate() {
            let Edge::On(at, _) = mechanism.edge else {
                continue;
            };
            for side in [Direction::Lagging, Direction::Leading] {
                if at.is_none_or(|at| at == side) {
                    on_edge.push(OnEdge {
                        of: Of::Mechanism(number),
                        parts: self.parts_of(mechanism),
                        side,
                        distance: mechanism.deciding_distance(model, series, side),
                    });
                }
            }
        }
        on_edge
    }

    /// The contacts on an edge that slip, by the programme for the coefficients of an order: the
    /// changes of the forces and the accelerations from those of stick.
    fn rates(
        &self,
        model: &Model<'_>,
        series: &Series,
        order: usize,
        on_edge: &[OnEdge],
    ) -> Result<Vec<Slipping>, Unsolved> {
        let mut unknowns = self.remaining();
        for unknown in &mut unknowns {
            (unknown.free, unknown.terms, unknown.most) = (0.0, 0.0, [f64::INFINITY; 2]);
        }
        for on in on_edge {
            let (at, coefficient) = on.distance.unwrap_or((TERMS, 0.0));
            if at < order {
                continue;
            }
            for &(place, part) in &on.parts {
                let contact = self.unknowns[place].contact;
                let Some(unknown) = unknowns.iter_mut().find(|u| u.contact == contact) else {
                    continue;
                };
                let side = Mechanism::slips(part, on.side);
                let (of, root) = (&series.contacts[contact], root_of(model, contact));
                let (most, size) = match on.of {
                    Of::Contact(_) if at == order => (coefficient, coefficient.abs()),
                    Of::Contact(_) => (0.0, 0.0),
                    Of::Mechanism(_) => {
                        let most = of.bound(side)[order] - side.sign() * of.carried[order];
                        let rounding = of.rounding(side, order);
                        (most, rounding / (EDGE_ROUNDING * f64::EPSILON))
                    }
                };
                unknown.most[side.place()] = most / root;
                unknown.terms = unknown.terms.max(size / root);
            }
        }
        solve(model, series, &mut unknowns)?;
        let slipping = unknowns.iter().filter_map(|unknown| {
            Some(Slipping {
                place: self.place(unknown.contact)?,
                side: unknown.moves()?,
                acceleration: unknown.acceleration,
            })
        });
        Ok(slipping.collect())
    }
}

fn root_of(model: &Model<'_>, contact: usize) -> f64 {
    model.contacts[contact].compliance.sqrt()
}

/// The forces by which mechanisms that have reached their bounds exceed them, on the contacts that
/// hold: see [`Decision::new`].
fn beyond_mechanisms(
    model: &Model<'_>,
    situation: &Situation,
    series: &Series,
    mut forces: Vec<f64>,
) -> Vec<(usize, f64)> {
    /// Each of several mechanisms changes the others.
    const SWEEPS: usize = 20;
    let contacts = &situation.holding.contacts;
    let place = |c: usize| contacts.iter().position(|&other| other == c);
    let mut beyond = vec![0.0; contacts.len()];
    let reached = |mechanism: &&Mechanism| matches!(mechanism.edge, Edge::On(Some(_), 1));
    let reached: Vec<&Mechanism> = situation.mechanisms.iter().filter(reached).collect();
    let sweeps = if reached.len() > 1 { SWEEPS } else { 1 };
    for _ in 0..sweeps {
        for mechanism in &reached {
            let Edge::On(Some(side), _) = mechanism.edge else {
                continue;
            };
            let parts = mechanism.parts.iter();
            let held = parts
                .clone()
                .filter_map(|&(c, part)| Some((place(c)?, part)));
            let held: Vec<(usize, f64)> = held.collect();
            let bound = mechanism.bound(model, series, side);
            let power: f64 = held.iter().map(|&(i, part)| part * forces[i]).sum();
            let size: f64 = held.iter().map(|(_, part)| part * part).sum();
            for (i, part) in held {
                let change = (power - side.sign() * bound) * part / size;
                forces[i] -= change;
                beyond[i] += change;
            }
        }
    }
    std::iter::zip(contacts.iter().copied(), beyond)
        .filter(|(_, beyond)| *beyond != 0.0)
        .collect()
}

/// The contacts that those at rest guide.
fn guided(model: &Model<'_>, situation: &Situation) -> Vec<Guided> {
    let holding = &situation.holding;
    let guided = |contact: usize, vectors: [&Entries; 2]| {
        let [slip, load] = vectors.map(|x| model.guiding(x, holding));
        let is_guided = slip.is_some() || load.is_some();
        is_guided.then_some(Guided {
            contact,
            slip,
            load,
        })
    };
    let springs = model.springs.iter().copied();
    let elastic = springs.filter_map(|c| {
        let contact = &model.contacts[c];
        let vectors = [&contact.direction, &contact.load_gradient[..]];
        contact.is_elastic().then(|| guided(c, vectors))?
    });
    let shared = model.shared.iter().copied();
    let passing = shared.filter_map(|c| {
        let state = &situation.contacts[c];
        let never_sticks = state.limits.is_none() && !state.phase_is_open();
        (never_sticks && state.rests()).then(|| guided(c, [&model.contacts[c].direction, &[]]))?
    });
    elastic.chain(passing).collect()
}

/// The error if a programme has no solution.
fn unsolved(reason: Unsolved, model: &Model<'_>, situation: &Situation, series: &Series) -> Error {
    let ascending = |mut contacts: Vec<usize>| {
        contacts.sort_unstable();
        contacts
    };
    match reason {
        Unsolved::Endless => situation.undecided(model, series),
        Unsolved::Jammed(contacts) => Error::Jammed {
            contacts: ascending(contacts),
            reached: situation.reached(model, series),
        },
        Unsolved::TooMany(TooMany { contacts, subsets }) => Error::TooManyMechanisms {
            contacts: ascending(contacts),
            subsets,
            most: MOST_SUBSETS,
            reached: Box::new(situation.reached(model, series)),
        },
    }
}

/// A contact or a mechanism on an edge.
struct OnEdge {
    of: Of,
    /// The contacts of the mechanism, by their places, and the parts with which they slip.
    parts: Vec<(usize, f64)>,
    side: Direction,
    /// Order and value of the coefficient of its distance from there that decides; `None` if all
    /// are 0.
    distance: Option<(usize, f64)>,
}

#[derive(Debug, Clone, Copy)]
enum Of {
    Contact(usize),
    Mechanism(usize),
}

/// A contact that slips in the solution of a programme.
struct Slipping {
    /// Place of the contact among the candidates.
    place: usize,
    side: Direction,
    acceleration: f64,
}

impl Candidate {
    /// Returns true if the kinetic limit is below the static limit for slip in a direction.
    fn falls(&self, side: Direction) -> bool {
        let [limit, kinetic] = [self.limits, self.kinetic].map(|of| of[side.place()]);
        limit - kinetic > 4.0 * f64::EPSILON * limit
    }

    /// The edge of its band at which it is, in stick.
    fn edge(&self, unknown: &Unknown) -> Edge {
        let (side, excess) = unknown.excess();
        let is_fresh = self.resting.has_arrived();
        let limit = self.limits[0].max(self.limits[1]);
        if is_fresh && limit.max(unknown.force.abs()) <= unknown.rounding {
            // No band yet, for the load begins: on both of its bounds.
            return Edge::reached(None);
        }
        if excess.abs() <= unknown.rounding {
            Edge::reached(Some(side))
        } else {
            Edge::Away
        }
    }
}
