//! Comparison of motions, and of branches of them.

use nalgebra::{DMatrix, DVector};

use super::super::branch::{Branch, BranchPoint};
use super::super::oscillator::Oscillator;
use super::super::period::Period;
use super::super::period_map::{state, vector};
use super::super::periodic_orbit::Orbit;
use super::super::type_erased_system::GeneralForm;
use crate::motion::sealed::State as _;
use crate::motion::{Segment, SystemState};
use crate::state::structure::State;

/// The largest distance of a state from the motion on which it lies, as a part of the extent: the
/// rounding of a motion that loses perturbations slowly.
const ONE: f64 = 1e-7;

/// The largest distance of a motion from a branch to which it belongs, as a part of its extent.
const ON_BRANCH: f64 = 1e-2;

/// The least and the largest displacements of a motion.
fn extremes<S: SystemState>(orbit: &Orbit<S>) -> Vec<(f64, f64)> {
    let count = orbit.state().general().displacements.len();
    (0..count).map(|i| orbit.extremes(i)).collect()
}

/// The largest extent of a motion.
pub(super) fn extent<S: SystemState>(orbit: &Orbit<S>) -> f64 {
    let extents = extremes(orbit).into_iter();
    extents
        .map(|(least, most)| most - least)
        .fold(0.0, f64::max)
}

/// Returns true if a period is another one or a multiple of it, or the other way round: the same
/// motion may be found over several of its periods.
fn fits(period: f64, other: f64, error: f64) -> bool {
    let ratio = (period / other).max(other / period);
    (ratio - ratio.round()).abs() <= error
}

/// Returns true if two motions of one system are the same: one passes the states of the other, at
/// the same phase of the drives. It may begin elsewhere and take another number of periods. Motions
/// that differ have no state in common, however near they lie.
pub(super) fn is_one<S: Oscillator>(system: &S, a: &Orbit<S::State>, b: &Orbit<S::State>) -> bool {
    /// Instants of a period, apart from each other, at which they are compared.
    const PLACES: [f64; 3] = [0.0, 0.37, 0.71];
    let form = system.form();
    let numbers = |orbit: &Orbit<S::State>, time: f64| {
        let state = orbit.trajectory().state_at(time)?.general();
        let state = form.put_back(&state, &State::at_rest(form.len()));
        Some([state.displacements, state.velocities].concat())
    };
    let mut sizes = [extent(a).max(extent(b)), 0.0];
    for (least, most) in
        (0..form.len()).flat_map(|i| [a, b].map(|orbit| orbit.velocity_extremes(i)))
    {
        sizes[1] = f64::max(sizes[1], most - least);
    }
    let apart = |time: f64, state: &[f64]| {
        let numbers = numbers(a, time).unwrap_or_default();
        let parts = std::iter::zip(&numbers, state).enumerate();
        parts.fold(0.0, |most: f64, (i, (x, y))| {
            most.max((x - y).abs() / sizes[usize::from(i >= form.len())])
        })
    };
    PLACES.iter().all(|place| {
        let time = place * b.period();
        let Some(state) = numbers(b, time) else {
            return false;
        };
        match b.kind() {
            Period::Driven(count) => {
                let drive = b.period() / count as f64;
                let periods = (a.period() / drive).round() as usize;
                let mut times = (0..periods).map(|k| (time + k as f64 * drive) % a.period());
                times.any(|time| apart(time, &state) <= ONE)
            }
            Period::Free(_) => nearest(a, |time| apart(time, &state)) <= ONE,
        }
    })
}

/// The start of a motion moved along its family so that the contacts that never slip have the
/// positions that they have in another motion; `None` unless they are the same contacts, and the
/// positions tell the members apart.
pub(super) fn in_positions<S: SystemState>(
    form: &GeneralForm<'_>,
    motion: &Orbit<S>,
    other: &Orbit<S>,
) -> Option<S> {
    let contacts = motion.unslipped();
    let is_told = !contacts.is_empty() && motion.families().len() == contacts.len();
    if !is_told || contacts != other.unslipped() {
        return None;
    }
    // What is constant while a contact sticks.
    let position = |state: &State, contact: usize| {
        let of = &form.model().contacts[contact];
        let displacement = of.along(|j| state.displacements[j]);
        match of.tangential_stiffness {
            Some(stiffness) => {
                let row = form.carried_row(contact) - 2 * form.len();
                displacement - state.memory.get(row).copied().unwrap_or(0.0) / stiffness
            }
            None => displacement,
        }
    };
    let order = form.order();
    let [from, to] = [motion, other].map(|orbit| orbit.state().general());
    let directions: Vec<State> = motion.families().iter().map(S::general).collect();
    let matrix = DMatrix::from_fn(contacts.len(), directions.len(), |i, j| {
        position(&directions[j], contacts[i])
    });
    let apart = DVector::from_fn(contacts.len(), |i, _| {
        position(&to, contacts[i]) - position(&from, contacts[i])
    });
    let parts = matrix.lu().solve(&apart)?;
    let moved = std::iter::zip(&directions, &parts).fold(vector(&from, order), |sum, (d, part)| {
        sum + vector(d, order) * *part
    });
    Some(S::of_general(&state(&moved, form.len())))
}

/// The least of a distance along a motion, which falls and rises linearly beside a zero.
fn nearest<S: SystemState>(orbit: &Orbit<S>, apart: impl Fn(f64) -> f64) -> f64 {
    /// Parts of a step, and sections of an interval by its golden ratio.
    const PARTS: usize = 8;
    const SECTIONS: usize = 64;
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let steps = orbit.trajectory().steps().iter();
    let times = steps.flat_map(|step| {
        let part = step.duration() / PARTS as f64;
        (0..PARTS).map(move |k| step.start_time() + k as f64 * part)
    });
    let times: Vec<f64> = times.chain([orbit.period()]).collect();
    let known: Vec<f64> = times.iter().map(|time| apart(*time)).collect();
    let last = times.len() - 1;
    let least = |i: &usize| {
        known[*i] <= known[i.saturating_sub(1)] && known[*i] <= known[(i + 1).min(last)]
    };
    let minima = (0..=last).filter(least).map(|i| {
        let (mut low, mut high) = (times[i.saturating_sub(1)], times[(i + 1).min(last)]);
        for _ in 0..SECTIONS {
            let inside = GOLDEN * (high - low);
            if apart(high - inside) < apart(low + inside) {
                high = low + inside;
            } else {
                low = high - inside;
            }
        }
        apart(0.5 * (low + high)).min(known[i])
    });
    minima.fold(f64::INFINITY, f64::min)
}

/// Returns true if a motion belongs to a branch: its numbers lie between those of neighbouring
/// points, wherever a translation that no force depends on has put them.
pub(super) fn is_on<S: SystemState>(
    form: &GeneralForm<'_>,
    branch: &Branch<S>,
    parameter: f64,
    orbit: &Orbit<S>,
) -> bool {
    let numbers = |orbit: &Orbit<S>| -> Vec<f64> {
        let (mut least, mut most): (Vec<f64>, Vec<f64>) = extremes(orbit).into_iter().unzip();
        form.untranslated(&mut least);
        form.untranslated(&mut most);
        [least, most].concat()
    };
    let (own, extent) = (numbers(orbit), extent(orbit));
    branch.points.windows(2).any(|pair| {
        let [a, b] = [0, 1].map(|i: usize| &pair[i] as &BranchPoint<S>);
        let part = (parameter - a.parameter) / (b.parameter - a.parameter);
        (0.0..=1.0).contains(&part)
            && {
                let period = a.orbit.period() * (1.0 - part) + b.orbit.period() * part;
                fits(orbit.period(), period, ON_BRANCH)
            }
            && {
                let pairs = std::iter::zip(numbers(&a.orbit), numbers(&b.orbit));
                pairs.zip(&own).all(|((a, b), own)| {
                    let apart = (a * (1.0 - part) + b * part - own).abs();
                    apart <= ON_BRANCH * extent + 0.1 * (a - b).abs()
                })
            }
    })
}

/// Returns true if most of some motions of a branch belong to another one.
pub(super) fn is_same<S: SystemState>(
    form: &GeneralForm<'_>,
    known: &Branch<S>,
    branch: &Branch<S>,
) -> bool {
    const TRIED: usize = 9;
    let count = branch.points.len();
    let tried = (0..TRIED).filter_map(|i| branch.points.get(count * (i + 1) / (TRIED + 1)));
    let same = tried.filter(|point| is_on(form, known, point.parameter, &point.orbit));
    2 * same.count() > TRIED
}

#[cfg(test)]
mod tests {
    use super::super::super::follow::follow;
    use super::super::super::oscillator::FamilyMember as _;
    use super::super::super::shoot::{settle, shoot};
    use super::*;
    use crate::belt::MassOnBelt;
    use crate::error::Error;
    use crate::friction::Exponential;
    use crate::numerics::testing::some;

    /// A motion lies on its own branch, and the one beyond the fold on another, whatever the unit
    /// of length.
    #[test]
    fn a_motion_is_on_its_own_branch_in_all_units() {
        for unit in some(1, [1e3, 1.0, 1e-3]) {
            let family = |velocity: f64| -> Result<MassOnBelt<Exponential>, Error> {
                let law = Exponential::new(0.4, 0.25, 0.5 * unit)?;
                let belt = MassOnBelt::new(law, velocity * unit)?;
                belt.with_damping(0.05)?.with_load(unit)
            };
            let belt = family(0.805).unwrap();
            let start = (0.4 * unit, 0.8 * unit).into();
            let stable = settle(&belt, &start, 400.0, Period::Free(6.3)).unwrap();
            let branch = follow(family, 0.805, &stable, 0.8..0.81).unwrap();
            let whole = follow(family, 0.805, &stable, 0.8..0.9).unwrap();
            let off = |point: &&BranchPoint<_>| (point.parameter - 0.805).abs();
            let beyond = whole.points.iter().filter(|point| !point.orbit.is_stable());
            let nearest = beyond.min_by(|a, b| off(a).total_cmp(&off(b))).unwrap();
            let other = shoot(&belt, &nearest.orbit.state(), nearest.orbit.kind()).unwrap();
            assert!(stable.is_stable() && !other.is_stable());
            let form = belt.form();
            assert!(is_on(&form, &branch, 0.805, &stable), "{unit}");
            assert!(!is_on(&form, &branch, 0.805, &other), "{unit}");
        }
    }

    /// Two motions just before the fold at which they meet are two, and each is the same from every
    /// start and over several periods.
    #[test]
    fn motions_that_nearly_meet_are_two() {
        let family = |velocity: f64| -> Result<MassOnBelt<Exponential>, Error> {
            MassOnBelt::new(Exponential::new(0.4, 0.25, 0.5)?, velocity)?.with_damping(0.05)
        };
        let belt = family(0.805).unwrap();
        let stable = settle(&belt, &(0.4, 0.8).into(), 400.0, Period::Free(6.3)).unwrap();
        let branch = follow(family, 0.805, &stable, 0.8..0.9).unwrap();
        let mut folds = branch.bifurcations.iter();
        let fold = folds.find(|found| found.parameter > 0.819).unwrap();
        let sides = branch.points.split_at(fold.behind + 1);
        for before in [1e-2, 1e-3, 1e-4] {
            let velocity = fold.parameter - before;
            let belt = family(velocity).unwrap();
            let [one, other] = [sides.0, sides.1].map(|side| {
                let off = |point: &&BranchPoint<_>| (point.parameter - velocity).abs();
                let nearest = side.iter().min_by(|a, b| off(a).total_cmp(&off(b)));
                let orbit = &nearest.unwrap().orbit;
                shoot(&belt, &orbit.state(), orbit.kind()).unwrap()
            });
            assert!(one.is_stable() != other.is_stable());
            assert!(!is_one(&belt, &one, &other) && !is_one(&belt, &other, &one));
            for orbit in [one, other] {
                for (part, count) in [(0.0, 1.0), (0.3, 1.0), (0.8, 2.0)] {
                    let state = orbit.trajectory().state_at(part * orbit.period()).unwrap();
                    let estimate = Period::Free(count * orbit.period());
                    let again = shoot(&belt, &state, estimate).unwrap();
                    assert!((again.period() / orbit.period() - count).abs() < 1e-9);
                    assert!(is_one(&belt, &orbit, &again) && is_one(&belt, &again, &orbit));
                }
            }
        }
    }
}
