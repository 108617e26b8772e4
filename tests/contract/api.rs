//! What holds for the whole of the public interface: the common traits, text that pads, and results
//! that are the same whenever and wherever they are computed.

use std::fmt::{Debug, Display};
use std::hash::Hash;
use std::thread;

use stick_slip::analysis::averaging::AveragedCycle;
use stick_slip::analysis::jenkins::{Backbone, SymmetricResponse};
use stick_slip::analysis::{PureSlip, PureSlipCycle, Regime, StickSlip, StickSlipCycle, Transient};
use stick_slip::bifurcation::{self, Criticality, DiagramPoint};
use stick_slip::limit_cycle::{self, Attractor, Continuum};
use stick_slip::orbit::{BifurcationKind, LyapunovExponent, Orbit, Period};
use stick_slip::{
    AnyLaw, Backlash, Coulomb, CycleKind, CycleSet, Direction, Element, EnergyBudget, Equilibrium,
    Error, Event, EventKind, Exponential, FirstOrder, Flow, ForceElement, FrictionLaw, Integrator,
    Iwan4, LimitCycle, MassOnBelt, Mode, Pendulum, Physical, Polynomial, PolynomialSpring,
    Rational, Reached, Scalar, Scaled, Scaling, SnapThrough, Stability, State, Step, Stop,
    Stribeck, Tabulated, TabulatedForce, Trajectory, VanDerPol, structure,
};

#[test]
fn types_have_the_common_traits() {
    fn value<T: Clone + Debug + PartialEq + Send + Sync + Unpin + 'static>() {}
    fn small<T: Copy + Debug + PartialEq + Send + Sync + Unpin + 'static>() {}
    fn name<T: Copy + Debug + Eq + Hash + Send + Sync + Unpin + 'static>() {}
    fn shown<T: Display>() {}

    value::<Trajectory>();
    value::<LimitCycle>();
    value::<Orbit<State>>();
    value::<Orbit<structure::State>>();
    value::<CycleSet>();
    value::<DiagramPoint>();
    value::<Attractor>();
    value::<Error>();
    value::<Reached>();
    value::<AnyLaw>();
    value::<Tabulated>();
    value::<FirstOrder>();
    value::<ForceElement>();
    value::<Stop>();
    value::<PolynomialSpring>();
    value::<TabulatedForce>();
    value::<MassOnBelt<AnyLaw>>();
    value::<Scaled<AnyLaw>>();

    small::<Coulomb>();
    small::<Exponential>();
    small::<Polynomial>();
    small::<Rational>();
    small::<Stribeck>();
    small::<MassOnBelt<Polynomial>>();
    small::<Scaled<Polynomial>>();
    small::<Scaling>();
    small::<Physical>();
    small::<State>();
    small::<Equilibrium>();
    small::<Event>();
    small::<Step>();
    small::<Integrator>();
    small::<EnergyBudget<f64>>();
    small::<Continuum>();
    small::<PureSlip>();
    small::<PureSlipCycle>();
    small::<StickSlip>();
    small::<StickSlipCycle>();
    small::<Transient>();
    small::<LyapunovExponent>();
    small::<Period>();
    small::<AveragedCycle>();
    small::<Backbone>();
    small::<SymmetricResponse>();
    small::<Iwan4>();
    small::<Pendulum>();
    small::<Backlash>();
    small::<SnapThrough>();
    small::<VanDerPol>();

    name::<Direction>();
    name::<Mode>();
    name::<EventKind>();
    name::<Stability>();
    name::<CycleKind>();
    name::<Criticality>();
    name::<Regime>();

    shown::<Error>();
    shown::<Reached>();
    shown::<Event>();
    shown::<Attractor>();

    // A flow borrows its system, and may be moved to another thread.
    fn moved<T: Send + Clone + Debug>() {}
    moved::<Flow<'static, Polynomial>>();
    // An error travels in the boxes that are used for errors.
    fn boxed<T: Into<Box<dyn std::error::Error + Send + Sync>>>() {}
    boxed::<Error>();
}

fn paper(belt_velocity: f64) -> MassOnBelt<Polynomial> {
    MassOnBelt::new(Polynomial::new(0.4, 0.25, 0.5).unwrap(), belt_velocity)
        .and_then(|system| system.with_damping(0.05))
        .unwrap()
}

fn bistable() -> MassOnBelt<Exponential> {
    MassOnBelt::new(Exponential::new(0.6, 0.3, 0.4).unwrap(), 1.0)
        .and_then(|system| system.with_damping(0.01))
        .unwrap()
}

#[test]
fn names_are_padded() {
    fn pads(name: impl Display) {
        let name_alone = name.to_string();
        let width = name_alone.chars().count();
        assert!(width > 0 && width < 30);
        assert_eq!(
            format!("{name:>30}|"),
            format!("{}{name_alone}|", " ".repeat(30 - width))
        );
        assert_eq!(
            format!("{name:<30}|"),
            format!("{name_alone}{}|", " ".repeat(30 - width))
        );
        assert_eq!(format!("{name:-^30}|").chars().count(), 31);
    }
    pads(Direction::Leading);
    pads(Mode::Slip(Direction::Lagging));
    pads(EventKind::Release(Direction::Lagging));
    pads(EventKind::Stick);
    pads(Stability::UnstableFocus);
    pads(CycleKind::StickSlip);
    pads(Criticality::Supercritical);
    pads(BifurcationKind::NeimarkSacker);
    assert_eq!(BifurcationKind::Fold.to_string(), "fold");
    assert_eq!(format!("{:>12}", CycleKind::StickSlip), "  stick-slip");

    let system = bistable();
    let rest = system.equilibrium().unwrap().displacement;
    let of = |v: f64| limit_cycle::attractor(&system, State::new(rest, v)).unwrap();
    assert_eq!(of(0.3).to_string(), "steady sliding");
    assert_eq!(of(0.32).to_string(), "stick-slip");
    pads(of(0.3));
    pads(of(0.32));
    let unstable = limit_cycle::find(&system).unwrap();
    let unstable = unstable.iter().next().unwrap().clone();
    let separatrix = Attractor::Separatrix(unstable);
    assert_eq!(separatrix.to_string(), "separatrix (pure slip)");
    pads(separatrix);
    for (other, name) in [
        (Attractor::Rest, "rest"),
        (Attractor::Continuum, "continuum"),
        (Attractor::Unbounded, "unbounded"),
        (Attractor::Unresolved, "unresolved"),
    ] {
        assert_eq!(other.to_string(), name);
        pads(other);
    }
}

#[test]
fn events_modes_and_directions_are_shown() {
    let lagging = Direction::Lagging;
    assert_eq!(EventKind::Stick.to_string(), "stick");
    assert_eq!(EventKind::Release(lagging).to_string(), "release (lagging)");
    assert_eq!(
        EventKind::Crossing(Direction::Leading).to_string(),
        "crossing (leading)"
    );
    assert_eq!(Mode::Stick.to_string(), "stick");
    assert_eq!(Mode::Slip(lagging).to_string(), "slip (lagging)");
    let event = Event {
        time: 1.25,
        element: Element::Contact(0),
        kind: EventKind::Release(lagging),
        state: State::new(-0.5, 0.25),
    };
    let text = event.to_string();
    for part in ["1.25", "release (lagging)", "-0.5"] {
        assert!(text.contains(part), "{text}");
    }
}

/// Results of every part of the crate as text that tells every bit: Debug writes the shortest
/// digits that lead back to the same number.
fn everything() -> String {
    fn of<L: FrictionLaw>(system: &MassOnBelt<L>) -> String {
        let start = State::new(0.1, -0.3);
        let motion = system.simulate(start, 100.0).unwrap();
        let coarse = Integrator::new().with_tolerance(1e-6).unwrap();
        let coarse = coarse.simulate(system, start, 100.0).unwrap();
        let cycles = limit_cycle::find(system).unwrap();
        let numbers: Vec<_> = cycles
            .iter()
            .map(|cycle| (cycle.energy(), cycle.harmonics(3), cycle.amplitude()))
            .collect();
        let states = |motion: &Trajectory| -> Vec<_> { motion.sample(100).collect() };
        let turns: Vec<_> = cycles.iter().map(|it| states(&it.trajectory())).collect();
        format!(
            "{:?} {:?} {:?} {:?} {turns:?} {cycles:?} {numbers:?} {:?} {:?} {:?} {:?} {:?}",
            states(&motion),
            motion.events(),
            states(&coarse),
            coarse.events(),
            limit_cycle::attractor(system, start).unwrap(),
            bifurcation::hopf_velocities(system, 0.0..2.0).unwrap(),
            bifurcation::grazing_velocities(system, 0.1..2.0).unwrap(),
            bifurcation::silencing_damping(system).unwrap(),
            system.equilibrium(),
        )
    }
    let table = [
        (0.0, 0.4),
        (0.1, 0.33),
        (0.3, 0.27),
        (0.6, 0.25),
        (1.0, 0.26),
    ];
    let table = MassOnBelt::new(Tabulated::new(table).unwrap(), -0.2)
        .and_then(|system| system.with_damping(0.02))
        .unwrap();
    format!("{} {} {}", of(&paper(0.2)), of(&bistable()), of(&table))
}

#[test]
fn the_same_bits_again_and_in_threads() {
    let first = everything();
    assert!(first.len() > 10_000);
    assert!(first == everything(), "a second time");
    let threads: Vec<_> = (0..2).map(|_| thread::spawn(everything)).collect();
    for thread in threads {
        assert!(first == thread.join().unwrap(), "in a thread");
    }
}

#[cfg(feature = "rayon")]
#[test]
fn the_same_bits_on_all_cores() {
    let velocities: Vec<f64> = (0..200).map(|i| -0.3 + 0.01 * f64::from(i)).collect();
    let text = |points: &[Result<DiagramPoint, Error>]| format!("{points:?}");
    for _ in 0..2 {
        let alone: Vec<_> = bifurcation::diagram(&bistable(), &velocities).collect();
        let shared = bifurcation::par_diagram(&bistable(), &velocities);
        assert!(alone == shared && text(&alone) == text(&shared));
    }
    // An error stays in its place.
    let with_bad = [0.2, f64::NAN, 0.3];
    let shared = bifurcation::par_diagram(&paper(0.2), &with_bad);
    assert!(shared[0].is_ok() && shared[1].is_err() && shared[2].is_ok());
}

/// h1 = 2β + γ² dμ̂/ds(v_b), at and beside the values at which the kind of the equilibrium changes.
#[test]
fn the_kind_of_an_equilibrium_changes_where_h1_is_two_and_zero() {
    struct Linear(f64);
    impl FrictionLaw for Linear {
        fn static_coefficient(&self) -> f64 {
            1.0
        }
        fn kinetic<S: Scalar>(&self, speed: S) -> S {
            speed * self.0 + 1.0
        }
    }
    for (h1, kind) in [
        (2.0_f64.next_up(), Stability::StableNode),
        (2.0, Stability::StableNode),
        (2.0_f64.next_down(), Stability::StableFocus),
        (f64::MIN_POSITIVE, Stability::StableFocus),
        (0.0, Stability::Center),
        (-f64::MIN_POSITIVE, Stability::UnstableFocus),
        (-2.0_f64.next_down(), Stability::UnstableFocus),
        (-2.0, Stability::UnstableNode),
        (-2.0_f64.next_up(), Stability::UnstableNode),
    ] {
        let system = MassOnBelt::new(Linear(h1), 0.1).unwrap();
        let equilibrium = system.equilibrium().unwrap();
        assert_eq!(equilibrium.stability, kind, "{h1:e}");
        assert_eq!(equilibrium.is_stable(), h1 > 0.0);
    }
}

#[test]
fn laws_give_back_what_they_were_given() {
    let rational = Rational::new(0.4, 3.0)
        .and_then(|law| law.with_offset(0.1))
        .and_then(|law| law.with_quadratic(0.02))
        .unwrap();
    assert_eq!(
        (rational.static_coefficient(), rational.decay()),
        (0.4, 3.0)
    );
    assert_eq!((rational.offset(), rational.quadratic()), (0.1, 0.02));
    let stribeck = Stribeck::new(0.4, 0.25, 0.3, 2)
        .and_then(|law| law.with_viscous_coefficient(0.01))
        .unwrap();
    assert_eq!(
        (
            stribeck.static_coefficient(),
            stribeck.coulomb_coefficient()
        ),
        (0.4, 0.25)
    );
    assert_eq!(
        (stribeck.stribeck_velocity(), stribeck.exponent()),
        (0.3, 2)
    );
    assert_eq!(stribeck.viscous_coefficient(), 0.01);
    assert_eq!(Integrator::default(), Integrator::new());
    let system = MassOnBelt::new(stribeck, 0.2).unwrap();
    assert_eq!((system.damping(), system.load()), (0.0, 1.0));
}

#[test]
fn a_belt_at_rest_neither_releases_nor_slides() {
    let system = paper(0.0);
    assert_eq!((system.equilibrium(), system.release_state()), (None, None));
}

#[test]
fn attractors_of_starts_that_are_no_numbers_are_errors() {
    let system = paper(0.2);
    for start in [State::new(f64::NAN, 0.1), State::new(0.1, f64::INFINITY)] {
        let error = limit_cycle::attractor(&system, start).unwrap_err();
        assert!(matches!(error, Error::InvalidState { .. }), "{error}");
    }
}
