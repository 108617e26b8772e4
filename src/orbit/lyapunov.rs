//! The largest Lyapunov exponent: the mean growth rate of a small perturbation of a motion.

use nalgebra::{DMatrix, DVector};

use super::attractor::fastest_surface;
use super::oscillator::Oscillator;
use super::period_map::{enlarge, sizes, vector};
use super::tangent::{TangentFlow, flow_of};
use super::type_erased_system::GeneralForm;
use crate::error::{Error, Reached};
use crate::motion::sealed::State as _;
use crate::motion::{Integrator, Segment};
use crate::search::Search;
use crate::state::structure::State;
use crate::structure::Step;

/// A Lyapunov exponent with its standard error; returned by [`lyapunov_with_spread`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct LyapunovExponent {
    /// The exponent, per unit of time.
    pub value: f64,
    /// The standard error of the exponent, per unit of time, from the differences between 16 parts
    /// of the duration. It is 0 if the exponent is −∞. It is infinite if one integration step
    /// covers the whole duration.
    pub spread: f64,
}

/// Number of parts of the duration whose growth rates are compared.
const PARTS: usize = 16;

/// The rest of a perturbation after the part along the motion is removed is rounding if it is below
/// this part of the perturbation.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// A motion rests, and a shift along it grows or decays like any perturbation, while no velocity
/// is above this part of the largest so far. If the motion goes on, nothing is lost: the part along
/// it is removed later.
const AT_REST: f64 = 1e-8;

/// Growth of a perturbation over a part of the duration.
#[derive(Debug, Clone, Copy, Default)]
struct Growth {
    /// Logarithm of the factor; −∞ for a perturbation that has decayed to zero.
    logarithm: f64,
    time: f64,
}

/// The largest Lyapunov exponent of the motion from a start, per unit of time: the value of
/// [`lyapunov_with_spread`], without its standard error.
///
/// # Errors
///
/// The errors of [`lyapunov_with_spread`].
///
/// ```
/// use stick_slip::{MassOnBelt, Polynomial, orbit};
///
/// // Stick-slip: a stick phase removes every perturbation.
/// let system = MassOnBelt::new(Polynomial::new(0.4, 0.25, 0.5)?, 0.2)?.with_damping(0.05)?;
/// let exponent = orbit::lyapunov(&system, &(0.0, 0.0).into(), 0.0, 100.0)?;
/// assert_eq!(exponent, f64::NEG_INFINITY);
/// # Ok::<(), stick_slip::Error>(())
/// ```
pub fn lyapunov<S: Oscillator>(
    system: &S,
    start: &S::State,
    transient: f64,
    duration: f64,
) -> Result<f64, Error> {
    Ok(lyapunov_with_spread(system, start, transient, duration)?.value)
}

/// The largest Lyapunov exponent of the motion from a start at time 0, with its standard error. The
/// exponent λ is the mean growth rate, per unit of time, of a small perturbation δx of the state.
/// The mean is taken over a duration after a transient.
///
/// ```text
/// λ = lim ln(|δx(t)|/|δx(0)|)/t  for t → ∞
/// ```
///
/// A positive exponent means chaos. For a stable periodic motion the exponent is ln|μ|/T, with the
/// period T and the multiplier μ of largest modulus. Two kinds of perturbations neither grow nor
/// decay, and are left out: a shift along the orbit of an autonomous motion, and a
/// [translation](super#motions-that-are-translated). If the motion settles to rest or steady
/// sliding, a shift along it decays, too, and the exponent is the largest real part of the
/// eigenvalues there. The exponent is −∞ if all other perturbations
/// become exactly zero after a finite time. (The stick phases of one mass on a belt have this
/// effect; μ is then 0.) It is 0 if all masses stick for ever to surfaces at rest, because a
/// perturbation of a displacement then remains. The perturbation δx is a solution of the
/// variational equations, not a difference of motions, so no digits cancel. In |δx| each number is
/// in units of its largest size so far, so that the units of the system do not matter. The memory
/// needed does not grow with the duration.
///
/// The cost is proportional to the duration. The standard error falls at least as fast as
/// 1/√duration. Three masses with natural frequencies of order 1 take about 0.15 ms for each unit
/// of time, so 10 000 units take 1.5 s. A run up to the bound of 10⁶ steps takes 10 to 20 s for
/// three masses, and covers about 10⁵ units of time; [`Search::with_max_steps`] changes this bound.
///
/// # Errors
///
/// * [`Error::InvalidDuration`] unless both times are finite, the transient is ≥ 0 and the duration
///   is > 0;
/// * [`Error::InvalidParameter`] if the duration is so short that transient + duration is rounded
///   to the transient;
/// * [`Error::TooManySteps`], with the time and state reached, after 10⁶ steps (10⁴ to 10⁵
///   oscillations);
/// * the other errors of [`Integrator::simulate`].
///
/// Source: G. Benettin, L. Galgani, A. Giorgilli, J.-M. Strelcyn, *Meccanica* 15 (1980) 9-30; for
/// events, P. C. Müller, *Chaos, Solitons & Fractals* 5 (1995) 1671-1681.
///
/// ```
/// use stick_slip::orbit;
/// use stick_slip::structure::State;
/// use stick_slip::{Contact, Drive, Rational, Structure};
///
/// // A forced mass on a belt, friction that falls and rises again (K. Popp, P. Stelter, 1990).
/// let law = Rational::new(0.3, 1.42)?.with_offset(0.1)?.with_quadratic(0.01)?;
/// let forced = Structure::new(&[1.0])?
///     .with_ground_spring(0, 1.0)?
///     .with_force(0, Drive::harmonic(0.1, 0.75, 0.0)?)?
///     .with_contact(Contact::new(0, law, 1.0)?.on_belt(0.2))?;
/// let found = orbit::lyapunov_with_spread(&forced, &State::at_rest(1), 200.0, 2000.0)?;
/// assert!((found.value - 0.035).abs() < 0.01 && found.spread < 0.004);
/// # Ok::<(), stick_slip::Error>(())
/// ```
pub fn lyapunov_with_spread<S: Oscillator>(
    system: &S,
    start: &S::State,
    transient: f64,
    duration: f64,
) -> Result<LyapunovExponent, Error> {
    Search::new().lyapunov_with_spread(system, start, transient, duration)
}

impl Search<'_> {
    /// Calls the function [`lyapunov_with_spread`] with the bound and the watcher of this search.
    ///
    /// # Errors
    ///
    /// The errors of [`lyapunov_with_spread`]; [`Error::Stopped`] if the watcher stops the search.
    pub fn lyapunov_with_spread<S: Oscillator>(
        &self,
        system: &S,
        start: &S::State,
        transient: f64,
        duration: f64,
    ) -> Result<LyapunovExponent, Error> {
        let watched = self.watch("time");
        let form = system.form().within(self.steps(), &watched);
        exponent(&form, &start.general(), transient, duration)
    }
}

fn exponent(
    form: &GeneralForm<'_>,
    start: &State,
    transient: f64,
    duration: f64,
) -> Result<LyapunovExponent, Error> {
    Error::check_duration(transient)?;
    if !(duration > 0.0 && (transient + duration).is_finite()) {
        return Err(Error::InvalidDuration { value: duration });
    }
    let is_resolved = transient + duration > transient;
    let allowed = "transient + duration > transient, in double precision";
    Error::check(
        "orbit::lyapunov",
        "duration",
        duration,
        is_resolved,
        allowed,
    )?;
    let parts = growths(form, start, transient, duration)?;
    let parts: Vec<Growth> = parts.into_iter().filter(|part| part.time > 0.0).collect();
    let sum = |of: fn(&Growth) -> f64| parts.iter().map(of).sum::<f64>();
    let time = sum(|part| part.time);
    let value = sum(|part| part.logarithm) / time;
    if value == f64::NEG_INFINITY {
        return Ok(LyapunovExponent { value, spread: 0.0 });
    }
    let deviations = parts.iter().map(|part| {
        let deviation = part.logarithm / part.time - value;
        deviation * deviation * part.time / time
    });
    let variance: f64 = deviations.sum();
    let spread = match parts.len() {
        0 | 1 => f64::INFINITY,
        count => (variance / (count - 1) as f64).sqrt(),
    };
    Ok(LyapunovExponent { value, spread })
}

/// The growth of a perturbation in parts of the duration after a transient.
fn growths(
    form: &GeneralForm<'_>,
    start: &State,
    transient: f64,
    duration: f64,
) -> Result<Vec<Growth>, Error> {
    let (n, order, is_free) = (form.len(), form.order(), form.is_free());
    let mut norm = Norm::new(form, start);
    // Any change will do that is not special. Memories take theirs from the motion, so that those
    // on which nothing depends have none.
    let change = |i: usize, _| {
        if i < 2 * n {
            ((i + 1) as f64).sqrt() * norm.sizes[i]
        } else {
            0.0
        }
    };
    let tangents = DMatrix::from_fn(order, 1, change);
    let mut flow = TangentFlow::new(form, Integrator::new(), (0.0, start), &[], tangents)?;
    flow.logarithm = Some(0.0);
    let mut parts = GrowthParts {
        growths: [Growth::default(); PARTS],
        transient,
        duration,
        since: 0.0,
    };
    let largest = |velocities: &[f64]| velocities.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
    let mut fastest = fastest_surface(form);
    while let Some(step) = flow.fetch(f64::INFINITY) {
        let step = step?;
        let begins = step.start_time();
        if step.duration() == 0.0 {
            flow.carry(&step)?;
            continue;
        }
        let mut along = flow_of(&step, n);
        form.untranslated(along.as_mut_slice());
        fastest = fastest.max(largest(&step.state().velocities));
        let moves = largest(&along.as_slice()[..n]) > AT_REST * fastest;
        let along = (is_free && moves).then_some(along.as_slice());
        let alive = parts.add(begins, normalise(form, &mut norm, &mut flow, along, &step)?);
        if !alive {
            return Ok(GrowthParts::gone(duration));
        }
        if begins >= parts.end() {
            break;
        }
        if step.duration() < f64::INFINITY {
            flow.carry(&step)?;
            continue;
        }
        // Nothing changes any more: any stretch of the step is like its first.
        let mut time = begins;
        for i in 0..=PARTS {
            let next = transient + duration * (i as f64 / PARTS as f64);
            if next <= time {
                continue;
            }
            flow.carry(&step.clone().until(begins + (next - time)))?;
            time = next;
            if !parts.add(time, normalise(form, &mut norm, &mut flow, along, &step)?) {
                return Ok(GrowthParts::gone(duration));
            }
        }
        break;
    }
    Ok(parts.growths.to_vec())
}

/// The growth so far.
struct GrowthParts {
    growths: [Growth; PARTS],
    transient: f64,
    duration: f64,
    /// The time at which the perturbation was measured last.
    since: f64,
}

impl GrowthParts {
    /// Growth rate of a perturbation that has decayed to zero: −∞.
    fn gone(duration: f64) -> Vec<Growth> {
        vec![Growth {
            logarithm: f64::NEG_INFINITY,
            time: duration,
        }]
    }

    fn end(&self) -> f64 {
        self.transient + self.duration
    }

    /// Adds the growth up to a time; returns true if the perturbation has not decayed to zero. If a
    /// step begins before the duration, or ends after it, only its part inside counts.
    fn add(&mut self, time: f64, logarithm: f64) -> bool {
        let since = std::mem::replace(&mut self.since, time);
        let (from, to) = (since.max(self.transient), time.min(self.end()));
        if from < to {
            let place = (0.5 * (from + to) - self.transient) / self.duration;
            let index = ((place * PARTS as f64) as usize).min(PARTS - 1);
            self.growths[index].logarithm += logarithm * ((to - from) / (time - since));
            self.growths[index].time += to - from;
        }
        logarithm > f64::NEG_INFINITY
    }
}

/// The size of perturbations, each number in units of its [size](sizes) in the motion up to the end
/// of the step, so that it does not depend on the units of the system.
struct Norm {
    memory_units: Vec<f64>,
    largest: DVector<f64>,
    sizes: DVector<f64>,
}

impl Norm {
    fn new(form: &GeneralForm<'_>, start: &State) -> Self {
        let mut norm = Self {
            memory_units: form.memory_units(),
            largest: DVector::zeros(form.order()),
            sizes: DVector::zeros(0),
        };
        norm.include(form, start);
        norm
    }

    /// Includes a state of the motion.
    fn include(&mut self, form: &GeneralForm<'_>, state: &State) {
        enlarge(&mut self.largest, &vector(state, form.order()));
        let (largest, time) = (self.largest.clone(), form.model.time_unit);
        self.sizes = sizes(largest, form.len(), time, &self.memory_units);
    }

    fn of(&self, x: &[f64]) -> f64 {
        let parts = std::iter::zip(x, &self.sizes);
        parts.fold(0.0, |norm: f64, (x, size)| norm.hypot(x / size))
    }

    /// Removes the part along a vector.
    fn remove(&self, along: &[f64], x: &mut [f64]) {
        let length = self.of(along);
        let rows = std::iter::zip(along, &*x).zip(&self.sizes);
        let part: f64 = rows
            .map(|((f, x), size)| f / size / length * (x / size))
            .sum();
        for (f, x) in std::iter::zip(along, x) {
            *x -= part * (f / length);
        }
    }
}

/// Scales the perturbation to size 1, and returns the logarithm of the factor by which it has
/// grown since it was scaled last, in the same units. The part along the translations that no force
/// depends on is removed first, and so is the part along an autonomous motion: they neither grow
/// nor decay.
fn normalise(
    form: &GeneralForm<'_>,
    norm: &mut Norm,
    flow: &mut TangentFlow<'_>,
    along: Option<&[f64]>,
    step: &Step,
) -> Result<f64, Error> {
    let before = flow.logarithm.replace(0.0).unwrap_or(0.0);
    let change = flow.tangents.as_mut_slice();
    let whole = norm.of(change);
    form.untranslated(change);
    if let Some(along) = along {
        norm.remove(along, change);
    }
    let left = norm.of(change);
    if !left.is_finite() {
        return Err(Error::StepUnderflow {
            step: 0.0,
            reached: Reached::new(step.start_time(), step.state().clone()),
        });
    }
    if left <= ROUNDING * whole {
        return Ok(f64::NEG_INFINITY);
    }
    if step.duration() < f64::INFINITY {
        norm.include(form, &step.end_state());
    }
    let unit = norm.of(change);
    change.iter_mut().for_each(|x| *x /= unit);
    Ok(left.ln() + before)
}
