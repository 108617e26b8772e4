//! The constant data of a first-order state.

use std::sync::Arc;

use nalgebra::DMatrix;

use super::contact_data::Entries;
use super::coordinate_series::DisplacementSeries;
use super::element_data::sum;
use crate::drive::Drive;
use crate::series::PowerSeries;

/// The constant data of a first-order state.
#[derive(Debug, Clone)]
pub(crate) struct FirstOrderData {
    /// The rows of A_q, A_v and A_z.
    pub(crate) displacements: Vec<(usize, f64)>,
    pub(crate) velocities: Vec<(usize, f64)>,
    pub(crate) states: Vec<(usize, f64)>,
    /// u = drive/T.
    pub(crate) drive: Arc<Drive>,
    pub(crate) scale: f64,
    /// b.
    pub(crate) forces: Vec<(usize, f64)>,
    /// M⁻¹b.
    pub(crate) responses: Vec<(usize, f64)>,
    /// True if anything depends on it, also through other states, or its own rate.
    pub(crate) acts: bool,
}

impl FirstOrderData {
    /// A_q q + A_v v + A_z z.
    pub(crate) fn rate(
        &self,
        q: impl Fn(usize) -> f64,
        v: impl Fn(usize) -> f64,
        z: impl Fn(usize) -> f64,
    ) -> f64 {
        sum(&self.displacements, q) + sum(&self.velocities, v) + sum(&self.states, z)
    }

    /// The size of the terms of the rate, without drives and laws.
    pub(super) fn rate_size<'c>(
        &self,
        motion: impl Fn(usize) -> &'c DisplacementSeries,
        states: &[PowerSeries],
    ) -> f64 {
        let size = |entries: &Entries, x: &dyn Fn(usize) -> f64| {
            entries.iter().map(|&(j, a)| (a * x(j)).abs()).sum::<f64>()
        };
        size(&self.displacements, &|j| motion(j).displacement(0))
            + size(&self.velocities, &|j| motion(j).velocity(0))
            + size(&self.states, &|k| states[k][0])
    }

    /// The factor of its own value in its rate.
    fn own(&self, number: usize) -> f64 {
        entry_of(&self.states, number)
    }
}

/// Subtracts the states from the equations of rest, in which they follow the n displacements: M⁻¹b
/// from those of the coordinates, A_q and A_z from their own.
pub(crate) fn subtract(states: &[FirstOrderData], stiffness: &mut DMatrix<f64>, n: usize) {
    for (state, row) in std::iter::zip(states, n..) {
        for &(i, x) in &state.responses {
            stiffness[(i, row)] -= x;
        }
        for &(j, a) in &state.displacements {
            stiffness[(row, j)] -= a;
        }
        for &(k, a) in &state.states {
            stiffness[(row, n + k)] -= a;
        }
    }
}

/// The sum of the entries with a number.
fn entry_of(entries: &Entries, number: usize) -> f64 {
    let own = entries.iter().filter(|(j, _)| *j == number);
    own.map(|(_, x)| x).sum()
}

/// Marks the states on which anything depends.
pub(super) fn find_acting(states: &mut [FirstOrderData], read: &[bool]) {
    for (number, (state, read)) in std::iter::zip(&mut *states, read).enumerate() {
        state.acts = *read || !state.forces.is_empty() || state.own(number) != 0.0;
    }
    loop {
        let acting = states.iter().filter(|state| state.acts);
        let inputs = acting.flat_map(|state| state.states.iter().map(|&(k, _)| k));
        let inputs: Vec<usize> = inputs.collect();
        let next = inputs.into_iter().filter(|&k| !states[k].acts);
        let next: Vec<usize> = next.collect();
        if next.is_empty() {
            return;
        }
        next.into_iter().for_each(|k| states[k].acts = true);
    }
}

/// The largest rate of states and of their loops with coordinates and with each other; it does not
/// depend on the units of states.
pub(super) fn fastest_loop(states: &[FirstOrderData]) -> f64 {
    let rates = states.iter().enumerate().flat_map(|(number, state)| {
        let around = |inputs: &Entries| {
            let sizes = inputs
                .iter()
                .map(|&(j, a)| (a * entry_of(&state.responses, j)).abs());
            sizes.sum::<f64>()
        };
        let with_others = state.states.iter().filter(move |(k, _)| *k != number);
        let with_others = with_others.map(move |&(k, a)| {
            let back = entry_of(&states[k].states, number);
            (a * back).abs().sqrt()
        });
        let own = [
            state.own(number).abs(),
            around(&state.displacements).cbrt(),
            around(&state.velocities).sqrt(),
        ];
        own.into_iter().chain(with_others)
    });
    rates.fold(0.0, f64::max)
}
