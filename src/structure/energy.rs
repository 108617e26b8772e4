//! Energies of a structure, and work and heat of each of its parts along a motion.

use std::iter::zip;

use super::engine::check_start;
use super::engine::instant::{Forces, Instant};
use super::engine::model::Model;
use super::engine::sparse::Sparse;
use super::step::Step;
use super::system::Structure;
use crate::error::Error;
use crate::motion::{EnergyBudget, Mode, Segment, Trajectory};
use crate::numerics::gauss::gauss_nodes;
use crate::state::structure::State;

/// Energies.
impl Structure {
    /// Kinetic energy ½ vᵀMv of a state.
    ///
    /// # Errors
    ///
    /// The errors of [`simulate`](Self::simulate) for a start state that is not valid;
    /// [`Error::InvalidState`] also if the energy overflows.
    pub fn kinetic_energy(&self, state: &State) -> Result<f64, Error> {
        let moving = State::new(&state.displacements, &state.velocities);
        check_start(&self.model(), 0.0, &moving)?;
        let energy = self.energies(&self.model()).kinetic(&state.velocities);
        finite(energy, state)
    }

    /// Elastic energy ½ qᵀKq + Σ T²/(2k_t) + Σ N²/(2k_n) + Σ D U of a state at a time: the energy
    /// of the stiffness matrix K, of elastic contacts with force T and stiffness k_t, of normal
    /// springs with load N and stiffness k_n that are closed at that time, and of force elements
    /// with the factor D whose laws have a potential U; U = ½kδ² of a stop where δ > 0.
    ///
    /// # Errors
    ///
    /// The errors of [`simulate`](Self::simulate) for a start state that is not valid;
    /// [`Error::InvalidState`] also if the energy overflows; [`Error::InvalidParameter`] if the
    /// time is not finite.
    ///
    /// ```
    /// use stick_slip::{Structure, structure::State};
    ///
    /// let pair = Structure::new(&[1.0, 2.0])?.with_spring(0, 1, 6.0)?;
    /// let state = State::new(&[0.5, 0.0], &[0.0, 3.0]);
    /// assert_eq!(pair.elastic_energy(0.0, &state)?, 0.75);
    /// assert_eq!(pair.kinetic_energy(&state)?, 9.0);
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    pub fn elastic_energy(&self, time: f64, state: &State) -> Result<f64, Error> {
        Error::check("Structure", "time", time, true, "any time")?;
        let model = self.model();
        check_start(&model, time, state)?;
        let energies = self.energies(&model);
        let springs = zip(self.contacts(), &energies.normal).enumerate();
        let springs = springs.map(|(c, (contact, normal))| {
            let load = contact.load_in(time, state).max(0.0);
            let carried = state.memory.get(model.memory(c).start);
            energies.of_contact(c, carried.copied().unwrap_or(0.0))
                + normal.map_or(0.0, |stiffness| 0.5 * load * load / stiffness)
        });
        let elements = model.forces_and_stops().map(|element| {
            let energy = element.potential(&|j| state.displacements[j]);
            element.factor.value(time) * energy
        });
        let energy =
            energies.elastic(&state.displacements) + springs.sum::<f64>() + elements.sum::<f64>();
        finite(energy, state)
    }

    /// Work and heat of each force, contact and damper along a motion of this structure.
    ///
    /// # Errors
    ///
    /// [`Error::WrongSize`] if the motion belongs to another structure; [`Error::InvalidState`],
    /// with a displacement and a velocity of the motion, if an energy overflows.
    pub fn energy_budget(&self, motion: &Trajectory<State>) -> Result<EnergyBudget, Error> {
        let model = self.model();
        check_motion(&model, motion)?;
        let budget = self.energies(&model).budget(motion.steps());
        finite(budget.defect(), &motion.last())?;
        Ok(budget)
    }

    /// The matrices and springs from which energies are computed.
    pub(crate) fn energies<'m, 's>(&self, model: &'m Model<'s>) -> Energies<'m, 's> {
        let normal = self.contacts().iter();
        Energies {
            model,
            mass: Sparse::new(&self.mass_matrix()),
            stiffness: Sparse::new(self.stiffness()),
            damping: Sparse::new(self.damping()),
            normal: normal
                .map(|contact| contact.normal_spring().map(|(_, stiffness)| stiffness))
                .collect(),
        }
    }
}

/// A number that follows from a state; the error shows the largest coordinate of a state for which
/// it overflows.
pub(super) fn finite(number: f64, state: &State) -> Result<f64, Error> {
    if number.is_finite() {
        return Ok(number);
    }
    let size = |(u, v): &(f64, f64)| u.abs().max(v.abs());
    let coordinates = zip(&state.displacements, &state.velocities).map(|(u, v)| (*u, *v));
    let largest = coordinates.max_by(|a, b| size(a).total_cmp(&size(b)));
    let (displacement, velocity) = largest.unwrap_or_default();
    Err(Error::InvalidState {
        displacement,
        velocity,
    })
}

/// Checks that a motion has the size of a structure.
pub(super) fn check_motion(model: &Model<'_>, motion: &Trajectory<State>) -> Result<(), Error> {
    let Some(first) = motion.steps().first() else {
        return Ok(());
    };
    let state = first.state();
    let sizes = [
        ("displacements", state.displacements.len(), model.len()),
        ("contacts", first.modes().len(), model.contacts.len()),
        ("stops", first.stops().len(), model.stops().len()),
        ("memory", state.memory.len(), model.remembered()),
    ];
    match sizes
        .into_iter()
        .find(|(_, found, expected)| found != expected)
    {
        Some((name, found, expected)) => Err(Error::WrongSize {
            name,
            found,
            expected,
        }),
        None => Ok(()),
    }
}

/// The matrices of a structure, for its energies.
pub(crate) struct Energies<'m, 's> {
    pub(crate) model: &'m Model<'s>,
    pub(crate) mass: Sparse,
    pub(crate) stiffness: Sparse,
    pub(crate) damping: Sparse,
    /// k_n of each contact.
    pub(crate) normal: Vec<Option<f64>>,
}

impl Energies<'_, '_> {
    fn kinetic(&self, v: &[f64]) -> f64 {
        0.5 * form(&self.mass, v, v)
    }

    fn elastic(&self, q: &[f64]) -> f64 {
        0.5 * form(&self.stiffness, q, q)
    }

    /// T²/(2k_t) of an elastic contact, and 0 of others.
    fn of_contact(&self, c: usize, carried: f64) -> f64 {
        let stiffness = self.model.contacts[c].tangential_stiffness;
        stiffness.map_or(0.0, |stiffness| 0.5 * carried * carried / stiffness)
    }

    /// N²/(2k_n) of each normal spring at one time.
    fn of_normals<'i>(&'i self, instant: &'i Instant) -> impl Iterator<Item = f64> + 'i {
        zip(&instant.contacts, &self.normal).map(|(at, normal)| {
            let load = at.load.max(0.0);
            normal.map_or(0.0, |stiffness| 0.5 * load * load / stiffness)
        })
    }

    /// E at one time.
    fn stored(&self, instant: &Instant) -> f64 {
        let State {
            displacements,
            velocities,
            ..
        } = &instant.state;
        let carried = instant.contacts.iter().enumerate();
        let carried = carried.map(|(c, at)| self.of_contact(c, at.carried));
        let springs = carried.chain(self.of_normals(instant)).sum::<f64>();
        let elements = zip(self.model.forces_and_stops(), &instant.elements);
        let elements =
            elements.map(|(element, at)| at.factor[0] * element.potential(&|j| displacements[j]));
        self.kinetic(velocities) + self.elastic(displacements) + springs + elements.sum::<f64>()
    }

    /// The budget of a motion of these steps.
    fn budget(&self, steps: &[Step]) -> EnergyBudget {
        self.along(steps).0
    }

    /// The budget of a period of these steps: drives may jump at its end, too.
    pub(crate) fn budget_of_period(&self, steps: &[Step]) -> EnergyBudget {
        let (mut budget, ends) = self.along(steps);
        if let Some((first, last)) = ends {
            budget.stored += self.add_jump(&mut budget, &last, &first);
        }
        budget
    }

    /// The budget of a motion of these steps, and its ends, with the drives of its own steps.
    fn along(&self, steps: &[Step]) -> (EnergyBudget, Option<(Instant, Instant)>) {
        let (model, contacts) = (self.model, self.model.contacts.len());
        let mut budget = EnergyBudget {
            force_work: vec![0.0; model.len()],
            drive_work: vec![0.0; contacts],
            belt_work: vec![0.0; contacts],
            friction_loss: vec![0.0; contacts],
            normal_work: vec![0.0; contacts],
            element_work: vec![0.0; model.force_elements().len()],
            first_order_work: vec![0.0; model.first_order.len()],
            stop_loss: vec![0.0; model.stops().len()],
            ..EnergyBudget::default()
        };
        let is_long = |step: &&Step| step.duration() > 0.0 && step.duration().is_finite();
        let mut ends: Option<(Instant, Instant)> = None;
        for step in steps.iter().filter(is_long) {
            let forces = Forces::of(model, step);
            let h = step.duration();
            for (t, weight) in gauss_nodes(0.0, h) {
                self.add(&mut budget, step, (t, weight), &forces.at(t));
            }
            // Drives at the end of a step belong to it: they may jump there.
            let (start, end) = (forces.at(0.0), forces.before(h));
            if let Some((_, last)) = &ends {
                self.add_jump(&mut budget, last, &start);
            }
            let first = ends.map_or(start, |(first, _)| first);
            ends = Some((first, end));
        }
        if let Some((first, last)) = &ends {
            budget.stored = self.stored(last) - self.stored(first);
        }
        (budget, ends)
    }

    /// Adds the contributions of one point of the quadrature, a time t after the start of a step.
    fn add(
        &self,
        budget: &mut EnergyBudget,
        step: &Step,
        (t, weight): (f64, f64),
        instant: &Instant,
    ) {
        let (q, v) = (&instant.state.displacements, &instant.state.velocities);
        for ((work, force), v) in zip(zip(&mut budget.force_work, &instant.forces), v) {
            *work += weight * force * v;
        }
        budget.damper_loss += weight * form(&self.damping, v, v);
        let skew = form(&self.stiffness, v, q) - form(&self.stiffness, q, v);
        budget.circulation -= 0.5 * weight * skew;
        for (c, at) in instant.contacts.iter().enumerate() {
            budget.drive_work[c] -= weight * at.carried * at.surface;
            budget.belt_work[c] -= weight * at.carried * at.velocity;
            let contact = &self.model.contacts[c];
            if let Mode::Slip(_) = step.modes()[c] {
                // The slider moves by r less what its spring takes up.
                let spring = contact.tangential_stiffness.map_or(0.0, |stiffness| {
                    let series = &step.series()[self.model.len() + self.model.memory(c).start];
                    series.slope_at(t) / stiffness
                });
                budget.friction_loss[c] += weight * at.carried * (at.relative - spring);
            }
            if let Some(stiffness) = self.normal[c].filter(|_| at.load > 0.0) {
                let pressed = contact.normal.iter().map(|&(j, d)| d * v[j]).sum::<f64>();
                let rate = instant.load_rate(self.model, c, step.clock().after(t));
                let rate = rate - stiffness * pressed;
                budget.normal_work[c] += weight * at.load * rate / stiffness;
            }
        }
        for (number, (work, data)) in
            zip(&mut budget.first_order_work, &self.model.first_order).enumerate()
        {
            let value = self
                .model
                .position(&instant.state, self.model.len() + number);
            let velocity = data.forces.iter().map(|&(j, b)| b * v[j]);
            *work += weight * value * velocity.sum::<f64>();
        }
        let elements = zip(self.model.forces_and_stops(), &instant.elements);
        for (e, (element, at)) in elements.enumerate() {
            let slopes = element.potential_slopes(&|j| q[j]);
            let parts = zip(element.along(&|j| v[j]), zip(&at.forces, slopes));
            let power = parts.map(|(velocity, (force, slope))| velocity * (force - slope));
            let [factor, change] = at.factor;
            let given = change * element.potential(&|j| q[j]);
            let work = weight * (given - factor * power.sum::<f64>());
            match e.checked_sub(budget.element_work.len()) {
                None => budget.element_work[e] += work,
                Some(stop) => budget.stop_loss[stop] -= work,
            }
        }
    }

    /// Adds the effect of a load or a factor that jumps between two steps: the slider of an elastic
    /// contact slips at once, a normal spring is pressed, and a potential changes. Returns the
    /// change of the stored energy.
    fn add_jump(&self, budget: &mut EnergyBudget, before: &Instant, after: &Instant) -> f64 {
        let mut stored = 0.0;
        for (c, loss) in budget.friction_loss.iter_mut().enumerate() {
            let [from, to] = [before, after].map(|at| self.of_contact(c, at.contacts[c].carried));
            *loss += from - to;
            stored += to - from;
        }
        let springs = zip(self.of_normals(before), self.of_normals(after));
        for (work, (from, to)) in zip(&mut budget.normal_work, springs) {
            *work += to - from;
            stored += to - from;
        }
        let factors = zip(&before.elements, &after.elements);
        let elements = zip(self.model.force_elements(), factors);
        for (work, (element, (from, to))) in zip(&mut budget.element_work, elements) {
            let energy = element.potential(&|j| after.state.displacements[j]);
            let change = (to.factor[0] - from.factor[0]) * energy;
            *work += change;
            stored += change;
        }
        stored
    }
}

/// xᵀAy.
fn form(matrix: &Sparse, x: &[f64], y: &[f64]) -> f64 {
    let rows = matrix.rows().enumerate();
    rows.map(|(i, (diagonal, beside))| {
        let own = diagonal * y[i];
        x[i] * beside.iter().fold(own, |sum, &(j, a)| sum + a * y[j])
    })
    .sum()
}
