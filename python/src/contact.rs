//! `Contact`: where friction acts.

use pyo3::prelude::*;
use stick_slip::structure::State;

use crate::contact_law::{ContactLawArgument, freewheel};
use crate::convert::{Direction, Index, Numbers, Points, Table};
use crate::drive::DriveArgument;
use crate::error::OrRaise;
use crate::force::{ForceLawArgument, with_force};
use crate::law::LawArgument;
use crate::made::{Made, Reduced};

/// A friction contact of a structure: relative velocity r = b v - w, friction force N mu(r).
///
/// Args:
///     direction: b. A coordinate i for a mass on a belt or the ground (b = e_i), a dict
///         {coordinate: coefficient} or pairs otherwise; dimensionless.
///         `Contact.between(i, j, ...)` is the direction {i: 1, j: -1}.
///     law: a Law, or a ContactLaw such as `Dwell`, `LuGre`, `RateState` or `Directional`.
///     load: the normal load, in units of force: a number or a Drive. The contact opens when the
///         whole load falls below 0, and closes again when it rises. With a load_gradient, but
///         without normal_spring and load_laws, the motion ends with an error instead.
///     belt_velocity: w, the velocity of the surface, in units of velocity: a number or a Drive.
///     load_gradient: a dict {coordinate: force per displacement} that adds to the load; the normal
///         spring is then part of the stiffness matrix.
///     tangential_stiffness: of an elastic contact, a spring in series with the slider, force per
///         displacement. Its law must be Coulomb(mu, mu).
///     normal_spring: a pair (direction, stiffness) of a spring that presses, and can open; then a
///         load below 0 is a gap.
///     load_laws: pairs (direction, ForceLaw) that add phi(a.q, a.v) to the load of a rigid
///         contact, in units of force: a bead on a ring, an oblique spring. They press only; give
///         the same law to a `ForceElement` if it also acts on the structure.
///
/// >>> from stick_slip import Contact, Coulomb
/// >>> Contact.between(0, 1, Coulomb(0.4, 0.3), 5.0)
/// Contact({0: 1.0, 1: -1.0}, Coulomb(0.4, 0.3), 5.0)
///
/// A bead on a horizontal ring of radius 2, which presses with v^2/2:
///
/// >>> from stick_slip import ForceLaw, Structure
/// >>> ring = ForceLaw(lambda x, v: v**2 / 2)
/// >>> bead = Structure([1.0]).with_contact(
/// ...     Contact(0, Coulomb(0.3, 0.3), 0.0, load_laws=[(0, ring)]))
/// >>> q, v = bead.simulate(([0.0], [3.0]), 10.0).last
/// >>> bool(abs(v[0] - 3.0 / (1.0 + 0.15 * 3.0 * 10.0)) < 1e-15)
/// True
#[pyclass(frozen, name = "Contact", module = "stick_slip")]
pub struct PyContact {
    pub contact: stick_slip::Contact,
    made: Made,
}

/// The keyword arguments of a contact.
struct Options<'py> {
    belt_velocity: Option<DriveArgument<'py>>,
    load_gradient: Option<Direction>,
    tangential_stiffness: Option<f64>,
    normal_spring: Option<(Direction, f64)>,
    load_laws: Vec<(Direction, ForceLawArgument<'py>)>,
}

/// The direction of what acts between two coordinates.
fn between(i: Index, j: Index) -> Direction {
    Direction(vec![(i.0, 1.0), (j.0, -1.0)])
}

impl PyContact {
    fn build(
        py: Python<'_>,
        direction: Direction,
        law: &ContactLawArgument<'_>,
        load: &DriveArgument<'_>,
        options: Options<'_>,
    ) -> PyResult<Self> {
        let mut contact = law.contact(&direction.0, load.drive()).or_raise()?;
        let mut made = Made::by(py, "Contact", (&direction, law.object(), load))?;
        if let Some(velocity) = options.belt_velocity {
            made = made.with(py, "belt_velocity", &velocity)?;
            contact = contact.on_belt(velocity.drive());
        }
        if let Some(gradient) = options.load_gradient {
            for (coordinate, gradient) in gradient.0 {
                contact = contact
                    .with_load_gradient(coordinate, gradient)
                    .or_raise()?;
            }
            let gradient = Direction(contact.load_gradient().to_vec());
            made = made.with(py, "load_gradient", &gradient)?;
        }
        if let Some(stiffness) = options.tangential_stiffness {
            made = made.with(py, "tangential_stiffness", stiffness)?;
            contact = contact.with_tangential_stiffness(stiffness).or_raise()?;
        }
        if let Some((direction, stiffness)) = options.normal_spring {
            made = made.with(py, "normal_spring", (&direction, stiffness))?;
            contact = contact
                .with_normal_spring(&direction.0, stiffness)
                .or_raise()?;
        }
        let laws: Vec<_> = options
            .load_laws
            .iter()
            .map(|(direction, law)| (direction, &law.0))
            .collect();
        made = made.with_given(py, "load_laws", (!laws.is_empty()).then_some(laws))?;
        for (Direction(direction), law) in &options.load_laws {
            let law = law.0.get().force.clone();
            let with = with_force!(law, law => contact.with_load_law(direction, law));
            contact = with.or_raise()?;
        }
        Ok(Self { contact, made })
    }
}

#[pymethods]
impl PyContact {
    #[new]
    #[pyo3(signature = (direction, law, load, *, belt_velocity = None, load_gradient = None,
        tangential_stiffness = None, normal_spring = None, load_laws = Vec::new()))]
    fn new(
        py: Python<'_>,
        direction: Direction,
        law: ContactLawArgument<'_>,
        load: DriveArgument<'_>,
        belt_velocity: Option<DriveArgument<'_>>,
        load_gradient: Option<Direction>,
        tangential_stiffness: Option<f64>,
        normal_spring: Option<(Direction, f64)>,
        load_laws: Vec<(Direction, ForceLawArgument<'_>)>,
    ) -> PyResult<Self> {
        let options = Options {
            belt_velocity,
            load_gradient,
            tangential_stiffness,
            normal_spring,
            load_laws,
        };
        Self::build(py, direction, &law, &load, options)
    }

    /// A contact between coordinates i and j: a clutch, a damper between blades, a pad on a disc.
    #[staticmethod]
    #[pyo3(signature = (i, j, law, load, *, belt_velocity = None, load_gradient = None,
        tangential_stiffness = None, normal_spring = None, load_laws = Vec::new()))]
    fn between(
        py: Python<'_>,
        i: Index,
        j: Index,
        law: ContactLawArgument<'_>,
        load: DriveArgument<'_>,
        belt_velocity: Option<DriveArgument<'_>>,
        load_gradient: Option<Direction>,
        tangential_stiffness: Option<f64>,
        normal_spring: Option<(Direction, f64)>,
        load_laws: Vec<(Direction, ForceLawArgument<'_>)>,
    ) -> PyResult<Self> {
        let options = Options {
            belt_velocity,
            load_gradient,
            tangential_stiffness,
            normal_spring,
            load_laws,
        };
        Self::build(py, between(i, j), &law, &load, options)
    }

    /// A freewheel (one-way clutch) between coordinates i and j: it drives j by i, and lets j run
    /// ahead. `Contact.between` with the law `Freewheel`.
    ///
    /// Args:
    ///     i: the coordinate that drives.
    ///     j: the coordinate that is driven.
    ///     drag: a Law, the friction while j runs ahead; none if it is None.
    ///     load: the normal load of the drag, in units of force: a number or a Drive. While it is
    ///         not positive, the freewheel is open.
    ///
    /// >>> import math
    /// >>> from stick_slip import Contact, Drive, Structure
    /// >>> shafts = (Structure([1.0, 3.0]).with_force(0, Drive.sine(1.0, 1.0))
    /// ...     .with_contact(Contact.freewheel(0, 1)))
    /// >>> motion = shafts.simulate(([0.0, 0.0], [0.0, 0.0]), 4.0)
    /// >>> abs(motion.events["time"][0] - math.pi) < 1e-14   # then shaft 1 runs ahead
    /// np.True_
    #[staticmethod]
    #[pyo3(signature = (i, j, *, drag = None, load = DriveArgument::Number(1.0)),
        text_signature = "(i, j, *, drag=None, load=1.0)")]
    fn freewheel(
        py: Python<'_>,
        i: Index,
        j: Index,
        drag: Option<LawArgument<'_>>,
        load: DriveArgument<'_>,
    ) -> PyResult<Self> {
        let (law, direction) = (freewheel(py, drag)?, between(i, j));
        let contact = law.contact(&direction.0, load.drive()).or_raise()?;
        let made = Made::by(py, "Contact", (&direction, law, &load))?;
        Ok(Self { contact, made })
    }

    /// Elastic contacts in parallel that replace this contact; they slide one after the other.
    ///
    /// Args:
    ///     elements: pairs (stiffness, share): the tangential stiffness of each element, and its
    ///         share of the load, > 0. If mu = 1 and load = 1, the share is the limit force, as in
    ///         the pairs of `Iwan4.elements`.
    ///
    /// >>> from stick_slip import Contact, Coulomb, Iwan4
    /// >>> joint = Iwan4(3.0, 2.0, -0.1, 0.1)
    /// >>> len(Contact(0, Coulomb(1.0, 1.0), 1.0).in_parallel(joint.elements(3, 0.5)))
    /// 4
    fn in_parallel(&self, py: Python<'_>, elements: Points) -> PyResult<Vec<Self>> {
        let contacts = self.contact.in_parallel(&elements.0).or_raise()?;
        let elements = Table::of_pairs(&elements.0);
        let all = self.made.then(py, "in_parallel", (elements,))?;
        let one = |(number, contact): (usize, stick_slip::Contact)| {
            let made = all.then(py, "__getitem__", (number,))?;
            Ok(Self { contact, made })
        };
        contacts.into_iter().enumerate().map(one).collect()
    }

    /// The direction b, a dict {coordinate: coefficient}.
    #[getter]
    fn direction(&self) -> std::collections::BTreeMap<usize, f64> {
        self.contact.direction().iter().copied().collect()
    }

    /// Stiffness of an elastic contact, force per displacement; None for a rigid one.
    #[getter]
    fn tangential_stiffness(&self) -> Option<f64> {
        self.contact.tangential_stiffness()
    }

    /// The normal load at a time with given displacements, in units of force; with velocities if
    /// laws of the load depend on them. Negative where the contact is open.
    #[pyo3(signature = (time, displacements, velocities = None))]
    fn load_at(&self, time: f64, displacements: Numbers, velocities: Option<Numbers>) -> f64 {
        match velocities {
            None => self.contact.load_at(time, &displacements.0),
            Some(velocities) => {
                let state = State::new(&displacements.0, &velocities.0);
                self.contact.load_in(time, &state)
            }
        }
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        self.made.text(py)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> Reduced<'py> {
        self.made.reduced(py)
    }
}
