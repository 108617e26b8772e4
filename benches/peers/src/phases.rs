//! What a user of a general integrator has to write around it: the equation of motion, stick, and
//! the change of phases.

use stick_slip::{FrictionLaw, MassOnBelt, State};

use crate::set::{DURATION, Set};

/// Slip behind the belt in u and w = v − v_b < 0: the root of w is the contact, without
/// cancellation.
#[derive(Clone, Copy)]
pub struct Slip<L> {
    pub law: L,
    pub belt_velocity: f64,
    pub damping: f64,
    pub load: f64,
}

impl<L: FrictionLaw + Copy> Slip<L> {
    pub fn new(set: &Set<MassOnBelt<L>>) -> Self {
        Self {
            law: *set.system.law(),
            belt_velocity: set.system.belt_velocity(),
            damping: set.system.damping(),
            load: set.system.load(),
        }
    }

    /// du/dτ and dw/dτ.
    #[inline]
    pub fn derivative(&self, displacement: f64, relative_velocity: f64) -> [f64; 2] {
        let velocity = relative_velocity + self.belt_velocity;
        let friction = self.load * self.law.kinetic(-relative_velocity);
        let acceleration = friction - displacement - 2.0 * self.damping * velocity;
        [velocity, acceleration]
    }
}

/// End of a slip phase, its time from the phase's start.
pub struct Contact {
    pub time: f64,
    pub displacement: f64,
}

/// The time, with its rounding error carried along. Each phase starts at time 0 and its duration is
/// added here, so that the clock costs no solver accuracy.
#[derive(Default)]
pub struct Clock {
    time: f64,
    carry: f64,
}

impl Clock {
    /// Writes down the event that comes after so long, and tells whether it is within the duration.
    pub fn note(&mut self, after: f64, events: &mut Vec<f64>) -> bool {
        let term = after - self.carry;
        let sum = self.time + term;
        self.carry = (sum - self.time) - term;
        self.time = sum;
        let within = sum < DURATION;
        if within {
            events.push(sum);
        }
        within
    }
}

/// Runs the motion and writes down its events; `contact` integrates one slip phase from u and w.
pub fn run<L: FrictionLaw>(
    set: &Set<MassOnBelt<L>>,
    events: &mut Vec<f64>,
    mut contact: impl FnMut(f64, f64) -> Contact,
) {
    let system = &set.system;
    let belt_velocity = system.belt_velocity();
    let release = system.release_state().expect("the belt moves").displacement;
    let State {
        displacement: mut start,
        velocity,
    } = set.start;
    let mut relative_velocity = velocity - belt_velocity;
    let mut clock = Clock::default();
    loop {
        let Contact { time, displacement } = contact(start, relative_velocity);
        let force = displacement + 2.0 * system.damping() * belt_velocity;
        assert!(
            force.abs() < system.load() * system.law().static_coefficient(),
            "the sets stick at each contact"
        );
        let stick = (release - displacement) / belt_velocity;
        if !(clock.note(time, events) && clock.note(stick, events)) {
            break;
        }
        (start, relative_velocity) = (release, 0.0);
    }
}
