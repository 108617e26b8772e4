//! Errors of a dimensionless system in the units that the user works in.

use super::{Error, Reached};
use crate::state::Units;

impl Reached {
    /// Converts this place to other units.
    fn in_units(mut self, units: Units) -> Self {
        self.time /= units.rate;
        for displacement in &mut self.state.displacements {
            *displacement *= units.length;
        }
        for velocity in &mut self.state.velocities {
            *velocity *= units.velocity();
        }
        self
    }
}

impl Error {
    /// Converts all numbers of this error of a dimensionless system to other units, and takes the
    /// names that parameters have there.
    pub(crate) fn in_units(self, units: Units) -> Self {
        let speed = |speed: f64| speed * units.velocity();
        let reached = |reached: Reached| reached.in_units(units);
        // A search whose parameter has another name is one of `PhysicalMassOnBelt::velocities`.
        let searched = |name: &'static str, value: f64| {
            let parameter = units.parameter(name, value);
            parameter.unwrap_or((name, speed(value)))
        };
        match self {
            Self::InvalidParameter {
                of,
                name,
                value,
                allowed,
            } => {
                let converted = units.parameter(name, value);
                let of = converted.map_or(of, |_| "PhysicalMassOnBelt (SI units)");
                let (name, value) = converted.unwrap_or((name, value));
                Self::InvalidParameter {
                    of,
                    name,
                    value,
                    allowed,
                }
            }
            Self::InvalidState {
                displacement,
                velocity,
            } => Self::InvalidState {
                displacement: displacement * units.length,
                velocity: speed(velocity),
            },
            Self::InvalidDuration { value } => Self::InvalidDuration {
                value: value / units.rate,
            },
            Self::NonFiniteFriction {
                speed: s,
                value,
                reached: at,
            } => Self::NonFiniteFriction {
                speed: speed(s),
                value,
                reached: at.map(reached),
            },
            Self::NotAnalytic {
                speed: s,
                reached: at,
            } => Self::NotAnalytic {
                speed: speed(s),
                reached: at.map(reached),
            },
            Self::BadBreakpoints { index, value } => Self::BadBreakpoints {
                index,
                value: speed(value),
            },
            Self::StepUnderflow { step, reached: at } => Self::StepUnderflow {
                step: step / units.rate,
                reached: reached(at),
            },
            Self::TooManySteps { limit, reached: at } => Self::TooManySteps {
                limit,
                reached: reached(at),
            },
            Self::TooManyEvents { limit, reached: at } => Self::TooManyEvents {
                limit,
                reached: reached(at),
            },
            Self::At {
                parameter,
                value,
                source,
            } => {
                let (parameter, value) = searched(parameter, value);
                source.in_units(units).at(parameter, value)
            }
            Self::Stopped {
                parameter,
                value,
                steps,
                found,
            } => {
                let found = found.into_iter().map(|value| searched(parameter, value).1);
                let found = found.collect();
                let (parameter, value) = searched(parameter, value);
                Self::Stopped {
                    parameter,
                    value,
                    steps,
                    found,
                }
            }
            // Without units, or of a structure, which has its own.
            Self::BadPoint { .. }
            | Self::InvalidTolerance { .. }
            | Self::StaticBelowKinetic { .. }
            | Self::BadElement { .. }
            | Self::NoSuchCoordinate { .. }
            | Self::NoSuchState { .. }
            | Self::WrongSize { .. }
            | Self::CoordinateTaken { .. }
            | Self::NotSymmetric { .. }
            | Self::NotPositiveDefinite { .. }
            | Self::BadDirection { .. }
            | Self::NoSteadySliding(_)
            | Self::NoHopfPoint
            | Self::NotSmooth
            | Self::NoSwitch { .. }
            | Self::NoDerivative { .. }
            | Self::RigidStop { .. }
            | Self::TooManyMechanisms { .. }
            | Self::Jammed { .. }
            | Self::WrongWay { .. }
            | Self::LawNotConstant { .. }
            | Self::NonFiniteForce { .. }
            | Self::NonFiniteLoad { .. }
            | Self::NotAnalyticLoad { .. }
            | Self::NotAnalyticForce { .. }
            | Self::NonFiniteRate { .. }
            | Self::NotAnalyticRate { .. }
            | Self::OverLimit { .. }
            | Self::BeltVelocityJumps { .. }
            | Self::Separation { .. }
            | Self::NoCommonPeriod
            | Self::NotFree
            | Self::AtRest
            | Self::NotPeriodic { .. } => self,
        }
    }
}
