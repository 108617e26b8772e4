//! Faults of a friction law.

/// A fault of a friction law, found by [`check_law`](crate::check_law). μ̂(s) is the kinetic
/// coefficient at the sliding speed s. Speeds and widths are in the units of the law, slopes in
/// 1/speed; coefficients are dimensionless.
///
/// The text that `Display` writes contains the remedy.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum LawFault {
    /// The law jumps at a speed.
    Jump {
        /// The sliding speed of the jump.
        speed: f64,
        /// μ̂ just below this speed.
        below: f64,
        /// μ̂ just above this speed.
        above: f64,
    },
    /// The slope of the law jumps at a speed that is not declared as a breakpoint.
    Kink {
        /// The sliding speed of the kink.
        speed: f64,
        /// dμ̂/ds just below this speed.
        slope_below: f64,
        /// dμ̂/ds just above this speed.
        slope_above: f64,
    },
    /// The law is not analytic at a speed in another way: a higher derivative jumps, or the slope
    /// is infinite.
    NotAnalytic {
        /// The sliding speed of this point.
        speed: f64,
    },
    /// The law returns NaN or ±∞.
    NotFinite {
        /// The lowest sliding speed of the interval in which the law is not finite.
        speed: f64,
        /// The value of the law at this speed.
        value: f64,
    },
    /// μ̂ is negative: friction would drive the motion instead of opposing it.
    Negative {
        /// The speed at which μ̂ falls below 0, or the start of the range.
        from: f64,
        /// The speed at which μ̂ rises above 0 again, or the end of the range.
        to: f64,
    },
    /// A feature of the law, such as a bump, is so narrow that a step may pass over it if the
    /// sliding speed changes fast.
    Narrow {
        /// The sliding speed at which the feature is most pronounced.
        speed: f64,
        /// Width of the feature at half its height.
        width: f64,
    },
}

impl std::fmt::Display for LawFault {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Jump {
                speed,
                below,
                above,
            } => write!(
                f,
                "jump from {below} to {above} at speed {speed}: laws are continuous; replace it by \
                 a steep ramp between two breakpoints"
            ),
            Self::Kink {
                speed,
                slope_below,
                slope_above,
            } => write!(
                f,
                "kink at speed {speed}, from slope {slope_below} to {slope_above}: name the speed \
                 in `breakpoints`, and give the pieces in `kinetic_on`"
            ),
            Self::NotAnalytic { speed } => write!(
                f,
                "no power series at speed {speed}: use integral powers there, or name the speed \
                 in `breakpoints` and give the pieces in `kinetic_on`"
            ),
            Self::NotFinite { speed, value } => write!(
                f,
                "{value} from speed {speed} on: define the law there, or keep motions away"
            ),
            Self::Negative { from, to } => write!(
                f,
                "negative from speed {from} to {to}: friction would drive the mass"
            ),
            Self::Narrow { speed, width } => write!(
                f,
                "narrow feature at speed {speed}, {width} wide: name the speed in `breakpoints`, \
                 so that no step passes over it"
            ),
        }
    }
}
