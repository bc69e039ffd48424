"""Values given on the command line: a number, a list `a,b,c`, or a range `a:b:n` (log-spaced) or `a:b:n:lin`."""

from math import inf, isfinite
from typing import Any

import numpy as np

from ..errors import ParameterError

_MOST = 100_000
_LEAST = 1e-3  # start of the range that is proposed, relative to its end


def parse_spec(text: Any, name: Any, positive: Any = True, unbounded: Any = False) -> Any:
    """Return the values of a SPEC as a float array (count,); raise a ParameterError that names `name`.

    `unbounded` admits inf in a list.
    """
    values = _range(text, name, positive) if ":" in text else \
        np.array([_number(part, name, unbounded) for part in text.split(",")])
    if positive and not np.all(values > 0):
        raise ParameterError(f"{name}: values must be positive (got {min(values):g})")
    return values


def parse_one(text: str, name: str, what: str = "value") -> float:
    """Return a SPEC of a single positive number as a float; `what` names it in the message."""
    values = parse_spec(text, name)
    if len(values) != 1:
        raise ParameterError(f"{name}: one {what} at a time (got {len(values)})")
    return float(values[0])


def _range(text: str, name: str, positive: bool) -> np.ndarray:
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
    if linear:
        return np.linspace(start, stop, count)
    if start <= 0:
        raise ParameterError(f"{name}: a logarithmic range starts above 0 (got {text!r}); add :lin for equal steps")
    return np.geomspace(start, stop, count)


def _number(text: str, name: str, unbounded: bool = False) -> float:
    try:
        value = float(text)
    except ValueError:
        value = None
    if value is None or not (isfinite(value) or unbounded and value == inf):
        raise ParameterError(f"{name}: not a finite number: {text!r}; "
                             "give a number, a list a,b,c or a range a:b:n[:lin]")
    return value
