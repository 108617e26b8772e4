//! The vector field of a system near its steady sliding: its equilibrium, its linear part, and its
//! terms of second and third order.

use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

use super::engine::contact::{ContactData, Entries};
use super::engine::element::{ElementData, ElementTangent};
use super::engine::limits::limit_force;
use super::engine::model::Model;
use super::equilibrium::{Equilibrium, ROUNDING, inverse_mass_times};
use super::freedom::{direction_row, elastic_rows, null_space, rate_rows, units};
use crate::error::{Error, NotSliding};
use crate::force::object::Place;
use crate::friction::memory::{Input, Motion, Sliding, Slip};
use crate::numerics::eigenvalues::{balance, eigenvalues as eigenvalues_of};
use crate::numerics::sort::sort_by;
use crate::series::{PowerSeries, TERMS};
use crate::state::Direction;
use crate::state::structure::State;

/// The field x' = F(x) near steady sliding, x the displacements, velocities and memory variables.
#[derive(Debug)]
pub(crate) struct SlidingField<'m, 's> {
    model: &'m Model<'s>,
    /// Steady sliding.
    pub(crate) displacements: Vec<f64>,
    /// Those of rigid-body motions that are not steady.
    pub(super) accelerations: Vec<f64>,
    /// The first-order states.
    pub(super) first_order: Vec<f64>,
    /// `None` for a contact that sticks.
    contacts: Vec<Option<Slides>>,
    /// The force elements at rest.
    elements: Vec<ElementTangent>,
}

/// A contact that slides steadily, or is open.
#[derive(Debug)]
struct Slides {
    sliding: Sliding,
    speed: f64,
    direction: f64,
    /// The load N; 0 for an open contact.
    load: f64,
}

impl Slides {
    fn is_open(&self) -> bool {
        self.load == 0.0
    }
}

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
    /// [`Structure::steady_sliding`](super::system::Structure::steady_sliding).
    pub(crate) fn of(model: &'m Model<'s>) -> Result<Self, Error> {
        Self::from(model, &vec![0.0; model.len()])
    }

    /// The same, searched from these displacements if there are force elements.
    pub(crate) fn from(model: &'m Model<'s>, start: &[f64]) -> Result<Self, Error> {
        Self::find(model, None, start).map_err(Error::NoSteadySliding)
    }

    /// The field near steady sliding at given velocities, under the conditions of
    /// [`Structure::steady_sliding_at`](super::system::Structure::steady_sliding_at).
    pub(crate) fn at(model: &'m Model<'s>, velocities: &[f64]) -> Result<Self, Error> {
        let start = vec![0.0; model.len()];
        Self::find(model, Some(velocities), &start).map_err(Error::NoSteadySliding)
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

    /// The same, beginning with given contacts open. The first contact whose load says the contrary
    /// is opened or closed, again and again.
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

    /// At rest all closed contacts slide; at given velocities those without a relative velocity
    /// stick.
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
        for (state, row) in std::iter::zip(&model.first_order, n..) {
            for &(i, x) in &state.responses {
                stiffness[(i, row)] -= x;
            }
            for &(j, a) in &state.displacements {
                stiffness[(row, j)] -= a;
            }
            for &(k, a) in &state.states {
                stiffness[(row, n + k)] -= a;
            }
        }
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
        for (&number, force) in std::iter::zip(&sticking, &balance.forces) {
            let contact = &model.contacts[number];
            let load = model.load_at(number, 0.0, |j| balance.positions[j], |_| 0.0);
            let limits = contact.law.limits(&|_| 0.0).unwrap_or([0.0; 2]);
            let limit = limit_force(load, limits[usize::from(*force > 0.0)]);
            let force = force.abs();
            if force > limit * (1.0 + ROUNDING) {
                return Err(NotSliding::OverLimit {
                    contact: number,
                    force,
                    limit,
                }
                .into());
            }
        }
        Ok(Self {
            model,
            displacements: balance.positions.as_slice()[..n].to_vec(),
            first_order: balance.positions.as_slice()[n..].to_vec(),
            accelerations: balance.accelerations.as_slice().to_vec(),
            contacts,
            elements,
        })
    }

    /// The numbers of the contacts that stick.
    pub(crate) fn sticking(&self) -> Vec<usize> {
        let numbers = 0..self.contacts.len();
        numbers.filter(|&c| self.contacts[c].is_none()).collect()
    }

    /// Returns true if the velocities are steady.
    pub(crate) fn is_steady(&self) -> bool {
        self.accelerations.iter().all(|a| *a == 0.0)
    }

    /// Returns true if the eigenvalues depend on the forces of contacts that stick: a load that
    /// depends on displacements changes the friction of a contact that slides.
    pub(crate) fn is_one_of_many(&self) -> bool {
        let contacts = std::iter::zip(&self.model.contacts, &self.contacts);
        let varies = contacts
            .into_iter()
            .filter(|(_, slides)| slides.as_ref().is_some_and(|slides| !slides.is_open()))
            .any(|(contact, _)| contact.load_follows());
        varies && self.contacts.iter().any(Option::is_none)
    }

    /// Steady sliding as a state. Each elastic contact carries its limit force.
    pub(crate) fn state(&self) -> State {
        let mut memory = vec![0.0; self.model.remembered()];
        for (number, (contact, slides)) in
            std::iter::zip(&self.model.contacts, &self.contacts).enumerate()
        {
            let Some(Slides { sliding, load, .. }) = slides else {
                continue;
            };
            let place = &mut memory[self.model.memory(number)];
            if contact.is_elastic() {
                place.fill(load * sliding.coefficient);
            } else {
                place.copy_from_slice(&sliding.memory);
            }
        }
        memory[self.model.state_place(0)..].copy_from_slice(&self.first_order);
        let zeros = vec![0.0; self.model.len()];
        State::new(&self.displacements, &zeros).with_memory(&memory)
    }

    /// Length of a state vector.
    fn order(&self) -> usize {
        2 * self.model.len() + self.model.remembered()
    }

    fn is_open(&self, contact: usize) -> bool {
        self.contacts[contact].as_ref().is_some_and(Slides::is_open)
    }

    /// The derivatives of the load of a contact by displacements and velocities that are not 0, by
    /// their places in a state; none for an open contact.
    fn load_slopes(&self, contact: usize) -> Vec<(usize, f64)> {
        if self.is_open(contact) {
            return Vec::new();
        }
        let contact = &self.model.contacts[contact];
        let mut loads = contact.load_gradient.clone();
        for e in contact.load_laws.clone() {
            let (law, tangent) = (&self.model.elements[e], &self.elements[e]);
            let factor = law.factor.value(0.0);
            for (first, slopes) in std::iter::zip([0, self.model.len()], &tangent.slopes) {
                let slope = factor * slopes[0];
                if slope != 0.0 {
                    let entries = law.directions[0].iter();
                    loads.extend(entries.map(|&(j, a)| (first + j, slope * a)));
                }
            }
        }
        loads
    }

    /// Adds the derivatives of the forces of elements to ∂F/∂x.
    fn add_elements(&self, matrix: &mut DMatrix<f64>) {
        let n = self.model.len();
        for (element, tangent) in std::iter::zip(&self.model.elements, &self.elements) {
            let (factor, m) = (element.factor.value(0.0), element.directions.len());
            for (by, slopes) in tangent.slopes.iter().enumerate() {
                for (response, slope) in std::iter::zip(&element.responses, slopes) {
                    for &(i, x) in response {
                        for &(j, a) in &element.directions[by % m] {
                            let column = match by < m {
                                true => self.model.position_row(j),
                                false if j < n => n + j,
                                false => continue,
                            };
                            matrix[(self.model.rate_row(i), column)] -= x * factor * slope * a;
                        }
                    }
                }
            }
        }
    }

    /// ∂F/∂x. A memory variable that neither changes in slip nor influences anything decays by
    /// itself.
    pub(crate) fn jacobian(&self) -> DMatrix<f64> {
        let (model, n) = (self.model, self.model.len());
        let mut matrix = DMatrix::zeros(self.order(), self.order());
        for i in 0..n {
            matrix[(i, n + i)] = 1.0;
        }
        let mut rates = matrix.view_mut((n, 0), (n, n));
        add_rows(&mut rates, -1.0, |i| model.stiffness.row(i));
        let mut rates = matrix.view_mut((n, n), (n, n));
        add_rows(&mut rates, -1.0, |i| model.damping.row(i));
        self.add_elements(&mut matrix);
        for (state, place) in std::iter::zip(&model.first_order, n..) {
            let row = model.position_row(place);
            for &(i, x) in &state.responses {
                matrix[(n + i, row)] += x;
            }
            for &(j, a) in &state.displacements {
                matrix[(row, j)] += a;
            }
            for &(j, a) in &state.velocities {
                matrix[(row, n + j)] += a;
            }
            for &(k, a) in &state.states {
                matrix[(row, model.position_row(n + k))] += a;
            }
        }
        for (number, (contact, slides)) in
            std::iter::zip(&model.contacts, &self.contacts).enumerate()
        {
            let first = 2 * n + model.memory(number).start;
            let loads = self.load_slopes(number);
            let Some(slides) = slides else {
                self.add_sticking(&mut matrix, number, &loads);
                continue;
            };
            let sliding = &slides.sliding;
            for &(i, x) in contact.responses() {
                let force = x * contact.compliance;
                for &(j, b) in contact.direction.iter() {
                    let slope = slides.direction * sliding.slope;
                    matrix[(n + i, n + j)] -= force * slides.load * slope * b;
                }
                for &(j, gradient) in &loads {
                    matrix[(n + i, j)] -= force * sliding.coefficient * gradient;
                }
                for (j, slope) in sliding.by_memory.iter().enumerate() {
                    matrix[(n + i, first + j)] -= force * slides.load * slope;
                }
            }
            add_reaction(&mut matrix, n, contact, &loads);
            if contact.is_elastic() {
                // The force follows the limit without delay.
                matrix[(first, first)] = -1.0;
            }
            for j in 0..sliding.memory.len() {
                for &(i, b) in contact.direction.iter() {
                    let rate = slides.direction * sliding.rates_by_speed[j];
                    matrix[(first + j, n + i)] += rate * b;
                }
                for &(i, gradient) in &loads {
                    matrix[(first + j, i)] += sliding.rates_by_load[j] * gradient;
                }
                for l in 0..sliding.memory.len() {
                    matrix[(first + j, first + l)] += sliding.rates_by_memory[(j, l)];
                }
                if sliding.is_idle(j) {
                    matrix[(first + j, first + j)] = -1.0;
                }
            }
        }
        matrix
    }

    /// Adds a contact that sticks. A rigid one adds nothing here: see
    /// [`eigenvalues`](Self::eigenvalues).
    fn add_sticking(&self, matrix: &mut DMatrix<f64>, number: usize, loads: &Entries) {
        let (contact, n) = (&self.model.contacts[number], self.model.len());
        add_reaction(matrix, n, contact, loads);
        for &(i, x) in contact.responses() {
            for &(j, b) in contact.direction.iter() {
                let stiffness = contact.tangential_stiffness.unwrap_or(0.0);
                matrix[(n + i, j)] -= x * contact.compliance * stiffness * b;
            }
        }
    }

    /// The eigenvalues, without the zeros of rigid-body motions, by falling real part, and the
    /// number of memory variables without influence; `None` if they do not converge.
    ///
    /// Displacements and velocities are in units of one energy. Rigid contacts that stick leave the
    /// perturbations b·δv = 0 only, and take the part P = 1 − X(BᵀX)⁻¹Bᵀ, X = M⁻¹B, of
    /// accelerations. Displacements along which no force changes, and velocities along which none
    /// changes, are left out: the matrix of the others has the remaining eigenvalues.
    pub(crate) fn eigenvalues(&self) -> Option<(Vec<Complex<f64>>, usize)> {
        let (model, n) = (self.model, self.model.len());
        let units = units(model);
        let scaled = |row: &DVector<f64>| DVector::from_fn(n, |j, _| row[j] * units[j]);
        let sticking = self.sticking();
        let rigid = sticking
            .iter()
            .filter(|&&c| !model.contacts[c].is_elastic());
        let rigid: Vec<DVector<f64>> = rigid.map(|&c| direction_row(model, c)).collect();
        // Rigid-body motions.
        let mut rows = elastic_rows(model);
        rows.extend(sticking.iter().map(|&c| direction_row(model, c)));
        let displaced = null_space(model, &rows);
        let mut active = Vec::new();
        let mut idle = 0;
        rows.extend(rate_rows(model));
        for (c, slides) in self.contacts.iter().enumerate() {
            let Some(Slides { sliding, .. }) = slides else {
                continue;
            };
            let first = 2 * n + model.memory(c).start;
            let (acts, none) = (0..sliding.memory.len()).partition(|&j| !sliding.is_idle(j));
            let (acts, none): (Vec<usize>, Vec<usize>) = (acts, none);
            idle += none.len() + usize::from(model.contacts[c].is_elastic());
            if sliding.slope != 0.0 || !acts.is_empty() {
                rows.push(direction_row(model, c));
            }
            active.extend(acts.into_iter().map(|j| first + j));
        }
        for (state, place) in std::iter::zip(&model.first_order, n..) {
            if state.acts {
                active.push(model.position_row(place));
            } else {
                idle += 1;
            }
        }
        let moved = null_space(model, &rows);
        // What is left, in units of one energy.
        let left = |motions: &[DVector<f64>]| {
            let unit = |e: &DVector<f64>| DVector::from_fn(n, |j, _| e[j] / units[j]);
            let motions = motions.iter().map(unit);
            complement(n, motions.chain(rigid.iter().map(scaled)))
        };
        let (displacements, velocities) = (left(&displaced), left(&moved));
        let mut matrix = self.jacobian();
        for (i, unit) in units.iter().enumerate() {
            for k in [i, n + i] {
                matrix.row_mut(k).unscale_mut(*unit);
                matrix.column_mut(k).scale_mut(*unit);
            }
        }
        let kept = velocities.transpose() * self.released(&rigid, &units)?;
        let elastic = &kept * matrix.view((n, 0), (n, n)) * &displacements;
        let damping = &kept * matrix.view((n, n), (n, n)) * &velocities;
        let same = displacements.ncols() == velocities.ncols();
        let mut values = if active.is_empty() && same && damping.iter().all(|c| *c == 0.0) {
            undamped(-elastic)?
        } else {
            let [m, k] = [&displacements, &velocities].map(DMatrix::ncols);
            let order = m + k + active.len();
            let mut reduced = DMatrix::zeros(order, order);
            let link = displacements.transpose() * &velocities;
            reduced.view_mut((0, m), (m, k)).copy_from(&link);
            reduced.view_mut((m, 0), (k, m)).copy_from(&elastic);
            reduced.view_mut((m, m), (k, k)).copy_from(&damping);
            for (j, &z) in active.iter().enumerate() {
                let acts = &kept * matrix.view((n, z), (n, 1));
                let loaded = matrix.view((z, 0), (1, n)) * &displacements;
                let driven = matrix.view((z, n), (1, n)) * &velocities;
                reduced.view_mut((m + k + j, 0), (1, m)).copy_from(&loaded);
                reduced.view_mut((m, m + k + j), (k, 1)).copy_from(&acts);
                reduced.view_mut((m + k + j, m), (1, k)).copy_from(&driven);
                for (l, &other) in active.iter().enumerate() {
                    reduced[(m + k + j, m + k + l)] = matrix[(z, other)];
                }
            }
            if !reduced.iter().all(|x| x.is_finite()) {
                return None;
            }
            let _ = balance(&mut reduced);
            eigenvalues_of(reduced)?
        };
        sort(&mut values);
        Some((values, idle))
    }

    /// P in units of one energy.
    fn released(&self, rigid: &[DVector<f64>], units: &[f64]) -> Option<DMatrix<f64>> {
        let n = units.len();
        let identity = DMatrix::identity(n, n);
        if rigid.is_empty() {
            return Some(identity);
        }
        let along = DMatrix::from_fn(n, rigid.len(), |j, c| rigid[c][j] * units[j]);
        let responses = along
            .column_iter()
            .map(|b| inverse_mass_times(self.model, units, &b.into_owned()));
        let responses = DMatrix::from_columns(&responses.collect::<Vec<_>>());
        let compliance = along.transpose() * &responses;
        let least = ROUNDING * compliance.amax();
        let inverse = compliance.pseudo_inverse(least).ok()?;
        Some(identity - responses * inverse * along.transpose())
    }

    /// The load of a contact along a line, as [`terms`](Self::terms) needs it.
    fn load_along(&self, contact: &ContactData<'_>, line: &DVector<f64>) -> PowerSeries {
        let at_rest = contact.load_at(0.0, |j| self.displacements[j]);
        let mut load = linear(at_rest, contact.displacement_load(|j| line[j]));
        for e in contact.load_laws.clone() {
            let law = &self.model.elements[e];
            let force = forces_along(self.model, law, &self.elements[e], line)[0];
            load.add(law.factor.value(0.0), &force);
        }
        load
    }

    /// The terms of second and third order along a line: the coefficients of t² and t³ in F(x̄ + t
    /// u). Friction and force elements alone have such terms.
    pub(crate) fn terms(&self, line: &DVector<f64>) -> [DVector<f64>; 2] {
        let (model, n) = (self.model, self.model.len());
        let mut terms = [DVector::zeros(self.order()), DVector::zeros(self.order())];
        for (element, tangent) in std::iter::zip(&model.elements, &self.elements) {
            let forces = forces_along(model, element, tangent, line);
            let factor = element.factor.value(0.0);
            for (response, force) in std::iter::zip(&element.responses, &forces) {
                for &(i, x) in response {
                    for (k, terms) in [2, 3].into_iter().zip(&mut terms) {
                        terms[model.rate_row(i)] -= x * factor * force[k];
                    }
                }
            }
        }
        for (number, (contact, slides)) in
            std::iter::zip(&model.contacts, &self.contacts).enumerate()
        {
            if self.is_open(number) {
                continue;
            }
            let loads = self.load_along(contact, line);
            for (k, terms) in [2, 3].into_iter().zip(&mut terms) {
                for &(i, y) in &contact.reaction {
                    terms[n + i] -= y * loads[k];
                }
            }
            let Some(slides) = slides else {
                continue;
            };
            let first = 2 * n + model.memory(number).start;
            let slip = contact.along(|j| line[n + j]);
            let speed = slides.speed;
            let speeds = linear(speed, slides.direction * slip);
            let memory = slides.sliding.memory.iter().enumerate();
            let memory: Vec<_> = memory.map(|(j, &z)| linear(z, line[first + j])).collect();
            let motion = Motion::Slip(Slip {
                speed: &speeds,
                direction: slides.direction,
                piece: contact.piece_above(speed),
            });
            let mut coefficient = PowerSeries::ZERO;
            let constant = |part: f64| PowerSeries::of(part);
            let mut inputs = vec![(Input::Speed, constant(slip))];
            inputs.extend((0..memory.len()).map(|j| (Input::Memory(j), constant(line[first + j]))));
            if !memory.is_empty() && contact.load_follows() {
                inputs.push((Input::Load, loads.derivative()));
            }
            for (by, parts) in inputs {
                let found = contact.law.derivative(motion, &loads, &memory, by);
                coefficient = found.coefficient;
                for (j, rate) in found.rates.iter().enumerate() {
                    // The rate changes along the line by its derivatives.
                    for (k, terms) in [2, 3].into_iter().zip(&mut terms) {
                        let sum = (0..k).map(|l| parts[l] * rate[k - 1 - l]).sum::<f64>();
                        terms[first + j] += sum / k as f64;
                    }
                }
            }
            for (k, terms) in [2, 3].into_iter().zip(&mut terms) {
                let force = (0..=k).map(|l| loads[l] * coefficient[k - l]).sum::<f64>();
                for &(i, x) in contact.responses() {
                    terms[n + i] -= x * contact.compliance * force;
                }
            }
        }
        terms
    }
}

/// Adds rows of a sparse matrix to a dense one.
fn add_rows<'r, S: nalgebra::StorageMut<f64, nalgebra::Dyn, nalgebra::Dyn>>(
    matrix: &mut nalgebra::Matrix<f64, nalgebra::Dyn, nalgebra::Dyn, S>,
    factor: f64,
    row: impl Fn(usize) -> (f64, &'r [(usize, f64)]),
) {
    for i in 0..matrix.nrows() {
        let (diagonal, beside) = row(i);
        matrix[(i, i)] += factor * diagonal;
        for &(j, entry) in beside {
            matrix[(i, j)] += factor * entry;
        }
    }
}

/// The series a + b t.
fn linear(a: f64, b: f64) -> PowerSeries {
    const { assert!(TERMS > 3) };
    PowerSeries::from_fn(|k| match k {
        0 => a,
        1 => b,
        _ => 0.0,
    })
}

/// The forces of an element along a line from steady sliding.
fn forces_along(
    model: &Model<'_>,
    element: &ElementData<'_>,
    tangent: &ElementTangent,
    line: &DVector<f64>,
) -> Vec<PowerSeries> {
    let n = model.len();
    let along = element.along(|j| line[model.position_row(j)]);
    let positions = std::iter::zip(&tangent.positions, along);
    let positions = positions.map(|(x, part)| linear(*x, part));
    let velocities = element.along(|j| if j < n { line[n + j] } else { 0.0 });
    let velocities = velocities.into_iter();
    let velocities = velocities.map(|part| linear(0.0, part));
    element.law.series(Place {
        positions: &positions.collect::<Vec<_>>(),
        velocities: &velocities.collect::<Vec<_>>(),
        piece: element.piece_above(tangent.positions[0]),
    })
}

/// The force of a normal spring, from the derivatives of the load.
fn add_reaction(matrix: &mut DMatrix<f64>, n: usize, contact: &ContactData<'_>, loads: &Entries) {
    for &(i, y) in &contact.reaction {
        for &(j, gradient) in loads {
            matrix[(n + i, j)] -= y * gradient;
        }
    }
}

/// An orthonormal basis of the vectors normal to all of some vectors.
fn complement(n: usize, vectors: impl Iterator<Item = DVector<f64>>) -> DMatrix<f64> {
    let mut squares = DMatrix::zeros(n, n);
    let mut is_whole = true;
    for vector in vectors {
        let unit = vector.normalize();
        squares.ger(1.0, &unit, &unit, 1.0);
        is_whole = false;
    }
    if is_whole {
        return DMatrix::identity(n, n);
    }
    let eigen = squares.symmetric_eigen();
    let largest = eigen.eigenvalues.amax();
    let is_normal = |i: &usize| eigen.eigenvalues[*i] <= ROUNDING * largest;
    let normal: Vec<usize> = (0..n).filter(is_normal).collect();
    eigen.eigenvectors.select_columns(&normal)
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

/// Eigenvalues s of s² + K: s² = −λ of K alone, so that the real parts of a symmetric K are exactly
/// 0.
fn undamped(stiffness: DMatrix<f64>) -> Option<Vec<Complex<f64>>> {
    let squares = eigenvalues_of(stiffness)?;
    let roots = squares.iter().map(|&square| (-square).sqrt());
    Some(roots.flat_map(|root| [root, -root]).collect())
}

/// By falling real part, then by falling imaginary part.
fn sort(values: &mut [Complex<f64>]) {
    // No −0, which would sort after 0.
    for value in values.iter_mut() {
        *value += Complex::new(0.0, 0.0);
    }
    sort_by(values, |value| -value.im);
    sort_by(values, |value| -value.re);
}
