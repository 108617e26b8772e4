//! The structure in the form used by the engine: solved for the accelerations, as sparse matrices.

use std::borrow::Cow;
use std::ops::Range;
use std::sync::Arc;

use nalgebra::DMatrix;

use super::contact_data::{ContactData, Entries, Kinematics, Site, entry};
use super::element_data::ElementData;
use super::first_order::{FirstOrderData, fastest_loop, find_acting};
use super::sparse::{Sparse, SparsePair};
use crate::belt::MassOnBelt;
use crate::clock::Clock;
use crate::drive::Drive;
use crate::friction::FrictionLaw;
use crate::motion::Mode;
use crate::numerics::sort::sort_by;
use crate::state::structure::State;

/// The data that are constant in a motion.
///
/// ```text
/// v' = M⁻¹ f(t) − M⁻¹C v − M⁻¹K q − Σ_e D_e M⁻¹a_e F_e − Σ_c x_c ℓ_c + M⁻¹B z
/// z' = A_q q + A_v v + A_z z + u(t) + F
/// x_c = M⁻¹b_c/G_cc,  ℓ_c = G_cc λ_c
/// ```
///
/// G_cc = b_cᵀM⁻¹b_c: all forces are expressed as accelerations; forces at a contact are
/// accelerations of its relative velocity.
#[derive(Debug, Clone)]
pub(crate) struct Model<'s> {
    /// M⁻¹K.
    pub(crate) stiffness: Sparse,
    /// M⁻¹C.
    pub(crate) damping: Sparse,
    /// M⁻¹K beside M⁻¹C.
    linear: SparsePair,
    /// M⁻¹.
    pub(crate) inverse_mass: Sparse,
    /// √(M⁻¹)_ii: the velocity of a coordinate with an energy of 1/2.
    pub(super) mobility: Vec<f64>,
    pub(crate) forces: Cow<'s, [Drive]>,
    pub(crate) contacts: Vec<ContactData<'s>>,
    /// Force elements, then the laws in the rates of first-order states, then the parts of the
    /// loads of contacts, then stops.
    pub(crate) elements: Vec<ElementData<'s>>,
    pub(crate) first_order: Vec<FirstOrderData>,
    /// Number of memory variables of all contacts.
    of_contacts: usize,
    /// The contacts whose laws creep: see [`ContactLaw::creeps`](crate::ContactLaw::creeps).
    pub(crate) creeping: Vec<usize>,
    /// Kinematics of all contacts, shared with the steps of motions.
    pub(super) kinematics: Arc<[Kinematics]>,
    /// The number of the contact that a coordinate has to itself.
    pub(crate) owner: Vec<Option<usize>>,
    /// Contacts that share coordinates or are coupled by the mass matrix, sorted so that coupled
    /// contacts are near each other in the list.
    pub(crate) shared: Vec<usize>,
    /// The coordinates of their directions, and those that they accelerate.
    pub(crate) shared_coordinates: Vec<usize>,
    /// Contacts with a spring: elastic ones, and those with a normal spring.
    pub(super) springs: Vec<usize>,
    /// The coordinates that these springs, force elements and first-order states accelerate,
    /// ascending.
    pub(super) sprung: Vec<usize>,
    /// The targets of the drives that vary.
    pub(super) varying: Vec<Target>,
    /// True if the force on a coordinate varies, except by stops, or the surface under its own
    /// contact.
    pub(super) is_driven: Vec<bool>,
    /// Largest |i − j| of two coordinates that act on each other.
    pub(super) bandwidth: usize,
    /// 1/√(max_i Σ_j |M⁻¹K|_ij): no free vibration without friction is faster than one radian in
    /// this time. Without springs it is computed from the dampers; without dampers it is infinite.
    /// No loop of first-order states is faster either. Springs of contacts and force elements are
    /// not included: see [`time_unit_with`](Self::time_unit_with).
    pub(crate) time_unit: f64,
    /// The rate of the fastest loop of first-order states; 0 if there are none.
    loop_rate: f64,
    /// The time in which the fastest drive advances by one radian; infinite without harmonics.
    pub(super) drive_unit: f64,
    /// The drives with functions of users.
    pub(super) functions: Vec<Target>,
}

/// A mass matrix, symmetric and positive definite.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Mass<'m> {
    Diagonal(&'m [f64]),
    Full(&'m DMatrix<f64>),
}

/// The target of a drive.
#[derive(Debug, Clone, Copy)]
pub(super) enum Target {
    /// The force on a coordinate.
    Force(usize),
    /// The velocity of the surface under a contact.
    Surface(usize),
    /// The load of a contact.
    Load(usize),
    /// The factor of a force element.
    Factor(usize),
    /// The rate of a first-order state.
    Rate(usize),
}

impl<'s> Model<'s> {
    /// Returns true if all forces are linear while contacts are in these modes.
    pub(crate) fn is_linear(&self, modes: &[Mode]) -> bool {
        let contacts = std::iter::zip(&self.contacts, modes);
        let mut contacts = contacts.map(|(contact, mode)| match mode {
            Mode::Open => true,
            _ if contact.is_elastic() => true,
            Mode::Stick => contact.memory.is_empty(),
            Mode::Slip(_) => contact.memory.is_empty() && contact.law.constant().is_some(),
        });
        self.elements.is_empty() && contacts.all(|is_linear| is_linear)
    }

    /// A mass on a belt as a structure.
    pub(crate) fn of_belt<L: FrictionLaw>(belt: &'s MassOnBelt<L>) -> Self {
        let one = |entry: f64| DMatrix::from_element(1, 1, entry);
        let contact = ContactData::new(
            Cow::Borrowed(&[(0, 1.0)]),
            belt.law(),
            [belt.load(), belt.belt_velocity()].map(|value| Arc::new(Drive::constant(value))),
            Vec::new(),
        );
        Self::new(
            Mass::Diagonal(&[1.0]),
            [&one(1.0), &one(2.0 * belt.damping())],
            Cow::Owned(vec![Drive::constant(0.0)]),
            vec![contact],
            (Vec::new(), Vec::new()),
            std::iter::empty(),
        )
    }

    /// The model with these M, K and C, force elements and first-order states.
    pub(crate) fn new(
        mass: Mass<'_>,
        [stiffness, damping]: [&DMatrix<f64>; 2],
        forces: Cow<'s, [Drive]>,
        mut contacts: Vec<ContactData<'s>>,
        (mut elements, first_order): (Vec<ElementData<'s>>, Vec<FirstOrderData>),
        load_laws: impl Iterator<Item = Vec<ElementData<'s>>>,
    ) -> Self {
        let stops = elements.partition_point(|element| element.stop.is_none());
        let stops = elements.split_off(stops);
        for (c, (contact, laws)) in std::iter::zip(&mut contacts, load_laws).enumerate() {
            let first = elements.len();
            elements.extend(laws.into_iter().map(|law| ElementData {
                pressed: Some(c),
                ..law
            }));
            if first < elements.len() {
                contact.load_laws = first..elements.len();
            }
        }
        elements.extend(stops);
        let n = stiffness.nrows();
        let inverse_mass = match mass {
            Mass::Diagonal(masses) => Sparse::diagonal(masses.iter().map(|m| m.recip())),
            Mass::Full(mass) => Sparse::new(&inverse(mass)),
        };
        let stiffness = inverse_mass.times(stiffness);
        let damping = inverse_mass.times(damping);
        let mut model = Self {
            mobility: inverse_mass.rows().map(|(own, _)| own.sqrt()).collect(),
            inverse_mass,
            linear: SparsePair::new([&stiffness, &damping]),
            stiffness,
            damping,
            forces,
            contacts,
            elements,
            first_order,
            of_contacts: 0,
            creeping: Vec::new(),
            kinematics: Arc::default(),
            owner: vec![None; n],
            shared: Vec::new(),
            shared_coordinates: Vec::new(),
            springs: Vec::new(),
            sprung: Vec::new(),
            varying: Vec::new(),
            is_driven: vec![false; n],
            bandwidth: 0,
            time_unit: f64::INFINITY,
            loop_rate: 0.0,
            drive_unit: f64::INFINITY,
            functions: Vec::new(),
        };
        model.place_contacts();
        model.place_states();
        model.kinematics = model.contacts.iter().map(Kinematics::of).collect();
        let creeps =
            |c: &usize| !model.contacts[*c].is_elastic() && model.contacts[*c].law.creeps();
        model.creeping = (0..model.contacts.len()).filter(creeps).collect();
        model.place_springs();
        model.place_drives();
        model.bandwidth = model.largest_distance();
        let elastic = largest(row_sums(&model.stiffness));
        let rate = if elastic > 0.0 {
            elastic.sqrt()
        } else {
            largest(row_sums(&model.damping))
        };
        model.time_unit = rate.max(model.loop_rate).recip();
        model
    }

    /// Finds which contacts have a coordinate to themselves, and how the others are coupled.
    fn place_contacts(&mut self) {
        let n = self.len();
        let mut uses = vec![0; n];
        for contact in &mut self.contacts {
            let first = self.of_contacts;
            self.of_contacts += contact.remembered();
            contact.memory = first..self.of_contacts;
            for &(j, _) in contact.direction.iter() {
                uses[j] += usize::from(!contact.is_elastic());
            }
        }
        let mut near: Vec<Vec<usize>> = vec![Vec::new(); n];
        for (number, contact) in self.contacts.iter_mut().enumerate() {
            contact.reaction = responses_to(&self.inverse_mass, contact.normal);
            if contact.is_elastic() {
                let response = responses_to(&self.inverse_mass, &contact.direction);
                contact.site = Site::Elastic { response };
                continue;
            }
            if let [(i, 1.0)] = contact.direction[..]
                && uses[i] == 1
                && self.inverse_mass.row(i).1.is_empty()
            {
                contact.compliance = self.inverse_mass.row(i).0;
                contact.site = Site::Own(i);
                self.owner[i] = Some(number);
                continue;
            }
            let mut response = responses_to(&self.inverse_mass, &contact.direction);
            let at = |j: usize| entry(&response, j);
            contact.compliance = contact.along(at);
            response.retain(|&(_, x)| x != 0.0);
            for (_, x) in &mut response {
                *x /= contact.compliance;
            }
            for &(j, _) in &response {
                near[j].push(number);
            }
            contact.site = Site::Shared {
                response,
                coupled: Vec::new(),
            };
            self.shared.push(number);
        }
        // A full mass matrix may leave a coordinate of a direction without acceleration.
        let is_along = |j: usize| uses[j] > 0 && self.owner[j].is_none();
        let of_shared = (0..n).filter(|&j| is_along(j) || !near[j].is_empty());
        self.shared_coordinates = of_shared.collect();
        sort_by(&mut self.shared, |&c| {
            let coordinates = self.contacts[c].direction.iter().map(|&(j, _)| j);
            coordinates.min().map_or(-1.0, |least| least as f64)
        });
        for &c in &self.shared {
            let coupled = self.coupled(c, &near);
            if let Site::Shared { coupled: to, .. } = &mut self.contacts[c].site {
                *to = coupled;
            }
        }
    }

    /// Finds on what first-order states act, and how fast they are.
    fn place_states(&mut self) {
        let n = self.len();
        for state in &mut self.first_order {
            state.responses = responses_to(&self.inverse_mass, &state.forces);
        }
        let mut read = vec![false; self.first_order.len()];
        let directions = self
            .elements
            .iter()
            .flat_map(|element| &*element.directions);
        for &(j, _) in directions.flatten() {
            if let Some(state) = j.checked_sub(n) {
                read[state] = true;
            }
        }
        find_acting(&mut self.first_order, &read);
        self.loop_rate = fastest_loop(&self.first_order);
    }

    /// Finds which coordinates the springs of contacts, force elements and first-order states act
    /// on.
    fn place_springs(&mut self) {
        let contacts = self.contacts.iter().enumerate();
        let with_spring =
            contacts.filter(|(_, contact)| contact.is_elastic() || !contact.reaction.is_empty());
        self.springs = with_spring.map(|(c, _)| c).collect();
        let of = |&c: &usize| {
            let contact = &self.contacts[c];
            let pulled = if contact.is_elastic() {
                contact.responses()
            } else {
                &[]
            };
            pulled.iter().chain(&contact.reaction).map(|&(j, _)| j)
        };
        self.sprung = self.springs.iter().flat_map(of).collect();
        for &j in &self.sprung {
            self.is_driven[j] = true;
        }
        for element in &mut self.elements {
            if let Some((state, scale)) = element.rate_of {
                element.responses = vec![vec![(self.owner.len() + state, -scale)]];
                continue;
            }
            let directions = element.directions.iter();
            let responses = directions.map(|a| match element.pressed {
                None => responses_to(&self.inverse_mass, a),
                Some(_) => Vec::new(),
            });
            element.responses = responses.collect();
            for &(j, _) in element.responses.iter().flatten() {
                self.sprung.push(j);
                // A stop acts only while it is closed.
                self.is_driven[j] |= element.stop.is_none();
            }
        }
        for &(j, _) in self.first_order.iter().flat_map(|state| &state.responses) {
            self.sprung.push(j);
            self.is_driven[j] = true;
        }
        self.sprung.sort_unstable();
        self.sprung.dedup();
    }

    /// The time unit with the springs of contacts that act (tangential ones of those that stick,
    /// normal ones of those that are closed), and with the tangent stiffnesses ∂F_i/∂x_j of force
    /// elements.
    pub(super) fn time_unit_with<'t>(
        &self,
        mode: impl Fn(usize) -> Mode,
        tangents: impl Fn(usize) -> &'t [Vec<f64>],
    ) -> f64 {
        if self.sprung.is_empty() && self.elements.is_empty() {
            return self.time_unit;
        }
        let (sums, fastest) = self.stiffness_sums(mode, tangents);
        let elastic = largest(sums.into_iter());
        if elastic > 0.0 || fastest > self.loop_rate {
            elastic.sqrt().max(fastest).recip()
        } else {
            self.time_unit
        }
    }

    /// The time unit where some coordinates have no motion of their own, because contacts damp it
    /// at these rates D; 0 for the others. Under a stiffness k they relax at the rate k/D.
    pub(super) fn slow_time_unit<'t>(
        &self,
        damped: impl Fn(usize) -> f64,
        mode: impl Fn(usize) -> Mode,
        tangents: impl Fn(usize) -> &'t [Vec<f64>],
    ) -> f64 {
        let (sums, fastest) = self.stiffness_sums(mode, tangents);
        let rates = sums.into_iter().enumerate();
        let rates = rates.map(|(i, stiffness)| match damped(i) {
            0.0 => stiffness.sqrt(),
            damped => stiffness / damped,
        });
        largest(rates).max(fastest).recip()
    }

    /// Σ_j |M⁻¹K|_ij of each coordinate, with the springs and force elements of
    /// [`time_unit_with`](Self::time_unit_with); and the fastest rate of first-order states.
    fn stiffness_sums<'t>(
        &self,
        mode: impl Fn(usize) -> Mode,
        tangents: impl Fn(usize) -> &'t [Vec<f64>],
    ) -> (Vec<f64>, f64) {
        let mut sums: Vec<f64> = row_sums(&self.stiffness).collect();
        let mut fastest = self.loop_rate;
        for &c in &self.springs {
            let contact = &self.contacts[c];
            let mut add = |response: &Entries, stiffness: f64| {
                for &(j, x) in response {
                    sums[j] += x.abs() * stiffness;
                }
            };
            if let (Some(stiffness), Mode::Stick) = (contact.tangential_stiffness, mode(c)) {
                add(contact.responses(), stiffness * contact.size_along(|_| 1.0));
            }
            if mode(c) != Mode::Open {
                let gradient = contact.load_gradient.iter().map(|(_, n)| n.abs());
                add(&contact.reaction, gradient.sum());
            }
        }
        for (e, element) in self.elements.iter().enumerate() {
            let factor = element.factor.size();
            // A part of the load of a closed contact acts with the reaction of its normal spring.
            let reaction = match element.pressed {
                Some(c) if mode(c) != Mode::Open => Some(&self.contacts[c].reaction),
                _ => None,
            };
            for (direction, slopes) in std::iter::zip(&*element.directions, tangents(e)) {
                let size = factor * direction.iter().map(|(_, a)| a.abs()).sum::<f64>();
                let responses = element.responses.iter().chain(reaction);
                let slopes = slopes.iter().chain(slopes.first());
                for (response, slope) in std::iter::zip(responses, slopes) {
                    // A slope that is not finite is an error of the law, found elsewhere.
                    let stiffness = if slope.is_finite() {
                        size * slope.abs()
                    } else {
                        0.0
                    };
                    for &(j, x) in response {
                        match sums.get_mut(j) {
                            Some(sum) => *sum += x.abs() * stiffness,
                            // The rate of a state of its own value.
                            None if direction.iter().any(|&(k, _)| k == j) => {
                                fastest = fastest.max(x.abs() * stiffness);
                            }
                            None => {}
                        }
                    }
                }
            }
        }
        (sums, fastest)
    }

    /// The contacts that a shared one is coupled with: G_cd/√(G_cc G_dd).
    fn coupled(&self, c: usize, near: &[Vec<usize>]) -> Vec<(usize, f64)> {
        let contact = &self.contacts[c];
        let touched = contact.direction.iter().flat_map(|&(j, _)| &near[j]);
        let mut others: Vec<usize> = touched.copied().filter(|&d| d != c).collect();
        others.sort_unstable();
        others.dedup();
        let coupling = |d: usize| {
            let other = &self.contacts[d];
            let entries = contact
                .direction
                .iter()
                .map(|&(j, b)| b * other.response(j));
            entries.sum::<f64>() * (other.compliance / contact.compliance).sqrt()
        };
        let couplings = others.into_iter().map(|d| (d, coupling(d)));
        couplings.filter(|(_, g)| *g != 0.0).collect()
    }

    fn place_drives(&mut self) {
        let of_forces = (0..self.len()).map(Target::Force);
        let contacts = 0..self.contacts.len();
        let of_contacts = contacts.flat_map(|c| [Target::Surface(c), Target::Load(c)]);
        let of_elements = (0..self.elements.len()).map(Target::Factor);
        let of_states = (0..self.first_order.len()).map(Target::Rate);
        let targets = of_forces.chain(of_contacts).chain(of_elements);
        let targets = targets.chain(of_states);
        self.varying = targets
            .filter(|&target| !self.drive(target).is_constant())
            .collect();
        let drives = self.varying.iter().map(|&target| self.drive(target));
        let fastest = drives.fold(0.0, |fastest: f64, drive| fastest.max(drive.fastest()));
        self.drive_unit = fastest.recip();
        let varying = self.varying.iter().copied();
        self.functions = varying
            .filter(|&target| self.drive(target).has_functions())
            .collect();
        for target in &self.varying {
            match *target {
                Target::Force(j) => {
                    self.is_driven[j] = true;
                    for &(i, _) in self.inverse_mass.row(j).1 {
                        self.is_driven[i] = true;
                    }
                }
                Target::Surface(c) => {
                    if let Site::Own(i) = self.contacts[c].site {
                        self.is_driven[i] = true;
                    }
                }
                Target::Load(_) | Target::Factor(_) | Target::Rate(_) => {}
            }
        }
    }

    fn largest_distance(&self) -> usize {
        let loads = self.contacts.iter().flat_map(|contact| {
            let gradient = contact.load_gradient.iter();
            let Site::Own(i) = contact.site else {
                return None.into_iter().flatten();
            };
            Some(gradient.map(move |&(j, _)| i.abs_diff(j)))
                .into_iter()
                .flatten()
        });
        let matrices = [self.stiffness.bandwidth(), self.damping.bandwidth()];
        loads.chain(matrices).max().unwrap_or(0)
    }

    /// Number of coordinates.
    pub(crate) fn len(&self) -> usize {
        self.owner.len()
    }

    /// Number of memory variables: those of all contacts, then first-order states.
    pub(crate) fn remembered(&self) -> usize {
        self.of_contacts + self.first_order.len()
    }

    /// The place of a first-order state among the memory variables.
    pub(crate) fn state_place(&self, state: usize) -> usize {
        self.of_contacts + state
    }

    /// The number of a state vector of displacements, velocities and memory variables that a
    /// coordinate's number, or one beyond them, stands for as a position.
    pub(crate) fn position_row(&self, j: usize) -> usize {
        match j.checked_sub(self.len()) {
            None => j,
            Some(state) => 2 * self.len() + self.state_place(state),
        }
    }

    /// The number whose rate a force changes there: a velocity, or a first-order state.
    pub(crate) fn rate_row(&self, j: usize) -> usize {
        match j.checked_sub(self.len()) {
            None => self.len() + j,
            Some(state) => 2 * self.len() + self.state_place(state),
        }
    }

    /// The positions that directions of force elements take: displacements, then first-order
    /// states.
    pub(crate) fn position(&self, state: &State, j: usize) -> f64 {
        match j.checked_sub(self.len()) {
            None => state.displacements[j],
            Some(z) => {
                let place = self.state_place(z);
                state.memory.get(place).copied().unwrap_or(0.0)
            }
        }
    }

    /// The force elements, without the laws of first-order states and of loads, and without stops.
    pub(crate) fn force_elements(&self) -> &[ElementData<'s>] {
        let acts = |element: &ElementData<'_>| {
            element.rate_of.is_none() && element.pressed.is_none() && element.stop.is_none()
        };
        &self.elements[..self.elements.partition_point(acts)]
    }

    /// Number of the parts of loads.
    pub(super) fn pressing(&self) -> usize {
        let of_contacts = self.contacts.iter();
        of_contacts.map(|contact| contact.load_laws.len()).sum()
    }

    /// The parts of the load of a contact that have laws of their own.
    pub(crate) fn load_laws(&self, contact: usize) -> &[ElementData<'s>] {
        &self.elements[self.contacts[contact].load_laws.clone()]
    }

    /// N of a contact at a time, negative if it is open.
    pub(crate) fn load_at(
        &self,
        contact: usize,
        time: f64,
        q: impl Fn(usize) -> f64,
        v: impl Fn(usize) -> f64,
    ) -> f64 {
        let linear = self.contacts[contact].load_at(time, &q);
        let laws = self.load_laws(contact).iter();
        laws.fold(linear, |sum, law| sum + law.pressure(time, &q, &v))
    }

    /// The number of the first stop among the elements.
    pub(crate) fn first_stop(&self) -> usize {
        self.elements
            .partition_point(|element| element.stop.is_none())
    }

    /// The stops.
    pub(crate) fn stops(&self) -> &[ElementData<'s>] {
        &self.elements[self.first_stop()..]
    }

    /// The elements that act on coordinates: force elements, then stops.
    pub(crate) fn forces_and_stops(&self) -> impl Iterator<Item = &ElementData<'s>> {
        self.force_elements().iter().chain(self.stops())
    }

    /// The memory variables of a contact among those of all.
    pub(crate) fn memory(&self, contact: usize) -> Range<usize> {
        self.contacts[contact].memory.clone()
    }

    /// The functions of time that act on the element.
    pub(crate) fn drives(&self) -> impl Iterator<Item = &Drive> {
        let contacts = self.contacts.iter();
        let of_contacts = contacts.flat_map(|contact| [&*contact.load, &*contact.belt_velocity]);
        let of_elements = self.elements.iter().map(|element| &*element.factor);
        let of_states = self.first_order.iter().map(|state| &*state.drive);
        let others = of_contacts.chain(of_elements).chain(of_states);
        self.forces.iter().chain(others)
    }

    /// The drive that acts there.
    pub(super) fn drive(&self, target: Target) -> &Drive {
        match target {
            Target::Force(i) => &self.forces[i],
            Target::Surface(c) => &self.contacts[c].belt_velocity,
            Target::Load(c) => &self.contacts[c].load,
            Target::Factor(e) => &self.elements[e].factor,
            Target::Rate(state) => &self.first_order[state].drive,
        }
    }

    /// The longest step from a time on in which all functions of users are looked at often enough.
    pub(super) fn foresight(&self, clock: Clock) -> f64 {
        let targets = self.functions.iter();
        let steps = targets.map(|&target| self.drive(target).foresight(clock));
        steps.fold(f64::INFINITY, f64::min)
    }

    /// −M⁻¹(K x + C y)_i; `own` are x_i and y_i.
    #[inline(always)]
    pub(crate) fn restoring(
        &self,
        i: usize,
        own: [f64; 2],
        x: impl Fn(usize) -> f64,
        y: impl Fn(usize) -> f64,
    ) -> f64 {
        self.linear.minus_products(i, own, x, y)
    }

    /// (M⁻¹f)_i with what `force` gives for each coordinate.
    pub(super) fn acceleration_by(&self, i: usize, force: impl Fn(usize) -> f64) -> f64 {
        let (diagonal, beside) = self.inverse_mass.row(i);
        let own = diagonal * force(i);
        beside.iter().fold(own, |sum, &(j, a)| sum + a * force(j))
    }

    /// The coordinate that a contact has to itself.
    pub(crate) fn owner_of(&self, contact: usize) -> Option<usize> {
        match self.contacts[contact].site {
            Site::Own(i) => Some(i),
            Site::Elastic { .. } | Site::Shared { .. } => None,
        }
    }

    /// The contacts without a coordinate of their own: those that share coordinates, then those
    /// with a spring.
    pub(super) fn unowned(&self) -> impl Iterator<Item = usize> {
        self.shared.iter().chain(&self.springs).copied()
    }

    /// Returns true if a rigid contact shares coordinates with others, or has several.
    pub(crate) fn is_shared(&self, contact: usize) -> bool {
        matches!(self.contacts[contact].site, Site::Shared { .. })
    }

    /// True for each coordinate that a contact accelerates, directly or through other contacts.
    pub(crate) fn connected(&self, contact: usize) -> Vec<bool> {
        let mut reached = vec![false; self.len()];
        let mut left = self.shared.clone();
        let mut next = Some(contact);
        while let Some(contact) = next {
            for &(j, _) in self.contacts[contact].responses() {
                reached[j] = true;
            }
            left.retain(|&c| c != contact);
            let touches = |&c: &usize| {
                let mut responses = self.contacts[c].responses().iter();
                responses.any(|&(j, _)| reached[j])
            };
            next = left.iter().copied().find(touches);
        }
        reached
    }
}

/// M⁻¹, by the parts that M couples: the inverse of a number is its reciprocal, to the bit.
fn inverse(mass: &DMatrix<f64>) -> DMatrix<f64> {
    let n = mass.nrows();
    let mut inverse = DMatrix::zeros(n, n);
    let mut is_done = vec![false; n];
    for start in 0..n {
        if is_done[start] {
            continue;
        }
        let mut part = vec![start];
        is_done[start] = true;
        let mut next = 0;
        while let Some(&i) = part.get(next) {
            next += 1;
            for j in 0..n {
                if mass[(i, j)] != 0.0 && !is_done[j] {
                    is_done[j] = true;
                    part.push(j);
                }
            }
        }
        if let [i] = part[..] {
            inverse[(i, i)] = mass[(i, i)].recip();
            continue;
        }
        let size = part.len();
        let block = DMatrix::from_fn(size, size, |a, b| mass[(part[a], part[b])]);
        // Checked where the matrix was given.
        let found = block.cholesky().map(|factor| factor.inverse());
        debug_assert!(found.is_some(), "the mass matrix is positive definite");
        for (a, &i) in part.iter().enumerate() {
            for (b, &j) in part.iter().enumerate() {
                inverse[(i, j)] = found.as_ref().map_or(f64::NAN, |found| found[(a, b)]);
            }
        }
    }
    inverse
}

/// M⁻¹b.
fn responses_to(inverse_mass: &Sparse, direction: &Entries) -> Vec<(usize, f64)> {
    let mut response: Vec<(usize, f64)> = Vec::new();
    for &(j, b) in direction {
        // M is symmetric: a row of its inverse is a column.
        let (diagonal, beside) = inverse_mass.row(j);
        response.push((j, b * diagonal));
        response.extend(beside.iter().map(|&(i, entry)| (i, b * entry)));
    }
    sort_by(&mut response, |&(i, _)| i as f64);
    response.dedup_by(|next, sum| {
        let is_same = next.0 == sum.0;
        if is_same {
            sum.1 += next.1;
        }
        is_same
    });
    response
}

/// Σ_j |a_ij| of each row.
fn row_sums(matrix: &Sparse) -> impl Iterator<Item = f64> {
    matrix
        .rows()
        .map(|(diagonal, beside)| diagonal.abs() + beside.iter().map(|(_, a)| a.abs()).sum::<f64>())
}

fn largest(numbers: impl Iterator<Item = f64>) -> f64 {
    numbers.fold(0.0, f64::max)
}
