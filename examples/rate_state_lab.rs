//! A laboratory slider under rate-and-state friction: velocity steps, holds, and the law found
//! again from a noisy record.
//!
//! What to learn from it:
//!
//! * the machine drives the base plate by a programme (`Drive::profile`), and a load cell, the
//!   spring k, holds the block and measures the friction coefficient kq/N. The motor takes a
//!   millisecond to change its speed;
//! * no machine is as stiff as the formulas of `analysis::rate_state` suppose: the block lags
//!   behind a step and creeps during a hold. A coefficient a read off the peak is too small, and
//!   healing comes near Dieterich's β = b only in long holds. So the machine must be part of a fit;
//! * `orbit::sensitivities` gives the derivatives J of the motion by the coefficients. With them
//!   Gauss-Newton finds the law in a few steps, and the covariance σ²(JᵀJ)⁻¹, with the variance σ²
//!   of the residuals, gives the intervals. For a method that converges from farther off see `fit`.
//!
//! ```text
//! m q'' = −k q + N f(V, θ),   V = w(t) − q',   f = a arsinh(V/(2V₀) e^((f₀ + bφ)/a))
//! φ = ln(V₀θ/D_c),   θ' = 1 − Vθ/D_c
//! ```
//!
//! Run it with `cargo run --release -p stick-slip-examples --example rate_state_lab`.

use stick_slip::analysis::rate_state::{healing, velocity_step};
use stick_slip::nalgebra::{DMatrix, DVector};
use stick_slip::orbit::sensitivities;
use stick_slip::structure::State;
use stick_slip::{Contact, Drive, Error, RateState, Structure};

// The machine: kilograms, newtons per metre, newtons, and the seconds of a change of speed.
const MASS: f64 = 20.0;
const STIFFNESS: f64 = 1e7;
const LOAD: f64 = 1e4;
const RAMP: f64 = 1e-3;

/// The reference speed V₀, in metres per second; and metres in a micrometre.
const MICRO: f64 = 1e-6;

// The law: f₀, a, b and D_c in micrometres.
const NAMES: [&str; 4] = ["f0", "a", "b", "D_c [µm]"];
const TRUTH: [f64; 4] = [0.62, 0.010, 0.014, 15.0];
const GUESS: [f64; 4] = [0.6, 0.012, 0.018, 20.0];

/// What the plate does: parts with their seconds and micrometres per second.
type Programme = [(f64, f64)];
const STEPS: &Programme = &[(10.0, 1.0), (30.0, 10.0), (200.0, 1.0)];

// Samples per second to find a peak, and to fit; and the standard deviation of the latter.
const FINE: f64 = 20.0;
const RATE: f64 = 2.0;
const NOISE: f64 = 3e-4;

fn law(p: &[f64]) -> Result<RateState, Error> {
    RateState::aging(p[0], p[1], p[2], MICRO * p[3], MICRO)
}

fn duration(programme: &Programme) -> f64 {
    programme.iter().map(|(seconds, _)| seconds).sum()
}

/// The block in steady sliding at the first speed of a programme.
fn slider(law: RateState, programme: &Programme) -> Result<(Structure, State), Error> {
    let first = MICRO * programme[0].1;
    let mut points = vec![(0.0, first)];
    let mut time = 0.0;
    for (seconds, speed) in programme {
        points.push((time + RAMP, MICRO * speed));
        time += seconds;
        points.push((time, MICRO * speed));
    }
    let contact = Contact::new(0, law, LOAD)?.on_belt(Drive::profile(&points)?);
    let structure = Structure::new(&[MASS])?
        .with_ground_spring(0, STIFFNESS)?
        .with_contact(contact)?;
    let start = State::new(&[LOAD * law.steady(first) / STIFFNESS], &[0.0])
        .with_memory(&[law.memory_at(first)])
        .with_sliding(0, -first);
    Ok((structure, start))
}

fn times(programme: &Programme, rate: f64) -> impl Iterator<Item = f64> {
    (0..(duration(programme) * rate) as usize).map(move |k| k as f64 / rate)
}

/// What the load cell measures.
fn coefficient(state: &State) -> f64 {
    STIFFNESS / LOAD * state.displacements[0]
}

fn record(programme: &Programme, rate: f64) -> Result<Vec<f64>, Error> {
    let (structure, start) = slider(law(&TRUTH)?, programme)?;
    let motion = structure.simulate(start, duration(programme))?;
    let states = motion.sample_at(times(programme, rate));
    Ok(states.map(|(_, state)| coefficient(&state)).collect())
}

fn largest(seen: &[f64]) -> f64 {
    seen.iter().copied().fold(0.0, f64::max)
}

struct Fit {
    found: [f64; 4],
    errors: [f64; 4],
    /// The standard deviation of the residuals.
    deviation: f64,
}

/// The coefficients with the least sum of squares, and their standard errors.
fn fit(seen: &[f64]) -> Result<Fit, Box<dyn std::error::Error>> {
    let mut found = GUESS;
    for _ in 0..20 {
        let motion = sensitivities(|p| slider(law(p)?, STEPS), &found, duration(STEPS))?;
        let mut residuals = DVector::zeros(seen.len());
        let mut slopes = DMatrix::zeros(seen.len(), found.len());
        for (i, time) in times(STEPS, RATE).enumerate() {
            residuals[i] = seen[i] - coefficient(&motion.state_at(time).ok_or("no state")?);
            // Row 0: the displacement.
            let by = motion.at(time).ok_or("no derivative")?;
            slopes.set_row(i, &(STIFFNESS / LOAD * by.row(0)));
        }
        let variance = residuals.norm_squared() / (seen.len() - found.len()) as f64;
        let inverse = slopes.tr_mul(&slopes).try_inverse().ok_or("singular")?;
        let change = &inverse * slopes.tr_mul(&residuals);
        let errors = std::array::from_fn(|j| (variance * inverse[(j, j)]).sqrt());
        if (0..4).all(|j| change[j].abs() < 0.01 * errors[j]) {
            return Ok(Fit {
                found,
                errors,
                deviation: variance.sqrt(),
            });
        }
        found = std::array::from_fn(|j| found[j] + change[j]);
    }
    Err("no convergence".into())
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let truth = law(&TRUTH)?;
    let [slow, fast] = [MICRO, 10.0 * MICRO];
    let before = truth.steady(slow);

    println!("step from 1 to 10 µm/s: change of the coefficient over ln 10");
    println!("          this machine   rigid machine");
    let seen = record(&STEPS[..2], FINE)?;
    let peak = [largest(&seen), velocity_step(&truth, slow, fast, 0.0)];
    let later = [seen[seen.len() - 1], truth.steady(fast)];
    for (name, after) in [("peak", peak), ("later", later)] {
        let [here, rigid] = after.map(|after| (after - before) / 10_f64.ln());
        println!("  {name:<7} {here:12.6} {rigid:15.6}");
    }

    println!("\nholds: healing Δμ, and its slope β over ln of the time in the last decade");
    println!("             this machine         rigid machine");
    println!("  seconds     Δμ        β          Δμ        β");
    let healed = |hold: f64| -> Result<[f64; 2], Error> {
        let seen = record(&[(10.0, 1.0), (hold, 0.0), (200.0, 1.0)], FINE)?;
        Ok([largest(&seen) - before, healing(&truth, hold)])
    };
    for hold in [1e2, 1e3, 1e4] {
        let [[here, rigid], [sooner, rigid_sooner]] = [healed(hold)?, healed(0.1 * hold)?];
        let [beta, rigid_beta] = [here - sooner, rigid - rigid_sooner].map(|by| by / 10_f64.ln());
        println!("  {hold:6}  {here:.5} {beta:9.5}   {rigid:.5} {rigid_beta:9.5}");
    }

    // Nearly normal noise, the same in every run: sums of twelve uniform numbers, by Knuth's linear
    // congruential generator.
    let mut seed = 2_u64;
    let mut uniform = |_| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005);
        seed = seed.wrapping_add(1_442_695_040_888_963_407);
        (seed >> 11) as f64 * 0.5_f64.powi(53)
    };
    let mut seen = record(STEPS, RATE)?;
    for sample in &mut seen {
        *sample += NOISE * ((0..12).map(&mut uniform).sum::<f64>() - 6.0);
    }
    let fit = fit(&seen)?;
    print!("\n{} samples with noise of {NOISE}; ", seen.len());
    println!("residuals {:.2e}", fit.deviation);
    println!("              truth     guess    95 % interval");
    for j in 0..4 {
        let [low, high] = [-1.96, 1.96].map(|width| fit.found[j] + width * fit.errors[j]);
        println!(
            "  {:<9} {:7.3} {:9.3} {low:11.5} to {high:8.5}",
            NAMES[j], TRUTH[j], GUESS[j]
        );
        if !(low..=high).contains(&TRUTH[j]) {
            return Err(format!("{} lies outside its interval", NAMES[j]).into());
        }
    }
    Ok(())
}
