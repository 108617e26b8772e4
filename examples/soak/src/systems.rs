//! The systems of the soak: laws, parameters and starts over many decades.

use stick_slip::{
    AnyLaw, Coulomb, Error, Exponential, FrictionLaw, MassOnBelt, Polynomial, Rational, State,
    Stribeck, Tabulated,
};

/// Splitmix64: the same numbers on every machine and in every run.
struct Random(u64);

impl Random {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform in [low, high).
    fn uniform(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.bits() >> 11) as f64 * 0.5_f64.powi(53)
    }

    /// Uniform in the logarithm.
    fn decades(&mut self, low: f64, high: f64) -> f64 {
        self.uniform(low.ln(), high.ln()).exp()
    }

    fn below(&mut self, n: u64) -> u64 {
        self.bits() % n
    }

    /// A law that falls, and may rise again.
    fn law(&mut self) -> Result<AnyLaw, Error> {
        let top = self.decades(1e-2, 2.0);
        let least = top * self.uniform(0.0, 1.0);
        let width = self.decades(1e-4, 1e2);
        let rise = 1e-2 * self.uniform(0.0, 1.0) * top / width;
        Ok(match self.below(6) {
            0 => Polynomial::new(top, least, width)?.into(),
            1 => Exponential::new(top, least, width)?.into(),
            2 => Coulomb::new(top, least)?.into(),
            3 => Rational::new(top, 1.0 / width)?
                .with_offset(least)?
                .with_quadratic(rise / width)?
                .into(),
            4 => Stribeck::new(top, least, width, 1 + self.below(4) as u32)?
                .with_viscous_coefficient(rise)?
                .into(),
            _ => {
                let middle = (width, 0.7 * least + 0.3 * top);
                let end = (4.0 * width, self.uniform(least, top));
                Tabulated::new([(0.0, top), middle, (2.0 * width, least), end])?
                    .with_static_coefficient(top * self.uniform(1.0, 1.5))?
                    .into()
            }
        })
    }
}

/// System, start and duration of one index.
pub(crate) fn random_motion(i: usize) -> Result<(MassOnBelt<AnyLaw>, State, f64), Error> {
    let mut random = Random((i as u64).wrapping_mul(0xd134_2543_de82_ef95));
    let law = random.law()?;
    let v_b = match random.below(20) {
        0 => 0.0,
        n => random.decades(1e-9, 1e3) * if n % 2 == 0 { 1.0 } else { -1.0 },
    };
    let damping = match random.below(8) {
        0 => 0.0,
        _ => random.decades(1e-6, 10.0),
    };
    let system = MassOnBelt::new(law, v_b)?
        .with_damping(damping)?
        .with_load(random.decades(1e-6, 1e4))?;
    let limits = system.stick_limits();
    let size = v_b.abs() + system.load() * system.law().static_coefficient();
    let start = match random.below(6) {
        // At an end of the stick band or an ulp beside it.
        0 => {
            let limit = limits[random.below(2) as usize];
            let u = [limit.next_down(), limit, limit.next_up()][random.below(3) as usize];
            State::new(u, v_b)
        }
        // As fast as the belt, or an ulp faster or slower.
        1 => {
            let v = [v_b.next_down(), v_b, v_b.next_up()][random.below(3) as usize];
            State::new(random.uniform(-2.0, 2.0) * size, v)
        }
        // Far outside.
        2 => {
            let far = size * random.decades(1.0, 1e3);
            State::new(random.uniform(-far, far), random.uniform(-far, far))
        }
        3 => State::new(0.0, 0.0),
        _ => State::new(random.uniform(-size, size), random.uniform(-1.0, 1.0) * v_b),
    };
    Ok((system, start, random.decades(1.0, 50.0)))
}
