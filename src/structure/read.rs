//! Serialisation of structures (feature `serde`): matrices as lists of rows; read through the
//! checks of the constructors.

use nalgebra::DMatrix;
use serde::{Deserialize, Serialize, Serializer};

use super::direction::checked_direction;
use super::first_order::Input;
use super::matrices::check_count;
use crate::drive::Drive;
use crate::error::Error;
use crate::force::NamedForce;
use crate::friction::memory::read::{AnyStates, RateState};
use crate::friction::memory::{
    AnyContactLaw, Dahl, Directional, Dwell, Freewheel, LuGre, NamedLaw,
};
use crate::friction::{AnyLaw, Coulomb, Exponential, Polynomial, Rational, Stribeck, Tabulated};
use crate::numerics::sort::sort_by;

/// A contact as it is written, with its law in one form or another.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ContactText<L> {
    coordinate: usize,
    /// Left out if it is that coordinate alone.
    #[serde(default = "Vec::new", skip_serializing_if = "Vec::is_empty")]
    direction: Vec<(usize, f64)>,
    law: L,
    load: Drive,
    #[serde(default = "Vec::new")]
    load_gradient: Vec<(usize, f64)>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    load_laws: Vec<super::ForceElement>,
    #[serde(default = "at_rest")]
    belt_velocity: Drive,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    tangential_stiffness: Option<f64>,
    /// d and k_n.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    normal_spring: Option<(Vec<(usize, f64)>, f64)>,
}

fn at_rest() -> Drive {
    Drive::constant(0.0)
}

/// A law in its written form, which only the crate's own laws have.
pub(super) struct Written<L>(Option<L>);

impl<L: Serialize> Serialize for Written<L> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let law = self.0.as_ref().ok_or_else(|| {
            serde::ser::Error::custom(
                "a contact, a force element or a first-order state has a user's own law, which has \
                 no name to be written by; write the law's parameters beside the structure, and \
                 add the contact, the element or the state after reading",
            )
        })?;
        law.serialize(serializer)
    }
}

/// A law that is read, by its name.
#[derive(Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum LawText {
    Coulomb(Coulomb),
    Exponential(Exponential),
    Polynomial(Polynomial),
    Rational(Rational),
    Stribeck(Stribeck),
    Tabulated(Tabulated),
    Dry(AnyLaw),
    Directional(Directional<AnyLaw, AnyLaw>),
    Freewheel(Freewheel<AnyLaw>),
    Dwell(Dwell<AnyLaw>),
    Dahl(Dahl),
    LuGre(LuGre<AnyLaw>),
    #[serde(rename = "rate_state")]
    RateState(RateState),
}

impl LawText {
    /// The contact with this law.
    fn contact(self, direction: &[(usize, f64)], load: Drive) -> Result<super::Contact, Error> {
        use super::Contact;
        match self {
            Self::Coulomb(law) => Contact::along(direction, law, load),
            Self::Exponential(law) => Contact::along(direction, law, load),
            Self::Polynomial(law) => Contact::along(direction, law, load),
            Self::Rational(law) => Contact::along(direction, law, load),
            Self::Stribeck(law) => Contact::along(direction, law, load),
            Self::Tabulated(law) => Contact::along(direction, law, load),
            Self::Dry(law) => Contact::along(direction, AnyContactLaw::Dry(law), load),
            Self::Directional(law) => Contact::along(direction, law, load),
            Self::Freewheel(law) => Contact::along(direction, law, load),
            Self::Dwell(law) => Contact::along(direction, law, load),
            Self::Dahl(law) => Contact::along(direction, law, load),
            Self::LuGre(law) => Contact::along(direction, law, load),
            Self::RateState(law) => match law.try_into()? {
                AnyStates::One(law) => Contact::along(direction, law, load),
                AnyStates::Two(law) => Contact::along(direction, law, load),
            },
        }
    }
}

impl From<super::Contact> for ContactText<Written<NamedLaw>> {
    fn from(contact: super::Contact) -> Self {
        let direction = contact.direction();
        let is_plain = direction == [(contact.coordinate(), 1.0)];
        Self {
            coordinate: contact.coordinate(),
            direction: if is_plain {
                Vec::new()
            } else {
                direction.to_vec()
            },
            law: Written(contact.law().named()),
            load: contact.load().clone(),
            load_gradient: contact.load_gradient().to_vec(),
            load_laws: contact.load_laws().to_vec(),
            belt_velocity: contact.belt_velocity().clone(),
            tangential_stiffness: contact.tangential_stiffness(),
            normal_spring: contact.normal_spring,
        }
    }
}

impl TryFrom<ContactText<LawText>> for super::Contact {
    type Error = Error;
    fn try_from(read: ContactText<LawText>) -> Result<Self, Error> {
        let mut direction = read.direction;
        if direction.is_empty() {
            direction.push((read.coordinate, 1.0));
        }
        // The coordinate that names the contact comes first.
        sort_by(&mut direction, |&(i, _)| f64::from(i != read.coordinate));
        let mut contact = read.law.contact(&direction, read.load)?;
        for (coordinate, gradient) in read.load_gradient {
            contact = contact.with_load_gradient(coordinate, gradient)?;
        }
        if let Some(stiffness) = read.tangential_stiffness {
            contact = contact.with_tangential_stiffness(stiffness)?;
        }
        if let Some((direction, stiffness)) = read.normal_spring {
            contact = contact.with_normal_spring(&direction, stiffness)?;
        }
        let contact = contact
            .on_belt(read.belt_velocity)
            .with_load_laws(read.load_laws)?;
        contact.check_load()?;
        Ok(contact)
    }
}

/// A force element as it is written.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ElementText<L> {
    direction: Vec<(usize, f64)>,
    law: L,
    #[serde(default = "unchanged")]
    factor: Drive,
}

fn unchanged() -> Drive {
    Drive::constant(1.0)
}

impl From<super::ForceElement> for ElementText<Written<NamedForce>> {
    fn from(element: super::ForceElement) -> Self {
        // Only a user's field has several directions.
        Self {
            direction: element.directions().concat(),
            law: Written(element.law().named()),
            factor: element.factor().clone(),
        }
    }
}

impl TryFrom<ElementText<NamedForce>> for super::ForceElement {
    type Error = Error;
    fn try_from(read: ElementText<NamedForce>) -> Result<Self, Error> {
        Self::with(&[&read.direction], read.law.object())?.with_factor(read.factor)
    }
}

/// A first-order state as it is written.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FirstOrderText<L> {
    /// Left out for an integrator.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    time_constant: Option<f64>,
    #[serde(default = "Vec::new", skip_serializing_if = "Vec::is_empty")]
    displacements: Vec<(usize, f64)>,
    #[serde(default = "Vec::new", skip_serializing_if = "Vec::is_empty")]
    velocities: Vec<(usize, f64)>,
    #[serde(default = "Vec::new", skip_serializing_if = "Vec::is_empty")]
    states: Vec<(usize, f64)>,
    #[serde(default = "at_rest")]
    drive: Drive,
    #[serde(default = "Vec::new", skip_serializing_if = "Vec::is_empty")]
    laws: Vec<RateLawText<L>>,
    #[serde(default = "Vec::new", skip_serializing_if = "Vec::is_empty")]
    forces: Vec<(usize, f64)>,
}

/// A law in the rate of a first-order state as it is written.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct RateLawText<L> {
    of: Input,
    law: L,
}

impl From<super::FirstOrder> for FirstOrderText<Written<NamedForce>> {
    fn from(state: super::FirstOrder) -> Self {
        let laws = state.laws().iter().map(|law| RateLawText {
            of: law.input.clone(),
            law: Written(law.law.named()),
        });
        Self {
            time_constant: state.time_constant(),
            displacements: state.displacements().to_vec(),
            velocities: state.velocities().to_vec(),
            states: state.states().to_vec(),
            drive: state.drive().clone(),
            laws: laws.collect(),
            forces: state.forces().to_vec(),
        }
    }
}

/// A stop as it is written.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct StopText {
    direction: Vec<(usize, f64)>,
    gap: f64,
    #[serde(default)]
    restitution: f64,
    /// k and c.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    contact_stiffness: Option<(f64, f64)>,
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    adhesive: bool,
}

impl From<super::Stop> for StopText {
    fn from(stop: super::Stop) -> Self {
        Self {
            direction: stop.direction().to_vec(),
            gap: stop.gap(),
            restitution: stop.restitution(),
            contact_stiffness: stop.contact_stiffness(),
            adhesive: stop.is_adhesive(),
        }
    }
}

impl TryFrom<FirstOrderText<NamedForce>> for super::FirstOrder {
    type Error = Error;
    fn try_from(read: FirstOrderText<NamedForce>) -> Result<Self, Error> {
        let mut state = match read.time_constant {
            Some(time_constant) => Self::lag(time_constant)?,
            None => Self::integrator(),
        };
        state = state.with_drive(read.drive)?;
        for (coordinate, gain) in read.displacements {
            state = state.with_displacement(coordinate, gain)?;
        }
        for (coordinate, gain) in read.velocities {
            state = state.with_velocity(coordinate, gain)?;
        }
        for (number, gain) in read.states {
            state = state.with_state(number, gain)?;
        }
        for (coordinate, gain) in read.forces {
            state = state.with_force(coordinate, gain)?;
        }
        for RateLawText { of, law } in read.laws {
            let input = match of {
                Input::Direction(given) => Input::Direction(checked_direction(&given)?.1),
                Input::State(number) => Input::State(number),
            };
            state = state.and_law(input, law.object())?;
        }
        Ok(state)
    }
}

impl TryFrom<StopText> for super::Stop {
    type Error = Error;
    fn try_from(read: StopText) -> Result<Self, Error> {
        let mut stop = Self::along(&read.direction, read.gap, read.restitution)?;
        if let Some((stiffness, damping)) = read.contact_stiffness {
            stop = stop.with_contact_stiffness(stiffness, damping)?;
        }
        Ok(if read.adhesive { stop.adhesive() } else { stop })
    }
}

/// A structure as it is written.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct StructureText {
    /// The diagonal, if the mass matrix is diagonal.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    masses: Vec<f64>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    mass_matrix: Vec<Vec<f64>>,
    #[serde(default)]
    stiffness: Vec<Vec<f64>>,
    #[serde(default)]
    damping: Vec<Vec<f64>>,
    #[serde(default)]
    forces: Vec<Drive>,
    #[serde(default)]
    contacts: Vec<super::Contact>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    elements: Vec<super::ForceElement>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    first_orders: Vec<super::FirstOrder>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    stops: Vec<super::Stop>,
}

impl From<super::Structure> for StructureText {
    fn from(structure: super::Structure) -> Self {
        let mass = structure.mass_matrix();
        let is_diagonal = matches!(mass, std::borrow::Cow::Owned(_));
        let (masses, mass_matrix) = if is_diagonal {
            (structure.masses().to_vec(), Vec::new())
        } else {
            (Vec::new(), rows(&mass))
        };
        Self {
            masses,
            mass_matrix,
            stiffness: rows(structure.stiffness()),
            damping: rows(structure.damping()),
            forces: structure.forces().to_vec(),
            contacts: structure.contacts().to_vec(),
            elements: structure.elements().to_vec(),
            first_orders: structure.first_orders().to_vec(),
            stops: structure.stops().to_vec(),
        }
    }
}

impl TryFrom<StructureText> for super::Structure {
    type Error = Error;
    fn try_from(read: StructureText) -> Result<Self, Error> {
        let mut structure = if read.mass_matrix.is_empty() {
            Self::new(&read.masses)?
        } else {
            let names = [
                "rows of the mass matrix",
                "numbers in a row of the mass matrix",
            ];
            check_length("masses beside a mass matrix", read.masses.len(), 0)?;
            let n = read.mass_matrix.len();
            check_count(n)?;
            Self::with_mass_matrix(from_rows(&read.mass_matrix, n, names)?)?
        };
        if !read.stiffness.is_empty() {
            let names = [
                "rows of the stiffness matrix",
                "numbers in a row of the stiffness matrix",
            ];
            let matrix = from_rows(&read.stiffness, structure.len(), names)?;
            structure = structure.with_stiffness(matrix)?;
        }
        if !read.damping.is_empty() {
            let names = [
                "rows of the damping matrix",
                "numbers in a row of the damping matrix",
            ];
            let matrix = from_rows(&read.damping, structure.len(), names)?;
            structure = structure.with_damping(matrix)?;
        }
        if !read.forces.is_empty() {
            check_length("forces", read.forces.len(), structure.len())?;
        }
        for (i, force) in read.forces.into_iter().enumerate() {
            structure = structure.with_force(i, force)?;
        }
        for contact in read.contacts {
            structure = structure.with_contact(contact)?;
        }
        for element in read.elements {
            structure = structure.with_element(element)?;
        }
        for stop in read.stops {
            structure = structure.with_stop(stop)?;
        }
        structure.with_first_orders(read.first_orders)
    }
}

/// A matrix row by row.
fn rows(matrix: &DMatrix<f64>) -> Vec<Vec<f64>> {
    let rows = matrix.row_iter();
    rows.map(|row| row.iter().copied().collect()).collect()
}

fn from_rows(
    rows: &[Vec<f64>],
    expected: usize,
    [names, numbers]: [&'static str; 2],
) -> Result<DMatrix<f64>, Error> {
    check_length(names, rows.len(), expected)?;
    for row in rows {
        check_length(numbers, row.len(), expected)?;
    }
    Ok(DMatrix::from_fn(expected, expected, |i, j| rows[i][j]))
}

fn check_length(name: &'static str, found: usize, expected: usize) -> Result<(), Error> {
    if found == expected {
        return Ok(());
    }
    Err(Error::WrongSize {
        name,
        found,
        expected,
    })
}
