"""Check the limit of a numerical function as k -> 0: a number, or the leading coefficient of an expansion.

What is extrapolated is the ratio to what is expected, by a few powers of k. Real and imaginary part each have a
coefficient of their own: the growth of long waves is often of higher order than their speed.
"""

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from .claims import claim_of
from .comparison import PART_NAMES, LimitMismatch, TooFewPoints
from .explain import extrapolate, is_astray
from .points import DECADES, FEWEST, PARTS, check_part, points_of

if TYPE_CHECKING:
    from .series import Expansion

LIMIT = 1e-3  # relative tolerance: a tenth of the 1 % by which a wrong limit should be found
_STANDARD_ERRORS = 5.0  # by which a limit must be off before that is said, and not that k is too large
_KNOWN = 0.1  # relative error up to which a limit is known at all
_EXPLAINED = 1.0  # misfit up to which a few powers explain the ratio


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
    misfit: float = 0.0
    astray: bool = False  # whether the numerics do not even behave like what is expected at the smallest k

    def agrees(self, tolerance: float) -> bool:
        """Whether value and error lie within the tolerance, relative to `scale`."""
        return abs(self.value - self.expected) <= tolerance * self.scale and self.error <= tolerance * self.scale

    @property
    def is_explained(self) -> bool:
        """Whether the numerics differ from what is expected by so much that k cannot be to blame."""
        known = self.misfit <= _EXPLAINED and self.error <= _KNOWN * self.scale
        return known and not self.astray and abs(self.value - self.expected) > _STANDARD_ERRORS * self.error

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
        return _coefficient(name, expected, k, values, floor)
    part, whole = getattr(asymptote, name), np.abs(asymptote)
    vanishes = not part.all()
    scale = np.ones(len(k)) if not whole.all() else whole if vanishes else part
    fit = extrapolate(k, (values - part) / scale, floor / np.abs(scale))
    astray = not vanishes and is_astray(k, values / scale, {0.0: 1.0})
    if np.isscalar(expected):
        size, value = float(abs(scale[0])), float(part[0])
        return Limit(name, fit.value * float(scale[0]) + value, fit.error * size, value, size, 0.0, fit.misfit, astray)
    return Limit(name, fit.value + (not vanishes), fit.error, float(not vanishes), 1.0, 0.0, fit.misfit, astray)


def _coefficient(name: str, law: "Expansion", k: np.ndarray, values: np.ndarray, floor: np.ndarray) -> Limit | None:
    """The first coefficient of a part of an expansion."""
    claim = claim_of(law, None)
    known = claim.coefficients[name]
    if not known:
        return None
    power = min(known)
    first = known[power]
    scale = first * k**power
    fit = extrapolate(k, values / scale - 1, floor / np.abs(scale), (claim.step,))
    return Limit(name, first * (1 + fit.value), abs(first) * fit.error, first, abs(first), power, fit.misfit,
                 is_astray(k, values / scale, {0.0: 1.0}))


def _blame(one: Limit) -> str:
    """What is wrong with a limit."""
    if one.is_explained:
        relative = f", off by {100 * (one.value / one.expected - 1):.2g} %" if one.expected else ""
        return f"{one}{relative}"
    return f"k is too large to tell the limit: {one}; take smaller k"
