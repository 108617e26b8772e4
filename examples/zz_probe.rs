use stick_slip::*;
fn main() -> Result<(), Box<dyn std::error::Error>> {
    for v_m in [1e-2, 1e-3, 3e-4, 1e-4] {
        for tau in [5.0, 20.0] {
            let law = Polynomial::new(0.4, 0.2, v_m)?;
            let system = MassOnBelt::new(law, 1.0)?.with_damping(0.05)?;
            let m = system.simulate(State::new(0.0, 0.0), tau)?;
            let last = m.last();
            println!(
                "{v_m:e} {tau} steps {} events {} {last:?} s={:e}",
                m.steps().len(),
                m.events().len(),
                1.0 - last.velocity
            );
        }
    }
    for v_m in [0.05, 0.02, 0.01, 1e-3] {
        let law = Polynomial::new(0.4, 0.25, v_m)?;
        let system = MassOnBelt::new(law, 20.0 * v_m)?.with_damping(0.05)?;
        let m = system.simulate(State::new(0.0, 0.0), 50.0)?;
        let n = m.steps().len();
        println!(
            "20x {v_m:e} steps {n} events {} {:?}",
            m.events().len(),
            m.last()
        );
    }
    Ok(())
}
