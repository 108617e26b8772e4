//! The programme for the forces λ and accelerations a of contacts with r = 0:
//!
//! ```text
//! a = a⁰ − G λ;   λ_c within its bounds where a_c = 0, at the bound against a_c elsewhere
//! ```
//!
//! It is convex, and a is unique. The same programme holds for the values at an instant, with the
//! limits of friction as bounds, and for the coefficients of any order, where contacts on an edge
//! of their band have one bound and contacts inside it none.
//!
//! If the directions of all contacts are independent, it is solved by pivoting: beginning with a
//! guess of the contacts that stick, the modes that violate their condition are changed until no
//! condition is violated. Otherwise it is solved by an active set: the accelerations move along
//! faces on which some contacts rest and the others slip in given directions, to the minimum of ½
//! (a − a⁰)ᵀG⁻¹(a − a⁰) + Σ B_c |a_c| on each. A contact that comes to rest on the way joins those
//! at rest; at a minimum the mechanism whose bound is exceeded most leaves them. The sum falls from
//! round to round, so that this ends.

use super::cholesky::Holding;
use super::model::Model;
use super::redundant_contacts::{Mechanism, Resting, TooMany, disagreement};
use super::series::Series;
use super::stick_band_edge::{EDGE_ROUNDING, side_of};
use crate::state::Direction;

/// A contact with r = 0. Accelerations and forces are divided by √G_cc, so that G has a unit
/// diagonal.
#[derive(Debug, Clone)]
pub(super) struct Unknown {
    pub(super) contact: usize,
    /// a⁰ and the sum of the sizes of its terms.
    pub(super) free: f64,
    pub(super) terms: f64,
    /// The largest force against slip backward and forward.
    pub(super) most: [f64; 2],
    pub(super) choice: Choice,
    /// The solution: λ, a, and the rounding error of the unknown of these two (a in slip, λ in
    /// stick).
    pub(super) force: f64,
    pub(super) acceleration: f64,
    pub(super) rounding: f64,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Choice {
    Stick,
    Slip(Direction),
}

/// Why there is no solution.
#[derive(Debug)]
pub(super) enum Unsolved {
    Endless,
    TooMany(TooMany),
    /// Contacts of a circuit of which each slips in one direction only.
    Jammed(Vec<usize>),
}

/// Changing the contact with the least number first always ends, but it can take 2ⁿ changes. The
/// usual number is below n; the largest seen is 299, for eleven contacts on six coordinates.
const MOST_CHANGES: usize = 1 << 14;

/// Solves for forces and accelerations.
pub(super) fn solve(
    model: &Model<'_>,
    series: &Series,
    unknowns: &mut [Unknown],
) -> Result<(), Unsolved> {
    let contacts: Vec<usize> = unknowns.iter().map(|unknown| unknown.contact).collect();
    match model.factor(&contacts) {
        Ok(_) => pivot(model, unknowns),
        Err(_) => walk(model, series, unknowns),
    }
}

/// Pivots until no condition is violated.
fn pivot(model: &Model<'_>, unknowns: &mut [Unknown]) -> Result<(), Unsolved> {
    let mut least_broken = usize::MAX;
    for _ in 0..MOST_CHANGES {
        evaluate(model, unknowns, &hold(model, unknowns).holding);
        let broken: Vec<usize> = (0..unknowns.len())
            .filter(|&i| unknowns[i].is_broken())
            .collect();
        if broken.is_empty() {
            return Ok(());
        }
        // While the number of violations falls, all of them are changed together; otherwise only
        // the first.
        let count = if broken.len() < least_broken {
            broken.len()
        } else {
            1
        };
        least_broken = least_broken.min(broken.len());
        for &i in &broken[..count] {
            unknowns[i].change();
        }
    }
    Err(Unsolved::Endless)
}

/// Moves from face to face until no mechanism of the contacts at rest leaves them: from rest, or,
/// if all at rest have too many mechanisms, from the accelerations without friction.
fn walk(model: &Model<'_>, series: &Series, unknowns: &mut [Unknown]) -> Result<(), Unsolved> {
    for unknown in unknowns.iter_mut() {
        unknown.choice = Choice::Stick;
    }
    let parted = part_riders(model, series, unknowns)?;
    match walk_from(model, series, unknowns, (None, parted)) {
        Err(Unsolved::TooMany(_)) if unknowns.iter().all(Unknown::may_slip_freely) => {}
        found => return found,
    }
    for unknown in unknowns.iter_mut().filter(|unknown| unknown.free != 0.0) {
        unknown.choice = Choice::Slip(side_of(unknown.free));
    }
    let free = unknowns.iter().map(|unknown| unknown.free).collect();
    walk_from(model, series, unknowns, (Some(free), Vec::new()))
}

/// Solves the programme from given accelerations and choices, with contacts that cannot rest with
/// the others.
fn walk_from(
    model: &Model<'_>,
    series: &Series,
    unknowns: &mut [Unknown],
    (mut at, mut parted): (Option<Vec<f64>>, Vec<usize>),
) -> Result<(), Unsolved> {
    let mut has_left = vec![false; unknowns.len()];
    for _ in 0..MOST_CHANGES {
        let resting = hold(model, unknowns);
        evaluate(model, unknowns, &resting.holding);
        if let Some(at) = &mut at {
            // The velocities of these pass through 0 in no time.
            let turning = |i: &usize| {
                let unknown = &unknowns[*i];
                at[*i] == 0.0 && !unknown.sticks() && unknown.is_broken()
            };
            if let Some(i) = parted.iter().copied().find(turning) {
                let side = side_of(unknowns[i].acceleration);
                let contact = unknowns[i].contact;
                unknowns[i].choice = Choice::Slip(side);
                if unknowns[i].most(side) == f64::INFINITY {
                    unknowns[i].choice = Choice::Stick;
                    let own = -side.sign();
                    let parting = ((contact, own), &resting.holding);
                    parted.extend(part(model, series, unknowns, parting)?);
                }
                continue;
            }
            let first = first_at_rest(at, unknowns, &has_left);
            let way = first.map_or(1.0, |(_, way)| way);
            for (at, unknown) in std::iter::zip(&mut *at, &*unknowns) {
                *at += way * (unknown.acceleration - *at);
            }
            if let Some((i, _)) = first {
                at[i] = 0.0;
                let contact = unknowns[i].contact;
                unknowns[i].choice = Choice::Stick;
                if let Some(own) = disagreement(model, series, contact, &resting.holding) {
                    let parting = ((contact, own), &resting.holding);
                    parted.extend(part(model, series, unknowns, parting)?);
                }
                continue;
            }
        }
        at = Some(
            unknowns
                .iter()
                .map(|unknown| unknown.acceleration)
                .collect(),
        );
        let leaving = first_to_leave(&resting, unknowns).map_err(Unsolved::TooMany)?;
        if leaving.is_empty() {
            return Ok(());
        }
        for (i, side) in leaving {
            (unknowns[i].choice, has_left[i]) = (Choice::Slip(side), true);
        }
    }
    Err(Unsolved::Endless)
}

/// Riders on surfaces that do not move with the base cannot rest with it: they slip, in the
/// direction of the first derivative of their velocity that is not 0, until all that rest move
/// together. Returns their places.
fn part_riders(
    model: &Model<'_>,
    series: &Series,
    unknowns: &mut [Unknown],
) -> Result<Vec<usize>, Unsolved> {
    let mut parted = Vec::new();
    loop {
        // Anew after each: if one of the base has slipped in its place, others hold its riders.
        let resting = hold(model, unknowns);
        let is_rider = |c: &usize| resting.groups.iter().any(|g| g.riders().contains(c));
        let contacts = unknowns.iter().map(|unknown| unknown.contact);
        let mut parting = contacts.filter(is_rider).filter_map(|c| {
            let own = disagreement(model, series, c, &resting.holding)?;
            Some((c, own))
        });
        let Some(parting) = parting.next() else {
            return Ok(parted);
        };
        parted.push(give_way(model, unknowns, parting, &resting.holding)?);
    }
}

/// Lets a contact slip that cannot rest with those that hold, or one of these in its place, and
/// then those that cannot rest with the others. Returns their places.
fn part(
    model: &Model<'_>,
    series: &Series,
    unknowns: &mut [Unknown],
    (parting, holding): ((usize, f64), &Holding),
) -> Result<Vec<usize>, Unsolved> {
    let first = give_way(model, unknowns, parting, holding)?;
    let mut parted = part_riders(model, series, unknowns)?;
    parted.push(first);
    Ok(parted)
}

/// Lets a contact slip that cannot rest with those that hold, because its surface moves relative to
/// them with the sign `own`; if it does not slip this way, one of those on which it depends slips
/// in its place. Returns the place of the one that slips.
fn give_way(
    model: &Model<'_>,
    unknowns: &mut [Unknown],
    (contact, own): (usize, f64),
    holding: &Holding,
) -> Result<usize, Unsolved> {
    let parts = model.parts(contact, holding).0.into_iter();
    let others = parts.filter(|(c, part)| *part != 0.0 && *c != contact);
    let circuit: Vec<(usize, f64)> = std::iter::once((contact, -1.0)).chain(others).collect();
    for &(c, part) in &circuit {
        // r_d = Σ α_c r_c − (w_d − Σ α_c w_c) is 0 if one of these slips, or itself.
        let side = side_of(part * own);
        let place = unknowns.iter().position(|unknown| unknown.contact == c);
        if let Some(place) = place
            && unknowns[place].most(side) != f64::INFINITY
        {
            unknowns[place].choice = Choice::Slip(side);
            return Ok(place);
        }
    }
    Err(Unsolved::Jammed(
        circuit.into_iter().map(|(c, _)| c).collect(),
    ))
}

/// The slipping contact whose acceleration is the first to become 0 on the way to the solution of
/// its face, and the part of the way up to there.
fn first_at_rest(at: &[f64], unknowns: &[Unknown], has_left: &[bool]) -> Option<(usize, f64)> {
    let ways = std::iter::zip(at, unknowns).enumerate();
    let ways = ways.filter_map(|(i, (at, unknown))| {
        let Choice::Slip(side) = unknown.choice else {
            return None;
        };
        let [from, to] = [*at, unknown.acceleration].map(|a| side.sign() * a);
        let comes_to_rest = unknown.is_broken() || (!has_left[i] && unknown.moves().is_none());
        let way = from.max(0.0) / (from.max(0.0) - to.min(0.0));
        comes_to_rest.then_some((i, if way <= 1.0 { way } else { 1.0 }))
    });
    ways.min_by(|a, b| a.1.total_cmp(&b.1))
}

/// The contacts of the mechanism that exceeds its bound most, with the directions in which they
/// slip; none if no mechanism does.
fn first_to_leave(
    resting: &Resting,
    unknowns: &[Unknown],
) -> Result<Vec<(usize, Direction)>, TooMany> {
    let place = |c: usize| unknowns.iter().position(|unknown| unknown.contact == c);
    let mut first: (f64, Vec<(usize, Direction)>) = (0.0, Vec::new());
    for (i, unknown) in unknowns.iter().enumerate() {
        let is_single = unknown.sticks() && !resting.groups.iter().any(|g| g.has(unknown.contact));
        if is_single && unknown.is_broken() {
            let (side, excess) = unknown.excess();
            if excess > first.0 {
                first = (excess, vec![(i, side)]);
            }
        }
    }
    for mechanism in resting.mechanisms()? {
        let parts = mechanism.parts.iter();
        let parts = parts.filter_map(|&(c, part)| Some((place(c)?, part)));
        let parts: Vec<(usize, f64)> = parts.collect();
        let size: f64 = parts.iter().map(|(_, part)| part.abs()).sum();
        for side in [Direction::Lagging, Direction::Leading] {
            let (excess, rounding) = excess_of(unknowns, &parts, side);
            if excess > rounding && excess / size > first.0 {
                let slips = parts
                    .iter()
                    .map(|&(i, part)| (i, Mechanism::slips(part, side)));
                first = (excess / size, slips.collect());
            }
        }
    }
    Ok(first.1)
}

/// Excess of Σ λ_c s_c over its bound Σ B_c |s_c|, and its rounding error, for a mechanism that
/// moves to a side, given by its parts of the unknowns.
pub(super) fn excess_of(
    unknowns: &[Unknown],
    parts: &[(usize, f64)],
    side: Direction,
) -> (f64, f64) {
    let parts = parts.iter();
    parts.fold((0.0, 0.0), |(excess, rounding), &(i, part)| {
        let unknown = &unknowns[i];
        let most = part.abs() * unknown.most(Mechanism::slips(part, side));
        let of_most = if most.is_finite() {
            EDGE_ROUNDING * f64::EPSILON * most.abs()
        } else {
            0.0
        };
        (
            excess + side.sign() * part * unknown.force - most,
            rounding + part.abs() * unknown.rounding + of_most,
        )
    })
}

/// The contacts that stick.
pub(super) fn hold(model: &Model<'_>, unknowns: &[Unknown]) -> Resting {
    let sticking = unknowns.iter().filter(|unknown| unknown.sticks());
    model.resting(sticking.map(|unknown| unknown.contact).collect())
}

/// Forces and accelerations of the choices; riders of those that stick carry nothing.
pub(super) fn evaluate(model: &Model<'_>, unknowns: &mut [Unknown], holding: &Holding) {
    let Holding { contacts, factor } = holding;
    let mut places = vec![None; model.contacts.len()];
    for (i, unknown) in unknowns.iter_mut().enumerate() {
        places[unknown.contact] = Some(i);
        (unknown.rounding, unknown.acceleration) = (0.0, 0.0);
        unknown.force = match unknown.choice {
            Choice::Stick => 0.0,
            Choice::Slip(side) => side.sign() * unknown.most(side),
        };
    }
    let pulls = accelerations(model, unknowns, &places);
    let sticking = || contacts.iter().filter_map(|&c| places[c]);
    let mut forces: Vec<f64> = sticking().map(|i| pulls[i].0).collect();
    let mut rounding: Vec<f64> = sticking().map(|i| pulls[i].1).collect();
    factor.solve(&mut forces);
    factor.magnify(&mut rounding);
    for ((i, force), rounding) in sticking().zip(forces).zip(rounding) {
        let unknown = &mut unknowns[i];
        (unknown.force, unknown.rounding) = (force, rounding);
    }
    let pulls = accelerations(model, unknowns, &places);
    for (unknown, (pull, rounding)) in std::iter::zip(unknowns, pulls) {
        if !unknown.sticks() {
            (unknown.acceleration, unknown.rounding) = (pull, rounding);
        }
    }
}

/// a⁰ − G λ of every contact, and how far rounding may have moved it.
fn accelerations(
    model: &Model<'_>,
    unknowns: &[Unknown],
    places: &[Option<usize>],
) -> Vec<(f64, f64)> {
    let sum = |unknown: &Unknown| {
        let mut pull = unknown.free - unknown.force;
        let mut terms = unknown.terms + unknown.force.abs();
        let mut moved = 0.0;
        for &(d, g) in model.contacts[unknown.contact].coupled() {
            let Some(i) = places[d] else { continue };
            let other = &unknowns[i];
            pull -= g * other.force;
            terms += (g * other.force).abs();
            if other.sticks() {
                moved += g.abs() * other.rounding;
            }
        }
        (pull, EDGE_ROUNDING * f64::EPSILON * terms + moved)
    };
    unknowns.iter().map(sum).collect()
}

impl Unknown {
    /// A contact that is assumed to stick, with a⁰ and the sizes of its terms.
    pub(super) fn new(contact: usize, [free, terms]: [f64; 2], most: [f64; 2]) -> Self {
        Self {
            contact,
            free,
            terms,
            most,
            choice: Choice::Stick,
            force: 0.0,
            acceleration: 0.0,
            rounding: 0.0,
        }
    }

    /// Returns true if the contact may slip in the direction of its acceleration without friction.
    fn may_slip_freely(&self) -> bool {
        self.most(side_of(self.free)) != f64::INFINITY
    }

    pub(super) fn sticks(&self) -> bool {
        self.choice == Choice::Stick
    }

    /// The direction of slip with an acceleration that is not rounding.
    pub(super) fn moves(&self) -> Option<Direction> {
        match self.choice {
            Choice::Slip(side) if self.acceleration.abs() > self.rounding => Some(side),
            _ => None,
        }
    }

    /// The largest force against slip in a direction.
    pub(super) fn most(&self, side: Direction) -> f64 {
        self.most[side.place()]
    }

    /// The bound that the force in stick exceeds, or to which it is closer, and by how much.
    pub(super) fn excess(&self) -> (Direction, f64) {
        let side = side_of(self.force);
        let [own, other] = [side, side.opposite()].map(|side| {
            let excess = side.sign() * self.force - self.most(side);
            (side, excess)
        });
        if other.1 > own.1 { other } else { own }
    }

    fn is_broken(&self) -> bool {
        match self.choice {
            Choice::Stick => self.excess().1 > self.rounding,
            Choice::Slip(side) => side.sign() * self.acceleration < -self.rounding,
        }
    }

    /// Changes the mode that violates its condition.
    fn change(&mut self) {
        self.choice = match self.choice {
            Choice::Stick => Choice::Slip(self.excess().0),
            Choice::Slip(_) => Choice::Stick,
        };
    }
}
