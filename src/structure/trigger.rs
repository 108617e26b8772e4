//! What the tangent flow has to know about the events at the end of a step: the conditions that
//! triggered them.

use crate::state::Direction;

/// Data for the tangent flow about the events at the end of a step.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct EventData {
    /// Contacts with a coordinate to themselves, released by a jump of a drive.
    pub(crate) forced: Vec<usize>,
    /// v' just after, if a contact that shares coordinates or slips in one direction only has an
    /// event, or a stop with a damper.
    pub(crate) rates: Vec<f64>,
    /// The conditions that determine the times of events of contacts that share coordinates; none
    /// at a jump of a drive.
    pub(crate) triggers: Vec<Trigger>,
    /// Elastic contacts that came to their limit there, and on which side: their sliders start, or
    /// the load has jumped below what they carried.
    pub(crate) limited: Vec<(usize, Direction)>,
}

impl EventData {
    pub(super) const NONE: Self = Self {
        forced: Vec::new(),
        rates: Vec::new(),
        triggers: Vec::new(),
        limited: Vec::new(),
    };
}

/// The condition that a contact with shared coordinates has reached; it may have no event itself.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Trigger {
    /// Rest: r = 0.
    Rest(usize),
    /// The bound of what contacts that slip together carry: h = Σ w_c λ_c − Σ |w_c| N μ_s, with
    /// these w_c and forces multiplied by G_cc, and the rate of h just before. A single contact has
    /// w = ±1.
    Bound(Vec<(usize, f64)>, f64),
}

impl Trigger {
    pub(crate) fn contacts(&self) -> impl Iterator<Item = usize> {
        let (rest, bound) = match self {
            Self::Rest(contact) => (Some(*contact), &[][..]),
            Self::Bound(parts, _) => (None, &parts[..]),
        };
        rest.into_iter().chain(bound.iter().map(|&(c, _)| c))
    }
}
