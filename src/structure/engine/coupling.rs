//! The coupling G = B M⁻¹Bᵀ of sticking contacts that share coordinates: contacts with independent
//! directions, and the constraint forces in them.

use nalgebra::DMatrix;

use super::cholesky::{Factor, Holding, Pivot, ROUNDING};
use super::contact_data::{Entries, Site, entry};
use super::element_data::sum_of_sizes;
use super::model::Model;

impl Model<'_> {
    /// Sets the velocities at a time so that these contacts are at rest. For contacts that share
    /// coordinates, the change has the least kinetic energy.
    pub(crate) fn put_at_rest(
        &self,
        velocities: &mut [f64],
        time: f64,
        rests: &dyn Fn(usize) -> bool,
    ) {
        for (c, contact) in self.contacts.iter().enumerate() {
            if let (Site::Own(i), true) = (&contact.site, rests(c)) {
                velocities[*i] = contact.belt_velocity.value(time);
            }
        }
        let holding = self.holding(rests);
        let relative = |c: usize| {
            let contact = &self.contacts[c];
            contact.along(|j| velocities[j]) - contact.belt_velocity.value(time)
        };
        for (j, correction) in self.corrections(&holding, &relative) {
            velocities[j] -= correction;
        }
        // To the bit: what rounding leaves would be a slip.
        let surface = |c: usize| self.contacts[c].belt_velocity.value(time);
        for pivot in self.pivots(&holding.contacts) {
            velocities[pivot.coordinate] = pivot.velocity(surface, |j| velocities[j]);
        }
    }

    /// The constraints of the shared contacts that stick, one for each independent direction.
    pub(crate) fn holding(&self, sticks: &dyn Fn(usize) -> bool) -> Holding {
        let shared = self.shared.iter().copied();
        self.independent(shared.filter(|&c| sticks(c)).collect(), &|_| 0.0)
    }

    /// The least change of the coordinates, in the norm of M, that sets the relative motion `apart`
    /// of these contacts to 0.
    pub(crate) fn corrections(
        &self,
        holding: &Holding,
        apart: &dyn Fn(usize) -> f64,
    ) -> Vec<(usize, f64)> {
        let Holding { contacts, factor } = holding;
        let root = |c: usize| self.contacts[c].compliance.sqrt();
        let mut parts: Vec<f64> = contacts.iter().map(|&c| apart(c) / root(c)).collect();
        factor.solve(&mut parts);
        let responses = std::iter::zip(contacts, parts).flat_map(|(&c, part)| {
            let responses = self.contacts[c].responses().iter();
            responses.map(move |&(j, x)| (j, x * part * root(c)))
        });
        responses.collect()
    }

    /// The largest set of these shared contacts whose directions are independent, with its factor.
    /// `softness` is an additional compliance of each contact, relative to its own compliance.
    pub(crate) fn independent(
        &self,
        mut contacts: Vec<usize>,
        softness: &dyn Fn(usize) -> f64,
    ) -> Holding {
        loop {
            match self.giving_factor(&contacts, softness) {
                Ok(factor) => return Holding { contacts, factor },
                Err(place) => {
                    contacts.remove(place);
                }
            }
        }
    }

    /// α, by contact, with b = Σ α_c b_c over the contacts of a holding, if the direction b of this
    /// one depends on theirs.
    ///
    /// That is judged by the directions themselves: G would not tell a direction from one at an
    /// angle of √ε to it.
    pub(super) fn dependence(&self, c: usize, holding: &Holding) -> Option<Vec<(usize, f64)>> {
        let (parts, depends) = self.parts(c, holding);
        depends.then_some(parts)
    }

    /// α with x = Σ α_c b_c over the contacts of a holding, for the part x of a vector on the
    /// coordinates without a contact of their own, if it depends on their directions.
    pub(super) fn guiding(&self, vector: &Entries, holding: &Holding) -> Option<Vec<(usize, f64)>> {
        let shared = vector.iter().filter(|(j, _)| self.owner[*j].is_none());
        let shared: Vec<(usize, f64)> = shared.copied().collect();
        if shared.is_empty() || holding.contacts.is_empty() {
            return None;
        }
        let size = sum_of_sizes(&shared, &|j| self.mobility[j]);
        let (parts, depends) = self.parts_of((&shared, size), holding);
        depends.then_some(parts)
    }

    /// The α of the combination that comes nearest to b, and whether it is b.
    pub(super) fn parts(&self, c: usize, holding: &Holding) -> (Vec<(usize, f64)>, bool) {
        let contact = &self.contacts[c];
        self.parts_of((&contact.direction, contact.compliance.sqrt()), holding)
    }

    /// The α of the combination that comes nearest to a vector of this size, and whether it is it.
    fn parts_of(
        &self,
        (vector, size): (&Entries, f64),
        holding: &Holding,
    ) -> (Vec<(usize, f64)>, bool) {
        let Holding { contacts, factor } = holding;
        let directions = contacts.iter().map(|&c| &self.contacts[c].direction[..]);
        let along = directions.chain([vector]).flatten().map(|&(j, _)| j);
        let mut coordinates: Vec<usize> = along.collect();
        coordinates.sort_unstable();
        coordinates.dedup();
        let mut parts = vec![0.0; contacts.len()];
        // The first solution, and corrections of its rounding errors.
        for _ in 0..3 {
            let rest = self.remainder(vector, contacts, &parts, &coordinates);
            let pull = |&c: &usize| {
                let product = |&(j, x): &(usize, f64)| {
                    let place = coordinates.binary_search(&j);
                    place.map_or(0.0, |place| x * rest[place].0)
                };
                let sum: f64 = self.contacts[c].responses().iter().map(product).sum();
                sum * self.contacts[c].compliance.sqrt()
            };
            let mut correction: Vec<f64> = contacts.iter().map(pull).collect();
            factor.solve(&mut correction);
            for ((part, correction), &other) in parts.iter_mut().zip(correction).zip(contacts) {
                let root = self.contacts[other].compliance.sqrt();
                *part += correction / root;
                // A part that is all rounding would leave remainders as large as its terms.
                if part.abs() * root <= ROUNDING * size {
                    *part = 0.0;
                }
            }
        }
        let rest = self.remainder(vector, contacts, &parts, &coordinates);
        let depends = rest
            .iter()
            .all(|(rest, size)| rest.abs() <= ROUNDING * size);
        let parts = std::iter::zip(contacts.iter().copied(), parts);
        (parts.collect(), depends)
    }

    /// x − Σ α_c b_c, and the sum of the sizes of its terms, for each of these coordinates.
    fn remainder(
        &self,
        vector: &Entries,
        contacts: &[usize],
        parts: &[f64],
        coordinates: &[usize],
    ) -> Vec<(f64, f64)> {
        let mut remainder = vec![(0.0, 0.0); coordinates.len()];
        let direction = |(&c, part): (&usize, &f64)| (&self.contacts[c].direction[..], -part);
        let others = std::iter::zip(contacts, parts).map(direction);
        for (direction, part) in std::iter::once((vector, 1.0)).chain(others) {
            for (j, b) in direction {
                if let Ok(place) = coordinates.binary_search(j) {
                    let (rest, size) = &mut remainder[place];
                    *rest += part * b;
                    *size += (part * b).abs();
                }
            }
        }
        remainder
    }

    /// Finds a coordinate for each of some contacts at rest with independent directions. Taken in
    /// this order, the velocities of the surfaces determine the velocities of these coordinates,
    /// for any velocities of the other coordinates.
    pub(super) fn pivots(&self, contacts: &[usize]) -> Vec<Pivot> {
        let mut users: Vec<Vec<usize>> = vec![Vec::new(); self.len()];
        for &c in contacts {
            for &(j, _) in self.contacts[c].direction.iter() {
                users[j].push(c);
            }
        }
        // From the ends of a chain inwards: a coordinate that belongs to one contact only is set
        // last.
        let mut alone: Vec<usize> = (0..self.len()).filter(|&j| users[j].len() == 1).collect();
        let mut pivots = Vec::new();
        let mut is_done = vec![false; self.contacts.len()];
        while let Some(j) = alone.pop() {
            let [c] = users[j][..] else { continue };
            is_done[c] = true;
            let direction = &self.contacts[c].direction;
            let others = direction.iter().copied().filter(|&(other, _)| other != j);
            pivots.push(Pivot {
                coordinate: j,
                own: entry(direction, j),
                others: others.collect(),
                surfaces: vec![(c, 1.0)],
            });
            for &(other, _) in direction.iter() {
                users[other].retain(|&user| user != c);
                if users[other].len() == 1 {
                    alone.push(other);
                }
            }
        }
        let rest: Vec<usize> = contacts.iter().copied().filter(|&c| !is_done[c]).collect();
        pivots.extend(self.eliminated(&rest));
        pivots.reverse();
        pivots
    }

    /// Pivots of contacts that have no coordinate to themselves, by Gauss-Jordan elimination, in
    /// units in which neither contacts nor coordinates count more than others.
    fn eliminated(&self, contacts: &[usize]) -> Vec<Pivot> {
        let n = self.len();
        // Beside each direction, the contacts that it is made of.
        let mut rows = DMatrix::zeros(contacts.len(), n + contacts.len());
        for (row, &c) in contacts.iter().enumerate() {
            let root = self.contacts[c].compliance.sqrt();
            for &(j, b) in self.contacts[c].direction.iter() {
                rows[(row, j)] = b * self.mobility[j] / root;
            }
            rows[(row, n + row)] = root.recip();
        }
        let mut places: Vec<(usize, usize)> = Vec::new();
        for _ in contacts {
            let is_free = |row: usize| places.iter().all(|place| place.0 != row);
            let free = (0..contacts.len()).filter(|&row| is_free(row));
            let entries = free.flat_map(|row| (0..n).map(move |j| (row, j)));
            let size = |&place: &(usize, usize)| f64::abs(rows[place]);
            let Some(place) = entries.max_by(|a, b| size(a).total_cmp(&size(b))) else {
                break;
            };
            let own = rows.row(place.0) / rows[place];
            for row in (0..contacts.len()).filter(|&row| row != place.0) {
                let part = rows[(row, place.1)];
                let mut other = rows.row_mut(row);
                other -= part * &own;
                rows[(row, place.1)] = 0.0;
            }
            rows.set_row(place.0, &own);
            places.push(place);
        }
        let pivot = |&(row, coordinate): &(usize, usize)| {
            let scale = self.mobility[coordinate];
            let others = (0..n).filter(|&j| j != coordinate && rows[(row, j)] != 0.0);
            let others = others.map(|j| (j, scale * rows[(row, j)] / self.mobility[j]));
            let made_of = |(place, &c): (usize, &usize)| (c, scale * rows[(row, n + place)]);
            Pivot {
                coordinate,
                own: 1.0,
                others: others.collect(),
                surfaces: contacts.iter().enumerate().map(made_of).collect(),
            }
        };
        places.iter().map(pivot).collect()
    }

    /// The factor of G for some of the shared contacts, in the order of [`shared`](Self::shared).
    ///
    /// # Errors
    ///
    /// The place of the first contact whose direction depends on those before it.
    pub(crate) fn factor(&self, among: &[usize]) -> Result<Factor, usize> {
        Factor::new(&mut self.couplings(among))
    }

    /// The factor of G with an additional compliance of each contact, relative to its own
    /// compliance.
    ///
    /// # Errors
    ///
    /// The errors of [`factor`](Self::factor).
    fn giving_factor(
        &self,
        among: &[usize],
        softness: &dyn Fn(usize) -> f64,
    ) -> Result<Factor, usize> {
        Factor::with_diagonal(&|i| 1.0 + softness(among[i]), &mut self.couplings(among))
    }

    /// The couplings of each of these contacts with those before it.
    fn couplings(&self, among: &[usize]) -> impl Iterator<Item = Vec<(usize, f64)>> {
        let mut places = vec![usize::MAX; self.contacts.len()];
        for (place, &c) in among.iter().enumerate() {
            places[c] = place;
        }
        among.iter().enumerate().map(move |(place, &c)| {
            let coupled = self.contacts[c].coupled().iter();
            let before = coupled.map(|&(d, g)| (places[d], g));
            before.filter(|&(other, _)| other < place).collect()
        })
    }
}
