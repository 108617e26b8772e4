//! Special points of curves of folds, flips, pitchforks and tori: zeros of test functions.

use nalgebra::DVector;
use num_complex::Complex;

use super::super::multipliers::tests;
use super::found::SpecialKind;
use super::smooth_equations::{Motion, Smooth, SmoothCurve};

/// Factors of test functions nearer to 0 than this are rounding.
const ROUNDING: f64 = 1e-11;

impl SmoothCurve<'_> {
    /// The multipliers without those that belong to the curve.
    fn others(&self, y: &DVector<f64>, value: &Motion) -> Vec<Complex<f64>> {
        let own = match self.kind {
            Smooth::Fold => vec![Complex::from(1.0)],
            Smooth::Flip => vec![Complex::from(-1.0)],
            Smooth::Torus => {
                let kappa = Complex::from(self.kappa(y));
                let root = (kappa * kappa - 1.0).sqrt();
                vec![kappa + root, kappa - root]
            }
        };
        let mut others = value.multipliers.clone();
        for own in own {
            let off = |m: &Complex<f64>| (m - own).norm();
            let places =
                (0..others.len()).min_by(|&i, &j| off(&others[i]).total_cmp(&off(&others[j])));
            if let Some(place) = places {
                others.remove(place);
            }
        }
        others
    }

    /// The kind of special point at a zero of a test; `None` for two real multipliers of product 1.
    pub(super) fn special_of(
        &self,
        test: usize,
        y: &DVector<f64>,
        value: &Motion,
    ) -> Option<SpecialKind> {
        let others = self.others(y, value);
        let with_pair = |kind| others.iter().any(|m| m.im != 0.0).then_some(kind);
        if self.motions.half.is_some() {
            return match test {
                0 => Some(SpecialKind::Resonance(1)),
                1 => Some(SpecialKind::FoldPitchfork),
                _ => with_pair(SpecialKind::PitchforkNeimarkSacker),
            };
        }
        match (self.kind, test) {
            (Smooth::Fold, 0) => Some(SpecialKind::Cusp),
            (Smooth::Fold, 1) | (Smooth::Torus, 0) => Some(SpecialKind::Resonance(1)),
            (Smooth::Flip, 0) | (Smooth::Torus, 1) => Some(SpecialKind::Resonance(2)),
            (Smooth::Torus, 2) => Some(SpecialKind::Resonance(3)),
            (Smooth::Torus, 3) => Some(SpecialKind::Resonance(4)),
            (Smooth::Fold, 2) | (Smooth::Flip, 1) => Some(SpecialKind::FoldFlip),
            (Smooth::Fold, _) => with_pair(SpecialKind::FoldNeimarkSacker),
            (Smooth::Flip, _) => with_pair(SpecialKind::FlipNeimarkSacker),
            (Smooth::Torus, 4) => Some(SpecialKind::FoldNeimarkSacker),
            (Smooth::Torus, 5) => Some(SpecialKind::FlipNeimarkSacker),
            (Smooth::Torus, _) => with_pair(SpecialKind::DoubleNeimarkSacker),
        }
    }

    /// Functions that change sign at special points.
    pub(super) fn test_values(&self, y: &DVector<f64>, value: &Motion) -> Vec<f64> {
        let [folds, flips, tori] = tests(&self.others(y, value), ROUNDING);
        let order = self.motions.order;
        let along = {
            let [left, right] = [&value.bordered.left, &value.bordered.right];
            left.rows(0, order).dot(&right.rows(0, order))
        };
        match self.kind {
            Smooth::Fold => vec![value.quadratic, along, flips, tori],
            Smooth::Flip => vec![along, folds, tori],
            Smooth::Torus => {
                let kappa = self.kappa(y);
                vec![
                    kappa - 1.0,
                    kappa + 1.0,
                    kappa + 0.5,
                    kappa,
                    folds,
                    flips,
                    tori,
                ]
            }
        }
    }
}
