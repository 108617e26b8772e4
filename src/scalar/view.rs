//! The operators of a Taylor number that is a view of a row, c_k = scale·row_k for k ≥ 1: those
//! with constants, and negations, change the view alone.

/// Implements `Neg`, `Sub` and the operators with an `f64` for a view.
macro_rules! view_operators {
    ([$($generics:tt)*] $view:ty) => {
        impl<$($generics)*> std::ops::Neg for $view {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                Self {
                    scale: -self.scale,
                    value: -self.value,
                    ..self
                }
            }
        }

        impl<$($generics)*> std::ops::Sub for $view {
            type Output = Self;
            #[inline(always)]
            fn sub(self, other: Self) -> Self {
                self + -other
            }
        }

        impl<$($generics)*> std::ops::Add<f64> for $view {
            type Output = Self;
            #[inline(always)]
            fn add(self, c: f64) -> Self {
                Self {
                    value: self.value + c,
                    ..self
                }
            }
        }

        impl<$($generics)*> std::ops::Sub<f64> for $view {
            type Output = Self;
            #[inline(always)]
            fn sub(self, c: f64) -> Self {
                self + -c
            }
        }

        impl<$($generics)*> std::ops::Mul<f64> for $view {
            type Output = Self;
            #[inline(always)]
            fn mul(self, c: f64) -> Self {
                Self {
                    scale: self.scale * c,
                    value: self.value * c,
                    ..self
                }
            }
        }

        impl<$($generics)*> std::ops::Div<f64> for $view {
            type Output = Self;
            #[inline(always)]
            fn div(self, c: f64) -> Self {
                Self {
                    scale: self.scale / c,
                    value: self.value / c,
                    ..self
                }
            }
        }
    };
}
pub(in crate::scalar) use view_operators;
