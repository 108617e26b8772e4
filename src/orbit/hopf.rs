//! Steady sliding along a parameter: its changes of stability, and the periodic motions that are
//! born at them.

use std::f64::consts::{FRAC_PI_2, TAU};
use std::ops::Range;

use nalgebra::DVector;
use num_complex::Complex;

use super::branch::BranchPoint;
use super::branch_equations::Curve;
use super::hopf_point::{hopf_point, spectrum};
use super::oscillator::{Oscillator, Systems};
use super::period::Period;
use super::period_map::vector;
use super::phase_condition::{FrozenStart, PhaseCondition};
use super::pseudo_arclength::natural_scale;
use super::shooting_residual::TrialMotion;
use super::translation::Turning;
use super::type_erased_system::GeneralForm;
use crate::error::Error;
use crate::motion::{AttractorKind, Mode};
use crate::numerics::bracket::{Bracket, border};
use crate::numerics::eigenvalues::{balance, eigenvectors};
use crate::numerics::trace::Plane;
use crate::search::Search;
use crate::state::structure::State;
use crate::structure::sliding_field::SlidingField;
use crate::structure::sliding_field::spectrum::Spectrum;

/// Amplitudes of the first motion, in units of the sliding velocities (and of the memory
/// variables).
const AMPLITUDES: [f64; 4] = [0.3, 0.1, 0.03, 0.01];

/// Largest amplitude of the first motion, in units of the displacements in steady sliding.
const DISPLACED: f64 = 0.1;

/// The eigenvalues at a value of the parameter.
fn spectrum_at<S: Oscillator>(
    family: &Systems<'_, S>,
    parameter: f64,
) -> Result<Vec<Complex<f64>>, Error> {
    let of = "orbit::begin";
    let checked = Error::check(of, "parameter", parameter, true, "a number")?;
    let find = || Ok(spectrum(&family(checked)?.form())?.values);
    find().map_err(|error: Error| error.at("parameter", parameter))
}

/// A value of the parameter at which steady sliding changes its stability.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Crossing {
    pub(super) parameter: f64,
    /// The angular frequency of the eigenvalue there: 0 at a static instability.
    pub(super) frequency: f64,
}

/// The equilibrium of a system with all masses at rest: contacts on surfaces that move slide, and
/// the others stick.
pub(super) struct Standing {
    spectrum: Spectrum,
    /// The contacts that stick.
    sticking: Vec<usize>,
    /// True if no contact slides.
    rests: bool,
    /// True if the eigenvalues are those of one equilibrium of a continuum only.
    is_one_of_many: bool,
}

impl Standing {
    /// `None` if there is no such equilibrium.
    pub(super) fn of(form: &GeneralForm<'_>) -> Option<Self> {
        let field = SlidingField::standing(form.model()).ok()?;
        let mut surfaces = form.model().contacts.iter();
        Some(Self {
            spectrum: field.eigenvalues()?.0,
            sticking: field.sticking(),
            rests: surfaces.all(|contact| contact.belt_velocity.value(0.0) == 0.0),
            is_one_of_many: field.is_one_of_many(),
        })
    }

    fn kind(&self) -> AttractorKind {
        if self.rests {
            AttractorKind::Rest
        } else {
            AttractorKind::SteadySliding
        }
    }

    /// Returns true if the eigenvalues are those of all equilibria of this kind.
    pub(super) fn is_only_one(&self) -> bool {
        !self.is_one_of_many
    }

    /// Returns true if no equilibrium of this kind attracts.
    pub(super) fn repels(&self) -> bool {
        self.spectrum.growing > 0 && self.is_only_one()
    }
}

/// Steady sliding, or rest, along a range of a parameter.
#[derive(Debug, Default)]
pub(super) struct SteadyAlong {
    pub(super) crossings: Vec<Crossing>,
    /// Ranges in which it is stable, and its kind.
    pub(super) stable: Vec<(Range<f64>, AttractorKind)>,
}

/// The facts by which equilibria along a parameter differ: which contacts stick, the kind, and the
/// number of eigenvalues in the right half plane.
type Facts = Option<(Vec<usize>, AttractorKind, usize)>;

/// The stability of steady sliding along a range, from its values at places and refined between
/// them. Where there is no steady sliding, it is not stable. Contacts on surfaces at rest stick.
pub(super) fn steady_along<S: Oscillator>(family: &Systems<'_, S>, places: &[f64]) -> SteadyAlong {
    let mut along = SteadyAlong::default();
    let at = |parameter: f64| Standing::of(&family(parameter).ok()?.form());
    let facts = |parameter: f64| -> Facts {
        let found = at(parameter)?;
        let kind = found.kind();
        Some((found.sticking, kind, found.spectrum.growing))
    };
    let spectrum = |parameter: f64| Some(at(parameter)?.spectrum.values);
    let mut add = |from: f64, to: f64, facts: &Facts| {
        let Some((_, kind, 0)) = facts else {
            return;
        };
        match along.stable.last_mut() {
            Some((last, of)) if last.end == from && of == kind => last.end = to,
            _ if from < to => along.stable.push((from..to, *kind)),
            _ => {}
        }
    };
    let known = places.iter().map(|&place| (place, facts(place)));
    let known: Vec<(f64, Facts)> = known.collect();
    for pair in known.windows(2) {
        let [mut low, high] = [pair[0].clone(), pair[1].clone()];
        // One eigenvalue, or pair of them, after the other.
        while low.1 != high.1 {
            let of = |facts: &Facts| facts.as_ref().map(|facts| (facts.0.clone(), facts.1));
            let found = match (&low.1, &high.1) {
                (Some((sticking, kind, from)), Some((_, _, to))) if of(&low.1) == of(&high.1) => {
                    let found = sign_change(&spectrum, (low.0, high.0), (*from, *to));
                    found.map(|(place, count, crossing)| {
                        (
                            place,
                            Some((sticking.clone(), *kind, count)),
                            Some(crossing),
                        )
                    })
                }
                _ => {
                    // Steady sliding begins or ends to exist, or other contacts stick.
                    let is_same = |place: f64| of(&facts(place)) == of(&low.1);
                    let place = border(low.0, high.0, is_same)[1];
                    Some((place, high.1.clone(), None))
                }
            };
            let Some((parameter, behind, crossing)) = found else {
                break;
            };
            add(low.0, parameter, &low.1);
            along.crossings.extend(crossing);
            low = (parameter, behind);
        }
        add(low.0, high.0, &low.1);
    }
    along
}

type SpectrumAt<'s> = dyn Fn(f64) -> Option<Vec<Complex<f64>>> + 's;

/// The place at which one more or one less eigenvalue is unstable, the number of unstable ones
/// behind it, and the crossing.
fn sign_change(
    at: &SpectrumAt<'_>,
    (low, high): (f64, f64),
    (from, to): (usize, usize),
) -> Option<(f64, usize, Crossing)> {
    // The real part of the eigenvalue of this rank changes its sign.
    let rank = if from < to { from } else { from - 1 };
    let real = |parameter: f64| Some(at(parameter)?.get(rank)?.re);
    let mut bracket = Bracket::new((low, real(low)?), (high, real(high)?));
    let mut parameter = high;
    while let Some(place) = bracket.next_place() {
        parameter = place;
        let value = real(place)?;
        bracket.narrow(place, value);
        if value == 0.0 {
            break;
        }
    }
    let frequency = at(parameter)?.get(rank)?.im.abs();
    let step = if frequency > 0.0 { 2 } else { 1 };
    let behind = if from < to {
        (from + step).min(to)
    } else {
        from.saturating_sub(step).max(to)
    };
    let crossing = Crossing {
        parameter,
        frequency,
    };
    Some((parameter, behind, crossing))
}

/// A small periodic motion near a Hopf point of steady sliding. [`follow`](super::follow())
/// continues this motion to its branch: in one direction down to the Hopf point, in the other to
/// larger motions, such as stick-slip.
///
/// `family` returns the system for a value of the parameter. `near` is a value of the parameter
/// near the Hopf point. At this value a pair of eigenvalues s of steady sliding must lie near the
/// imaginary axis: |Re s| ≤ 0.2 |Im s|. First the Hopf point itself is computed: the parameter p0,
/// with eigenvalues ±iω. Let x_s be the state of steady sliding at p0, and A the Jacobian matrix
/// there. Let q and u be the right and left eigenvectors of A: Aq = iωq, Aᵀu = −iωu, and ūᵀq = 1
/// with the complex conjugate ū of u. Newton's method finds the start x(0), the period T and the
/// parameter p of the motion. The first guess is p = p0 and
///
/// ```text
/// x(0) = x_s + 2ε Re(q e^{iφ}),    T = 2π/ω.
/// ```
///
/// Newton's method keeps the start on the plane Re(u e^{iφ})ᵀ(x − x_s) = ε. The result satisfies Re
/// s(p) + ω l1 ε² ≈ 0, where s(p) is the eigenvalue at p, and l1 is the first Lyapunov coefficient.
/// The phase φ is chosen so that one coordinate is at a turning point at time 0. The amplitude ε is
/// chosen so that the relative velocity of each contact varies by at most 0.3 of its value in
/// steady sliding, and each displacement by at most a tenth of the largest displacement in steady
/// sliding. If no motion is found, smaller values of ε are tried.
///
/// Contacts on surfaces at rest, and joints between masses, stick in steady sliding. A rigid one
/// then is a constraint (b·δq = 0), and an elastic one a spring of stiffness k_t. The amplitude is
/// chosen so that their forces vary by at most 0.3 of their distance from the limits of stick.
/// These contacts could stick elsewhere, too: the steady sliding is that of
/// [`Structure::steady_sliding_at`](crate::Structure::steady_sliding_at) with all velocities 0, and
/// what they alone hold has b·q = 0.
///
/// The motion is stable if l1 < 0 and no other eigenvalue is in the right half plane
/// ([`HopfPoint`](crate::bifurcation::HopfPoint) contains l1). If friction is constant (Coulomb's
/// law) or linear in the sliding speed, and no contact sticks, small periodic motions exist at p0
/// only and form a continuum. One of these motions is returned. The branch of motions at other
/// parameters begins with the motion whose largest velocity equals the belt velocity.
///
/// Source: Kuznetsov, *Elements of Applied Bifurcation Theory*, sections 3.4, 5.4 and 10.2.
///
/// # Errors
///
/// * [`Error::InvalidParameter`] unless `near` is finite;
/// * [`Error::At`], with the value of the parameter, if the family returns an error, if there is no
///   steady sliding ([`Error::NoSteadySliding`]), or if no periodic motion is found;
/// * [`Error::At`] with [`Error::NoHopfPoint`], if no pair of eigenvalues is near the imaginary
///   axis at `near`, or if no pair crosses this axis near this value.
///
/// ```
/// use stick_slip::orbit::{self, AttractorKind, BranchEnd};
/// use stick_slip::{Contact, Error, Exponential, Structure};
///
/// // A mass on a belt: steady sliding is neutral at the damping 0.1 = −dμ̂/ds, near v_b = 0.74.
/// let mass = |velocity: f64| -> Result<Structure, Error> {
///     let law = Exponential::new(0.4, 0.25, 0.5)?;
///     Structure::new(&[1.0])?
///         .with_ground_spring(0, 1.0)?
///         .with_ground_damper(0, 0.1)?
///         .with_contact(Contact::new(0, law, 1.0)?.on_belt(velocity))
/// };
/// let born = orbit::begin(mass, 0.74)?;
/// // Above v_b = √(3/2)·0.5 the bifurcation is subcritical: the motion that is born is unstable.
/// assert!(born.parameter > 0.738553461542470176 && !born.orbit.is_stable());
///
/// let branch = orbit::follow(mass, born.parameter, &born.orbit, 0.5..1.0)?;
/// let hopf = branch.ends.iter().find_map(|end| match end {
///     BranchEnd::Hopf { parameter } => Some(*parameter),
///     _ => None,
/// });
/// assert!((hopf.unwrap() - 0.738553461542470176).abs() < 1e-14);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[doc(alias = "Hopf")]
#[doc(alias = "flutter")]
pub fn begin<S: Oscillator>(
    family: impl Fn(f64) -> Result<S, Error>,
    near: f64,
) -> Result<BranchPoint<S::State>, Error> {
    Search::new().begin(family, near)
}

impl Search<'_> {
    /// Calls the function [`begin`] with the watcher of this search.
    ///
    /// # Errors
    ///
    /// The errors of [`begin`]; [`Error::Stopped`] if the watcher stops the search.
    pub fn begin<S: Oscillator>(
        &self,
        family: impl Fn(f64) -> Result<S, Error>,
        near: f64,
    ) -> Result<BranchPoint<S::State>, Error> {
        let unit = if near == 0.0 { 1.0 } else { near.abs() };
        let (parameter, frequency) = hopf_point(&|value| spectrum_at(&family, value), near, unit)?;
        let system = family(parameter).map_err(|error| error.at("parameter", parameter))?;
        let form = system.form();
        let born = Born::of(&form, frequency).map_err(|error| error.at("parameter", parameter))?;
        let range = parameter - 0.1 * unit..parameter + 0.1 * unit;
        let kind = Period::Free(TAU / frequency);
        let (parameter, trial) = self.over(&family, kind, range, |curve| {
            born.motion(&form, curve, parameter)
        })?;
        BranchPoint::of(&family, parameter, trial, kind)
    }
}

/// A motion that is born at a Hopf point, to first order.
struct Born {
    steady: State,
    modes: Vec<Mode>,
    /// The coordinate that turns at the start.
    turning: usize,
    /// 2 Re(q e^{iφ}) and Re(u e^{iφ}).
    way: DVector<f64>,
    normal: DVector<f64>,
    /// The largest distance ε for an amplitude of 1 in units of the sliding velocities and of what
    /// contacts that stick can carry, and its limit from the displacements.
    reach: f64,
    most: f64,
    frequency: f64,
}

impl Born {
    fn of(form: &GeneralForm<'_>, frequency: f64) -> Result<Self, Error> {
        let field = SlidingField::standing(form.model())?;
        let mut matrix = field.jacobian().ok_or(Error::NoHopfPoint)?;
        let units = balance(&mut matrix);
        let n = form.len();
        let vectors = eigenvectors(&matrix, Complex::new(0.0, frequency));
        let [u, q] = vectors.ok_or(Error::NoHopfPoint)?;
        let q = q.zip_map(&units, |x, unit| x * unit);
        let u = u.zip_map(&units, |x, unit| x / unit);
        let u = &u / u.dotc(&q).conj();
        let turning = q.rows(n, n).map(|v| v.norm()).argmax().0;
        let turn = Complex::cis(FRAC_PI_2 - q[n + turning].arg());
        let steady = field.state();
        let model = form.model();
        // The others stick, are open or have no friction.
        let moves = |c: &usize| model.contacts[*c].belt_velocity.value(0.0) != 0.0;
        let moving: Vec<usize> = (0..form.contacts()).filter(moves).collect();
        let slides = moving.iter().map(|&c| {
            let contact = &model.contacts[c];
            let varies = contact.direction.iter().map(|&(j, b)| q[n + j] * b);
            let velocity = contact.belt_velocity.value(0.0).abs();
            velocity / (2.0 * varies.sum::<Complex<f64>>().norm())
        });
        let forces = field.held_forces(&q).ok_or(Error::NoHopfPoint)?;
        let sticks = std::iter::zip(&field.held, forces);
        let sticks = sticks.map(|(held, force)| held.margin / (2.0 * force));
        let remembered = moving.iter().flat_map(|&c| model.memory(c));
        let remembered = remembered.map(|j| (steady.memory[j], q[2 * n + j]));
        let remembered = remembered.filter(|(z, _)| *z != 0.0);
        let remembered = remembered.map(|(z, q)| z.abs() / (2.0 * q.norm()));
        let reach = slides.chain(sticks).chain(remembered);
        let reach = reach.fold(f64::INFINITY, f64::min);
        let displaced = steady.displacements.iter().map(|x| x.abs());
        let displaced = displaced.fold(0.0, f64::max);
        let moves = q.rows(0, n).map(|x| x.norm()).max();
        let most = if displaced > 0.0 {
            DISPLACED * displaced / (2.0 * moves)
        } else {
            f64::INFINITY
        };
        Ok(Self {
            steady,
            modes: field.modes(),
            turning,
            way: q.map(|x| 2.0 * (x * turn).re),
            normal: u.map(|x| (x * turn).re),
            reach,
            most,
            frequency,
        })
    }

    /// A small motion, and its parameter.
    fn motion(
        &self,
        form: &GeneralForm<'_>,
        mut curve: Curve<'_>,
        parameter: f64,
    ) -> Result<(f64, TrialMotion), Error> {
        (curve.n, curve.order) = (self.steady.displacements.len(), self.way.len());
        curve.weigh(form);
        let (order, last) = (curve.order, curve.unknowns() - 1);
        let steady = vector(&self.steady, order);
        let unit = DVector::from_element(order, 1.0);
        let turning = Turning::of(self.turning);
        let begin = FrozenStart {
            modes: self.modes.clone(),
            condition: Some(PhaseCondition::of_turning(turning, 1.0, &unit, curve.n)),
            ..FrozenStart::at_zero()
        };
        let mut failure = Error::NoHopfPoint.at("parameter", parameter);
        for amplitude in AMPLITUDES {
            let away = (amplitude * self.reach).min(self.most);
            if !away.is_finite() {
                break;
            }
            let start = &steady + &self.way * away;
            let solve = || {
                let guess = (TAU / self.frequency, parameter);
                let mut near = curve.guess(&start, guess, begin.clone())?;
                near.begin.modes = near.trial.map.end_modes().to_vec();
                let scale = natural_scale(&curve, &near);
                let mut normal = DVector::zeros(last + 1);
                let mut along = normal.clone();
                normal.rows_mut(0, order).copy_from(&self.normal);
                normal.component_mul_assign(&scale);
                along.rows_mut(0, order).copy_from(&self.way);
                along.component_div_assign(&scale);
                let plane = Plane {
                    value: self.normal.dot(&steady) + away,
                    scale: &scale,
                    normal,
                    along: &along,
                };
                curve.solve(&near.y, &near, &plane)
            };
            match solve() {
                Ok(found) => return Ok((curve.parameter(&found.y), found.trial)),
                Err(error) => failure = error,
            }
        }
        Err(failure)
    }
}
