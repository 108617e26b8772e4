//! How wrong each formula is: its error over ε, for friction and damping that are both multiplied
//! by ε.

use plotters::style::RGBColor;
use stick_slip::analysis::{PureSlip, StickSlip};
use stick_slip::{LimitCycle, MassOnBelt, Polynomial, limit_cycle};

use super::clip::Point;
use super::plot::{Axis, Panel};
use super::style::{BLUE, Stroke, VERMILLION};
use super::svg::{Area, Figure, Result, svg};

const CAPTION: &str = "Error of each formula against the exact cycle, for γ² = ε and β = 0.05 ε; \
    polynomial law, v_m = 0.5. The slope of a line is the order of the error; the number at its \
    end is the slope between the last two dots, if it has settled. (a) Vibration that never \
    sticks, v_b = 0.42, μ_s = 0.4, μ_m = 0.25; errors as small as those of rounding are left out. \
    (b) Stick-slip, v_b = 0.2, μ_s = 100.4, μ_m = 100.25, so that the mass sticks where it meets \
    the belt, whatever ε is. The error of the corrected duration of stick changes its sign near ε \
    = 0.06, and its slope has not settled yet.";

/// The smallest ε is 2 to minus this power.
const HALVINGS: i32 = 10;
/// What rounding does to a motion in one period; on a cycle with the multiplier m it grows by 1/(1
/// − m).
const ROUNDING: f64 = 2e-15;
const BY_PAPER: RGBColor = VERMILLION;
const CORRECTED: RGBColor = BLUE;

type System = MassOnBelt<Polynomial>;

/// A name, where it stands beside the last dot, and what gives the value of the formula and the
/// exact value.
struct Formula {
    name: &'static str,
    shift: Point,
    colour: RGBColor,
    values: fn(&System, &LimitCycle) -> Option<[f64; 2]>,
}

const PURE_SLIP: [Formula; 5] = [
    Formula {
        name: "A_0 as u_{max} − ū",
        shift: (-8.0, 0.0),
        colour: BY_PAPER,
        values: |system, cycle| Some([PureSlip::new(system)?.amplitude()?, z_max(system, cycle)?]),
    },
    Formula {
        name: "A_0 as amplitude",
        shift: (-8.0, 0.0),
        colour: BY_PAPER,
        values: |system, cycle| Some([PureSlip::new(system)?.amplitude()?, cycle.amplitude()]),
    },
    Formula {
        name: "u_{max} − ū, 2nd order",
        shift: (-8.0, 0.0),
        colour: CORRECTED,
        values: |system, cycle| {
            let formula = PureSlip::new(system)?.second_order()?;
            Some([formula.z_max, z_max(system, cycle)?])
        },
    },
    Formula {
        name: "amplitude, 4th order",
        shift: (-4.0, 18.0),
        colour: CORRECTED,
        values: |system, cycle| {
            let formula = PureSlip::new(system)?.fourth_order()?;
            Some([formula.amplitude, cycle.amplitude()])
        },
    },
    Formula {
        name: "period, 4th order",
        shift: (-4.0, 16.0),
        colour: CORRECTED,
        values: |system, cycle| {
            let formula = PureSlip::new(system)?.fourth_order()?;
            Some([formula.period, cycle.period()])
        },
    },
];

const STICK_SLIP: [Formula; 6] = [
    Formula {
        name: "stick 2κ",
        shift: (-8.0, 0.0),
        colour: BY_PAPER,
        values: |system, cycle| {
            let formula = StickSlip::new(system)?;
            Some([formula.stick_duration(), cycle.stick_duration()])
        },
    },
    Formula {
        name: "period",
        shift: (-8.0, 0.0),
        colour: BY_PAPER,
        values: |system, cycle| Some([StickSlip::new(system)?.period(), cycle.period()]),
    },
    Formula {
        name: "A_1",
        shift: (-8.0, 0.0),
        colour: BY_PAPER,
        values: |system, cycle| Some([StickSlip::new(system)?.amplitude(), cycle.amplitude()]),
    },
    Formula {
        name: "stick, 2nd order",
        shift: (-8.0, 0.0),
        colour: CORRECTED,
        values: |system, cycle| {
            let formula = StickSlip::new(system)?.second_order()?;
            Some([formula.stick, cycle.stick_duration()])
        },
    },
    Formula {
        name: "amplitude, 1st order",
        shift: (-8.0, 0.0),
        colour: CORRECTED,
        values: |system, cycle| {
            let formula = StickSlip::new(system)?.first_order()?;
            Some([0.5 * (formula.u_max - formula.u_min), cycle.amplitude()])
        },
    },
    Formula {
        name: "amplitude, 2nd order",
        shift: (-8.0, 0.0),
        colour: CORRECTED,
        values: |system, cycle| {
            let formula = StickSlip::new(system)?.second_order()?;
            Some([0.5 * (formula.u_max - formula.u_min), cycle.amplitude()])
        },
    },
];

/// u_max − ū of the exact cycle.
fn z_max(system: &System, cycle: &LimitCycle) -> Option<f64> {
    Some(cycle.max_displacement() - system.equilibrium()?.displacement)
}

pub(crate) fn errors() -> Result<Figure> {
    svg((860, 480), CAPTION, |area| {
        let halves = area.split_evenly((1, 2));
        let law = Polynomial::new(0.4, 0.25, 0.5)?;
        panel(
            &halves[0],
            "(a)  pure slip; formula: slope",
            law,
            0.42,
            &PURE_SLIP,
            (0.04, 0.05),
        )?;
        let law = Polynomial::new(100.4, 100.25, 0.5)?;
        panel(
            &halves[1],
            "(b)  stick-slip; formula: slope",
            law,
            0.2,
            &STICK_SLIP,
            (0.04, 0.91),
        )
    })
}

fn panel(
    area: &Area,
    heading: &str,
    law: Polynomial,
    v_b: f64,
    formulas: &[Formula],
    key: Point,
) -> Result<()> {
    let mut cycles = Vec::new();
    for halving in 0..=HALVINGS {
        let epsilon = 0.5_f64.powi(halving);
        let system = MassOnBelt::new(law, v_b)?
            .with_damping(0.05 * epsilon)?
            .with_load(epsilon)?;
        let found = limit_cycle::find(&system)?;
        let cycle = found.stable().next().ok_or("no vibration")?.clone();
        cycles.push((epsilon, system, cycle));
    }
    let axes = [
        Axis::logarithmic("ε, share of friction and damping", -7.0..0.15),
        Axis::logarithmic("absolute error", -14.0..0.5).ticks(9),
    ];
    let mut panel = Panel::new(area, heading, axes)?;
    for formula in formulas {
        let points: Vec<Point> = cycles
            .iter()
            .filter_map(|(epsilon, system, cycle)| {
                let [value, exact] = (formula.values)(system, cycle)?;
                let error = (value - exact).abs();
                let floor = ROUNDING / (1.0 - cycle.multiplier());
                (error > floor).then(|| (epsilon.log10(), error.log10()))
            })
            .collect();
        panel.line(&points, Stroke::solid(formula.colour, 2.0))?;
        panel.dots(&points, 2.5, formula.colour)?;
        if let [.., (x1, y1), (x2, y2)] = points[..] {
            // Orders are multiples of 1/2.
            let slope = (y1 - y2) / (x1 - x2);
            let text = if (2.0 * slope - (2.0 * slope).round()).abs() < 0.05 {
                format!("{}: {slope:.2}", formula.name)
            } else {
                formula.name.to_string()
            };
            panel.label(&text, (x2, y2), formula.shift, formula.colour)?;
        }
    }
    let rows = [BY_PAPER, CORRECTED].map(|colour| Stroke::solid(colour, 2.0));
    panel.key(key, &[(rows[0], "of the paper"), (rows[1], "corrected")])?;
    panel.finish()
}
