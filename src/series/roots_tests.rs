//! Tests of `roots.rs`: an attack by polynomials with planted roots, and a judge that checks each
//! answer in exact arithmetic.
//!
//! Every coefficient and every time is a whole number times a power of two, so big integers decide
//! the sign of a value exactly. The sign on a whole interval is decided by coefficients in
//! Bernstein's basis, rounded down in units of about 2⁻⁴⁰ of the finder's own error bound. The
//! judge uses the polynomial with its rounded coefficients.

use std::ops::ControlFlow;

use num_bigint::{BigInt, Sign};

use super::roots::{MOST_DIVISIONS, Search};
use super::{PowerSeries, TERMS, quarters};
use crate::belt::MassOnBelt;
use crate::belt::Stepper;
use crate::clock::Time;
use crate::friction::slip_series::SlipPoint;
use crate::friction::{Exponential, Polynomial};
use crate::numerics::testing::count;
use crate::state::{Direction, State};

const DEGREE: usize = TERMS - 1;

/// A root's place can be judged if the root is known to within this part of its time.
const SHARP: f64 = 1e-3;

// ---- Exact arithmetic ----

/// (m, e) with x = m·2^e and m odd or zero.
fn parts(x: f64) -> (i64, i32) {
    let bits = x.to_bits();
    let exponent = (bits >> 52 & 0x7ff) as i32;
    let fraction = (bits & ((1 << 52) - 1)) as i64;
    let m = if exponent == 0 {
        fraction
    } else {
        fraction | 1 << 52
    };
    let zeros = if m == 0 { 0 } else { m.trailing_zeros() };
    let e = exponent.max(1) - 1075 + zeros as i32;
    ((m >> zeros) * x.signum() as i64, e)
}

/// Returns true if c(t) > level.
fn is_above(c: &PowerSeries, t: f64, level: f64) -> bool {
    let (t, e) = parts(t);
    // With f = −e: c(t)·2^(26f) = Σ c_k t^k 2^((26−k)f), by Horner's rule.
    let (t, f) = (t << e.max(0), (-e).max(0) as usize);
    let least = c.0.iter().chain([&level]).filter(|c| **c != 0.0);
    let least = least.map(|c| parts(*c).1).min().unwrap_or(0);
    let whole = |x: f64, k: usize| {
        let (m, e) = parts(x);
        BigInt::from(m) << ((e - least).max(0) as usize + (DEGREE - k) * f)
    };
    let sum = (0..TERMS).rev().fold(BigInt::ZERO, |sum, k| {
        let sum = sum * t;
        if c[k] == 0.0 {
            sum
        } else {
            sum + whole(c[k], k)
        }
    });
    (sum - whole(level, 0)).sign() == Sign::Plus
}

/// Decides in exact arithmetic whether an answer is right.
struct Judge {
    /// Weights w_jk = L·C(j, k)/C(26, k), where L is the least common multiple of all C(26, k): L
    /// times Bernstein's coefficient j is Σ_k w_jk c_k.
    weights: [[i128; TERMS]; TERMS],
}

impl Judge {
    /// L = lcm(1, …, 27)/27.
    const COMMON: i128 = 2_974_571_600;

    fn new() -> Self {
        let mut binomial = [[0; TERMS]; TERMS];
        for n in 0..TERMS {
            binomial[n][0] = 1;
            for k in 1..=n {
                binomial[n][k] = binomial[n - 1][k - 1] + binomial[n - 1][k];
            }
        }
        let weight = |j: usize, k: usize| {
            assert_eq!(Self::COMMON % binomial[DEGREE][k], 0);
            binomial[j][k] * (Self::COMMON / binomial[DEGREE][k])
        };
        Self {
            weights: std::array::from_fn(|j| std::array::from_fn(|k| weight(j, k))),
        }
    }

    /// Returns true if sign·c may fall to `level` anywhere between the times `from` and `to`. The
    /// answer "no" is proven.
    fn falls(&self, c: &PowerSeries, sign: f64, level: f64, [from, to]: [f64; 2]) -> bool {
        if from >= to {
            return false;
        }
        // c_k·to^k − level in units of `unit`, rounded down; their sum stays below 2⁹⁰.
        let (t, e) = parts(to);
        let size = |x: f64, k: usize| x.abs().log2() + k as f64 * to.log2();
        let sizes = (0..TERMS)
            .map(|k| size(c[k], k))
            .chain([level.abs().log2()]);
        let unit = sizes.fold(f64::NEG_INFINITY, f64::max).ceil() as i32 + 5 - 90;
        let down = |m: BigInt, e: i32| {
            let m = if e >= unit {
                m << (e - unit)
            } else {
                m >> (unit - e)
            };
            i128::try_from(m).expect("below 2⁹⁰")
        };
        let mut power = BigInt::from(1);
        let mut powers: [i128; TERMS] = std::array::from_fn(|k| {
            let (m, e_k) = parts(sign * c[k]);
            let term = down(&power * m, e_k + k as i32 * e);
            power *= t;
            term
        });
        let (m, e) = parts(-level);
        powers[0] += down(BigInt::from(m), e);
        let bernstein = std::array::from_fn(|j| {
            let terms = std::iter::zip(&self.weights[j], &powers);
            terms.take(j + 1).map(|(w, c)| w * c).sum()
        });
        falls_to_zero(&bernstein, 0.0, 1.0, from / to, 160)
    }
}

/// Returns true if a polynomial may fall to 0 on the part [x, x + w] of an interval, not counting
/// what lies before `from`; given by its Bernstein coefficients on that part.
fn falls_to_zero(bernstein: &[i128; TERMS], x: f64, w: f64, from: f64, depth: usize) -> bool {
    if x + w < from || bernstein.iter().all(|&b| b > 0) {
        return false;
    }
    if (bernstein[0] <= 0 && x >= from) || bernstein[DEGREE] <= 0 || depth == 0 {
        return true;
    }
    // De Casteljau's halving. The shift rounds down.
    let mut right = *bernstein;
    let left = std::array::from_fn(|j| {
        let first = right[0];
        for k in 0..DEGREE - j {
            right[k] = (right[k] + right[k + 1]) >> 1;
        }
        first
    });
    let w = 0.5 * w;
    falls_to_zero(&left, x, w, from, depth - 1) || falls_to_zero(&right, x + w, w, from, depth - 1)
}

// ---- Judgement ----

#[derive(Debug, Clone, Copy, PartialEq)]
enum Verdict {
    /// Right, and every value that decided the answer is larger than its error bound.
    Right,
    /// Right for some polynomial within the error bound of this one.
    Undecided,
    /// The search gave up, after [`MOST_DIVISIONS`].
    TooCurved,
    Missed,
    Invented,
}

/// Largest distance of the root from the time found, by the error bound of the values and the
/// slope; true if that is close enough to judge its place.
fn blur(slope: &PowerSeries, t: f64, error: f64) -> (f64, bool) {
    let last_bit = 2.0 * f64::EPSILON * t;
    let blur = last_bit + 2.0 * error / slope.at(t).abs();
    if blur <= SHARP * t {
        (blur, true)
    } else {
        (last_bit, false)
    }
}

impl Judge {
    /// Judges the times in (0, h] at which c is said to change sign, `all` of them or the first. A
    /// dip below zero may be overlooked if it is less deep than twice the error bound: once for the
    /// error of a value, and once for the distance of c from the last chord.
    fn judge(&self, c: &PowerSeries, h: f64, found: &[f64], all: bool) -> Verdict {
        let error = c.rounding_bound(h);
        let slope = c.derivative();
        let mut sign = c.first_nonzero().map_or(1.0, f64::signum);
        let mut decided = true;
        let mut from = 0.0;
        if c[0] == 0.0 {
            from = 2.0 * error / c[1].abs();
            decided = from <= SHARP * h;
            from = if decided { from } else { 0.0 };
        }
        for &t in found {
            let (blur, sharp) = blur(&slope, t, error);
            let place = |t: f64| sign * f64::from(i8::from(is_above(c, t, 0.0)) * 2 - 1);
            let crosses = sharp && place(t - blur) > 0.0 && place(t + blur) < 0.0;
            let touches = || is_above(c, t, -2.0 * error) && !is_above(c, t, 2.0 * error);
            if !(0.0 < t && t <= h && (crosses || touches())) {
                return Verdict::Invented;
            }
            let until = t - blur;
            if self.falls(c, sign, -2.0 * error, [from, until]) {
                return Verdict::Missed;
            }
            decided &= crosses && !self.falls(c, sign, error, [from, until]);
            sign = -sign;
            from = t + blur;
        }
        if all {
            if self.falls(c, sign, -2.0 * error, [from, h]) {
                return Verdict::Missed;
            }
            decided = decided && !self.falls(c, sign, error, [from, h]);
        }
        if decided {
            Verdict::Right
        } else {
            Verdict::Undecided
        }
    }

    fn first(&self, c: &PowerSeries, h: f64) -> Verdict {
        match c.first_root(h, c.at_four(quarters(h))) {
            Ok(Some(t)) => self.judge(c, h, &[t], false),
            Ok(None) => self.judge(c, h, &[], true),
            Err(_) => Verdict::TooCurved,
        }
    }

    fn every(&self, c: &PowerSeries, h: f64) -> Verdict {
        let mut found = Vec::new();
        let mut rises = c.first_nonzero().is_some_and(|c| c < 0.0);
        let mut alternate = true;
        let mut visit = |t, rising| {
            alternate &= rising == rises;
            rises = !rises;
            found.push(t);
        };
        c.sign_changes(h, &mut visit);
        // `sign_changes` does not tell whether it gave up, so the search is repeated.
        let search = Search::new(c, h, c.curvature_bound(h));
        let values = c.at_four(quarters(h));
        let _ = search.run(h, values, &mut |_, _| ControlFlow::Continue(()));
        if search.divisions.get() >= MOST_DIVISIONS {
            Verdict::TooCurved
        } else if alternate {
            self.judge(c, h, &found, true)
        } else {
            Verdict::Missed
        }
    }
}

// ---- Cases ----

/// SplitMix64.
struct Random(u64);

impl Random {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ self.0 >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ z >> 31
    }

    fn below(&mut self, n: u64) -> u64 {
        self.bits() % n
    }

    fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.bits() >> 11) as f64 * 2.0_f64.powi(-53)
    }

    /// ±2^e with e in a range.
    fn power(&mut self, low: f64, high: f64) -> f64 {
        let x = self.within(low, high).exp2();
        if self.below(2) == 0 { x } else { -x }
    }
}

fn times(a: &[f64], b: &[f64]) -> Vec<f64> {
    let mut product = vec![0.0; a.len() + b.len() - 1];
    for (i, a) in a.iter().enumerate() {
        for (j, b) in b.iter().enumerate() {
            product[i + j] += a * b;
        }
    }
    product
}

/// The Chebyshev polynomial of degree n on [0, 1].
fn chebyshev(n: u64) -> Vec<f64> {
    let (mut last, mut this) = (vec![1.0], vec![-1.0, 2.0]);
    for _ in 1..n {
        let mut next = times(&this, &[-2.0, 4.0]);
        for (next, last) in std::iter::zip(&mut next, &last) {
            *next -= last;
        }
        (last, this) = (this, next);
    }
    this
}

const KINDS: [&str; 12] = [
    "pair, ulps apart",
    "pair",
    "multiple root",
    "root at an end",
    "root missed by a hair",
    "cluster",
    "Chebyshev",
    "square",
    "any magnitudes",
    "starts at zero",
    "grazing slip",
    "slow step",
];

/// A polynomial on [0, 1] with the roots that its kind asks for.
fn planted(kind: &str, random: &mut Random) -> Vec<f64> {
    let r = random.within(0.0, 1.0);
    let mut roots = Vec::new();
    let mut shift = 0.0;
    let mut c = vec![1.0];
    match kind {
        "pair, ulps apart" => {
            let apart = random.below(64) as f64 * f64::EPSILON;
            roots.extend([r, r * (1.0 + apart)]);
        }
        "pair" => roots.extend([r, r + random.power(-30.0, -1.0)]),
        "multiple root" => roots.extend(vec![r; 2 + random.below(6) as usize]),
        "root at an end" => {
            let ulps = random.below(9) as f64 - 4.0;
            roots.extend(match random.below(3) {
                0 => vec![1.0 + ulps * f64::EPSILON],
                1 => vec![random.power(-80.0, -1.0)],
                _ => vec![random.power(-80.0, -1.0), 1.0 + ulps * f64::EPSILON],
            });
        }
        "root missed by a hair" => {
            roots.extend([r, r]);
            shift = random.power(-3.0, 8.0);
        }
        "cluster" => {
            let width = random.power(-50.0, -1.0);
            let count = 3 + random.below(6);
            roots.extend((0..count).map(|_| r + width * random.within(0.0, 1.0)));
        }
        "Chebyshev" => {
            c = chebyshev(2 + random.below(25));
            c[0] += 1.0 + random.power(-50.0, 0.0);
            return c;
        }
        "square" => {
            let terms = 2 + random.below(11);
            c = (0..terms).map(|_| random.within(-1.0, 1.0)).collect();
            c = times(&c, &c);
            shift = random.power(-3.0, 8.0);
        }
        "any magnitudes" => {
            c = (0..TERMS).map(|_| random.power(-60.0, 60.0)).collect();
            return c;
        }
        "starts at zero" => {
            let size = random.power(-40.0, 0.0);
            c = (0..8).map(|_| size * random.within(-1.0, 1.0)).collect();
            c[0] = 0.0;
            roots.push(random.power(-20.0, 0.0));
        }
        _ => unreachable!(),
    }
    // Sometimes more roots, and half of the time a factor without roots near the interval.
    if random.below(4) == 0 {
        roots.extend((0..random.below(4)).map(|_| random.within(-0.5, 1.5)));
    }
    for root in roots {
        c = times(&c, &[-root, 1.0]);
    }
    if random.below(2) == 0 {
        let decay = random.within(0.1, 0.8);
        let free = TERMS - c.len();
        let tail = (1..free).map(|k| random.within(-1.0, 1.0) * decay.powi(k as i32));
        let tail: Vec<_> = std::iter::once(2.0).chain(tail).collect();
        c = times(&c, &tail);
    }
    if shift != 0.0 {
        c[0] += shift * PowerSeries::from(&c[..]).rounding_bound(1.0);
    }
    c
}

/// The sliding speed of a slip phase that comes to rest relative to the belt, or nearly: the motion
/// is followed backward from there, and then forward again.
fn grazing(random: &mut Random) -> Option<(PowerSeries, f64)> {
    let at_rest = random.within(0.2, 1.0);
    let law = Exponential::new(
        at_rest,
        at_rest * random.within(0.3, 0.99),
        random.within(0.05, 1.0),
    );
    let system = MassOnBelt::new(law.ok()?, random.within(0.01, 1.0)).ok()?;
    let system = system.with_damping(random.within(0.0, 0.3)).ok()?;
    let least = match random.below(3) {
        0 => 0.0,
        _ => random.power(-60.0, -1.0).abs(),
    };
    let state = State::new(0.0, system.belt_velocity() - least);
    let end = SlipPoint {
        direction: Direction::Lagging,
        // The u at which v' = −u + v'(u = 0) vanishes.
        displacement: system.acceleration(state),
        speed: least,
        rate: Some(0.0),
    };
    let belt = system.belt();
    let mut stepper = Stepper::new(&belt, random.power(-52.0, -8.0).abs());
    let back = stepper.advance(&belt, &end, Time::Backward, 0.0).ok()?;
    if back.duration.is_infinite() {
        return None;
    }
    let start = SlipPoint {
        speed: stepper.speed().at(back.duration),
        ..back.end
    };
    let duration = back.duration;
    stepper.advance(&belt, &start, Time::Forward, 0.0).ok()?;
    let mut c = *stepper.speed();
    let h = duration * random.within(0.9, 1.5);
    // Half of the polynomials are shifted, so that some miss zero by a hair.
    if random.below(2) == 0 {
        c[0] += random.power(-3.0, 8.0) * c.rounding_bound(h);
    }
    Some((c, h))
}

/// The slow motion of a stiff system, lowered so far that it comes to zero within a step, or
/// nearly.
fn slow_step(random: &mut Random) -> Option<(PowerSeries, f64)> {
    let v_m = random.power(-12.0, -3.0).abs();
    let at_rest = random.within(0.2, 1.0);
    let law = Polynomial::new(at_rest, at_rest * random.within(0.3, 0.95), v_m).ok()?;
    let system = MassOnBelt::new(law, v_m * random.power(1.0, 10.0).abs()).ok()?;
    let system = system.with_damping(random.within(0.0, 0.3)).ok()?;
    let state = State::new(0.0, system.belt_velocity() * random.within(-0.5, 0.9));
    let mut point = SlipPoint {
        direction: Direction::Lagging,
        displacement: state.displacement,
        speed: system.belt_velocity() - state.velocity,
        rate: None,
    };
    let belt = system.belt();
    let mut stepper = Stepper::new(&belt, random.power(-52.0, -30.0).abs());
    for _ in 0..100 {
        let advance = stepper.advance(&belt, &point, Time::Forward, 0.0).ok()?;
        let (end, h, mut c) = (advance.end, advance.duration, *stepper.speed());
        // No explicit step is so long, and none has a last coefficient of zero.
        let is_slow = h * belt.effective_damping(point.speed) > 16.0 && c[TERMS - 1] == 0.0;
        if is_slow && random.below(4) == 0 {
            c[0] -= c.at(h * random.within(0.0, 1.2));
            if random.below(2) == 0 {
                c[0] += random.power(-3.0, 8.0) * c.rounding_bound(h);
            }
            return Some((c, h));
        }
        point = end;
    }
    None
}

/// Case number n: its kind, polynomial and step.
fn case(n: u64) -> (usize, PowerSeries, f64) {
    let kind = (n % KINDS.len() as u64) as usize;
    let random = &mut Random(n);
    loop {
        let of_motion = match KINDS[kind] {
            "grazing slip" => Some(grazing(random)),
            "slow step" => Some(slow_step(random)),
            _ => None,
        };
        let (c, h) = if let Some(case) = of_motion {
            let Some(case) = case else {
                continue;
            };
            case
        } else {
            let planted = planted(KINDS[kind], random);
            let h = random.power(-8.0, 3.0).abs();
            // A quarter of the steps are powers of two, so that scaling does not round planted
            // numbers.
            let h = if random.below(4) == 0 {
                h.log2().round().exp2()
            } else {
                h
            };
            let octaves = if random.below(8) == 0 { 300.0 } else { 30.0 };
            let scale = random.power(-octaves, octaves);
            let mut c = PowerSeries::ZERO;
            for (k, p) in planted.iter().enumerate() {
                c[k] = scale * p / h.powi(k as i32);
            }
            (c, h)
        };
        if c[0] > 0.0 || KINDS[kind] == "starts at zero" {
            return (kind, c, h);
        }
        if c[0] < 0.0 {
            return (kind, c.scaled(-1.0), h);
        }
    }
}

// ---- The attack ----

/// Counts of each verdict on each kind, for the first root and for all sign changes; and the most
/// halvings of a step that was too curved.
#[derive(Debug, Default, Clone, Copy)]
struct Tally {
    first: [[u64; 5]; KINDS.len()],
    every: [[u64; 5]; KINDS.len()],
    halvings: [u32; KINDS.len()],
}

impl Tally {
    fn of(judge: &Judge, cases: impl Iterator<Item = u64>) -> Self {
        let mut tally = Self::default();
        for n in cases {
            let (kind, c, mut h) = case(n);
            let check = |verdict: Verdict, what: &str, h: f64| {
                if matches!(verdict, Verdict::Missed | Verdict::Invented) {
                    println!("{verdict:?} {what}, case {n} ({}), h = {h:e}", KINDS[kind]);
                }
            };
            let every = judge.every(&c, h);
            check(every, "sign change", h);
            tally.every[kind][every as usize] += 1;
            if c[0] == 0.0 {
                continue;
            }
            // The integrator halves a step that is too curved.
            for halvings in 0.. {
                let first = judge.first(&c, h);
                check(first, "first root", h);
                tally.first[kind][first as usize] += 1;
                tally.halvings[kind] = tally.halvings[kind].max(halvings);
                if first != Verdict::TooCurved {
                    break;
                }
                h *= 0.5;
            }
        }
        tally
    }

    fn add(&mut self, other: &Self) {
        for (sums, terms) in [
            (&mut self.first, &other.first),
            (&mut self.every, &other.every),
        ] {
            for (sum, term) in std::iter::zip(sums.as_flattened_mut(), terms.as_flattened()) {
                *sum += term;
            }
        }
        for (most, other) in std::iter::zip(&mut self.halvings, other.halvings) {
            *most = other.max(*most);
        }
    }
}

/// A judge that lets everything pass would find no fault: this test shows that it does not.
#[test]
fn wrong_answers_are_recognised() {
    let judge = Judge::new();
    // (t − 1/4)(t − 3/4) and, with no root, (t − 1/2)² + 10⁻¹².
    let two = PowerSeries::from(&[0.1875, -1.0, 1.0]);
    let mut none = PowerSeries::from(&[0.25 + 1e-12, -1.0, 1.0]);
    for (c, found, all, verdict) in [
        (&two, &[0.25, 0.75][..], true, Verdict::Right),
        (&two, &[0.25], false, Verdict::Right),
        (&two, &[0.25], true, Verdict::Missed),
        (&two, &[0.75], false, Verdict::Missed),
        (&two, &[], true, Verdict::Missed),
        (&two, &[0.25 + 1e-14], false, Verdict::Invented),
        (&two, &[0.5], false, Verdict::Invented),
        (&none, &[], true, Verdict::Right),
        (&none, &[0.5], false, Verdict::Invented),
    ] {
        assert_eq!(judge.judge(c, 1.0, found, all), verdict, "{c:?} {found:?}");
    }
    // An answer that is the third of three roots.
    let three = PowerSeries::from(&[0.09375, -0.6875, 1.5, -1.0]);
    assert_eq!(judge.judge(&three, 1.0, &[0.75], false), Verdict::Missed);
    none[0] = 0.25 - 1e-12;
    assert_eq!(judge.judge(&none, 1.0, &[], true), Verdict::Missed);
    none[0] = 0.25;
    assert_eq!(judge.judge(&none, 1.0, &[], true), Verdict::Undecided);
}

/// The root may lie before the first place at which a value is computed.
#[test]
fn a_root_close_to_one_at_the_start_is_found() {
    for (root, sign) in [(0.1, 1.0), (0.1, -1.0), (1e-9, 1.0), (1e-9, -1.0)] {
        let c = PowerSeries::from(&[0.0, root * sign, -sign]);
        let mut found = Vec::new();
        c.sign_changes(1.0, &mut |t, rising| {
            found.push((t, rising));
        });
        assert_eq!(found, [(root, sign < 0.0)]);
    }
}

#[test]
fn no_planted_root_is_missed_and_none_invented() {
    let cases = count(400, 6000) as u64;
    let judge = Judge::new();
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let mut tally = Tally::default();
    std::thread::scope(|scope| {
        let judge = &judge;
        let share = |first| move || Tally::of(judge, (first as u64..cases).step_by(threads));
        let running: Vec<_> = (0..threads).map(|i| scope.spawn(share(i))).collect();
        for thread in running {
            tally.add(&thread.join().unwrap());
        }
    });
    println!("Right, Undecided, TooCurved, Missed, Invented");
    for (kind, name) in KINDS.iter().enumerate() {
        println!("{name:22} {:?} {:?}", tally.first[kind], tally.every[kind]);
    }
    println!("{:?} halvings", tally.halvings);
    for (first, every) in std::iter::zip(&tally.first, &tally.every) {
        assert_eq!([&first[3..], &every[3..]], [[0, 0]; 2], "{tally:?}");
        let decided = first[0] + every[0];
        assert!(decided >= cases / KINDS.len() as u64 / 20, "{tally:?}");
    }
}
