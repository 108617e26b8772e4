//! The transition between explicit steps and steps on the slow manifold, in both directions of
//! time.
//!
//! The residual of the equation of motion, divided by the rate at which a deviation decays, bounds
//! the error of a motion that approaches a slow manifold. So no other method is needed.

use super::*;
use crate::belt::MassOnBelt;
use crate::friction::{Exponential, FrictionLaw, Polynomial, Stribeck, Tabulated};
use crate::numerics::testing::count;
use crate::state::Direction;

/// Statistics of the steps of some motions.
#[derive(Debug, Default)]
struct Seen {
    /// Number of steps by their length in units of 1/|D|: up to 8, 14, 40, 100 and beyond.
    lengths: [usize; 5],
    /// Largest change of the speed by a step, at its start and by its defect, in units of the
    /// error: the tolerance, or the shift of the slow manifold by rounding of the forces.
    jump: f64,
    defect: f64,
}

impl Seen {
    /// Follows a motion while it approaches a slow manifold.
    fn follow<L: FrictionLaw>(
        &mut self,
        system: &MassOnBelt<L>,
        start: SlipPoint,
        time: Time,
        most: usize,
    ) {
        let system = system.belt();
        let mut stepper = Stepper::new(&system, 2.0 * f64::EPSILON);
        let (sign, sigma) = (time.sign(), start.direction.sign());
        let (damping, load, v_b) = (
            2.0 * system.damping(),
            system.load(),
            system.belt_velocity(),
        );
        let (mut point, mut elapsed) = (start, 0.0);
        for _ in 0..most {
            let Ok(advance) = stepper.advance(&system, &point, time, elapsed) else {
                panic!("{start:?}");
            };
            let (h, end, speed) = (advance.duration, advance.end, *stepper.speed());
            if advance.is_contact() || !h.is_finite() {
                return;
            }
            let decay = |s: f64| sign * system.effective_damping(s);
            let closing = decay(point.speed).min(decay(end.speed));
            if closing > STIFF {
                let bin = [8.0, 14.0, 40.0, 100.0].partition_point(|l| *l < h * closing);
                self.lengths[bin] += 1;
                let v = v_b + sigma * point.speed;
                let forces = (point.displacement.abs() + damping * v.abs())
                    + load * system.law().kinetic(point.speed);
                let does = (speed[1] / closing).abs().max(v.abs()).max(v_b.abs());
                let error = f64::EPSILON * (2.0 * does).max(forces / closing);
                let jump = (speed[0] - point.speed).abs();
                self.jump = self.jump.max(jump / error.max(f64::EPSILON * point.speed));
                let rate = speed.derivative();
                for k in 1..32 {
                    let t = h * f64::from(k) / 32.0;
                    let s = speed.at(t);
                    let u = point.displacement + sign * (v_b + sigma * speed.mean(t)) * t;
                    let friction = load * system.law().kinetic(s);
                    let terms = [sigma * u, damping * (s + sigma * v_b), friction];
                    let missing = sign * rate.at(t) + terms.iter().sum::<f64>();
                    let rounding =
                        8.0 * f64::EPSILON * terms.iter().fold(0.0, |m: f64, t| m.max(t.abs()));
                    let shift = (missing.abs() - rounding).max(0.0) / decay(s).max(1.0 / h);
                    self.defect = self.defect.max(shift / error);
                }
            }
            (point, elapsed) = (end, elapsed + h);
        }
    }

    #[track_caller]
    fn assert_exact(&self) {
        assert!(self.jump <= 8.0, "{self:?}");
        assert!(self.defect <= 32.0, "{self:?}");
    }
}

fn at_force_balance<L: FrictionLaw>(system: &MassOnBelt<L>, speed: f64) -> SlipPoint {
    let velocity = system.belt_velocity() - speed;
    let friction = system.load() * system.law().kinetic(speed);
    SlipPoint {
        direction: Direction::Lagging,
        displacement: friction - 2.0 * system.damping() * velocity,
        speed,
        rate: None,
    }
}

/// Friction that rises with the speed, D from 4 to 4000 and R by the speed at the start: steps of
/// all lengths in units of 1/D, below, at and beyond the transition.
#[test]
fn explicit_and_slow_steps_meet_without_a_gap() {
    let mut seen = Seen::default();
    let loads = count(10, 60);
    for i in 0..loads {
        for beyond in [1.5, 3.0, 10.0, 100.0] {
            let v_m = 1e-2;
            let load = 0.01 * (10.0 * i as f64 / loads as f64).exp2();
            let law = Polynomial::new(0.4, 0.2, v_m).unwrap();
            let system = MassOnBelt::new(law, beyond * v_m)
                .and_then(|system| system.with_damping(0.05)?.with_load(load))
                .unwrap();
            for speed in [1.2, 1.6, 4.0] {
                let start = at_force_balance(&system, speed * v_m);
                seen.follow(&system, start, Time::Forward, 60);
            }
        }
    }
    println!("{seen:?}");
    seen.assert_exact();
    assert!(seen.lengths.iter().all(|n| *n >= 50), "{seen:?}");
}

/// Friction that falls with the speed: backwards in time the slow manifold attracts.
#[test]
fn explicit_and_slow_steps_meet_backwards_too() {
    let mut seen = Seen::default();
    let loads = count(15, 60);
    for i in 0..loads {
        for v_b in [0.01, 0.1, 1.0] {
            let load = 0.3 * (10.0 * i as f64 / loads as f64).exp2();
            let law = Exponential::new(0.4, 0.2, 0.1).unwrap();
            let exponential = MassOnBelt::new(law, v_b)
                .and_then(|system| system.with_damping(0.05)?.with_load(load))
                .unwrap();
            let law = Stribeck::new(0.4, 0.2, 0.1, 2).unwrap();
            let stribeck = MassOnBelt::new(law, v_b)
                .and_then(|system| system.with_damping(0.05)?.with_load(load))
                .unwrap();
            for speed in [0.05, 0.1, 0.15] {
                let start = at_force_balance(&exponential, speed);
                seen.follow(&exponential, start, Time::Backward, 40);
                let start = at_force_balance(&stribeck, speed);
                seen.follow(&stribeck, start, Time::Backward, 40);
            }
        }
    }
    println!("{seen:?}");
    seen.assert_exact();
    assert!(seen.lengths.iter().all(|n| *n >= 50), "{seen:?}");
}

/// A table whose points the creeping motion passes: each step stays on one piece.
#[test]
fn slow_steps_end_at_the_breakpoints_of_the_law() {
    let points = (0..40).map(|i| {
        let s = 0.01 * f64::from(i);
        (s, 0.2 + 3.0 * s + 5.0 * s * s)
    });
    let law = Tabulated::new(points).unwrap();
    for (time, load) in [(Time::Forward, 10.0), (Time::Forward, 1e3)] {
        let mut seen = Seen::default();
        let system = MassOnBelt::new(law.clone(), 0.3)
            .and_then(|system| system.with_load(load))
            .unwrap();
        let mut stepper = Stepper::new(&system.belt(), 2.0 * f64::EPSILON);
        let mut point = at_force_balance(&system, 0.055);
        let mut passed = 0;
        for _ in 0..400 {
            let end = stepper
                .advance(&system.belt(), &point, time, 0.0)
                .unwrap()
                .end;
            let on_breakpoint = system.law().breakpoints().any(|b| b == end.speed);
            passed += usize::from(on_breakpoint);
            let piece = |s: f64| system.law().breakpoints().take_while(|b| *b < s).count();
            let crossed = piece(end.speed).abs_diff(piece(point.speed));
            assert!(crossed <= 1, "{point:?} {end:?}");
            point = end;
        }
        assert!(passed >= 20, "{passed}");
        let start = at_force_balance(&system, 0.055);
        seen.follow(&system, start, time, 400);
        println!("{seen:?}");
        seen.assert_exact();
    }
}
