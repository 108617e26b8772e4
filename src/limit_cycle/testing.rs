//! Shared by the tests of this module: systems with closed forms. If the kinetic coefficient is c +
//! d·s, slip is a damped oscillation, and a circle without damping.

use std::f64::consts::TAU;

use super::arc::Tracer;
use super::release::{Release, ReleaseFate};
use crate::belt::{Forward, MassOnBelt};
use crate::error::Error;
use crate::friction::FrictionLaw;
use crate::numerics::roots_with_slopes::Sample;
use crate::scalar::Scalar;

/// Calls a function with a tracer of the system, and returns its result.
pub(super) fn traced<L: FrictionLaw, T>(
    system: &MassOnBelt<L>,
    f: impl FnOnce(&mut Tracer<'_>) -> Result<T, Error>,
) -> T {
    let forward = Forward::of(system.belt()).unwrap();
    f(&mut Tracer::new(forward)).unwrap()
}

#[track_caller]
pub(super) fn assert_close(found: f64, expected: f64, error: f64) {
    assert!(
        (found - expected).abs() <= error,
        "{found} {expected} ± {error}"
    );
}

/// Fate of the motion from the release point.
pub(super) fn fate(tracer: &mut Tracer<'_>) -> Result<ReleaseFate, Error> {
    Release::follow(tracer)?.fate(tracer)
}

/// The law μ̂(s) = c0 + c1 s + c3 s³, and a straight line from a knee on.
#[derive(Debug, Clone, Copy)]
pub(super) struct Law {
    pub(super) rest: f64,
    pub(super) c: [f64; 3],
    pub(super) knee: Option<(f64, f64)>,
}

impl FrictionLaw for Law {
    fn static_coefficient(&self) -> f64 {
        self.rest
    }
    fn kinetic<S: Scalar>(&self, s: S) -> S {
        let above = self.knee.is_some_and(|(knee, _)| s.value() >= knee);
        self.kinetic_on(usize::from(above), s)
    }
    fn breakpoints(&self) -> impl Iterator<Item = f64> {
        self.knee.map(|(knee, _)| knee).into_iter()
    }
    fn kinetic_on<S: Scalar>(&self, piece: usize, s: S) -> S {
        let [c0, c1, c3] = self.c;
        match self.knee {
            Some((knee, slope)) if piece == 1 => {
                (s - knee) * slope + (c0 + c1 * knee + c3 * knee.powi(3))
            }
            _ => (s.square() * c3 + c1) * s + c0,
        }
    }
}

pub(super) type System = MassOnBelt<Law>;

pub(super) fn system(rest: f64, c: [f64; 3], v_b: f64, damping: f64) -> System {
    let knee = None;
    MassOnBelt::unchecked(Law { rest, c, knee }, v_b)
        .and_then(|system| system.with_damping(damping))
        .unwrap()
}

/// A system with a constant kinetic coefficient and no damping: slip runs on circles.
pub(super) fn circles(rest: f64, kinetic: f64, v_b: f64) -> System {
    system(rest, [kinetic, 0.0, 0.0], v_b, 0.0)
}

/// A system whose slip has the damping ratio `damping`, which may be negative.
pub(super) fn spiral(damping: f64, v_b: f64) -> System {
    system(0.4, [0.4, 2.0 * damping, 0.0], v_b, 0.0)
}

pub(super) fn with_knee(mut law: Law, knee: f64, slope: f64, v_b: f64) -> System {
    law.knee = Some((knee, slope));
    MassOnBelt::unchecked(law, v_b).unwrap()
}

/// A system with the parameters of most examples of the crate: friction falls up to the speed ½ and
/// rises beyond.
pub(super) fn paper(v_b: f64) -> System {
    system(0.4, [0.4, -0.45, 0.6], v_b, 0.05)
}

/// A system that overshoots, and crosses, at large belt velocities.
pub(super) fn fast(v_b: f64, damping: f64, load: f64) -> System {
    let (k1, k3) = (1.5 * 0.16 / 0.55, 0.5 * 0.16 / 0.55_f64.powi(3));
    system(0.38, [0.38, -k1, k3], v_b, damping)
        .with_load(load)
        .unwrap()
}

/// A system with an unstable cycle of about this peak round a stable equilibrium.
pub(super) fn repelling(peak: f64, cubic: f64) -> System {
    let v_b = 0.5;
    // The slope −3·cubic·v_b² of the cubic term is made up for, and 0.75·cubic·V² added as linear
    // damping.
    let slope = cubic * (3.0 * v_b * v_b + 0.75 * peak * peak);
    system(0.6, [0.6, slope, -cubic], v_b, 0.0)
}

/// Returns a system measured in another unit of length.
pub(super) fn rescaled(system: &System, unit: f64) -> System {
    let law = *system.law();
    let [c0, c1, c3] = law.c;
    let law = Law {
        c: [c0, c1 / unit, c3 / unit.powi(3)],
        knee: law.knee.map(|(knee, slope)| (knee * unit, slope / unit)),
        ..law
    };
    MassOnBelt::unchecked(law, system.belt_velocity() * unit)
        .and_then(|scaled| scaled.with_damping(system.damping()))
        .and_then(|scaled| scaled.with_load(system.load() * unit))
        .unwrap()
}

/// Factor by which a damped oscillation shrinks over one period.
pub(super) fn shrinks(damping: f64) -> f64 {
    (-TAU * damping / (1.0 - damping * damping).sqrt()).exp()
}

/// Floating-point numbers next to x, on both sides.
pub(super) fn neighbours(x: f64) -> Vec<f64> {
    (-6..=6)
        .map(|n| x * (1.0 + f64::from(n) * f64::EPSILON))
        .collect()
}

#[track_caller]
pub(super) fn assert_slope(
    sample: Sample,
    step: f64,
    accuracy: f64,
    mut value: impl FnMut(f64) -> f64,
) {
    let difference = (value(sample.x + step) - value(sample.x - step)) / (2.0 * step);
    assert_close(sample.slope, difference, accuracy);
}

/// Asserts that the values at the numbers next to x differ from the exact ones by no more than the
/// noise that they report, and not by far less.
#[track_caller]
pub(super) fn assert_noise(
    x: f64,
    mut sample: impl FnMut(f64) -> Sample,
    exact: impl Fn(f64) -> f64,
) {
    let scatter = neighbours(x)
        .into_iter()
        .map(|x| (sample(x).value - exact(x)).abs())
        .fold(0.0, f64::max);
    let Sample { value, noise, .. } = sample(x);
    assert!(scatter <= noise, "{scatter:e} > {noise:e} at {x} ({value})");
    assert!(
        noise <= 3000.0 * scatter,
        "{noise:e} for {scatter:e} at {x} ({value})"
    );
}
