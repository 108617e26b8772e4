//! The vector field of a system near its steady sliding: its linear part, and its terms of second
//! and third order.

mod contact_modes;
mod small_motions;
pub(crate) mod spectrum;

use nalgebra::{DMatrix, DVector};

use super::engine::contact_data::{ContactData, Entries};
use super::engine::element_data::{ElementData, ElementTangent};
use super::engine::model::Model;
use crate::force::object::Place;
use crate::friction::memory::{Input, Motion, Sliding, Slip};
use crate::motion::Mode;
use crate::series::{PowerSeries, TERMS};
use crate::state::Direction;
use crate::state::structure::State;

/// The field x' = F(x) near steady sliding, x the displacements, velocities and memory variables.
#[derive(Debug)]
pub(crate) struct SlidingField<'m, 's> {
    model: &'m Model<'s>,
    /// Steady sliding.
    pub(crate) displacements: Vec<f64>,
    /// Accelerations of rigid-body motions that are not steady.
    pub(super) accelerations: Vec<f64>,
    /// The first-order states.
    pub(super) first_order: Vec<f64>,
    /// `None` for a contact that sticks.
    contacts: Vec<Option<Slides>>,
    /// The contacts that stick.
    pub(crate) held: Vec<Held>,
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

/// A contact that sticks.
#[derive(Debug)]
pub(crate) struct Held {
    pub(crate) contact: usize,
    /// The force that it carries.
    force: f64,
    /// The least change of this force that reaches a limit.
    pub(crate) margin: f64,
}

impl Slides {
    fn is_open(&self) -> bool {
        self.load == 0.0
    }
}

impl SlidingField<'_, '_> {
    /// The numbers of the contacts that stick.
    pub(crate) fn sticking(&self) -> Vec<usize> {
        self.held.iter().map(|held| held.contact).collect()
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
        varies && !self.held.is_empty()
    }

    /// The modes of the contacts.
    pub(crate) fn modes(&self) -> Vec<Mode> {
        let mode = |slides: &Option<Slides>| match slides {
            None => Mode::Stick,
            Some(slides) if slides.is_open() => Mode::Open,
            Some(slides) if slides.direction > 0.0 => Mode::Slip(Direction::Leading),
            Some(_) => Mode::Slip(Direction::Lagging),
        };
        self.contacts.iter().map(mode).collect()
    }

    /// Steady sliding as a state. Each elastic contact that slides carries its limit force.
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
        for held in &self.held {
            if self.model.contacts[held.contact].is_elastic() {
                memory[self.model.memory(held.contact)].fill(held.force);
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

    /// The places in a state of the memory variables and first-order states that influence small
    /// motions.
    pub(crate) fn acting(&self) -> Vec<usize> {
        let mut places = Vec::new();
        for (number, slides) in self.contacts.iter().enumerate() {
            let first = 2 * self.model.len() + self.model.memory(number).start;
            if let Some(Slides { sliding, .. }) = slides {
                let acts = (0..sliding.memory.len()).filter(|&j| !sliding.is_idle(j));
                places.extend(acts.map(|j| first + j));
            }
        }
        let states = std::iter::zip(&self.model.first_order, self.model.len()..);
        let acts = states.filter(|(state, _)| state.acts);
        places.extend(acts.map(|(_, place)| self.model.position_row(place)));
        places
    }

    /// ∂F/∂x for the perturbations that contacts which stick allow, without the forces of rigid
    /// ones and with elastic ones as springs; 0 for memory variables without influence.
    fn derivatives(&self) -> DMatrix<f64> {
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
            }
        }
        matrix
    }

    /// Adds a contact that sticks.
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
    let along = element.along(&|j| line[model.position_row(j)]);
    let positions = std::iter::zip(&tangent.positions, along);
    let positions = positions.map(|(x, part)| linear(*x, part));
    let velocities = element.along(&|j| if j < n { line[n + j] } else { 0.0 });
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
