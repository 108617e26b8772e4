//! Static friction that rises during stick: stick-slip disappears as the belt velocity increases.
//!
//! What to learn from it:
//!
//! * `Dwell` adds to any friction law a static coefficient that rises during stick. Its memory
//!   variable, the time in stick, is part of the state of each event;
//! * without damping the amplitude falls to zero at Gao's critical velocity, along a straight line
//!   (hyperbolic form) or a curve. Closed forms exist, and the simulated motions agree with them;
//! * with damping stick-slip disappears at a fold, with a finite amplitude. Just below the fold the
//!   start decides whether the mass sticks.
//!
//! Run it with `cargo run --release -p stick-slip-examples --example rising_static_friction`.

use stick_slip::analysis::dwell::DwellOscillator;
use stick_slip::structure::State;
use stick_slip::{Contact, Coulomb, Dwell, Error, EventKind, Structure};

/// m = k = N = 1, μ_k = 0.3; static friction rises from this value.
fn oscillator(law: Dwell<Coulomb>, damping: f64) -> DwellOscillator {
    DwellOscillator {
        law,
        mass: 1.0,
        stiffness: 1.0,
        damping,
        load: 1.0,
    }
}

fn block(of: &DwellOscillator, velocity: f64) -> Result<Structure, Error> {
    Structure::new(&[of.mass])?
        .with_ground_spring(0, of.stiffness)?
        .with_ground_damper(0, of.damping)?
        .with_contact(Contact::new(0, of.law, of.load)?.on_belt(velocity))
}

/// The duration of stick in each cycle after the transient; `None` if the mass does not stick.
fn stuck(of: &DwellOscillator, velocity: f64, start: f64) -> Result<Option<f64>, Error> {
    let duration = 2000.0;
    let start = State::new(&[start], &[velocity]);
    let motion = block(of, velocity)?.simulate(start, duration)?;
    let mut events = motion.events().iter().rev();
    let last = events.find(|event| matches!(event.kind, EventKind::Release(_)));
    let last = last.filter(|event| event.time > duration - 100.0);
    Ok(last.map(|event| event.state.memory[0]))
}

fn main() -> Result<(), Error> {
    let law = Coulomb::new(0.3, 0.3)?;
    let forms = [
        ("hyperbolic", Dwell::hyperbolic(law, 0.6, 2.0)?),
        ("exponential", Dwell::exponential(law, 0.6, 2.0)?),
        ("logarithmic", Dwell::logarithmic(law, 0.05, 0.4)?),
    ];

    println!("without damping: belt velocity, amplitude, time in stick by formula and simulated");
    for (name, law) in forms {
        let of = oscillator(law, 0.0);
        let critical = of.critical_velocity().unwrap_or(f64::NAN);
        println!("  {name}, critical velocity {critical:.6}");
        for part in [0.2, 0.4, 0.6, 0.8, 0.95, 1.05] {
            let v = part * critical;
            let simulated = stuck(&of, v, 1.0)?;
            let Some(cycle) = of.stick_slip(v) else {
                println!("    {v:8.5}  no stick-slip");
                assert!(simulated.is_none_or(|theta| theta < 1e-4));
                continue;
            };
            let (amplitude, theta) = (cycle.amplitude, cycle.stick_duration);
            let simulated = simulated.unwrap_or(0.0);
            println!("    {v:8.5}  {amplitude:.12}  {theta:16.12}  {simulated:16.12}");
            assert!((simulated - theta).abs() < 1e-10 * (1.0 + theta));
        }
    }

    println!("\nwith a damping ratio of 0.025");
    println!("  form           unstable from   stick-slip up to   its amplitude there");
    for (name, law) in forms {
        let of = oscillator(law, 0.05);
        let (Some(fold), Some(grazing)) = (of.fold(), of.grazing_velocity()) else {
            continue;
        };
        let (velocity, amplitude) = (fold.belt_velocity, fold.amplitude);
        println!("  {name:<12}  {grazing:14.12}    {velocity:14.12}   {amplitude:14.12}");
        // After a large initial displacement, stick-slip lasts below the fold and disappears above
        // it.
        assert!(stuck(&of, 0.999 * velocity, 1.0)?.is_some());
        assert!(stuck(&of, 1.001 * velocity, 1.0)?.is_none());
    }

    // Starts on both sides of the unstable cycle at one belt velocity: the displacement at the
    // first stick decides.
    let of = oscillator(forms[1].1, 0.05);
    if let Some(cycle) = of.unstable_stick_slip(0.165) {
        let caught = cycle.contact_displacement;
        println!("\nexponential form, v = 0.165: the unstable cycle sticks from u = {caught:.6}");
        for (start, goes_on) in [(caught - 1e-3, true), (caught + 1e-3, false)] {
            let motion = block(&of, 0.165)?.simulate(State::new(&[start], &[0.165]), 2000.0)?;
            let sticks = motion
                .events()
                .iter()
                .filter(|e| e.kind == EventKind::Stick);
            let sticks = sticks.count();
            println!("  stick that begins at u = {start:.6} is followed by {sticks} more");
            assert_eq!(sticks > 100, goes_on);
        }
    }
    Ok(())
}
