//! Folds of outlines made by hand, and the number of outlines requested.

use approx::assert_abs_diff_eq;
use std::cell::RefCell;

use super::*;
use crate::friction::Exponential;
use crate::numerics::scan::refine;

/// An outline that is known to any reach.
fn outline(points: &[(f64, f64)]) -> Outline {
    Outline {
        surveyed: Vec::new(),
        seen: Vec::new(),
        points: points.to_vec(),
        reach: f64::INFINITY,
        bend: f64::INFINITY,
    }
}

fn window(points: &[(f64, f64)]) -> Window {
    outline(points).within(f64::INFINITY)
}

/// Outlines made by a function, which records the places at which it is called.
struct Made<F> {
    f: F,
    asked: RefCell<Vec<f64>>,
}

impl<F: Fn(f64) -> Outline> Growths for Made<F> {
    fn survey(&self, value: f64) -> Result<Outline, Error> {
        assert!(0.0 < value && value < 1.0, "{value}");
        self.asked.borrow_mut().push(value);
        Ok((self.f)(value))
    }

    fn sharpen(&self, _: f64, _: &mut Outline, _: f64) -> Result<(), Error> {
        Ok(())
    }

    fn turn(&self, _: f64, _: [f64; 2], _: bool) -> Result<Option<f64>, Error> {
        Ok(None)
    }
}

/// An outline with one turning point of this height in the middle, between ends at −1.
fn hump(height: f64) -> Outline {
    outline(&[(0.0, -1.0), (0.5, height), (1.0, -1.0)])
}

/// Folds over the belt velocities from 0 to 1, and the places at which outlines were requested.
fn folds(f: impl Fn(f64) -> Outline, halvings: u32) -> (Vec<f64>, Vec<f64>) {
    let (mut low, mut high) = ((0.0, f(0.0)), (1.0, f(1.0)));
    let made = Made {
        f,
        asked: RefCell::default(),
    };
    let mut folds = Folds {
        growths: &made,
        found: Vec::new(),
        doubtful: Vec::new(),
    };
    refine(&mut folds, &mut low, &mut high, halvings).unwrap();
    let found = folds.found;
    (found, made.asked.into_inner())
}

#[test]
fn outlines_are_alike_if_maxima_and_minima_come_in_the_same_order() {
    let up = window(&[(0.0, 0.0), (0.5, 1.0), (1.0, 0.5)]);
    let higher = window(&[(0.1, 3.0), (0.2, 9.0), (5.0, 1.0)]);
    let down = window(&[(0.0, 0.0), (0.5, -1.0), (1.0, 0.5)]);
    let longer = window(&[(0.0, 0.0), (0.5, 1.0), (0.7, 0.5), (1.0, 0.6)]);
    let none = window(&[]);
    assert!(up.is_like(&higher) && higher.is_like(&up) && none.is_like(&none));
    for (a, b) in [(&up, &down), (&up, &longer), (&up, &none), (&down, &none)] {
        assert!(!a.is_like(b) && !b.is_like(a));
    }
}

#[test]
fn turning_points_are_what_lies_between_the_ends() {
    let turns = |window: &Window| window.turns().collect::<Vec<_>>();
    let points = [(2.0, 0.1), (3.0, 0.5), (5.0, -0.5), (6.0, 0.2)];
    assert_eq!(turns(&window(&points)), [(0.25, 0.5), (0.75, -0.5)]);
    assert_eq!(turns(&window(&points[..2])), []);
    assert_eq!(turns(&window(&[])), []);
}

#[test]
fn ends_count_as_growing_above_zero() {
    let ends = |first, last| outline(&[(0.0, first), (0.5, 9.0), (1.0, last)]).at_ends();
    assert_eq!(ends(1.0, -1.0), [true, false]);
    assert_eq!(ends(-1.0, 1.0), [false, true]);
    assert_eq!(ends(0.0, 0.0), [false, false]);
    assert_eq!(outline(&[]).at_ends(), [false, false]);
}

#[test]
fn zeros_are_at_the_same_places_where_they_may_be() {
    let one = window(&[(0.0, -1.0), (0.4, -0.5), (0.6, 0.5), (1.0, 0.2)]);
    let other = window(&[(0.0, -2.0), (0.5, 0.1), (0.7, 0.05), (1.0, 1.0)]);
    let later = window(&[(0.0, -2.0), (0.6, -1.0), (0.8, -1.5), (1.0, 1.0)]);
    let none = window(&[(0.0, 1.0), (1.0, 2.0)]);
    assert_eq!(one.zeros(), [[0.4, 0.6]]);
    assert_eq!(other.zeros(), [[0.0, 0.5]]);
    assert_eq!(later.zeros(), [[0.8, 1.0]]);
    assert_eq!(none.zeros(), [[0.0; 2]; 0]);
    assert!(one.may_have_zeros_of(&other) && none.may_have_zeros_of(&none));
    assert!(!one.may_have_zeros_of(&later) && !one.may_have_zeros_of(&none));
    assert!(!window(&[]).may_have_zeros_of(&one) && window(&[]).may_have_zeros_of(&none));
}

/// A hump whose growth is known at nine places too.
fn surveyed(height: f64) -> Outline {
    let at = |i: usize| height - (1.0 + height) * (0.25 * i as f64 - 1.0).powi(2);
    Outline {
        surveyed: (0..9).map(at).collect(),
        ..hump(height)
    }
}

/// A turning point that moves by ten times its distance from zero, but evenly, needs two more
/// looks; one that turns back is followed.
#[test]
fn growth_that_moves_evenly_is_not_followed() {
    let (found, asked) = folds(|v_b| surveyed(0.1 + v_b), 16);
    assert_eq!((found.len(), asked.len()), (0, 2));
    let (found, asked) = folds(|v_b| surveyed((v_b - 0.4).powi(2) - 1e-4), 16);
    assert_eq!(found.len(), 2);
    assert!(asked.len() < 140, "{}", asked.len());
}

#[test]
fn what_lies_beyond_reach_is_cut_off() {
    let points = [
        (0.0, -9.0),
        (1.0, 3.0),
        (2.0, 2.0),
        (3.0, 4.0),
        (4.0, -0.5),
        (5.0, 0.5),
    ];
    let within = |reach| outline(&points).within(reach).0;
    assert_eq!(within(f64::INFINITY), points);
    // The dip from 3 to 2 and up again stays beyond.
    let cut = [(0.0, -1.0), (3.0, 1.0), (4.0, -0.5), (5.0, 0.5)];
    assert_eq!(within(1.0), cut);
    let cut = within(0.1).iter().map(|point| point.1).collect::<Vec<_>>();
    assert_eq!(cut, [-0.1, 0.1, -0.1, 0.1]);
}

#[test]
fn a_fold_is_where_the_growth_at_a_turning_point_is_zero() {
    for sign in [1.0, -1.0] {
        // The height changes so steeply that the first pass finds the root without division.
        let (found, asked) = folds(|v_b| hump(sign * (v_b - 0.3)), 16);
        assert_eq!(found.len(), 1);
        assert_abs_diff_eq!(found[0], 0.3, epsilon = 1e-15);
        assert!(asked.len() <= 60, "{}", asked.len());
    }
    let (found, asked) = folds(|v_b| hump(v_b + 1.0), 16);
    assert_eq!((found.len(), asked.len()), (0, 0));
}

#[test]
fn folds_of_several_turning_points_come_in_order() {
    let two = |v_b: f64| {
        outline(&[
            (0.0, -1.0),
            (0.3, 0.7 - v_b),
            (0.6, -2.0),
            (0.8, 0.2 - v_b),
            (1.0, -1.0),
        ])
    };
    let (found, _) = folds(two, 16);
    assert_eq!(found.len(), 2);
    assert!((found[0] - 0.2).abs() < 1e-15 && (found[1] - 0.7).abs() < 1e-15);
}

#[test]
fn two_folds_of_one_turning_point_are_found_where_it_comes_near_zero() {
    for sign in [1.0, -1.0] {
        let f = |v_b: f64| {
            outline(&[
                (0.0, -3.0 * sign),
                (0.5, sign * ((v_b - 0.4).powi(2) - 1e-4)),
                (1.0, -3.0 * sign),
            ])
        };
        let (found, asked) = folds(f, 16);
        assert_eq!(found.len(), 2);
        assert!((found[0] - 0.39).abs() < 1e-13 && (found[1] - 0.41).abs() < 1e-13);
        assert!(asked.len() < 140, "{}", asked.len());
    }
}

#[test]
fn a_turning_point_that_only_comes_near_zero_is_followed_to_a_limited_depth() {
    for depth in [4, 8] {
        let (found, asked) = folds(|v_b| hump(-(v_b - 0.3_f64).powi(2) - 1e-9), depth);
        assert_eq!(found, []);
        assert!(
            (depth as usize..6 * depth as usize).contains(&asked.len()),
            "{}",
            asked.len()
        );
        let closest = asked
            .iter()
            .map(|v_b| (v_b - 0.3).abs())
            .fold(1.0, f64::min);
        assert!(closest <= 0.5_f64.powi(depth as i32));
    }
}

#[test]
fn a_turning_point_that_moves_far_is_followed_more_closely() {
    let moving = |speed: f64| {
        move |v_b: f64| {
            outline(&[
                (0.0, -1.0),
                (0.2 + speed * v_b, 5.0 + 0.1 * v_b),
                (1.0, -1.0),
            ])
        }
    };
    assert_eq!(folds(moving(0.09), 16).1.len(), 0);
    assert_eq!(folds(moving(0.15), 16).1.len(), 1);
    assert_eq!(folds(moving(-0.15), 16).1.len(), 1);
    assert_eq!(folds(moving(0.3), 16).1.len(), 3);
}

#[test]
fn an_end_that_changes_its_sign_is_followed_to_the_last_division() {
    for (first, last) in [(1.0, 0.0), (0.0, 1.0)] {
        let f = |v_b: f64| {
            outline(&[
                (0.0, first * (v_b - 0.3) - 5.0 * last),
                (0.5, 5.0),
                (1.0, last * (v_b - 0.3) - 5.0 * first),
            ])
        };
        let (found, asked) = folds(f, 8);
        assert_eq!((found.len(), asked.len()), (0, 8));
    }
}

#[test]
fn turning_points_that_come_or_go_are_followed_to_the_last_division() {
    // There is no hump below 0.3. Above, its growth begins positive and falls through zero at 0.7.
    let f = |v_b: f64| {
        if v_b < 0.3 {
            outline(&[(0.0, -1.0), (1.0, -1.0)])
        } else {
            hump(0.7 - v_b)
        }
    };
    let (found, asked) = folds(f, 8);
    assert_eq!(found.len(), 1);
    assert_abs_diff_eq!(found[0], 0.7, epsilon = 1e-15);
    assert!(asked.len() < 70, "{}", asked.len());
    // For a while a dip takes the place of the hump: as many points, in another order.
    let f = |v_b: f64| {
        if v_b < 0.3 {
            hump(-2.0)
        } else {
            hump(0.7 - v_b)
        }
    };
    let (found, _) = folds(f, 8);
    assert_eq!(found.len(), 1);
    assert_abs_diff_eq!(found[0], 0.7, epsilon = 1e-15);
}

#[test]
fn a_growth_that_jumps_over_zero_is_no_fold() {
    for size in [1.0, 1e-8] {
        let (found, _) = folds(|v_b| hump(if v_b > 0.3 { size } else { -size }), 6);
        assert_eq!(found, []);
    }
    let (found, _) = folds(|v_b| hump(if v_b > 0.3 { 1e-10 } else { -1e-10 }), 6);
    assert_eq!(found.len(), 1);
    // A turning point that jumps over zero does not hide another that passes through.
    let two = |v_b: f64| {
        outline(&[
            (0.0, -1.0),
            (0.3, if v_b > 0.3 { 1.0 } else { -0.9 }),
            (0.6, -2.0),
            (0.8, 0.7 - v_b),
            (1.0, -1.0),
        ])
    };
    let (found, _) = folds(two, 6);
    assert_eq!(found.len(), 1);
    assert_abs_diff_eq!(found[0], 0.7, epsilon = 1e-15);
}

#[test]
fn a_growth_of_zero_counts_as_one_that_dies() {
    // If the fold lies where two ranges meet, only the upper range reports it.
    assert_eq!(folds(hump, 4).0.len(), 1);
    assert_eq!(folds(|v_b| hump(v_b - 1.0), 4).0.len(), 0);
}

#[test]
fn folds_of_a_system_lie_in_the_range_asked_for() {
    let system = Exponential::new(0.4, 0.3, 1.0)
        .and_then(|law| MassOnBelt::new(law, 1.4)?.with_damping(0.02))
        .unwrap();
    let fold = 1.457_823_592_457_963_272;
    let found = fold_velocities(&system, 1.45..1.46).unwrap();
    assert_eq!(found.len(), 1);
    assert_abs_diff_eq!(found[0], fold, epsilon = 1e-13);
    // The range need not be a multiple of its parts, nor the fold inside a narrow one.
    let found = fold_velocities(&system, fold - 1e-5..fold + 3e-6).unwrap();
    assert_eq!(found.len(), 1);
    assert_eq!(fold_velocities(&system, fold + 1e-5..1.46).unwrap(), []);
}
