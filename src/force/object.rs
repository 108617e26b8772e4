//! A force law as a trait object, for the engine of structures: the engine and the searches are
//! compiled once, for any law.

use std::any::Any;

use super::{ForceField, ForceLaw};
use crate::friction::memory::Variables;
use crate::scalar::Scalar;
use crate::scalar::dual::Dual;
use crate::scalar::jet::{Jet, Tape};
use crate::scalar::lanes::LANES;
use crate::scalar::recorded::{Output, Recorder};
use crate::series::PowerSeries;
use crate::series::many::{Block, GROUPS, values_of};

/// Positions and velocities along the directions of a force, and the piece of its law.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Place<'p, S> {
    pub(crate) positions: &'p [S],
    pub(crate) velocities: &'p [S],
    pub(crate) piece: usize,
}

/// The series of a force element along a motion.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Along<'p> {
    pub(crate) place: Place<'p, PowerSeries>,
    /// F_i.
    pub(crate) forces: &'p [PowerSeries],
    /// D.
    pub(crate) factor: &'p PowerSeries,
}

/// The law of a force without its type.
pub(crate) trait ForceObject {
    /// Number of directions.
    fn count(&self) -> usize;
    /// Positions at which pieces of the law meet; none with several directions.
    fn breakpoints(&self) -> Vec<f64>;
    /// F_i.
    fn forces(&self, place: Place<'_, f64>) -> Vec<f64>;
    /// The derivative of each F_i by an input: position `by`, or velocity `by` − m.
    fn slopes(&self, place: Place<'_, f64>, by: usize) -> Vec<f64>;
    /// U.
    fn potential(&self, place: Place<'_, f64>) -> Option<f64>;
    /// ∂U/∂x_i.
    fn potential_slope(&self, place: Place<'_, f64>, by: usize) -> Option<f64>;
    /// Coefficient k of each F_i along a motion, of which the first k are given.
    fn order(
        &self,
        tape: &mut Tape,
        k: usize,
        place: Place<'_, PowerSeries>,
        forces: &mut [PowerSeries],
    );
    /// The operations that give F_i at the start of a motion, from the positions and then the
    /// velocities.
    fn record(&self, recorder: &mut Recorder, place: Place<'_, PowerSeries>, i: usize) -> Output;
    /// Adds, for each F_i, the largest |D| |F_i(x(t), y(t)) − F_i(t)| in each group of four times
    /// to one of its sums: `kinds` has the number of the sum for each group.
    fn add_defects(&self, along: Along<'_>, times: &Block, kinds: &[usize], sums: &mut [[f64; 3]]);
    /// The derivative of each F_i by an input at the start of a motion.
    fn start_slopes(&self, place: Place<'_, PowerSeries>, by: usize, slopes: &mut [f64]);
    /// The series of each F_i along a motion.
    fn series(&self, place: Place<'_, PowerSeries>) -> Vec<PowerSeries>;
    /// The series of the derivative of each F_i by an input.
    fn derivative(&self, place: Place<'_, PowerSeries>, by: usize) -> Vec<PowerSeries>;
    /// The law with its type.
    fn any(&self) -> &dyn Any;
}

/// A law of one direction, or a field, as what both have in common.
trait Forces {
    type Coordinates<S: Scalar>: Variables<S>;
    fn at<S: Scalar>(
        &self,
        positions: Self::Coordinates<S>,
        velocities: Self::Coordinates<S>,
        piece: usize,
    ) -> Self::Coordinates<S>;
    fn energy<S: Scalar>(&self, positions: Self::Coordinates<S>, piece: usize) -> Option<S>;
    fn breakpoints(&self) -> Vec<f64>;
}

/// A law of one direction.
#[derive(Clone, Copy)]
pub(crate) struct OneDirection<L>(pub(crate) L);

/// A field.
pub(crate) struct SeveralDirections<F>(pub(crate) F);

impl<L: ForceLaw> Forces for OneDirection<L> {
    type Coordinates<S: Scalar> = [S; 1];

    #[inline(always)]
    fn at<S: Scalar>(&self, [x]: [S; 1], [y]: [S; 1], piece: usize) -> [S; 1] {
        [self.0.force(x, y, piece)]
    }

    fn energy<S: Scalar>(&self, [x]: [S; 1], piece: usize) -> Option<S> {
        self.0.potential(x, piece)
    }

    fn breakpoints(&self) -> Vec<f64> {
        self.0.breakpoints().collect()
    }
}

impl<F: ForceField> Forces for SeveralDirections<F> {
    type Coordinates<S: Scalar> = F::Coordinates<S>;

    #[inline(always)]
    fn at<S: Scalar>(
        &self,
        positions: F::Coordinates<S>,
        velocities: F::Coordinates<S>,
        _: usize,
    ) -> F::Coordinates<S> {
        self.0.forces(positions, velocities)
    }

    fn energy<S: Scalar>(&self, positions: F::Coordinates<S>, _: usize) -> Option<S> {
        self.0.potential(positions)
    }

    fn breakpoints(&self) -> Vec<f64> {
        Vec::new()
    }
}

impl<L: Forces + 'static> ForceObject for L {
    fn count(&self) -> usize {
        L::Coordinates::<f64>::COUNT
    }

    fn breakpoints(&self) -> Vec<f64> {
        Forces::breakpoints(self)
    }

    fn forces(&self, place: Place<'_, f64>) -> Vec<f64> {
        let [x, y] = [place.positions, place.velocities].map(|z| Variables::from_fn(|i| z[i]));
        self.at(x, y, place.piece).as_ref().to_vec()
    }

    fn slopes(&self, place: Place<'_, f64>, by: usize) -> Vec<f64> {
        slopes(self, place, by)
    }

    fn potential(&self, place: Place<'_, f64>) -> Option<f64> {
        self.energy(Variables::from_fn(|i| place.positions[i]), place.piece)
    }

    fn potential_slope(&self, place: Place<'_, f64>, by: usize) -> Option<f64> {
        let input = |i: usize| Dual::along(place.positions[i], if i == by { 1.0 } else { 0.0 });
        let energy = self.energy(Variables::from_fn(input), place.piece);
        energy.map(Dual::derivative)
    }

    fn order(
        &self,
        tape: &mut Tape,
        k: usize,
        place: Place<'_, PowerSeries>,
        forces: &mut [PowerSeries],
    ) {
        tape.run(k, |run| {
            let x: L::Coordinates<Jet<'_>> =
                Variables::from_fn(|i| run.input(place.positions[i][k]));
            let y = Variables::from_fn(|i| run.input(place.velocities[i][k]));
            let found = self.at(x, y, place.piece);
            for (series, force) in std::iter::zip(&mut *forces, found.as_ref()) {
                series[k] = force.coefficient();
            }
        });
    }

    fn record(&self, recorder: &mut Recorder, place: Place<'_, PowerSeries>, i: usize) -> Output {
        let count = self.count();
        let recorder = recorder.begin(2 * count);
        let x = Variables::from_fn(|j| recorder.input(j, place.positions[j][0]));
        let y = Variables::from_fn(|j| recorder.input(count + j, place.velocities[j][0]));
        self.at(x, y, place.piece).as_ref()[i].output()
    }

    fn add_defects(&self, along: Along<'_>, times: &Block, kinds: &[usize], sums: &mut [[f64; 3]]) {
        let zeros: L::Coordinates<f64> = Variables::from_fn(|_| 0.0);
        let [mut x, mut y, mut expanded] = [[[zeros; LANES]; GROUPS]; 3];
        let mut factors = *times;
        let Place {
            positions,
            velocities,
            piece,
        } = along.place;
        for i in 0..sums.len() {
            let first = values_of([&positions[i], &along.forces[i]], times);
            let second = values_of([&velocities[i], along.factor], times);
            factors = second[1];
            for (to, from) in [
                (&mut x, first[0]),
                (&mut y, second[0]),
                (&mut expanded, first[1]),
            ] {
                for (to, from) in to.as_flattened_mut().iter_mut().zip(from.as_flattened()) {
                    to.as_mut()[i] = *from;
                }
            }
        }
        for (group, &kind) in kinds.iter().enumerate() {
            let factor = factors[group]
                .iter()
                .fold(0.0, |most: f64, d| most.max(d.abs()));
            let mut largest = zeros;
            for lane in 0..LANES {
                let exact = self.at(x[group][lane], y[group][lane], piece);
                let both = exact.as_ref().iter().zip(expanded[group][lane].as_ref());
                for (largest, (exact, force)) in largest.as_mut().iter_mut().zip(both) {
                    let defect = (exact - force).abs();
                    // Numbers that are not finite are not dropped.
                    if defect > *largest || defect.is_nan() {
                        *largest = defect;
                    }
                }
            }
            for (sums, largest) in sums.iter_mut().zip(largest.as_ref()) {
                sums[kind] += factor * largest;
            }
        }
    }

    fn start_slopes(&self, place: Place<'_, PowerSeries>, by: usize, found: &mut [f64]) {
        let forces = duals(
            self,
            place.piece,
            by,
            [place.positions, place.velocities],
            |z| z[0],
        );
        for (found, force) in found.iter_mut().zip(forces.as_ref()) {
            *found = force.derivative();
        }
    }

    fn series(&self, place: Place<'_, PowerSeries>) -> Vec<PowerSeries> {
        let [x, y] = [place.positions, place.velocities].map(|z| Variables::from_fn(|i| z[i]));
        self.at(x, y, place.piece).as_ref().to_vec()
    }

    fn derivative(&self, place: Place<'_, PowerSeries>, by: usize) -> Vec<PowerSeries> {
        slopes(self, place, by)
    }

    fn any(&self) -> &dyn Any {
        self
    }
}

/// Each F_i with its derivative by an input, at inputs that are taken from `positions` and
/// `velocities`.
fn duals<L: Forces, T, S: Scalar>(
    law: &L,
    piece: usize,
    by: usize,
    [positions, velocities]: [&[T]; 2],
    take: impl Fn(&T) -> S,
) -> L::Coordinates<Dual<S>> {
    let component = |input: usize| if input == by { 1.0 } else { 0.0 };
    let m = positions.len();
    let x = Variables::from_fn(|i| Dual::along(take(&positions[i]), component(i)));
    let y = Variables::from_fn(|i| Dual::along(take(&velocities[i]), component(m + i)));
    law.at(x, y, piece)
}

/// The derivative of each F_i by an input.
fn slopes<L: Forces, S: Scalar>(law: &L, place: Place<'_, S>, by: usize) -> Vec<S> {
    let inputs = [place.positions, place.velocities];
    let forces = duals(law, place.piece, by, inputs, |z| *z);
    let slopes = forces.as_ref().iter().map(|force| force.derivative());
    slopes.collect()
}
