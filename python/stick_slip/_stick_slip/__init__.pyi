# Arrays of NumPy before 2.3 overlap with numbers.
# mypy: disable-error-code="overload-overlap"

from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING, Any, final, overload

import numpy as np
import numpy.typing as npt
from numpy.typing import ArrayLike
from typing_extensions import disjoint_base

from stick_slip._state import State
from stick_slip._stick_slip import analysis as analysis
from stick_slip.typing import (
    Array, Belt, ComplexArray, DirectionLike, StateLike, System,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = [
    "Along",
    "Attractor",
    "Backlash",
    "BeltAttractor",
    "Bifurcation",
    "Branch",
    "BranchEnd",
    "BranchPoint",
    "Capstan",
    "Carried",
    "Change",
    "Contact",
    "ContactLaw",
    "Coulomb",
    "CycleEnergy",
    "CycleSet",
    "Dahl",
    "Diagram",
    "DiagramPoint",
    "Directional",
    "Drive",
    "Dwell",
    "EnergyBudget",
    "Equilibrium",
    "EventSensitivity",
    "Exponential",
    "FirstOrder",
    "ForceElement",
    "ForceLaw",
    "Freewheel",
    "HopfLocus",
    "HopfPoint",
    "Iwan4",
    "Law",
    "LimitCycle",
    "Locus",
    "LocusEnd",
    "LocusPoint",
    "LuGre",
    "LyapunovExponent",
    "MassOnBelt",
    "Mechanism",
    "Motion",
    "Orbit",
    "OrbitSensitivities",
    "Passage",
    "Pendulum",
    "PhysicalMassOnBelt",
    "Polynomial",
    "PolynomialSpring",
    "Progress",
    "RateState",
    "Rational",
    "Samples",
    "Scaled",
    "Sensitivities",
    "SnapThrough",
    "SpecialPoint",
    "StabilityChange",
    "SteadySliding",
    "Stop",
    "Stribeck",
    "Structure",
    "Sweep",
    "SweepPoint",
    "Tabulated",
    "TabulatedForce",
    "VanDerPol",
    "VibrationRange",
    "VibrationRanges",
    "along",
    "analysis",
    "attractor",
    "begin",
    "classify",
    "criticality",
    "crossing_velocities",
    "diagram",
    "fold_velocities",
    "follow",
    "grazing_velocities",
    "hopf_locus",
    "hopf_velocities",
    "limit_cycles",
    "locus",
    "lyapunov",
    "orbit_sensitivities",
    "overshoot_velocities",
    "section",
    "section_at",
    "section_through",
    "sensitivities",
    "settle",
    "shoot",
    "silencing_damping",
    "silencing_load",
    "silencing_stiffness",
    "stick_slip_cycle",
    "sweep",
    "touching_velocities",
    "vibration_ranges",
]

@final
class Law:
    def __new__(
        cls,
        function: Callable[..., Any] | Sequence[Callable[..., Any]],
        *,
        static: float,
        breakpoints: Sequence[float] = ...,
    ) -> Law: ...
    @property
    def static_coefficient(self) -> float: ...
    @property
    def breakpoints(self) -> list[float]: ...
    @overload
    def kinetic(self, speed: float) -> float: ...
    @overload
    def kinetic(self, speed: ArrayLike) -> Array: ...
    @overload
    def slope(self, speed: float) -> float: ...
    @overload
    def slope(self, speed: ArrayLike) -> Array: ...
    @overload
    def coefficient(self, velocity: float) -> float: ...
    @overload
    def coefficient(self, velocity: ArrayLike) -> Array: ...
    def derivative(self, n: int, speed: float) -> float: ...
    def check(self, low: float, high: float) -> list[str]: ...

@disjoint_base
class ContactLaw:
    def static_coefficient(self, rest: float) -> float | None: ...
    def static_rate(self, rest: float) -> float | None: ...

@final
class RateState(ContactLaw):
    def __new__(
        cls,
        *,
        f0: float,
        a: float,
        b: float | tuple[float, float],
        d_c: float | tuple[float, float],
        v0: float,
        evolution: str = "aging",
        least_speed: float | None = None,
    ) -> RateState: ...
    @overload
    def steady(self, speed: float) -> float: ...
    @overload
    def steady(self, speed: ArrayLike) -> Array: ...
    @overload
    def memory_at(self, speed: float) -> float: ...
    @overload
    def memory_at(self, speed: ArrayLike) -> Array: ...
    def critical_stiffness(
        self,
        load: float,
        speed: float,
        mass: float = 0.0,
        damping: float = 0.0,
    ) -> float | None: ...
    def hopf_frequency(
        self,
        load: float,
        speed: float,
        damping: float = 0.0,
    ) -> float | None: ...

@final
class Iwan4:
    def __new__(
        cls,
        slip_force: float,
        stiffness: float,
        exponent: float,
        ratio: float,
    ) -> Iwan4: ...
    @property
    def slip_force(self) -> float: ...
    @property
    def stiffness(self) -> float: ...
    @property
    def exponent(self) -> float: ...
    @property
    def ratio(self) -> float: ...
    @property
    def largest_break_free(self) -> float: ...
    @overload
    def backbone(self, displacement: float) -> float: ...
    @overload
    def backbone(self, displacement: ArrayLike) -> Array: ...
    @overload
    def dissipation(self, amplitude: float) -> float: ...
    @overload
    def dissipation(self, amplitude: ArrayLike) -> Array: ...
    def elements(self, n: int, grid: float) -> list[tuple[float, float]]: ...

def Coulomb(static_coefficient: float, kinetic_coefficient: float) -> Law: ...
def Exponential(
    static_coefficient: float,
    kinetic_coefficient: float,
    stribeck_velocity: float,
) -> Law: ...
def Polynomial(
    static_coefficient: float,
    minimum_coefficient: float,
    minimum_velocity: float,
) -> Law: ...
def Rational(
    static_coefficient: float,
    decay: float,
    offset: float = 0.0,
    quadratic: float = 0.0,
) -> Law: ...
def Stribeck(
    static_coefficient: float,
    coulomb_coefficient: float,
    stribeck_velocity: float,
    exponent: int,
    viscous_coefficient: float = 0.0,
) -> Law: ...
def Tabulated(
    points: ArrayLike,
    static_coefficient: float | None = None,
    piecewise_linear: bool = False,
) -> Law: ...
def Scaled(law: Law, velocity_unit: float) -> Law: ...
def Directional(forward: Law, backward: Law) -> ContactLaw: ...
def Capstan(
    static_coefficient: float,
    kinetic_coefficient: float,
    wrap: float,
) -> ContactLaw: ...
def Freewheel(drag: Law | None = None) -> ContactLaw: ...
def Dwell(
    law: Law,
    *,
    time: float,
    limit: float | None = None,
    rate: float | None = None,
    hyperbolic: bool = False,
) -> ContactLaw: ...
def Dahl(coefficient: float, stiffness: float) -> ContactLaw: ...
def LuGre(law: Law, stiffness: float, damping: float, viscous: float = 0.0) -> ContactLaw: ...
@final
class Drive:
    @staticmethod
    def constant(value: float) -> Drive: ...
    @staticmethod
    def harmonic(amplitude: float, omega: float, phase: float = 0.0) -> Drive: ...
    @staticmethod
    def sine(amplitude: float, omega: float) -> Drive: ...
    @staticmethod
    def profile(points: ArrayLike) -> Drive: ...
    @staticmethod
    def function(
        function: Callable[..., Any] | Sequence[Callable[..., Any]],
        *,
        size: float,
        timescale: float,
        breakpoints: Sequence[float] = ...,
        period: float | None = None,
    ) -> Drive: ...
    @overload
    def __call__(self, time: float) -> float: ...
    @overload
    def __call__(self, time: ArrayLike) -> Array: ...
    @overload
    def slope(self, time: float) -> float: ...
    @overload
    def slope(self, time: ArrayLike) -> Array: ...
    @property
    def period(self) -> float | None: ...
    def __add__(self, other: Drive | float, /) -> Drive: ...
    def __radd__(self, other: float, /) -> Drive: ...

@final
class Equilibrium:
    @property
    def displacement(self) -> float: ...
    @property
    def jacobian(self) -> Array: ...
    @property
    def eigenvalues(self) -> ComplexArray: ...
    @property
    def stability(self) -> str: ...
    @property
    def is_stable(self) -> bool: ...

@final
class MassOnBelt:
    def __new__(
        cls,
        law: Law,
        belt_velocity: float,
        *,
        damping: float = 0.0,
        load: float = 1.0,
    ) -> MassOnBelt: ...
    @property
    def belt_velocity(self) -> float: ...
    @property
    def damping(self) -> float: ...
    @property
    def load(self) -> float: ...
    def replace(
        self,
        *,
        belt_velocity: float | None = None,
        damping: float | None = None,
        load: float | None = None,
    ) -> MassOnBelt: ...
    @property
    def law(self) -> Law: ...
    @property
    def stick_limits(self) -> tuple[float, float]: ...
    @property
    def release_state(self) -> tuple[float, float] | None: ...
    @property
    def equilibrium(self) -> Equilibrium | None: ...
    def friction_force(self, state: StateLike) -> float: ...
    def acceleration(self, state: StateLike) -> float: ...
    def structure(self) -> Structure: ...
    def simulate(
        self,
        start: StateLike,
        duration: float,
        *,
        tolerance: float | None = None,
        max_steps: int | None = None,
        max_events: int | None = None,
        until: Callable[[float, float], float] | None = None,
    ) -> Motion: ...

@final
class PhysicalMassOnBelt:
    def __new__(
        cls,
        law: Law,
        *,
        mass: float,
        stiffness: float,
        normal_force: float,
        belt_velocity: float,
        damping: float = 0.0,
    ) -> PhysicalMassOnBelt: ...
    @property
    def mass(self) -> float: ...
    @property
    def stiffness(self) -> float: ...
    @property
    def damping(self) -> float: ...
    @property
    def normal_force(self) -> float: ...
    @property
    def belt_velocity(self) -> float: ...
    @property
    def dimensionless(self) -> MassOnBelt: ...
    @property
    def length(self) -> float: ...
    @property
    def angular_frequency(self) -> float: ...
    def replace(
        self,
        *,
        mass: float | None = None,
        stiffness: float | None = None,
        normal_force: float | None = None,
        belt_velocity: float | None = None,
        damping: float | None = None,
    ) -> PhysicalMassOnBelt: ...
    @property
    def law(self) -> Law: ...
    @property
    def stick_limits(self) -> tuple[float, float]: ...
    @property
    def release_state(self) -> tuple[float, float] | None: ...
    @property
    def equilibrium(self) -> Equilibrium | None: ...
    def friction_force(self, state: StateLike) -> float: ...
    def acceleration(self, state: StateLike) -> float: ...
    def structure(self) -> Structure: ...
    def simulate(
        self,
        start: StateLike,
        duration: float,
        *,
        tolerance: float | None = None,
        max_steps: int | None = None,
        max_events: int | None = None,
        until: Callable[[float, float], float] | None = None,
    ) -> Motion: ...

@final
class Samples:
    @property
    def time(self) -> Array: ...
    @property
    def displacements(self) -> Array: ...
    @property
    def velocities(self) -> Array: ...
    @property
    def memory(self) -> Array: ...
    @property
    def accelerations(self) -> Array: ...
    @property
    def modes(self) -> Array: ...
    @property
    def friction(self) -> Array: ...
    @property
    def loads(self) -> Array: ...
    @property
    def element_forces(self) -> Array: ...
    @property
    def stop_forces(self) -> Array: ...
    def __len__(self) -> int: ...

@final
class EnergyBudget:
    @property
    def stored(self) -> float: ...
    @property
    def force_work(self) -> Array: ...
    @property
    def drive_work(self) -> Array: ...
    @property
    def belt_work(self) -> Array: ...
    @property
    def friction_loss(self) -> Array: ...
    @property
    def normal_work(self) -> Array: ...
    @property
    def element_work(self) -> Array: ...
    @property
    def first_order_work(self) -> Array: ...
    @property
    def stop_loss(self) -> Array: ...
    @property
    def damper_loss(self) -> float: ...
    @property
    def circulation(self) -> float: ...
    @property
    def defect(self) -> float: ...

@final
class Motion:
    @property
    def duration(self) -> float: ...
    @property
    def start_time(self) -> float: ...
    @property
    def end_time(self) -> float: ...
    @property
    def ended(self) -> str: ...
    @property
    def steps(self) -> int: ...
    @property
    def contacts(self) -> int: ...
    @property
    def events(self) -> npt.NDArray[np.void]: ...
    @property
    def last(self) -> Any: ...
    def state_at(self, time: float | None = None) -> Any: ...
    def sample(self, times: ArrayLike) -> tuple[Any, Any]: ...
    def sample_memory(self, times: ArrayLike) -> Array: ...
    @overload
    def sliding_velocity(self, times: float, contact: int = 0) -> float: ...
    @overload
    def sliding_velocity(self, times: ArrayLike, contact: int = 0) -> Array: ...
    def mode_at(self, time: float, contact: int = 0) -> str | None: ...
    def modes(self, times: ArrayLike, contact: int = 0) -> npt.NDArray[np.int8]: ...
    def samples(self, interval: float) -> Samples: ...
    def energy_budget(self) -> EnergyBudget: ...
    def plot(
        self,
        ax: Axes | None = None,
        *,
        coordinates: Sequence[int] | None = None,
        contact: int | None = ...,
        points: int = 2000,
    ) -> Axes: ...
    def plot_phase(
        self,
        ax: Axes | None = None,
        *,
        coordinate: int = 0,
        contact: int | None = ...,
        points: int = 2000,
    ) -> Axes: ...

@final
class SteadySliding:
    @property
    def displacements(self) -> Array: ...
    @property
    def first_order(self) -> Array: ...
    @property
    def eigenvalues(self) -> ComplexArray: ...
    @property
    def accelerations(self) -> Array: ...
    @property
    def is_stable(self) -> bool: ...

@final
class Carried:
    @property
    def force(self) -> float: ...
    @property
    def least(self) -> float: ...
    @property
    def most(self) -> float: ...
    @property
    def is_determined(self) -> bool: ...

@final
class Mechanism:
    @property
    def contacts(self) -> list[tuple[int, float]]: ...
    @property
    def power(self) -> float: ...
    @property
    def resistance(self) -> float: ...
    @property
    def margin(self) -> float: ...

@final
class StabilityChange:
    @property
    def time(self) -> float: ...
    @property
    def becomes_stable(self) -> bool: ...
    @property
    def frequency(self) -> float: ...

@final
class Contact:
    def __new__(
        cls,
        direction: DirectionLike,
        law: Law | ContactLaw,
        load: Drive | float,
        *,
        belt_velocity: Drive | float | None = None,
        load_gradient: DirectionLike | None = None,
        tangential_stiffness: float | None = None,
        normal_spring: tuple[DirectionLike, float] | None = None,
        load_laws: Sequence[tuple[DirectionLike, ForceLaw]] = ...,
    ) -> Contact: ...
    @staticmethod
    def between(
        i: int,
        j: int,
        law: Law | ContactLaw,
        load: Drive | float,
        *,
        belt_velocity: Drive | float | None = None,
        load_gradient: DirectionLike | None = None,
        tangential_stiffness: float | None = None,
        normal_spring: tuple[DirectionLike, float] | None = None,
        load_laws: Sequence[tuple[DirectionLike, ForceLaw]] = ...,
    ) -> Contact: ...
    @staticmethod
    def freewheel(
        i: int,
        j: int,
        *,
        drag: Law | None = None,
        load: Drive | float = 1.0,
    ) -> Contact: ...
    def in_parallel(self, elements: ArrayLike) -> list[Contact]: ...
    @property
    def direction(self) -> dict[int, float]: ...
    @property
    def tangential_stiffness(self) -> float | None: ...
    def load_at(
        self,
        time: float,
        displacements: ArrayLike,
        velocities: ArrayLike | None = None,
    ) -> float: ...

@final
class ForceLaw:
    def __new__(
        cls,
        function: Callable[..., Any] | Sequence[Callable[..., Any]],
        *,
        breakpoints: Sequence[float] = ...,
        potential: Callable[..., Any] | Sequence[Callable[..., Any]] | None = None,
    ) -> ForceLaw: ...
    def force(self, position: float, velocity: float = 0.0) -> float: ...

@final
class ForceElement:
    def __new__(
        cls,
        direction: DirectionLike,
        law: ForceLaw,
        *,
        factor: Drive | float | None = None,
    ) -> ForceElement: ...
    @staticmethod
    def field(
        directions: Sequence[DirectionLike],
        forces: Callable[[Any, Any], Sequence[Any]],
        *,
        potential: Callable[[Any], Any] | None = None,
        factor: Drive | float | None = None,
    ) -> ForceElement: ...
    @property
    def directions(self) -> list[dict[int, float]]: ...

@final
class Stop:
    def __new__(
        cls,
        direction: DirectionLike,
        gap: float,
        *,
        stiffness: float,
        damping: float = 0.0,
        adhesive: bool = False,
    ) -> Stop: ...
    @staticmethod
    def above(
        i: int,
        position: float,
        *,
        stiffness: float,
        damping: float = 0.0,
        adhesive: bool = False,
    ) -> Stop: ...
    @staticmethod
    def below(
        i: int,
        position: float,
        *,
        stiffness: float,
        damping: float = 0.0,
        adhesive: bool = False,
    ) -> Stop: ...
    @staticmethod
    def between(
        i: int,
        j: int,
        gap: float,
        *,
        stiffness: float,
        damping: float = 0.0,
        adhesive: bool = False,
    ) -> Stop: ...
    @property
    def direction(self) -> dict[int, float]: ...
    @property
    def gap(self) -> float: ...
    @property
    def stiffness(self) -> float: ...
    @property
    def damping(self) -> float: ...
    @property
    def is_adhesive(self) -> bool: ...

@final
class FirstOrder:
    def __new__(
        cls,
        *,
        time_constant: float | None = None,
        displacements: DirectionLike | None = None,
        velocities: DirectionLike | None = None,
        states: DirectionLike | None = None,
        drive: Drive | float | None = None,
        laws: Sequence[tuple[DirectionLike, ForceLaw]] = ...,
        state_laws: Sequence[tuple[int, ForceLaw]] = ...,
        forces: DirectionLike | None = None,
    ) -> FirstOrder: ...
    @property
    def time_constant(self) -> float | None: ...

@final
class Structure:
    def __new__(
        cls,
        masses: ArrayLike | None = None,
        *,
        mass_matrix: ArrayLike | None = None,
        stiffness: ArrayLike | None = None,
        damping: ArrayLike | None = None,
    ) -> Structure: ...
    def with_spring(self, i: int, j: int, stiffness: float) -> Structure: ...
    def with_damper(self, i: int, j: int, damping: float) -> Structure: ...
    def with_ground_spring(self, i: int, stiffness: float) -> Structure: ...
    def with_ground_damper(self, i: int, damping: float) -> Structure: ...
    def with_stiffness(self, stiffness: ArrayLike) -> Structure: ...
    def with_damping(self, damping: ArrayLike) -> Structure: ...
    def with_force(self, i: int, force: Drive | float) -> Structure: ...
    def with_contact(self, contact: Contact) -> Structure: ...
    def with_contacts(self, contacts: Sequence[Contact]) -> Structure: ...
    def with_element(self, element: ForceElement) -> Structure: ...
    def with_stop(self, stop: Stop) -> Structure: ...
    def with_stops(self, stops: Sequence[Stop]) -> Structure: ...
    def with_first_order(self, state: FirstOrder) -> Structure: ...
    def with_first_orders(self, states: Sequence[FirstOrder]) -> Structure: ...
    def __len__(self) -> int: ...
    @property
    def mass_matrix(self) -> Array: ...
    @property
    def stiffness(self) -> Array: ...
    @property
    def damping(self) -> Array: ...
    @property
    def period(self) -> float | None: ...
    @property
    def contacts(self) -> int: ...
    @property
    def elements(self) -> int: ...
    @property
    def stops(self) -> int: ...
    @property
    def first_orders(self) -> int: ...
    def simulate(
        self,
        start: StateLike,
        duration: float,
        *,
        tolerance: float | None = None,
        max_steps: int | None = None,
        max_events: int | None = None,
        start_time: float = 0.0,
        until: Callable[[Array, Array], float] | None = None,
    ) -> Motion: ...
    def steady_sliding(
        self,
        *,
        near: ArrayLike | None = None,
        velocities: ArrayLike | None = None,
    ) -> SteadySliding: ...
    def frozen(self, time: float) -> Structure: ...
    def stability_changes(self, start: float, end: float) -> list[StabilityChange]: ...
    def carried(self, time: float, state: StateLike) -> list[Carried]: ...
    def mechanisms(self, time: float, state: StateLike) -> list[Mechanism]: ...
    def acceleration(self, time: float, state: StateLike) -> Array: ...
    def kinetic_energy(self, state: StateLike) -> float: ...
    def elastic_energy(self, time: float, state: StateLike) -> float: ...

def PolynomialSpring(coefficients: ArrayLike) -> ForceLaw: ...
def Backlash(stiffness: float, gap: float) -> ForceLaw: ...
def Pendulum(moment: float, length: float) -> ForceLaw: ...
def SnapThrough(stiffness: float, free_length: float, span: float) -> ForceLaw: ...
def VanDerPol(negative_damping: float, nonlinear_damping: float) -> ForceLaw: ...
def TabulatedForce(points: ArrayLike, piecewise_linear: bool = False) -> ForceLaw: ...
@final
class CycleEnergy:
    @property
    def drive_work(self) -> float: ...
    @property
    def belt_work(self) -> float: ...
    @property
    def friction_loss(self) -> float: ...
    @property
    def damper_loss(self) -> float: ...

@final
class BeltAttractor:
    @property
    def kind(self) -> str: ...
    @property
    def cycle(self) -> LimitCycle | None: ...

@final
class LimitCycle:
    @property
    def kind(self) -> str: ...
    @property
    def state(self) -> tuple[float, float]: ...
    @property
    def period(self) -> float: ...
    @property
    def frequency(self) -> float: ...
    @property
    def hertz(self) -> float: ...
    @property
    def stick_duration(self) -> float: ...
    @property
    def leading_duration(self) -> float: ...
    @property
    def amplitude(self) -> float: ...
    @property
    def max_displacement(self) -> float: ...
    @property
    def min_displacement(self) -> float: ...
    @property
    def mean_displacement(self) -> float: ...
    @property
    def max_velocity(self) -> float: ...
    @property
    def min_velocity(self) -> float: ...
    @property
    def rms_velocity(self) -> float: ...
    @property
    def rms_acceleration(self) -> float: ...
    @property
    def peak_acceleration(self) -> float: ...
    @property
    def max_sliding_speed(self) -> float: ...
    @property
    def multiplier(self) -> float: ...
    @property
    def is_stable(self) -> bool: ...
    @property
    def motion(self) -> Motion: ...
    @property
    def energy(self) -> CycleEnergy: ...
    def harmonics(self, n: int) -> ComplexArray: ...
    def velocity_harmonics(self, n: int) -> ComplexArray: ...
    def acceleration_harmonics(self, n: int) -> ComplexArray: ...

@final
class CycleSet:
    def __len__(self) -> int: ...
    def __getitem__(self, index: int, /) -> LimitCycle: ...
    def __iter__(self) -> Iterator[LimitCycle]: ...
    @property
    def stable(self) -> list[LimitCycle]: ...
    @property
    def unstable(self) -> list[LimitCycle]: ...
    @property
    def continuum(self) -> float | None: ...
    @property
    def unresolved(self) -> list[tuple[float, float]]: ...

@final
class Diagram:
    def __len__(self) -> int: ...
    def __getitem__(self, index: int, /) -> DiagramPoint: ...
    def __iter__(self) -> Iterator[DiagramPoint]: ...
    def plot(self, ax: Axes | None = None, *, measure: str = "amplitude") -> Axes: ...

@final
class DiagramPoint:
    @property
    def belt_velocity(self) -> float: ...
    @property
    def equilibrium(self) -> Equilibrium | None: ...
    @property
    def cycles(self) -> CycleSet: ...

@final
class Along:
    def hopf(self) -> Array: ...
    def grazing(self) -> Array: ...
    def touching(self) -> Array: ...
    def overshoot(self) -> Array: ...
    def crossing(self) -> Array: ...
    def folds(self) -> Array: ...
    def vibration_ranges(self) -> VibrationRanges: ...
    def silence(self) -> float | None: ...

def hopf_velocities(
    system: Belt,
    low: float,
    high: float,
    *,
    max_steps: int | None = None,
    progress: Callable[[Progress], object] | None = None,
) -> Array: ...
def grazing_velocities(
    system: Belt,
    low: float,
    high: float,
    *,
    max_steps: int | None = None,
    progress: Callable[[Progress], object] | None = None,
) -> Array: ...
def touching_velocities(
    system: Belt,
    low: float,
    high: float,
    *,
    max_steps: int | None = None,
    progress: Callable[[Progress], object] | None = None,
) -> Array: ...
def overshoot_velocities(
    system: Belt,
    low: float,
    high: float,
    *,
    max_steps: int | None = None,
    progress: Callable[[Progress], object] | None = None,
) -> Array: ...
def crossing_velocities(
    system: Belt,
    low: float,
    high: float,
    *,
    max_steps: int | None = None,
    progress: Callable[[Progress], object] | None = None,
) -> Array: ...
def fold_velocities(
    system: Belt,
    low: float,
    high: float,
    *,
    max_steps: int | None = None,
    progress: Callable[[Progress], object] | None = None,
) -> Array: ...
def limit_cycles(system: Belt) -> CycleSet: ...
def stick_slip_cycle(system: Belt) -> LimitCycle | None: ...
@overload
def attractor(system: Belt, start: tuple[float, float]) -> BeltAttractor: ...
@overload
def attractor(system: Belt, start: Sequence[tuple[float, float]]) -> list[BeltAttractor]: ...
def silencing_damping(system: Belt) -> float: ...
def silencing_load(system: Belt) -> float: ...
def silencing_stiffness(system: Belt) -> float: ...
def criticality(system: Belt, velocity: float) -> str: ...
def diagram(
    system: Belt,
    velocities: ArrayLike,
    *,
    progress: Callable[[Progress], object] | None = None,
) -> Diagram: ...
def along(
    family: Callable[[float], Belt],
    low: float,
    high: float,
    *,
    max_steps: int | None = None,
    progress: Callable[[Progress], object] | None = None,
) -> Along: ...
@final
class BranchEnd:
    @property
    def kind(self) -> str: ...
    @property
    def parameter(self) -> float | None: ...
    @property
    def reason(self) -> str: ...

@final
class VibrationRange:
    @property
    def low(self) -> float: ...
    @property
    def high(self) -> float: ...
    @property
    def attractors(self) -> list[str]: ...
    @property
    def borders(self) -> list[str]: ...
    @property
    def is_bistable(self) -> bool: ...
    @property
    def vibrates(self) -> bool: ...

@final
class LocusEnd:
    @property
    def kind(self) -> str: ...
    @property
    def parameters(self) -> tuple[float, float] | None: ...
    @property
    def reason(self) -> str: ...

@final
class HopfPoint:
    @property
    def parameters(self) -> tuple[float, float]: ...
    @property
    def frequency(self) -> float: ...
    @property
    def displacements(self) -> Array: ...
    @property
    def first_lyapunov_coefficient(self) -> float: ...
    @property
    def largest_other(self) -> float: ...
    @property
    def criticality(self) -> str: ...

@final
class LyapunovExponent:
    @property
    def value(self) -> float: ...
    @property
    def spread(self) -> float: ...

@final
class EventSensitivity:
    @property
    def time(self) -> float: ...
    @property
    def contact(self) -> int | None: ...
    @property
    def stop(self) -> int | None: ...
    @property
    def kind(self) -> str: ...
    @property
    def by_parameters(self) -> Array: ...

@final
class Attractor:
    @property
    def kind(self) -> str: ...
    @property
    def orbit(self) -> Orbit | None: ...

@final
class BranchPoint:
    @property
    def parameter(self) -> float: ...
    @property
    def orbit(self) -> Orbit: ...

@final
class Sweep:
    @property
    def up(self) -> list[SweepPoint]: ...
    @property
    def down(self) -> list[SweepPoint]: ...
    @property
    def stopped(self) -> float | None: ...
    @property
    def changes(self) -> list[Change]: ...

@final
class Change:
    @property
    def between(self) -> tuple[float, float]: ...
    @property
    def before(self) -> str: ...
    @property
    def after(self) -> str: ...

@final
class SweepPoint:
    @property
    def parameter(self) -> float: ...
    @property
    def attractor(self) -> Attractor | None: ...
    @property
    def error(self) -> str | None: ...

@final
class LocusPoint:
    @property
    def parameters(self) -> tuple[float, float]: ...
    @property
    def orbit(self) -> Orbit: ...

@final
class SpecialPoint:
    @property
    def kind(self) -> str: ...
    @property
    def parameters(self) -> tuple[float, float]: ...

@final
class Locus:
    @property
    def kind(self) -> str: ...
    @property
    def points(self) -> list[LocusPoint]: ...
    @property
    def special(self) -> list[SpecialPoint]: ...
    @property
    def ends(self) -> tuple[LocusEnd, LocusEnd]: ...
    @property
    def parameters(self) -> Array: ...
    def plot(self, ax: Axes | None = None) -> Axes: ...

@final
class HopfLocus:
    @property
    def points(self) -> list[HopfPoint]: ...
    @property
    def special(self) -> list[SpecialPoint]: ...
    @property
    def ends(self) -> tuple[LocusEnd, LocusEnd]: ...
    @property
    def parameters(self) -> Array: ...

@final
class Passage:
    @property
    def time(self) -> float: ...
    @property
    def state(self) -> State: ...
    @property
    def rises(self) -> bool: ...

@final
class OrbitSensitivities:
    @property
    def period(self) -> Array: ...
    @property
    def motion(self) -> Sensitivities: ...

@final
class Orbit:
    @property
    def is_forced(self) -> bool: ...
    @property
    def period(self) -> float: ...
    @property
    def frequency(self) -> float: ...
    @property
    def hertz(self) -> float: ...
    @property
    def state(self) -> State: ...
    @property
    def motion(self) -> Motion: ...
    @property
    def events(self) -> npt.NDArray[np.void]: ...
    @property
    def multipliers(self) -> ComplexArray: ...
    @property
    def is_stable(self) -> bool: ...
    @property
    def is_symmetric(self) -> bool: ...
    @property
    def unslipped(self) -> list[int]: ...
    @property
    def families(self) -> list[State]: ...
    @property
    def energy(self) -> EnergyBudget: ...
    def extremes(self, coordinate: int = 0) -> tuple[float, float]: ...
    def velocity_extremes(self, coordinate: int = 0) -> tuple[float, float]: ...
    def acceleration_extremes(self, coordinate: int = 0) -> tuple[float, float]: ...
    def amplitude(self, coordinate: int = 0) -> float: ...
    def mean_velocity(self, coordinate: int = 0) -> float: ...
    def mean_displacement(self, coordinate: int = 0) -> float: ...
    def rms_velocity(self, coordinate: int = 0) -> float: ...
    def rms_acceleration(self, coordinate: int = 0) -> float: ...
    def peak_acceleration(self, coordinate: int = 0) -> float: ...
    def stick_duration(self, contact: int = 0) -> float: ...
    def slips(self, contact: int = 0) -> int: ...
    def max_sliding_speed(self, contact: int = 0) -> float: ...
    def harmonics(self, n: int, coordinate: int = 0) -> ComplexArray: ...
    def velocity_harmonics(self, n: int, coordinate: int = 0) -> ComplexArray: ...
    def acceleration_harmonics(self, n: int, coordinate: int = 0) -> ComplexArray: ...

@final
class Bifurcation:
    @property
    def parameter(self) -> float: ...
    @property
    def kind(self) -> str: ...
    @property
    def orbit(self) -> Orbit: ...
    def switch(
        self,
        family: Callable[[float], System],
        *,
        progress: Callable[[Progress], object] | None = None,
    ) -> BranchPoint: ...

@final
class Branch:
    @property
    def points(self) -> list[BranchPoint]: ...
    @property
    def parameters(self) -> Array: ...
    @property
    def stable(self) -> npt.NDArray[np.bool_]: ...
    @property
    def periods(self) -> Array: ...
    def amplitudes(self, coordinate: int = 0) -> Array: ...
    def peak(self, coordinate: int = 0) -> BranchPoint | None: ...
    @property
    def bifurcations(self) -> list[Bifurcation]: ...
    @property
    def ends(self) -> tuple[BranchEnd, BranchEnd]: ...
    def plot(
        self,
        ax: Axes | None = None,
        *,
        coordinate: int = 0,
        measure: Callable[[Orbit], float] | None = None,
        bifurcations: bool = True,
    ) -> Axes: ...
    def __len__(self) -> int: ...

@final
class VibrationRanges:
    def __len__(self) -> int: ...
    def __getitem__(self, index: int, /) -> VibrationRange: ...
    def __iter__(self) -> Iterator[VibrationRange]: ...
    @property
    def branches(self) -> list[Branch]: ...
    @property
    def sweep(self) -> Sweep | None: ...
    @property
    def stopped(self) -> float | None: ...

@final
class Sensitivities:
    @property
    def times(self) -> tuple[float, float]: ...
    def state_at(self, time: float) -> State | None: ...
    def at(self, time: float) -> Array | None: ...
    @property
    def events(self) -> list[EventSensitivity]: ...

def shoot(
    system: System,
    guess: StateLike,
    *,
    periods: int | None = None,
    estimate: float | None = None,
    max_steps: int | None = None,
    progress: Callable[[Progress], object] | None = None,
) -> Orbit: ...
def settle(
    system: System,
    start: StateLike,
    transient: float,
    *,
    periods: int | None = None,
    estimate: float | None = None,
    max_steps: int | None = None,
    progress: Callable[[Progress], object] | None = None,
) -> Orbit: ...
def classify(
    system: System,
    start: StateLike,
    *,
    max_steps: int | None = None,
    progress: Callable[[Progress], object] | None = None,
) -> Attractor: ...
def follow(
    family: Callable[[float], System],
    parameter: float,
    orbit: Orbit,
    low: float,
    high: float,
    *,
    max_steps: int | None = None,
    max_points: int | None = None,
    progress: Callable[[Progress], object] | None = None,
) -> Branch: ...
def begin(
    family: Callable[[float], System],
    near: float,
    *,
    max_steps: int | None = None,
    progress: Callable[[Progress], object] | None = None,
) -> BranchPoint: ...
def sweep(
    family: Callable[[float], System],
    values: ArrayLike,
    start: StateLike,
    *,
    max_steps: int | None = None,
    progress: Callable[[Progress], object] | None = None,
) -> Sweep: ...
def vibration_ranges(
    family: Callable[[float], System] | Belt,
    low: float,
    high: float,
    *,
    max_steps: int | None = None,
    max_points: int | None = None,
    progress: Callable[[Progress], object] | None = None,
) -> VibrationRanges: ...
def locus(
    family: Callable[[float, float], System],
    bifurcation: Bifurcation,
    second: float,
    ranges: tuple[tuple[float, float], tuple[float, float]],
    *,
    max_steps: int | None = None,
    max_points: int | None = None,
    progress: Callable[[Progress], object] | None = None,
) -> Locus: ...
def hopf_locus(
    family: Callable[[float, float], System],
    ranges: tuple[tuple[float, float], tuple[float, float]],
) -> list[HopfLocus]: ...
def lyapunov(
    system: System,
    start: StateLike,
    transient: float,
    duration: float,
    *,
    max_steps: int | None = None,
    progress: Callable[[Progress], object] | None = None,
) -> LyapunovExponent: ...
def section(
    system: System,
    start: StateLike,
    period: float,
    count: int,
    *,
    skip: int = 0,
) -> tuple[Array, Array]: ...
def section_at(
    system: System,
    start: StateLike,
    contact: int,
    kind: str,
    count: int,
    *,
    direction: int = ...,
    skip: int = 0,
) -> tuple[Array, Array, Array]: ...
def section_through(
    system: System,
    start: StateLike,
    contact: int,
    speed: float,
    count: int,
    *,
    skip: int = 0,
) -> list[Passage]: ...
def sensitivities(
    family: Callable[[Array], tuple[System, StateLike]],
    parameters: ArrayLike,
    duration: float,
    *,
    max_steps: int | None = None,
    progress: Callable[[Progress], object] | None = None,
) -> Sensitivities: ...
def orbit_sensitivities(
    family: Callable[[Array], System],
    parameters: ArrayLike,
    orbit: Orbit,
    *,
    max_steps: int | None = None,
    progress: Callable[[Progress], object] | None = None,
) -> OrbitSensitivities: ...
@final
class Progress:
    @property
    def value(self) -> float: ...
    @property
    def second(self) -> float | None: ...
    @property
    def points(self) -> int: ...
    @property
    def steps(self) -> int: ...

