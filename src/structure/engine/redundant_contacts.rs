//! Contacts at rest whose directions depend on each other, such as two brakes and a clutch in a
//! ring: how they can begin to slip.
//!
//! The base is a set of independent contacts that hold all others; their forces λ follow from the
//! motion. A rider is another contact, with b_d = Σ α_dc b_c and the force 0. What each of them
//! carries is not determined, but when they slip is. A mechanism is a motion s_c = b_c·y in which
//! as few contacts as possible slip, and the contacts stay at rest as long as
//!
//! ```text
//! Σ_c B_c |s_c| ∓ Σ_c λ_c s_c ≥ 0        for each mechanism: friction's power against that of λ
//! ```
//!
//! This is the kinematic theorem of limit analysis. If a distance reaches 0, exactly the contacts
//! of its mechanism slip, in the directions of s. A contact on which no rider depends is a
//! mechanism by itself: the distances are those from the edges of its band.

use nalgebra::{DMatrix, DVector};

use super::cholesky::{Holding, ROUNDING};
use super::least_norm_shares::least_norm_shares;
use super::model::Model;
use super::series::Series;
use super::stick_band_edge::{Edge, deciding};
use crate::series::{PowerSeries, TERMS};
use crate::state::Direction;

/// Shared contacts at rest.
#[derive(Debug, Clone, Default)]
pub(crate) struct Resting {
    pub(crate) holding: Holding,
    pub(super) groups: Vec<Group>,
}

/// Contacts that depend on each other.
#[derive(Debug, Clone)]
pub(super) struct Group {
    /// The contacts of the group, those of the base first.
    pub(super) contacts: Vec<usize>,
    /// s of each contact, by rows, from s of the base; in units of √G_cc.
    rows: DMatrix<f64>,
}

/// A motion of contacts at rest that is possible, and in which as few as possible slip.
#[derive(Debug, Clone)]
pub(super) struct Mechanism {
    /// s_c/√G_cc of the contacts that slip.
    pub(super) parts: Vec<(usize, f64)>,
    /// The bound of Σ λ_c s_c at which it is.
    pub(super) edge: Edge,
}

/// The largest number of sets of contacts of a group that are tried.
pub(super) const MOST_SUBSETS: usize = 10_000;

/// A group with too many mechanisms: its contacts, and the number of sets to try.
#[derive(Debug)]
pub(super) struct TooMany {
    pub(super) contacts: Vec<usize>,
    pub(super) subsets: usize,
}

impl Model<'_> {
    /// The base and the riders of shared contacts at rest, given in the order of
    /// [`shared`](Self::shared). Contacts that slip in one direction only are riders of each other
    /// only.
    pub(crate) fn resting(&self, mut contacts: Vec<usize>) -> Resting {
        let holding = match self.factor(&contacts) {
            Ok(factor) => return Resting::independent(Holding { contacts, factor }),
            Err(_) => {
                contacts.sort_by_key(|&c| !self.contacts[c].is_one_way());
                self.independent(contacts.clone(), &|_| 0.0)
            }
        };
        let mut set = holding.contacts.iter().peekable();
        let is_rider = |c: &usize| set.next_if_eq(&c).is_none();
        let riders: Vec<usize> = contacts.into_iter().filter(is_rider).collect();
        let root = |c: usize| self.contacts[c].compliance.sqrt();
        let parts = |&c: &usize| {
            let parts = self.parts(c, &holding).0.into_iter();
            let scaled = parts.filter(|(_, part)| *part != 0.0);
            (
                c,
                scaled
                    .map(|(d, part)| (d, part * root(d) / root(c)))
                    .collect(),
            )
        };
        let groups = groups_of(riders.iter().map(parts).collect());
        Resting { holding, groups }
    }
}

/// Riders with the contacts of the base on which they depend, directly or through each other.
fn groups_of(riders: Vec<(usize, Vec<(usize, f64)>)>) -> Vec<Group> {
    type Rider = (usize, Vec<(usize, f64)>);
    let mut groups: Vec<(Vec<usize>, Vec<Rider>)> = Vec::new();
    for rider in riders {
        let mut base: Vec<usize> = rider.1.iter().map(|&(c, _)| c).collect();
        let mut members = vec![rider];
        groups.retain_mut(|(others, of_group)| {
            let is_apart = others.iter().all(|c| !base.contains(c));
            if !is_apart {
                base.append(others);
                members.append(of_group);
            }
            is_apart
        });
        base.sort_unstable();
        base.dedup();
        groups.push((base, members));
    }
    let group = |(base, mut riders): (Vec<usize>, Vec<Rider>)| {
        riders.sort_unstable_by_key(|&(c, _)| c);
        let mut rows = DMatrix::identity(base.len() + riders.len(), base.len());
        for (i, (_, parts)) in riders.iter().enumerate() {
            for (j, c) in base.iter().enumerate() {
                let part = parts.iter().find(|(d, _)| d == c);
                rows[(base.len() + i, j)] = part.map_or(0.0, |&(_, part)| part);
            }
        }
        let contacts = base.into_iter().chain(riders.into_iter().map(|(c, _)| c));
        Group {
            contacts: contacts.collect(),
            rows,
        }
    };
    groups.into_iter().map(group).collect()
}

impl Resting {
    fn independent(holding: Holding) -> Self {
        Self {
            holding,
            groups: Vec::new(),
        }
    }

    /// Returns all mechanisms of groups.
    pub(super) fn mechanisms(&self) -> Result<Vec<Mechanism>, TooMany> {
        let mut all = Vec::new();
        for group in &self.groups {
            all.extend(group.mechanisms()?);
        }
        Ok(all)
    }

    /// Possible forces of the contacts of groups, from the forces of the base and the bounds, with
    /// the number of each contact, in the units of the base. Of all possible forces, those with the
    /// least Σ (λ_c/B_c)² are returned.
    pub(crate) fn shares(
        &self,
        force: impl Fn(usize) -> f64,
        bounds: impl Fn(usize) -> [f64; 2],
    ) -> Vec<(usize, f64)> {
        let groups = self.groups.iter();
        let shares = groups.flat_map(|group| {
            let base = group.contacts.iter().take(group.rows.ncols());
            let forces = DVector::from_iterator(group.rows.ncols(), base.map(|&c| force(c)));
            let bounds: Vec<[f64; 2]> = group.contacts.iter().map(|&c| bounds(c)).collect();
            std::iter::zip(
                group.contacts.iter().copied(),
                least_norm_shares(&group.rows, &forces, &bounds),
            )
        });
        shares.collect()
    }
}

impl Group {
    pub(super) fn has(&self, contact: usize) -> bool {
        self.contacts.contains(&contact)
    }

    pub(super) fn riders(&self) -> &[usize] {
        &self.contacts[self.rows.ncols()..]
    }

    fn mechanisms(&self) -> Result<Vec<Mechanism>, TooMany> {
        let (count, rank) = self.rows.shape();
        let subsets = (1..rank).fold(1.0, |number, k| number * (count + 1 - k) as f64 / k as f64);
        if subsets > MOST_SUBSETS as f64 {
            return Err(TooMany {
                contacts: self.contacts.clone(),
                subsets: subsets as usize,
            });
        }
        let mut found: Vec<(Vec<bool>, Mechanism)> = Vec::new();
        let mut held: Vec<usize> = (0..rank - 1).collect();
        loop {
            if let Some(x) = null_vector(&self.rows.select_rows(&held)) {
                let parts = (0..count).map(|row| self.slip(row, &x));
                let parts: Vec<f64> = parts.collect();
                let support: Vec<bool> = parts.iter().map(|part| *part != 0.0).collect();
                if found.iter().all(|(other, _)| *other != support) {
                    let parts = std::iter::zip(self.contacts.iter().copied(), parts);
                    let parts = parts.filter(|(_, part)| *part != 0.0).collect();
                    let edge = Edge::Away;
                    found.push((support, Mechanism { parts, edge }));
                }
            }
            // The next set of rows.
            let Some(i) = (0..held.len()).rfind(|&i| held[i] < count - held.len() + i) else {
                return Ok(found.into_iter().map(|(_, mechanism)| mechanism).collect());
            };
            held[i] += 1;
            for j in i + 1..held.len() {
                held[j] = held[j - 1] + 1;
            }
        }
    }

    /// s of a contact in a motion of the base; 0 if it is rounding.
    fn slip(&self, row: usize, x: &DVector<f64>) -> f64 {
        let terms = || self.rows.row(row).into_owned().transpose().component_mul(x);
        let (sum, size) = (terms().sum(), terms().abs().sum());
        if sum.abs() <= 2.0 * ROUNDING * size {
            0.0
        } else {
            sum
        }
    }
}

/// The vector normal to all rows of a matrix with one column more than rows, with a largest entry
/// of 1; `None` if the rows are dependent.
fn null_vector(rows: &DMatrix<f64>) -> Option<DVector<f64>> {
    let mut left = rows.clone();
    let (count, columns) = left.shape();
    let mut pivots: Vec<usize> = Vec::new();
    for i in 0..count {
        let entries = (i..count).flat_map(|row| (0..columns).map(move |j| (row, j)));
        let free = entries.filter(|(_, j)| !pivots.contains(j));
        let size = |&place: &(usize, usize)| f64::abs(left[place]);
        let (row, j) = free.max_by(|a, b| size(a).total_cmp(&size(b)))?;
        if size(&(row, j)).partial_cmp(&(64.0 * f64::EPSILON)) != Some(std::cmp::Ordering::Greater)
        {
            return None;
        }
        left.swap_rows(i, row);
        let own = left.row(i) / left[(i, j)];
        for other in (0..count).filter(|&other| other != i) {
            let part = left[(other, j)];
            if part != 0.0 {
                let mut row = left.row_mut(other);
                for (entry, own) in row.iter_mut().zip(&own) {
                    let size = entry.abs() + (part * own).abs();
                    *entry -= part * own;
                    if entry.abs() <= ROUNDING * size {
                        *entry = 0.0;
                    }
                }
            }
        }
        left.set_row(i, &own);
        pivots.push(j);
    }
    let free = (0..columns).find(|j| !pivots.contains(j))?;
    let mut x = DVector::zeros(columns);
    x[free] = 1.0;
    for (i, &j) in pivots.iter().enumerate() {
        x[j] = -left[(i, free)];
    }
    let largest = x.amax();
    Some(x / largest)
}

impl Mechanism {
    /// Σ B_c |s_c| ∓ Σ λ_c s_c, with the zeros that are known; its first coefficient is infinite if
    /// a bound is.
    pub(super) fn distance(
        &self,
        model: &Model<'_>,
        series: &Series,
        side: Direction,
    ) -> PowerSeries {
        let mut distance = PowerSeries::ZERO;
        for &(c, part) in &self.parts {
            let (of, part) = (
                &series.contacts[c],
                part / model.contacts[c].compliance.sqrt(),
            );
            distance.add(part.abs(), of.bound(Self::slips(part, side)));
            distance.add(-side.sign() * part, &of.carried);
        }
        self.edge.with_zeros(distance, side)
    }

    /// Bound of the rounding error of coefficient k of a distance.
    fn rounding(&self, model: &Model<'_>, series: &Series, side: Direction, k: usize) -> f64 {
        let parts = self.parts.iter().map(|&(c, part)| {
            let root = model.contacts[c].compliance.sqrt();
            part.abs() / root * series.contacts[c].rounding(Self::slips(part, side), k)
        });
        parts.sum()
    }

    /// Order and value of the coefficient of a distance from its bound that decides; see
    /// [`deciding`].
    pub(super) fn deciding_distance(
        &self,
        model: &Model<'_>,
        series: &Series,
        side: Direction,
    ) -> Option<(usize, f64)> {
        let distance = self.distance(model, series, side);
        let distance = PowerSeries::from_fn(|k| {
            let is_rounding = k == 0 || distance[k].abs() <= self.rounding(model, series, side, k);
            if is_rounding { 0.0 } else { distance[k] }
        });
        deciding(&distance, self.bound(model, series, side))
    }

    /// Returns true if the mechanism stays on its bound up to a time t after the start of the step,
    /// within rounding.
    pub(super) fn stays_along(&self, model: &Model<'_>, series: &Series, t: f64) -> bool {
        let Edge::Along(side) = self.edge else {
            return false;
        };
        let free = Self {
            parts: self.parts.clone(),
            edge: Edge::Away,
        };
        let rounding = PowerSeries::from_fn(|k| self.rounding(model, series, side, k)).at(t);
        free.distance(model, series, side).at(t).abs() <= rounding
    }

    /// Σ B_c |s_c| at the start of the step.
    pub(super) fn bound(&self, model: &Model<'_>, series: &Series, side: Direction) -> f64 {
        let parts = self.parts.iter().map(|&(c, part)| {
            let root = model.contacts[c].compliance.sqrt();
            part.abs() / root * series.contacts[c].bound(Self::slips(part, side))[0]
        });
        parts.sum()
    }

    /// The direction in which a contact slips, if the mechanism moves to a side.
    pub(super) fn slips(part: f64, side: Direction) -> Direction {
        if part < 0.0 { side.opposite() } else { side }
    }

    /// The parts with which it is the trigger of an event: h = Σ w_c λ_c − Σ |w_c| N μ_s.
    pub(super) fn weights(&self, model: &Model<'_>, side: Direction) -> Vec<(usize, f64)> {
        let parts = self.parts.iter().map(|&(c, part)| {
            let root = model.contacts[c].compliance.sqrt();
            (c, side.sign() * part / root)
        });
        parts.collect()
    }

    /// The least and the largest force of each of its contacts, in units of √G_cc, if Σ λ_c s_c and
    /// the bounds of the other contacts are given.
    pub(super) fn ranges(
        &self,
        force: impl Fn(usize) -> f64,
        bounds: impl Fn(usize) -> [f64; 2],
    ) -> impl Iterator<Item = (usize, [f64; 2])> {
        let power: f64 = self.parts.iter().map(|&(c, part)| part * force(c)).sum();
        self.parts.iter().map(move |&(c, part)| {
            // What the others carry at most, if they and this one slip to a side.
            let others = |side: Direction| {
                let others = self.parts.iter().filter(|&&(d, _)| d != c);
                let carried = others.map(|&(d, other)| {
                    let side = Self::slips(other * part.signum(), side);
                    other.abs() * bounds(d)[side.place()]
                });
                carried.sum::<f64>() / part.abs()
            };
            let center = power / part;
            let [below, above] = [Direction::Leading, Direction::Lagging].map(others);
            (c, [center - below, center + above])
        })
    }
}

/// The first coefficient of the velocity of a contact's surface, relative to those at rest on which
/// it depends, that is not 0; `None` if it moves with them up to the next break of a drive, or does
/// not depend on them.
pub(super) fn disagreement(
    model: &Model<'_>,
    series: &Series,
    contact: usize,
    holding: &Holding,
) -> Option<f64> {
    const AGREES: f64 = 4.0 * f64::EPSILON;
    let others = holding.contacts.iter().copied();
    let all: Vec<usize> = others.chain([contact]).collect();
    if model.factor(&all).is_ok() {
        return None;
    }
    let (parts, _) = model.parts(contact, holding);
    (1..TERMS).find_map(|k| {
        let own = series.contacts[contact].surface[k];
        let (sum, size) = parts
            .iter()
            .fold((own, own.abs()), |(sum, size), &(c, part)| {
                let term = part * series.contacts[c].surface[k];
                (sum - term, size + term.abs())
            });
        (sum.abs() > AGREES * size).then_some(sum)
    })
}
