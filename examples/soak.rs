//! Random systems by the thousand, of parameters over many decades: what comes out, how exactly,
//! and how long it takes.
//!
//! What to learn from it:
//!
//! * what cannot be followed ends in an error that says so; the errors are counted here by kind;
//! * every motion is followed a second time, with half the tolerance and from a state inside its
//!   first step on, so that all steps start elsewhere: how far the last states are apart shows
//!   what the integrator itself gets wrong, in u and in the sliding speed themselves, unless the
//!   motion itself magnifies the rounding of its own data as much;
//! * the energy of every motion is balanced by a quadrature of the law itself, which knows nothing
//!   of the integrator;
//! * systems and laws are plain values, so that any number of threads can work on them.
//!
//! Run it with
//! `cargo run --release --example soak -- [integrations] [searches for cycles] [first index]`.

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use stick_slip::{
    AnyLaw, Coulomb, Error, Exponential, FrictionLaw, Integrator, MassOnBelt, Mode, Polynomial,
    Rational, State, Stribeck, Tabulated, limit_cycle,
};

/// Integrations and searches where no number is given.
const DEFAULT: [usize; 2] = [2000, 200];

/// How a task ends that comes to its end.
const RESULT: &str = "result";

/// Steps after which an integration is given up.
const MOST_STEPS: usize = 10_000;

/// Energy defect, in roundings, that is worth a look.
const REMARKABLE: f64 = 1000.0;

/// Distance between two integrations of one motion, in parts of max(|u|, |v|, |v_b|) or of
/// max(|v|, |v_b|), that is worth a look: it is an error, or the motion itself magnifies rounding
/// (near grazing, at a release where friction falls steeply, or at v_b far below γ²μ_s).
const APART: f64 = 1e-9;

/// Rounding errors of a whole integration, in those of its data: two integrations that are further
/// apart than so many ulps of start, load and duration move the result are wrong.
const ROUNDINGS: f64 = 64.0;

/// A task that takes longer is named.
const SLOW: Duration = Duration::from_secs(1);

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1).map(|text| text.parse::<usize>());
    let integrations = arguments.next().unwrap_or(Ok(DEFAULT[0]))?;
    let searches = arguments.next().unwrap_or(Ok(DEFAULT[1]))?;
    let first = arguments.next().unwrap_or(Ok(0))?;
    let rule = Rule::new();
    soak("integrations", first, integrations, |i| {
        let (system, start, duration) = random_motion(i)?;
        integrate(&rule, &system, start, duration)
    })?;
    soak("searches", first, searches, |i| {
        let (system, ..) = random_motion(i)?;
        limit_cycle::find(&system).map(|_| Judged::default())
    })
}

/// How good a result is.
#[derive(Default)]
struct Judged {
    /// Energy defect, in roundings.
    defect: f64,
    /// Distance from a second integration.
    apart: f64,
    /// By how much the result moves with an ulp of the data, if it had to be found out.
    moved: f64,
}

/// What became of many tasks.
#[derive(Default)]
struct Tally {
    /// Largest distance between two integrations of one motion, and those beyond [`APART`].
    apart: (f64, usize),
    differing: Vec<usize>,
    /// Those of them that the rounding of the data does not explain.
    wrong: Vec<usize>,
    /// Which ended how.
    ends: BTreeMap<String, Vec<usize>>,
    /// Largest defect and longest time, each with the index of its system.
    defect: (f64, usize),
    /// Those with a defect above [`REMARKABLE`].
    remarkable: Vec<usize>,
    time: (Duration, usize),
    slow: Vec<usize>,
}

/// Whether x is larger than y; NaN counts as larger than anything.
fn exceeds(x: f64, y: f64) -> bool {
    x.is_nan() || x > y
}

impl Tally {
    fn add(&mut self, i: usize, end: &str, judged: &Judged, time: Duration) {
        let Judged {
            defect,
            apart,
            moved,
        } = *judged;
        if exceeds(apart, self.apart.0) {
            self.apart = (apart, i);
        }
        if exceeds(apart, APART) {
            self.differing.push(i);
            if exceeds(apart, ROUNDINGS * moved) {
                self.wrong.push(i);
            }
        }
        self.ends.entry(end.into()).or_default().push(i);
        // A NaN counts as the worst.
        let defect = if defect.is_nan() {
            f64::INFINITY
        } else {
            defect
        };
        if defect > self.defect.0 {
            self.defect = (defect, i);
        }
        if defect > REMARKABLE {
            self.remarkable.push(i);
        }
        if time > self.time.0 {
            self.time = (time, i);
        }
        if time > SLOW {
            self.slow.push(i);
        }
    }

    fn merge(&mut self, other: Self) {
        for (end, indices) in other.ends {
            self.ends.entry(end).or_default().extend(indices);
        }
        if other.defect.0 > self.defect.0 {
            self.defect = other.defect;
        }
        self.remarkable.extend(other.remarkable);
        if other.apart.0 > self.apart.0 {
            self.apart = other.apart;
        }
        self.differing.extend(other.differing);
        self.wrong.extend(other.wrong);
        self.slow.extend(other.slow);
        self.time = self.time.max(other.time);
    }
}

/// Does one task for each index, on all cores, and prints what became of them.
fn soak(
    what: &str,
    first: usize,
    count: usize,
    task: impl Fn(usize) -> Result<Judged, Error> + Sync,
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
                Ok(Ok(judged)) => (RESULT, judged),
                Ok(Err(error)) => (name(&error), Judged::default()),
                Err(_) => ("PANIC", Judged::default()),
            };
            tally.add(i, end, &judged, before.elapsed());
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

    println!("{count} {what}");
    for (end, indices) in &tally.ends {
        let n = indices.len();
        let share = 100.0 * n as f64 / count as f64;
        println!("  {end:20} {n:8}  {share:6.2} %");
        if end != RESULT {
            println!("  {:20} as {}", "", some(indices));
        }
    }
    let describe = |i: usize| match random_motion(i) {
        Ok((system, start, duration)) => format!("{i}: {system:?} {start:?} for {duration:e}"),
        Err(error) => format!("{i}: {error}"),
    };
    let (defect, i) = tally.defect;
    if defect != 0.0 {
        println!(
            "  worst energy defect {defect:.1} roundings, system {}",
            describe(i)
        );
    }
    if let [first, ..] = tally.remarkable[..] {
        let n = tally.remarkable.len();
        println!("  {n} above {REMARKABLE} roundings, as system {first}");
    }
    let (apart, i) = tally.apart;
    if apart != 0.0 {
        println!(
            "  two integrations at most {apart:.1e} apart, system {}",
            describe(i)
        );
    }
    if !tally.differing.is_empty() {
        let [all, wrong] = [&tally.differing, &tally.wrong].map(Vec::len);
        let explained = all - wrong;
        println!(
            "  {all} by more than {APART:e}: {explained} by the rounding of the data, {wrong} wrong"
        );
        println!("  those: {}", some(&tally.differing));
        if wrong > 0 {
            println!("  wrong: {}", some(&tally.wrong));
        }
    }
    let (time, i) = tally.time;
    println!("  longest time {time:.1?}, system {}", describe(i));
    if !tally.slow.is_empty() {
        println!("  longer than {SLOW:?}: {}", some(&tally.slow));
    }
    Ok(())
}

/// The least few of these indices.
fn some(indices: &[usize]) -> String {
    let mut sorted = indices.to_vec();
    sorted.sort_unstable();
    let most = sorted.len().min(100);
    format!("{:?}", &sorted[..most])
}

/// The kind of an error.
fn name(error: &Error) -> &'static str {
    match error {
        Error::StepUnderflow { .. } => "StepUnderflow",
        Error::TooManySteps { .. } => "TooManySteps",
        Error::TooManyEvents { .. } => "TooManyEvents",
        Error::NonFiniteFriction { .. } => "NonFiniteFriction",
        Error::NotAnalytic { .. } => "NotAnalytic",
        Error::InvalidState { .. } => "InvalidState",
        Error::InvalidParameter { .. } => "InvalidParameter",
        _ => "another error",
    }
}

/// Follows a motion, and compares the energy that it gains with what friction and the damper do,
/// integrated by a quadrature. Returns the difference in units of the rounding errors of such a
/// sum.
fn integrate(
    rule: &Rule,
    system: &MassOnBelt<AnyLaw>,
    start: State,
    duration: f64,
) -> Result<Judged, Error> {
    let energy = |state: State| 0.5 * (state.displacement.powi(2) + state.velocity.powi(2));
    let (v_b, damping) = (system.belt_velocity(), system.damping());
    let centre = system.equilibrium().map_or(0.0, |e| e.displacement);
    let [mut work, mut rounding, mut turnover] = [0.0; 3];
    let mut last = start;
    let integrator = Integrator::new().with_max_steps(MOST_STEPS)?;
    for step in integrator.flow(system, start)? {
        let step = step?;
        let h = step.duration().min(duration - step.start_time());
        last = step.state_at(h);
        if step.mode() == Mode::Stick {
            let [from, to] = [step.state(), last].map(|state| state.displacement);
            // ∫(u + 2βv_b)v_b − 2βv_b² = ∫u du
            work += 0.5 * (to - from) * (to + from);
            rounding += from.powi(2).max(to.powi(2));
        } else {
            for (t, weight) in rule.over(h) {
                let state = step.state_at(t);
                let force = system.friction_force(state);
                let power = (force - 2.0 * damping * state.velocity) * state.velocity;
                work += weight * power;
                turnover += weight * power.abs();
                // v − v_b is rounded like v and v_b, and friction changes with it.
                let slope = system.law().slope((state.velocity - v_b).abs());
                let blur = system.load() * slope.abs() * (state.velocity.abs() + v_b.abs());
                let forces = blur + state.displacement.abs() + force.abs();
                rounding += weight * forces * state.velocity.abs();
            }
            // Each step is good to a rounding of max(|u − ū|, |v|, |v_b|), or better.
            let State {
                displacement: u,
                velocity: v,
            } = last;
            let scale = (u - centre).abs().max(v.abs()).max(v_b.abs());
            rounding += (u.abs() + v.abs()) * scale;
        }
        if step.end_time() >= duration {
            break;
        }
    }
    let defect = (energy(last) - energy(start) - work).abs();
    rounding += turnover + energy(last) + energy(start);
    let defect = if defect == 0.0 {
        0.0
    } else {
        defect / (f64::EPSILON * rounding)
    };
    let apart = distance(last, second(system, start, duration)?, v_b);
    let moved = if apart <= APART {
        0.0
    } else {
        moved(system, start, duration, last)
    };
    Ok(Judged {
        defect,
        apart,
        moved,
    })
}

/// How far apart two ends of one motion are, in parts of themselves.
fn distance(last: State, other: State, v_b: f64) -> f64 {
    let speed = last.velocity.abs().max(v_b.abs());
    let apart = [
        (other.displacement - last.displacement).abs() / last.displacement.abs().max(speed),
        (other.velocity - last.velocity).abs() / speed,
    ];
    // 0/0 is no difference.
    apart
        .into_iter()
        .filter(|a| !a.is_nan())
        .fold(0.0, f64::max)
}

/// By how much an ulp of the data moves the end of a motion: of u, v, γ² and the duration.
fn moved(system: &MassOnBelt<AnyLaw>, start: State, duration: f64, last: State) -> f64 {
    let beside = |x: f64| [x.next_down(), x.next_up()];
    let State {
        displacement: u,
        velocity: v,
    } = start;
    let mut others = Vec::new();
    others.extend(beside(u).map(|u| (Ok(system.clone()), State::new(u, v), duration)));
    others.extend(beside(v).map(|v| (Ok(system.clone()), State::new(u, v), duration)));
    others.extend(
        beside(system.load()).map(|load| (system.clone().with_load(load), start, duration)),
    );
    others.extend(beside(duration).map(|duration| (Ok(system.clone()), start, duration)));
    let ends = others.into_iter().map(|(system, start, duration)| {
        let motion = Integrator::new()
            .with_max_steps(MOST_STEPS)?
            .simulate(&system?, start, duration)?;
        Ok(motion.last())
    });
    ends.map(|end: Result<State, Error>| {
        end.map_or(0.0, |end| distance(last, end, system.belt_velocity()))
    })
    .fold(0.0, f64::max)
}

/// Where the same motion ends, with half the tolerance and other steps.
fn second(system: &MassOnBelt<AnyLaw>, start: State, duration: f64) -> Result<State, Error> {
    let integrator = Integrator::new()
        .with_tolerance(0.5 * Integrator::ROUND_OFF)?
        .with_max_steps(MOST_STEPS)?;
    // Half of the first step.
    let Some(first) = integrator.flow(system, start)?.next().transpose()? else {
        return Ok(start);
    };
    let part = 0.5 * first.duration().min(duration);
    let from = first.state_at(part);
    let mut last = from;
    for step in integrator.flow(system, from)? {
        let step = step?;
        let left = duration - part - step.start_time();
        last = step.state_at(step.duration().min(left));
        if step.duration() >= left {
            break;
        }
    }
    Ok(last)
}

/// The rule of Gauss and Legendre with 16 points.
struct Rule([(f64, f64); 16]);

impl Rule {
    fn new() -> Self {
        let legendre = |x: f64| {
            let (mut p, mut last) = (x, 1.0);
            for k in 2..=16 {
                let k = f64::from(k);
                (p, last) = (((2.0 * k - 1.0) * x * p - (k - 1.0) * last) / k, p);
            }
            (p, 16.0 * (x * p - last) / (x * x - 1.0))
        };
        Self(std::array::from_fn(|i| {
            let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / 16.5).cos();
            for _ in 0..6 {
                let (p, slope) = legendre(x);
                x -= p / slope;
            }
            let slope = legendre(x).1;
            (0.5 + 0.5 * x, 1.0 / ((1.0 - x * x) * slope * slope))
        }))
    }

    /// Points and weights over [0, h].
    fn over(&self, h: f64) -> impl Iterator<Item = (f64, f64)> {
        self.0.iter().map(move |(x, weight)| (h * x, h * weight))
    }
}

/// Splitmix64: the same numbers on every machine and in every run.
struct Random(u64);

impl Random {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform in [low, high).
    fn uniform(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.bits() >> 11) as f64 * 0.5_f64.powi(53)
    }

    /// Uniform in the logarithm.
    fn decades(&mut self, low: f64, high: f64) -> f64 {
        self.uniform(low.ln(), high.ln()).exp()
    }

    fn below(&mut self, n: u64) -> u64 {
        self.bits() % n
    }

    /// A law that falls, and may rise again.
    fn law(&mut self) -> Result<AnyLaw, Error> {
        let top = self.decades(1e-2, 2.0);
        let least = top * self.uniform(0.0, 1.0);
        let width = self.decades(1e-4, 1e2);
        let rise = 1e-2 * self.uniform(0.0, 1.0) * top / width;
        Ok(match self.below(6) {
            0 => Polynomial::new(top, least, width)?.into(),
            1 => Exponential::new(top, least, width)?.into(),
            2 => Coulomb::new(top, least)?.into(),
            3 => Rational::new(top, 1.0 / width)?
                .with_offset(least)?
                .with_quadratic(rise / width)?
                .into(),
            4 => Stribeck::new(top, least, width, 1 + self.below(4) as u32)?
                .with_viscous_coefficient(rise)?
                .into(),
            _ => {
                let middle = (width, 0.7 * least + 0.3 * top);
                let end = (4.0 * width, self.uniform(least, top));
                Tabulated::new([(0.0, top), middle, (2.0 * width, least), end])?
                    .with_static_coefficient(top * self.uniform(1.0, 1.5))?
                    .into()
            }
        })
    }
}

/// System, start and duration of one index.
fn random_motion(i: usize) -> Result<(MassOnBelt<AnyLaw>, State, f64), Error> {
    let mut random = Random((i as u64).wrapping_mul(0xd134_2543_de82_ef95));
    let law = random.law()?;
    let v_b = match random.below(20) {
        0 => 0.0,
        n => random.decades(1e-9, 1e3) * if n % 2 == 0 { 1.0 } else { -1.0 },
    };
    let damping = match random.below(8) {
        0 => 0.0,
        _ => random.decades(1e-6, 10.0),
    };
    let system = MassOnBelt::new(law, v_b)?
        .with_damping(damping)?
        .with_load(random.decades(1e-6, 1e4))?;
    let limits = system.stick_limits();
    let size = v_b.abs() + system.load() * system.law().static_coefficient();
    let start = match random.below(6) {
        // At an end of the stick band or an ulp beside it.
        0 => {
            let limit = limits[random.below(2) as usize];
            let u = [limit.next_down(), limit, limit.next_up()][random.below(3) as usize];
            State::new(u, v_b)
        }
        // As fast as the belt, or an ulp faster or slower.
        1 => {
            let v = [v_b.next_down(), v_b, v_b.next_up()][random.below(3) as usize];
            State::new(random.uniform(-2.0, 2.0) * size, v)
        }
        // Far outside.
        2 => {
            let far = size * random.decades(1.0, 1e3);
            State::new(random.uniform(-far, far), random.uniform(-far, far))
        }
        3 => State::new(0.0, 0.0),
        _ => State::new(random.uniform(-size, size), random.uniform(-1.0, 1.0) * v_b),
    };
    Ok((system, start, random.decades(1.0, 50.0)))
}
