//! What the engine knows of each coordinate and of each contact.

use super::model::Model;
use crate::clock::Clock;
use crate::motion::Mode;
use crate::scalar::jet::Tape;
use crate::scalar::mul_add;
use crate::series::PowerSeries;
use crate::state::Direction;

/// One coordinate. All forces are divided by its mass.
///
/// Its velocity is v = w + σy. Of a contact that slips, w is the velocity of the surface, σ the
/// sign of r and y the sliding speed: what is integrated, so that contact is exact however fast the
/// surface moves. Of one that sticks σ = 0. Without a contact, or with an open one, w = 0 and σ =
/// 1.
#[derive(Debug, Clone)]
pub(crate) struct Body {
    pub(super) displacement: f64,
    /// y.
    pub(super) speed: f64,
    /// σ.
    pub(super) side: f64,
    /// dy/dt at the start of the step, where it is known better than the equation of motion gives
    /// it: where slip begins.
    pub(super) rate: Option<f64>,
    /// The number of its contact.
    pub(super) contact: Option<usize>,
    pub(super) speeds: PowerSeries,
    /// R: in stick what the contact carries.
    pub(super) carried: PowerSeries,
    /// Whether force or surface ever vary.
    pub(super) is_driven: bool,
    pub(super) force: PowerSeries,
    /// w.
    pub(super) surface: PowerSeries,
}

impl Body {
    pub(super) fn new(displacement: f64, speed: f64, force: f64) -> Self {
        let mut series = PowerSeries::ZERO;
        series[0] = force;
        Self {
            displacement,
            speed,
            side: 1.0,
            rate: None,
            contact: None,
            speeds: PowerSeries::ZERO,
            carried: PowerSeries::ZERO,
            is_driven: false,
            force: series,
            surface: PowerSeries::ZERO,
        }
    }

    /// v.
    pub(super) fn velocity(&self) -> f64 {
        self.surface[0] + self.side * self.speed
    }

    /// Mean of v over [0, t].
    pub(super) fn mean_velocity(&self, t: f64) -> f64 {
        let surface = if self.is_driven {
            self.surface.mean(t)
        } else {
            self.surface[0]
        };
        mul_add(self.side, self.speeds.mean(t), surface)
    }
}

/// What is known of a contact at the bound of its stick band, or of its load.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) enum Edge {
    /// Away from it, as far as is known.
    #[default]
    Away,
    /// On it, to the bit.
    On(Option<Direction>),
    /// On it, and its rate is 0: it was touched.
    Touched(Option<Direction>),
}

impl Edge {
    /// How many coefficients of the distance from the bound are 0.
    pub(super) fn known(self) -> usize {
        match self {
            Self::Away => 0,
            Self::On(_) => 1,
            Self::Touched(_) => 2,
        }
    }
}

/// Why a contact ends a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Firing {
    /// The sliding speed is 0.
    Arrival,
    /// The sliding speed is at a breakpoint of the law, of this number, and rising or not.
    Breakpoint(usize, bool),
    /// The load carried is the largest, in this direction.
    Bound(Direction),
    /// The normal load is 0.
    Load,
}

/// One contact.
#[derive(Debug, Clone)]
pub(crate) struct Joint {
    /// The number of its coordinate.
    pub(super) body: usize,
    pub(super) mode: Mode,
    /// Which piece of the law holds in slip.
    pub(super) piece: usize,
    pub(super) breakpoints: Vec<f64>,
    /// Of the stick band.
    pub(super) edge: Edge,
    /// Of the normal load.
    pub(super) load_edge: Edge,
    /// It has just come to r = 0: on the bound within rounding counts as on it.
    pub(super) fresh: bool,
    /// Where it slipped before it came to r = 0, if it did.
    pub(super) arrived_from: Option<Direction>,
    pub(super) memory: Vec<f64>,
    /// The memory at that moment.
    pub(super) memory_on_arrival: Vec<f64>,
    pub(super) memories: Vec<PowerSeries>,
    /// D, at which the memory relaxes, where its series is that of the slow motion; else 0.
    pub(super) relaxation: f64,
    /// Whether it does so since the last trial.
    pub(super) relaxes_anew: bool,
    /// N/m.
    pub(super) load: PowerSeries,
    /// Its part that is given in time.
    pub(super) drive_load: PowerSeries,
    /// Whether N is not the same at all times.
    pub(super) load_varies: bool,
    /// N μ_s/m; without terms beyond the first for a constant load and a law without memory.
    pub(super) bound: PowerSeries,
    /// σμ in slip.
    pub(super) friction: PowerSeries,
    /// Its derivative by the sliding speed, at the start of the step.
    pub(super) slope: f64,
    /// μ_s, if the law remembers anything.
    pub(super) limits: PowerSeries,
    /// μ_s at the start of the step; `None` for a law that never sticks.
    pub(super) limit: Option<f64>,
    pub(super) tape: Tape,
    /// Since when, and from where, a surface carries its mass along.
    pub(super) carried_from: (Clock, f64),
    /// In the step under way: when it fires first, and why.
    pub(super) firing: Option<(f64, Firing)>,
}

impl Joint {
    /// Not yet decided: see `Engine::start`.
    pub(super) fn new(model: &Model<'_>, number: usize, load: f64, memory: Vec<f64>) -> Self {
        let (contact, laws) = (&model.contacts[number], &model.laws);
        let mut series = PowerSeries::ZERO;
        series[0] = load;
        Self {
            body: contact.coordinate,
            mode: Mode::Stick,
            piece: 0,
            breakpoints: laws.breakpoints(number),
            edge: Edge::Away,
            load_edge: Edge::Away,
            fresh: true,
            arrived_from: None,
            memory_on_arrival: memory.clone(),
            memories: vec![PowerSeries::ZERO; memory.len()],
            relaxation: 0.0,
            relaxes_anew: false,
            load: series,
            drive_load: series,
            load_varies: !contact.load.is_constant() || !contact.load_gradient.is_empty(),
            bound: PowerSeries::ZERO,
            friction: PowerSeries::ZERO,
            slope: 0.0,
            limits: PowerSeries::ZERO,
            limit: laws.limit(number, &|j| memory[j]),
            tape: Tape::new(),
            carried_from: (Clock::default(), 0.0),
            firing: None,
            memory,
        }
    }

    /// The direction of slip; `None` in any other mode.
    pub(super) fn direction(&self) -> Option<Direction> {
        match self.mode {
            Mode::Slip(direction) => Some(direction),
            Mode::Stick | Mode::Open => None,
        }
    }

    /// μ_s at the start of the step, 0 for a law that never sticks.
    pub(super) fn static_coefficient(&self) -> f64 {
        self.limit.unwrap_or(0.0)
    }

    /// The piece of the law just above a sliding speed.
    pub(super) fn piece_above(&self, speed: f64) -> usize {
        self.breakpoints.partition_point(|&b| b <= speed)
    }
}
