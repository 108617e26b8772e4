//! Sign changes, over a range of belt velocities, of a function that is known point by point.

use crate::error::Error;

/// Intervals that a range is divided into before anything is known.
const INTERVALS: usize = 64;

/// Halvings of an interval in which something may be hidden.
const DEPTH: u32 = 10;

/// Finds the sign changes of `f`, of order 1, over a range, each to the last bit; `None` where f is
/// not defined.
///
/// The range is divided into [`INTERVALS`] intervals; one is halved, up to [`DEPTH`] times, while f
/// is defined at one end only, or while it comes closer to zero than it changes across the
/// interval. Two sign changes are lost only if f turns back between points of that grid: narrow the
/// range to look closer.
pub(super) fn sign_changes(
    mut f: impl FnMut(f64) -> Result<Option<f64>, Error>,
    range: &std::ops::Range<f64>,
) -> Result<Vec<f64>, Error> {
    let mut roots = Vec::new();
    let width = (range.end - range.start) / INTERVALS as f64;
    let mut left = (range.start, f(range.start)?);
    for i in 1..=INTERVALS {
        let x = if i == INTERVALS {
            range.end
        } else {
            range.start + width * i as f64
        };
        let right = (x, f(x)?);
        divide(&mut f, left, right, DEPTH, &mut roots)?;
        left = right;
    }
    Ok(roots)
}

type Sample = (f64, Option<f64>);

fn divide(
    f: &mut impl FnMut(f64) -> Result<Option<f64>, Error>,
    a: Sample,
    b: Sample,
    depth: u32,
    roots: &mut Vec<f64>,
) -> Result<(), Error> {
    let suspicious = match (a.1, b.1) {
        (None, None) => false,
        // Zero throughout, as for a motion that returns to the belt tangentially at every belt
        // velocity.
        (Some(p), Some(q)) if p.abs().max(q.abs()) <= ROUNDING => false,
        (Some(p), Some(q)) if (p > 0.0) != (q > 0.0) => {
            // A jump is one too: the motion may depend on the belt velocity so steeply that it
            // passes through zero within an ulp.
            if let Some((root, _)) = root_between(f, (a.0, p), (b.0, q))? {
                roots.push(root);
                return Ok(());
            }
            true
        }
        (Some(p), Some(q)) => p.abs().min(q.abs()) < (p - q).abs(),
        _ => true,
    };
    if suspicious && depth > 0 {
        let x = 0.5 * (a.0 + b.0);
        let middle = (x, f(x)?);
        divide(f, a, middle, depth - 1, roots)?;
        divide(f, middle, b, depth - 1, roots)?;
    }
    Ok(())
}

/// The root of a function that is defined, and of different sign, at both ends, between
/// neighbouring numbers: false position, with bisection where that does not halve the bracket
/// within three evaluations. With it, how far from zero the function is on either side of it at
/// most; `None` where the function has a gap in between.
pub(super) fn root_between(
    f: &mut impl FnMut(f64) -> Result<Option<f64>, Error>,
    (mut a, mut at_a): (f64, f64),
    (mut b, mut at_b): (f64, f64),
) -> Result<Option<(f64, f64)>, Error> {
    // While one end moves alone, its steps go twice as far each time, so that the other end soon
    // moves too.
    let (mut lower_moved, mut stretch) = (None, 1.0);
    let (mut width, mut slow) = (b - a, 0_u32);
    loop {
        let chord = a + (b - a) * (at_a / (at_a - at_b));
        // An end may be a root itself.
        let chord = chord.max(a.next_up()).min(b.next_down());
        let step = match lower_moved {
            None => chord,
            Some(true) => (a + stretch * (chord - a)).max(a.next_up()),
            Some(false) => (b - stretch * (b - chord)).min(b.next_down()),
        };
        let x = if slow < 3 && a < step && step < b {
            step
        } else {
            0.5 * (a + b)
        };
        if x <= a || x >= b {
            break;
        }
        let Some(value) = f(x)? else {
            return Ok(None);
        };
        let lower = (value > 0.0) == (at_a > 0.0);
        if lower {
            (a, at_a) = (x, value);
        } else {
            (b, at_b) = (x, value);
        }
        stretch = if lower_moved == Some(lower) {
            2.0 * stretch
        } else {
            1.0
        };
        lower_moved = Some(lower);
        if b - a <= 0.5 * width {
            (width, slow) = (b - a, slow.saturating_sub(1));
        } else {
            slow += 1;
        }
    }
    // Of the two neighbouring numbers that are left, the lower one lies in every range in which the
    // change is seen: so none is lost, and none found twice, where a range is cut.
    Ok(Some((a, at_a.abs().max(at_b.abs()))))
}

/// Size of the rounding error of a function of order 1.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

#[cfg(test)]
mod tests;
