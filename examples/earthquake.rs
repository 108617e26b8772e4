//! Earthquakes of a spring-slider: recurrence time, slip and stress drop over the stiffness.
//!
//! What to learn from it:
//!
//! * a fault under rate-and-state friction (`RateState`) does not stick: between two earthquakes it
//!   creeps at 1e-15 m/s, in an earthquake it slides at 0.4 m/s. Steps are as long as the motion
//!   allows, from years to milliseconds: some 170 a cycle;
//! * the displacement is the stretch of the spring, and the surface moves with the plate, so that
//!   no number grows with time. The damping by radiated waves acts on the sliding speed: a force
//!   η V_p beside a damper η;
//! * `orbit::section_through` finds where the fault becomes slow, a good guess for `orbit::shoot`,
//!   which finds the cycle; its second multiplier says how much of a disturbance is left after an
//!   earthquake;
//! * below the critical stiffness the fault is unstable. The formula for the stress drop
//!   (`analysis::rate_state`) leaves out inertia, which nearly doubles it.
//!
//! ```text
//! m x'' = η (V_p − x') − k x + N f(V, θ),   V = V_p − x',   f = a arsinh(V/(2V₀) e^((f₀ + bφ)/a))
//! φ = ln(V₀θ/D_c),   θ' = 1 − Vθ/D_c
//! ```
//!
//! Run it with `cargo run --release -p stick-slip-examples --example earthquake`.

use stick_slip::analysis::rate_state::stress_drop;
use stick_slip::orbit::{self, Orbit, Passage, Period};
use stick_slip::structure::State;
use stick_slip::{Contact, Error, RateState, Segment, Structure};

pub(crate) const YEAR: f64 = 365.25 * 86400.0;
/// Normal stress, N/m²; velocity of the plate, m/s; damping by radiation, N·s/m³.
const NORMAL: f64 = 5e7;
pub(crate) const PLATE: f64 = 1e-9;
const RADIATION: f64 = 4.6e6;
/// Angular frequency √(k/m) at the critical stiffness, 1/s.
const INERTIA: f64 = 2.0;

fn law() -> Result<RateState, Error> {
    RateState::aging(0.6, 0.01, 0.015, 0.008, 1e-6)
}

/// Per unit of area of the fault.
fn fault(stiffness: f64, mass: f64) -> Result<Structure, Error> {
    Structure::new(&[mass])?
        .with_ground_spring(0, stiffness)?
        .with_ground_damper(0, RADIATION)?
        .with_force(0, RADIATION * PLATE)?
        .with_contact(Contact::new(0, law()?, NORMAL)?.on_belt(PLATE))
}

/// The sliding speed, which is known to all its digits.
pub(crate) fn speed(state: &State) -> f64 {
    let creeping = state.sliding().first();
    creeping.map_or(PLATE - state.velocities[0], |(_, velocity)| velocity.abs())
}

/// Time between two of the earthquakes after the first five, and the state in which the fault
/// becomes slow after them: nearly those of the cycle.
fn later(fault: &Structure, start: &State) -> Result<(f64, State), Error> {
    let passages = orbit::section_through(fault, start, 0, 1e-3 * PLATE);
    let is_slower = |passage: &Result<Passage<State>, Error>| {
        passage.as_ref().map_or(true, |passage| !passage.rises)
    };
    let mut slower = passages.filter(is_slower).skip(5);
    let mut next = || slower.next().unwrap_or(Err(Error::AtRest));
    let (one, other) = (next()?, next()?);
    Ok((other.time - one.time, other.state))
}

/// The speed at the middle of each part of a period, and the largest and the least of all.
fn speeds(fault: &Structure, orbit: &Orbit<State>) -> Result<(Vec<f64>, [f64; 2]), Error> {
    const PARTS: usize = 64;
    let motion = fault.simulate(orbit.state().clone(), orbit.period())?;
    let mut range = [f64::INFINITY, 0.0_f64];
    for step in motion.steps() {
        for part in 0..=PARTS {
            let state = step.state_at(step.duration() * part as f64 / PARTS as f64);
            range = [range[0].min(speed(&state)), range[1].max(speed(&state))];
        }
    }
    let middle = |part: usize| orbit.period() * (part as f64 + 0.5) / PARTS as f64;
    let states = (0..PARTS).filter_map(|part| motion.state_at(middle(part)));
    Ok((states.map(|state| speed(&state)).collect(), range))
}

/// The stiffness at which steady sliding becomes unstable, and the mass, whatever the stiffness.
fn critical(law: &RateState) -> (f64, f64) {
    let massless = law.critical_stiffness(NORMAL, PLATE, 0.0, RADIATION);
    let mass = massless.map_or(0.0, |stiffness| stiffness / INERTIA.powi(2));
    let critical = law.critical_stiffness(NORMAL, PLATE, mass, RADIATION);
    (
        critical.expect("b > a: the fault weakens with the speed"),
        mass,
    )
}

/// The cycle of a fault with a part of the critical stiffness.
pub(crate) fn cycle(part: f64) -> Result<(Structure, Orbit<State>), Error> {
    let law = law()?;
    let (critical, mass) = critical(&law);
    let stiffness = part * critical;
    let fault = fault(stiffness, mass)?;
    let start = State::new(&[0.9 * NORMAL * law.steady(PLATE) / stiffness], &[0.0])
        .with_memory(&[law.memory_at(PLATE)]);
    let (guess, state) = later(&fault, &start)?;
    let orbit = orbit::shoot(&fault, &state, Period::Free(guess))?;
    Ok((fault, orbit))
}

fn main() -> Result<(), Error> {
    let law = law()?;
    let (critical, _) = critical(&law);
    println!("critical stiffness {:.5} MPa/m", critical * 1e-6);
    println!("  k/k_c   recurrence   slip    stress drop    speeds             multiplier");
    println!("          years        m       MPa  (formula) m/s");
    let mut seen = None;
    for part in [0.8, 0.6, 0.4, 0.3, 0.2] {
        let (fault, orbit) = cycle(part)?;
        let stiffness = part * critical;
        // Without inertia: from the speed of the plate to that at which radiation balances.
        let expected = stress_drop(&law, NORMAL, PLATE, 1.0);
        let (speeds, [least, largest]) = speeds(&fault, &orbit)?;
        let (low, high) = orbit.extremes(0);
        println!(
            "  {part:.1}     {:10.5}   {:.4}  {:.4} ({:.4})  {least:.2e} {largest:.4}   {:.2e}",
            orbit.period() / YEAR,
            PLATE * orbit.period(),
            stiffness * (high - low) * 1e-6,
            expected * 1e-6,
            orbit.multipliers()[0].re,
        );
        seen = Some(speeds);
    }
    println!("\nspeed over the last cycle, a column each 1/64 of it; a line each two decades");
    let decades: Vec<f64> = seen.unwrap_or_default().iter().map(|v| v.log10()).collect();
    for line in (-8..=-4).rev().map(|line| 2.0 * f64::from(line) + 1.0) {
        let mark = |decade: &f64| {
            if (decade - line).abs() <= 1.0 {
                '*'
            } else {
                ' '
            }
        };
        println!(
            "  1e{line:<4}|{}",
            decades.iter().map(mark).collect::<String>()
        );
    }
    Ok(())
}
