//! Whatever refuses a number says so by its own name, and by that of the number.

use std::collections::BTreeSet;
use std::fs;
use std::ops::Range;
use std::path::Path;

use stick_slip::analysis::{PureSlip, averaging, design, lugre};
use stick_slip::nalgebra::DMatrix;
use stick_slip::orbit::{self, Period};
use stick_slip::{
    Backlash, Contact, ContactLaw, Coulomb, Dahl, Directional, Drive, Dwell, Error, EventKind,
    Exponential, FirstOrder, ForceElement, ForceLaw, Integrator, Iwan4, LuGre, MassOnBelt, Motion,
    Pendulum, Physical, Polynomial, PolynomialSpring, RateState, Rational, Scalar, Scaled, Scaling,
    Search, Slip, SnapThrough, State, Stop, Stribeck, Structure, Tabulated, TabulatedForce,
    TimeFunction, VanDerPol, bifurcation, check_law, structure,
};
use stick_slip_tests_common::masses::{PAD, driven as forced};
use stick_slip_tests_common::polynomials::Polynomials;
use stick_slip_tests_common::{memory_stays, root};

/// A law with the given static coefficient and no friction.
fn given(static_coefficient: f64) -> Polynomials {
    Polynomials::new(static_coefficient, &[0.0])
}

/// One that remembers.
#[derive(Debug, Clone, Copy)]
struct Remembering(f64);

impl ContactLaw for Remembering {
    type Memory<S: Scalar> = [S; 1];
    memory_stays!(1);
    fn coefficient<S: Scalar>(&self, slip: Slip<S>, _: [S; 1]) -> S {
        slip.speed * 0.0
    }
    fn limit<S: Scalar>(&self, _: S, _: [S; 1]) -> Option<S> {
        None
    }
    fn rates<S: Scalar>(&self, motion: Motion<S>, _: S, memory: [S; 1]) -> [S; 1] {
        let _ = motion;
        [memory[0] + self.0]
    }
}

/// No force, but a potential of this slope.
#[derive(Debug, Clone, Copy)]
struct Stored(f64);

impl ForceLaw for Stored {
    fn force<S: Scalar>(&self, position: S, _: S, _: usize) -> S {
        position * 0.0
    }
    fn potential<S: Scalar>(&self, position: S, _: usize) -> Option<S> {
        Some(position * self.0)
    }
}

/// A constant function of time with this size, timescale and period.
#[derive(Debug, Clone, Copy)]
struct Timed([f64; 4]);

impl TimeFunction for Timed {
    fn value<S: Scalar>(&self, time: S, _: usize) -> S {
        time.constant(self.0[3])
    }
    fn size(&self) -> f64 {
        self.0[0]
    }
    fn timescale(&self, _: usize) -> f64 {
        self.0[1]
    }
    fn period(&self) -> Option<f64> {
        Some(self.0[2])
    }
}

const ANY: [f64; 0] = [];
const BELOW: &[f64] = &[-1.0, -1e-300, -5e-324];
const NOT_ABOVE: &[f64] = &[-1.0, -1e-300, -5e-324, 0.0, -0.0];
/// An ulp above the static coefficient of the laws below, or below 0.
const NO_KINETIC: &[f64] = &[-1.0, -1e-300, 0.4_f64.next_up(), 0.5];
/// Just above 0.1.
const CLOSE: &[f64] = &[0.1_f64.next_up()];
/// Ends of a range that starts at 0.1.
const EMPTY: &[f64] = &[0.1, -1.0];
/// Around the tolerances that an integrator takes.
const NO_TOLERANCE: &[f64] = &[
    0.0,
    -1e-9,
    Integrator::MIN_TOLERANCE.next_down(),
    Integrator::MAX_TOLERANCE.next_up(),
    1.0,
];

/// Who refuses, which number, finite numbers that are refused besides NaN and infinities, and the
/// call.
type Call = Box<dyn Fn(f64) -> Option<Error>>;
type Case = (&'static str, &'static str, &'static [f64], Call);

fn call<T>(call: impl Fn(f64) -> Result<T, Error> + 'static) -> Call {
    Box::new(move |x| call(x).err())
}

/// A case in each row.
macro_rules! cases {
    ($($of:literal $name:literal $bad:expr, |$x:ident| $call:expr;)*) => {
        vec![$(($of, $name, $bad as &[f64], call(move |$x| $call)) as Case),*]
    };
}

fn stop() -> Result<Stop, Error> {
    Stop::above(0, 1.0, 0.0)
}

fn law() -> Exponential {
    Exponential::new(0.4, 0.25, 0.5).unwrap()
}

fn belt() -> MassOnBelt<Exponential> {
    MassOnBelt::new(law(), 0.2)
        .unwrap()
        .with_damping(0.05)
        .unwrap()
}

fn formulas() -> PureSlip {
    let law = Polynomial::new(0.4, 0.25, 0.5).unwrap();
    PureSlip::new(&MassOnBelt::new(law, 0.42).unwrap()).unwrap()
}

fn follow(parameter: f64, range: Range<f64>) -> Result<usize, Error> {
    let orbit = orbit::shoot(&belt(), &belt().release_state().unwrap(), Period::Free(6.8))?;
    let branch = orbit::follow(
        |v_b| belt().with_belt_velocity(v_b),
        parameter,
        &orbit,
        range,
    )?;
    Ok(branch.bifurcations.len())
}

/// The curve of a flip.
fn locus(second: f64, ranges: [Range<f64>; 2]) -> Result<usize, Error> {
    let start = structure::State::new(&[0.3], &[0.0]);
    let motion = orbit::settle(&forced(0.78, 0.3)?, &start, 400.0, Period::Driven(1))?;
    let branch = orbit::follow(|x| forced(x, 0.3), 0.78, &motion, 0.74..0.79)?;
    let locus = orbit::locus(forced, &branch.bifurcations[0], second, ranges)?;
    Ok(locus.points.len())
}

fn hopf_locus(ranges: [Range<f64>; 2]) -> Result<usize, Error> {
    let family = |v_b: f64, damping: f64| belt().with_belt_velocity(v_b)?.with_damping(damping);
    Ok(bifurcation::hopf_locus(family, ranges)?.len())
}

fn laws() -> Vec<Case> {
    cases! {
        "Polynomial" "static_coefficient" BELOW, |x| Polynomial::new(x, 0.2, 0.5);
        "Polynomial" "minimum_coefficient" NO_KINETIC, |x| Polynomial::new(0.4, x, 0.5);
        "Polynomial" "minimum_velocity" NOT_ABOVE, |x| Polynomial::new(0.4, 0.2, x);
        // So small or so large that derived numbers overflow or underflow.
        "Polynomial" "minimum_velocity" &[1e-120, 1e120], |x| Polynomial::new(0.4, 0.25, x);
        "Exponential" "stribeck_velocity" &[1e-160, 1e151], |x| Exponential::new(0.4, 0.25, x);
        "Exponential" "static_coefficient" BELOW, |x| Exponential::new(x, 0.2, 0.5);
        "Exponential" "kinetic_coefficient" NO_KINETIC, |x| Exponential::new(0.4, x, 0.5);
        "Exponential" "stribeck_velocity" NOT_ABOVE, |x| Exponential::new(0.4, 0.2, x);
        "Coulomb" "static_coefficient" BELOW, |x| Coulomb::new(x, 0.2);
        "Coulomb" "kinetic_coefficient" NO_KINETIC, |x| Coulomb::new(0.4, x);
        "Rational" "static_coefficient" BELOW, |x| Rational::new(x, 1.0);
        "Rational" "decay" BELOW, |x| Rational::new(0.4, x);
        "Rational" "offset" &[-1.0, 0.41, 0.5], |x| Rational::new(0.4, 1.0)?.with_offset(x);
        "Rational" "quadratic" BELOW, |x| Rational::new(0.4, 1.0)?.with_quadratic(x);
        "Stribeck" "static_coefficient" BELOW, |x| Stribeck::new(x, 0.2, 0.5, 1);
        "Stribeck" "coulomb_coefficient" &[-0.1, 0.41, 0.5], |x| Stribeck::new(0.4, x, 0.5, 1);
        "Stribeck" "stribeck_velocity" NOT_ABOVE, |x| Stribeck::new(0.4, 0.2, x, 1);
        "Stribeck" "stribeck_velocity" &[1e-320], |x| Stribeck::new(0.4, 0.2, x, 1);
        "Stribeck" "viscous_coefficient" BELOW,
            |x| Stribeck::new(0.4, 0.2, 0.5, 1)?.with_viscous_coefficient(x);
        "Tabulated" "point 0, counted from 0: speed" &[-0.1, 0.1],
            |x| Tabulated::new([(x, 0.4), (0.2, 0.3)]);
        "Tabulated" "point 1, counted from 0: speed" &[0.0, 1e-200],
            |x| Tabulated::new([(0.0, 0.4), (x, 0.3), (1.0, 0.3)]);
        "Tabulated" "point 2, counted from 0: speed" &[1.0, 0.5],
            |x| Tabulated::new([(0.0, 0.4), (1.0, 0.3), (x, 0.2)]);
        // So close that a slope overflows.
        "Tabulated" "point 2, counted from 0: speed" CLOSE,
            |x| Tabulated::new([(0.0, 0.4), (0.1, 0.3), (x, 1e300)]);
        "Tabulated" "point 1, counted from 0: coefficient" BELOW,
            |x| Tabulated::new([(0.0, 0.4), (1.0, x)]);
        "Tabulated" "point 1, counted from 0: coefficient" BELOW,
            |x| Tabulated::piecewise_linear([(0.0, 0.4), (1.0, x)]);
        "Tabulated" "point 2, counted from 0: speed" CLOSE,
            |x| Tabulated::piecewise_linear([(0.0, 0.4), (0.1, 0.3), (x, 1e300)]);
        "Tabulated" "static_coefficient" &[0.3, 0.39],
            |x| Tabulated::new([(0.0, 0.4), (1.0, 0.3)])?.with_static_coefficient(x);
        "PolynomialSpring" "coefficient" &ANY, |x| PolynomialSpring::new(&[1.0, x]);
        "Pendulum" "moment" &ANY, |x| Pendulum::new(x, 1.0);
        "Pendulum" "length" NOT_ABOVE, |x| Pendulum::new(1.0, x);
        // So short or long that a slope or an energy overflows.
        "Pendulum" "length" &[5e-324, 1e-320, 1e301], |x| Pendulum::new(1e8, x);
        "Backlash" "stiffness" &ANY, |x| Backlash::new(x, 1.0);
        "Backlash" "gap" BELOW, |x| Backlash::new(1.0, x);
        "SnapThrough" "stiffness" &ANY, |x| SnapThrough::new(x, 1.0, 1.0);
        "SnapThrough" "free_length" BELOW, |x| SnapThrough::new(1.0, x, 1.0);
        "SnapThrough" "span" NOT_ABOVE, |x| SnapThrough::new(1.0, 1.0, x);
        // So small or large that a square or a slope overflows or underflows.
        "SnapThrough" "span" &[1e-160, 1e-153, 1e160], |x| SnapThrough::new(1e160, 1.0, x);
        "VanDerPol" "negative_damping" &ANY, |x| VanDerPol::new(x, 1.0);
        "VanDerPol" "nonlinear_damping" &ANY, |x| VanDerPol::new(1.0, x);
        "TabulatedForce" "point 0, counted from 0: position" &ANY,
            |x| TabulatedForce::new(&[(x, 0.0), (1.0, 1.0)]);
        "TabulatedForce" "point 1, counted from 0: position" &[-1.0, 0.0],
            |x| TabulatedForce::new(&[(0.0, 0.0), (x, 1.0)]);
        "TabulatedForce" "point 2, counted from 0: position" CLOSE,
            |x| TabulatedForce::piecewise_linear(&[(0.0, 0.4), (0.1, 0.3), (x, 1e300)]);
        "TabulatedForce" "point 1, counted from 0: force" &ANY,
            |x| TabulatedForce::new(&[(0.0, 0.0), (1.0, x)]);
        "Scaled" "velocity_unit" NOT_ABOVE, |x| Scaled::new(law(), x);
        "Iwan4" "slip_force" NOT_ABOVE, |x| Iwan4::new(x, 2.0, -0.1, 0.1);
        "Iwan4" "stiffness" NOT_ABOVE, |x| Iwan4::new(3.0, x, -0.1, 0.1);
        // So small that the displacement of slip overflows.
        "Iwan4" "stiffness" &[5e-324], |x| Iwan4::new(3.0, x, -0.1, 0.1);
        "Iwan4" "exponent" &[-1.0, -2.0, 5e-324, 1.0], |x| Iwan4::new(3.0, 2.0, x, 0.1);
        "Iwan4" "ratio" BELOW, |x| Iwan4::new(3.0, 2.0, -0.1, x);
        "Iwan4::elements" "grid" &[0.0, -0.5, 1.0, 2.0, 1e-300],
            |x| Iwan4::new(3.0, 2.0, -0.1, 0.1)?.elements(3, x);
        "LuGre" "stiffness" NOT_ABOVE, |x| LuGre::new(law(), x, 1.0, 0.0);
        "LuGre" "damping" BELOW, |x| LuGre::new(law(), 1e3, x, 0.0);
        "LuGre" "viscous" BELOW, |x| LuGre::new(law(), 1e3, 1.0, x);
        "RateState" "f0" &ANY, |x| RateState::aging(x, 0.01, 0.015, 1e-5, 1e-6);
        "RateState" "a" NOT_ABOVE, |x| RateState::slip(0.6, x, 0.015, 1e-5, 1e-6);
        "RateState" "b" &ANY, |x| RateState::aging(0.6, 0.01, x, 1e-5, 1e-6);
        "RateState" "d_c" NOT_ABOVE, |x| RateState::slip(0.6, 0.01, 0.015, x, 1e-6);
        "RateState" "v0" NOT_ABOVE, |x| RateState::aging(0.6, 0.01, 0.015, 1e-5, x);
        "RateState" "b2" &ANY,
            |x| RateState::aging(0.6, 0.01, 0.015, 1e-5, 1e-6)?.with_second_state(x, 1e-4);
        "RateState" "d_c2" NOT_ABOVE,
            |x| RateState::aging(0.6, 0.01, 0.015, 1e-5, 1e-6)?.with_second_state(0.01, x);
        "RateState" "v_m" NOT_ABOVE,
            |x| RateState::slip(0.6, 0.01, 0.015, 1e-5, 1e-6)?.with_least_speed(x);
        "Dahl" "coefficient" NOT_ABOVE, |x| Dahl::new(x, 1e3);
        "Dahl" "stiffness" NOT_ABOVE, |x| Dahl::new(0.4, x);
        "Directional" "static_coefficient" BELOW, |x| Directional::capstan(x, 0.2, 1.0);
        "Directional" "kinetic_coefficient" &[-1.0, 0.5], |x| Directional::capstan(0.4, x, 1.0);
        "Directional" "wrap" &[-1.0, 1e4], |x| Directional::capstan(0.4, 0.2, x);
        "Dwell" "limit" &[0.3, 0.39], |x| Dwell::exponential(law(), x, 1.0);
        "Dwell" "limit" &[0.3, 0.39], |x| Dwell::hyperbolic(law(), x, 1.0);
        "Dwell" "rate" BELOW, |x| Dwell::logarithmic(law(), x, 1.0);
        "Dwell" "time" NOT_ABOVE, |x| Dwell::exponential(law(), 0.5, x);
        "Dwell" "time" NOT_ABOVE, |x| Dwell::hyperbolic(law(), 0.5, x);
        "Dwell" "time" NOT_ABOVE, |x| Dwell::logarithmic(law(), 0.1, x);
        "FrictionLaw" "static_coefficient" BELOW, |x| MassOnBelt::new(given(x), 0.2);
        "FrictionLaw" "static_coefficient" BELOW, |x| Contact::new(0, given(x), 1.0);
        "ForceLaw" "slope of the potential" &[1e-3, -1.0], |x| ForceElement::new(0, Stored(x));
        "ContactLaw" "rate" &ANY, |x| Contact::new(0, Remembering(x), 1.0);
        "check_law" "speeds.start" BELOW, |x| check_law(&law(), x..1.0);
        "check_law" "speeds.end" &[0.1, 0.0], |x| check_law(&law(), 0.1..x);
    }
}

fn blocks() -> Structure {
    Structure::new(&[1.0, 1.0]).unwrap()
}

fn systems() -> Vec<Case> {
    cases! {
        "MassOnBelt" "belt_velocity" &ANY, |x| MassOnBelt::new(law(), x);
        "MassOnBelt" "belt_velocity" &ANY, |x| belt().with_belt_velocity(x);
        "MassOnBelt" "damping" BELOW, |x| belt().with_damping(x);
        "MassOnBelt" "load" NOT_ABOVE, |x| belt().with_load(x);
        // So large that derived numbers overflow.
        "MassOnBelt" "load" &[1e300],
            |x| MassOnBelt::new(Coulomb::new(1e10, 1e10)?, 1.0)?.with_load(x);
        "MassOnBelt" "damping" &[1e308], |x| belt().with_belt_velocity(10.0)?.with_damping(x);
        "MassOnBelt" "belt_velocity" &[1e308],
            |x| belt().with_damping(100.0)?.with_belt_velocity(x);
        "Scaling" "mass" NOT_ABOVE, |mass| Scaling::new(Physical { mass, ..PAD });
        "Scaling" "stiffness" NOT_ABOVE, |stiffness| Scaling::new(Physical { stiffness, ..PAD });
        "Scaling" "damping" &[-1.0], |damping| Scaling::new(Physical { damping, ..PAD });
        "Scaling" "normal_force" NOT_ABOVE,
            |normal_force| Scaling::new(Physical { normal_force, ..PAD });
        "Scaling" "belt_velocity" &ANY,
            |belt_velocity| Scaling::new(Physical { belt_velocity, ..PAD });
        "Scaling" "stiffness" &[1e300],
            |stiffness| Scaling::new(Physical { mass: 1e-300, stiffness, ..PAD });
        "Scaling" "length" NOT_ABOVE, |x| Scaling::new(PAD)?.with_length(x);
        "Scaling" "length" &[1e-310, 1e306], |x| Scaling::new(PAD)?.with_length(x);
        // A load that underflows, in units that are ordinary.
        "Scaling" "length" &[1e299], |x| {
            let soft = Physical { mass: 1.0, stiffness: 1.0, normal_force: 1e-10, ..PAD };
            Scaling::new(soft)?.with_length(x)
        };
        // A belt that moves does so in dimensionless numbers too.
        "Scaling" "length" &[1e30],
            |x| Scaling::new(Physical { belt_velocity: 1e-300, ..PAD })?.with_length(x);
        "Integrator" "tolerance" NO_TOLERANCE, |x| Integrator::new().with_tolerance(x);
        "Integrator" "start_time" &ANY, |x| Integrator::new().with_start_time(x);
        "Integrator" "stop time" &ANY, |x| {
            let rest = State::new(0.0, 0.0);
            Integrator::new().simulate_until(&belt(), rest, 1.0, |_| Some(x))
        };
        "Drive" "value" &ANY, |x| Drive::constant(1.0).with_constant(x);
        "Drive" "amplitude" &ANY, |x| Drive::sine(x, 1.0);
        // A slope that overflows.
        "Drive" "amplitude" &[1e200], |x| Drive::sine(x, 1e150);
        "Drive" "angular_frequency" NOT_ABOVE, |x| Drive::sine(1.0, x);
        "Drive" "amplitude" &ANY, |x| Drive::harmonic(x, 1.0, 0.0);
        "Drive" "angular_frequency" NOT_ABOVE, |x| Drive::harmonic(1.0, x, 0.0);
        "Drive" "phase" &ANY, |x| Drive::harmonic(1.0, 1.0, x);
        "Drive" "time" &[-1.0], |x| Drive::profile(&[(0.0, 1.0), (x, 2.0)]);
        "Drive" "value" &ANY, |x| Drive::profile(&[(0.0, 1.0), (1.0, x)]);
        "Drive" "size" BELOW, |x| Drive::function(Timed([x, 1.0, 1.0, 0.0]));
        "Drive" "period" NOT_ABOVE, |x| Drive::function(Timed([1.0, 1.0, x, 0.0]));
        "Drive" "value" &ANY, |x| Drive::function(Timed([1.0, 1.0, 1.0, x]));
        "Contact" "load" NOT_ABOVE, |x| blocks().with_contact(Contact::new(0, law(), x)?);
        "Contact" "gradient" &ANY, |x| Contact::new(0, law(), 1.0)?.with_load_gradient(0, x);
        "Stop" "q_max" &ANY, |x| Stop::above(0, x, 0.0);
        "Stop" "q_min" &ANY, |x| Stop::below(0, x, 0.0);
        "Stop" "gap" &ANY, |x| Stop::between(0, 1, x, 0.0);
        "Stop" "restitution" &[-0.1, 1.1], |x| Stop::between(0, 1, 1.0, x);
        "Stop" "stiffness" NOT_ABOVE, |x| stop()?.with_contact_stiffness(x, 0.0);
        "Stop" "damping" BELOW, |x| stop()?.with_contact_stiffness(1.0, x);
        "FirstOrder" "time_constant" &[-1.0, 0.0, -0.0, 5e-324], |x| FirstOrder::lag(x);
        "FirstOrder" "gain" &ANY, |x| FirstOrder::integrator().with_displacement(0, x);
        "FirstOrder" "gain" &ANY, |x| FirstOrder::integrator().with_velocity(0, x);
        "FirstOrder" "gain" &ANY, |x| FirstOrder::integrator().with_state(0, x);
        "FirstOrder" "gain" &ANY, |x| FirstOrder::integrator().with_force(0, x);
        "FirstOrder" "gain" &[f64::MAX],
            |x| FirstOrder::integrator().with_force(0, f64::MAX)?.with_force(0, x);
        "Drive" "value" &ANY, |x| FirstOrder::integrator().with_drive(x);
        "ForceLaw" "slope of the potential" &[1e-3, -1.0],
            |x| FirstOrder::integrator().with_law_of_state(0, Stored(x));
        "Structure" "mass 1" NOT_ABOVE, |x| Structure::new(&[1.0, x, -2.0]);
        "Structure" "mass matrix (1, 1)" NOT_ABOVE,
            |x| Structure::with_mass_matrix(DMatrix::from_row_slice(2, 2, &[1.0, 0.0, 0.0, x]));
        "Structure" "mass matrix (0, 1)" &ANY,
            |x| Structure::with_mass_matrix(DMatrix::from_row_slice(2, 2, &[1.0, x, 0.0, 1.0]));
        "Structure" "time" &ANY, |x| blocks().carried(x, &structure::State::at_rest(2));
        "Structure" "time" &ANY, |x| blocks().mechanisms(x, &structure::State::at_rest(2));
        "Structure" "time" &ANY,
            |x| blocks().acceleration(x, &structure::State::at_rest(2));
        "Structure" "stiffness (0, 0)" &ANY, |x| blocks().with_ground_spring(0, x);
        "Structure" "damping (1, 1)" &ANY, |x| blocks().with_ground_damper(1, x);
        "Structure" "stiffness (1, 0)" &ANY, |x| blocks().with_spring(1, 0, x);
        "Structure" "damping (0, 1)" &ANY, |x| blocks().with_damper(0, 1, x);
        "Structure" "stiffness (1, 0)" &ANY,
            |x| blocks().with_stiffness(DMatrix::from_row_slice(2, 2, &[0.0, 0.0, x, 0.0]));
        "Structure" "damping (1, 0)" &ANY,
            |x| blocks().with_damping(DMatrix::from_row_slice(2, 2, &[0.0, 0.0, x, 0.0]));
        "Structure" "force on coordinate 1" &ANY, |x| blocks().with_force(1, x);
        "Structure" "contact 0" &ANY,
            |x| Structure::new(&[1.0])?.with_contact(Contact::new(0, law(), 1.0)?.on_belt(x));
        "State" "sliding" &ANY, |x| {
            let contact = Contact::new(0, law(), 1.0)?.on_belt(0.1);
            let start = structure::State::new(&[0.0], &[0.0]).with_sliding(0, x);
            Structure::new(&[1.0])?.with_contact(contact)?.simulate(start, 1.0)
        };
        "Structure" "memory" &ANY, |x| {
            let brush = Contact::new(0, Dahl::new(0.4, 1e3)?, 1.0)?.on_belt(0.1);
            let start = structure::State::new(&[0.0], &[0.0]).with_memory(&[x]);
            Structure::new(&[1.0])?.with_contact(brush)?.simulate(start, 1.0)
        };
    }
}

fn searches() -> Vec<Case> {
    let start = || State::new(0.3, 0.0);
    let loads = |range| bifurcation::along(|load| belt().with_load(load), range);
    let velocities = [
        bifurcation::hopf_velocities::<Exponential>,
        bifurcation::grazing_velocities,
        bifurcation::touching_velocities,
        bifurcation::overshoot_velocities,
        bifurcation::crossing_velocities,
        bifurcation::fold_velocities,
    ];
    let velocities = velocities.into_iter().flat_map(|search| {
        cases! {
            "bifurcation::along" "range.start" &ANY, |x| search(&belt(), x..1.0);
            "bifurcation::along" "range.end" EMPTY, |x| search(&belt(), 0.1..x);
            "bifurcation::along" "range.end" &[0.0, -0.5], |x| search(&belt(), 0.0..x);
            "bifurcation::along" "range.end" &[-0.5, -0.2], |x| search(&belt(), -0.2..x);
        }
    });
    let others = cases! {
        "Trajectory" "interval" NOT_ABOVE,
            |x| belt().simulate(start(), 1.0)?.sample_every(x).map(Iterator::count);
        "bifurcation::along" "range.end" EMPTY, |x| loads(0.1..x).vibration_ranges();
        "bifurcation::along" "range.end" EMPTY, |x| loads(0.1..x).silence();
        "orbit::section" "period" NOT_ABOVE,
            |x| orbit::section(&belt(), &start(), x).next().transpose();
        "orbit::section_through" "speed" NOT_ABOVE,
            |x| orbit::section_through(&belt(), &start(), 0, x).next().transpose();
        "orbit::Period" "period" NOT_ABOVE, |x| orbit::shoot(&belt(), &start(), Period::Free(x));
        "orbit::follow" "range.start" &ANY, |x| follow(0.2, x..0.3);
        "orbit::follow" "range.end" EMPTY, |x| follow(0.2, 0.1..x);
        "orbit::sweep" "value" &[0.2, 0.1],
            |x| orbit::sweep(|v| belt().with_belt_velocity(v), &[0.2, x], &(0.0, 0.0).into());
        "orbit::vibration_ranges" "range.start" &ANY,
            |x| orbit::vibration_ranges(|v| belt().with_belt_velocity(v), x..0.3);
        "orbit::vibration_ranges" "range.end" EMPTY,
            |x| orbit::vibration_ranges(|v| belt().with_belt_velocity(v), 0.1..x);
        "orbit::begin" "parameter" &ANY, |x| orbit::begin(|v| belt().with_belt_velocity(v), x);
        "Structure::stability_changes" "times.start" &ANY,
            |x| Structure::new(&[1.0])?.stability_changes(x..1.0);
        "Structure::stability_changes" "times.end" EMPTY,
            |x| Structure::new(&[1.0])?.stability_changes(0.1..x);
        "Structure" "time" &ANY, |x| Structure::new(&[1.0])?.frozen(x);
        "orbit::follow" "parameter" &[0.0, 0.4], |x| follow(x, 0.1..0.3);
        "orbit::sensitivities" "parameter" &[], |x| {
            let family = |p: &[f64]| {
                let force = if p[0].is_finite() { p[0] } else { 0.1 };
                Ok((forced(0.78, force)?, structure::State::at_rest(1)))
            };
            Ok(orbit::sensitivities(family, &[x], 1.0)?.events().len())
        };
        "orbit::locus" "ranges[0].start" &[], |x| locus(0.3, [x..0.75, 0.2..0.4]);
        "orbit::locus" "ranges[1].end" &[0.2, 0.1], |x| locus(0.3, [0.7..0.75, 0.2..x]);
        "orbit::locus" "second" &[0.1, 0.5], |x| locus(x, [0.7..0.75, 0.2..0.4]);
        "bifurcation::hopf_locus" "ranges[1].start" &[], |x| hopf_locus([0.1..0.5, x..0.1]);
        "bifurcation::hopf_locus" "ranges[0].end" EMPTY, |x| hopf_locus([0.1..x, 0.01..0.1]);
        "design::stabilizing_damping_over" "velocities.start" &[-1.0],
            |x| design::stabilizing_damping_over(&belt(), x..1.0);
        "design::stabilizing_damping_over" "velocities.end" EMPTY,
            |x| design::stabilizing_damping_over(&belt(), 0.1..x);
        "lugre::passive_viscosity" "max_speed" NOT_ABOVE,
            |x| lugre::passive_viscosity(&LuGre::new(law(), 1e3, 1.0, 0.0)?, x);
        "averaging" "amplitude" &[-1.0], |x| averaging::drift(&belt(), x);
        "PureSlip" "initial_amplitude" &[-1.0], |x| formulas().transient(x, 0.0);
        "PureSlip" "initial_phase" &ANY, |x| formulas().transient(0.1, x);
    };
    velocities.chain(others).collect()
}

/// One more than the largest power of a speed.
const MOST: f64 = 2_147_483_648.0;

/// Counts that are refused, and as which number.
fn counts() -> Vec<(&'static str, &'static str, f64, Error)> {
    let forced = Structure::new(&[1.0]).unwrap();
    let forced = forced
        .with_force(0, Drive::sine(1.0, 1.0).unwrap())
        .unwrap();
    let start = structure::State::new(&[0.0], &[0.0]);
    let belt = belt();
    let mut no_contact = orbit::section_at(&belt, &(0.0, 0.0).into(), 3, EventKind::Stick);
    let no_contact_3 = no_contact.next().unwrap().unwrap_err();
    assert_eq!(no_contact.next(), None);
    let mut no_contact = orbit::section_through(&belt, &(0.0, 0.0).into(), 3, 0.1);
    let no_contact_4 = no_contact.next().unwrap().unwrap_err();
    assert_eq!(no_contact.next(), None);
    let no_period = orbit::shoot(&forced, &start, Period::Driven(0));
    let no_steps = Integrator::new().with_max_steps(0);
    let no_search = Search::new().with_max_steps(0);
    let no_events = Integrator::new().with_max_events(0);
    let no_power = Stribeck::new(0.4, 0.2, 0.5, 0);
    let too_high = Stribeck::new(0.4, 0.2, 0.5, MOST as u32);
    let smooth = Coulomb::new(0.4, 0.0).unwrap();
    let no_friction = LuGre::new(smooth, 1.0, 0.0, 0.0);
    let no_points = Search::new().with_max_points(0);
    let no_table = Tabulated::new([]);
    let one_point = Tabulated::new([(0.0, 0.4)]);
    let no_spring = PolynomialSpring::new(&[]);
    let no_force = TabulatedForce::new(&[]);
    let one_force = TabulatedForce::piecewise_linear(&[(0.0, 0.4)]);
    let (spring, forces) = ("PolynomialSpring", "TabulatedForce");
    let no_point = Drive::profile(&[]);
    let no_mass = Structure::new(&[]);
    let no_matrix = Structure::with_mass_matrix(DMatrix::zeros(0, 0));
    let no_time = orbit::lyapunov(&forced, &start, 1.0, 1e-17);
    vec![
        ("Integrator", "max_steps", 0.0, no_steps.unwrap_err()),
        ("Integrator", "max_events", 0.0, no_events.unwrap_err()),
        ("Search", "max_steps", 0.0, no_search.unwrap_err()),
        ("Search", "max_points", 0.0, no_points.unwrap_err()),
        ("LuGre", "coefficient", 0.0, no_friction.unwrap_err()),
        ("Stribeck", "exponent", 0.0, no_power.unwrap_err()),
        ("Stribeck", "exponent", MOST, too_high.unwrap_err()),
        ("Tabulated", "points", 0.0, no_table.unwrap_err()),
        ("Tabulated", "points", 1.0, one_point.unwrap_err()),
        (spring, "coefficients", 0.0, no_spring.unwrap_err()),
        (forces, "points", 0.0, no_force.unwrap_err()),
        (forces, "points", 1.0, one_force.unwrap_err()),
        ("Drive", "points", 0.0, no_point.unwrap_err()),
        ("Structure", "masses", 0.0, no_mass.unwrap_err()),
        ("Structure", "masses", 0.0, no_matrix.unwrap_err()),
        ("orbit::Period", "periods", 0.0, no_period.unwrap_err()),
        ("orbit::section_at", "contact", 3.0, no_contact_3),
        ("orbit::section_through", "contact", 3.0, no_contact_4),
        ("orbit::lyapunov", "duration", 1e-17, no_time.unwrap_err()),
    ]
}

/// The error holds the number, and its message begins with the name of what refuses and goes on to
/// that of the number.
#[track_caller]
fn assert_names(error: &Error, of: &str, name: &str, x: f64) {
    let text = error.to_string();
    let rest = text
        .strip_prefix(of)
        .and_then(|rest| rest.strip_prefix(": "));
    let rest = rest.unwrap_or_else(|| panic!("{of}: {text}"));
    assert!(rest.contains(&format!("{name} = ")), "{of}, {name}: {text}");
    assert!(rest.contains("not allowed"), "{text}");
    assert!(
        !rest.ends_with(['.', ' ']) && !rest.starts_with(char::is_uppercase),
        "{text}"
    );
    let (value, allowed) = match error {
        Error::InvalidParameter { value, allowed, .. }
        | Error::BadPoint { value, allowed, .. }
        | Error::BadElement { value, allowed, .. } => (value, *allowed),
        Error::InvalidTolerance {
            value, min, max, ..
        } => {
            assert_eq!([*min, *max], [1e-16, 1e-2]);
            (value, "1e-16 ≤ tolerance ≤ 1e-2")
        }
        other => panic!("{other:?}"),
    };
    assert_eq!(value.to_bits(), x.to_bits(), "{text}");
    assert!(text.contains(allowed), "{text}");
    // Nobody is told to give a finite number who has done so.
    if !matches!(error, Error::InvalidTolerance { .. }) {
        assert_eq!(text.contains("finite number"), !x.is_finite(), "{text}");
    }
}

#[test]
fn every_refusal_names_its_constructor_and_its_number() {
    let mut names = BTreeSet::new();
    for (of, name, bad, call) in laws().into_iter().chain(systems()).chain(searches()) {
        names.insert(of);
        let not_finite = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY];
        for &x in not_finite.iter().chain(bad) {
            let error = call(x).unwrap_or_else(|| panic!("{of} takes {name} = {x}"));
            assert_names(&error, of, name, x);
        }
    }
    for (of, name, count, error) in counts() {
        names.insert(of);
        assert_names(&error, of, name, count);
    }
    // Nothing that refuses is missing above.
    let mut written = BTreeSet::new();
    written_names(&root().join("src"), &mut written);
    assert!(written.len() > 20);
    let missing: Vec<_> = written
        .iter()
        .filter(|of| !names.contains(of.as_str()))
        .collect();
    assert!(
        missing.is_empty(),
        "no bad number is tried with {missing:?}"
    );
}

/// The names that `Error::check` is called with in the source.
fn written_names(folder: &Path, names: &mut BTreeSet<String>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            written_names(&path, names);
        } else if !path.ends_with("tests.rs") {
            let text = fs::read_to_string(&path).unwrap();
            for rest in text.split("Error::check(").skip(1) {
                let of = rest.trim_start().strip_prefix('"');
                names.extend(of.and_then(|of| Some(of.split_once('"')?.0.to_owned())));
            }
        }
    }
}
