//! The forces that a state determines, in the variational equations: those of elastic contacts, of
//! normal springs that open and close, of force elements and of first-order states.
//!
//! Saltation matrices of the events of springs are S = I for displacements and velocities, because
//! the forces of springs are continuous. If an elastic contact starts to slip or opens, or if its
//! load limits its force T, δT becomes the perturbation of the limit force.

use nalgebra::RowDVector;

use super::elements::ElementDerivatives;
use super::tangent::TangentFlow;
use super::variational_equations::load_at_end;
use crate::motion::{Mode, Segment};
use crate::structure::Step;
use crate::structure::engine::contact_data::entry;
use crate::structure::engine::element_data::ElementData;

impl TangentFlow<'_> {
    /// Sets δT of the elastic contacts that do not stick: σμ n·δq in slip, 0 while open.
    pub(super) fn limit_elastic(&mut self, modes: &[Mode]) {
        for (c, contact) in self.form.model.contacts.iter().enumerate() {
            if contact.is_elastic() && modes[c] != Mode::Stick {
                let side = match modes[c] {
                    Mode::Slip(side) => side.sign(),
                    Mode::Stick | Mode::Open => 0.0,
                };
                self.limit_carried(c, side);
            }
        }
    }

    /// Sets δT of an elastic contact to σμ n·δq.
    pub(super) fn limit_carried(&mut self, c: usize, side: f64) {
        let contact = &self.form.model.contacts[c];
        let coefficient = side * contact.constant_coefficient();
        let mut carried = self.tangents.row(0) * 0.0;
        for &(j, n) in &contact.load_gradient {
            carried += self.tangents.row(j) * (coefficient * n);
        }
        let row = self.form.carried_row(c);
        self.tangents.row_mut(row).copy_from(&carried);
    }

    /// δT of an elastic contact that closed at t_c and sticks: T = k_t r (t − t_c).
    pub(super) fn closed(&self, step: &Step, contact: usize) -> RowDVector<f64> {
        let data = &self.form.model.contacts[contact];
        let stiffness = data.tangential_stiffness.unwrap_or(0.0);
        let velocities = step.end_state().velocities;
        let surface = data.belt_velocity.series(step.clock()).at(step.duration());
        let velocity = data.along(|j| velocities[j]) - surface;
        self.load_later(step, contact) * (-stiffness * velocity)
    }

    /// The delay δt of the time at which displacements bring a load to 0; 0 if the load jumps.
    pub(super) fn load_later(&self, step: &Step, contact: usize) -> RowDVector<f64> {
        /// A load below this fraction of its terms counts as 0.
        const ZERO: f64 = 1e-9;
        let never = self.row(0) * 0.0;
        let data = &self.form.model.contacts[contact];
        let state = step.end_state();
        let displacement = |j: usize| state.displacements[j];
        let [load, rate] = load_at_end(&self.form.model, contact, step);
        let laws = self.form.model.load_laws(contact).iter();
        let sizes = laws.map(|law| {
            let tangent = law.tangent(&state.displacements, &state.velocities);
            tangent.forces[0].abs() + (tangent.slopes[0][0] * tangent.positions[0]).abs()
        });
        let size = data.load_size(displacement) + sizes.sum::<f64>();
        if !data.load_follows() || load.abs() > ZERO * size {
            return never;
        }
        let gradient = data.load_gradient.iter();
        let mut gradient = gradient.fold(never, |sum, &(j, n)| sum + self.row(j) * n);
        self.add_load_laws(&mut gradient, step, contact, 1.0);
        gradient * -rate.recip()
    }

    /// Adds the perturbation of the load of a contact by its laws at the end of a step, times a
    /// factor.
    pub(super) fn add_load_laws(
        &self,
        sum: &mut RowDVector<f64>,
        step: &Step,
        contact: usize,
        factor: f64,
    ) {
        let model = &self.form.model;
        for law in model.contacts[contact].load_laws.clone() {
            let derivatives = ElementDerivatives::of(model, law, step);
            for (first, slopes) in std::iter::zip([0, self.form.len()], &derivatives.0) {
                let slope = factor * slopes[0].series.at(step.duration());
                for &(j, a) in &model.elements[law].directions[0] {
                    *sum += self.row(first + j) * (slope * a);
                }
            }
        }
    }

    /// The perturbation of the acceleration v' of a coordinate by the springs of contacts, by force
    /// elements and by first-order states, at the end of a step.
    pub(super) fn by_springs(&self, step: &Step, i: usize) -> RowDVector<f64> {
        let model = &self.form.model;
        let mut rate = self.row(0) * 0.0;
        for (c, contact) in model.contacts.iter().enumerate() {
            if contact.is_elastic() {
                rate -= self.row(self.form.carried_row(c)) * entry(contact.responses(), i);
            }
            let reaction = entry(&contact.reaction, i);
            if reaction != 0.0 && step.modes()[c] != Mode::Open {
                for &(j, n) in &contact.load_gradient {
                    rate -= self.row(j) * (reaction * n);
                }
                self.add_load_laws(&mut rate, step, c, -reaction);
            }
        }
        for (data, place) in std::iter::zip(&model.first_order, model.len()..) {
            rate += self.row(model.position_row(place)) * entry(&data.responses, i);
        }
        for (e, element) in model.elements.iter().enumerate() {
            let response: Vec<f64> = responses_at(element, i).collect();
            if response.iter().all(|x| *x == 0.0) {
                continue;
            }
            let derivatives = ElementDerivatives::of(model, e, step);
            for (by, slopes) in derivatives.0.iter().enumerate() {
                let forces = std::iter::zip(&response, slopes);
                let forces = forces.map(|(x, slope)| x * slope.series.at(step.duration()));
                let force = forces.sum::<f64>();
                let (first, direction) = match by.checked_sub(response.len()) {
                    None => (0, &element.directions[by]),
                    Some(by) => (self.form.len(), &element.directions[by]),
                };
                for &(j, a) in direction {
                    rate -= self.row(first + j) * (force * a);
                }
            }
        }
        rate
    }

    /// The rate of the acceleration v' of a coordinate by the springs of contacts, by force
    /// elements and by first-order states, at the end of a step.
    pub(super) fn spring_rate(&self, step: &Step, i: usize) -> f64 {
        let (model, h) = (&self.form.model, step.duration());
        let rates = model.contacts.iter().enumerate().map(|(c, contact)| {
            let mut rate = 0.0;
            if contact.is_elastic() {
                let carried = &step.series()[self.form.carried_row(c) - self.form.len()];
                rate -= carried.slope_at(h) * entry(contact.responses(), i);
            }
            let reaction = entry(&contact.reaction, i);
            if reaction != 0.0 && step.modes()[c] != Mode::Open {
                rate -= load_at_end(model, c, step)[1] * reaction;
            }
            rate
        });
        let states = std::iter::zip(&model.first_order, model.len()..);
        let states = states.map(|(data, place)| {
            let series = &step.series()[model.position_row(place) - model.len()];
            series.slope_at(h) * entry(&data.responses, i)
        });
        let elements = model.elements.iter().enumerate().map(|(e, element)| {
            let response: Vec<f64> = responses_at(element, i).collect();
            if response.iter().all(|x| *x == 0.0) {
                return 0.0;
            }
            let forces = ElementDerivatives::forces(model, e, step);
            -std::iter::zip(response, forces)
                .map(|(x, force)| x * force.slope_at(h))
                .sum::<f64>()
        });
        rates.sum::<f64>() + elements.sum::<f64>() + states.sum::<f64>()
    }
}

/// (M⁻¹a)_i of each direction of an element.
fn responses_at(element: &ElementData<'_>, i: usize) -> impl Iterator<Item = f64> {
    let responses = element.responses.iter();
    responses.map(move |response| entry(response, i))
}
