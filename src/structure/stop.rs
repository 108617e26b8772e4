use std::borrow::Cow;
use std::sync::Arc;

use super::direction::{check_coordinates, checked_direction};
use super::engine::element_data::ElementData;
use crate::drive::Drive;
use crate::error::{Element, Error};
use crate::force::object::OneDirection;
use crate::force::stop::StopLaw;

/// A stop with a gap: a buffer, the teeth of a loose gear, a wall of rubber. It is a spring with a
/// damper that acts only while the gap is closed.
///
/// ```text
/// gap      g = g0 + d·q,   depth  δ = −g
/// force    +d F on the coordinates,  F = max(0, kδ + cδ')  while δ > 0,  otherwise 0
/// adhesive                           F = kδ + cδ'          while δ > 0,  otherwise 0
/// ```
///
/// d is a constant direction (dimensionless) and g0 the gap at q = 0, in units of length, of any
/// sign: a stop with g0 < 0 is pressed at q = 0. k > 0 and c ≥ 0 are the stiffness and the damping
/// constant of the stop. Both sides of a play are two stops.
///
/// | stop | d | g |
/// |---|---|---|
/// | [`above(i, q_max, ..)`](Self::above) | −e_i | q_max − q_i |
/// | [`below(i, q_min, ..)`](Self::below) | e_i | q_i − q_min |
/// | [`between(i, j, gap, ..)`](Self::between) | e_j − e_i | gap + q_j − q_i |
/// | [`along(&[(j, d_j), ..], gap, ..)`](Self::along) | Σ d_j e_j | gap + Σ d_j q_j |
///
/// A stop closes ([`EventKind::Close`](crate::EventKind::Close)) when its force begins and opens
/// when its force ends, at a root of δ or of kδ + cδ'. With c > 0 the force jumps to cδ' at the
/// touch. The first law never pulls: it is 0 as soon as kδ + cδ' is negative, before δ is 0 again,
/// and acts again if kδ + cδ' becomes positive again before that. The
/// [adhesive](Self::adhesive) law pulls until δ = 0. A state alone determines the force, so a
/// motion continues from any of its states. The slow recovery of a real pad is not covered.
///
/// # Rigid stops
///
/// Rigid impacts are not available: [`Structure::with_stop`](crate::Structure::with_stop) refuses a
/// stop without a [contact stiffness](Self::with_contact_stiffness), and the argument `restitution`
/// of the constructors has no effect. Instead, give a stiff stop the damping that belongs to the
/// restitution e that you need. Let m = 1/(dᵀM⁻¹d) and ζ = c/(2√(km)). A free mass rebounds with
/// the restitution
///
/// ```text
/// e = exp(−2ζ acos(ζ)/√(1 − ζ²))      ζ > 1:  exp(−2ζ acosh(ζ)/√(ζ² − 1))
/// e = exp(−πζ/√(1 − ζ²))              adhesive
/// ```
///
/// after the contact time 2 acos(ζ)/ω_d, with ω_d = √((1 − ζ²)k/m) (adhesive: π/ω_d). Choose k such
/// that this time is short compared with the motion. An impact costs two to four steps at any
/// stiffness. While a stop stays closed, the number of steps is in proportion to √(k/m): about 40
/// and 400 in each unit of time with k/m = 1e4 and 1e6.
///
/// Source: T. Schwager and T. Pöschel, *Granular Matter* 9 (2007) 465-469, for the law that never
/// pulls; K. H. Hunt and F. R. E. Crossley, *J. Appl. Mech.* 42 (1975) 440-445, for both.
///
/// ```
/// use stick_slip::{Element, EventKind, Stop, Structure, structure::State};
///
/// // A mass of 1 flies with the velocity 1 against a stop at q = 1, ζ = 0.3.
/// let (stiffness, zeta) = (1e4_f64, 0.3_f64);
/// let damping = 2.0 * zeta * stiffness.sqrt();
/// let stop = Stop::above(0, 1.0, 0.0)?.with_contact_stiffness(stiffness, damping)?;
/// let mass = Structure::new(&[1.0])?.with_stop(stop)?;
/// let motion = mass.simulate(State::new(&[0.0], &[1.0]), 2.0)?;
///
/// let [close, open] = motion.events() else { panic!() };
/// assert_eq!((close.element, close.kind), (Element::Stop(0), EventKind::Close));
/// assert_eq!((close.time, open.kind), (1.0, EventKind::Open));
/// let duration = 2.0 * zeta.acos() / (stiffness * (1.0 - zeta * zeta)).sqrt();
/// assert!((open.time - close.time - duration).abs() < 1e-15);
/// let rebound = (-2.0 * zeta * zeta.acos() / (1.0 - zeta * zeta).sqrt()).exp();
/// assert!((motion.last().velocities[0] + rebound).abs() < 1e-14);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[derive(Clone)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "super::read::StopText", into = "super::read::StopText")
)]
pub struct Stop {
    /// d by ascending coordinate; no entry is 0.
    direction: Vec<(usize, f64)>,
    /// −d, along which the depth grows.
    inward: [Vec<(usize, f64)>; 1],
    restitution: f64,
    /// The law of the stop, whose stiffness is 0 until it is given.
    law: OneDirection<StopLaw>,
}

/// The values that gaps and positions may have, as messages say it.
const ANY: &str = "any sign is allowed";

impl Stop {
    /// Creates a stop along any direction d: g = gap + Σ d_j q_j. `restitution` has no effect: see
    /// [rigid stops](Self#rigid-stops).
    ///
    /// # Errors
    ///
    /// [`Error::BadDirection`] if no coordinate is given, if a coordinate is given twice, if a d_j
    /// is not finite, or if all d_j are 0; [`Error::InvalidParameter`] unless the gap is finite and
    /// 0 ≤ restitution ≤ 1.
    pub fn along(direction: &[(usize, f64)], gap: f64, restitution: f64) -> Result<Self, Error> {
        let (_, direction) = checked_direction(direction)?;
        Error::check("Stop", "gap", gap, true, ANY)?;
        let is_allowed = (0.0..=1.0).contains(&restitution);
        let allowed = "0 ≤ restitution ≤ 1";
        Error::check("Stop", "restitution", restitution, is_allowed, allowed)?;
        let inward = direction.iter().map(|&(j, d)| (j, -d));
        Ok(Self {
            inward: [inward.collect()],
            direction,
            restitution,
            law: OneDirection(StopLaw {
                gap,
                stiffness: 0.0,
                damping: 0.0,
                is_adhesive: false,
            }),
        })
    }

    /// Creates a stop that pushes coordinate i back from above q_max. `restitution` has no effect:
    /// see [rigid stops](Self#rigid-stops).
    ///
    /// # Errors
    ///
    /// [`Error::InvalidParameter`] unless q_max is finite and 0 ≤ restitution ≤ 1.
    pub fn above(i: usize, q_max: f64, restitution: f64) -> Result<Self, Error> {
        Error::check("Stop", "q_max", q_max, true, ANY)?;
        Self::along(&[(i, -1.0)], q_max, restitution)
    }

    /// Creates a stop that pushes coordinate i back from below q_min. `restitution` has no effect:
    /// see [rigid stops](Self#rigid-stops).
    ///
    /// # Errors
    ///
    /// [`Error::InvalidParameter`] unless q_min is finite and 0 ≤ restitution ≤ 1.
    pub fn below(i: usize, q_min: f64, restitution: f64) -> Result<Self, Error> {
        Error::check("Stop", "q_min", q_min, true, ANY)?;
        Self::along(&[(i, 1.0)], -q_min, restitution)
    }

    /// Creates a stop between two coordinates, where i hits j from below: g = gap + q_j − q_i.
    /// `restitution` has no effect: see [rigid stops](Self#rigid-stops).
    ///
    /// # Errors
    ///
    /// [`Error::BadDirection`] if i = j; [`Error::InvalidParameter`] unless the gap is finite and 0
    /// ≤ restitution ≤ 1.
    pub fn between(i: usize, j: usize, gap: f64, restitution: f64) -> Result<Self, Error> {
        Self::along(&[(i, -1.0), (j, 1.0)], gap, restitution)
    }

    /// Sets the stiffness k and the damping constant c of the closed stop, in units of force per
    /// length and of force per velocity (along d).
    ///
    /// # Errors
    ///
    /// [`Error::InvalidParameter`] unless both are finite, k > 0 and c ≥ 0.
    pub fn with_contact_stiffness(mut self, stiffness: f64, damping: f64) -> Result<Self, Error> {
        let (is_stiff, allowed) = (stiffness > 0.0, "stiffness > 0");
        Error::check("Stop", "stiffness", stiffness, is_stiff, allowed)?;
        let (is_damped, allowed) = (damping >= 0.0, "damping ≥ 0");
        Error::check("Stop", "damping", damping, is_damped, allowed)?;
        (self.law.0.stiffness, self.law.0.damping) = (stiffness, damping);
        Ok(self)
    }

    /// Lets the stop pull at the end of a contact: F = kδ + cδ' until δ = 0. It changes nothing if
    /// c = 0.
    pub fn adhesive(mut self) -> Self {
        self.law.0.is_adhesive = true;
        self
    }

    /// The direction d: pairs of a coordinate j and its d_j ≠ 0 (dimensionless), by ascending j.
    pub fn direction(&self) -> &[(usize, f64)] {
        &self.direction
    }

    /// The gap g0 at q = 0, in units of length.
    pub fn gap(&self) -> f64 {
        self.law.0.gap
    }

    /// The restitution, dimensionless; it is unused.
    pub fn restitution(&self) -> f64 {
        self.restitution
    }

    /// The stiffness k and the damping constant c; `None` if they were not given.
    pub fn contact_stiffness(&self) -> Option<(f64, f64)> {
        let law = &self.law.0;
        (law.stiffness > 0.0).then_some((law.stiffness, law.damping))
    }

    /// Returns true if the stop [pulls](Self::adhesive) at the end of a contact.
    pub fn is_adhesive(&self) -> bool {
        self.law.0.is_adhesive
    }

    /// The stop as the engine needs it.
    pub(super) fn data(&self) -> ElementData<'_> {
        let factor = Arc::new(Drive::constant(1.0));
        ElementData {
            stop: Some(self.law.0),
            ..ElementData::new(Cow::Borrowed(&self.inward), &self.law, factor)
        }
    }

    /// Checks that this may be stop number `number` of a structure with so many coordinates.
    pub(super) fn check(&self, number: usize, count: usize) -> Result<(), Error> {
        if self.contact_stiffness().is_none() {
            return Err(Error::RigidStop { stop: number });
        }
        let coordinates = self.direction.iter().map(|&(j, _)| j);
        check_coordinates(Element::Stop(number), coordinates, count)
    }
}

impl PartialEq for Stop {
    fn eq(&self, other: &Self) -> bool {
        let numbers = |stop: &Self| (stop.restitution, stop.law.0);
        self.direction == other.direction && numbers(self) == numbers(other)
    }
}

impl std::fmt::Debug for Stop {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Stop")
            .field("direction", &self.direction)
            .field("gap", &self.gap())
            .field("restitution", &self.restitution)
            .field("contact_stiffness", &self.contact_stiffness())
            .field("is_adhesive", &self.is_adhesive())
            .finish()
    }
}
