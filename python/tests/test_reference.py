"""The reference motions of the Rust tests through Python: the same bits as in Rust."""

from __future__ import annotations

import os
import shutil
import struct
import subprocess
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import reference

import stick_slip as ss

PACKAGE = Path(__file__).resolve().parents[1]
STRUCTURES = [
    "driven_trajectories",
    "structure_trajectories",
    "contact_trajectories",
    "joint_trajectories",
    "bristle_trajectories",
    "dwell_trajectories",
    "limits_trajectories",
    "force_trajectories",
    "rate_state_trajectories",
]

pytestmark = pytest.mark.skipif(
    not reference.DATA.is_dir(), reason="the reference data are in a clone of the repository only"
)


def bits(numbers: Any) -> str:
    return " ".join(struct.pack(">d", number).hex() for number in np.ravel(numbers))


@pytest.fixture(scope="session")
def rust() -> dict[str, list[str]]:
    """The lines of the Rust program by case."""
    if shutil.which("cargo") is None:
        pytest.skip("no Rust toolchain")
    # With the settings of the extension, for which the crate may be compiled already.
    command = ["cargo", "run", "--quiet", "--locked", "--package", "stick-slip-bits"]
    profile = os.environ.get("STICK_SLIP_PROFILE", "release")
    run = subprocess.run(
        [*command, "--profile", profile], cwd=PACKAGE, capture_output=True, text=True
    )
    assert run.returncode == 0, run.stderr
    found: dict[str, list[str]] = {}
    for line in run.stdout.splitlines():
        kind, _, rest = line.partition(" ")
        if kind == "case":
            lines = found.setdefault(rest.strip('"'), [])
        elif kind == "time":
            name, _, seconds = rest.rpartition(" ")
            found[f"time of {name}"] = [seconds]
        else:
            lines.append(line)
    return found


def test_belts_have_the_bits_of_rust(rust: dict[str, list[str]]) -> None:
    compared = 0
    for case in reference.cases("trajectories"):
        if case["id"] not in rust:
            continue
        start = (float(case["start"]["u"]), float(case["start"]["v"]))
        times = reference.floats([state["t"] for state in case["states"]])
        motion = reference.belt(case).simulate(start, times[-1])
        lines = [f"event {event['kind']} {bits(event['time'])}" for event in motion.events]
        u, v = motion.sample(times)
        lines += [f"state {bits(state)}" for state in zip(u, v)]
        assert lines == rust[case["id"]]
        compared += len(lines)
        # The reference values themselves, within the accuracy that the crate promises.
        for i, state in enumerate(case["states"]):
            for found, value in ((u[i], float(state["u"])), (v[i], float(state["v"]))):
                assert abs(found - value) <= 1e-13 * max(1.0, abs(value))
    assert compared > 200


def test_cycles_have_the_bits_of_rust(rust: dict[str, list[str]]) -> None:
    compared = 0
    for case in reference.cases("cycles"):
        lines = [
            "cycle "
            + bits([c.period, c.amplitude, c.multiplier, c.min_velocity, c.energy.drive_work])
            for c in ss.limit_cycles(reference.belt(case))
        ]
        assert lines == rust[case["id"]], case["id"]
        compared += len(lines)
    assert compared > 30


def lines_of(motion: ss.Motion, times: Any) -> list[str]:
    """The events and states of a structure as the Rust program prints them."""
    lines = [
        f"event {event['kind']} {max(event['contact'], event['stop'])} {bits(event['time'])}"
        for event in motion.events
    ]
    q, v = motion.sample(times)
    memory = motion.sample_memory(times)
    return lines + [f"state {bits(np.concatenate(state))}" for state in zip(q, v, memory)]


@pytest.mark.parametrize("name", STRUCTURES)
def test_structures_have_the_bits_of_rust(name: str, rust: dict[str, list[str]]) -> None:
    compared = 0
    for case in reference.cases(name):
        system = reference.structure(case["system"])
        if system is None or case["id"] not in rust:
            continue
        motion = system.simulate(reference.start(case), float(case["t_end"]))
        times = reference.floats([state["t"] for state in case["states"]])
        assert lines_of(motion, times) == rust[case["id"]], case["id"]
        compared += 1
    assert compared >= 6


def test_other_elements_have_the_bits_of_rust(rust: dict[str, list[str]]) -> None:
    load = ss.PolynomialSpring([0.2, 0.0, 0.1])
    belt = ss.Contact(
        0, ss.Stribeck(0.4, 0.25, 0.3, 1), 1.0, belt_velocity=0.3, load_laws=[(1, load)]
    )
    table = ss.TabulatedForce([(-1.0, -1.0), (0.0, 0.0), (1.0, 2.0)])
    factor = ss.Drive.harmonic(0.2, 0.7) + 1.0
    lag = ss.FirstOrder(
        time_constant=0.5, velocities={1: 2.0}, laws=[(0, ss.Backlash(1.0, 0.1))], forces={0: -0.7}
    )
    system = (
        ss.Structure([1.0, 2.0])
        .with_ground_spring(0, 4.0)
        .with_spring(0, 1, 3.0)
        .with_ground_damper(1, 0.2)
        .with_force(0, ss.Drive.harmonic(0.3, 1.3, 0.2))
        .with_contact(belt)
        .with_contact(ss.Contact(1, ss.Capstan(0.3, 0.2, 2.0), 0.4))
        .with_element(ss.ForceElement({0: 1.0, 1: -1.0}, table, factor=factor))
        .with_first_order(lag)
    )
    motion = system.simulate(([0.1, -0.2], [0.3, 0.4], [0.05]), 30.0)
    assert len(motion.events) > 10
    assert lines_of(motion, np.arange(31.0)) == rust["elements"]


def test_brakes_and_passages_have_the_bits_of_rust(rust: dict[str, list[str]]) -> None:
    brake = ss.PhysicalMassOnBelt(
        ss.Stribeck(0.45, 0.35, 0.05, 1),
        mass=4.0,
        stiffness=1.0e6,
        normal_force=800.0,
        belt_velocity=0.03,
        damping=20.0,
    )
    system = brake.dimensionless
    # The law at speed 1 is that at the unit of velocity.
    unit = brake.length * brake.angular_frequency
    assert system.law.kinetic(1.0) == brake.law.kinetic(unit)
    numbers = [system.belt_velocity, system.damping, system.load, unit]
    lines = ["numbers " + bits([*numbers, brake.length, brake.angular_frequency])]
    cycles = ss.limit_cycles(system)
    lines += [f"cycle {bits([it.period, it.amplitude, it.multiplier])}" for it in cycles]
    ranges = ss.vibration_ranges(brake, 0.005, 0.5)
    lines += [f"range {bits([it.low, it.high])}" for it in ranges]
    assert len(lines) == 4 and lines == rust["brake"]

    law = ss.RateState(f0=0.6, a=0.01, b=0.015, d_c=8e-3, v0=1e-6)
    fault = (
        ss.Structure([3.90625e6])
        .with_ground_spring(0, 1.5625e7)
        .with_ground_damper(0, 4.6e6)
        .with_force(0, 4.6e6 * 1e-9)
        .with_contact(ss.Contact(0, law, 5e7, belt_velocity=1e-9))
    )
    start = ([1.92], [0.0], [6.9], {0: -1.2e-9})
    lines = []
    for passage in ss.section_through(fault, start, 0, 1e-10, 5, skip=1):
        q, v, memory, sliding = passage.state
        numbers = [passage.time, *q, *v, *memory, sliding[0]]
        lines.append(f"passage {str(passage.rises).lower()} {bits(numbers)}")
    assert len(lines) == 5 and lines == rust["passages"]


KINDS = {"kv_close": ("close", 0), "kv_open": ("open", 0)}


def kind(name: str) -> tuple[str, int]:
    """The kind of an event and the direction of slip after it."""
    if name.startswith(("release_", "cross_to_")):
        word = "release" if name.startswith("release") else "crossing"
        return word, 1 if name.endswith("positive") else -1
    return KINDS.get(name, (name, 0))


@pytest.mark.parametrize("name", STRUCTURES[-3:])
def test_motions_are_those_of_the_reference(name: str) -> None:
    """Stops, laws by direction and with a rate, force elements: to the rounding of the motions."""
    compared = 0

    def meet(found: Any, expected: Any) -> None:
        nonlocal compared
        values = reference.floats(expected)
        np.testing.assert_array_less(np.abs(found - values), 5e-12 * np.maximum(1, np.abs(values)))
        compared += values.size

    for case in reference.cases(name):
        system = reference.structure(case["system"])
        # Rigid stops are not available.
        if system is None or "stops" in case["system"]:
            continue
        motion = system.simulate(reference.start(case), float(case["t_end"]))
        events = motion.events
        expected = [kind(event["kind"]) for event in case["events"]]
        assert list(zip(events["kind"], events["direction"])) == expected, case["id"]
        meet(events["time"], [event["t"] for event in case["events"]])
        times = reference.floats([state["t"] for state in case["states"]])
        q, v = motion.sample(times)
        meet(q, [state["q"] for state in case["states"]])
        meet(v, [state["v"] for state in case["states"]])
        if "phi" in case["start"]:
            meet(motion.sample_memory(times), [state["phi"] for state in case["states"]])
            creeping = [
                i for i, it in enumerate(case["system"]["contacts"]) if it["law"] == "rate_state"
            ]
            r = np.stack([motion.sliding_velocity(times, contact) for contact in creeping], 1)
            given = reference.floats([state["r"] for state in case["states"]])
            np.testing.assert_allclose(r, given, rtol=1e-9)
            compared += r.size
    assert compared > 150, compared


def least_time(call: Callable[[], object], repeats: int = 1) -> float:
    """The least time of a call, in seconds."""
    least = np.inf
    for _ in range(9):
        begin = time.perf_counter()
        for _ in range(repeats):
            call()
        least = min(least, (time.perf_counter() - begin) / repeats)
    return float(least)


@pytest.mark.skipif("TIMES" not in os.environ, reason="measures times: set TIMES=1")
def test_work_takes_at_most_twice_the_time_of_rust(rust: dict[str, list[str]]) -> None:
    system = ss.MassOnBelt(ss.Polynomial(0.4, 0.25, 0.5), 0.2, damping=0.05)
    structure = system.structure()
    motion = system.simulate((0.0, 0.0), 1000.0)
    of_structure = structure.simulate(([0.0], [0.0]), 1000.0)
    times = 1000.0 * np.arange(100_000) / 100_000
    work: dict[str, Callable[[], object]] = {
        "run": lambda: system.simulate((0.0, 0.0), 1000.0),
        "run of a structure": lambda: structure.simulate(([0.0], [0.0]), 1000.0),
        "cycles": lambda: ss.limit_cycles(system),
        "samples": lambda: motion.sample(times),
        "samples of a structure": lambda: of_structure.sample(times),
    }
    ratios = {}
    for name, call in work.items():
        taken, in_rust = least_time(call), float(rust[f"time of {name}"][0])
        print(f"{name}: {1e3 * taken:.3g} ms, {taken / in_rust:.2f} times that of Rust")
        ratios[name] = taken / in_rust
    assert max(ratios.values()) < 2.0, ratios


@pytest.mark.skipif("TIMES" not in os.environ, reason="measures times: set TIMES=1")
def test_a_call_costs_at_most_20_us() -> None:
    law = ss.Polynomial(0.4, 0.25, 0.5)
    system = ss.MassOnBelt(law, 0.2, damping=0.05)
    contact = ss.Contact(0, law, 1.0, belt_velocity=0.2)
    block = ss.Structure([1.0]).with_ground_spring(0, 1.0).with_contact(contact)
    motions = system.simulate((0.0, 0.0), 10.0), block.simulate(([0.0], [0.0]), 10.0)
    calls: dict[str, Callable[[], object]] = {
        "a property": lambda: motions[0].duration,
        "law.kinetic": lambda: law.kinetic(0.3),
        "a law": lambda: ss.Polynomial(0.4, 0.25, 0.5),
        "a system": lambda: ss.MassOnBelt(law, 0.2, damping=0.05),
        "a drive": lambda: ss.Drive.harmonic(0.1, 2.0),
        "a contact": lambda: ss.Contact(0, law, 1.0, belt_velocity=0.2),
        "a structure": lambda: ss.Structure([1.0]),
        "with_contact": lambda: block.with_contact(contact),
        "sample": lambda: motions[0].sample(3.0),
        "state_at": lambda: motions[1].state_at(3.0),
        "events": lambda: motions[1].events,
        "simulate": lambda: system.simulate((0.0, 0.0), 0.0),
    }
    taken = {name: 1e6 * least_time(call, 500) for name, call in calls.items()}
    print({name: round(us, 2) for name, us in taken.items()})
    assert max(taken.values()) < 20.0, taken
