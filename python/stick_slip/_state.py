"""States of structures, as results."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt


class State(NamedTuple):
    """The state of a structure; a start of the same motion, to the bit.

    A start may be any such tuple of lists, arrays or numbers, also without the last entries.

    >>> from stick_slip import Structure
    >>> block = Structure([1.0]).with_ground_spring(0, 1.0)
    >>> state = block.simulate(([0.0], [0.5]), 1.0).state_at(0.0)
    >>> state
    State(displacements=array([0.]), velocities=array([0.5]), memory=array([], dtype=float64),
          sliding={})
    >>> q, v, *_ = state
    """

    displacements: npt.NDArray[np.float64]
    """The displacement of each coordinate."""

    velocities: npt.NDArray[np.float64]
    """The velocity of each coordinate."""

    memory: npt.NDArray[np.float64]
    """The memory variables of the contacts, in the order of the contacts (the force of an elastic
    contact is one), then the first-order states."""

    sliding: dict[int, float]
    """The relative velocity of each contact that creeps, with all its digits."""
