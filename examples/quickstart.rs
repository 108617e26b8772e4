use stick_slip::*;
fn main() -> Result<(), Error> {
    let system = MassOnBelt::new(Polynomial::new(0.4, 0.25, 0.5)?, 0.2)?.with_damping(0.05)?;
    let m = system.simulate(State::new(0.0, 0.0), 40.0)?;
    for e in m.events() {
        println!("{:.17e} {e}", e.time);
    }
    println!("{}", m.steps().len());
    let system = MassOnBelt::new(Exponential::new(0.4, 0.25, 0.5)?, 0.2)?.with_damping(0.05)?;
    let m = system.simulate(State::new(0.0, 0.0), 40.0)?;
    for e in m.events() {
        println!("{:.17e} {e}", e.time);
    }
    println!("{}", m.steps().len());
    let system = MassOnBelt::new(Polynomial::new(0.4, 0.25, 0.5)?, 0.2)?.with_damping(0.05)?;
    for tol in [1e-16, 1e-12, 1e-9] {
        let n = 20000.0;
        for _ in 0..3 {
            let t = std::time::Instant::now();
            let (mut k, mut last, mut steps) = (0, 0.0, 0);
            for step in Integrator::new()
                .with_tolerance(tol)?
                .flow(&system, State::new(0.0, 0.0))?
            {
                let step = step?;
                steps += 1;
                if step.event().is_some() {
                    k += 1;
                    last = step.end_time();
                }
                if step.end_time() > 6.8 * n {
                    break;
                }
            }
            let e = t.elapsed().as_secs_f64();
            println!(
                "{tol:e}: {k} events, {last}, {:.1} steps/cycle, {:.3} µs/cycle, {:.1} ns/step",
                steps as f64 / n,
                e / n * 1e6,
                e / steps as f64 * 1e9
            );
        }
    }
    Ok(())
}
