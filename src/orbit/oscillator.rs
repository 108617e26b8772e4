//! What the searches need of a system.

use super::lyapunov::{self, Growth};
use super::map::{self, PeriodMap};
use crate::belt::MassOnBelt;
use crate::error::Error;
use crate::friction::FrictionLaw;
use crate::friction::memory::ContactLaw;
use crate::motion::{Ended, EventKind, Mode, System, Trajectory};
use crate::state;
use crate::state::structure::State;
use crate::structure::Structure;

/// A system whose periodic motions can be found: [`MassOnBelt`] or [`Structure`]. Sealed, as
/// [`System`] is.
///
/// A belt is looked at as the structure of one mass that it is; its trajectories are its own.
pub trait Oscillator: System {
    /// The general form of a state.
    #[doc(hidden)]
    fn general(state: &Self::State) -> State;
    /// The system's own form of a state.
    #[doc(hidden)]
    fn own(state: &State) -> Self::State;
    /// Numbers of displacements and of numbers that contacts remember.
    #[doc(hidden)]
    fn sizes(&self) -> (usize, usize);
    /// How its drives vary.
    #[doc(hidden)]
    fn rhythm(&self) -> Rhythm;
    /// Coordinate of each contact, and the velocity of its belt at time 0.
    #[doc(hidden)]
    fn belts(&self) -> Vec<(usize, f64)>;
    /// The motion from a state at time 0 over a duration, with its derivative with respect to that
    /// state.
    #[doc(hidden)]
    fn period_map(&self, start: &State, duration: f64) -> Result<PeriodMap, Error>;
    /// The map of the same closed motion begun where no event is near, if its start is near to one.
    #[doc(hidden)]
    fn begun_apart(&self, map: &PeriodMap, period: f64) -> Result<Option<PeriodMap>, Error>;
    /// Where the motion from a state at time 0 is after a duration, and what its contacts do there.
    #[doc(hidden)]
    fn reach(&self, start: &State, duration: f64) -> Result<(State, Vec<Mode>), Error>;
    /// Where the motion from a state at time 0 is after a duration, and the events on the way.
    #[doc(hidden)]
    fn passage(&self, start: &State, duration: f64) -> Result<Passage, Error>;
    /// How a small change of the motion from a state at time 0 grows, in parts of a duration.
    #[doc(hidden)]
    fn growths(&self, start: &State, transient: f64, duration: f64) -> Result<Vec<Growth>, Error>;
    /// The motion over one period in the system's own form.
    #[doc(hidden)]
    fn trajectory(&self, map: PeriodMap, period: f64) -> Result<Trajectory<Self::State>, Error>;
}

/// The end of a motion, and its events: contact and kind.
pub(super) type Passage = (State, Vec<(usize, EventKind)>);

/// How drives vary.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Rhythm {
    /// Not at all.
    Constant,
    /// With a common period.
    Periodic(f64),
    /// Without one.
    Aperiodic,
}

impl<L: ContactLaw<Z>, const Z: usize> Oscillator for Structure<L, Z> {
    fn general(state: &State) -> State {
        state.clone()
    }

    fn own(state: &State) -> State {
        state.clone()
    }

    fn sizes(&self) -> (usize, usize) {
        (self.len(), Z * self.contacts().len())
    }

    fn rhythm(&self) -> Rhythm {
        match self.period() {
            Some(period) => Rhythm::Periodic(period),
            None if self.drives().all(|drive| drive.is_constant()) => Rhythm::Constant,
            None => Rhythm::Aperiodic,
        }
    }

    fn belts(&self) -> Vec<(usize, f64)> {
        let contacts = self.contacts().iter();
        contacts
            .map(|contact| (contact.coordinate(), contact.belt_velocity().value(0.0)))
            .collect()
    }

    fn period_map(&self, start: &State, duration: f64) -> Result<PeriodMap, Error> {
        map::period_map(self, 0.0, start, duration)
    }

    fn begun_apart(&self, map: &PeriodMap, period: f64) -> Result<Option<PeriodMap>, Error> {
        map::begun_apart(self, map, period)
    }

    fn reach(&self, start: &State, duration: f64) -> Result<(State, Vec<Mode>), Error> {
        map::reach(self, start, duration)
    }

    fn passage(&self, start: &State, duration: f64) -> Result<Passage, Error> {
        map::passage(self, start, duration)
    }

    fn growths(&self, start: &State, transient: f64, duration: f64) -> Result<Vec<Growth>, Error> {
        lyapunov::growths(self, start, transient, duration)
    }

    fn trajectory(&self, map: PeriodMap, period: f64) -> Result<Trajectory<State>, Error> {
        Ok(Trajectory::new(map.steps, 0.0, period, Ended::Duration))
    }
}

impl<L: FrictionLaw> Oscillator for MassOnBelt<L> {
    fn general(state: &state::State) -> State {
        (*state).into()
    }

    fn own(state: &State) -> state::State {
        match (&state.displacements[..], &state.velocities[..]) {
            ([displacement], [velocity]) => state::State::new(*displacement, *velocity),
            // One mass has no other state.
            _ => state::State::new(f64::NAN, f64::NAN),
        }
    }

    fn sizes(&self) -> (usize, usize) {
        (1, 0)
    }

    fn rhythm(&self) -> Rhythm {
        Rhythm::Constant
    }

    fn belts(&self) -> Vec<(usize, f64)> {
        vec![(0, self.belt_velocity())]
    }

    fn period_map(&self, start: &State, duration: f64) -> Result<PeriodMap, Error> {
        Structure::from(&self.by_reference()).period_map(start, duration)
    }

    fn begun_apart(&self, map: &PeriodMap, period: f64) -> Result<Option<PeriodMap>, Error> {
        Structure::from(&self.by_reference()).begun_apart(map, period)
    }

    fn reach(&self, start: &State, duration: f64) -> Result<(State, Vec<Mode>), Error> {
        Structure::from(&self.by_reference()).reach(start, duration)
    }

    fn passage(&self, start: &State, duration: f64) -> Result<Passage, Error> {
        Structure::from(&self.by_reference()).passage(start, duration)
    }

    fn growths(&self, start: &State, transient: f64, duration: f64) -> Result<Vec<Growth>, Error> {
        Structure::from(&self.by_reference()).growths(start, transient, duration)
    }

    fn trajectory(&self, map: PeriodMap, period: f64) -> Result<Trajectory, Error> {
        self.simulate(Self::own(&map.start), period)
    }
}
