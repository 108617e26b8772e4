//! The balance of energy: what a motion gains is what friction and the damper do, integrated by a
//! quadrature of the law itself that knows nothing of the integrator.

use stick_slip::{AnyLaw, FrictionLaw, MassOnBelt, Mode, State, Step};

/// Work along a motion, and the rounding errors of such a sum.
pub(crate) struct Balance<'s> {
    system: &'s MassOnBelt<AnyLaw>,
    rule: &'s Rule,
    centre: f64,
    work: f64,
    rounding: f64,
    turnover: f64,
}

impl<'s> Balance<'s> {
    pub(crate) fn new(system: &'s MassOnBelt<AnyLaw>, rule: &'s Rule) -> Self {
        Self {
            system,
            rule,
            centre: system.equilibrium().map_or(0.0, |e| e.displacement),
            work: 0.0,
            rounding: 0.0,
            turnover: 0.0,
        }
    }

    /// Adds the first time h of a step, which ends at `last`.
    pub(crate) fn add(&mut self, step: &Step, h: f64, last: State) {
        let (system, v_b) = (self.system, self.system.belt_velocity());
        if step.mode() == Mode::Stick {
            let [from, to] = [step.state(), last].map(|state| state.displacement);
            // ∫(u + 2βv_b)v_b − 2βv_b² = ∫u du
            self.work += 0.5 * (to - from) * (to + from);
            self.rounding += from.powi(2).max(to.powi(2));
            return;
        }
        for (t, weight) in self.rule.over(h) {
            let state = step.state_at(t);
            let force = system.friction_force(state);
            let power = (force - 2.0 * system.damping() * state.velocity) * state.velocity;
            self.work += weight * power;
            self.turnover += weight * power.abs();
            // v − v_b is rounded like v and v_b, and friction changes with it.
            let slope = system.law().slope((state.velocity - v_b).abs());
            let blur = system.load() * slope.abs() * (state.velocity.abs() + v_b.abs());
            let forces = blur + state.displacement.abs() + force.abs();
            self.rounding += weight * forces * state.velocity.abs();
        }
        // Each step is good to a rounding of max(|u − ū|, |v|, |v_b|), or better.
        let State {
            displacement: u,
            velocity: v,
        } = last;
        let scale = (u - self.centre).abs().max(v.abs()).max(v_b.abs());
        self.rounding += (u.abs() + v.abs()) * scale;
    }

    /// The energy that is missing between these states, in roundings.
    pub(crate) fn defect(&self, start: State, last: State) -> f64 {
        let energy = |state: State| 0.5 * (state.displacement.powi(2) + state.velocity.powi(2));
        let defect = (energy(last) - energy(start) - self.work).abs();
        let rounding = self.rounding + self.turnover + energy(last) + energy(start);
        if defect == 0.0 {
            0.0
        } else {
            defect / (f64::EPSILON * rounding)
        }
    }
}

/// The rule of Gauss and Legendre with 16 points.
pub(crate) struct Rule([(f64, f64); 16]);

impl Rule {
    pub(crate) fn new() -> Self {
        let legendre = |x: f64| {
            let (mut p, mut last) = (x, 1.0);
            for k in 2..=16 {
                let k = f64::from(k);
                (p, last) = (((2.0 * k - 1.0) * x * p - (k - 1.0) * last) / k, p);
            }
            (p, 16.0 * (x * p - last) / (x * x - 1.0))
        };
        Self(std::array::from_fn(|i| {
            let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / 16.5).cos();
            for _ in 0..6 {
                let (p, slope) = legendre(x);
                x -= p / slope;
            }
            let slope = legendre(x).1;
            (0.5 + 0.5 * x, 1.0 / ((1.0 - x * x) * slope * slope))
        }))
    }

    /// Points and weights over [0, h].
    fn over(&self, h: f64) -> impl Iterator<Item = (f64, f64)> {
        self.0.iter().map(move |(x, weight)| (h * x, h * weight))
    }
}
