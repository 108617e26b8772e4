//! The crate's code for the laws that most tests take, so that it is optimised and compiled once.
//!
//! A program compiles generic code for each law that it names, at its own level of optimisation:
//! that of the tests is 0, at which the series of a law take ten times as long. But a program of
//! level 0 takes such code from a package that has it, if that package is of level 1, s or z. This
//! one is of level s, and has the code by the functions below. Nothing calls them.
// Written for the tests, not for users.
#![allow(missing_docs)]

use stick_slip::{
    AnyContactLaw, AnyLaw, Backlash, Contact, ContactLaw, Coulomb, Directional, Dwell, Error,
    Exponential, ForceElement, ForceLaw, LuGre, MassOnBelt, Pendulum, Polynomial, PolynomialSpring,
    RateState, RateState2, Rational, State, Stribeck, Tabulated, Trajectory,
};
use stick_slip_tests_common::any::Any;
use stick_slip_tests_common::bristles::Bristles;
use stick_slip_tests_common::heat::Heat;
use stick_slip_tests_common::polynomials::Polynomials;
use stick_slip_tests_common::reading::Raised;
use stick_slip_tests_common::{Counted, Decay, Leine, Table};

/// The law of one mass as the engine of the belt takes it.
macro_rules! of_belts {
    ($($name:ident: $law:ty),*) => { $(
        pub fn $name(system: &MassOnBelt<$law>) -> Result<Trajectory<State>, Error> {
            system.simulate(State::new(0.0, 0.0), 1.0)
        }
    )* };
}

of_belts! {
    any: Any,
    decay: Decay,
    leine: Leine,
    polynomials: Polynomials,
    table: Table,
    counted: Counted<'_, Exponential>,
    counted_table: Counted<'_, Tabulated>
}

/// The law of a contact or an element as the engine of structures takes it.
macro_rules! of_structures {
    ($take:ident -> $part:ty, $($name:ident: $law:ty),*) => { $(
        pub fn $name(law: $law) -> Result<$part, Error> {
            $take(law)
        }
    )* };
}

fn contact<L: ContactLaw + Send + Sync + 'static>(law: L) -> Result<Contact, Error> {
    Contact::new(0, law, 1.0)
}

of_structures! {
    contact -> Contact,
    any_contact: Any,
    any_law: AnyLaw,
    any_memory: AnyContactLaw<Any>,
    any_named_memory: AnyContactLaw<AnyLaw>,
    bristles: Bristles,
    coulomb: Coulomb,
    directional: Directional<Coulomb, Coulomb>,
    dwell: Dwell<Coulomb>,
    exponential: Exponential,
    heat: Heat,
    lugre: LuGre<Coulomb>,
    lugre_of_any: LuGre<AnyLaw>,
    polynomial: Polynomial,
    raised: Raised,
    raised_memory: AnyContactLaw<Raised>,
    rate_state: RateState,
    rate_state_of_two: RateState2,
    rational: Rational,
    stribeck: Stribeck,
    tabulated: Tabulated
}

fn element<L: ForceLaw + Send + Sync + 'static>(law: L) -> Result<ForceElement, Error> {
    ForceElement::new(0, law)
}

of_structures! {
    element -> ForceElement,
    backlash: Backlash,
    pendulum: Pendulum,
    polynomial_spring: PolynomialSpring
}
