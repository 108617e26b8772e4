//! Resonance curves of an oscillator that sticks, followed through their folds.

use stick_slip::orbit::{self, BifurcationKind, Branch, Period};
use stick_slip::structure::State;
use stick_slip::{Contact, Drive, Error, EventKind, Polynomial, Structure};

use super::clip::Point;
use super::plot::{Axis, Panel};
use super::style::{BLACK, BLUE, GREEN, Stroke, VERMILLION};
use super::svg::{Figure, Result, svg};

type System = Structure;

const FORCES: [f64; 3] = [0.14, 0.2, 0.3];
const WHOLE: std::ops::Range<f64> = 0.5..2.0;

/// A mass on a belt under the force p cos Ωt.
pub(super) fn oscillator(force: f64, frequency: f64) -> std::result::Result<System, Error> {
    let law = Polynomial::new(0.55, 0.3, 0.7)?;
    Structure::new(&[1.0])?
        .with_ground_spring(0, 1.0)?
        .with_ground_damper(0, 0.06)?
        .with_force(0, Drive::harmonic(force, frequency, 0.0)?)?
        .with_contact(Contact::new(0, law, 0.9)?.on_belt(0.25))
}

fn branch(force: f64) -> std::result::Result<Branch<State>, Error> {
    let frequency = 0.9;
    let system = oscillator(force, frequency)?;
    let start = orbit::settle(&system, &State::at_rest(1), 400.0, Period::Driven(1))?;
    orbit::follow(
        |frequency| oscillator(force, frequency),
        frequency,
        &start,
        WHOLE,
    )
}

fn amplitude(orbit: &orbit::Orbit<State>) -> f64 {
    let (low, high) = orbit.extremes(0);
    0.5 * (high - low)
}

/// Pieces of a branch that are drawn alike; neighbours share a point.
fn pieces(branch: &Branch<State>) -> Vec<(Stroke, Vec<Point>)> {
    let mut pieces: Vec<((bool, bool), Vec<Point>)> = Vec::new();
    for point in &branch.points {
        let sticks = point.orbit.events().iter();
        let sticks = sticks
            .filter(|event| event.kind == EventKind::Stick)
            .count()
            > 0;
        let kind = (sticks, point.orbit.is_stable());
        let place = (point.parameter, amplitude(&point.orbit));
        match pieces.last_mut() {
            Some((last, points)) if *last == kind => points.push(place),
            Some((_, points)) => {
                let before = points.last().copied();
                pieces.push((kind, before.into_iter().chain([place]).collect()));
            }
            None => pieces.push((kind, vec![place])),
        }
    }
    let stroke = |(sticks, stable): (bool, bool)| {
        let colour = if sticks { BLUE } else { GREEN };
        if stable {
            Stroke::solid(colour, 2.5)
        } else {
            Stroke::dashed(colour, 1.8, [7, 5])
        }
    };
    let drawn = pieces.into_iter();
    drawn.map(|(kind, points)| (stroke(kind), points)).collect()
}

pub(crate) fn resonance() -> Result<Figure> {
    let branches: Vec<_> = FORCES
        .into_iter()
        .map(branch)
        .collect::<std::result::Result<_, Error>>()?;
    let of = |kind: BifurcationKind| {
        let all = branches.iter().flat_map(|branch| &branch.bifurcations);
        let own = all.filter(move |bifurcation| bifurcation.kind == kind);
        own.map(|b| (b.parameter, amplitude(&b.orbit)))
            .collect::<Vec<Point>>()
    };
    let folds = of(BifurcationKind::Fold);
    let caption = format!(
        "Amplitude over the frequency of a forced mass on a belt: \
         x'' + 0.06 x' + x = p cos Ωt − 0.9 μ(v_r), polynomial law, μ_s = 0.55, μ_m = 0.3, \
         v_m = 0.7, belt velocity 0.25. Periodic motions of the period of the force. Solid lines \
         are stable, dashed ones unstable; {} folds (rings) bound the ranges in which the motion \
         is locked to the force.",
        folds.len()
    );
    svg((860, 430), &caption, |area| {
        let axes = [
            Axis::new("angular frequency Ω", WHOLE, 1),
            Axis::new("amplitude (x_{max} − x_{min})/2", 0.0..0.9, 1),
        ];
        let mut panel = Panel::new(area, "", axes)?;
        for branch in &branches {
            for (stroke, points) in pieces(branch) {
                panel.line(&points, stroke)?;
            }
        }
        for fold in &folds {
            panel.ring(*fold, VERMILLION)?;
        }
        panel.dots(&of(BifurcationKind::Flip), 3.5, VERMILLION)?;
        panel.dots(&of(BifurcationKind::Grazing), 3.5, BLACK)?;
        let key = [
            (Stroke::solid(BLUE, 2.5), "stick-slip"),
            (Stroke::solid(GREEN, 2.5), "without stick"),
            (Stroke::dashed(BLACK, 1.8, [7, 5]), "unstable"),
        ];
        panel.key((0.78, 0.08), &key)?;
        panel.finish()
    })
}
