use super::{ContactLaw, Motion, NamedLaw, Slip};
use crate::error::Error;
use crate::friction::FrictionLaw;
use crate::friction::law_object::{LawRef, Own};
use crate::scalar::Scalar;

/// Static friction that rises with the time in stick.
///
/// ```text
/// exponential   μ_s(θ) = μ_∞ − (μ_∞ − μ_0) exp(−θ/θ_c)
/// hyperbolic    μ_s(θ) = μ_0 + (μ_∞ − μ_0) θ/(θ + θ_c)
/// logarithmic   μ_s(θ) = μ_0 + B ln(1 + θ/θ_c)
/// ```
///
/// μ_s is the static coefficient. The only memory variable is θ, the time since the beginning of
/// stick. θ is 0 in slip, and starts from 0 at a [`Stick`](crate::EventKind::Stick) event. The
/// state of a release event contains the value of θ just before the release. The start state of a
/// motion that starts in stick may contain θ > 0. μ_∞ is the limit of μ_s, θ_c a time constant, and
/// B the rate of the logarithmic form. A dry law gives the kinetic coefficient and the static
/// coefficient μ_0 at θ = 0. Coefficients are dimensionless, times in the units of the structure.
/// [`analysis::dwell`](crate::analysis::dwell) has closed forms for one mass on a belt.
///
/// Source: B. Armstrong-Hélouvry, *Control of Machines with Friction*, Kluwer 1991 (hyperbolic);
/// J. H. Dieterich, *J. Geophys. Res.* 84 (1979) 2161-2168 (logarithmic).
///
/// ```
/// use stick_slip::{Contact, Coulomb, Dwell, EventKind, Structure, structure::State};
///
/// // ΔF = 0.5, θ_c = 2, k = 1, v = 0.2: sticks for θ* = 2ΔF/(kv) − θ_c = 3 in each cycle.
/// let law = Dwell::hyperbolic(Coulomb::new(0.5, 0.5)?, 1.0, 2.0)?;
/// let block = Structure::new(&[1.0])?
///     .with_ground_spring(0, 1.0)?
///     .with_contact(Contact::new(0, law, 1.0)?.on_belt(0.2))?;
/// let motion = block.simulate(State::new(&[0.5], &[0.2]), 300.0)?;
/// let releases = motion.events().iter().filter(|e| matches!(e.kind, EventKind::Release(_)));
/// let stuck = releases.last().unwrap().state.memory[0];
/// assert!((stuck - 3.0).abs() < 1e-12);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(into = "super::read::Dwell<L>", try_from = "super::read::Dwell<L>"),
    serde(bound(
        serialize = "L: Clone + serde::Serialize",
        deserialize = "L: FrictionLaw + serde::Deserialize<'de>"
    ))
)]
pub struct Dwell<L> {
    pub(super) law: L,
    pub(super) form: Rise,
    /// The time θ_c.
    pub(super) time: f64,
}

/// The form of the rise, with μ_∞ or B.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Rise {
    Exponential(f64),
    Hyperbolic(f64),
    Logarithmic(f64),
}

impl<L: FrictionLaw> Dwell<L> {
    /// Creates a law whose static coefficient rises exponentially to the limit μ_∞, with the time
    /// constant θ_c.
    ///
    /// # Errors
    ///
    /// [`Error::InvalidParameter`] unless μ_∞ is finite and at least the law's static coefficient,
    /// and θ_c is positive and finite.
    pub fn exponential(law: L, limit: f64, time: f64) -> Result<Self, Error> {
        check_limit(&law, limit)?;
        Self::new(law, Rise::Exponential(limit), time)
    }

    /// Creates a law whose static coefficient rises to the limit μ_∞ along a hyperbola. After the
    /// time θ_c the coefficient has risen by half of μ_∞ − μ_0.
    ///
    /// # Errors
    ///
    /// The errors of [`exponential`](Self::exponential).
    pub fn hyperbolic(law: L, limit: f64, time: f64) -> Result<Self, Error> {
        check_limit(&law, limit)?;
        Self::new(law, Rise::Hyperbolic(limit), time)
    }

    /// Creates a law whose static coefficient rises without bound, like the logarithm of the time
    /// in stick. At times far above θ_c, μ_s rises by B while the time grows by the factor e.
    ///
    /// # Errors
    ///
    /// [`Error::InvalidParameter`] unless B ≥ 0 and θ_c > 0, both finite.
    pub fn logarithmic(law: L, rate: f64, time: f64) -> Result<Self, Error> {
        Error::check("Dwell", "rate", rate, rate >= 0.0, "rate ≥ 0")?;
        Self::new(law, Rise::Logarithmic(rate), time)
    }

    fn new(law: L, form: Rise, time: f64) -> Result<Self, Error> {
        Error::check("Dwell", "time", time, time > 0.0, "time > 0")?;
        Ok(Self { law, form, time })
    }

    /// The dry law, which gives μ_0 and the kinetic coefficient.
    pub fn law(&self) -> &L {
        &self.law
    }

    /// Static coefficient μ_s(θ) after a time θ ≥ 0 in stick, dimensionless.
    ///
    /// ```
    /// use stick_slip::{Coulomb, Dwell};
    ///
    /// let law = Dwell::hyperbolic(Coulomb::new(0.4, 0.3)?, 0.6, 2.0)?;
    /// assert_eq!(law.static_coefficient(0.0), 0.4);
    /// assert_eq!(law.static_coefficient(2.0), 0.5);
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    pub fn static_coefficient(&self, rest: f64) -> f64 {
        self.law.static_coefficient() + self.rise(rest)[0]
    }

    /// Rate dμ_s/dθ after a time θ ≥ 0 in stick, per unit of time.
    ///
    /// ```
    /// use stick_slip::{Coulomb, Dwell};
    ///
    /// // B/(θ + θ_c)
    /// let law = Dwell::logarithmic(Coulomb::new(0.4, 0.3)?, 0.1, 2.0)?;
    /// assert_eq!(law.static_rate(2.0), 0.025);
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    pub fn static_rate(&self, rest: f64) -> f64 {
        self.rise(rest)[1]
    }

    /// μ_s(θ) − μ_0, exact for small θ too, and its rate.
    pub(crate) fn rise(&self, rest: f64) -> [f64; 2] {
        /// A rest after which the limit is reached to rounding; θ may overflow.
        const LONG: f64 = 1e200;
        let theta = match rest / self.time {
            theta if theta > LONG => LONG,
            theta => theta,
        };
        let [rise, slope] = match self.form {
            Rise::Exponential(limit) => {
                let largest = limit - self.law.static_coefficient();
                [-(-theta).exp_m1() * largest, (-theta).exp() * largest]
            }
            Rise::Hyperbolic(limit) => {
                let part = (limit - self.law.static_coefficient()) / (theta + 1.0);
                [theta * part, part / (theta + 1.0)]
            }
            Rise::Logarithmic(rate) => {
                let grown = if theta < LONG {
                    theta.ln_1p()
                } else {
                    rest.ln() - self.time.ln()
                };
                [grown * rate, rate / (theta + 1.0)]
            }
        };
        [rise, slope / self.time]
    }
}

fn check_limit(law: &impl FrictionLaw, limit: f64) -> Result<(), Error> {
    let is_reached = limit >= law.static_coefficient();
    let allowed = "limit ≥ static coefficient of the law";
    Error::check("Dwell", "limit", limit, is_reached, allowed).map(drop)
}

impl<L: FrictionLaw> ContactLaw for Dwell<L> {
    type Memory<S: Scalar> = [S; 1];

    #[inline(always)]
    fn coefficient<S: Scalar>(&self, slip: Slip<S>, _: [S; 1]) -> S {
        self.law.kinetic_on(slip.piece, slip.speed) * slip.direction
    }

    #[inline]
    fn limit<S: Scalar>(&self, _: S, [rest]: [S; 1]) -> Option<S> {
        let theta = rest / self.time;
        let first = self.law.static_coefficient();
        let risen = match self.form {
            Rise::Exponential(limit) => ((-theta).exp() - 1.0) * (first - limit),
            Rise::Hyperbolic(limit) => theta / (theta + 1.0) * (limit - first),
            Rise::Logarithmic(rate) => (theta + 1.0).ln() * rate,
        };
        Some(risen + first)
    }

    #[inline(always)]
    fn rates<S: Scalar>(&self, motion: Motion<S>, _: S, [rest]: [S; 1]) -> [S; 1] {
        [rest.constant(match motion {
            Motion::Stick => 1.0,
            Motion::Slip(_) => 0.0,
        })]
    }

    fn breakpoints(&self) -> impl Iterator<Item = f64> {
        self.law.breakpoints()
    }

    fn caught(&self, _: [f64; 1]) -> [f64; 1] {
        [0.0]
    }

    fn named(&self) -> Option<NamedLaw> {
        let Self { form, time, .. } = *self;
        let law = self.law.any(Own)?;
        Some(NamedLaw::Contact(Dwell { law, form, time }.into()))
    }

    fn dry_slip(&self, _: f64) -> Option<LawRef<'_>> {
        Some(self.law.erased())
    }
}
