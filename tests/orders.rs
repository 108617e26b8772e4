//! Orders of convergence: every formula of `analysis` against the exact motions, under (γ², β) → (εγ², εβ).

mod common;

use std::f64::consts::TAU;

use stick_slip::analysis::averaging::{self, AveragedCycle};
use stick_slip::analysis::{PureSlip, PureSlipCycle, StickSlip, StickSlipCycle};
use stick_slip::{CycleKind, FrictionLaw, LimitCycle, MassOnBelt, Polynomial, Scalar};
use stick_slip::{bifurcation, limit_cycle};

type System = MassOnBelt<Polynomial>;

/// μ_s, μ_m, v_m, γ², β, v_b at ε = 1.
type Parameters = [f64; 6];

fn system([mu_s, mu_m, v_m, load, damping, v_b]: Parameters, epsilon: f64) -> System {
    MassOnBelt::new(Polynomial::new(mu_s, mu_m, v_m).unwrap(), v_b)
        .and_then(|system| system.with_damping(epsilon * damping))
        .and_then(|system| system.with_load(epsilon * load))
        .unwrap()
}

/// ε = 1, 1/2, 1/4, …
fn halvings(count: i32) -> impl Iterator<Item = f64> {
    (0..count).map(|k| 0.5_f64.powi(k))
}

/// Pure slip: v_b0 < v_b < v_b1, η of 0.5 to 1.3 at ε = 1.
const PURE_SLIP: [Parameters; 10] = [
    [0.40, 0.25, 0.50, 2.0, 0.10, 0.420],
    [0.40, 0.25, 0.50, 2.5, 0.02, 0.470],
    [0.50, 0.20, 0.80, 1.5, 0.12, 0.640],
    [0.30, 0.05, 0.60, 1.2, 0.05, 0.545],
    [0.60, 0.40, 1.00, 3.0, 0.20, 0.700],
    [0.35, 0.30, 0.20, 2.0, 0.03, 0.180],
    [0.80, 0.50, 0.40, 0.7, 0.25, 0.240],
    [0.45, 0.15, 1.50, 2.2, 0.04, 1.330],
    [0.25, 0.20, 0.30, 3.0, 0.15, 0.205],
    [0.70, 0.10, 0.90, 0.9, 0.08, 0.790],
];

/// Stick-slip: v_b < v_b0 with a margin, η of 0.15 to 0.5 at ε = 1. μ_s and μ_m are raised by 100 later on.
const STICK_SLIP: [Parameters; 10] = [
    [0.40, 0.25, 0.50, 1.0, 0.05, 0.20],
    [0.40, 0.25, 0.50, 1.0, 0.02, 0.30],
    [0.50, 0.20, 0.80, 0.6, 0.01, 0.25],
    [0.30, 0.05, 0.60, 0.4, 0.02, 0.30],
    [0.60, 0.40, 1.00, 1.0, 0.03, 0.40],
    [0.35, 0.30, 0.20, 0.8, 0.03, 0.08],
    [0.80, 0.50, 0.40, 0.2, 0.01, 0.10],
    [0.45, 0.15, 1.50, 1.0, 0.00, 0.70],
    [0.25, 0.20, 0.30, 1.5, 0.05, 0.10],
    [0.70, 0.10, 0.90, 0.3, 0.02, 0.45],
];

/// Crossing cycles.
const CROSSING: [Parameters; 10] = [
    [0.30, 0.05, 0.80, 0.15, 0.003, 0.50],
    [0.30, 0.00, 0.80, 0.20, 0.002, 0.50],
    [0.20, 0.02, 0.60, 0.20, 0.004, 0.40],
    [0.40, 0.05, 0.50, 0.08, 0.001, 0.35],
    [0.25, 0.00, 1.00, 0.30, 0.000, 0.60],
    [0.50, 0.10, 0.70, 0.08, 0.002, 0.40],
    [0.15, 0.01, 0.40, 0.15, 0.005, 0.25],
    [0.35, 0.02, 1.20, 0.25, 0.001, 0.80],
    [0.60, 0.00, 0.90, 0.10, 0.003, 0.55],
    [0.10, 0.00, 0.30, 0.20, 0.006, 0.20],
];

/// A system, its exact motion, and how well that is known.
struct Point {
    system: System,
    cycle: LimitCycle,
    rest: f64,
    noise: f64,
}

impl Point {
    fn new(system: System, cycle: LimitCycle) -> Self {
        let rest = system.equilibrium().unwrap().displacement;
        let size = (rest.abs() + cycle.max_velocity()) / system.belt_velocity();
        let noise = 4.0 * f64::EPSILON * (1.0 + size) / (1.0 - cycle.multiplier());
        Self {
            system,
            cycle,
            rest,
            noise,
        }
    }
    fn z_max(&self) -> f64 {
        self.cycle.max_displacement() - self.rest
    }
    fn z_min(&self) -> f64 {
        self.cycle.min_displacement() - self.rest
    }
    fn slip(&self) -> f64 {
        self.cycle.period() - self.cycle.stick_duration()
    }
    fn harmonic(&self, k: usize) -> f64 {
        self.cycle.harmonics(3)[k - 1].norm()
    }
}

/// The points at ε = 1, 1/2, … for as long as the motion is of the kind.
fn points(parameters: Parameters, kind: CycleKind, count: i32) -> Vec<Point> {
    halvings(count)
        .map_while(|epsilon| {
            let system = system(parameters, epsilon);
            let cycle = if kind == CycleKind::StickSlip {
                limit_cycle::stick_slip(&system).unwrap()
            } else {
                limit_cycle::find(&system).unwrap().stable().next().cloned()
            };
            let cycle = cycle.filter(|cycle| cycle.kind() == kind)?;
            Some(Point::new(system, cycle))
        })
        .collect()
}

/// Order of the errors at ε = 1, 1/2, …, given with their noise. The last two local exponents that noise does not spoil, extrapolated to ε =
/// 0 in powers of ε^step.
fn order(errors: impl Iterator<Item = (f64, f64)>, step: f64) -> f64 {
    let clear: Vec<f64> = errors
        .take_while(|(error, noise)| error.abs() > 1e3 * noise)
        .map(|(error, _)| error.abs())
        .collect();
    let exponents: Vec<f64> = clear.windows(2).map(|e| (e[0] / e[1]).log2()).collect();
    if std::env::var("ORDERS").is_ok() {
        println!("{clear:.2?} {exponents:.3?}");
    }
    match exponents[..] {
        [.., a, b] => b + (b - a) / (step.exp2() - 1.0),
        _ => f64::NAN,
    }
}

/// What was measured, and whether it is what is stated.
#[derive(Default)]
struct Report {
    text: String,
    failed: bool,
}

impl Report {
    fn row(&mut self, name: &str, stated: f64, measured: &[f64]) {
        let spread = |f: fn(f64, f64) -> f64, start| measured.iter().copied().fold(start, f);
        let wrong: Vec<_> = measured
            .iter()
            .enumerate()
            .filter(|(_, p)| ((*p - stated).abs() > 0.1) || p.is_nan())
            .collect();
        self.failed |= !wrong.is_empty();
        self.text += &format!(
            "{name:<44} {stated:4} {:7.3} {:7.3}  {}\n",
            spread(f64::min, f64::INFINITY),
            spread(f64::max, f64::NEG_INFINITY),
            if wrong.is_empty() {
                String::new()
            } else {
                format!("WRONG: {wrong:.3?}")
            }
        );
    }
    fn finish(self) {
        println!("{}", self.text);
        assert!(!self.failed, "\n{}", self.text);
    }
}

fn rows(
    report: &mut Report,
    systems: &[Vec<Point>],
    name: &str,
    stated: f64,
    step: f64,
    formula: impl Fn(&Point) -> f64,
    exact: impl Fn(&Point) -> f64,
) {
    if std::env::var("ORDERS").is_ok() {
        println!("{name}");
    }
    let measured: Vec<f64> = systems
        .iter()
        .map(|points| {
            order(
                points
                    .iter()
                    .map(|point| (formula(point) - exact(point), point.noise)),
                step,
            )
        })
        .collect();
    report.row(name, stated, &measured);
}

type Exact = fn(&Point) -> f64;

#[test]
fn pure_slip_formulas() {
    type Field = fn(&PureSlipCycle) -> f64;
    /// Quantity, formula, exact value, orders of the error of first to fourth order.
    const TABLE: &[(&str, Field, Exact, [f64; 4])] = &[
        ("z_max", |f| f.z_max, Point::z_max, [2., 3., 4., 4.]),
        ("z_min", |f| f.z_min, Point::z_min, [2., 3., 4., 4.]),
        (
            "u_max",
            |f| f.u_max,
            |x| x.cycle.max_displacement(),
            [2., 3., 4., 4.],
        ),
        (
            "u_min",
            |f| f.u_min,
            |x| x.cycle.min_displacement(),
            [2., 3., 4., 4.],
        ),
        (
            "amplitude",
            |f| f.amplitude,
            |x| x.cycle.amplitude(),
            [2., 4., 4., 4.],
        ),
        (
            "v_max",
            |f| f.v_max,
            |x| x.cycle.max_velocity(),
            [2., 4., 4., 4.],
        ),
        (
            "v_min",
            |f| f.v_min,
            |x| x.cycle.min_velocity(),
            [2., 4., 4., 4.],
        ),
        (
            "middle",
            |f| 0.5 * (f.z_max + f.z_min),
            |x| 0.5 * (x.z_max() + x.z_min()),
            [3., 3., 5., 5.],
        ),
        (
            "z_mean",
            |f| f.z_mean,
            |x| x.cycle.mean_displacement() - x.rest,
            [3., 3., 5., 5.],
        ),
        (
            "u_mean",
            |f| f.u_mean,
            |x| x.cycle.mean_displacement(),
            [3., 3., 5., 5.],
        ),
        (
            "frequency",
            |f| f.frequency,
            |x| TAU / x.cycle.period(),
            [2., 4., 4., 6.],
        ),
        (
            "period",
            |f| f.period,
            |x| x.cycle.period(),
            [2., 4., 4., 6.],
        ),
        (
            "log_multiplier",
            |f| f.log_multiplier,
            |x| x.cycle.multiplier().ln(),
            [3., 3., 5., 5.],
        ),
        (
            "multiplier",
            |f| f.multiplier,
            |x| x.cycle.multiplier(),
            [3., 3., 5., 5.],
        ),
        (
            "first harmonic",
            |f| f.harmonics[0],
            |x| x.harmonic(1),
            [2., 4., 4., 4.],
        ),
        (
            "second harmonic",
            |f| f.harmonics[1],
            |x| x.harmonic(2),
            [3., 3., 3., 3.],
        ),
        (
            "third harmonic",
            |f| f.harmonics[2],
            |x| x.harmonic(3),
            [3., 3., 3., 3.],
        ),
    ];
    let systems: Vec<_> = PURE_SLIP
        .iter()
        .map(|p| points(*p, CycleKind::PureSlip, 12))
        .collect();
    println!("{:?}", systems.iter().map(|s| s.len()).collect::<Vec<_>>());
    let mut report = Report::default();
    for (name, field, exact, orders) in TABLE {
        for (k, stated) in orders.iter().enumerate() {
            let formula = |point: &Point| {
                let formulas = PureSlip::new(&point.system).unwrap();
                let cycles = [
                    formulas.first_order(),
                    formulas.second_order(),
                    formulas.third_order(),
                    formulas.fourth_order(),
                ];
                field(&cycles[k].unwrap())
            };
            rows(
                &mut report,
                &systems,
                &format!("{name}, through ε^{}", k + 1),
                *stated,
                1.0,
                formula,
                exact,
            );
        }
    }
    report.finish();
}

/// Polynomial law continued beyond the belt velocity: a cubic of v_r for v_r < 0 and v_r > 0 alike, as the expansions take it.
struct Continued {
    law: Polynomial,
    shift: f64,
}

impl FrictionLaw for Continued {
    fn static_coefficient(&self) -> f64 {
        self.kinetic(0.0)
    }
    fn kinetic<S: Scalar>(&self, speed: S) -> S {
        self.law.kinetic(speed - self.shift)
    }
}

/// Growth of the velocity's maximum from v_b to the next, (v − v_b)/v_b, if friction had no jump at v_r = 0.
fn growth(point: &Point) -> f64 {
    let (system, v_b) = (&point.system, point.system.belt_velocity());
    let shift = 8.0 * v_b;
    let law = Continued {
        law: *system.law(),
        shift,
    };
    let continued = MassOnBelt::new(law, v_b + shift)
        .and_then(|continued| continued.with_damping(system.damping()))
        .and_then(|continued| continued.with_load(system.load()))
        .unwrap();
    let motion = continued
        .simulate(system.release_state().unwrap(), 8.0)
        .unwrap();
    let (mut low, mut high) = (4.8, 8.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        let state = motion.state_at(middle).unwrap();
        *(if continued.acceleration(state) > 0.0 {
            &mut low
        } else {
            &mut high
        }) = middle;
    }
    motion.state_at(low).unwrap().velocity / v_b - 1.0
}

#[test]
fn stick_slip_formulas() {
    type Paper = fn(&StickSlip<Polynomial>) -> f64;
    const PAPER: &[(&str, Paper, Exact, f64, f64)] = &[
        (
            "A1 (Eq. 18) as z_max",
            |f| f.amplitude(),
            Point::z_max,
            1.0,
            1.0,
        ),
        ("A1 as −z_min", |f| -f.amplitude(), Point::z_min, 1.0, 1.0),
        (
            "A1 as half the range of u",
            |f| f.amplitude(),
            |x| x.cycle.amplitude(),
            1.0,
            1.0,
        ),
        (
            "velocity amplitude",
            |f| -f.velocity_amplitude(),
            |x| x.cycle.min_velocity(),
            1.0,
            1.0,
        ),
        (
            "stick 2κ",
            |f| f.stick_duration(),
            |x| x.cycle.stick_duration(),
            0.5,
            0.5,
        ),
        (
            "slip 2π − 2 atan κ",
            |f| f.slip_duration(),
            Point::slip,
            0.5,
            0.5,
        ),
        (
            "T of Eqs. 16-18",
            |f| f.period(),
            |x| x.cycle.period(),
            1.5,
            0.5,
        ),
        (
            "ω_ss",
            |f| f.frequency(),
            |x| TAU / x.cycle.period(),
            1.5,
            0.5,
        ),
        ("2π as T", |_| TAU, |x| x.cycle.period(), 1.5, 0.5),
    ];
    type Field = fn(&StickSlipCycle) -> f64;
    const TABLE: &[(&str, Field, Exact, [f64; 2], f64)] = &[
        ("z_max", |f| f.z_max, Point::z_max, [2., 3.], 1.0),
        ("z_min", |f| f.z_min, Point::z_min, [2., 3.], 1.0),
        (
            "u_max",
            |f| f.u_max,
            |x| x.cycle.max_displacement(),
            [2., 3.],
            1.0,
        ),
        (
            "u_min",
            |f| f.u_min,
            |x| x.cycle.min_displacement(),
            [2., 3.],
            1.0,
        ),
        (
            "v_min",
            |f| f.v_min,
            |x| x.cycle.min_velocity(),
            [2., 3.],
            1.0,
        ),
        ("growth", |f| f.growth, growth, [2., 3.], 1.0),
        (
            "return_angle",
            |f| f.return_angle,
            |x| x.cycle.stick_duration().atan(),
            [1.5, 2.],
            0.5,
        ),
        (
            "stick",
            |f| f.stick,
            |x| x.cycle.stick_duration(),
            [1.5, 2.5],
            0.5,
        ),
        ("slip", |f| f.slip, Point::slip, [1.5, 2.5], 0.5),
        ("period", |f| f.period, |x| x.cycle.period(), [2., 3.], 0.5),
    ];
    let raised = |[mu_s, mu_m, v_m, load, damping, v_b]: Parameters| {
        [mu_s + 100.0, mu_m + 100.0, v_m, load, damping, v_b]
    };
    let systems: Vec<_> = STICK_SLIP
        .iter()
        .map(|p| points(raised(*p), CycleKind::StickSlip, 30))
        .collect();
    println!("{:?}", systems.iter().map(|s| s.len()).collect::<Vec<_>>());
    let mut report = Report::default();
    for (name, paper, exact, stated, step) in PAPER {
        let formula = |point: &Point| paper(&StickSlip::new(&point.system).unwrap());
        rows(&mut report, &systems, name, *stated, *step, formula, exact);
    }
    for (name, field, exact, orders, step) in TABLE {
        for (k, stated) in orders.iter().enumerate() {
            let formula = |point: &Point| {
                let formulas = StickSlip::new(&point.system).unwrap();
                let cycles = [formulas.first_order(), formulas.second_order()];
                cycles[k].map_or(f64::NAN, |c| field(&c))
            };
            rows(
                &mut report,
                &systems,
                &format!("{name}, through ε^{}", k + 1),
                *stated,
                *step,
                formula,
                exact,
            );
        }
    }
    report.finish();
}

#[test]
fn averaged_crossing_cycles() {
    const TABLE: &[(&str, fn(&AveragedCycle) -> f64, Exact, f64)] = &[
        ("amplitude", |f| f.amplitude(), |x| x.cycle.amplitude(), 2.0),
        ("v_max", |f| f.amplitude(), |x| x.cycle.max_velocity(), 2.0),
        ("v_min", |f| -f.amplitude(), |x| x.cycle.min_velocity(), 2.0),
        ("z_max", |f| f.amplitude(), Point::z_max, 1.0),
        ("z_min", |f| -f.amplitude(), Point::z_min, 1.0),
        ("T = 2π", |_| TAU, |x| x.cycle.period(), 2.0),
        (
            "leading_duration",
            |f| f.leading_duration(),
            |x| x.cycle.leading_duration(),
            2.0,
        ),
        (
            "multiplier",
            |f| f.multiplier(),
            |x| x.cycle.multiplier(),
            3.0,
        ),
        (
            "drift_slope",
            |f| f.drift_slope(),
            |x| x.cycle.multiplier().ln() / x.cycle.period(),
            3.0,
        ),
    ];
    let systems: Vec<_> = CROSSING
        .iter()
        .map(|p| points(*p, CycleKind::Crossing, 16))
        .collect();
    println!("{:?}", systems.iter().map(|s| s.len()).collect::<Vec<_>>());
    let mut report = Report::default();
    for (name, field, exact, stated) in TABLE {
        let formula =
            |point: &Point| field(averaging::cycles(&point.system).unwrap().last().unwrap());
        rows(&mut report, &systems, name, *stated, 1.0, formula, exact);
    }
    report.finish();
}

#[test]
fn grazing_velocities() {
    let mut report = Report::default();
    let table: [(&str, fn(&PureSlip) -> f64, f64); 2] = [
        ("v_b0", |f| f.stick_velocity().unwrap(), 2.0),
        ("grazing velocity", |f| f.grazing_velocity().unwrap(), 4.0),
    ];
    for (name, formula, stated) in table {
        let measured: Vec<f64> = PURE_SLIP
            .iter()
            .map(|p| {
                let errors = halvings(8).map(|epsilon| {
                    let system = system(*p, epsilon);
                    let formulas = PureSlip::new(&system).unwrap();
                    let onset = formulas.onset_velocity().unwrap();
                    let exact =
                        bifurcation::grazing_velocities(&system, 0.85 * onset..onset).unwrap();
                    assert_eq!(exact.len(), 1, "{p:?} {epsilon} {exact:?}");
                    (formula(&formulas) / exact[0] - 1.0, 1e-15 / epsilon)
                });
                order(errors, 1.0)
            })
            .collect();
        report.row(name, stated, &measured);
    }
    report.finish();
}
