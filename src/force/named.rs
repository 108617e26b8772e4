use std::fmt;
#[cfg(feature = "serde")]
use std::sync::Arc;

use super::object::{ForceObject, OneDirection};
use super::{Backlash, Pendulum, PolynomialSpring, SnapThrough, TabulatedForce, VanDerPol};

/// Defines `NamedForce` with a variant for each law.
macro_rules! named {
    ($($law:ident)*) => {
        /// A law of the crate, for serialization and comparison of force elements.
        #[derive(Clone, PartialEq)]
        #[cfg_attr(
            feature = "serde",
            derive(serde::Serialize, serde::Deserialize),
            serde(rename_all = "snake_case")
        )]
        pub(crate) enum NamedForce {
            $($law($law),)*
        }

        impl NamedForce {
            /// The law of an element; `None` for a user's own.
            pub(crate) fn of(law: &dyn ForceObject) -> Option<Self> {
                let law = law.any();
                $(if let Some(OneDirection(law)) = law.downcast_ref() {
                    return Some(Self::$law(Clone::clone(law)));
                })*
                None
            }

            /// The law of an element.
            #[cfg(feature = "serde")]
            pub(crate) fn object(self) -> Arc<dyn ForceObject + Send + Sync> {
                match self {
                    $(Self::$law(law) => Arc::new(OneDirection(law)),)*
                }
            }
        }

        impl fmt::Debug for dyn ForceObject + '_ {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                match NamedForce::of(self) {
                    $(Some(NamedForce::$law(law)) => law.fmt(f),)*
                    None => f.write_str("a user's law"),
                }
            }
        }
    };
}

named!(Backlash Pendulum PolynomialSpring SnapThrough TabulatedForce VanDerPol);
