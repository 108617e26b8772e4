//! The questions of the page, answered by the crate. No other file uses the crate.

use std::ops::Range;

use stick_slip::bifurcation::{self, along_velocities};
use stick_slip::limit_cycle::{Attractor, Basins, basins};
use stick_slip::orbit::{self, Period};
use stick_slip::structure;
use stick_slip::{
    AnyLaw, Coulomb, Drive, Error, Event, Exponential, FrictionLaw, MassOnBelt, Mode,
};
use stick_slip::{Physical, Polynomial, Scaling, Segment, State, Stribeck, Structure, Tabulated};

use crate::text::{Answer, Fallible, Question, six};

type Belt = MassOnBelt<AnyLaw>;
type Forced = Structure<AnyLaw>;

/// The answer to a question, as JSON.
pub fn answer(question: &str) -> String {
    let q = Question(question);
    let answer = match q.text("kind") {
        "motion" => motion(&q),
        "diagram" => diagram(&q),
        "basins" => cells(&q),
        kind => Err(format!("no such question: {kind}").into()),
    };
    let failed = |error: Box<dyn std::error::Error>| Some(error.to_string());
    let answer = answer.unwrap_or_else(|e| Answer { error: failed(e), ..Answer::default() });
    serde_json::to_string(&answer).unwrap_or_default()
}

fn law(q: &Question) -> Fallible<AnyLaw> {
    let [mu_s, mu_k, v_s] = ["mu_s", "mu_k", "v_s"].map(|name| q.get::<f64>(name));
    Ok(match q.text("law") {
        "polynomial" => Polynomial::new(mu_s?, mu_k?, v_s?)?.into(),
        "exponential" => Exponential::new(mu_s?, mu_k?, v_s?)?.into(),
        "coulomb" => Coulomb::new(mu_s?, mu_k?)?.into(),
        "stribeck" => Stribeck::new(mu_s?, mu_k?, v_s?, q.get("exponent")?)?
            .with_viscous_coefficient(q.get("viscous")?)?
            .into(),
        "table" => {
            let parts = q.text("points").split([' ', ',', ';']).filter(|part| !part.is_empty());
            let number = |part: &str| part.parse().map_err(|e| format!("points, “{part}”: {e}"));
            let numbers: Vec<f64> = parts.map(number).collect::<Result<_, _>>()?;
            let (points, []) = numbers.as_chunks() else {
                return Err("points: the last speed has no coefficient".into());
            };
            Tabulated::new(points.iter().map(|&[speed, mu]| (speed, mu)))?.into()
        }
        law => return Err(format!("no such law: {law}").into()),
    })
}

fn belt(q: &Question) -> Fallible<Belt> {
    let belt = MassOnBelt::new(law(q)?, q.get("v_b")?)?;
    Ok(belt.with_damping(q.get("beta")?)?.with_load(q.get("load")?)?)
}

fn start(q: &Question) -> Fallible<State> {
    Ok(State::new(q.get("u")?, q.get("v")?))
}

/// The belt under the force F cos Ωτ.
fn forced(belt: &Belt, force: f64, frequency: f64) -> Result<Forced, Error> {
    Structure::from(belt).with_force(0, Drive::harmonic(force, frequency, 0.0)?)
}

/// A motion as points, with both ends of every step, so that no event is cut off.
#[derive(Default)]
struct Line {
    t: Vec<f64>,
    u: Vec<f64>,
    v: Vec<f64>,
    /// Displacement where the mass sticks, else NaN.
    stick: Vec<f64>,
    stick_time: f64,
    /// Sliding speeds; NaN where the mass sticks.
    speeds: Vec<f64>,
    events: Vec<Event<structure::State>>,
}

impl Line {
    fn of(system: &Forced, start: structure::State, time: f64) -> Result<Self, Error> {
        let motion = system.simulate(start, time)?;
        let v_b = system.contacts()[0].belt_velocity().value(0.0);
        let mut line = Self { events: motion.events().to_vec(), ..Self::default() };
        for step in motion.steps() {
            let duration = step.duration();
            let sticks = step.modes()[0] == Mode::Stick;
            line.stick_time += if sticks { duration } else { 0.0 };
            let parts = (800.0 * duration / time).ceil().max(1.0);
            for time in (0..=parts as usize).map(|i| duration * i as f64 / parts) {
                let state = step.state_at(time);
                let (u, v) = (state.displacements[0], state.velocities[0]);
                line.t.push(step.start_time() + time);
                line.u.push(u);
                line.v.push(v);
                line.stick.push(if sticks { u } else { f64::NAN });
                line.speeds.push(if sticks { f64::NAN } else { (v - v_b).abs() });
            }
        }
        Ok(line)
    }
}

/// A periodic motion.
struct Cycle {
    is_stable: bool,
    kind: String,
    period: f64,
    amplitude: f64,
    line: Line,
}

impl Cycle {
    fn words(&self) -> String {
        let Self { kind, period, amplitude, .. } = self;
        let stick = match 100.0 * self.line.stick_time / period {
            0.0 => String::new(),
            percent => format!(", {percent:.1} % of it in stick"),
        };
        let (amplitude, period) = (six(*amplitude), six(*period));
        format!("{} {kind}: amplitude {amplitude}, period {period}{stick}", stable(self.is_stable))
    }
}

fn stable(is_stable: bool) -> &'static str {
    if is_stable { "stable" } else { "unstable" }
}

/// A fate in words, all cycles, and the number of the cycle that is reached.
type Fate = (String, Vec<Cycle>, Option<usize>);

/// What becomes of a start without a force.
fn free_fate(belt: &Belt, system: &Forced, start: State) -> Result<Fate, Error> {
    let basins = basins(belt)?;
    let cycles = basins.cycles().iter().map(|cycle| {
        let line = Line::of(system, cycle.state().into(), cycle.period())?;
        let (period, amplitude) = (cycle.period(), cycle.amplitude());
        let (is_stable, kind) = (cycle.is_stable(), cycle.kind().to_string());
        Ok(Cycle { is_stable, kind, period, amplitude, line })
    });
    let cycles = cycles.collect::<Result<Vec<Cycle>, Error>>()?;
    let attractor = basins.attractor(start)?;
    let index = index(&basins, &attractor);
    let words = match (&attractor, index) {
        (Attractor::Separatrix(_), Some(i)) => format!("stays on {}", cycles[i].words()),
        (_, Some(i)) => format!("settles to {}", cycles[i].words()),
        (Attractor::Unbounded, _) => "moves farther and farther away".into(),
        (Attractor::Unresolved, _) => "comes to what double precision does not tell".into(),
        (other, _) => format!("settles to {other}"),
    };
    Ok((words, cycles, index))
}

/// The number of the cycle to which a motion comes.
fn index(basins: &Basins<AnyLaw>, attractor: &Attractor) -> Option<usize> {
    let (Attractor::Cycle(cycle) | Attractor::Separatrix(cycle)) = attractor else { return None };
    basins.cycles().iter().position(|other| other == cycle)
}

/// What becomes of a start under a force: the first stable motion that repeats after one to four
/// of its periods, and the unstable ones met before.
fn forced_fate(belt: &Belt, system: &Forced, start: State) -> Result<Fate, Error> {
    let transient = (20.0 / belt.damping()).clamp(300.0, 3000.0);
    let (mut cycles, mut failure) = (Vec::new(), String::new());
    for count in 1..=4 {
        match orbit::settle(system, &start.into(), transient, Period::Driven(count)) {
            Err(error) => failure = format!(" ({error})"),
            Ok(orbit) => {
                let ((low, high), period) = (orbit.extremes(0), orbit.period());
                let (is_stable, amplitude) = (orbit.is_stable(), 0.5 * (high - low));
                let kind = format!("motion over {count} × the force's period");
                let line = Line::of(system, orbit.state(), period)?;
                cycles.push(Cycle { is_stable, kind, period, amplitude, line });
                if is_stable {
                    let last = cycles.len() - 1;
                    return Ok((
                        format!("settles to {}", cycles[last].words()),
                        cycles,
                        Some(last),
                    ));
                }
            }
        }
    }
    let words = format!("does not repeat itself after 1, 2, 3 or 4 periods of the force{failure}");
    Ok((words, cycles, None))
}

/// What the mass does from its start, all its cycles, and its law.
fn motion(q: &Question) -> Fallible<Answer> {
    let (belt, start, force) = (belt(q)?, start(q)?, q.get("force")?);
    let system = forced(&belt, force, q.get("frequency")?)?;
    let line = Line::of(&system, start.into(), q.get("time")?)?;
    let fate = if force == 0.0 { free_fate } else { forced_fate };
    let (fate, cycles, reached) = fate(&belt, &system, start)?;
    let mut answer = Answer::default();
    let (u, v) = (start.displacement, start.velocity);
    answer.words.push(format!("From u = {u}, u′ = {v} the mass {fate}."));
    let others = cycles.iter().enumerate().filter(|(i, _)| Some(*i) != reached);
    answer.words.extend(others.map(|(_, cycle)| format!("There is also {}.", cycle.words())));
    draw_motion(&mut answer, &line, &cycles);
    if let Some(equilibrium) = belt.equilibrium().filter(|_| force == 0.0) {
        answer.words.push(format!("Steady sliding: {equilibrium}."));
        let class = format!("phase {} point", stable(equilibrium.is_stable()));
        answer.add(class, "steady sliding", vec![equilibrium.displacement], vec![0.0]);
    }
    let reached = reached.map(|i| &cycles[i]);
    draw_law(&mut answer, &belt, &reached.map_or(&line, |cycle| &cycle.line).speeds);
    if ["mass", "spring", "normal_load"].iter().all(|name| !q.text(name).is_empty()) {
        answer.words.push(si_units(q, &belt, reached)?);
    }
    Ok(answer)
}

/// A motion in SI units: N = γ²KL, V = v_b L ω0.
fn si_units(q: &Question, belt: &Belt, cycle: Option<&Cycle>) -> Fallible<String> {
    let (mass, stiffness): (f64, f64) = (q.get("mass")?, q.get("spring")?);
    let normal_force = q.get("normal_load")?;
    let length = normal_force / stiffness / belt.load();
    let damping = 2.0 * belt.damping() * (stiffness * mass).sqrt();
    let belt_velocity = belt.belt_velocity() * length * (stiffness / mass).sqrt();
    let physical = Physical { mass, stiffness, damping, normal_force, belt_velocity };
    let scaling = Scaling::new(physical)?.with_length(length)?;
    let motion = cycle.map_or(String::new(), |cycle| {
        let amplitude = six(1e3 * scaling.metres(cycle.amplitude));
        let period = scaling.seconds(cycle.period);
        let (period, hertz) = (six(period), six(period.recip()));
        format!("amplitude {amplitude} mm, period {period} s, {hertz} Hz; ")
    });
    let (damping, velocity) = (six(damping), six(belt_velocity));
    Ok(format!("In SI units: {motion}belt {velocity} m/s, damper {damping} N·s/m."))
}

fn draw_motion(answer: &mut Answer, line: &Line, cycles: &[Cycle]) {
    let Line { t, u, v, stick, .. } = line;
    answer.add("phase motion", "from the start", u.clone(), v.clone());
    for Cycle { is_stable, kind, line: Line { u, v, stick, .. }, .. } in cycles {
        answer.add("phase stick", "stick", stick.clone(), v.clone());
        answer.add(format!("phase {}", stable(*is_stable)), kind, u.clone(), v.clone());
    }
    answer.add("phase start point", "start", u[..1].to_vec(), v[..1].to_vec());
    answer.add("time stick", "stick", t.clone(), stick.clone());
    answer.add("time velocity", "velocity u′", t.clone(), v.clone());
    answer.add("time displacement", "displacement u", t.clone(), u.clone());
    for kind in ["stick", "release", "crossing"] {
        let events = line.events.iter().filter(|event| event.kind.to_string().starts_with(kind));
        let (x, y) = events.map(|event| (event.time, event.state.displacements[0])).unzip();
        answer.add(format!("time {kind}-event point"), &format!("{kind} (event)"), x, y);
    }
}

fn draw_law(answer: &mut Answer, belt: &Belt, speeds: &[f64]) {
    let (law, v_b) = (belt.law(), belt.belt_velocity().abs());
    let start = speeds.iter().copied().fold(f64::INFINITY, f64::min);
    let end = speeds.iter().copied().fold(0.0, f64::max);
    let mut curve = |class, name, range: Range<f64>| {
        let speed = |i| range.start + (range.end - range.start) * f64::from(i) / 200.0;
        let x: Vec<f64> = (0..=200).map(speed).collect();
        let y = x.iter().map(|&speed| law.kinetic(speed)).collect();
        answer.add(class, name, x, y);
    };
    if start < end {
        curve("law visited", "where the motion slides", start..end);
    }
    curve("law kinetic", "kinetic", 0.0..1.25 * end.max(v_b).max(1e-3));
    answer.add("law event point", "static", vec![0.0], vec![law.static_coefficient()]);
    answer.add("law start point", "steady sliding", vec![v_b], vec![law.kinetic(v_b)]);
}

/// Amplitudes over the belt velocity; under a force, over it or over the frequency.
fn diagram(q: &Question) -> Fallible<Answer> {
    let (belt, end, force): (Belt, f64, f64) = (belt(q)?, q.get("to")?, q.get("force")?);
    if force != 0.0 {
        return branch(q, &belt, force, end);
    }
    let (mut answer, count) = (Answer::default(), q.get::<u32>("count")?);
    let step = end / f64::from(count);
    let mut velocities: Vec<f64> = (1..=count).map(|i| step * f64::from(i)).collect();
    // The curves go up to the bifurcations, if these are wanted.
    if q.text("exact") == "1" {
        let search = along_velocities(&belt, 1e-3 * end..end);
        let searches = [
            ("Hopf", search.hopf()),
            ("grazing", search.grazing()),
            ("overshoot", search.overshoot()),
            ("crossing", search.crossing()),
            ("fold", search.folds()),
        ];
        for (name, found) in searches {
            for v_b in found? {
                // A branch can begin like a square root.
                let apart = (0..6).map(|k| step * 0.25_f64.powi(k)).chain([1e-7 * end]);
                velocities.extend(apart.flat_map(|apart| [v_b - apart, v_b + apart]));
                answer.add("diagram mark", name, vec![v_b], vec![0.0]);
            }
        }
        velocities.retain(|&v_b| 0.0 < v_b && v_b <= end);
        velocities.sort_by(f64::total_cmp);
    }
    let mut rows = Vec::new();
    for point in bifurcation::diagram(&belt, velocities) {
        match point {
            Err(error) => answer.error = Some(error.to_string()),
            Ok(point) => {
                let steady = point.equilibrium.map(|e| (0.0, e.is_stable()));
                let cycles = point.cycles.iter().map(|c| (c.amplitude(), c.is_stable()));
                rows.push((point.belt_velocity, steady.into_iter().chain(cycles).collect()));
            }
        }
    }
    draw_rows(&mut answer, &rows);
    Ok(answer)
}

/// A value of the parameter, with amplitudes and stabilities.
type Row = (f64, Vec<(f64, bool)>);

/// Joins the motions of neighbours that have equally many, and equally stable ones.
fn draw_rows(answer: &mut Answer, rows: &[Row]) {
    let signs = |row: &Row| row.1.iter().map(|motion| motion.1).collect::<Vec<_>>();
    for run in rows.chunk_by(|a, b| signs(a) == signs(b)) {
        for (i, &(_, is_stable)) in run[0].1.iter().enumerate() {
            let (x, y) = run.iter().map(|row| (row.0, row.1[i].0)).unzip();
            let name = stable(is_stable);
            answer.add(format!("diagram {name}"), name, x, y);
        }
    }
}

/// The motion under the force, followed over the belt velocity or the frequency.
fn branch(q: &Question, belt: &Belt, force: f64, end: f64) -> Fallible<Answer> {
    let (frequency, is_over_frequency) = (q.get("frequency")?, q.text("over") == "frequency");
    let family = |value: f64| match is_over_frequency {
        true => forced(belt, force, value),
        false => forced(&belt.clone().with_belt_velocity(value)?, force, frequency),
    };
    let from = if is_over_frequency { frequency } else { belt.belt_velocity() };
    let start = orbit::settle(&family(from)?, &start(q)?.into(), 300.0, Period::Driven(1))?;
    let found = orbit::follow(family, from, &start, from.min(0.01 * end)..from.max(end))?;
    let mut answer = Answer::default();
    let rows = found.points.iter().map(|point| {
        let (low, high) = point.orbit.extremes(0);
        (point.parameter, vec![(0.5 * (high - low), point.orbit.is_stable())])
    });
    draw_rows(&mut answer, &rows.collect::<Vec<_>>());
    for change in &found.bifurcations {
        answer.add("diagram mark", &change.kind.to_string(), vec![change.parameter], vec![0.0]);
    }
    Ok(answer)
}

/// What the starts of a grid settle to: the number of a cycle, else `0`.
fn cells(q: &Question) -> Fallible<Answer> {
    let belt = belt(q)?;
    let basins = basins(&belt)?;
    let (columns, rows): (u32, u32) = (q.get("columns")?, q.get("rows")?);
    let (left, right): (f64, f64) = (q.get("left")?, q.get("right")?);
    let (low, high): (f64, f64) = (q.get("low")?, q.get("high")?);
    let cell = |row: u32, column: u32| -> Result<String, Error> {
        let u = left + (right - left) * (f64::from(column) + 0.5) / f64::from(columns);
        let v = low + (high - low) * (f64::from(row) + 0.5) / f64::from(rows);
        let attractor = basins.attractor(State::new(u, v))?;
        Ok(index(&basins, &attractor).map_or("0".into(), |i| (i + 1).to_string()))
    };
    let row = |row| (0..columns).map(|column| cell(row, column)).collect();
    let cells = (0..rows).map(row).collect::<Result<_, Error>>()?;
    Ok(Answer { cells, ..Answer::default() })
}
