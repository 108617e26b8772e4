//! The series of coordinates in groups of four, side by side in the lanes of vector registers. For
//! steps in which every coordinate is held, is free, or slips on a contact of its own, under a
//! constant load and by a law without memory.
//!
//! The laws are recorded at the start of the step: see `scalar/recorded.rs`. All coordinates of a
//! group follow one equation, without a branch:
//!
//! ```text
//! a_k = (M⁻¹f − M⁻¹K q − M⁻¹C v − w')_k,   y_{k+1} = (σ a_k − N m_k)/(k + 1),
//! v_{k+1} = σ y_{k+1} + w_{k+1}
//! ```
//!
//! with σ = 0 for those that are held, and σ = 1, N = 0, w = 0 for those that are free.

use super::expand::{ALL, in_waves};
use super::model::Model;
use super::series::{ContactCourse, ContactSeries, Series};
use crate::friction::memory::Slip;
use crate::friction::memory::object::LawObject;
use crate::scalar::fused;
use crate::scalar::lanes::{Chunk, LANES, Lanes, mul_add, plus, times};
use crate::scalar::recorded::Recorder;
use crate::series::{INTEGRAL, PowerSeries, TERMS};

/// Number of groups of a long chain that are expanded to the last order before the next are begun:
/// see [`expand`](super::expand::expand).
const AT_A_TIME: usize = 4;

/// All groups.
#[derive(Debug, Clone)]
pub(super) struct Groups {
    rows: Vec<Rows>,
    series: GroupSeries,
    recorder: Recorder,
}

/// The rows of M⁻¹K and M⁻¹C of a group.
#[derive(Debug, Clone)]
struct Rows {
    diagonal: [Lanes; 2],
    /// The columns beside the diagonal that are not 0: where they are, and their entries.
    beside: [Vec<(Place, Lanes)>; 2],
}

/// Group and lane of a coordinate.
#[derive(Debug, Clone, Copy)]
struct Place {
    group: usize,
    lane: usize,
}

impl Place {
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
    /// The displacements, then the coefficients of the velocities, as in
    /// [`DisplacementSeries`](super::series::DisplacementSeries).
    courses: Vec<[Lanes; TERMS + 1]>,
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
    /// The laws: one chunk for those with the same operations, and how many are in use.
    chunks: Vec<Chunk>,
    used: usize,
}

impl Groups {
    pub(super) fn new(model: &Model<'_>) -> Self {
        let n = model.len();
        let count = n.div_ceil(LANES);
        let zero = [0.0; LANES];
        let mut rows = vec![
            Rows {
                diagonal: [zero; 2],
                beside: [Vec::new(), Vec::new()],
            };
            count
        ];
        for (kind, matrix) in [&model.stiffness, &model.damping].into_iter().enumerate() {
            for (i, (diagonal, beside)) in matrix.rows().enumerate() {
                let Place { group, lane } = Place::of(i);
                let rows = &mut rows[group];
                rows.diagonal[kind][lane] = diagonal;
                for &(j, a) in beside {
                    let columns = &mut rows.beside[kind];
                    let column = Place::of(j);
                    let is_same = |(place, _): &&mut (Place, Lanes)| {
                        (place.group, place.lane) == (column.group, column.lane)
                    };
                    match columns.iter_mut().find(is_same) {
                        Some((_, entries)) => entries[lane] = a,
                        None => {
                            let mut entries = zero;
                            entries[lane] = a;
                            columns.push((column, entries));
                        }
                    }
                }
            }
        }
        let group = Group {
            side: zero,
            load: zero,
            speeds: [zero; TERMS],
            friction: [zero; TERMS],
            carried: [zero; TERMS],
            is_driven: false,
            given: [zero; TERMS],
            surface: [zero; TERMS],
            chunks: Vec::new(),
            used: 0,
        };
        Self {
            rows,
            series: GroupSeries {
                courses: vec![[zero; TERMS + 1]; count],
                groups: vec![group; count],
            },
            recorder: Recorder::default(),
        }
    }
}

/// All orders after the first.
pub(super) fn expand_groups(model: &Model<'_>, series: &mut Series) {
    let Series {
        coordinates,
        contacts,
        groups,
        ..
    } = series;
    for group in &mut groups.series.groups {
        (group.side, group.load, group.used) = ([0.0; LANES], [0.0; LANES], 0);
        group.is_driven = false;
    }
    for (i, coordinate) in coordinates.iter().enumerate() {
        let Place { group, lane } = Place::of(i);
        let numbers = &mut groups.series.courses[group];
        numbers[0][lane] = coordinate.course.displacement(0);
        numbers[1][lane] = coordinate.course.velocity(0);
        numbers[2][lane] = coordinate.course.velocity(1);
        let group = &mut groups.series.groups[group];
        match model.owner[i] {
            Some(c) if contacts[c].course == ContactCourse::Slip => {
                let law = model.contacts[c].law;
                group.begin(lane, &contacts[c], law, &mut groups.recorder);
            }
            Some(_) => {}
            None => group.side[lane] = 1.0,
        }
        if model.is_driven[i] {
            let surface = model.owner[i].map(|c| &contacts[c].surface);
            group.drive(lane, &coordinate.force, surface);
        }
    }
    let shift = model.bandwidth.div_ceil(LANES);
    fused::compute(
        &groups.rows,
        &mut (&mut groups.series, shift),
        #[inline(always)]
        |rows, (series, shift)| series.all_orders::<true>(rows, *shift),
        |rows, (series, shift)| series.all_orders::<false>(rows, *shift),
    );
    for (i, coordinate) in coordinates.iter_mut().enumerate() {
        let Place { group, lane } = Place::of(i);
        let numbers = &groups.series.courses[group];
        let group = &groups.series.groups[group];
        if let Some(c) = model.owner[i] {
            let of = &mut contacts[c];
            for k in 1..ALL {
                of.carried[k] = group.carried[k][lane];
                of.speeds[k + 1] = group.speeds[k + 1][lane];
            }
            if of.course == ContactCourse::Slip {
                for k in 1..ALL {
                    of.friction[k] = group.friction[k][lane];
                }
            }
        }
        for k in 2..=ALL {
            coordinate.course.set_velocity(k, numbers[k + 1][lane]);
        }
    }
}

impl Group {
    /// Takes a contact that slips into a lane.
    fn begin(
        &mut self,
        lane: usize,
        of: &ContactSeries,
        law: &dyn LawObject,
        recorder: &mut Recorder,
    ) {
        (self.side[lane], self.load[lane]) = (of.side, of.load[0]);
        self.speeds[1][lane] = of.speeds[1];
        let slip = Slip {
            speed: of.speeds[0],
            direction: of.side,
            piece: of.piece,
        };
        let output = law.record(recorder, slip);
        let mut open = self.chunks[..self.used].iter_mut();
        if open.any(|chunk| chunk.take(lane, recorder, output)) {
            return;
        }
        if self.used == self.chunks.len() {
            self.chunks.push(Chunk::new());
        }
        self.chunks[self.used].begin(lane, recorder, output);
        self.used += 1;
    }
}

impl Group {
    /// Takes a force that varies, and the velocity of the surface, into a lane.
    fn drive(&mut self, lane: usize, force: &PowerSeries, surface: Option<&PowerSeries>) {
        if !self.is_driven {
            (self.given, self.surface) = ([[0.0; LANES]; TERMS], [[0.0; LANES]; TERMS]);
            self.is_driven = true;
        }
        for k in 1..ALL {
            let next = surface.map_or(0.0, |surface| surface[k + 1]);
            self.given[k][lane] = force[k] - (k + 1) as f64 * next;
            self.surface[k + 1][lane] = next;
        }
    }
}

impl GroupSeries {
    #[inline(always)]
    fn all_orders<const CHOSEN: bool>(&mut self, rows: &[Rows], shift: usize) {
        in_waves(
            [rows.len(), AT_A_TIME, shift],
            1..ALL,
            #[inline(always)]
            |groups, k| {
                for g in groups {
                    self.order::<CHOSEN>(&rows[g], g, k);
                }
            },
        );
    }

    /// Order k > 0 of what accelerates a group, and k + 1 of its velocities.
    #[inline(always)]
    fn order<const CHOSEN: bool>(&mut self, rows: &Rows, g: usize, k: usize) {
        let own = &self.courses[g];
        let mut springs = times(rows.diagonal[0], own[k]);
        let mut dampers = times(rows.diagonal[1], own[k + 1]);
        for &(Place { group, lane }, entries) in &rows.beside[0] {
            let displacement = self.courses[group][k][lane];
            springs = mul_add::<CHOSEN>([displacement; LANES], entries, springs);
        }
        for &(Place { group, lane }, entries) in &rows.beside[1] {
            let velocity = self.courses[group][k + 1][lane];
            dampers = mul_add::<CHOSEN>([velocity; LANES], entries, dampers);
        }
        // Number k of a displacement is k q_k.
        let pull = mul_add::<CHOSEN>([INTEGRAL[k - 1]; LANES], springs, dampers);
        let group = &mut self.groups[g];
        let mut friction = [0.0; LANES];
        for chunk in &mut group.chunks[..group.used] {
            friction = chunk.order::<CHOSEN>(k, group.speeds[k], friction);
        }
        let minus = [-1.0; LANES];
        let mut rate = times(minus, pull);
        if group.is_driven {
            rate = plus(rate, group.given[k]);
        }
        group.carried[k] = rate;
        group.friction[k] = friction;
        let braked = times(minus, times(group.load, friction));
        let speed = mul_add::<CHOSEN>(group.side, rate, braked);
        let speed = times([INTEGRAL[k]; LANES], speed);
        group.speeds[k + 1] = speed;
        let mut velocity = times(group.side, speed);
        if group.is_driven {
            velocity = plus(velocity, group.surface[k + 1]);
        }
        self.courses[g][k + 2] = velocity;
    }
}

#[cfg(test)]
mod tests;
