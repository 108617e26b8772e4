//! Translations that no force depends on, up to which motions are periodic: a shaft that turns.

use nalgebra::{DMatrix, DVector};

use super::type_erased_system::GeneralForm;
use crate::series::PowerSeries;
use crate::state::structure::State;
use crate::structure::Step;

/// A translation q + φe that no force depends on, and its place a·x with a·e = 1.
#[derive(Debug, Clone)]
pub(super) struct Translation {
    /// e.
    direction: DVector<f64>,
    /// a, by the numbers of a state.
    place: Vec<(usize, f64)>,
    /// True if a contact that never slips keeps the place, so that no perturbation changes it.
    pub(super) is_held: bool,
}

/// Entries of a direction below this part are rounding.
const ROUNDING: f64 = 1e-12;

/// The translations of a motion, with the places of contacts that never slip where they have one,
/// otherwise of coordinates.
pub(super) fn translations(
    form: &GeneralForm<'_>,
    never_slips: impl Fn(usize) -> bool,
) -> Vec<Translation> {
    let mut left: Vec<DVector<f64>> = form.freedom().displacements.clone();
    if left.is_empty() {
        return Vec::new();
    }
    // The surface under an elastic contact moves with b·q − T/k.
    let of_contacts = (0..form.contacts()).filter(|&c| never_slips(c)).map(|c| {
        let contact = &form.model.contacts[c];
        let force = contact.tangential_stiffness;
        let force = force.map(|stiffness| (form.carried_row(c), -stiffness.recip()));
        (
            contact.direction.iter().copied().chain(force).collect(),
            true,
        )
    });
    let of_coordinates = (0..form.len()).map(|j| (vec![(j, 1.0)], false));
    let mut found: Vec<Translation> = Vec::new();
    for (place, is_held) in of_contacts.chain(of_coordinates) {
        let place: Vec<(usize, f64)> = place;
        let along = |e: &DVector<f64>| dot(&place, |j| e.get(j).copied().unwrap_or(0.0));
        let parts: Vec<f64> = left.iter().map(along).collect();
        let largest = (0..parts.len()).max_by(|&i, &j| parts[i].abs().total_cmp(&parts[j].abs()));
        let Some(chosen) = largest.filter(|&i| parts[i].abs() > ROUNDING * left[i].amax()) else {
            continue;
        };
        let direction = left.swap_remove(chosen) / parts[chosen];
        for other in left
            .iter_mut()
            .chain(found.iter_mut().map(|t| &mut t.direction))
        {
            let part = along(other);
            other.axpy(-part, &direction, 1.0);
            if let [(j, _)] = place[..] {
                other[j] = 0.0;
            }
        }
        found.push(Translation {
            direction,
            place,
            is_held,
        });
    }
    found
}

fn dot(place: &[(usize, f64)], at: impl Fn(usize) -> f64) -> f64 {
    place.iter().map(|&(j, a)| a * at(j)).sum()
}

impl Translation {
    /// Removes the part along the translation from a perturbation, or from a rate: from its first
    /// numbers, the displacements.
    pub(super) fn remove_from(&self, change: &mut [f64]) {
        let part = dot(&self.place, |j| change[j]);
        for (x, e) in change.iter_mut().zip(&self.direction) {
            *x -= part * e;
        }
    }

    /// The place as a row for states.
    pub(super) fn row(&self, order: usize) -> DVector<f64> {
        let mut row = DVector::zeros(order);
        self.place.iter().for_each(|&(j, a)| row[j] = a);
        row
    }

    /// Removes the part along the translation from each column of a derivative.
    pub(super) fn remove_from_columns(&self, derivative: &mut DMatrix<f64>) {
        for mut column in derivative.column_iter_mut() {
            self.remove_from(column.as_mut_slice());
        }
    }
}

/// The part of a coordinate's velocity that no translation changes, by velocities.
fn relative_velocity(translations: &[Translation], coordinate: usize) -> Vec<(usize, f64)> {
    let mut entries = vec![(coordinate, 1.0)];
    for translation in translations {
        let e = translation.direction[coordinate];
        let n = translation.direction.len();
        for &(j, a) in translation.place.iter().filter(|(j, _)| *j < n) {
            match entries.iter_mut().find(|entry| entry.0 == j) {
                Some((_, entry)) => *entry -= e * a,
                None => entries.push((j, -e * a)),
            }
        }
    }
    entries.retain(|(_, entry)| entry.abs() > ROUNDING);
    entries
}

impl GeneralForm<'_> {
    /// The part of a coordinate's velocity that no translation changes.
    pub(super) fn turning(&self, coordinate: usize) -> Turning {
        Turning::relative(&translations(self, |_| false), coordinate)
    }

    /// A state moved along the translations that no force depends on, to the place of another one.
    pub(super) fn put_back(&self, state: &State, to: &State) -> State {
        let mut state = state.clone();
        for translation in translations(self, |_| false) {
            let moved = std::iter::zip(&state.displacements, &to.displacements);
            let mut moved: Vec<f64> = moved.map(|(x, to)| x - to).collect();
            translation.remove_from(&mut moved);
            let back = std::iter::zip(moved, &to.displacements).map(|(x, to)| to + x);
            state.displacements = back.collect();
        }
        state
    }

    /// Removes the parts along these translations from a perturbation.
    pub(super) fn untranslated(&self, change: &mut [f64]) {
        for translation in translations(self, |_| false) {
            translation.remove_from(change);
        }
    }
}

/// The phase condition of an autonomous motion: a coordinate turns, or its velocity relative to the
/// place of the translations is 0.
#[derive(Debug, Clone)]
pub(super) struct Turning {
    pub(super) coordinate: usize,
    /// The velocities with their factors; that of the coordinate is 1.
    velocity: Vec<(usize, f64)>,
}

impl Turning {
    /// The condition v_i = 0.
    pub(super) fn of(coordinate: usize) -> Self {
        Self::relative(&[], coordinate)
    }

    /// The condition for the part of a velocity that no translation changes.
    pub(super) fn relative(translations: &[Translation], coordinate: usize) -> Self {
        Self {
            coordinate,
            velocity: relative_velocity(translations, coordinate),
        }
    }

    /// The velocity, or the acceleration, by those of the coordinates.
    pub(super) fn of_velocities(&self, at: impl Fn(usize) -> f64) -> f64 {
        dot(&self.velocity, at)
    }

    /// The numbers of a state with n coordinates, with their factors.
    pub(super) fn entries(&self, n: usize) -> impl Iterator<Item = (usize, f64)> {
        self.velocity
            .iter()
            .map(move |&(j, factor)| (n + j, factor))
    }

    /// The velocity in a step, as a power series; zero in a step of a mass at rest.
    pub(super) fn series(&self, step: &Step) -> Option<PowerSeries> {
        let mut sum = *step.series().get(self.coordinate)?;
        for &(j, factor) in self.velocity.iter().filter(|(j, _)| *j != self.coordinate) {
            sum.add(factor, step.series().get(j)?);
        }
        Some(sum)
    }

    /// Puts a state on the condition.
    pub(super) fn impose(&self, velocities: &mut [f64]) {
        velocities[self.coordinate] -= self.of_velocities(|j| velocities[j]);
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use super::super::oscillator::FamilyMember;
    use super::*;
    use crate::friction::Coulomb;
    use crate::structure::freedom::Freedom;
    use crate::structure::{Contact, Structure};

    fn freedom(structure: &Structure) -> Freedom {
        Freedom::of(structure.form().model())
    }

    /// A chain of masses and springs of all sizes moves as a whole, unless a spring holds it to the
    /// ground, however weak.
    #[test]
    fn a_chain_moves_as_a_whole_unless_it_is_held() {
        let count = 40;
        let size = |i: usize| 10f64.powi((i * 7 % 5) as i32 - 2);
        let masses: Vec<f64> = (0..count).map(size).collect();
        let mut chain = Structure::new(&masses).unwrap();
        for i in 1..count {
            chain = chain.with_spring(i - 1, i, 1e4 * size(i + 1)).unwrap();
        }
        let found = freedom(&chain).displacements;
        let [direction] = &found[..] else {
            panic!("{found:?}")
        };
        // Rounding, times the condition number of a chain of such springs.
        let apart = direction.iter().map(|x| (x - direction[0]).abs());
        let apart = apart.fold(0.0, f64::max);
        assert!(apart < 1e-10, "{apart:e}");
        assert_eq!(freedom(&chain).velocities.len(), 1);
        // A damper sees velocities, a load that depends on a displacement holds.
        let damped = chain.clone().with_ground_damper(3, 1e-3).unwrap();
        let found = freedom(&damped);
        assert_eq!((found.displacements.len(), found.velocities.len()), (1, 0));
        let contact = Contact::new(2, Coulomb::new(0.4, 0.3).unwrap(), 1.0).unwrap();
        let rubbed = chain.clone().with_contact(contact.clone()).unwrap();
        let found = freedom(&rubbed);
        assert_eq!((found.displacements.len(), found.velocities.len()), (1, 0));
        let loaded = contact.with_load_gradient(5, 1.0).unwrap();
        let loaded = chain.clone().with_contact(loaded).unwrap();
        assert!(freedom(&loaded).displacements.is_empty());
        for (place, stiffness) in [(0, 1.0), (20, 1e-2), (39, 1e-4)] {
            let held = chain.clone().with_ground_spring(place, stiffness).unwrap();
            assert!(freedom(&held).displacements.is_empty(), "{place}");
        }
    }

    /// Several shafts, geared: as many translations, whose places are found again.
    #[test]
    fn each_part_has_a_translation_of_its_own() {
        // q_0 = 3 q_1, apart from them q_2 = q_3, and q_4 alone.
        let mut stiffness = DMatrix::zeros(5, 5);
        for (i, j, ratio) in [(0, 1, 3.0), (2, 3, 1.0)] {
            stiffness[(i, i)] = 2.0;
            stiffness[(i, j)] = -2.0 * ratio;
            stiffness[(j, i)] = -2.0 * ratio;
            stiffness[(j, j)] = 2.0 * ratio * ratio;
        }
        let shafts = Structure::new(&[1.0, 0.2, 3.0, 1.0, 2.0]).unwrap();
        let shafts = shafts.with_stiffness(stiffness.clone()).unwrap();
        let form = shafts.form();
        assert_eq!(form.freedom().displacements.len(), 3);
        let found = translations(&form, |_| false);
        assert_eq!(found.len(), 3);
        for (i, translation) in found.iter().enumerate() {
            assert!((&stiffness * &translation.direction).amax() < 1e-12);
            for (j, other) in found.iter().enumerate() {
                let part = dot(&translation.place, |k| other.direction[k]);
                assert!((part - f64::from(u8::from(i == j))).abs() < 1e-12);
            }
        }
        // A state is put back along all of them, and what they do not change stays.
        let state = State::new(&[6.0, 1.0, 5.0, 5.5, -7.0], &[1.0; 5]);
        let back = form.put_back(&state, &State::at_rest(5));
        let twist = |state: &State| {
            let q = &state.displacements;
            [q[0] - 3.0 * q[1], q[2] - q[3]]
        };
        for (a, b) in std::iter::zip(twist(&back), twist(&state)) {
            assert!((a - b).abs() < 1e-12);
        }
        assert!(back.displacements[4] == 0.0 && back.velocities == state.velocities);
    }
}
