use super::*;
use crate::friction::{Exponential, Polynomial, Rational, Stribeck};
use crate::scalar::Scalar;
use crate::state::Direction;

/// An expander that holds another series.
fn used() -> Expander {
    let mut expander = Expander::new();
    expander.series.speed = PowerSeries::from_fn(|k| k as f64);
    expander.series.friction = PowerSeries::from_fn(|k| -(k as f64));
    expander
}

/// Calls `look` with expansions of many motions on one law: at once, unrolled outside of the
/// dispatch, and by jets.
fn every_way<L: FrictionLaw>(law: &L, look: impl Fn([SlipSeries; 3])) {
    let slow = PowerSeries::from_fn(|k| 0.4 * 0.3_f64.powi(k as i32));
    let points = [
        (Direction::Lagging, 0.3, 0.0, Some(0.1)),
        (Direction::Lagging, -0.7, 1.0, None),
        (Direction::Leading, 0.9, 0.2, None),
    ];
    for (direction, displacement, speed, rate) in points {
        let from = SlipPoint {
            direction,
            displacement,
            speed,
            rate,
        };
        for (time, known) in [
            (Time::Forward, Known::Nothing),
            (Time::Backward, Known::Nothing),
            (Time::Forward, Known::Speed(&slow)),
            (Time::Forward, Known::Force(&slow)),
        ] {
            let equation = Equation {
                stiffness: 1.25,
                damping: 0.1,
                load: 1.0,
                belt: 0.2 * direction.sign(),
                pull: 0.0,
                drift: 0.125,
            };
            let piece = Piece { law, index: 0 };
            let [mut dispatched, mut unrolled, mut jets] = [used(), used(), used()];
            let expansion = Expansion {
                expander: &mut dispatched,
                piece: 0,
                equation: &equation,
                from: &from,
                time,
                known,
            };
            law.give_to(expansion).unwrap();
            unrolled
                .expand_by::<_, true>(piece, &equation, &from, time, known)
                .unwrap();
            jets.expand_by::<_, false>(piece, &equation, &from, time, known)
                .unwrap();
            look([dispatched, unrolled, jets].map(|expander| expander.series));
        }
    }
}

fn on_every_law(look: impl Fn([SlipSeries; 3])) {
    every_way(&Polynomial::new(0.4, 0.25, 0.5).unwrap(), &look);
    every_way(&Exponential::new(0.4, 0.25, 0.3).unwrap(), &look);
    every_way(&Rational::new(0.4, 2.0).unwrap(), &look);
}

fn bits(series: &SlipSeries) -> Vec<u64> {
    let SlipSeries {
        speed,
        friction,
        decay,
        slope,
    } = series;
    let coefficients = speed.coefficients().iter().chain(friction.coefficients());
    coefficients
        .chain([decay, slope])
        .map(|c| c.to_bits())
        .collect()
}

#[test]
fn the_bits_of_a_series_do_not_depend_on_how_its_code_was_compiled() {
    // A processor without the instruction takes the other way.
    let is_unrolled = fused::compute(&(), &mut (), |(), ()| true, |(), ()| false);
    on_every_law(|[dispatched, unrolled, jets]| {
        let expected = if is_unrolled { unrolled } else { jets };
        assert_eq!(bits(&dispatched), bits(&expected));
    });
}

/// Usual exponents of the Stribeck law are unrolled, each in code of its own; others are not.
#[test]
fn exponents_of_the_stribeck_law_give_the_series_of_jets() {
    let equation = Equation {
        stiffness: 1.25,
        damping: 0.1,
        load: 1.0,
        belt: -0.2,
        pull: 0.0,
        drift: 0.0,
    };
    for exponent in 1..=6 {
        let law = Stribeck::new(0.4, 0.25, 0.3, exponent).unwrap();
        let law = law.with_viscous_coefficient(0.02).unwrap();
        for speed in [0.0, 0.2, 1.0, 5.0] {
            let from = SlipPoint {
                direction: Direction::Lagging,
                displacement: 0.3,
                speed,
                rate: None,
            };
            let [mut given, mut jets] = [used(), used()];
            let (time, known) = (Time::Forward, Known::Nothing);
            law.give_to(Expansion {
                expander: &mut given,
                piece: 0,
                equation: &equation,
                from: &from,
                time,
                known,
            })
            .unwrap();
            let piece = Piece {
                law: &law,
                index: 0,
            };
            jets.expand_by::<_, false>(piece, &equation, &from, time, known)
                .unwrap();
            let [given, jets] = [given, jets].map(|expander| expander.series);
            if exponent > 4 {
                assert_eq!(bits(&given), bits(&jets));
            }
            let mut size = 0.0_f64;
            for (k, c) in jets.speed.coefficients().iter().enumerate().take(TERMS - 1) {
                size = (2.0 * size).max(c.abs());
                let apart = (c - given.speed[k]).abs();
                assert!(apart <= 1e-13 * size, "{exponent}, {speed}, {k}: {apart:e}");
            }
        }
    }
}

#[test]
fn both_ways_give_the_same_series_up_to_roundings() {
    on_every_law(|[_, unrolled, jets]| {
        assert!((unrolled.decay - jets.decay).abs() <= 1e-15 * unrolled.decay.abs());
        let pairs = [
            (unrolled.speed, jets.speed),
            (unrolled.friction, jets.friction),
        ];
        for (unrolled, jets) in pairs {
            // Terms of lower orders may be larger, and cancel.
            let mut size = 0.0_f64;
            for (k, c) in unrolled.coefficients().iter().enumerate().take(TERMS - 1) {
                size = (2.0 * size).max(c.abs());
                assert!((c - jets[k]).abs() <= 1e-14 * size, "{k}: {c} {}", jets[k]);
            }
        }
    });
}

#[test]
fn both_ways_refuse_a_law_that_gives_no_number() {
    /// A kink at 0.5 and a pole at 2.
    #[derive(Debug)]
    struct Broken;
    impl FrictionLaw for Broken {
        fn static_coefficient(&self) -> f64 {
            1.0
        }
        fn kinetic<S: Scalar>(&self, speed: S) -> S {
            (speed - 0.5).square().sqrt() * 0.1 + (speed - 2.0).square().recip() * 0.1
        }
    }
    let (law, index) = (&Broken, 0);
    let piece = Piece { law, index };
    let equation = Equation {
        stiffness: 1.0,
        damping: 0.0,
        load: 1.0,
        belt: 1.0,
        pull: 0.0,
        drift: 0.0,
    };
    for (speed, is_number) in [(0.5, true), (2.0, false)] {
        let from = SlipPoint {
            direction: Direction::Lagging,
            displacement: 0.0,
            speed,
            rate: None,
        };
        let mut expander = Expander::new();
        let time = Time::Forward;
        for error in [
            expander.expand_by::<_, true>(piece, &equation, &from, time, Known::Nothing),
            expander.expand_by::<_, false>(piece, &equation, &from, time, Known::Nothing),
        ] {
            match error.unwrap_err() {
                Error::NotAnalytic { .. } => assert!(is_number),
                Error::NonFiniteFriction { .. } => assert!(!is_number),
                other => panic!("{other}"),
            }
        }
    }
}
