//! Measures of a periodic motion: extremes as roots of its power series, means and harmonics as
//! integrals over them.

use std::ops::ControlFlow;

use nalgebra::DVector;
use num_complex::Complex;

use super::form::GeneralForm;
use super::oscillator::Oscillator;
use super::periodic_orbit::Orbit;
use crate::clock::Clock;
use crate::motion::{Mode, Segment, System};
use crate::numerics::gauss::{gauss_legendre, gauss_nodes};
use crate::numerics::power_of_two;
use crate::series::PowerSeries;
use crate::structure::{EnergyBudget, Step};

/// Measures taken once a motion is found.
#[derive(Debug, Clone)]
pub(super) struct Measures {
    coordinates: Vec<Coordinate>,
    contacts: Vec<Contact>,
    pub(super) energy: EnergyBudget,
}

#[derive(Debug, Clone, Copy)]
struct Coordinate {
    /// Least and largest displacement (minus the translation), velocity and acceleration.
    ranges: [(f64, f64); 3],
    mean: f64,
    mean_velocity: f64,
    rms_velocity: f64,
    rms_acceleration: f64,
}

#[derive(Debug, Clone, Copy)]
struct Contact {
    stick_duration: f64,
    max_sliding_speed: f64,
}

impl Measures {
    /// The measures of one period, from the steps and the translation in this period.
    pub(super) fn of(
        form: &GeneralForm<'_>,
        (steps, translation): (&[Step], &DVector<f64>),
        period: f64,
        energy: EnergyBudget,
    ) -> Self {
        let coordinate = |i: usize| Coordinate::of(steps, i, (translation[i], period));
        let coordinates = (0..form.len()).map(coordinate);
        Self {
            coordinates: coordinates.collect(),
            contacts: (0..form.contacts())
                .map(|c| Contact::of(form, steps, c))
                .collect(),
            energy,
        }
    }
}

impl Coordinate {
    fn of(steps: &[Step], coordinate: usize, (translation, period): (f64, f64)) -> Self {
        let mean_velocity = translation / period;
        let ranges = extremes(steps, coordinate, mean_velocity);
        let largest = |(least, most): (f64, f64)| f64::max(-least, most);
        let series = |step: &Step| step.series().get(coordinate).copied();
        // In units of the largest value, so that squares do not overflow.
        let rms = |which: usize, value: fn(&PowerSeries, f64) -> f64| {
            let unit = largest(ranges[which]);
            if unit == 0.0 {
                return 0.0;
            }
            let squares = steps.iter().filter_map(|step| {
                let series = series(step)?;
                let square = |t: f64| (value(&series, t) / unit).powi(2);
                let nodes = gauss_nodes(0.0, step.duration());
                Some(nodes.map(|(t, weight)| weight * square(t)).sum::<f64>())
            });
            unit * (squares.sum::<f64>() / period).sqrt()
        };
        // Products with a long period do not overflow in this unit.
        let unit = power_of_two(largest(ranges[0]).max(1.0));
        let integrals = steps.iter().filter_map(|step| {
            let (h, velocity) = (step.duration(), series(step)?);
            // ∫∫v = h² Σ v_k h^k/((k + 1)(k + 2))
            let twice = PowerSeries::from_fn(|k| velocity[k] / ((k + 1) * (k + 2)) as f64);
            let middle = step.start_time() + 0.5 * h;
            let start = step.state().displacements[coordinate] - mean_velocity * middle;
            Some((start + twice.at(h) * h) / unit * h)
        });
        Self {
            mean: unit * (integrals.sum::<f64>() / period),
            mean_velocity,
            rms_velocity: rms(1, PowerSeries::at),
            rms_acceleration: rms(2, PowerSeries::slope_at),
            ranges,
        }
    }
}

impl Contact {
    fn of(form: &GeneralForm<'_>, steps: &[Step], number: usize) -> Self {
        let contact = &form.model.contacts[number];
        let mut clock = Clock::default();
        let mut max_sliding_speed = 0.0_f64;
        for step in steps {
            if step.modes()[number] == Mode::Stick {
                clock = clock.after(step.duration());
            }
            if !matches!(step.modes()[number], Mode::Slip(_)) || step.series().is_empty() {
                continue;
            }
            let mut relative = contact.belt_velocity.series(step.clock()).scaled(-1.0);
            for &(j, b) in contact.direction.iter() {
                relative.add(b, &step.series()[j]);
            }
            let mut meet = |t: f64| max_sliding_speed = max_sliding_speed.max(relative.at(t).abs());
            meet(0.0);
            meet(step.duration());
            at_extremes(&relative.derivative(), step.duration(), &mut meet);
        }
        Self {
            stick_duration: clock.time,
            max_sliding_speed,
        }
    }
}

impl<S: System> Orbit<S> {
    /// Number of coordinates.
    #[cfg(feature = "serde")]
    pub(super) fn coordinates(&self) -> usize {
        self.measures.coordinates.len()
    }

    fn coordinate<T>(&self, coordinate: usize, of: impl Fn(&Coordinate) -> T) -> Option<T> {
        self.measures.coordinates.get(coordinate).map(of)
    }

    fn contact(&self, contact: usize, of: impl Fn(&Contact) -> f64) -> f64 {
        self.measures.contacts.get(contact).map_or(f64::NAN, of)
    }

    fn range(&self, coordinate: usize, which: usize) -> (f64, f64) {
        let range = self.coordinate(coordinate, |of| of.ranges[which]);
        range.unwrap_or((f64::NAN, f64::NAN))
    }
}

/// Measures of the motion, with the names of the measures of a [`LimitCycle`](crate::LimitCycle). A
/// measure is NaN if the coordinate or the contact does not exist.
impl<S: System> Orbit<S> {
    /// Angular frequency ω = 2π/T, per unit of time.
    pub fn frequency(&self) -> f64 {
        std::f64::consts::TAU / self.period()
    }

    /// Least and largest displacement of a coordinate. If the motion is periodic only up to a
    /// [translation](Self::mean_velocity), displacements are relative to a frame that moves at the
    /// mean velocity from time 0 on.
    pub fn extremes(&self, coordinate: usize) -> (f64, f64) {
        self.range(coordinate, 0)
    }

    /// Least and largest velocity of a coordinate.
    pub fn velocity_extremes(&self, coordinate: usize) -> (f64, f64) {
        self.range(coordinate, 1)
    }

    /// Least and largest acceleration of a coordinate, including the values on both sides of each
    /// event.
    pub fn acceleration_extremes(&self, coordinate: usize) -> (f64, f64) {
        self.range(coordinate, 2)
    }

    /// Amplitude of a coordinate: half the distance between its largest and its least displacement.
    ///
    /// ```
    /// use stick_slip::orbit::{self, Period};
    /// use stick_slip::{Contact, Drive, Polynomial, Structure, structure::State};
    ///
    /// let contact = Contact::new(0, Polynomial::new(0.4, 0.25, 0.5)?, 1.0)?.on_belt(0.2);
    /// let forced = Structure::new(&[1.0])?
    ///     .with_ground_spring(0, 1.0)?
    ///     .with_ground_damper(0, 0.1)?
    ///     .with_force(0, Drive::harmonic(0.15, 0.8, 0.0)?)?
    ///     .with_contact(contact)?;
    /// let orbit = orbit::settle(&forced, &State::at_rest(1), 100.0, Period::Driven(1))?;
    /// assert!((orbit.amplitude(0) - 0.4223186731942).abs() < 1e-12);
    /// assert!((orbit.rms_velocity(0) - 0.2387076461704).abs() < 1e-12);
    ///
    /// // Most of the vibration has the frequency of the force.
    /// let harmonics = orbit.harmonics(0, 3);
    /// assert!(harmonics[0].norm() > 3.0 * harmonics[1].norm());
    ///
    /// // The work of the force and of the belt becomes heat, in the damper and in the contact.
    /// let energy = orbit.energy();
    /// let heat = energy.damper_loss + energy.friction_loss[0];
    /// assert!((energy.force_work[0] + energy.drive_work[0] - heat).abs() < 1e-14);
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    pub fn amplitude(&self, coordinate: usize) -> f64 {
        let (least, largest) = self.extremes(coordinate);
        0.5 * (largest - least)
    }

    /// Mean velocity V = (q(T) − q(0))/T of a coordinate. V differs from 0 only if the motion is
    /// periodic [up to a translation](super#motions-that-are-translated).
    ///
    /// The displacement is the sum of Vt and a periodic part. [`extremes`](Self::extremes),
    /// [`amplitude`](Self::amplitude), [`mean_displacement`](Self::mean_displacement) and
    /// [`harmonics`](Self::harmonics) are measures of the periodic part. The result is NaN if the
    /// coordinate does not exist.
    pub fn mean_velocity(&self, coordinate: usize) -> f64 {
        self.coordinate(coordinate, |of| of.mean_velocity)
            .unwrap_or(f64::NAN)
    }

    /// Mean displacement (1/T)∮q dt of a coordinate, without the
    /// [translation](Self::mean_velocity).
    pub fn mean_displacement(&self, coordinate: usize) -> f64 {
        self.coordinate(coordinate, |of| of.mean)
            .unwrap_or(f64::NAN)
    }

    /// Root mean square of the velocity of a coordinate, √((1/T)∮v² dt).
    #[doc(alias = "severity")]
    pub fn rms_velocity(&self, coordinate: usize) -> f64 {
        let found = self.coordinate(coordinate, |of| of.rms_velocity);
        found.unwrap_or(f64::NAN)
    }

    /// Root mean square of the acceleration of a coordinate, √((1/T)∮v'² dt).
    pub fn rms_acceleration(&self, coordinate: usize) -> f64 {
        let found = self.coordinate(coordinate, |of| of.rms_acceleration);
        found.unwrap_or(f64::NAN)
    }

    /// Largest absolute acceleration |v'| of a coordinate, including the values on both sides of
    /// each event.
    pub fn peak_acceleration(&self, coordinate: usize) -> f64 {
        let (least, largest) = self.acceleration_extremes(coordinate);
        largest.max(-least)
    }

    /// Time that a contact sticks in each period, in units of time; NaN if the contact does not
    /// exist.
    pub fn stick_duration(&self, contact: usize) -> f64 {
        self.contact(contact, |of| of.stick_duration)
    }

    /// Largest sliding speed |r| of a contact while it slips, where r is the relative velocity; 0
    /// if the contact never slips. The friction law must be valid up to this speed.
    pub fn max_sliding_speed(&self, contact: usize) -> f64 {
        self.contact(contact, |of| of.max_sliding_speed)
    }

    /// Work and heat over one period, for each force, contact and damper. For a
    /// [`MassOnBelt`](crate::MassOnBelt) these are the values of
    /// [`LimitCycle::energy`](crate::LimitCycle::energy). A value with a term that
    /// overflows is ±∞, or NaN if terms of both signs do.
    pub fn energy(&self) -> &EnergyBudget {
        &self.measures.energy
    }
}

impl<S: Oscillator> Orbit<S> {
    /// Complex amplitudes of the first n harmonics of a coordinate's displacement: (2/T)∮q
    /// e^(−ikωt) dt for k = 1, …, n, with ω = 2π/T and the time t from the start of the period
    /// ([`state`](Self::state)). The modulus is the amplitude of the harmonic. Each harmonic is
    /// computed by a separate quadrature. The cost of the k-th is proportional to k, so that of n
    /// harmonics grows as n². The list is empty if the coordinate does not exist.
    #[doc(alias = "spectrum")]
    #[doc(alias = "fft")]
    pub fn harmonics(&self, coordinate: usize, n: usize) -> Vec<Complex<f64>> {
        let measured = self.coordinate(coordinate, |of| (of.mean, of.mean_velocity));
        let Some((mean, velocity)) = measured else {
            return Vec::new();
        };
        let steps = self.trajectory().steps();
        let (least, most) = self.extremes(coordinate);
        let unit = power_of_two(most.max(-least).max(1.0));
        let harmonic = |k: usize| {
            let omega = k as f64 * self.frequency();
            let part = |weight: fn(f64) -> f64| {
                let over = |step: &<S::State as crate::motion::SystemState>::Step| {
                    let (start, h) = (step.start_time(), step.duration());
                    // Pieces of at most one radian of the harmonic.
                    let pieces = (omega * h).ceil().max(1.0);
                    let width = h / pieces;
                    (0..pieces as usize)
                        .map(|i| {
                            let from = i as f64 * width;
                            gauss_legendre(from, from + width, |t| {
                                let state = S::general(&step.state_at(t));
                                let displacement = state.displacements[coordinate];
                                let time = start + t;
                                (displacement - velocity * time - mean) / unit
                                    * weight(omega * time)
                            })
                        })
                        .sum::<f64>()
                };
                let moving = steps.iter().filter(|step| step.duration() > 0.0);
                moving.map(over).sum::<f64>()
            };
            Complex::new(part(f64::cos), -part(f64::sin)) * (2.0 / self.period()) * unit
        };
        (1..=n).map(harmonic).collect()
    }

    /// Complex amplitudes of the first n harmonics of a coordinate's velocity. The k-th amplitude
    /// is ikω times that of the displacement, with ω = 2π/T.
    #[doc(alias = "spectrum")]
    #[doc(alias = "fft")]
    pub fn velocity_harmonics(&self, coordinate: usize, n: usize) -> Vec<Complex<f64>> {
        self.differentiated(coordinate, n, 1)
    }

    /// Complex amplitudes of the first n harmonics of a coordinate's acceleration. The k-th
    /// amplitude is (ikω)² times that of the displacement, with ω = 2π/T. If the acceleration jumps
    /// at events, the k-th amplitude decreases only as 1/k.
    #[doc(alias = "spectrum")]
    #[doc(alias = "fft")]
    pub fn acceleration_harmonics(&self, coordinate: usize, n: usize) -> Vec<Complex<f64>> {
        self.differentiated(coordinate, n, 2)
    }

    fn differentiated(&self, coordinate: usize, n: usize, times: i32) -> Vec<Complex<f64>> {
        let mut harmonics = self.harmonics(coordinate, n);
        for (k, amplitude) in (1..).zip(&mut harmonics) {
            *amplitude *= Complex::new(0.0, f64::from(k) * self.frequency()).powi(times);
        }
        harmonics
    }
}

/// Calls `meet` where a series changes its sign in a step.
fn at_extremes(rate: &PowerSeries, h: f64, meet: &mut dyn FnMut(f64)) {
    let _ = rate.sign_changes(h, &mut |t, _| {
        meet(t);
        ControlFlow::Continue(())
    });
}

/// Least and largest displacement (minus the translation), velocity and acceleration of a
/// coordinate, among the ends of steps and the zeros of the derivatives.
fn extremes(steps: &[Step], coordinate: usize, mean_velocity: f64) -> [(f64, f64); 3] {
    let mut ranges = [(f64::INFINITY, f64::NEG_INFINITY); 3];
    let mut meet = |which: usize, value: f64| {
        let (least, largest): &mut (f64, f64) = &mut ranges[which];
        (*least, *largest) = (least.min(value), largest.max(value));
    };
    for step in steps {
        let ends = [step.start_time(), step.end_time()];
        for (time, state) in std::iter::zip(ends, [step.state(), &step.end_state()]) {
            meet(0, state.displacements[coordinate] - mean_velocity * time);
            meet(1, state.velocities[coordinate]);
        }
        let Some(velocity) = step.series().get(coordinate) else {
            continue;
        };
        let h = step.duration();
        let start = step.state().displacements[coordinate] - mean_velocity * step.start_time();
        let mut relative = *velocity;
        relative[0] -= mean_velocity;
        let acceleration = velocity.derivative();
        meet(2, acceleration.at(0.0));
        meet(2, acceleration.at(h));
        at_extremes(&relative, h, &mut |t| meet(0, start + t * relative.mean(t)));
        at_extremes(&acceleration, h, &mut |t| meet(1, velocity.at(t)));
        at_extremes(&acceleration.derivative(), h, &mut |t| {
            meet(2, acceleration.at(t));
        });
    }
    ranges
}
