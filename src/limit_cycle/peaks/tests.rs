//! The map of velocity maxima, compared with closed forms.

use super::super::continuum::is_flat;
use super::super::testing::{
    System, assert_close, assert_noise, assert_slope, circles, fast, paper, repelling, rescaled,
    shrinks, spiral, system, traced, with_knee,
};
use super::*;
use crate::state::State;

#[test]
fn noise_of_a_turn_bounds_what_rounding_does_and_not_by_far() {
    for damping in [0.05, -0.05, -1e-3] {
        for v_b in [1e-3, 1.0, 1e3, 1e6] {
            let system = spiral(damping, v_b);
            for part in [1e-4, 0.5, 0.7] {
                traced(&system, |tracer| {
                    let growth = |peak| PeakMap::of(tracer).growth(peak).unwrap();
                    assert_noise(part * v_b, growth, |_| shrinks(damping) - 1.0);
                    Ok(())
                });
            }
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
                let growth = traced(&system, |tracer| PeakMap::of(tracer).growth(peak));
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
        let growth = traced(&system, |tracer| PeakMap::of(tracer).growth(peak));
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
                    let growth = PeakMap::of(tracer).growth(peak)?;
                    let value = |peak| PeakMap::of(tracer).growth(peak).unwrap().value;
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
    let grows = traced(&spiral(-0.1, 0.5), |tracer| PeakMap::of(tracer).growth(0.4));
    assert_eq!((grows.value, grows.slope < 0.0), (1.5, true));
    let dies = traced(&spiral(1.2, 0.5), |tracer| PeakMap::of(tracer).growth(0.4));
    assert_eq!((dies.value, dies.slope), (-1.0, 0.0));
}

#[test]
fn the_largest_peak_comes_back_grazing_the_belt() {
    for v_b in [0.2, 3.0] {
        // If motions grow, the largest peak is the one before grazing; this motion grows by the
        // same factor as every other.
        let largest = traced(&spiral(-0.1, v_b), |tracer| PeakMap::of(tracer).largest()).unwrap();
        assert_close(largest.x, v_b / shrinks(-0.1), largest.noise * v_b);
        assert_close(largest.value, shrinks(-0.1) - 1.0, largest.noise);
        assert_close(largest.slope * largest.x, 0.0, largest.noise);
        // If motions die, the largest peak is the belt velocity itself.
        let largest = traced(&spiral(0.1, v_b), |tracer| PeakMap::of(tracer).largest()).unwrap();
        assert_eq!(largest.x, v_b);
        assert_close(largest.value, shrinks(0.1) - 1.0, largest.noise);
    }
    // Near an unstable node no motion turns, and the grazing motion comes straight from the node.
    let none = traced(&spiral(-1.5, 1.0), |tracer| PeakMap::of(tracer).largest());
    assert_eq!(none, None);
}

#[test]
fn the_slope_at_the_largest_peak_is_that_of_the_growth_just_below() {
    let system = paper(0.3);
    traced(&system, |tracer| {
        let largest = PeakMap::of(tracer).largest()?.unwrap();
        let below = PeakMap::of(tracer).growth(largest.x * (1.0 - 1e-6))?;
        assert_close(largest.value, below.value, 1e-5 * largest.value);
        // The slope changes fast near the largest peak.
        assert_close(largest.slope, below.slope, 1e-2 * largest.slope.abs());
        Ok(())
    });
}

#[test]
fn peaks_are_searched_from_a_ten_thousandth_of_the_belt_velocity_to_the_largest() {
    for v_b in [0.2, 3.0] {
        let [smallest, largest] =
            traced(&spiral(-0.1, v_b), |tracer| PeakMap::of(tracer).range()).unwrap();
        assert_close(smallest.x, 1e-4 * v_b, 1e-18 * v_b);
        assert_close(largest.x, v_b / shrinks(-0.1), 1e-13 * v_b);
        for end in [smallest, largest] {
            assert_close(end.value, shrinks(-0.1) - 1.0, end.noise);
        }
        let [_, largest] = traced(&spiral(0.1, v_b), |tracer| PeakMap::of(tracer).range()).unwrap();
        assert_eq!(largest.x, v_b);
        // All motions grow to the belt, by a factor of more than 10⁴ a turn.
        assert_eq!(
            traced(&spiral(-0.9, v_b), |tracer| PeakMap::of(tracer).range()),
            None
        );
        // Here the factor is smaller.
        let [_, largest] =
            traced(&spiral(-0.7, v_b), |tracer| PeakMap::of(tracer).range()).unwrap();
        assert_close(largest.x, v_b / shrinks(-0.7), 1e-12 * v_b);
    }
}

#[test]
fn the_outline_of_a_straight_growth_has_only_ends() {
    let outline = |rate: f64| {
        traced(&spiral(rate, 2.0), |tracer| {
            let mut peaks = PeakMap::of(tracer);
            let mut seen = peaks.survey()?;
            peaks.outline(&mut seen, f64::INFINITY)
        })
    };
    let found = outline(-0.1);
    let [(first, low), (last, high)] = found[..] else {
        panic!("{found:?}")
    };
    assert_close(first, 2e-4, 1e-15);
    assert_close(last, 2.0 / shrinks(-0.1), 1e-12);
    assert_close(low, shrinks(-0.1) - 1.0, 1e-9);
    assert_close(high, shrinks(-0.1) - 1.0, 1e-13);
    assert_eq!(outline(-0.9), []);
}

#[test]
fn cycles_in_slip_close_whether_they_attract_or_repel() {
    let strongly = repelling(0.3, 2.0);
    let (repelling, attracting) = (repelling(0.3, 0.9), paper(0.43));
    for (system, grows) in [(repelling, true), (strongly, true), (attracting, false)] {
        traced(&system, |tracer| {
            let found = PeakMap::of(tracer).roots()?;
            let [peak] = found.roots[..] else {
                panic!("{found:?}")
            };
            let (arc, multiplier) = PeakMap::of(tracer).cycle(peak)?;
            assert_eq!(multiplier > 1.0, grows, "{multiplier}");
            // P(V)/V − 1 is zero there, and so P' = 1 + V times its slope.
            let growth = PeakMap::of(tracer).growth(peak)?;
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
    let is_flat = |system: &System| traced(system, |tracer| Ok(is_flat(&tracer.system())));
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
    let is_continuum =
        |system: &System| traced(system, |tracer| PeakMap::of(tracer).is_continuum());
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
    let grows = |system: &System, peak| traced(system, |tracer| PeakMap::of(tracer).grows(peak));
    for peak in [0.01, 0.3] {
        assert_eq!(grows(&spiral(-0.01, 1.0), peak), Some(true));
        assert_eq!(grows(&spiral(0.01, 1.0), peak), Some(false));
    }
    for peak in [1e-6, 0.3] {
        // The growth over a turn is 1e-16 or less.
        assert_eq!(grows(&spiral(-2e-17, 1.0), peak), None);
        assert_eq!(grows(&spiral(2e-17, 1.0), peak), None);
    }
    let system = repelling(0.3, 0.9);
    assert!(system.equilibrium().unwrap().is_stable());
    let [peak] = traced(&system, |tracer| PeakMap::of(tracer).roots()).roots[..] else {
        panic!()
    };
    assert_eq!(grows(&system, 0.9 * peak), Some(false));
    assert_eq!(grows(&system, peak + 0.1 * (0.5 - peak)), Some(true));
}
