//! Sign changes of functions that are known in closed form, and the number of evaluations.

use super::*;
use approx::assert_abs_diff_eq;

/// A place a third of the way into one of the 64 intervals, and so a third or two thirds of the way
/// into each of its halves.
const MIDDLE: f64 = 0.5 + 1.0 / 192.0;

/// Sign changes, and the places at which the function was asked.
fn scan(range: std::ops::Range<f64>, f: impl Fn(f64) -> Option<f64>) -> (Vec<f64>, Vec<f64>) {
    let (mut asked, mut roots) = (Vec::new(), Vec::new());
    let mut counted = |x| {
        asked.push(x);
        Ok(f(x))
    };
    sign_changes(&mut counted, &range, &mut roots).unwrap();
    assert!(asked.iter().all(|&x| range.start <= x && x <= range.end));
    (roots, asked)
}

#[test]
fn a_range_is_first_divided_into_equal_parts() {
    for range in [0.0..1.0, 0.1..0.7, 3.0..3.3, 1e-3..1e3] {
        let (roots, asked) = scan(range.clone(), |_| Some(1.0));
        assert_eq!((roots.len(), asked.len()), (0, 65));
        // Both ends to the last bit.
        assert_eq!((asked[0], asked[64]), (range.start, range.end));
        let width = (range.end - range.start) / 64.0;
        for pair in asked.windows(2) {
            assert!((pair[1] - pair[0] - width).abs() <= 4.0 * f64::EPSILON * range.end);
        }
    }
}

#[test]
fn sign_changes_are_found_to_the_last_bit() {
    for root in [0.1, 0.333, 0.5, 0.77, 0.999] {
        // The lower of the two neighbours between which the sign changes.
        let (roots, asked) = scan(0.0..1.0, |x| Some(x - root));
        assert_eq!(roots, [root]);
        assert!(asked.len() < 80, "{}", asked.len());
        let (roots, _) = scan(0.0..1.0, |x| Some(root - x));
        assert_eq!(roots, [root.next_down()]);
        let (roots, _) = scan(0.0..1.0, |x| Some((x - root).powi(3)));
        assert_eq!(roots, [root]);
    }
    let (roots, _) = scan(0.0..10.0, |x| Some(x.sin()));
    assert_eq!(roots.len(), 4);
    for (k, root) in std::iter::zip(0_u8.., roots) {
        assert_abs_diff_eq!(root, std::f64::consts::PI * f64::from(k), epsilon = 4e-15);
    }
}

#[test]
fn where_a_range_is_cut_a_root_is_found_once() {
    for cut in [0.25, 0.3, 0.5, 1.0 / 3.0] {
        for sign in [1.0, -1.0] {
            let find = |range| scan(range, |x| Some(sign * (x - cut))).0;
            let (below, above) = (find(0.0..cut), find(cut..1.0));
            assert_eq!(below.len() + above.len(), 1, "{cut} {sign}");
            assert_eq!([below, above].concat(), find(0.0..1.0));
        }
    }
}

#[test]
fn two_roots_within_one_part_are_found() {
    for width in [1e-3, 1e-4, 3e-5] {
        for sign in [1.0, -1.0] {
            let (roots, asked) = scan(0.0..1.0, |x| {
                Some(sign * ((x - MIDDLE).powi(2) - width * width))
            });
            assert_eq!(roots.len(), 2, "{width}");
            assert!((roots[0] - MIDDLE + width).abs() < 1e-11);
            assert_abs_diff_eq!(roots[1] - MIDDLE, width, epsilon = 1e-11);
            assert!(asked.len() < 220, "{}", asked.len());
        }
    }
}

/// The function has equal values at both ends of the part that holds its roots.
#[test]
fn two_roots_in_the_middle_of_one_part_are_found() {
    for (place, width) in [(32.5, 0.4), (32.5, 0.25), (10.4, 0.3), (50.6, 0.3)] {
        for sign in [1.0, -1.0] {
            let middle = place / 64.0;
            let width = width / 64.0;
            let (roots, asked) = scan(0.0..1.0, |x| {
                Some(sign * ((x - middle).powi(2) - width * width))
            });
            assert_eq!(roots.len(), 2, "{place} {width}");
            assert!((roots[0] - middle + width).abs() < 1e-11);
            assert_abs_diff_eq!(roots[1] - middle, width, epsilon = 1e-11);
            assert!(asked.len() < 120, "{}", asked.len());
        }
    }
}

#[test]
fn a_function_that_only_comes_near_zero_is_divided_a_limited_number_of_times() {
    let (roots, asked) = scan(0.0..1.0, |x| Some((x - MIDDLE).powi(2) + 1e-12));
    assert_eq!(roots, []);
    // Ten times at the lowest place; a few times beside it.
    assert!((90..140).contains(&asked.len()), "{}", asked.len());
    let finest = asked.iter().map(|x| (x - MIDDLE).abs()).fold(1.0, f64::min);
    assert!(finest < 1.0 / 64.0 / 1024.0);
}

#[test]
fn nothing_is_looked_for_where_a_function_is_zero_to_rounding() {
    for size in [0.0, 1e-15, 1e-14] {
        let (roots, asked) = scan(0.0..1.0, |x| Some(size * (100.0 * x).sin()));
        assert_eq!((roots.len(), asked.len()), (0, 65));
    }
    let (roots, _) = scan(0.0..1.0, |x| Some(2e-14 * (x - 0.3)));
    assert_eq!(roots, []);
    let (roots, _) = scan(0.0..1.0, |x| Some(1e-11 * (x - 0.3)));
    assert_eq!(roots, [0.3]);
    // The function has to be zero to rounding at both ends of an interval.
    let (roots, _) = scan(0.0..1.0, |x| Some(if x > 0.3 { 1.0 } else { -1e-15 }));
    assert_eq!(roots, [0.3]);
}

#[test]
fn the_border_of_where_a_function_is_defined_is_halved_ten_times() {
    let border = 0.3;
    for (start, end) in [(0.0, border), (border, 1.0)] {
        let defined = |x| (start <= x && x <= end).then_some(1.0);
        let (roots, asked) = scan(0.0..1.0, defined);
        assert_eq!((roots.len(), asked.len()), (0, 75));
        let closest = asked.iter().map(|x| (x - border).abs()).fold(1.0, f64::min);
        assert!(closest <= 1.0 / 64.0 / 1024.0);
    }
    let (roots, asked) = scan(0.0..1.0, |_| None);
    assert_eq!((roots.len(), asked.len()), (0, 65));
}

#[test]
fn a_root_next_to_where_a_function_ends_is_found() {
    for (root, end) in [(0.3, 0.301), (0.3, 0.3001)] {
        let (roots, _) = scan(0.0..1.0, |x| (x < end).then_some(x - root));
        assert_eq!(roots, [root]);
        let (roots, _) = scan(0.0..1.0, |x| (x > root - (end - root)).then_some(x - root));
        assert_eq!(roots, [root]);
    }
}

#[test]
fn a_gap_is_no_root_but_one_beside_it_is() {
    // A function that goes from −1 to 1 through a gap.
    let (roots, asked) = scan(0.0..1.0, |x| {
        (!(0.3..0.301).contains(&x)).then_some(if x < 0.3 { -1.0 } else { 1.0 })
    });
    assert_eq!(roots, []);
    assert!(asked.len() < 90, "{}", asked.len());
    let (roots, _) = scan(0.0..1.0, |x| {
        (!(0.3..0.301).contains(&x)).then_some(x - 0.302)
    });
    assert_eq!(roots, [0.302]);
}

#[test]
fn a_jump_over_zero_is_a_root() {
    for place in [0.1, 0.5, 0.77] {
        let (roots, _) = scan(0.0..1.0, |x| Some(if x > place { 1.0 } else { -1.0 }));
        assert_eq!(roots, [place]);
        let (roots, _) = scan(0.0..1.0, |x| Some(if x > place { -0.1 } else { 30.0 }));
        assert_eq!(roots, [place]);
    }
}

#[test]
fn an_error_ends_the_search() {
    let error = Error::InvalidDuration { value: 0.5 };
    let fails = |at: f64| {
        let mut found = Vec::new();
        let mut f = |x| {
            if x > at {
                Err(error.clone())
            } else {
                Ok(Some(x - 0.1))
            }
        };
        (sign_changes(&mut f, &(0.0..1.0), &mut found), found)
    };
    // What was found before is there.
    assert_eq!(fails(0.7), (Err(error.clone()), vec![0.1]));
    assert_eq!(fails(2.0), (Ok(()), vec![0.1]));
}
