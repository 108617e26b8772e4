//! Samples of a motion with friction forces, loads and accelerations.

use super::energy::check_motion;
use super::engine::instant::{AtElement, Forces};
use super::system::Structure;
use crate::error::Error;
use crate::motion::{Mode, Trajectory};
use crate::state::structure::State;

/// State, forces and accelerations of a [`Structure`] at one instant of a motion. See
/// [`Structure::samples`]. Accelerations, forces and loads are infinite or NaN where a displacement
/// or velocity of the motion overflows.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Sample {
    /// The time, in the units of the structure.
    pub time: f64,
    /// Displacements, velocities and memory variables.
    pub state: State,
    /// The mode of each contact; at the time of an event, the mode after the event.
    pub modes: Vec<Mode>,
    /// The acceleration v' of each coordinate, in units of velocity per time.
    pub accelerations: Vec<f64>,
    /// The friction force of each contact, as returned by [`Structure::carried`], in units of
    /// force; 0 if the contact is open.
    pub friction: Vec<f64>,
    /// The normal load of each contact, in units of force; 0 if the contact is open.
    pub loads: Vec<f64>,
    /// The forces D F_i of each [force element](crate::ForceElement), one for each of its
    /// directions, in units of force; the force on the structure is −Σ a_i D F_i.
    pub element_forces: Vec<Vec<f64>>,
    /// The force F of each [stop](crate::Stop), in units of force; the force on the structure is +d
    /// F, and 0 while the stop is open.
    pub stop_forces: Vec<f64>,
}

impl Structure {
    /// Samples of a motion of this structure at equal intervals, from its start to the last
    /// sampling time within the motion: the state, the accelerations, and the friction force, load
    /// and mode of each contact. [`Trajectory::sample_every`] returns states and modes only, and is
    /// faster.
    ///
    /// # Errors
    ///
    /// [`Error::InvalidParameter`] unless the interval is finite and > 0; [`Error::WrongSize`] if
    /// the motion belongs to another structure.
    ///
    /// ```
    /// use stick_slip::{Contact, Coulomb, Mode, Structure, structure::State};
    ///
    /// // A block of 2 kg on a belt: while it sticks, friction balances its spring.
    /// let contact = Contact::new(0, Coulomb::new(0.4, 0.3)?, 20.0)?.on_belt(0.1);
    /// let block = Structure::new(&[2.0])?.with_ground_spring(0, 50.0)?.with_contact(contact)?;
    /// let motion = block.simulate(State::at_rest(1), 2.0)?;
    /// for sample in block.samples(&motion, 1e-3)? {
    ///     let spring = 50.0 * sample.state.displacements[0];
    ///     match sample.modes[0] {
    ///         Mode::Stick => assert!((sample.friction[0] + spring).abs() < 1e-14),
    ///         _ => assert_eq!(sample.friction[0].abs(), 0.3 * 20.0),
    ///     }
    ///     assert!((2.0 * sample.accelerations[0] + spring + sample.friction[0]).abs() < 1e-14);
    /// }
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    pub fn samples(
        &self,
        motion: &Trajectory<State>,
        interval: f64,
    ) -> Result<impl Iterator<Item = Sample>, Error> {
        let model = self.model();
        check_motion(&model, motion)?;
        Ok(motion.steps_every(interval)?.map(move |(time, step)| {
            let instant = Forces::of(&model, step).at_time(time);
            let contacts = instant.contacts.iter();
            let (friction, loads) = contacts.map(|at| (at.carried, at.load)).unzip();
            let (elements, stops) = instant.elements.split_at(model.force_elements().len());
            let element_forces = elements.iter().map(AtElement::scaled).collect();
            let stop_forces = stops.iter().map(|at| at.forces[0]).collect();
            Sample {
                time,
                modes: step.modes().to_vec(),
                accelerations: instant.accelerations,
                friction,
                loads,
                element_forces,
                stop_forces,
                state: instant.state,
            }
        }))
    }
}
