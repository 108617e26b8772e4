use std::borrow::Cow;

use super::model::Support;
use crate::belt::MassOnBelt;
use crate::drive::Drive;
use crate::error::Error;
use crate::friction::memory::{ContactLaw, validate};

/// A friction contact of one coordinate: its law, its normal load and the belt that it slides on.
///
/// ```text
/// friction on the mass  −N μ(r),   r = v − w(t)        in slip
/// N = N0(t) + Σ n_j q_j                                the normal load
/// w(t)                                                 velocity of the belt, 0 unless set
/// ```
///
/// Loads in units of force, n_j force per displacement, w in units of velocity, μ dimensionless.
///
/// A load that depends on time alone may fall to 0 and come back: the contact is open meanwhile,
/// and there is no friction. A load that depends on displacements comes from a normal spring that
/// is part of the stiffness matrix, and which would pull once N < 0: the motion ends there, with
/// an error.
///
/// A load that only touches 0, from above or from below, is no event: where it turns back within
/// 8ε of 0, in units of the sum of the sizes of its terms, or where one piece of a [`Drive`] ends
/// at 0 and the next goes back. Nor is it one where what a sticking contact carries touches its
/// limit, within 8ε of that limit.
///
/// `Z` is the number of memory variables of the law: 0 for every dry law.
///
/// ```
/// use stick_slip::{Contact, Coulomb, Drive};
///
/// // On coordinate 1, pressed by 5 + 0.3·q_0, on a belt that starts at t = 2.
/// let law = Coulomb::new(0.4, 0.25)?;
/// let belt = Drive::profile(&[(2.0, 0.0), (4.0, 0.1)])?;
/// let contact = Contact::new(1, law, 5.0)?.with_load_gradient(0, 0.3)?.on_belt(belt);
/// assert_eq!(contact.coordinate(), 1);
/// assert_eq!(contact.load_at(0.0, &[1.0, 0.0]), 5.3);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "super::read::Contact<L>"),
    serde(bound(deserialize = "L: ContactLaw<Z> + serde::Deserialize<'de>"))
)]
pub struct Contact<L, const Z: usize = 0> {
    coordinate: usize,
    law: L,
    load: Drive,
    /// n_j by ascending coordinate j; none is 0.
    load_gradient: Vec<(usize, f64)>,
    belt_velocity: Drive,
}

impl<const Z: usize, L: ContactLaw<Z>> Contact<L, Z> {
    /// A contact of a coordinate with a law and a normal load N0(t), on a surface at rest.
    ///
    /// # Errors
    ///
    /// * [`Error::InvalidParameter`] if the load is not finite, or a constant ≤ 0, if μ_s is
    ///   negative or not finite, and if a law breaks one of the rules of [`ContactLaw`];
    /// * the errors of [`MassOnBelt::new`](crate::MassOnBelt::new) that a law can cause.
    pub fn new(coordinate: usize, law: L, load: impl Into<Drive>) -> Result<Self, Error> {
        validate(&law)?;
        Ok(Self {
            coordinate,
            law,
            load: checked_load(load.into())?,
            load_gradient: Vec::new(),
            belt_velocity: Drive::constant(0.0),
        })
    }
}

impl<L: Clone> Contact<L> {
    /// The contact of a mass on a belt.
    pub(super) fn of_belt(belt: &MassOnBelt<L>) -> Self {
        Self {
            coordinate: 0,
            law: belt.law().clone(),
            load: Drive::constant(belt.load()),
            load_gradient: Vec::new(),
            belt_velocity: Drive::constant(belt.belt_velocity()),
        }
    }
}

impl<L, const Z: usize> Contact<L, Z> {
    /// The same contact on a belt of velocity w(t).
    ///
    /// The velocity must not jump; [`Structure::with_contact`](crate::Structure::with_contact)
    /// checks it.
    pub fn on_belt(mut self, velocity: impl Into<Drive>) -> Self {
        self.belt_velocity = velocity.into();
        self
    }

    /// The same contact with n·q added to its load, q the displacement of a coordinate.
    ///
    /// # Errors
    ///
    /// [`Error::InvalidParameter`] unless n, and its sum with what is there for that coordinate,
    /// is finite.
    pub fn with_load_gradient(mut self, coordinate: usize, gradient: f64) -> Result<Self, Error> {
        let place = self
            .load_gradient
            .partition_point(|&(other, _)| other < coordinate);
        let mut sum = gradient;
        if let Some(&(other, old)) = self.load_gradient.get(place)
            && other == coordinate
        {
            self.load_gradient.remove(place);
            sum += old;
        }
        Error::check(
            "Contact",
            "gradient",
            gradient,
            sum.is_finite(),
            "a finite sum",
        )?;
        if sum != 0.0 {
            self.load_gradient.insert(place, (coordinate, sum));
        }
        Ok(self)
    }

    /// The coordinate that it belongs to, from 0.
    pub fn coordinate(&self) -> usize {
        self.coordinate
    }

    /// Its friction law.
    pub fn law(&self) -> &L {
        &self.law
    }

    /// N0(t), the part of the normal load that depends on time, in units of force.
    pub fn load(&self) -> &Drive {
        &self.load
    }

    /// Coordinates j, ascending, with the n_j ≠ 0 of the normal load, in units of force per
    /// displacement.
    pub fn load_gradient(&self) -> &[(usize, f64)] {
        &self.load_gradient
    }

    /// Velocity w(t) of the belt.
    pub fn belt_velocity(&self) -> &Drive {
        &self.belt_velocity
    }

    /// Normal load N = N0(t) + Σ n_j q_j at a time, in units of force; NaN where a displacement
    /// is missing. It may be negative: the contact is open then, or the motion has ended.
    pub fn load_at(&self, time: f64, displacements: &[f64]) -> f64 {
        self.support().load_at(time, displacements)
    }

    /// All but its law.
    pub(crate) fn support(&self) -> Support<'_> {
        Support {
            coordinate: self.coordinate,
            load: Cow::Borrowed(&self.load),
            load_gradient: &self.load_gradient,
            belt_velocity: Cow::Borrowed(&self.belt_velocity),
        }
    }

    /// The contact as seen from a frame that oscillates with its belt.
    pub(super) fn seen_from(&self, velocity: &Drive, displacement: &Drive) -> Result<Self, Error>
    where
        L: Clone,
    {
        let gradient: f64 = self.load_gradient.iter().map(|&(_, n)| n).sum();
        let mut seen = self.clone();
        seen.load = seen.load.plus(&displacement.scaled(gradient)?)?;
        seen.belt_velocity = seen.belt_velocity.plus(&velocity.scaled(-1.0)?)?;
        Ok(seen)
    }
}

/// A normal load N0(t), if it may be one.
fn checked_load(load: Drive) -> Result<Drive, Error> {
    load.check("load", "load > 0")?;
    if load.is_constant() {
        let value = load.value(0.0);
        Error::check("Contact", "load", value, value > 0.0, "load > 0")?;
    }
    Ok(load)
}
