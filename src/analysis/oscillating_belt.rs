//! Oscillating belts replaced by forces: the same motion, seen from a frame that oscillates with
//! the belts.

use crate::drive::Drive;
use crate::state::structure::State;
use crate::structure::Structure;

/// A structure whose belts all oscillate together, rewritten as one on steady belts with additional
/// forces.
///
/// ```text
/// w_i(t) = w̄_i + W'(t),   q = y + W(t)·1
/// ```
///
/// W' is the common oscillation of the belt velocities, and 1 a vector of ones. y obeys the
/// equations with the steady belt velocities w̄_i, the additional forces −(M 1 W'' + C 1 W' + K 1
/// W), and the additional loads Σ_j n_ij W. Relative velocities are the same, and so are stick,
/// slip and all events. Exact, for any number of coordinates.
///
/// ```
/// use stick_slip::analysis::oscillating_belt::OnSteadyBelts;
/// use stick_slip::{Contact, Coulomb, Drive, Structure, structure::State};
///
/// // w = 0.3 + 0.2 cos 2t under a mass with m = k = 1.
/// let belt = Drive::harmonic(0.2, 2.0, 0.0)?.with_constant(0.3)?;
/// let contact = Contact::new(0, Coulomb::new(0.4, 0.3)?, 1.0)?.on_belt(belt);
/// let shaken = Structure::new(&[1.0])?.with_ground_spring(0, 1.0)?.with_contact(contact)?;
///
/// let steady = OnSteadyBelts::new(&shaken).ok_or("profiles, or different oscillations")?;
/// assert_eq!(steady.structure().contacts()[0].belt_velocity(), &Drive::constant(0.3));
/// // wΩ sin Ωt − (w/Ω) sin Ωt
/// assert_eq!(steady.structure().forces()[0], Drive::sine(0.4 - 0.1, 2.0)?);
/// let start = steady.seen_from_belts(&State::new(&[0.1], &[0.5]), 0.0);
/// assert_eq!(start, State::new(&[0.1], &[0.3]));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct OnSteadyBelts {
    structure: Structure,
    shift: Drive,
}

impl OnSteadyBelts {
    /// The structure, seen from a frame that oscillates with its belts.
    ///
    /// `None` unless the structure has contacts, the velocities of all their belts differ by
    /// constants only, no belt velocity follows a profile, and no force overflows.
    pub fn new(structure: &Structure) -> Option<Self> {
        let oscillation = structure
            .contacts()
            .first()?
            .belt_velocity()
            .oscillation()?;
        let together = structure
            .contacts()
            .iter()
            .all(|contact| contact.belt_velocity().oscillation().as_ref() == Some(&oscillation));
        if !together {
            return None;
        }
        let shift = oscillation.antiderivative()?;
        Some(Self {
            structure: structure.seen_from(&oscillation, &shift).ok()?,
            shift,
        })
    }

    /// The structure on steady belts, whose coordinates are y.
    pub fn structure(&self) -> &Structure {
        &self.structure
    }

    /// Displacement W(t) of the oscillating belts, in the structure's unit of length; its mean
    /// is 0.
    pub fn shift(&self) -> &Drive {
        &self.shift
    }

    /// The state (y, y') on steady belts that belongs to a state (q, q') at a time.
    pub fn seen_from_belts(&self, state: &State, time: f64) -> State {
        self.moved(state, time, -1.0)
    }

    /// The state (q, q') that belongs to a state (y, y') on steady belts at a time.
    pub fn seen_from_ground(&self, state: &State, time: f64) -> State {
        self.moved(state, time, 1.0)
    }

    fn moved(&self, state: &State, time: f64, sign: f64) -> State {
        let (shift, rate) = (sign * self.shift.value(time), sign * self.shift.slope(time));
        State {
            displacements: state.displacements.iter().map(|q| q + shift).collect(),
            velocities: state.velocities.iter().map(|v| v + rate).collect(),
            memory: state.memory.clone(),
        }
    }
}
