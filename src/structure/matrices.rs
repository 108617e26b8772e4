//! Checks of the matrices of a structure, and additions to them.

use nalgebra::DMatrix;

use super::direction::check_coordinates;
use crate::error::{Element, Error};

/// The largest number of coordinates: a matrix of this size takes 128 MiB.
pub(super) const MAX_COORDINATES: usize = 4096;

/// Checks the number of coordinates. Called before a matrix of this size exists.
pub(super) fn check_count(coordinates: usize) -> Result<(), Error> {
    const { assert!(MAX_COORDINATES == 4096) } // the number in the message
    let allowed = "at least 1 and at most 4096: their number; reduce a larger model to its first \
                   modes";
    let in_range = (1..=MAX_COORDINATES).contains(&coordinates);
    Error::check("Structure", "masses", coordinates as f64, in_range, allowed).map(drop)
}

/// The largest number of contacts: the couplings of this number take 256 MiB.
pub(super) const MAX_CONTACTS: usize = 4096;

/// Checks the number of contacts.
pub(super) fn check_contacts(contacts: usize) -> Result<(), Error> {
    const { assert!(MAX_CONTACTS == 4096) } // the number in the message
    let allowed = "at most 4096: their number; replace contacts of the same direction by one";
    let in_range = contacts <= MAX_CONTACTS;
    Error::check("Structure", "contacts", contacts as f64, in_range, allowed).map(drop)
}

/// The largest number of first-order states, as that of coordinates.
pub(super) const MAX_FIRST_ORDERS: usize = 4096;

/// Checks the number of first-order states.
pub(super) fn check_first_orders(states: usize) -> Result<(), Error> {
    const { assert!(MAX_FIRST_ORDERS == 4096) } // the number in the message
    let allowed = "at most 4096: their number; reduce a larger linear part to its slow states";
    let in_range = states <= MAX_FIRST_ORDERS;
    Error::check(
        "Structure",
        "first_orders",
        states as f64,
        in_range,
        allowed,
    )
    .map(drop)
}

/// Checks the masses of a structure.
pub(super) fn check_masses(
    masses: &[f64],
    element: impl Fn(usize) -> Element,
) -> Result<(), Error> {
    check_count(masses.len())?;
    for (i, &mass) in masses.iter().enumerate() {
        Error::check("Structure", "mass", mass, mass > 0.0, "mass > 0")
            .map_err(|error| error.of_element(element(i)))?;
    }
    Ok(())
}

/// Takes the mean of the entries (i, j) and (j, i), which may differ by rounding.
pub(super) fn make_symmetric(mass: &mut DMatrix<f64>) -> Result<(), Error> {
    for i in 0..mass.nrows() {
        for j in 0..i {
            for (row, column) in [(i, j), (j, i)] {
                let value = mass[(row, column)];
                Error::check("Structure", "mass", value, true, "a finite number")
                    .map_err(|error| error.of_element(Element::MassMatrix(row, column)))?;
            }
            let entries = [mass[(j, i)], mass[(i, j)]];
            let size = mass[(i, i)].sqrt() * mass[(j, j)].sqrt();
            if (entries[0] - entries[1]).abs() > 4.0 * f64::EPSILON * size {
                let (row, column) = (j, i);
                return Err(Error::NotSymmetric { row, column });
            }
            let mean = 0.5 * entries[0] + 0.5 * entries[1];
            (mass[(i, j)], mass[(j, i)]) = (mean, mean);
        }
    }
    Ok(())
}

/// Checks that a symmetric matrix is positive definite, by Cholesky's factorisation.
pub(super) fn check_definite(mass: &DMatrix<f64>) -> Result<(), Error> {
    let n = mass.nrows();
    let mut rest = mass.clone();
    for row in 0..n {
        let pivot = rest[(row, row)];
        let is_positive = pivot > n as f64 * f64::EPSILON * mass[(row, row)];
        if !is_positive {
            return Err(Error::NotPositiveDefinite { row });
        }
        for i in row + 1..n {
            let factor = rest[(i, row)] / pivot;
            for j in row + 1..=i {
                rest[(i, j)] -= factor * rest[(j, row)];
            }
        }
    }
    Ok(())
}

/// Adds a value at one place of a matrix of a structure.
pub(super) fn add(
    matrix: &mut DMatrix<f64>,
    element: Element,
    (i, j): (usize, usize),
    value: f64,
) -> Result<(), Error> {
    check_coordinates(element, [i, j].into_iter(), matrix.nrows())?;
    let sum = matrix[(i, j)] + value;
    Error::check("Structure", "value", value, sum.is_finite(), "a finite sum")
        .map_err(|error| error.of_element(element))?;
    matrix[(i, j)] = sum;
    Ok(())
}

/// Adds a spring or damper between two coordinates.
pub(super) fn add_between(
    matrix: &mut DMatrix<f64>,
    element: Element,
    (i, j): (usize, usize),
    value: f64,
) -> Result<(), Error> {
    if i == j {
        return Err(Error::BadElement {
            element,
            value,
            allowed: "between two different coordinates; there is another method for the ground",
        });
    }
    for (row, column, sign) in [(i, i, 1.0), (j, j, 1.0), (i, j, -1.0), (j, i, -1.0)] {
        add(matrix, element, (row, column), sign * value)?;
    }
    Ok(())
}

/// Adds a whole matrix.
pub(super) fn add_matrix(
    matrix: &mut DMatrix<f64>,
    added: &DMatrix<f64>,
    [rows, columns]: [&'static str; 2],
    element: impl Fn(usize, usize) -> Element,
) -> Result<(), Error> {
    let expected = matrix.nrows();
    for (name, found) in [(rows, added.nrows()), (columns, added.ncols())] {
        if found != expected {
            return Err(Error::WrongSize {
                name,
                found,
                expected,
            });
        }
    }
    for i in 0..expected {
        for j in 0..expected {
            add(matrix, element(i, j), (i, j), added[(i, j)])?;
        }
    }
    Ok(())
}
