//! What is refused, but for single numbers (tests/contract/refusals.rs), and what is not found.

use stick_slip::orbit::{Orbit, Period, Search, lyapunov, section, settle, shoot};
use stick_slip::structure::State;
use stick_slip::{Contact, Coulomb, Drive, Error, MassOnBelt, Polynomial, Stribeck, Structure};

use crate::common::{apart, at_least, count, message, one_mass, oscillator, paper, refused};

fn block(force: Drive, belt: Drive) -> Structure {
    let contact = Contact::new(0, Coulomb::new(0.4, 0.3).unwrap(), 1.0).unwrap();
    one_mass([1.0, 0.1, 1.0], force, contact.on_belt(belt)).unwrap()
}

fn sine(frequency: f64) -> Drive {
    Drive::sine(0.5, frequency).unwrap()
}

const BAD: [f64; 5] = [0.0, -1.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY];

#[test]
fn periods_fit_the_drives() {
    let (driven, free) = (block(sine(1.0), 0.2.into()), block(0.0.into(), 0.2.into()));
    let start = State::at_rest(1);
    refused!(shoot(&driven, &start, Period::Free(6.0)) => Error::NotFree);
    let found = shoot(&driven, &start, Period::Free(6.0));
    message(found, &["`Period::Driven`"]);
    let ramp = Drive::profile(&[(0.0, 0.0), (1.0, 0.3)]).unwrap();
    for without in [
        free.clone(),
        block(sine(1.0), sine(2.0_f64.sqrt())),
        block(ramp.clone(), sine(1.0)),
    ] {
        refused!(shoot(&without, &start, Period::Driven(1)) => Error::NoCommonPeriod);
    }
    message(shoot(&free, &start, Period::Driven(1)), &["`Period::Free`"]);
    refused!(shoot(&block(ramp, 0.2.into()), &start, Period::Free(1.0)) => Error::NotFree);
    refused!(shoot(&paper(0.2), &(0.0, 0.0).into(), Period::Driven(1)) => Error::NoCommonPeriod);
}

#[test]
fn starts_are_checked() {
    let driven = block(sine(1.0), 0.2.into());
    let found = shoot(&driven, &State::at_rest(2), Period::Driven(1));
    refused!(found => Error::WrongSize { found: 2, expected: 1, .. });
    // An elastic contact whose load depends on a coordinate that the guess lacks.
    let joint = Contact::new(0, Coulomb::new(0.3, 0.3).unwrap(), 1.0).and_then(|joint| {
        joint
            .with_tangential_stiffness(5.0)?
            .with_load_gradient(1, 0.1)
    });
    let pair = Structure::new(&[1.0, 1.0])
        .and_then(|s| s.with_ground_spring(0, 1.0)?.with_spring(0, 1, 1.0))
        .and_then(|s| s.with_contact(joint?.on_belt(0.2)))
        .unwrap();
    for guess in [State::at_rest(1), State::at_rest(1).with_memory(&[0.0])] {
        refused!(shoot(&pair, &guess, Period::Free(6.0)) => Error::WrongSize { .. });
    }
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for start in [State::new(&[bad], &[0.0]), State::new(&[0.0], &[bad])] {
            refused!(shoot(&driven, &start, Period::Driven(1)) => Error::InvalidState { .. });
            refused!(settle(&driven, &start, 1.0, Period::Driven(1)) => Error::InvalidState { .. });
            refused!(lyapunov(&driven, &start, 1.0, 1.0) => Error::InvalidState { .. });
            let mut states = section(&driven, &start, 1.0);
            refused!(states.next().unwrap() => Error::InvalidState { .. });
            assert_eq!(states.next(), None);
        }
        let found = shoot(&paper(0.2), &(bad, 0.0).into(), Period::Free(7.0));
        refused!(found => Error::InvalidState { .. });
    }
}

#[test]
fn durations_are_checked() {
    let driven = block(sine(1.0), 0.2.into());
    let start = State::at_rest(1);
    for bad in &BAD[1..] {
        refused!(settle(&driven, &start, *bad, Period::Driven(1)) => Error::InvalidDuration { .. });
        refused!(lyapunov(&driven, &start, *bad, 1.0) => Error::InvalidDuration { .. });
    }
    for bad in BAD {
        refused!(lyapunov(&driven, &start, 1.0, bad) => Error::InvalidDuration { .. });
    }
}

#[test]
fn a_mean_over_no_time_says_what_it_needs() {
    let driven = block(sine(1.0), 0.2.into());
    let found = lyapunov(&driven, &State::at_rest(1), 1.0, 0.0);
    message(found, &["duration = 0 is not allowed: duration > 0"]);
    // Rounding leaves nothing of it behind the transient.
    let found = lyapunov(&driven, &State::at_rest(1), 1.0, 1e-17);
    refused!(found => Error::InvalidParameter { name: "duration", value: 1e-17, .. });
}

#[test]
fn rest_is_no_periodic_motion() {
    let rest = MassOnBelt::new(Coulomb::new(0.4, 0.3).unwrap(), 0.0).unwrap();
    refused!(shoot(&rest, &(0.1, 0.0).into(), Period::Free(6.0)) => Error::AtRest);
    let found = shoot(&rest, &(0.1, 0.0).into(), Period::Free(6.0));
    message(found, &["transient"]);
    let sliding = MassOnBelt::new(Coulomb::new(0.25, 0.25).unwrap(), 0.5).unwrap();
    refused!(shoot(&sliding, &(0.25, 0.0).into(), Period::Free(6.0)) => Error::AtRest);
    // Driven by nothing that moves it, a mass may rest: a motion of any period.
    let held: Orbit<_> = shoot(
        &block(Drive::sine(0.1, 1.0).unwrap(), 0.0.into()),
        &State::at_rest(1),
        Period::Driven(1),
    )
    .unwrap();
    assert_eq!(held.extremes(0), (0.0, 0.0));
    assert!(held.events().is_empty());
}

#[test]
fn what_is_not_found_says_how_far_it_is() {
    // All spirals into steady sliding: nothing else is periodic.
    let system = paper(0.6);
    for start in [(0.5, 0.1), (0.4, 0.5), (1.5, -0.3)] {
        match shoot(&system, &start.into(), Period::Free(6.3)).map(|_| ()) {
            Err(Error::AtRest) => {}
            Err(Error::NotPeriodic {
                residual,
                period,
                start,
            }) => {
                assert!(residual > 1e-9 && residual.is_finite() && period > 0.0);
                assert_eq!(start.displacements.len(), 1);
            }
            other => panic!("{other:?}"),
        }
    }
    let undamped: Structure = oscillator([1.0, 0.0, 1.0], Drive::sine(1.0, 1.0).unwrap()).unwrap();
    // Resonance: no periodic motion exists.
    refused!(shoot(&undamped, &State::at_rest(1), Period::Driven(1)) => Error::NotPeriodic { .. });
    let found = shoot(&undamped, &State::at_rest(1), Period::Driven(1));
    message(found, &["differs from its start"]);
}

#[test]
fn what_stops_a_motion_stops_a_search() {
    let contact = Contact::new(0, Coulomb::new(0.4, 0.3).unwrap(), 1.0)
        .and_then(|contact| contact.with_load_gradient(0, 1.0))
        .unwrap();
    let force = Drive::sine(3.0, 0.5).unwrap();
    let lifts: Structure = one_mass([1.0, 0.0, 1.0], force, contact).unwrap();
    let found = shoot(&lifts, &State::at_rest(1), Period::Driven(1));
    refused!(found => Error::Separation { contact: 0, .. });
    let found = lyapunov(&lifts, &State::at_rest(1), 100.0, 100.0);
    refused!(found => Error::Separation { contact: 0, .. });
    let last = section(&lifts, &State::at_rest(1), 1.0).last();
    refused!(last.unwrap() => Error::Separation { .. });
}

/// Asserts that a search came to its bound, and says so; the time that it reached.
fn at_bound(error: Option<Error>, bound: usize) -> f64 {
    let found = error.map_or(Ok(()), Err);
    let (limit, reached) =
        refused!(found => Error::TooManySteps { limit, reached }, (limit, reached));
    assert_eq!(limit, bound);
    assert!(reached.time.is_finite());
    assert_eq!(reached.state.displacements.len(), 1);
    reached.time
}

/// Whatever times are asked for, a call ends within seconds and says how far it came.
#[test]
fn work_is_bounded() {
    let driven = block(sine(1.0), 0.2.into());
    let free = block(0.0.into(), 0.2.into());
    let start = State::at_rest(1);
    const BOUND: usize = 20_000;
    let search = Search::new().with_max_steps(BOUND).unwrap();
    let settled = search.settle(&driven, &start, 1e12, Period::Driven(1));
    assert!(at_bound(settled.err(), BOUND) > 2e3);
    for (transient, duration) in [(0.0, 1e12), (1e12, 1.0)] {
        let exponent = search.lyapunov_with_spread(&driven, &start, transient, duration);
        assert!(at_bound(exponent.err(), BOUND) > 2e3);
    }
    // Steady sliding is one step, which changes of it pass in many.
    let sliding = State::new(&[0.3], &[0.0]);
    for duration in [1e8, 1e12] {
        let exponent = search.lyapunov_with_spread(&free, &sliding, 0.0, duration);
        at_bound(exponent.err(), BOUND);
    }
    let found = shoot(&driven, &start, Period::Driven(100_000_000));
    at_bound(found.err(), 100_000);
    let guesses = [[0.3, 0.0], [0.3 + 1e-10, 0.0], [-1e8, 0.2], [0.0, 0.0]];
    for guess in guesses {
        for period in [1e8, 1e12] {
            let start = State::new(&guess[..1], &guess[1..]);
            assert!(search.shoot(&free, &start, Period::Free(period)).is_err());
        }
    }
}

/// Without a bound of the user's, too.
#[test]
#[ignore = "a full count: runs of a million steps"]
fn work_is_bounded_by_default() {
    const BOUND: usize = 1_000_000;
    let driven = block(sine(1.0), 0.2.into());
    let start = State::at_rest(1);
    let settled = settle(&driven, &start, 1e12, Period::Driven(1));
    assert!(at_bound(settled.err(), BOUND) > 1e5);
    let exponent = lyapunov(&driven, &start, 0.0, 1e12);
    assert!(at_bound(exponent.err(), BOUND) > 1e5);
    let free = block(0.0.into(), 0.2.into());
    let sliding = State::new(&[0.3], &[0.0]);
    at_bound(lyapunov(&free, &sliding, 0.0, 1e8).err(), BOUND);
}

/// What sticks for ever keeps the displacement at which it came to rest: the motion is one of a
/// family, and says so.
#[test]
fn contacts_that_never_slip_give_a_family_that_is_named() {
    let stuck = |joints: Vec<Contact>| {
        let structure = Structure::new(&[1.0, 1.5, 0.8])
            .and_then(|s| s.with_ground_spring(0, 1.0)?.with_ground_damper(0, 0.2))
            .and_then(|s| s.with_ground_spring(1, 0.6)?.with_ground_damper(1, 0.1))
            .and_then(|s| s.with_spring(1, 2, 0.7)?.with_ground_damper(2, 0.1))
            .and_then(|s| s.with_force(0, sine(1.3)));
        let mut joints = joints.into_iter();
        let structure = joints.try_fold(structure.unwrap(), |s, joint| s.with_contact(joint));
        structure.unwrap()
    };
    let law = || Coulomb::new(0.5, 0.5).unwrap();
    let between = |i: usize, j: usize| Contact::between(i, j, law(), 20.0).unwrap();
    let ground = |i: usize| Contact::new(i, law(), 20.0).unwrap();
    let elastic = |i: usize, j: usize| between(i, j).with_tangential_stiffness(3.0).unwrap();
    let slips = || Contact::new(0, law(), 0.1).unwrap();
    type Joints = Vec<Contact>;
    let cases: [(Joints, &[usize]); 8] = [
        (vec![between(0, 1)], &[0]),
        (vec![ground(1)], &[0]),
        (vec![slips(), ground(1)], &[1]),
        (vec![between(0, 1), between(1, 2)], &[0, 1]),
        (vec![between(0, 2), slips(), between(1, 2)], &[0, 2]),
        (vec![elastic(0, 1), between(0, 2)], &[0, 1]),
        (vec![elastic(0, 1), ground(2), elastic(1, 2)], &[0, 1, 2]),
        (vec![slips(), elastic(1, 2)], &[1]),
    ];
    for (joints, expected) in cases {
        let count = joints
            .iter()
            .filter(|joint| joint.tangential_stiffness().is_some())
            .count();
        let system = stuck(joints);
        let start = State::new(&[0.1, 0.05, -0.2], &[0.0, 0.0, 0.0]);
        let start = start.with_memory(&vec![0.1; count]);
        let shot = shoot(&system, &start, Period::Driven(1)).unwrap();
        let settled = settle(&system, &start, 200.0, Period::Driven(1)).unwrap();
        for orbit in [shot, settled] {
            assert_eq!(orbit.unslipped(), expected);
            let [from, to] = [orbit.state(), orbit.trajectory().last()];
            let off = apart(&from, &to);
            assert!(off < 1e-13, "{expected:?}: {off:e}");
            // The places at which they stick are no multipliers: what is left decays.
            assert_eq!(orbit.multipliers().len(), 6 + count - expected.len());
            assert!(orbit.is_stable(), "{expected:?}: {:?}", orbit.multipliers());
        }
    }
}

/// A guess whose velocity is rounding of that of the ground: the contact slips for no time at all.
#[test]
fn a_contact_that_slips_by_rounding_never_slips() {
    let law = Coulomb::new(0.4, 0.3).unwrap();
    let belt = Contact::new(0, law, 0.3).unwrap().on_belt(0.1);
    let blocks = Structure::new(&[1.0, 1.0])
        .and_then(|s| s.with_ground_spring(0, 1.0)?.with_ground_spring(1, 1.0))
        .and_then(|s| s.with_spring(0, 1, 0.1)?.with_ground_damper(0, 0.1))
        .and_then(|s| s.with_force(0, sine(0.7)))
        .and_then(|s| {
            s.with_contact(Contact::new(1, law, 1.0)?)?
                .with_contact(belt)
        })
        .unwrap();
    let settled = settle(&blocks, &State::at_rest(2), 100.0, Period::Driven(1)).unwrap();
    for velocity in [0.0, 1e-33, -1e-33, 1e-20] {
        let mut guess = settled.state();
        guess.velocities[1] = velocity;
        let found = shoot(&blocks, &guess, Period::Driven(1)).unwrap();
        assert_eq!(found.unslipped(), [0], "{velocity:e}");
        assert_eq!(found.multipliers().len(), 3);
    }
}

/// The place was that of the guess.
#[test]
fn a_contact_that_never_slips_keeps_the_place_of_the_guess() {
    let system = Structure::new(&[1.0, 1.0])
        .and_then(|s| s.with_ground_spring(0, 1.0)?.with_ground_damper(0, 0.2))
        .and_then(|s| s.with_ground_spring(1, 1.0)?.with_force(0, sine(0.5)))
        .and_then(|s| s.with_contact(Contact::between(0, 1, Coulomb::new(0.5, 0.4)?, 20.0)?))
        .unwrap();
    for apart in [0.0, 0.3, -1.5] {
        let start = State::new(&[apart, 0.0], &[0.0, 0.0]);
        let orbit = shoot(&system, &start, Period::Driven(1)).unwrap();
        for state in [orbit.state(), orbit.trajectory().last()] {
            let found = state.displacements[0] - state.displacements[1];
            assert!((found - apart).abs() < 1e-14, "{found} {apart}");
        }
    }
}

/// A drill string that shrinks to steady sliding, by 2 % per oscillation: beside an equilibrium the
/// flow is small, and Newton's method has to see that the equilibrium lies farther than that.
#[test]
fn what_shrinks_to_steady_sliding_is_no_periodic_motion() {
    let n = 12;
    let mut inertias = vec![60.0; n];
    (inertias[0], inertias[n - 1]) = (300.0, 2100.0);
    let bit = Contact::new(0, Stribeck::new(0.8, 0.4, 1.0, 1).unwrap(), 17512.5).unwrap();
    let string = (0..n - 1)
        .try_fold(Structure::new(&inertias).unwrap(), |string, i| {
            string
                .with_spring(i, i + 1, 473.0 * (n - 1) as f64)?
                .with_damper(i, i + 1, 60.0)
        })
        .and_then(|s| {
            s.with_ground_spring(n - 1, 4000.0)?
                .with_ground_damper(n - 1, 425.0)
        })
        .and_then(|s| s.with_contact(bit.on_belt(-6.0)))
        .unwrap();
    let steady = string.steady_sliding().unwrap();
    let [&slowest] = at_least(&steady.eigenvalues);
    assert!((-0.003..-0.002).contains(&slowest.re), "{slowest}");
    let period = std::f64::consts::TAU / slowest.im.abs();
    let pushes = [1e-6, 1e-9, 1e-3, 1e-8, 1e-7, 1e-5, 1e-4];
    for push in pushes.into_iter().take(count(2, pushes.len())) {
        let mut start = State::new(&steady.displacements, &[0.0; 12]);
        start.velocities[0] = push;
        for transient in [0.0, 20.0, 200.0] {
            let found = settle(&string, &start, transient, Period::Free(period));
            refused!(found => Error::AtRest | Error::NotPeriodic { .. });
        }
    }
}

/// Derivatives by a period of so little overflow.
#[test]
fn the_least_estimate_of_a_period_finds_nothing() {
    let law = Polynomial::new(
        0.20122928429018733,
        0.10106231808337672,
        0.12306729043491449,
    );
    let system = MassOnBelt::new(law.unwrap(), 0.17438575977625276)
        .and_then(|system| system.with_damping(0.140124657552818))
        .and_then(|system| system.with_load(0.1174505946738409))
        .unwrap();
    for least in [f64::from_bits(1), 1e-310, 1e-300] {
        for displacement in [0.0, 2.3e-308] {
            let guess = (displacement, 0.5811796779354172).into();
            let found = shoot(&system, &guess, Period::Free(least));
            refused!(found => Error::NotPeriodic { .. } | Error::AtRest);
        }
    }
}
