//! Friction laws of the tests' own.

use std::cell::Cell;

use stick_slip::{Coulomb, FrictionLaw, Scalar};

/// Declares a friction law by its static coefficient, its kinetic one at a sliding speed, and its
/// breakpoints if it names any; all may use its numbers.
#[macro_export]
macro_rules! friction_law {
    ($(#[$about:meta])* $visible:vis $name:ident { $($number:ident),* }: $($law:tt)*) => {
        $(#[$about])*
        #[derive(Debug, Clone, Copy, PartialEq)]
        $visible struct $name { $($visible $number: f64),* }
        $crate::friction_law!(@ $name [$($number),*] $($law)*);
    };
    ($(#[$about:meta])* $visible:vis $name:ident: $($law:tt)*) => {
        $(#[$about])*
        #[derive(Debug, Clone, Copy, PartialEq)]
        $visible struct $name;
        $crate::friction_law!(@ $name [] $($law)*);
    };
    (@ $name:ident $numbers:tt $static:expr,
        |$speed:ident| $kinetic:expr $(, at $breakpoints:expr)?) => {
        #[allow(unused_variables)]
        impl stick_slip::FrictionLaw for $name {
            fn static_coefficient(&self) -> f64 {
                $crate::friction_law!(% self $numbers);
                $static
            }
            fn kinetic<S: stick_slip::Scalar>(&self, $speed: S) -> S {
                $crate::friction_law!(% self $numbers);
                $kinetic
            }
            $(fn breakpoints(&self) -> impl Iterator<Item = f64> {
                $crate::friction_law!(% self $numbers);
                $breakpoints.into_iter()
            })?
        }
    };
    (% $law:ident [$($number:ident),*]) => { let Self { $($number),* } = *$law; };
}

/// Functions of a contact law with so many memory variables: they stay when the contact sticks, and
/// no speed is a breakpoint.
#[macro_export]
macro_rules! memory_stays {
    ($count:literal) => {
        fn breakpoints(&self) -> impl Iterator<Item = f64> {
            std::iter::empty()
        }
        fn caught(&self, memory: [f64; $count]) -> [f64; $count] {
            memory
        }
    };
}

/// μ_s = μ̂(0).
pub fn even(coefficient: f64) -> Coulomb {
    Coulomb::new(coefficient, coefficient).unwrap()
}

friction_law! {
    /// Leine et al., Nonlinear Dynamics 16 (1998) 41-54: μ̂(s) = μ_s/(1 + δ s).
    pub Leine { static_coefficient, decay }: static_coefficient,
    |s| (s * decay + 1.0).recip() * static_coefficient
}

friction_law! {
    /// μ̂(s) = μ_k + (μ_s − μ_k) exp(−s/v_s), an exponential of s and not of s².
    pub Decay { static_coefficient, kinetic_coefficient, velocity }: static_coefficient,
    |s| (s / -velocity).exp() * (static_coefficient - kinetic_coefficient) + kinetic_coefficient
}

friction_law! {
    /// μ̂ = √(0.8 − s): ends at s = 0.8 with a vertical tangent.
    pub Ends: 1.0,
    |s| (-s + 0.8).sqrt()
}

friction_law! {
    /// μ̂(s) = μ_s − d s/(1 + s) + a (cos ks − 1): falls, and waves.
    pub Wave { static_coefficient, fall, height, number }: static_coefficient,
    |s| ((s * number).cos() - 1.0) * height - s / (s + 1.0) * fall + static_coefficient
}

/// A table of (speed, coefficient), joined by straight lines and continued by the last of them. It
/// starts at speed 0.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    pub static_coefficient: f64,
    pub points: Vec<(f64, f64)>,
}

impl Table {
    /// Coefficient at the start of a piece, speed there, and slope.
    pub fn line(&self, piece: usize) -> (f64, f64, f64) {
        let ((s0, c0), (s1, c1)) = (self.points[piece], self.points[piece + 1]);
        (c0, s0, (c1 - c0) / (s1 - s0))
    }

    /// The piece that holds a speed.
    pub fn piece(&self, speed: f64) -> usize {
        self.breakpoints().take_while(|&b| b <= speed).count()
    }
}

impl FrictionLaw for Table {
    fn static_coefficient(&self) -> f64 {
        self.static_coefficient
    }
    fn kinetic<S: Scalar>(&self, speed: S) -> S {
        self.kinetic_on(self.piece(speed.value()), speed)
    }
    fn breakpoints(&self) -> impl Iterator<Item = f64> {
        let inner = 1..self.points.len() - 1;
        self.points[inner].iter().map(|point| point.0)
    }
    fn kinetic_on<S: Scalar>(&self, piece: usize, speed: S) -> S {
        let (c0, s0, slope) = self.line(piece);
        (speed - s0) * slope + c0
    }
}

/// A law whose static coefficient is NaN from some call on.
pub struct TurnsNan {
    calls: Cell<u32>,
    good: u32,
}

impl TurnsNan {
    /// Right for so many calls.
    pub fn after(good: u32) -> Self {
        let calls = Cell::new(0);
        Self { calls, good }
    }
}

impl FrictionLaw for TurnsNan {
    fn static_coefficient(&self) -> f64 {
        self.calls.set(self.calls.get() + 1);
        if self.calls.get() > self.good {
            f64::NAN
        } else {
            0.4
        }
    }
    fn kinetic<S: Scalar>(&self, speed: S) -> S {
        (speed + 1.0).recip() * 0.4
    }
}

/// A law that counts how often it is asked for a coefficient, and for a breakpoint.
#[derive(Debug, Clone)]
pub struct Counted<'c, L> {
    pub law: L,
    pub asked: &'c [Cell<usize>; 2],
}

impl<L> Counted<'_, L> {
    fn count(&self, what: usize) {
        self.asked[what].set(self.asked[what].get() + 1);
    }
}

impl<L: FrictionLaw> FrictionLaw for Counted<'_, L> {
    fn static_coefficient(&self) -> f64 {
        self.law.static_coefficient()
    }
    fn kinetic<S: Scalar>(&self, speed: S) -> S {
        self.count(0);
        self.law.kinetic(speed)
    }
    fn kinetic_on<S: Scalar>(&self, piece: usize, speed: S) -> S {
        self.count(0);
        self.law.kinetic_on(piece, speed)
    }
    fn breakpoints(&self) -> impl Iterator<Item = f64> {
        self.law.breakpoints().inspect(|_| self.count(1))
    }
}
