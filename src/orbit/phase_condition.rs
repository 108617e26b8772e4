//! The start of motions while Newton's method searches for them: away from events, at a time of the
//! period of a forced motion, or where an autonomous one meets its phase condition.

use nalgebra::DVector;

use super::period_map::{self, PeriodMap, state, vector};
use super::prescribed_modes::{Hold, Then};
use super::shooting_residual::TrialMotion;
use super::tangent::flow_of;
use super::translation::Turning;
use super::type_erased_system::GeneralForm;
use super::watched_event::Mark;
use crate::error::Error;
use crate::motion::{Mode, Segment};
use crate::series::PowerSeries;
use crate::state::structure::State;
use crate::structure::Step;

/// The start of motions: the data that do not change during Newton's method.
#[derive(Debug, Clone)]
pub(super) struct FrozenStart {
    /// The start of a forced motion, as a part of its period.
    pub(super) phase: f64,
    /// The modes of the contacts at the start.
    pub(super) modes: Vec<Mode>,
    /// The phase condition of an autonomous motion.
    pub(super) condition: Option<PhaseCondition>,
    /// The sizes of the start, and the period of an autonomous motion.
    pub(super) sizes: DVector<f64>,
    /// Contacts held past touches, and events that are watched.
    pub(super) holds: Vec<Hold>,
    pub(super) marks: Vec<Mark>,
}

/// The phase condition of an autonomous motion: it starts on a plane, which it passes with a
/// positive speed.
#[derive(Debug, Clone)]
pub(super) struct PhaseCondition {
    /// The coordinate that turns at the start, v_i = 0: the condition holds however small the
    /// motion becomes. Otherwise the plane lies across the flow.
    pub(super) turning: Option<Turning>,
    point: DVector<f64>,
    pub(super) normal: DVector<f64>,
}

/// Parts of the period within which an event is near the start, when that is chosen and later.
const FAR: f64 = 0.02;
const NEAR: f64 = 0.005;

/// The start is moved once the motion passes the phase condition at this part of the speed that it
/// has at the sharpest turning point, or across a plane.
const BLUNT: f64 = 0.3;

/// The least acceleration at a turning point, in units of the extent of the velocity per period.
const SHARP: f64 = 1.0;

impl PhaseCondition {
    /// A coordinate turns, with an acceleration of this sign. Numbers are in units of sizes.
    pub(super) fn of_turning(turning: Turning, sign: f64, sizes: &DVector<f64>, n: usize) -> Self {
        let mut normal = DVector::zeros(sizes.len());
        for (j, factor) in turning.entries(n) {
            normal[j] = sign * factor / sizes[n + turning.coordinate];
        }
        Self {
            turning: Some(turning),
            point: DVector::zeros(sizes.len()),
            normal,
        }
    }

    /// The plane through a point, across the flow there. Numbers are in units of sizes.
    pub(super) fn across(
        flow: &DVector<f64>,
        point: DVector<f64>,
        sizes: &DVector<f64>,
    ) -> Result<Self, Error> {
        let normal = flow.component_div(sizes);
        let normal = normal.try_normalize(0.0).ok_or(Error::AtRest)?;
        Ok(Self {
            turning: None,
            point,
            normal: normal.component_div(sizes),
        })
    }

    /// The distance of a start from the plane.
    pub(super) fn missed_by(&self, start: &DVector<f64>) -> f64 {
        self.normal.dot(&(start - &self.point))
    }

    /// The speed at which a motion with this rate of change passes the plane.
    pub(super) fn speed(&self, flow: &DVector<f64>) -> f64 {
        self.normal.dot(flow)
    }

    /// The distance from the plane along a step.
    fn series(&self, step: &Step) -> Option<PowerSeries> {
        let (n, rates) = (step.state().displacements.len(), step.series());
        let mut sum = PowerSeries::from_fn(|_| 0.0);
        for (j, &factor) in self.normal.iter().enumerate().filter(|(_, x)| **x != 0.0) {
            match j.checked_sub(n) {
                Some(j) => sum.add(factor, rates.get(j)?),
                None => {
                    let (velocity, from) = (rates.get(j)?, step.state().displacements[j]);
                    let moved = PowerSeries::from_fn(|k| match k {
                        0 => from,
                        k => velocity[k - 1] / k as f64,
                    });
                    sum.add(factor, &moved);
                }
            }
        }
        sum[0] -= self.normal.dot(&self.point);
        Some(sum)
    }

    /// The states in which a motion passes the plane with a positive speed.
    fn passed(&self, map: &PeriodMap) -> Vec<DVector<f64>> {
        let mut passed = Vec::new();
        for step in &map.steps {
            let Some(missed) = self.series(step) else {
                continue;
            };
            missed.sign_changes(step.duration(), &mut |t, rises| {
                if rises {
                    passed.extend(map.vector_at(step.start_time() + t));
                }
            });
        }
        passed
    }
}

impl FrozenStart {
    /// The start at time 0, with no contact known to stick.
    pub(super) fn at_zero() -> Self {
        Self {
            phase: 0.0,
            modes: Vec::new(),
            condition: None,
            sizes: DVector::zeros(0),
            holds: Vec::new(),
            marks: Vec::new(),
        }
    }

    /// A start of a closed motion away from its events, and the state there; the sharpest turning
    /// point of an autonomous motion, if there is one.
    pub(super) fn away(
        map: &PeriodMap,
        period: f64,
        old: &Self,
        is_free: bool,
    ) -> Result<(DVector<f64>, Self), Error> {
        let begins = map.begins();
        let turn = is_free.then(|| sharpest(map, period)).flatten();
        let time = match &turn {
            Some(turn) => turn.time,
            None if begins_near_event(map, period, FAR) => {
                period_map::longest_pause(map, begins, begins + period)
            }
            None => begins,
        };
        // The start and the end of a closed motion are one state.
        let time = begins + (time - begins).rem_euclid(period);
        let step = map.steps.iter().find(|step| step.end_time() > time);
        let step = step.ok_or(Error::InvalidDuration { value: period })?;
        let step = step.clone().from(step.since_start(time));
        let mut state = step.state().clone();
        if let Some(turn) = &turn {
            turn.turning.impose(&mut state.velocities);
        }
        let mut begin = Self {
            phase: if is_free {
                0.0
            } else {
                (time / period).fract()
            },
            modes: step.modes().to_vec(),
            condition: None,
            sizes: DVector::zeros(0),
            holds: map.holds_later(time - begins, period),
            marks: old.marks.clone(),
        };
        for mark in &mut begin.marks {
            mark.since = (mark.since + begins - time).rem_euclid(period);
        }
        let (n, start) = (state.displacements.len(), vector(&state, map.order()));
        if is_free {
            let sizes = map.sizes();
            begin.condition = Some(match turn {
                Some(turn) => PhaseCondition::of_turning(turn.turning, turn.sign, &sizes, n),
                None => {
                    let mut flow = flow_of(&step, n);
                    map.untranslated(&mut flow);
                    PhaseCondition::across(&flow, start.clone(), &sizes)?
                }
            });
        }
        Ok((start, begin))
    }

    /// Sets sizes and phase condition to those of a motion.
    pub(super) fn settle(&mut self, start: DVector<f64>, trial: &TrialMotion) -> Result<(), Error> {
        let (map, sizes) = (&trial.map, trial.map.sizes());
        self.sizes = sizes.clone();
        let Some(condition) = &self.condition else {
            return Ok(());
        };
        self.condition = Some(match condition.turning.clone() {
            Some(turning) => {
                let n = map.start.displacements.len();
                let sign = condition.speed(&map.flow[0]).signum();
                PhaseCondition::of_turning(turning, sign, &sizes, n)
            }
            None => PhaseCondition::across(&map.flow[0], start, &sizes)?,
        });
        self.sizes = sizes.insert_row(map.order(), trial.period);
        Ok(())
    }

    /// Another start for the same motion, if an event has come near this one, or if the motion
    /// passes the phase condition slowly.
    pub(super) fn moved(&self, map: &PeriodMap, period: f64) -> Option<(DVector<f64>, Self)> {
        let is_near = begins_near_event(map, period, NEAR);
        let is_blunt = self.condition.as_ref().is_some_and(|condition| {
            let (sizes, turn) = (map.sizes(), sharpest(map, period));
            let speed = condition.speed(&map.flow[0]).abs();
            let unit = condition.normal.component_mul(&sizes).amax();
            let best = turn.as_ref().map_or(0.0, |turn| turn.sharpness);
            let flow = map.flow[0].component_div(&sizes).norm();
            match &condition.turning {
                Some(_) => speed < BLUNT * best * unit,
                None => turn.is_some() || speed < BLUNT * flow * unit,
            }
        });
        (is_near || is_blunt)
            .then(|| Self::away(map, period, self, self.condition.is_some()).ok())?
    }

    /// The time of the start of a motion, and its start in y, in its modes.
    pub(super) fn of(&self, form: &GeneralForm<'_>, y: &DVector<f64>, period: f64) -> (f64, State) {
        let time = self.phase * period;
        let mut start = state(&y.rows(0, form.order()).into_owned(), form.len());
        let condition = self.condition.as_ref();
        if let Some(turning) = condition.and_then(|condition| condition.turning.as_ref()) {
            turning.impose(&mut start.velocities);
        }
        // Last, as rest at a contact may take more than one of the velocities.
        form.put_in_modes(&mut start, time, &|c| self.modes.get(c).copied());
        (time, start)
    }

    /// The states of a closed motion with another start at which it could have this one. A motion
    /// over several periods of the drives passes so many of them.
    pub(super) fn seen(
        &self,
        (map, period): (&PeriodMap, f64),
        old: &Self,
        periods: usize,
    ) -> Vec<DVector<f64>> {
        let start = vector(&map.start, map.order());
        let states = match &self.condition {
            Some(condition) => condition.passed(map),
            None => {
                let later = (0..periods).filter_map(|j| {
                    let part = self.phase - old.phase + j as f64 / periods as f64;
                    map.vector_at(map.begins() + part.rem_euclid(1.0) * period)
                });
                later.collect()
            }
        };
        let back = |state: DVector<f64>| {
            let mut change = state - &start;
            map.untranslated(&mut change);
            &start + map.without_idle(change)
        };
        let own = self.condition.is_some().then(|| start.clone());
        states.into_iter().map(back).chain(own).collect()
    }

    /// Lets contacts slip on past their touches without a rest.
    pub(super) fn slip_on(&mut self) {
        let holds = self.holds.iter_mut();
        let rest = holds.filter(|hold| hold.then == Then::SlipsAfterRest);
        rest.for_each(|hold| hold.then = Then::Slips);
    }
}

/// A turning point of a coordinate of an autonomous motion.
struct TurningPoint {
    /// Acceleration of the coordinate there in units of its largest velocity, and the sign.
    sharpness: f64,
    sign: f64,
    turning: Turning,
    time: f64,
}

/// The sharpest turning point of an autonomous motion away from events.
fn sharpest(map: &PeriodMap, period: f64) -> Option<TurningPoint> {
    let n = map.start.displacements.len();
    let mut sharpest: Option<TurningPoint> = None;
    let (speeds, extents) = (map.sizes(), map.extents());
    let turnings: Vec<Turning> = (0..n).map(|i| map.turning(i)).collect();
    let events = map.times();
    for step in &map.steps {
        for (coordinate, turning) in turnings.iter().enumerate() {
            let Some(velocity) = turning.series(step) else {
                continue;
            };
            velocity.sign_changes(step.duration(), &mut |t, _| {
                let acceleration = velocity.derivative().at(t);
                let sharpness = acceleration.abs() / speeds[n + coordinate];
                // The first of several equal ones, in spite of rounding.
                let most = sharpest.as_ref().map_or(0.0, |most| 1.001 * most.sharpness);
                let time = step.start_time() + t;
                let is_sharp = acceleration.abs() * period >= SHARP * extents[n + coordinate];
                if sharpness > most && is_sharp && !near_events(&events, time, period, FAR) {
                    sharpest = Some(TurningPoint {
                        sharpness,
                        sign: acceleration.signum(),
                        turning: turning.clone(),
                        time,
                    });
                }
            });
        }
    }
    sharpest
}

/// Returns true if an event is near the start of a closed motion; one exactly there may be missing.
fn begins_near_event(map: &PeriodMap, period: f64, part: f64) -> bool {
    near_events(&map.times(), map.begins(), period, part)
        || map.first_modes() != Some(map.end_modes())
}

/// Returns true if one of these [times](PeriodMap::times) lies within a part of the period from a
/// time of a closed motion.
fn near_events(events: &[f64], time: f64, period: f64, part: f64) -> bool {
    events.iter().any(|event| {
        let since = (event - time).rem_euclid(period);
        since < part * period || since > (1.0 - part) * period
    })
}
