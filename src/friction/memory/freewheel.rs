use super::{ContactLaw, Motion, NamedLaw, SidedLaw, Slip};
use crate::error::Error;
use crate::friction::check::validate;
use crate::friction::law_object::{LawRef, Own};
use crate::friction::{Coulomb, FrictionLaw};
use crate::scalar::Scalar;

/// A freewheel (one-way clutch, backstop): it slips backward only, and carries any force that would
/// make it slip forward.
///
/// ```text
/// r ≤ 0;   slip:  λ = −N μ̂(|r|),   stick:  −N μ_s ≤ λ < ∞
/// ```
///
/// λ is the force and r the relative velocity. The drag is the friction of overrunning, with the
/// kinetic coefficient μ̂ and the static coefficient μ_s, under the normal load N of the contact. A
/// freewheel between two coordinates is [`Contact::freewheel`](crate::Contact::freewheel); this law
/// makes one along any direction, such as a backstop on the ground. A contact with this law has no
/// memory variables. It is open while its load is not positive: a pawl that is lifted.
///
/// ```
/// use stick_slip::{Contact, Coulomb, Drive, Freewheel, Structure, structure::State};
///
/// // A shaft under the torque cos t turns forward only: b = −1.
/// let backstop = Contact::along(&[(0, -1.0)], Freewheel::new(Coulomb::new(0.0, 0.0)?)?, 1.0)?;
/// let shaft = Structure::new(&[1.0])?
///     .with_force(0, Drive::harmonic(1.0, 1.0, 0.0)?)?
///     .with_contact(backstop)?;
/// let motion = shaft.simulate(State::at_rest(1), 6.0)?;
/// // It stops at π, and is released again at 3π/2.
/// let times: Vec<f64> = motion.events().iter().map(|event| event.time).collect();
/// for (time, expected) in times.iter().zip([1.0, 1.5]) {
///     assert!((time - expected * std::f64::consts::PI).abs() < 1e-14);
/// }
/// assert_eq!(times.len(), 2);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "super::read::Freewheel<L>"),
    serde(bound(
        serialize = "L: serde::Serialize",
        deserialize = "L: FrictionLaw + serde::Deserialize<'de>"
    ))
)]
pub struct Freewheel<L> {
    drag: L,
}

impl Freewheel<Coulomb> {
    /// A freewheel without drag.
    pub(crate) fn without_drag() -> Result<Self, Error> {
        Self::new(Coulomb::new(0.0, 0.0)?)
    }
}

impl<L: FrictionLaw> Freewheel<L> {
    /// Creates a freewheel with a law of its drag.
    ///
    /// # Errors
    ///
    /// The errors of [`MassOnBelt::new`](crate::MassOnBelt::new) that concern the law.
    pub fn new(drag: L) -> Result<Self, Error> {
        validate(&drag)?;
        Ok(Self { drag })
    }

    /// The law of the drag.
    pub fn drag(&self) -> &L {
        &self.drag
    }
}

impl<L: FrictionLaw> ContactLaw for Freewheel<L> {
    type Memory<S: Scalar> = [S; 0];

    #[inline(always)]
    fn coefficient<S: Scalar>(&self, slip: Slip<S>, _: [S; 0]) -> S {
        if slip.direction > 0.0 {
            slip.speed.constant(f64::INFINITY)
        } else {
            self.drag.kinetic_on(slip.piece, slip.speed) * slip.direction
        }
    }

    /// Infinite.
    fn limit<S: Scalar>(&self, zero: S, _: [S; 0]) -> Option<S> {
        Some(zero.constant(f64::INFINITY))
    }

    fn limits<S: Scalar>(&self, zero: S, _: [S; 0]) -> Option<[S; 2]> {
        let limits = [self.drag.static_coefficient(), f64::INFINITY];
        Some(limits.map(|limit| zero.constant(limit)))
    }

    #[inline(always)]
    fn rates<S: Scalar>(&self, _: Motion<S>, _: S, memory: [S; 0]) -> [S; 0] {
        memory
    }

    fn breakpoints(&self) -> impl Iterator<Item = f64> {
        self.drag.breakpoints()
    }

    fn caught(&self, memory: [f64; 0]) -> [f64; 0] {
        memory
    }

    fn named(&self) -> Option<NamedLaw> {
        let drag = self.drag.any(Own)?;
        Some(NamedLaw::Sided(SidedLaw::Freewheel(Freewheel { drag })))
    }

    fn dry_slip(&self, direction: f64) -> Option<LawRef<'_>> {
        (direction < 0.0).then(|| self.drag.erased())
    }
}
