use super::{ContactLaw, Motion, NamedLaw, SidedLaw, Slip};
use crate::error::Error;
use crate::friction::check::{check_kinetic, check_static, validate};
use crate::friction::law_object::{LawRef, Own};
use crate::friction::{Coulomb, FrictionLaw};
use crate::scalar::Scalar;

/// Dry friction that depends on the direction of slip: one law for each direction.
///
/// ```text
/// slip:   λ = N μ̂⁺(r) for r > 0,   λ = −N μ̂⁻(|r|) for r < 0
/// stick:  −N μ_s⁻ ≤ λ ≤ N μ_s⁺
/// ```
///
/// λ is the friction force, N the normal load and r the relative velocity. The forward law gives
/// the kinetic coefficient μ̂⁺ and the static coefficient μ_s⁺, the backward law μ̂⁻ and μ_s⁻; all
/// are dimensionless. Such friction acts on scaled and hairy surfaces, on the soles of crawling
/// robots, on boards with nap, and on ropes and bands around a drum. A contact with this law has no
/// memory variables.
///
/// Source: G. Noselli, A. DeSimone, *Int. J. Non-Linear Mech.* 56 (2013) 1 (crawlers).
///
/// ```
/// use stick_slip::{Contact, Coulomb, Directional, Drive, Structure, structure::State};
///
/// // x'' = sin 2πt: with 0.2 forward and 0.6 backward the block moves forward only.
/// let law = Directional::new(Coulomb::new(0.2, 0.2)?, Coulomb::new(0.6, 0.6)?)?;
/// let shaking = Drive::constant(0.0).with_sine(1.0, std::f64::consts::TAU)?;
/// let block = Structure::new(&[1.0])?
///     .with_force(0, shaking)?
///     .with_contact(Contact::new(0, law, 1.0)?)?;
/// let motion = block.simulate(State::at_rest(1), 20.0)?;
/// let first = motion.events()[0].time;
/// assert!((first - 0.2_f64.asin() / std::f64::consts::TAU).abs() < 1e-15);
/// let way = |t: f64| motion.state_at(t).unwrap().displacements[0];
/// assert!((way(20.0) - way(10.0) - 0.853).abs() < 1e-3);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "super::read::Directional<F, B>"),
    serde(bound(deserialize = "F: FrictionLaw + serde::Deserialize<'de>, \
                               B: FrictionLaw + serde::Deserialize<'de>"))
)]
pub struct Directional<F, B> {
    forward: F,
    backward: B,
    /// The breakpoints of both laws, each with the number of those of each law up to there.
    #[cfg_attr(feature = "serde", serde(skip_serializing))]
    breakpoints: Vec<(f64, [usize; 2])>,
}

impl<F: FrictionLaw, B: FrictionLaw> Directional<F, B> {
    /// Creates a law from a law for slip forward (r > 0) and one for slip backward (r < 0).
    ///
    /// # Errors
    ///
    /// The errors of [`MassOnBelt::new`](crate::MassOnBelt::new) that concern the laws.
    pub fn new(forward: F, backward: B) -> Result<Self, Error> {
        validate(&forward)?;
        validate(&backward)?;
        let own = [
            forward.breakpoints().collect::<Vec<f64>>(),
            backward.breakpoints().collect(),
        ];
        let mut all = own.concat();
        all.sort_unstable_by(f64::total_cmp);
        all.dedup();
        let below = |at: f64| own.each_ref().map(|own| own.partition_point(|&b| b <= at));
        Ok(Self {
            forward,
            backward,
            breakpoints: all.into_iter().map(|at| (at, below(at))).collect(),
        })
    }

    /// The law of slip forward.
    pub fn forward(&self) -> &F {
        &self.forward
    }

    /// The law of slip backward.
    pub fn backward(&self) -> &B {
        &self.backward
    }

    /// The piece of each law, forward and backward, on a piece of this one.
    #[inline(always)]
    fn pieces(&self, piece: usize) -> [usize; 2] {
        match piece.checked_sub(1) {
            None => [0; 2],
            Some(below) => self.breakpoints[below].1,
        }
    }
}

impl Directional<Coulomb, Coulomb> {
    /// Creates the law of a rope or a band around a drum, with the static and kinetic coefficients
    /// μ_s and μ_k and the wrap angle θ in radians (Euler and Eytelwein, the capstan equation).
    ///
    /// The tension T of one end is the normal load of the contact. Friction carries the difference
    /// λ between the tension of the other end and T, so the other end has the tension T + λ, and
    ///
    /// ```text
    /// stick:  T e^{−μ_s θ} ≤ T + λ ≤ T e^{μ_s θ}
    /// ```
    ///
    /// The coefficients of slip are e^{μ_k θ} − 1 forward and 1 − e^{−μ_k θ} backward. T itself is
    /// a force on the rope that must be added to the structure; a drum feels λ alone.
    ///
    /// # Errors
    ///
    /// [`Error::InvalidParameter`] unless 0 ≤ μ_k ≤ μ_s and θ ≥ 0, and e^{μ_s θ} is finite.
    ///
    /// ```
    /// use stick_slip::{Directional, FrictionLaw};
    ///
    /// // One turn at 0.3 holds 6.6 times the tension.
    /// let law = Directional::capstan(0.3, 0.2, std::f64::consts::TAU)?;
    /// let ratio = 1.0 + law.forward().static_coefficient();
    /// assert!((ratio - 6.586061962694724858).abs() < 4e-15);
    /// assert!((ratio * (1.0 - law.backward().static_coefficient()) - 1.0).abs() < 1e-15);
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    pub fn capstan(
        static_coefficient: f64,
        kinetic_coefficient: f64,
        wrap: f64,
    ) -> Result<Self, Error> {
        const OF: &str = "Directional";
        check_static(OF, static_coefficient)?;
        check_kinetic(OF, static_coefficient, kinetic_coefficient)?;
        let [most, kinetic] = [static_coefficient, kinetic_coefficient].map(|c| c * wrap);
        let is_finite = wrap >= 0.0 && most.exp_m1().is_finite();
        let allowed = "wrap ≥ 0, in radians, with a finite exp(static_coefficient·wrap)";
        Error::check(OF, "wrap", wrap, is_finite, allowed)?;
        Self::new(
            Coulomb::new(most.exp_m1(), kinetic.exp_m1())?,
            Coulomb::new(-(-most).exp_m1(), -(-kinetic).exp_m1())?,
        )
    }
}

impl<F: FrictionLaw, B: FrictionLaw> ContactLaw for Directional<F, B> {
    type Memory<S: Scalar> = [S; 0];

    #[inline(always)]
    fn coefficient<S: Scalar>(&self, slip: Slip<S>, _: [S; 0]) -> S {
        let [forward, backward] = self.pieces(slip.piece);
        let kinetic = if slip.direction > 0.0 {
            self.forward.kinetic_on(forward, slip.speed)
        } else {
            self.backward.kinetic_on(backward, slip.speed)
        };
        kinetic * slip.direction
    }

    /// The larger static coefficient.
    fn limit<S: Scalar>(&self, zero: S, _: [S; 0]) -> Option<S> {
        let [backward, forward] = [
            self.backward.static_coefficient(),
            self.forward.static_coefficient(),
        ];
        Some(zero.constant(backward.max(forward)))
    }

    fn limits<S: Scalar>(&self, zero: S, _: [S; 0]) -> Option<[S; 2]> {
        let limits = [
            self.backward.static_coefficient(),
            self.forward.static_coefficient(),
        ];
        Some(limits.map(|limit| zero.constant(limit)))
    }

    #[inline(always)]
    fn rates<S: Scalar>(&self, _: Motion<S>, _: S, memory: [S; 0]) -> [S; 0] {
        memory
    }

    fn breakpoints(&self) -> impl Iterator<Item = f64> {
        self.breakpoints.iter().map(|&(at, _)| at)
    }

    fn caught(&self, memory: [f64; 0]) -> [f64; 0] {
        memory
    }

    fn named(&self) -> Option<NamedLaw> {
        let forward = self.forward.any(Own)?;
        let backward = self.backward.any(Own)?;
        let law = Directional::new(forward, backward).ok()?;
        Some(NamedLaw::Sided(SidedLaw::Directional(law)))
    }

    fn constant(&self, own: Own) -> Option<f64> {
        let [forward, backward] = [self.forward.constant(own)?, self.backward.constant(own)?];
        (forward == backward).then_some(forward)
    }

    fn dry_slip(&self, direction: f64) -> Option<LawRef<'_>> {
        let (law, side) = if direction > 0.0 {
            (self.forward.erased(), 0)
        } else {
            (self.backward.erased(), 1)
        };
        // Otherwise its pieces have other numbers.
        let mut pieces = self.breakpoints.iter().enumerate();
        pieces
            .all(|(i, (_, below))| below[side] == i + 1)
            .then_some(law)
    }
}
