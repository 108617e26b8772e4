use stick_slip::{MassOnBelt, Polynomial, State, limit_cycle};

fn main() -> Result<(), stick_slip::Error> {
    let law = Polynomial::new(0.4, 0.25, 0.5)?; // static μ, least μ, speed of least μ
    let system = MassOnBelt::new(law, 0.2)?.with_damping(0.05)?; // belt velocity, damping ratio

    let motion = system.simulate(State::new(0.0, 0.0), 10.0)?;
    for event in motion.events() {
        println!("{:.12}  {}", event.time, event.kind);
    }

    for cycle in limit_cycle::find(&system)?.stable() {
        let (period, amplitude) = (cycle.period(), cycle.amplitude());
        println!("{}: T = {period:.12}, a = {amplitude:.12}", cycle.kind());
    }
    Ok(())
}
