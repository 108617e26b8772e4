//! The data of one step: the power series of all coordinates and contacts.

use super::contact_series::ContactSeries;
use super::coordinate_series::CoordinateSeries;
use super::element_series::ElementSeries;
use super::model::Model;
use super::simd_groups::Groups;
use crate::friction::slip_series::Expander;
use crate::series::{PowerSeries, TERMS};

/// The power series of a step.
#[derive(Debug, Clone)]
pub(super) struct Series {
    pub(super) coordinates: Vec<CoordinateSeries>,
    pub(super) contacts: Vec<ContactSeries>,
    pub(super) elements: Vec<ElementSeries>,
    /// First-order states, and the drives in their rates.
    pub(super) states: Vec<PowerSeries>,
    pub(super) inputs: Vec<PowerSeries>,
    /// Room for one order of the laws in these rates.
    pub(super) laws: Vec<f64>,
    /// The given forces on coordinates with springs of contacts, force elements or forces of
    /// first-order states, divided by the mass.
    pub(super) given: Vec<PowerSeries>,
    /// The sizes of the forces of these springs, elements and states at the start.
    pub(super) spring_sizes: Vec<f64>,
    /// Room for one order of the shared coordinates and contacts.
    pub(super) rates: Vec<f64>,
    pub(super) unheld: Vec<f64>,
    pub(super) held: Vec<f64>,
    /// Bound of rounding of that order of the shared coordinates, where it counts.
    pub(super) rounding: Vec<f64>,
    /// Present if the loads of all rigid contacts are constant, so that none of them opens, and all
    /// factors of elements, and there are no first-order states.
    pub(super) groups: Option<Groups>,
    /// The expander of a coordinate that slips alone.
    pub(super) expander: Expander,
}

impl Series {
    pub(super) fn new(model: &Model<'_>, time: f64) -> Self {
        let contacts = model.contacts.iter();
        let contacts: Vec<_> = contacts.map(|c| ContactSeries::new(c, time)).collect();
        let loads_vary = contacts.iter().any(|of| of.load_varies);
        let mut rigid =
            std::iter::zip(&model.contacts, &contacts).filter(|(contact, _)| !contact.is_elastic());
        let is_simple = model.elements.iter().all(|of| of.factor.is_constant())
            && model.first_order.is_empty()
            && rigid.all(|(_, of)| !of.load_varies);
        let coordinates = (0..model.len()).map(|i| {
            let force = model.acceleration_by(i, |j| model.forces[j].value(time));
            CoordinateSeries::new(PowerSeries::of(force))
        });
        let coordinates: Vec<CoordinateSeries> = coordinates.collect();
        let elements = model.elements.iter();
        let given = model.sprung.iter().map(|&j| coordinates[j].force);
        let inputs = model.first_order.iter();
        let inputs = inputs.map(|state| PowerSeries::of(state.scale * state.drive.value(time)));
        let states = model.first_order.len();
        Self {
            given: given.collect(),
            spring_sizes: vec![0.0; model.sprung.len()],
            elements: elements
                .map(|element| ElementSeries::new(element, time))
                .collect(),
            coordinates,
            contacts,
            states: vec![PowerSeries::ZERO; states],
            inputs: inputs.collect(),
            laws: vec![0.0; states],
            rates: vec![0.0; model.len()],
            unheld: vec![0.0; model.len()],
            rounding: vec![0.0; model.len()],
            held: Vec::with_capacity(model.shared.len()),
            groups: is_simple.then(|| Groups::new(model, loads_vary)),
            expander: Expander::new(),
        }
    }

    /// Returns true if an element acts: a force element, or a stop that is closed.
    pub(super) fn is_pushed(&self) -> bool {
        self.elements.iter().any(|of| of.acts)
    }

    /// Contacts are no longer on slow manifolds.
    pub(super) fn forget_slow(&mut self) {
        for contact in &mut self.contacts {
            (contact.relaxation, contact.settling) = (0.0, 0.0);
        }
    }

    /// Drops all orders from the first one on at which a coefficient overflows, or bounds of a
    /// series do; returns their number.
    #[cold]
    pub(super) fn truncate(&mut self) -> usize {
        /// Size of coefficients above which bounds of a series overflow.
        const LARGEST: f64 = 1e240;
        let is_ordinary = |coefficient: f64| coefficient.abs() < LARGEST;
        let (motions, series) = self.integrated();
        let kept = (0..TERMS).position(|k| {
            let mut velocities = motions.iter().map(|of| of.motion.velocity(k));
            !(velocities.all(is_ordinary) && series.iter().all(|c| is_ordinary(c[k])))
        });
        let kept = kept.unwrap_or(TERMS);
        self.keep(kept);
        TERMS - kept
    }

    /// Keeps the first orders of all series.
    #[cold]
    pub(super) fn keep(&mut self, kept: usize) {
        let (motions, mut series) = self.integrated();
        for k in kept..TERMS {
            for of in &mut *motions {
                of.motion.set_velocity(k, 0.0);
            }
            for c in &mut series {
                c[k] = 0.0;
            }
        }
    }

    /// The series that follow from the equations of motion. A limit that is infinite, as that of a
    /// freewheel, does not.
    fn integrated(&mut self) -> (&mut [CoordinateSeries], Vec<&mut PowerSeries>) {
        let contacts = self.contacts.iter_mut().flat_map(|of| {
            let own = [&mut of.speeds, &mut of.friction, &mut of.carried];
            let bounds = of.bounds.iter_mut();
            own.into_iter()
                .chain(bounds.filter(|bound| !bound[0].is_infinite()))
                .chain(&mut of.memories)
        });
        let elements = self.elements.iter_mut().flat_map(|of| {
            let motion = of.positions.iter_mut().chain(&mut of.velocities);
            motion.chain(&mut of.forces)
        });
        let numbers = contacts.chain(elements).chain(&mut self.states);
        (&mut self.coordinates, numbers.collect())
    }

    /// The velocity of coordinate i over the step.
    pub(super) fn velocities(&self, i: usize) -> PowerSeries {
        self.coordinates[i].motion.velocities()
    }
}
