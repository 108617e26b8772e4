//! The systems whose periodic motions can be found.

use super::form::GeneralForm;
use super::map::PeriodMap;
use crate::belt::MassOnBelt;
use crate::error::Error;
use crate::friction::FrictionLaw;
use crate::motion::{Ended, EnergyBudget, System, Trajectory, sealed};
use crate::state::structure;
use crate::structure::engine::model::Model;
use crate::structure::engine::sparse::Sparse;
use crate::structure::{Energies, Structure};

/// A system whose periodic motions can be found: [`MassOnBelt`] or [`Structure`]. The trait is
/// sealed, like [`System`].
///
/// The searches treat a [`MassOnBelt`] as a structure of one mass. Their results contain the states
/// of the given system: [`State`](crate::State) for a `MassOnBelt`, and
/// [`structure::State`](crate::structure::State) for a `Structure`.
pub trait Oscillator: System + FamilyMember + Measured {}

/// One system of a family, without its type. Not exported.
pub trait FamilyMember {
    /// The system without the type of its laws.
    fn form(&self) -> GeneralForm<'_>;
}

/// Measures of a motion of the system. Not exported.
pub trait Measured: System {
    /// The motion over one period in the system's own form.
    fn trajectory(&self, map: PeriodMap, period: f64) -> Result<Trajectory<Self::State>, Error>;
    /// Work and heat along a motion.
    fn energy_budget(&self, map: &PeriodMap) -> EnergyBudget;
}

/// The member of a family at a value of its parameters.
type Member<'f> = Result<Box<dyn FamilyMember + 'f>, Error>;

/// A system without its type.
pub(crate) fn member<'f, S: Oscillator + 'f>(system: Result<S, Error>) -> Member<'f> {
    Ok(Box::new(system?))
}

/// A family in one parameter. What works with it is compiled once, not for each function that a
/// program gives.
pub(super) type Family<'f> = dyn Fn(f64) -> Member<'f> + 'f;

/// A family in two parameters.
pub(crate) type FamilyOfTwo<'f> = dyn Fn(f64, f64) -> Member<'f> + 'f;

/// A family in one parameter with the type of its systems.
pub(super) type Systems<'f, S> = dyn Fn(f64) -> Result<S, Error> + 'f;

/// A family in two parameters with the type of its systems.
pub(super) type SystemsOfTwo<'f, S> = dyn Fn(f64, f64) -> Result<S, Error> + 'f;

impl Oscillator for Structure {}

impl FamilyMember for Structure {
    fn form(&self) -> GeneralForm<'_> {
        GeneralForm::new(self.model())
    }
}

impl Measured for Structure {
    fn trajectory(
        &self,
        map: PeriodMap,
        period: f64,
    ) -> Result<Trajectory<structure::State>, Error> {
        Ok(Trajectory::new(map.steps, 0.0, period, Ended::Duration))
    }

    fn energy_budget(&self, map: &PeriodMap) -> EnergyBudget {
        let model = self.model();
        self.energies(&model).budget(map.steps())
    }
}

impl<L: FrictionLaw> Oscillator for MassOnBelt<L> {}

impl<L: FrictionLaw> FamilyMember for MassOnBelt<L> {
    fn form(&self) -> GeneralForm<'_> {
        GeneralForm::new(Model::of_belt(self))
    }
}

impl<L: FrictionLaw> Measured for MassOnBelt<L> {
    fn trajectory(&self, map: PeriodMap, period: f64) -> Result<Trajectory, Error> {
        self.simulate(
            <Self::State as sealed::State>::of_general(&map.start),
            period,
        )
    }

    fn energy_budget(&self, map: &PeriodMap) -> EnergyBudget {
        let one = |entry: f64| Sparse::diagonal(std::iter::once(entry));
        let energies = Energies {
            model: &Model::of_belt(self),
            mass: one(1.0),
            stiffness: one(1.0),
            damping: one(2.0 * self.damping()),
            normal: vec![None],
        };
        energies.budget(map.steps())
    }
}
