//! A structure as its engine sees it: divided by the masses, without zeros.

use std::borrow::Cow;
use std::rc::Rc;

use nalgebra::DMatrix;

use super::laws::{Laws, Typed};
use super::sparse::Sparse;
use crate::belt::MassOnBelt;
use crate::drive::Drive;
use crate::error::{Element, Error};
use crate::friction::FrictionLaw;

/// What moves, what acts on it, and how fast it could go. The type of its laws is left behind.
#[derive(Debug, Clone)]
pub(crate) struct Model<'s> {
    pub(crate) masses: Cow<'s, [f64]>,
    /// K_ij/m_i.
    pub(crate) stiffness: Sparse,
    /// C_ij/m_i.
    pub(crate) damping: Sparse,
    /// 1/m_i.
    pub(super) inverse_mass: Vec<f64>,
    pub(crate) forces: Cow<'s, [Drive]>,
    pub(crate) contacts: Vec<Support<'s>>,
    pub(crate) laws: Rc<dyn Laws + 's>,
    /// What the drives that are not constant act on.
    pub(super) varying: Vec<Target>,
    /// Largest |i − j| of coordinates of which one acts on the other.
    pub(super) bandwidth: usize,
    /// 1/√(max_i Σ_j |K_ij|/m_i): no free vibration without friction is faster than one radian in
    /// this time. Where nothing is elastic that of the dampers, and infinite without any.
    pub(super) time_unit: f64,
}

/// What a drive acts on.
#[derive(Debug, Clone, Copy)]
pub(super) enum Target {
    /// The force on a coordinate.
    Force(usize),
    /// The velocity of the surface under a contact.
    Surface(usize),
    /// The load of a contact.
    Load(usize),
}

/// A contact without its law.
#[derive(Debug, Clone)]
pub(crate) struct Support<'s> {
    pub(crate) coordinate: usize,
    pub(crate) load: Cow<'s, Drive>,
    pub(crate) load_gradient: &'s [(usize, f64)],
    pub(crate) belt_velocity: Cow<'s, Drive>,
}

impl Support<'_> {
    /// N at a time.
    pub(crate) fn load_at(&self, time: f64, displacements: &[f64]) -> f64 {
        self.load.value(time) + self.displacement_load(displacements)
    }

    /// Σ n_j q_j; NaN where a displacement is missing.
    pub(crate) fn displacement_load(&self, displacements: &[f64]) -> f64 {
        let terms = self.load_gradient.iter();
        terms
            .map(|&(j, n)| n * displacements.get(j).copied().unwrap_or(f64::NAN))
            .sum()
    }

    /// Whether it may be contact number `number` of a structure with `count` coordinates.
    pub(super) fn check(&self, number: usize, count: usize) -> Result<(), Error> {
        let gradients = self.load_gradient.iter().map(|&(j, _)| j);
        for coordinate in std::iter::once(self.coordinate).chain(gradients) {
            if coordinate >= count {
                return Err(Error::NoSuchCoordinate {
                    element: Element::Contact(number),
                    coordinate,
                    count,
                });
            }
        }
        self.belt_velocity
            .check("belt_velocity", "a belt velocity of any size")
            .map_err(|error| error.of_element(Element::Contact(number)))?;
        match self.belt_velocity.first_jump() {
            Some(time) => Err(Error::BeltVelocityJumps {
                coordinate: self.coordinate,
                time,
            }),
            None => Ok(()),
        }
    }
}

impl<'s> Model<'s> {
    /// A mass on a belt as the structure that it is.
    pub(crate) fn of_belt<L: FrictionLaw>(belt: &'s MassOnBelt<L>) -> Self {
        let one = |entry: f64| DMatrix::from_element(1, 1, entry);
        let (stiffness, damping) = (one(1.0), one(2.0 * belt.damping()));
        let contact = Support {
            coordinate: 0,
            load: Cow::Owned(Drive::constant(belt.load())),
            load_gradient: &[],
            belt_velocity: Cow::Owned(Drive::constant(belt.belt_velocity())),
        };
        Self::new(
            Cow::Borrowed(&[1.0]),
            [&stiffness, &damping],
            Cow::Owned(vec![Drive::constant(0.0)]),
            vec![contact],
            Rc::new(Typed::<L, 0>(vec![belt.law()])),
        )
    }

    pub(crate) fn new(
        masses: Cow<'s, [f64]>,
        [stiffness, damping]: [&DMatrix<f64>; 2],
        forces: Cow<'s, [Drive]>,
        contacts: Vec<Support<'s>>,
        laws: Rc<dyn Laws + 's>,
    ) -> Self {
        let inverse_mass: Vec<f64> = masses.iter().map(|m| m.recip()).collect();
        let by_mass = |i: usize, _: usize| inverse_mass[i];
        let stiffness = Sparse::scaled(stiffness, by_mass);
        let damping = Sparse::scaled(damping, by_mass);
        let elastic = largest_row(&stiffness);
        let rate = if elastic > 0.0 {
            elastic.sqrt()
        } else {
            largest_row(&damping)
        };
        let loads = contacts.iter().flat_map(|contact| {
            let gradient = contact.load_gradient.iter();
            gradient.map(|&(j, _)| contact.coordinate.abs_diff(j))
        });
        let bandwidth = [stiffness.bandwidth(), damping.bandwidth()];
        let bandwidth = loads.chain(bandwidth).max().unwrap_or(0);
        let mut model = Self {
            varying: Vec::new(),
            masses,
            stiffness,
            damping,
            inverse_mass,
            forces,
            contacts,
            laws,
            bandwidth,
            time_unit: rate.recip(),
        };
        let of_forces = (0..model.len()).map(Target::Force);
        let of_contacts =
            (0..model.contacts.len()).flat_map(|c| [Target::Surface(c), Target::Load(c)]);
        let targets = of_forces.chain(of_contacts);
        model.varying = targets
            .filter(|&target| !model.drive(target).is_constant())
            .collect();
        model
    }

    /// Number of coordinates.
    pub(crate) fn len(&self) -> usize {
        self.masses.len()
    }

    /// Numbers that all contacts remember.
    pub(crate) fn remembered(&self) -> usize {
        self.laws.memory() * self.contacts.len()
    }

    /// All functions of time that act on it.
    pub(crate) fn drives(&self) -> impl Iterator<Item = &Drive> {
        let contacts = self.contacts.iter();
        let of_contacts = contacts.flat_map(|contact| [&*contact.load, &*contact.belt_velocity]);
        self.forces.iter().chain(of_contacts)
    }

    /// The drive that acts there.
    pub(super) fn drive(&self, target: Target) -> &Drive {
        match target {
            Target::Force(i) => &self.forces[i],
            Target::Surface(c) => &self.contacts[c].belt_velocity,
            Target::Load(c) => &self.contacts[c].load,
        }
    }
}

/// Largest Σ_j |a_ij|.
fn largest_row(matrix: &Sparse) -> f64 {
    let rows = matrix.rows().map(|(diagonal, beside)| {
        diagonal.abs() + beside.iter().map(|(_, a)| a.abs()).sum::<f64>()
    });
    rows.fold(0.0, f64::max)
}
