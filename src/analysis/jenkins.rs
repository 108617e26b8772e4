//! The Jenkins element, a spring in series with a dry slider: its hysteresis, its first harmonic,
//! and the exact response of one mass with such an element to a harmonic force.
//!
//! The element is a model of an elastic dry contact.
//!
//! ```text
//! stick:  T' = k_t x'  while |T| ≤ F_s            slip:  T = F_s sgn x'
//! ```
//!
//! x is the displacement, T the force of the element, k_t the stiffness of the spring and F_s = μN
//! the limit of the slider. Any consistent units may be used. A [`Contact`](crate::Contact) with a
//! tangential stiffness is a Jenkins element; many of them in parallel form Segalman's joint model
//! [`Iwan4`].
//!
//! Sources: G. Masing, *Eigenspannungen und Verfestigung beim Messing*, Proc. 2nd Int. Congr. Appl.
//! Mech. (1926) 332-335; T. K. Caughey, *Sinusoidal excitation of a system with bilinear
//! hysteresis*, J. Appl. Mech. 27 (1960) 640-643; W. D. Iwan, *A distributed-element model for
//! hysteresis and its steady-state dynamic response*, J. Appl. Mech. 33 (1966) 893-900.

mod linear;
mod response;

use std::f64::consts::PI;

#[doc(no_inline)]
pub use crate::friction::Iwan4;
pub use response::SymmetricResponse;

/// Energy that the element dissipates in one cycle between the displacements −A and A: the area of
/// the hysteresis loop.
///
/// It is 4F_s(A − F_s/k_t), with the stiffness k_t and the limit F_s of the element. For A ≤
/// F_s/k_t it is 0, because the slider does not move. Exact, in units of force times displacement.
/// NaN unless all three arguments are positive and finite.
///
/// ```
/// use stick_slip::analysis::jenkins::loop_area;
///
/// assert_eq!(loop_area(2.0, 3.0, 5.0), 42.0);
/// assert_eq!(loop_area(2.0, 3.0, 1.5), 0.0);
/// ```
#[doc(alias = "dissipation")]
pub fn loop_area(tangential_stiffness: f64, limit: f64, amplitude: f64) -> f64 {
    if !are_positive(&[tangential_stiffness, limit, amplitude]) {
        return f64::NAN;
    }
    // In this sequence a large limit does not overflow beside an amplitude below the first slip.
    4.0 * (limit * (amplitude - limit / tangential_stiffness).max(0.0))
}

/// The first harmonic of the force of the element under a harmonic displacement.
///
/// The displacement is x = A cos ωt, and the result is the triple (k_eq, c_eq, D). The force of a
/// spring of stiffness k_eq plus that of a damper of constant c_eq is the first harmonic. D is the
/// energy dissipated in one cycle ([`loop_area`]). k_t is the stiffness and F_s the limit of the
/// element. Any consistent units may be used.
///
/// ```text
/// cos θ = 1 − 2F_s/(k_t A),    D = 4F_s(A − F_s/k_t)
/// k_eq = (k_t/π)(θ − ½ sin 2θ),    c_eq = D/(πωA²)
/// ```
///
/// For A ≤ F_s/k_t the result is (k_t, 0, 0). The harmonic itself is exact; using it in place of
/// the force is an approximation. All three results are NaN unless all four arguments are positive
/// and finite.
///
/// ```
/// use std::f64::consts::PI;
/// use stick_slip::analysis::jenkins::first_harmonic;
///
/// // D/A² is largest at A = 2F_s/k_t, twice the amplitude at which slip begins.
/// let (stiffness, damping, loss) = first_harmonic(3.0, 6.0, 4.0, 0.5);
/// assert!((stiffness - 1.5).abs() < 1e-15);
/// assert!((damping - 48.0 / (PI * 0.5 * 16.0)).abs() < 1e-15);
/// assert_eq!(loss, 48.0);
/// assert_eq!(first_harmonic(3.0, 6.0, 2.0, 0.5), (3.0, 0.0, 0.0));
/// ```
#[doc(alias = "harmonic_balance")]
pub fn first_harmonic(
    tangential_stiffness: f64,
    limit: f64,
    amplitude: f64,
    angular_frequency: f64,
) -> (f64, f64, f64) {
    let loss = loop_area(tangential_stiffness, limit, amplitude);
    if loss.is_nan() || !are_positive(&[angular_frequency]) {
        return (f64::NAN, f64::NAN, f64::NAN);
    }
    // sin²(θ/2), at most 1.
    let part = limit / tangential_stiffness / amplitude;
    if part >= 1.0 {
        return (tangential_stiffness, 0.0, 0.0);
    }
    let angle = 4.0 * part.sqrt().asin();
    let stiffness = tangential_stiffness * (angle_without_sine(angle) / (2.0 * PI));
    let damping = 4.0 / PI * (limit * (1.0 - part) / amplitude) / angular_frequency;
    (stiffness, damping, loss)
}

/// x − sin x for 0 ≤ x ≤ 2π, without cancellation.
fn angle_without_sine(x: f64) -> f64 {
    if x > 1.0 {
        return x - x.sin();
    }
    let square = x * x;
    let terms = (1..10).rev().map(f64::from);
    let sum = terms.fold(1.0, |sum, k| {
        1.0 - sum * square / ((2.0 * k + 2.0) * (2.0 * k + 3.0))
    });
    x * square / 6.0 * sum
}

/// A point of a backbone curve: the free vibration at one amplitude, with the force of the element
/// replaced by its first harmonic.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Backbone {
    /// Angular frequency ω, in radians per unit of time.
    pub angular_frequency: f64,
    /// Damping ratio ζ, dimensionless.
    pub damping_ratio: f64,
}

/// The point at one amplitude of the backbone curve of a mass with a damper, a spring and a Jenkins
/// element in parallel.
///
/// The mass is m, the damper c, the spring k, and the amplitude A; the element has the stiffness
/// k_t and the limit F_s. The first-harmonic approximation, with k_eq and c_eq of
/// [`first_harmonic`], is
///
/// ```text
/// mω² = k + k_eq(A),   ζ = (c + c_eq(A))/(2mω)
/// ```
///
/// A negative damping that cancels c + c_eq makes the vibration periodic (extended periodic motion
/// concept). A force of amplitude ω(c + c_eq)A maintains the vibration at phase resonance. `None`
/// unless m, k_t, F_s and A are positive, c ≥ 0 and k ≥ 0, all finite.
///
/// Source: M. Krack, *Nonlinear modal analysis of nonconservative systems: extension of the
/// periodic motion concept*, Computers & Structures 154 (2015) 59-71.
///
/// ```
/// use stick_slip::analysis::jenkins::backbone;
///
/// let stuck = backbone(1.0, 0.02, 0.6, 0.4, 0.3, 0.5).unwrap();
/// assert_eq!(stuck.angular_frequency, 1.0);
/// assert!((stuck.damping_ratio - 0.01).abs() < 1e-17);
/// let slipping = backbone(1.0, 0.02, 0.6, 0.4, 0.3, 1.5).unwrap();
/// assert!((slipping.angular_frequency.powi(2) - 0.8).abs() < 1e-15);
/// ```
pub fn backbone(
    mass: f64,
    damping: f64,
    stiffness: f64,
    tangential_stiffness: f64,
    limit: f64,
    amplitude: f64,
) -> Option<Backbone> {
    if !(are_positive(&[mass]) && damping >= 0.0 && stiffness >= 0.0) {
        return None;
    }
    let at = |frequency| first_harmonic(tangential_stiffness, limit, amplitude, frequency);
    let (added, ..) = at(1.0);
    let angular_frequency = ((stiffness + added) / mass).sqrt();
    let (_, damper, _) = at(angular_frequency);
    let damping_ratio = 0.5 * (damping + damper) / mass / angular_frequency;
    let is_finite = angular_frequency.is_finite() && damping_ratio.is_finite();
    is_finite.then_some(Backbone {
        angular_frequency,
        damping_ratio,
    })
}

/// The forces along a history of displacements, by Masing's rules: one force for each displacement.
///
/// `backbone` is the force F(x) of the first loading; it must be odd. The forces have the unit of
/// F.
///
/// The history starts at displacement 0 and force 0, and the displacement changes monotonically
/// from each value to the next. The rules below are exact for any number of Jenkins elements in
/// parallel with constant limits. T is the force at the displacement x; the upper sign holds for
/// rising x.
///
/// ```text
/// first loading:   T = F(x)
/// after a reversal at (x_r, T_r):   T = T_r ± 2F(|x − x_r|/2)
/// ```
///
/// After a closed loop, the curve that the loop interrupted continues as if there had been no loop;
/// this holds also for the first loading. The area of a closed loop between −A and A is
/// D = 8∫F dx − 4A F(A), integrated over 0 ≤ x ≤ A. `None` unless all displacements and all forces
/// are finite.
///
/// ```
/// use stick_slip::Iwan4;
/// use stick_slip::analysis::jenkins::masing;
///
/// // k_t = 2, F_s = 3
/// let jenkins = |x: f64| (2.0 * x).clamp(-3.0, 3.0);
/// let forces = masing(jenkins, &[0.0, 5.0, 3.5, 2.0, -5.0, -3.5, -2.0, 0.0]);
/// assert_eq!(forces.unwrap(), [0.0, 3.0, 0.0, -3.0, -3.0, 0.0, 3.0, 3.0]);
///
/// let joint = Iwan4::new(3.0, 2.0, -0.1, 0.1)?;
/// // A small loop does not change the force at the end of the large loop.
/// let forces = masing(|x| joint.backbone(x), &[1.0, 0.6, 0.8, 0.2, 1.0]).unwrap();
/// assert_eq!(forces[4], joint.backbone(1.0));
/// # Ok::<(), stick_slip::Error>(())
/// ```
pub fn masing(backbone: impl Fn(f64) -> f64, displacements: &[f64]) -> Option<Vec<f64>> {
    if !displacements.iter().all(|x| x.is_finite()) {
        return None;
    }
    // Turns whose loops are open, the outermost first.
    let mut turns: Vec<[f64; 2]> = Vec::new();
    let mut last = [0.0, 0.0];
    let mut rises = None;
    let forces = displacements.iter().map(|&x| {
        if x == last[0] {
            return Some(last[1]);
        }
        let now_rises = x > last[0];
        if rises.is_some_and(|rises| rises != now_rises) {
            turns.push(last);
        }
        rises = Some(now_rises);
        let is_past = |end: f64| if now_rises { x >= end } else { x <= end };
        // The branch from the last turn ends where its loop closes: at the turn before, or, if
        // there is none, at minus the displacement of the last turn.
        while let Some(&[turn, _]) = turns.last() {
            let before = turns.len().checked_sub(2).map(|i| turns[i][0]);
            if !is_past(before.unwrap_or(-turn)) {
                break;
            }
            turns.truncate(turns.len().saturating_sub(2));
        }
        let force = match turns.last() {
            None => backbone(x),
            Some(&[turn, at_turn]) => {
                // Half of each, so that the distance does not overflow.
                at_turn + 2.0 * backbone(0.5 * x - 0.5 * turn)
            }
        };
        last = [x, force];
        force.is_finite().then_some(force)
    });
    forces.collect()
}

fn are_positive(numbers: &[f64]) -> bool {
    numbers.iter().all(|&x| x > 0.0 && x.is_finite())
}
