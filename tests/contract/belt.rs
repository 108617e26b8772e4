//! The public contract: every name with its full signature used once, so that an accidental change
//! does not compile.
//!
//! Functions are assigned to typed function pointers, public fields are named in patterns without
//! `..`, and enums that users match are matched without a wildcard.

use std::fmt::{Debug, Display};
use std::ops::{Add, Div, Mul, Neg, Sub};

use stick_slip::nalgebra::{Complex, Matrix2};
use stick_slip::{
    Coulomb, Direction, Equilibrium, Error, Event, EventKind, Exponential, Flow, FrictionLaw,
    Integrator, MassOnBelt, Mode, Polynomial, Scalar, Stability, State, Step, Trajectory,
};

fn value<T: Clone + Debug + PartialEq + Send + Sync + 'static>() {}
fn small<T: Copy + Clone + Debug + PartialEq + Send + Sync + 'static>() {}
fn shown<T: Display>() {}

#[test]
fn types_have_the_common_traits() {
    small::<Polynomial>();
    small::<Exponential>();
    small::<Coulomb>();
    small::<MassOnBelt<Polynomial>>();
    small::<State>();
    small::<Equilibrium>();
    small::<Stability>();
    small::<Direction>();
    small::<Mode>();
    small::<EventKind>();
    small::<Event>();
    small::<Integrator>();
    small::<Step>();
    value::<Trajectory>();
    value::<Error>();
    shown::<Error>();
    shown::<Event>();
    shown::<EventKind>();
    shown::<Mode>();
    shown::<Direction>();
    shown::<Stability>();
    fn error<T: std::error::Error>() {}
    error::<Error>();
    fn default<T: Default>() {}
    default::<Integrator>();
    // A law that is not Clone or Copy does not make its system unusable.
    struct Bare;
    impl FrictionLaw for Bare {
        fn static_coefficient(&self) -> f64 {
            1.0
        }
        fn kinetic<S: Scalar>(&self, speed: S) -> S {
            speed.constant(1.0)
        }
    }
    let system: MassOnBelt<Bare> = MassOnBelt::new(Bare, 1.0).unwrap();
    let _: Trajectory = system.simulate(State::new(0.0, 0.0), 1.0).unwrap();
}

#[test]
fn scalar_has_every_operation() {
    fn operators<S>(x: S, c: f64) -> S
    where
        S: Scalar
            + Copy
            + Neg<Output = S>
            + Add<Output = S>
            + Sub<Output = S>
            + Mul<Output = S>
            + Div<Output = S>
            + Add<f64, Output = S>
            + Sub<f64, Output = S>
            + Mul<f64, Output = S>
            + Div<f64, Output = S>,
    {
        ((-x + x - x * x) / x + c - c) * c / c
    }
    // The bounds above follow from Scalar alone.
    fn implied<S: Scalar>(x: S) -> S {
        operators(x, 2.0)
    }
    fn functions<S: Scalar>() {
        let _: fn(S) -> f64 = S::value;
        let _: fn(S, f64) -> S = S::constant;
        let _: [fn(S) -> S; 11] = [
            S::recip,
            S::square,
            S::exp,
            S::ln,
            S::sqrt,
            S::tanh,
            S::atan,
            S::sin,
            S::cos,
            S::abs,
            implied,
        ];
        let _: fn(S, i32) -> S = S::powi;
        let _: fn(S, f64) -> S = S::powf;
    }
    functions::<f64>();
    assert_eq!(implied(0.5_f64), -0.5);
}

/// A law as users write it: all four functions, in their full signatures.
#[derive(Debug)]
struct Kinked {
    kink: f64,
}

impl FrictionLaw for Kinked {
    fn static_coefficient(&self) -> f64 {
        0.5
    }
    fn kinetic<S: Scalar>(&self, speed: S) -> S {
        self.kinetic_on(usize::from(speed.value() >= self.kink), speed)
    }
    fn breakpoints(&self) -> impl Iterator<Item = f64> {
        std::iter::once(self.kink)
    }
    fn kinetic_on<S: Scalar>(&self, piece: usize, speed: S) -> S {
        match piece {
            0 => -speed * 0.1 + 0.5,
            _ => speed.constant(0.5 - 0.1 * self.kink),
        }
    }
}

#[test]
fn laws_have_the_trait() {
    fn provided<L: FrictionLaw>(law: &L) -> f64 {
        let _: fn(&L) -> f64 = L::static_coefficient;
        let _: fn(&L, f64) -> f64 = L::kinetic::<f64>;
        let _: fn(&L, usize, f64) -> f64 = L::kinetic_on::<f64>;
        let _: fn(&L, f64) -> f64 = L::coefficient;
        let _: fn(&L, f64) -> f64 = L::slope;
        let _: fn(&L, f64) -> f64 = L::curvature;
        let _: fn(&L, usize, f64) -> f64 = L::derivative;
        fn items(iterator: impl Iterator<Item = f64>) -> usize {
            iterator.count()
        }
        let _: usize = items(law.breakpoints());
        law.coefficient(-1.0)
    }
    fn law<L: FrictionLaw>() {}
    law::<Polynomial>();
    law::<Exponential>();
    law::<Coulomb>();
    law::<&Kinked>();
    law::<&&Polynomial>();
    let kinked = Kinked { kink: 0.25 };
    assert_eq!(provided(&kinked), -0.475);
    assert_eq!(provided(&&kinked), -0.475);
    assert_eq!(Coulomb::new(0.5, 0.25).unwrap().breakpoints().count(), 0);

    let _: fn(f64, f64, f64) -> Result<Polynomial, Error> = Polynomial::new;
    let _: fn(f64, f64, f64) -> Result<Exponential, Error> = Exponential::new;
    let _: fn(f64, f64) -> Result<Coulomb, Error> = Coulomb::new;
}

#[test]
fn mass_on_belt_has_its_functions() {
    type System = MassOnBelt<Polynomial>;
    let _: fn(Polynomial, f64) -> Result<System, Error> = System::new;
    let _: fn(System, f64) -> Result<System, Error> = System::with_damping;
    let _: fn(System, f64) -> Result<System, Error> = System::with_load;
    let _: fn(System, f64) -> Result<System, Error> = System::with_belt_velocity;
    let _: fn(&System) -> &Polynomial = System::law;
    let _: [fn(&System) -> f64; 3] = [System::belt_velocity, System::damping, System::load];
    let _: fn(&System) -> Option<State> = System::release_state;
    let _: fn(&System) -> Option<Equilibrium> = System::equilibrium;
    let _: [fn(&System, State) -> f64; 2] = [System::friction_force, System::acceleration];
    let _: fn(&System, State, f64) -> Result<Trajectory, Error> = System::simulate;

    let _: fn(f64, f64) -> State = State::new;
    let State {
        displacement,
        velocity,
    } = State {
        displacement: 1.0,
        velocity: 2.0,
    };
    assert_eq!(State::new(displacement, velocity), State::new(1.0, 2.0));

    // β = 0 and γ² = 1 unless set.
    let system = System::new(Polynomial::new(0.4, 0.25, 0.5).unwrap(), 0.2).unwrap();
    assert_eq!((system.damping(), system.load()), (0.0, 1.0));
    let Equilibrium {
        displacement,
        jacobian,
        eigenvalues,
        stability,
    } = system.equilibrium().unwrap();
    let _: (f64, Matrix2<f64>, [Complex<f64>; 2]) = (displacement, jacobian, eigenvalues);
    match stability {
        Stability::StableFocus
        | Stability::StableNode
        | Stability::Center
        | Stability::UnstableFocus
        | Stability::UnstableNode => (),
    }
    let _: fn(&Equilibrium) -> bool = Equilibrium::is_stable;
    assert_eq!(system.with_belt_velocity(0.0).unwrap().equilibrium(), None);
    assert_eq!(
        system.with_belt_velocity(0.0).unwrap().release_state(),
        None
    );
}

#[test]
fn integrator_has_its_functions() {
    type System = MassOnBelt<Coulomb>;
    let _: fn() -> Integrator = Integrator::new;
    let _: fn(Integrator, f64) -> Result<Integrator, Error> = Integrator::with_tolerance;
    let _: fn(Integrator, usize) -> Result<Integrator, Error> = Integrator::with_max_steps;
    let _: fn(Integrator, usize) -> Result<Integrator, Error> = Integrator::with_max_events;
    let _: fn(Integrator, &System, State, f64) -> Result<Trajectory, Error> = Integrator::simulate;
    fn flow<'s>(
        integrator: Integrator,
        system: &'s System,
        start: State,
    ) -> Result<Flow<'s, Coulomb>, Error> {
        integrator.flow(system, start)
    }
    fn steps<I: Iterator<Item = Result<Step, Error>>>(_: &I) {}

    let system = System::new(Coulomb::new(0.5, 0.25).unwrap(), 0.5).unwrap();
    let mut flow = flow(Integrator::new(), &system, State::new(0.0, 0.5)).unwrap();
    steps(&flow);
    let step: Step = flow.next().unwrap().unwrap();
    // A value on its own, which outlives the flow.
    drop(flow);
    let _: [fn(&Step) -> f64; 3] = [Step::start_time, Step::end_time, Step::duration];
    let _: fn(&Step) -> Mode = Step::mode;
    let _: fn(&Step) -> State = Step::state;
    let _: fn(&Step, f64) -> State = Step::state_at;
    let _: fn(&Step) -> Option<Event> = Step::event;
    assert_eq!(step.state_at(0.5), State::new(0.25, 0.5));
}

#[test]
fn trajectory_and_events_have_their_parts() {
    let _: fn(&Trajectory) -> &[Event] = Trajectory::events;
    let _: fn(&Trajectory) -> &[Step] = Trajectory::steps;
    let _: fn(&Trajectory, f64) -> Option<State> = Trajectory::state_at;
    let _: fn(&Trajectory, f64) -> Option<Mode> = <Trajectory>::mode_at;
    let _: fn(&Trajectory) -> State = Trajectory::last;
    let _: fn(&Trajectory) -> f64 = Trajectory::duration;
    fn sample(trajectory: &Trajectory, n: usize) -> impl Iterator<Item = (f64, State)> {
        trajectory.sample(n)
    }

    let system = MassOnBelt::new(Coulomb::new(0.5, 0.25).unwrap(), 0.5).unwrap();
    let motion = system.simulate(State::new(0.0, 0.5), 2.0).unwrap();
    let times: Vec<f64> = sample(&motion, 3).map(|(time, _)| time).collect();
    assert_eq!(times, [0.0, 1.0, 2.0]);
    let Event {
        time,
        contact,
        kind,
        state,
    } = motion.events()[0];
    assert_eq!((time, contact, state), (1.0, 0, State::new(0.5, 0.5)));
    let direction = match kind {
        EventKind::Release(direction) | EventKind::Crossing(direction) => direction,
        other => panic!("{other}: the mass starts in stick"),
    };
    let _: Direction = match motion.mode_at(2.0).unwrap() {
        Mode::Slip(direction) => direction,
        other => panic!("{other}: the mass slides after its release"),
    };
    // The sign of v_r after the event.
    assert_eq!(
        match direction {
            Direction::Lagging => -1,
            Direction::Leading => 1,
        },
        -1
    );
    let _: fn(EventKind) -> Mode = EventKind::mode;
    let _: fn(Direction) -> f64 = Direction::sign;
    let _: fn(Direction) -> Direction = Direction::opposite;
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
        contact: 0,
        kind: EventKind::Release(lagging),
        state: State::new(-0.5, 0.25),
    };
    let text = event.to_string();
    for part in ["1.25", "release (lagging)", "-0.5"] {
        assert!(text.contains(part), "{text}");
    }
}

// `limit_cycle`, `bifurcation` and `analysis`: tests/contract/cycles.rs.
