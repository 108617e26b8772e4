//! The mass on a belt, followed by the engine of structures: two engines that share no phase
//! machine must tell the same story.

use stick_slip::structure;
use stick_slip::{
    AnyLaw, Error, Exponential, FrictionLaw, Integrator, MassOnBelt, Mode, Polynomial, State,
    Structure, Tabulated, Trajectory,
};

use crate::common::{Random, Worst, larger, number, on_belt, system_of, text};
use crate::reading::cases;

/// Difference allowed in times and states, in units of max(1, |value|).
const ACCURACY: f64 = 1e-13;

/// What was compared.
#[derive(Default)]
struct Compared {
    motions: usize,
    events: usize,
    /// The largest errors, in parts of what is allowed.
    worst: Worst,
}

impl Compared {
    /// Follows one motion by both.
    fn motion<L: FrictionLaw + Clone + Send + Sync + 'static>(
        &mut self,
        about: &str,
        belt: &MassOnBelt<L>,
        start: State,
        duration: f64,
    ) {
        self.motions += 1;
        let structure = Structure::from(belt);
        let expected = belt.simulate(start, duration).unwrap();
        let found = structure.simulate(start, duration).unwrap();
        let kinds = |n: usize| (expected.events()[n].kind, found.events()[n].kind);
        let magnified = magnification(belt, &expected, duration);
        let allowed = ACCURACY + 8.0 * f64::EPSILON * magnified;
        for (n, (one, other)) in std::iter::zip(expected.events(), found.events()).enumerate() {
            let about = format!("{about}, event {n}");
            assert_eq!(kinds(n).0, kinds(n).1, "{about}");
            assert_eq!(other.contact().unwrap(), 0);
            self.worst
                .meet_within(allowed, &about, other.time, one.time);
            let (u, v) = (other.state.displacements[0], other.state.velocities[0]);
            self.worst
                .meet_within(allowed, &about, u, one.state.displacement);
            // The belt's velocity, to the bit.
            assert_eq!(one.state.velocity, v, "{about}");
            self.events += 1;
        }
        assert_eq!(expected.events().len(), found.events().len(), "{about}");
        for (time, one) in expected.sample(20) {
            let other = found.state_at(time).unwrap();
            self.worst
                .meet_within(allowed, about, other.displacements[0], one.displacement);
            self.worst
                .meet_within(4.0 * allowed, about, other.velocities[0], one.velocity);
        }
    }
}

/// What the problem itself makes of a rounding: the largest change of the motion at any time, for a
/// change of 1 in the displacement at some time before.
fn magnification<L: FrictionLaw>(belt: &MassOnBelt<L>, motion: &Trajectory, duration: f64) -> f64 {
    const NUDGE: f64 = 1e-9;
    let mut grown = 1.0_f64;
    // Anywhere, and shortly after each event: a release forgets what was before.
    let events = motion.events().iter().map(|event| event.time + 0.01);
    let times = motion.sample(12).map(|(time, _)| time).chain(events);
    for (from, state) in motion.sample_at(times) {
        let nudged = State::new(state.displacement + NUDGE, state.velocity);
        let nudged = belt.simulate(nudged, duration - from).unwrap();
        for (time, one) in motion.sample(40).filter(|(time, _)| *time >= from) {
            let Some(other) = nudged.state_at(time - from) else {
                continue; // the end, rounded
            };
            let apart = (one.displacement - other.displacement)
                .abs()
                .max((one.velocity - other.velocity).abs());
            grown = grown.max(apart / NUDGE);
        }
    }
    grown
}

#[test]
fn reference_motions_of_the_belt() {
    let mut compared = Compared::default();
    for case in cases(include_str!("../data/trajectories.json")) {
        let belt = system_of(&case);
        let start = match text(&case["start"]["type"]) {
            "release" => belt.release_state().unwrap(),
            _ => State::new(number(&case["start"]["u"]), number(&case["start"]["v"])),
        };
        compared.motion(text(&case["id"]), &belt, start, 60.0);
    }
    assert_eq!(compared.motions, 22);
    compared.worst.assert("both engines", 1.0);
}

#[test]
fn random_belts() {
    let mut compared = Compared::default();
    let mut random = Random::new(17);
    for i in 0..1000 {
        let belt = random.system();
        let start = match i % 4 {
            0 => belt.release_state().unwrap(),
            1 => State::new(random.uniform(-1.0, 1.0), belt.belt_velocity()),
            _ => State::new(random.uniform(-2.0, 2.0), random.uniform(-2.0, 2.0)),
        };
        compared.motion(&format!("{i}: {belt:?}, {start:?}"), &belt, start, 30.0);
    }
    assert!(compared.events > 2500, "{}", compared.events);
    compared.worst.assert("both engines", 1.0);
}

/// Laws so steep that slip faster than the belt is damped at rates up to 10⁴. Where the problem
/// magnifies nothing the two may still be apart by as much as a step may leave out.
#[test]
fn steep_cubic_laws() {
    let mut random = Random::new(99);
    let (mut compared, mut apart, mut worst) = (0, 0, 0.0_f64);
    for i in 0..1000 {
        let limit = random.uniform(0.2, 0.8);
        let least = limit * random.uniform(0.3, 1.0);
        let law = Polynomial::new(limit, least, random.logarithmic(0.05, 1.5)).unwrap();
        let belt = on_belt(
            law,
            random.sign() * random.logarithmic(0.03, 2.0),
            random.uniform(0.0, 0.4),
            random.logarithmic(0.1, 5.0),
        );
        let start = State::new(random.uniform(-2.0, 2.0), random.uniform(-2.0, 2.0));
        let expected = belt.simulate(start, 10.0).unwrap();
        let found = Structure::from(&belt).simulate(start, 10.0).unwrap();
        assert_eq!(
            expected.events().len(),
            found.events().len(),
            "{i}: {belt:?}"
        );
        let mut largest = 0.0_f64;
        for (one, other) in std::iter::zip(expected.events(), found.events()) {
            assert_eq!(one.kind, other.kind, "{i}: {belt:?}");
            largest = larger(largest, (one.time - other.time).abs());
            compared += 1;
        }
        for (time, one) in expected.sample(50) {
            let other = found.state_at(time).unwrap();
            largest = larger(largest, (one.displacement - other.displacements[0]).abs());
        }
        apart += usize::from(largest > ACCURACY);
        worst = larger(worst, largest);
    }
    println!("{compared} events, {apart} motions apart, worst {worst:.1e}");
    assert!(
        worst < 1e-12 && apart <= 5,
        "{apart} motions apart, worst {worst:.1e}"
    );
}

/// Fast slip under a steep law, by a Taylor series of order 36 in 40 digits.
#[test]
fn steep_cubic_laws_in_40_digits() {
    for (law, v_b, damping, load, start, time, end) in [
        (
            [0.7928079028591324, 0.35623977788734035, 0.07535271910876735],
            1.3124895666593734,
            0.3441577769503061,
            1.9908878679253206,
            State::new(-0.006246547765100363, -0.24250149573144641),
            0.1507537688442211,
            [0.1696024995078068611904, 1.203214045028274820259],
        ),
        (
            [
                0.28941594734113135,
                0.10754192408629942,
                0.07174731950975977,
            ],
            -0.9521396727251888,
            0.02558351653472002,
            1.9317061350827553,
            State::new(-1.129488531652095, 1.392228178183121),
            0.1507537688442211,
            [-1.241591819809527641185, -0.7933765952009954806155],
        ),
    ] {
        let [limit, least, velocity] = law;
        let belt = on_belt(
            Polynomial::new(limit, least, velocity).unwrap(),
            v_b,
            damping,
            load,
        );
        let one = belt.simulate(start, time).unwrap().last();
        let structure = Structure::from(&belt);
        let other = structure.simulate(start, time).unwrap().last();
        for [u, v] in [
            [one.displacement, one.velocity],
            [other.displacements[0], other.velocities[0]],
        ] {
            assert!((u - end[0]).abs() < 1e-15, "{u:e} {:e}", end[0]);
            assert!((v - end[1]).abs() < 1e-15, "{v:e} {:e}", end[1]);
        }
    }
}

/// The release point is exactly the edge of the stick band, also where it is rounded.
#[test]
fn the_release_state_is_released() {
    let mut random = Random::new(18);
    for _ in 0..2000 {
        let belt: MassOnBelt<AnyLaw> = random.system();
        let release = belt.release_state().unwrap();
        let structure = Structure::from(&belt);
        let from = |displacement: f64| {
            let start = structure::State::new(&[displacement], &[release.velocity]);
            structure.simulate(start, 1e-3).unwrap()
        };
        let motion = from(release.displacement);
        let expected = belt.simulate(release, 1e-3).unwrap();
        assert_eq!(motion.events().len(), expected.events().len(), "{belt:?}");
        assert_eq!(
            motion.events()[0].kind,
            expected.events()[0].kind,
            "{belt:?}"
        );
        assert_eq!(motion.events()[0].time, 0.0);
        // Well before it the mass sticks, and well beyond it slips without an event.
        let far = 1e-9 * release.displacement.abs().max(1.0) * belt.belt_velocity().signum();
        assert_eq!(
            from(release.displacement - 1e-2 * belt.belt_velocity()).mode_at(0, 0.0),
            Some(Mode::Stick)
        );
        let beyond = from(release.displacement + far);
        assert!(
            matches!(beyond.mode_at(0, 0.0), Some(Mode::Slip(_))),
            "{belt:?}"
        );
        assert!(beyond.events().is_empty(), "{belt:?}");
    }
}

#[test]
fn starts_that_do_not_fit_are_refused() {
    let belt = crate::common::paper(0.2);
    let structure = Structure::from(&belt);
    let state = structure::State::new;
    for (start, name) in [
        (state(&[], &[0.0]), "displacements"),
        (state(&[0.0, 1.0], &[0.0]), "displacements"),
        (state(&[0.0], &[]), "velocities"),
        (state(&[0.0], &[0.0, 0.0]), "velocities"),
        (state(&[0.0], &[0.0]).with_memory(&[1.0]), "memory"),
    ] {
        let Err(Error::WrongSize { name: found, .. }) = structure.simulate(start, 1.0) else {
            panic!("{name}")
        };
        assert!(found.contains(name), "{found}");
    }
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        assert!(structure.simulate(state(&[bad], &[0.0]), 1.0).is_err());
        assert!(structure.simulate(state(&[0.0], &[bad]), 1.0).is_err());
        assert!(structure.simulate(state(&[0.0], &[0.0]), bad).is_err());
    }
    assert!(structure.simulate(state(&[0.0], &[0.0]), -1.0).is_err());
    assert!(structure.simulate(state(&[0.0], &[0.0]), 0.0).is_ok());
}

/// A mass far outside of the stick band flies off the belt at once, however narrow the law's
/// feature at the belt is beside the tolerance: a series may come back there, the motion does not.
#[test]
fn a_mass_outside_the_stick_band_leaves_the_belt_at_any_tolerance() {
    let law = Exponential::new(0.06, 0.003, 8e-4).unwrap();
    let points = [(0.0, 0.345), (0.077, 0.214), (0.154, 0.158), (0.309, 0.301)];
    let table = Tabulated::new(points)
        .and_then(|law| law.with_static_coefficient(0.457))
        .unwrap();
    let laws: [(AnyLaw, _, _); 2] = [(law.into(), 1.2e-6, 45.0), (table.into(), 8222.0, 40.86)];
    for (law, load, v_b) in laws {
        let belt = on_belt(law.clone(), v_b, 0.0, load);
        let structure = Structure::from(&belt);
        let start = State::new(belt.stick_limits()[0] - 66.0, v_b);
        let exact = belt.simulate(start, 0.1).unwrap().last();
        for tolerance in [1e-14, 1e-12, 1e-10, 1e-8, 1e-6, 1e-4, 1e-2] {
            let integrator = Integrator::new().with_tolerance(tolerance).unwrap();
            let motion = integrator.simulate(&structure, start, 0.1).unwrap();
            let last = motion.last();
            let forces = start.displacement.abs() + load * law.static_coefficient();
            let apart = (last.velocities[0] - exact.velocity).abs() / forces.max(v_b);
            assert!(apart <= 10.0 * tolerance, "{v_b} {tolerance:e}: {apart:e}");
        }
    }
}
