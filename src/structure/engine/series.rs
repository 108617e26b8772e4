//! The data of one step: the power series of all coordinates and contacts.

use super::groups::Groups;
use super::model::Model;
use crate::friction::slip::Expander;
use crate::scalar::jet::Tape;
use crate::series::{INTEGRAL, PowerSeries, TERMS};

/// The power series of a step.
#[derive(Debug, Clone)]
pub(super) struct Series {
    pub(super) coordinates: Vec<CoordinateSeries>,
    pub(super) contacts: Vec<ContactSeries>,
    /// The given forces on coordinates with springs of contacts, divided by the mass.
    pub(super) given: Vec<PowerSeries>,
    /// The sizes of the forces of springs on these coordinates at the start.
    pub(super) spring_sizes: Vec<f64>,
    /// Room for one order of the shared coordinates and contacts.
    pub(super) rates: Vec<f64>,
    pub(super) unheld: Vec<f64>,
    pub(super) held: Vec<f64>,
    /// Bound of rounding of that order of the shared coordinates, where it counts.
    pub(super) rounding: Vec<f64>,
    /// Present if all loads are constant and no contact has a normal spring: none opens.
    pub(super) groups: Option<Groups>,
    /// For a coordinate that slips alone.
    pub(super) expander: Expander,
}

/// The mode of a contact in a step, for its series.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum StepMode {
    Open,
    Stick,
    Slip,
}

/// The series at one contact. All forces are accelerations of r: multiplied by G_cc.
#[derive(Debug, Clone)]
pub(super) struct ContactSeries {
    /// The mode of the contact in the step.
    pub(super) mode: StepMode,
    /// σ in slip; 0 in stick, and 1 for one that is open.
    pub(super) side: f64,
    /// The piece of the law that holds in slip.
    pub(super) piece: usize,
    /// dy/dt at the start, where it is known.
    pub(super) rate: Option<f64>,
    /// μ_s at the start.
    pub(super) limit: f64,
    /// y.
    pub(super) speeds: PowerSeries,
    /// w.
    pub(super) surface: PowerSeries,
    /// Σ b_j v_j of an elastic contact, where contacts that stick determine it.
    pub(super) guided: Option<PowerSeries>,
    /// The force in stick. For a contact with its own coordinate, also in slip, unless it slips
    /// alone without a drive: the force that stick would need, from order 1 on.
    pub(super) carried: PowerSeries,
    /// N μ_s; without terms beyond the first for a constant load and a law without memory.
    pub(super) bound: PowerSeries,
    /// N.
    pub(super) load: PowerSeries,
    /// Its part that is given in time.
    pub(super) drive_load: PowerSeries,
    /// True if N varies.
    pub(super) load_varies: bool,
    /// r' at the start of the step without the forces of all shared contacts at r = 0.
    pub(super) free: f64,
    /// σμ in slip.
    pub(super) friction: PowerSeries,
    /// Its derivative by the sliding speed, at the start of the step.
    pub(super) slope: f64,
    /// μ_s, if the law has a memory.
    pub(super) limits: PowerSeries,
    pub(super) memories: Vec<PowerSeries>,
    /// One order of the rates of the memory.
    pub(super) rates: Vec<f64>,
    /// D, the rate at which the memory relaxes, if its series is that of the slow manifold;
    /// otherwise 0.
    pub(super) relaxation: f64,
    pub(super) tape: Tape,
}

/// The series of one displacement q: its value, then the coefficients of the velocity v = q', so
/// that number k is q_0 or k q_k.
#[derive(Debug, Clone)]
pub(super) struct DisplacementSeries {
    numbers: [f64; TERMS + 1],
    /// The coefficient of the velocity that was set last, stored separately. If it were stored next
    /// to the one before it, the processor would load both at once, and would have to wait for the
    /// store.
    newest: f64,
}

impl DisplacementSeries {
    pub(super) const ZERO: Self = Self {
        numbers: [0.0; TERMS + 1],
        newest: 0.0,
    };

    /// The factors of coefficient k in the displacement: 1/k, and 1 for its value.
    const WEIGHTS: [f64; TERMS + 1] = {
        let mut weights = [1.0; TERMS + 1];
        let mut k = 1;
        while k <= TERMS {
            weights[k] = INTEGRAL[k - 1];
            k += 1;
        }
        weights
    };

    pub(super) fn start(&mut self, displacement: f64, velocity: f64) {
        [self.numbers[0], self.numbers[1]] = [displacement, velocity];
        self.newest = velocity;
    }

    #[inline(always)]
    pub(super) fn displacement(&self, k: usize) -> f64 {
        self.numbers[k] * Self::WEIGHTS[k]
    }

    #[inline(always)]
    pub(super) fn velocity(&self, k: usize) -> f64 {
        self.numbers[k + 1]
    }

    /// The velocity coefficient of the highest order so far.
    #[inline(always)]
    pub(super) fn newest_velocity(&self) -> f64 {
        self.newest
    }

    #[inline(always)]
    pub(super) fn set_velocity(&mut self, k: usize, coefficient: f64) {
        self.numbers[k + 1] = coefficient;
        self.newest = coefficient;
    }

    /// Takes v = σy + w from the series of y and w, from coefficient 1 on.
    pub(super) fn follow(&mut self, side: f64, speeds: &PowerSeries, surface: &PowerSeries) {
        for k in 1..TERMS {
            self.numbers[k + 1] = side * speeds[k] + surface[k];
        }
        self.newest = self.numbers[TERMS];
    }

    /// Sets all numbers.
    #[inline(always)]
    pub(super) fn set(&mut self, number: impl Fn(usize) -> f64) {
        for (k, own) in self.numbers.iter_mut().enumerate() {
            *own = number(k);
        }
        self.newest = self.numbers[TERMS];
    }

    /// v(t).
    pub(super) fn at(&self, t: f64) -> f64 {
        self.velocities().at(t)
    }

    /// Returns true if v is constant.
    pub(super) fn is_straight(&self) -> bool {
        self.numbers[2..].iter().all(|&c| c == 0.0)
    }

    /// The series of v.
    pub(super) fn velocities(&self) -> PowerSeries {
        PowerSeries::from_fn(|k| self.velocity(k))
    }
}

/// The series of one coordinate.
#[derive(Debug, Clone)]
pub(super) struct CoordinateSeries {
    pub(super) motion: DisplacementSeries,
    /// (M⁻¹f)_i.
    pub(super) force: PowerSeries,
    /// The rule for the later orders of its velocity in the step.
    pub(super) role: Role,
}

/// The role of a coordinate in a step, if it is simple.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Role {
    /// The coordinate sticks in this contact, which has a constant bound and a constant velocity.
    Held(usize),
    /// It slips in this contact, which has no memory, with a constant load on a constant belt.
    Slips(usize),
    /// Something else.
    Other,
}

impl CoordinateSeries {
    pub(super) fn new(force: PowerSeries) -> Self {
        Self {
            motion: DisplacementSeries::ZERO,
            force,
            role: Role::Other,
        }
    }
}

impl Series {
    pub(super) fn new(model: &Model<'_>, time: f64) -> Self {
        let constant = PowerSeries::of;
        let contacts = model.contacts.iter().map(|contact| {
            let load = constant(contact.load.value(time) * contact.compliance);
            let count = contact.memory.len();
            ContactSeries {
                mode: StepMode::Open,
                side: 1.0,
                piece: 0,
                rate: None,
                limit: 0.0,
                speeds: PowerSeries::ZERO,
                guided: None,
                surface: constant(contact.belt_velocity.value(time)),
                carried: PowerSeries::ZERO,
                bound: PowerSeries::ZERO,
                load,
                drive_load: load,
                load_varies: !contact.load.is_constant() || !contact.load_gradient.is_empty(),
                free: 0.0,
                friction: PowerSeries::ZERO,
                slope: 0.0,
                limits: PowerSeries::ZERO,
                memories: vec![PowerSeries::ZERO; count],
                rates: vec![0.0; count],
                relaxation: 0.0,
                tape: Tape::new(),
            }
        });
        let contacts: Vec<ContactSeries> = contacts.collect();
        let has_springs = model
            .contacts
            .iter()
            .any(|contact| !contact.reaction.is_empty());
        let is_simple = !has_springs && contacts.iter().all(|of| !of.load_varies);
        let coordinates = (0..model.len()).map(|i| {
            let force = model.acceleration_by(i, |j| model.forces[j].value(time));
            CoordinateSeries::new(constant(force))
        });
        let coordinates: Vec<CoordinateSeries> = coordinates.collect();
        let given = model.sprung.iter().map(|&j| coordinates[j].force);
        Self {
            given: given.collect(),
            spring_sizes: vec![0.0; model.sprung.len()],
            coordinates,
            contacts,
            rates: vec![0.0; model.len()],
            unheld: vec![0.0; model.len()],
            rounding: vec![0.0; model.len()],
            held: Vec::with_capacity(model.shared.len()),
            groups: is_simple.then(|| Groups::new(model)),
            expander: Expander::new(),
        }
    }

    /// The velocity of coordinate i over the step.
    pub(super) fn velocities(&self, i: usize) -> PowerSeries {
        self.coordinates[i].motion.velocities()
    }
}

impl ContactSeries {
    /// Keeps the memory constant.
    pub(super) fn hold_memory(&mut self, memory: &[f64]) {
        for (series, memory) in std::iter::zip(&mut self.memories, memory) {
            *series = PowerSeries::of(*memory);
        }
    }
}
