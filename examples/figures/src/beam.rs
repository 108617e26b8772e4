//! A beam on pads that slip and open: resonance swept both ways, and damping over amplitude.

use super::bolted_beam::{self, FORCES, SHAPES, Swept};
use super::clip::Point;
use super::plot::{Axis, Panel};
use super::style::{BLACK, BLUE, GREEN, GREY, Stroke, VERMILLION};
use super::svg::{Figure, Result, svg};

/// The sweeps take minutes: the example writes them.
const SWEEPS: &str = include_str!("../bolted_beam.csv");

/// The sweeps upwards and downwards at each force, each in the order in which it went.
pub(super) fn sweeps() -> Result<[[Vec<Swept>; 2]; FORCES.len()]> {
    let mut sweeps: [[Vec<Swept>; 2]; FORCES.len()] = Default::default();
    for line in SWEEPS.lines().skip(1) {
        let [force, name, numbers @ ..] = &line.split(',').collect::<Vec<_>>()[..] else {
            return Err(format!("no sweep: {line}").into());
        };
        let force: f64 = force.parse()?;
        let place = FORCES.iter().position(|&of| of == force);
        let place = place.ok_or_else(|| format!("another force: {line}"))?;
        let numbers = numbers.iter().map(|number| number.parse());
        let numbers: Vec<f64> = numbers.collect::<std::result::Result<_, _>>()?;
        let [frequency, least, largest] = numbers[..] else {
            return Err(format!("not three numbers: {line}").into());
        };
        sweeps[place][usize::from(*name == "down")].push((frequency, [least, largest]));
    }
    Ok(sweeps)
}

/// The lowest and the highest frequency at which the two sweeps differ by more than a tenth.
pub(super) fn apart([up, down]: &[Vec<Swept>; 2]) -> Option<(f64, f64)> {
    let middle = |swept: &Swept| 0.5 * (swept.1[0] + swept.1[1]);
    let pairs = up.iter().zip(down.iter().rev());
    let mut own = pairs.filter(|(one, other)| middle(other) > 1.1 * middle(one));
    let first = own.next()?.0.0;
    Some((first, own.next_back().map_or(first, |pair| pair.0.0)))
}

/// An amplitude in micrometres.
fn micro(swept: &Swept, which: usize) -> Point {
    (swept.0, 1e6 * swept.1[which])
}

pub(crate) fn beam() -> Result<Figure> {
    let sweeps = sweeps()?;
    let (natural, _) = bolted_beam::second_mode().ok_or("no second mode")?;
    let decay = bolted_beam::decay(40, 4)?;
    let ranges = sweeps.iter().zip(FORCES).filter_map(|(both, force)| {
        let (low, high) = apart(both)?;
        Some(format!("at {force} N from {low:.1} to {high:.1} Hz"))
    });
    let ranges: Vec<String> = ranges.collect();
    let forces = FORCES.map(|force| force.to_string()).join(", ");
    let caption = format!(
        "A beam of {SHAPES} shapes on six elastic pads with dry friction, which slip and open: \
         example bolted_beam. (a) Amplitude of its second bending shape under forces of {forces} N \
         (numbers at the curves), swept downwards and upwards; bars: the amplitudes of 40 periods \
         where the motion has not become periodic after 150. The sweeps differ {}: at the lower \
         end of such a range, or below the frequencies shown, the downward sweep jumps, at its \
         upper end the upward one. Grey: the frequency with all pads closed and stuck. (b) Damping \
         ratio over amplitude, of a free decay, over 40 periods at a time.",
        ranges.join(", ")
    );
    svg((860, 420), &caption, |area| {
        let halves = area.split_evenly((1, 2));
        let ends = 1165.0..1215.0;
        let axes = [
            Axis::new("frequency in Hz", ends, 0).ticks(5),
            Axis::new("amplitude in µm", 0.0..180.0, 0),
        ];
        let mut panel = Panel::new(&halves[0], "(a)  swept both ways", axes)?;
        panel.vertical(natural, Stroke::dashed(GREY, 1.0, [3, 3]))?;
        let strokes = [Stroke::solid(VERMILLION, 1.5), Stroke::solid(BLUE, 2.5)];
        // Upward sweeps over the others: where both agree, both are seen.
        for both in &sweeps {
            for (sweep, stroke) in both.iter().zip(strokes).rev() {
                let middle = sweep.iter().map(|swept| {
                    let [low, high] = [0, 1].map(|which| micro(swept, which));
                    (low.0, 0.5 * (low.1 + high.1))
                });
                panel.line(&middle.collect::<Vec<Point>>(), stroke)?;
                for swept in sweep.iter().filter(|swept| swept.1[1] > 1.01 * swept.1[0]) {
                    panel.line(&[0, 1].map(|which| micro(swept, which)), stroke)?;
                }
            }
        }
        for ([_, down], force) in sweeps.iter().zip(FORCES) {
            let end = micro(&down[0], 0);
            panel.label(&force.to_string(), end, (6.0, 0.0), BLACK)?;
        }
        let key = [(strokes[1], "downwards"), (strokes[0], "upwards")];
        panel.key((0.66, 0.08), &key)?;
        panel.finish()?;

        let axes = [
            Axis::new("amplitude in µm", 0.0..120.0, 0),
            Axis::new("damping ratio ζ in %", 0.0..0.5, 1).ticks(6),
        ];
        let mut panel = Panel::new(&halves[1], "(b)  damping over amplitude", axes)?;
        let line: Vec<Point> = decay.iter().map(|at| (1e6 * at[0], 1e2 * at[2])).collect();
        panel.line(&line, Stroke::solid(GREEN, 2.0))?;
        panel.dots(&line, 2.5, BLACK)?;
        panel.finish()
    })
}
