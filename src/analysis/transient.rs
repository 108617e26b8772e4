use crate::error::Error;
use crate::state::State;

/// Slow growth or decay of a vibration without stick, for the polynomial law, in closed form.
///
/// The displacement u vibrates about the equilibrium ū: u − ū = A sin ψ with ψ = τ + φ and the time
/// τ. Amplitude A and phase shift φ obey the equations on the left; their solution is on the right:
///
/// ```text
/// A' = −½ h1 A − (3/8) h3 A³     ⇒  A(τ) = A(0) / √(e^{h1 τ} + ¾ h3 A(0)² (e^{h1 τ} − 1)/h1)
/// φ' = 0                         ⇒  ψ(τ) = ψ(0) + τ
/// u ≈ ū + A sin ψ,  v ≈ A cos ψ
/// ```
///
/// v is the velocity; h1 and h3 are those of [`PureSlip`](super::PureSlip). The first equation is a
/// Bernoulli equation: it is linear in 1/A². All quantities are dimensionless. Errors are O(ε),
/// with ε of [`analysis`](super), for times up to O(1/ε), as long as A(τ) does not exceed the belt
/// speed |v_b|.
///
/// Source: Farshidianfar and Noei Aghaee, Eq. 12, corrected: the right sides must be means over a
/// cycle, and A' = 0 on limit cycles only. [`PureSlip::transient`](super::PureSlip::transient)
/// returns this type.
///
/// ```
/// use stick_slip::analysis::PureSlip;
/// use stick_slip::{MassOnBelt, Polynomial};
///
/// let system = MassOnBelt::new(Polynomial::new(0.4, 0.25, 0.5)?, 0.42)?.with_damping(0.05)?;
/// let formulas = PureSlip::new(&system).unwrap();
/// let growth = formulas.transient(0.01, 0.0)?;
/// assert_eq!(growth.amplitude(0.0), Some(0.01));
/// assert!((growth.amplitude(100.0).unwrap() - 0.0498857218).abs() < 1e-10);
/// assert!((growth.amplitude(1e6).unwrap() - formulas.amplitude().unwrap()).abs() < 1e-15);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Transient {
    equilibrium: f64,
    h1: f64,
    h3: f64,
    initial_amplitude: f64,
    initial_phase: f64,
}

impl Transient {
    pub(super) fn new(
        [equilibrium, h1, h3]: [f64; 3],
        initial_amplitude: f64,
        initial_phase: f64,
    ) -> Result<Self, Error> {
        Error::check(
            "PureSlip",
            "initial_amplitude",
            initial_amplitude,
            initial_amplitude >= 0.0,
            "initial_amplitude ≥ 0",
        )?;
        Error::check(
            "PureSlip",
            "initial_phase",
            initial_phase,
            true,
            "any value",
        )?;
        Ok(Self {
            equilibrium,
            h1,
            h3,
            initial_amplitude,
            initial_phase,
        })
    }

    /// Amplitude A(τ), dimensionless. Backwards in time the amplitude may grow without bound. The
    /// result is `None` at and before the time at which A = ∞, and for a time that is NaN.
    pub fn amplitude(&self, time: f64) -> Option<f64> {
        let (a, h1) = (self.initial_amplitude, self.h1);
        if a == 0.0 && !time.is_nan() {
            return Some(0.0);
        }
        // 1/A² = e^{h1τ}/A(0)² + ¾h3(e^{h1τ} − 1)/h1, with the factor that overflows taken out.
        let amplitude = if time < 0.0 {
            // Multiplies twice by the fourth root of e^{−h1τ}, because its square root may
            // overflow.
            let quarter = (-0.25 * h1 * time).exp();
            let cubic = 0.75 * self.h3 * a;
            let past = if cubic == 0.0 {
                0.0
            } else {
                cubic * growth(-h1, time) * a
            };
            a * quarter * quarter / (1.0 + past).sqrt()
        } else {
            let half = (0.5 * h1 * time).exp();
            if h1 < 0.0 {
                (half / a)
                    .hypot((0.75 * self.h3 * growth(h1, time)).sqrt())
                    .recip()
            } else {
                let limit = (0.75 * self.h3 * growth(-h1, time)).sqrt();
                a.recip().hypot(limit).recip() / half
            }
        };
        amplitude.is_finite().then_some(amplitude)
    }

    /// Phase ψ(τ) = ψ(0) + τ of the vibration u − ū = A sin ψ, in radians.
    pub fn phase(&self, time: f64) -> f64 {
        self.initial_phase + time
    }

    /// State (u, v) = (ū + A sin ψ, A cos ψ), dimensionless. `None` if
    /// [`amplitude`](Self::amplitude) is `None`, or if a sum overflows.
    ///
    /// ```
    /// use stick_slip::analysis::PureSlip;
    /// use stick_slip::{MassOnBelt, Polynomial};
    ///
    /// let system = MassOnBelt::new(Polynomial::new(0.4, 0.25, 0.5)?, 0.42)?.with_damping(0.05)?;
    /// let start = PureSlip::new(&system).unwrap().transient(0.1, 0.0)?.state(0.0).unwrap();
    /// assert!((start.displacement - 0.2554528).abs() < 1e-15);
    /// assert_eq!(start.velocity, 0.1);
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    pub fn state(&self, time: f64) -> Option<State> {
        let (sine, cosine) = self.phase(time).sin_cos();
        self.amplitude(time)
            .map(|a| State::new(self.equilibrium + a * sine, a * cosine))
            .filter(|state| state.displacement.is_finite())
    }
}

/// The quotient (e^{hτ} − 1)/h, which is τ for h = 0.
fn growth(h: f64, time: f64) -> f64 {
    if h == 0.0 {
        time
    } else {
        (h * time).exp_m1() / h
    }
}
