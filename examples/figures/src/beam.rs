//! A beam on pads of which one opens: resonance curves through their folds, and damping over
//! amplitude.

use super::bolted_beam::{self, FORCES, Point as Motion, SHAPES, WHOLE};
use super::clip::Point;
use super::plot::{Axis, Panel};
use super::style::{BLACK, BLUE, GREEN, GREY, Stroke, VERMILLION};
use super::svg::{Figure, Result, svg};

/// The curves take minutes: the example writes them.
const CURVES: &str = include_str!("../bolted_beam.csv");

/// The resonance curve of each force.
pub(super) fn curves() -> Result<[Vec<Motion>; FORCES.len()]> {
    let mut curves: [Vec<Motion>; FORCES.len()] = Default::default();
    for line in CURVES.lines().skip(1) {
        let [force, frequency, amplitude, stable] = line.split(',').collect::<Vec<_>>()[..] else {
            return Err(format!("no motion: {line}").into());
        };
        let force: f64 = force.parse()?;
        let place = FORCES.iter().position(|&of| of == force);
        let place = place.ok_or_else(|| format!("another force: {line}"))?;
        curves[place].push((frequency.parse()?, amplitude.parse()?, stable.parse()?));
    }
    Ok(curves)
}

/// The frequencies between which a curve has an unstable part, if it has one.
pub(super) fn between_folds(curve: &[Motion]) -> Option<(f64, f64)> {
    let unstable = curve.iter().filter(|motion| !motion.2);
    unstable.fold(None, |found, &(frequency, ..)| {
        let (low, high) = found.unwrap_or((frequency, frequency));
        Some((low.min(frequency), high.max(frequency)))
    })
}

/// Pieces of a curve that are stable throughout or unstable; neighbours share a point.
fn pieces(curve: &[Motion]) -> Vec<(bool, Vec<Point>)> {
    let mut pieces: Vec<(bool, Vec<Point>)> = Vec::new();
    for &(frequency, amplitude, is_stable) in curve {
        let point = (frequency, 1e6 * amplitude);
        match pieces.last_mut() {
            Some((stable, points)) if *stable == is_stable => points.push(point),
            last => {
                let before = last.and_then(|(_, points)| points.last().copied());
                pieces.push((is_stable, before.into_iter().chain([point]).collect()));
            }
        }
    }
    pieces
}

pub(crate) fn beam() -> Result<Figure> {
    let curves = curves()?;
    let (natural, _) = bolted_beam::second_mode().ok_or("no second mode")?;
    let decay = bolted_beam::decay(40, 8)?;
    let ranges = curves.iter().zip(FORCES).filter_map(|(curve, force)| {
        let (low, high) = between_folds(curve)?;
        Some(format!("at {force} N from {low:.1} to {high:.1} Hz"))
    });
    let ranges: Vec<String> = ranges.collect();
    let forces = FORCES.map(|force| force.to_string()).join(", ");
    let caption = format!(
        "A beam of {SHAPES} shapes on six elastic pads with dry friction, one of which is pressed \
         loosely, slips and opens: example bolted_beam. (a) Amplitude of its second bending shape \
         under forces of {forces} N (numbers at the curves), followed from the highest frequency \
         through the folds; dashed: unstable motions, {}. Grey: the frequency with all pads closed \
         and stuck. (b) Damping ratio over amplitude, of a free decay, over 40 periods at a time: \
         at large amplitudes all pads slip and open.",
        ranges.join(", ")
    );
    svg((860, 420), &caption, |area| {
        let halves = area.split_evenly((1, 2));
        let axes = [
            Axis::new("frequency in Hz", WHOLE, 0).ticks(5),
            Axis::new("amplitude in µm", 0.0..70.0, 0),
        ];
        let mut panel = Panel::new(&halves[0], "(a)  resonance", axes)?;
        panel.vertical(natural, Stroke::dashed(GREY, 1.0, [3, 3]))?;
        let strokes = [
            Stroke::solid(BLUE, 2.0),
            Stroke::dashed(VERMILLION, 1.5, [6, 4]),
        ];
        for (curve, force) in curves.iter().zip(FORCES) {
            for (is_stable, points) in pieces(curve) {
                panel.line(&points, strokes[usize::from(!is_stable)])?;
            }
            let top = curve.iter().max_by(|a, b| a.1.total_cmp(&b.1));
            let top = top.ok_or("an empty curve")?;
            panel.label(
                &force.to_string(),
                (top.0, 1e6 * top.1),
                (-4.0, -8.0),
                BLACK,
            )?;
        }
        panel.key(
            (0.5, 0.08),
            &[(strokes[0], "stable"), (strokes[1], "unstable")],
        )?;
        panel.finish()?;

        let axes = [
            Axis::new("amplitude in µm", 0.0..250.0, 0),
            Axis::new("damping ratio ζ in %", 0.0..0.15, 2).ticks(4),
        ];
        let mut panel = Panel::new(&halves[1], "(b)  damping over amplitude", axes)?;
        let line: Vec<Point> = decay.iter().map(|at| (1e6 * at[0], 1e2 * at[2])).collect();
        panel.line(&line, Stroke::solid(GREEN, 2.0))?;
        panel.dots(&line, 2.5, BLACK)?;
        panel.finish()
    })
}
