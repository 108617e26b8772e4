//! Functions of time of any shape as drives: closed forms, quadratures, and functions that are
//! harmonics or profiles.

use std::f64::consts::{PI, TAU};

use stick_slip::orbit::{self, Period};
use stick_slip::structure::State;
use stick_slip::{
    Contact, Coulomb, Drive, Error, Exponential, ForceElement, Integrator, PolynomialSpring,
    Scalar, Structure, TimeFunction,
};

use crate::common::{Random, count, larger};

/// A cos(Ωt + φ), with or without its period.
struct Wave {
    amplitude: f64,
    frequency: f64,
    phase: f64,
    periodic: bool,
}

impl TimeFunction for Wave {
    fn value<S: Scalar>(&self, time: S, _: usize) -> S {
        (time * self.frequency + self.phase).cos() * self.amplitude
    }
    fn size(&self) -> f64 {
        self.amplitude.abs()
    }
    fn timescale(&self, _: usize) -> f64 {
        self.frequency.recip()
    }
    fn period(&self) -> Option<f64> {
        self.periodic.then_some(TAU / self.frequency)
    }
}

/// h exp(−((t − t0)/w)²).
#[derive(Clone, Copy)]
struct Bump {
    height: f64,
    at: f64,
    width: f64,
}

impl TimeFunction for Bump {
    fn value<S: Scalar>(&self, time: S, _: usize) -> S {
        (-((time - self.at) / self.width).square()).exp() * self.height
    }
    fn size(&self) -> f64 {
        self.height.abs()
    }
    fn timescale(&self, _: usize) -> f64 {
        self.width
    }
}

/// cos(a t²).
struct Chirp(f64);

impl TimeFunction for Chirp {
    fn value<S: Scalar>(&self, time: S, _: usize) -> S {
        (time.square() * self.0).cos()
    }
    fn size(&self) -> f64 {
        1.0
    }
    fn timescale(&self, _: usize) -> f64 {
        0.2
    }
}

/// Half a sine of angular frequency Ω from a time on.
struct Shock {
    start: f64,
    frequency: f64,
}

impl TimeFunction for Shock {
    fn value<S: Scalar>(&self, time: S, piece: usize) -> S {
        match piece {
            1 => ((time - self.start) * self.frequency).sin(),
            _ => time.constant(0.0),
        }
    }
    fn size(&self) -> f64 {
        1.0
    }
    fn timescale(&self, piece: usize) -> f64 {
        if piece == 1 {
            self.frequency.recip()
        } else {
            f64::INFINITY
        }
    }
    fn breakpoints(&self) -> impl Iterator<Item = f64> {
        [self.start, self.start + PI / self.frequency].into_iter()
    }
}

/// 1, then −1 from half of the period on.
struct Square(f64);

impl TimeFunction for Square {
    fn value<S: Scalar>(&self, time: S, piece: usize) -> S {
        time.constant(if piece == 0 { 1.0 } else { -1.0 })
    }
    fn size(&self) -> f64 {
        1.0
    }
    fn timescale(&self, _: usize) -> f64 {
        f64::INFINITY
    }
    fn breakpoints(&self) -> impl Iterator<Item = f64> {
        std::iter::once(0.5 * self.0)
    }
    fn period(&self) -> Option<f64> {
        Some(self.0)
    }
}

fn oscillator(frequency: f64, force: Drive) -> Structure {
    let mass = Structure::new(&[1.0]).unwrap();
    mass.with_ground_spring(0, frequency * frequency)
        .and_then(|mass| mass.with_force(0, force))
        .unwrap()
}

/// ∫ f dt by the 8-point Gauss rule on many panels.
fn quadrature(to: f64, panels: usize, f: impl Fn(f64) -> f64) -> f64 {
    const NODES: [[f64; 2]; 4] = [
        [0.183_434_642_495_649_8, 0.362_683_783_378_362],
        [0.525_532_409_916_329, 0.313_706_645_877_887_3],
        [0.796_666_477_413_626_7, 0.222_381_034_453_374_48],
        [0.960_289_856_497_536_3, 0.101_228_536_290_376_26],
    ];
    let half = 0.5 * to / panels as f64;
    let panel = |i: usize| {
        let middle = (2 * i + 1) as f64 * half;
        let pair = |[x, weight]: [f64; 2]| weight * (f(middle - half * x) + f(middle + half * x));
        half * NODES.map(pair).iter().sum::<f64>()
    };
    (0..panels).map(panel).sum()
}

#[test]
fn a_chirp_on_an_oscillator_is_its_convolution() {
    for (rate, frequency) in [(0.05, 1.0), (0.02, 0.1), (0.05, 2.7)] {
        let chirp = oscillator(frequency, Drive::function(Chirp(rate)).unwrap());
        let motion = chirp.simulate(State::at_rest(1), 40.0).unwrap();
        for time in [3.0, 20.0, 40.0] {
            let state = motion.state_at(time).unwrap();
            let along = |green: &dyn Fn(f64) -> f64| {
                quadrature(time, 4000, |t| {
                    green(frequency * (time - t)) * (rate * t * t).cos()
                })
            };
            let displacement = along(&|phase| phase.sin()) / frequency;
            let velocity = along(&|phase| phase.cos());
            let errors = [
                (state.displacements[0] - displacement) * frequency,
                state.velocities[0] - velocity,
            ];
            assert!(
                errors.iter().all(|e| e.abs() < 1e-13),
                "{rate} {time} {errors:?}"
            );
        }
    }
}

#[test]
fn a_shock_has_its_closed_form() {
    // At once, after a long rest, and much shorter than the period of the oscillator.
    for (start, frequency, own) in [(0.0, 1.0, 2.0), (1e3, 3.0, 0.7), (1e4, 1e3, 1.0)] {
        let force = Drive::function(Shock { start, frequency }).unwrap();
        assert!(force.period().is_none());
        let end = start + PI / frequency;
        let motion = oscillator(own, force)
            .simulate(State::at_rest(1), end + 5.0)
            .unwrap();
        let during = |t: f64| {
            let bottom = own * own - frequency * frequency;
            let x = (frequency * t).sin() - frequency / own * (own * t).sin();
            let v = frequency * ((frequency * t).cos() - (own * t).cos());
            [x / bottom, v / bottom]
        };
        let at = |time: f64| motion.state_at(time).unwrap();
        // The times themselves are rounded.
        let allowed = 1e-13 + 2.0 * f64::EPSILON * end;
        for part in [0.2, 0.5, 0.9] {
            let time = start + part * PI / frequency;
            let [x, v] = during(time - start);
            assert!((at(time).displacements[0] - x).abs() < allowed);
            assert!((at(time).velocities[0] - v).abs() < allowed);
        }
        let [x, v] = during(PI / frequency);
        for since in [1.0, 5.0] {
            let (sine, cosine) = (own * since).sin_cos();
            let state = at(end + since);
            assert!((state.displacements[0] - (x * cosine + v / own * sine)).abs() < allowed);
            assert!((state.velocities[0] - (v * cosine - own * x * sine)).abs() < allowed);
        }
    }
}

#[test]
fn no_step_goes_over_a_narrow_bump() {
    let bump = Bump {
        height: 3.0,
        at: 500.0,
        width: 0.01,
    };
    let push = bump.height * bump.width * PI.sqrt();
    for frequency in [1.0, 1e-2, 1e-4] {
        let moved = oscillator(frequency, Drive::function(bump).unwrap());
        let state = moved.simulate(State::at_rest(1), 700.0).unwrap().last();
        let size = push * (-0.25 * (frequency * bump.width).powi(2)).exp();
        let (sine, cosine) = (frequency * 200.0).sin_cos();
        let errors = [
            state.displacements[0] * frequency - size * sine,
            state.velocities[0] - size * cosine,
        ];
        assert!(
            errors.iter().all(|e| e.abs() < 1e-13),
            "{frequency} {errors:?}"
        );
    }
    // A mass without a spring, and one that sticks until then.
    let free = Structure::new(&[1.0]).unwrap();
    let free = free.with_force(0, Drive::function(bump).unwrap()).unwrap();
    let last = free.simulate(State::at_rest(1), 700.0).unwrap().last();
    assert!((last.velocities[0] - push).abs() < 1e-14);
    let contact = Contact::new(0, Coulomb::new(0.4, 0.4).unwrap(), 5.0).unwrap();
    let stuck = free.with_contact(contact).unwrap();
    let motion = stuck.simulate(State::at_rest(1), 700.0).unwrap();
    let half = bump.width * (bump.height / 2.0).ln().sqrt();
    assert_eq!(motion.events().len(), 2);
    let released = motion.events()[0].time;
    assert!((released - (bump.at - half)).abs() < 1e-12, "{released}");
    // A load that vanishes for a moment lets the mass slip.
    let dip = Bump {
        height: -4.9,
        ..bump
    };
    let contact = Contact::new(
        0,
        Coulomb::new(0.4, 0.4).unwrap(),
        Drive::constant(5.0).with_function(dip).unwrap(),
    );
    let pulled = Structure::new(&[1.0])
        .and_then(|mass| mass.with_force(0, 1.0))
        .and_then(|mass| mass.with_contact(contact.unwrap()))
        .unwrap();
    let motion = pulled.simulate(State::at_rest(1), 700.0).unwrap();
    assert_eq!(motion.events().len(), 2);
    // 1 = 0.4 (5 − 4.9 exp(−x²)).
    let half = bump.width * (4.9_f64 / 2.5).ln().sqrt();
    let released = motion.events()[0].time;
    assert!((released - (bump.at - half)).abs() < 1e-12, "{released}");
}

#[test]
fn a_belt_that_follows_a_function_carries_the_mass() {
    let bump = Bump {
        height: 0.3,
        at: 50.0,
        width: 0.01,
    };
    let velocity = Drive::constant(0.1).with_function(bump).unwrap();
    let contact = Contact::new(0, Coulomb::new(0.4, 0.4).unwrap(), 1e4).unwrap();
    let held = Structure::new(&[1.0])
        .and_then(|mass| mass.with_contact(contact.on_belt(velocity)))
        .unwrap();
    let start = State::new(&[0.0], &[0.1]);
    let motion = held.simulate(start, 100.0).unwrap();
    assert!(motion.events().is_empty());
    let way = 10.0 + bump.height * bump.width * PI.sqrt();
    assert!((motion.last().displacements[0] - way).abs() < 1e-14);

    // Over many periods.
    let end = count(200, 1000) as f64;
    let wave = |periodic| Wave {
        amplitude: 0.2,
        frequency: 1.3,
        phase: -0.5 * PI,
        periodic,
    };
    for periodic in [true, false] {
        let velocity = Drive::function(wave(periodic)).unwrap();
        let contact = Contact::new(0, Coulomb::new(0.4, 0.4).unwrap(), 1e4).unwrap();
        let held = Structure::new(&[1.0])
            .and_then(|mass| mass.with_contact(contact.on_belt(velocity)))
            .unwrap();
        let state = held.simulate(State::at_rest(1), end).unwrap().last();
        let way = 0.2 / 1.3 * (1.0 - (1.3_f64 * end).cos());
        assert!((state.displacements[0] - way).abs() < 1e-13, "{periodic}");
    }
}

/// A random structure of one to three masses, whose drives are harmonics, and the same with
/// functions.
fn both_ways(random: &mut Random) -> [Structure; 2] {
    let n = 1 + (random.bits() % 3) as usize;
    let periodic = random.bits().is_multiple_of(2);
    let frequency = random.uniform(0.3, 2.5);
    let mut both = [(); 2].map(|()| {
        let masses: Vec<f64> = (0..n).map(|i| 1.0 + 0.3 * i as f64).collect();
        Structure::new(&masses).unwrap()
    });
    let drive = |random: &mut Random, constant: f64, amplitude: f64| {
        let phase = random.uniform(-3.0, 3.0);
        let wave = Wave {
            amplitude,
            frequency,
            phase,
            periodic,
        };
        let constant = Drive::constant(constant);
        [
            constant
                .clone()
                .with_harmonic(amplitude, frequency, phase)
                .unwrap(),
            constant.with_function(wave).unwrap(),
        ]
    };
    for i in 0..n {
        let stiffness = random.uniform(0.5, 3.0);
        let amplitude = random.uniform(0.1, 1.0);
        let mean = random.uniform(-0.5, 0.5);
        let forces = drive(random, mean, amplitude);
        let belts = drive(random, 0.3, if i == 0 { 0.1 } else { 0.0 });
        let loads = drive(random, 1.0, 0.3);
        let factors = drive(random, 1.0, 0.4);
        let joint = random.bits().is_multiple_of(3);
        let elastic = random.bits().is_multiple_of(2);
        for (structure, ((force, belt), (load, factor))) in std::iter::zip(
            &mut both,
            forces
                .into_iter()
                .zip(belts)
                .zip(loads.into_iter().zip(factors)),
        ) {
            let law = Exponential::new(0.5, 0.2, 2.0).unwrap();
            // Elastic joints have a constant coefficient.
            let elastic = elastic.then_some(5.0).filter(|_| joint && i > 0);
            let contact = match elastic {
                Some(stiffness) => {
                    let law = Coulomb::new(0.4, 0.4).unwrap();
                    Contact::between(i - 1, i, law, load)
                        .and_then(|contact| contact.with_tangential_stiffness(stiffness))
                }
                None if joint && i > 0 => Contact::between(i - 1, i, law, load),
                None => Contact::new(i, law, load),
            };
            let spring = PolynomialSpring::new(&[0.3, 0.0, 0.2]).unwrap();
            let element = ForceElement::new(i, spring).unwrap();
            *structure = std::mem::replace(structure, Structure::new(&[1.0]).unwrap())
                .with_ground_spring(i, stiffness)
                .and_then(|s| s.with_ground_damper(i, 0.05))
                .and_then(|s| s.with_force(i, force))
                .and_then(|s| s.with_contact(contact.unwrap().on_belt(belt)))
                .and_then(|s| s.with_element(element.with_factor(factor)?))
                .unwrap();
        }
    }
    both
}

#[test]
fn a_function_that_is_a_harmonic_gives_its_motions() {
    let mut random = Random::new(11);
    let mut worst: f64 = 0.0;
    for case in 0..count(60, 200) {
        let both = both_ways(&mut random);
        let start = State::at_rest(both[0].len());
        let [harmonic, function] = both.map(|s| s.simulate(start.clone(), 30.0).unwrap());
        let kinds = [&harmonic, &function].map(|motion| {
            let events = motion.events().iter();
            events
                .map(|e| (e.contact().unwrap(), e.kind))
                .collect::<Vec<_>>()
        });
        assert_eq!(kinds[0], kinds[1], "case {case}");
        for (one, other) in std::iter::zip(harmonic.events(), function.events()) {
            worst = larger(worst, (one.time - other.time).abs());
        }
        let [one, other] = [harmonic.last(), function.last()];
        for (x, y) in std::iter::zip(one.displacements, other.displacements) {
            worst = larger(worst, (x - y).abs());
        }
        assert!(worst < 1e-11, "case {case}: {worst:e}");
    }
}

#[test]
fn a_periodic_function_is_the_profile_that_it_repeats() {
    let period = 2.7;
    let square = Drive::function(Square(period)).unwrap();
    assert_eq!(square.period(), Some(period));
    let mut points = vec![];
    for turn in 0..20 {
        let start = f64::from(turn) * period;
        if turn > 0 {
            points.push((start, -1.0));
        }
        points.extend([
            (start, 1.0),
            (start + 0.5 * period, 1.0),
            (start + 0.5 * period, -1.0),
        ]);
    }
    let profile = Drive::profile(&points).unwrap();
    let contact = || Contact::new(0, Coulomb::new(0.4, 0.3).unwrap(), 1.0).unwrap();
    let [one, other] = [square, profile].map(|force| {
        let driven = oscillator(1.0, force)
            .with_contact(contact().on_belt(0.1))
            .unwrap();
        driven.simulate(State::at_rest(1), 50.0).unwrap()
    });
    assert!(one.events().len() > 10);
    assert_eq!(one.events().len(), other.events().len());
    for (one, other) in std::iter::zip(one.events(), other.events()) {
        assert!(one.kind == other.kind && (one.time - other.time).abs() < 1e-12);
    }
}

#[test]
fn a_periodic_motion_has_the_period_of_a_function() {
    let orbit = |force: Drive| {
        let contact = Contact::new(0, Exponential::new(0.4, 0.25, 2.0).unwrap(), 1.0).unwrap();
        let forced = oscillator(1.0, force)
            .with_ground_damper(0, 0.1)
            .and_then(|forced| forced.with_contact(contact.on_belt(0.2)))
            .unwrap();
        orbit::settle(&forced, &State::at_rest(1), 200.0, Period::Driven(1)).unwrap()
    };
    let wave = |periodic| Wave {
        amplitude: 0.3,
        frequency: 0.8,
        phase: 0.4,
        periodic,
    };
    let one = orbit(Drive::harmonic(0.3, 0.8, 0.4).unwrap());
    let other = orbit(Drive::function(wave(true)).unwrap());
    assert_eq!(one.period(), other.period());
    assert_eq!(one.events().len(), other.events().len());
    assert!((one.extremes(0).1 - other.extremes(0).1).abs() < 1e-12);
    for (one, other) in std::iter::zip(one.multipliers(), other.multipliers()) {
        assert!((one - other).norm() < 1e-11);
    }
    // Jumps at both ends of the period.
    let square = orbit(Drive::function(Square(8.0)).unwrap());
    assert_eq!(square.period(), 8.0);
    // Without a period there is none.
    let aperiodic = oscillator(1.0, Drive::function(wave(false)).unwrap());
    let found = orbit::settle(&aperiodic, &State::at_rest(1), 9.0, Period::Driven(1));
    assert!(matches!(found, Err(Error::NoCommonPeriod)));
}

/// A function whose parts are given one by one.
struct Given {
    size: f64,
    timescale: f64,
    period: Option<f64>,
    breakpoints: Vec<f64>,
    value: f64,
}

impl TimeFunction for Given {
    fn value<S: Scalar>(&self, time: S, _: usize) -> S {
        time.constant(self.value)
    }
    fn size(&self) -> f64 {
        self.size
    }
    fn timescale(&self, _: usize) -> f64 {
        self.timescale
    }
    fn breakpoints(&self) -> impl Iterator<Item = f64> {
        self.breakpoints.iter().copied()
    }
    fn period(&self) -> Option<f64> {
        self.period
    }
}

#[test]
fn what_is_no_function_is_refused_and_nan_ends_the_motion() {
    let good = || Given {
        size: 1.0,
        timescale: 1.0,
        period: None,
        breakpoints: vec![0.0, 1.0],
        value: 1.0,
    };
    assert!(Drive::function(good()).is_ok());
    let refused = |given: Given| Drive::function(given).unwrap_err();
    for breakpoints in [
        vec![1.0, 1.0],
        vec![0.0, f64::NAN],
        vec![0.0, f64::INFINITY],
    ] {
        let given = Given {
            breakpoints,
            ..good()
        };
        assert!(matches!(
            refused(given),
            Error::BadBreakpoints { index: 1, .. }
        ));
    }
    for (period, breakpoints) in [(1.0, vec![0.0, 1.0]), (1.0, vec![0.0, 2.0])] {
        let given = Given {
            period: Some(period),
            breakpoints,
            ..good()
        };
        assert!(matches!(
            refused(given),
            Error::BadBreakpoints { index: 1, .. }
        ));
    }
    // A jump is no velocity of a rigid contact's belt.
    let contact = Contact::new(0, Coulomb::new(0.4, 0.3).unwrap(), 1.0).unwrap();
    let square = contact.on_belt(Drive::function(Square(2.0)).unwrap());
    let error = Structure::new(&[1.0])
        .unwrap()
        .with_contact(square)
        .unwrap_err();
    assert!(
        matches!(error, Error::BeltVelocityJumps { time: 0.0, .. }),
        "{error}"
    );

    struct Root;
    impl TimeFunction for Root {
        fn value<S: Scalar>(&self, time: S, _: usize) -> S {
            (-time + 3.0).sqrt()
        }
        fn size(&self) -> f64 {
            2.0
        }
        fn timescale(&self, _: usize) -> f64 {
            0.5
        }
    }
    let root = || Drive::function(Root).unwrap();
    let law = || Coulomb::new(0.4, 0.3).unwrap();
    let mass = || Structure::new(&[1.0]).unwrap();
    let spring = PolynomialSpring::new(&[1.0]).unwrap();
    let driven = [
        oscillator(1.0, root()),
        mass().with_force(0, root()).unwrap(),
        mass()
            .with_contact(Contact::new(0, law(), root()).unwrap().on_belt(0.1))
            .unwrap(),
        mass()
            .with_contact(Contact::new(0, law(), 1.0).unwrap().on_belt(root()))
            .unwrap(),
        mass()
            .with_element(
                ForceElement::new(0, spring)
                    .unwrap()
                    .with_factor(root())
                    .unwrap(),
            )
            .unwrap(),
    ];
    for (case, driven) in driven.iter().enumerate() {
        let start = State::new(&[0.3], &[0.1]);
        let error = Integrator::new().simulate(driven, start, 10.0).unwrap_err();
        let (Error::StepUnderflow { reached, .. }
        | Error::NonFiniteFriction {
            reached: Some(reached),
            ..
        }) = &error
        else {
            panic!("{case}: {error}")
        };
        assert!(reached.time > 2.9 && reached.time <= 3.0, "{case}: {error}");
    }
}

#[test]
fn a_function_is_equal_to_itself_only() {
    let [one, other] = [(); 2].map(|()| Drive::function(Chirp(0.1)).unwrap());
    assert_eq!(one, one.clone());
    assert_ne!(one, other);
    assert!(format!("{one:?}").contains("Chirp"));
}

/// exp(−((t − 1)/w)²) in each period of 2: the formula is 0 in all others.
struct Bumps;

/// Width of a bump.
const WIDTH: f64 = 0.01;

impl TimeFunction for Bumps {
    fn value<S: Scalar>(&self, time: S, _: usize) -> S {
        (-((time - 1.0) / WIDTH).square()).exp()
    }
    fn size(&self) -> f64 {
        1.0
    }
    fn timescale(&self, _: usize) -> f64 {
        WIDTH
    }
    fn period(&self) -> Option<f64> {
        Some(2.0)
    }
}

/// A bump in each period gives a free mass a velocity, and moves one that sticks to its belt.
#[test]
fn a_function_without_breakpoints_is_that_of_one_period() {
    let bumps = || Drive::function(Bumps).unwrap();
    let free = Structure::new(&[1.0])
        .and_then(|block| block.with_force(0, bumps()))
        .unwrap();
    let carried = Contact::new(0, Coulomb::new(1e6, 1e6).unwrap(), 1.0)
        .and_then(|contact| Structure::new(&[1.0])?.with_contact(contact.on_belt(bumps())))
        .unwrap();
    for start in [0.0, 0.5, 1.5, 1.9] {
        for end in [3.7, 6.5, 20.5] {
            let run = |block: &Structure| {
                let from = Integrator::new().with_start_time(start).unwrap();
                let motion = from.simulate(block, State::at_rest(1), end - start);
                motion.unwrap().last()
            };
            let passed = |t: f64| ((t + 1.0) / 2.0).floor();
            let expected = (passed(end) - passed(start)) * WIDTH * PI.sqrt();
            for found in [run(&free).velocities[0], run(&carried).displacements[0]] {
                let off = found - expected;
                assert!(off.abs() < 1e-12, "{start} {end}: {off:e}");
            }
        }
    }
}

/// A table under a block that sticks is shaken by half a sine, which begins at 0.
#[test]
fn a_shaken_table_carries_its_block() {
    /// Start, duration and height.
    struct Shock(f64, f64, f64);
    impl TimeFunction for Shock {
        fn value<S: Scalar>(&self, time: S, piece: usize) -> S {
            match piece {
                1 => ((time - self.0) * (PI / self.1)).sin() * self.2,
                _ => time.constant(0.0),
            }
        }
        fn size(&self) -> f64 {
            self.2
        }
        fn timescale(&self, piece: usize) -> f64 {
            [f64::INFINITY, self.1 / PI, f64::INFINITY][piece]
        }
        fn breakpoints(&self) -> impl Iterator<Item = f64> {
            [self.0, self.0 + self.1].into_iter()
        }
    }
    for start in [0.0, 1.0, 5.0, 50.0] {
        for (duration, height) in [(1.0, 0.3), (0.1, 0.3), (1.0, 300.0), (1.0, 3e-4)] {
            let table = Drive::function(Shock(start, duration, height)).unwrap();
            let contact = Contact::new(0, Coulomb::new(30.0, 30.0).unwrap(), 1e3).unwrap();
            let block = Structure::new(&[1.0])
                .and_then(|block| block.with_ground_spring(0, 1.0))
                .and_then(|block| block.with_contact(contact.on_belt(table)))
                .unwrap();
            let motion = block
                .simulate(State::at_rest(1), start + 2.0 * duration)
                .unwrap();
            let off = motion.last().displacements[0] - height * duration * 2.0 / PI;
            assert!(
                off.abs() < 1e-13 * height,
                "{start} {duration} {height}: {off:e}"
            );
        }
    }
}
