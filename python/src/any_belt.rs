//! A mass on a belt without the types of its units and its law.

use std::any::Any;
use std::ops::Range;
use std::sync::Arc;

use stick_slip::bifurcation::{self, Along, Criticality, DiagramPoint, VibrationRange};
use stick_slip::limit_cycle::{self, Attractor};
use stick_slip::{
    CycleSet, Error, FrictionLaw, Integrator, LimitCycle, MassOnBelt, PhysicalMassOnBelt, Scaled,
    Search, State, Step, Structure, Trajectory,
};

/// A search along a parameter, by its name in Python.
#[derive(Clone, Copy)]
pub enum Border {
    Hopf,
    Grazing,
    Touching,
    Overshoot,
    Crossing,
    Folds,
}

impl Border {
    fn of<L: FrictionLaw>(self, along: &Along<'_, L>) -> Result<Vec<f64>, Error> {
        match self {
            Self::Hopf => along.hopf(),
            Self::Grazing => along.grazing(),
            Self::Touching => along.touching(),
            Self::Overshoot => along.overshoot(),
            Self::Crossing => along.crossing(),
            Self::Folds => along.folds(),
        }
    }
}

/// What a search along a parameter of a family asks for.
#[derive(Clone, Copy)]
pub enum Question {
    Border(Border),
    Ranges,
    Silence,
}

/// Its answer.
pub enum Answer {
    Values(Vec<f64>),
    Ranges(Vec<VibrationRange>),
    Value(Option<f64>),
}

impl Question {
    fn of<L: FrictionLaw>(self, along: &Along<'_, L>) -> Result<Answer, Error> {
        Ok(match self {
            Self::Border(border) => Answer::Values(border.of(along)?),
            Self::Ranges => Answer::Ranges(along.vibration_ranges()?),
            Self::Silence => Answer::Value(along.silence()?),
        })
    }
}

/// The damping, load or stiffness at which a system falls silent.
#[derive(Clone, Copy)]
pub enum Silencing {
    Damping,
    Load,
    Stiffness,
}

/// A family of systems along a parameter.
pub type BeltFamily<'f> = dyn Fn(f64) -> Result<Arc<dyn Belt>, Error> + 'f;

/// A mass on a belt in either system of units with a law of either kind.
pub trait Belt: Send + Sync + 'static {
    fn simulate_until(
        &self,
        integrator: Integrator,
        start: State,
        duration: f64,
        stop: &mut dyn FnMut(&Step) -> Option<f64>,
    ) -> Result<Trajectory, Error>;
    fn stick_limits(&self) -> [f64; 2];
    fn release_state(&self) -> Option<State>;
    fn friction_force(&self, state: State) -> f64;
    fn acceleration(&self, state: State) -> f64;
    fn equilibrium(&self) -> Option<stick_slip::Equilibrium>;
    fn structure(&self) -> Result<Structure, Error>;
    fn cycles(&self) -> Result<CycleSet, Error>;
    fn stick_slip(&self) -> Result<Option<LimitCycle>, Error>;
    fn attractors(&self, starts: &[State]) -> Result<Vec<Attractor>, Error>;
    fn velocities(
        &self,
        border: Border,
        range: Range<f64>,
        search: Search<'_>,
    ) -> Result<Vec<f64>, Error>;
    fn ranges(&self, range: Range<f64>, search: Search<'_>) -> Result<Vec<VibrationRange>, Error>;
    /// The belt velocity that searches report as 1.
    fn velocity_unit(&self) -> f64;
    fn criticality(&self, velocity: f64) -> Criticality;
    fn point(&self, velocity: f64) -> Result<DiagramPoint, Error>;
    fn silencing(&self, of: Silencing) -> Result<f64, Error>;
    /// A search of a family to which this system belongs.
    fn along(
        &self,
        question: Question,
        family: &BeltFamily<'_>,
        range: Range<f64>,
        name: &'static str,
        search: Search<'_>,
    ) -> Result<Answer, Error>;
    fn any(&self) -> &dyn Any;
}

/// A system whose law cannot be that of the rest of its family.
fn other_kind() -> Error {
    Error::InvalidParameter {
        of: "family",
        name: "law",
        value: f64::NAN,
        allowed: "laws of one's own throughout, or laws of the package throughout, in one system \
                  of units",
    }
}

impl<L: FrictionLaw + Clone + Send + Sync + 'static> Belt for MassOnBelt<L> {
    fn simulate_until(
        &self,
        integrator: Integrator,
        start: State,
        duration: f64,
        stop: &mut dyn FnMut(&Step) -> Option<f64>,
    ) -> Result<Trajectory, Error> {
        integrator.simulate_until(self, start, duration, stop)
    }
    fn stick_limits(&self) -> [f64; 2] {
        self.stick_limits()
    }
    fn release_state(&self) -> Option<State> {
        self.release_state()
    }
    fn friction_force(&self, state: State) -> f64 {
        self.friction_force(state)
    }
    fn acceleration(&self, state: State) -> f64 {
        self.acceleration(state)
    }
    fn equilibrium(&self) -> Option<stick_slip::Equilibrium> {
        self.equilibrium()
    }
    fn structure(&self) -> Result<Structure, Error> {
        Ok(Structure::from(self))
    }
    fn cycles(&self) -> Result<CycleSet, Error> {
        limit_cycle::find(self)
    }
    fn stick_slip(&self) -> Result<Option<LimitCycle>, Error> {
        limit_cycle::stick_slip(self)
    }
    fn attractors(&self, starts: &[State]) -> Result<Vec<Attractor>, Error> {
        let basins = limit_cycle::basins(self)?;
        starts
            .iter()
            .map(|start| basins.attractor(*start))
            .collect()
    }
    fn velocities(
        &self,
        border: Border,
        range: Range<f64>,
        search: Search<'_>,
    ) -> Result<Vec<f64>, Error> {
        border.of(&bifurcation::along_velocities(self, range).with_search(search))
    }
    fn ranges(&self, range: Range<f64>, search: Search<'_>) -> Result<Vec<VibrationRange>, Error> {
        bifurcation::along_velocities(self, range)
            .with_search(search)
            .vibration_ranges()
    }
    fn velocity_unit(&self) -> f64 {
        1.0
    }
    fn criticality(&self, velocity: f64) -> Criticality {
        bifurcation::criticality(self, velocity)
    }
    fn point(&self, velocity: f64) -> Result<DiagramPoint, Error> {
        bifurcation::diagram(self, [velocity])
            .next()
            .expect("one velocity, one point")
    }
    fn silencing(&self, of: Silencing) -> Result<f64, Error> {
        match of {
            Silencing::Damping => bifurcation::silencing_damping(self),
            Silencing::Load => bifurcation::silencing_load(self),
            Silencing::Stiffness => bifurcation::silencing_stiffness(self),
        }
    }
    fn along(
        &self,
        question: Question,
        family: &BeltFamily<'_>,
        range: Range<f64>,
        name: &'static str,
        search: Search<'_>,
    ) -> Result<Answer, Error> {
        let family = |value: f64| {
            let system = family(value)?;
            system
                .any()
                .downcast_ref::<Self>()
                .cloned()
                .ok_or_else(other_kind)
        };
        question.of(&bifurcation::along(family, range)
            .named(name)
            .with_search(search))
    }
    fn any(&self) -> &dyn Any {
        self
    }
}

impl<L: FrictionLaw + Clone + Send + Sync + 'static> Belt for PhysicalMassOnBelt<L> {
    fn simulate_until(
        &self,
        integrator: Integrator,
        start: State,
        duration: f64,
        stop: &mut dyn FnMut(&Step) -> Option<f64>,
    ) -> Result<Trajectory, Error> {
        self.simulate_until(integrator, start, duration, stop)
    }
    fn stick_limits(&self) -> [f64; 2] {
        self.stick_limits()
    }
    fn release_state(&self) -> Option<State> {
        self.release_state()
    }
    fn friction_force(&self, state: State) -> f64 {
        self.friction_force(state)
    }
    fn acceleration(&self, state: State) -> f64 {
        self.acceleration(state)
    }
    fn equilibrium(&self) -> Option<stick_slip::Equilibrium> {
        self.equilibrium()
    }
    fn structure(&self) -> Result<Structure, Error> {
        Structure::try_from(self)
    }
    fn cycles(&self) -> Result<CycleSet, Error> {
        self.cycles()
    }
    fn stick_slip(&self) -> Result<Option<LimitCycle>, Error> {
        self.stick_slip()
    }
    fn attractors(&self, starts: &[State]) -> Result<Vec<Attractor>, Error> {
        let basins = self.basins()?;
        starts
            .iter()
            .map(|start| basins.attractor(*start))
            .collect()
    }
    fn velocities(
        &self,
        border: Border,
        range: Range<f64>,
        search: Search<'_>,
    ) -> Result<Vec<f64>, Error> {
        let along = |system: &MassOnBelt<Scaled<L>>, range| {
            border.of(&bifurcation::along_velocities(system, range).with_search(search))
        };
        self.velocities(along, range)
    }
    fn ranges(&self, range: Range<f64>, search: Search<'_>) -> Result<Vec<VibrationRange>, Error> {
        let mut found = Vec::new();
        let along = |system: &MassOnBelt<Scaled<L>>, range| {
            let along = bifurcation::along_velocities(system, range).with_search(search);
            found = along.vibration_ranges()?;
            let borders = found.iter().map(|range| &range.velocities);
            Ok(borders.flat_map(|it| [it.start, it.end]).collect())
        };
        let borders = self.velocities(along, range)?;
        for (range, borders) in found.iter_mut().zip(borders.chunks(2)) {
            range.velocities = borders[0]..borders[1];
        }
        Ok(found)
    }
    fn velocity_unit(&self) -> f64 {
        self.scaling().metres_per_second(1.0)
    }
    fn criticality(&self, velocity: f64) -> Criticality {
        self.criticality(velocity)
    }
    fn point(&self, velocity: f64) -> Result<DiagramPoint, Error> {
        self.diagram([velocity])
            .next()
            .expect("one velocity, one point")
    }
    fn silencing(&self, of: Silencing) -> Result<f64, Error> {
        match of {
            Silencing::Damping => self.silencing_damping(),
            Silencing::Load => self.silencing_load(),
            Silencing::Stiffness => self.silencing_stiffness(),
        }
    }
    fn along(
        &self,
        question: Question,
        family: &BeltFamily<'_>,
        range: Range<f64>,
        name: &'static str,
        search: Search<'_>,
    ) -> Result<Answer, Error> {
        let family = |value: f64| {
            let system = family(value)?;
            let system = system.any().downcast_ref::<Self>().ok_or_else(other_kind)?;
            Ok(system.dimensionless().clone())
        };
        question.of(&bifurcation::along(family, range)
            .named(name)
            .with_search(search))
    }
    fn any(&self) -> &dyn Any {
        self
    }
}
