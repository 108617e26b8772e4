//! Force elements: identities with linear structures, closed forms, conservation, and errors.

use stick_slip::nalgebra::DMatrix;
use stick_slip::structure::{Element, NotSliding, State};
use stick_slip::{
    Backlash, Contact, Coulomb, Drive, Error, ForceElement, ForceField, ForceLaw, Integrator,
    Pendulum, PolynomialSpring, Scalar, Structure,
};

use crate::common::any_force::Magnet;
use crate::common::forces::QuarticPair;
use crate::common::{Random, count};
use crate::restarts::{coordinate, difference, draw, run};

/// F = c x + d y.
#[derive(Debug, Clone, Copy)]
struct Linear(f64, f64);

impl ForceLaw for Linear {
    fn force<S: Scalar>(&self, x: S, y: S, _: usize) -> S {
        x * self.0 + y * self.1
    }
    fn potential<S: Scalar>(&self, x: S, _: usize) -> Option<S> {
        Some(x.square() * (0.5 * self.0))
    }
}

/// Two linear springs and dampers that know nothing of each other.
#[derive(Debug, Clone, Copy)]
struct Two(Linear, Linear);

impl ForceField for Two {
    type Coordinates<S: Scalar> = [S; 2];
    fn forces<S: Scalar>(&self, x: [S; 2], y: [S; 2]) -> [S; 2] {
        [self.0.force(x[0], y[0], 0), self.1.force(x[1], y[1], 0)]
    }
}

fn mass(element: ForceElement) -> Structure {
    let mass = Structure::new(&[1.0]).unwrap();
    mass.with_element(element).unwrap()
}

/// A mass of 1 on a spring with a law.
fn sprung<L: ForceLaw + Send + Sync + 'static>(law: L) -> Structure {
    mass(ForceElement::new(0, law).unwrap())
}

/// The same on a belt under constant friction, 0.2 of a load.
fn rubbing<L: ForceLaw + Send + Sync + 'static>(law: L, load: f64) -> Structure {
    let friction = Contact::new(0, Coulomb::new(0.2, 0.2).unwrap(), load).unwrap();
    sprung(law).with_contact(friction.on_belt(1.0)).unwrap()
}

/// A structure with a spring c and a damper d along a direction, and the same as elements, written
/// in one of several ways.
fn both_ways(random: &mut Random, structure: Structure) -> [Structure; 2] {
    let n = structure.len();
    let entry = |random: &mut Random| random.uniform(-1.0, 1.0);
    let direction: Vec<(usize, f64)> = match random.bits() % 3 {
        0 => vec![(coordinate(random, n), 1.0)],
        _ => (0..n).map(|j| (j, entry(random))).collect(),
    };
    let (c, d) = (random.uniform(0.0, 2.0), random.uniform(0.0, 0.3));
    let row = |j: usize| {
        direction
            .iter()
            .filter(|(i, _)| *i == j)
            .map(|(_, a)| a)
            .sum::<f64>()
    };
    let matrix = |factor: f64| DMatrix::from_fn(n, n, |i, j| factor * (row(i) * row(j)));
    let linear = structure.clone().with_stiffness(matrix(c)).unwrap();
    let linear = linear.with_damping(matrix(d)).unwrap();
    let along = |direction: &[(usize, f64)], law| ForceElement::along(direction, law).unwrap();
    let elements = match random.bits() % 4 {
        0 => vec![along(&direction, Linear(c, d))],
        // Two halves.
        1 => vec![along(&direction, Linear(0.5 * c, 0.5 * d)); 2],
        // Twice the direction, and a factor.
        2 => {
            let twice: Vec<_> = direction.iter().map(|(j, a)| (*j, 2.0 * a)).collect();
            let half = along(&twice, Linear(0.5 * c, 0.5 * d));
            vec![half.with_factor(0.5).unwrap()]
        }
        _ => {
            let field = Two(Linear(c, 0.0), Linear(0.0, d));
            vec![ForceElement::field(&[&direction, &direction], field).unwrap()]
        }
    };
    let with = |structure: Structure, element| structure.with_element(element).unwrap();
    [linear, elements.into_iter().fold(structure, with)]
}

/// All kinds of contacts, full mass matrices, drives: events and states agree as far as the problem
/// itself magnifies rounding errors.
#[test]
fn a_linear_element_is_a_spring_and_a_damper() {
    let mut random = Random::new(51);
    let [mut compared, mut unclear] = [0; 2];
    let mut wrong = Vec::new();
    for number in 0..count(75, 1000) {
        let (structure, start) = draw(&mut random);
        let [linear, with_elements] = both_ways(&mut random, structure);
        let motions = [&linear, &with_elements].map(|s| run(s, 0.0, start.clone()));
        let [Ok(motion), Ok(found)] = motions else {
            continue;
        };
        compared += 1;
        let apart = difference(&linear, &motion, &found);
        if apart < 1e-11 {
            continue;
        }
        let near = [-1e-10, 1e-10].map(|force| {
            let pushed = linear.clone().with_force(0, force).unwrap();
            let pushed = run(&pushed, 0.0, start.clone());
            pushed.map_or(f64::INFINITY, |pushed| {
                difference(&linear, &motion, &pushed)
            })
        });
        let near = near[0].max(near[1]);
        if near > 1e-4 || apart < 1e-3 * near {
            unclear += 1;
        } else {
            wrong.push((number, apart, near));
        }
    }
    println!("{compared} structures, {unclear} unclear");
    assert!(wrong.is_empty(), "{wrong:?}");
    assert!(
        unclear * 20 < compared && compared > count(50, 100),
        "{unclear} of {compared}"
    );
}

/// 4 K(m)/Ω of a Duffing oscillator, Γ(¼)²/(√π A) of a pure cubic, 4 K(sin²(A/2)) of a pendulum,
/// and a formula of straight pieces for backlash: computed with 60 digits.
#[test]
fn free_vibrations_have_the_periods_of_their_closed_forms() {
    // 3 (|x| − ½) beyond ½, and a spring of 1 throughout.
    let gap = ForceElement::new(0, Backlash::new(3.0, 0.5).unwrap()).unwrap();
    let cases = [
        (
            sprung(PolynomialSpring::new(&[1.0, 0.0, 0.7]).unwrap()),
            2.0,
            3.603712656168182309250034,
        ),
        (
            sprung(PolynomialSpring::new(&[0.0, 0.0, 1.0]).unwrap()),
            1.0,
            7.416298709205487673735401,
        ),
        (
            sprung(Pendulum::new(1.0, 1.0).unwrap()),
            2.0,
            8.349752926918494734406372,
        ),
        (
            mass(gap).with_ground_spring(0, 1.0).unwrap(),
            1.0,
            4.289263558629854269960580,
        ),
    ];
    for (structure, amplitude, period) in cases {
        let start = State::new(&[amplitude], &[0.0]);
        let motion = structure.simulate(start.clone(), 10.0 * period).unwrap();
        for turns in [1.0, 10.0] {
            let state = motion.state_at(turns * period).unwrap();
            // A velocity of 0 shows an error of the period at once.
            let velocity = state.velocities[0].abs();
            assert!(velocity < turns * 1e-13, "{structure:?}: {velocity:e}");
            assert!((state.displacements[0] - amplitude).abs() < 1e-14 * turns);
        }
        // The energy is constant to rounding, over a hundred periods too.
        let long = structure.simulate(start.clone(), 100.0 * period).unwrap();
        let energy = |state: &State| {
            structure.kinetic_energy(state).unwrap() + structure.elastic_energy(0.0, state).unwrap()
        };
        let (first, last) = (energy(&start), energy(&long.last()));
        assert!(
            // A linear spring loses 1e-13 in as many steps.
            (last - first).abs() < 3e-13 * first,
            "{:e}",
            last / first - 1.0
        );
        let budget = structure.energy_budget(&long).unwrap();
        assert!(budget.defect().abs() < 3e-13 * first, "{budget:?}");
        assert!(budget.element_work[0].abs() < 1e-13 * first, "{budget:?}");
    }
}

/// A mass that leaves x = 0 against a pure power of x: only every (p + 1)-th coefficient of its
/// series is not 0. The first integral v²/2 + x^(p+1)/(p+1) is kept.
#[test]
fn series_with_gaps_are_no_polynomials() {
    for power in [3, 5, 7, 9, 12, 20] {
        let mut c = vec![0.0; power];
        c[power - 1] = 1.0;
        let structure = sprung(PolynomialSpring::new(&c).unwrap());
        for speed in [0.5, 1.0, 3.0] {
            let start = State::new(&[0.0], &[speed]);
            // An even power drives the mass away once it is back.
            let turns = if power % 2 == 0 { 1.5 } else { 20.0 };
            let motion = structure.simulate(start, turns / speed).unwrap();
            let end = motion.last();
            let power = power as f64 + 1.0;
            let potential = end.displacements[0].powf(power) / power;
            let energy = 0.5 * end.velocities[0].powi(2) + potential;
            let expected = 0.5 * speed * speed;
            assert!(
                (energy - expected).abs() < 1e-13 * expected,
                "{power} {energy}"
            );
        }
    }
}

/// y_1 x_2 − y_2 x_1 of a potential with rotational symmetry.
#[test]
fn a_rotation_symmetric_field_conserves_the_angular_momentum() {
    let directions: [&[(usize, f64)]; 2] = [&[(0, 1.0)], &[(1, 1.0)]];
    let element = ForceElement::field(&directions, QuarticPair(1.3)).unwrap();
    let structure = Structure::new(&[2.0, 2.0])
        .and_then(|s| s.with_ground_spring(0, 0.7)?.with_ground_spring(1, 0.7))
        .and_then(|s| s.with_element(element))
        .unwrap();
    let motion = structure
        .simulate(State::new(&[1.0, -0.2], &[0.3, 0.9]), 200.0)
        .unwrap();
    let moment = |state: &State| {
        let (q, v) = (&state.displacements, &state.velocities);
        q[0] * v[1] - q[1] * v[0]
    };
    let expected = 0.9 + 0.2 * 0.3;
    for k in 0..=200 {
        let found = moment(&motion.state_at(f64::from(k)).unwrap());
        assert!((found - expected).abs() < 1e-13, "{found}");
    }
}

/// Without a gap a backlash spring is a linear spring; within its gap it is nothing at all.
#[test]
fn backlash_has_its_limits() {
    let friction = || Contact::new(0, Coulomb::new(0.3, 0.2).unwrap(), 1.0).unwrap();
    let base = || {
        Structure::new(&[1.0])
            .and_then(|s| {
                s.with_ground_spring(0, 0.5)?
                    .with_contact(friction().on_belt(0.2))
            })
            .unwrap()
    };
    let with = |law| {
        base()
            .with_element(ForceElement::new(0, law).unwrap())
            .unwrap()
    };
    let start = || State::new(&[0.1], &[0.2]);
    let spring = base().with_ground_spring(0, 1.5).unwrap();
    let motions = [
        (spring, with(Backlash::new(1.5, 1e-300).unwrap())),
        (base(), with(Backlash::new(1.5, 50.0).unwrap())),
    ];
    for (plain, backlash) in motions {
        let [a, b] = [plain, backlash].map(|s| s.simulate(start(), 100.0).unwrap());
        assert_eq!(a.events().len(), b.events().len());
        assert!(a.events().len() > 8, "{:?}", a.events());
        for (a, b) in std::iter::zip(a.events(), b.events()) {
            assert_eq!(a.kind, b.kind);
            assert!((a.time - b.time).abs() < 1e-12, "{} {}", a.time, b.time);
        }
    }
}

/// The separatrix x = √2 sech t of x'' = x − x³: the motion stays on it as long as rounding errors,
/// which grow as e^t, let it.
#[test]
fn a_separatrix_is_followed_as_far_as_rounding_errors_let_it() {
    let structure = sprung(PolynomialSpring::new(&[-1.0, 0.0, 1.0]).unwrap());
    let start = State::new(&[2.0_f64.sqrt()], &[0.0]);
    let motion = structure.simulate(start, 20.0).unwrap();
    for k in 1..=20 {
        let t = f64::from(k);
        let x = motion.state_at(t).unwrap().displacements[0];
        let expected = 2.0_f64.sqrt() / t.cosh();
        assert!(
            (x - expected).abs() < 8.0 * f64::EPSILON * t.exp(),
            "{t}: {x} {expected}"
        );
    }
}

/// Mathieu's equation x'' + (δ + ε cos t) x = 0: for δ = ¼ it grows as e^{εt/2} to first order; the
/// determinant of its period map is 1.
#[test]
fn a_factor_is_a_stiffness_that_varies() {
    let (delta, epsilon) = (0.25, 0.05);
    let factor = Drive::constant(delta)
        .with_harmonic(epsilon, 1.0, 0.0)
        .unwrap();
    let element = ForceElement::new(0, Linear(1.0, 0.0)).unwrap();
    let structure = mass(element.with_factor(factor).unwrap());
    let period = std::f64::consts::TAU;
    let columns = [[1.0, 0.0], [0.0, 1.0]].map(|[q, v]| {
        let last = structure
            .simulate(State::new(&[q], &[v]), period)
            .unwrap()
            .last();
        [last.displacements[0], last.velocities[0]]
    });
    let [[a, c], [b, d]] = columns;
    assert!((a * d - b * c - 1.0).abs() < 1e-14);
    let half = 0.5 * (a + d).abs();
    let rate = (half + (half * half - 1.0).sqrt()).ln() / period;
    assert!((rate - 0.5 * epsilon).abs() < epsilon * epsilon, "{rate}");
    // The work that the factor does is the growth of the energy.
    let motion = structure
        .simulate(State::new(&[1.0], &[0.0]), 10.0)
        .unwrap();
    let budget = structure.energy_budget(&motion).unwrap();
    assert!(budget.defect().abs() < 1e-13 && budget.element_work[0].abs() > 0.01);
    // A factor that jumps stores energy at once.
    let jumps = Drive::profile(&[(1.0, 1.0), (1.0, 3.0)]).unwrap();
    let element = ForceElement::new(0, Linear(1.0, 0.0)).unwrap();
    let structure = mass(element.with_factor(jumps).unwrap());
    let motion = structure.simulate(State::new(&[1.0], &[0.0]), 2.0).unwrap();
    let budget = structure.energy_budget(&motion).unwrap();
    assert!(
        (budget.element_work[0] - 1.0_f64.cos().powi(2)).abs() < 1e-14,
        "{budget:?}"
    );
    assert!(budget.defect().abs() < 1e-14);
}

/// Samples contain the forces of elements, and obey the equations of motion.
#[test]
fn samples_contain_the_forces_of_elements() {
    let factor = Drive::constant(1.0).with_harmonic(0.3, 1.7, 0.2).unwrap();
    let element =
        ForceElement::between(0, 1, PolynomialSpring::new(&[0.5, 0.0, 2.0]).unwrap()).unwrap();
    let structure = Structure::new(&[1.0, 2.0])
        .and_then(|s| {
            s.with_ground_spring(0, 1.0)?
                .with_force(1, Drive::sine(0.4, 0.9)?)
        })
        .and_then(|s| s.with_element(element.with_factor(factor.clone())?))
        .unwrap();
    let motion = structure
        .simulate(State::new(&[0.5, -0.5], &[0.0, 0.0]), 10.0)
        .unwrap();
    for sample in structure.samples(&motion, 0.1).unwrap() {
        let q = &sample.state.displacements;
        let x = q[0] - q[1];
        let force = factor.value(sample.time) * (0.5 * x + 2.0 * x.powi(3));
        assert!((sample.element_forces[0][0] - force).abs() < 1e-14);
        assert!((sample.accelerations[0] + q[0] + force).abs() < 1e-14);
        let acceleration = structure.acceleration(sample.time, &sample.state).unwrap();
        assert!((acceleration[0] - sample.accelerations[0]).abs() < 1e-13);
    }
}

/// A law by a function, for laws that are wrong.
struct Wrong {
    law: fn(f64) -> f64,
    breakpoints: Vec<f64>,
}

impl ForceLaw for Wrong {
    fn force<S: Scalar>(&self, x: S, _: S, piece: usize) -> S {
        // Constant on each piece.
        x.constant((self.law)(piece as f64))
    }
    fn breakpoints(&self) -> impl Iterator<Item = f64> {
        self.breakpoints.iter().copied()
    }
}

#[test]
fn elements_that_are_wrong_are_refused() {
    let refused = |law, breakpoints: &[f64]| {
        let breakpoints = breakpoints.to_vec();
        ForceElement::new(0, Wrong { law, breakpoints }).map(drop)
    };
    let constant: fn(f64) -> f64 = |_| 1.0;
    assert_eq!(refused(constant, &[-1.0, 0.0, 2.0]), Ok(()));
    for (breakpoints, index) in [
        (&[0.0, 0.0][..], 1),
        (&[1.0, -1.0], 1),
        (&[f64::NAN], 0),
        (&[0.0, f64::INFINITY], 1),
    ] {
        let value = breakpoints[index];
        match refused(constant, breakpoints) {
            Err(Error::BadBreakpoints {
                index: at,
                value: found,
            }) => {
                assert_eq!((at, found.to_bits()), (index, value.to_bits()));
            }
            other => panic!("{other:?}"),
        }
    }
    // A step in a track would add energy.
    let jump = refused(|piece| piece, &[0.5]);
    assert_eq!(
        jump,
        Err(Error::BadBreakpoints {
            index: 0,
            value: 0.5
        })
    );
    let linear = Linear(1.0, 0.0);
    assert!(matches!(
        ForceElement::between(1, 1, linear),
        Err(Error::BadDirection { .. })
    ));
    for direction in [
        &[][..],
        &[(0, 0.0)],
        &[(0, f64::NAN)],
        &[(0, 1.0), (0, 2.0)],
    ] {
        assert!(
            ForceElement::along(direction, linear).is_err(),
            "{direction:?}"
        );
    }
    let few = ForceElement::field(&[&[(0, 1.0)]], QuarticPair(1.0));
    assert_eq!(
        few.unwrap_err(),
        Error::WrongSize {
            name: "directions of the force element",
            found: 1,
            expected: 2,
        }
    );
    let far = ForceElement::new(3, linear).unwrap();
    let error = Structure::new(&[1.0, 1.0])
        .unwrap()
        .with_element(far)
        .unwrap_err();
    assert_eq!(
        error,
        Error::NoSuchCoordinate {
            element: Element::ForceElement(0),
            coordinate: 3,
            count: 2,
        }
    );
    assert!(error.to_string().contains("force element 0"), "{error}");
}

/// Motions that meet a singular point of a force end with the place.
#[test]
fn singular_points_of_a_force_are_named() {
    // Pulled into a magnet at 1: v²/2 = 1/(1 − x) + constant.
    let magnet = mass(
        ForceElement::new(
            0,
            Magnet {
                strength: 1.0,
                gap: 1.0,
            },
        )
        .unwrap(),
    );
    match magnet.simulate(State::at_rest(1), 10.0) {
        Err(Error::NonFiniteForce {
            element: 0,
            position,
            value,
            reached,
            ..
        }) => {
            assert!((position - 1.0).abs() < 1e-6, "{position}");
            assert!(value.abs() > 1e6);
            // ∫ dx/√(2x/(1 − x)) from 0 to 1.
            assert!((reached.time - std::f64::consts::FRAC_PI_2 / 2.0_f64.sqrt()).abs() < 1e-6);
        }
        other => panic!("{other:?}"),
    }
    // Hertz's contact without a breakpoint at 0 has no power series there.
    struct Hertz;
    impl ForceLaw for Hertz {
        fn force<S: Scalar>(&self, x: S, _: S, _: usize) -> S {
            if x.value() < 0.0 {
                x.constant(0.0)
            } else {
                x.powf(1.5)
            }
        }
    }
    let hertz = mass(ForceElement::new(0, Hertz).unwrap());
    match hertz.simulate(State::new(&[0.0], &[1.0]), 10.0) {
        Err(Error::NotAnalyticForce {
            element: 0,
            position: 0.0,
            ..
        }) => {}
        other => panic!("{other:?}"),
    }
    let closing = hertz.simulate(State::new(&[-1.0], &[1.0]), 10.0);
    assert!(
        matches!(closing, Err(Error::NotAnalyticForce { position: 0.0, .. })),
        "{closing:?}"
    );
    // A law that is no number.
    struct Hole;
    impl ForceLaw for Hole {
        fn force<S: Scalar>(&self, x: S, _: S, _: usize) -> S {
            x.ln()
        }
    }
    let hole = mass(ForceElement::new(0, Hole).unwrap());
    match hole.simulate(State::new(&[-1.0], &[0.0]), 1.0) {
        Err(error @ Error::NonFiniteForce { position: -1.0, .. }) => {
            assert!(error.to_string().contains("force element 0"), "{error}");
        }
        other => panic!("{other:?}"),
    }
}

/// Newton's method against closed forms; equilibria that there are not.
#[test]
fn steady_sliding_is_found_with_nonlinear_forces() {
    // x³ = 0.2 N on a spring without a stiffness at rest.
    for load in [1e-6, 1.0, 5.0, 1e6] {
        let cubic = rubbing(PolynomialSpring::new(&[0.0, 0.0, 1.0]).unwrap(), load);
        let sliding = cubic.steady_sliding().unwrap();
        let expected = (0.2 * load).cbrt();
        let found = sliding.displacements[0];
        assert!(
            (found - expected).abs() < 4.0 * f64::EPSILON * expected,
            "{load} {found}"
        );
        let frequency = 3.0_f64.sqrt() * expected;
        assert!((sliding.eigenvalues[0].im - frequency).abs() < 1e-14 * frequency);
        assert!(sliding.eigenvalues[0].re.abs() < 1e-14 * frequency);
    }
    // Without a load nothing tells where a spring without a stiffness at rest gets one.
    let idle = sprung(PolynomialSpring::new(&[0.0, 0.0, 1.0]).unwrap());
    let error = idle.steady_sliding().unwrap_err();
    assert_eq!(error, Error::NoSteadySliding(NotSliding::Singular));
    // A pendulum carries a moment of 1 at most.
    let pendulum = rubbing(Pendulum::new(1.0, 1.0).unwrap(), 4.0)
        .steady_sliding()
        .unwrap();
    assert!((pendulum.displacements[0] - 0.8_f64.asin()).abs() < 1e-15);
    let error = rubbing(Pendulum::new(1.0, 1.0).unwrap(), 6.0)
        .steady_sliding()
        .unwrap_err();
    match error {
        Error::NoSteadySliding(NotSliding::NotFound { residual, load }) => {
            assert!(
                (0.5..1.0).contains(&load) && residual > 0.01,
                "{load} {residual}"
            );
        }
        other => panic!("{other:?}"),
    }
    // Two wells, by the start.
    let wells = rubbing(PolynomialSpring::new(&[-1.0, 0.0, 1.0]).unwrap(), 0.5);
    for start in [-1.0, 1.0] {
        let x = wells.steady_sliding_from(&[start]).unwrap().displacements[0];
        assert!((x.powi(3) - x - 0.1).abs() < 1e-15 && (x - start).abs() < 0.1);
    }
    assert!(wells.steady_sliding_from(&[f64::NAN]).is_err());
    assert!(wells.steady_sliding_from(&[0.0; 2]).is_err());
    // On a breakpoint the stiffness is that of neither side.
    let gap = rubbing(Backlash::new(1.0, 0.25).unwrap(), 1.0);
    let gap = gap.with_ground_spring(0, 0.8).unwrap();
    match gap.steady_sliding() {
        Err(Error::NoSteadySliding(NotSliding::AtBreakpoint {
            element: Element::ForceElement(0),
            position,
        })) => {
            assert!((position - 0.25).abs() < 1e-15);
        }
        other => panic!("{other:?}"),
    }
}

/// The frequencies of an undamped structure with a full mass matrix have no real parts.
#[test]
fn undamped_structures_do_not_grow_by_rounding() {
    let mut random = Random::new(77);
    for _ in 0..count(100, 1000) {
        let n = 2 + coordinate(&mut random, 5);
        let mut symmetric = |weight: f64| {
            let half = DMatrix::from_fn(n, n, |_, _| random.uniform(-1.0, 1.0));
            &half * half.transpose() + DMatrix::identity(n, n) * weight
        };
        let (mass, stiffness) = (symmetric(0.3), symmetric(0.1));
        let structure = Structure::with_mass_matrix(mass).unwrap();
        let structure = structure.with_stiffness(stiffness).unwrap();
        for eigenvalue in structure.steady_sliding().unwrap().eigenvalues {
            assert_eq!(eigenvalue.re, 0.0, "{structure:?}");
        }
    }
}

/// A tolerance is kept with elements, too.
#[test]
fn errors_follow_the_tolerance() {
    let structure = sprung(Pendulum::new(1.0, 1.0).unwrap());
    let start = || State::new(&[0.0], &[1.5]);
    let exact = structure.simulate(start(), 30.0).unwrap().last();
    for tolerance in [1e-12, 1e-9, 1e-6] {
        let integrator = Integrator::new().with_tolerance(tolerance).unwrap();
        let last = integrator
            .simulate(&structure, start(), 30.0)
            .unwrap()
            .last();
        let error = (last.displacements[0] - exact.displacements[0]).abs();
        assert!(error < 1000.0 * tolerance, "{tolerance}: {error}");
    }
}
