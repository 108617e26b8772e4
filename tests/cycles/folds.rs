//! Folds of pure-slip cycles against the cycles themselves, counted on both sides.

use crate::common::{Random, on_belt};
use stick_slip::bifurcation::{
    crossing_velocities, fold_velocities, grazing_velocities, hopf_velocities, overshoot_velocities,
};
use stick_slip::limit_cycle::{self, CycleSet};
use stick_slip::{
    AnyLaw, Coulomb, CycleKind, Exponential, FrictionLaw, MassOnBelt, Polynomial, Rational,
    Stribeck,
};

fn at<L: FrictionLaw + Clone>(system: &MassOnBelt<L>, v_b: f64) -> CycleSet {
    let system = system.clone().with_belt_velocity(v_b).unwrap();
    limit_cycle::find(&system).unwrap()
}

/// How many pure-slip cycles there are; `None` where double precision can't tell.
fn count<L: FrictionLaw + Clone>(system: &MassOnBelt<L>, v_b: f64) -> Option<usize> {
    let cycles = at(system, v_b);
    cycles.unresolved().is_empty().then(|| {
        cycles
            .iter()
            .filter(|cycle| cycle.kind() == CycleKind::PureSlip)
            .count()
    })
}

/// On one side of a fold there are two cycles more than on the other, and they merge there: 10⁻² of
/// the distance to it brings them 10 times closer, and their multipliers to 1.
fn check_fold<L: FrictionLaw + Clone>(about: &str, system: &MassOnBelt<L>, fold: f64) {
    let peaks = |v_b: f64| -> Vec<(f64, f64)> {
        at(system, v_b)
            .iter()
            .filter(|cycle| cycle.kind() == CycleKind::PureSlip)
            .map(|cycle| (cycle.max_velocity(), cycle.multiplier()))
            .collect()
    };
    let closest = |distance: f64| {
        let [below, above] = [
            peaks(fold * (1.0 - distance)),
            peaks(fold * (1.0 + distance)),
        ];
        let (few, many) = if below.len() < above.len() {
            (below, above)
        } else {
            (above, below)
        };
        assert_eq!(
            many.len(),
            few.len() + 2,
            "{about}: {fold} {few:?} {many:?}"
        );
        many.windows(2)
            .map(|pair| {
                assert!((pair[0].1 < 1.0) != (pair[1].1 < 1.0), "{about}: {many:?}");
                let multiplier = (pair[0].1 - 1.0).abs().max((pair[1].1 - 1.0).abs());
                (pair[1].0 / pair[0].0 - 1.0, multiplier)
            })
            .min_by(|p, q| p.0.total_cmp(&q.0))
            .unwrap()
    };
    let [near, nearer] = [1e-7, 1e-9].map(closest);
    for ratio in [nearer.0 / near.0, nearer.1 / near.1] {
        assert!(
            (0.05..0.2).contains(&ratio),
            "{about}: {fold} {near:?} {nearer:?}"
        );
    }
}

fn exponential(damping: f64) -> MassOnBelt<Exponential> {
    on_belt(Exponential::new(0.6, 0.3, 0.4).unwrap(), 1.0, damping, 1.0)
}

/// On a wide grid a turning point leaves at one end of the range of peak velocities while another
/// one comes in at the other.
#[test]
fn no_fold_where_turning_points_only_change_places() {
    for damping in [0.15, 0.2, 0.22, 0.25, 0.28, 0.3] {
        let system = exponential(damping);
        for end in [1.0, 4.0, 20.0] {
            let folds = fold_velocities(&system, 0.003..end).unwrap();
            let expected = usize::from(damping < 0.22);
            assert_eq!(folds.len(), expected, "β = {damping}, to {end}: {folds:?}");
            for fold in folds {
                check_fold(&format!("β = {damping}"), &system, fold);
            }
        }
    }
}

/// Two folds close to Hopf velocities, on a grid that is forty times as wide as the law's fall.
#[test]
fn folds_of_a_narrow_law_in_a_wide_range() {
    let law = Stribeck::new(
        0.2298096082229402,
        0.07034011978121221,
        0.11045377669846623,
        4,
    )
    .and_then(|law| law.with_viscous_coefficient(0.02325845314578373))
    .unwrap();
    let system = on_belt(law, 1.0, 1.3321127212043296, 2.437575515979321);
    let folds = fold_velocities(&system, 0.01..4.0).unwrap();
    assert_eq!(folds.len(), 2, "{folds:?}");
    check_fold("narrow", &system, folds[1]);
}

/// A random system with a law that falls, or falls and rises again, and the largest belt velocity
/// to look at.
fn random_system(random: &mut Random, kind: usize) -> (MassOnBelt<AnyLaw>, f64) {
    let top = random.uniform(0.2, 0.8);
    let least = top * random.uniform(0.3, 0.9);
    let width = random.logarithmic(0.1, 1.5);
    let law: AnyLaw = match kind {
        0 => Exponential::new(top, least, width).unwrap().into(),
        1 => Polynomial::new(top, least, width).unwrap().into(),
        2 => Rational::new(top, random.uniform(0.2, 5.0))
            .and_then(|law| law.with_offset(0.7 * least))
            .and_then(|law| law.with_quadratic(random.uniform(0.0, 0.05)))
            .unwrap()
            .into(),
        _ => Stribeck::new(top, least, width, random.pick(&[1, 2, 3, 4]))
            .and_then(|law| law.with_viscous_coefficient(random.uniform(0.0, 0.05)))
            .unwrap()
            .into(),
    };
    let slope = law.slope(0.7 * width).abs();
    let load = random.logarithmic(0.1, 3.0);
    // A part of the damping that makes steady sliding stable there.
    let damping = 0.5 * load * slope * random.logarithmic(0.05, 1.2);
    let system = on_belt(law, 1.0, damping, load);
    // The cubic is stiff far above its minimum.
    (system, if kind == 1 { 2.0 * width } else { 4.0 })
}

/// Belt velocities, to 10⁻⁶, between which the number of pure-slip cycles changes, with the change.
/// Intervals are cut at the `cuts` in them first, then into halves.
fn changes(
    system: &MassOnBelt<AnyLaw>,
    cuts: &[f64],
    a: (f64, usize),
    b: (f64, usize),
    found: &mut Vec<(f64, f64, usize)>,
) {
    if a.1 == b.1 {
        return;
    }
    if b.0 / a.0 - 1.0 < 1e-6 {
        found.push((a.0, b.0, a.1.abs_diff(b.1)));
        return;
    }
    let cut = cuts.iter().find(|&&cut| a.0 < cut && cut < b.0);
    let middle = cut.copied().unwrap_or(0.5 * (a.0 + b.0));
    if let Some(cycles) = count(system, middle) {
        changes(system, cuts, a, (middle, cycles), found);
        changes(system, cuts, (middle, cycles), b, found);
    }
}

#[test]
fn folds_are_where_two_cycles_appear() {
    let mut random = Random::new(91);
    let (mut folds, mut seen, mut one) = (0, 0, 0);
    let cases = crate::common::count(16, 120);
    for i in 0..cases {
        let (system, end) = random_system(&mut random, i % 4);
        let about = format!("system {i}: {system:?}");
        let range = 0.01..end;
        let found = fold_velocities(&system, range.clone()).unwrap();
        assert!(found.is_sorted());
        for &fold in &found {
            folds += 1;
            check_fold(&about, &system, fold);
        }
        let counts: Vec<(f64, usize)> = (0..60)
            .map(|k| range.start * (range.end / range.start).powf((f64::from(k) + 0.5) / 60.0))
            .filter_map(|v_b| Some((v_b, count(&system, v_b)?)))
            .collect();
        // Where something happens by other searches, the number of cycles may change.
        let searches = [
            hopf_velocities,
            grazing_velocities,
            overshoot_velocities,
            crossing_velocities,
        ];
        let happens = searches.map(|search| search(&system, range.clone()).unwrap());
        let cuts: Vec<f64> = happens
            .iter()
            .chain([&found])
            .flatten()
            .flat_map(|v_b| [v_b * (1.0 - 4e-7), v_b * (1.0 + 4e-7)])
            .collect();
        let mut brackets = Vec::new();
        for pair in counts.windows(2) {
            changes(&system, &cuts, pair[0], pair[1], &mut brackets);
        }
        for (low, high, change) in brackets {
            let here = found
                .iter()
                .filter(|&&fold| low <= fold && fold <= high)
                .count();
            if change == 2 {
                seen += 1;
            } else {
                one += 1;
            }
            assert_eq!(
                here % 2,
                usize::from(change == 2),
                "{about}: {change} from {low} to {high}: {found:?}"
            );
        }
    }
    println!("{folds} folds found, {seen} seen by counting; {one} cycles appeared alone");
    assert!(8 * seen > cases && 6 * one > 5 * cases);
}

/// What a motion from the release point comes to.
fn released<L: FrictionLaw + Clone>(system: &MassOnBelt<L>, v_b: f64) -> Option<CycleKind> {
    let system = system.clone().with_belt_velocity(v_b).unwrap();
    limit_cycle::stick_slip(&system)
        .unwrap()
        .map(|cycle| cycle.kind())
}

/// Each velocity at which a cycle that sticks appears, disappears or changes its kind is found
/// once, by the function that is named for it, and nothing else is.
#[test]
fn kinds_change_where_they_are_said_to() {
    use CycleKind::{Overshoot, StickSlip};
    let mut random = Random::new(92);
    let mut counts = [0; 3];
    let cases = crate::common::count(40, 200);
    for i in 0..cases {
        let (system, end) = random_system(&mut random, i % 4);
        let system = system
            .clone()
            .with_load(system.load() * random.logarithmic(0.03, 1.0))
            .unwrap();
        let system = system
            .clone()
            .with_damping(system.damping() * random.logarithmic(0.01, 1.0))
            .unwrap();
        let about = format!("system {i}: {system:?}");
        let range = 0.01..end;
        let found = [
            grazing_velocities(&system, range.clone()).unwrap(),
            overshoot_velocities(&system, range.clone()).unwrap(),
            crossing_velocities(&system, range.clone()).unwrap(),
        ];
        let between = |a: Option<CycleKind>, b: Option<CycleKind>| match (a, b) {
            (None, Some(StickSlip)) | (Some(StickSlip), None) => Some(0),
            (Some(StickSlip), Some(Overshoot)) | (Some(Overshoot), Some(StickSlip)) => Some(1),
            (Some(Overshoot), None) | (None, Some(Overshoot)) => Some(2),
            _ => None,
        };
        for (which, found) in found.iter().enumerate() {
            for v_b in found {
                let sides = [1.0 - 1e-9, 1.0 + 1e-9].map(|side| released(&system, v_b * side));
                assert_eq!(
                    between(sides[0], sides[1]),
                    Some(which),
                    "{about}: {v_b} {sides:?}"
                );
                counts[which] += 1;
            }
        }
        let mut seen = [0; 3];
        let at = |v_b: f64| (v_b, released(&system, v_b));
        let points: Vec<_> = (0..200)
            .map(|k| range.start * (range.end / range.start).powf((f64::from(k) + 0.5) / 200.0))
            .map(at)
            .collect();
        for pair in points.windows(2) {
            let mut stack = vec![(pair[0], pair[1])];
            while let Some(((a, at_a), (b, at_b))) = stack.pop() {
                let middle = 0.5 * (a + b);
                if at_a == at_b {
                    continue;
                }
                if b / a - 1.0 > 1e-11 {
                    let halfway = at(middle);
                    stack.extend([((a, at_a), halfway), (halfway, (b, at_b))]);
                } else if let Some(which) = between(at_a, at_b) {
                    seen[which] += 1;
                    let near = |v: &&f64| (*v / middle - 1.0).abs() < 1e-10;
                    let here = found[which].iter().filter(near).count();
                    assert_eq!(here, 1, "{about}: {which} at {middle}: {found:?}");
                } else {
                    panic!("{about}: {at_a:?} {at_b:?} at {middle}");
                }
            }
        }
        assert!((0..3).all(|i| seen[i] <= found[i].len()), "{about}");
    }
    println!("{counts:?} changes of kind");
    assert!(counts.iter().all(|&count| 20 * count > cases));
}

#[test]
fn nothing_is_found_where_nothing_changes() {
    // A circle that touches the belt, at every belt velocity.
    let system = MassOnBelt::new(Coulomb::new(0.3, 0.3).unwrap(), 1.0).unwrap();
    assert_eq!(grazing_velocities(&system, 0.01..3.0).unwrap(), [0.0; 0]);
    assert_eq!(fold_velocities(&system, 0.01..3.0).unwrap(), [0.0; 0]);
    // Energy is kept: the contact is the mirror image of the release.
    let system = MassOnBelt::new(Coulomb::new(0.3, 0.1).unwrap(), 1.0).unwrap();
    assert_eq!(grazing_velocities(&system, 0.01..3.0).unwrap(), [0.0; 0]);
    assert_eq!(fold_velocities(&system, 0.01..3.0).unwrap(), [0.0; 0]);
}

/// Wherever a range is cut, none is lost and none is found twice.
#[test]
fn ranges_are_half_open() {
    type Search =
        fn(&MassOnBelt<Exponential>, std::ops::Range<f64>) -> Result<Vec<f64>, stick_slip::Error>;
    let searches: [(Search, f64); 2] = [(fold_velocities, 0.15), (grazing_velocities, 0.15)];
    for (search, damping) in searches {
        let system = exponential(damping);
        let all = search(&system, 0.05..1.0).unwrap();
        assert!(!all.is_empty());
        for &v_b in &all {
            for cut in [
                v_b.next_down(),
                v_b,
                v_b.next_up(),
                v_b.next_up().next_up(),
                v_b * 0.999,
                v_b * 1.001,
            ] {
                let below = search(&system, 0.05..cut).unwrap();
                let above = search(&system, cut..1.0).unwrap();
                assert_eq!(below.len() + above.len(), all.len(), "{v_b} {cut}");
            }
        }
    }
}
