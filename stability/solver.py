"""The solver of one flow: refines a mode at the degree it needs, with error bars."""

from functools import cached_property
from itertools import pairwise

import numpy as np

from .checks import check_integer, check_tolerance
from .cutoff import neglected
from .mode import Mode
from .pencil import Pencil
from .refine import refine, refine_many
from .status import RESOLVED
from .system import System
from .table import Table

DEGREES = (8, 10, 12, 14, 16, 20, 24, 28, 32, 40, 48, 56, 64, 80, 96, 128, 160, 192, 256, 320,
           384, 512)
TOLERANCE = 1e-10  # default bound on error / |sigma| for a resolved mode

_FAR_BELOW = 1e-15  # relative truncation error that is aimed at with the default tolerance
_LEAST = 32  # degree of the smallest table of entries
_TOGETHER = 16  # groups refined at once: their vectors stay in the cache
_EPS = np.finfo(float).eps
_ROUNDING = 4.0  # standard deviations of the accumulated rounding that the error bar spans


class Assembly:
    """The pencils of a system of equations, each degree assembled when first asked for."""

    def __init__(self, flow):
        self._flow = flow
        self._table = None
        self._pencils = {}

    @cached_property
    def system(self):
        return System(self._flow)

    def pencil(self, degree):
        if degree not in self._pencils:
            if self._table is None or degree > self._table.degree:
                self._table = Table(self.system, max(_LEAST, 1 << int(degree - 1).bit_length()))
            self._pencils[degree] = Pencil(self._table, degree)
        return self._pencils[degree]

    def serving(self, flow):
        """Return this assembly if its equations are those of `flow` too, else a new one.

        Parameters that enter only through functions of k leave the matrices alone.
        """
        other = Assembly(flow)
        return self if other.system == self.system else other


class Solver:
    """Refines modes of one flow to a relative tolerance, within a largest degree.

    The degree is raised until the truncation error is half the tolerance asked for, or below rounding; with the
    default tolerance and smaller ones until it is far below, since that costs little. Without `bars` errors are
    truncation alone.
    """

    def __init__(self, flow, tolerance=TOLERANCE, max_degree=DEGREES[-1], assembly=None, bars=True):
        self.flow = flow
        self.bars = bars
        self.tolerance = tolerance
        self.truncation = 0.5 * tolerance if tolerance > TOLERANCE else min(0.5 * tolerance, _FAR_BELOW)
        self.degrees = tuple(d for d in DEGREES if d <= max_degree) or (max_degree,)
        self.assembly = assembly or Assembly(flow)
        self.pencil = self.assembly.pencil
        self._functions = {}

    @cached_property
    def halves(self):
        """Solvers of the symmetry classes of the flow: this one alone where it has none."""
        return tuple(self if half == self.flow else Solver(half, self.tolerance, self.degrees[-1], bars=self.bars)
                     for half in self.flow.halves())

    def prepare(self, k):
        """Evaluate the flow's functions of k for a whole array (count,) at once."""
        k = k[[one not in self._functions for one in k.tolist()]]
        if not len(k):
            return
        values = np.array(list(self.flow.evaluate(k).values())).T  # (count, value slope error, functions)
        self._functions.update(zip(k.tolist(), values if len(values) else [values] * len(k), strict=True))

    def _at(self, k):
        """Value, slope and error of the functions at one wavenumber, (3, functions)."""
        if k not in self._functions:
            self.prepare(np.array([k], dtype=float))
        return self._functions[k]

    def symbols(self, k):
        """Return {name: (value, slope, error)} of the symbols at one wavenumber."""
        return {"k": (k, 1.0, 0.0), **dict(zip(self.flow.functions, self._at(float(k)).T, strict=True))}

    def weights(self, wavenumbers, degree):
        """Return the weights (parts, points) of the pencil of a degree at several wavenumbers."""
        k, functions = np.array(wavenumbers), np.array([self._at(k) for k in wavenumbers]).T
        symbols = {"k": (k, np.ones_like(k), np.zeros_like(k)),
                   **dict(zip(self.flow.functions, functions, strict=True))}
        return self.pencil(degree).weights(symbols)

    def width(self, k):
        """sigma / rate at wavenumber k."""
        return k ** (1 + self.flow.order)

    def rough(self, tolerance):
        """Return a solver of the same equations, no more accurate than this and without bars."""
        return Solver(self.flow, max(self.tolerance, tolerance), self.degrees[-1], self.assembly, bars=False)

    def solve(self, k, rate, vectors=None, degree=None, glance=False):
        """Return the mode next to `rate`, at the first degree that resolves it; at the first one tried for a `glance`.

        `vectors` is (degree, x, y) of a nearby mode, if known. Raises ModeLost where the iteration
        does not settle; a mode still unresolved at the largest degree is returned with that status.
        """
        start = self.degrees.index(degree or (vectors[0] if vectors else self.degrees[min(2, len(self.degrees) - 1)]))
        for degree in self.degrees[start:]:
            pencil = self.pencil(degree)
            x, y = transfer(self, vectors, degree) if vectors else (None, None)
            eigen = refine(pencil, self.weights([k], degree), rate, x, y, self.bars)
            mode = self._mode(k, degree, eigen)
            if glance or self._fits(mode):
                break
            rate, vectors = eigen.rate, (degree, eigen.x, eigen.y)
        return mode

    def solve_many(self, groups, guesses, degree):
        """Return the modes at many wavenumbers at once, None where more work is needed.

        `groups` are lists of neighbouring wavenumbers, which share a factorisation; `guesses` hold for each good
        rates (points,) and right and left vectors (points, size) at this degree.
        """
        modes = []
        for first in range(0, len(groups), _TOGETHER):
            chunk = slice(first, first + _TOGETHER)
            wavenumbers = [k for group in groups[chunk] for k in group]
            ends = np.cumsum([0, *(len(group) for group in groups[chunk])]).tolist()
            eigen = refine_many(self.pencil(degree), self.weights(wavenumbers, degree),
                                *(np.concatenate(parts) for parts in zip(*guesses[chunk], strict=True)),
                                [slice(*pair) for pair in pairwise(ends)], self.bars)
            found = [self._mode(k, degree, one) for k, one in zip(wavenumbers, eigen.split(), strict=True)]
            modes += [mode if settled and self._fits(mode) else None
                      for mode, settled in zip(found, eigen.settled, strict=True)]
        return modes

    def _fits(self, mode):
        return mode.truncation <= max(mode.rounding, self.truncation * abs(mode.sigma))

    def resolves(self, mode):
        """Whether the truncation error is within the tolerance, or could be at a larger degree."""
        return mode.degree < self.degrees[-1] or mode.truncation <= self.tolerance * abs(mode.sigma)

    def overlap(self, old, mode):
        """Product of the two biorthogonal overlaps of a new mode with an old one: near 1 for one mode, 0 for two."""
        x, y = transfer(self, (old.degree, old.x, old.y), mode.degree)
        weights = self.weights([mode.k], mode.degree).value
        bx, b_old = self.pencil(mode.degree).b(weights, np.array([mode.x, x]).T).T
        return np.vdot(y, bx) * np.vdot(mode.y, b_old)

    def next_degree(self, mode):
        """The degree to try first near this mode: one rung lower where it is over-resolved."""
        rung = self.degrees.index(mode.degree)
        return self.degrees[rung - 1] if rung and mode.truncation < 1e-7 * mode.rounding else mode.degree

    def _mode(self, k, degree, eigen):
        width = self.width(k)
        sigma = width * eigen.rate
        rounding = width * _ROUNDING * eigen.rounding + width * eigen.spread + _EPS * abs(sigma)
        lacking = 0.0  # at cuts: no degree mends that
        if self.bars and self.flow.unbounded:
            lacking = neglected(self, k, degree, eigen)
        if self.bars and self.flow.cut:
            from .response import spread_of  # needs solvers itself

            rounding += spread_of(self, k, degree, eigen, self.flow.cut)
        truncation = width * eigen.truncation
        error = truncation + rounding + lacking
        status = RESOLVED
        if not error <= self.tolerance * abs(sigma):  # nor where it is not a number
            status = f"error {error:.1e} exceeds tolerance at degree {degree}"
        slope = width * eigen.slope + (1 + self.flow.order) * sigma / k
        return Mode(self.flow, float(k), complex(sigma), float(error), complex(slope), degree, status,
                    float(truncation), float(rounding), eigen.rate, eigen.slope, eigen.x, eigen.y,
                    self._data_error(k, degree, eigen))

    def _data_error(self, k, degree, eigen):
        """What the errors of a measured base flow do to the growth rate, None without such errors or without bars."""
        if not self.bars or self.flow.data is None:
            return None
        from .response import data_error  # needs solvers itself

        return data_error(self, k, degree, eigen)


def check_accuracy(tolerance, max_degree, names=("tolerance", "max_degree")):
    """Return both as numbers, or raise a ParameterError that uses these names."""
    return check_tolerance(tolerance, names[0]), check_integer(max_degree, names[1], DEGREES[0], DEGREES[-1])


def transfer(solver, vectors, degree):
    """Eigenvectors (degree, x, y) of one degree as vectors of another: series are padded or cut."""
    old, x, y = vectors
    if old == degree:
        return x, y
    source, target = solver.pencil(old), solver.pencil(degree)
    return _fit(x, source.columns, target.columns, target.size), _fit(y, source.rows, target.rows, target.size)


def _fit(vector, source, target, size):
    fitted = np.zeros(size, vector.dtype)
    for name, places in source.items():
        count = min(len(places), len(target[name]))
        fitted[target[name][:count]] = vector[places[:count]]
    return fitted
