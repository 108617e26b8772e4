//! From a measured vibration back to the friction law: which static coefficient, and which speed of
//! least friction, give the measured period, amplitude and time in stick?
//!
//! What to learn from it:
//!
//! * period and amplitude alone do not determine two parameters: here two quite different laws give
//!   the same period and amplitude, to the last digit. The time in stick distinguishes these laws,
//!   and is as easy to measure;
//! * the computation of a limit cycle takes about ten microseconds and is exact to rounding.
//!   Sensitivities can therefore be computed as differences of cycles, to nine digits. With them
//!   Newton's method converges quadratically; started from hundreds of guesses, it finds the laws
//!   that fit;
//! * the errors of the measurement determine the errors of the parameters.
//!
//! Here all quantities are dimensionless. For measurements in SI units, replace `MassOnBelt` by
//! `PhysicalMassOnBelt`; nothing else changes.
//!
//! Run it with `cargo run --release -p stick-slip-examples --example calibration`.

use stick_slip::nalgebra::{Matrix2, Matrix3x2, Vector2, Vector3};
use stick_slip::{Error, MassOnBelt, Polynomial, limit_cycle};

// What is known of the machine and of its law.
const BELT_VELOCITY: f64 = 0.2;
const DAMPING: f64 = 0.05;
const LEAST_COEFFICIENT: f64 = 0.25;

// What was measured, and with which errors.
const MEASURED: [f64; 3] = [6.91946, 0.29968, 1.787];
const ERRORS: [f64; 3] = [1e-3, 1e-4, 5e-3];
const NAMES: [&str; 3] = ["period T", "amplitude", "stick time"];

/// Half the difference of the parameter in a sensitivity, relative to the parameter. The error of
/// the sensitivity is about its square, plus 1e-14 divided by it.
const STEP: f64 = 1e-5;

type Parameters = Vector2<f64>;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("known: polynomial law with least coefficient 0.25; β = 0.05, γ² = 1, v_b = 0.2");
    println!("measured:");
    for ((name, value), error) in NAMES.iter().zip(MEASURED).zip(ERRORS) {
        println!("  {name:<12} {value:8.4} ± {error}");
    }

    let measured = Vector3::from(MEASURED);
    let mut laws: Vec<Parameters> = Vec::new();
    for i in 0..8 {
        for k in 0..10 {
            let start = Vector2::new(0.3 + 0.04 * f64::from(i), 0.15 + 0.1 * f64::from(k));
            let Some(law) = with_period_and_amplitude(measured, start)? else {
                continue;
            };
            if laws.iter().all(|other| (other - law).norm() > 1e-6) {
                laws.push(law);
            }
        }
    }
    laws.sort_by(|a, b| b.y.total_cmp(&a.y));
    println!("\nlaws with this period and this amplitude:");
    println!(
        "  {:>12} {:>12}   {:>16} {:>16} {:>12}",
        "μ_s", "v_m", NAMES[0], NAMES[1], NAMES[2]
    );
    let mut best: Option<(f64, Parameters)> = None;
    for law in laws {
        let Some(vibration) = vibration(law)? else {
            continue;
        };
        let [period, amplitude, stick] = vibration.into();
        println!(
            "  {:12.8} {:12.8}   {period:16.12} {amplitude:16.12} {stick:12.6}",
            law.x, law.y
        );
        let apart = (stick - measured.z).abs();
        if best.is_none_or(|(least, _)| apart < least) {
            best = Some((apart, law));
        }
    }
    let Some((_, start)) = best else {
        return Err("no law vibrates like this".into());
    };

    // The best compromise of all three, each weighted by its error.
    let weights = Vector3::from(ERRORS.map(|error| error.powi(-2)));
    let weighted = |jacobian: &Matrix3x2<f64>| {
        let mut weighted = *jacobian;
        for (mut row, weight) in weighted.row_iter_mut().zip(&weights) {
            row *= *weight;
        }
        weighted
    };
    let mut law = start;
    for _ in 0..10 {
        let (Some(now), Some(jacobian)) = (vibration(law)?, sensitivities(law)?) else {
            return Err("the vibration has ended".into());
        };
        let normal: Matrix2<f64> = weighted(&jacobian).transpose() * jacobian;
        let step = weighted(&jacobian).transpose() * (measured - now);
        law += normal
            .lu()
            .solve(&step)
            .ok_or("the parameters cannot be told apart")?;
    }
    let jacobian = sensitivities(law)?.ok_or("the vibration has ended")?;
    println!("\nsensitivities (central differences, accurate to about 1e-9):");
    println!("  {:<12} {:>12} {:>12}", "", "by μ_s", "by v_m");
    for (name, row) in NAMES.iter().zip(jacobian.row_iter()) {
        println!("  {name:<12} {:12.6} {:12.6}", row[0], row[1]);
    }
    let covariance = (weighted(&jacobian).transpose() * jacobian)
        .try_inverse()
        .ok_or("the parameters cannot be told apart")?;
    println!("\nthe law that fits all three measured values best:");
    for (name, i) in [("μ_s", 0), ("v_m", 1)] {
        println!(
            "  {name} = {:.4} ± {:.4}",
            law[i],
            covariance[(i, i)].sqrt()
        );
    }
    Ok(())
}

/// Period, amplitude and time in stick for μ_s and v_m; `None` if there is no such law, or if the
/// mass does not stick.
fn vibration(parameters: Parameters) -> Result<Option<Vector3<f64>>, Error> {
    let Ok(law) = Polynomial::new(parameters.x, LEAST_COEFFICIENT, parameters.y) else {
        return Ok(None);
    };
    let system = MassOnBelt::new(law, BELT_VELOCITY)?.with_damping(DAMPING)?;
    let cycle = limit_cycle::stick_slip(&system)?;
    Ok(cycle.map(|it| Vector3::new(it.period(), it.amplitude(), it.stick_duration())))
}

/// The derivatives of period, amplitude and stick time by μ_s and v_m.
fn sensitivities(parameters: Parameters) -> Result<Option<Matrix3x2<f64>>, Error> {
    let mut jacobian = Matrix3x2::zeros();
    for i in 0..2 {
        let mut shift = Parameters::zeros();
        shift[i] = STEP * parameters[i];
        let ends = [
            vibration(parameters + shift)?,
            vibration(parameters - shift)?,
        ];
        let [Some(above), Some(below)] = ends else {
            return Ok(None);
        };
        jacobian.set_column(i, &((above - below) / (2.0 * shift[i])));
    }
    Ok(Some(jacobian))
}

/// Parameters that give the measured period and amplitude, by Newton's method from a start; `None`
/// if it does not converge.
fn with_period_and_amplitude(
    measured: Vector3<f64>,
    start: Parameters,
) -> Result<Option<Parameters>, Error> {
    let mut law = start;
    for _ in 0..30 {
        let (Some(now), Some(jacobian)) = (vibration(law)?, sensitivities(law)?) else {
            return Ok(None);
        };
        let missing = (measured - now).fixed_rows::<2>(0).into_owned();
        let rates = jacobian.fixed_rows::<2>(0).into_owned();
        let Some(step) = rates.lu().solve(&missing) else {
            return Ok(None);
        };
        // Steps are limited to the region in which the law is valid.
        law += step * (0.3 * law.norm() / step.norm()).min(1.0);
        if step.norm() < 1e-12 {
            return Ok(Some(law));
        }
    }
    Ok(None)
}
