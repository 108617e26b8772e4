//! The sliding speed of a fault over its cycles, and in an earthquake.

use stick_slip::Segment;
use stick_slip::structure::Step;

use super::clip::Point;
use super::earthquake::{PLATE, YEAR, cycle, speed};
use super::plot::{Axis, Panel};
use super::style::{BLUE, GREY, Stroke};
use super::svg::{Figure, Result, svg};

const CAPTION: &str = "The sliding speed V of a spring-slider under rate-and-state friction with \
    the aging law, of the example earthquake, k = 0.4 k_c. (a) Two cycles, over 15 decades of V; \
    the fault creeps for 25 years and slides for seconds. Dashed: the plate. (b) An earthquake: \
    time from its fastest slip.";

/// Places in a step at which the speed is drawn.
const PARTS: u32 = 6;

/// Decimal logarithms of the speed along a step, each with its time.
fn points(step: &Step) -> impl Iterator<Item = Point> {
    let place = |part: u32| step.duration() * f64::from(part) / f64::from(PARTS);
    (0..=PARTS).map(move |part| {
        let state = step.state_at(place(part));
        (step.start_time() + place(part), speed(&state).log10())
    })
}

pub(crate) fn fault() -> Result<Figure> {
    let (fault, orbit) = cycle(0.4)?;
    let motion = fault.simulate(orbit.state().clone(), 2.0 * orbit.period())?;
    let points: Vec<Point> = motion.steps().iter().flat_map(points).collect();
    let first = points.iter().filter(|point| point.0 < orbit.period());
    let fastest = first
        .max_by(|a, b| a.1.total_cmp(&b.1))
        .ok_or("no speed")?
        .0;
    svg((860, 400), CAPTION, |area| {
        let halves = area.split_evenly((1, 2));
        let speeds = || Axis::logarithmic("speed V, m/s", -17.0..1.0).ticks(9);
        let axes = [Axis::new("time, years", 0.0..52.0, 0), speeds()];
        let mut panel = Panel::new(&halves[0], "(a)  two cycles", axes)?;
        panel.horizontal(PLATE.log10(), Stroke::dashed(GREY, 1.0, [3, 3]))?;
        let years: Vec<Point> = points.iter().map(|&(time, v)| (time / YEAR, v)).collect();
        panel.line(&years, Stroke::solid(BLUE, 2.0))?;
        panel.finish()?;

        let axes = [Axis::new("time, s", -40.0..40.0, 0).ticks(9), speeds()];
        let mut panel = Panel::new(&halves[1], "(b)  an earthquake", axes)?;
        panel.horizontal(PLATE.log10(), Stroke::dashed(GREY, 1.0, [3, 3]))?;
        let seconds: Vec<Point> = points
            .iter()
            .map(|&(time, v)| (time - fastest, v))
            .collect();
        panel.line(&seconds, Stroke::solid(BLUE, 2.0))?;
        panel.finish()
    })
}
