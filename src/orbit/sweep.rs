//! A sweep of a parameter up and down: each motion starts from the end of the motion before.

use super::attractor::{Attractor, settled};
use super::oscillator::{Oscillator, Systems};
use crate::error::Error;
use crate::motion::sealed::State as _;
use crate::motion::{AttractorKind, SystemState};
use crate::search::{Search, Watched};
use crate::state::structure::State;

/// Attractors as a parameter rises and falls: see [`sweep`].
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Sweep<S: SystemState> {
    /// The results as the parameter rises, by ascending values.
    pub up: Vec<SweepPoint<S>>,
    /// The results as the parameter falls, by descending values.
    pub down: Vec<SweepPoint<S>>,
    /// The value of the parameter at which the watcher stopped the sweep; `None` if the watcher did
    /// not stop it.
    pub stopped: Option<f64>,
}

/// The attractor at one value of a parameter.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct SweepPoint<S: SystemState> {
    /// The parameter, in its own units.
    pub parameter: f64,
    /// The attractor that the motion reaches, or the error. After an error the sweep continues from
    /// the last state before this error.
    pub attractor: Result<Attractor<S>, Error>,
}

/// A change of the attractor, between two values of a sweep.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Change {
    /// The values of the parameter before and after the change; in a sweep downward the larger
    /// value comes first.
    pub between: [f64; 2],
    /// The attractor before the change.
    pub from: AttractorKind,
    /// The attractor after the change.
    pub to: AttractorKind,
}

impl<S: SystemState> SweepPoint<S> {
    /// The kind of the attractor; `None` if the result is an error.
    pub fn kind(&self) -> Option<AttractorKind> {
        self.attractor.as_ref().ok().map(Attractor::kind)
    }
}

impl<S: SystemState> Sweep<S> {
    /// The changes as the parameter rises, then the changes as it falls.
    pub fn changes(&self) -> impl Iterator<Item = Change> {
        [&self.up, &self.down].into_iter().flat_map(|way| {
            let known = way
                .iter()
                .filter_map(|point| Some((point.parameter, point.kind()?)));
            let known: Vec<(f64, AttractorKind)> = known.collect();
            let pairs = known.windows(2).filter(|pair| pair[0].1 != pair[1].1);
            let changes = pairs.map(|pair| Change {
                between: [pair[0].0, pair[1].0],
                from: pair[0].1,
                to: pair[1].1,
            });
            changes.collect::<Vec<_>>()
        })
    }
}

/// The attractors that a system reaches while a parameter rises through the given values and then
/// falls through them again. `family` returns the system for a value of the parameter. Each motion
/// starts from the last state of the motion before, as in a machine that is started, loaded and
/// unloaded.
///
/// If the results of the two directions differ at a value, the system has two attractors there. The
/// past of the motion then decides which attractor it reaches (hysteresis). Do not search for a
/// critical value by bisection with simulations from one start. At the next value this start may
/// lie in the basin of another attractor, and the bisection would miss vibration that exists far
/// beyond the value that it finds. Instead, sweep, then follow the motion found to the end of its
/// branch:
///
/// ```
/// use stick_slip::orbit::{self, AttractorKind};
/// use stick_slip::{Contact, Error, Exponential, Structure, structure::State};
///
/// // A mass on a belt of rising velocity: steady sliding and stick-slip side by side.
/// let mass = |velocity: f64| -> Result<Structure, Error> {
///     let law = Exponential::new(0.6, 0.3, 0.4)?;
///     Structure::new(&[1.0])?
///         .with_ground_spring(0, 1.0)?
///         .with_ground_damper(0, 0.02)?
///         .with_contact(Contact::new(0, law, 1.0)?.on_belt(velocity))
/// };
/// let velocities: Vec<f64> = (1..=16).map(|i| 0.25 * f64::from(i)).collect();
/// let sweep = orbit::sweep(mass, &velocities, &State::at_rest(1))?;
/// let [ends, begins] = sweep.changes().collect::<Vec<_>>()[..] else { panic!() };
/// assert_eq!((ends.from, ends.to), (AttractorKind::StickSlip, AttractorKind::SteadySliding));
/// assert_eq!((begins.from, begins.to), (AttractorKind::SteadySliding, AttractorKind::StickSlip));
/// assert!(begins.between[0] < ends.between[0]); // hysteresis: it ends at a higher velocity
///
/// // The exact end of stick-slip is the grazing at which it meets an unstable motion. A sweep with
/// // too large steps loses stick-slip before this end.
/// let last = sweep.up.iter().rfind(|point| point.kind() == Some(AttractorKind::StickSlip));
/// let last = last.unwrap();
/// let orbit = last.attractor.as_ref().unwrap().orbit().unwrap();
/// let branch = orbit::follow(mass, last.parameter, orbit, 0.2..4.0)?;
/// let [grazing] = &branch.bifurcations[..] else { panic!() };
/// assert!((grazing.parameter - 3.8399).abs() < 1e-6 && grazing.parameter > ends.between[0]);
/// # Ok::<(), stick_slip::Error>(())
/// ```
///
/// If the last motion ended in steady sliding, the next motion starts with displacements that are
/// perturbed by up to 10⁻⁶ of the largest displacement, so that it can leave unstable steady
/// sliding. Each value costs one [`classify`](super::classify) in each direction. Close to a
/// bifurcation the transient may be longer than the 1.3·10⁵ steps of `classify`. The change then
/// appears at a later value.
///
/// [`Search::sweep`] sets a bound of the work, and accepts a watcher, a function that can stop the
/// search.
///
/// # Errors
///
/// [`Error::InvalidParameter`] unless there is at least one value, and the values are finite and
/// ascending; [`Error::At`], with the parameter, if a system does not accept `start`. Any other
/// error at a value, such as an error of the family, is part of the result.
#[doc(alias = "hysteresis")]
#[doc(alias = "brute force")]
pub fn sweep<S: Oscillator>(
    family: impl Fn(f64) -> Result<S, Error>,
    values: &[f64],
    start: &S::State,
) -> Result<Sweep<S::State>, Error> {
    Search::new().sweep(family, values, start)
}

impl Search<'_> {
    /// Calls the function [`sweep`] with the watcher of this search, and with its bound at each
    /// value. A sweep that is stopped keeps the results found so far.
    ///
    /// # Errors
    ///
    /// The errors of [`sweep`].
    pub fn sweep<S: Oscillator>(
        &self,
        family: impl Fn(f64) -> Result<S, Error>,
        values: &[f64],
        start: &S::State,
    ) -> Result<Sweep<S::State>, Error> {
        let (count, allowed) = (values.len(), "at least one value");
        Error::check(
            "orbit::sweep",
            "values.len()",
            count as f64,
            count > 0,
            allowed,
        )?;
        let mut last = f64::NEG_INFINITY;
        for &value in values {
            Error::check(
                "orbit::sweep",
                "value",
                value,
                value > last,
                "ascending values",
            )?;
            last = value;
        }
        let watched = self.watch("parameter");
        let mut sweep = Sweep {
            up: Vec::new(),
            down: Vec::new(),
            stopped: None,
        };
        let mut start = start.general();
        let mut is_given = true;
        let down = values.iter().rev().map(|&value| (value, false));
        for (parameter, rises) in values.iter().map(|&value| (value, true)).chain(down) {
            watched.at(parameter);
            let system = family(parameter);
            let has_system = system.is_ok();
            let found = system.and_then(|system| self.reached(&system, &start, &watched));
            if let Err(error) = &found
                && has_system
                && is_given
                && is_of_start(error)
            {
                return Err(error.clone().at("parameter", parameter));
            }
            if watched.is_stopped() {
                sweep.stopped = Some(parameter);
                break;
            }
            let attractor = found.map(|(attractor, state)| {
                start = pushed(&attractor, state);
                is_given = false;
                attractor
            });
            let way = if rises {
                &mut sweep.up
            } else {
                &mut sweep.down
            };
            way.push(SweepPoint {
                parameter,
                attractor: attractor.map_err(|error| error.at("parameter", parameter)),
            });
            watched.found(parameter);
        }
        Ok(sweep)
    }

    /// The attractors that motions reach from these values of a parameter and states, up to the
    /// value at which the watcher stops the search.
    pub(super) fn reached_from<S: Oscillator>(
        &self,
        family: &Systems<'_, S>,
        starts: &[(f64, State)],
    ) -> Vec<SweepPoint<S::State>> {
        let watched = self.watch("parameter");
        let mut points = Vec::new();
        for &(parameter, ref start) in starts {
            watched.at(parameter);
            let found = family(parameter).and_then(|system| self.reached(&system, start, &watched));
            if watched.is_stopped() {
                break;
            }
            let attractor = found.map(|(attractor, _)| attractor);
            points.push(SweepPoint {
                parameter,
                attractor: attractor.map_err(|error| error.at("parameter", parameter)),
            });
            watched.found(parameter);
        }
        points
    }

    /// The attractor that a motion of a system reaches, and a state there.
    fn reached<S: Oscillator>(
        &self,
        system: &S,
        start: &State,
        watched: &Watched<'_>,
    ) -> Result<(Attractor<S::State>, State), Error> {
        let form = system.form().within(self.steps(), watched);
        let found = settled(system, &form, start);
        watched.add(form.taken());
        found
    }
}

/// Returns true if a system has refused the start.
fn is_of_start(error: &Error) -> bool {
    matches!(
        error,
        Error::WrongSize { .. } | Error::InvalidState { .. } | Error::InvalidParameter { .. }
    )
}

/// The start at the next value.
fn pushed<S: SystemState>(attractor: &Attractor<S>, mut state: State) -> State {
    const PUSH: f64 = 1e-6;
    if let Attractor::SteadySliding = attractor {
        let sizes = state.displacements.iter().map(|q| q.abs());
        let size = sizes.fold(0.0, f64::max);
        for (i, q) in state.displacements.iter_mut().enumerate() {
            *q += PUSH * size / ((i + 1) as f64).sqrt();
        }
    }
    state
}
