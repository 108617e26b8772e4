//! The series of coordinates in groups of four, side by side in the lanes of vector registers. Used
//! for steps in which the loads of all rigid contacts are constant, every one of them that sticks
//! has a coordinate to itself and no memory, and no series is of rounding.
//!
//! The laws are recorded at the start of the step: see `scalar/recorded.rs`. All coordinates of a
//! group follow one equation, without a branch:
//!
//! ```text
//! a_k = (M⁻¹f − M⁻¹K q − M⁻¹C v − Σ_c x_c ℓ_c − Σ_c M⁻¹d_c N_c − w')_k
//! y_{k+1} = (σ a_k − N m_k)/(k + 1),   v_{k+1} = σ y_{k+1} + w_{k+1}
//! ```
//!
//! with σ = 0 for those that are held, and σ = 1, N = 0, w = 0 for those without a contact of their
//! own. The contacts without a coordinate of their own have groups, too, with
//!
//! ```text
//! y_{k+1} = σ (b·v − w)_{k+1} − [(k + 2) μ N_{k+2}/k_t]   […]: if an elastic contact slips
//! ℓ_c = σ N m_k                if the contact is rigid and slips
//! ℓ_c = T_k = k_t y_{k−1}/k    if it is elastic and its slider is at rest, with σ = 1
//! ℓ_c = T_k = σ μ N_k          if it is elastic and slips
//! ```
//!
//! The load N = N_0(t) + n·q of an elastic contact acts along its normal spring, unless it is open.
//!
//! A memory z follows its rate, z_{k+1} = rate_k/(k + 1), or a slow manifold: see `slow.rs`.
//!
//! The forces of force elements have groups, too: m_k is order k of F_i, whose inputs are the
//! positions and velocities along the directions of the element, and ℓ = D m_k with a constant
//! factor D.

use std::collections::BTreeMap;
use std::ops::Range;

use super::contact::ContactData;
use super::contact_series::{ContactSeries, StepMode, correction};
use super::coordinate_series::{ALL, DisplacementSeries};
use super::element::ElementData;
use super::element_series::ElementSeries;
use super::model::Model;
use crate::scalar::fused;
use crate::scalar::lanes::{Chunk, LANES, Lanes, mul_add, plus, times};
use crate::scalar::recorded::{Output, Recorder};
use crate::series::{INTEGRAL, PowerSeries, TERMS};

/// Number of groups of a long chain that are expanded to the last order before the next are begun:
/// see [`Waves`].
const AT_A_TIME: usize = 4;

/// The groups of coordinates and their own contacts, those of [all other
/// contacts](Model::unowned), and those of the forces of elements.
#[derive(Debug, Clone)]
pub(super) struct Groups {
    fixed: Fixed,
    series: GroupSeries,
    recorder: Recorder,
    /// True if a contact that slips has a memory, or an element acts.
    has_inputs: bool,
}

/// The data that are constant in a motion.
#[derive(Debug, Clone)]
struct Fixed {
    /// Data of each group of coordinates.
    rows: Vec<Rows>,
    /// The directions b of each group of contacts without a coordinate of their own, and the
    /// gradients n of the loads, if loads vary.
    directions: Vec<Columns>,
    gradients: Vec<Columns>,
    /// The forces of elements: F_i by its element and i.
    forces: Vec<[usize; 2]>,
    /// The directions of the elements of each group of forces: the first of each, the second, and
    /// so on.
    inputs: Vec<Vec<Columns>>,
    waves: Waves,
}

/// The columns of some rows of a matrix: where they are, and their entries.
type Columns = Vec<(Slot, Lanes)>;

/// The rows of a group of coordinates.
#[derive(Debug, Clone)]
struct Rows {
    /// The diagonals of M⁻¹K and M⁻¹C, and the columns beside them that are not 0.
    diagonal: [Lanes; 2],
    beside: [Columns; 2],
    /// x_c of the rigid contacts without a coordinate of their own.
    responses: Columns,
    /// x_c of the elastic contacts and M⁻¹a_i of the elements, and M⁻¹d_c by the number among all
    /// loads.
    springs: Columns,
    reactions: Columns,
}

/// Group and lane of a coordinate or contact.
#[derive(Debug, Clone, Copy)]
struct Slot {
    group: usize,
    lane: usize,
}

impl Slot {
    fn of(number: usize) -> Self {
        Self {
            group: number / LANES,
            lane: number % LANES,
        }
    }
}

/// The series of all groups.
#[derive(Debug, Clone)]
struct GroupSeries {
    /// The displacements, then the coefficients of the velocities: number k is q_0 or k q_k.
    motions: Vec<[Lanes; TERMS + 1]>,
    groups: Vec<Group>,
    /// The loads of each group of contacts without a coordinate of their own; none if all are
    /// constant.
    loads: Vec<Loads>,
}

/// The loads of a group of elastic contacts.
#[derive(Debug, Clone)]
struct Loads {
    /// N_0(t), and N.
    given: [Lanes; TERMS],
    loads: [Lanes; TERMS],
    /// μ and μ/k_t in slip, otherwise 0.
    coefficient: Lanes,
    yielding: Lanes,
    /// 1 for those that are closed, otherwise 0.
    closed: Lanes,
}

/// A group: a contact or a force of an element in each lane, or none.
#[derive(Debug, Clone)]
struct Group {
    side: Lanes,
    load: Lanes,
    speeds: [Lanes; TERMS],
    /// m, T of an elastic contact, or F_i of an element.
    friction: [Lanes; TERMS],
    /// True if a slider of the group is at rest: then k_t of each, and 0 in other lanes.
    is_elastic: bool,
    stiffness: Lanes,
    /// a.
    carried: [Lanes; TERMS],
    /// The accelerations against the forces of elastic contacts and of elements.
    pushed: [Lanes; TERMS],
    /// True if a force or a surface of the group varies: then M⁻¹f − w', and w.
    is_driven: bool,
    given: [Lanes; TERMS],
    surface: [Lanes; TERMS],
    /// The laws: one chunk for those with the same operations, and how many are in use. The memory
    /// of a law is among the inputs of its chunk.
    chunks: Vec<Chunk>,
    used: usize,
    /// The number of the chunk with the law of each coordinate.
    chunk_of: [usize; LANES],
    /// D of the memories that are on a slow manifold; 0 of the others.
    relaxation: Lanes,
}

/// The series of a coordinate and its contact, or of another contact.
pub(super) struct Member<'g> {
    series: &'g GroupSeries,
    group: &'g Group,
    slot: Slot,
}

/// The list of orders in [`each_order`] is complete.
const _: () = assert!(ALL == 26);

/// Writes out all orders after the first: a tenth faster than a loop. In one function they would
/// take several times as long to compile as in five.
macro_rules! each_order {
    ($fixed:ident, $series:ident, $start:ident) => {
        each_order!(
            $fixed, $series, $start,
            [1 2 3 4 5][6 7 8 9 10][11 12 13 14 15][16 17 18 19 20][21 22 23 24 25]
        )
    };
    ($fixed:ident, $series:ident, $start:ident, $([$($order:literal)*])*) => {$(
        fused::compute(
            $fixed,
            $series,
            #[inline(always)]
            |fixed, series| {
                $(series.order::<true, false>(fixed, $start, $order);)*
            },
            |fixed, series| {
                $(series.unfused_order(fixed, $start, $order);)*
            },
        );
    )*};
}

impl Groups {
    pub(super) fn new(model: &Model<'_>, loads_vary: bool) -> Self {
        let count = model.len().div_ceil(LANES);
        let unowned: Vec<usize> = model.unowned().collect();
        let [mut responses, mut springs, mut reactions] =
            [0; 3].map(|_| vec![Vec::new(); model.len()]);
        for (place, &c) in unowned.iter().enumerate() {
            let contact = &model.contacts[c];
            let rows = if contact.is_elastic() {
                &mut springs
            } else {
                &mut responses
            };
            for &(j, x) in contact.responses() {
                rows[j].push((count * LANES + place, x));
            }
            for &(j, y) in &contact.reaction {
                reactions[j].push((place, y));
            }
        }
        let first_force = (count + unowned.len().div_ceil(LANES)) * LANES;
        let mut forces = Vec::new();
        for (e, element) in model.elements.iter().enumerate() {
            for (i, response) in element.responses.iter().enumerate() {
                for &(j, x) in response {
                    springs[j].push((first_force + forces.len(), x));
                }
                forces.push([e, i]);
            }
        }
        let inputs = forces.chunks(LANES).map(|forces| {
            let directions = |&[e, _]: &[usize; 2]| &model.elements[e].directions[..];
            let most = forces.iter().map(|force| directions(force).len()).max();
            let of = |number: usize| {
                let direction = |force| directions(force).get(number).map_or(&[][..], |of| of);
                columns(forces.iter().map(direction))
            };
            (0..most.unwrap_or(0)).map(of).collect()
        });
        let inputs: Vec<Vec<Columns>> = inputs.collect();
        let matrices = [&model.stiffness, &model.damping];
        let rows = (0..count).map(|group| {
            let own = group * LANES..model.len().min((group + 1) * LANES);
            let mut diagonal = [[0.0; LANES]; 2];
            for (matrix, diagonal) in std::iter::zip(matrices, &mut diagonal) {
                for (own, entry) in std::iter::zip(own.clone(), diagonal) {
                    *entry = matrix.row(own).0;
                }
            }
            Rows {
                diagonal,
                beside: matrices.map(|matrix| columns(own.clone().map(|i| matrix.row(i).1))),
                responses: columns(own.clone().map(|i| &responses[i][..])),
                springs: columns(own.clone().map(|i| &springs[i][..])),
                reactions: columns(own.map(|i| &reactions[i][..])),
            }
        });
        let contacts = unowned.chunks(LANES).map(|group| {
            let contacts = group.iter().map(|&c| &model.contacts[c]);
            [
                columns(contacts.clone().map(|contact| &*contact.direction)),
                columns(contacts.map(|contact| &contact.load_gradient[..])),
            ]
        });
        let (directions, mut gradients): (Vec<Columns>, Vec<Columns>) =
            contacts.map(<[Columns; 2]>::into).unzip();
        if !loads_vary {
            gradients.clear();
        }
        let zero = [[0.0; LANES]; TERMS];
        let group = Group {
            side: [0.0; LANES],
            load: [0.0; LANES],
            speeds: zero,
            friction: zero,
            is_elastic: false,
            stiffness: [0.0; LANES],
            carried: zero,
            pushed: zero,
            is_driven: false,
            given: zero,
            surface: zero,
            chunks: Vec::new(),
            used: 0,
            chunk_of: [0; LANES],
            relaxation: [0.0; LANES],
        };
        let loads = Loads {
            given: zero,
            loads: zero,
            coefficient: [0.0; LANES],
            yielding: [0.0; LANES],
            closed: [0.0; LANES],
        };
        // Contacts and elements may couple any coordinates.
        let at_a_time = if directions.is_empty() && forces.is_empty() {
            AT_A_TIME
        } else {
            count
        };
        Self {
            series: GroupSeries {
                motions: vec![[[0.0; LANES]; TERMS + 1]; count],
                groups: vec![group; count + directions.len() + inputs.len()],
                loads: vec![loads; gradients.len()],
            },
            fixed: Fixed {
                rows: rows.collect(),
                directions,
                gradients,
                forces,
                inputs,
                waves: Waves::new(count, at_a_time, model.bandwidth.div_ceil(LANES)),
            },
            recorder: Recorder::default(),
            has_inputs: false,
        }
    }

    /// The number of a contact without a coordinate of its own, from its place among them. A
    /// coordinate and its own contact have the number of the coordinate.
    pub(super) fn number_of_unowned(&self, place: usize) -> usize {
        self.series.motions.len() * LANES + place
    }

    /// Number of the forces of elements.
    pub(super) fn forces(&self) -> usize {
        self.fixed.forces.len()
    }

    /// The element of a force, from the place of the force among them, and the number i of its
    /// direction.
    pub(super) fn force(&self, place: usize) -> [usize; 2] {
        self.fixed.forces[place]
    }

    /// The number of a force of an element.
    pub(super) fn number_of_force(&self, place: usize) -> usize {
        self.fixed.first_force() + place
    }

    /// Begins a step: nothing moves, and nothing is driven.
    pub(super) fn clear(&mut self) {
        self.has_inputs = false;
        for group in &mut self.series.groups {
            (group.side, group.load, group.used) = ([0.0; LANES], [0.0; LANES], 0);
            (group.is_driven, group.relaxation) = (false, [0.0; LANES]);
            (group.is_elastic, group.stiffness) = (false, [0.0; LANES]);
            if !self.fixed.inputs.is_empty() {
                // Not computed where all stops are open.
                group.pushed = [[0.0; LANES]; TERMS];
            }
        }
        for loads in &mut self.series.loads {
            (loads.coefficient, loads.yielding) = ([0.0; LANES], [0.0; LANES]);
        }
    }

    /// Sets displacement, velocity, and coefficient 1 of the velocity of a coordinate.
    pub(super) fn start(&mut self, coordinate: usize, numbers: [f64; 3]) {
        let Slot { group, lane } = Slot::of(coordinate);
        let motion = &mut self.series.motions[group];
        for (own, number) in std::iter::zip(motion, numbers) {
            own[lane] = number;
        }
    }

    /// Sets a coordinate to be free.
    pub(super) fn free(&mut self, coordinate: usize) {
        let Slot { group, lane } = Slot::of(coordinate);
        self.series.groups[group].side[lane] = 1.0;
    }

    /// Sets a contact to slip, with its series so far.
    pub(super) fn slip(&mut self, number: usize, contact: &ContactData<'_>, of: &ContactSeries) {
        let Slot { group, lane } = Slot::of(number);
        let group = &mut self.series.groups[group];
        (group.side[lane], group.load[lane]) = (of.side, of.load[0]);
        (group.speeds[0][lane], group.speeds[1][lane]) = (of.speeds[0], of.speeds[1]);
        group.friction[0][lane] = of.friction[0];
        let load = of.load[0] / contact.compliance;
        let memory = &|j: usize| of.memories[j][0];
        let law = contact.law;
        let output = law.record(&mut self.recorder, of.slip(0), load, memory);
        let place = group.take(lane, &mut self.recorder, output);
        if of.memories.is_empty() {
            return;
        }
        self.has_inputs = true;
        (group.chunk_of[lane], group.relaxation[lane]) = (place, of.relaxation);
        let inputs = group.chunks[place].inputs_mut();
        for (row, memory) in std::iter::zip(inputs, &of.memories) {
            for k in 1..TERMS {
                row[k][lane] = memory[k];
            }
        }
    }

    /// Sets a force of an element that acts.
    pub(super) fn push(&mut self, place: usize, element: &ElementData<'_>, of: &ElementSeries) {
        let Slot { group, lane } = Slot::of(self.number_of_force(place));
        let [_, i] = self.force(place);
        let group = &mut self.series.groups[group];
        (group.side[lane], group.load[lane]) = (1.0, of.factor[0]);
        self.has_inputs = true;
        let output = element.law.record(&mut self.recorder, of.place(), i);
        group.chunk_of[lane] = group.take(lane, &mut self.recorder, output);
    }

    /// Sets an elastic contact: its stiffness and the sign of y, which are k_t and 1 while its
    /// slider is at rest, 0 and σ in slip, and y up to order 1.
    pub(super) fn spring(&mut self, number: usize, [stiffness, side]: [f64; 2], speeds: [f64; 2]) {
        let Slot { group, lane } = Slot::of(number);
        let group = &mut self.series.groups[group];
        (group.side[lane], group.load[lane]) = (side, 1.0);
        group.stiffness[lane] = stiffness;
        group.is_elastic |= stiffness > 0.0;
        for (own, speed) in std::iter::zip(&mut group.speeds, speeds) {
            own[lane] = speed;
        }
    }

    /// Sets the load of an elastic contact, by its place among the contacts without a coordinate of
    /// their own, from its series up to order 2.
    pub(super) fn press(&mut self, place: usize, contact: &ContactData<'_>, of: &ContactSeries) {
        let Slot { group, lane } = Slot::of(place);
        let loads = &mut self.series.loads[group];
        let coefficient = if of.mode == StepMode::Slip {
            of.limits[0]
        } else {
            0.0
        };
        let stiffness = contact.tangential_stiffness.unwrap_or(f64::INFINITY);
        loads.coefficient[lane] = coefficient;
        loads.yielding[lane] = coefficient / stiffness;
        loads.closed[lane] = if of.mode == StepMode::Open { 0.0 } else { 1.0 };
        for k in 0..TERMS {
            loads.given[k][lane] = of.drive_load[k];
        }
        for k in 0..3 {
            loads.loads[k][lane] = of.load[k];
        }
    }

    /// Sets a force that varies, and the velocity of the surface.
    pub(super) fn drive(
        &mut self,
        number: usize,
        force: &PowerSeries,
        surface: Option<&PowerSeries>,
    ) {
        let Slot { group, lane } = Slot::of(number);
        let group = &mut self.series.groups[group];
        if !group.is_driven {
            (group.given, group.surface) = ([[0.0; LANES]; TERMS], [[0.0; LANES]; TERMS]);
            group.is_driven = true;
        }
        for k in 1..ALL {
            let next = surface.map_or(0.0, |surface| surface[k + 1]);
            group.given[k][lane] = force[k] - (k + 1) as f64 * next;
            group.surface[k + 1][lane] = next;
        }
    }

    /// Computes all orders after the first.
    pub(super) fn expand(&mut self) {
        let (fixed, series) = (&self.fixed, &mut self.series);
        // Code for laws of the sliding speed alone, of contacts that have a coordinate each, is
        // faster.
        if self.has_inputs || !fixed.directions.is_empty() {
            fused::compute(
                fixed,
                series,
                #[inline(always)]
                |fixed, series| series.all_orders::<true>(fixed),
                |fixed, series| series.all_orders::<false>(fixed),
            );
        } else {
            for start in fixed.waves.starts(ALL - 1) {
                each_order!(fixed, series, start);
            }
        }
    }

    pub(super) fn member(&self, number: usize) -> Member<'_> {
        let slot = Slot::of(number);
        Member {
            series: &self.series,
            group: &self.series.groups[slot.group],
            slot,
        }
    }
}

impl Fixed {
    /// The number of the first force of the elements.
    fn first_force(&self) -> usize {
        (self.rows.len() + self.directions.len()) * LANES
    }
}

impl Group {
    /// Takes a recorded law into a lane, and returns the number of its chunk.
    fn take(&mut self, lane: usize, recorder: &mut Recorder, output: Output) -> usize {
        let mut open = self.chunks[..self.used].iter_mut();
        let place = open.position(|chunk| chunk.take(lane, recorder, output));
        place.unwrap_or_else(|| {
            if self.used == self.chunks.len() {
                self.chunks.push(Chunk::new());
            }
            self.chunks[self.used].begin(lane, recorder, output);
            self.used += 1;
            self.used - 1
        })
    }
}

impl Member<'_> {
    /// Puts the displacement and the coefficients of the velocity in their place.
    pub(super) fn give_motion(&self, motion: &mut DisplacementSeries) {
        let Slot { group, lane } = self.slot;
        let numbers = &self.series.motions[group];
        motion.set(|k| numbers[k][lane % LANES]);
    }

    /// Copies the series of a contact that slips, and of its memory, from order 1 on.
    pub(super) fn give_slip(&self, of: &mut ContactSeries) {
        let lane = self.slot.lane % LANES;
        let (speeds, friction) = (&mut of.speeds, &mut of.friction);
        for k in 0..TERMS {
            speeds[k] = self.group.speeds[k][lane];
            friction[k] = self.group.friction[k][lane];
        }
        let chunk_of = &self.group.chunks[self.group.chunk_of[lane]];
        for (j, memory) in of.memories.iter_mut().enumerate() {
            let input = chunk_of.input(j);
            for k in 1..TERMS {
                memory[k] = input[k][lane];
            }
        }
    }

    /// Copies the series of F_i of an element, and of its positions and velocities, from order 1
    /// on.
    pub(super) fn give_element(&self, of: &mut ElementSeries, i: usize) {
        let lane = self.slot.lane % LANES;
        let chunk = &self.group.chunks[self.group.chunk_of[lane]];
        let motion = of.positions.iter_mut().chain(&mut of.velocities);
        for (number, series) in motion.enumerate() {
            let input = chunk.input(number);
            for k in 1..ALL {
                series[k] = input[k][lane];
            }
        }
        for k in 1..ALL {
            of.forces[i][k] = self.group.friction[k][lane];
        }
    }

    /// Copies the series of the force in an elastic contact, of its load, and of the speed of its
    /// slider, from order 2 on. The last coefficient of the speed remains 0.
    pub(super) fn give_spring(&self, of: &mut ContactSeries) {
        let lane = self.slot.lane % LANES;
        let (speeds, stiffness) = (&self.group.speeds, self.group.stiffness[lane]);
        for k in 2..TERMS {
            let carried = stiffness * speeds[k - 1][lane] * INTEGRAL[k - 1];
            (of.carried[k], of.memories[0][k]) = (carried, carried);
        }
        if let Some(place) = self.slot.group.checked_sub(self.series.motions.len())
            && of.load_varies
            && let Some(of_loads) = self.series.loads.get(place)
        {
            let coefficient = self.group.side[lane] * of_loads.coefficient[lane];
            for (k, loads) in of_loads.loads.iter().enumerate().skip(2) {
                let load = loads[lane];
                of.load[k] = load;
                for bound in &mut of.bounds {
                    bound[k] = load * of.limits[0];
                }
                if of.mode == StepMode::Slip {
                    (of.carried[k], of.memories[0][k]) = (coefficient * load, coefficient * load);
                }
            }
        }
        if of.mode == StepMode::Slip {
            for (k, speed) in speeds.iter().enumerate().take(ALL).skip(2) {
                of.speeds[k] = speed[lane];
            }
        }
    }

    /// Copies the accelerations of a coordinate by given forces, by elastic contacts and by
    /// elements, from order 1 on.
    pub(super) fn give_force(&self, given: &PowerSeries, force: &mut PowerSeries) {
        let lane = self.slot.lane % LANES;
        for k in 1..ALL {
            force[k] = given[k] - self.group.pushed[k][lane];
        }
    }

    /// Copies the series of the force in a contact from order 1 on.
    pub(super) fn give_carried(&self, carried: &mut PowerSeries) {
        let lane = self.slot.lane % LANES;
        for k in 1..TERMS {
            carried[k] = self.group.carried[k][lane];
        }
    }
}

/// The columns of up to four rows, each given by its entries.
fn columns<'r>(rows: impl Iterator<Item = &'r [(usize, f64)]>) -> Columns {
    let mut columns = BTreeMap::new();
    for (lane, row) in rows.enumerate() {
        for &(j, a) in row {
            columns.entry(j).or_insert([0.0; LANES])[lane] = a;
        }
    }
    let columns = columns.into_iter();
    columns.map(|(j, entries)| (Slot::of(j), entries)).collect()
}

/// The sequence in which the orders of many places are computed: group by group, if there are more
/// than `at_a_time`. An order of a place needs those before of the places within `shift`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Waves {
    count: usize,
    at_a_time: usize,
    shift: usize,
}

impl Waves {
    pub(super) fn new(count: usize, at_a_time: usize, shift: usize) -> Self {
        let (at_a_time, shift) = if count <= at_a_time {
            (count.max(1), 0)
        } else {
            (at_a_time, shift)
        };
        Self {
            count,
            at_a_time,
            shift,
        }
    }

    /// The places at which the waves of so many orders begin.
    pub(super) fn starts(self, orders: usize) -> impl Iterator<Item = usize> {
        (0..self.count + orders * self.shift).step_by(self.at_a_time)
    }

    /// The places whose order comes next in a wave, after that many of its orders.
    #[inline(always)]
    pub(super) fn places(self, start: usize, done: usize) -> Range<usize> {
        let behind = done * self.shift;
        let place = |i: usize| i.saturating_sub(behind).min(self.count);
        place(start)..place(start + self.at_a_time)
    }
}

impl GroupSeries {
    /// Computes all orders after the first, with memories and contacts without a coordinate of
    /// their own.
    #[inline(always)]
    fn all_orders<const CHOSEN: bool>(&mut self, fixed: &Fixed) {
        for start in fixed.waves.starts(ALL - 1) {
            for k in 1..ALL {
                self.order::<CHOSEN, true>(fixed, start, k);
            }
        }
    }

    /// An order without these, for a processor without fused multiply-adds.
    #[inline(never)]
    fn unfused_order(&mut self, fixed: &Fixed, start: usize, k: usize) {
        self.order::<false, false>(fixed, start, k);
    }

    /// Order k > 0 of the groups that come next in a wave.
    #[inline(always)]
    fn order<const CHOSEN: bool, const EXTENDED: bool>(
        &mut self,
        fixed: &Fixed,
        start: usize,
        k: usize,
    ) {
        // Tells the compiler which coefficients there are.
        let k = k.min(ALL - 1);
        let own = fixed.waves.places(start, k - 1);
        let others = self.motions.len()..self.groups.len();
        if EXTENDED {
            let first_force = fixed.first_force() / LANES;
            // Not a chain of ranges: its body would be compiled twice.
            for place in 0..own.len() + others.len() {
                let g = match place.checked_sub(own.len()) {
                    None => own.start + place,
                    Some(place) => others.start + place,
                };
                if let Some(group) = g.checked_sub(first_force) {
                    self.input_order::<CHOSEN>(k, &fixed.inputs[group], g);
                }
                self.friction_order::<CHOSEN, EXTENDED>(k, g);
            }
            for (place, of_loads) in self.loads.iter().enumerate() {
                let friction = &mut self.groups[others.start + place].friction[k];
                *friction = mul_add::<CHOSEN>(of_loads.coefficient, of_loads.loads[k], *friction);
            }
        }
        for g in own {
            if !EXTENDED {
                self.friction_order::<CHOSEN, EXTENDED>(k, g);
            }
            self.motion_order::<CHOSEN, EXTENDED>(k, &fixed.rows[g], g);
        }
        if EXTENDED {
            for (place, directions) in fixed.directions.iter().enumerate() {
                let g = others.start + place;
                self.slip_order::<CHOSEN>(k, directions, g);
                if let Some(gradients) = fixed.gradients.get(place) {
                    self.load_order::<CHOSEN>(k, gradients, (place, g));
                }
            }
        }
    }

    /// Order k > 0 of the inputs of a group of forces.
    #[inline(always)]
    fn input_order<const CHOSEN: bool>(&mut self, k: usize, directions: &[Columns], g: usize) {
        for (number, columns) in directions.iter().enumerate() {
            let [mut position, mut velocity] = [[0.0; LANES]; 2];
            for &(Slot { group, lane }, entries) in columns {
                let motion = &self.motions[group];
                position = mul_add::<CHOSEN>([motion[k][lane]; LANES], entries, position);
                velocity = mul_add::<CHOSEN>([motion[k + 1][lane]; LANES], entries, velocity);
            }
            // Number k of a displacement is k q_k.
            position = times([INTEGRAL[k - 1]; LANES], position);
            let group = &mut self.groups[g];
            for chunk in &mut group.chunks[..group.used] {
                let inputs = chunk.inputs_mut();
                let (positions, velocities) = inputs.split_at_mut(inputs.len() / 2);
                if number < positions.len() {
                    (positions[number][k], velocities[number][k]) = (position, velocity);
                }
            }
        }
    }

    /// Order k > 0 of the laws of a group.
    #[inline(always)]
    fn friction_order<const CHOSEN: bool, const EXTENDED: bool>(&mut self, k: usize, g: usize) {
        let group = &mut self.groups[g];
        let mut friction = [0.0; LANES];
        for chunk in &mut group.chunks[..group.used] {
            let mut is_relaxed = false;
            friction = loop {
                let sum = chunk.order::<CHOSEN, EXTENDED>(k, group.speeds[k], friction);
                let remembers = EXTENDED && chunk.rates() > 0;
                if !remembers || memory_order(chunk, k, &group.relaxation, &mut is_relaxed) {
                    break sum;
                }
            };
        }
        if EXTENDED && group.is_elastic {
            let rate = times(group.stiffness, group.speeds[k - 1]);
            friction = mul_add::<CHOSEN>([INTEGRAL[k - 1]; LANES], rate, friction);
        }
        group.friction[k] = friction;
    }

    /// Order k of what accelerates a group of coordinates, and k + 1 of its velocities.
    #[inline(always)]
    fn motion_order<const CHOSEN: bool, const EXTENDED: bool>(
        &mut self,
        k: usize,
        rows: &Rows,
        g: usize,
    ) {
        let own = &self.motions[g];
        let mut springs = times(rows.diagonal[0], own[k]);
        let mut dampers = times(rows.diagonal[1], own[k + 1]);
        for &(Slot { group, lane }, entries) in &rows.beside[0] {
            let displacement = self.motions[group][k][lane];
            springs = mul_add::<CHOSEN>([displacement; LANES], entries, springs);
        }
        for &(Slot { group, lane }, entries) in &rows.beside[1] {
            let velocity = self.motions[group][k + 1][lane];
            dampers = mul_add::<CHOSEN>([velocity; LANES], entries, dampers);
        }
        if EXTENDED {
            for &(Slot { group, lane }, entries) in &rows.responses {
                let of = &self.groups[group];
                let force = of.side[lane] * of.load[lane] * of.friction[k][lane];
                dampers = mul_add::<CHOSEN>([force; LANES], entries, dampers);
            }
        }
        let mut pushed = [0.0; LANES];
        if EXTENDED {
            for &(Slot { group, lane }, entries) in &rows.springs {
                let of = &self.groups[group];
                let force = of.side[lane] * of.load[lane] * of.friction[k][lane];
                pushed = mul_add::<CHOSEN>([force; LANES], entries, pushed);
            }
            for &(Slot { group, lane }, entries) in &rows.reactions {
                let of = &self.loads[group];
                let force = of.closed[lane] * of.loads[k][lane];
                pushed = mul_add::<CHOSEN>([force; LANES], entries, pushed);
            }
            dampers = plus(dampers, pushed);
        }
        // Number k of a displacement is k q_k.
        let pull = mul_add::<CHOSEN>([INTEGRAL[k - 1]; LANES], springs, dampers);
        let group = &mut self.groups[g];
        if EXTENDED {
            group.pushed[k] = pushed;
        }
        let minus = [-1.0; LANES];
        let mut rate = times(minus, pull);
        if group.is_driven {
            rate = plus(rate, group.given[k]);
        }
        group.carried[k] = rate;
        let braked = times(minus, times(group.load, group.friction[k]));
        let speed = mul_add::<CHOSEN>(group.side, rate, braked);
        let speed = times([INTEGRAL[k]; LANES], speed);
        group.speeds[k + 1] = speed;
        let mut velocity = times(group.side, speed);
        if group.is_driven {
            velocity = plus(velocity, group.surface[k + 1]);
        }
        self.motions[g][k + 2] = velocity;
    }

    /// Order k + 1 of the sliding speeds of a group of contacts without a coordinate of their own.
    #[inline(always)]
    fn slip_order<const CHOSEN: bool>(&mut self, k: usize, directions: &Columns, g: usize) {
        let mut relative = [0.0; LANES];
        if self.groups[g].is_driven {
            relative = times([-1.0; LANES], self.groups[g].surface[k + 1]);
        }
        for &(Slot { group, lane }, entries) in directions {
            let velocity = self.motions[group][k + 2][lane];
            relative = mul_add::<CHOSEN>([velocity; LANES], entries, relative);
        }
        let group = &mut self.groups[g];
        group.speeds[k + 1] = times(group.side, relative);
    }

    /// Order k + 2 of the loads of a group of elastic contacts, and their part in order k + 1 of
    /// the speeds of sliders.
    #[inline(always)]
    fn load_order<const CHOSEN: bool>(
        &mut self,
        k: usize,
        gradients: &Columns,
        (place, g): (usize, usize),
    ) {
        if k + 2 == TERMS {
            return;
        }
        let mut rates = [0.0; LANES];
        for &(Slot { group, lane }, entries) in gradients {
            let velocity = self.motions[group][k + 2][lane];
            rates = mul_add::<CHOSEN>([velocity; LANES], entries, rates);
        }
        let (of_loads, group) = (&mut self.loads[place], &mut self.groups[g]);
        let load = mul_add::<CHOSEN>([INTEGRAL[k + 1]; LANES], rates, of_loads.given[k + 2]);
        of_loads.loads[k + 2] = load;
        let yielded = times([-((k + 2) as f64); LANES], load);
        group.speeds[k + 1] = mul_add::<CHOSEN>(of_loads.yielding, yielded, group.speeds[k + 1]);
    }
}

/// Sets coefficient k + 1 of the memories of a chunk, after order k of its laws. On a slow manifold
/// it first corrects coefficient k, once; then it returns false: the order has to be computed
/// again.
#[inline(never)]
fn memory_order(chunk: &mut Chunk, k: usize, relaxation: &Lanes, is_relaxed: &mut bool) -> bool {
    let is_last = std::mem::replace(is_relaxed, true) || *relaxation == [0.0; LANES];
    for j in 0..chunk.rates() {
        let rate = chunk.rate(j, k);
        let memory = &mut chunk.inputs_mut()[j];
        for lane in 0..LANES {
            let [own, next] = [memory[k][lane], memory[k + 1][lane]];
            if relaxation[lane] == 0.0 {
                memory[k + 1][lane] = rate[lane] * INTEGRAL[k];
            } else if !is_last {
                memory[k][lane] += correction(relaxation[lane], k, rate[lane], [own, next]);
            }
        }
    }
    is_last
}
