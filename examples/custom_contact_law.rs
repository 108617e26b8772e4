//! Your own contact law with memory: elasto-plastic bristles, which do not creep.
//!
//! What to learn from it:
//!
//! * a contact law with memory variables is a `ContactLaw`: it gives the friction coefficient, the
//!   static limit, and the rates of the memory variables. If the limit is `None`, the contact never
//!   sticks;
//! * with LuGre's bristles a mass creeps under any oscillating force, however small. In the law of
//!   Dupont et al. bristles are elastic up to a break-away deflection, and yield beyond it only if
//!   slip increases their deflection: the mass does not creep;
//! * a law may branch on the value of its memory. The second derivative of this law jumps at the
//!   deflection at which bristles begin to yield. Steps are short there, but as accurate as
//!   elsewhere.
//!
//! Run it with `cargo run --release -p stick-slip-examples --example custom_contact_law`.

use std::f64::consts::{PI, TAU};

use stick_slip::structure::State;
use stick_slip::{
    Contact, ContactLaw, Coulomb, Drive, Error, LuGre, Motion, Scalar, Slip, Structure,
};

/// P. Dupont, V. Hayward, B. Armstrong, F. Altpeter, *Single state elastoplastic friction models*,
/// IEEE Trans. Automatic Control 47 (2002) 787-792: z' = r(1 − α(z, r) σ0 z/(μ_k sgn r)), μ = σ0 z.
struct ElastoPlastic {
    kinetic: f64,
    stiffness: f64,
    /// Part of the largest deflection, μ_k/σ0, up to which bristles are elastic.
    elastic: f64,
}

impl ContactLaw for ElastoPlastic {
    type Memory<S: Scalar> = [S; 1];
    fn coefficient<S: Scalar>(&self, _: Slip<S>, [z]: [S; 1]) -> S {
        z * self.stiffness
    }
    fn limit<S: Scalar>(&self, _: S, _: [S; 1]) -> Option<S> {
        None
    }
    fn rates<S: Scalar>(&self, motion: Motion<S>, _: S, [z]: [S; 1]) -> [S; 1] {
        let Motion::Slip(slip) = motion else {
            return [z.constant(0.0)];
        };
        // Negative if slip reduces the deflection: bristles do not flow then.
        let bent = z * (slip.direction * self.stiffness / self.kinetic);
        let flow = if bent.value() <= self.elastic {
            z.constant(0.0)
        } else if bent.value() < 1.0 {
            let phase = (bent - 0.5 * (1.0 + self.elastic)) * (PI / (1.0 - self.elastic));
            phase.sin() * 0.5 + 0.5
        } else {
            z.constant(1.0)
        };
        [slip.velocity() * (-(flow * bent) + 1.0)]
    }
    fn breakpoints(&self) -> impl Iterator<Item = f64> {
        std::iter::empty()
    }
    fn caught(&self, memory: [f64; 1]) -> [f64; 1] {
        memory
    }
}

/// A mass of 1 on a table, under a force that oscillates about 0.3 with the period π.
fn pushed<L>(law: L, amplitude: f64) -> Result<Structure, Error>
where
    L: ContactLaw + Send + Sync + 'static,
{
    Structure::new(&[1.0])?
        .with_ground_damper(0, 10.0)?
        .with_force(
            0,
            Drive::harmonic(amplitude, 2.0, -0.5 * PI)?.with_constant(0.3)?,
        )?
        .with_contact(Contact::new(0, law, 1.0)?)
}

/// Displacements after two periods and after twenty.
fn creep(block: &Structure) -> Result<[f64; 2], Error> {
    let start = State::new(&[0.3 / 400.0], &[0.0]).with_memory(&[0.3 / 400.0]);
    let motion = block.simulate(start, 10.0 * TAU)?;
    let at = |time: f64| motion.state_at(time).map(|state| state.displacements[0]);
    Ok([2.0 * PI, 20.0 * PI].map(|time| at(time).unwrap_or(f64::NAN)))
}

fn main() -> Result<(), Error> {
    let (kinetic, stiffness) = (0.6, 400.0);
    println!("bristles of stiffness 400 that carry 0.6 at most, 0.42 elastically; force 0.3 ± a\n");
    println!("             elasto-plastic              LuGre");
    println!("    a    after 2     after 20    after 2     after 20 periods");
    for amplitude in [0.05, 0.1, 0.2, 0.25] {
        let own = ElastoPlastic {
            kinetic,
            stiffness,
            elastic: 0.7,
        };
        let own = creep(&pushed(own, amplitude)?)?;
        let law = LuGre::new(Coulomb::new(kinetic, kinetic)?, stiffness, 0.0, 0.0)?;
        let lugre = creep(&pushed(law, amplitude)?)?;
        println!(
            "{amplitude:6.2}  {:9.6}   {:9.6}   {:9.6}   {:9.6}",
            own[0], own[1], lugre[0], lugre[1]
        );
        // LuGre creeps under any oscillating force, this law only under forces above 0.42.
        assert!(lugre[1] - lugre[0] > 1e-6);
        assert_eq!((own[1] - own[0]).abs() > 1e-6, 0.3 + amplitude > 0.42);
    }
    Ok(())
}
