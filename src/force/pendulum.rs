use super::ForceLaw;
use crate::error::Error;
use crate::scalar::Scalar;

/// The restoring force of a pendulum, at any angle.
///
/// ```text
/// F(x) = A sin(x/l),   U(x) = A l (1 − cos(x/l))
/// ```
///
/// F is the force at the position x, and U its potential. x/l is the angle from the hanging
/// position in radians, and A the largest force:
///
/// | coordinate | inertia | A | l |
/// |---|---|---|---|
/// | angle of a pendulum of mass m and length L | m L² | m g L | 1 rad |
/// | arc length along the circle | m | m g | L |
///
/// The pendulum may turn over. Its angle then grows with each turn, so the searches for periodic
/// motions do not find such a motion. Its pivot is at rest: the mass matrix of a structure is
/// constant. A < 0 is an inverted pendulum. The same force acts between the rotor and the field of
/// a synchronous machine, and across a Josephson junction.
///
/// Source: NIST Digital Library of Mathematical Functions, <https://dlmf.nist.gov/22.19>, part (i).
///
/// ```
/// use stick_slip::{ForceElement, ForceLaw, Pendulum, Structure, structure::State};
///
/// let pendulum = Pendulum::new(9.81, 1.0)?;
/// assert_eq!(pendulum.force(0.5, 0.0, 0), 9.81 * 0.5_f64.sin());
///
/// // Free vibration of amplitude 2 rad: the period is 4 K(sin² 1) √(l/g), where K is the complete
/// // elliptic integral.
/// let pendulum = Structure::new(&[1.0])?.with_element(ForceElement::new(0, pendulum)?)?;
/// let period = 8.349752926918494734406372 / 9.81_f64.sqrt();
/// let motion = pendulum.simulate(State::new(&[2.0], &[0.0]), period)?;
/// assert!((motion.last().displacements[0] - 2.0).abs() < 1e-14);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "super::read::Pendulum")
)]
pub struct Pendulum {
    moment: f64,
    length: f64,
}

impl Pendulum {
    /// Creates a pendulum with the largest force or moment A, and the length l (1 if the position
    /// is an angle).
    ///
    /// # Errors
    ///
    /// [`Error::InvalidParameter`] unless A is finite, l > 0, and A/l and A l neither overflow nor
    /// underflow.
    pub fn new(moment: f64, length: f64) -> Result<Self, Error> {
        let of = "Pendulum";
        Error::check(of, "moment", moment, true, "a moment of any size")?;
        let sizes = [moment / length, moment * length];
        let in_range = moment == 0.0 || sizes.iter().all(|size| size.is_normal());
        let allowed = "length > 0, and moment/length and moment·length within the range of f64";
        let is_length = length > 0.0 && in_range;
        Error::check(of, "length", length, is_length, allowed)?;
        Ok(Self { moment, length })
    }

    /// The largest force or moment A, in units of force.
    pub fn moment(&self) -> f64 {
        self.moment
    }

    /// The length l, in units of position: F is 0 at multiples of πl.
    pub fn length(&self) -> f64 {
        self.length
    }
}

impl ForceLaw for Pendulum {
    #[inline(always)]
    fn force<S: Scalar>(&self, position: S, _: S, _: usize) -> S {
        (position / self.length).sin() * self.moment
    }

    fn potential<S: Scalar>(&self, position: S, _: usize) -> Option<S> {
        // 1 − cos φ = 2 sin²(φ/2), without the difference of near numbers for small φ.
        let half = position / self.length * 0.5;
        Some(half.sin().square() * 2.0 * self.moment * self.length)
    }
}
