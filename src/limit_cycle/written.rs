//! Cycles as they are written and read (feature `serde`).
//!
//! A cycle does not know the friction law, so what is read is checked against itself: it must be a
//! closed, continuous motion of its kind, and the numbers written for other programs must be its
//! own.

use serde::{Deserialize, Serialize};

use super::{CycleKind, CycleSet, EnergyBudget, LimitCycle};
use crate::integrator::{Clock, Event, EventKind, Mode, Polynomial, Step, derivative, evaluate};
use crate::quadrature::gauss_legendre;
use crate::{Error, State};

/// Distance, relative to the motion's size, that numbers which say the same may lie apart.
const CLOSE: f64 = 1e-8;

/// The same for the logarithm of the multiplier, which is computed from second derivatives of the
/// series.
const MULTIPLIER_CLOSE: f64 = 1e-3;

/// What is written: numbers of the whole cycle, and the series that it consists of.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct WrittenCycle {
    kind: CycleKind,
    belt_velocity: f64,
    damping: f64,
    multiplier: f64,
    period: f64,
    stick_duration: f64,
    amplitude: f64,
    mean_displacement: f64,
    max_velocity: f64,
    min_velocity: f64,
    energy: EnergyBudget,
    steps: Vec<WrittenStep>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct WrittenStep {
    duration: f64,
    mode: Mode,
    state: State,
    /// Coefficients of the sliding speed.
    speed: Polynomial,
    event: Option<Event>,
}

impl From<LimitCycle> for WrittenCycle {
    fn from(cycle: LimitCycle) -> Self {
        Self {
            kind: cycle.kind,
            belt_velocity: cycle.belt_velocity(),
            damping: cycle.damping,
            multiplier: cycle.multiplier,
            period: cycle.period(),
            stick_duration: cycle.stick_duration(),
            amplitude: cycle.amplitude(),
            mean_displacement: cycle.mean_displacement(),
            max_velocity: cycle.max_velocity(),
            min_velocity: cycle.min_velocity(),
            energy: cycle.energy(),
            steps: cycle.steps.iter().map(WrittenStep::from).collect(),
        }
    }
}

impl From<&Step> for WrittenStep {
    fn from(step: &Step) -> Self {
        Self {
            duration: step.duration,
            mode: step.mode,
            state: step.state,
            speed: step.speed,
            event: step.event,
        }
    }
}

impl TryFrom<WrittenCycle> for LimitCycle {
    type Error = Error;
    fn try_from(written: WrittenCycle) -> Result<Self, Error> {
        let (v_b, damping) = (written.belt_velocity, written.damping);
        Error::check("belt_velocity", v_b, v_b != 0.0, "belt_velocity ≠ 0")?;
        Error::check("damping", damping, damping >= 0.0, "damping ≥ 0")?;
        let count = written.steps.len() as f64;
        Error::check("steps", count, count > 0.0, "steps > 0: their number")?;
        let mut clock = Clock::default();
        let mut steps = Vec::with_capacity(written.steps.len());
        for step in written.steps {
            let start = clock;
            let step = step.checked(start, v_b)?;
            clock = start.after(step.duration);
            steps.push(step);
        }
        let cycle = Self {
            steps,
            kind: written.kind,
            multiplier: written.multiplier,
            damping,
        };
        cycle.check_joints()?;
        cycle.check_kind()?;
        let size = cycle.max_displacement().abs() + cycle.amplitude() + v_b.abs();
        let period = cycle.period();
        let (read, energy, work) = (written.energy, cycle.energy(), size * size * period);
        for (name, value, own, size) in [
            ("period", written.period, period, period),
            (
                "stick_duration",
                written.stick_duration,
                cycle.stick_duration(),
                period,
            ),
            ("amplitude", written.amplitude, cycle.amplitude(), size),
            (
                "mean_displacement",
                written.mean_displacement,
                cycle.mean_displacement(),
                size,
            ),
            (
                "max_velocity",
                written.max_velocity,
                cycle.max_velocity(),
                size,
            ),
            (
                "min_velocity",
                written.min_velocity,
                cycle.min_velocity(),
                size,
            ),
            ("drive_work", read.drive_work, energy.drive_work, work),
            ("belt_work", read.belt_work, energy.belt_work, work),
            ("damper_loss", read.damper_loss, energy.damper_loss, work),
            (
                "friction_loss",
                read.friction_loss,
                energy.friction_loss,
                work,
            ),
        ] {
            let agrees = (value - own).abs() <= CLOSE * size;
            Error::check(name, value, agrees, "the value that the steps give")?;
        }
        Ok(cycle)
    }
}

impl WrittenStep {
    /// The step, if its numbers are finite and its series starts at its state.
    fn checked(self, start: Clock, v_b: f64) -> Result<Step, Error> {
        let Self {
            duration,
            mode,
            state,
            speed,
            event,
        } = self;
        Error::check("duration", duration, duration >= 0.0, "duration ≥ 0")?;
        let State {
            displacement,
            velocity,
        } = state;
        Error::check("displacement", displacement, true, "any size")?;
        for c in speed {
            Error::check("speed", c, true, "any size")?;
        }
        let step = Step {
            start,
            duration,
            mode,
            state,
            speed,
            event,
            belt_velocity: v_b,
        };
        let relative = step.sigma() * speed[0];
        let starts = (velocity - v_b - relative).abs() <= CLOSE * (v_b.abs() + velocity.abs());
        Error::check(
            "velocity",
            velocity,
            starts,
            "the velocity that the series starts with",
        )?;
        let still = mode != Mode::Stick || speed == Step::AT_REST_ON_BELT;
        Error::check("speed", speed[0], still, "speed = 0 in stick")?;
        if let Some(event) = event {
            let in_time = (event.time - step.end_time()).abs() <= CLOSE * step.end_time();
            Error::check(
                "time",
                event.time,
                in_time,
                "the end of the step that the event ends",
            )?;
        }
        Ok(step)
    }
}

impl LimitCycle {
    /// Each step with the one that follows it, the last with the first.
    fn joints(&self) -> impl Iterator<Item = (&Step, &Step)> {
        self.steps.iter().zip(self.steps.iter().cycle().skip(1))
    }

    /// The motion is continuous and closed, and its events are the changes between stick and slip.
    fn check_joints(&self) -> Result<(), Error> {
        let size = self.amplitude() + self.max_displacement().abs() + self.belt_velocity().abs();
        for (step, next) in self.joints() {
            for end in [step.state_at(step.duration), step.end_state()] {
                let State {
                    displacement,
                    velocity,
                } = next.state;
                let apart =
                    (end.displacement - displacement).abs() + (end.velocity - velocity).abs();
                let closes = apart <= CLOSE * size;
                Error::check(
                    "displacement",
                    displacement,
                    closes,
                    "the end of the step before",
                )?;
            }
            let follows = match step.event {
                Some(event) => event.kind.mode() == next.mode && step.mode != next.mode,
                None => step.mode == next.mode,
            };
            let time = step.end_time();
            Error::check(
                "time",
                time,
                follows,
                "an event where the mode changes, and only there",
            )?;
        }
        Ok(())
    }

    /// Kind and multiplier are those of the motion.
    fn check_kind(&self) -> Result<(), Error> {
        let sticks = self.steps.iter().any(|step| step.mode == Mode::Stick);
        let leads = self.leading_duration() > 0.0;
        let kind = match (sticks, leads) {
            (false, false) => CycleKind::PureSlip,
            (true, false) => CycleKind::StickSlip,
            (true, true) => CycleKind::Overshoot,
            (false, true) => CycleKind::Crossing,
        };
        let allowed = "the number of stick phases and crossings that its kind has";
        Error::check("steps", self.steps.len() as f64, kind == self.kind, allowed)?;
        let agrees = if sticks {
            self.multiplier == 0.0
        } else {
            // Powers beyond the range of f64 are written as 0 or not at all.
            let least = f64::MIN_POSITIVE.ln();
            let own = self.log_multiplier().max(least);
            let written = self.multiplier.max(f64::MIN_POSITIVE).ln();
            (own - written).abs() <= MULTIPLIER_CLOSE * (1.0 + own.abs())
        };
        let allowed = "the multiplier that the steps give";
        Error::check("multiplier", self.multiplier, agrees, allowed)?;
        Ok(())
    }

    /// Logarithm of the multiplier of a motion without stick, from its series alone.
    ///
    /// 2β + γ²dμ̂/ds, whose integral it is, follows from the equation of motion, differentiated: it
    /// is −(σv + s'')/s'.
    fn log_multiplier(&self) -> f64 {
        self.joints()
            .map(|(step, next)| {
                let rate = derivative(&step.speed);
                let second = derivative(&rate);
                let sigma = step.sigma();
                let slip = gauss_legendre(0.0, step.duration, |t| {
                    let v = step.belt_velocity + sigma * evaluate(&step.speed, t);
                    (sigma * v + evaluate(&second, t)) / evaluate(&rate, t)
                });
                let jump = match step.event.map(|event| event.kind) {
                    Some(EventKind::Crossing(_)) => {
                        (next.speed[1] / evaluate(&rate, step.duration)).abs().ln()
                    }
                    _ => 0.0,
                };
                slip + jump
            })
            .sum()
    }
}

/// A set of cycles as it is read.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ReadSet {
    cycles: Vec<LimitCycle>,
    continuum: Option<super::Continuum>,
    unresolved: Vec<std::ops::Range<f64>>,
}

impl TryFrom<ReadSet> for CycleSet {
    type Error = Error;
    fn try_from(read: ReadSet) -> Result<Self, Error> {
        let ReadSet {
            cycles,
            continuum,
            unresolved,
        } = read;
        let mut inner = 0.0;
        for cycle in &cycles {
            let amplitude = cycle.amplitude();
            let outside = amplitude >= inner;
            Error::check(
                "amplitude",
                amplitude,
                outside,
                "cycles in ascending order of amplitude",
            )?;
            inner = amplitude;
        }
        for range in &unresolved {
            Error::check("unresolved.start", range.start, true, "start ≤ end")?;
            let ordered = range.start <= range.end;
            Error::check("unresolved.end", range.end, ordered, "start ≤ end")?;
        }
        Ok(Self {
            cycles,
            continuum,
            unresolved,
        })
    }
}

/// ∞ as nothing: some formats have no infinite numbers.
pub(super) mod infinite_as_none {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    pub(in super::super) fn serialize<S: Serializer>(x: &f64, to: S) -> Result<S::Ok, S::Error> {
        x.is_finite().then_some(*x).serialize(to)
    }

    pub(in super::super) fn deserialize<'de, D: Deserializer<'de>>(
        from: D,
    ) -> Result<f64, D::Error> {
        Ok(Option::deserialize(from)?.unwrap_or(f64::INFINITY))
    }
}
