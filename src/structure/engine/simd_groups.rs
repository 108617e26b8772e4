//! The series of coordinates in groups of four, side by side in the lanes of vector registers. Used
//! for steps in which the loads of all rigid contacts are constant, every one of them that sticks
//! has a coordinate to itself and no memory, and no series is of rounding.
//!
//! The laws are recorded at the start of the step: see `scalar/recorded.rs`. The orders follow in
//! `simd_recurrences.rs`.

use super::contact_data::ContactData;
use super::contact_series::{ContactSeries, StepMode};
use super::coordinate_series::{ALL, DisplacementSeries};
use super::element_data::ElementData;
use super::element_series::ElementSeries;
use super::model::Model;
use super::simd_recurrences::{
    Columns, Fixed, Group, GroupSeries, Loads, Rows, Slot, Waves, columns,
};
use crate::scalar::fused;
use crate::scalar::lanes::LANES;
use crate::scalar::recorded::Recorder;
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
            // Constant loads act at order 0, which is not computed here.
            for &(j, y) in contact.reaction.iter().filter(|_| loads_vary) {
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
