//! What a user of a general integrator has to write around it: the equation of motion, stick, and
//! the change of phases.

use stick_slip::{FrictionLaw, State};

use crate::set::{DURATION, REST, Set};

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
    pub fn new(set: &Set<L>) -> Self {
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

/// Runs the motion from rest and writes down its events; `contact` integrates one slip phase from u
/// and w.
///
/// Each phase starts at time 0 and its duration is added with the rounding error carried along, so
/// that the clock costs no solver accuracy.
pub fn run<L: FrictionLaw>(
    set: &Set<L>,
    events: &mut Vec<f64>,
    mut contact: impl FnMut(f64, f64) -> Contact,
) {
    let system = &set.system;
    let belt_velocity = system.belt_velocity();
    let release = system.release_state().expect("the belt moves").displacement;
    let State {
        displacement: mut start,
        velocity,
    } = REST;
    let mut relative_velocity = velocity - belt_velocity;
    let (mut time, mut carry) = (0.0, 0.0);
    // Whether the event is within the duration.
    let mut note = |duration: f64| {
        let term = duration - carry;
        let sum = time + term;
        carry = (sum - time) - term;
        time = sum;
        if time < DURATION {
            events.push(time);
        }
        time < DURATION
    };
    loop {
        let Contact { time, displacement } = contact(start, relative_velocity);
        let force = displacement + 2.0 * system.damping() * belt_velocity;
        assert!(
            force.abs() < system.load() * system.law().static_coefficient(),
            "the sets stick at each contact"
        );
        if !(note(time) && note((release - displacement) / belt_velocity)) {
            break;
        }
        (start, relative_velocity) = (release, 0.0);
    }
}
