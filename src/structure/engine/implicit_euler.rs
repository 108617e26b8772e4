//! Sliding speeds that settle within the rounding of time: the implicit Euler method.
//!
//! Where the sliding speed of a creeping contact is far from the balance of forces, at a reversal
//! or where a surface stops, its rate D may be so large that steps of 1/D are below the resolution
//! of the clock, or coefficients D^k overflow. What the speeds do within that resolution need not
//! be followed: they end as the implicit Euler method says. Where friction has become steep in
//! other directions, the search for its solution goes on along these.
//!
//! The relative velocities r of the contacts in slip move to
//!
//! ```text
//! r = r_0 + h r'(r),   r'(r) = r'(r_0) − C (r − r_0) − G [N μ(r) − N μ(r_0)]
//! ```
//!
//! with the compliances G and the damping C between the directions of the contacts. As N μ rises
//! with r, there is one solution, and each contact comes nearer to its balance r' = 0 without
//! passing it. One that comes close to it where e^{−Dh} is rounding has settled, and gets the
//! balance itself.
//!
//! Friction follows the logarithm of r, over hundreds of decades. Far from the solution one
//! velocity after the other is set to that at which its own forces balance; near to it Newton's
//! method corrects all of them.

use nalgebra::{DMatrix, DVector};

use super::directions::Directions;
use super::events::Firings;
use super::mode_decision::set_phase;
use super::model::Model;
use super::series::Series;
use super::state::{Firing, Phase, Situation};
use super::step_size::{Plan, SETTLED};
use crate::friction::memory::{Motion, Slip};
use crate::series::PowerSeries;
use crate::state::Direction;

/// Halvings of a range of logarithms of speeds to its rounding.
const HALVINGS: usize = 64;

/// Relative changes in the meantime that count as rounding.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// The increment of a difference, relative to a speed: half the digits are enough.
const PART: f64 = 1.0 / (1 << 26) as f64;

/// The speed from which Newton's method starts at rest.
const LEAST: f64 = 1e-290;

/// Corrections at most.
const MOST: usize = 12;

/// Relative correction after which the next one is less than rounding.
const SMALL: f64 = 1e-8;

/// The part of what is left of the equations that Newton's step may leave.
const NEAR: f64 = 0.5;

/// Factor of the speed in a search for a larger one.
const FURTHER: f64 = 1e4;

/// Choices of independent directions: those of steep friction.
const CHOICES: usize = 12;

/// A step of the length of the resolution of time, at most to a break of a drive: contacts in slip
/// get the speeds that they reach within it, if nothing else in the motion changes by more than
/// rounding. Its series are those speeds; one that turns back arrives at r = 0. Returns its length,
/// or `None` if no speed changes.
pub(super) fn leap(
    model: &Model<'_>,
    situation: &mut Situation,
    series: &mut Series,
    plan: &Plan,
    to_break: f64,
    firings: &mut Firings,
) -> Option<f64> {
    let (step, ends, duration) = found(model, situation, series, plan, to_break)?;
    // By how much implicit changes differ from r' h.
    let rates = std::iter::zip(&ends.changes, &step.rates);
    let changes: Vec<f64> = rates
        .map(|(change, rate)| change - rate * duration)
        .collect();
    let ImplicitStep {
        directions, slips, ..
    } = step;
    let motions = series.coordinates.iter().map(|of| &of.motion);
    let accelerations: Vec<f64> = motions.map(|motion| motion.velocity(1)).collect();
    series.keep(1);
    for (i, acceleration) in accelerations.into_iter().enumerate() {
        let change = changes.iter().enumerate();
        let change = change.map(|(k, change)| change * directions.column(k)[i]);
        let motion = &mut series.coordinates[i].motion;
        motion.set_velocity(0, motion.velocity(0) + change.sum::<f64>());
        motion.set_velocity(1, acceleration);
    }
    *firings = Firings::default();
    firings.contacts.resize(model.contacts.len(), None);
    for slip in slips {
        let (c, end) = (slip.contact, slip.relative(&ends.relative));
        let before = situation.contacts[c].relative();
        let of = &mut series.contacts[c];
        if end == before {
            continue;
        }
        match Direction::of(end) {
            Some(direction) => {
                set_phase(model, situation, c, end);
                (of.side, of.speeds) = (direction.sign(), PowerSeries::of(end.abs()));
            }
            None => {
                of.speeds[1] = -of.speeds[0] / duration;
                firings.contacts[c] = Some((duration, Firing::Arrival));
            }
        }
    }
    Some(duration)
}

/// The contacts in slip, their velocities after the resolution of time, and that time.
fn found<'a, 's>(
    model: &'a Model<'s>,
    situation: &'a Situation,
    series: &'a Series,
    plan: &Plan,
    to_break: f64,
) -> Option<(ImplicitStep<'a, 's>, Velocities, f64)> {
    let start: Vec<f64> = situation.contacts.iter().map(|of| of.relative()).collect();
    let mut from = start.clone();
    let slopes = series.contacts.iter().map(|of| of.slope.abs());
    let mut slopes: Vec<f64> = slopes.collect();
    for _ in 0..CHOICES {
        let step = ImplicitStep::new(model, situation, series, &slopes)?;
        let ends = step.ends(plan, to_break, &from);
        let last = match &ends {
            Ok((ends, _)) => &ends.relative,
            Err(last) => last.as_ref()?,
        };
        for slip in &step.slips {
            from[slip.contact] = slip.relative(last);
        }
        // Friction that holds a contact at rest is no function of r.
        let stops = |c: usize| {
            let may_stick = situation.contacts[c].limits.is_some() && start[c] != 0.0;
            let arrives = match &ends {
                Ok(_) => from[c] * start[c] < 0.0,
                Err(_) => start[c].abs() <= plan.resolution * plan.sizes[c],
            };
            may_stick && arrives
        };
        let stop = step.slips.iter().map(|slip| slip.contact);
        let stop: Vec<usize> = stop.filter(|&c| stops(c)).collect();
        match ends {
            Ok((ends, duration)) if stop.is_empty() => {
                return Some((step, ends, duration));
            }
            Ok(_) => {}
            Err(_) => slopes = step.slopes(&from),
        }
        for c in stop {
            slopes[c] = f64::INFINITY;
        }
    }
    None
}

/// A contact in slip.
struct Slipping {
    contact: usize,
    /// r is the sum of these parts of the velocities along the directions, and an offset.
    parts: Vec<f64>,
    offset: f64,
}

impl Slipping {
    fn relative(&self, velocities: &[f64]) -> f64 {
        let parts = std::iter::zip(&self.parts, velocities);
        parts.fold(self.offset, |sum, (part, r)| sum + part * r)
    }
}

/// The contacts in slip.
struct ImplicitStep<'a, 's> {
    model: &'a Model<'s>,
    situation: &'a Situation,
    series: &'a Series,
    /// The independent directions among theirs, and whether the contact along each comes to rest.
    directions: Directions,
    stops: Vec<bool>,
    slips: Vec<Slipping>,
    /// r and r' along the directions at the start.
    start: Vec<f64>,
    rates: DVector<f64>,
    /// C, and G for friction that is the acceleration of its own contact.
    damping: DMatrix<f64>,
    compliance: DMatrix<f64>,
}

impl<'a, 's> ImplicitStep<'a, 's> {
    /// The contacts in slip; the steepest are independent. Those of infinite slope come to rest.
    fn new(
        model: &'a Model<'s>,
        situation: &'a Situation,
        series: &'a Series,
        slopes: &[f64],
    ) -> Option<Self> {
        let slips = |c: usize| {
            let is_rigid = !model.contacts[c].is_elastic();
            is_rigid && matches!(situation.contacts[c].phase, Phase::Slip { .. })
        };
        let all: Vec<usize> = (0..model.contacts.len()).filter(|&c| slips(c)).collect();
        if !all.iter().any(|&c| model.contacts[c].law.creeps()) {
            return None;
        }
        let held = &situation.holding;
        let number = |c: usize| slips(c).then(|| -slopes[c]);
        let directions = Directions::new(model, held, &number);
        let damping = directions.matrix(model, held, &|_| 0.0)?;
        let is_independent = |c: usize| directions.contacts.contains(&c);
        let braking = |c: usize| f64::from(u8::from(is_independent(c)));
        let compliance = directions.matrix(model, held, &braking)? - &damping;
        let relative = |&c: &usize| situation.contacts[c].relative();
        let start: Vec<f64> = directions.contacts.iter().map(relative).collect();
        let rate = |&c: &usize| series.contacts[c].side * series.contacts[c].speeds[1];
        let rates = directions.contacts.iter().map(rate);
        let rates = DVector::from_iterator(start.len(), rates);
        let surface = |c: usize| series.contacts[c].surface[0];
        let slipping = |contact: usize| {
            let dependent = directions.dependent(model, contact)?;
            Some(Slipping {
                contact,
                parts: directions
                    .contacts
                    .iter()
                    .map(|&c| dependent.part(c))
                    .collect(),
                offset: dependent.relative(|_| 0.0, surface),
            })
        };
        let slips: Option<Vec<Slipping>> = all.into_iter().map(slipping).collect();
        let stops = directions.contacts.iter();
        Some(Self {
            slips: slips?,
            stops: stops.map(|&c| slopes[c] == f64::INFINITY).collect(),
            model,
            situation,
            series,
            directions,
            start,
            rates,
            damping,
            compliance,
        })
    }

    /// Friction as an acceleration of its own contact, against r.
    fn friction(&self, c: usize, relative: f64) -> f64 {
        let (contact, state) = (&self.model.contacts[c], &self.situation.contacts[c]);
        let slip = self.slip(c, relative);
        let load = self.series.contacts[c].load[0];
        load * contact.law.coefficient(slip, &|j| state.memory[j])
    }

    /// The argument of its law.
    fn slip(&self, c: usize, relative: f64) -> Slip<f64> {
        let side = match Direction::of(relative) {
            Some(side) => side.sign(),
            None => self.series.contacts[c].side,
        };
        Slip {
            speed: relative.abs(),
            direction: side,
            piece: self.model.contacts[c].piece_above(relative.abs()),
        }
    }

    /// The derivative of friction by r.
    fn slope(&self, c: usize, relative: f64) -> f64 {
        let relative = if relative == 0.0 { LEAST } else { relative };
        let [more, less] = [1.0 + PART, 1.0 - PART].map(|part| self.friction(c, relative * part));
        (more - less) / (2.0 * PART * relative)
    }

    /// The sizes of the derivatives of friction at these relative velocities of all contacts, 0
    /// where there is no slip.
    fn slopes(&self, relative: &[f64]) -> Vec<f64> {
        let mut slopes = vec![0.0; relative.len()];
        for &Slipping { contact, .. } in &self.slips {
            slopes[contact] = self.slope(contact, relative[contact]).abs();
        }
        let stops = std::iter::zip(&self.directions.contacts, &self.stops);
        for (&contact, _) in stops.filter(|(_, stops)| **stops) {
            slopes[contact] = f64::INFINITY;
        }
        slopes
    }

    /// The friction of all contacts at these velocities, along the directions.
    fn frictions(&self, velocities: &[f64]) -> DVector<f64> {
        let mut sum = DVector::zeros(self.start.len());
        for slip in &self.slips {
            let friction = self.friction(slip.contact, slip.relative(velocities));
            self.add(&mut sum, slip, friction);
        }
        sum
    }

    /// Adds the friction of a contact to that of the contacts along the directions.
    fn add(&self, sum: &mut DVector<f64>, slip: &Slipping, friction: f64) {
        let compliance = |c: usize| self.model.contacts[c].compliance;
        let own = compliance(slip.contact);
        let parts = std::iter::zip(&self.directions.contacts, &slip.parts);
        for (sum, (&c, part)) in std::iter::zip(sum.iter_mut(), parts) {
            *sum += part * friction * (compliance(c) / own);
        }
    }

    /// The solution of `inertia` (r − r_0) = r'(r), from these velocities.
    ///
    /// # Errors
    ///
    /// The last velocities, if there are any.
    fn solution(
        &self,
        inertia: &[f64],
        mut velocities: Velocities,
    ) -> Result<Velocities, Option<Vec<f64>>> {
        // Divided by G, the equations are those of the least of a convex function.
        let divided = self.compliance.clone().lu();
        let mut resistance = self.damping.clone();
        for (k, inertia) in inertia.iter().enumerate() {
            resistance[(k, k)] += inertia;
        }
        let mut forces = self.rates.clone();
        if !(divided.solve_mut(&mut resistance) && divided.solve_mut(&mut forces)) {
            return Err(None);
        }
        let balance = Balance {
            forces: forces + self.frictions(&self.start),
            step: self,
            resistance,
        };
        let moving = (0..inertia.len()).filter(|&k| !self.stops[k]);
        let moving: Vec<usize> = moving.collect();
        for k in (0..inertia.len()).filter(|&k| self.stops[k]) {
            velocities.set(k, 0.0, self.start[k]);
        }
        for _ in 0..MOST {
            let Some(corrections) = balance.corrections(&velocities) else {
                break;
            };
            let parts = std::iter::zip(&corrections, &velocities.relative);
            let largest = parts.fold(0.0, |most: f64, (change, r)| most.max((change / r).abs()));
            let mut corrected = velocities.clone();
            for (k, change) in corrections.iter().enumerate() {
                corrected.add(k, *change);
            }
            if largest < SMALL {
                return Ok(corrected);
            }
            if balance.left(&corrected) < NEAR * balance.left(&velocities) {
                velocities = corrected;
            } else {
                for &k in &moving {
                    balance.solve_one(k, &mut velocities).ok_or(None)?;
                }
            }
        }
        Err(Some(velocities.relative))
    }

    /// The velocities along the directions after the resolution of time, and that time, at most one
    /// to a break of a drive. They are searched from these relative velocities of all contacts.
    ///
    /// # Errors
    ///
    /// The velocities at which the search for them ended, if it did.
    fn ends(
        &self,
        plan: &Plan,
        to_break: f64,
        from: &[f64],
    ) -> Result<(Velocities, f64), Option<Vec<f64>>> {
        let lasts = self.memory_lasts(&self.start);
        let duration = plan.resolution.min(lasts).min(to_break);
        let side = |k: usize| self.series.contacts[self.directions.contacts[k]].side;
        let size = self.start.len();
        let mut inertia = vec![duration.recip(); size];
        let starts = std::iter::zip(0.., &self.directions.contacts);
        let starts = starts.map(|(k, &c)| match from[c] {
            r if r.abs() < LEAST => side(k) * LEAST,
            r => r,
        });
        let relative: Vec<f64> = starts.collect();
        let changes = std::iter::zip(&relative, &self.start);
        let from = Velocities {
            changes: changes.map(|(r, start)| r - start).collect(),
            relative,
        };
        let mut ends = self.solution(&inertia, from)?;
        let direct =
            |k: usize, r: f64| self.slope(self.directions.contacts[k], r) * self.compliance[(k, k)];
        let mut settles = false;
        for (k, inertia) in inertia.iter_mut().enumerate() {
            if direct(k, ends.relative[k]) > SETTLED * *inertia {
                (*inertia, settles) = (*inertia * PART * PART * PART, true);
            }
        }
        if settles {
            let balance = self.solution(&inertia, ends.clone());
            let is_close = |balance: &Velocities| {
                let mut all = std::iter::zip(&balance.relative, &ends.relative);
                all.all(|(balance, there)| (balance / there).ln().abs() < 1.0)
            };
            if let Some(balance) = balance.ok().filter(is_close) {
                ends = balance;
            }
        }
        let mut moves = false;
        for k in 0..size {
            let (start, end) = (self.start[k], ends.relative[k]);
            if (end - start).abs() <= ROUNDING * start.abs() {
                continue;
            }
            // Its way is less than rounding in terms of the forces that change the speed.
            let change = (end - start).abs();
            let force = (direct(k, end) * end).abs().max(change / duration);
            if change * duration > ROUNDING * force * plan.unit * plan.unit {
                return Err(None);
            }
            moves = true;
            if start != 0.0 && end * side(k) < 0.0 {
                ends.set(k, 0.0, start);
            }
        }
        let lasts = 2.0 * self.memory_lasts(&ends.relative) >= duration;
        match moves && lasts {
            true => Ok((ends, duration)),
            false => Err(None),
        }
    }

    /// The time within which memories change by no more than rounding at these velocities.
    fn memory_lasts(&self, velocities: &[f64]) -> f64 {
        let mut time = f64::INFINITY;
        for slip in &self.slips {
            let c = slip.contact;
            let (contact, state) = (&self.model.contacts[c], &self.situation.contacts[c]);
            let motion = self.slip(c, slip.relative(velocities));
            let load = self.series.contacts[c].load[0] / contact.compliance;
            let memory = |j: usize| state.memory[j];
            let take = &mut |j: usize, rate: f64| {
                let unit = contact.law.unit_in_creep(motion, &memory, j).max(1.0);
                time = time.min(ROUNDING * unit / rate.abs());
            };
            contact.law.rates(Motion::Slip(motion), load, &memory, take);
        }
        time
    }
}

/// Relative velocities along the directions, and their changes: of a large one the change has more
/// digits, of a small one the velocity itself.
#[derive(Debug, Clone)]
struct Velocities {
    relative: Vec<f64>,
    changes: Vec<f64>,
}

impl Velocities {
    fn add(&mut self, k: usize, change: f64) {
        self.relative[k] += change;
        self.changes[k] += change;
    }

    fn set(&mut self, k: usize, relative: f64, start: f64) {
        (self.relative[k], self.changes[k]) = (relative, relative - start);
    }
}

/// The equations K (r − r_0) + N μ(r) = p, divided by G.
struct Balance<'l, 'a, 's> {
    step: &'l ImplicitStep<'a, 's>,
    resistance: DMatrix<f64>,
    forces: DVector<f64>,
}

impl Balance<'_, '_, '_> {
    /// What is left of the equation of a direction.
    fn residual(&self, k: usize, velocities: &Velocities) -> f64 {
        let changes = velocities.changes.iter().enumerate();
        let resisted: f64 = changes
            .map(|(j, change)| self.resistance[(k, j)] * change)
            .sum();
        self.forces[k] - resisted - self.step.frictions(&velocities.relative)[k]
    }

    /// The largest of what is left.
    fn left(&self, velocities: &Velocities) -> f64 {
        let moving = std::iter::zip(0.., &self.step.stops).filter(|(_, stops)| !**stops);
        let left = moving.map(|(k, _)| self.residual(k, velocities).abs());
        left.fold(0.0, f64::max)
    }

    /// The derivatives by the velocities, times −1.
    fn slopes(&self, velocities: &Velocities) -> DMatrix<f64> {
        let mut matrix = self.resistance.clone();
        for slip in &self.step.slips {
            let relative = slip.relative(&velocities.relative);
            let slope = self.step.slope(slip.contact, relative);
            for (k, part) in slip.parts.iter().enumerate() {
                let mut column = DVector::zeros(slip.parts.len());
                self.step.add(&mut column, slip, slope * part);
                let mut sum = matrix.column_mut(k);
                sum += column;
            }
        }
        matrix
    }

    /// Newton's corrections of all velocities.
    fn corrections(&self, velocities: &Velocities) -> Option<DVector<f64>> {
        let mut matrix = self.slopes(velocities);
        let stops = |k: usize| self.step.stops[k];
        for k in (0..matrix.nrows()).filter(|&k| stops(k)) {
            matrix.row_mut(k).fill(0.0);
            matrix.column_mut(k).fill(0.0);
            matrix[(k, k)] = 1.0;
        }
        let scales = matrix.diagonal().abs();
        for (mut column, scale) in std::iter::zip(matrix.column_iter_mut(), &scales) {
            column /= *scale;
        }
        let mut corrections = DVector::from_fn(scales.len(), |k, _| match stops(k) {
            true => 0.0,
            false => self.residual(k, velocities),
        });
        if !matrix.lu().solve_mut(&mut corrections) {
            return None;
        }
        corrections.component_div_assign(&scales);
        let is_finite = corrections.iter().all(|x| x.is_finite());
        is_finite.then_some(corrections)
    }

    /// Solves the equation of one direction, whose residual falls as its velocity rises.
    fn solve_one(&self, k: usize, velocities: &mut Velocities) -> Option<()> {
        let start = self.step.start[k];
        let residual = &mut |r: f64| {
            velocities.set(k, r, start);
            self.residual(k, velocities)
        };
        let side = residual(0.0).signum();
        let is_below = &mut |r: f64| side * residual(side * r) > 0.0;
        let [mut low, mut high] = [LEAST, start.abs().max(FURTHER * LEAST)];
        if is_below(low) {
            while is_below(high) {
                (low, high) = (high, FURTHER * high);
                if high > f64::MAX.sqrt() {
                    return None;
                }
            }
            for _ in 0..HALVINGS {
                let middle = low.sqrt() * high.sqrt();
                if is_below(middle) {
                    low = middle;
                } else {
                    high = middle;
                }
            }
        }
        velocities.set(k, side * low, start);
        let change = self.residual(k, velocities) / self.slopes(velocities)[(k, k)];
        velocities.add(k, change);
        Some(())
    }
}
