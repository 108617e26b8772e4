//! Functions of time.
//!
//! A time inside the crate is a [`Clock`]: even after 10⁹ periods the phase has no accumulated
//! error.

// | file | what is in it |
// |---|---|
// | `mod.rs` | `Drive`: a constant, harmonics (from amplitude and phase), profiles and functions, added up |
// | `harmonic.rs` | one angular frequency, as a cosine and a sine: value, slope, series, integral; the common period of several |
// | `profile.rs` | straight lines through points: the same, and where pieces meet |
// | `function.rs` | `TimeFunction`, the trait of a user's own function |
// | `function_series.rs` | such a function as a trait object: the same, and how far it is from its series |

mod function;
mod function_series;
mod harmonic;
mod profile;
#[cfg(feature = "serde")]
mod read;
#[cfg(test)]
mod tests;

pub use function::TimeFunction;
use function_series::Function;
pub(crate) use harmonic::Harmonic;
use profile::Profile;

use std::f64::consts::TAU;

use crate::clock::Clock;
use crate::error::Error;
use crate::series::PowerSeries;

/// A function of time: a force, the velocity of a belt, a normal load, or the factor of a force
/// element.
///
/// ```text
/// f(t) = c + Σ A_k cos(Ω_k t + φ_k) + Σ (straight lines through points) + Σ (your functions)
/// ```
///
/// c is a constant, and A_k, Ω_k and φ_k are the amplitude, angular frequency and phase of a
/// harmonic. A function of your own, such as a chirp or a shock, is a [`TimeFunction`]. Times,
/// angular frequencies (radians per unit of time) and values are in the units of the driven system;
/// phases are in radians. A plain number such as `0.3` is accepted as a constant drive.
///
/// Phases are computed from the exact product Ωt, so a harmonic is as accurate after 10⁹ periods as
/// in the first. At a kink or a jump, [`value`](Self::value) and [`slope`](Self::slope) return the
/// value and slope just after it.
///
/// ```
/// use stick_slip::Drive;
///
/// let drive = Drive::constant(0.2).with_harmonic(0.1, 2.0, 0.0)?; // 0.2 + 0.1 cos 2t
/// assert_eq!(drive.value(0.0), 0.2 + 0.1);
/// assert!((drive.slope(1.0) + 0.2 * 2.0_f64.sin()).abs() < 1e-16);
/// assert_eq!(drive.period(), Some(std::f64::consts::PI));
///
/// // A belt that starts, holds its velocity and stops; a force that is switched on at t = 5.
/// let belt = Drive::profile(&[(0.0, 0.0), (10.0, 0.3), (35.0, 0.3), (45.0, 0.0)])?;
/// assert_eq!([5.0, 20.0, 1e6].map(|t| belt.value(t)), [0.15, 0.3, 0.0]);
/// let switched = Drive::profile(&[(5.0, 0.0), (5.0, 1.0)])?;
/// assert_eq!([4.9, 5.0].map(|t| switched.value(t)), [0.0, 1.0]);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Drive {
    constant: f64,
    /// Harmonics of different frequencies, ascending; none is zero.
    harmonics: Vec<Harmonic>,
    /// Profiles; none is constant.
    profiles: Vec<Profile>,
    /// Functions of users, of which only that there are none can be written.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Vec::is_empty"))]
    functions: Vec<Function>,
}

impl Drive {
    /// Creates the constant drive c. If c is not finite, the function that uses the drive returns
    /// an error.
    pub const fn constant(value: f64) -> Self {
        Self {
            constant: value,
            harmonics: Vec::new(),
            profiles: Vec::new(),
            functions: Vec::new(),
        }
    }

    /// Creates the drive A·cos(Ωt + φ) of amplitude A, angular frequency Ω and phase φ.
    ///
    /// # Errors
    ///
    /// [`Error::InvalidParameter`] unless A and φ are finite, Ω is positive and finite, and AΩ does
    /// not overflow.
    pub fn harmonic(amplitude: f64, angular_frequency: f64, phase: f64) -> Result<Self, Error> {
        Self::constant(0.0).with_harmonic(amplitude, angular_frequency, phase)
    }

    /// Creates the drive A·sin(Ωt) of amplitude A and angular frequency Ω, exactly 0 at t = 0.
    ///
    /// # Errors
    ///
    /// [`Error::InvalidParameter`] unless A is finite, Ω is positive and finite, and AΩ does not
    /// overflow.
    ///
    /// ```
    /// assert_eq!(stick_slip::Drive::sine(0.4, 0.7)?.value(0.0), 0.0);
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    pub fn sine(amplitude: f64, angular_frequency: f64) -> Result<Self, Error> {
        Self::constant(0.0).with_sine(amplitude, angular_frequency)
    }

    /// Creates a drive of straight lines through points (time, value). The drive is constant before
    /// the first point and after the last point.
    ///
    /// Times must not descend. Two points at the same time describe a jump. At this time the drive
    /// already has the second value. A force or a load may jump. The velocity of a belt must not
    /// jump, except at an elastic contact.
    ///
    /// # Errors
    ///
    /// [`Error::InvalidParameter`] if the list is empty. [`Error::BadPoint`], with the first point
    /// at fault, if a number is not finite, if the times descend, if three points have the same
    /// time, or if a slope overflows.
    pub fn profile(points: &[(f64, f64)]) -> Result<Self, Error> {
        Self::constant(0.0).with_profile(points)
    }

    /// Creates a drive of a function of your own, such as a chirp, a shock or a window.
    ///
    /// In comparisons, a function is equal only to itself in a clone of its drive. A drive with a
    /// function cannot be written with the feature `serde`. At its breakpoints the function may
    /// jump, with the same exceptions as a [profile](Self::profile).
    ///
    /// # Errors
    ///
    /// * [`Error::InvalidParameter`] unless the function's size is ≥ 0 and finite, its timescales
    ///   are > 0, its period is > 0 and finite, and its values at time 0 and on both sides of each
    ///   breakpoint are finite;
    /// * [`Error::BadBreakpoints`] for the first breakpoint that is not finite, does not ascend, or
    ///   lies outside the first period.
    ///
    /// If the function is not finite at another time, a motion that comes there ends in
    /// [`Error::StepUnderflow`].
    pub fn function(function: impl TimeFunction + Send + Sync + 'static) -> Result<Self, Error> {
        Self::constant(0.0).with_function(function)
    }

    /// Adds a constant c.
    ///
    /// # Errors
    ///
    /// [`Error::InvalidParameter`] unless c and the sum of the constants are finite.
    pub fn with_constant(mut self, value: f64) -> Result<Self, Error> {
        self.constant += value;
        let finite = self.constant.is_finite();
        Error::check(
            "Drive",
            "value",
            value,
            finite,
            "a sum of constants that is finite",
        )?;
        Ok(self)
    }

    /// Adds A·cos(Ωt + φ), with the amplitude A, the angular frequency Ω and the phase φ.
    ///
    /// # Errors
    ///
    /// The errors of [`harmonic`](Self::harmonic); [`Error::InvalidParameter`] also if the sum with
    /// a harmonic of the same angular frequency overflows.
    pub fn with_harmonic(
        self,
        amplitude: f64,
        angular_frequency: f64,
        phase: f64,
    ) -> Result<Self, Error> {
        Error::check("Drive", "amplitude", amplitude, true, "any size")?;
        Error::check("Drive", "phase", phase, true, "any number of radians")?;
        let (sine, cosine) = phase.sin_cos();
        self.with_waves(angular_frequency, amplitude * cosine, -amplitude * sine)
    }

    /// Adds A·sin(Ωt), with the amplitude A and the angular frequency Ω.
    ///
    /// # Errors
    ///
    /// The errors of [`sine`](Self::sine); [`Error::InvalidParameter`] also if the sum with a
    /// harmonic of the same angular frequency overflows.
    pub fn with_sine(self, amplitude: f64, angular_frequency: f64) -> Result<Self, Error> {
        Error::check("Drive", "amplitude", amplitude, true, "any size")?;
        self.with_waves(angular_frequency, 0.0, amplitude)
    }

    /// Adds straight lines through points.
    ///
    /// # Errors
    ///
    /// The errors of [`profile`](Self::profile); if all points have one value, also those of
    /// [`with_constant`](Self::with_constant).
    pub fn with_profile(mut self, points: &[(f64, f64)]) -> Result<Self, Error> {
        let profile = Profile::new(points)?;
        match profile.as_constant() {
            Some(value) => self.with_constant(value),
            None => {
                self.profiles.push(profile);
                Ok(self)
            }
        }
    }

    /// Adds a function of your own.
    ///
    /// # Errors
    ///
    /// The errors of [`function`](Self::function).
    pub fn with_function(
        mut self,
        function: impl TimeFunction + Send + Sync + 'static,
    ) -> Result<Self, Error> {
        self.functions.push(Function::new(function)?);
        Ok(self)
    }

    /// Adds cosine·cos(Ωt) + sine·sin(Ωt).
    fn with_waves(mut self, frequency: f64, cosine: f64, sine: f64) -> Result<Self, Error> {
        Error::check(
            "Drive",
            "angular_frequency",
            frequency,
            frequency > 0.0,
            "angular_frequency > 0; for its negative change the signs of phase or sine, \
             and for 0 add a constant",
        )?;
        let mut new = Harmonic::new(frequency, cosine, sine);
        let place = self
            .harmonics
            .partition_point(|old| old.frequency() < frequency);
        if let Some(old) = self.harmonics.get(place)
            && old.frequency() == frequency
        {
            new = new.plus(old);
            self.harmonics.remove(place);
        }
        let amplitude = new.amplitude();
        Error::check(
            "Drive",
            "amplitude",
            amplitude,
            (frequency * amplitude).is_finite(),
            "amplitudes with a finite sum, and a slope that does not overflow",
        )?;
        if amplitude != 0.0 {
            self.harmonics.insert(place, new);
        }
        Ok(self)
    }

    /// The value f(t) at a finite time, in the unit of the driven quantity. The result is NaN if Ωt
    /// overflows for an angular frequency Ω of the drive: double precision has no such phase.
    pub fn value(&self, time: f64) -> f64 {
        self.at(Clock::at(time))[0]
    }

    /// The slope f'(t) at a finite time, in the unit of the driven quantity per unit of time. The
    /// result is NaN if the [value](Self::value) is NaN.
    pub fn slope(&self, time: f64) -> f64 {
        self.at(Clock::at(time))[1]
    }

    /// The period: the least T > 0 with f(t + T) = f(t), in units of time. `None` if the drive is
    /// constant, contains a profile or a function without a [period](TimeFunction::period), or has
    /// parts without a common period.
    ///
    /// Harmonics have a common period if the ratio of each angular frequency to the lowest angular
    /// frequency is within 4 ulps of a fraction p/q with q ≤ 1000. The tolerance is needed, because
    /// in `f64` even 1.65/0.55 is not exactly 3. A function of period T counts as a harmonic of
    /// angular frequency 2π/T.
    ///
    /// ```
    /// use stick_slip::Drive;
    /// use std::f64::consts::TAU;
    ///
    /// let drive = Drive::sine(1.0, 0.55)?;
    /// assert_eq!(drive.period(), Some(TAU / 0.55));
    /// assert_eq!(drive.clone().with_sine(0.2, 1.65)?.period(), Some(TAU / 0.55));
    /// assert_eq!(drive.with_sine(0.2, 0.55 * 2.0_f64.sqrt())?.period(), None);
    /// assert_eq!(Drive::constant(1.0).period(), None);
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    pub fn period(&self) -> Option<f64> {
        common_period([self])
    }

    /// Returns true if the drive is constant.
    pub(crate) fn is_constant(&self) -> bool {
        self.harmonics.is_empty() && self.profiles.is_empty() && self.functions.is_empty()
    }

    /// Returns true if a user's function is a part of the drive.
    pub(crate) fn has_functions(&self) -> bool {
        !self.functions.is_empty()
    }

    /// Sum of the largest absolute values of the parts of f. It is a bound of |f|, and ε times this
    /// sum is the unit of the rounding errors of f. For functions of users it is what they say.
    pub(crate) fn size(&self) -> f64 {
        let harmonics = self.harmonics.iter().map(Harmonic::amplitude);
        let profiles = self.profiles.iter().map(Profile::size);
        let functions = self.functions.iter().map(Function::size);
        self.constant.abs() + harmonics.chain(profiles).chain(functions).sum::<f64>()
    }

    /// The largest angular frequency, of functions 1/timescale; 0 without harmonics and functions.
    pub(crate) fn fastest(&self) -> f64 {
        let frequencies = self.harmonics.iter().map(Harmonic::frequency);
        let frequencies = frequencies.chain(self.functions.iter().map(Function::fastest));
        frequencies.fold(0.0, |fastest, frequency| fastest.max(frequency.abs()))
    }

    /// The sum of two drives.
    pub(crate) fn plus(self, other: &Self) -> Result<Self, Error> {
        let mut sum = self.with_constant(other.constant)?;
        for harmonic in &other.harmonics {
            sum = sum.with_waves(harmonic.angular_frequency, harmonic.cosine, harmonic.sine)?;
        }
        sum.profiles.extend(other.profiles.iter().cloned());
        sum.functions.extend(other.functions.iter().cloned());
        Ok(sum)
    }

    /// The drive multiplied by a factor that is not 0.
    pub(crate) fn scaled(&self, factor: f64) -> Self {
        Self {
            constant: self.constant * factor,
            harmonics: self
                .harmonics
                .iter()
                .map(|wave| wave.scaled(factor))
                .collect(),
            profiles: self
                .profiles
                .iter()
                .map(|profile| profile.scaled(factor))
                .collect(),
            functions: self
                .functions
                .iter()
                .map(|function| function.scaled(factor))
                .collect(),
        }
    }

    /// Returns [`Error::InvalidParameter`] unless the drive of a contact is finite at all times.
    /// `name` is the name of the drive in the contact.
    pub(crate) fn check(&self, name: &'static str, allowed: &'static str) -> Result<(), Error> {
        Error::check("Contact", name, self.constant, true, allowed).map(drop)
    }

    /// Value and slope at a time; at a break those of the piece that begins there.
    pub(crate) fn at(&self, time: Clock) -> [f64; 2] {
        let harmonics = self.harmonics.iter().map(|harmonic| harmonic.at(time));
        let profiles = self.profiles.iter().map(|profile| profile.at(time));
        let functions = self.functions.iter().map(|function| function.at(time));
        harmonics
            .chain(profiles)
            .chain(functions)
            .fold([self.constant, 0.0], |sum, [value, slope]| {
                [sum[0] + value, sum[1] + slope]
            })
    }

    /// The value at a time; at a jump the value just before it.
    pub(crate) fn just_before(&self, time: f64) -> f64 {
        let clock = Clock::at(time);
        let harmonics = self.harmonics.iter().map(|harmonic| harmonic.at(clock)[0]);
        let profiles = self.profiles.iter();
        let profiles = profiles.map(|profile| profile.just_before(clock));
        let functions = self.functions.iter();
        let functions = functions.map(|function| function.just_before(clock));
        harmonics
            .chain(profiles)
            .chain(functions)
            .fold(self.constant, |sum, value| sum + value)
    }

    /// Power series in the time since `start`, of the piece that begins there or contains it.
    pub(crate) fn series(&self, start: Clock) -> PowerSeries {
        let mut series = PowerSeries::of(self.constant);
        for harmonic in &self.harmonics {
            harmonic.add_series(start, &mut series);
        }
        for profile in &self.profiles {
            let [value, slope] = profile.at(start);
            series[0] += value;
            series[1] += slope;
        }
        for function in &self.functions {
            series.add(1.0, &function.series(start));
        }
        series
    }

    /// The longest step from `start` in which functions of users are looked at often enough;
    /// infinite without them.
    pub(crate) fn foresight(&self, start: Clock) -> f64 {
        let functions = self.functions.iter();
        let steps = functions.map(|function| function.foresight(start));
        steps.fold(f64::INFINITY, f64::min)
    }

    /// The largest distance of each function of a user from its [`series`](Self::series), within a
    /// duration from `start` on and before the next break, and the size of the function.
    pub(crate) fn defects(&self, start: Clock, duration: f64) -> impl Iterator<Item = [f64; 2]> {
        let functions = self.functions.iter();
        functions.map(move |function| function.defect(start, duration))
    }

    /// The first time after `time` at which two pieces meet: a kink or a jump.
    pub(crate) fn next_break(&self, time: Clock) -> Option<f64> {
        let breaks = self
            .profiles
            .iter()
            .filter_map(|profile| profile.next_break(time));
        let functions = self.functions.iter();
        let breaks = breaks.chain(functions.filter_map(|function| function.next_break(time)));
        breaks.min_by(f64::total_cmp)
    }

    /// The times in [start, end] at which two pieces meet.
    pub(crate) fn breaks_in(&self, start: f64, end: f64) -> Vec<f64> {
        let mut breaks = Vec::new();
        let mut time = start;
        while let Some(next) = self.next_break(Clock::at(time)).filter(|&next| next <= end) {
            breaks.push(next);
            time = next;
        }
        breaks
    }

    /// The first time at which the drive jumps.
    pub(crate) fn first_jump(&self) -> Option<f64> {
        let functions = self.functions.iter().filter_map(Function::first_jump);
        self.jumps().chain(functions).min_by(f64::total_cmp)
    }

    /// Returns true if the drive jumps at this time.
    pub(crate) fn jumps_at(&self, time: f64) -> bool {
        let mut functions = self.functions.iter();
        self.jumps().any(|jump| jump == time) || functions.any(|function| function.jumps_at(time))
    }

    fn jumps(&self) -> impl Iterator<Item = f64> {
        self.profiles.iter().flat_map(Profile::jumps)
    }

    /// ∫ f dt from one time to a later one: in closed form, of functions by quadrature.
    pub(crate) fn integral(&self, from: Clock, to: Clock) -> f64 {
        let harmonics = self.harmonics.iter().map(|h| h.integral(from, to));
        let profiles = self.profiles.iter().map(|p| p.integral(from, to));
        let functions = self.functions.iter().map(|f| f.integral(from, to));
        let parts = harmonics.chain(profiles).chain(functions);
        self.constant * from.to(to) + parts.sum::<f64>()
    }
}

impl From<f64> for Drive {
    fn from(value: f64) -> Self {
        Self::constant(value)
    }
}

/// The least common period of several drives, as [`Drive::period`] defines it.
pub(crate) fn common_period<'d>(drives: impl IntoIterator<Item = &'d Drive>) -> Option<f64> {
    let (mut frequencies, mut periods) = (Vec::new(), Vec::new());
    for drive in drives {
        if !drive.profiles.is_empty() {
            return None;
        }
        frequencies.extend(drive.harmonics.iter().map(Harmonic::frequency));
        for function in &drive.functions {
            let period = function.period()?;
            frequencies.push(TAU / period);
            periods.push(period);
        }
    }
    let period = harmonic::common_period(&frequencies)?;
    // That of a function to the bit.
    let is_same = |given: &f64| (given - period).abs() <= 4.0 * f64::EPSILON * period;
    Some(periods.into_iter().find(is_same).unwrap_or(period))
}

#[cfg(feature = "serde")]
impl Drive {
    /// The drive from its written form.
    pub(crate) fn read(
        constant: f64,
        harmonics: &[Harmonic],
        profiles: &[Vec<(f64, f64)>],
    ) -> Result<Self, Error> {
        let mut drive = Self::constant(0.0).with_constant(constant)?;
        for &Harmonic {
            angular_frequency,
            cosine,
            sine,
        } in harmonics
        {
            Error::check("Drive", "cosine", cosine, true, "any size")?;
            Error::check("Drive", "sine", sine, true, "any size")?;
            drive = drive.with_waves(angular_frequency, cosine, sine)?;
        }
        for points in profiles {
            drive = drive.with_profile(points)?;
        }
        Ok(drive)
    }
}
