//! Closed forms that are exact: they meet the motions to rounding.

use std::f64::consts::TAU;

use proptest::prelude::*;
use stick_slip::analysis::coulomb::{self, FreeVibration};
use stick_slip::analysis::dwell::{DwellOscillator, ExactCycle};
use stick_slip::analysis::forced::{ForcedOscillator, no_stop_limit};
use stick_slip::structure::State as Place;
use stick_slip::{
    Coulomb, Dwell, EventKind, FrictionLaw, LimitCycle, MassOnBelt, State, limit_cycle,
};

use super::{Bounds, Verdict, check, decades, or_zero, sign, system};
use crate::common::{Random, count, dwelling, forced};

const EPS: f64 = f64::EPSILON;

/// μ_s and μ_k, the load and the damping ratio. Not μ_k = 0: without damping the mass then meets
/// the belt where static friction can just hold it, and rounding decides.
fn constant() -> impl Strategy<Value = (Coulomb, f64, f64)> {
    let law = (decades(1e-2, 10.0), 0.01..0.99);
    let law = law.prop_map(|(top, least)| Coulomb::new(top, least * top).unwrap());
    (law, decades(1e-3, 1e3), or_zero(decades(1e-8, 0.95)))
}

/// γ²(μ_s − μ_k).
fn jump(of: &MassOnBelt<Coulomb>) -> f64 {
    of.load() * (of.law().static_coefficient() - of.law().kinetic_coefficient())
}

/// The cycle that was found, if it never overtakes the belt: that of the formula.
fn found(of: &MassOnBelt<Coulomb>) -> Option<LimitCycle> {
    let found = limit_cycle::stick_slip(of).unwrap();
    found.filter(|cycle| cycle.leading_duration() == 0.0)
}

/// How steeply the sliding speed falls to 0 at the contact, in units of ωv but at most 1. The time
/// of contact is known the worse, the smaller this is.
fn arrival(of: &DwellOscillator, cycle: &ExactCycle) -> f64 {
    let v = cycle.belt_velocity.abs();
    let kinetic = of.load * of.law.law().kinetic_coefficient();
    let place = cycle.contact_displacement * cycle.belt_velocity.signum();
    let force = kinetic - of.stiffness * place - of.damping * v;
    (force / (v * f64::sqrt(of.stiffness * of.mass)))
        .abs()
        .min(1.0)
}

/// The same cycle, in units of v_b.
fn meets(bounds: &Bounds, of: &MassOnBelt<Coulomb>, formula: &ExactCycle) -> Verdict {
    let oscillator = DwellOscillator {
        law: Dwell::logarithmic(*of.law(), 0.0, 1.0).unwrap(),
        mass: 1.0,
        stiffness: 1.0,
        damping: 2.0 * of.damping(),
        load: of.load(),
    };
    // Where the mass comes back to the belt along it, rounding decides whether it does.
    let arrival = arrival(&oscillator, formula);
    prop_assume!(arrival > 1e-6);
    let cycle = found(of);
    prop_assert!(cycle.is_some(), "not found: {formula:?}");
    let cycle = cycle.unwrap();
    let speed = of.belt_velocity().abs();
    let size = 1.0 + of.load() * of.law().static_coefficient() / speed;
    let allowed = 64.0 * EPS * size / arrival;
    let release = of.release_state().unwrap().displacement;
    let fastest = cycle.max_sliding_speed();
    for (name, error) in [
        ("stick", cycle.stick_duration() - formula.stick_duration),
        ("period", cycle.period() - formula.period()),
        ("release", (release - formula.release_displacement) / speed),
        ("amplitude", (cycle.amplitude() - formula.amplitude) / speed),
        (
            "largest sliding speed",
            (fastest - formula.max_sliding_speed) / speed,
        ),
        ("multiplier", cycle.multiplier() - formula.multiplier),
    ] {
        bounds.hold(name, error, allowed)?;
    }
    Ok(())
}

/// Below the largest velocity the cycle is that of the formula, above it there is none.
#[test]
fn coulomb_cycles() {
    let beside = prop_oneof![decades(1e-9, 1e-2), 0.01..0.98];
    check(
        (constant(), sign(), beside),
        |((law, load, damping), sign, beside), bounds| {
            let one = system(law, 1.0, damping, load);
            let largest = coulomb::largest_stick_slip_velocity(&one);
            let fastest = if damping == 0.0 {
                10.0 * jump(&one)
            } else {
                largest
            };
            prop_assert_eq!(coulomb::quiet_velocity(&one), largest);
            let slower = one
                .with_belt_velocity(sign * (1.0 - beside) * fastest)
                .unwrap();
            match coulomb::stick_slip(&slower) {
                Some(formula) => meets(bounds, &slower, &formula)?,
                // The mass overtakes the belt.
                None => {
                    let cycle = limit_cycle::stick_slip(&slower).unwrap();
                    let leads = cycle.is_some_and(|cycle| cycle.leading_duration() > 0.0);
                    prop_assert!(leads, "no formula");
                }
            }
            let faster = one
                .with_belt_velocity(sign * (1.0 + beside) * fastest)
                .unwrap();
            let exists = damping == 0.0;
            prop_assert_eq!(coulomb::stick_slip(&faster).is_some(), exists);
            prop_assert_eq!(limit_cycle::stick_slip(&faster).unwrap().is_some(), exists);
            Ok(())
        },
    );
}

/// With more than the silencing damping there is no stick-slip, with less there is.
#[test]
fn coulomb_silence() {
    let beside = prop_oneof![decades(1e-9, 1e-2), 0.01..0.98];
    let cases = (constant(), sign(), decades(1e-2, 30.0), beside);
    check(cases, |((law, load, _), sign, ratio, beside), _| {
        let one = system(law, 1.0, 0.0, load);
        let system = one.with_belt_velocity(sign * ratio * jump(&one)).unwrap();
        let damping = coulomb::silencing_damping(&system).unwrap();
        let sticks = |damping: f64| {
            let cycle = limit_cycle::stick_slip(&system.with_damping(damping).unwrap());
            cycle.unwrap().is_some()
        };
        prop_assert!(sticks((1.0 - beside) * damping), "none below {damping}");
        // Above 1 nothing swings.
        prop_assert!(!sticks((1.0 + beside) * damping), "one above {damping}");
        Ok(())
    });
}

/// Turning points and the place of rest of a motion on a belt that stands still.
#[test]
fn free_vibration() {
    let law = (decades(1e-2, 10.0), 0.02..1.0, decades(1e-3, 1e3));
    let start = (0.0..80.0, 0.0..TAU);
    check(
        (law, start),
        |((top, least, load), (radius, angle)), bounds| {
            let system = system(Coulomb::new(top, least * top).unwrap(), 0.0, 0.0, load);
            let loss = load * least * top;
            let size = radius * loss + load * top;
            let start = State::new(size * f64::sin(angle), size * f64::cos(angle));
            let formula = FreeVibration::new(&system, start).unwrap();
            let turns: Vec<_> = formula.turning_points().collect();
            let end = formula.rest_time().unwrap();
            let motion = system.simulate(start, end + 1.0).unwrap();
            let events = motion.events();
            prop_assert_eq!(events.len(), turns.len());
            for (i, (event, (time, place))) in events.iter().zip(&turns).enumerate() {
                let stops = event.kind == EventKind::Stick;
                prop_assert_eq!(stops, i + 1 == turns.len());
                // How well the time is known depends on the force that turns the mass.
                let force = f64::abs(place.abs() - loss).max(loss * least);
                bounds.hold("time", event.time - time, 64.0 * EPS * (end + size / force))?;
                bounds.hold("place", event.state.displacement - place, 64.0 * EPS * size)?;
            }
            bounds.hold(
                "loss",
                formula.amplitude_loss() - 4.0 * loss,
                8.0 * EPS * loss,
            )?;
            let rest = formula.rest_position().unwrap();
            bounds.hold("rest", motion.last().displacement - rest, 64.0 * EPS * size)
        },
    );
}

/// Time and place of the release and of the contact that follow a contact at some place.
fn caught(of: &DwellOscillator, cycle: &ExactCycle, place: f64) -> Option<[(f64, f64); 2]> {
    let v = cycle.belt_velocity;
    let start = Place::new(&[place], &[v]).with_memory(&[0.0]);
    let motion = dwelling(of, v)
        .simulate(start, 1.5 * cycle.period())
        .unwrap();
    let [release, contact, ..] = motion.events() else {
        return None;
    };
    let kinds = matches!(release.kind, EventKind::Release(_)) && contact.kind == EventKind::Stick;
    kinds.then(|| [release, contact].map(|event| (event.time, event.state.displacements[0])))
}

/// The amplitude and the largest sliding speed are those of the motion at so many moments that it
/// can be larger in between by the last part of a parabola only.
fn reaches(bounds: &Bounds, of: &DwellOscillator, cycle: &ExactCycle) -> Verdict {
    const MOMENTS: usize = 1000;
    let v = cycle.belt_velocity;
    let start = Place::new(&[cycle.contact_displacement], &[v]).with_memory(&[0.0]);
    let motion = dwelling(of, v).simulate(start, cycle.period()).unwrap();
    let (mut least, mut largest, mut fastest) = (f64::INFINITY, f64::NEG_INFINITY, 0.0_f64);
    for (_, state) in motion.sample(MOMENTS) {
        least = least.min(state.displacements[0]);
        largest = largest.max(state.displacements[0]);
        fastest = fastest.max((state.velocities[0] - v).abs());
    }
    let omega = f64::sqrt(of.stiffness / of.mass);
    let between = 0.5 * (0.5 * omega * cycle.period() / MOMENTS as f64).powi(2) + 1e-12;
    // |u''| and |v''| are at most so large: damping is below critical.
    let size = 6.0 * (cycle.amplitude + cycle.max_sliding_speed / omega + v.abs() / omega);
    for (name, error) in [
        ("amplitude", 0.5 * (largest - least) - cycle.amplitude),
        (
            "largest sliding speed",
            (fastest - cycle.max_sliding_speed) / omega,
        ),
    ] {
        bounds.hold(name, error, between * size)?;
    }
    Ok(())
}

/// The motion from the contact comes back to it, and a little beside it the return map has the
/// slope of the formula, with an error of second order in the difference.
fn returns(bounds: &Bounds, of: &DwellOscillator, cycle: &ExactCycle, last: i32) -> Verdict {
    let place = cycle.contact_displacement;
    let followed = caught(of, cycle, place);
    prop_assert!(followed.is_some(), "not followed: {cycle:?}");
    let [release, contact] = followed.unwrap();
    let (v, arrival) = (cycle.belt_velocity.abs(), arrival(of, cycle));
    let omega = f64::sqrt(of.stiffness / of.mass);
    let size = cycle.release_displacement.abs() + cycle.amplitude + v / omega;
    let noise = EPS * (size * omega / v + omega * cycle.period()) / arrival;
    reaches(bounds, of, cycle)?;
    for (name, error) in [
        ("stick", release.0 - cycle.stick_duration),
        ("period", contact.0 - cycle.period()),
        ("release", (release.1 - cycle.release_displacement) / v),
        ("contact", (contact.1 - place) / v),
    ] {
        bounds.hold(name, error * omega, 64.0 * noise)?;
    }
    let widest = 2.0_f64.powi(-6) * f64::min(cycle.stick_duration, arrival * arrival / omega) * v;
    let squares = [1.0, 0.25, 0.0625, 0.0625 * 0.25_f64.powi(last)];
    let error = |square: f64| {
        let h = widest * square.sqrt();
        let [to, from] = [h, -h].map(|h| caught(of, cycle, place + h).map(|[_, end]| end.1));
        let slope = (to? - from?) / (2.0 * h);
        Some((slope - cycle.multiplier, noise * v / omega / h))
    };
    let errors: Option<Vec<_>> = squares.into_iter().map(error).collect();
    // At the end of the band the mass may not be held where it is put.
    prop_assume!(errors.is_some());
    let name = if cycle.is_stable() {
        "multiplier, stable"
    } else {
        "multiplier, unstable"
    };
    bounds.order(name, 1.0, |x| x, &squares, &errors.unwrap_or_default())
}

#[test]
fn dwell_cycles() {
    let law = (
        0..3_usize,
        0.05..1.0,
        or_zero((0.01..1.0).boxed()),
        decades(0.05, 2.0),
        decades(0.1, 20.0),
    );
    let units = (decades(0.1, 10.0), decades(0.1, 10.0), decades(0.1, 10.0));
    let cases = (
        law,
        units,
        or_zero(decades(1e-3, 0.8)),
        sign(),
        0.01..0.9,
        1..5_i32,
    );
    check(
        cases,
        |(law, (mass, stiffness, load), damping, sign, beside, last), bounds| {
            let (form, kinetic, jump, rise, time) = law;
            let omega = f64::sqrt(stiffness / mass);
            let (time, static_) = (time / omega, kinetic * (1.0 + jump));
            let constant = Coulomb::new(static_, kinetic).unwrap();
            let risen = static_ + rise * kinetic;
            let law = match form {
                0 => Dwell::exponential(constant, risen, time),
                1 => Dwell::hyperbolic(constant, risen, time),
                _ => Dwell::logarithmic(constant, rise * kinetic, time),
            };
            let damping = 2.0 * damping * f64::sqrt(mass * stiffness);
            let of = DwellOscillator {
                law: law.unwrap(),
                mass,
                stiffness,
                damping,
                load,
            };
            let fold = of.fold();
            if let Some(fold) = fold {
                let slow = arrival(&of, &fold);
                // What remains of the force there, in units of its rounding.
                let force = of.load * kinetic / (fold.belt_velocity * f64::sqrt(stiffness * mass));
                if slow > 300.0 * EPS * (1.0 + force) {
                    bounds.hold("fold", fold.multiplier - 1.0, 3e-15 * (1.0 + 1.0 / slow))?;
                }
            }
            let fold = fold.map(|fold| fold.belt_velocity);
            let critical = of.critical_velocity().filter(|v| v.is_finite());
            let scale = load * kinetic * (jump + rise) / f64::sqrt(mass * stiffness);
            let end = fold.or(critical);
            let v = sign * (1.0 - beside) * end.unwrap_or(scale);
            let slowest = of.grazing_velocity().zip(fold);
            let slower = slowest.map(|(least, fold)| sign * (fold - beside * (fold - least)));
            let unstable = slower.and_then(|v| of.unstable_stick_slip(v));
            // The two come in pairs, wherever rounding tells them apart.
            if let Some((least, fold)) = slowest.filter(|(least, fold)| fold - least > 1e-6 * fold)
            {
                let stable = slower.and_then(|v| of.stick_slip(v));
                prop_assert!(stable.is_none() || unstable.is_some());
                let [above, below] = [1e-3, -1e-3]
                    .map(|part| of.unstable_stick_slip(sign * (least + part * (fold - least))));
                prop_assert!(above.is_some() && below.is_none());
            }
            if let Some(critical) = critical {
                prop_assert!(of.stick_slip(sign * 0.999 * critical).is_some());
            }
            for (cycle, stable) in [(of.stick_slip(v), true), (unstable, false)] {
                let Some(cycle) = cycle else { continue };
                prop_assert_eq!(cycle.is_stable(), stable);
                // Where the mass comes back to the belt along it, rounding decides when.
                prop_assume!(arrival(&of, &cycle) > 1e-4);
                returns(bounds, &of, &cycle, last)?;
            }
            // Beyond the end there is none.
            let beyond = end.map(|end| sign * (1.0 + 1e-9) * end);
            prop_assert!(beyond.is_none_or(|v| of.stick_slip(v).is_none()));
            Ok(())
        },
    );
}

/// From the largest displacement the mass swings to its mirror image and back, and turns nowhere
/// else.
#[test]
fn den_hartog() {
    let sizes = (
        or_zero(decades(1e-3, 0.7)),
        0.3..4.0,
        0.01..0.9,
        1.0..1.3,
        decades(0.1, 10.0),
    );
    check(
        sizes,
        |(damping, angular_frequency, friction, raise, force), bounds| {
            let kinetic_friction = friction * force;
            let oscillator = ForcedOscillator {
                damping,
                angular_frequency,
                kinetic_friction,
                static_friction: raise * kinetic_friction,
                force,
            };
            let motion = oscillator.without_stops();
            prop_assume!(motion.is_some());
            let motion = motion.unwrap();
            let (amplitude, period) = (motion.amplitude(), motion.period());
            let start = Place::new(&[amplitude], &[0.0]);
            let followed = forced(&oscillator, motion.phase())
                .simulate(start, 1.25 * period)
                .unwrap();
            let crosses = |kind| matches!(kind, EventKind::Crossing(_));
            let turns = followed.events();
            prop_assert_eq!(turns.len(), 2);
            prop_assert!(turns.iter().all(|event| crosses(event.kind)));
            // Near resonance the formula divides by small numbers.
            let [decay, turn] =
                [damping, f64::sqrt(1.0 - damping * damping)].map(|x| 0.5 * period * x);
            let size = (amplitude + force) * (1.0 + 1.0 / (decay.cosh() + turn.cos()));
            let pulled = force * motion.phase().cos() - amplitude + kinetic_friction;
            for (event, part) in turns.iter().zip([0.5, 1.0]) {
                let place = if part == 0.5 { -amplitude } else { amplitude };
                let late = event.time - part * period;
                bounds.hold("time", late, 64.0 * EPS * (period + size / pulled.abs()))?;
                bounds.hold(
                    "place",
                    event.state.displacements[0] - place,
                    64.0 * EPS * size,
                )?;
            }
            let moments = (0..=16).map(|k| f64::from(k) / 16.0 * period);
            for (time, state) in followed.sample_at(moments) {
                let (x, v) = motion.at(time);
                let error = (state.displacements[0] - x).hypot(state.velocities[0] - v);
                bounds.hold(
                    "motion",
                    error,
                    64.0 * EPS * size * (1.0 + angular_frequency),
                )?;
            }
            Ok(())
        },
    );
}

/// The motion without stops has a state at every time, within its own range.
#[test]
fn den_hartog_at_any_time() {
    for angular_frequency in [0.8, 0.5, 20.0] {
        let oscillator = ForcedOscillator {
            damping: 0.05,
            angular_frequency,
            kinetic_friction: 1e-6,
            static_friction: 1e-6,
            force: 1.0,
        };
        let motion = oscillator.without_stops().unwrap();
        let period = motion.period();
        for time in [1e10, 1e17, 1e154, 1e200, 1e308, f64::MAX] {
            // The remainder of a division of numbers is exact.
            let (x, v) = motion.at(time);
            assert_eq!((x, v), motion.at(time % period), "{time}");
            assert!(x.abs() <= motion.amplitude() * (1.0 + 1e-14), "{time}: {x}");
            let (back, _) = motion.at(-time);
            assert!(back.abs() <= motion.amplitude() * (1.0 + 1e-14), "{time}");
        }
        // Both ways from the largest displacement, k periods later.
        let same = |a: f64, b: f64| (a - b).abs() < 1e-12 * motion.amplitude();
        assert!(same(
            motion.at(-0.25 * period).0,
            motion.at(0.75 * period).0
        ));
        assert!(same(
            motion.at(0.125 * period).0,
            motion.at(1024.125 * period).0
        ));
    }
}

fn undamped(angular_frequency: f64, friction: f64) -> ForcedOscillator {
    ForcedOscillator {
        damping: 0.0,
        angular_frequency,
        kinetic_friction: friction,
        static_friction: friction,
        force: 1.0,
    }
}

/// Just above the limit the mass turns back in the middle of its way, for a moment.
#[test]
fn nearly_stopping() {
    let mut random = Random::new(91);
    // Near odd fractions of the natural frequency small friction is enough.
    let near = [3.0, 5.0, 7.0].map(|odd| (1.0 + 1e-5) / odd);
    let drawn = (0..count(3000, 30_000)).map(|_| random.uniform(0.1, 3.0));
    for omega in near.into_iter().chain(drawn) {
        if (omega - 1.0).abs() < 1e-3 {
            continue;
        }
        let limit = no_stop_limit(omega).unwrap();
        let exists = |friction| undamped(omega, friction).without_stops().is_some();
        let sides = [1.0 - 1e-9, 1.0 + 1e-9].map(|part| exists(part * limit));
        assert_eq!(sides, [true, false], "{omega}");
    }
}

/// With less friction than the limit the undamped mass settles to the motion without stops, with
/// more to one that stops.
#[test]
fn no_stop_limits() {
    check((0.4..3.0_f64, decades(0.01, 0.3)), |(omega, beside), _| {
        prop_assume!((omega - 1.0).abs() > 0.1);
        let limit = no_stop_limit(omega).unwrap();
        // With more than p it would not move at all.
        let rough = undamped(omega, limit + beside * (1.0 - limit));
        prop_assert!(rough.without_stops().is_none());
        let period = TAU / omega;
        let duration = 60.0 * period;
        let motion = forced(&rough, 0.0)
            .simulate(Place::at_rest(1), duration)
            .unwrap();
        let mut stops = motion
            .events()
            .iter()
            .filter(|event| event.kind == EventKind::Stick);
        let last = stops.next_back().map_or(0.0, |event| event.time);
        prop_assert!(last > duration - 1.5 * period, "{last} of {duration}");
        Ok(())
    });
}
