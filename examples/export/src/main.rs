//! Reads a structure from JSON, simulates it, and writes its events and samples as CSV tables,
//! which Python, MATLAB and spreadsheets can read.
//!
//! Run it with `cargo run --release -p stick-slip-export -- examples/export/brake.json events.csv
//! samples.csv`. The names of fields are those of `stick_slip::schema`.

use std::fmt::Write;

use stick_slip::structure::{Sample, State};
use stick_slip::{Event, Structure};

type Failure = Box<dyn std::error::Error>;

/// What is read.
struct Task {
    structure: Structure,
    start: State,
    duration: f64,
    interval: f64,
}

impl Task {
    fn read(text: &str) -> Result<Self, Failure> {
        let mut text: serde_json::Value = serde_json::from_str(text)?;
        let number = |text: &serde_json::Value, name: &str| {
            let number = text[name].as_f64();
            number.ok_or_else(|| format!("`{name}` has to be a number"))
        };
        Ok(Self {
            duration: number(&text, "duration")?,
            interval: number(&text, "interval")?,
            structure: serde_json::from_value(text["structure"].take())?,
            start: serde_json::from_value(text["start"].take())?,
        })
    }
}

/// A row for each event: time, element, kind, and state.
fn events(n: usize, events: &[Event<State>]) -> Result<String, Failure> {
    let mut table = String::from("time,element,event");
    columns(&mut table, &[("q", n), ("v", n)])?;
    for Event {
        time,
        element,
        kind,
        state,
        ..
    } in events
    {
        write!(table, "\n{time},{element},{kind}")?;
        numbers(&mut table, &[&state.displacements, &state.velocities])?;
    }
    Ok(table + "\n")
}

/// A row for each sample: time, state, accelerations, and of each contact mode, friction and load.
fn samples(structure: &Structure, rows: impl Iterator<Item = Sample>) -> Result<String, Failure> {
    let (n, contacts) = (structure.len(), structure.contacts().len());
    let mut table = String::from("time");
    let of_contacts = [
        ("mode", contacts),
        ("friction", contacts),
        ("load", contacts),
    ];
    columns(&mut table, &[("q", n), ("v", n), ("a", n)])?;
    columns(&mut table, &of_contacts)?;
    for sample in rows {
        write!(table, "\n{}", sample.time)?;
        let state = &sample.state;
        let of_state = [
            &state.displacements,
            &state.velocities,
            &sample.accelerations,
        ];
        numbers(&mut table, &of_state.map(Vec::as_slice))?;
        for mode in &sample.modes {
            write!(table, ",{mode}")?;
        }
        numbers(&mut table, &[&sample.friction, &sample.loads])?;
    }
    Ok(table + "\n")
}

/// Names of columns: `q0`, `q1`, …
fn columns(table: &mut String, names: &[(&str, usize)]) -> std::fmt::Result {
    for (name, count) in names {
        (0..*count).try_for_each(|i| write!(table, ",{name}{i}"))?;
    }
    Ok(())
}

/// Numbers with all the digits that tell them apart from others.
fn numbers(table: &mut String, rows: &[&[f64]]) -> std::fmt::Result {
    let mut all = rows.iter().copied().flatten();
    all.try_for_each(|x| write!(table, ",{x}"))
}

fn main() -> Result<(), Failure> {
    let mut names = std::env::args().skip(1);
    let (Some(from), Some(events_to), Some(samples_to)) =
        (names.next(), names.next(), names.next())
    else {
        return Err("give three names: a structure (JSON), events and samples (CSV)".into());
    };
    let task = Task::read(&std::fs::read_to_string(&from)?)?;
    let Task {
        structure,
        start,
        duration,
        interval,
    } = task;
    let motion = structure.simulate(start, duration)?;
    let sampled = structure.samples(&motion, interval)?;
    std::fs::write(&events_to, events(structure.len(), motion.events())?)?;
    std::fs::write(&samples_to, samples(&structure, sampled)?)?;
    let budget = structure.energy_budget(&motion)?;
    println!(
        "{} events; heat in each contact {:?}",
        motion.events().len(),
        budget.friction_loss
    );
    Ok(())
}
