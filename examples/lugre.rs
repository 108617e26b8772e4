//! LuGre bristles in stick-slip: the simulation of Canudas de Wit et al., compared with dry
//! friction.
//!
//! What to learn from it:
//!
//! * contacts with bristles never stick: the mass creeps at a few micrometres per second, and every
//!   instant of zero velocity is a crossing. The times of these crossings are ill-conditioned, but
//!   the states are not;
//! * near stick the mass is a stiff oscillator (here 50 Hz), and in slip the bristles relax within
//!   microseconds. Nevertheless the run takes only a few hundred steps;
//! * dry friction with the same law, which is the limit of stiff bristles, slips at nearly the same
//!   times;
//! * this friction is not passive: `analysis::lugre` gives the viscosity that would make it
//!   passive.
//!
//! Run it with `cargo run --release -p stick-slip-examples --example lugre`.

use stick_slip::analysis::lugre::{contact_vibration, passive_viscosity, steady_bristles};
use stick_slip::structure::State;
use stick_slip::{
    Contact, ContactLaw, Error, EventKind, Exponential, Integrator, LuGre, Segment, Structure,
};

/// C. Canudas de Wit, H. Olsson, K. J. Åström, P. Lischinsky, *A new model for control of systems
/// with friction*, IEEE Trans. Automatic Control 40 (1995) 419-425: a mass of 1 kg is pulled over
/// the ground by a spring of 2 N/m, whose end moves at 0.1 m/s. In the frame of this end, the
/// ground moves backward.
fn pulled<L: ContactLaw + Send + Sync + 'static>(law: L) -> Result<Structure, Error> {
    Structure::new(&[1.0])?
        .with_ground_spring(0, 2.0)?
        .with_contact(Contact::new(0, law, 1.0)?.on_belt(-0.1))
}

fn main() -> Result<(), Error> {
    let g = Exponential::new(1.5, 1.0, 0.001)?;
    let law = LuGre::new(g, 1e5, 1e5_f64.sqrt(), 0.4)?;
    println!("Table I: σ0 = 1e5 N/m, σ1 = √1e5 Ns/m, σ2 = 0.4 Ns/m, 1 to 1.5 N, v_s = 0.001 m/s");
    if let Some(held) = contact_vibration(&law, 1.0, 1.0, 2.0, 0.0) {
        let (omega, ratio) = (held.angular_frequency, held.damping_ratio);
        println!("  held by its bristles: {omega:.3} rad/s, damping ratio {ratio:.4}");
    }
    if let Some(steady) = steady_bristles(&law, 0.1) {
        let (force, rate) = (steady.coefficient, steady.rate);
        println!("  sliding at 0.1 m/s: {force:.6} N; bristles follow at the rate {rate:.0} 1/s");
        assert!((force - 1.04).abs() < 1e-15);
    }
    let least = passive_viscosity(&law, 1.0)?;
    println!("  passive only with σ2 ≥ {least:.1} Ns/m");

    let block = pulled(law)?;
    let many = Integrator::new().with_max_steps(100_000)?;
    let (mut steps, mut slips, mut fastest, mut crossings) = (0, Vec::new(), 0.0_f64, 0);
    let mut is_slow = true;
    for step in many.flow(&block, State::new(&[0.0], &[-0.1]))? {
        let step = step?;
        steps += 1;
        crossings += step.events().len();
        let end = step.end_state();
        // Over the ground.
        let speed = end.velocities[0] + 0.1;
        let inside = (0..16).map(|i| step.state_at(step.duration() * f64::from(i) / 16.0));
        fastest = inside.fold(fastest, |fastest, state| {
            fastest.max(state.velocities[0] + 0.1)
        });
        if is_slow && speed > 0.001 {
            slips.push(step.end_time());
        }
        is_slow = speed < 0.001;
        if step.end_time() > 40.0 {
            break;
        }
    }
    println!("\n40 s: {steps} steps, {crossings} crossings; up to {fastest:.4} m/s");
    assert!(steps < 2000);

    // With dry friction slip begins when the spring is stretched by 1.5/2.
    let dry = pulled(g)?
        .with_ground_damper(0, 0.4)?
        .with_force(0, -0.04)?;
    let motion = dry.simulate(State::new(&[0.0], &[-0.1]), 40.0)?;
    let released = motion.events().iter();
    let released = released.filter(|event| matches!(event.kind, EventKind::Release(_)));
    let released: Vec<f64> = released.map(|event| event.time).collect();
    println!("\nslip begins   with bristles        dry");
    for (slip, dry) in slips.iter().zip(&released) {
        println!("            {slip:12.3}  {dry:12.3}");
    }
    // With bristles the mass creeps before slip begins, and slip begins earlier.
    let [one, other] = [&slips, &released].map(|times| (times[4] - times[1]) / 3.0);
    println!("period      {one:12.3}  {other:12.3}");
    assert!((one - 6.363).abs() < 1e-3 && (other - 6.512).abs() < 1e-3);
    Ok(())
}
