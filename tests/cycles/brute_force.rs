//! Searches held against brute force: motions by Runge-Kutta steps of fixed length, over a grid of
//! belt velocities. Nothing of the crate is used in them, laws included.

use std::collections::HashMap;

use crate::common::any::Any;
use crate::common::formula::Formula;
use crate::common::simple::{Simple, bisect};
use crate::common::{Random, count, on_belt};
use stick_slip::bifurcation::{
    crossing_velocities, fold_velocities, grazing_velocities, hopf_velocities, overshoot_velocities,
};
use stick_slip::{CycleKind, MassOnBelt, limit_cycle};

/// A mass on a belt that moves forward.
#[derive(Debug, Clone)]
struct Plain {
    formula: Formula,
    damping: f64,
    load: f64,
    belt: f64,
    step: f64,
}

/// How a slip arc ends: on the belt at this displacement, or at this maximum of the velocity; and
/// after which time.
#[derive(Debug, Clone, Copy, PartialEq)]
enum End {
    Belt(f64, f64),
    Peak(f64),
    Rest,
}

impl Plain {
    fn at(&self, belt: f64) -> Self {
        Self {
            belt,
            ..self.clone()
        }
    }

    fn system(&self) -> MassOnBelt<Any> {
        on_belt(self.formula.law(), self.belt, self.damping, self.load)
    }

    fn held(&self) -> f64 {
        self.load * self.formula.static_coefficient()
    }

    fn arc(&self, side: f64, mut now: [f64; 2]) -> End {
        let simple = Simple::new(&self.formula, self.belt, self.damping, self.load);
        let stepped = |from: [f64; 2], h: f64| simple.step(side, from, h);
        let on_belt = |at: [f64; 2]| side * (at[1] - self.belt) <= 0.0;
        let acceleration = |at: [f64; 2]| simple.rates(side, at)[1];
        let (mut time, h) = (0.0, self.step);
        let mut has_left = side * (now[1] - self.belt) > 0.0;
        while time < 2000.0 {
            let next = stepped(now, h);
            if next == now {
                return End::Rest;
            }
            let met = |longest: f64| {
                let part = bisect(longest, |part| on_belt(stepped(now, part)));
                End::Belt(stepped(now, part)[0], time + part)
            };
            // Or it leaves and comes back within one step.
            let leaves = side * acceleration(now) > 1e-12;
            if (has_left || leaves) && on_belt(next) {
                return met(h);
            }
            // The next maximum of the velocity is most of a turn away; one may be at the start.
            let may_turn = time > 1.0 && side < 0.0 && next[1] > 0.0;
            if may_turn && acceleration(now) > 0.0 && acceleration(next) <= 0.0 {
                let part = bisect(h, |part| acceleration(stepped(now, part)) <= 0.0);
                let [_, peak] = stepped(now, part);
                // The belt may be met between.
                return if peak >= self.belt {
                    met(part)
                } else {
                    End::Peak(peak)
                };
            }
            has_left |= !on_belt(next);
            (now, time) = (next, time + h);
        }
        End::Rest
    }

    /// The kind and the period of the cycle through the release point.
    fn released(&self) -> Option<(CycleKind, f64)> {
        let (held, carried) = (self.held(), 2.0 * self.damping * self.belt);
        let End::Belt(u, slip) = self.arc(-1.0, [held - carried, self.belt]) else {
            return None;
        };
        let rest = |u: f64| (held - carried - u) / self.belt;
        if u + carried >= -held {
            return Some((CycleKind::StickSlip, slip + rest(u)));
        }
        match self.arc(1.0, [u, self.belt]) {
            End::Belt(u, leading) if u + carried < held => {
                Some((CycleKind::Overshoot, slip + leading + rest(u)))
            }
            _ => None,
        }
    }

    /// Whether motions from these peak velocities grow in a turn.
    fn growing(&self, count: usize) -> Vec<bool> {
        (1..count)
            .map(|k| {
                let peak = self.belt * k as f64 / count as f64;
                let u = -2.0 * self.damping * peak + self.load * self.formula.at(self.belt - peak);
                match self.arc(-1.0, [u, peak]) {
                    End::Peak(next) => next > peak,
                    End::Belt(..) => true,
                    End::Rest => false,
                }
            })
            .collect()
    }
}

fn random(random: &mut Random, kind: usize) -> Plain {
    let (top, width) = (random.uniform(0.2, 0.8), random.uniform(0.2, 1.0));
    let least = top * random.uniform(0.2, 0.9);
    let formula = match kind {
        0 => Formula::Polynomial([top, least, width]),
        1 => Formula::Exponential([top, least, width]),
        2 => Formula::Stribeck([top, least, width, random.uniform(0.0, 0.05)], 1),
        _ => {
            // A fall and a rise, with a slope of 0 where they meet and at the end, and one at rest
            // that the formula of the docs gives.
            let (a, b) = (width, width * random.uniform(1.5, 3.0));
            let last = least + random.uniform(0.0, 0.5) * (top - least);
            let chords = [(least - top) / a, (last - least) / (b - a)];
            let (h, k) = (a, b - a);
            let first = ((2.0 * h + k) * chords[0] - h * chords[1]) / (h + k);
            let first = first.max(3.0 * chords[0]);
            let points = vec![[0.0, top, first], [a, least, 0.0], [b, last, 0.0]];
            Formula::Points(points, top)
        }
    };
    let load = random.logarithmic(0.1, 2.0);
    let damping = 0.5 * load * (top - least) / width * random.logarithmic(0.02, 1.0);
    Plain {
        formula,
        damping,
        load,
        belt: width,
        step: 0.01,
    }
}

fn width(of: &Plain) -> f64 {
    of.belt
}

/// A motion from the release point sticks, overtakes the belt or does neither; this changes at the
/// velocities that are found, and nowhere else.
#[test]
fn contacts_change_where_brute_force_says() {
    use CycleKind::{Overshoot, StickSlip};
    let mut generator = Random::new(1601);
    let (mut seen, mut wrong) = ([0; 3], Vec::new());
    let cases = count(40, 80);
    for i in 0..cases {
        let plain = random(&mut generator, i % 4);
        let (start, end) = (0.02 * width(&plain), 2.0 * width(&plain));
        let system = plain.system();
        let found = [
            grazing_velocities(&system, start..end).unwrap(),
            overshoot_velocities(&system, start..end).unwrap(),
            crossing_velocities(&system, start..end).unwrap(),
        ];
        let all = || found.iter().flatten();
        let mut grid: Vec<f64> = (0..=60)
            .map(|k| start + (end - start) * f64::from(k) / 60.0)
            .collect();
        // Close to what was found on both sides.
        grid.extend(all().flat_map(|v| [v * (1.0 - 1e-4), v * (1.0 + 1e-4)]));
        grid.retain(|v| start <= *v && *v <= end);
        grid.retain(|v| all().all(|found| (found / v - 1.0).abs() > 0.5e-4));
        grid.sort_by(f64::total_cmp);
        let kinds: Vec<_> = grid
            .iter()
            .map(|&v| plain.at(v).released().map(|cycle| cycle.0))
            .collect();
        for (v, kinds) in grid.windows(2).zip(kinds.windows(2)) {
            let expected = match (kinds[0], kinds[1]) {
                (None, Some(StickSlip)) | (Some(StickSlip), None) => [1, 0, 0],
                (Some(StickSlip), Some(Overshoot)) | (Some(Overshoot), Some(StickSlip)) => {
                    [0, 1, 0]
                }
                (Some(Overshoot), None) | (None, Some(Overshoot)) => [0, 0, 1],
                _ => [0, 0, 0],
            };
            let between =
                |list: &Vec<f64>| list.iter().filter(|x| v[0] < **x && **x < v[1]).count();
            let here = [0, 1, 2].map(|i| between(&found[i]));
            (0..3).for_each(|i| seen[i] += expected[i]);
            if here != expected {
                wrong.push(format!("{i} {v:?} {kinds:?} {here:?} {plain:?}"));
            }
        }
    }
    println!("{seen:?} changes");
    assert!(wrong.is_empty(), "{} wrong: {wrong:#?}", wrong.len());
    assert!(seen.iter().all(|&seen| 27 * seen > cases), "{seen:?}");
}

/// Pairs of pure-slip cycles appear and vanish at the folds that are found, and nowhere else: the
/// number of peak velocities at which growth changes its sign.
#[test]
fn pairs_of_cycles_appear_where_folds_are_found() {
    let mut generator = Random::new(1602);
    let (mut seen, mut wrong) = (0, Vec::new());
    let cases = count(8, 24);
    for i in 0..cases {
        let mut plain = random(&mut generator, [1, 1, 3, 2][i % 4]);
        plain.step = 0.02;
        plain.load *= 0.3;
        plain.damping *= 0.3;
        let (start, end) = (0.05 * width(&plain), 2.5 * width(&plain));
        let system = plain.system();
        let found = fold_velocities(&system, start..end).unwrap();
        let hopf = hopf_velocities(&system, start..end).unwrap();
        let grid: Vec<f64> = (0..=32)
            .map(|k| start + (end - start) * f64::from(k) / 32.0)
            .collect();
        let mut known = HashMap::new();
        let mut outline = |v: f64, count: usize| -> ([bool; 2], usize) {
            *known.entry((v.to_bits(), count)).or_insert_with(|| {
                let growing = plain.at(v).growing(count);
                let changes = growing.windows(2).filter(|pair| pair[0] != pair[1]);
                ([growing[0], growing[growing.len() - 1]], changes.count())
            })
        };
        let first: Vec<_> = grid.iter().map(|&v| (v, outline(v, 24))).collect();
        let mut stack: Vec<_> = first.windows(2).map(|pair| (pair[0], pair[1], 0)).collect();
        while let Some(((low, (ends, a)), (high, (other, b)), depth)) = stack.pop() {
            let between = |v: &&f64| low < **v && **v < high;
            let folds = found.iter().filter(between).count();
            // A cycle that leaves the range at either end is another matter.
            let leaves = ends != other || hopf.iter().any(|v| low < *v && *v < high);
            let pairs = a.abs_diff(b) / 2;
            if !leaves && pairs % 2 == folds % 2 {
                seen += pairs;
            } else if depth < 5 {
                // Or pairs are closer than the peaks that are looked at.
                let (depth, count) = (depth + 1, if leaves { 24 } else { 24 << depth });
                let [low, middle, high] =
                    [low, 0.5 * (low + high), high].map(|v| (v, outline(v, count)));
                stack.extend([(low, middle, depth), (middle, high, depth)]);
            } else if !leaves {
                wrong.push(format!("{i} {low}..{high}: {a} {b} {folds} {plain:?}"));
            }
        }
    }
    println!("{seen} folds");
    assert!(wrong.is_empty(), "{} wrong: {wrong:#?}", wrong.len());
    assert!(4 * seen >= cases, "{seen}");
}

/// Strong friction, η = (3/2)γ²(μ_s − μ_m)/v_m from 30 on: relaxation, with stick-slip up to just
/// below the velocity at which steady sliding becomes stable.
#[test]
fn strong_friction_gives_relaxation() {
    let mut generator = Random::new(1603);
    let mut seen = [0; 2];
    let cases = count(10, 30);
    for i in 0..cases {
        let (top, width) = (generator.uniform(0.2, 0.8), generator.uniform(0.2, 1.0));
        let least = top * generator.uniform(0.2, 0.9);
        let eta = generator.logarithmic(30.0, 100.0);
        let damping = 0.5 * eta * generator.uniform(0.0, 0.6);
        let onset = width * f64::sqrt(1.0 - 2.0 * damping / eta);
        let belt = onset * generator.uniform(0.5, 1.5);
        let load = eta * width / (1.5 * (top - least));
        // No speed is larger than some times that of the minimum, where D is η and more.
        let plain = Plain {
            formula: Formula::Polynomial([top, least, width]),
            damping,
            load,
            belt,
            step: 0.18 / (eta + damping),
        };
        let system = plain.system();
        let cycle = limit_cycle::stick_slip(&system).unwrap();
        let released = plain.released();
        let about = format!("{i} η {eta} {plain:?} {released:?}");
        if (belt / onset - 1.0).abs() < 1e-3 {
            continue;
        }
        assert_eq!(
            cycle.as_ref().map(|cycle| cycle.kind()),
            released.map(|x| x.0),
            "{about}"
        );
        assert_eq!(cycle.is_some(), belt < onset, "{about}");
        if let (Some(cycle), Some((_, period))) = (cycle, released) {
            assert!(
                (cycle.period() / period - 1.0).abs() < 1e-6,
                "{about} {}",
                cycle.period()
            );
            seen[0] += 1;
        } else {
            assert!(limit_cycle::find(&system).unwrap().is_empty(), "{about}");
            seen[1] += 1;
        }
    }
    println!("{seen:?}");
    assert!(seen.iter().all(|&seen| 6 * seen > cases), "{seen:?}");
}
