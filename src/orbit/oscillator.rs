//! The systems whose periodic motions can be found.

use std::sync::{Arc, OnceLock};

use super::course::{Course, KeptMotion};
use super::type_erased_system::GeneralForm;
use crate::belt::MassOnBelt;
use crate::error::Error;
use crate::friction::FrictionLaw;
use crate::motion::{Ended, EnergyBudget, System, Trajectory};
use crate::state::{State, structure};
use crate::structure::engine::model::Model;
use crate::structure::engine::sparse::Sparse;
use crate::structure::{Energies, Step, Structure};

/// A system whose periodic motions can be found: [`MassOnBelt`] or [`Structure`]. The trait is
/// sealed, like [`System`].
///
/// The searches treat a [`MassOnBelt`] as a structure of one mass. Their results contain the states
/// of the given system: [`State`](crate::State) for a `MassOnBelt`, and
/// [`structure::State`](crate::structure::State) for a `Structure`.
pub trait Oscillator: System + FamilyMember + Shown {}

/// One system of a family, without its type. Not exported.
pub trait FamilyMember {
    /// The system without the type of its laws.
    fn form(&self) -> GeneralForm<'_>;
    /// Work and heat over a period of these steps.
    fn energy_over(&self, steps: &[Step]) -> EnergyBudget;
}

/// Motions of the system in its own form. Not exported.
pub trait Shown: System {
    /// The motion of a course, which starts in a state at time 0, over its period.
    fn motion(
        &self,
        course: Course,
        start: &Self::State,
        period: f64,
    ) -> Result<KeptMotion<Self::State>, Error>;
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

    fn energy_over(&self, steps: &[Step]) -> EnergyBudget {
        let model = self.model();
        self.energies(&model).budget_of_period(steps)
    }
}

impl Shown for Structure {
    /// A copy of the structure fills much less memory than the steps of a motion.
    fn motion(
        &self,
        course: Course,
        _: &structure::State,
        period: f64,
    ) -> Result<KeptMotion<structure::State>, Error> {
        let structure = self.clone();
        let again = move || {
            let steps = course.steps(&structure.form(), period);
            Trajectory::new(steps, 0.0, period, Ended::Duration)
        };
        Ok(KeptMotion::Later(Arc::new(again), OnceLock::new()))
    }
}

impl<L: FrictionLaw> Oscillator for MassOnBelt<L> {}

impl<L: FrictionLaw> FamilyMember for MassOnBelt<L> {
    fn form(&self) -> GeneralForm<'_> {
        GeneralForm::new(Model::of_belt(self))
    }

    fn energy_over(&self, steps: &[Step]) -> EnergyBudget {
        let one = |entry: f64| Sparse::diagonal(std::iter::once(entry));
        let energies = Energies {
            model: &Model::of_belt(self),
            mass: one(1.0),
            stiffness: one(1.0),
            damping: one(2.0 * self.damping()),
            normal: vec![None],
        };
        energies.budget_of_period(steps)
    }
}

impl<L: FrictionLaw> Shown for MassOnBelt<L> {
    /// Kept, because a law may be borrowed.
    fn motion(&self, _: Course, start: &State, period: f64) -> Result<KeptMotion<State>, Error> {
        self.simulate(*start, period).map(KeptMotion::Known)
    }
}
