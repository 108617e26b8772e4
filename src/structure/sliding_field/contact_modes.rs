//! Steady sliding: which contacts are open, slide or stick, and the forces in it.

use nalgebra::{DMatrix, DVector};

use super::super::engine::contact_data::ContactData;
use super::super::engine::first_order;
use super::super::engine::limits::limit_force;
use super::super::engine::model::Model;
use super::super::equilibrium_newton::{Equilibrium, ROUNDING};
use super::super::freedom::{direction_row, elastic_rows, null_space};
use super::{Held, Slides, SlidingField, add_rows};
use crate::error::{Error, NotSliding};
use crate::friction::memory::{Sliding, Slip};
use crate::numerics::least_norm::least_norm;
use crate::state::Direction;

/// Why there is no steady sliding in which given contacts are open.
enum NotFound {
    /// The load of this contact says the contrary.
    Contrary(usize, f64),
    Other(NotSliding),
}

impl From<NotSliding> for NotFound {
    fn from(reason: NotSliding) -> Self {
        Self::Other(reason)
    }
}

impl<'m, 's> SlidingField<'m, 's> {
    /// The field near steady sliding, under the conditions of
    /// [`Structure::steady_sliding`](super::super::system::Structure::steady_sliding).
    pub(crate) fn of(model: &'m Model<'s>) -> Result<Self, Error> {
        Self::from(model, &vec![0.0; model.len()])
    }

    /// Finds steady sliding, from the given displacements if there are force elements.
    pub(crate) fn from(model: &'m Model<'s>, start: &[f64]) -> Result<Self, Error> {
        Self::find(model, None, start).map_err(Error::NoSteadySliding)
    }

    /// The field near steady sliding at given velocities, under the conditions of
    /// [`Structure::steady_sliding_at`](super::super::system::Structure::steady_sliding_at).
    pub(crate) fn at(model: &'m Model<'s>, velocities: &[f64]) -> Result<Self, Error> {
        let start = vec![0.0; model.len()];
        Self::find(model, Some(velocities), &start).map_err(Error::NoSteadySliding)
    }

    /// The field near the equilibrium with all masses at rest: contacts whose surfaces move slide,
    /// and the others stick. What they alone hold has b·q = 0 of them.
    pub(crate) fn standing(model: &'m Model<'s>) -> Result<Self, Error> {
        let mut field = Self::at(model, &vec![0.0; model.len()])?;
        if !field.is_steady() {
            return Err(Error::NoSteadySliding(NotSliding::Singular));
        }
        let along = field.held.iter().map(|held| held.contact);
        let along: Vec<_> = along.map(|c| direction_row(model, c).transpose()).collect();
        let motions = null_space(model, &elastic_rows(model));
        if !along.is_empty() && !motions.is_empty() {
            let (along, motions) = (DMatrix::from_rows(&along), DMatrix::from_columns(&motions));
            let moved = &along * DVector::from_column_slice(&field.displacements);
            let back = least_norm(along * &motions, &moved, ROUNDING);
            let back = back.ok_or(Error::NoSteadySliding(NotSliding::Overflow))?;
            let back = motions * back;
            let places = std::iter::zip(&mut field.displacements, &back);
            places.for_each(|(x, back)| *x -= back);
        }
        Ok(field)
    }

    /// Steady sliding with the contacts open whose loads are negative there.
    fn find(
        model: &'m Model<'s>,
        velocities: Option<&[f64]>,
        start: &[f64],
    ) -> Result<Self, NotSliding> {
        let contacts = 0..model.contacts.len();
        let opens = |c: usize| model.contacts[c].may_open();
        let load = |c: usize| model.load_at(c, 0.0, |j| start[j], |_| 0.0);
        let closed = vec![false; contacts.len()];
        let found = Self::settle(model, velocities, start, closed.clone());
        let at_start: Vec<bool> = contacts.map(|c| opens(c) && load(c) < 0.0).collect();
        if found.is_ok() || at_start == closed {
            return found;
        }
        Self::settle(model, velocities, start, at_start).or(found)
    }

    /// Finds steady sliding, beginning with given contacts open. The first contact whose load says
    /// the contrary is opened or closed, again and again.
    ///
    /// Source: K. G. Murty, *Opsearch* 11 (1974): this ends if the equations are those of a
    /// P-matrix.
    fn settle(
        model: &'m Model<'s>,
        velocities: Option<&[f64]>,
        start: &[f64],
        mut open: Vec<bool>,
    ) -> Result<Self, NotSliding> {
        /// Number of changes for each contact.
        const MOST_CHANGES: usize = 8;
        let mut left = MOST_CHANGES * open.len();
        loop {
            match Self::with_open(model, velocities, start, &open) {
                Ok(found) => return Ok(found),
                Err(NotFound::Other(reason)) => return Err(reason),
                Err(NotFound::Contrary(contact, load)) => {
                    let is_edge = load == 0.0 && model.contacts[contact].load_follows();
                    if !model.contacts[contact].may_open() || is_edge || left == 0 {
                        return Err(NotSliding::NoLoad { contact, load });
                    }
                    open[contact] = !open[contact];
                    left -= 1;
                }
            }
        }
    }

    /// Solves for steady sliding with given contacts open. At rest all closed contacts slide; at
    /// given velocities the contacts without a relative velocity stick.
    fn with_open(
        model: &'m Model<'s>,
        velocities: Option<&[f64]>,
        start: &[f64],
        open: &[bool],
    ) -> Result<Self, NotFound> {
        if !model.drives().all(|drive| drive.is_constant()) {
            return Err(NotSliding::Driven.into());
        }
        let n = model.len();
        let at_rest = vec![0.0; n];
        let moving = velocities.unwrap_or(&at_rest);
        let contacts = model.contacts.iter().enumerate();
        let contacts = contacts.map(|(number, contact)| {
            let surface = [contact.belt_velocity.value(0.0), 0.0];
            let relative = contact.sliding_velocity(|j| moving[j], surface, 0.0);
            if !relative.is_finite() {
                return Err(NotSliding::Overflow);
            }
            if open[number] {
                let slip = slip_at(relative, contact).unwrap_or(STILL);
                let sliding = contact.law.sliding(slip, 0.0);
                let sliding = sliding.ok_or(NotSliding::NoSteadyMemory { contact: number })?;
                return Ok(Some((sliding, slip)));
            }
            let limits = contact.law.limits(&|_| 0.0);
            if let (Some(side), Some(limits)) = (Direction::of(relative), limits)
                && limits[side.place()] == f64::INFINITY
            {
                return Err(NotSliding::WrongWay {
                    contact: number,
                    velocity: relative,
                });
            }
            let is_frictionless = contact.law.constant() == Some(0.0);
            let may_stick = contact.is_elastic() || limits.is_some();
            if relative == 0.0 && velocities.is_some() && may_stick && !is_frictionless {
                return Ok(None);
            }
            if relative == 0.0 && contact.is_elastic() && !is_frictionless {
                return Err(NotSliding::Continuum { contact: number });
            }
            let slip = slip_at(relative, contact).or(is_frictionless.then_some(STILL));
            let Some(slip) = slip else {
                return Err(NotSliding::NoSpeed { contact: number });
            };
            let load = model.load_at(number, 0.0, |j| start[j], |_| 0.0).max(0.0);
            let sliding = contact.law.sliding(slip, load);
            let sliding = sliding.ok_or(NotSliding::NoSteadyMemory { contact: number })?;
            Ok(Some((sliding, slip)))
        });
        let contacts: Vec<Option<(Sliding, Slip<f64>)>> = contacts.collect::<Result<_, _>>()?;
        // With the rates of first-order states, −z' = 0, as further rows.
        let all = n + model.first_order.len();
        let mut stiffness = DMatrix::zeros(all, all);
        add_rows(&mut stiffness.view_mut((0, 0), (n, n)), 1.0, |i| {
            model.stiffness.row(i)
        });
        let force = |i: usize| model.forces[i].value(0.0);
        let mut right = DVector::from_fn(all, |i, _| {
            if let Some(state) = i.checked_sub(n) {
                let state = &model.first_order[state];
                let by_velocities = state.rate(|_| 0.0, |j| moving[j], |_| 0.0);
                return by_velocities + state.scale * state.drive.value(0.0);
            }
            let (diagonal, beside) = model.inverse_mass.row(i);
            let own = diagonal * force(i);
            beside.iter().fold(own, |sum, &(j, a)| sum + a * force(j))
        });
        let mut frictions = Vec::new();
        let numbers = std::iter::zip(&model.contacts, &contacts).enumerate();
        for (number, (contact, slides)) in numbers.filter(|&(number, _)| !open[number]) {
            let mut coefficient = None;
            if let Some((sliding, slip)) = slides {
                let is_warm = sliding.rates_by_load.iter().any(|by| *by != 0.0);
                if !contact.load_laws.is_empty() || contact.load_follows() && is_warm {
                    frictions.push((number, *slip));
                } else {
                    coefficient = Some(contact.compliance * sliding.coefficient);
                }
            }
            for &(i, x) in contact.responses() {
                let Some(coefficient) = coefficient else {
                    break;
                };
                right[i] -= x * coefficient * contact.load.value(0.0);
                for &(j, gradient) in &contact.load_gradient {
                    stiffness[(i, j)] += x * coefficient * gradient;
                }
            }
            // A normal spring acts on its own direction.
            for &(i, y) in &contact.reaction {
                right[i] -= y * contact.load.value(0.0);
                for &(j, gradient) in &contact.load_gradient {
                    stiffness[(i, j)] += y * gradient;
                }
            }
        }
        first_order::subtract(&model.first_order, &mut stiffness, n);
        let sticking = (0..contacts.len()).filter(|&c| contacts[c].is_none());
        let sticking: Vec<usize> = sticking.collect();
        for i in (0..n).filter(|_| velocities.is_some()) {
            let (diagonal, beside) = model.damping.row(i);
            let own = diagonal * moving[i];
            right[i] -= beside.iter().fold(own, |sum, &(j, c)| sum + c * moving[j]);
        }
        let equations = Equilibrium {
            model,
            stiffness,
            right,
            velocities,
            sticking: &sticking,
            frictions: &frictions,
            open,
        };
        let (balance, elements) = equations.solve(start)?;
        let slides = contacts.into_iter().enumerate();
        let slides = slides.map(|(number, slides)| {
            let contact = &model.contacts[number];
            let load = model.load_at(number, 0.0, |j| balance.positions[j], |_| 0.0);
            if load.is_nan() {
                let contact = number;
                return Err(NotSliding::NoLoad { contact, load }.into());
            }
            if open[number] != (load <= 0.0) {
                return Err(NotFound::Contrary(number, load));
            }
            let Some((sliding, slip)) = slides else {
                return Ok(None);
            };
            let sliding = if frictions.iter().any(|&(followed, _)| followed == number) {
                contact.law.sliding(slip, load)
            } else {
                Some(sliding)
            };
            Ok(Some(Slides {
                sliding: sliding.ok_or(NotSliding::NoSteadyMemory { contact: number })?,
                speed: slip.speed,
                direction: slip.direction,
                load: load.max(0.0),
            }))
        });
        let contacts = slides.collect::<Result<_, NotFound>>()?;
        let held = std::iter::zip(&sticking, &balance.forces).map(|(&number, &force)| {
            let contact = &model.contacts[number];
            let load = model.load_at(number, 0.0, |j| balance.positions[j], |_| 0.0);
            let limits = contact.law.limits(&|_| 0.0).unwrap_or([0.0; 2]);
            let limits = limits.map(|limit| limit_force(load, limit));
            let (size, limit) = (force.abs(), limits[usize::from(force > 0.0)]);
            if size > limit * (1.0 + ROUNDING) {
                return Err(NotSliding::OverLimit {
                    contact: number,
                    force: size,
                    limit,
                });
            }
            Ok(Held {
                contact: number,
                force,
                margin: (limits[0] + force).min(limits[1] - force),
            })
        });
        let held = held.collect::<Result<_, NotSliding>>()?;
        Ok(Self {
            model,
            displacements: balance.positions.as_slice()[..n].to_vec(),
            first_order: balance.positions.as_slice()[n..].to_vec(),
            accelerations: balance.accelerations.as_slice().to_vec(),
            contacts,
            held,
            elements,
        })
    }
}

/// Slip at r = 0, where friction has no direction only if there is none.
const STILL: Slip<f64> = Slip {
    speed: 0.0,
    direction: 1.0,
    piece: 0,
};

/// Slip at a relative velocity; `None` at 0.
fn slip_at(relative: f64, contact: &ContactData<'_>) -> Option<Slip<f64>> {
    let (direction, speed) = (Direction::of(relative)?, relative.abs());
    Some(Slip {
        speed,
        direction: direction.sign(),
        piece: contact.piece_above(speed),
    })
}
