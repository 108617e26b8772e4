//! Laws and systems as they are read, before the checks of their constructors (feature `serde`).

use serde::{Deserialize, Serialize};

use crate::belt::Stability;
use crate::drive::Harmonic;
use crate::error::Error;
use crate::friction::FrictionLaw;

/// A struct of the same name as the type it is read for, and the way from one to the other.
macro_rules! read {
    ($($name:ident { $($(#[$attribute:meta])? $field:ident: $type:ty),* } => $make:expr;)*) => {$(
        #[derive(Deserialize)]
        #[serde(deny_unknown_fields)]
        pub(crate) struct $name {
            $($(#[$attribute])? $field: $type,)*
        }

        impl TryFrom<$name> for crate::$name {
            type Error = Error;
            fn try_from($name { $($field),* }: $name) -> Result<Self, Error> {
                $make
            }
        }
    )*};
}

read! {
    Coulomb { static_coefficient: f64, kinetic_coefficient: f64 }
        => Self::new(static_coefficient, kinetic_coefficient);
    Drive {
        #[serde(default)] constant: f64, #[serde(default)] harmonics: Vec<Harmonic>,
        #[serde(default)] profiles: Vec<Vec<(f64, f64)>>
    } => Self::read(constant, &harmonics, &profiles);
    Exponential { static_coefficient: f64, kinetic_coefficient: f64, stribeck_velocity: f64 }
        => Self::new(static_coefficient, kinetic_coefficient, stribeck_velocity);
    Polynomial { static_coefficient: f64, minimum_coefficient: f64, minimum_velocity: f64 }
        => Self::new(static_coefficient, minimum_coefficient, minimum_velocity);
    Rational { static_coefficient: f64, decay: f64, #[serde(default)] offset: f64, #[serde(default)] quadratic: f64 }
        => Self::new(static_coefficient, decay)?.with_offset(offset)?.with_quadratic(quadratic);
    Stribeck {
        static_coefficient: f64, coulomb_coefficient: f64, stribeck_velocity: f64, exponent: u32,
        #[serde(default)] viscous_coefficient: f64
    } => Self::new(static_coefficient, coulomb_coefficient, stribeck_velocity, exponent)?
        .with_viscous_coefficient(viscous_coefficient);
    Tabulated { #[serde(default)] static_coefficient: Option<f64>, points: Vec<(f64, f64)> } => {
        let law = Self::new(points)?;
        match static_coefficient {
            Some(static_coefficient) => law.with_static_coefficient(static_coefficient),
            None => Ok(law),
        }
    };
    Scaling { physical: crate::Physical, #[serde(default)] length: Option<f64> } => {
        let scaling = Self::new(physical)?;
        match length {
            Some(length) => scaling.with_length(length),
            None => Ok(scaling),
        }
    };
}

/// The numbers that an equilibrium follows from, and its stability for other programs.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Equilibrium {
    displacement: f64,
    /// h1.
    effective_damping: f64,
    stability: Stability,
}

impl From<crate::Equilibrium> for Equilibrium {
    fn from(equilibrium: crate::Equilibrium) -> Self {
        Self {
            displacement: equilibrium.displacement,
            effective_damping: -equilibrium.jacobian[(1, 1)],
            stability: equilibrium.stability,
        }
    }
}

impl TryFrom<Equilibrium> for crate::Equilibrium {
    type Error = Error;
    fn try_from(raw: Equilibrium) -> Result<Self, Error> {
        let h1 = raw.effective_damping;
        Error::check("displacement", raw.displacement, true, "any size")?;
        let read = Self::new(raw.displacement, h1);
        let agrees = read.stability == raw.stability;
        Error::check(
            "effective_damping",
            h1,
            agrees,
            "the sign and size that the stability has",
        )?;
        Ok(read)
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Scaled<L> {
    law: L,
    velocity_unit: f64,
}

impl<L: FrictionLaw> TryFrom<Scaled<L>> for crate::Scaled<L> {
    type Error = Error;
    fn try_from(Scaled { law, velocity_unit }: Scaled<L>) -> Result<Self, Error> {
        Self::new(law, velocity_unit)
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct MassOnBelt<L> {
    law: L,
    belt_velocity: f64,
    #[serde(default)]
    damping: f64,
    #[serde(default = "one")]
    load: f64,
}

fn one() -> f64 {
    1.0
}

impl<L: FrictionLaw> TryFrom<MassOnBelt<L>> for crate::MassOnBelt<L> {
    type Error = Error;
    fn try_from(raw: MassOnBelt<L>) -> Result<Self, Error> {
        Self::new(raw.law, raw.belt_velocity)?
            .with_damping(raw.damping)?
            .with_load(raw.load)
    }
}
