use super::{ContactLaw, Slip};
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

/// Checks the rules of [`ContactLaw`] on which a structure relies, with a memory of zeros: μ_s is
/// finite and not below the coefficient at speed 0, the breakpoints ascend, and the law is
/// continuous.
pub(crate) fn validate<const Z: usize, L: ContactLaw<Z>>(law: &L) -> Result<(), Error> {
    let fresh = [0.0; Z];
    let slip = |piece, speed| Slip {
        speed,
        direction: 1.0,
        piece,
    };
    let limit = law.limit(0.0, fresh);
    if let Some(limit) = limit {
        let allowed = "static_coefficient ≥ 0";
        Error::check("static_coefficient", limit, limit >= 0.0, allowed)?;
    }
    let [kinetic_coefficient, _] = coefficient_and_slope(law, slip(0, 0.0), fresh)?;
    if let Some(static_coefficient) =
        limit.filter(|limit| kinetic_coefficient > limit * (1.0 + STATIC_ROUNDING))
    {
        return Err(Error::StaticBelowKinetic {
            static_coefficient,
            kinetic_coefficient,
        });
    }
    let mut last = 0.0;
    for (index, value) in law.breakpoints().enumerate() {
        let [below, above] =
            [index, index + 1].map(|piece| law.coefficient(slip(piece, value), fresh));
        let scale = limit.unwrap_or(0.0).max(below.abs());
        let continuous = (below - above).abs() <= JUMP * scale;
        if !(value.is_finite() && value > last && continuous) {
            return Err(Error::BadBreakpoints { index, value });
        }
        last = value;
    }
    Ok(())
}
