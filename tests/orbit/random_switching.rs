//! Branches that are born at the flips and pitchforks of random forced systems.

use stick_slip::orbit::{
    Bifurcation, BifurcationKind, Branch, BranchEnd, BranchPoint, Orbit, Search, classify, follow,
    shoot,
};
use stick_slip::structure::State;
use stick_slip::{Contact, Coulomb, Drive, Error, Stribeck, Structure};

use crate::common::{Random, count, vector};

/// One or two masses under harmonic forces, rubbed by a slow belt, or by a surface at rest so that
/// the motion may be symmetric, or by an elastic joint.
#[derive(Debug)]
struct Forced {
    masses: Vec<f64>,
    damping: f64,
    spring: f64,
    frequency: f64,
    static_friction: f64,
    kinetic_friction: f64,
    load: f64,
    belt: f64,
    falls: bool,
    tangential: Option<f64>,
    force: f64,
}

impl Forced {
    fn random(random: &mut Random) -> Self {
        let n = 1 + (random.bits() % 2) as usize;
        let static_friction = random.uniform(0.3, 0.7);
        let belt = [0.0, random.uniform(0.05, 0.3)];
        let tangential = random.bits().is_multiple_of(4);
        Self {
            masses: (0..n).map(|_| random.uniform(0.5, 1.5)).collect(),
            damping: random.uniform(0.01, 0.06),
            spring: random.uniform(0.5, 2.0),
            frequency: random.uniform(0.3, 1.3),
            static_friction,
            kinetic_friction: static_friction * random.uniform(0.4, 0.9),
            load: random.uniform(0.5, 1.8),
            belt: random.pick(&belt),
            falls: random.bits() & 1 == 0,
            tangential: tangential.then(|| random.uniform(2.0, 20.0)),
            force: random.uniform(0.3, 1.5),
        }
    }

    /// The system over the size of its force.
    fn at(&self, force: f64) -> Result<Structure, Error> {
        let n = self.masses.len();
        let mut structure = Structure::new(&self.masses)?;
        for i in 0..n {
            structure = structure
                .with_ground_spring(i, 1.0)?
                .with_ground_damper(i, self.damping)?;
        }
        for i in 1..n {
            structure = structure.with_spring(i - 1, i, self.spring)?;
        }
        let drive = Drive::harmonic(force, self.frequency, 0.0)?;
        structure = structure.with_force(n - 1, drive)?;
        let [s, k] = [self.static_friction, self.kinetic_friction];
        let contact = if self.falls {
            Contact::new(0, Stribeck::new(s, k, 0.3, 1)?, self.load)?
        } else if self.tangential.is_some() {
            Contact::new(0, Coulomb::new(k, k)?, self.load)?
        } else {
            Contact::new(0, Coulomb::new(s, k)?, self.load)?
        };
        let contact = contact.on_belt(self.belt);
        let contact = match self.tangential {
            Some(stiffness) if !self.falls => contact.with_tangential_stiffness(stiffness)?,
            _ => contact,
        };
        structure.with_contact(contact)
    }
}

/// The distances in the parameter from a bifurcation, each in units of the one before.
const NEARER: f64 = 0.125;

/// How far a motion is from one of the old branch: from itself after half its period at a flip, and
/// from its mirror image after half its period at a pitchfork.
fn apart(orbit: &Orbit<State>, kind: BifurcationKind) -> f64 {
    let half = orbit.trajectory().state_at(0.5 * orbit.period()).unwrap();
    let n = half.displacements.len();
    let [start, half] = [&orbit.state(), &half].map(vector);
    if kind == BifurcationKind::Flip {
        return (start - half).rows(0, 2 * n).amax();
    }
    // x(t + T/2) = c − x(t), with the means of the displacements in c.
    let mut mirrored = (start + half).rows(0, 2 * n).into_owned();
    for i in 0..n {
        mirrored[i] -= 2.0 * orbit.mean_displacement(i);
    }
    let means = (0..n).map(|i| {
        let (least, largest) = orbit.extremes(i);
        (0.5 * (least + largest) - orbit.mean_displacement(i)).abs()
    });
    means.fold(mirrored.amax(), f64::max)
}

/// Returns true if a branch that was born goes over to motions of the old branch.
fn strays(branch: &Branch<State>, kind: BifurcationKind) -> bool {
    let part = |orbit: &Orbit<State>| apart(orbit, kind) / vector(&orbit.state()).amax();
    let parts = branch.points.iter().map(|point| part(&point.orbit));
    let parts: Vec<f64> = parts.collect();
    let is_passage = |pair: &[f64]| pair[0].min(pair[1]) < 1e-9 && pair[0].max(pair[1]) > 1e-6;
    parts.windows(2).any(is_passage)
}

/// The exponent with which the distance from the old branch grows with that from the bifurcation,
/// between the nearest two of three motions, found one from the other. `None` if shooting from
/// there ends on the old branch, or if the motions have other events.
fn exponent(
    family: &dyn Fn(f64) -> Result<Structure, Error>,
    from: &Bifurcation<State>,
    born: &BranchPoint<State>,
) -> Option<f64> {
    let periods = (born.orbit.period() / from.orbit.period()).round() as usize;
    let events = periods * from.orbit.events().len();
    let origin = vector(&from.orbit.state());
    let mut way = vector(&born.orbit.state()) - &origin;
    let n = born.orbit.state().displacements.len();
    let mut distance = born.parameter - from.parameter;
    let mut size = apart(&born.orbit, from.kind);
    let mut exponent = None;
    for _ in 0..3 {
        distance *= NEARER;
        way *= NEARER.sqrt();
        let parameter = from.parameter + distance;
        let guess = &origin + &way;
        let guess = guess.as_slice();
        let state = State::new(&guess[..n], &guess[n..2 * n]).with_memory(&guess[2 * n..]);
        let found = shoot(&family(parameter).ok()?, &state, born.orbit.kind()).ok()?;
        way = vector(&found.state()) - &origin;
        let now = apart(&found, from.kind);
        if now < 0.1 * NEARER.sqrt() * size || found.events().len() != events {
            return None;
        }
        exponent = Some((now / size).ln() / NEARER.ln());
        size = now;
    }
    exponent
}

#[test]
fn what_is_born_is_another_motion_that_grows_with_the_root_of_the_distance() {
    /// Systems with births, which take little time; of all the first, every fifth has some.
    const FEW: [u64; 4] = [35, 44, 166, 346];
    let [mut found, mut none, mut measured] = [0; 3];
    let mut wrong: Vec<String> = Vec::new();
    let search = Search::new().with_max_steps(30_000).unwrap();
    let search = search.with_max_points(100).unwrap();
    let all = 1..=count(0, 60) as u64;
    for number in FEW.into_iter().chain(all) {
        let system = Forced::random(&mut Random::new(6100 + number));
        let family = |force: f64| system.at(force);
        let first = family(system.force).unwrap();
        let rest = State::at_rest(system.masses.len());
        let Ok(attractor) = search.classify(&first, &rest) else {
            continue;
        };
        let Some(orbit) = attractor.orbit() else {
            continue;
        };
        let range = 0.3 * system.force..2.0 * system.force;
        let Ok(branch) = search.follow(family, system.force, orbit, range.clone()) else {
            continue;
        };
        for from in &branch.bifurcations {
            let periods = match from.kind {
                BifurcationKind::Flip => 2.0,
                BifurcationKind::Pitchfork => 1.0,
                _ => continue,
            };
            let about = format!("system {number}, {} at {}", from.kind, from.parameter);
            let born = match from.switch(family) {
                Ok(born) => born,
                Err(error) => {
                    println!("{about}: {error}");
                    none += 1;
                    continue;
                }
            };
            found += 1;
            // A motion of the system.
            let there = family(born.parameter).unwrap();
            let start = born.orbit.state();
            let period = born.orbit.period();
            let motion = there.simulate(start.clone(), period).unwrap();
            let missed = (vector(&motion.last()) - vector(&start)).amax();
            // Another one than those of the old branch: of twice the period, or not symmetric.
            let distance = apart(&born.orbit, from.kind);
            let size = vector(&start).amax();
            let ratio = period / from.orbit.period() / periods;
            if missed > 1e-10
                || distance < 1e-5 * size
                || born.orbit.is_symmetric()
                || (ratio - 1.0).abs() > 1e-9
            {
                wrong.push(format!("{about}: {missed:e} {distance:e} {ratio}"));
            }
            // Other branches of such motions may lie near: this one turns back at the bifurcation.
            if (born.parameter - from.parameter).abs() > 1e-8 * system.force {
                let branch = Search::new().with_max_points(count(40, 70)).unwrap();
                let branch = branch.follow(family, born.parameter, &born.orbit, range.clone());
                let branch = branch.unwrap();
                let turns = branch.bifurcations.iter().any(|found| {
                    let off = (found.parameter - from.parameter).abs();
                    found.kind == BifurcationKind::Fold && off < 1e-8 * system.force
                });
                if !turns || strays(&branch, from.kind) {
                    let found = branch.bifurcations.iter().map(|it| (it.kind, it.parameter));
                    let found: Vec<_> = found.collect();
                    wrong.push(format!(
                        "{about}: {} {found:?} {:?}",
                        born.parameter, branch.ends
                    ));
                }
            }
            let Some(exponent) = exponent(&family, from, &born) else {
                continue;
            };
            measured += 1;
            if (exponent - 0.5).abs() > 0.01 {
                wrong.push(format!("{about}: exponent {exponent}"));
            }
        }
    }
    println!("{found} births, {measured} of them measured, {none} without");
    assert!(wrong.is_empty(), "{wrong:#?}");
    assert!(found > 2 && 20 * none <= found && 3 * measured >= 2 * found);
}

/// A motion of eight periods is stable over a hundredth of the range. The motions of sixteen are
/// near it at small amplitudes only.
#[test]
fn motions_of_many_periods_are_doubled() {
    let system = Forced::random(&mut Random::new(6100 + 351));
    let family = |force: f64| system.at(force);
    let search = Search::new().with_max_points(10).unwrap();
    let start = family(system.force).unwrap();
    let attractor = search.classify(&start, &State::at_rest(1)).unwrap();
    let orbit = attractor.orbit().unwrap();
    let branch = search.follow(family, system.force, orbit, 0.11..0.75);
    let branch = branch.unwrap();
    let flips = branch.bifurcations.iter();
    let mut flips: Vec<_> = flips
        .filter(|found| found.kind == BifurcationKind::Flip)
        .collect();
    // Beyond its own birth the branch runs through the same motions again.
    flips.dedup_by(|a, b| (a.parameter - b.parameter).abs() < 1e-9);
    assert_eq!(flips.len(), 2);
    for flip in flips {
        let born = flip.switch(family).unwrap();
        assert!((born.parameter - flip.parameter).abs() < 1e-3);
        let distance = apart(&born.orbit, flip.kind);
        assert!(distance > 1e-5, "{distance:e}");
        let start = born.orbit.state();
        let there = family(born.parameter).unwrap();
        let motion = there.simulate(start.clone(), born.orbit.period()).unwrap();
        let missed = (vector(&motion.last()) - vector(&start)).amax();
        assert!(missed < 1e-9, "{missed:e}");
        // Beside the flip the old motions are nearer than a step.
        let search = Search::new().with_max_points(4).unwrap();
        let branch = search.follow(family, born.parameter, &born.orbit, 0.11..0.75);
        assert!(!strays(&branch.unwrap(), flip.kind));
    }
}

/// Motions without the symmetry leave the symmetric ones at a pitchfork, and come back where the
/// events of both change. There they end, on both sides of the pitchfork.
#[test]
fn a_branch_ends_where_it_is_born_at_a_change_of_events() {
    let system = Forced::random(&mut Random::new(6100 + 166));
    let family = |force: f64| system.at(force);
    let range = 0.3 * system.force..2.0 * system.force;
    let start = family(system.force).unwrap();
    let attractor = classify(&start, &State::at_rest(system.masses.len())).unwrap();
    let orbit = attractor.orbit().unwrap();
    let old = follow(family, system.force, orbit, range.clone()).unwrap();
    let mut found = old.bifurcations.iter();
    let pitchfork = found.find(|found| found.kind == BifurcationKind::Pitchfork);
    let born = pitchfork.unwrap().switch(family).unwrap();
    let new = follow(family, born.parameter, &born.orbit, range).unwrap();
    assert!(!strays(&new, BifurcationKind::Pitchfork));
    let ends = [0, new.bifurcations.len() - 1].map(|i| &new.bifurcations[i]);
    for (end, change) in new.ends.iter().zip(ends) {
        let BranchEnd::Birth { parameter } = *end else {
            panic!("{end:?}")
        };
        assert_eq!(parameter, change.parameter);
        assert!(change.orbit.is_symmetric());
        // The symmetric motions change their events there, too.
        let mut changes = old.bifurcations.iter();
        assert!(changes.any(|found| {
            found.kind == change.kind && (found.parameter - parameter).abs() < 1e-9
        }));
    }
}
