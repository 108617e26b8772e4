"""Laws by direction or with a rate, loads of any shape, stops, first-order states, restarts."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import stick_slip as ss

DRY = ss.Coulomb(0.4, 0.3)
FAULT = ss.RateState(f0=0.6, a=0.01, b=0.015, d_c=8e-3, v0=1e-6)


def fault() -> ss.Structure:
    contact = ss.Contact(0, FAULT, 5e7, belt_velocity=1e-9)
    return ss.Structure([4e6]).with_ground_spring(0, 1.6e7).with_contact(contact)


def test_friction_by_direction() -> None:
    law = ss.Directional(ss.Coulomb(0.2, 0.1), ss.Exponential(0.7, 0.5, 1.0))
    block = ss.Structure([2.0]).with_contact(ss.Contact(0, law, 10.0))
    # The forces that still hold it, and the accelerations of slip.
    for force, holds in ((1.99, True), (2.01, False), (-6.99, True), (-7.01, False)):
        motion = block.with_force(0, force).simulate(([0.0], [0.0]), 1.0)
        assert (motion.last[1][0] == 0.0) == holds, force
    forward, backward = (block.acceleration(0.0, ([0.0], [v])) for v in (1.0, -1.0))
    assert forward[0] == -0.5 and backward[0] == pytest.approx((0.5 + 0.2 / math.e) * 5)
    assert repr(law) == "Directional(Coulomb(0.2, 0.1), Exponential(0.7, 0.5, 1.0))"
    assert law.static_coefficient(1.0) is None
    # Laws of one's own on either side.
    own = ss.Law(lambda s: 0.5 + 0.2 * np.exp(-(s**2)), static=0.7)
    same = ss.Structure([2.0]).with_contact(
        ss.Contact(0, ss.Directional(ss.Coulomb(0.2, 0.1), own), 10.0)
    )
    ends = [system.simulate(([0.0], [-3.0]), 5.0).last for system in (block, same)]
    np.testing.assert_allclose(ends[0], ends[1], atol=1e-14)


def test_a_rope_on_a_drum() -> None:
    law = ss.Capstan(0.3, 0.2, 2 * math.pi)
    rope = ss.Structure([1.0]).with_contact(ss.Contact(0, law, 10.0))
    hold, give = 10 * math.expm1(0.6 * math.pi), 10 * -math.expm1(-0.6 * math.pi)
    for limit, sign in ((hold, 1.0), (give, -1.0)):
        pulled = rope.with_force(0, ss.Drive.profile([(0.0, 0.0), (100.0, 100.0 * sign)]))
        [event] = pulled.simulate(([0.0], [0.0]), 60.0).events
        assert event["kind"] == "release" and event["direction"] == sign
        assert event["time"] == pytest.approx(limit, rel=1e-14)
    sliding = rope.acceleration(0.0, ([0.0], [1.0]))
    assert sliding[0] == pytest.approx(-10 * math.expm1(0.4 * math.pi))
    with pytest.raises(ss.ParameterError) as caught:
        ss.Capstan(0.3, 0.4, 1.0)
    assert caught.value.name == "kinetic_coefficient"


def test_a_freewheel_lets_run_ahead() -> None:
    shafts = ss.Structure([1.0, 3.0]).with_force(0, ss.Drive.sine(1.0, 1.0))
    free = shafts.with_contact(ss.Contact.freewheel(0, 1))
    motion = free.simulate(([0.0, 0.0], [0.0, 0.0]), 4.0)
    assert motion.last[1][1] == pytest.approx(0.5, abs=1e-15)
    # The same by the law, and with drag: shaft 1 then slows down by 0.3 * 2/3. It is held until
    # 3/4 sin t = -0.6.
    law = ss.Freewheel(ss.Coulomb(0.3, 0.3))
    dragged = [
        shafts.with_contact(contact).simulate(([0.0, 0.0], [0.0, 0.0]), 6.0)
        for contact in (
            ss.Contact.freewheel(0, 1, drag=ss.Coulomb(0.3, 0.3), load=2.0),
            ss.Contact.between(0, 1, law, 2.0),
        )
    ]
    np.testing.assert_array_equal(dragged[0].last, dragged[1].last)
    [release] = dragged[0].events
    assert release["kind"] == "release" and release["direction"] == -1
    assert release["time"] == pytest.approx(math.pi + math.asin(0.8), abs=1e-14)
    v = dragged[0].sample(release["time"])[1][1]
    assert dragged[0].last[1][1] == pytest.approx(v - 0.2 * (6.0 - release["time"]))
    assert repr(ss.Contact.freewheel(0, 1)) == "Contact({0: 1.0, 1: -1.0}, Freewheel(), 1.0)"
    assert repr(law) == "Freewheel(Coulomb(0.3, 0.3))"
    with pytest.raises(ss.StickSlipError) as wrong:
        free.simulate(([0.0, 0.0], [1.0, 0.0]), 4.0)
    assert wrong.value.variant == "WrongWay"
    assert (wrong.value.contact, wrong.value.velocity) == (0, 1.0)
    # Two backstops that face each other, and a belt that moves between them.
    ways = [ss.Contact({0: sign}, ss.Freewheel(), 1.0, belt_velocity=-0.1) for sign in (1.0, -1.0)]
    with pytest.raises(ss.StickSlipError) as jammed:
        ss.Structure([1.0]).with_contacts(ways).simulate(([0.0], [-0.1]), 1.0)
    assert jammed.value.variant in ("Jammed", "WrongWay")


def test_rate_and_state() -> None:
    assert isinstance(FAULT, ss.ContactLaw)
    np.testing.assert_allclose(
        FAULT.steady([1e-6, 1e-5]), [0.6, 0.6 - 0.005 * math.log(10)], rtol=1e-15
    )
    assert FAULT.memory_at(1e-5) == pytest.approx(-math.log(10))
    # The eigenvalues of steady sliding cross the imaginary axis at the critical stiffness.
    law = ss.RateState(f0=0.4, a=0.1, b=(0.2, 0.1), d_c=(0.06, 0.3), v0=0.05)
    for it in (law, ss.RateState(f0=0.4, a=0.1, b=0.3, d_c=0.06, v0=0.05, evolution="slip")):
        critical = it.critical_stiffness(load=2.0, speed=0.05, mass=0.5, damping=0.1)
        omega = it.hopf_frequency(load=2.0, speed=0.05, damping=0.1)
        assert critical is not None and omega is not None
        block = (
            ss.Structure([0.5])
            .with_ground_spring(0, critical)
            .with_ground_damper(0, 0.1)
            .with_contact(ss.Contact(0, it, 2.0, belt_velocity=0.05))
        )
        pair = block.steady_sliding().eigenvalues[:2]
        assert pair == pytest.approx([1j * omega, -1j * omega], abs=1e-10)
    assert repr(law) == (
        "RateState(f0=0.4, a=0.1, b=(0.2, 0.1), d_c=(0.06, 0.3), v0=0.05, evolution='aging')"
    )
    assert FAULT.critical_stiffness(load=1.0, speed=1e-6, damping=1e9) is None
    # The slip law has no power series at rest.
    slip: dict[str, Any] = dict(f0=0.4, a=0.1, b=0.2, d_c=0.1, v0=0.1, evolution="slip")
    start = ([0.0], [1.0], [0.0])
    with pytest.raises(ss.StickSlipError) as caught:
        ss.Structure([1.0]).with_ground_spring(0, 1.0).with_contact(
            ss.Contact(0, ss.RateState(**slip), 0.1)
        ).simulate(start, 10.0)
    assert caught.value.variant == "NotAnalytic"
    passing = ss.Contact(0, ss.RateState(**slip, least_speed=1e-31), 0.1)
    motion = (
        ss.Structure([1.0]).with_ground_spring(0, 1.0).with_contact(passing).simulate(start, 10.0)
    )
    assert list(motion.events["kind"])[:2] == ["crossing", "crossing"]
    with pytest.raises(ValueError, match="'aging' or 'slip'"):
        ss.RateState(f0=0.4, a=0.1, b=0.2, d_c=0.1, v0=0.1, evolution="ageing")
    for b in ((0.2, 0.1), (0.2, 0.1, 0.1), ()):
        with pytest.raises(ValueError, match="two numbers or two pairs"):
            ss.RateState(f0=0.4, a=0.1, b=b, d_c=0.1, v0=0.1)  # type: ignore[arg-type]


def test_formulas_of_rate_and_state() -> None:
    analysis = ss.analysis
    steps = analysis.velocity_step(FAULT, 1e-6, 1e-5, [0.0, 1.0])
    assert steps == pytest.approx([0.6 + 0.01 * math.log(10), FAULT.steady(1e-5)])
    assert analysis.healing(FAULT, [0.0, 8e3]) == pytest.approx([0.0, 0.015 * math.log(2)])
    drop = analysis.stress_drop(FAULT, 5e7, 1e-9, 1.0)
    assert drop == pytest.approx(5e7 * 0.005 * math.log(1e9))
    time = analysis.time_to_instability(FAULT, load=1.0, stiffness=0.0, speed=1e-3)
    assert time == pytest.approx(0.01 / (0.015 / 8e-3 * 1e-3))
    steady = analysis.first_integral(FAULT, 1e-7, 1e-7, FAULT.memory_at(1e-7))
    assert steady == pytest.approx(1.5)
    two = ss.RateState(f0=0.6, a=0.01, b=(0.01, 0.005), d_c=(1e-3, 1e-2), v0=1e-6)
    assert analysis.healing(two, 1e9) > 0
    with pytest.raises(TypeError, match="one state variable"):
        analysis.first_integral(two, 1e-7, 1e-7, 0.0)


def test_a_creeping_contact_keeps_its_digits() -> None:
    start = ([1.9], [0.0], [6.9], {0: -1.5e-12})
    motion = fault().simulate(start, 1e-5)
    assert motion.sliding_velocity(0.0) == -1.5e-12
    state = motion.state_at(0.0)
    assert state.sliding == {0: -1.5e-12} and state.velocities[0] == 1e-9 - 1.5e-12
    rates = motion.sliding_velocity([0.0, 5e-6, 1e-5, 2e-5])
    assert (rates[:3] < 0).all() and np.isnan(rates[3])
    # A restart in between has the digits of a motion in one piece.
    rest = fault().simulate(motion.state_at(5e-6), 5e-6, start_time=5e-6)
    assert rest.sliding_velocity(1e-5) == pytest.approx(rates[2], rel=1e-13)
    with pytest.raises(IndexError, match="no contact 1"):
        motion.sliding_velocity(0.0, contact=1)
    # Without the dict the speed is the difference of velocities.
    rounded = fault().simulate(start[:2] + (start[2],), 0.0).sliding_velocity(0.0)
    assert rounded == -1e-9
    belt = ss.MassOnBelt(DRY, 0.2).simulate((0.0, 0.0), 1.0)
    with pytest.raises(TypeError, match="structure"):
        belt.sliding_velocity(0.5)


def test_a_motion_goes_on_from_any_of_its_states() -> None:
    contact = ss.Contact(0, ss.Coulomb(0.3, 0.3), 1.0, tangential_stiffness=2.0)
    lag = ss.FirstOrder(time_constant=0.3, velocities={0: 1.0}, forces={0: -0.2})
    joint = (
        ss.Structure([1.0])
        .with_ground_spring(0, 1.0)
        .with_force(0, ss.Drive.harmonic(0.5, 1.3))
        .with_contact(contact)
        .with_first_order(lag)
        .with_stop(ss.Stop.above(0, 0.4, stiffness=50.0, damping=0.5))
    )
    whole = joint.simulate(([0.0], [0.0]), 20.0)
    assert {"close", "open", "stick", "release"} <= set(whole.events["kind"])
    for time in (0.0, 7.0, *whole.events["time"][3:6], None):
        state = whole.state_at(time)
        assert isinstance(state, ss.State) and len(state.memory) == 2
        at = whole.end_time if time is None else time
        rest = joint.simulate(state, 20.0 - at, start_time=at)
        np.testing.assert_allclose(np.ravel(rest.last), np.ravel(whole.last), atol=1e-13)
    first = joint.simulate(([0.0], [0.0]), 7.0)
    q, v, memory, sliding = first.state_at()
    np.testing.assert_array_equal(memory, first.sample_memory([7.0])[0])
    assert sliding == {} and whole.state_at(21.0) is None
    belt = ss.MassOnBelt(DRY, 0.2).simulate((0.0, 0.0), 3.0)
    assert belt.state_at() == belt.last and belt.state_at(3.1) is None
    assert belt.state_at(1.0) == belt.sample(1.0)
    with pytest.raises(TypeError, match="fourth"):
        joint.simulate(([0.0], [0.0], [], 3.0), 1.0)  # type: ignore[arg-type]
    with pytest.raises(IndexError, match="counted from 0"):
        joint.simulate(([0.0], [0.0], [], {-1: 0.0}), 1.0)


def test_loads_of_any_shape() -> None:
    # A load that opens: N = 1 + q, of a mass that swings.
    law = ss.ForceLaw(lambda x, v: 1.0 * x)
    contact = ss.Contact(0, ss.Coulomb(0.1, 0.1), 1.0, load_laws=[(1, law)])
    assert contact.load_at(0.0, [0.0, -3.0]) == -2.0
    pair = (
        ss.Structure([1.0, 1.0])
        .with_ground_spring(0, 1.0)
        .with_ground_spring(1, 1.0)
        .with_contact(contact)
    )
    motion = pair.simulate(([1.0, 2.0], [0.0, 0.0]), 6.0)
    opened = motion.events[np.isin(motion.events["kind"], ["open", "close"])]
    # N = 1 + 2 cos t.
    assert opened["time"] == pytest.approx([2 * math.pi / 3, 4 * math.pi / 3], abs=1e-14)
    ring = ss.ForceLaw(lambda x, v: v**2 / 2)
    bead = ss.Contact(0, DRY, 0.0, load_laws=[(0, ring)])
    assert bead.load_at(0.0, 0.0) == 0.0 and bead.load_at(0.0, [0.0], [3.0]) == 4.5
    assert "load_laws=[({0: 1.0}, ForceLaw(" in repr(bead)
    with pytest.raises(ss.ParameterError, match="load law"):
        law_of_one = ss.Coulomb(0.3, 0.3)
        ss.Contact(0, law_of_one, 0.0, load_laws=[(0, ring)], tangential_stiffness=1.0)
    pole = ss.ForceLaw(lambda x, v: 1 / (x - 1.0))
    bad = ss.Contact(0, ss.Coulomb(0.1, 0.1), 5.0, load_laws=[(0, pole)])
    with pytest.raises(ss.StickSlipError) as caught:
        ss.Structure([1.0]).with_contact(bad).simulate(([0.0], [2.0]), 10.0)
    assert caught.value.time > 0 and len(caught.value.state.displacements) == 1


def test_stops() -> None:
    stiffness, zeta = 1e4, 0.3
    both: dict[str, float] = dict(stiffness=stiffness, damping=2 * zeta * math.sqrt(stiffness))
    rebounds = {False: -2 * zeta * math.acos(zeta), True: -math.pi * zeta}
    for adhesive, exponent in rebounds.items():
        stop = ss.Stop.above(0, 1.0, **both, adhesive=adhesive)
        motion = ss.Structure([1.0]).with_stop(stop).simulate(([0.0], [1.0]), 2.0)
        restitution = math.exp(exponent / math.sqrt(1 - zeta**2))
        assert motion.last[1][0] == pytest.approx(-restitution, rel=1e-13)
        budget = motion.energy_budget()
        assert budget.stop_loss == pytest.approx([0.5 * (1 - restitution**2)], rel=1e-12)
        assert list(motion.events["kind"]) == ["close", "open"]
        assert list(motion.events["stop"]) == [0, 0] and list(motion.events["contact"]) == [-1, -1]
    below = ss.Stop.below(0, -1.0, **both)
    assert repr(below) == "Stop({0: 1.0}, 1.0, stiffness=10000.0, damping=60.0)"
    assert repr(ss.Stop.between(0, 1, 0.1, stiffness=1.0, adhesive=True)) == (
        "Stop({0: -1.0, 1: 1.0}, 0.1, stiffness=1.0, damping=0.0, adhesive=True)"
    )
    # A mass thrown to and fro between two stops, beside friction.
    play = [
        ss.Stop.above(0, 0.5, stiffness=200.0, damping=4.0),
        ss.Stop.below(0, -0.5, stiffness=200.0, damping=4.0),
    ]
    thrown = (
        ss.Structure([1.0])
        .with_force(0, ss.Drive.sine(3.0, 2.0))
        .with_contact(ss.Contact(0, ss.Coulomb(0.1, 0.1), 1.0))
        .with_stops(play)
    )
    assert thrown.stops == 2
    assert repr(thrown) == "<Structure of 1 coordinate, 1 contact, 2 stops>"
    motion = thrown.simulate(([0.0], [0.0]), 20.0)
    assert set(motion.events["stop"]) == {-1, 0, 1} and set(motion.events["contact"]) == {-1, 0}
    samples = motion.samples(0.01)
    signs = np.array([1.0, -1.0])
    depth = signs * samples.displacements - 0.5
    forces = (200 * depth + 4 * signs * samples.velocities).clip(min=0)
    np.testing.assert_allclose(samples.stop_forces, np.where(depth > 0, forces, 0), atol=1e-12)
    orbit = ss.settle(thrown, ([0.0], [0.0]), 100.0, periods=1)
    assert orbit.is_stable and set(orbit.events["stop"]) == {-1, 0, 1}
    found = ss.sensitivities(
        lambda p: (
            ss.Structure([1.0]).with_stop(ss.Stop.above(0, p[0], stiffness=100.0)),
            ([0.0], [2.0]),
        ),
        [1.0],
        1.0,
    )
    [close, open_] = found.events
    assert (close.stop, close.contact, close.kind) == (0, None, "close")
    assert close.by_parameters == pytest.approx([0.5]) and open_.kind == "open"
    with pytest.raises(ss.ParameterError) as beyond:
        ss.Structure([1.0]).with_stop(ss.Stop.above(1, 1.0, stiffness=1.0))
    assert beyond.value.element == "stop 0" and beyond.value.coordinate == 1
    with pytest.raises(ss.ParameterError) as same:
        ss.Stop.between(1, 1, 0.1, stiffness=1.0)
    assert same.value.variant == "BadDirection"
    with pytest.raises(TypeError, match="stiffness"):
        ss.Stop.above(0, 1.0)  # type: ignore[call-arg]


def test_first_order_states() -> None:
    # Three poles by position control: (s + 1)(s + 2)(s + 3).
    integral = ss.FirstOrder(displacements=0, forces={0: -6.0})
    axis = (
        ss.Structure([1.0])
        .with_ground_spring(0, 11.0)
        .with_ground_damper(0, 6.0)
        .with_first_order(integral)
        .with_force(0, 9.0)
    )
    assert axis.first_orders == 1
    still = axis.steady_sliding()
    assert still.first_order == pytest.approx([1.5]) and abs(still.displacements[0]) < 1e-15
    np.testing.assert_allclose(still.eigenvalues, [-1, -2, -3], atol=1e-12)
    assert repr(axis) == "<Structure of 1 coordinate, 1 first-order state>"
    # A low-pass filter of T = 0.5 under sin 3t.
    drive = ss.Drive.sine(1.0, 3.0)
    low_pass = ss.FirstOrder(time_constant=0.5, drive=drive)
    assert low_pass.time_constant == 0.5 and integral.time_constant is None
    motion = ss.Structure([1.0]).with_first_order(low_pass).simulate(([0.0], [0.0]), 2.0)
    exact = (math.sin(6) - 1.5 * math.cos(6) + 1.5 * math.exp(-4)) / 3.25
    assert motion.state_at().memory == pytest.approx([exact], abs=1e-15)
    assert motion.samples(1.0).memory[-1] == pytest.approx([exact], abs=1e-15)
    # z' = z - z^3, and z' = tanh(v).
    growth = ss.FirstOrder(state_laws=[(0, ss.PolynomialSpring([1.0, 0.0, -1.0]))])
    grown = ss.Structure([1.0]).with_first_order(growth).simulate(([0.0], [0.0], [0.1]), 3.0)
    assert grown.state_at().memory[0] == pytest.approx((1 + 99 * math.exp(-6)) ** -0.5, abs=1e-15)
    limited = ss.FirstOrder(laws=[(0, ss.ForceLaw(lambda x, v: np.tanh(v)))])
    moved = ss.Structure([1.0]).with_first_order(limited).simulate(([0.0], [0.7]), 3.0)
    assert moved.state_at().memory[0] == pytest.approx(3 * math.tanh(0.7), abs=1e-14)
    twice = ss.FirstOrder(displacements=[(1, 1.0), (0, 1.0), (1, 2.0)], forces={0: 0.0})
    assert repr(twice) == "FirstOrder(displacements={0: 1.0, 1: 3.0})"
    assert repr(growth) == "FirstOrder(state_laws=[(0, PolynomialSpring([1.0, 0.0, -1.0]))])"
    assert repr(low_pass) == "FirstOrder(time_constant=0.5, drive=Drive.sine(1.0, 3.0))"
    with pytest.raises(ss.ParameterError) as caught:
        ss.Structure([1.0]).with_first_order(ss.FirstOrder(states={1: 1.0}))
    error = caught.value
    assert (error.variant, error.element, error.first_order, error.count) == (
        "NoSuchState",
        "first-order state 0",
        1,
        1,
    )
    pole = ss.FirstOrder(state_laws=[(0, ss.ForceLaw(lambda x, v: 1 / (1 - x) ** 2))])
    with pytest.raises(ss.StickSlipError) as ended:
        ss.Structure([1.0]).with_first_order(pole).simulate(([0.0], [0.0]), 10.0)
    # 1/3 is where (1 - z)^3 = 1 - 3t ends.
    assert ended.value.time == pytest.approx(1 / 3, abs=1e-3)


def test_forces_that_are_not_determined() -> None:
    brakes = [ss.Contact(0, ss.Coulomb(0.5, 0.4), load) for load in (4.0, 6.0)]
    disc = ss.Structure([1.0]).with_contacts(brakes).with_force(0, 4.0)
    first, second = disc.carried(0.0, ([0.0], [0.0]))
    assert (first.least, first.most) == (1.0, 2.0) and (second.least, second.most) == (2.0, 3.0)
    assert first.force + second.force == pytest.approx(4.0) and not first.is_determined


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
def test_numbers_that_are_none_are_refused(bad: float) -> None:
    calls: list[Callable[[], Any]] = [
        lambda: ss.Capstan(0.3, 0.2, bad),
        lambda: ss.RateState(f0=bad, a=0.1, b=0.2, d_c=0.1, v0=0.1),
        lambda: ss.RateState(f0=0.4, a=bad, b=0.2, d_c=0.1, v0=0.1),
        lambda: ss.RateState(f0=0.4, a=0.1, b=(0.2, bad), d_c=(0.1, 0.2), v0=0.1),
        lambda: ss.RateState(f0=0.4, a=0.1, b=0.2, d_c=0.1, v0=0.1, least_speed=bad),
        lambda: ss.Stop.above(0, bad, stiffness=1.0),
        lambda: ss.Stop.below(0, bad, stiffness=1.0),
        lambda: ss.Stop.between(0, 1, bad, stiffness=1.0),
        lambda: ss.Stop({0: bad}, 0.1, stiffness=1.0),
        lambda: ss.Stop(0, 0.1, stiffness=bad),
        lambda: ss.Stop(0, 0.1, stiffness=1.0, damping=bad),
        lambda: ss.FirstOrder(time_constant=bad),
        lambda: ss.FirstOrder(displacements={0: bad}),
        lambda: ss.FirstOrder(velocities={0: bad}),
        lambda: ss.FirstOrder(states={0: bad}),
        lambda: ss.FirstOrder(drive=bad),
        lambda: ss.FirstOrder(forces={0: bad}),
        lambda: ss.Contact(0, DRY, 1.0, load_laws=[({0: bad}, ss.Backlash(1.0, 0.1))]),
        lambda: ss.Contact.freewheel(0, 1, drag=DRY, load=bad),
        lambda: fault().simulate(([0.0], [0.0], [0.0], {0: bad}), 1.0),
        lambda: fault().simulate(([0.0], [0.0], [bad]), 1.0),
    ]
    for call in calls:
        with pytest.raises(ss.StickSlipError):
            call()


@pytest.mark.parametrize("bad", [0.0, -1.0])
def test_numbers_that_must_be_positive(bad: float) -> None:
    for call in (
        lambda: ss.Stop(0, 0.1, stiffness=bad),
        lambda: ss.FirstOrder(time_constant=bad),
        lambda: ss.RateState(f0=0.4, a=bad, b=0.2, d_c=0.1, v0=0.1),
        lambda: ss.RateState(f0=0.4, a=0.1, b=0.2, d_c=0.1, v0=0.1, least_speed=bad),
    ):
        with pytest.raises(ss.ParameterError) as caught:
            call()
        assert caught.value.value == bad


def test_fields_are_forces_of_several_directions() -> None:
    # Three oblique springs as a field, against three elements of one direction each.
    rows = [{0: 1.0, 1: 0.5}, {1: 1.0}, {0: -1.0, 1: 2.0}]
    cubic = ss.ForceLaw(lambda x, v: x**3 + 0.1 * v, potential=lambda x: x**4 / 4)
    apart = ss.Structure([1.0, 2.0], stiffness=np.eye(2))
    for row in rows:
        apart = apart.with_element(ss.ForceElement(row, cubic, factor=2.0))
    field = ss.ForceElement.field(
        rows,
        lambda x, v: [x[i] ** 3 + 0.1 * v[i] for i in range(3)],
        potential=lambda x: (x[0] ** 4 + x[1] ** 4 + x[2] ** 4) / 4,
        factor=2.0,
    )
    assert field.directions == rows and "ForceElement.field(" in repr(field)
    together = ss.Structure([1.0, 2.0], stiffness=np.eye(2)).with_element(field)
    start = ([1.0, -0.5], [0.3, 0.2])
    motions = [it.simulate(start, 20.0) for it in (apart, together)]
    np.testing.assert_allclose(motions[0].last, motions[1].last, atol=1e-13)
    assert abs(motions[1].energy_budget().defect) < 1e-13
    # A force that one coordinate feels and another one causes: v1' = q0, q0 = cos t.
    pull = ss.ForceElement.field([0, 1], lambda x, v: (0.0, -x[0]))
    pair = ss.Structure([1.0, 1.0]).with_ground_spring(0, 1.0).with_element(pull)
    q, v = pair.simulate(([1.0, 0.0], [0.0, 0.0]), 1.0).last
    assert v[1] == pytest.approx(math.sin(1.0), abs=1e-15)
    # Four directions, nested expressions of all of them.
    four = ss.ForceElement.field(
        [0, 1, 2, 3],
        lambda x, v: [
            ((x[0] + v[0]) * (x[1] - v[1])) / ((1 + x[2] ** 2) * (2 + x[3] ** 2)) * np.exp(-x[i])
            for i in range(4)
        ],
    )
    numbers = [0.1, 0.2, 0.3, 0.4], [1.0, 2.0, 3.0, 4.0]
    at = ss.Structure([1.0] * 4).with_element(four).acceleration(0.0, numbers)
    factor = (0.1 + 1.0) * (0.2 - 2.0) / ((1 + 0.3**2) * (2 + 0.4**2))
    assert at == pytest.approx([-factor * math.exp(-x) for x in numbers[0]], rel=1e-15)


def test_fields_refuse_what_cannot_be() -> None:
    for count in (0, 1, 5, 8, 100):
        with pytest.raises(ValueError, match="2, 3 or 4 directions"):
            ss.ForceElement.field(list(range(count)), lambda x, v: list(x))
    with pytest.raises(TypeError, match="one force for each of the 2 directions"):
        ss.ForceElement.field([0, 1], lambda x, v: x[0])
    with pytest.raises(TypeError, match="cannot be recorded"):
        ss.ForceElement.field([0, 1], lambda x, v: (max(x[0], x[1]), 0.0))
    with pytest.raises(ss.ParameterError) as caught:
        ss.ForceElement.field([0, 1], lambda x, v: (x[1], x[0]), potential=lambda x: x[0] ** 2)
    assert caught.value.variant == "InvalidParameter" and "potential" in str(caught.value)
    with pytest.raises(ss.ParameterError) as caught:
        ss.ForceLaw(lambda x, v: x, potential=lambda x: x**2)
    assert "potential" in str(caught.value)
    with pytest.raises(TypeError, match="a potential is a function of x"):
        ss.ForceElement.field([0, 1], lambda x, v: x, potential=3.0)  # type: ignore[arg-type]


def test_the_parts_of_elements_are_shown() -> None:
    stop = ss.Stop.below(1, -0.5, stiffness=10.0, damping=2.0, adhesive=True)
    assert (stop.direction, stop.gap, stop.stiffness, stop.damping) == ({1: 1.0}, 0.5, 10.0, 2.0)
    assert stop.is_adhesive
    axis = (
        ss.Structure([1.0])
        .with_ground_spring(0, 11.0)
        .with_first_order(ss.FirstOrder(displacements={0: 1.0}, forces={0: -6.0}))
    )
    budget = axis.simulate(([1.0], [0.0]), 3.0).energy_budget()
    assert budget.first_order_work.shape == (1,) and abs(budget.defect) < 1e-13
    assert budget.first_order_work[0] == pytest.approx(budget.stored, abs=1e-13)
