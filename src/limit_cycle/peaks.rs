//! The map from one velocity maximum to the next, of motions behind the belt. Its fixed points are
//! the pure-slip cycles.

use super::arc::{Arc, Arrival, Tracer};
use super::averaged;
use super::continuum::is_flat;
use super::growth::{self, velocity_growth};
use crate::belt::Forward;
use crate::clock::Time;
use crate::error::Error;
use crate::friction::taylor_coefficients_on;
use crate::numerics::roots_with_slopes::{
    Kinks, Roots, Sample, eighths, outline_between, roots_between, turn,
};
use crate::numerics::sort::sort_by;

/// Smallest velocity maximum that is searched, in units of v_b. Below it one period changes a
/// motion by less than rounding does.
pub(super) const SMALLEST_PEAK: f64 = 1e-4;

/// A growth, or its change over the range, counts as hidden if it is less than this number of
/// rounding errors.
const HIDDEN: f64 = 100.0;

/// The map V → P(V) from one velocity maximum to the next.
pub(crate) struct PeakMap<'t, 's> {
    tracer: &'t mut Tracer<'s>,
}

impl<'t, 's> PeakMap<'t, 's> {
    pub(crate) fn of(tracer: &'t mut Tracer<'s>) -> Self {
        Self { tracer }
    }

    pub(super) fn system(&self) -> Forward<'s> {
        self.tracer.system()
    }

    /// The growth over one period, P(V)/V − 1, and its slope. P(V) is the velocity maximum that
    /// follows V on a motion in slip.
    ///
    /// P'(V) = (V/P)·exp(−∮(2β + γ² dμ̂/ds) dτ). A motion that meets the belt instead counts as
    /// growing, and one that settles at a node as decaying. Nothing is known of one that rounding
    /// keeps at an equilibrium that does not attract.
    pub(super) fn growth(&mut self, peak: f64) -> Result<Sample, Error> {
        let v_b = self.system().belt_velocity();
        let arc = self.tracer.arc_from_peak(peak, Time::Forward)?;
        let (next, slope) = match arc.arrival {
            Arrival::Maximum(point) => {
                let next = v_b - point.speed;
                (next, peak / next * (-self.tracer.contraction(&arc)).exp())
            }
            Arrival::Contact(_) | Arrival::Far | Arrival::Held => (2.0 * v_b, 0.0),
            Arrival::Equilibrium if self.tracer.attracts(Time::Forward) => (0.0, 0.0),
            Arrival::Equilibrium => (peak, 1.0),
        };
        Ok(velocity_growth(self.tracer, peak, next, slope))
    }

    /// Returns true if a motion with the velocity maximum V grows over the next period; `None` if
    /// rounding hides it.
    pub(super) fn grows(&mut self, peak: f64) -> Result<Option<bool>, Error> {
        self.growth(peak).map(Sample::grows)
    }

    /// The largest velocity maximum from which a motion returns without meeting the belt, with its
    /// growth. Found by following the motion that grazes the belt backwards to the maximum before.
    /// It is v_b if every motion returns; `None` if none does.
    fn largest(&mut self) -> Result<Option<Sample>, Error> {
        let v_b = self.system().belt_velocity();
        let grazing = self.tracer.arc_from_peak(v_b, Time::Backward)?;
        match grazing.arrival {
            Arrival::Maximum(point) => {
                let peak = v_b - point.speed;
                let slope = peak / v_b * (-self.tracer.contraction(&grazing)).exp();
                Ok(Some(velocity_growth(self.tracer, peak, v_b, slope)))
            }
            Arrival::Equilibrium if self.tracer.attracts(Time::Backward) => Ok(None),
            _ => self.growth(v_b).map(Some),
        }
    }

    /// The overshoot, after one period, of the motion that touches the belt velocity from below,
    /// with the velocity maximum V = v_b: see [`growth::overshoot`]. It is 0 if a periodic motion
    /// in slip touches the belt velocity.
    pub(crate) fn overshoot(&mut self) -> Result<f64, Error> {
        let v_b = self.system().belt_velocity();
        let turn = self.tracer.arc_from_peak(v_b, Time::Forward)?;
        growth::overshoot(self.tracer, &turn)
    }

    /// Returns true if every motion in slip is periodic: the system [`is_flat`], and no motion
    /// grows or shrinks.
    pub(super) fn is_continuum(&mut self) -> Result<bool, Error> {
        let system = self.system();
        if !is_flat(&system) {
            return Ok(false);
        }
        for part in [0.9, 0.1, 0.7, 0.3, 0.5] {
            if !self.growth(part * system.belt_velocity())?.vanishes() {
                return Ok(false);
            }
        }
        // The largest motion meets the lowest speeds, at which alone friction may vary.
        Ok(self.overshoot()? == 0.0)
    }

    /// The range of velocity maxima that is searched, from the smallest to the largest.
    fn range(&mut self) -> Result<Option<[Sample; 2]>, Error> {
        let v_b = self.system().belt_velocity();
        let smallest = self.growth(SMALLEST_PEAK * v_b)?;
        if smallest.x * (1.0 + smallest.value) > v_b {
            // The smallest motion meets the belt, and so does every motion round it.
            return Ok(None);
        }
        let largest = self.largest()?;
        Ok(largest
            .filter(|largest| largest.x > smallest.x)
            .map(|largest| [smallest, largest]))
    }

    /// Velocity maxima V of the periodic motions in slip. Ranges in which rounding hides the growth
    /// are left unresolved only where averaging does not exclude a cycle.
    pub(super) fn roots(&mut self) -> Result<Roots, Error> {
        let mut roots = Roots::default();
        if let Some([smallest, largest]) = self.range()? {
            let kinks = Kink::all(&self.system());
            let between = |a: f64, b: f64| Kink::between(&kinks, a, b);
            let mut growth = |peak: f64| self.growth(peak);
            roots_between(&mut growth, &between, smallest, largest, &mut roots)?;
        }
        self.decide_hidden(&roots)
    }

    /// Removes roots that rounding has made, and unresolved ranges that hold no root. Where
    /// rounding hides the growth, averaging decides if it can.
    fn decide_hidden(&mut self, found: &Roots) -> Result<Roots, Error> {
        let system = self.system();
        let v_b = system.belt_velocity();
        let mut kept = Roots::default();
        for &root in &found.roots {
            let growth = self.growth(root)?;
            let is_hidden = (growth.slope * root).abs() <= HIDDEN * growth.noise;
            // Rounding moves the root of a cycle by less: one that it moves farther is unresolved.
            let near = 0.5 * root..(2.0 * root).min(v_b);
            if !(is_hidden && averaged::all_grow(&system, &near)?.is_some()) {
                kept.roots.push(root);
            }
        }
        for range in &found.unresolved {
            let [start, end] = [self.growth(range.start)?, self.growth(range.end)?];
            let is_decided = start.value.abs() <= HIDDEN * start.noise
                && match averaged::all_grow(&system, range)? {
                    None => false,
                    Some(false) => true,
                    // All motions grow out of the range, and the growth beyond it is known, unless
                    // the range ends at the belt to rounding.
                    Some(true) => v_b - range.end > HIDDEN * end.noise * v_b,
                };
            if !is_decided {
                kept.unresolved.push(range.clone());
            }
        }
        Ok(kept)
    }

    /// The growth over one period at nine peak velocities from one end of their range to the other.
    /// Empty if every motion in slip meets the belt, if none returns, or if every one is periodic.
    pub(crate) fn survey(&mut self) -> Result<Vec<Sample>, Error> {
        if self.is_continuum()? {
            return Ok(Vec::new());
        }
        let Some([smallest, largest]) = self.range()? else {
            return Ok(Vec::new());
        };
        eighths(&mut |peak| self.growth(peak), smallest, largest)
    }

    /// Outline of the growth over one period as a function of the peak velocity: (peak, growth) at
    /// the ends of the range and at the turning points between, as far as the growth there is
    /// within `reach` of zero. `seen` holds the known values of the growth, in ascending order,
    /// from a [`survey`](Self::survey) on; new values are added to it.
    pub(crate) fn outline(
        &mut self,
        seen: &mut Vec<Sample>,
        reach: f64,
    ) -> Result<Vec<(f64, f64)>, Error> {
        let &[smallest, .., largest] = &seen[..] else {
            return Ok(Vec::new());
        };
        let mut growth = |peak: f64| match seen.binary_search_by(|seen| seen.x.total_cmp(&peak)) {
            Ok(i) => Ok(seen[i]),
            Err(i) => {
                let sample = self.growth(peak)?;
                seen.insert(i, sample);
                Ok(sample)
            }
        };
        let outline = outline_between(&mut growth, smallest, largest, reach)?;
        Ok(outline.iter().map(|turn| (turn.x, turn.value)).collect())
    }

    /// The growth at a turning point between two places in the range of peak velocities, from 0 to
    /// 1; `None` if the slopes there show no maximum, or no minimum if that is searched.
    pub(crate) fn turn(
        &mut self,
        places: [f64; 2],
        is_maximum: bool,
    ) -> Result<Option<f64>, Error> {
        let Some([smallest, largest]) = self.range()? else {
            return Ok(None);
        };
        let at = |place: f64| smallest.x + place * (largest.x - smallest.x);
        let [a, b] = [self.growth(at(places[0]))?, self.growth(at(places[1]))?];
        if (a.slope > 0.0) != is_maximum || (b.slope > 0.0) == is_maximum {
            return Ok(None);
        }
        Ok(Some(turn(&mut |peak| self.growth(peak), a, b, 0.0)?.value))
    }

    /// The periodic motion in slip whose velocity has the maximum V, and its Floquet multiplier.
    ///
    /// An unstable cycle is followed backwards, because it attracts in that direction: followed
    /// forwards, rounding would grow and the cycle would not close.
    pub(super) fn cycle(&mut self, peak: f64) -> Result<(Arc, f64), Error> {
        let arc = self.tracer.arc_from_peak(peak, Time::Forward)?;
        let multiplier = (-self.tracer.contraction(&arc)).exp();
        if multiplier > 1.0 {
            let backward = self.tracer.arc_from_peak(peak, Time::Backward)?;
            if let Arrival::Maximum(point) = backward.arrival {
                let multiplier = (-self.tracer.contraction(&backward)).exp();
                let start = point.state(&self.system());
                return Ok((backward.reversed(start), multiplier));
            }
        }
        Ok((arc, multiplier))
    }
}

/// A velocity amplitude W from which on motions meet a breakpoint of the law, at which γ² dμ̂/ds
/// jumps by J and γ² d²μ̂/ds² by K. Beyond W their growth changes to first order by
///
/// ```text
/// J(θ − sin θ cos θ) + K V(sin θ − ⅓ sin³θ − θ cos θ),   cos θ = W/V:
/// ```
///
/// the work of the force J(V cos ψ − W) + ½K(V cos ψ − W)² over |ψ| < θ, divided by V². Where
/// dμ̂/ds is continuous, as in a table, the second term remains.
#[derive(Debug, Clone, Copy)]
struct Kink {
    amplitude: f64,
    /// |J| and |K|.
    jumps: [f64; 2],
}

impl Kink {
    /// Returns all kinks, by ascending amplitude.
    fn all(system: &Forward<'_>) -> Vec<Self> {
        let (law, v_b) = (system.law(), system.belt_velocity());
        let breakpoints = law.breakpoints().enumerate();
        let kinks = breakpoints.map(|(i, breakpoint)| {
            let [below, above]: [[f64; 3]; 2] =
                [i, i + 1].map(|piece| taylor_coefficients_on(law, piece, breakpoint));
            let jump = |n: usize| system.load() * (above[n] - below[n]).abs();
            Self {
                amplitude: (breakpoint - v_b).abs(),
                jumps: [jump(1), 2.0 * jump(2)],
            }
        });
        let mut kinks: Vec<Self> = kinks.filter(|kink| kink.jumps != [0.0; 2]).collect();
        sort_by(&mut kinks, |kink| kink.amplitude);
        kinks
    }

    /// The error with which a cubic may predict the growth between two amplitudes: the change that
    /// kinks cause in the value at the upper end, plus at most 4/27 of the change of the slope
    /// there times the width.
    fn between(kinks: &[Self], a: f64, b: f64) -> Option<Kinks> {
        let start = kinks.partition_point(|kink| kink.amplitude <= a);
        let end = kinks.partition_point(|kink| kink.amplitude < b);
        let inside = kinks.get(start..end).filter(|inside| !inside.is_empty())?;
        let change = |kink: &Self| {
            let cos = kink.amplitude / b;
            let sin = (1.0 - cos * cos).sqrt();
            let angle = cos.acos();
            let (slope, bend) = (2.0 * sin * cos / b, 2.0 / 3.0 * sin.powi(3));
            let of_slope = angle - sin * cos + 4.0 / 27.0 * slope * (b - a);
            let of_bend = b * (sin - sin.powi(3) / 3.0 - angle * cos) + 4.0 / 27.0 * bend * (b - a);
            kink.jumps[0] * of_slope + kink.jumps[1] * of_bend
        };
        Some(Kinks {
            x: inside[inside.len() / 2].amplitude,
            error: inside.iter().map(change).sum(),
        })
    }
}

#[cfg(test)]
mod tests;
