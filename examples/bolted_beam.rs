//! A beam that is pressed by springs on six elastic pads, one of them loosely. The vibration under
//! a harmonic force is followed through its second resonance, which bends because the loose pad
//! opens. A free decay gives the damping over the amplitude.
//!
//! What to learn from it:
//!
//! * a reduced model is given by its matrices. Here its coordinates are 13 bending and 7 axial
//!   shapes of a beam with a step in its thickness, so M and K are full. A contact is given by two
//!   rows of shape functions: the displacement of the surface along the pad, and the displacement
//!   into the pad;
//! * each pad is an elastic contact with a normal spring. Up to an amplitude all pads stick, and
//!   the beam is linear. Above it the loose pad slips and opens, and the frequency falls. At large
//!   amplitudes the other pads slip, too, and damp the vibration;
//! * `orbit::follow` starts above the resonance, where there is one motion, and finds all motions
//!   connected with it, through two folds and into the linear range. Between the folds there are
//!   three motions at each frequency, and the middle one is unstable: neither sweeps nor
//!   simulations reach it;
//! * the folds are computed to round-off, not read from a curve.
//!
//! Run it with `cargo run --release -p stick-slip-examples --example bolted_beam`; it takes half a
//! minute. With a file name after `--`, it writes the curves of three forces to this file instead,
//! which takes some minutes. The package `examples/figures` draws such a file,
//! `examples/figures/bolted_beam.csv`.

use std::f64::consts::{PI, TAU};
use std::ops::Range;

use stick_slip::nalgebra::{DMatrix, DVector};
use stick_slip::orbit::{self, BifurcationKind, Branch, BranchPoint, Period, Search};
use stick_slip::structure::State;
use stick_slip::{Contact, Coulomb, Drive, Error, Integrator, Segment, Structure};

// Steel, in metres, kilograms and seconds.
const LENGTH: f64 = 0.4;
const WIDTH: f64 = 0.03;
const MODULUS: f64 = 210e9;
const DENSITY: f64 = 7850.0;
/// Thickness up to the middle, and beyond it.
const THICKNESS: [f64; 2] = [0.02, 0.018];
const BENDING: usize = 13;
const AXIAL: usize = 7;
pub(crate) const SHAPES: usize = BENDING + AXIAL;
/// Damping ratio of the second mode without pads.
const DAMPING: f64 = 0.0005;

// Of each pad.
const PADS: usize = 6;
const FRICTION: f64 = 0.3;
/// The bolt beside the fifth pad is loose.
const LOADS: [f64; PADS] = [300.0, 300.0, 300.0, 300.0, 20.0, 300.0];
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
    for (pad, load) in LOADS.into_iter().enumerate() {
        let [along, into] = rows(pad);
        for &(shape, d) in &into {
            pressed[shape] += load * d;
        }
        let contact = Contact::along(&along, Coulomb::new(FRICTION, FRICTION)?, load)?
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

/// Times and values of the maxima of the second bending shape. The steps are not kept: they would
/// fill half a gigabyte.
fn maxima(beam: &Structure, start: State, end: f64) -> Result<Vec<(f64, f64)>, Error> {
    let mut maxima = Vec::new();
    for step in Integrator::new().flow(beam, start)? {
        let step = step?;
        if step.start_time() >= end {
            break;
        }
        let [before, after] = [step.state(), &step.end_state()].map(|state| state.velocities[1]);
        if before > 0.0 && after <= 0.0 {
            let time = step.duration() * before / (before - after);
            let displacement = step.state_at(time).displacements[1];
            maxima.push((step.start_time() + time, displacement));
        }
    }
    Ok(maxima)
}

/// A free decay in the second mode, from an amplitude at which all pads open: amplitude, frequency
/// and damping ratio of windows of `window` periods. Each window begins `step` periods after the
/// window before.
pub(crate) fn decay(window: usize, step: usize) -> Result<Vec<[f64; 3]>, Error> {
    let (natural, shape) = second_mode().expect("the mass matrix is positive definite");
    let start: Vec<f64> = (&shape * 2.5e-4).iter().copied().collect();
    let start = State::new(&start, &[0.0; SHAPES]);
    let maxima = maxima(&beam(0.0, natural)?, start, 900.0 / natural)?;
    let windows = maxima.windows(window + 1).step_by(step).map(|part| {
        let (begin, end) = (part[0], part[window]);
        let frequency = window as f64 / (end.0 - begin.0);
        let ratio = (begin.1 / end.1).ln() / (window as f64 * TAU);
        [(begin.1 * end.1).sqrt(), frequency, ratio]
    });
    Ok(windows.collect())
}

/// Forces of the resonance curves of the figure.
pub(crate) const FORCES: [f64; 3] = [2.0, 3.0, FORCE];
/// Frequencies of the figure.
pub(crate) const WHOLE: Range<f64> = 1224.0..1234.0;

const FORCE: f64 = 4.0;
/// Frequencies around the folds.
const RANGE: Range<f64> = 1225.9..1229.8;
/// Periods after which the vibration is nearly periodic.
const TRANSIENT: f64 = 2000.0;

/// The resonance curve of a force, followed from the highest frequency, where the loose pad slips
/// in both directions, to at most so many other motions.
pub(crate) fn resonance(
    force: f64,
    range: Range<f64>,
    points: usize,
) -> Result<Branch<State>, Error> {
    let (highest, rest) = (range.end, State::at_rest(SHAPES));
    let system = beam(force, highest)?;
    let search = Search::new()
        .with_max_points(points)?
        .with_max_steps(10_000_000)?;
    let first = search.settle(&system, &rest, TRANSIENT / highest, Period::Driven(1))?;
    search.follow(|frequency| beam(force, frequency), highest, &first, range)
}

/// A point of a resonance curve: frequency, amplitude, and whether the motion is stable.
pub(crate) type Point = (f64, f64, bool);

pub(crate) fn points(branch: &Branch<State>) -> impl Iterator<Item = Point> {
    let points = branch.points.iter();
    points.map(
        |BranchPoint {
             parameter, orbit, ..
         }| { (*parameter, orbit.amplitude(1), orbit.is_stable()) },
    )
}

/// Writes the resonance curves of the figure, all at one time.
fn write(file: &str) -> Result<(), Box<dyn std::error::Error>> {
    let curves = std::thread::scope(|scope| {
        let most = Search::DEFAULT_MAX_POINTS;
        let running = FORCES.map(|force| {
            scope.spawn(move || Ok(points(&resonance(force, WHOLE, most)?).collect()))
        });
        running.map(|curve| curve.join().expect("no curve panics"))
    });
    let mut text = String::from("force in N,frequency in Hz,amplitude in m,stable\n");
    for (force, curve) in FORCES.into_iter().zip(curves) {
        let curve: Result<Vec<Point>, Error> = curve;
        for (frequency, amplitude, is_stable) in curve? {
            text += &format!("{force},{frequency:.9},{amplitude:.9e},{is_stable}\n");
        }
    }
    std::fs::write(file, text)?;
    Ok(())
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    if let Some(file) = std::env::args().nth(1) {
        return write(&file);
    }
    let (natural, _) = second_mode().expect("the mass matrix is positive definite");
    println!("second mode, pads closed and stuck: {natural:.2} Hz");

    println!("\nfree decay: amplitude in µm, frequency in Hz, damping ratio");
    let mut ratios = Vec::new();
    for [amplitude, frequency, ratio] in decay(40, 40)? {
        println!("  {:6.1}   {frequency:8.2}   {ratio:.5}", 1e6 * amplitude);
        ratios.push((frequency, ratio));
    }
    let (first, last) = (ratios[0], ratios[ratios.len() - 1]);
    // At the end all pads stick. Before, they lower the frequency, and the first ones damp it.
    assert!(first.0 < 0.99 * natural && (last.0 / natural - 1.0).abs() < 1e-3);
    assert!(first.1 > 1.5 * last.1);
    println!("\n{FORCE} N: frequency in Hz, amplitude in µm, events per period");
    let branch = resonance(FORCE, RANGE, Search::DEFAULT_MAX_POINTS)?;
    for BranchPoint {
        parameter, orbit, ..
    } in branch.points.iter().step_by(10)
    {
        let stable = if orbit.is_stable() { "" } else { "   unstable" };
        let (amplitude, events) = (1e6 * orbit.amplitude(1), orbit.events().len());
        println!("  {parameter:10.4}   {amplitude:8.4}   {events:2}{stable}");
    }
    println!("\nthe curve turns back: frequency in Hz, amplitude in µm, |multiplier − 1|");
    let folds = branch.bifurcations.iter();
    let folds: Vec<_> = folds
        .filter(|at| at.kind == BifurcationKind::Fold)
        .collect();
    for fold in &folds {
        let multipliers = fold.orbit.multipliers().iter();
        let apart = multipliers.map(|multiplier| (multiplier - 1.0).norm());
        let apart = apart.fold(f64::INFINITY, f64::min);
        let amplitude = 1e6 * fold.orbit.amplitude(1);
        println!("  {:.7}   {amplitude:.6}   {apart:.0e}", fold.parameter);
        assert!(apart < 1e-6);
    }
    let [upper, lower] = folds[..] else {
        panic!("two folds")
    };

    // All motions at one frequency between them, each found from the nearest point of the curve.
    let middle = 0.5 * (upper.parameter + lower.parameter);
    println!("\nat {middle:.4} Hz: amplitude in µm, events per period, largest multiplier");
    let system = beam(FORCE, middle)?;
    let crossings = branch.points.windows(2).filter(|pair| {
        let [one, other] = [0, 1].map(|i| pair[i].parameter < middle);
        one != other
    });
    let motions: Vec<_> = crossings
        .map(|pair| orbit::shoot(&system, &pair[0].orbit.state(), Period::Driven(1)))
        .collect::<Result<_, _>>()?;
    for orbit in &motions {
        let (events, largest) = (orbit.events().len(), orbit.multipliers()[0].norm());
        println!(
            "  {:9.6}   {events}   {largest:.9}",
            1e6 * orbit.amplitude(1)
        );
    }
    assert!(
        motions
            .iter()
            .map(|orbit| orbit.is_stable())
            .eq([true, false, true])
    );
    assert!(motions.is_sorted_by_key(|orbit| orbit.amplitude(1)));
    Ok(())
}
