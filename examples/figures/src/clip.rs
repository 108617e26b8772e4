//! Lines cut at the frame of a chart, which plotters does not do.

use std::ops::Range;

pub(crate) type Point = (f64, f64);

/// The stretches of a line along which a coordinate stays in its range.
pub(crate) fn inside(
    points: &[Point],
    coordinate: fn(Point) -> f64,
    range: &Range<f64>,
) -> Vec<Vec<Point>> {
    let mut parts = vec![Vec::new()];
    for pair in points.windows(2) {
        let (a, b) = (pair[0], pair[1]);
        let (from, to) = (coordinate(a), coordinate(b));
        // Where the segment, from 0 to 1, enters the range and leaves it.
        let [s, t] = [range.start, range.end].map(|end| (end - from) / (to - from));
        let (enter, leave) = match (range.start..=range.end).contains(&to) {
            _ if from != to => (s.min(t).max(0.0), s.max(t).min(1.0)),
            true => (0.0, 1.0),
            false => (0.0, 0.0),
        };
        let at = |t: f64| ((1.0 - t) * a.0 + t * b.0, (1.0 - t) * a.1 + t * b.1);
        if enter > 0.0 {
            parts.push(Vec::new());
        }
        if let (Some(part), true) = (parts.last_mut(), enter < leave) {
            if part.is_empty() {
                part.push(at(enter));
            }
            part.push(at(leave));
        }
        if leave < 1.0 {
            parts.push(Vec::new());
        }
    }
    parts.retain(|part| !part.is_empty());
    parts
}
