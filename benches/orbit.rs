//! What do the derivatives of a motion cost, beside the motion itself, and what does a branch cost?
//!
//! Least times of a motion over one period, by `simulate`, and of the same motion with its
//! monodromy matrix, as each trial of a search for periodic motions computes it; then of a branch
//! of the drill string, by `follow`.

use std::f64::consts::{PI, TAU};
use std::hint::black_box;
use std::time::Instant;

use stick_slip::nalgebra::DMatrix;
use stick_slip::orbit::{self, Oscillator, Period};
use stick_slip::structure::State;
use stick_slip::{
    Contact, Coulomb, Drive, Error, Exponential, Integrator, Polynomial, Stribeck, Structure,
    System,
};

/// Least time in microseconds over about a second of runs.
fn least(mut run: impl FnMut()) -> f64 {
    let begin = Instant::now();
    let mut least = f64::INFINITY;
    while begin.elapsed().as_secs_f64() < 1.0 {
        let start = Instant::now();
        run();
        least = least.min(start.elapsed().as_secs_f64());
    }
    least * 1e6
}

/// Masses on a belt in a row, one of them under a harmonic force.
fn masses(n: usize) -> Result<Structure, Error> {
    let law = Exponential::new(0.4, 0.25, 1.5)?;
    let mut masses = Structure::new(&vec![1.0; n])?;
    for i in 0..n {
        masses = masses
            .with_ground_spring(i, 1.0)?
            .with_ground_damper(i, 0.1)?
            .with_contact(Contact::new(i, law, 1.0)?.on_belt(0.2))?;
        if i > 0 {
            masses = masses.with_spring(i - 1, i, 0.5)?;
        }
    }
    masses.with_force(0, Drive::harmonic(0.3, 0.8, 0.0)?)
}

/// The same in smooth slip under a cubic law.
fn sliding(n: usize) -> Result<Structure, Error> {
    let law = Polynomial::new(0.4, 0.25, 1.5)?;
    let mut masses = Structure::new(&vec![1.0; n])?;
    for i in 0..n {
        masses = masses
            .with_ground_spring(i, 1.0)?
            .with_ground_damper(i, 0.1)?
            .with_contact(Contact::new(i, law, 1.0)?.on_belt(2.0))?;
        if i > 0 {
            masses = masses.with_spring(i - 1, i, 0.5)?;
        }
    }
    masses.with_force(0, Drive::harmonic(0.3, 0.8, 0.0)?)
}

const INERTIAS: usize = 20;
/// The table's speed, rad/s.
const SPEED: f64 = 5.0;

/// A drill string of 20 inertias, as seen from its table: the bit is the first, the drive the last;
/// kg·m², N·m per radian, N·m·s.
fn drill_string(speed: f64) -> Result<Structure, Error> {
    let mut inertias = [5.0; INERTIAS];
    (inertias[0], inertias[INERTIAS - 1]) = (374.0, 2122.0);
    let pieces = (INERTIAS - 1) as f64;
    let rock = Contact::new(0, Stribeck::new(0.8, 0.4, 1.0, 1)?, 12e3)?.on_belt(-speed);
    let mut string = Structure::new(&inertias)?.with_contact(rock)?;
    for i in 1..INERTIAS {
        string =
            string
                .with_spring(i - 1, i, 473.0 * pieces)?
                .with_damper(i - 1, i, 23.2 * pieces)?;
    }
    string
        .with_ground_spring(INERTIAS - 1, 4000.0)?
        .with_ground_damper(INERTIAS - 1, 425.0)
}

/// Twenty shapes of a beam that carries three masses, on six elastic pads with normal springs: full
/// matrices.
fn beam(frequency: f64) -> Result<Structure, Error> {
    const SHAPES: usize = 20;
    let row = |x: f64| -> Vec<(usize, f64)> {
        let shape = |i: usize| (i, (PI * (i + 1) as f64 * x).sin());
        (0..SHAPES).map(shape).collect()
    };
    let mut mass = DMatrix::identity(SHAPES, SHAPES);
    let square = |i: usize| 0.01 * ((i + 1) as f64).powi(4);
    let mut stiffness = DMatrix::from_fn(SHAPES, SHAPES, |i, j| f64::from(i == j) * square(i));
    for x in [0.21, 0.37, 0.55] {
        for (i, a) in row(x) {
            for (j, b) in row(x) {
                mass[(i, j)] += 0.1 * a * b;
                stiffness[(i, j)] += 0.02 * a * b;
            }
        }
    }
    let damping = &stiffness * 1e-3;
    let mut beam = Structure::with_mass_matrix(mass)?
        .with_stiffness(stiffness)?
        .with_damping(damping)?;
    for pad in 0..6 {
        let x = 0.62 + 0.06 * f64::from(pad);
        let along: Vec<_> = row(1.0 - 0.9 * x);
        beam = beam.with_contact(
            Contact::along(&along, Coulomb::new(0.3, 0.3)?, 0.1)?
                .with_tangential_stiffness(0.3)?
                .with_normal_spring(&row(x), 0.1)?,
        )?;
    }
    for (i, part) in row(0.3) {
        beam = beam.with_force(i, Drive::harmonic(0.1 * part, TAU * frequency, 0.0)?)?;
    }
    Ok(beam)
}

/// Steps and times of one motion, without and with its monodromy matrix.
fn compare<S>(name: &str, system: &S, start: &State, period: f64)
where
    S: Oscillator + System<State = State>,
{
    let run = || Integrator::new().simulate(system, start.clone(), period);
    let steps = run().unwrap();
    let [mut motion, mut both] = [f64::INFINITY; 2];
    // In turn, and the least of both.
    for _ in 0..3 {
        motion = motion.min(least(|| {
            black_box(run().unwrap());
        }));
        both = both.min(least(|| {
            black_box(system.form().period_map(black_box(start), period).unwrap());
        }));
    }
    println!(
        "{name:24} {:4} steps: motion {motion:8.1} µs, with monodromy {both:8.1} µs: {:.2}",
        steps.steps().len(),
        both / motion
    );
}

fn main() -> Result<(), Error> {
    for n in [1, 3] {
        let length = TAU / 0.8;
        let start = |system: &Structure| system.simulate(State::at_rest(n), 20.0 * length);
        let system = masses(n)?;
        compare(
            &format!("stick-slip, n = {n}"),
            &system,
            &start(&system)?.last(),
            length,
        );
        let system = sliding(n)?;
        compare(
            &format!("slip, n = {n}"),
            &system,
            &start(&system)?.last(),
            length,
        );
    }
    let string = drill_string(SPEED)?;
    let mut still = vec![0.0; INERTIAS];
    still[0] = -SPEED;
    let start = State::new(&[0.0; INERTIAS], &still);
    let settled = orbit::settle(&string, &start, 100.0, Period::Free(6.0))?;
    compare(
        "drill string, n = 20",
        &string,
        &settled.state(),
        settled.period(),
    );
    let frequency = 0.1;
    let shaken = beam(frequency)?;
    let start = shaken
        .simulate(State::at_rest(20), 30.0 / frequency)?
        .last();
    compare("beam on pads, n = 20", &shaken, &start, 1.0 / frequency);

    let begin = Instant::now();
    let branch = orbit::follow(drill_string, SPEED, &settled, 3.0..7.0)?;
    println!(
        "\nfollow, drill string: {} points, {} bifurcations in {:.2} s",
        branch.points.len(),
        branch.bifurcations.len(),
        begin.elapsed().as_secs_f64()
    );
    for found in &branch.bifurcations {
        println!("  {} at {:.9}", found.kind, found.parameter);
    }
    println!("  {:?}", branch.ends);
    Ok(())
}
