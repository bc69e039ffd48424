"""Bordered matrices whose interior falls apart into blocks that are nearly full: each is factorised by itself.

Coefficients with long series leave bands as wide as the unknowns of a layer. Of a band LAPACK's gbtrf knows neither
where one layer ends nor that it is full; getrf on the blocks takes a small part of its time.
"""

from typing import Any

import numpy as np
from scipy.linalg import lapack

from .bordered import Places, phase

_FULL = 1.25, 0.5  # width of a band over the size of the largest block above which blocks are faster (measured) ...
_WIDE, _LARGEST = 128, 512  # the former for any band, the latter for one so wide; size of blocks up to which
_WIDE_RIGHT = 32  # columns from which on it pays to see which of them a block meets
_BLOCK = {"f": (lapack.dgetrf, lapack.dgetrs), "c": (lapack.zgetrf, lapack.zgetrs)}


def placed(part: np.ndarray, row: np.ndarray, column: np.ndarray, parts: int, interior: int, border: int) -> Places:
    """Return the `Places` of these entries in a band, or in blocks where those are full or nearly so."""
    band = Places(part, row, column, parts, interior, border)
    edges = _edges(row, column, interior)
    width, largest = band.lower + band.upper + 1, np.diff(edges).max(initial=0)
    full = 0 < largest <= _LARGEST and width > _FULL[width > _WIDE] * largest
    return Blocks(part, row, column, parts, interior, border) if full else band


def whole(part: np.ndarray, row: np.ndarray, column: np.ndarray, parts: int, interior: int, border: int) -> Places:
    """The `placed` entries, but where all would be one block and the border: one block without a border."""
    places = placed(part, row, column, parts, interior, border)
    alone = isinstance(places, Blocks) and places.lone
    return Blocks(part, row, column, parts, interior + border, 0) if alone else places


def _edges(row: np.ndarray, column: np.ndarray, interior: int) -> np.ndarray:
    """Where the blocks of the interior begin, and its end."""
    inside = (row < interior) & (column < interior)
    reach = np.arange(interior)
    np.maximum.at(reach, np.minimum(row, column)[inside], np.maximum(row, column)[inside])
    return np.concatenate(([0], np.flatnonzero(np.maximum.accumulate(reach) == np.arange(interior)) + 1))


class Blocks(Places):
    """Where the entries lie in a matrix with full blocks along its diagonal and a border.

    The blocks follow one another, each by columns; all else is as in a band. `lone` tells whether there is but one.
    """

    def _inner(self, row: np.ndarray, column: np.ndarray, inside: np.ndarray) -> tuple[tuple[int, int], np.ndarray]:
        super()._inner(row, column, inside)  # compiled code takes it for a band
        edges = _edges(row, column, self.interior)
        sizes = np.diff(edges)
        ends = np.cumsum(sizes**2)
        block = np.minimum(np.searchsorted(edges, column, side="right") - 1, len(sizes) - 1)
        beside = (row < self.interior) & (column >= self.interior)
        self._parts = []
        for first, last, end in zip(edges[:-1].tolist(), edges[1:].tolist(), ends.tolist(), strict=True):
            used = column[beside & (row >= first) & (row < last)] - self.interior
            few = slice(int(used.min(initial=self.border)), int(used.max(initial=-1)) + 1)
            self._parts.append((slice(first, last), slice(end - (last - first) ** 2, end), few))
        self.lone = len(sizes) == 1
        place = (ends - sizes**2)[block] + (column - edges[block]) * sizes[block] + row - edges[block]
        return (1, int(ends[-1])), place

    def factors(self, band: np.ndarray) -> Any:
        return BlockFactors(band[0], self._parts)


class BlockFactors:
    """LU factors of the blocks; `failed` where a pivot vanishes.

    `parts` are the slices of each block: of rows, of its entries, and of the columns of the border that it meets.
    """

    def __init__(self, entries: np.ndarray, parts: list[tuple[slice, slice, slice]]) -> None:
        factor, self._solve = _BLOCK[entries.dtype.kind]
        self._parts, self._factors, self.failed = parts, [], 0
        for rows, own, _ in parts:
            size = rows.stop - rows.start
            *factors, info = factor(entries[own].reshape(size, size).T, overwrite_a=True)
            self._factors.append(factors)
            self.failed = self.failed or info

    def solve(self, right: np.ndarray, trans: int = 0) -> np.ndarray:
        """Return z with M z = right, or M^T z = right."""
        if right.ndim > 1 and right.shape[1] >= _WIDE_RIGHT:
            return self._apart(right, trans)
        if len(self._factors) == 1:
            return self._solve(*self._factors[0], right, trans=trans)[0]
        return np.concatenate([self._solve(*factors, right[rows], trans=trans)[0]
                               for factors, (rows, *_) in zip(self._factors, self._parts, strict=True)])

    def _apart(self, right: np.ndarray, trans: int) -> np.ndarray:
        """The same for each block with the columns that are not 0 in its rows: of many, few may be."""
        found = np.zeros(right.shape, np.result_type(right, self._factors[0][0]))
        for factors, (rows, *_) in zip(self._factors, self._parts, strict=True):
            used = np.flatnonzero(right[rows].any(axis=0))
            found[rows, used] = self._solve(*factors, right[rows, used], trans=trans)[0]
        return found

    def coupled(self, right: np.ndarray) -> np.ndarray:
        """Return z with M z = right, the border beside the interior: of that each block meets a few columns."""
        found = np.zeros_like(right)
        for factors, (rows, _, few) in zip(self._factors, self._parts, strict=True):
            if few.stop > few.start:
                found[rows, few] = self._solve(*factors, right[rows, few])[0]
        return found

    def phase(self) -> Any:
        """Return the determinant over its modulus."""
        return np.prod([phase(lu.diagonal(), pivots) for lu, pivots in self._factors])
