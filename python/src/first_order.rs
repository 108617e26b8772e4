//! `FirstOrder`: states without a mass.

use pyo3::prelude::*;
use stick_slip::FirstOrder;

use crate::convert::{Direction, Index};
use crate::drive::DriveArgument;
use crate::error::OrRaise;
use crate::force::{ForceLawArgument, with_force};
use crate::made::{Made, Reduced};

/// A first-order state z of a `Structure`: the integral of a controller, the current of a motor,
/// the pressure of an actuator, the output of a filter, the force of a Maxwell damper.
///
/// integrator: z' = u; with a time constant T a lag (low-pass filter): T z' + z = u;
///
/// u = sum of a_j q_j + c_j v_j + e_k z_k + w(t) + F(x, y);   force on coordinate i: b_i z.
///
/// z has any unit; u has the unit of z for a lag, and that of z per time for an integrator. States
/// are numbered from 0 in the order in which they are added. In starts and in
/// `Motion.sample_memory` they follow the memory variables of the contacts.
///
/// Args:
///     time_constant: T of a lag, in units of time, > 0; None for an integrator.
///     displacements: a dict {coordinate j: a_j} of gains.
///     velocities: a dict {coordinate j: c_j} of gains.
///     states: a dict {number k: e_k} of gains of first-order states, its own included.
///     drive: w(t), such as a reference value or a supply voltage: a number or a Drive.
///     laws: pairs (direction, ForceLaw) that add F(a.q, a.v): saturation, an orifice.
///     state_laws: pairs (number k, ForceLaw) that add F(z_k, 0).
///     forces: a dict {coordinate i: b_i} of the forces that z exerts, force per unit of z.
///
/// Position control: spring, damper and the integral of the displacement.
///
/// >>> from stick_slip import FirstOrder, Structure
/// >>> integral = FirstOrder(displacements={0: 1.0}, forces={0: -6.0})
/// >>> axis = (Structure([1.0]).with_ground_spring(0, 11.0).with_ground_damper(0, 6.0)
/// ...     .with_first_order(integral).with_force(0, 9.0))
/// >>> still = axis.steady_sliding()    # the integral takes up the whole force
/// >>> still.first_order
/// array([1.5])
/// >>> still.eigenvalues.real.round(12)
/// array([-1., -2., -3.])
///
/// A Maxwell damper, a spring of 5 in series with a dashpot of 2: its force z follows z'/5 + z/2 =
/// v.
///
/// >>> FirstOrder(time_constant=2.0 / 5.0, velocities={0: 2.0}, forces={0: -1.0})
/// FirstOrder(time_constant=0.4, velocities={0: 2.0}, forces={0: -1.0})
#[pyclass(frozen, name = "FirstOrder", module = "stick_slip")]
pub struct PyFirstOrder {
    pub state: FirstOrder,
    made: Made,
}

type Laws<'py, P> = Vec<(P, ForceLawArgument<'py>)>;

#[pymethods]
impl PyFirstOrder {
    #[new]
    #[pyo3(signature = (*, time_constant = None, displacements = None, velocities = None,
        states = None, drive = None, laws = Vec::new(), state_laws = Vec::new(), forces = None))]
    fn new(
        py: Python<'_>,
        time_constant: Option<f64>,
        displacements: Option<Direction>,
        velocities: Option<Direction>,
        states: Option<Direction>,
        drive: Option<DriveArgument<'_>>,
        laws: Laws<'_, Direction>,
        state_laws: Laws<'_, Index>,
        forces: Option<Direction>,
    ) -> PyResult<Self> {
        let mut made = Made::by(py, "FirstOrder", ())?;
        made = made.with_given(py, "time_constant", time_constant)?;
        let mut state = match time_constant {
            None => FirstOrder::integrator(),
            Some(time) => FirstOrder::lag(time).or_raise()?,
        };
        let gains = [
            (
                displacements,
                FirstOrder::with_displacement as fn(_, _, _) -> _,
            ),
            (velocities, FirstOrder::with_velocity),
            (states, FirstOrder::with_state),
            (forces, FirstOrder::with_force),
        ];
        for (gains, with) in gains {
            for (number, gain) in gains.into_iter().flat_map(|Direction(gains)| gains) {
                state = with(state, number, gain).or_raise()?;
            }
        }
        // Gains that were given twice are added.
        let gains = [
            ("displacements", state.displacements()),
            ("velocities", state.velocities()),
            ("states", state.states()),
            ("forces", state.forces()),
        ];
        for (name, gains) in gains.into_iter().filter(|(_, gains)| !gains.is_empty()) {
            made = made.with(py, name, &Direction(gains.to_vec()))?;
        }
        made = made.with_given(py, "drive", drive.as_ref())?;
        if let Some(drive) = drive {
            state = state.with_drive(drive.drive()).or_raise()?;
        }
        let given: Vec<_> = laws.iter().map(|(it, law)| (it, &law.0)).collect();
        made = made.with_given(py, "laws", (!given.is_empty()).then_some(given))?;
        for (Direction(direction), law) in &laws {
            let law = law.0.get().force.clone();
            let with = with_force!(law, law => state.with_law(direction, law));
            state = with.or_raise()?;
        }
        let given: Vec<_> = state_laws.iter().map(|(it, law)| (it.0, &law.0)).collect();
        made = made.with_given(py, "state_laws", (!given.is_empty()).then_some(given))?;
        for (Index(number), law) in &state_laws {
            let law = law.0.get().force.clone();
            let with = with_force!(law, law => state.with_law_of_state(*number, law));
            state = with.or_raise()?;
        }
        Ok(Self { state, made })
    }

    /// The time constant of a lag, in units of time; None for an integrator.
    #[getter]
    fn time_constant(&self) -> Option<f64> {
        self.state.time_constant()
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        self.made.text(py)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> Reduced<'py> {
        self.made.reduced(py)
    }
}
