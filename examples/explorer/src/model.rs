//! The questions of the page, answered by the crate. No other file uses the crate.

use std::ops::Range;

use stick_slip::bifurcation::{self, along_velocities};
use stick_slip::limit_cycle::{Attractor, Basins, basins};
use stick_slip::orbit::{self, Period};
use stick_slip::structure;
use stick_slip::{AnyLaw, Coulomb, Drive, Error, Exponential, FrictionLaw, MassOnBelt, Physical};
use stick_slip::{Polynomial, Scaling, Segment, State, Stribeck, Structure};
use stick_slip::{SystemState, Tabulated, Trajectory};

use crate::text::{Answer, Fallible, Question, six};

type Belt = MassOnBelt<AnyLaw>;

/// The answer to a question, `motion`, `diagram` or `basins`, as JSON.
pub fn answer(question: &str) -> String {
    let q = Question(question);
    let answer = match q.text("kind") {
        "motion" => motion(&q),
        "diagram" => diagram(&q),
        _ => cells(&q),
    };
    let answer = answer.map_err(|error| error.to_string());
    let answer = answer.unwrap_or_else(|e| Answer { error: Some(e), ..Answer::default() });
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
fn forced(belt: &Belt, force: f64, frequency: f64) -> Result<Structure, Error> {
    Structure::from(belt).with_force(0, Drive::harmonic(force, frequency, 0.0)?)
}

/// A motion as points, with both ends of every step, so that no event is cut off.
struct Line {
    /// Time, displacement, velocity; displacement in stick, sliding speed in slip, else NaN.
    points: Vec<[f64; 5]>,
    stick_time: f64,
    /// Time, displacement, kind.
    events: Vec<(f64, f64, String)>,
}

impl Line {
    fn of<S: SystemState + Into<structure::State>>(motion: &Trajectory<S>, v_b: f64) -> Self {
        let (mut points, mut stick_time, mut events) = (Vec::new(), 0.0, Vec::new());
        let interval = motion.duration() / 800.0;
        for step in motion.steps() {
            let duration = step.duration();
            let point = |time: f64| {
                let state: structure::State = step.state_at(time).into();
                (state.displacements[0], state.velocities[0])
            };
            // In stick the velocity is that of the belt, to the bit.
            let is_stick = [0.0, 0.5, 1.0].iter().all(|part| point(part * duration).1 == v_b);
            stick_time += if is_stick { duration } else { 0.0 };
            let parts = (duration / interval).ceil().max(1.0);
            points.extend((0..=parts as usize).map(|i| {
                let time = duration * i as f64 / parts;
                let (u, v) = point(time);
                let slip = [step.start_time() + time, u, v, f64::NAN, (v - v_b).abs()];
                if is_stick { [slip[0], u, v, u, f64::NAN] } else { slip }
            }));
            let u = point(duration).0;
            let kinds = step.events().iter().map(|event| (event.time, u, event.kind.to_string()));
            events.extend(kinds);
        }
        // A stiff motion has many steps.
        points.dedup_by(|next: &mut [f64; 5], kept| {
            next[0] - kept[0] < 0.2 * interval && next[3].is_nan() == kept[3].is_nan()
        });
        Self { points, stick_time, events }
    }

    fn columns(&self) -> [Vec<f64>; 5] {
        std::array::from_fn(|i| self.points.iter().map(|point| point[i]).collect())
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
        let (amplitude, period) = (six(self.amplitude), six(self.period));
        let stick = match 100.0 * self.line.stick_time / self.period {
            0.0 => String::new(),
            percent => format!(", {percent:.1} % of it in stick"),
        };
        format!("{}: amplitude {amplitude}, period {period}{stick}", self.kind)
    }
}

fn stable(is_stable: bool) -> &'static str {
    if is_stable { "stable" } else { "unstable" }
}

/// All cycles, and the number of the one that the motion comes to, or what else it comes to.
type Fate = (Vec<Cycle>, Result<usize, String>);

/// What becomes of a start without a force.
fn free_fate(belt: &Belt, start: State) -> Result<Fate, Error> {
    let basins = basins(belt)?;
    let cycles = basins.cycles().iter().map(|cycle| {
        let (period, amplitude) = (cycle.period(), cycle.amplitude());
        let is_stable = cycle.is_stable();
        let kind = format!("{} {}", stable(is_stable), cycle.kind());
        let line = Line::of(&cycle.trajectory(), belt.belt_velocity());
        Cycle { is_stable, kind, period, amplitude, line }
    });
    let attractor = basins.attractor(start)?;
    let other = match attractor {
        Attractor::Continuum => "stays on one of a continuum of cycles".into(),
        Attractor::Unbounded => "moves farther and farther away".into(),
        Attractor::Unresolved => "comes to what double precision does not tell".into(),
        _ => format!("settles to {attractor}"),
    };
    Ok((cycles.collect(), index(&basins, &attractor).ok_or(other)))
}

/// The number of the cycle to which a motion comes.
fn index(basins: &Basins<AnyLaw>, attractor: &Attractor) -> Option<usize> {
    let (Attractor::Cycle(cycle) | Attractor::Separatrix(cycle)) = attractor else { return None };
    basins.cycles().iter().position(|other| other == cycle)
}

/// What becomes of a start under a force: the first stable motion that repeats after one to four
/// of its periods, and the unstable ones met before.
fn forced_fate(belt: &Belt, system: &Structure, start: State) -> Fate {
    let transient = (20.0 / belt.damping()).clamp(300.0, 3000.0);
    let mut cycles = Vec::new();
    for count in 1..=4 {
        let orbit = orbit::settle(system, &start.into(), transient, Period::Driven(count));
        let Ok(orbit) = orbit else { continue };
        let (period, (low, high)) = (orbit.period(), orbit.extremes(0));
        let (is_stable, amplitude) = (orbit.is_stable(), 0.5 * (high - low));
        let kind = format!("{} motion of period {}π/Ω", stable(is_stable), 2 * count);
        let line = Line::of(orbit.trajectory(), belt.belt_velocity());
        cycles.push(Cycle { is_stable, kind, period, amplitude, line });
        if is_stable {
            break;
        }
    }
    let reached = cycles.iter().position(|cycle| cycle.is_stable);
    let other = "does not repeat itself after 1, 2, 3 or 4 periods of the force";
    (cycles, reached.ok_or(other.into()))
}

/// What the mass does from its start, all its cycles, and its law.
fn motion(q: &Question) -> Fallible<Answer> {
    let (belt, start, time, force) = (belt(q)?, start(q)?, q.get("time")?, q.get("force")?);
    let v_b = belt.belt_velocity();
    let (line, (cycles, reached)) = if force == 0.0 {
        (Line::of(&belt.simulate(start, time)?, v_b), free_fate(&belt, start)?)
    } else {
        let system = forced(&belt, force, q.get("frequency")?)?;
        let motion = system.simulate(start, time)?;
        (Line::of(&motion, v_b), forced_fate(&belt, &system, start))
    };
    let fate = match &reached {
        Ok(i) if cycles[*i].is_stable => format!("settles to {}", cycles[*i].words()),
        Ok(i) => format!("stays, until disturbed, on {}", cycles[*i].words()),
        Err(other) => other.clone(),
    };
    let mut answer = Answer::default();
    let (u, v) = (start.displacement, start.velocity);
    answer.words.push(format!("From u = {u}, u′ = {v} the mass {fate}."));
    let others = cycles.iter().enumerate().filter(|(i, _)| Ok(*i) != reached);
    answer.words.extend(others.map(|(_, cycle)| format!("There is also {}.", cycle.words())));
    draw_motion(&mut answer, &line, &cycles);
    if let Some(equilibrium) = belt.equilibrium().filter(|_| force == 0.0) {
        answer.words.push(format!("Steady sliding: {equilibrium}."));
        let class = format!("phase {} point", stable(equilibrium.is_stable()));
        answer.add(class, "steady sliding", vec![equilibrium.displacement], vec![0.0]);
    }
    let cycle = reached.ok().map(|i| &cycles[i]);
    draw_law(&mut answer, &belt, cycle.map_or(&line, |cycle| &cycle.line));
    if ["mass", "spring", "normal_load"].iter().all(|name| !q.text(name).is_empty()) {
        answer.words.push(si_units(q, &belt, cycle)?);
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
        let period = scaling.seconds(cycle.period);
        let amplitude = six(1e3 * scaling.metres(cycle.amplitude));
        let (period, hertz) = (six(period), six(period.recip()));
        format!("amplitude {amplitude} mm, period {period} s, {hertz} Hz; ")
    });
    let (damping, velocity) = (six(damping), six(belt_velocity));
    Ok(format!("In SI units: {motion}belt {velocity} m/s, damper {damping} N·s/m."))
}

fn draw_motion(answer: &mut Answer, line: &Line, cycles: &[Cycle]) {
    let [t, u, v, stick, _] = line.columns();
    answer.add("phase motion", "from the start", u.clone(), v.clone());
    for Cycle { is_stable, kind, line, .. } in cycles {
        let [_, u, v, stick, _] = line.columns();
        answer.add("phase stick", "stick", stick, v.clone());
        answer.add(format!("phase {}", stable(*is_stable)), kind, u, v);
    }
    answer.add("phase start point", "start", u[..1].to_vec(), v[..1].to_vec());
    answer.add("time stick", "stick", t.clone(), stick);
    answer.add("time velocity", "velocity u′", t.clone(), v);
    answer.add("time displacement", "displacement u", t, u);
    for kind in ["stick", "release", "crossing"] {
        let events = line.events.iter().filter(|event| event.2.starts_with(kind));
        let (x, y) = events.map(|event| (event.0, event.1)).unzip();
        answer.add(format!("time {kind}-event point"), &format!("{kind} (event)"), x, y);
    }
}

fn draw_law(answer: &mut Answer, belt: &Belt, line: &Line) {
    let (law, v_b) = (belt.law(), belt.belt_velocity().abs());
    let speeds = || line.points.iter().map(|point| point[4]);
    let (low, high) = (speeds().fold(f64::INFINITY, f64::min), speeds().fold(0.0, f64::max));
    let mut curve = |class, name, range: Range<f64>| {
        let speed = |i| range.start + (range.end - range.start) * f64::from(i) / 200.0;
        let x: Vec<f64> = (0..=200).map(speed).collect();
        let y = x.iter().map(|&speed| law.kinetic(speed)).collect();
        answer.add(class, name, x, y);
    };
    if low < high {
        curve("law visited", "where the motion slides", low..high);
    }
    curve("law kinetic", "kinetic", 0.0..1.25 * high.max(v_b).max(1e-3));
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
