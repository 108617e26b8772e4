//! The directions in which contacts settle that are stiff in the sliding speed.

use nalgebra::{DMatrix, Dyn, LU};

use super::cholesky::Holding;
use super::model::Model;
use crate::numerics::sort::sort_by;

/// Contacts that settle, and that determine the relative velocities of all others that settle.
#[derive(Debug, Clone, Default)]
pub(crate) struct Directions {
    /// The contacts whose directions do not depend on each other or on contacts that stick.
    pub(crate) contacts: Vec<usize>,
    /// The contacts that stick, then those of `contacts` that share coordinates.
    pub(super) holding: Holding,
    /// The velocities of all coordinates that move one of `contacts` alone, with the least kinetic
    /// energy: its relative velocity is 1.
    columns: Vec<Vec<f64>>,
}

impl Directions {
    /// The directions of the contacts that settle, which have a number here, beside those that
    /// stick. Those of the least numbers are independent, such as the slowest: a small velocity
    /// would lose its digits as a sum of large ones.
    pub(crate) fn new(
        model: &Model<'_>,
        held: &Holding,
        number: &dyn Fn(usize) -> Option<f64>,
    ) -> Self {
        let own = 0..model.contacts.len();
        let own = own.filter(|&c| number(c).is_some() && model.owner_of(c).is_some());
        let mut contacts: Vec<usize> = own.collect();
        let shared = model.shared.iter().copied();
        let mut shared: Vec<usize> = shared.filter(|&c| number(c).is_some()).collect();
        sort_by(&mut shared, |&c| number(c).unwrap_or(0.0));
        let mut holding = Holding::default();
        if !shared.is_empty() {
            let sticking = held.contacts.iter().copied();
            holding = model.independent(sticking.chain(shared.iter().copied()).collect(), &|_| 0.0);
            let chosen = shared.into_iter();
            contacts.extend(chosen.filter(|c| holding.contacts.contains(c)));
        }
        let column = |&c: &usize| {
            let mut velocities = vec![0.0; model.len()];
            match model.owner_of(c) {
                Some(i) => velocities[i] = 1.0,
                None => {
                    let apart = |d: usize| if d == c { -1.0 } else { 0.0 };
                    for (j, correction) in model.corrections(&holding, &apart) {
                        velocities[j] -= correction;
                    }
                }
            }
            velocities
        };
        Self {
            columns: contacts.iter().map(column).collect(),
            contacts,
            holding,
        }
    }

    /// The velocities that move one of the contacts alone.
    pub(crate) fn column(&self, place: usize) -> &[f64] {
        &self.columns[place]
    }

    /// A contact whose direction depends on those of `contacts` and of contacts that stick.
    pub(super) fn dependent(&self, model: &Model<'_>, contact: usize) -> Option<Dependent> {
        if self.contacts.contains(&contact) {
            let parts = vec![(contact, 1.0)];
            return Some(Dependent { contact, parts });
        }
        Dependent::on(model, &self.holding, contact)
    }

    /// The relative velocities of a contact that move `contacts` one by one: those of the others
    /// are 0 without rounding errors, because friction may be steeper by any factor in one of them.
    fn slips(&self, model: &Model<'_>, contact: usize) -> Vec<f64> {
        let Some(dependent) = self.dependent(model, contact) else {
            let slip = |velocities: &Vec<f64>| model.contacts[contact].along(|j| velocities[j]);
            return self.columns.iter().map(slip).collect();
        };
        self.contacts.iter().map(|&c| dependent.part(c)).collect()
    }

    /// The matrix D: minus the derivatives of the relative accelerations by the relative
    /// velocities. Every contact brakes its relative velocity at the rate `braking`, 0 unless it
    /// slips, beside the dampers.
    pub(crate) fn rates(
        &self,
        model: &Model<'_>,
        held: &Holding,
        braking: &dyn Fn(usize) -> f64,
    ) -> Option<LU<f64, Dyn, Dyn>> {
        self.matrix(model, held, braking).map(DMatrix::lu)
    }

    /// The matrix of [`rates`](Self::rates), if it is finite.
    pub(super) fn matrix(
        &self,
        model: &Model<'_>,
        held: &Holding,
        braking: &dyn Fn(usize) -> f64,
    ) -> Option<DMatrix<f64>> {
        let size = self.contacts.len();
        let brakes = |c: usize| Some((c, braking(c))).filter(|&(_, rate)| rate != 0.0);
        let braked = (0..model.contacts.len()).filter_map(brakes);
        let braked = braked.map(|(c, rate)| (c, rate, self.slips(model, c)));
        let braked: Vec<(usize, f64, Vec<f64>)> = braked.collect();
        let mut matrix = DMatrix::zeros(size, size);
        for (column, velocities) in self.columns.iter().enumerate() {
            let damped = (0..model.len()).map(|i| {
                let (own, beside) = model.damping.row(i);
                let others = beside.iter().map(|&(j, damping)| damping * velocities[j]);
                -(own * velocities[i] + others.sum::<f64>())
            });
            let mut accelerations: Vec<f64> = damped.collect();
            for (c, rate, slips) in &braked {
                let friction = rate * slips[column];
                for &(j, x) in model.contacts[*c].responses() {
                    accelerations[j] -= x * friction;
                }
            }
            let pull = |d: usize| model.contacts[d].along(|j| accelerations[j]);
            for (j, reaction) in model.corrections(held, &pull) {
                accelerations[j] -= reaction;
            }
            for (row, &d) in self.contacts.iter().enumerate() {
                matrix[(row, column)] = -model.contacts[d].along(|j| accelerations[j]);
            }
        }
        matrix.iter().all(|x| x.is_finite()).then_some(matrix)
    }
}

/// A contact whose direction is the sum of those of others: b = Σ α_c b_c.
#[derive(Debug, Clone)]
pub(super) struct Dependent {
    pub(super) contact: usize,
    pub(super) parts: Vec<(usize, f64)>,
}

impl Dependent {
    /// `None` if its direction does not depend on those of the contacts that are held.
    pub(super) fn on(model: &Model<'_>, holding: &Holding, contact: usize) -> Option<Self> {
        let parts = model.dependence(contact, holding)?;
        Some(Self { contact, parts })
    }

    /// α of a contact.
    pub(super) fn part(&self, contact: usize) -> f64 {
        let found = self.parts.iter().find(|&&(c, _)| c == contact);
        found.map_or(0.0, |&(_, part)| part)
    }

    /// Its relative velocity Σ α_c (r_c + w_c) − w, where those of others may be far below the
    /// velocities of the surfaces.
    pub(super) fn relative(
        &self,
        relative: impl Fn(usize) -> f64,
        surface: impl Fn(usize) -> f64,
    ) -> f64 {
        let start = [0.0, -surface(self.contact)];
        let parts = self.parts.iter();
        let [slip, carried] = parts.fold(start, |[slip, carried], &(c, part)| {
            [slip + part * relative(c), carried + part * surface(c)]
        });
        slip + carried
    }
}
