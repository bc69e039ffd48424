"""Wavenumbers on the command line: a number, a list a,b,c, or a range a:b:n (log-spaced) or a:b:n:lin."""

from math import isfinite
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np

_MOST = 100_000


class BadSpec(ValueError):
    """Text that is no SPEC of positive numbers."""


def parse_spec(text: str, name: str) -> "np.ndarray":
    """Return the positive values of a SPEC (count,); raises BadSpec, which names `name`."""
    if ":" in text:
        return _range(text, name)
    values = [_number(part, name) for part in text.split(",")]
    if not min(values) > 0:
        raise BadSpec(f"{name}: values must be positive (got {min(values):g})")
    import numpy as np

    return np.array(values)


def _range(text: str, name: str) -> "np.ndarray":
    parts = text.split(":")
    linear = parts[3:] == ["lin"]
    if len(parts) != 3 and not linear:
        raise BadSpec(f"{name}: a range is a:b:n or a:b:n:lin (got {text!r})")
    start, stop = _number(parts[0], name), _number(parts[1], name)
    count = int(parts[2]) if parts[2].isdecimal() else 0
    if not 2 <= count <= _MOST:
        raise BadSpec(f"{name}: the number of points must be an integer from 2 to {_MOST} (got {parts[2]!r})")
    if not start < stop:
        raise BadSpec(f"{name}: a range must rise, a < b (got {text!r})")
    if start <= 0:
        raise BadSpec(f"{name}: a range of wavenumbers starts above 0 (got {text!r}); take "
                      f"{stop / 1000:g}:{stop:g}:{count}{':lin' if linear else ''}")
    import numpy as np

    return (np.linspace if linear else np.geomspace)(start, stop, count)


def _number(text: str, name: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    if not isfinite(value):
        raise BadSpec(f"{name}: not a finite number: {text!r}; give a number, a list a,b,c or a range a:b:n[:lin]")
    return value
