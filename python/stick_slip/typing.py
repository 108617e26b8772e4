"""Types of arguments and results, for annotations."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TypeAlias, Union

import numpy as np
import numpy.typing as npt

from stick_slip._stick_slip import MassOnBelt, PhysicalMassOnBelt, Structure

Array: TypeAlias = npt.NDArray[np.float64]
"""An array of numbers."""

ComplexArray: TypeAlias = npt.NDArray[np.complex128]
"""An array of complex numbers."""

DirectionLike: TypeAlias = Union[int, Mapping[int, float], Sequence[tuple[int, float]]]
"""A coordinate, {coordinate: coefficient}, or pairs of both."""

StateLike: TypeAlias = Union[
    tuple[npt.ArrayLike, npt.ArrayLike],
    tuple[npt.ArrayLike, npt.ArrayLike, npt.ArrayLike],
    tuple[npt.ArrayLike, npt.ArrayLike, npt.ArrayLike, Mapping[int, float]],
    Sequence[float],
    Array,
]
"""Displacements and velocities; memory variables, and relative velocities of contacts, where there
are any. A `State` is one."""

Belt: TypeAlias = Union[MassOnBelt, PhysicalMassOnBelt]
"""A mass on a belt in either system of units."""

System: TypeAlias = Union[Structure, MassOnBelt, PhysicalMassOnBelt]
"""Any system."""

__all__ = ["Array", "Belt", "ComplexArray", "DirectionLike", "StateLike", "System"]
