//! A law looked at before it is used: every fault is found where it lies, and the crate's own laws
//! have none.

use crate::common::polynomials::Polynomials;
use crate::common::property::for_all;
use crate::common::{count, friction_law, refused};
use approx::assert_abs_diff_eq;
use proptest::prelude::*;
use stick_slip::{
    AnyLaw, Coulomb, Error, Exponential, FrictionLaw, LawFault, MassOnBelt, Polynomial, Rational,
    State, Stribeck, Tabulated, check_law,
};

friction_law! {
    Root: 0.4,
    |s| if s.value() < 0.3 { s.constant(0.3) } else { (s - 0.3).sqrt() * -0.1 + 0.3 }
}

friction_law! { Cusp: 0.4, |s| (s - 0.5).abs().sqrt() * 0.1 + 0.2 }

friction_law! {
    NarrowDip: 0.4,
    |s| (-((s - 0.7) / 0.005).square()).exp() * -1e-3 + (s * -2.0).exp() * 0.2 + 0.1
}

friction_law! {
    NotANumber: 0.4,
    |s| if s.value() < 1.1 { s * -0.1 + 0.4 } else { (s * 0.0).ln() * 0.0 }
}

friction_law! { SteepStep: 0.4, |s| ((s - 0.4) / 1e-6).tanh() * -0.05 + 0.3 }

friction_law! {
    /// Slope ∓`half` below and above the speed 0.3.
    Kink { half }: 0.4, |s| (s - 0.3).abs() * half + 0.2
}

friction_law! {
    /// exp(−((s − at)/width)²), on a constant.
    Bump { at, width }: 0.4, |s| (-((s - at) / width).square()).exp() * 0.1 + 0.3
}

friction_law! {
    /// A bump on a law that falls: .3 + .2 exp(−s/.7) + height exp(−((s − at)/width)²).
    BumpOnFall { at, width, height }: 0.5 + height,
    |s| (s * (-1.0 / 0.7)).exp() * 0.2 + 0.3 + (-((s - at) / width).square()).exp() * height
}

friction_law! {
    /// Slope −`by` and `by` on a law that falls.
    Kinked { at, by }: 0.4 + by * at, |s| (s - at).abs() * by + (-s).exp() * 0.2 + 0.2
}

const NARROW_BUMP: Bump = Bump {
    at: 0.7,
    width: 0.01,
};

/// Σ c_k s^k, with μ_s = 0.4 as all laws here.
fn polynomial(coefficients: &[f64]) -> Polynomials {
    Polynomials::new(0.4, coefficients)
}

fn jump() -> Polynomials {
    polynomial(&[0.4, -0.1]).then(0.3, &[0.27, -0.1])
}

/// Where the range is halved again and again.
fn jump_in_the_middle() -> Polynomials {
    polynomial(&[0.4]).then(1.0, &[0.3])
}

fn falls_below_zero() -> Polynomials {
    polynomial(&[0.4, -0.3])
}

/// The faults of a law over speeds up to 2.
fn faults(law: &impl FrictionLaw) -> Vec<LawFault> {
    check_law(law, 0.0..2.0).unwrap()
}

#[test]
fn jumps_are_found_to_the_last_bits() {
    let [
        LawFault::Jump {
            speed,
            below,
            above,
        },
    ] = faults(&jump())[..]
    else {
        panic!("{:?}", faults(&jump()))
    };
    assert_abs_diff_eq!(speed, 0.3, epsilon = 1e-15);
    assert!((below - 0.37).abs() < 1e-14 && (above - 0.27).abs() < 1e-14);
    let [LawFault::Jump { speed, .. }] = faults(&jump_in_the_middle())[..] else {
        panic!()
    };
    assert_eq!(speed, 1.0);
    let pulse = polynomial(&[0.3]).then(0.7, &[0.31]).then(0.72, &[0.3]);
    let [
        LawFault::Jump { speed: up, .. },
        LawFault::Jump { speed: down, .. },
    ] = faults(&pulse)[..]
    else {
        panic!("{:?}", faults(&pulse))
    };
    assert!((up - 0.7).abs() < 1e-15 && (down - 0.72).abs() < 1e-15);
}

/// What the check is for: `simulate` follows a law that jumps.
#[test]
fn a_law_with_a_jump_can_be_simulated_all_the_same() {
    let system = MassOnBelt::new(jump_in_the_middle(), 0.2).unwrap();
    assert!(system.simulate(State::new(0.0, 0.0), 10.0).is_ok());
}

#[test]
fn kinks_are_told_from_jumps_of_higher_derivatives() {
    for half in [0.1, 1e-4] {
        let found = faults(&Kink { half });
        let [
            LawFault::Kink {
                speed,
                slope_below,
                slope_above,
            },
        ] = found[..]
        else {
            panic!("{found:?}")
        };
        assert!((speed - 0.3).abs() < 1e-8, "{speed}");
        assert!((slope_below + half).abs() < 1e-12 && (slope_above - half).abs() < 1e-12);
    }
    let curvature = polynomial(&[0.3]).then(0.3, &[0.3, 0.0, 0.2]);
    let third = polynomial(&[0.3]).then(0.3, &[0.3, 0.0, 0.0, 0.2]);
    for (found, near) in [
        (faults(&curvature), 1e-5),
        (faults(&third), 1e-3),
        (faults(&Root), 1e-9),
        (faults(&Cusp), 1e-8),
    ] {
        let [LawFault::NotAnalytic { speed }] = found[..] else {
            panic!("{found:?}")
        };
        let there = if (speed - 0.5).abs() < 0.1 { 0.5 } else { 0.3 };
        assert!((speed - there).abs() < near, "{speed}");
    }
}

#[test]
fn nan_and_negative_values_are_found() {
    let [LawFault::NotFinite { speed, value }] = faults(&NotANumber)[..] else {
        panic!("{:?}", faults(&NotANumber))
    };
    assert!((speed - 1.1).abs() < 1e-15 && value.is_nan());

    let [LawFault::Negative { from, to }] = faults(&falls_below_zero())[..] else {
        panic!()
    };
    assert!((from - 4.0 / 3.0).abs() < 1e-15 && to == 2.0);
    let below_for_a_while = Polynomials::about(1.0, 0.4, &[-0.1, 0.0, 0.4]);
    let [LawFault::Negative { from, to }] = faults(&below_for_a_while)[..] else {
        panic!()
    };
    assert!((from - 0.5).abs() < 1e-14 && (to - 1.5).abs() < 1e-14);
    // From the start of the range on.
    let found = check_law(&falls_below_zero(), 1.5..2.0).unwrap();
    assert_eq!(found, [LawFault::Negative { from: 1.5, to: 2.0 }]);
    let touches_zero = Polynomials::about(1.0, 0.4, &[0.0, 0.0, 0.4]);
    assert_eq!(faults(&touches_zero), []);
}

#[test]
fn narrow_features_are_found_and_others_are_not_called_narrow() {
    // Half the height of exp(−(s/w)²) at ±w√ln 2.
    let width = |w: f64| 2.0 * w * 2.0_f64.ln().sqrt();
    for (found, w) in [(faults(&NARROW_BUMP), 0.01), (faults(&NarrowDip), 0.005)] {
        let [LawFault::Narrow { speed, width: is }] = found[..] else {
            panic!("{found:?}")
        };
        assert_abs_diff_eq!(speed, 0.7, epsilon = 1e-3);
        assert!((is - width(w)).abs() < 2e-3, "{is}");
    }
    let wide = Bump {
        at: 0.7,
        width: 0.05,
    };
    assert_eq!(faults(&wide), []);
    // What is narrow at rest is seen by every slip phase, which begins there.
    let at_rest = Bump {
        at: 0.0,
        width: 1e-3,
    };
    assert_eq!(faults(&at_rest), []);
    assert_eq!(faults(&SteepStep), []);
    // For slower motions the same bump is wide.
    assert_eq!(check_law(&NARROW_BUMP, 0.6..0.8).unwrap(), []);
}

/// Wherever it lies, also just above a place where a series begins that shows it.
#[test]
fn a_narrow_bump_is_found_wherever_it_lies() {
    let above_the_middle = [
        (1.1134908661127623, 0.015223865377099027, 0.138),
        (1.0865681123015738, 0.00743, 0.0246),
    ];
    let one = |at: f64, width: f64, height: f64| {
        let found = faults(&BumpOnFall { at, width, height });
        let [LawFault::Narrow { speed, width: is }] = found[..] else {
            return Err(TestCaseError::fail(format!(
                "{at} {width} {height}: {found:?}"
            )));
        };
        prop_assert!(
            (speed - at).abs() < 5e-4 + 0.2 * width,
            "{} is not {}",
            speed,
            at
        );
        let half = 2.0 * width * 2.0_f64.ln().sqrt();
        prop_assert!((is - half).abs() < 2e-3, "{} is not {}", is, half);
        Ok(())
    };
    for (at, width, height) in above_the_middle {
        one(at, width, height).unwrap();
    }
    let ranges = [0.0..1.0, -3.0..-1.65, -4.0..-0.5];
    for_all(count(128, 1024), ranges, |[place, width, height]| {
        let width = 10.0_f64.powf(width);
        // Between the ends, where it shows at none.
        let at = 7.0 * width + place * (2.0 - 14.0 * width);
        one(at, width, 10.0_f64.powf(height))
    });
    // And none that is wide enough is called narrow.
    for_all(
        count(64, 256),
        [0.0..2.0, -1.3..0.0, -4.0..-0.5],
        |[at, width, height]| {
            let (width, height) = (10.0_f64.powf(width), 10.0_f64.powf(height));
            prop_assert_eq!(faults(&BumpOnFall { at, width, height }), []);
            Ok(())
        },
    );
}

#[test]
fn faults_say_what_to_do() {
    for (found, remedy) in [
        (faults(&jump()), "ramp"),
        (faults(&Kink { half: 0.1 }), "`breakpoints`"),
        (faults(&Root), "`kinetic_on`"),
        (faults(&NotANumber), "NaN from speed 1.1"),
        (faults(&falls_below_zero()), "drive"),
        (faults(&NARROW_BUMP), "`breakpoints`"),
    ] {
        let text = found[0].to_string();
        assert!(text.contains(remedy), "{text}");
    }
}

#[test]
fn a_law_that_no_system_takes_is_refused() {
    refused!(check_law(&polynomial(&[0.5]), 0.0..1.0) => Error::StaticBelowKinetic { .. });
}

/// Every law of the crate, of any size: static coefficient and a part of it, exponent of ten of a
/// speed, which law, and four points for a table.
fn law_of_the_crate([high, part, exponent, which, points @ ..]: [f64; 8]) -> AnyLaw {
    let low = part * high;
    let speed = 10.0_f64.powf(exponent);
    match which as u32 {
        0 => Coulomb::new(high, low).unwrap().into(),
        1 => Exponential::new(high, low, speed).unwrap().into(),
        2 => Stribeck::new(high, low, speed, 1).unwrap().into(),
        3 => Rational::new(high, 1.0 / speed).unwrap().into(),
        4 => Tabulated::new((0..).map(|i| f64::from(i) * speed).zip(points))
            .unwrap()
            .into(),
        _ => Polynomial::new(high, low, speed).unwrap().into(),
    }
}

#[test]
fn the_laws_of_the_crate_have_no_faults() {
    let ranges = [
        0.01..2.0,
        0.0..1.0,
        -4.0..2.0,
        0.0..6.0,
        0.0..1.0,
        0.0..1.0,
        0.0..1.0,
        0.0..1.0,
        0.01..10.0,
    ];
    for_all(count(64, 256), ranges, |[numbers @ .., end]| {
        let law = law_of_the_crate(numbers);
        let mut found = check_law(&law, 0.0..end).unwrap();
        // A table that dips within a narrow part of the range, or falls from rest.
        if matches!(law, AnyLaw::Polynomial(_)) {
            // It rises for ever above its minimum, and never falls below.
            prop_assert_eq!(&found[..], &[], "{:?} {}", law, end);
        }
        found.retain(|fault| !matches!(fault, LawFault::Narrow { .. }));
        prop_assert_eq!(&found[..], &[], "{:?} {}", law, end);
        Ok(())
    });
}

#[test]
fn a_range_may_end_at_the_largest_speed() {
    let law = Coulomb::new(0.4, 0.3).unwrap();
    assert_eq!(check_law(&law, 0.0..1e10).unwrap(), []);
    for end in [1.1e10, f64::MAX] {
        assert!(check_law(&law, 0.0..end).is_err());
    }
}

/// A kink of any size at any place is found there, and nothing else is.
#[test]
fn a_kink_is_found_wherever_it_lies() {
    for_all(count(64, 256), [0.01..1.99, -3.0..1.0], |[at, exponent]| {
        let by = 10.0_f64.powf(exponent);
        let found = faults(&Kinked { at, by });
        let [
            LawFault::Kink {
                speed,
                slope_below,
                slope_above,
            },
        ] = found[..]
        else {
            return Err(TestCaseError::fail(format!("{at} {by}: {found:?}")));
        };
        prop_assert!((speed - at).abs() < 1e-8, "{} is not {}", speed, at);
        prop_assert!((slope_above - slope_below - 2.0 * by).abs() < 1e-7 * (1.0 + by));
        Ok(())
    });
}
