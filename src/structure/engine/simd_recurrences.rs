//! The series of groups of four, order by order: see `simd_groups.rs`.
//!
//! All coordinates of a group follow one equation, without a branch:
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
//! A memory z follows its rate, z_{k+1} = rate_k/(k + 1), or a slow manifold: `slow_manifold.rs`.
//!
//! The forces of force elements have groups, too: m_k is order k of F_i, whose inputs are the
//! positions and velocities along the directions of the element, and ℓ = D m_k with a constant
//! factor D.

use std::collections::BTreeMap;
use std::ops::Range;

use super::contact_series::correction;
use super::coordinate_series::ALL;
use crate::scalar::lanes::{Chunk, LANES, Lanes, mul_add, plus, times};
use crate::scalar::recorded::{Output, Recorder};
use crate::series::{INTEGRAL, TERMS};

/// The data that are constant in a motion.
#[derive(Debug, Clone)]
pub(super) struct Fixed {
    /// Data of each group of coordinates.
    pub(super) rows: Vec<Rows>,
    /// The directions b of each group of contacts without a coordinate of their own, and the
    /// gradients n of the loads, if loads vary.
    pub(super) directions: Vec<Columns>,
    pub(super) gradients: Vec<Columns>,
    /// The forces of elements: F_i by its element and i.
    pub(super) forces: Vec<[usize; 2]>,
    /// The directions of the elements of each group of forces: the first of each, the second, and
    /// so on.
    pub(super) inputs: Vec<Vec<Columns>>,
    pub(super) waves: Waves,
}

impl Fixed {
    /// The number of the first force of the elements.
    pub(super) fn first_force(&self) -> usize {
        (self.rows.len() + self.directions.len()) * LANES
    }
}

/// The columns of some rows of a matrix: where they are, and their entries.
pub(super) type Columns = Vec<(Slot, Lanes)>;

/// The rows of a group of coordinates.
#[derive(Debug, Clone)]
pub(super) struct Rows {
    /// The diagonals of M⁻¹K and M⁻¹C, and the columns beside them that are not 0.
    pub(super) diagonal: [Lanes; 2],
    pub(super) beside: [Columns; 2],
    /// x_c of the rigid contacts without a coordinate of their own.
    pub(super) responses: Columns,
    /// x_c of the elastic contacts and M⁻¹a_i of the elements, and M⁻¹d_c by the number among all
    /// loads.
    pub(super) springs: Columns,
    pub(super) reactions: Columns,
}

/// Group and lane of a coordinate or contact.
#[derive(Debug, Clone, Copy)]
pub(super) struct Slot {
    pub(super) group: usize,
    pub(super) lane: usize,
}

impl Slot {
    pub(super) fn of(number: usize) -> Self {
        Self {
            group: number / LANES,
            lane: number % LANES,
        }
    }
}

/// The series of all groups.
#[derive(Debug, Clone)]
pub(super) struct GroupSeries {
    /// The displacements, then the coefficients of the velocities: number k is q_0 or k q_k.
    pub(super) motions: Vec<[Lanes; TERMS + 1]>,
    pub(super) groups: Vec<Group>,
    /// The loads of each group of contacts without a coordinate of their own; none if all are
    /// constant.
    pub(super) loads: Vec<Loads>,
}

/// The loads of a group of elastic contacts.
#[derive(Debug, Clone)]
pub(super) struct Loads {
    /// N_0(t), and N.
    pub(super) given: [Lanes; TERMS],
    pub(super) loads: [Lanes; TERMS],
    /// μ and μ/k_t in slip, otherwise 0.
    pub(super) coefficient: Lanes,
    pub(super) yielding: Lanes,
    /// 1 for those that are closed, otherwise 0.
    pub(super) closed: Lanes,
}

/// A group: a contact or a force of an element in each lane, or none.
#[derive(Debug, Clone)]
pub(super) struct Group {
    pub(super) side: Lanes,
    pub(super) load: Lanes,
    pub(super) speeds: [Lanes; TERMS],
    /// m, T of an elastic contact, or F_i of an element.
    pub(super) friction: [Lanes; TERMS],
    /// True if a slider of the group is at rest: then k_t of each, and 0 in other lanes.
    pub(super) is_elastic: bool,
    pub(super) stiffness: Lanes,
    /// a.
    pub(super) carried: [Lanes; TERMS],
    /// The accelerations against the forces of elastic contacts and of elements.
    pub(super) pushed: [Lanes; TERMS],
    /// True if a force or a surface of the group varies: then M⁻¹f − w', and w.
    pub(super) is_driven: bool,
    pub(super) given: [Lanes; TERMS],
    pub(super) surface: [Lanes; TERMS],
    /// The laws: one chunk for those with the same operations, and how many are in use. The memory
    /// of a law is among the inputs of its chunk.
    pub(super) chunks: Vec<Chunk>,
    pub(super) used: usize,
    /// The number of the chunk with the law of each coordinate.
    pub(super) chunk_of: [usize; LANES],
    /// D of the memories that are on a slow manifold; 0 of the others.
    pub(super) relaxation: Lanes,
}

impl Group {
    /// Takes a recorded law into a lane, and returns the number of its chunk.
    pub(super) fn take(&mut self, lane: usize, recorder: &mut Recorder, output: Output) -> usize {
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

/// The columns of up to four rows, each given by its entries.
pub(super) fn columns<'r>(rows: impl Iterator<Item = &'r [(usize, f64)]>) -> Columns {
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
    pub(super) fn all_orders<const CHOSEN: bool>(&mut self, fixed: &Fixed) {
        for start in fixed.waves.starts(ALL - 1) {
            for k in 1..ALL {
                self.order::<CHOSEN, true>(fixed, start, k);
            }
        }
    }

    /// An order without these, for a processor without fused multiply-adds.
    #[inline(never)]
    pub(super) fn unfused_order(&mut self, fixed: &Fixed, start: usize, k: usize) {
        self.order::<false, false>(fixed, start, k);
    }

    /// Order k > 0 of the groups that come next in a wave.
    #[inline(always)]
    pub(super) fn order<const CHOSEN: bool, const EXTENDED: bool>(
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
