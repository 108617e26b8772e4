//! Reading of force laws (feature `serde`), as of friction laws.

use crate::friction::read::read;

read! {
    Backlash { stiffness: f64, gap: f64 } => Self::new(stiffness, gap);
    Pendulum { moment: f64, length: f64 } => Self::new(moment, length);
    PolynomialSpring { coefficients: Vec<f64> } => Self::new(&coefficients);
    SnapThrough { stiffness: f64, free_length: f64, span: f64 }
        => Self::new(stiffness, free_length, span);
    TabulatedForce {
        points: Vec<(f64, f64)>, #[serde(default)] piecewise_linear: bool
    } => if piecewise_linear { Self::piecewise_linear(&points) } else { Self::new(&points) };
    VanDerPol { negative_damping: f64, nonlinear_damping: f64 }
        => Self::new(negative_damping, nonlinear_damping);
}
