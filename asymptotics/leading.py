"""Check the limit of a numerical function as k -> 0: a number, or the leading coefficient of an expansion.

What is extrapolated is the ratio to what is expected, by a few powers of k. Real and imaginary part each have a
coefficient of their own: the growth of long waves is often of higher order than their speed.
"""

from dataclasses import dataclass
from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np

from .claims import claim_of
from .comparison import PART_NAMES, LimitMismatch
from .errors import TooFewPoints
from .explain import STEPS, extrapolate, is_astray
from .points import DECADES, FEWEST, PARTS, check_part, points_of

LIMIT = 1e-3  # relative tolerance: a tenth of the 1 % by which a wrong limit should be found
_KNOWN = 0.1  # relative error up to which a limit is known at all


@dataclass(frozen=True)
class Limit:
    """Limit of one part as k -> 0: `value` +- `error`, where `expected` was expected, in units of k^`power`.

    Where nothing was expected of the part but that it vanishes beside the other, `expected` is 0, and `scale` is the
    size of the other.
    """

    name: str
    value: float
    error: float
    expected: float
    scale: float
    power: float = 0.0
    is_other: bool = False  # whether the numerics tend to something else, and k cannot be to blame

    def agrees(self, tolerance: float) -> bool:
        """Whether value and error lie within the tolerance, relative to `scale`."""
        return abs(self.value - self.expected) <= tolerance * self.scale and self.error <= tolerance * self.scale

    def __str__(self) -> str:
        power = "" if self.power == 1 else f"^{Fraction(self.power).limit_denominator(12)}"
        what = f"the coefficient of k{power} is" if self.power else "tends to"
        return f"{PART_NAMES[self.name]}: {what} {self.value:.6g} +- {self.error:.1g}, expected {self.expected:.6g}"


class Limits(NamedTuple):
    """What was found of the real and of the imaginary part; None for one that was not asked for or is not known.

    >>> print(Limits(Limit("real", 0.9999, 2e-4, 1.0, 1.0), None))
    real part: tends to 0.9999 +- 0.0002, expected 1
    """

    real: Limit | None
    imag: Limit | None

    def __str__(self) -> str:
        return "; ".join(str(one) for one in self if one)


def assert_limit(numeric: Any, expected: Any, k: Any, *, part: str = "both", error: Any = None,
                 tolerance: float = LIMIT) -> Limits:
    """Return the `Limits` of real and imaginary part as k -> 0, extrapolated; or raise LimitMismatch.

    expected    a number that `numeric` tends to; or an `Expansion` whose parameters have values: of each part the
                first coefficient is meant; or a function of k or an array of the shape of k, to which `numeric` is
                asymptotic: then limits of the ratio are returned, 1 is expected
    part        "real" or "imag" part alone, or "both", each by itself
    tolerance   of each limit and of its error, relative; where 0 is expected, relative to the other part if that is not
                0 as well
    numeric, k and error as for `assert_order`.

    >>> import numpy as np
    >>> found = assert_limit(lambda k: np.sin(k) / k, 1, np.geomspace(1e-2, 1, 9))
    >>> bool(abs(found.real.value - 1) < 1e-9), found.imag.value
    (True, 0.0)

    Wavenumbers and values are in the scales of the flow. Raises TooFewPoints where fewer than four k remain, and
    ValueError for another `part`.
    """
    __tracebackhide__ = True
    check_part(part)
    series = (lambda k: np.full(np.shape(k), expected, dtype=complex)) if np.isscalar(expected) else expected
    k, values, asymptote, floor, left_out = points_of(numeric, series, k, error)
    near = k <= DECADES * min(k, default=0)
    if near.sum() < FEWEST:
        raise TooFewPoints(f"{near.sum()} points, {FEWEST} are needed: give more k"
                           + "".join(f"; {one}" for one in left_out))
    k, values, asymptote, floor = (array[near] for array in (k, values, asymptote, floor))
    found = {name: _limit(name, expected, k, values, asymptote, floor) for name in PARTS[part]}
    limits = Limits(found.get("real"), found.get("imag"))
    wrong = [one for one in limits if one and not one.agrees(tolerance)]
    if wrong:
        raise LimitMismatch("; ".join(_blame(one) for one in wrong) + f" (as k -> 0, tolerance {tolerance:g}, "
                            f"{len(k)} points, k = {k[0]:g} .. {k[-1]:g})")
    return limits


def _limit(name: str, expected: Any, k: np.ndarray, values: np.ndarray, asymptote: np.ndarray,
           floor: np.ndarray) -> Limit | None:
    """The limit of a part, None where nothing is known of it."""
    values = getattr(values, name)
    if hasattr(expected, "next_power"):
        claim = claim_of(expected, None)
        known = claim.coefficients[name]
        if not known:
            return None
        power = min(known)
        first = known[power] * k**power
        return _extrapolated(name, k, values, first, first, floor, known[power], power, (claim.step,))
    part, whole = getattr(asymptote, name), np.abs(asymptote)
    scale = np.ones(len(k)) if not whole.all() else part if part.all() else whole
    return _extrapolated(name, k, values, part, scale, floor, float(scale[0]) if np.isscalar(expected) else 1.0)


def _extrapolated(name: str, k: np.ndarray, values: np.ndarray, part: np.ndarray, scale: np.ndarray, floor: np.ndarray,
                  unit: float, power: float = 0.0, steps: tuple[float, ...] = STEPS) -> Limit:
    """The limit of values over `scale`, times `unit`: expected to be that of `part`, or 0 where that has zeros."""
    fit = extrapolate(k, (values - part) / scale, floor / np.abs(scale), steps)
    vanishes = not part.all()
    astray = not vanishes and is_astray(k, values / scale, {0.0: 1.0})  # they do not even behave alike
    other = fit.is_good and fit.stands_out and fit.error <= _KNOWN and not astray
    expected = 0.0 if vanishes else unit
    return Limit(name, expected + unit * fit.value, abs(unit) * fit.error, expected, abs(unit), power, other)


def _blame(one: Limit) -> str:
    """What is wrong with a limit."""
    if one.is_other:
        relative = f", off by {100 * (one.value / one.expected - 1):.2g} %" if one.expected else ""
        return f"{one}{relative}"
    return f"k is too large to tell the limit: {one}; take smaller k"
