//! Orders of convergence: every formula of `analysis` against the exact motions, under (γ², β) →
//! (εγ², εβ).
//!
//! Halve ε and watch the error fall by 2^p. `cargo test --test analysis orders --
//! --nocapture` prints what was measured.

pub(crate) mod points;
pub(crate) mod tables;

use std::f64::consts::TAU;

use crate::common::Random;
use crate::common::larger;
use points::{
    CROSSING, PURE_SLIP, Parameters, Point, STICK_SLIP, halvings, points, raised, system,
};
use stick_slip::analysis::{PureSlip, StickSlip, averaging};
use stick_slip::{CycleKind, State, bifurcation};
use tables::{AVERAGED_CROSSING, Errors, Series, averaged_rows, pure_slip_rows, stick_slip_rows};

/// The order of errors at ε = 1, 1/2, …: the local exponents log2(e(ε)/e(ε/2)) where the error is
/// 10³ times its noise or more, the last two extrapolated to ε = 0, from which they differ by cε
/// or, where the series has half powers, by c√ε. (Not extrapolated, that of `stick` at second order
/// has risen to 2.46 only at ε = 2⁻¹².)
fn order(errors: &[(f64, f64)], series: Series) -> f64 {
    let clear: Vec<f64> = errors
        .iter()
        .take_while(|(error, noise)| *error > 1e3 * noise)
        .map(|(error, _)| *error)
        .collect();
    let exponents: Vec<f64> = clear.windows(2).map(|e| (e[0] / e[1]).log2()).collect();
    let ratio: f64 = match series {
        Series::Whole => 2.0,
        Series::Halves => 2.0_f64.sqrt(),
    };
    match exponents[..] {
        [.., a, b] => b + (b - a) / (ratio - 1.0),
        _ => f64::NAN,
    }
}

/// What was measured in one test.
#[derive(Default)]
struct Report {
    text: String,
    wrong: usize,
}

impl Report {
    fn orders(&mut self, name: &str, stated: f64, series: Series, errors: &Errors) {
        let measured: Vec<f64> = errors.iter().map(|errors| order(errors, series)).collect();
        let fits = measured.iter().all(|p| (p - stated).abs() <= 0.1);
        self.row(name, stated, fits, format_args!("{measured:7.3?}"));
    }

    /// e ≤ factor·K·ε^p for all systems and all ε, where K is the largest e/ε^p of all systems at
    /// the smallest ε that is clear of noise.
    fn bounds(&mut self, name: &str, stated: f64, factor: f64, errors: &Errors) {
        let ratios = errors.iter().map(|errors| {
            let clear = errors
                .iter()
                .zip(halvings(64))
                .take_while(|((error, noise), _)| error > &(1e2 * noise));
            clear
                .map(|((error, _), epsilon)| error / epsilon.powf(stated))
                .collect::<Vec<_>>()
        });
        let ratios: Vec<_> = ratios.collect();
        let constant = ratios
            .iter()
            .filter_map(|r| r.last())
            .copied()
            .fold(0.0, f64::max);
        let worst = ratios.iter().flatten().copied().fold(0.0, larger);
        self.row(
            name,
            stated,
            constant > 0.0 && worst <= factor * constant,
            format_args!("{:8.3}", worst / constant),
        );
    }

    fn row(&mut self, name: &str, stated: f64, fits: bool, measured: std::fmt::Arguments<'_>) {
        let verdict = if fits { "" } else { "  WRONG" };
        self.text += &format!("{name:<32} {stated:4}  {measured}{verdict}\n");
        self.wrong += usize::from(!fits);
    }

    fn finish(self) {
        println!("{}", self.text);
        assert_eq!(self.wrong, 0, "\n{}", self.text);
    }
}

#[test]
fn orders_of_pure_slip_formulas() {
    let mut report = Report::default();
    let systems = points(&PURE_SLIP, CycleKind::PureSlip, 12);
    pure_slip_rows(&systems, |name, stated, series, errors| {
        report.orders(name, stated, series, errors);
    });
    report.finish();
}

#[test]
fn orders_of_stick_slip_formulas() {
    let mut report = Report::default();
    let systems = points(&raised(&STICK_SLIP), CycleKind::StickSlip, 24);
    stick_slip_rows(&systems, |name, stated, series, errors| {
        report.orders(name, stated, series, errors);
    });
    let v_max = |point: &Point| {
        StickSlip::new(&point.system)
            .unwrap()
            .first_order()
            .unwrap()
            .v_max
    };
    assert!(
        systems
            .iter()
            .flatten()
            .all(|point| v_max(point) == point.cycle.max_velocity())
    );
    report.finish();
}

#[test]
fn orders_of_averaged_crossing_cycles() {
    let mut report = Report::default();
    let systems = points(&CROSSING, CycleKind::Crossing, 13);
    averaged_rows(
        &systems,
        AVERAGED_CROSSING,
        |name, stated, series, errors| {
            report.orders(name, stated, series, errors);
        },
    );
    report.finish();
}

#[test]
fn orders_of_grazing_velocities() {
    type Formula = fn(&PureSlip) -> Option<f64>;
    const TABLE: [(&str, Formula, f64); 2] = [
        ("v_b0", PureSlip::stick_velocity, 2.0),
        ("grazing_velocity", PureSlip::grazing_velocity, 4.0),
    ];
    let mut report = Report::default();
    for (name, formula, stated) in TABLE {
        let along = |parameters: &Parameters| {
            let error = |epsilon| {
                let system = system(*parameters, epsilon);
                let formulas = PureSlip::new(&system).unwrap();
                let onset = formulas.onset_velocity().unwrap();
                let exact = bifurcation::grazing_velocities(&system, 0.85 * onset..onset).unwrap();
                assert_eq!(exact.len(), 1, "{parameters:?}, ε = {epsilon}: {exact:?}");
                (
                    (formula(&formulas).unwrap() / exact[0] - 1.0).abs(),
                    4.0 * f64::EPSILON / epsilon,
                )
            };
            halvings(8).map(error).collect()
        };
        let errors: Vec<_> = PURE_SLIP.iter().map(along).collect();
        report.orders(name, stated, Series::Whole, &errors);
    }
    report.finish();
}

/// Amplitude and phase of Eq. 12 after a time of 2π/ε: O(ε), in both components of the state.
#[test]
fn orders_of_the_slow_transient() {
    let along = |parameters: &Parameters| {
        let error = |epsilon: f64| {
            let system = system(*parameters, epsilon);
            let formulas = PureSlip::new(&system).unwrap();
            let transient = formulas
                .transient(0.5 * formulas.amplitude().unwrap(), 0.7)
                .unwrap();
            let exact = system
                .simulate(transient.state(0.0).unwrap(), TAU / epsilon)
                .unwrap()
                .last();
            let State {
                displacement,
                velocity,
            } = transient.state(TAU / epsilon).unwrap();
            (
                (displacement - exact.displacement).hypot(velocity - exact.velocity),
                1e-13,
            )
        };
        halvings(9).map(error).collect()
    };
    let errors: Vec<_> = PURE_SLIP.iter().map(along).collect();
    let mut report = Report::default();
    report.orders("transient after τ = 2π/ε", 1.0, Series::Whole, &errors);
    report.finish();
}

/// 24 random systems with η(ε = 1) given, 2β/η < 0.6, and v_b/v_b1 in a range.
fn random_systems(seed: u64, eta: f64, ratio: [f64; 2]) -> Vec<Parameters> {
    let mut random = Random::new(seed);
    let mut system = || {
        let (mu_s, v_m) = (random.uniform(0.2, 0.9), random.uniform(0.3, 1.5));
        let mu_m = mu_s * random.uniform(0.0, 0.9);
        let excess = random.uniform(0.4, 1.0);
        let v_b = v_m * excess.sqrt() * random.uniform(ratio[0], ratio[1]);
        [
            mu_s,
            mu_m,
            v_m,
            eta * v_m / (1.5 * (mu_s - mu_m)),
            0.5 * eta * (1.0 - excess),
            v_b,
        ]
    };
    (0..24).map(|_| system()).collect()
}

/// 12 random systems at half the γ² and β at which, by averaging, the motion begins to stick: A sin
/// s = 2γ²μ_s.
fn random_crossing_systems(seed: u64) -> Vec<Parameters> {
    let mut random = Random::new(seed);
    let mut system = || {
        let (mu_s, v_m) = (random.uniform(0.1, 0.6), random.uniform(0.3, 1.2));
        let mu_m = mu_s * random.uniform(0.0, 0.2);
        let v_b = v_m * random.uniform(0.5, 0.75);
        let damping = 0.1 * (mu_s - mu_m) / v_m * random.uniform(0.0, 1.0);
        let parameters = [mu_s, mu_m, v_m, 1.0, damping, v_b];
        let averaged = averaging::cycles(&points::system(parameters, 1.0))
            .unwrap()
            .pop()
            .unwrap();
        let load = averaged.amplitude() * (0.5 * averaged.leading_duration()).sin() / (4.0 * mu_s);
        [mu_s, mu_m, v_m, load, load * damping, v_b]
    };
    (0..12).map(|_| system()).collect()
}

#[test]
fn errors_of_random_systems_are_bounded() {
    let mut report = Report::default();
    let systems = points(
        &random_systems(1, 0.6, [0.925, 0.985]),
        CycleKind::PureSlip,
        8,
    );
    pure_slip_rows(&systems, |name, stated, _, errors| {
        report.bounds(name, stated, 2.0, errors);
    });
    let systems = points(
        &raised(&random_systems(2, 0.3, [0.2, 0.7])),
        CycleKind::StickSlip,
        13,
    );
    stick_slip_rows(&systems, |name, stated, _, errors| {
        report.bounds(name, stated, 2.0, errors);
    });
    let systems = points(&random_crossing_systems(3), CycleKind::Crossing, 8);
    averaged_rows(&systems, AVERAGED_CROSSING, |name, stated, _, errors| {
        report.bounds(name, stated, 2.0, errors);
    });
    report.finish();
}
