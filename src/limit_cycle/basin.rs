use super::arc::{Arrival, Tracer};
use super::maps::ReleaseFate;
use super::{CycleKind, CycleSet, LimitCycle, facing, find_with};
use crate::belt::MassOnBelt;
use crate::belt::{SlipPoint, Start};
use crate::clock::Time;
use crate::error::Error;
use crate::friction::{FrictionLaw, has_no_kinetic_friction};
use crate::state::{Direction, State};

/// Where a motion ends up. See [`attractor`].
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize),
    serde(rename_all = "snake_case")
)]
#[non_exhaustive]
pub enum Attractor {
    /// At rest in the stick band of a belt that stands still.
    Rest,
    /// Steady sliding at the equilibrium.
    Equilibrium,
    /// A stable periodic motion.
    Cycle(LimitCycle),
    /// The start lies on an unstable periodic motion, to rounding: the slightest disturbance
    /// decides.
    Separatrix(LimitCycle),
    /// The start lies in a [continuum](super::Continuum): its motion is periodic, and so is every
    /// other near it.
    Continuum,
    /// The motion grows beyond every periodic motion that was found.
    Unbounded,
    /// Rounding hides whether the motion grows or shrinks: it starts in a range that is
    /// [unresolved](CycleSet::unresolved), or friction and damping change it by less than 10⁻¹⁴ in
    /// a turn.
    Unresolved,
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

/// The same where rounding hides the growth: it is small near a cycle whose multiplier is near 1.
const HIDDEN_BY_CYCLE: f64 = 1e-6;

/// Which attractor the motion from `start` reaches.
///
/// Decided from the geometry of the planar flow: cycles lie one inside the other, and a motion
/// between two of them goes to the one that it moves towards. At most a few slip arcs are followed,
/// to the first velocity maximum, stick, or crossing outside the stick band; nothing is simulated
/// until it settles.
///
/// | start | first decided at | reaches |
/// |---|---|---|
/// | v_b = 0 | | [`Rest`](Attractor::Rest); without damping and kinetic friction [`Continuum`](Attractor::Continuum), outside the stick band |
/// | in stick, or slip that ends in stick | the release point | the cycle through it; if the motion from there turns inwards or outwards, as below |
/// | slip behind the belt, equilibrium a focus | a velocity maximum V | growing over one turn: the next cycle outside, else the next one inside, else the equilibrium |
/// | slip into a node that it does not turn round, or the equilibrium itself, stable or not | | [`Equilibrium`](Attractor::Equilibrium) |
/// | far out, or above the belt velocity | a crossing beyond the release point | growing over one turn: the next crossing cycle outside, else the next one inside, else as from the release point |
/// | an unstable cycle, to 10⁻¹² | | [`Separatrix`](Attractor::Separatrix) |
/// | where rounding hides the growth over one turn | | [`Unresolved`](Attractor::Unresolved) |
///
/// # Errors
///
/// Those of [`find`](super::find), and [`Error::InvalidState`] unless `start` is finite.
///
/// ```
/// use stick_slip::limit_cycle::{Attractor, attractor};
/// use stick_slip::{Exponential, MassOnBelt, State};
///
/// // Bistable: the unstable cycle between equilibrium and stick-slip has a peak velocity of 0.3112.
/// let system = MassOnBelt::new(Exponential::new(0.6, 0.3, 0.4)?, 1.0)?.with_damping(0.01)?;
/// let rest = system.equilibrium().unwrap().displacement;
/// assert_eq!(attractor(&system, State::new(rest, 0.30))?, Attractor::Equilibrium);
/// assert!(matches!(attractor(&system, State::new(rest, 0.32))?, Attractor::Cycle(_)));
/// # Ok::<(), stick_slip::Error>(())
/// ```
pub fn attractor<L: FrictionLaw>(system: &MassOnBelt<L>, start: State) -> Result<Attractor, Error> {
    if !(start.displacement.is_finite() && start.velocity.is_finite()) {
        let State {
            displacement,
            velocity,
        } = start;
        return Err(Error::InvalidState {
            displacement,
            velocity,
        });
    }
    if system.belt_velocity() == 0.0 {
        let [_, band] = system.stick_limits();
        let goes_on = system.damping() == 0.0
            && start.displacement.hypot(start.velocity) > band
            && has_no_kinetic_friction(system.law());
        return Ok(if goes_on {
            Attractor::Continuum
        } else {
            Attractor::Rest
        });
    }
    let forward = system.moving_forward();
    let start = if system.belt_velocity() < 0.0 {
        start.mirrored()
    } else {
        start
    };
    let mut tracer = Tracer::new(&forward);
    let fate = tracer.release_fate()?;
    let basins = Basins {
        cycles: find_with(&mut tracer, &fate)?,
        fate,
    };
    let place = tracer.first_place(start)?;
    Ok(match basins.from(&mut tracer, place)? {
        Attractor::Cycle(cycle) => Attractor::Cycle(facing(system, cycle)),
        Attractor::Separatrix(cycle) => Attractor::Separatrix(facing(system, cycle)),
        other => other,
    })
}

/// Where the fate of a motion is decided.
#[derive(Debug, Clone, Copy)]
enum Place {
    /// At a velocity maximum V, behind the belt.
    Peak(f64),
    /// At the release point.
    Release,
    /// At a downward crossing with the force F beyond the release point.
    Crossing(f64),
    /// At a node.
    Equilibrium,
}

impl<L: FrictionLaw> Tracer<'_, L> {
    /// The first place on the motion from `start` where its fate is decided.
    fn first_place(&mut self, start: State) -> Result<Place, Error> {
        let system = self.system();
        let v_b = system.belt_velocity();
        let mut point = match Start::of(system, start) {
            Start::Stick => return Ok(Place::Release),
            Start::Slip(point) => point,
        };
        loop {
            let arc = self.arc(point, Time::Forward)?;
            let displacement = match arc.arrival {
                Arrival::Maximum(point) => return Ok(Place::Peak(v_b - point.speed)),
                Arrival::Contact(displacement) => displacement,
                Arrival::Equilibrium | Arrival::Far => return Ok(Place::Equilibrium),
            };
            match self.system().slides_at(displacement) {
                None => return Ok(Place::Release),
                Some(Direction::Lagging) => {
                    return Ok(Place::Crossing(displacement + system.carried_force()));
                }
                // At most once: the leading arc that follows ends in stick or in a downward
                // crossing.
                Some(Direction::Leading) => {
                    point = SlipPoint::leaving(system, displacement, Direction::Leading);
                }
            }
        }
    }
}

/// The nested cycles of a system moving forward.
struct Basins {
    cycles: CycleSet,
    fate: ReleaseFate,
}

impl Basins {
    fn is_in_continuum(&self, peak: f64) -> bool {
        self.cycles
            .continuum()
            .is_some_and(|continuum| peak <= continuum.max_amplitude)
    }

    fn is_unresolved(&self, peak: f64) -> bool {
        let ranges = self.cycles.unresolved();
        ranges.iter().any(|range| range.contains(&peak))
    }

    fn of_kind(&self, kind: CycleKind) -> impl DoubleEndedIterator<Item = &LimitCycle> {
        self.cycles.iter().filter(move |cycle| cycle.kind() == kind)
    }

    fn from<L: FrictionLaw>(
        &self,
        tracer: &mut Tracer<'_, L>,
        place: Place,
    ) -> Result<Attractor, Error> {
        let v_b = tracer.system().belt_velocity();
        // Near the equilibrium, where motion is linear, rounding hides the growth.
        let equilibrium = tracer.system().equilibrium();
        let unstable = equilibrium.is_some_and(|equilibrium| !equilibrium.is_stable());
        Ok(match place {
            Place::Equilibrium => Attractor::Equilibrium,
            Place::Peak(peak) if self.is_in_continuum(peak) => Attractor::Continuum,
            Place::Peak(peak) if self.is_unresolved(peak) => Attractor::Unresolved,
            Place::Peak(peak) => {
                let peaks = LimitCycle::max_velocity;
                let grows = tracer.grows_from_peak(peak)?;
                let mut cycles = self.of_kind(CycleKind::PureSlip);
                if let Some(cycle) = self.at(CycleKind::PureSlip, peaks, peak, v_b, grows) {
                    on(cycle)
                } else if grows.unwrap_or(unstable) {
                    match cycles.find(|cycle| peaks(cycle) > peak) {
                        Some(cycle) => Attractor::Cycle(cycle.clone()),
                        // Out of slip: to what surrounds it.
                        None => self.from(tracer, Place::Release)?,
                    }
                } else {
                    match cycles.rfind(|cycle| peaks(cycle) < peak) {
                        Some(cycle) => Attractor::Cycle(cycle.clone()),
                        None => Attractor::Equilibrium,
                    }
                }
            }
            Place::Release => match &self.fate {
                // It surrounds every motion in slip, and so it comes down to the outermost of them.
                ReleaseFate::Inward { peak } => match self.of_kind(CycleKind::PureSlip).next_back()
                {
                    Some(cycle) => Attractor::Cycle(cycle.clone()),
                    None if peak.is_some_and(|peak| self.is_in_continuum(peak)) => {
                        Attractor::Continuum
                    }
                    None => Attractor::Equilibrium,
                },
                ReleaseFate::Stick { .. } => self
                    .cycles
                    .iter()
                    .find(|cycle| cycle.stick_duration() > 0.0)
                    .map_or(Attractor::Unbounded, |cycle| {
                        Attractor::Cycle(cycle.clone())
                    }),
                ReleaseFate::Outward => self
                    .of_kind(CycleKind::Crossing)
                    .next()
                    .map_or(Attractor::Unbounded, |cycle| {
                        Attractor::Cycle(cycle.clone())
                    }),
            },
            Place::Crossing(_) if self.is_in_continuum(f64::INFINITY) => Attractor::Continuum,
            Place::Crossing(force) => {
                let offset = tracer.system().carried_force();
                let forces = |cycle: &LimitCycle| cycle.state().displacement + offset;
                let grows = tracer.grows_from_crossing(force)?;
                let mut cycles = self.of_kind(CycleKind::Crossing);
                match (
                    self.at(CycleKind::Crossing, forces, force, force, grows),
                    grows,
                ) {
                    (Some(cycle), _) => on(cycle),
                    (None, None) => Attractor::Unresolved,
                    (None, Some(true)) => cycles
                        .find(|cycle| forces(cycle) > force)
                        .map_or(Attractor::Unbounded, |cycle| {
                            Attractor::Cycle(cycle.clone())
                        }),
                    (None, Some(false)) => match cycles.rfind(|cycle| forces(cycle) < force) {
                        Some(cycle) => Attractor::Cycle(cycle.clone()),
                        // In to stick, or past it inwards as the motion from the release point.
                        None => self.from(tracer, Place::Release)?,
                    },
                }
            }
        })
    }

    /// The cycle of a kind that a start lies on, by their places on it.
    fn at(
        &self,
        kind: CycleKind,
        place: impl Fn(&LimitCycle) -> f64,
        start: f64,
        scale: f64,
        grows: Option<bool>,
    ) -> Option<&LimitCycle> {
        let reach = if grows.is_some() {
            ON_CYCLE
        } else {
            HIDDEN_BY_CYCLE
        };
        let distance = |cycle: &LimitCycle| (place(cycle) - start).abs();
        self.of_kind(kind)
            .min_by(|a, b| distance(a).total_cmp(&distance(b)))
            .filter(|cycle| distance(cycle) <= reach * scale)
    }
}

fn on(cycle: &LimitCycle) -> Attractor {
    if cycle.is_stable() {
        Attractor::Cycle(cycle.clone())
    } else {
        Attractor::Separatrix(cycle.clone())
    }
}
