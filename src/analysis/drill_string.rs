//! Two inertias on a shaft, friction at the far one: a drill string and its bit.

/// A driven upper inertia, a shaft, and a lower inertia with friction.
///
/// ```text
/// J_u φ_u'' + b_u φ_u' + k(φ_u − φ_l) = const
/// J_l φ_l'' − k(φ_u − φ_l) + T(φ_l') = 0,       d = dT/dω at the steady speed
/// ```
///
/// J_u, J_l moments of inertia, k stiffness of the shaft, b_u damping of the drive. Any consistent
/// units: kg·m², N·m, N·m·s give radians per second.
///
/// ```
/// use stick_slip::analysis::drill_string::TwoInertias;
///
/// // kg·m², N·m per radian, N·m·s
/// let string = TwoInertias { upper: 2000.0, lower: 400.0, stiffness: 500.0, damping: 300.0 };
/// let critical = string.critical_slope().unwrap();
/// assert!((critical + 11.829054972953).abs() < 1e-11);
/// assert!(string.is_stable(0.999 * critical) && !string.is_stable(1.001 * critical));
/// // The impedance of the string: as much as the drive can take up.
/// assert_eq!(string.best_damper(), 2000.0 * (500.0_f64 / 400.0).sqrt());
/// ```
///
/// Source: Routh-Hurwitz conditions of the system above.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TwoInertias {
    /// J_u > 0.
    pub upper: f64,
    /// J_l > 0.
    pub lower: f64,
    /// k > 0.
    pub stiffness: f64,
    /// b_u > 0.
    pub damping: f64,
}

impl TwoInertias {
    /// Whether steady rotation is stable where the torque of friction has the slope d = dT/dω:
    ///
    /// ```text
    /// J_u b_u d² + (J_u²k + J_l b_u²) d + J_l² b_u k > 0,   b_u + d > 0,   J_u d + J_l b_u > 0
    /// ```
    ///
    /// Exact. (The angle of the whole is free, and left out.)
    pub fn is_stable(&self, slope: f64) -> bool {
        let [a, b, c] = self.quadratic();
        (a * slope + b) * slope + c > 0.0
            && self.damping + slope > 0.0
            && self.upper * slope + self.lower * self.damping > 0.0
    }

    /// The slope d < 0 of friction down to which steady rotation is stable. Exact. `None` unless
    /// all parameters are positive.
    pub fn critical_slope(&self) -> Option<f64> {
        let parameters = [self.upper, self.lower, self.stiffness, self.damping];
        if !parameters.iter().all(|&x| x > 0.0) {
            return None;
        }
        let [a, b, c] = self.quadratic();
        // The root next to 0; NaN where there is none.
        let root = -2.0 * c / (b + (b * b - 4.0 * a * c).sqrt());
        let others = [-self.damping, -self.lower * self.damping / self.upper];
        let critical = others.into_iter().fold(root, f64::max);
        critical.is_finite().then_some(critical)
    }

    /// b_u ≈ J_u√(k/J_l), the damper of the drive that allows the steepest fall of friction, to
    /// first order in d.
    pub fn best_damper(&self) -> f64 {
        self.upper * (self.stiffness / self.lower).sqrt()
    }

    fn quadratic(&self) -> [f64; 3] {
        let &Self {
            upper,
            lower,
            stiffness,
            damping,
        } = self;
        [
            upper * damping,
            upper * upper * stiffness + lower * damping * damping,
            lower * lower * damping * stiffness,
        ]
    }
}
