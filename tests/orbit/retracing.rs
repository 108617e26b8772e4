//! A branch visits no motion twice.

use std::cell::Cell;
use std::f64::consts::{PI, TAU};
use std::ops::ControlFlow;

use stick_slip::orbit::{
    Attractor, BifurcationKind, Branch, BranchEnd, BranchPoint, Orbit, Period, Search, classify,
    follow, settle,
};
use stick_slip::structure::State;
use stick_slip::{Contact, Coulomb, Drive, Dwell, Error, Exponential, Rational, Structure};

use crate::common::{Random, count};

/// Three modes of a string, bowed at an eighth of its length at a velocity.
fn string(load: f64, velocity: f64) -> Result<Structure, Error> {
    let law = Rational::new(0.8, 5.0)?.with_offset(0.3)?;
    let mut string = Structure::new(&[1.0; 3])?;
    for i in 0..3 {
        let omega = TAU * 196.0 * (i + 1) as f64;
        string = string
            .with_ground_spring(i, omega * omega)?
            .with_ground_damper(i, 0.004 * omega)?;
    }
    let shape = |i: usize| 2000.0_f64.sqrt() * ((i + 1) as f64 * PI / 8.0).sin();
    let direction: Vec<_> = (0..3).map(|i| (i, shape(i))).collect();
    string.with_contact(Contact::along(&direction, law, load)?.on_belt(velocity))
}

/// The numbers by which the motions of a branch differ: the parameter, the period, and extremes,
/// or the state at time 0 of the drives.
fn numbers(point: &BranchPoint<State>, masses: usize) -> Vec<f64> {
    let orbit = &point.orbit;
    let mut numbers = vec![point.parameter, orbit.period()];
    if let Period::Driven(_) = orbit.kind() {
        numbers.extend(orbit.state().displacements);
        numbers.extend(orbit.state().velocities);
    }
    for i in 0..masses {
        for (low, high) in [orbit.extremes(i), orbit.velocity_extremes(i)] {
            numbers.extend([low, high]);
        }
    }
    numbers
}

/// A number that varies along a branch by less than this part of the largest is constant, but for
/// rounding.
const STILL: f64 = 1e-9;

/// The number of motions in a row that lie on a part of the branch that was left before.
fn retraced(branch: &Branch<State>, masses: usize) -> usize {
    let points = branch.points.iter();
    let mut points: Vec<_> = points.map(|point| numbers(point, masses)).collect();
    let sizes = points.iter().flatten().map(|x| x.abs());
    let largest = sizes.fold(0.0, f64::max);
    for k in 0..points.first().map_or(0, Vec::len) {
        let of = |pick: fn(f64, f64) -> f64| points.iter().map(|p| p[k]).reduce(pick).unwrap();
        let width = of(f64::max) - of(f64::min);
        // The velocity of a mass that a contact holds has rounding errors only.
        let unit = if width > STILL * largest { width } else { 1.0 };
        points.iter_mut().for_each(|point| point[k] /= unit);
    }
    let apart =
        |a: &[f64], b: &[f64]| -> Vec<f64> { a.iter().zip(b).map(|(a, b)| a - b).collect() };
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let lies_on = |point: &[f64], from: &[f64], to: &[f64]| {
        let (way, there) = (apart(to, from), apart(point, from));
        let along = dot(&way, &way);
        let part = dot(&way, &there) / along;
        let beside: Vec<_> = there.iter().zip(&way).map(|(a, b)| a - part * b).collect();
        (0.0..=1.0).contains(&part) && dot(&beside, &beside) <= 0.02_f64.powi(2) * along
    };
    let (mut most, mut row) = (0, 0);
    for (i, point) in points.iter().enumerate() {
        let before = points[..i.saturating_sub(3)].windows(2);
        let known = before
            .filter(|pair| lies_on(point, &pair[0], &pair[1]))
            .count()
            > 0;
        row = if known { row + 1 } else { 0 };
        most = most.max(row);
    }
    most
}

/// A random structure of a family, whose parameter multiplies one of its numbers.
struct Family {
    masses: Vec<f64>,
    springs: Vec<f64>,
    force: Option<[f64; 2]>,
    contacts: Vec<(usize, usize, [f64; 5])>,
    varied: usize,
}

impl Family {
    fn random(random: &mut Random) -> Self {
        let n = 1 + (random.bits() % 3) as usize;
        let is_free = random.bits() & 1 == 0;
        let contacts = 1 + (random.bits() % 2) as usize;
        let contacts = (0..contacts.min(n)).map(|i| {
            let belt = random.uniform(0.1, 0.6);
            let on_belt = is_free || random.bits() & 1 == 0;
            let numbers = [
                random.uniform(0.3, 0.8),
                random.uniform(0.3, 0.9),
                random.uniform(0.2, 1.0),
                random.uniform(0.4, 1.5),
                if on_belt { belt } else { 0.0 },
            ];
            (i, (random.bits() % 4) as usize, numbers)
        });
        let contacts = contacts.collect();
        Self {
            contacts,
            masses: (0..n).map(|_| random.uniform(0.5, 2.0)).collect(),
            springs: (0..3 * n).map(|_| random.uniform(0.5, 2.0)).collect(),
            force: (!is_free).then(|| [random.uniform(0.3, 1.0), random.uniform(0.4, 1.6)]),
            varied: (random.bits() % 3) as usize,
        }
    }

    fn at(&self, parameter: f64) -> Result<Structure, Error> {
        let factor = |which: usize| if which == self.varied { parameter } else { 1.0 };
        let mut system = Structure::new(&self.masses)?;
        for i in 0..self.masses.len() {
            let numbers = &self.springs[3 * i..];
            system = system
                .with_ground_spring(i, numbers[0])?
                .with_ground_damper(i, 0.06 * numbers[1])?;
            if i > 0 {
                system = system.with_spring(i - 1, i, numbers[2])?;
            }
        }
        if let Some([size, frequency]) = self.force {
            let force = Drive::harmonic(size * factor(2), frequency * factor(0), 0.3)?;
            system = system.with_force(0, force)?;
        }
        for &(i, kind, [top, part, width, load, belt]) in &self.contacts {
            let load = load * factor(1);
            let contact = match kind {
                0 => Contact::new(i, Coulomb::new(top, part * top)?, load)?,
                1 => {
                    let law = Coulomb::new(part * top, part * top)?;
                    Contact::new(i, Dwell::exponential(law, top, width)?, load)?
                }
                _ => Contact::new(i, Exponential::new(top, part * top, width)?, load)?,
            };
            let belt = belt
                * if self.force.is_none() {
                    factor(0) * factor(2)
                } else {
                    1.0
                };
            system = system.with_contact(contact.on_belt(belt))?;
        }
        Ok(system)
    }

    fn motion(&self) -> Option<Orbit<State>> {
        let (system, rest) = (self.at(1.0).ok()?, State::at_rest(self.masses.len()));
        if self.force.is_some() {
            return settle(&system, &rest, 300.0, Period::Driven(1)).ok();
        }
        match classify(&system, &rest).ok()? {
            Attractor::PureSlip(orbit) | Attractor::StickSlip(orbit) => Some(*orbit),
            _ => None,
        }
    }
}

/// Returns true if a branch of doubled motions passes the flip at which it is born: behind it are
/// the same motions, begun half a period later.
fn is_born_within(branch: &Branch<State>) -> bool {
    let folds = branch.bifurcations.iter();
    let mut folds = folds.filter(|found| found.kind == BifurcationKind::Fold);
    folds.any(|fold| {
        let (orbit, half) = (&fold.orbit, 0.5 * fold.orbit.period());
        let states = [0.1 * half, 1.1 * half].map(|time| orbit.trajectory().state_at(time));
        let [Some(a), Some(b)] = states else {
            return false;
        };
        let mut pairs = a.displacements.iter().zip(&b.displacements).enumerate();
        pairs.all(|(i, (a, b))| (a - b).abs() < 1e-3 * orbit.amplitude(i))
    })
}

#[test]
fn random_branches_visit_no_motion_twice() {
    let mut random = Random::new(20_261_127);
    let [mut followed, mut lost] = [0; 2];
    for case in 0..count(8, 330) {
        let family = Family::random(&mut random);
        let Some(orbit) = family.motion() else {
            continue;
        };
        let branch = follow(|parameter| family.at(parameter), 1.0, &orbit, 0.75..1.25).unwrap();
        let row = retraced(&branch, family.masses.len());
        assert!(
            row < 3 || is_born_within(&branch),
            "{case}: {:?}",
            branch.bifurcations
        );
        let ends = branch.ends.iter();
        lost += ends
            .filter(|end| matches!(end, BranchEnd::Lost { .. }))
            .count();
        followed += 1;
    }
    assert!(150 * lost <= followed, "{lost} of {followed} lost");
    assert!(followed >= count(4, 200), "{followed}");
}

/// The two sides of a jump do not come nearer to each other: a few motions show that, and not as
/// many as a number has bits, for each step that is too long.
#[test]
fn a_jump_is_reached_by_few_motions() {
    let mut random = Random::new(20_261_127);
    let families = (0..=27).map(|_| Family::random(&mut random));
    let family = families.last().unwrap();
    let orbit = family.motion().unwrap();
    let steps = Cell::new(0);
    let search = Search::new().watched(|progress| {
        steps.set(progress.steps);
        ControlFlow::Continue(())
    });
    let at = |parameter: f64| family.at(parameter);
    let branch = search.follow(at, 1.0, &orbit, 0.75..1.25).unwrap();
    let [BranchEnd::Range, BranchEnd::Discontinuity { .. }] = branch.ends else {
        panic!("{:?}", branch.ends)
    };
    let of_a_motion = |point: &BranchPoint<State>| point.orbit.trajectory().steps().len();
    let longest = branch.points.iter().map(of_a_motion).max().unwrap();
    let motions = steps.get() / longest;
    assert!(
        motions < 40 * branch.points.len(),
        "{motions} for {}",
        branch.points.len()
    );
}

/// As the load falls, a contact at rest begins to slip to and fro. The first slips are as short as
/// rounding, and its position is not determined: the branch goes on beyond them.
#[test]
fn a_branch_passes_slips_that_are_rounding() {
    let mut random = Random::new(20_261_127);
    let family = (0..=114)
        .map(|_| Family::random(&mut random))
        .last()
        .unwrap();
    let orbit = family.motion().unwrap();
    let branch = follow(|parameter| family.at(parameter), 1.0, &orbit, 0.75..1.25).unwrap();
    assert_eq!(branch.ends, [BranchEnd::Range, BranchEnd::Range]);
    let [begin] = &branch.bifurcations[..] else {
        panic!("{:?}", branch.bifurcations)
    };
    assert_eq!(begin.kind, BifurcationKind::Grazing);
    let slips = |point: &BranchPoint<State>| {
        let mut events = point.orbit.events().iter();
        events.any(|event| event.contact() == Some(1))
    };
    let below = branch.points.iter().filter(|point| slips(point));
    let above = branch.points.iter().filter(|point| !slips(point));
    let last = below.map(|point| point.parameter).fold(0.0, f64::max);
    let first = above.map(|point| point.parameter).fold(2.0, f64::min);
    assert!(last < begin.parameter && begin.parameter < first);
    // Neighbouring systems from rest, simulated for long.
    for (beside, is_slipping) in [(-0.01, true), (0.01, false)] {
        let system = family.at(begin.parameter + beside).unwrap();
        let start = State::at_rest(family.masses.len());
        let period = orbit.period();
        let before = system.simulate(start, 400.0 * period).unwrap();
        let motion = system.simulate(before.last(), period).unwrap();
        let mut events = motion.events().iter();
        assert_eq!(events.any(|event| event.contact() == Some(1)), is_slipping);
    }
}

/// A contact of the string comes to stick where the displacement at the contact turns most sharply.
#[test]
fn a_bowed_string_is_followed_past_a_stick_at_its_turning_point() {
    let Attractor::StickSlip(orbit) =
        classify(&string(3.0, 0.4).unwrap(), &State::at_rest(3)).unwrap()
    else {
        panic!("not periodic")
    };
    assert!((orbit.period().recip() - 182.90).abs() < 0.01);
    let family = |load: f64| string(load, 0.4);
    let branch = follow(family, 3.0, &orbit, 2.9..3.2).unwrap();
    assert_eq!(branch.ends, [BranchEnd::Range, BranchEnd::Range]);
    assert_eq!(retraced(&branch, 3), 0);
    let parameters = branch.points.iter().map(|point| point.parameter);
    assert!(parameters.is_sorted());
    // From the other side of the place.
    let there = branch
        .points
        .iter()
        .find(|point| point.parameter > 3.02)
        .unwrap();
    let again = follow(family, there.parameter, &there.orbit, 2.9..3.2).unwrap();
    let of = |branch: &Branch<State>| -> Vec<_> {
        let found = branch.bifurcations.iter();
        found.map(|found| (found.kind, found.parameter)).collect()
    };
    assert_eq!(of(&branch).len(), 2);
    for (a, b) in of(&branch).into_iter().zip(of(&again)) {
        assert!(a.0 == b.0 && (a.1 - b.1).abs() < 1e-9, "{a:?} {b:?}");
    }
}

/// The motion of the slower string under a load of 2.
fn slow_string() -> Orbit<State> {
    let system = string(2.0, 0.2).unwrap();
    let period = Period::Free(1.0 / 190.0);
    settle(&system, &State::at_rest(3), 5.0, period).unwrap()
}

/// Motions of the slower string begin where one of its modes turns while the contact sticks, which
/// takes a velocity of another mode. Newton's method needs two or three motions for each of few
/// points, and no event is seen that is rounding.
#[test]
fn a_bowed_string_that_begins_in_stick_has_no_event_there() {
    let family = |load: f64| string(load, 0.2);
    let branch = follow(family, 2.0, &slow_string(), 2.0..7.0).unwrap();
    assert_eq!(branch.ends, [BranchEnd::Range, BranchEnd::Range]);
    assert!(branch.points.len() < 200, "{}", branch.points.len());
    let [torus] = &branch.bifurcations[..] else {
        panic!("{:?}", branch.bifurcations)
    };
    assert_eq!(torus.kind, BifurcationKind::NeimarkSacker);
    assert!((torus.parameter - 2.770368755).abs() < 1e-8);
}

/// Under larger loads the slower string does not end at a tangential event: the first multiplier
/// doubles with each quarter of a unit of the load, to 2·10⁵ at 12, as perturbations grow in the
/// falling friction of the slow begin of a slip. Steps stay as long as at small multipliers.
#[test]
fn a_bowed_string_is_followed_to_large_multipliers() {
    let family = |load: f64| string(load, 0.2);
    let branch = follow(family, 2.0, &slow_string(), 2.0..12.0).unwrap();
    assert_eq!(branch.ends, [BranchEnd::Range, BranchEnd::Range]);
    assert!(branch.points.len() < 200, "{}", branch.points.len());
    let growth = |point: &BranchPoint<State>| point.orbit.multipliers()[0].norm();
    let large = branch.points.iter().filter(|point| point.parameter > 10.0);
    let large: Vec<_> = large
        .map(|point| [point.parameter, growth(point).log2()])
        .collect();
    // Beside a tangential event the rate would grow without bound.
    for pair in large.windows(2) {
        let rate = (pair[1][1] - pair[0][1]) / (pair[1][0] - pair[0][0]);
        assert!((3.0..5.0).contains(&rate), "{rate} at {}", pair[0][0]);
    }
    let last = &branch.points[branch.points.len() - 1];
    assert!((1e5..4e5).contains(&growth(last)), "{}", growth(last));
    // A neighbouring start, simulated over one period, leaves the motion by about the multiplier.
    let system = family(12.0).unwrap();
    let state = last.orbit.state();
    let again = |change: f64| {
        let mut start = state.clone();
        start.displacements[1] += change;
        system.simulate(start, last.orbit.period()).unwrap().last()
    };
    let [here, beside] = [again(0.0), again(1e-14)].map(|end| end.displacements);
    let away = here.iter().zip(&beside).map(|(a, b)| (a - b).abs());
    assert!(away.fold(0.0, f64::max) > 1e-12);
}
