use crate::friction::FrictionLaw;
use crate::limit_cycle::{CycleSet, find};
use crate::{Equilibrium, Error, MassOnBelt};

/// Everything that a system can settle to at one belt velocity.
#[derive(Debug, Clone, PartialEq)]
pub struct DiagramPoint {
    /// Belt velocity v_b, dimensionless.
    pub belt_velocity: f64,
    /// The equilibrium and its stability; `None` at v_b = 0.
    pub equilibrium: Option<Equilibrium>,
    /// Every periodic motion.
    pub cycles: CycleSet,
}

/// Equilibrium and periodic motions at each of the belt velocities, computed as the iterator is advanced; the system's own v_b is ignored.
///
/// # Errors
///
/// Each item those of [`MassOnBelt::with_belt_velocity`] and [`find`](crate::limit_cycle::find); the next items follow all the same.
///
/// ```
/// use stick_slip::{CycleKind, MassOnBelt, Polynomial, bifurcation};
///
/// let system = MassOnBelt::new(Polynomial::new(0.4, 0.25, 0.5)?, 0.2)?.with_damping(0.05)?;
/// let kinds: Vec<Option<CycleKind>> = bifurcation::diagram(&system, [0.2, 0.42, 0.46])
///     .map(|point| Ok(point?.cycles.stable().next().map(|cycle| cycle.kind())))
///     .collect::<Result<_, stick_slip::Error>>()?;
/// assert_eq!(kinds, [Some(CycleKind::StickSlip), Some(CycleKind::PureSlip), None]);
/// # Ok::<(), stick_slip::Error>(())
/// ```
pub fn diagram<L: FrictionLaw>(
    system: &MassOnBelt<L>,
    velocities: impl IntoIterator<Item = f64>,
) -> impl Iterator<Item = Result<DiagramPoint, Error>> {
    velocities.into_iter().map(|v_b| point(system, v_b))
}

fn point<L: FrictionLaw>(system: &MassOnBelt<L>, belt_velocity: f64) -> Result<DiagramPoint, Error> {
    let system = system.by_reference().with_belt_velocity(belt_velocity)?;
    Ok(DiagramPoint {
        belt_velocity,
        equilibrium: system.equilibrium(),
        cycles: find(&system)?,
    })
}
