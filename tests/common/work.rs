//! What all forces do along a motion: by the law of motion, from states and modes alone.

use stick_slip::nalgebra::{DMatrix, DVector};
use stick_slip::structure::{State, Step};
use stick_slip::{AnyLaw, FrictionLaw, Mode, Segment, Structure, Trajectory};

use crate::larger;
use crate::naive::is_definite;
use crate::orbit::integrate;

/// A structure whose contacts have laws of dry friction.
pub struct Work<'s> {
    structure: &'s Structure,
    laws: &'s [AnyLaw],
    mass: DMatrix<f64>,
    inverse: DMatrix<f64>,
    /// The rows b.
    rows: DMatrix<f64>,
}

impl<'s> Work<'s> {
    pub fn new(structure: &'s Structure, laws: &'s [AnyLaw]) -> Self {
        let mass = structure.mass_matrix().into_owned();
        let mut rows = DMatrix::zeros(laws.len(), structure.len());
        for (c, contact) in structure.contacts().iter().enumerate() {
            for &(j, b) in contact.direction() {
                rows[(c, j)] = b;
            }
        }
        Self {
            structure,
            laws,
            inverse: mass.clone().try_inverse().unwrap(),
            mass,
            rows,
        }
    }

    /// Whether that is determined: the directions of the contacts that stick are independent.
    pub fn is_determined(&self, modes: &[Mode]) -> bool {
        let sticks = |c: &usize| modes[*c] == Mode::Stick;
        let stuck: Vec<usize> = (0..modes.len()).filter(sticks).collect();
        let rows = self.rows.select_rows(&stuck);
        stuck.is_empty() || is_definite(&(&rows * &self.inverse * rows.transpose()))
    }

    /// What contacts with these modes carry.
    pub fn carried(&self, time: f64, state: &State, modes: &[Mode]) -> DVector<f64> {
        let structure = self.structure;
        let [q, v] =
            [&state.displacements, &state.velocities].map(|x| DVector::from_column_slice(x));
        let drives = structure.forces().iter().map(|force| force.value(time));
        let outer = DVector::from_iterator(q.len(), drives) - structure.damping() * &v;
        let mut carried = DVector::zeros(modes.len());
        let contacts = structure.contacts();
        for (c, mode) in modes.iter().enumerate() {
            if let Mode::Slip(direction) = mode {
                let r = (self.rows.row(c) * &v)[0] - contacts[c].belt_velocity().value(time);
                // At r = 0 the side of the slip counts.
                let speed = (direction.sign() * r).max(0.0);
                let load = contacts[c].load_at(time, q.as_slice());
                carried[c] = direction.sign() * load * self.laws[c].kinetic(speed);
            }
        }
        let force = &outer - structure.stiffness() * &q - self.rows.transpose() * &carried;
        let rates = &self.inverse * force;
        let stuck: Vec<usize> = (0..modes.len())
            .filter(|&c| modes[c] == Mode::Stick)
            .collect();
        if !stuck.is_empty() {
            let rows = self.rows.select_rows(&stuck);
            let slopes = stuck
                .iter()
                .map(|&c| contacts[c].belt_velocity().slope(time));
            let pulls = &rows * &rates - DVector::from_iterator(stuck.len(), slopes);
            let compliance = &rows * &self.inverse * rows.transpose();
            // Of dependent contacts the forces of the least norm.
            let held = match compliance.clone().cholesky() {
                Some(factor) if is_definite(&compliance) => factor.solve(&pulls),
                _ => compliance.svd(true, true).solve(&pulls, 1e-9).unwrap(),
            };
            for (&c, held) in stuck.iter().zip(&held) {
                carried[c] = *held;
            }
        }
        carried
    }

    /// Energy of a state: ½ vᵀMv + ½ qᵀKq.
    fn energy(&self, state: &State, time: f64, sum: &mut Sum, weight: f64) {
        let v = self.velocities(state, time);
        let q = sized(&state.displacements);
        sum.product(0.5 * weight, &v, &self.mass, &v);
        sum.product(0.5 * weight, &q, self.structure.stiffness(), &q);
    }

    /// The power of all that is not elastic: f·v − vᵀCv − qᵀK_aᵀv − Σ λ_c b_c·v, K_a the
    /// antisymmetric part of K.
    fn power(&self, state: &State, time: f64, modes: &[Mode]) -> Sum {
        let mut sum = Sum::default();
        let structure = self.structure;
        let v = self.velocities(state, time);
        let q = sized(&state.displacements);
        let skew = (structure.stiffness() - structure.stiffness().transpose()) * 0.5;
        sum.product(-1.0, &v, structure.damping(), &v);
        sum.product(-1.0, &v, &skew, &q);
        for (force, v) in structure.forces().iter().zip(&v) {
            sum.add(force.value(time), *v);
        }
        let carried = self.carried(time, state, modes);
        for (c, contact) in structure.contacts().iter().enumerate() {
            for &(j, b) in contact.direction() {
                sum.add(-carried[c] * b, v[j]);
            }
        }
        sum
    }

    /// The velocities. Those under a contact are the sum of a relative velocity and that of its
    /// surface, however small they are themselves.
    fn velocities(&self, state: &State, time: f64) -> Vec<Sum> {
        let mut velocities = sized(&state.velocities);
        for contact in self.structure.contacts() {
            for &(j, _) in contact.direction() {
                velocities[j].size += contact.belt_velocity().value(time).abs();
            }
        }
        velocities
    }

    /// What is missing in the balance of energy and work over a step, with the sizes of all terms.
    pub fn missing(&self, step: &Step) -> Sum {
        let (start, duration) = (step.start_time(), step.duration());
        let power = |t: f64| self.power(&step.state_at(t), start + t, step.modes());
        let mut sum = Sum {
            value: integrate(duration, |t| power(t).value),
            size: integrate(duration, |t| power(t).size),
        };
        self.energy(step.state(), start, &mut sum, 1.0);
        self.energy(&step.end_state(), start + duration, &mut sum, -1.0);
        sum
    }

    /// Work is the change of energy over every step, at round-off. Returns the largest part
    /// missing.
    pub fn balances(&self, motion: &Trajectory<State>, about: &str) -> f64 {
        let steps = motion.steps().iter().filter(|step| step.duration() > 0.0);
        let parts = steps.map(|step| {
            let missing = self.missing(step);
            let part = missing.part(f64::MIN_POSITIVE);
            let time = step.start_time();
            assert!(part < 1e-13, "{about} at {time}: {missing:?}");
            part
        });
        parts.fold(0.0, larger)
    }
}

/// A sum, and the sum of the sizes of its terms.
#[derive(Debug, Clone, Copy, Default)]
pub struct Sum {
    value: f64,
    size: f64,
}

impl Sum {
    fn add(&mut self, factor: f64, term: Sum) {
        self.value += factor * term.value;
        self.size += factor.abs() * term.size;
    }

    /// Adds a weight times xᵀAy.
    fn product(&mut self, weight: f64, x: &[Sum], a: &DMatrix<f64>, y: &[Sum]) {
        for (i, x) in x.iter().enumerate() {
            for (j, y) in y.iter().enumerate() {
                let entry = weight * a[(i, j)];
                self.value += entry * x.value * y.value;
                self.size += entry.abs() * x.size * y.size;
            }
        }
    }

    /// The value in parts of the size; of terms below the least, all is rounding of larger ones
    /// before.
    pub fn part(&self, least: f64) -> f64 {
        self.value.abs() / self.size.max(least)
    }
}

fn sized(values: &[f64]) -> Vec<Sum> {
    let of = |&value: &f64| Sum {
        value,
        size: value.abs(),
    };
    values.iter().map(of).collect()
}
