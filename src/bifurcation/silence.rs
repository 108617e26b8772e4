use super::along::{Along, RangeSearch, Visit, Work};
use crate::belt::{Belt, MassOnBelt};
use crate::error::Error;
use crate::friction::{FrictionLaw, Scaled};
use crate::limit_cycle::{Tracer, find_moving, is_frictionless};
use crate::numerics::bracket::Bracket;
use crate::search::Search;

/// The least damping ratio β, dimensionless, at which no vibration lasts at the system's belt
/// velocity. With this damping or more, steady sliding is stable, and there is no periodic motion.
/// (Exception: if the result is 0 and friction is constant near the sliding speed |v_b| of steady
/// sliding, small vibrations last at β = 0 itself.) With less damping, a periodic motion exists or
/// steady sliding is unstable. The system's own β is ignored. The result is 0 if the belt velocity
/// v_b is 0.
///
/// If the kinetic coefficient μ̂(s) is negative at no sliding speed s, a single border separates
/// the dampings with vibration from those without. The reason: less damping rotates the vector
/// field outwards at every state with v ≠ 0. Consider a cycle at one value of β, a closed curve in
/// the phase plane. With less damping, a motion that starts outside this curve stays outside and
/// never reaches steady sliding. A system that can vibrate at one β can therefore vibrate at every
/// smaller β.
///
/// One of three changes happens at the border: steady sliding becomes stable (β =
/// −½γ²dμ̂/ds(|v_b|), with the friction load γ²), the last two cycles meet and vanish, or the
/// stick-slip cycle grazes the belt velocity. The function encloses the border by doubling β, and
/// narrows the enclosure to neighbouring numbers. [`find`](crate::limit_cycle::find) decides
/// whether a system vibrates. If `find` misses a vibration, the result can be too small. If it
/// leaves a range [unresolved](crate::limit_cycle::CycleSet::unresolved), the system counts as
/// vibrating. On very slow belts and near steady sliding, a motion may change over one period by
/// less than the rounding error. `find` then decides by averaging. Vibration may end at a β
/// slightly above the β at which steady sliding becomes stable. If their relative difference is
/// less than 10⁻⁸, the result is the β at which steady sliding becomes stable.
///
/// The function calls `find` once if the vibration ends where steady sliding becomes stable,
/// otherwise 60 to 130 times. [`Along::silence`] accepts a bound of the work and a watcher (a
/// function that can stop the search).
///
/// Source: cycles of rotated vector fields, Duff, *Ann. Math.* 57 (1953) 15-31.
///
/// # Errors
///
/// * [`Error::At`], with the β tried and one of the errors of [`find`](crate::limit_cycle::find).
///   Every β tried is at most max(10⁻³, 2β_0, 2β_1), where β_0 is the result and β_1 the β at which
///   steady sliding becomes stable;
/// * [`Error::Stopped`] after [`Search::DEFAULT_MAX_BRANCH_STEPS`].
///
/// ```
/// use stick_slip::{Coulomb, Exponential, MassOnBelt, bifurcation};
///
/// let system = MassOnBelt::new(Exponential::new(0.4, 0.25, 0.5)?, 1.0)?;
/// let silent = bifurcation::silencing_damping(&system)?;
/// // Steady sliding is stable from β = 0.0110 on; stick-slip still exists at this damping.
/// assert!(silent > 0.012);
///
/// // Coulomb's law never destabilises steady sliding.
/// let system = MassOnBelt::new(Coulomb::new(0.4, 0.25)?, 0.1)?;
/// assert!(bifurcation::silencing_damping(&system)? > 0.1);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[doc(alias = "squeal")]
#[doc(alias = "critical damping")]
#[doc(alias = "least_damping")]
pub fn silencing_damping<L: FrictionLaw>(system: &MassOnBelt<L>) -> Result<f64, Error> {
    least_damping(system.belt())
}

fn least_damping(system: Belt<'_>) -> Result<f64, Error> {
    if system.belt_velocity() == 0.0 || is_frictionless(system.law()) {
        return Ok(0.0);
    }
    judged(
        &|value, look| system.with_damping(value).and_then(look),
        "damping",
        &|vibrates| {
            let slope = system.law().slope(system.belt_velocity().abs());
            // The β below which steady sliding is unstable.
            let stable = (-0.5 * system.load() * slope).max(0.0);
            let just_above = stable * (1.0 + MARGIN) + f64::MIN_POSITIVE;
            if !vibrates(just_above)? {
                return Ok(stable);
            }
            let (mut loud, mut silent) = (just_above, (2.0 * just_above).max(FIRST));
            while vibrates(silent)? {
                (loud, silent) = (silent, 2.0 * silent);
            }
            Ok(border(vibrates, (loud, true), (silent, false))?.next_up())
        },
    )
}

/// A search for a border with loads, dampings or stiffnesses of its own choice, within the default
/// bound of the work.
fn judged(
    systems: &dyn Fn(f64, &mut Visit<'_>) -> Result<(), Error>,
    parameter: &'static str,
    search: &dyn Fn(&Vibrates) -> Result<f64, Error>,
) -> Result<f64, Error> {
    let bound = Search::new();
    let family = RangeSearch::of(systems, parameter, &bound);
    let work = Work::of(&family);
    search(&|value| Ok(work.moving_at(value, &mut has_cycles)?.unwrap_or(false)))
}

/// The friction load γ², dimensionless, at which vibration begins at the system's belt velocity and
/// damping. The system's own load is ignored.
///
/// At this load one of three changes happens: steady sliding becomes unstable (γ² =
/// −2β/(dμ̂/ds(|v_b|)), with the damping ratio β and the kinetic coefficient μ̂(s) at the sliding
/// speed s), two cycles appear, or a stick-slip cycle appears. Let γ_1² = (1 + β)|v_b|/max(μ_s,
/// μ̂(|v_b|)), with the static coefficient μ_s. The function tries loads below the load at which
/// steady sliding becomes unstable, from about 10⁻⁶γ_1² to about 10⁶γ_1². If no change is found,
/// the result is
/// * 0 for an undamped mass if vibration can last with every load: steady sliding is unstable, or a
///   [`Continuum`](crate::limit_cycle::Continuum) surrounds it;
/// * 0 if the mass vibrates under every load tried;
/// * ∞ if the mass vibrates under no load tried, and steady sliding is stable under every load;
/// * ∞ if the belt is at rest.
///
/// The function encloses the load by doubling or halving γ², beginning with γ_1², and narrows the
/// enclosure to neighbouring numbers. As in [`silencing_damping`],
/// [`find`](crate::limit_cycle::find) decides whether the mass vibrates. The loads with vibration
/// may form several intervals. The result is then the lower end of one of these intervals, not
/// necessarily of the first. [`Along::vibration_ranges`] lists all borders.
///
/// The function calls `find` up to 130 times. [`Along::silence`] accepts a bound of the work and a
/// watcher (a function that can stop the search).
///
/// # Errors
///
/// * [`Error::At`], with the load tried and one of the errors of
///   [`find`](crate::limit_cycle::find);
/// * [`Error::Stopped`] after [`Search::DEFAULT_MAX_BRANCH_STEPS`].
///
/// ```
/// use stick_slip::{Exponential, MassOnBelt, bifurcation};
///
/// let law = Exponential::new(0.4, 0.25, 0.5)?;
/// let system = MassOnBelt::new(law, 0.6)?.with_damping(0.05)?;
/// let silent = bifurcation::silencing_load(&system)?;
/// // Steady sliding is stable up to a load of 0.59; the mass can vibrate at smaller loads.
/// let hopf = 0.1 / (1.2 * 0.6 * (-1.44_f64).exp());
/// assert!(silent < hopf && silent > 0.5 * hopf);
/// // The damping that silences the mass under this load is the damping of the system, 0.05.
/// let damping = bifurcation::silencing_damping(&system.with_load(silent)?)?;
/// assert!((damping - 0.05).abs() < 1e-12);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[doc(alias = "squeal")]
#[doc(alias = "critical load")]
pub fn silencing_load<L: FrictionLaw>(system: &MassOnBelt<L>) -> Result<f64, Error> {
    largest_load(system.belt())
}

fn largest_load(system: Belt<'_>) -> Result<f64, Error> {
    let (law, speed, damping) = (system.law(), system.belt_velocity().abs(), system.damping());
    if speed == 0.0 || is_frictionless(law) {
        let is_free = speed > 0.0 && damping == 0.0;
        return Ok(if is_free { 0.0 } else { f64::INFINITY });
    }
    // The load above which steady sliding is unstable.
    let stable = match law.slope(speed) {
        slope if slope < 0.0 => -2.0 * damping / slope,
        _ => f64::INFINITY,
    };
    if stable == 0.0 {
        return Ok(stable);
    }
    let just_below = stable * (1.0 - MARGIN);
    // Under this load friction is as strong as the motion with the belt. Where the law is nearly
    // flat at v_b, the load that makes steady sliding unstable is beyond all that is of interest.
    let unit = (1.0 + damping) * speed / law.static_coefficient().max(law.kinetic(speed));
    let systems = |value: f64, look: &mut Visit<'_>| system.with_load(value).and_then(look);
    judged(&systems, "load", &|vibrates| {
        let (mut silent, mut loud) = (0.0, unit.min(just_below));
        while !vibrates(loud)? {
            if loud >= just_below || loud > MOST_LOAD * unit {
                return Ok(stable);
            }
            (silent, loud) = (loud, (2.0 * loud).min(just_below));
        }
        if silent == 0.0 {
            let least = loud / MOST_LOAD;
            silent = 0.5 * loud;
            while vibrates(silent)? {
                if silent < least {
                    return Ok(0.0);
                }
                (loud, silent) = (silent, 0.5 * silent);
            }
        }
        border(vibrates, (silent, false), (loud, true))
    })
}

/// The stiffness at which vibration ends at the system's belt velocity, as a multiple κ of the
/// stiffness of the spring; mass, damping constant and normal force stay the same. With a slightly
/// softer spring a vibration can last.
///
/// The equation of slip with the stiffness κ is that of [`MassOnBelt`] with the damping ratio β/√κ,
/// the friction load γ²/κ, the belt velocity v_b/√κ and the law μ(√κ v_r), in the time √κ τ. κ does
/// not change the sign of the damping of steady sliding, 2β + γ²dμ̂/ds(|v_b|). The result is
/// * ∞ if steady sliding is unstable, or if the mass vibrates with every stiffness tried, up to
///   10⁶: if friction falls with the speed, a large vibration can last with any stiffness;
/// * 0 if the belt is at rest, or if the mass vibrates with no stiffness tried, down to 10⁻⁶.
///
/// The function encloses κ by doubling or halving, beginning with 1, and narrows the enclosure to
/// neighbouring numbers. As in [`silencing_damping`], [`find`](crate::limit_cycle::find) decides
/// whether the mass vibrates. The stiffnesses with vibration may form several intervals; the result
/// is the upper end of one of them.
///
/// # Errors
///
/// * [`Error::At`], with the κ tried and one of the errors of [`find`](crate::limit_cycle::find),
///   in the units of the equation above;
/// * [`Error::Stopped`] after [`Search::DEFAULT_MAX_BRANCH_STEPS`].
///
/// ```
/// use stick_slip::{Coulomb, MassOnBelt, analysis, bifurcation};
///
/// let law = Coulomb::new(0.4, 0.25)?;
/// let system = MassOnBelt::new(law, 0.2)?.with_damping(0.05)?;
/// let stiffness = bifurcation::silencing_stiffness(&system)?;
/// // There the belt is as fast as the fastest belt with stick-slip.
/// let root = stiffness.sqrt();
/// let stiff = MassOnBelt::new(law, 0.2 / root)?
///     .with_damping(0.05 / root)?
///     .with_load(1.0 / stiffness)?;
/// let fastest = analysis::coulomb::largest_stick_slip_velocity(&stiff);
/// assert!((0.2 / root - fastest).abs() < 1e-14);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[doc(alias = "squeal")]
#[doc(alias = "critical stiffness")]
pub fn silencing_stiffness<L: FrictionLaw>(system: &MassOnBelt<L>) -> Result<f64, Error> {
    least_stiffness(system.belt(), &|stiffness, look| {
        let root = stiffness.sqrt();
        let law = Scaled::of(system.law(), root);
        let stiff = MassOnBelt::new(law, system.belt_velocity() / root)?
            .with_damping(system.damping() / root)?
            .with_load(system.load() / stiffness)?;
        look(stiff.belt())
    })
}

/// The multiple of the stiffness of a system at which vibration ends, among the systems with other
/// stiffnesses.
pub(crate) fn least_stiffness(
    system: Belt<'_>,
    systems: &dyn Fn(f64, &mut Visit<'_>) -> Result<(), Error>,
) -> Result<f64, Error> {
    let (law, speed) = (system.law(), system.belt_velocity().abs());
    if speed == 0.0 {
        return Ok(0.0);
    }
    if 2.0 * system.damping() + system.load() * law.slope(speed) < 0.0 {
        return Ok(f64::INFINITY);
    }
    judged(systems, "stiffness", &|vibrates| {
        let mut silent = 1.0;
        while vibrates(silent)? {
            if silent > MOST_STIFFNESS {
                return Ok(f64::INFINITY);
            }
            silent *= 2.0;
        }
        let mut loud = 0.5 * silent;
        while !vibrates(loud)? {
            if loud < 1.0 / MOST_STIFFNESS {
                return Ok(0.0);
            }
            (silent, loud) = (loud, 0.5 * loud);
        }
        Ok(border(vibrates, (loud, true), (silent, false))?.next_up())
    })
}

impl<L: FrictionLaw> Along<'_, L> {
    /// A value of the parameter, within the range, at which vibration begins or ends. On one side
    /// of this value the mass can vibrate, on the other side it cannot. The result is `None` if the
    /// mass can vibrate at both ends of the range, or at neither end.
    ///
    /// The mass can vibrate if steady sliding is unstable, or if [`find`](crate::limit_cycle::find)
    /// finds a cycle, a continuum or an unresolved range. The border lies between two neighbouring
    /// numbers, and the result is the lower number. If there are several borders, one of them is
    /// found; [`vibration_ranges`](Self::vibration_ranges) lists all.
    ///
    /// # Errors
    ///
    /// * [`Error::InvalidParameter`] unless the range is finite and not empty;
    /// * [`Error::At`], with the value and one of the errors of `find`;
    /// * [`Error::Stopped`] if the bound of the work is reached, or if the watcher stops the
    ///   search.
    ///
    /// ```
    /// use stick_slip::{Exponential, MassOnBelt, bifurcation};
    ///
    /// let system = MassOnBelt::new(Exponential::new(0.4, 0.25, 0.5)?, 1.0)?;
    /// let search = bifurcation::along(|damping| system.with_damping(damping), 0.0..0.5);
    /// let silent = search.silence()?.unwrap();
    /// assert!((silent - bifurcation::silencing_damping(&system)?).abs() < 1e-15);
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    pub fn silence(&self) -> Result<Option<f64>, Error> {
        self.search(|search| search.silence())
    }
}

impl RangeSearch<'_> {
    fn silence(&self) -> Result<Option<f64>, Error> {
        let whole = self.whole()?;
        let work = Work::of(self);
        let vibrates: &Vibrates = &|value| {
            let vibrates = work.moving_at(value, &mut |tracer| {
                let equilibrium = tracer.system().equilibrium();
                let is_stable = equilibrium.is_none_or(|equilibrium| equilibrium.is_stable());
                Ok(!is_stable || has_cycles(tracer)?)
            })?;
            Ok(vibrates.unwrap_or(false))
        };
        let at = |value: f64| Ok((value, vibrates(value)?));
        let (low, high) = (at(whole.start)?, at(whole.end)?);
        if low.1 == high.1 {
            return Ok(None);
        }
        border(vibrates, low, high).map(Some)
    }
}

/// A predicate of the parameter: the mass can vibrate. A trait object, so that the search is
/// compiled once.
type Vibrates<'v> = dyn Fn(f64) -> Result<bool, Error> + 'v;

/// The lower of the two neighbouring numbers between which vibration begins or ends.
fn border(vibrates: &Vibrates, low: (f64, bool), high: (f64, bool)) -> Result<f64, Error> {
    let sign = |loud: bool| if loud { 1.0 } else { -1.0 };
    let mut border = Bracket::new((low.0, sign(low.1)), (high.0, sign(high.1)));
    while let Some(value) = border.next_place() {
        border.narrow(value, sign(vibrates(value)?));
    }
    Ok(border.sign_change().below)
}

/// Returns true if there are, or may be, periodic motions.
fn has_cycles(tracer: &mut Tracer<'_>) -> Result<bool, Error> {
    let cycles = find_moving(tracer)?;
    let none = cycles.is_empty() && cycles.continuum().is_none() && cycles.unresolved().is_empty();
    Ok(!none)
}

/// Largest and least load tried, above and below (1 + β)|v_b|/max(μ_s, μ̂(|v_b|)).
const MOST_LOAD: f64 = 1e6;

/// Largest stiffness tried, and the reciprocal of the least, in units of that of the system.
const MOST_STIFFNESS: f64 = 1e6;

/// Relative distance above the β at which steady sliding becomes stable; small cycles closer to it
/// are not resolved.
const MARGIN: f64 = 1e-8;

/// First β that is tried if steady sliding is always stable.
const FIRST: f64 = 1e-3;

#[cfg(test)]
mod tests;
