//! Two figures of several masses: a chain of blocks that slip in avalanches, and two modes that
//! merge.

use plotters::style::AsRelative;
use stick_slip::analysis::mode_coupling::ModeCoupling;
use stick_slip::nalgebra::DMatrix;
use stick_slip::structure::State;
use stick_slip::{Contact, Coulomb, EventKind, Rational, Structure};

use super::clip::Point;
use super::plot::{Axis, Panel};
use super::style::{BLUE, GREY, Stroke, VERMILLION};
use super::svg::{Figure, Result, svg};

const CHAIN: &str = "A Burridge-Knopoff chain: 30 blocks on a belt with v = 0.05, each held by a \
    spring of 1 and joined to the next by one of 10; μ = 1/(1 + 2s), mass and load 1. (a) Every \
    slip of every block, from its release to where it sticks again. Most slips begin at one block \
    and run along the chain. (b) Mean displacement: it rises with the belt and falls with every \
    avalanche.";

/// Number of blocks.
const BLOCKS: usize = 30;

pub(crate) fn chain() -> Result<Figure> {
    let law = Rational::new(1.0, 2.0)?;
    let mut chain = Structure::new(&[1.0; BLOCKS])?;
    for i in 0..BLOCKS {
        chain = chain
            .with_ground_spring(i, 1.0)?
            .with_contact(Contact::new(i, law, 1.0)?.on_belt(0.05))?;
        if i > 0 {
            chain = chain.with_spring(i - 1, i, 10.0)?;
        }
    }
    // Uneven, so that not all are released at once.
    let start: Vec<f64> = (0..BLOCKS)
        .map(|i| 0.3 * (0.7 * (i * i) as f64).sin())
        .collect();
    let (from, to) = (40.0, 160.0);
    let motion = chain.simulate(State::new(&start, &[0.05; BLOCKS]), to)?;

    svg((860, 620), CHAIN, |area| {
        let (upper, lower) = area.split_vertically(66.percent_height());
        let axes = [
            Axis::new("", from..to, 0),
            Axis::new("block", 0.0..BLOCKS as f64 + 1.0, 0),
        ];
        let mut panel = Panel::new(&upper, "(a)  slips", axes)?;
        let mut released = [None; BLOCKS];
        for event in motion.events() {
            let Some(block) = event.contact() else {
                continue;
            };
            let place = (block + 1) as f64;
            match event.kind {
                EventKind::Release(_) => released[block] = Some(event.time),
                EventKind::Stick => {
                    if let Some(time) = released[block].take() {
                        let slip = [(time, place), (event.time, place)];
                        panel.line(&slip, Stroke::solid(BLUE, 3.5))?;
                    }
                }
                _ => {}
            }
        }
        panel.finish()?;

        let axes = [
            Axis::new("time", from..to, 0),
            Axis::new("mean displacement", 0.0..1.0, 1).ticks(6),
        ];
        let mut panel = Panel::new(&lower, "(b)", axes)?;
        let mean: Vec<Point> = motion
            .sample(1601)
            .map(|(time, state)| {
                let sum: f64 = state.displacements.iter().sum();
                (time, sum / BLOCKS as f64)
            })
            .collect();
        panel.line(&mean, Stroke::solid(BLUE, 2.0))?;
        panel.finish()
    })
}

const COUPLING: &str = "Mode coupling in the brake model of Hoffmann et al. (2002): K = [[2, 1 − \
    4μ/3], [1, 2]], unit masses. (a) Frequencies of small motions about steady sliding. (b) Their \
    growth rates. Without damping two modes merge at μ = 3/4, and one of them grows; with the \
    dampers 0.1 and 0.05 they only come close, and growth begins at μ = 0.7575 (dashed).";

/// Normal stiffness of the model.
const NORMAL: f64 = 4.0 / 3.0;

/// The two eigenvalues with positive imaginary parts: (frequency, growth rate).
fn modes(coefficient: f64, damping: [f64; 2]) -> Result<[Point; 2]> {
    let sliding = Structure::new(&[1.0, 1.0])?
        .with_stiffness(DMatrix::from_row_slice(2, 2, &[2.0, 1.0, 1.0, 2.0]))?
        .with_ground_damper(0, damping[0])?
        .with_ground_damper(1, damping[1])?
        .with_contact(
            Contact::new(0, Coulomb::new(coefficient, coefficient)?, 10.0)?
                .with_load_gradient(1, NORMAL)?
                .on_belt(1.0),
        )?
        .steady_sliding()?;
    let mut modes: Vec<Point> = sliding
        .eigenvalues
        .iter()
        .filter(|value| value.im > 0.0)
        .map(|value| (value.im, value.re))
        .collect();
    modes.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    <[Point; 2]>::try_from(modes).map_err(|_| "two modes that oscillate".into())
}

pub(crate) fn mode_coupling() -> Result<Figure> {
    let model = |damping: [f64; 2]| ModeCoupling {
        masses: [1.0, 1.0],
        stiffness: [[2.0, 1.0], [1.0, 2.0]],
        normal_stiffness: NORMAL,
        damping,
    };
    let cases = [
        ([0.0, 0.0], Stroke::solid(BLUE, 2.5), "undamped"),
        ([0.1, 0.05], Stroke::solid(VERMILLION, 2.0), "damped"),
    ];
    svg((860, 400), COUPLING, |area| {
        let halves = area.split_evenly((1, 2));
        let panels = [
            ("(a)  frequencies", "angular frequency", 0.9..1.8, 0.45),
            ("(b)  growth rates", "growth rate", -0.3..0.3, 0.06),
        ];
        for (number, (half, (heading, title, range, down))) in halves.iter().zip(panels).enumerate()
        {
            let (low, high) = (range.start, range.end);
            let axes = [
                Axis::new("friction coefficient μ", 0.0..1.2, 1),
                Axis::new(title, range, 1),
            ];
            let mut panel = Panel::new(half, heading, axes)?;
            for (damping, stroke, _) in cases {
                let flutter = model(damping).flutter().ok_or("no flutter")?.coefficient;
                let border = Stroke::dashed(GREY, 1.0, [3, 3]);
                panel.line(&[(flutter, low), (flutter, high)], border)?;
                // Dense about the border, where undamped modes part like square roots.
                let mut lines: [Vec<Point>; 2] = [Vec::new(), Vec::new()];
                for i in -60..=60 {
                    let part = f64::from(i) / 60.0;
                    let width = if part < 0.0 {
                        flutter - 1e-3
                    } else {
                        1.2 - flutter
                    };
                    let coefficient = flutter + width * part * part.abs();
                    let modes = modes(coefficient, damping)?;
                    for (line, (frequency, growth)) in lines.iter_mut().zip(modes) {
                        line.push((coefficient, [frequency, growth][number]));
                    }
                }
                for line in &lines {
                    panel.line(line, stroke)?;
                }
            }
            panel.key((0.05, down), &cases.map(|(_, stroke, name)| (stroke, name)))?;
            panel.finish()?;
        }
        Ok(())
    })
}
