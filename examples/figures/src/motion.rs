//! Figs. 4, 5 and 7: a motion from rest over time and in the phase plane, beside the exact cycle
//! that it settles to.

use std::ops::Range;

use plotters::style::AsRelative;
use stick_slip::{
    AnyLaw, Exponential, MassOnBelt, Mode, Polynomial, State, Trajectory, limit_cycle,
};

use super::clip::Point;
use super::plot::{Axis, Panel};
use super::style::{BLACK, BLUE, GREY, SKY, Stroke, VERMILLION, pale};
use super::svg::{Figure, Result, svg};

const SLIP: Stroke = Stroke::solid(BLUE, 2.0);
const STICK: Stroke = Stroke::solid(VERMILLION, 3.0);
const TRANSIENT: Stroke = Stroke::solid(SKY, 1.0);
/// Width over height of the phase plane, so that both axes have the same scale.
const ASPECT: f64 = 342.0 / 368.0;
const BELT: Stroke = Stroke::dashed(GREY, 1.0, [3, 3]);

const FIG4: &str = "Fig. 4. From rest to vibration that never sticks: polynomial law, γ² = 1, v_m \
    = 0.5, μ_s = 0.4, μ_m = 0.25, β = 0.05, v_b = 0.4. The exact limit cycle is drawn over the \
    motion; steady sliding (ring) is unstable.";

pub(crate) fn fig4() -> Result<Figure> {
    let law = Polynomial::new(0.4, 0.25, 0.5)?;
    motion(FIG4, law.into(), 0.4, 120.0, -0.5..0.6)
}

const FIG5: &str = "Fig. 5. Stick-slip from rest: as Fig. 4, but v_b = 0.2. Stick phases are \
    marked; from the first release on the motion is periodic.";

pub(crate) fn fig5() -> Result<Figure> {
    let law = Polynomial::new(0.4, 0.25, 0.5)?;
    motion(FIG5, law.into(), 0.2, 30.0, -0.4..0.4)
}

const FIG7: &str = "Fig. 7. Stick-slip with the exponential law: μ_s = 0.4, μ_k = 0.25, v_s = 0.5, \
    γ² = 1, β = 0.05, v_b = 0.2 (the paper gives no numbers, but says that they are those of the \
    polynomial law).";

pub(crate) fn fig7() -> Result<Figure> {
    let law = Exponential::new(0.4, 0.25, 0.5)?;
    motion(FIG7, law.into(), 0.2, 30.0, -0.4..0.4)
}

fn motion(
    caption: &str,
    law: AnyLaw,
    v_b: f64,
    duration: f64,
    velocities: Range<f64>,
) -> Result<Figure> {
    let system = MassOnBelt::new(law, v_b)?.with_damping(0.05)?;
    let transient = phases(&system.simulate(State::new(0.0, 0.0), duration)?);
    let cycles = limit_cycle::find(&system)?;
    let cycle = cycles.stable().next().ok_or("no vibration")?;
    let middle = 0.5 * (cycle.max_displacement() + cycle.min_displacement());
    let half = 0.5 * ASPECT * (velocities.end - velocities.start);
    let displacements = middle - half..middle + half;

    svg((860, 430), caption, |area| {
        let (left, right) = area.split_horizontally(50.percent_width());
        let (upper, lower) = left.split_vertically(48.percent_height());

        let axes = [
            Axis::new("", 0.0..duration, 0),
            Axis::new("displacement u", displacements.clone(), 1).ticks(6),
        ];
        let mut panel = Panel::new(&upper, "", axes)?;
        over_time(&mut panel, &transient, |state| state.displacement)?;
        panel.finish()?;

        let axes = [
            Axis::new("time τ", 0.0..duration, 0),
            Axis::new("velocity v", velocities.clone(), 1).ticks(6),
        ];
        let mut panel = Panel::new(&lower, "", axes)?;
        panel.horizontal(v_b, BELT)?;
        over_time(&mut panel, &transient, |state| state.velocity)?;
        panel.finish()?;

        let axes = [
            Axis::new("displacement u", displacements.clone(), 1).ticks(6),
            Axis::new("velocity v", velocities, 1),
        ];
        let mut panel = Panel::new(&right, "", axes)?;
        panel.horizontal(v_b, BELT)?;
        panel.label("v = v_b", (displacements.end, v_b), (-6.0, -10.0), GREY)?;
        for phase in &transient {
            panel.line(&phase.points(in_plane), TRANSIENT)?;
        }
        for phase in phases(&cycle.trajectory()) {
            panel.line(&phase.points(in_plane), phase.stroke())?;
        }
        if let Some(equilibrium) = system.equilibrium() {
            let place = (equilibrium.displacement, 0.0);
            panel.ring(place, BLACK)?;
            panel.label("steady sliding", place, (0.0, 16.0), BLACK)?;
        }
        let mut rows = vec![(TRANSIENT, "motion from rest"), (SLIP, "limit cycle, slip")];
        if cycle.stick_duration() > 0.0 {
            rows.push((STICK, "limit cycle, stick"));
        }
        panel.key((0.05, 0.05), &rows)?;
        panel.finish()
    })
}

/// A stretch of stick or of slip, with states that lie closely enough to be joined by straight
/// lines.
struct Phase {
    sticks: bool,
    states: Vec<(f64, State)>,
}

impl Phase {
    fn points(&self, coordinates: impl Fn(f64, State) -> Point) -> Vec<Point> {
        let points = self.states.iter();
        points
            .map(|&(time, state)| coordinates(time, state))
            .collect()
    }

    fn stroke(&self) -> Stroke {
        if self.sticks { STICK } else { SLIP }
    }
}

fn in_plane(_: f64, state: State) -> Point {
    (state.displacement, state.velocity)
}

/// The steps of a motion joined to phases. A step holds its power series, and so gives the state
/// anywhere inside.
fn phases(motion: &Trajectory) -> Vec<Phase> {
    let mut phases: Vec<Phase> = Vec::new();
    for step in motion.steps() {
        let sticks = step.mode() == Mode::Stick;
        if phases.last().is_none_or(|phase| phase.sticks != sticks) {
            let states = Vec::new();
            phases.push(Phase { sticks, states });
        }
        let pieces = if sticks {
            1
        } else {
            1 + (step.duration() / 0.06) as u32
        };
        let times = (0..=pieces).map(|i| step.duration() * f64::from(i) / f64::from(pieces));
        if let Some(phase) = phases.last_mut() {
            let states = times.map(|t| (step.start_time() + t, step.state_at(t)));
            phase.states.extend(states);
        }
    }
    phases
}

fn over_time(panel: &mut Panel, phases: &[Phase], of: fn(State) -> f64) -> Result<()> {
    for phase in phases.iter().filter(|phase| phase.sticks) {
        if let [(start, _), .., (end, _)] = phase.states[..] {
            panel.band(start..end, pale(VERMILLION, 0.15))?;
        }
    }
    for phase in phases {
        panel.line(
            &phase.points(|time, state| (time, of(state))),
            phase.stroke(),
        )?;
    }
    Ok(())
}
