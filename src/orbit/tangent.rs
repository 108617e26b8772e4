//! The tangent flow: the variational equations along a trajectory,
//!
//! ```text
//! δq' = δv,   m δv' = −K δq − C δv − ∂(Nμ)/∂v δv − ∂(Nμ)/∂z δz − μ n·δq
//! δz' = ∂z'/∂v δv + ∂z'/∂z δz
//! ```
//!
//! A law φ of the load adds ∂φ/∂x a·δq + ∂φ/∂y a·δv to n·δq, and rates z' that depend on the load
//! have the term ∂z'/∂N of this sum.
//!
//! The force T of an elastic contact obeys δT' = k_t b·δv in stick and δT = σμ n·δq in slip; a
//! closed normal spring adds −d n·δq to the forces. The perturbation of a first-order state
//! obeys δz' = A_q δq + A_v δv + A_z δz.
//!
//! The equations are solved by power series on the steps of the trajectory, or by a matrix
//! exponential over several of them (`constant_coefficient_flow.rs`). A contact that sticks has δv
//! = 0; events are treated in `saltation.rs`. Each column of a matrix is one perturbation: n
//! displacements, n velocities, the memory variables of the contacts, and first-order states.

use std::borrow::Cow;

use nalgebra::{DMatrix, DVector};

use super::constant_coefficient_flow::{Phase, ends_phase};
use super::perturbation_series::{Equations, LONG};
use super::prescribed_modes::{HeldFlow, Hold, Touch};
use super::stiff_perturbations::{Settling, stiffest};
use super::type_erased_system::GeneralForm;
use super::variational_equations::Linear;
use crate::error::{Error, Reached};
use crate::motion::step_control::EXPLICIT;
use crate::motion::{Integrator, Mode, Segment};
use crate::state::structure::State;
use crate::structure::Step;

/// Numbers of perturbations that are computed together.
const FEW: usize = 4;
const MANY: usize = 8;

/// A trajectory with perturbations of it.
#[derive(Debug)]
pub(super) struct TangentFlow<'s> {
    pub(super) form: &'s GeneralForm<'s>,
    flow: HeldFlow<'s>,
    /// The perturbations, one in each column.
    pub(super) tangents: DMatrix<f64>,
    /// True for each memory variable on which anything has depended so far.
    pub(super) depends: Vec<bool>,
    /// The logarithm of a factor that is taken out of a single perturbation, to avoid overflow and
    /// underflow; `None` if no factor is taken out.
    pub(super) logarithm: Option<f64>,
    /// True if a step of positive length has been taken.
    has_begun: bool,
    pub(super) start: State,
    work: Vec<f64>,
    /// The phase under way: the tangents are those at its start.
    phase: Option<Phase>,
}

impl<'s> TangentFlow<'s> {
    /// Perturbations of a start at a time, to be carried along the trajectory from there, with
    /// contacts held.
    pub(super) fn new(
        form: &'s GeneralForm<'s>,
        settings: Integrator,
        (time, start): (f64, &State),
        holds: &[Hold],
        tangents: DMatrix<f64>,
    ) -> Result<Self, Error> {
        Ok(Self {
            form,
            flow: HeldFlow::new(form, settings, time, start, holds)?,
            work: Vec::new(),
            phase: None,
            tangents,
            depends: vec![false; form.model.remembered()],
            logarithm: None,
            has_begun: false,
            start: start.clone(),
        })
    }

    /// The next step, cut at a time if it is longer. Velocity perturbations of a contact that
    /// sticks, or that has come to rest there for no time, are projected out at its start.
    pub(super) fn fetch(&mut self, end: f64) -> Option<Result<Step, Error>> {
        let step = match self.flow.next()? {
            Ok(step) if step.end_time() > end => step.until(end),
            Ok(step) => step,
            error => return Some(error),
        };
        let reached = || Reached::new(step.start_time(), step.state().clone());
        if let Err(error) = self.form.count(&reached) {
            return Some(Err(error));
        }
        let touched = self.flow.touched;
        let is_within = |phase: &Phase| touched.is_none() && phase.modes == step.modes();
        if step.duration() > 0.0 && !self.phase.as_ref().is_some_and(is_within) {
            if let Err(error) = self.finish() {
                return Some(Err(error));
            }
            let (n, model) = (self.form.len(), &self.form.model);
            let rests = |c: usize| step.modes()[c] == Mode::Stick || touched == Some(c);
            for c in (0..step.modes().len()).filter(|&c| rests(c)) {
                if let Some(i) = model.owner_of(c) {
                    self.tangents.row_mut(n + i).fill(0.0);
                }
            }
            let holding = model.holding(&rests);
            if !holding.contacts.is_empty() {
                for mut column in self.tangents.column_iter_mut() {
                    let mut velocities = column.rows_mut(n, n);
                    let velocities = velocities.as_mut_slice().as_chunks_mut::<1>().0;
                    let velocities = velocities.as_chunks_mut::<1>().0;
                    holding.project(model, velocities, 0);
                }
            }
        }
        Some(Ok(step))
    }

    /// Integrates the tangents from the start of a step to its end, including its events. Events at
    /// the start of the trajectory belong to the step before.
    ///
    /// Within a phase the tangents stay those at its start.
    pub(super) fn carry(&mut self, step: &Step) -> Result<(), Error> {
        let mut linear = None;
        if step.duration() > 0.0 {
            if !self.has_begun {
                self.begin(step);
                self.has_begun = true;
            }
            linear = self.integrate(step)?;
        }
        if self.phase.is_some() {
            if !ends_phase(step) {
                return Ok(());
            }
            linear = self.finish()?;
        }
        if self.has_begun {
            self.pass(step, linear.as_ref());
        }
        Ok(())
    }

    /// Integrates the tangents over a step without its events, or adds it to a phase; returns its
    /// coefficients in the first case.
    fn integrate(&mut self, step: &Step) -> Result<Option<Linear>, Error> {
        let phase = self.phase.as_mut();
        if phase.is_some_and(|phase| phase.extend(self.form, step)) {
            return Ok(None);
        }
        self.finish()?;
        let linear = Linear::of(&self.form.model, step);
        let of_memory = linear.contacts.iter().flat_map(|joint| &joint.depends);
        let states = self.form.model.first_order.iter();
        let of_memory = of_memory.chain(states.map(|state| &state.acts));
        for (ever, now) in self.depends.iter_mut().zip(of_memory) {
            *ever |= now;
        }
        if self.logarithm.is_none() && linear.is_constant() {
            self.phase = Some(Phase::new(linear, step));
            return Ok(None);
        }
        let h = step.duration();
        let reached = |t: f64| Reached::new(step.start_time() + t, step.state_at(t));
        let later = |since: f64| linear.later(&self.form.model, step, since);
        self.expand((h, &reached), (&linear, &later))?;
        self.limit_elastic(step.modes());
        Ok(Some(linear))
    }

    /// Carries the tangents over the phase under way, if there is one, and returns its
    /// coefficients.
    pub(super) fn finish(&mut self) -> Result<Option<Linear>, Error> {
        let Some(phase) = self.phase.take() else {
            return Ok(None);
        };
        let columns = self.tangents.as_slice().chunks(self.tangents.nrows());
        let perturbations = columns.filter(|column| is_alive(column)).count();
        match phase.exponential(self.form, perturbations) {
            Some(exponential) => self.tangents = exponential * &self.tangents,
            None => {
                let reached = |_| phase.begins.clone();
                let constant = |_| phase.linear.clone();
                self.expand((phase.duration, &reached), (&phase.linear, &constant))?;
            }
        }
        self.limit_elastic(&phase.modes);
        Ok(Some(phase.linear))
    }

    /// Returns true if the tangents are those at the end of the last step.
    pub(super) fn is_finished(&self) -> bool {
        self.phase.is_none()
    }

    /// Integrates the tangents by their power series.
    fn expand(&mut self, stretch: Stretch<'_>, linear: Coefficients<'_>) -> Result<(), Error> {
        let rows = self.tangents.nrows();
        let columns = self.tangents.as_mut_slice().chunks_mut(rows);
        let mut columns: Vec<_> = columns.filter(|column| is_alive(column)).collect();
        let width = if columns.len() <= FEW { FEW } else { MANY };
        for columns in columns.chunks_mut(width) {
            let advance = if width == FEW {
                advance::<FEW>
            } else {
                advance::<MANY>
            };
            let work = (&mut self.work, self.logarithm.as_mut());
            advance(self.form, stretch, linear, columns, work)?;
        }
        Ok(())
    }

    /// The touches passed so far.
    pub(super) fn touches(&self) -> &[Touch] {
        &self.flow.touches
    }

    /// Replaces the tangents, and returns the old ones.
    pub(super) fn replace(&mut self, tangents: DMatrix<f64>) -> DMatrix<f64> {
        std::mem::replace(&mut self.tangents, tangents)
    }
}

fn is_alive(perturbation: &[f64]) -> bool {
    perturbation.iter().any(|x| *x != 0.0)
}

/// The rates of change of all coordinates at the start of a step.
pub(super) fn flow_of(step: &Step, n: usize) -> DVector<f64> {
    let velocities = step.state().velocities.iter().copied();
    let rates = step.series().iter().map(|series| series[1]);
    DVector::from_iterator(n + step.series().len(), velocities.chain(rates))
}

/// The rates of change of all numbers at a time since the start of a step, with these velocities.
pub(super) fn flow_at(step: &Step, since: f64, velocities: Vec<f64>) -> DVector<f64> {
    let rates = step.series().iter();
    let rates = rates.map(|series| series.derivative().at(since));
    let count = velocities.len() + step.series().len();
    DVector::from_iterator(count, velocities.into_iter().chain(rates))
}

/// A time, and the state of the motion after a part of it.
type Stretch<'a> = (f64, &'a dyn Fn(f64) -> Reached);

/// The coefficients of the variational equations, and those about a later time.
type Coefficients<'a> = (&'a Linear, &'a dyn Fn(f64) -> Linear);

/// Integrates perturbations, each in a slice, over a time h. If their own series converge over less
/// than h, as on a steady motion of any length, it is taken in parts, each counted as a step.
fn advance<const W: usize>(
    form: &GeneralForm<'_>,
    (h, reached): Stretch<'_>,
    (linear, later): Coefficients<'_>,
    columns: &mut [&mut [f64]],
    (work, mut logarithm): (&mut Vec<f64>, Option<&mut f64>),
) -> Result<(), Error> {
    /// Numbers in a line of the cache.
    const LINE: usize = 8;
    /// The shortest part of a step, unless velocities of stiff contacts settle in it.
    const SHORTEST: f64 = 1e-9;
    /// A number of orders of which none overflows.
    const FEWEST: usize = 7;
    /// A part of the time in which velocities settle: the length of a step of so few orders.
    const OF_SETTLING: f64 = 1e-3;
    let mut linear = Cow::Borrowed(linear);
    let mut left = h;
    // At the start of a line of the cache: registers as long as a line are loaded at once from
    // there.
    let mut terms = LONG;
    let length = Equations::new(form, &linear, terms).rows() * LONG * W;
    work.resize(length + LINE, 0.0);
    let begin = work
        .as_ptr()
        .align_offset(LINE * size_of::<f64>())
        .min(LINE);
    let rows = work[begin..begin + length].as_chunks_mut::<W>().0;
    let rows = rows.as_chunks_mut::<LONG>().0;
    for (i, row) in rows[..form.order()].iter_mut().enumerate() {
        row[0] = std::array::from_fn(|lane| columns.get(lane).map_or(0.0, |column| column[i]));
    }
    loop {
        let equations = Equations::new(form, &linear, terms);
        equations.expand(rows);
        let mut part = equations.reach(rows, left);
        let stiffest = stiffest(&form.model, &linear);
        while part.is_nan() && stiffest > 0.0 && terms > FEWEST {
            // Where a stiff contact settles, high orders overflow.
            terms = 3 * terms / 4;
            part = Equations::new(form, &linear, terms).reach(rows, left);
        }
        let stable = part.max(EXPLICIT / stiffest);
        if stable < left {
            let equations = Equations::new(form, &linear, LONG);
            let settling = Settling::within(&form.model, &linear, stable);
            let slow = settling.and_then(|settling| settling.expand(&equations, rows, left));
            match slow {
                Some(reach) => (part, terms) = (reach, LONG),
                None => Equations::new(form, &linear, terms).expand(rows),
            }
        }
        let equations = Equations::new(form, &linear, terms);
        if part.is_nan() {
            columns.iter_mut().for_each(|column| column.fill(f64::NAN));
            return Ok(());
        }
        equations.go_to(rows, part);
        if let Some(logarithm) = logarithm.as_deref_mut() {
            let now = &mut rows[..form.order()];
            let size = now.iter().fold(0.0, |m: f64, x| m.max(x[0][0].abs()));
            if size > 0.0 && !(1e-100..1e100).contains(&size) {
                now.iter_mut().for_each(|x| x[0][0] /= size);
                *logarithm += size.ln();
            }
        }
        if part >= left {
            break;
        }
        left -= part;
        terms = equations.terms_for(left, part);
        let reached = || reached(h - left);
        if part < SHORTEST * h && stiffest * part < OF_SETTLING {
            return Err(form.too_many(reached()));
        }
        form.count(&reached)?;
        linear = Cow::Owned(later(h - left));
    }
    for (lane, column) in columns.iter_mut().enumerate() {
        for (x, row) in std::iter::zip(&mut **column, &*rows) {
            *x = row[0][lane];
        }
    }
    Ok(())
}
