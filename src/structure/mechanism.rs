//! The ways in which contacts at rest can begin to slip.

/// A way in which as few contacts as possible begin to slip, as returned by
/// [`Structure::mechanisms`](crate::Structure::mechanisms). All other contacts at rest stick in it.
///
/// ```text
/// power = Σ_c λ_c s_c,   resistance = Σ_c N_c μ_s,c |s_c|,   margin = resistance − power ≥ 0
/// ```
///
/// s_c is the relative velocity of contact c, in units of that of the first contact. Power and
/// resistance are therefore forces: those of the first contact, if it slips alone. Even if the
/// forces λ_c are not [determined](crate::structure::Carried::is_determined), their power is: it is
/// the power of the load, inertia included. The contacts begin to slip when the margin falls to 0.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Mechanism {
    /// The contacts that slip, in rising order, with s_c, which is 1 or −1 for the first.
    pub contacts: Vec<(usize, f64)>,
    /// The power of the load, in units of force.
    pub power: f64,
    /// The power that friction can dissipate at most, in units of force.
    pub resistance: f64,
}

impl Mechanism {
    /// The margin, resistance minus power, in units of force. When these contacts begin to slip, it
    /// is 0 within rounding.
    pub fn margin(&self) -> f64 {
        self.resistance - self.power
    }
}
