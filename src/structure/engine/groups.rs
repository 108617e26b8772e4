//! The series of coordinates in groups of four, side by side in the lanes of vector registers. Used
//! for steps in which every coordinate is held, is free, or slips on its own contact, all with
//! constant loads; those that are held have no memory.
//!
//! The laws are recorded at the start of the step: see `scalar/recorded.rs`. All coordinates of a
//! group follow one equation, without a branch:
//!
//! ```text
//! a_k = (M⁻¹f − M⁻¹K q − M⁻¹C v − w')_k,   y_{k+1} = (σ a_k − N m_k)/(k + 1),
//! v_{k+1} = σ y_{k+1} + w_{k+1}
//! ```
//!
//! with σ = 0 for those that are held, and σ = 1, N = 0, w = 0 for those that are free. A memory z
//! follows its rate, z_{k+1} = rate_k/(k + 1), or a slow manifold: see `slow.rs`.

use std::ops::Range;

use super::ALL;
use super::model::Model;
use super::series::{ContactSeries, DisplacementSeries};
use super::slow::correction;
use super::sparse::Sparse;
use crate::friction::memory::object::LawObject;
use crate::scalar::fused;
use crate::scalar::lanes::{Chunk, LANES, Lanes, mul_add, plus, times};
use crate::scalar::recorded::Recorder;
use crate::series::{INTEGRAL, PowerSeries, TERMS};

/// Number of groups of a long chain that are expanded to the last order before the next are begun:
/// see [`Waves`].
const AT_A_TIME: usize = 4;

/// All groups.
#[derive(Debug, Clone)]
pub(super) struct Groups {
    rows: Vec<Rows>,
    series: GroupSeries,
    recorder: Recorder,
    /// True if a contact that slips has a memory.
    remembers: bool,
    /// Largest distance between two groups that act on each other, in numbers of groups.
    shift: usize,
}

/// The rows of M⁻¹K and M⁻¹C of a group.
#[derive(Debug, Clone)]
struct Rows {
    diagonal: [Lanes; 2],
    /// The columns beside the diagonal that are not 0: where they are, and their entries.
    beside: [Vec<(Slot, Lanes)>; 2],
}

/// Group and lane of a coordinate.
#[derive(Debug, Clone, Copy)]
struct Slot {
    group: usize,
    lane: usize,
}

impl Slot {
    fn of(coordinate: usize) -> Self {
        Self {
            group: coordinate / LANES,
            lane: coordinate % LANES,
        }
    }
}

/// The series of all groups.
#[derive(Debug, Clone)]
struct GroupSeries {
    /// The displacements, then the coefficients of the velocities: number k is q_0 or k q_k.
    motions: Vec<[Lanes; TERMS + 1]>,
    groups: Vec<Group>,
}

/// The contacts of a group.
#[derive(Debug, Clone)]
struct Group {
    side: Lanes,
    load: Lanes,
    speeds: [Lanes; TERMS],
    friction: [Lanes; TERMS],
    carried: [Lanes; TERMS],
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

/// The series of one coordinate.
pub(super) struct GroupedCoordinate<'g> {
    motion: &'g [Lanes; TERMS + 1],
    group: &'g Group,
    lane: usize,
}

impl Groups {
    pub(super) fn new(model: &Model<'_>) -> Self {
        let count = model.len().div_ceil(LANES);
        let [springs, dampers] = [&model.stiffness, &model.damping].map(rows_of);
        let rows = std::iter::zip(springs, dampers).map(|(springs, dampers)| Rows {
            diagonal: [springs.0, dampers.0],
            beside: [springs.1, dampers.1],
        });
        let zero = [[0.0; LANES]; TERMS];
        let group = Group {
            side: [0.0; LANES],
            load: [0.0; LANES],
            speeds: zero,
            friction: zero,
            carried: zero,
            is_driven: false,
            given: zero,
            surface: zero,
            chunks: Vec::new(),
            used: 0,
            chunk_of: [0; LANES],
            relaxation: [0.0; LANES],
        };
        Self {
            rows: rows.collect(),
            series: GroupSeries {
                motions: vec![[[0.0; LANES]; TERMS + 1]; count],
                groups: vec![group; count],
            },
            recorder: Recorder::default(),
            remembers: false,
            shift: model.bandwidth.div_ceil(LANES),
        }
    }

    /// Begins a step: nothing moves, and nothing is driven.
    pub(super) fn clear(&mut self) {
        self.remembers = false;
        for group in &mut self.series.groups {
            (group.side, group.load, group.used) = ([0.0; LANES], [0.0; LANES], 0);
            (group.is_driven, group.relaxation) = (false, [0.0; LANES]);
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

    /// Sets a coordinate to slip, with its law and the series of its contact so far.
    pub(super) fn slip(&mut self, coordinate: usize, law: &dyn LawObject, of: &ContactSeries) {
        let Slot { group, lane } = Slot::of(coordinate);
        let group = &mut self.series.groups[group];
        (group.side[lane], group.load[lane]) = (of.side, of.load[0]);
        (group.speeds[0][lane], group.speeds[1][lane]) = (of.speeds[0], of.speeds[1]);
        group.friction[0][lane] = of.friction[0];
        let output = law.record(&mut self.recorder, of.slip(0), &|j| of.memories[j][0]);
        let mut open = group.chunks[..group.used].iter_mut();
        let place = open.position(|chunk| chunk.take(lane, &mut self.recorder, output));
        let place = place.unwrap_or_else(|| {
            if group.used == group.chunks.len() {
                group.chunks.push(Chunk::new());
            }
            group.chunks[group.used].begin(lane, &mut self.recorder, output);
            group.used += 1;
            group.used - 1
        });
        if of.memories.is_empty() {
            return;
        }
        self.remembers = true;
        (group.chunk_of[lane], group.relaxation[lane]) = (place, of.relaxation);
        let inputs = group.chunks[place].inputs_mut();
        for (row, memory) in std::iter::zip(inputs, &of.memories) {
            for k in 1..TERMS {
                row[k][lane] = memory[k];
            }
        }
    }

    /// Sets a force that varies, and the velocity of the surface.
    pub(super) fn drive(
        &mut self,
        coordinate: usize,
        force: &PowerSeries,
        surface: Option<&PowerSeries>,
    ) {
        let Slot { group, lane } = Slot::of(coordinate);
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

    /// All orders after the first.
    pub(super) fn expand(&mut self) {
        let work = &mut (&mut self.series, self.shift);
        // Code that knows of no memory is faster.
        if self.remembers {
            fused::compute(
                &self.rows,
                work,
                #[inline(always)]
                |rows, (series, shift)| series.all_orders::<true, true>(rows, *shift),
                |rows, (series, shift)| series.all_orders::<false, true>(rows, *shift),
            );
        } else {
            fused::compute(
                &self.rows,
                work,
                #[inline(always)]
                |rows, (series, shift)| series.all_orders::<true, false>(rows, *shift),
                |rows, (series, shift)| series.all_orders::<false, false>(rows, *shift),
            );
        }
    }

    pub(super) fn member(&self, coordinate: usize) -> GroupedCoordinate<'_> {
        let Slot { group, lane } = Slot::of(coordinate);
        GroupedCoordinate {
            motion: &self.series.motions[group],
            group: &self.series.groups[group],
            lane,
        }
    }
}

impl GroupedCoordinate<'_> {
    /// Puts the displacement and the coefficients of the velocity in their place.
    pub(super) fn give_motion(&self, motion: &mut DisplacementSeries) {
        let lane = self.lane % LANES;
        motion.set(|k| self.motion[k][lane]);
    }

    /// The same of a contact that slips.
    pub(super) fn give_slip(&self, speeds: &mut PowerSeries, friction: &mut PowerSeries) {
        let lane = self.lane % LANES;
        for k in 0..TERMS {
            speeds[k] = self.group.speeds[k][lane];
            friction[k] = self.group.friction[k][lane];
        }
    }

    /// The same of its memory, from order 1 on.
    pub(super) fn give_memory(&self, memories: &mut [PowerSeries]) {
        let lane = self.lane % LANES;
        let chunk = &self.group.chunks[self.group.chunk_of[lane]];
        for (j, memory) in memories.iter_mut().enumerate() {
            let input = chunk.input(j);
            for k in 1..TERMS {
                memory[k] = input[k][lane];
            }
        }
    }

    /// The same of the force in a contact, from order 1 on.
    pub(super) fn give_carried(&self, carried: &mut PowerSeries) {
        let lane = self.lane % LANES;
        for k in 1..TERMS {
            carried[k] = self.group.carried[k][lane];
        }
    }
}

/// The diagonal of each group's rows of a matrix, and the columns beside it.
fn rows_of(matrix: &Sparse) -> Vec<(Lanes, Vec<(Slot, Lanes)>)> {
    let rows: Vec<_> = matrix.rows().collect();
    // Where the column of a coordinate is in the group under way.
    let mut places = vec![usize::MAX; rows.len()];
    let groups = rows.chunks(LANES).map(|rows| {
        let mut diagonal = [0.0; LANES];
        let mut columns: Vec<(Slot, Lanes)> = Vec::new();
        for (lane, &(own, beside)) in rows.iter().enumerate() {
            diagonal[lane] = own;
            for &(j, a) in beside {
                if places[j] == usize::MAX {
                    places[j] = columns.len();
                    columns.push((Slot::of(j), [0.0; LANES]));
                }
                columns[places[j]].1[lane] = a;
            }
        }
        for &(j, _) in rows.iter().flat_map(|&(_, beside)| beside) {
            places[j] = usize::MAX;
        }
        (diagonal, columns)
    });
    groups.collect()
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

    /// Where the waves of so many orders begin.
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

/// The list of orders in `all_orders` is written out.
const _: () = assert!(ALL == 26);

impl GroupSeries {
    #[inline(always)]
    fn all_orders<const CHOSEN: bool, const MEMORY: bool>(&mut self, rows: &[Rows], shift: usize) {
        let waves = Waves::new(rows.len(), AT_A_TIME, shift);
        macro_rules! each {
            ($start:ident, $($order:literal)*) => {$(
                for g in waves.places($start, $order - 1) {
                    self.order::<$order, CHOSEN, MEMORY>(&rows[g], g);
                }
            )*};
        }
        for start in waves.starts(ALL - 1) {
            each!(start, 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22 23 24 25);
        }
    }

    /// Order K > 0 of what accelerates a group, and K + 1 of its velocities.
    #[inline(always)]
    fn order<const K: usize, const CHOSEN: bool, const MEMORY: bool>(
        &mut self,
        rows: &Rows,
        g: usize,
    ) {
        let own = &self.motions[g];
        let mut springs = times(rows.diagonal[0], own[K]);
        let mut dampers = times(rows.diagonal[1], own[K + 1]);
        for &(Slot { group, lane }, entries) in &rows.beside[0] {
            let displacement = self.motions[group][K][lane];
            springs = mul_add::<CHOSEN>([displacement; LANES], entries, springs);
        }
        for &(Slot { group, lane }, entries) in &rows.beside[1] {
            let velocity = self.motions[group][K + 1][lane];
            dampers = mul_add::<CHOSEN>([velocity; LANES], entries, dampers);
        }
        // Number k of a displacement is k q_k.
        let pull = mul_add::<CHOSEN>([INTEGRAL[K - 1]; LANES], springs, dampers);
        let group = &mut self.groups[g];
        let mut friction = [0.0; LANES];
        for chunk in &mut group.chunks[..group.used] {
            let mut is_relaxed = false;
            friction = loop {
                let sum = chunk.order::<K, CHOSEN, MEMORY>(group.speeds[K], friction);
                if !MEMORY || memory_order(chunk, K, &group.relaxation, &mut is_relaxed) {
                    break sum;
                }
            };
        }
        let minus = [-1.0; LANES];
        let mut rate = times(minus, pull);
        if group.is_driven {
            rate = plus(rate, group.given[K]);
        }
        group.carried[K] = rate;
        group.friction[K] = friction;
        let braked = times(minus, times(group.load, friction));
        let speed = mul_add::<CHOSEN>(group.side, rate, braked);
        let speed = times([INTEGRAL[K]; LANES], speed);
        group.speeds[K + 1] = speed;
        let mut velocity = times(group.side, speed);
        if group.is_driven {
            velocity = plus(velocity, group.surface[K + 1]);
        }
        self.motions[g][K + 2] = velocity;
    }
}

/// After order k of the laws of a chunk, sets coefficient k + 1 of their memories. On a slow
/// manifold it first corrects coefficient k, once; then it returns false: the order has to be
/// computed again.
#[inline(never)]
fn memory_order(chunk: &mut Chunk, k: usize, relaxation: &Lanes, is_relaxed: &mut bool) -> bool {
    let is_last = std::mem::replace(is_relaxed, true) || *relaxation == [0.0; LANES];
    for j in 0..chunk.inputs() {
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
