//! Random force laws: those of the crate, and the tests' own.

use stick_slip::{
    Backlash, Contact, ForceElement, ForceLaw, Pendulum, PolynomialSpring, Scalar, SnapThrough,
    TabulatedForce, VanDerPol,
};

use crate::Random;

/// Any force law of the crate or of the tests.
#[derive(Debug, Clone, PartialEq)]
pub enum AnyForce {
    Polynomial(PolynomialSpring),
    Pendulum(Pendulum),
    Backlash(Backlash),
    SnapThrough(SnapThrough),
    VanDerPol(VanDerPol),
    Table(TabulatedForce),
    Toda(Toda),
    CubicDamper(CubicDamper),
    Mixed(Mixed),
    Magnet(Magnet),
}

/// F = A (exp(x/l) − 1).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Toda {
    pub force: f64,
    pub length: f64,
}

impl ForceLaw for Toda {
    fn force<S: Scalar>(&self, position: S, _: S, _: usize) -> S {
        ((position / self.length).exp() - 1.0) * self.force
    }
    fn potential<S: Scalar>(&self, position: S, _: usize) -> Option<S> {
        let exponential = ((position / self.length).exp() - 1.0) * self.length;
        Some((exponential - position) * self.force)
    }
}

/// F = c y³.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CubicDamper(pub f64);

impl ForceLaw for CubicDamper {
    fn force<S: Scalar>(&self, _: S, velocity: S, _: usize) -> S {
        velocity.powi(3) * self.0
    }
}

/// F = −A/(g − x)².
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Magnet {
    pub strength: f64,
    pub gap: f64,
}

impl ForceLaw for Magnet {
    fn force<S: Scalar>(&self, position: S, _: S, _: usize) -> S {
        (-position + self.gap).square().recip() * -self.strength
    }
    fn potential<S: Scalar>(&self, position: S, _: usize) -> Option<S> {
        Some((-position + self.gap).recip() * -self.strength)
    }
}

/// F = (1 + x²/l²)(k x + c y): a damper that stiffens with a spring. Its potential is that of the
/// spring.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mixed {
    pub stiffness: f64,
    pub damping: f64,
    pub length: f64,
}

impl ForceLaw for Mixed {
    fn force<S: Scalar>(&self, position: S, velocity: S, _: usize) -> S {
        let linear = position * self.stiffness + velocity * self.damping;
        ((position / self.length).square() + 1.0) * linear
    }
    fn potential<S: Scalar>(&self, position: S, _: usize) -> Option<S> {
        let square = position.square();
        let quartic = square.square() * (0.5 / self.length / self.length);
        Some((square + quartic) * (0.5 * self.stiffness))
    }
}

/// Evaluates one expression with the law of any variant.
macro_rules! for_each {
    ($force:expr, $law:ident => $result:expr) => {
        match $force {
            AnyForce::Polynomial($law) => $result,
            AnyForce::Pendulum($law) => $result,
            AnyForce::Backlash($law) => $result,
            AnyForce::SnapThrough($law) => $result,
            AnyForce::VanDerPol($law) => $result,
            AnyForce::Table($law) => $result,
            AnyForce::Toda($law) => $result,
            AnyForce::CubicDamper($law) => $result,
            AnyForce::Mixed($law) => $result,
            AnyForce::Magnet($law) => $result,
        }
    };
}

impl ForceLaw for AnyForce {
    fn force<S: Scalar>(&self, position: S, velocity: S, piece: usize) -> S {
        for_each!(self, law => law.force(position, velocity, piece))
    }
    fn potential<S: Scalar>(&self, position: S, piece: usize) -> Option<S> {
        for_each!(self, law => law.potential(position, piece))
    }
    fn breakpoints(&self) -> impl Iterator<Item = f64> {
        let all: Vec<f64> = for_each!(self, law => law.breakpoints().collect());
        all.into_iter()
    }
}

impl AnyForce {
    /// An element with the law itself, as a user makes it.
    pub fn element(self, direction: &[(usize, f64)]) -> ForceElement {
        for_each!(self, law => ForceElement::along(direction, law)).unwrap()
    }

    /// A contact with the law itself in its load.
    pub fn press(self, contact: Contact, direction: &[(usize, f64)]) -> Contact {
        for_each!(self, law => contact.with_load_law(direction, law)).unwrap()
    }

    /// The number of the piece at a position.
    pub fn piece(&self, position: f64) -> usize {
        self.breakpoints().filter(|b| *b <= position).count()
    }

    /// F(x, y).
    pub fn at(&self, position: f64, velocity: f64) -> f64 {
        self.force(position, velocity, self.piece(position))
    }

    /// U(x).
    pub fn energy(&self, position: f64) -> Option<f64> {
        self.potential(position, self.piece(position))
    }
}

impl Random {
    /// How many kinds [`any_force`](Self::any_force) knows.
    pub const FORCES: usize = 11;

    /// A force law of one kind, with a slope of up to about k over positions of about l: forces of
    /// springs hold motions near 0, those of dampers alone do not.
    pub fn any_force(&mut self, kind: usize, stiffness: f64, length: f64) -> AnyForce {
        let k = stiffness * self.uniform(0.2, 1.0);
        let l = length * self.uniform(0.5, 1.5);
        match kind {
            // Hardens or softens, and then hardens.
            0 => {
                let linear = self.uniform(-0.5, 1.0) * k;
                let square = self.uniform(-0.5, 0.5) * k / l;
                let cubic = [linear, square, k / (l * l)];
                AnyForce::Polynomial(PolynomialSpring::new(&cubic).unwrap())
            }
            1 => {
                let quintic = [k, 0.0, 0.0, 0.0, self.uniform(0.0, 1.0) * k / l.powi(4)];
                AnyForce::Polynomial(PolynomialSpring::new(&quintic).unwrap())
            }
            2 => AnyForce::Pendulum(Pendulum::new(k * l, l).unwrap()),
            3 => {
                let gap = self.pick(&[0.0, 0.1, 0.3, 0.6]) * l;
                AnyForce::Backlash(Backlash::new(k, gap).unwrap())
            }
            4 => {
                let free = self.uniform(0.0, 1.5) * l;
                AnyForce::SnapThrough(SnapThrough::new(k, free, l).unwrap())
            }
            5 => {
                let damping = self.uniform(0.1, 0.5) * k;
                AnyForce::VanDerPol(VanDerPol::new(damping, k / (l * l)).unwrap())
            }
            6 | 7 => {
                let mut points = vec![(-l, -k * l * self.uniform(0.2, 2.0))];
                while let Some(&(x, force)) = points.last()
                    && x < l
                {
                    let (rise, step) = (self.uniform(0.0, 2.0), self.uniform(0.1, 0.6) * l);
                    points.push((x + step, force + rise * k * step));
                }
                let table = match kind {
                    6 => TabulatedForce::new(&points),
                    _ => TabulatedForce::piecewise_linear(&points),
                };
                AnyForce::Table(table.unwrap())
            }
            8 => AnyForce::Toda(Toda {
                force: k * l,
                length: l,
            }),
            9 => AnyForce::CubicDamper(CubicDamper(k)),
            _ => AnyForce::Mixed(Mixed {
                stiffness: k,
                damping: self.uniform(0.0, 0.3) * k,
                length: l,
            }),
        }
    }
}
