//! Three motions of the paper by A. Farshidianfar and N. Noei Aghaee, from rest until they settle,
//! compared with the exact periodic motions that they approach.
//!
//! What to learn from it:
//!
//! * a system is a friction law, a belt velocity and a damping ratio; `simulate` gives its events
//!   and its state at any time;
//! * `limit_cycle::find` gives the periodic motions themselves, without a transient: the two
//!   columns of numbers agree, although one comes from a simulation of many oscillations and the
//!   other from the slip arcs of one period;
//! * on a fast belt the mass never reaches the velocity of the belt (Fig. 4) and takes tens of
//!   oscillations to settle; on a slow belt stick and slip alternate (Figs. 5 and 7), and the
//!   motion is periodic after the first release: its multiplier is 0.
//!
//! Run it with `cargo run -p quickstart --example quickstart`.

use stick_slip::{
    Exponential, FrictionLaw, LimitCycle, MassOnBelt, Polynomial, State, Trajectory, limit_cycle,
};

/// Time simulated: about 95 oscillations.
const DURATION: f64 = 600.0;
/// Events printed of each motion.
const SHOWN: usize = 6;

fn main() -> Result<(), stick_slip::Error> {
    println!("Mass on a moving belt: u'' + 2βu' + u + γ²μ(u' − v_b) = 0, with β = 0.05 and γ² = 1");
    let polynomial = Polynomial::new(0.4, 0.25, 0.5)?;
    let exponential = Exponential::new(0.4, 0.25, 0.5)?;
    show("Fig. 4: polynomial law, v_b = 0.4", polynomial, 0.4)?;
    show("Fig. 5: polynomial law, v_b = 0.2", polynomial, 0.2)?;
    show("Fig. 7: exponential law, v_b = 0.2", exponential, 0.2)
}

fn show<L: FrictionLaw>(title: &str, law: L, v_b: f64) -> Result<(), stick_slip::Error> {
    let system = MassOnBelt::new(law, v_b)?.with_damping(0.05)?;
    println!("\n{title}");
    if let Some(equilibrium) = system.equilibrium() {
        let (u, stability) = (equilibrium.displacement, equilibrium.stability);
        println!("  steady sliding at u = {u:.6}: {stability}");
    }

    let motion = system.simulate(State::new(0.0, 0.0), DURATION)?;
    let events = motion.events();
    match events.len() {
        0 => println!("  events from rest: none, the mass slips all the time"),
        n => println!("  events from rest, {} of {n}:", SHOWN.min(n)),
    }
    for event in events.iter().take(SHOWN) {
        let kind = event.kind.to_string();
        println!(
            "    τ = {:12.9}  {kind:<18}  u = {:12.9}",
            event.time, event.state.displacement
        );
    }

    for cycle in limit_cycle::find(&system)?.stable() {
        println!(
            "  settled motion: {}, multiplier {:.6}",
            cycle.kind(),
            cycle.multiplier()
        );
        println!("    {:<16}  {:>14}  {:>14}", "", "simulated", "exact");
        let rows = settled(&motion, cycle);
        for (name, simulated, exact) in rows {
            println!("    {name:<16}  {simulated:14.9}  {exact:14.9}");
        }
        println!(
            "    {:<16}  {:>14}  {:14.9}",
            "time in stick",
            "",
            cycle.stick_duration()
        );
    }
    Ok(())
}

/// Name, value in the last simulated oscillation, value on the exact cycle.
fn settled(motion: &Trajectory, cycle: &LimitCycle) -> Vec<(&'static str, f64, f64)> {
    let turns = turning_points(motion);
    // The last three turning points: one side, the other side, and the first side again.
    let [.., (from, a), (_, b), (to, _)] = turns[..] else {
        return Vec::new();
    };
    vec![
        ("period", to - from, cycle.period()),
        ("u_max", a.max(b), cycle.max_displacement()),
        ("u_min", a.min(b), cycle.min_displacement()),
        ("(u_max − u_min)/2", 0.5 * (a - b).abs(), cycle.amplitude()),
    ]
}

/// Times and displacements of the turning points: zeros of v, bracketed by samples and bisected in
/// the power series of the motion.
fn turning_points(motion: &Trajectory) -> Vec<(f64, f64)> {
    let velocity = |time: f64| {
        motion
            .state_at(time)
            .map_or(f64::NAN, |state| state.velocity)
    };
    let samples: Vec<(f64, State)> = motion.sample(20_001).collect();
    let mut turns = Vec::new();
    for pair in samples.windows(2) {
        let ((mut a, before), (mut b, after)) = (pair[0], pair[1]);
        if before.velocity * after.velocity < 0.0 {
            for _ in 0..50 {
                let middle = 0.5 * (a + b);
                if velocity(middle) * before.velocity > 0.0 {
                    a = middle;
                } else {
                    b = middle;
                }
            }
            turns.extend(motion.state_at(b).map(|state| (b, state.displacement)));
        }
    }
    turns
}
