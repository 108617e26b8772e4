//! A friction law from a measured vibration: three coefficients from two seconds of a noisy
//! displacement, sampled at 5 kHz, with their standard errors.
//!
//! What to learn from it:
//!
//! * `orbit::sensitivities` gives the derivatives of a motion with respect to any parameters,
//!   through stick and release. With these derivatives a least-squares method converges in a few
//!   steps; here it is the method of Levenberg and Marquardt, from the crate `levenberg-marquardt`;
//! * the same derivatives J give the standard errors: the covariance is σ² (JᵀJ)⁻¹, with the mean
//!   square σ² of the residuals. The standard errors agree with the true errors of this fit;
//! * over a long time a wrong law gives a wrong number of cycles, and the sum of squares has many
//!   minima. Fit a short time first, and start the fit of a longer time from the result;
//! * a velocity sensor is not sufficient: it does not measure the mean stretch of the spring, so
//!   μ_s and μ_k could rise together without any effect on its signal;
//! * the start is a parameter like any other. Fit every unknown quantity; otherwise its error
//!   changes the coefficients.
//!
//! Run it with `cargo run --release -p stick-slip-fit --example fit`.

use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt};
use nalgebra::{DMatrix, DVector, Dyn, Owned};
use stick_slip::orbit::{Sensitivities, sensitivities};
use stick_slip::structure::State;
use stick_slip::{Contact, Error, Exponential, Structure};

// What is known: kilograms, newtons per metre, newtons, metres per second.
const MASS: f64 = 1.2;
const STIFFNESS: f64 = 18e3;
const DAMPING: f64 = 6.0;
const LOAD: f64 = 60.0;
const BELT: f64 = 0.05;

// What is to be found: μ_s, μ_k, the speed v_s over which friction falls, and the first
// displacement.
const TRUTH: [f64; 4] = [0.42, 0.28, 0.08, 1.1e-3];
const NAMES: [&str; 4] = ["mu_s", "mu_k", "v_s [m/s]", "q(0) [m]"];

// The measurement.
const DURATION: f64 = 2.0;
/// The durations that are fitted one after another.
const STRETCHES: [f64; 3] = [0.1, 0.5, DURATION];
const RATE: f64 = 5e3;
const NOISE: f64 = 5e-5;

fn brake(p: &[f64]) -> Result<(Structure, State), Error> {
    let law = Exponential::new(p[0], p[1], p[2])?;
    let structure = Structure::new(&[MASS])?
        .with_ground_spring(0, STIFFNESS)?
        .with_ground_damper(0, DAMPING)?
        .with_contact(Contact::new(0, law, LOAD)?.on_belt(BELT))?;
    Ok((structure, State::new(&[p[3]], &[BELT])))
}

fn times(duration: f64) -> impl Iterator<Item = f64> {
    (1..=(duration * RATE) as usize).map(|k| k as f64 / RATE)
}

/// The displacement sensor: noise that is the same in every run, of nearly normal distribution (the
/// sum of twelve uniform numbers).
fn measured() -> Result<Vec<f64>, Error> {
    let (structure, start) = brake(&TRUTH)?;
    let motion = structure.simulate(start, DURATION)?;
    let mut seed = 1_u64;
    let mut noise = || {
        let uniform = |_| {
            // Knuth's linear congruential generator.
            seed = seed.wrapping_mul(6_364_136_223_846_793_005);
            seed = seed.wrapping_add(1_442_695_040_888_963_407);
            (seed >> 11) as f64 * 0.5_f64.powi(53)
        };
        (0..12).map(uniform).sum::<f64>() - 6.0
    };
    let states = times(DURATION).filter_map(|time| motion.state_at(time));
    Ok(states
        .map(|state| state.displacements[0] + NOISE * noise())
        .collect())
}

/// The problem for the least-squares method: parameters in units of their first guess.
struct Fit<'m> {
    measured: &'m [f64],
    duration: f64,
    guess: [f64; 4],
    parameters: DVector<f64>,
    /// `None` if the parameters of the brake are not valid.
    motion: Option<Sensitivities>,
}

impl Fit<'_> {
    fn values(&self) -> Vec<f64> {
        let parts = self.parameters.iter().zip(self.guess);
        parts.map(|(part, guess)| part * guess).collect()
    }
}

impl LeastSquaresProblem<f64, Dyn, Dyn> for Fit<'_> {
    type ResidualStorage = Owned<f64, Dyn>;
    type JacobianStorage = Owned<f64, Dyn, Dyn>;
    type ParameterStorage = Owned<f64, Dyn>;

    fn set_params(&mut self, parameters: &DVector<f64>) {
        self.parameters.copy_from(parameters);
        self.motion = sensitivities(brake, &self.values(), self.duration).ok();
    }

    fn params(&self) -> DVector<f64> {
        self.parameters.clone()
    }

    fn residuals(&self) -> Option<DVector<f64>> {
        let residual = |(time, measured): (f64, &f64)| {
            // If the law is not valid, the residual is so large that the step is shortened.
            let state = self
                .motion
                .as_ref()
                .and_then(|motion| motion.state_at(time));
            state.map_or(1e3, |state| state.displacements[0] - measured)
        };
        let residuals = times(self.duration).zip(self.measured).map(residual);
        Some(DVector::from_vec(residuals.collect()))
    }

    fn jacobian(&self) -> Option<DMatrix<f64>> {
        let motion = self.motion.as_ref()?;
        let count = times(self.duration).count();
        let mut jacobian = DMatrix::zeros(count, 4);
        for (i, time) in times(self.duration).enumerate() {
            // Row 0: the displacement.
            let slopes = motion.at(time)?;
            for j in 0..4 {
                jacobian[(i, j)] = slopes[(0, j)] * self.guess[j];
            }
        }
        Some(jacobian)
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let measured = measured()?;
    println!(
        "{} samples of the displacement, noise {NOISE} m",
        measured.len()
    );

    let guess = [0.4, 0.3, 0.1, 1e-3];
    let mut fit = Fit {
        measured: &measured,
        duration: 0.0,
        guess,
        parameters: DVector::from_element(4, 1.0),
        motion: None,
    };
    for duration in STRETCHES {
        fit.duration = duration;
        fit.set_params(&fit.params());
        let (found, report) = LevenbergMarquardt::new().with_stepbound(0.1).minimize(fit);
        fit = found;
        let evaluations = report.number_of_evaluations;
        println!(
            "{duration} s: {:?} after {evaluations} motions",
            report.termination
        );
        if !report.termination.was_successful() {
            return Err("no law fits".into());
        }
    }

    let residuals = fit.residuals().ok_or("no motion")?;
    let jacobian = fit.jacobian().ok_or("no derivative")?;
    let freedom = (measured.len() - guess.len()) as f64;
    let variance = residuals.norm_squared() / freedom;
    let covariance = (jacobian.transpose() * &jacobian)
        .try_inverse()
        .ok_or("singular")?
        * variance;
    println!("residual: {:.3e} m rms", variance.sqrt());
    println!(
        "{:<10} {:>9} {:>12} {:>10} {:>8}",
        "", "guess", "found", "± error", "off by"
    );
    for (j, value) in fit.values().into_iter().enumerate() {
        let error = covariance[(j, j)].sqrt() * guess[j];
        let off = (value - TRUTH[j]) / error;
        println!(
            "{:<10} {:9.4} {value:12.7} {error:10.1e} {off:8.2}",
            NAMES[j], guess[j]
        );
        if off.abs() > 4.0 {
            return Err(format!("{} is off by {off} standard errors", NAMES[j]).into());
        }
    }
    Ok(())
}
