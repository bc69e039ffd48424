"""The points at which numerics are compared: which count, and what has been left out."""

from typing import Any

import numpy as np

from .errors import TooFewPoints

FEWEST = 4
NOISE = 3.0  # a difference counts only if it exceeds this many times the error of the numerics
DECADES = 100 * (1 + 1e-9)  # the largest k that is used, in units of the smallest: the order is that of k -> 0
PARTS = {"real": ("real",), "imag": ("imag",), "both": ("real", "imag")}
_ROUNDING = np.finfo(float).eps  # relative error of numbers that come without one, and the least of any


def check_part(part: str) -> None:
    """Raise ValueError where the part is none."""
    __tracebackhide__ = True
    if part not in PARTS:
        raise ValueError(f"part must be one of {', '.join(PARTS)} (got {part!r})")


def points_of(numeric: Any, series: Any, k: Any, error: Any) -> Any:
    """k, numerics, series and error of the numerics, complex and in increasing k, and what has been left out."""
    __tracebackhide__ = True
    k = np.asarray(k, dtype=float).ravel()
    if hasattr(series, "next_power"):
        series = series.function()
    numeric, series = (_values(values, k) for values in (numeric, series))
    given = np.broadcast_to(0.0 if error is None else np.asarray(error, dtype=float).ravel(), k.shape)
    floor = np.maximum(given, _ROUNDING * np.abs(numeric))
    rising = np.argsort(k)
    k, numeric, series, floor = k[rising], numeric[rising], series[rising], floor[rising]
    if (k <= 0).any():
        raise ValueError(f"k must be positive (got {k.min():g})")
    known = np.isfinite(k) & np.isfinite(numeric) & np.isfinite(series) & np.isfinite(floor)
    left_out: tuple[str, ...] = ()
    if not known.all():
        left_out = (f"{(~known).sum()} of {len(k)} points left out: not a number, first at k = {k[~known][0]:g}",)
    k, numeric, series, floor = (values[known] for values in (k, numeric, series, floor))
    k, once = np.unique(k, return_index=True)
    if len(once) < len(numeric):
        left_out += (f"{len(numeric) - len(once)} of {len(numeric)} points left out: k given before",)
    return k, numeric[once], series[once], floor[once], left_out


def used(k: Any, heard: Any, largest: Any, left_out: Any) -> Any:
    """Which points are `heard` above the noise, which lie near enough to k = 0, and what has been left out."""
    __tracebackhide__ = True
    highest = largest if largest is not None else DECADES * min(k[heard], default=np.inf)
    near = k <= highest
    if (heard & near).sum() < FEWEST:
        raise TooFewPoints(f"the difference between numerics and series exceeds {NOISE:g} times the numerics' error at "
                           f"{(heard & near).sum()} of {len(k)} points, {FEWEST} are needed: take larger k"
                           + "".join(f"; {one}" for one in left_out))
    if not near.all():
        left_out += (f"{(~near).sum()} of {len(k)} points left out: k above {highest:.4g}",)
    return heard, near, left_out


def _values(values: Any, k: np.ndarray) -> np.ndarray:
    """A function of an array or of a number, or an array, as complex values of the shape of k."""
    __tracebackhide__ = True
    if not callable(values):
        return np.asarray(values, dtype=complex).reshape(k.shape)
    try:
        found = np.asarray(values(k), dtype=complex)
    except (TypeError, ValueError):  # it takes numbers only
        found = None
    if found is None or found.shape != k.shape:
        found = np.array([complex(values(one)) for one in k.tolist()])
    return found


def only(part: str, values: np.ndarray) -> np.ndarray:
    """The complex values, without their imaginary or real part where only the other is asked for."""
    return {"both": values, "real": values.real + 0j, "imag": 1j * values.imag}[part]
