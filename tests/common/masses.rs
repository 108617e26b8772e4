//! One mass: on a belt, and as a structure with a spring, a force and a contact.

use stick_slip::analysis::dwell::DwellOscillator;
use stick_slip::analysis::forced::ForcedOscillator;
use stick_slip::{
    Contact, Coulomb, Drive, Error, FrictionLaw, MassOnBelt, Physical, Polynomial, Structure,
};

/// A brake pad in SI units.
pub const PAD: Physical = Physical {
    mass: 2.0,
    stiffness: 5000.0,
    damping: 4.0,
    normal_force: 20.0,
    belt_velocity: 0.05,
};

/// A system of which all numbers are right.
#[track_caller]
pub fn on_belt<L: FrictionLaw>(law: L, v_b: f64, damping: f64, load: f64) -> MassOnBelt<L> {
    MassOnBelt::new(law, v_b)
        .and_then(|system| system.with_damping(damping)?.with_load(load))
        .unwrap()
}

/// The set of the source paper's Figs. 4 and 5: polynomial law, β = 0.05, γ² = 1.
pub fn paper(belt_velocity: f64) -> MassOnBelt<Polynomial> {
    let law = Polynomial::new(0.4, 0.25, 0.5).unwrap();
    on_belt(law, belt_velocity, 0.05, 1.0)
}

/// m q'' + c q' + k q = f(t) − friction.
pub fn one_mass(
    [m, c, k]: [f64; 3],
    force: impl Into<Drive>,
    contact: Contact,
) -> Result<Structure, Error> {
    oscillator([m, c, k], force)?.with_contact(contact)
}

/// m q'' + c q' + k q = f(t).
pub fn oscillator([m, c, k]: [f64; 3], force: impl Into<Drive>) -> Result<Structure, Error> {
    Structure::new(&[m])?
        .with_ground_spring(0, k)?
        .with_ground_damper(0, c)?
        .with_force(0, force)
}

/// A mass on a slow belt under a force, whose motions have flips.
pub fn driven(frequency: f64, force: f64) -> Result<Structure, Error> {
    let force = Drive::harmonic(force, frequency, 0.0)?;
    let contact = Contact::new(0, Coulomb::new(0.5, 0.3)?, 1.5)?.on_belt(0.1);
    one_mass([1.0, 0.02, 1.0], force, contact)
}

/// The mass of a closed formula on its belt.
pub fn dwelling(of: &DwellOscillator, velocity: f64) -> Structure {
    let contact = Contact::new(0, of.law, of.load).unwrap().on_belt(velocity);
    one_mass([of.mass, of.damping, of.stiffness], 0.0, contact).unwrap()
}

/// The mass of a closed formula on a surface at rest, with the force at this phase.
pub fn forced(of: &ForcedOscillator, phase: f64) -> Structure {
    let law = Coulomb::new(of.static_friction, of.kinetic_friction).unwrap();
    let force = Drive::harmonic(of.force, of.angular_frequency, phase).unwrap();
    let contact = Contact::new(0, law, 1.0).unwrap();
    one_mass([1.0, 2.0 * of.damping, 1.0], force, contact).unwrap()
}
