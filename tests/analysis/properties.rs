//! Properties of the closed forms over random systems.

use crate::common::on_belt;
use std::ops::Range;

use proptest::{prop_assert, prop_assert_eq};
use stick_slip::analysis::averaging::cycles;
use stick_slip::analysis::{PureSlip, StickSlip, regime};
use stick_slip::{MassOnBelt, Polynomial};

use crate::common::property::for_all;

/// What makes a system with the polynomial law for which h1, h2, h3 are of order 0.01 to 1: static
/// coefficient, fall of the law, velocity of its minimum, v_b in its units, β, γ².
pub(crate) const RANGES: [Range<f64>; 6] =
    [0.2..1.0, 0.05..1.0, 0.3..1.5, 0.2..0.98, 0.0..0.1, 0.1..2.0];

pub(crate) fn system(numbers: [f64; 6]) -> MassOnBelt<Polynomial> {
    let [
        static_coefficient,
        fall,
        minimum_velocity,
        ratio,
        damping,
        load,
    ] = numbers;
    let least = static_coefficient * (1.0 - fall);
    let law = Polynomial::new(static_coefficient, least, minimum_velocity).unwrap();
    on_belt(law, ratio * minimum_velocity, damping, load)
}

#[test]
fn transient_solves_its_equation() {
    let [a, b, c, d, e, f] = RANGES;
    for_all(
        64,
        [a, b, c, d, e, f, 0.01..1.5, 0.0..60.0],
        |[numbers @ .., start, time]| {
            let system = system(numbers);
            let formulas = PureSlip::new(&system).unwrap();
            let transient = formulas.transient(start, 0.3).unwrap();
            let at = |time: f64| transient.amplitude(time).unwrap();
            let a = at(time);
            // Five-point difference, with a step of 0.01 times that in which the amplitude changes:
            // truncation 1e-9.
            let rate = 1.0 + formulas.h1().abs() + 3.0 * formulas.h3().abs() * a * a;
            let step = 0.01 / rate;
            let across = |h: f64| at(time + h) - at(time - h);
            let slope = (8.0 * across(step) - across(2.0 * step)) / (12.0 * step);
            let expected = -0.5 * formulas.h1() * a - 0.375 * formulas.h3() * a.powi(3);
            let tolerance = 1e-7 * (1.0 + expected.abs());
            prop_assert!(
                (slope - expected).abs() <= tolerance,
                "{} {}",
                slope,
                expected
            );
            // The flow composes.
            let onward = formulas.transient(a, 0.0).unwrap().amplitude(7.0).unwrap();
            prop_assert!((onward / at(time + 7.0) - 1.0).abs() < 1e-13);
            prop_assert_eq!(transient.phase(time), 0.3 + time);
            Ok(())
        },
    );
}

#[test]
fn formulas_are_mirror_symmetric() {
    for_all(64, RANGES, |numbers| {
        let system = system(numbers);
        let mirrored = system.with_belt_velocity(-system.belt_velocity()).unwrap();
        let (here, there) = (
            PureSlip::new(&system).unwrap(),
            PureSlip::new(&mirrored).unwrap(),
        );
        prop_assert_eq!(
            (here.h1(), here.h2(), here.h3()),
            (there.h1(), -there.h2(), there.h3())
        );
        prop_assert_eq!(here.is_valid(), there.is_valid());
        prop_assert_eq!(regime(&system), regime(&mirrored));
        for (a, b) in here.fourth_order().into_iter().zip(there.fourth_order()) {
            prop_assert_eq!(
                (a.u_max, a.u_min, a.u_mean),
                (-b.u_min, -b.u_max, -b.u_mean)
            );
            prop_assert_eq!((a.v_max, a.v_min), (-b.v_min, -b.v_max));
            prop_assert_eq!((a.period, a.multiplier), (b.period, b.multiplier));
            prop_assert_eq!(a.harmonics, b.harmonics);
        }
        let (here, there) = (StickSlip::new(&system), StickSlip::new(&mirrored));
        let first = |f: Option<StickSlip>| f.map(|f| (f.amplitude(), f.period()));
        prop_assert_eq!(first(here), first(there));
        let second = |f: Option<StickSlip>| f.and_then(|f| f.second_order());
        prop_assert_eq!(second(here).is_some(), second(there).is_some());
        for (a, b) in second(here).into_iter().zip(second(there)) {
            prop_assert_eq!((a.u_max, a.u_min), (-b.u_min, -b.u_max));
            prop_assert_eq!((a.v_max, a.v_min), (-b.v_min, -b.v_max));
            prop_assert_eq!((a.stick, a.slip, a.period), (b.stick, b.slip, b.period));
        }
        prop_assert_eq!(cycles(&system).unwrap(), cycles(&mirrored).unwrap());
        Ok(())
    });
}

#[test]
fn kappa_of_the_polynomial_law() {
    for_all(64, RANGES, |numbers| {
        let system = system(numbers);
        // η(1 − (v_b/v_m)²/3) − 2β
        let formulas = PureSlip::new(&system).unwrap();
        let ratio = system.belt_velocity() / system.law().minimum_velocity();
        let expected = formulas.eta() * (1.0 - ratio * ratio / 3.0) - 2.0 * system.damping();
        match StickSlip::new(&system) {
            Some(formulas) => prop_assert!((formulas.kappa() - expected).abs() < 1e-13),
            None => prop_assert!(expected < 1e-13),
        }
        Ok(())
    });
}
