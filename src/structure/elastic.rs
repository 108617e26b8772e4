//! Elastic contacts, and contacts with their own normal spring.

use std::sync::Arc;

use super::contact::Contact;
use crate::error::Error;

/// Elastic contacts and normal springs.
impl Contact {
    /// Makes the contact elastic: its friction slider gets a spring of stiffness k_t > 0 in series.
    /// This is a Jenkins element, the model of a bolted joint or a blade root. The element acts as
    /// a spring until its slider slips.
    ///
    /// ```text
    /// stick:  T' = k_t r         while |T| ≤ μ N
    /// slip:   T = σ μ N          z' = r − σ μ N'/k_t,  σ z' ≥ 0,  σ = ±1
    /// open:   T = 0              N < 0, or N stays 0
    /// ```
    ///
    /// T is the force of the spring, r the relative velocity, μ the coefficient, N the normal load,
    /// z' the velocity of the slider, and σ the direction of z'. T takes the place of λ: the force
    /// on the structure is −b T. T is a memory variable of the contact:
    /// [`State::memory`](crate::structure::State::memory) contains T after the memory variables of
    /// the contacts with lower numbers. Events refer to the slider: it stops at an
    /// [`EventKind::Stick`](crate::EventKind::Stick), and starts in the direction σ at an
    /// [`EventKind::Release`](crate::EventKind::Release). In [`Mode::Stick`](crate::Mode::Stick)
    /// the slider sticks, and r may have any value. k_t is a force per displacement b·q, and μ is
    /// dimensionless. The velocity of the contact's surface may jump.
    ///
    /// The mode of an elastic contact does not depend on the modes of other contacts at the same
    /// instant, so elastic contacts may have linearly dependent directions. For k_t → ∞ the motion
    /// tends to the motion with a rigid contact. The difference is of order 1/√k_t, and the number
    /// of steps grows as √k_t.
    ///
    /// Source: G. M. Jenkins, *J. Appl. Phys.* 33 (1962); W. D. Iwan, *J. Appl. Mech.* 33 (1966)
    /// 893-900. The model is Moreau's sweeping process, called the *stop* operator in hysteresis
    /// theory.
    ///
    /// # Errors
    ///
    /// * [`Error::InvalidParameter`] unless k_t is positive and finite, or if the contact has a
    ///   [load law](Self::with_load_law);
    /// * [`Error::LawNotConstant`] unless the coefficient is constant, as in `Coulomb::new(μ, μ)`.
    ///   The reason: with static friction above kinetic friction, or with friction that falls with
    ///   speed, the displacement of the massless slider is not determined. Friction that depends on
    ///   the direction is refused, too.
    ///
    /// ```
    /// use stick_slip::{Contact, Coulomb, Drive, Structure, structure::State};
    ///
    /// // An element with k_t = 2 and μN = 3 on a surface that moves to −5, to 5, and to 0. The
    /// // mass is so large that it stays at rest.
    /// let way = [(0.0, -1.0), (5.0, -1.0), (5.0, 1.0), (15.0, 1.0), (15.0, -1.0)];
    /// let element = Contact::new(0, Coulomb::new(1.0, 1.0)?, 3.0)?
    ///     .with_tangential_stiffness(2.0)?
    ///     .on_belt(Drive::profile(&way)?);
    /// let wall = Structure::new(&[1e20])?.with_contact(element)?;
    /// let motion = wall.simulate(State::at_rest(1), 20.0)?;
    /// for (time, force) in [(0.0, 0.0), (5.0, 3.0), (6.5, 0.0), (8.0, -3.0)] {
    ///     assert!((motion.state_at(time).unwrap().memory[0] - force).abs() < 1e-14);
    /// }
    /// assert_eq!(motion.last().memory, [3.0]);
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    pub fn with_tangential_stiffness(mut self, tangential_stiffness: f64) -> Result<Self, Error> {
        Error::check(
            "Contact",
            "tangential_stiffness",
            tangential_stiffness,
            tangential_stiffness > 0.0,
            "tangential_stiffness > 0",
        )?;
        if self.law().constant().is_none() {
            return Err(Error::LawNotConstant {
                coefficients: self.coefficients_at_rest(),
            });
        }
        self.tangential_stiffness = Some(tangential_stiffness);
        self.check_load_laws()?;
        Ok(self)
    }

    /// Stiffness k_t of the spring in series, in units of force per displacement; `None` if the
    /// contact is rigid.
    pub fn tangential_stiffness(&self) -> Option<f64> {
        self.tangential_stiffness
    }

    /// Gives the contact a normal spring, so that the contact can open and close:
    ///
    /// ```text
    /// N = max(0, N0(t) + k_n d·q)
    /// ```
    ///
    /// d is the direction of the spring; its entries d_j are dimensionless. k_n > 0 is the
    /// stiffness, a force per displacement, and N0(t) the load that was given to the contact. The
    /// force of the spring on the structure is −d N. The contact opens when N0 + k_n d·q falls
    /// below 0, and closes when this sum rises above 0 again; both are events. N is a continuous
    /// function of q, so the contact closes without an impact. A load gradient n adds n·q inside
    /// the maximum. The contact may be rigid or elastic.
    ///
    /// A contact with a gap g has N = max(0, k_n (d·q − g)): give it the load N0 = −k_n g. It is
    /// open until d·q exceeds g.
    ///
    /// # Errors
    ///
    /// * [`Error::BadDirection`] if no coordinate is given, if a coordinate is given twice, if a
    ///   d_j is not finite, or if all d_j are 0;
    /// * [`Error::InvalidParameter`] unless k_n > 0, and k_n and each k_n d_j are finite.
    ///
    /// ```
    /// use stick_slip::{Contact, Coulomb, EventKind, Structure, structure::State};
    ///
    /// // A ball of mass 1 and weight 1 on a spring of stiffness 4, thrown up at the velocity 1.
    /// let spring = Contact::new(0, Coulomb::new(0.3, 0.3)?, 1.0)?
    ///     .with_normal_spring(&[(1, -1.0)], 4.0)?;
    /// let ball = Structure::new(&[1.0, 1.0])?.with_force(1, -1.0)?.with_contact(spring)?;
    /// let motion = ball.simulate(State::new(&[0.0, 0.0], &[0.0, 1.0]), 3.0)?;
    /// let [open, close] = motion.events() else { panic!() };
    /// assert_eq!([open.kind, close.kind], [EventKind::Open, EventKind::Close]);
    /// // It leaves the spring at q = 1/4, with v² = 1 − 1/4, and flies for the time 2v.
    /// assert!((open.state.displacements[1] - 0.25).abs() < 1e-15);
    /// assert!((close.time - open.time - 2.0 * 0.75_f64.sqrt()).abs() < 1e-14);
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    pub fn with_normal_spring(
        mut self,
        direction: &[(usize, f64)],
        normal_stiffness: f64,
    ) -> Result<Self, Error> {
        Error::check(
            "Contact",
            "normal_stiffness",
            normal_stiffness,
            normal_stiffness > 0.0,
            "normal_stiffness > 0",
        )?;
        let (_, direction) = super::direction::checked_direction(direction)?;
        for &(_, d) in &direction {
            let gradient = normal_stiffness * d;
            let is_finite = gradient.is_finite();
            Error::check("Contact", "gradient", gradient, is_finite, "k_n d_j finite")?;
        }
        self.normal_spring = Some((direction, normal_stiffness));
        Ok(self)
    }

    /// The normal spring of the contact: its direction d, by ascending coordinate, and its
    /// stiffness k_n, in units of force per displacement. `None` if the contact has no normal
    /// spring.
    pub fn normal_spring(&self) -> Option<(&[(usize, f64)], f64)> {
        let (direction, stiffness) = self.normal_spring.as_ref()?;
        Some((direction, *stiffness))
    }

    /// Returns elastic contacts in parallel that replace this contact. Each of the `elements` is a
    /// pair: the stiffness k_t, and the share of the load, of the load gradient and of the
    /// stiffness of the normal spring.
    ///
    /// Shares are positive and dimensionless; their sum need not be 1. A load that varies is shared
    /// in the same ratio at all times. The elements of an [`Iwan4`](crate::Iwan4) model are pairs
    /// of k_t and limit force: use them with a contact that has μ = 1 and N = 1.
    ///
    /// # Errors
    ///
    /// [`Error::InvalidParameter`] if there is no element, if a share is not positive and finite,
    /// or if a share of the load would overflow; the errors of
    /// [`with_tangential_stiffness`](Self::with_tangential_stiffness).
    ///
    /// ```
    /// use stick_slip::{Contact, Coulomb, Structure};
    ///
    /// let joint = Contact::between(0, 1, Coulomb::new(0.3, 0.3)?, 10.0)?;
    /// let elements = joint.in_parallel(&[(5.0, 0.25), (2.0, 0.75)])?;
    /// assert_eq!(elements[1].tangential_stiffness(), Some(2.0));
    /// assert_eq!(elements[1].load().value(0.0), 7.5);
    /// let masses = Structure::new(&[1.0, 1.0])?.with_contacts(elements)?;
    /// assert_eq!(masses.contacts().len(), 2);
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    pub fn in_parallel(&self, elements: &[(f64, f64)]) -> Result<Vec<Self>, Error> {
        let count = elements.len();
        let allowed = "at least one: their number";
        Error::check("Contact", "elements", count as f64, count > 0, allowed)?;
        let element = |&(tangential_stiffness, share): &(f64, f64)| {
            Error::check("Contact", "share", share, share > 0.0, "share > 0")?;
            let mut element = self
                .clone()
                .with_tangential_stiffness(tangential_stiffness)?;
            element.scale_load(share)?;
            Ok(element)
        };
        elements.iter().map(element).collect()
    }

    /// Multiplies the load, its gradient and its normal spring by a share.
    fn scale_load(&mut self, share: f64) -> Result<(), Error> {
        self.load = Arc::new(self.load.scaled(share));
        let spring = self.normal_spring.iter_mut();
        let gradients = self.load_gradient.iter_mut().map(|(_, n)| n);
        let mut largest = self.load.size();
        for number in gradients.chain(spring.map(|(_, stiffness)| stiffness)) {
            *number *= share;
            largest = largest.max(number.abs());
        }
        Error::check("Contact", "load", largest, true, "a finite share of it").map(drop)
    }
}
