//! Squeal of an elastic pad on an elastic rotating disc, in SI units: the threshold at which steady
//! sliding begins to flutter, and the limit cycle above this threshold.
//!
//! What to learn from it:
//!
//! * the pad is a rigid block whose centre of mass lies above its rubbing face. In coordinates of
//!   the face its mass matrix is full (`with_mass_matrix`), like the mass matrix of a reduced
//!   finite-element model;
//! * the contact is between pad and disc. The rotation of the disc enters as the belt velocity of
//!   the contact, and the load depends on the normal spring between pad and disc;
//! * friction makes the stiffness matrix unsymmetric. Two modes merge, and above a threshold of the
//!   coefficient one of them grows, although the coefficient does not fall with speed;
//! * the growth ends in stick-slip. Near the threshold the frequency of the cycle equals that of
//!   the eigenvalue; farther above the threshold the two frequencies differ.
//!
//! ```text
//!            ▒▒▒ back plate, stiffness k_y on each side            y, z   normal, towards the disc
//!        ┌───┴───┐
//!  k_x ──┤  pad  │ φ        coordinates x, y, φ of the pad's face, s, z of the disc
//!        └───┬───┘
//!     ═══════╧════════ disc ──▶ V        N = N0 + k_n (y − z)
//! ```
//!
//! Source of the mechanism: N. Hoffmann, M. Fischer, R. Allgaier, L. Gaul, Mech. Res. Commun. 29
//! (2002) 197-205. The numbers are typical values.
//!
//! Run it with `cargo run --release -p stick-slip-examples --example brake_squeal`.

use std::f64::consts::TAU;

use stick_slip::nalgebra::{DMatrix, RowVector5};
use stick_slip::orbit::{self, Period};
use stick_slip::structure::State;
use stick_slip::{Contact, Coulomb, Error, EventKind, Structure};

/// The pad: mass in kg, moment of inertia in kg·m², and the distances in metres of its centre of
/// mass above the face and behind the middle of the springs.
const PAD: f64 = 0.4;
const INERTIA: f64 = 1e-4;
const HEIGHT: f64 = 0.008;
const BEHIND: f64 = 0.003;
/// Springs of the pad in N/m: along the face, at half the height; normal, one at each side.
const ALONG: f64 = 1e8;
const BACK: f64 = 2e7;
const SIDE: f64 = 0.02;
/// The lining, as a normal spring and a spring against tilting.
const LINING: f64 = 5e7;
/// The disc's two modes: modal masses in kg and angular frequencies in rad/s, in its plane and
/// across.
const DISC: [(f64, f64); 2] = [(1.2, 2.0e4), (0.8, 1.2e4)];
/// Damping matrix divided by stiffness matrix, in s; damping ratios are near 1 %.
const DAMPING: f64 = 1e-6;
/// Clamp force in newtons and speed of the disc in m/s.
const CLAMP: f64 = 3000.0;
const SPEED: f64 = 0.02;

/// Coordinates.
const X: usize = 0;
const Y: usize = 1;
const S: usize = 3;
const Z: usize = 4;

/// Adds a mass, or a spring, that moves or stretches by row·q.
fn add(matrix: &mut DMatrix<f64>, value: f64, row: [f64; 5]) {
    let row = RowVector5::from(row);
    *matrix += value * row.transpose() * row;
}

fn brake(coefficient: f64) -> Result<Structure, Error> {
    let mut mass = DMatrix::zeros(5, 5);
    add(&mut mass, PAD, [1.0, 0.0, -HEIGHT, 0.0, 0.0]);
    add(&mut mass, PAD, [0.0, 1.0, -BEHIND, 0.0, 0.0]);
    add(&mut mass, INERTIA, [0.0, 0.0, 1.0, 0.0, 0.0]);
    let mut stiffness = DMatrix::zeros(5, 5);
    add(&mut stiffness, ALONG, [1.0, 0.0, -0.5 * HEIGHT, 0.0, 0.0]);
    add(&mut stiffness, BACK, [0.0, 1.0, SIDE, 0.0, 0.0]);
    add(&mut stiffness, BACK, [0.0, 1.0, -SIDE, 0.0, 0.0]);
    add(&mut stiffness, LINING, [0.0, 1.0, 0.0, 0.0, -1.0]);
    let tilting = LINING * SIDE * SIDE / 3.0;
    add(&mut stiffness, tilting, [0.0, 0.0, 1.0, 0.0, 0.0]);
    for (i, (modal, frequency)) in [S, Z].into_iter().zip(DISC) {
        mass[(i, i)] = modal;
        stiffness[(i, i)] += modal * frequency * frequency;
    }
    let contact = Contact::between(X, S, Coulomb::new(coefficient, coefficient)?, CLAMP)?
        .with_load_gradient(Y, LINING)?
        .with_load_gradient(Z, -LINING)?
        .on_belt(SPEED);
    Structure::with_mass_matrix(mass)?
        .with_damping(&stiffness * DAMPING)?
        .with_stiffness(stiffness)?
        .with_contact(contact)
}

/// The eigenvalue that grows fastest: its growth rate in 1/s and its frequency in Hz.
fn growth(coefficient: f64) -> Result<(f64, f64), Error> {
    let fastest = brake(coefficient)?.steady_sliding()?.eigenvalues[0];
    Ok((fastest.re, fastest.im.abs() / TAU))
}

fn main() -> Result<(), Error> {
    let mut range = [0.1, 0.3];
    assert!(growth(range[0])?.0 < 0.0 && growth(range[1])?.0 > 0.0);
    for _ in 0..50 {
        let middle = 0.5 * (range[0] + range[1]);
        range[usize::from(growth(middle)?.0 > 0.0)] = middle;
    }
    let threshold = range[1];
    let (rate, frequency) = growth(threshold)?;
    println!("flutter above μ = {threshold:.9}, at {frequency:.3} Hz");
    assert!(rate.abs() < 1e-6 * frequency);

    println!("\n    μ      growth 1/s   eigenvalue Hz   limit cycle Hz   face mm/s   least load N");
    let mut apart = Vec::new();
    for coefficient in [0.1, 0.15, 0.2, 0.22, 0.25, 0.3, 0.4] {
        let brake = brake(coefficient)?;
        let steady = brake.steady_sliding()?;
        let (rate, frequency) = growth(coefficient)?;
        print!("  {coefficient:5.3}   {rate:10.3}    {frequency:11.3}");
        assert_eq!(coefficient > threshold, rate > 0.0);
        if steady.is_stable() {
            println!("     silent");
            continue;
        }
        // A small perturbation of steady sliding, and time to grow.
        let mut start = State::new(&steady.displacements, &[0.0; 5]);
        start.velocities[Y] = 1e-3 * SPEED;
        let squeal = orbit::settle(&brake, &start, 0.4, Period::Free(1.0 / frequency))?;
        let heard = 1.0 / squeal.period();
        let (slow, fast) = squeal.velocity_extremes(Y);
        let loads = squeal.trajectory().sample(1000);
        let loads =
            loads.map(|(time, state)| brake.contacts()[0].load_at(time, &state.displacements));
        let least = loads.fold(f64::INFINITY, f64::min);
        println!(
            "     {heard:11.3}    {:10.3}   {least:10.1}",
            0.5e3 * (fast - slow)
        );
        assert!(squeal.is_stable() && least > 0.0);
        let kinds = squeal.events().iter().map(|event| event.kind);
        assert_eq!(kinds.filter(|&kind| kind == EventKind::Stick).count(), 1);
        apart.push((heard / frequency - 1.0).abs());
    }
    // Near the threshold the cycle is close to the unstable eigenvector.
    assert!(apart.is_sorted() && apart[0] < 1e-4 && apart[apart.len() - 1] < 1e-2);
    Ok(())
}
