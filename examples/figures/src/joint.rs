//! One mass on a Jenkins element: exact resonance curves, and the theory of first harmonics.

use stick_slip::analysis::jenkins::{SymmetricResponse, backbone, first_harmonic};

use super::clip::Point;
use super::plot::{Axis, Panel};
use super::style::{BLACK, BLUE, GREY, Stroke, VERMILLION};
use super::svg::{Figure, Result, svg};

const DAMPING: f64 = 0.02;
const STIFFNESS: f64 = 0.6;
const TANGENTIAL: f64 = 0.4;
const LIMIT: f64 = 0.3;
const FORCES: [f64; 5] = [0.05, 0.15, 0.25, 0.35, 0.42];
const RANGE: std::ops::Range<f64> = 0.65..1.15;

const CAPTION: &str = concat!(
    "One mass on a spring in series with a dry slider: x'' + 0.02 x' + 0.6 x + T = P cos ",
    "ωt, spring 0.4, slider 0.3. (a) Exact amplitudes for P = 0.05, 0.15, 0.25, 0.35 and ",
    "0.42, and to first harmonic (dashed); the backbone (grey). (b) Damping ratio along ",
    "the backbone: nothing is added below the amplitude 0.75, where slip begins.",
);

/// The frequencies, one below and one above the backbone, at which the first harmonic needs a force
/// for an amplitude.
fn harmonic(force: f64, amplitude: f64) -> [Option<f64>; 2] {
    let (added, damper, _) = first_harmonic(TANGENTIAL, LIMIT, amplitude, 1.0);
    // c_eq ω does not depend on ω: (k − ω²)² + (cω + d)² = (P/A)².
    let (k, needed) = (STIFFNESS + added, force / amplitude);
    let missing = |w: f64| (k - w * w).hypot(DAMPING * w + damper) - needed;
    let least = k.sqrt();
    [RANGE.start, RANGE.end].map(|end| {
        let (mut inside, mut outside) = (least, end);
        if missing(inside) > 0.0 || missing(outside) < 0.0 {
            return None;
        }
        for _ in 0..60 {
            let middle = 0.5 * (inside + outside);
            if missing(middle) > 0.0 {
                outside = middle;
            } else {
                inside = middle;
            }
        }
        Some(inside)
    })
}

pub(crate) fn joint() -> Result<Figure> {
    let amplitudes = || (0..=600).map(|i| 0.02 * 10_f64.powf(f64::from(i) / 220.0));
    let points = amplitudes().filter_map(|amplitude| {
        let point = backbone(1.0, DAMPING, STIFFNESS, TANGENTIAL, LIMIT, amplitude)?;
        Some((amplitude, point))
    });
    let points: Vec<_> = points.collect();
    svg((860, 400), CAPTION, |area| {
        let halves = area.split_evenly((1, 2));
        let axes = [
            Axis::new("angular frequency ω", RANGE, 1),
            Axis::new("amplitude A", 0.0..6.0, 0),
        ];
        let mut panel = Panel::new(&halves[0], "(a)  resonance curves", axes)?;
        let line: Vec<Point> = points
            .iter()
            .map(|(amplitude, point)| (point.angular_frequency, *amplitude))
            .collect();
        panel.line(&line, Stroke::solid(GREY, 1.5))?;
        for force in FORCES {
            let exact = (0..=1000).filter_map(|i| {
                let frequency = RANGE.start + (RANGE.end - RANGE.start) * f64::from(i) / 1000.0;
                let found = SymmetricResponse::at(
                    1.0, DAMPING, STIFFNESS, TANGENTIAL, LIMIT, force, frequency,
                )?;
                Some((frequency, found.amplitude))
            });
            panel.line(&exact.collect::<Vec<Point>>(), Stroke::solid(BLUE, 2.0))?;
            // Up on the left, down on the right.
            let sides = [0, 1].map(|side| {
                let on = amplitudes().filter_map(|a| Some((harmonic(force, a)[side]?, a)));
                on.collect::<Vec<Point>>()
            });
            let [left, right] = sides;
            let all: Vec<Point> = left.into_iter().chain(right.into_iter().rev()).collect();
            panel.line(&all, Stroke::dashed(VERMILLION, 1.2, [5, 4]))?;
        }
        let key = [
            (Stroke::solid(BLUE, 2.0), "exact"),
            (Stroke::dashed(VERMILLION, 1.2, [5, 4]), "first harmonic"),
            (Stroke::solid(GREY, 1.5), "backbone"),
        ];
        panel.key((0.62, 0.08), &key)?;
        panel.finish()?;

        let axes = [
            Axis::logarithmic("amplitude A", -1.0..1.0).ticks(3),
            Axis::new("damping ratio ζ", 0.0..0.1, 2),
        ];
        let mut panel = Panel::new(&halves[1], "(b)  damping over amplitude", axes)?;
        let onset = (LIMIT / TANGENTIAL).log10();
        panel.vertical(onset, Stroke::dashed(GREY, 1.0, [3, 3]))?;
        let line: Vec<Point> = points
            .iter()
            .map(|(amplitude, point)| (amplitude.log10(), point.damping_ratio))
            .collect();
        panel.line(&line, Stroke::solid(BLACK, 2.0))?;
        panel.finish()
    })
}
