//! Systems, each with its exact motion at ε = 1, 1/2, 1/4, …

use crate::common::on_belt;
use std::cell::OnceCell;

use stick_slip::nalgebra::Complex;
use stick_slip::{CycleKind, LimitCycle, MassOnBelt, Polynomial, limit_cycle};

use crate::common::polynomials::{Polynomials, coefficients};

/// μ_s, μ_m, v_m, γ², β, v_b at ε = 1.
pub(crate) type Parameters = [f64; 6];

/// v_b0 < v_b < v_b1, v_b/v_b1 of 0.938 to 0.976; η of 0.66 to 1.13 at ε = 1.
#[rustfmt::skip]
pub(crate) const PURE_SLIP: [Parameters; 10] = [
    [0.40, 0.25, 0.50, 2.0, 0.10, 0.420],
    [0.40, 0.25, 0.50, 2.5, 0.02, 0.470],
    [0.50, 0.20, 0.80, 1.5, 0.12, 0.640],
    [0.30, 0.05, 0.60, 1.2, 0.05, 0.545],
    [0.60, 0.40, 1.00, 3.0, 0.20, 0.700],
    [0.35, 0.30, 0.20, 2.0, 0.03, 0.180],
    [0.80, 0.50, 0.40, 0.9, 0.25, 0.270],
    [0.45, 0.15, 1.50, 2.2, 0.04, 1.330],
    [0.25, 0.20, 0.30, 3.6, 0.15, 0.236],
    [0.70, 0.10, 0.90, 0.9, 0.08, 0.790],
];

/// v_b < v_b0 with a margin; η of 0.2 to 0.45 at ε = 1; the first is the paper's Fig. 5. μ_s and
/// μ_m are raised by 100, which leaves u − ū as it is but keeps the mass from overtaking the belt,
/// down to ε of 2⁻¹² or less.
///
/// The errors of `stick` and `slip` at second order are cε^{5/2} + c'ε³ + …, and c = 0 for some
/// v_b/v_m that depends on β/η. There the orders are better than stated: near v_b/v_m = 0.6, β/η =
/// 0.044, 3 is measured down to ε = 2⁻¹⁰. None of the systems lies near.
#[rustfmt::skip]
pub(crate) const STICK_SLIP: [Parameters; 10] = [
    [0.40, 0.25, 0.50, 1.0, 0.05, 0.20],
    [0.40, 0.25, 0.50, 0.7, 0.00, 0.22],
    [0.50, 0.20, 0.80, 0.6, 0.01, 0.25],
    [0.30, 0.05, 0.60, 0.4, 0.02, 0.28],
    [0.60, 0.40, 1.00, 1.0, 0.03, 0.40],
    [0.35, 0.30, 0.20, 0.8, 0.02, 0.06],
    [0.80, 0.50, 0.40, 0.2, 0.01, 0.10],
    [0.45, 0.15, 1.50, 1.0, 0.00, 0.70],
    [0.25, 0.20, 0.30, 1.5, 0.05, 0.10],
    [0.70, 0.10, 0.90, 0.3, 0.02, 0.40],
];

/// W1 > 0, and γ² below that at which the motion stops to stick.
#[rustfmt::skip]
pub(crate) const CROSSING: [Parameters; 10] = [
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
pub(crate) struct Point {
    pub(crate) system: MassOnBelt<Polynomial>,
    pub(crate) cycle: LimitCycle,
    pub(crate) rest: f64,
    pub(crate) noise: f64,
    harmonics: OnceCell<Vec<Complex<f64>>>,
}

impl Point {
    fn new(system: MassOnBelt<Polynomial>, cycle: LimitCycle) -> Self {
        let rest = system.equilibrium().unwrap().displacement;
        let size = (rest + cycle.max_velocity()) / system.belt_velocity();
        // The mass meets the belt at the rate v_b·(stick duration) in the weak limit, so that is
        // how well the time of contact is known.
        let rate = match cycle.stick_duration() {
            0.0 => 1.0,
            stick => stick.min(1.0),
        };
        Self {
            system,
            rest,
            noise: 4.0 * f64::EPSILON * (1.0 + size) / (1.0 - cycle.multiplier()) / rate,
            cycle,
            harmonics: OnceCell::new(),
        }
    }

    pub(crate) fn z_max(&self) -> f64 {
        self.cycle.max_displacement() - self.rest
    }

    pub(crate) fn z_min(&self) -> f64 {
        self.cycle.min_displacement() - self.rest
    }

    pub(crate) fn z_mean(&self) -> f64 {
        self.cycle.mean_displacement() - self.rest
    }

    pub(crate) fn slip(&self) -> f64 {
        self.cycle.period() - self.cycle.stick_duration()
    }

    pub(crate) fn harmonic(&self, k: usize) -> f64 {
        let harmonics = self.harmonics.get_or_init(|| self.cycle.harmonics(3));
        harmonics[k - 1].norm()
    }

    pub(crate) fn growth_rate(&self) -> f64 {
        self.cycle.multiplier().ln() / self.cycle.period()
    }

    /// (V − v_b)/v_b for the velocity maximum V that follows the release point, if friction had no
    /// jump at v_r = 0.
    pub(crate) fn growth(&self) -> f64 {
        let (system, v_b) = (&self.system, self.system.belt_velocity());
        // The polynomial law as a cubic of v_r on both sides of v_r = 0: on a belt that is faster.
        let shift = 8.0 * v_b;
        let law = Polynomials::without_jump(shift, &coefficients(system.law(), 0.0));
        let continued = on_belt(law, v_b + shift, system.damping(), system.load());
        let motion = continued.simulate(system.release_state().unwrap(), 8.0);
        let at = |time: f64| motion.as_ref().unwrap().state_at(time).unwrap();
        let (mut rising, mut falling) = (4.8, 8.0);
        for _ in 0..60 {
            let middle = 0.5 * (rising + falling);
            if continued.acceleration(at(middle)) > 0.0 {
                rising = middle;
            } else {
                falling = middle;
            }
        }
        at(rising).velocity / v_b - 1.0
    }
}

pub(crate) fn system(
    [mu_s, mu_m, v_m, load, damping, v_b]: Parameters,
    epsilon: f64,
) -> MassOnBelt<Polynomial> {
    on_belt(
        Polynomial::new(mu_s, mu_m, v_m).unwrap(),
        v_b,
        epsilon * damping,
        epsilon * load,
    )
}

/// ε = 1, 1/2, 1/4, …
pub(crate) fn halvings(count: usize) -> impl Iterator<Item = f64> {
    (0..count).scan(1.0, |epsilon, _| {
        Some(std::mem::replace(epsilon, 0.5 * *epsilon))
    })
}

/// A system at one ε, if its motion is of that kind.
pub(crate) fn at(parameters: Parameters, epsilon: f64, kind: CycleKind) -> Option<Point> {
    let system = system(parameters, epsilon);
    let mut cycles: Vec<_> = match kind {
        CycleKind::StickSlip => limit_cycle::stick_slip(&system)
            .unwrap()
            .into_iter()
            .collect(),
        _ => limit_cycle::find(&system)
            .unwrap()
            .stable()
            .cloned()
            .collect(),
    };
    let cycle = cycles.pop().filter(|cycle| cycle.kind() == kind)?;
    Some(Point::new(system, cycle))
}

/// Each system at ε = 1, 1/2, …, for as long as its motion is of that kind.
pub(crate) fn points(systems: &[Parameters], kind: CycleKind, count: usize) -> Vec<Vec<Point>> {
    let of = |parameters: &Parameters| {
        let along: Vec<_> = halvings(count)
            .map_while(|epsilon| at(*parameters, epsilon, kind))
            .collect();
        assert!(
            along.len() >= count.min(13),
            "{parameters:?}: {} points",
            along.len()
        );
        along
    };
    systems.iter().map(of).collect()
}

/// μ_s and μ_m larger by 100.
pub(crate) fn raised(systems: &[Parameters]) -> Vec<Parameters> {
    let raise = |&[mu_s, mu_m, v_m, load, damping, v_b]: &Parameters| {
        [mu_s + 100.0, mu_m + 100.0, v_m, load, damping, v_b]
    };
    systems.iter().map(raise).collect()
}
