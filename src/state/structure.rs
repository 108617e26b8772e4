use super::State as OneMass;

/// The state of several masses: displacements, velocities, the memory variables of their contacts,
/// and [first-order states](crate::FirstOrder). The relative velocities of contacts follow from the
/// velocities, but may be given, too.
///
/// All numbers are in the units of the system: the structure's own, or dimensionless for a
/// [`MassOnBelt`](crate::MassOnBelt). For both kinds of system, an [`Error`](crate::Error) contains
/// the last state reached as a value of this type.
///
/// ```
/// use stick_slip::{State, structure};
///
/// let state = structure::State::new(&[0.3, 0.1], &[0.0, -0.1]);
/// assert_eq!(state.velocities[1], -0.1);
/// assert_eq!(structure::State::from(State::new(0.3, 0.0)).displacements, [0.3]);
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct State {
    /// The displacement of each coordinate.
    pub displacements: Vec<f64>,
    /// The velocity of each coordinate.
    pub velocities: Vec<f64>,
    /// The memory variables of the contacts, in the order of the contacts. A contact without memory
    /// has no variable, and an elastic contact has one, its force T. The [first-order
    /// states](crate::FirstOrder) follow, by their numbers. If the list is empty in a start state,
    /// all start at 0.
    #[cfg_attr(feature = "serde", serde(default))]
    pub memory: Vec<f64>,
    #[cfg_attr(
        feature = "serde",
        serde(default, skip_serializing_if = "Option::is_none")
    )]
    sliding: Option<Box<Sliding>>,
}

/// The relative velocities in a state. Behind a thin pointer, because few states have them and all
/// errors of motions contain a state.
#[derive(Debug, Clone, PartialEq, Default)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(transparent)
)]
struct Sliding(Vec<(usize, f64)>);

impl State {
    /// Creates a state with the given displacements and velocities, without memory variables.
    pub fn new(displacements: &[f64], velocities: &[f64]) -> Self {
        Self {
            displacements: displacements.to_vec(),
            velocities: velocities.to_vec(),
            memory: Vec::new(),
            sliding: None,
        }
    }

    /// Creates the state of n masses at rest with all displacements 0.
    ///
    /// ```
    /// assert_eq!(stick_slip::structure::State::at_rest(2).velocities, [0.0, 0.0]);
    /// ```
    pub fn at_rest(n: usize) -> Self {
        Self::new(&vec![0.0; n], &vec![0.0; n])
    }

    /// The numbers of the state: displacements, velocities, memory variables, relative velocities.
    pub(crate) fn numbers(&self) -> impl Iterator<Item = f64> {
        let motion = self.displacements.iter().chain(&self.velocities);
        let sliding = self.sliding().iter().map(|&(_, r)| r);
        motion.chain(&self.memory).copied().chain(sliding)
    }

    /// The state with these displacements, velocities and memory variables.
    pub(crate) fn of_parts([displacements, velocities, memory]: [Vec<f64>; 3]) -> Self {
        Self {
            displacements,
            velocities,
            memory,
            sliding: None,
        }
    }

    /// The state of so many coordinates with these [`numbers`](Self::numbers), without relative
    /// velocities.
    pub(crate) fn of_numbers(coordinates: usize, numbers: &[f64]) -> Self {
        let (displacements, others) = numbers.split_at(coordinates);
        let (velocities, memory) = others.split_at(coordinates);
        Self::new(displacements, velocities).with_memory(memory)
    }

    /// Sets the memory variables, in the order of the contacts, and then the first-order states.
    pub fn with_memory(mut self, memory: &[f64]) -> Self {
        self.memory = memory.to_vec();
        self
    }

    /// Sets the relative velocity r of a contact. As the difference b·v − w(t) it has lost digits
    /// where the contact creeps: beside a plate that moves at 1e-9 m/s, a speed of 1e-12 m/s has 13
    /// digits left. The given number has all of them, and wins: at the start of a motion the
    /// velocities v are changed until b·v − w = r, by the change of least kinetic energy. Other
    /// contacts that stick go on to stick, unless r does not allow it.
    ///
    /// ```
    /// use stick_slip::{Contact, RateState, Structure, structure::State};
    ///
    /// // A fault, by the square metre.
    /// let law = RateState::aging(0.6, 0.01, 0.015, 8e-3, 1e-6)?;
    /// let fault = Structure::new(&[4e6])?
    ///     .with_ground_spring(0, 1.6e7)?
    ///     .with_contact(Contact::new(0, law, 5e7)?.on_belt(1e-9))?;
    /// let start = State::new(&[1.9], &[0.0]).with_memory(&[6.9]).with_sliding(0, -1.5e-12);
    /// let motion = fault.simulate(start, 0.0)?;
    /// assert_eq!(motion.sliding_velocity(0, 0.0), -1.5e-12);
    /// assert_eq!(motion.last().velocities, [1e-9 - 1.5e-12]);
    /// // A state of the motion contains it, too.
    /// assert_eq!(motion.last().sliding(), [(0, -1.5e-12)]);
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    pub fn with_sliding(mut self, contact: usize, relative_velocity: f64) -> Self {
        let Sliding(all) = &mut **self.sliding.get_or_insert_default();
        let place = all.partition_point(|&(other, _)| other < contact);
        match all.get_mut(place) {
            Some((other, r)) if *other == contact => *r = relative_velocity,
            _ => all.insert(place, (contact, relative_velocity)),
        }
        self
    }

    /// Relative velocities r of contacts, with the numbers of the contacts, ascending. States of a
    /// motion contain those of contacts whose law [creeps](crate::ContactLaw::creeps), others none
    /// but those given by [`with_sliding`](Self::with_sliding).
    pub fn sliding(&self) -> &[(usize, f64)] {
        self.sliding.as_ref().map_or(&[], |sliding| &sliding.0)
    }

    /// Sets the relative velocities of contacts, given by ascending number.
    pub(crate) fn sliding_at(self, sliding: impl Iterator<Item = (usize, f64)>) -> Self {
        let mut sliding = sliding.peekable();
        let is_given = sliding.peek().is_some();
        Self {
            sliding: is_given.then(|| Box::new(Sliding(sliding.collect()))),
            ..self
        }
    }
}

impl From<OneMass> for State {
    fn from(state: OneMass) -> Self {
        Self::new(&[state.displacement], &[state.velocity])
    }
}
