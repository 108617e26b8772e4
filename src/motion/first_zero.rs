//! The first zero of a user's function in a step.

use crate::numerics::bracket::Bracket;

/// Number of equal parts of a step at whose ends the function is evaluated.
const PARTS: usize = 32;

/// Steps of the search for an extreme between two places: golden sections down to rounding.
const SECTIONS: usize = 48;

/// The first time t in (0, h] at which f is zero or changes its sign, to the last bit; `None` for
/// infinite h; NaN if f is NaN where it is evaluated.
pub(super) fn first_zero(f: &mut dyn FnMut(f64) -> f64, h: f64) -> Option<f64> {
    let mut is_nan = false;
    let mut f = |t: f64| {
        let value = f(t);
        is_nan |= value.is_nan();
        value
    };
    let found = search(&mut f, h);
    if is_nan { Some(f64::NAN) } else { found }
}

/// The search; with NaN it ends with any result.
fn search(f: &mut dyn FnMut(f64) -> f64, h: f64) -> Option<f64> {
    if !h.is_finite() {
        return None;
    }
    let place = |i: usize| {
        if i == PARTS {
            h
        } else {
            h / PARTS as f64 * i as f64
        }
    };
    let mut seen: Vec<(f64, f64)> = Vec::with_capacity(PARTS + 1);
    for i in 0..=PARTS {
        let here = (place(i), f(place(i)));
        if here.1.is_nan() {
            return None;
        }
        let Some(&last) = seen.last() else {
            // A function that starts at zero has the sign that it takes first.
            seen.extend((here.1 != 0.0).then_some(here));
            continue;
        };
        if here.1 == 0.0 || (here.1 > 0.0) != (last.1 > 0.0) {
            return Some(between(f, last, here));
        }
        // A zero may hide about the place before, if f was nearest to zero there.
        if let [.., before, last] = seen[..]
            && last.1.abs() <= before.1.abs().min(here.1.abs())
            && let Some(beyond) = extreme(f, before, last, here)
        {
            return Some(between(f, before, beyond));
        }
        seen.push(here);
    }
    None
}

/// The zero between two places of different sign, the lower first.
fn between(f: &mut dyn FnMut(f64) -> f64, a: (f64, f64), b: (f64, f64)) -> f64 {
    let mut bracket = Bracket::new(a, b);
    while let Some(t) = bracket.next_place() {
        bracket.narrow(t, f(t));
    }
    bracket.sign_change().nearest()
}

/// A point at which f has another sign than at three given points, of which f is nearest to zero at
/// the middle one; `None` if none is found on the way to the extreme.
fn extreme(
    f: &mut dyn FnMut(f64) -> f64,
    low: (f64, f64),
    middle: (f64, f64),
    high: (f64, f64),
) -> Option<(f64, f64)> {
    let (mut low, mut best, mut high) = (low.0, middle, high.0);
    for _ in 0..SECTIONS {
        // The golden section of the larger part.
        let t = if best.0 - low > high - best.0 {
            best.0 - 0.381_966 * (best.0 - low)
        } else {
            best.0 + 0.381_966 * (high - best.0)
        };
        let value = f(t);
        if value == 0.0 || (value > 0.0) != (best.1 > 0.0) {
            return Some((t, value));
        }
        let (inner, outer) = if value.abs() <= best.1.abs() {
            ((t, value), best.0)
        } else {
            (best, t)
        };
        if outer < inner.0 {
            low = outer;
        } else {
            high = outer;
        }
        best = inner;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::first_zero;

    #[test]
    fn zeros_are_found_to_the_last_bit() {
        assert_eq!(first_zero(&mut |t| t - 0.3, 1.0), Some(0.3));
        assert_eq!(first_zero(&mut |t| 1.0 - t, 1.0), Some(1.0));
        assert_eq!(first_zero(&mut |t| 2.0 - t, 1.0), None);
        assert_eq!(first_zero(&mut |t| 0.5 - t, f64::INFINITY), None);
        assert_eq!(first_zero(&mut |t| 0.5 - t, 0.0), None);
        // The first of several, and with a kink.
        let root = first_zero(&mut |t: f64| (20.0 * t).cos(), 1.0).unwrap();
        assert!((root - std::f64::consts::FRAC_PI_2 / 20.0).abs() < 1e-17);
        // This one is 0 at the number below 0.25 too.
        let root = first_zero(&mut |t: f64| (t - 0.5).abs() - 0.25, 1.0).unwrap();
        assert!((0.25_f64.next_down()..=0.25).contains(&root), "{root}");
    }

    #[test]
    fn a_zero_at_the_start_does_not_count() {
        assert_eq!(first_zero(&mut |t| t, 1.0), None);
        assert_eq!(first_zero(&mut |t| t * (t - 0.5), 1.0), Some(0.5));
        assert_eq!(first_zero(&mut |_| 0.0, 1.0), None);
    }

    #[test]
    fn two_zeros_between_two_places_are_found_and_touches_are_not() {
        for apart in [1e-2, 1e-4, 1e-6] {
            let (a, b) = (0.41, 0.41 + apart);
            let mut f = |t: f64| (t - a) * (t - b);
            let root = first_zero(&mut f, 1.0).unwrap();
            assert!((root - a).abs() < 1e-15, "{root}");
            let mut f = |t: f64| -(t - a) * (t - b);
            assert!((first_zero(&mut f, 1.0).unwrap() - a).abs() < 1e-15);
        }
        assert_eq!(
            first_zero(&mut |t: f64| (t - 0.41).powi(2) + 1e-12, 1.0),
            None
        );
    }

    #[test]
    fn nan_is_said() {
        let is_nan = |f: &mut dyn FnMut(f64) -> f64| first_zero(f, 1.0).unwrap().is_nan();
        assert!(is_nan(&mut |_| f64::NAN));
        assert!(is_nan(&mut |t| if t < 0.25 { f64::NAN } else { t - 0.75 }));
        // Between the places, on the way to a root or to an extreme.
        let near = |at: f64, t: f64| (t - at).abs() < 1e-3;
        assert!(is_nan(&mut |t| if near(0.74, t) {
            f64::NAN
        } else {
            t - 0.74
        }));
        assert!(is_nan(&mut |t| if near(0.41, t) {
            f64::NAN
        } else {
            (t - 0.41).abs()
        }));
        // Beyond the zero it is not evaluated.
        let mut f = |t: f64| if t > 0.5 { f64::NAN } else { t - 0.3 };
        assert_eq!(first_zero(&mut f, 1.0), Some(0.3));
    }
}
