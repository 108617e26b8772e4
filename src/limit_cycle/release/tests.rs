//! The motion from the release point, compared with closed forms and simulations.

use super::super::crossings::CrossingMap;
use super::super::peaks::PeakMap;
use super::super::testing::{
    System, assert_close, circles, fast, fate, paper, rescaled, shrinks, spiral, traced,
};
use super::*;
use crate::motion::EventKind;
use crate::numerics::roots_with_slopes::Sample;
use crate::state::State;

/// The contacts of the arcs from the release point.
#[derive(Debug, PartialEq)]
struct Contacts {
    overshoot: f64,
    beyond_low: Option<f64>,
    beyond_high: Option<f64>,
}

fn contacts(tracer: &mut Tracer<'_>) -> Result<Contacts, Error> {
    let mut release = Release::follow(tracer)?;
    Ok(Contacts {
        overshoot: release.overshoot(tracer)?,
        beyond_low: release.beyond_low(tracer),
        beyond_high: release.beyond_high(tracer)?,
    })
}

#[test]
fn nothing_depends_on_the_unit_of_length() {
    // The units are powers of two, so that even the rounding is the same.
    let examples = [
        paper(0.2),
        paper(0.43),
        fast(0.15, 0.004, 0.1),
        fast(0.2, 0.001, 0.03),
        circles(0.4, 0.25, 0.2),
    ];
    for (unit, system) in [1.0 / 1024.0, 1024.0]
        .into_iter()
        .flat_map(|unit| examples.map(|system| (unit, system)))
    {
        let other = rescaled(&system, unit);
        let same = |small: Sample, large: Sample| {
            assert_eq!(large.x, small.x * unit);
            assert_eq!(large.value, small.value);
            assert_eq!(large.slope, small.slope / unit);
            assert_eq!(large.noise, small.noise);
            assert_eq!(large.work, small.work);
        };
        traced(&system, |a| {
            traced(&other, |b| {
                let (v_b, force) = (system.belt_velocity(), 3.0 * a.scale());
                for part in [0.3, 1.0] {
                    same(
                        PeakMap::of(a).growth(part * v_b)?,
                        PeakMap::of(b).growth(part * v_b * unit)?,
                    );
                }
                same(
                    CrossingMap::of(a).growth(force)?,
                    CrossingMap::of(b).growth(force * unit)?,
                );
                for (a, b) in
                    std::iter::zip(CrossingMap::of(a).least()?, CrossingMap::of(b).least()?)
                {
                    same(a, b);
                }
                assert_eq!(contacts(a)?, contacts(b)?);
                assert_eq!(a.scale() * unit, b.scale());
                assert_eq!(
                    a.system().carried_force() * unit,
                    b.system().carried_force()
                );
                let (fate, scaled_fate) = (fate(a)?, fate(b)?);
                let (found, scaled) = (
                    CrossingMap::of(a).roots(fate)?,
                    CrossingMap::of(b).roots(scaled_fate)?,
                );
                assert_eq!(
                    found
                        .roots
                        .iter()
                        .map(|force| force * unit)
                        .collect::<Vec<_>>(),
                    scaled.roots
                );
                assert_eq!(a.work(), b.work());
                Ok(())
            });
            Ok(())
        });
    }
}

#[test]
fn the_release_point_leads_to_stick_crossing_or_inwards() {
    let fate = |system: &System| traced(system, fate);
    let kind = |system: &System| {
        let cycle = traced(system, |tracer| Release::follow(tracer)?.into_cycle(tracer));
        cycle.map(|cycle| cycle.kind())
    };
    for (system, expected) in [
        (circles(0.4, 0.25, 0.2), CycleKind::StickSlip),
        (fast(0.15, 0.004, 0.1), CycleKind::StickSlip),
        (fast(0.18, 0.004, 0.1), CycleKind::Overshoot),
    ] {
        assert_eq!(fate(&system), ReleaseFate::Stick);
        assert_eq!(kind(&system), Some(expected));
    }
    assert_eq!(kind(&fast(0.3, 0.001, 0.03)), None);
    assert!(matches!(
        fate(&fast(0.3, 0.001, 0.03)),
        ReleaseFate::Outward
    ));
    assert_eq!(fate(&spiral(1.5, 0.2)), ReleaseFate::Inward);
    assert_eq!(fate(&spiral(0.1, 0.5)), ReleaseFate::Inward);
}

#[test]
fn contacts_of_circles() {
    for (rest, kinetic, v_b) in [(0.4, 0.25, 0.2), (0.5, 0.1, 0.3), (4.0, 3.0, 10.0)] {
        let contacts = traced(&circles(rest, kinetic, v_b), contacts);
        // The motion circles about μ_k, from the displacement μ_s to its mirror image.
        let excess: f64 = (rest - kinetic) / v_b;
        assert_close(contacts.overshoot, 0.5 * excess * excess, 1e-14);
        let beyond = (-rest - (2.0 * kinetic - rest)) / (v_b + rest);
        assert_close(contacts.beyond_low.unwrap(), beyond, 1e-13);
        assert_eq!(contacts.beyond_high, None);
    }
}

#[test]
fn contacts_of_motions_that_turn_back_or_settle() {
    for v_b in [0.2, 5.0] {
        // If the law has no jump, the velocity has its maximum v_b at the release point.
        let turns = traced(&spiral(0.1, v_b), contacts);
        assert_close(turns.overshoot, shrinks(0.1) - 1.0, 1e-14);
        assert_eq!((turns.beyond_low, turns.beyond_high), (None, None));
        let settles = traced(&spiral(1.5, v_b), contacts);
        assert_eq!(settles.overshoot, -1.0);
    }
}

#[test]
fn contacts_are_those_of_the_simulated_motion() {
    for (system, crosses) in [
        (fast(0.15, 0.004, 0.1), false),
        (fast(0.18, 0.004, 0.1), true),
        (fast(0.2, 0.001, 0.03), true),
        (fast(0.3, 0.001, 0.03), true),
    ] {
        let contacts = traced(&system, contacts);
        let (v_b, [low, high]) = (system.belt_velocity(), system.stick_limits());
        let scale = v_b + system.load() * 0.38;
        let motion = system
            .simulate(system.release_state().unwrap(), 16.0)
            .unwrap();
        let places: Vec<f64> = motion.events()[1..]
            .iter()
            .map(|event| event.state.displacement)
            .collect();
        assert_close(
            contacts.beyond_low.unwrap(),
            (low - places[0]) / scale,
            1e-13,
        );
        assert_eq!(contacts.beyond_low.unwrap() > 0.0, crosses);
        assert_eq!(motion.events()[1].kind != EventKind::Stick, crosses);
        // The acceleration with which the mass meets the belt; nearer to v_b it counts as at rest.
        let slower = v_b * (1.0 - 16.0 * f64::EPSILON);
        let rate = system.acceleration(State::new(places[0], slower)) / v_b;
        assert_close(contacts.overshoot, 0.5 * rate * rate, 1e-12);
        let beyond_high = crosses.then(|| (places[1] - high) / scale);
        assert_eq!(contacts.beyond_high.is_some(), crosses);
        if let (Some(found), Some(simulated)) = (contacts.beyond_high, beyond_high) {
            assert_close(found, simulated, 1e-12);
            assert_eq!(found > 0.0, motion.events()[2].kind != EventKind::Stick);
        }
    }
}
