//! A beam that is pressed by springs on six elastic pads. A harmonic force is swept upwards and
//! downwards over the second resonance, at which the pads slip and open. A free decay gives the
//! damping over the amplitude.
//!
//! What to learn from it:
//!
//! * a reduced model is given by its matrices. Here its coordinates are 14 bending and 6 axial
//!   shapes of a beam with a step in its thickness, so M and K are full. A contact is given by two
//!   rows of shape functions: the displacement of the surface along the pad, and the displacement
//!   into the pad;
//! * each pad is an elastic contact with a normal spring. Below the onset of slip the joint is
//!   linear. Above it the joint damps the vibration. When pads open, the resonance peak bends to
//!   lower frequencies;
//! * two motions therefore exist in a range of frequencies: sweeps downwards and upwards reach
//!   different amplitudes;
//! * `orbit::settle` computes two such motions exactly, with their multipliers, which show whether
//!   they are stable.
//!
//! Run it with `cargo run --release --example bolted_beam`; it takes a minute. With a file name
//! after `--`, it writes sweeps at three forces to this file instead, which takes some minutes. The
//! package `examples/figures` draws such a file, `examples/figures/bolted_beam.csv`.

use std::f64::consts::{PI, TAU};

use stick_slip::nalgebra::{DMatrix, DVector};
use stick_slip::orbit::{self, Period};
use stick_slip::structure::State;
use stick_slip::{Contact, Coulomb, Drive, Error, Segment, Structure, Trajectory};

// Steel, in metres, kilograms and seconds.
const LENGTH: f64 = 0.4;
const WIDTH: f64 = 0.03;
const MODULUS: f64 = 210e9;
const DENSITY: f64 = 7850.0;
/// Thickness up to the middle, and beyond it.
const THICKNESS: [f64; 2] = [0.02, 0.016];
const BENDING: usize = 14;
const AXIAL: usize = 6;
pub(crate) const SHAPES: usize = BENDING + AXIAL;
/// Damping ratio of the second mode without pads.
const DAMPING: f64 = 0.001;

// Of each pad.
const PADS: usize = 6;
const FRICTION: f64 = 0.3;
const LOAD: f64 = 150.0;
const TANGENTIAL: f64 = 8e6;
const NORMAL: f64 = 2e6;

/// Wave numbers: w = sin px of a beam on two supports, u = sin qx of a bar held at one end.
fn wave_number(shape: usize) -> f64 {
    match shape.checked_sub(BENDING) {
        None => PI * (shape + 1) as f64 / LENGTH,
        Some(axial) => PI * (axial as f64 + 0.5) / LENGTH,
    }
}

/// Mass and stiffness matrix.
fn matrices() -> [DMatrix<f64>; 2] {
    let mut matrices = [0, 1].map(|_| DMatrix::zeros(SHAPES, SHAPES));
    for (half, thickness) in THICKNESS.into_iter().enumerate() {
        let ends = [0.5, 1.0].map(|part| LENGTH * (part - 0.5 + 0.5 * half as f64));
        let area = WIDTH * thickness;
        let bending = MODULUS * area * thickness * thickness / 12.0;
        // ∫ cos rx
        let cosine = |r: f64| match r {
            0.0 => ends[1] - ends[0],
            _ => ((r * ends[1]).sin() - (r * ends[0]).sin()) / r,
        };
        for i in 0..SHAPES {
            for j in (0..SHAPES).filter(|&j| (i < BENDING) == (j < BENDING)) {
                let [p, q] = [i, j].map(wave_number);
                let [less, more] = [cosine((p - q).abs()), cosine(p + q)];
                let sines = 0.5 * (less - more);
                matrices[0][(i, j)] += DENSITY * area * sines;
                matrices[1][(i, j)] += if i < BENDING {
                    bending * (p * q) * (p * q) * sines
                } else {
                    MODULUS * area * (p * q) * (0.5 * (less + more))
                };
            }
        }
    }
    matrices
}

/// Displacements of the lower surface at a pad: along it, and into it.
fn rows(pad: usize) -> [Vec<(usize, f64)>; 2] {
    let x = LENGTH * (0.62 + 0.06 * pad as f64);
    let along = |shape: usize| {
        let p = wave_number(shape);
        if shape < BENDING {
            0.5 * THICKNESS[1] * p * (p * x).cos()
        } else {
            (p * x).sin()
        }
    };
    let into = |shape: usize| -(wave_number(shape) * x).sin();
    [
        (0..SHAPES).map(|shape| (shape, along(shape))).collect(),
        (0..BENDING).map(|shape| (shape, into(shape))).collect(),
    ]
}

/// The beam under a force at 0.3 of its length.
fn beam(force: f64, frequency: f64) -> Result<Structure, Error> {
    let [mass, stiffness] = matrices();
    // In proportion to the stiffness: higher modes are damped more.
    let damping = &stiffness * (2.0 * DAMPING / (TAU * 1060.0));
    let mut beam = Structure::with_mass_matrix(mass)?
        .with_stiffness(stiffness)?
        .with_damping(damping)?;
    let mut pressed = [0.0; BENDING];
    for pad in 0..PADS {
        let [along, into] = rows(pad);
        for &(shape, d) in &into {
            pressed[shape] += LOAD * d;
        }
        let contact = Contact::along(&along, Coulomb::new(FRICTION, FRICTION)?, LOAD)?
            .with_tangential_stiffness(TANGENTIAL)?
            .with_normal_spring(&into, NORMAL)?;
        beam = beam.with_contact(contact)?;
    }
    for (shape, pressed) in pressed.into_iter().enumerate() {
        let part = force * (wave_number(shape) * 0.3 * LENGTH).sin();
        let drive = Drive::harmonic(part, TAU * frequency, 0.0)?.with_constant(pressed)?;
        beam = beam.with_force(shape, drive)?;
    }
    Ok(beam)
}

/// Frequency and shape of the second mode, with all pads closed and stuck.
pub(crate) fn second_mode() -> Option<(f64, DVector<f64>)> {
    let [mass, mut stiffness] = matrices();
    for pad in 0..PADS {
        for (row, k) in rows(pad).into_iter().zip([TANGENTIAL, NORMAL]) {
            let mut vector = DVector::zeros(SHAPES);
            row.iter().for_each(|&(shape, b)| vector[shape] = b);
            stiffness += k * &vector * vector.transpose();
        }
    }
    let inverse = mass.cholesky()?.l().try_inverse()?;
    let modes = (&inverse * stiffness * inverse.transpose()).symmetric_eigen();
    let mut order: Vec<usize> = (0..SHAPES).collect();
    order.sort_by(|&i, &j| modes.eigenvalues[i].total_cmp(&modes.eigenvalues[j]));
    let mode = order[1];
    let shape = inverse.transpose() * modes.eigenvectors.column(mode);
    Some((modes.eigenvalues[mode].sqrt() / TAU, &shape / shape[1]))
}

/// Half the range of the second bending shape from a time on.
fn amplitude(motion: &Trajectory<State>, from: f64) -> f64 {
    let steps = motion.steps().iter();
    let late = steps.filter(|step| step.start_time() >= from);
    let (low, high) = late.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), step| {
        let q = step.state().displacements[1];
        (low.min(q), high.max(q))
    });
    0.5 * (high - low)
}

/// Times and values of the turning points of the second bending shape; whether each is a maximum.
fn turns(motion: &Trajectory<State>) -> Vec<(f64, f64, bool)> {
    let turns = motion.steps().iter().filter_map(|step| {
        let [before, after] = [step.state(), &step.end_state()].map(|state| state.velocities[1]);
        let time = step.duration() * before / (before - after);
        let turns = (before > 0.0) != (after > 0.0);
        turns.then(|| {
            let displacement = step.state_at(time).displacements[1];
            (step.start_time() + time, displacement, before > 0.0)
        })
    });
    turns.collect()
}

/// A free decay in the second mode, from an amplitude at which the pads open: amplitude, frequency
/// and damping ratio of windows of `window` periods. Each window begins `step` periods after the
/// window before.
pub(crate) fn decay(window: usize, step: usize) -> Result<Vec<[f64; 3]>, Error> {
    let (natural, shape) = second_mode().expect("the mass matrix is positive definite");
    let start: Vec<f64> = (&shape * 1.2e-4).iter().copied().collect();
    let start = State::new(&start, &[0.0; SHAPES]);
    let motion = beam(0.0, natural)?.simulate(start, 240.0 / natural)?;
    let maxima: Vec<_> = turns(&motion).into_iter().filter(|turn| turn.2).collect();
    let windows = maxima.windows(window + 1).step_by(step).map(|part| {
        let (begin, end) = (part[0], part[window]);
        let frequency = window as f64 / (end.0 - begin.0);
        let ratio = (begin.1 / end.1).ln() / (window as f64 * TAU);
        [(begin.1 * end.1).sqrt(), frequency, ratio]
    });
    Ok(windows.collect())
}

/// A frequency of a sweep, and the least and the largest amplitude there: one and the same if the
/// vibration is periodic.
pub(crate) type Swept = (f64, [f64; 2]);

/// The amplitudes at frequencies one after the other; each run starts from the last state of the
/// run before. If the motion settles to a stable motion of the force's period, this motion is
/// computed exactly. Otherwise the amplitudes of the last 40 periods are returned.
pub(crate) fn swept(
    force: f64,
    frequencies: impl Iterator<Item = f64>,
) -> Result<Vec<Swept>, Error> {
    let mut state = State::at_rest(SHAPES);
    let mut found = Vec::new();
    for frequency in frequencies {
        let system = beam(force, frequency)?;
        let motion = system.simulate(state, PERIODS / frequency)?;
        state = motion.last();
        let turns = turns(&motion);
        // A period between two turning points has no amplitude of its own.
        let late = (1..=40).filter_map(|back| {
            let from = (PERIODS - f64::from(back)) / frequency;
            let period = from..from + 1.0 / frequency;
            let values = turns.iter().filter(|turn| period.contains(&turn.0));
            let (low, high) = values
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), turn| {
                    (low.min(turn.1), high.max(turn.1))
                });
            (high > low).then_some(0.5 * (high - low))
        });
        let mut amplitudes = late.fold([f64::INFINITY, 0.0], |[low, high]: [f64; 2], amplitude| {
            [low.min(amplitude), high.max(amplitude)]
        });
        // A motion far away is not the one that the sweep tends to.
        let near = 0.8 * amplitudes[0]..1.2 * amplitudes[1];
        match orbit::shoot(&system, &state, Period::Driven(1)) {
            Ok(orbit) if orbit.is_stable() && near.contains(&orbit.amplitude(1)) => {
                amplitudes = [orbit.amplitude(1); 2];
                state = orbit.state();
            }
            _ => {}
        }
        found.push((frequency, amplitudes));
    }
    Ok(found)
}

/// Forces of the sweeps for the figure.
pub(crate) const FORCES: [f64; 3] = [15.0, 30.0, 60.0];

/// Frequencies of the sweeps for the figure, upwards.
pub(crate) fn frequencies(natural: f64) -> impl DoubleEndedIterator<Item = f64> + Clone {
    (0..=24).map(move |i| natural * (0.97 + 0.0015 * f64::from(i)))
}

/// Writes the sweeps of the figure, all at one time.
fn write(file: &str, natural: f64) -> Result<(), Box<dyn std::error::Error>> {
    let of = frequencies(natural);
    let sweeps = std::thread::scope(|scope| {
        let running = FORCES.map(|force| {
            let (up, down) = (of.clone(), of.clone().rev());
            [
                scope.spawn(move || swept(force, up)),
                scope.spawn(move || swept(force, down)),
            ]
        });
        running.map(|both| both.map(|sweep| sweep.join().expect("no sweep panics")))
    });
    let mut text =
        String::from("force in N,sweep,frequency in Hz,least and,largest amplitude in m\n");
    for (force, both) in FORCES.into_iter().zip(sweeps) {
        for (sweep, name) in both.into_iter().zip(["up", "down"]) {
            for (frequency, [least, largest]) in sweep? {
                text += &format!("{force},{name},{frequency:.9},{least:.9e},{largest:.9e}\n");
            }
        }
    }
    std::fs::write(file, text)?;
    Ok(())
}

const FORCE: f64 = 60.0;
/// Frequencies of the sweeps, in units of that of the stuck beam.
const RANGE: [f64; 2] = [0.978, 1.002];
const FREQUENCIES: usize = 13;
/// Periods at each of them.
const PERIODS: f64 = 150.0;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (natural, _) = second_mode().expect("the mass matrix is positive definite");
    if let Some(file) = std::env::args().nth(1) {
        return write(&file, natural);
    }
    println!("second mode, pads closed and stuck: {natural:.2} Hz");

    println!("\nfree decay: amplitude in µm, frequency in Hz, damping ratio");
    let mut ratios = Vec::new();
    for [amplitude, frequency, ratio] in decay(20, 20)? {
        println!("  {:6.1}   {frequency:8.2}   {ratio:.5}", 1e6 * amplitude);
        ratios.push((frequency, ratio));
    }
    let most = ratios.iter().fold(0.0_f64, |most, point| most.max(point.1));
    let last = ratios[ratios.len() - 1];
    // At the end of the decay the pads stick; before, they damp the vibration, and lower its
    // frequency when they open.
    assert!((last.0 / natural - 1.0).abs() < 5e-3 && ratios[0].0 < 0.995 * natural);
    assert!(most > 1.5 * last.1);

    println!("\n{FORCE} N: frequency in Hz, amplitude in µm swept downwards and upwards");
    let at = |i: usize| {
        let part = i as f64 / (FREQUENCIES - 1) as f64;
        natural * (RANGE[0] + (RANGE[1] - RANGE[0]) * part)
    };
    let sweep = |order: &mut dyn Iterator<Item = usize>| {
        let mut found = vec![(0.0, State::at_rest(SHAPES)); FREQUENCIES];
        let mut state = State::at_rest(SHAPES);
        for i in order {
            let motion = beam(FORCE, at(i))?.simulate(state, PERIODS / at(i))?;
            state = motion.last();
            found[i] = (amplitude(&motion, (PERIODS - 2.0) / at(i)), state.clone());
        }
        Ok::<_, Error>(found)
    };
    let down = sweep(&mut (0..FREQUENCIES).rev())?;
    let up = sweep(&mut (0..FREQUENCIES))?;
    let mut apart = Vec::new();
    for i in 0..FREQUENCIES {
        let [one, other] = [down[i].0, up[i].0];
        println!("  {:8.2}   {:6.1}   {:6.1}", at(i), 1e6 * one, 1e6 * other);
        apart.push((one / other, i));
    }

    // Two exact motions at one frequency: the frequency at which the sweeps differ most among those
    // with periodic vibrations.
    apart.sort_by(|a, b| b.0.total_cmp(&a.0));
    let exact = |i: usize| -> Result<[orbit::Orbit<Structure>; 2], Error> {
        let system = beam(FORCE, at(i))?;
        let settled = |start| orbit::settle(&system, start, 200.0 / at(i), Period::Driven(1));
        Ok([settled(&down[i].1)?, settled(&up[i].1)?])
    };
    let (i, orbits) = apart
        .iter()
        .find_map(|&(_, i)| exact(i).ok().map(|orbits| (i, orbits)))
        .expect("two periodic motions");
    println!(
        "\nat {:.2} Hz: amplitude in µm, events per period, largest multiplier",
        at(i)
    );
    let amplitudes = orbits.each_ref().map(|orbit| {
        let (low, high) = orbit.extremes(1);
        let (events, largest) = (orbit.events().len(), orbit.multipliers()[0].norm());
        println!("  {:7.3}   {events:3}   {largest:.6}", 0.5e6 * (high - low));
        high - low
    });
    assert!(amplitudes[0] > 1.2 * amplitudes[1] && orbits[1].is_stable());
    Ok(())
}
