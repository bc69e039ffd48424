"""Check a numerical function against an expansion by the order at which the difference falls.

If sigma(k) = truncated series + C k^p + ..., the difference has slope p in log-log axes. Finding p proves all
coefficients of the truncated series at once: one that is 1 % wrong leaves a slope of its own, lower power. Real and
imaginary parts are judged separately too: the larger one would hide a wrong coefficient of the other.

>>> import numpy as np
>>> k = np.geomspace(1e-3, 1e-1, 9)
>>> comparison = assert_order(np.sin, lambda k: k - k**3 / 6, k, expected=5)
>>> round(comparison.observed, 2)
5.0
"""

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from .claims import claim_of
from .comparison import TOLERANCE, Comparison, OrderMismatch, Part
from .explain import BEND, explain, is_astray
from .points import FEWEST, NOISE, PARTS, check_part, only, points_of, used

if TYPE_CHECKING:
    from .claims import Claim

MANY = 5  # more points than these allow to fit a drift of the slope


def compare(numeric: Any, series: Any, k: Any, expected: Any = None, *, part: str = "both", correction: Any = "known",
            error: Any = None, largest: float | None = None, tolerance: float = TOLERANCE) -> Comparison:
    """Compare numerics with a series over wavenumbers (or values of another gauge) k of shape (points,).

    numeric, series   functions of an array k, of a number k, or arrays of the shape of k; complex or real. The series
                      may be an `Expansion` whose parameters all have values: it knows the powers to expect
    expected          power of the first term that the series leaves out: that of the whole, which each part then must
                      reach at least
    part              "real" or "imag" part alone, or "both": each by itself, besides the modulus of their difference
    correction        relative power of the term after that: fits the slope as p + (slope's drift) k^correction; None
                      fits none, and by default it is what an `Expansion` knows, if there are more than five points
    error             error of the numerics, same shape: points whose difference does not stand out from it
                      are left out, the others weighted by it
    largest           largest k that is used; by default those of two decades above the smallest
    Points where k or a value is not a number are left out, which `left_out` says, as it does of those beyond `largest`.
    Raises TooFewPoints if fewer than four points remain.
    """
    __tracebackhide__ = True
    check_part(part)
    claim = claim_of(series, expected)
    k, numeric, series, floor, left_out = points_of(numeric, series, k, error)
    numeric, series = (only(part, values) for values in (numeric, series))
    heard, near, left_out = used(k, np.abs(numeric - series) > NOISE * floor, largest, left_out)
    if correction == "known":
        correction = claim.correction if near.sum() > MANY else None
    parts = tuple(_part(name, claim, k[near], numeric[near], series[near], floor[near], correction, tolerance)
                  for name in PARTS[part])
    k, numeric, series, floor = (values[heard & near] for values in (k, numeric, series, floor))
    difference = np.abs(numeric - series)
    slope = np.diff(np.log(difference)) / np.diff(np.log(k))
    whole = claim.expected if part == "both" else claim.parts[part]
    return Comparison(k, numeric, series, slope, _order(k, difference, floor, correction), whole, tolerance, parts,
                      left_out, whole > claim.expected)


def assert_order(numeric: Any, series: Any, k: np.ndarray, expected: float | None = None, **options: Any) -> Comparison:
    """Return the comparison, or raise OrderMismatch with its table. Arguments as for `compare`.

    `series` may be an `Expansion` whose parameters all have values: it knows the power to expect.

    >>> from asymptotics import expand
    >>> import numpy as np
    >>> law, longer = (expand("vortex", order=order, slope_deg=45, Fr2=0) for order in (2, 4))
    >>> assert_order(longer.function(), law, np.geomspace(1e-3, 1e-1, 9)).expected
    4.0

    Wavenumbers and values are in the scales of the flow, the order is a number. Raises TooFewPoints and ValueError as
    `compare` does.
    """
    __tracebackhide__ = True
    comparison = compare(numeric, series, k, expected, **options)
    if not comparison.agrees:
        raise OrderMismatch(comparison)
    return comparison


# -- one part --------------------------------------------------------------------------------------------


def _part(name: str, claim: "Claim", k: np.ndarray, numeric: np.ndarray, series: np.ndarray, floor: np.ndarray,
          correction: float | None, tolerance: float) -> Part:
    """Judge the real or imaginary part of all points, heard or not."""
    expected = claim.parts[name]
    if name == "imag" and not numeric.imag.any() and not series.imag.any():
        return Part(name, expected, silence="vanishes")
    difference = getattr(numeric - series, name)
    heard = np.abs(difference) > NOISE * floor
    if not heard.any():
        vanishes = not getattr(series, name).any()
        return Part(name, expected, silence="vanishes" if vanishes else "differs by less than the numerics' error")
    if heard.sum() < FEWEST:
        return Part(name, expected, silence=f"differs by more than the numerics' error at {heard.sum()} of {len(k)} "
                    "points only: not judged")
    k, difference, floor = k[heard], difference[heard], floor[heard]
    order = _order(k, np.abs(difference), floor, correction)
    why = None
    if claim.towards > 0:
        why = explain(k, difference, floor, claim.below[name], expected, claim.step, claim.coefficients[name])
        astray = is_astray(k, getattr(numeric, name)[heard], claim.coefficients[name])
        why = replace(why, astray=astray and not abs(order - expected) <= tolerance)
    return Part(name, expected, order, tolerance, claim.towards, why)


def _order(k: np.ndarray, difference: np.ndarray, error: np.ndarray, correction: float | None) -> float:
    """Least-squares slope; a point counts less the nearer its difference is to the numerics' error."""
    columns = [np.ones_like(k), np.log(k)]
    if correction is not None:
        columns.append((k / k[-1]) ** correction)
    weight = 1 / np.hypot(BEND, error / difference)
    fit = np.linalg.lstsq(np.column_stack(columns) * weight[:, None], np.log(difference) * weight, rcond=None)
    return float(fit[0][1])
