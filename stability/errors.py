"""What can go wrong, by name. Messages say what was asked, what was found and what to try."""

from typing import Any


class StabilityError(Exception):
    """Base of all errors of this package.

    No other one is raised for input that cannot be computed; numbers in messages are in the scales of the flow.

    >>> from stability import StabilityError, flows, k_max
    >>> try:
    ...     k_max(flows.Vortex())
    ... except StabilityError as reason:
    ...     print(type(reason).__name__)
    NotResolved
    """


class ParameterError(StabilityError, ValueError):
    """A parameter lies outside its range.

    Raised before anything is computed; the message has name, value, range and units or remedy. A ValueError as well.

    >>> from stability import flows
    >>> flows.Film(slope_deg=200.0)
    Traceback (most recent call last):
        ...
    stability.errors.ParameterError: film: slope_deg must lie in (0, 180) (got 200)
    """


class NotSmooth(ParameterError):
    """A base flow has a kink, a step or noise, or a value that is not a finite real number.

    `where` names flow and layer, `complaint` the coefficient, `height` is the z where it is rough, or None.
    """

    def __init__(self, where: Any, complaint: Any, height: Any, remedy: Any) -> None:
        super().__init__(where, complaint, height, remedy)
        self.where, self.complaint, self.height, self.remedy = where, complaint, height, remedy

    def of(self, flow: Any, bottom: Any) -> Any:
        """Return the same with the flow named, and the height measured from where z = 0 in it."""
        height = None if self.height is None else self.height + bottom
        return NotSmooth(f"{flow}: {self.where}", self.complaint, height, self.remedy)

    def __str__(self) -> str:
        place = "" if self.height is None else f" near z = {self.height:.4g}"
        return f"{self.where}: {self.complaint}{place}: {self.remedy}"


class ConditionCount(ParameterError):
    """The conditions of a flow do not match the order of its layers."""


class NotResolved(StabilityError):
    """The tolerance is not met at the largest degree allowed.

    Raised by default; with strict=False the record carries the number and its error bar (in units of V/L), and a
    status.

    >>> from stability import dispersion, flows
    >>> relation = dispersion(flows.Poiseuille(Re=1e6), 1.0, "most-unstable", max_degree=24, strict=False)
    >>> relation[0]["status"] == "resolved", relation[0]["growth_rate"]
    (False, None)
    """


class ModeLost(StabilityError):
    """A mode could not be followed without risking a jump to another one.

    Raised by default, naming flow and wavenumber (units of 1/L); with strict=False the rows say so instead.

    >>> from stability import ModeLost, StabilityError
    >>> issubclass(ModeLost, StabilityError)
    True
    """


class WorkersLost(StabilityError):
    """Worker processes end again and again before they have finished anything."""


def naming(flow: Any, reason: str) -> str:
    """Return the reason with the flow named in front, once."""
    return reason if reason.startswith(f"{flow}: ") else f"{flow}: {reason}"
