//! Periodic motions, attractors and bifurcations of structures with force elements.

use stick_slip::orbit::{self, AttractorKind, Period};
use stick_slip::structure::State;
use stick_slip::{Contact, Error, ForceElement, PolynomialSpring, Stribeck, Structure};

/// x'' + 0.1 x' + x + x³ on a belt.
fn hardening(velocity: f64) -> Result<Structure, Error> {
    let friction = Contact::new(0, Stribeck::new(0.4, 0.25, 0.5, 1)?, 1.0)?;
    Structure::new(&[1.0])?
        .with_ground_spring(0, 1.0)?
        .with_ground_damper(0, 0.1)?
        .with_element(ForceElement::new(
            0,
            PolynomialSpring::new(&[0.0, 0.0, 1.0])?,
        )?)?
        .with_contact(friction.on_belt(velocity))
}

/// Numbers of another program, to 14 digits.
#[test]
fn a_belt_with_a_hardening_spring_has_its_attractors() {
    let start = State::at_rest(1);
    let slow = hardening(0.2).unwrap();
    let cycle = orbit::settle(&slow, &start, 200.0, Period::Free(5.6)).unwrap();
    assert!(
        (cycle.period() - 5.6059554765258).abs() < 1e-12,
        "{}",
        cycle.period()
    );
    assert!(cycle.is_stable() && cycle.events().len() == 2);
    let fast = hardening(0.7).unwrap();
    let attractor = orbit::classify(&fast, &start).unwrap();
    assert_eq!(attractor.kind(), AttractorKind::SteadySliding);
    let sliding = fast.steady_sliding().unwrap();
    let found = sliding.displacements[0];
    assert!((found - 0.267786647494506).abs() < 1e-14, "{found}");
    assert!(sliding.is_stable());
}

/// The damper balances the fall of friction, 0.3 e^(−2v), at v = ½ ln 3, whatever the spring; the
/// stick-slip motion beyond that ends where it no longer reaches the velocity of the belt.
#[test]
fn the_ranges_of_a_belt_with_a_hardening_spring_are_right() {
    let ranges = orbit::vibration_ranges(hardening, 0.1..1.0).unwrap();
    let [slow, both, fast] = &ranges.ranges[..] else {
        panic!("{ranges:?}")
    };
    let (stick_slip, sliding) = (AttractorKind::StickSlip, AttractorKind::SteadySliding);
    assert_eq!(slow.attractors, [stick_slip]);
    assert_eq!(both.attractors, [sliding, stick_slip]);
    assert_eq!(fast.attractors, [sliding]);
    assert!((slow.parameters.end - 0.5 * 3.0_f64.ln()).abs() < 1e-14);
    let end = both.parameters.end;
    for (velocity, kind) in [(end - 1e-6, stick_slip), (end + 1e-6, sliding)] {
        let belt = hardening(velocity).unwrap();
        let carried = State::new(&[-0.3], &[velocity]);
        let attractor = orbit::classify(&belt, &carried).unwrap();
        assert_eq!(attractor.kind(), kind, "{velocity}");
    }
}
