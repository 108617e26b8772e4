//! Discontinuities: up to one event the motions on both sides of a border are the same, and
//! afterwards they differ. Or they differ by a slip that no other slip takes back.

use super::bifurcations::JUMP;
use super::branch::BranchEnd;
use super::branch_predictor::LocalCurve;
use super::period_map::PeriodMap;
use super::unslipped::slips_one_way;
use crate::error::Element;
use crate::motion::{EventKind, Segment};
use crate::numerics::sort::sort_by;

/// Distances beyond the last motion at which the border is searched, in units of a least one.
const AWAY: [f64; 8] = [1.0, 4.0, 16.0, 64.0, 256.0, 1024.0, 4096.0, 16384.0];

/// Limit of bisections of the interval that holds the border: down to neighbouring numbers.
const MOST_HALVINGS: usize = 64;

/// Largest difference of the motions on the two sides up to the event at the border.
const SAME: f64 = 1e-6;

/// Or, if the jump is large, this part of it.
const BEFORE: f64 = 0.01;

/// A jump above this, in units of the sizes, ends the branch; after a smaller one it may continue.
pub(super) const LARGE: f64 = 1e-3;

/// An event whose time changes by more than this part of the period counts as another event.
const ALIKE: f64 = 1e-3;

/// A jump of the motion.
pub(super) struct Discontinuity {
    /// Distance of the jump behind the last point of the curve.
    pub(super) distance: f64,
    /// The size of the jump, in units of the sizes of the motion.
    pub(super) size: f64,
    pub(super) end: BranchEnd,
}

/// The events of one period are compared first. A motion that magnifies perturbations much shifts
/// its later events far before the border, and only an event near the start needs a second period.
const PERIODS: [f64; 2] = [1.0, 2.0];

/// A motion over three periods, and the events of the first, or of the first two: time, contact and
/// kind.
#[derive(Clone)]
struct Side {
    parameter: f64,
    period: f64,
    map: PeriodMap,
    events: Vec<(f64, Element, EventKind)>,
}

impl LocalCurve<'_, '_> {
    /// The discontinuity at which the curve ends behind its last point, if there is one within some
    /// of these least distances; with its distance, and its size in units of the sizes.
    pub(super) fn discontinuity(&self, least: f64) -> Option<Discontinuity> {
        let mut found = PERIODS.into_iter();
        let found = found.find_map(|periods| self.jump(periods, least));
        found.or_else(|| self.already_slips())
    }

    /// Searches the jump from the events of some periods.
    fn jump(&self, periods: f64, least: f64) -> Option<Discontinuity> {
        let mut low = (0.0, self.side(0.0, periods)?);
        for away in AWAY {
            let high = (away * least, self.side(away * least, periods)?);
            if !high.1.is_like(&low.1, ALIKE) {
                let (below, above) = self.border(low, high.clone(), periods)?;
                let unslipped = self.base.trial.map.unslipped();
                let jump = below.1.jump_to(&above);
                if let Some((size, end)) = jump.or_else(|| below.1.one_way_slip(&above, &unslipped))
                {
                    let distance = below.0;
                    return Some(Discontinuity {
                        distance,
                        size,
                        end,
                    });
                }
            }
            low = high;
        }
        None
    }

    /// The end at the last point, if a contact slips there in one direction only, by a way that
    /// counts as rounding.
    fn already_slips(&self) -> Option<Discontinuity> {
        let map = &self.base.trial.map;
        let (contact, direction) = slips_one_way(&map.steps, |c| map.slips_by_rounding(c))?;
        let parameter = self.curve.parameter(&self.base.y);
        Some(Discontinuity {
            distance: 0.0,
            size: 0.0,
            end: BranchEnd::OneWaySlip {
                parameter,
                contact,
                direction,
            },
        })
    }

    /// The motion from a start on the tangent, at a distance from the last point.
    fn side(&self, distance: f64, periods: f64) -> Option<Side> {
        let y = &self.base.y + self.base.tangent.component_mul(self.scale) * distance;
        let (map, period) = self.curve.motion(&y, &self.base.begin, 3.0).ok()?;
        let inside = map.begins()..map.begins() + periods * period;
        let events = map.events().map(|(event, _)| event);
        let events = events.filter(|event| inside.contains(&event.time));
        let events = events.map(|event| (event.time, event.element, event.kind));
        Some(Side {
            parameter: self.curve.parameter(&y),
            period,
            events: events.collect(),
            map,
        })
    }

    /// The two sides of the change of the event sequence; the first with its distance.
    fn border(
        &self,
        mut low: (f64, Side),
        mut high: (f64, Side),
        periods: f64,
    ) -> Option<((f64, Side), Side)> {
        for _ in 0..MOST_HALVINGS {
            let middle = 0.5 * (low.0 + high.0);
            if middle <= low.0 || middle >= high.0 {
                break;
            }
            let side = self.side(middle, periods)?;
            if side.is_like(&low.1, ALIKE) {
                low = (middle, side);
            } else {
                high = (middle, side);
            }
        }
        Some((low, high.1))
    }
}

impl Side {
    /// The number of first events equal to those of another motion, with times that differ by at
    /// most this part of the period.
    fn alike(&self, other: &Self, part: f64) -> usize {
        let pairs = std::iter::zip(&self.events, &other.events);
        let alike = pairs.take_while(|(a, b)| {
            (a.1, a.2) == (b.1, b.2) && (a.0 - b.0).abs() <= part * self.period
        });
        alike.count()
    }

    fn is_like(&self, other: &Self, part: f64) -> bool {
        let counts = [self.events.len(), other.events.len()];
        counts == [self.alike(other, part); 2]
    }

    /// A time since the last time 0 of the drives.
    fn since_zero(&self, time: f64) -> f64 {
        time.rem_euclid(self.period)
    }

    /// The events of the period in which a time lies, from time 0 of the drives on.
    fn kinds_around(&self, time: f64) -> Vec<(Element, EventKind)> {
        let begins = self.map.begins();
        let begin = begins + ((time - begins) / self.period).floor() * self.period;
        let inside = begin..begin + self.period;
        let events = self.events.iter();
        let mut events: Vec<_> = events.filter(|event| inside.contains(&event.0)).collect();
        sort_by(&mut events, |event| self.since_zero(event.0));
        let events = events.into_iter();
        events.map(|&(_, element, kind)| (element, kind)).collect()
    }

    /// The distance of another motion at a time, in units of the sizes.
    fn apart(&self, other: &Self, time: f64) -> Option<f64> {
        let sizes = self.map.sizes();
        let [a, b] = [self.map.vector_at(time)?, other.map.vector_at(time)?];
        let n = 2 * self.map.start.displacements.len();
        let apart = (a - b).component_div(&sizes);
        Some(apart.rows(0, n).amax())
    }

    /// The end of a branch between two sides, if the motion jumps there.
    fn jump_to(&self, beyond: &Self) -> Option<(f64, BranchEnd)> {
        let same = self.alike(beyond, SAME);
        // Motions part at an event of a contact: where one of them just touches a stop, the jump of
        // the stop's force is 0, and the motion continuous.
        let first = [self, beyond].map(|side| {
            let mut others = side.events.iter().skip(same);
            others.find_map(|&(time, element, _)| Some((time, element.contact()?)))
        });
        let first = first.into_iter().flatten();
        let (time, contact) = first.min_by(|a, b| a.0.total_cmp(&b.0))?;
        let later = self.map.steps.iter().map(Segment::end_time);
        let later = later.filter(|end| (time..time + self.period).contains(end));
        let jumps = later.filter_map(|end| self.apart(beyond, end));
        let jump = jumps.fold(0.0, f64::max);
        // At a tangential release the time of the event, and what follows, varies by a square root.
        let same = SAME.max(BEFORE * jump);
        if jump <= JUMP || self.apart(beyond, time)? > same {
            return None;
        }
        let end = BranchEnd::Discontinuity {
            parameter: self.parameter,
            time: self.since_zero(time),
            contact,
            events: self.kinds_around(time),
            beyond: beyond.kinds_around(time),
        };
        Some((jump, end))
    }

    /// The end of a branch between two sides, if a contact that never slips on this side slips
    /// beyond, in one direction only.
    ///
    /// Its size counts as infinite, unless the slip may be a translation that nothing depends on:
    /// then the branch may continue.
    fn one_way_slip(&self, beyond: &Self, unslipped: &[usize]) -> Option<(f64, BranchEnd)> {
        let (contact, direction) = slips_one_way(&beyond.map.steps, |c| unslipped.contains(&c))?;
        let size = if beyond.map.has_translations() {
            0.0
        } else {
            f64::INFINITY
        };
        let end = BranchEnd::OneWaySlip {
            parameter: self.parameter,
            contact,
            direction,
        };
        Some((size, end))
    }
}
