//! Conversion from physical units to the dimensionless system and back, for any law.

use std::ops::Range;

use crate::belt::MassOnBelt;
use crate::error::{Digits, Error, Plain};
use crate::friction::{FrictionLaw, Scaled};
use crate::state::Units;

#[cfg(feature = "serde")]
mod read;

/// The physical parameters of a mass on a belt, in SI units.
///
/// ```text
/// M X'' + C X' + K X + N μ(X' − V) = 0
/// ```
///
/// X is the displacement, and μ the friction coefficient at the relative velocity X' − V.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct Physical {
    /// Mass M > 0, kg.
    pub mass: f64,
    /// Stiffness K > 0 of the spring, N/m.
    pub stiffness: f64,
    /// Damping constant C ≥ 0 of the damper, N·s/m.
    pub damping: f64,
    /// Normal force N > 0 between mass and belt, in newtons: N = M·9.81 m/s² for a mass that lies
    /// on a level belt.
    pub normal_force: f64,
    /// Belt velocity V, m/s. Its sign gives the direction.
    pub belt_velocity: f64,
}

/// The conversion from physical units to the dimensionless system, and back.
///
/// ```text
/// ω0 = √(K/M),   τ = ω0 t,   u = X/L,   v = X'/(ω0 L)
/// β = C/(2√(K M)),   γ² = N/(K L),   v_b = V/(ω0 L)
/// ```
///
/// M, C, K, N and V are the parameters in [`Physical`], X is the displacement and t the time. ω0 is
/// the natural frequency, τ the dimensionless time, u the displacement, v the velocity, β the
/// damping ratio, γ² the friction load and v_b the belt velocity. The unit of length L can be
/// chosen freely; physical results do not depend on it. The default, L = N/K, is the length by
/// which the normal force would stretch the spring; then γ² = 1.
///
/// The name of a method says what it returns: [`seconds`](Self::seconds) takes a dimensionless
/// time. An energy is a force times a length: `newtons(metres(energy))` joules.
/// [`PhysicalMassOnBelt`](crate::PhysicalMassOnBelt) uses SI units throughout and converts
/// internally.
///
/// A torsional oscillator is converted in the same way. Use the moment of inertia (kg·m²) as the
/// mass, radians instead of metres, and N·m instead of newtons. The normal force is replaced by the
/// product of normal force and friction radius, in N·m; the belt velocity and the speeds of the law
/// are replaced by angular velocities, in rad/s.
///
/// Source: Farshidianfar and Noei Aghaee, *Analytical Approaches for Friction Induced Vibration and
/// Stability Analysis*, Eq. 1; J. J. Thomsen, A. Fidlin, *Analytical approximations for stick-slip
/// vibration amplitudes*, Int. J. Non-Linear Mech. 38 (2003) 389-403.
///
/// ```
/// use stick_slip::{Physical, Scaling, State, Stribeck};
///
/// let scaling = Scaling::new(Physical {
///     mass: 2.0,           // kg
///     stiffness: 5000.0,   // N/m
///     damping: 4.0,        // N·s/m
///     normal_force: 20.0,  // N
///     belt_velocity: 0.05, // m/s
/// })?;
/// assert_eq!(scaling.angular_frequency(), 50.0); // rad/s
/// assert_eq!(scaling.length(), 0.004); // m
///
/// // The law is given in m/s.
/// let system = scaling.system(Stribeck::new(0.4, 0.25, 0.1, 1)?)?;
/// assert_eq!(system.load(), 1.0);
/// assert!((system.damping() - 0.02).abs() < 1e-17);
/// assert!((system.belt_velocity() - 0.25).abs() < 1e-16);
///
/// let release = system.release_state().unwrap();
/// // (N μ_s − C V)/K
/// assert!((scaling.metres(release.displacement) - (8.0 - 0.2) / 5000.0).abs() < 1e-17);
/// assert_eq!(scaling.metres_per_second(release.velocity), 0.05);
///
/// let motion = system.simulate(State::new(0.0, 0.0), scaling.angular_frequency())?; // 1 s
/// let milliseconds = 1e3 * scaling.seconds(motion.events()[0].time);
/// assert!((milliseconds - 15.0966).abs() < 1e-4);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "read::Scaling")
)]
pub struct Scaling {
    physical: Physical,
    length: f64,
    /// Angular frequency ω0, rad/s.
    #[cfg_attr(feature = "serde", serde(skip_serializing))]
    angular_frequency: f64,
}

impl Scaling {
    /// Creates the scaling with the length L = N/K, for which γ² = 1.
    ///
    /// # Errors
    ///
    /// [`Error::InvalidParameter`] unless all parameters are finite and in the ranges given at
    /// [`Physical`], and ω0, N/K and the dimensionless parameters neither overflow nor underflow.
    pub fn new(physical: Physical) -> Result<Self, Error> {
        let Physical {
            mass,
            stiffness,
            damping,
            normal_force,
            belt_velocity,
        } = physical;
        Error::check("Scaling", "mass", mass, mass > 0.0, "mass > 0")?;
        Error::check(
            "Scaling",
            "stiffness",
            stiffness,
            stiffness > 0.0,
            "stiffness > 0",
        )?;
        Error::check("Scaling", "damping", damping, damping >= 0.0, "damping ≥ 0")?;
        Error::check(
            "Scaling",
            "normal_force",
            normal_force,
            normal_force > 0.0,
            "normal_force > 0",
        )?;
        Error::check(
            "Scaling",
            "belt_velocity",
            belt_velocity,
            true,
            "any direction and size",
        )?;
        let angular_frequency = (stiffness / mass).sqrt();
        Error::check(
            "Scaling",
            "stiffness",
            stiffness,
            angular_frequency.is_normal(),
            "stiffness/mass within the range of f64",
        )?;
        let length = normal_force / stiffness;
        Self {
            physical,
            length,
            angular_frequency,
        }
        .with_length(length)
    }

    /// Sets another unit of length L > 0, in m.
    ///
    /// # Errors
    ///
    /// [`Error::InvalidParameter`] unless L is finite and > 0, and ω0 L and the dimensionless
    /// parameters neither overflow nor underflow.
    pub fn with_length(mut self, length: f64) -> Result<Self, Error> {
        self.length = length;
        let [damping, load, belt_velocity] = self.dimensionless();
        let ordinary = length.is_normal()
            && self.velocity_unit().is_normal()
            && load.is_normal()
            && (damping.is_normal() || self.physical.damping == 0.0)
            && (belt_velocity.is_normal() || self.physical.belt_velocity == 0.0);
        Error::check(
            "Scaling",
            "length",
            length,
            length > 0.0 && ordinary,
            "length > 0, and the dimensionless parameters within the range of f64",
        )?;
        Ok(self)
    }

    /// The physical parameters from which the scaling was made.
    pub fn physical(&self) -> Physical {
        self.physical
    }

    /// The unit of length L, m.
    pub fn length(&self) -> f64 {
        self.length
    }

    /// Angular frequency ω0 = √(K/M) of the undamped mass on its spring, rad/s.
    pub fn angular_frequency(&self) -> f64 {
        self.angular_frequency
    }

    /// The units of the dimensionless system.
    pub(crate) fn units(&self) -> Units {
        Units {
            length: self.length,
            rate: self.angular_frequency,
            stiffness: self.physical.stiffness,
            belt_velocity: Some(self.physical.belt_velocity),
        }
    }

    /// The unit of velocity ω0 L, m/s.
    fn velocity_unit(&self) -> f64 {
        self.units().velocity()
    }

    /// The unit of force K L, N.
    fn force_unit(&self) -> f64 {
        self.units().force()
    }

    /// The dimensionless parameters β, γ² and v_b.
    fn dimensionless(&self) -> [f64; 3] {
        let Physical {
            damping,
            normal_force,
            stiffness,
            belt_velocity,
            ..
        } = self.physical;
        [
            // 2√(KM) = 2 M ω0
            0.5 * damping / self.physical.mass / self.angular_frequency,
            // In this order the load is exactly 1 for L = N/K.
            normal_force / stiffness / self.length,
            belt_velocity / self.velocity_unit(),
        ]
    }

    /// The dimensionless system, with a law whose speeds are in m/s.
    ///
    /// # Errors
    ///
    /// The errors of [`MassOnBelt::new`] and its `with_` methods. A speed or a breakpoint in these
    /// errors is dimensionless; [`metres_per_second`](Self::metres_per_second) converts it.
    pub fn system<L: FrictionLaw>(&self, law: L) -> Result<MassOnBelt<Scaled<L>>, Error> {
        let [damping, load, belt_velocity] = self.dimensionless();
        MassOnBelt::new(self.law(law), belt_velocity)?
            .with_damping(damping)?
            .with_load(load)
    }

    /// The law in dimensionless speeds, from a law whose speeds are in m/s.
    pub fn law<L: FrictionLaw>(&self, law: L) -> Scaled<L> {
        // `with_length` has checked that the unit is an ordinary number.
        Scaled::of(law, self.velocity_unit())
    }

    /// Time t = τ/ω0 in seconds, from a dimensionless time or period τ.
    pub fn seconds(&self, time: f64) -> f64 {
        time / self.angular_frequency
    }

    /// Dimensionless time τ = ω0 t, from a time t in seconds.
    pub(crate) fn dimensionless_time(&self, seconds: f64) -> f64 {
        seconds * self.angular_frequency
    }

    /// Displacement X = L u in metres, from a dimensionless displacement or amplitude u.
    pub fn metres(&self, displacement: f64) -> f64 {
        displacement * self.length
    }

    /// Velocity X' = ω0 L v in metres per second, from a dimensionless velocity or sliding speed v.
    pub fn metres_per_second(&self, velocity: f64) -> f64 {
        velocity * self.velocity_unit()
    }

    /// Dimensionless velocity v = X'/(ω0 L), from a velocity X' in metres per second.
    pub(crate) fn dimensionless_velocity(&self, metres_per_second: f64) -> f64 {
        metres_per_second / self.velocity_unit()
    }

    /// A range of dimensionless velocities, from a range in metres per second.
    pub(crate) fn dimensionless_velocities(&self, metres_per_second: Range<f64>) -> Range<f64> {
        self.dimensionless_velocity(metres_per_second.start)
            ..self.dimensionless_velocity(metres_per_second.end)
    }

    /// Frequency f = ω0 ω/2π in hertz, from a dimensionless **angular** frequency ω = 2π/T.
    ///
    /// The undamped mass on its spring has ω = 1.
    ///
    /// ```
    /// # use stick_slip::{Physical, Scaling};
    /// # let scaling = Scaling::new(Physical {
    /// #     mass: 2.0, stiffness: 5000.0, damping: 4.0, normal_force: 20.0, belt_velocity: 0.05,
    /// # })?;
    /// assert!((scaling.hertz(1.0) - 7.957747154594767).abs() < 1e-14);
    /// // The same from a period.
    /// assert!((1.0 / scaling.seconds(std::f64::consts::TAU) - scaling.hertz(1.0)).abs() < 1e-14);
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    pub fn hertz(&self, frequency: f64) -> f64 {
        frequency * self.angular_frequency / std::f64::consts::TAU
    }

    /// Force in newtons: K L times a dimensionless force, for example of
    /// [`MassOnBelt::friction_force`].
    pub fn newtons(&self, force: f64) -> f64 {
        force * self.force_unit()
    }

    /// Damping constant C = 2β√(K M) in N·s/m, from a damping ratio β.
    ///
    /// ```
    /// # use stick_slip::{Physical, Scaling};
    /// # let scaling = Scaling::new(Physical {
    /// #     mass: 2.0, stiffness: 5000.0, damping: 4.0, normal_force: 20.0, belt_velocity: 0.05,
    /// # })?;
    /// assert_eq!(scaling.damping_constant(1.0), 200.0);
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    pub fn damping_constant(&self, damping_ratio: f64) -> f64 {
        2.0 * damping_ratio * self.physical.mass * self.angular_frequency
    }
}

/// The parameters in one line, and the undamped frequency.
///
/// ```
/// # use stick_slip::{Physical, Scaling};
/// # let scaling = Scaling::new(Physical {
/// #     mass: 2.0, stiffness: 5000.0, damping: 4.0, normal_force: 20.0, belt_velocity: 0.05,
/// # })?;
/// assert_eq!(
///     scaling.to_string(),
///     "M = 2 kg, K = 5000 N/m, C = 4 N·s/m, N = 20 N, V = 0.05 m/s: 7.95775 Hz, L = 0.004 m"
/// );
/// # Ok::<(), stick_slip::Error>(())
/// ```
impl std::fmt::Display for Scaling {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Physical {
            mass,
            stiffness,
            damping,
            normal_force,
            belt_velocity,
        } = self.physical;
        let [m, k, c, n, v] = [mass, stiffness, damping, normal_force, belt_velocity].map(Plain);
        let (hertz, length) = (Digits(self.hertz(1.0)), Digits(self.length));
        write!(
            f,
            "M = {m} kg, K = {k} N/m, C = {c} N·s/m, N = {n} N, V = {v} m/s: "
        )?;
        write!(f, "{hertz} Hz, L = {length} m")
    }
}
