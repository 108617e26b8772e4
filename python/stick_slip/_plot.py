"""Pictures of motions, diagrams and branches, drawn into axes of matplotlib."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from stick_slip import Branch, Diagram, Locus, Motion, Orbit

STICK = "tab:red"
"""The colour of stick."""

MARKERS = {
    "fold": "o",
    "flip": "s",
    "pitchfork": "D",
    "Neimark-Sacker": "^",
    "grazing": "v",
    "change of events": "x",
    "Hopf": "*",
}


def axes(ax: Axes | None) -> Axes:
    """The given axes, or new ones."""
    if ax is not None:
        return ax
    try:
        import matplotlib.pyplot as plt
    except ImportError as error:
        raise ImportError(
            "pictures need matplotlib: pip install matplotlib, or stick-slip[plot]"
        ) from error
    return plt.figure().add_subplot()


def times_of(motion: Motion, points: int) -> Any:
    """Equidistant times with those of the events, so that corners are sharp."""
    times = np.linspace(motion.start_time, motion.end_time, points)
    return np.union1d(times, motion.events["time"])


def stuck(motion: Motion, times: Any, contact: int | None) -> Any:
    """True where the contact sticks; nowhere without a contact."""
    if contact is None or motion.contacts == 0:
        return np.zeros(times.shape, dtype=bool)
    return motion.modes(times, contact) == 0


def columns(array: Any) -> Any:
    """One column for each coordinate; a mass on a belt has one."""
    return array if array.ndim == 2 else array[:, np.newaxis]


def motion(
    motion: Motion, ax: Axes | None, coordinates: list[int] | None, contact: int | None, points: int
) -> Axes:
    ax = axes(ax)
    times = times_of(motion, points)
    displacements = columns(motion.sample(times)[0])
    sticks = stuck(motion, times, contact)
    chosen = range(displacements.shape[1]) if coordinates is None else coordinates
    for i in chosen:
        q = displacements[:, i]
        label = "displacement" if displacements.shape[1] == 1 else f"coordinate {i}"
        (line,) = ax.plot(times, q, label=label)
        if contact is not None and sticks.any():
            ax.plot(times, np.where(sticks, q, np.nan), color=STICK, linewidth=2.5)
    ax.set_xlabel("time")
    ax.set_ylabel("displacement")
    if displacements.shape[1] > 1:
        ax.legend()
    return ax


def phase(
    motion: Motion, ax: Axes | None, coordinate: int, contact: int | None, points: int
) -> Axes:
    ax = axes(ax)
    times = times_of(motion, points)
    q, v = (columns(array)[:, coordinate] for array in motion.sample(times))
    sticks = stuck(motion, times, contact)
    ax.plot(q, v)
    if sticks.any():
        ax.plot(
            np.where(sticks, q, np.nan),
            np.where(sticks, v, np.nan),
            color=STICK,
            linewidth=2.5,
            label="stick",
        )
        ax.legend()
    ax.set_xlabel("displacement")
    ax.set_ylabel("velocity")
    return ax


def diagram(diagram: Diagram, ax: Axes | None, measure: str) -> Axes:
    ax = axes(ax)
    for stable, style in ((True, "o"), (False, "x")):
        found = [
            (point.belt_velocity, getattr(cycle, measure))
            for point in diagram
            for cycle in point.cycles
            if cycle.is_stable == stable
        ]
        if found:
            label = "stable" if stable else "unstable"
            ax.plot(*zip(*found), style, markersize=3, label=label)
    sliding = [(p.belt_velocity, p.equilibrium) for p in diagram if p.equilibrium is not None]
    if measure == "amplitude" and sliding:
        velocities = np.array([velocity for velocity, _ in sliding])
        for stable, style in ((True, "-"), (False, ":")):
            is_so = np.array([equilibrium.is_stable == stable for _, equilibrium in sliding])
            ax.plot(velocities, np.where(is_so, 0.0, np.nan), style, color="black")
    ax.set_xlabel("belt velocity")
    ax.set_ylabel(measure.replace("_", " "))
    if ax.get_legend_handles_labels()[0]:
        ax.legend()
    return ax


def branch(
    branch: Branch,
    ax: Axes | None,
    coordinate: int,
    measure: Callable[[Orbit], float] | None,
    bifurcations: bool,
) -> Axes:
    ax = axes(ax)

    def value(orbit: Orbit) -> float:
        return orbit.amplitude(coordinate) if measure is None else measure(orbit)

    parameters = branch.parameters
    values = np.array([value(point.orbit) for point in branch.points])
    stable = branch.stable
    # A line between two points is stable if both are, so the two kinds of line meet.
    neighbour = np.zeros(stable.shape, dtype=bool)
    neighbour[1:] |= ~stable[:-1]
    neighbour[:-1] |= ~stable[1:]
    (line,) = ax.plot(parameters, np.where(stable, values, np.nan), "-")
    unstable = np.where(~stable | neighbour, values, np.nan)
    ax.plot(parameters, unstable, "--", color=line.get_color())
    if bifurcations:
        marked: set[str] = set()
        for found in branch.bifurcations:
            label = None if found.kind in marked else found.kind
            marked.add(found.kind)
            ax.plot(
                found.parameter,
                value(found.orbit),
                MARKERS.get(found.kind, "P"),
                color="black",
                fillstyle="none",
                label=label,
            )
        if marked:
            ax.legend()
    ax.set_xlabel("parameter")
    ax.set_ylabel("amplitude" if measure is None else "measure")
    return ax


def locus(locus: Locus, ax: Axes | None) -> Axes:
    ax = axes(ax)
    parameters = locus.parameters
    ax.plot(parameters[:, 0], parameters[:, 1], label=locus.kind)
    for point in locus.special:
        ax.plot(*point.parameters, "o", color="black", fillstyle="none")
        ax.annotate(point.kind, point.parameters)
    ax.set_xlabel("first parameter")
    ax.set_ylabel("second parameter")
    ax.legend()
    return ax
