//! Steady sliding at given velocities: rigid-body motions are left out, and contacts may stick.

use super::sliding_field::SlidingField;
use super::steady::{SteadySliding, check_numbers};
use super::system::Structure;
use crate::error::Error;

/// Steady sliding of structures that move as a whole.
impl Structure {
    /// Steady sliding at given velocities of the coordinates, for example of turning shafts. A
    /// contact with the relative velocity r_c = b_c·v − w_c ≠ 0 slips at the speed |r_c|; a contact
    /// with r_c = 0 (up to rounding of the sum) sticks.
    ///
    /// ```text
    /// K q + M a + Σ_c b_c λ_c = f − C v,    a: acceleration of a rigid-body motion
    /// ```
    ///
    /// The symbols are those of [`Structure`]. The velocities v must be those of a rigid-body
    /// motion: K v = 0, and no load changes along v. With v = 0 this is
    /// [`steady_sliding`](Self::steady_sliding), but contacts with surfaces at rest stick.
    ///
    /// * **Rigid-body motions** are directions e with K e = 0 along which no load changes, and
    ///   which contacts that stick allow. [`SteadySliding::displacements`] has no part along such
    ///   directions, and [`SteadySliding::eigenvalues`] does not contain their zeros: one for each
    ///   direction of displacements, and one for each direction of velocities along which neither a
    ///   damper nor friction changes. (A clutch with constant friction has such a velocity; the
    ///   slope of a law gives the clutch a real eigenvalue.)
    /// * If forces do not balance along a rigid-body motion, its velocity is not steady, as in a
    ///   clutch that engages. [`SteadySliding::accelerations`] is then not 0. The eigenvalues are
    ///   those at the given velocities, which must change little within 1/|s| for the eigenvalue s.
    /// * **A first-order state that integrates velocities**, as in PI control of a speed, has the
    ///   value at which forces balance along a rigid-body motion; no acceleration is left there.
    /// * **Contacts that stick.** In a rigid one b·δv = 0; an elastic one is a spring of stiffness
    ///   k_t. Either can carry any force within its limit, so the equilibria form a continuum. The
    ///   result is the equilibrium in which these contacts carry only forces that springs cannot
    ///   carry. The eigenvalues depend on these forces only if the load of a contact that slips
    ///   depends on displacements. The memory variables of these contacts have no eigenvalues here.
    ///
    /// # Errors
    ///
    /// [`Error::WrongSize`] unless there is a velocity for each coordinate;
    /// [`Error::InvalidParameter`] unless all are finite; the errors of
    /// [`steady_sliding`](Self::steady_sliding), except that a contact with the relative velocity 0
    /// is an error only if its law has friction and never sticks. Further reasons
    /// ([`NotSliding`](crate::structure::NotSliding)) are velocities that deform a spring, change a
    /// load or make a first-order state grow, and a contact that sticks if balance requires more
    /// than its limit force. The stiffness matrix must be non-singular on the directions that are
    /// not rigid-body motions.
    ///
    /// ```
    /// use stick_slip::{Contact, Exponential, Structure};
    ///
    /// // A clutch between a motor and a driveline of two inertias, slipping at 10 rad/s. Its
    /// // coefficient 0.3 + 0.05 e^{−(s/20)²} falls with the slip speed s; the load is 1000 N m.
    /// let (motor, gearbox, car, shaft) = (0.2, 0.05, 2.0, 500.0);
    /// let clutch = Contact::between(0, 1, Exponential::new(0.35, 0.3, 20.0)?, 1000.0)?;
    /// let driveline = Structure::new(&[motor, gearbox, car])?
    ///     .with_spring(1, 2, shaft)?
    ///     .with_contact(clutch)?;
    /// assert!(driveline.steady_sliding().is_err());
    /// let slipping = driveline.steady_sliding_at(&[110.0, 100.0, 100.0])?;
    ///
    /// // Two rigid-body displacements and one rigid-body velocity have no eigenvalue. The slope of
    /// // friction drives the shaft: it judders.
    /// let [first, second, third] = slipping.eigenvalues[..] else { panic!() };
    /// assert!(!slipping.is_stable() && first.re > 0.0 && second == first.conj());
    /// let fall = 0.05 * (-0.25_f64).exp();
    /// let slope = -2.0 * 10.0 / 400.0 * fall * 1000.0;
    /// // The cubic of slip speed and twist.
    /// let cubic = |s: stick_slip::nalgebra::Complex<f64>| {
    ///     let slip = s + slope * (1.0 / motor + 1.0 / gearbox);
    ///     let twist = s * s + shaft * (1.0 / gearbox + 1.0 / car);
    ///     (slip * twist - shaft * slope / (gearbox * gearbox)).norm()
    /// };
    /// assert!(cubic(first).max(cubic(third)) < 1e-12 * first.norm().powi(3));
    ///
    /// // The clutch slows the motor down: its speed is not steady.
    /// let torque = (0.3 + fall) * 1000.0;
    /// assert!((slipping.accelerations[0] + torque / motor).abs() < 1e-9);
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    pub fn steady_sliding_at(&self, velocities: &[f64]) -> Result<SteadySliding, Error> {
        check_numbers(self, ["velocities", "velocity"], velocities)?;
        let model = self.model();
        SteadySliding::of(SlidingField::at(&model, velocities)?)
    }
}
