//! The derivative of the map over a time against differences of motions, for random structures.

use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::TAU;

use stick_slip::nalgebra::{DMatrix, DVector};
use stick_slip::orbit::{Orbit, Period, settle};
use stick_slip::structure::{State, Step};
use stick_slip::{
    AnyContactLaw, AnyLaw, Contact, Coulomb, Dahl, Drive, Dwell, Error, EventKind, Exponential,
    Freewheel, LuGre, Mode, Polynomial, PolynomialSpring, Rational, Segment, Structure, Tabulated,
};

use crate::common::forces;
use crate::common::heat::Heat;
use crate::common::orbit::monodromy;
use crate::common::{Random, count, larger, vector};
use crate::reading::Raised;

type Law = AnyContactLaw<Raised>;

/// Draws structures.
struct Draw(Random);

impl Draw {
    fn uniform(&mut self, low: f64, high: f64) -> f64 {
        self.0.uniform(low, high)
    }

    /// One of n.
    fn one_of(&mut self, n: u64) -> u64 {
        self.0.bits() % n
    }

    fn dry(&mut self) -> Raised {
        let low = self.uniform(0.15, 0.3);
        let high = low + self.uniform(0.0, 0.3);
        match self.one_of(5) {
            0 => Coulomb::new(high, low).map(AnyLaw::from),
            1 => Exponential::new(high, low, self.uniform(0.2, 0.6)).map(AnyLaw::from),
            2 => Rational::new(high, self.uniform(0.5, 3.0)).map(AnyLaw::from),
            3 => {
                Tabulated::new([(0.0, high), (0.2, low), (0.5, low), (2.0, high)]).map(AnyLaw::from)
            }
            _ => Polynomial::new(high, low, self.uniform(0.4, 0.9)).map(AnyLaw::from),
        }
        .map(Raised::from)
        .unwrap()
    }

    fn law(&mut self) -> Law {
        let dry = self.dry();
        match self.one_of(6) {
            0 => Dwell::exponential(dry, 1.0, self.uniform(0.5, 3.0))
                .unwrap()
                .into(),
            1 => Dwell::logarithmic(dry, self.uniform(0.0, 0.1), 1.0)
                .unwrap()
                .into(),
            2 => Dahl::new(self.uniform(0.2, 0.5), self.uniform(2.0, 20.0))
                .unwrap()
                .into(),
            3 => {
                let [stiffness, damping, viscous] =
                    [(2.0, 20.0), (0.0, 0.5), (0.0, 0.1)].map(|(a, b)| self.uniform(a, b));
                LuGre::new(dry, stiffness, damping, viscous).unwrap().into()
            }
            _ => AnyContactLaw::Dry(dry),
        }
    }

    /// About a value.
    fn drive(&mut self, about: f64, amplitude: f64, may_jump: bool) -> Drive {
        let drive = Drive::constant(about);
        let (frequency, phase) = (self.uniform(0.3, 2.5), self.uniform(0.0, 6.0));
        match self.one_of(4) {
            0 => drive.with_harmonic(amplitude, frequency, phase),
            1 => {
                let [a, b, c] = [0.0; 3].map(|_| self.uniform(0.5, 8.0));
                let jump = if may_jump { 1e-9 } else { 0.5 };
                let mut times = [a, b, c, a.max(b).max(c) + jump];
                times.sort_by(f64::total_cmp);
                if may_jump {
                    times[3] = times[2];
                }
                drive.with_profile(&times.map(|t| (t, self.uniform(-amplitude, amplitude))))
            }
            _ => Ok(drive),
        }
        .unwrap()
    }

    fn structure(&mut self) -> Structure {
        let n = 1 + self.one_of(4) as usize;
        let masses: Vec<f64> = (0..n).map(|_| self.uniform(0.5, 2.0)).collect();
        // Half of the structures have joints between neighbours, and half of those a full M.
        let joints = if self.one_of(2) == 0 { 0 } else { n - 1 };
        let coupling = match joints > 0 && self.one_of(2) == 0 {
            true => self.uniform(-0.1, 0.1),
            false => 0.0,
        };
        let mass = |i, j| if i == j { masses[i] } else { coupling };
        let mut structure = Structure::with_mass_matrix(DMatrix::from_fn(n, n, mass)).unwrap();
        for i in 0..n {
            structure = structure
                .with_ground_spring(i, self.uniform(0.3, 2.0))
                .and_then(|s| s.with_ground_damper(i, self.uniform(0.0, 0.2)))
                .and_then(|s| s.with_force(i, self.drive(0.0, 0.7, true)))
                .unwrap();
            if i > 0 {
                structure = structure
                    .with_spring(i - 1, i, self.uniform(0.2, 2.0))
                    .and_then(|s| s.with_damper(i - 1, i, self.uniform(0.0, 0.2)))
                    .unwrap();
            }
        }
        for place in 0..n + joints {
            if self.one_of(4) == 0 {
                continue;
            }
            let i = place % n;
            let load_varies = self.one_of(4) == 0;
            let load = if load_varies {
                self.drive(0.5, 0.9, true)
            } else {
                self.uniform(0.4, 2.0).into()
            };
            let about = self.uniform(-0.4, 0.4);
            let belt = self.drive(about, 0.3, false);
            let direction = match place < n {
                true => vec![(i, 1.0)],
                false => vec![(i, 1.0), (i + 1, self.uniform(-1.5, -0.5))],
            };
            let mut contact = if self.one_of(3) == 0 {
                let coefficient = self.uniform(0.1, 0.5);
                let law = Coulomb::new(coefficient, coefficient).unwrap();
                let contact = Contact::along(&direction, law, load).unwrap();
                contact
                    .with_tangential_stiffness(self.uniform(0.5, 8.0))
                    .unwrap()
            } else {
                Contact::along(&direction, self.law(), load).unwrap()
            };
            contact = contact.on_belt(belt);
            let j = self.one_of(n as u64) as usize;
            if self.one_of(4) == 0 {
                contact = contact
                    .with_normal_spring(&[(j, 1.0)], self.uniform(0.2, 1.5))
                    .unwrap();
            } else if !load_varies && self.one_of(3) == 0 {
                contact = contact
                    .with_load_gradient(j, self.uniform(-0.2, 0.2))
                    .unwrap();
            }
            structure = structure.with_contact(contact).unwrap();
        }
        structure
    }

    /// Slipping, but for one contact in four.
    fn start(&mut self, structure: &Structure) -> State {
        let n = structure.len();
        let mut draw = || self.uniform(-1.0, 1.0);
        let displacements: Vec<f64> = (0..n).map(|_| draw()).collect();
        let mut velocities: Vec<f64> = (0..n).map(|_| draw()).collect();
        let mut memory = Vec::new();
        for contact in structure.contacts() {
            if self.one_of(4) == 0 {
                let [(i, b), rest @ ..] = contact.direction() else {
                    panic!("no direction")
                };
                let others: f64 = rest.iter().map(|&(j, b)| b * velocities[j]).sum();
                velocities[*i] = (contact.belt_velocity().value(0.0) - others) / b;
            }
            memory.push(self.uniform(0.0, 0.02));
        }
        State::new(&displacements, &velocities).with_memory(&memory)
    }
}

type Sequence = Vec<(usize, EventKind)>;

fn sequence(steps: &[Step]) -> Sequence {
    let events = steps.iter().flat_map(Segment::events);
    events
        .map(|event| (event.contact().unwrap(), event.kind))
        .collect()
}

/// Column of the derivative by central differences of three widths, with an estimate of its error;
/// `None` where a motion beside has other events.
fn column(
    structure: &Structure,
    start: &State,
    duration: f64,
    index: usize,
    events: &Sequence,
) -> Option<(DVector<f64>, f64)> {
    let n = structure.len();
    let end = |change: f64| -> Option<DVector<f64>> {
        let mut start = start.clone();
        let place = match index {
            i if i < n => &mut start.displacements[i],
            i if i < 2 * n => &mut start.velocities[i - n],
            i => &mut start.memory[i - 2 * n],
        };
        *place += change;
        let motion = structure.simulate(start, duration).ok()?;
        (sequence(motion.steps()) == *events).then(|| vector(&motion.last()))
    };
    let difference = |width: f64| Some((end(width)? - end(-width)?) / (2.0 * width));
    let width = 4e-4;
    let widths = [2.0, 1.0, 0.5, 0.25].map(|part| difference(part * width));
    let [farther, far, near, nearest] = widths;
    let better = |fine: DVector<f64>, coarse: &DVector<f64>| &fine + (&fine - coarse) / 3.0;
    let (far, near) = (far?, near?);
    let (fine, coarse) = (better(nearest?, &near), better(near, &far));
    // Errors of the fourth order in the width: two differences seldom agree by chance.
    let before = (&coarse - better(far, &farther?)).amax() / 16.0;
    let error = (&fine - coarse).amax().max(before);
    Some((fine, error))
}

#[test]
fn derivatives_are_those_of_motions_beside() {
    agree(Draw(Random::new(5)), count(15, 200), &mut |_, structure| {
        structure
    });
}

/// The same with one or two force elements.
#[test]
fn derivatives_with_force_elements_are_those_of_motions_beside() {
    let mut add = |random: &mut Draw, mut structure: Structure| {
        for _ in 0..=random.one_of(2) {
            let element = forces::random(&mut random.0, structure.len());
            structure = structure.with_element(element).unwrap();
        }
        structure
    };
    agree(Draw(Random::new(52)), count(15, 150), &mut add);
}

/// The same with contacts whose memory depends on their loads.
#[test]
fn derivatives_with_heat_are_those_of_motions_beside() {
    let mut add = |random: &mut Draw, mut structure: Structure| {
        for _ in 0..=random.one_of(2) {
            let n = structure.len() as u64;
            let hot = random.uniform(0.1, 0.3);
            let law = Heat {
                cold: hot + random.uniform(0.0, 0.4),
                hot,
                heating: random.uniform(0.2, 2.0),
                cooling: random.uniform(0.0, 1.0),
                conduction: random.uniform(0.0, 1.0),
                kept: random.uniform(0.6, 1.0),
            };
            let [i, j] = [0; 2].map(|_| random.one_of(n) as usize);
            let load = random.drive(1.0, 0.9, false);
            let belt = random.drive(0.2, 0.3, false);
            let contact = Contact::new(i, law, load).unwrap().on_belt(belt);
            let gradient = random.uniform(-0.3, 0.3);
            let contact = if random.one_of(3) == 0 {
                contact.with_normal_spring(&[(j, 1.0)], gradient.abs() + 0.1)
            } else {
                contact.with_load_gradient(j, gradient)
            };
            structure = structure.with_contact(contact.unwrap()).unwrap();
        }
        structure
    };
    agree(Draw(Random::new(54)), count(10, 100), &mut add);
}

/// The same with laws of all kinds in the loads of contacts, with and without a temperature.
#[test]
fn derivatives_with_load_laws_are_those_of_motions_beside() {
    let mut add = |random: &mut Draw, mut structure: Structure| {
        for _ in 0..=random.one_of(2) {
            let n = structure.len();
            let law = Heat {
                cold: random.uniform(0.3, 0.6),
                hot: random.uniform(0.1, 0.3),
                heating: random.uniform(0.0, 1.0),
                cooling: random.uniform(0.0, 1.0),
                conduction: random.uniform(0.0, 1.0),
                kept: random.uniform(0.6, 1.0),
            };
            let i = random.one_of(n as u64) as usize;
            let load = random.drive(0.8, 0.4, false);
            let belt = random.drive(0.2, 0.3, false);
            let mut contact = match random.one_of(2) {
                0 => Contact::new(i, law, load),
                _ => Contact::new(i, random.law(), load),
            }
            .unwrap()
            .on_belt(belt);
            for _ in 0..=random.one_of(2) {
                let direction: Vec<(usize, f64)> =
                    (0..n).map(|j| (j, random.uniform(-1.0, 1.0))).collect();
                let kind = random.one_of(Random::FORCES as u64) as usize;
                contact = random
                    .0
                    .any_force(kind, 0.5, 1.0)
                    .press(contact, &direction);
            }
            if random.one_of(3) == 0 {
                let j = random.one_of(n as u64) as usize;
                contact = contact.with_normal_spring(&[(j, 1.0)], 0.4).unwrap();
            }
            structure = structure.with_contact(contact).unwrap();
        }
        structure
    };
    agree(Draw(Random::new(55)), count(10, 100), &mut add);
}

/// Compares the derivatives of so many motions of structures, drawn and then completed.
fn agree(
    mut random: Draw,
    enough: usize,
    complete: &mut dyn FnMut(&mut Draw, Structure) -> Structure,
) {
    let (mut motions, mut columns, mut worst) = (0, 0, 0.0_f64);
    let mut seen: BTreeMap<String, usize> = BTreeMap::new();
    let mut tried = 0;
    while motions < enough {
        tried += 1;
        assert!(tried < 10 * enough, "{motions}");
        let structure = random.structure();
        let structure = complete(&mut random, structure);
        let start = random.start(&structure);
        let duration = random.uniform(1.0, 8.0);
        let (steps, exact) = match monodromy(&structure, &start, duration) {
            Ok(found) => found,
            Err(Error::Separation { .. } | Error::OverLimit { .. }) => continue,
            // A load that grows with the speed it causes runs away.
            Err(Error::StepUnderflow { reached, .. } | Error::TooManySteps { reached, .. })
                if reached.state.velocities.iter().any(|v| v.abs() > 1e4) =>
            {
                continue;
            }
            Err(error) => panic!("{error}: {structure:?} {start:?}"),
        };
        let events = sequence(&steps);
        let n = structure.len();
        let first = steps.iter().find(|step| step.duration() > 0.0).unwrap();
        let mut compared = 0;
        for index in 0..exact.nrows() {
            // A change that takes a contact out of stick is gone at once, with its clock, where no
            // other contact feels it.
            let stuck = std::iter::zip(structure.contacts(), first.modes())
                .filter(|(c, _)| c.tangential_stiffness().is_none())
                .any(|(c, mode)| *mode == Mode::Stick && n + c.coordinate() == index);
            let coordinates = structure.contacts().iter().map(|c| c.coordinate());
            let coordinates: BTreeSet<usize> = coordinates.collect();
            let is_plain = structure
                .contacts()
                .iter()
                .all(|c| c.direction().len() == 1 && c.tangential_stiffness().is_none())
                && coordinates.len() == structure.contacts().len()
                && structure.mass_matrix()[(0, n - 1)] * (n - 1) as f64 == 0.0;
            if stuck && is_plain {
                assert!(exact.column(index).iter().all(|x| *x == 0.0));
                continue;
            }
            let Some((expected, error)) = column(&structure, &start, duration, index, &events)
            else {
                continue;
            };
            let found = exact.column(index);
            let size = expected.amax().max(1.0);
            // Where differences are no measure, nothing is compared.
            if error > 1e-7 * size {
                continue;
            }
            let apart = (&expected - found).amax();
            let allowed = 4.0 * error + 2e-10 * size;
            assert!(
                apart <= allowed,
                "column {index}: {apart:e} of {size:e}, differences good to {error:e}\n\
                 {expected}{found}\n{structure:?}\n{start:?} {duration} {events:?}",
            );
            worst = larger(worst, apart / size);
            compared += 1;
        }
        if compared > 0 {
            motions += 1;
            columns += compared;
            for (_, kind) in &events {
                *seen.entry(kind.to_string()).or_default() += 1;
            }
        }
    }
    println!("{motions} motions, {columns} columns, worst {worst:.1e}, {seen:?}");
    for kind in [
        "stick",
        "release (lagging)",
        "crossing (leading)",
        "open",
        "close",
    ] {
        assert!(
            seen.get(kind).is_some_and(|seen| 20 * seen > enough),
            "{kind}: {seen:?}"
        );
    }
}

/// Two brakes and a clutch hold two shafts on springs, and begin to slip in a mechanism with less
/// friction: the time of that depends on the springs of both shafts.
#[test]
fn mechanisms_have_the_derivatives_of_motions_beside() {
    let law = || Coulomb::new(1.0, 0.6).unwrap();
    let contacts = [
        Contact::new(0, law(), 3.0).unwrap(),
        Contact::new(1, law(), 5.0).unwrap(),
        Contact::between(0, 1, law(), 4.0).unwrap(),
    ];
    for (size, slipping) in [(12.0, [0, 2]), (-14.0, [0, 2])] {
        let ring = Structure::new(&[1.0, 1.5])
            .and_then(|s| s.with_ground_spring(0, 1.0)?.with_ground_spring(1, 0.7))
            .and_then(|s| s.with_spring(0, 1, 0.3))
            .and_then(|s| s.with_force(0, Drive::sine(size, 0.5)?))
            .and_then(|s| s.with_contacts(contacts.clone()))
            .unwrap();
        let start = State::new(&[0.3, -0.2], &[0.0, 0.0]);
        let (steps, exact) = monodromy(&ring, &start, 3.0).unwrap();
        let events = sequence(&steps);
        let first: Vec<usize> = events.iter().take(2).map(|event| event.0).collect();
        assert_eq!(first, slipping, "{events:?}");
        for index in 0..2 {
            let (expected, error) = column(&ring, &start, 3.0, index, &events).unwrap();
            let apart = (&expected - exact.column(index)).amax();
            assert!(
                expected.amax() > 0.1 && error < 1e-7,
                "{expected} {error:e}"
            );
            assert!(apart <= 4.0 * error + 2e-10, "{apart:e} {error:e}");
        }
    }
}

/// A load that jumps from below 0 closes an elastic contact at the time of the jump, whatever the
/// displacement of its normal spring: δT = k_t(δq_0 − δq_0(1)) from there on.
#[test]
fn a_contact_that_a_jump_of_the_load_closes_has_the_derivative_of_the_closed_form() {
    // Of unit masses, the first on a spring of stiffness 1, with k_t = 3; the second is free, and
    // from t = 1 on the normal spring of stiffness 9.
    let system = |load: f64| {
        let load = Drive::profile(&[(1.0, -5.0), (1.0, load)])?;
        let contact = Contact::new(0, Coulomb::new(0.5, 0.5)?, load)?
            .with_tangential_stiffness(3.0)?
            .with_normal_spring(&[(1, 1.0)], 9.0)?
            .on_belt(-0.1);
        Structure::new(&[1.0, 1.0])?
            .with_ground_spring(0, 1.0)?
            .with_contact(contact)
    };
    let start = State::new(&[0.0, 0.01], &[0.02, 0.03]);
    let (sine, cosine) = 1.0_f64.sin_cos();
    #[rustfmt::skip]
    let before = DMatrix::from_row_slice(5, 5, &[
        cosine, 0.0, sine,   0.0, 0.0,
        0.0,    1.0, 0.0,    1.0, 0.0,
        -sine,  0.0, cosine, 0.0, 0.0,
        0.0,    0.0, 0.0,    1.0, 0.0,
        0.0,    0.0, 0.0,    0.0, 0.0,
    ]);
    // δq_0'' = −δq_0 − 3(δq_0 − δq_0(1)) and δq_1'' = −9 δq_1 over 0.2.
    let ((s2, c2), (s3, c3)) = (0.4_f64.sin_cos(), 0.6_f64.sin_cos());
    #[rustfmt::skip]
    let after = DMatrix::from_row_slice(5, 5, &[
        0.75 + 0.25 * c2,  0.0,       0.5 * s2, 0.0,      0.0,
        0.0,               c3,        0.0,      s3 / 3.0, 0.0,
        -0.5 * s2,         0.0,       c2,       0.0,      0.0,
        0.0,               -3.0 * s3, 0.0,      c3,       0.0,
        0.75 * (c2 - 1.0), 0.0,       1.5 * s2, 0.0,      0.0,
    ]);
    let expected = after * before;
    for load in [3.0, 4.0] {
        let system: Result<Structure, Error> = system(load);
        let system = system.unwrap();
        let (steps, found) = monodromy(&system, &start, 1.2).unwrap();
        assert_eq!(sequence(&steps), [(0, EventKind::Close)]);
        assert_eq!(steps.last().unwrap().modes(), [Mode::Stick]);
        // Some rounding errors of entries of size 2.
        let error = (found - &expected).amax();
        assert!(error < 1e-14, "{load}: {error:e}");
    }
}

/// A contact that slips in one direction only holds any force in stick until its load is gone: then
/// the velocity behind it begins to change, at a time that depends on the state.
#[test]
fn a_jammed_contact_that_opens_has_the_derivative_of_motions_beside() {
    let system = |pressed_by_law: bool, inertia: f64| {
        let load = if pressed_by_law { 0.5 } else { 1.0 };
        let contact = Contact::new(0, Freewheel::new(Coulomb::new(0.2, 0.2)?)?, load)?;
        let contact = if pressed_by_law {
            contact.with_load_law(&[(1, 1.0)], PolynomialSpring::new(&[1.0])?)?
        } else {
            contact.with_normal_spring(&[(1, 1.0)], 2.0)?
        };
        let masses = DMatrix::from_row_slice(2, 2, &[1.0, inertia, inertia, 1.0]);
        Structure::with_mass_matrix(masses)?
            .with_ground_spring(0, 4.0)?
            .with_ground_spring(1, 1.5)?
            .with_force(0, 0.8)?
            .with_contact(contact)
    };
    for (pressed_by_law, inertia) in [(false, 0.0), (false, 0.1), (true, 0.0), (true, 0.1)] {
        let system: Result<Structure, Error> = system(pressed_by_law, inertia);
        let system = system.unwrap();
        let start = [0.1, 0.2, 0.0, -1.0];
        let state = |x: &[f64]| State::new(&x[..2], &x[2..]);
        let (steps, found) = monodromy(&system, &state(&start), 1.2).unwrap();
        assert_eq!(steps[0].modes(), [Mode::Stick]);
        assert_eq!(sequence(&steps), [(0, EventKind::Open)]);
        // The velocity of the jammed mass cannot vary.
        for j in [0, 1, 3] {
            let end = |change: f64| {
                let mut start = start;
                start[j] += change;
                vector(&system.simulate(state(&start), 1.2).unwrap().last())
            };
            let difference = |width: f64| (end(width) - end(-width)) / (2.0 * width);
            let expected = (difference(1e-3) * 4.0 - difference(2e-3)) / 3.0;
            let error = (found.column(j) - expected).amax();
            assert!(error < 1e-9, "{pressed_by_law} {inertia} {j}: {error:e}");
        }
    }
}

/// Linear structures with full matrices, in closed form: with K = Q diag(ω²) Qᵀ, C = Q diag(2ζω) Qᵀ
/// and a reflection Q the multipliers are e^{λT}, λ = (−ζ ± i√(1 − ζ²)) ω. Rates differ by up to
/// two orders; in the longest periods the fastest mode has 10⁴ radians.
#[test]
fn multipliers_of_linear_structures_are_exponentials() {
    let mut draw = Draw(Random::new(97));
    for round in 0..count(40, 1000) {
        let n = 1 + round % 8;
        let spread = [0.5, 1.0, 2.0][round % 3];
        let normal = DVector::from_fn(n, |_, _| draw.uniform(-1.0, 1.0)).normalize();
        let turn = DMatrix::identity(n, n) - &normal * normal.transpose() * 2.0;
        let rate = |_: usize, _: usize| 10_f64.powf(draw.uniform(-spread, 0.0));
        let rates = DVector::from_fn(n, rate);
        let ratio = draw.uniform(1e-4, 0.9);
        let of = |values: DVector<f64>| {
            let full = &turn * DMatrix::from_diagonal(&values) * turn.transpose();
            (&full + full.transpose()) * 0.5
        };
        let radians = 10_f64.powf(draw.uniform(0.0, 4.0));
        let force = Drive::harmonic(1.0, TAU / radians, 0.3).unwrap();
        let structure = Structure::with_mass_matrix(DMatrix::identity(n, n))
            .and_then(|of_mass| of_mass.with_stiffness(of(rates.map(|rate| rate * rate))))
            .and_then(|sprung| sprung.with_damping(of(rates.map(|rate| 2.0 * ratio * rate))))
            .and_then(|damped| damped.with_force(0, force))
            .unwrap();
        let (_, map) = monodromy(&structure, &State::at_rest(n), radians).unwrap();
        // In the coordinates of the modes, and in units of energy.
        let mut blocks = DMatrix::zeros(2 * n, 2 * n);
        for (i, omega) in rates.iter().enumerate() {
            let frequency = omega * (1.0 - ratio * ratio).sqrt();
            let decay = (-ratio * omega * radians).exp();
            let (sine, cosine) = (frequency * radians).sin_cos();
            let part = ratio * omega / frequency * sine;
            blocks[(i, i)] = decay * (cosine + part);
            blocks[(i, n + i)] = decay * sine * omega / frequency;
            blocks[(n + i, i)] = -decay * sine * omega / frequency;
            blocks[(n + i, n + i)] = decay * (cosine - part);
        }
        let mut modes = DMatrix::zeros(2 * n, 2 * n);
        for (j, omega) in rates.iter().enumerate() {
            for i in 0..n {
                modes[(i, j)] = turn[(i, j)] / omega;
                modes[(n + i, n + j)] = turn[(i, j)];
            }
        }
        let inverse = modes.clone().try_inverse().unwrap();
        let found = inverse * map * modes;
        // Rounding of K alone turns the slowest mode by about ε ω_max² T/ω_min.
        let error = (found - blocks).amax();
        let fastest = (rates.amax() * radians).max(1.0);
        let bound = 8.0 * f64::EPSILON * fastest * rates.amax() / rates.amin();
        assert!(error < bound, "{round}: {error:e} above {bound:e}");
    }
}

/// Two masses with a joint between them that sticks and slips, or with several that share its load
/// and slip as one; coefficients of the directions are such that rows depend by rounding only.
fn jointed(parts: &[f64], random: &mut Random) -> Result<Structure, Error> {
    let mut uniform = |low: f64, high: f64| random.uniform(low, high);
    let mut structure = Structure::new(&[uniform(0.5, 2.0), uniform(0.5, 2.0)])?
        .with_ground_spring(0, uniform(0.8, 2.0))?
        .with_ground_spring(1, uniform(0.4, 1.0))?
        .with_spring(0, 1, uniform(0.5, 2.0))?
        .with_ground_damper(0, uniform(0.02, 0.1))?
        .with_ground_damper(1, uniform(0.02, 0.2))?
        .with_force(0, Drive::harmonic(uniform(0.6, 1.2), 1.1, 0.4)?)?;
    for (i, part) in parts.iter().enumerate() {
        let lever = 1.0 + 0.3 * i as f64;
        let law = Coulomb::new(0.4, 0.3)?;
        let joint = Contact::along(&[(0, lever), (1, -lever)], law, part * 0.5 / lever)?;
        structure = structure.with_contact(joint)?;
    }
    Ok(structure)
}

#[test]
fn multipliers_are_the_same_if_joints_share_the_load_of_one() {
    let (mut compared, mut slipping) = (0, 0);
    for seed in 0..count(12, 120) as u64 {
        let settled = |parts: &[f64]| {
            let system = jointed(parts, &mut Random::new(seed)).unwrap();
            let start = State::new(&[0.3, 0.1], &[0.0; 2]);
            settle(&system, &start, 400.0, Period::Driven(1)).ok()
        };
        let (Some(one), Some(three)) = (settled(&[1.0]), settled(&[0.25, 0.25, 0.5])) else {
            continue;
        };
        let apart = one.extremes(1).1 - three.extremes(1).1;
        if apart.abs() > 1e-10 {
            continue;
        }
        compared += 1;
        slipping += usize::from(one.events().len() > 1);
        let moduli = |orbit: &Orbit<State>| -> Vec<f64> {
            orbit.multipliers().iter().map(|m| m.norm()).collect()
        };
        for (found, expected) in std::iter::zip(moduli(&three), moduli(&one)) {
            assert!(
                (found - expected).abs() < 1e-8,
                "{seed}: {:?}, not {:?}",
                three.multipliers(),
                one.multipliers()
            );
        }
    }
    assert!(
        2 * compared > count(12, 120) && slipping > 2,
        "{compared}, {slipping}"
    );
}
