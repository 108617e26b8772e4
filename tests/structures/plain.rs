//! Random structures in plain numbers, and a deliberately simple integrator for them, which shares
//! no idea and no code with the crate: fixed Runge-Kutta steps, events by bisection.

use stick_slip::structure::State;
use stick_slip::{
    AnyLaw, Contact, Coulomb, Drive, Exponential, FrictionLaw, Polynomial, Rational, Stribeck,
    Structure, Tabulated,
};

use crate::common::Random;

/// constant + Σ a cos(Ωt + φ) + straight lines through points.
#[derive(Debug, Clone, Default)]
pub(crate) struct PlainDrive {
    pub(crate) constant: f64,
    pub(crate) harmonics: Vec<[f64; 3]>,
    pub(crate) points: Vec<(f64, f64)>,
}

impl PlainDrive {
    fn at(&self, t: f64, before: bool) -> [f64; 2] {
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

    /// Of any kind, about as large as `size`.
    fn random(random: &mut Random, size: f64, jumps: bool) -> Self {
        let mut drive = Self {
            constant: size * random.uniform(-1.0, 1.0),
            ..Self::default()
        };
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
pub(crate) struct PlainContact {
    pub(crate) coordinate: usize,
    pub(crate) law: AnyLaw,
    pub(crate) load: PlainDrive,
    pub(crate) gradient: Vec<f64>,
    pub(crate) belt: PlainDrive,
}

#[derive(Debug, Clone)]
pub(crate) struct Plain {
    pub(crate) masses: Vec<f64>,
    pub(crate) stiffness: Vec<Vec<f64>>,
    pub(crate) damping: Vec<Vec<f64>>,
    pub(crate) forces: Vec<PlainDrive>,
    pub(crate) contacts: Vec<PlainContact>,
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
    pub(crate) fn random(random: &mut Random) -> Self {
        let n = 1 + (random.bits() % 4) as usize;
        let mut stiffness = vec![vec![0.0; n]; n];
        let mut damping = stiffness.clone();
        for i in 0..n {
            stiffness[i][i] += random.uniform(0.3, 2.0);
            damping[i][i] += random.uniform(0.0, 0.3);
            for j in 0..i {
                if random.bits().is_multiple_of(2) {
                    let (k, c) = (random.uniform(0.1, 1.5), random.uniform(0.0, 0.1));
                    for (matrix, value) in [(&mut stiffness, k), (&mut damping, c)] {
                        matrix[i][i] += value;
                        matrix[j][j] += value;
                        matrix[i][j] -= value;
                        matrix[j][i] -= value;
                    }
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
            let mut load = PlainDrive {
                constant: base,
                ..PlainDrive::default()
            };
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
                1 => PlainDrive {
                    constant: random.sign() * random.logarithmic(0.03, 1.0),
                    ..PlainDrive::default()
                },
                _ => PlainDrive::default(),
            };
            contacts.push(PlainContact {
                coordinate: i,
                law: any_law(random),
                load,
                gradient,
                belt,
            });
        }
        Self {
            masses: (0..n).map(|_| random.logarithmic(0.3, 3.0)).collect(),
            stiffness,
            damping,
            forces,
            contacts,
        }
    }

    /// A start; sometimes with masses that move with their belts.
    pub(crate) fn start(&self, random: &mut Random) -> State {
        let n = self.masses.len();
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

    pub(crate) fn structure(&self) -> Structure {
        let n = self.masses.len();
        let matrix =
            |rows: &[Vec<f64>]| stick_slip::nalgebra::DMatrix::from_fn(n, n, |i, j| rows[i][j]);
        let mut structure = Structure::new(&self.masses)
            .and_then(|s| s.with_stiffness(matrix(&self.stiffness)))
            .and_then(|s| s.with_damping(matrix(&self.damping)))
            .unwrap();
        for (i, force) in self.forces.iter().enumerate() {
            structure = structure.with_force(i, force.drive()).unwrap();
        }
        for contact in &self.contacts {
            let mut made = Contact::new(
                contact.coordinate,
                contact.law.clone(),
                contact.load.drive(),
            )
            .unwrap()
            .on_belt(contact.belt.drive());
            for (j, &n) in contact.gradient.iter().enumerate() {
                made = made.with_load_gradient(j, n).unwrap();
            }
            structure = structure.with_contact(made).unwrap();
        }
        structure
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
enum Does {
    Slip(f64),
    Stick,
    Open,
}

/// Time, contact, a letter (s: stick, r: release, x: crossing, o: open, c: close), and the side of
/// the slip after a release or a crossing.
pub(crate) type Seen = (f64, usize, char, f64);

/// A motion that is followed.
struct Simple<'p> {
    plain: &'p Plain,
    does: Vec<Does>,
    t: f64,
    q: Vec<f64>,
    v: Vec<f64>,
    seen: Vec<Seen>,
}

impl Simple<'_> {
    fn load(&self, contact: &PlainContact, t: f64, q: &[f64], before: bool) -> f64 {
        let gradient: f64 = contact.gradient.iter().zip(q).map(|(n, q)| n * q).sum();
        contact.load.at(t, before)[0] + gradient
    }

    /// Force on a coordinate without that of its contact.
    fn force(&self, i: usize, t: f64, q: &[f64], v: &[f64], before: bool) -> f64 {
        let plain = self.plain;
        let row = |m: &[Vec<f64>], x: &[f64]| m[i].iter().zip(x).map(|(m, x)| m * x).sum::<f64>();
        plain.forces[i].at(t, before)[0] - row(&plain.damping, v) - row(&plain.stiffness, q)
    }

    fn carried(&self, contact: &PlainContact, t: f64, q: &[f64], v: &[f64], before: bool) -> f64 {
        let i = contact.coordinate;
        let slope = contact.belt.at(t, before)[1];
        self.force(i, t, q, v, before) - self.plain.masses[i] * slope
    }

    /// dv/dt; `before`: of the piece of the drives that ends at t.
    fn rates(&self, t: f64, q: &[f64], v: &[f64], before: bool) -> Vec<f64> {
        let mut rates: Vec<f64> = (0..q.len())
            .map(|i| self.force(i, t, q, v, before))
            .collect();
        for (contact, does) in self.plain.contacts.iter().zip(&self.does) {
            let i = contact.coordinate;
            if let Does::Slip(side) = does {
                let speed = (side * (v[i] - contact.belt.at(t, before)[0])).max(0.0);
                let coefficient = side * contact.law.kinetic(speed);
                rates[i] -= self.load(contact, t, q, before) * coefficient;
            }
        }
        for (rate, mass) in rates.iter_mut().zip(&self.plain.masses) {
            *rate /= mass;
        }
        for (contact, does) in self.plain.contacts.iter().zip(&self.does) {
            if *does == Does::Stick {
                rates[contact.coordinate] = contact.belt.at(t, before)[1];
            }
        }
        rates
    }

    /// The state a step later, within one piece of all drives.
    fn after(&self, h: f64) -> (Vec<f64>, Vec<f64>) {
        let moved = |x: &[f64], k: &[f64], h: f64| -> Vec<f64> {
            x.iter().zip(k).map(|(x, k)| x + h * k).collect()
        };
        let (t, q, v) = (self.t, &self.q, &self.v);
        let a = (v.clone(), self.rates(t, q, v, false));
        let at = |k: &(Vec<f64>, Vec<f64>), h: f64, before| {
            let (q, v) = (moved(q, &k.0, h), moved(v, &k.1, h));
            let rates = self.rates(t + h, &q, &v, before);
            (v, rates)
        };
        let b = at(&a, 0.5 * h, false);
        let c = at(&b, 0.5 * h, false);
        let d = at(&c, h, true);
        let sum = |x: &[f64], [a, b, c, d]: [&[f64]; 4]| -> Vec<f64> {
            (0..x.len())
                .map(|i| x[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]))
                .collect()
        };
        (
            sum(q, [&a.0, &b.0, &c.0, &d.0]),
            sum(v, [&a.1, &b.1, &c.1, &d.1]),
        )
    }

    /// Contacts whose mode ends within a step.
    fn due(&self, h: f64) -> Vec<usize> {
        let (q, v) = self.after(h);
        let t = self.t + h;
        let due = |(contact, does): (&PlainContact, &Does)| {
            let load = self.load(contact, t, &q, true);
            match does {
                Does::Open => load > 0.0,
                _ if load < 0.0 => true,
                Does::Slip(side) => {
                    side * (v[contact.coordinate] - contact.belt.at(t, true)[0]) < 0.0
                }
                Does::Stick => {
                    self.carried(contact, t, &q, &v, true).abs()
                        > load * contact.law.static_coefficient()
                }
            }
        };
        let contacts = self.plain.contacts.iter().zip(&self.does).enumerate();
        contacts
            .filter(|(_, pair)| due(*pair))
            .map(|(c, _)| c)
            .collect()
    }

    fn go(&mut self, h: f64) {
        (self.q, self.v) = self.after(h);
        self.t += h;
        self.hold();
    }

    /// Contacts that stick keep the velocity of their belts.
    fn hold(&mut self) {
        for (contact, does) in self.plain.contacts.iter().zip(&self.does) {
            if *does == Does::Stick {
                self.v[contact.coordinate] = contact.belt.at(self.t, false)[0];
            }
        }
    }

    /// What a contact with r = 0 does.
    fn decide(&self, contact: &PlainContact) -> Does {
        let load = self.load(contact, self.t, &self.q, false);
        let carried = self.carried(contact, self.t, &self.q, &self.v, false);
        if carried.abs() > load * contact.law.static_coefficient() {
            Does::Slip(carried.signum())
        } else {
            Does::Stick
        }
    }

    /// Changes the mode of a contact that is due; false where it separates.
    fn change(&mut self, c: usize) -> bool {
        let contact = &self.plain.contacts[c];
        let i = contact.coordinate;
        let load = self.load(contact, self.t, &self.q, false);
        let event = match self.does[c] {
            Does::Open => {
                let r = self.v[i] - contact.belt.at(self.t, false)[0];
                // Far from the belt it slips; r = 0 by chance is too close to call.
                self.does[c] = Does::Slip(r.signum());
                ('c', 0.0)
            }
            _ if load.abs() < 1e-9 || load < 0.0 => {
                self.does[c] = Does::Open;
                ('o', 0.0)
            }
            was => {
                if let Does::Slip(_) = was {
                    self.v[i] = contact.belt.at(self.t, false)[0];
                }
                let carried = self.carried(contact, self.t, &self.q, &self.v, false);
                let now = match was {
                    Does::Stick => Does::Slip(carried.signum()),
                    _ => self.decide(contact),
                };
                self.does[c] = now;
                match (was, now) {
                    (Does::Stick, Does::Slip(side)) => ('r', side),
                    (_, Does::Slip(side)) => ('x', side),
                    _ => ('s', 0.0),
                }
            }
        };
        self.seen.push((self.t, c, event.0, event.1));
        event.0 != 'o' || contact.gradient.iter().all(|n| *n == 0.0)
    }
}

impl Plain {
    /// The events of a motion over a time; an `o` of a load that depends on displacements is its
    /// end.
    pub(crate) fn events(&self, start: &State, duration: f64, step: f64) -> Vec<Seen> {
        let mut simple = Simple {
            plain: self,
            does: vec![Does::Stick; self.contacts.len()],
            t: 0.0,
            q: start.displacements.clone(),
            v: start.velocities.clone(),
            seen: vec![],
        };
        for (c, contact) in self.contacts.iter().enumerate() {
            let r = simple.v[contact.coordinate] - contact.belt.at(0.0, false)[0];
            let load = simple.load(contact, 0.0, &simple.q, false);
            // The belt's velocity as the crate rounds it.
            let together = r.abs() < 1e-14;
            simple.does[c] = if load <= 0.0 {
                Does::Open
            } else if together {
                simple.decide(contact)
            } else {
                Does::Slip(r.signum())
            };
        }
        let breaks = self.breaks();
        while simple.t < duration {
            let t = simple.t;
            // At a break the drives may have jumped: what sticks is asked anew, and so are loads.
            if breaks.contains(&t) {
                for c in 0..self.contacts.len() {
                    let contact = &self.contacts[c];
                    let load = simple.load(contact, t, &simple.q, false);
                    let due = match simple.does[c] {
                        Does::Stick => load < 0.0 || simple.decide(contact) != Does::Stick,
                        Does::Slip(_) => load < 0.0,
                        Does::Open => load > 0.0,
                    };
                    if due && !simple.change(c) {
                        return simple.seen;
                    }
                }
            }
            let next = breaks.iter().copied().find(|time| *time > t);
            let end = next.unwrap_or(f64::INFINITY).min(duration);
            let h = step.min(end - t);
            let mut due = simple.due(h);
            if due.is_empty() {
                simple.go(h);
                if h == end - t {
                    simple.t = end;
                }
                continue;
            }
            let (mut no, mut yes) = (0.0, h);
            for _ in 0..50 {
                let middle = 0.5 * (no + yes);
                let found = simple.due(middle);
                if found.is_empty() {
                    no = middle;
                } else {
                    (yes, due) = (middle, found);
                }
            }
            simple.go(yes);
            for c in due {
                if !simple.change(c) {
                    return simple.seen;
                }
            }
            if simple.seen.len() > 500 {
                break;
            }
        }
        simple.seen
    }
}
