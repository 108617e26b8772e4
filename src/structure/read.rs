//! How structures are written and read (feature `serde`): matrices as lists of rows; read through
//! the checks of the constructors.

use nalgebra::DMatrix;
use serde::{Deserialize, Serializer};

use crate::drive::Drive;
use crate::error::Error;
use crate::friction::memory::ContactLaw;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Contact<L> {
    coordinate: usize,
    law: L,
    load: Drive,
    #[serde(default)]
    load_gradient: Vec<(usize, f64)>,
    #[serde(default)]
    belt_velocity: Option<Drive>,
}

impl<L: ContactLaw<Z>, const Z: usize> TryFrom<Contact<L>> for super::Contact<L, Z> {
    type Error = Error;
    fn try_from(read: Contact<L>) -> Result<Self, Error> {
        let mut contact = Self::new(read.coordinate, read.law, read.load)?;
        for (coordinate, gradient) in read.load_gradient {
            contact = contact.with_load_gradient(coordinate, gradient)?;
        }
        Ok(match read.belt_velocity {
            Some(velocity) => contact.on_belt(velocity),
            None => contact,
        })
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
#[serde(bound(deserialize = "L: ContactLaw<Z> + Deserialize<'de>"))]
pub(super) struct Structure<L, const Z: usize> {
    masses: Vec<f64>,
    #[serde(default)]
    stiffness: Vec<Vec<f64>>,
    #[serde(default)]
    damping: Vec<Vec<f64>>,
    #[serde(default)]
    forces: Vec<Drive>,
    #[serde(default)]
    contacts: Vec<super::Contact<L, Z>>,
}

impl<L: ContactLaw<Z>, const Z: usize> TryFrom<Structure<L, Z>> for super::Structure<L, Z> {
    type Error = Error;
    fn try_from(read: Structure<L, Z>) -> Result<Self, Error> {
        let mut structure = Self::new(&read.masses)?;
        if !read.stiffness.is_empty() {
            let names = ["rows of the stiffness matrix", "numbers in a row of it"];
            let matrix = from_rows(&read.stiffness, structure.len(), names)?;
            structure = structure.with_stiffness(matrix)?;
        }
        if !read.damping.is_empty() {
            let names = ["rows of the damping matrix", "numbers in a row of it"];
            let matrix = from_rows(&read.damping, structure.len(), names)?;
            structure = structure.with_damping(matrix)?;
        }
        if !read.forces.is_empty() {
            check_count("forces", read.forces.len(), structure.len())?;
        }
        for (i, force) in read.forces.into_iter().enumerate() {
            structure = structure.with_force(i, force)?;
        }
        for contact in read.contacts {
            structure = structure.with_contact(contact)?;
        }
        Ok(structure)
    }
}

/// A square matrix row by row.
pub(super) fn rows<S: Serializer>(matrix: &DMatrix<f64>, serializer: S) -> Result<S::Ok, S::Error> {
    let rows = matrix.row_iter();
    serializer.collect_seq(rows.map(|row| row.iter().copied().collect::<Vec<f64>>()))
}

fn from_rows(
    rows: &[Vec<f64>],
    expected: usize,
    [names, numbers]: [&'static str; 2],
) -> Result<DMatrix<f64>, Error> {
    check_count(names, rows.len(), expected)?;
    for row in rows {
        check_count(numbers, row.len(), expected)?;
    }
    Ok(DMatrix::from_fn(expected, expected, |i, j| rows[i][j]))
}

fn check_count(name: &'static str, found: usize, expected: usize) -> Result<(), Error> {
    if found == expected {
        return Ok(());
    }
    Err(Error::WrongSize {
        name,
        found,
        expected,
    })
}
