//! Examples of the Modelica Standard Library, package `Mechanics.Rotational.Examples`, with their
//! own numbers, in SI units.

use std::f64::consts::PI;

use approx::assert_abs_diff_eq;
use stick_slip::structure::State;
use stick_slip::{
    Contact, Coulomb, Direction, Drive, EventKind, ForceElement, ForceLaw, Scalar, Stop, Structure,
    Tabulated, Trajectory,
};

fn even(coefficient: f64) -> Coulomb {
    Coulomb::new(coefficient, coefficient).unwrap()
}

fn keys(motion: &Trajectory<State>) -> Vec<(usize, EventKind)> {
    let events = motion.events().iter();
    events
        .map(|event| (event.contact().unwrap(), event.kind))
        .collect()
}

/// A torque that brakes by the square of the speed.
#[derive(Clone)]
struct Quadratic {
    torque: f64,
    at: f64,
}

impl Quadratic {
    fn at(&self, speed: f64) -> f64 {
        self.torque * (speed / self.at).powi(2)
    }
}

impl ForceLaw for Quadratic {
    fn force<S: Scalar>(&self, _: S, velocity: S, _: usize) -> S {
        (velocity * (1.0 / self.at)).square() * self.torque
    }
}

/// The classical Runge-Kutta method over a time, in so many steps.
fn march(
    state: [f64; 2],
    [begin, end]: [f64; 2],
    steps: usize,
    rates: &dyn Fn(f64, [f64; 2]) -> [f64; 2],
) -> [f64; 2] {
    let h = (end - begin) / steps as f64;
    let moved = |x: [f64; 2], h: f64, k: [f64; 2]| [x[0] + h * k[0], x[1] + h * k[1]];
    (0..steps).fold(state, |x, i| {
        let t = begin + h * i as f64;
        let first = rates(t, x);
        let second = rates(t + 0.5 * h, moved(x, 0.5 * h, first));
        let third = rates(t + 0.5 * h, moved(x, 0.5 * h, second));
        let last = rates(t + h, moved(x, h, third));
        let sum = |i: usize| first[i] + 2.0 * (second[i] + third[i]) + last[i];
        moved(x, h / 6.0, [sum(0), sum(1)])
    })
}

/// The time at which a function of the state falls to 0, and the state there.
fn fall_to_zero(
    state: [f64; 2],
    [begin, end]: [f64; 2],
    rates: &dyn Fn(f64, [f64; 2]) -> [f64; 2],
    left: &dyn Fn(f64, [f64; 2]) -> f64,
) -> (f64, [f64; 2]) {
    let at = |time: f64| march(state, [begin, time], 300, rates);
    let [mut low, mut high] = [begin, end];
    assert!(left(low, state) > 0.0 && left(high, at(high)) < 0.0);
    while high - low > 1e-15 {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        if left(middle, at(middle)) > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    (low, at(low))
}

/// `SimpleGearShift`: an engine on the sun of a planetary gear (75 to 50 teeth) and a load on the
/// carrier. A brake holds the ring, then a clutch takes over from it and connects ring and sun. The
/// ring has no inertia.
#[test]
fn a_gear_is_shifted() {
    let ratio = 1.5;
    let load = Quadratic {
        torque: 20.0,
        at: 10.471975511966,
    };
    let ring = [(0, -1.0 / ratio), (1, (1.0 + ratio) / ratio)];
    let slip = [(0, 1.0 + 1.0 / ratio), (1, -(1.0 + ratio) / ratio)];
    let part =
        |from: f64, to: f64| Drive::profile(&[(2.0, 200.0 * from), (2.1, 200.0 * to)]).unwrap();
    let step = Drive::profile(&[(0.5, 0.0), (0.5, 20.0)]).unwrap();
    let gear = Structure::new(&[1.0, 10.0])
        .and_then(|s| s.with_force(0, step))
        .and_then(|s| s.with_element(ForceElement::new(1, load.clone())?))
        .and_then(|s| s.with_contact(Contact::along(&ring, even(0.5), part(1.0, 0.0))?))
        .and_then(|s| s.with_contact(Contact::along(&slip, even(0.5), part(0.0, 1.0))?))
        .unwrap();
    let motion = gear.simulate(State::at_rest(2), 5.0).unwrap();
    let [brake, clutch] = [0, 1];
    let forward = EventKind::Release(Direction::Leading);
    let expected = [
        (clutch, EventKind::Close),
        (brake, forward),
        (brake, EventKind::Open),
        (clutch, EventKind::Stick),
    ];
    assert_eq!(keys(&motion), expected);
    let times: Vec<f64> = motion.events().iter().map(|event| event.time).collect();
    let speeds = |time: f64| motion.state_at(time).unwrap().velocities;
    // First gear: with v the speed of the carrier, 16.25 v' = 50 − 20 (v/v_0)².
    let top = load.at * 2.5_f64.sqrt();
    let first_gear = |time: f64| top * (50.0 / (16.25 * top) * f64::max(time - 0.5, 0.0)).tanh();
    for time in [0.3, 0.5, 1.2, 2.0] {
        let speed = first_gear(time);
        assert_abs_diff_eq!(speeds(time)[0], 2.5 * speed, epsilon = 1e-14);
        assert_abs_diff_eq!(speeds(time)[1], speed, epsilon = 1e-14);
    }
    // The brake holds while the clutch slips and its torque T = 100 u grows.
    let shifts = |t: f64| ((t - 2.0) / 0.1).clamp(0.0, 1.0);
    let held = |t: f64, [_, carrier]: [f64; 2]| {
        let rate = (2.5 * (20.0 - 100.0 * shifts(t)) - load.at(carrier)) / 16.25;
        [2.5 * rate, rate]
    };
    let left = |t: f64, x: [f64; 2]| {
        let (torque, [sun, _]) = (100.0 * shifts(t), held(t, x));
        let brake = torque + ratio * (sun - 20.0 + torque);
        100.0 - torque - brake
    };
    let speed = first_gear(2.0);
    let (released, x) = fall_to_zero([2.5 * speed, speed], [2.0, 2.1], &held, &left);
    assert_eq!(times[0], 2.0);
    assert_abs_diff_eq!(times[1], released, epsilon = 1e-14);
    // Both slip: the torque of the gear on the sun follows from the balance of the ring.
    let both = |t: f64, [_, carrier]: [f64; 2]| {
        let torque = 100.0 * shifts(t);
        let gear = (100.0 - 2.0 * torque) / ratio;
        let on_carrier = -(1.0 + ratio) * gear - load.at(carrier);
        [20.0 - torque + gear, on_carrier / 10.0]
    };
    let x = march(x, [released, 2.1], 300, &both);
    assert_eq!(times[2], 2.1);
    assert_abs_diff_eq!(speeds(2.1)[0], x[0], epsilon = 1e-13);
    assert_abs_diff_eq!(speeds(2.1)[1], x[1], epsilon = 1e-13);
    let slips = |_: f64, [sun, carrier]: [f64; 2]| sun - carrier;
    let (locked, x) = fall_to_zero(x, [2.1, 2.3], &both, &slips);
    assert_abs_diff_eq!(times[3], locked, epsilon = 1e-14);
    // Direct gear: 11 v' = 20 − 20 (v/v_0)².
    let rate = 20.0 / (11.0 * load.at);
    for time in [3.0, 5.0] {
        let speed = load.at * ((x[1] / load.at).atanh() + rate * (time - locked)).tanh();
        assert_abs_diff_eq!(speeds(time)[0], speed, epsilon = 1e-13);
        assert_abs_diff_eq!(speeds(time)[1], speed, epsilon = 1e-13);
    }
}

/// `OneWayClutch`: a freewheel with a friction clutch in parallel, which a pulse engages; two
/// contacts of the same direction. Its static friction is 25 times its kinetic friction.
#[test]
fn a_one_way_clutch_is_engaged_by_pulses() {
    let torque = Drive::sine(10.0, 6.0 * PI).unwrap();
    let pulses = [
        (0.3, 0.0),
        (0.3, 3.0),
        (0.95, 3.0),
        (0.95, 0.0),
        (1.6, 0.0),
        (1.6, 3.0),
    ];
    let clutch = Contact::between(
        0,
        1,
        Coulomb::new(12.5, 0.5).unwrap(),
        Drive::profile(&pulses).unwrap(),
    );
    let train = Structure::new(&[1.0, 1.0])
        .and_then(|s| {
            s.with_force(0, torque)?
                .with_contact(Contact::freewheel(0, 1)?)
        })
        .and_then(|s| s.with_contact(clutch?))
        .unwrap();
    let motion = train
        .simulate(State::new(&[0.0; 2], &[-0.5, 0.0]), 2.0)
        .unwrap();
    // The impulse of the torque, and the time at which slip ends that begins at −r.
    let impulse = |t: f64| 10.0 / (6.0 * PI) * (1.0 - (6.0 * PI * t).cos());
    let closes = |from: f64, to: f64, r: f64| {
        // r' = 10 sin 6πt, and 3 more with the clutch.
        let slip = |t: f64| impulse(t) - impulse(from) + 3.0 * (t - from) - r;
        let [mut low, mut high] = [from, to];
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if slip(middle) < 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        low
    };
    let [freewheel, clutch] = [0, 1];
    let behind = EventKind::Release(Direction::Lagging);
    // At 1.5 the shafts have one speed for an instant; nothing happens.
    let first = closes(0.3, 0.5, impulse(1.0 / 6.0) - impulse(0.3));
    let second = closes(1.6, 1.9, impulse(1.5) - impulse(1.6));
    let expected = [
        (0.08028000024134917137001713, freewheel, EventKind::Stick),
        (1.0 / 6.0, freewheel, behind),
        (0.3, clutch, EventKind::Close),
        (first, freewheel, EventKind::Stick),
        (first, clutch, EventKind::Stick),
        (0.95, freewheel, behind),
        (0.95, clutch, EventKind::Open),
        (1.05, freewheel, EventKind::Stick),
        (7.0 / 6.0, freewheel, behind),
        (1.6, clutch, EventKind::Close),
        (second, freewheel, EventKind::Stick),
        (second, clutch, EventKind::Stick),
    ];
    let kinds: Vec<_> = expected.iter().map(|&(_, c, kind)| (c, kind)).collect();
    assert_eq!(keys(&motion), kinds);
    for (event, (time, ..)) in motion.events().iter().zip(expected) {
        assert_abs_diff_eq!(event.time, time, epsilon = 1e-15);
        // Friction does not change the sum of the momenta.
        let sum: f64 = event.state.velocities.iter().sum();
        assert_abs_diff_eq!(sum, impulse(event.time) - 0.5, epsilon = 1e-14);
    }
    let [one, other] = motion.last().velocities[..] else {
        panic!()
    };
    assert!(one == other);
    assert_abs_diff_eq!(one, -0.25, epsilon = 1e-14);
}

/// Moreau's time stepping for six inertias of 2 kg m² in `HeatLosses`: forces at the middle of the
/// step, impulses of friction that leave no slip or have their largest size, found one after the
/// other until they change no more.
struct Stepping {
    position: [f64; 6],
    velocity: [f64; 6],
    /// Heat of the dampers and of the contacts, and the work on the backlash.
    heat: [f64; 6],
    dampers: f64,
    backlash: f64,
}

const INERTIA: f64 = 2.0;

impl Stepping {
    /// Directions of the contacts: bearing, gear, clutch, freewheel, its clutch, brake.
    const ALONG: [[f64; 6]; 6] = [
        [0.0, 0.0, 1.0, 0.0, 0.0, 0.0],
        [0.0, 0.0, 0.0, 1.0, 0.0, 0.0],
        [0.0, 0.0, 0.0, 0.5, -1.0, 0.0],
        [0.0, 0.0, 0.0, 0.0, 1.0, -1.0],
        [0.0, 0.0, 0.0, 0.0, 1.0, -1.0],
        [0.0, 0.0, 0.0, 0.0, 0.0, 1.0],
    ];

    fn to_one_second(steps: usize) -> Self {
        let mut at = Self {
            position: [0.0; 6],
            velocity: [0.0; 6],
            heat: [0.0; 6],
            dampers: 0.0,
            backlash: 0.0,
        };
        let mut impulses = [0.0; 6];
        for i in 0..steps {
            at.step(i as f64 / steps as f64, 1.0 / steps as f64, &mut impulses);
        }
        at
    }

    fn step(&mut self, begin: f64, h: f64, impulses: &mut [f64; 6]) {
        let time = begin + 0.5 * h;
        let q: Vec<f64> = (0..6)
            .map(|i| self.position[i] + 0.5 * h * self.velocity[i])
            .collect();
        let grip = (0.4 * PI * time).sin();
        let mut next = self.velocity;
        let mut powers = [0.0; 2];
        for _ in 0..4 {
            let v: Vec<f64> = (0..6).map(|i| 0.5 * (self.velocity[i] + next[i])).collect();
            let torque = 20.0 * (10.0 * PI * time).sin();
            let damping = 20.0 * (v[0] - v[1]);
            let spring = 1e4 * (q[0] - q[1]) + damping;
            let (twist, rate) = (q[1] - q[2], v[1] - v[2]);
            let play = match () {
                () if twist > 5e-4 => f64::max(0.0, 1e5 * (twist - 5e-4) + 100.0 * rate),
                () if twist < -5e-4 => f64::min(0.0, 1e5 * (twist + 5e-4) + 100.0 * rate),
                () => 0.0,
            };
            let shaft = 1e4 * (q[2] - q[3]);
            powers = [10.0 * v[0] * v[0] + damping * (v[0] - v[1]), play * rate];
            let forces = [
                torque - 10.0 * v[0] - spring,
                spring - play,
                play - shaft,
                shaft,
                0.0,
                0.0,
            ];
            let gear = 1.0 + v[3].abs();
            let limits = [1.0, gear, 5.0 * grip, f64::INFINITY, 0.5 * grip, grip];
            for i in 0..6 {
                let friction: f64 = (0..6).map(|c| Self::ALONG[c][i] * impulses[c]).sum();
                next[i] = self.velocity[i] + (h * forces[i] - friction) / INERTIA;
            }
            for _ in 0..60 {
                let mut moved = 0.0_f64;
                for (c, along) in Self::ALONG.iter().enumerate() {
                    let slip: f64 = (0..6).map(|i| along[i] * next[i]).sum();
                    let mass = INERTIA / along.iter().map(|b| b * b).sum::<f64>();
                    let most = h * limits[c];
                    let least = if c == 3 { 0.0 } else { -most };
                    let impulse = (impulses[c] + slip * mass).clamp(least, most);
                    let change = impulse - impulses[c];
                    for i in 0..6 {
                        next[i] -= along[i] * change / INERTIA;
                    }
                    impulses[c] = impulse;
                    moved = moved.max(change.abs());
                }
                if moved <= 1e-13 * h {
                    break;
                }
            }
        }
        let mean = |i: usize| 0.5 * (self.velocity[i] + next[i]);
        for (c, along) in Self::ALONG.iter().enumerate() {
            let slip: f64 = (0..6).map(|i| along[i] * mean(i)).sum();
            self.heat[c] += impulses[c] * slip;
        }
        self.dampers += h * powers[0];
        self.backlash += h * powers[1];
        for i in 0..6 {
            self.position[i] += h * mean(i);
        }
        self.velocity = next;
    }
}

/// `HeatLosses`: six inertias with a damper, a spring with a damper, backlash, a bearing, a gear, a
/// clutch, a one-way clutch and a brake.
///
/// Two elements differ. The library cuts the damping torque of its backlash to the size of the
/// spring's torque; a [`Stop`] does not. The gear has the friction of the bearings in the library's
/// table, without the efficiency of the mesh: that is friction whose normal load is a torque of
/// constraint, which a rigid gear has only in the library.
#[test]
fn a_drive_train_heats_up() {
    let sine = |amplitude: f64| Drive::sine(amplitude, 0.4 * PI).unwrap();
    let backlash = |stop: Result<Stop, stick_slip::Error>| {
        stop.unwrap().with_contact_stiffness(1e5, 100.0).unwrap()
    };
    let contacts = [
        Contact::new(2, even(1.0), 1.0),
        Contact::new(
            3,
            Tabulated::piecewise_linear([(0.0, 1.0), (1.0, 2.0)]).unwrap(),
            1.0,
        ),
        Contact::along(&[(3, 0.5), (4, -1.0)], even(0.5), sine(10.0)),
        Contact::freewheel(4, 5),
        Contact::between(4, 5, even(0.5), sine(1.0)),
        Contact::new(5, even(0.5), sine(2.0)),
    ];
    let train = Structure::new(&[INERTIA; 6])
        .and_then(|s| {
            s.with_force(0, Drive::sine(20.0, 10.0 * PI)?)?
                .with_ground_damper(0, 10.0)
        })
        .and_then(|s| s.with_spring(0, 1, 1e4)?.with_damper(0, 1, 20.0))
        .and_then(|s| s.with_stop(backlash(Stop::between(1, 2, 5e-4, 0.0))))
        .and_then(|s| s.with_stop(backlash(Stop::between(2, 1, 5e-4, 0.0))))
        .and_then(|s| {
            s.with_spring(2, 3, 1e4)?
                .with_contacts(contacts.map(Result::unwrap))
        })
        .unwrap();
    let motion = train.simulate(State::at_rest(6), 1.0).unwrap();
    assert!(motion.events().len() > 100);
    let budget = train.energy_budget(&motion).unwrap();
    assert!(budget.defect().abs() < 1e-13, "{budget:?}");

    // The stepping is of first order at events; with 10 000 steps the errors are three times these.
    let found = Stepping::to_one_second(20_000);
    let last = motion.last();
    for i in 0..6 {
        assert_abs_diff_eq!(last.velocities[i], found.velocity[i], epsilon = 3e-5);
        assert_abs_diff_eq!(last.displacements[i], found.position[i], epsilon = 6e-6);
    }
    // All inertias have moved, and the brake has stopped the last.
    assert!(found.position.iter().all(|q| q.abs() > 1e-3));
    assert_eq!(last.velocities[5], 0.0);
    let depth = (found.position[1] - found.position[2]).abs() - 5e-4;
    let stored = 0.5 * 1e5 * f64::max(depth, 0.0).powi(2);
    let stops: f64 = budget.stop_loss.iter().sum();
    assert_abs_diff_eq!(stops, found.backlash - stored, epsilon = 1e-4);
    assert_abs_diff_eq!(budget.damper_loss, found.dampers, epsilon = 1e-4);
    for (loss, heat) in budget.friction_loss.iter().zip(found.heat) {
        assert_abs_diff_eq!(*loss, heat, epsilon = 1e-5);
    }
}
