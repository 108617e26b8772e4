"""Laws: those of the crate, those with memory, and functions of one's own."""

from __future__ import annotations

import math
import pickle
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import stick_slip as ss

SPEEDS = np.linspace(0.0, 3.0, 31)


@pytest.mark.parametrize(
    ("law", "formula"),
    [
        (ss.Coulomb(0.4, 0.25), lambda s: 0.25 + 0 * s),
        (ss.Exponential(0.4, 0.25, 0.5), lambda s: 0.25 + 0.15 * np.exp(-((s / 0.5) ** 2))),
        (ss.Polynomial(0.4, 0.25, 0.5), lambda s: 0.4 - 0.45 * s + 0.6 * s**3),
        (ss.Rational(1.0, 3.0), lambda s: 1.0 / (1.0 + 3.0 * s)),
        (
            ss.Rational(0.4, 3.0, offset=0.2, quadratic=0.01),
            lambda s: 0.2 / (1 + 3 * s) + 0.2 + 0.01 * s**2,
        ),
        (
            ss.Stribeck(0.4, 0.25, 0.5, 1, viscous_coefficient=0.02),
            lambda s: 0.25 + 0.15 * np.exp(-s / 0.5) + 0.02 * s,
        ),
    ],
)
def test_laws_have_their_formulas(law: ss.Law, formula: Callable[[Any], Any]) -> None:
    np.testing.assert_allclose(law.kinetic(SPEEDS), formula(SPEEDS), rtol=0, atol=1e-15 * 20)
    assert law.kinetic(0.5) == law.kinetic([0.5])[0]
    # The exact derivative against a central difference of second order.
    h = 1e-5
    difference = (formula(SPEEDS + 1 + h) - formula(SPEEDS + 1 - h)) / (2 * h)
    np.testing.assert_allclose(law.slope(SPEEDS + 1), difference, rtol=1e-8, atol=1e-8)
    assert law.coefficient(-1.0) == -law.kinetic(1.0)
    again = pickle.loads(pickle.dumps(law))
    assert repr(again) == repr(law)
    assert np.array_equal(again.kinetic(SPEEDS), law.kinetic(SPEEDS))


def test_a_table_goes_through_its_points() -> None:
    points = [(0.0, 0.4), (0.5, 0.3), (1.0, 0.25)]
    for law in (ss.Tabulated(points), ss.Tabulated(np.array(points), piecewise_linear=True)):
        np.testing.assert_array_equal(law.kinetic([p[0] for p in points]), [0.4, 0.3, 0.25])
        assert law.static_coefficient == 0.4
        assert pickle.loads(pickle.dumps(law)).kinetic(0.7) == law.kinetic(0.7)
    assert ss.Tabulated(points, piecewise_linear=True).kinetic(0.25) == pytest.approx(0.35)
    with pytest.raises(ss.ParameterError) as caught:
        ss.Tabulated([(0.0, 0.4), (0.0, 0.3)])
    assert caught.value.variant == "BadPoint" and caught.value.index == 1


TRACED: list[tuple[Callable[[Any], Any], Callable[[float], float]]] = [
    (lambda s: 0.3 + 0.2 * np.exp(-s / 0.1), lambda s: 0.3 + 0.2 * math.exp(-s / 0.1)),
    (lambda s: 0.2 / (1 + 5 * s), lambda s: 0.2 / (1 + 5 * s)),
    (lambda s: 0.4 - 0.1 * np.tanh(3 * s), lambda s: 0.4 - 0.1 * math.tanh(3 * s)),
    (lambda s: 0.4 - np.arctan(s) / 10, lambda s: 0.4 - math.atan(s) / 10),
    (lambda s: 0.3 + np.cos(s) * np.sin(s) / 9, lambda s: 0.3 + math.cos(s) * math.sin(s) / 9),
    (lambda s: 0.2 + 2.0**-s, lambda s: 0.2 + 2.0**-s),
    (lambda s: 0.1 + np.sqrt(1 + s) / 5, lambda s: 0.1 + math.sqrt(1 + s) / 5),
    (lambda s: 0.1 + (1 + s) ** 0.3, lambda s: 0.1 + (1 + s) ** 0.3),
    (lambda s: 0.1 + (1 + s) ** -3, lambda s: 0.1 + (1 + s) ** -3),
    (lambda s: np.float64(0.5) + np.square(s) - s * s, lambda s: 0.5),
    (
        lambda s: (s + 1) * (s + 2) / ((s + 3) * (s + 4)),
        lambda s: (s + 1) * (s + 2) / ((s + 3) * (s + 4)),
    ),
    (lambda s: 0.3 + np.log(1 + s) / (1 + s**2), lambda s: 0.3 + math.log(1 + s) / (1 + s**2)),
    (lambda s: np.reciprocal(2 + s) + abs(s) + +s - -s, lambda s: 1 / (2 + s) + 3 * s),
    (lambda s: 0.25, lambda s: 0.25),
    (lambda s: 1 - (1 - s / (2 + s)) / 3, lambda s: 1 - (1 - s / (2 + s)) / 3),
    (
        lambda s: ((s + 1) / (s + 2) - 3 / (s + 4)) / ((s + 5) / (s + 6) + s / (s + 8)) + 1,
        lambda s: ((s + 1) / (s + 2) - 3 / (s + 4)) / ((s + 5) / (s + 6) + s / (s + 8)) + 1,
    ),
]


@pytest.mark.parametrize(("traced", "formula"), TRACED)
def test_a_function_is_recorded(
    traced: Callable[[Any], Any], formula: Callable[[float], float]
) -> None:
    law = ss.Law(traced, static=9.0)
    found = law.kinetic(SPEEDS)
    expected = np.array([formula(s) for s in SPEEDS])
    np.testing.assert_allclose(found, expected, rtol=1e-14, atol=0)
    h = 1e-5
    difference = [(formula(s + 1 + h) - formula(s + 1 - h)) / (2 * h) for s in SPEEDS]
    np.testing.assert_allclose(law.slope(SPEEDS + 1), difference, rtol=1e-7, atol=1e-8)


@pytest.mark.parametrize(
    "function",
    [
        lambda s: 0.3 if s > 1 else 0.2,
        lambda s: 0.3 if s else 0.2,
        lambda s: 0.3 if s == 1 else 0.2,
        lambda s: max(s, 0.1),
        lambda s: min(0.1, s),
        lambda s: math.exp(-s),
        lambda s: float(s),
        lambda s: int(s),
        lambda s: round(s),
        lambda s: math.floor(s),
        lambda s: np.maximum(s, 0.1),
        lambda s: np.where(s > 1, 0.2, 0.3),
        lambda s: np.clip(s, 0, 1),
        lambda s: np.interp(s, [0, 1], [0, 1]),
        lambda s: np.piecewise(s, [s > 1], [0.2, 0.3]),
        lambda s: np.sign(s),
        lambda s: np.heaviside(s, 1),
        lambda s: np.add(s, 1, out=np.zeros(1)),
        lambda s: np.add.reduce([s, s]),
        lambda s: s**s,
        lambda s: (-2) ** s,
        lambda s: True * s,
        lambda s: s * np.array([1.0, 2.0]),
        lambda s: np.array([1.0, 2.0]) * s,
        lambda s: s[0],
        lambda s: sum(s),
        lambda s: len(s),
        lambda s: s // 2,
        lambda s: s % 2,
        lambda s: divmod(s, 2),
        lambda s: s * "2",
        lambda s: s * 1j,
        lambda s: np.sum([s, s]) and s,
        lambda s: np.asarray(s, dtype=float),
        lambda s: None,
        lambda s: "0.3",
        lambda s: [s],
        7,
        None,
        [7],
    ],
)
def test_what_cannot_be_recorded_is_refused(function: Any) -> None:
    with pytest.raises(TypeError, match="record|law|return|arg"):
        ss.Law(function, static=0.5)


def test_a_refusal_names_the_remedy() -> None:
    with pytest.raises(TypeError, match="one for each piece, and the breakpoints"):
        ss.Law(lambda s: 0.3 if s > 1 else 0.2, static=0.5)
    with pytest.raises(TypeError, match="nested so deeply"):
        # Two deep sides at each of many levels.
        def deep(s: Any, n: int) -> Any:
            return s + 1 if n == 0 else deep(s, n - 1) / deep(s + n, n - 1)

        ss.Law(lambda s: deep(s, 5), static=0.5)


def test_pieces_meet_at_breakpoints() -> None:
    law = ss.Law(
        [lambda s: 0.4 - 0.1 * s, lambda s: 0.3 + 0 * s, lambda s: 0.3 + 0.1 * (s - 2)],
        static=0.4,
        breakpoints=[1.0, 2.0],
    )
    np.testing.assert_allclose(law.kinetic([0.5, 1.0, 1.5, 3.0]), [0.35, 0.3, 0.3, 0.4])
    assert law.slope(1.0) == 0.0 and law.slope(2.0) == 0.1
    assert law.breakpoints == [1.0, 2.0]
    # The same law as a table of straight lines: the same motion.
    table = ss.Tabulated([(0, 0.4), (1, 0.3), (2, 0.3), (9, 1.0)], piecewise_linear=True)
    motions = [
        ss.MassOnBelt(each, 0.4, damping=0.01, load=3.0).simulate((0.0, 0.0), 60.0)
        for each in (law, table)
    ]
    assert np.array_equal(motions[0].events["kind"], motions[1].events["kind"])
    np.testing.assert_allclose(motions[0].events["time"], motions[1].events["time"], atol=1e-12)
    with pytest.raises(ValueError, match="2 functions and 2 breakpoints"):
        ss.Law([lambda s: s, lambda s: s], static=1.0, breakpoints=[1.0, 2.0])
    with pytest.raises(ss.ParameterError) as caught:
        ss.Law([lambda s: 0.1, lambda s: 0.1], static=1.0, breakpoints=[-1.0])
    assert caught.value.variant == "BadBreakpoints"


def test_a_recorded_law_moves_like_the_named_one() -> None:
    named = ss.Stribeck(0.5, 0.3, 0.1, 1)
    own = ss.Law(lambda s: 0.3 + 0.2 * np.exp(-s / 0.1), static=0.5)
    for build in (
        lambda law: ss.MassOnBelt(law, 0.2, damping=0.05),
        lambda law: ss.PhysicalMassOnBelt(
            law, mass=2.0, stiffness=800.0, normal_force=20.0, belt_velocity=0.03
        ),
    ):
        one, other = (build(law).simulate((0.0, 0.0), 20.0) for law in (named, own))
        assert len(one.events) > 3
        np.testing.assert_allclose(one.events["time"], other.events["time"], rtol=1e-12)
    cycles = [ss.limit_cycles(ss.MassOnBelt(law, 0.2, damping=0.05)) for law in (named, own)]
    assert cycles[0][0].period == pytest.approx(cycles[1][0].period, rel=1e-13)


def test_own_laws_may_be_long_but_not_deep() -> None:
    def chain(s: Any, n: int) -> Any:
        for _ in range(n):
            s = s * 0.5 + 0.1
        return s

    assert ss.Law(lambda s: chain(s, 100), static=0.3).kinetic(1.0) == chain(1.0, 100)
    with pytest.raises(TypeError, match="nested so deeply"):
        ss.Law(lambda s: chain(s, 5000), static=0.3)


def test_own_laws_are_checked() -> None:
    with pytest.raises(ss.ParameterError) as caught:
        ss.Law(lambda s: 0.6 - s, static=0.5)
    assert caught.value.variant == "StaticBelowKinetic"
    assert caught.value.kinetic_coefficient == 0.6
    with pytest.raises(ss.StickSlipError):
        law = ss.Law(lambda s: 0.3 + np.sqrt(s), static=0.5)
        ss.MassOnBelt(law, 0.2).simulate((0.0, 0.0), 10.0)
    for static in (math.nan, math.inf, -1.0):
        with pytest.raises(ss.ParameterError):
            ss.Law(lambda s: 0.0 * s - 2.0, static=static)
    assert ss.Law(lambda s: 0.3 + 0.1 * np.abs(s - 1), static=0.5).check(0.0, 3.0)


def test_laws_with_memory() -> None:
    law = ss.Dwell(ss.Coulomb(0.3, 0.2), limit=0.5, time=2.0)
    assert law.static_coefficient(2.0) == pytest.approx(0.5 - 0.2 * math.exp(-1))
    assert ss.Dwell(ss.Coulomb(0.3, 0.2), limit=0.5, time=2.0, hyperbolic=True).static_coefficient(
        2.0
    ) == pytest.approx(0.4)
    assert ss.Dwell(ss.Coulomb(0.3, 0.2), rate=0.1, time=2.0).static_coefficient(
        2.0
    ) == pytest.approx(0.3 + 0.1 * math.log(2))
    for bad in ({"time": 1.0}, {"time": 1.0, "limit": 0.5, "rate": 0.1}):
        with pytest.raises(ValueError, match="give limit"):
            ss.Dwell(ss.Coulomb(0.3, 0.2), **bad)
    own = ss.Law(lambda s: 0.25 + 0.15 * np.exp(-((s / 0.5) ** 2)), static=0.4)
    for named, traced in (
        (ss.LuGre(ss.Exponential(0.4, 0.25, 0.5), 100.0, 0.5), ss.LuGre(own, 100.0, 0.5)),
        (
            ss.Dwell(ss.Exponential(0.4, 0.25, 0.5), limit=0.5, time=1.0),
            ss.Dwell(own, limit=0.5, time=1.0),
        ),
    ):
        motions = [
            ss.Structure([1.0])
            .with_ground_spring(0, 1.0)
            .with_ground_damper(0, 0.1)
            .with_contact(ss.Contact(0, law, 1.0, belt_velocity=0.2))
            .simulate(([0.0], [0.0]), 30.0)
            for law in (named, traced)
        ]
        np.testing.assert_allclose(motions[0].last, motions[1].last, atol=1e-11)
