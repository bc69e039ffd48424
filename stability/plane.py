"""The growth of one mode over the plane of wavenumber k and one parameter of a flow, and where to find it.

A `Point` is a mode with the gradient of its growth rate. Moving from point to point keeps to the mode: the
rate is predicted from the gradient, and old and new eigenvectors must be biorthogonal partners, as in
`stability.tracking`.
"""

from dataclasses import dataclass, replace
from math import exp, isinf, log
from typing import Any

import numpy as np

from .dense import dense_degrees, finite_rates
from .errors import ModeLost, ParameterError
from .listing import leading_modes
from .sensitivity import parameter_slope
from .solver import Solver

_NEAR = 0.6  # in log k
_DRIFT = 0.05  # of the growth between two degrees, relative to |sigma|, at which a look is good enough
_OVERLAP = 0.5
_HALVINGS = 12
_FIRST = 0.01  # value tried instead of 0
_LOOKS = 4  # over all wavenumbers, each at the degree that the fastest of the look before needs
_WORK = 1e10  # unknowns cubed, summed over the dense problems of all looks: of the order of five seconds
_LOW = 8  # rung of the degrees below which no look starts
_SETTLED = 1e-3  # growth / |sigma| nearer to zero than this, in a look, is computed properly


@dataclass(frozen=True)
class Point:
    """A mode at wavenumber k and parameter `value`: its growth rate and the gradient of it in (log k, value)."""

    k: float
    value: float
    mode: Any
    by_value: complex  # d sigma / d value

    @property
    def growth(self):
        return self.mode.growth_rate

    @property
    def gradient(self):
        return np.array([self.k * self.mode.slope.real, self.by_value.real])


class Plane:
    """Modes of `flow` at any wavenumber and any value of its parameter `vary`, to a relative `tolerance`."""

    def __init__(self, flow, vary, tolerance, max_degree):
        if isinf(getattr(flow, vary)):
            raise ParameterError(f"{flow.name}: {vary} = inf cannot be varied; start from a finite {vary}")
        self.flow, self.vary = flow, vary
        self.tolerance, self.max_degree = tolerance, max_degree
        long_waves = flow.has_surface_mode()
        self.power = 2 if long_waves else 0  # growth of a surface mode is of the order of k^power in long waves
        self.wavenumbers = np.geomspace(0.01, 20, 20) if long_waves else np.geomspace(0.1, 10, 11)
        self._first = _LOW  # rung of the degrees at which a look starts
        self._value = self._solver = None
        self._work = 0.0  # done so far

    def solver(self, value):
        """The solver at this value; the last one is kept."""
        if value != self._value:
            flow = replace(self.flow, **{self.vary: value})
            self._value, self._solver = value, Solver(flow, self.tolerance, self.max_degree)
        return self._solver

    def rough(self, tolerance):
        """The same plane, no more accurate than this."""
        return Plane(self.flow, self.vary, max(self.tolerance, tolerance), self.max_degree)

    def leading(self, k, value):
        """The least stable mode."""
        found = leading_modes(self.solver(value), k, 1)
        if not found:
            raise ModeLost(f"{self.solver(value).flow}: no mode settles at k = {k:g}")
        return self._point(k, value, found[0])

    def move(self, start, k, value):
        """The mode of `start` at another point; in several steps where one would not be safe."""
        at, reached, step = start, 0.0, 1.0
        for _ in range(4 * _HALVINGS):
            ahead = min(1.0, reached + step)
            point = self._step(at, start.k * (k / start.k) ** ahead if ahead < 1 else k,
                               start.value + (value - start.value) * ahead if ahead < 1 else value)
            if point is None:
                step /= 2
                if step < 0.5**_HALVINGS:
                    break
            elif ahead == 1:
                return point
            else:
                at, reached, step = point, ahead, 2 * step
        raise ModeLost(f"{start.mode.flow}: the mode is lost between k = {start.k:.6g} and {k:.6g}, "
                       f"{self.vary} = {start.value:.6g} and {value:.6g}")

    def _step(self, start, k, value):
        """The mode of `start` at a nearby point, or None where it is not safely the same."""
        solver, old = self.solver(value), start.mode
        change = old.slope * (k - start.k) + start.by_value * (value - start.value)
        vectors = (old.degree, old.x, old.y)
        degree = old.degree if old.degree in solver.degrees else solver.degrees[-1]
        try:
            mode = solver.solve(k, (old.sigma + change) / solver.width(k), vectors, degree)
        except ModeLost:
            return None
        return self._point(k, value, mode) if abs(solver.overlap(old, mode) - 1) < _OVERLAP else None

    def _point(self, k, value, mode):
        return Point(k, value, mode, complex(parameter_slope(self.solver(value), mode, self.vary)))

    def near_largest(self, value):
        """A point near the largest growth rate over k."""
        growth, rates = self._look(value)
        best = int(np.argmax(growth))
        self._check_end(value, growth)
        solver, k = self.solver(value), float(self.wavenumbers[best])
        degree = solver.degrees[min(8, len(solver.degrees) - 1)]
        return self._point(k, value, solver.solve(k, rates[best], None, degree))

    def most_unstable(self, value, beyond=None):
        """The point of largest growth / k^power among unstable ones, or None; near `beyond` does not count."""
        growth, rates = self._look(value)
        self._check_end(value, growth)
        unstable = []
        for k, size, rate in zip(self.wavenumbers.tolist(), growth, rates, strict=True):
            if size > -_SETTLED * abs(rate) * k and not (beyond and abs(log(k / beyond)) < _NEAR):
                point = self.leading(k, value)
                if point.growth > 2 * point.mode.error:
                    unstable.append(point)
        return max(unstable, key=lambda point: point.growth / point.k**self.power, default=None)

    def _look(self, value):
        """Leading growth and rate at all wavenumbers, at the first degree at which the largest growth settles."""
        solver = self.solver(value)
        degrees, rung = dense_degrees(solver, self._first), 0
        for _ in range(_LOOKS):
            rates = np.array([self._leading(solver, degrees[rung], k) for k in self.wavenumbers.tolist()])
            growth = solver.width(self.wavenumbers) * rates.real
            best = int(np.argmax(growth))
            settled = self._settled(solver, degrees[rung:], self.wavenumbers[best], rates[best])
            if settled == 0:
                self._first = max(_LOW, self._first + rung - 1)
                return growth, rates
            rung += settled
        raise ModeLost(f"{solver.flow}: the least stable modes do not settle up to degree {degrees[rung]}")

    def _settled(self, solver, degrees, k, rate):
        """Rung at which the leading rate at k no longer moves; it is `rate` at the first of the degrees."""
        for rung, finer in enumerate((*degrees[1:], degrees[-1])):
            before, rate = rate, self._leading(solver, finer, k)
            if abs(rate - before) < _DRIFT * abs(rate):
                return rung
        raise ModeLost(f"{solver.flow}: the least stable modes do not settle up to degree {degrees[-1]}")

    def _leading(self, solver, degree, k):
        """Rate of the least stable mode at one degree, as long as the looks have not taken too long."""
        self._work += solver.pencil(degree).size ** 3
        if self._work > _WORK:
            raise ModeLost(f"{solver.flow}: the search is given up: the least stable modes need too large a degree")
        return finite_rates(solver, degree, solver.symbols(k))[0]

    def _check_end(self, value, growth):
        if growth[-1] > 0 and growth[-1] == max(growth):
            raise ModeLost(f"{self.solver(value).flow}: growth is largest at k = {self.wavenumbers[-1]:g}, the end of "
                           "the search; the flow may be ill-posed")

    def bracket(self, value):
        """An unstable value within a factor 1.5 of a stable one, found by trying further and further from `value`."""
        value = value or _FIRST
        known = {}
        grows = self._try(value, known)
        for exponent in (0.2, 0.4, 0.8, 1.6, 3.2):
            others = (self._try(value * exp(side * exponent), known) for side in (-1, 1))
            if any(other is not None and other != grows for other in others):
                break
        stable, unstable = _nearest_pair(known) or self._none(known)
        while max(stable / unstable, unstable / stable) > 1.5:
            middle = (stable * unstable) ** 0.5
            stable, unstable = (stable, middle) if self._try(middle, known) else (middle, unstable)
        return unstable

    def _try(self, value, known):
        """Whether some wavenumber grows at this value; None where that cannot be found."""
        try:
            known[value] = max(self._look(value)[0])
        except (ParameterError, ModeLost):
            return None
        return known[value] > 0

    def _none(self, known):
        growth = list(known.values())
        kind = "no growth rate could be computed" if not growth else "stable" if max(growth) < 0 else "unstable"
        span = f" at every {self.vary} tried from {min(known):.4g} to {max(known):.4g}" if known else ""
        raise ModeLost(f"{self.flow}: {kind}{span}, k from {self.wavenumbers[0]:g} to {self.wavenumbers[-1]:g}; "
                       f"start from another {self.vary}")


def _nearest_pair(known):
    """The closest neighbours (stable value, unstable value), or None."""
    values = sorted(known)
    pairs = [(a, b) if known[a] < 0 else (b, a) for a, b in zip(values, values[1:], strict=False)
             if (known[a] < 0) != (known[b] < 0)]
    return min(pairs, key=lambda pair: abs(pair[0] - pair[1])) if pairs else None
