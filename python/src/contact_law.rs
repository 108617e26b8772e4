//! Laws for contacts of structures only: `ContactLaw` and `RateState`.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use stick_slip::{
    AnyLaw, Contact, Coulomb, Dahl, Directional, Drive, Dwell, Error, Freewheel, FrictionLaw,
    LuGre, RateState2,
};

use crate::convert::{Numbers, elementwise};
use crate::error::OrRaise;
use crate::law::{LawArgument, Plain, PyLaw, with_plain_law};
use crate::made::{Made, Reduced};
use crate::traced::Traced;

/// A law for contacts of a `Structure` only: it depends on the direction of slip (`Directional`,
/// `Capstan`, `Freewheel`) or has a memory (`Dwell`, `Dahl`, `LuGre`, `RateState`).
#[pyclass(frozen, subclass, name = "ContactLaw", module = "stick_slip")]
pub struct PyContactLaw {
    law: AnyContactLaw,
    made: Made,
}

/// A contact law with the type of its dry law.
#[derive(Clone)]
pub enum AnyContactLaw {
    /// The laws of slip forward and backward.
    Directional(Plain, Plain),
    /// The law of its drag.
    Freewheel(Plain),
    /// The law, and how static friction rises, which the crate's law does not tell.
    DwellNamed(Dwell<AnyLaw>, Rise),
    DwellTraced(Dwell<Traced>),
    Dahl(Dahl),
    LuGreNamed(LuGre<AnyLaw>),
    LuGreTraced(LuGre<Traced>),
    RateState(AnyRateState),
}

/// A rate-and-state law with one state variable or two.
#[derive(Clone, Copy)]
pub enum AnyRateState {
    One(stick_slip::RateState),
    Two(RateState2),
}

/// Runs an expression with a rate-and-state law of either kind.
macro_rules! with_rate_state {
    ($kind:expr, $law:ident => $result:expr) => {
        match $kind {
            $crate::contact_law::AnyRateState::One($law) => $result,
            $crate::contact_law::AnyRateState::Two($law) => $result,
        }
    };
}
pub(crate) use with_rate_state;

/// How static friction rises with the time in stick.
#[derive(Clone, Copy)]
pub struct Rise {
    time: f64,
    limit: Option<f64>,
    rate: Option<f64>,
    hyperbolic: bool,
}

impl Rise {
    fn of<L: FrictionLaw>(self, law: L) -> PyResult<Dwell<L>> {
        let Self {
            time,
            limit,
            rate,
            hyperbolic,
        } = self;
        match (limit, rate, hyperbolic) {
            (Some(limit), None, false) => Dwell::exponential(law, limit, time).or_raise(),
            (Some(limit), None, true) => Dwell::hyperbolic(law, limit, time).or_raise(),
            (None, Some(rate), false) => Dwell::logarithmic(law, rate, time).or_raise(),
            _ => Err(PyValueError::new_err(
                "give limit (exponential form, or with hyperbolic=True), or rate (logarithmic)",
            )),
        }
    }
}

/// The dry law inside of another law.
fn plain(law: &Bound<'_, PyLaw>) -> PyResult<Plain> {
    law.get().kind.plain().cloned().or_raise()
}

impl PyContactLaw {
    pub fn law(&self) -> &AnyContactLaw {
        &self.law
    }

    pub fn contact(&self, direction: &[(usize, f64)], load: Drive) -> Result<Contact, Error> {
        match self.law.clone() {
            AnyContactLaw::Directional(forward, backward) => {
                with_plain_law!(forward, forward => with_plain_law!(backward, backward => {
                    Contact::along(direction, Directional::new(forward, backward)?, load)
                }))
            }
            AnyContactLaw::Freewheel(drag) => with_plain_law!(drag, drag => {
                Contact::along(direction, Freewheel::new(drag)?, load)
            }),
            AnyContactLaw::DwellNamed(law, _) => Contact::along(direction, law, load),
            AnyContactLaw::DwellTraced(law) => Contact::along(direction, law, load),
            AnyContactLaw::Dahl(law) => Contact::along(direction, law, load),
            AnyContactLaw::LuGreNamed(law) => Contact::along(direction, law, load),
            AnyContactLaw::LuGreTraced(law) => Contact::along(direction, law, load),
            AnyContactLaw::RateState(law) => {
                with_rate_state!(law, law => Contact::along(direction, law, load))
            }
        }
    }

    /// The law with its dry law's own type, if that is Coulomb's.
    pub fn dwell_of_coulomb(&self) -> Option<PyResult<Dwell<Coulomb>>> {
        match &self.law {
            AnyContactLaw::DwellNamed(law, rise) => match law.law() {
                AnyLaw::Coulomb(law) => Some(rise.of(*law)),
                _ => None,
            },
            _ => None,
        }
    }
}

#[pymethods]
impl PyContactLaw {
    /// The static coefficient of a `Dwell` after so much time in stick; dimensionless. None for
    /// another law.
    ///
    /// >>> from stick_slip import Coulomb, Dwell
    /// >>> law = Dwell(Coulomb(0.3, 0.2), limit=0.5, time=2.0)
    /// >>> law.static_coefficient(0.0), law.static_coefficient(float("inf"))
    /// (0.3, 0.5)
    fn static_coefficient(&self, rest: f64) -> Option<f64> {
        match &self.law {
            AnyContactLaw::DwellNamed(law, _) => Some(law.static_coefficient(rest)),
            AnyContactLaw::DwellTraced(law) => Some(law.static_coefficient(rest)),
            _ => None,
        }
    }

    /// The rate d mu_s/dt at which the static coefficient of a `Dwell` rises after so much time in
    /// stick; per unit of time. None for another law.
    ///
    /// >>> from stick_slip import Coulomb, Dwell
    /// >>> Dwell(Coulomb(0.3, 0.2), limit=0.5, time=2.0).static_rate(0.0)
    /// 0.1
    fn static_rate(&self, rest: f64) -> Option<f64> {
        match &self.law {
            AnyContactLaw::DwellNamed(law, _) => Some(law.static_rate(rest)),
            AnyContactLaw::DwellTraced(law) => Some(law.static_rate(rest)),
            _ => None,
        }
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        self.made.text(py)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> Reduced<'py> {
        self.made.reduced(py)
    }
}

/// Dry friction that depends on the direction of slip: one law for each direction, as of hairs,
/// scales, soles and boards with nap.
///
/// Args:
///     forward: a Law for slip with a positive relative velocity; its static coefficient limits
///         the friction force at load * static_coefficient.
///     backward: a Law for slip with a negative relative velocity; its static coefficient limits
///         the friction force at -load * static_coefficient.
///
/// >>> import math
/// >>> from stick_slip import Contact, Coulomb, Directional, Drive, Structure
/// >>> law = Directional(Coulomb(0.2, 0.2), Coulomb(0.6, 0.6))
/// >>> law
/// Directional(Coulomb(0.2, 0.2), Coulomb(0.6, 0.6))
/// >>> shaken = (Structure([1.0]).with_force(0, Drive.sine(1.0, 2 * math.pi))
/// ...     .with_contact(Contact(0, law, 1.0)))
/// >>> motion = shaken.simulate(([0.0], [0.0]), 20.0)   # it moves forward only
/// >>> abs(motion.events["time"][0] - math.asin(0.2) / (2 * math.pi)) < 1e-15
/// np.True_
#[pyfunction(name = "Directional")]
pub fn directional(
    py: Python<'_>,
    forward: LawArgument<'_>,
    backward: LawArgument<'_>,
) -> PyResult<PyContactLaw> {
    let [forward, backward] = [forward.0, backward.0];
    let law = AnyContactLaw::Directional(plain(&forward)?, plain(&backward)?);
    let made = Made::by(py, "Directional", (forward, backward))?;
    Ok(PyContactLaw { law, made })
}

/// A rope or a band around a drum (Euler and Eytelwein): a `Directional` law.
///
/// The load of the contact is the tension of one end. The friction force is the difference of the
/// tension of the other end and the load: at most e^(mu wrap) - 1 times the load forward, and at
/// most 1 - e^(-mu wrap) times the load backward. A drum feels the friction force alone; the load
/// is a force on the rope that you add to the structure.
///
/// Args:
///     static_coefficient: of rope and drum, dimensionless.
///     kinetic_coefficient: dimensionless, <= static_coefficient.
///     wrap: the angle of contact, in radians, >= 0.
///
/// >>> import math
/// >>> from stick_slip import Capstan, Contact, Structure
/// >>> rope = Structure([1.0]).with_contact(Contact(0, Capstan(0.3, 0.2, 2 * math.pi), 10.0))
/// >>> [at] = rope.with_force(0, 50.0).carried(0.0, ([0.0], [0.0]))   # one turn holds 5.6 times 10
/// >>> at.force
/// 50.0
#[pyfunction(name = "Capstan")]
pub fn capstan(
    py: Python<'_>,
    static_coefficient: f64,
    kinetic_coefficient: f64,
    wrap: f64,
) -> PyResult<PyContactLaw> {
    let law = Directional::capstan(static_coefficient, kinetic_coefficient, wrap).or_raise()?;
    let [forward, backward] =
        [law.forward(), law.backward()].map(|law| Plain::Named((*law).into()));
    let numbers = (static_coefficient, kinetic_coefficient, wrap);
    let made = Made::by(py, "Capstan", numbers)?;
    let law = AnyContactLaw::Directional(forward, backward);
    Ok(PyContactLaw { law, made })
}

/// A freewheel (one-way clutch, backstop): it slips with a negative relative velocity only, and
/// carries any force that would make it slip forward. See also `Contact.freewheel`.
///
/// Args:
///     drag: a Law, the friction while it overruns; none if it is None.
///
/// >>> import math
/// >>> from stick_slip import Contact, Drive, Freewheel, Structure
/// >>> backstop = Contact({0: -1.0}, Freewheel(), 1.0)   # coordinate 0 turns forward only
/// >>> shaft = Structure([1.0]).with_force(0, Drive.harmonic(1.0, 1.0)).with_contact(backstop)
/// >>> motion = shaft.simulate(([0.0], [0.0]), 6.0)
/// >>> motion.events["kind"], motion.events["time"] / math.pi
/// (array(['stick', 'release'], dtype='<U8'), array([1. , 1.5]))
#[pyfunction(name = "Freewheel")]
#[pyo3(signature = (drag = None))]
pub fn freewheel(py: Python<'_>, drag: Option<LawArgument<'_>>) -> PyResult<PyContactLaw> {
    let (drag, made) = match drag {
        Some(LawArgument(law)) => (plain(&law)?, Made::by(py, "Freewheel", (law,))?),
        None => (
            Plain::Named(Coulomb::new(0.0, 0.0).or_raise()?.into()),
            Made::by(py, "Freewheel", ())?,
        ),
    };
    let law = AnyContactLaw::Freewheel(drag);
    Ok(PyContactLaw { law, made })
}

/// Static friction that rises with the time in stick. Give `limit` or `rate`:
///
/// exponential: limit - (limit - mu_s) exp(-t/time);
/// hyperbolic: mu_s + (limit - mu_s) t/(t + time);
/// logarithmic: mu_s + rate ln(1 + t/time).
///
/// Args:
///     law: the law in slip; its static coefficient mu_s is that of stick without delay.
///     limit: the static coefficient after a long stick, dimensionless, >= mu_s.
///     rate: the growth per unit of ln t, dimensionless, >= 0.
///     time: the time constant, in units of time, > 0.
///     hyperbolic: the hyperbolic form instead of the exponential one.
///
/// >>> from stick_slip import Coulomb, Dwell
/// >>> Dwell(Coulomb(0.3, 0.2), rate=0.01, time=1.0)
/// Dwell(Coulomb(0.3, 0.2), rate=0.01, time=1.0)
#[pyfunction(name = "Dwell")]
#[pyo3(signature = (law, *, time, limit = None, rate = None, hyperbolic = false))]
pub fn dwell(
    py: Python<'_>,
    law: LawArgument<'_>,
    time: f64,
    limit: Option<f64>,
    rate: Option<f64>,
    hyperbolic: bool,
) -> PyResult<PyContactLaw> {
    let rise = Rise {
        time,
        limit,
        rate,
        hyperbolic,
    };
    let made = Made::by(py, "Dwell", (&law.0,))?
        .with_given(py, "limit", limit)?
        .with_given(py, "rate", rate)?
        .with(py, "time", time)?
        .with_given(py, "hyperbolic", hyperbolic.then_some(true))?;
    let law = match plain(&law.0)? {
        Plain::Named(law) => AnyContactLaw::DwellNamed(rise.of(law)?, rise),
        Plain::Traced(law) => AnyContactLaw::DwellTraced(rise.of(law)?),
    };
    Ok(PyContactLaw { law, made })
}

/// Dahl's bristle model: elastic before it slides, without a static limit.
///
/// Args:
///     coefficient: the coefficient in steady sliding, dimensionless, > 0.
///     stiffness: of the bristles, per unit of displacement (force = load times coefficient).
///
/// >>> from stick_slip import Dahl
/// >>> Dahl(0.3, 1e4)
/// Dahl(0.3, 10000.0)
#[pyfunction(name = "Dahl")]
pub fn dahl(py: Python<'_>, coefficient: f64, stiffness: f64) -> PyResult<PyContactLaw> {
    let law = AnyContactLaw::Dahl(Dahl::new(coefficient, stiffness).or_raise()?);
    let made = Made::by(py, "Dahl", (coefficient, stiffness))?;
    Ok(PyContactLaw { law, made })
}

/// The LuGre bristle model.
///
/// Args:
///     law: the friction in steady sliding, without the viscous term.
///     stiffness: of the bristles, per unit of displacement.
///     damping: of the bristles, per unit of velocity.
///     viscous: the viscous coefficient, per unit of velocity.
///
/// >>> from stick_slip import Exponential, LuGre
/// >>> LuGre(Exponential(0.4, 0.25, 0.5), 1e4, 10.0, viscous=0.1)
/// LuGre(Exponential(0.4, 0.25, 0.5), 10000.0, 10.0, viscous=0.1)
#[pyfunction(name = "LuGre")]
#[pyo3(signature = (law, stiffness, damping, viscous = 0.0))]
pub fn lugre(
    py: Python<'_>,
    law: LawArgument<'_>,
    stiffness: f64,
    damping: f64,
    viscous: f64,
) -> PyResult<PyContactLaw> {
    let made = Made::by(py, "LuGre", (&law.0, stiffness, damping))?;
    let made = made.with(py, "viscous", viscous)?;
    let law = match plain(&law.0)? {
        Plain::Named(law) => {
            AnyContactLaw::LuGreNamed(LuGre::new(law, stiffness, damping, viscous).or_raise()?)
        }
        Plain::Traced(law) => {
            AnyContactLaw::LuGreTraced(LuGre::new(law, stiffness, damping, viscous).or_raise()?)
        }
    };
    Ok(PyContactLaw { law, made })
}

/// A number, or a pair of numbers for two state variables, as it was given.
fn number_or_pair<'py>(py: Python<'py>, numbers: &Numbers) -> PyResult<Bound<'py, PyAny>> {
    Ok(match numbers.0[..] {
        [number] => number.into_pyobject(py)?.into_any(),
        [first, second] => (first, second).into_pyobject(py)?.into_any(),
        _ => {
            return Err(PyValueError::new_err(
                "b and d_c are two numbers or two pairs",
            ));
        }
    })
}

/// Rate-and-state friction: the coefficient depends on the logarithm of the sliding speed V and of
/// a state variable theta, the mean age of the asperities:
///
/// mu = f0 + a ln(V/v0) + b phi,   phi = ln(v0 theta/d_c)
///
/// (with arsinh at the lowest speeds). The memory variable of the contact is phi. In steady sliding
/// phi = -ln(V/v0) and mu = f0 + (a - b) ln(V/v0): friction falls with the speed if b > a.
///
/// There is no stick: a contact that seems to stick creeps. Starts may give its relative velocity
/// with all digits, and `Motion.sliding_velocity` returns it so.
///
/// Args:
///     f0: the coefficient of steady sliding at the speed v0; dimensionless.
///     a: the direct effect, > 0; dimensionless.
///     b: the effect of the state; dimensionless. A pair (b1, b2) for two state variables.
///     d_c: the slip over which the state changes, in units of displacement, > 0. A pair for two
///         state variables.
///     v0: the reference speed, in units of velocity, > 0.
///     evolution: "aging" (Dieterich: theta' = 1 - V theta/d_c) or "slip" (Ruina: theta' =
///         -(V theta/d_c) ln(V theta/d_c)).
///     least_speed: in units of velocity, > 0. With the slip law a motion that reverses ends with
///         an error unless it is given; 1e-30 v0 changes no digit.
///
/// >>> from stick_slip import Contact, RateState, Structure
/// >>> RateState(f0=0.6, a=0.01, b=0.015, d_c=1e-5, v0=1e-6).steady(1e-6)
/// 0.6
/// >>> law = RateState(f0=0.4, a=0.1, b=0.3, d_c=0.06, v0=0.05)
/// >>> slider = (Structure([1.0]).with_ground_spring(0, 1.0).with_ground_damper(0, 0.02)
/// ...     .with_contact(Contact(0, law, 1.0, belt_velocity=0.05)))
/// >>> motion = slider.simulate(([0.35], [0.01], [0.0]), 20.0)
/// >>> motion.events["time"][0]     # a growing oscillation: the mass overtakes its belt
/// np.float64(16.2809726467366...)
#[pyclass(frozen, extends = PyContactLaw, name = "RateState", module = "stick_slip")]
pub struct PyRateState(pub AnyRateState);

#[pymethods]
impl PyRateState {
    #[new]
    #[pyo3(signature = (*, f0, a, b, d_c, v0, evolution = "aging", least_speed = None))]
    fn new(
        py: Python<'_>,
        f0: f64,
        a: f64,
        b: Numbers,
        d_c: Numbers,
        v0: f64,
        evolution: &str,
        least_speed: Option<f64>,
    ) -> PyResult<PyClassInitializer<Self>> {
        let new = match evolution {
            "aging" => stick_slip::RateState::aging,
            "slip" => stick_slip::RateState::slip,
            _ => return Err(PyValueError::new_err("evolution is 'aging' or 'slip'")),
        };
        let made = Made::by(py, "RateState", ())?
            .with(py, "f0", f0)?
            .with(py, "a", a)?
            .with(py, "b", number_or_pair(py, &b)?)?
            .with(py, "d_c", number_or_pair(py, &d_c)?)?
            .with(py, "v0", v0)?
            .with(py, "evolution", evolution)?
            .with_given(py, "least_speed", least_speed)?;
        let mut law = match (&b.0[..], &d_c.0[..]) {
            (&[b], &[d_c]) => AnyRateState::One(new(f0, a, b, d_c, v0).or_raise()?),
            (&[b, b2], &[d_c, d_c2]) => {
                let one = new(f0, a, b, d_c, v0);
                AnyRateState::Two(
                    one.and_then(|law| law.with_second_state(b2, d_c2))
                        .or_raise()?,
                )
            }
            _ => {
                return Err(PyValueError::new_err(
                    "b and d_c are two numbers or two pairs",
                ));
            }
        };
        if let Some(speed) = least_speed {
            law = match law {
                AnyRateState::One(law) => {
                    AnyRateState::One(law.with_least_speed(speed).or_raise()?)
                }
                AnyRateState::Two(law) => {
                    AnyRateState::Two(law.with_least_speed(speed).or_raise()?)
                }
            };
        }
        let base = PyContactLaw {
            law: AnyContactLaw::RateState(law),
            made,
        };
        Ok(PyClassInitializer::from(base).add_subclass(Self(law)))
    }

    /// The coefficient of steady sliding at speeds > 0, a number or an array in units of velocity:
    /// f0 + (a - b) ln(V/v0), with the sum of b1 and b2 for two state variables; dimensionless.
    ///
    /// >>> import math
    /// >>> from stick_slip import RateState
    /// >>> law = RateState(f0=0.6, a=0.01, b=0.015, d_c=1e-5, v0=1e-6)
    /// >>> abs(law.steady(1e-5) - (0.6 - 0.005 * math.log(10))) < 1e-15
    /// True
    fn steady<'py>(&self, speed: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        with_rate_state!(&self.0, law => elementwise(speed, |speed| law.steady(speed)))
    }

    /// The memory variable phi = -ln(V/v0) in steady sliding at speeds > 0, a number or an array in
    /// units of velocity; that of each of two state variables. Dimensionless.
    fn memory_at<'py>(&self, speed: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        with_rate_state!(&self.0, law => elementwise(speed, |speed| law.memory_at(speed)))
    }

    /// The stiffness below which steady sliding is unstable, force per displacement; None if it is
    /// stable with every spring.
    ///
    /// Args:
    ///     load: in units of force.
    ///     speed: of steady sliding, in units of velocity, > 0.
    ///     mass: in units of mass.
    ///     damping: of a damper to the ground, such as radiation damping, force per velocity.
    ///
    /// >>> from stick_slip import RateState
    /// >>> law = RateState(f0=0.6, a=0.008, b=0.016, d_c=2e-5, v0=1e-6)
    /// >>> round(law.critical_stiffness(load=5e3, speed=1e-5), 6)
    /// 2000000.0
    #[pyo3(signature = (load, speed, mass = 0.0, damping = 0.0))]
    fn critical_stiffness(&self, load: f64, speed: f64, mass: f64, damping: f64) -> Option<f64> {
        with_rate_state!(&self.0, law => law.critical_stiffness(load, speed, mass, damping))
    }

    /// The angular frequency of the oscillation that begins at the critical stiffness, in radians
    /// per unit of time, for any mass; None if steady sliding is stable with every spring.
    ///
    /// Args:
    ///     load: in units of force.
    ///     speed: of steady sliding, in units of velocity, > 0.
    ///     damping: of a damper to the ground, force per velocity.
    #[pyo3(signature = (load, speed, damping = 0.0))]
    fn hopf_frequency(&self, load: f64, speed: f64, damping: f64) -> Option<f64> {
        with_rate_state!(&self.0, law => law.hopf_frequency(load, speed, damping))
    }
}

/// Either kind of law, as contacts take it.
pub enum ContactLawArgument<'py> {
    Dry(Bound<'py, PyLaw>),
    Other(Bound<'py, PyContactLaw>),
}

impl<'a, 'py> FromPyObject<'a, 'py> for ContactLawArgument<'py> {
    type Error = PyErr;

    fn extract(object: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        match object.cast::<PyContactLaw>() {
            Ok(law) => Ok(Self::Other(law.to_owned())),
            Err(_) => object.extract().map(|LawArgument(law)| Self::Dry(law)),
        }
    }
}

impl<'py> ContactLawArgument<'py> {
    pub fn contact(&self, direction: &[(usize, f64)], load: Drive) -> Result<Contact, Error> {
        match self {
            Self::Dry(law) => law.get().kind.contact(direction, load),
            Self::Other(law) => law.get().contact(direction, load),
        }
    }

    /// The law as Python has it.
    pub fn object(&self) -> &Bound<'py, PyAny> {
        match self {
            Self::Dry(law) => law.as_any(),
            Self::Other(law) => law.as_any(),
        }
    }
}
