//! No search ends for stiffness: parameters that a user may well have, and strong dampers.

use crate::common::any::{cubic, rational};
use crate::common::{Random, count, on_belt, refused};
use stick_slip::limit_cycle::{attractor, find};
use stick_slip::{
    AnyLaw, Coulomb, Error, Exponential, FrictionLaw, MassOnBelt, Polynomial, Rational, State,
    Stribeck, Tabulated, bifurcation,
};

/// A law of any kind that falls over a speed, and may rise beyond it.
fn law(random: &mut Random, kind: usize, width: f64) -> Result<AnyLaw, Error> {
    let top = random.logarithmic(0.1, 1.0);
    let least = top * random.uniform(0.2, 0.95);
    let rise = random.uniform(0.0, 0.3) * top / width;
    Ok(match kind % 6 {
        0 => Polynomial::new(top, least, width)?.into(),
        1 => Exponential::new(top, least, width)?.into(),
        2 => Coulomb::new(top, least)?.into(),
        3 => Rational::new(top, 1.0 / width)?
            .with_offset(0.7 * least)?
            .with_quadratic(rise / width)?
            .into(),
        4 => Stribeck::new(top, least, width, 1 + (kind / 6 % 4) as u32)?
            .with_viscous_coefficient(rise)?
            .into(),
        _ => {
            let last = (3.0 * width, least + rise * width);
            let points = [
                (0.0, top),
                (0.4 * width, 0.5 * (top + least)),
                (width, least),
                last,
            ];
            Tabulated::new(points)?
                .with_static_coefficient(top * random.uniform(1.0, 1.5))?
                .into()
        }
    })
}

/// Load 0.01 to 10, v_b 0.02 to 3, β 0 to 5, speeds of the law 0.1 to 10 v_b.
fn reasonable(random: &mut Random, i: usize) -> Result<MassOnBelt<AnyLaw>, Error> {
    let v_b = random.logarithmic(0.02, 3.0);
    let width = v_b * random.logarithmic(0.1, 10.0);
    let law = law(random, i, width)?;
    let damping = match random.bits() % 4 {
        0 => 0.0,
        1 => random.uniform(0.0, 5.0),
        _ => random.logarithmic(1e-3, 5.0),
    };
    MassOnBelt::new(law, random.sign() * v_b)?
        .with_damping(damping)?
        .with_load(random.logarithmic(0.01, 10.0))
}

/// β 1 to 50, load 0.1 to 1000.
fn damped(random: &mut Random, i: usize) -> Result<MassOnBelt<AnyLaw>, Error> {
    let v_b = random.logarithmic(0.02, 3.0);
    let width = v_b * random.logarithmic(0.1, 10.0);
    let law = law(random, i, width)?;
    MassOnBelt::new(law, random.sign() * v_b)?
        .with_damping(random.logarithmic(1.0, 50.0))?
        .with_load(random.logarithmic(0.1, 1000.0))
}

/// Searches each of these systems, and asks where a motion from three starts goes.
fn none_fails(
    seed: u64,
    count: usize,
    system: fn(&mut Random, usize) -> Result<MassOnBelt<AnyLaw>, Error>,
) {
    let mut random = Random::new(seed);
    let mut failed = Vec::new();
    let (mut longest, mut found) = ((0.0, 0), 0);
    for i in 0..count {
        let system = system(&mut random, i).unwrap();
        let size = system.belt_velocity().abs() + system.load() * system.law().static_coefficient();
        let from = State::new(
            size * random.uniform(-1.0, 1.0),
            system.belt_velocity() * random.uniform(-0.5, 1.5),
        );
        let before = std::time::Instant::now();
        match find(&system) {
            Ok(cycles) => found += cycles.iter().count(),
            Err(error) => failed.push(format!("find {i}: {error} {system:?}")),
        }
        for start in [State::new(0.0, 0.0), from] {
            if let Err(error) = attractor(&system, start) {
                failed.push(format!("attractor {i}: {error} {system:?} {start:?}"));
            }
        }
        let spent = before.elapsed().as_secs_f64();
        if spent > longest.0 {
            longest = (spent, i);
        }
    }
    println!("{count} systems, {found} cycles, longest {longest:?}");
    assert!(failed.is_empty(), "{}\n{}", failed.len(), failed.join("\n"));
}

#[test]
fn no_search_of_a_reasonable_system_fails() {
    none_fails(31, count(120, 1000), reasonable);
}

#[test]
fn no_search_of_a_strongly_damped_system_fails() {
    none_fails(32, count(20, 160), damped);
}

/// Belt velocities over four decades, and damping ratios, of reasonable systems.
#[test]
fn no_range_fails_for_one_velocity_that_is_stiff() {
    let mut random = Random::new(33);
    let mut failed = Vec::new();
    for i in 0..count(1, 16) {
        let system = reasonable(&mut random, i).unwrap();
        let v_b = system.belt_velocity().abs();
        let range = 1e-2 * v_b..100.0 * v_b;
        let of_range = [
            (
                "grazing",
                bifurcation::grazing_velocities(&system, range.clone()).err(),
            ),
            (
                "folds",
                bifurcation::fold_velocities(&system, range.clone()).err(),
            ),
            (
                "overshoot",
                bifurcation::overshoot_velocities(&system, range).err(),
            ),
            ("silencing", bifurcation::silencing_damping(&system).err()),
        ];
        for (what, error) in of_range {
            if let Some(error) = error {
                failed.push(format!("{what} {i}: {error} {system:?}"));
            }
        }
    }
    assert!(failed.is_empty(), "{}\n{}", failed.len(), failed.join("\n"));
}

/// Hostile systems whose search gave up while a motion crept to a stable node.
#[test]
fn motions_that_creep_to_a_node_are_concluded() {
    let systems = [
        (
            rational(
                0.1441495499283929,
                9864.047260016057,
                0.09383026070596923,
                74693.02141794178,
            ),
            [1.7722105085627644, 1.069448586069713e-5, 74.81290945499386],
        ),
        (
            cubic(
                0.018973465889142727,
                0.012045744032001109,
                0.0008498348035486757,
            ),
            [434.51565054882354, 5.441088758763837, 5.695829398656496e-5],
        ),
        (
            cubic(
                0.020313670292533375,
                0.015584253411722683,
                0.00012781431572079507,
            ),
            [
                -0.0007371323172936102,
                0.0004001191642210705,
                1797.4961740871224,
            ],
        ),
        (
            rational(
                0.05571903891839205,
                7942.789706347661,
                0.034110817074113,
                2699.125941559547,
            ),
            [0.014846745495592445, 0.45443999929949636, 994.7786406704731],
        ),
    ];
    for (law, [v_b, damping, load]) in systems {
        let system = on_belt(law, v_b, damping, load);
        assert_eq!(find(&system).unwrap().iter().count(), 0, "{system:?}");
        let goes_to = attractor(&system, State::new(0.0, 0.0)).unwrap();
        assert_eq!(goes_to.to_string(), "steady sliding", "{system:?}");
    }
}

/// The damper is at least fifty times as strong as friction falls: steady sliding attracts every
/// motion. The forces are up to 10⁴³ times as large as the belt's velocity, and so are their
/// rounding errors, which once brought tangential motions back to the belt, or hid all growth.
#[test]
fn no_damper_is_so_strong_that_a_cycle_is_left_open() {
    let mut random = Random::new(20);
    for i in 0..count(60, 3000) {
        let v_b = random.logarithmic(1e-3, 1e3);
        let width = v_b * random.logarithmic(0.1, 10.0);
        let law = law(&mut random, i, width).unwrap();
        // From a breakpoint of a law, a step of 1/β may not change the speed if β is larger.
        let is_smooth = law.breakpoints().next().is_none();
        let damping = random.logarithmic(3.0, if is_smooth { 1e40 } else { 1e8 });
        // No law falls faster than at the rate 5/width.
        let load = damping * width * random.logarithmic(1e-8, 4e-3);
        let system = MassOnBelt::new(law, random.sign() * v_b)
            .and_then(|system| system.with_damping(damping)?.with_load(load))
            .unwrap();
        let cycles = find(&system).unwrap_or_else(|error| panic!("{i}: {system} {error:?}"));
        let none = cycles.is_empty() && cycles.unresolved().is_empty();
        assert!(none, "{i}: {system} {cycles:?}");
    }
}

/// The growth of a small motion is hidden if rounding keeps it at an equilibrium that repels.
#[test]
fn a_repelling_equilibrium_is_never_without_a_cycle_or_an_open_range() {
    let law = Exponential::new(0.4, 0.25, 1.0).unwrap();
    for load in [1e7, 1e9, 1e11] {
        let hopf = 0.15 * (-1.0_f64).exp() * load;
        for beside in [1e-10, 1e-8, 1e-6] {
            let system = MassOnBelt::new(law, 1.0).unwrap();
            let system = system.with_load(load).unwrap();
            let system = system.with_damping(hopf * (1.0 - beside)).unwrap();
            let cycles = find(&system).unwrap();
            let none = cycles.is_empty() && cycles.unresolved().is_empty();
            assert!(!none, "{system} {cycles:?}");
        }
    }
}

/// On the slowest belt the rounding errors of forces are zero, and searches end all the same.
#[test]
fn searches_of_the_slowest_belt_end() {
    let law = Polynomial::new(0.4, 0.25, 0.5).unwrap();
    let system = on_belt(law, f64::from_bits(1), 0.05, 1.0);
    let found = bifurcation::silencing_load(&system);
    // Half the load that the belt's velocity gives is no number.
    refused!(found => Error::At { parameter: "load", value: 0.0, .. });
}
