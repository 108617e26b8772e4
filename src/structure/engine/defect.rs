//! The defect of the series of a step: the residuals of the equations of motion between their
//! coefficients.

use super::contact_data::{ContactData, entry};
use super::contact_series::ContactSeries;
use super::element_data::ElementData;
use super::element_series::ElementSeries;
use super::model::Model;
use super::series::Series;
use super::slow_manifold::relaxation;
use super::state::{ContactState, Phase, Situation};
use super::step_size::{Plan, memory_scale};
use crate::friction::memory::{Motion, Slip};
use crate::motion::step_control::{Allowance, LONG, MOST_FOURS};
use crate::series::many::{Block, GROUPS, values_of};
use crate::series::quarters;

/// Ratio of the successive distances, from the place where a contact is slowest, at which the
/// defect is checked.
///
/// The speeds at successive distances then have the ratio 1/4, or 1/16 if the speed falls like the
/// square of the distance. A law that changes near a low speed still has its values of speed 0 at a
/// quarter or a sixteenth of this speed.
const NEARER: f64 = 0.25;

/// The first of these distances, in parts of the step.
const FIRST: f64 = 0.0625;

/// Returns true if the defect of a step of length h is accepted at every contact: at its quarters,
/// near the least sliding speeds and, in a long step, at least every quarter of a radian.
/// Coefficients alone miss terms that underflow, such as the flank of a narrow Gaussian.
pub(super) fn is_accepted(
    model: &Model<'_>,
    situation: &Situation,
    series: &mut Series,
    plan: &Plan,
    h: f64,
) -> bool {
    let Series {
        contacts: at_contacts,
        elements,
        ..
    } = series;
    let contacts = (0..model.contacts.len()).all(|c| {
        if model.contacts[c].is_elastic() {
            // Linear in what is integrated, up to its events.
            return true;
        }
        let step = ContactStep {
            contact: &model.contacts[c],
            state: &situation.contacts[c],
            series: &at_contacts[c],
            allowance: plan.contacts[c],
            size: plan.sizes[c],
            unit: plan.unit,
            memory_units: &plan.memory_units[model.memory(c)],
            tolerance: plan.tolerance,
            h,
        };
        step.friction_is_accepted() && step.memory_is_accepted()
    });
    let checks = Checks::new(h, plan.unit);
    // In stick a force is carried, not integrated.
    let held = |j: usize| {
        let owner = model.owner[j].filter(|&c| situation.contacts[c].sticks())?;
        let scale = at_contacts[owner].largest_bound().max(plan.sizes[owner]);
        Some(Allowance::new(plan.tolerance * scale, scale))
    };
    contacts
        && std::iter::zip(&model.elements, elements)
            .filter(|(_, of)| of.acts)
            .all(|(element, of)| match element.pressed {
                None => force_is_accepted((element, of), plan, &held, checks),
                Some(c) => {
                    // Within the errors that the coefficients of a load may have.
                    let (defects, size) = (defects(element, of, checks)[0], plan.loads[c]);
                    Allowance::new(plan.tolerance * size, size).accepts(defects, 1.0)
                }
            })
}

/// Returns true if the series of all functions of users, as drives, are those of the functions over
/// a step of length h, within an error relative to their sizes.
pub(super) fn functions_are_accepted(
    model: &Model<'_>,
    situation: &Situation,
    tolerance: f64,
    h: f64,
) -> bool {
    let targets = model.functions.iter();
    let mut defects = targets.flat_map(|&at| model.drive(at).defects(situation.clock, h));
    defects.all(|[defect, size]| Allowance::new(tolerance * size, size).accepts([defect; 3], 1.0))
}

/// The sums of defects of an element.
const QUARTERS: usize = 0;
const EXTREMA: usize = 1;
const BETWEEN: usize = 2;

/// The sums of the defects of each force of an element: at the same places, and about the extrema
/// of its positions and velocities.
fn defects<'s>(
    element: &ElementData<'_>,
    of: &'s mut ElementSeries,
    checks: Checks,
) -> &'s [[f64; 3]] {
    let mut sums = std::mem::take(&mut of.defects);
    sums.fill([0.0; 3]);
    // The force is computed for a block of times at once.
    let (mut block, mut kinds, mut count) = ([[0.0; 4]; GROUPS], [BETWEEN; GROUPS], 0);
    let mut look = |kind: usize, times: [f64; 4]| {
        (block[count], kinds[count]) = (times, kind);
        count += 1;
        if count == GROUPS {
            of.add_defects(element, (&block, &kinds), &mut sums);
            count = 0;
        }
    };
    for k in 0..checks.count() {
        look(if k == 0 { QUARTERS } else { BETWEEN }, checks.group(k));
    }
    for along in of.positions.iter().chain(&of.velocities) {
        let values = along.at_some(quarters(checks.h));
        along.about_extrema(checks.h, values, &mut |times| look(EXTREMA, times));
    }
    if count > 0 {
        of.add_defects(element, (&block, &kinds[..count]), &mut sums);
    }
    of.defects = sums;
    &of.defects
}

/// Returns true if the defect of a force element is accepted on each of its coordinates.
fn force_is_accepted(
    (element, of): (&ElementData<'_>, &mut ElementSeries),
    plan: &Plan,
    held: &dyn Fn(usize) -> Option<Allowance>,
    checks: Checks,
) -> bool {
    let of_forces = defects(element, of, checks);
    let mut coordinates = element.responses.iter().flatten().map(|&(j, _)| j);
    let n = plan.coordinates.len();
    coordinates.all(|j| {
        let forces = || std::iter::zip(&element.responses, of_forces);
        let defects = [QUARTERS, EXTREMA, BETWEEN].map(|kind| {
            let parts = forces().map(|(response, sums)| entry(response, j).abs() * sums[kind]);
            parts.sum::<f64>()
        });
        if let Some(state) = j.checked_sub(n) {
            return plan.states[state].accepts(defects, checks.h);
        }
        match held(j) {
            Some(allowance) => allowance.accepts(defects, 1.0),
            None => plan.coordinates[j].accepts(defects, plan.lasting(j, checks.h)),
        }
    })
}

/// The times at which a step of length h is checked, four at a time: its quarters and, if it is
/// longer than a unit of time, at least every quarter of that unit.
#[derive(Clone, Copy)]
struct Checks {
    h: f64,
    /// Number of groups between the quarters.
    fours: usize,
}

impl Checks {
    fn new(h: f64, unit: f64) -> Self {
        let fours = if h > LONG * unit {
            (h / unit).ceil().min(MOST_FOURS) as usize
        } else {
            0
        };
        Self { h, fours }
    }

    /// Number of groups.
    fn count(&self) -> usize {
        1 + self.fours
    }

    /// The times of one group; those of the last one beyond.
    #[inline(always)]
    fn group(&self, k: usize) -> [f64; 4] {
        match k.min(self.fours) {
            0 => quarters(self.h),
            k => {
                let part = 0.25 * self.h / self.fours as f64;
                let start = (k - 1) as f64 * 4.0 * part;
                [0.5, 1.5, 2.5, 3.5].map(|place| start + place * part)
            }
        }
    }
}

/// A contact in a step of length h.
struct ContactStep<'a> {
    contact: &'a ContactData<'a>,
    state: &'a ContactState,
    series: &'a ContactSeries,
    /// The allowance of its relative velocity.
    allowance: Allowance,
    /// The size of the terms of its equation.
    size: f64,
    /// The time unit in which step lengths are measured.
    unit: f64,
    /// The least scales of the variables of its memory.
    memory_units: &'a [f64],
    tolerance: f64,
    h: f64,
}

impl ContactStep<'_> {
    /// Returns true if the defect of friction in slip is accepted.
    fn friction_is_accepted(&self) -> bool {
        let Some(slip) = self.state.slip(()) else {
            return true;
        };
        let series = self.series;
        let checks = Checks::new(self.h, self.unit);
        let (mut at_quarters, mut between, mut at_times) = (0.0, 0.0, [0.0; 4]);
        for first in (0..checks.count()).step_by(GROUPS) {
            let times = std::array::from_fn(|k| checks.group(first + k));
            let values = values_of([&series.speeds, &series.friction], &times);
            let count = GROUPS.min(checks.count() - first);
            let mut found = self.defects(slip, &times[..count], values);
            if first == 0 {
                (at_quarters, at_times) = (found[0], values[0][0]);
                found[0] = 0.0;
            }
            between += found.iter().sum::<f64>();
        }
        let mut at_minima = 0.0;
        series.speeds.about_minima(self.h, at_times, &mut |times| {
            let block = [times; GROUPS];
            let values = values_of([&series.speeds, &series.friction], &block);
            at_minima += self.defects(slip, &[times], values)[0];
        });
        self.allowance
            .accepts([at_quarters, at_minima, between], self.lasting(self.h))
    }

    /// How much of a time a defect has an effect on the sliding speed: 1/D on a slow manifold.
    fn lasting(&self, time: f64) -> f64 {
        time.min(self.series.settling.recip())
    }

    /// The defect of the series at each group of four times, up to terms as small as its last: max
    /// N · max |μ(s(t)) − μ(t)|, with the sliding speed s(t). The largest load is used, so that a
    /// load that is 0 at one of these times does not hide a defect at another. `values` are those
    /// of s and of the series of σμ.
    #[inline(always)]
    fn defects(&self, slip: Slip<()>, times: &[[f64; 4]], values: [Block; 2]) -> [f64; GROUPS] {
        let Self {
            contact, series, ..
        } = self;
        let [mut exact, friction] = values;
        let exact = &mut exact[..times.len()];
        let memory = &|i: usize, j: usize| series.memories[j].at(times.as_flattened()[i]);
        contact.law.values(slip, exact.as_flattened_mut(), memory);
        let mut defects = [0.0; GROUPS];
        for (k, defect) in defects.iter_mut().enumerate().take(times.len()) {
            let difference = |i: usize| (exact[k][i] * slip.direction - friction[k][i]).abs();
            let [a, b, c, d] = [0, 1, 2, 3].map(difference);
            // The same as `f64::max`, but faster.
            let larger = |a: f64, b: f64| if a > b { a } else { b };
            let largest = larger(larger(a, b), larger(c, d));
            // Numbers that are not finite are not dropped.
            let nothing = 0.0 * ((a + b) + (c + d));
            let load = if series.load_varies {
                let loads = series.load.at_some(times[k]).map(f64::abs);
                loads.into_iter().fold(0.0, f64::max)
            } else {
                series.load[0].abs()
            };
            *defect = load * (largest + nothing);
        }
        defects
    }

    /// Returns true if the defect of the memory is accepted at the same places, and in slip at
    /// others that approach those where the contact is slowest.
    fn memory_is_accepted(&self) -> bool {
        let slips = matches!(self.state.phase, Phase::Slip { .. });
        if self.series.memories.is_empty()
            || self.state.phase_is_open()
            || slips && self.contact.law.dry_slip(self.series.side).is_some()
        {
            return true;
        }
        let h = self.h;
        let holds = |times| self.memory_holds(times, [h; 4]);
        let checks = Checks::new(h, self.unit);
        let mut accepted = (0..checks.count()).all(|k| holds(checks.group(k)));
        if accepted && slips {
            let speeds = &self.series.speeds;
            let at_quarters = speeds.at_some(quarters(h));
            speeds.about_minima(h, at_quarters, &mut |times| {
                accepted = accepted && holds(times) && self.holds_towards(times[1]);
            });
            if at_quarters[3] < 0.5 * at_quarters[2] {
                accepted = accepted && self.holds_towards(h);
            }
        }
        accepted
    }

    /// Returns true if the series of a contact that slips hold at places that approach the one
    /// where it is slowest.
    ///
    /// The rate of a memory variable is mostly proportional to the sliding speed. A check at speed
    /// 0, or at a much larger speed, therefore does not detect an error at low speeds; such an
    /// error would remain in the memory.
    fn holds_towards(&self, slowest: f64) -> bool {
        let (speeds, h) = (&self.series.speeds, self.h);
        let least = speeds.at(slowest);
        let (sides, ratio) = if slowest < h {
            ([-1.0, 1.0, -NEARER, NEARER], NEARER.powi(2))
        } else {
            ([0, 1, 2, 3].map(|k| -NEARER.powi(k)), NEARER.powi(4))
        };
        let mut distance = FIRST * h;
        while distance > f64::EPSILON * h {
            let times = sides.map(|side| (slowest + side * distance).clamp(0.0, h));
            let lasting = sides.map(|side: f64| side.abs() * distance / NEARER);
            if !(self.memory_holds(times, lasting) && self.friction_holds(times, lasting)) {
                return false;
            }
            // At smaller distances the speed is the same, or the remaining time is too short for an
            // error.
            let is_as_fast = speeds.at(times[3]) <= 2.0 * least;
            if is_as_fast || !self.counts(slowest, times[3], lasting[3]) {
                return true;
            }
            distance *= ratio;
        }
        true
    }

    /// Returns true if the defects of the memory, and of the limit of the stick band, are accepted
    /// at four times, each of which represents an interval of this duration.
    fn memory_holds(&self, times: [f64; 4], lasting: [f64; 4]) -> bool {
        let (series, law) = (self.series, self.contact.law);
        let motions = self.motions_at(times);
        let loads = self.loads_at(times);
        let given = loads.map(|load| load / self.contact.compliance);
        let mut accepted = true;
        if self.state.sticks() {
            let scale = series.largest_bound().max(self.size);
            let allowance = Allowance::new(self.tolerance * scale, scale);
            let bounds = series.bounds.each_ref().map(|bound| bound.at_some(times));
            for i in 0..4 {
                let limits = law.limits(&|j| series.memories[j].at(times[i]));
                let limits = std::iter::zip(limits.iter().flatten(), &bounds);
                for (&limit, bounds) in limits.filter(|(limit, _)| **limit != f64::INFINITY) {
                    let missing = (limit * loads[i] - bounds[i]).abs();
                    accepted &= allowance.accepts([missing; 3], 1.0);
                }
            }
        }
        for i in 0..4 {
            let memory = &|j: usize| series.memories[j].at(times[i]);
            // A defect on a slow manifold displaces the manifold by the defect divided by D.
            let relaxation = match motions[i] {
                Motion::Slip(slip) if series.relaxation > 0.0 => {
                    relaxation(law, (slip, given[i]), memory(0)).max(0.0)
                }
                _ => 0.0,
            };
            let lasting = lasting[i].min(relaxation.recip());
            let mut take = |j: usize, rate: f64| {
                let memory = &series.memories[j];
                let scale = self.memory_scale(j);
                let largest = rate.abs().max(memory[1].abs()).max(relaxation * scale);
                let missing = (memory.slope_at(times[i]) - rate).abs();
                let allowance = Allowance::new(self.tolerance * scale, largest);
                accepted &= allowance.accepts([missing; 3], lasting);
            };
            law.rates(motions[i], given[i], memory, &mut take);
        }
        accepted
    }

    /// Checks the series of friction in slip at four times.
    fn friction_holds(&self, times: [f64; 4], lasting: [f64; 4]) -> bool {
        let motions = self.motions_at(times);
        let (loads, friction) = (self.loads_at(times), self.series.friction.at_some(times));
        (0..4).all(|i| {
            let Motion::Slip(slip) = motions[i] else {
                return true;
            };
            let memory = &|j: usize| self.series.memories[j].at(times[i]);
            let value = self.contact.law.coefficient(slip, memory) * slip.direction;
            let missing = (loads[i] * (value - friction[i])).abs();
            self.allowance
                .accepts([missing; 3], self.lasting(lasting[i]))
        })
    }

    /// Returns true if the largest possible defect that depends on the speed could be rejected
    /// between a time and the place where the contact is slowest.
    ///
    /// If the memory is stationary, the rate is 0 at any speed; with twice the memory it is not 0.
    fn counts(&self, slowest: f64, time: f64, lasting: f64) -> bool {
        let (series, law) = (self.series, self.contact.law);
        let motions = self.motions_at([time, slowest, slowest, slowest]);
        let [Motion::Slip(here), Motion::Slip(there), ..] = motions else {
            return false;
        };
        let mut counts = false;
        let load = self.loads_at([time; 4])[0];
        let given = load / self.contact.compliance;
        for factor in [1.0, 2.0] {
            let memory = &|j: usize| factor * series.memories[j].at(time);
            law.rates(Motion::Slip(here), given, memory, &mut |j, rate| {
                let allowance = Allowance::new(self.tolerance * self.memory_scale(j), 0.0);
                let all = rate.abs() + series.memories[j].slope_at(time).abs();
                counts |= !allowance.accepts([all; 3], lasting);
            });
            let [value, at_slowest] = [here, there].map(|slip| law.coefficient(slip, memory));
            let all = load * (value - at_slowest);
            let lasting = self.lasting(lasting);
            counts |= !self.allowance.accepts([all.abs(); 3], lasting);
        }
        counts
    }

    /// The motion of the contact at four times.
    fn motions_at(&self, times: [f64; 4]) -> [Motion<f64>; 4] {
        if self.state.sticks() {
            return [Motion::Stick; 4];
        }
        let speeds = self.series.speeds.at_some(times);
        speeds.map(|speed| match self.state.slip(speed.max(0.0)) {
            Some(slip) => Motion::Slip(slip),
            None => Motion::Stick,
        })
    }

    /// N at four times.
    fn loads_at(&self, times: [f64; 4]) -> [f64; 4] {
        if self.series.load_varies {
            self.series.load.at_some(times)
        } else {
            [self.series.load[0]; 4]
        }
    }

    /// The size by which errors of a variable of the memory are measured.
    fn memory_scale(&self, j: usize) -> f64 {
        let series = &self.series.memories[j];
        memory_scale(series[0], series, self.memory_units[j], self.h)
    }
}
