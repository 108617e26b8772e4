//! The two sides of a change of events, and their approach to it.

use super::branch_equations::FINE;
use super::branch_predictor::CurvePoint;
use super::event_sequence::{Nearness, Sequence};

/// The points on the two sides that are known to be nearest to a change of events.
///
/// Events that change their order or vanish show the distance to the change. With this distance few
/// motions suffice; bisection would take as many motions as a number has bits.
pub(super) struct Sides {
    pub(super) low: CurvePoint,
    pub(super) high: CurvePoint,
    /// The last two nearest points of before on each side, the later first: distances and events.
    before: [Vec<(f64, Sequence)>; 2],
    /// The last estimate of the place of the change.
    expected: Option<f64>,
    /// Width when the interval was last halved.
    width: f64,
    /// Number of motions that have failed to halve the interval since.
    slow: u32,
}

/// Bisection is used after this number of motions that have not halved the interval.
const MOST_SLOW: u32 = 3;

impl Sides {
    pub(super) fn new(low: &CurvePoint, high: &CurvePoint) -> Self {
        Self {
            width: high.distance - low.distance,
            low: low.clone(),
            high: high.clone(),
            before: [Vec::new(), Vec::new()],
            expected: None,
            slow: 0,
        }
    }

    /// Estimate of the place of the change, from the distances of the motions.
    fn expect(&self) -> Option<f64> {
        let (low, high) = (&self.low, &self.high);
        let nearness = |one: &CurvePoint, other: &CurvePoint| {
            let nearness = one.solved.sequence.nearness(&other.solved.sequence)?;
            Some((one.distance, nearness))
        };
        let zeros = match (nearness(low, high), nearness(high, low)) {
            (Some((a, Nearness::Order(f))), Some((b, Nearness::Order(g)))) => {
                vec![extrapolated([(a, f), (b, g)])]
            }
            (Some((a, Nearness::Pair(f))), None) => vanishing((a, f), &self.earlier(0)),
            (None, Some((b, Nearness::Pair(g)))) => vanishing((b, g), &self.earlier(1)),
            _ => return None,
        };
        let mut inside = zeros
            .into_iter()
            .filter(|zero| low.distance < *zero && *zero < high.distance);
        inside.next()
    }

    /// The earlier points on the side that has more events: their distances and pauses.
    fn earlier(&self, side: usize) -> Vec<(f64, f64)> {
        let [own, other] = match side {
            0 => [&self.low, &self.high],
            _ => [&self.high, &self.low],
        };
        let [own, other] = [own, other].map(|point| &point.solved.sequence);
        let before = self.before[side].iter();
        let alike = before.take_while(|(_, sequence)| sequence.is_like(own));
        let nearness = alike.map_while(|(distance, sequence)| match sequence.nearness(other)? {
            Nearness::Pair(pause) => Some((*distance, pause)),
            Nearness::Order(_) => None,
        });
        nearness.collect()
    }

    /// The next place to try: just beyond the estimated change, so that the farther side moves near
    /// to it; `None` for the middle.
    pub(super) fn next_place(&mut self) -> Option<f64> {
        let last = self.expected.take();
        if self.slow >= MOST_SLOW {
            self.slow = 0;
            return None;
        }
        let zero = self.expect()?;
        self.expected = Some(zero);
        let (low, high) = (self.low.distance, self.high.distance);
        let error = last.map_or(0.25 * (high - low), |last| (zero - last).abs());
        let margin = error.clamp(0.25 * FINE, 0.25 * (high - low));
        Some(if high - zero > zero - low {
            zero + margin
        } else {
            zero - margin
        })
    }

    /// Puts a point in the place of that on its side.
    pub(super) fn narrow(&mut self, point: CurvePoint, is_low: bool) {
        let side = if is_low {
            &mut self.low
        } else {
            &mut self.high
        };
        let last = std::mem::replace(side, point);
        let before = &mut self.before[usize::from(!is_low)];
        before.insert(0, (last.distance, last.solved.sequence));
        before.truncate(2);
        let width = self.high.distance - self.low.distance;
        if width <= 0.5 * self.width {
            (self.width, self.slow) = (width, 0);
        } else {
            self.slow += 1;
        }
    }
}

/// The zero of the line through two values.
fn extrapolated([(a, f), (b, g)]: [(f64, f64); 2]) -> f64 {
    b + (b - a) * (g / (f - g))
}

/// The places where a pause may vanish, from that at the nearest point and those before; the
/// likeliest first.
///
/// A pause vanishes like a power p of the distance: p = 1/2 if a quantity touches its bound and
/// turns back, p = 1 if one event overtakes another. Three points determine p; usually it is a
/// touch.
fn vanishing((c, now): (f64, f64), before: &[(f64, f64)]) -> Vec<f64> {
    const TOUCH: f64 = 0.5;
    let Some(&(b, last)) = before.first() else {
        return Vec::new();
    };
    let told = before.get(1).map(|&(a, first)| {
        // The slope of the logarithm is p/(x − zero).
        let slope = |x: f64, f: f64, y: f64, g: f64| (0.5 * (x + y), (f / g).ln() / (x - y));
        let [(x, steep), (y, steeper)] = [slope(a, first, b, last), slope(b, last, c, now)];
        let zero = (steep * x - steeper * y) / (steep - steeper);
        // Halves: more is rounding.
        (2.0 * steep * (x - zero)).round().clamp(1.0, 6.0) / 2.0
    });
    let zero = |power: f64| {
        let root = |pause: f64| pause.powf(power.recip());
        extrapolated([(b, root(last)), (c, root(now))])
    };
    told.into_iter().chain([TOUCH]).map(zero).collect()
}
