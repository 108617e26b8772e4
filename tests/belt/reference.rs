//! Trajectories and cycles computed independently to 25 digits.
//!
//! `data/trajectories.json` and `data/overshoot.json` come from a Taylor integration in 220-bit
//! arithmetic, checked against a Runge-Kutta method and closed forms; the field `header` of each
//! file explains the others.

use crate::common::reading::cases;
use crate::common::{Worst, at_least, kind, list, number, system_of, text};
use serde_json::Value;
use stick_slip::{Direction, Event, EventKind, Mode, State};

/// Error promised for every time, displacement and velocity, in units of max(1, |value|).
const ACCURACY: f64 = 1e-13;

fn overshoots() -> Vec<Value> {
    cases(include_str!("../data/overshoot.json"))
}

#[test]
fn trajectories_have_the_reference_events_and_states() {
    let mut worst = Worst::default();
    let (mut events_seen, mut states_seen) = (0, 0);
    for case in cases(include_str!("../data/trajectories.json")) {
        let id = text(&case["id"]);
        let system = system_of(&case);
        let start = match text(&case["start"]["type"]) {
            "release" => system.release_state().unwrap(),
            _ => State::new(number(&case["start"]["u"]), number(&case["start"]["v"])),
        };
        let motion = system.simulate(start, 400.0).unwrap();

        let expected = list(&case["events"]);
        let actual = motion.events();
        if case["events_complete"].as_bool().unwrap() {
            assert_eq!(actual.len(), expected.len(), "{id}: number of events");
        }
        assert!(actual.len() >= expected.len(), "{id}: number of events");
        for (n, (actual, expected)) in std::iter::zip(actual, expected).enumerate() {
            assert_eq!(
                actual.kind,
                kind(text(&expected["kind"])),
                "{id}, event {n}"
            );
            let what = |quantity: &str| format!("{id}, event {n}: {quantity}");
            worst.meet(&what("time"), actual.time, number(&expected["t"]));
            worst.meet(
                &what("u"),
                actual.state.displacement,
                number(&expected["u"]),
            );
            worst.meet(&what("v"), actual.state.velocity, number(&expected["v"]));
            assert_eq!(
                actual.state.velocity,
                system.belt_velocity(),
                "{id}, event {n}"
            );
            events_seen += 1;
        }
        for expected in list(&case["states"]) {
            let time = number(&expected["t"]);
            let actual = motion.state_at(time).unwrap();
            let what = |quantity: &str| format!("{id}, time {time}: {quantity}");
            worst.meet(&what("u"), actual.displacement, number(&expected["u"]));
            worst.meet(&what("v"), actual.velocity, number(&expected["v"]));
            let phase = match motion.mode_at(time).unwrap() {
                Mode::Stick => "stick",
                Mode::Slip(_) => "slip",
                Mode::Open => "open",
            };
            assert_eq!(phase, text(&expected["phase"]), "{id}, time {time}");
            states_seen += 1;
        }
        if case["stuck_forever"].as_bool().unwrap() {
            let steps = motion.steps();
            assert_eq!(
                steps.last().unwrap().mode(),
                Mode::Stick,
                "{id}: rests for ever"
            );
            assert_eq!(motion.last().velocity, 0.0, "{id}: rests for ever");
        }
    }
    // What the file holds, so that an empty one does not pass.
    assert_eq!((events_seen, states_seen), (EVENTS, 110));
    worst.assert("trajectories", ACCURACY);
}

/// Events in `trajectories.json`.
const EVENTS: usize = 187;

/// The cycle through the release point that overtakes the belt before it sticks.
#[test]
fn overshooting_cycles_have_the_reference_contacts() {
    let mut worst = Worst::default();
    let mut seen = 0;
    for case in overshoots() {
        let (id, cycle) = (text(&case["id"]), &case["stick_cycle"]);
        if cycle.is_null() {
            continue;
        }
        seen += 1;
        let system = system_of(&case);
        let period = number(&cycle["period"]);
        let motion = system
            .simulate(system.release_state().unwrap(), 3.0 * period)
            .unwrap();
        let events = motion.events();

        let sequence: Vec<EventKind> = list(&cycle["sequence"])
            .iter()
            .map(|name| kind(text(name)))
            .collect();
        for (n, event) in events.iter().enumerate() {
            assert_eq!(event.kind, sequence[n % sequence.len()], "{id}, event {n}");
        }
        for (n, contact) in list(&cycle["contacts"]).iter().enumerate() {
            let Event { time, state, .. } = events[n + 1];
            let what = |quantity: &str| format!("{id}, contact {n}: {quantity}");
            worst.meet(&what("time"), time, number(&contact["t"]));
            worst.meet(&what("u"), state.displacement, number(&contact["u"]));
        }
        let [release, contact, stick] =
            [0, sequence.len() - 2, sequence.len() - 1].map(|n| events[n]);
        let again = events[sequence.len()];
        let mut check = |name: &str, actual: f64| {
            worst.meet(&format!("{id}: {name}"), actual, number(&cycle[name]));
        };
        check("period", again.time - release.time);
        check("stick", again.time - stick.time);
        check("slip", stick.time - release.time);
        check("slip_positive", stick.time - contact.time);
        check("u_release", release.state.displacement);
        check("u_contact", stick.state.displacement);
        // From the same release point the second cycle is the first one again.
        assert_eq!(again.state, release.state, "{id}");
    }
    assert_eq!(seen, 5);
    worst.assert("overshooting cycles", ACCURACY);
}

/// The periodic orbit that crosses the belt's velocity twice a period and never sticks, started
/// where it begins to lag.
#[test]
fn crossing_cycles_return_after_the_reference_period() {
    let mut worst = Worst::default();
    let mut seen = 0;
    for case in overshoots() {
        let (id, cycle) = (text(&case["id"]), &case["crossing_cycle"]);
        if cycle.is_null() {
            continue;
        }
        seen += 1;
        let system = system_of(&case);
        let start = State::new(number(&cycle["u_enter_negative"]), system.belt_velocity());
        let motion = system
            .simulate(start, 1.5 * number(&cycle["period"]))
            .unwrap();
        let [to_leading, to_lagging] = at_least(motion.events());
        assert_eq!(
            to_leading.kind,
            EventKind::Crossing(Direction::Leading),
            "{id}"
        );
        assert_eq!(
            to_lagging.kind,
            EventKind::Crossing(Direction::Lagging),
            "{id}"
        );
        let mut check = |name: &str, actual: f64| {
            worst.meet(&format!("{id}: {name}"), actual, number(&cycle[name]));
        };
        check("slip_negative", to_leading.time);
        check("slip_positive", to_lagging.time - to_leading.time);
        check("period", to_lagging.time);
        check("u_enter_positive", to_leading.state.displacement);
        check("u_enter_negative", to_lagging.state.displacement);
    }
    assert_eq!(seen, 8);
    worst.assert("crossing cycles", ACCURACY);
}
