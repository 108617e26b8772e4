use crate::error::Error;

/// Most intervals of [`Iwan4::elements`].
const MOST_INTERVALS: usize = 100_000;

/// Segalman's four-parameter Iwan model of a bolted joint: many elements in parallel, each a spring
/// in series with a dry slider. φ is the break-free displacement of an element, at which its slider
/// starts to slip. The φ are distributed from 0 up to φ_max.
///
/// ```text
/// ρ(φ) = R φ^χ on 0 < φ < φ_max, and S δ(φ − φ_max)        T(x) = ∫ ρ(φ) clip(x − z_φ, ±φ) dφ
/// β = S(χ+1)/(R φ_max^{χ+1}),     φ_max = F_S(1+β)/(K_T(β + (χ+1)/(χ+2)))
/// ```
///
/// T is the force of the joint at the displacement x. z_φ is the displacement of the slider of
/// element φ, and clip limits its first argument to the range from −φ to φ. ρ is the density of the
/// distribution, with the factors R and S and Dirac's δ. F_S is the force at which the whole joint
/// slips, and K_T is the stiffness of the joint under small forces. χ is the exponent of ρ, with −1
/// < χ ≤ 0. β ≥ 0 is the ratio of the two parts of ρ. Small cycles of amplitude A dissipate an
/// energy proportional to A^{χ+3}. Any consistent units may be used.
///
/// [`elements`](Self::elements) approximates the model by a few elements, each of them a
/// [`Contact`](crate::Contact) with a tangential stiffness.
/// [`analysis::jenkins::masing`](crate::analysis::jenkins::masing) gives the force along any
/// history of displacements.
///
/// Source: D. J. Segalman, *A four-parameter Iwan model for lap-type joints*, J. Appl. Mech. 72
/// (2005) 752-760.
///
/// ```
/// use stick_slip::Iwan4;
///
/// let joint = Iwan4::new(3.0, 2.0, -0.1, 0.1)?;
/// assert!((joint.largest_break_free() - 2.876146788990826).abs() < 1e-15);
/// assert!((joint.backbone(1.0) - 1.6302111882950872).abs() < 1e-15);
/// assert_eq!(joint.backbone(10.0), 3.0);
/// // Ten times the amplitude dissipates 10^2.9 times the energy.
/// let ratio = joint.dissipation(0.1) / joint.dissipation(0.01);
/// assert!((ratio.log10() - 2.9).abs() < 1e-14);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "super::read::Iwan4")
)]
pub struct Iwan4 {
    slip_force: f64,
    stiffness: f64,
    exponent: f64,
    ratio: f64,
}

impl Iwan4 {
    /// Creates a joint with the slip force F_S, the stiffness K_T, the exponent χ and the ratio β.
    ///
    /// # Errors
    ///
    /// [`Error::InvalidParameter`] unless all are finite, F_S > 0, K_T > 0, −1 < χ ≤ 0 and β ≥ 0;
    /// also if φ_max overflows or underflows.
    pub fn new(slip_force: f64, stiffness: f64, exponent: f64, ratio: f64) -> Result<Self, Error> {
        let check = |name, value: f64, in_range: bool, allowed| {
            Error::check("Iwan4", name, value, in_range, allowed)
        };
        check("slip_force", slip_force, slip_force > 0.0, "slip_force > 0")?;
        check("stiffness", stiffness, stiffness > 0.0, "stiffness > 0")?;
        let in_range = -1.0 < exponent && exponent <= 0.0;
        check("exponent", exponent, in_range, "-1 < exponent ≤ 0")?;
        check("ratio", ratio, ratio >= 0.0, "ratio ≥ 0")?;
        let joint = Self {
            slip_force,
            stiffness,
            exponent,
            ratio,
        };
        let longest = joint.largest_break_free();
        let allowed =
            "a stiffness with which slip_force/stiffness neither overflows nor underflows";
        check("stiffness", stiffness, longest.is_normal(), allowed)?;
        Ok(joint)
    }

    /// Slip force F_S, in units of force.
    pub fn slip_force(&self) -> f64 {
        self.slip_force
    }

    /// Stiffness K_T under small forces, in units of force per displacement.
    pub fn stiffness(&self) -> f64 {
        self.stiffness
    }

    /// Exponent χ of the distribution, dimensionless.
    pub fn exponent(&self) -> f64 {
        self.exponent
    }

    /// Ratio β of the two parts of the distribution, dimensionless.
    pub fn ratio(&self) -> f64 {
        self.ratio
    }

    /// Largest break-free displacement φ_max, in units of displacement. At larger displacements the
    /// whole joint slips.
    pub fn largest_break_free(&self) -> f64 {
        self.slip_force / self.stiffness * ((1.0 + self.ratio) / self.scale())
    }

    /// Force F of the first loading from the relaxed joint to a displacement u of either sign, in
    /// units of force. The result is NaN if u is NaN.
    ///
    /// ```text
    /// F(u) = K_T u − R u^{χ+2}/((χ+1)(χ+2)) up to φ_max, and F_S from there on;  F(−u) = −F(u)
    /// ```
    pub fn backbone(&self, displacement: f64) -> f64 {
        let part = displacement.abs() / self.largest_break_free();
        if part >= 1.0 {
            return self.slip_force.copysign(displacement);
        }
        // F/F_S with w = u/φ_max and q = χ + 1, without the difference of near numbers for q → 0:
        // [βw + w(q + 1 − w^q)/(q + 1)]/(β + q/(q + 1)).
        let q = self.exponent + 1.0;
        let slipped = if part == 0.0 {
            -1.0
        } else {
            (q * part.ln()).exp_m1()
        };
        let sum = self.ratio + (q - slipped) / (q + 1.0);
        (self.slip_force * (part * sum / self.scale())).copysign(displacement)
    }

    /// Energy D dissipated in one cycle between the displacements −A and A, with A ≥ 0. D is in
    /// units of force times displacement. The result is NaN if A is negative or NaN, and ∞ if D
    /// overflows.
    ///
    /// ```text
    /// D(A) = 4R A^{χ+3}/((χ+2)(χ+3)) up to φ_max, and D(φ_max) + 4F_S(A − φ_max) from there on
    /// ```
    pub fn dissipation(&self, amplitude: f64) -> f64 {
        if amplitude.is_nan() || amplitude < 0.0 {
            return f64::NAN;
        }
        let longest = self.largest_break_free();
        let part = (amplitude / longest).min(1.0);
        let q = self.exponent + 1.0;
        // At most 1, so that no product overflows before the energy does.
        let factor = 2.0 * q / ((q + 1.0) * (q + 2.0) * self.scale());
        let partial = 2.0 * (self.slip_force * (factor * part.powf(q + 2.0)) * longest);
        partial + 4.0 * (self.slip_force * (amplitude - longest).max(0.0))
    }

    /// Elements that approximate the joint: springs with sliders, as pairs of a stiffness k_i and a
    /// limit force limit_i. There is one element for each of n intervals between 0 and φ_max, and
    /// one for the sliders at φ_max if β > 0. Interval i lies between e_{i−1} and e_i:
    ///
    /// ```text
    /// e_n = φ_max,   e_{i−1} = grid·e_i for i > 1,   e_0 = 0
    /// k_i = ∫ ρ dφ,   limit_i = ∫ φ ρ dφ    over e_{i−1} … e_i
    /// ```
    ///
    /// The sum of the stiffnesses is K_T, and the sum of the limits is F_S, to rounding. At the
    /// first loading, the force of these elements over the displacement is a polygon of tangents to
    /// the [`backbone`](Self::backbone) F of the model. The polygon touches F at all e_i, and is
    /// never below F.
    ///
    /// Compare the energy that the elements dissipate in a cycle with the energy D of the model. At
    /// the amplitudes e_i the elements dissipate more; the ratio of the two energies tends to a
    /// constant as i grows. Between e_{i−1} and e_i the ratio can be below 1; its minimum also
    /// tends to a constant. For χ = −0.1 and a grid of 0.5 the two constants are 1.068 and 0.78.
    /// Cycles with an amplitude below limit_1/k_1 dissipate nothing, so choose n such that e_1 =
    /// grid^{n−1} φ_max is below the smallest amplitude of interest.
    ///
    /// # Errors
    ///
    /// [`Error::InvalidParameter`] unless 0 < grid < 1 and 1 ≤ n ≤ 100 000, or if the first
    /// stiffness or limit underflows.
    ///
    /// ```
    /// use stick_slip::Iwan4;
    ///
    /// let joint = Iwan4::new(3.0, 2.0, -0.1, 0.1)?;
    /// let elements = joint.elements(3, 0.5)?;
    /// assert_eq!(elements.len(), 4);
    /// assert!((elements[0].0 - 0.5221356159077432).abs() < 1e-15);
    /// assert!((elements[0].1 - 0.1778374746841740).abs() < 1e-15);
    /// let stiffness: f64 = elements.iter().map(|element| element.0).sum();
    /// assert!((stiffness - 2.0).abs() < 1e-15);
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    pub fn elements(&self, n: usize, grid: f64) -> Result<Vec<(f64, f64)>, Error> {
        let in_range = (1..=MOST_INTERVALS).contains(&n);
        let allowed = "1 ≤ n ≤ 100 000";
        Error::check("Iwan4::elements", "n", n as f64, in_range, allowed)?;
        let in_range = 0.0 < grid && grid < 1.0;
        Error::check("Iwan4::elements", "grid", grid, in_range, "0 < grid < 1")?;
        let q = self.exponent + 1.0;
        let longest = self.largest_break_free();
        let limits = self.slip_force / self.scale();
        let stiffnesses = limits / longest;
        // w^power, less the same at the lower end of the interval.
        let between = |power: f64, w: f64, first: bool| {
            let part = if first {
                1.0
            } else {
                -(power * grid.ln()).exp_m1()
            };
            w.powf(power) * part
        };
        let interval = |i: usize| {
            let (w, first) = (grid.powf((n - i) as f64), i == 1);
            let limit = limits * (q / (q + 1.0) * between(q + 1.0, w, first));
            (stiffnesses * between(q, w, first), limit)
        };
        let (stiffness, limit) = interval(1);
        let allowed = "a grid with which grid^(n - 1) times the largest break-free displacement \
                       leaves a stiffness and a limit above 0";
        let is_left = stiffness.is_normal() && limit.is_normal();
        Error::check("Iwan4::elements", "grid", grid, is_left, allowed)?;
        let mut elements: Vec<_> = (1..=n).map(interval).collect();
        if self.ratio > 0.0 {
            elements.push((stiffnesses * self.ratio, limits * self.ratio));
        }
        Ok(elements)
    }

    /// β + (χ+1)/(χ+2).
    fn scale(&self) -> f64 {
        self.ratio + (self.exponent + 1.0) / (self.exponent + 2.0)
    }
}
