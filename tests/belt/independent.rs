//! A simple integrator, written without an idea of the crate's, must see the same events.

use crate::common::formula::Formula;
use crate::common::simple::{Seen, Simple, told};
use crate::common::{Random, on_belt};
use approx::assert_abs_diff_eq;
use stick_slip::{Direction, FrictionLaw};

/// How often the two were compared.
#[derive(Debug, Default)]
struct Count {
    events: usize,
    undecided: usize,
    worst: f64,
}

/// Follows one random motion by both.
fn compare(random: &mut Random, formula: &Formula, count: &mut Count) {
    let (belt, damping) = (
        random.sign() * random.logarithmic(0.05, 1.5),
        random.uniform(0.0, 0.3),
    );
    let load = random.logarithmic(0.1, 4.0);
    let system = on_belt(formula.law(), belt, damping, load);
    let start = [random.uniform(-2.0, 2.0), random.uniform(-2.0, 2.0)];
    let simple = Simple::new(formula, belt, damping, load);
    let motion = system.simulate((start[0], start[1]), DURATION).unwrap();
    let has_kinks = system.law().breakpoints().next().is_some();
    let about = format!("{formula:?} belt {belt} damping {damping} load {load} start {start:?}");
    let [coarse, fine] = [2.0 * STEP, STEP].map(|h| simple.run(start, DURATION, |_| h).0);
    let events = told(motion.events());
    judge(&about, &events, [&coarse, &fine], has_kinks, count);
}

const DURATION: f64 = 20.0;

/// Step of the finer run.
const STEP: f64 = 2e-3;

/// The crate's events against those of the simple integrator.
fn judge(
    about: &str,
    crate_events: &[Seen],
    [coarse, fine]: [&[Seen]; 2],
    has_kinks: bool,
    count: &mut Count,
) {
    // The error of the finer run is less than what halving the step has changed; where it steps
    // over a kink, it is of the order h².
    let floor = if has_kinks { STEP * STEP } else { 1e-9 };
    for i in 0..coarse.len().max(fine.len()).max(crate_events.len()) {
        let about = || format!("event {i}: {crate_events:?}\n{fine:?}\n{about}");
        let (Some(a), Some(b)) = (coarse.get(i), fine.get(i)) else {
            if coarse.len() == fine.len() {
                // One more in the crate's motion: only at the very end.
                assert!(crate_events[i].0 > DURATION - 1e-6, "{}", about());
            } else {
                count.undecided += 1;
            }
            return;
        };
        if (a.1, a.2) != (b.1, b.2) || (a.0 - b.0).abs() > 1e-3 {
            // Too close to call for so simple a method.
            count.undecided += 1;
            return;
        }
        let Some(event) = crate_events.get(i) else {
            assert!(b.0 > DURATION - 1e-6, "{}", about());
            return;
        };
        assert_eq!((event.1, event.2), (b.1, b.2), "{}", about());
        let difference = (event.0 - b.0).abs();
        let allowed = 2.0 * (a.0 - b.0).abs() + floor;
        assert!(
            difference <= allowed,
            "{difference:e} > {allowed:e}, {}",
            about()
        );
        count.worst = count.worst.max(difference);
        count.events += 1;
    }
}

#[test]
fn a_simple_integrator_sees_the_same_events() {
    let mut random = Random::new(77);
    let mut count = Count::default();
    let of_each = crate::common::count(10, 60);
    for _ in 0..of_each {
        let r = &mut random;
        let top = r.uniform(0.2, 0.8);
        let least = top * r.uniform(0.3, 1.0);
        let width = r.uniform(0.2, 1.0);
        let middle = 0.5 * (top + least);
        let slope = (least - top) / (2.0 * width);
        let mut formulas = vec![
            Formula::Polynomial([top, least, width]),
            Formula::Exponential([top, least, width]),
            Formula::Coulomb([top, least]),
            Formula::Rational([top, width, least, 0.02]),
        ];
        let stribeck = |exponent| Formula::Stribeck([top, least, width, 0.03], exponent);
        formulas.extend((1..=4).map(stribeck));
        // A table of a straight fall, with three points in a line: there the curve through them is
        // straight as well, and from the second on it has the chord's slope, to a level end.
        let ends = [
            [0.0, top, slope],
            [width, middle, slope],
            [2.0 * width, least, 0.0],
        ];
        formulas.push(Formula::Points(ends.to_vec(), 1.2 * top));
        formulas.push(Formula::Lines(vec![
            (0.0, top),
            (width, least),
            (2.0 * width, middle),
            (3.0 * width, middle),
        ]));
        formulas.push(Formula::Wave([top, top - least, 0.05 * top, 6.0]));
        for formula in formulas {
            compare(r, &formula, &mut count);
        }
    }
    println!("{count:?}");
    assert!(
        count.events > 25 * of_each && 100 * count.undecided < count.events,
        "{count:?}"
    );
}

/// The simple integrator is checked itself, by a number that neither it nor the crate has computed.
#[test]
fn the_simple_integrator_meets_the_known_slip_duration() {
    let paper = Formula::Polynomial([0.4, 0.25, 0.5]);
    let simple = Simple::new(&paper, 0.2, 0.05, 1.0);
    let seen = simple.run([0.0, 0.0], 8.0, |_| 1e-3).0;
    let (release, stick) = (seen[1], seen[2]);
    assert_eq!(
        (release.1, release.2, stick.1),
        ('r', Direction::Lagging.sign(), 's')
    );
    // 25 digits are known.
    assert_abs_diff_eq!(stick.0 - release.0, 5.169862999532134, epsilon = 1e-10);
}
