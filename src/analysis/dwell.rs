//! Static friction that rises during stick, with constant kinetic friction: stick-slip cycles of
//! one mass, with the conditions for their existence and stability.
//!
//! The system is a mass m with a spring k and a damper c, pressed by the load N on a belt of
//! velocity v. Let F_s(θ) = N μ_s(θ), where θ is the duration of stick, and F_k = N μ_k. Without
//! damping, successive durations of stick θ_n follow a return map. Its fixed point θ* is the
//! duration of stick in the stick-slip cycle. Primes are derivatives with respect to θ.
//!
//! ```text
//! return map    k v θ_{n+1} = [F_s(θ_n) − F_k] + [F_s(θ_{n+1}) − F_k]
//! fixed point   F_s(θ*) − F_k = k v θ*/2
//! multiplier    F_s'(θ*)/(kv − F_s'(θ*)),   stable if F_s'(θ*) < kv/2
//! slip          (2/ω)(π − atan(ω θ*/2)),    ω = √(k/m)
//! release       at displacement F_k/k + z*,  z* = v θ*/2;   amplitude √(z*² + v²/ω²)
//! ```
//!
//! F_s is a concave function of θ, so there is at most one cycle, and it is stable. If static
//! friction begins at F_s(0) = F_k, the cycle exists if F_s'(0) > kv/2 (Gao's criterion), that is
//! for belt velocities below **v_c = 2 F_s'(0)/k**. In the following table ΔF = N(μ_∞ − μ_0) and
//! F_0 = N(μ_0 − μ_k), with the constants μ_0, μ_∞, θ_c and B of the law [`Dwell`]:
//!
//! | form of μ_s(θ) | v_c for F_0 = 0 | θ* |
//! |---|---|---|
//! | hyperbolic | 2ΔF/(kθ_c) | for F_0 = 0: 2ΔF/(kv) − θ_c, so that z* = ΔF/k − vθ_c/2 is linear in v |
//! | exponential | 2ΔF/(kθ_c) | θ_c[a/q + W0(−e^{−a/q}/q)], q = kvθ_c/(2ΔF), a = 1 + F_0/ΔF |
//! | logarithmic | 2NB/(kθ_c) | −θ_c[1 + W−1(−q e^{−q−a})/q], q = kvθ_c/(2NB), a = F_0/(NB) |
//!
//! W0 and W−1 are the branches of Lambert's function.
//!
//! With damping, the slip phase is a part of a damped vibration. In units of time 1/ω and length
//! v/ω, all possible slip phases form a family with one parameter, for example the duration of
//! slip. Each slip phase of the family belongs to one duration of stick θ and to one belt velocity
//! v. The cycles therefore form a curve in the plane of θ and v, which is known in closed form.
//! Along the curve v has one maximum, the fold, at which a stable and an unstable cycle meet.
//!
//! At the lowest belt velocity of the unstable cycle, the mass reaches the belt velocity
//! tangentially at the end of slip. Let Λ be the factor of
//! [`coulomb::tangential_slip`](super::coulomb::tangential_slip) for the damping ratio c/(2√(km)).
//! The duration of stick is then θ_g = 1/(Λω), and the belt velocity N(μ_s(θ_g) − μ_k)Λω/k.
//!
//! Source: C. Gao, D. Kuhlmann-Wilsdorf, D. D. Makel, *The dynamic analysis of stick-slip motion*,
//! Wear 173 (1994) 1-12, for the criterion; the other formulas follow from the exact solution of
//! the equations of stick and slip, which are linear.

pub use super::slip_arc::ExactCycle;
use super::slip_arc::tangential_angle;
use super::slip_arc::{Oscillator, SlipArc};
use crate::error::Error;
use crate::friction::memory::Dwell;
use crate::friction::{Coulomb, FrictionLaw};
use crate::numerics::bracket::root_between;

/// A mass with a spring and a damper on a belt, with static friction that rises during stick and
/// constant kinetic friction.
///
/// The page [`dwell`](self) has the formulas. μ_s(θ) is the static coefficient after the duration θ
/// of stick, μ_k the kinetic coefficient, and ω = √(k/m) the natural frequency. Any consistent
/// units may be used.
///
/// ```
/// use stick_slip::analysis::dwell::DwellOscillator;
/// use stick_slip::{Coulomb, Dwell};
///
/// // ΔF = 0.5, θ_c = 2.
/// let oscillator = DwellOscillator {
///     law: Dwell::hyperbolic(Coulomb::new(0.5, 0.5)?, 1.0, 2.0)?,
///     mass: 1.0,
///     stiffness: 1.0,
///     damping: 0.0,
///     load: 1.0,
/// };
/// assert_eq!(oscillator.critical_velocity(), Some(0.5)); // 2ΔF/(kθ_c)
/// let cycle = oscillator.stick_slip(0.2).ok_or("no stick-slip")?;
/// assert!((cycle.stick_duration - 3.0).abs() < 1e-14); // 2ΔF/(kv) − θ_c
/// assert!((cycle.slip_duration - 4.317597860685).abs() < 1e-12);
/// assert!((cycle.release_displacement - 0.8).abs() < 1e-15); // F_k/k + ΔF/k − vθ_c/2
/// assert_eq!(oscillator.stick_slip(0.6), None);
///
/// // Damping ends stick-slip at a fold; below it there is an unstable cycle, too.
/// let damped = DwellOscillator { damping: 0.05, ..oscillator };
/// let fold = damped.fold().ok_or("no fold")?;
/// assert!((fold.multiplier - 1.0).abs() < 1e-8);
/// let slower = 0.99 * fold.belt_velocity;
/// let [one, other] = [damped.stick_slip(slower), damped.unstable_stick_slip(slower)];
/// assert!(one.is_some_and(|cycle| cycle.is_stable()));
/// assert!(other.is_some_and(|cycle| cycle.multiplier > 1.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DwellOscillator {
    /// Friction law with μ_s(θ) and μ_k.
    pub law: Dwell<Coulomb>,
    /// Mass m > 0.
    pub mass: f64,
    /// Stiffness k > 0.
    pub stiffness: f64,
    /// Damping constant c ≥ 0.
    pub damping: f64,
    /// Normal load N > 0.
    pub load: f64,
}

/// Largest p that is searched: beyond it mass and spring do not matter.
const LARGEST: f64 = 1e150;

impl DwellOscillator {
    /// Belt velocity below which stick-slip exists without damping (Gao's criterion). Exact.
    ///
    /// This velocity is v_c = 2N μ_s'(0)/k, with the rate μ_s'(0) at which static friction rises at
    /// the beginning of stick.
    ///
    /// If μ_s(0) > μ_k, the result is ∞. `None` if the oscillator is damped (use
    /// [`fold`](Self::fold)), or if a field is out of its range.
    pub fn critical_velocity(&self) -> Option<f64> {
        self.oscillator().filter(|of| of.damping == 0.0)?;
        if self.jump() > 0.0 {
            return Some(f64::INFINITY);
        }
        let [_, rate] = self.law.rise(0.0);
        Some(2.0 * self.load * rate / self.stiffness)
    }

    /// The stable stick-slip cycle at the belt velocity v, exact. If v < 0, the result is the
    /// mirror image of the cycle at −v.
    ///
    /// `None` in these cases:
    /// * v = 0, or c ≥ 2√(km);
    /// * without damping: |v| is [`critical_velocity`](Self::critical_velocity) or more;
    /// * with damping: |v| is above the [`fold`](Self::fold);
    /// * the mass overtakes the belt: to stick at the end of slip, it would need a friction force
    ///   above N·μ_s(0), opposite to the force at the release. This happens only if static friction
    ///   rises far above N·μ_s(0);
    /// * a field is out of its range, a number of the cycle overflows, or stick lasts longer than
    ///   about 10¹⁵⁰/ω.
    pub fn stick_slip(&self, velocity: f64) -> Option<ExactCycle> {
        let of = self.oscillator()?;
        let least = match self.fold_arc(&of) {
            Some(fold) => fold,
            None => tangential(&of),
        };
        let excess = |p: f64| self.excess(&of, velocity.abs(), p);
        // `excess` is positive at `least` where there is a cycle, and negative for large p.
        let mut low = least;
        let mut high = least.max(1.0);
        if least == 0.0 {
            low = 1.0;
            while excess(low) <= 0.0 {
                (low, high) = (0.5 * low, low);
                if low < f64::MIN_POSITIVE {
                    return None;
                }
            }
        }
        while excess(high) > 0.0 {
            (low, high) = (high, 2.0 * high);
            if high > LARGEST {
                return None;
            }
        }
        self.cycle_between(&of, velocity, low, high)
    }

    /// The unstable stick-slip cycle at the belt velocity v, exact. This cycle separates the starts
    /// that lead to the stable cycle from those that do not. It exists only with damping, between
    /// [`grazing_velocity`](Self::grazing_velocity) and the [`fold`](Self::fold). `None` in the
    /// cases listed at [`stick_slip`](Self::stick_slip), or if rounding cannot separate the cycle
    /// from the fold. If static friction has almost reached its limit at the release, the range of
    /// belt velocities from grazing to fold can be narrower than rounding errors. With the
    /// exponential form, damping ratio 0.77 and ωθ_c = 1, for example, this range is narrower than
    /// 10⁻⁹⁰ of the belt velocity.
    pub fn unstable_stick_slip(&self, velocity: f64) -> Option<ExactCycle> {
        let of = self.oscillator()?;
        let fold = self.fold_arc(&of)?;
        let cycle = self.cycle_between(&of, velocity, tangential(&of), fold);
        cycle.filter(|cycle| cycle.multiplier > 1.0)
    }

    /// The cycle at the fold. The fold is the largest belt velocity with a cycle; there the stable
    /// and the unstable cycle meet. The belt velocity is exact. The multiplier is 1 within
    /// 3·10⁻¹⁵(1 + ωv/a), where v is the belt velocity and a the acceleration of the mass at the
    /// end of slip. If static friction has almost reached its limit at the release, a is smaller
    /// than rounding errors, and the multiplier is undetermined.
    ///
    /// `None` without damping (there is no unstable cycle), if static friction does not rise, if c
    /// ≥ 2√(km), if the mass overtakes the belt (see [`stick_slip`](Self::stick_slip)), if a field
    /// is out of its range, or if a number of the cycle overflows.
    pub fn fold(&self) -> Option<ExactCycle> {
        let of = self.oscillator()?;
        let p = self.fold_arc(&of)?;
        self.cycle(&of, self.velocity(&of, p), p)
    }

    /// The belt velocity down to which an unstable cycle exists. Exact.
    ///
    /// At this velocity the mass reaches the belt velocity tangentially at the end of slip. The
    /// page [`dwell`](self) has the formula. `None` if there is no damping, if c ≥ 2√(km), if a
    /// field is out of its range, or if numbers overflow or underflow.
    pub fn grazing_velocity(&self) -> Option<f64> {
        let of = self.oscillator().filter(|of| of.damping > 0.0)?;
        let velocity = self.velocity(&of, tangential(&of));
        velocity.is_finite().then_some(velocity)
    }

    fn oscillator(&self) -> Option<Oscillator> {
        let &Self {
            law,
            mass,
            stiffness,
            damping,
            load,
        } = self;
        let positive = [mass, stiffness, load]
            .iter()
            .all(|&x| x > 0.0 && x.is_finite());
        let of = Oscillator {
            frequency: (stiffness / mass).sqrt(),
            damping: 0.5 * damping / (stiffness.sqrt() * mass.sqrt()),
            stiffness,
            kinetic: load * law.law().kinetic_coefficient(),
        };
        (positive && (0.0..1.0).contains(&of.damping)).then_some(of)
    }

    /// F_s(0) − F_k.
    fn jump(&self) -> f64 {
        let law = self.law.law();
        self.load * (law.static_coefficient() - law.kinetic_coefficient())
    }

    /// F_s(θ) − F_k after the stick phase that belongs to an arc, and its rate.
    fn risen(&self, of: &Oscillator, arc: &SlipArc) -> [f64; 2] {
        let [rise, rate] = self.law.rise(arc.rest() / of.frequency);
        [self.jump() + self.load * rise, self.load * rate]
    }

    /// The belt velocity of an arc.
    fn velocity(&self, of: &Oscillator, p: f64) -> f64 {
        let arc = SlipArc::new(of.damping, p);
        self.risen(of, &arc)[0] / arc.start * of.frequency / of.stiffness
    }

    /// F_s(θ) − F_k minus the force above F_k with which an arc begins, times ω.
    fn excess(&self, of: &Oscillator, velocity: f64, p: f64) -> f64 {
        let arc = SlipArc::new(of.damping, p);
        self.risen(of, &arc)[0] * of.frequency - of.stiffness * velocity * arc.start
    }

    /// The arc with the largest belt velocity, if it is not at an end of the range of arcs.
    ///
    /// F_s is a concave function of θ, and θ of the force at the release, so F_s is a concave
    /// function of this force. Their quotient, the belt velocity, has one maximum at most.
    fn fold_arc(&self, of: &Oscillator) -> Option<f64> {
        // The multiplier is 1.
        let beyond = |p: f64| {
            let arc = SlipArc::new(of.damping, p);
            let [force, rate] = self.risen(of, &arc);
            let held = force / arc.start * of.frequency;
            rate * (arc.stretched_arrival() - arc.arrival) + held * arc.arrival
        };
        let first = tangential(of);
        if first == 0.0 || beyond(first) >= 0.0 {
            return None;
        }
        let (mut low, mut high) = (first, 2.0 * first);
        while beyond(high) < 0.0 {
            (low, high) = (high, 2.0 * high);
            if high > LARGEST {
                return None;
            }
        }
        root_between(&mut |p| Ok(beyond(p)), low, high).ok()
    }

    fn cycle_between(
        &self,
        of: &Oscillator,
        velocity: f64,
        low: f64,
        high: f64,
    ) -> Option<ExactCycle> {
        let speed = velocity.abs();
        let mut excess = |p: f64| Ok::<f64, Error>(self.excess(of, speed, p));
        let changes = excess(low).ok()? * excess(high).ok()? <= 0.0;
        if !(changes && speed > 0.0) {
            return None;
        }
        let p = root_between(&mut excess, low, high).ok()?;
        let cycle = self.cycle(of, speed, p)?;
        let side = velocity.signum();
        Some(ExactCycle {
            belt_velocity: velocity,
            release_displacement: side * cycle.release_displacement,
            contact_displacement: side * cycle.contact_displacement,
            ..cycle
        })
    }

    /// The cycle with an arc, if the mass sticks at the end of the arc, and nothing overflows.
    fn cycle(&self, of: &Oscillator, velocity: f64, p: f64) -> Option<ExactCycle> {
        let arc = SlipArc::new(of.damping, p);
        let carried = of.kinetic - of.stiffness * velocity / of.frequency * arc.arrival;
        let sticks = -carried <= self.load * self.law.law().static_coefficient();
        let [_, growth] = self.risen(of, &arc);
        let cycle = arc.cycle(of, velocity, growth);
        let numbers = [
            cycle.belt_velocity,
            cycle.release_displacement,
            cycle.contact_displacement,
            cycle.amplitude,
            cycle.max_sliding_speed,
            cycle.period(),
        ];
        let is_known = numbers.iter().all(|x| x.is_finite()) && !cycle.multiplier.is_nan();
        (sticks && is_known).then_some(cycle)
    }
}

/// The arc that comes back to the belt tangentially; 0 without damping.
fn tangential(of: &Oscillator) -> f64 {
    tangential_angle(of.damping).map_or(0.0, |angle| (0.5 * angle).tan())
}
