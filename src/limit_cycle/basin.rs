use super::arc::{Arrival, Tracer};
use super::averaged;
use super::crossings::CrossingMap;
use super::cycle::{CycleKind, LimitCycle};
use super::find::{nested_cycles, of_belt_at_rest};
use super::peaks::PeakMap;
use super::release::{Release, ReleaseFate};
use super::set::CycleSet;
use crate::belt::{Belt, Forward, MassOnBelt, Start};
use crate::clock::Time;
use crate::error::Error;
use crate::friction::FrictionLaw;
use crate::friction::slip_series::SlipPoint;
use crate::state::{Direction, State, Units};

/// The attractor that a motion reaches, or the reason why there is none. See [`attractor`].
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize),
    serde(rename_all = "snake_case")
)]
#[non_exhaustive]
pub enum Attractor {
    /// The mass sticks to a belt that stands still.
    Rest,
    /// Steady sliding at the equilibrium.
    Equilibrium,
    /// A stable periodic motion.
    Cycle(LimitCycle),
    /// The start lies on an unstable periodic motion, to rounding. An arbitrarily small
    /// perturbation decides which attractor is reached.
    Separatrix(LimitCycle),
    /// A [continuum](super::Continuum): the motion from the start belongs to it, or shrinks until
    /// it belongs to it.
    Continuum,
    /// The motion grows beyond every periodic motion that was found.
    Unbounded,
    /// The attractor is not decided, because rounding errors hide whether the motion grows or
    /// shrinks over one period. Either a velocity maximum of the motion lies in an
    /// [unresolved](CycleSet::unresolved) range, or the motion crosses the belt velocity in each
    /// period, and its relative change over one period is about 10⁻¹⁴ or less.
    Unresolved,
}

impl Attractor {
    /// Converts this attractor of a dimensionless system to other units.
    fn in_units(self, units: Units) -> Self {
        match self {
            Self::Cycle(cycle) => Self::Cycle(cycle.in_units(units)),
            Self::Separatrix(cycle) => Self::Separatrix(cycle.in_units(units)),
            other => other,
        }
    }
}

impl std::fmt::Display for Attractor {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Rest => f.pad("rest"),
            Self::Equilibrium => f.pad("steady sliding"),
            Self::Cycle(cycle) => cycle.kind().fmt(f),
            Self::Separatrix(cycle) => f.pad(&format!("separatrix ({})", cycle.kind())),
            Self::Continuum => f.pad("continuum"),
            Self::Unbounded => f.pad("unbounded"),
            Self::Unresolved => f.pad("unresolved"),
        }
    }
}

/// Relative distance from a cycle within which a start lies on it to rounding.
const ON_CYCLE: f64 = 1e-12;

/// Relative distance from a cycle within which a start counts as on it if rounding hides its
/// growth, which is small near a cycle whose multiplier is close to 1.
const HIDDEN_BY_CYCLE: f64 = 1e-6;

/// The attractor that the motion from `start` reaches. For many starts of one system use
/// [`basins`], which finds the cycles only once.
///
/// The decision uses the geometry of the planar flow: cycles are nested, and a motion between two
/// neighbouring cycles tends to the cycle towards which it moves. Therefore only a few slip arcs
/// are computed, up to the first of three points: stick, a velocity maximum V below the belt
/// velocity, or a downward crossing of the belt velocity outside the stick band. No transient is
/// simulated.
///
/// | first point | condition | attractor |
/// |---|---|---|
/// | stick | the motion from the release point returns to stick | the cycle through the release point |
/// | stick | the motion from the release point shrinks | the outermost pure-slip cycle; if there is none, the equilibrium or the [continuum](Attractor::Continuum) around it |
/// | stick | the motion from the release point grows | the innermost crossing cycle; if there is none, [`Unbounded`](Attractor::Unbounded) |
/// | velocity maximum V | the motion grows over one period | the next pure-slip cycle outside; if there is none, as for stick |
/// | velocity maximum V | the motion shrinks | the next pure-slip cycle inside; if there is none, the equilibrium or the [continuum](Attractor::Continuum) around it |
/// | velocity maximum V | V lies in an [unresolved range](CycleSet::unresolved) | [`Unresolved`](Attractor::Unresolved) |
/// | downward crossing | the motion grows over one period | the next crossing cycle outside; if there is none, [`Unbounded`](Attractor::Unbounded) |
/// | downward crossing | the motion shrinks | the next crossing cycle inside; if there is none, as for stick |
/// | downward crossing | rounding hides the growth | [`Unresolved`](Attractor::Unresolved) |
/// | none | the motion slips into a node, or starts at the equilibrium | [`Equilibrium`](Attractor::Equilibrium) |
/// | none | the belt is at rest | [`Rest`](Attractor::Rest) |
///
/// There are two exceptions. A start within a relative distance of 10⁻¹² from an unstable cycle
/// (10⁻⁶ if rounding hides the growth there) gives [`Separatrix`](Attractor::Separatrix). On a belt
/// at rest, without damping and kinetic friction, a motion with an amplitude above γ²μ_s (friction
/// load times static coefficient) gives [`Continuum`](Attractor::Continuum).
///
/// # Errors
///
/// The errors of [`find`](super::find), and [`Error::InvalidState`] unless `start` is finite.
///
/// ```
/// use stick_slip::limit_cycle::{Attractor, attractor};
/// use stick_slip::{Exponential, MassOnBelt, State};
///
/// // Bistable: between equilibrium and stick-slip lies an unstable cycle of peak velocity 0.3112.
/// let system = MassOnBelt::new(Exponential::new(0.6, 0.3, 0.4)?, 1.0)?.with_damping(0.01)?;
/// let rest = system.equilibrium().unwrap().displacement;
/// assert_eq!(attractor(&system, State::new(rest, 0.30))?, Attractor::Equilibrium);
/// assert!(matches!(attractor(&system, State::new(rest, 0.32))?, Attractor::Cycle(_)));
/// # Ok::<(), stick_slip::Error>(())
/// ```
pub fn attractor<L: FrictionLaw>(
    system: &MassOnBelt<L>,
    start: impl Into<State>,
) -> Result<Attractor, Error> {
    let start = start.into();
    check(start)?;
    basins(system)?.attractor(start)
}

/// The basins of attraction of a system. This function finds the cycles once. [`Basins::attractor`]
/// uses them to return the attractor of any start.
///
/// # Errors
///
/// The errors of [`find`](super::find).
///
/// ```
/// use stick_slip::limit_cycle::{Attractor, basins};
/// use stick_slip::{MassOnBelt, State, Stribeck};
///
/// // μ̂ = 0.5 + 0.5 e^(−2s): steady sliding and stick-slip side by side.
/// let law = Stribeck::new(1.0, 0.5, 0.5, 1)?;
/// let system = MassOnBelt::new(law, 1.5)?.with_damping(0.05)?;
/// let basins = basins(&system)?;
/// assert_eq!(basins.cycles().len(), 2);
/// let slides = |u: f64, v: f64| -> Result<bool, stick_slip::Error> {
///     Ok(basins.attractor(State::new(u, v))? == Attractor::Equilibrium)
/// };
/// assert!(slides(0.5, 0.0)? && slides(0.5, 0.5)? && !slides(0.5, 1.5)? && !slides(-2.0, 0.0)?);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[doc(alias = "brute force")]
#[doc(alias = "basin of attraction")]
pub fn basins<L: FrictionLaw>(system: &MassOnBelt<L>) -> Result<Basins<'_, L>, Error> {
    Ok(Basins {
        system,
        nest: Nest::of(system.belt())?,
        measured: None,
    })
}

/// The motions that bound the basins of a system.
#[derive(Debug, Clone)]
struct Nest {
    cycles: CycleSet,
    /// `None` on a belt at rest.
    bounds: Option<Bounds>,
}

/// Basins of attraction of a system. See [`basins`].
///
/// Starts and cycles are dimensionless, or in SI units if this value was returned by
/// [`PhysicalMassOnBelt::basins`](crate::PhysicalMassOnBelt::basins).
///
/// A `Basins` borrows the system and owns the cycles. Queries do not change the `Basins`, so
/// threads may share it:
///
/// ```
/// # use stick_slip::limit_cycle::{Attractor, basins};
/// # use stick_slip::{MassOnBelt, State, Stribeck};
/// # let system = MassOnBelt::new(Stribeck::new(1.0, 0.5, 0.5, 1)?, 1.5)?.with_damping(0.05)?;
/// let basins = basins(&system)?;
/// let starts: Vec<State> = (0..40).map(|i| State::new(0.1 * f64::from(i) - 2.0, 0.0)).collect();
/// // With rayon: `starts.par_iter().map(|&start| basins.attractor(start)).collect()`.
/// let halves = starts.split_at(20);
/// let reached = |half: &[State]| -> Vec<_> {
///     half.iter().map(|&start| basins.attractor(start)).collect()
/// };
/// let (left, right) = std::thread::scope(|scope| {
///     let left = scope.spawn(|| reached(halves.0));
///     (left.join(), reached(halves.1))
/// });
/// let slides = |reached: &Result<Attractor, _>| *reached == Ok(Attractor::Equilibrium);
/// assert!(!slides(&left.unwrap()[0]) && slides(&right[5]));
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Basins<'s, L> {
    system: &'s MassOnBelt<L>,
    nest: Nest,
    /// The units of starts and results if they have any, and the cycles in them.
    measured: Option<(Units, CycleSet)>,
}

/// The boundaries of the basins on a belt that moves forward.
#[derive(Debug, Clone)]
struct Bounds {
    fate: ReleaseFate,
    /// The coordinate of each cycle: its velocity maximum in pure slip, otherwise the force F at
    /// its start (the release point, or the downward crossing).
    places: Vec<f64>,
}

fn check(start: State) -> Result<(), Error> {
    let State {
        displacement,
        velocity,
    } = start;
    if displacement.is_finite() && velocity.is_finite() {
        Ok(())
    } else {
        Err(Error::InvalidState {
            displacement,
            velocity,
        })
    }
}

/// The first point of a motion that decides its attractor.
#[derive(Debug, Clone, Copy)]
enum FirstPoint {
    /// A velocity maximum V < v_b.
    Peak(f64),
    /// The release point.
    Release,
    /// A downward crossing with the force F, beyond the release point.
    Crossing(f64),
    /// A node, or the equilibrium itself.
    Equilibrium,
}

impl Tracer<'_> {
    /// The first point of the motion from `start` that decides its attractor.
    fn first_point(&mut self, start: State) -> Result<FirstPoint, Error> {
        let system = self.system();
        let v_b = system.belt_velocity();
        let mut point = match Start::of(&system, start) {
            Start::Stick => return Ok(FirstPoint::Release),
            Start::Slip(point) => point,
        };
        loop {
            let arc = self.arc(point, Time::Forward)?;
            let displacement = match arc.arrival {
                Arrival::Maximum(point) => return Ok(FirstPoint::Peak(v_b - point.speed)),
                Arrival::Contact(displacement) => displacement,
                Arrival::Equilibrium | Arrival::Far => return Ok(FirstPoint::Equilibrium),
                Arrival::Held => return Ok(FirstPoint::Release),
            };
            match self.system().slides_at(displacement) {
                None => return Ok(FirstPoint::Release),
                Some(Direction::Lagging) => {
                    return Ok(FirstPoint::Crossing(displacement + system.carried_force()));
                }
                // This happens at most once: the leading arc that follows ends in stick or in a
                // downward crossing.
                Some(Direction::Leading) => {
                    point = SlipPoint::leaving(&system, displacement, Direction::Leading);
                }
            }
        }
    }
}

impl<L: FrictionLaw> Basins<'_, L> {
    /// The periodic motions of the system, as returned by [`find`](super::find).
    pub fn cycles(&self) -> &CycleSet {
        match &self.measured {
            Some((_, cycles)) => cycles,
            None => &self.nest.cycles,
        }
    }

    /// The attractor that the motion from `start` reaches. It is decided from at most a few slip
    /// arcs, by the table of the function [`limit_cycle::attractor`](attractor()).
    ///
    /// # Errors
    ///
    /// [`Error::InvalidState`] unless `start` is finite, and the errors of [`find`](super::find).
    pub fn attractor(&self, start: impl Into<State>) -> Result<Attractor, Error> {
        let start = start.into();
        check(start)?;
        let belt = self.system.belt();
        let Some((units, _)) = self.measured else {
            return self.nest.attractor(belt, start);
        };
        match self.nest.attractor(belt, units.dimensionless(start)) {
            Ok(attractor) => Ok(attractor.in_units(units)),
            Err(error) => Err(error.in_units(units)),
        }
    }

    /// The basins of a dimensionless system, for starts and with results in other units.
    pub(crate) fn in_units(self, units: Units) -> Self {
        let cycles = self.nest.cycles.clone().in_units(units);
        let measured = Some((units, cycles));
        Self { measured, ..self }
    }
}

impl Nest {
    fn of(system: Belt<'_>) -> Result<Self, Error> {
        let Some(forward) = Forward::of(system) else {
            return Ok(Self {
                cycles: of_belt_at_rest(system),
                bounds: None,
            });
        };
        let mut tracer = Tracer::new(forward);
        let mut release = Release::follow(&mut tracer)?;
        let fate = release.fate(&mut tracer)?;
        let mut cycles = nested_cycles(&mut tracer, release)?;
        let carried = forward.carried_force();
        let place = |cycle: &LimitCycle| match cycle.kind() {
            CycleKind::PureSlip => cycle.max_velocity(),
            _ => cycle.state().displacement + carried,
        };
        let bounds = Bounds {
            fate,
            places: cycles.iter().map(place).collect(),
        };
        if system.belt_velocity() < 0.0 {
            cycles.mirror();
        }
        Ok(Self {
            cycles,
            bounds: Some(bounds),
        })
    }

    fn attractor(&self, system: Belt<'_>, start: State) -> Result<Attractor, Error> {
        let (Some(bounds), Some(forward)) = (&self.bounds, Forward::of(system)) else {
            return Ok(self.at_rest(system, start));
        };
        let start = if system.belt_velocity() < 0.0 {
            start.mirrored()
        } else {
            start
        };
        self.reached_from(bounds, &mut Tracer::new(forward), start)
    }

    fn reached_from(
        &self,
        bounds: &Bounds,
        tracer: &mut Tracer<'_>,
        start: State,
    ) -> Result<Attractor, Error> {
        match tracer.first_point(start)? {
            FirstPoint::Equilibrium => Ok(Attractor::Equilibrium),
            FirstPoint::Peak(peak) => self.reached_from_peak(bounds, tracer, peak),
            FirstPoint::Release => Ok(self.reached_from_release(bounds)),
            FirstPoint::Crossing(force) => self.reached_from_crossing(bounds, tracer, force),
        }
    }

    /// The attractor of a start on a belt that stands still.
    fn at_rest(&self, system: Belt<'_>, start: State) -> Attractor {
        let [_, band] = system.stick_limits();
        match self.cycles.continuum() {
            Some(_) if start.displacement.hypot(start.velocity) > band => Attractor::Continuum,
            _ => Attractor::Rest,
        }
    }

    fn is_in_continuum(&self, peak: f64) -> bool {
        self.cycles
            .continuum()
            .is_some_and(|continuum| peak <= continuum.max_amplitude)
    }

    fn is_unresolved(&self, peak: f64) -> bool {
        let ranges = self.cycles.unresolved();
        ranges.iter().any(|range| range.contains(&peak))
    }

    /// The cycles of a kind with their coordinates, from the inside outwards.
    fn of_kind(
        &self,
        bounds: &Bounds,
        kind: CycleKind,
    ) -> impl DoubleEndedIterator<Item = (&LimitCycle, f64)> {
        std::iter::zip(self.cycles.iter(), bounds.places.iter().copied())
            .filter(move |(cycle, _)| cycle.kind() == kind)
    }

    fn reached_from_peak(
        &self,
        bounds: &Bounds,
        tracer: &mut Tracer<'_>,
        peak: f64,
    ) -> Result<Attractor, Error> {
        if self.is_in_continuum(peak) {
            return Ok(Attractor::Continuum);
        }
        if self.is_unresolved(peak) {
            return Ok(Attractor::Unresolved);
        }
        let grows = PeakMap::of(tracer).grows(peak)?;
        let v_b = tracer.system().belt_velocity();
        if let Some(cycle) = self.cycle_through(bounds, CycleKind::PureSlip, peak, v_b, grows) {
            return Ok(attractor_on(cycle));
        }
        let grows = match grows {
            None => averaged::grows(&tracer.system(), peak)?,
            grows => grows,
        };
        if grows.is_none() && self.cycles.continuum().is_some() {
            // At the border of the continuum, on either side of it.
            return Ok(Attractor::Continuum);
        }
        // Closest to the equilibrium, where no growth is certain, the motion is linear, and the
        // stability of the equilibrium decides.
        let equilibrium = tracer.system().equilibrium();
        let unstable = equilibrium.is_some_and(|equilibrium| !equilibrium.is_stable());
        let mut cycles = self.of_kind(bounds, CycleKind::PureSlip);
        Ok(if grows.unwrap_or(unstable) {
            match cycles.find(|(_, place)| *place > peak) {
                Some((cycle, _)) => Attractor::Cycle(cycle.clone()),
                // The motion leaves the region of pure slip for the next attractor outside.
                None => self.reached_from_release(bounds),
            }
        } else {
            match cycles.rfind(|(_, place)| *place < peak) {
                Some((cycle, _)) => Attractor::Cycle(cycle.clone()),
                None => self.innermost(),
            }
        })
    }

    /// The attractor inside all cycles.
    fn innermost(&self) -> Attractor {
        match self.cycles.continuum() {
            Some(_) => Attractor::Continuum,
            None => Attractor::Equilibrium,
        }
    }

    fn reached_from_release(&self, bounds: &Bounds) -> Attractor {
        let to = |cycle: Option<&LimitCycle>| cycle.map(|cycle| Attractor::Cycle(cycle.clone()));
        match bounds.fate {
            // The motion from the release point surrounds all motions in slip, so it comes down to
            // the outermost cycle among them.
            ReleaseFate::Inward => {
                let outermost = self.of_kind(bounds, CycleKind::PureSlip).next_back();
                to(outermost.map(|(cycle, _)| cycle)).unwrap_or_else(|| self.innermost())
            }
            ReleaseFate::Stick => {
                let mut cycles = self.cycles.iter();
                to(cycles.find(|cycle| {
                    matches!(cycle.kind(), CycleKind::StickSlip | CycleKind::Overshoot)
                }))
                .unwrap_or(Attractor::Unbounded)
            }
            ReleaseFate::Outward => {
                let innermost = self.of_kind(bounds, CycleKind::Crossing).next();
                to(innermost.map(|(cycle, _)| cycle)).unwrap_or(Attractor::Unbounded)
            }
        }
    }

    fn reached_from_crossing(
        &self,
        bounds: &Bounds,
        tracer: &mut Tracer<'_>,
        force: f64,
    ) -> Result<Attractor, Error> {
        if self.is_in_continuum(f64::INFINITY) {
            return Ok(Attractor::Continuum);
        }
        let grows = CrossingMap::of(tracer).grows(force)?;
        if let Some(cycle) = self.cycle_through(bounds, CycleKind::Crossing, force, force, grows) {
            return Ok(attractor_on(cycle));
        }
        let mut cycles = self.of_kind(bounds, CycleKind::Crossing);
        Ok(match grows {
            None => Attractor::Unresolved,
            Some(true) => match cycles.find(|(_, place)| *place > force) {
                Some((cycle, _)) => Attractor::Cycle(cycle.clone()),
                None => Attractor::Unbounded,
            },
            Some(false) => match cycles.rfind(|(_, place)| *place < force) {
                Some((cycle, _)) => Attractor::Cycle(cycle.clone()),
                // Further inwards is the stick-slip cycle, or the motion moves inwards like the
                // motion from the release point.
                None => self.reached_from_release(bounds),
            },
        })
    }

    /// The cycle of a kind on which a start lies, by comparison of coordinates.
    fn cycle_through(
        &self,
        bounds: &Bounds,
        kind: CycleKind,
        start: f64,
        scale: f64,
        grows: Option<bool>,
    ) -> Option<&LimitCycle> {
        let reach = if grows.is_some() {
            ON_CYCLE
        } else {
            HIDDEN_BY_CYCLE
        };
        self.of_kind(bounds, kind)
            .map(|(cycle, place)| (cycle, (place - start).abs()))
            .min_by(|(_, a), (_, b)| a.total_cmp(b))
            .filter(|(_, distance)| *distance <= reach * scale)
            .map(|(cycle, _)| cycle)
    }
}

/// The attractor of a start on a cycle: the cycle itself, or a separatrix if it is unstable.
fn attractor_on(cycle: &LimitCycle) -> Attractor {
    if cycle.is_stable() {
        Attractor::Cycle(cycle.clone())
    } else {
        Attractor::Separatrix(cycle.clone())
    }
}

#[cfg(test)]
mod tests;
