use super::{ContactLaw, Motion, NamedLaw, Slip};
use crate::error::Error;
use crate::friction::{Coulomb, FrictionLaw, Own};
use crate::scalar::Scalar;

/// The LuGre model: the friction force depends on the mean deflection z of elastic bristles, the
/// only memory variable.
///
/// ```text
/// z' = r − σ0 |r| z/g(|r|),   μ = σ0 z + σ1 z' + σ2 r
/// ```
///
/// r is the relative velocity, μ the friction coefficient, and g the kinetic coefficient μ̂ of any
/// dry law. In steady sliding μ = sgn(r) g(|r|) + σ2 r. There is no stick mode: every change of
/// sign of r is a [`Crossing`](crate::EventKind::Crossing). In the following, *near stick* means at
/// small |r|, while the bristles bend elastically. Near stick the times of crossings are sensitive
/// to small errors, but the states are not. z is in units of length, the stiffness σ0 of the
/// bristles in 1/length, their damping σ1 and the viscous friction σ2 in time/length; g is
/// dimensionless.
///
/// In slip the deflection z relaxes to its steady value at the rate σ0|r|/g. The number of steps
/// does not grow with this rate: after z has relaxed, a step is a power series on the slow
/// manifold, on which z follows the motion. Near stick a mass m under the normal load N vibrates on
/// its bristles with the frequency √(Nσ0/m). Steps near stick are about 10/√(Nσ0/m) long, even
/// after this vibration has decayed.
///
/// Source: C. Canudas de Wit, H. Olsson, K. J. Åström, P. Lischinsky, *IEEE Trans. Automatic
/// Control* 40 (1995) 419-425.
///
/// ```
/// use stick_slip::{Contact, Exponential, LuGre, Structure, structure::State};
///
/// let law = LuGre::new(Exponential::new(0.4, 0.25, 0.5)?, 100.0, 0.5, 0.02)?;
/// let block = Structure::new(&[1.0])?
///     .with_ground_spring(0, 1.0)?
///     .with_ground_damper(0, 0.1)?
///     .with_contact(Contact::new(0, law, 1.0)?.on_belt(0.2))?;
/// let motion = block.simulate(State::new(&[0.0], &[0.0]), 2.0)?;
/// let first = &motion.events()[0];
/// assert!((first.time - 0.5639330527166541).abs() < 1e-14);
/// assert!((first.state.memory[0] + 0.003983495707454176).abs() < 1e-15);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "super::read::LuGre<L>"),
    serde(bound(deserialize = "L: FrictionLaw + serde::Deserialize<'de>"))
)]
pub struct LuGre<L> {
    law: L,
    stiffness: f64,
    damping: f64,
    viscous: f64,
}

impl<L: FrictionLaw> LuGre<L> {
    /// Creates a LuGre law with bristles of stiffness σ0 and damping σ1, and with viscous friction
    /// σ2.
    ///
    /// If the damping σ1 exceeds a limit that depends on σ2, the contact can supply energy to the
    /// mass. Such a law is accepted;
    /// [`analysis::lugre::passive_viscosity`](crate::analysis::lugre::passive_viscosity) returns
    /// the least σ2 at which the contact cannot supply energy.
    ///
    /// # Errors
    ///
    /// [`Error::InvalidParameter`] unless σ0 > 0, σ1 ≥ 0, σ2 ≥ 0, all finite, and μ̂(0) > 0.
    pub fn new(law: L, stiffness: f64, damping: f64, viscous: f64) -> Result<Self, Error> {
        Error::check(
            "LuGre",
            "stiffness",
            stiffness,
            stiffness > 0.0,
            "stiffness > 0",
        )?;
        Error::check("LuGre", "damping", damping, damping >= 0.0, "damping ≥ 0")?;
        Error::check("LuGre", "viscous", viscous, viscous >= 0.0, "viscous ≥ 0")?;
        let largest = law.kinetic(0.0);
        Error::check("LuGre", "coefficient", largest, largest > 0.0, "μ̂(0) > 0")?;
        Ok(Self {
            law,
            stiffness,
            damping,
            viscous,
        })
    }

    /// The dry law whose kinetic coefficient is g: the coefficient in steady sliding without
    /// viscous friction.
    pub fn law(&self) -> &L {
        &self.law
    }

    /// Stiffness σ0 of the bristles, per unit of length.
    pub fn stiffness(&self) -> f64 {
        self.stiffness
    }

    /// Damping σ1 of the bristles, in units of time per length.
    pub fn damping(&self) -> f64 {
        self.damping
    }

    /// Viscous friction σ2, in units of time per length.
    pub fn viscous(&self) -> f64 {
        self.viscous
    }

    /// The rate z'.
    #[inline(always)]
    fn rate<S: Scalar>(&self, slip: Slip<S>, z: S) -> S {
        let largest = self.law.kinetic_on(slip.piece, slip.speed);
        let part = z * self.stiffness / largest;
        (-part + slip.direction) * slip.speed
    }

    /// μ; z' is needed only if the bristles are damped.
    #[inline(always)]
    fn friction<S: Scalar>(&self, slip: Slip<S>, z: S, rate: impl FnOnce() -> S) -> S {
        let elastic = z * self.stiffness + slip.velocity() * self.viscous;
        if self.damping == 0.0 {
            elastic
        } else {
            elastic + rate() * self.damping
        }
    }
}

impl<L: FrictionLaw> ContactLaw for LuGre<L> {
    type Memory<S: Scalar> = [S; 1];

    #[inline]
    fn coefficient<S: Scalar>(&self, slip: Slip<S>, [z]: [S; 1]) -> S {
        self.friction(slip, z, || self.rate(slip, z))
    }

    fn limit<S: Scalar>(&self, _: S, _: [S; 1]) -> Option<S> {
        None
    }

    #[inline]
    fn rates<S: Scalar>(&self, motion: Motion<S>, _: S, [z]: [S; 1]) -> [S; 1] {
        match motion {
            Motion::Stick => [z.constant(0.0)],
            Motion::Slip(slip) => [self.rate(slip, z)],
        }
    }

    #[inline]
    fn coefficient_and_rates<S: Scalar>(&self, slip: Slip<S>, _: S, [z]: [S; 1]) -> (S, [S; 1]) {
        let rate = self.rate(slip, z);
        (self.friction(slip, z, || rate), [rate])
    }

    fn breakpoints(&self) -> impl Iterator<Item = f64> {
        self.law.breakpoints()
    }

    fn caught(&self, memory: [f64; 1]) -> [f64; 1] {
        memory
    }

    fn named(&self) -> Option<NamedLaw> {
        let Self {
            stiffness,
            damping,
            viscous,
            ..
        } = *self;
        let law = self.law.any(Own)?;
        let named = LuGre {
            law,
            stiffness,
            damping,
            viscous,
        };
        Some(NamedLaw::Contact(named.into()))
    }
}

/// Dahl's model: bristles without damping. It is [`LuGre`] with a constant g and σ1 = σ2 = 0; the
/// symbols are those of `LuGre`.
///
/// ```text
/// z' = r − σ0 |r| z/g,   μ = σ0 z
/// ```
///
/// Source: P. R. Dahl, *A solid friction model*, The Aerospace Corporation, TOR-158(3107-18), 1968.
///
/// ```
/// use stick_slip::{ContactLaw, Dahl, Slip};
///
/// let law = Dahl::new(0.4, 100.0)?;
/// let slip = Slip { speed: 0.1, direction: 1.0, piece: 0 };
/// assert_eq!(law.coefficient(slip, [0.004]), 0.4);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(into = "super::read::Dahl", try_from = "super::read::Dahl")
)]
pub struct Dahl(LuGre<Coulomb>);

impl Dahl {
    /// Creates a Dahl law: bristles of stiffness σ0 with the friction coefficient g in steady
    /// sliding.
    ///
    /// # Errors
    ///
    /// [`Error::InvalidParameter`] unless g > 0 and σ0 > 0, both finite.
    pub fn new(coefficient: f64, stiffness: f64) -> Result<Self, Error> {
        Error::check(
            "Dahl",
            "coefficient",
            coefficient,
            coefficient > 0.0,
            "coefficient > 0",
        )?;
        Error::check(
            "Dahl",
            "stiffness",
            stiffness,
            stiffness > 0.0,
            "stiffness > 0",
        )?;
        let law = Coulomb::new(coefficient, coefficient)?;
        Ok(Self(LuGre::new(law, stiffness, 0.0, 0.0)?))
    }

    /// Coefficient g of steady sliding, dimensionless.
    pub fn kinetic_coefficient(&self) -> f64 {
        self.0.law().kinetic_coefficient()
    }

    /// Stiffness σ0 of the bristles, per unit of length.
    pub fn stiffness(&self) -> f64 {
        self.0.stiffness()
    }
}

impl ContactLaw for Dahl {
    type Memory<S: Scalar> = [S; 1];

    #[inline]
    fn coefficient<S: Scalar>(&self, slip: Slip<S>, memory: [S; 1]) -> S {
        self.0.coefficient(slip, memory)
    }

    fn limit<S: Scalar>(&self, _: S, _: [S; 1]) -> Option<S> {
        None
    }

    #[inline]
    fn rates<S: Scalar>(&self, motion: Motion<S>, load: S, memory: [S; 1]) -> [S; 1] {
        self.0.rates(motion, load, memory)
    }

    #[inline]
    fn coefficient_and_rates<S: Scalar>(
        &self,
        slip: Slip<S>,
        load: S,
        memory: [S; 1],
    ) -> (S, [S; 1]) {
        self.0.coefficient_and_rates(slip, load, memory)
    }

    fn breakpoints(&self) -> impl Iterator<Item = f64> {
        std::iter::empty()
    }

    fn caught(&self, memory: [f64; 1]) -> [f64; 1] {
        memory
    }

    fn named(&self) -> Option<NamedLaw> {
        Some(NamedLaw::Contact((*self).into()))
    }
}
