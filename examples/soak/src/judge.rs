//! The accuracy of a motion, from two integrations with different steps.
//!
//! Two integrations of one motion differ by the errors of both. The difference is measured in u, v
//! and the times of events, not in a scale of the integrator. It is an error of the integrator
//! unless the motion itself magnifies rounding errors as much. To find this out, each rounded
//! number is changed by a few ulps in both directions, and the rest of the motion is followed
//! again. The rounded numbers are
//!
//! * the data: load, damping and duration;
//! * the state at the start of each step of both motions, the first one included, which stands in
//!   two rounded numbers u and v (in stick and on the belt in one, because there v is v_b).
//!
//! A backward stable integration ends within the sum of these effects. It is large where motions
//! are chaotic or leave an unstable slow motion; where the forces are far above what moves (u is
//! rounded by ε γ²μ_s, and at v_b ≪ γ²μ_s, or for a start an ulp beside the stick band, that is all
//! of the motion); and at grazing, where an ulp decides which events happen.
//!
//! An event happens where s or u reaches a bound, so its time is as exact as they are: a difference
//! Δt counts as the Δs = s'Δt and Δu = vΔt that it stands for.

use stick_slip::{AnyLaw, Error, EventKind, Integrator, MassOnBelt, Mode, State, Step};

use crate::energy::{Balance, Rule};

/// Steps after which an integration is given up.
pub(crate) const MOST_STEPS: usize = 10_000;

/// Distance between two integrations of one motion, in parts of themselves, that is worth a look.
pub(crate) const APART: f64 = 1e-9;

/// Rounding errors at each of the numbers that are rounded, in ulps.
const ROUNDINGS: usize = 16;

/// A change of velocity that is no more than its rounding.
const FEW: f64 = 16.0 * f64::EPSILON;

/// What explains that two integrations of one motion differ.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Verdict {
    /// They do not.
    Agree,
    /// The rounding of the data moves the end, or an event, as far.
    Data,
    /// So does that of the states on the way.
    Way,
    /// It decides which events happen.
    Grazing,
    /// Nothing does: the integrator is wrong.
    Wrong,
}

impl std::fmt::Display for Verdict {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(match self {
            Self::Agree => "they agree",
            Self::Data => "the rounding of load, damping or duration",
            Self::Way => "the rounding of the states on the way",
            Self::Grazing => "grazing, where rounding decides which events happen",
            Self::Wrong => "NOTHING: wrong",
        })
    }
}

/// How good a result is.
pub(crate) struct Judged {
    /// Energy defect, in roundings.
    pub(crate) defect: f64,
    /// Distance from a second integration.
    pub(crate) apart: Apart,
    pub(crate) verdict: Verdict,
}

/// How far two motions are apart, in parts of themselves.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Apart {
    /// The distance of the last states: |Δu|/max(|u|, |v|, |v_b|) or |Δv|/max(|v|, |v_b|).
    pub(crate) state: f64,
    /// That of the states that the events' times stand for; infinite if other events happen.
    pub(crate) time: f64,
}

impl Apart {
    fn is_seen(self) -> bool {
        // A NaN is.
        !(self.state <= APART && self.time <= APART)
    }

    /// Whether roundings that move the motion by so much explain it.
    fn is_explained_by(self, moved: Self) -> bool {
        let is = |apart: f64, moved: f64| apart <= APART || apart <= moved;
        is(self.state, moved.state) && is(self.time, moved.time)
    }

    fn plus(self, other: Self) -> Self {
        Self {
            state: self.state + other.state,
            time: self.time + other.time,
        }
    }

    fn max(self, other: Self) -> Self {
        Self {
            state: self.state.max(other.state),
            time: self.time.max(other.time),
        }
    }
}

/// An event, and how fast the state changes there, in parts of the largest since the last event.
struct Seen {
    time: f64,
    kind: EventKind,
    rate: f64,
}

/// A motion from a time on.
struct Motion {
    end: State,
    events: Vec<Seen>,
    /// When each step starts, in which state, and in stick or not.
    starts: Vec<(f64, State, Mode)>,
}

impl Motion {
    /// Follows a motion from a state at the time `from` up to the time `to`.
    fn follow(
        integrator: Integrator,
        system: &MassOnBelt<AnyLaw>,
        start: State,
        [from, to]: [f64; 2],
        mut visit: impl FnMut(&Step, f64, State),
    ) -> Result<Self, Error> {
        let mut motion = Self {
            end: start,
            events: Vec::new(),
            starts: Vec::new(),
        };
        let left = to - from;
        let mut largest = Largest::default();
        for step in integrator.flow(system, start)? {
            let step = step?;
            let h = step.duration().min(left - step.start_time());
            motion.end = step.state_at(h);
            visit(&step, h, motion.end);
            largest.add(step.state());
            largest.add(step.state_at(0.5 * h));
            let start = (from + step.start_time(), step.state(), step.mode());
            motion.starts.push(start);
            let is_last = step.end_time() >= left;
            if let Some(event) = step.event()
                && event.time <= left
            {
                motion.events.push(Seen {
                    time: from + event.time,
                    kind: event.kind,
                    rate: largest.rate_at_end(&step),
                });
                largest = Largest::default();
            }
            if is_last {
                break;
            }
        }
        Ok(motion)
    }

    /// How far another motion, which begins at the time `from`, is from this one.
    fn apart(&self, other: &Self, from: f64, v_b: f64) -> Apart {
        let (a, b) = (self.end, other.end);
        let speed = a.velocity.abs().max(b.velocity.abs()).max(v_b.abs());
        let size = a.displacement.abs().max(b.displacement.abs()).max(speed);
        // 0/0 is no difference.
        let part = |difference: f64, size: f64| match difference.abs() {
            0.0 => 0.0,
            difference => difference / size,
        };
        let u = part(a.displacement - b.displacement, size);
        let v = part(a.velocity - b.velocity, speed);
        let earlier = self.events.iter().filter(|event| event.time < from).count();
        let events = &self.events[earlier.min(self.events.len())..];
        let pairs = std::iter::zip(events, &other.events);
        let time = pairs.map(|(a, b)| match a.kind == b.kind {
            true if a.time == b.time => 0.0,
            true => (a.time - b.time).abs() * a.rate.max(b.rate),
            false => f64::INFINITY,
        });
        let time = time.fold(0.0, f64::max);
        Apart {
            // A NaN counts as more than anything.
            state: if u.is_nan() || v.is_nan() {
                f64::INFINITY
            } else {
                u.max(v)
            },
            time: if events.len() == other.events.len() {
                time
            } else {
                f64::INFINITY
            },
        }
    }
}

/// The largest |u| and |v| since an event.
#[derive(Default)]
struct Largest {
    size: f64,
    speed: f64,
}

impl Largest {
    fn add(&mut self, state: State) {
        self.speed = self.speed.max(state.velocity.abs());
        self.size = self.size.max(state.displacement.abs()).max(self.speed);
    }

    /// The rate at which v or u changes at the end of a step, in parts of these.
    fn rate_at_end(&self, step: &Step) -> f64 {
        let h = step.duration();
        let [before, to] = [0.99 * h, h].map(|t| step.state_at(t));
        let force = (to.velocity - before.velocity).abs() / (0.01 * h);
        // 0/0 where nothing changes.
        let rates = [force / self.speed, to.velocity.abs() / self.size];
        rates.into_iter().fold(0.0, f64::max)
    }
}

/// Follows a motion twice and judges it.
pub(crate) fn judge(
    rule: &Rule,
    system: &MassOnBelt<AnyLaw>,
    start: State,
    duration: f64,
) -> Result<Judged, Error> {
    let integrator = Integrator::new().with_max_steps(MOST_STEPS)?;
    let mut balance = Balance::new(system, rule);
    let span = [0.0, duration];
    let motion = Motion::follow(integrator, system, start, span, |step, h, last| {
        balance.add(step, h, last);
    })?;
    let (from, second) = second(system, start, duration)?;
    let apart = motion.apart(&second, from, system.belt_velocity());
    Ok(Judged {
        defect: balance.defect(start, motion.end),
        apart,
        verdict: if apart.is_seen() {
            let trial = Trial {
                integrator,
                system,
                duration,
            };
            trial.verdict(apart, start, &motion, &second)
        } else {
            Verdict::Agree
        },
    })
}

/// The same motion from inside its first step on, with half the tolerance, so that all its steps
/// start elsewhere, and the time from which on it is followed.
fn second(
    system: &MassOnBelt<AnyLaw>,
    start: State,
    duration: f64,
) -> Result<(f64, Motion), Error> {
    let integrator = Integrator::new()
        .with_tolerance(0.5 * Integrator::ROUND_OFF)?
        .with_max_steps(MOST_STEPS)?;
    let (mut from, mut within) = (0.0, start);
    for step in integrator.flow(system, start)? {
        let step = step?;
        let left = duration - step.start_time();
        let part = 0.5 * step.duration().min(left);
        let moved = (step.state_at(part).velocity - step.state().velocity).abs();
        // Not a release at the start, nor the way back to the belt from an ulp beside it.
        let is_step = match step.mode() {
            Mode::Stick => part > 0.0,
            _ => moved > f64::MIN_POSITIVE + FEW * step.state().velocity.abs(),
        };
        if is_step || step.duration() >= left {
            (from, within) = (step.start_time() + part, step.state_at(part));
            break;
        }
    }
    let motion = Motion::follow(integrator, system, within, [from, duration], |_, _, _| ())?;
    Ok((from, motion))
}

/// Tries what rounding does to a motion.
struct Trial<'s> {
    integrator: Integrator,
    system: &'s MassOnBelt<AnyLaw>,
    duration: f64,
}

impl Trial<'_> {
    fn verdict(&self, apart: Apart, start: State, motion: &Motion, second: &Motion) -> Verdict {
        let mut moved = self.by_data(start, motion);
        let mut verdict = Verdict::Data;
        let mut ways = motion.starts.iter().chain(&second.starts);
        while !apart.is_explained_by(moved) {
            let Some(state) = ways.next() else {
                return Verdict::Wrong;
            };
            verdict = Verdict::Way;
            moved = moved.plus(self.by_state(*state));
        }
        if apart.time == f64::INFINITY {
            Verdict::Grazing
        } else {
            verdict
        }
    }

    /// The distance by which the rounding of load, damping and duration moves a motion.
    fn by_data(&self, start: State, motion: &Motion) -> Apart {
        let system = |load, damping| self.system.clone().with_load(load)?.with_damping(damping);
        let (load, damping) = (self.system.load(), self.system.damping());
        let others = [
            beside(load).map(|load| (system(load, damping), self.duration)),
            beside(damping).map(|damping| (system(load, damping.abs()), self.duration)),
            beside(self.duration).map(|duration| (Ok(self.system.clone()), duration)),
        ];
        most(others, |(system, duration)| {
            let other = self.follow(&system.ok()?, start, [0.0, duration])?;
            Some(motion.apart(&other, 0.0, self.system.belt_velocity()))
        })
    }

    /// The distance by which that of the state at the start of a step does.
    ///
    /// Both motions are followed from there: what the integrator itself gets wrong is in both.
    fn by_state(&self, (from, state, mode): (f64, State, Mode)) -> Apart {
        let State {
            displacement: u,
            velocity: v,
        } = state;
        let span = [from, self.duration];
        let Some(motion) = self.follow(self.system, state, span) else {
            return Apart::default();
        };
        let v_b = self.system.belt_velocity();
        let on_belt = mode == Mode::Stick || v == v_b;
        let speeds = if on_belt { [v; 2] } else { beside(v) };
        let others = [
            beside(u).map(|u| State::new(u, v)),
            speeds.map(|v| State::new(u, v)),
        ];
        most(others, |other| {
            let other = self.follow(self.system, other, span)?;
            Some(motion.apart(&other, from, v_b))
        })
    }

    fn follow(&self, system: &MassOnBelt<AnyLaw>, start: State, span: [f64; 2]) -> Option<Motion> {
        Motion::follow(self.integrator, system, start, span, |_, _, _| ()).ok()
    }
}

/// The sum of what each of some numbers moves, in the direction in which that is more.
fn most<T, const N: usize>(others: [[T; 2]; N], moved: impl Fn(T) -> Option<Apart>) -> Apart {
    let each = others.map(|pair| {
        let [below, above] = pair.map(|other| moved(other).unwrap_or_default());
        below.max(above)
    });
    each.into_iter().fold(Apart::default(), Apart::plus)
}

/// The numbers [`ROUNDINGS`] ulps below and above.
fn beside(x: f64) -> [f64; 2] {
    [f64::next_down, f64::next_up].map(|next| (0..ROUNDINGS).fold(x, |x, _| next(x)))
}
