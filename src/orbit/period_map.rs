//! The period map, from the state at the start of a period to the state at its end, and its
//! derivative: the equations that close a motion, their units and the multipliers.

pub(super) mod run;

use nalgebra::{DMatrix, DVector, DVectorView};
use num_complex::Complex;

use super::course::{Course, since_zero};
use super::multipliers::multipliers;
use super::prescribed_modes::{Hold, Touch, minima_in_slip, speeds};
use super::translation::{Translation, Turning};
use super::type_erased_system::GeneralForm;
use super::unslipped::Unslipped;
use crate::error::Error;
use crate::motion::{Event, Mode, Segment};
use crate::numerics::least_norm::directions;
use crate::state::Direction;
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
    /// Contacts whose sliding speeds may touch 0.
    touching: Vec<usize>,
    /// The touches past which contacts are held, and how they were looked for.
    pub(super) touches: Vec<Touch>,
    holds: Vec<Hold>,
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

    /// The times, in order, at which events happen or may begin to happen along a curve: those of
    /// events, of touches, and of minima of sliding speeds near 0.
    pub(super) fn times(&self) -> Vec<f64> {
        /// A minimum up to this part of the largest sliding speed is near 0.
        const NEAR: f64 = 0.1;
        let events = self.steps.iter().flat_map(Segment::events);
        let begins = self.begins();
        let touches = self.touches.iter();
        let touches = touches.map(|touch| begins + touch.hold.since);
        let mut times: Vec<f64> = events.map(|event| event.time).chain(touches).collect();
        for &contact in &self.touching {
            let starts = self.steps.iter();
            let starts = starts.map(|step| speeds(step, contact, Direction::Leading)[0].abs());
            let largest = starts.fold(0.0, f64::max);
            minima_in_slip(&self.steps, contact, &mut |step, t, _, speeds| {
                if speeds.at(t).abs() <= NEAR * largest {
                    times.push(step.start_time() + t);
                }
            });
        }
        times.sort_by(f64::total_cmp);
        times
    }

    /// The holds of the motion from a later start.
    pub(super) fn holds_later(&self, by: f64, period: f64) -> Vec<Hold> {
        let touches = self.touches.iter();
        touches.map(|touch| touch.hold.later(by, period)).collect()
    }

    /// The largest residual, each number in units of its errors.
    pub(super) fn miss(&self) -> f64 {
        self.residual()
            .component_div(&self.units_of_errors())
            .amax()
    }

    /// The largest residual, with memory variables also in units of their errors in the motion
    /// before: one that only decays shrinks from trial to trial, and its units with it.
    pub(super) fn miss_after(&self, before: &Self) -> f64 {
        let mut units = self.units_of_errors();
        let first = 2 * self.start.displacements.len();
        for (unit, earlier) in std::iter::zip(&mut units, &before.units_of_errors()).skip(first) {
            *unit = unit.max(*earlier);
        }
        self.residual().component_div(&units).amax()
    }

    /// The sizes of the numbers whose rounding errors each number has: its own, and where a contact
    /// never slips those of the displacements that it follows.
    pub(super) fn units_of_errors(&self) -> DVector<f64> {
        let mut sizes = self.sizes();
        for Unslipped { row, slopes, .. } in &self.unslipped {
            let followed = slopes.iter().map(|&(j, k)| k.abs() * sizes[j]);
            sizes[*row] = sizes[*row].max(followed.sum());
        }
        sizes
    }

    /// The error if this motion does not close.
    pub(super) fn not_periodic(&self, period: f64) -> Error {
        Error::NotPeriodic {
            residual: self.miss(),
            period,
            start: self.start.clone(),
        }
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
        let steps = std::mem::take(&mut self.steps);
        self.steps = since_zero(steps, period, self.translation.as_slice());
        if let [first, .., last] = &self.steps[..] {
            self.start = first.state().clone();
            let end = vector(&last.end_state(), self.order());
            self.end_at(end);
        }
        self
    }

    /// What the motion is computed again from.
    pub(super) fn course(&self) -> Course {
        Course {
            time: self.begins(),
            start: self.start.clone(),
            holds: self.holds.clone(),
            translation: self.translation.as_slice().to_vec(),
        }
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

    /// Sets the column behind those of the state: the change of the end with the period, in a unit
    /// of time. What is kept does not depend on the period.
    pub(super) fn close_by_period(&self, matrix: &mut DMatrix<f64>, unit: f64) {
        let (order, sizes) = (self.order(), self.sizes());
        for i in 0..order {
            matrix[(i, order)] = self.flow[1][i] * (unit / sizes[i]);
        }
        for row in self.kept() {
            matrix[(row, order)] = 0.0;
        }
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
                matrix[(order, i)] = normal[i] * sizes[i] / largest;
            }
            self.close_by_period(&mut matrix, period);
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
    /// beside it to first order, without those of translations; each with the relative change of
    /// the period.
    pub(super) fn neutral(&self, is_free: bool, period: f64) -> Vec<(DVector<f64>, f64)> {
        let (order, sizes) = (self.order(), self.sizes());
        let (mut matrix, _, unit) = self.equations(is_free.then_some(&self.flow[0]), period);
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
        let scaled = found.column_iter().map(|column| {
            let (direction, longer) = self.changes(column, unit);
            let largest = direction[direction.icamax()];
            (direction / largest, longer / largest)
        });
        scaled.collect()
    }

    /// The change of the start, in units of the sizes, and the relative change of the period, from
    /// the unknowns of the [equations](Self::equations).
    pub(super) fn changes(&self, unknowns: DVectorView<'_, f64>, unit: f64) -> (DVector<f64>, f64) {
        let longer = unknowns.get(self.order()).map_or(0.0, |last| last / unit);
        (unknowns.rows(0, self.order()).into_owned(), longer)
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

    /// The [`sizes`] at the ends of steps, displacements without their mean velocity; of velocities
    /// at least [`LEAST_VELOCITY`] times those of their displacements over the period.
    pub(super) fn sizes(&self) -> DVector<f64> {
        let mut largest = DVector::zeros(self.order());
        let ends = self.steps.iter();
        let ends = ends.map(|step| self.still(&step.end_state(), step.end_time()));
        for state in std::iter::once(vector(&self.start, self.order())).chain(ends) {
            enlarge(&mut largest, &state);
        }
        let n = self.start.displacements.len();
        let time = self.duration() / LEAST_VELOCITY;
        sizes(largest, n, time, &self.memory_units)
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

/// Raises the largest size of each number to that in a state.
pub(super) fn enlarge(largest: &mut DVector<f64>, state: &DVector<f64>) {
    largest.zip_apply(state, |size: &mut f64, x: f64| *size = size.max(x.abs()));
}

/// The size of each number of a state of n coordinates, from the largest in a motion; for a
/// velocity at least that of its displacement over a time, because near steady sliding a velocity
/// is small or rounding only. A memory variable may be so small that it changes a friction
/// coefficient by less than rounding, because it has decayed or is not used. Its size is the change
/// that changes the coefficient by 1. Any other number that is 0, and a displacement or velocity
/// that is a rounding error of 0 (as for a mass at a node), gets the size of the largest number of
/// its kind.
pub(super) fn sizes(
    largest: DVector<f64>,
    n: usize,
    time: f64,
    memory_units: &[f64],
) -> DVector<f64> {
    let mut sizes = largest;
    for i in 0..n {
        sizes[n + i] = sizes[n + i].max(sizes[i] / time);
    }
    let memory = sizes.iter_mut().skip(2 * n);
    for (size, unit) in memory.zip(memory_units) {
        if unit.is_finite() && *size <= f64::EPSILON * unit {
            *size = *unit;
        }
    }
    let mut first = 0;
    for length in [n, n, sizes.len() - 2 * n] {
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

/// The middle of the longest time between two times in which nothing happens, nor may begin to.
pub(super) fn longest_pause(map: &PeriodMap, from: f64, to: f64) -> f64 {
    let mut last = from;
    let times = map.times().into_iter().chain([to]);
    let gaps = times.map(|time| (std::mem::replace(&mut last, time), time));
    let gap = gaps.max_by(|a, b| (a.1 - a.0).total_cmp(&(b.1 - b.0)));
    gap.map_or(from, |(from, to)| 0.5 * (from + to))
}
