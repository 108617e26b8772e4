//! A mass on bristles in plain numbers, and an implicit integrator for it that shares nothing with
//! the crate's: Radau IIA, steps checked by their halves, one side of r = 0 at a time.

use stick_slip::structure::State;
use stick_slip::{
    Contact, ContactLaw, Dahl, Error, Exponential, Integrator, LuGre, Motion, Scalar, Segment,
    Slip, Stribeck, Structure,
};

use crate::larger;
use crate::radau::{Matrix, STAGES, solve, weights};
use crate::{Random, memory_stays, one_mass};

/// LuGre's bristles in plain numbers, with a damping that fades with speed and a bump in g if one
/// likes:
///
/// ```text
/// z' = r − σ0 |r| z/g(|r|),   μ = σ0 z + σ1 exp(−(r/v_d)²) z' + σ2 r
/// g(s) = μ_c + (μ_s − μ_c) exp(−(s/v_s)^δ) + b exp(−((s − s_b)/w)²)
/// ```
#[derive(Debug, Clone)]
pub struct Bristles {
    pub stiffness: f64,
    pub damping: f64,
    pub viscous: f64,
    /// 1/v_d.
    pub fading: f64,
    pub limit: f64,
    pub least: f64,
    pub stribeck: f64,
    pub exponent: u32,
    /// b, s_b, w.
    pub bump: [f64; 3],
}

impl Bristles {
    fn rate<S: Scalar>(&self, slip: Slip<S>, z: S) -> S {
        let s = slip.speed;
        let ratio = s / self.stribeck;
        let ratio = if self.exponent == 2 {
            ratio * ratio
        } else {
            ratio
        };
        let mut g = (-ratio).exp() * (self.limit - self.least) + self.least;
        let [height, place, width] = self.bump;
        if height != 0.0 {
            let part = (s - place) / width;
            g = g + (-(part * part)).exp() * height;
        }
        (-(z * self.stiffness / g) + slip.direction) * s
    }
}

impl ContactLaw for Bristles {
    type Memory<S: Scalar> = [S; 1];
    fn coefficient<S: Scalar>(&self, slip: Slip<S>, [z]: [S; 1]) -> S {
        let mut damping = self.rate(slip, z) * self.damping;
        if self.fading != 0.0 {
            let part = slip.speed * self.fading;
            damping = damping * (-(part * part)).exp();
        }
        z * self.stiffness + damping + slip.velocity() * self.viscous
    }
    fn limit<S: Scalar>(&self, _: S, _: [S; 1]) -> Option<S> {
        None
    }
    fn rates<S: Scalar>(&self, motion: Motion<S>, _: S, [z]: [S; 1]) -> [S; 1] {
        match motion {
            Motion::Stick => [z.constant(0.0)],
            Motion::Slip(slip) => [self.rate(slip, z)],
        }
    }
    memory_stays!(1);
}

/// One mass on a spring and on bristles.
#[derive(Debug, Clone)]
pub struct Block {
    pub law: Bristles,
    pub mass: f64,
    pub spring: f64,
    pub damper: f64,
    pub load: f64,
    pub belt: f64,
}

/// q, the sliding speed s and z.
type Point = [f64; 3];

/// A speed below all over which a law of these tests changes.
const SLOWEST: f64 = 1e-6;

const SIZE: usize = 3 * STAGES;

/// Where a motion is, step by step.
pub struct Radau<'b> {
    block: &'b Block,
    weights: Matrix,
    tolerance: f64,
    side: f64,
    point: Point,
    h: f64,
    pub crossings: usize,
}

impl<'b> Radau<'b> {
    pub fn new(block: &'b Block, tolerance: f64, start: &State) -> Self {
        let [q, v] = [start.displacements[0], start.velocities[0]];
        let relative = v - block.belt;
        let mut radau = Self {
            block,
            weights: weights(),
            tolerance,
            side: relative.signum(),
            point: [
                q,
                relative.abs(),
                start.memory.first().copied().unwrap_or(0.0),
            ],
            h: 1e-6,
            crossings: 0,
        };
        if relative == 0.0 {
            radau.turn();
            radau.crossings = 0;
        }
        radau
    }

    pub fn state(&self) -> [f64; 3] {
        let [q, s, z] = self.point;
        [q, self.block.belt + self.side * s, z]
    }

    fn law(&self, s: f64, z: f64) -> [f64; 2] {
        let slip = Slip {
            speed: s,
            direction: self.side,
            piece: 0,
        };
        let [rate] = self.block.law.rates(Motion::Slip(slip), 1.0, [z]);
        [self.block.law.coefficient(slip, [z]), rate]
    }

    fn rate(&self, [q, s, z]: Point) -> Point {
        let block = self.block;
        let v = block.belt + self.side * s;
        let [friction, rate] = self.law(s, z);
        let force = -block.spring * q - block.damper * v - block.load * friction;
        [v, self.side * force / block.mass, rate]
    }

    /// ∂rate/∂point, good enough for Newton's method.
    fn jacobian(&self, [_, s, z]: Point, least: f64) -> [Point; 3] {
        let block = self.block;
        let ds = 1e-6 * s.abs().max(least);
        let dz = 1e-6 * z.abs().max(block.law.limit / block.law.stiffness);
        let by =
            |[a, b]: [[f64; 2]; 2], d: f64| [(a[0] - b[0]) / (2.0 * d), (a[1] - b[1]) / (2.0 * d)];
        let by_speed = by([self.law(s + ds, z), self.law(s - ds, z)], ds);
        let by_memory = by([self.law(s, z + dz), self.law(s, z - dz)], dz);
        let of = |force: f64| self.side * force / block.mass;
        [
            [0.0, self.side, 0.0],
            [
                of(-block.spring),
                of(-block.damper * self.side - block.load * by_speed[0]),
                of(-block.load * by_memory[0]),
            ],
            [0.0, by_speed[1], by_memory[1]],
        ]
    }

    /// What errors are measured by.
    fn scales(&self, a: Point, b: Point) -> Point {
        let block = self.block;
        let size = block.load * block.law.limit / block.spring;
        let fast = block.belt.abs() + size * (block.spring / block.mass).sqrt();
        [
            size.max(a[0].abs()),
            a[1].abs().max(b[1].abs()).max(1e-6 * fast),
            block.law.limit / block.law.stiffness,
        ]
    }

    /// What rounding of the forces may do to s.
    fn rounding(&self, [q, _, z]: Point, h: f64) -> f64 {
        let block = self.block;
        let terms = (block.spring * q).abs() + block.load * (block.law.stiffness * z).abs();
        8.0 * f64::EPSILON * terms * h / block.mass
    }

    /// One step, if Newton's method converges; and whether a stage lies beyond r = 0.
    fn step(&self, from: Point, h: f64) -> Option<(Point, bool)> {
        let first = self.rate(from);
        let least = (h * first[1]).abs().max(1e-9 * self.scales(from, from)[1]);
        let mut stages = [from; STAGES];
        let rounding = self.rounding(from, h);
        let mut last = f64::INFINITY;
        for _ in 0..30 {
            let rates = stages.map(|y| self.rate(y));
            let slopes = stages.map(|y| self.jacobian(y, least));
            let mut residual = [0.0; SIZE];
            let mut matrix = [[0.0; SIZE]; SIZE];
            for i in 0..STAGES {
                for a in 0..3 {
                    let sum: f64 = (0..STAGES).map(|j| self.weights[i][j] * rates[j][a]).sum();
                    residual[3 * i + a] = from[a] - stages[i][a] + h * sum;
                    matrix[3 * i + a][3 * i + a] = 1.0;
                    for j in 0..STAGES {
                        for b in 0..3 {
                            matrix[3 * i + a][3 * j + b] -=
                                h * self.weights[i][j] * slopes[j][a][b];
                        }
                    }
                }
            }
            // In one unit.
            let scales = self.scales(from, stages[STAGES - 1]);
            for row in 0..SIZE {
                residual[row] /= scales[row % 3];
                for column in 0..SIZE {
                    matrix[row][column] *= scales[column % 3] / scales[row % 3];
                }
            }
            let correction = solve(matrix, residual);
            let mut change = 0.0_f64;
            for (i, stage) in stages.iter_mut().enumerate() {
                for (a, y) in stage.iter_mut().enumerate() {
                    let d = correction[3 * i + a];
                    *y += d * scales[a];
                    let beyond = if a == 1 { rounding / scales[1] } else { 0.0 };
                    change = change.max((d.abs() - beyond).max(0.0));
                }
            }
            if stages.iter().flatten().any(|y| !y.is_finite()) {
                return None;
            }
            if change <= 1e-15 || (change < 1e-11 && change >= 0.25 * last) {
                // Or near it, between the stages.
                let inner = stages[..STAGES - 1].iter().map(|stage| stage[1]);
                let ends = from[1].min(stages[STAGES - 1][1]);
                let crosses = inner.fold(f64::INFINITY, f64::min) < 0.5 * ends.max(0.0);
                return Some((stages[STAGES - 1], crosses));
            }
            last = change;
        }
        None
    }

    /// Two steps of half the length, and how much one differs from them.
    fn checked(&self, from: Point, h: f64) -> Option<(Point, f64, bool)> {
        let (whole, _) = self.step(from, h)?;
        let (middle, first) = self.step(from, 0.5 * h)?;
        let (end, second) = self.step(middle, 0.5 * h)?;
        let scales = self.scales(from, end);
        let rounding = [0.0, self.rounding(from, h), 0.0];
        let error = (0..3)
            .map(|a| ((whole[a] - end[a]).abs() - rounding[a]).max(0.0) / scales[a])
            .fold(0.0, f64::max);
        // The halves are more exact than the whole by this.
        Some((end, error / 256.0, first || second))
    }

    /// The motion decides on its side at r = 0.
    fn turn(&mut self) {
        let rate = self.side.signum() * self.rate([self.point[0], 0.0, self.point[2]])[1];
        let rate = if rate == 0.0 { -self.block.belt } else { rate };
        self.crossings += usize::from(rate.signum() != self.side);
        (self.side, self.point[1]) = (rate.signum(), 0.0);
    }

    /// Goes on for a time; false if no step does, or too many would.
    pub fn advance(&mut self, duration: f64, most: usize) -> bool {
        let mut time = 0.0;
        for _ in 0..most {
            let left = duration - time;
            if left <= 0.0 {
                return true;
            }
            let mut h = self.h.min(left);
            let (end, next, crosses) = loop {
                if h.is_nan() || h <= 1e-30 {
                    return false;
                }
                match self.checked(self.point, h) {
                    Some((end, error, crosses)) if error <= self.tolerance => {
                        let grow = (self.tolerance / error.max(1e-30)).powf(0.1);
                        let next = h * (0.8 * grow).clamp(0.5, 3.0);
                        // It was beyond r = 0, and has come back: where was that? And no step
                        // passes over all speeds of one order of size, where g may have changed.
                        let [slow, fast] = [self.point[1], end[1]].map(|s| s.max(SLOWEST));
                        let apart = (slow / fast).max(fast / slow);
                        if (crosses && end[1] > 0.0 && h > 1e-12) || apart > 5.0 {
                            h *= 0.3;
                            continue;
                        }
                        break (end, next, end[1] <= 0.0);
                    }
                    Some((_, error, _)) if error.is_finite() => {
                        h *= (0.8 * (self.tolerance / error).powf(0.1)).clamp(0.1, 0.7);
                    }
                    _ => h *= 0.25,
                }
            };
            if !crosses {
                (self.point, time) = (end, if h == left { duration } else { time + h });
                self.h = self
                    .h
                    .max(next)
                    .min(if h < self.h { next.max(h) } else { next });
                continue;
            }
            // The step that ends at r = 0, by secants kept inside.
            let (mut a, mut b) = (0.0, h);
            let [mut at_a, mut at_b] = [self.point[1], end[1]];
            let mut there = end;
            let mut used = h;
            for pass in 0..100 {
                if at_b == 0.0 || b - a <= 2e-16 * b {
                    break;
                }
                let secant = b + (b - a) * at_b / (at_a - at_b);
                let inside = pass % 3 < 2 && a < secant && secant < b && at_a > 0.0;
                used = if inside { secant } else { 0.5 * (a + b) };
                let Some((found, _)) = self.step(self.point, used) else {
                    return false;
                };
                there = found;
                if found[1] > 0.0 {
                    (a, at_a) = (used, found[1]);
                } else {
                    (b, at_b) = (used, found[1]);
                }
                if found[1].abs() <= 1e-16 * self.scales(self.point, self.point)[1] {
                    break;
                }
            }
            (self.point, time) = (there, time + used);
            self.h = h.max(1e-9);
            self.turn();
        }
        false
    }
}

impl Block {
    pub fn random(random: &mut Random) -> (Self, usize) {
        let limit = random.uniform(0.2, 1.0);
        let kind = (random.bits() % 4) as usize;
        let stiffness = random.logarithmic(10.0, 1e7);
        let mut law = Bristles {
            stiffness,
            damping: match random.bits() % 3 {
                0 => 0.0,
                1 => random.uniform(0.1, 1.5) * stiffness.sqrt(),
                _ => random.uniform(0.0, 0.5),
            },
            viscous: random.pick(&[0.0, 0.02, 0.4]),
            fading: 0.0,
            limit,
            least: limit * random.uniform(0.4, 1.0),
            stribeck: random.logarithmic(1e-5, 1.0),
            exponent: 1 + (random.bits() % 2) as u32,
            bump: [0.0, 0.0, 1.0],
        };
        match kind {
            // Dahl's.
            0 => (law.least, law.damping, law.viscous) = (limit, 0.0, 0.0),
            2 => {
                // Damping that fades.
                law.fading = 1.0 / random.logarithmic(1e-5, 1.0);
            }
            3 => {
                let place = random.logarithmic(1e-4, 0.3);
                law.bump = [0.2 * limit, place, place * random.uniform(0.3, 1.0)];
            }
            _ => {}
        }
        let block = Self {
            law,
            mass: random.logarithmic(0.3, 3.0),
            spring: random.logarithmic(0.3, 3.0),
            damper: random.pick(&[0.0, 0.05]),
            load: random.logarithmic(0.3, 3.0),
            belt: random.sign() * random.logarithmic(0.02, 1.0),
        };
        (block, kind)
    }

    pub fn structure<L: ContactLaw + Send + Sync + 'static>(&self, law: L) -> Structure {
        let contact = Contact::new(0, law, self.load).unwrap().on_belt(self.belt);
        one_mass([self.mass, self.damper, self.spring], 0.0, contact).unwrap()
    }

    /// Steps, crossings, and q, v, z at equal times.
    pub fn follow(&self, kind: usize, start: &State, times: &[f64]) -> Result<Followed, Error> {
        let law = &self.law;
        match kind {
            0 => follow(
                &self.structure(Dahl::new(law.limit, law.stiffness)?),
                start,
                times,
            ),
            1 if law.exponent == 2 => {
                let g = Exponential::new(law.limit, law.least, law.stribeck)?;
                let law = LuGre::new(g, law.stiffness, law.damping, law.viscous)?;
                follow(&self.structure(law), start, times)
            }
            1 => {
                let g = Stribeck::new(law.limit, law.least, law.stribeck, 1)?;
                let law = LuGre::new(g, law.stiffness, law.damping, law.viscous)?;
                follow(&self.structure(law), start, times)
            }
            _ => follow(&self.structure(law.clone()), start, times),
        }
    }
}

pub type Followed = (usize, usize, Vec<[f64; 3]>);

pub fn follow(structure: &Structure, start: &State, times: &[f64]) -> Result<Followed, Error> {
    let many = Integrator::new().with_max_steps(3_000_000)?;
    let (mut steps, mut crossings, mut states) = (0, 0, Vec::new());
    for step in many.flow(structure, start.clone())? {
        let step = step?;
        steps += 1;
        while let Some(&time) = times.get(states.len())
            && step.end_time() >= time
        {
            let state = step.state_at(step.since_start(time));
            states.push([state.displacements[0], state.velocities[0], state.memory[0]]);
        }
        if states.len() == times.len() {
            break;
        }
        crossings += step.events().len();
    }
    Ok((steps, crossings, states))
}

/// Largest difference of two states, each number in its own unit.
pub fn apart(block: &Block, a: &[f64; 3], b: &[f64; 3]) -> f64 {
    let size = block.load * block.law.limit / block.spring;
    let fast = block.belt.abs() + size * (block.spring / block.mass).sqrt();
    let scales = [size, fast, block.law.limit / block.law.stiffness];
    (0..3)
        .map(|i| (a[i] - b[i]).abs() / scales[i])
        .fold(0.0, larger)
}
