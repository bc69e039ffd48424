"""The solver of one flow: refines a mode at the degree it needs, with error bars."""

from collections.abc import Callable
from functools import cached_property, lru_cache
from itertools import pairwise
from math import ceil, log
from typing import TYPE_CHECKING, Any

import numpy as np

from ..equations.pencil import Layout, Pencil, Weights, weights_of
from ..equations.system import System
from ..equations.table import Table
from ..flows.base import check_flow
from ..flows.sources import shipped
from ..numerics.refine import VECTOR, refine, refine_many
from ..status import RESOLVED, unresolved
from .accuracy import TOLERANCE, USUAL
from .cutoff import neglected
from .mode import Mode
from .response import data_error, spread_of

if TYPE_CHECKING:
    from ..equations.table import Table
    from ..flows.base import Flow
    from ..numerics.refine import Eigen
    from .accuracy import Accuracy

_FAR_BELOW = 1e-15  # relative truncation error that is aimed at with the default tolerance
_OVERSOLVED = 1e-7  # truncation over rounding below which one rung less of the degree suffices as well
_VECTOR, _ROUGHEST = 0.01, 1e-6  # error of vectors without bars, in units of the tolerance; the largest
_SCATTER = 40.0  # error of a slope from vectors right to rounding, in units of error times 1 or 1/k (measured)
_LEAP = 1e-3  # error of vectors after a leap, over the usual one: there was no step before it to bring them near
_HARDLY = 0.25  # of the way to the next degree: below a need by more it suffices in one case of ten (measured)
_BLIND = 12  # degree to try first where nothing is known
_LEAST = 24  # degree of the smallest table of entries
_DECADES = 3.0  # that coefficients span at most where only structure counts: eigenvalues stand out from rounding
_SMALL, _LARGE = 1024, 4096  # degree times terms of the longest series up to which layouts, some megabytes each, ...
_KEPT = (48, 8), (12, 3)  # ... are kept for other flows, and how many with how many tables: of small and of large ones
_TOGETHER = 128, 600_000  # points refined at once, and the numbers in their matrices: what fits into a cache
_EPS, _TINY = np.finfo(float).eps, np.finfo(float).tiny
_REMEMBERED = 10_000  # wavenumbers whose functions and weights are kept
_ROUNDING = 4.0  # standard deviations of the accumulated rounding that the error bar spans


class Assembly:
    """The pencils of a system of equations, each degree assembled when first asked for.

    Where their entries lie is kept for all flows with the same structure. The `twin` is that of another symmetry class,
    if one is known.
    """

    def __init__(self, flow: "Flow", twin: "Assembly | None" = None) -> None:
        self._flow, self._twin = flow, twin
        self._values, self._pencils = {}, {}

    @cached_property
    def system(self) -> System:
        return System(self._flow, self._twin.system if self._twin else None)

    def pencil(self, degree: int) -> Pencil:
        if degree not in self._pencils:
            layout = self._layout(degree)
            if layout.table not in self._values:
                self._values[layout.table] = layout.table.values(self.system.coefficients)
            self._pencils[degree] = Pencil(layout, self._values[layout.table], self.system)
        return self._pencils[degree]

    def generic(self, degree: int) -> Pencil:
        """The pencil of this degree with coefficients brought to similar sizes: of it holds what depends on the
        structure alone, which enormous ratios of numbers would hide."""
        coefficients, layout = self.system.coefficients, self._layout(degree)
        sizes = np.where(coefficients, np.abs(coefficients), np.abs(coefficients).max())
        decades = np.log10(sizes.max() / sizes.min())
        values = layout.table.values(coefficients * sizes ** (min(1.0, _DECADES / max(decades, _DECADES)) - 1))
        return Pencil(layout, values, self.system)

    @property
    def small(self) -> bool:
        """Whether its matrices are not too large to be kept."""
        return all(table.degree * table.structure.longest <= _LARGE for table in self._values)

    @property
    def entries(self) -> int:
        """Entries of its matrices if they were full: what they take in memory goes with that."""
        return sum(pencil.size**2 for pencil in self._pencils.values())

    def _layout(self, degree: int) -> Layout:
        structure, size = self.system.structure, max(_LEAST, 1 << int(degree - 1).bit_length())
        if size * structure.longest <= _LARGE:
            return _LAYOUTS[size * structure.longest > _SMALL](structure, degree, size)
        large = (table for table in self._values if table.degree == size)
        return Layout(next(large, None) or Table(structure.plain, size), degree, structure)

    def serving(self, flow: "Flow") -> "Assembly":
        """Return this assembly if its equations are those of `flow` too, else a new one.

        Parameters that enter only through functions of k leave the matrices alone.
        """
        other = Assembly(flow)
        return self if other.system == self.system else other


def _layouts(layouts: int, tables: int) -> Callable[..., Layout]:
    """A function of structure, degree and size of the table that keeps so many layouts and tables."""
    table_of = lru_cache(maxsize=tables)(Table)
    return lru_cache(maxsize=layouts)(
        lambda structure, degree, size: Layout(table_of(structure.plain, size), degree, structure))


_LAYOUTS = tuple(_layouts(*kept) for kept in _KEPT)


class Solver:
    """Refines modes of one flow to a relative tolerance, within a largest degree.

    The degree is raised until the truncation error is half the tolerance asked for, or below rounding; with the
    default tolerance and smaller ones until it is far below, since that costs little. Without `bars` errors are
    truncation alone.
    """

    def __init__(self, flow: "Flow", accuracy: "Accuracy" = USUAL, assembly: "Assembly | None" = None,
                 bars: bool = True) -> None:
        self.flow = check_flow(flow)
        self.bars = bars
        self.accuracy, self.tolerance = accuracy, (tolerance := accuracy.tolerance)
        self.truncation = 0.5 * tolerance if tolerance > TOLERANCE else min(0.5 * tolerance, _FAR_BELOW)
        self.vectors = VECTOR if bars else max(VECTOR, min(_VECTOR * tolerance, _ROUGHEST))
        self.degrees = accuracy.degrees
        self.assembly = assembly or Assembly(flow)
        self.pencil = self.assembly.pencil
        self._known = {}
        self.foresight = None

    @property
    def halves(self) -> tuple[Any, ...]:
        """Solvers of the symmetry classes of the flow: this one alone where it has none."""
        return self._halves or (self,)  # not kept: a solver that refers to itself would outlive its use

    @cached_property
    def _halves(self) -> tuple[Any, ...]:
        parts = self.flow.halves()
        if parts == (self.flow,):
            return ()
        first = Assembly(parts[0])
        twin = first if shipped(type(self.flow)) else None  # of others it is not known that their layers are the same
        return tuple(Solver(part, self.accuracy, Assembly(part, twin) if part is not parts[0] else first, self.bars)
                     for part in parts)

    def prepare(self, k: np.ndarray) -> None:
        """Evaluate the flow's functions of k, and the weights, for a whole array (count,) at once."""
        k = k[[one not in self._known for one in k.tolist()]]
        if not len(k):
            return
        symbols = {"k": (k, np.ones_like(k), np.zeros_like(k)), **self.flow.evaluate(k)}
        weights = weights_of(self.assembly.system.structure, symbols)
        if len(self._known) > _REMEMBERED:
            self._known.clear()
        rows = weights.value.T.copy(), weights.slope.T.copy(), weights.spread.T.copy()
        for index, one in enumerate(k.tolist()):
            self._known[one] = [symbols, rows, index, None]

    def _at(self, k: float) -> list[Any]:
        k = float(k)
        if k not in self._known:
            self.prepare(np.array([k]))
        return self._known[k]

    def symbols(self, k: float) -> dict[str, tuple[Any, ...]]:
        """Return {name: (value, slope, error)} of the symbols at one wavenumber."""
        symbols, _, index, _ = self._at(k)
        return {name: tuple(values[index] for values in triple) for name, triple in symbols.items()}

    def weights(self, k: Any) -> Weights:
        """Return the weights of the pencils at one wavenumber, (parts,), or at a list of them, (parts, points)."""
        if isinstance(k, list):
            each = [self._at(one) for one in k]
            return Weights(*(np.array([rows[part][index] for _, rows, index, _ in each]).T for part in range(3)))
        known = self._at(k)
        if known[-1] is None:
            _, rows, index, _ = known
            known[-1] = Weights(*(array[index] for array in rows))
        return known[-1]

    def width(self, k: float) -> float:
        """sigma / rate at wavenumber k."""
        return k ** (1 + self.flow.order)

    def rough(self, tolerance: float) -> "Solver":
        """Return a solver of the same equations, no more accurate than this and without bars."""
        rough = Solver(self.flow, self.accuracy.rougher(tolerance), self.assembly, bars=False)
        rough._known = self._known
        return rough

    def solve(self, k: Any, rate: Any, vectors: Any = None, degree: Any = None, glance: Any = False) -> Any:
        """Return the mode next to `rate`, at the first degree that resolves it; at the first one tried for a `glance`.

        `vectors` is (degree, x, y) of a nearby mode, if known. Raises ModeLost where the iteration
        does not settle; a mode still unresolved at the largest degree is returned with that status.
        """
        degree = degree or (vectors[0] if vectors else self.rung_degree(_BLIND))
        while True:
            pencil = self.pencil(degree)
            x, y = transfer(self, vectors, degree) if vectors else (None, None)
            eigen = refine(pencil, self.weights(k), rate, x, y, self.bars,
                           self._accuracy(vectors[0] if vectors else degree, degree))
            mode = self._mode(k, degree, eigen)
            if glance or degree == self.degrees[-1] or self.fits(mode):
                return mode
            rate, vectors, degree = eigen.rate, (degree, eigen.x, eigen.y), self.likely_degree(mode)

    def foreseen(self, k: float, rate: complex, part: float) -> "Mode | None":
        """The mode that is foreseen at k, if it is resolved and its rate is this one to a small part of it."""
        likely = self.foresight and self.foresight.at(k, rate, part)
        return likely if likely and self.fits(likely) else None

    def refined(self, mode: Mode) -> Mode:
        """Return a mode of a rougher solver as this one has it."""
        return self.solve(mode.k, mode.rate, (mode.degree, mode.x, mode.y), self.likely_degree(mode))

    def rung_degree(self, least: int) -> int:
        """The first degree at which a field has as many coefficients as at degree `least` where all of them count."""
        least *= self.assembly.system.structure.stride
        return next((degree for degree in self.degrees if degree >= least), self.degrees[-1])

    def expected_degree(self, k: float) -> int:
        """The largest degree that the flow says its series are likely to need at k, or the smallest of all."""
        likely = self.assembly.system.likely_degree(k)
        return max((degree for degree in self.degrees if degree <= likely), default=self.degrees[0])

    def likely_degree(self, mode: Mode) -> int:
        """The degree to try first where this solver, or a rougher one, has found a mode: a higher one if its own is too
        low, the first that is hardly below where its error is small enough if its series fall on as they do."""
        if self.fits(mode):
            return mode.degree
        degrees, needed = self.degrees, self.needed(mode)
        higher = min(degrees.index(mode.degree) + 1, len(degrees) - 1)
        return next((one for one, above in pairwise(degrees[higher:]) if needed < one + _HARDLY * (above - one)),
                    degrees[-1])

    def needed(self, mode: Mode, rounding: float = 0.0) -> float:
        """The degree, between rungs, at which the error of a mode is just small enough if its series fall on as they
        do; `rounding` is what is known of that, relative to sigma: rougher solvers do not tell."""
        excess = log(max(mode.truncation, _TINY) /
                     max(mode.rounding, max(self.truncation, rounding) * abs(mode.sigma), _TINY))
        layout = self.pencil(mode.degree).layout
        shares = np.abs(mode.x[layout.ends]).sum(axis=2) * np.abs(mode.y[layout.last]).max(axis=1)  # of the truncation
        sizes = np.log(shares.sum(axis=1))
        fall, faster = sizes[1] - sizes[2], max(2 * sizes[1] - sizes[0] - sizes[2], 0.0) / 2  # half: falls are uneven
        if fall <= 0:
            return mode.degree + float(excess > 0)
        fall += faster / 2  # from here on by fall + faster, fall + 2 faster ...
        steps = 2 * excess / (fall + max(fall**2 + 2 * faster * excess, 0.0) ** 0.5)
        return min(2.0 * mode.degree, mode.degree + layout.structure.stride * layout.ends.shape[2] * steps)

    def _accuracy(self, known: int, degree: int) -> float:
        """Of vectors, where coefficients up to the degree `known` are the guess."""
        return self.vectors * (_LEAP if self.degrees.index(degree) > self.degrees.index(known) + 1 else 1.0)

    def solve_many(self, wavenumbers: list[float], rates: np.ndarray | None, vectors: list[np.ndarray],
                   degree: int, known: int | None = None) -> list[Any]:
        """Return the modes at many wavenumbers at once, at this degree, None where the iteration does not settle.

        `rates` (points,) and right and left `vectors` (points, size) of this degree are good guesses. Without rates
        the quotients of the vectors are. Coefficients beyond the degree `known` are none, if that is given.
        """
        modes, (x, y), pencil = [], vectors, self.pencil(degree)
        entries = (pencil.iterated(len(wavenumbers)) or pencil).entries
        batches = ceil(len(wavenumbers) / max(1, min(_TOGETHER[0], _TOGETHER[1] // entries)))
        count = ceil(len(wavenumbers) / batches)
        for first in range(0, len(wavenumbers), count):
            part = slice(first, first + count)
            eigen = refine_many(pencil, self.weights(wavenumbers[part]),
                                None if rates is None else rates[part],
                                x[part], y[part], self.bars, self._accuracy(known or degree, degree))
            found = [self._mode(k, degree, one) for k, one in zip(wavenumbers[part], eigen.split(), strict=True)]
            modes += [mode if settled else None for mode, settled in zip(found, eigen.settled, strict=True)]
        return modes

    def fits(self, mode: Mode) -> bool:
        """Whether the truncation error is as small as is aimed at, or below rounding."""
        return mode.truncation <= max(mode.rounding, self.truncation * abs(mode.sigma))

    def resolves(self, mode: Mode) -> bool:
        """Whether the truncation error is within the tolerance, or could be at a larger degree."""
        return mode.degree < self.degrees[-1] or mode.truncation <= self.tolerance * abs(mode.sigma)

    def overlap(self, old: Mode, mode: Mode) -> complex:
        """Product of the two biorthogonal overlaps of a new mode with an old one: near 1 for one mode, 0 for two."""
        x, y = transfer(self, (old.degree, old.x, old.y), mode.degree)
        b, _ = self.pencil(mode.degree).b_products(self.weights(mode.k).value)
        return np.vdot(y, b(mode.x)) * np.vdot(mode.y, b(x))

    def next_degree(self, mode: Mode) -> int:
        """The degree to try first near this mode: one rung lower where it is over-resolved."""
        rung = self.degrees.index(mode.degree)
        return self.degrees[rung - 1] if rung and mode.truncation < _OVERSOLVED * mode.rounding else mode.degree

    def _mode(self, k: float, degree: int, eigen: "Eigen") -> Mode:
        width = self.width(k)
        sigma = width * eigen.rate
        rounding = width * _ROUNDING * eigen.rounding + width * eigen.spread + _EPS * abs(sigma)
        lacking = 0.0  # at cuts: no degree mends that
        if self.bars and self.flow.unbounded:
            lacking = neglected(self, k, degree, eigen)
        if self.bars and self.flow.chopped:

            rounding += spread_of(self, k, degree, eigen, self.flow.chopped)
        truncation = width * eigen.truncation
        error = truncation + rounding + lacking
        status = RESOLVED
        if not error <= self.tolerance * abs(sigma):  # nor where it is not a number
            status = unresolved(f"error {error:.1e} exceeds tolerance at degree {degree}")
        slope = width * eigen.slope + (1 + self.flow.order) * sigma / k
        scatter = width * eigen.left + min(width * eigen.scatter, _SCATTER * error * max(1.0, 1 / k))
        return Mode(self.flow, float(k), complex(sigma), float(error), complex(slope), degree, status,
                    float(truncation), float(rounding), eigen.rate, eigen.slope, eigen.x, eigen.y,
                    self._data_error(k, degree, eigen), float(scatter))

    def _data_error(self, k: float, degree: int, eigen: "Eigen") -> Any:
        """What the errors of a measured base flow do to the growth rate, None without such errors or without bars."""
        if not self.bars or self.flow.data is None:
            return None

        return data_error(self, k, degree, eigen)


def transfer(solver: "Solver", vectors: tuple[int, np.ndarray, np.ndarray], degree: int) -> tuple[np.ndarray, ...]:
    """Eigenvectors (degree, x, y) of one degree as vectors of another: series are padded or cut."""
    old, x, y = vectors
    if old == degree:
        return x, y
    target = solver.pencil(degree).layout
    return tuple(_fit(vector, *places, target.size) for vector, places in
                 zip((x, y), solver.pencil(old).layout.common(target), strict=True))


def _fit(vector: np.ndarray, source: np.ndarray, target: np.ndarray, size: int) -> np.ndarray:
    fitted = np.zeros(size, vector.dtype)
    fitted[target] = vector[source]
    return fitted
