//! Where motions start: away from events, with a phase condition, held contacts and watched events.

use nalgebra::DVector;

use super::super::curve::{BLUNT, sharpest};
use super::super::map::{self, PeriodMap, held_period_map, vector};
use super::super::trial::TrialMotion;
use super::frozen_start::{FrozenStart, Section};
use super::motions::Motions;
use crate::error::Error;
use crate::motion::{Mode, Segment};
use crate::state::structure::State;

/// Parts of the period within which an event is near the start, when that is chosen and later.
const FAR: f64 = 0.02;
const NEAR: f64 = 0.005;

impl Motions<'_> {
    /// A start of the motion away from its events: y there, and what stays.
    pub(super) fn begun(
        &self,
        y: &DVector<f64>,
        trial: &TrialMotion,
        old: &FrozenStart,
    ) -> Result<(DVector<f64>, FrozenStart), Error> {
        let (map, period) = (&trial.map, trial.period);
        let begins = old.phase * period;
        let turn = sharpest(map).filter(|_| self.is_free());
        let turn = turn.filter(|turn| !near_events(map, turn.time, period, NEAR));
        let (time, state, modes) = match &turn {
            Some(turn) => (turn.time, turn.state.clone(), Some(&turn.modes[..])),
            None if near_events(map, begins, period, FAR) => middle(map, begins, period),
            None => (begins, map.start.clone(), map.first_modes()),
        };
        let mut begin = FrozenStart {
            phase: if self.is_free() {
                0.0
            } else {
                (time / period).fract()
            },
            modes: modes.unwrap_or_default().to_vec(),
            section: turn.map(|turn| Section {
                turning: Some(turn.turning),
                point: DVector::zeros(self.order),
                normal: DVector::zeros(self.order),
            }),
            sizes: DVector::zeros(0),
            holds: map.holds_later(time - begins, period),
            marks: old.marks.clone(),
        };
        for mark in &mut begin.marks {
            mark.since = (mark.since + begins - time).rem_euclid(period);
        }
        let mut y = y.clone();
        y.rows_mut(0, self.order)
            .copy_from(&vector(&state, self.order));
        let trial = self.trial(&y, &begin)?;
        y.rows_mut(0, self.order)
            .copy_from(&vector(&trial.map.start, self.order));
        self.settle(&y, &trial, &mut begin)?;
        Ok((y, begin))
    }

    /// Sets sizes and phase condition to those of a motion.
    pub(super) fn settle(
        &self,
        y: &DVector<f64>,
        trial: &TrialMotion,
        begin: &mut FrozenStart,
    ) -> Result<(), Error> {
        let mut sizes = trial.map.sizes();
        if self.is_free() {
            sizes = sizes.insert_row(self.order, trial.period);
            let section = begin.section.as_ref();
            let turning = section.and_then(|section| section.turning.clone());
            let own = sizes.rows(0, self.order);
            let (point, normal) = if let Some(turning) = &turning {
                let mut normal = DVector::zeros(self.order);
                for (j, factor) in turning.entries(self.n) {
                    normal[j] = factor / own[self.n + turning.coordinate];
                }
                (DVector::zeros(self.order), normal)
            } else {
                let normal = trial.map.flow[0].component_div(&own);
                if normal.amax() == 0.0 {
                    return Err(Error::AtRest);
                }
                let normal = normal.normalize().component_div(&own);
                (y.rows(0, self.order).into_owned(), normal)
            };
            begin.section = Some(Section {
                turning,
                point,
                normal,
            });
        }
        begin.sizes = sizes;
        Ok(())
    }

    /// Another start, if an event has come near this one, or the motion turns more sharply
    /// elsewhere.
    pub(super) fn moved(
        &self,
        y: &DVector<f64>,
        trial: &TrialMotion,
        begin: &FrozenStart,
    ) -> Option<(DVector<f64>, FrozenStart)> {
        let begins = begin.phase * trial.period;
        let is_near = near_events(&trial.map, begins, trial.period, NEAR);
        let turning = begin.section.as_ref();
        let turning = turning.and_then(|section| section.turning.as_ref());
        let is_blunt = turning.is_some_and(|turning| {
            let acceleration = turning.of_velocities(|j| trial.map.flow[0][self.n + j]);
            let sharpness = acceleration.abs() / begin.sizes[self.n + turning.coordinate];
            sharpest(&trial.map).is_some_and(|turn| sharpness < BLUNT * turn.sharpness)
        });
        (is_near || is_blunt).then(|| self.begun(y, trial, begin).ok())?
    }

    /// The motion from time 0 of the drives.
    pub(super) fn since_zero(
        &self,
        y: &DVector<f64>,
        trial: &TrialMotion,
        begin: &FrozenStart,
    ) -> Result<TrialMotion, Error> {
        if begin.phase == 0.0 {
            return Ok(trial.clone());
        }
        let period = trial.period;
        let step = trial.map.steps.iter().find(|step| step.end_time() > period);
        let Some(step) = step else {
            return Ok(trial.clone());
        };
        self.with_form(self.parameters(y), |form| {
            let mut start = step.state_at(step.since_start(period));
            form.put_in_modes(&mut start, 0.0, &|c| Some(step.modes()[c]));
            let holds = trial.map.holds_later((1.0 - begin.phase) * period, period);
            let map = held_period_map(&form, (0.0, &start), period, &holds)?;
            Ok(TrialMotion::new(map, period))
        })
    }
}

/// Returns true if an event or a touch lies within a part of the period from a time of a closed
/// motion.
fn near_events(map: &PeriodMap, time: f64, period: f64, part: f64) -> bool {
    map.times().into_iter().any(|event| {
        let since = (event - time).rem_euclid(period);
        since < part * period || since > (1.0 - part) * period
    })
}

/// The middle of the longest time without an event in a motion: the time, the state and the modes.
fn middle(map: &PeriodMap, begins: f64, period: f64) -> (f64, State, Option<&[Mode]>) {
    let time = map::longest_pause(map, begins, begins + period);
    let step = map.steps.iter().find(|step| step.end_time() > time);
    step.map_or((begins, map.start.clone(), map.first_modes()), |step| {
        let state = step.state_at(step.since_start(time));
        (time, state, Some(step.modes()))
    })
}
