//! The formulas: `stick_slip.analysis`.

use std::cell::RefCell;

use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use stick_slip::analysis::{
    self, averaging, coulomb, design, drill_string, duffing, dwell, exponential, fast_vibration,
    forced, jenkins, lugre, mode_coupling, polynomial, rate_state,
};
use stick_slip::{AnyLaw, Coulomb, Dwell, Exponential, MassOnBelt, Polynomial, Scaled};

use crate::belt::PyBelt;
use crate::contact_law::{AnyContactLaw, AnyRateState, PyContactLaw, PyRateState, with_rate_state};
use crate::convert::{BeltStart, ComplexNumbers, Count, Numbers, elementwise};
use crate::error::OrRaise;
use crate::law::{Kind, Plain, PyLaw};
use crate::motion::criticality_name;
use crate::record::record;
use crate::traced::Traced;

/// Runs an expression with a dimensionless system of any kind of law.
macro_rules! with_system {
    ($belt:expr, $system:ident => $result:expr) => {{
        let any = $belt.system.any();
        if let Some($system) = any.downcast_ref::<MassOnBelt<AnyLaw>>() {
            Ok($result)
        } else if let Some($system) = any.downcast_ref::<MassOnBelt<Traced>>() {
            Ok($result)
        } else if let Some($system) = any.downcast_ref::<MassOnBelt<Scaled<AnyLaw>>>() {
            Ok($result)
        } else {
            Err(PyTypeError::new_err("expected a MassOnBelt"))
        }
    }};
}

/// The system with the type of one law, for formulas that are of this law only.
fn of_law<L: stick_slip::FrictionLaw>(
    belt: &PyBelt,
    name: &str,
    pick: impl Fn(&AnyLaw) -> Option<L>,
) -> PyResult<MassOnBelt<L>> {
    let system = belt.system.any().downcast_ref::<MassOnBelt<AnyLaw>>();
    let law = system.and_then(|system| Some((system, pick(system.law())?)));
    let (system, law) =
        law.ok_or_else(|| PyTypeError::new_err(format!("this formula is that of the law {name}")))?;
    let system = MassOnBelt::new(law, system.belt_velocity())
        .and_then(|it| it.with_damping(system.damping())?.with_load(system.load()));
    system.or_raise()
}

fn of_coulomb(belt: &PyBelt) -> PyResult<MassOnBelt<Coulomb>> {
    of_law(belt, "Coulomb", |law| match law {
        AnyLaw::Coulomb(law) => Some(*law),
        _ => None,
    })
}

fn of_exponential(belt: &PyBelt) -> PyResult<MassOnBelt<Exponential>> {
    of_law(belt, "Exponential", |law| match law {
        AnyLaw::Exponential(law) => Some(*law),
        _ => None,
    })
}

fn of_polynomial(belt: &PyBelt) -> PyResult<MassOnBelt<Polynomial>> {
    of_law(belt, "Polynomial", |law| match law {
        AnyLaw::Polynomial(law) => Some(*law),
        _ => None,
    })
}

record! {
    in "stick_slip.analysis":
    /// A cycle of the averaged equation; dimensionless.
    AveragedCycle {
        /// The amplitude of displacement and velocity.
        amplitude: f64,
        /// The slope of the drift there: the growth rate of perturbations.
        drift_slope: f64,
        /// The Floquet multiplier.
        multiplier: f64,
        /// True if neighbouring motions approach the cycle.
        is_stable: bool,
        /// Time in each cycle in which the mass is faster than the belt.
        leading_duration: f64,
        /// True if the motion never sticks, so that averaging describes it.
        is_valid: bool,
    }
}

/// The drift A' of the amplitude A by the method of averaging; dimensionless.
///
/// >>> from stick_slip import MassOnBelt, Polynomial, analysis
/// >>> system = MassOnBelt(Polynomial(0.4, 0.25, 0.5), 0.42, damping=0.05)
/// >>> round(analysis.drift(system, 0.1), 12)
/// 0.001399
#[pyfunction]
pub fn drift(system: &PyBelt, amplitude: f64) -> PyResult<f64> {
    with_system!(system, system => averaging::drift(system, amplitude).or_raise()?)
}

/// The slope dA'/dA of the drift; dimensionless.
#[pyfunction]
pub fn drift_slope(system: &PyBelt, amplitude: f64) -> PyResult<f64> {
    with_system!(system, system => averaging::drift_slope(system, amplitude).or_raise()?)
}

/// The cycles by the method of averaging, by ascending amplitude.
#[pyfunction]
pub fn averaged_cycles(system: &PyBelt) -> PyResult<Vec<AveragedCycle>> {
    let cycles: Vec<averaging::AveragedCycle> =
        with_system!(system, system => averaging::cycles(system).or_raise()?)?;
    let cycle = |cycle: &averaging::AveragedCycle| AveragedCycle {
        amplitude: cycle.amplitude(),
        drift_slope: cycle.drift_slope(),
        multiplier: cycle.multiplier(),
        is_stable: cycle.is_stable(),
        leading_duration: cycle.leading_duration(),
        is_valid: cycle.is_valid(),
    };
    Ok(cycles.iter().map(cycle).collect())
}

/// The least damping ratio at which steady sliding is stable: at the system's own belt velocity
/// (None on a belt at rest), or at all belt velocities of a range.
#[pyfunction]
#[pyo3(signature = (system, low = None, high = None))]
pub fn stabilizing_damping(
    system: &PyBelt,
    low: Option<f64>,
    high: Option<f64>,
) -> PyResult<Option<f64>> {
    match (low, high) {
        (None, None) => with_system!(system, system => design::stabilizing_damping(system)),
        (Some(low), Some(high)) => {
            with_system!(system, system => {
                Some(design::stabilizing_damping_over(system, low..high).or_raise()?)
            })
        }
        _ => Err(PyValueError::new_err("give both low and high, or neither")),
    }
}

/// The kind of motion by the formulas of the source paper, for a system with the law Polynomial:
/// "rest", "steady sliding", "pure slip" or "stick-slip".
#[pyfunction]
pub fn regime(system: &PyBelt) -> PyResult<String> {
    Ok(analysis::regime(&of_polynomial(system)?).to_string())
}

/// The least damping ratio without vibration at any belt velocity, for the laws Coulomb,
/// Exponential and Polynomial.
#[pyfunction]
pub fn silencing_damping_everywhere(system: &PyBelt) -> PyResult<f64> {
    if let Ok(system) = of_coulomb(system) {
        return Ok(coulomb::silencing_damping_everywhere(&system));
    }
    if let Ok(system) = of_exponential(system) {
        return Ok(exponential::silencing_damping_everywhere(&system));
    }
    let system = of_law(
        system,
        "Coulomb, Exponential or Polynomial",
        |law| match law {
            AnyLaw::Polynomial(law) => Some(*law),
            _ => None,
        },
    )?;
    Ok(polynomial::silencing_damping_everywhere(&system))
}

/// The belt velocity above which nothing vibrates, for the laws Coulomb, Exponential and
/// Polynomial; None if the formula has no answer.
#[pyfunction]
pub fn quiet_velocity(system: &PyBelt) -> PyResult<Option<f64>> {
    if let Ok(system) = of_coulomb(system) {
        return Ok(Some(coulomb::quiet_velocity(&system)));
    }
    if let Ok(system) = of_exponential(system) {
        return Ok(exponential::quiet_velocity(&system));
    }
    let system = of_law(
        system,
        "Coulomb, Exponential or Polynomial",
        |law| match law {
            AnyLaw::Polynomial(law) => Some(*law),
            _ => None,
        },
    )?;
    Ok(polynomial::quiet_velocity(&system))
}

/// The two Hopf velocities of the law Exponential with their criticality, exact; None if there are
/// none: steady sliding is stable at every belt velocity or, without damping, at none.
#[pyfunction]
pub fn exponential_hopf_velocities(system: &PyBelt) -> PyResult<Option<[(f64, &'static str); 2]>> {
    let found = exponential::hopf_velocities(&of_exponential(system)?);
    Ok(found.map(|pair| pair.map(|(velocity, kind)| (velocity, criticality_name(kind)))))
}

record! {
    in "stick_slip.analysis":
    /// A stick-slip cycle in closed form.
    ExactCycle {
        /// The belt velocity.
        belt_velocity: f64,
        /// Time in stick.
        stick_duration: f64,
        /// Time in slip.
        slip_duration: f64,
        /// The period.
        period: f64,
        /// Displacement at the release.
        release_displacement: f64,
        /// Displacement at the end of slip.
        contact_displacement: f64,
        /// Half the range of displacements.
        amplitude: f64,
        /// Largest sliding speed.
        max_sliding_speed: f64,
        /// The Floquet multiplier.
        multiplier: f64,
        /// True if the cycle attracts.
        is_stable: bool,
    }
}

impl From<dwell::ExactCycle> for ExactCycle {
    fn from(cycle: dwell::ExactCycle) -> Self {
        Self {
            belt_velocity: cycle.belt_velocity,
            stick_duration: cycle.stick_duration,
            slip_duration: cycle.slip_duration,
            period: cycle.period(),
            release_displacement: cycle.release_displacement,
            contact_displacement: cycle.contact_displacement,
            amplitude: cycle.amplitude,
            max_sliding_speed: cycle.max_sliding_speed,
            multiplier: cycle.multiplier,
            is_stable: cycle.is_stable(),
        }
    }
}

record! {
    in "stick_slip.analysis":
    /// A slip phase of Coulomb's law that ends where the mass reaches the belt velocity
    /// tangentially; dimensionless.
    TangentialSlip {
        /// The duration of slip.
        duration: f64,
        /// The belt velocity in units of load times (static - kinetic coefficient).
        velocity_factor: f64,
    }
}

/// The tangential slip of Coulomb's law at a damping ratio; None unless 0 < damping < 1.
#[pyfunction]
pub fn tangential_slip(damping: f64) -> Option<TangentialSlip> {
    let slip = coulomb::tangential_slip(damping)?;
    Some(TangentialSlip {
        duration: slip.duration,
        velocity_factor: slip.velocity_factor,
    })
}

/// The largest belt velocity with stick-slip, for Coulomb's law.
#[pyfunction]
pub fn largest_stick_slip_velocity(system: &PyBelt) -> PyResult<f64> {
    Ok(coulomb::largest_stick_slip_velocity(&of_coulomb(system)?))
}

/// The least damping ratio without stick-slip, for Coulomb's law, in closed form.
#[pyfunction]
pub fn coulomb_silencing_damping(system: &PyBelt) -> PyResult<Option<f64>> {
    Ok(coulomb::silencing_damping(&of_coulomb(system)?))
}

/// The stick-slip cycle of Coulomb's law in closed form; None if there is none.
///
/// >>> from stick_slip import Coulomb, MassOnBelt, analysis
/// >>> analysis.coulomb_stick_slip(MassOnBelt(Coulomb(0.4, 0.25), 0.1)).stick_duration
/// 3.0
#[pyfunction]
pub fn coulomb_stick_slip(system: &PyBelt) -> PyResult<Option<ExactCycle>> {
    Ok(coulomb::stick_slip(&of_coulomb(system)?).map(ExactCycle::from))
}

record! {
    in "stick_slip.analysis":
    /// The free vibration of a mass with Coulomb friction on a belt at rest; dimensionless, exact.
    FreeVibration {
        /// Loss of amplitude in each cycle.
        amplitude_loss: f64,
        /// The displacement at which the mass comes to rest; None if it never does.
        rest_position: Option<f64>,
        /// The time at which it comes to rest; None if it never does.
        rest_time: Option<f64>,
        /// Times of the turning points, at most 10000 of them.
        times: Numbers,
        /// Displacements of the turning points.
        displacements: Numbers,
    }
}

/// The free vibration from a state (u, v); None unless the belt is at rest and nothing is damped.
#[pyfunction]
pub fn free_vibration(system: &PyBelt, start: BeltStart) -> PyResult<Option<FreeVibration>> {
    let found = coulomb::FreeVibration::new(&of_coulomb(system)?, start.0);
    Ok(found.map(|motion| {
        let (times, displacements) = motion.turning_points().take(10_000).unzip();
        FreeVibration {
            amplitude_loss: motion.amplitude_loss(),
            rest_position: motion.rest_position(),
            rest_time: motion.rest_time(),
            times: Numbers(times),
            displacements: Numbers(displacements),
        }
    }))
}

record! {
    in "stick_slip.analysis":
    /// A drill string of two inertias whose drive is damped.
    TwoInertias {
        /// The upper moment of inertia, in kg m^2 for example.
        upper: f64,
        /// The lower moment of inertia.
        lower: f64,
        /// The stiffness of the shaft, in N m for example.
        stiffness: f64,
        /// The damping of the drive, in N m s for example.
        damping: f64,
    }

    #[new]
    #[pyo3(signature = (*, upper, lower, stiffness, damping))]
    fn new(upper: f64, lower: f64, stiffness: f64, damping: f64) -> Self {
        Self { upper, lower, stiffness, damping }
    }

    /// True if steady rotation is stable at this slope of the friction torque.
    fn is_stable(&self, slope: f64) -> bool {
        self.formula().is_stable(slope)
    }

    /// The slope above which steady rotation is stable; None unless all numbers are positive.
    #[getter]
    fn critical_slope(&self) -> Option<f64> {
        self.formula().critical_slope()
    }

    /// The damping of the drive that is best against torsional vibration.
    #[getter]
    fn best_damper(&self) -> f64 {
        self.formula().best_damper()
    }
}

impl TwoInertias {
    fn formula(&self) -> drill_string::TwoInertias {
        let Self {
            upper,
            lower,
            stiffness,
            damping,
        } = *self;
        drill_string::TwoInertias {
            upper,
            lower,
            stiffness,
            damping,
        }
    }
}

/// The exact period of a free Duffing oscillator; None if the motion does not swing through 0.
///
/// >>> from stick_slip import analysis
/// >>> round(analysis.duffing_period(1.0, 1.0, 0.7, 2.0), 14)
/// 3.60371265616818
#[pyfunction]
pub fn duffing_period(mass: f64, stiffness: f64, cubic: f64, amplitude: f64) -> Option<f64> {
    duffing::period(mass, stiffness, cubic, amplitude)
}

/// The turning points (times, displacements) of a Duffing oscillator with dry friction, at most
/// `count` of them; None if the arguments are out of range.
#[pyfunction]
#[pyo3(
    signature = (
        mass, stiffness, cubic, kinetic_friction, static_friction, start, *, count = Count(1000)
    ),
    text_signature = "(mass, stiffness, cubic, kinetic_friction, static_friction, start, *, \
                      count=1000)"
)]
pub fn duffing_friction_decay(
    mass: f64,
    stiffness: f64,
    cubic: f64,
    kinetic_friction: f64,
    static_friction: f64,
    start: f64,
    count: Count,
) -> Option<(Numbers, Numbers)> {
    let turns = duffing::friction_decay(
        mass,
        stiffness,
        cubic,
        kinetic_friction,
        static_friction,
        start,
    )?;
    let (times, displacements) = turns.take(count.0).unzip();
    Some((Numbers(times), Numbers(displacements)))
}

record! {
    in "stick_slip.analysis":
    /// A response of a Duffing oscillator with friction by first-harmonic theory.
    DuffingResponse {
        /// Amplitude of the first harmonic, in units of displacement.
        amplitude: f64,
        /// Estimate of the amplitude of the third harmonic.
        third_harmonic: f64,
        /// Estimate of the error of the amplitude.
        error: f64,
    }
}

/// The responses of a Duffing oscillator with dry friction to a harmonic force.
#[pyfunction]
pub fn duffing_response(
    mass: f64,
    damping: f64,
    stiffness: f64,
    cubic: f64,
    friction: f64,
    force: f64,
    angular_frequency: f64,
) -> Vec<DuffingResponse> {
    let found = duffing::response(
        mass,
        damping,
        stiffness,
        cubic,
        friction,
        force,
        angular_frequency,
    );
    let response = |found: duffing::Response| DuffingResponse {
        amplitude: found.amplitude,
        third_harmonic: found.third_harmonic,
        error: found.error,
    };
    found.into_iter().map(response).collect()
}

/// A mass on a belt whose static friction rises with the time in stick: closed formulas.
///
/// Args:
///     law: Dwell of a Coulomb law.
///     mass, stiffness, damping, load: in consistent units.
///
/// >>> from stick_slip import Coulomb, Dwell, analysis
/// >>> law = Dwell(Coulomb(0.3, 0.3), rate=0.02, time=1.0)
/// >>> analysis.DwellOscillator(law, mass=1.0, stiffness=1.0, load=1.0).critical_velocity
/// 0.04
#[pyclass(frozen, name = "DwellOscillator", module = "stick_slip.analysis")]
pub struct DwellOscillator(dwell::DwellOscillator);

#[pymethods]
impl DwellOscillator {
    #[new]
    #[pyo3(signature = (law, *, mass, stiffness, load, damping = 0.0))]
    fn new(
        law: &PyContactLaw,
        mass: f64,
        stiffness: f64,
        load: f64,
        damping: f64,
    ) -> PyResult<Self> {
        let law: Option<Dwell<Coulomb>> = law.dwell_of_coulomb().transpose()?;
        let law =
            law.ok_or_else(|| PyTypeError::new_err("the law must be Dwell(Coulomb(...), ...)"))?;
        Ok(Self(dwell::DwellOscillator {
            law,
            mass,
            stiffness,
            damping,
            load,
        }))
    }

    /// The belt velocity below which there is stick-slip without damping; None with damping.
    #[getter]
    fn critical_velocity(&self) -> Option<f64> {
        self.0.critical_velocity()
    }

    /// The stable stick-slip cycle at a belt velocity; None if there is none.
    fn stick_slip(&self, velocity: f64) -> Option<ExactCycle> {
        self.0.stick_slip(velocity).map(ExactCycle::from)
    }

    /// The unstable stick-slip cycle at a belt velocity; None if there is none.
    fn unstable_stick_slip(&self, velocity: f64) -> Option<ExactCycle> {
        self.0.unstable_stick_slip(velocity).map(ExactCycle::from)
    }

    /// The cycle at the largest belt velocity with stick-slip; None without damping.
    #[getter]
    fn fold(&self) -> Option<ExactCycle> {
        self.0.fold().map(ExactCycle::from)
    }

    /// The belt velocity down to which the unstable cycle exists.
    #[getter]
    fn grazing_velocity(&self) -> Option<f64> {
        self.0.grazing_velocity()
    }

    fn __repr__(&self) -> String {
        let dwell::DwellOscillator {
            mass,
            stiffness,
            damping,
            load,
            ..
        } = &self.0;
        format!(
            "DwellOscillator(mass={mass:?}, stiffness={stiffness:?}, load={load:?}, \
             damping={damping:?})"
        )
    }
}

/// The mean friction coefficient under a fast vibration of a velocity amplitude, for Coulomb's law.
#[pyfunction]
pub fn mean_coefficient(law: &PyLaw, velocity: f64, amplitude: f64) -> PyResult<f64> {
    match &law.kind {
        Kind::Plain(Plain::Named(AnyLaw::Coulomb(law))) => {
            Ok(fast_vibration::mean_coefficient(law, velocity, amplitude))
        }
        _ => Err(PyTypeError::new_err(
            "this formula is that of the law Coulomb",
        )),
    }
}

/// The belt velocity below which, down to `amplitude`, steady sliding is unstable under a fast
/// vibration of this velocity amplitude, for the law Polynomial; None if there is none.
#[pyfunction]
pub fn onset_velocity(system: &PyBelt, amplitude: f64) -> PyResult<Option<f64>> {
    Ok(fast_vibration::onset_velocity(
        &of_polynomial(system)?,
        amplitude,
    ))
}

record! {
    in "stick_slip.analysis":
    /// Den Hartog's forced oscillator with dry friction; mass and stiffness are 1.
    ForcedOscillator {
        /// The damping ratio, 0 <= damping < 1.
        damping: f64,
        /// The angular frequency of the force, in units of the natural frequency.
        angular_frequency: f64,
        /// The kinetic friction force.
        kinetic_friction: f64,
        /// The largest static friction force.
        static_friction: f64,
        /// The amplitude of the harmonic force.
        force: f64,
    }

    #[new]
    #[pyo3(signature = (*, damping, angular_frequency, kinetic_friction, static_friction, force))]
    fn new(
        damping: f64,
        angular_frequency: f64,
        kinetic_friction: f64,
        static_friction: f64,
        force: f64,
    ) -> Self {
        Self { damping, angular_frequency, kinetic_friction, static_friction, force }
    }

    /// The periodic motion without stops; None if the mass stops.
    ///
    /// >>> from stick_slip import analysis
    /// >>> oscillator = analysis.ForcedOscillator(damping=0.05, angular_frequency=0.8,
    /// ...     kinetic_friction=0.3, static_friction=0.3, force=1.0)
    /// >>> round(oscillator.without_stops().amplitude, 12)
    /// 2.346871967422
    fn without_stops(&self) -> Option<WithoutStops> {
        let Self { damping, angular_frequency, kinetic_friction, static_friction, force } = *self;
        let oscillator = forced::ForcedOscillator {
            damping,
            angular_frequency,
            kinetic_friction,
            static_friction,
            force,
        };
        oscillator.without_stops().map(WithoutStops)
    }
}

/// The periodic motion of a ForcedOscillator without stops, exact.
#[pyclass(frozen, module = "stick_slip.analysis")]
pub struct WithoutStops(forced::WithoutStops);

#[pymethods]
impl WithoutStops {
    /// The largest displacement.
    #[getter]
    fn amplitude(&self) -> f64 {
        self.0.amplitude()
    }

    /// The phase of the force at the largest displacement, in radians.
    #[getter]
    fn phase(&self) -> f64 {
        self.0.phase()
    }

    /// The period.
    #[getter]
    fn period(&self) -> f64 {
        self.0.period()
    }

    /// Displacement and velocity at a time after the largest displacement.
    fn at(&self, time: f64) -> (f64, f64) {
        self.0.at(time)
    }

    fn __repr__(&self) -> String {
        format!(
            "WithoutStops(amplitude={:?}, phase={:?})",
            self.0.amplitude(),
            self.0.phase()
        )
    }
}

/// The largest friction, in units of the force amplitude, with which an undamped forced oscillator
/// does not stop; None if the frequency is not positive.
#[pyfunction]
pub fn no_stop_limit(angular_frequency: f64) -> Option<f64> {
    forced::no_stop_limit(angular_frequency)
}

/// The heat of a Jenkins element in a cycle; nan unless all numbers are positive.
///
/// >>> from stick_slip import analysis
/// >>> analysis.loop_area(2.0, 3.0, 5.0)
/// 42.0
#[pyfunction]
pub fn loop_area(tangential_stiffness: f64, limit: f64, amplitude: f64) -> f64 {
    jenkins::loop_area(tangential_stiffness, limit, amplitude)
}

/// The first harmonic of a Jenkins element: equivalent stiffness and damping, and heat in a cycle.
#[pyfunction]
pub fn first_harmonic(
    tangential_stiffness: f64,
    limit: f64,
    amplitude: f64,
    angular_frequency: f64,
) -> (f64, f64, f64) {
    jenkins::first_harmonic(tangential_stiffness, limit, amplitude, angular_frequency)
}

record! {
    in "stick_slip.analysis":
    /// A point of a backbone curve.
    Backbone {
        /// The angular frequency, in radians per unit of time.
        angular_frequency: f64,
        /// The damping ratio.
        damping_ratio: f64,
    }
}

/// The backbone curve of a mass with a Jenkins element at an amplitude; None out of range.
#[pyfunction]
pub fn backbone(
    mass: f64,
    damping: f64,
    stiffness: f64,
    tangential_stiffness: f64,
    limit: f64,
    amplitude: f64,
) -> Option<Backbone> {
    let point = jenkins::backbone(
        mass,
        damping,
        stiffness,
        tangential_stiffness,
        limit,
        amplitude,
    )?;
    Some(Backbone {
        angular_frequency: point.angular_frequency,
        damping_ratio: point.damping_ratio,
    })
}

/// The forces of a joint along a history of displacements by Masing's rules.
///
/// Args:
///     backbone: a function: the force at first loading to a displacement of either sign; odd.
///     displacements: the turning points and points between them.
///
/// >>> from stick_slip import analysis
/// >>> analysis.masing(lambda x: max(-3.0, min(3.0, 2.0 * x)), [0.0, 5.0, 2.0, -5.0])
/// array([ 0.,  3., -3., -3.])
#[pyfunction]
pub fn masing(backbone: &Bound<'_, PyAny>, displacements: Numbers) -> PyResult<Option<Numbers>> {
    let exception = RefCell::new(None);
    let force = |x: f64| {
        let value = backbone
            .call1((x,))
            .and_then(|value| value.extract::<f64>());
        value.unwrap_or_else(|error| {
            exception.borrow_mut().get_or_insert(error);
            f64::NAN
        })
    };
    let forces = jenkins::masing(force, &displacements.0);
    match exception.into_inner() {
        Some(exception) => Err(exception),
        None => Ok(forces.map(Numbers)),
    }
}

record! {
    in "stick_slip.analysis":
    /// The forced response of a mass with a Jenkins element, exact.
    SymmetricResponse {
        /// The largest displacement.
        amplitude: f64,
        /// The time from a turning point until the slider moves.
        elastic_time: f64,
        /// The phase of the force at the turning point, in radians.
        phase: f64,
        /// The three Floquet multipliers.
        multipliers: ComplexNumbers,
    }
}

/// The forced response of a mass with damper, spring and Jenkins element; None if it has more than
/// two turning points in a period, is unbounded, or a number is out of range.
#[pyfunction]
pub fn symmetric_response(
    mass: f64,
    damping: f64,
    stiffness: f64,
    tangential_stiffness: f64,
    limit: f64,
    force: f64,
    angular_frequency: f64,
) -> Option<SymmetricResponse> {
    let found = jenkins::SymmetricResponse::at(
        mass,
        damping,
        stiffness,
        tangential_stiffness,
        limit,
        force,
        angular_frequency,
    )?;
    Some(SymmetricResponse {
        amplitude: found.amplitude,
        elastic_time: found.elastic_time,
        phase: found.phase,
        multipliers: ComplexNumbers(found.multipliers.to_vec()),
    })
}

record! {
    in "stick_slip.analysis":
    /// Bristles in steady sliding.
    SteadyBristles {
        /// The deflection of the bristles, in units of length.
        deflection: f64,
        /// The friction coefficient.
        coefficient: f64,
        /// The rate at which a perturbation decays, per unit of time.
        rate: f64,
    }
}

/// The bristles of a LuGre law in steady sliding; None if they have no steady deflection.
#[pyfunction]
pub fn steady_bristles(law: &PyContactLaw, velocity: f64) -> PyResult<Option<SteadyBristles>> {
    let found = match law.law() {
        AnyContactLaw::LuGreNamed(law) => lugre::steady_bristles(law, velocity),
        AnyContactLaw::LuGreTraced(law) => lugre::steady_bristles(law, velocity),
        _ => {
            return Err(PyTypeError::new_err(
                "this formula is that of the law LuGre",
            ));
        }
    };
    Ok(found.map(|it| SteadyBristles {
        deflection: it.deflection,
        coefficient: it.coefficient,
        rate: it.rate,
    }))
}

record! {
    in "stick_slip.analysis":
    /// The small vibration of a mass on bristles.
    ContactVibration {
        /// The angular frequency without damping, in radians per unit of time.
        angular_frequency: f64,
        /// The damping ratio.
        damping_ratio: f64,
    }
}

/// The small vibration of a mass on the bristles of a LuGre law; None out of range.
#[pyfunction]
#[pyo3(signature = (law, *, mass, load, stiffness = 0.0, damping = 0.0))]
pub fn contact_vibration(
    law: &PyContactLaw,
    mass: f64,
    load: f64,
    stiffness: f64,
    damping: f64,
) -> PyResult<Option<ContactVibration>> {
    let found = match law.law() {
        AnyContactLaw::LuGreNamed(law) => {
            lugre::contact_vibration(law, mass, load, stiffness, damping)
        }
        AnyContactLaw::LuGreTraced(law) => {
            lugre::contact_vibration(law, mass, load, stiffness, damping)
        }
        _ => {
            return Err(PyTypeError::new_err(
                "this formula is that of the law LuGre",
            ));
        }
    };
    Ok(found.map(|it| ContactVibration {
        angular_frequency: it.angular_frequency,
        damping_ratio: it.damping_ratio,
    }))
}

/// The viscous coefficient from which on a LuGre law dissipates at all speeds up to one.
#[pyfunction]
pub fn passive_viscosity(law: &PyContactLaw, max_speed: f64) -> PyResult<f64> {
    match law.law() {
        AnyContactLaw::LuGreNamed(law) => lugre::passive_viscosity(law, max_speed).or_raise(),
        AnyContactLaw::LuGreTraced(law) => lugre::passive_viscosity(law, max_speed).or_raise(),
        _ => Err(PyTypeError::new_err(
            "this formula is that of the law LuGre",
        )),
    }
}

record! {
    in "stick_slip.analysis":
    /// The point at which steady sliding begins to flutter.
    Flutter {
        /// The friction coefficient above which it does.
        coefficient: f64,
        /// The angular frequency, in radians per unit of time.
        angular_frequency: f64,
    }
}

/// The onset of flutter in steady sliding of two coupled coordinates (Hoffmann, Gaul); None if
/// there is no flutter.
///
/// Args:
///     masses: (m1, m2).
///     stiffness: ((k11, k12), (k21, k22)) without friction.
///     normal_stiffness: increase of the load by the second coordinate.
///     damping: (c1, c2).
#[pyfunction]
#[pyo3(signature = (*, masses, stiffness, normal_stiffness, damping = [0.0, 0.0]))]
pub fn mode_coupling_flutter(
    masses: [f64; 2],
    stiffness: [[f64; 2]; 2],
    normal_stiffness: f64,
    damping: [f64; 2],
) -> Option<Flutter> {
    let model = mode_coupling::ModeCoupling {
        masses,
        stiffness,
        normal_stiffness,
        damping,
    };
    let flutter = model.flutter()?;
    Some(Flutter {
        coefficient: flutter.coefficient,
        angular_frequency: flutter.angular_frequency,
    })
}

record! {
    in "stick_slip.analysis":
    /// A pure-slip cycle by an expansion; dimensionless.
    PureSlipCycle {
        /// Largest displacement.
        u_max: f64,
        /// Least displacement.
        u_min: f64,
        /// Mean displacement.
        u_mean: f64,
        /// Largest distance from the equilibrium upwards.
        z_max: f64,
        /// Largest distance from the equilibrium downwards (negative).
        z_min: f64,
        /// Mean distance from the equilibrium.
        z_mean: f64,
        /// Largest velocity.
        v_max: f64,
        /// Least velocity.
        v_min: f64,
        /// Half the range of displacements.
        amplitude: f64,
        /// The angular frequency.
        frequency: f64,
        /// The period.
        period: f64,
        /// The Floquet multiplier.
        multiplier: f64,
        /// The logarithm of the multiplier.
        log_multiplier: f64,
        /// Amplitudes of the first three harmonics.
        harmonics: Numbers,
    }
}

impl From<analysis::PureSlipCycle> for PureSlipCycle {
    fn from(cycle: analysis::PureSlipCycle) -> Self {
        Self {
            u_max: cycle.u_max,
            u_min: cycle.u_min,
            u_mean: cycle.u_mean,
            z_max: cycle.z_max,
            z_min: cycle.z_min,
            z_mean: cycle.z_mean,
            v_max: cycle.v_max,
            v_min: cycle.v_min,
            amplitude: cycle.amplitude,
            frequency: cycle.frequency,
            period: cycle.period,
            multiplier: cycle.multiplier,
            log_multiplier: cycle.log_multiplier,
            harmonics: Numbers(cycle.harmonics.to_vec()),
        }
    }
}

/// The formulas of Farshidianfar and Noei Aghaee for pure slip, corrected, with expansions beyond
/// them; for the law Polynomial, dimensionless.
///
/// >>> from stick_slip import MassOnBelt, Polynomial, analysis
/// >>> system = MassOnBelt(Polynomial(0.4, 0.25, 0.5), 0.42, damping=0.05)
/// >>> round(analysis.PureSlip(system).onset_velocity, 10)
/// 0.4409585518
#[pyclass(frozen, module = "stick_slip.analysis")]
pub struct PureSlip(analysis::PureSlip);

#[pymethods]
impl PureSlip {
    #[new]
    fn new(system: &PyBelt) -> PyResult<Self> {
        let found = analysis::PureSlip::new(&of_polynomial(system)?);
        found.map(Self).ok_or_else(|| {
            let why = "the belt is at rest, or a coefficient of the formulas is beyond floats";
            PyValueError::new_err(why)
        })
    }

    /// The strength of friction, Eq. 11.
    #[getter]
    fn eta(&self) -> f64 {
        self.0.eta()
    }

    /// The linear coefficient, Eq. 10a.
    #[getter]
    fn h1(&self) -> f64 {
        self.0.h1()
    }

    /// The quadratic coefficient, Eq. 10b, corrected.
    #[getter]
    fn h2(&self) -> f64 {
        self.0.h2()
    }

    /// The cubic coefficient, Eq. 10c.
    #[getter]
    fn h3(&self) -> f64 {
        self.0.h3()
    }

    /// The belt velocity below which steady sliding is unstable; None if it is always stable.
    #[getter]
    fn onset_velocity(&self) -> Option<f64> {
        self.0.onset_velocity()
    }

    /// The belt velocity below which the mass sticks, by averaging.
    #[getter]
    fn stick_velocity(&self) -> Option<f64> {
        self.0.stick_velocity()
    }

    /// The belt velocity below which the mass sticks, by an expansion of higher order.
    #[getter]
    fn grazing_velocity(&self) -> Option<f64> {
        self.0.grazing_velocity()
    }

    /// The amplitude A0, Eq. 15; None where there is no vibration.
    #[getter]
    fn amplitude(&self) -> Option<f64> {
        self.0.amplitude()
    }

    /// True if the formulas describe the motion.
    #[getter]
    fn is_valid(&self) -> bool {
        self.0.is_valid()
    }

    /// The state (u, v) of a transient by averaging at a time; None where it is not defined.
    ///
    /// Args:
    ///     initial_amplitude: > 0.
    ///     initial_phase: in radians.
    ///     time: dimensionless.
    fn transient(
        &self,
        initial_amplitude: f64,
        initial_phase: f64,
        time: f64,
    ) -> PyResult<Option<(f64, f64)>> {
        let transient = self
            .0
            .transient(initial_amplitude, initial_phase)
            .or_raise()?;
        Ok(transient
            .state(time)
            .map(|state| (state.displacement, state.velocity)))
    }

    /// The cycle to first order; None where there is none.
    fn first_order(&self) -> Option<PureSlipCycle> {
        self.0.first_order().map(PureSlipCycle::from)
    }

    /// The cycle to second order; None where there is none.
    fn second_order(&self) -> Option<PureSlipCycle> {
        self.0.second_order().map(PureSlipCycle::from)
    }

    /// The cycle to third order; None where there is none.
    fn third_order(&self) -> Option<PureSlipCycle> {
        self.0.third_order().map(PureSlipCycle::from)
    }

    /// The cycle to fourth order; None where there is none.
    fn fourth_order(&self) -> Option<PureSlipCycle> {
        self.0.fourth_order().map(PureSlipCycle::from)
    }

    fn __repr__(&self) -> String {
        format!(
            "<PureSlip eta = {:?}, h1 = {:?}>",
            self.0.eta(),
            self.0.h1()
        )
    }
}

record! {
    in "stick_slip.analysis":
    /// A stick-slip cycle by an expansion; dimensionless.
    StickSlipCycle {
        /// Largest displacement.
        u_max: f64,
        /// Least displacement.
        u_min: f64,
        /// Largest distance from the equilibrium upwards.
        z_max: f64,
        /// Largest distance from the equilibrium downwards (negative).
        z_min: f64,
        /// Largest velocity.
        v_max: f64,
        /// Least velocity.
        v_min: f64,
        /// Duration of stick.
        stick: f64,
        /// Duration of slip.
        slip: f64,
        /// The period.
        period: f64,
        /// The growth in a slip phase.
        growth: f64,
        /// The phase by which slip is shorter than a free vibration, in radians.
        return_angle: f64,
    }
}

impl From<analysis::StickSlipCycle> for StickSlipCycle {
    fn from(cycle: analysis::StickSlipCycle) -> Self {
        Self {
            u_max: cycle.u_max,
            u_min: cycle.u_min,
            z_max: cycle.z_max,
            z_min: cycle.z_min,
            v_max: cycle.v_max,
            v_min: cycle.v_min,
            stick: cycle.stick,
            slip: cycle.slip,
            period: cycle.period,
            growth: cycle.growth,
            return_angle: cycle.return_angle,
        }
    }
}

/// The formulas of Farshidianfar and Noei Aghaee for stick-slip, with expansions beyond them;
/// dimensionless.
#[pyclass(frozen, module = "stick_slip.analysis")]
pub struct StickSlip(analysis::StickSlip);

#[pymethods]
impl StickSlip {
    #[new]
    fn new(system: &PyBelt) -> PyResult<Self> {
        let found: Option<analysis::StickSlip> =
            with_system!(system, system => analysis::StickSlip::new(system))?;
        found.map(Self).ok_or_else(|| {
            let why = "the formulas need a moving belt and a finite kappa > 0: friction that falls \
                 from rest to the belt velocity by more than the damper's force there";
            PyValueError::new_err(why)
        })
    }

    /// The drop of friction from rest to the speed of the belt, less the force of the damper at
    /// that speed, divided by the belt velocity.
    #[getter]
    fn kappa(&self) -> f64 {
        self.0.kappa()
    }

    /// The amplitude A1, Eq. 18.
    #[getter]
    fn amplitude(&self) -> f64 {
        self.0.amplitude()
    }

    /// The amplitude of the velocity.
    #[getter]
    fn velocity_amplitude(&self) -> f64 {
        self.0.velocity_amplitude()
    }

    /// The duration of stick.
    #[getter]
    fn stick_duration(&self) -> f64 {
        self.0.stick_duration()
    }

    /// The duration of slip.
    #[getter]
    fn slip_duration(&self) -> f64 {
        self.0.slip_duration()
    }

    /// The period.
    #[getter]
    fn period(&self) -> f64 {
        self.0.period()
    }

    /// The angular frequency.
    #[getter]
    fn frequency(&self) -> f64 {
        self.0.frequency()
    }

    /// The cycle to first order, for laws that are cubic up to its fastest slip, as Polynomial is;
    /// None otherwise.
    fn first_order(&self) -> Option<StickSlipCycle> {
        self.0.first_order().map(StickSlipCycle::from)
    }

    /// The cycle to second order, for laws that are cubic up to its fastest slip, as Polynomial is;
    /// None otherwise.
    fn second_order(&self) -> Option<StickSlipCycle> {
        self.0.second_order().map(StickSlipCycle::from)
    }

    fn __repr__(&self) -> String {
        format!(
            "<StickSlip amplitude = {:?}, period = {:?}>",
            self.0.amplitude(),
            self.0.period()
        )
    }
}

/// The friction coefficient of a `RateState` law after a velocity step: after steady sliding at
/// one speed the contact slides at another, and has covered a distance at it. Dimensionless.
///
/// Args:
///     law: a RateState.
///     before: the speed of steady sliding, in units of velocity, > 0.
///     after: the speed then, in units of velocity, > 0.
///     slip: the distance at that speed, in units of displacement; a number or an array.
///
/// >>> import math
/// >>> from stick_slip import RateState, analysis
/// >>> law = RateState(f0=0.6, a=0.01, b=0.015, d_c=1e-5, v0=1e-6, evolution="slip")
/// >>> jump = analysis.velocity_step(law, before=1e-6, after=1e-5, slip=0.0)
/// >>> abs(jump - (0.6 + 0.01 * math.log(10))) < 1e-15
/// True
#[pyfunction]
pub fn velocity_step<'py>(
    law: &PyRateState,
    before: f64,
    after: f64,
    slip: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyAny>> {
    with_rate_state!(&law.0, law => {
        elementwise(slip, |slip| rate_state::velocity_step(law, before, after, slip))
    })
}

/// The increase of the friction coefficient of a `RateState` law by a hold without sliding:
/// b ln(1 + v0 t/d_c) with the aging law, 0 with the slip law. Dimensionless.
///
/// Args:
///     law: a RateState.
///     hold: the time at rest, >= 0; a number or an array.
///
/// >>> import math
/// >>> from stick_slip import RateState, analysis
/// >>> law = RateState(f0=0.6, a=0.01, b=0.015, d_c=1e-5, v0=1e-6)
/// >>> abs(analysis.healing(law, 10.0) - 0.015 * math.log(2)) < 1e-15
/// True
#[pyfunction]
pub fn healing<'py>(law: &PyRateState, hold: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    with_rate_state!(&law.0, law => elementwise(hold, |hold| rate_state::healing(law, hold)))
}

/// The fall of the friction force in a strong earthquake, from steady sliding at the plate speed to
/// steady sliding at the coseismic speed; in units of force.
///
/// Args:
///     law: a RateState.
///     load: the normal load, in units of force.
///     plate_speed: in units of velocity, > 0.
///     coseismic_speed: in units of velocity, > 0.
#[pyfunction]
pub fn stress_drop(law: &PyRateState, load: f64, plate_speed: f64, coseismic_speed: f64) -> f64 {
    with_rate_state!(&law.0, law => {
        rate_state::stress_drop(law, load, plate_speed, coseismic_speed)
    })
}

/// A rate-and-state law with one state variable.
fn of_one_state(law: &PyRateState) -> PyResult<&stick_slip::RateState> {
    match &law.0 {
        AnyRateState::One(law) => Ok(law),
        AnyRateState::Two(_) => Err(PyTypeError::new_err(
            "this formula is that of a RateState with one state variable",
        )),
    }
}

/// The time until a self-accelerating contact without inertia reaches an unbounded speed, with the
/// aging law; None if it does not.
///
/// Args:
///     law: a RateState with one state variable.
///     load: the normal load, in units of force.
///     stiffness: of the spring, force per displacement.
///     speed: of the contact now, in units of velocity.
///     load_rate: at which the spring would be loaded without sliding, force per time.
///
/// >>> from stick_slip import RateState, analysis
/// >>> law = RateState(f0=0.6, a=0.01, b=0.015, d_c=1e-5, v0=1e-6)
/// >>> round(analysis.time_to_instability(law, 5e6, 5e9, 1e-9), 6)
/// 20000.0
#[pyfunction]
#[pyo3(signature = (law, load, stiffness, speed, load_rate = 0.0))]
pub fn time_to_instability(
    law: &PyRateState,
    load: f64,
    stiffness: f64,
    speed: f64,
    load_rate: f64,
) -> PyResult<Option<f64>> {
    let law = of_one_state(law)?;
    Ok(rate_state::time_to_instability(
        law, load, stiffness, speed, load_rate,
    ))
}

/// The first integral of a spring-slider without inertia at the critical stiffness: a number that
/// stays constant along a motion; dimensionless. None where the speed grows without bound.
///
/// Args:
///     law: a RateState with one state variable.
///     plate_speed: at which the spring is pulled, in units of velocity.
///     speed: of the contact, in units of velocity.
///     memory: its memory variable phi.
#[pyfunction]
pub fn first_integral(
    law: &PyRateState,
    plate_speed: f64,
    speed: f64,
    memory: f64,
) -> PyResult<Option<f64>> {
    let law = of_one_state(law)?;
    Ok(rate_state::first_integral(law, plate_speed, speed, memory))
}
