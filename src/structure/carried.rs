//! The friction forces of contacts at an instant.

/// The friction force λ of a contact at an instant, as returned by
/// [`Structure::carried`](crate::Structure::carried), in units of force. A positive λ opposes a
/// positive relative velocity.
///
/// Contacts at rest whose directions are linearly dependent (parallel clutches; two brakes and the
/// clutch between them) carry their load together, and nothing determines what each of them
/// carries: any forces within their limits that balance the same load are possible. `least` and
/// `most` are the ends of the range of these forces. `force` belongs to the possible distribution
/// with the least sum of (λ/(N μ_s))² over these contacts.
///
/// For all other contacts the three numbers are the same.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Carried {
    /// A possible force, and the only one if it [is determined](Self::is_determined).
    pub force: f64,
    /// The least possible force.
    pub least: f64,
    /// The largest possible force.
    pub most: f64,
}

impl Carried {
    /// A force that is determined.
    pub(super) fn of(force: f64) -> Self {
        Self {
            force,
            least: force,
            most: force,
        }
    }

    /// Restricts the range; one within rounding is a number.
    pub(super) fn restrict(&mut self, least: f64, most: f64) {
        const ROUNDING: f64 = 16.0 * f64::EPSILON;
        self.least = self.least.max(least);
        self.most = self.most.min(most);
        let size = least.abs().max(most.abs()).max(self.force.abs());
        if size.is_finite() && self.most - self.least <= ROUNDING * size {
            let middle = 0.5 * (self.least + self.most);
            *self = Self::of(middle);
        }
        self.force = self.force.max(self.least).min(self.most);
    }

    /// Returns true if only one force is possible.
    pub fn is_determined(&self) -> bool {
        self.least == self.most
    }
}
