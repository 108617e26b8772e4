use std::borrow::Borrow;

use crate::belt::{Belt, Equilibrium, MassOnBelt};
use crate::error::Error;
use crate::friction::FrictionLaw;
use crate::limit_cycle::{CycleSet, find_all};

/// The equilibrium and all periodic motions, stable and unstable, at one belt velocity.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct DiagramPoint {
    /// Belt velocity v_b, dimensionless.
    pub belt_velocity: f64,
    /// The equilibrium and its stability; `None` on a belt at rest.
    pub equilibrium: Option<Equilibrium>,
    /// The periodic motions, as [`find`](crate::limit_cycle::find) returns them.
    pub cycles: CycleSet,
}

/// The equilibrium and all periodic motions for each belt velocity (dimensionless) of a list. Each
/// item is computed when the iterator reaches it. The system's own belt velocity is ignored.
///
/// # Errors
///
/// An item can be an error of [`MassOnBelt::with_belt_velocity`], or [`Error::At`] with the belt
/// velocity and one of the errors of [`find`](crate::limit_cycle::find). The iterator continues
/// after an error.
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
#[doc(alias = "sweep")]
#[doc(alias = "brute force")]
#[doc(alias = "bifurcation diagram")]
#[doc(alias = "hysteresis")]
pub fn diagram<L: FrictionLaw>(
    system: &MassOnBelt<L>,
    velocities: impl IntoIterator<Item = impl Borrow<f64>>,
) -> impl Iterator<Item = Result<DiagramPoint, Error>> {
    velocities
        .into_iter()
        .map(|v_b| point(system.belt(), *v_b.borrow()))
}

/// The results of [`diagram`], computed by several threads, each for some of the belt velocities.
/// They equal those of `diagram` bit for bit, and have the order of the velocities.
///
/// Needs the feature `rayon`.
///
/// ```
/// use stick_slip::{Exponential, MassOnBelt, bifurcation};
///
/// let system = MassOnBelt::new(Exponential::new(0.6, 0.3, 0.4)?, 1.0)?.with_damping(0.01)?;
/// let velocities: Vec<f64> = (1..=20).map(|i| 0.1 * i as f64).collect();
/// let alone: Vec<_> = bifurcation::diagram(&system, &velocities).collect();
/// assert_eq!(bifurcation::par_diagram(&system, &velocities), alone);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[cfg(feature = "rayon")]
pub fn par_diagram<L: FrictionLaw + Sync>(
    system: &MassOnBelt<L>,
    velocities: &[f64],
) -> Vec<Result<DiagramPoint, Error>> {
    use rayon::prelude::*;
    velocities
        .par_iter()
        .map(|&v_b| point(system.belt(), v_b))
        .collect()
}

/// Equilibrium and periodic motions at one belt velocity.
pub(crate) fn point(system: Belt<'_>, belt_velocity: f64) -> Result<DiagramPoint, Error> {
    let system = system.with_belt_velocity(belt_velocity)?;
    Ok(DiagramPoint {
        belt_velocity,
        equilibrium: system.equilibrium(),
        cycles: find_all(system).map_err(|error| error.at("belt_velocity", belt_velocity))?,
    })
}
