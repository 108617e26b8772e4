//! Reading of laws (feature `serde`). A law is read from its parameters, under the names under
//! which they are written, and is checked by its constructor. Fields that are not parameters are
//! refused.

/// Defines a struct with the parameters of the law of the same name, and the conversion into the
/// law, which may be generic over other laws. For force laws and systems too.
macro_rules! read {
    ($(
        $name:ident $(<$($law:ident),*>)? { $($(#[$attribute:meta])? $field:ident: $type:ty),* }
            => $make:expr;
    )*) => {$(
        #[derive(serde::Deserialize)]
        #[serde(deny_unknown_fields)]
        pub(super) struct $name $(<$($law),*>)? {
            $($(#[$attribute])? $field: $type,)*
        }

        impl $(<$($law: $crate::friction::FrictionLaw),*>)? TryFrom<$name $(<$($law),*>)?>
            for super::$name $(<$($law),*>)?
        {
            type Error = $crate::error::Error;
            fn try_from(read: $name $(<$($law),*>)?) -> Result<Self, Self::Error> {
                let $name { $($field),* } = read;
                $make
            }
        }
    )*};
}
pub(crate) use read;

read! {
    Coulomb { static_coefficient: f64, kinetic_coefficient: f64 }
        => Self::new(static_coefficient, kinetic_coefficient);
    Exponential { static_coefficient: f64, kinetic_coefficient: f64, stribeck_velocity: f64 }
        => Self::new(static_coefficient, kinetic_coefficient, stribeck_velocity);
    Iwan4 { slip_force: f64, stiffness: f64, exponent: f64, ratio: f64 }
        => Self::new(slip_force, stiffness, exponent, ratio);
    Polynomial { static_coefficient: f64, minimum_coefficient: f64, minimum_velocity: f64 }
        => Self::new(static_coefficient, minimum_coefficient, minimum_velocity);
    Rational {
        static_coefficient: f64, decay: f64,
        #[serde(default)] offset: f64, #[serde(default)] quadratic: f64
    } => Self::new(static_coefficient, decay)?.with_offset(offset)?.with_quadratic(quadratic);
    Stribeck {
        static_coefficient: f64, coulomb_coefficient: f64, stribeck_velocity: f64, exponent: u32,
        #[serde(default)] viscous_coefficient: f64
    } => Self::new(static_coefficient, coulomb_coefficient, stribeck_velocity, exponent)?
        .with_viscous_coefficient(viscous_coefficient);
    Tabulated {
        #[serde(default)] static_coefficient: Option<f64>, points: Vec<(f64, f64)>,
        #[serde(default)] piecewise_linear: bool
    } => {
        let make = if piecewise_linear { Self::piecewise_linear } else { Self::new };
        let law = make(points)?;
        match static_coefficient {
            Some(static_coefficient) => law.with_static_coefficient(static_coefficient),
            None => Ok(law),
        }
    };
    Scaled<L> { law: L, velocity_unit: f64 } => Self::new(law, velocity_unit);
}
