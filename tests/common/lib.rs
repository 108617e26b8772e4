//! What several test files share: reference data, laws of the tests' own, and random numbers that
//! are the same in every run.
// Written for the tests here, not for users.
#![allow(missing_docs, clippy::len_without_is_empty)]

pub mod any;
pub mod any_force;
pub mod bristles;
pub mod collocation;
pub mod forces;
pub mod formula;
pub mod heat;
pub mod laws;
pub mod masses;
pub mod naive;
pub mod orbit;
pub mod plain;
pub mod polynomials;
pub mod property;
pub mod radau;
pub mod reading;
pub mod simple;
pub mod work;
pub mod worst;

use std::fmt::Debug;
use std::path::Path;

use serde_json::Value;
use stick_slip::nalgebra::DVector;
use stick_slip::structure::Carried;
use stick_slip::{
    AnyLaw, Coulomb, Direction, Element, Error, Event, EventKind, Exponential, LimitCycle,
    MassOnBelt, Polynomial, State, Trajectory, structure,
};

pub use crate::laws::{Counted, Decay, Ends, Leine, Table, TurnsNan, even};
pub use crate::masses::{dwelling, forced, on_belt, one_mass, oscillator, paper};
pub use crate::worst::{Worst, assert_met};

/// Reads JSON, by code that is compiled in `serde_json` and not once more in each program.
pub fn json(text: &str) -> Value {
    text.parse().unwrap()
}

/// A reference number: a decimal string of 25 digits, rounded to `f64`.
pub fn number(value: &Value) -> f64 {
    let text = value
        .as_str()
        .unwrap_or_else(|| panic!("not a decimal string: {value}"));
    text.parse().unwrap()
}

/// The text of a JSON field.
pub fn text(value: &Value) -> &str {
    value.as_str().unwrap()
}

/// The items of a JSON array.
pub fn list(value: &Value) -> &[Value] {
    value.as_array().unwrap()
}

/// What a result holds that is the error of a pattern.
#[macro_export]
macro_rules! refused {
    ($found:expr => $error:pat) => {
        $crate::refused!($found => $error, ())
    };
    ($found:expr => $error:pat, $held:expr) => {
        match $found {
            Err($error) => $held,
            Err(other) => panic!("{other:?}"),
            Ok(_) => panic!("no error"),
        }
    };
}

/// All of them, if they are as many as asked for.
#[track_caller]
pub fn exactly<T: Debug, const N: usize>(found: &[T]) -> [&T; N] {
    assert_eq!(found.len(), N, "{found:?}");
    at_least(found)
}

/// The first of them.
#[track_caller]
pub fn at_least<T: Debug, const N: usize>(found: &[T]) -> [&T; N] {
    assert!(found.len() >= N, "{found:?}");
    std::array::from_fn(|i| &found[i])
}

/// A message has the form of all: behind the name of what refused, if there is one, lower case; and
/// no full stop.
#[track_caller]
pub fn assert_form(message: &str) {
    let named = message.split_once(": ");
    let named = named.filter(|(of, _)| !of.contains(' '));
    let said = named.map_or(message, |(_, said)| said);
    assert!(!said.is_empty() && !said.ends_with('.'), "{message}");
    assert!(!said.starts_with(char::is_uppercase), "{message}");
}

/// A message of the form of all says all parts.
#[track_caller]
pub fn assert_message(error: &Error, parts: &[&str]) {
    let text = error.to_string();
    for part in parts {
        assert!(text.contains(part), "{part:?} is missing: {text}");
    }
    assert_form(&text);
}

/// The message of a refusal.
#[track_caller]
pub fn message<T>(found: Result<T, Error>, parts: &[&str]) {
    assert_message(&found.map(|_| ()).unwrap_err(), parts);
}

/// The event of a name in the reference data.
pub fn kind(name: &str) -> EventKind {
    match name {
        "stick" => EventKind::Stick,
        "release_negative" => EventKind::Release(Direction::Lagging),
        "release_positive" => EventKind::Release(Direction::Leading),
        "cross_to_negative" => EventKind::Crossing(Direction::Lagging),
        "cross_to_positive" => EventKind::Crossing(Direction::Leading),
        "open" | "kv_open" => EventKind::Open,
        "close" | "kv_close" => EventKind::Close,
        other => panic!("unknown event {other}"),
    }
}

/// The system of a reference case.
pub fn system_of(case: &Value) -> MassOnBelt<AnyLaw> {
    let parameter = |name: &str| number(&case["law_params"][name]);
    let law = match text(&case["law"]) {
        "poly" => AnyLaw::Polynomial(
            Polynomial::new(parameter("mus"), parameter("mum"), parameter("vm")).unwrap(),
        ),
        "exp" => AnyLaw::Exponential(
            Exponential::new(parameter("mus"), parameter("muk"), parameter("vs")).unwrap(),
        ),
        "coulomb" => AnyLaw::Coulomb(Coulomb::new(parameter("mus"), parameter("muk")).unwrap()),
        other => panic!("unknown law {other}"),
    };
    let [v_b, damping, load] = ["v_b", "beta", "gamma2"].map(|name| number(&case[name]));
    on_belt(law, v_b, damping, load)
}

/// Number of random cases of a test: a few in a usual run, all of them with the variable `FULL=1`,
/// and n times all with `FULL=n`.
pub fn count(few: usize, all: usize) -> usize {
    match std::env::var("FULL") {
        Ok(times) => all * times.parse::<usize>().expect("FULL: a whole number"),
        Err(_) => few,
    }
}

/// The first few of some cases, or all of them; see [`count`].
pub fn some<T, const N: usize>(few: usize, cases: [T; N]) -> impl Iterator<Item = T> {
    cases.into_iter().take(count(few, N))
}

/// The force of each contact.
pub fn forces(carried: &[Carried]) -> Vec<f64> {
    carried.iter().map(|carried| carried.force).collect()
}

/// The events of a motion of contacts: the contact and the kind of each.
pub fn keys(motion: &Trajectory<structure::State>) -> Vec<(usize, EventKind)> {
    let events = motion.events().iter();
    let key = |event: &Event<structure::State>| (event.contact().unwrap(), event.kind);
    events.map(key).collect()
}

/// The events of a motion: the element and the kind of each.
pub fn element_keys(motion: &Trajectory<structure::State>) -> Vec<(Element, EventKind)> {
    let events = motion.events().iter();
    events.map(|event| (event.element, event.kind)).collect()
}

/// All numbers of a state: displacements, velocities, memory variables.
pub fn numbers(state: &structure::State) -> Vec<f64> {
    [&state.displacements, &state.velocities, &state.memory]
        .map(Vec::as_slice)
        .concat()
}

/// All [`numbers`] of a state.
pub fn vector(state: &structure::State) -> DVector<f64> {
    DVector::from_vec(numbers(state))
}

/// The largest difference of two states.
pub fn apart(a: &structure::State, b: &structure::State) -> f64 {
    let numbers = std::iter::zip(numbers(a), numbers(b));
    numbers.map(|(a, b)| (a - b).abs()).fold(0.0, larger)
}

/// The larger of two numbers; a NaN is larger than all.
pub fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || a > b { a } else { b }
}

/// The repository: tests run in the folder of their package.
pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .ancestors()
        .nth(2)
        .unwrap()
}

/// Splitmix64: the same numbers on every machine and in every run, unless the variable `SEED` asks
/// for others.
#[derive(Debug, Clone)]
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        let other = std::env::var("SEED").map_or(0, |text| text.parse().expect("a number"));
        Self(seed.wrapping_add(other))
    }

    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform in [low, high).
    pub fn uniform(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.bits() >> 11) as f64 * 0.5_f64.powi(53)
    }

    /// Uniform in the logarithm.
    pub fn logarithmic(&mut self, low: f64, high: f64) -> f64 {
        self.uniform(low.ln(), high.ln()).exp()
    }

    /// +1 or −1.
    pub fn sign(&mut self) -> f64 {
        if self.bits() & 1 == 0 { 1.0 } else { -1.0 }
    }

    pub fn pick<T: Copy>(&mut self, items: &[T]) -> T {
        items[(self.bits() % items.len() as u64) as usize]
    }

    /// One of the three laws of the crate, with μ_s in [0.2, 0.8) and its minimum at 0.3 to 1 of
    /// it.
    pub fn law(&mut self) -> AnyLaw {
        let static_coefficient = self.uniform(0.2, 0.8);
        let least = static_coefficient * self.uniform(0.3, 1.0);
        match self.bits() % 3 {
            0 => AnyLaw::Polynomial(
                Polynomial::new(static_coefficient, least, self.uniform(0.3, 1.5)).unwrap(),
            ),
            1 => AnyLaw::Exponential(
                Exponential::new(static_coefficient, least, self.uniform(0.1, 1.0)).unwrap(),
            ),
            _ => AnyLaw::Coulomb(Coulomb::new(static_coefficient, least).unwrap()),
        }
    }

    /// A system of ordinary size: 0.03 ≤ |v_b| < 2 with either sign, β < 0.4, 0.1 ≤ γ² < 5.
    pub fn system(&mut self) -> MassOnBelt<AnyLaw> {
        let law = self.law();
        let belt_velocity = self.sign() * self.logarithmic(0.03, 2.0);
        let damping = self.uniform(0.0, 0.4);
        let load = self.logarithmic(0.1, 5.0);
        on_belt(law, belt_velocity, damping, load)
    }
}

/// Distance between neighbouring numbers at |x|.
pub fn ulp(x: f64) -> f64 {
    x.abs().next_up() - x.abs()
}

/// (u, v, v_b) → (−u, −v, −v_b), to the bit.
#[track_caller]
pub fn assert_mirrored(a: &LimitCycle, b: &LimitCycle, about: &str) {
    let of = |cycle: &LimitCycle| {
        (
            cycle.kind(),
            cycle.period(),
            cycle.multiplier(),
            cycle.amplitude(),
            cycle.energy(),
            cycle.leading_duration(),
        )
    };
    assert_eq!(of(a), of(b), "{about}");
    assert_eq!(a.max_displacement(), -b.min_displacement(), "{about}");
    assert_eq!(a.mean_displacement(), -b.mean_displacement(), "{about}");
    assert_eq!(a.max_velocity(), -b.min_velocity(), "{about}");
    assert_eq!(a.min_velocity(), -b.max_velocity(), "{about}");
    let mirrored = |state: State| State::new(-state.displacement, -state.velocity);
    assert_eq!(a.state(), mirrored(b.state()), "{about}");
    let (a, b) = (a.trajectory(), b.trajectory());
    for (a, b) in std::iter::zip(a.events(), b.events()) {
        assert_eq!((a.time, a.state), (b.time, mirrored(b.state)), "{about}");
    }
    for (a, b) in std::iter::zip(a.sample(20), b.sample(20)) {
        assert_eq!(a, (b.0, mirrored(b.1)), "{about}");
    }
}
