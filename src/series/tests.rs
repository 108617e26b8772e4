use std::ops::ControlFlow;

use super::roots::Search;
use super::*;

/// The rounding error that a search assumes of a term: half an ε for each multiplication, and four
/// more.
#[test]
fn rounding_is_bounded_term_by_term() {
    for t in [0.25_f64, 1.0, 3.0] {
        let mut all = PowerSeries::ZERO;
        let mut sum = 0.0;
        for k in 0..TERMS {
            let mut c = PowerSeries::ZERO;
            c[k] = -0.7;
            let expected = f64::EPSILON * (0.5 * k as f64 + 4.0) * 0.7 * t.powi(k as i32);
            assert!((c.rounding_bound(t) / expected - 1.0).abs() < 1e-13, "{k}");
            (all[k], sum) = (c[k], sum + expected);
        }
        assert!((all.rounding_bound(t) / sum - 1.0).abs() < 1e-13);
    }
}

/// Most steps are settled by a look at their quarters, the others by a few halvings, and only a
/// root that is almost double takes many.
#[test]
fn searches_are_short() {
    let divisions = |c: &[f64], h: f64| {
        let c = PowerSeries::from(c);
        let values = c.at_four(quarters(h));
        let curvature = c.curvature_bound(h);
        let search = Search::new(&c, h, curvature);
        let _ = search.run(h, values, &mut |_, _| ControlFlow::Continue(()));
        (c.stays_away(h, values, curvature), search.divisions.get())
    };
    // |c''| = 2, and 2h²/128 = 1/16 for h = 2.
    assert_eq!(divisions(&[4.0 + 0.0626, -4.0, 1.0], 2.0), (true, 0));
    assert_eq!(divisions(&[4.0 + 0.0624, -4.0, 1.0], 2.0), (false, 1));
    assert_eq!(divisions(&[-4.0 - 0.0626, 4.0, -1.0], 2.0), (true, 0));
    // A simple root.
    assert_eq!(divisions(&[1.0, -1.0], 2.0), (false, 0));
    assert_eq!(divisions(&[1.0, 0.0, -1.2], 2.0), (false, 0));
    // Two roots, and two roots missed, ever closer.
    for (gap, most) in [(0.2, 3), (1e-2, 8), (1e-4, 21), (1e-6, 35)] {
        for sign in [1.0, -1.0] {
            let c = [0.16 - sign * gap * gap, -0.8, 1.0];
            let (away, divisions) = divisions(&c, 2.0);
            assert!(!away && divisions <= most, "{gap} {sign}: {divisions}");
        }
    }
}
