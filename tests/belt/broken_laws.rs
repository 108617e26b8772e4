//! Laws that break their contract, or use its edges: what stepping makes of them.

use approx::assert_abs_diff_eq;
use std::cell::Cell;

use crate::common::polynomials::Polynomials;
use crate::common::{TurnsNan, friction_law};
use stick_slip::{
    Contact, Coulomb, Error, FrictionLaw, Integrator, MassOnBelt, Mode, Rational, Scalar, State,
    check_law,
};

#[test]
fn a_static_coefficient_that_turns_nan_ends_the_motion_in_an_error() {
    let mut seen = 0;
    for good in 2..40 {
        for duration in [0.1, 3.0, 30.0] {
            let law = TurnsNan::after(good);
            let system = MassOnBelt::new(law, 0.2).unwrap();
            match system.simulate(State::new(0.0, 0.0), duration) {
                Ok(motion) => {
                    let State {
                        displacement,
                        velocity,
                    } = motion.last();
                    assert!(displacement.is_finite() && velocity.is_finite(), "{good}");
                }
                Err(Error::InvalidParameter { name, value, .. }) => {
                    assert!(name == "static_coefficient" && value.is_nan());
                    seen += 1;
                }
                Err(error) => panic!("{good}: {error:?}"),
            }
        }
    }
    assert!(seen > 20, "{seen}");
}

#[test]
fn negative_friction_is_followed_as_it_is() {
    // −0.1 at all speeds of the motion, from 0.3 to 0.7; at speed 0 it would be refused.
    let law = Polynomials::new(0.4, &[0.1, -1.0])
        .then(0.2, &[-0.1])
        .told();
    let system = MassOnBelt::new(law, -0.5).unwrap();
    let motion = system.simulate(State::new(0.3, 0.0), 4.0).unwrap();
    for (time, state) in motion.sample(50) {
        // v_r > 0: u'' + u − 0.1 = 0.
        let expected = 0.1 + 0.2 * time.cos();
        assert_abs_diff_eq!(state.displacement, expected, epsilon = 1e-15);
    }
}

friction_law! {
    /// A law that names the same breakpoint for ever.
    Endless: 0.4, |s| s * -0.1 + 0.4, at std::iter::repeat(0.5)
}

#[test]
fn breakpoints_without_an_end_are_refused() {
    let refused = Error::BadBreakpoints {
        index: 1,
        value: 0.5,
    };
    assert_eq!(MassOnBelt::new(Endless, 0.2).unwrap_err(), refused);
    assert_eq!(check_law(&Endless, 0.0..1.0).unwrap_err(), refused);
    assert_eq!(Contact::new(0, Endless, 1.0).unwrap_err(), refused);
}

/// An analytic law that names other breakpoints at each call.
struct Wandering(Cell<u32>);

impl FrictionLaw for Wandering {
    fn static_coefficient(&self) -> f64 {
        0.4
    }
    fn kinetic<S: Scalar>(&self, speed: S) -> S {
        (speed + 1.0).recip() * 0.4
    }
    fn breakpoints(&self) -> impl Iterator<Item = f64> {
        self.0.set(self.0.get() + 1);
        let calls = self.0.get();
        (1..=calls % 4).map(move |i| 0.1 * f64::from(i) + 0.01 * f64::from(calls % 7))
    }
}

#[test]
fn breakpoints_that_change_cut_steps_and_no_more() {
    let same_law = Rational::new(0.4, 1.0).unwrap();
    let system = MassOnBelt::new(same_law, 0.2).unwrap();
    let steady = system.simulate(State::new(0.0, 0.0), 30.0).unwrap().last();
    for calls in 0..28 {
        let system = MassOnBelt::new(Wandering(Cell::new(calls)), 0.2).unwrap();
        let last = system.simulate(State::new(0.0, 0.0), 30.0).unwrap().last();
        assert_abs_diff_eq!(last.displacement, steady.displacement, epsilon = 1e-13);
        assert_abs_diff_eq!(last.velocity, steady.velocity, epsilon = 1e-13);
    }
}

#[test]
fn a_release_whose_time_overflows_never_comes() {
    for v_b in [f64::from_bits(1), -f64::from_bits(1), 1e-310] {
        let system = MassOnBelt::new(Coulomb::new(0.4, 0.25).unwrap(), v_b).unwrap();
        let mut flow = Integrator::new()
            .flow(&system, State::new(0.0, v_b))
            .unwrap();
        let rest = flow.next().unwrap().unwrap();
        assert_eq!((rest.mode(), rest.duration()), (Mode::Stick, f64::INFINITY));
        assert_eq!(rest.event(), None);
        assert!(flow.next().is_none());
        let motion = system.simulate(State::new(0.0, v_b), 30.0).unwrap();
        assert!(motion.events().is_empty());
        assert_eq!(motion.last().velocity, v_b);
    }
}
