//! The equations of a curve of Hopf points: iω is an eigenvalue of steady sliding.
//!
//! The complex scalar g of the bordered system
//!
//! ```text
//! (A − iω) w + b g = 0,    cᴴ w = 1
//! uᴴ (A − iω) + g cᴴ = 0,  uᴴ b = 1
//! ```
//!
//! is 0 exactly where A − iω is singular, and smooth: g_α = −uᴴ(A − iω)_α w. The borders b and c
//! are the last vectors u and w.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

use crate::error::Error;
use crate::numerics::eigenvalues::{balance, is_neutral};
use crate::numerics::trace::{Equations, Point};
use crate::orbit::FamilyOfTwo;
use crate::structure::sliding_field::SlidingField;

type Vector = DVector<Complex<f64>>;

/// The Hopf points of a family; the unknowns are the two parameters and the frequency.
pub(super) struct HopfPoints<'f> {
    pub(super) family: &'f FamilyOfTwo<'f>,
    pub(super) ranges: [Range<f64>; 2],
}

/// ∂F/∂x in balanced coordinates, their units, and the contacts that stick.
pub(super) struct Balanced {
    pub(super) matrix: DMatrix<f64>,
    units: DVector<f64>,
    pub(super) sticking: Vec<usize>,
}

/// The bordered system at one place, in balanced coordinates y = x/units.
#[derive(Debug, Clone)]
pub(super) struct Bordered {
    pub(super) displacements: Vec<f64>,
    /// The contacts that stick: where others do, the field is another one.
    pub(super) sticking: Vec<usize>,
    matrix: DMatrix<f64>,
    units: DVector<f64>,
    /// b and c.
    borders: [Vector; 2],
    /// u and w.
    vectors: [Vector; 2],
    scalar: Complex<f64>,
    /// The other eigenvalues with im ≥ 0, and the first Lyapunov coefficient with its rounding; of
    /// a solution.
    pub(super) others: Vec<Complex<f64>>,
    pub(super) lyapunov: [f64; 2],
}

/// Increments of a parameter for derivatives, in units of the parameter or, if that is larger, of
/// the width of its range: about the third root of ε.
const PART: f64 = 6e-6;

/// The largest increment, in units of the width.
const MOST: f64 = 1.0 / 64.0;

/// Other real parts, in units of their terms, that are rounding.
const ROUNDING: f64 = 1e-12;

const I: Complex<f64> = Complex::new(0.0, 1.0);

impl HopfPoints<'_> {
    /// A property of the field near steady sliding; an error if there is none.
    pub(super) fn field<T>(
        &self,
        [first, second]: [f64; 2],
        take: impl FnOnce(&SlidingField<'_, '_>) -> Option<T>,
    ) -> Result<T, Error> {
        let find = || {
            let system = (self.family)(first, second)?;
            let form = system.form();
            take(&SlidingField::standing(form.model())?).ok_or(Error::NoHopfPoint)
        };
        find().map_err(|error: Error| error.at_pair([first, second]))
    }

    /// The field at parameters, in units of its own.
    pub(super) fn balanced(&self, parameters: [f64; 2]) -> Result<Balanced, Error> {
        let take = |field: &SlidingField<'_, '_>| Some((field.jacobian()?, field.sticking()));
        let (mut matrix, sticking) = self.field(parameters, take)?;
        if !matrix.iter().all(|entry| entry.is_finite()) {
            return Err(self.none(parameters));
        }
        let units = balance(&mut matrix);
        Ok(Balanced {
            matrix,
            units,
            sticking,
        })
    }

    /// ∂F/∂x in the units of a place where the same contacts stick, and the displacements.
    fn balanced_as(
        &self,
        parameters: [f64; 2],
        near: &Bordered,
    ) -> Result<(DMatrix<f64>, Vec<f64>), Error> {
        let take = |field: &SlidingField<'_, '_>| {
            let jacobian = field
                .jacobian()
                .filter(|_| field.sticking() == near.sticking)?;
            Some((jacobian, field.displacements.clone()))
        };
        let (mut matrix, displacements) = self.field(parameters, take)?;
        for i in 0..matrix.nrows() {
            for j in 0..matrix.ncols() {
                matrix[(i, j)] *= near.units[j] / near.units[i];
            }
        }
        Ok((matrix, displacements))
    }

    fn none(&self, parameters: [f64; 2]) -> Error {
        Error::NoHopfPoint.at_pair(parameters)
    }

    /// The bordered system near an eigenvalue iω, its borders by inverse iteration.
    pub(super) fn begun(&self, parameters: [f64; 2], frequency: f64) -> Result<Bordered, Error> {
        /// Two are enough near an eigenvalue.
        const ITERATIONS: usize = 4;
        let Balanced {
            matrix,
            units,
            sticking,
        } = self.balanced(parameters)?;
        // Any vector will do that is not special.
        let any = |sign: f64| {
            let entry = |i: usize, _| Complex::cis(sign * (1.0 + i as f64).sqrt());
            DVector::from_fn(matrix.nrows(), entry).normalize()
        };
        let none = Vector::zeros(0);
        let mut begun = Bordered {
            displacements: Vec::new(),
            sticking,
            borders: [any(1.0), any(-1.0)],
            vectors: [none.clone(), none],
            scalar: Complex::new(f64::NAN, 0.0),
            others: Vec::new(),
            lyapunov: [f64::NAN; 2],
            matrix,
            units,
        };
        for _ in 0..ITERATIONS {
            if !begun.solve(frequency) {
                return Err(self.none(parameters));
            }
            begun.borders = begun.vectors.clone().map(|vector| vector.normalize());
        }
        Ok(begun)
    }

    /// The derivative of the balanced matrix by a parameter, by a central difference inside the
    /// range; one-sided if one side has no system.
    fn by_parameter(
        &self,
        y: &DVector<f64>,
        which: usize,
        here: &Bordered,
    ) -> Option<DMatrix<f64>> {
        let Range { start, end } = self.ranges[which];
        let (width, value) = (end - start, y[which]);
        let beside = |change: f64| {
            let mut parameters = [y[0], y[1]];
            parameters[which] = (value + change).clamp(start.min(value), end.max(value));
            let (balanced, _) = self.balanced_as(parameters, here).ok()?;
            Some((parameters[which], balanced))
        };
        let step = (PART * width.max(value.abs())).min(MOST * width);
        let here = Some((value, here.matrix.clone()));
        let pair = match (beside(-step), beside(step)) {
            (None, high) => (here, high),
            (low, None) => (low, here),
            pair => pair,
        };
        let ((low, below), (high, above)) = (pair.0?, pair.1?);
        Some((above - below) / (high - low))
    }
}

impl Bordered {
    /// Solves the bordered system and its adjoint; returns false if that is singular.
    fn solve(&mut self, frequency: f64) -> bool {
        let n = self.matrix.nrows();
        let [b, c] = &self.borders;
        let system = DMatrix::from_fn(n + 1, n + 1, |i, j| match (i < n, j < n) {
            (true, true) if i == j => self.matrix[(i, j)] - I * frequency,
            (true, true) => Complex::from(self.matrix[(i, j)]),
            (true, false) => b[i],
            (false, true) => c[j].conj(),
            (false, false) => Complex::from(0.0),
        });
        let mut right = Vector::zeros(n + 1);
        right[n] = Complex::from(1.0);
        let adjoint = system.adjoint().lu().solve(&right);
        let (Some(found), Some(adjoint)) = (system.lu().solve(&right), adjoint) else {
            return false;
        };
        self.scalar = found[n];
        self.vectors = [adjoint, found].map(|vector| vector.rows(0, n).into_owned());
        let numbers = self.vectors.iter().flatten();
        numbers.chain([&self.scalar]).all(|x| x.is_finite())
    }

    /// The first Lyapunov coefficient of the solution, and the size of its rounding.
    ///
    /// The vectors are scaled to |q| = 1 in the units of the system, and p·q = 1.
    fn first_lyapunov(&self, field: &SlidingField<'_, '_>, frequency: f64) -> Option<[f64; 2]> {
        let projection = field.projection()?;
        let [u, w] = &self.vectors;
        let length = w.map_with_location(|i, _, x| x * self.units[i]).norm();
        let q = w / Complex::from(length);
        let p = u / u.dotc(&q).conj();
        let [a, b] = [q.map(|x| x.re), q.map(|x| x.im)];
        // B(x, x) and C(x, x, x) for real x.
        let forms = |x: &DVector<f64>| {
            let [second, third] = field.terms(&x.component_mul(&self.units));
            let forms = [second * 2.0, third * 6.0];
            forms.map(|form| (&projection * form).component_div(&self.units))
        };
        let [[aa, aaa], [bb, bbb]] = [forms(&a), forms(&b)];
        let [plus, minus] = [forms(&(&a + &b)), forms(&(&a - &b))];
        let ab = (&plus[0] - &minus[0]) * 0.25;
        let abb = ((&plus[1] + &minus[1]) * 0.5 - &aaa) / 3.0;
        let aab = ((&plus[1] - &minus[1]) * 0.5 - &bbb) / 3.0;
        let complex = |re: DVector<f64>, im: DVector<f64>| re.zip_map(&im, Complex::new);
        let cubic = complex(aaa + abb, aab + bbb);
        let mean = complex(&aa + &bb, DVector::zeros(a.len()));
        let double = complex(aa - bb, ab * 2.0);
        // B(x, y) of complex vectors.
        let product = |x: &Vector, y: &Vector| {
            let [x, y] = [x, y].map(|x| [x.map(|x| x.re), x.map(|x| x.im)]);
            let real = |x: &DVector<f64>, y: &DVector<f64>| {
                let [[plus, _], [minus, _]] = [forms(&(x + y)), forms(&(x - y))];
                (plus - minus) * 0.25
            };
            let re = real(&x[0], &y[0]) - real(&x[1], &y[1]);
            complex(re, real(&x[0], &y[1]) + real(&x[1], &y[0]))
        };
        let matrix = self.matrix.map(Complex::from);
        let twice = DMatrix::from_diagonal_element(matrix.nrows(), matrix.nrows(), I * frequency)
            * Complex::from(2.0)
            - &matrix;
        let solved = (matrix.lu().solve(&mean), twice.lu().solve(&double));
        let (Some(mean), Some(double)) = solved else {
            return Some([f64::NAN; 2]);
        };
        let parts = [
            p.dotc(&cubic),
            p.dotc(&product(&q, &mean)) * -2.0,
            p.dotc(&product(&q.conjugate(), &double)),
        ];
        let [value, size] = [
            parts.iter().map(|part| part.re).sum::<f64>(),
            parts.iter().map(|part| part.norm()).sum(),
        ];
        Some([value, 64.0 * f64::EPSILON * size].map(|x| x / (2.0 * frequency)))
    }

    /// The product of the real parts of the other eigenvalues; 0 if one of them is rounding.
    fn neutral(&self) -> f64 {
        let largest = self
            .others
            .iter()
            .map(|value| value.norm())
            .fold(0.0, f64::max);
        let is_rounding =
            |value: &Complex<f64>| is_neutral(&self.matrix, &self.others, *value, ROUNDING);
        if self.others.iter().any(is_rounding) {
            0.0
        } else {
            self.others.iter().map(|value| value.re / largest).product()
        }
    }
}

impl Equations for HopfPoints<'_> {
    type Value = Bordered;

    fn parameters(&self) -> [usize; 2] {
        [0, 1]
    }

    fn ranges(&self) -> &[Range<f64>; 2] {
        &self.ranges
    }

    fn value(&self, y: &mut DVector<f64>, near: &Bordered) -> Result<Bordered, Error> {
        let parameters = [y[0], y[1]];
        let (matrix, displacements) = self.balanced_as(parameters, near)?;
        let mut value = Bordered {
            matrix,
            displacements,
            ..near.clone()
        };
        if value.solve(y[2]) {
            Ok(value)
        } else {
            Err(self.none(parameters))
        }
    }

    fn residual(&self, y: &DVector<f64>, value: &Bordered) -> DVector<f64> {
        DVector::from_column_slice(&[value.scalar.re, value.scalar.im]) / y[2].abs()
    }

    fn jacobian(
        &self,
        y: &DVector<f64>,
        value: &Bordered,
        scale: &DVector<f64>,
    ) -> Result<DMatrix<f64>, Error> {
        let [u, w] = &value.vectors;
        let mut jacobian = DMatrix::zeros(2, 3);
        for j in 0..3 {
            let slope = if j == 2 {
                I * u.dotc(w)
            } else {
                let slope = self.by_parameter(y, j, value);
                let slope = slope.ok_or_else(|| self.none([y[0], y[1]]))?;
                -u.dotc(&(slope.map(Complex::from) * w))
            };
            let slope = slope * (scale[j] / y[2].abs());
            jacobian[(0, j)] = slope.re;
            jacobian[(1, j)] = slope.im;
        }
        Ok(jacobian)
    }

    fn rounding(&self, value: &Bordered) -> f64 {
        1e-12 * value.matrix.nrows() as f64
    }

    fn complete(&self, y: &DVector<f64>, mut value: Bordered) -> Result<Bordered, Error> {
        let parameters = [y[0], y[1]];
        let frequency = y[2];
        if frequency <= 0.0 || frequency.is_nan() {
            return Err(self.none(parameters));
        }
        let (lyapunov, spectrum) = self.field(parameters, |field| {
            let lyapunov = value.first_lyapunov(field, frequency)?;
            Some((lyapunov, field.eigenvalues()?.0))
        })?;
        let mut others = spectrum.values;
        others.retain(|value| value.im >= 0.0);
        let own = |value: &Complex<f64>| (value - I * frequency).norm();
        let nearest = others.iter().enumerate();
        let nearest = nearest.min_by(|a, b| own(a.1).total_cmp(&own(b.1)));
        if let Some((place, _)) = nearest {
            others.swap_remove(place);
        }
        let Balanced { units, .. } = self.balanced(parameters)?;
        let ratio = value.units.component_div(&units).map(Complex::from);
        let [u, w] = &value.vectors;
        value.borders = [
            u.component_div(&ratio).normalize(),
            w.component_mul(&ratio).normalize(),
        ];
        let balanced = DMatrix::from_fn(units.len(), units.len(), |i, j| {
            value.matrix[(i, j)] * (ratio[i].re / ratio[j].re)
        });
        Ok(Bordered {
            matrix: balanced,
            units,
            others,
            lyapunov,
            ..value
        })
    }

    fn scale(&self, y: &DVector<f64>, _: &Bordered) -> DVector<f64> {
        let [first, second] = [0, 1].map(|i| self.ranges[i].end - self.ranges[i].start);
        DVector::from_column_slice(&[first, second, y[2]])
    }

    fn tests(&self, point: &Point<Bordered>) -> Vec<f64> {
        let value = &point.value;
        let [lyapunov, rounding] = value.lyapunov;
        let lyapunov = if lyapunov.abs() > rounding {
            lyapunov
        } else {
            0.0
        };
        vec![
            lyapunov,
            value.neutral(),
            point.tangent[0],
            point.tangent[1],
        ]
    }

    fn ends_at(&self, _: usize) -> bool {
        false
    }

    fn is_at_limit(&self) -> bool {
        false
    }

    fn lost(&self, y: &DVector<f64>, _: &Bordered) -> Error {
        self.none([y[0], y[1]])
    }
}
