//! Arcs of a law with constant slope, for which slip is a damped oscillation; and decisions of
//! `PeakDetector` on polynomials made by hand.

use std::f64::consts::{FRAC_1_SQRT_2, TAU};

use super::super::testing::{assert_close, traced};
use super::*;
use crate::belt::MassOnBelt;
use crate::friction::Coulomb;
use crate::friction::FrictionLaw;
use crate::scalar::Scalar;

/// The law μ̂(s) = value + slope·s.
#[derive(Debug, Clone, Copy)]
struct Straight {
    value: f64,
    slope: f64,
}

impl FrictionLaw for Straight {
    fn static_coefficient(&self) -> f64 {
        0.4
    }
    fn kinetic<S: Scalar>(&self, s: S) -> S {
        s * self.slope + self.value
    }
}

type System = MassOnBelt<Straight>;

fn system(value: f64, slope: f64, v_b: f64, damping: f64) -> System {
    MassOnBelt::new(Straight { value, slope }, v_b)
        .and_then(|system| system.with_damping(damping))
        .unwrap()
}

/// A mass behind the belt.
fn lagging(system: &System, displacement: f64, velocity: f64) -> SlipPoint {
    SlipPoint {
        direction: Direction::Lagging,
        displacement,
        speed: system.belt_velocity() - velocity,
        rate: None,
    }
}

/// Asserts that each step begins where and when the one before ends.
#[track_caller]
fn assert_continuous(arc: &Arc, time: Time) {
    for pair in arc.steps.windows(2) {
        assert_close(pair[0].end_time(), pair[1].start_time(), 1e-15);
        if time == Time::Forward {
            let end = pair[0].state_at(pair[0].duration);
            assert_close(end.displacement, pair[1].state.displacement, 1e-14);
            assert_close(end.velocity, pair[1].state.velocity, 1e-14);
        }
    }
}

#[test]
fn an_arc_in_slip_ends_at_the_next_maximum_of_the_velocity() {
    // v = e^(−ζτ)·(a sine): each maximum comes one turn after the last, and is smaller by e^(−ζT).
    for (damping, v_b, load) in [
        (0.1, 0.5, 1.0),
        (-0.1, 0.5, 2.0),
        (0.01, 20.0, 3.0),
        (0.5, 1e-3, 1.0),
    ] {
        // A part of the damping is viscous, and the rest comes from the law.
        let slope = 2.0 * (damping - 0.005) / load;
        let system = system(0.3, slope, v_b, 0.005).with_load(load).unwrap();
        let frequency = f64::sqrt(1.0 - damping * damping);
        let turn = TAU / frequency;
        traced(&system, |tracer| {
            let peak = 0.3 * v_b;
            // v' = 0 where u − ū = −2ζv.
            let rest = tracer.equilibrium;
            let displacement = rest - 2.0 * damping * peak;
            let start = SlipPoint {
                rate: Some(0.0),
                ..lagging(&system, displacement, peak)
            };
            let arc = tracer.arc(start, Time::Forward)?;
            let Arrival::Maximum(end) = arc.arrival else {
                panic!("{:?}", arc.arrival)
            };
            let factor = (-damping * turn).exp();
            let scale = tracer.scale();
            assert_close(v_b - end.speed, factor * peak, 4e-15 * scale);
            assert_close(
                end.displacement,
                rest + factor * (displacement - rest),
                4e-15 * scale,
            );
            assert_eq!(end.rate, Some(0.0));
            let duration: f64 = arc.steps.iter().map(|step| step.duration).sum();
            assert_close(duration, turn, 1e-10);
            // The flow contracts areas by 2ζ per unit of time.
            assert_close(tracer.contraction(&arc), 2.0 * damping * duration, 1e-13);
            assert_continuous(&arc, Time::Forward);
            assert_eq!(arc.start_rate, 0.0);
            assert_close(arc.end_rate, 0.0, 1e-14 * scale);
            assert!((3..=16).contains(&arc.steps.len()), "{}", arc.steps.len());
            assert_eq!(tracer.work(), arc.steps.len());
            // The same arc backwards.
            let back = tracer.arc(end, Time::Backward)?;
            assert_eq!(tracer.work(), arc.steps.len() + back.steps.len());
            let Arrival::Maximum(found) = back.arrival else {
                panic!("{:?}", back.arrival)
            };
            assert_close(found.speed, v_b - peak, 1e-13 * scale);
            assert_close(found.displacement, displacement, 1e-13 * scale);
            assert_close(tracer.contraction(&back), 2.0 * damping * turn, 1e-9);
            assert_continuous(&back, Time::Backward);
            // Reversed, it is the arc forwards again.
            let last = found.state(&tracer.system());
            let again = back.reversed(last);
            assert_eq!(again.steps[0].state, last);
            for pair in again.steps.windows(2) {
                let end = pair[0].state_at(pair[0].duration);
                assert_close(end.displacement, pair[1].state.displacement, 1e-14 * scale);
                assert_close(end.velocity, pair[1].state.velocity, 1e-14 * scale);
            }
            let step = again.steps.last().unwrap();
            assert_close(
                step.state_at(step.duration).velocity,
                factor * peak,
                1e-13 * scale,
            );
            Ok(())
        });
    }
}

#[test]
fn an_arc_from_anywhere_ends_at_its_first_maximum() {
    // Without damping v = A sin(φ + τ): a maximum v = A comes at φ + τ = π/2.
    let system = system(0.3, 0.0, 1.0, 0.0);
    for amplitude in [0.2, 0.9] {
        for k in 0..24 {
            let phase = TAU * (f64::from(k) + 0.5) / 24.0;
            let start = lagging(
                &system,
                0.3 - amplitude * phase.cos(),
                amplitude * phase.sin(),
            );
            let arc = traced(&system, |tracer| tracer.arc(start, Time::Forward));
            let Arrival::Maximum(end) = arc.arrival else {
                panic!("{:?}", arc.arrival)
            };
            let time = (TAU * 1.25 - phase).rem_euclid(TAU);
            let duration: f64 = arc.steps.iter().map(|step| step.duration).sum();
            assert_close(duration, time, 1e-12);
            assert_close(1.0 - end.speed, amplitude, 1e-14);
            assert_close(end.displacement, 0.3, 1e-12);
            assert_close(arc.start_rate, -amplitude * phase.cos(), 1e-15);
            assert!(arc.steps.len() <= 16);
        }
    }
}

#[test]
fn an_arc_beyond_the_belt_velocity_ends_in_contact() {
    let system = system(0.3, 0.0, 1.0, 0.0);
    for (direction, from, to) in [
        (Direction::Lagging, 0.9, -0.3),
        (Direction::Leading, -0.9, 0.3),
    ] {
        let start = SlipPoint::arriving(from, direction);
        let arc = traced(&system, |tracer| tracer.arc(start, Time::Forward));
        let Arrival::Contact(end) = arc.arrival else {
            panic!("{:?}", arc.arrival)
        };
        assert_close(end, to, 1e-14);
        // By symmetry the mass comes back to the belt as fast as it left.
        assert_close(arc.start_rate, 0.6, 1e-15);
        assert_close(arc.end_rate, -0.6, 1e-14);
        assert_continuous(&arc, Time::Forward);
        let back = SlipPoint {
            displacement: end,
            ..start
        };
        let back = traced(&system, |tracer| tracer.arc(back, Time::Backward));
        let Arrival::Contact(end) = back.arrival else {
            panic!("{:?}", back.arrival)
        };
        assert_close(end, from, 1e-14);
    }
}

#[test]
fn an_arc_that_does_not_turn_ends_at_the_equilibrium() {
    for v_b in [0.01, 1.0, 100.0] {
        let system = system(0.3, 3.0, v_b, 0.0);
        let rest = system.belt().equilibrium_displacement();
        let arc = traced(&system, |tracer| {
            tracer.arc(lagging(&system, rest - 0.1 * v_b, 0.5 * v_b), Time::Forward)
        });
        assert_eq!(arc.arrival, Arrival::Equilibrium);
        let last = arc.steps.last().unwrap();
        // The deviation u − ū is measured by the speed (u − ū)/h1 that it causes; h1 = 3.
        let distance = |at: State| ((at.displacement - rest).abs() / 3.0).max(at.velocity.abs());
        assert!(distance(last.state_at(last.duration)) < 1e-9 * v_b);
        // The arc ends no later than it has to: the step before ends outside.
        assert!(distance(last.state) >= 1e-9 * v_b);
    }
    // In a stiff system rounding decides which way the speed changes along the slow motion. The
    // velocity has a maximum only if it was below that of the slow motion.
    let system = system(0.3, 20.0, 1.0, 0.0);
    let rest = system.belt().equilibrium_displacement();
    for (offset, velocity, turns) in [
        (-0.5, 0.0, true),
        (-0.5, -0.5, true),
        (-0.5, 0.9, false),
        (0.5, 0.0, false),
        (0.5, -0.5, false),
    ] {
        let start = lagging(&system, rest + offset, velocity);
        let arc = traced(&system, |tracer| tracer.arc(start, Time::Forward));
        assert_eq!(
            matches!(arc.arrival, Arrival::Maximum(_)),
            turns,
            "{offset} {velocity}"
        );
        assert_eq!(
            arc.arrival == Arrival::Equilibrium,
            !turns,
            "{offset} {velocity}"
        );
    }
}

#[test]
fn an_arc_from_the_equilibrium_stays_there() {
    let system = system(0.25, 0.0, 1.0, 0.0);
    for time in [Time::Forward, Time::Backward] {
        let arc = traced(&system, |tracer| {
            tracer.arc(lagging(&system, 0.25, 0.0), time)
        });
        assert_eq!((arc.arrival, arc.steps.len()), (Arrival::Equilibrium, 1));
        assert_eq!(arc.steps[0].duration, f64::INFINITY);
    }
}

#[test]
fn an_arc_that_grows_backwards_without_turning_is_followed_far_and_no_further() {
    for unit in [1.0 / 256.0, 1.0, 256.0] {
        let system = system(0.3, 3.0 / unit, unit, 0.0).with_load(unit).unwrap();
        let rest = system.belt().equilibrium_displacement();
        let arc = traced(&system, |tracer| {
            tracer.arc(
                lagging(&system, rest + 0.3 * unit, -0.5 * unit),
                Time::Backward,
            )
        });
        assert_eq!(arc.arrival, Arrival::Far);
        let scale = 1.4 * unit;
        let speeds = arc.steps.iter().map(|step| step.speed[0]);
        let step = arc.steps.last().unwrap();
        assert!(speeds.fold(0.0, f64::max) <= 16.0 * scale);
        assert!(step.speed.at(step.duration) > 16.0 * scale);
        assert!(arc.steps.len() <= 16);
    }
}

#[test]
fn a_motion_has_settled_within_a_billionth_of_the_belt_velocity_where_the_equilibrium_attracts() {
    // The equilibrium is at 0, so the numbers are exact. Where h1 = 2β exceeds 1, u is measured by
    // the speed u/h1 that it causes.
    for (damping, stiffness, attracts) in [
        (0.1, 1.0, Some(Time::Forward)),
        (2.0, 4.0, Some(Time::Forward)),
        (512.0, 1024.0, Some(Time::Forward)),
        (0.0, 1.0, None),
    ] {
        let system = system(0.0, 0.0, 1.0, damping);
        traced(&system, |tracer| {
            let settled = |deviation: f64, velocity: f64, time| {
                let displacement = match attracts == Some(time) {
                    true => stiffness * deviation,
                    false => deviation,
                };
                tracer.has_settled(&lagging(&system, displacement, velocity), time)
            };
            for time in [Time::Forward, Time::Backward] {
                let within = attracts == Some(time);
                for place in [0.99e-9, -0.99e-9] {
                    assert_eq!(settled(place, 0.0, time), within);
                    assert_eq!(settled(0.0, place, time), within);
                    assert_eq!(settled(place, place, time), within);
                }
                for place in [1e-9, -1e-9, 1.01e-9, -0.5] {
                    assert!(!settled(place, 0.0, time));
                }
                assert!(!settled(0.0, 1.01e-9, time) && !settled(0.5e-9, -0.3, time));
                // Within rounding of the equilibrium, a motion has settled in any case.
                assert!(settled(15.0 * f64::EPSILON, 0.0, time));
                assert!(settled(0.0, -15.0 * f64::EPSILON, time));
                assert!(attracts == Some(time) || !settled(16.0 * f64::EPSILON, 0.0, time));
            }
            Ok(())
        });
    }
    // An unstable equilibrium attracts backwards, and distances are measured from it.
    let system = system(0.3, -0.1, 1.0, 0.0).with_load(2.0).unwrap();
    let rest = system.belt().equilibrium_displacement();
    assert_close(rest, 0.4, 1e-15);
    traced(&system, |tracer| {
        let near = lagging(&system, rest + 0.5e-9, 0.0);
        assert!(tracer.has_settled(&near, Time::Backward));
        assert!(!tracer.has_settled(&near, Time::Forward));
        let elsewhere = lagging(&system, -rest, 0.0);
        assert!(!tracer.has_settled(&elsewhere, Time::Backward));
        // 16ε(ū + v_b)
        assert!(tracer.has_settled(
            &lagging(&system, rest + 20.0 * f64::EPSILON, 0.0),
            Time::Forward
        ));
        assert!(!tracer.has_settled(
            &lagging(&system, rest + 24.0 * f64::EPSILON, 0.0),
            Time::Forward
        ));
        Ok(())
    });
}

#[test]
fn a_slip_that_cannot_begin_is_not_followed() {
    // Without a jump from static to kinetic friction v' = 0 at the ends of the stick band, and the
    // belt holds the mass at the lower end.
    let flat = system(0.4, 0.0, 1.0, 0.1);
    let jump = MassOnBelt::new(Coulomb::new(0.4, 0.25).unwrap(), 1.0).unwrap();
    let [low, high] = flat.stick_limits();
    let arrival = |u, direction| traced(&flat, |tracer| tracer.arc_leaving(u, direction)).arrival;
    assert_eq!(arrival(low, Direction::Leading), Arrival::Held);
    assert_eq!(arrival(high, Direction::Leading), Arrival::Held);
    assert!(matches!(
        arrival(high, Direction::Lagging),
        Arrival::Maximum(_)
    ));
    assert!(matches!(
        arrival(low - 0.1, Direction::Leading),
        Arrival::Contact(_)
    ));
    // With a jump, slip begins at either end.
    let start = jump.stick_limits()[0];
    let arc = traced(&jump, |tracer| {
        tracer.arc_leaving(start, Direction::Leading)
    });
    assert!(matches!(arc.arrival, Arrival::Contact(_)));
    assert!(
        arc.steps
            .iter()
            .all(|step| step.speed.at(0.5 * step.duration) > 0.0)
    );
    // Backwards, the motion would have to come through the belt velocity.
    let back = |u, direction| traced(&flat, |tracer| tracer.arc_arriving(u, direction)).arrival;
    assert_eq!(back(high + 0.1, Direction::Lagging), Arrival::Held);
    assert_eq!(back(low - 0.1, Direction::Leading), Arrival::Held);
}

#[test]
fn distances_are_measured_by_belt_velocity_and_largest_friction_force() {
    let system = system(0.3, 0.0, 0.5, 0.0).with_load(3.0).unwrap();
    assert_close(traced(&system, |tracer| Ok(tracer.scale())), 1.7, 1e-15);
}

#[test]
fn the_contraction_is_that_of_the_law_where_the_motion_goes() {
    for (value, slope, damping, load) in [(0.3, 0.2, 0.03, 2.0), (0.1, -0.1, 0.2, 3.0)] {
        let system = system(value, slope, 1.0, damping).with_load(load).unwrap();
        let [_, high] = system.stick_limits();
        for (direction, place) in [
            (Direction::Lagging, high + 1.0),
            (Direction::Leading, -high - 4.0),
        ] {
            traced(&system, |tracer| {
                let start = SlipPoint::arriving(place, direction);
                let arc = tracer.arc(start, Time::Forward)?;
                let duration: f64 = arc.steps.iter().map(|step| step.duration).sum();
                let expected = (2.0 * damping + load * slope) * duration;
                assert_close(tracer.contraction(&arc), expected, 1e-13);
                Ok(())
            });
        }
    }
}

#[test]
fn the_rate_at_the_end_of_a_step_is_the_slope_of_its_series() {
    let system = system(0.3, 0.0, 1.0, 0.0);
    let start = lagging(&system, 0.9, 0.2);
    let arc = traced(&system, |tracer| tracer.arc(start, Time::Forward));
    let mut step = arc.steps[0];
    (step.speed, step.duration) = (PowerSeries::from(&[5.0, 1.0, -3.0, 0.5]), 2.0);
    // 1 − 6t + 1.5 t²
    assert_eq!(rate_at_end(&step), -5.0);
}

#[test]
fn a_velocity_may_turn_where_it_is_positive_after_it_grew_or_was_negative() {
    let (h, v_b) = (1.0, 1.0);
    let may = |c: &[f64], has_grown| {
        PeakDetector {
            has_grown,
            ..PeakDetector::new(v_b)
        }
        .may_come(&PowerSeries::from(c), h)
    };
    // The velocity is positive all along.
    assert!(may(&[0.5, 0.1], true));
    assert!(!may(&[0.5, 0.1], false));
    // The velocity is negative all along.
    assert!(!may(&[1.5, 0.1], true) && !may(&[1.5, 0.1], false));
    // The velocity becomes negative, or positive.
    for grows in [true, false] {
        assert!(may(&[0.5, 0.8], grows));
        assert!(may(&[1.5, -0.8], grows));
        assert!(may(&[0.9, 2.0], grows));
        // The velocity changes its sign for a while.
        assert!(may(&[0.9, 1.0, -1.0], grows));
    }
    // Zero is not negative.
    assert!(!may(&[1.0], false));
    assert!(may(&[1.0, 0.1], true) && may(&[1.5, -0.5], true));
}

#[test]
fn the_next_maximum_of_the_velocity_is_a_minimum_of_the_sliding_speed_after_growth() {
    let next = |c: &[f64], h, has_grown| {
        let mut watch = PeakDetector {
            has_grown,
            ..PeakDetector::new(1.0)
        };
        let found = watch.first_inside(&PowerSeries::from(c), h);
        (found, watch.has_grown)
    };
    // The sliding speed is least at t = 0.3.
    let parabola = [0.5, -0.6, 1.0];
    let (found, grows) = next(&parabola, 1.0, true);
    assert_close(found.unwrap(), 0.3, 1e-15);
    assert!(grows);
    assert_eq!(next(&parabola, 1.0, false), (None, false));
    assert_eq!(next(&parabola, 0.29, true), (None, true));
    assert_eq!(next(&parabola, f64::INFINITY, true), (None, true));
    // The sliding speed is largest there: the velocity has a minimum, and counts as growing from
    // then on if the minimum is negative.
    assert_eq!(next(&[0.5, 0.6, -1.0], 1.0, false), (None, false));
    assert_eq!(next(&[1.5, 0.6, -1.0], 1.0, false), (None, true));
    assert_eq!(next(&[0.5, 0.6, -1.0], 1.0, true), (None, true));
    // The sliding speed rises to exactly 1.
    assert_eq!(next(&[0.75, 1.0, -1.0], 1.0, false), (None, false));
    // The rate is −(t − 0.25)(t − 0.5): the speed falls to its minimum at 0.25 and grows until 0.5.
    let falls = |height| [height, -0.125, 0.375, -1.0 / 3.0];
    let (found, _) = next(&falls(0.5), 1.0, true);
    assert_close(found.unwrap(), 0.25, 1e-15);
    assert_eq!(next(&falls(0.5), 1.0, false), (None, false));
    // The rate is (t − 0.25)(t − 0.5): the maximum comes first.
    let rises = |height| [height, 0.125, -0.375, 1.0 / 3.0];
    let (found, grows) = next(&rises(1.0), 1.0, false);
    assert_close(found.unwrap(), 0.5, 1e-15);
    assert!(grows);
    assert_eq!(next(&rises(0.5), 1.0, false), (None, false));
    // An extremum at the start is not the next one: the rates are −2t + 4t³ and 2t.
    let (found, _) = next(&[0.5, 0.0, -1.0, 0.0, 1.0], 1.0, true);
    assert_close(found.unwrap(), FRAC_1_SQRT_2, 1e-15);
    assert_eq!(next(&[0.5, 0.0, 1.0], 1.0, true), (None, true));
}
