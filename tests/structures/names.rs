//! Every public name of structures, as a program would write it.

use std::f64::consts::TAU;

use stick_slip::nalgebra::{Complex, DMatrix};
use stick_slip::structure::{State, SteadySliding};
use stick_slip::{
    AnyLaw, Contact, Coulomb, Direction, Drive, Error, Event, EventKind, Exponential, Integrator,
    MassOnBelt, Mode, Polynomial, Structure, Trajectory,
};

#[test]
fn drives() -> Result<(), Error> {
    let drive = Drive::constant(1.0)
        .with_constant(0.5)?
        .with_harmonic(0.2, 2.0, 0.3)?
        .with_sine(0.1, 4.0)?;
    assert!((drive.value(0.0) - (1.5 + 0.2 * 0.3_f64.cos())).abs() < 1e-15);
    assert!((drive.slope(0.0) - (0.4 - 0.4 * 0.3_f64.sin())).abs() < 1e-15);
    assert_eq!(drive.period(), Some(TAU / 2.0));
    let profile =
        Drive::profile(&[(0.0, 0.0), (1.0, 1.0)])?.with_profile(&[(2.0, 0.0), (2.0, 3.0)])?;
    assert_eq!([0.5, 1.5, 2.0].map(|t| profile.value(t)), [0.5, 1.0, 4.0]);
    assert_eq!((profile.slope(0.5), profile.period()), (1.0, None));
    assert_eq!(Drive::from(0.3), 0.3.into());
    assert_eq!(Drive::harmonic(0.0, 1.0, 0.0)?, Drive::constant(0.0));
    assert_eq!(Drive::sine(1.0, 2.0)?.clone().value(0.0), 0.0);
    Ok(())
}

#[test]
fn structures() -> Result<(), Error> {
    let law: AnyLaw = Exponential::new(0.5, 0.3, 0.25)?.into();
    let contact = Contact::new(1, law, 1.0)?
        .on_belt(0.2)
        .with_load_gradient(0, 0.1)?;
    assert_eq!(contact.coordinate(), 1);
    let structure = Structure::new(&[1.0, 2.0])?
        .with_spring(0, 1, 0.5)?
        .with_damper(0, 1, 0.02)?
        .with_ground_spring(0, 1.0)?
        .with_ground_damper(1, 0.1)?
        .with_stiffness(DMatrix::identity(2, 2))?
        .with_damping(DMatrix::zeros(2, 2))?
        .with_force(0, Drive::sine(0.3, 1.1)?)?
        .with_contact(contact)?;
    assert_eq!((structure.len(), structure.masses()), (2, &[1.0, 2.0][..]));
    let (stiffness, damping): (&DMatrix<f64>, &DMatrix<f64>) =
        (structure.stiffness(), structure.damping());
    assert_eq!((stiffness[(0, 0)], damping[(1, 0)]), (2.5, -0.02));
    assert_eq!(
        (structure.contacts().len(), structure.forces().len()),
        (1, 2)
    );
    assert_eq!(structure.period(), Some(TAU / 1.1));
    assert!(structure.steady_sliding().is_err());

    let start = State::new(&[0.1, 0.0], &[0.0, 0.2]);
    let motion: Trajectory<State> = structure.simulate(start.clone(), 30.0)?;
    let events: &[Event<State>] = motion.events();
    assert!(
        events
            .iter()
            .all(|event| event.contact == 0 && event.time <= 30.0)
    );
    assert!(motion.mode_at(0, 1.0).is_some() && motion.mode_at(1, 1.0).is_none());
    assert_eq!(motion.state_at(31.0), None);
    assert_eq!(motion.sample(3).count(), 3);
    assert_eq!(motion.sample_at([1.0, 2.0]).count(), 2);
    assert_eq!(motion.last(), motion.state_at(30.0).unwrap());

    let integrator = Integrator::new().with_start_time(5.0)?;
    let later = integrator.simulate(&structure, start.clone(), 3.0)?;
    assert!(later.state_at(8.0).is_some() && later.state_at(4.0).is_none());
    assert!(
        Integrator::new()
            .flow(&structure, start)?
            .take(5)
            .all(|step| step.is_ok())
    );
    assert!(Integrator::new().with_start_time(f64::NAN).is_err());

    let belt = MassOnBelt::new(Polynomial::new(0.4, 0.25, 0.5)?, 0.2)?;
    let one: Structure = Structure::from(&belt);
    let SteadySliding {
        displacements,
        eigenvalues,
        ..
    } = one.steady_sliding().unwrap();
    let eigenvalues: Vec<Complex<f64>> = eigenvalues;
    assert_eq!((displacements.len(), eigenvalues.len()), (1, 2));
    assert_eq!(State::at_rest(2).with_memory(&[1.0]).memory, [1.0]);
    Ok(())
}

/// A clutch is let go for a while: no friction in between.
#[test]
fn a_load_that_falls_to_zero_opens_the_contact() -> Result<(), Error> {
    let load = Drive::profile(&[(0.0, 1.0), (10.0, -1.0), (30.0, -1.0), (40.0, 1.0)])?;
    let structure = Structure::new(&[1.0])?
        .with_ground_spring(0, 1.0)?
        .with_contact(Contact::new(0, Coulomb::new(0.4, 0.3)?, load)?.on_belt(0.1))?;
    let motion = structure.simulate(State::new(&[0.0], &[0.1]), 60.0)?;
    let kind = |wanted: EventKind| motion.events().iter().find(|event| event.kind == wanted);
    let (open, close) = (
        kind(EventKind::Open).unwrap(),
        kind(EventKind::Close).unwrap(),
    );
    // 1 − t/5 = 0 and −1 + (t − 30)/5 = 0
    assert!((open.time - 5.0).abs() < 1e-14 && (close.time - 35.0).abs() < 1e-13);
    assert_eq!(motion.mode_at(0, 20.0), Some(Mode::Open));
    // Free vibration in between.
    let (q, v) = (open.state.displacements[0], open.state.velocities[0]);
    let t = 20.0 - open.time;
    let free = q * t.cos() + v * t.sin();
    assert!((motion.state_at(20.0).unwrap().displacements[0] - free).abs() < 1e-14);
    // It has slipped by then, and does so again afterwards.
    assert!(matches!(
        motion.mode_at(0, 4.99),
        Some(Mode::Slip(Direction::Lagging | Direction::Leading))
    ));
    assert_ne!(motion.mode_at(0, 36.0), Some(Mode::Open));
    Ok(())
}

#[test]
fn a_load_that_springs_lift_ends_the_motion() -> Result<(), Error> {
    let contact = Contact::new(0, Coulomb::new(0.4, 0.3)?, 1.0)?
        .on_belt(0.1)
        .with_load_gradient(1, -1.0)?;
    let structure = Structure::new(&[1.0, 1.0])?
        .with_ground_spring(0, 1.0)?
        .with_ground_spring(1, 1.0)?
        .with_contact(contact)?;
    // q_1 = 2 sin t: the load 1 − q_1 is gone at t = π/6.
    let start = || State::new(&[0.0, 0.0], &[0.0, 2.0]);
    let Err(Error::Separation { contact, reached }) = structure.simulate(start(), 5.0) else {
        panic!("it separates")
    };
    assert_eq!(contact, 0);
    assert!((reached.time - TAU / 12.0).abs() < 1e-15);
    assert!((reached.state.displacements[1] - 1.0).abs() < 1e-15);
    // Up to there it is a motion like any other.
    assert!(structure.simulate(start(), 0.5).is_ok());
    Ok(())
}
