//! Extremes of a cycle, as roots of its power series; harmonics and energies, as integrals over
//! these series.

use num_complex::Complex;

use super::cycle::LimitCycle;
use crate::belt::Step;
use crate::motion::EnergyBudget;
use crate::numerics::fourier::{Fourier, differentiated};
use crate::numerics::gauss::gauss_fours;
use crate::numerics::power_of_two;
use crate::series::PowerSeries;
use crate::state::{State, Units};

impl LimitCycle {
    /// Complex amplitudes of the first n harmonics of the displacement u, dimensionless: (2/T)∮u
    /// e^(−ikωτ) dτ for k = 1, …, n. T is the period and ω = 2π/T. The time τ is 0 at
    /// [`state`](Self::state), the start of the period. The modulus is the amplitude of the
    /// harmonic. The cost is in proportion to n.
    ///
    /// ```
    /// use stick_slip::{MassOnBelt, Polynomial, limit_cycle};
    ///
    /// let system = MassOnBelt::new(Polynomial::new(0.4, 0.25, 0.5)?, 0.2)?.with_damping(0.05)?;
    /// let cycle = limit_cycle::stick_slip(&system)?.unwrap();
    /// let harmonics = cycle.harmonics(40);
    /// // The Fourier series at the start of the cycle.
    /// let u = cycle.mean_displacement() + harmonics.iter().map(|a| a.re).sum::<f64>();
    /// assert!((u - cycle.state().displacement).abs() < 1e-4);
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    pub fn harmonics(&self, n: usize) -> Vec<Complex<f64>> {
        let (mean, unit) = (self.mean_displacement(), self.unit_of_displacement());
        let mut fourier = Fourier::new(self.frequency(), n);
        for step in &self.steps {
            let displacement = |t: f64| (step.state_at(t).displacement - mean) / unit;
            fourier.add(step.start.time, step.duration, &displacement);
        }
        fourier.amplitudes(unit)
    }

    /// Complex amplitudes of the first n harmonics of the velocity v, dimensionless: ikω times the
    /// amplitudes of the displacement ([`harmonics`](Self::harmonics)) for k = 1, …, n. Harmonic k
    /// has the frequency k/T = kω/2π. In a cycle of a
    /// [`PhysicalMassOnBelt`](crate::PhysicalMassOnBelt) the units are hertz and metres per second.
    ///
    /// The velocity of a cycle is continuous. If its acceleration jumps at events, the amplitudes
    /// fall off as 1/k².
    ///
    /// ```
    /// use stick_slip::{MassOnBelt, Polynomial, limit_cycle};
    ///
    /// let system = MassOnBelt::new(Polynomial::new(0.4, 0.25, 0.5)?, 0.2)?.with_damping(0.05)?;
    /// let cycle = limit_cycle::stick_slip(&system)?.unwrap();
    /// // Parseval: the mean of v² is half the sum of all squares.
    /// let squares: f64 = cycle.velocity_harmonics(40).iter().map(|a| a.norm_sqr()).sum();
    /// assert!((cycle.rms_velocity() - (0.5 * squares).sqrt()).abs() < 1e-6);
    /// // In decibels, relative to 1e-3.
    /// let decibels = |amplitude: f64| 20.0 * (amplitude / 1e-3).log10();
    /// assert!((decibels(cycle.velocity_harmonics(1)[0].norm()) - 48.2).abs() < 0.1);
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    #[doc(alias = "spectrum")]
    #[doc(alias = "fft")]
    pub fn velocity_harmonics(&self, n: usize) -> Vec<Complex<f64>> {
        self.differentiated_harmonics(n, 1)
    }

    /// Complex amplitudes of the first n harmonics of the acceleration, dimensionless: (ikω)² times
    /// the amplitudes of the displacement ([`harmonics`](Self::harmonics)) for k = 1, …, n, with ω
    /// = 2π/T. If the acceleration jumps at events, these amplitudes fall off only as 1/k.
    #[doc(alias = "spectrum")]
    #[doc(alias = "fft")]
    pub fn acceleration_harmonics(&self, n: usize) -> Vec<Complex<f64>> {
        self.differentiated_harmonics(n, 2)
    }

    fn differentiated_harmonics(&self, n: usize, times: i32) -> Vec<Complex<f64>> {
        differentiated(self.harmonics(n), self.frequency(), times)
    }

    /// Root mean square of the velocity v over the period T, √((1/T)∮v² dτ), dimensionless: the
    /// usual measure of vibration severity.
    #[doc(alias = "severity")]
    pub fn rms_velocity(&self) -> f64 {
        let unit = self.unit_of_velocity();
        unit * (self.integral_of_squared_velocity(unit) / self.period()).sqrt()
    }

    /// Root mean square of the acceleration, √((1/T)∮v'² dτ), dimensionless; in stick the
    /// acceleration is 0.
    ///
    /// In dimensionless units the result equals the root mean square of the velocity; in physical
    /// units it is the natural frequency ω0 times the root mean square of the velocity. To show
    /// this, multiply the time derivative of the equation of motion by v and integrate over a
    /// period. The result is ∮v'² = ∮v² − ∮v df with the friction force f. With the relative
    /// velocity v_r, ∮v df = ∮v_r df = 0, because f depends on v_r alone in slip, and v_r is 0 in
    /// stick.
    ///
    /// ```
    /// use stick_slip::{MassOnBelt, Polynomial, limit_cycle};
    ///
    /// let system = MassOnBelt::new(Polynomial::new(0.4, 0.25, 0.5)?, 0.2)?.with_damping(0.05)?;
    /// let cycle = limit_cycle::stick_slip(&system)?.unwrap();
    /// assert!((cycle.rms_acceleration() - 0.1845106284158651).abs() < 1e-15);
    /// assert!((cycle.peak_acceleration() - 0.33677836529307).abs() < 1e-13);
    /// assert!((cycle.max_sliding_speed() - (0.2 - cycle.min_velocity())).abs() < 1e-16);
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    pub fn rms_acceleration(&self) -> f64 {
        self.units.rate * self.rms_velocity()
    }

    /// Largest size |v'| of the acceleration, dimensionless, including the values on both sides of
    /// each event.
    pub fn peak_acceleration(&self) -> f64 {
        let mut peak = 0.0_f64;
        for step in &self.steps {
            let (least, largest) = step.speed.derivative().extremes(step.duration);
            peak = peak.max(-least).max(largest);
        }
        peak
    }

    /// Largest sliding speed |v − v_b|, dimensionless. The law must be known up to this speed: a
    /// [table](crate::Tabulated) must not end below it.
    pub fn max_sliding_speed(&self) -> f64 {
        let [min, max] = self.velocities();
        let v_b = self.belt_velocity();
        (max - v_b).max(v_b - min)
    }

    /// Work and losses over one period, in dimensionless energy units (joules in SI units).
    ///
    /// The damper dissipates the work of friction on the mass, and the drive supplies both losses,
    /// because a period ends in the state in which it began. Two of the numbers are computed from
    /// integrals of u and v²; the others follow. At velocities above 10¹⁵³, caused by an unsuitable
    /// unit of length, a value can overflow to ±∞.
    pub fn energy(&self) -> EnergyBudget<f64> {
        let v_b = self.belt_velocity();
        // The force on the mass is f = u + 2βv + v', and over a period ∮v = ∮v' = ∮(u + v')v = 0.
        let Units {
            stiffness, rate, ..
        } = self.units;
        let unit = self.unit_of_velocity();
        let drive_work = stiffness * (v_b / unit) * self.integral_of_displacement(unit);
        let dissipation = 2.0 * self.damping * stiffness / rate;
        let damper_loss = dissipation * self.integral_of_squared_velocity(unit);
        let in_full = |energy: f64| energy * unit * unit;
        EnergyBudget {
            drive_work: in_full(drive_work),
            belt_work: in_full(damper_loss),
            damper_loss: in_full(damper_loss),
            friction_loss: in_full(drive_work - damper_loss),
            ..EnergyBudget::default()
        }
    }

    /// A power of two, at least 1, as a unit in which the squares of velocities do not overflow. A
    /// power of two causes no rounding.
    fn unit_of_velocity(&self) -> f64 {
        let [min, max] = self.velocities();
        let largest = self.belt_velocity().abs().max(-min).max(max);
        power_of_two(largest.max(1.0))
    }

    /// Such a unit of displacements, whose products with a long period do not overflow.
    fn unit_of_displacement(&self) -> f64 {
        let [min, max] = self.displacements();
        power_of_two(max.max(-min).max(1.0))
    }

    /// Mean displacement (1/T)∮u dτ, dimensionless.
    pub fn mean_displacement(&self) -> f64 {
        let unit = self.unit_of_displacement();
        unit * (self.integral_of_displacement(unit) / self.period())
    }

    /// The integral ∮u dτ over one period, with u counted in a unit.
    fn integral_of_displacement(&self, unit: f64) -> f64 {
        let over = |step: &Step| {
            let h = step.duration;
            let slipped = step.direction().map_or(0.0, |direction| {
                direction.sign() * step.speed.twice_integrated(h)
            });
            (step.state.displacement + (0.5 * step.belt_velocity + slipped) * h) / unit * h
        };
        self.steps.iter().map(over).sum()
    }

    /// The integral ∮v² dτ over one period, with v counted in a unit.
    fn integral_of_squared_velocity(&self, unit: f64) -> f64 {
        let over = |step: &Step| {
            let v_b = step.belt_velocity;
            let Some(direction) = step.direction() else {
                return (v_b / unit).powi(2) * step.duration;
            };
            let velocity = |s: f64| (v_b + direction.sign() * s) / unit;
            let four = |(times, weights): ([f64; 4], [f64; 4])| {
                let speeds = step.speed.at_four(times);
                std::iter::zip(weights, speeds)
                    .map(|(weight, s)| weight * velocity(s) * velocity(s))
                    .sum::<f64>()
            };
            gauss_fours(0.0, step.duration)
                .map(four)
                .iter()
                .sum::<f64>()
        };
        self.steps.iter().map(over).sum()
    }

    /// Least and largest displacement; each lies at an end of a step, or where v changes its sign.
    pub(super) fn displacements(&self) -> [f64; 2] {
        self.extremes(
            |state| state.displacement,
            |step| {
                let mut velocity = step.speed.scaled(step.sigma());
                velocity[0] += step.belt_velocity;
                velocity
            },
        )
    }

    /// Least and largest velocity; each lies at an end of a step, or where s' changes its sign.
    pub(super) fn velocities(&self) -> [f64; 2] {
        self.extremes(|state| state.velocity, |step| step.speed.derivative())
    }

    fn extremes(&self, quantity: fn(State) -> f64, rate: fn(&Step) -> PowerSeries) -> [f64; 2] {
        let mut range = [f64::INFINITY, f64::NEG_INFINITY];
        let mut include = |state: State| {
            let value = quantity(state);
            range = [range[0].min(value), range[1].max(value)];
        };
        for step in &self.steps {
            include(step.state());
            if step.direction().is_some() {
                rate(step).sign_changes(step.duration, &mut |t, _| {
                    include(step.state_at(t));
                });
            }
        }
        range
    }
}
