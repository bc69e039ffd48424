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

from dataclasses import dataclass, replace

import numpy as np

from .explain import BEND, Explanation, explain, extrapolate, is_astray
from .series import vanishes

TOLERANCE = 0.05
FEWEST = 4
NOISE = 3.0  # a difference counts only if it exceeds this many times the error of the numerics
ROUNDING = np.finfo(float).eps  # relative error of numbers that come without one, and the least of any
DECADES = 100 * (1 + 1e-9)  # the largest k that is used, in units of the smallest: the order is that of k -> 0
LIMIT = 1e-3  # tolerance of a limit: a tenth of the 1 % by which a wrong one should be found
MANY = 5  # more points than these allow to fit a drift of the slope
PARTS = {"real": ("real",), "imag": ("imag",), "both": ("real", "imag")}
_NAMES = {"real": "real part", "imag": "imaginary part"}


class OrderMismatch(AssertionError):
    """The difference falls at another order than expected; `comparison` holds the numbers."""

    def __init__(self, comparison: "Comparison"):
        super().__init__(f"{comparison.verdict}\n{comparison.table()}")
        self.comparison = comparison


class LimitMismatch(AssertionError):
    """The limit is another one than expected, or k is too large to tell."""


class TooFewPoints(ValueError):
    """Not enough points where the difference exceeds the error of the numerics."""


@dataclass(frozen=True, eq=False)
class Part:
    """Real or imaginary part of a difference; `observed` is None where it is not judged, `silence` then says why.

    A part agrees where it falls at the expected order or faster, or where k is too large to see the order; but not
    where it takes a lower power to explain it.
    """

    name: str
    expected: float
    observed: float | None = None
    tolerance: float = TOLERANCE
    towards: int = 1
    explanation: Explanation | None = None
    silence: str = ""

    @property
    def in_order(self) -> bool:
        return self.observed is None or self.towards * (self.observed - self.expected) >= -self.tolerance

    @property
    def agrees(self) -> bool:
        if self.explanation is None:
            return self.in_order
        return not self.explanation.coefficient_differs and (self.in_order or self.explanation.k_too_large)

    @property
    def remark(self) -> str:
        """What the verdict of the whole adds of this part."""
        if self.observed is None:
            return f"{_NAMES[self.name]} {self.silence}"
        order = f"{_NAMES[self.name]} of order {self.observed:.2f}, expected {self.expected:.4g}"
        seen = self.explanation is None or abs(self.observed - self.expected) <= self.tolerance
        return order if seen else f"{order}: {self.explanation}"


@dataclass(frozen=True, eq=False)
class Comparison:
    """Numerics against a series: arrays of shape (points,), in increasing k.

    slope      local slope of log |difference| between neighbours (points - 1 values)
    observed   slope as k -> 0, from all points together
    parts      real and imaginary part by themselves
    at_least   whether a higher order agrees too: for one part alone, where the other leaves out an earlier term
    left_out   what has been left out, a sentence each
    """

    k: np.ndarray
    numeric: np.ndarray
    series: np.ndarray
    slope: np.ndarray
    observed: float
    expected: float
    tolerance: float
    parts: tuple[Part, ...] = ()
    left_out: tuple[str, ...] = ()
    at_least: bool = False

    @property
    def difference(self) -> np.ndarray:
        return np.abs(self.numeric - self.series)

    @property
    def agrees(self) -> bool:
        return self._in_order and all(part.agrees for part in self.parts)

    @property
    def _in_order(self) -> bool:
        surplus = self.observed - self.expected
        return abs(surplus) <= self.tolerance or (self.at_least and surplus > 0)

    @property
    def verdict(self) -> str:
        """One line: the order observed and expected, and if they differ what explains it."""
        points = (f"(slope of log |difference|, tolerance {self.tolerance:g}, {len(self.k)} points, "
                  f"k = {self.k[0]:g} .. {self.k[-1]:g})")
        wrong = next((part for part in self.parts if not part.agrees), None)
        if wrong is not None and wrong.observed is not None:
            return (f"observed order {wrong.observed:.4f} of the {_NAMES[wrong.name]} differs from the expected "
                    f"{wrong.expected:.4f}: {wrong.explanation} {points}")
        observed, expected = f"observed order {self.observed:.4f}", f"the expected {self.expected:.4f}"
        expected += " at least" * self.at_least
        remarks = "".join(f"; {part.remark}" for part in self.parts)
        return f"{observed} {'agrees with' if self._in_order else 'differs from'} {expected} {points}{remarks}"

    def table(self) -> str:
        """k, numerics, series, difference and local slope, one point a line."""
        lines = [f"{'k':>12}  {'numeric':>40}  {'series':>40}  {'error':>10}  {'slope':>7}"]
        slopes = ["", *(f"{slope:.3f}" for slope in self.slope)]
        for k, numeric, series, error, slope in zip(self.k, self.numeric, self.series, self.difference, slopes,
                                                    strict=True):
            lines.append(f"{k:12.6g}  {_complex(numeric):>40}  {_complex(series):>40}  {error:10.3e}  {slope:>7}")
        return "\n".join(lines)


@dataclass(frozen=True)
class _Claim:
    """What is known of the difference, by part where a dict.

    parts   the powers to expect
    below   lower ones that show where a coefficient is wrong
    """

    expected: float
    parts: dict[str, float]
    below: dict[str, list[float]]
    step: float
    coefficients: dict[str, dict[float, float]]
    correction: float | None
    towards: int = 1


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
    claim = _claim(series, expected)
    k, numeric, series, floor, left_out = _points(numeric, series, k, error)
    numeric, series = (_only(part, values) for values in (numeric, series))
    heard = np.abs(numeric - series) > NOISE * floor
    highest = largest if largest is not None else DECADES * min(k[heard], default=np.inf)
    near = k <= highest
    if (heard & near).sum() < FEWEST:
        raise TooFewPoints(f"the difference between numerics and series exceeds {NOISE:g} times the numerics' error at "
                           f"{(heard & near).sum()} of {len(k)} points, {FEWEST} are needed: take larger k"
                           + "".join(f"; {one}" for one in left_out))
    if not near.all():
        left_out += (f"{(~near).sum()} of {len(k)} points left out: k above {highest:.4g}",)
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


# -- what is claimed -------------------------------------------------------------------------------------


def _claim(series, expected) -> _Claim:
    if hasattr(series, "next_power"):
        return _claim_of_expansion(series, expected)
    if expected is None:
        raise TypeError("expected must be given unless the series is an Expansion")
    power = float(expected)
    below = np.arange(max(0.0, np.ceil(power))).tolist()
    return _Claim(power, dict.fromkeys(_NAMES, power), dict.fromkeys(_NAMES, below), 1.0,
                  dict.fromkeys(_NAMES, {}), None, -1 if power < 0 else 1)


def _claim_of_expansion(law, expected) -> _Claim:
    values = law.values()
    following = law.next_powers if expected is None else dict.fromkeys(_NAMES, float(expected))
    spacing = float(law.spacing)
    first = float(law.next_power if expected is None else expected)
    towards = 1 if first > float(max(values)) else -1
    coefficients = {name: {float(power): getattr(c, name) for power, c in values.items() if not vanishes(c, name)}
                    for name in _NAMES}
    below = {name: [float(power) for power in values if _has(law, name, power)] for name in _NAMES}
    step = 2 * spacing if law.alternates and spacing == 1 else spacing
    return _Claim(first, {name: float(power) for name, power in following.items()}, below, step, coefficients,
                  spacing if towards > 0 else None, towards)


def _has(law, part, power) -> bool:
    """Whether a power can occur in a part."""
    return not law.alternates or power % 2 == (part == "imag")


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


def _complex(value: complex) -> str:
    return f"{value.real:.12e}" if value.imag == 0 else f"{value.real:.12e}{value.imag:+.12e}j"
