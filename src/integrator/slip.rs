//! Motion within a slip phase, one Taylor step at a time, forward or backward in time.

use super::polynomial::{
    Polynomial, TERMS, TooCurved, evaluate_four, first_root, mean, quarters, reach,
};
use super::series::{LONG, Series, SlipPoint, Time};
use crate::friction::FrictionLaw;
use crate::scalar::Workspace;
use crate::{Error, MassOnBelt, Reached, State};

/// One Taylor step.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Advance {
    /// How long the step lasts; infinite exactly on an equilibrium.
    pub(crate) duration: f64,
    /// Where it ends.
    pub(crate) end: SlipPoint,
}

impl Advance {
    /// Whether it ends in contact: at zero sliding speed.
    pub(crate) fn is_contact(&self) -> bool {
        self.end.speed == 0.0
    }
}

/// Floor of the defect that rounding alone causes, in units of ε times the largest term of the
/// equation of motion; it is seldom above 8.
const DEFECT_FLOOR: f64 = 1000.0;

/// Defect × step accepted, in units of the error allowed in a step's last term.
const DEFECT_LIMIT: f64 = 40.0 * TERMS as f64;

/// Takes Taylor steps within slip phases of one system.
///
/// Who simulates and who looks for cycles both give it a system that borrows the law,
/// MassOnBelt<&L>: `kinetic` of one type is then called from one place for each order, and inlined
/// there. Called from two, it is not, and a step takes 1.5 times as long.
#[derive(Debug, Clone)]
pub(crate) struct Stepper<'s, L> {
    system: MassOnBelt<&'s L>,
    workspace: Workspace<TERMS>,
    /// Of the step taken last.
    series: Series,
    breakpoints: Vec<f64>,
    tolerance: f64,
    /// ū, from which the scale of the motion is measured.
    equilibrium: f64,
    /// Twice the last step if that had to be shorter than its coefficients promise, as in stiff
    /// systems again and again; else no limit.
    longest: f64,
}

impl<'s, L: FrictionLaw> Stepper<'s, L> {
    pub(crate) fn new(system: MassOnBelt<&'s L>, tolerance: f64) -> Self {
        Self {
            workspace: Workspace::new(),
            series: Series::ZERO,
            breakpoints: system.law().breakpoints().collect(),
            tolerance,
            equilibrium: system.equilibrium_displacement(),
            longest: f64::INFINITY,
            system,
        }
    }

    pub(crate) fn system(&self) -> &MassOnBelt<&'s L> {
        &self.system
    }

    /// The state at a point.
    pub(crate) fn state(&self, point: &SlipPoint) -> State {
        let velocity = self.system.belt_velocity() + point.direction.sign() * point.speed;
        State::new(point.displacement, velocity)
    }

    /// One step from `point`, up to contact or to a breakpoint of the law if one of them is
    /// reached. `elapsed` is the time since the motion began, for the step's least length and for
    /// errors.
    #[inline]
    pub(crate) fn advance(
        &mut self,
        point: &SlipPoint,
        time: Time,
        elapsed: f64,
    ) -> Result<Advance, Error> {
        let state = self.state(point);
        let reached = Reached {
            time: elapsed,
            state,
        };
        let at_breakpoint;
        let (piece, point) = match self.on_piece(point, time) {
            (piece, None) => (piece, point),
            (piece, rate) => {
                at_breakpoint = SlipPoint { rate, ..*point };
                (piece, &at_breakpoint)
            }
        };
        let (law, system) = (*self.system.law(), &self.system);
        self.series
            .expand(law, system, &mut self.workspace, point, piece, time)
            .map_err(|error| error.reached_at(reached))?;
        let series = &self.series;
        let speed = &series.speed;
        if speed[1] == 0.0 && speed[2] == 0.0 {
            return Ok(Advance {
                duration: f64::INFINITY,
                end: *point,
            });
        }
        if !(speed[TERMS - 1].is_finite() && speed[TERMS - 2].is_finite()) {
            return Err(Error::StepUnderflow { step: 0.0, reached });
        }

        let v_b = self.system.belt_velocity();
        let deviation = point.displacement - self.equilibrium;
        let scale = deviation.abs().max(state.velocity.abs()).max(v_b.abs());
        let error = self.tolerance * scale;
        let floor = DEFECT_FLOOR * f64::EPSILON * series.largest_term(&self.system, state);
        let limits = self.limits(piece);
        let reach = reach(speed, error);
        let mut h = reach.min(self.longest);
        let (duration, end_speed) = loop {
            if !(h > f64::EPSILON * elapsed && h >= f64::MIN_POSITIVE) {
                return Err(self.underflow(piece, h, reached));
            }
            let speeds = evaluate_four(speed, quarters(h));
            let Ok(exit) = limits.first_exit(speed, h, speeds) else {
                h *= 0.5;
                continue;
            };
            let (end, speeds, end_speed) = match exit {
                None => (h, speeds, speeds[3]),
                Some((t, limit)) => (t, evaluate_four(speed, quarters(t)), limit),
            };
            let defect = series.defect(&self.system, piece, quarters(end), speeds);
            let closest = series.defect_at_minimum(&self.system, piece, end, speeds);
            let between = if end > LONG {
                series.defect_in_between(&self.system, piece, end)
            } else {
                0.0
            };
            let accepted = DEFECT_LIMIT * error + floor * end;
            if [defect, closest, between]
                .iter()
                .all(|d| d * end <= accepted)
            {
                break (end, end_speed);
            }
            h = 0.5 * end;
        };
        self.longest = if h < reach { 2.0 * h } else { f64::INFINITY };

        Ok(Advance {
            duration,
            end: SlipPoint {
                displacement: self.displacement(point, time, duration),
                speed: end_speed,
                rate: None,
                ..*point
            },
        })
    }

    /// Series of the sliding speed over the step taken last, in the time since its start; backward
    /// time where that was asked for.
    pub(crate) fn speed(&self) -> &Polynomial {
        &self.series.speed
    }

    /// Displacement at a time t after the start of the step taken last, from `start`.
    #[inline(always)]
    pub(crate) fn displacement(&self, start: &SlipPoint, time: Time, t: f64) -> f64 {
        let mean_speed = mean(&self.series.speed, t);
        let mean_velocity = self.system.belt_velocity() + start.direction.sign() * mean_speed;
        start.displacement + time.sign() * mean_velocity * t
    }

    /// The law's own failure if it gave no number where the motion goes, else a step too short.
    #[cold]
    fn underflow(&self, piece: usize, step: f64, reached: Reached) -> Error {
        let law = self.system.law();
        let failure = evaluate_four(&self.series.speed, quarters(2.0 * step))
            .into_iter()
            .map(|s| (s, law.kinetic_on(piece, s.max(0.0))))
            .find(|(s, value)| s.is_finite() && !value.is_finite());
        match failure {
            Some((speed, value)) => Error::NonFiniteFriction {
                speed,
                value,
                reached: Some(reached),
            },
            None => Error::StepUnderflow { step, reached },
        }
    }

    /// The piece of the law that a motion from this point goes through, and the rate that decided
    /// on it.
    #[inline(always)]
    fn on_piece(&self, point: &SlipPoint, time: Time) -> (usize, Option<f64>) {
        if self.breakpoints.is_empty() {
            (0, None)
        } else {
            self.among_pieces(point, time)
        }
    }

    /// The same for a law of several pieces. At a breakpoint the motion decides, by its rate, which
    /// is then the one that the series starts with.
    #[inline(never)]
    fn among_pieces(&self, point: &SlipPoint, time: Time) -> (usize, Option<f64>) {
        let above = self.breakpoints.partition_point(|&b| b <= point.speed);
        if above == 0 || self.breakpoints[above - 1] != point.speed {
            return (above, None);
        }
        let sigma = point.direction.sign();
        let state = self.state(point);
        let equation = || time.sign() * sigma * self.system.acceleration(state);
        let rate = point.rate.unwrap_or_else(equation);
        // Where s' = σv' is zero, s'' = −σv decides.
        let rising = rate > 0.0 || (rate == 0.0 && sigma * state.velocity < 0.0);
        (if rising { above } else { above - 1 }, Some(rate))
    }

    /// Sliding speeds at which a step on this piece must end.
    fn limits(&self, piece: usize) -> Limits {
        Limits {
            low: if piece == 0 {
                0.0
            } else {
                self.breakpoints[piece - 1]
            },
            high: self.breakpoints.get(piece).copied(),
        }
    }
}

/// When a step leaves its piece of the law, and at which sliding speed.
type Exit = Option<(f64, f64)>;

/// The sliding speeds between which one piece of the law holds.
struct Limits {
    low: f64,
    high: Option<f64>,
}

impl Limits {
    /// First time in (0, h] at which s(t) reaches a limit, and that limit; `speeds` are its values
    /// at the quarters of h.
    #[inline(always)]
    fn first_exit(&self, speed: &Polynomial, h: f64, speeds: [f64; 4]) -> Result<Exit, TooCurved> {
        if self.high.is_none() && self.low == 0.0 && speed[0] > 0.0 {
            // The usual case, kept short.
            return Ok(first_root(speed, h, speeds)?.map(|time| (time, 0.0)));
        }
        self.first_exit_from_piece(speed, h, speeds)
    }

    #[inline(never)]
    fn first_exit_from_piece(
        &self,
        speed: &Polynomial,
        h: f64,
        speeds: [f64; 4],
    ) -> Result<Exit, TooCurved> {
        let low = first_passage(speed, self.low, 1.0, h, speeds)?.map(|time| (time, self.low));
        let Some(limit) = self.high else {
            return Ok(low);
        };
        let high = first_passage(speed, limit, -1.0, h, speeds)?.map(|time| (time, limit));
        Ok(match (low, high) {
            (Some(low), Some(high)) if high.0 < low.0 => Some(high),
            (low, high) => low.or(high),
        })
    }
}

/// First root in (0, h] of sign·(s(t) − level), which is positive just after t = 0.
///
/// If the motion starts on the level, that root (double where the rate is zero) is divided out: it
/// is known, so nothing has to be skipped by a small time.
fn first_passage(
    speed: &Polynomial,
    level: f64,
    sign: f64,
    h: f64,
    speeds: [f64; 4],
) -> Result<Option<f64>, TooCurved> {
    if speed[0] == level {
        let known = if speed[1] == 0.0 { 2 } else { 1 };
        let rest = std::array::from_fn(|k| speed.get(k + known).map_or(0.0, |c| sign * c));
        first_root(&rest, h, evaluate_four(&rest, quarters(h)))
    } else {
        let mut distance = speed.map(|c| sign * c);
        distance[0] -= sign * level;
        first_root(&distance, h, speeds.map(|s| sign * (s - level)))
    }
}
