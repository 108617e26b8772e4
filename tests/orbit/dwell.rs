//! Cycles with static friction that rises at rest, over belt velocities up to where they die.

use stick_slip::analysis::dwell::{DwellOscillator, ExactCycle};
use stick_slip::orbit::{BranchEnd, Orbit, Period, follow, settle, shoot};
use stick_slip::structure::State;
use stick_slip::{
    AnyLaw, Contact, Coulomb, Drive, Dwell, Error, EventKind, Exponential, FrictionLaw, MassOnBelt,
    Polynomial, Structure, bifurcation,
};

use crate::common::{apart, larger, one_mass};

/// m = k = N = 1.
fn block<L>(law: &Dwell<L>, damper: f64, velocity: f64) -> Structure
where
    L: FrictionLaw + Clone + Send + Sync + 'static,
{
    let contact = Contact::new(0, law.clone(), 1.0).unwrap();
    one_mass([1.0, damper, 1.0], 0.0, contact.on_belt(velocity)).unwrap()
}

/// A state in the middle of the slip phase, a little beside the cycle.
fn in_slip(system: &Structure, contact: f64, cycle: &ExactCycle) -> State {
    let start = State::new(&[contact], &[cycle.belt_velocity]);
    let time = cycle.stick_duration + 0.5 * cycle.slip_duration;
    let mut state = system.simulate(start, time).unwrap().last();
    state.displacements[0] += 1e-6;
    state
}

/// Where the motion slips, some time before the contact: nothing happens at the seam.
fn late_in_slip(orbit: &Orbit<State>) -> State {
    let mut events = orbit.events().iter();
    let stick = events.find(|event| event.kind == EventKind::Stick).unwrap();
    let time = stick.time - 1.5;
    let time = if time < 0.0 {
        time + orbit.period()
    } else {
        time
    };
    orbit.trajectory().state_at(time).unwrap()
}

/// The place of the contact, from where a motion is caught and sticks.
fn caught(orbit: &Orbit<State>) -> f64 {
    let mut events = orbit.events().iter();
    let stick = events.find(|event| event.kind == EventKind::Stick);
    stick.unwrap().state.displacements[0]
}

fn forms() -> [Dwell<Coulomb>; 3] {
    let law = |jump: f64| Coulomb::new(0.3 + jump, 0.3).unwrap();
    [
        Dwell::exponential(law(0.0), 0.6, 2.0).unwrap(),
        Dwell::hyperbolic(law(0.05), 0.6, 1.5).unwrap(),
        Dwell::logarithmic(law(0.0), 0.05, 0.4).unwrap(),
    ]
}

/// Both cycles, found by shooting from a little beside, against the closed forms.
#[test]
fn cycles_have_their_closed_forms_up_to_the_fold() {
    let mut worst = 0.0_f64;
    for law in forms() {
        for damping in [0.02, 0.05, 0.2] {
            let formula = DwellOscillator {
                law,
                mass: 1.0,
                stiffness: 1.0,
                damping,
                load: 1.0,
            };
            let fold = formula.fold().unwrap().belt_velocity;
            for part in [0.1, 0.3, 0.5, 0.7, 0.9, 0.99, 0.999] {
                let v = part * fold;
                let cycles = [formula.stick_slip(v), formula.unstable_stick_slip(v)];
                // A start 1e-6 beside a cycle so unstable misses the belt.
                let cycles = cycles.into_iter().flatten();
                for cycle in cycles.filter(|cycle| cycle.multiplier.abs() < 30.0) {
                    let system = block(&law, damping, v);
                    let guess = in_slip(&system, cycle.contact_displacement, &cycle);
                    let period = Period::Free(cycle.period() + 1e-6);
                    let orbit = shoot(&system, &guess, period);
                    let orbit = orbit.unwrap_or_else(|error| panic!("{part}: {error} {cycle:?}"));
                    // Near the fold a cycle is as ill-conditioned as its multiplier is near 1.
                    let condition = (1.0 - cycle.multiplier).abs().min(1.0);
                    let multiplier = orbit.multipliers()[0];
                    assert!(multiplier.im == 0.0 && multiplier.re != 0.0);
                    for (what, actual, expected) in [
                        ("period", orbit.period(), cycle.period()),
                        ("place", caught(&orbit), cycle.contact_displacement),
                        ("multiplier", multiplier.re, cycle.multiplier),
                    ] {
                        let scale = if what == "multiplier" {
                            expected.abs().max(1.0) / condition
                        } else {
                            expected.abs().max(1.0)
                        };
                        let error = (actual - expected).abs() / scale * condition;
                        assert!(error < 1e-12, "{what} at {part}: {actual:e} {expected:e}");
                        worst = larger(worst, error);
                    }
                    assert_eq!(orbit.is_stable(), cycle.is_stable());
                }
            }
            // Beyond it there is none near.
            let beyond = 1.001 * fold;
            let near = formula.fold().unwrap();
            let system = block(&law, damping, fold);
            let guess = in_slip(&system, near.contact_displacement, &near);
            let found = shoot(
                &block(&law, damping, beyond),
                &guess,
                Period::Free(near.period()),
            );
            let missed = match found {
                Err(Error::NotPeriodic { .. } | Error::AtRest) => true,
                Ok(orbit) => !orbit
                    .events()
                    .iter()
                    .any(|event| event.kind == EventKind::Stick),
                Err(_) => false,
            };
            assert!(missed);
        }
    }
    println!("worst {worst:.1e}");
}

/// Where kinetic friction falls with speed there is no fold: mass and belt stick ever shorter, and
/// the last cycle with stick touches the belt. There the time stuck is 0, and static friction has
/// not risen: so that is the grazing velocity of the law without a memory.
#[test]
fn with_falling_friction_cycles_end_where_they_touch_the_belt() {
    let polynomial: AnyLaw = Polynomial::new(0.4, 0.25, 0.5).unwrap().into();
    let exponential: AnyLaw = Exponential::new(0.5, 0.35, 0.2).unwrap().into();
    let cases = [
        (Dwell::exponential(polynomial, 0.7, 3.0).unwrap(), 0.1),
        (
            Dwell::hyperbolic(exponential.clone(), 0.9, 5.0).unwrap(),
            0.06,
        ),
        (Dwell::logarithmic(exponential, 0.05, 0.5).unwrap(), 0.04),
    ];
    for (law, damper) in cases {
        let at = |v: f64, guess: &State, period: f64| {
            shoot(&block(&law, damper, v), guess, Period::Free(period)).ok()
        };
        // From a slow belt on, with steps that are halved where the next cycle is not found.
        let mut v = 0.05;
        let system = block(&law, damper, v);
        let motion = system.simulate(State::new(&[0.5], &[v]), 300.0).unwrap();
        let mut sticks = motion.events().iter().rev();
        let mut last_stick = || sticks.find(|event| event.kind == EventKind::Stick).unwrap();
        let (stick, earlier) = (last_stick(), last_stick());
        let period = stick.time - earlier.time;
        let guess = motion.state_at(stick.time - 1.5).unwrap();
        let mut orbit = at(v, &guess, period).unwrap();
        let mut step = 0.05;
        let mut found = 0;
        while step > 1e-9 {
            let next = at(v + step, &late_in_slip(&orbit), orbit.period());
            let next = next.filter(|next| {
                let multiplier = next.multipliers()[0];
                let sticks = next
                    .events()
                    .iter()
                    .any(|event| event.kind == EventKind::Stick);
                sticks && next.is_stable() && multiplier.re != 0.0 && multiplier.im == 0.0
            });
            match next {
                Some(next) => {
                    (v, orbit) = (v + step, next);
                    found += 1;
                }
                None => step *= 0.5,
            }
        }
        let multiplier = orbit.multipliers()[0].re;
        let stuck = orbit.events().iter().map(|event| event.state.memory[0]);
        let stuck = stuck.fold(0.0, f64::max);
        println!("{found} cycles up to v_b = {v:.9}, multiplier {multiplier:.6}, stuck {stuck:.4}");
        assert!(found > 10);
        assert!(stuck < 1e-3 && multiplier != 0.0, "{stuck} {multiplier}");
        let belt = MassOnBelt::new(law.law(), v).and_then(|belt| belt.with_damping(0.5 * damper));
        let grazing = bifurcation::grazing_velocities(&belt.unwrap(), 0.05..2.0).unwrap();
        let near = grazing.iter().any(|grazing| (grazing - v).abs() < 1e-7);
        assert!(near, "{v} {grazing:?}");
        let sticks = |v: f64| {
            let start = State::new(&[caught(&orbit) - 0.02], &[v]);
            let motion = block(&law, damper, v).simulate(start, 3000.0).unwrap();
            let last = motion.events().last().unwrap();
            last.time > 2900.0
        };
        assert!(sticks(0.995 * v) && !sticks(1.005 * v));
    }
}

/// A mass on a belt under a harmonic force, begun at a phase of it.
fn forced(amplitude: f64, phase: f64) -> Result<Structure, Error> {
    let law = Dwell::exponential(Coulomb::new(0.4, 0.3)?, 0.6, 1.5)?;
    let force = Drive::harmonic(amplitude, 0.6, phase)?;
    let contact = Contact::new(0, law, 1.0)?.on_belt(0.1);
    one_mass([1.0, 0.1, 1.0], force, contact)
}

fn sticks(orbit: &Orbit<State>) -> bool {
    let mut events = orbit.events().iter();
    events.any(|event| event.kind == EventKind::Stick)
}

/// As stick or release passes the start of the period, the time in stick jumps there; the motion is
/// the same.
#[test]
fn the_phase_at_which_a_period_begins_does_not_matter() {
    let start = State::new(&[0.1], &[0.0]).with_memory(&[0.0]);
    let family = |phase: f64| forced(0.6, phase);
    let orbit = settle(&family(0.0).unwrap(), &start, 300.0, Period::Driven(1)).unwrap();
    assert!(sticks(&orbit));
    let branch = follow(family, 0.0, &orbit, -3.2..3.2).unwrap();
    assert_eq!(branch.ends, [BranchEnd::Range, BranchEnd::Range]);
    assert!(branch.bifurcations.is_empty(), "{:?}", branch.bifurcations);
    for point in &branch.points {
        let pairs = orbit.multipliers().iter().zip(point.orbit.multipliers());
        for (here, there) in pairs {
            // Both are as exact as the closure of the motion, some 1e-13, times its magnification.
            assert!((here - there).norm() < 1e-10, "{here} {there}");
        }
        assert_eq!(point.orbit.events().len(), orbit.events().len());
    }
}

/// A motion that always slips does not know how long it has stuck, whatever the start says; then it
/// begins to stick.
#[test]
fn a_branch_enters_stick_from_a_motion_that_only_slips() {
    for rest in [0.0, 1e-30, 0.3, 1e9] {
        let start = State::new(&[0.1], &[0.0]).with_memory(&[0.0]);
        let family = |amplitude: f64| forced(amplitude, 1.0);
        let slips = settle(&family(1.5).unwrap(), &start, 300.0, Period::Driven(1)).unwrap();
        assert!(!sticks(&slips));
        let guess = slips.state().with_memory(&[rest]);
        let slips = shoot(&family(1.5).unwrap(), &guess, Period::Driven(1)).unwrap();
        let branch = follow(family, 1.5, &slips, 0.6..1.6).unwrap();
        assert_eq!(branch.ends, [BranchEnd::Range, BranchEnd::Range], "{rest}");
        let count = branch
            .points
            .iter()
            .filter(|point| sticks(&point.orbit))
            .count();
        assert!(
            count > 10 && count < branch.points.len() - 5,
            "{rest}: {count}"
        );
    }
}

/// A motion that always slips has the time in stick 0, whatever the guess has.
#[test]
fn a_motion_that_only_slips_has_not_stuck() -> Result<(), Error> {
    let falling = Exponential::new(0.6, 0.3, 0.4)?;
    let system = block(&Dwell::exponential(falling, 0.9, 2.0)?, 0.02, 1.0);
    for rest in [0.0, 1e-30, -0.3, 5.0, 1e9] {
        let guess = State::new(&[0.3], &[0.6]).with_memory(&[rest]);
        let orbit = shoot(&system, &guess, Period::Free(6.3))?;
        assert!(!sticks(&orbit));
        assert_eq!(orbit.state().memory, [0.0]);
        assert_eq!(orbit.trajectory().last().memory, [0.0]);
        assert!((orbit.multipliers()[0].re - 1.0981305946699447).abs() < 1e-12);
    }
    Ok(())
}

/// A block that never slips, whose limit grows with its time of rest for ever, beside one that
/// does: the clock is not part of the motion.
#[test]
fn the_clock_of_a_block_at_rest_runs_on() {
    let frequency = 0.4046846911102611;
    let rests = Dwell::hyperbolic(Coulomb::new(0.34, 0.34).unwrap(), 0.61, 0.52).unwrap();
    let slips = Dwell::exponential(Coulomb::new(0.66, 0.51).unwrap(), 0.87, 0.31).unwrap();
    let structure = Structure::new(&[1.0, 1.0])
        .and_then(|s| s.with_ground_spring(0, 1.1)?.with_ground_spring(1, 1.7))
        .and_then(|s| s.with_spring(0, 1, 0.3)?.with_ground_damper(1, 0.08))
        .and_then(|s| s.with_force(1, Drive::sine(0.5, frequency)?))
        .and_then(|s| s.with_contact(Contact::new(0, rests, 0.33)?))
        .and_then(|s| s.with_contact(Contact::new(1, slips, 0.25)?))
        .unwrap();
    let start = State::at_rest(2);
    let orbit = settle(&structure, &start, 300.0, Period::Driven(1)).unwrap();
    assert_eq!(orbit.unslipped(), [0]);
    assert!(orbit.is_stable());
    // One period later the clock alone has moved on.
    let mut state = orbit.state();
    let motion = structure.simulate(state.clone(), orbit.period()).unwrap();
    state.memory[0] += orbit.period();
    assert!(apart(&motion.last(), &state) <= 1e-10);
}
