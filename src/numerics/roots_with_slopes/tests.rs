use approx::assert_abs_diff_eq;
use std::cell::Cell;
use std::f64::consts::{PI, SQRT_2};

use super::*;

/// The sample of a function and its derivative.
fn sample(x: f64, value: f64, slope: f64) -> Sample {
    Sample {
        x,
        value,
        slope,
        noise: 0.0,
        work: 0,
    }
}

/// A cubic that turns at r and q, where its slope k(x − r)(x − q) vanishes.
#[derive(Debug, Clone, Copy)]
struct Cubic {
    k: f64,
    r: f64,
    q: f64,
    offset: f64,
}

impl Cubic {
    fn at(self, x: f64) -> Sample {
        let Self { k, r, q, offset } = self;
        let value = offset + k * (x * x * x / 3.0 - (r + q) * x * x / 2.0 + r * q * x);
        sample(x, value, k * (x - r) * (x - q))
    }
}

/// Cubics and intervals: both turns inside, one or none, and the middle of the turns inside or
/// outside.
fn cubics() -> impl Iterator<Item = (Cubic, f64, f64)> {
    let signs = [1.0, -1.0, 0.3];
    let turns = [(-1.1, 0.7), (0.2, 0.9), (-2.0, 2.5)];
    let intervals = [
        (-1.7, 1.9),
        (0.0, 2.0),
        (-0.5, 0.5),
        (-3.0, 0.3),
        (3.0, 4.0),
        (0.3, 0.8),
    ];
    signs.into_iter().flat_map(move |k| {
        turns.into_iter().flat_map(move |(r, q)| {
            intervals.into_iter().flat_map(move |(a, b)| {
                let cubic = move |offset| (Cubic { k, r, q, offset }, a, b);
                [-0.4, 3.0].into_iter().map(cubic)
            })
        })
    })
}

/// Calls a function and counts how often.
struct Counted<F> {
    f: F,
    calls: Cell<usize>,
}

impl<F: Fn(f64) -> Sample> Counted<F> {
    fn new(f: F) -> Self {
        Self {
            f,
            calls: Cell::new(0),
        }
    }

    /// Returns the result of the search, and the number of its evaluations.
    fn roots(&self, a: f64, b: f64) -> (Roots, usize) {
        self.roots_with(&|_, _| None, a, b)
    }

    fn roots_with(&self, kinks: KinksBetween<'_>, a: f64, b: f64) -> (Roots, usize) {
        let mut found = Roots::default();
        let mut f = |x| {
            self.calls.set(self.calls.get() + 1);
            Ok((self.f)(x))
        };
        let (low, high) = ((self.f)(a), (self.f)(b));
        roots_between(&mut f, kinks, low, high, &mut found).unwrap();
        (found, self.calls.get())
    }

    fn outline(&self, a: f64, b: f64) -> (Vec<TurningPoint>, usize) {
        self.outline_within(a, b, f64::INFINITY)
    }

    fn outline_within(&self, a: f64, b: f64, reach: f64) -> (Vec<TurningPoint>, usize) {
        let mut f = |x| {
            self.calls.set(self.calls.get() + 1);
            Ok((self.f)(x))
        };
        let outline = outline_between(&mut f, (self.f)(a), (self.f)(b), reach).unwrap();
        (outline, self.calls.get())
    }
}

#[test]
fn the_cubic_through_both_ends_is_a_cubic() {
    for (cubic, a, b) in cubics() {
        let (fits, error) = fits(cubic.at(a), cubic.at(0.5 * (a + b)), cubic.at(b));
        assert!(fits && error < 1e-13, "{cubic:?} on {a}..{b}: {error}");
    }
}

#[test]
fn what_the_cubic_misses_is_told() {
    // For (x − c)⁴ the cubic's value in the middle is wrong by h⁴; for (x − c)⁵ the value is right
    // and the slope is wrong by h⁴.
    for (c, h) in [(0.0, 1.0), (3.0, 0.5), (-2.0, 2.0_f64)] {
        let fourth = |x: f64| sample(x, (x - c).powi(4), 4.0 * (x - c).powi(3));
        let fifth = |x: f64| sample(x, (x - c).powi(5), 5.0 * (x - c).powi(4));
        let missed = |f: &dyn Fn(f64) -> Sample| fits(f(c - h), f(c), f(c + h));
        assert_eq!(missed(&fourth), (false, h.powi(4)));
        let (fits, error) = missed(&fifth);
        assert!(!fits && (error - 0.25 * h.powi(5)).abs() < 1e-15);
    }
}

#[test]
fn it_fits_within_a_fiftieth_of_the_variation_and_the_value_and_noise() {
    for sign in [1.0, -1.0] {
        let ends = [0.0, 1.0].map(|x| sample(x, sign * x, sign));
        let middle = |off: f64, noise: f64| Sample {
            noise,
            ..sample(0.5, sign * (0.5 + off), sign)
        };
        // off ≤ 0.02·(1 + 0.5 + off) + noise
        let limit = |noise: f64| (0.03 + noise) / 0.98;
        for noise in [0.0, 0.1] {
            assert!(fits(ends[0], middle(limit(noise) - 1e-9, noise), ends[1]).0);
            assert!(!fits(ends[0], middle(limit(noise) + 1e-9, noise), ends[1]).0);
        }
    }
}

#[test]
fn a_cubic_turns_twice_where_both_turns_lie_inside() {
    for (cubic, a, b) in cubics() {
        let Cubic { k, r, q, .. } = cubic;
        let expected = a < r && q < b;
        assert_eq!(
            turns_twice(cubic.at(a), cubic.at(b)),
            expected,
            "{cubic:?} on {a}..{b}"
        );
        // Steepest between the turns: k(q − r)²/4, times the width.
        let steepest = k.abs() * (q - r).powi(2) / 4.0 * (b - a);
        for (noises, hides) in [
            ([0.99, 0.0], false),
            ([1.01, 0.0], true),
            ([0.0, 1.01], true),
        ] {
            let [low, high] = [(a, noises[0]), (b, noises[1])].map(|(x, noise)| Sample {
                noise: noise * steepest,
                ..cubic.at(x)
            });
            assert_eq!(turns_twice(low, high), expected && !hides);
        }
    }
    // One that never turns.
    let rising = |x: f64| sample(x, x.powi(3) + 0.1 * x, 3.0 * x * x + 0.1);
    assert!(!turns_twice(rising(-1.0), rising(0.8)));
}

#[test]
fn a_root_passed_one_way_has_slopes_that_fit_the_change() {
    for sign in [1.0, -1.0] {
        // The secant has the slope 4·sign.
        let way = |p: f64, q: f64| {
            let ends = [(2.0, -0.5, p), (2.25, 0.5, q)];
            let [a, b] = ends.map(|(x, value, slope)| sample(x, sign * value, sign * 4.0 * slope));
            one_way(a, b)
        };
        assert!(way(0.01, 0.01) && way(2.99, 2.99) && way(2.99, 0.01) && way(0.01, 2.99));
        assert!(!way(-0.01, 1.0) && !way(1.0, -0.01) && !way(3.01, 1.0) && !way(1.0, 3.01));
        assert!(!way(0.0, 1.0) && !way(1.0, 3.0));
    }
}

#[test]
fn a_root_passed_in_noise_is_not_passed_one_way() {
    let a = |slope: f64, value: f64| Sample {
        noise: 1e-3,
        ..sample(2.0, value, slope)
    };
    let b = |slope: f64| sample(2.01, 4e-3, slope);
    // A slope counts as rounding if the change that it makes over x itself, relative to the value,
    // is at most ten times the noise.
    assert!(one_way(a(5.1e-3, -1e-3), b(0.5)));
    assert!(!one_way(a(4.9e-3, -1e-3), b(0.5)));
    assert!(one_way(a(4.9e-3, -1.1e-3), b(0.5)));
}

#[test]
fn the_lowest_point_of_a_cubic_is_found() {
    for (cubic, a, b) in cubics() {
        let (low, high) = (cubic.at(a), cubic.at(b));
        if low.value * high.value <= 0.0 {
            continue;
        }
        let turns = [cubic.r, cubic.q].into_iter();
        let expected = turns
            .filter(|turn| (a..=b).contains(turn))
            .map(|turn| low.value.signum() * cubic.at(turn).value)
            .fold(f64::INFINITY, f64::min);
        let found = lowest(low, high);
        assert!(
            found == expected || (found - expected).abs() < 1e-12,
            "{cubic:?} on {a}..{b}: {found}, {expected}"
        );
    }
    // Parabolas, and a cubic that never turns.
    let parabola = |x: f64| sample(x, (x - 1.0) * (x - 1.0) + 0.25, 2.0 * (x - 1.0));
    assert_abs_diff_eq!(lowest(parabola(0.0), parabola(3.0)), 0.25, epsilon = 1e-15);
    assert_abs_diff_eq!(lowest(parabola(-1.0), parabola(1.5)), 0.25, epsilon = 1e-15);
    let rising = |x: f64| sample(x, 5.0 + x.powi(3) + x, 3.0 * x * x + 1.0);
    assert_eq!(lowest(rising(-1.0), rising(0.8)), f64::INFINITY);
}

#[test]
fn rounding_hides_a_root_beside_an_end_or_where_the_cubic_is_lowest() {
    let noisy = |x: f64, value: f64, slope: f64| Sample {
        noise: 1e-3,
        ..sample(x, value, slope)
    };
    let (positive, negative) = (noisy(0.0, 0.1, 0.0), noisy(1.0, -0.1, 0.0));
    assert!(!hidden(positive, negative, 1e-3));
    assert!(hidden(noisy(0.0, 1e-3, 0.0), negative, 1e-3));
    assert!(hidden(positive, noisy(1.0, -1e-3, 0.0), 1e-3));
    // x² + d, lowest at 0 with the value d, of either sign.
    for sign in [1.0, -1.0] {
        let valley = |x: f64, d: f64| noisy(x, sign * (x * x + d), sign * 2.0 * x);
        let hides = |d: f64| hidden(valley(-1.0, d), valley(0.5, d), 1e-3);
        assert!(hides(0.9e-3) && hides(-0.9e-3));
        assert!(!hides(1.1e-3) && !hides(-1.1e-3));
    }
}

#[test]
fn ranges_that_meet_are_one() {
    let mut found = Roots::default();
    found.leave(0.0..1.0);
    found.leave(1.0..1.5);
    found.leave(2.0..3.0);
    assert_eq!(found.unresolved, [0.0..1.5, 2.0..3.0]);
}

/// Every root is found to rounding, in order, and at few points.
#[test]
fn simple_roots_are_found_in_few_evaluations() {
    let sine = Counted::new(|x: f64| sample(x, (3.0 * x).sin(), 3.0 * (3.0 * x).cos()));
    let (found, calls) = sine.roots(0.5, 6.0);
    assert_eq!(found.unresolved, []);
    assert_eq!(found.roots.len(), 5);
    for (i, root) in found.roots.iter().enumerate() {
        let exact = (i + 1) as f64 * PI / 3.0;
        assert!((root - exact).abs() <= 4e-16 * exact, "{root}");
    }
    assert!(calls <= 36, "{calls}");

    let square = Counted::new(|x: f64| sample(x, 2.0 - x * x, -2.0 * x));
    let (found, calls) = square.roots(1.0, 2.0);
    assert_abs_diff_eq!(found.roots[0], SQRT_2, epsilon = 3e-16);
    assert!(calls <= 5, "{calls}");

    // A root in the middle of an interval is found to the bit.
    let line = Counted::new(|x: f64| sample(x, x - 1.5, 1.0));
    let (found, calls) = line.roots(1.0, 2.0);
    assert_eq!(found.roots, [1.5]);
    assert!(calls <= 1, "{calls}");
}

#[test]
fn two_roots_that_are_almost_one_are_both_found_or_neither() {
    let valley = |d: f64| {
        Counted::new(move |x: f64| {
            let y = x - 1.234;
            sample(x, y * y * (1.0 + 0.1 * y) - d, 2.0 * y + 0.3 * y * y)
        })
    };
    for half in [1e-2, 1e-4, 1e-6, 1e-7] {
        let (found, calls) = valley(half * half).roots(0.0, 2.0);
        let [low, high] = found.roots[..] else {
            panic!("{half}: {found:?}")
        };
        assert!(
            ((high - low) / (2.0 * half) - 1.0).abs() < 1e-2,
            "{half}: {low} {high}"
        );
        assert_eq!(found.unresolved, []);
        assert!(calls <= 32, "{calls}");
        let (found, calls) = valley(-half * half).roots(0.0, 2.0);
        assert_eq!(found, Roots::default());
        assert!(calls <= 1, "{calls}");
    }
}

#[test]
fn a_root_of_third_order_and_a_pole_end() {
    // Newton's method alone gains a third of the distance a time.
    let flat = Counted::new(|x: f64| {
        let y = x - 1.3;
        sample(x, y * y * y, 3.0 * y * y)
    });
    let (found, calls) = flat.roots(1.0, 2.0);
    assert!((found.roots[0] - 1.3).abs() < 1e-6, "{found:?}");
    assert!(calls <= 57, "{calls}");

    let jump = Counted::new(|x: f64| sample(x, if x < 1.3 { -1.0 } else { 1.0 }, 0.0));
    let (found, calls) = jump.roots(1.0, 2.0);
    assert_eq!(found.roots, []);
    let [range] = &found.unresolved[..] else {
        panic!("{found:?}")
    };
    assert!(range.start < 1.3 && 1.3 <= range.end && range.end - range.start <= 2e-9);
    assert!(calls <= 81, "{calls}");
}

#[test]
fn what_rounding_hides_is_left_and_nothing_beside_it() {
    // Zero to rounding over a stretch.
    let dead = Counted::new(|x: f64| {
        let y = (x - 1.0).max(0.0) + (x - 0.5).min(0.0);
        Sample {
            noise: 1e-12,
            ..sample(x, y * y * y, 3.0 * y * y)
        }
    });
    let (found, calls) = dead.roots(0.0, 1.6);
    assert_eq!(found.roots, []);
    let [range] = &found.unresolved[..] else {
        panic!("{found:?}")
    };
    assert!(0.4 <= range.start && range.start <= 0.5, "{range:?}");
    assert!(1.0 <= range.end && range.end <= 1.11, "{range:?}");
    assert!(calls <= 10, "{calls}");

    // A parabola that may touch zero is reported, and not divided without end.
    let touch = Counted::new(|x: f64| Sample {
        noise: 1e-9,
        ..sample(x, (x - 0.7) * (x - 0.7), 2.0 * (x - 0.7))
    });
    let (found, calls) = touch.roots(0.0, 1.6);
    assert_eq!(found.roots, []);
    let [range] = &found.unresolved[..] else {
        panic!("{found:?}")
    };
    assert!(range.contains(&0.7));
    assert!(calls <= 1, "{calls}");
}

/// f = x − k − J(x − k)^(3/2) + c, without the third term below the kink k, comes above zero
/// between two places that lie close together.
#[test]
fn functions_are_divided_at_their_kinks() {
    let mut lost = 0;
    for i in 0..2000 {
        let kink = 0.05 + 0.9 * f64::from(i) / 2000.0;
        let jump = 2.0 + 0.02 * f64::from(i % 300);
        let turns = (2.0 / (3.0 * jump)).powi(2);
        let bent = |x: f64| {
            let beyond = (x - kink).max(0.0);
            let value = x - kink - jump * beyond.powf(1.5) - 0.3 * turns;
            sample(x, value, 1.0 - 1.5 * jump * beyond.sqrt())
        };
        let kinks = |a: f64, b: f64| {
            let error = 2.0 * jump * (b - kink).powf(0.5) * (b - a);
            (a < kink && kink < b).then_some(Kinks { x: kink, error })
        };
        let (found, calls) = Counted::new(bent).roots_with(&kinks, 0.0, 1.0);
        let expected = if bent(1.0).value < 0.0 { 2 } else { 1 };
        assert_eq!(found.roots.len(), expected, "{i}: {found:?}");
        assert!(found.unresolved.is_empty() && calls < 100, "{i}: {calls}");
        lost += usize::from(Counted::new(bent).roots(0.0, 1.0).0.roots.len() != expected);
    }
    assert!(lost > 0);
}

/// f = c − x beyond k, and rises by 10⁷ below k, which lies 10⁻¹⁰ below c: a sample beside the root
/// c, whose slope is of that root, is none of the other.
#[test]
fn a_steep_root_beside_a_flat_one_keeps_its_place() {
    let (c, below) = (0.5, 1e-10);
    let corner = |x: f64| {
        let under = (x - (c - below)).min(0.0);
        // Positive at c, by less than a number near c can be told apart.
        let value = (c - x) + 1e-17 + 1e7 * under;
        let slope = if under < 0.0 { 1e7 - 1.0 } else { -1.0 };
        sample(x, value, slope)
    };
    let (found, _) = Counted::new(corner).roots(0.0, 1.0);
    let [steep, flat] = found.roots[..] else {
        panic!("{found:?}")
    };
    assert!((steep - (c - below)).abs() < 1e-15, "{steep:e}");
    assert!((flat - c).abs() < 1e-15, "{flat:e}");
}

#[test]
fn work_is_bounded() {
    let spent = Cell::new(MOST_WORK - 1000);
    let waves = Counted::new(|x: f64| {
        spent.set(spent.get() + 10);
        Sample {
            work: spent.get(),
            ..sample(x, (1e4 * x).sin(), 1e4 * (1e4 * x).cos())
        }
    });
    let (found, calls) = waves.roots(0.01, 1.0);
    assert!((100..200).contains(&calls), "{calls}");
    assert!(!found.unresolved.is_empty());
    // Every root found is a root, and all others lie in the unresolved ranges.
    assert!(found.roots.iter().all(|x| (1e4 * x).sin().abs() < 1e-9));
    for i in 32..=3183 {
        let root = f64::from(i) * PI / 1e4;
        let told = found.roots.iter().any(|x| (x - root).abs() < 1e-12)
            || found.unresolved.iter().any(|range| range.contains(&root));
        assert!(told, "{root}");
    }
}

#[test]
fn the_outline_holds_the_ends_and_every_turn() {
    let wave = Counted::new(|x: f64| Sample {
        noise: 1e-15,
        ..sample(x, (3.0 * x).sin() + x, 3.0 * (3.0 * x).cos() + 1.0)
    });
    let (outline, calls) = wave.outline(0.0, 6.0);
    let first = (-1.0_f64 / 3.0).acos() / 3.0;
    let turns: Vec<f64> = (0..3)
        .flat_map(|i| {
            let period = 2.0 * PI / 3.0 * f64::from(i);
            [period + first, period + 2.0 * PI / 3.0 - first]
        })
        .collect();
    assert_eq!(outline.len(), turns.len() + 2);
    assert_eq!((outline[0].x, outline[turns.len() + 1].x), (0.0, 6.0));
    for (turn, exact) in outline[1..].iter().zip(&turns) {
        let (value, curvature) = ((3.0 * exact).sin() + exact, 9.0 * (3.0 * exact).sin());
        let allowed = 0.01 * value;
        assert!((turn.value - value).abs() <= allowed, "{turn:?}, {exact}");
        assert!(curvature.abs() * (turn.x - exact).powi(2) < 2.1 * allowed);
    }
    assert!(calls <= 120, "{calls}");

    let rising = Counted::new(|x: f64| sample(x, x.exp(), x.exp()));
    let (outline, calls) = rising.outline(0.0, 1.0);
    assert_eq!(outline.len(), 2);
    assert_eq!(calls, 7);
}

/// A least and a largest value where a sample is taken, whose slope is exactly 0.
#[test]
fn a_turn_at_a_sample_is_one_turn() {
    for sign in [1.0, -1.0] {
        let parabola = Counted::new(|x: f64| sample(x, sign * (1.0 + x * x), sign * 2.0 * x));
        let (outline, _) = parabola.outline(-1.0, 1.0);
        let values: Vec<f64> = outline.iter().map(|turn| sign * turn.value).collect();
        assert_eq!(values.len(), 3, "{values:?}");
        // A turn is found to a hundredth.
        assert!(values[0] == 2.0 && values[2] == 2.0 && (values[1] - 1.0).abs() <= 0.01);
    }
}

/// Waves of height 1 about a line that passes zero in the middle.
#[test]
fn turns_beyond_reach_cost_little() {
    let waves = |x: f64| Sample {
        noise: 1e-15,
        ..sample(
            x,
            10.0 * x + (40.0 * x).sin(),
            10.0 + 40.0 * (40.0 * x).cos(),
        )
    };
    let (all, full) = Counted::new(waves).outline(-6.0, 6.0);
    let (within, few) = Counted::new(waves).outline_within(-6.0, 6.0, 0.5);
    assert!(all.len() > 140 && 4 * few < full, "{few} {full}");
    let near = |turns: &[TurningPoint]| -> Vec<f64> {
        let near = turns.iter().filter(|turn| turn.value.abs() <= 0.5);
        near.map(|turn| turn.value).collect()
    };
    let (near_all, near_within) = (near(&all), near(&within));
    assert_eq!(near_all.len(), near_within.len());
    for (a, b) in std::iter::zip(near_all, near_within) {
        assert!((a - b).abs() < 0.02 * a.abs() && (a > 0.0) == (b > 0.0));
    }
}

/// Waves that would take hundreds of samples, each of which costs a hundredth of all.
#[test]
fn an_outline_that_costs_too_much_is_left_as_it_is() {
    let calls = Cell::new(0);
    let mut f = |x: f64| {
        calls.set(calls.get() + 1);
        let (value, slope) = ((40.0 * x).sin(), 40.0 * (40.0 * x).cos());
        Ok(Sample {
            noise: 1e-15,
            work: calls.get() * MOST_WORK / 100,
            ..sample(x, value, slope)
        })
    };
    let (a, b) = (f(-6.0).unwrap(), f(6.0).unwrap());
    outline_between(&mut f, a, b, f64::INFINITY).unwrap();
    assert!((100..130).contains(&calls.get()), "{}", calls.get());
}

#[test]
fn eighths_are_at_equal_distances() {
    let line = Counted::new(|x: f64| sample(x, x, 1.0));
    let mut f = |x| Ok((line.f)(x));
    let eighths = eighths(&mut f, (line.f)(1.0), (line.f)(3.0)).unwrap();
    let places: Vec<f64> = eighths.iter().map(|sample| sample.x).collect();
    assert_eq!(places, [1.0, 1.25, 1.5, 1.75, 2.0, 2.25, 2.5, 2.75, 3.0]);
}

#[test]
fn turns_that_rounding_makes_are_none() {
    let turn = |x: f64, value: f64| TurningPoint {
        x,
        value,
        noise: 0.1,
    };
    let smoothed = |values: &[f64]| {
        let mut outline: Vec<TurningPoint> = (values.iter().enumerate())
            .map(|(i, &value)| turn(i as f64, value))
            .collect();
        smooth(&mut outline);
        outline.iter().map(|turn| turn.x).collect::<Vec<_>>()
    };
    assert_eq!(smoothed(&[0.0, 1.0, 0.5, 2.0]), [0.0, 1.0, 2.0, 3.0]);
    assert_eq!(smoothed(&[0.0, 1.0, 0.95, 2.0]), [0.0, 3.0]);
    assert_eq!(smoothed(&[0.0, 0.05, -1.0, 2.0]), [0.0, 2.0, 3.0]);
    assert_eq!(smoothed(&[0.0, 1.0, -1.0, -0.95]), [0.0, 1.0, 3.0]);
    assert_eq!(smoothed(&[0.0, 0.05]), [0.0, 1.0]);
    // The noise of either turn counts.
    let mut outline = vec![
        turn(0.0, 0.0),
        turn(1.0, 1.0),
        turn(2.0, 0.5),
        turn(3.0, 2.0),
    ];
    outline[2].noise = 0.6;
    smooth(&mut outline);
    assert_eq!(outline.len(), 2);
}

#[test]
fn a_turn_is_found_whatever_the_curvature() {
    // Slopes x³, |x|^(1/3) and 1 to 10⁶ at the ends.
    for power in [1.0, 3.0, 1.0 / 3.0, 9.0] {
        for (a, b) in [(-1.0, 2.0), (-3.0, 0.1), (-1e-3, 1.0)] {
            let calls = Cell::new(0);
            let f = |x: f64| {
                let y = x - 0.01;
                Sample {
                    noise: 1e-16,
                    ..sample(
                        x,
                        y.abs().powf(power + 1.0),
                        y.abs().powf(power).copysign(y),
                    )
                }
            };
            let mut counted = |x| {
                calls.set(calls.get() + 1);
                Ok(f(x))
            };
            let found = turn(&mut counted, f(a), f(b), 0.0).unwrap();
            assert!(found.value <= 1e-18 + 1e-16, "{power} {a} {b}: {found:?}");
            assert!(calls.get() <= 51, "{power} {a} {b}: {}", calls.get());
        }
    }
}

#[test]
fn an_interval_without_a_number_inside_is_not_divided() {
    let least = f64::from_bits(1);
    // Neither cubic fits, and 1e-9 of the first width is 0.
    for (a, b) in [
        (least, 3.0 * least),
        (1.0, 1.0_f64.next_up()),
        (1.0, f64::INFINITY),
    ] {
        let wild = |x: f64| sample(x, if x > a { 1.0 } else { 2.0 }, f64::NAN);
        let mut found = Roots::default();
        roots_between(
            &mut |x| Ok(wild(x)),
            &|_, _| None,
            wild(a),
            wild(b),
            &mut found,
        )
        .unwrap();
        assert_eq!(found, Roots::default());
    }
}
