// | file | what is in it |
// |---|---|
// | `along.rs` | `Along`: the family of systems, the range, the bound of the work and the watcher |
// | `grazing.rs` | grazing, overshoot, crossing: contacts of the motion from the release point; touching of pure-slip cycles; searched by `numerics/scan.rs` |
// | `fold.rs` | folds of pure-slip cycles |
// | `hopf.rs` | changes of stability, and the cycle born there; belt velocities are found in `friction/slope_zeros.rs` |
// | `hopf_locus` | curves of Hopf points of any system in two parameters: the search (`mod.rs`), the equations (`equations.rs`) |
// | `ranges.rs` | the attractors of each range |
// | `silence.rs` | the damping, the load and the stiffness at which vibration ends |
// | `diagram.rs` | equilibrium and all cycles at each of a list of belt velocities |

//! Bifurcations of one mass on its belt, and of steady sliding of any system: the belt velocities,
//! loads, dampings or coefficients at which periodic motions appear, disappear or change their
//! kind.
//!
//! ```
//! use stick_slip::bifurcation::{self, AttractorKind};
//! use stick_slip::{MassOnBelt, Polynomial};
//!
//! let system = MassOnBelt::new(Polynomial::new(0.4, 0.25, 0.5)?, 0.2)?.with_damping(0.05)?;
//! let range = 0.01..0.6;
//!
//! // On a faster belt stick-slip ends at one velocity, all vibration at another.
//! let [grazing] = bifurcation::grazing_velocities(&system, range.clone())?[..] else { panic!() };
//! let [hopf] = bifurcation::hopf_velocities(&system, range.clone())?[..] else { panic!() };
//! assert!((grazing - 0.395790288797834).abs() < 1e-14);
//! assert!((hopf - (0.35_f64 / 1.8).sqrt()).abs() < 1e-15);
//!
//! // The attractors over the whole range.
//! let ranges = bifurcation::vibration_ranges(&system, range)?;
//! let attractors: Vec<_> = ranges.iter().map(|range| range.attractors[0]).collect();
//! use AttractorKind::{PureSlip, SteadySliding, StickSlip};
//! assert_eq!(attractors, [StickSlip, PureSlip, SteadySliding]);
//! # Ok::<(), stick_slip::Error>(())
//! ```
//!
#![doc = include_str!("../figures/regimes.svg")]
//!
//! *Attractors over belt velocity and damping, with their computed borders, which the table below
//! explains: Hopf points (black), grazing (blue), overshoot and crossing (purple), folds (green).
//! (a) Polynomial law with static coefficient 0.4, least coefficient 0.1 at the sliding speed 1,
//! and friction load γ² = 0.15. (b) Exponential law with static coefficient 0.6, kinetic
//! coefficient 0.3 at high speeds, Stribeck velocity 0.4, and γ² = 1: two stable motions can
//! coexist.*
//!
//! | function | what happens at the values that it returns |
//! |---|---|
//! | [`hopf_velocities`] | the equilibrium loses or regains stability, and a pure-slip cycle is born; [`criticality`] tells whether the cycle is stable |
//! | [`grazing_velocities`] | stick-slip appears or disappears: after release, the velocity of the mass returns to the belt velocity tangentially |
//! | [`touching_velocities`] | a pure-slip cycle touches the belt velocity, and appears or disappears |
//! | [`fold_velocities`] | a stable and an unstable pure-slip cycle meet and vanish |
//! | [`overshoot_velocities`] | the mass begins or ceases to overtake the belt before it sticks |
//! | [`crossing_velocities`] | a mass that overtakes the belt ceases or begins to stick |
//! | [`vibration_ranges`] | the set of attractors changes; the result is a list of intervals with their attractors |
//! | [`silencing_damping`] | vibration ends: with this damping or more, no vibration lasts at the system's belt velocity |
//! | [`silencing_load`] | vibration begins: just below this load, no vibration lasts at the system's belt velocity |
//! | [`silencing_stiffness`] | vibration ends: with a slightly stiffer spring, no vibration lasts at the system's belt velocity |
//! | [`hopf_locus`] | the equilibrium of any system loses or regains stability; the result is a list of curves in two parameters, with their special points |
//!
//! Every velocity is a root of an exact function of the belt velocity, bracketed and refined to
//! round-off. (Only [`vibration_ranges`] finds some borders by bisection.) The documentation of
//! each function says how densely it searches a range. A narrower range is searched more densely.
//! Negative velocities are also searched: their motions are mirror images of those at positive
//! velocities.
//!
//! [`along`] makes these searches over any other parameter: a load, a damping, a coefficient of the
//! law. Searches by [`along`] and [`along_velocities`] accept a bound of the work, and a watcher, a
//! function that can stop the search, as a [`Search`](crate::Search). [`Along`] states the cost of
//! a search.
//!
//! For each velocity of a list, [`diagram`] returns the equilibrium and all cycles.
//! [`analysis`](crate::analysis) has closed forms of some of these velocities for some laws.
//! [`orbit::follow`](crate::orbit::follow) follows the periodic motions of any system.

mod along;
mod diagram;
mod fold;
mod grazing;
mod hopf;
#[cfg(feature = "orbits")]
mod hopf_locus;
mod ranges;
mod silence;

pub use crate::belt::Criticality;
pub use crate::motion::AttractorKind;
pub(crate) use along::Visit;
pub use along::{Along, along, along_velocities};
#[cfg(feature = "rayon")]
pub use diagram::par_diagram;
pub(crate) use diagram::point;
pub use diagram::{DiagramPoint, diagram};
pub use fold::fold_velocities;
pub use grazing::{
    crossing_velocities, grazing_velocities, overshoot_velocities, touching_velocities,
};
pub use hopf::{criticality, hopf_velocities};
#[cfg(feature = "orbits")]
pub use hopf_locus::{HopfLocus, HopfPoint, SpecialHopfPoint, hopf_locus};
pub use ranges::{VibrationRange, vibration_ranges};
pub(crate) use silence::least_stiffness;
pub use silence::{silencing_damping, silencing_load, silencing_stiffness};
