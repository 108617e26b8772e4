//! Searches within bounds: how they end, what a watcher sees, and what is kept.

use std::cell::{Cell, RefCell};
use std::ops::ControlFlow::{Break, Continue};

use stick_slip::orbit::{
    BifurcationKind, BranchEnd, Locus, LocusEnd, Orbit, Period, Progress, Search, follow, locus,
    sensitivities, settle, shoot,
};
use stick_slip::structure::State;
use stick_slip::{Error, Structure};

use crate::common::masses::driven as family;
use crate::common::refused;

fn driven(frequency: f64) -> Result<Structure, Error> {
    family(frequency, 0.3)
}

fn start() -> State {
    State::new(&[0.3], &[0.0])
}

fn motion() -> Orbit<State> {
    settle(&driven(0.78).unwrap(), &start(), 400.0, Period::Driven(1)).unwrap()
}

/// The bound counts the steps of all motions of a search, and is met to the step.
#[test]
fn steps_are_bounded_on_one_system() {
    let system = driven(0.78).unwrap();
    let search = |most: usize| Search::new().with_max_steps(most).unwrap();
    let (period, orbit) = (Period::Driven(1), motion());
    for most in [1, 100] {
        let settled = search(most)
            .settle(&system, &start(), 1e12, period)
            .map(drop);
        let exponent = search(most).lyapunov_with_spread(&system, &start(), 1.0, 1e12);
        for found in [settled, exponent.map(drop)] {
            let Err(Error::TooManySteps { limit, reached }) = found else {
                panic!("{found:?}")
            };
            assert_eq!(limit, most);
            assert!(reached.time < 1e3);
        }
    }
    // Enough is enough, and the result does not depend on the bound.
    let same = search(1000).shoot(&system, &orbit.state(), period).unwrap();
    assert!(same == shoot(&system, &orbit.state(), period).unwrap());
}

/// A bound may be larger than the default, too.
#[test]
#[ignore = "a full count: a run of two million steps"]
fn a_bound_may_be_larger_than_the_default() {
    let system = driven(0.78).unwrap();
    let search = |most: usize| Search::new().with_max_steps(most).unwrap();
    let more = search(2 * Search::DEFAULT_MAX_STEPS);
    let found = more.lyapunov_with_spread(&system, &start(), 0.0, 1e12);
    let Err(Error::TooManySteps { limit, reached }) = found else {
        panic!("{found:?}")
    };
    assert_eq!(limit, 2 * Search::DEFAULT_MAX_STEPS);
    assert!(reached.time > 2e5);
}

#[test]
fn a_watcher_stops_a_search_on_one_system() {
    let system = driven(0.78).unwrap();
    let calls = Cell::new(0);
    let search = Search::new().watched(|progress| {
        calls.set(calls.get() + 1);
        assert_eq!(progress.points, 0);
        if progress.value < 1e4 {
            Continue(())
        } else {
            Break(())
        }
    });
    let period = Period::Driven(1);
    let settled = search.settle(&system, &start(), 1e12, period).map(drop);
    let exponent = search.lyapunov_with_spread(&system, &start(), 1e12, 1e12);
    for found in [settled, exponent.map(drop)] {
        let Err(Error::Stopped {
            parameter,
            value,
            steps,
            found,
        }) = found
        else {
            panic!("{found:?}")
        };
        assert_eq!((parameter, found), ("time", vec![]));
        assert!((1e4..1.1e4).contains(&value), "{value}");
        assert!(steps.is_multiple_of(1000) && calls.get() >= steps / 1000);
    }
    let never = Search::new().watched(|_| Break(()));
    refused!(never.shoot(&system, &start(), period) => Error::Stopped { steps: 0, .. });
    refused!(never.follow(driven, 0.78, &motion(), 0.7..0.8) => Error::Stopped { steps: 0, .. });
}

/// All motions of derivatives by parameters count, and the watcher sees their steps.
#[test]
fn derivatives_by_parameters_are_bounded_and_watched() {
    let family = |p: &[f64]| Ok((driven(p[0])?, start()));
    let system = |p: &[f64]| driven(p[0]);
    let most = |most: usize| Search::new().with_max_steps(most).unwrap();
    let seen = Cell::new(0);
    let watched = Search::new().watched(|progress| {
        assert!(progress.steps >= seen.get() && progress.value <= 404.0);
        seen.set(progress.steps);
        Continue(())
    });
    let whole = watched.sensitivities(family, &[0.78], 400.0).unwrap();
    let same = sensitivities(family, &[0.78], 400.0).unwrap();
    assert_eq!(whole.at(400.0), same.at(400.0));
    assert!(seen.get() >= 2000);
    let orbit = motion();
    for limit in [1, 100, seen.get()] {
        let found = most(limit).sensitivities(family, &[0.78], 400.0);
        let of_orbit = most(limit.min(100)).orbit_sensitivities(system, &[0.78], &orbit);
        for (found, limit) in [
            (found.map(drop), limit),
            (of_orbit.map(drop), limit.min(100)),
        ] {
            let Err(Error::TooManySteps { limit: met, .. }) = found else {
                panic!("{found:?}")
            };
            assert_eq!(met, limit);
        }
    }
    let stopped = Search::new().watched(|progress| {
        if progress.steps < 1000 {
            Continue(())
        } else {
            Break(())
        }
    });
    let found = stopped.sensitivities(family, &[0.78], 400.0).map(drop);
    let Err(Error::Stopped { parameter, .. }) = found else {
        panic!("{found:?}")
    };
    assert_eq!(parameter, "time");
    let never = Search::new().watched(|_| Break(()));
    refused!(never.orbit_sensitivities(system, &[0.78], &orbit) => Error::Stopped { steps: 0, .. });
}

/// A branch that is stopped is the beginning of the whole one, to the bit.
#[test]
fn a_branch_keeps_what_was_found() {
    let (range, orbit) = (0.7..0.8, motion());
    let whole = follow(driven, 0.78, &orbit, range.clone()).unwrap();
    let seen: RefCell<Vec<Progress>> = RefCell::new(Vec::new());
    let watched = Search::new().watched(|progress| {
        seen.borrow_mut().push(*progress);
        Continue(())
    });
    let same = watched.follow(driven, 0.78, &orbit, range.clone()).unwrap();
    assert_eq!(same.ends, whole.ends);
    assert_eq!(same.points.len(), whole.points.len());
    let seen = seen.borrow();
    for pair in seen.windows(2) {
        assert!(pair[0].points <= pair[1].points && pair[0].steps <= pair[1].steps);
    }
    assert!(seen.iter().all(|progress| range.contains(&progress.value)
        || (progress.value - range.end).abs() < 1e-3
        || (progress.value - range.start).abs() < 1e-3));
    assert_eq!(seen.last().unwrap().points, whole.points.len() - 1);

    let parameters = |points: &[stick_slip::orbit::BranchPoint<State>]| -> Vec<f64> {
        points.iter().map(|point| point.parameter).collect()
    };
    let known = parameters(&whole.points);
    let most = whole.points.len() - 1;
    for points in [1, most / 2, most - 1] {
        let stopped = Search::new().watched(move |progress| {
            if progress.points < points {
                Continue(())
            } else {
                Break(())
            }
        });
        let part = stopped.follow(driven, 0.78, &orbit, range.clone()).unwrap();
        let found = parameters(&part.points);
        assert_eq!(found.len(), points + 1);
        assert!(
            known.windows(found.len()).any(|known| known == found),
            "{found:?}"
        );
        assert!(
            part.ends
                .iter()
                .any(|end| matches!(end, BranchEnd::Stopped { .. }))
        );
    }
    // Bounds of points and of steps: in each direction.
    let few = Search::new().with_max_points(3).unwrap();
    let part = few.follow(driven, 0.78, &orbit, range.clone()).unwrap();
    assert_eq!(part.ends, [BranchEnd::Work, BranchEnd::Work]);
    assert_eq!(part.points.len(), 7);
    let short = Search::new().with_max_steps(150).unwrap();
    let part = short.follow(driven, 0.78, &orbit, range).unwrap();
    assert_eq!(part.ends, [BranchEnd::Work, BranchEnd::Work]);
    assert!(part.points.len() > 3 && part.points.len() < whole.points.len());
    // The branch behind a flip, and one of a Hopf point.
    let mut found = whole.bifurcations.iter();
    let flip = found
        .find(|found| found.kind == BifurcationKind::Flip)
        .unwrap();
    let watched = Search::new().watched(|_| Continue(()));
    let born = watched.switch(flip, driven).unwrap();
    assert_eq!(born.parameter, flip.switch(driven).unwrap().parameter);
    let never = Search::new().watched(|_| Break(()));
    let found = never.switch(flip, driven).map(drop);
    assert!(found.unwrap_err().to_string().contains("stopped"));
}

/// A curve in two parameters within bounds: it is the begin of the whole one.
#[test]
fn a_locus_is_bounded_and_watched() {
    let branch = follow(driven, 0.78, &motion(), 0.7..0.8).unwrap();
    let flip = &branch.bifurcations[0];
    let ranges = [0.72..0.9, 0.1..0.5];
    let whole = locus(family, flip, 0.3, ranges.clone()).unwrap();
    let places = |locus: &Locus<State>| -> Vec<[f64; 2]> {
        locus.points.iter().map(|point| point.parameters).collect()
    };
    let all = places(&whole);
    let is_part = |part: &Locus<State>| {
        let part = places(part);
        all.windows(part.len()).any(|window| window == part)
    };
    let three = Search::new().with_max_points(3).unwrap();
    let part = three.locus(family, flip, 0.3, ranges.clone()).unwrap();
    assert_eq!(part.ends, [LocusEnd::Work, LocusEnd::Work]);
    assert!(part.points.len() == 7 && is_part(&part));
    let short = Search::new().with_max_steps(2000).unwrap();
    let part = short.locus(family, flip, 0.3, ranges.clone()).unwrap();
    assert!(part.ends.contains(&LocusEnd::Work), "{:?}", part.ends);
    assert!(part.points.len() > 1 && is_part(&part));
    // A watcher sees both parameters, and can stop the search.
    let seen = Cell::new(0);
    let search = Search::new().watched(|progress| {
        // Those of differences lie a little outside the rectangle.
        assert!((0.719..0.901).contains(&progress.value));
        assert!((0.099..0.501).contains(&progress.second.unwrap()));
        seen.set(progress.points);
        if progress.points < 5 {
            Continue(())
        } else {
            Break(())
        }
    });
    let part = search.locus(family, flip, 0.3, ranges.clone()).unwrap();
    assert!(part.points.len() == 6 && is_part(&part) && seen.get() == 5);
    let stopped = |end: &LocusEnd| matches!(end, LocusEnd::Stopped { .. });
    assert!(part.ends.iter().all(stopped), "{:?}", part.ends);
    let never = Search::new().watched(|_| Break(()));
    let error = never.locus(family, flip, 0.3, ranges).unwrap_err();
    assert!(error.to_string().contains("stopped"), "{error}");
}
