//! Stiff systems: as exact as any other, beside an integrator that shares nothing with the crate's.

use crate::common::Random;
use crate::radau::{Motion, Radau};
use crate::simple::{Seen, told};
use stick_slip::{
    AnyLaw, FrictionLaw, Integrator, MassOnBelt, Polynomial, Rational, State, Stribeck, Tabulated,
};

/// Systems of the usual run; the variable of this name asks for more.
const SYSTEMS: (&str, usize) = ("STICK_SLIP_STIFF_SYSTEMS", 1000);

/// Largest difference between the crate's motion and the witness's, of s and of u in parts of
/// themselves, of event times in parts of the time; and whether the events are the same.
fn difference<L: FrictionLaw>(
    system: &MassOnBelt<L>,
    start: State,
    duration: f64,
    witness: &Motion,
) -> Result<[f64; 3], String> {
    let motion = system
        .simulate(start, duration)
        .map_err(|e| e.to_string())?;
    let v_b = system.belt_velocity();
    let last = motion.last();
    let speed = (last.velocity - v_b).abs();
    // v is a rounded number.
    let rounding = 4.0 * f64::EPSILON * v_b.abs();
    let s = ((speed - witness.speed).abs() - rounding).max(0.0) / witness.speed.max(rounding);
    let u = (last.displacement - witness.end.displacement).abs() / last.displacement.abs();
    let events = told(motion.events());
    let kinds = |seen: &[Seen]| seen.iter().map(|e| (e.1, e.2)).collect::<Vec<_>>();
    if kinds(&events) != kinds(&witness.seen) {
        return Err(format!("{events:?} beside {:?}", witness.seen));
    }
    let times = std::iter::zip(&events, &witness.seen);
    let t = times
        .map(|(a, b)| (a.0 - b.0).abs() / b.0.max(f64::MIN_POSITIVE))
        .fold(0.0, f64::max);
    Ok([s, u, t])
}

/// Number i of the stiff systems: on a belt so fast that friction rises steeply with the sliding
/// speed, or with a strong damper.
fn stiff(i: usize) -> Option<(MassOnBelt<AnyLaw>, State, f64)> {
    let mut random = Random::new(7000 + i as u64);
    let top = random.logarithmic(0.1, 1.0);
    let least = top * random.uniform(0.3, 0.95);
    let width = random.logarithmic(1e-4, 1.0);
    let beyond = random.logarithmic(3.0, 300.0);
    let rise = random.logarithmic(0.03, 3.0) * top / width;
    let law: AnyLaw = match i % 5 {
        0 => Polynomial::new(top, least, width).ok()?.into(),
        1 => Rational::new(top, 1.0 / width)
            .and_then(|law| law.with_offset(least))
            .and_then(|law| law.with_quadratic(rise / width))
            .ok()?
            .into(),
        2 => Stribeck::new(top, least, width, 1 + (i / 5 % 4) as u32)
            .and_then(|law| law.with_viscous_coefficient(rise))
            .ok()?
            .into(),
        3 => {
            let points = [
                (0.0, top),
                (width, least),
                (3.0 * width, least + rise * width),
                (10.0 * width, least + 20.0 * rise * width),
            ];
            Tabulated::new(points).ok()?.into()
        }
        _ => Polynomial::new(top, least, width).ok()?.into(),
    };
    let damping = match i % 5 {
        4 => random.logarithmic(5.0, 1e4),
        _ => random.uniform(0.0, 0.3),
    };
    let v_b = random.sign() * width * beyond;
    let load = random.logarithmic(0.03, 30.0);
    let system = MassOnBelt::new(law, v_b)
        .and_then(|system| system.with_damping(damping)?.with_load(load))
        .ok()?;
    let size = load * top + v_b.abs();
    let start = match random.bits() % 4 {
        0 => State::new(0.0, 0.0),
        1 => system.release_state()?,
        _ => State::new(
            size * random.uniform(-1.0, 1.0),
            v_b * random.uniform(-0.5, 1.5),
        ),
    };
    Some((system, start, random.logarithmic(0.5, 20.0)))
}

#[test]
fn stiff_motions_are_those_of_an_implicit_method() {
    let (variable, usual) = SYSTEMS;
    let systems = std::env::var(variable).map_or(usual, |n| n.parse().expect("a number"));
    let radau = Radau::new(1e-13);
    let (mut judged, mut steps, mut worst) = (0, [0; 2], [0.0; 3]);
    let mut wrong = Vec::new();
    for i in 0..systems {
        let Some((system, start, duration)) = stiff(i) else {
            panic!("system {i}");
        };
        let motion = Integrator::new().simulate(&system, start, duration);
        let Ok(motion) = motion else {
            wrong.push(format!("{i}: {}", motion.unwrap_err()));
            continue;
        };
        steps[0] = steps[0].max(motion.steps().len());
        let Some(witness) = radau.run(&system, start, duration, 2000) else {
            println!("no witness of {i}: {start:?} {duration}");
            continue;
        };
        judged += 1;
        steps[1] = steps[1].max(witness.steps);
        match difference(&system, start, duration, &witness) {
            Ok(apart) => {
                for (worst, apart) in std::iter::zip(&mut worst, apart) {
                    *worst = apart.max(*worst);
                }
                if !apart.iter().all(|a| *a < 1e-10) {
                    wrong.push(format!("{i}: {apart:?} {system:?} {start:?} {duration}"));
                }
            }
            Err(events) => wrong.push(format!("{i}: {events} {system:?} {start:?} {duration}")),
        }
    }
    println!("{judged} of {systems}, most steps {steps:?}, worst {worst:?}");
    assert!(wrong.is_empty(), "{}\n{}", wrong.len(), wrong.join("\n"));
}

/// The cubic on a belt far faster than its minimum, from rest: v' beside its value on the slow
/// motion, to its second term. A speed that is wrong by δ shows as D·δ in it.
#[test]
fn the_residual_acceleration_is_that_of_the_slow_motion() {
    let (v_b, damping) = (1.0, 0.05);
    for (v_m, most) in [(1e-2, 2e-10), (1e-3, 1e-13), (3e-4, 1e-13), (1e-4, 1e-13)] {
        let system = MassOnBelt::new(Polynomial::new(0.4, 0.2, v_m).unwrap(), v_b)
            .and_then(|system| system.with_damping(damping))
            .unwrap();
        for time in [5.0, 20.0] {
            let motion = system.simulate(State::new(0.0, 0.0), time).unwrap();
            assert!(
                motion.steps().len() <= 100,
                "{v_m}: {}",
                motion.steps().len()
            );
            let State {
                displacement: u,
                velocity: v,
            } = motion.last();
            let s = v_b - v;
            // μ̂(s) = 0.4 − 0.3 z + 0.1 z³, z = s/v_m; forces about s without cancellation in u.
            let z = s / v_m;
            let decay = 2.0 * damping + (-0.3 + 0.3 * z * z) / v_m;
            let bend = 0.6 * z / (v_m * v_m);
            let acceleration = 0.4 - 0.3 * z + 0.1 * z * z * z - 2.0 * damping * v - u;
            // v'' = −v − D v' and D' = −bend·v': v' = −(v + v'')/D, twice.
            let first = -v / decay;
            let slow = -(v - first / decay - v * bend * first / (decay * decay)) / decay;
            let wrong = (acceleration - slow) / decay / s;
            assert!(
                wrong.abs() < most,
                "{v_m} {time}: s is wrong by {wrong:e} of itself"
            );
        }
    }
}

/// Slow belts under a large load: the speeds are far below the rounding of the forces over the
/// speeds, and the motion creeps nevertheless.
#[test]
fn a_creep_far_below_the_forces_is_followed() {
    for v_b in [1e-4, 1e-6] {
        let law = Stribeck::new(0.4, 0.3, 0.1 * v_b, 2)
            .and_then(|law| law.with_viscous_coefficient(0.1 / v_b))
            .unwrap();
        let system = MassOnBelt::new(law, v_b)
            .and_then(|system| system.with_load(10.0))
            .unwrap();
        let motion = system.simulate(State::new(0.0, 0.0), 10.0).unwrap();
        assert!(
            motion.steps().len() < 100,
            "{v_b}: {}",
            motion.steps().len()
        );
        let witness = Radau::new(1e-13).run(&system, State::new(0.0, 0.0), 10.0, 2000);
        let apart = difference(&system, State::new(0.0, 0.0), 10.0, &witness.unwrap());
        assert!(apart.unwrap().iter().all(|a| *a < 1e-10), "{v_b}");
    }
}

/// The cubic law at 20 to 10⁹ times its minimum velocity.
#[test]
fn work_does_not_grow_with_the_stiffness() {
    // From 1e6 on the first steps, from rest, are short of orders: their coefficients overflow.
    for (beyond, most) in [(20.0, 100), (1e3, 100), (1e6, 150), (1e9, 250)] {
        let v_m = 0.01;
        let system = MassOnBelt::new(Polynomial::new(0.4, 0.25, v_m).unwrap(), beyond * v_m)
            .and_then(|system| system.with_damping(0.05))
            .unwrap();
        let motion = system.simulate(State::new(0.0, 0.0), 50.0).unwrap();
        let steps = motion.steps().len();
        assert!(steps <= most, "{beyond:e}: {steps}");
    }
}
