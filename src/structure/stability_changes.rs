//! Changes of stability of steady sliding while drives vary slowly.

use std::ops::Range;
use std::sync::Arc;

use super::system::Structure;
use crate::drive::Drive;
use crate::error::Error;

/// A time at which steady sliding becomes unstable, or stable again, while the drives vary slowly:
/// see [`Structure::stability_changes`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct StabilityChange {
    /// The time, in the units of the structure.
    pub time: f64,
    /// True if steady sliding is stable after this time.
    pub becomes_stable: bool,
    /// Angular frequency of the small motion that neither grows nor decays at this time, in radians
    /// per unit of time; 0 if this motion does not oscillate.
    pub frequency: f64,
}

/// Equal parts of a range of times at whose ends stability is computed.
const PARTS: usize = 256;

/// Drives that vary slowly.
impl Structure {
    /// Returns this structure with every drive held constant at its value at the given time.
    ///
    /// # Errors
    ///
    /// [`Error::InvalidParameter`] if the time is not finite; [`Error::BadElement`] or
    /// [`Error::InvalidParameter`] if a drive is not finite at this time.
    ///
    /// ```
    /// use stick_slip::{Contact, Coulomb, Drive, Structure};
    ///
    /// let belt = Drive::profile(&[(0.0, 1.0), (10.0, 0.0)])?;
    /// let block = Structure::new(&[1.0])?
    ///     .with_ground_spring(0, 1.0)?
    ///     .with_contact(Contact::new(0, Coulomb::new(0.4, 0.3)?, 1.0)?.on_belt(belt))?;
    /// let then = block.frozen(4.0)?;
    /// assert_eq!(then.contacts()[0].belt_velocity().value(99.0), 0.6);
    /// assert_eq!(then.steady_sliding()?.displacements, [0.3]);
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    pub fn frozen(&self, time: f64) -> Result<Self, Error> {
        Error::check("Structure", "time", time, true, "any time")?;
        let held = |drive: &Drive| Drive::constant(drive.value(time));
        let mut frozen = Self::with_mass_matrix(self.mass_matrix().into_owned())?
            .with_stiffness(self.stiffness().clone())?
            .with_damping(self.damping().clone())?;
        for (i, force) in self.forces().iter().enumerate() {
            frozen = frozen.with_force(i, held(force))?;
        }
        for contact in self.contacts() {
            let mut contact = contact.clone().on_belt(held(contact.belt_velocity()));
            contact.load = Arc::new(held(&contact.load));
            let laws = contact.load_laws().iter().map(|law| law.frozen(time));
            let laws = laws.collect::<Result<_, Error>>()?;
            frozen = frozen.with_any_load(contact.with_load_laws(laws)?)?;
        }
        for element in self.elements() {
            frozen = frozen.with_element(element.frozen(time)?)?;
        }
        for stop in self.stops() {
            frozen = frozen.with_stop(stop.clone())?;
        }
        let states = self.first_orders().iter();
        frozen.with_first_orders(states.map(|state| state.frozen(time)))
    }

    /// The times at which steady sliding of the [frozen](Self::frozen) structure becomes unstable
    /// or stable again, in ascending order. If speed or load change slowly, small vibration grows
    /// between a time at which sliding becomes unstable and the next time at which it becomes
    /// stable.
    ///
    /// Stability is computed at 257 equally spaced instants of the range, at each point of a
    /// [profile](crate::Drive::profile), and at each breakpoint of a
    /// [function](crate::Drive::function). Each change is refined by bisection to the last bit. Two
    /// changes between neighbouring instants can be missed; choose a narrower range for a denser
    /// search. No change is reported while there is no steady sliding, for example while a belt is
    /// at rest.
    ///
    /// # Delayed loss of stability
    ///
    /// If the drives vary slowly, vibration does not begin immediately when steady sliding becomes
    /// unstable. While sliding is stable, a perturbation decays as exp ∫Re s dt, where s is the
    /// eigenvalue with the largest real part. After the loss of stability the perturbation must
    /// grow by the same factor before vibration is visible. The delay is therefore determined by
    /// the level to which the perturbation has decayed. In exact arithmetic the decay is not
    /// limited, and the delay lasts until growth has compensated the whole decay. In floating-point
    /// arithmetic, rounding limits the decay to a factor of about 10⁻¹⁶. In a real machine,
    /// roughness, noise or external vibration limit the decay much earlier. In a simulation without
    /// a disturbance, the onset of vibration is therefore a property of the arithmetic. Add a
    /// disturbance as large as that of the machine at frequencies near
    /// [`StabilityChange::frequency`]. Other frequencies have little effect. (A kink of a profile
    /// is a disturbance, too.)
    ///
    /// ```
    /// use stick_slip::{Contact, Drive, EventKind, Exponential, Structure, structure::State};
    ///
    /// // A belt that slows down from 1.2 to 0.4, and a disturbance near the natural frequency.
    /// let belt = Drive::profile(&[(0.0, 1.2), (4000.0, 0.4)])?;
    /// let slowing = |disturbance: f64| {
    ///     let contact = Contact::new(0, Exponential::new(0.4, 0.25, 0.5)?, 1.0)?;
    ///     Structure::new(&[1.0])?
    ///         .with_ground_spring(0, 1.0)?
    ///         .with_ground_damper(0, 0.1)?
    ///         .with_force(0, Drive::sine(disturbance, 1.0)?)?
    ///         .with_contact(contact.on_belt(belt.clone()))
    /// };
    /// let limit = slowing(0.0)?.stability_changes(0.0..4000.0)?[0];
    /// assert!(!limit.becomes_stable && (limit.frequency - 1.0).abs() < 1e-12);
    ///
    /// // Time of the first stick: disturbances of 10⁻³ and 10⁻⁹ of the load, then none.
    /// let onset = |disturbance: f64| -> Result<f64, stick_slip::Error> {
    ///     let motion = slowing(disturbance)?.simulate(State::new(&[0.26], &[0.0]), 4000.0)?;
    ///     let mut sticks = motion.events().iter().filter(|event| event.kind == EventKind::Stick);
    ///     Ok(sticks.next().map_or(f64::INFINITY, |event| event.time))
    /// };
    /// let [real, small, rounding] = [onset(1e-3)?, onset(1e-9)?, onset(0.0)?];
    /// assert_eq!([limit.time, real, small].map(f64::round), [2307.0, 2509.0, 3093.0]);
    /// assert!(rounding > 3300.0);
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    ///
    /// Source: A. I. Neishtadt, *Differential Equations* 23 (1987) 1385-1391; S. M. Baer, T.
    /// Erneux, J. Rinzel, *SIAM J. Appl. Math.* 49 (1989) 55-71.
    ///
    /// # Errors
    ///
    /// [`Error::InvalidParameter`] unless both ends of the range are finite and the start is below
    /// the end; the errors of [`frozen`](Self::frozen).
    #[doc(alias = "Hopf")]
    #[doc(alias = "slow passage")]
    pub fn stability_changes(&self, times: Range<f64>) -> Result<Vec<StabilityChange>, Error> {
        let names = ["times.start", "times.end"];
        Error::check_range("Structure::stability_changes", names, &times)?;
        let Range { start, end } = times;
        let width = end - start;
        let parts = (0..=PARTS).map(|i| start + width * (i as f64 / PARTS as f64));
        let mut places: Vec<f64> = parts.collect();
        places.extend(self.drives().flat_map(|drive| drive.breaks_in(start, end)));
        places.sort_by(f64::total_cmp);
        places.dedup();
        let mut changes = Vec::new();
        let mut last: Option<(f64, bool)> = None;
        for time in places {
            let here = self.is_stable_at(time)?.map(|stable| (time, stable));
            if let (Some(before), Some(after)) = (last, here)
                && before.1 != after.1
                && let Some(change) = self.change_between(before, after)?
            {
                changes.push(change);
            }
            last = here;
        }
        Ok(changes)
    }

    /// Returns true if steady sliding is stable with the drives held at a time; `None` if there is
    /// no steady sliding.
    fn is_stable_at(&self, time: f64) -> Result<Option<bool>, Error> {
        match self.frozen(time)?.steady_sliding() {
            Ok(sliding) => Ok(Some(sliding.is_stable())),
            Err(Error::NoSteadySliding(_)) => Ok(None),
            Err(error) => Err(error),
        }
    }

    /// The change between two times; `None` if steady sliding ends between them.
    fn change_between(
        &self,
        (mut low, is_stable): (f64, bool),
        (mut high, becomes_stable): (f64, bool),
    ) -> Result<Option<StabilityChange>, Error> {
        loop {
            let middle = 0.5 * low + 0.5 * high;
            if !(low < middle && middle < high) {
                break;
            }
            match self.is_stable_at(middle)? {
                Some(stable) if stable == is_stable => low = middle,
                Some(_) => high = middle,
                None => return Ok(None),
            }
        }
        let sliding = self.frozen(high)?.steady_sliding()?;
        let frequency = sliding.eigenvalues[0].im.abs();
        Ok(Some(StabilityChange {
            time: high,
            becomes_stable,
            frequency,
        }))
    }
}
