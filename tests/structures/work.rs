//! What all forces do along a motion: by the law of motion, from states and modes alone.

use stick_slip::nalgebra::{DMatrix, DVector};
use stick_slip::structure::{State, Step};
use stick_slip::{AnyLaw, FrictionLaw, Mode, Segment, Structure};

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
        let (mut work, mut size) = (0.0, 0.0);
        // 10-point Gauss rule on each half.
        for half in [0.25, 0.75] {
            for (x, weight) in GAUSS.into_iter().flat_map(|(x, w)| [(x, w), (-x, w)]) {
                let t = (half + 0.25 * x) * duration;
                let state = step.state_at(t);
                let forces = self.forces(start + t, &state, step.modes());
                let [q, v] = [&state.displacements, &state.velocities]
                    .map(|x| DVector::from_column_slice(x));
                let mut parts = vec![forces.outer.dot(&v), -v.dot(&(&skew * &q))];
                let along = &self.rows * &v;
                parts.extend(forces.carried.iter().zip(&along).map(|(f, v)| -f * v));
                let weight = 0.25 * duration * weight;
                work += weight * parts.iter().sum::<f64>();
                size += weight * parts.iter().map(|part| part.abs()).sum::<f64>();
            }
        }
        (work, size)
    }
}

/// Points and weights of the 10-point Gauss rule on [−1, 1], one of each pair.
const GAUSS: [(f64, f64); 5] = [
    (0.148_874_338_981_631_21, 0.295_524_224_714_752_87),
    (0.433_395_394_129_247_19, 0.269_266_719_309_996_35),
    (0.679_409_568_299_024_41, 0.219_086_362_515_982_04),
    (0.865_063_366_688_984_51, 0.149_451_349_150_580_59),
    (0.973_906_528_517_171_72, 0.066_671_344_308_688_138),
];
