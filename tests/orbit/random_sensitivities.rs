//! Derivatives of random motions by their parameters, against differences of motions on both sides
//! of the parameter. Many of the events happen at the same instant: elements in parallel, mirrored
//! masses, and contacts that others cause to slip.

use stick_slip::nalgebra::DVector;
use stick_slip::orbit::{NotDifferentiable, sensitivities};
use stick_slip::structure::State;
use stick_slip::{
    Contact, Coulomb, Drive, Element, Error, Event, EventKind, Exponential, Mode, Structure,
    Trajectory,
};

use crate::common::orbit::monodromy;
use crate::common::{Random, count};

/// The middle of the longest time without events between two times.
fn longest_pause(motion: &Trajectory<State>, after: f64, end: f64) -> f64 {
    let times = motion.events().iter().map(|event| event.time);
    let times = times.filter(|t| *t > after);
    let ends = std::iter::once(after).chain(times).chain([end]);
    let times: Vec<f64> = ends.collect();
    let pauses = times.windows(2);
    let pause = pauses.max_by(|a, b| (a[1] - a[0]).total_cmp(&(b[1] - b[0])));
    pause.map(|pair| 0.5 * (pair[0] + pair[1])).unwrap()
}

/// How a coordinate or two are rubbed.
#[derive(Debug, Clone)]
enum Rub {
    /// The places in the parameters of μ_s, μ_k/μ_s, N and w.
    Belt(usize, [usize; 4]),
    Falling(usize, [usize; 4]),
    Joint([usize; 2], [usize; 3]),
    /// μN, and stiffness and share of each element.
    Elements([usize; 2], usize, Vec<[usize; 2]>),
}

/// A random structure; its numbers are the parameters of a family.
#[derive(Debug, Clone, Default)]
struct Case {
    numbers: Vec<f64>,
    /// Places of the masses, ground springs, dampers, and of springs between neighbours.
    masses: Vec<usize>,
    ground: Vec<usize>,
    dampers: Vec<usize>,
    springs: Vec<usize>,
    /// Amplitude and frequency of the force on each coordinate.
    forces: Vec<Option<[usize; 2]>>,
    rubs: Vec<Rub>,
    displacements: Vec<usize>,
    velocities: Vec<usize>,
    /// A second copy, which shares its numbers except one place.
    twins: bool,
    /// What connects the copies: a spring, a damper, nothing, or an elastic contact.
    coupling: u64,
}

impl Case {
    fn number(&mut self, value: f64) -> usize {
        self.numbers.push(value);
        self.numbers.len() - 1
    }

    fn random(random: &mut Random, kind: usize) -> Self {
        let mut case = Self::default();
        let n = 1 + (random.bits() % 2) as usize + usize::from(kind == 2);
        for i in 0..n {
            let mass = case.number(random.uniform(0.5, 2.0));
            case.masses.push(mass);
            let ground = case.number(random.uniform(0.5, 2.0));
            case.ground.push(ground);
            let damper = case.number(random.uniform(0.02, 0.2));
            case.dampers.push(damper);
            if i > 0 {
                let spring = case.number(random.uniform(0.3, 2.0));
                case.springs.push(spring);
            }
            let force = random.bits().is_multiple_of(2) || i == 0;
            let force = force.then(|| {
                [random.uniform(0.3, 1.0), random.uniform(0.4, 1.6)].map(|value| case.number(value))
            });
            case.forces.push(force);
            let displacement = case.number(random.uniform(-0.5, 0.5));
            case.displacements.push(displacement);
            let velocity = case.number(random.uniform(-0.7, 0.7));
            case.velocities.push(velocity);
        }
        // At rest on surfaces at rest in every fourth.
        if random.bits().is_multiple_of(4) {
            for at in case.velocities.clone() {
                case.numbers[at] = 0.0;
            }
        }
        for i in 0..n {
            let numbers = [
                random.uniform(0.2, 0.6),
                if random.bits() & 1 == 0 {
                    1.0
                } else {
                    random.uniform(0.4, 1.0)
                },
                random.uniform(0.3, 1.0),
                if random.bits() & 1 == 0 {
                    0.0
                } else {
                    random.uniform(0.1, 0.5)
                },
            ];
            let elements = |case: &mut Self, random: &mut Random, between| {
                let limit = case.number(random.uniform(0.1, 0.5));
                let count = 2 + random.bits() % 3;
                let same = random.bits().is_multiple_of(4);
                let first = [random.uniform(0.5, 5.0), random.uniform(0.2, 0.6)];
                let elements = (0..count).map(|_| {
                    let own = [random.uniform(0.5, 5.0), random.uniform(0.2, 0.6)];
                    (if same { first } else { own }).map(|value| case.number(value))
                });
                let elements = elements.collect();
                case.rubs.push(Rub::Elements(between, limit, elements));
            };
            match (kind, random.bits() % 3) {
                (0, _) | (3, 0) => elements(&mut case, random, [i, i]),
                (_, 0) => {
                    let places = numbers.map(|value| case.number(value));
                    case.rubs.push(Rub::Falling(i, places));
                }
                (_, _) => {
                    let places = numbers.map(|value| case.number(value));
                    case.rubs.push(Rub::Belt(i, places));
                }
            }
            if i > 0 && kind != 0 {
                if random.bits() & 1 == 0 {
                    let [a, b, c, _] = numbers;
                    let places = [0.7 * a, b, 0.6 * c].map(|value| case.number(value));
                    case.rubs.push(Rub::Joint([i - 1, i], places));
                } else if random.bits() & 1 == 0 {
                    elements(&mut case, random, [i - 1, i]);
                }
            }
        }
        case.twins = kind == 1;
        case.coupling = random.bits() % 4;
        case
    }

    /// The system and its start; of twins the second copy has the last number added to one place.
    fn build(&self, p: &[f64], apart: Option<usize>) -> Result<(Structure, State), Error> {
        let copies = if self.twins { 2 } else { 1 };
        let n = self.masses.len();
        let (shared, extra) = p.split_at(self.numbers.len());
        let of_copy = |copy: usize| {
            let mut p = shared.to_vec();
            if let (1, Some(at)) = (copy, apart) {
                p[at] += extra[0];
            }
            p
        };
        let numbers: Vec<Vec<f64>> = (0..copies).map(of_copy).collect();
        let all = |places: &[usize]| -> Vec<f64> {
            numbers
                .iter()
                .flat_map(|p| places.iter().map(|&at| p[at]))
                .collect()
        };
        let mut structure = Structure::new(&all(&self.masses))?;
        for (copy, p) in numbers.iter().enumerate() {
            let first = copy * n;
            for i in 0..n {
                structure = structure
                    .with_ground_spring(first + i, p[self.ground[i]])?
                    .with_ground_damper(first + i, p[self.dampers[i]])?;
                if let Some([amplitude, frequency]) = self.forces[i] {
                    let force = Drive::harmonic(p[amplitude], p[frequency], 0.3)?;
                    structure = structure.with_force(first + i, force)?;
                }
                if i > 0 {
                    let stiffness = p[self.springs[i - 1]];
                    structure = structure.with_spring(first + i - 1, first + i, stiffness)?;
                }
            }
            for rub in &self.rubs {
                match rub {
                    Rub::Belt(i, [limit, part, load, w]) => {
                        let law = Coulomb::new(p[*limit], p[*limit] * p[*part])?;
                        let contact = Contact::new(first + i, law, p[*load])?.on_belt(p[*w]);
                        structure = structure.with_contact(contact)?;
                    }
                    Rub::Falling(i, [limit, part, load, w]) => {
                        let least = 0.9 * p[*limit] * p[*part];
                        let law = Exponential::new(p[*limit], least, 0.3)?;
                        let contact = Contact::new(first + i, law, p[*load])?.on_belt(p[*w]);
                        structure = structure.with_contact(contact)?;
                    }
                    Rub::Joint([i, j], [limit, part, load]) => {
                        let law = Coulomb::new(p[*limit], p[*limit] * p[*part])?;
                        let joint = Contact::between(first + i, first + j, law, p[*load])?;
                        structure = structure.with_contact(joint)?;
                    }
                    Rub::Elements([i, j], limit, elements) => {
                        let law = Coulomb::new(p[*limit], p[*limit])?;
                        let joint = if i == j {
                            Contact::new(first + i, law, 1.0)?
                        } else {
                            Contact::between(first + i, first + j, law, 1.0)?
                        };
                        let elements: Vec<(f64, f64)> = elements
                            .iter()
                            .map(|[k, share]| (p[*k], p[*share]))
                            .collect();
                        structure = structure.with_contacts(joint.in_parallel(&elements)?)?;
                    }
                }
            }
        }
        if copies == 2 {
            structure = match self.coupling {
                0 => structure.with_spring(0, n, 0.4)?,
                1 => structure.with_damper(0, n, 0.2)?,
                2 => structure,
                _ => {
                    let joint = Contact::between(0, n, Coulomb::new(0.1, 0.1)?, 1.0)?;
                    structure.with_contact(joint.with_tangential_stiffness(0.7)?)?
                }
            };
        }
        let start = State::new(&all(&self.displacements), &all(&self.velocities));
        Ok((structure, start))
    }
}

fn vector(state: &State) -> DVector<f64> {
    let numbers = state.displacements.iter().chain(&state.velocities);
    DVector::from_iterator(2 * state.velocities.len(), numbers.copied())
}

/// What differences of motions say about the derivative.
enum Differences {
    /// Both sides agree.
    Value(DVector<f64>, f64),
    /// They have limits that differ.
    Kink([DVector<f64>; 2]),
    /// They have no limits that agree to enough digits to tell.
    Unclear,
}

/// Extrapolated differences of second order on one side, at several increments: the error, and the
/// derivative.
fn difference(
    end: &dyn Fn(f64) -> Option<DVector<f64>>,
    here: &DVector<f64>,
    value: f64,
    side: f64,
) -> Option<(f64, DVector<f64>)> {
    let size = if value == 0.0 { 1.0 } else { value.abs() };
    let mut best: Option<(f64, DVector<f64>)> = None;
    let mut last: Option<DVector<f64>> = None;
    for i in 4..18 {
        let h = side * size * 0.3_f64.powi(i);
        let near = |places: f64| {
            let change = (value + places * h) - value;
            Some((end(change)? - here) / change)
        };
        let (Some(a), Some(b), Some(c)) = (near(1.0), near(2.0), near(4.0)) else {
            last = None;
            continue;
        };
        // Without the terms of first and second order.
        let (ab, bc) = (&a * 2.0 - &b, &b * 2.0 - &c);
        let slope = (ab * 4.0 - bc) / 3.0;
        if let Some(last) = last.replace(slope.clone()) {
            let error = (&last - &slope).amax();
            if best.as_ref().is_none_or(|best| error < best.0) {
                best = Some((error, slope));
            }
        }
    }
    best
}

fn differences(
    end: &dyn Fn(f64) -> Option<DVector<f64>>,
    here: &DVector<f64>,
    value: f64,
) -> Differences {
    // A family may end at the value.
    let (up, down) = match [1.0, -1.0].map(|side| difference(end, here, value, side)) {
        [Some(up), Some(down)] => (up, down),
        [Some(one), None] | [None, Some(one)] => (one.clone(), one),
        [None, None] => return Differences::Unclear,
    };
    let scale = up.1.amax().max(down.1.amax()).max(1e-3 * here.amax());
    let error = up.0.max(down.0);
    if error > 1e-4 * scale {
        return Differences::Unclear;
    }
    let gap = (&up.1 - &down.1).amax();
    if gap <= 1e-6 * scale + 20.0 * error {
        Differences::Value((up.1 + down.1) * 0.5, 1e-6 * scale + 20.0 * error)
    } else {
        Differences::Kink([up.1, down.1])
    }
}

/// The events of a motion: an element and a kind for each, and which of them happen at the instant
/// of the one before.
struct Sequence(Vec<(Element, EventKind, bool)>);

impl Sequence {
    /// `first_modes` are those of the contacts at the start of the motion that has the derivative:
    /// what sticks there may have a velocity in the others, and come to rest at once.
    fn of(motion: &Trajectory<State>, first_modes: &[Mode], time: f64) -> Self {
        /// Times of one instant, in units of the time.
        const TOGETHER: f64 = 1e-12;
        let mut last = f64::NEG_INFINITY;
        let comes_to_rest = |event: &&Event<State>| {
            let contact = event.contact().filter(|_| event.kind == EventKind::Stick);
            contact.is_some_and(|contact| first_modes[contact] == Mode::Stick)
        };
        let events = motion.events().iter().skip_while(comes_to_rest);
        let events = events.map(|event| {
            let continues = event.time - last <= TOGETHER * time;
            last = event.time;
            (event.element, event.kind, continues)
        });
        Self(events.collect())
    }

    /// Returns true if another motion has the same events, those of one instant in any order.
    fn is_that_of(&self, other: &Self) -> bool {
        if self.0.len() != other.0.len() {
            return false;
        }
        let mut begin = 0;
        while begin < self.0.len() {
            let group = self.0[begin + 1..].iter().take_while(|event| event.2);
            let end = begin + 1 + group.count();
            let kinds = |of: &Self| {
                let mut kinds: Vec<String> = of.0[begin..end]
                    .iter()
                    .map(|event| format!("{} {}", event.0, event.1))
                    .collect();
                kinds.sort();
                kinds
            };
            if kinds(self) != kinds(other) {
                return false;
            }
            begin = end;
        }
        true
    }

    fn has_one_instant_with_two(&self) -> bool {
        self.0.iter().any(|event| event.2)
    }
}

/// Where the motions on both sides have the events of the motion itself, the derivative is that of
/// both sides; where one side only has them, it is that of this side; and an error where neither
/// has them, or where the order of events at one instant gives two derivatives.
#[test]
fn random_derivatives_agree_with_differences() {
    let mut random = Random::new(4907);
    let mut counts = [0; 6];
    let mut wrong = Vec::new();
    for number in 0..count(12, 200) {
        let case = Case::random(&mut random, number % 4);
        // A number that the second copy has by itself, or one of all.
        let count = case.numbers.len();
        let apart =
            (case.twins && random.bits() & 1 == 0).then(|| (random.bits() % count as u64) as usize);
        let mut parameters = case.numbers.clone();
        parameters.push(0.0);
        let by = match apart {
            Some(_) => count,
            None => (random.bits() % count as u64) as usize,
        };
        let family = |p: &[f64]| {
            let mut all = parameters.clone();
            all[by] = p[0];
            case.build(&all, apart)
        };
        let value = parameters[by];
        let about = format!("case {number}, parameter {by} apart {apart:?}");
        let Ok((structure, start)) = family(&[value]) else {
            continue;
        };
        let Ok(whole) = structure.simulate(start, 12.0) else {
            continue;
        };
        let time = longest_pause(&whole, 6.0, 12.0);
        let here = vector(&whole.state_at(time).unwrap());
        let beside = |change: f64| {
            let (structure, start) = family(&[value + change]).ok()?;
            structure.simulate(start, time).ok()
        };
        let end = |change: f64| Some(vector(&beside(change)?.last()));
        let expected = differences(&end, &here, value);
        let first_modes = whole.steps()[0].modes();
        let events = |motion: &Trajectory<State>| Sequence::of(motion, first_modes, time);
        let own = events(&beside(0.0).unwrap());
        // Whether the motions on a side have the same events; `None` if that depends on how near
        // they are, or if there are none.
        let size = if value == 0.0 { 1.0 } else { value.abs() };
        let [up, down] = [1.0, -1.0].map(|side| {
            let same = [1e-7, 1e-9].map(|part| {
                let motion = beside(side * part * size)?;
                Some(own.is_that_of(&events(&motion)))
            });
            if same[0] == same[1] { same[0] } else { None }
        });
        let found = match sensitivities(family, &[value], time) {
            Ok(found) => {
                let by = found.at(time).unwrap();
                Ok(by.column(0).rows(0, here.len()).into_owned())
            }
            Err(Error::NoDerivative { reason, .. }) => Err(reason),
            Err(error) => panic!("{about}: {error}"),
        };
        let is_of = |found: &DVector<f64>, side: &DVector<f64>| {
            (found - side).amax() <= 1e-5 * side.amax().max(1e-3 * here.amax())
        };
        let said = format!("{about}: {found:?}, same events {up:?} {down:?}");
        let outcome = match (&found, &expected, up, down) {
            (_, Differences::Unclear, ..) => 0,
            // Both sides agree, whatever their events.
            (Ok(found), Differences::Value(value, most), ..) => {
                let is_right = (found - value).amax() <= *most;
                if is_right { 1 } else { 5 }
            }
            // One side has the events of the motion.
            (Ok(found), Differences::Kink([side, _]), Some(true), Some(false) | None)
            | (Ok(found), Differences::Kink([_, side]), Some(false) | None, Some(true))
                if is_of(found, side) =>
            {
                2
            }
            // No side has them.
            (
                Err(NotDifferentiable::Events { .. }),
                Differences::Kink(_),
                Some(false),
                Some(false),
            ) => 3,
            // Both sides have them, at one instant in any order.
            (
                Err(NotDifferentiable::Order { .. }),
                Differences::Kink(_),
                Some(true),
                Some(true),
            ) if own.has_one_instant_with_two() => 4,
            _ => 5,
        };
        if outcome == 0 {
            println!("unclear: {said}");
        }
        if outcome == 5 {
            let differences = match &expected {
                Differences::Value(value, most) => format!("{} {most:e}", value.transpose()),
                Differences::Kink([a, b]) => format!("{} {}", a.transpose(), b.transpose()),
                Differences::Unclear => String::new(),
            };
            wrong.push(format!("{said} {differences}"));
        }
        counts[outcome] += 1;
    }
    let [unclear, both, one, neither, order, _] = counts;
    println!(
        "{both} of both sides, {one} of one, {neither} other events, {order} orders, \
         {unclear} unclear"
    );
    assert!(wrong.is_empty(), "{wrong:#?}");
    assert!(20 * unclear <= counts.iter().sum(), "{unclear} unclear");
}

/// At the last value of a parameter before the events of the motion change, the derivative is that
/// of the side with the same events; or an error, where it grows without bound towards the change.
#[test]
fn beside_a_change_of_events_the_derivative_is_of_one_side() {
    let mut random = Random::new(4909);
    let [mut right, mut refused] = [0; 2];
    let mut wrong = Vec::new();
    for number in 0..count(10, 200) {
        let case = Case::random(&mut random, [1, 0, 2, 3][number % 4]);
        let mut parameters = case.numbers.clone();
        parameters.push(0.0);
        let by = (random.bits() % case.numbers.len() as u64) as usize;
        let family = |p: &[f64]| {
            let mut all = parameters.clone();
            all[by] = p[0];
            case.build(&all, None)
        };
        let motion = |value: f64, time: f64| {
            let (structure, start) = family(&[value]).ok()?;
            structure.simulate(start, time).ok()
        };
        let value = parameters[by];
        let Some(whole) = motion(value, 12.0) else {
            continue;
        };
        let time = longest_pause(&whole, 6.0, 12.0);
        let first_modes = whole.steps()[0].modes();
        let events = |value: f64| Some(Sequence::of(&motion(value, time)?, first_modes, time));
        let own = events(value).unwrap();
        let is_same = |value: f64| events(value).is_some_and(|events| own.is_that_of(&events));
        // The nearest value, up to a few tenths, with other events.
        let away = (1..=8).map(|i| value * (1.0 + 0.05 * f64::from(i)));
        let Some(mut other) = away.clone().find(|away| !is_same(*away)) else {
            continue;
        };
        let mut same = value;
        loop {
            let middle = 0.5 * (same + other);
            if middle == same || middle == other {
                break;
            }
            *(if is_same(middle) {
                &mut same
            } else {
                &mut other
            }) = middle;
        }
        let side = (same - other).signum();
        let Some(there) = motion(same, time) else {
            continue;
        };
        let here = vector(&there.last());
        let end = |change: f64| Some(vector(&motion(same + change, time)?.last()));
        let expected = difference(&end, &here, same, side);
        let about = format!("case {number}, parameter {by} = {same:?}, side {side}");
        let found = match sensitivities(family, &[same], time) {
            Ok(found) => Ok(found
                .at(time)
                .unwrap()
                .column(0)
                .rows(0, here.len())
                .into_owned()),
            Err(Error::NoDerivative { reason, .. }) => Err(reason),
            Err(error) => panic!("{about}: {error}"),
        };
        let size = |(_, slope): &(f64, DVector<f64>)| slope.amax();
        let scale = expected.as_ref().map_or(0.0, size).max(1e-3 * here.amax());
        let expected = expected.filter(|(error, _)| *error <= 1e-4 * scale);
        let is_right = |found: &DVector<f64>, (error, slope): &(f64, DVector<f64>)| {
            (found - slope).amax() <= 1e-5 * scale + 20.0 * error
        };
        match (&found, &expected) {
            (Ok(found), Some(expected)) if is_right(found, expected) => right += 1,
            // The events that change are at one instant there.
            (Err(NotDifferentiable::Order { .. }), _)
                if events(same).unwrap().has_one_instant_with_two() =>
            {
                right += 1;
            }
            // Motions that jump beside the change, or nearly: some that almost stop.
            (Err(NotDifferentiable::Kink), _) => refused += 1,
            _ => wrong.push(format!("{about}: {found:?} {expected:?}")),
        }
    }
    println!("{right} right, {refused} refused");
    assert!(wrong.is_empty(), "{wrong:#?}");
    assert!(20 * refused <= right, "{refused} refused");
}

/// The derivative by the start, through events of several contacts at one instant too, is the
/// monodromy matrix of the tangent flow.
#[test]
fn monodromy_matrices_agree_with_derivatives_by_the_start() {
    let mut random = Random::new(5011);
    let (mut right, mut wrong, mut refused) = (0, 0, 0);
    for number in 0..count(12, 200) {
        let case = Case::random(&mut random, [1, 0, 1, 2][number % 4]);
        let mut parameters = case.numbers.clone();
        parameters.push(0.0);
        let Ok((structure, mut start)) = case.build(&parameters, None) else {
            continue;
        };
        let n = structure.len();
        // No velocity of a surface, which a perturbation would change the mode of.
        for (i, velocity) in start.velocities.iter_mut().enumerate() {
            if *velocity == 0.0 {
                *velocity = 0.3 + 0.01 * (i % case.masses.len()) as f64;
            }
        }
        let Ok(whole) = structure.simulate(start.clone(), 9.0) else {
            continue;
        };
        let time = longest_pause(&whole, 4.0, 9.0);
        let (_, matrix) = monodromy(&structure, &start, time).unwrap();
        let numbers: Vec<f64> = start
            .displacements
            .iter()
            .chain(&start.velocities)
            .copied()
            .collect();
        for (j, &value) in numbers.iter().enumerate() {
            let family = |p: &[f64]| {
                let mut numbers = numbers.clone();
                numbers[j] = p[0];
                let start = State::new(&numbers[..n], &numbers[n..]);
                Ok((case.build(&parameters, None)?.0, start))
            };
            let Ok(found) = sensitivities(family, &[value], time) else {
                refused += 1;
                continue;
            };
            let found = found
                .at(time)
                .unwrap()
                .column(0)
                .rows(0, 2 * n)
                .into_owned();
            let exact = matrix.column(j).rows(0, 2 * n).into_owned();
            let error = (&found - &exact).amax();
            if error > 1e-7 * exact.amax().max(1e-3) {
                println!(
                    "case {number}, {j} of {n}: {error:e} of {:e}, coupling {} twins {} {:?}",
                    exact.amax(),
                    case.coupling,
                    case.twins,
                    case.rubs
                );
                wrong += 1;
            } else {
                right += 1;
            }
        }
    }
    println!("{right} right, {wrong} wrong, {refused} refused");
    assert_eq!(wrong, 0);
}
