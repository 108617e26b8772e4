use std::f64::consts::{PI, TAU};

use super::Transient;
use crate::belt::MassOnBelt;
use crate::error::Error;
use crate::friction::{FrictionLaw, Polynomial};

/// Vibration that never sticks, for the polynomial law: coefficients, averaging, and expansions
/// beyond averaging.
///
/// u is the displacement, ū that of the equilibrium, v the velocity, and v_b the belt velocity.
/// While v_r = v − v_b keeps its sign, z = u − ū obeys z'' + z + h1 z' + h2 z'² + h3 z'³ = 0, with
///
/// ```text
/// η  = (3/2) γ²(μ_s − μ_m)/v_m         (Eq. 11)
/// h1 = 2β − η(1 − (v_b/v_m)²)          (Eq. 10a)
/// h2 = −η v_b/v_m²                     (Eq. 10b, corrected: printed −η(v_b/v_m)²)
/// h3 = η/(3 v_m²)                      (Eq. 10c)
/// ```
///
/// γ² is the friction load, β the damping ratio, μ_s the static coefficient, and μ_m the least
/// coefficient, at the sliding speed v_m. Orders of errors are powers of the ε of
/// [`analysis`](super). The equation of motion and its coefficients are exact. All quantities are
/// dimensionless. The formulas hold for both signs of v_b: the mirror image (u, v, v_b) → (−u, −v,
/// −v_b) changes the sign of h2 only. The limits v_b0 and v_b1 in the table are magnitudes; v_b0 is
/// approximate.
///
/// | belt velocity | motion |
/// |---|---|
/// | 0 < abs(v_b) < v_b0, the [`stick_velocity`](Self::stick_velocity) | stick-slip: [`StickSlip`](super::StickSlip) |
/// | v_b0 < abs(v_b) < v_b1, the [`onset_velocity`](Self::onset_velocity) | pure slip with amplitude A0: this type |
/// | abs(v_b) > v_b1 | steady sliding (the source says stick-slip for velocities "beyond this range"; this is true only below v_b0) |
///
/// Source: Farshidianfar and Noei Aghaee, Eqs. 9-15; J. J. Thomsen, A. Fidlin, *Analytical
/// approximations for stick-slip vibration amplitudes*, Int. J. Non-Linear Mech. 38 (2003) 389-403.
///
/// ```
/// use stick_slip::analysis::PureSlip;
/// use stick_slip::{MassOnBelt, Polynomial, bifurcation, limit_cycle};
///
/// let system = MassOnBelt::new(Polynomial::new(0.4, 0.25, 0.5)?, 0.42)?.with_damping(0.05)?;
/// let formulas = PureSlip::new(&system).unwrap();
/// assert!((formulas.eta() - 0.45).abs() < 1e-15); // (3/2)·0.15/0.5
/// assert!((formulas.h1() + 0.03248).abs() < 1e-15);
/// assert!((formulas.h1() + system.equilibrium().unwrap().jacobian[(1, 1)]).abs() < 1e-15);
/// assert!((formulas.h2() + 0.756).abs() < 1e-15);
/// assert!((formulas.h3() - 0.6).abs() < 1e-15);
/// // The range v_b0 < v_b < v_b1 of pure slip. Its exact lower end is 0.3957902888.
/// let onset = formulas.onset_velocity().unwrap();
/// assert!((onset - 0.4409585518).abs() < 1e-10);
/// assert!((onset - bifurcation::hopf_velocities(&system, 0.0..1.0)?[0]).abs() < 1e-15);
/// assert!((formulas.stick_velocity().unwrap() - 0.3944053189).abs() < 1e-10);
/// assert!(formulas.is_valid());
/// assert!(!PureSlip::new(&system.with_belt_velocity(0.2)?).unwrap().is_valid()); // it sticks
/// // The amplitude A0, the exact amplitude, and slow growth towards A0.
/// let cycle = &limit_cycle::find(&system)?[0];
/// let amplitude = formulas.amplitude().unwrap();
/// assert!((amplitude - 0.2686592224).abs() < 1e-10);
/// assert!((cycle.amplitude() - 0.2719902245).abs() < 1e-10);
/// assert!(formulas.transient(0.1, 0.0)?.amplitude(1000.0).unwrap() > 0.999 * amplitude);
/// // Each order is closer to the exact cycle.
/// let centre = 0.5 * (cycle.max_displacement() + cycle.min_displacement());
/// let first = formulas.first_order().unwrap();
/// assert!((0.5 * (first.u_max + first.u_min) - centre).abs() < 1e-3);
/// let second = formulas.second_order().unwrap();
/// assert!((second.amplitude - cycle.amplitude()).abs() < 1e-4);
/// assert!((second.period - cycle.period()).abs() < 1e-3);
/// let third = formulas.third_order().unwrap();
/// assert!((third.u_max - cycle.max_displacement()).abs() < 1e-4);
/// let fourth = formulas.fourth_order().unwrap();
/// assert!((fourth.period - cycle.period()).abs() < 1e-5);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PureSlip {
    belt_velocity: f64,
    minimum_velocity: f64,
    damping: f64,
    equilibrium: f64,
    eta: f64,
    h1: f64,
    h2: f64,
    h3: f64,
}

impl PureSlip {
    /// Computes the coefficients for a system. `None` if v_b = 0, or if a coefficient overflows or
    /// underflows.
    pub fn new(system: &MassOnBelt<Polynomial>) -> Option<Self> {
        let (law, v_b) = (system.law(), system.belt_velocity());
        let v_m = law.minimum_velocity();
        let ratio = v_b.abs() / v_m;
        let drop = law.static_coefficient() - law.minimum_coefficient();
        let eta = 1.5 * system.load() * drop / v_m;
        let h2 = -eta * (v_b / v_m) / v_m;
        let formulas = Self {
            belt_velocity: v_b,
            minimum_velocity: v_m,
            damping: system.damping(),
            equilibrium: system.belt().equilibrium_displacement(),
            eta,
            h1: 2.0 * system.damping() - eta * (1.0 - ratio) * (1.0 + ratio),
            h2,
            h3: eta / 3.0 / v_m / v_m,
        };
        let finite = [formulas.h1, formulas.h2].iter().all(|h| h.is_finite());
        let falls = system.load() > 0.0 && drop > 0.0;
        let normal = [eta, formulas.h3].iter().all(|h| h.is_normal() || !falls);
        (v_b != 0.0 && finite && normal).then_some(formulas)
    }

    /// Coefficient η = (3/2)γ²(μ_s − μ_m)/v_m: how steeply friction falls at small speeds.
    /// Dimensionless, exact. Source: Farshidianfar and Noei Aghaee, Eq. 11.
    pub fn eta(&self) -> f64 {
        self.eta
    }

    /// Coefficient h1 = 2β − η(1 − (v_b/v_m)²): the damping of small motions. Dimensionless, exact.
    /// Source: Farshidianfar and Noei Aghaee, Eq. 10a.
    pub fn h1(&self) -> f64 {
        self.h1
    }

    /// Coefficient h2 = −η v_b/v_m². Dimensionless, exact. Source: Farshidianfar and Noei Aghaee,
    /// Eq. 10b, corrected (printed: −η(v_b/v_m)²).
    pub fn h2(&self) -> f64 {
        self.h2
    }

    /// Coefficient h3 = η/(3v_m²). Dimensionless, exact. Source: Farshidianfar and Noei Aghaee,
    /// Eq. 10c.
    pub fn h3(&self) -> f64 {
        self.h3
    }

    /// Belt velocity v_b1 = v_m√(1 − 2β/η), below which steady sliding is unstable. Dimensionless,
    /// exact. `None` if 2β ≥ η: steady sliding is then stable at every belt velocity.
    ///
    /// Source: Farshidianfar and Noei Aghaee, text after Eq. 15.
    pub fn onset_velocity(&self) -> Option<f64> {
        let excess = self.eta - 2.0 * self.damping;
        (excess > 0.0).then(|| self.minimum_velocity * (excess / self.eta).sqrt())
    }

    /// Belt velocity v_b0 = √(4/5) v_b1 below which the mass sticks, by averaging: A0 = v_b at
    /// v_b0. Dimensionless, relative error O(ε²). `None` if 2β ≥ η.
    ///
    /// Source: Farshidianfar and Noei Aghaee, text after Eq. 15, corrected: the printed √(4/3)
    /// would give a velocity above v_b1.
    pub fn stick_velocity(&self) -> Option<f64> {
        self.onset_velocity().map(|onset| 0.8_f64.sqrt() * onset)
    }

    /// Belt velocity √(4/5) v_b1 [1 + (3461/76800) q²], q = (4/5)η(v_b1/v_m)², at which the largest
    /// velocity of the pure-slip cycle equals the belt velocity. Dimensionless, relative error
    /// O(ε⁴). `None` if 2β ≥ η, or if a term overflows.
    ///
    /// ```
    /// use stick_slip::analysis::PureSlip;
    /// use stick_slip::{MassOnBelt, Polynomial};
    ///
    /// let system = MassOnBelt::new(Polynomial::new(0.4, 0.25, 0.5)?, 0.4)?.with_damping(0.05)?;
    /// let formulas = PureSlip::new(&system).unwrap();
    /// let grazing = formulas.grazing_velocity().unwrap();
    /// assert!((grazing - 0.3957987939).abs() < 1e-10); // exact: 0.3957902888
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    pub fn grazing_velocity(&self) -> Option<f64> {
        let q = 0.8 * (self.eta - 2.0 * self.damping);
        self.stick_velocity()
            .map(|stick| stick * (1.0 + 3461.0 / 76800.0 * q * q))
            .filter(|grazing| grazing.is_finite())
    }

    /// Amplitude A0 = √(−(4/3) h1/h3) = 2√(v_b1² − v_b²) of the averaged cycle, dimensionless.
    /// `None` if h1 ≥ 0.
    ///
    /// As an approximation of half the range of u, or of the largest velocity, A0 has an error
    /// O(ε²). As an approximation of u_max − ū its error is O(ε), because the cycle is not centred
    /// on ū. Below v_b0 the formula still gives a number, but no pure-slip motion exists: see
    /// [`is_valid`](Self::is_valid).
    ///
    /// Source: Farshidianfar and Noei Aghaee, Eq. 13, corrected (4/3 replaces the printed 3/4), and
    /// Eq. 15.
    pub fn amplitude(&self) -> Option<f64> {
        (self.h1 < 0.0).then(|| 2.0 * self.minimum_velocity * (-self.h1 / self.eta).sqrt())
    }

    /// Returns true if the averaged cycle exists and slips all the time: A0 < |v_b|, which is the
    /// same as v_b0 < |v_b| < v_b1. The limit v_b1 is exact, and the limit v_b0 has a relative
    /// error O(ε²).
    ///
    /// Source: Farshidianfar and Noei Aghaee, section 4.1.1, corrected: the printed condition is
    /// ż < 0 (velocity of the mass) instead of v_r < 0.
    pub fn is_valid(&self) -> bool {
        self.amplitude()
            .is_some_and(|amplitude| amplitude < self.belt_velocity.abs())
    }

    /// Slow growth or decay of the vibration z = A sin ψ from an amplitude A(0) ≥ 0 and a phase
    /// ψ(0).
    ///
    /// # Errors
    ///
    /// [`Error::InvalidParameter`] if the amplitude is negative, or if the amplitude or the phase
    /// is not finite.
    pub fn transient(
        &self,
        initial_amplitude: f64,
        initial_phase: f64,
    ) -> Result<Transient, Error> {
        let coefficients = [self.equilibrium, self.h1, self.h3];
        Transient::new(coefficients, initial_amplitude, initial_phase)
    }

    /// The cycle with all terms up to order ε: the averaged cycle, and the shift of its centre.
    /// `None` if h1 ≥ 0, or if a term overflows. For errors and range see [`PureSlipCycle`].
    pub fn first_order(&self) -> Option<PureSlipCycle> {
        self.cycle(1)
    }

    /// The cycle with all terms up to order ε². `None` if h1 ≥ 0, or if a term overflows. For
    /// errors and range see [`PureSlipCycle`].
    pub fn second_order(&self) -> Option<PureSlipCycle> {
        self.cycle(2)
    }

    /// The cycle with the terms up to order ε³. `None` if h1 ≥ 0, or if a term overflows. For
    /// errors and range see [`PureSlipCycle`].
    pub fn third_order(&self) -> Option<PureSlipCycle> {
        self.cycle(3)
    }

    /// The cycle with the terms up to order ε³, and the frequency up to order ε⁴. `None` if h1 ≥ 0,
    /// or if a term overflows. For errors and range see [`PureSlipCycle`].
    pub fn fourth_order(&self) -> Option<PureSlipCycle> {
        self.cycle(4)
    }

    fn cycle(&self, order: u32) -> Option<PureSlipCycle> {
        let amplitude = self.amplitude()?;
        let through = |lowest: u32, term: f64| if order >= lowest { term } else { 0.0 };
        let (h1, a, b) = (
            self.h1,
            amplitude * self.h2,
            amplitude * amplitude * self.h3,
        );
        let (a2, b2) = (a * a, b * b);

        // Half the range of u: A[1 + (153b² + 896a²)/3072]
        let half_range = amplitude * (1.0 + through(2, (153.0 * b2 + 896.0 * a2) / 3072.0));
        // Middle of the range: −(2/3)aA − aA(12160a² − 9807b²)/57600
        let middle =
            -a * amplitude * (2.0 / 3.0 + through(3, (12160.0 * a2 - 9807.0 * b2) / 57600.0));
        // Extremes of v: ±A[1 + (135b² ∓ 6144ab + 8320a²)/46080]
        let v_extreme = |sign: f64| {
            let second = (135.0 * b2 - sign * 6144.0 * a * b + 8320.0 * a2) / 46080.0;
            sign * amplitude * (1.0 + through(2, second))
        };
        // Mean of z: −aA/2 − aA(1280a² − 1071b²)/9216
        let z_mean = -a * amplitude * (0.5 + through(3, (1280.0 * a2 - 1071.0 * b2) / 9216.0));
        // ω = 1 − a²/6 − h1²/16 + (61965b⁴ + 3333888a²b² − 1392640a⁴)/35389440
        let fourth = 61965.0 * b2 * b2 + 3_333_888.0 * a2 * b2 - 1_392_640.0 * a2 * a2;
        let frequency =
            1.0 - through(2, a2 / 6.0 + h1 * h1 / 16.0) + through(4, fourth / 35_389_440.0);
        // ln of the multiplier: 2πh1 − πb(81b² + 832a²)/768
        let log_multiplier = TAU * h1 - through(3, PI * b * (81.0 * b2 + 832.0 * a2) / 768.0);
        let first_harmonic = amplitude * (1.0 + through(2, (81.0 * b2 + 512.0 * a2) / 2048.0));

        let (z_max, z_min) = (middle + half_range, middle - half_range);
        let cycle = PureSlipCycle {
            u_max: self.equilibrium + z_max,
            u_min: self.equilibrium + z_min,
            u_mean: self.equilibrium + z_mean,
            z_max,
            z_min,
            z_mean,
            v_max: v_extreme(1.0),
            v_min: v_extreme(-1.0),
            amplitude: half_range,
            frequency,
            period: TAU / frequency,
            log_multiplier,
            multiplier: log_multiplier.exp(),
            harmonics: [
                first_harmonic,
                a.abs() * amplitude / 6.0,
                b * amplitude / 32.0,
            ],
        };
        let [_, second, third] = cycle.harmonics;
        let numbers = [
            cycle.u_max,
            cycle.u_min,
            cycle.u_mean,
            cycle.v_max,
            cycle.v_min,
            first_harmonic,
            second,
            third,
            frequency,
            log_multiplier,
        ];
        numbers.iter().all(|x| x.is_finite()).then_some(cycle)
    }
}

/// A pure-slip cycle of the polynomial law, as an expansion for weak friction and damping.
///
/// The expansion is in powers of ε ([`analysis`](super)); all quantities are dimensionless.
/// [`PureSlip::first_order`] to [`PureSlip::fourth_order`] compute it.
///
/// A0, h1, h2 and h3 are those of [`PureSlip`]; a = A0 h2 and b = A0² h3. u is the displacement, ū
/// that of the equilibrium, v the velocity, and ω the angular frequency. The fourth order is
///
/// ```text
/// u_max − ū, u_min − ū = ±A0[1 + (153b² + 896a²)/3072] − A0 a[2/3 + (12160a² − 9807b²)/57600]
/// v_max, v_min         = ±A0[1 + (135b² ∓ 6144ab + 8320a²)/46080]
/// mean of u − ū        = −A0 a[1/2 + (1280a² − 1071b²)/9216]
/// ω                    = 1 − a²/6 − h1²/16 + (61965b⁴ + 3333888a²b² − 1392640a⁴)/35389440
/// harmonics            = A0[1 + (81b² + 512a²)/2048],  |a|A0/6,  bA0/32
/// ln(multiplier)       = 2πh1 − πb(81b² + 832a²)/768
/// ```
///
/// The cycles of first, second and third order contain the terms up to ε, ε² and ε³. The cycle of
/// fourth order differs from that of third order in the frequency and the period only, which
/// contain the terms up to ε⁴. The errors have the following orders in ε:
///
/// | field | first | second | third | fourth |
/// |---|---|---|---|---|
/// | `z_max`, `z_min`, `u_max`, `u_min` | 2 | 3 | 4 | 4 |
/// | `amplitude`, `v_max`, `v_min`, first harmonic | 2 | 4 | 4 | 4 |
/// | `z_mean`, `u_mean` | 3 | 3 | 5 | 5 |
/// | `frequency`, `period` | 2 | 4 | 4 | 6 |
/// | `multiplier`, `log_multiplier` | 3 | 3 | 5 | 5 |
/// | second and third harmonic | 3 | 3 | 3 | 3 |
///
/// The expansion is valid for belt velocities v_b0 < |v_b| < v_b1 ([`PureSlip::is_valid`]), if a, b
/// and h1 are small compared with 1. [`PureSlip::grazing_velocity`] is more accurate than v_b0.
///
/// Source: expansion of z'' + z + h1 z' + h2 z'² + h3 z'³ = 0. The first order consists of Eqs. 13
/// and 15 of Farshidianfar and Noei Aghaee (corrected) and of the shift of the centre, which they
/// neglect.
///
/// ```
/// use stick_slip::analysis::PureSlip;
/// use stick_slip::{MassOnBelt, Polynomial};
///
/// let system = MassOnBelt::new(Polynomial::new(0.4, 0.25, 0.5)?, 0.42)?.with_damping(0.05)?;
/// let formulas = PureSlip::new(&system).unwrap();
/// let exact = 0.5642899981; // largest displacement
/// let errors = [formulas.first_order(), formulas.second_order(), formulas.third_order()]
///     .map(|cycle| (cycle.unwrap().u_max - exact).abs());
/// assert!(errors[0] < 4e-3 && errors[1] < 6e-4 && errors[2] < 9e-5);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct PureSlipCycle {
    /// Largest displacement u_max.
    pub u_max: f64,
    /// Least displacement u_min.
    pub u_min: f64,
    /// Time mean of the displacement u.
    pub u_mean: f64,
    /// Largest distance from the equilibrium upwards, u_max − ū.
    pub z_max: f64,
    /// Largest distance from the equilibrium downwards, u_min − ū (negative).
    pub z_min: f64,
    /// Time mean of u − ū.
    pub z_mean: f64,
    /// Largest velocity v_max.
    pub v_max: f64,
    /// Least velocity v_min.
    pub v_min: f64,
    /// Amplitude (u_max − u_min)/2.
    pub amplitude: f64,
    /// Angular frequency ω = 2π/T, in units of ω0.
    pub frequency: f64,
    /// Period T.
    pub period: f64,
    /// Floquet multiplier: the factor by which a small perturbation grows over one period.
    pub multiplier: f64,
    /// Natural logarithm of the Floquet multiplier.
    pub log_multiplier: f64,
    /// Amplitudes of the first three harmonics of u.
    pub harmonics: [f64; 3],
}
