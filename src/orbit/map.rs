//! The period map, from the state at the start of a period to the state at its end, and its
//! derivative.

use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

use super::form::GeneralForm;
use super::hold::{Hold, Touch};
use super::multipliers::multipliers;
use super::passage::modes_after;
use super::tangent::{TangentFlow, flow_of};
use super::translation::{Translation, Turning, translations};
use super::unslipped::{Unslipped, never_slips, slip_by_rounding, unslipped};
use crate::clock::Clock;
use crate::error::Error;
use crate::friction::memory::Slip;
use crate::motion::{Event, Integrator, Mode, Segment};
use crate::numerics::least_norm::directions;
use crate::state::structure::State;
use crate::structure::Step;

/// A motion over one period, closed or not, with its derivative.
///
/// Vectors hold n displacements, n velocities and the memory variables of the contacts. At the end
/// the system is put back along the translations that no force depends on: the map is then P(x) −
/// φe, with φ such that the place of its start is kept, so that motions periodic up to a
/// translation are fixed points, and the multiplier of the translation is 0.
#[derive(Debug, Clone)]
pub struct PeriodMap {
    pub(super) start: State,
    /// The end, put back.
    pub(super) end: State,
    translations: Vec<Translation>,
    /// The displacements by which the end was put back, φe.
    translation: DVector<f64>,
    /// Velocities that nothing depends on.
    boosts: Vec<DVector<f64>>,
    /// The steps, at least one; the last is cut at the end of the period.
    pub(super) steps: Vec<Step>,
    /// The monodromy matrix: the derivative of the end with respect to the start.
    pub(super) monodromy: DMatrix<f64>,
    /// The rates of change of the state at its start and at its end, without a part along the
    /// translations.
    pub(super) flow: [DVector<f64>; 2],
    /// True for each memory variable on which anything depended.
    pub(super) depends: Vec<bool>,
    /// The unit of each memory variable: the change that changes a coefficient of friction by 1;
    /// infinite if none does.
    memory_units: Vec<f64>,
    /// The modes of the contacts after the end.
    end_modes: Vec<Mode>,
    /// The monodromy matrix of a closed motion that starts at a time at which most contacts stick,
    /// and the flow at this time.
    cycle: (DMatrix<f64>, DVector<f64>),
    /// The directions of sticking contacts that share coordinates there.
    held: Vec<DVector<f64>>,
    /// Contacts that never slip.
    unslipped: Vec<Unslipped>,
    /// Contacts that slip by rounding only, if the motion is closed.
    slip_by_rounding: Vec<usize>,
    /// The touches past which contacts are held.
    pub(super) touches: Vec<Touch>,
    /// True if friction is the same in both directions along the motion, where no contact remembers
    /// anything.
    pub(super) is_friction_even: bool,
}

/// Largest residual of a closed motion, in units of the sizes of its numbers and of the
/// magnification by the motion. Rounding alone causes about 1e-15.
pub(super) const CLOSED: f64 = 1e-11;

/// Singular values of the equations of a closed motion below this part of the largest count as 0:
/// the motion belongs to a continuous family.
pub(super) const SINGULAR: f64 = 1e-11;

/// The least size of a velocity, in units of the displacement per period: a coordinate that passes
/// 0 goes as far as its largest displacement and back within a period, so it is at least this fast.
/// One that hardly moves beside its static displacement is slower, and its velocity has the
/// rounding errors of that displacement.
const LEAST_VELOCITY: f64 = 2.0;

/// Displacements below this part of the largest displacement are rounding errors of 0, and
/// velocities below this part of the largest velocity. Masses at rest between a spring and an
/// elastic contact were seen with velocities of 65 ε of the largest.
const NODE: f64 = 1024.0 * f64::EPSILON;

impl PeriodMap {
    /// The state at the end of the period.
    pub fn end(&self) -> &State {
        &self.end
    }

    /// The steps of the motion.
    pub fn steps(&self) -> &[Step] {
        &self.steps
    }

    /// The derivative of the end with respect to the start.
    pub fn monodromy(&self) -> &DMatrix<f64> {
        &self.monodromy
    }

    /// Order of vectors and matrices.
    pub(super) fn order(&self) -> usize {
        self.monodromy.nrows()
    }

    /// The residual: end minus start; 0 for variables on which nothing depends.
    pub(super) fn residual(&self) -> DVector<f64> {
        let [start, end] = [&self.start, &self.end].map(|state| vector(state, self.order()));
        self.without_idle(end - start)
    }

    /// The residual of a motion near this one.
    pub(super) fn residual_near(&self, start: &State, end: &State) -> DVector<f64> {
        let [start, end] = [start, end].map(|state| vector(state, self.order()));
        let mut residual = end - start;
        self.untranslated(&mut residual);
        self.without_idle(residual)
    }

    /// A residual or a difference with 0 for variables on which nothing depends.
    pub(super) fn without_idle(&self, mut residual: DVector<f64>) -> DVector<f64> {
        self.idle().for_each(|i| residual[i] = 0.0);
        residual
    }

    /// The entries of the state on which nothing depends.
    fn idle(&self) -> impl Iterator<Item = usize> {
        let first = self.order() - self.depends.len();
        let idle = self.depends.iter().enumerate();
        idle.filter_map(move |(j, depends)| (!depends).then_some(first + j))
    }

    /// The time of the start.
    pub(super) fn begins(&self) -> f64 {
        self.steps.first().map_or(0.0, Segment::start_time)
    }

    /// The times of events and touches, in order.
    pub(super) fn times(&self) -> Vec<f64> {
        let events = self.steps.iter().flat_map(Segment::events);
        let begins = self.begins();
        let touches = self.touches.iter();
        let touches = touches.map(|touch| begins + touch.hold.since);
        let mut times: Vec<f64> = events.map(|event| event.time).chain(touches).collect();
        times.sort_by(f64::total_cmp);
        times
    }

    /// The holds of the motion from a later start.
    pub(super) fn holds_later(&self, by: f64, period: f64) -> Vec<Hold> {
        let touches = self.touches.iter();
        touches.map(|touch| touch.hold.later(by, period)).collect()
    }

    /// The largest residual, each number in units of its size.
    pub(super) fn miss(&self) -> f64 {
        self.residual().component_div(&self.sizes()).amax()
    }

    /// The factor by which the motion magnifies perturbations, at least 1: the largest derivative
    /// of a displacement or velocity at the end. Displacements and velocities are measured in units
    /// of the largest size of their kind, memory variables in units of their own sizes. So the
    /// factor depends neither on the units of the system nor on a memory that has decayed to 0, and
    /// a motion close to a constant one magnifies nothing.
    pub(super) fn growth(&self) -> f64 {
        let n = self.start.displacements.len();
        let mut sizes = self.sizes();
        let displacement = sizes.rows(0, n).amax();
        let velocity = sizes.rows(n, n).amax();
        sizes.rows_mut(0, n).fill(displacement);
        sizes.rows_mut(n, n).fill(velocity);
        let entries = (0..self.order()).flat_map(|j| (0..2 * n).map(move |i| (i, j)));
        let scaled = entries.map(|(i, j)| self.monodromy[(i, j)].abs() * (sizes[j] / sizes[i]));
        scaled.fold(1.0, f64::max)
    }

    /// Returns true if a closed motion is near: the residual is below the square root of its limit
    /// for a closed motion.
    pub(super) fn is_nearly_closed(&self) -> bool {
        self.miss() <= CLOSED.sqrt() * self.growth()
    }

    /// The state at a time, as a vector, displacements without their mean velocity; `None` outside
    /// the motion.
    pub(super) fn vector_at(&self, time: f64) -> Option<DVector<f64>> {
        let step = self.steps.iter().find(|step| time <= step.end_time())?;
        Some(self.still(&step.state_at(step.since_start(time)), time))
    }

    /// A state at a time, displacements without their mean velocity.
    fn still(&self, state: &State, time: f64) -> DVector<f64> {
        let mut state = vector(state, self.order());
        if !self.translations.is_empty() {
            let part = (time - self.begins()) / self.duration();
            let mut displacements = state.rows_mut(0, self.translation.len());
            displacements.axpy(-part, &self.translation, 1.0);
        }
        state
    }

    fn duration(&self) -> f64 {
        self.steps.iter().map(Segment::duration).sum()
    }

    /// Returns true if there are translations on which no force depends.
    pub(super) fn has_translations(&self) -> bool {
        !self.translations.is_empty()
    }

    /// The displacements by which the motion is translated over its duration.
    pub(super) fn translation(&self) -> &DVector<f64> {
        &self.translation
    }

    /// Removes the part along the translations from a perturbation or a residual.
    pub(super) fn untranslated(&self, change: &mut DVector<f64>) {
        for translation in &self.translations {
            translation.remove_from(change.as_mut_slice());
        }
    }

    /// The part of a coordinate's velocity that no translation changes.
    pub(super) fn turning(&self, coordinate: usize) -> Turning {
        Turning::relative(&self.translations, coordinate)
    }

    /// Replaces the end, and puts it back to the place of the start.
    pub(super) fn end_at(&mut self, end: DVector<f64>) {
        let start = vector(&self.start, self.order());
        let mut moved = end - &start;
        self.untranslated(&mut moved);
        self.end = state(&(start + moved), self.start.displacements.len());
    }

    /// The closed motion from time 0 of the drives, with the same derivatives: they remain those by
    /// the start.
    pub(super) fn since_zero(mut self, period: f64) -> Self {
        if self.begins() == 0.0 {
            return self;
        }
        let mut before = Vec::new();
        let mut steps = Vec::new();
        for step in std::mem::take(&mut self.steps) {
            let since = step.since_start(period);
            if since >= step.duration() {
                before.push(step);
                continue;
            }
            if since > 0.0 {
                before.push(step.clone().lasting(since));
            }
            let later = step.from(since.max(0.0));
            steps.push(later.earlier(period, self.translation.as_slice()));
        }
        steps.extend(before);
        self.steps = steps;
        if let [first, .., last] = &self.steps[..] {
            self.start = first.state().clone();
            let end = vector(&last.end_state(), self.order());
            self.end_at(end);
        }
        self
    }

    /// The modes of the contacts at the start.
    pub(super) fn first_modes(&self) -> Option<&[Mode]> {
        let first = self.steps.iter().find(|step| step.duration() > 0.0);
        first.map(|step| step.modes())
    }

    /// The modes of the contacts after the end.
    pub(super) fn end_modes(&self) -> &[Mode] {
        &self.end_modes
    }

    /// The events, each with the mode of its element afterwards.
    pub(super) fn events(&self) -> impl Iterator<Item = (&Event<State>, Mode)> {
        let steps = self.steps.iter().enumerate();
        steps.flat_map(|(i, step)| {
            let mut later = self.steps[i + 1..].iter();
            let next = later.find(|step| step.duration() > 0.0);
            let after = next.map_or(&self.end_modes[..], |step| step.modes());
            let events = step.events().iter();
            events.map(|event| {
                let mode = event.contact().map(|contact| after[contact]);
                (event, mode.unwrap_or(event.kind.mode()))
            })
        })
    }

    /// The Newton equations of x(T) = x(0), (M − 1)·Δx = −residual: each row in units of the size
    /// of its number, each column in those of a scale. Rows and columns of zeros follow for the
    /// other unknowns.
    pub(super) fn closing(
        &self,
        scale: &DVector<f64>,
        unknowns: usize,
    ) -> (DMatrix<f64>, DVector<f64>) {
        let (order, sizes) = (self.order(), self.sizes());
        let mut matrix = DMatrix::zeros(unknowns, unknowns);
        for i in 0..order {
            for j in 0..order {
                let identity = if i == j { 1.0 } else { 0.0 };
                matrix[(i, j)] = (self.monodromy[(i, j)] - identity) * (scale[j] / sizes[i]);
            }
        }
        for row in self.kept() {
            matrix.row_mut(row).fill(0.0);
            matrix[(row, row)] = scale[row] / sizes[row];
        }
        for Unslipped { row, slopes, .. } in &self.unslipped {
            for &(j, k) in slopes {
                matrix[(*row, j)] -= k * (scale[j] / sizes[*row]);
            }
        }
        (matrix, self.closing_by(&self.residual(), unknowns))
    }

    /// The Newton equations in units of the sizes. For an autonomous motion the relative increment
    /// of the period follows, in the unit that is returned, with the condition that the start stays
    /// on a plane with this normal.
    pub(super) fn equations(
        &self,
        normal: Option<&DVector<f64>>,
        period: f64,
    ) -> (DMatrix<f64>, DVector<f64>, f64) {
        let (order, sizes) = (self.order(), self.sizes());
        let unknowns = order + usize::from(normal.is_some());
        let (mut matrix, right) = self.closing(&sizes, unknowns);
        let mut unit = 1.0;
        if let Some(normal) = normal {
            let largest = normal.component_mul(&sizes).amax();
            for i in 0..order {
                matrix[(i, order)] = self.flow[1][i] * period / sizes[i];
                matrix[(order, i)] = normal[i] * sizes[i] / largest;
            }
            // What is kept does not depend on the period.
            self.kept()
                .into_iter()
                .for_each(|row| matrix[(row, order)] = 0.0);
            // Close to an equilibrium the flow is small, but the period is determined as well as
            // elsewhere.
            let largest = matrix.column(order).amax();
            if largest > 0.0 {
                unit = largest;
                matrix.column_mut(order).scale_mut(unit.recip());
            }
        }
        (matrix, right, unit)
    }

    /// The directions, in units of the sizes, in which the start of a closed motion has closed ones
    /// beside it to first order, without those of translations.
    pub(super) fn neutral(&self, is_free: bool, period: f64) -> Vec<DVector<f64>> {
        let (order, sizes) = (self.order(), self.sizes());
        let (mut matrix, ..) = self.equations(is_free.then_some(&self.flow[0]), period);
        // Positions of contacts that never slip are kept by the search, not by the motion.
        for Unslipped { row, .. } in &self.unslipped {
            for j in 0..order {
                let identity = if *row == j { 1.0 } else { 0.0 };
                let entry = self.monodromy[(*row, j)] - identity;
                matrix[(*row, j)] = entry * (sizes[j] / sizes[*row]);
            }
        }
        let Some(found) = directions(matrix, SINGULAR, order) else {
            return Vec::new();
        };
        let columns = found.column_iter();
        let columns = columns.map(|column| column.rows(0, order).into_owned());
        let scaled = columns.map(|direction| {
            let largest = direction[direction.icamax()];
            direction / largest
        });
        scaled.collect()
    }

    /// The number of families that are known without their directions: those of contacts that never
    /// slip, and of velocities that nothing depends on.
    pub(super) fn known_families(&self) -> usize {
        self.unslipped.len() + self.boosts.len()
    }

    /// The right-hand side of these equations for the residual of a motion near this one.
    pub(super) fn closing_by(&self, residual: &DVector<f64>, unknowns: usize) -> DVector<f64> {
        let mut right = -residual.component_div(&self.sizes());
        for row in self.kept() {
            right[row] = 0.0;
        }
        right.resize_vertically(unknowns, 0.0)
    }

    /// Entries of the state that closure does not determine, and which are kept: memory variables
    /// on which nothing depends, and the positions of contacts that never slip.
    pub(super) fn kept(&self) -> Vec<usize> {
        let unslipped = self.unslipped.iter().map(|unslipped| unslipped.row);
        self.idle().chain(unslipped).collect()
    }

    /// Returns true if contacts that slip neither in this closed motion nor in another one have the
    /// same positions in both: only a slip moves them. Differences are in units of the sizes, or of
    /// a scale if it is larger: the sizes of a structure at rest can be rounding errors of 0.
    pub(super) fn has_positions_of(&self, other: &Self, scale: &DVector<f64>) -> bool {
        let apart = vector(&self.start, self.order()) - vector(&other.start, self.order());
        let most = CLOSED * self.growth().max(other.growth());
        let sizes = self.sizes();
        let unslipped = self.unslipped();
        let stays = |contact| unslipped.contains(&contact) || self.slips_by_rounding(contact);
        let mut common = other.unslipped.iter().filter(|of| stays(of.contact));
        common.all(|Unslipped { row, slopes, .. }| {
            let along: f64 = slopes.iter().map(|&(j, k)| k * apart[j]).sum();
            (apart[*row] - along).abs() <= most * sizes[*row].max(scale[*row])
        })
    }

    /// Contacts that never slip, by their numbers.
    pub(super) fn unslipped(&self) -> Vec<usize> {
        let contacts = self.unslipped.iter();
        let mut contacts: Vec<_> = contacts.map(|unslipped| unslipped.contact).collect();
        contacts.sort_unstable();
        contacts
    }

    /// Returns true if a contact slips by rounding only, in a motion that is closed.
    pub(super) fn slips_by_rounding(&self, contact: usize) -> bool {
        self.slip_by_rounding.contains(&contact)
    }

    /// The largest size of each number of the state at the ends of steps, displacements without
    /// their mean velocity; for a velocity at least [`LEAST_VELOCITY`] times its displacement over
    /// the period, because near steady sliding a velocity is small or rounding only. A memory
    /// variable may be so small that it changes a friction coefficient by less than rounding,
    /// because it has decayed or is not used. Its size is the change that changes the coefficient
    /// by 1. Any other number that is 0, and a displacement or velocity that is a rounding error of
    /// 0 (as for a mass at a node), gets the size of the largest number of its kind.
    pub(super) fn sizes(&self) -> DVector<f64> {
        let mut sizes = DVector::zeros(self.order());
        let ends = self.steps.iter();
        let ends = ends.map(|step| self.still(&step.end_state(), step.end_time()));
        for state in std::iter::once(vector(&self.start, self.order())).chain(ends) {
            sizes.zip_apply(&state, |size: &mut f64, x: f64| *size = size.max(x.abs()));
        }
        let n = self.start.displacements.len();
        let period = self.duration();
        for i in 0..n {
            sizes[n + i] = sizes[n + i].max(LEAST_VELOCITY * sizes[i] / period);
        }
        let memory = sizes.iter_mut().skip(2 * n);
        for (size, unit) in memory.zip(&self.memory_units) {
            if unit.is_finite() && *size <= f64::EPSILON * unit {
                *size = *unit;
            }
        }
        let mut first = 0;
        for length in [n, n, self.order() - 2 * n] {
            let mut part = sizes.rows_mut(first, length);
            let largest = part.amax();
            let least = if largest > 0.0 { largest } else { 1.0 };
            let rounding = if first < 2 * n { NODE * largest } else { 0.0 };
            part.iter_mut()
                .filter(|x| **x <= rounding)
                .for_each(|x| *x = least);
            first += length;
        }
        sizes
    }

    /// The states at the ends and midpoints of steps, displacements without their mean velocity.
    fn states(&self) -> impl Iterator<Item = DVector<f64>> {
        self.steps.iter().flat_map(|step| {
            let since = 0.5 * step.duration();
            [
                self.still(&step.state_at(since), step.start_time() + since),
                self.still(&step.end_state(), step.end_time()),
            ]
        })
    }

    /// The extent of each number of the state: its largest distance from the start, at the ends and
    /// midpoints of steps. It does not depend on where the motion lies, as the sizes do.
    pub(super) fn extents(&self) -> DVector<f64> {
        let start = vector(&self.start, self.order());
        self.states()
            .fold(DVector::zeros(self.order()), |extents, state| {
                extents.sup(&(state - &start).abs())
            })
    }

    /// The largest displacement and the largest velocity of a vector.
    pub(super) fn largest(&self, vector: &DVector<f64>) -> [f64; 2] {
        let n = self.start.displacements.len();
        [0, n].map(|first| vector.rows(first, n).amax())
    }

    /// The eigenvalues of the derivative of a closed motion with respect to its start, without the
    /// 1 that belongs to a shift along an autonomous motion.
    pub(super) fn multipliers_by_start(&self, is_free: bool) -> Option<Vec<Complex<f64>>> {
        let shifts = self.shifts(is_free.then_some(&self.flow[0]));
        let mut found = multipliers(&self.monodromy, &shifts, &[], &self.sizes())?;
        found.truncate(found.len() - self.free_translations());
        Some(found)
    }

    /// The eigenvectors of multipliers 1 that are known: the flow of an autonomous motion, and
    /// velocities that nothing depends on.
    fn shifts(&self, flow: Option<&DVector<f64>>) -> Vec<DVector<f64>> {
        let boosts = self.boosts.iter().map(|boost| {
            let n = boost.len();
            DVector::from_fn(self.order(), |i, _| match i.checked_sub(n) {
                Some(j) if j < n => boost[j],
                _ => 0.0,
            })
        });
        flow.cloned().into_iter().chain(boosts).collect()
    }

    /// An orthonormal basis of the velocities that nothing depends on, in units of scales.
    fn free_velocities(&self, scales: &DVector<f64>) -> Option<DMatrix<f64>> {
        let boosts = self.shifts(None).into_iter();
        let boosts: Vec<_> = boosts.map(|boost| boost.component_div(scales)).collect();
        (!boosts.is_empty()).then(|| DMatrix::from_columns(&boosts).qr().q())
    }

    /// A vector without its part along the velocities that nothing depends on.
    pub(super) fn without_free_velocities(&self, vector: &DVector<f64>) -> DVector<f64> {
        let sizes = self.sizes();
        let mut scaled = vector.component_div(&sizes);
        if let Some(basis) = self.free_velocities(&sizes) {
            scaled -= &basis * basis.tr_mul(&scaled);
        }
        scaled.component_mul(&sizes)
    }

    /// The monodromy matrix in units of scales, with multipliers 0 for the velocities that nothing
    /// depends on: ±1 there would hide the others.
    pub(super) fn in_units(&self, scales: &DVector<f64>) -> DMatrix<f64> {
        let order = self.order();
        let mut matrix = DMatrix::from_fn(order, order, |i, j| {
            self.monodromy[(i, j)] * (scales[j] / scales[i])
        });
        if let Some(basis) = self.free_velocities(scales) {
            matrix -= &matrix * &basis * basis.transpose();
        }
        matrix
    }

    /// Number of directions in which nothing changes: translations, and velocities that nothing
    /// depends on.
    pub(super) fn known_directions(&self) -> usize {
        self.free_translations() + self.boosts.len()
    }

    /// Number of translations whose multiplier is 0 because the end is put back.
    fn free_translations(&self) -> usize {
        let translations = self.translations.iter();
        translations.filter(|found| !found.is_held).count()
    }

    /// The multipliers of a closed motion, by falling modulus. The 1 of a shift along an autonomous
    /// motion, of the position of each contact that never slips, of each translation and of each
    /// velocity on which nothing depends, are left out. `None` if
    /// they do not converge. At the tangential end of a branch the first is infinite, and the
    /// others are NaN.
    pub(super) fn multipliers(&self, is_free: bool) -> Option<Vec<Complex<f64>>> {
        let (matrix, flow) = &self.cycle;
        if self.touches.iter().any(|touch| touch.is_unbounded) {
            let left_out = self.unslipped.len() + usize::from(is_free) + self.boosts.len();
            let count = self.order() - left_out - self.free_translations();
            let first = std::iter::once(Complex::from(f64::INFINITY));
            let others = std::iter::repeat(Complex::from(f64::NAN));
            return Some(first.chain(others).take(count).collect());
        }
        let shifts = self.shifts(is_free.then_some(flow));
        // The place of a translation is put back, and its perturbation with it.
        let places = self.translations.iter().filter(|found| !found.is_held);
        let places = places.map(|found| found.row(self.order()));
        let held: Vec<_> = self.held.iter().cloned().chain(places).collect();
        let without_translations = |mut found: Vec<Complex<f64>>| {
            // They are 0, and the last.
            found.truncate(found.len() - self.free_translations());
            found
        };
        if self.unslipped.is_empty() {
            return multipliers(matrix, &shifts, &held, &self.sizes()).map(without_translations);
        }
        let mut basis = DMatrix::identity(self.order(), self.order());
        for Unslipped { row, slopes, .. } in &self.unslipped {
            for &(j, k) in slopes {
                basis[(*row, j)] += k;
            }
        }
        let rows: Vec<usize> = self
            .unslipped
            .iter()
            .map(|unslipped| unslipped.row)
            .collect();
        let basis = basis.remove_columns_at(&rows);
        let kept = |vector: &DVector<f64>| vector.clone().remove_rows_at(&rows);
        let matrix = (matrix * &basis).remove_rows_at(&rows);
        let held: Vec<_> = held.iter().map(|row| basis.tr_mul(row)).collect();
        let shifts: Vec<_> = shifts.iter().map(kept).collect();
        multipliers(&matrix, &shifts, &held, &kept(&self.sizes())).map(without_translations)
    }
}

/// A state as a vector. Missing memory variables are 0.
pub(super) fn vector(state: &State, order: usize) -> DVector<f64> {
    let numbers = state.displacements.iter().chain(&state.velocities);
    let numbers = numbers.chain(&state.memory).copied();
    DVector::from_iterator(order, numbers.chain(std::iter::repeat(0.0)).take(order))
}

/// The state of n coordinates from a vector.
pub(super) fn state(vector: &DVector<f64>, n: usize) -> State {
    let numbers = vector.as_slice();
    State::new(&numbers[..n], &numbers[n..2 * n]).with_memory(&numbers[2 * n..])
}

impl GeneralForm<'_> {
    /// The motion from a state at time 0 over a duration, with its derivative with respect to that
    /// state.
    pub fn period_map(&self, start: &State, duration: f64) -> Result<PeriodMap, Error> {
        period_map(self, 0.0, start, duration)
    }
}

/// The period map over a duration from a state at a time.
pub(super) fn period_map(
    form: &GeneralForm<'_>,
    time: f64,
    start: &State,
    duration: f64,
) -> Result<PeriodMap, Error> {
    held_period_map(form, (time, start), duration, &[])
}

/// The same with contacts held past touches.
pub(super) fn held_period_map(
    form: &GeneralForm<'_>,
    (time, start): (f64, &State),
    duration: f64,
    holds: &[Hold],
) -> Result<PeriodMap, Error> {
    let (n, order) = (form.len(), form.order());
    let settings = Integrator::new().with_max_steps(form.most_of_a_period())?;
    let end_time = time + duration;
    let identity = DMatrix::identity(order, order);
    let mut flow = TangentFlow::new(form, settings, (time, start), holds, identity)?;
    let mut steps: Vec<Step> = Vec::new();
    let mut first_flow = None;
    // The derivative from the start to the cut, after which `flow.tangents` begin again, and the
    // flow at the cut.
    let mut head = (DMatrix::identity(order, order), DVector::zeros(order));
    let mut held = Vec::new();
    let mut dead = 0;
    while steps.last().is_none_or(|step| step.end_time() < end_time) {
        let Some(step) = flow.fetch(end_time) else {
            break;
        };
        let step = step?;
        // Within a phase nothing vanishes.
        if step.duration() > 0.0 && flow.is_finished() {
            let rates = flow_of(&step, n);
            let rows = dead_rows(&flow.tangents);
            let sticking = held_by(form, step.modes());
            let dead_alone = |&(row, dead): &(usize, &bool)| *dead && !form.is_held(row);
            let now = rows.iter().enumerate().filter(dead_alone).count()
                + sticking.len()
                + forgetting(form, step.modes());
            if first_flow.is_none() || now > dead {
                let alive = rows.iter().map(|dead| f64::from(u8::from(!dead)));
                let alive = DMatrix::from_diagonal(&DVector::from_iterator(order, alive));
                let since = flow.replace(alive);
                head = (since * head.0, rates.clone());
                (dead, held) = (now, sticking);
            }
            first_flow.get_or_insert(rates);
        }
        flow.carry(&step)?;
        steps.push(step);
    }
    flow.finish()?;
    let Some(last) = steps.last() else {
        return Err(Error::InvalidDuration { value: duration });
    };
    let (end, last_flow) = (last.end_state(), flow_at_end(last, n));
    let mut monodromy = &flow.tangents * &head.0;
    let mut cycle = head.0 * &flow.tangents;
    let mut depends = flow.depends.clone();
    // The clock of a contact that never slips runs on, and only its limit follows.
    for c in (0..form.contacts()).filter(|&c| form.holds(c) && never_slips(&steps)(c)) {
        depends[form.model.memory(c)].fill(false);
    }
    for (j, depends) in depends.iter().enumerate() {
        if !depends {
            cycle.row_mut(2 * n + j).fill(0.0);
            cycle.column_mut(2 * n + j).fill(0.0);
        }
    }
    let end_modes = modes_after(last, || flow.fetch(f64::INFINITY))?;
    let translations = translations(form, never_slips(&steps));
    let [from, to] = [start, &end].map(|state| vector(state, order));
    let mut moved = &to - &from;
    let mut flows = [first_flow.unwrap_or_else(|| last_flow.clone()), last_flow];
    for translation in &translations {
        translation.remove_from(moved.as_mut_slice());
        for flow in flows.iter_mut().chain([&mut head.1]) {
            translation.remove_from(flow.as_mut_slice());
        }
        if !translation.is_held {
            translation.remove_from_columns(&mut monodromy);
            translation.remove_from_columns(&mut cycle);
        }
    }
    let (translation, end) = if translations.is_empty() {
        (DVector::zeros(n), end)
    } else {
        let back = from + moved;
        ((to - &back).rows(0, n).into_owned(), state(&back, n))
    };
    let unslipped = unslipped(form, &steps, [start, &end]);
    let slip_by_rounding = slip_by_rounding(form, &steps, &translation);
    Ok(PeriodMap {
        translations,
        translation,
        slip_by_rounding,
        boosts: form.freedom().velocities.clone(),
        unslipped,
        touches: flow.touches().to_vec(),
        is_friction_even: is_friction_even(form, &steps),
        start: start.clone(),
        end_modes,
        monodromy,
        flow: flows,
        depends,
        memory_units: form.memory_units(),
        cycle: (cycle, head.1),
        held,
        end,
        steps,
    })
}

/// Returns true if the limits of stick and the friction of slip are the same in both directions, at
/// the starts of all steps. Laws with memory are not asked: their memory has directions, too.
fn is_friction_even(form: &GeneralForm<'_>, steps: &[Step]) -> bool {
    const ROUNDING: f64 = 1e-12;
    let is_same = |[a, b]: [f64; 2]| (a - b).abs() <= ROUNDING * a.abs().max(b.abs());
    let mut contacts = form.model.contacts.iter();
    contacts.all(|contact| {
        let [backward, forward] = [-1.0, 1.0].map(|direction| contact.law.dry_slip(direction));
        let is_one_law =
            matches!((backward, forward), (Some(a), Some(b)) if std::ptr::addr_eq(a, b));
        if is_one_law || contact.is_elastic() || !contact.memory.is_empty() {
            return true;
        }
        contact.law.limits(&|_| 0.0).is_none_or(is_same)
            && steps.iter().all(|step| {
                let (time, velocities) = (step.start_time(), &step.state().velocities);
                let surface = contact.belt_velocity.at(Clock::at(time));
                let relative = contact.sliding_velocity(|j| velocities[j], surface, time);
                let speed = relative.abs();
                let piece = contact.piece_above(speed);
                is_same([-1.0, 1.0].map(|direction| {
                    let slip = Slip {
                        speed,
                        direction,
                        piece,
                    };
                    direction * contact.law.coefficient(slip, &|_| 0.0)
                }))
            })
    })
}

/// The start of a closed motion with the memory of contacts that slip as it is after a release,
/// where nothing depends on this memory; `None` if it is so already. Newton's method leaves such a
/// memory as any of its trials had it.
pub(super) fn released(form: &GeneralForm<'_>, map: &PeriodMap) -> Option<State> {
    let first_modes = map.first_modes()?;
    let mut start = map.start.clone();
    for (c, contact) in form.model.contacts.iter().enumerate() {
        let memory = form.model.memory(c);
        let is_idle = !map.depends[memory.clone()].contains(&true);
        if is_idle && form.holds(c) && matches!(first_modes[c], Mode::Slip(_)) {
            contact.law.caught(&mut start.memory[memory]);
        }
    }
    (start.memory != map.start.memory).then_some(start)
}

/// The period map of the same closed motion with another start, if the start is so near to an event
/// that rounding decides on which side of the event the end lies; otherwise `None`.
pub(super) fn begun_apart(
    form: &GeneralForm<'_>,
    map: &PeriodMap,
    period: f64,
) -> Result<Option<PeriodMap>, Error> {
    /// Part of the period within which an event is near.
    const NEAR: f64 = 1e-6;
    let events = map.steps.iter().flat_map(Segment::events);
    let mut times = events.map(|event| event.time);
    let near = NEAR * period..(1.0 - NEAR) * period;
    let is_near = |time: f64| !near.contains(&(time - map.begins()));
    if !times.any(is_near) && map.first_modes() == Some(&map.end_modes[..]) {
        return Ok(None);
    }
    let time = longest_pause(map, map.begins(), map.begins() + period);
    let step = map.steps.iter().find(|step| step.end_time() > time);
    let Some(step) = step else {
        return Ok(None);
    };
    let mut state = step.state_at(step.since_start(time));
    form.put_in_modes(&mut state, time, &|c| Some(step.modes()[c]));
    let holds = map.holds_later(time - map.begins(), period);
    held_period_map(form, (time, &state), period, &holds).map(Some)
}

/// The middle of the longest time without an event or a touch between two times.
pub(super) fn longest_pause(map: &PeriodMap, from: f64, to: f64) -> f64 {
    let mut last = from;
    let times = map.times().into_iter().chain([to]);
    let gaps = times.map(|time| (std::mem::replace(&mut last, time), time));
    let gap = gaps.max_by(|a, b| (a.1 - a.0).total_cmp(&(b.1 - b.0)));
    gap.map_or(from, |(from, to)| 0.5 * (from + to))
}

/// Perturbations of the start of a motion, carried on to a time.
pub(super) fn carried(
    form: &GeneralForm<'_>,
    map: &PeriodMap,
    tangents: DMatrix<f64>,
    time: f64,
) -> Result<DMatrix<f64>, Error> {
    let settings = Integrator::new().with_max_steps(form.most_of_a_period())?;
    let start = (map.begins(), &map.start);
    let mut flow = TangentFlow::new(form, settings, start, &[], tangents)?;
    while let Some(step) = flow.fetch(time) {
        let step = step?;
        flow.carry(&step)?;
        if step.end_time() >= time {
            break;
        }
    }
    flow.finish()?;
    Ok(flow.tangents)
}

/// The directions of sticking contacts that share coordinates, as rows for states.
fn held_by(form: &GeneralForm<'_>, modes: &[Mode]) -> Vec<DVector<f64>> {
    let model = &form.model;
    let sticking = model.shared.iter().filter(|&&c| modes[c] == Mode::Stick);
    let rows = sticking.map(|&c| {
        let mut row = DVector::zeros(form.order());
        for &(j, b) in model.contacts[c].direction.iter() {
            row[form.len() + j] = b;
        }
        row
    });
    rows.collect()
}

/// The number of elastic contacts that do not stick: their forces do not depend on their past.
fn forgetting(form: &GeneralForm<'_>, modes: &[Mode]) -> usize {
    let elastic = (0..form.contacts()).filter(|&c| !form.holds(c));
    elastic.filter(|&c| modes[c] != Mode::Stick).count()
}

/// True for each row that is all zero, so that perturbations of this coordinate have vanished.
fn dead_rows(matrix: &DMatrix<f64>) -> Vec<bool> {
    let rows = matrix.row_iter();
    rows.map(|row| row.iter().all(|x| *x == 0.0)).collect()
}

/// The rates of change of all numbers at the end of a step.
fn flow_at_end(step: &Step, n: usize) -> DVector<f64> {
    let velocities = step.end_state().velocities;
    let rates = step.series().iter();
    let rates = rates.map(|series| series.derivative().at(step.duration()));
    DVector::from_iterator(n + step.series().len(), velocities.into_iter().chain(rates))
}
