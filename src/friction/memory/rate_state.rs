use super::{ContactLaw, Motion, NamedLaw, Slip, Variables};
use crate::error::Error;
use crate::scalar::Scalar;

/// Rate-and-state friction: the coefficient depends on the logarithm of the sliding speed and of a
/// state variable θ, the mean age of the asperities.
///
/// ```text
/// μ(r, φ) = a arsinh( r/(2V₀) exp((f₀ + bφ)/a) )          φ = ln(V₀θ/D_c)
///
/// aging   θ' = 1 − Vθ/D_c                   φ' = (V₀ e^{−φ} − V)/D_c
/// slip    θ' = −(Vθ/D_c) ln(Vθ/D_c)         φ' = −(V/D_c)(ln(V/V₀) + φ)
/// ```
///
/// r is the relative velocity, V = |r| the sliding speed. The only memory variable is φ, because θ
/// spans as many decades as the speed. Except at speeds that are lower by tens of decades, μ = f₀ +
/// a ln(V/V₀) + bφ. In steady sliding φ = −ln(V/V₀) and μ = f₀ + (a − b) ln(V/V₀) for both laws:
/// friction falls with the speed if b > a. f₀, a and b are dimensionless, D_c is in units of
/// length, V₀ in units of velocity. A law with [two state variables](Self::with_second_state) has
/// the sum b₁φ₁ + b₂φ₂ in place of bφ, and a rate for each with its own D_c.
///
/// There is no stick mode: a contact that seems to stick creeps, and every change of sign of r is a
/// [`Crossing`](crate::EventKind::Crossing). Under the aging law a motion passes r = 0. In the slip
/// law V ln V is not analytic there, so a motion that reverses ends with [`Error::NotAnalytic`]
/// unless the law has a [least speed](Self::with_least_speed). φ also changes, by the same rates,
/// [while the contact is open](ContactLaw::changes_while_open).
///
/// Where the contact creeps, its speed settles at the rate N a/(m V), much faster than the motion
/// changes. The motion is then followed on its slow manifold: a seismic cycle from 1e-15 to 0.4 m/s
/// takes some 170 steps. With any method, the speed has a relative error of about ε μ/a (ε =
/// 2.2e-16), because a relative change of the speed by this amount changes μ by a rounding error.
///
/// The mass must not be 0: for a motion without inertia take a small mass m. Its relative effect on
/// a period is proportional to m: 5e-8 for m = 1e-6 η²/k, with the damping η of radiated waves and
/// the stiffness k. Let the surface move with the plate, as in the example below, so that no number
/// grows with time.
///
/// To find a cycle, start [`shoot`](crate::orbit::shoot) from a state between two earthquakes, for
/// example from a passage of [`section_through`](crate::orbit::section_through) at which the
/// contact becomes slow. The multipliers of the cycle have an error of some 1e-12. The eigenvalues
/// of steady sliding are accurate however large the rate N a/(m V) is, so
/// [`begin`](crate::orbit::begin) and [`hopf_locus`](crate::bifurcation::hopf_locus()) find the
/// critical stiffness at any speed.
///
/// Sources: J. H. Dieterich, *J. Geophys. Res.* 84 (1979) 2161-2168 (aging); A. Ruina, *J. Geophys.
/// Res.* 88 (1983) 10359-10370 (slip); J. R. Rice, N. Lapusta, K. Ranjith, *J. Mech. Phys. Solids*
/// 49 (2001) 1865-1898 (the form with arsinh).
///
/// ```
/// use stick_slip::{Contact, ContactLaw, RateState, Slip, Structure, structure::State};
///
/// let law = RateState::aging(0.6, 0.01, 0.015, 1e-5, 1e-6)?;
/// assert_eq!(law.steady(1e-6), 0.6);
/// assert!((law.steady(1e-5) - (0.6 - 0.005 * 10_f64.ln())).abs() < 1e-15);
/// // From 1 to 10 µm/s: friction first rises by a ln 10.
/// let slip = Slip { speed: 1e-5, direction: 1.0, piece: 0 };
/// let risen = law.coefficient(slip, [law.memory_at(1e-6)]);
/// assert!((risen - (0.6 + 0.01 * 10_f64.ln())).abs() < 1e-15);
///
/// // An oscillation that grows until the mass overtakes its belt.
/// let law = RateState::aging(0.4, 0.1, 0.3, 0.06, 0.05)?;
/// let slider = Structure::new(&[1.0])?
///     .with_ground_spring(0, 1.0)?
///     .with_ground_damper(0, 0.02)?
///     .with_contact(Contact::new(0, law, 1.0)?.on_belt(0.05))?;
/// let motion = slider.simulate(State::new(&[0.35], &[0.01]).with_memory(&[0.0]), 20.0)?;
/// assert!((motion.events()[0].time - 16.28097264673667).abs() < 1e-13);
///
/// // A fault, per unit of area: 16 years after the start its speed is 4e-14 m/s.
/// let (plate, radiation) = (1e-9, 4.6e6);
/// let fault = Structure::new(&[3.90625e6])?
///     .with_ground_spring(0, 1.5625e7)?
///     .with_ground_damper(0, radiation)?
///     .with_force(0, radiation * plate)?
///     .with_contact(
///         Contact::new(0, RateState::aging(0.6, 0.01, 0.015, 0.008, 1e-6)?, 5e7)?.on_belt(plate),
///     )?;
/// let start = State::new(&[1.92], &[0.0]).with_memory(&[6.9]).with_sliding(0, -1.2e-9);
/// let motion = fault.simulate(start, 5e8)?;
/// assert!((motion.sliding_velocity(0, 4.65e8) / -4.069317410992138e-14 - 1.0).abs() < 1e-12);
/// assert!(motion.steps().len() < 250);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(into = "super::read::RateState", try_from = "super::read::RateState")
)]
pub struct RateState<const STATES: usize = 1> {
    pub(crate) evolution: Evolution,
    pub(super) f0: f64,
    pub(crate) a: f64,
    pub(crate) v0: f64,
    pub(crate) states: [StateVariable; STATES],
    /// V_m; 0 if none is set.
    pub(super) least_speed: f64,
}

/// A [`RateState`] law with two state variables, made by
/// [`with_second_state`](RateState::with_second_state).
pub type RateState2 = RateState<2>;

/// The law by which the state variables change.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Evolution {
    Aging,
    Slip,
}

/// The numbers of one state variable.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct StateVariable {
    pub(crate) b: f64,
    pub(crate) d_c: f64,
}

impl RateState {
    /// Creates a law with the aging law (Dieterich's law): the state changes at rest, too.
    ///
    /// f₀ is the coefficient of steady sliding at the speed V₀, a the direct effect, b the effect
    /// of the state, D_c the length over which the state changes.
    ///
    /// # Errors
    ///
    /// [`Error::InvalidParameter`] unless a > 0, D_c > 0, V₀ > 0, and all numbers are finite.
    pub fn aging(f0: f64, a: f64, b: f64, d_c: f64, v0: f64) -> Result<Self, Error> {
        Self::new(Evolution::Aging, f0, a, b, d_c, v0)
    }

    /// Creates a law with the slip law (Ruina's law): the state changes in slip only. The arguments
    /// are those of [`aging`](Self::aging).
    ///
    /// # Errors
    ///
    /// The errors of [`aging`](Self::aging).
    pub fn slip(f0: f64, a: f64, b: f64, d_c: f64, v0: f64) -> Result<Self, Error> {
        Self::new(Evolution::Slip, f0, a, b, d_c, v0)
    }

    pub(super) fn new(
        evolution: Evolution,
        f0: f64,
        a: f64,
        b: f64,
        d_c: f64,
        v0: f64,
    ) -> Result<Self, Error> {
        Error::check("RateState", "f0", f0, true, "any size")?;
        Error::check("RateState", "a", a, a > 0.0, "a > 0")?;
        Error::check("RateState", "v0", v0, v0 > 0.0, "v0 > 0")?;
        Ok(Self {
            evolution,
            f0,
            a,
            v0,
            states: [StateVariable::new(["b", "d_c"], b, d_c)?],
            least_speed: 0.0,
        })
    }

    /// Adds a second state variable, with its own b₂ and D_c2 and the same evolution law.
    ///
    /// # Errors
    ///
    /// [`Error::InvalidParameter`] unless D_c2 > 0 and both numbers are finite.
    ///
    /// ```
    /// use stick_slip::RateState;
    ///
    /// let law = RateState::slip(0.6, 0.01, 0.012, 1e-5, 1e-6)?.with_second_state(0.004, 1e-4)?;
    /// assert!((law.steady(1e-5) - (0.6 - 0.006 * 10_f64.ln())).abs() < 1e-15);
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    pub fn with_second_state(self, b2: f64, d_c2: f64) -> Result<RateState2, Error> {
        let second = StateVariable::new(["b2", "d_c2"], b2, d_c2)?;
        let [first] = self.states;
        Ok(self.of_states([first, second]))
    }
}

impl StateVariable {
    fn new(names: [&'static str; 2], b: f64, d_c: f64) -> Result<Self, Error> {
        Error::check("RateState", names[0], b, true, "any size")?;
        Error::check("RateState", names[1], d_c, d_c > 0.0, "a length > 0")?;
        Ok(Self { b, d_c })
    }
}

impl<const STATES: usize> RateState<STATES> {
    /// The law with other state variables.
    pub(super) fn of_states<const COUNT: usize>(
        self,
        states: [StateVariable; COUNT],
    ) -> RateState<COUNT> {
        RateState {
            evolution: self.evolution,
            f0: self.f0,
            a: self.a,
            v0: self.v0,
            states,
            least_speed: self.least_speed,
        }
    }

    /// Sets a least speed V_m > 0, in units of velocity: at speeds V below V_m, ln(V_m/V₀) replaces
    /// ln(V/V₀) in the rates of the slip law, so that a motion can pass r = 0. (The rates are 0
    /// there in any case.) V_m = 10⁻³⁰ V₀ changes no digit of a motion. The aging law needs no
    /// least speed.
    ///
    /// # Errors
    ///
    /// [`Error::InvalidParameter`] unless V_m > 0 and finite.
    pub fn with_least_speed(self, v_m: f64) -> Result<Self, Error> {
        let least_speed = Error::check("RateState", "v_m", v_m, v_m > 0.0, "v_m > 0")?;
        Ok(Self {
            least_speed,
            ..self
        })
    }

    /// Coefficient of steady sliding at a speed V > 0, dimensionless: the value of the law with
    /// arsinh. It differs from f₀ + (a − Σ b) ln(V/V₀) by a exp(−2μ/a), which is less than rounding
    /// if μ/a > 18.
    pub fn steady(&self, v: f64) -> f64 {
        let slip = Slip {
            speed: v,
            direction: 1.0,
            piece: 0,
        };
        self.coefficient(slip, [self.memory_at(v); STATES])
    }

    /// The value −ln(V/V₀) of φ in steady sliding at a speed V > 0, dimensionless; for each of two
    /// state variables.
    pub fn memory_at(&self, v: f64) -> f64 {
        -(v / self.v0).ln()
    }

    /// Stiffness below which steady sliding at a speed V > 0 is unstable, for a mass m on a spring
    /// to the ground with a damper η (such as radiation damping), under a load N; `None` if steady
    /// sliding is stable with every spring.
    ///
    /// ```text
    /// k_c = [N(b − a)/D_c − ηλ] [1 + mλ/(η + Na/V)],    λ = V/D_c
    /// ```
    ///
    /// This is the case of one state variable; with two, k_c is the largest stiffness with an
    /// eigenvalue iω. The units are those of the structure.
    ///
    /// Source: J. R. Rice, A. L. Ruina, *J. Appl. Mech.* 50 (1983) 343-349.
    ///
    /// ```
    /// use stick_slip::RateState;
    ///
    /// let law = RateState::aging(0.6, 0.008, 0.016, 2e-5, 1e-6)?;
    /// let quasi_static = law.critical_stiffness(5e3, 1e-5, 0.0, 0.0).unwrap();
    /// assert!((quasi_static - 2e6).abs() < 1e-8);
    /// let inert = law.critical_stiffness(5e3, 1e-5, 20.0, 0.0).unwrap();
    /// assert!((inert / quasi_static - (1.0 + 2.5e-6)).abs() < 1e-14);
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    pub fn critical_stiffness(&self, load: f64, v: f64, mass: f64, damping: f64) -> Option<f64> {
        let limits = self.limits_of_stability(load, v, mass, damping);
        limits.map(|limit| limit.stiffness).reduce(f64::max)
    }

    /// Angular frequency ω of the oscillation that begins at the
    /// [critical stiffness](Self::critical_stiffness), in radians per unit of time; it does not
    /// depend on the mass. `None` if steady sliding is stable with every spring.
    ///
    /// ```text
    /// ω² = λ [N(b − a)/D_c − ηλ]/(η + Na/V),    λ = V/D_c;    η = 0: ω = λ √((b − a)/a)
    /// ```
    ///
    /// ```
    /// use stick_slip::RateState;
    ///
    /// let law = RateState::slip(0.6, 0.008, 0.016, 2e-5, 1e-6)?;
    /// let frequency = law.hopf_frequency(5e3, 1e-5, 0.0).unwrap();
    /// assert!((frequency - 0.5).abs() < 1e-15);
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    pub fn hopf_frequency(&self, load: f64, v: f64, damping: f64) -> Option<f64> {
        let limits = self.limits_of_stability(load, v, 0.0, damping);
        let last = limits.reduce(|one, other| {
            if one.stiffness < other.stiffness {
                other
            } else {
                one
            }
        });
        last.map(|limit| limit.square.sqrt())
    }

    /// The stiffnesses k with eigenvalues ±iω, from s = iω in
    ///
    /// ```text
    /// m s² + η s + k + N c s [a/V − Σ b_i/(D_i (s + λ_i))] = 0,    c = tanh(μ/a)
    /// ```
    ///
    /// V ∂μ/∂V = ca and ∂μ/∂φ_i = cb_i; c is 1 to rounding unless μ/a < 19.
    fn limits_of_stability(
        &self,
        load: f64,
        v: f64,
        mass: f64,
        damping: f64,
    ) -> impl Iterator<Item = Limit> {
        let load = load * (self.steady(v) / self.a).tanh();
        let direct = damping + load * self.a / v;
        let squares = match self.states.as_slice() {
            [StateVariable { b, d_c }] => {
                let rate = v / d_c;
                let fall = load * (b - self.a) / d_c - damping * rate;
                [rate * fall / direct, f64::NAN]
            }
            states => {
                // Of x = ω²: direct (x + p)(x + q) = g (x + q) + h (x + p).
                let part = |i: usize| {
                    let StateVariable { b, d_c } = states[i];
                    let rate = v / d_c;
                    (load * b * rate / d_c / direct, rate * rate)
                };
                let ((g, p), (h, q)) = (part(0), part(1));
                let half = 0.5 * (p + q - g - h);
                let root = (half * half - (p * q - g * q - h * p)).sqrt();
                let far = -half - root.copysign(half);
                [far, (p * q - g * q - h * p) / far]
            }
        };
        let states = self.states;
        let found = squares.into_iter().filter(|square| *square > 0.0);
        found.map(move |square| {
            let of_states = states.map(|StateVariable { b, d_c }| {
                let rate = v / d_c;
                load * b / d_c / (square + rate * rate)
            });
            Limit {
                square,
                stiffness: square * (mass + of_states.iter().sum::<f64>()),
            }
        })
    }

    /// f₀ + Σ b_i φ_i.
    #[inline]
    fn without_speed<S: Scalar>(&self, memory: [S; STATES]) -> S {
        let mut sum = memory[0] * self.states[0].b + self.f0;
        for (phi, state) in std::iter::zip(memory, self.states).skip(1) {
            sum = phi * state.b + sum;
        }
        sum
    }

    /// ln(V/V₀), if arsinh x is ln(2x) to rounding. It is not only faster: exp((f₀ + bφ)/a)
    /// overflows in laws with a small a.
    #[inline]
    fn logarithm<S: Scalar>(&self, speed: S, without_speed: S) -> Option<S> {
        /// exp(−2·20) is below a quarter of the rounding error of 20.
        const LARGE: f64 = 20.0;
        let ratio = speed.value() / self.v0;
        let exponent = ratio.ln() + without_speed.value() / self.a;
        (exponent > LARGE).then(|| (speed / self.v0).ln())
    }

    /// μσ, with the result of [`logarithm`](Self::logarithm).
    #[inline]
    fn friction<S: Scalar>(&self, speed: S, without_speed: S, logarithm: Option<S>) -> S {
        /// Logarithms of numbers that do not overflow.
        const LARGEST: f64 = 650.0;
        match logarithm {
            Some(logarithm) => logarithm * self.a + without_speed,
            None => {
                let exponent = without_speed / self.a;
                // Larger exponents occur below the least positive speed only. The slope at r = 0
                // is then large, but not infinite.
                let largest = LARGEST + (2.0 * self.v0 / self.a).ln().min(0.0);
                let excess = (exponent.value() - largest).max(0.0);
                let factor = (exponent - excess).exp() * (0.5 / self.v0);
                (speed * factor).asinh() * self.a
            }
        }
    }

    /// The rates of the states in slip, with the result of [`logarithm`](Self::logarithm).
    #[inline]
    fn rates_in_slip<S: Scalar>(
        &self,
        speed: S,
        logarithm: Option<S>,
        memory: [S; STATES],
    ) -> [S; STATES] {
        match self.evolution {
            Evolution::Aging => Variables::from_fn(|i| {
                let growth = (-memory[i]).exp() * self.v0;
                (growth - speed) / self.states[i].d_c
            }),
            Evolution::Slip if speed.value() > self.least_speed => {
                let logarithm = logarithm.unwrap_or_else(|| (speed / self.v0).ln());
                Variables::from_fn(|i| -(logarithm + memory[i]) * speed / self.states[i].d_c)
            }
            // The rate is 0, but V ln V has no power series.
            Evolution::Slip if self.least_speed == 0.0 => {
                Variables::from_fn(|i| speed.sqrt() / self.states[i].d_c)
            }
            Evolution::Slip => {
                let logarithm = (self.least_speed / self.v0).ln();
                Variables::from_fn(|i| -(memory[i] + logarithm) * speed / self.states[i].d_c)
            }
        }
    }
}

/// A stiffness with eigenvalues ±iω.
struct Limit {
    /// ω².
    square: f64,
    stiffness: f64,
}

impl<const STATES: usize> ContactLaw for RateState<STATES> {
    type Memory<S: Scalar> = [S; STATES];

    #[inline]
    fn coefficient<S: Scalar>(&self, slip: Slip<S>, memory: [S; STATES]) -> S {
        let without_speed = self.without_speed(memory);
        let logarithm = self.logarithm(slip.speed, without_speed);
        self.friction(slip.speed, without_speed, logarithm) * slip.direction
    }

    fn limit<S: Scalar>(&self, _: S, _: [S; STATES]) -> Option<S> {
        None
    }

    #[inline]
    fn rates<S: Scalar>(&self, motion: Motion<S>, _: S, memory: [S; STATES]) -> [S; STATES] {
        let speed = match motion {
            Motion::Stick => memory[0].constant(0.0),
            Motion::Slip(slip) => slip.speed,
        };
        self.rates_in_slip(speed, None, memory)
    }

    #[inline]
    fn coefficient_and_rates<S: Scalar>(
        &self,
        slip: Slip<S>,
        _: S,
        memory: [S; STATES],
    ) -> (S, [S; STATES]) {
        let without_speed = self.without_speed(memory);
        let logarithm = self.logarithm(slip.speed, without_speed);
        let friction = self.friction(slip.speed, without_speed, logarithm);
        let rates = self.rates_in_slip(slip.speed, logarithm, memory);
        (friction * slip.direction, rates)
    }

    fn breakpoints(&self) -> impl Iterator<Item = f64> {
        std::iter::empty()
    }

    fn creeps(&self) -> bool {
        true
    }

    fn changes_while_open(&self) -> bool {
        true
    }

    fn caught(&self, memory: [f64; STATES]) -> [f64; STATES] {
        memory
    }

    fn named(&self) -> Option<NamedLaw> {
        match *self.states.as_slice() {
            [state] => Some(NamedLaw::Contact(self.of_states([state]).into())),
            [first, second] => Some(NamedLaw::TwoStates {
                rate_state: self.of_states([first, second]),
            }),
            _ => None,
        }
    }
}
