//! What the system settles to, over belt velocity and damping: regions with exact borders.

use std::f64::consts::FRAC_PI_2;
use std::ops::Range;

use plotters::style::RGBColor;
use stick_slip::analysis;
use stick_slip::bifurcation::{
    crossing_velocities, fold_velocities, grazing_velocities, hopf_velocities, overshoot_velocities,
};
use stick_slip::{Error, Exponential, MassOnBelt, Polynomial};

use super::clip::Point;
use super::plot::{Axis, Panel};
use super::style::{BLACK, BLUE, GREEN, ORANGE, PURPLE, SKY, Stroke, VERMILLION, pale};
use super::svg::{Area, Figure, Result, svg};

const CAPTION: &str = "What the mass settles to, over belt velocity and damping. The borders are \
    exact: Hopf points of steady sliding (black), grazing, where stick-slip appears (blue), \
    overshoot and crossing, where the mass begins to overtake the belt (purple), folds of \
    pure-slip cycles (green). (a) Polynomial law, μ_s = 0.4, μ_m = 0.1, v_m = 1, γ² = 0.15. (b) \
    Exponential law, μ_s = 0.6, μ_k = 0.3, v_s = 0.4, γ² = 1: here two motions can exist side by \
    side, and on a slow belt steady sliding is stable again.";

const BELT_VELOCITY: &str = "belt velocity v_b";
const DAMPING: &str = "damping ratio β";

const PURE_SLIP: RGBColor = pale(GREEN, 0.3);
const STICK_SLIP: RGBColor = pale(SKY, 0.35);

const HOPF: Stroke = Stroke::solid(BLACK, 2.0);
const GRAZING: Stroke = Stroke::solid(BLUE, 2.0);
const OVERTAKING: Stroke = Stroke::solid(PURPLE, 2.0);
/// Upper left corner of the keys, in fractions of the frame.
const KEY: Point = (0.58, 0.13);

const FOLD: Stroke = Stroke::solid(GREEN, 2.0);

pub(crate) fn regimes() -> Result<Figure> {
    svg((860, 430), CAPTION, |area| {
        let halves = area.split_evenly((1, 2));
        polynomial(&halves[0])?;
        exponential(&halves[1])
    })
}

fn polynomial(area: &Area) -> Result<()> {
    let system = MassOnBelt::new(Polynomial::new(0.4, 0.1, 1.0)?, 0.5)?.with_load(0.15)?;
    let quiet = analysis::polynomial::silencing_damping_everywhere(&system);
    let range = 0.0..1.1;
    let below = |velocities: Vec<f64>| velocities.first().map(|&v_b| [-1.0, v_b]);
    let between = |velocities: Vec<f64>| match velocities[..] {
        [low, high] => Some([low, high]),
        _ => None,
    };
    let vibrating = region(0.0..quiet, 0.01, 48, |beta| {
        let system = system.with_damping(beta)?;
        hopf_velocities(&system, range.clone()).map(below)
    })?;
    let sticking = region(0.0..quiet, 0.01, 48, |beta| {
        let system = system.with_damping(beta)?;
        grazing_velocities(&system, range.clone()).map(below)
    })?;
    let overshoot = region(0.0..quiet, 0.01, 48, |beta| {
        let system = system.with_damping(beta)?;
        overshoot_velocities(&system, range.clone()).map(between)
    })?;
    let crossing = region(0.0..quiet, 0.002, 48, |beta| {
        let system = system.with_damping(beta)?;
        crossing_velocities(&system, range.clone()).map(between)
    })?;

    let axes = [
        Axis::new(BELT_VELOCITY, range.clone(), 1),
        Axis::new(DAMPING, 0.0..0.042, 2),
    ];
    let mut panel = Panel::new(area, "(a)  polynomial law", axes)?;
    for (border, colour, stroke) in [
        (&vibrating, PURE_SLIP, HOPF),
        (&sticking, STICK_SLIP, GRAZING),
        (&overshoot, pale(PURPLE, 0.35), OVERTAKING),
        (&crossing, pale(PURPLE, 0.65), OVERTAKING),
    ] {
        panel.polygon(border, colour)?;
        panel.line(border, stroke)?;
    }
    let law = "μ_s = 0.4,  μ_m = 0.1,  v_m = 1,  γ² = 0.15";
    panel.label(law, (0.0, 0.0402), (8.0, 0.0), BLACK)?;
    panel.key(
        KEY,
        &[
            (HOPF, "Hopf"),
            (GRAZING, "grazing"),
            (OVERTAKING, "overtaking"),
        ],
    )?;
    for (text, place) in [
        ("steady sliding", (0.9, 0.028)),
        ("stick-slip", (0.25, 0.023)),
        ("overshoot", (0.46, 0.0125)),
        ("crossing", (0.58, 0.0025)),
    ] {
        panel.label(text, place, (0.0, 0.0), BLACK)?;
    }
    panel.pointer("pure slip", (0.6, 0.0196), (50.0, -25.0))?;
    panel.finish()
}

fn exponential(area: &Area) -> Result<()> {
    let system = MassOnBelt::new(Exponential::new(0.6, 0.3, 0.4)?, 0.5)?;
    let quiet = analysis::exponential::silencing_damping_everywhere(&system);
    // The upper border leaves the picture as β → 0; where it is not found, it lies beyond this.
    let end = 2.0;
    let hopf = |beta: f64| {
        let velocities = hopf_velocities(&system.with_damping(beta)?, 0.0..end)?;
        let low = velocities.first();
        Ok(low.map(|&low| [low, velocities.get(1).copied().unwrap_or(end)]))
    };
    let grazing = |beta: f64| {
        let velocities = grazing_velocities(&system.with_damping(beta)?, 0.0..end)?;
        let low = velocities.first();
        Ok(low.map(|&low| [low, velocities.get(1).copied().unwrap_or(end)]))
    };
    let vibrating = region(0.0..quiet, 0.1, 48, hopf)?;
    let sticking = region(0.0..quiet, 0.1, 48, grazing)?;
    let or_sticking = region(0.0..quiet, 0.1, 48, |beta| {
        let (hopf, grazing) = (hopf(beta)?, grazing(beta)?);
        Ok(hopf
            .zip(grazing)
            .and_then(|([_, unstable_up_to], [_, sticks_up_to])| {
                (unstable_up_to < sticks_up_to).then_some([unstable_up_to, sticks_up_to])
            }))
    })?;
    let or_pure_slip = region(0.0..quiet, 0.15, 24, |beta| {
        let (hopf, grazing) = (hopf(beta)?, grazing(beta)?);
        let Some(([_, unstable_up_to], [_, sticks_up_to])) = hopf.zip(grazing) else {
            return Ok(None);
        };
        let start = unstable_up_to.max(sticks_up_to);
        let folds = fold_velocities(&system.with_damping(beta)?, start..start + 0.05)?;
        Ok(folds.first().map(|&fold| [start, fold]))
    })?;

    let axes = [
        Axis::new(BELT_VELOCITY, 0.0..1.4, 1),
        Axis::new(DAMPING, 0.0..0.4, 2),
    ];
    let mut panel = Panel::new(area, "(b)  exponential law", axes)?;
    panel.polygon(&vibrating, PURE_SLIP)?;
    panel.polygon(&sticking, STICK_SLIP)?;
    panel.polygon(&or_sticking, pale(ORANGE, 0.4))?;
    panel.polygon(&or_pure_slip, pale(VERMILLION, 0.5))?;
    panel.line(&or_pure_slip, FOLD)?;
    panel.line(&vibrating, HOPF)?;
    panel.line(&sticking, GRAZING)?;
    let law = "μ_s = 0.6,  μ_k = 0.3,  v_s = 0.4,  γ² = 1";
    panel.label(law, (0.0, 0.383), (8.0, 0.0), BLACK)?;
    panel.key(
        KEY,
        &[
            (HOPF, "Hopf"),
            (GRAZING, "grazing"),
            (FOLD, "fold of pure slip"),
        ],
    )?;
    panel.label("stick-slip", (0.35, 0.09), (0.0, 0.0), BLACK)?;
    panel.label("steady sliding", (1.12, 0.032), (0.0, -8.0), BLACK)?;
    panel.label("or stick-slip", (1.12, 0.032), (0.0, 8.0), BLACK)?;
    panel.label("steady sliding", (0.98, 0.24), (0.0, 0.0), BLACK)?;
    panel.pointer("pure slip", (0.36, 0.26), (50.0, -25.0))?;
    panel.pointer("steady sliding", (0.6, 0.14), (50.0, -25.0))?;
    panel.label("or pure slip", (0.6, 0.14), (54.0, -9.0), BLACK)?;
    panel.finish()
}

/// The border of the region of dampings, within a range and around one that belongs to it, at which
/// there is an interval of belt velocities. Its ends are halved a third as many times as there are
/// points.
fn region(
    range: Range<f64>,
    inside: f64,
    points: u32,
    interval: impl Fn(f64) -> std::result::Result<Option<[f64; 2]>, Error>,
) -> Result<Vec<Point>> {
    let mut ends = [range.start, range.end];
    for end in &mut ends {
        let (mut some, mut none) = (inside, *end);
        for _ in 0..points / 3 {
            let middle = 0.5 * (some + none);
            if interval(middle)?.is_some() {
                some = middle;
            } else {
                none = middle;
            }
        }
        *end = some;
    }
    let (mut lower, mut upper) = (Vec::new(), Vec::new());
    for i in 0..=points {
        // Crowded at both ends, where the border may turn.
        let way = (FRAC_PI_2 * f64::from(i) / f64::from(points)).sin().powi(2);
        let beta = ends[0] + (ends[1] - ends[0]) * way;
        if let Some([low, high]) = interval(beta)? {
            lower.push((low, beta));
            upper.push((high, beta));
        }
    }
    lower.extend(upper.into_iter().rev());
    Ok(lower)
}
