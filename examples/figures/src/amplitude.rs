//! Amplitudes over the belt velocity: Fig. 6, and where steady sliding and stick-slip exist side by
//! side.

use std::ops::Range;

use stick_slip::analysis::{PureSlip, StickSlip};
use stick_slip::bifurcation::{self, diagram};
use stick_slip::{CycleKind, Error, Exponential, FrictionLaw, MassOnBelt, Polynomial};

use super::clip::Point;
use super::plot::{Axis, Panel};
use super::style::{BLACK, BLUE, GREEN, GREY, Stroke, VERMILLION};
use super::svg::{Area, Figure, Result, svg};

const BELT_VELOCITY: &str = "belt velocity v_b";
const AMPLITUDE: &str = "amplitude (u_{max} − u_{min})/2";
const BORDER: Stroke = Stroke::solid(GREY, 0.8);

const STICK_SLIP: Stroke = Stroke::solid(BLUE, 2.5);
const PURE_SLIP: Stroke = Stroke::solid(GREEN, 2.5);
const UNSTABLE_PURE_SLIP: Stroke = Stroke::dashed(GREEN, 2.5, [7, 5]);
const SLIDING: Stroke = Stroke::solid(BLACK, 2.5);
const UNSTABLE_SLIDING: Stroke = Stroke::dashed(BLACK, 2.5, [7, 5]);
const BY_PAPER: Stroke = Stroke::dashed(VERMILLION, 1.8, [5, 4]);
const CORRECTED: Stroke = Stroke::dashed(BLACK, 1.6, [2, 3]);

/// A periodic motion, or steady sliding with the amplitude 0, followed over the belt velocity.
struct Branch {
    kind: Option<CycleKind>,
    stable: bool,
    points: Vec<Point>,
}

impl Branch {
    fn stroke(&self) -> Stroke {
        match (self.kind, self.stable) {
            (None, true) => SLIDING,
            (None, false) => UNSTABLE_SLIDING,
            (Some(CycleKind::PureSlip), true) => PURE_SLIP,
            (Some(CycleKind::PureSlip), false) => UNSTABLE_PURE_SLIP,
            // A cycle that sticks is always stable.
            (Some(_), _) => STICK_SLIP,
        }
    }
}

/// All branches between neighbouring borders. Amplitudes change like square roots there, so the
/// belt velocities crowd at both ends.
fn branches<L: FrictionLaw>(
    system: &MassOnBelt<L>,
    borders: &[f64],
) -> std::result::Result<Vec<Branch>, Error> {
    const POINTS: u32 = 60;
    let mut branches: Vec<Branch> = Vec::new();
    for ends in borders.windows(2) {
        let velocities = (0..=POINTS).map(|i| {
            let angle = std::f64::consts::PI * f64::from(i) / f64::from(POINTS);
            let inside = 1e-6 + (1.0 - 2e-6) * 0.5 * (1.0 - angle.cos());
            ends[0] + (ends[1] - ends[0]) * inside
        });
        let first = branches.len();
        let mut add = |kind, stable, point| {
            let branch = branches[first..]
                .iter_mut()
                .find(|branch| branch.kind == kind && branch.stable == stable);
            match branch {
                Some(branch) => branch.points.push(point),
                None => branches.push(Branch {
                    kind,
                    stable,
                    points: vec![point],
                }),
            }
        };
        for found in diagram(system, velocities) {
            let found = found?;
            let v_b = found.belt_velocity;
            if let Some(equilibrium) = found.equilibrium {
                add(None, equilibrium.is_stable(), (v_b, 0.0));
            }
            for cycle in &found.cycles {
                let point = (v_b, cycle.amplitude());
                add(Some(cycle.kind()), cycle.is_stable(), point);
            }
        }
    }
    Ok(branches)
}

pub(crate) fn fig6() -> Result<Figure> {
    let law = Polynomial::new(0.4, 0.25, 0.5)?;
    let system = MassOnBelt::new(law, 0.2)?.with_damping(0.05)?;
    let hopf = bifurcation::hopf_velocities(&system, 0.0..0.5)?[0];
    let grazing = bifurcation::grazing_velocities(&system, 0.01..0.5)?[0];
    let by_averaging = PureSlip::new(&system)
        .and_then(|formulas| formulas.stick_velocity())
        .ok_or("steady sliding is always stable")?;
    let exact = branches(&system, &[0.0, grazing, hopf, 0.52])?;

    // Every formula where it claims to hold.
    let over = |range: [f64; 2], formula: &dyn Fn(&MassOnBelt<Polynomial>) -> Option<f64>| {
        // Densest at the end, where A0 falls to zero.
        let left = (0..=80).rev().map(|i| (f64::from(i) / 80.0).powi(2));
        let velocities = left.map(|left| range[1] - (range[1] - range[0]) * left);
        let systems = velocities.filter_map(|v_b| system.with_belt_velocity(v_b).ok());
        let points = systems.filter_map(|system| Some((system.belt_velocity(), formula(&system)?)));
        points.collect::<Vec<Point>>()
    };
    let stick_slip = [0.0, by_averaging];
    let pure_slip = [by_averaging, hopf];
    let formulas = [
        (
            BY_PAPER,
            over(stick_slip, &|s| Some(StickSlip::new(s)?.amplitude())),
        ),
        (
            BY_PAPER,
            over(pure_slip, &|s| PureSlip::new(s)?.amplitude()),
        ),
        (
            CORRECTED,
            over(stick_slip, &|s| {
                let cycle = StickSlip::new(s)?.second_order()?;
                Some(0.5 * (cycle.u_max - cycle.u_min))
            }),
        ),
        (
            CORRECTED,
            over(pure_slip, &|s| {
                Some(PureSlip::new(s)?.fourth_order()?.amplitude)
            }),
        ),
    ];

    let caption = format!(
        "Fig. 6. Amplitude over the belt velocity, polynomial law, γ² = 1, v_m = 0.5, μ_s = 0.4, \
         μ_m = 0.25, β = 0.05: exact motions and the formulas for them. Solid lines are stable, \
         dashed ones unstable. A_1, Eq. 18, leaves out the energy that slip gains. Stick-slip ends \
         at {grazing:.9}; averaging says v_b0 = {by_averaging:.9}, which the paper misprints as \
         √(4/3) v_b1. Steady sliding is stable from v_b1 = {hopf:.9} on."
    );
    svg((860, 430), &caption, |area| {
        let halves = area.split_evenly((1, 2));
        let whole = [
            ("v_{b0}", (by_averaging, 0.48), (-4.0, 0.0), GREY),
            ("v_{b1}", (hopf, 0.48), (4.0, 0.0), GREY),
            ("A_1", (0.25, 0.26), (5.0, 10.0), VERMILLION),
            ("steady sliding, unstable", (0.2, 0.0), (0.0, -13.0), BLACK),
            ("stable", (hopf, 0.0), (4.0, -13.0), BLACK),
        ];
        let transition = [
            ("v_{b0}", (by_averaging, 0.14), (-4.0, 0.0), GREY),
            ("grazing, exact", (grazing, 0.14), (4.0, 0.0), GREY),
            ("v_{b1}", (hopf, 0.48), (-4.0, 0.0), GREY),
            ("A_1", (0.39, 0.405), (0.0, -14.0), VERMILLION),
            ("A_0", (0.408, 0.34), (-8.0, 10.0), VERMILLION),
        ];
        let key = [
            (STICK_SLIP, "stick-slip, exact"),
            (PURE_SLIP, "pure slip, exact"),
            (BY_PAPER, "paper, Eqs. 15 and 18"),
            (CORRECTED, "corrected"),
        ];
        let views: [(_, _, &[_], &[_]); 2] = [
            ("(a)", 0.0..0.52, &whole, &key),
            ("(b)  the transition", 0.385..0.445, &transition, &[]),
        ];
        for (half, (heading, x, labels, key)) in halves.iter().zip(views) {
            let axes = [
                Axis::new(BELT_VELOCITY, x, if key.is_empty() { 2 } else { 1 }),
                Axis::new(AMPLITUDE, -0.02..0.5, 1),
            ];
            let mut panel = Panel::new(half, heading, axes)?;
            for border in [by_averaging, grazing, hopf] {
                panel.vertical(border, BORDER)?;
            }
            for branch in &exact {
                panel.line(&branch.points, branch.stroke())?;
            }
            for (stroke, points) in &formulas {
                panel.line(points, *stroke)?;
            }
            for (text, place, shift, colour) in labels {
                panel.label(text, *place, *shift, *colour)?;
            }
            panel.key((0.04, 0.05), key)?;
            panel.finish()?;
        }
        Ok(())
    })
}

pub(crate) fn bistability() -> Result<Figure> {
    svg((860, 430), BISTABILITY, |area| {
        let halves = area.split_evenly((1, 2));
        beside_sliding(&halves[0], "(a)  β = 0.05", 0.05, [0.0..1.4, -0.05..1.4])?;
        beside_sliding(&halves[1], "(b)  β = 0.14", 0.14, [0.54..0.63, -0.025..0.7])
    })
}

fn beside_sliding(
    area: &Area,
    heading: &str,
    damping: f64,
    [velocities, amplitudes]: [Range<f64>; 2],
) -> Result<()> {
    let law = Exponential::new(0.6, 0.3, 0.4)?;
    let system = MassOnBelt::new(law, 1.0)?.with_damping(damping)?;
    let hopf = bifurcation::hopf_velocities(&system, velocities.clone())?;
    let grazing = bifurcation::grazing_velocities(&system, velocities.clone())?;
    let folds = bifurcation::fold_velocities(&system, 0.5..velocities.end)?;
    let mut borders = [
        &hopf[..],
        &grazing,
        &folds,
        &[velocities.start, velocities.end],
    ]
    .concat();
    borders.sort_by(f64::total_cmp);

    let axes = [
        Axis::new(
            BELT_VELOCITY,
            velocities,
            if folds.is_empty() { 1 } else { 2 },
        ),
        Axis::new(AMPLITUDE, amplitudes, 1),
    ];
    let mut panel = Panel::new(area, heading, axes)?;
    for (name, found, side) in [
        ("Hopf", &hopf, -5.0),
        (
            "grazing",
            &grazing,
            if folds.is_empty() { -5.0 } else { 5.0 },
        ),
        ("fold", &folds, 5.0),
    ] {
        for &velocity in found {
            panel.vertical(velocity, BORDER)?;
        }
        if let Some(&last) = found.last() {
            panel.label(name, (last, 0.08), (side, 0.0), GREY)?;
        }
    }
    for branch in branches(&system, &borders)? {
        panel.line(&branch.points, branch.stroke())?;
    }
    // On a slow belt the two lie so close together that they look like one.
    if let ([first, _], [grazing, _]) = (&hopf[..], &grazing[..]) {
        let middle = 0.5 * (first + grazing);
        panel.label("Hopf, grazing", (middle, 0.75), (5.0, 0.0), GREY)?;
    }
    if folds.is_empty() {
        let rows = [
            (STICK_SLIP, "stick-slip"),
            (PURE_SLIP, "pure slip"),
            (UNSTABLE_PURE_SLIP, "pure slip, unstable"),
            (SLIDING, "steady sliding"),
            (UNSTABLE_SLIDING, "steady sliding, unstable"),
        ];
        panel.key((0.04, 0.05), &rows)?;
    }
    panel.finish()
}

const BISTABILITY: &str = "Amplitude over the belt velocity, exponential law, μ_s = 0.6, μ_k = \
    0.3, v_s = 0.4, γ² = 1. Right of the Hopf point steady sliding and a vibration are both \
    stable; an unstable cycle lies between them. (a) It ends where stick-slip does, by grazing, \
    far beyond the Hopf point. (b) With more damping stick-slip goes over into pure slip, which \
    ends in a fold. At the far left of (a), steady sliding is stable on a slow belt, too.";
