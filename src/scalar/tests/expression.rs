//! Laws as data.

use num_complex::Complex;

use crate::friction::FrictionLaw;
use crate::scalar::Scalar;

/// An expression in the sliding speed as data, to be evaluated on any number: one law, and so one
/// compiled copy of the operations, serves every test.
#[derive(Debug, Clone, Copy)]
pub(super) struct Expression(&'static Node);

#[derive(Debug)]
enum Node {
    Speed,
    Constant(Expression, f64),
    Neg(Expression),
    Add(Expression, Expression),
    Sub(Expression, Expression),
    Mul(Expression, Expression),
    Div(Expression, Expression),
    AddNumber(Expression, f64),
    SubNumber(Expression, f64),
    MulNumber(Expression, f64),
    DivNumber(Expression, f64),
    Recip(Expression),
    Square(Expression),
    Exp(Expression),
    Ln(Expression),
    Sqrt(Expression),
    Powi(Expression, i32),
    Powf(Expression, f64),
    Tanh(Expression),
    Atan(Expression),
    Asinh(Expression),
    Sin(Expression),
    Cos(Expression),
    Abs(Expression),
    /// The first below a sliding speed, the second from there on.
    Below(f64, Expression, Expression),
    /// One for each piece of a law.
    Pieces(&'static [Expression]),
}

pub(super) const SPEED: Expression = Expression(&Node::Speed);

fn node(node: Node) -> Expression {
    Expression(Box::leak(Box::new(node)))
}

macro_rules! operators {
    ($($trait:ident $method:ident $number:ident)*) => {$(
        impl std::ops::$trait for Expression {
            type Output = Self;
            fn $method(self, other: Self) -> Self {
                node(Node::$trait(self, other))
            }
        }
        impl std::ops::$trait<f64> for Expression {
            type Output = Self;
            fn $method(self, c: f64) -> Self {
                node(Node::$number(self, c))
            }
        }
    )*};
}
operators!(Add add AddNumber  Sub sub SubNumber  Mul mul MulNumber  Div div DivNumber);

impl std::ops::Neg for Expression {
    type Output = Self;
    fn neg(self) -> Self {
        node(Node::Neg(self))
    }
}

macro_rules! functions {
    ($($name:ident $node:ident)*) => {$(
        pub(super) fn $name(self) -> Self {
            node(Node::$node(self))
        }
    )*};
}

impl Expression {
    functions!(recip Recip  square Square  exp Exp  ln Ln  sqrt Sqrt  tanh Tanh  atan Atan);
    functions!(asinh Asinh);
    functions!(sin Sin  cos Cos  abs Abs);
    pub(super) fn constant(self, c: f64) -> Self {
        node(Node::Constant(self, c))
    }
    pub(super) fn powi(self, n: i32) -> Self {
        node(Node::Powi(self, n))
    }
    pub(super) fn powf(self, p: f64) -> Self {
        node(Node::Powf(self, p))
    }
    pub(super) fn below(speed: f64, below: Self, above: Self) -> Self {
        node(Node::Below(speed, below, above))
    }
    pub(super) fn pieces(pieces: Vec<Self>) -> Self {
        node(Node::Pieces(pieces.leak()))
    }
}

/// The value of an expression in one number type; the last entries are what complex numbers write
/// differently.
macro_rules! evaluate {
    (
        $self:ident, $s:ident, $value:ident, $constant:expr, $recip:expr, $square:expr, $abs:expr,
        $is_below:expr
    ) => {
        match *$self.0 {
            Node::Speed => $s,
            Node::Constant(a, c) => $constant(a.$value($s), c),
            Node::Neg(a) => -a.$value($s),
            Node::Add(a, b) => a.$value($s) + b.$value($s),
            Node::Sub(a, b) => a.$value($s) - b.$value($s),
            Node::Mul(a, b) => a.$value($s) * b.$value($s),
            Node::Div(a, b) => a.$value($s) / b.$value($s),
            Node::AddNumber(a, c) => a.$value($s) + c,
            Node::SubNumber(a, c) => a.$value($s) - c,
            Node::MulNumber(a, c) => a.$value($s) * c,
            Node::DivNumber(a, c) => a.$value($s) / c,
            Node::Recip(a) => $recip(a.$value($s)),
            Node::Square(a) => $square(a.$value($s)),
            Node::Exp(a) => a.$value($s).exp(),
            Node::Ln(a) => a.$value($s).ln(),
            Node::Sqrt(a) => a.$value($s).sqrt(),
            Node::Powi(a, n) => a.$value($s).powi(n),
            Node::Powf(a, p) => a.$value($s).powf(p),
            Node::Tanh(a) => a.$value($s).tanh(),
            Node::Atan(a) => a.$value($s).atan(),
            Node::Asinh(a) => a.$value($s).asinh(),
            Node::Sin(a) => a.$value($s).sin(),
            Node::Cos(a) => a.$value($s).cos(),
            Node::Abs(a) => $abs(a.$value($s)),
            Node::Below(c, a, _) if $is_below($s, c) => a.$value($s),
            Node::Below(_, _, b) => b.$value($s),
            Node::Pieces(pieces) => pieces[0].$value($s),
        }
    };
}

impl Expression {
    pub(super) fn complex(self, s: Complex<f64>) -> Complex<f64> {
        let abs = |_| panic!("|s| is not analytic");
        evaluate!(
            self,
            s,
            complex,
            |_, c| Complex::from(c),
            |z: Complex<f64>| z.inv(),
            |z| z * z,
            abs,
            |_, _| panic!("a branch is not analytic")
        )
    }
}

impl FrictionLaw for Expression {
    fn static_coefficient(&self) -> f64 {
        f64::INFINITY
    }
    // Not into the 31 orders of `expand` as well: compiling this function takes long.
    #[inline(never)]
    fn kinetic<S: Scalar>(&self, s: S) -> S {
        evaluate!(
            self,
            s,
            kinetic,
            S::constant,
            S::recip,
            S::square,
            S::abs,
            |s: S, c| s.value() < c
        )
    }
    fn kinetic_on<S: Scalar>(&self, piece: usize, s: S) -> S {
        match self.0 {
            Node::Pieces(pieces) => pieces[piece].kinetic(s),
            _ => self.kinetic(s),
        }
    }
}
