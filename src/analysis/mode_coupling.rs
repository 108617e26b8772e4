//! Flutter by mode coupling: friction makes the stiffness matrix unsymmetric, and two modes merge
//! into one.

use crate::numerics::power_of_two;

/// Two coupled coordinates: the first slides under a normal load that depends on the second.
///
/// ```text
/// M q'' + C q' + K(μ) q = const,   K(μ) = [[k11, k12 − μk3], [k21, k22]],   C = diag(c1, c2)
/// ```
///
/// q = (q1, q2) are the coordinates, and M = diag(m1, m2) contains the masses. μ is the friction
/// coefficient, which does not depend on speed; k3 is the stiffness of the normal spring. Any
/// consistent units may be used.
///
/// ```
/// use stick_slip::analysis::mode_coupling::ModeCoupling;
///
/// let model = ModeCoupling {
///     masses: [1.0, 1.0],
///     stiffness: [[2.0, 1.0], [1.0, 2.0]],
///     normal_stiffness: 4.0 / 3.0,
///     damping: [0.0, 0.0],
/// };
/// let flutter = model.flutter().unwrap();
/// assert_eq!(flutter.coefficient, 0.75);
/// assert_eq!(flutter.angular_frequency, 2.0_f64.sqrt());
///
/// // Damping of both coordinates can raise μ_c; damping of one coordinate alone can lower it.
/// let damped = ModeCoupling { damping: [0.1, 0.05], ..model };
/// assert!((damped.flutter().unwrap().coefficient - 0.7575).abs() < 1e-15);
/// ```
///
/// Source: N. Hoffmann, M. Fischer, R. Allgaier, L. Gaul, *A minimal model for studying properties
/// of the mode-coupling type instability in friction induced oscillations*, Mech. Res. Commun. 29
/// (2002) 197-205; with damping N. Hoffmann, L. Gaul, *Effects of damping on mode-coupling
/// instability in friction induced oscillations*, Z. Angew. Math. Mech. 83 (2003) 524-534.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModeCoupling {
    /// Masses m1, m2 > 0.
    pub masses: [f64; 2],
    /// Stiffness matrix [[k11, k12], [k21, k22]] without friction.
    pub stiffness: [[f64; 2]; 2],
    /// Stiffness k3 of the normal spring: the increase of the load on the first coordinate per unit
    /// displacement of the second. To build the same model as a [`Structure`](crate::Structure),
    /// add a contact of coordinate 0 on a belt that moves forward, and give it the load gradient k3
    /// for coordinate 1.
    pub normal_stiffness: f64,
    /// Damping constants c1, c2 ≥ 0.
    pub damping: [f64; 2],
}

/// The point at which steady sliding begins to flutter.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Flutter {
    /// Friction coefficient μ_c, dimensionless: steady sliding flutters for μ above it.
    pub coefficient: f64,
    /// Angular frequency of the mode that neither grows nor decays at μ_c, in radians per unit of
    /// time.
    pub angular_frequency: f64,
}

impl ModeCoupling {
    /// The flutter point: the least μ ≥ 0 above which steady sliding flutters, and the frequency of
    /// this flutter. Exact.
    ///
    /// ```text
    /// undamped:  μ_c = [k12 + (k11 − k22)²/(4k21)]/k3                          (m1 = m2 = 1)
    /// damped:    μ_c = [k12 − (k11k22 − a1(a3a2 − a1)/a3²)/k21]/k3
    ///            a3 = c1 + c2,  a2 = k11 + k22 + c1c2,  a1 = c1k22 + c2k11
    /// ```
    ///
    /// Both formulas are for m1 = m2 = 1; for other masses divide each row of K and C by its mass
    /// first. Damping of one coordinate alone can lower μ_c. As c1, c2 → 0, μ_c in general does not
    /// tend to its undamped value.
    ///
    /// `None` unless m1, m2, k11 and k22 are positive, c1 and c2 are not negative, k21k3 > 0
    /// (otherwise the modes do not merge as μ grows), and μ_c ≥ 0.
    pub fn flutter(&self) -> Option<Flutter> {
        let [m1, m2] = self.masses;
        let [[k11, k12], [k21, k22]] = self.stiffness;
        let [k11, k12, k3] = [k11, k12, self.normal_stiffness].map(|k| k / m1);
        let [k21, k22] = [k21, k22].map(|k| k / m2);
        let [c1, c2] = [self.damping[0] / m1, self.damping[1] / m2];
        let merges = (k21 > 0.0 && k3 > 0.0) || (k21 < 0.0 && k3 < 0.0);
        let in_range = merges
            && [m1, m2, k11, k22].iter().all(|&x| x > 0.0)
            && [c1, c2].iter().all(|&c| c >= 0.0);
        if !in_range {
            return None;
        }
        // In a unit of frequencies in which no product overflows; a power of two, which causes no
        // rounding.
        let unit = power_of_two(k11.max(k22).sqrt());
        let [k11, k12, k21, k22, k3] = [k11, k12, k21, k22, k3].map(|k| k / unit / unit);
        let [c1, c2] = [c1 / unit, c2 / unit];
        let a3 = c1 + c2;
        let (coefficient, square) = if a3 == 0.0 {
            let apart = k11 - k22;
            let coefficient = (k12 + apart * apart / (4.0 * k21)) / k3;
            (coefficient, 0.5 * (k11 + k22))
        } else {
            // Roots on the imaginary axis have a3 s³ + a1 s = 0, so ω² = a1/a3; a0 is the
            // determinant at the flutter point.
            let (a2, a1) = (k11 + k22 + c1 * c2, c1 * k22 + c2 * k11);
            let square = a1 / a3;
            let determinant = square * (a2 - square);
            ((k12 - (k11 * k22 - determinant) / k21) / k3, square)
        };
        let valid = coefficient >= 0.0 && coefficient.is_finite();
        valid.then(|| Flutter {
            coefficient,
            angular_frequency: unit * square.sqrt(),
        })
    }
}
