//! Drill string and bit: two inertias on a shaft, with friction at the lower inertia.

/// A driven upper inertia, a shaft, and a lower inertia with friction: a drill string with its bit.
///
/// ```text
/// J_u φ_u'' + b_u φ_u' + k(φ_u − φ_l) = const
/// J_l φ_l'' − k(φ_u − φ_l) + T(φ_l') = 0,       d = dT/dω at the steady speed
/// ```
///
/// φ_u and φ_l are the angles of rotation and J_u and J_l the moments of inertia of the upper and
/// the lower inertia. k is the stiffness of the shaft, b_u the damping of the drive, and T the
/// friction torque at the angular velocity ω = φ_l'. Any consistent units may be used: with kg·m²,
/// N·m and N·m·s, angular velocities are in rad/s.
///
/// ```
/// use stick_slip::analysis::drill_string::TwoInertias;
///
/// // kg·m², N·m per radian, N·m·s
/// let string = TwoInertias { upper: 2000.0, lower: 400.0, stiffness: 500.0, damping: 300.0 };
/// let critical = string.critical_slope().unwrap();
/// assert!((critical + 11.829054972953).abs() < 1e-11);
/// assert!(string.is_stable(0.999 * critical) && !string.is_stable(1.001 * critical));
/// assert!(string.is_stable(0.0)); // friction that does not fall
/// // The drive damps most with b_u = J_u ω, where ω = √(k/J_l).
/// assert_eq!(string.best_damper(), 2000.0 * (500.0_f64 / 400.0).sqrt());
/// let best = TwoInertias { damping: string.best_damper(), ..string };
/// assert!(best.critical_slope().unwrap() < critical); // friction may fall more steeply
/// ```
///
/// Source: Routh-Hurwitz conditions of the system above.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TwoInertias {
    /// Upper moment of inertia J_u > 0, in kg·m² for example.
    pub upper: f64,
    /// Lower moment of inertia J_l > 0, in kg·m² for example.
    pub lower: f64,
    /// Stiffness k > 0 of the shaft, in N·m per radian for example.
    pub stiffness: f64,
    /// Damping b_u > 0 of the drive, in N·m·s for example.
    pub damping: f64,
}

impl TwoInertias {
    /// Returns true if steady rotation is stable. Exact.
    ///
    /// The argument is the slope d = dT/dω of the friction torque at the angular velocity ω of this
    /// rotation. The conditions are
    ///
    /// ```text
    /// J_u b_u d² + (J_u²k + J_l b_u²) d + J_l² b_u k > 0,   b_u + d > 0,   J_u d + J_l b_u > 0
    /// ```
    ///
    /// The eigenvalue 0, a rotation of the whole string by a constant angle, is not counted.
    pub fn is_stable(&self, slope: f64) -> bool {
        let [unit, ratio, damping] = self.in_units();
        let slope = slope / unit;
        let middle = 1.0 + damping * (ratio * damping + slope);
        middle * slope + ratio * ratio * damping > 0.0
            && damping + slope > 0.0
            && slope + ratio * damping > 0.0
    }

    /// Critical slope d < 0 of the friction torque, in the unit of b_u: steady rotation is stable
    /// for slopes above this value. Exact. `None` unless all parameters are positive.
    pub fn critical_slope(&self) -> Option<f64> {
        let parameters = [self.upper, self.lower, self.stiffness, self.damping];
        if !parameters.iter().all(|&x| x > 0.0) {
            return None;
        }
        let [unit, ratio, damping] = self.in_units();
        // The root closest to 0; NaN if there is none.
        let part = 2.0 * ratio * damping / (1.0 + ratio * damping * damping);
        let root = -ratio * part / (1.0 + ((1.0 - part) * (1.0 + part)).sqrt());
        let critical = unit * root.max(-damping).max(-ratio * damping);
        critical.is_finite().then_some(critical)
    }

    /// The damping b_u ≈ J_u√(k/J_l) of the drive with which the
    /// [`critical_slope`](Self::critical_slope) is steepest. The term with d² in
    /// [`is_stable`](Self::is_stable) is neglected. NaN unless J_u, J_l and k are positive.
    pub fn best_damper(&self) -> f64 {
        let parameters = [self.upper, self.lower, self.stiffness];
        if !parameters.iter().all(|&x| x > 0.0) {
            return f64::NAN;
        }
        self.upper * (self.stiffness / self.lower).sqrt()
    }

    /// √(J_u k) as a unit of slopes, in which no product overflows; J_l/J_u; and b_u in this unit.
    fn in_units(&self) -> [f64; 3] {
        let unit = self.upper.sqrt() * self.stiffness.sqrt();
        [unit, self.lower / self.upper, self.damping / unit]
    }
}
