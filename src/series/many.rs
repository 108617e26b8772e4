//! The values of two series at many times.

use super::{PowerSeries, TERMS};
use crate::scalar::fused;
use crate::scalar::lanes::{self, LANES, Lanes};

/// Number of groups of four times that are summed side by side. With two series these are enough
/// sums at a time to hide the latency of each.
pub(crate) const GROUPS: usize = 4;

/// Groups of four numbers each.
pub(crate) type Block = [Lanes; GROUPS];

/// The values of two series at these times, with the fused instructions of the processor, if it
/// has them: their last bits depend on it.
#[inline(never)]
pub(crate) fn values_of(series: [&PowerSeries; 2], times: &Block) -> [Block; 2] {
    let mut values = [*times; 2];
    fused::compute(
        &series,
        &mut values,
        #[inline(always)]
        |series, values| *values = in_lanes(series, &values[0]),
        #[inline(always)]
        |series, values| {
            for (series, values) in std::iter::zip(series, values) {
                *values = values.map(|times| series.at_some(times));
            }
        },
    );
    values
}

#[inline(always)]
fn in_lanes(series: &[&PowerSeries; 2], times: &Block) -> [Block; 2] {
    let [a, b] = *series;
    let mut first = [[a[TERMS - 1]; LANES]; GROUPS];
    let mut second = [[b[TERMS - 1]; LANES]; GROUPS];
    for k in (0..TERMS - 1).rev() {
        let next = [[a[k]; LANES], [b[k]; LANES]];
        for group in 0..GROUPS {
            let t = times[group];
            first[group] = lanes::mul_add::<true>(first[group], t, next[0]);
            second[group] = lanes::mul_add::<true>(second[group], t, next[1]);
        }
    }
    [first, second]
}

#[cfg(test)]
mod tests {
    use super::{GROUPS, in_lanes, values_of};
    use crate::scalar::lanes::LANES;
    use crate::series::PowerSeries;

    /// Values of two series at many times are those at each of the times, to rounding.
    #[test]
    fn values_are_those_of_each_series() {
        let cosine = |k: usize| {
            let factorial: f64 = (1..=k).map(|i| i as f64).product();
            [1.0, 0.0, -1.0, 0.0][k % 4] / factorial
        };
        let series = [
            PowerSeries::from_fn(cosine),
            PowerSeries::from_fn(|k| 0.9_f64.powi(k as i32)),
        ];
        let times = std::array::from_fn::<_, GROUPS, _>(|group| {
            std::array::from_fn::<_, LANES, _>(|lane| 0.06 * (LANES * group + lane) as f64)
        });
        let pair = [&series[0], &series[1]];
        for values in [values_of(pair, &times), in_lanes(&pair, &times)] {
            for (values, series) in values.iter().zip(&series) {
                let both = values.as_flattened().iter().zip(times.as_flattened());
                for (value, t) in both {
                    let error = value - series.at(*t);
                    assert!(
                        error.abs() <= 4.0 * series.rounding_bound(*t),
                        "{t}: {error:e}"
                    );
                }
            }
        }
    }
}
