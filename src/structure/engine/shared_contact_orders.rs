//! The orders of contacts that share coordinates: friction of slipping contacts, and the forces of
//! sticking contacts, which are solved for together.

use super::cholesky::{Holding, ROUNDING};
use super::contact_data::ContactData;
use super::contact_series::StepMode;
use super::coordinate_series::CoordinateSeries;
use super::model::Model;
use super::series::Series;
use super::state::{Phase, Situation};
use super::stick_band_edge::Edge;
use crate::series::INTEGRAL;

/// Contribution of shared contacts to order k + 1 of the velocities: friction of those that slip,
/// then the forces of those that stick, G_SS λ = B_S a − w'.
pub(super) fn shared_order(
    model: &Model<'_>,
    situation: &Situation,
    series: &mut Series,
    k: usize,
    is_delicate: bool,
) {
    for &c in &model.shared {
        series.friction_order(model, c, k);
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
    if is_delicate {
        note_rounding(model, situation, series, k);
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
        if is_delicate && series.rates[j].abs() <= series.rounding[j] {
            series.rates[j] = 0.0;
        }
        let velocity = series.rates[j] * INTEGRAL[k];
        series.coordinates[j].motion.set_velocity(k + 1, velocity);
    }
    for &c in &model.shared {
        if let StepMode::Slip = series.contacts[c].mode {
            let contact = &model.contacts[c];
            let mut pull = pull(contact, series, c, k);
            if is_delicate && pull.abs() <= contact.size_along(|j| series.rounding[j]) {
                pull = 0.0;
            }
            let of = &mut series.contacts[c];
            let equation = match &of.guided {
                Some(guided) => of.side * (guided[k + 1] - of.surface[k + 1]),
                None => of.side * pull * INTEGRAL[k],
            };
            of.speeds[k + 1] = of.rate.filter(|_| k == 0).unwrap_or(equation);
        }
    }
}

/// Returns true if a contact is on an edge or on a breakpoint of its law, or slip begins without an
/// acceleration: the sign of the first nonzero coefficient then decides.
pub(super) fn is_delicate(model: &Model<'_>, situation: &Situation) -> bool {
    let mut mechanisms = situation.mechanisms.iter();
    mechanisms.any(|mechanism| mechanism.edge != Edge::Away)
        || model.shared.iter().any(|&c| {
            let state = &situation.contacts[c];
            match state.phase {
                Phase::Open => false,
                Phase::Stick { .. } => state.edge != Edge::Away,
                Phase::Slip { speed, rate, .. } => {
                    rate == Some(0.0) || model.contacts[c].breakpoints.contains(&speed)
                }
            }
        })
}

/// Notes the bound of rounding of order k of the accelerations, and sets forces of contacts on an
/// edge to 0 if they are rounding.
fn note_rounding(model: &Model<'_>, situation: &Situation, series: &mut Series, k: usize) {
    let mut sizes = std::mem::take(&mut series.rounding);
    for &j in &model.shared_coordinates {
        sizes[j] =
            free_size(model, &series.coordinates, j, k) + series.coordinates[j].force[k].abs();
    }
    for &c in &model.shared {
        let of = &series.contacts[c];
        if of.mode == StepMode::Slip {
            let friction: f64 = (0..=k)
                .map(|l| (of.load[l] * of.friction[k - l]).abs())
                .sum();
            for &(j, x) in model.contacts[c].responses() {
                sizes[j] += x.abs() * friction;
            }
        }
    }
    let Holding { contacts, factor } = &situation.holding;
    let root = |c: usize| model.contacts[c].compliance.sqrt();
    let size = |&c: &usize| {
        let of_surface = (k + 1) as f64 * series.contacts[c].surface[k + 1];
        (model.contacts[c].size_along(|j| sizes[j]) + of_surface.abs()) / root(c)
    };
    let mut of_forces: Vec<f64> = contacts.iter().map(size).collect();
    factor.magnify(&mut of_forces);
    for (place, (&c, size)) in std::iter::zip(contacts, of_forces).enumerate() {
        let state = &situation.contacts[c];
        if state.edge != Edge::Away || state.is_in_group {
            series.held[place] = unless_rounding(series.held[place], size);
            series.contacts[c].carried_rounding[k] = ROUNDING * size * root(c);
        }
        for &(j, x) in model.contacts[c].responses() {
            sizes[j] += x.abs() * size * root(c);
        }
    }
    for &j in &model.shared_coordinates {
        sizes[j] *= ROUNDING;
    }
    series.rounding = sizes;
}

/// The sum of the sizes of the terms of [`free_rate`].
fn free_size(model: &Model<'_>, coordinates: &[CoordinateSeries], i: usize, k: usize) -> f64 {
    let ((spring, springs), (damper, dampers)) = (model.stiffness.row(i), model.damping.row(i));
    let of_springs = springs
        .iter()
        .map(|&(j, a)| a * coordinates[j].motion.displacement(k));
    let of_dampers = dampers
        .iter()
        .map(|&(j, a)| a * coordinates[j].motion.velocity(k));
    let own = &coordinates[i].motion;
    (damper * own.velocity(k)).abs()
        + (spring * own.displacement(k)).abs()
        + of_springs.chain(of_dampers).map(f64::abs).sum::<f64>()
}

/// A difference, or 0 if it is the rounding of the minuend: held coordinates are at rest to the
/// bit, and their motion is no measure of anything.
pub(super) fn unless_rounding(difference: f64, from: f64) -> f64 {
    if difference.abs() <= ROUNDING * from.abs() {
        0.0
    } else {
        difference
    }
}

/// b·a − w' of order k.
pub(super) fn pull(contact: &ContactData<'_>, series: &Series, c: usize, k: usize) -> f64 {
    contact.along(|j| series.rates[j]) - (k + 1) as f64 * series.contacts[c].surface[k + 1]
}

impl Series {
    /// Order k of the law of a contact that shares coordinates, and the contribution of its
    /// friction in slip.
    pub(super) fn friction_order(&mut self, model: &Model<'_>, c: usize, k: usize) {
        let (contact, of) = (&model.contacts[c], &mut self.contacts[c]);
        of.load_order(contact, &self.coordinates, &self.elements, k);
        match of.mode {
            StepMode::Open => {}
            StepMode::Stick => of.stick_order(contact, k),
            StepMode::Slip => {
                let friction = of.side * of.slip_order(contact, k);
                for &(j, x) in contact.responses() {
                    self.rates[j] -= x * friction;
                }
            }
        }
    }
}
