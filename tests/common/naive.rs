//! The decision of contacts at rest, by trying all patterns of modes.

use stick_slip::nalgebra::{DMatrix, DVector};

/// Whether a matrix B M⁻¹Bᵀ is that of independent rows.
pub fn is_definite(compliance: &DMatrix<f64>) -> bool {
    let Some(factor) = compliance.clone().cholesky() else {
        return false;
    };
    let part = |c: usize| factor.l_dirty()[(c, c)].powi(2) / compliance[(c, c)];
    (0..compliance.nrows()).all(|c| part(c) > 1e-9)
}

/// Contacts with r = 0 that ask what to do: a = a⁰ − G λ.
#[derive(Debug, Clone)]
pub struct Question {
    /// G.
    pub compliance: DMatrix<f64>,
    /// a⁰.
    pub free: DVector<f64>,
    /// N μ_s and N μ̂(0), backward and forward; infinite where it cannot slip.
    pub limits: Vec<[f64; 2]>,
    pub kinetic: Vec<[f64; 2]>,
}

/// 0 sticks, ±1 slips with that sign.
pub type Pattern = Vec<i8>;

/// The one of two numbers backward and forward that belongs to a sign.
pub fn on_side(pair: [f64; 2], side: i8) -> f64 {
    pair[usize::from(side > 0)]
}

impl Question {
    /// G of some of them.
    fn among(&self, contacts: &[usize]) -> DMatrix<f64> {
        let entry = |c: usize, d: usize| self.compliance[(contacts[c], contacts[d])];
        DMatrix::from_fn(contacts.len(), contacts.len(), entry)
    }

    /// What all carry, and how they are accelerated, with these forces in slip; `None` if those
    /// that stick are dependent.
    fn solve(&self, pattern: &[i8], slipping: &[[f64; 2]]) -> Option<(DVector<f64>, DVector<f64>)> {
        let k = pattern.len();
        // λ of those that slip, and a = 0 of those that stick: one system for all.
        let mut matrix = DMatrix::identity(k, k);
        let mut right = DVector::zeros(k);
        for c in 0..k {
            if pattern[c] == 0 {
                // In units in which G has a unit diagonal, to tell dependent ones.
                let unit = self.compliance[(c, c)].sqrt();
                for d in 0..k {
                    matrix[(c, d)] = self.compliance[(c, d)] / unit;
                }
                right[c] = self.free[c] / unit;
            } else {
                right[c] = f64::from(pattern[c]) * on_side(slipping[c], pattern[c]);
                if right[c].is_infinite() {
                    return None;
                }
            }
        }
        let stuck: Vec<usize> = (0..k).filter(|&c| pattern[c] == 0).collect();
        if !is_definite(&self.among(&stuck)) {
            return None;
        }
        // Nalgebra factorises no matrix without rows.
        let forces = match k {
            0 => right,
            _ => matrix.lu().solve(&right)?,
        };
        let accelerations = &self.free - &self.compliance * &forces;
        Some((forces, accelerations))
    }

    /// The force by which the pattern keeps all its conditions; negative if it breaks
    /// one.
    fn margin(&self, pattern: &[i8], bounds: &[[f64; 2]], slipping: &[[f64; 2]]) -> Option<f64> {
        let (forces, accelerations) = self.solve(pattern, slipping)?;
        let margins = (0..pattern.len()).map(|c| match pattern[c] {
            0 => (bounds[c][0] + forces[c]).min(bounds[c][1] - forces[c]),
            side => f64::from(side) * accelerations[c] / self.compliance[(c, c)],
        });
        Some(margins.fold(f64::INFINITY, f64::min))
    }

    fn patterns(&self) -> impl Iterator<Item = Pattern> {
        let k = self.limits.len();
        let digit = |n: usize, c: usize| (n / 3_usize.pow(c as u32) % 3) as i8 - 1;
        (0..3_usize.pow(k as u32)).map(move |n| (0..k).map(|c| digit(n, c)).collect())
    }

    /// The pattern that solves the programme with given limits, and how clearly.
    pub fn programme(&self, limits: &[[f64; 2]]) -> Option<(Pattern, f64)> {
        let patterns = self.patterns();
        let margins = patterns.filter_map(|p| Some((self.margin(&p, limits, limits)?, p)));
        let best = margins.max_by(|a, b| a.0.total_cmp(&b.0));
        best.map(|(margin, pattern)| (pattern, margin))
    }

    /// All that stuck contacts can hold while those that slip carry their kinetic force and go its
    /// way.
    pub fn consistent(&self) -> Vec<Pattern> {
        let keeps = |p: &Pattern| self.margin(p, &self.limits, &self.kinetic) > Some(0.0);
        self.patterns().filter(keeps).collect()
    }

    /// The fastest yields first: its answer, and how clear it is; `None` if dependent contacts stay
    /// at rest.
    pub fn fastest_first(&self) -> Option<(Pattern, f64)> {
        let k = self.limits.len();
        let mut limits = self.limits.clone();
        let mut yielded = vec![false; k];
        let mut clear = f64::INFINITY;
        loop {
            let (pattern, margin) = self.programme(&limits)?;
            clear = clear.min(margin);
            let (_, accelerations) = self.solve(&pattern, &limits)?;
            let speed = |c: usize| {
                let [limit, kinetic] =
                    [self.limits[c], self.kinetic[c]].map(|pair| on_side(pair, pattern[c]));
                let may = pattern[c] != 0 && !yielded[c] && kinetic < limit;
                let speed = accelerations[c].abs() / (self.compliance[(c, c)] * limit);
                if may { speed } else { 0.0 }
            };
            let speeds: Vec<f64> = (0..k).map(speed).collect();
            let fastest = speeds.iter().copied().fold(0.0, f64::max);
            let rests = |&c: &usize| accelerations[c].abs() < 1e-9;
            let resting: Vec<usize> = (0..k).filter(rests).collect();
            let moves = (0..k).any(|c| speeds[c] > 0.0 && !rests(&c));
            // The acceleration of a contact at its limit may be rounding.
            if !moves && !is_definite(&self.among(&resting)) {
                return None;
            }
            if fastest == 0.0 {
                return Some((pattern, clear));
            }
            for c in 0..k {
                // Mirrored ones together.
                if speeds[c] >= (1.0 - 1e-9) * fastest {
                    (yielded[c], limits[c]) = (true, self.kinetic[c]);
                } else if speeds[c] > 0.0 {
                    clear = clear.min(fastest - speeds[c]);
                }
            }
        }
    }
}

/// Solves the programme for the forces of contacts at rest, one contact after the other, again and
/// again: λ_c = clamp(λ_c + (free_c − Σ G_cd λ_d)/G_cc). One force may be held at its value.
pub fn relax(
    compliance: &DMatrix<f64>,
    free: &DVector<f64>,
    limits: &[[f64; 2]],
    carried: &mut DVector<f64>,
    held: Option<usize>,
) {
    for _ in 0..10_000 {
        let mut moved = 0.0_f64;
        for c in (0..limits.len()).filter(|&c| held != Some(c)) {
            let pull = free[c] - compliance.row(c).tr_dot(carried);
            let next = carried[c] + pull / compliance[(c, c)];
            let next = next.clamp(-limits[c][0], limits[c][1]);
            moved = moved.max((next - carried[c]).abs());
            carried[c] = next;
        }
        if moved < 1e-16 {
            break;
        }
    }
}
