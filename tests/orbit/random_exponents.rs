//! Lyapunov exponents of forced systems with elastic joints, against two motions side by side.

use stick_slip::nalgebra::DVector;
use stick_slip::orbit::lyapunov_with_spread;
use stick_slip::structure::State;
use stick_slip::{Contact, Coulomb, Drive, Error, Integrator, Rational, Structure};

use crate::common::{Random, count, vector};

/// A mass on a belt, and one or two that elastic contacts join to it.
fn joined(random: &mut Random) -> Result<Structure, Error> {
    let n = 2 + (random.bits() % 2) as usize;
    let masses: Vec<f64> = (0..n).map(|_| random.uniform(0.5, 1.5)).collect();
    let mut system = Structure::new(&masses)?;
    for i in 0..n {
        system = system
            .with_ground_spring(i, random.uniform(0.5, 1.5))?
            .with_ground_damper(i, random.uniform(0.005, 0.03))?;
    }
    let force = Drive::harmonic(random.uniform(0.1, 0.6), random.uniform(0.5, 1.2), 0.0)?;
    let law = Rational::new(0.3, 1.42)?
        .with_offset(0.1)?
        .with_quadratic(0.01)?;
    let belt = Contact::new(0, law, 1.0)?.on_belt(0.2);
    system = system.with_force(0, force)?.with_contact(belt)?;
    for i in 1..n {
        let limit = random.uniform(0.02, 0.2);
        let joint = Contact::between(i - 1, i, Coulomb::new(limit, limit)?, 1.0)?;
        system = system.with_contact(joint.with_tangential_stiffness(random.uniform(0.5, 5.0))?)?;
    }
    Ok(system)
}

/// The growth rate of the distance of two motions, once a period of the drive, in several parts of
/// the duration; `None` if they become one.
fn growth_of_two(
    system: &Structure,
    start: &State,
    parts: usize,
    periods: usize,
) -> Option<Vec<f64>> {
    const APART: f64 = 1e-8;
    let step = system.period().unwrap();
    let n = start.displacements.len();
    let state = |of: &DVector<f64>| {
        let of = of.as_slice();
        State::new(&of[..n], &of[n..2 * n]).with_memory(&of[2 * n..])
    };
    let mut one = vector(start);
    // Not a velocity, which stick takes away.
    let mut other = one.clone();
    other[n - 1] += APART;
    let mut rates = Vec::new();
    for part in 0..parts {
        let mut sum = 0.0;
        for number in part * periods..(part + 1) * periods {
            let settings = Integrator::new()
                .with_start_time(number as f64 * step)
                .unwrap();
            let run = |from: &DVector<f64>| {
                vector(&settings.simulate(system, state(from), step).unwrap().last())
            };
            (one, other) = (run(&one), run(&other));
            let apart = &other - &one;
            let size = apart.norm();
            if size < 1e-14 {
                return None;
            }
            sum += (size / APART).ln();
            other = &one + apart * (APART / size);
        }
        rates.push(sum / (periods as f64 * step));
    }
    Some(rates)
}

#[test]
fn exponents_with_joints_are_the_growth_of_two_motions() {
    let mut random = Random::new(8801);
    let mut compared = 0;
    let mut wrong: Vec<String> = Vec::new();
    let cases = count(1, 40);
    for number in 0..cases {
        let system = joined(&mut random).unwrap();
        let period = system.period().unwrap();
        let rest = State::at_rest(system.len()).with_memory(&vec![0.0; system.len() - 1]);
        let begin = 200.0 * period;
        let start = system.simulate(rest, begin).unwrap().last();
        let found = lyapunov_with_spread(&system, &start, 0.0, 400.0 * period).unwrap();
        if found.value == f64::NEG_INFINITY {
            continue;
        }
        let Some(rates) = growth_of_two(&system, &start, 8, 50) else {
            continue;
        };
        let mean = rates.iter().sum::<f64>() / 8.0;
        let squares: f64 = rates.iter().map(|rate| (rate - mean).powi(2)).sum();
        let spread = (squares / 56.0).sqrt();
        compared += 1;
        // What each begins with counts as one factor in 400 periods.
        let allowed = 6.0 * (spread + found.spread) + 1e-3;
        if (mean - found.value).abs() > allowed {
            wrong.push(format!(
                "case {number}: {found:?}, by two motions {mean} {spread}"
            ));
        }
    }
    println!("{compared} compared");
    assert!(wrong.is_empty(), "{wrong:#?}");
    assert!(10 * compared >= 9 * cases, "{compared} compared");
}
