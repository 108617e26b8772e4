//! Motions that are born at the Hopf points of random structures.

use std::f64::consts::TAU;

use stick_slip::orbit::{BranchEnd, BranchPoint, Search};
use stick_slip::structure::State;
use stick_slip::{Contact, Error, Exponential, Stribeck, Structure, bifurcation};

use crate::common::{Random, count};

/// Up to three masses in a row, rubbed by belts.
struct Row {
    masses: Vec<f64>,
    ground: Vec<f64>,
    dampers: Vec<f64>,
    springs: Vec<f64>,
    law: [f64; 3],
    load: f64,
    bells: bool,
}

impl Row {
    fn random(random: &mut Random) -> Self {
        let n = 1 + (random.bits() % 3) as usize;
        let mut some =
            |from: f64, to: f64| -> Vec<f64> { (0..n).map(|_| random.uniform(from, to)).collect() };
        Self {
            masses: some(0.5, 2.0),
            ground: some(0.3, 2.0),
            dampers: some(0.01, 0.1),
            springs: some(0.3, 2.0),
            law: {
                let limit = random.uniform(0.3, 0.7);
                [
                    limit,
                    limit * random.uniform(0.3, 0.8),
                    random.uniform(0.2, 0.6),
                ]
            },
            load: random.uniform(0.5, 2.0),
            bells: random.bits() & 1 == 0,
        }
    }

    /// The structure over the velocity of its belt; its first ground spring is multiplied.
    fn at(&self, velocity: f64, stiffer: f64) -> Result<Structure, Error> {
        let mut row = Structure::new(&self.masses)?;
        for i in 0..self.masses.len() {
            let stiffer = if i == 0 { stiffer } else { 1.0 };
            row = row
                .with_ground_spring(i, self.ground[i] * stiffer)?
                .with_ground_damper(i, self.dampers[i])?;
            if i > 0 {
                row = row.with_spring(i - 1, i, self.springs[i])?;
            }
        }
        let [s, k, v] = self.law;
        let contact = if self.bells {
            Contact::new(0, Stribeck::new(s, k, v, 2)?, self.load)?
        } else {
            Contact::new(0, Exponential::new(s, k, v)?, self.load)?
        };
        row.with_contact(contact.on_belt(velocity))
    }

    /// The growth rate of steady sliding, and its frequency.
    fn growth(&self, velocity: f64) -> Option<(f64, f64)> {
        let steady = self.at(velocity, 1.0).ok()?.steady_sliding().ok()?;
        let values = steady.eigenvalues.iter();
        let first = values.max_by(|a, b| a.re.total_cmp(&b.re))?;
        Some((first.re, first.im.abs()))
    }

    /// A velocity at which the growth rate is 0, and the frequency there.
    fn hopf(&self) -> Option<(f64, f64)> {
        let at = |velocity: f64| self.growth(velocity);
        let velocities = (0..40).map(|i| 0.05 * 1.12_f64.powi(i));
        let known: Vec<(f64, f64)> = velocities.filter_map(|v| Some((v, at(v)?.0))).collect();
        let pair = known.windows(2).find(|pair| pair[0].1 * pair[1].1 < 0.0)?;
        let (mut low, mut high) = (pair[0].0, pair[1].0);
        let sign = pair[0].1.signum();
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            *(if at(middle)?.0 * sign > 0.0 {
                &mut low
            } else {
                &mut high
            }) = middle;
        }
        let frequency = at(low)?.1;
        (frequency > 0.0).then_some((low, frequency))
    }
}

#[test]
fn first_motions_have_the_period_the_side_and_the_growth_of_the_normal_form() {
    let mut random = Random::new(7301);
    let mut found = 0;
    let mut wrong: Vec<String> = Vec::new();
    for number in 0..count(2, 60) {
        let row = Row::random(&mut random);
        let Some((hopf, frequency)) = row.hopf() else {
            continue;
        };
        found += 1;
        let family = |velocity: f64| row.at(velocity, 1.0);
        let about = format!("case {number}, velocity {hopf}");
        let born = match Search::new().begin(family, 1.001 * hopf) {
            Ok(born) => born,
            Err(error) => {
                wrong.push(format!("{about}: {error}"));
                continue;
            }
        };
        // By the first Lyapunov coefficient.
        let ranges = [0.99 * hopf..1.01 * hopf, 0.9999..1.0001];
        let loci = bifurcation::hopf_locus(|v, stiffer| row.at(v, stiffer), ranges).unwrap();
        let points = loci.iter().flat_map(|locus| &locus.points);
        let middle = points.min_by(|a, b| {
            let apart = |q: f64| (q - 1.0).abs();
            apart(a.parameters[1]).total_cmp(&apart(b.parameters[1]))
        });
        let is_supercritical = middle.unwrap().first_lyapunov_coefficient < 0.0;
        let is_unstable = |velocity: f64| row.growth(velocity).unwrap().0 > 0.0;
        if born.orbit.is_stable() != is_supercritical
            || is_unstable(born.parameter) != is_supercritical
        {
            wrong.push(format!(
                "{about}: {} stable {}, supercritical {is_supercritical}",
                born.parameter,
                born.orbit.is_stable()
            ));
        }
        let away = born.parameter - hopf;
        let range = hopf - 2.0 * away.abs()..hopf + 2.0 * away.abs();
        let search = Search::new().with_max_points(60).unwrap();
        let branch = search
            .follow(family, born.parameter, &born.orbit, range)
            .unwrap();
        let end = branch.ends.iter().find_map(|end| match end {
            BranchEnd::Hopf { parameter } => Some(parameter - hopf),
            _ => None,
        });
        if end.is_none_or(|end| end.abs() > 1e-9 * hopf) {
            wrong.push(format!("{about}: {end:?} of {:?}", branch.ends));
        }
        // Small motions, but not so small that their distance is rounding.
        let amplitude = |point: &BranchPoint<State>| point.orbit.amplitude(0);
        let mut small: Vec<_> = branch
            .points
            .iter()
            .filter(|point| {
                let part = amplitude(point) / amplitude(&born);
                (0.02..0.5).contains(&part)
            })
            .collect();
        small.sort_by(|a, b| amplitude(a).total_cmp(&amplitude(b)));
        let [near, far] = [small.first(), small.last()].map(Option::unwrap);
        let distance = |point: &BranchPoint<State>| (point.parameter - hopf).abs();
        let exponent =
            (amplitude(far) / amplitude(near)).ln() / (distance(far) / distance(near)).ln();
        let error =
            |point: &BranchPoint<State>| (point.orbit.period() * frequency / TAU - 1.0).abs();
        if (exponent - 0.5).abs() > 0.01 {
            wrong.push(format!("{about}: exponent {exponent}"));
        }
        // 2π/ω, and an error of the order of the distance.
        if error(near) > 2.0 * error(far) * distance(near) / distance(far) + 1e-11 / distance(near)
            || error(&born) > 0.1
        {
            wrong.push(format!(
                "{about}: periods {:e} {:e}",
                error(near),
                error(far)
            ));
        }
    }
    println!("{found} Hopf points");
    assert!(wrong.is_empty(), "{wrong:#?}");
    assert!(found > 1);
}
