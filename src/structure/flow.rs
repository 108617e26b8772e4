//! The motion of a structure, step by step.

use super::engine::Engine;
use super::engine::model::Model;
use super::step::Step;
use super::system::Structure;
use crate::error::Error;
use crate::motion::sealed::Sealed;
use crate::motion::{Integrator, Run, Segment, System, Trajectory};
use crate::state::structure::State;

/// The motion of a [`Structure`] from a start state, without an end: an iterator of [`Step`]s in
/// constant memory.
///
/// Made by [`Integrator::flow`]. After an error comes `None`. A motion in which no velocity changes
/// and no contact ever will is one last step of infinite duration. A flow stays in the thread in
/// which it was made; a structure may be shared by threads.
#[derive(Debug, Clone)]
pub struct Flow<'s> {
    engine: Engine<'s>,
    run: Run,
    /// The events of the start itself.
    first: Option<Step>,
    ended: bool,
}

impl<'s> Flow<'s> {
    pub(crate) fn new(
        settings: Integrator,
        model: Model<'s>,
        start: &State,
    ) -> Result<Self, Error> {
        check_start(&model, start)?;
        let run = Run::new(settings);
        let (engine, first) = Engine::start(model, settings.tolerance(), run.clock, start)?;
        Ok(Self {
            engine,
            run,
            first,
            ended: false,
        })
    }
}

/// Checks the sizes and the numbers of a start.
pub(super) fn check_start(model: &Model<'_>, start: &State) -> Result<(), Error> {
    let n = model.len();
    let memory = model.remembered();
    let sizes = [
        ("displacements", start.displacements.len(), n),
        ("velocities", start.velocities.len(), n),
    ];
    let remembered = start.memory.len();
    let memory = (remembered > 0).then_some(("memory", remembered, memory));
    for (name, found, expected) in sizes.into_iter().chain(memory) {
        if found != expected {
            return Err(Error::WrongSize {
                name,
                found,
                expected,
            });
        }
    }
    let coordinates = std::iter::zip(&start.displacements, &start.velocities);
    for (&displacement, &velocity) in coordinates {
        if !(displacement.is_finite() && velocity.is_finite()) {
            return Err(Error::InvalidState {
                displacement,
                velocity,
            });
        }
    }
    for &value in &start.memory {
        Error::check("Structure", "memory", value, true, "any size")?;
    }
    if remembered > 0 {
        for (c, contact) in model.contacts.iter().enumerate() {
            let memory = &start.memory[model.memory(c)];
            if let Some(limit) = contact.law.limit(&|j| memory[j]) {
                let allowed = "a memory at the start with which static_coefficient ≥ 0";
                let is_allowed = limit >= 0.0;
                Error::check(
                    "Structure",
                    "static_coefficient",
                    limit,
                    is_allowed,
                    allowed,
                )?;
            }
        }
    }
    Ok(())
}

impl Iterator for Flow<'_> {
    type Item = Result<Step, Error>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.ended {
            return None;
        }
        let step = match self.run.limit_reached(|| self.engine.state()) {
            Some(error) => Err(error),
            None => match self.first.take() {
                Some(first) => Ok(first),
                None => self.engine.step(),
            },
        };
        match &step {
            Ok(step) => {
                self.run.count(step.events().len());
                self.run.clock = self.engine.clock();
                self.ended = step.duration().is_infinite();
            }
            // An error is the last item.
            Err(_) => self.ended = true,
        }
        Some(step)
    }
}

impl Sealed for Structure {}

impl System for Structure {
    type State = State;
    type Flow<'s> = Flow<'s>;

    fn flow(&self, settings: Integrator, start: State) -> Result<Flow<'_>, Error> {
        Flow::new(settings, self.model(), &start)
    }
}

impl Structure {
    /// The motion from `start` over `duration`, to round-off:
    /// [`Integrator::simulate`](crate::Integrator::simulate) with its defaults.
    ///
    /// # Errors
    ///
    /// Those of [`Integrator::simulate`](crate::Integrator::simulate).
    #[doc(alias = "integrate")]
    #[doc(alias = "solve")]
    pub fn simulate(&self, start: State, duration: f64) -> Result<Trajectory<State>, Error> {
        Integrator::new().simulate(self, start, duration)
    }
}
