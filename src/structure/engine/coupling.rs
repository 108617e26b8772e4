//! The coupling G = B M⁻¹Bᵀ of sticking contacts that share coordinates: contacts with independent
//! directions, and the constraint forces in them.

use super::contact::Site;
use super::factor::{Factor, Holding};
use super::model::Model;

impl Model<'_> {
    /// Sets the velocities at a time so that these contacts are at rest. For contacts that share
    /// coordinates, the change has the least kinetic energy.
    pub(crate) fn put_at_rest(
        &self,
        velocities: &mut [f64],
        time: f64,
        rests: impl Fn(usize) -> bool,
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
        for (j, correction) in self.corrections(&holding, relative) {
            velocities[j] -= correction;
        }
    }

    /// The constraints of the shared contacts that stick, one for each independent direction.
    pub(crate) fn holding(&self, sticks: impl Fn(usize) -> bool) -> Holding {
        let shared = self.shared.iter().copied();
        self.independent(shared.filter(|&c| sticks(c)).collect(), |_| 0.0)
    }

    /// The least change of the coordinates, in the norm of M, that sets the relative motion `apart`
    /// of these contacts to 0.
    pub(crate) fn corrections(
        &self,
        holding: &Holding,
        apart: impl Fn(usize) -> f64,
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
        softness: impl Fn(usize) -> f64,
    ) -> Holding {
        loop {
            match self.giving_factor(&contacts, &softness) {
                Ok(factor) => return Holding { contacts, factor },
                Err(place) => {
                    contacts.remove(place);
                }
            }
        }
    }

    /// Contacts, each with a coordinate that no contact before it has, as far as such coordinates
    /// exist. In this order, their relative velocities determine the velocities of these
    /// coordinates. Every contact has such a coordinate unless the contacts form a closed loop.
    pub(super) fn pivots(&self, contacts: &[usize]) -> Vec<(usize, usize)> {
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
        while let Some(j) = alone.pop() {
            let [c] = users[j][..] else { continue };
            pivots.push((c, j));
            for &(other, _) in self.contacts[c].direction.iter() {
                users[other].retain(|&user| user != c);
                if users[other].len() == 1 {
                    alone.push(other);
                }
            }
        }
        pivots.reverse();
        pivots
    }

    /// The factor of G for some of the shared contacts, in the order of [`shared`](Self::shared).
    ///
    /// # Errors
    ///
    /// The place of the first contact whose direction depends on those before it.
    pub(crate) fn factor(&self, among: &[usize]) -> Result<Factor, usize> {
        Factor::new(self.couplings(among))
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
        softness: impl Fn(usize) -> f64,
    ) -> Result<Factor, usize> {
        Factor::with_diagonal(|i| 1.0 + softness(among[i]), self.couplings(among))
    }

    /// The factor of G with a small additional compliance of each contact, so that contacts with
    /// dependent directions share the force.
    pub(super) fn soft_factor(&self, among: &[usize]) -> Factor {
        const SOFTEST: f64 = 1.0;
        let mut softness = 1e-8;
        loop {
            match self.giving_factor(among, |_| softness) {
                Ok(factor) => return factor,
                // Numbers that are not finite.
                Err(_) if softness > SOFTEST => return Factor::default(),
                Err(_) => softness *= 100.0,
            }
        }
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
