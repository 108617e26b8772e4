use super::{ContactLaw, Motion, Slip};
use crate::error::Error;
use crate::friction::check::{JUMP, STATIC_ROUNDING};
use crate::scalar::{Function, Workspace, expand};

/// The coefficient as a function of the sliding speed, on one piece and with one memory.
#[derive(Debug)]
struct OverSpeed<'l, const Z: usize, L> {
    law: &'l L,
    direction: f64,
    piece: usize,
    memory: [f64; Z],
}

impl<const Z: usize, L> Clone for OverSpeed<'_, Z, L> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<const Z: usize, L> Copy for OverSpeed<'_, Z, L> {}

impl<const Z: usize, L: ContactLaw<Z>> Function for OverSpeed<'_, Z, L> {
    #[inline(always)]
    fn at<S: crate::scalar::Scalar>(self, speed: S) -> S {
        let slip = Slip {
            speed,
            direction: self.direction,
            piece: self.piece,
        };
        let memory = self.memory.map(|number| speed.constant(number));
        self.law.coefficient(slip, memory)
    }
}

/// Which trait a law implements that remembers so many numbers. A law without memory is a
/// `FrictionLaw`.
const fn of_law(memory: usize) -> &'static str {
    if memory == 0 {
        "FrictionLaw"
    } else {
        "ContactLaw"
    }
}

/// The coefficient and its slope over the sliding speed, both with the sign of the direction, on
/// the piece that `slip` names.
pub(crate) fn coefficient_and_slope<const Z: usize, L: ContactLaw<Z>>(
    law: &L,
    slip: Slip<f64>,
    memory: [f64; Z],
) -> Result<[f64; 2], Error> {
    let Slip {
        speed,
        direction,
        piece,
    } = slip;
    let function = OverSpeed {
        law,
        direction,
        piece,
        memory,
    };
    let mut workspace = Workspace::<2>::new();
    let along = |k, _, _| if k == 0 { 1.0 } else { 0.0 };
    let (value, slope) = expand(function, &mut workspace, speed, along);
    Error::check_friction(speed, value, slope)?;
    Ok([value, slope])
}

/// Checks the rules of [`ContactLaw`] on which a structure relies, with a memory of zeros and in
/// both directions of slip: μ_s is finite and not below the coefficient at speed 0, friction
/// opposes slip there, rates are finite, the breakpoints ascend, and the law is continuous.
pub(crate) fn validate<const Z: usize, L: ContactLaw<Z>>(law: &L) -> Result<(), Error> {
    let fresh = [0.0; Z];
    let limit = law.limit(0.0, fresh);
    if let Some(limit) = limit {
        let allowed = "static_coefficient ≥ 0";
        Error::check(
            of_law(Z),
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
        let [value, _] = coefficient_and_slope(law, slip, fresh)?;
        let kinetic_coefficient = direction * value;
        if let Some(static_coefficient) =
            limit.filter(|limit| kinetic_coefficient > limit * (1.0 + STATIC_ROUNDING))
        {
            return Err(Error::StaticBelowKinetic {
                static_coefficient,
                kinetic_coefficient,
            });
        }
        *at_rest = value;
        check_rates(law.rates(Motion::Slip(slip), fresh))?;
    }
    check_rates(law.rates(Motion::Stick, fresh))?;
    let [forward, backward] = at_rest;
    let (is_allowed, allowed) = if limit.is_some() {
        (forward * backward <= 0.0, OPPOSED)
    } else {
        let jump = (forward - backward).abs();
        (jump <= JUMP * forward.abs().max(backward.abs()), CONTINUOUS)
    };
    Error::check(
        of_law(Z),
        "coefficient backward at speed 0",
        backward,
        is_allowed,
        allowed,
    )?;
    let mut last = 0.0;
    for (index, value) in law.breakpoints().enumerate() {
        let continuous = DIRECTIONS.iter().all(|&direction| {
            let [below, above] = [index, index + 1].map(|piece| {
                let slip = Slip {
                    speed: value,
                    direction,
                    piece,
                };
                law.coefficient(slip, fresh)
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

const DIRECTIONS: [f64; 2] = [1.0, -1.0];

const OPPOSED: &str = "friction that opposes slip in both directions, positive forward and \
    negative backward; use the sign of `slip.direction`";

const CONTINUOUS: &str = "the same as forward: a law that never sticks is continuous at speed 0";

fn check_rates<const Z: usize>(rates: [f64; Z]) -> Result<(), Error> {
    for rate in rates {
        let allowed = "rates of the memory at speed 0 and in stick";
        Error::check(of_law(Z), "rate", rate, true, allowed)?;
    }
    Ok(())
}
