//! What does a step of a structure cost, for each of its masses, and how does that grow with their
//! number?
//!
//! Chains of masses on a belt, each with the cubic law and a spring to the next (tridiagonal K,
//! diagonal C), a part of them sliding in steady vibration; time of a step divided by the number of
//! masses, from least times. Beside it the belt's own engine, for one mass.

use std::hint::black_box;
use std::time::Instant;

use stick_slip::{
    Contact, Coulomb, Drive, Exponential, FrictionLaw, Integrator, MassOnBelt, Polynomial,
    Rational, State, Structure, structure,
};

/// Least time of a step, in nanoseconds, over many runs of so many steps.
fn least_of(runs: usize, steps: usize, mut run: impl FnMut()) -> f64 {
    let mut least = f64::INFINITY;
    for _ in 0..runs {
        let start = Instant::now();
        run();
        least = least.min(start.elapsed().as_secs_f64() / steps as f64);
    }
    least * 1e9
}

/// n masses that slide behind their belt, none near it.
fn chain<L: FrictionLaw + Clone + Send + Sync + 'static>(
    n: usize,
    law: &L,
    drive: bool,
) -> Structure {
    let mut chain = Structure::new(&vec![1.0; n]).unwrap();
    for i in 0..n {
        let belt: Drive = if drive {
            Drive::sine(0.1, 1.3).unwrap().with_constant(2.0).unwrap()
        } else {
            2.0.into()
        };
        chain = chain
            .with_ground_spring(i, 1.0)
            .and_then(|chain| chain.with_ground_damper(i, 0.1))
            .and_then(|chain| chain.with_contact(Contact::new(i, law.clone(), 1.0)?.on_belt(belt)))
            .unwrap();
        if i > 0 {
            chain = chain.with_spring(i - 1, i, 0.5).unwrap();
        }
    }
    chain
}

fn start(n: usize) -> structure::State {
    let u: Vec<f64> = (0..n).map(|i| 0.3 + 0.2 * (1.7 * i as f64).sin()).collect();
    structure::State::new(&u, &vec![0.0; n])
}

fn of_structure<L: FrictionLaw + Clone + Send + Sync + 'static>(
    n: usize,
    law: &L,
    drive: bool,
) -> f64 {
    let system = chain(n, law, drive);
    // Short runs: a long one is seldom left alone by other programs.
    let steps = (1000 / n).clamp(10, 100);
    let runs = if n > 10 { 200 } else { 2000 };
    let step = least_of(runs, steps, || {
        let flow = Integrator::new()
            .flow(black_box(&system), start(n))
            .unwrap();
        for step in flow.take(steps) {
            black_box(step.unwrap());
        }
    });
    step / n as f64
}

fn of_belt<L: FrictionLaw + Clone + Send + Sync + 'static>(law: &L) -> f64 {
    let system = MassOnBelt::new(law.clone(), 2.0)
        .and_then(|system| system.with_damping(0.05))
        .unwrap();
    let steps = 100;
    least_of(2000, steps, || {
        let flow = Integrator::new()
            .flow(black_box(&system), State::new(0.3, 0.0))
            .unwrap();
        for step in flow.take(steps) {
            black_box(step.unwrap());
        }
    })
}

/// Returns the belt's time.
fn one_law<L: FrictionLaw + Clone + Send + Sync + 'static>(name: &str, law: &L) -> f64 {
    // In turn, and the least of both.
    let [mut belt, mut one] = [f64::INFINITY; 2];
    for _ in 0..3 {
        belt = belt.min(of_belt(law));
        one = one.min(of_structure(1, law, false));
    }
    println!(
        "{name:12} belt {belt:5.0} ns, structure of one {one:5.0} ns: {:.2}",
        one / belt
    );
    belt
}

fn main() {
    let cubic = Polynomial::new(0.4, 0.25, 1.5).unwrap();
    let belt = one_law("cubic", &cubic);
    one_law("exponential", &Exponential::new(0.4, 0.25, 1.5).unwrap());
    one_law("rational", &Rational::new(0.4, 1.0).unwrap());
    one_law("coulomb", &Coulomb::new(0.4, 0.25).unwrap());
    for n in [1, 2, 3, 10, 100, 1000] {
        let mass = of_structure(n, &cubic, false);
        println!(
            "n = {n:4}: {mass:5.0} ns a mass: {:.2} of the belt",
            mass / belt
        );
    }
    println!(
        "one harmonic belt: {:5.0} ns",
        of_structure(1, &cubic, true)
    );
}
