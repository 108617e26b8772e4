//! One mass beside a Jenkins element: the exact symmetric response, against orbits.

use std::f64::consts::{PI, TAU};

use stick_slip::analysis::jenkins::{SymmetricResponse, first_harmonic, loop_area};
use stick_slip::nalgebra::Complex;
use stick_slip::orbit::{Branch, BranchEnd, Orbit, Period, follow, settle, shoot};
use stick_slip::structure::State;
use stick_slip::{Contact, Coulomb, Drive, EventKind, Structure};

use crate::common::{Random, one_mass};

/// Mass, damper, spring, spring and limit of the element, force and frequency.
type Given = [f64; 7];

fn response([m, c, k, k_t, limit, force, omega]: Given) -> Option<SymmetricResponse> {
    SymmetricResponse::at(m, c, k, k_t, limit, force, omega)
}

fn structure([m, c, k, k_t, limit, force, omega]: Given, phase: f64) -> Structure {
    let law = Coulomb::new(1.0, 1.0).unwrap();
    let element = Contact::new(0, law, limit).and_then(|c| c.with_tangential_stiffness(k_t));
    let force = Drive::harmonic(force, omega, phase).unwrap();
    one_mass([m, c, k], force, element.unwrap()).unwrap()
}

fn amplitude(orbit: &Orbit<State>) -> f64 {
    let (least, most) = orbit.extremes(0);
    0.5 * (most - least)
}

#[test]
fn responses_are_orbits() {
    let mut random = Random::new(40);
    let (mut slipping, mut sticking) = (0, 0);
    while slipping < 150 {
        let m = random.logarithmic(0.3, 3.0);
        let k = random.logarithmic(0.1, 10.0);
        let k_t = random.logarithmic(0.1, 30.0);
        let limit = random.logarithmic(0.1, 10.0);
        let force = limit * random.logarithmic(0.03, 30.0);
        let omega = ((k + k_t) / m).sqrt() * random.logarithmic(0.5, 2.0);
        let c = m * omega * random.logarithmic(0.01, 1.0);
        let given = [m, c, k, k_t, limit, force, omega];
        let Some(found) = response(given) else {
            continue;
        };
        let slips = k_t * found.amplitude > limit;
        // Begun at 1/8 of a period after the turn, away from all events at the turn itself.
        let structure = structure(given, found.phase + 0.25 * PI);
        let guess = if slips {
            let start = State::new(&[found.amplitude], &[0.0]).with_memory(&[limit]);
            let turned = self::structure(given, found.phase);
            turned.simulate(start, 0.25 * PI / omega).unwrap().last()
        } else {
            State::at_rest(1)
        };
        let orbit = shoot(&structure, &guess, Period::Driven(1)).unwrap();
        let size = found.amplitude;
        assert!(
            (amplitude(&orbit) - size).abs() < 1e-12 * size,
            "{given:?}: {found:?}"
        );
        if !slips {
            sticking += 1;
            assert_eq!(orbit.unslipped(), [0]);
            assert!(orbit.events().is_empty());
            // The slider keeps its place, and an orbit leaves its multiplier 1 out.
            let [one, a, b] = found.multipliers;
            assert_eq!(one, Complex::from(1.0));
            same_multipliers(&[a, b], orbit.multipliers(), &given);
            continue;
        }
        slipping += 1;
        same_multipliers(&found.multipliers, orbit.multipliers(), &given);
        assert_eq!(orbit.multipliers()[2].norm(), 0.0);
        let events = orbit.events();
        let count =
            |kind: fn(&EventKind) -> bool| events.iter().filter(|event| kind(&event.kind)).count();
        assert_eq!(count(|kind| *kind == EventKind::Stick), 2, "{given:?}");
        assert_eq!(
            count(|kind| matches!(kind, EventKind::Release(_))),
            2,
            "{given:?}"
        );
        // From a stop of the slider to its next start.
        let period = TAU / omega;
        let stick = events
            .iter()
            .position(|event| event.kind == EventKind::Stick);
        let stick = stick.unwrap();
        let next = &events[(stick + 1) % 4];
        let elapsed = (next.time - events[stick].time).rem_euclid(period);
        assert!(
            (elapsed - found.elastic_time).abs() < 1e-11 * period,
            "{given:?}"
        );
        // First-harmonic theory takes up the same energy at the same amplitude.
        let (_, _, loss) = first_harmonic(k_t, limit, found.amplitude, omega);
        assert_eq!(loss, loop_area(k_t, limit, found.amplitude));
    }
    assert!(sticking > 10, "{sticking}");
}

/// Compares two multipliers by sum and product, which are smooth where they meet.
fn same_multipliers(one: &[Complex<f64>], other: &[Complex<f64>], given: &Given) {
    assert_eq!(one.len(), other.len(), "{given:?}");
    let sum = |all: &[Complex<f64>]| all[0] + all[1];
    let product = |all: &[Complex<f64>]| all[0] * all[1];
    let apart = [sum(one) - sum(other), product(one) - product(other)];
    for apart in apart {
        assert!(apart.norm() < 1e-11, "{given:?}: {one:?}, not {other:?}");
    }
}

/// A branch in metres and seconds of a mass that vibrates by micrometres in a fraction of a
/// millisecond, beside the same one in its own units.
#[test]
fn branches_do_not_depend_on_units() {
    let (time, length) = (1e-4, 1e-6);
    let branch = |[per_time, length]: [f64; 2]| {
        let square = per_time * per_time;
        let family = |frequency: f64| {
            let [k, k_t] = [0.6, 0.4].map(|stiffness| stiffness * square);
            let [limit, force] = [0.3, 0.15].map(|force| force * length * square);
            let given = [1.0, 0.02 * per_time, k, k_t, limit, force, frequency];
            Ok(structure(given, 0.0))
        };
        let middle = 0.9 * per_time;
        let system = family(middle)?;
        let start = State::at_rest(1);
        let orbit = settle(&system, &start, 400.0 / per_time, Period::Driven(1))?;
        follow(family, middle, &orbit, 0.85 * per_time..1.12 * per_time)
    };
    let [plain, scaled] = [[1.0, 1.0], [1.0 / time, length]].map(|units| branch(units).unwrap());
    assert!(plain.ends.iter().all(|end| *end == BranchEnd::Range));
    assert_eq!(plain.ends, scaled.ends);
    let kinds = |branch: &Branch<State>| -> Vec<_> {
        branch.bifurcations.iter().map(|found| found.kind).collect()
    };
    assert!(!plain.bifurcations.is_empty());
    assert_eq!(kinds(&plain), kinds(&scaled));
    for (one, other) in plain.bifurcations.iter().zip(&scaled.bifurcations) {
        let apart = one.parameter - other.parameter * time;
        assert!(apart.abs() < 1e-9, "{} {}", one.kind, apart);
    }
}
