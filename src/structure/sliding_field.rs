//! The vector field of a system near its steady sliding: its equilibrium, its linear part, and its
//! terms of second and third order.

use nalgebra::{DMatrix, DVector};

use super::engine::model::Model;
use super::steady::{sliding_of, solve};
use crate::error::{Error, NotSliding};
use crate::friction::memory::{Motion, Sliding, Slip};
use crate::series::{PowerSeries, TERMS};
use crate::state::structure::State;

/// The field x' = F(x) near steady sliding, x the displacements, velocities and memory variables.
#[derive(Debug)]
pub(crate) struct SlidingField<'m, 's> {
    model: &'m Model<'s>,
    /// Steady sliding.
    pub(crate) displacements: Vec<f64>,
    contacts: Vec<Slides>,
}

/// A contact that slides steadily.
#[derive(Debug)]
struct Slides {
    sliding: Sliding,
    direction: f64,
    /// The load N.
    load: f64,
}

impl<'m, 's> SlidingField<'m, 's> {
    /// The field near steady sliding, under the conditions of
    /// [`Structure::steady_sliding`](super::system::Structure::steady_sliding).
    pub(crate) fn of(model: &'m Model<'s>) -> Result<Self, Error> {
        Self::find(model).map_err(Error::NoSteadySliding)
    }

    fn find(model: &'m Model<'s>) -> Result<Self, NotSliding> {
        if !model.drives().all(|drive| drive.is_constant()) {
            return Err(NotSliding::Driven);
        }
        let contacts = model.contacts.iter().enumerate();
        let contacts = contacts.map(|(number, contact)| {
            sliding_of(&contact.belt_velocity, contact.law).map_err(|reason| reason(number))
        });
        let contacts: Vec<(Sliding, f64)> = contacts.collect::<Result<_, _>>()?;
        let n = model.len();
        let mut stiffness = DMatrix::zeros(n, n);
        add_rows(&mut stiffness, 1.0, |i| model.stiffness.row(i));
        let force = |i: usize| model.forces[i].value(0.0);
        let mut right = DVector::from_fn(n, |i, _| {
            let (diagonal, beside) = model.inverse_mass.row(i);
            let own = diagonal * force(i);
            beside.iter().fold(own, |sum, &(j, a)| sum + a * force(j))
        });
        for (contact, (sliding, _)) in std::iter::zip(&model.contacts, &contacts) {
            let coefficient = contact.compliance * sliding.coefficient;
            for &(i, x) in contact.responses() {
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
        let displacements = solve(&stiffness, &right).ok_or(NotSliding::Singular)?;
        let slides = contacts.into_iter().enumerate();
        let slides = slides.map(|(number, (sliding, direction))| {
            let contact = &model.contacts[number];
            let load = contact.load_at(0.0, |j| displacements[j]);
            if load > 0.0 {
                Ok(Slides {
                    sliding,
                    direction,
                    load,
                })
            } else {
                let contact = number;
                Err(NotSliding::NoLoad { contact, load })
            }
        });
        let contacts = slides.collect::<Result<_, _>>()?;
        Ok(Self {
            model,
            displacements: displacements.as_slice().to_vec(),
            contacts,
        })
    }

    /// Steady sliding as a state. Each elastic contact carries its limit force.
    pub(crate) fn state(&self) -> State {
        let mut memory = vec![0.0; self.model.remembered()];
        for (number, (contact, slides)) in
            std::iter::zip(&self.model.contacts, &self.contacts).enumerate()
        {
            let sliding = &slides.sliding;
            let place = &mut memory[self.model.memory(number)];
            if contact.is_elastic() {
                place.fill(slides.direction * slides.load * sliding.coefficient);
            } else {
                place.copy_from_slice(&sliding.memory);
            }
        }
        let zeros = vec![0.0; self.model.len()];
        State::new(&self.displacements, &zeros).with_memory(&memory)
    }

    /// Length of a state vector.
    fn order(&self) -> usize {
        2 * self.model.len() + self.model.remembered()
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
        for (number, (contact, slides)) in
            std::iter::zip(&model.contacts, &self.contacts).enumerate()
        {
            let (sliding, first) = (&slides.sliding, 2 * n + model.memory(number).start);
            for &(i, x) in contact.responses() {
                let force = x * contact.compliance;
                for &(j, b) in contact.direction.iter() {
                    let slope = slides.direction * sliding.slope;
                    matrix[(n + i, n + j)] -= force * slides.load * slope * b;
                }
                for &(j, gradient) in &contact.load_gradient {
                    matrix[(n + i, j)] -= force * sliding.coefficient * gradient;
                }
                for (j, slope) in sliding.by_memory.iter().enumerate() {
                    matrix[(n + i, first + j)] -= force * slides.load * slope;
                }
            }
            for &(i, y) in &contact.reaction {
                for &(j, gradient) in &contact.load_gradient {
                    matrix[(n + i, j)] -= y * gradient;
                }
            }
            if contact.is_elastic() {
                // The force follows the limit without delay.
                matrix[(first, first)] = -1.0;
            }
            for j in 0..sliding.memory.len() {
                for &(i, b) in contact.direction.iter() {
                    let rate = slides.direction * sliding.rates_by_speed[j];
                    matrix[(first + j, n + i)] += rate * b;
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

    /// The terms of second and third order along a line: the coefficients of t² and t³ in F(x̄ + t
    /// u). Friction alone has such terms.
    pub(crate) fn terms(&self, line: &DVector<f64>) -> [DVector<f64>; 2] {
        let (model, n) = (self.model, self.model.len());
        let mut terms = [DVector::zeros(self.order()), DVector::zeros(self.order())];
        for (number, (contact, slides)) in
            std::iter::zip(&model.contacts, &self.contacts).enumerate()
        {
            let first = 2 * n + model.memory(number).start;
            let slip = contact.along(|j| line[n + j]);
            let speed = contact.belt_velocity.value(0.0).abs();
            let speeds = linear(speed, slides.direction * slip);
            let memory = slides.sliding.memory.iter().enumerate();
            let memory: Vec<_> = memory.map(|(j, &z)| linear(z, line[first + j])).collect();
            let motion = Motion::Slip(Slip {
                speed: &speeds,
                direction: slides.direction,
                piece: contact.piece_above(speed),
            });
            let along = |by: Option<usize>| (by, by.map_or(slip, |j: usize| line[first + j]));
            let mut coefficient = PowerSeries::ZERO;
            let inputs =
                std::iter::once(along(None)).chain((0..memory.len()).map(|j| along(Some(j))));
            for (by, part) in inputs {
                let found = contact.law.derivative(motion, &memory, by);
                coefficient = found.coefficient;
                for (j, rate) in found.rates.iter().enumerate() {
                    // The rate changes along the line by its derivatives.
                    for (k, terms) in [2, 3].into_iter().zip(&mut terms) {
                        terms[first + j] += part * rate[k - 1] / k as f64;
                    }
                }
            }
            let load = contact.displacement_load(|j| line[j]);
            for (k, terms) in [2, 3].into_iter().zip(&mut terms) {
                let force = slides.load * coefficient[k] + load * coefficient[k - 1];
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
