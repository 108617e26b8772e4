use super::equilibrium::Equilibrium;
use super::model::{Belt, Parameters};
use crate::error::{Error, Plain};
use crate::friction::{FrictionLaw, validate};
use crate::state::State;

/// A mass on a spring and a damper, on a belt that moves at constant velocity.
///
/// ```text
/// slip:   u'' + 2β u' + u + γ² μ(u' − v_b) = 0,    μ(v_r) = sgn(v_r)·μ̂(|v_r|)
/// stick:  u' = v_b  while |u + 2β v_b| ≤ γ² μ_s
/// ```
///
/// Everything is dimensionless: time τ = ω0 t with the natural frequency ω0, displacement u,
/// velocity v = u', damping ratio β, friction load γ², belt velocity v_b, relative velocity v_r = v
/// − v_b. The friction law has the static coefficient μ_s and the kinetic coefficient μ̂(s) at the
/// sliding speed s.
///
/// In stick the contact transmits the force F = u + 2βv_b. The band of F in which the mass sticks
/// is half open, so that exactly one motion follows from every state:
///
/// * v_b > 0: −γ²μ_s ≤ F < γ²μ_s. At F = γ²μ_s the mass is released.
/// * v_b < 0: −γ²μ_s < F ≤ γ²μ_s, the mirror image.
/// * v_b = 0: −γ²μ_s ≤ F ≤ γ²μ_s. A sticking mass stays at rest for ever.
///
/// Source: Farshidianfar and Noei Aghaee, *Analytical Approaches for Friction Induced Vibration and
/// Stability Analysis*, Eqs. 1 and 2. Eq. 2 is corrected here: the paper prints the stick condition
/// as 2βv_b + u ≤ μ_s, one-sided and without γ².
///
/// ```
/// use stick_slip::{MassOnBelt, Polynomial, State};
///
/// let law = Polynomial::new(0.4, 0.25, 0.5)?;
/// let system = MassOnBelt::new(law, 0.2)?.with_damping(0.05)?;
/// assert_eq!(system.load(), 1.0);
/// assert_eq!(system.release_state(), Some(State::new(0.4 - 2.0 * 0.05 * 0.2, 0.2)));
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[doc(alias = "oscillator")]
#[doc(alias = "brake")]
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "super::read::MassOnBelt<L>"),
    serde(bound(deserialize = "L: FrictionLaw + serde::Deserialize<'de>"))
)]
pub struct MassOnBelt<L> {
    law: L,
    belt_velocity: f64,
    damping: f64,
    load: f64,
}

impl<L: FrictionLaw> MassOnBelt<L> {
    /// Creates an undamped system (β = 0) with friction load γ² = 1, on a belt of velocity v_b
    /// (dimensionless), which may be negative or zero.
    ///
    /// # Errors
    ///
    /// * [`Error::InvalidParameter`] if v_b or μ_s is not finite, μ_s < 0 or μ̂(0) < 0
    ///   ([`check_law`](crate::check_law) finds other speeds at which a law is negative);
    /// * [`Error::StaticBelowKinetic`] if μ̂(0) exceeds μ_s by more than rounding errors;
    /// * [`Error::NonFiniteFriction`] or [`Error::NotAnalytic`] if the law has no finite value or
    ///   slope at the speeds 0 and |v_b|;
    /// * [`Error::BadBreakpoints`] if the law's breakpoints are not positive and ascending, or the
    ///   law jumps at one of them.
    pub fn new(law: L, belt_velocity: f64) -> Result<Self, Error> {
        validate(&law)?;
        Self::unchecked(law, belt_velocity)
    }

    /// A system whose law is not checked. Friction may then be a negative constant, which drives
    /// the mass also at speed 0: these growing motions have closed forms, for tests.
    pub(crate) fn unchecked(law: L, belt_velocity: f64) -> Result<Self, Error> {
        Self {
            law,
            belt_velocity: 0.0,
            damping: 0.0,
            load: 1.0,
        }
        .with_belt_velocity(belt_velocity)
    }

    /// Sets the damping ratio β ≥ 0, dimensionless. The damper's force is 2β u'.
    ///
    /// # Errors
    ///
    /// [`Error::InvalidParameter`] if β is negative or not finite, or 2βv_b overflows.
    #[doc(alias = "critical damping")]
    pub fn with_damping(mut self, damping: f64) -> Result<Self, Error> {
        let checked = self.parameters().with_damping(damping, &self.law)?;
        self.damping = checked.damping;
        Ok(self)
    }

    /// Sets the friction load γ² > 0, dimensionless. The friction force is γ² μ.
    ///
    /// In physical units γ² = N/(K L), for a normal force N, a stiffness K and the unit of length
    /// L.
    ///
    /// # Errors
    ///
    /// [`Error::InvalidParameter`] if γ² is not positive and finite, or γ²μ_s overflows.
    pub fn with_load(mut self, load: f64) -> Result<Self, Error> {
        let checked = self.parameters().with_load(load, &self.law)?;
        self.load = checked.load;
        Ok(self)
    }

    /// Sets the belt velocity v_b, dimensionless.
    ///
    /// # Errors
    ///
    /// [`Error::InvalidParameter`] if v_b is not finite or 2βv_b overflows;
    /// [`Error::NonFiniteFriction`] or [`Error::NotAnalytic`] if the law has no finite value or
    /// slope at the speed |v_b|.
    pub fn with_belt_velocity(mut self, belt_velocity: f64) -> Result<Self, Error> {
        let checked = self
            .parameters()
            .with_belt_velocity(belt_velocity, &self.law)?;
        self.belt_velocity = checked.belt_velocity;
        Ok(self)
    }
}

impl<L> MassOnBelt<L> {
    /// The friction law.
    pub fn law(&self) -> &L {
        &self.law
    }

    /// Belt velocity v_b, dimensionless.
    pub fn belt_velocity(&self) -> f64 {
        self.belt_velocity
    }

    /// Damping ratio β, dimensionless.
    pub fn damping(&self) -> f64 {
        self.damping
    }

    /// Friction load γ², dimensionless.
    pub fn load(&self) -> f64 {
        self.load
    }

    fn parameters(&self) -> Parameters {
        Parameters {
            belt_velocity: self.belt_velocity,
            damping: self.damping,
            load: self.load,
        }
    }
}

impl<L: FrictionLaw> MassOnBelt<L> {
    /// The system for the engines.
    pub(crate) fn belt(&self) -> Belt<'_> {
        Belt {
            law: self.law.erased().law(),
            parameters: self.parameters(),
        }
    }

    /// The displacements between which the mass can stick, −γ²μ_s − 2βv_b and γ²μ_s − 2βv_b,
    /// dimensionless.
    ///
    /// Every decision between stick and slip compares u with these two numbers. The release state
    /// has the second displacement if v_b > 0, the first one if v_b < 0.
    ///
    /// ```
    /// use stick_slip::{Coulomb, MassOnBelt};
    ///
    /// let system = MassOnBelt::new(Coulomb::new(0.5, 0.25)?, 0.5)?
    ///     .with_load(2.0)?
    ///     .with_damping(0.25)?;
    /// assert_eq!(system.stick_limits(), [-1.25, 0.75]);
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    pub fn stick_limits(&self) -> [f64; 2] {
        self.belt().stick_limits()
    }

    /// The release point, dimensionless: the state u = sgn(v_b)·γ²μ_s − 2βv_b, v = v_b, in which
    /// stick ends. `None` if v_b = 0, because a sticking mass is then at rest for ever.
    pub fn release_state(&self) -> Option<State> {
        self.belt().release_state()
    }

    /// The friction force on the mass, dimensionless (in units of the spring's force at u = 1).
    ///
    /// In slip the force is −γ²μ(v_r). In stick it is u + 2βv_b, the force that the contact
    /// transmits. If v_r is 0 and u lies outside the stick band, the result is the force just after
    /// slip begins. If the law overflows at this speed, the result is ±∞. If the law returns NaN,
    /// so does this function; a [`Polynomial`](crate::Polynomial) with μ_m = μ_s does so above a
    /// speed of 1e154.
    ///
    /// ```
    /// use stick_slip::{Coulomb, MassOnBelt, State};
    ///
    /// let system = MassOnBelt::new(Coulomb::new(0.4, 0.25)?, 0.2)?;
    /// assert_eq!(system.friction_force(State::new(0.0, 0.0)), 0.25); // the belt drags it forward
    /// assert_eq!(system.friction_force(State::new(0.1, 0.2)), 0.1); // stick
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    pub fn friction_force(&self, state: impl Into<State>) -> f64 {
        self.belt().friction_force(state.into())
    }

    /// The acceleration u'' of the mass, dimensionless: in slip −2βv − u plus the friction force,
    /// in stick 0.
    ///
    /// ```
    /// use stick_slip::{Coulomb, MassOnBelt, State};
    ///
    /// let system = MassOnBelt::new(Coulomb::new(0.4, 0.25)?, 0.2)?;
    /// assert_eq!(system.acceleration(State::new(1.0, 0.0)), -0.75);
    /// assert_eq!(system.acceleration(State::new(0.1, 0.2)), 0.0);
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    pub fn acceleration(&self, state: impl Into<State>) -> f64 {
        self.belt().acceleration(state.into())
    }

    /// The equilibrium of steady sliding, in which the mass stands still on the moving belt. `None`
    /// if v_b = 0, because the mass can then rest anywhere in the stick band.
    ///
    /// See [`Equilibrium`] for the formulas and an example.
    pub fn equilibrium(&self) -> Option<Equilibrium> {
        self.belt().equilibrium()
    }
}

/// Shows the parameters; a law need not implement `Debug`.
///
/// ```
/// use stick_slip::{MassOnBelt, Polynomial};
///
/// let system = MassOnBelt::new(Polynomial::new(0.4, 0.25, 0.5)?, 0.2)?.with_damping(0.05)?;
/// assert_eq!(system.to_string(), "mass on a belt: v_b = 0.2, β = 0.05, γ² = 1");
/// # Ok::<(), stick_slip::Error>(())
/// ```
impl<L> std::fmt::Display for MassOnBelt<L> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self {
            belt_velocity,
            damping,
            load,
            ..
        } = self;
        let [v_b, beta, load] = [*belt_velocity, *damping, *load].map(Plain);
        write!(f, "mass on a belt: v_b = {v_b}, β = {beta}, γ² = {load}")
    }
}
