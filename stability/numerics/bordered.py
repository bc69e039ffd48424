"""LU factors of bordered band matrices, in time proportional to the size.

    [ band    right  ]   interior rows
    [ bottom  corner ]   border rows

The interior is factorised as a band (LAPACK gbtrf); the border follows by block elimination.
"""

from contextlib import suppress
from functools import cached_property
from typing import Any

import numpy as np
from scipy.linalg import lapack
from scipy.sparse import csr_array

from .stack import with_data

UNEVEN = 1e6  # largest entry of a sum above which its rows and columns are scaled

_FULL = {"f": (lapack.dgetrf, lapack.dgetri), "c": (lapack.zgetrf, lapack.zgetri)}
_BAND = {"f": (lapack.dgbtrf, lapack.dgbtrs), "c": (lapack.zgbtrf, lapack.zgbtrs)}


class Places:
    """Where the entries part, row, column (entries,) of `parts` sparse matrices lie in a bordered band matrix.

    The band is stored by columns as LAPACK's gbtrf wants it: entry (row, column) at [column, lower + upper + row -
    column], the first `lower` places being room for fill; behind it `right` and then `bottom` with the corner.
    """

    def __init__(self, part: np.ndarray, row: np.ndarray, column: np.ndarray, parts: int, interior: int,
                 border: int) -> None:
        inside, below = (row < interior) & (column < interior), row >= interior
        shift = (row - column)[inside]
        self.interior, self.border = interior, border
        self.lower, self.upper = int(max(shift.max(initial=0), 0)), int(max(-shift.min(initial=0), 0))
        width = 2 * self.lower + self.upper + 1
        self._shapes = (interior, width), (interior, border), (border, interior + border)
        self._starts = np.cumsum([0, *(rows * columns for rows, columns in self._shapes)])
        place = np.where(inside, column * width + self.lower + self.upper + row - column,
                         self._starts[1] + row * border + column - interior)
        place[below] = (self._starts[2] + (row - interior) * (interior + border) + column)[below]
        self._order = np.argsort(place, kind="stable")
        place = place[self._order]
        first = np.flatnonzero(np.diff(place, prepend=-1))
        self._place, self.row, self.column = place[first], row[self._order][first], column[self._order][first]
        self._matrix = csr_array((np.zeros(len(place)), part[self._order], np.append(first, len(place))),
                                 (len(first), parts))

    def matrix(self, value: np.ndarray) -> Any:
        """The sparse matrix (places, parts) of entries with these values (entries,)."""
        return with_data(self._matrix, value[self._order])

    def blocks(self, values: np.ndarray) -> tuple[np.ndarray, ...]:
        """Return band, right and bottom with these values (..., places) in place."""
        flat = np.zeros((*values.shape[:-1], self._starts[3]), values.dtype)
        flat[..., self._place] = values
        return tuple(flat[..., start: stop].reshape(*values.shape[:-1], *shape) for start, stop, shape in
                     zip(self._starts[:-1], self._starts[1:], self._shapes, strict=True))


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
            scales = self._scales(np.abs(values))
            values *= scales[0][self.places.row] * scales[1][self.places.column]
        return self.places.blocks(values), scales

    def sums(self, weights: Any) -> Any:
        """Return the blocks of the sums at many points, weights (parts, points), unscaled, and which are uneven."""
        values = np.ascontiguousarray((self._matrix @ weights).T)
        return self.places.blocks(values), np.abs(values.view(float)).max(axis=1) > UNEVEN

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
        factor, self._solve = _BAND[band.dtype.kind]
        places = bordered.places
        self._interior, self._lower, self._upper = places.interior, places.lower, places.upper
        self._lu, self._pivots, info = factor(band.T, self._lower, self._upper, overwrite_ab=True)
        if info:
            raise np.linalg.LinAlgError("singular interior")
        self._bottom = bottom[:, : self._interior]
        self._coupled = self._inner(right)
        self._schur = bottom[:, self._interior:] - self._bottom @ self._coupled
        self._border = _inverse(self._schur)

    def phase(self) -> Any:
        """Return the determinant over its modulus (scales are positive: they leave it alone)."""
        return _phase(self._lu[self._lower + self._upper], self._pivots) * np.linalg.slogdet(self._schur)[0]

    def solve(self, f: Any) -> Any:
        """Return z with M z = f, (size, points) or (size,)."""
        if self.uneven:
            rows, columns = (scale.reshape(-1, *[1] * (f.ndim - 1)) for scale in self._scales)
            return columns * self._solved(rows * f)
        return self._solved(f)

    def _solved(self, f: np.ndarray) -> np.ndarray:
        inner = self._inner(f[: self._interior])
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
        return np.concatenate([self._inner(inner - self._bottom.T @ border, trans=1), border])

    def _inner(self, right: np.ndarray, trans: int = 0) -> np.ndarray:
        return self._solve(self._lu, self._lower, self._upper, right, self._pivots, trans=trans)[0]


def _phase(diagonal: Any, pivots: Any) -> Any:
    """The determinant over its modulus of a band with this diagonal of U."""
    swaps = np.count_nonzero(pivots != np.arange(len(pivots)))
    phases = np.prod(diagonal / np.abs(diagonal))
    return (-1) ** swaps * phases / abs(phases)


class ManyFactors:
    """The `Factors` at many points, weights (parts, points); right-hand sides are the columns of arrays (size, points).

    `uneven` tells which points need scales, and have none here. What is singular gives numbers that are not finite.
    """

    def __init__(self, bordered: "Bordered", weights: np.ndarray) -> None:
        (band, right, bottom), self.uneven = bordered.sums(weights)
        places = bordered.places
        factor, self._solve = _BAND[band.dtype.kind]
        self._interior, self._shape = places.interior, (places.lower, places.upper)
        self._factors = [factor(one.T, *self._shape, overwrite_ab=True)[:2] for one in band]
        self._bottom = bottom[..., : self._interior]
        self._coupled = np.array([self._inner(index, one) for index, one in enumerate(right)])
        self._schur = bottom[..., self._interior:] - self._bottom @ self._coupled

    def phases(self) -> np.ndarray:
        """Return the determinants over their moduli (points,)."""
        bands = [_phase(lu[sum(self._shape)], pivots) for lu, pivots in self._factors]
        return np.array(bands) * np.linalg.slogdet(self._schur)[0]

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
        f = f.T
        inner = np.array([self._inner(index, one) for index, one in enumerate(f[:, : self._interior])])[..., None]
        border = self._border @ (f[:, self._interior:, None] - self._bottom @ inner)
        return np.concatenate([inner - self._coupled @ border, border], axis=1)[..., 0].T

    def solve_left(self, g: np.ndarray) -> np.ndarray:
        """Return z with z^T M = g^T (no conjugation) at every point."""
        inner, border = g.T[:, None, : self._interior], g.T[:, None, self._interior:]
        border = (border - inner @ self._coupled) @ self._border
        inner = (inner - border @ self._bottom)[:, 0]
        inner = np.array([self._inner(index, one, trans=1) for index, one in enumerate(inner)])
        return np.concatenate([inner, border[:, 0]], axis=1).T

    def _inner(self, index: int, right: np.ndarray, trans: int = 0) -> np.ndarray:
        lu, pivots = self._factors[index]
        return self._solve(lu, *self._shape, right, pivots, trans=trans)[0]
