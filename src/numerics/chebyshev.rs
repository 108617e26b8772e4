//! Search for all roots of a function that is known from values alone, isolated by Chebyshev
//! interpolation.

use super::sort::sort_by;
use std::collections::VecDeque;

use crate::error::Error;
use crate::numerics::power_of_two;

/// A value and the size of its rounding error.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sample {
    pub(crate) value: f64,
    pub(crate) noise: f64,
}

/// A place at which a function was evaluated while its roots were isolated.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Node {
    pub(crate) at: f64,
    pub(crate) sample: Sample,
}

/// Degree of the interpolants. Laws with one hump are resolved by one or two of them.
const DEGREE: usize = 32;
/// Shortest piece of 0 ≤ t ≤ 1: two roots closer than this can be missed as a pair.
const SHORTEST: f64 = 1.0 / (1u64 << 30) as f64;
/// Most pieces in one segment. A smooth function needs a few, and each near-double root about 60;
/// for a function noisier than it reports the halving would never end.
const MOST_PIECES: usize = 2000;

/// Points, in ascending t, between which f(x(t)), 0 ≤ t ≤ 1, has at most one root. Between two of
/// them the Chebyshev interpolant of f∘x is resolved to round-off, and the sizes of its
/// coefficients show that it has no root or is monotone; or that of ln|f∘x| is smooth, so that f∘x
/// has no root. x(t) must be monotone, and f∘x analytic.
pub(crate) fn isolate(
    f: &mut dyn FnMut(f64) -> Result<Sample, Error>,
    x: &dyn Fn(f64) -> f64,
) -> Result<Vec<Node>, Error> {
    let cosines = cosines();
    let mut nodes = Vec::new();
    let mut pieces = VecDeque::from([(0.0, 1.0)]);
    let mut made = 1;
    while let Some((start, end)) = pieces.pop_front() {
        let (mid, half) = (0.5 * (start + end), 0.5 * (end - start));
        let mut samples = Vec::with_capacity(DEGREE + 1);
        for (j, cosine) in cosines[..=DEGREE].iter().enumerate() {
            // Neighbouring pieces have the same end, to the bit.
            let t = match j {
                0 => end,
                DEGREE => start,
                _ => mid + half * cosine,
            };
            let at = x(t);
            samples.push((t, Node { at, sample: f(at)? }));
        }
        let settled = has_one_root_at_most(&samples, &cosines) || keeps_sign(&samples, &cosines);
        if settled || end - start <= SHORTEST || made + 2 > MOST_PIECES {
            nodes.extend([samples[DEGREE], samples[0]]);
        } else {
            pieces.extend([(start, mid), (mid, end)]);
            made += 2;
        }
    }
    sort_by(&mut nodes, |node| node.0);
    Ok(nodes.into_iter().map(|(_, node)| node).collect())
}

/// Returns true if f(x(t)) is positive throughout 0 ≤ t ≤ 1, false if it is negative throughout;
/// `None` if it may be zero somewhere.
///
/// ln|f| is interpolated instead of f, so that a function that falls by hundreds of decades needs
/// no more places than one that hardly changes. A zero is a singularity of ln|f|, which no
/// interpolant resolves.
pub(crate) fn sign_throughout(
    f: &mut dyn FnMut(f64) -> Result<Sample, Error>,
    x: &dyn Fn(f64) -> f64,
) -> Result<Option<bool>, Error> {
    let cosines = cosines();
    let mut positive = None;
    let mut pieces = vec![(0.0, 1.0)];
    let mut made = 0;
    while let Some((start, end)) = pieces.pop() {
        let mut samples = Vec::with_capacity(DEGREE + 1);
        let mut surest = f64::INFINITY;
        for cosine in &cosines[..=DEGREE] {
            let t = 0.5 * ((start + end) + (end - start) * cosine);
            let at = x(t);
            let sample = f(at)?;
            let Sample { value, noise } = sample;
            // False for a value that is NaN.
            let is_sure = value.abs() > noise;
            if !is_sure || positive.is_some_and(|positive| positive != (value > 0.0)) {
                return Ok(None);
            }
            positive = Some(value > 0.0);
            surest = surest.min(value.abs() / noise);
            samples.push((t, Node { at, sample }));
        }
        // Between two values of one sign there is not one root alone.
        if !keeps_sign(&samples, &cosines) && !has_one_root_at_most(&samples, &cosines) {
            made += 2;
            if made > MOST_HALVES || surest < HARDLY_SURE {
                return Ok(None);
            }
            let middle = 0.5 * (start + end);
            pieces.extend([(start, middle), (middle, end)]);
        }
    }
    Ok(positive)
}

/// Largest last coefficients of ln|f| where f has no zero: those of ln|t| are 2/k.
const SMOOTH_LOGARITHM: f64 = 1e-2;
/// The last coefficients begin here. Midway between two places a zero leaves no trace in the last
/// three: coefficient k is 2 cos kθ (1/k − 1/(2·[`DEGREE`] − k)) there.
const LAST_COEFFICIENTS: usize = DEGREE - 8;
/// Pieces after which a sign counts as unknown.
const MOST_HALVES: usize = 200;
/// A value that is not larger than its noise by this factor has no certain logarithm.
const HARDLY_SURE: f64 = 100.0;

fn cosines() -> [f64; 2 * DEGREE] {
    std::array::from_fn(|j| (std::f64::consts::PI * j as f64 / DEGREE as f64).cos())
}

/// Coefficients of the Chebyshev interpolant through values at the places cos(πj/[`DEGREE`]).
fn coefficients(values: &[f64; DEGREE + 1], cosines: &[f64; 2 * DEGREE]) -> [f64; DEGREE + 1] {
    std::array::from_fn(|k| {
        let inner: f64 = (1..DEGREE)
            .map(|j| values[j] * cosines[j * k % (2 * DEGREE)])
            .sum();
        let ends = 0.5 * (values[0] + values[DEGREE] * cosines[DEGREE * k % (2 * DEGREE)]);
        let weight = if k % DEGREE == 0 { 1.0 } else { 2.0 };
        (inner + ends) * weight / DEGREE as f64
    })
}

/// Returns true if all values have one sign beyond doubt, and the interpolant of their logarithms
/// is smooth, as at no root. A function that falls by hundreds of decades has a smooth logarithm.
fn keeps_sign(samples: &[(f64, Node)], cosines: &[f64; 2 * DEGREE]) -> bool {
    let sign = samples[0].1.sample.value.signum();
    let mut logarithms = [0.0; DEGREE + 1];
    for (logarithm, (_, node)) in std::iter::zip(&mut logarithms, samples) {
        let Sample { value, noise } = node.sample;
        let is_sure = value * sign > noise;
        if !is_sure {
            return false;
        }
        *logarithm = value.abs().ln();
    }
    sum(&coefficients(&logarithms, cosines)[LAST_COEFFICIENTS..]) <= SMOOTH_LOGARITHM
}

fn has_one_root_at_most(samples: &[(f64, Node)], cosines: &[f64; 2 * DEGREE]) -> bool {
    // In a unit in which no sum overflows. A power of two causes no rounding.
    let sizes = samples.iter().map(|(_, node)| node.sample.value.abs());
    let unit = power_of_two(sizes.fold(0.0, f64::max));
    let noises = samples.iter().map(|(_, node)| node.sample.noise);
    let noise = noises.fold(0.0, f64::max) / unit;
    let mut values = [0.0; DEGREE + 1];
    for (value, (_, node)) in std::iter::zip(&mut values, samples) {
        *value = node.sample.value / unit;
    }
    let c = coefficients(&values, cosines);
    let resolved = sum(&c[DEGREE - 3..]) <= 4.0 * noise;
    let has_no_root = c[0].abs() > sum(&c[1..]) + noise;
    let is_flat = sum(&c) <= noise;
    if !resolved || has_no_root || is_flat {
        return resolved;
    }
    // Coefficients of the derivative, without those that are mere rounding.
    let mut d = [0.0; DEGREE + 2];
    for k in (1..=DEGREE).rev().skip_while(|&k| c[k].abs() <= noise) {
        d[k - 1] = d[k + 1] + 2.0 * k as f64 * c[k];
    }
    0.5 * d[0].abs() > sum(&d[1..])
}

/// Σ |c_k|, in one copy of the code: four would be unrolled.
#[inline(never)]
fn sum(c: &[f64]) -> f64 {
    c.iter().map(|c| c.abs()).sum()
}

/// Pairs of points between which the sign changes beyond doubt. A value within its rounding error
/// has no sign, so a function that vanishes on a whole interval has no root there.
pub(crate) fn brackets(nodes: &[Node]) -> Vec<[f64; 2]> {
    let definite = nodes
        .iter()
        .filter(|node| node.sample.value.abs() > node.sample.noise);
    let mut found = Vec::new();
    let mut last: Option<&Node> = None;
    for node in definite {
        if let Some(last) = last.filter(|last| last.sample.value * node.sample.value.signum() < 0.0)
        {
            found.push([last.at, node.at]);
        }
        last = Some(node);
    }
    found
}

#[cfg(test)]
mod tests;
