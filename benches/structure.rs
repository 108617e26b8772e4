//! What does a step of a structure cost, for each of its masses, and how does that grow with their
//! number?
//!
//! Chains of masses on a belt, each with the cubic law and a spring to the next (tridiagonal K,
//! diagonal C), a part of them sliding in steady vibration; time of a step divided by the number of
//! masses, from least times. The start of a motion, which reads all entries of K and C, does not
//! count. Beside it the belt's own engine, for one mass.
//!
//! Then the same chains with joints between all neighbours, friction contacts that share masses:
//! all sliding, or all stuck, so that what they carry is found by a factorisation in every order.
//!
//! Last, what a force element adds to a step of one mass, beside what a second mass with its
//! friction adds.

use std::hint::black_box;
use std::time::Instant;

use stick_slip::{
    Contact, Coulomb, Drive, Exponential, ForceElement, FrictionLaw, Integrator, MassOnBelt,
    Pendulum, Polynomial, PolynomialSpring, Rational, State, Structure, System, structure,
};

/// Least time of a step, in nanoseconds, over many runs of so many steps.
fn least_of<S: System>(runs: usize, steps: usize, system: &S, start: &S::State) -> f64 {
    let mut least = f64::INFINITY;
    for _ in 0..runs {
        let flow = Integrator::new()
            .flow(black_box(system), start.clone())
            .unwrap();
        let begin = Instant::now();
        for step in flow.take(steps) {
            black_box(step.unwrap());
        }
        least = least.min(begin.elapsed().as_secs_f64() / steps as f64);
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

/// n masses with springs and joints between neighbours. They slide by one another, and the first
/// by the ground, at the speed of a motor in every joint; without motors the joints stick.
fn jointed<L: FrictionLaw + Clone + Send + Sync + 'static>(
    n: usize,
    law: &L,
    motors: bool,
) -> Structure {
    let mut chain = Structure::new(&vec![1.0; n]).unwrap();
    for i in 0..n {
        chain = chain
            .with_ground_spring(i, 1.0)
            .and_then(|chain| chain.with_ground_damper(i, 0.1))
            .unwrap();
        if i > 0 {
            chain = chain.with_spring(i - 1, i, 0.5).unwrap();
        }
        let contact = match i {
            0 if motors => Contact::new(0, law.clone(), 1.0),
            0 => continue,
            _ if motors => Contact::between(i, i - 1, law.clone(), 1.0),
            _ => Contact::between(i, i - 1, law.clone(), 100.0 * n as f64),
        };
        let speed = if motors { 2.0 } else { 0.0 };
        let contact = contact.unwrap().on_belt(speed);
        chain = chain.with_contact(contact).unwrap();
    }
    chain
}

/// A chain whose joints all stick moves as one.
fn together(n: usize) -> structure::State {
    structure::State::new(&vec![0.3; n], &vec![0.0; n])
}

fn of_structure<L: FrictionLaw + Clone + Send + Sync + 'static>(
    n: usize,
    law: &L,
    drive: bool,
) -> f64 {
    of_chain(n, &chain(n, law, drive), &start(n))
}

fn of_chain(n: usize, system: &Structure, start: &structure::State) -> f64 {
    // Short runs: a long one is seldom left alone by other programs.
    let steps = (1000 / n).clamp(10, 100);
    let runs = if n > 10 { 200 } else { 2000 };
    least_of(runs, steps, system, start) / n as f64
}

fn of_belt<L: FrictionLaw + Clone + Send + Sync + 'static>(law: &L) -> f64 {
    let system = MassOnBelt::new(law.clone(), 2.0)
        .and_then(|system| system.with_damping(0.05))
        .unwrap();
    least_of(2000, 100, &system, &State::new(0.3, 0.0))
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
    println!("\njoints between all neighbours, beside the chain without them");
    for n in [2, 10, 100, 1000] {
        let [mut free, mut sliding, mut stuck] = [f64::INFINITY; 3];
        let chains = [true, false].map(|motors| jointed(n, &cubic, motors));
        // In turn, and the least of all.
        for _ in 0..3 {
            free = free.min(of_structure(n, &cubic, false));
            sliding = sliding.min(of_chain(n, &chains[0], &start(n)));
            stuck = stuck.min(of_chain(n, &chains[1], &together(n)));
        }
        println!(
            "n = {n:4}: {free:5.0} ns a mass; all sliding {:.2}, all stuck {:.2} of that",
            sliding / free,
            stuck / free
        );
    }
    println!(
        "\none harmonic belt: {:5.0} ns",
        of_structure(1, &cubic, true)
    );
    elements(&cubic);
}

/// What a force element adds to a step of one mass, in parts of what a second mass adds.
fn elements(friction: &Polynomial) {
    let with = |element: ForceElement| chain(1, friction, false).with_element(element).unwrap();
    let duffing = PolynomialSpring::new(&[0.0, 0.0, 0.5]).unwrap();
    let pendulum = Pendulum::new(0.5, 1.0).unwrap();
    let systems = [
        ("one mass", chain(1, friction, false)),
        ("a second", chain(2, friction, false)),
        ("Duffing", with(ForceElement::new(0, duffing).unwrap())),
        ("pendulum", with(ForceElement::new(0, pendulum).unwrap())),
    ];
    let mut least = [f64::INFINITY; 4];
    // In turn, and the least of all.
    for _ in 0..3 {
        for (least, (_, system)) in least.iter_mut().zip(&systems) {
            *least = least.min(least_of(2000, 100, system, &start(system.len())));
        }
    }
    let [one, second, ..] = least;
    println!("\n{} {one:5.0} ns a step; others add", systems[0].0);
    for (least, (name, _)) in std::iter::zip(least, &systems).skip(1) {
        let added = least - one;
        println!(
            "{name:8} {added:5.0} ns: {:.2} of a second mass",
            added / (second - one)
        );
    }
}
