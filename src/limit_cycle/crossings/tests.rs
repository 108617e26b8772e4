//! The map of crossings, compared with closed forms.

use std::f64::consts::TAU;

use super::super::testing::{
    System, assert_close, assert_noise, assert_slope, circles, fast, fate, paper, rescaled, spiral,
    system, traced, with_knee,
};
use super::*;
use crate::friction::slip_series::SlipPoint;

/// A system with friction that drives the mass, and viscous damping: C(F) = rF + d with r < 1.
fn driven(force: f64, v_b: f64) -> System {
    // The crossing cycle lies where 4·0.05 = force·(1 − r), nearly.
    let damping = 0.2 / (TAU * force);
    system(0.4, [-0.05, 0.0, 0.0], v_b, damping)
}

#[test]
fn noise_of_a_crossing_grows_with_the_place_of_contact_that_a_slow_contact_shifts() {
    // From flat contacts, with a belt velocity 10⁴ times as large as the acceleration, to steep
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
                let growth = |force| CrossingMap::of(tracer).growth(force).unwrap();
                let exact = |force| -4.0 * kinetic / force;
                assert_noise((4.0 * kinetic + rest) * part, growth, exact);
                Ok(())
            });
        }
    }
}

#[test]
fn crossings_of_circles_lose_four_times_the_friction_force() {
    for (rest, kinetic, v_b) in [(0.4, 0.25, 0.2), (0.4, 0.25, 7.0), (0.4, -0.03, 0.2)] {
        let system = circles(rest, kinetic, v_b).with_load(2.0).unwrap();
        let (rest, kinetic) = (2.0 * rest, 2.0 * kinetic);
        for force in [1.0 + rest + 4.0 * kinetic, 9.0, 30.0] {
            let growth = traced(&system, |tracer| CrossingMap::of(tracer).growth(force));
            assert_close(growth.value, -4.0 * kinetic / force, growth.noise);
            // Two motions come back as far apart as they set out.
            assert_close(
                growth.slope,
                4.0 * kinetic / (force * force),
                growth.noise / force,
            );
            let grows = traced(&system, |tracer| CrossingMap::of(tracer).grows(force));
            assert_eq!(grows, Some(kinetic < 0.0));
        }
    }
}

#[test]
fn a_motion_that_does_not_cross_again_is_taken_to_the_release_point() {
    let system = circles(0.4, 0.25, 0.2);
    // A force above 2μ_k + μ_s leads to a second downward crossing, but with less than the release
    // force.
    for force in [0.5, 0.85, 0.95, 1.3] {
        let growth = traced(&system, |tracer| CrossingMap::of(tracer).growth(force));
        assert_close(growth.value, 0.4 / force - 1.0, 1e-15);
        assert_close(growth.slope, -0.4 / (force * force), 1e-14);
    }
    // These motions never come back to the belt, or do not cross it.
    let none = |system: &System, force| {
        traced(system, |tracer| CrossingMap::of(tracer).cycle(force)).is_none()
    };
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
                    let growth = CrossingMap::of(tracer).growth(force)?;
                    assert!(CrossingMap::of(tracer).cycle(force)?.is_some(), "{force}");
                    let value = |force| CrossingMap::of(tracer).growth(force).unwrap().value;
                    assert_slope(growth, 1e-4 * force, 1e-7 / force, value);
                    Ok(())
                });
            }
        }
    }
}

#[test]
fn the_least_crossing_comes_back_to_an_end_of_the_stick_band() {
    // From beyond the lower end of the band, the motion comes back to the upper end.
    let least = traced(&circles(0.4, 0.25, 0.2), |tracer| {
        CrossingMap::of(tracer).least()
    })
    .unwrap();
    assert_close(least.x, 1.4, 1e-14);
    assert_close(least.value, 0.4 / 1.4 - 1.0, 1e-14);
    assert_close(least.slope, 1.0 / (1.4 * 1.4), 1e-13);
    // Friction that drives the mass takes it from the lower end of the band beyond the upper end.
    let least = traced(&circles(0.4, -0.05, 0.2), |tracer| {
        CrossingMap::of(tracer).least()
    })
    .unwrap();
    assert_close(least.x, 0.3, 1e-14);
    assert_close(least.value, 0.5 / 0.3 - 1.0, 1e-14);
    assert_close(least.slope, -0.2 / (0.3 * 0.3), 1e-13);
    // If nothing brakes a motion beyond the release point, it crosses again.
    let outward = traced(&circles(0.4, -0.25, 0.2), |tracer| {
        CrossingMap::of(tracer).least()
    });
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
            let least = CrossingMap::of(tracer).least()?.unwrap();
            let above = CrossingMap::of(tracer).growth(least.x * (1.0 + 1e-7))?;
            assert_close(least.value, above.value, 1e-5);
            assert_close(least.slope, above.slope, 1e-4 * above.slope.abs());
            // The motion comes back to the release point or, if friction drives it, beyond.
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
            let least = CrossingMap::of(tracer).least()?.unwrap();
            let above = CrossingMap::of(tracer).growth(least.x * (1.0 + 1e-6))?;
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
        let ([lagging, leading], _) = CrossingMap::of(tracer).one_period(3.0)?.unwrap();
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
                    SlipPoint::leaving(&tracer.system(), start + by, direction),
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
        let fate = fate(tracer)?;
        let found = CrossingMap::of(tracer).roots(fate)?;
        assert_eq!((found.roots.len(), found.unresolved.len()), (1, 0));
        let force = found.roots[0];
        let multiplier = CrossingMap::of(tracer).cycle(force)?.unwrap().multiplier();
        let mut next = |force: f64| -> Result<f64, Error> {
            Ok(CrossingMap::of(tracer).one_period(force)?.unwrap().1)
        };
        assert_close(next(force)?, force, 1e-13);
        let difference = (next(force + 1e-5)? - next(force - 1e-5)?) / 2e-5;
        assert_close(multiplier, difference, 1e-7);
        assert!(multiplier < 0.999 && multiplier > 0.1);
        Ok(())
    });
}

#[test]
fn crossings_are_searched_to_sixteen_times_the_scale_of_a_system_and_no_further_than_twice_that() {
    for (v_b, unit) in [(0.2, 1.0), (0.5, 1.0), (0.2, 1e3), (0.2, 1e-3)] {
        let far = FARTHEST * (0.4 + v_b);
        for (force, lies_in) in [(0.1 * far, true), (0.95 * far, true), (3.0 * far, false)] {
            let system = rescaled(&driven(force, v_b), unit);
            traced(&system, |tracer| {
                let fate = fate(tracer)?;
                let found = CrossingMap::of(tracer).roots(fate)?;
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
        // The search ends after two forces, beyond what the belt velocity can feed, from which
        // motions shrink.
        (circles(0.4, 0.25, 0.2), 16..26),
        (circles(0.4, 0.1, 20.0), 54..75),
        (paper(0.2), 20..29),
        // The search goes as far as `FARTHEST`.
        (circles(0.4, -0.1, 0.2), 36..52),
        (circles(0.4, -0.1, 20.0), 76..100),
    ] {
        traced(&system, |tracer| {
            let fate = fate(tracer)?;
            let before = tracer.work();
            let found = CrossingMap::of(tracer).roots(fate)?;
            assert_eq!(found, Roots::default());
            let work = tracer.work() - before;
            assert!(steps.contains(&work), "{work} {system:?}");
            Ok(())
        });
    }
}

#[test]
fn crossings_beyond_the_last_breakpoint_are_found_where_those_below_shrink() {
    // At speeds above the knee friction drives the mass. Motions with forces from 0.5 to about 10
    // shrink.
    let law = *circles(0.12, 0.1, 1.0).law();
    for unit in [1.0, 64.0, 1.0 / 64.0] {
        let system = rescaled(&with_knee(law, 10.0, -0.5, 1.0), unit);
        traced(&system, |tracer| {
            let fate = fate(tracer)?;
            let found = CrossingMap::of(tracer).roots(fate)?;
            let [force] = found.roots[..] else {
                panic!("{found:?}")
            };
            let multiplier = CrossingMap::of(tracer).cycle(force)?.unwrap().multiplier();
            assert!(multiplier > 1.0);
            assert_eq!(CrossingMap::of(tracer).grows(0.99 * force)?, Some(false));
            assert_eq!(CrossingMap::of(tracer).grows(1.01 * force)?, Some(true));
            Ok(())
        });
    }
}

#[test]
fn without_friction_nothing_crosses_for_ever() {
    let found = traced(&system(0.0, [0.0; 3], 1.0, 0.1), |tracer| {
        let fate = fate(tracer)?;
        CrossingMap::of(tracer).roots(fate)
    });
    assert_eq!(found, Roots::default());
}
