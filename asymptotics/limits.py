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

import numpy as np

from .claims import claim_of
from .comparison import TOLERANCE, Comparison, LimitMismatch, OrderMismatch, Part, TooFewPoints
from .explain import BEND, explain, extrapolate, is_astray

FEWEST = 4
NOISE = 3.0  # a difference counts only if it exceeds this many times the error of the numerics
ROUNDING = np.finfo(float).eps  # relative error of numbers that come without one, and the least of any
DECADES = 100 * (1 + 1e-9)  # the largest k that is used, in units of the smallest: the order is that of k -> 0
LIMIT = 1e-3  # tolerance of a limit: a tenth of the 1 % by which a wrong one should be found
MANY = 5  # more points than these allow to fit a drift of the slope
PARTS = {"real": ("real",), "imag": ("imag",), "both": ("real", "imag")}


def compare(numeric, series, k, expected=None, *, part: str = "both", correction="known", error=None,
            largest: float | None = None, tolerance: float = TOLERANCE) -> Comparison:
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
    if part not in PARTS:
        raise ValueError(f"part must be one of {', '.join(PARTS)} (got {part!r})")
    claim = claim_of(series, expected)
    k, numeric, series, floor, left_out = _points(numeric, series, k, error)
    numeric, series = (_only(part, values) for values in (numeric, series))
    heard, near, left_out = _used(k, np.abs(numeric - series) > NOISE * floor, largest, left_out)
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


def assert_order(numeric, series, k, expected: float | None = None, **options) -> Comparison:
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


def assert_limit(numeric, expected, k, *, error=None, tolerance: float = LIMIT) -> complex:
    """Return the limit of numeric/expected as k -> 0, extrapolated, which must be 1; or raise LimitMismatch.

    expected    a number that `numeric` tends to, a function of k or an array of the shape of k, or an `Expansion`,
                whose leading term is meant; where the number is 0, the limit of `numeric` itself must be 0
    tolerance   of real and imaginary part of that limit, and of its standard error
    numeric, k and error as for `compare`.

    >>> import numpy as np
    >>> bool(abs(assert_limit(lambda k: np.sin(k) / k, 1, np.geomspace(1e-2, 1, 9)) - 1) < 1e-6)
    True

    Wavenumbers and values are in the scales of the flow. Raises TooFewPoints where fewer than four k remain.
    """
    __tracebackhide__ = True
    ratio = not np.isscalar(expected) or expected != 0
    k, numeric, series, floor, left_out = _points(numeric, _leading(expected), k, error)
    near = k <= DECADES * min(k, default=0)
    if near.sum() < FEWEST:
        raise TooFewPoints(f"{near.sum()} points, {FEWEST} are needed: give more k"
                           + "".join(f"; {one}" for one in left_out))
    k, numeric, series, floor = (values[near] for values in (k, numeric, series, floor))
    scale = series if ratio else np.ones_like(series)
    parts = [extrapolate(k, part, floor / np.abs(scale)) for part in
             (((numeric - series) / scale).real, ((numeric - series) / scale).imag)]
    wrong = [abs(part.value) > tolerance or part.error > tolerance for part in parts]
    limit = complex(ratio + parts[0].value, parts[1].value)
    if any(wrong):
        what = "numeric/expected" if ratio else "numeric"
        raise LimitMismatch(f"{what} tends to {limit.real:.6g}{limit.imag:+.6g}j +- {max(p.error for p in parts):.1g} "
                            f"as k -> 0, not to {ratio:d} (tolerance {tolerance:g}, {len(k)} points, k = {k[0]:g} .. "
                            f"{k[-1]:g})")
    return limit


def _leading(expected):
    """What numerics tend to: an array or a function as it is, a number as a function, an Expansion's first term."""
    if hasattr(expected, "next_power"):
        return expected.truncated(min(power for power, c in expected.terms.items() if c != 0))
    return (lambda k: np.full(np.shape(k), expected, dtype=complex)) if np.isscalar(expected) else expected


# -- the points ------------------------------------------------------------------------------------------


def _points(numeric, series, k, error):
    """k, numerics, series and error of the numerics, complex and in increasing k, and what has been left out."""
    __tracebackhide__ = True
    k = np.asarray(k, dtype=float).ravel()
    if hasattr(series, "next_power"):
        series = series.function()
    numeric, series = (_values(values, k) for values in (numeric, series))
    given = np.broadcast_to(0.0 if error is None else np.asarray(error, dtype=float).ravel(), k.shape)
    floor = np.maximum(given, ROUNDING * np.abs(numeric))
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


def _used(k, heard, largest, left_out):
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


def _values(values, k):
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


def _only(part, values):
    """The complex values, without their imaginary or real part where only the other is asked for."""
    return {"both": values, "real": values.real + 0j, "imag": 1j * values.imag}[part]


# -- one part --------------------------------------------------------------------------------------------


def _part(name, claim, k, numeric, series, floor, correction, tolerance) -> Part:
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


def _order(k, difference, error, correction) -> float:
    """Least-squares slope; a point counts less the nearer its difference is to the numerics' error."""
    columns = [np.ones_like(k), np.log(k)]
    if correction is not None:
        columns.append((k / k[-1]) ** correction)
    weight = 1 / np.hypot(BEND, error / difference)
    fit = np.linalg.lstsq(np.column_stack(columns) * weight[:, None], np.log(difference) * weight, rcond=None)
    return float(fit[0][1])
