use std::f64::consts::{PI, TAU};

use crate::clock::Clock;
use crate::series::{INTEGRAL, PowerSeries, TERMS};

/// cosine·cos(Ωt) + sine·sin(Ωt). The phase at t = 0 is in the two amplitudes, so that Ωt is the
/// only product that has to be exact.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub(crate) struct Harmonic {
    /// Angular frequency Ω.
    pub(crate) angular_frequency: f64,
    pub(crate) cosine: f64,
    pub(crate) sine: f64,
}

impl Harmonic {
    pub(super) fn new(angular_frequency: f64, cosine: f64, sine: f64) -> Self {
        Self {
            angular_frequency,
            cosine,
            sine,
        }
    }

    pub(super) fn frequency(&self) -> f64 {
        self.angular_frequency
    }

    pub(super) fn amplitude(&self) -> f64 {
        self.cosine.hypot(self.sine)
    }

    /// The sum of two harmonics of one frequency.
    pub(super) fn plus(self, other: &Self) -> Self {
        Self {
            cosine: self.cosine + other.cosine,
            sine: self.sine + other.sine,
            ..self
        }
    }

    pub(super) fn scaled(&self, factor: f64) -> Self {
        Self {
            cosine: self.cosine * factor,
            sine: self.sine * factor,
            ..*self
        }
    }

    /// Value and slope.
    pub(super) fn at(&self, time: Clock) -> [f64; 2] {
        let (sine, cosine) = sin_cos(time, self.angular_frequency);
        [
            self.cosine * cosine + self.sine * sine,
            self.angular_frequency * (self.sine * cosine - self.cosine * sine),
        ]
    }

    /// Adds the series in the time since `start`: f'' = −Ω²f.
    pub(super) fn add_series(&self, start: Clock, series: &mut PowerSeries) {
        let square = self.angular_frequency * self.angular_frequency;
        let [mut even, mut odd] = self.at(start);
        for k in (0..TERMS - 1).step_by(2) {
            series[k] += even;
            series[k + 1] += odd;
            even *= -square * (INTEGRAL[k] * INTEGRAL[k + 1]);
            odd *= -square * (INTEGRAL[k + 1] * INTEGRAL[k + 2]);
        }
        series[TERMS - 1] += even;
    }

    /// ∫ f dt.
    pub(super) fn integral(&self, from: Clock, to: Clock) -> f64 {
        let frequency = self.angular_frequency;
        let duration = from.to(to);
        if frequency * duration <= PI {
            // The mean over a short stretch, without the difference of two like numbers.
            let half = 0.5 * duration;
            let [middle, _] = self.at(from.after(half));
            return 2.0 * (frequency * half).sin() / frequency * middle;
        }
        // Over a long one the exact phases at both ends.
        let antiderivative = |time| {
            let (sine, cosine) = sin_cos(time, frequency);
            self.cosine * sine - self.sine * cosine
        };
        (antiderivative(to) - antiderivative(from)) / frequency
    }
}

/// sin Ωt and cos Ωt of the exact time.
fn sin_cos(time: Clock, frequency: f64) -> (f64, f64) {
    /// The remainder below which its cosine is 1 and its sine is itself, to rounding.
    const SMALL: f64 = 1e-8;
    let (phase, rest) = time.times(frequency);
    let (sine, cosine) = phase.sin_cos();
    let (rest_sine, rest_cosine) = if rest.abs() <= SMALL {
        (rest, 1.0)
    } else {
        rest.sin_cos()
    };
    (
        sine * rest_cosine + cosine * rest_sine,
        cosine * rest_cosine - sine * rest_sine,
    )
}

/// The least common period of harmonics with these angular frequencies; `None` if there are none,
/// or they have none.
pub(super) fn common_period(frequencies: &[f64]) -> Option<f64> {
    let slowest = frequencies.iter().copied().min_by(f64::total_cmp)?;
    let mut turns = 1;
    for frequency in frequencies {
        let denominator = denominator(frequency / slowest)?;
        turns = least_common_multiple(turns, denominator)?;
    }
    Some(TAU * turns as f64 / slowest)
}

/// The least q for which a ratio is p/q.
fn denominator(ratio: f64) -> Option<u64> {
    const MOST: u64 = 1000;
    /// Tolerance in ulps: each frequency is rounded, and so is their ratio.
    const ROUNDING: f64 = 4.0;
    let allowed = ROUNDING * (ratio.next_up() - ratio);
    (1..=MOST).find(|&q| {
        let nearest = (ratio * q as f64).round() / q as f64;
        (ratio - nearest).abs() <= allowed
    })
}

fn least_common_multiple(a: u64, b: u64) -> Option<u64> {
    let (mut divisor, mut rest) = (a, b);
    while rest != 0 {
        (divisor, rest) = (rest, divisor % rest);
    }
    (a / divisor).checked_mul(b)
}
