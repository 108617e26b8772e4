"""The exceptions of the package."""

from __future__ import annotations

from typing import Any


class StickSlipError(RuntimeError):
    """An error of the package: a motion or a search that could not continue.

    The message names the remedy. The numbers of the error are attributes, and entries of `fields`:
    a motion that fails has `time` and `state`, where it had got to.

    >>> from stick_slip import MassOnBelt, Polynomial, StickSlipError
    >>> system = MassOnBelt(Polynomial(0.4, 0.25, 0.5), 0.2)
    >>> try:
    ...     system.simulate((0.0, 0.0), 100.0, max_steps=5)
    ... except StickSlipError as error:
    ...     print(error.variant, error.limit, error.found)
    TooManySteps 5 <Motion from 0.0 to 4.269046: 2 events, ended by error>
    """

    variant: str
    """The name of the error in the Rust crate, for example "TooManySteps"."""

    fields: dict[str, Any]
    """The numbers of the error by name."""

    found: Any
    """What had been found before the error; None if nothing."""

    def __init__(
        self,
        message: str,
        variant: str = "",
        fields: dict[str, Any] | None = None,
        cause: object = None,
    ) -> None:
        super().__init__(message)
        self.variant = variant
        self.fields = dict(fields or {})
        self.found = self.fields.get("found")
        self._cause = cause

    def __getattr__(self, name: str) -> Any:
        try:
            return self.__dict__["fields"][name]
        except KeyError:
            raise AttributeError(f"{type(self).__name__} has no attribute {name!r}") from None

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (str(self), self.variant, self.fields)


class ParameterError(StickSlipError, ValueError):
    """An argument that is not allowed.

    >>> from stick_slip import ParameterError, Polynomial
    >>> try:
    ...     Polynomial(0.4, 0.5, 0.5)
    ... except ParameterError as error:
    ...     print(error)
    ...     print(error.name, error.value, error.allowed)
    Polynomial: minimum_coefficient = 0.5 is not allowed: 0 ≤ minimum_coefficient ≤ static_coefficient
    minimum_coefficient 0.5 0 ≤ minimum_coefficient ≤ static_coefficient
    """
