"""Records a function of one or two numbers that a user wrote in Python as a list of operations.

The function is called once, with a symbol in place of each number. Operators and numpy functions of
the symbol make an expression, a tree. The tree becomes a list of operations on one number under way
and a few slots, which the extension runs on power series as fast as it can.
"""

from __future__ import annotations

import math
import numbers
from collections.abc import Callable, Sequence
from typing import Any, NoReturn

import numpy as np

SLOTS = 4
"""Slots of the extension's machine for laws; the first ones hold the arguments."""

Operation = tuple[str, int, float]

FUNCTIONS = {
    "negative": "negate",
    "reciprocal": "recip",
    "square": "square",
    "exp": "exp",
    "log": "ln",
    "sqrt": "sqrt",
    "tanh": "tanh",
    "arctan": "atan",
    "sin": "sin",
    "cos": "cos",
    "absolute": "abs",
    "fabs": "abs",
}
BINARY = {
    "add": "__add__",
    "subtract": "__sub__",
    "multiply": "__mul__",
    "divide": "__truediv__",
    "true_divide": "__truediv__",
    "power": "__pow__",
    "float_power": "__pow__",
}

ADVICE = (
    "a law is recorded once, as one formula of its arguments: use + - * / ** and numpy's exp, log, "
    "sqrt, tanh, arctan, sin, cos, abs, square and reciprocal. Where different formulas meet, give "
    "a list of functions, one for each piece, and the breakpoints where they meet"
)


def refuse(what: str) -> NoReturn:
    raise TypeError(f"{what} cannot be recorded: {ADVICE}")


def number(value: object) -> float | None:
    """The value as a float if it is one real number."""
    if isinstance(value, (bool, np.bool_)):
        return None
    if isinstance(value, np.ndarray) and value.ndim == 0:
        value = value.item()
    return float(value) if isinstance(value, numbers.Real) else None


class Symbol:
    """A node of the expression."""

    __slots__ = ("name", "parts", "constant")
    # Symbols are compared with nothing, so they have no hash either.
    __hash__ = None  # type: ignore[assignment]

    def __init__(self, name: str, parts: tuple[Symbol, ...] = (), constant: float = 0.0) -> None:
        self.name = name
        self.parts = parts
        self.constant = constant

    def _with(self, other: object, binary: str, by_constant: str) -> Symbol:
        if isinstance(other, Symbol):
            return Symbol(binary, (self, other))
        value = number(other)
        if value is None:
            if isinstance(other, np.ndarray):
                refuse("an array as a coefficient")
            refuse(f"an operation with {other!r}")
        return Symbol(by_constant, (self,), value)

    def __add__(self, other: object) -> Symbol:
        return self._with(other, "add", "add_constant")

    __radd__ = __add__

    def __sub__(self, other: object) -> Symbol:
        return self._with(other, "subtract", "subtract_constant")

    def __rsub__(self, other: object) -> Symbol:
        return (-self) + other

    def __mul__(self, other: object) -> Symbol:
        return self._with(other, "multiply", "multiply_constant")

    __rmul__ = __mul__

    def __truediv__(self, other: object) -> Symbol:
        return self._with(other, "divide", "divide_constant")

    def __rtruediv__(self, other: object) -> Symbol:
        return Symbol("recip", (self,)) * other

    def __pow__(self, other: object) -> Symbol:
        value = number(other)
        if value is None:
            refuse("a power with an exponent that varies")
        if value == 2.0:
            return Symbol("square", (self,))
        if value == 1.0:
            return self
        if value == 0.5:
            return Symbol("sqrt", (self,))
        if value.is_integer() and abs(value) < 2**31:
            return Symbol("powi", (self,), value)
        return Symbol("powf", (self,), value)

    def __rpow__(self, other: object) -> Symbol:
        value = number(other)
        if value is None or not value > 0.0:
            refuse("a power of a base that is not a number > 0")
        return Symbol("exp", (self * math.log(value),))

    def __neg__(self) -> Symbol:
        return Symbol("negate", (self,))

    def __pos__(self) -> Symbol:
        return self

    def __abs__(self) -> Symbol:
        return Symbol("abs", (self,))

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **options: Any) -> Any:
        name = ufunc.__name__
        if method != "__call__" or options:
            refuse(f"numpy.{name} with options")
        if name == "positive":
            return inputs[0]
        if name in FUNCTIONS:
            return Symbol(FUNCTIONS[name], (inputs[0],))
        if name in BINARY:
            left, right = inputs
            if isinstance(left, Symbol):
                return getattr(left, BINARY[name])(right)
            return getattr(right, BINARY[name].replace("__", "__r", 1))(left)
        refuse(f"numpy.{name}")

    def __array_function__(self, function: Any, *_: Any) -> NoReturn:
        refuse(f"numpy.{function.__name__}")

    def __array__(self, *_: Any, **__: Any) -> NoReturn:
        refuse("a conversion to an array")

    def __bool__(self) -> NoReturn:
        refuse("a branch (if, and, or, max, min)")

    def _compare(self, _: object) -> NoReturn:
        refuse("a comparison")

    __lt__ = __le__ = __gt__ = __ge__ = _compare
    __eq__ = __ne__ = _compare

    def _convert(self, *_: Any) -> NoReturn:
        refuse("a conversion to a number (math.exp and the like; numpy has the same functions)")

    __float__ = __int__ = __index__ = __complex__ = __round__ = _convert
    __floor__ = __ceil__ = __trunc__ = _convert

    def _part(self, *_: Any) -> NoReturn:
        refuse("an index or a loop")

    __getitem__ = __iter__ = __len__ = __contains__ = _part

    def _whole(self, *_: Any) -> NoReturn:
        refuse("a remainder or a quotient without remainder")

    __floordiv__ = __rfloordiv__ = __mod__ = __rmod__ = __divmod__ = __rdivmod__ = _whole

    def __repr__(self) -> str:
        return text(self, "abc")


SIGNS = {"add": "+", "subtract": "-", "multiply": "*", "divide": "/"}


def text(node: Symbol, names: Sequence[str]) -> str:
    """The expression as one would write it."""
    name = node.name
    if name == "argument":
        return names[int(node.constant)]
    if name == "constant":
        return repr(node.constant)
    parts = [text(part, names) for part in node.parts]
    if name in SIGNS:
        return f"({parts[0]} {SIGNS[name]} {parts[1]})"
    if name.endswith("_constant"):
        return f"({parts[0]} {SIGNS[name.removesuffix('_constant')]} {node.constant!r})"
    if name in ("powi", "powf"):
        return f"{parts[0]}**{node.constant!r}"
    if name == "negate":
        return f"(-{parts[0]})"
    return f"{name}({parts[0]})"


def depth(node: Symbol) -> int:
    """The number of slots that the node needs beside that of the argument."""
    if len(node.parts) < 2:
        return depth(node.parts[0]) if node.parts else 0
    left, right = node.parts
    if left.name == "argument" or right.name == "argument":
        return max(depth(left), depth(right))
    first, second = depth(left), depth(right)
    return max(first, second) if first != second else first + 1


# What an operation is called if its operands come in the other order.
REVERSED = {
    "add": "add",
    "subtract": "subtract_from",
    "multiply": "multiply_onto",
    "divide": "divide_into",
}


def emit(node: Symbol, slot: int, slots: int, operations: list[Operation]) -> None:
    """Appends the operations that leave the node's value as the number under way.

    Slots from `slot` on are free; there are `slots`.
    """
    if node.name == "argument":
        operations.append(("load", int(node.constant), 0.0))
    elif node.name == "constant":
        operations.append(("constant", 0, node.constant))
    elif len(node.parts) == 1:
        emit(node.parts[0], slot, slots, operations)
        operations.append((node.name, 0, node.constant))
    else:
        left, right = node.parts
        if right.name == "argument":
            emit(left, slot, slots, operations)
            operations.append((node.name, int(right.constant), 0.0))
        elif left.name == "argument":
            emit(right, slot, slots, operations)
            operations.append((REVERSED[node.name], int(left.constant), 0.0))
        else:
            if slot == slots:
                refuse("an expression nested so deeply")
            # The deeper side first: it needs the slots that are still free.
            left_first = depth(left) >= depth(right)
            first, second = (left, right) if left_first else (right, left)
            emit(first, slot, slots, operations)
            operations.append(("store", slot, 0.0))
            emit(second, slot + 1, slots, operations)
            name = REVERSED[node.name] if left_first else node.name
            operations.append((name, slot, 0.0))


class Formula:
    """A recorded function. It stands for the function where an object is made again."""

    __slots__ = ("operations", "text")

    def __init__(self, operations: list[Operation], text: str) -> None:
        self.operations = operations
        self.text = text

    def __repr__(self) -> str:
        return self.text

    def __reduce__(self) -> tuple[type[Formula], tuple[list[Operation], str]]:
        return Formula, (self.operations, self.text)


def formula(result: object, names: Sequence[str], slots: int) -> Formula:
    """The formula of what a function of arguments with these names returned."""
    if not isinstance(result, Symbol):
        value = number(result)
        if value is None:
            raise TypeError(f"a law must return a number, not {result!r}")
        result = Symbol("constant", (), value)
    operations: list[Operation] = []
    try:
        emit(result, len(names), slots, operations)
        return Formula(operations, text(result, names))
    except RecursionError:
        refuse("an expression nested so deeply")


def symbols(names: Sequence[str]) -> tuple[Symbol, ...]:
    """A symbol for each argument."""
    return tuple(Symbol("argument", (), float(i)) for i in range(len(names)))


def trace(function: Any, names: Sequence[str]) -> Formula:
    """The formula of a function of arguments with these names."""
    if isinstance(function, Formula):
        return function
    if not callable(function):
        raise TypeError(f"a law is a function of {', '.join(names)}, not {function!r}")
    return formula(function(*symbols(names)), names, SLOTS)


def trace_pieces(
    functions: Any, count: int, names: Sequence[str] = ("s",)
) -> tuple[list[list[Operation]], Formula | list[Formula]]:
    """The operations of each piece of a law with `count` pieces; its formulas, as it was given."""
    if callable(functions) or isinstance(functions, Formula):
        pieces: list[Any] = [functions]
    elif isinstance(functions, (list, tuple)):
        pieces = list(functions)
    else:
        raise TypeError(f"a law is a function or a list of functions, not {functions!r}")
    if len(pieces) != count:
        raise ValueError(
            f"{len(pieces)} functions and {count - 1} breakpoints do not fit: give one function "
            "for each piece, one more than there are breakpoints"
        )
    formulas = [trace(piece, names) for piece in pieces]
    return [it.operations for it in formulas], formulas if count > 1 else formulas[0]


def trace_field(
    forces: Any, count: int, slots: int
) -> tuple[list[list[Operation]], list[Formula]]:
    """The operations and formulas of the forces along `count` directions."""
    names = [f"{letter}[{i}]" for letter in "xv" for i in range(count)]
    if callable(forces):
        arguments = symbols(names)
        forces = forces(arguments[:count], arguments[count:])
    if not isinstance(forces, (list, tuple, np.ndarray)) or len(forces) != count:
        raise TypeError(
            "the forces of a field are a function of (x, v) that returns one force for each of "
            f"the {count} directions, not {forces!r}"
        )
    formulas = [it if isinstance(it, Formula) else formula(it, names, slots) for it in forces]
    return [it.operations for it in formulas], formulas


def trace_potential(
    potential: Any, count: int, slots: int
) -> tuple[list[list[Operation]], Formula]:
    """The operations and the formula of the potential of a field."""
    if not isinstance(potential, Formula):
        if not callable(potential):
            raise TypeError(f"a potential is a function of x, not {potential!r}")
        names = [f"x[{i}]" for i in range(count)]
        potential = formula(potential(symbols(names)), names, slots)
    return [potential.operations], potential
