//! A flow allocates nothing after its first step, whatever the law; that of a structure no more
//! than the step that it hands out. A branch keeps its results alone.
//!
//! Only an allocator of its own can count, and the trait of allocators is unsafe: this one file may
//! write `unsafe`.
#![allow(unsafe_code)]

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use stick_slip::orbit::{self, Period};
use stick_slip::{
    AnyContactLaw, Contact, Coulomb, Drive, Dwell, Exponential, ForceElement, FrictionLaw,
    Integrator, LuGre, MassOnBelt, Pendulum, PolynomialSpring, Scalar, Segment, State, Structure,
    structure,
};
use stick_slip_tests_common::{Decay, Leine, Table, friction_law, paper};

/// Counts what this thread asks for; other threads of the test runner do not disturb.
struct Counting;

thread_local! {
    static CALLS: Cell<usize> = const { Cell::new(0) };
    /// Bytes in use, and the most that there were.
    static BYTES: Cell<isize> = const { Cell::new(0) };
    static MOST_BYTES: Cell<isize> = const { Cell::new(0) };
}

/// Counts a call that takes a number of bytes and gives another back.
fn count(taken: usize, given: usize) {
    CALLS.set(CALLS.get() + 1);
    BYTES.set(BYTES.get() + taken.cast_signed() - given.cast_signed());
    MOST_BYTES.set(MOST_BYTES.get().max(BYTES.get()));
}

// SAFETY: every call is passed on to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count(layout.size(), 0);
        // SAFETY: the caller keeps the contract of `alloc`.
        unsafe { System.alloc(layout) }
    }
    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        count(0, layout.size());
        // SAFETY: the caller keeps the contract of `dealloc`.
        unsafe { System.dealloc(pointer, layout) }
    }
    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count(size, layout.size());
        // SAFETY: the caller keeps the contract of `realloc`.
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

friction_law! {
    /// Far more operations than the crate keeps rows for in place: each round is eight.
    Long: 0.5,
    |s| {
        let mut fall = s;
        for _ in 0..5 {
            fall = (fall.tanh() + s * s).sin().atan() * (s.cos() + 2.0) * 0.3;
        }
        -(fall * 0.1) + 0.5
    }
}

/// Calls of the allocator while a flow takes `n` steps, after `before` first steps.
fn calls<L: FrictionLaw>(system: &MassOnBelt<L>, before: usize, n: usize) -> usize {
    let mut flow = Integrator::new()
        .flow(system, State::new(0.0, 0.0))
        .unwrap();
    for _ in 0..before {
        flow.next().unwrap().unwrap();
    }
    let start = CALLS.get();
    let mut events = 0;
    for _ in 0..n {
        events += usize::from(flow.next().unwrap().unwrap().event().is_some());
    }
    let calls = CALLS.get() - start;
    assert!(events > 20, "{events} events: the motion sticks and slips");
    calls
}

#[test]
fn the_counter_counts() {
    let start = CALLS.get();
    drop(std::hint::black_box(vec![1.0_f64; 100]));
    assert_eq!(CALLS.get() - start, 2);
}

#[test]
fn a_flow_allocates_nothing_after_its_first_step() {
    const STEPS: usize = 2000;
    assert_eq!(calls(&paper(0.2), 1, STEPS), 0);
    let exponential = Exponential::new(0.4, 0.25, 0.05).unwrap();
    assert_eq!(
        calls(&MassOnBelt::new(exponential, 0.2).unwrap(), 1, STEPS),
        0
    );
    let coulomb = Coulomb::new(0.4, 0.25).unwrap();
    assert_eq!(calls(&MassOnBelt::new(coulomb, 0.2).unwrap(), 1, STEPS), 0);
    let leine = Leine {
        static_coefficient: 1.0,
        decay: 3.0,
    };
    assert_eq!(calls(&MassOnBelt::new(leine, 0.2).unwrap(), 1, STEPS), 0);
    let decay = Decay {
        static_coefficient: 0.6,
        kinetic_coefficient: 0.3,
        velocity: 0.1,
    };
    assert_eq!(calls(&MassOnBelt::new(decay, 0.3).unwrap(), 1, STEPS), 0);
    assert_eq!(calls(&MassOnBelt::new(Long, 0.1).unwrap(), 1, STEPS), 0);
    let table = Table {
        static_coefficient: 0.5,
        points: vec![
            (0.0, 0.45),
            (0.125, 0.3),
            (0.375, 0.25),
            (0.75, 0.35),
            (1.0, 0.2),
            (2.0, 0.6),
        ],
    };
    assert_eq!(calls(&MassOnBelt::new(table, 0.2).unwrap(), 1, STEPS), 0);
}

/// A law whose pieces differ in length may grow its memory when a piece is first entered, and never
/// again.
#[test]
fn a_law_with_pieces_of_different_length_stops_allocating() {
    #[derive(Debug)]
    struct Pieces;
    impl FrictionLaw for Pieces {
        fn static_coefficient(&self) -> f64 {
            0.5
        }
        fn kinetic<S: Scalar>(&self, speed: S) -> S {
            self.kinetic_on(usize::from(speed.value() >= 0.125), speed)
        }
        fn breakpoints(&self) -> impl Iterator<Item = f64> {
            std::iter::once(0.125)
        }
        fn kinetic_on<S: Scalar>(&self, piece: usize, speed: S) -> S {
            match piece {
                0 => -speed + 0.5,
                _ => Long.kinetic(speed) - Long.kinetic(0.125) + 0.375,
            }
        }
    }
    let system = MassOnBelt::new(Pieces, 0.2).unwrap();
    assert_eq!(calls(&system, 100, 2000), 0);
}

/// As many calls as a clone of the step makes: nothing but what the step itself holds, unless it
/// ends with an event.
#[test]
fn a_structure_allocates_the_steps_alone() {
    let dry = Coulomb::new(0.4, 0.3).unwrap();
    let laws: [AnyContactLaw<Coulomb>; 3] = [
        Dwell::exponential(dry, 0.6, 0.5).unwrap().into(),
        LuGre::new(dry, 30.0, 0.3, 0.01).unwrap().into(),
        AnyContactLaw::Dry(dry),
    ];
    let n = 12;
    let mut chain = Structure::new(&vec![1.0; n]).unwrap();
    for i in 0..n {
        let belt = Drive::sine(0.2, 0.7).unwrap().with_constant(0.1).unwrap();
        let mut load: Drive = 1.0.into();
        if i % 4 == 1 {
            load = Drive::sine(1.2, 0.5).unwrap().with_constant(1.0).unwrap();
        }
        let contact = Contact::new(i, laws[i % 3].clone(), load).unwrap();
        chain = chain
            .with_ground_spring(i, 1.0)
            .and_then(|chain| chain.with_ground_damper(i, 0.1))
            .and_then(|chain| chain.with_force(i, Drive::sine(0.3, 0.3 + 0.1 * i as f64)?))
            .and_then(|chain| chain.with_contact(contact.on_belt(belt)))
            .unwrap();
        if i > 0 {
            chain = chain.with_spring(i - 1, i, 0.5).unwrap();
        }
    }
    let start = structure::State::at_rest(n);
    let mut flow = Integrator::new().flow(&chain, start).unwrap();
    flow.next().unwrap().unwrap();
    let mut events = 0;
    for _ in 0..2000 {
        let before = CALLS.get();
        let step = flow.next().unwrap().unwrap();
        let made = CALLS.get();
        let copy = std::hint::black_box(step.clone());
        let (made, copied) = (made - before, CALLS.get() - made);
        // What happens at an event is compared with the state there, which is made for that. The
        // modes after it are lists that the next steps share.
        const MODES: usize = 6;
        if copy.events().is_empty() {
            assert_eq!(made, copied);
        } else {
            assert!(
                made <= 2 * copied + MODES,
                "{made} and {copied}: {:?}",
                copy.events()
            );
        }
        events += step.events().len();
    }
    assert!(events > 200, "{events}");
}

/// Force elements allocate one list for the time unit of a step, and nothing for their forces.
#[test]
fn force_elements_allocate_a_list_for_each_step() {
    let spring = PolynomialSpring::new(&[0.5, 0.0, 0.8]).unwrap();
    let factor = Drive::sine(0.2, 0.7).unwrap().with_constant(1.0).unwrap();
    let mesh = ForceElement::between(0, 1, spring).unwrap();
    let pendulum = Pendulum::new(1.0, 1.0).unwrap();
    let belt = Contact::new(0, Exponential::new(0.4, 0.25, 0.3).unwrap(), 1.0).unwrap();
    let structure = Structure::new(&[1.0, 2.0])
        .and_then(|structure| structure.with_contact(belt.on_belt(0.2)))
        .and_then(|structure| structure.with_element(mesh.with_factor(factor)?))
        .and_then(|structure| structure.with_element(ForceElement::new(1, pendulum)?))
        .unwrap();
    let start = structure::State::at_rest(2);
    let mut flow = Integrator::new().flow(&structure, start).unwrap();
    for _ in 0..10 {
        flow.next().unwrap().unwrap();
    }
    for _ in 0..500 {
        let before = CALLS.get();
        let step = flow.next().unwrap().unwrap();
        let made = CALLS.get();
        let copy = std::hint::black_box(step.clone());
        let (made, copied) = (made - before, CALLS.get() - made);
        if copy.events().is_empty() {
            // Two calls: the list is made and freed.
            assert!(made <= copied + 2, "{made} and {copied}");
        }
    }
}

/// The steps of the motions along a branch would fill 30 times as much as its results.
#[test]
fn a_branch_keeps_its_results_alone() {
    const MASSES: usize = 10;
    let chain = |frequency: f64| {
        let mut chain = Structure::new(&[1.0; MASSES])?
            .with_ground_spring(0, 1.0)?
            .with_force(MASSES - 1, Drive::sine(1.0, frequency)?)?;
        for i in 0..MASSES {
            let contact = Contact::new(i, Coulomb::new(0.3, 0.2)?, 0.1)?;
            chain = chain.with_ground_damper(i, 0.1)?.with_contact(contact)?;
            if i > 0 {
                chain = chain.with_spring(i - 1, i, 1.0)?;
            }
        }
        Ok::<_, stick_slip::Error>(chain)
    };
    let rest = structure::State::at_rest(MASSES);
    let first = orbit::settle(&chain(0.5).unwrap(), &rest, 400.0, Period::Driven(1)).unwrap();
    let steps = first.trajectory().steps().len();
    let series = steps * MASSES * 27 * size_of::<f64>();
    let before = BYTES.get();
    MOST_BYTES.set(before);
    let branch = orbit::follow(chain, 0.5, &first, 0.45..0.55).unwrap();
    let [kept, most] = [BYTES.get(), MOST_BYTES.get()].map(|bytes| (bytes - before) as usize);
    let motions = branch.points.len() + branch.bifurcations.len();
    println!("{motions} motions: {kept} bytes, {most} on the way; {series} for the series of one");
    assert!(motions > 60);
    assert!(kept / motions < series / 2);
    assert!(most < 2 * kept + 60 * series);
}
