//! What all forces do along a motion: by the law of motion, from states and modes alone.

use stick_slip::nalgebra::{DMatrix, DVector};
use stick_slip::structure::{State, Step};
use stick_slip::{AnyLaw, FrictionLaw, Mode, Segment, Structure, Trajectory};

use crate::common::orbit::integrate;

/// A structure whose contacts have laws of dry friction.
pub(crate) struct Work<'s> {
    structure: &'s Structure,
    laws: &'s [AnyLaw],
    mass: DMatrix<f64>,
    inverse: DMatrix<f64>,
    /// The rows b.
    rows: DMatrix<f64>,
}

/// Forces at an instant: of drives and dampers, and of contacts along their directions.
pub(crate) struct Forces {
    pub(crate) outer: DVector<f64>,
    pub(crate) carried: DVector<f64>,
}

impl<'s> Work<'s> {
    pub(crate) fn new(structure: &'s Structure, laws: &'s [AnyLaw]) -> Self {
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

    /// What contacts with these modes carry.
    pub(crate) fn forces(&self, time: f64, state: &State, modes: &[Mode]) -> Forces {
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
        let mut rates = &self.inverse * force;
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
            let held = compliance.cholesky().unwrap().solve(&pulls);
            rates -= &self.inverse * rows.transpose() * &held;
            for (&c, held) in stuck.iter().zip(&held) {
                carried[c] = *held;
            }
        }
        Forces { outer, carried }
    }

    /// Energy of a state.
    pub(crate) fn energy(&self, state: &State) -> f64 {
        let [q, v] =
            [&state.displacements, &state.velocities].map(|x| DVector::from_column_slice(x));
        0.5 * (v.dot(&(&self.mass * &v)) + q.dot(&(self.structure.stiffness() * &q)))
    }

    /// Work over a step of all that is not elastic, and the sum of the sizes of its parts:
    /// f·v − vᵀCv − qᵀK_aᵀv − Σ λ_c b_c·v, K_a the antisymmetric part of K.
    pub(crate) fn over(&self, step: &Step) -> (f64, f64) {
        let skew = (self.structure.stiffness() - self.structure.stiffness().transpose()) * 0.5;
        let (start, duration) = (step.start_time(), step.duration());
        let parts = |t: f64| {
            let state = step.state_at(t);
            let forces = self.forces(start + t, &state, step.modes());
            let [q, v] =
                [&state.displacements, &state.velocities].map(|x| DVector::from_column_slice(x));
            let along = &self.rows * &v;
            let contacts = forces.carried.iter().zip(&along).map(|(f, v)| -f * v);
            let outer = [forces.outer.dot(&v), -v.dot(&(&skew * &q))];
            let parts: Vec<f64> = contacts.chain(outer).collect();
            parts
        };
        let work = integrate(duration, |t| parts(t).iter().sum());
        let size = integrate(duration, |t| parts(t).iter().map(|part| part.abs()).sum());
        (work, size)
    }

    /// Work is the change of energy over every step, at round-off. Returns the largest part
    /// missing.
    pub(crate) fn balances(&self, motion: &Trajectory<State>, about: &str) -> f64 {
        let steps = motion.steps().iter().filter(|step| step.duration() > 0.0);
        let missing = steps.map(|step| {
            let (done, size) = self.over(step);
            let [a, b] = [step.state(), &step.end_state()].map(|state| self.energy(state));
            let apart = (b - a - done).abs() / (size + a.abs() + b.abs());
            assert!(apart < 1e-13, "{about} at {}: {apart:e}", step.start_time());
            apart
        });
        missing.fold(0.0, f64::max)
    }
}
