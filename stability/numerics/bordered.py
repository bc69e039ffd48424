"""LU factors of bordered band matrices, in time proportional to the size.

    [ band    right  ]   interior rows
    [ bottom  corner ]   border rows

The interior is factorised as a band (LAPACK gbtrf); the border follows by block elimination.
"""

from contextlib import suppress
from copy import copy
from functools import cached_property
from typing import Any

import numpy as np
from scipy.linalg import lapack
from scipy.sparse import csr_array

from .stack import with_data

_CHUNK = 1 << 15  # numbers that are brought from columns to rows at once
UNEVEN = 1e6  # largest entry of a sum above which its rows and columns are scaled

_FULL = {"f": (lapack.dgetrf, lapack.dgetri), "c": (lapack.zgetrf, lapack.zgetri)}
_BAND = {"f": (lapack.dgbtrf, lapack.dgbtrs), "c": (lapack.zgbtrf, lapack.zgbtrs)}


class Places:
    """Where the entries part, row, column (entries,) of `parts` sparse matrices lie in a bordered band matrix.

    The band is stored by columns as LAPACK's gbtrf wants it: entry (row, column) at [column, lower + upper + row -
    column], the first `lower` places being room for fill; behind it `right` and then `bottom` with the corner. Of these
    `count` places those `used` have an entry, at `row` and `column`.
    """

    def __init__(self, part: np.ndarray, row: np.ndarray, column: np.ndarray, parts: int, interior: int,
                 border: int) -> None:
        self.interior, self.border = interior, border
        inside, below = (row < interior) & (column < interior), row >= interior
        shape, place = self._inner(row, column, inside)
        self._shapes = shape, (interior, border), (border, interior + border)
        self._starts = np.cumsum([0, *(rows * columns for rows, columns in self._shapes)])
        self.count = int(self._starts[-1])
        place = np.where(inside, place, self._starts[1] + row * border + column - interior)
        place[below] = (self._starts[2] + (row - interior) * (interior + border) + column)[below]
        self._order = np.argsort(place, kind="stable").astype(np.int32)
        place = place[self._order]
        first = np.flatnonzero(np.diff(place, prepend=-1))
        self.used = place[first]
        self.row, self.column = (index[self._order][first].astype(np.int32) for index in (row, column))
        ends = np.searchsorted(place, np.arange(self._starts[-1] + 1))
        self._matrix = csr_array((np.zeros(len(place)), part[self._order], ends), (self._starts[-1], parts))

    def _inner(self, row: np.ndarray, column: np.ndarray, inside: np.ndarray) -> tuple[tuple[int, int], np.ndarray]:
        """The shape of the array of the interior, and where entries lie in it."""
        shift = (row - column)[inside]
        self.lower, self.upper = int(max(shift.max(initial=0), 0)), int(max(-shift.min(initial=0), 0))
        width = 2 * self.lower + self.upper + 1
        return (self.interior, width), column * width + self.lower + self.upper + row - column

    def factors(self, band: np.ndarray) -> Any:
        """LU factors of the interior."""
        return BandFactors(band, self.lower, self.upper)

    def matrix(self, value: np.ndarray) -> Any:
        """The sparse matrix (count, parts) of entries with these values (entries,)."""
        return with_data(self._matrix, value[self._order])

    def blocks(self, values: np.ndarray) -> tuple[np.ndarray, ...]:
        """Return band, right and bottom, of all the values (..., count)."""
        return tuple(values[..., start: stop].reshape(*values.shape[:-1], *shape) for start, stop, shape in
                     zip(self._starts[:-1], self._starts[1:], self._shapes, strict=True))


class BandFactors:
    """LU factors of a band as `Places` stores it, by columns; `failed` where a pivot vanishes."""

    def __init__(self, band: np.ndarray, lower: int, upper: int) -> None:
        factor, self._solve = _BAND[band.dtype.kind]
        self._lower, self._upper = lower, upper
        self._lu, self._pivots, self.failed = factor(band.T, lower, upper, overwrite_ab=True)

    def solve(self, right: np.ndarray, trans: int = 0) -> np.ndarray:
        """Return z with M z = right, or M^T z = right."""
        return self._solve(self._lu, self._lower, self._upper, right, self._pivots, trans=trans)[0]

    def coupled(self, right: np.ndarray) -> np.ndarray:
        """Return z with M z = right, the border beside the interior."""
        return self.solve(right)

    def phase(self) -> Any:
        """Return the determinant over its modulus."""
        return phase(self._lu[self._lower + self._upper], self._pivots)


class Bordered:
    """Sums of sparse matrices times scalars; entries lie at `places` and have the values `value` (entries,)."""

    def __init__(self, places: "Places", value: np.ndarray) -> None:
        self.places, self._matrix = places, places.matrix(value)

    def sum(self, weights: np.ndarray) -> tuple[Any, ...]:
        """Return the blocks of the sum of the parts times weights (parts,), and the scales of its rows and columns.

        Where entries are very large, the sum is scaled by powers of two that bring the largest entry of each row and
        column near 1: an unknown that is tiny beside the others would else be found with few digits of its own.
        Elsewhere the scales are None.
        """
        values, scales = self._matrix @ weights, None
        if np.abs(values.view(float)).max(initial=0) > UNEVEN:
            used = self.places.used
            scales = self._scales(np.abs(values[used]))
            values[used] *= scales[0][self.places.row] * scales[1][self.places.column]
        return self.places.blocks(values), scales

    def sums(self, weights: Any) -> Any:
        """Return the blocks of the sums at many points, weights (parts, points), unscaled, and which are uneven."""
        values = np.empty(weights.shape[1:] + self._matrix.shape[:1], np.result_type(self._matrix.dtype, weights))
        few = max(1, _CHUNK // len(values.T))
        for first in range(0, len(values), few):
            values[first: first + few] = (self._matrix @ weights[:, first: first + few]).T
        return self.places.blocks(values), _uneven(values, self._largest @ np.abs(weights))

    def along(self, weights: Any, rates: Any) -> Any:
        """The `sums` for weights[:, 0] + rate weights[:, 1] at many rates."""
        start, slope = (self._matrix @ weights).T
        values = np.multiply.outer(rates, slope)
        values += start
        return self.places.blocks(values), _uneven(values, np.abs(start).max() + np.abs(rates) * np.abs(slope).max())

    @cached_property
    def _largest(self) -> np.ndarray:
        """The largest modulus in each part (parts,)."""
        largest = np.zeros(self._matrix.shape[1])
        np.maximum.at(largest, self._matrix.indices, np.abs(self._matrix.data))
        return largest

    def _scales(self, size: np.ndarray) -> np.ndarray:
        """Powers of two for rows and columns, (2, size), by the sizes of the entries."""
        places = self.places
        scales = np.ones((2, places.interior + places.border))
        for axis, index in 2 * ((1, places.column), (0, places.row)):
            largest = np.zeros(scales.shape[1])
            np.maximum.at(largest, index, size)
            factor = np.exp2(-np.round(np.log2(np.where(largest > 0, largest, 1.0))))
            scales[axis] *= factor
            size = size * factor[index]
        return scales


def _uneven(values: np.ndarray, bounds: np.ndarray) -> np.ndarray:
    """Whether values (points, count) are very large; where `bounds` (points,) of them are not, they need no look."""
    uneven = bounds > UNEVEN
    uneven[uneven] = np.abs(values[uneven].view(float)).max(axis=1) > UNEVEN
    return uneven


def _inverse(matrix: np.ndarray) -> np.ndarray:
    """Of one small matrix, without what numpy's costs beside its work."""
    factor, invert = _FULL[matrix.dtype.kind]
    lu, pivots, info = factor(matrix)
    if not info:
        inverse, info = invert(lu, pivots)
    if info:
        raise np.linalg.LinAlgError("singular border")
    return inverse


class Factors:
    """LU factors of the sum of the parts of a `Bordered` times weights (parts,); `uneven` where it had to be scaled.

    Raises numpy's LinAlgError where a pivot vanishes.
    """

    def __init__(self, bordered: "Bordered", weights: np.ndarray) -> None:
        (band, right, bottom), self._scales = bordered.sum(weights)
        self.uneven = self._scales is not None
        self._interior, self._inner = bordered.places.interior, bordered.places.factors(band)
        if self._inner.failed:
            raise np.linalg.LinAlgError("singular interior")
        self._bottom = bottom[:, : self._interior]
        self._coupled = self._inner.coupled(right)
        self._schur = bottom[:, self._interior:] - self._bottom @ self._coupled
        self._border = _inverse(self._schur) if len(self._schur) else self._schur

    def phase(self) -> Any:
        """Return the determinant over its modulus (scales are positive: they leave it alone)."""
        return self._inner.phase() * np.linalg.slogdet(self._schur)[0]

    def solve(self, f: Any) -> Any:
        """Return z with M z = f, (size, points) or (size,)."""
        if self.uneven:
            rows, columns = (scale.reshape(-1, *[1] * (f.ndim - 1)) for scale in self._scales)
            return columns * self._solved(rows * f)
        return self._solved(f)

    def _solved(self, f: np.ndarray) -> np.ndarray:
        inner = self._inner.solve(f[: self._interior])
        border = self._border @ (f[self._interior:] - self._bottom @ inner)
        return np.concatenate([inner - self._coupled @ border, border])

    def solve_left(self, g: np.ndarray) -> np.ndarray:
        """Return z with z^T M = g^T (no conjugation), (size, points) or (size,)."""
        if self.uneven:
            rows, columns = (scale.reshape(-1, *[1] * (g.ndim - 1)) for scale in self._scales)
            return rows * self._solved_left(columns * g)
        return self._solved_left(g)

    def _solved_left(self, g: Any) -> Any:
        inner, border = g[: self._interior], g[self._interior:]
        border = self._border.T @ (border - self._coupled.T @ inner)
        return np.concatenate([self._inner.solve(inner - self._bottom.T @ border, trans=1), border])


def phase(diagonal: Any, pivots: Any) -> Any:
    """The determinant over its modulus of a matrix with this diagonal of U."""
    swaps = np.count_nonzero(pivots != np.arange(len(pivots)))
    phases = np.prod(diagonal / np.abs(diagonal))
    return (-1) ** swaps * phases / abs(phases)


class ManyFactors:
    """The `Factors` at many points, weights (parts, points); right-hand sides are the columns of arrays (size, points).

    Weights (parts, 2) and many rates give those for weights[:, 0] + rate weights[:, 1]. `uneven` tells which points
    need scales, and have none here. What is singular gives numbers that are not finite.
    """

    def __init__(self, bordered: "Bordered", weights: np.ndarray, rates: np.ndarray | None = None) -> None:
        (band, right, bottom), self.uneven = bordered.sums(weights) if rates is None else bordered.along(weights, rates)
        places = bordered.places
        self._interior, self._inner = places.interior, [places.factors(one) for one in band]
        self._bottom = bottom[..., : self._interior]
        self._coupled = np.array([inner.coupled(one) for inner, one in zip(self._inner, right, strict=True)])
        self._schur = bottom[..., self._interior:] - self._bottom @ self._coupled

    def at(self, which: np.ndarray) -> "ManyFactors":
        """Return those of some of the points, a mask (points,)."""
        some = copy(self)
        some.uneven, some._inner = self.uneven[which], [self._inner[one] for one in np.flatnonzero(which)]
        some._bottom, some._coupled = self._bottom[which], self._coupled[which]
        some._schur, some._border = self._schur[which], self._border[which]
        return some

    def phases(self) -> np.ndarray:
        """Return the determinants over their moduli (points,)."""
        return np.array([inner.phase() for inner in self._inner]) * np.linalg.slogdet(self._schur)[0]

    @cached_property
    def _border(self) -> np.ndarray:
        with suppress(np.linalg.LinAlgError):
            return np.linalg.inv(self._schur)
        inverse = np.full_like(self._schur, np.nan)
        for one, schur in zip(inverse, self._schur, strict=True):
            with suppress(np.linalg.LinAlgError):
                one[:] = _inverse(schur)
        return inverse

    def solve(self, f: Any) -> Any:
        """Return z with M z = f at every point."""
        inner = self._solved(f[: self._interior].T)
        if not self._bottom.shape[1]:
            return inner.T
        border = self._border @ (f[self._interior:].T[..., None] - self._bottom @ inner[..., None])
        return np.concatenate([inner - (self._coupled @ border)[..., 0], border[..., 0]], axis=1).T

    def solve_left(self, g: np.ndarray) -> np.ndarray:
        """Return z with z^T M = g^T (no conjugation) at every point."""
        if not self._bottom.shape[1]:
            return self._solved(g.T, trans=1).T
        inner, border = g.T[:, None, : self._interior], g.T[:, None, self._interior:]
        border = (border - inner @ self._coupled) @ self._border
        inner = self._solved((inner - border @ self._bottom)[:, 0], trans=1)
        return np.concatenate([inner, border[:, 0]], axis=1).T

    def _solved(self, right: np.ndarray, trans: int = 0) -> np.ndarray:
        right = np.ascontiguousarray(right)  # once for all: LAPACK wants vectors so
        return np.array([inner.solve(one, trans) for inner, one in zip(self._inner, right, strict=True)])
