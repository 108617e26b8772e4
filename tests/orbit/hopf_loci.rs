//! Hopf curves of steady sliding in two parameters: closed forms, and points known to 25 digits.

use approx::assert_abs_diff_eq;
use stick_slip::bifurcation::{Criticality, HopfLocus, hopf_locus};
use stick_slip::nalgebra::DMatrix;
use stick_slip::orbit::{LocusEnd, SpecialKind};
use stick_slip::structure::State;
use stick_slip::{
    Contact, Coulomb, Drive, Dwell, Error, Exponential, FirstOrder, ForceLaw, LuGre, MassOnBelt,
    Scalar, Structure,
};

use crate::common::{Random, count, exactly, list, number, one_mass, text};
use crate::loci::{curve, member};

/// Error promised for parameters, in units of max(1, |value|).
const ACCURACY: f64 = 1e-13;

fn close(actual: f64, expected: f64) -> bool {
    (actual - expected).abs() <= ACCURACY * expected.abs().max(1.0)
}

fn special(locus: &HopfLocus, kind: SpecialKind) -> Vec<[f64; 2]> {
    let of_kind = locus.special.iter().filter(|special| special.kind == kind);
    of_kind.map(|special| special.point.parameters).collect()
}

/// The curve of a reference case between two of its points, of which one parameter is prescribed at
/// the sides of the rectangle.
#[test]
fn curves_pass_through_the_points_of_the_reference() {
    for (id, which) in [("hbe", 0), ("hds", 0), ("hmc", 1)] {
        let case = curve(id);
        let family = |p: f64, q: f64| Ok(member(&case["system"], p, q));
        let points = list(&case["points"]);
        let every = points.len().div_ceil(count(3, points.len()));
        for pair in points.windows(2).step_by(every) {
            let at = |i: usize| [0, 1].map(|k| number(&pair[i][["PARAM1", "PARAM2"][k]]));
            let [from, to] = [at(0), at(1)];
            let mut ranges = [0, 1].map(|k: usize| {
                let (low, high) = (from[k].min(to[k]), from[k].max(to[k]));
                let margin = 0.3 * (high - low) + 0.02 * high;
                low - margin..high + margin
            });
            ranges[which] = from[which].min(to[which])..from[which].max(to[which]);
            let loci = hopf_locus(family, ranges).unwrap();
            let mut found = 0;
            for locus in &loci {
                for point in &locus.points {
                    let i = usize::from(point.parameters[which] == to[which]);
                    if point.parameters[which] != [from, to][i][which] {
                        continue;
                    }
                    let expected = &pair[i];
                    let other = [from, to][i][1 - which];
                    let error = point.parameters[1 - which] - other;
                    if error.abs() > 1e-3 {
                        // Another point at the same side.
                        continue;
                    }
                    found += 1;
                    assert!(close(point.parameters[1 - which], other), "{id}: {error:e}");
                    let frequency = number(&expected["omega"]);
                    assert!(
                        close(point.frequency, frequency),
                        "{id}: {}",
                        point.frequency
                    );
                    let l1 = point.first_lyapunov_coefficient;
                    if let Some(known) = expected.get("first_lyapunov_coefficient") {
                        assert!((l1 / number(known) - 1.0).abs() < 1e-10, "{id}: {l1}");
                    }
                    if let Some(cubic) = expected.get("cubic_coefficient") {
                        // A' = ω l1 A³/2, with an eigenvector of length 1.
                        let known = 2.0 * number(cubic) / frequency;
                        assert!((l1 - known).abs() < 1e-12, "{id}: {l1}, {known}");
                    }
                    let kind = match expected.get("criticality") {
                        Some(kind) => text(kind),
                        None => "degenerate",
                    };
                    assert_eq!(point.criticality().to_string(), kind, "{id}");
                }
            }
            assert_eq!(found, 2, "{id}: {from:?} {to:?} {}", loci.len());
        }
    }
}

#[test]
fn a_mass_on_a_belt_has_the_curve_in_closed_form_with_its_special_points() {
    let case = curve("hbe");
    let family = |p: f64, q: f64| Ok(member(&case["system"], p, q));
    let loci = hopf_locus(family, [0.01..1.5, 0.01..0.3]).unwrap();
    let [locus] = exactly(&loci);
    assert_eq!(locus.ends, [LocusEnd::Ranges, LocusEnd::Ranges]);
    assert!(locus.points.len() > 40);
    for point in &locus.points {
        let [v_b, damping] = point.parameters;
        let expected = 0.3 * v_b / 0.25 * (-4.0 * v_b * v_b).exp();
        assert!(close(damping, expected), "{v_b}: {:e}", damping - expected);
        assert!(close(point.frequency, 1.0));
        assert_eq!(point.largest_other, f64::NEG_INFINITY);
    }
    for (name, kind) in [
        ("bautin", SpecialKind::Bautin),
        ("fold_of_the_hopf_curve_over_PARAM2", SpecialKind::Turn(1)),
    ] {
        let mut known = list(&case["codimension_two"]).iter();
        let known = known.find(|point| text(&point["kind"]) == name);
        let found = special(locus, kind);
        assert_eq!(found.len(), 1, "{name}");
        for (which, found) in found[0].iter().enumerate() {
            let expected = number(&known.unwrap()[["PARAM1", "PARAM2"][which]]);
            let error = found - expected;
            println!("{name}: {error:.1e}");
            // Where the curve turns, its place is the zero of a tangent from differences.
            let tolerance = if which == 0 { 1e-9 } else { ACCURACY };
            assert!(error.abs() <= tolerance, "{name}: {error:e}");
        }
    }
}

/// The curve 2β = −dμ̂/ds has one maximum, at v_b = v_s/√2: it is found in rectangles of any width
/// around it, whichever parameter is the first.
#[test]
fn a_maximum_of_the_curve_is_found_in_rectangles_of_any_width() {
    let mut random = Random::new(11);
    for _ in 0..16 {
        let (fall, v_s) = (random.uniform(0.1, 0.4), random.uniform(0.2, 0.8));
        let law = Exponential::new(0.1 + fall, 0.1, v_s).unwrap();
        let slope = |v_b: f64| fall * v_b / (v_s * v_s) * (-(v_b / v_s).powi(2)).exp();
        let place = v_s / std::f64::consts::SQRT_2;
        let width = place * random.logarithmic(1e-3, 0.3);
        let low = place - width * random.uniform(0.1, 0.9);
        let velocities = low..place + width * random.uniform(0.1, 0.9);
        let depth = slope(place) - slope(velocities.start).min(slope(velocities.end));
        let top = slope(place) + depth * random.uniform(0.1, 2.0);
        let dampings = slope(place) - depth * random.uniform(1.2, 2.0)..top;
        let family = |v_b: f64, damping: f64| MassOnBelt::new(law, v_b)?.with_damping(damping);
        let one = hopf_locus(family, [velocities.clone(), dampings.clone()]).unwrap();
        let swapped = |damping: f64, v_b: f64| family(v_b, damping);
        let other = hopf_locus(swapped, [dampings, velocities]).unwrap();
        for (loci, which) in [(one, 1), (other, 0)] {
            let turns = loci
                .iter()
                .flat_map(|locus| special(locus, SpecialKind::Turn(which)));
            let turns: Vec<[f64; 2]> = turns.collect();
            assert_eq!(turns.len(), 1, "{width:e}: {turns:?}");
            let error = turns[0][1 - which] - place;
            assert!(error.abs() < 1e-6 * width, "{width:e}: {error:e}");
        }
    }
}

/// Below v_b = 0 the belt moves backward, and the derivative by v_b jumps: it is taken inside the
/// rectangle, and the curve reaches its side.
#[test]
fn a_curve_reaches_a_side_beside_a_jump_of_derivatives() {
    let law = Exponential::new(0.4, 0.25, 0.5).unwrap();
    let family = |v_b: f64, damping: f64| MassOnBelt::new(law, v_b)?.with_damping(damping);
    let loci = hopf_locus(family, [1e-9..0.9, 1e-9..0.3]).unwrap();
    let [locus] = exactly(&loci);
    assert_eq!(locus.ends, [LocusEnd::Ranges, LocusEnd::Ranges]);
}

/// A belt by itself and as a structure has the same curve.
#[test]
fn a_belt_and_its_structure_have_the_same_curve() {
    let belt = |v_b: f64, beta: f64| {
        MassOnBelt::new(Exponential::new(0.4, 0.25, 0.5)?, v_b)?.with_damping(beta)
    };
    let ranges = || [0.02..1.2, 0.005..0.2];
    let structure = |v_b: f64, beta: f64| Ok(Structure::from(&belt(v_b, beta)?));
    let [a, b] = [
        hopf_locus(belt, ranges()).unwrap(),
        hopf_locus(structure, ranges()).unwrap(),
    ];
    assert_eq!(a.len(), 1);
    assert_eq!(a, b);
}

/// Bristles on a mass with a spring: the stability limit of LuGre friction about steady sliding,
/// with the eigenvalues of `Structure::steady_sliding` on both sides.
#[test]
fn bristles_have_the_stability_limit_of_their_eigenvalues() {
    let family = |v_b: f64, damping: f64| {
        let law = LuGre::new(Exponential::new(0.4, 0.25, 0.1)?, 100.0, 0.5, 0.1)?;
        let contact = Contact::new(0, law, 1.0)?.on_belt(v_b);
        one_mass([1.0, damping, 1.0], 0.0, contact)
    };
    let loci = hopf_locus(family, [0.02..0.4, 0.0..1.5]).unwrap();
    assert!(!loci.is_empty());
    for locus in &loci {
        for point in &locus.points {
            let [v_b, damping] = point.parameters;
            let pair = |damping: f64| {
                let sliding = family(v_b, damping).unwrap().steady_sliding().unwrap();
                let values = sliding.eigenvalues.into_iter();
                let mut values = values.filter(|value| value.im > 0.0);
                values.next().unwrap()
            };
            let there = pair(damping);
            assert!(
                there.re.abs() < 1e-12 * there.norm().max(1.0),
                "{v_b}: {there}"
            );
            assert_abs_diff_eq!(there.im, point.frequency, epsilon = 1e-11);
            assert!(pair(damping + 1e-6).re < 0.0 && pair(damping - 1e-6).re > 0.0);
        }
    }
}

#[test]
fn undamped_systems_and_bad_families_are_no_trouble() {
    // Without damping all eigenvalues lie on the axis until two modes merge.
    let flutter = |mu: f64, k22: f64| {
        Structure::new(&[1.0, 1.0])?
            .with_stiffness(DMatrix::from_row_slice(2, 2, &[2.0, 1.0, 1.0, k22]))?
            .with_contact(
                Contact::new(0, Coulomb::new(mu, mu)?, 10.0)?
                    .with_load_gradient(1, 4.0 / 3.0)?
                    .on_belt(1.0),
            )
    };
    let loci = hopf_locus(flutter, [0.1..1.5, 1.5..3.0]).unwrap();
    // Where they merge is no Hopf point: the eigenvalues leave the axis with a vertical tangent.
    for point in loci.iter().flat_map(|locus| &locus.points) {
        assert!(point.frequency > 0.0);
        assert_eq!(point.criticality(), Criticality::Degenerate);
    }
    let refuses = |_: f64, _: f64| -> Result<Structure, Error> { Err(Error::NotFree) };
    let error = hopf_locus(refuses, [0.0..1.0, 0.0..1.0]).unwrap_err();
    assert!(error.to_string().contains("first parameter"), "{error}");
    for bad in [f64::NAN, f64::INFINITY] {
        for ranges in [[0.0..bad, 0.0..1.0], [0.0..1.0, bad..1.0]] {
            let error = hopf_locus(flutter, ranges).unwrap_err();
            assert!(matches!(error, Error::InvalidParameter { .. }), "{error}");
        }
    }
    // A driven system does not slide steadily.
    let driven = |p: f64, q: f64| flutter(p, q)?.with_force(0, Drive::harmonic(0.1, 1.0, 0.0)?);
    assert!(hopf_locus(driven, [0.1..1.0, 1.5..3.0]).is_err());
    // A part of the rectangle has no system.
    let case = curve("hbe");
    let half = |p: f64, q: f64| {
        if p > 0.4 {
            return Err(Error::NotFree);
        }
        Ok(member(&case["system"], p, q))
    };
    let loci = hopf_locus(half, [0.01..1.5, 0.01..0.3]).unwrap();
    assert_eq!(loci.len(), 1);
    let lost = |end: &LocusEnd| match end {
        LocusEnd::Lost { parameters, .. } => (parameters[0] - 0.4).abs() < 1e-6,
        _ => false,
    };
    assert!(loci[0].ends.iter().any(lost), "{:?}", loci[0].ends);
}

/// A law in a load that depends on place and speed: x'' + x + cx' = μφ(x, x') is an oscillator with
/// quadratic and cubic terms, whose first Lyapunov coefficient is known in closed form. Motions are
/// the witness: inside and outside the circle that averaging gives they move apart from it, or
/// towards it.
#[test]
fn a_load_law_decides_the_criticality() {
    /// φ = ay + ex² + dxy + βx²y + γy³.
    #[derive(Debug, Clone, Copy)]
    struct Terms([f64; 5]);
    impl ForceLaw for Terms {
        fn force<S: Scalar>(&self, x: S, y: S, _: usize) -> S {
            let [a, e, d, beta, gamma] = self.0;
            let square = x * x;
            y * a + square * e + x * y * d + square * y * beta + y.powi(3) * gamma
        }
    }
    const LOAD: f64 = 2.0;
    let mut random = Random::new(91);
    let [mut falling, mut rising] = [0, 0];
    for _ in 0..count(8, 60) {
        let mut draw = |low: f64, high: f64| random.uniform(low, high);
        let (mu, a) = (draw(0.3, 0.9), draw(0.1, 0.5));
        let terms = [
            a,
            draw(-1.0, 1.0),
            draw(-1.0, 1.0),
            draw(-1.0, 1.0),
            draw(-1.0, 1.0),
        ];
        let [_, e, d, beta, gamma] = terms;
        let family = |damping: f64, speed: f64| {
            let contact = Contact::new(0, Coulomb::new(mu, mu)?, LOAD)?
                .with_load_law(&[(0, 1.0)], Terms(terms))?
                .on_belt(speed);
            // Around x = 0.
            one_mass([1.0, damping, 1.0], -mu * LOAD, contact)
        };
        let loci = hopf_locus(family, [0.5 * mu * a..1.5 * mu * a, 9.0..11.0]).unwrap();
        let point = &loci[0].points[0];
        assert!(close(point.parameters[0], mu * a) && close(point.frequency, 1.0));
        let lyapunov = 0.25 * (mu * (beta + 3.0 * gamma) + mu * mu * d * e);
        let found = point.first_lyapunov_coefficient;
        assert!((found - lyapunov).abs() < 1e-12, "{found} {lyapunov}");
        if lyapunov.abs() < 0.02 {
            continue;
        }
        // A' = αA + l1 A³/2 near the point; a circle of radius 0.05.
        const AMPLITUDE: f64 = 0.05;
        let growth = -0.5 * lyapunov * AMPLITUDE * AMPLITUDE;
        let system = family(mu * a - 2.0 * growth, 10.0).unwrap();
        for part in [0.7, 1.3] {
            let start = State::new(&[part * AMPLITUDE], &[0.0]);
            let period = system.steady_sliding().unwrap().eigenvalues[0].im.abs();
            let duration = 40.0 * std::f64::consts::TAU / period;
            let last = system.simulate(start, duration).unwrap().last();
            let end = last.displacements[0].hypot(last.velocities[0]);
            let grows = (lyapunov < 0.0) == (part < 1.0);
            let log = (end / (part * AMPLITUDE)).ln();
            // Of u = (A/0.05)², u' = 2αu(1 − u).
            let (u, factor) = (part * part, (2.0 * growth * duration).exp());
            let expected = 0.5 * (factor / (1.0 - u + u * factor)).ln();
            assert_eq!(log > 0.0, grows, "{log} {expected}");
            assert!((log / expected - 1.0).abs() < 0.15, "{log} {expected}");
        }
        falling += u32::from(lyapunov < 0.0);
        rising += u32::from(lyapunov > 0.0);
    }
    assert!(falling > 1 && rising > 1, "{falling} {rising}");
}

/// Memory without influence has no part in the other eigenvalues, as in those of steady sliding.
#[test]
fn the_largest_other_eigenvalue_is_that_of_steady_sliding() {
    let law = Exponential::new(0.4, 0.25, 0.5).unwrap();
    let mass = |damping: f64| {
        Structure::new(&[1.0])?
            .with_ground_spring(0, 1.0)?
            .with_ground_damper(0, 2.0 * damping)
    };
    let clock = |belt: f64, damping: f64| {
        let law = Dwell::hyperbolic(law, 0.5, 1.0)?;
        mass(damping)?.with_contact(Contact::new(0, law, 1.0)?.on_belt(belt))
    };
    // The force of an elastic contact, which slip keeps at its limit.
    let elastic = |belt: f64, damping: f64| {
        let joint = Contact::new(0, Coulomb::new(0.1, 0.1)?, 1.0)?.on_belt(belt);
        mass(damping)?
            .with_contact(Contact::new(0, law, 1.0)?.on_belt(belt))?
            .with_contact(joint.with_tangential_stiffness(4.0)?)
    };
    // A state that carries a force.
    let lag = |belt: f64, damping: f64| {
        let lag = FirstOrder::lag(5.0)?.with_displacement(0, 1.0)?;
        mass(damping)?
            .with_contact(Contact::new(0, law, 1.0)?.on_belt(belt))?
            .with_first_order(lag.with_force(0, 0.01)?)
    };
    let families: [&dyn Fn(f64, f64) -> Result<Structure, Error>; 3] = [&clock, &elastic, &lag];
    for (number, family) in families.into_iter().enumerate() {
        let loci = hopf_locus(family, [0.05..1.1, 0.005..0.2]).unwrap();
        let [locus] = exactly(&loci);
        for point in &locus.points {
            let [belt, damping] = point.parameters;
            let sliding = family(belt, damping).unwrap().steady_sliding().unwrap();
            let others = sliding.eigenvalues.iter().filter(|value| value.im == 0.0);
            let largest = others
                .map(|value| value.re)
                .fold(f64::NEG_INFINITY, f64::max);
            let found = point.largest_other;
            assert!(
                found == largest || (found - largest).abs() < 1e-10,
                "{number}: {found} {largest}"
            );
            assert_eq!(found == f64::NEG_INFINITY, number < 2, "{number}: {found}");
        }
    }
}
