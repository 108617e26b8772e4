//! `MassOnBelt` and `PhysicalMassOnBelt`.

use std::sync::Arc;

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use stick_slip::{Coulomb, Physical, Scaling, State};

use crate::any_belt::Belt;
use crate::convert::{BeltStart, ComplexNumbers, Table, shown};
use crate::error::OrRaise;
use crate::law::{LawArgument, PyLaw, scaled};
use crate::made::{Made, Reduced};
use crate::motion::{AnyMotion, PyMotion, ended_well};
use crate::record::record;
use crate::simulate::Settings;
use crate::structure::PyStructure;
use crate::waiting::Waiting;

record! {
    /// Steady sliding of a mass on a belt.
    ///
    /// >>> from stick_slip import MassOnBelt, Polynomial
    /// >>> MassOnBelt(Polynomial(0.4, 0.25, 0.5), 0.6, damping=0.05).equilibrium.stability
    /// 'stable focus'
    Equilibrium {
        /// The displacement, in units of displacement.
        displacement: f64,
        /// The derivatives of (u', v') by (u, v), two by two.
        jacobian: Table,
        /// The two eigenvalues of the linearized equations, per unit of time.
        eigenvalues: ComplexNumbers,
        /// "stable focus", "stable node", "centre", "unstable focus" or "unstable node".
        stability: String,
        /// True if small perturbations decay.
        is_stable: bool,
    }
}

impl From<stick_slip::Equilibrium> for Equilibrium {
    fn from(equilibrium: stick_slip::Equilibrium) -> Self {
        Self {
            displacement: equilibrium.displacement,
            jacobian: {
                let mut table = Table::new(2);
                for row in 0..2 {
                    let entry = |column| equilibrium.jacobian[(row, column)];
                    table.push(&[entry(0), entry(1)]);
                }
                table
            },
            eigenvalues: ComplexNumbers(equilibrium.eigenvalues.to_vec()),
            stability: equilibrium.stability.to_string(),
            is_stable: equilibrium.is_stable(),
        }
    }
}

/// A dimensionless mass on a moving belt, held by a spring and a damper:
///
/// u'' + 2 beta u' + u + gamma^2 mu(u' - v_b) = 0.
///
/// Args:
///     law: the friction law, over dimensionless speeds.
///     belt_velocity: v_b, dimensionless, of either sign.
///     damping: beta, the damping ratio, >= 0.
///     load: gamma^2, the friction load, > 0.
///
/// >>> from stick_slip import MassOnBelt, Polynomial
/// >>> system = MassOnBelt(Polynomial(0.4, 0.25, 0.5), 0.2, damping=0.05)
/// >>> system
/// MassOnBelt(Polynomial(0.4, 0.25, 0.5), 0.2, damping=0.05, load=1.0)
/// >>> len(system.simulate((0.0, 0.0), 10.0).events)
/// 4
#[pyclass(frozen, name = "MassOnBelt", module = "stick_slip")]
pub struct PyBelt {
    pub system: Arc<dyn Belt>,
    law: Py<PyLaw>,
    belt_velocity: f64,
    damping: f64,
    load: f64,
}

/// A mass on a moving belt in SI units: kilograms, newtons, metres, seconds.
///
/// Args:
///     law: the friction law, over speeds in m/s.
///     mass: in kg, > 0.
///     stiffness: of the spring, in N/m, > 0.
///     normal_force: in N, > 0.
///     belt_velocity: in m/s, of either sign.
///     damping: of the damper, in N s/m, >= 0.
///
/// >>> from stick_slip import Exponential, PhysicalMassOnBelt
/// >>> brake = PhysicalMassOnBelt(Exponential(0.4, 0.25, 0.05), mass=2.0, stiffness=800.0,
/// ...     normal_force=20.0, belt_velocity=0.03, damping=1.0)
/// >>> motion = brake.simulate((0.0, 0.0), 1.0)
/// >>> motion.duration
/// 1.0
#[pyclass(frozen, name = "PhysicalMassOnBelt", module = "stick_slip")]
pub struct PyPhysicalBelt {
    pub system: Arc<dyn Belt>,
    law: Py<PyLaw>,
    scaling: Scaling,
}

/// Either class.
pub enum BeltArgument<'py> {
    Belt(Bound<'py, PyBelt>),
    Physical(Bound<'py, PyPhysicalBelt>),
}

impl<'a, 'py> FromPyObject<'a, 'py> for BeltArgument<'py> {
    type Error = PyErr;

    fn extract(object: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        if let Ok(belt) = object.cast::<PyBelt>() {
            return Ok(Self::Belt(belt.to_owned()));
        }
        if let Ok(belt) = object.cast::<PyPhysicalBelt>() {
            return Ok(Self::Physical(belt.to_owned()));
        }
        Err(PyTypeError::new_err(format!(
            "expected a MassOnBelt or a PhysicalMassOnBelt, not {}; the searches of a Structure \
             are settle, follow, classify, sweep and vibration_ranges",
            shown(&object)
        )))
    }
}

impl BeltArgument<'_> {
    pub fn system(&self) -> Arc<dyn Belt> {
        match self {
            Self::Belt(belt) => belt.get().system.clone(),
            Self::Physical(belt) => belt.get().system.clone(),
        }
    }
}

fn simulate(
    py: Python<'_>,
    system: &dyn Belt,
    start: State,
    duration: f64,
    settings: &Settings,
) -> PyResult<PyMotion> {
    let (motion, exception) = py.detach(|| {
        let waiting = Waiting::new();
        let integrator = settings.integrator();
        let motion = integrator.and_then(|integrator| {
            let mut stop = settings.stop(&waiting, |until, state: &State| {
                until.call1((state.displacement, state.velocity))
            });
            system.simulate_until(integrator, start, duration, &mut stop)
        });
        (motion, waiting.into_exception())
    });
    let motion = AnyMotion::Belt(Arc::new(motion.or_raise()?));
    if let Some(exception) = exception {
        exception
            .value(py)
            .setattr("found", PyMotion(motion).into_pyobject(py)?)?;
        return Err(exception);
    }
    ended_well(py, motion)
}

/// The methods of both classes.
macro_rules! belt_methods {
    ($class:ident { $($own:tt)* }) => {
        #[pymethods]
        impl $class {
            $($own)*

            /// The law.
            #[getter]
            fn law(&self, py: Python<'_>) -> Py<PyLaw> {
                self.law.clone_ref(py)
            }

            /// The least and the largest displacement at which the mass sticks.
            #[getter]
            fn stick_limits(&self) -> (f64, f64) {
                let [low, high] = self.system.stick_limits();
                (low, high)
            }

            /// The state (u, v) at which stick ends; None if it never does (a belt at rest).
            #[getter]
            fn release_state(&self) -> Option<(f64, f64)> {
                let state = self.system.release_state()?;
                Some((state.displacement, state.velocity))
            }

            /// Steady sliding and its stability; None on a belt at rest.
            #[getter]
            fn equilibrium(&self) -> Option<Equilibrium> {
                self.system.equilibrium().map(Equilibrium::from)
            }

            /// The friction force on the mass in a state (u, v), in units of force.
            fn friction_force(&self, state: BeltStart) -> f64 {
                self.system.friction_force(state.0)
            }

            /// The acceleration in a state (u, v), in units of velocity per time.
            fn acceleration(&self, state: BeltStart) -> f64 {
                self.system.acceleration(state.0)
            }

            /// This system as a `Structure` of one mass.
            fn structure(&self, py: Python<'_>) -> PyResult<PyStructure> {
                let made = self.made(py)?.then(py, "structure", ())?;
                let structure = self.system.structure().or_raise()?;
                Ok(PyStructure::of(structure, made))
            }

            fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
                self.made(py)?.text(py)
            }

            fn __reduce__<'py>(&self, py: Python<'py>) -> Reduced<'py> {
                self.made(py)?.reduced(py)
            }

            /// The motion from a start.
            ///
            /// Args:
            ///     start: (u, v), displacement and velocity, in the units of the system.
            ///     duration: in units of time, >= 0.
            ///     tolerance: of the integrator, 1e-16 to 1e-2, relative to the motion's scale;
            ///         round-off if it is None.
            ///     max_steps: largest number of integration steps.
            ///     max_events: largest number of events.
            ///     until: a function of (u, v), two numbers; the motion ends where its value
            ///         passes 0.
            ///
            /// Returns:
            ///     The Motion. KeyboardInterrupt and errors carry the motion so far as `found`.
            #[pyo3(signature = (start, duration, *, tolerance = None, max_steps = None,
                max_events = None, until = None))]
            #[allow(clippy::too_many_arguments)]
            fn simulate(
                &self,
                py: Python<'_>,
                start: BeltStart,
                duration: f64,
                tolerance: Option<f64>,
                max_steps: Option<usize>,
                max_events: Option<usize>,
                until: Option<Py<PyAny>>,
            ) -> PyResult<PyMotion> {
                let settings =
                    Settings { tolerance, max_steps, max_events, start_time: 0.0, until };
                simulate(py, &*self.system, start.0, duration, &settings)
            }
        }
    };
}

belt_methods!(PyBelt {
    #[new]
    #[pyo3(signature = (law, belt_velocity, *, damping = 0.0, load = 1.0))]
    fn new(
        law: LawArgument<'_>,
        belt_velocity: f64,
        damping: f64,
        load: f64,
    ) -> PyResult<Self> {
        let law = law.0.unbind();
        let system = law.get().kind.belt(belt_velocity, damping, load).or_raise()?;
        Ok(Self { system, law, belt_velocity, damping, load })
    }

    /// The belt velocity v_b, dimensionless.
    #[getter]
    fn belt_velocity(&self) -> f64 {
        self.belt_velocity
    }

    /// The damping ratio beta.
    #[getter]
    fn damping(&self) -> f64 {
        self.damping
    }

    /// The friction load gamma^2.
    #[getter]
    fn load(&self) -> f64 {
        self.load
    }

    /// A copy of this system with some numbers replaced.
    ///
    /// >>> from stick_slip import Coulomb, MassOnBelt
    /// >>> MassOnBelt(Coulomb(0.4, 0.25), 0.2).replace(load=2.0)
    /// MassOnBelt(Coulomb(0.4, 0.25), 0.2, damping=0.0, load=2.0)
    #[pyo3(signature = (*, belt_velocity = None, damping = None, load = None))]
    fn replace(
        &self,
        py: Python<'_>,
        belt_velocity: Option<f64>,
        damping: Option<f64>,
        load: Option<f64>,
    ) -> PyResult<Self> {
        Self::new(
            LawArgument(self.law.bind(py).clone()),
            belt_velocity.unwrap_or(self.belt_velocity),
            damping.unwrap_or(self.damping),
            load.unwrap_or(self.load),
        )
    }
});

impl PyBelt {
    fn made(&self, py: Python<'_>) -> PyResult<Made> {
        Made::by(py, "MassOnBelt", (&self.law, self.belt_velocity))?
            .with(py, "damping", self.damping)?
            .with(py, "load", self.load)
    }
}

belt_methods!(PyPhysicalBelt {
    #[new]
    #[pyo3(signature = (law, *, mass, stiffness, normal_force, belt_velocity, damping = 0.0))]
    fn new(
        law: LawArgument<'_>,
        mass: f64,
        stiffness: f64,
        normal_force: f64,
        belt_velocity: f64,
        damping: f64,
    ) -> PyResult<Self> {
        let law = law.0.unbind();
        let physical = Physical { mass, stiffness, damping, normal_force, belt_velocity };
        let system = law.get().kind.physical(physical).or_raise()?;
        let scaling = Scaling::new(physical).or_raise()?;
        Ok(Self { system, law, scaling })
    }

    /// The mass, in kg.
    #[getter]
    fn mass(&self) -> f64 {
        self.scaling.physical().mass
    }

    /// The stiffness of the spring, in N/m.
    #[getter]
    fn stiffness(&self) -> f64 {
        self.scaling.physical().stiffness
    }

    /// The damping constant, in N s/m.
    #[getter]
    fn damping(&self) -> f64 {
        self.scaling.physical().damping
    }

    /// The normal force, in N.
    #[getter]
    fn normal_force(&self) -> f64 {
        self.scaling.physical().normal_force
    }

    /// The belt velocity, in m/s.
    #[getter]
    fn belt_velocity(&self) -> f64 {
        self.scaling.physical().belt_velocity
    }

    /// This system without units, for the formulas of `analysis`: displacements in units of
    /// `length`, times in units of 1/`angular_frequency`, forces in units of the normal force.
    ///
    /// >>> from stick_slip import Exponential, PhysicalMassOnBelt
    /// >>> brake = PhysicalMassOnBelt(Exponential(0.4, 0.25, 0.05), mass=2.0, stiffness=800.0,
    /// ...     normal_force=20.0, belt_velocity=0.03, damping=1.0)
    /// >>> brake.dimensionless
    /// MassOnBelt(Scaled(Exponential(0.4, 0.25, 0.05), 0.5), 0.06, damping=0.0125, load=1.0)
    /// >>> brake.length, brake.angular_frequency
    /// (0.025, 20.0)
    #[getter]
    fn dimensionless(&self, py: Python<'_>) -> PyResult<PyBelt> {
        let (law, unit) = (self.law.bind(py).clone(), self.scaling.metres_per_second(1.0));
        let law = scaled(py, LawArgument(law), unit)?;
        // The numbers do not depend on the law.
        let any_law = Coulomb::new(0.0, 0.0).or_raise()?;
        let numbers = self.scaling.system(any_law).or_raise()?;
        PyBelt::new(
            LawArgument(Bound::new(py, law)?),
            numbers.belt_velocity(),
            numbers.damping(),
            numbers.load(),
        )
    }

    /// The unit of displacement of `dimensionless`, in m: the normal force over the stiffness.
    #[getter]
    fn length(&self) -> f64 {
        self.scaling.length()
    }

    /// The angular frequency of the mass on its spring, in rad/s.
    #[getter]
    fn angular_frequency(&self) -> f64 {
        self.scaling.angular_frequency()
    }

    /// The same system with other numbers, in SI units.
    #[pyo3(signature = (*, mass = None, stiffness = None, normal_force = None,
        belt_velocity = None, damping = None))]
    fn replace(
        &self,
        py: Python<'_>,
        mass: Option<f64>,
        stiffness: Option<f64>,
        normal_force: Option<f64>,
        belt_velocity: Option<f64>,
        damping: Option<f64>,
    ) -> PyResult<Self> {
        let own = self.scaling.physical();
        Self::new(
            LawArgument(self.law.bind(py).clone()),
            mass.unwrap_or(own.mass),
            stiffness.unwrap_or(own.stiffness),
            normal_force.unwrap_or(own.normal_force),
            belt_velocity.unwrap_or(own.belt_velocity),
            damping.unwrap_or(own.damping),
        )
    }
});

impl PyPhysicalBelt {
    fn made(&self, py: Python<'_>) -> PyResult<Made> {
        let own = self.scaling.physical();
        Made::by(py, "PhysicalMassOnBelt", (&self.law,))?
            .with(py, "mass", own.mass)?
            .with(py, "stiffness", own.stiffness)?
            .with(py, "normal_force", own.normal_force)?
            .with(py, "belt_velocity", own.belt_velocity)?
            .with(py, "damping", own.damping)
    }
}
