//! A periodic motion as a result: which multipliers and events it lists, whether it is stable and
//! symmetric, and that an event at its start counts once, at its end.

use std::fmt;

use nalgebra::DMatrix;
use num_complex::Complex;

use super::course::{Course, KeptMotion};
use super::family::families;
use super::half_map::HalfMap;
use super::measures::{Contact, Coordinate, Measures};
use super::oscillator::{FamilyMember, Oscillator};
use super::period::Period;
use super::period_map;
use super::period_map::run::{self, carried};
use super::shooting_residual::TrialMotion;
use super::type_erased_system::GeneralForm;
use crate::error::Error;
use crate::motion::sealed::State as _;
use crate::motion::{EnergyBudget, Event, EventKind, Segment, SystemState, Trajectory};
use crate::numerics::fourier::{Fourier, differentiated};
use crate::numerics::power_of_two;
use crate::numerics::sort::sort_by;
use crate::state::structure::State;

/// A periodic motion, exact to rounding, with its Floquet multipliers.
///
/// The searches of [`orbit`](super) return this type, for example [`shoot`](super::shoot). Extremes
/// are exact to rounding, too: the displacement and the velocity are power series in each step, and
/// their extremes lie at the roots of the derivatives. All numbers are in the units of the system.
/// A measure of a coordinate or of a contact that does not exist is NaN.
///
/// ```
/// use stick_slip::orbit::{self, Period};
/// use stick_slip::{EventKind, MassOnBelt, Polynomial};
///
/// let system = MassOnBelt::new(Polynomial::new(0.4, 0.25, 0.5)?, 0.2)?.with_damping(0.05)?;
/// let orbit = orbit::shoot(&system, &(0.1, 0.2).into(), Period::Free(7.0))?;
/// assert!((orbit.period() - 6.799421444472158).abs() < 1e-14);
/// assert_eq!(orbit.state().velocity, 0.2);
/// assert!((orbit.extremes(0).1 - 0.5664694667237888).abs() < 1e-14);
/// assert_eq!(orbit.velocity_extremes(0).1, 0.2);
/// assert_eq!(orbit.events()[1].kind, EventKind::Stick);
/// assert_eq!(orbit.multipliers()[0].norm(), 0.0);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[derive(Clone)]
pub struct Orbit<S: SystemState> {
    kind: Period,
    period: f64,
    state: S,
    events: Vec<Event<S>>,
    pub(super) measures: Measures,
    multipliers: Vec<Complex<f64>>,
    unslipped: Vec<usize>,
    families: Vec<S>,
    /// The multipliers 1 of families that are listed.
    neutral: usize,
    /// True if a contact alternates between stick and slip.
    alternates: bool,
    is_symmetric: bool,
    motion: KeptMotion<S>,
}

/// A closed motion as a result, in the general form of its states, without the motion itself.
pub(super) struct Closed {
    kind: Period,
    period: f64,
    state: State,
    measures: Measures,
    properties: Properties,
    is_symmetric: bool,
    course: Course,
}

impl Closed {
    pub(super) fn new(
        system: &dyn FamilyMember,
        form: &GeneralForm<'_>,
        found: TrialMotion,
        kind: Period,
    ) -> Result<Self, Error> {
        let properties = Properties::of(form, &found, kind)?;
        let TrialMotion { period, map, .. } = found;
        let course = map.course();
        let map = map.since_zero(period);
        let energy = system.energy_over(&map.steps);
        Ok(Self {
            kind: kind.with_period(period),
            period,
            is_symmetric: HalfMap::of_symmetric(&map, period).is_some(),
            measures: Measures::of(form, (&map.steps, map.translation()), period, energy),
            state: map.start,
            properties,
            course,
        })
    }

    /// The motion in the states of its system.
    pub(super) fn orbit<S: Oscillator>(self, system: &S) -> Result<Orbit<S::State>, Error> {
        let events = self.properties.events.into_iter().map(|event| {
            let state = S::State::of_general(&event.state);
            event.with_state(state)
        });
        let families = self.properties.families.iter();
        let state = S::State::of_general(&self.state);
        Ok(Orbit {
            motion: system.motion(self.course, &state, self.period)?,
            kind: self.kind,
            period: self.period,
            state,
            events: events.collect(),
            measures: self.measures,
            multipliers: self.properties.multipliers,
            unslipped: self.properties.unslipped,
            families: families.map(S::State::of_general).collect(),
            neutral: self.properties.neutral,
            alternates: self.properties.alternates,
            is_symmetric: self.is_symmetric,
        })
    }
}

impl<S: SystemState> Orbit<S> {
    pub(super) fn new(
        system: &impl Oscillator<State = S>,
        form: &GeneralForm<'_>,
        found: TrialMotion,
        kind: Period,
    ) -> Result<Self, Error> {
        Closed::new(system, form, found, kind)?.orbit(system)
    }
}

/// Properties of a closed motion.
struct Properties {
    events: Vec<Event<State>>,
    multipliers: Vec<Complex<f64>>,
    unslipped: Vec<usize>,
    families: Vec<State>,
    neutral: usize,
    alternates: bool,
}

impl Properties {
    fn of(form: &GeneralForm<'_>, found: &TrialMotion, kind: Period) -> Result<Self, Error> {
        let (map, period) = (&found.map, found.period);
        let apart = run::begun_apart(form, map, period)?;
        let begun = apart.as_ref().unwrap_or(map);
        let is_free = matches!(kind, Period::Free(_));
        let multipliers = begun.multipliers(is_free);
        let multipliers = multipliers.ok_or_else(|| found.not_periodic())?;
        let mut families = families(form, map, is_free, period);
        if map.begins() != 0.0 && !families.is_empty() {
            let found = carried(form, map, DMatrix::from_columns(&families), period)?;
            let sizes = map.sizes();
            let columns = found.column_iter();
            let scaled = columns.map(|d| d / d.component_div(&sizes).amax());
            families = scaled.collect();
        }
        let (unslipped, known) = (begun.unslipped(), begun.known_families());
        let steps = begun.clone().since_zero(period).steps;
        let events = steps.iter().flat_map(Segment::events);
        let events = events.map(|event| Event {
            time: within(event.time, period),
            ..event.clone()
        });
        let mut events: Vec<_> = events.collect();
        sort_by(&mut events, |event| event.time);
        // A contact whose force only touches its limit has events by rounding.
        let sticks = |event: &Event<State>| {
            let slips = |contact| !begun.slips_by_rounding(contact);
            event.kind == EventKind::Stick && event.contact().is_some_and(slips)
        };
        Ok(Self {
            alternates: events.iter().any(sticks),
            events,
            multipliers,
            unslipped,
            neutral: families.len().saturating_sub(known),
            families: families
                .iter()
                .map(|direction| period_map::state(direction, form.len()))
                .collect(),
        })
    }
}

impl<S: SystemState> Orbit<S> {
    /// The kind of the motion: [`Period::Driven`] with the number of common periods of the drives,
    /// or [`Period::Free`] with the period.
    pub fn kind(&self) -> Period {
        self.kind
    }

    /// The period T, in units of time.
    pub fn period(&self) -> f64 {
        self.period
    }

    /// The state at the start of the period. The state at the end of the period is the same, except
    /// for a [translation](Self::mean_velocity).
    pub fn state(&self) -> S {
        self.state.clone()
    }

    /// The motion over one period, from time 0. For a [`Structure`](crate::Structure) it is
    /// computed when it is asked for first, in the time of one motion: the power series of its
    /// steps would fill far more memory than the orbit.
    pub fn trajectory(&self) -> &Trajectory<S> {
        self.motion.trajectory()
    }

    /// The events in (0, T], in order of time. An event at the start of the period has the time T.
    pub fn events(&self) -> &[Event<S>] {
        &self.events
    }

    /// The Floquet multipliers, by descending modulus, dimensionless: two for each coordinate and
    /// one for each memory variable. Some multipliers 1 are left out: that of a shift along an
    /// autonomous motion, those of a [translation](super#motions-that-are-translated), and those of
    /// contacts that never [slip](Self::unslipped). In any other [family](Self::families) the
    /// multiplier 1 is listed.
    ///
    /// In each period a small perturbation along an eigenvector is multiplied by the multiplier of
    /// this eigenvector. Multipliers that are 0 because of stick are exactly 0: see [the page of
    /// this module](super#multipliers).
    #[doc(alias = "Floquet")]
    pub fn multipliers(&self) -> &[Complex<f64>] {
        &self.multipliers
    }

    /// The numbers of the contacts that never slip in the period. Of rigid contacts whose
    /// directions depend on each other those are listed that determine the others.
    ///
    /// If there are such contacts, the motion belongs to a continuous family. The position at which
    /// a rigid contact sticks is arbitrary. For an elastic contact the position of the slider is
    /// arbitrary, and so is the constant part of the force in the contact. The positions are those
    /// of the state at which the search began. [`multipliers`](Self::multipliers) omits the
    /// multipliers 1 of the family.
    pub fn unslipped(&self) -> &[usize] {
        &self.unslipped
    }

    /// The directions of the continuous family to which the motion belongs: one perturbation of
    /// [`state`](Self::state) for each, in its units. Empty if the motion is isolated.
    ///
    /// The motion from the state plus ε times a direction is also periodic, up to ε² and with a
    /// period that may differ by the order of ε. The largest entry of a direction, in units of the
    /// size of its variable in the motion, is 1. Several directions are a basis. A family has one
    /// direction for each contact that never [slips](Self::unslipped), and for each quantity that
    /// the motion conserves: a momentum along a direction in which no force acts, a memory variable
    /// minus a displacement, an energy. Which member a search finds: see [`shoot`](super::shoot).
    /// Shifts along an autonomous motion and
    /// [translations](super#motions-that-are-translated) give the same motion again and do not
    /// count. Motions that grow or decay by less than 1e-11 per period count as members of a
    /// family.
    ///
    /// ```
    /// use stick_slip::orbit::{self, Period};
    /// use stick_slip::structure::State;
    /// use stick_slip::{Contact, Coulomb, Drive, Structure};
    ///
    /// // Two bodies that rub on each other and that nothing holds: their momentum is conserved.
    /// let pair = Structure::new(&[1.0, 3.0])?
    ///     .with_spring(0, 1, 2.0)?
    ///     .with_force(0, Drive::harmonic(1.0, 1.1, 0.0)?)?
    ///     .with_contact(Contact::between(0, 1, Coulomb::new(0.3, 0.2)?, 1.0)?)?;
    /// let start = State::new(&[0.0, 0.0], &[2.0, -0.4]);
    /// let orbit = orbit::settle(&pair, &start, 100.0, Period::Driven(1))?;
    /// let [direction] = orbit.families() else { panic!() };
    /// assert!((direction.velocities[0] - direction.velocities[1]).abs() < 1e-12);
    /// let velocities = orbit.state().velocities;
    /// assert!((velocities[0] + 3.0 * velocities[1] - 0.8).abs() < 1e-12);
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    #[doc(alias = "continuum")]
    pub fn families(&self) -> &[S] {
        &self.families
    }

    /// Returns true if the motion is its own mirror image half a period later: each displacement
    /// satisfies x_i(t + T/2) = c_i − x_i(t) with a constant c_i. A memory variable satisfies the
    /// same equation, or repeats itself after half a period (as the time in stick does).
    ///
    /// The condition is checked at 12 times, with a tolerance of 10⁻⁷ of the size of each variable.
    pub fn is_symmetric(&self) -> bool {
        self.is_symmetric
    }

    /// Returns true if all multipliers lie inside the unit circle, except for the multipliers 1 of
    /// a [family](Self::families): small perturbations decay, up to a change of the member.
    pub fn is_stable(&self) -> bool {
        let mut neutral = self.neutral;
        self.multipliers.iter().all(|m| {
            // Rounding, magnified by the motion.
            let is_neutral = neutral > 0 && (m - 1.0).norm() <= 1e-6;
            neutral -= usize::from(is_neutral);
            is_neutral || m.norm() < 1.0
        })
    }

    /// Returns true if a contact alternates between stick and slip.
    pub(super) fn alternates(&self) -> bool {
        self.alternates
    }

    /// Returns true if the motion is one of a family that conserves a quantity.
    pub(super) fn is_one_of_many(&self) -> bool {
        self.neutral > 0
    }
}

impl<S: SystemState> Orbit<S> {
    /// Number of coordinates.
    #[cfg(feature = "serde")]
    pub(super) fn coordinates(&self) -> usize {
        self.measures.coordinates.len()
    }

    fn coordinate<T>(&self, coordinate: usize, of: impl Fn(&Coordinate) -> T) -> Option<T> {
        self.measures.coordinates.get(coordinate).map(of)
    }

    fn contact(&self, contact: usize, of: impl Fn(&Contact) -> f64) -> f64 {
        self.measures.contacts.get(contact).map_or(f64::NAN, of)
    }

    fn range(&self, coordinate: usize, which: usize) -> (f64, f64) {
        let range = self.coordinate(coordinate, |of| of.ranges[which]);
        range.unwrap_or((f64::NAN, f64::NAN))
    }
}

/// Measures of the motion, with the names of the measures of a [`LimitCycle`](crate::LimitCycle).
impl<S: SystemState> Orbit<S> {
    /// Angular frequency ω = 2π/T, per unit of time.
    pub fn frequency(&self) -> f64 {
        std::f64::consts::TAU / self.period()
    }

    /// Frequency 1/T, per unit of time: in hertz if times are in seconds.
    pub fn hertz(&self) -> f64 {
        1.0 / self.period()
    }

    /// Least and largest displacement of a coordinate. If the motion is periodic only up to a
    /// [translation](Self::mean_velocity), displacements are relative to a frame that moves at the
    /// mean velocity from time 0 on.
    pub fn extremes(&self, coordinate: usize) -> (f64, f64) {
        self.range(coordinate, 0)
    }

    /// Least and largest velocity of a coordinate.
    pub fn velocity_extremes(&self, coordinate: usize) -> (f64, f64) {
        self.range(coordinate, 1)
    }

    /// Least and largest acceleration of a coordinate, including the values on both sides of each
    /// event.
    pub fn acceleration_extremes(&self, coordinate: usize) -> (f64, f64) {
        self.range(coordinate, 2)
    }

    /// Amplitude of a coordinate: half the distance between its largest and its least displacement.
    ///
    /// ```
    /// use stick_slip::orbit::{self, Period};
    /// use stick_slip::{Contact, Drive, Polynomial, Structure, structure::State};
    ///
    /// let contact = Contact::new(0, Polynomial::new(0.4, 0.25, 0.5)?, 1.0)?.on_belt(0.2);
    /// let forced = Structure::new(&[1.0])?
    ///     .with_ground_spring(0, 1.0)?
    ///     .with_ground_damper(0, 0.1)?
    ///     .with_force(0, Drive::harmonic(0.15, 0.8, 0.0)?)?
    ///     .with_contact(contact)?;
    /// let orbit = orbit::settle(&forced, &State::at_rest(1), 100.0, Period::Driven(1))?;
    /// assert!((orbit.amplitude(0) - 0.4223186731942).abs() < 1e-12);
    /// assert!((orbit.rms_velocity(0) - 0.2387076461704).abs() < 1e-12);
    ///
    /// // Most of the vibration has the frequency of the force.
    /// let harmonics = orbit.harmonics(0, 3);
    /// assert!(harmonics[0].norm() > 3.0 * harmonics[1].norm());
    ///
    /// // The work of the force and of the belt becomes heat, in the damper and in the contact.
    /// let energy = orbit.energy();
    /// let heat = energy.damper_loss + energy.friction_loss[0];
    /// assert!((energy.force_work[0] + energy.drive_work[0] - heat).abs() < 1e-14);
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    pub fn amplitude(&self, coordinate: usize) -> f64 {
        let (least, largest) = self.extremes(coordinate);
        0.5 * (largest - least)
    }

    /// Mean velocity V = (q(T) − q(0))/T of a coordinate. V differs from 0 only if the motion is
    /// periodic [up to a translation](super#motions-that-are-translated).
    ///
    /// The displacement is the sum of Vt and a periodic part. [`extremes`](Self::extremes),
    /// [`amplitude`](Self::amplitude), [`mean_displacement`](Self::mean_displacement) and
    /// [`harmonics`](Self::harmonics) are measures of the periodic part.
    pub fn mean_velocity(&self, coordinate: usize) -> f64 {
        self.coordinate(coordinate, |of| of.mean_velocity)
            .unwrap_or(f64::NAN)
    }

    /// Mean displacement (1/T)∮q dt of a coordinate, without the
    /// [translation](Self::mean_velocity).
    pub fn mean_displacement(&self, coordinate: usize) -> f64 {
        self.coordinate(coordinate, |of| of.mean)
            .unwrap_or(f64::NAN)
    }

    /// Root mean square of the velocity of a coordinate, √((1/T)∮v² dt).
    #[doc(alias = "severity")]
    pub fn rms_velocity(&self, coordinate: usize) -> f64 {
        let found = self.coordinate(coordinate, |of| of.rms_velocity);
        found.unwrap_or(f64::NAN)
    }

    /// Root mean square of the acceleration of a coordinate, √((1/T)∮v'² dt).
    pub fn rms_acceleration(&self, coordinate: usize) -> f64 {
        let found = self.coordinate(coordinate, |of| of.rms_acceleration);
        found.unwrap_or(f64::NAN)
    }

    /// Largest absolute acceleration |v'| of a coordinate, including the values on both sides of
    /// each event.
    pub fn peak_acceleration(&self, coordinate: usize) -> f64 {
        let (least, largest) = self.acceleration_extremes(coordinate);
        largest.max(-least)
    }

    /// Time that a contact sticks in each period, in units of time.
    pub fn stick_duration(&self, contact: usize) -> f64 {
        self.contact(contact, |of| of.stick_duration)
    }

    /// Number of times that a contact is released from stick in each period: the number of slips of
    /// a contact that alternates between stick and slip, otherwise 0.
    ///
    /// ```
    /// use stick_slip::orbit::{self, Period};
    /// use stick_slip::{MassOnBelt, Polynomial};
    ///
    /// let system = MassOnBelt::new(Polynomial::new(0.4, 0.25, 0.5)?, 0.2)?.with_damping(0.05)?;
    /// let orbit = orbit::shoot(&system, &(0.1, 0.2).into(), Period::Free(7.0))?;
    /// assert_eq!(orbit.slips(0), 1);
    /// assert_eq!(orbit.hertz() * orbit.period(), 1.0);
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    pub fn slips(&self, contact: usize) -> usize {
        let is_release = |event: &&Event<S>| {
            event.contact() == Some(contact) && matches!(event.kind, EventKind::Release(_))
        };
        self.events.iter().filter(is_release).count()
    }

    /// Largest sliding speed |r| of a contact while it slips, where r is the relative velocity; 0
    /// if the contact never slips. The friction law must be valid up to this speed.
    pub fn max_sliding_speed(&self, contact: usize) -> f64 {
        self.contact(contact, |of| of.max_sliding_speed)
    }

    /// Work and heat over one period, for each force, contact and damper. A factor or a load that
    /// jumps at the end of the period counts as one that jumps inside. For a
    /// [`MassOnBelt`](crate::MassOnBelt) these are the values of
    /// [`LimitCycle::energy`](crate::LimitCycle::energy). A value with a term that
    /// overflows is ±∞, or NaN if terms of both signs do.
    pub fn energy(&self) -> &EnergyBudget {
        &self.measures.energy
    }
}

impl<S: SystemState> Orbit<S> {
    /// Complex amplitudes of the first n harmonics of a coordinate's displacement: (2/T)∮q
    /// e^(−ikωt) dt for k = 1, …, n, with ω = 2π/T and the time t from the start of the period
    /// ([`state`](Self::state)). The modulus is the amplitude of the harmonic. The cost is in
    /// proportion to n. The list is empty if the coordinate does not exist.
    #[doc(alias = "spectrum")]
    #[doc(alias = "fft")]
    pub fn harmonics(&self, coordinate: usize, n: usize) -> Vec<Complex<f64>> {
        let measured = self.coordinate(coordinate, |of| (of.mean, of.mean_velocity));
        let Some((mean, velocity)) = measured else {
            return Vec::new();
        };
        let (least, most) = self.extremes(coordinate);
        let unit = power_of_two(most.max(-least).max(1.0));
        let mut fourier = Fourier::new(self.frequency(), n);
        for step in self.trajectory().steps() {
            let start = step.start_time();
            let displacement = |t: f64| {
                let displacement = step.state_at(t).general().displacements[coordinate];
                (displacement - velocity * (start + t) - mean) / unit
            };
            fourier.add(start, step.duration(), &displacement);
        }
        fourier.amplitudes(unit)
    }

    /// Complex amplitudes of the first n harmonics of a coordinate's velocity. The k-th amplitude
    /// is ikω times that of the displacement, with ω = 2π/T.
    #[doc(alias = "spectrum")]
    #[doc(alias = "fft")]
    pub fn velocity_harmonics(&self, coordinate: usize, n: usize) -> Vec<Complex<f64>> {
        self.differentiated(coordinate, n, 1)
    }

    /// Complex amplitudes of the first n harmonics of a coordinate's acceleration. The k-th
    /// amplitude is (ikω)² times that of the displacement, with ω = 2π/T. If the acceleration jumps
    /// at events, the k-th amplitude decreases only as 1/k.
    #[doc(alias = "spectrum")]
    #[doc(alias = "fft")]
    pub fn acceleration_harmonics(&self, coordinate: usize, n: usize) -> Vec<Complex<f64>> {
        self.differentiated(coordinate, n, 2)
    }

    fn differentiated(&self, coordinate: usize, n: usize, times: i32) -> Vec<Complex<f64>> {
        differentiated(self.harmonics(coordinate, n), self.frequency(), times)
    }
}

impl<S: SystemState + PartialEq> PartialEq for Orbit<S> {
    /// Compares the motion, its kind and its multipliers, from which the rest follows.
    fn eq(&self, other: &Self) -> bool {
        self.kind == other.kind
            && self.period == other.period
            && self.state == other.state
            && self.events == other.events
            && self.multipliers == other.multipliers
    }
}

impl<S: SystemState> fmt::Debug for Orbit<S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Orbit")
            .field("kind", &self.kind)
            .field("period", &self.period)
            .field("events", &self.events.len())
            .field("multipliers", &self.multipliers)
            .finish_non_exhaustive()
    }
}

/// A time of a periodic motion, in (0, T]. A time within rounding of 0 becomes T.
fn within(time: f64, period: f64) -> f64 {
    const ROUNDING: f64 = 16.0 * f64::EPSILON;
    let time = if time > period { time - period } else { time };
    if time <= ROUNDING * period || time > (1.0 - ROUNDING) * period {
        period
    } else {
        time
    }
}

#[cfg(test)]
mod tests {
    use super::super::shoot::settle;
    use super::*;
    use crate::drive::Drive;
    use crate::friction::memory::Dwell;
    use crate::friction::{Coulomb, Exponential};
    use crate::structure::{Contact, Structure};

    /// The steps of a motion are computed again to the bit, wherever it was begun.
    #[test]
    fn steps_are_those_of_the_map() -> Result<(), Error> {
        let clock = Dwell::exponential(Exponential::new(0.4, 0.25, 0.5)?, 0.5, 1.0)?;
        let elastic = Contact::new(1, Coulomb::new(0.3, 0.3)?, 0.5)?
            .with_tangential_stiffness(8.0)?
            .with_normal_spring(&[(1, 0.5)], 3.0)?;
        let system = Structure::new(&[1.0, 0.7])?
            .with_ground_spring(0, 1.0)?
            .with_spring(0, 1, 0.8)?
            .with_ground_damper(0, 0.2)?
            .with_ground_damper(1, 0.2)?
            .with_force(0, Drive::harmonic(0.9, 0.8, 0.0)?)?
            .with_contact(Contact::new(0, clock, 1.0)?.on_belt(0.1))?
            .with_contact(elastic)?;
        let orbit = settle(&system, &State::at_rest(2), 300.0, Period::Driven(1))?;
        let (form, motion) = (system.form(), orbit.trajectory());
        for part in [0.0, 0.3, 0.71] {
            let time = part * orbit.period();
            let mut steps = motion.steps().iter();
            let step = steps.find(|step| step.end_time() > time).unwrap();
            let mut start = step.state_at(step.since_start(time));
            form.put_in_modes(&mut start, time, &|c| Some(step.modes()[c]));
            let map = run::period_map(&form, time, &start, orbit.period())?;
            let again = map.course().steps(&form, orbit.period());
            assert!(
                again.len() > 10 && again == map.since_zero(orbit.period()).steps,
                "{part}"
            );
        }
        Ok(())
    }
}
