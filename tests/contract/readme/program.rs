use stick_slip::{Error, Physical, PhysicalMassOnBelt, Stribeck};

fn main() -> Result<(), Error> {
    let pad = Physical {
        mass: 4.0,           // kg
        stiffness: 1.0e6,    // N/m
        damping: 20.0,       // N·s/m
        normal_force: 800.0, // N
        belt_velocity: 0.03, // m/s, of the disc
    };
    // Friction falls from 0.45 to 0.35 within some 0.05 m/s.
    let brake = PhysicalMassOnBelt::new(pad, Stribeck::new(0.45, 0.35, 0.05, 1)?)?;
    for groan in brake.cycles()?.stable() {
        let (hertz, amplitude) = (1.0 / groan.period(), 1e3 * groan.amplitude());
        println!("{}: {hertz:.3} Hz, {amplitude:.4} mm", groan.kind());
    }
    println!("silent below {:.2} N", brake.silencing_load()?);
    println!("silent above {:.1} N·s/m", brake.silencing_damping()?);
    Ok(())
}
