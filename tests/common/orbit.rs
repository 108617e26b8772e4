//! The tests' own view of periodic motions: return maps from simulated turns, quadrature, extremes
//! of a run.

use std::sync::LazyLock;

use stick_slip::nalgebra::DMatrix;
use stick_slip::orbit::Oscillator;
use stick_slip::{
    CycleSet, Direction, Error, EventKind, FrictionLaw, Integrator, LimitCycle, MassOnBelt, Mode,
    State, Step, Trajectory, limit_cycle, structure,
};

/// The steps of a motion, and its monodromy matrix: by methods of a supertrait of [`Oscillator`]
/// that programs cannot name.
pub fn monodromy(
    system: &impl Oscillator,
    start: &structure::State,
    duration: f64,
) -> Result<(Vec<structure::Step>, DMatrix<f64>), Error> {
    let map = system.form().period_map(start, duration)?;
    Ok((map.steps().to_vec(), map.monodromy().clone()))
}

/// The time between the last two sticks of a motion.
pub fn last_turn(motion: &Trajectory<structure::State>) -> f64 {
    let sticks = motion.events().iter().rev();
    let mut sticks = sticks.filter(|event| event.kind == EventKind::Stick);
    let [last, before] = [sticks.next(), sticks.next()].map(|event| event.unwrap().time);
    last - before
}

/// Nodes on [−1, 1] and weights of the Gauss-Legendre rule of 20 points.
static RULE: LazyLock<[(f64, f64); 20]> = LazyLock::new(|| {
    const N: usize = 20;
    let legendre = |x: f64| {
        let (mut p, mut last) = (x, 1.0);
        for k in 2..=N {
            let k = k as f64;
            (p, last) = (((2.0 * k - 1.0) * x * p - (k - 1.0) * last) / k, p);
        }
        (p, N as f64 * (x * p - last) / (x * x - 1.0))
    };
    std::array::from_fn(|i| {
        let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / (N as f64 + 0.5)).cos();
        for _ in 0..6 {
            let (p, slope) = legendre(x);
            x -= p / slope;
        }
        let slope = legendre(x).1;
        (x, 2.0 / ((1.0 - x * x) * slope * slope))
    })
});

/// ∫ over [0, h] by Gauss-Legendre rules of 20 points, on 4 pieces.
pub fn integrate(h: f64, mut f: impl FnMut(f64) -> f64) -> f64 {
    let width = h / 4.0;
    let mut sum = 0.0;
    for (x, weight) in *RULE {
        for piece in 0..4 {
            sum += weight * f(width * (f64::from(piece) + 0.5 * (1.0 + x)));
        }
    }
    0.5 * width * sum
}

/// What a simulated turn comes to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Turn {
    /// Again at a velocity maximum V, or at a downward crossing at u.
    Returns(f64),
    /// Up to the belt, or in stick.
    Belt,
    /// Nothing of both within the time allowed.
    Ends,
}

const TURN: f64 = 60.0;

/// The state with the velocity maximum V, for v_b > 0.
pub fn at_peak<L: FrictionLaw>(system: &MassOnBelt<L>, peak: f64) -> State {
    let friction = system.load() * system.law().kinetic(system.belt_velocity() - peak);
    State::new(friction - 2.0 * system.damping() * peak, peak)
}

/// The next velocity maximum below v_b > 0 after the one at V.
pub fn next_peak<L: FrictionLaw>(system: &MassOnBelt<L>, peak: f64) -> Turn {
    let mut backwards = false;
    for step in Integrator::new()
        .flow(system, at_peak(system, peak))
        .unwrap()
    {
        let step: Step = step.unwrap();
        if step.mode() != Mode::Slip(Direction::Lagging) {
            return Turn::Belt;
        }
        if step.end_time() >= TURN {
            return Turn::Ends;
        }
        let time = |i: u32| step.duration() * f64::from(i) / 16.0;
        let states: [State; 17] = std::array::from_fn(|i| step.state_at(time(i as u32)));
        for i in 0..16 {
            let [before, after] = [states[i], states[i + 1]];
            backwards |= before.velocity < 0.0;
            let last = i == 15 && step.event().is_some();
            if backwards
                && !last
                && after.velocity > 0.0
                && system.acceleration(before) > 0.0
                && system.acceleration(after) <= 0.0
            {
                let (mut a, mut b) = (time(i as u32), time(i as u32 + 1));
                let rate = |t: f64| system.acceleration(step.state_at(t));
                for _ in 0..60 {
                    let middle = 0.5 * (a + b);
                    if rate(middle) > 0.0 {
                        a = middle;
                    } else {
                        b = middle;
                    }
                }
                return Turn::Returns(step.state_at(a).velocity);
            }
        }
        if step.event().is_some() {
            return Turn::Belt;
        }
    }
    Turn::Ends
}

/// The next downward crossing after one at u, beyond the release point, for v_b > 0.
pub fn next_crossing<L: FrictionLaw>(system: &MassOnBelt<L>, displacement: f64) -> Turn {
    let start = State::new(displacement, system.belt_velocity());
    for step in Integrator::new().flow(system, start).unwrap() {
        let step: Step = step.unwrap();
        if step.mode() == Mode::Stick {
            return Turn::Belt;
        }
        if let Some(event) = step.event() {
            match event.kind {
                EventKind::Crossing(Direction::Lagging) => {
                    return Turn::Returns(event.state.displacement);
                }
                EventKind::Crossing(Direction::Leading) => (),
                _ => return Turn::Belt,
            }
        }
        if step.end_time() >= TURN {
            return Turn::Ends;
        }
    }
    Turn::Ends
}

/// Least and largest displacement over the last `window` of a run.
pub fn settles<L: FrictionLaw>(
    system: &MassOnBelt<L>,
    start: State,
    duration: f64,
    window: f64,
) -> [f64; 2] {
    let mut range = [f64::INFINITY, f64::NEG_INFINITY];
    for step in Integrator::new().flow(system, start).unwrap() {
        let step: Step = step.unwrap();
        if step.end_time() > duration - window {
            let length = step.duration().min(8.0);
            for i in 0..=256 {
                let u = step.state_at(length * f64::from(i) / 256.0).displacement;
                range = [range[0].min(u), range[1].max(u)];
            }
        }
        if step.end_time() > duration {
            break;
        }
    }
    range
}

/// The cycles of a system.
pub fn find<L: FrictionLaw>(about: &str, system: &MassOnBelt<L>) -> CycleSet {
    limit_cycle::find(system).unwrap_or_else(|error| panic!("{about}: {error}"))
}

/// The largest of |u|, |v| and |v_b| on a cycle.
pub fn size<L: FrictionLaw>(system: &MassOnBelt<L>, cycle: &LimitCycle) -> f64 {
    [
        cycle.max_displacement(),
        cycle.min_displacement(),
        cycle.max_velocity(),
        cycle.min_velocity(),
        system.belt_velocity(),
    ]
    .into_iter()
    .fold(0.0, |largest, x: f64| largest.max(x.abs()))
}

/// ∮ over a cycle, by the tests' own quadrature.
pub fn around(cycle: &LimitCycle, mut integrand: impl FnMut(f64, State) -> f64) -> f64 {
    cycle
        .trajectory()
        .steps()
        .iter()
        .map(|step| {
            integrate(step.duration(), |t| {
                integrand(step.start_time() + t, step.state_at(t))
            })
        })
        .sum()
}
