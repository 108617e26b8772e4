//! The sound of a brake: from a motion in SI units to a WAV file for any audio player.
//!
//! What to learn from it:
//!
//! * `samples` gives a motion at any rate, here 44.1 kHz, and each sample is as exact as the
//!   motion. The acceleration jumps at every stick, so it has harmonics above half the rate; they
//!   are folded back, and this program does not filter them out;
//! * the sound that one hears is nearly proportional to the acceleration of a surface;
//! * a WAV file is 44 bytes of header and the samples.
//!
//! Run it with `cargo run --release -p stick-slip-examples --example sound -- groan.wav`;
//! without a file name it prints a summary of the sound.

use stick_slip::orbit::{self, Period};
use stick_slip::structure::State;
use stick_slip::{Contact, Error, Stribeck, Structure};

/// Samples per second.
const RATE: u32 = 44_100;

/// A pad of 0.5 kg on 2·10⁶ N/m, 318 Hz alone, pressed with 1 kN on a disc at 20 mm/s.
fn brake() -> Result<Structure, Error> {
    let contact = Contact::new(0, Stribeck::new(0.45, 0.35, 0.05, 1)?, 1000.0)?;
    Structure::new(&[0.5])?
        .with_ground_spring(0, 2e6)?
        .with_ground_damper(0, 10.0)?
        .with_contact(contact.on_belt(0.02))
}

/// A WAV file of one channel with 16 bits a sample.
fn wav(samples: &[i16]) -> Vec<u8> {
    let bytes = 2 * samples.len() as u32;
    let mut file = Vec::with_capacity(44 + bytes as usize);
    file.extend(b"RIFF");
    file.extend((36 + bytes).to_le_bytes());
    file.extend(b"WAVEfmt ");
    file.extend(16_u32.to_le_bytes());
    for number in [1_u16, 1] {
        file.extend(number.to_le_bytes()); // plain numbers, one channel
    }
    file.extend(RATE.to_le_bytes());
    file.extend((2 * RATE).to_le_bytes());
    for number in [2_u16, 16] {
        file.extend(number.to_le_bytes()); // bytes and bits a sample
    }
    file.extend(b"data");
    file.extend(bytes.to_le_bytes());
    for sample in samples {
        file.extend(sample.to_le_bytes());
    }
    file
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let brake = brake()?;
    let motion = brake.simulate(State::at_rest(1), 2.0)?;
    let samples = brake.samples(&motion, 1.0 / f64::from(RATE))?;
    let heard: Vec<f64> = samples.map(|sample| sample.accelerations[0]).collect();
    let loudest = heard
        .iter()
        .fold(0.0, |loudest: f64, a| loudest.max(a.abs()));
    let samples = heard.iter().map(|a| (0.8 * 32767.0 * a / loudest) as i16);
    let file = wav(&samples.collect::<Vec<_>>());

    let groan = orbit::settle(&brake, &State::at_rest(1), 1.0, Period::Free(0.005))?;
    let pitch = 1.0 / groan.period();
    println!(
        "{pitch:.2} Hz, {:.0} m/s² at most",
        groan.peak_acceleration(0)
    );
    let harmonics = groan.acceleration_harmonics(0, 6);
    for (k, amplitude) in (1..).zip(&harmonics) {
        let level = 20.0 * (amplitude.norm() / harmonics[0].norm()).log10();
        println!("  {:8.2} Hz  {level:6.1} dB", pitch * f64::from(k));
    }
    match std::env::args().nth(1) {
        Some(name) => std::fs::write(&name, &file).map(|()| println!("{name} is written"))?,
        None => println!("to write a WAV file of {} bytes, give its name", file.len()),
    }
    Ok(())
}
