//! A forced stick-slip oscillator once a period of the force, and its largest Lyapunov exponent.

use stick_slip::Error;
use stick_slip::orbit;
use stick_slip::structure::State;

use super::clip::Point;
use super::plot::{Axis, Panel};
use super::resonance::oscillator;
use super::style::{BLACK, BLUE, GREY, Stroke};
use super::svg::{Figure, Result, svg};

const FREQUENCY: f64 = 1.15;
const FORCES: std::ops::Range<f64> = 0.07..0.12;
const COUNT: usize = 160;
const TRANSIENT: usize = 300;
const SAMPLES: usize = 60;

fn column(force: f64) -> std::result::Result<(Vec<Point>, Point), Error> {
    let system = oscillator(force, FREQUENCY)?;
    let period = std::f64::consts::TAU / FREQUENCY;
    let start = State::at_rest(1);
    let section = orbit::section(&system, &start, period);
    let section = section.skip(TRANSIENT).take(SAMPLES);
    let section = section.map(|state| Ok((force, state?.displacements[0])));
    let section = section.collect::<std::result::Result<_, Error>>()?;
    let duration = 5.0 * SAMPLES as f64 * period;
    let exponent = orbit::lyapunov(&system, &start, TRANSIENT as f64 * period, duration)?;
    Ok((section, (force, exponent)))
}

pub(crate) fn chaos() -> Result<Figure> {
    let step = (FORCES.end - FORCES.start) / (COUNT - 1) as f64;
    let columns = (0..COUNT).map(|i| column(FORCES.start + step * i as f64));
    let columns: Vec<_> = columns.collect::<std::result::Result<_, Error>>()?;
    let states: Vec<Point> = columns.iter().flat_map(|column| column.0.clone()).collect();
    let exponents: Vec<Point> = columns.iter().map(|column| column.1).collect();
    let caption = "A forced mass on a belt, x'' + 0.06 x' + x = p cos 1.15t − 0.9 μ(v_r), \
                   polynomial law, μ_s = 0.55, μ_m = 0.3, v_m = 0.7, belt velocity 0.25: its \
                   displacement once a period of the force, and its largest Lyapunov exponent.";
    svg((860, 560), caption, |area| {
        let halves = area.split_evenly((2, 1));
        let force = || Axis::new("force p", FORCES, 2);
        let axes = [force(), Axis::new("x once a period", -0.2..0.8, 1)];
        let mut panel = Panel::new(&halves[0], "", axes)?;
        panel.dots(&states, 0.7, BLACK)?;
        panel.finish()?;
        let axes = [force(), Axis::new("largest exponent", -0.15..0.05, 2)];
        let mut panel = Panel::new(&halves[1], "", axes)?;
        panel.horizontal(0.0, Stroke::solid(GREY, 0.8))?;
        panel.line(&exponents, Stroke::solid(BLUE, 1.2))?;
        panel.finish()
    })
}
