/// Energy budget of a motion: work and heat. `EnergyBudget` has one entry for each force and
/// contact of a [`Structure`](crate::Structure); `EnergyBudget<f64>` is that of one mass on a belt.
///
/// ```text
/// E = ½ vᵀMv + ½ qᵀK_s q + Σ T²/(2k_t) + Σ N²/(2k_n) + Σ D U,    K_s = (K + Kᵀ)/2
/// stored = Σ force_work + Σ drive_work + Σ normal_work + Σ element_work + Σ first_order_work
///          + circulation − damper_loss − Σ friction_loss − Σ stop_loss
/// drive_work = belt_work + friction_loss + Δ[T²/(2k_t)]        for each contact
/// ```
///
/// E is the energy of a state, and `stored` is E at the end of the motion minus E at its start. The
/// other terms are integrals over the power series of the motion. The equations for
/// `stored` and `drive_work` hold up to rounding; `defect()` is the residual of the equation for
/// `stored`. Over a period of a periodic motion `stored` is 0.
///
/// The symbols are those of [`Structure`](crate::Structure) and [`Contact`](crate::Contact). λ is
/// the friction force of a contact; in an elastic contact of stiffness k_t it is T. N and k_n are
/// the load and the stiffness of a normal spring. U is the potential of a [force
/// element](crate::ForceElement), 0 if its law has none, and D its factor; of a
/// [stop](crate::Stop) it is ½kδ² where δ > 0, and D = 1. Friction exerts the
/// force −b λ on the coordinates and the force λ on the surface, which moves with the velocity w. Δ
/// is the change over the motion. The unit is force times displacement. For a mass on a belt
/// energies are dimensionless, and [`Scaling`](crate::Scaling) converts them to joules:
/// `newtons(metres(energy))`.
///
/// ```
/// use stick_slip::{Contact, Coulomb, Structure, structure::State};
///
/// // Block 0 slides on the ground until it stops, and a belt carries block 1 along.
/// let ground = Contact::new(0, Coulomb::new(0.4, 0.25)?, 8.0)?;
/// let belt = Contact::new(1, Coulomb::new(0.4, 0.25)?, 8.0)?.on_belt(1.0);
/// let blocks = Structure::new(&[2.0, 2.0])?.with_contact(ground)?.with_contact(belt)?;
/// let motion = blocks.simulate(State::new(&[0.0, 0.0], &[3.0, 0.0]), 5.0)?;
/// let energy = blocks.energy_budget(&motion)?;
/// // ½·2·3² becomes heat. Half of the belt's work moves block 1, and half is heat: ½·2·1² each.
/// assert!((energy.friction_loss[0] - 9.0).abs() < 1e-14);
/// assert!((energy.belt_work[1] - 1.0).abs() < 1e-15);
/// assert!((energy.drive_work[1] - 2.0).abs() < 1e-15);
/// assert!((energy.stored + 8.0).abs() < 1e-14 && energy.defect().abs() < 1e-14);
/// # Ok::<(), stick_slip::Error>(())
/// ```
///
/// The cycle of a mass on a belt, for which `belt_work = damper_loss` and
/// `drive_work = damper_loss + friction_loss = v_b ∮u dτ`, with the belt velocity v_b, the
/// displacement u and the time τ:
///
/// ```
/// use stick_slip::{MassOnBelt, Polynomial, limit_cycle};
///
/// let system = MassOnBelt::new(Polynomial::new(0.4, 0.25, 0.5)?, 0.2)?.with_damping(0.05)?;
/// let cycle = limit_cycle::stick_slip(&system)?.unwrap();
/// let energy = cycle.energy();
/// assert!((energy.drive_work - 0.393077187566709).abs() < 1e-14);
/// assert!((energy.damper_loss - 0.023148067314534).abs() < 1e-14);
/// assert!((energy.friction_loss - 0.369929120252175).abs() < 1e-14);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct EnergyBudget<C = Vec<f64>> {
    /// The change of the energy E: E at the end of the motion minus E at its start. Of a drive that
    /// jumps at the end of the motion, the value before the jump counts.
    pub stored: f64,
    /// Work of the force on each coordinate, ∫ f_i v_i dt.
    pub force_work: C,
    /// Work of the drive that moves the surface of each contact, −∫ λ w dt: positive if the drive
    /// pulls against friction.
    pub drive_work: C,
    /// Work that the friction of each contact does on the coordinates, −∫ λ b·v dt: positive if
    /// friction drives the masses.
    pub belt_work: C,
    /// Heat in each contact, ∫ λ r dt; in an elastic contact ∫ μN|z'| dt, with the velocity z' of
    /// its slider. In a contact with bristles the integral also contains the change of the energy
    /// stored in the bristles.
    pub friction_loss: C,
    /// Work of the moving base of each normal spring, ∫ N (N0' + n·v)/k_n dt. N is the load; the
    /// base moves by (N0 + n·q)/k_n. N0(t) is the load given to the contact, and n its load
    /// gradient; a load law φ is a part of N0 here. 0 for a contact without a normal spring.
    pub normal_work: C,
    /// Work of each force element beyond its potential, ∫ (D' U − D Σ y_i (F_i − ∂U/∂x_i)) dt: 0
    /// if its force has a potential and its factor is constant; without a potential, all its work.
    pub element_work: C,
    /// Work of the forces of each [first-order state](crate::FirstOrder), ∫ z Σ b_i v_i dt.
    pub first_order_work: C,
    /// Heat in the damper of each [stop](crate::Stop), ∫ (F − kδ) δ' dt while δ > 0. After a force
    /// that never pulls has ended, its spring relaxes against the damper.
    pub stop_loss: C,
    /// Heat in all dampers, ∫ vᵀCv dt.
    pub damper_loss: f64,
    /// Work of the skew-symmetric part of the stiffness matrix, −∫ vᵀ(K − Kᵀ)q/2 dt; 0 if K is
    /// symmetric.
    pub circulation: f64,
}

impl EnergyBudget {
    /// Residual of the energy balance: `stored` − (Σ `force_work` + Σ `drive_work` + Σ
    /// `normal_work` + Σ `element_work` + Σ `first_order_work` + `circulation`) + `damper_loss` + Σ
    /// `friction_loss` + Σ `stop_loss`. `belt_work` is no term of its own, because `drive_work`
    /// contains it. With the default tolerance of the integrator the residual consists of rounding
    /// errors. With a larger tolerance it estimates the error of the motion.
    pub fn defect(&self) -> f64 {
        let work = [
            &self.force_work,
            &self.drive_work,
            &self.normal_work,
            &self.element_work,
            &self.first_order_work,
        ];
        let work = work.into_iter().flatten().sum::<f64>() + self.circulation;
        let losses = self.friction_loss.iter().chain(&self.stop_loss);
        let losses = losses.sum::<f64>() + self.damper_loss;
        self.stored - (work - losses)
    }
}
