use super::State as OneMass;

/// The state of several masses: displacements, velocities, the memory variables of their contacts,
/// and [first-order states](crate::FirstOrder).
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
}

impl State {
    /// Creates a state with the given displacements and velocities, without memory variables.
    pub fn new(displacements: &[f64], velocities: &[f64]) -> Self {
        Self {
            displacements: displacements.to_vec(),
            velocities: velocities.to_vec(),
            memory: Vec::new(),
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

    /// All numbers: displacements, velocities, memory variables.
    pub(crate) fn numbers(&self) -> impl Iterator<Item = f64> {
        let motion = self.displacements.iter().chain(&self.velocities);
        motion.chain(&self.memory).copied()
    }

    /// The state of so many coordinates with these [`numbers`](Self::numbers).
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
}

impl From<OneMass> for State {
    fn from(state: OneMass) -> Self {
        Self::new(&[state.displacement], &[state.velocity])
    }
}
