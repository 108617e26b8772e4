//! Motions over a duration, without derivatives.

use super::prescribed_modes::{HeldFlow, Hold, Touch};
use super::type_erased_system::GeneralForm;
use crate::error::{Element, Error, Reached};
use crate::motion::{EventKind, Integrator, Mode, Segment};
use crate::state::structure::State;
use crate::structure::{Flow, Step};

/// The state after a duration, and the modes of the contacts afterwards.
pub(super) fn reach(
    form: &GeneralForm<'_>,
    start: &State,
    duration: f64,
) -> Result<(State, Vec<Mode>), Error> {
    let mut reached = None;
    let mut flow = Flow::new(Integrator::new(), form.model.clone(), start)?;
    while let Some(step) = flow.next() {
        let step = step?;
        form.count(&|| Reached::new(step.start_time(), step.state().clone()))?;
        let is_last = step.end_time() >= duration;
        if is_last || reached.is_none() {
            let step = if step.end_time() > duration {
                step.until(duration)
            } else {
                step
            };
            let modes = modes_after(&step, || flow.next())?;
            reached = Some((step.end_state(), modes));
        }
        if is_last {
            break;
        }
    }
    reached.ok_or(Error::InvalidDuration { value: duration })
}

/// The steps of a motion over a duration, and its touches.
pub(super) type StepsAndTouches = (Vec<Step>, Vec<Touch>);

/// The motion over a duration from a state at a time, with contacts held.
pub(super) fn held_steps(
    form: &GeneralForm<'_>,
    (time, start): (f64, &State),
    duration: f64,
    holds: &[Hold],
) -> Result<StepsAndTouches, Error> {
    let settings = Integrator::new().with_max_steps(form.most_of_a_period())?;
    let mut flow = HeldFlow::new(form, settings, time, start, holds)?;
    let mut steps = Vec::new();
    let count = |step: &Step| form.count(&|| Reached::new(step.start_time(), step.state().clone()));
    collect(&mut flow, (time, duration), &mut steps, &count)?;
    Ok((steps, flow.touches))
}

/// Collects the steps of a motion over a duration from a time.
pub(super) fn collect(
    flow: &mut HeldFlow<'_>,
    (time, duration): (f64, f64),
    steps: &mut Vec<Step>,
    count: &dyn Fn(&Step) -> Result<(), Error>,
) -> Result<(), Error> {
    let end_time = time + duration;
    for step in flow {
        let step = step?;
        count(&step)?;
        let is_last = step.end_time() >= end_time;
        steps.push(if step.end_time() > end_time {
            step.until(end_time)
        } else {
            step
        });
        if is_last {
            return Ok(());
        }
    }
    Err(Error::InvalidDuration { value: duration })
}

/// The events of a motion: element and kind.
pub(super) type Events = Vec<(Element, EventKind)>;

/// The events of a motion after its start.
pub(super) fn events_of(steps: &[Step]) -> Events {
    let begins = steps.first().map_or(0.0, Segment::start_time);
    let events = steps.iter().flat_map(Segment::events);
    let events = events.filter(|event| event.time > begins);
    events.map(|event| (event.element, event.kind)).collect()
}

/// The modes of the contacts after a step. A contact that closes sticks or slips, which the next
/// step decides.
pub(super) fn modes_after(
    step: &Step,
    mut next: impl FnMut() -> Option<Result<Step, Error>>,
) -> Result<Vec<Mode>, Error> {
    let mut modes = step.modes().to_vec();
    for event in step.events() {
        if let Some(contact) = event.contact() {
            modes[contact] = event.kind.mode();
        }
    }
    let mut closing = step.events().iter();
    if closing.any(|event| event.kind == EventKind::Close) {
        while let Some(next) = next().transpose()? {
            if next.duration() > 0.0 {
                return Ok(next.modes().to_vec());
            }
        }
    }
    Ok(modes)
}
