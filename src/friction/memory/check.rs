use super::sliding::{Derivatives, Input, derivatives};
use super::{ContactLaw, Motion, Slip, Variables};
use crate::error::Error;
use crate::friction::check::{JUMP, STATIC_ROUNDING, check_opposing};

/// The trait that a law with this number of memory variables implements: without memory it is
/// `FrictionLaw`.
const fn of_law(memory: usize) -> &'static str {
    if memory == 0 {
        "FrictionLaw"
    } else {
        "ContactLaw"
    }
}

/// The values by which the rules are checked, all with a memory of zeros.
struct LawValues<'l> {
    kind: &'static str,
    limit: Option<f64>,
    coefficient: &'l dyn Fn(Slip<f64>) -> f64,
    derivatives: &'l dyn Fn(Slip<f64>) -> Derivatives,
    rates_in_stick: &'l [f64],
    breakpoints: &'l mut dyn Iterator<Item = f64>,
}

/// Checks the rules of [`ContactLaw`] on which a structure relies, under a load N, with a memory
/// of zeros and in both directions of slip: μ_s is finite and not below the coefficient at speed 0,
/// friction opposes slip there, rates are finite, the breakpoints ascend, and the law is
/// continuous.
pub(crate) fn validate<L: ContactLaw>(law: &L, load: f64) -> Result<(), Error> {
    let fresh = L::Memory::<f64>::from_fn(|_| 0.0);
    let rates_in_stick = law.rates(Motion::Stick, load, fresh);
    let values = LawValues {
        kind: of_law(L::Memory::<f64>::COUNT),
        limit: law.limit(0.0, fresh),
        coefficient: &|slip| law.coefficient(slip, fresh),
        derivatives: &|slip| derivatives(law, (slip, load), fresh.as_ref(), Input::Speed),
        rates_in_stick: rates_in_stick.as_ref(),
        breakpoints: &mut law.breakpoints(),
    };
    values.check()
}

impl LawValues<'_> {
    fn check(self) -> Result<(), Error> {
        if let Some(limit) = self.limit {
            let allowed = "static_coefficient ≥ 0";
            Error::check(
                self.kind,
                "static_coefficient",
                limit,
                limit >= 0.0,
                allowed,
            )?;
        }
        let mut at_rest = [0.0; 2];
        for (at_rest, direction) in std::iter::zip(&mut at_rest, DIRECTIONS) {
            let slip = Slip {
                speed: 0.0,
                direction,
                piece: 0,
            };
            let Derivatives { coefficient, rates } = (self.derivatives)(slip);
            let [value, slope] = coefficient;
            Error::check_friction(slip.speed, value, slope)?;
            let kinetic_coefficient = direction * value;
            if let Some(static_coefficient) = self
                .limit
                .filter(|limit| kinetic_coefficient > limit * (1.0 + STATIC_ROUNDING))
            {
                return Err(Error::StaticBelowKinetic {
                    static_coefficient,
                    kinetic_coefficient,
                });
            }
            *at_rest = value;
            for [rate, _] in rates {
                self.check_rate(rate)?;
            }
        }
        for &rate in self.rates_in_stick {
            self.check_rate(rate)?;
        }
        let [forward, backward] = at_rest;
        let (is_allowed, allowed) = if self.limit.is_some() {
            (forward * backward <= 0.0, OPPOSED)
        } else {
            let jump = (forward - backward).abs();
            (jump <= JUMP * forward.abs().max(backward.abs()), CONTINUOUS)
        };
        Error::check(
            self.kind,
            "coefficient backward at speed 0",
            backward,
            is_allowed,
            allowed,
        )?;
        if self.limit.is_some() {
            check_opposing(self.kind, forward)?;
        }
        let mut last = 0.0;
        for (index, value) in self.breakpoints.enumerate() {
            let continuous = DIRECTIONS.iter().all(|&direction| {
                let [below, above] = [index, index + 1].map(|piece| {
                    let slip = Slip {
                        speed: value,
                        direction,
                        piece,
                    };
                    (self.coefficient)(slip)
                });
                let scale = self.limit.unwrap_or(0.0).max(below.abs());
                (below - above).abs() <= JUMP * scale
            });
            if !(value.is_finite() && value > last && continuous) {
                return Err(Error::BadBreakpoints { index, value });
            }
            last = value;
        }
        Ok(())
    }

    fn check_rate(&self, rate: f64) -> Result<(), Error> {
        let allowed = "rates of the memory at speed 0 and in stick";
        Error::check(self.kind, "rate", rate, true, allowed).map(drop)
    }
}

const DIRECTIONS: [f64; 2] = [1.0, -1.0];

const OPPOSED: &str = "friction that opposes slip in both directions, positive forward and \
    negative backward; use the sign of `slip.direction`";

const CONTINUOUS: &str = "the same as forward: a law that never sticks is continuous at speed 0";
