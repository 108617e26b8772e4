"""A user's program: mypy --strict accepts it, and refuses what is marked in test_types.py."""

from __future__ import annotations

import numpy as np

import stick_slip as ss
from stick_slip.typing import Array, StateLike, System


def family(load: float) -> ss.Structure:
    contact = ss.Contact(0, ss.Polynomial(0.4, 0.25, 0.5), load, belt_velocity=0.2)
    return ss.Structure([1.0]).with_ground_spring(0, 1.0).with_contact(contact)


def amplitudes(system: System, start: StateLike) -> float:
    orbit: ss.Orbit = ss.settle(
        system, start, 50.0, estimate=6.8, progress=lambda p: p.steps < 10**6
    )
    return orbit.amplitude() + orbit.extremes(0)[1]


law = ss.Law(lambda s: 0.3 + 0.2 * np.exp(-s / 0.1), static=0.55)
values: Array = law.kinetic(np.linspace(0.0, 1.0, 5))
value: float = law.kinetic(0.5)
motion: ss.Motion = ss.MassOnBelt(law, 0.2, damping=0.05).simulate((0.0, 0.0), 10.0)
u, v = motion.sample([0.0, 1.0])
times: list[float] = [float(event["time"]) for event in motion.events]
cycles: ss.CycleSet = ss.limit_cycles(ss.MassOnBelt(law, 0.2))
kinds: list[str] = [cycle.kind for cycle in cycles]
first: ss.Orbit = ss.shoot(family(1.0), (0.1, 0.2), estimate=6.5)
branch: ss.Branch = ss.follow(family, 1.0, first, 0.5, 1.5)
ends: list[str] = [end.kind for end in branch.ends]
low: float = ss.vibration_ranges(family, 0.5, 1.5)[0].low
found: float = ss.hopf_velocities(ss.MassOnBelt(law, 0.2), 0.1, 1.0)[0]
drive: ss.Drive = 1.0 + ss.Drive.harmonic(0.1, 2.0)
creeping = ss.RateState(f0=0.4, a=0.1, b=(0.2, 0.1), d_c=(0.06, 0.3), v0=0.05)
steady: Array = creeping.steady([0.1, 0.2])
laws: list[ss.Law | ss.ContactLaw] = [law, creeping, ss.Capstan(0.3, 0.2, 6.0), ss.Freewheel(law)]
load = ss.ForceLaw(lambda x, v: v**2 / 2)
held = (
    ss.Structure([1.0])
    .with_contacts([ss.Contact(0, it, 1.0, load_laws=[(0, load)]) for it in laws])
    .with_stops([ss.Stop.above(0, 1.0, stiffness=10.0), ss.Stop({0: 1.0}, 1.0, stiffness=10.0)])
    .with_first_order(ss.FirstOrder(time_constant=0.5, velocities={0: 1.0}, forces={0: -1.0}))
)
rising: list[bool] = [it.rises for it in ss.section_through(held, ([0.1], [0.2]), 0, 0.1, 3)]
state: ss.State = first.state
again: StateLike = state
further: StateLike = ([0.0], [0.0], [0.0], {0: 1e-12})
forces: Array = held.simulate(further, 1.0).samples(0.1).stop_forces
try:
    ss.Coulomb(0.1, 0.2)
except ss.ParameterError as error:
    name: str = error.variant
