//! Functions of a user that return NaN: a typed error, where the NaN enters.

use stick_slip::{
    Contact, ContactLaw, Coulomb, Error, Integrator, MassOnBelt, Motion, PhysicalMassOnBelt,
    Scalar, Segment, Slip, State, Structure, structure,
};

use crate::common::masses::PAD;
use crate::common::one_mass;

fn law() -> Coulomb {
    Coulomb::new(0.4, 0.3).unwrap()
}

/// A block that a belt carries along against a spring.
fn block<L: ContactLaw + Send + Sync + 'static>(law: L) -> Structure {
    let contact = Contact::new(0, law, 1.0).unwrap().on_belt(0.2);
    one_mass([1.0, 0.0, 1.0], 0.0, contact).unwrap()
}

#[track_caller]
fn is_refused<T: std::fmt::Debug>(motion: Result<T, Error>) {
    match motion {
        Err(Error::InvalidParameter {
            of, name, value, ..
        }) => {
            assert_eq!((of, name), ("Integrator", "stop time"));
            assert!(!value.is_finite());
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_stop_time_that_is_not_finite_is_refused() {
    let integrator = Integrator::new();
    let belt = MassOnBelt::new(law(), 0.2).unwrap();
    let system = Structure::from(&belt);
    let rest = || structure::State::at_rest(1);
    let brake = PhysicalMassOnBelt::new(PAD, law()).unwrap();
    let start = State::new(0.0, 0.0);
    // At once, after some steps, and in the last step.
    for (first, time) in [(0, f64::NAN), (3, f64::NAN), (20, f64::INFINITY)] {
        let stop = || {
            let mut steps = 0;
            move || {
                steps += 1;
                (steps > first).then_some(time)
            }
        };
        let mut next = stop();
        is_refused(integrator.simulate_until(&belt, start, 50.0, |_| next()));
        let mut next = stop();
        is_refused(integrator.simulate_until(&system, rest(), 50.0, |_| next()));
        let mut next = stop();
        is_refused(brake.simulate_until(integrator, start, 5.0, |_| next()));
    }
    // A zero of what is no number.
    is_refused(integrator.simulate_until(&belt, start, 50.0, |step| {
        step.first_zero(|state| (state.displacement - 0.1).sqrt() - 0.3)
    }));
    is_refused(
        integrator.simulate_until(&system, rest(), 50.0, |step| step.first_zero(|_| f64::NAN)),
    );
}

/// Numbers that a law with one memory variable returns; NaN for one of them once the mass has slid
/// for a while, or at once.
#[derive(Debug, Clone, Copy)]
struct Spoilt(&'static str, f64);

impl Spoilt {
    fn number<S: Scalar>(self, name: &str, memory: S, number: S) -> S {
        if self.0 == name && memory.value() >= self.1 {
            number * f64::NAN
        } else {
            number
        }
    }
}

impl ContactLaw for Spoilt {
    type Memory<S: Scalar> = [S; 1];
    fn coefficient<S: Scalar>(&self, slip: Slip<S>, [z]: [S; 1]) -> S {
        self.number("coefficient", z, z.constant(0.3 * slip.direction))
    }
    fn limit<S: Scalar>(&self, _: S, [z]: [S; 1]) -> Option<S> {
        Some(self.number("limit", z, z.constant(0.4)))
    }
    fn rates<S: Scalar>(&self, motion: Motion<S>, _: S, [z]: [S; 1]) -> [S; 1] {
        [match motion {
            Motion::Stick => self.number("in stick", z, z.constant(1.0)),
            Motion::Slip(slip) => self.number("in slip", z, slip.speed),
        }]
    }
    fn breakpoints(&self) -> impl Iterator<Item = f64> {
        std::iter::empty()
    }
    fn caught(&self, [z]: [f64; 1]) -> [f64; 1] {
        [self.number("caught", z, z)]
    }
}

#[test]
fn a_contact_law_that_returns_nan_ends_the_motion_with_an_error() {
    for name in ["coefficient", "limit", "in stick", "in slip", "caught"] {
        for from in [0.05, 0.5, 2.0] {
            let start = structure::State::at_rest(1);
            let found = block(Spoilt(name, from)).simulate(start, 60.0);
            match found {
                Err(Error::NonFiniteFriction {
                    value,
                    reached: Some(reached),
                    ..
                }) => {
                    assert!(value.is_nan(), "{name}, {from}");
                    let memory = reached.state.memory[0];
                    assert_eq!(memory.is_nan(), name == "caught", "{name}, {from}");
                    // Not before the number is NaN: the memory moves by less in a step.
                    assert!(
                        memory.is_nan() || memory > from - 0.1,
                        "{name}, {from}: {memory}"
                    );
                }
                other => panic!("{name}, {from}: {other:?}"),
            }
        }
    }
}
