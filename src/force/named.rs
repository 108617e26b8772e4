use std::fmt;
use std::ops::Deref;
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
            pub(crate) fn object(self) -> SharedForce {
                match self {
                    $(Self::$law(law) => SharedForce::new(OneDirection(law)),)*
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

/// A force law without its type, shared with clones. Laws of the crate are equal if their types and
/// numbers are equal, a user's law only to itself.
#[derive(Clone)]
pub(crate) struct SharedForce(Arc<dyn ForceObject + Send + Sync>);

impl SharedForce {
    pub(crate) fn new(law: impl ForceObject + Send + Sync + 'static) -> Self {
        Self(Arc::new(law))
    }

    /// The law, if it is one of the crate.
    pub(crate) fn named(&self) -> Option<NamedForce> {
        NamedForce::of(&*self.0)
    }
}

impl Deref for SharedForce {
    type Target = dyn ForceObject;

    fn deref(&self) -> &Self::Target {
        &*self.0
    }
}

impl PartialEq for SharedForce {
    fn eq(&self, other: &Self) -> bool {
        match [self, other].map(Self::named) {
            [Some(one), Some(other)] => one == other,
            _ => Arc::ptr_eq(&self.0, &other.0),
        }
    }
}

impl fmt::Debug for SharedForce {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        (**self).fmt(f)
    }
}

named!(Backlash Pendulum PolynomialSpring SnapThrough TabulatedForce VanDerPol);
