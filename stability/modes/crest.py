"""Where the growth rate of one mode is largest between two wavenumbers, with an error bar.

Growth is largest where its analytic slope vanishes: secants lead there from two modes that bracket it.
"""

from dataclasses import dataclass
from itertools import combinations
from math import exp, log
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import ModeLost
from ..status import Status, is_resolved, unresolved
from .response import error_of_maximum
from .tracking import Walk

if TYPE_CHECKING:
    from .mode import Mode
    from .solver import Solver

_ITERATIONS = 40
_SETTLED, _PART = 1e-15, 0.5  # relative step in k; step in units of what noise makes of k
_NEAR = 1e-6  # relative way from a known mode within which vectors are refined twice
_APART = 1e-5  # relative distance of two k from which the slopes there give the curvature
_SCATTER = 4.0  # error of a slope in units of its change when the vectors are refined once more (measured)
_OVERLAP = 0.3  # largest deviation of the overlap of one step from 1
_K_TOLERANCE = 1e-8  # relative error of k_max that is accepted as resolved whatever the tolerance of sigma


@dataclass(frozen=True)
class Maximum:
    """A local maximum of the growth rate: `error` bounds the absolute error of k, `status` says whether it is small."""

    k: float
    error: float
    mode: Any
    status: Status
    data_error: float | None = None  # standard error of k from that of a measured base flow

    @property
    def growth_rate(self) -> float:
        return self.mode.growth_rate


def crest(solver: "Solver", left: "Mode", right: "Mode") -> "Maximum":
    """The `Maximum` between two modes that bracket it: secants of the analytic slope, kept inside the bracket.

    The curvature is that of the parabola through the last three slopes, as long as those are apart.
    """
    low, high, scatter = left, right, 0.0
    before, now = sorted((left, right), key=lambda end: -abs(end.slope.real))
    curvature, k = _bend(left, right), _hermite(left, right)
    for _ in range(_ITERATIONS):
        near = low if k - low.k < high.k - k else high
        (earlier, before), (now, again) = (before, now), _moved(solver, near, k, abs(k - near.k) < _NEAR * k)
        low, high = (now, high) if now.slope.real > 0 else (low, now)
        if min(abs(a.k - b.k) for a, b in combinations((now, before, earlier), 2)) > _APART * now.k:
            curvature = _bend(now, before) + _bend(now, earlier) - _bend(before, earlier)
        scatter = max(scatter, _SCATTER * abs(again - now.slope))
        step, noise = -now.slope.real / curvature, now.slope_error + scatter
        if again != now.slope and abs(step) < max(_SETTLED * now.k, _PART * noise / abs(curvature)):
            break
        k = now.k + step if low.k < now.k + step < high.k else (low.k + high.k) / 2
    error = float((abs(now.slope.real) + noise) / abs(curvature))
    status = now.status
    if is_resolved(status) and not error <= max(solver.tolerance, _K_TOLERANCE) * now.k:
        status = unresolved(f"error {error:.1e} of k_max exceeds tolerance")
    measured = error_of_maximum(solver, now) if now.growth_rate > 0 else None
    return Maximum(now.k, error, now, status, measured)


def _bend(one: "Mode", other: "Mode") -> float:
    """Mean curvature of growth between two modes."""
    return (other.slope.real - one.slope.real) / (other.k - one.k)


def middle_of(solver: "Solver", left: "Mode", right: "Mode") -> "tuple[Mode, float]":
    """A mode near the crest between two that bracket it, and the curvature of growth in log k there, roughly."""
    k = _hermite(left, right)
    a, b = (mode.k * mode.slope.real for mode in (left, right))
    return _moved(solver, left if k - left.k < right.k - k else right, k)[0], (b - a) / log(right.k / left.k)


def _moved(solver: "Solver", near: "Mode", k: float, twice: bool = False) -> "tuple[Mode, complex]":
    """The mode `near` at a wavenumber close by, and its slope; from the vectors before they were refined once more,
    where that is done `twice`: the difference shows how far rounding scatters slopes where another mode is near.
    """
    try:
        mode = solver.solve(k, near.rate + (k - near.k) * near.rate_slope, (near.degree, near.x, near.y),
                            solver.likely_degree(near))
        if not abs(solver.overlap(near, mode) - 1) < _OVERLAP:
            mode = Walk(solver, near).to(k)
    except ModeLost:
        mode = Walk(solver, near).to(k)
    return (solver.solve(k, mode.rate, (mode.degree, mode.x, mode.y)) if twice else mode), mode.slope


def _hermite(low: "Mode", high: "Mode") -> float:
    """Zero of the growth slope between two modes, from the cubic through values and slopes in log k."""
    a, b = low.k * low.slope.real, high.k * high.slope.real
    h = log(high.k / low.k)
    secant = (high.growth_rate - low.growth_rate) / h
    roots = np.roots((3 * (a + b - 2 * secant), 2 * (3 * secant - 2 * a - b), a))
    inside = [root.real for root in roots if abs(root.imag) < 1e-12 and 0 < root.real < 1]
    return low.k * exp(h * (inside[0] if len(inside) == 1 else a / (a - b)))
