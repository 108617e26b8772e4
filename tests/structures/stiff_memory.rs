//! Stiff bristles: steps by the slow motion, beside explicit ones.

use stick_slip::structure::State;
use stick_slip::{
    AnyLaw, Contact, ContactLaw, Drive, Exponential, FrictionLaw, Integrator, LuGre, Motion,
    Polynomial, Scalar, Segment, Slip, Structure, Variables,
};

use crate::common::{larger, one_mass, some};

/// The same law with a second memory that nothing depends on: its motion is followed by explicit
/// steps.
pub(crate) struct Padded<L>(pub(crate) L);

impl<L: ContactLaw> ContactLaw for Padded<L> {
    type Memory<S: Scalar> = [S; 2];
    fn coefficient<S: Scalar>(&self, slip: Slip<S>, [z, _]: [S; 2]) -> S {
        self.0.coefficient(slip, Variables::from_fn(|_| z))
    }
    fn limit<S: Scalar>(&self, zero: S, [z, _]: [S; 2]) -> Option<S> {
        self.0.limit(zero, Variables::from_fn(|_| z))
    }
    fn rates<S: Scalar>(&self, motion: Motion<S>, load: S, [z, other]: [S; 2]) -> [S; 2] {
        let rates = self.0.rates(motion, load, Variables::from_fn(|_| z));
        [rates.as_ref()[0], other.constant(0.0)]
    }
    fn breakpoints(&self) -> impl Iterator<Item = f64> {
        self.0.breakpoints()
    }
    fn caught(&self, [z, other]: [f64; 2]) -> [f64; 2] {
        let caught = self.0.caught(Variables::from_fn(|_| z));
        [caught.as_ref()[0], other]
    }
}

fn block<L: ContactLaw + Send + Sync + 'static>(
    law: L,
    belt: impl Into<Drive>,
    damper: f64,
) -> Structure {
    let contact = Contact::new(0, law, 1.0).unwrap().on_belt(belt);
    one_mass([1.0, damper, 1.0], 0.0, contact).unwrap()
}

/// Steps, events and the last state.
fn follow(structure: &Structure, start: State, duration: f64) -> (usize, Vec<f64>, State) {
    let many = Integrator::new().with_max_steps(1_000_000).unwrap();
    let (mut steps, mut events) = (0, Vec::new());
    for step in many.flow(structure, start).unwrap() {
        let step = step.unwrap();
        steps += 1;
        if step.end_time() >= duration {
            return (steps, events, step.until(duration).end_state());
        }
        events.extend(step.events().iter().map(|event| event.time));
    }
    panic!("ended");
}

fn apart(a: &State, b: &State) -> f64 {
    let coordinates = [
        a.displacements[0] - b.displacements[0],
        a.velocities[0] - b.velocities[0],
    ];
    coordinates
        .iter()
        .fold(0.0, |largest, x| x.abs().max(largest))
}

/// Both methods, from where explicit steps are as good up to where they take thousands.
#[test]
fn slow_steps_and_explicit_ones_give_one_motion() {
    let exponential = AnyLaw::from(Exponential::new(0.4, 0.25, 0.5).unwrap());
    let cubic = AnyLaw::from(Polynomial::new(0.4, 0.25, 0.5).unwrap());
    let (mut worst, mut cell) = (0.0_f64, 0);
    for stiffness in some(3, [30.0, 1e3, 1e4, 100.0, 300.0, 3e3]) {
        for belt in [-0.15, 0.2, 0.6] {
            let shaken = Drive::sine(0.1, 1.7)
                .and_then(|d| d.with_constant(belt))
                .unwrap();
            for damping in [0.0, 0.3, f64::sqrt(stiffness)] {
                // Each law on one of the two belts, by turns.
                let drives = [Drive::constant(belt), shaken.clone()];
                let law = LuGre::new(exponential.clone(), stiffness, damping, 0.02).unwrap();
                let one = both(law, &drives[cell % 2]);
                let law = LuGre::new(cubic.clone(), stiffness, damping, 0.02).unwrap();
                let two = both(law, &drives[1 - cell % 2]);
                cell += 1;
                for [slow, explicit] in [one.0, two.0] {
                    assert!(slow <= explicit, "{stiffness} {belt}: {slow} {explicit}");
                    if stiffness > 2e3 && belt == 0.6 {
                        assert!(slow * 20 < explicit, "{stiffness}: {slow} {explicit}");
                    }
                }
                worst = larger(larger(worst, one.1), two.1);
            }
        }
    }
    println!("worst {worst:.1e}");
    assert!(worst < 1e-12, "{worst:e}");
}

fn both(law: LuGre<AnyLaw>, belt: &Drive) -> ([usize; 2], f64) {
    let start = State::new(&[0.05], &[0.3]);
    let slow = block(law.clone(), belt.clone(), 0.05);
    let explicit = block(Padded(law), belt.clone(), 0.05);
    let (a, events, end) = follow(&slow, start.clone(), 6.0);
    let (b, others, other) = follow(&explicit, start, 6.0);
    assert_eq!(events.len(), others.len());
    ([a, b], apart(&end, &other))
}

/// The number of steps does not grow with the stiffness, and the motion comes to that of dry
/// friction like 1/σ0.
#[test]
fn any_stiffness_takes_as_many_steps() {
    let g = AnyLaw::from(Exponential::new(0.4, 0.25, 0.5).unwrap());
    let start = State::new(&[0.0], &[0.0]);
    let dry = block(g.clone(), 0.6, 0.12);
    let contact = dry.contacts()[0].clone();
    // σ2 of the bristles is a damper against the belt.
    let dry = one_mass([1.0, 0.12, 1.0], 0.02 * 0.6, contact).unwrap();
    let (_, events, limit) = follow(&dry, start.clone(), 8.0);
    assert!(events.is_empty());
    let mut before: Option<f64> = None;
    for exponent in 3..=12 {
        let stiffness = 10_f64.powi(exponent);
        let law = LuGre::new(g.clone(), stiffness, 0.0, 0.02).unwrap();
        // Bristles that are bent from the start.
        let start = start.clone().with_memory(&[-g.kinetic(0.6) / stiffness]);
        let (steps, events, end) = follow(&block(law, 0.6, 0.1), start, 8.0);
        println!(
            "σ0 = 1e{exponent}: {steps} steps, {:.2e} from dry friction",
            apart(&end, &limit)
        );
        assert!(steps < 40 && events.is_empty(), "{stiffness}: {steps}");
        let error = apart(&end, &limit);
        if exponent < 10 {
            if let Some(before) = before {
                assert!(
                    (before / error - 10.0).abs() < 0.2,
                    "{stiffness}: {before:e} {error:e}"
                );
            }
            before = Some(error);
        } else {
            assert!(error < 2e-11);
        }
    }
}

/// Where a motion is cut does not matter: neither to a slow step nor to an explicit one.
#[test]
fn a_stiff_motion_goes_on_from_anywhere() {
    let g = AnyLaw::from(Exponential::new(0.4, 0.25, 0.5).unwrap());
    for stiffness in [1e3, 1e5, 1e7] {
        let law = LuGre::new(g.clone(), stiffness, f64::sqrt(stiffness), 0.02).unwrap();
        let system = block(law, 0.3, 0.1);
        let (_, _, whole) = follow(&system, State::new(&[0.0], &[0.0]), 6.0);
        let mut state = State::new(&[0.0], &[0.0]);
        for _ in 0..60 {
            state = system.simulate(state, 0.1).unwrap().last();
        }
        let error = apart(&whole, &state);
        println!("{stiffness:e}: {error:.1e}");
        assert!(error < 1e-12, "{stiffness}: {error:e}");
    }
}

/// Three masses on stiff bristles, each with its own.
fn chain<L: ContactLaw + Send + Sync + 'static>(wrapped: impl Fn(LuGre<AnyLaw>) -> L) -> Structure {
    let g = AnyLaw::from(Exponential::new(0.4, 0.25, 0.5).unwrap());
    let mut chain = Structure::new(&[1.0, 2.0, 0.5]).unwrap();
    for (i, stiffness) in [400.0, 2e3, 8e3].into_iter().enumerate() {
        let law = wrapped(LuGre::new(g.clone(), stiffness, 0.5, 0.01).unwrap());
        let contact = Contact::new(i, law, 1.0).unwrap().on_belt(0.6);
        chain = chain
            .with_ground_spring(i, 1.0)
            .and_then(|s| s.with_contact(contact))
            .unwrap();
    }
    for i in 0..2 {
        chain = chain.with_spring(i, i + 1, 0.7).unwrap();
    }
    chain
}

#[test]
fn stiff_chains() {
    let start = State::new(&[0.1, 0.0, -0.1], &[0.0; 3]);
    let (slow, _, end) = follow(&chain(|law| law), start.clone(), 5.0);
    let (explicit, _, other) = follow(&chain(Padded), start, 5.0);
    println!("{slow} steps, explicit {explicit}");
    assert!(slow * 10 < explicit, "{slow} {explicit}");
    for (q, other) in end.displacements.iter().zip(&other.displacements) {
        assert!((q - other).abs() < 1e-12, "{q} {other}");
    }
}
