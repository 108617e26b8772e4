use crate::scalar::Scalar;

/// A function of time of any shape, such as a chirp, a shock or a window, for
/// [`Drive::function`](crate::Drive::function).
///
/// The function is generic over the number type, by the rules of [`Scalar`]; time and value have
/// the units of the driven system. It must be analytic (have a power series) at all times, except
/// at its [breakpoints](Self::breakpoints), where the value or a slope may jump.
///
/// ```
/// use stick_slip::{Drive, Scalar, Structure, TimeFunction, structure::State};
/// use std::f64::consts::PI;
///
/// /// A shock: half a sine of this duration and height.
/// struct Shock { duration: f64, height: f64 }
///
/// impl TimeFunction for Shock {
///     fn value<S: Scalar>(&self, time: S, piece: usize) -> S {
///         match piece {
///             1 => (time * (PI / self.duration)).sin() * self.height,
///             _ => time.constant(0.0),
///         }
///     }
///     fn size(&self) -> f64 {
///         self.height
///     }
///     fn timescale(&self, piece: usize) -> f64 {
///         if piece == 1 { self.duration / PI } else { f64::INFINITY }
///     }
///     fn breakpoints(&self) -> impl Iterator<Item = f64> {
///         [0.0, self.duration].into_iter()
///     }
/// }
///
/// // A shock of angular frequency 1 on an oscillator of angular frequency 2 at rest: at its end
/// // x = (sin π − sin(2π)/2)/3 = 0 and v = (cos π − cos 2π)/3 = −2/3.
/// let shock = Drive::function(Shock { duration: PI, height: 1.0 })?;
/// let oscillator = Structure::new(&[1.0])?.with_ground_spring(0, 4.0)?.with_force(0, shock)?;
/// let end = oscillator.simulate(State::at_rest(1), PI)?.last();
/// assert!(end.displacements[0].abs() < 1e-15 && (end.velocities[0] + 2.0 / 3.0).abs() < 1e-15);
/// # Ok::<(), stick_slip::Error>(())
/// ```
///
/// A chirp from angular frequency 0 to 2 in the time 100, and a train of Gaussian bumps with a
/// period:
///
/// ```
/// use stick_slip::{Drive, Scalar, TimeFunction};
///
/// struct Chirp;
///
/// impl TimeFunction for Chirp {
///     fn value<S: Scalar>(&self, time: S, piece: usize) -> S {
///         if piece == 0 { (time.square() * 0.01).cos() } else { time.constant(0.0) }
///     }
///     fn size(&self) -> f64 {
///         1.0
///     }
///     fn timescale(&self, piece: usize) -> f64 {
///         if piece == 0 { 0.5 } else { f64::INFINITY }
///     }
///     fn breakpoints(&self) -> impl Iterator<Item = f64> {
///         [100.0].into_iter()
///     }
/// }
///
/// struct Bumps;
///
/// impl TimeFunction for Bumps {
///     fn value<S: Scalar>(&self, time: S, _: usize) -> S {
///         (-((time - 1.0) / 0.01).square()).exp()
///     }
///     fn size(&self) -> f64 {
///         1.0
///     }
///     fn timescale(&self, _: usize) -> f64 {
///         0.01
///     }
///     fn period(&self) -> Option<f64> {
///         Some(2.0)
///     }
/// }
///
/// let chirp = Drive::constant(0.2).with_function(Chirp)?;
/// assert_eq!([chirp.value(0.0), chirp.value(1e3)], [1.2, 0.2]);
/// assert_eq!(chirp.slope(10.0), -0.2 * 1.0_f64.sin());
/// let bumps = Drive::function(Bumps)?;
/// assert_eq!((bumps.value(2e6 + 1.0), bumps.period()), (1.0, Some(2.0)));
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a function of time",
    note = "a closure cannot be one, because it is evaluated on power series, too; write \
            `struct MyFunction;` and `impl TimeFunction for MyFunction`"
)]
pub trait TimeFunction: Sized {
    /// The value f(t). `piece` is the number of [breakpoints](Self::breakpoints) at or before t.
    /// With a [period](Self::period) T, t is the time since the start of the period, from 0 to T.
    fn value<S: Scalar>(&self, time: S, piece: usize) -> S;

    /// The largest |f|, or an estimate of it. Errors of f are measured by it.
    fn size(&self) -> f64;

    /// The shortest time in which f changes noticeably on a piece: 1/Ω for a harmonic of angular
    /// frequency Ω, w for a bump exp(−(t/w)²). [`f64::INFINITY`] where f is constant or a
    /// polynomial.
    ///
    /// In every step f is evaluated twice at least in this time, so that no narrow feature is
    /// missed, and no step is longer than 512 times this time. Too short a time only costs
    /// evaluations of f.
    fn timescale(&self, piece: usize) -> f64;

    /// Times at which pieces of the function meet: finitely many, ascending. With a
    /// [period](Self::period) T they must lie in 0 ≤ t < T, and repeat. The function may also jump
    /// or have a kink at the start of each period, even if 0 is not among them; `piece` still
    /// counts only the times given here.
    fn breakpoints(&self) -> impl Iterator<Item = f64> {
        std::iter::empty()
    }

    /// The period T, if the function has one. The formula is evaluated for one period only, from 0
    /// to T.
    fn period(&self) -> Option<f64> {
        None
    }
}
