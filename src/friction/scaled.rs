use super::{FrictionLaw, LawVisitor, Own};
use crate::error::Error;
use crate::scalar::Scalar;

/// A friction law of dimensionless speeds, made from a law of physical speeds in m/s.
///
/// ```text
/// μ̂(s) = μ̂_physical(ω0 L s)
/// ```
///
/// μ̂ is the kinetic coefficient at the dimensionless sliding speed s. ω0 L is the unit of velocity
/// in m/s: the natural frequency ω0 times the unit of length L of a [`Scaling`](crate::Scaling).
/// The breakpoints are the breakpoints of the physical law, divided by ω0 L.
/// [`Scaling::system`](crate::Scaling::system) and [`Scaling::law`](crate::Scaling::law) make such
/// laws.
///
/// ```
/// use stick_slip::{FrictionLaw, Physical, Scaling, Tabulated};
///
/// let scaling = Scaling::new(Physical {
///     mass: 2.0, stiffness: 5000.0, damping: 4.0, normal_force: 20.0, belt_velocity: 0.05,
/// })?;
/// // Measured at 0, 0.1 and 0.3 m/s; ω0 L is 0.2 m/s.
/// let law = scaling.law(Tabulated::new([(0.0, 0.4), (0.1, 0.3), (0.3, 0.25)])?);
/// assert_eq!(law.kinetic(0.5), 0.3);
/// let mut speeds = law.breakpoints().map(|speed| scaling.metres_per_second(speed));
/// assert_eq!((speeds.next(), speeds.next(), speeds.next()), (Some(0.1), Some(0.3), None));
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "super::read::Scaled<L>"),
    serde(bound(deserialize = "L: FrictionLaw + serde::Deserialize<'de>"))
)]
pub struct Scaled<L> {
    law: L,
    velocity_unit: f64,
}

impl<L: FrictionLaw> Scaled<L> {
    /// Creates a dimensionless law from a law of speeds in m/s. `velocity_unit` is the physical
    /// speed ω0 L, in m/s, that corresponds to the dimensionless speed 1.
    ///
    /// # Errors
    ///
    /// [`Error::InvalidParameter`] unless the unit is finite and > 0.
    pub fn new(law: L, velocity_unit: f64) -> Result<Self, Error> {
        Error::check(
            "Scaled",
            "velocity_unit",
            velocity_unit,
            velocity_unit > 0.0,
            "velocity_unit > 0",
        )?;
        Ok(Self { law, velocity_unit })
    }
}

impl<L> Scaled<L> {
    /// Like [`new`](Self::new), for a unit that is known to be finite and > 0.
    pub(crate) fn of(law: L, velocity_unit: f64) -> Self {
        Self { law, velocity_unit }
    }

    /// The original law, a function of physical speeds.
    pub fn law(&self) -> &L {
        &self.law
    }

    /// Physical speed ω0 L, in m/s, that corresponds to the dimensionless speed 1.
    pub fn velocity_unit(&self) -> f64 {
        self.velocity_unit
    }
}

impl<L: FrictionLaw> FrictionLaw for Scaled<L> {
    fn static_coefficient(&self) -> f64 {
        self.law.static_coefficient()
    }

    #[inline(always)]
    fn kinetic<S: Scalar>(&self, speed: S) -> S {
        self.law.kinetic(speed * self.velocity_unit)
    }

    fn breakpoints(&self) -> impl Iterator<Item = f64> {
        let unit = self.velocity_unit;
        self.law.breakpoints().map(move |speed| speed / unit)
    }

    #[inline(always)]
    fn kinetic_on<S: Scalar>(&self, piece: usize, speed: S) -> S {
        self.law.kinetic_on(piece, speed * self.velocity_unit)
    }

    #[inline(always)]
    fn give_to<V: LawVisitor>(&self, visitor: V) -> V::Output {
        let Self { law, velocity_unit } = self;
        law.give_to(Scaling {
            velocity_unit: *velocity_unit,
            visitor,
        })
    }

    fn constant(&self, own: Own) -> Option<f64> {
        self.law.constant(own)
    }
}

/// A visitor that scales the law inside for another visitor.
struct Scaling<V> {
    velocity_unit: f64,
    visitor: V,
}

impl<V: LawVisitor> LawVisitor for Scaling<V> {
    type Output = V::Output;

    #[inline(always)]
    fn visit<L: FrictionLaw>(self, law: &L) -> V::Output {
        self.visitor.visit(&Scaled::of(law, self.velocity_unit))
    }

    #[inline(always)]
    fn visit_seldom<L: FrictionLaw>(self, law: &L) -> V::Output {
        self.visitor
            .visit_seldom(&Scaled::of(law, self.velocity_unit))
    }
}
