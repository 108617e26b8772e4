use std::cell::Cell;

use super::super::system::MassOnBelt;
use super::*;
use crate::clock::Time;
use crate::friction::slip_series::{Expander, Expansion, Known, SlipPoint};
use crate::friction::{FrictionLaw, Polynomial as Cubic};
use crate::scalar::Scalar;
use crate::series::{PowerSeries, quarters};
use crate::state::Direction;

/// Friction 0.25, and 0.1 more within about `width` of one speed.
#[derive(Clone, Copy)]
struct Bump {
    at: f64,
    width: f64,
}

impl FrictionLaw for Bump {
    fn static_coefficient(&self) -> f64 {
        1.0
    }
    fn kinetic<S: Scalar>(&self, speed: S) -> S {
        (-((speed - self.at) / self.width).square()).exp() * 0.1 + 0.25
    }
}

/// Friction that is NaN above a speed.
struct Ends(f64);

impl FrictionLaw for Ends {
    fn static_coefficient(&self) -> f64 {
        1.0
    }
    fn kinetic<S: Scalar>(&self, speed: S) -> S {
        if speed.value() > self.0 {
            speed.constant(f64::NAN)
        } else {
            speed.constant(0.25)
        }
    }
}

/// Friction 0.25, by a law that counts its evaluations.
#[derive(Default)]
struct Counted(Cell<usize>);

impl FrictionLaw for Counted {
    fn static_coefficient(&self) -> f64 {
        1.0
    }
    fn kinetic<S: Scalar>(&self, speed: S) -> S {
        self.0.set(self.0.get() + 1);
        speed.constant(0.25)
    }
}

const LOAD: f64 = 2.0;

fn on_belt<L: FrictionLaw>(law: L) -> MassOnBelt<L> {
    MassOnBelt::new(law, 0.2)
        .and_then(|system| system.with_load(LOAD))
        .unwrap()
}

/// A motion of sliding speed Σ c_k t^k with the friction 0.25 + `slope`·t.
fn series(c: &[f64], slope: f64) -> SlipSeries {
    SlipSeries {
        speed: PowerSeries::from(c),
        friction: PowerSeries::from(&[0.25, slope]),
        decay: 0.0,
        slope: 0.0,
    }
}

/// (t − at)²(1 + a t + b t²) + least.
fn valley(at: f64, a: f64, b: f64, least: f64) -> [f64; 5] {
    let square = [at * at, -2.0 * at, 1.0];
    let mut c = [0.0; 5];
    for (i, x) in square.iter().enumerate() {
        for (j, y) in [1.0, a, b].iter().enumerate() {
            c[i + j] += x * y;
        }
    }
    c[0] += least;
    c
}

/// Factors a and b of a [`valley`].
const SHAPES: [(f64, f64); 5] = [
    (0.0, 0.0),
    (0.4, 0.0),
    (-0.2, 0.0),
    (0.3, -0.1),
    (-0.1, 0.2),
];

fn defect<L: FrictionLaw>(
    system: &MassOnBelt<L>,
    series: &SlipSeries,
    times: [f64; 4],
    speeds: [f64; 4],
) -> f64 {
    let friction = series.friction.at_four(times);
    system.belt().defect(0, friction, speeds)
}

/// The defect found near the least sliding speed.
fn closest(law: Bump, c: &[f64], h: f64) -> f64 {
    let series = series(c, 0.0);
    let speeds = series.speed.at_four(quarters(h));
    series.defect_at_minimum(&on_belt(law).belt(), 0, h, speeds)
}

#[test]
fn terms_of_the_equation_of_motion_are_added_by_size() {
    let law = Cubic::new(0.4, 0.25, 0.5).unwrap();
    let system = on_belt(&law).with_damping(0.3).unwrap();
    let from = SlipPoint {
        direction: Direction::Lagging,
        displacement: -0.7,
        speed: 1.0,
        rate: None,
    };
    let (system, time) = (system.belt(), Time::Forward);
    let mut expander = Expander::new();
    let expansion = Expansion {
        expander: &mut expander,
        piece: 0,
        equation: &system.equation(from.direction),
        from: &from,
        time,
        known: Known::Nothing,
    };
    system.law().expand_slip(expansion).unwrap();
    let series = expander.series;
    // μ̂(1) = 0.4 − 0.45 + 0.6 = 0.55 and v = 0.2 − 1.
    let largest = series.largest_term(&system, State::new(-0.7, -0.8));
    assert!((largest - (0.7 + 2.0 * 0.3 * 0.8 + LOAD * 0.55)).abs() < 1e-15);
}

#[test]
fn the_defect_is_the_largest_of_four() {
    let flat = Bump {
        at: 0.0,
        width: 1e-6,
    };
    let system = on_belt(flat);
    for sign in [1.0, -1.0] {
        let series = series(&[1.0], sign * 0.01);
        for times in [
            [1.0, 2.0, 3.0, 4.0],
            [4.0, 3.0, 2.0, 1.0],
            [1.0, 4.0, 2.0, 3.0],
        ] {
            let defect = defect(&system, &series, times, [1.0; 4]);
            assert!((defect - LOAD * 0.04).abs() < 1e-15, "{times:?}: {defect}");
        }
        // Speeds below zero are those of contact, within rounding.
        assert!(defect(&system, &series, [0.0; 4], [-1e-20; 4]) > 0.19);
    }
}

#[test]
fn no_number_is_larger_than_any_defect() {
    let system = on_belt(Ends(1.0));
    let series = series(&[1.0], 0.01);
    for bad in 0..4 {
        let mut speeds = [0.5; 4];
        speeds[bad] = 1.5;
        let defect = defect(&system, &series, [1.0, 2.0, 3.0, 4.0], speeds);
        assert!(defect.is_nan(), "{bad}: {defect}");
    }
}

/// Every place of the minimum in a step, with every shape around it.
#[test]
fn features_at_the_least_speed_are_seen() {
    for h in [0.3, 1.0, 2.0] {
        for part in [0.01, 0.1, 0.2, 0.3, 0.45, 0.6, 0.7, 0.8, 0.9, 0.95, 0.99] {
            for (a, b) in SHAPES {
                let c = valley(part * h, a, b, 0.01);
                // Only the lowest 10⁻⁵ of the way to the next place that is looked at.
                let width = 1e-2 * (0.02 * h).powi(2);
                let law = Bump { at: 0.01, width };
                let seen = closest(law, &c, h) / LOAD;
                assert!(
                    (0.0999..=0.2001).contains(&seen),
                    "{h} {part} {a} {b}: {seen}"
                );
            }
        }
    }
}

/// The law is also evaluated on both sides of the minimum, but not beyond the step.
#[test]
fn features_beside_the_least_speed_are_seen() {
    let speed_at = |c: &[f64], t: f64| PowerSeries::from(c).at(t);
    for h in [0.5, 1.0] {
        let c = valley(0.45 * h, 0.2, 0.0, 0.01);
        for part in [-0.05, 0.02, 0.1] {
            let at = speed_at(&c, (0.45 + part) * h);
            let law = Bump { at, width: 1e-5 };
            let seen = closest(law, &c, h) / LOAD;
            assert!((seen - 0.1).abs() < 1e-4, "{h} {part}: {seen}");
        }
        for (middle, end) in [(0.03, 0.0), (0.95, 1.0)] {
            let c = valley(middle * h, 0.2, 0.0, 0.01);
            let law = Bump {
                at: speed_at(&c, end * h),
                width: 1e-7,
            };
            let seen = closest(law, &c, h) / LOAD;
            assert!((seen - 0.1).abs() < 1e-4, "{h} {middle}: {seen}");
        }
    }
}

/// The slope at the end of a step decides whether the last interval holds a minimum: exact to the
/// fourth degree.
#[test]
fn minima_outside_the_step_are_not_looked_for() {
    let wide = Bump {
        at: 0.01,
        width: 10.0,
    };
    for h in [0.5, 1.0] {
        for (a, b) in SHAPES {
            for hair in [1e-2, 1e-6] {
                assert!(closest(wide, &valley(h * (1.0 - hair), a, b, 0.01), h) > 0.0);
                assert_eq!(closest(wide, &valley(h * (1.0 + hair), a, b, 0.01), h), 0.0);
                assert!(closest(wide, &valley(h * hair, a, b, 0.01), h) > 0.0);
                assert_eq!(closest(wide, &valley(-h * hair, a, b, 0.01), h), 0.0);
            }
        }
        // A maximum is none.
        let hill = valley(0.5 * h, 0.0, 0.0, 0.01).map(|c| -c);
        assert_eq!(closest(wide, &hill, h), 0.0);
    }
}

/// Both of two minima in one step count.
#[test]
fn every_minimum_of_a_step_is_looked_at() {
    // (t − 0.2)²(t − 0.8)² + 0.01 t + 0.02: the first minimum is the lower one.
    let c = [0.0256 + 0.02, -0.32 + 0.01, 1.32, -2.0, 1.0];
    let [first, second] = [0.2, 0.8].map(|near: f64| {
        let (mut t, slope) = (near, PowerSeries::from(&c).derivative());
        let curvature = slope.derivative();
        for _ in 0..10 {
            t -= slope.at(t) / curvature.at(t);
        }
        PowerSeries::from(&c).at(t)
    });
    for at in [first, second] {
        let seen = closest(Bump { at, width: 1e-6 }, &c, 1.0) / LOAD;
        assert!((seen - 0.1).abs() < 1e-4, "{at}: {seen}");
    }
}

/// Four points for each radian, but not more than 64: a step on a slow manifold may be 10²⁰ radians
/// long.
#[test]
fn a_long_step_is_looked_at_in_so_many_places() {
    let system = on_belt(Counted::default());
    for (h, places) in [(1.5, 8), (3.0, 12), (16.0, 64), (17.0, 64), (1e20, 64)] {
        system.law().0.set(0);
        assert_eq!(
            series(&[1.0], 0.0).defect_in_between(&system.belt(), 0, h),
            0.0
        );
        assert_eq!(system.law().0.get(), places, "{h}");
    }
}
