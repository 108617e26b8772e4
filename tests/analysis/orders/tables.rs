//! The formulas of `analysis`, beside what they stand for, and the orders of their errors.

use std::f64::consts::TAU;

use stick_slip::analysis::averaging::{self, AveragedCycle};
use stick_slip::analysis::{PureSlip, PureSlipCycle, StickSlip, StickSlipCycle};

use super::points::Point;
use Series::{Halves, Whole};

type Exact = fn(&Point) -> f64;
type PureSlipRow = (&'static str, fn(&PureSlipCycle) -> f64, Exact, [f64; 4]);
type PaperRow = (&'static str, fn(&StickSlip) -> f64, Exact, f64, Series);
type StickSlipRow = (
    &'static str,
    fn(&StickSlipCycle) -> f64,
    Exact,
    [f64; 2],
    Series,
);
/// The formula takes the averaged cycle at ε = 1, and ε.
pub(crate) type AveragedRow = (&'static str, fn(&AveragedCycle, f64) -> f64, Exact, f64);

/// Quantity, formula, exact value, order of the error at first to fourth order.
#[rustfmt::skip]
const PURE_SLIP_FORMULAS: &[PureSlipRow] = &[
    ("z_max",           |f| f.z_max,          Point::z_max,                      [2., 3., 4., 4.]),
    ("z_min",           |f| f.z_min,          Point::z_min,                      [2., 3., 4., 4.]),
    ("u_max",           |f| f.u_max,          |x| x.cycle.max_displacement(),    [2., 3., 4., 4.]),
    ("u_min",           |f| f.u_min,          |x| x.cycle.min_displacement(),    [2., 3., 4., 4.]),
    ("amplitude",       |f| f.amplitude,      |x| x.cycle.amplitude(),           [2., 4., 4., 4.]),
    ("(z_max+z_min)/2", |f| 0.5 * (f.z_max + f.z_min),
                                              |x| 0.5 * (x.z_max() + x.z_min()), [3., 3., 5., 5.]),
    ("v_max",           |f| f.v_max,          |x| x.cycle.max_velocity(),        [2., 4., 4., 4.]),
    ("v_min",           |f| f.v_min,          |x| x.cycle.min_velocity(),        [2., 4., 4., 4.]),
    ("z_mean",          |f| f.z_mean,         Point::z_mean,                     [3., 3., 5., 5.]),
    ("u_mean",          |f| f.u_mean,         |x| x.cycle.mean_displacement(),   [3., 3., 5., 5.]),
    ("frequency",       |f| f.frequency,      |x| TAU / x.cycle.period(),        [2., 4., 4., 6.]),
    ("period",          |f| f.period,         |x| x.cycle.period(),              [2., 4., 4., 6.]),
    ("log_multiplier",  |f| f.log_multiplier, |x| x.cycle.multiplier().ln(),     [3., 3., 5., 5.]),
    ("multiplier",      |f| f.multiplier,     |x| x.cycle.multiplier(),          [3., 3., 5., 5.]),
    ("first harmonic",  |f| f.harmonics[0],   |x| x.harmonic(1),                 [2., 4., 4., 4.]),
    ("second harmonic", |f| f.harmonics[1],   |x| x.harmonic(2),                 [3., 3., 3., 3.]),
    ("third harmonic",  |f| f.harmonics[2],   |x| x.harmonic(3),                 [3., 3., 3., 3.]),
];

/// A0 (Eqs. 13 and 15, corrected) and its multiplier. As u_max − ū it is poor: the motion is not
/// centred on ū.
#[rustfmt::skip]
const AVERAGED_PURE_SLIP: &[AveragedRow] = &[
    ("A0 as half the range of u", |f, _| f.amplitude(),          |x| x.cycle.amplitude(),     2.0),
    ("A0 as v_max",               |f, _| f.amplitude(),          |x| x.cycle.max_velocity(),  2.0),
    ("A0 as −v_min",              |f, _| f.amplitude(),          |x| -x.cycle.min_velocity(), 2.0),
    ("A0 as u_max − ū",           |f, _| f.amplitude(),          Point::z_max,                1.0),
    ("A0 as ū − u_min",           |f, _| f.amplitude(),          |x| -x.z_min(),              1.0),
    ("2π as T",                   |_, _| TAU,                    |x| x.cycle.period(),        2.0),
    ("multiplier",                |f, e| f.multiplier().powf(e), |x| x.cycle.multiplier(),    3.0),
    ("drift_slope",               |f, e| e * f.drift_slope(),    Point::growth_rate,          3.0),
];

#[rustfmt::skip]
pub(crate) const AVERAGED_CROSSING: &[AveragedRow] = &[
    ("A as half the range",     |f, _| f.amplitude(),          |x| x.cycle.amplitude(),        2.0),
    ("A as v_max",              |f, _| f.amplitude(),          |x| x.cycle.max_velocity(),     2.0),
    ("A as −v_min",             |f, _| f.amplitude(),          |x| -x.cycle.min_velocity(),    2.0),
    ("A as u_max − ū",          |f, _| f.amplitude(),          Point::z_max,                   1.0),
    ("A as ū − u_min",          |f, _| f.amplitude(),          |x| -x.z_min(),                 1.0),
    ("2π as T",                 |_, _| TAU,                    |x| x.cycle.period(),           2.0),
    ("time ahead of the belt",  |f, _| f.leading_duration(),   |x| x.cycle.leading_duration(), 2.0),
    ("multiplier",              |f, e| f.multiplier().powf(e), |x| x.cycle.multiplier(),       3.0),
    ("drift_slope",             |f, e| e * f.drift_slope(),    Point::growth_rate,             3.0),
];

/// The paper's stick-slip formulas as they are.
#[rustfmt::skip]
const PAPER_STICK_SLIP: &[PaperRow] = &[
    ("Eq. 18, A1 as u_max − ū", |f| f.amplitude(), Point::z_max, 1.0, Whole),
    ("Eq. 18, A1 as ū − u_min", |f| f.amplitude(), |x| -x.z_min(), 1.0, Whole),
    ("Eq. 18, A1 as half the range", |f| f.amplitude(), |x| x.cycle.amplitude(), 1.0, Whole),
    ("Eq. 17, amplitude of v", |f| f.velocity_amplitude(), |x| -x.cycle.min_velocity(), 1.0, Whole),
    ("after Eq. 18, T", |f| f.period(), |x| x.cycle.period(), 1.5, Halves),
    ("after Eq. 18, ω_ss", |f| f.frequency(), |x| TAU / x.cycle.period(), 1.5, Halves),
    ("2π as T, no worse", |_| TAU, |x| x.cycle.period(), 1.5, Halves),
    ("Eqs. 16-18, stick 2κ", |f| f.stick_duration(), |x| x.cycle.stick_duration(), 0.5, Halves),
    ("Eqs. 16-18, slip 2π − 2 atan κ", |f| f.slip_duration(), Point::slip, 0.5, Halves),
];

/// `v_max` = v_b is exact. `return_angle` is the phase reckoned from where the mass meets the belt
/// to the release point.
#[rustfmt::skip]
const STICK_SLIP_FORMULAS: &[StickSlipRow] = &[
    ("z_max",        |f| f.z_max,        Point::z_max,                        [2.0, 3.0], Whole),
    ("z_min",        |f| f.z_min,        Point::z_min,                        [2.0, 3.0], Whole),
    ("u_max",        |f| f.u_max,        |x| x.cycle.max_displacement(),      [2.0, 3.0], Whole),
    ("u_min",        |f| f.u_min,        |x| x.cycle.min_displacement(),      [2.0, 3.0], Whole),
    ("v_min",        |f| f.v_min,        |x| x.cycle.min_velocity(),          [2.0, 3.0], Whole),
    ("growth",       |f| f.growth,       Point::growth,                       [2.0, 3.0], Whole),
    ("return_angle", |f| f.return_angle, |x| x.cycle.stick_duration().atan(), [1.5, 2.0], Halves),
    ("stick",        |f| f.stick,        |x| x.cycle.stick_duration(),        [1.5, 2.5], Halves),
    ("slip",         |f| f.slip,         Point::slip,                         [1.5, 2.5], Halves),
    ("period",       |f| f.period,       |x| x.cycle.period(),                [2.0, 3.0], Halves),
];

/// Powers of ε in which an error goes on after its first term: ε or √ε times the one before.
#[derive(Clone, Copy)]
pub(crate) enum Series {
    Whole,
    Halves,
}

/// The errors of one formula for each system, at ε = 1, 1/2, …, with the noise in each.
pub(crate) type Errors = [Vec<(f64, f64)>];

fn errors(
    systems: &[Vec<Point>],
    formula: impl Fn(&Point) -> f64,
    exact: Exact,
) -> Vec<Vec<(f64, f64)>> {
    let error = |point: &Point| ((formula(point) - exact(point)).abs(), point.noise);
    systems
        .iter()
        .map(|points| points.iter().map(error).collect())
        .collect()
}

/// Hands to `judge` each row of the tables: name, order that is stated, series, errors.
pub(crate) fn pure_slip_rows(
    systems: &[Vec<Point>],
    mut judge: impl FnMut(&str, f64, Series, &Errors),
) {
    type Order = fn(&PureSlip) -> Option<PureSlipCycle>;
    const ORDERS: [Order; 4] = [
        PureSlip::first_order,
        PureSlip::second_order,
        PureSlip::third_order,
        PureSlip::fourth_order,
    ];
    for (name, field, exact, orders) in PURE_SLIP_FORMULAS {
        for (k, cycle) in ORDERS.iter().enumerate() {
            let formula = |point: &Point| {
                field(
                    &PureSlip::new(&point.system)
                        .and_then(|f| cycle(&f))
                        .unwrap(),
                )
            };
            judge(
                &format!("{name}, through ε^{}", k + 1),
                orders[k],
                Whole,
                &errors(systems, formula, *exact),
            );
        }
    }
    averaged_rows(systems, AVERAGED_PURE_SLIP, judge);
}

/// ε changes no bit of an averaged amplitude, and the drift in proportion:
/// `averaging::amplitudes_do_not_depend_on_the_size_of_the_friction`. So one cycle serves all ε.
pub(crate) fn averaged_rows(
    systems: &[Vec<Point>],
    table: &[AveragedRow],
    mut judge: impl FnMut(&str, f64, Series, &Errors),
) {
    let averaged: Vec<AveragedCycle> = systems
        .iter()
        .map(|points| averaging::cycles(&points[0].system).unwrap().pop().unwrap())
        .collect();
    for (name, field, exact, stated) in table {
        let errors: Vec<Vec<(f64, f64)>> = std::iter::zip(systems, &averaged)
            .map(|(points, averaged)| {
                let error = |point: &Point| {
                    let epsilon = point.system.load() / points[0].system.load();
                    ((field(averaged, epsilon) - exact(point)).abs(), point.noise)
                };
                points.iter().map(error).collect()
            })
            .collect();
        judge(name, *stated, Whole, &errors);
    }
}

pub(crate) fn stick_slip_rows(
    systems: &[Vec<Point>],
    mut judge: impl FnMut(&str, f64, Series, &Errors),
) {
    type Order = fn(&StickSlip) -> Option<StickSlipCycle>;
    const ORDERS: [Order; 2] = [StickSlip::first_order, StickSlip::second_order];
    for (name, field, exact, stated, series) in PAPER_STICK_SLIP {
        let formula = |point: &Point| field(&StickSlip::new(&point.system).unwrap());
        judge(name, *stated, *series, &errors(systems, formula, *exact));
    }
    for (name, field, exact, orders, series) in STICK_SLIP_FORMULAS {
        for (k, cycle) in ORDERS.iter().enumerate() {
            let formula = |point: &Point| {
                field(
                    &StickSlip::new(&point.system)
                        .and_then(|f| cycle(&f))
                        .unwrap(),
                )
            };
            judge(
                &format!("{name}, through ε^{}", k + 1),
                orders[k],
                *series,
                &errors(systems, formula, *exact),
            );
        }
    }
}
