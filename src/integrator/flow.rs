//! The phase machine: stick and slip in turn, step by step.

use super::Integrator;
use super::polynomial::{Polynomial, TERMS, evaluate_four, first_root, mean, quarters};
use super::series::{Series, SlipPoint};
use super::step::{Clock, Event, EventKind, Mode, Step};
use crate::friction::FrictionLaw;
use crate::scalar::Workspace;
use crate::{Direction, Error, MassOnBelt, Reached, State};

/// The motion from a start state, step by step, without an end: an iterator of [`Step`]s in constant memory.
///
/// Made by [`Integrator::flow`]. Steps follow each other without a gap. After an error comes `None`. A motion that comes to
/// rest for ever (in stick at v_b = 0, or exactly on an equilibrium) is one last step of infinite duration.
///
/// ```
/// use stick_slip::{Coulomb, Integrator, MassOnBelt, Mode, State};
///
/// // Free vibration on a belt at rest: the mass stops in the stick band.
/// let system = MassOnBelt::new(Coulomb::new(1.0, 1.0)?, 0.0)?;
/// let steps: Vec<_> = Integrator::new()
///     .flow(&system, State::new(2.5, 0.0))?
///     .collect::<Result<_, _>>()?;
/// let rest = steps.last().unwrap();
/// assert_eq!(rest.mode(), Mode::Stick);
/// assert_eq!(rest.duration(), f64::INFINITY);
/// assert!((rest.state().displacement + 0.5).abs() < 1e-15);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Flow<'s, L> {
    system: &'s MassOnBelt<L>,
    workspace: Workspace<TERMS>,
    breakpoints: Vec<f64>,
    settings: Integrator,
    clock: Clock,
    phase: Phase,
    /// ū, from which the scale of the motion is measured.
    equilibrium: f64,
    /// γ²(μ_s − μ̂(0)) ≥ 0: ds/dτ just after release.
    release_rate: f64,
    steps: usize,
    events: usize,
}

/// Where the motion stands.
#[derive(Debug, Clone, Copy)]
enum Phase {
    Stick { displacement: f64 },
    Slip { point: SlipPoint, state: State },
    Ended,
}

/// Floor of the defect that rounding alone causes, in units of ε times the largest term of the equation of motion; it is seldom above 8.
const DEFECT_FLOOR: f64 = 1000.0;

/// Defect × step accepted, in units of the error allowed in a step's last term.
const DEFECT_LIMIT: f64 = 40.0 * TERMS as f64;

/// Distance from the release point, in units of ε times the largest term of its formula, within which a start is one exactly on it.
const RELEASE_ROUNDING: f64 = 4.0;

impl<'s, L: FrictionLaw> Flow<'s, L> {
    pub(super) fn new(
        settings: Integrator,
        system: &'s MassOnBelt<L>,
        start: State,
    ) -> Result<Self, Error> {
        let v_b = system.belt_velocity();
        let relative_velocity = start.velocity - v_b;
        let force = start.displacement + 2.0 * system.damping() * start.velocity;
        if !(force.is_finite() && relative_velocity.is_finite()) {
            return Err(Error::InvalidState {
                displacement: start.displacement,
                velocity: start.velocity,
            });
        }
        let law = system.law();
        let jump = law.static_coefficient() - law.kinetic(0.0);
        let mut flow = Self {
            system,
            workspace: Workspace::new(),
            breakpoints: law.breakpoints().collect(),
            settings,
            clock: Clock::default(),
            phase: Phase::Ended,
            equilibrium: system.equilibrium_displacement(),
            release_rate: (system.load() * jump).max(0.0),
            steps: 0,
            events: 0,
        };
        let State { displacement, .. } = start;
        flow.phase = if relative_velocity != 0.0 {
            let direction = if relative_velocity < 0.0 {
                Direction::Lagging
            } else {
                Direction::Leading
            };
            let point = SlipPoint {
                direction,
                displacement,
                speed: relative_velocity.abs(),
                piece: 0,
                rate: None,
            };
            Phase::Slip {
                point,
                state: start,
            }
        } else if flow.is_release(displacement) {
            // In stick, with no time left in it: the release is reported at time 0.
            Phase::Stick { displacement }
        } else {
            match system.slides_at(displacement) {
                None => Phase::Stick { displacement },
                Some(direction) => flow.slip_from_belt(displacement, direction),
            }
        };
        Ok(flow)
    }

    /// Whether u is the release point, as far as its formula can be rounded differently.
    fn is_release(&self, displacement: f64) -> bool {
        self.system.release_state().is_some_and(|release| {
            let force = self.system.load() * self.system.law().static_coefficient();
            let largest = force
                .max(release.displacement.abs())
                .max(displacement.abs());
            (displacement - release.displacement).abs() <= RELEASE_ROUNDING * f64::EPSILON * largest
        })
    }

    /// The start of a slip phase, with v = v_b.
    fn slip_from_belt(&self, displacement: f64, direction: Direction) -> Phase {
        // ds/dτ = |F| − γ²μ̂(0), from the same limits that every decision uses, so that it is exactly 0 at the release point
        // of a law with μ̂(0) = μ_s.
        let [low, high] = self.system.stick_limits();
        let beyond = match direction {
            _ if self.is_release(displacement) => 0.0,
            Direction::Lagging => displacement - high,
            Direction::Leading => low - displacement,
        };
        let point = SlipPoint {
            direction,
            displacement,
            speed: 0.0,
            piece: 0,
            rate: Some(beyond.max(0.0) + self.release_rate),
        };
        let state = State::new(displacement, self.system.belt_velocity());
        Phase::Slip { point, state }
    }

    fn reached(&self, state: State) -> Reached {
        Reached {
            time: self.clock.time,
            state,
        }
    }

    /// A stick phase: u grows at the rate v_b up to the release point.
    fn stick(&mut self, displacement: f64) -> Step {
        let v_b = self.system.belt_velocity();
        let state = State::new(displacement, v_b);
        let (duration, released) = match self.system.release_state() {
            None => (f64::INFINITY, state),
            Some(_) if self.is_release(displacement) => (0.0, state),
            Some(release) => ((release.displacement - displacement) / v_b, release),
        };
        let event = if duration.is_finite() {
            let direction = if v_b > 0.0 {
                Direction::Lagging
            } else {
                Direction::Leading
            };
            self.phase = self.slip_from_belt(released.displacement, direction);
            Some((EventKind::Release(direction), released))
        } else {
            self.phase = Phase::Ended;
            None
        };
        self.step(Mode::Stick, state, Step::AT_REST_ON_BELT, duration, event)
    }

    /// One Taylor step of a slip phase, up to contact or to a breakpoint of the law if one of them is reached.
    fn slip(&mut self, point: SlipPoint, state: State) -> Result<Step, Error> {
        let reached = self.reached(state);
        let point = SlipPoint {
            piece: self.piece(&point),
            ..point
        };
        let series = Series::new(self.system, &mut self.workspace, &point)
            .map_err(|error| error.reached_at(reached))?;
        let speed = series.speed;
        let mode = Mode::Slip(point.direction);
        if speed[1] == 0.0 && speed[2] == 0.0 {
            self.phase = Phase::Ended;
            return Ok(self.step(mode, state, speed, f64::INFINITY, None));
        }

        let v_b = self.system.belt_velocity();
        let deviation = point.displacement - self.equilibrium;
        let scale = deviation.abs().max(state.velocity.abs()).max(v_b.abs());
        let error = self.settings.tolerance * scale;
        let limits = self.limits(point.piece);
        let mut h = series.reach(error);
        let accepted = loop {
            if !(h > f64::EPSILON * self.clock.time && h >= f64::MIN_POSITIVE) {
                return Err(Error::StepUnderflow { step: h, reached });
            }
            let speeds = evaluate_four(&speed, quarters(h));
            let exit = limits.first_exit(&speed, h, speeds);
            let (end, speeds) = match exit {
                None => (h, speeds),
                Some((time, _)) => (time, evaluate_four(&speed, quarters(time))),
            };
            let defect = series.defect(self.system, point.piece, end, speeds);
            let floor = series.largest_term(self.system, state) * DEFECT_FLOOR * f64::EPSILON;
            if defect * end <= DEFECT_LIMIT * error + floor * end {
                break (end, exit, speeds[3]);
            }
            h = 0.5 * end;
        };

        let (duration, exit, end_speed) = accepted;
        let sigma = point.direction.sign();
        let displacement = point.displacement + (v_b + sigma * mean(&speed, duration)) * duration;
        let on_belt = State::new(displacement, v_b);
        let event = match exit {
            Some((_, 0.0)) => match self.system.slides_at(displacement) {
                None => {
                    self.phase = Phase::Stick { displacement };
                    Some((EventKind::Stick, on_belt))
                }
                Some(direction) => {
                    self.phase = self.slip_from_belt(displacement, direction);
                    (direction != point.direction)
                        .then_some((EventKind::Crossing(direction), on_belt))
                }
            },
            _ => {
                let speed = exit.map_or(end_speed, |(_, level)| level);
                self.phase = Phase::Slip {
                    point: SlipPoint {
                        displacement,
                        speed,
                        rate: None,
                        ..point
                    },
                    state: State::new(displacement, v_b + sigma * speed),
                };
                None
            }
        };
        Ok(self.step(mode, state, speed, duration, event))
    }

    /// The piece of the law that a motion from this point goes through; at a breakpoint the motion decides.
    fn piece(&self, point: &SlipPoint) -> usize {
        let above = self.breakpoints.partition_point(|&b| b <= point.speed);
        if above == 0 || self.breakpoints[above - 1] != point.speed {
            return above;
        }
        let sigma = point.direction.sign();
        let velocity = self.system.belt_velocity() + sigma * point.speed;
        let acceleration = self
            .system
            .acceleration(State::new(point.displacement, velocity));
        // s' = σv', and where that is zero s'' = −σv.
        let rising = sigma * acceleration > 0.0 || (acceleration == 0.0 && sigma * velocity < 0.0);
        if rising { above } else { above - 1 }
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

    fn step(
        &mut self,
        mode: Mode,
        state: State,
        speed: Polynomial,
        duration: f64,
        event: Option<(EventKind, State)>,
    ) -> Step {
        let start = self.clock;
        self.clock = start.after(duration);
        Step {
            start,
            duration,
            mode,
            state,
            speed,
            event: event.map(|(kind, state)| Event {
                time: self.clock.time,
                kind,
                state,
            }),
            belt_velocity: self.system.belt_velocity(),
        }
    }
}

/// The sliding speeds between which one piece of the law holds.
struct Limits {
    low: f64,
    high: Option<f64>,
}

impl Limits {
    /// First time in (0, h] at which s(t) reaches a limit, and that limit; `speeds` are its values at the quarters of h.
    #[inline(always)]
    fn first_exit(&self, speed: &Polynomial, h: f64, speeds: [f64; 4]) -> Option<(f64, f64)> {
        let low = first_passage(speed, self.low, 1.0, h, speeds).map(|time| (time, self.low));
        let Some(limit) = self.high else {
            return low;
        };
        let high = first_passage(speed, limit, -1.0, h, speeds).map(|time| (time, limit));
        match (low, high) {
            (Some(low), Some(high)) if high.0 < low.0 => Some(high),
            (low, high) => low.or(high),
        }
    }
}

/// First root in (0, h] of sign·(s(t) − level), which is positive just after t = 0.
///
/// If the motion starts on the level, that root (double where the rate is zero) is divided out: it is known, so nothing has to be
/// skipped by a small time.
#[inline(always)]
fn first_passage(
    speed: &Polynomial,
    level: f64,
    sign: f64,
    h: f64,
    speeds: [f64; 4],
) -> Option<f64> {
    if speed[0] == level {
        let known = if speed[1] == 0.0 { 2 } else { 1 };
        let rest = std::array::from_fn(|k| speed.get(k + known).map_or(0.0, |c| sign * c));
        first_root(&rest, h, evaluate_four(&rest, quarters(h)))
    } else if level == 0.0 {
        first_root(speed, h, speeds)
    } else {
        let mut distance = speed.map(|c| sign * c);
        distance[0] -= sign * level;
        first_root(&distance, h, speeds.map(|s| sign * (s - level)))
    }
}

impl<L: FrictionLaw> Iterator for Flow<'_, L> {
    type Item = Result<Step, Error>;

    fn next(&mut self) -> Option<Self::Item> {
        let phase = std::mem::replace(&mut self.phase, Phase::Ended);
        let step = match phase {
            Phase::Ended => return None,
            Phase::Stick { displacement } => Ok(self.stick(displacement)),
            Phase::Slip { point, state } => self.slip(point, state),
        };
        Some(step)
    }
}
