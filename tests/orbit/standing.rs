//! Steady sliding in which joints stick, over a range: reported, with the exact ends of its
//! stability.

use stick_slip::orbit::{
    AttractorKind, Border, VibrationRange, VibrationRanges, classify, vibration_ranges,
};
use stick_slip::structure::State;
use stick_slip::{Contact, Coulomb, Error, Exponential, Structure};

/// Two masses with a friction joint between them, mass 0 on a belt.
fn joined(stiffness: Option<f64>) -> impl Fn(f64) -> Result<Structure, Error> {
    move |velocity| {
        let belt = Contact::new(0, Exponential::new(0.5, 0.25, 0.3)?, 1.0)?.on_belt(velocity);
        let joint = Contact::between(0, 1, Coulomb::new(0.15, 0.15)?, 1.0)?;
        let joint = match stiffness {
            Some(stiffness) => joint.with_tangential_stiffness(stiffness)?,
            None => joint,
        };
        Structure::new(&[1.0, 0.7])?
            .with_ground_spring(0, 1.0)?
            .with_spring(0, 1, 1.5)?
            .with_ground_damper(1, 0.07)?
            .with_contact(belt)?
            .with_contact(joint)
    }
}

/// −dμ̂/ds of the law of the belt: 0.25 + 0.25 e^{−(s/0.3)²}.
fn fall(speed: f64) -> f64 {
    0.25 * 2.0 * speed / 0.09 * (-(speed / 0.3).powi(2)).exp()
}

/// The least speed above which a condition holds, by bisection.
fn bisect(holds: impl Fn(f64) -> bool) -> f64 {
    let (mut low, mut high) = (0.3, 1.2);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if holds(middle) {
            high = middle;
        } else {
            low = middle;
        }
    }
    high
}

/// Steady sliding is an attractor at and only at speeds above a Hopf point, and the sweep found it.
#[track_caller]
fn slides_from(found: &VibrationRanges<State>, hopf: f64) {
    let mut border = None;
    for range in &found.ranges {
        let slides = range.attractors.contains(&AttractorKind::SteadySliding);
        // Bisection, and eigenvalues of a matrix of four rows.
        assert_eq!(slides, range.parameters.start > hopf - 1e-9, "{range:?}");
        if slides && border.is_none() {
            border = Some((range.parameters.start, range.borders[0]));
        }
    }
    let (start, kind) = border.unwrap();
    assert!((start - hopf).abs() < 1e-12, "{start} {hopf}");
    assert_eq!(kind, Border::Hopf);
    let vibrates = |range: &&VibrationRange| {
        range.parameters.start > hopf && range.attractors != [AttractorKind::SteadySliding]
    };
    assert!(found.ranges.iter().filter(vibrates).count() > 2);
}

/// With the slider stuck the joint is a spring: the quartic of two masses is stable by Hurwitz's
/// conditions from a speed on, and motions from rest stop there.
#[test]
fn an_elastic_joint_that_sticks_is_a_spring() {
    let family = joined(Some(0.7));
    let (k, c) = (1.5 + 0.7, 0.07);
    let is_stable = |speed: f64| {
        let (m, slope) = ([1.0, 0.7], -fall(speed));
        // (m0 s² + slope s + 1 + k)(m1 s² + c s + k) − k²
        let a = [
            m[0] * m[1],
            m[0] * c + m[1] * slope,
            m[0] * k + slope * c + m[1] * (1.0 + k),
            slope * k + c * (1.0 + k),
            k,
        ];
        a[1] > 0.0 && a[3] > 0.0 && a[1] * a[2] * a[3] > a[0] * a[3] * a[3] + a[1] * a[1] * a[4]
    };
    for speed in [0.6, 0.75, 0.85] {
        assert!(is_stable(speed));
        let reached = classify(&family(speed).unwrap(), &State::at_rest(2)).unwrap();
        assert_eq!(reached.kind(), AttractorKind::SteadySliding, "{speed}");
    }
    let found = vibration_ranges(&family, 0.3..1.2).unwrap();
    slides_from(&found, bisect(is_stable));
}

/// With a rigid joint that sticks the masses are one: stable where the damper exceeds the slope.
#[test]
fn a_rigid_joint_that_sticks_makes_the_masses_one() {
    let found = vibration_ranges(joined(None), 0.3..1.2).unwrap();
    slides_from(&found, bisect(|speed| fall(speed) < 0.07));
}
