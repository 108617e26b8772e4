//! The constant data of a contact.

use std::borrow::Cow;
use std::ops::Range;
use std::sync::Arc;

use crate::drive::Drive;
use crate::friction::memory::Slip;
use crate::friction::memory::object::LawObject;
use crate::state::{Direction, Surface, relative_velocity};

/// Entries of a vector by their coordinates, without zeros.
pub(crate) type Entries = [(usize, f64)];

/// The constant data of a contact.
#[derive(Debug, Clone)]
pub(crate) struct ContactData<'s> {
    /// b.
    pub(crate) direction: Cow<'s, Entries>,
    pub(crate) law: &'s dyn LawObject,
    pub(crate) load: Arc<Drive>,
    /// n, including the stiffness of a normal spring.
    pub(crate) load_gradient: Vec<(usize, f64)>,
    /// The places of the laws of its load among the elements.
    pub(crate) load_laws: Range<usize>,
    pub(crate) belt_velocity: Arc<Drive>,
    /// k_t of an elastic contact.
    pub(crate) tangential_stiffness: Option<f64>,
    /// The direction d of its normal spring; empty without one.
    pub(crate) normal: &'s Entries,
    /// M⁻¹d.
    pub(crate) reaction: Vec<(usize, f64)>,
    /// Speeds at which pieces of the law meet.
    pub(crate) breakpoints: Vec<f64>,
    /// G_cc; 1 for an elastic contact, whose forces are not divided by a mass.
    pub(crate) compliance: f64,
    pub(crate) site: Site,
    /// The places of its memory variables among those of all contacts.
    pub(crate) memory: Range<usize>,
}

/// The coordinates on which a contact acts.
#[derive(Debug, Clone)]
pub(crate) enum Site {
    /// No other contact acts on its only coordinate: r = v_i − w.
    Own(usize),
    /// Elastic: its force is a state variable, and it does not constrain a coordinate.
    Elastic {
        /// M⁻¹b.
        response: Vec<(usize, f64)>,
    },
    /// The contact shares coordinates with other contacts, or has several.
    Shared {
        /// M⁻¹b/G_cc.
        response: Vec<(usize, f64)>,
        /// G_cd/√(G_cc G_dd) of the other contacts that it is coupled with.
        coupled: Vec<(usize, f64)>,
    },
}

impl<'s> ContactData<'s> {
    pub(crate) fn new(
        direction: Cow<'s, Entries>,
        law: &'s dyn LawObject,
        [load, belt_velocity]: [Arc<Drive>; 2],
        load_gradient: Vec<(usize, f64)>,
    ) -> Self {
        Self {
            direction,
            law,
            load,
            load_gradient,
            load_laws: 0..0,
            belt_velocity,
            tangential_stiffness: None,
            normal: &[],
            reaction: Vec::new(),
            breakpoints: law.breakpoints(),
            compliance: 1.0,
            site: Site::Own(0),
            memory: 0..0,
        }
    }

    /// b·x.
    pub(crate) fn along(&self, x: impl Fn(usize) -> f64) -> f64 {
        self.direction.iter().map(|&(j, b)| b * x(j)).sum()
    }

    /// Σ_j |b_j x_j|.
    pub(crate) fn size_along(&self, x: impl Fn(usize) -> f64) -> f64 {
        self.direction.iter().map(|&(j, b)| (b * x(j)).abs()).sum()
    }

    /// n·x.
    pub(crate) fn displacement_load(&self, x: impl Fn(usize) -> f64) -> f64 {
        self.load_gradient.iter().map(|&(j, n)| n * x(j)).sum()
    }

    /// The relative velocity in a state at a time, with the velocity and acceleration of the
    /// surface; 0 if it is within its rounding error.
    pub(crate) fn sliding_velocity(
        &self,
        v: impl Fn(usize) -> f64,
        [velocity, acceleration]: [f64; 2],
        time: f64,
    ) -> f64 {
        let surface = Surface {
            velocity,
            size: self.belt_velocity.size(),
            drift: acceleration * time,
        };
        relative_velocity(self.direction.iter().map(|&(j, b)| b * v(j)), surface)
    }

    /// Returns true if the contact slips in one direction only, with its first memory.
    pub(super) fn is_one_way(&self) -> bool {
        let limits = self.law.limits(&|_| 0.0);
        limits.is_some_and(|limits| limits.contains(&f64::INFINITY))
    }

    /// Returns false if a load that falls below 0 ends a motion: a load gradient alone presses
    /// where surfaces part.
    pub(crate) fn may_open(&self) -> bool {
        let by_gradient = !self.load_gradient.is_empty() && self.load_laws.is_empty();
        !(by_gradient && self.normal.is_empty())
    }

    /// Returns true if the load depends on the state.
    pub(crate) fn load_follows(&self) -> bool {
        !self.load_gradient.is_empty() || !self.load_laws.is_empty()
    }

    /// N at a time without its laws: see [`Model::load_at`](super::model::Model::load_at).
    pub(crate) fn load_at(&self, time: f64, displacement: impl Fn(usize) -> f64) -> f64 {
        load_at(self.load.value(time), &self.load_gradient, displacement)
    }

    /// The kinetic coefficient at speed 0 for slip in a direction, and the static coefficients
    /// backward and forward if it would stick there, for the given memory; `None` if the contact
    /// never sticks.
    pub(crate) fn coefficients_at_rest(
        &self,
        direction: Direction,
        memory: &[f64],
    ) -> (f64, Option<[f64; 2]>) {
        let slip = Slip {
            speed: 0.0,
            direction: direction.sign(),
            piece: 0,
        };
        let kinetic = direction.sign() * self.law.coefficient(slip, &|j| memory[j]);
        let mut caught = memory.to_vec();
        self.law.caught(&mut caught);
        (kinetic, self.law.limits(&|j| caught[j]))
    }

    /// The piece of its law just above a sliding speed.
    pub(crate) fn piece_above(&self, speed: f64) -> usize {
        self.breakpoints.partition_point(|&b| b <= speed)
    }

    /// Number of memory variables: those of its law, or the force of an elastic contact.
    pub(super) fn remembered(&self) -> usize {
        match self.tangential_stiffness {
            Some(_) => 1,
            None => self.law.memory(),
        }
    }

    pub(crate) fn is_elastic(&self) -> bool {
        self.tangential_stiffness.is_some()
    }

    /// μ of an elastic contact.
    pub(crate) fn constant_coefficient(&self) -> f64 {
        self.law.constant().unwrap_or(0.0)
    }

    /// μN of an elastic contact at a time, 0 if it is open.
    pub(crate) fn limit_at(&self, time: f64, displacement: impl Fn(usize) -> f64) -> f64 {
        (self.constant_coefficient() * self.load_at(time, displacement)).max(0.0)
    }

    /// The limit just before a time at which the load jumps.
    pub(super) fn limit_before(&self, time: f64, displacement: impl Fn(usize) -> f64) -> f64 {
        let load = load_at(
            self.load.just_before(time),
            &self.load_gradient,
            displacement,
        );
        (self.constant_coefficient() * load).max(0.0)
    }

    /// Sum of the sizes of all terms of the load without its laws.
    pub(crate) fn load_size(&self, displacement: impl Fn(usize) -> f64) -> f64 {
        let by_displacements = self.load_gradient.iter();
        let sizes = by_displacements.map(|&(j, n)| (n * displacement(j)).abs());
        self.load.size() + sizes.sum::<f64>()
    }
}

/// The data that determine the relative velocity b·v − w of a contact.
#[derive(Debug, Clone)]
pub(super) struct Kinematics {
    pub(super) direction: Box<[(usize, f64)]>,
    pub(super) belt_velocity: Arc<Drive>,
    pub(super) is_elastic: bool,
}

impl Kinematics {
    pub(super) fn of(contact: &ContactData<'_>) -> Self {
        Self {
            direction: contact.direction.as_ref().into(),
            belt_velocity: Arc::clone(&contact.belt_velocity),
            is_elastic: contact.is_elastic(),
        }
    }
}

impl ContactData<'_> {
    /// (M⁻¹b)_j/G_cc of a shared contact.
    pub(crate) fn response(&self, coordinate: usize) -> f64 {
        entry(self.responses(), coordinate)
    }

    /// M⁻¹b/G_cc; it is b if no other contact acts on the coordinate.
    pub(crate) fn responses(&self) -> &Entries {
        match &self.site {
            Site::Own(_) => &self.direction,
            Site::Elastic { response } | Site::Shared { response, .. } => response,
        }
    }

    /// G_cd/√(G_cc G_dd) of the other contacts that it is coupled with.
    pub(crate) fn coupled(&self) -> &Entries {
        match &self.site {
            Site::Own(_) | Site::Elastic { .. } => &[],
            Site::Shared { coupled, .. } => coupled,
        }
    }
}

/// N0 + n·q.
pub(super) fn load_at(given: f64, gradient: &Entries, displacement: impl Fn(usize) -> f64) -> f64 {
    let by_displacements = gradient.iter().map(|&(j, n)| n * displacement(j));
    given + by_displacements.sum::<f64>()
}

/// The entry of a coordinate; 0 if there is none.
pub(crate) fn entry(entries: &Entries, coordinate: usize) -> f64 {
    let place = entries.binary_search_by_key(&coordinate, |&(j, _)| j);
    place.map_or(0.0, |place| entries[place].1)
}
