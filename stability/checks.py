"""What a user may pass: numbers, wavenumbers, accuracy, names of files. Anything else is refused in one line.

What the command line passes, texts, needs no numerics to be looked at.
"""

import os
from math import inf
from typing import TYPE_CHECKING, Any

from .errors import ParameterError

if TYPE_CHECKING:
    import numpy as np

LARGEST = 1e20  # of a parameter or wavenumber, and 1/LARGEST the smallest beside 0: products of several stay finite

_SHOWN = 60  # characters of a wrong value in a message


def as_number(value: Any) -> float | None:
    """The value as a float, or None if it is no real number: text and zero-dimensional arrays may be."""
    if type(value) is float:
        return value
    if not isinstance(value, str | int) and not _is_real_scalar(value):
        return None
    try:
        return float(value)
    except OverflowError:  # an integer beyond the floats
        return inf if value > 0 else -inf
    except (TypeError, ValueError):
        return None


def _is_real_scalar(value: Any) -> bool:
    import numpy as np

    return not (isinstance(value, complex) or np.iscomplexobj(value) or value is np.ma.masked or np.ndim(value))


def in_double_precision(number: float) -> bool:
    """Whether a finite number is 0 or of a size whose products neither overflow nor underflow."""
    return number == 0 or 1 / LARGEST <= abs(number) <= LARGEST


def shown(value: Any, number: Any = None) -> Any:
    """A value given by the user, in one line of bounded length; as a number where it is one."""
    text = " ".join(repr(value).split()) if number is None else f"{number:g}"
    return text if len(text) <= _SHOWN else f"{text[:_SHOWN]}..."


def flat(values: Any, name: str) -> list[float]:
    """One value or a sequence of them as a list; what has more dimensions is refused, or its shape would be lost."""
    import numpy as np

    array = values if isinstance(values, np.ndarray) else np.asarray(values, dtype=object)
    if array.ndim > 1:
        raise ParameterError(f"{name} must be a number or a sequence of numbers (got shape {array.shape}): flatten it, "
                             "and give the results its shape")
    return array.ravel().tolist()


def check_wavenumbers(k: Any, name: str = "k") -> "np.ndarray":
    """Return k, a number or a sequence, as a float array (points,), or raise a ParameterError."""
    import numpy as np

    return np.array(_positive(flat(k, name), name))


def _positive(values: list[Any], name: str) -> list[float]:
    """Return values as wavenumbers, or raise a ParameterError."""
    if not values:
        raise ParameterError(f"{name}: give at least one wavenumber")
    numbers = [as_number(value) for value in values]
    for value, number in zip(values, numbers, strict=True):
        if number is None or not 0 < number < inf:
            raise ParameterError(f"{name} must be positive and finite (got {shown(value, number)})")
        if not in_double_precision(number):
            raise ParameterError(f"{name} must lie between {1 / LARGEST:g} and {LARGEST:g} for double precision: "
                                 f"change the scales (got {number:g})")
    return [number for number in numbers if number is not None]


def check_wavenumber(k: Any, name: Any = "k") -> Any:
    """Return one wavenumber as a float, or raise a ParameterError."""
    wavenumbers = check_wavenumbers(k, name)
    if len(wavenumbers) != 1:
        raise ParameterError(f"{name}: give one wavenumber (got {len(wavenumbers)})")
    return float(wavenumbers[0])


def check_tolerance(value: Any, name: str = "tolerance") -> float:
    """Return a relative tolerance as a float, or raise a ParameterError."""
    number = as_number(value)
    if number is None or not 1e-15 <= number <= 0.1:
        raise ParameterError(f"{name}: must lie in [1e-15, 0.1] (got {shown(value, number)})")
    return number


def check_integer(value: Any, name: str, low: int, high: int) -> int:
    """Return an integer, given as a number or as text, or raise a ParameterError."""
    number = as_number(value) if not isinstance(value, str) or value.isdecimal() else None
    if number is None or not low <= number <= high or number != int(number):
        raise ParameterError(f"{name}: must be an integer from {low} to {high} (got {shown(value, number)})")
    return int(number)


def check_options(name: str, value: str, options: tuple[Any, ...]) -> str:
    """Return one of a few names, or raise a ParameterError."""
    if not (isinstance(value, str) and value in options):
        raise ParameterError(f"{name} must be one of {', '.join(options)} (got {shown(value)})")
    return str(value)


def check_flag(name: str, value: bool) -> bool:
    """Return True or False, or raise a ParameterError."""
    import numpy as np

    if not isinstance(value, bool | np.bool_):
        raise ParameterError(f"{name} must be True or False (got {shown(value)})")
    return bool(value)


def check_range(values: Any, name: Any) -> Any:
    """Return two positive numbers low < high as a tuple of floats, or raise a ParameterError."""
    texts = isinstance(values, list) and all(isinstance(value, str) for value in values)
    numbers = _positive(values if texts else flat(values, name), name)
    if len(numbers) != 2 or not numbers[0] < numbers[1]:
        raise ParameterError(f"{name}: give a range (low, high) of positive numbers (got {shown(values)})")
    return numbers[0], numbers[1]


def as_file_name(path: Any) -> str | None:
    """The name of a file as text, or None if no file can have it: neither text nor a path, empty, or with a NUL."""
    name = os.fspath(path) if isinstance(path, str | os.PathLike) else None
    if not isinstance(name, str) or not name or "\0" in name:
        return None
    try:
        os.fsencode(name)
    except UnicodeEncodeError:
        return None
    return name


def check_file_name(path: Any, name: str) -> str:
    """Return the name of a file as text, or raise a ParameterError that begins with `name`."""
    text = as_file_name(path)
    if text is None:
        raise ParameterError(f"{name} must be the name of a file (got {shown(path)})")
    return text
