//! The return maps against closed forms: with a kinetic coefficient c + d·s slip is a damped
//! oscillation, and without damping a circle.

use std::f64::consts::TAU;

use super::super::testing::{assert_close, traced};
use super::*;
use crate::belt::MassOnBelt;
use crate::motion::EventKind;
use crate::scalar::Scalar;
use crate::state::State;

/// μ̂(s) = c0 + c1 s + c3 s³, and from a knee on a straight line.
#[derive(Debug, Clone, Copy)]
struct Law {
    rest: f64,
    c: [f64; 3],
    knee: Option<(f64, f64)>,
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

type System = MassOnBelt<Law>;

fn system(rest: f64, c: [f64; 3], v_b: f64, damping: f64) -> System {
    let knee = None;
    MassOnBelt::new(Law { rest, c, knee }, v_b)
        .and_then(|system| system.with_damping(damping))
        .unwrap()
}

/// A constant kinetic coefficient, and no damping.
fn circles(rest: f64, kinetic: f64, v_b: f64) -> System {
    system(rest, [kinetic, 0.0, 0.0], v_b, 0.0)
}

/// Slip with the damping ratio `damping`, which may be negative.
fn spiral(damping: f64, v_b: f64) -> System {
    system(0.4, [0.4, 2.0 * damping, 0.0], v_b, 0.0)
}

fn with_knee(mut law: Law, knee: f64, slope: f64, v_b: f64) -> System {
    law.knee = Some((knee, slope));
    MassOnBelt::new(law, v_b).unwrap()
}

/// The set of parameters of most examples of the crate: friction falls to half a unit of speed, and
/// rises beyond.
fn paper(v_b: f64) -> System {
    system(0.4, [0.4, -0.45, 0.6], v_b, 0.05)
}

/// A set that overshoots, and crosses, at large belt velocities.
fn fast(v_b: f64, damping: f64, load: f64) -> System {
    let (k1, k3) = (1.5 * 0.16 / 0.55, 0.5 * 0.16 / 0.55_f64.powi(3));
    system(0.38, [0.38, -k1, k3], v_b, damping)
        .with_load(load)
        .unwrap()
}

/// Round a stable equilibrium a cycle that repels, with about this peak.
fn repelling(peak: f64, cubic: f64) -> System {
    let v_b = 0.5;
    // Linear damping 0.75·cubic·V², beside the slope 3·cubic·v_b².
    let slope = cubic * (3.0 * v_b * v_b + 0.75 * peak * peak);
    system(0.6, [0.6, slope, -cubic], v_b, 0.0)
}

/// The same system measured in another unit of length.
fn rescaled(system: &System, unit: f64) -> System {
    let law = *system.law();
    let [c0, c1, c3] = law.c;
    let law = Law {
        c: [c0, c1 / unit, c3 / unit.powi(3)],
        knee: law.knee.map(|(knee, slope)| (knee * unit, slope / unit)),
        ..law
    };
    MassOnBelt::new(law, system.belt_velocity() * unit)
        .and_then(|scaled| scaled.with_damping(system.damping()))
        .and_then(|scaled| scaled.with_load(system.load() * unit))
        .unwrap()
}

/// Factor by which a damped oscillation shrinks over one turn.
fn shrinks(damping: f64) -> f64 {
    (-TAU * damping / (1.0 - damping * damping).sqrt()).exp()
}

/// Numbers next to x, on both sides.
fn neighbours(x: f64) -> Vec<f64> {
    (-6..=6)
        .map(|n| x * (1.0 + f64::from(n) * f64::EPSILON))
        .collect()
}

#[track_caller]
fn assert_slope(sample: Sample, step: f64, accuracy: f64, mut value: impl FnMut(f64) -> f64) {
    let difference = (value(sample.x + step) - value(sample.x - step)) / (2.0 * step);
    assert_close(sample.slope, difference, accuracy);
}

/// Largest distance of the values next to x from what they should be, and the noise that is told
/// there.
#[track_caller]
fn assert_noise(x: f64, mut sample: impl FnMut(f64) -> Sample, exact: impl Fn(f64) -> f64) {
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

#[test]
fn noise_of_a_turn_bounds_what_rounding_does_and_not_by_far() {
    for damping in [0.05, -0.05, -1e-3] {
        for v_b in [1e-3, 1.0, 1e3, 1e6] {
            let system = spiral(damping, v_b);
            for part in [1e-4, 0.5, 0.7] {
                traced(&system, |tracer| {
                    let growth = |peak| tracer.growth(peak).unwrap();
                    assert_noise(part * v_b, growth, |_| shrinks(damping) - 1.0);
                    Ok(())
                });
            }
        }
    }
}

#[test]
fn noise_of_a_crossing_grows_with_the_place_of_contact_that_a_slow_contact_shifts() {
    // From flat contacts, where the belt is 10⁴ times as fast as the motion accelerates, to steep
    // ones.
    for (rest, kinetic, v_b) in [
        (0.4, 0.25, 0.2),
        (0.4, 0.25, 1e-4),
        (0.4, 0.25, 1e4),
        (0.4, 0.4, 30.0),
    ] {
        let system = circles(rest, kinetic, v_b);
        for part in [1.0001, 4.0, 100.0, 1e5] {
            traced(&system, |tracer| {
                let growth = |force| tracer.crossing_growth(force).unwrap();
                let exact = |force| -4.0 * kinetic / force;
                assert_noise((4.0 * kinetic + rest) * part, growth, exact);
                Ok(())
            });
        }
    }
}

#[test]
fn linear_friction_makes_every_turn_the_same_spiral() {
    for damping in [0.3, 0.02, -0.02, -0.1] {
        for v_b in [0.01, 1.0, 50.0] {
            let system = spiral(damping, v_b);
            for part in [1e-3, 0.1, 0.5] {
                let peak = part * v_b;
                let growth = traced(&system, |tracer| tracer.growth(peak));
                assert_eq!(growth.x, peak);
                assert_close(growth.value, shrinks(damping) - 1.0, growth.noise);
                // P(V)/V is the same for all V.
                assert_close(growth.slope * peak, 0.0, growth.noise);
            }
        }
    }
}

#[test]
fn viscous_damping_and_a_rising_law_damp_alike() {
    // 2β + γ²d = 0.2.
    let system = system(0.4, [0.4, 0.05, 0.0], 1.0, 0.05)
        .with_load(2.0)
        .unwrap();
    for peak in [0.1, 0.9] {
        let growth = traced(&system, |tracer| tracer.growth(peak));
        assert_close(growth.value, shrinks(0.1) - 1.0, growth.noise);
        assert_close(growth.slope, 0.0, growth.noise / peak);
    }
}

#[test]
fn slopes_of_the_growth_of_a_turn_are_those_of_its_values() {
    for unit in [1.0, 1.0 / 64.0] {
        for (of_unit_size, peaks) in [
            (paper(0.43), [0.1, 0.25, 0.33]),
            (paper(0.5), [0.1, 0.25, 0.4]),
            (fast(0.4, 0.02, 1.0), [0.1, 0.2, 0.25]),
        ] {
            let system = rescaled(&of_unit_size, unit);
            for peak in peaks.map(|peak| peak * unit) {
                traced(&system, |tracer| {
                    let growth = tracer.growth(peak)?;
                    let value = |peak| tracer.growth(peak).unwrap().value;
                    assert!(growth.slope.abs() * peak > 1e-3);
                    assert_slope(growth, 1e-4 * peak, 1e-7 / peak, value);
                    Ok(())
                });
            }
        }
    }
}

#[test]
fn a_turn_that_meets_the_belt_counts_as_growth_and_one_that_settles_as_death() {
    let grows = traced(&spiral(-0.1, 0.5), |tracer| tracer.growth(0.4));
    assert_eq!((grows.value, grows.slope < 0.0), (1.5, true));
    let dies = traced(&spiral(1.2, 0.5), |tracer| tracer.growth(0.4));
    assert_eq!((dies.value, dies.slope), (-1.0, 0.0));
}

#[test]
fn the_largest_peak_comes_back_grazing_the_belt() {
    for v_b in [0.2, 3.0] {
        // Of a motion that grows, the peak before the belt; it grows by the same factor as every
        // other.
        let largest = traced(&spiral(-0.1, v_b), |tracer| tracer.largest_peak()).unwrap();
        assert_close(largest.x, v_b / shrinks(-0.1), largest.noise * v_b);
        assert_close(largest.value, shrinks(-0.1) - 1.0, largest.noise);
        assert_close(largest.slope * largest.x, 0.0, largest.noise);
        // Of one that dies, the belt velocity itself.
        let largest = traced(&spiral(0.1, v_b), |tracer| tracer.largest_peak()).unwrap();
        assert_eq!(largest.x, v_b);
        assert_close(largest.value, shrinks(0.1) - 1.0, largest.noise);
    }
    // Next to an unstable node no motion turns, and the grazing one comes straight from it.
    let none = traced(&spiral(-1.5, 1.0), |tracer| tracer.largest_peak());
    assert_eq!(none, None);
}

#[test]
fn the_slope_at_the_largest_peak_is_that_of_the_growth_just_below() {
    let system = paper(0.3);
    traced(&system, |tracer| {
        let largest = tracer.largest_peak()?.unwrap();
        let below = tracer.growth(largest.x * (1.0 - 1e-6))?;
        assert_close(largest.value, below.value, 1e-5 * largest.value);
        // The growth turns steep there.
        assert_close(largest.slope, below.slope, 1e-2 * largest.slope.abs());
        Ok(())
    });
}

#[test]
fn peaks_are_searched_from_a_ten_thousandth_of_the_belt_velocity_to_the_largest() {
    for v_b in [0.2, 3.0] {
        let [smallest, largest] =
            traced(&spiral(-0.1, v_b), |tracer| tracer.range_of_peaks()).unwrap();
        assert_close(smallest.x, 1e-4 * v_b, 1e-18 * v_b);
        assert_close(largest.x, v_b / shrinks(-0.1), 1e-13 * v_b);
        for end in [smallest, largest] {
            assert_close(end.value, shrinks(-0.1) - 1.0, end.noise);
        }
        let [_, largest] = traced(&spiral(0.1, v_b), |tracer| tracer.range_of_peaks()).unwrap();
        assert_eq!(largest.x, v_b);
        // All motions grow to the belt: by more than 10⁴ a turn.
        assert_eq!(
            traced(&spiral(-0.9, v_b), |tracer| tracer.range_of_peaks()),
            None
        );
        // By less.
        let [_, largest] = traced(&spiral(-0.7, v_b), |tracer| tracer.range_of_peaks()).unwrap();
        assert_close(largest.x, v_b / shrinks(-0.7), 1e-12 * v_b);
    }
}

#[test]
fn the_outline_of_a_straight_growth_has_only_ends() {
    let outline = traced(&spiral(-0.1, 2.0), |tracer| tracer.outline());
    let [(first, low), (last, high)] = outline[..] else {
        panic!("{outline:?}")
    };
    assert_close(first, 2e-4, 1e-15);
    assert_close(last, 2.0 / shrinks(-0.1), 1e-12);
    assert_close(low, shrinks(-0.1) - 1.0, 1e-9);
    assert_close(high, shrinks(-0.1) - 1.0, 1e-13);
    assert_eq!(traced(&spiral(-0.9, 2.0), |tracer| tracer.outline()), []);
}

#[test]
fn nothing_depends_on_the_unit_of_length() {
    // By a power of two, so that not even rounding does.
    let examples = [
        paper(0.2),
        paper(0.43),
        fast(0.15, 0.004, 0.1),
        fast(0.2, 0.001, 0.03),
        circles(0.4, 0.25, 0.2),
    ];
    for (unit, system) in [1.0 / 1024.0, 1024.0]
        .into_iter()
        .flat_map(|unit| examples.map(|system| (unit, system)))
    {
        let other = rescaled(&system, unit);
        let same = |small: Sample, large: Sample| {
            assert_eq!(large.x, small.x * unit);
            assert_eq!(large.value, small.value);
            assert_eq!(large.slope, small.slope / unit);
            assert_eq!(large.noise, small.noise);
            assert_eq!(large.work, small.work);
        };
        traced(&system, |a| {
            traced(&other, |b| {
                let (v_b, force) = (system.belt_velocity(), 3.0 * a.scale());
                for part in [0.3, 1.0] {
                    same(a.growth(part * v_b)?, b.growth(part * v_b * unit)?);
                }
                same(a.crossing_growth(force)?, b.crossing_growth(force * unit)?);
                for (a, b) in std::iter::zip(a.least_crossing()?, b.least_crossing()?) {
                    same(a, b);
                }
                assert_eq!(a.contacts()?, b.contacts()?);
                assert_eq!(a.scale() * unit, b.scale());
                assert_eq!(
                    a.system().carried_force() * unit,
                    b.system().carried_force()
                );
                let (fate, scaled_fate) = (a.release_fate()?, b.release_fate()?);
                let (found, scaled) = (a.crossing_forces(&fate)?, b.crossing_forces(&scaled_fate)?);
                assert_eq!(
                    found
                        .roots
                        .iter()
                        .map(|force| force * unit)
                        .collect::<Vec<_>>(),
                    scaled.roots
                );
                assert_eq!(a.work(), b.work());
                Ok(())
            });
            Ok(())
        });
    }
}

#[test]
fn the_release_point_leads_to_stick_crossing_or_inwards() {
    let fate = |system: &System| traced(system, |tracer| tracer.release_fate());
    let arcs = |fate: ReleaseFate| match fate {
        ReleaseFate::Stick { arcs } => arcs.len(),
        other => panic!("{other:?}"),
    };
    assert_eq!(arcs(fate(&circles(0.4, 0.25, 0.2))), 1);
    assert_eq!(arcs(fate(&fast(0.15, 0.004, 0.1))), 1);
    assert_eq!(arcs(fate(&fast(0.18, 0.004, 0.1))), 2);
    assert!(matches!(
        fate(&fast(0.3, 0.001, 0.03)),
        ReleaseFate::Outward
    ));
    assert!(matches!(
        fate(&spiral(1.5, 0.2)),
        ReleaseFate::Inward { peak: None }
    ));
    // The release point of a law without a jump is where the velocity has its maximum v_b.
    let ReleaseFate::Inward { peak: Some(peak) } = fate(&spiral(0.1, 0.5)) else {
        panic!()
    };
    assert_close(peak, 0.5 * shrinks(0.1), 1e-15);
}

#[test]
fn contacts_of_circles() {
    for (rest, kinetic, v_b) in [(0.4, 0.25, 0.2), (0.5, 0.1, 0.3), (4.0, 3.0, 10.0)] {
        let contacts = traced(&circles(rest, kinetic, v_b), |tracer| tracer.contacts());
        // Round μ_k, from the displacement μ_s back to its mirror image.
        let excess: f64 = (rest - kinetic) / v_b;
        assert_close(contacts.gap, 0.5 * excess * excess, 1e-14);
        let beyond = (-rest - (2.0 * kinetic - rest)) / (v_b + rest);
        assert_close(contacts.beyond_low.unwrap(), beyond, 1e-13);
        assert_eq!(contacts.beyond_high, None);
    }
}

#[test]
fn contacts_of_motions_that_turn_back_or_settle() {
    for v_b in [0.2, 5.0] {
        let turns = traced(&spiral(0.1, v_b), |tracer| tracer.contacts());
        assert_close(turns.gap, shrinks(0.1) - 1.0, 1e-14);
        assert_eq!((turns.beyond_low, turns.beyond_high), (None, None));
        let settles = traced(&spiral(1.5, v_b), |tracer| tracer.contacts());
        assert_eq!(settles.gap, -1.0);
    }
}

#[test]
fn contacts_are_those_of_the_simulated_motion() {
    for (system, crosses) in [
        (fast(0.15, 0.004, 0.1), false),
        (fast(0.18, 0.004, 0.1), true),
        (fast(0.2, 0.001, 0.03), true),
        (fast(0.3, 0.001, 0.03), true),
    ] {
        let contacts = traced(&system, |tracer| tracer.contacts());
        let (v_b, [low, high]) = (system.belt_velocity(), system.stick_limits());
        let scale = v_b + system.load() * 0.38;
        let motion = system
            .simulate(system.release_state().unwrap(), 16.0)
            .unwrap();
        let places: Vec<f64> = motion.events()[1..]
            .iter()
            .map(|event| event.state.displacement)
            .collect();
        assert_close(
            contacts.beyond_low.unwrap(),
            (low - places[0]) / scale,
            1e-13,
        );
        assert_eq!(contacts.beyond_low.unwrap() > 0.0, crosses);
        assert_eq!(motion.events()[1].kind != EventKind::Stick, crosses);
        // The acceleration with which it meets the belt.
        let rate = system.acceleration(State::new(places[0], v_b.next_down())) / v_b;
        assert_close(contacts.gap, 0.5 * rate * rate, 1e-12);
        let beyond_high = crosses.then(|| (places[1] - high) / scale);
        assert_eq!(contacts.beyond_high.is_some(), crosses);
        if let (Some(found), Some(simulated)) = (contacts.beyond_high, beyond_high) {
            assert_close(found, simulated, 1e-12);
            assert_eq!(found > 0.0, motion.events()[2].kind != EventKind::Stick);
        }
    }
}

#[test]
fn crossings_of_circles_lose_four_times_the_friction_force() {
    for (rest, kinetic, v_b) in [(0.4, 0.25, 0.2), (0.4, 0.25, 7.0), (0.4, -0.03, 0.2)] {
        let system = circles(rest, kinetic, v_b).with_load(2.0).unwrap();
        let (rest, kinetic) = (2.0 * rest, 2.0 * kinetic);
        for force in [1.0 + rest + 4.0 * kinetic, 9.0, 30.0] {
            let growth = traced(&system, |tracer| tracer.crossing_growth(force));
            assert_close(growth.value, -4.0 * kinetic / force, growth.noise);
            // As long as they lie apart on the way out, they do on the way back.
            assert_close(
                growth.slope,
                4.0 * kinetic / (force * force),
                growth.noise / force,
            );
            let grows = traced(&system, |tracer| tracer.grows_from_crossing(force));
            assert_eq!(grows, Some(kinetic < 0.0));
        }
    }
}

#[test]
fn a_motion_that_does_not_cross_again_is_taken_to_the_release_point() {
    let system = circles(0.4, 0.25, 0.2);
    // It crosses down at more than 2μ_k + μ_s, and down again at less than the release force, if at
    // all.
    for force in [0.5, 0.85, 0.95, 1.3] {
        let growth = traced(&system, |tracer| tracer.crossing_growth(force));
        assert_close(growth.value, 0.4 / force - 1.0, 1e-15);
        assert_close(growth.slope, -0.4 / (force * force), 1e-14);
    }
    // Or never comes back to the belt, or not beyond.
    let none = |system: &System, force| traced(system, |tracer| tracer.crossing(force)).is_none();
    assert!(none(&spiral(1.5, 1.0), 0.5));
    assert!(none(&system, 0.85));
    assert!(!none(&system, 0.95));
}

#[test]
fn the_slope_of_a_crossing_is_that_of_its_values() {
    for (of_unit_size, forces) in [
        (fast(0.3, 0.001, 0.03), [0.1, 0.3, 0.6]),
        (fast(0.3, 0.1, 0.03), [1.0, 2.0, 4.0]),
        (system(0.4, [0.4, 0.05, 0.0], 1.0, 0.05), [3.0, 4.0, 10.0]),
        (system(0.4, [0.2, 0.0, 0.02], 0.3, 0.02), [3.0, 4.0, 5.0]),
    ] {
        for unit in [1.0, 64.0] {
            let system = rescaled(&of_unit_size, unit);
            for force in forces.map(|force| force * unit) {
                traced(&system, |tracer| {
                    let growth = tracer.crossing_growth(force)?;
                    assert!(tracer.crossing(force)?.is_some(), "{force}");
                    let value = |force| tracer.crossing_growth(force).unwrap().value;
                    assert_slope(growth, 1e-4 * force, 1e-7 / force, value);
                    Ok(())
                });
            }
        }
    }
}

#[test]
fn the_least_crossing_comes_back_to_an_end_of_the_stick_band() {
    // From beyond the lower end of the band to its upper end.
    let least = traced(&circles(0.4, 0.25, 0.2), |tracer| tracer.least_crossing()).unwrap();
    assert_close(least.x, 1.4, 1e-14);
    assert_close(least.value, 0.4 / 1.4 - 1.0, 1e-14);
    assert_close(least.slope, 1.0 / (1.4 * 1.4), 1e-13);
    // A friction that drives the mass: from the lower end of the band beyond its upper end.
    let least = traced(&circles(0.4, -0.05, 0.2), |tracer| tracer.least_crossing()).unwrap();
    assert_close(least.x, 0.3, 1e-14);
    assert_close(least.value, 0.5 / 0.3 - 1.0, 1e-14);
    assert_close(least.slope, -0.2 / (0.3 * 0.3), 1e-13);
    // Every motion beyond the release point crosses again where nothing brakes it.
    let outward = traced(&circles(0.4, -0.25, 0.2), |tracer| tracer.least_crossing());
    assert!(outward.is_none_or(|least| least.x <= 0.4));
}

#[test]
fn the_least_crossing_has_the_growth_of_the_crossings_just_above() {
    for (system, driven) in [
        (fast(0.18, 0.004, 0.1), false),
        (fast(0.3, 0.05, 0.03), false),
        (system(0.4, [0.1, 0.1, 0.0], 0.5, 0.1), false),
        (system(0.4, [-0.05, 0.2, 0.0], 1.0, 0.01), true),
    ] {
        traced(&system, |tracer| {
            let least = tracer.least_crossing()?.unwrap();
            let above = tracer.crossing_growth(least.x * (1.0 + 1e-7))?;
            assert_close(least.value, above.value, 1e-5);
            assert_close(least.slope, above.slope, 1e-4 * above.slope.abs());
            // It comes back to the release point, or, driven, beyond.
            let release = system.load() * system.law().rest;
            let next = least.x * (1.0 + least.value);
            if driven {
                assert!(next > release + 0.01);
            } else {
                assert_close(next, release, 1e-14);
            }
            Ok(())
        });
    }
}

#[test]
fn noise_of_the_least_crossing_is_that_of_the_crossings_just_above() {
    for system in [
        circles(0.4, 0.25, 0.2),
        circles(0.4, 0.25, 1e3),
        system(0.4, [-0.05, 0.2, 0.0], 1.0, 0.01),
        fast(0.18, 0.004, 0.1),
    ] {
        traced(&system, |tracer| {
            let least = tracer.least_crossing()?.unwrap();
            let above = tracer.crossing_growth(least.x * (1.0 + 1e-6))?;
            assert!(
                (0.1..10.0).contains(&(least.noise / above.noise)),
                "{least:?} {above:?}"
            );
            Ok(())
        });
    }
}

#[test]
fn an_arc_stretches_the_same_followed_forward_and_backward() {
    let system = system(0.4, [0.2, 0.1, 0.02], 0.5, 0.05);
    traced(&system, |tracer| {
        let offset = tracer.system().carried_force();
        let ([lagging, leading], _) = tracer.crossing_arcs(3.0)?.unwrap();
        let mut start = 3.0 - offset;
        for (arc, direction) in [(lagging, Direction::Lagging), (leading, Direction::Leading)] {
            let Arrival::Contact(end) = arc.arrival else {
                panic!()
            };
            let forward = tracer.stretch(&arc, Time::Forward);
            let arriving = SlipPoint::arriving(end, direction);
            let back = tracer.arc(arriving, Time::Backward)?;
            let Arrival::Contact(found) = back.arrival else {
                panic!()
            };
            assert_close(found, start, 1e-13);
            assert_close(tracer.stretch(&back, Time::Backward), forward, 1e-12);
            let mut shifted = |by: f64| -> Result<f64, Error> {
                let arc = tracer.arc(
                    SlipPoint::leaving(tracer.system(), start + by, direction),
                    Time::Forward,
                )?;
                match arc.arrival {
                    Arrival::Contact(end) => Ok(end),
                    other => panic!("{other:?}"),
                }
            };
            let difference = (shifted(1e-4)? - shifted(-1e-4)?) / 2e-4;
            assert_close(forward, difference.abs(), 1e-8);
            assert!((forward - 1.0).abs() > 0.05, "{forward}");
            start = end;
        }
        Ok(())
    });
}

#[test]
fn the_multiplier_of_a_crossing_cycle_is_how_far_a_shift_comes_back() {
    let system = fast(0.3, 0.001, 0.03);
    traced(&system, |tracer| {
        let fate = tracer.release_fate()?;
        let found = tracer.crossing_forces(&fate)?;
        assert_eq!((found.roots.len(), found.unresolved.len()), (1, 0));
        let force = found.roots[0];
        let (_, multiplier) = tracer.crossing(force)?.unwrap();
        let mut next =
            |force: f64| -> Result<f64, Error> { Ok(tracer.crossing_arcs(force)?.unwrap().1) };
        assert_close(next(force)?, force, 1e-13);
        let difference = (next(force + 1e-5)? - next(force - 1e-5)?) / 2e-5;
        assert_close(multiplier, difference, 1e-7);
        assert!(multiplier < 0.999 && multiplier > 0.1);
        Ok(())
    });
}

#[test]
fn cycles_in_slip_close_whether_they_attract_or_repel() {
    let strongly = repelling(0.3, 2.0);
    let (repelling, attracting) = (repelling(0.3, 0.9), paper(0.43));
    for (system, grows) in [(repelling, true), (strongly, true), (attracting, false)] {
        traced(&system, |tracer| {
            let found = tracer.pure_slip_peaks()?;
            let [peak] = found.roots[..] else {
                panic!("{found:?}")
            };
            let (arc, multiplier) = tracer.pure_slip(peak)?;
            assert_eq!(multiplier > 1.0, grows, "{multiplier}");
            // P(V)/V − 1 is zero there, and so P' = 1 + V times its slope.
            let growth = tracer.growth(peak)?;
            assert_close(multiplier, 1.0 + peak * growth.slope, 1e-9 * multiplier);
            let starts: Vec<State> = arc.steps.iter().map(|step| step.state).collect();
            let ends = arc.steps.iter().map(|step| step.state_at(step.duration));
            for (end, start) in std::iter::zip(ends, starts.iter().cycle().skip(1)) {
                assert_close(end.displacement, start.displacement, 1e-14);
                assert_close(end.velocity, start.velocity, 1e-14);
            }
            assert_close(starts[0].velocity, peak, 1e-14);
            Ok(())
        });
    }
}

#[test]
fn friction_is_flat_if_nothing_varies_at_the_belt_velocity() {
    let is_flat = |system: &System| traced(system, |tracer| Ok(tracer.is_flat()));
    let flat = circles(0.4, 0.25, 0.5);
    assert!(is_flat(&flat));
    assert!(is_flat(&with_knee(*flat.law(), 0.7, 0.1, 0.5)));
    assert!(!is_flat(&with_knee(*flat.law(), 0.7, 0.1, 0.8)));
    assert!(!is_flat(&flat.with_damping(1e-9).unwrap()));
    assert!(!is_flat(&spiral(1e-9, 0.5)));
    assert!(!is_flat(&spiral(1e-9, 0.5).with_damping(1e-9).unwrap()));
}

#[test]
fn motions_fill_a_disc_only_if_friction_varies_nowhere_in_it() {
    let is_continuum = |system: &System| traced(system, |tracer| tracer.is_continuum());
    for v_b in [0.01, 0.5, 40.0] {
        let flat = circles(0.4, 0.25, v_b);
        assert!(is_continuum(&flat));
        // Peaks above 0.05, 0.2, 0.4, 0.6, 0.8 of the belt velocity meet the knee.
        for reach in [0.05, 0.2, 0.4, 0.6, 0.8] {
            let kneed = with_knee(*flat.law(), (1.0 + reach) * v_b, 0.1 / v_b, v_b);
            assert!(!is_continuum(&kneed), "{v_b} {reach}");
        }
        let beyond = with_knee(*flat.law(), 2.5 * v_b, 0.1 / v_b, v_b);
        assert!(is_continuum(&beyond), "{v_b}");
    }
}

#[test]
fn growth_is_not_told_where_rounding_hides_it() {
    let grows = |system: &System, peak| traced(system, |tracer| tracer.grows_from_peak(peak));
    for peak in [0.01, 0.3] {
        assert_eq!(grows(&spiral(-0.01, 1.0), peak), Some(true));
        assert_eq!(grows(&spiral(0.01, 1.0), peak), Some(false));
    }
    for peak in [1e-6, 0.3] {
        // 1e-16 or less a turn.
        assert_eq!(grows(&spiral(-2e-17, 1.0), peak), None);
        assert_eq!(grows(&spiral(2e-17, 1.0), peak), None);
    }
    let system = repelling(0.3, 0.9);
    assert!(system.equilibrium().unwrap().is_stable());
    let [peak] = traced(&system, |tracer| tracer.pure_slip_peaks()).roots[..] else {
        panic!()
    };
    assert_eq!(grows(&system, 0.9 * peak), Some(false));
    assert_eq!(grows(&system, peak + 0.1 * (0.5 - peak)), Some(true));
}

/// A friction that drives the mass, and viscous damping: C(F) = r F + d with r < 1, by circles that
/// shrink.
fn driven(force: f64, v_b: f64) -> System {
    // The crossing cycle lies where 4·0.05 = force·(1 − r), nearly.
    let damping = 0.2 / (TAU * force);
    system(0.4, [-0.05, 0.0, 0.0], v_b, damping)
}

#[test]
fn crossings_are_searched_to_sixteen_times_the_scale_of_a_system_and_no_further_than_twice_that() {
    for (v_b, unit) in [(0.2, 1.0), (0.5, 1.0), (0.2, 1e3), (0.2, 1e-3)] {
        let far = FAR * (0.4 + v_b);
        for (force, lies_in) in [(0.1 * far, true), (0.95 * far, true), (3.0 * far, false)] {
            let system = rescaled(&driven(force, v_b), unit);
            traced(&system, |tracer| {
                let fate = tracer.release_fate()?;
                let found = tracer.crossing_forces(&fate)?;
                assert_eq!(
                    found.roots.len(),
                    usize::from(lies_in),
                    "{v_b} {unit} {force}: {found:?}"
                );
                Ok(())
            });
        }
    }
}

#[test]
fn the_search_for_crossings_ends_soon_where_motions_shrink_and_where_they_grow() {
    for (system, steps) in [
        // After two that shrink beyond what the belt velocity can feed.
        (circles(0.4, 0.25, 0.2), 16..26),
        (circles(0.4, 0.1, 20.0), 54..75),
        (paper(0.2), 20..29),
        // Far out.
        (circles(0.4, -0.1, 0.2), 36..52),
        (circles(0.4, -0.1, 20.0), 76..100),
    ] {
        traced(&system, |tracer| {
            let fate = tracer.release_fate()?;
            let before = tracer.work();
            let found = tracer.crossing_forces(&fate)?;
            assert_eq!(found, Found::default());
            let work = tracer.work() - before;
            assert!(steps.contains(&work), "{work} {system:?}");
            Ok(())
        });
    }
}

#[test]
fn crossings_beyond_the_last_breakpoint_are_found_where_those_below_shrink() {
    // From the knee on friction drives the mass. Motions with forces from 0.5 to about 10 shrink.
    let law = *circles(0.12, 0.1, 1.0).law();
    for unit in [1.0, 64.0, 1.0 / 64.0] {
        let system = rescaled(&with_knee(law, 10.0, -0.5, 1.0), unit);
        traced(&system, |tracer| {
            let fate = tracer.release_fate()?;
            let found = tracer.crossing_forces(&fate)?;
            let [force] = found.roots[..] else {
                panic!("{found:?}")
            };
            let (_, multiplier) = tracer.crossing(force)?.unwrap();
            assert!(multiplier > 1.0);
            assert_eq!(tracer.grows_from_crossing(0.99 * force)?, Some(false));
            assert_eq!(tracer.grows_from_crossing(1.01 * force)?, Some(true));
            Ok(())
        });
    }
}

#[test]
fn without_friction_nothing_crosses_for_ever() {
    let found = traced(&system(0.0, [0.0; 3], 1.0, 0.1), |tracer| {
        let fate = tracer.release_fate()?;
        tracer.crossing_forces(&fate)
    });
    assert_eq!(found, Found::default());
}
