"""Why a difference does not fall at the expected order: is a coefficient wrong, or is k too large for the series?

The difference d(k) is fitted by a few successive powers, sum of a_q k^q, from the first power left out on, and from
each lower one on, with equally many terms; to the smallest k alone where there is no fit to all. If a lower power is
needed, the coefficient there differs by a_q. This is for series in rising powers: for k -> oo the order alone decides.
"""

from bisect import bisect
from collections.abc import Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import numpy as np

BEND = 0.01  # relative departure of the difference from a few powers that is not blamed on the numerics
_TERMS = 4  # of a fit, if there are more points than that
STEPS = 1 / 3, 1 / 2, 2 / 3, 1.0, 2.0  # between successive powers of the problems there are
_ROUNDING = np.finfo(float).eps  # of the largest difference: where another one vanishes
_FEWEST = 6  # points of a fit, if there are as many
_SHRINK = 0.9  # of the number of points from one attempt to the next
_ALSO, _EXACT = 3.0, 1e-9  # misfit over that of the best fit, up to which another is as good; one of rounding
_GOOD = 1.0  # misfit of a fit that explains the difference
_BETTER = 3.0  # a lower power is needed only if the misfit without it is this many times as large
_ASTRAY, _ASTRAY_POINTS = 0.5, 4  # powers by which numerics rise more slowly than a series that is of no use there
_STANDARD_ERRORS = 5.0  # and if its coefficient is this many times its error


@dataclass(frozen=True)
class Fit:
    """sum of a_q k^q for successive powers q from `power` on; `value` is the first a_q, `error` its standard error.

    misfit   root mean square of (fit - d) in units of the error of the numerics and `BEND` of d
    """

    power: float
    value: float
    error: float
    misfit: float

    @property
    def stands_out(self) -> bool:
        return abs(self.value) > _STANDARD_ERRORS * self.error

    @property
    def is_good(self) -> bool:
        """Whether its powers explain the difference."""
        return self.misfit <= _GOOD


@dataclass(frozen=True)
class Explanation:
    """What the fits say of one part of a difference.

    first          the fit that explains it, None where none does
    last           where that needs no lower power: the fit from the last coefficient of the series on
    coefficients   {power: coefficient of the series}
    astray         whether the numerics do not even rise like the first term of the series: nothing is then said of its
                   coefficients, for far beyond its range the difference is the series itself
    """

    expected: float
    first: Fit | None
    last: Fit | None
    coefficients: dict[float, float]
    astray: bool = False

    @property
    def coefficient_differs(self) -> bool:
        return not self.astray and self.first is not None and self.first.power != self.expected

    @property
    def k_too_large(self) -> bool:
        return not self.astray and self.first is not None and self.first.power == self.expected

    def __str__(self) -> str:
        if self.astray:
            return (f"k is too large for this expansion: the numerics do not even rise like its first term, "
                    f"k^{_power(min(self.coefficients))}; take smaller k")
        if self.first is None:
            return "a few powers of k do not explain the difference: take more k, smaller ones, or give errors"
        if self.coefficient_differs:
            return self._differs(self.first)
        said = f"k is too large for this expansion: no power below {_power(self.expected)} is needed"
        return said if self.last is None else f"{said}, {self._differs(self.last)}"

    def _differs(self, fit: Fit) -> str:
        known = self.coefficients.get(fit.power)
        relative = f", that is {100 * fit.value / known:.2g} % of it" if known else ""
        return f"the coefficient of k^{_power(fit.power)} differs by {fit.value:.3g} +- {fit.error:.1g}{relative}"


def explain(k: np.ndarray, difference: np.ndarray, error: np.ndarray, below: list[float], expected: float, step: float,
            coefficients: dict[Any, Any]) -> Explanation:
    """Fit a real difference of shape (points,), k increasing.

    below          powers that may occur under the expected one
    step           distance from the expected power to the next ones
    coefficients   {power: coefficient of the series}: those that are in every fit that begins below them
    """
    beyond = [expected + step * number for number in range(_TERMS)]
    known = sorted(power for power in coefficients if power < expected)
    candidates = [*reversed(known), *(power for power in reversed(below) if power < expected and power not in known)]
    for points in _windows(len(k)):
        count = min(_TERMS, points - 1)

        def fit(power: float, points: int = points, count: int = count) -> "Fit":
            powers = [power, *known[bisect(known, power):], *beyond] if power < expected else beyond
            return _fit(k[:points], difference[:points], error[:points], powers[:count])

        usual = fit(expected)
        if usual.is_good:
            return Explanation(expected, usual, fit(known[-1]) if known else None, coefficients)
        for found in map(fit, candidates):
            if found.is_good and found.misfit * _BETTER < usual.misfit and found.stands_out:
                return Explanation(expected, found, None, coefficients)
    return Explanation(expected, None, None, coefficients)


def is_astray(k: np.ndarray, values: np.ndarray, coefficients: dict[Any, Any]) -> bool:
    """Whether real values of shape (points,) rise more slowly than the first term of the series at the smallest k."""
    few = np.abs(values[:_ASTRAY_POINTS])
    if not coefficients or not few.all():
        return False
    slope = np.polyfit(np.log(k[:_ASTRAY_POINTS]), np.log(few), 1)[0]
    return bool(slope < min(coefficients) - _ASTRAY or np.ptp(np.sign(values[:_ASTRAY_POINTS])) > 0)


def _windows(points: int) -> Iterator[Any]:
    """Numbers of the smallest k to try, all of them first."""
    while points > _FEWEST:
        yield points
        points = int(_SHRINK * points)
    yield points


def extrapolate(k: np.ndarray, values: np.ndarray, error: np.ndarray, steps: tuple[float, ...] = STEPS) -> Fit:
    """The constant that real values of shape (points,) tend to as k -> 0, by a few powers of one of the `steps`.

    From all points or, where no step explains those, from the smallest; the steps that explain them agree within the
    `error`. Where none does the fit is not good: k is too large to tell.
    """
    for points in _windows(len(k)):
        count = min(_TERMS, points - 1)
        fits = [_fit(k[:points], values[:points], error[:points], [step * number for number in range(count)])
                for step in steps]
        best = min(fits, key=lambda fit: fit.misfit)
        if best.is_good:
            break
    doubt = max(abs(fit.value - best.value) for fit in fits if fit.misfit <= max(_ALSO * best.misfit, _EXACT))
    return replace(best, error=best.error * min(1.0, best.misfit) + doubt)  # the fit may be far better than `BEND`


def _fit(k: np.ndarray, difference: np.ndarray, error: np.ndarray, powers: list[float]) -> Fit:
    """Weighted least squares; a misfit beyond the error of the numerics enlarges the error of the coefficient."""
    size = np.abs(difference)
    weight = 1 / (np.hypot(error, BEND * size) + (_ROUNDING * size.max() or 1.0))
    columns = np.column_stack([(k / k[-1]) ** power for power in powers]) * weight[:, None]
    scale = np.linalg.norm(columns, axis=0)
    values, _, _, _ = np.linalg.lstsq(columns / scale, difference * weight, rcond=None)
    residual = columns / scale @ values - difference * weight
    misfit = float(np.sqrt(np.sum(residual**2) / (len(k) - len(powers))))
    spread = np.sqrt(np.linalg.pinv((columns / scale).T @ (columns / scale))[0, 0])
    unit = scale[0] * k[-1] ** powers[0]
    return Fit(powers[0], float(values[0] / unit), float(spread * max(1.0, misfit) / unit), misfit)


def _power(power: float) -> str:
    return str(Fraction(power).limit_denominator(12))
