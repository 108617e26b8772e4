//! Thousands of random systems, with parameters over many decades: results, accuracy and computing
//! time.
//!
//! What to learn from it:
//!
//! * a motion that cannot be followed returns a typed error; errors are counted by kind and by
//!   message;
//! * every motion is followed a second time, with half the tolerance and from a state inside its
//!   first step, so that all steps differ. The distance between the last states and between the
//!   events of the two motions is an error of the integrator, unless the motion itself magnifies
//!   rounding errors of its data and states as much;
//! * the energy balance of every motion is checked by a quadrature of the law that is independent
//!   of the integrator;
//! * systems and laws are plain values, so that any number of threads can work on them.
//!
//! Run it with
//! `cargo run --release -p stick-slip-soak -- [integrations] [cycle searches] [first index]`.

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use stick_slip::{Error, limit_cycle};

mod energy;
mod judge;
mod systems;

use judge::{APART, Judged, Verdict};
use systems::random_motion;

/// Integrations and searches where no number is given.
const DEFAULT: [usize; 2] = [2000, 200];

/// How a task ends that comes to its end.
const RESULT: &str = "result";

/// Energy defect, in roundings, that is worth a look.
const REMARKABLE: f64 = 1000.0;

/// A task that takes longer is named.
const SLOW: Duration = Duration::from_secs(1);

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1).map(|text| text.parse::<usize>());
    let integrations = arguments.next().unwrap_or(Ok(DEFAULT[0]))?;
    let searches = arguments.next().unwrap_or(Ok(DEFAULT[1]))?;
    let first = arguments.next().unwrap_or(Ok(0))?;
    let rule = energy::Rule::new();
    soak("integrations", first, integrations, |i| {
        let (system, start, duration) = random_motion(i)?;
        judge::judge(&rule, &system, start, duration).map(Some)
    })?;
    soak("searches", first, searches, |i| {
        let (system, ..) = random_motion(i)?;
        limit_cycle::find(&system).map(|_| None)
    })
}

/// The largest of some measure, and whose it is.
#[derive(Default, Clone, Copy)]
struct Worst(f64, usize);

impl Worst {
    fn add(&mut self, other: Self) {
        // A NaN counts as the worst.
        if other.0.is_nan() || other.0 > self.0 {
            *self = other;
        }
    }
}

/// What became of many tasks.
#[derive(Default)]
struct Tally {
    /// Which ended how.
    ends: BTreeMap<String, Vec<usize>>,
    /// What explains that two integrations of one motion differ.
    verdicts: BTreeMap<Verdict, Vec<usize>>,
    /// Largest distances between two integrations, of states and of times.
    state: Worst,
    time: Worst,
    defect: Worst,
    /// Those with a defect above [`REMARKABLE`].
    remarkable: Vec<usize>,
    longest: (Duration, usize),
    slow: Vec<usize>,
}

impl Tally {
    fn add(&mut self, i: usize, end: String, judged: Option<&Judged>, time: Duration) {
        self.ends.entry(end).or_default().push(i);
        if let Some(judged) = judged {
            self.verdicts.entry(judged.verdict).or_default().push(i);
            self.state.add(Worst(judged.apart.state, i));
            self.time.add(Worst(judged.apart.time, i));
            self.defect.add(Worst(judged.defect, i));
            if judged.defect.is_nan() || judged.defect > REMARKABLE {
                self.remarkable.push(i);
            }
        }
        self.longest = self.longest.max((time, i));
        if time > SLOW {
            self.slow.push(i);
        }
    }

    fn merge(&mut self, other: Self) {
        for (end, indices) in other.ends {
            self.ends.entry(end).or_default().extend(indices);
        }
        for (verdict, indices) in other.verdicts {
            self.verdicts.entry(verdict).or_default().extend(indices);
        }
        self.state.add(other.state);
        self.time.add(other.time);
        self.defect.add(other.defect);
        self.remarkable.extend(other.remarkable);
        self.slow.extend(other.slow);
        self.longest = self.longest.max(other.longest);
    }
}

/// Does one task for each index, on all cores, and prints what became of them.
fn soak(
    what: &str,
    first: usize,
    count: usize,
    task: impl Fn(usize) -> Result<Option<Judged>, Error> + Sync,
) -> Result<(), Box<dyn std::error::Error>> {
    if count == 0 {
        return Ok(());
    }
    let bar = ProgressBar::new(count as u64).with_style(ProgressStyle::with_template(
        "{msg:12} {wide_bar} {pos}/{len}, {eta} left",
    )?);
    bar.set_message(what.to_string());
    let next = AtomicUsize::new(0);
    let work = || {
        let mut tally = Tally::default();
        loop {
            let i = next.fetch_add(1, Ordering::Relaxed);
            if i >= count {
                return tally;
            }
            let i = first + i;
            let before = Instant::now();
            // A panic would be a bug, and this the place to find it.
            let (end, judged) = match catch_unwind(AssertUnwindSafe(|| task(i))) {
                Ok(Ok(judged)) => (RESULT.to_string(), judged),
                Ok(Err(error)) => (classified(&error), None),
                Err(_) => ("PANIC".to_string(), None),
            };
            tally.add(i, end, judged.as_ref(), before.elapsed());
            bar.inc(1);
        }
    };
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let mut tally = Tally::default();
    std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        for worker in workers {
            tally.merge(worker.join().unwrap_or_default());
        }
    });
    bar.finish_and_clear();
    print(what, count, &tally);
    Ok(())
}

fn print(what: &str, count: usize, tally: &Tally) {
    println!("{count} {what}");
    for (end, indices) in &tally.ends {
        let n = indices.len();
        let share = 100.0 * n as f64 / count as f64;
        println!("  {n:8}  {share:6.2} %  {end}");
        if end != RESULT {
            println!("      as {}", some(indices));
        }
    }
    let describe = |i: usize| match random_motion(i) {
        Ok((system, start, duration)) => format!("{i}: {system:?} {start:?} for {duration:e}"),
        Err(error) => format!("{i}: {error}"),
    };
    let Worst(defect, i) = tally.defect;
    if defect != 0.0 {
        let system = describe(i);
        println!("  worst energy defect {defect:.1} roundings, system {system}");
    }
    if let [first, ..] = tally.remarkable[..] {
        let n = tally.remarkable.len();
        println!("  {n} above {REMARKABLE} roundings, as system {first}");
    }
    let differing = tally.verdicts.iter().filter(|v| *v.0 != Verdict::Agree);
    let n: usize = differing.clone().map(|(_, indices)| indices.len()).sum();
    if n > 0 {
        let (Worst(state, i), Worst(time, j)) = (tally.state, tally.time);
        println!("  {n} pairs of integrations are more than {APART:e} apart, explained by");
        for (verdict, indices) in differing {
            println!("  {:8}  {verdict}, as {}", indices.len(), some(indices));
        }
        println!("  states at most {state:.1e} apart, system {i}; times {time:.1e}, {j}");
    }
    let (time, i) = tally.longest;
    println!("  longest time {time:.1?}, system {}", describe(i));
    if !tally.slow.is_empty() {
        println!("  longer than {SLOW:?}: {}", some(&tally.slow));
    }
}

/// The least few of these indices.
fn some(indices: &[usize]) -> String {
    let mut sorted = indices.to_vec();
    sorted.sort_unstable();
    let most = sorted.len().min(if sorted.len() > 100 { 10 } else { 100 });
    format!("{:?}", &sorted[..most])
}

/// The kind of an error, and its reason: what it says, without its numbers.
fn classified(error: &Error) -> String {
    let told = format!("{error:?}");
    let kind = told.split([' ', '(', '{']).next().unwrap_or_default();
    let reason: String = error
        .to_string()
        .chars()
        .map(|c| if c.is_ascii_digit() { '#' } else { c })
        .collect();
    let mut words: Vec<&str> = reason.split_whitespace().collect();
    words.retain(|word| !word.contains('#'));
    format!("{kind}: {}", words.join(" "))
}
