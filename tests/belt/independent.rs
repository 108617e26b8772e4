//! A simple integrator, written without an idea of the crate's, must see the same events.

use crate::common::simple::{Seen, Simple, told};
use crate::common::{Random, on_belt};
use approx::assert_abs_diff_eq;
use stick_slip::{
    Coulomb, Direction, Error, Exponential, FrictionLaw, Polynomial, Rational, State, Stribeck,
    Tabulated,
};

/// How often the two were compared.
#[derive(Debug, Default)]
struct Count {
    events: usize,
    undecided: usize,
    worst: f64,
}

/// Follows one random motion by both. `friction` is the law once more, written in plain numbers.
fn compare<L: FrictionLaw>(
    random: &mut Random,
    law: Result<L, Error>,
    friction: &dyn Fn(f64) -> f64,
    count: &mut Count,
) {
    let (belt, damping) = (
        random.sign() * random.logarithmic(0.05, 1.5),
        random.uniform(0.0, 0.3),
    );
    let load = random.logarithmic(0.1, 4.0);
    let system = on_belt(law.unwrap(), belt, damping, load);
    let start = [random.uniform(-2.0, 2.0), random.uniform(-2.0, 2.0)];
    let simple = Simple {
        friction: &|s| load * friction(s),
        static_friction: load * system.law().static_coefficient(),
        damping,
        belt,
    };
    let motion = system
        .simulate(State::new(start[0], start[1]), DURATION)
        .unwrap();
    let has_kinks = system.law().breakpoints().next().is_some();
    let about = format!("belt {belt} damping {damping} load {load} start {start:?}");
    let [coarse, fine] = [2.0 * STEP, STEP].map(|h| simple.run(start, DURATION, |_| h).0);
    judge(
        &about,
        &told(motion.events()),
        [&coarse, &fine],
        has_kinks,
        count,
    );
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
        let fall = top - least;
        compare(
            r,
            Polynomial::new(top, least, width),
            &|s| {
                let x = s / width;
                top + fall * (0.5 * x * x * x - 1.5 * x)
            },
            &mut count,
        );
        compare(
            r,
            Exponential::new(top, least, width),
            &|s| least + fall * (-(s / width) * (s / width)).exp(),
            &mut count,
        );
        compare(r, Coulomb::new(top, least), &|_| least, &mut count);
        let rational = Rational::new(top, 1.0 / width)
            .and_then(|law| law.with_offset(least)?.with_quadratic(0.02));
        compare(
            r,
            rational,
            &|s| fall * width / (width + s) + least + 0.02 * s * s,
            &mut count,
        );
        for exponent in 1..=4 {
            let stribeck = Stribeck::new(top, least, width, exponent)
                .and_then(|law| law.with_viscous_coefficient(0.03));
            compare(
                r,
                stribeck,
                &|s| least + fall * (-(s / width).powi(exponent as i32)).exp() + 0.03 * s,
                &mut count,
            );
        }
        // A table of a straight fall and rise, with three points in a line: there the curve through
        // them is straight as well.
        let points = [
            (0.0, top),
            (width, 0.5 * (top + least)),
            (2.0 * width, least),
        ];
        let raised = 1.2 * top;
        let table = Tabulated::new(points).and_then(|law| law.with_static_coefficient(raised));
        let (slope, middle) = (-fall / (2.0 * width), 0.5 * (top + least));
        compare(
            r,
            table,
            &|s| {
                if s <= width {
                    return top + slope * s;
                }
                // From there with the chord's slope to a level end: Hermite's cubic.
                let t = ((s - width) / width).min(1.0);
                let basis = [
                    (1.0 + 2.0 * t) * (1.0 - t) * (1.0 - t),
                    t * (1.0 - t) * (1.0 - t),
                ];
                least + (middle - least) * basis[0] + slope * width * basis[1]
            },
            &mut count,
        );
        let points = vec![
            (0.0, top),
            (width, least),
            (2.0 * width, middle),
            (3.0 * width, middle),
        ];
        let broken = crate::common::Table {
            static_coefficient: top,
            points,
        };
        compare(
            r,
            Ok(broken),
            &|s| match s / width {
                x if x < 1.0 => top - x * fall,
                x if x < 2.0 => least + (x - 1.0) * (middle - least),
                _ => middle,
            },
            &mut count,
        );
        let wave = crate::common::any::Wave {
            static_coefficient: top,
            fall,
            height: 0.05 * top,
            number: 6.0,
        };
        compare(
            r,
            Ok(wave),
            &|s| top - fall * s / (1.0 + s) + 0.05 * top * ((6.0 * s).cos() - 1.0),
            &mut count,
        );
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
    let simple = Simple {
        friction: &|s| 0.4 - 0.45 * s + 0.6 * s * s * s,
        static_friction: 0.4,
        damping: 0.05,
        belt: 0.2,
    };
    let seen = simple.run([0.0, 0.0], 8.0, |_| 1e-3).0;
    let (release, stick) = (seen[1], seen[2]);
    assert_eq!(
        (release.1, release.2, stick.1),
        ('r', Direction::Lagging.sign(), 's')
    );
    // 25 digits are known.
    assert_abs_diff_eq!(stick.0 - release.0, 5.169862999532134, epsilon = 1e-10);
}
