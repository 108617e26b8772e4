//! From a file of measured friction coefficients to the vibration of a machine.
//!
//! What to learn from it:
//!
//! * `Tabulated` takes points (speed, coefficient), the first at speed 0. The law goes through each
//!   point and does not oscillate between the points;
//! * speeds may be physical: `Scaling::system` converts them together with the machine;
//! * limit cycles take so little time that they can be computed for every run of the measurement.
//!   The results then show the effect of the scatter of the coefficient: here amplitudes differ by
//!   3 %, and the speed at which sliding becomes stable differs by 15 %, because it depends on the
//!   slope of the law.
//!
//! Run it with `cargo run --release -p stick-slip-examples --example measured_law`, or with
//! your own file (add `-- my.csv`) in the format of `examples/friction.csv`: lines that begin with
//! `#` are comments; then one line of headings, then speed in m/s and one column for each run.

use std::error::Error;
use std::process::ExitCode;

use stick_slip::{
    Error as LawError, FrictionLaw, Physical, Scaling, Tabulated, bifurcation, limit_cycle,
};

const SAMPLE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/friction.csv");

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<(), Box<dyn Error>> {
    let path = std::env::args().nth(1).unwrap_or_else(|| SAMPLE.into());
    let text = std::fs::read_to_string(&path).map_err(|error| format!("{path}: {error}"))?;
    let table = read(&text).map_err(|error| format!("{path}, {error}"))?;
    let runs = table.first().map_or(0, |row| row.runs.len());
    if let Some(Row { line, .. }) = table.iter().find(|row| row.runs.len() != runs) {
        return Err(
            format!("{path}, line {line}: {runs} coefficients are needed, as above").into(),
        );
    }
    // The points of a law; an error names the line of a bad point.
    let law = |coefficient: &dyn Fn(&Row) -> f64| {
        let points = table.iter().map(|row| (row.speed, coefficient(row)));
        Tabulated::new(points).map_err(|error| match &error {
            LawError::BadPoint { index, .. } => {
                format!("{path}, line {}: {error}", table[*index].line)
            }
            _ => format!("{path}: {error}"),
        })
    };
    println!("{} speeds, {runs} runs", table.len());

    let scaling = Scaling::new(Physical {
        mass: 4.0,           // kg
        stiffness: 1.0e6,    // N/m
        damping: 100.0,      // N·s/m
        normal_force: 800.0, // N
        belt_velocity: 0.03, // m/s
    })?;
    println!("4 kg on 1e6 N/m, 100 N·s/m, pressed with 800 N on a disc at 0.03 m/s\n");
    let columns = [
        "",
        "frequency",
        "amplitude",
        "sticking",
        "steady sliding is stable",
    ];
    let units = ["", "Hz", "mm", "%", "above, m/s"];
    for [name, frequency, amplitude, sticking, stable] in [columns, units] {
        println!("{name:<14} {frequency:>10} {amplitude:>10} {sticking:>10}   {stable}");
    }
    for run in 0..runs {
        show(
            &format!("run {}", run + 1),
            &scaling,
            law(&|row| row.runs[run])?,
        )?;
    }
    let mean = |runs: &[f64]| runs.iter().sum::<f64>() / runs.len() as f64;
    show("mean of runs", &scaling, law(&|row| mean(&row.runs))?)
}

fn show<L: FrictionLaw>(name: &str, scaling: &Scaling, law: L) -> Result<(), Box<dyn Error>> {
    let system = scaling.system(law)?;
    let fastest = system.law().breakpoints().fold(0.0, f64::max);
    let hopf = bifurcation::hopf_velocities(&system, 0.0..fastest)?;
    let hopf: Vec<String> = hopf
        .iter()
        .map(|&velocity| format!("{:.5}", scaling.metres_per_second(velocity)))
        .collect();
    for cycle in limit_cycle::find(&system)?.stable() {
        println!(
            "{name:<14} {:>10.4} {:>10.5} {:>10.3}   {}",
            1.0 / scaling.seconds(cycle.period()),
            1e3 * scaling.metres(cycle.amplitude()),
            100.0 * cycle.stick_duration() / cycle.period(),
            hopf.join(", ")
        );
        // Above the last point the table is constant, which is an assumption.
        let sliding = system.belt_velocity() - cycle.min_velocity();
        if sliding > fastest {
            println!("{name:<14} slides faster than the measured speeds");
        }
    }
    Ok(())
}

/// A speed, m/s, and the coefficients of all runs.
struct Row {
    line: usize,
    speed: f64,
    runs: Vec<f64>,
}

fn read(text: &str) -> Result<Vec<Row>, Box<dyn Error>> {
    let lines = (1..).zip(text.lines().map(str::trim));
    let rows = lines
        .filter(|(_, line)| !line.is_empty() && !line.starts_with('#'))
        .skip(1);
    rows.map(|(line, row)| {
        let numbers: Vec<f64> = row
            .split(',')
            .map(|number| number.trim().parse())
            .collect::<Result<_, _>>()
            .map_err(|error| format!("line {line}, {row:?}: {error}"))?;
        match numbers.split_first() {
            Some((&speed, runs)) if !runs.is_empty() => Ok(Row {
                line,
                speed,
                runs: runs.to_vec(),
            }),
            _ => {
                let needed = "a speed and at least one coefficient are needed";
                Err(format!("line {line}, {row:?}: {needed}").into())
            }
        }
    })
    .collect()
}
