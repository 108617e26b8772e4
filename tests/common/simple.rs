//! A deliberately simple integrator, which shares no idea and no code with the crate: fixed
//! Runge-Kutta steps, friction as a closure of numbers, contact by bisection.

use stick_slip::{Event, EventKind};

use crate::formula::Formula;

/// The classical Runge-Kutta step from x at time t.
pub fn runge_kutta<const N: usize>(
    t: f64,
    x: [f64; N],
    h: f64,
    rates: impl Fn(f64, [f64; N]) -> [f64; N],
) -> [f64; N] {
    let moved = |k: [f64; N], h: f64| std::array::from_fn(|i| x[i] + h * k[i]);
    let a = rates(t, x);
    let b = rates(t + 0.5 * h, moved(a, 0.5 * h));
    let c = rates(t + 0.5 * h, moved(b, 0.5 * h));
    let d = rates(t + h, moved(c, h));
    std::array::from_fn(|i| x[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]))
}

/// Where in (0, h] a condition begins to hold that holds at h.
pub fn bisect(h: f64, holds: impl Fn(f64) -> bool) -> f64 {
    let (mut no, mut yes) = (0.0, h);
    for _ in 0..60 {
        let middle = 0.5 * (no + yes);
        if holds(middle) {
            yes = middle;
        } else {
            no = middle;
        }
    }
    yes
}

/// What happened, as the simple integrator tells it: its time, a letter (s: stick, r: release, c:
/// crossing), and the sign of v_r afterwards.
pub type Seen = (f64, char, f64);

/// A mass on a belt in plain numbers.
pub struct Simple<'a> {
    friction: Box<dyn Fn(f64) -> f64 + 'a>,
    static_friction: f64,
    damping: f64,
    belt: f64,
}

impl<'a> Simple<'a> {
    pub fn new(formula: &'a Formula, belt: f64, damping: f64, load: f64) -> Self {
        Self {
            friction: Box::new(move |s| load * formula.at(s)),
            static_friction: load * formula.static_coefficient(),
            damping,
            belt,
        }
    }

    pub fn rates(&self, side: f64, [u, v]: [f64; 2]) -> [f64; 2] {
        let speed = (side * (v - self.belt)).max(0.0);
        [
            v,
            -2.0 * self.damping * v - u - side * (self.friction)(speed),
        ]
    }

    /// The state a step later.
    pub fn step(&self, side: f64, x: [f64; 2], h: f64) -> [f64; 2] {
        runge_kutta(0.0, x, h, |_, x| self.rates(side, x))
    }

    /// The side to which a mass at u leaves the belt, or 0 if it sticks.
    fn leaves(&self, u: f64) -> f64 {
        let force = u + 2.0 * self.damping * self.belt;
        if force.abs() <= self.static_friction {
            0.0
        } else {
            -force.signum()
        }
    }

    /// Events before the end and the last state, in steps of a length that may depend on the state.
    pub fn run(
        &self,
        mut x: [f64; 2],
        duration: f64,
        length: impl Fn([f64; 2]) -> f64,
    ) -> (Vec<Seen>, [f64; 2]) {
        let mut seen = Vec::new();
        let mut time = 0.0;
        let mut side = if x[1] == self.belt {
            self.leaves(x[0])
        } else {
            (x[1] - self.belt).signum()
        };
        while time < duration {
            if side == 0.0 {
                let release =
                    self.belt.signum() * self.static_friction - 2.0 * self.damping * self.belt;
                let wait = (release - x[0]) / self.belt;
                if time + wait >= duration {
                    x[0] += self.belt * (duration - time);
                    break;
                }
                time += wait;
                x[0] = release;
                side = -self.belt.signum();
                seen.push((time, 'r', side));
                continue;
            }
            let h = length(x).min(duration - time);
            let next = self.step(side, x, h);
            let speed_at = |x: [f64; 2]| side * (x[1] - self.belt);
            let speed = |t: f64| speed_at(self.step(side, x, t));
            let slows_at = |x: [f64; 2]| side * self.rates(side, x)[1] < 0.0;
            // The lowest speed in this step: at its end, or where the mass no longer slows down.
            let (lowest, least) = if slows_at(x) && !slows_at(next) {
                let turn = bisect(h, |t| !slows_at(self.step(side, x, t)));
                (turn, speed(turn))
            } else {
                (h, speed_at(next))
            };
            // After a release the speed grows from 0 like t², below rounding at first.
            if least >= -1e-15 {
                x = next;
                time += h;
                continue;
            }
            let contact = bisect(lowest, |t| speed(t) < 0.0);
            x = [self.step(side, x, contact)[0], self.belt];
            time += contact;
            let next = self.leaves(x[0]);
            if next != side {
                seen.push((time, if next == 0.0 { 's' } else { 'c' }, next));
            }
            side = next;
        }
        seen.retain(|event| event.0 < duration);
        (seen, x)
    }
}

/// The crate's events in the same words.
pub fn told(events: &[Event]) -> Vec<Seen> {
    let tell = |event: &Event| match event.kind {
        EventKind::Stick => (event.time, 's', 0.0),
        EventKind::Release(direction) => (event.time, 'r', direction.sign()),
        EventKind::Crossing(direction) => (event.time, 'c', direction.sign()),
        EventKind::Open | EventKind::Close => panic!("a belt's contact holds"),
    };
    events.iter().map(tell).collect()
}
