//! The laws of all contacts behind one trait object: the engine is compiled once, whatever the
//! laws.
//!
//! What is asked of numbers is asked for one contact at a time. The two loops that run the law all
//! the time, the orders of an expansion and the four places of a look at its defect, lie behind the
//! seam, with the law inlined.

use std::fmt;

use super::expansion::{self, Course};
use super::model::Model;
use super::parts::{Body, Joint};
use crate::friction::memory::{ContactLaw, Motion, Slip};
use crate::series::PowerSeries;

/// The numbers that a contact remembers, by their place.
pub(crate) type Memory<'m> = &'m dyn Fn(usize) -> f64;

/// The laws of all contacts of a structure.
pub(crate) trait Laws {
    /// How many numbers each contact remembers.
    fn memory(&self) -> usize;
    /// Speeds at which pieces of a law meet.
    fn breakpoints(&self, contact: usize) -> Vec<f64>;
    /// μ(r, z).
    fn coefficient(&self, contact: usize, slip: Slip<f64>, memory: Memory<'_>) -> f64;
    /// The defects of a step of length h at a contact that slips with these sliding speeds.
    fn defects(
        &self,
        contact: usize,
        joint: &Joint,
        speeds: &PowerSeries,
        h: f64,
        unit: f64,
    ) -> [f64; 3];
    /// μ_s(z).
    fn limit(&self, contact: usize, memory: Memory<'_>) -> Option<f64>;
    /// dz/dt: the place of each number, and its rate.
    fn rates(
        &self,
        contact: usize,
        motion: Motion<f64>,
        memory: Memory<'_>,
        take: &mut dyn FnMut(usize, f64),
    );
    /// What becomes of the memory where slip ends in stick, or stick in slip.
    fn caught(&self, contact: usize, memory: &mut [f64]);
    /// All orders of the series of all coordinates.
    fn expand(
        &self,
        model: &Model<'_>,
        bodies: &mut [Body],
        joints: &mut [Joint],
        courses: &mut [Course],
    );
}

impl fmt::Debug for dyn Laws + '_ {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Laws")
    }
}

/// The laws of contacts, of one type.
pub(crate) struct Typed<'s, L, const Z: usize>(pub(crate) Vec<&'s L>);

impl<L: ContactLaw<Z>, const Z: usize> Laws for Typed<'_, L, Z> {
    fn memory(&self) -> usize {
        Z
    }

    fn breakpoints(&self, contact: usize) -> Vec<f64> {
        self.0[contact].breakpoints().collect()
    }

    fn coefficient(&self, contact: usize, slip: Slip<f64>, memory: Memory<'_>) -> f64 {
        self.0[contact].coefficient(slip, std::array::from_fn(memory))
    }

    fn defects(
        &self,
        contact: usize,
        joint: &Joint,
        speeds: &PowerSeries,
        h: f64,
        unit: f64,
    ) -> [f64; 3] {
        joint.defects(self.0[contact], speeds, h, unit)
    }

    fn limit(&self, contact: usize, memory: Memory<'_>) -> Option<f64> {
        self.0[contact].limit(0.0, std::array::from_fn(memory))
    }

    fn rates(
        &self,
        contact: usize,
        motion: Motion<f64>,
        memory: Memory<'_>,
        take: &mut dyn FnMut(usize, f64),
    ) {
        let rates = self.0[contact].rates(motion, std::array::from_fn(memory));
        for (j, rate) in rates.into_iter().enumerate() {
            take(j, rate);
        }
    }

    fn caught(&self, contact: usize, memory: &mut [f64]) {
        let caught = self.0[contact].caught(std::array::from_fn(|j| memory[j]));
        memory.copy_from_slice(&caught);
    }

    fn expand(
        &self,
        model: &Model<'_>,
        bodies: &mut [Body],
        joints: &mut [Joint],
        courses: &mut [Course],
    ) {
        expansion::expand(&self.0, model, bodies, joints, courses);
    }
}
