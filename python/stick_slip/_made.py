"""Objects by the calls that made them, and results, which cannot be made again: for `pickle`.

Systems and their parts are sent to other processes as calls. A result holds the whole motion, which
takes less time to compute again than to send.
"""

from __future__ import annotations

import copyreg
from collections.abc import Sequence
from operator import attrgetter
from typing import Any, NoReturn

import stick_slip
from stick_slip import _stick_slip


def made(
    function: str,
    arguments: tuple[Any, ...],
    keywords: dict[str, Any],
    then: Sequence[tuple[str, tuple[Any, ...]]],
) -> Any:
    """Calls a function of the package by its name, then methods of what it returns."""
    found = attrgetter(function)(stick_slip)(*arguments, **keywords)
    for name, further in then:
        found = getattr(found, name)(*further)
    return found


def refuse(result: Any) -> NoReturn:
    """Says what to send instead of a result."""
    kind = type(result)
    numbers = [name for name in vars(kind) if not name.startswith("_")][:3]
    raise TypeError(
        f"results and formulas are not pickled, such as this {kind.__name__}: return the "
        f"numbers and arrays that you need ({', '.join(numbers)}, ...) from the process, or send "
        "the system and compute the result where you need it"
    )


for _kind in [*vars(_stick_slip).values(), *vars(_stick_slip.analysis).values()]:
    if isinstance(_kind, type) and _kind.__reduce__ is object.__reduce__:
        copyreg.pickle(_kind, refuse)
