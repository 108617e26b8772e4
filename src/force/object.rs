//! A force law as a trait object, for the engine of structures: the engine and the searches are
//! compiled once, for any law.

use std::any::Any;

use super::{ForceField, ForceLaw};
use crate::friction::memory::Variables;
use crate::scalar::Scalar;
use crate::scalar::dual::Dual;
use crate::scalar::jet::{Jet, Tape};
use crate::series::PowerSeries;

/// Positions and velocities along the directions of a force, and the piece of its law.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Place<'p, S> {
    pub(crate) positions: &'p [S],
    pub(crate) velocities: &'p [S],
    pub(crate) piece: usize,
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

/// The derivative of each F_i by an input.
fn slopes<L: Forces, S: Scalar>(law: &L, place: Place<'_, S>, by: usize) -> Vec<S> {
    let component = |input: usize| if input == by { 1.0 } else { 0.0 };
    let m = place.positions.len();
    let x = Variables::from_fn(|i| Dual::along(place.positions[i], component(i)));
    let y = Variables::from_fn(|i| Dual::along(place.velocities[i], component(m + i)));
    let forces = law.at(x, y, place.piece);
    forces
        .as_ref()
        .iter()
        .map(|force| force.derivative())
        .collect()
}
