"""Values given on the command line: a number, a list `a,b,c`, or a range `a:b:n` (log-spaced) or `a:b:n:lin`.

They are read, and refused, without numerics; `Spec.array` has the numbers.
"""

from dataclasses import dataclass
from math import inf, isfinite
from typing import TYPE_CHECKING

from ..errors import ParameterError

if TYPE_CHECKING:
    import numpy as np

_MOST = 100_000
_LEAST = 1e-3  # start of the range that is proposed, relative to its end


@dataclass(frozen=True)
class Spec:
    """The `known` values of a SPEC: all of a list, or the first and the last of a range of `count`."""

    known: tuple[float, ...]
    count: int
    linear: bool = True

    def __len__(self) -> int:
        return self.count

    @property
    def array(self) -> "np.ndarray":
        """All values, shape (count,)."""
        import numpy as np

        if self.count == len(self.known):
            return np.array(self.known)
        low, high = self.known
        return (np.linspace if self.linear else np.geomspace)(low, high, self.count)


def read_spec(text: str, name: str, positive: bool = True, unbounded: bool = False) -> Spec:
    """Return what a SPEC says; raise a ParameterError that names `name`. `unbounded` admits inf in a list."""
    if ":" in text:
        spec = _range(text, name, positive)
    else:
        numbers = tuple(_number(part, name, unbounded) for part in text.split(","))
        spec = Spec(numbers, len(numbers))
    if positive and not min(spec.known) > 0:
        raise ParameterError(f"{name}: values must be positive (got {min(spec.known):g})")
    return spec


def parse_spec(text: str, name: str, positive: bool = True, unbounded: bool = False) -> "np.ndarray":
    """Return the values of a SPEC as a float array (count,), or raise a ParameterError, as `read_spec` does."""
    return read_spec(text, name, positive, unbounded).array


def parse_one(text: str, name: str, what: str = "value") -> float:
    """Return a SPEC of a single positive number as a float; `what` names it in the message."""
    spec = read_spec(text, name)
    if len(spec) != 1:
        raise ParameterError(f"{name}: one {what} at a time (got {len(spec)})")
    return spec.known[0]


def _range(text: str, name: str, positive: bool) -> Spec:
    parts = text.split(":")
    linear = parts[3:] == ["lin"]
    if len(parts) != 3 and not linear:
        raise ParameterError(f"{name}: a range is a:b:n or a:b:n:lin (got {text!r})")
    start, stop = _number(parts[0], name), _number(parts[1], name)
    count = int(parts[2]) if parts[2].isdecimal() else 0
    if not 2 <= count <= _MOST:
        raise ParameterError(f"{name}: the number of points must be an integer from 2 to {_MOST} (got {parts[2]!r})")
    if start <= 0 < stop and (positive or not linear):
        would_do = f"{stop * _LEAST:g}:{stop:g}:{count}"
        others = ":lin" if positive and linear else "" if positive else f", or {text}:lin for equal steps"
        kind = "a range of positive values" if linear else "a logarithmic range"
        raise ParameterError(f"{name}: {kind} starts above 0 (got {text!r}); {would_do}{others} would do")
    if not start < stop:
        raise ParameterError(f"{name}: a range must rise, a < b (got {text!r})")
    if not linear and start <= 0:
        raise ParameterError(f"{name}: a logarithmic range starts above 0 (got {text!r}); add :lin for equal steps")
    return Spec((start, stop), count, linear)


def _number(text: str, name: str, unbounded: bool = False) -> float:
    try:
        value = float(text)
    except ValueError:
        value = None
    if value is None or not (isfinite(value) or unbounded and value == inf):
        raise ParameterError(f"{name}: not a finite number: {text!r}; "
                             "give a number, a list a,b,c or a range a:b:n[:lin]")
    return value
