"""Pictures: what is drawn, into which axes."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import stick_slip as ss

matplotlib = pytest.importorskip("matplotlib")
matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

SYSTEM = ss.MassOnBelt(ss.Polynomial(0.4, 0.25, 0.5), 0.2, damping=0.05)


@pytest.fixture()
def ax() -> Any:
    figure, axes = plt.subplots()
    yield axes
    plt.close(figure)


def test_motions_are_drawn_with_stick_marked(ax: Any) -> None:
    motion = SYSTEM.simulate((0.0, 0.0), 20.0)
    assert motion.plot(ax) is ax
    line, stick = ax.lines
    times = line.get_xdata()
    np.testing.assert_array_equal(line.get_ydata(), motion.sample(times)[0])
    # Red where the contact sticks, and nowhere else.
    np.testing.assert_array_equal(~np.isnan(stick.get_ydata()), motion.modes(times) == 0)
    assert set(motion.events["time"]) <= set(times)
    motion.plot_phase(ax)
    np.testing.assert_array_equal(ax.lines[2].get_ydata(), motion.sample(times)[1])
    new = motion.plot(contact=None, points=10)
    assert new is not ax and len(new.lines) == 1
    plt.close(new.figure)
    blocks = ss.Structure([1.0, 1.0], stiffness=np.eye(2)).simulate(([1.0, 0.5], [0.0, 0.0]), 5.0)
    assert len(blocks.plot(contact=None, coordinates=[1]).lines) == 1
    plt.close("all")


def test_diagrams_are_drawn(ax: Any) -> None:
    bistable = ss.MassOnBelt(ss.Exponential(0.6, 0.3, 0.4), 1.0, damping=0.01)
    points = ss.diagram(bistable, [0.5, 1.0, 2.0])
    points.plot(ax)
    drawn = {line.get_label(): np.column_stack(line.get_data()) for line in ax.lines}
    stable = [[p.belt_velocity, c.amplitude] for p in points for c in p.cycles if c.is_stable]
    unstable = [[p.belt_velocity, c.amplitude] for p in points for c in p.cycles if not c.is_stable]
    np.testing.assert_array_equal(drawn["stable"], stable)
    np.testing.assert_array_equal(drawn["unstable"], unstable)
    points.plot(ax, measure="hertz")


def test_branches_are_drawn_with_their_stability(ax: Any) -> None:
    def duffing(omega: float) -> ss.Structure:
        spring = ss.ForceElement(0, ss.PolynomialSpring([0.0, 0.0, 0.5]))
        return (
            ss.Structure([1.0])
            .with_ground_spring(0, 1.0)
            .with_ground_damper(0, 0.1)
            .with_force(0, ss.Drive.harmonic(0.6, omega))
            .with_element(spring)
        )

    orbit = ss.settle(duffing(1.0), ([0.0], [0.0]), 200.0, periods=1)
    branch = ss.follow(duffing, 1.0, orbit, 0.8, 2.5)
    branch.plot(ax)
    solid, dashed, *folds = ax.lines
    np.testing.assert_array_equal(~np.isnan(solid.get_ydata()), branch.stable)
    assert np.isnan(dashed.get_ydata()).any() and dashed.get_linestyle() == "--"
    assert [line.get_xdata()[0] for line in folds] == [b.parameter for b in branch.bifurcations]
    branch.plot(ax, measure=lambda orbit: orbit.period, bifurcations=False)


