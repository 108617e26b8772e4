//! One order of a contact: its load, its law, and its memory.

use super::contact_data::ContactData;
use super::contact_series::{ContactSeries, StepMode, correction};
use super::coordinate_series::CoordinateSeries;
use super::element_series::ElementSeries;
use super::limits::limit_force;
use crate::friction::memory::Slip;
use crate::friction::memory::object::MemoryOrder;
use crate::scalar::mul_add;
use crate::series::INTEGRAL;

impl ContactSeries {
    /// Computes order k of a contact with its own coordinate, and order k + 1 of its sliding speed,
    /// from order k of all other accelerations relative to the surface. Returns order k + 1 of the
    /// coordinate's velocity.
    #[inline(always)]
    pub(super) fn order(&mut self, contact: &ContactData<'_>, k: usize, surface: f64) -> f64 {
        let friction = match self.mode {
            StepMode::Open => 0.0,
            StepMode::Stick => {
                self.stick_order(contact, k);
                0.0
            }
            StepMode::Slip => self.slip_order(contact, k),
        };
        let mut speed = (self.side * self.carried[k] - friction) * INTEGRAL[k];
        if k == 0 {
            speed = self.rate.unwrap_or(speed);
        }
        self.speeds[k + 1] = speed;
        mul_add(self.side, speed, surface)
    }

    /// Coefficient k of the load; that of the elements is known.
    #[inline(always)]
    pub(super) fn load_order(
        &mut self,
        contact: &ContactData<'_>,
        coordinates: &[CoordinateSeries],
        elements: &[ElementSeries],
        k: usize,
    ) {
        if self.load_varies {
            let mut by_displacements =
                contact.displacement_load(|j| coordinates[j].motion.displacement(k));
            for law in &elements[contact.load_laws.clone()] {
                by_displacements += law.product(0, k);
            }
            let load = self.drive_load[k] + by_displacements * contact.compliance;
            self.normal_mut()[k] = load;
        }
    }

    /// Coefficient k of Nσμ in slip, and coefficient k + 1 of the memory. On the slow manifold it
    /// computes coefficient k of the memory instead, from coefficient k + 1 of the pass before.
    pub(super) fn slip_order(&mut self, contact: &ContactData<'_>, k: usize) -> f64 {
        let coefficient = if self.memories.is_empty() {
            self.law_order(contact, k)
        } else {
            self.with_memory(contact, k)
        };
        if self.load_varies {
            (0..=k).map(|l| self.load[l] * self.friction[k - l]).sum()
        } else {
            self.load[0] * coefficient
        }
    }

    /// Coefficient k of σμ, and k + 1 of the memory, or k.
    fn with_memory(&mut self, contact: &ContactData<'_>, k: usize) -> f64 {
        if self.relaxation > 0.0 {
            // The law runs twice: for the memory, then with it.
            self.law_order(contact, k);
            for (series, rate) in std::iter::zip(&mut self.memories, &self.rates) {
                series[k] += correction(self.relaxation, k, *rate, [series[k], series[k + 1]]);
            }
            return self.law_order(contact, k);
        }
        let coefficient = self.law_order(contact, k);
        self.set_memories(k);
        coefficient
    }

    /// The argument of its law, with coefficient k of the sliding speed.
    #[inline(always)]
    pub(super) fn slip(&self, k: usize) -> Slip<f64> {
        Slip {
            speed: self.speeds[k],
            direction: self.side,
            piece: self.piece,
        }
    }

    /// Coefficient k of σμ; notes that of the rates of the memory.
    #[inline(always)]
    pub(super) fn law_order(&mut self, contact: &ContactData<'_>, k: usize) -> f64 {
        let slip = self.slip(k);
        let mut memory = MemoryOrder {
            load: self.load[k] / contact.compliance,
            series: &self.memories,
            rates: &mut self.rates,
        };
        let (coefficient, slope) = contact.law.slip_order(&mut self.tape, k, slip, &mut memory);
        (self.friction[k], self.slope) = (coefficient, slope);
        coefficient
    }

    /// Coefficient k of the bounds N μ_s in stick, and k + 1 of the memory.
    #[inline]
    pub(super) fn stick_order(&mut self, contact: &ContactData<'_>, k: usize) {
        if self.memories.is_empty() {
            // μ_s is a constant.
            if k > 0 && !self.load_varies {
                return;
            }
            for (bound, limit) in std::iter::zip(&mut self.bounds, self.limits) {
                bound[k] = if k == 0 {
                    limit_force(self.load[0], limit)
                } else if limit.is_finite() {
                    self.load[k] * limit
                } else {
                    0.0
                };
            }
            return;
        }
        let mut memory = MemoryOrder {
            load: self.load[k] / contact.compliance,
            series: &self.memories,
            rates: &mut self.rates,
        };
        let limits = contact.law.stick_order(&mut self.tape, k, &mut memory);
        let series = std::iter::zip(&mut self.bounds, &mut self.limit_series);
        for ((bound, series), limit) in series.zip(limits) {
            series[k] = limit;
            bound[k] = if series[0] == f64::INFINITY {
                limit_force(self.load[k], limit)
            } else if self.load_varies {
                (0..=k).map(|l| self.load[l] * series[k - l]).sum()
            } else {
                self.load[0] * limit
            };
        }
        self.set_memories(k);
    }

    #[inline(always)]
    fn set_memories(&mut self, k: usize) {
        for (series, rate) in std::iter::zip(&mut self.memories, &self.rates) {
            series[k + 1] = rate * INTEGRAL[k];
        }
    }
}
