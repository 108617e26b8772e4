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
