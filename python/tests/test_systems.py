"""Masses on belts and structures: construction, motions, samples, energies, errors."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import stick_slip as ss

LAW = ss.Polynomial(0.4, 0.25, 0.5)


def test_both_systems_of_units_move_alike() -> None:
    """kg, N, m against the dimensionless system: time in 1/omega, length g/omega^2 = 1 m here."""
    mass, stiffness, force, speed = 2.0, 8.0, 6.0, 0.3
    omega = math.sqrt(stiffness / mass)
    brake = ss.PhysicalMassOnBelt(
        ss.Coulomb(0.4, 0.25),
        mass=mass,
        stiffness=stiffness,
        normal_force=force,
        belt_velocity=speed,
        damping=0.4,
    )
    belt = ss.MassOnBelt(
        ss.Coulomb(0.4, 0.25),
        speed / omega,
        damping=0.4 / (2 * mass * omega),
        load=force / stiffness,
    )
    si, plain = brake.simulate((0.0, 0.0), 10.0), belt.simulate((0.0, 0.0), 10.0 * omega)
    assert list(si.events["kind"]) == list(plain.events["kind"])
    np.testing.assert_allclose(si.events["time"] * omega, plain.events["time"], rtol=1e-13)
    u, v = si.sample(3.3)
    assert (u, v / omega) == pytest.approx(plain.sample(3.3 * omega), abs=1e-13)
    assert brake.friction_force((0.0, 0.0)) == pytest.approx(0.25 * force)
    assert brake.acceleration((0.0, 0.0)) == pytest.approx(0.25 * force / mass)
    low, high = brake.stick_limits
    assert (low, high) == pytest.approx(((-2.4 - 0.12) / 8, (2.4 - 0.12) / 8))
    assert brake.release_state == (pytest.approx(high), speed)
    sliding = brake.equilibrium
    assert sliding is not None and sliding.displacement == pytest.approx(1.5 / 8)
    # As a structure of one mass.
    q, v = brake.structure().simulate((0.0, 0.0), 10.0).last
    assert (q[0], v[0]) == pytest.approx(si.last, abs=1e-12)
    assert brake.replace(normal_force=1.0).normal_force == 1.0
    assert "normal_force=6.0" in repr(brake)


def test_samples_modes_and_events() -> None:
    motion = ss.MassOnBelt(LAW, 0.2, damping=0.05).simulate((0.0, 0.0), 10.0)
    events = motion.events
    assert events.dtype.names == ("time", "contact", "stop", "kind", "direction")
    assert list(events["contact"]) == [0] * 4 and list(events["stop"]) == [-1] * 4
    assert list(events["kind"]) == ["stick", "release", "stick", "release"]
    assert list(events["direction"]) == [0, -1, 0, -1]
    u, v = motion.sample([0.0, *events["time"], 10.5, math.nan])
    assert np.isnan(u[-2:]).all() and np.isnan(v[-2:]).all()
    assert (v[1:5] == 0.2).all()
    modes = motion.modes([-1.0, 0.0, *events["time"], 11.0])
    assert list(modes) == [-128, -1, 0, -1, 0, -1, -128]
    assert motion.mode_at(events["time"][0]) == "stick"
    assert motion.mode_at(0.0) == "slip" and motion.mode_at(99.0) is None
    with pytest.raises(IndexError, match="no contact 1"):
        motion.mode_at(0.0, 1)
    assert motion.ended == "duration" and motion.end_time == motion.duration == 10.0
    for times in (range(5), [0, 1], np.float32([0.5, 1.5]), np.array([0.5]), [0.5], np.zeros(0)):
        assert motion.sample(times)[0].shape == (len(times),)
        assert motion.sample_memory(times).shape == (len(times), 0)
    for time in (1, np.float64(0.5), np.array(0.5)):
        assert isinstance(motion.sample(time)[0], float)
    assert isinstance(LAW.kinetic(np.array([0.5])), np.ndarray)
    with pytest.raises(TypeError, match="one-dimensional"):
        motion.sample(np.zeros((2, 2)))
    with pytest.raises(TypeError, match="Structure"):
        motion.samples(0.1)


def test_until_stops_a_motion() -> None:
    system = ss.MassOnBelt(LAW, 0.2, damping=0.05)
    # The mass turns back for the first time: the number of the Rust documentation.
    motion = system.simulate((0.0, 0.0), 100.0, until=lambda u, v: v - 1e-300 if v < 0.2 else 1.0)
    assert motion.ended == "stopped"
    turn = system.simulate((0.1, 0.2), 100.0, until=lambda u, v: v)
    assert turn.ended == "stopped" and abs(turn.last[1]) < 1e-15
    blocks = ss.Structure([1.0]).with_ground_spring(0, 1.0)
    half = blocks.simulate(([1.0], [0.0]), 10.0, until=lambda q, v: q[0])
    assert half.duration == pytest.approx(math.pi / 2, abs=1e-15)
    with pytest.raises(KeyError) as caught:
        blocks.simulate(([1.0], [0.0]), 10.0, until=lambda q, v: {}["missing"])
    assert isinstance(caught.value.found, ss.Motion)  # type: ignore[attr-defined]


def test_starts_are_read_in_many_ways() -> None:
    belt = ss.MassOnBelt(LAW, 0.2)
    for start in ((0, 0), [0.0, 0.0], np.zeros(2)):
        assert belt.simulate(start, 1.0).last == belt.simulate((0.0, 0.0), 1.0).last
    block = ss.Structure([1.0]).with_ground_spring(0, 1.0)
    for start in ((1, 0), ([1], [0]), (np.ones(1), np.zeros(1)), np.array([[1.0], [0.0]])):
        assert block.simulate(start, 1.0).last[0] == pytest.approx(math.cos(1.0), abs=1e-15)
    for bad in (1.0, "ab", (1.0, 2.0, 3.0, 4.0), None):
        with pytest.raises(TypeError, match="start"):
            block.simulate(bad, 1.0)  # type: ignore[arg-type]
        with pytest.raises(TypeError, match="start"):
            belt.simulate(bad, 1.0)  # type: ignore[arg-type]
    with pytest.raises(ss.ParameterError) as caught:
        block.simulate(([1.0, 2.0], [0.0, 0.0]), 1.0)
    assert caught.value.variant == "WrongSize"


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
def test_numbers_that_are_none_are_refused(bad: float) -> None:
    for call in (
        lambda: ss.Polynomial(bad, 0.25, 0.5),
        lambda: ss.MassOnBelt(LAW, bad),
        lambda: ss.MassOnBelt(LAW, 0.2, damping=bad),
        lambda: ss.MassOnBelt(LAW, 0.2, load=bad),
        lambda: ss.MassOnBelt(LAW, 0.2).simulate((bad, 0.0), 1.0),
        lambda: ss.MassOnBelt(LAW, 0.2).simulate((0.0, 0.0), bad),
        lambda: ss.MassOnBelt(LAW, 0.2).simulate((0.0, 0.0), 1.0, tolerance=bad),
        lambda: ss.Structure([bad]),
        lambda: ss.Structure([1.0]).with_ground_spring(0, bad),
        lambda: ss.Contact({0: bad}, LAW, 1.0),
        lambda: ss.Drive.harmonic(bad, 1.0),
        lambda: ss.Drive.profile([(0.0, bad)]),
        lambda: ss.hopf_velocities(ss.MassOnBelt(LAW, 0.2), bad, 1.0),
        lambda: ss.diagram(ss.MassOnBelt(LAW, 0.2), [bad]),
        lambda: ss.shoot(ss.MassOnBelt(LAW, 0.2), (0.1, 0.2), estimate=bad),
        lambda: ss.section(ss.MassOnBelt(LAW, 0.2), (0.1, 0.2), bad, 3),
        lambda: ss.Backlash(bad, 0.1),
    ):
        with pytest.raises(ss.StickSlipError):
            call()


def test_errors_carry_their_numbers() -> None:
    with pytest.raises(ValueError, match="minimum_coefficient = 0.5 is not allowed") as caught:
        ss.Polynomial(0.4, 0.5, 0.5)
    error = caught.value
    assert isinstance(error, ss.ParameterError) and isinstance(error, RuntimeError)
    assert (error.variant, error.name, error.value) == (
        "InvalidParameter",
        "minimum_coefficient",
        0.5,
    )
    with pytest.raises(ss.StickSlipError) as stopped:
        ss.MassOnBelt(LAW, 0.2).simulate((0.0, 0.0), 100.0, max_steps=5)
    assert stopped.value.limit == 5 and stopped.value.variant == "TooManySteps"
    q, v, memory, sliding = stopped.value.state
    found = stopped.value.found
    assert found.end_time == stopped.value.time
    assert (q[0], v[0]) == pytest.approx(found.last)
    with pytest.raises(AttributeError):
        _ = error.missing
    with pytest.raises(IndexError, match="counted from 0"):
        ss.Structure([1.0]).with_ground_spring(-1, 1.0)
    with pytest.raises(ss.ParameterError) as beyond:
        ss.Structure([1.0]).with_ground_spring(1, 1.0)
    assert beyond.value.coordinate == 1 and beyond.value.count == 1
    with pytest.raises(ss.StickSlipError) as none:
        ss.Structure([1.0]).with_contact(ss.Contact(0, LAW, 1.0)).steady_sliding()
    assert none.value.variant == "NoSteadySliding" and none.value.contact == 0


def test_every_variant_of_the_crate_has_its_fields() -> None:
    """The names in the source of the crate, each with its numbers in the package."""
    from pathlib import Path
    import re

    root = Path(__file__).resolve().parents[2]
    if not (root / "src" / "error.rs").exists():
        pytest.skip("the source of the crate is in a clone only")
    source = (root / "src" / "error.rs").read_text()
    source = source[source.index("pub enum Error {") :]
    variants = set(re.findall(r"^    ([A-Z]\w+)(?: \{|\(|,)", source, re.M))
    package = (root / "python" / "src" / "error.rs").read_text()
    named = set(re.findall(r"Error::(\w+)", package))
    plain = {"NotSmooth", "NoHopfPoint", "NoCommonPeriod", "NotFree", "AtRest"}
    assert variants - named - plain <= {"CoordinateTaken"}
    source = (root / "src" / "error" / "structure.rs").read_text()
    source = source[source.index("pub enum NotSliding {") :]
    reasons = set(re.findall(r"^    ([A-Z]\w+) \{", source, re.M))
    assert len(reasons) > 8 and reasons <= set(re.findall(r"NotSliding::(\w+)", package))


def test_messages_name_what_python_has() -> None:
    """Each name of the crate in its messages has its name here."""
    from pathlib import Path
    import re

    root = Path(__file__).resolve().parents[2]
    if not (root / "src" / "error.rs").exists():
        pytest.skip("the source of the crate is in a clone only")
    sources = ["error.rs", "error/structure.rs", "structure/contact.rs", "friction/fault.rs"]
    lines = "\n".join((root / "src" / source).read_text() for source in sources).splitlines()
    said = "\n".join(line for line in lines if not line.lstrip().startswith("//"))
    names = {name for name in re.findall(r"`([^`\n]*)`", said) if "::" in name or "with_" in name}
    names |= {"flow", "simulate_until", "steady_sliding_from", "kinetic_on"}
    names -= {"Contact::freewheel", "with_drag"}  # of an argument that Python has not
    package = (root / "python" / "src" / "error.rs").read_text()
    assert len(names) > 10 and [name for name in names if f"`{name}`" not in package] == []
    with pytest.raises(ss.StickSlipError, match="with `max_steps=`, or shorten the run") as steps:
        ss.MassOnBelt(LAW, 0.2).simulate((0.0, 0.0), 100.0, max_steps=5)
    assert "flow" not in str(steps.value)
    [kink] = ss.Law(lambda s: 0.3 + 0.1 * np.abs(s - 1), static=0.5).check(0.0, 3.0)
    assert "a list of functions" in kink


def test_arguments_of_other_kinds_say_what_is_expected() -> None:
    for call in (
        lambda: ss.MassOnBelt(lambda s: 0.3, 0.2),  # type: ignore[arg-type]
        lambda: ss.MassOnBelt(ss.Dahl(0.3, 1.0), 0.2),  # type: ignore[arg-type]
        lambda: ss.Contact(0, 0.3, 1.0),  # type: ignore[arg-type]
        lambda: ss.Directional(LAW, 0.3),  # type: ignore[arg-type]
    ):
        with pytest.raises(TypeError, match=r"Law\(function, static=0.4\)"):
            call()
    block = ss.Structure([1.0])
    with pytest.raises(TypeError, match="vibration_ranges"):
        ss.silencing_damping(block)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="expected a Structure"):
        ss.classify(3.0, (0.0, 0.0))  # type: ignore[arg-type]
    force: Any = lambda x, v: x
    for call in (
        lambda: ss.ForceElement(0, force),
        lambda: ss.FirstOrder(laws=[(0, force)]),
        lambda: ss.Contact(0, LAW, 1.0, load_laws=[(0, force)]),
    ):
        with pytest.raises(TypeError, match=r"ForceLaw\(function\)"):
            call()
    with pytest.raises(TypeError, match="Drive.function"):
        block.with_force(0, lambda t: t)  # type: ignore[arg-type]


def test_drives_add_up() -> None:
    drive = 1.0 + ss.Drive.harmonic(0.5, 2.0, phase=0.3) + ss.Drive.sine(0.1, 4.0) + 2
    assert drive(0.7) == pytest.approx(3 + 0.5 * math.cos(1.7) + 0.1 * math.sin(2.8))
    assert drive.period == pytest.approx(math.pi)
    assert drive.slope(0.7) == pytest.approx(-math.sin(1.7) + 0.4 * math.cos(2.8))
    step = ss.Drive.profile(np.array([[1.0, 0.0], [1.0, 5.0]]))
    np.testing.assert_array_equal(step([0.9, 1.0]), [0.0, 5.0])
    assert "Drive.profile" in repr(drive + step)
    with pytest.raises(TypeError):
        _ = drive + "1"  # type: ignore[operator]


def blocks() -> ss.Structure:
    law = ss.Rational(1.0, 3.0)
    return (
        ss.Structure([1.0, 1.0])
        .with_ground_spring(0, 1.0)
        .with_ground_spring(1, 1.0)
        .with_spring(0, 1, 1.2)
        .with_contact(ss.Contact(0, law, 1.0, belt_velocity=0.17))
        .with_contact(ss.Contact(1, law, 1.3, belt_velocity=0.17))
    )


def test_structures_have_matrices_and_energies() -> None:
    system = blocks()
    np.testing.assert_array_equal(system.stiffness, [[2.2, -1.2], [-1.2, 2.2]])
    np.testing.assert_array_equal(system.mass_matrix, np.eye(2))
    assert len(system) == 2 and system.contacts == 2 and system.period is None
    same = ss.Structure(mass_matrix=np.eye(2), stiffness=[[2.2, -1.2], [-1.2, 2.2]])
    np.testing.assert_array_equal(same.stiffness, system.stiffness)
    motion = system.simulate(([0.2, -0.4], [0.0, 0.1]), 60.0)
    assert set(motion.events["contact"]) == {0, 1}
    budget = motion.energy_budget()
    assert abs(budget.defect) < 1e-13 * abs(budget.drive_work.sum())
    samples = motion.samples(0.01)
    assert len(samples) == 6001 and samples.friction.shape == (6001, 2)
    # M a + K q + friction = 0 at every instant.
    rest = samples.accelerations + samples.displacements @ system.stiffness + samples.friction
    assert np.abs(rest).max() < 1e-13
    np.testing.assert_array_equal(samples.modes[:, 1], motion.modes(samples.time, 1))
    state = (samples.displacements[7], samples.velocities[7])
    np.testing.assert_allclose(system.acceleration(0.07, state), samples.accelerations[7])
    assert [it.is_determined for it in system.carried(0.07, state)] == [True, True]
    total = system.kinetic_energy(state) + system.elastic_energy(0.0, state)
    assert total > 0
    sliding = system.steady_sliding()
    np.testing.assert_allclose(
        system.stiffness @ sliding.displacements, [1.0 / 1.51, 1.3 / 1.51], rtol=1e-14
    )
    assert len(sliding.eigenvalues) == 4 and not sliding.is_stable
    with pytest.raises(ValueError, match="either masses or mass_matrix"):
        ss.Structure()


def test_dependent_contacts_slip_in_mechanisms() -> None:
    law = ss.Coulomb(1.0, 1.0)
    ring = ss.Structure([1.0, 1.0])
    ring = ring.with_force(0, 6.0)
    for contact in (
        ss.Contact(0, law, 3.0),
        ss.Contact(1, law, 5.0),
        ss.Contact.between(0, 1, law, 4.0),
    ):
        ring = ring.with_contact(contact)
    mechanisms = ring.mechanisms(0.0, ([0.0, 0.0], [0.0, 0.0]))
    assert len(mechanisms) == 6
    following = min(mechanisms, key=lambda it: it.margin)
    assert [contact for contact, _ in following.contacts] == [0, 2]
    assert abs(following.margin - 1.0) < 1e-14


def test_joints_open_and_slip() -> None:
    law = ss.Coulomb(0.25, 0.25)
    joint = ss.Contact(0, law, 1.0, tangential_stiffness=0.35)
    assert joint.tangential_stiffness == 0.35 and joint.direction == {0: 1.0}
    driven = (
        ss.Structure([1.0], stiffness=[[0.65]], damping=[[0.02]])
        .with_force(0, ss.Drive.harmonic(0.6, 0.85))
        .with_contact(joint)
    )
    orbit = ss.settle(driven, ([0.0], [0.0], [0.0]), 500.0, periods=1)
    exact = ss.analysis.symmetric_response(1.0, 0.02, 0.65, 0.35, 0.25, 0.6, 0.85)
    assert exact is not None
    assert orbit.amplitude() == pytest.approx(exact.amplitude, rel=1e-12)
    with pytest.raises(ss.ParameterError) as caught:
        ss.Contact(0, ss.Coulomb(0.4, 0.3), 1.0, tangential_stiffness=1.0)
    assert caught.value.variant == "LawNotConstant" and caught.value.coefficients == [0.4, 0.3]
    pieces = ss.Contact(0, ss.Coulomb(1.0, 1.0), 1.0).in_parallel([(1.0, 0.1), (2.0, 0.4)])
    assert [piece.tangential_stiffness for piece in pieces] == [1.0, 2.0]
    bouncing = ss.Contact({0: 1.0}, ss.Coulomb(0.3, 0.3), 0.5, normal_spring=({1: 1.0}, 2.0),
                          load_gradient=None)
    motion = (
        ss.Structure([1.0, 1.0], stiffness=np.eye(2))
        .with_contact(bouncing)
        .simulate(([0.0, 0.0], [0.1, 3.0]), 10.0)
    )
    assert {"open", "close"} <= set(motion.events["kind"])
    clutch = ss.Contact.between(0, 1, ss.Coulomb(0.36, 0.3), 4.0)
    shafts = ss.Structure([1.0, 0.5]).with_contact(clutch)
    locked = shafts.simulate(([0.0, 0.0], [5.0, 0.0]), 5.0)
    assert locked.events["time"][0] == pytest.approx(5.0 / (1.2 + 2.4), abs=1e-15)
    q, v = locked.last
    assert v == pytest.approx([5 / 1.5, 5 / 1.5])
    at = shafts.steady_sliding(velocities=[5.0, 0.0])
    assert at.accelerations == pytest.approx([-1.2, 2.4])


@pytest.mark.parametrize(
    ("law", "formula"),
    [
        (ss.PolynomialSpring([1.0, 0.0, 0.7]), lambda x: x + 0.7 * x**3),
        (ss.Pendulum(0.4, 0.7), lambda x: 0.4 * math.sin(x / 0.7)),
        (ss.Backlash(8.0, 0.25), lambda x: 8 * (x - 0.25 if x > 0.25 else min(x + 0.25, 0.0))),
        (ss.SnapThrough(1.0, 1.0, 0.5), lambda x: x * (1 - 1 / math.hypot(x, 0.5))),
        (
            ss.TabulatedForce([(-2.0, -2.0), (0.0, 0.0), (2.0, 6.0)], piecewise_linear=True),
            lambda x: x if x < 0 else 3 * x,
        ),
    ],
)
def test_force_elements_have_their_formulas(law: ss.ForceLaw, formula: Any) -> None:
    for x in (-1.5, -0.1, 0.0, 0.2, 1.1):
        assert law.force(x) == pytest.approx(formula(x), abs=1e-15)
    element = ss.ForceElement(0, law, factor=2.0)
    system = ss.Structure([1.0]).with_element(element)
    assert system.acceleration(0.0, ([1.1], [0.0]))[0] == pytest.approx(-2 * formula(1.1))
    assert repr(law) in repr(element) and system.elements == 1


def test_van_der_pol_has_its_cycle() -> None:
    damper = ss.ForceElement(0, ss.VanDerPol(1.0, 1.0))
    system = ss.Structure([1.0]).with_ground_spring(0, 1.0).with_element(damper)
    orbit = ss.settle(system, ([2.0], [0.0]), 60.0, estimate=6.6)
    # The period at mu = 1, known to many digits.
    assert orbit.period == pytest.approx(6.6632868593231301896996820305, rel=1e-12)
    assert orbit.amplitude() == pytest.approx(2.00861986087484313650940188, rel=1e-12)


def test_stability_along_a_profile() -> None:
    belt = ss.Drive.profile([(0.0, 0.1), (100.0, 1.0)])
    block = (
        ss.Structure([1.0])
        .with_ground_spring(0, 1.0)
        .with_ground_damper(0, 0.1)
        .with_contact(ss.Contact(0, LAW, 1.0, belt_velocity=belt))
    )
    [change] = block.stability_changes(0.0, 100.0)
    hopf = ss.hopf_velocities(ss.MassOnBelt(LAW, 0.2, damping=0.05), 0.1, 1.0)
    assert change.becomes_stable and belt(change.time) == pytest.approx(hopf[0])
    assert block.frozen(change.time).steady_sliding().eigenvalues.real == pytest.approx(
        [0, 0], abs=1e-12
    )


def test_forces_and_drives_of_ones_own() -> None:
    # Duffing's spring against the named one, and a cubic damper against its power.
    own = ss.ForceLaw(lambda x, v: x + 0.7 * x**3)
    named = ss.PolynomialSpring([1.0, 0.0, 0.7])
    ends = [
        ss.Structure([1.0]).with_element(ss.ForceElement(0, law)).simulate(([2.0], [0.0]), 9.0).last
        for law in (own, named)
    ]
    np.testing.assert_allclose(ends[0], ends[1], atol=1e-13)
    damped = ss.Structure([1.0]).with_ground_spring(0, 1.0)
    damped = damped.with_element(ss.ForceElement(0, ss.ForceLaw(lambda x, v: 0.2 * v**3)))
    motion = damped.simulate(([1.0], [0.0]), 20.0)
    budget = motion.energy_budget()
    assert abs(budget.defect) < 1e-14 and budget.element_work[0] < -0.3
    play = ss.ForceLaw(
        [lambda x, v: 8 * (x + 0.25), lambda x, v: 0 * x, lambda x, v: 8 * (x - 0.25)],
        breakpoints=[-0.25, 0.25],
    )
    for x in (-1.0, -0.1, 0.3):
        assert play.force(x) == ss.Backlash(8.0, 0.25).force(x)
    with pytest.raises(TypeError, match="breakpoints where they meet"):
        ss.ForceLaw(lambda x, v: x if v > 0 else -x)
    # A shock of half a sine on an oscillator of angular frequency 2: v = -2/3 at its end.
    shock = ss.Drive.function(
        [lambda t: 0 * t, lambda t: np.sin(t), lambda t: 0 * t],
        size=1.0,
        timescale=1.0,
        breakpoints=[0.0, math.pi],
    )
    struck = ss.Structure([1.0]).with_ground_spring(0, 4.0).with_force(0, shock)
    q, v = struck.simulate(([0.0], [0.0]), math.pi).last
    assert abs(q[0]) < 1e-15 and v[0] == pytest.approx(-2 / 3, abs=1e-15)
    bumps = ss.Drive.function(
        lambda t: np.exp(-(((t - 1) / 0.01) ** 2)), size=1.0, timescale=0.01, period=2.0
    )
    assert (1.0 + bumps)(2e6 + 1.0) == 2.0 and bumps.period == 2.0
    with pytest.raises(ss.ParameterError):
        ss.Drive.function(lambda t: t, size=1.0, timescale=-1.0)


def test_what_is_not_there_or_does_not_fit_is_refused() -> None:
    block = ss.Structure([1.0]).with_ground_spring(0, 1.0)
    with_contact = block.with_contact(ss.Contact(0, LAW, 1.0, belt_velocity=0.2))
    belt = ss.MassOnBelt(LAW, 0.2)
    motions = [belt.simulate((0.0, 0.0), 5.0), with_contact.simulate(([0.1], [0.0]), 5.0)]
    for motion in motions:
        assert motion.contacts == 1 and motion.mode_at(99.0) is None
        with pytest.raises(IndexError, match="no contact 1: there are 1"):
            motion.modes([0.0], 1)
        with pytest.raises(IndexError, match="no contact 2"):
            motion.mode_at(0.0, 2)
    with pytest.raises(IndexError, match="no contact 1"):
        motions[1].sliding_velocity([0.0], 1)
    free = block.simulate(([0.1], [0.0]), 1.0)
    assert free.contacts == 0
    with pytest.raises(IndexError, match="no contact 0: there are 0"):
        free.mode_at(0.5)
    cycle = ss.stick_slip_cycle(belt)
    orbit = ss.shoot(belt, cycle.state, estimate=cycle.period)
    for count in (10**8, 2**62):
        for call in (cycle.harmonics, cycle.velocity_harmonics, cycle.acceleration_harmonics):
            with pytest.raises(ValueError, match="too many"):
                call(count)
        for call in (orbit.harmonics, orbit.velocity_harmonics, orbit.acceleration_harmonics):
            with pytest.raises(ValueError, match="too many"):
                call(count)
        with pytest.raises(ValueError, match="too many"):
            ss.analysis.duffing_friction_decay(1.0, 1.0, 1.0, 1e-12, 1e-12, 1.0, count=count)
    for interval in (5e-324, 1e-9):
        with pytest.raises(ValueError, match="too many"):
            motions[1].samples(interval)
    for interval in (0.0, -1.0, math.nan, math.inf):
        with pytest.raises(ss.ParameterError):
            motions[1].samples(interval)


def test_what_is_no_real_number_is_refused() -> None:
    motion = ss.MassOnBelt(LAW, 0.2).simulate((0.0, 0.0), 1.0)
    calls: list[Any] = [
        LAW.kinetic,
        ss.Drive.harmonic(1.0, 2.0),
        motion.sample,
        motion.modes,
        ss.PolynomialSpring,
        ss.Structure,
        lambda it: ss.Structure([1.0], stiffness=[it]),
        lambda it: ss.Tabulated([(0.0, 0.4), it]),
        lambda it: ss.diagram(ss.MassOnBelt(LAW, 0.2), it),
    ]
    for call in calls:
        for bad in (
            np.array([1.0 + 2.0j, 1.0]),
            ["1.0", "2.0"],
            [None, 1.0],
            np.array([1.0, "2"], dtype=object),
            np.array(["2020-01-01"], dtype="datetime64[D]"),
            b"ab",
        ):
            with pytest.raises(TypeError, match="number"):
                call(bad)
    for good in ([0, 1], (0.0, 1.0), np.array([0, 1], dtype=np.uint8), np.arange(4.0)[1:3][::-1]):
        assert np.array_equal(LAW.kinetic(good), LAW.kinetic(np.asarray(good, dtype=float)))
    assert motion.sample([])[0].shape == (0,) and LAW.kinetic(np.zeros((0, 2))).shape == (0, 2)


def test_numbers_are_shown_as_python_shows_them() -> None:
    for number in (1e20, 1.5e-7, 1e100, -2.5e-300, 0.1, 1e-5, 3.0):
        assert repr(ss.Drive.constant(number)) == repr(number)
    long = ss.MassOnBelt(LAW, 0.2).structure().simulate(([0.0], [0.2]), 1.0, start_time=1 / 3e7)
    assert "from 3.33333e-08 to" in repr(long)
