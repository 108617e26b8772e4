//! One mass on a belt in SI units, from its parameters to its cycles.

use std::borrow::Borrow;
use std::ops::Range;

use crate::belt::{Criticality, Equilibrium, MassOnBelt, Step};
use crate::bifurcation::{self, DiagramPoint, VibrationRange, Visit};
use crate::error::Error;
use crate::friction::{FrictionLaw, Scaled};
use crate::limit_cycle::{self, Attractor, Basins, CycleSet, LimitCycle};
use crate::motion::{Integrator, Trajectory};
use crate::scaling::{Physical, Scaling};
use crate::series::TERMS;
use crate::state::{State, Units};
#[cfg(feature = "structures")]
use crate::structure::{Contact, Structure};

/// A mass on a belt in SI units: all arguments and results are in metres, seconds, newtons and
/// joules.
///
/// ```text
/// M X'' + C X' + K X + N μ(X' − V) = 0
/// ```
///
/// X is the displacement, and μ the friction coefficient at the relative velocity X' − V. The mass
/// M, damping C, stiffness K, normal force N and belt velocity V are the parameters in
/// [`Physical`]. This type contains the [dimensionless system](Self::dimensionless) and converts
/// all numbers to and from dimensionless form. The motions and cycles that it returns have the same
/// types as those of a [`MassOnBelt`], but their numbers are in SI units. Times are in s,
/// displacements in m, velocities in m/s, angular frequencies and eigenvalues in rad/s, energies in
/// J. Multipliers have no unit. Each conversion costs a few rounding errors.
///
/// Numbers in errors are also in SI units; parameters have the names of the fields of [`Physical`].
///
/// **Torsion.** For a torsional oscillator, use the moment of inertia (kg·m²) as the mass, a
/// stiffness in N·m/rad and a damping in N·m·s/rad. As the normal force use the product of normal
/// force and friction radius (N·m). Velocities of belt and law are in rad/s, displacements in
/// radians.
///
/// ```
/// use stick_slip::{CycleKind, Physical, PhysicalMassOnBelt, Stribeck, bifurcation};
///
/// let pad = Physical {
///     mass: 2.0,           // kg
///     stiffness: 5000.0,   // N/m
///     damping: 4.0,        // N·s/m
///     normal_force: 20.0,  // N
///     belt_velocity: 0.05, // m/s
/// };
/// let brake = PhysicalMassOnBelt::new(pad, Stribeck::new(0.4, 0.25, 0.1, 1)?)?; // law in m/s
///
/// // From rest over one second, sampled at 48 kHz.
/// let motion = brake.simulate((0.0, 0.0), 1.0)?;
/// assert!((motion.events()[0].time - 15.0966e-3).abs() < 1e-7); // s
/// assert_eq!(motion.sample_every(1.0 / 48e3)?.count(), 48_001);
///
/// // The cycle to which the motion settles.
/// let cycles = brake.cycles()?;
/// let cycle = cycles.stable().next().unwrap();
/// assert_eq!(cycle.kind(), CycleKind::StickSlip);
/// assert!((1.0 / cycle.period() - 7.65384).abs() < 1e-5); // Hz
/// assert!((cycle.amplitude() - 1.24896e-3).abs() < 1e-8); // m
///
/// // Stick-slip exists below this belt velocity, and no cycle above it.
/// let grazing = brake.velocities(bifurcation::grazing_velocities, 0.01..1.0)?;
/// assert!((grazing[0] - 0.29624).abs() < 1e-5); // m/s
/// for point in brake.diagram([0.1, 0.5]) {
///     let point = point?;
///     assert_eq!(point.cycles.is_empty(), point.belt_velocity > grazing[0]);
/// }
/// # Ok::<(), stick_slip::Error>(())
/// ```
///
/// **Any parameter.** [`bifurcation::along`] searches a family of such systems along any parameter,
/// in the units of this parameter:
///
/// ```
/// # use stick_slip::{Error, Physical, PhysicalMassOnBelt, Stribeck, bifurcation};
/// # let pad = Physical {
/// #     mass: 2.0, stiffness: 5000.0, damping: 4.0, normal_force: 20.0, belt_velocity: 0.05,
/// # };
/// let law = Stribeck::new(0.4, 0.25, 0.1, 1)?;
/// let pressed = |normal_force: f64| -> Result<_, Error> {
///     let brake = PhysicalMassOnBelt::new(Physical { normal_force, ..pad }, law)?;
///     Ok(*brake.dimensionless())
/// };
/// // Steady sliding becomes unstable where C + N dμ̂/dV = 0, with dμ̂/dV = −1.5 exp(−0.5) s/m.
/// let hopf = bifurcation::along(pressed, 1.0..20.0).named("normal_force").hopf()?; // N
/// assert!((hopf[0] - 4.0 / (1.5 * (-0.5_f64).exp())).abs() < 1e-14);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[doc(alias = "SI")]
#[doc(alias = "units")]
#[doc(alias = "torsion")]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PhysicalMassOnBelt<L> {
    scaling: Scaling,
    system: MassOnBelt<Scaled<L>>,
}

/// Returns true unless a state overflows in its units.
fn is_finite(state: State) -> bool {
    state.displacement.is_finite() && state.velocity.is_finite()
}

impl<L: FrictionLaw> PhysicalMassOnBelt<L> {
    /// Creates a system from its parameters and a law whose speeds are in m/s.
    ///
    /// # Errors
    ///
    /// The errors of [`Scaling::new`] and [`Scaling::system`], with speeds of the law in m/s;
    /// [`Error::InvalidParameter`] if ω0 = √(K/M) is so large or small (about 10¹¹ or 10⁻¹¹ rad/s)
    /// that power series of time in seconds overflow or underflow.
    pub fn new(physical: Physical, law: L) -> Result<Self, Error> {
        let scaling = Scaling::new(physical)?;
        let highest = scaling.angular_frequency().powi(TERMS as i32);
        Error::check(
            "Scaling",
            "stiffness",
            physical.stiffness,
            highest.is_normal() && (highest * scaling.units().velocity()).is_normal(),
            "√(stiffness/mass) between about 1e-11 and 1e11 rad/s; beyond, simulate a MassOnBelt, \
             which is dimensionless, and convert by Scaling",
        )?;
        let system = scaling.system(law);
        let system = system.map_err(|error| error.in_units(scaling.units()))?;
        Ok(Self { scaling, system })
    }

    /// The parameters, in SI units.
    pub fn physical(&self) -> Physical {
        self.scaling.physical()
    }

    /// The conversion to dimensionless quantities and back.
    pub fn scaling(&self) -> &Scaling {
        &self.scaling
    }

    /// The law, with speeds in m/s.
    pub fn law(&self) -> &L {
        self.system.law().law()
    }

    /// The dimensionless system, for functions that this type does not have: searches by
    /// [`bifurcation::along`], and the formulas of [`analysis`](crate::analysis).
    pub fn dimensionless(&self) -> &MassOnBelt<Scaled<L>> {
        &self.system
    }

    /// The displacements between which the mass can stick, ∓N μ_s/K − C V/K, in m, with the static
    /// coefficient μ_s: [`MassOnBelt::stick_limits`].
    pub fn stick_limits(&self) -> [f64; 2] {
        let limits = self.system.stick_limits();
        limits.map(|displacement| self.scaling.metres(displacement))
    }

    /// The friction force on the mass, in N, for a state in m and m/s:
    /// [`MassOnBelt::friction_force`].
    ///
    /// ```
    /// use stick_slip::{Coulomb, Physical, PhysicalMassOnBelt};
    ///
    /// let pad = Physical {
    ///     mass: 2.0, stiffness: 5000.0, damping: 4.0, normal_force: 20.0, belt_velocity: 0.05,
    /// };
    /// let brake = PhysicalMassOnBelt::new(pad, Coulomb::new(0.4, 0.25)?)?;
    /// assert_eq!(brake.friction_force((0.0, 0.0)), 5.0); // N μ_k
    /// assert!((brake.friction_force((1e-3, 0.05)) - 5.2).abs() < 1e-14); // stick: K X + C V
    /// assert_eq!(brake.acceleration((0.0, 0.0)), 2.5); // m/s²
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    pub fn friction_force(&self, state: impl Into<State>) -> f64 {
        let given = state.into();
        let relative_velocity = given.velocity - self.physical().belt_velocity;
        let state = self.scaling.units().dimensionless(given);
        if is_finite(state) || relative_velocity == 0.0 {
            return self.scaling.newtons(self.system.friction_force(state));
        }
        -self.physical().normal_force * self.law().coefficient(relative_velocity)
    }

    /// The acceleration of the mass, in m/s², for a state in m and m/s:
    /// [`MassOnBelt::acceleration`]. If it overflows, the result is ±∞.
    pub fn acceleration(&self, state: impl Into<State>) -> f64 {
        let given = state.into();
        let state = self.scaling.units().dimensionless(given);
        let units = self.scaling.units();
        if is_finite(state) {
            return self.system.acceleration(state) * units.rate * units.velocity();
        }
        // The force of the spring and that of the damper may overflow with different signs.
        const SMALL: f64 = f64::from_bits((1023 - 600) << 52);
        let [displacement, velocity] = [given.displacement, given.velocity].map(|x| x * SMALL);
        let friction = SMALL * self.friction_force(given) / self.physical().mass;
        let damper = 2.0 * self.system.damping() * units.rate * velocity;
        (friction - damper - units.rate * units.rate * displacement) / SMALL
    }

    /// The release point, in m and m/s: [`MassOnBelt::release_state`].
    pub fn release_state(&self) -> Option<State> {
        let state = self.scaling.units().state(self.system.release_state()?);
        let velocity = self.physical().belt_velocity;
        Some(State { velocity, ..state })
    }

    /// Steady sliding and its stability, in m and rad/s: [`MassOnBelt::equilibrium`].
    pub fn equilibrium(&self) -> Option<Equilibrium> {
        Some(self.system.equilibrium()?.in_units(self.scaling.units()))
    }

    /// The motion from a start (m, m/s) over a time in seconds: [`MassOnBelt::simulate`].
    ///
    /// # Errors
    ///
    /// The errors of [`Integrator::simulate`], with numbers in SI units.
    #[doc(alias = "integrate")]
    pub fn simulate(&self, start: impl Into<State>, seconds: f64) -> Result<Trajectory, Error> {
        self.simulate_with(Integrator::new(), start, seconds)
    }

    /// The motion from a start (m, m/s) over a time in seconds, with the given settings of the
    /// integrator. A start time in these settings is ignored: the motion starts at time 0.
    ///
    /// # Errors
    ///
    /// The errors of [`Integrator::simulate`], with numbers in SI units.
    pub fn simulate_with(
        &self,
        integrator: Integrator,
        start: impl Into<State>,
        seconds: f64,
    ) -> Result<Trajectory, Error> {
        let integrator = integrator.with_start_time(0.0)?;
        self.motion(start.into(), seconds, |start, duration| {
            integrator.simulate(&self.system, start, duration)
        })
    }

    /// The motion from a start (m, m/s) until `stop` ends it, until a time in seconds is over, or
    /// until the integration fails: [`Integrator::simulate_until`]. `stop` gets each step in SI
    /// units and returns a time in seconds.
    ///
    /// # Errors
    ///
    /// The errors of [`Integrator::simulate_until`], with numbers in SI units.
    ///
    /// ```
    /// use stick_slip::{Ended, Integrator, Physical, PhysicalMassOnBelt, Segment, Stribeck};
    ///
    /// let pad = Physical {
    ///     mass: 2.0, stiffness: 5000.0, damping: 4.0, normal_force: 20.0, belt_velocity: 0.05,
    /// };
    /// let brake = PhysicalMassOnBelt::new(pad, Stribeck::new(0.4, 0.25, 0.1, 1)?)?;
    /// // Until the spring is stretched by 1.5 mm.
    /// let motion = brake.simulate_until(Integrator::new(), (0.0, 0.0), 10.0, |step| {
    ///     step.first_zero(|state| state.displacement - 1.5e-3)
    /// })?;
    /// assert_eq!(motion.ended(), &Ended::Stopped);
    /// assert!((motion.last().displacement - 1.5e-3).abs() < 1e-17);
    /// // It sticks already and moves with the belt.
    /// let stick = motion.events()[0];
    /// let way = 0.05 * (motion.duration() - stick.time);
    /// assert!((stick.state.displacement + way - 1.5e-3).abs() < 1e-17);
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    #[doc(alias = "event")]
    pub fn simulate_until(
        &self,
        integrator: Integrator,
        start: impl Into<State>,
        seconds: f64,
        mut stop: impl FnMut(&Step) -> Option<f64>,
    ) -> Result<Trajectory, Error> {
        let units = self.scaling.units();
        let mut stop = |step: &Step| {
            let converted = step.in_units(units);
            let time = stop(&converted)?;
            // The end of a step remains its end, and keeps the event there.
            let is_end = time.is_finite() && time >= converted.end_time();
            let time = self.scaling.dimensionless_time(time);
            Some(if is_end { step.end_time() } else { time })
        };
        let integrator = integrator.with_start_time(0.0)?;
        self.motion(start.into(), seconds, |start, duration| {
            integrator.simulate_until(&self.system, start, duration, &mut stop)
        })
    }

    /// The motion in SI units that `run` makes from a dimensionless start and duration.
    fn motion(
        &self,
        given: State,
        seconds: f64,
        run: impl FnOnce(State, f64) -> Result<Trajectory, Error>,
    ) -> Result<Trajectory, Error> {
        let start = self.scaling.units().dimensionless(given);
        let duration = self.scaling.dimensionless_time(seconds);
        match run(start, duration) {
            Ok(motion) => Ok(motion.in_units(self.scaling.units(), seconds)),
            // The numbers as they were given: their conversion may have overflowed.
            Err(Error::InvalidState { .. }) => Err(Error::InvalidState {
                displacement: given.displacement,
                velocity: given.velocity,
            }),
            Err(Error::InvalidDuration { .. }) => Err(Error::InvalidDuration { value: seconds }),
            Err(error) => Err(self.in_si(error)),
        }
    }

    /// The periodic motions, stable and unstable: [`limit_cycle::find`].
    ///
    /// # Errors
    ///
    /// The errors of [`limit_cycle::find`], with numbers in SI units.
    #[doc(alias = "find")]
    pub fn cycles(&self) -> Result<CycleSet, Error> {
        match limit_cycle::find(&self.system) {
            Ok(cycles) => Ok(cycles.in_units(self.scaling.units())),
            Err(error) => Err(self.in_si(error)),
        }
    }

    /// The periodic motion that sticks, if there is one: [`limit_cycle::stick_slip`].
    ///
    /// # Errors
    ///
    /// The errors of [`limit_cycle::stick_slip`], with numbers in SI units.
    pub fn stick_slip(&self) -> Result<Option<LimitCycle>, Error> {
        match limit_cycle::stick_slip(&self.system) {
            Ok(cycle) => Ok(cycle.map(|cycle| cycle.in_units(self.scaling.units()))),
            Err(error) => Err(self.in_si(error)),
        }
    }

    /// The attractor that the motion from a given start reaches: see [`limit_cycle::attractor`].
    /// The start is given in m and m/s, and the attractor is returned in SI units.
    ///
    /// # Errors
    ///
    /// The errors of [`limit_cycle::attractor`].
    pub fn attractor(&self, start: impl Into<State>) -> Result<Attractor, Error> {
        self.basins()?.attractor(start.into())
    }

    /// The basins of attraction: [`limit_cycle::basins`]. Starts are in m and m/s, cycles in SI
    /// units.
    ///
    /// # Errors
    ///
    /// The errors of [`limit_cycle::basins`].
    ///
    /// ```
    /// use stick_slip::{Attractor, Exponential, Physical, PhysicalMassOnBelt};
    ///
    /// let pad = Physical {
    ///     mass: 2.0, stiffness: 5000.0, damping: 2.0, normal_force: 20.0, belt_velocity: 0.2,
    /// };
    /// let brake = PhysicalMassOnBelt::new(pad, Exponential::new(0.6, 0.3, 0.08)?)?; // law in m/s
    /// let basins = brake.basins()?;
    /// let steady = brake.equilibrium().unwrap().displacement;
    /// assert_eq!(basins.attractor((steady, 0.060))?, Attractor::Equilibrium);
    /// let Attractor::Cycle(cycle) = basins.attractor((steady, 0.064))? else { panic!() };
    /// assert!((cycle.max_velocity() - 0.2).abs() < 1e-15); // m/s: it sticks to the belt
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    pub fn basins(&self) -> Result<Basins<'_, Scaled<L>>, Error> {
        match limit_cycle::basins(&self.system) {
            Ok(basins) => Ok(basins.in_units(self.scaling.units())),
            Err(error) => Err(self.in_si(error)),
        }
    }

    /// Runs a search of [`bifurcation`] over a range of belt velocities in m/s, and returns the
    /// velocities found, in m/s. Pass the search by its name, as in
    /// `brake.velocities(bifurcation::hopf_velocities, 0.01..1.0)`.
    ///
    /// # Errors
    ///
    /// The errors of the search, with numbers in SI units.
    #[doc(alias = "sweep")]
    pub fn velocities(
        &self,
        search: impl FnOnce(&MassOnBelt<Scaled<L>>, Range<f64>) -> Result<Vec<f64>, Error>,
        range: Range<f64>,
    ) -> Result<Vec<f64>, Error> {
        let mut found = self.over(&range, |range| search(&self.system, range))?;
        for velocity in &mut found {
            *velocity = self.scaling.metres_per_second(*velocity);
        }
        Ok(found)
    }

    /// Returns whether the cycle born at a Hopf velocity, in m/s, is stable (supercritical) or
    /// unstable (subcritical): [`bifurcation::criticality`].
    ///
    /// ```
    /// # use stick_slip::{Exponential, Physical, PhysicalMassOnBelt};
    /// use stick_slip::bifurcation::{Criticality, hopf_velocities};
    ///
    /// # let pad = Physical {
    /// #     mass: 2.0, stiffness: 5000.0, damping: 2.0, normal_force: 20.0, belt_velocity: 0.2,
    /// # };
    /// let brake = PhysicalMassOnBelt::new(pad, Exponential::new(0.6, 0.3, 0.08)?)?;
    /// let hopf = brake.velocities(hopf_velocities, 0.0..1.0)?; // m/s
    /// assert_eq!(brake.criticality(hopf[0]), Criticality::Supercritical);
    /// assert_eq!(brake.criticality(hopf[1]), Criticality::Subcritical);
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    pub fn criticality(&self, velocity: f64) -> Criticality {
        let velocity = self.scaling.dimensionless_velocity(velocity);
        bifurcation::criticality(&self.system, velocity)
    }

    /// The attractors over a range of belt velocities in m/s: [`bifurcation::vibration_ranges`].
    ///
    /// # Errors
    ///
    /// The errors of [`bifurcation::vibration_ranges`], with numbers in SI units.
    #[doc(alias = "sweep")]
    pub fn vibration_ranges(&self, range: Range<f64>) -> Result<Vec<VibrationRange>, Error> {
        let search = |range| bifurcation::vibration_ranges(&self.system, range);
        let mut ranges = self.over(&range, search)?;
        for VibrationRange { velocities, .. } in &mut ranges {
            *velocities = self.scaling.metres_per_second(velocities.start)
                ..self.scaling.metres_per_second(velocities.end);
        }
        Ok(ranges)
    }

    /// The least damping constant, in N·s/m, with which no vibration lasts at the system's belt
    /// velocity: [`bifurcation::silencing_damping`]. The system's own damping is ignored.
    ///
    /// # Errors
    ///
    /// The errors of [`bifurcation::silencing_damping`], with numbers in SI units.
    ///
    /// ```
    /// # use stick_slip::{Physical, PhysicalMassOnBelt, Stribeck};
    /// let pad = Physical {
    ///     mass: 2.0, stiffness: 5000.0, damping: 4.0, normal_force: 20.0, belt_velocity: 0.05,
    /// };
    /// let law = Stribeck::new(0.4, 0.25, 0.1, 1)?;
    /// let brake = PhysicalMassOnBelt::new(pad, law)?;
    /// let silent = brake.silencing_damping()?; // N·s/m
    /// let damped = PhysicalMassOnBelt::new(Physical { damping: 1.001 * silent, ..pad }, law)?;
    /// assert!(damped.cycles()?.is_empty());
    /// // Or reduce the normal force.
    /// let silent = brake.silencing_load()?; // N
    /// let light = PhysicalMassOnBelt::new(Physical { normal_force: 0.999 * silent, ..pad }, law)?;
    /// assert!(light.cycles()?.is_empty());
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    #[doc(alias = "squeal")]
    pub fn silencing_damping(&self) -> Result<f64, Error> {
        let damping = bifurcation::silencing_damping(&self.system);
        let damping = damping.map_err(|error| self.in_si(error))?;
        Ok(self.scaling.damping_constant(damping))
    }

    /// The largest normal force, in N, with which no vibration lasts at the system's belt velocity:
    /// [`bifurcation::silencing_load`]. The system's own normal force is ignored.
    ///
    /// # Errors
    ///
    /// The errors of [`bifurcation::silencing_load`], with numbers in SI units.
    #[doc(alias = "squeal")]
    pub fn silencing_load(&self) -> Result<f64, Error> {
        let load = bifurcation::silencing_load(&self.system);
        let load = load.map_err(|error| self.in_si(error))?;
        Ok(self.scaling.newtons(load))
    }

    /// The stiffness, in N/m, at which vibration ends at the system's belt velocity:
    /// [`bifurcation::silencing_stiffness`]. Infinite if no spring is stiff enough.
    ///
    /// # Errors
    ///
    /// The errors of [`bifurcation::silencing_stiffness`], with numbers in SI units.
    ///
    /// ```
    /// # use stick_slip::{Coulomb, Physical, PhysicalMassOnBelt};
    /// let pad = Physical {
    ///     mass: 2.0, stiffness: 5000.0, damping: 4.0, normal_force: 20.0, belt_velocity: 0.05,
    /// };
    /// let of = |stiffness: f64| {
    ///     PhysicalMassOnBelt::new(Physical { stiffness, ..pad }, Coulomb::new(0.4, 0.25)?)
    /// };
    /// let silent = of(5000.0)?.silencing_stiffness()?; // N/m
    /// assert!(of(1.001 * silent)?.cycles()?.is_empty());
    /// assert!(!of(0.999 * silent)?.cycles()?.is_empty());
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    #[doc(alias = "squeal")]
    pub fn silencing_stiffness(&self) -> Result<f64, Error> {
        let (physical, law) = (self.physical(), self.system.law().law());
        let own = physical.stiffness;
        let systems = |factor: f64, look: &mut Visit<'_>| {
            let stiffness = factor * own;
            let brake = PhysicalMassOnBelt::new(
                Physical {
                    stiffness,
                    ..physical
                },
                law,
            )?;
            look(brake.system.belt()).map_err(|error| brake.in_si(error))
        };
        match bifurcation::least_stiffness(self.system.belt(), &systems) {
            Ok(factor) => Ok(factor * own),
            Err(mut error) => {
                if let Error::At { value, .. } | Error::Stopped { value, .. } = &mut error {
                    *value *= own;
                }
                Err(error)
            }
        }
    }

    /// Converts an error of the dimensionless system to SI units.
    fn in_si(&self, error: Error) -> Error {
        error.in_units(self.scaling.units())
    }

    /// The results of a search over a range in m/s. An error holds the ends of a bad range as they
    /// were given.
    fn over<T>(
        &self,
        range: &Range<f64>,
        search: impl FnOnce(Range<f64>) -> Result<T, Error>,
    ) -> Result<T, Error> {
        let found = search(self.scaling.dimensionless_velocities(range.clone()));
        found.map_err(|error| {
            let mut error = self.in_si(error);
            if let Error::InvalidParameter { name, value, .. } = &mut error {
                match *name {
                    "range.start" => *value = range.start,
                    "range.end" => *value = range.end,
                    _ => {}
                }
            }
            error
        })
    }

    /// Equilibrium and periodic motions at each of a list of belt velocities in m/s:
    /// [`bifurcation::diagram`]. The system's own belt velocity is ignored.
    ///
    /// # Errors
    ///
    /// Each item can be an error of [`bifurcation::diagram`], with numbers in SI units; the
    /// iterator continues after an error.
    #[doc(alias = "sweep")]
    pub fn diagram(
        &self,
        velocities: impl IntoIterator<Item = impl Borrow<f64>>,
    ) -> impl Iterator<Item = Result<DiagramPoint, Error>> {
        let velocities = velocities.into_iter();
        velocities.map(|velocity| self.point(*velocity.borrow()))
    }

    /// The results of [`diagram`](Self::diagram), computed by several threads:
    /// [`bifurcation::par_diagram`]. Belt velocities are in m/s.
    ///
    /// Needs the feature `rayon`.
    #[cfg(feature = "rayon")]
    pub fn par_diagram(&self, velocities: &[f64]) -> Vec<Result<DiagramPoint, Error>>
    where
        L: Sync,
    {
        use rayon::prelude::*;
        let velocities = velocities.par_iter();
        velocities.map(|velocity| self.point(*velocity)).collect()
    }

    /// Equilibrium and periodic motions at a belt velocity in m/s.
    fn point(&self, velocity: f64) -> Result<DiagramPoint, Error> {
        let dimensionless = self.scaling.dimensionless_velocity(velocity);
        let units = Units {
            belt_velocity: Some(velocity),
            ..self.scaling.units()
        };
        match bifurcation::point(self.system.belt(), dimensionless) {
            Ok(point) => Ok(DiagramPoint {
                belt_velocity: velocity,
                equilibrium: point.equilibrium.map(|it| it.in_units(units)),
                cycles: point.cycles.in_units(units),
            }),
            Err(error) => {
                let mut error = self.in_si(error);
                if let Error::InvalidParameter { value, .. } | Error::At { value, .. } = &mut error
                {
                    *value = velocity;
                }
                Err(error)
            }
        }
    }
}

/// The mass on its belt as a structure, in SI units, for [`orbit`](crate::orbit) and for the other
/// functions of structures, such as energies of motions.
///
/// ```
/// use stick_slip::{Coulomb, Physical, PhysicalMassOnBelt, Structure, structure::State};
///
/// let pad = Physical {
///     mass: 2.0, stiffness: 5000.0, damping: 4.0, normal_force: 20.0, belt_velocity: 0.05,
/// };
/// let brake = PhysicalMassOnBelt::new(pad, Coulomb::new(0.4, 0.25)?)?;
/// let structure = Structure::try_from(&brake)?;
/// let motion = structure.simulate(State::new(&[0.0], &[0.0]), 1.0)?; // s
/// let energy = structure.energy_budget(&motion)?; // J
/// assert!(energy.friction_loss[0] > 0.2 && energy.defect().abs() < 1e-13);
/// let same = brake.simulate((0.0, 0.0), 1.0)?;
/// assert!((motion.last().displacements[0] - same.last().displacement).abs() < 1e-16); // m
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[cfg(feature = "structures")]
impl<L> TryFrom<&PhysicalMassOnBelt<L>> for Structure
where
    L: FrictionLaw + Clone + Send + Sync + 'static,
{
    type Error = Error;

    /// # Errors
    ///
    /// The errors of [`Structure`]'s constructors, which can occur only for numbers near the limits
    /// of `f64`.
    fn try_from(brake: &PhysicalMassOnBelt<L>) -> Result<Self, Error> {
        let physical = brake.physical();
        let law = brake.dimensionless().law().law().clone();
        let contact = Contact::new(0, law, physical.normal_force)?.on_belt(physical.belt_velocity);
        Self::new(&[physical.mass])?
            .with_ground_spring(0, physical.stiffness)?
            .with_ground_damper(0, physical.damping)?
            .with_contact(contact)
    }
}

/// The parameters, in SI units.
impl<L> std::fmt::Display for PhysicalMassOnBelt<L> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.scaling.fmt(f)
    }
}
