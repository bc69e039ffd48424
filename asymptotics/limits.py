"""Check a numerical function against an expansion by the order at which the difference falls.

If sigma(k) = truncated series + C k^p + ..., the difference has slope p in log-log axes. Finding p proves all
coefficients of the truncated series at once: one that is 1 % wrong leaves a slope of its own, lower power.

>>> import numpy as np
>>> k = np.geomspace(1e-3, 1e-1, 9)
>>> comparison = assert_order(np.sin, lambda k: k - k**3 / 6, k, expected=5)
>>> round(comparison.observed, 2)
5.0
"""

from dataclasses import dataclass

import numpy as np

TOLERANCE = 0.05
FEWEST = 4
NOISE = 3.0  # a difference counts only if it exceeds this many times the error of the numerics
BEND = 0.01  # relative departure of the difference from a pure power that is not blamed on the numerics


class OrderMismatch(AssertionError):
    """The difference falls at another order than expected."""


class TooFewPoints(ValueError):
    """Not enough points where the difference exceeds the error of the numerics."""


@dataclass(frozen=True, eq=False)
class Comparison:
    """Numerics against a series: arrays of shape (points,), in increasing k.

    slope      local slope of log |difference| between neighbours (points - 1 values)
    observed   slope as k -> 0, from all points together
    """

    k: np.ndarray
    numeric: np.ndarray
    series: np.ndarray
    slope: np.ndarray
    observed: float
    expected: float
    tolerance: float

    @property
    def difference(self) -> np.ndarray:
        return np.abs(self.numeric - self.series)

    @property
    def agrees(self) -> bool:
        return abs(self.observed - self.expected) <= self.tolerance

    @property
    def verdict(self) -> str:
        relation = "agrees with" if self.agrees else "differs from"
        return (f"observed order {self.observed:.4f} {relation} the expected {self.expected:.4f} "
                f"(tolerance {self.tolerance:g}, {len(self.k)} points, k = {self.k[0]:g} .. {self.k[-1]:g})")

    def table(self) -> str:
        """k, numerics, series, difference and local slope, one point a line."""
        lines = [f"{'k':>12}  {'numeric':>40}  {'series':>40}  {'error':>10}  {'slope':>7}"]
        slopes = ["", *(f"{slope:.3f}" for slope in self.slope)]
        for k, numeric, series, error, slope in zip(self.k, self.numeric, self.series, self.difference, slopes,
                                                    strict=True):
            lines.append(f"{k:12.6g}  {_complex(numeric):>40}  {_complex(series):>40}  {error:10.3e}  {slope:>7}")
        return "\n".join(lines)


def compare(numeric, series, k, expected: float, *, correction: float | None = None, error=None,
            tolerance: float = TOLERANCE) -> Comparison:
    """Compare numerics with a series over wavenumbers (or values of another gauge) k of shape (points,).

    numeric, series   functions of an array k, or arrays of the shape of k; complex or real
    expected          power of the first term that the series leaves out
    correction        relative power of the term after that: fits the slope as p + (slope's drift) k^correction
    error             error of the numerics, same shape: points whose difference does not stand out from it
                      are left out, the others weighted by it
    Raises TooFewPoints if fewer than four points remain.
    """
    k = np.asarray(k, dtype=float)
    numeric, series = (np.asarray(values(k) if callable(values) else values, dtype=complex)
                       for values in (numeric, series))
    floor = np.broadcast_to(0.0 if error is None else np.asarray(error, dtype=float), k.shape)
    rising = np.argsort(k)
    k, numeric, series, floor = k[rising], numeric[rising], series[rising], floor[rising]
    heard = np.abs(numeric - series) > NOISE * floor
    if heard.sum() < FEWEST:
        raise TooFewPoints(f"the difference between numerics and series exceeds {NOISE:g} times the numerics' error at "
                           f"{heard.sum()} of {len(k)} points, {FEWEST} are needed: take larger k")
    k, numeric, series, floor = k[heard], numeric[heard], series[heard], floor[heard]
    difference = np.abs(numeric - series)
    slope = np.diff(np.log(difference)) / np.diff(np.log(k))
    order = _order(k, difference, floor, correction)
    return Comparison(k, numeric, series, slope, order, float(expected), tolerance)


def assert_order(numeric, series, k, expected: float | None = None, **options) -> Comparison:
    """Return the comparison, or raise OrderMismatch with its table. Options as for `compare`.

    `series` may be an `Expansion` whose parameters all have values: it knows the power to expect.
    """
    if hasattr(series, "next_power"):
        expected = float(series.next_power) if expected is None else expected
        series = series.function()
    if expected is None:
        raise TypeError("expected must be given unless the series is an Expansion")
    comparison = compare(numeric, series, k, expected, **options)
    if not comparison.agrees:
        raise OrderMismatch(f"{comparison.verdict}\n{comparison.table()}")
    return comparison


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
