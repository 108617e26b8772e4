//! The power series of a slip phase of one mass on a spring and a damper.

use super::{FrictionLaw, LawVisitor, Piece};
use crate::clock::Time;
use crate::error::Error;
use crate::scalar::{Composed, Workspace, expand, fused, jet};
use crate::series::{INTEGRAL, PowerSeries, TERMS};
use crate::state::Direction;

/// A point of a slip phase.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SlipPoint {
    /// The direction of slip σ, the sign of v_r.
    pub(crate) direction: Direction,
    /// Displacement u.
    pub(crate) displacement: f64,
    /// Sliding speed s = |v_r|.
    pub(crate) speed: f64,
    /// The rate ds/dt in the direction of time in use, if it is known more accurately than from the
    /// equation of motion: at contact, and at an extremum of v.
    pub(crate) rate: Option<f64>,
}

/// The power series of a slip phase about one of its points, in the time since that point.
///
/// The equations of slip, with the direction of slip σ = ±1 and x = σu, are
///
/// ```text
/// x' = s + σv_b,   s' = −x − 2β(s + σv_b) − γ²μ̂(s),
/// ```
///
/// The unknown is the sliding speed s and not v, so that contact is exact however large the belt
/// velocity is.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SlipSeries {
    /// The series of the sliding speed s(t).
    pub(crate) speed: PowerSeries,
    /// The series of μ̂(s(t)), without the last coefficient, which the motion does not need.
    pub(crate) friction: PowerSeries,
    /// The rate D = 2β + γ²dμ̂/ds at the start, at which a deviation of s decays.
    pub(crate) decay: f64,
    /// dμ̂/ds at the start.
    pub(crate) slope: f64,
}

impl SlipSeries {
    pub(crate) const ZERO: Self = Self {
        speed: PowerSeries::ZERO,
        friction: PowerSeries::ZERO,
        decay: 0.0,
        slope: 0.0,
    };
}

/// The series of a slip phase, and the rows in which it is computed.
///
/// Both are in one struct, because the compiler then knows that they do not overlap: see
/// [`fused::compute`]. Otherwise it would reload its registers after every coefficient that is
/// stored.
#[derive(Debug, Clone)]
pub(crate) struct Expander {
    pub(crate) series: SlipSeries,
    /// Number of series that the last step took: one, or more on a slow manifold.
    pub(crate) passes: usize,
    workspace: Workspace<TERMS>,
}

impl Expander {
    pub(crate) fn new() -> Self {
        Self {
            series: SlipSeries::ZERO,
            passes: 0,
            workspace: Workspace::new(),
        }
    }

    /// An [`Expansion`] for one law, not a choice of several.
    ///
    /// Three choices are made for speed. The law is an argument of its own: as a part of
    /// `Equation`, the compiler would have to load the law's parameters anew after every
    /// coefficient that is stored. So are the others: gathered in one struct they cost 4 %. The
    /// series is written in place: a copy would wait for values that have just been stored.
    fn expand_one<L: FrictionLaw>(
        &mut self,
        piece: Piece<'_, L>,
        equation: &Equation,
        from: &SlipPoint,
        time: Time,
        known: Known<'_>,
    ) -> Result<(), Error> {
        let Piece { law, index } = piece;
        let mut work = (self, index, equation, from, time, known);
        fused::compute(
            law,
            &mut work,
            #[inline(always)]
            |law, (expander, index, equation, from, time, known)| {
                let piece = Piece { law, index: *index };
                expander.expand_by::<_, true>(piece, equation, from, *time, *known)
            },
            |law, (expander, index, equation, from, time, known)| {
                let piece = Piece { law, index: *index };
                expander.expand_by::<_, false>(piece, equation, from, *time, *known)
            },
        )
    }

    /// Expands the law, with code that is unrolled for every order, or by jets.
    #[inline(always)]
    fn expand_by<L: FrictionLaw, const UNROLLED: bool>(
        &mut self,
        piece: Piece<'_, L>,
        equation: &Equation,
        from: &SlipPoint,
        time: Time,
        known: Known<'_>,
    ) -> Result<(), Error> {
        let mul_add = fused::mul_add_in::<UNROLLED>;
        let sigma = from.direction.sign();
        let &Equation {
            stiffness,
            damping,
            load,
            belt,
            pull,
            drift,
        } = equation;
        let Self {
            series, workspace, ..
        } = self;
        let SlipSeries {
            speed: series,
            friction,
            decay: stored_decay,
            slope: stored_slope,
        } = series;

        let along = match known {
            Known::Speed(along) => Some(along),
            Known::Nothing | Known::Force(_) | Known::Push(_) => None,
        };
        let s0 = along.map_or(from.speed, |along| along[0]);
        // (k + 1) s_{k+1} = −x_k − 2β s_k − γ² m_k, where x_k = s_{k−1}/k and
        // m_k = slope·s_k + scale·rest. The rest is put in last, because it is ready last: s_{k−1}
        // has to pass through the law first, which takes longer than computing s_k.
        let (mut decay, mut older) = (0.0, 0.0);
        // A closure may have the attribute as an argument only. Not inlined, it would call software
        // for each multiply-add.
        let next = std::convert::identity(
            #[inline(always)]
            |k: usize, s: f64, m: Composed| {
                series[k] = s;
                let weight = -INTEGRAL[k];
                if k == 0 {
                    decay = mul_add(load, m.slope, damping);
                    friction[0] = m.rest;
                    older = s + belt;
                    if let Some(along) = along {
                        return along[1];
                    }
                    let spring = stiffness * (sigma * from.displacement);
                    let equation = -spring - pull - damping * (s + belt) - load * m.rest;
                    return from.rate.map_or(equation, |rate| time.sign() * rate);
                }
                friction[k] = mul_add(m.slope, s, m.scale * m.rest);
                // x_1 = s_0 + σv_b
                let mut spring = if k == 1 {
                    weight * (stiffness * older + drift)
                } else {
                    weight * INTEGRAL[k - 1] * (stiffness * older)
                };
                match known {
                    Known::Push(push) if !UNROLLED => {
                        spring = mul_add(-weight, push(k, s), spring);
                    }
                    Known::Nothing | Known::Push(_) => {}
                    Known::Force(force) => spring = mul_add(-weight, force[k], spring),
                    Known::Speed(along) => return along[k + 1],
                }
                older = s;
                let next = mul_add(weight * decay, s, spring);
                let next = mul_add(weight * load * m.scale, m.rest, next);
                if k + 1 == TERMS - 1 {
                    series[k + 1] = next;
                }
                next
            },
        );
        let (value, slope) = if UNROLLED {
            expand(piece, workspace, s0, next)
        } else {
            jet::expand(piece, TERMS, s0, next)
        };
        // `Error::check_friction` says the same; called here, it costs 3 % with some laws.
        if !value.is_finite() {
            return Err(Error::NonFiniteFriction {
                speed: s0,
                value,
                reached: None,
            });
        }
        if !slope.is_finite() {
            return Err(Error::NotAnalytic {
                speed: s0,
                reached: None,
            });
        }
        (*stored_decay, *stored_slope) = (decay, slope);
        if time == Time::Backward && along.is_none() {
            // In f(−t) the odd coefficients change their sign.
            for k in (1..TERMS).step_by(2) {
                series[k] = -series[k];
                friction[k] = -friction[k];
            }
        }
        Ok(())
    }
}

/// The constants of the equation of slip of one mass, s' = −κx − p − ρt − d(s + σw) −
/// Nμ̂(s).
pub(crate) struct Equation {
    /// κ; 1 in the units of a mass on a belt.
    pub(crate) stiffness: f64,
    /// d; 2β.
    pub(crate) damping: f64,
    /// N; γ².
    pub(crate) load: f64,
    /// σw; σv_b.
    pub(crate) belt: f64,
    /// p: the pull of neighbours at the start; 0.
    pub(crate) pull: f64,
    /// ρ: how fast that grows, for neighbours that move steadily; 0.
    pub(crate) drift: f64,
}

/// The expansion of the motion about a point, as a visitor of the law.
pub(crate) struct Expansion<'a> {
    pub(crate) expander: &'a mut Expander,
    /// Index of the piece of the law.
    pub(crate) piece: usize,
    pub(crate) equation: &'a Equation,
    pub(crate) from: &'a SlipPoint,
    pub(crate) time: Time,
    pub(crate) known: Known<'a>,
}

/// A series that an expansion is given.
#[derive(Clone, Copy)]
pub(crate) enum Known<'a> {
    Nothing,
    /// The sliding speed, in any unit of time: only the friction is expanded.
    Speed(&'a PowerSeries),
    /// A force, added to s', in the forward direction of time. Its value at the start is in the
    /// equation.
    Force(&'a PowerSeries),
    /// The same for a force that depends on the motion: order k > 0 from order k of s. Code that is
    /// unrolled for every order has no place for such a call in each.
    Push(&'a dyn Fn(usize, f64) -> f64),
}

impl LawVisitor for Expansion<'_> {
    type Output = Result<(), Error>;

    #[inline(always)]
    fn visit<L: FrictionLaw>(self, law: &L) -> Self::Output {
        if let Known::Push(_) = self.known {
            return self.visit_seldom(law);
        }
        let index = self.piece;
        let (equation, from) = (self.equation, self.from);
        self.expander
            .expand_one(Piece { law, index }, equation, from, self.time, self.known)
    }

    #[inline(never)]
    fn visit_seldom<L: FrictionLaw>(self, law: &L) -> Self::Output {
        let index = self.piece;
        let (equation, from) = (self.equation, self.from);
        self.expander.expand_by::<_, false>(
            Piece { law, index },
            equation,
            from,
            self.time,
            self.known,
        )
    }
}

#[cfg(test)]
mod tests;
