//! Random structures in plain numbers, and a deliberately simple integrator for them, which shares
//! no idea and no code with the crate: fixed Runge-Kutta steps, events by bisection.

use stick_slip::nalgebra::{DMatrix, DVector};
use stick_slip::structure::State;
use stick_slip::{
    AnyLaw, Contact, Coulomb, Drive, Exponential, FirstOrder, FrictionLaw, Polynomial, Rational,
    Stop, Stribeck, Structure, Tabulated,
};

use crate::Random;
use crate::any_force::AnyForce;
use crate::naive::{Question, is_definite};

/// constant + Σ a cos(Ωt + φ) + straight lines through points.
#[derive(Debug, Clone, Default)]
pub struct PlainDrive {
    pub constant: f64,
    pub harmonics: Vec<[f64; 3]>,
    pub points: Vec<(f64, f64)>,
}

impl PlainDrive {
    pub fn constant(constant: f64) -> Self {
        Self {
            constant,
            ..Self::default()
        }
    }

    pub fn at(&self, t: f64, before: bool) -> [f64; 2] {
        let mut sum = [self.constant, 0.0];
        for &[a, omega, phase] in &self.harmonics {
            sum[0] += a * (omega * t + phase).cos();
            sum[1] -= a * omega * (omega * t + phase).sin();
        }
        let passed = self
            .points
            .iter()
            .filter(|(time, _)| *time < t || (!before && *time == t));
        let (start, end) = (passed.clone().next_back(), self.points.get(passed.count()));
        match (start, end) {
            (Some(&(t0, v0)), Some(&(t1, v1))) => {
                let slope = (v1 - v0) / (t1 - t0);
                sum[0] += v0 + slope * (t - t0);
                sum[1] += slope;
            }
            (Some(&(_, v)), None) | (None, Some(&(_, v))) => sum[0] += v,
            (None, None) => {}
        }
        sum
    }

    fn drive(&self) -> Drive {
        let mut drive = Drive::constant(self.constant);
        for &[a, omega, phase] in &self.harmonics {
            drive = drive.with_harmonic(a, omega, phase).unwrap();
        }
        if !self.points.is_empty() {
            drive = drive.with_profile(&self.points).unwrap();
        }
        drive
    }

    /// A function of any kind, about as large as `size`.
    fn random(random: &mut Random, size: f64, jumps: bool) -> Self {
        let mut drive = Self::constant(size * random.uniform(-1.0, 1.0));
        for _ in 0..random.bits() % 3 {
            let amplitude = 0.7 * size * random.uniform(-1.0, 1.0);
            drive.harmonics.push([
                amplitude,
                random.logarithmic(0.2, 4.0),
                random.uniform(-3.0, 3.0),
            ]);
        }
        if random.bits().is_multiple_of(3) {
            let mut time = random.uniform(0.0, 5.0);
            let mut value = size * random.uniform(-1.0, 1.0);
            for _ in 0..5 {
                drive.points.push((time, value));
                value = size * random.uniform(-1.0, 1.0);
                if jumps && random.bits().is_multiple_of(2) {
                    drive.points.push((time, value));
                }
                time += random.uniform(0.5, 6.0);
            }
        }
        drive
    }
}

#[derive(Debug, Clone)]
pub struct PlainContact {
    /// b, with a number for each coordinate.
    pub direction: DVector<f64>,
    pub law: AnyLaw,
    pub load: PlainDrive,
    pub gradient: Vec<f64>,
    /// φ, each along a direction.
    pub laws: Vec<(DVector<f64>, AnyForce)>,
    pub belt: PlainDrive,
}

#[derive(Debug, Clone)]
pub struct PlainElement {
    /// a, with a number for each coordinate.
    pub direction: DVector<f64>,
    pub law: AnyForce,
    pub factor: PlainDrive,
}

/// A stop with spring and damper behind a gap.
#[derive(Debug, Clone)]
pub struct PlainStop {
    /// −d, with a number for each coordinate.
    pub inward: DVector<f64>,
    pub gap: f64,
    pub stiffness: f64,
    pub damping: f64,
    pub adhesive: bool,
}

impl PlainStop {
    /// The depth, and kδ + cδ'.
    fn pressure(&self, q: &DVector<f64>, v: &DVector<f64>) -> [f64; 2] {
        let depth = self.inward.dot(q) - self.gap;
        [
            depth,
            self.stiffness * depth + self.damping * self.inward.dot(v),
        ]
    }

    /// Closed ones open at the end of their force; open ones close where it begins.
    fn is_due(&self, closed: bool, q: &DVector<f64>, v: &DVector<f64>) -> bool {
        let [depth, pressure] = self.pressure(q, v);
        let pushes = depth > 0.0 && (self.adhesive || pressure > 0.0);
        pushes != closed
    }
}

/// The number of the first stop in a list of events.
pub const STOPS: usize = 1000;

#[derive(Debug, Clone)]
pub struct Plain {
    pub mass: DMatrix<f64>,
    pub stiffness: DMatrix<f64>,
    pub damping: DMatrix<f64>,
    pub forces: Vec<PlainDrive>,
    pub contacts: Vec<PlainContact>,
    pub elements: Vec<PlainElement>,
    /// How many of the last coordinates, of mass 1, are first-order states of the structure, by
    /// their velocities; nothing depends on their displacements.
    pub states: usize,
    pub stops: Vec<PlainStop>,
}

/// e_i.
fn unit(n: usize, i: usize) -> DVector<f64> {
    DVector::from_fn(n, |j, _| if i == j { 1.0 } else { 0.0 })
}

/// A spring or a damper between two coordinates.
fn connect(matrix: &mut DMatrix<f64>, i: usize, j: usize, value: f64) {
    for (row, column, sign) in [(i, i, 1.0), (j, j, 1.0), (i, j, -1.0), (j, i, -1.0)] {
        matrix[(row, column)] += sign * value;
    }
}

fn any_law(random: &mut Random) -> AnyLaw {
    let limit = random.uniform(0.2, 0.8);
    let least = limit * random.uniform(0.4, 1.0);
    match random.bits() % 6 {
        0 => Coulomb::new(limit, least).unwrap().into(),
        1 => Polynomial::new(limit, least, random.uniform(0.4, 1.5))
            .unwrap()
            .into(),
        2 => Exponential::new(limit, least, random.uniform(0.15, 1.0))
            .unwrap()
            .into(),
        3 => Rational::new(limit, random.uniform(0.5, 3.0))
            .unwrap()
            .into(),
        4 => Stribeck::new(limit, least, random.uniform(0.2, 1.0), 1)
            .and_then(|law| law.with_viscous_coefficient(0.02))
            .unwrap()
            .into(),
        _ => {
            let middle = 0.5 * (limit + least);
            let points = [(0.0, limit), (0.2, middle), (0.5, least), (1.2, middle)];
            Tabulated::new(points).unwrap().into()
        }
    }
}

impl Plain {
    /// One to four masses of ordinary size.
    pub fn random(random: &mut Random) -> Self {
        let n = 1 + (random.bits() % 4) as usize;
        let mut stiffness = DMatrix::zeros(n, n);
        let mut damping = stiffness.clone();
        for i in 0..n {
            stiffness[(i, i)] += random.uniform(0.3, 2.0);
            damping[(i, i)] += random.uniform(0.0, 0.3);
            for j in 0..i {
                if random.bits().is_multiple_of(2) {
                    let (k, c) = (random.uniform(0.1, 1.5), random.uniform(0.0, 0.1));
                    connect(&mut stiffness, i, j, k);
                    connect(&mut damping, i, j, c);
                }
            }
        }
        let forces = (0..n)
            .map(|_| match random.bits() % 3 {
                0 => PlainDrive::random(random, 0.6, true),
                _ => PlainDrive::default(),
            })
            .collect();
        let mut contacts = Vec::new();
        for i in (0..n).rev() {
            if random.bits().is_multiple_of(4) {
                continue;
            }
            let base = random.uniform(0.3, 2.0);
            let mut load = PlainDrive::constant(base);
            let mut gradient = vec![0.0; n];
            match random.bits() % 4 {
                // May open.
                0 => {
                    load = PlainDrive::random(random, base, true);
                    load.constant = 0.6 * base;
                    load.harmonics
                        .push([0.5 * base, random.logarithmic(0.2, 2.0), 0.0]);
                }
                1 => gradient[(random.bits() as usize) % n] = base * random.uniform(-0.8, 0.8),
                _ => {}
            }
            let belt = match random.bits() % 3 {
                0 => PlainDrive::random(random, 0.5, false),
                1 => PlainDrive::constant(random.sign() * random.logarithmic(0.03, 1.0)),
                _ => PlainDrive::default(),
            };
            contacts.push(PlainContact {
                direction: unit(n, i),
                law: any_law(random),
                load,
                gradient,
                laws: Vec::new(),
                belt,
            });
        }
        let masses = DVector::from_fn(n, |_, _| random.logarithmic(0.3, 3.0));
        Self {
            mass: DMatrix::from_diagonal(&masses),
            stiffness,
            damping,
            forces,
            contacts,
            elements: Vec::new(),
            states: 0,
            stops: Vec::new(),
        }
    }

    /// A start; sometimes with masses that move with their belts.
    pub fn start(&self, random: &mut Random) -> State {
        let n = self.len();
        let q: Vec<f64> = (0..n).map(|_| random.uniform(-1.0, 1.0)).collect();
        let mut v: Vec<f64> = (0..n).map(|_| random.uniform(-1.0, 1.0)).collect();
        let structure = self.structure();
        for contact in structure.contacts() {
            if random.bits().is_multiple_of(2) {
                v[contact.coordinate()] = contact.belt_velocity().value(0.0);
            }
        }
        State::new(&q, &v)
    }

    /// One to six coordinates, and as many contacts, in any direction. Where numbers are `coarse`
    /// they are multiples of 1/4: many contacts stand on their edges, or come to them together.
    pub fn shared(random: &mut Random, coarse: bool) -> Self {
        fn round(x: f64) -> f64 {
            (4.0 * x).round() / 4.0
        }
        let n = 1 + (random.bits() % 6) as usize;
        let number = |random: &mut Random, low: f64, high: f64| {
            let x = random.uniform(low, high);
            if coarse { round(x).max(0.25) } else { x }
        };
        let drive = |random: &mut Random, size: f64, jumps: bool| {
            let mut drive = PlainDrive::random(random, size, jumps);
            if coarse {
                drive.constant = round(drive.constant);
                for (time, value) in &mut drive.points {
                    (*time, *value) = (round(*time), round(*value));
                }
                drive.points.dedup();
            }
            drive
        };
        let mut mass = DMatrix::from_fn(n, n, |i, j| {
            let diagonal = number(random, 0.4, 2.5);
            if i == j { diagonal } else { 0.0 }
        });
        if random.bits().is_multiple_of(2) {
            let part = DMatrix::from_fn(n, n, |_, _| round(random.uniform(-1.0, 1.0)));
            mass += &part * part.transpose();
        }
        let (mut stiffness, mut damping) = (DMatrix::zeros(n, n), DMatrix::zeros(n, n));
        for i in 0..n {
            if !random.bits().is_multiple_of(4) {
                stiffness[(i, i)] += number(random, 0.3, 2.0);
                damping[(i, i)] += random.uniform(0.0, 0.2);
            }
            for j in 0..i {
                if random.bits().is_multiple_of(3) {
                    connect(&mut stiffness, i, j, number(random, 0.1, 1.5));
                    connect(&mut damping, i, j, random.uniform(0.0, 0.1));
                }
            }
        }
        let forces = (0..n).map(|_| match random.bits() % 3 {
            0 => drive(random, 1.0, true),
            _ => PlainDrive::default(),
        });
        let forces = forces.collect();
        let mut contacts = Vec::new();
        for _ in 0..1 + random.bits() % 6 {
            let [i, j] = [0; 2].map(|_| (random.bits() % n as u64) as usize);
            let direction = match random.bits() % 4 {
                0 => unit(n, i),
                1 => DVector::from_fn(n, |_, _| 0.5 + number(random, 0.0, 1.0)),
                _ if i == j => unit(n, i),
                _ => unit(n, i) - unit(n, j),
            };
            let base = number(random, 0.3, 2.0);
            let mut load = PlainDrive::constant(base);
            let mut gradient = vec![0.0; n];
            match random.bits() % 6 {
                // May open.
                0 => {
                    load = drive(random, base, true);
                    load.constant = 0.6 * base;
                    let harmonic = [0.5 * base, random.logarithmic(0.2, 2.0), 0.0];
                    load.harmonics.push(harmonic);
                }
                1 => gradient[i] = base * random.uniform(-0.4, 0.4),
                _ => {}
            }
            let belt = match random.bits() % 6 {
                0 => PlainDrive::random(random, 0.5, false),
                1 | 2 => PlainDrive::constant(random.sign() * number(random, 0.05, 0.8)),
                _ => PlainDrive::default(),
            };
            let law = match random.bits() % 4 {
                0 => any_law(random),
                k => {
                    let kinetic = number(random, 0.2, 0.6);
                    // Equal limits in one case of three.
                    let fall = number(random, 0.02, 0.4) * f64::from(u8::from(k > 1));
                    Coulomb::new(kinetic + fall, kinetic).unwrap().into()
                }
            };
            contacts.push(PlainContact {
                direction,
                law,
                load,
                gradient,
                laws: Vec::new(),
                belt,
            });
        }
        Self {
            mass,
            stiffness,
            damping,
            forces,
            contacts,
            elements: Vec::new(),
            states: 0,
            stops: Vec::new(),
        }
    }

    /// A start in which a few contacts are at rest, or all masses.
    pub fn start_at_rest(&self, random: &mut Random) -> State {
        let n = self.len();
        let scale = random.pick(&[0.0, 0.5, 1.0]);
        let q: Vec<f64> = (0..n).map(|_| scale * random.uniform(-1.0, 1.0)).collect();
        let scale = random.pick(&[0.0, 1.0, 1.0]);
        let mut v = DVector::from_fn(n, |_, _| scale * random.uniform(-1.0, 1.0));
        let mut rest = Vec::new();
        for c in 0..self.contacts.len() {
            let with_it: Vec<usize> = rest.iter().copied().chain([c]).collect();
            let rows = self.rows(&with_it);
            let is_independent = is_definite(&(&rows * rows.transpose()));
            if random.bits().is_multiple_of(2) && is_independent {
                rest = with_it;
            }
        }
        let rows = self.rows(&rest);
        let belts = rest
            .iter()
            .map(|&c| self.contacts[c].belt.at(0.0, false)[0]);
        let apart = &rows * &v - DVector::from_vec(belts.collect());
        if let Some(inverse) = (&rows * rows.transpose()).try_inverse() {
            v -= rows.transpose() * inverse * apart;
        }
        State::new(&q, v.as_slice())
    }

    /// Whether every contact is at rest to the bit at the start, or surely not: what is at rest but
    /// for rounding comes to rest a moment later, and until then others decide as if it slid.
    pub fn is_clear(&self, start: &State) -> bool {
        let structure = self.structure();
        let mut belts = std::iter::zip(structure.contacts(), &self.contacts);
        // Sums of harmonics may be rounded in another order.
        let are_same = belts
            .all(|(made, plain)| made.belt_velocity().value(0.0) == plain.belt.at(0.0, false)[0]);
        are_same && self.starts(start).all(|r| r == 0.0 || r.abs() > 1e-9)
    }

    /// The number of contacts that are at rest at the start.
    pub fn resting(&self, start: &State) -> usize {
        self.starts(start).filter(|r| *r == 0.0).count()
    }

    /// The relative velocities of the contacts at the start.
    fn starts(&self, start: &State) -> impl Iterator<Item = f64> {
        let v = DVector::from_column_slice(&start.velocities);
        (0..self.contacts.len()).map(move |c| self.sliding(c, 0.0, &v))
    }

    /// The same with one to three force elements.
    pub fn with_elements(mut self, random: &mut Random) -> Self {
        let n = self.len();
        for _ in 0..=random.bits() % 3 {
            let i = (random.bits() % n as u64) as usize;
            let direction = match random.bits() % 2 {
                0 => unit(n, i),
                _ => DVector::from_fn(n, |_, _| random.uniform(-1.0, 1.0)),
            };
            let kind = (random.bits() % Random::FORCES as u64) as usize;
            let (stiffness, length) = (random.uniform(0.2, 2.0), random.uniform(0.5, 2.0));
            let mut factor = PlainDrive::random(random, 0.3, false);
            factor.constant = 1.0;
            self.elements.push(PlainElement {
                direction,
                law: random.any_force(kind, stiffness, length),
                factor,
            });
        }
        self
    }

    /// The same with one to three first-order states.
    pub fn with_states(mut self, random: &mut Random) -> Self {
        let n = self.len();
        let r = 1 + (random.bits() % 3) as usize;
        let all = n + r;
        let mut entry = |size: f64| match random.bits() % 3 {
            0 => 0.0,
            _ => random.uniform(-size, size),
        };
        self.mass = self.mass.resize(all, all, 0.0);
        self.stiffness = self.stiffness.resize(all, all, 0.0);
        self.damping = self.damping.resize(all, all, 0.0);
        for k in n..all {
            self.mass[(k, k)] = 1.0;
            for j in 0..n {
                self.stiffness[(k, j)] = entry(1.0);
                self.damping[(k, j)] = entry(1.0);
                self.damping[(j, k)] = entry(0.5);
            }
            for l in n..all {
                self.damping[(k, l)] = entry(0.5);
            }
            self.damping[(k, k)] += 1.0;
        }
        for contact in &mut self.contacts {
            contact.direction = contact.direction.clone().resize_vertically(all, 0.0);
            contact.gradient.resize(all, 0.0);
        }
        for element in &mut self.elements {
            element.direction = element.direction.clone().resize_vertically(all, 0.0);
        }
        for stop in &mut self.stops {
            stop.inward = stop.inward.clone().resize_vertically(all, 0.0);
        }
        for _ in 0..r {
            self.forces.push(PlainDrive::random(random, 0.3, true));
        }
        self.states = r;
        self
    }

    /// The start of its structure: velocities of the coordinates that stand for first-order states
    /// are these states.
    pub fn state(&self, start: &State) -> State {
        if self.states == 0 {
            return start.clone();
        }
        let n = self.len() - self.states;
        State::new(&start.displacements[..n], &start.velocities[..n])
            .with_memory(&start.velocities[n..])
    }

    /// First-order state k.
    fn first_order(&self, k: usize) -> FirstOrder {
        let n = self.len() - self.states;
        let mut state = FirstOrder::integrator();
        for j in 0..n {
            state = state
                .with_displacement(j, -self.stiffness[(n + k, j)])
                .and_then(|s| s.with_velocity(j, -self.damping[(n + k, j)]))
                .and_then(|s| s.with_force(j, -self.damping[(j, n + k)]))
                .unwrap();
        }
        for l in 0..self.states {
            state = state.with_state(l, -self.damping[(n + k, n + l)]).unwrap();
        }
        state.with_drive(self.forces[n + k].drive()).unwrap()
    }

    /// One to three stops, in any direction.
    pub fn with_stops(mut self, random: &mut Random) -> Self {
        let n = self.len();
        for _ in 0..=random.bits() % 3 {
            let [i, j] = [0; 2].map(|_| (random.bits() % n as u64) as usize);
            let inward = match random.bits() % 3 {
                0 => unit(n, i) * random.sign(),
                1 if i != j => unit(n, i) - unit(n, j),
                _ => DVector::from_fn(n, |_, _| random.uniform(-1.0, 1.0)),
            };
            self.stops.push(PlainStop {
                inward,
                gap: random.uniform(-0.2, 0.6),
                stiffness: random.logarithmic(1.0, 100.0),
                damping: random.pick(&[0.0, 1.0, 1.0]) * random.uniform(0.1, 4.0),
                adhesive: random.bits().is_multiple_of(3),
            });
        }
        self
    }

    /// The same with laws in the loads of half of the contacts.
    pub fn with_load_laws(mut self, random: &mut Random) -> Self {
        let n = self.len();
        for contact in &mut self.contacts {
            for _ in 0..random.bits() % 3 {
                let i = (random.bits() % n as u64) as usize;
                let direction = match random.bits() % 2 {
                    0 => unit(n, i),
                    _ => DVector::from_fn(n, |_, _| random.uniform(-1.0, 1.0)),
                };
                let kind = (random.bits() % Random::FORCES as u64) as usize;
                let (stiffness, length) = (random.uniform(0.1, 0.8), random.uniform(0.5, 2.0));
                let law = random.any_force(kind, stiffness, length);
                contact.laws.push((direction, law));
            }
        }
        self
    }

    /// Number of coordinates.
    pub fn len(&self) -> usize {
        self.mass.nrows()
    }

    pub fn structure(&self) -> Structure {
        let n = self.len() - self.states;
        let own = |matrix: &DMatrix<f64>| matrix.view((0, 0), (n, n)).into_owned();
        let mut structure = Structure::with_mass_matrix(own(&self.mass))
            .and_then(|s| s.with_stiffness(own(&self.stiffness)))
            .and_then(|s| s.with_damping(own(&self.damping)))
            .unwrap();
        for (i, force) in self.forces[..n].iter().enumerate() {
            structure = structure.with_force(i, force.drive()).unwrap();
        }
        for contact in &self.contacts {
            let entries = contact.direction.iter().copied().enumerate();
            let direction: Vec<_> = entries.filter(|(_, b)| *b != 0.0).collect();
            let mut made = Contact::along(&direction, contact.law.clone(), contact.load.drive())
                .unwrap()
                .on_belt(contact.belt.drive());
            for (j, &n) in contact.gradient.iter().enumerate() {
                made = made.with_load_gradient(j, n).unwrap();
            }
            for (direction, law) in &contact.laws {
                let direction: Vec<_> = direction.iter().copied().enumerate().collect();
                made = law.clone().press(made, &direction);
            }
            structure = structure.with_contact(made).unwrap();
        }
        for element in &self.elements {
            let direction: Vec<_> = element.direction.iter().copied().enumerate().collect();
            let made = element.law.clone().element(&direction);
            let made = made.with_factor(element.factor.drive()).unwrap();
            structure = structure.with_element(made).unwrap();
        }
        for stop in &self.stops {
            let entries = stop.inward.iter().copied().enumerate();
            let direction: Vec<_> = entries.map(|(j, a)| (j, -a)).collect();
            let made = Stop::along(&direction, stop.gap, 0.0)
                .and_then(|made| made.with_contact_stiffness(stop.stiffness, stop.damping))
                .unwrap();
            let made = if stop.adhesive { made.adhesive() } else { made };
            structure = structure.with_stop(made).unwrap();
        }
        let states = (0..self.states).map(|k| self.first_order(k));
        structure.with_first_orders(states).unwrap()
    }

    /// The rows b of some contacts.
    pub fn rows(&self, contacts: &[usize]) -> DMatrix<f64> {
        DMatrix::from_fn(contacts.len(), self.len(), |c, j| {
            self.contacts[contacts[c]].direction[j]
        })
    }

    /// Times where pieces of drives meet.
    fn breaks(&self) -> Vec<f64> {
        let of_contacts = self.contacts.iter().flat_map(|c| [&c.load, &c.belt]);
        let drives = self.forces.iter().chain(of_contacts);
        let mut times: Vec<f64> = drives.flat_map(|d| d.points.iter().map(|p| p.0)).collect();
        times.sort_by(f64::total_cmp);
        times.dedup();
        times
    }
}

/// What a contact does: slips to a side, sticks, or is open.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Does {
    Slip(f64),
    Stick,
    Open,
}

/// Time, contact, a letter (s: stick, r: release, x: crossing, o: open, c: close, u: dependent
/// contacts stick together), and the side of the slip after a release or a crossing.
pub type Seen = (f64, usize, char, f64);

impl Plain {
    /// The load of each contact.
    pub fn loads(&self, t: f64, [q, v]: [&DVector<f64>; 2], before: bool) -> Vec<f64> {
        let load = |contact: &PlainContact| {
            let gradient: f64 = contact.gradient.iter().zip(q).map(|(n, q)| n * q).sum();
            let laws = contact.laws.iter();
            let laws = laws.map(|(a, law)| law.at(a.dot(q), a.dot(v)));
            contact.load.at(t, before)[0] + gradient + laws.sum::<f64>()
        };
        self.contacts.iter().map(load).collect()
    }

    /// The relative velocity of a contact.
    pub fn sliding(&self, c: usize, t: f64, v: &DVector<f64>) -> f64 {
        let contact = &self.contacts[c];
        contact.direction.dot(v) - contact.belt.at(t, false)[0]
    }
}

/// Equations of motion with the modes of all contacts.
pub struct Simple<'p> {
    plain: &'p Plain,
    /// M⁻¹.
    inverse: DMatrix<f64>,
    does: Vec<Does>,
    /// True for each stop that is closed.
    closed: Vec<bool>,
    /// The contacts that stick, M⁻¹B_Sᵀ, and the inverse of B_S M⁻¹B_Sᵀ.
    stuck: Vec<usize>,
    responses: DMatrix<f64>,
    holds: DMatrix<f64>,
    t: f64,
    q: DVector<f64>,
    v: DVector<f64>,
    seen: Vec<Seen>,
}

impl<'p> Simple<'p> {
    pub fn new(plain: &'p Plain, start: &State) -> Self {
        Self {
            plain,
            inverse: plain.mass.clone().try_inverse().unwrap(),
            does: vec![Does::Open; plain.contacts.len()],
            closed: vec![false; plain.stops.len()],
            stuck: vec![],
            responses: DMatrix::zeros(plain.len(), 0),
            holds: DMatrix::zeros(0, 0),
            t: 0.0,
            q: DVector::from_column_slice(&start.displacements),
            v: DVector::from_column_slice(&start.velocities),
            seen: vec![],
        }
    }

    /// Sets the modes; false if contacts that stick are dependent.
    pub fn set(&mut self, does: Vec<Does>) -> bool {
        let contacts = 0..does.len();
        self.stuck = contacts.filter(|&c| does[c] == Does::Stick).collect();
        self.does = does;
        let rows = self.plain.rows(&self.stuck);
        self.responses = &self.inverse * rows.transpose();
        let compliance = &rows * &self.responses;
        if !is_definite(&compliance) {
            return false;
        }
        if !self.stuck.is_empty() {
            self.holds = compliance.try_inverse().unwrap();
        }
        true
    }

    /// dv/dt and what each contact carries; `before`: of the piece of the drives that ends at t.
    pub fn rates(
        &self,
        t: f64,
        q: &DVector<f64>,
        v: &DVector<f64>,
        before: bool,
    ) -> (DVector<f64>, Vec<f64>) {
        let plain = self.plain;
        let mut force = -&plain.damping * v - &plain.stiffness * q;
        for (force, drive) in force.iter_mut().zip(&plain.forces) {
            *force += drive.at(t, before)[0];
        }
        for element in &plain.elements {
            let (x, y) = (element.direction.dot(q), element.direction.dot(v));
            let factor = element.factor.at(t, before)[0];
            force -= &element.direction * (factor * element.law.at(x, y));
        }
        for (stop, closed) in plain.stops.iter().zip(&self.closed) {
            if *closed {
                force -= &stop.inward * stop.pressure(q, v)[1];
            }
        }
        let loads = plain.loads(t, [q, v], before);
        let mut carried = vec![0.0; loads.len()];
        for (c, contact) in plain.contacts.iter().enumerate() {
            if let Does::Slip(side) = self.does[c] {
                let r = contact.direction.dot(v) - contact.belt.at(t, before)[0];
                carried[c] = side * loads[c] * contact.law.kinetic((side * r).max(0.0));
                force -= &contact.direction * carried[c];
            }
        }
        let mut rates = &self.inverse * force;
        let pulls = self.stuck.iter().map(|&c| {
            let contact = &plain.contacts[c];
            contact.direction.dot(&rates) - contact.belt.at(t, before)[1]
        });
        if !self.stuck.is_empty() {
            let held = &self.holds * DVector::from_iterator(self.stuck.len(), pulls);
            rates -= &self.responses * &held;
            for (&c, held) in self.stuck.iter().zip(&held) {
                carried[c] = *held;
            }
        }
        (rates, carried)
    }

    /// The state a step later, within one piece of all drives.
    fn after(&self, h: f64) -> (DVector<f64>, DVector<f64>) {
        let (t, q, v) = (self.t, &self.q, &self.v);
        let a = (v.clone(), self.rates(t, q, v, false).0);
        let at = |k: &(DVector<f64>, DVector<f64>), h: f64, before| {
            let (q, v) = (q + &k.0 * h, v + &k.1 * h);
            let rates = self.rates(t + h, &q, &v, before).0;
            (v, rates)
        };
        let b = at(&a, 0.5 * h, false);
        let c = at(&b, 0.5 * h, false);
        let d = at(&c, h, true);
        (
            q + (a.0 + b.0 * 2.0 + c.0 * 2.0 + d.0) * (h / 6.0),
            v + (a.1 + b.1 * 2.0 + c.1 * 2.0 + d.1) * (h / 6.0),
        )
    }

    /// Contacts whose mode ends within a step.
    fn due(&self, h: f64) -> Vec<usize> {
        let (q, v) = self.after(h);
        let t = self.t + h;
        let loads = self.plain.loads(t, [&q, &v], true);
        let (_, carried) = self.rates(t, &q, &v, true);
        let due = |c: &usize| {
            let contact = &self.plain.contacts[*c];
            let load = loads[*c];
            match self.does[*c] {
                Does::Open => load > 0.0,
                _ if load < 0.0 => true,
                Does::Slip(side) => {
                    side * (contact.direction.dot(&v) - contact.belt.at(t, true)[0]) < 0.0
                }
                Does::Stick => carried[*c].abs() > load * contact.law.static_coefficient(),
            }
        };
        let contacts = (0..self.does.len()).filter(due);
        let stops = self.plain.stops.iter().zip(&self.closed).enumerate();
        let stops = stops.filter(|(_, (stop, closed))| stop.is_due(**closed, &q, &v));
        contacts.chain(stops.map(|(k, _)| STOPS + k)).collect()
    }

    /// Contacts that stick keep the velocity of their belts.
    fn hold(&mut self) {
        if self.stuck.is_empty() {
            return;
        }
        let apart = self
            .stuck
            .iter()
            .map(|&c| self.plain.sliding(c, self.t, &self.v));
        let apart = DVector::from_iterator(self.stuck.len(), apart);
        self.v -= &self.responses * &self.holds * apart;
    }

    /// What contacts do from now on of which some are due: all at rest decide together. False where
    /// one separates, or contacts that stick are dependent.
    fn change(&mut self, due: &[usize]) -> bool {
        let plain = self.plain;
        for (k, stop) in plain.stops.iter().enumerate() {
            if due.contains(&(STOPS + k)) && stop.is_due(self.closed[k], &self.q, &self.v) {
                self.closed[k] = !self.closed[k];
                let letter = if self.closed[k] { 'c' } else { 'o' };
                self.seen.push((self.t, STOPS + k, letter, 0.0));
            }
        }
        let due: Vec<usize> = due.iter().copied().filter(|&c| c < STOPS).collect();
        let was = self.does.clone();
        let loads = plain.loads(self.t, [&self.q, &self.v], false);
        let mut does = was.clone();
        for c in due {
            let r = plain.sliding(c, self.t, &self.v);
            does[c] = match was[c] {
                // The belt's velocity as the crate rounds it.
                Does::Open if loads[c] > 0.0 && r.abs() > 1e-14 => Does::Slip(r.signum()),
                Does::Open if loads[c] > 0.0 => Does::Stick,
                _ if loads[c] < 1e-9 => Does::Open,
                _ => Does::Stick,
            };
        }
        // Those at rest, exactly so.
        let resting: Vec<usize> = (0..does.len())
            .filter(|&c| does[c] == Does::Stick)
            .collect();
        let independent = self.set(does.clone());
        if independent {
            self.hold();
        }
        // Then they decide.
        let rows = plain.rows(&resting);
        let free: Vec<Does> = does
            .iter()
            .map(|does| {
                if *does == Does::Stick {
                    Does::Open
                } else {
                    *does
                }
            })
            .collect();
        self.set(free);
        let (rates, _) = self.rates(self.t, &self.q, &self.v, false);
        let belts = resting
            .iter()
            .map(|&c| plain.contacts[c].belt.at(self.t, false)[1]);
        let limits = |coefficient: &dyn Fn(&AnyLaw) -> f64| -> Vec<[f64; 2]> {
            let limit = |&c: &usize| [loads[c] * coefficient(&plain.contacts[c].law); 2];
            resting.iter().map(limit).collect()
        };
        let question = Question {
            compliance: &rows * &self.inverse * rows.transpose(),
            free: &rows * rates - DVector::from_iterator(resting.len(), belts),
            limits: limits(&|law| law.static_coefficient()),
            kinetic: limits(&|law| law.kinetic(0.0)),
        };
        let Some((pattern, _)) = question.fastest_first() else {
            self.seen.push((self.t, 0, 'u', 0.0));
            return false;
        };
        for (&c, mode) in resting.iter().zip(pattern) {
            does[c] = match mode {
                0 => Does::Stick,
                side => Does::Slip(f64::from(side)),
            };
        }
        for (c, (was, now)) in was.iter().zip(&does).enumerate() {
            let event = match (was, now) {
                (Does::Open, Does::Open) | (Does::Stick, Does::Stick) => continue,
                (_, Does::Open) => ('o', 0.0),
                (Does::Open, _) => ('c', 0.0),
                (Does::Slip(_), Does::Stick) => ('s', 0.0),
                (Does::Stick, Does::Slip(side)) => ('r', *side),
                (Does::Slip(from), Does::Slip(to)) if from != to => ('x', *to),
                (Does::Slip(_), Does::Slip(_)) => continue,
            };
            self.seen.push((self.t, c, event.0, event.1));
            let contact = &plain.contacts[c];
            let depends = contact.laws.is_empty() && contact.gradient.iter().any(|n| *n != 0.0);
            if event.0 == 'o' && depends {
                return false;
            }
        }
        if !self.set(does) {
            self.seen.push((self.t, 0, 'u', 0.0));
            return false;
        }
        true
    }
}

impl Plain {
    /// The events of a motion over a time; an `o` of a load that depends on displacements is its
    /// end.
    pub fn events(&self, start: &State, duration: f64, step: f64) -> Vec<Seen> {
        let mut simple = Simple::new(self, start);
        let stops = STOPS..STOPS + self.stops.len();
        let all: Vec<usize> = (0..self.contacts.len()).chain(stops).collect();
        let goes_on = simple.change(&all);
        // At the start nothing changes, but for what cannot go on.
        simple.seen.retain(|seen| seen.2 == 'u');
        if !goes_on {
            return simple.seen;
        }
        let breaks = self.breaks();
        while simple.t < duration {
            let t = simple.t;
            // At a break the drives may have jumped: what sticks is asked anew, and so are loads.
            if breaks.contains(&t) {
                let loads = self.loads(t, [&simple.q, &simple.v], false);
                let due: Vec<usize> = (0..self.contacts.len())
                    .filter(|&c| match simple.does[c] {
                        Does::Stick => true,
                        Does::Slip(_) => loads[c] < 0.0,
                        Does::Open => loads[c] > 0.0,
                    })
                    .collect();
                if !simple.change(&due) {
                    return simple.seen;
                }
            }
            let next = breaks.iter().copied().find(|time| *time > t);
            let end = next.unwrap_or(f64::INFINITY).min(duration);
            let h = step.min(end - t);
            let mut due = simple.due(h);
            if due.is_empty() {
                (simple.q, simple.v) = simple.after(h);
                simple.t = if h == end - t { end } else { t + h };
                simple.hold();
                continue;
            }
            let (mut no, mut yes) = (0.0, h);
            // Far enough beyond the limit that rounding does not decide.
            while yes - no > 1e-11 {
                let middle = 0.5 * (no + yes);
                let found = simple.due(middle);
                if found.is_empty() {
                    no = middle;
                } else {
                    (yes, due) = (middle, found);
                }
            }
            (simple.q, simple.v) = simple.after(yes);
            simple.t += yes;
            simple.hold();
            if !simple.change(&due) {
                return simple.seen;
            }
            if simple.seen.len() > 500 {
                break;
            }
        }
        simple.seen
    }
}
