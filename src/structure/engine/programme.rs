//! The programme for the forces λ and accelerations a of contacts with r = 0:
//!
//! ```text
//! a = a⁰ − G λ;   λ_c within its bounds where a_c = 0, at the bound against a_c elsewhere
//! ```
//!
//! It is convex, and a is unique. It is solved by pivoting: beginning with a guess of the contacts
//! that stick, the modes that violate their condition are changed until no condition is violated.
//!
//! The same programme holds for the values at an instant, with the limits of friction as bounds,
//! and for the coefficients of any order, where contacts on an edge of their band have one bound
//! and contacts inside it none.

use super::edge::{EDGE_ROUNDING, side_of};
use super::factor::Holding;
use super::model::Model;
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

/// Pivots until no condition is violated; `None` if that does not end.
pub(super) fn solve(model: &Model<'_>, unknowns: &mut [Unknown]) -> Option<()> {
    /// Changing the contact with the least number first always ends, but it can take 2ⁿ changes.
    /// The usual number is below n; the largest seen is 299, for eleven contacts on six
    /// coordinates.
    const MOST_CHANGES: usize = 1 << 14;
    let mut least_broken = usize::MAX;
    for _ in 0..MOST_CHANGES {
        evaluate(model, unknowns);
        let broken: Vec<usize> = (0..unknowns.len())
            .filter(|&i| unknowns[i].is_broken())
            .collect();
        if broken.is_empty() {
            return Some(());
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
    None
}

/// The contacts that stick, with their factor. Contacts with dependent directions get a small
/// compliance: they share the force, and their forces exceed the limits by far if they cannot all
/// stick.
pub(super) fn hold(model: &Model<'_>, unknowns: &[Unknown]) -> Holding {
    let sticking = unknowns.iter().filter(|unknown| unknown.sticks());
    let contacts: Vec<usize> = sticking.map(|unknown| unknown.contact).collect();
    let factor = model.factor(&contacts);
    let factor = factor.unwrap_or_else(|_| model.soft_factor(&contacts));
    Holding { contacts, factor }
}

/// Forces and accelerations of the choices.
fn evaluate(model: &Model<'_>, unknowns: &mut [Unknown]) {
    let Holding { contacts, factor } = hold(model, unknowns);
    let mut places = vec![None; model.contacts.len()];
    for (i, unknown) in unknowns.iter_mut().enumerate() {
        places[unknown.contact] = Some(i);
        unknown.rounding = 0.0;
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
        unknown.acceleration = 0.0;
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
        self.most[usize::from(side == Direction::Leading)]
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
