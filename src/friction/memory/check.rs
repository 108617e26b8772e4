use super::sliding::{Derivatives, Input, derivatives};
use super::{ContactLaw, Motion, Slip, Variables};
use crate::error::Error;
use crate::friction::check::{JUMP, STATIC_ROUNDING, check_opposing, check_static};

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
    /// Backward and forward.
    limits: Option<[f64; 2]>,
    coefficient: &'l dyn Fn(Slip<f64>) -> f64,
    derivatives: &'l dyn Fn(Slip<f64>) -> Derivatives,
    rates_in_stick: &'l [f64],
    breakpoints: &'l mut dyn Iterator<Item = f64>,
}

/// Checks the rules of [`ContactLaw`] on which a structure relies, under a load N, with a memory
/// of zeros and in both directions of slip: μ_s is not below the coefficient at speed 0, friction
/// opposes slip there, rates are finite, the breakpoints ascend, and the law is continuous. In one
/// direction μ_s may be infinite: the contact never slips in this direction, and the coefficient
/// does not matter.
pub(crate) fn validate<L: ContactLaw>(law: &L, load: f64) -> Result<(), Error> {
    let fresh = L::Memory::<f64>::from_fn(|_| 0.0);
    let rates_in_stick = law.rates(Motion::Stick, load, fresh);
    let values = LawValues {
        kind: of_law(L::Memory::<f64>::COUNT),
        limits: law.limits(0.0, fresh),
        coefficient: &|slip| law.coefficient(slip, fresh),
        derivatives: &|slip| derivatives(law, (slip, load), fresh.as_ref(), Input::Speed),
        rates_in_stick: rates_in_stick.as_ref(),
        breakpoints: &mut law.breakpoints(),
    };
    values.check()
}

impl LawValues<'_> {
    fn check(self) -> Result<(), Error> {
        if let Some(limits) = self.limits {
            check_limits(self.kind, limits)?;
        }
        let [backward, forward] = self.limits.map_or([None; 2], |limits| limits.map(Some));
        let directions = [(1.0, forward), (-1.0, backward)].into_iter();
        let slips = directions.filter(|(_, limit)| *limit != Some(f64::INFINITY));
        let directions: Vec<(f64, Option<f64>)> = slips.collect();
        let mut at_rest = Vec::new();
        for &(direction, limit) in &directions {
            let slip = Slip {
                speed: 0.0,
                direction,
                piece: 0,
            };
            let Derivatives { coefficient, rates } = (self.derivatives)(slip);
            let [value, slope] = coefficient;
            Error::check_friction(slip.speed, value, slope)?;
            let kinetic_coefficient = direction * value;
            if let Some(static_coefficient) =
                limit.filter(|limit| kinetic_coefficient > limit * (1.0 + STATIC_ROUNDING))
            {
                return Err(Error::StaticBelowKinetic {
                    static_coefficient,
                    kinetic_coefficient,
                });
            }
            at_rest.push(value);
            for [rate, _] in rates {
                self.check_rate(rate)?;
            }
        }
        for &rate in self.rates_in_stick {
            self.check_rate(rate)?;
        }
        if let [forward, backward] = at_rest[..] {
            let (is_allowed, allowed) = if self.limits.is_some() {
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
        }
        if self.limits.is_some() {
            for (&(direction, _), value) in std::iter::zip(&directions, at_rest) {
                check_opposing(self.kind, direction * value)?;
            }
        }
        let mut last = 0.0;
        for (index, value) in self.breakpoints.enumerate() {
            let continuous = directions.iter().all(|&(direction, limit)| {
                let [below, above] = [index, index + 1].map(|piece| {
                    let slip = Slip {
                        speed: value,
                        direction,
                        piece,
                    };
                    (self.coefficient)(slip)
                });
                let scale = limit.unwrap_or(0.0).max(below.abs());
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

/// Checks the static coefficients backward and forward. One of them may be infinite.
pub(crate) fn check_limits(of: &'static str, [backward, forward]: [f64; 2]) -> Result<(), Error> {
    for (limit, other) in [(forward, backward), (backward, forward)] {
        let is_one_way = limit == f64::INFINITY && other.is_finite();
        if !is_one_way {
            check_static(of, limit)?;
        }
    }
    Ok(())
}

const OPPOSED: &str = "friction that opposes slip in both directions, positive forward and \
    negative backward; use the sign of `slip.direction`";

const CONTINUOUS: &str = "the same as forward: a law that never sticks is continuous at speed 0";
