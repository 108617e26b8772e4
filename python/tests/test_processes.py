"""Systems in other processes: what defines a system is pickled; results say what to send instead."""

from __future__ import annotations

import copy
import multiprocessing
import pickle
from typing import Any

import numpy as np
import pytest

import stick_slip as ss

OWN = ss.Law(lambda s: 0.3 + 0.2 * np.exp(-s / 0.1), static=0.55)
PIECES = ss.Law(
    [lambda s: 0.4 - 0.1 * s, lambda s: 0.3 + 0 * s], static=0.5, breakpoints=[1.0]
)
SPRING = ss.ForceLaw(lambda x, v: x + 0.7 * x**3, potential=lambda x: x**2 / 2 + 0.175 * x**4)
CHIRP = ss.Drive.function(lambda t: 0.1 * np.cos(0.01 * t**2), size=0.1, timescale=0.5)
POINTS = [(0.1 * i, 0.4 - 0.01 * i) for i in range(12)]
LAWS = [
    ss.Coulomb(0.4, 0.25),
    ss.Rational(1.0, 3.0, offset=0.1),
    ss.Tabulated(POINTS, 0.5, piecewise_linear=True),
    OWN,
    PIECES,
    ss.Scaled(ss.Coulomb(0.4, 0.25), 2.0),
    ss.Scaled(PIECES, 2.0),
]
CONTACT_LAWS = [
    ss.Directional(ss.Coulomb(0.2, 0.1), OWN),
    ss.Capstan(0.3, 0.2, 6.0),
    ss.Freewheel(),
    ss.Freewheel(OWN),
    ss.Dwell(OWN, limit=0.9, time=2.0, hyperbolic=True),
    ss.Dwell(ss.Coulomb(0.3, 0.2), rate=0.1, time=2.0),
    ss.Dahl(0.3, 100.0),
    ss.LuGre(ss.Coulomb(0.4, 0.3), 100.0, 0.5, viscous=0.1),
    ss.RateState(f0=0.4, a=0.1, b=(0.2, 0.1), d_c=(0.06, 0.3), v0=0.05, least_speed=1e-30),
]
DRIVES = [
    ss.Drive.constant(2.0),
    2.0 + ss.Drive.harmonic(0.5, 3.0, 0.2) + ss.Drive.sine(0.1, 1.0),
    ss.Drive.profile([(0.0, 1.0), (1.0, 2.0)]) + CHIRP,
]
OTHERS = [
    ss.Iwan4(3.0, 2.0, -0.1, 0.1),
    SPRING,
    ss.TabulatedForce(POINTS),
    ss.ForceElement({0: 1.0, 1: -1.0}, SPRING, factor=DRIVES[1]),
    ss.ForceElement.field(
        [0, {1: 2.0}],
        lambda x, v: (x[0] * x[1] ** 2 + v[0], x[1] * x[0] ** 2),
        potential=lambda x: 0.5 * (x[0] * x[1]) ** 2,
    ),
    ss.Stop.between(0, 1, 0.1, stiffness=10.0, damping=0.5, adhesive=True),
    ss.FirstOrder(time_constant=0.5, drive=CHIRP, laws=[({0: 1.0}, SPRING)], forces={0: 1.0}),
    ss.FirstOrder(states={0: -1.0}, state_laws=[(0, SPRING)]),
    ss.Contact(0, CONTACT_LAWS[4], DRIVES[1], belt_velocity=CHIRP, load_laws=[(1, SPRING)]),
    ss.Contact(0, OWN, 1.0, normal_spring=({1: 1.0}, 2.0)),
    ss.Contact.freewheel(0, 1, drag=OWN),
    ss.MassOnBelt(PIECES, 0.2, damping=0.05, load=2.0),
    ss.PhysicalMassOnBelt(OWN, mass=2.0, stiffness=800.0, normal_force=20.0, belt_velocity=0.03),
]


def block() -> ss.Structure:
    """A structure with something of every kind."""
    joint = ss.Contact.between(0, 1, ss.Coulomb(0.3, 0.3), 1.0, tangential_stiffness=5.0)
    return (
        ss.Structure([1.0, 2.0], stiffness=np.diag([1.0, 3.0]), damping=0.01 * np.eye(2))
        .with_spring(0, 1, 1.0)
        .with_ground_damper(1, 0.1)
        .with_force(1, DRIVES[1])
        .with_contact(ss.Contact(0, OWN, 1.0, belt_velocity=0.2))
        .with_contacts(joint.in_parallel([(1.0, 0.1), (2.0, 0.4)]))
        .with_element(ss.ForceElement(0, SPRING))
        .with_stop(ss.Stop.above(1, 0.5, stiffness=50.0))
        .with_first_order(ss.FirstOrder(time_constant=0.5, velocities={1: 1.0}, forces={0: 0.1}))
    )


@pytest.mark.parametrize("made", [*LAWS, *CONTACT_LAWS, *DRIVES, *OTHERS], ids=repr)
def test_what_defines_a_system_is_made_again(made: Any) -> None:
    again = pickle.loads(pickle.dumps(made))
    assert type(again) is type(made) and repr(again) == repr(made)
    assert pickle.dumps(again) == pickle.dumps(copy.deepcopy(again))
    if isinstance(made, ss.Drive):
        times = np.linspace(0.0, 5.0, 50)
        assert np.array_equal(made(times), again(times))
    if isinstance(made, ss.Law):
        speeds = np.linspace(0.0, 2.0, 50)
        assert np.array_equal(made.kinetic(speeds), again.kinetic(speeds))


def end(system: ss.Structure | ss.MassOnBelt) -> list[np.ndarray]:
    """The end of a motion: a function that a process can run."""
    if isinstance(system, ss.MassOnBelt):
        return [np.array(system.simulate((0.1, 0.0), 30.0).last)]
    return [np.array(part) for part in system.simulate(([0.1, 0.0], [0.0, 0.0]), 30.0).state_at()[:3]]


def test_the_motions_of_another_process_have_the_same_bits() -> None:
    belt = ss.MassOnBelt(OWN, 0.2, damping=0.05)
    systems = [block(), block().frozen(1.5), belt, belt.structure()]
    here = [end(system) for system in systems[:3]]
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        there = pool.map(end, systems[:3])
    for one, other in zip(here, there):
        assert all(np.array_equal(a, b) for a, b in zip(one, other))
    again = pickle.loads(pickle.dumps(systems[3]))
    starts = ([0.1], [0.0])
    assert again.simulate(starts, 9.0).last == systems[3].simulate(starts, 9.0).last
    pieces = ss.Contact(0, ss.Coulomb(1.0, 1.0), 1.0).in_parallel([(1.0, 0.1), (2.0, 0.4)])
    parts = pickle.loads(pickle.dumps(pieces))
    assert [part.tangential_stiffness for part in parts] == [1.0, 2.0]
    assert [part.load_at(0.0, [0.0]) for part in parts] == [0.1, 0.4]
    long = ss.Structure([1.0])
    for _ in range(3000):
        long = long.with_ground_spring(0, 1e-3)
    assert pickle.loads(pickle.dumps(long)).stiffness == long.stiffness


def test_results_say_what_to_send_instead() -> None:
    system = ss.MassOnBelt(ss.Polynomial(0.4, 0.25, 0.5), 0.2, damping=0.05)
    orbit = ss.settle(system, (0.0, 0.0), 50.0, estimate=6.8)
    results = [system.simulate((0.0, 0.0), 1.0), orbit, ss.limit_cycles(system), orbit.energy]
    for result in results:
        with pytest.raises(TypeError, match="return the numbers and arrays") as caught:
            pickle.dumps(result)
        assert type(result).__name__ in str(caught.value)
    assert pickle.loads(pickle.dumps(orbit.state)).velocities == orbit.state.velocities
    with pytest.raises(ss.StickSlipError) as failed:
        system.simulate((0.0, 0.0), 100.0, max_steps=5)
    again = pickle.loads(pickle.dumps(failed.value))
    assert (again.variant, again.limit, str(again)) == ("TooManySteps", 5, str(failed.value))
