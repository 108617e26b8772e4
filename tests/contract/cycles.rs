//! The public contract of `limit_cycle`, `bifurcation` and `analysis`, as tests/contract/belt.rs is
//! that of the rest: every name with its full signature used once, so that an accidental change
//! does not compile.

use std::fmt::{Debug, Display};
use std::ops::Range;

use stick_slip::analysis::averaging::AveragedCycle;
use stick_slip::analysis::{self, PureSlip, Regime, StickSlip};
use stick_slip::bifurcation::{
    self, Along, AttractorKind, Criticality, DiagramPoint, VibrationRange,
};
use stick_slip::limit_cycle::{self, Attractor, Continuum};
use stick_slip::nalgebra::Complex;
use stick_slip::{
    CycleKind, CycleSet, EnergyBudget, Equilibrium, Error, Exponential, LimitCycle, MassOnBelt,
    Polynomial, State, Trajectory,
};

fn value<T: Clone + Debug + PartialEq + Send + Sync + 'static>() {}
fn small<T: Copy + Clone + Debug + PartialEq + Send + Sync + 'static>() {}

fn paper(belt_velocity: f64) -> MassOnBelt<Polynomial> {
    MassOnBelt::new(Polynomial::new(0.4, 0.25, 0.5).unwrap(), belt_velocity)
        .and_then(|system| system.with_damping(0.05))
        .unwrap()
}

#[test]
fn types_have_the_common_traits() {
    value::<LimitCycle>();
    value::<CycleSet>();
    value::<DiagramPoint>();
    value::<Attractor>();
    small::<CycleKind>();
    small::<EnergyBudget>();
    small::<Continuum>();
    small::<Criticality>();
    small::<AttractorKind>();
    value::<VibrationRange>();
    small::<PureSlip>();
    small::<StickSlip>();
    small::<AveragedCycle>();
    small::<Regime>();
    fn shown<T: Display>() {}
    shown::<CycleKind>();
    shown::<Regime>();
}

#[test]
fn limit_cycles() {
    type System = MassOnBelt<Polynomial>;
    let _: fn(&System) -> Result<Option<LimitCycle>, Error> = limit_cycle::stick_slip;
    let _: fn(&System) -> Result<CycleSet, Error> = limit_cycle::find;
    let _: fn(&System, State) -> Result<Attractor, Error> = limit_cycle::attractor;

    let set = limit_cycle::find(&paper(0.2)).unwrap();
    let _: usize = set.len();
    let _: Option<&LimitCycle> = set.iter().next();
    let _: Option<&LimitCycle> = set.stable().next();
    let _: Option<&LimitCycle> = (&set).into_iter().next();
    let _: &[Range<f64>] = set.unresolved();
    if let Some(Continuum { max_amplitude }) = set.continuum() {
        let _: f64 = max_amplitude;
    }
    let numbers: [fn(&LimitCycle) -> f64; 11] = [
        LimitCycle::period,
        LimitCycle::stick_duration,
        LimitCycle::leading_duration,
        LimitCycle::amplitude,
        LimitCycle::max_displacement,
        LimitCycle::min_displacement,
        LimitCycle::max_velocity,
        LimitCycle::min_velocity,
        LimitCycle::mean_displacement,
        LimitCycle::multiplier,
        |cycle| f64::from(u8::from(cycle.is_stable())),
    ];
    let cycle: LimitCycle = set.iter().next().unwrap().clone();
    assert!(numbers.iter().all(|number| number(&cycle).is_finite()));
    let harmonics: Vec<Complex<f64>> = cycle.harmonics(3);
    assert_eq!(harmonics.len(), 3);
    let EnergyBudget {
        drive_work,
        belt_work,
        damper_loss,
        friction_loss,
    } = cycle.energy();
    assert!(
        [drive_work, belt_work, damper_loss, friction_loss]
            .iter()
            .all(|work| *work > 0.0)
    );
    let _: State = cycle.state();
    let _: Trajectory = cycle.trajectory();
    match cycle.kind() {
        CycleKind::PureSlip | CycleKind::Overshoot | CycleKind::Crossing => panic!(),
        CycleKind::StickSlip => {}
    }
}

#[test]
fn bifurcations() {
    type Velocities = fn(&MassOnBelt<Polynomial>, Range<f64>) -> Result<Vec<f64>, Error>;
    let all: [Velocities; 6] = [
        bifurcation::hopf_velocities,
        bifurcation::grazing_velocities,
        bifurcation::touching_velocities,
        bifurcation::fold_velocities,
        bifurcation::overshoot_velocities,
        bifurcation::crossing_velocities,
    ];
    let counts = all.map(|velocities| velocities(&paper(0.2), 0.1..0.6).unwrap().len());
    assert_eq!(counts, [1, 1, 1, 0, 0, 0]);
    let system = paper(0.2);
    let search: Along<'_, Polynomial> =
        bifurcation::along(|load: f64| system.with_load(load), 0.05..0.5);
    type Search = fn(&Along<'_, Polynomial>) -> Result<Vec<f64>, Error>;
    let searches: [Search; 6] = [
        |search| search.hopf(),
        |search| search.grazing(),
        |search| search.touching(),
        |search| search.folds(),
        |search| search.overshoot(),
        |search| search.crossing(),
    ];
    let counts = searches.map(|found| found(&search).unwrap().len());
    assert_eq!(counts[0], 1);
    let ranges: Vec<VibrationRange> = bifurcation::vibration_ranges(&system, 0.1..0.6).unwrap();
    let VibrationRange {
        velocities,
        attractors,
    } = &ranges[0];
    let _: (&Range<f64>, &Vec<AttractorKind>) = (velocities, attractors);
    type Silencing = fn(&MassOnBelt<Polynomial>) -> Result<f64, Error>;
    let silencing: [Silencing; 2] = [bifurcation::silencing_damping, bifurcation::silencing_load];
    assert!(
        silencing
            .iter()
            .all(|silencing| silencing(&system).unwrap() > 0.0)
    );
    let criticality: fn(&MassOnBelt<Polynomial>, f64) -> Criticality = bifurcation::criticality;
    match criticality(&paper(0.2), 0.44) {
        Criticality::Subcritical | Criticality::Degenerate => panic!(),
        Criticality::Supercritical => {}
    }
    let system = paper(0.2);
    let velocities = vec![0.2, 0.42];
    for point in bifurcation::diagram(&system, &velocities) {
        let point: Result<DiagramPoint, Error> = point;
        let DiagramPoint {
            belt_velocity,
            equilibrium,
            cycles,
        } = point.unwrap();
        let _: (f64, Option<Equilibrium>, CycleSet) = (belt_velocity, equilibrium, cycles);
    }
    assert_eq!(bifurcation::diagram(&system, velocities).count(), 2);
    assert_eq!(bifurcation::diagram(&system, [0.2]).count(), 1);
}

#[test]
fn formulas() {
    type System = MassOnBelt<Polynomial>;
    let _: fn(&System) -> Option<Equilibrium> = analysis::equilibrium;
    let _: fn(&System) -> Option<PureSlip> = PureSlip::new;
    let _: fn(&System) -> Option<StickSlip> = StickSlip::new;
    let _: fn(&System) -> Result<Vec<AveragedCycle>, Error> = analysis::averaging::cycles;
    match analysis::regime(&paper(0.2)) {
        Regime::Rest | Regime::Equilibrium | Regime::PureSlip => panic!(),
        Regime::StickSlip => {}
    }
    let pure_slip = PureSlip::new(&paper(0.42)).unwrap();
    let _: [f64; 4] = [
        pure_slip.eta(),
        pure_slip.h1(),
        pure_slip.h2(),
        pure_slip.h3(),
    ];
    let _: [Option<f64>; 3] = [
        pure_slip.amplitude(),
        pure_slip.onset_velocity(),
        pure_slip.stick_velocity(),
    ];
    assert!(pure_slip.is_valid());
    let stick_slip = StickSlip::new(&paper(0.2)).unwrap();
    let _: [f64; 5] = [
        stick_slip.amplitude(),
        stick_slip.stick_duration(),
        stick_slip.slip_duration(),
        stick_slip.period(),
        stick_slip.frequency(),
    ];
    assert!(stick_slip.first_order().is_some() && stick_slip.second_order().is_some());
    let law = Exponential::new(0.4, 0.25, 0.5).unwrap();
    let any_law = StickSlip::new(&MassOnBelt::new(law, 0.2).unwrap()).unwrap();
    assert!(any_law.period() > 6.0);
}
