//! Force laws: values, slopes, pieces and potentials.

use approx::assert_abs_diff_eq;

use stick_slip::structure::State;
use stick_slip::{
    Backlash, Contact, Coulomb, Error, ForceElement, ForceLaw, FrictionLaw, Pendulum,
    PolynomialSpring, SnapThrough, Structure, Tabulated, TabulatedForce, VanDerPol,
};

use crate::common::any_force::{AnyForce, CubicDamper};
use crate::common::{Random, count};

/// Laws of every kind, so many of each, with what to say of one that fails.
fn laws(seed: u64, of_each: usize) -> impl Iterator<Item = (String, AnyForce)> {
    let mut random = Random::new(seed);
    (0..of_each * Random::FORCES).map(move |i| {
        let law = random.any_force(i % Random::FORCES, 2.0, 1.0);
        (format!("law {i}: {law:?}"), law)
    })
}

/// Derivative by the differences of six neighbours.
fn derivative(f: impl Fn(f64) -> f64, x: f64, h: f64) -> f64 {
    let pair = |n: f64| (f(x + n * h) - f(x - n * h)) / h;
    (45.0 * pair(1.0) - 9.0 * pair(2.0) + pair(3.0)) / 60.0
}

#[test]
fn laws_have_the_values_of_their_formulas() {
    for x in [-2.0, -0.7, -0.5, 0.0, 1e-9, 0.3, 0.5, 1.9_f64] {
        for y in [-3.0, 0.0, 0.4] {
            let spring = PolynomialSpring::new(&[0.3, -0.2, 0.7, 0.1]).unwrap();
            let sum = 0.3 * x - 0.2 * x.powi(2) + 0.7 * x.powi(3) + 0.1 * x.powi(4);
            let energy =
                0.15 * x.powi(2) - 0.2 / 3.0 * x.powi(3) + 0.175 * x.powi(4) + 0.02 * x.powi(5);
            assert_abs_diff_eq!(spring.force(x, y, 0), sum, epsilon = 1e-14);
            assert_abs_diff_eq!(spring.potential(x, 0).unwrap(), energy, epsilon = 1e-14);

            let pendulum = Pendulum::new(-0.7, 0.3).unwrap();
            let sine = -0.7 * (x / 0.3).sin();
            let energy = -0.21 * (1.0 - (x / 0.3).cos());
            assert_abs_diff_eq!(pendulum.force(x, y, 0), sine, epsilon = 1e-15);
            assert_abs_diff_eq!(pendulum.potential(x, 0).unwrap(), energy, epsilon = 1e-15);

            let backlash = AnyForce::Backlash(Backlash::new(3.0, 0.5).unwrap());
            let beyond = (x.abs() - 0.5).max(0.0).copysign(x);
            assert_abs_diff_eq!(backlash.at(x, y), 3.0 * beyond, epsilon = 1e-15);
            let energy = backlash.energy(x).unwrap();
            assert_abs_diff_eq!(energy, 1.5 * beyond * beyond, epsilon = 1e-15);

            let snap = SnapThrough::new(2.0, 1.2, 0.8).unwrap();
            let length = x.hypot(0.8);
            let force = 2.0 * x * (1.0 - 1.2 / length);
            assert_abs_diff_eq!(snap.force(x, y, 0), force, epsilon = 1e-14);
            let energy = snap.potential(x, 0).unwrap();
            assert_abs_diff_eq!(energy, (length - 1.2).powi(2), epsilon = 1e-15);

            let damper = VanDerPol::new(0.4, 1.5).unwrap();
            let force = (1.5 * x * x - 0.4) * y;
            assert_abs_diff_eq!(damper.force(x, y, 0), force, epsilon = 1e-14);
            assert_eq!(damper.potential(x, 0), None);
        }
    }
    // A small angle loses no digits of its energy.
    let energy = Pendulum::new(2.0, 1.0).unwrap().potential(1e-8, 0).unwrap();
    assert!((energy - 1e-16).abs() < 1e-31);
}

#[test]
fn laws_have_the_numbers_they_were_given() {
    let spring = PolynomialSpring::new(&[1.0, 0.0, 3.0]).unwrap();
    assert_eq!(spring.coefficients(), [1.0, 0.0, 3.0]);
    let pendulum = Pendulum::new(9.81, 2.0).unwrap();
    assert_eq!((pendulum.moment(), pendulum.length()), (9.81, 2.0));
    let backlash = Backlash::new(3.0, 0.5).unwrap();
    assert_eq!((backlash.stiffness(), backlash.gap()), (3.0, 0.5));
    let snap = SnapThrough::new(2.0, 1.2, 0.8).unwrap();
    assert_eq!((snap.stiffness(), snap.free_length()), (2.0, 1.2));
    assert_eq!(snap.span(), 0.8);
    let damper = VanDerPol::new(0.4, 1.5).unwrap();
    assert_eq!(damper.negative_damping(), 0.4);
    assert_eq!(damper.nonlinear_damping(), 1.5);
    let points = [(-1.0, -3.0), (0.5, 0.0), (1.0, 1.0)];
    for is_linear in [false, true] {
        let table = table(&points, is_linear);
        assert_eq!(table.points(), points);
        assert_eq!(table.is_piecewise_linear(), is_linear);
    }
}

#[test]
fn pieces_are_continuous() {
    let mut found = 0;
    for (about, law) in laws(1, count(20, 400)) {
        for (piece, b) in law.breakpoints().enumerate() {
            found += 1;
            for y in [0.0, 0.7] {
                let [below, above] = [piece, piece + 1].map(|piece| law.force(b, y, piece));
                // Horner's rule over one interval: rounding errors of forces of about 2.
                assert_abs_diff_eq!(below, above, epsilon = 4e-15);
            }
            let [below, above] = [piece, piece + 1].map(|piece| law.potential(b, piece).unwrap());
            assert!((below - above).abs() < 4e-15, "{about} at {b}");
        }
    }
    assert!(found > 200, "{found}");
}

#[test]
fn the_slope_of_a_potential_is_the_force_at_rest() {
    let mut random = Random::new(2);
    for (about, law) in laws(3, count(20, 400)) {
        for _ in 0..20 {
            let x = random.uniform(-2.5, 2.5);
            let piece = law.piece(x);
            let Some(energy) = law.potential(x, piece) else {
                assert!(matches!(
                    law,
                    AnyForce::VanDerPol(_) | AnyForce::CubicDamper(_)
                ));
                continue;
            };
            let h = 0.01;
            let slope = derivative(|x| law.potential(x, piece).unwrap(), x, h);
            let force = law.force(x, 0.0, piece);
            // h⁶/140 times the seventh derivative, at most 6!·16/l⁷ with l ≥ 1/2, and rounding.
            let allowed = 1e-8 * (1.0 + force.abs() + energy.abs());
            assert!(
                (slope - force).abs() < allowed,
                "{about} at {x}: {slope} {force}"
            );
        }
    }
}

/// Potentials of tables are 0 at 0, wherever the points lie.
#[test]
fn the_potential_of_a_table_begins_at_zero() {
    let points = [(-2.0, -3.0), (-0.5, -1.0), (0.7, 1.0), (2.0, 2.0)];
    for shift in [-5.0, -2.0, -1.0, 0.0, 0.5, 1.0, 3.0, 5.0] {
        let shifted = points.map(|(x, force)| (x + shift, force));
        for is_linear in [false, true] {
            let law = AnyForce::Table(table(&shifted, is_linear));
            // Rounding of the energy between 0 and the nearest point.
            assert_abs_diff_eq!(law.energy(0.0).unwrap(), 0.0, epsilon = 1e-14);
            // To another place by the midpoint rule.
            let n = 20_000;
            let end = 1.5;
            let middle = |i: u32| end * (f64::from(i) + 0.5) / f64::from(n);
            let sum: f64 = (0..n).map(|i| law.at(middle(i), 0.0)).sum();
            let work = sum * end / f64::from(n);
            assert_abs_diff_eq!(law.energy(end).unwrap(), work, epsilon = 1e-7);
        }
    }
}

fn table(points: &[(f64, f64)], is_linear: bool) -> TabulatedForce {
    let table = if is_linear {
        TabulatedForce::piecewise_linear(points)
    } else {
        TabulatedForce::new(points)
    };
    table.unwrap()
}

/// Up to the last interval, where friction levels off, both tables are the same curve.
#[test]
fn tables_of_forces_are_those_of_friction() {
    let points = [
        (0.0, 0.4),
        (0.1, 0.33),
        (0.3, 0.27),
        (0.6, 0.25),
        (1.0, 0.26),
    ];
    for (friction, is_linear) in [
        (Tabulated::new(points), false),
        (Tabulated::piecewise_linear(points), true),
    ] {
        let (friction, force) = (friction.unwrap(), table(&points, is_linear));
        for i in 0..60 {
            let x = 0.01 * f64::from(i);
            let piece = points.iter().filter(|point| point.0 <= x).count();
            assert_eq!(force.force(x, 1.0, piece), friction.kinetic(x), "{x}");
        }
    }
}

/// The force at 0 is 0, and so may be its slope: what rounding leaves of the piece below is
/// compared with the forces nearby.
#[test]
fn tables_may_go_through_the_origin() {
    let mut random = Random::new(5);
    for _ in 0..count(500, 50_000) {
        let [mut below, above] = [(); 2].map(|()| random.uniform(0.1, 1.0));
        let [x0, x1] = [(); 2].map(|()| random.uniform(0.1, 3.0));
        below *= random.sign();
        let points = [(-x0, below), (0.0, 0.0), (x1, above)];
        for is_linear in [false, true] {
            ForceElement::new(0, table(&points, is_linear)).unwrap();
        }
    }
}

#[test]
fn tables_of_forces_turn_with_their_points() {
    let points = [
        (-1.0, -3.0),
        (-0.4, -0.6),
        (0.0, 0.0),
        (1.0, 1.0),
        (2.0, 4.0),
    ];
    let mut turned = points.map(|(x, force)| (-x, -force));
    turned.reverse();
    for is_linear in [false, true] {
        let [one, other] =
            [points, turned].map(|points| AnyForce::Table(table(&points, is_linear)));
        for i in -300..300 {
            let x = 0.01 * f64::from(i) + 0.005;
            assert_abs_diff_eq!(one.at(x, 0.0), -other.at(-x, 0.0), epsilon = 1e-14);
            let energies = [one.energy(x), other.energy(-x)].map(Option::unwrap);
            assert_abs_diff_eq!(energies[0], energies[1], epsilon = 1e-14);
        }
    }
}

#[test]
fn tables_of_forces_continue_along_a_straight_line() {
    let points = [(-1.0, -3.0), (0.0, 0.0), (1.0, 1.0), (2.0, 4.0)];
    // Chords 3, 1, 3 of length 1: the slope at both ends is (3·3 − 1)/2.
    for (is_linear, slope) in [(false, 4.0), (true, 3.0)] {
        let law = AnyForce::Table(table(&points, is_linear));
        for beyond in [0.0, 0.5, 3.0, 100.0] {
            assert_eq!(law.at(2.0 + beyond, 1.0), 4.0 + slope * beyond);
            assert_eq!(law.at(-1.0 - beyond, 1.0), -3.0 - slope * beyond);
        }
        // From inside too.
        for (piece, x) in [(1, -1.0), (3, 2.0)] {
            let inside = derivative(|x| law.force(x, 0.0, piece), x, 0.01);
            assert_abs_diff_eq!(inside, slope, epsilon = 1e-12);
        }
    }
    let [(x0, _), (x1, _)] = [(0.3, 1.0), (0.9, 2.0)];
    let two = AnyForce::Table(table(&[(x0, 1.0), (x1, 2.0)], false));
    for x in [-2.0, 0.5, 4.0] {
        assert_abs_diff_eq!(two.at(x, 0.0), 1.0 + (x - x0) / (x1 - x0), epsilon = 1e-14);
    }
}

#[test]
fn backlash_without_a_gap_is_a_linear_spring() {
    for gap in [0.0, -0.0] {
        let law = Backlash::new(3.0, gap).unwrap();
        assert_eq!(law.breakpoints().count(), 0);
        for x in [-2.0, 0.0, 0.3] {
            assert_eq!(law.force(x, 1.0, 0), 3.0 * x);
            assert_eq!(law.potential(x, 0), Some(x * x * 1.5));
        }
    }
    let law = Backlash::new(3.0, 5e-324).unwrap();
    assert_eq!(law.breakpoints().collect::<Vec<_>>(), [-5e-324, 5e-324]);
    assert!(ForceElement::new(0, law).is_ok());
}

/// A conservative law of each kind carries a mass of 1, and gives back what it has taken.
#[test]
fn energy_is_kept() {
    for (about, law) in laws(4, count(3, 50)) {
        if matches!(
            law,
            AnyForce::VanDerPol(_) | AnyForce::CubicDamper(_) | AnyForce::Mixed(_)
        ) {
            continue;
        }
        let mass = Structure::new(&[1.0]).unwrap();
        let mass = mass.with_element(law.clone().element(&[(0, 1.0)])).unwrap();
        let motion = mass.simulate(State::new(&[0.2], &[1.0]), 10.0).unwrap();
        let energy = |state: &State| {
            let velocity = state.velocities[0];
            0.5 * velocity * velocity + law.energy(state.displacements[0]).unwrap()
        };
        let start = energy(&State::new(&[0.2], &[1.0]));
        for (time, state) in motion.sample(200) {
            // Rounding errors of some hundred steps, each of the size of the energies.
            let apart = (energy(&state) - start).abs();
            assert!(apart < 2e-13, "{about} at {time}: {apart:e}");
        }
    }
}

#[test]
fn elements_are_equal_if_their_laws_have_equal_numbers() {
    let pendulum = |length: f64| ForceElement::new(0, Pendulum::new(1.0, length).unwrap()).unwrap();
    assert_eq!(pendulum(1.0), pendulum(1.0));
    assert_ne!(pendulum(1.0), pendulum(2.0));
    let backlash = ForceElement::new(0, Backlash::new(1.0, 1.0).unwrap()).unwrap();
    assert_ne!(pendulum(1.0), backlash);
    let other = ForceElement::new(1, Pendulum::new(1.0, 1.0).unwrap()).unwrap();
    assert_ne!(pendulum(1.0), other);
    assert_ne!(pendulum(1.0).with_factor(2.0).unwrap(), pendulum(1.0));
    // The same points, joined in two ways.
    let points = [(-1.0, -1.0), (0.0, 0.0), (1.0, 3.0)];
    let tables = [false, true].map(|is_linear| table(&points, is_linear));
    assert_ne!(tables[0], tables[1]);

    let own = || ForceElement::new(0, CubicDamper(1.0)).unwrap();
    let one = own();
    assert_eq!(one, one.clone());
    assert_ne!(one, own());
    assert_ne!(one, pendulum(1.0));
}

#[test]
fn contacts_are_equal_if_their_loads_are() {
    let pressed = |length: f64| {
        let contact = Contact::new(0, Coulomb::new(0.4, 0.3).unwrap(), 1.0).unwrap();
        let law = Pendulum::new(0.1, length).unwrap();
        contact.with_load_law(&[(0, 1.0)], law).unwrap()
    };
    assert_eq!(pressed(1.0), pressed(1.0));
    assert_ne!(pressed(1.0), pressed(2.0));
    let bare = Contact::new(0, Coulomb::new(0.4, 0.3).unwrap(), 1.0).unwrap();
    assert_ne!(pressed(1.0), bare);
}

#[test]
fn elements_show_their_laws() {
    let text = |law: AnyForce| format!("{:?}", law.element(&[(0, 1.0)]));
    let pendulum = text(AnyForce::Pendulum(Pendulum::new(1.5, 2.0).unwrap()));
    let expected = "law: Pendulum { moment: 1.5, length: 2.0 }, factor";
    assert!(pendulum.contains(expected), "{pendulum}");
    let own = text(AnyForce::CubicDamper(CubicDamper(1.0)));
    assert!(own.contains("law: a user's law, factor"), "{own}");
}

#[test]
fn points_of_a_table_of_forces_are_checked() {
    let refused = |points: &[(f64, f64)]| {
        let [one, other] = [
            TabulatedForce::new(points),
            TabulatedForce::piecewise_linear(points),
        ];
        let [one, other] = [one.unwrap_err(), other.unwrap_err()];
        assert_eq!(one.to_string(), other.to_string());
        one
    };
    // The first point at fault, with its first number.
    for (points, fault, fault_name) in [
        (vec![(f64::NAN, 0.0), (1.0, f64::NAN)], 0, "position"),
        (vec![(0.0, f64::INFINITY), (0.0, 1.0)], 0, "force"),
        (vec![(0.0, 0.0), (1.0, f64::NAN), (0.5, 1.0)], 1, "force"),
        (vec![(0.0, 0.0), (1.0, 1.0), (1.0, f64::NAN)], 2, "position"),
        (vec![(0.0, 0.0), (1e-300, 1e300), (1.0, 1.0)], 1, "position"),
        (vec![(1.0, 1e200), (1e200, 1e200)], 1, "force"),
    ] {
        let error = refused(&points);
        let Error::BadPoint { index, name, .. } = error else {
            panic!("{error:?}");
        };
        assert_eq!((index, name), (fault, fault_name), "{points:?}");
    }
}

/// At the positions where a potential is compared with its force, a short pendulum has turned over
/// many times.
#[test]
fn pendulums_of_any_length_are_elements() {
    for exponent in -12..=12 {
        let length = 1.7 * 10_f64.powi(exponent);
        let pendulum = Pendulum::new(9.81, length).unwrap();
        let element = ForceElement::new(0, pendulum);
        assert!(element.is_ok(), "length {length}: {element:?}");
    }
}
