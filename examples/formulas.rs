//! The amplitude formulas of A. Farshidianfar and N. Noei Aghaee, and more accurate formulas,
//! compared with the exact motion over the belt velocities of their Fig. 6.
//!
//! What to learn from it:
//!
//! * A0 (Eq. 15), for vibration that never sticks, has an error of up to 2 %; the fourth-order
//!   formulas of `PureSlip` have an error of up to 0.1 %;
//! * A1 (Eq. 18), for vibration that sticks, is too small by up to 40 %, because it neglects the
//!   energy that the mass gains during slip. The second-order formulas of `StickSlip` have an error
//!   of up to 3 %;
//! * above v_b1 steady sliding is stable and there is no vibration. The paper's "beyond this range"
//!   is true only below v_b0;
//! * the order of the error decides the quality of a formula. If friction and damping are halved,
//!   the error of A1 falls by the factor 2, the error of A0 by 4, and the errors of the corrected
//!   formulas by 8 with stick and by 16 without stick.
//!
//! Run it with `cargo run --release -p stick-slip-examples --example formulas`.

use stick_slip::analysis::{PureSlip, Regime, StickSlip, regime};
use stick_slip::{Error, MassOnBelt, Polynomial, limit_cycle};

/// γ² = 1, v_m = 0.5, μ_s = 0.4, μ_m = 0.25, β = 0.05, all friction and damping times `epsilon`.
fn paper(v_b: f64, epsilon: f64) -> Result<MassOnBelt<Polynomial>, Error> {
    let law = Polynomial::new(0.4, 0.25, 0.5)?;
    MassOnBelt::new(law, v_b)?
        .with_damping(0.05 * epsilon)?
        .with_load(epsilon)
}

/// Half the range of u: by the paper's formula and by the corrected formula.
fn formulas(system: &MassOnBelt<Polynomial>) -> [Option<f64>; 2] {
    match regime(system) {
        Regime::PureSlip => {
            let formulas = PureSlip::new(system);
            let better = formulas.and_then(|f| f.fourth_order());
            [
                formulas.and_then(|f| f.amplitude()),
                better.map(|cycle| cycle.amplitude),
            ]
        }
        Regime::StickSlip => {
            let formulas = StickSlip::new(system);
            let better = formulas.as_ref().and_then(|f| f.second_order());
            [
                formulas.map(|f| f.amplitude()),
                better.map(|cycle| 0.5 * (cycle.u_max - cycle.u_min)),
            ]
        }
        _ => [None, None],
    }
}

fn main() -> Result<(), Error> {
    if let Some(borders) = PureSlip::new(&paper(0.4, 1.0)?) {
        println!("Fig. 6: γ² = 1, v_m = 0.5, μ_s = 0.4, μ_m = 0.25, β = 0.05");
        for (name, velocity) in [
            (
                "v_b0, stick-slip below it, by averaging",
                borders.stick_velocity(),
            ),
            ("the same, with its next term", borders.grazing_velocity()),
            ("v_b1, steady sliding above it", borders.onset_velocity()),
        ] {
            println!("  {name:<40} {}", number(velocity));
        }
    }
    println!(
        "\namplitude (u_max − u_min)/2; A1 where the mass sticks, A0 where it does not; \
         relative errors"
    );
    println!(
        "  {:>5}  {:<10} {:>10} {:>10} {:>9} {:>10} {:>9}",
        "v_b", "motion", "exact", "A0, A1", "error", "corrected", "error"
    );
    for k in 1..=10 {
        row(0.04 * f64::from(k), 1.0)?;
    }
    for v_b in [0.41, 0.42, 0.43, 0.44, 0.46, 0.50] {
        row(v_b, 1.0)?;
    }
    for v_b in [0.2, 0.42] {
        println!("\nv_b = {v_b}: γ² = ε, β = 0.05 ε");
        for k in 0..4 {
            print!("  ε = {:<5}", 0.5_f64.powi(k));
            row(v_b, 0.5_f64.powi(k))?;
        }
    }
    Ok(())
}

fn row(v_b: f64, epsilon: f64) -> Result<(), Error> {
    let system = paper(v_b, epsilon)?;
    let cycles = limit_cycle::find(&system)?;
    let cycle = cycles.stable().next();
    let exact = cycle.map(|cycle| cycle.amplitude());
    let motion = cycle.map_or("quiet".to_string(), |cycle| cycle.kind().to_string());
    let [by_paper, corrected] = formulas(&system);
    println!(
        "  {v_b:>5.2}  {motion:<10} {} {} {} {} {}",
        number(exact),
        number(by_paper),
        error(by_paper, exact),
        number(corrected),
        error(corrected, exact)
    );
    Ok(())
}

fn number(value: Option<f64>) -> String {
    value.map_or(format!("{:>10}", "-"), |value| format!("{value:10.6}"))
}

/// Relative error.
fn error(value: Option<f64>, exact: Option<f64>) -> String {
    match (value, exact) {
        (Some(value), Some(exact)) => format!("{:9.1e}", value / exact - 1.0),
        _ => format!("{:>9}", "-"),
    }
}
