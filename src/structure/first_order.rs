use std::borrow::Cow;
use std::sync::Arc;

use super::direction::{add_entry, check_coordinates, checked_direction};
use super::engine::element_data::ElementData;
use super::engine::first_order::FirstOrderData;
use crate::drive::Drive;
use crate::error::{Element, Error};
use crate::force::object::OneDirection;
use crate::force::{ForceLaw, SharedForce, validate};

/// A first-order state z of a [`Structure`](crate::Structure): the integral of a controller, the
/// current of a motor, the pressure of an actuator, the output of a filter, the force of a Maxwell
/// damper.
///
/// ```text
/// integrator:  z' = u            lag:  T z' + z = u
/// u = Σ_j a_j q_j + Σ_j c_j v_j + Σ_k e_k z_k + w(t) + Σ F(x, y)
/// force on coordinate i:  b_i z
/// ```
///
/// q and v are the displacements and velocities of the coordinates, z_k the first-order states of
/// the structure, w(t) is a [`Drive`], and each F a [`ForceLaw`] of one direction, here with a
/// positive sign. z has any unit. u has the unit of z for a lag, and that of z per time for an
/// integrator; b z is a force.
///
/// | method | adds |
/// |---|---|
/// | [`with_displacement`](Self::with_displacement), [`with_velocity`](Self::with_velocity) | a_j q_j, c_j v_j |
/// | [`with_state`](Self::with_state) | e_k z_k of any state, its own included |
/// | [`with_drive`](Self::with_drive) | w(t), such as a reference value or a supply voltage |
/// | [`with_law`](Self::with_law), [`with_law_of_state`](Self::with_law_of_state) | F of a direction of q and v, or of a state: saturation, an orifice |
/// | [`with_force`](Self::with_force) | the force b_i z |
///
/// States are added by [`Structure::with_first_order`](crate::Structure::with_first_order), and are
/// numbered from 0 in that order. In a [`State`](crate::structure::State) their values are the last
/// of the memory variables.
///
/// ```
/// use stick_slip::{FirstOrder, Structure, structure::State};
///
/// // A mass on a Maxwell damper, a spring of stiffness k in series with a dashpot of constant c:
/// // its force z follows z'/k + z/c = v.
/// let (k, c) = (5.0, 2.0);
/// let damper = FirstOrder::lag(c / k)?
///     .with_velocity(0, c)?
///     .with_force(0, -1.0)?;
/// let mass = Structure::new(&[1.0])?.with_first_order(damper)?;
/// // v'' + v'k/c + k v = 0. From v = 1 and z = 0:
/// let motion = mass.simulate(State::new(&[0.0], &[1.0]), 1.0)?;
/// let (decay, omega) = (0.5 * k / c, (k - (0.5 * k / c).powi(2)).sqrt());
/// let exact = (-decay).exp() * (omega.cos() + decay / omega * omega.sin());
/// assert!((motion.last().velocities[0] - exact).abs() < 1e-15);
/// let force = (-decay).exp() * k / omega * omega.sin();
/// assert!((motion.last().memory[0] - force).abs() < 1e-15);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "super::read::FirstOrderText<crate::force::NamedForce>"),
    serde(into = "super::read::FirstOrderText<super::read::Written<crate::force::NamedForce>>")
)]
pub struct FirstOrder {
    /// T of a lag; `None` for an integrator.
    time_constant: Option<f64>,
    /// Each by ascending number; no entry is 0.
    displacements: Vec<(usize, f64)>,
    velocities: Vec<(usize, f64)>,
    states: Vec<(usize, f64)>,
    drive: Arc<Drive>,
    laws: Vec<RateLaw>,
    forces: Vec<(usize, f64)>,
}

/// A law in the rate of a state, with its input.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct RateLaw {
    pub(super) input: Input,
    pub(super) law: SharedForce,
}

/// The input of a law in the rate of a state.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub(super) enum Input {
    /// x = a·q, y = a·v.
    Direction(Vec<(usize, f64)>),
    /// x = z_k, y = 0.
    State(usize),
}

impl FirstOrder {
    /// Creates an integrator, z' = u, still without input and without a force.
    ///
    /// ```
    /// use stick_slip::{FirstOrder, Structure};
    ///
    /// // Position control by a spring, a damper and the integral of the displacement: the
    /// // eigenvalues λ are the roots of λ³ + 6λ² + 11λ + 6 = (λ + 1)(λ + 2)(λ + 3).
    /// let integral = FirstOrder::integrator()
    ///     .with_displacement(0, 1.0)?
    ///     .with_force(0, -6.0)?;
    /// let axis = Structure::new(&[1.0])?
    ///     .with_ground_spring(0, 11.0)?
    ///     .with_ground_damper(0, 6.0)?
    ///     .with_first_order(integral)?
    ///     .with_force(0, 9.0)?;
    /// let still = axis.steady_sliding()?;
    /// // The integral takes up the whole force.
    /// assert!(still.displacements[0].abs() < 1e-15);
    /// assert!((still.first_order[0] - 1.5).abs() < 1e-15);
    /// for (eigenvalue, exact) in still.eigenvalues.iter().zip([-1.0, -2.0, -3.0]) {
    ///     assert!((eigenvalue - exact).norm() < 1e-13);
    /// }
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    pub fn integrator() -> Self {
        Self {
            time_constant: None,
            displacements: Vec::new(),
            velocities: Vec::new(),
            states: Vec::new(),
            drive: Arc::new(Drive::constant(0.0)),
            laws: Vec::new(),
            forces: Vec::new(),
        }
    }

    /// Creates a first-order lag (low-pass filter), T z' + z = u, still without input and without a
    /// force. T is the time constant.
    ///
    /// # Errors
    ///
    /// [`Error::InvalidParameter`] unless T and 1/T are positive and finite.
    ///
    /// ```
    /// use stick_slip::{Drive, FirstOrder, Structure, structure::State};
    ///
    /// // An RC circuit (RC = 0.5) under a voltage sin 3t; the mass takes no part.
    /// let filter = FirstOrder::lag(0.5)?.with_drive(Drive::sine(1.0, 3.0)?)?;
    /// let circuit = Structure::new(&[1.0])?.with_first_order(filter)?;
    /// let motion = circuit.simulate(State::at_rest(1), 2.0)?;
    /// let [sine, cosine] = [6.0_f64.sin(), 6.0_f64.cos()];
    /// let exact = (sine - 1.5 * cosine + 1.5 * (-4.0_f64).exp()) / (1.0 + 1.5 * 1.5);
    /// assert!((motion.last().memory[0] - exact).abs() < 1e-15);
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    #[doc(alias = "low pass")]
    #[doc(alias = "PT1")]
    pub fn lag(time_constant: f64) -> Result<Self, Error> {
        let in_range = time_constant > 0.0 && time_constant.recip().is_finite();
        let allowed = "time_constant > 0, with a finite reciprocal";
        Error::check(
            "FirstOrder",
            "time_constant",
            time_constant,
            in_range,
            allowed,
        )?;
        Ok(Self {
            time_constant: Some(time_constant),
            ..Self::integrator()
        })
    }

    /// Adds a q_j to the input.
    ///
    /// # Errors
    ///
    /// [`Error::InvalidParameter`] if a, or the sum with what was added before, is not finite.
    pub fn with_displacement(mut self, coordinate: usize, gain: f64) -> Result<Self, Error> {
        add(&mut self.displacements, coordinate, gain)?;
        Ok(self)
    }

    /// Adds c v_j to the input.
    ///
    /// # Errors
    ///
    /// The errors of [`with_displacement`](Self::with_displacement).
    pub fn with_velocity(mut self, coordinate: usize, gain: f64) -> Result<Self, Error> {
        add(&mut self.velocities, coordinate, gain)?;
        Ok(self)
    }

    /// Adds e z_k to the input. k is the number of a state in the structure, and may be its own.
    /// States that act on each other are added together, by
    /// [`Structure::with_first_orders`](crate::Structure::with_first_orders).
    ///
    /// # Errors
    ///
    /// The errors of [`with_displacement`](Self::with_displacement).
    pub fn with_state(mut self, state: usize, gain: f64) -> Result<Self, Error> {
        add(&mut self.states, state, gain)?;
        Ok(self)
    }

    /// Adds w(t) to the input.
    ///
    /// # Errors
    ///
    /// [`Error::InvalidParameter`] if w, or the sum with what was added before, is not finite at
    /// all times.
    pub fn with_drive(mut self, drive: impl Into<Drive>) -> Result<Self, Error> {
        let sum = Drive::clone(&self.drive).plus(&drive.into())?;
        self.drive = Arc::new(sum);
        Ok(self)
    }

    /// Adds F(x, y) to the input, with x = Σ a_j q_j and y = Σ a_j v_j.
    ///
    /// # Errors
    ///
    /// The errors of [`ForceElement::along`](crate::ForceElement::along).
    pub fn with_law<L: ForceLaw + Send + Sync + 'static>(
        self,
        direction: &[(usize, f64)],
        law: L,
    ) -> Result<Self, Error> {
        let direction = checked_direction(direction)?.1;
        self.and_law(
            Input::Direction(direction),
            SharedForce::new(OneDirection(law)),
        )
    }

    /// Adds F(x, 0) to the input, with x = z_k; k is the number of a state in the structure, and
    /// may be its own.
    ///
    /// # Errors
    ///
    /// The errors of [`ForceElement::new`](crate::ForceElement::new).
    ///
    /// ```
    /// use stick_slip::{FirstOrder, PolynomialSpring, Structure, structure::State};
    ///
    /// // Growth with saturation: z' = z − z³, so that 1/z² − 1 decays as e^(−2t).
    /// let growth = PolynomialSpring::new(&[1.0, 0.0, -1.0])?;
    /// let state = FirstOrder::integrator().with_law_of_state(0, growth)?;
    /// let system = Structure::new(&[1.0])?.with_first_order(state)?;
    /// let start = State::at_rest(1).with_memory(&[0.1]);
    /// let motion = system.simulate(start, 3.0)?;
    /// let exact = (1.0 + 99.0 * (-6.0_f64).exp()).sqrt().recip();
    /// assert!((motion.last().memory[0] - exact).abs() < 1e-15);
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    pub fn with_law_of_state<L: ForceLaw + Send + Sync + 'static>(
        self,
        state: usize,
        law: L,
    ) -> Result<Self, Error> {
        self.and_law(Input::State(state), SharedForce::new(OneDirection(law)))
    }

    /// Adds a law without its type.
    pub(super) fn and_law(mut self, input: Input, law: SharedForce) -> Result<Self, Error> {
        validate(&*law)?;
        self.laws.push(RateLaw { input, law });
        Ok(self)
    }

    /// Adds the force b z on a coordinate.
    ///
    /// # Errors
    ///
    /// The errors of [`with_displacement`](Self::with_displacement).
    pub fn with_force(mut self, coordinate: usize, gain: f64) -> Result<Self, Error> {
        add(&mut self.forces, coordinate, gain)?;
        Ok(self)
    }

    /// The time constant T of a lag; `None` for an integrator.
    pub fn time_constant(&self) -> Option<f64> {
        self.time_constant
    }

    /// The gains of displacements in the input: pairs of a coordinate j and a_j ≠ 0, by ascending
    /// j.
    pub fn displacements(&self) -> &[(usize, f64)] {
        &self.displacements
    }

    /// The gains of velocities in the input: pairs of a coordinate j and c_j ≠ 0, by ascending j.
    pub fn velocities(&self) -> &[(usize, f64)] {
        &self.velocities
    }

    /// The gains of first-order states in the input: pairs of a number k and e_k ≠ 0, by ascending
    /// k.
    pub fn states(&self) -> &[(usize, f64)] {
        &self.states
    }

    /// The function of time w(t) in the input.
    pub fn drive(&self) -> &Drive {
        &self.drive
    }

    /// The forces: pairs of a coordinate i and b_i ≠ 0, by ascending i.
    pub fn forces(&self) -> &[(usize, f64)] {
        &self.forces
    }

    /// Holds the drive of the state at its value at a time.
    pub(super) fn frozen(&self, time: f64) -> Self {
        Self {
            drive: Arc::new(Drive::constant(self.drive.value(time))),
            ..self.clone()
        }
    }

    #[cfg(feature = "serde")]
    pub(super) fn laws(&self) -> &[RateLaw] {
        &self.laws
    }

    /// Checks that this may be state `number` of a structure with so many coordinates and states.
    pub(super) fn check(&self, number: usize, count: usize, states: usize) -> Result<(), Error> {
        let element = Element::FirstOrder(number);
        let laws = self.laws.iter().map(|law| &law.input);
        let along = laws.clone().flat_map(|input| match input {
            Input::Direction(direction) => &direction[..],
            Input::State(_) => &[],
        });
        let lists = [&self.displacements, &self.velocities, &self.forces];
        let coordinates = lists.into_iter().flatten().chain(along).map(|&(j, _)| j);
        check_coordinates(element, coordinates, count)?;
        let of_laws = laws.filter_map(|input| match input {
            Input::State(state) => Some(*state),
            Input::Direction(_) => None,
        });
        let mut read = self.states.iter().map(|&(k, _)| k).chain(of_laws);
        match read.find(|&state| state >= states) {
            None => Ok(()),
            Some(state) => Err(Error::NoSuchState {
                element,
                state,
                count: states,
            }),
        }
    }

    /// 1/T, or 1.
    fn scale(&self) -> f64 {
        self.time_constant.map_or(1.0, f64::recip)
    }

    /// State `number` as the engine needs it.
    pub(super) fn data(&self, number: usize) -> FirstOrderData {
        let scale = self.scale();
        let scaled = |entries: &[(usize, f64)]| -> Vec<(usize, f64)> {
            entries.iter().map(|&(j, a)| (j, scale * a)).collect()
        };
        let mut states = scaled(&self.states);
        if self.time_constant.is_some() {
            states.push((number, -scale));
        }
        FirstOrderData {
            displacements: scaled(&self.displacements),
            velocities: scaled(&self.velocities),
            states,
            drive: Arc::clone(&self.drive),
            scale,
            forces: self.forces.clone(),
            responses: Vec::new(),
            acts: false,
        }
    }

    /// The laws in the rate of state `number`, in a structure with so many coordinates.
    pub(super) fn law_data(&self, number: usize, count: usize) -> Vec<ElementData<'_>> {
        let laws = self.laws.iter().map(|RateLaw { input, law }| {
            let direction = match input {
                Input::Direction(direction) => direction.clone(),
                Input::State(state) => vec![(count + state, 1.0)],
            };
            let factor = Arc::new(Drive::constant(1.0));
            ElementData {
                rate_of: Some((number, self.scale())),
                ..ElementData::new(Cow::Owned(vec![direction]), &**law, factor)
            }
        });
        laws.collect()
    }
}

/// Adds a gain.
fn add(gains: &mut Vec<(usize, f64)>, number: usize, gain: f64) -> Result<(), Error> {
    let sum = add_entry(gains, number, gain);
    Error::check("FirstOrder", "gain", gain, sum.is_finite(), "a finite sum").map(drop)
}
