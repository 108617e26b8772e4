//! What ends a step: the first times at which sliding speeds, stick bands and loads come to 0.

use super::edge::Edge;
use super::model::Model;
use super::series::{ContactSeries, Series};
use super::state::{ContactState, Firing, Phase, Situation};
use crate::series::{PowerSeries, TooCurved, Watch, quarters};
use crate::state::Direction;

/// Ulps of the time by which events of several contacts may lie apart that end a step together:
/// rounding alone can part those of mirrored masses so far.
const TOGETHER: f64 = 4.0;

/// When and why each contact ends the step, if it does.
pub(super) type Firings = Vec<Option<(f64, Firing)>>;

/// The first time in (0, h] at which something happens at a contact, or h; which contacts it is is
/// noted. Within rounding of a break of a drive it is that: what a contact comes to where pieces of
/// a drive meet, the later piece decides on.
pub(super) fn first_firings(
    model: &Model<'_>,
    situation: &Situation,
    series: &Series,
    [h, to_break]: [f64; 2],
    firings: &mut Firings,
) -> Result<f64, TooCurved> {
    let elapsed = situation.clock.time.abs();
    let slack = |end: f64| TOGETHER * f64::EPSILON * (elapsed + end);
    let mut end = h;
    firings.clear();
    for (c, contact) in model.contacts.iter().enumerate() {
        let limit = if end < h { h.min(end + slack(end)) } else { h };
        let (state, series) = (&situation.contacts[c], &series.contacts[c]);
        let firing = first_firing(state, series, &contact.breakpoints, limit)?;
        if let Some((time, _)) = firing {
            end = end.min(time);
        }
        firings.push(firing);
    }
    for firing in firings.iter_mut() {
        *firing = firing.filter(|&(time, _)| time <= end + slack(end));
    }
    if to_break <= end + slack(end) {
        end = end.max(to_break);
    }
    Ok(end)
}

/// The first time in (0, h] at which something happens at a contact, and what.
fn first_firing(
    state: &ContactState,
    series: &ContactSeries,
    breakpoints: &[f64],
    h: f64,
) -> Result<Option<(f64, Firing)>, TooCurved> {
    let of_load = load_firing(state, series, h)?;
    let of_motion = match state.phase {
        Phase::Open => None,
        Phase::Stick { .. } => bound_firing(series, state.edge, h)?,
        Phase::Slip { piece, .. } => speed_firing(&series.speeds, breakpoints, piece, h)?,
    };
    Ok(match (of_load, of_motion) {
        (Some(load), Some(motion)) if motion.0 < load.0 => Some(motion),
        (load, motion) => load.or(motion),
    })
}

/// The normal load falls to 0, or comes back.
fn load_firing(
    state: &ContactState,
    series: &ContactSeries,
    h: f64,
) -> Result<Option<(f64, Firing)>, TooCurved> {
    if !series.load_varies {
        return Ok(None);
    }
    let sign = if let Phase::Open = state.phase {
        -1.0
    } else {
        1.0
    };
    let mut load = series.load.scaled(sign);
    for k in 0..state.load_edge.known() {
        load[k] = 0.0;
    }
    first(&load, h, Firing::Load)
}

/// What a sticking contact carries comes to one of its limits.
fn bound_firing(
    series: &ContactSeries,
    edge: Edge,
    h: f64,
) -> Result<Option<(f64, Firing)>, TooCurved> {
    let carried = &series.carried;
    if edge == Edge::Away && series.bound.is_constant() && carried.stays_within(series.bound[0], h)
    {
        return Ok(None);
    }
    let mut found: Option<(f64, Firing)> = None;
    for side in [Direction::Lagging, Direction::Leading] {
        let distance = edge.distance(series, side);
        let h = found.map_or(h, |(time, _)| time);
        found = first(&distance, h, Firing::Bound(side))?.or(found);
    }
    Ok(found)
}

/// The sliding speed comes to 0, or to a breakpoint of the law.
fn speed_firing(
    speeds: &PowerSeries,
    breakpoints: &[f64],
    piece: usize,
    h: f64,
) -> Result<Option<(f64, Firing)>, TooCurved> {
    if speeds.is_constant() {
        return Ok(None);
    }
    let low = match piece.checked_sub(1) {
        // The usual case, kept short.
        None if speeds[0] > 0.0 => {
            let root = speeds.first_root(h, speeds.at_four(quarters(h)))?;
            root.map(|time| (time, Firing::Arrival))
        }
        None => first(speeds, h, Firing::Arrival)?,
        Some(below) => {
            let distance = speeds.minus(breakpoints[below]);
            first(&distance, h, Firing::Breakpoint(below, false))?
        }
    };
    let Some(&level) = breakpoints.get(piece) else {
        return Ok(low);
    };
    let h = low.map_or(h, |(time, _)| time);
    let distance = speeds.minus(level).scaled(-1.0);
    Ok(first(&distance, h, Firing::Breakpoint(piece, true))?.or(low))
}

/// When a distance is 0 first.
fn first(
    distance: &PowerSeries,
    h: f64,
    firing: Firing,
) -> Result<Option<(f64, Firing)>, TooCurved> {
    let Some(watch) = Watch::new(distance) else {
        return Ok(None);
    };
    Ok(watch.first_zero(h)?.map(|time| (time, firing)))
}
