//! Elastic contacts, alone and among rigid ones: two motions never come apart, energy is what the
//! forces and the sliders leave, and many elements act as the joint that they stand for.

use std::f64::consts::{PI, TAU};

use stick_slip::nalgebra::{DMatrix, DVector};
use stick_slip::structure::State;
use stick_slip::{
    Contact, Coulomb, Direction, Drive, Error, EventKind, Iwan4, Mode, Segment, Structure,
    Trajectory,
};

use crate::common::orbit::integrate;
use crate::common::{Random, count, larger, one_mass, some};

/// A mean value and one harmonic.
#[derive(Debug, Clone, Copy)]
struct Wave {
    mean: f64,
    amplitude: f64,
    frequency: f64,
    phase: f64,
}

impl Wave {
    fn random(random: &mut Random, mean: f64, amplitude: f64) -> Self {
        Self {
            mean,
            amplitude,
            frequency: random.uniform(0.5, 3.0),
            phase: random.uniform(0.0, TAU),
        }
    }

    fn at(&self, time: f64) -> f64 {
        self.mean + self.amplitude * (self.frequency * time + self.phase).cos()
    }

    fn rate(&self, time: f64) -> f64 {
        -self.amplitude * self.frequency * (self.frequency * time + self.phase).sin()
    }

    fn drive(&self) -> Drive {
        Drive::constant(self.mean)
            .with_harmonic(self.amplitude, self.frequency, self.phase)
            .unwrap()
    }
}

#[derive(Debug, Clone)]
struct Joint {
    direction: Vec<f64>,
    /// None: rigid.
    stiffness: Option<f64>,
    friction: f64,
    load: Wave,
    surface: Wave,
}

/// A structure whose loads and belts are functions of time alone.
#[derive(Debug, Clone)]
struct Given {
    mass: DMatrix<f64>,
    damping: DMatrix<f64>,
    stiffness: DMatrix<f64>,
    forces: Vec<Wave>,
    joints: Vec<Joint>,
}

/// Symmetric, with eigenvalues from `least` up.
fn definite(random: &mut Random, n: usize, least: f64, size: f64) -> DMatrix<f64> {
    let root = DMatrix::from_fn(n, n, |_, _| random.uniform(-size, size));
    let square = &root * root.transpose();
    // Symmetric to the bit.
    DMatrix::from_fn(n, n, |i, j| {
        square[(i.max(j), i.min(j))] + if i == j { least } else { 0.0 }
    })
}

impl Given {
    /// A system of up to three coordinates, four elastic contacts, and as many rigid ones as
    /// coordinates.
    fn random(random: &mut Random) -> Self {
        let n = 1 + (random.bits() % 3) as usize;
        let mass = definite(random, n, 0.5, 0.7);
        let damping = definite(random, n, 0.0, 0.3);
        let stiffness = definite(random, n, 0.2, 1.0);
        let force = |_| {
            let (mean, amplitude) = (random.uniform(-0.5, 0.5), random.uniform(0.0, 2.0));
            Wave::random(random, mean, amplitude)
        };
        let forces = (0..n).map(force).collect();
        let mut joints = Vec::new();
        for _ in 0..1 + random.bits() % 4 {
            let direction = (0..n).map(|_| random.uniform(-1.0, 1.0)).collect();
            let mean = random.logarithmic(0.1, 2.0);
            // Some loads fall to 0, and the contact opens.
            let part = random.pick(&[0.0, 0.5, 1.5]);
            let speed = random.pick(&[0.0, 0.0, 0.5]);
            joints.push(Joint {
                direction,
                stiffness: Some(random.logarithmic(0.1, 100.0)),
                friction: random.uniform(0.1, 1.0),
                load: Wave::random(random, mean, part * mean),
                surface: Wave::random(random, speed, speed),
            });
        }
        for i in 0..n {
            if !random.bits().is_multiple_of(3) {
                continue;
            }
            let direction = (0..n).map(|j| if i == j { 1.0 } else { 0.0 }).collect();
            let mean = random.logarithmic(0.1, 1.0);
            joints.push(Joint {
                direction,
                stiffness: None,
                friction: random.uniform(0.1, 1.0),
                load: Wave::random(random, mean, 0.5 * mean),
                surface: Wave::random(random, 0.0, 0.0),
            });
        }
        Self {
            mass,
            damping,
            stiffness,
            forces,
            joints,
        }
    }

    fn structure(&self) -> Result<Structure, Error> {
        let mut structure = Structure::with_mass_matrix(self.mass.clone())?
            .with_stiffness(self.stiffness.clone())?
            .with_damping(self.damping.clone())?;
        for (i, force) in self.forces.iter().enumerate() {
            structure = structure.with_force(i, force.drive())?;
        }
        let contacts: Result<Vec<_>, Error> = self.joints.iter().map(Joint::contact).collect();
        structure.with_contacts(contacts?)
    }

    fn elastic(&self) -> impl Iterator<Item = (usize, &Joint, f64)> {
        let joints = self.joints.iter().enumerate();
        joints.filter_map(|(c, joint)| Some((c, joint, joint.stiffness?)))
    }

    fn start(&self, random: &mut Random) -> State {
        let mut some = || -> Vec<f64> {
            let n = self.forces.len();
            (0..n).map(|_| random.uniform(-2.0, 2.0)).collect()
        };
        let (q, v) = (some(), some());
        let carried = |(_, joint, _): (usize, &Joint, f64)| {
            let most = joint.friction * joint.load.at(0.0).max(0.0);
            random.uniform(-most, most)
        };
        let memory: Vec<f64> = self.elastic().map(carried).collect();
        State::new(&q, &v).with_memory(&memory)
    }

    /// ½ vᵀMv + ½ qᵀKq + Σ T²/(2k_t)
    fn energy(&self, state: &State) -> f64 {
        let [q, v] = [&state.displacements, &state.velocities].map(|x| DVector::from_row_slice(x));
        let springs = self.elastic().zip(&state.memory);
        let stored: f64 = springs
            .map(|((.., k), force)| 0.5 * force * force / k)
            .sum();
        0.5 * (v.dot(&(&self.mass * &v)) + q.dot(&(&self.stiffness * &q))) + stored
    }

    /// Rate of the energy: what forces give, less what dampers, sliders and surfaces take.
    fn power(&self, time: f64, state: &State, modes: &[Mode]) -> f64 {
        let v = DVector::from_row_slice(&state.velocities);
        let forces = self.forces.iter().zip(v.iter());
        let given: f64 = forces.map(|(force, v)| force.at(time) * v).sum();
        let mut carried = state.memory.iter();
        let taken = self.joints.iter().zip(modes).map(|(joint, mode)| {
            let row = DVector::from_row_slice(&joint.direction);
            let w = joint.surface.at(time);
            let r = row.dot(&v) - w;
            let (load, rate) = (joint.load.at(time), joint.load.rate(time));
            let carried = joint.stiffness.map(|k| (k, *carried.next().unwrap()));
            let sign = match mode {
                Mode::Slip(Direction::Leading) => 1.0,
                Mode::Slip(Direction::Lagging) => -1.0,
                _ => 0.0,
            };
            let limit = joint.friction * load;
            match carried {
                Some((k, force)) => {
                    let slider = sign * r - joint.friction * rate / k;
                    force * w + sign.abs() * limit * slider
                }
                None => sign * limit * r,
            }
        });
        given - v.dot(&(&self.damping * &v)) - taken.sum::<f64>()
    }
}

impl Joint {
    fn contact(&self) -> Result<Contact, Error> {
        let row: Vec<(usize, f64)> = self.direction.iter().copied().enumerate().collect();
        let law = Coulomb::new(self.friction, self.friction)?;
        let contact = Contact::along(&row, law, self.load.drive())?.on_belt(self.surface.drive());
        match self.stiffness {
            Some(k) => contact.with_tangential_stiffness(k),
            None => Ok(contact),
        }
    }
}

fn simulate(given: &Given, start: &State, about: &str) -> Trajectory<State> {
    let structure = given.structure().unwrap();
    let motion = structure.simulate(start.clone(), 12.0);
    motion.unwrap_or_else(|error| panic!("{about}: {error}\n{given:?}\n{start:?}"))
}

#[test]
fn two_motions_never_come_apart() {
    let mut random = Random::new(30);
    let (mut events, mut fallen) = (0, 0);
    let cases = count(75, 1000);
    for i in 0..cases {
        let given = Given::random(&mut random);
        let motions = [0, 1].map(|_| {
            let start = given.start(&mut random);
            simulate(&given, &start, &i.to_string())
        });
        events += motions
            .iter()
            .map(|motion| motion.events().len())
            .sum::<usize>();
        let apart = |time: f64| {
            let [a, b] = [0, 1].map(|k: usize| motions[k].state_at(time).unwrap());
            let minus = |a: &[f64], b: &[f64]| -> Vec<f64> {
                a.iter().zip(b).map(|(a, b)| a - b).collect()
            };
            let q = minus(&a.displacements, &b.displacements);
            let v = minus(&a.velocities, &b.velocities);
            given.energy(&State::new(&q, &v).with_memory(&minus(&a.memory, &b.memory)))
        };
        let begin = apart(0.0);
        let mut last = begin;
        for k in 1..=120 {
            let time = 0.1 * f64::from(k);
            let next = apart(time);
            // Rounding of the motions, relative to the energy of their difference at the start.
            assert!(
                next <= last + 1e-13 * (1.0 + begin),
                "{i} at {time}: {last:e} {next:e}\n{given:?}"
            );
            last = next;
        }
        fallen += usize::from(last < 0.5 * begin);
    }
    println!("{events} events, {fallen} have come closer");
    assert!(events > 5 * cases && fallen > cases / 2);
}

#[test]
fn mirror_images_agree_to_the_bit() {
    let mut random = Random::new(145);
    let turned = |wave: &Wave| Wave {
        mean: -wave.mean,
        amplitude: -wave.amplitude,
        ..*wave
    };
    let negated = |numbers: &[f64]| numbers.iter().map(|x| -x).collect::<Vec<_>>();
    let mirrored = |state: &State| {
        let [q, v] = [&state.displacements, &state.velocities].map(|x| negated(x));
        State::new(&q, &v).with_memory(&negated(&state.memory))
    };
    let mut events = 0;
    for number in 0..count(75, 1000) {
        let given = Given::random(&mut random);
        let mut image = given.clone();
        image.forces = given.forces.iter().map(turned).collect();
        for joint in &mut image.joints {
            joint.surface = turned(&joint.surface);
        }
        let start = given.start(&mut random);
        let about = format!("{number}: {given:?}");
        let one = simulate(&given, &start, &about);
        let other = simulate(&image, &mirrored(&start), &about);
        assert_eq!(one.events().len(), other.events().len(), "{about}");
        for (a, b) in one.events().iter().zip(other.events()) {
            assert_eq!(
                (a.time, a.contact().unwrap()),
                (b.time, b.contact().unwrap()),
                "{about}"
            );
            assert_eq!(mirrored(&a.state), b.state, "{about}");
            events += 1;
        }
        assert_eq!(mirrored(&one.last()), other.last(), "{about}");
    }
    assert!(events > 10 * count(75, 1000), "{events}");
}

#[test]
fn energy_is_what_forces_and_sliders_leave() {
    let mut random = Random::new(31);
    let mut worst = 0.0_f64;
    for i in 0..count(25, 1000) {
        let given = Given::random(&mut random);
        let start = given.start(&mut random);
        let motion = simulate(&given, &start, &i.to_string());
        let (mut energy, mut moved) = (given.energy(&start), 0.0);
        for step in motion.steps() {
            let power =
                |t: f64| given.power(step.start_time() + t, &step.state_at(t), step.modes());
            let work = integrate(step.duration(), power);
            energy += work;
            moved += work.abs();
        }
        let end = given.energy(&motion.last());
        let error = (energy - end).abs() / (1.0 + moved);
        worst = larger(worst, error);
        // A few dozen steps of rounding.
        assert!(error < 2e-13, "{i}: {error:e}\n{given:?}\n{start:?}");
    }
    println!("worst: {worst:e}");
}

/// In slip no force depends on how fast the surface moves, but the stop of the slider does.
#[test]
fn sliders_stop_where_a_fast_surface_turns() {
    let law = Coulomb::new(1.0, 1.0).unwrap();
    for frequency in [1.0, 10.0, 100.0] {
        // The surface moves by 2/frequency and back; the slider follows after twice its limit.
        let element = Contact::new(0, law, 0.3 / frequency)
            .and_then(|contact| contact.with_tangential_stiffness(1.0))
            .unwrap()
            .on_belt(Drive::sine(1.0, frequency).unwrap());
        for stiffness in [0.0, 1e20] {
            let wall = one_mass([1e20, 0.0, stiffness], 0.0, element.clone()).unwrap();
            let motion = wall.simulate(State::at_rest(1), 20.0 / frequency).unwrap();
            let stops = motion.events().iter();
            let stops = stops.filter(|event| event.kind == EventKind::Stick);
            let mut count = 0;
            for (k, stop) in (1..).zip(stops) {
                let turn = PI * f64::from(k) / frequency;
                assert!(
                    (stop.time - turn).abs() < 1e-14 * turn,
                    "{frequency}: {} {turn}",
                    stop.time
                );
                count += 1;
            }
            assert_eq!(count, 6, "{frequency}");
        }
    }
}

/// The elements of a joint on a surface that moves at velocity 1 from turn to turn, under a mass so
/// heavy that it stays.
fn moved(joint: &Contact, elements: &[(f64, f64)], turns: &[f64]) -> Trajectory<State> {
    let mut points = Vec::new();
    let (mut time, mut place) = (0.0, 0.0);
    for &turn in turns {
        // x = b·q − ∫w
        let speed = f64::signum(place - turn);
        let duration = (turn - place).abs();
        points.extend([(time, speed), (time + duration, speed)]);
        (time, place) = (time + duration, turn);
    }
    let way = Drive::profile(&points).unwrap();
    let contacts = joint.clone().on_belt(way).in_parallel(elements).unwrap();
    let wall = Structure::new(&[1e20]).and_then(|s| s.with_contacts(contacts));
    wall.unwrap().simulate(State::at_rest(1), time).unwrap()
}

#[test]
fn elements_of_a_joint_carry_and_dissipate_what_it_does() {
    let joint = Iwan4::new(3.0, 2.0, -0.3, 0.2).unwrap();
    let elements = joint.elements(12, 0.5).unwrap();
    let contact = Contact::new(0, Coulomb::new(1.0, 1.0).unwrap(), 1.0).unwrap();
    let longest = joint.largest_break_free();
    let force = |state: &State| state.memory.iter().sum::<f64>();
    for i in 0..8 {
        // The polygon touches the backbone there.
        let amplitude = longest * 0.5_f64.powi(i);
        let motion = moved(&contact, &elements, &[amplitude, -amplitude, amplitude]);
        let exact = joint.backbone(amplitude);
        let small = 1e-13 * exact;
        let turns = [1.0, 3.0, 5.0].map(|part| motion.state_at(part * amplitude).unwrap());
        for (state, sign) in turns.iter().zip([1.0, -1.0, 1.0]) {
            assert!((force(state) - sign * exact).abs() < 20.0 * small, "{i}");
        }
        // Masing's rules between the turns, within what the polygon lies above the backbone.
        for part in [1.3, 1.7, 2.2, 2.9] {
            let place = (2.0 - part) * amplitude;
            let expected = exact - 2.0 * joint.backbone(0.5 * (amplitude - place));
            let found = force(&motion.state_at(part * amplitude).unwrap());
            assert!((found - expected).abs() < 0.12 * exact, "{i} {part}");
        }
        // Work of the surface over the closed cycle.
        let cycle = motion
            .steps()
            .iter()
            .filter(|step| step.start_time() >= amplitude);
        let loss: f64 = cycle
            .map(|step| {
                let middle = step.start_time() + 0.5 * step.duration();
                let sign = if middle < 3.0 * amplitude { -1.0 } else { 1.0 };
                sign * integrate(step.duration(), |t| force(&step.state_at(t)))
            })
            .sum();
        let by_elements: f64 = elements
            .iter()
            .map(|&(k, limit)| stick_slip::analysis::jenkins::loop_area(k, limit, amplitude))
            .sum();
        assert!(
            (loss / by_elements - 1.0).abs() < 1e-12,
            "{i}: {loss} {by_elements}"
        );
        let ratio = loss / joint.dissipation(amplitude);
        assert!((1.0..1.1).contains(&ratio), "{i}: {ratio}");
    }
}

/// Small cycles of a simulated joint dissipate D = 4R A^(χ+3)/((χ+2)(χ+3)): its slope in a log-log
/// diagram is χ + 3, and the finer the grid, the nearer is the loss itself.
#[test]
fn small_cycles_of_a_joint_have_the_exponent_of_its_distribution() {
    for chi in some(1, [-0.5, -0.8, -0.2, 0.0]) {
        let joint = Iwan4::new(3.0, 2.0, chi, 0.3).unwrap();
        let longest = joint.largest_break_free();
        let contact = Contact::new(0, Coulomb::new(1.0, 1.0).unwrap(), 1.0).unwrap();
        // R from the limits of all sliders, S φ_max among them: F_S = R φ^{χ+2}/(χ+2) + S φ.
        let share = 1.0 / (chi + 2.0) + 0.3 / (chi + 1.0);
        let density = joint.slip_force() / (share * longest.powf(chi + 2.0));
        let closed = |a: f64| 4.0 * density * a.powf(chi + 3.0) / ((chi + 2.0) * (chi + 3.0));
        let worst = [(40, 0.8), (80, 0.8_f64.sqrt())].map(|(n, grid)| {
            let elements = joint.elements(n, grid).unwrap();
            let loss = |amplitude: f64| {
                let motion = moved(&contact, &elements, &[amplitude, -amplitude, amplitude]);
                let wall = motion.steps().iter();
                // Work of the surface over the closed cycle.
                wall.filter(|step| step.start_time() >= amplitude)
                    .map(|step| {
                        let middle = step.start_time() + 0.5 * step.duration();
                        let sign = if middle < 3.0 * amplitude { -1.0 } else { 1.0 };
                        let force = |t: f64| step.state_at(t).memory.iter().sum::<f64>();
                        sign * integrate(step.duration(), force)
                    })
                    .sum::<f64>()
            };
            // Over two decades, between the tangents of the polygon and where they touch.
            let amplitudes: Vec<f64> = (0..9)
                .map(|i| 0.3 * longest * 0.01_f64.powf(f64::from(i) / 8.0))
                .collect();
            let losses: Vec<f64> = amplitudes.iter().map(|&a| loss(a)).collect();
            let logarithms = amplitudes
                .iter()
                .zip(&losses)
                .map(|(a, d)| [a.ln(), d.ln()]);
            let points: Vec<_> = logarithms.collect();
            let mean = |k: usize| points.iter().map(|point| point[k]).sum::<f64>() / 9.0;
            let [x, y] = [mean(0), mean(1)];
            let over = |f: &dyn Fn(&[f64; 2]) -> f64| points.iter().map(f).sum::<f64>();
            let slope = over(&|p| (p[0] - x) * (p[1] - y)) / over(&|p| (p[0] - x).powi(2));
            println!("{chi} {grid}: slope {slope}");
            assert!((slope - chi - 3.0).abs() < 0.002, "{chi}: {slope}");
            let apart = amplitudes.iter().zip(&losses).map(|(&a, loss)| {
                assert!((joint.dissipation(a) / closed(a) - 1.0).abs() < 1e-13);
                (loss / closed(a) - 1.0).abs()
            });
            apart.fold(0.0, larger)
        });
        // Of second order in the ratio of neighbouring intervals.
        println!("{chi}: {worst:?}");
        assert!(
            worst[0] < 0.04 && worst[1] < 0.4 * worst[0],
            "{chi}: {worst:?}"
        );
    }
}
