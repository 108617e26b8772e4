//! One slider under rate-and-state friction, over five to fifteen decades of the sliding speed:
//! passages, peaks and states computed independently to 25 digits.

use serde_json::{Value, json};
use stick_slip::analysis::rate_state::first_integral;
use stick_slip::structure::{State, Step};
use stick_slip::{
    AnyContactLaw, Contact, Coulomb, Direction, Drive, Ended, Error, EventKind, Integrator,
    RateState, Segment, Structure, Trajectory,
};

use crate::common::radau::{Matrix, STAGES, corrections, end, weights};
use crate::common::simple::runge_kutta;
use crate::common::{Random, Worst, count, larger, list, number, text};
use crate::reading::{cases, numbers, remembering};

type Made = fn(f64, f64, f64, f64, f64) -> Result<RateState, Error>;

const CASES: &str = include_str!("../data/rate_state_cycles_of_one.json");

/// The slider of a case, in place of one without inertia that with a mass > 0, if there is one; and
/// the velocity of its load point.
fn slider(case: &Value, mass: f64) -> (Option<Structure>, f64) {
    let mut system = case["system"].clone();
    let velocity = number(&system["contacts"][0]["w"]["value"]);
    let is_light = number(&system["mass"][0][0]) == 0.0;
    if is_light {
        system["mass"] = json!([[format!("{mass:e}")]]);
    }
    let exists = !is_light || mass > 0.0;
    (exists.then(|| remembering(&system)), velocity)
}

fn start(case: &Value) -> State {
    let start = &case["start"];
    let memory = numbers(&start["phi"]);
    let speed = numbers(&start["r"])[0];
    let state = State::new(&numbers(&start["q"]), &[0.0]);
    state.with_memory(&memory).with_sliding(0, speed)
}

/// The times at which the sliding speed passes a threshold, and true where it rises.
fn passages(motion: &Trajectory<State>, threshold: f64) -> Vec<(f64, bool)> {
    /// Each part has one passage at most.
    const PARTS: usize = 16;
    let above = |t: f64| -motion.sliding_velocity(0, t) > threshold;
    let mut found = Vec::new();
    for step in motion.steps() {
        let place = |k: usize| step.start_time() + step.duration() * k as f64 / PARTS as f64;
        for k in 0..PARTS {
            let [mut low, mut high] = [place(k), place(k + 1)];
            let rises = above(high);
            if above(low) == rises {
                continue;
            }
            loop {
                let middle = low + 0.5 * (high - low);
                if middle <= low || middle >= high {
                    break;
                }
                let end = if above(middle) == rises {
                    &mut high
                } else {
                    &mut low
                };
                *end = middle;
            }
            found.push((high, rises));
        }
    }
    found
}

fn motion(system: &Structure, case: &Value, tolerance: f64) -> Trajectory<State> {
    Integrator::new()
        .with_tolerance(tolerance)
        .and_then(|integrator| integrator.simulate(system, start(case), number(&case["t_end"])))
        .unwrap()
}

/// The passages of the load point's velocity.
fn expected_passages(case: &Value) -> Vec<(f64, bool)> {
    let kind = |section: &Value| match text(&section["kind"]) {
        "faster" => Some(true),
        "slower" => Some(false),
        _ => None,
    };
    let sections = list(&case["sections"]).iter();
    let passages = sections.filter_map(|section| Some((number(&section["t"]), kind(section)?)));
    passages.collect()
}

/// At the default tolerance the speed has a relative error of some f/a = 60 to 75 roundings at
/// each time of a motion over decades; at others the tolerance, magnified by the instability.
#[test]
fn motions_have_the_reference_passages_and_states() {
    let (mut all, mut cycles) = (0, 0);
    for case in cases(CASES) {
        let (system, velocity) = slider(&case, f64::NAN);
        let Some(system) = system else {
            continue;
        };
        let id = text(&case["id"]);
        let levels = [(1e-6, 1e-5), (1e-9, 2e-9), (1e-12, 2e-12), (1e-14, 1e-13)];
        for (place, (tolerance, allowed)) in levels.into_iter().enumerate() {
            let about = &format!("{id} {tolerance:e}");
            let motion = motion(&system, &case, tolerance);
            let (found, expected) = (passages(&motion, velocity), expected_passages(&case));
            let mut worst = Worst::default();
            assert_eq!(found.len(), expected.len(), "{about}");
            for (found, expected) in std::iter::zip(&found, &expected) {
                assert_eq!(found.1, expected.1, "{about}");
                worst.meet_within(allowed * expected.0, "passage", found.0, expected.0);
                all += 1;
            }
            for state in list(&case["states"]) {
                let time = number(&state["t"]);
                let there = motion.state_at(time).unwrap();
                let [q, r, phi] = ["q", "r", "phi"].map(|name| numbers(&state[name])[0]);
                worst.meet_within(allowed * q, "q", there.displacements[0], q);
                // Velocity and memory change by their sizes over a small part of a cycle.
                let speed = motion.sliding_velocity(0, time);
                worst.meet_within(20.0 * allowed * r.abs(), "r", speed, r);
                worst.meet_within(20.0 * allowed, "φ", there.memory[0], phi);
            }
            worst.assert(about, 1.0);
            // The number of steps of a cycle that a trial with the same series took.
            let most = match id {
                "rs_01" => [97, 132, 178, 178],
                "rs_02" => [86, 118, 163, 163],
                _ => continue,
            };
            let faster = found.iter().filter(|(_, rises)| *rises);
            let times: Vec<f64> = faster.map(|(time, _)| *time).collect();
            for period in times.windows(2) {
                let is_within = |step: &&Step| (period[0]..period[1]).contains(&step.end_time());
                let steps = motion.steps().iter().filter(is_within).count();
                assert!(10 * steps <= 13 * most[place], "{about}: {steps} steps");
                cycles += 1;
            }
        }
    }
    assert_eq!((all, cycles), (4 * 22, 4 * 4));
}

/// Without inertia a small mass is taken: periods tend to those without it in proportion to it.
#[test]
fn periods_without_inertia_are_the_limit_of_small_masses() {
    let cases = cases(CASES);
    let case = cases.iter().find(|case| text(&case["id"]) == "rs_05");
    let case = case.unwrap();
    let expected = numbers(&case["periods"])[1];
    let [damping, stiffness] = ["C", "K"].map(|name| numbers(&case["system"][name][0])[0]);
    let mass = 1e-6 * damping * damping / stiffness;
    let [large, small, least] = [mass, 0.01 * mass, 1e-8].map(|mass| {
        let (system, velocity) = slider(case, mass);
        let motion = motion(&system.unwrap(), case, 1e-14);
        let passages = passages(&motion, velocity);
        let faster: Vec<_> = passages.iter().filter(|(_, rises)| *rises).collect();
        let [.., one, other] = faster[..] else {
            panic!("{faster:?}");
        };
        (other.0 - one.0) / expected - 1.0
    });
    assert!(least.abs() < 1e-14, "{least:e}");
    assert!((large.abs() - 5e-8).abs() < 5e-9, "{large:e}");
    assert!((large / small - 100.0).abs() < 0.1, "{large:e} {small:e}");
}

/// In units of N, D_c and V_p at the stiffness b − a, without inertia a first integral is constant:
/// with a mass it drifts in proportion to the mass.
#[test]
fn first_integrals_drift_in_proportion_to_the_mass() {
    for (made, v0) in [(RateState::aging as Made, 1e-3), (RateState::slip, 1e-5)] {
        let law = made(0.6, 0.01, 0.015, 1.0, v0).unwrap();
        let drift = |mass: f64| {
            let slider = Structure::new(&[mass])
                .and_then(|slider| slider.with_ground_spring(0, 0.005))
                .and_then(|slider| slider.with_contact(Contact::new(0, law, 1.0)?.on_belt(1.0)))
                .unwrap();
            let start = State::new(&[law.steady(1.0) / 0.005], &[0.0]);
            let start = start.with_memory(&[law.memory_at(1.0) - 0.3]);
            let motion = slider.simulate(start, 60.0).unwrap();
            // The start is not at the balance of forces: the speed comes to it at once.
            let integrals = (1..=60).map(|k| {
                let time = f64::from(k);
                let state = motion.state_at(time).unwrap();
                let speed = motion.sliding_velocity(0, time).abs();
                first_integral(&law, 1.0, speed, state.memory[0]).unwrap()
            });
            let integrals: Vec<f64> = integrals.collect();
            let [low, high] = [f64::min, f64::max].map(|of| integrals.iter().copied().reduce(of));
            high.unwrap() - low.unwrap()
        };
        let [large, small, least] = [1e-6, 1e-8, 1e-16].map(drift);
        assert!((large / small - 100.0).abs() < 1.0, "{large:e} {small:e}");
        assert!(least < 1e-11, "{least:e}");
    }
}

/// Sliders in a row, in their displacements, the logarithms of their speeds and φ: N numbers, three
/// for each.
struct Sliders<const N: usize> {
    aging: bool,
    /// f₀, a, b, D_c, V₀.
    numbers: [f64; 5],
    load: f64,
    mass: f64,
    damping: f64,
    /// The stiffness of the spring of each to the ground, and of those between neighbours.
    own: f64,
    between: f64,
    plate: f64,
    weights: Matrix,
}

impl<const N: usize> Sliders<N> {
    const MASSES: usize = N / 3;

    /// Random sliders of stable and of seismic sliding.
    fn of(random: &mut Random) -> Self {
        let aging = random.bits().is_multiple_of(2);
        let a = random.uniform(0.008, 0.02);
        let numbers = [
            random.uniform(0.4, 0.8),
            a,
            a * random.uniform(1.1, 1.8),
            random.logarithmic(1e-5, 1e-2),
            random.logarithmic(1e-7, 1e-5),
        ];
        let [_, a, b, d_c, _] = numbers;
        let load = random.logarithmic(1e3, 1e8);
        let plate = random.logarithmic(1e-9, 1e-5);
        let critical = load * (b - a) / d_c;
        let own = critical * random.uniform(0.2, 1.0);
        let between = critical * random.uniform(0.05, 0.5);
        // Speeds of the order of 0.1 m/s in a quake.
        let damping = random.uniform(0.5, 2.0) * a * load / 0.1;
        let mass = own * random.logarithmic(1e-6, 1e-4) * (d_c / 0.1).powi(2);
        Self {
            aging,
            numbers,
            load,
            mass,
            damping,
            own,
            between,
            plate,
            weights: weights(),
        }
    }

    fn law(&self) -> RateState {
        let made = if self.aging {
            RateState::aging
        } else {
            RateState::slip
        };
        let [f0, a, b, d_c, v0] = self.numbers;
        made(f0, a, b, d_c, v0).unwrap()
    }

    fn structure(&self) -> Result<Structure, Error> {
        let mut system = Structure::new(&vec![self.mass; Self::MASSES])?;
        for i in 0..Self::MASSES {
            system = system
                .with_ground_spring(i, self.own)?
                .with_ground_damper(i, self.damping)?
                .with_force(i, self.damping * self.plate)?
                .with_contact(Contact::new(i, self.law(), self.load)?.on_belt(self.plate))?;
            if i > 0 {
                system = system.with_spring(i - 1, i, self.between)?;
            }
        }
        Ok(system)
    }

    /// The force of all springs of a slider.
    fn springs(&self, y: &[f64; N], i: usize) -> f64 {
        let mut force = self.own * y[i];
        for j in [i.wrapping_sub(1), i + 1] {
            if j < Self::MASSES {
                force += self.between * (y[i] - y[j]);
            }
        }
        force
    }

    fn rates(&self, y: &[f64; N]) -> [f64; N] {
        let [f0, a, b, d_c, v0] = self.numbers;
        let mut rates = [0.0; N];
        for i in 0..Self::MASSES {
            let [x, phi] = [1, 2].map(|place| y[place * Self::MASSES + i]);
            let speed = x.exp();
            let friction = f0 + a * (x - v0.ln()) + b * phi;
            // The damper acts on the sliding speed, as radiated waves do.
            let force = self.load * friction - self.springs(y, i) + self.damping * speed;
            rates[i] = self.plate - speed;
            rates[Self::MASSES + i] = -force / (self.mass * speed);
            rates[2 * Self::MASSES + i] = if self.aging {
                v0 / d_c * (-phi).exp() - speed / d_c
            } else {
                -speed / d_c * (x - v0.ln() + phi)
            };
        }
        rates
    }

    /// One step of Radau IIA, or `None` if Newton's method fails.
    fn step(&self, y: &[f64; N], h: f64) -> Option<[f64; N]> {
        let rates = |y: &[f64; N]| self.rates(y);
        let increment = |at: &[f64; N], by: usize| 1e-7 * at[by].abs().max(1e-3);
        let mut slopes = [[0.0; N]; STAGES];
        let mut last = f64::INFINITY;
        for _ in 0..25 {
            let change = corrections(&self.weights, &rates, &increment, (y, h), &slopes);
            let mut largest = 0.0;
            for (slopes, change) in std::iter::zip(&mut slopes, change) {
                for n in 0..N {
                    slopes[n] += change[n];
                    let size = if n < Self::MASSES {
                        y[n].abs().max(1e-300)
                    } else {
                        1.0
                    };
                    largest = larger(largest, (h * change[n] / size).abs());
                }
            }
            if largest.is_nan() || largest > 1e3 {
                return None;
            }
            // The second condition: only rounding is left.
            if largest < 1e-14 || largest < 1e-10 && largest > 0.1 * last {
                break;
            }
            last = largest;
        }
        Some(end(&self.weights, y, h, &slopes))
    }

    /// Steps over a time, each as long as two halves agree with it.
    fn advance(&self, y: &mut [f64; N], time: f64, h: &mut f64) {
        let mut left = time;
        while left > 0.0 {
            let part = h.min(left);
            let whole = self.step(y, part);
            let halves = self.step(y, 0.5 * part);
            let halves = halves.and_then(|middle| self.step(&middle, 0.5 * part));
            let size = |n: usize| if n < Self::MASSES { y[n].abs() } else { 1.0 };
            let apart = match (whole, halves) {
                (Some(whole), Some(halves)) => (0..N)
                    .map(|n| (whole[n] - halves[n]).abs() / size(n))
                    .fold(0.0, larger),
                _ => f64::NAN,
            };
            if apart < 1e-11 {
                *y = halves.unwrap();
                left -= part;
            }
            let longer = 0.8 * (1e-11 / apart.max(1e-16)).powf(1.0 / 9.0);
            *h = part
                * if apart.is_nan() {
                    0.1
                } else {
                    longer.clamp(0.1, 3.0)
                };
            assert!(*h > 1e-15 * time, "the witness does not advance");
        }
    }

    /// The numbers of a motion at a time.
    fn seen(motion: &Trajectory<State>, time: f64) -> [f64; N] {
        let state = motion.state_at(time).unwrap();
        std::array::from_fn(|n| match (n / Self::MASSES, n % Self::MASSES) {
            (0, i) => state.displacements[i],
            (1, i) => motion.sliding_velocity(i, time).abs().ln(),
            (_, i) => state.memory[i],
        })
    }

    /// Compares the motion of random sliders with the implicit method; returns how far the speed of
    /// the first comes from that of the plate, in powers of e.
    fn compare(random: &mut Random, number: usize, worst: &mut Worst) -> f64 {
        let sliders = Self::of(random);
        let (law, plate) = (sliders.law(), sliders.plate);
        let [_, a, _, d_c, _] = sliders.numbers;
        let system = sliders.structure().unwrap();
        let steady = sliders.load * law.steady(plate) / sliders.own;
        let phi = law.memory_at(plate) + random.uniform(-1.5, 1.5);
        let apart: Vec<f64> = (0..Self::MASSES)
            .map(|_| random.uniform(-0.1, 0.1))
            .collect();
        let start = |by: f64| {
            let displacements: Vec<f64> = apart.iter().map(|x| (1.0 - 0.2 * x) * steady).collect();
            let mut memory: Vec<f64> = apart.iter().map(|x| phi + x).collect();
            memory[0] += by;
            State::new(&displacements, &[0.0].repeat(Self::MASSES)).with_memory(&memory)
        };
        let unit = d_c / plate;
        let times: Vec<f64> = (1..=8).map(|k| 6.0 * unit * f64::from(k)).collect();
        let about = format!(
            "{number}: {} masses, {law:?}, {}",
            Self::MASSES,
            sliders.load
        );
        let run = |by: f64| system.simulate(start(by), times[7]).expect(&about);
        let (motion, nearby) = (run(0.0), run(1e-7));
        // The witness begins on the manifold.
        let from = 1e-3 * unit;
        let (mut y, mut now, mut h) = (Self::seen(&motion, from), from, 1e-6 * unit);
        let mut farthest = 0.0_f64;
        for time in times {
            sliders.advance(&mut y, time - now, &mut h);
            now = time;
            let (found, beside) = (Self::seen(&motion, time), Self::seen(&nearby, time));
            for n in 0..N {
                let is_displacement = n < Self::MASSES;
                let size = if is_displacement {
                    sliders.load * a / sliders.own
                } else {
                    1.0
                };
                let spread = (beside[n] - found[n]).abs() / 1e-7;
                let allowed = 1e-10 * size + 1e-11 * spread;
                worst.meet_within(allowed, &about, found[n], y[n]);
            }
            farthest = farthest.max((found[Self::MASSES] - plate.ln()).abs());
        }
        farthest
    }
}

/// A plate that stops under a block at rest: the sliding speed is 0 there, and the numbers of both
/// ends of the step are those of their states.
#[test]
fn a_plate_that_stops_takes_no_number_from_a_state() {
    let law = RateState::aging(0.62, 0.010, 0.014, 15e-6, 1e-6).unwrap();
    let (stiffness, load, plate) = (1e7, 1e4, 1e-6);
    let stops = [(0.0, plate), (10.0, plate), (10.0, 0.0), (20.0, 0.0)];
    let block = Structure::new(&[20.0])
        .and_then(|block| block.with_ground_spring(0, stiffness))
        .and_then(|block| {
            let contact = Contact::new(0, law, load)?;
            block.with_contact(contact.on_belt(Drive::profile(&stops)?))
        })
        .unwrap();
    let place = load * law.steady(plate) / stiffness;
    let start = State::new(&[place], &[0.0]).with_memory(&[law.memory_at(plate)]);
    let start = start.with_sliding(0, -plate);
    let mut flow = Integrator::new().flow(&block, start).unwrap();
    let step = flow.next().unwrap().unwrap();
    for (state, speed) in [(step.state(), -plate), (&step.end_state(), 0.0)] {
        assert_eq!(state.displacements, [place]);
        assert_eq!(state.velocities, [0.0]);
        assert_eq!(state.memory, [0.0]);
        assert_eq!(state.sliding(), [(0, speed)]);
    }
}

/// A fault far from the balance of forces, with φ = 0 and V₀ = 1e-6: from rest, from slip against
/// the plate and from the plate's velocity, it comes to the same speed at once.
#[test]
fn the_speed_at_the_start_is_forgotten() {
    let (load, plate) = (5e7, 1e-9);
    let law = RateState::aging(0.6, 0.01, 0.015, 0.008, 1e-6).unwrap();
    let fault = Structure::new(&[3.9e6])
        .and_then(|fault| fault.with_ground_spring(0, 1.5625e7))
        .and_then(|fault| fault.with_ground_damper(0, 4.6e6))
        .and_then(|fault| fault.with_force(0, 4.6e6 * plate))
        .and_then(|fault| fault.with_contact(Contact::new(0, law, load)?.on_belt(plate)))
        .unwrap();
    let seen = |part: f64, speed: f64| {
        let start = State::new(&[part * load / 1.5625e7], &[0.0]);
        let start = start.with_memory(&[0.0]).with_sliding(0, speed);
        let motion = fault.simulate(start, 1e4).unwrap();
        let late = motion.state_at(1e4).unwrap();
        let speed = -motion.sliding_velocity(0, 1e4);
        assert!(motion.steps().len() < 5000, "{}", motion.steps().len());
        [late.displacements[0], speed.ln(), late.memory[0]]
    };
    for part in [0.5, 0.6, 0.7, 0.9] {
        let expected = seen(part, -plate);
        for speed in [0.0, plate, 1e-300, -1e-308, -1e-12, -1e-4] {
            let found = seen(part, speed);
            // Of 1e-4 m/s, which fall in m V/(5 N a) = 1.6e-4 s over a part 1e-6 of D_c, ln V
            // remembers at most b/a as much.
            let allowed = 1e-9 + 2e-2 * speed.abs();
            for (found, expected) in std::iter::zip(found, expected) {
                assert!(
                    (found - expected).abs() < allowed,
                    "{part}, {speed}: {found} {expected}"
                );
            }
        }
    }
}

/// The block of a laboratory: 1e7 N/m, 1e4 N, V₀ = 1e-6 m/s.
fn block(law: RateState, mass: f64, plate: Drive) -> Structure {
    Structure::new(&[mass])
        .and_then(|block| block.with_ground_spring(0, 1e7))
        .and_then(|block| block.with_contact(Contact::new(0, law, 1e4)?.on_belt(plate)))
        .unwrap()
}

/// A plate that stops at once leaves the block at rest: the rate at which its speed settles is
/// above the resolution of the clock. It moves on as from a creep of 1e-9 m/s.
#[test]
fn a_block_creeps_on_where_its_plate_stops_at_once() {
    let law = RateState::aging(0.62, 0.010, 0.014, 15e-6, 1e-6).unwrap();
    let plate = 1e-6;
    let stops = [(0.0, plate), (10.0, plate), (10.0, 0.0), (110.0, 0.0)];
    let system = block(law, 20.0, Drive::profile(&stops).unwrap());
    let start = State::new(&[1e4 * law.steady(plate) / 1e7], &[0.0]).with_memory(&[0.0]);
    let whole = system
        .simulate(start.clone().with_sliding(0, -plate), 110.0)
        .unwrap();
    assert!(whole.steps().len() < 150, "{}", whole.steps().len());
    let held = block(law, 20.0, 0.0.into());
    let after = held.simulate(start.with_sliding(0, -1e-9), 100.0).unwrap();
    for time in [1e-3, 1.0, 100.0] {
        let [found, expected] = [
            whole.state_at(10.0 + time).unwrap(),
            after.state_at(time).unwrap(),
        ];
        let off = (found.sliding()[0].1 / expected.sliding()[0].1).ln().abs();
        // The clock at 10 has an error of 2e-15 in a millisecond; V has f/a roundings.
        assert!(off < 1e-11, "{time}: {off:e}");
        // 1e-9 m/s last for m V/(Na) = 2e-7 s.
        let off = (found.displacements[0] - expected.displacements[0]).abs();
        assert!(off < 2e-16, "{time}: {off:e}");
        // 2e-16 of D_c.
        assert!((found.memory[0] - expected.memory[0]).abs() < 2e-11);
    }
}

/// A plate that stops in a time of one rounding of the clock, of hundreds or of more: the block
/// creeps on as where its plate stops at once.
#[test]
fn a_plate_may_stop_in_any_time() {
    let law = RateState::aging(0.62, 0.010, 0.014, 15e-6, 1e-6).unwrap();
    let plate = 1e-6;
    let seen = |ramp: f64| {
        let stops = [
            (0.0, plate),
            (10.0, plate),
            (10.0 + ramp, 0.0),
            (110.0, 0.0),
        ];
        let system = block(law, 20.0, Drive::profile(&stops).unwrap());
        let start = State::new(&[1e4 * law.steady(plate) / 1e7], &[0.0]).with_memory(&[0.0]);
        let motion = system.simulate(start.with_sliding(0, -plate), 110.0);
        let motion = motion.unwrap_or_else(|error| panic!("{ramp}: {error}"));
        assert!(motion.steps().len() < 150, "{}", motion.steps().len());
        motion.sliding_velocity(0, 110.0)
    };
    let at_once = seen(0.0);
    let decades = (0..9).map(|decade| 2e-15 * 10_f64.powi(decade));
    for ramp in decades.chain([1e-12, 1e-11]) {
        // The memory changes by V t/D_c meanwhile.
        let allowed = 1e-12 + plate * ramp / 15e-6;
        let off = (seen(ramp) / at_once).ln().abs();
        assert!(off < allowed, "{ramp}: {off:e}");
    }
}

/// A block thrown against its spring turns back: its speed falls by up to eighty decades within
/// the rounding of any time. Beside Runge-Kutta's method over u = kq/(Na) − mr'/(Na), with r =
/// 2V₀ e^{−L} sinh u, and then on the slow manifold, u = −kq/(Na).
#[test]
fn slip_turns_back_however_large_the_memory() {
    let (v0, d_c, plate, a, b, load, stiffness) = (1e-6, 15e-6, 1e-6, 0.01, 0.014, 1e4, 1e7);
    let mut random = Random::new(55);
    for number in 0..count(6, 100) {
        let is_aging = number % 2 == 0;
        let law = match is_aging {
            true => RateState::aging(0.62, a, b, d_c, v0).unwrap(),
            false => RateState::slip(0.62, a, b, d_c, v0)
                .and_then(|law| law.with_least_speed(1e-300))
                .unwrap(),
        };
        let mass = 10_f64.powf(random.uniform(-4.0, 2.0));
        let phi = random.uniform(0.0, 100.0);
        let part = random.uniform(0.2, 0.9);
        let speed = 10_f64.powf(random.uniform(-25.0, -1.0));
        let what = format!("{is_aging} {mass} {phi} {part} {speed}");
        let place = part * 0.62e-3;
        let start = State::new(&[place], &[0.0]).with_memory(&[phi]);
        let system = block(law, mass, plate.into());
        let motion = system.simulate(start.with_sliding(0, speed), 1.0);
        let motion = motion.unwrap_or_else(|error| panic!("{what}: {error}"));
        let kinds: Vec<EventKind> = motion.events().iter().map(|event| event.kind).collect();
        assert_eq!(kinds, [EventKind::Crossing(Direction::Lagging)], "{what}");
        let found = motion.last();

        let exponent = |phi: f64| (0.62 + b * phi) / a;
        let heals = |phi: f64, speed: f64| match is_aging {
            true => (v0 * (-phi).exp() - speed.abs()) / d_c,
            false => -speed.abs() / d_c * ((speed.abs() / v0).max(1e-300).ln() + phi),
        };
        let balance = |q: f64| -stiffness * q / (load * a);
        // d(q, φ, t)/du.
        let turning = |u: f64, [q, phi, _]: [f64; 3]| {
            let l = exponent(phi);
            let [ahead, behind] = [(u - l).exp(), (-u - l).exp()];
            let r = v0 * (ahead - behind);
            let rate = load * a * (balance(q) - u) / mass + b / a * heals(phi, r) * r;
            let time = v0 * (ahead + behind) / rate;
            [(plate + r) * time, heals(phi, r) * time, time]
        };
        let mut y = [place, phi, 0.0];
        let mut u = exponent(phi) + (speed / v0).ln();
        while u > balance(y[0]) + 1e-3 {
            let h = -(0.02_f64).min(0.25 * (u - balance(y[0])));
            y = runge_kutta(u, y, h, turning);
            u += h;
        }
        let creeping = |_, [q, phi, _]: [f64; 3]| {
            let r = -v0 * (-balance(q) - exponent(phi)).exp();
            [plate + r, heals(phi, r), 1.0]
        };
        while y[2] < 1.0 {
            let h = (0.02 * (d_c / v0 * y[1].exp() + y[2])).min(1.0 - y[2]);
            y = runge_kutta(0.0, y, h, creeping);
        }
        let r = v0 * (-balance(y[0]) - exponent(y[1])).exp();
        let off = (found.displacements[0] - y[0]).abs();
        assert!(off < 1e-14, "{what}: {off:e}");
        let off = (found.memory[0] - y[1]).abs();
        assert!(off < 1e-9, "{what}: {off:e}");
        let off = (-found.sliding()[0].1 / r).ln().abs();
        assert!(off < 2e-9, "{what}: {off:e}");
    }
}

/// Pads that share the load of a block move as one: their directions depend on each other, and
/// their speeds settle together.
#[test]
fn pads_that_share_a_load_move_as_one() {
    let mut random = Random::new(59);
    for _ in 0..count(6, 40) {
        let law = RateState::aging(0.62, 0.01, 0.014, 15e-6, 1e-6).unwrap();
        let plate = 10_f64.powf(random.uniform(-9.0, -4.0));
        let mass = 10_f64.powf(random.uniform(-4.0, 2.0));
        let phi = random.uniform(0.0, 100.0);
        let place = random.uniform(-0.9, 0.9) * 0.62e-3;
        let speed = 10_f64.powf(random.uniform(-25.0, -1.0));
        let side = if random.bits().is_multiple_of(2) {
            1.0
        } else {
            -1.0
        };
        let what = format!("{mass} {phi} {place} {plate} {}", side * speed);
        let seen = |parts: &[f64]| {
            let pads = parts.iter().map(|part| {
                let pad = Contact::new(0, law, 1e4 * part).unwrap();
                pad.on_belt(plate)
            });
            let system = Structure::new(&[mass])
                .and_then(|block| block.with_ground_spring(0, 1e7))
                .and_then(|block| block.with_contacts(pads))
                .unwrap();
            let start = State::new(&[place], &[0.0]).with_memory(&vec![phi; parts.len()]);
            let start =
                (0..parts.len()).fold(start, |start, c| start.with_sliding(c, side * speed));
            let motion = system.simulate(start, 0.1);
            motion
                .unwrap_or_else(|error| panic!("{parts:?} {what}: {error}"))
                .last()
        };
        let (one, all) = (seen(&[1.0]), seen(&[0.2, 0.3, 0.5]));
        let off = (one.displacements[0] - all.displacements[0]).abs();
        assert!(off < 1e-14, "{what}: {off:e}");
        for c in 0..3 {
            let off = (one.memory[0] - all.memory[c]).abs();
            assert!(off < 1e-9, "{what}: {off:e}");
            let ratio = all.sliding()[c].1 / one.sliding()[0].1;
            assert!((ratio - 1.0).abs() < 2e-9, "{what}: {ratio}");
        }
    }
}

/// Two masses that creep on plates, with a creeping contact between them, move the same in either
/// order: the speeds of contacts that share masses settle together.
#[test]
fn masses_that_share_a_contact_move_the_same_in_either_order() {
    let mut random = Random::new(60);
    for _ in 0..count(2, 20) {
        let law = RateState::aging(0.62, 0.01, 0.014, 15e-6, 1e-6).unwrap();
        let plate = 10_f64.powf(random.uniform(-9.0, -5.0));
        let masses = [(); 2].map(|()| 10_f64.powf(random.uniform(-1.0, 1.0)));
        let stiffness = [(); 2].map(|()| 10_f64.powf(random.uniform(6.0, 7.0)));
        let places = [0, 1].map(|i| random.uniform(-0.9, 0.9) * 6.2e3 / stiffness[i]);
        let speeds = [(); 2].map(|()| 10_f64.powf(random.uniform(-12.0, -2.0)));
        let phi = [(); 3].map(|()| random.uniform(0.0, 60.0));
        let what = format!("{masses:?} {stiffness:?} {places:?} {speeds:?} {phi:?} {plate}");
        let seen = |order: [usize; 2]| {
            let mut system = Structure::new(&order.map(|i| masses[i])).unwrap();
            for (place, i) in order.into_iter().enumerate() {
                let own = Contact::new(place, law, 1e4).unwrap().on_belt(plate);
                system = system
                    .with_ground_spring(place, stiffness[i])
                    .and_then(|system| system.with_contact(own))
                    .unwrap();
            }
            let between = Contact::between(order[0], order[1], law, 1e4).unwrap();
            let system = system.with_contact(between).unwrap();
            let start = State::new(&order.map(|i| places[i]), &order.map(|i| speeds[i]));
            let memory = [phi[order[0]], phi[order[1]], phi[2]];
            let motion = system.simulate(start.with_memory(&memory), 0.01);
            motion
                .unwrap_or_else(|error| panic!("{what}: {error}"))
                .last()
        };
        let [found, turned] = [[0, 1], [1, 0]].map(seen);
        for i in 0..2 {
            let off = (found.displacements[i] - turned.displacements[1 - i]).abs();
            assert!(off < 1e-13, "{what}: {off:e}");
            let off = (found.memory[i] - turned.memory[1 - i]).abs();
            assert!(off < 1e-8, "{what}: {off:e}");
        }
        let off = (found.memory[2] - turned.memory[2]).abs();
        assert!(off < 1e-8, "{what}: {off:e}");
    }
}

/// Structures of one to three masses with creeping contacts of any memory, on plates, on the ground
/// and between masses, some beside Coulomb's friction, thrown at speeds of 25 decades against
/// strong springs: each motion goes on, and its energies balance.
#[test]
fn structures_that_are_thrown_move_on() {
    const STEPS: usize = 2000;
    let mut random = Random::new(61);
    for number in 0..count(4, 100) {
        let size = 1 + (random.bits() % 3) as usize;
        let masses: Vec<f64> = (0..size).map(|_| random.logarithmic(1e-3, 1e2)).collect();
        let load = random.logarithmic(1e3, 1e6);
        let plate = random.logarithmic(1e-9, 1e-4);
        let mut system = Structure::new(&masses).unwrap();
        let (mut contacts, mut memory, mut sliding) = (0, Vec::new(), Vec::new());
        let mut stiffnesses = vec![0.0; size];
        let mut add = |system: Structure, at: [Option<usize>; 2], random: &mut Random| {
            let a = random.uniform(0.008, 0.02);
            let b = random.uniform(0.5, 1.8) * a;
            let d_c = random.logarithmic(1e-6, 1e-4);
            let f0 = random.uniform(0.4, 0.8);
            let law = match random.bits().is_multiple_of(2) {
                true => RateState::aging(f0, a, b, d_c, 1e-6),
                false => RateState::slip(f0, a, b, d_c, 1e-6)
                    .and_then(|law| law.with_least_speed(1e-300)),
            };
            let law: AnyContactLaw<Coulomb> = match contacts > 0 && random.bits().is_multiple_of(4)
            {
                true => AnyContactLaw::Dry(Coulomb::new(0.6, 0.5).unwrap()),
                false => law.unwrap().into(),
            };
            let creeps = matches!(law, AnyContactLaw::RateState(_));
            let load = load * random.uniform(0.3, 1.5);
            let contact = match at {
                [Some(i), Some(j)] => Contact::between(i, j, law, load),
                _ => Contact::new(at[0].unwrap(), law, load),
            };
            let moves = at[1].is_none() && random.bits().is_multiple_of(2);
            let contact = contact.unwrap().on_belt(if moves { plate } else { 0.0 });
            if creeps && random.bits().is_multiple_of(2) {
                let side = random.uniform(-1.0, 1.0).signum();
                sliding.push((contacts, side * random.logarithmic(1e-25, 1.0)));
            }
            memory.push(match creeps {
                true => random.uniform(-20.0, 100.0),
                false => 0.0,
            });
            contacts += 1;
            system.with_contact(contact).unwrap()
        };
        for i in 0..size {
            let stiffness = load * random.logarithmic(10.0, 1e4);
            system = system.with_ground_spring(i, stiffness).unwrap();
            stiffnesses[i] += stiffness;
            if random.bits().is_multiple_of(2) {
                let damping = (stiffness * masses[i]).sqrt() * random.logarithmic(0.01, 10.0);
                system = system.with_ground_damper(i, damping).unwrap();
            }
            if i == 0 || random.bits().is_multiple_of(2) {
                system = add(system, [Some(i), None], &mut random);
            }
            if i > 0 {
                let stiffness = load * random.logarithmic(10.0, 1e4);
                system = system.with_spring(i - 1, i, stiffness).unwrap();
                stiffnesses[i - 1] += stiffness;
                stiffnesses[i] += stiffness;
                if random.bits().is_multiple_of(2) {
                    system = add(system, [Some(i - 1), Some(i)], &mut random);
                }
            }
        }
        let places: Vec<f64> = (0..size).map(|_| random.uniform(-1e-3, 1e-3)).collect();
        let mut start = State::new(&places, &vec![0.0; size]).with_memory(&memory);
        for (contact, velocity) in sliding {
            start = start.with_sliding(contact, velocity);
        }
        let integrator = Integrator::new().with_max_steps(STEPS).unwrap();
        let motion = match integrator.simulate_until(&system, start, 1.0, |_| None) {
            // Speeds of contacts with dependent directions that do not fit together.
            Err(Error::InvalidParameter {
                name: "sliding", ..
            }) => continue,
            motion => motion.unwrap_or_else(|error| panic!("{number}: {error}")),
        };
        match motion.ended() {
            Ended::Error(Error::TooManySteps { .. }) | Ended::Duration => {}
            ended => panic!("{number}: {ended:?}, {system:?}"),
        }
        let budget = system.energy_budget(&motion).unwrap();
        let springs = std::iter::zip(&stiffnesses, &places);
        let energy = springs.map(|(k, q)| k * q * q).sum::<f64>();
        let turnover = budget.friction_loss.iter().sum::<f64>() + energy;
        let defect = budget.defect().abs();
        assert!(
            defect < 1e-12 * turnover,
            "{number}: {defect:e} {turnover:e}"
        );
    }
}

/// A spring that is stronger than friction: from any speed below 1e-12 m/s the motion is that from
/// there, to the time in which that speed is reached.
#[test]
fn a_strong_spring_starts_slip_from_any_speed() {
    let mut random = Random::new(57);
    for _ in 0..count(5, 80) {
        let law = RateState::aging(0.62, 0.01, 0.014, 15e-6, 1e-6).unwrap();
        let mass = 10_f64.powf(random.uniform(-3.0, 2.0));
        let phi = random.uniform(-10.0, 60.0);
        let place = random.uniform(2.5, 8.0) * 0.62e-3;
        let system = block(law, mass, 1e-6.into());
        let period = (mass / 1e7).sqrt();
        let seen = |speed: f64| {
            let start = State::new(&[place], &[0.0]).with_memory(&[phi]);
            let motion = system.simulate(start.with_sliding(0, speed), period);
            let motion = motion.unwrap_or_else(|error| panic!("{mass} {phi} {speed}: {error}"));
            motion.last()
        };
        let expected = seen(-1e-12);
        for speed in [0.0, -1e-300, 1e-300, 1e-30, -1e-20, 1e-13] {
            let found = seen(speed);
            // The spring has 2.5 · 0.62 and more of the load, friction 1.46 and less.
            let fastest = place / period;
            let off = (found.velocities[0] - expected.velocities[0]).abs();
            assert!(
                off < 1e-11 + 1e-12 * fastest,
                "{mass} {phi} {speed}: {off:e}"
            );
            let off = (found.displacements[0] - expected.displacements[0]).abs();
            assert!(
                off < 1e-11 * period + 1e-12 * place,
                "{mass} {phi} {speed}: {off:e}"
            );
        }
    }
}

/// Two masses that vibrate together, held by a contact between them whose memory is so large that
/// its creep is nothing: beside Coulomb's contact in stick. Each reversal of its force is one of
/// creep, r = 2V₀ e^{−L} sinh(F/(Na)).
#[test]
fn a_contact_that_hardly_creeps_moves_as_one_in_stick() {
    let mut random = Random::new(58);
    for _ in 0..count(10, 200) {
        let law = RateState::aging(0.62, 0.01, 0.014, 15e-6, 1e-6).unwrap();
        let phi = random.uniform(20.0, 140.0);
        let masses = [(); 2].map(|()| 10_f64.powf(random.uniform(-1.0, 1.0)));
        let stiffness = [(); 2].map(|()| 10_f64.powf(random.uniform(6.0, 7.0)));
        let places = [(); 2].map(|()| random.uniform(-0.3e-3, 0.3e-3));
        let made = |contact: Contact| {
            Structure::new(&masses)
                .and_then(|made| made.with_ground_spring(0, stiffness[0]))
                .and_then(|made| made.with_ground_spring(1, stiffness[1]))
                .and_then(|made| made.with_contact(contact))
                .unwrap()
        };
        let end = 10.0 * (masses[0] / stiffness[0]).sqrt();
        let held = made(Contact::between(0, 1, Coulomb::new(2.0, 1.0).unwrap(), 1e4).unwrap());
        let start = State::new(&places, &[0.0; 2]);
        let expected = held.simulate(start.clone(), end).unwrap().last();
        let force = held.carried(end, &expected).unwrap()[0].force;
        let creeping = made(Contact::between(0, 1, law, 1e4).unwrap());
        let found = creeping.simulate(start.with_memory(&[phi]), end);
        let what = format!("{masses:?} {stiffness:?} {places:?} {phi}");
        let found = found
            .unwrap_or_else(|error| panic!("{what}: {error}"))
            .last();
        for (found, expected) in std::iter::zip(&found.displacements, &expected.displacements) {
            assert!(
                (found - expected).abs() < 1e-15,
                "{what}: {found} {expected}"
            );
        }
        let exponent = (0.62 + 0.014 * found.memory[0]) / 0.01;
        let creep = 2e-6 * (force / (1e4 * 0.01)).sinh() * (-exponent).exp();
        let ratio = found.sliding()[0].1 / creep;
        assert!((ratio - 1.0).abs() < 1e-9, "{what}: {ratio}");
    }
}

/// A block that was thrown comes to rest and creeps back with its plate: its spring relaxes, and
/// the force and the speed pass 0, where both are rounding, in one event.
#[test]
fn creep_reverses_where_its_spring_is_relaxed() {
    let mut random = Random::new(56);
    for _ in 0..count(10, 400) {
        let law = RateState::aging(0.62, 0.01, 0.014, 15e-6, 1e-6).unwrap();
        let plate = 10_f64.powf(random.uniform(-9.0, -3.0));
        let mass = 10_f64.powf(random.uniform(-3.0, 2.0));
        let phi = random.uniform(-10.0, 60.0);
        let place = random.uniform(0.1, 0.8) * 0.62e-3;
        let start = State::new(&[-place], &[plate]).with_memory(&[phi]);
        let system = block(law, mass, plate.into());
        let motion = system.simulate(start, 1.5 * place / plate);
        let motion = motion.unwrap_or_else(|error| panic!("{mass} {phi} {plate}: {error}"));
        let events = motion.events();
        let kinds: Vec<EventKind> = events.iter().map(|event| event.kind).collect();
        let crossing = EventKind::Crossing(Direction::Lagging);
        assert_eq!(kinds, [crossing], "{mass} {phi} {plate}");
        // The block slides V t ahead of the plate meanwhile.
        let off = (events[0].state.displacements[0] / place).abs();
        assert!(off < 1e-13, "{mass} {phi} {plate}: {off:e}");
    }
}

/// At rest with a memory so large that the speed settles within the rounding of any time: the
/// motion is that from the speed r = −2V₀ e^{−L} sinh(kq/(Na)) at which forces balance.
#[test]
fn a_start_at_rest_settles_however_large_its_memory() {
    let mut random = Random::new(54);
    for number in 0..count(12, 400) {
        let laws = [RateState::aging, RateState::slip];
        let made = laws[number % 2](0.62, 0.01, 0.014, 15e-6, 1e-6);
        let law = made.unwrap().with_least_speed(1e-300).unwrap();
        let mass = 10_f64.powf(random.uniform(-4.0, 2.0));
        let phi = random.uniform(25.0, 140.0);
        let part = random.uniform(0.2, 1.1);
        let system = block(law, mass, 1e-6.into());
        let start = State::new(&[part * 0.62e-3], &[0.0]).with_memory(&[phi]);
        let balance = ((part - 1.0) * 0.62 - 0.014 * phi) / 0.01;
        let seen = |speed: f64| {
            let motion = system.simulate(start.clone().with_sliding(0, speed), 1.0);
            let motion = motion.unwrap_or_else(|error| panic!("{mass} {phi} {part}: {error}"));
            assert!(motion.steps().len() < 100, "{}", motion.steps().len());
            motion.last()
        };
        let expected = seen(-1e-6 * balance.exp());
        for speed in [0.0, -1e-300] {
            let found = seen(speed);
            let ratio = found.sliding()[0].1 / expected.sliding()[0].1;
            assert!(ratio.ln().abs() < 1e-11, "{mass} {phi} {part}: {ratio}");
            assert!((found.displacements[0] - expected.displacements[0]).abs() < 1e-17);
            assert!((found.memory[0] - expected.memory[0]).abs() < 1e-13 * phi);
        }
    }
}

/// A fault whose friction rises with the speed, near steady sliding, where rounding errors of the
/// coefficients limit the reach of the slow series: D_c/V = 8e6 s. The force at the start is less
/// than that of steady sliding by c V: beside Runge-Kutta's method for the linearised motion.
#[test]
fn steady_sliding_takes_few_steps() {
    let plate = 1e-9;
    let settling = |k: f64, b: f64| {
        let [stiffness, rise, fall] = [k, 5e7 * 0.01 + 4.6e6 * plate, 5e7 * b];
        let speed = |[q, phi]: [f64; 2]| (stiffness * q - fall * phi) / rise;
        let rates = |_, y: [f64; 2]| [-plate * speed(y), -plate / 0.008 * (y[1] + speed(y))];
        let mut y = [-4.6e6 * plate / k, 0.0];
        for _ in 0..20_000 {
            y = runge_kutta(0.0, y, 5.5e8 / 20_000.0, rates);
        }
        speed(y)
    };
    for (k, b) in [(1.6e6, 0.005), (1.6e7, 0.001), (1.6e7, 0.005), (1.6e8, 0.0)] {
        let law = RateState::aging(0.6, 0.01, b, 0.008, 1e-6).unwrap();
        let fault = Structure::new(&[3.90625e6])
            .and_then(|fault| fault.with_ground_spring(0, k))
            .and_then(|fault| fault.with_ground_damper(0, 4.6e6))
            .and_then(|fault| fault.with_force(0, 4.6e6 * plate))
            .and_then(|fault| fault.with_contact(Contact::new(0, law, 5e7)?.on_belt(plate)))
            .unwrap();
        for part in [1.0, 1.1] {
            let start = State::new(&[5e7 * law.steady(plate) / k], &[0.0]);
            let start = start.with_memory(&[law.memory_at(part * plate)]);
            let start = start.with_sliding(0, -part * plate);
            let motion = fault.simulate(start, 5.5e8).unwrap();
            let steps = motion.steps().len();
            assert!(steps < 60, "{k} {b}: {steps}");
            if part == 1.0 {
                let found = -motion.last().sliding()[0].1 / plate - 1.0;
                let off = found - settling(k, b);
                assert!(off.abs() < 1e-13, "{k} {b}: {off:e}");
            }
        }
    }
}

/// A memory that heals at 7e11 times its unit per second, so that its last coefficients overflow:
/// beside Runge-Kutta's method in θ.
#[test]
fn memories_whose_series_overflow_are_followed() {
    let law = RateState::aging(0.62, 0.010, 0.014, 15e-6, 1e-6).unwrap();
    let (plate, d_c, v0, end) = (1e-6, 15e-6, 1e-6, 1e-5);
    let system = block(law, 20.0, plate.into());
    for speed in [1.0, -1.0] {
        let start = State::new(&[0.62e-3], &[0.0]).with_memory(&[-30.0]);
        let start = start.with_sliding(0, speed);
        let found = system.simulate(start, end).unwrap().last();
        let rates = |_, [q, r, theta]: [f64; 3]| {
            let x = r / (2.0 * v0) * ((0.62 + 0.014 * (v0 * theta / d_c).ln()) / 0.01).exp();
            let force = -1e7 * q - 1e4 * 0.01 * x.asinh();
            [plate + r, force / 20.0, 1.0 - r.abs() * theta / d_c]
        };
        let mut y = [0.62e-3, speed, d_c / v0 * (-30.0_f64).exp()];
        let mut time = 0.0;
        while time < end {
            let h = (0.02 * (y[2] + time)).min(1e-8).min(end - time);
            y = runge_kutta(time, y, h, rates);
            time = if h < end - time { time + h } else { end };
        }
        let phi = (v0 * y[2] / d_c).ln();
        assert!((found.sliding()[0].1 - y[1]).abs() < 1e-11);
        assert!((found.displacements[0] - y[0]).abs() < 1e-13);
        assert!(
            (found.memory[0] - phi).abs() < 1e-8,
            "{}",
            found.memory[0] - phi
        );
    }
}

/// One to three sliders of both laws, of stable and of seismic sliding, over several decades of
/// their speeds, beside an implicit method in the logarithm of the speed.
#[test]
fn random_sliders_move_as_by_an_implicit_method() {
    let mut random = Random::new(81);
    let (mut worst, mut farthest) = (Worst::default(), 0.0_f64);
    for number in 0..count(2, 67) {
        let moved = [
            Sliders::<3>::compare(&mut random, number, &mut worst),
            Sliders::<6>::compare(&mut random, number, &mut worst),
            Sliders::<9>::compare(&mut random, number, &mut worst),
        ];
        farthest = moved.into_iter().fold(farthest, f64::max);
    }
    worst.assert("Radau", 1.0);
    assert!(farthest > 3.0, "{farthest}");
}

/// Years of a fault in constant memory: 2000 in a usual run, 20 000 in a full count, a million with
/// `FULL=50`. Once the motion has become periodic, each cycle takes as long as the one before.
#[test]
fn cycles_go_on_for_thousands_of_years() {
    const YEAR: f64 = 365.25 * 86400.0;
    let cases = cases(CASES);
    let case = cases.iter().find(|case| text(&case["id"]) == "rs_01");
    let (system, plate) = slider(case.unwrap(), f64::NAN);
    let system = system.unwrap();
    let end = count(2_000, 20_000) as f64 * YEAR;
    let (mut begins, mut last, mut steps) = (Vec::<f64>::new(), None::<Step>, 0_usize);
    for step in Integrator::new()
        .flow(&system, start(case.unwrap()))
        .unwrap()
    {
        let step = step.unwrap();
        steps += 1;
        let speed = |state: &State| state.sliding()[0].1.abs();
        // The first passage upward of a quake: V is least at its start.
        let [from, to] = [step.state(), &step.end_state()].map(|state| speed(state) > 1e3 * plate);
        if !from && to {
            begins.push(
                step.first_zero(|state| (speed(state) / plate).ln() - 1e3_f64.ln())
                    .unwrap(),
            );
        }
        let is_over = step.end_time() > end;
        last = Some(step);
        if is_over {
            break;
        }
    }
    let last = last.unwrap();
    let periods: Vec<f64> = begins.windows(2).map(|pair| pair[1] - pair[0]).collect();
    // One multiplier is 0.04.
    let settled = &periods[14..];
    assert!(
        settled.len() as f64 > end / (22.0 * YEAR),
        "{}",
        settled.len()
    );
    let mean = settled.iter().sum::<f64>() / settled.len() as f64;
    for period in settled {
        // Rounding of times, and of the speed.
        let allowed = 2e-13 * mean + 2.0 * f64::EPSILON * last.end_time();
        assert!((period - mean).abs() < allowed, "{period} {mean}");
    }
    assert!(steps < 200 * begins.len() + 400, "{steps}");
    let [q] = last.end_state().displacements[..] else {
        unreachable!("one slider");
    };
    assert!((0.0..3.0).contains(&q), "{q}");
}
