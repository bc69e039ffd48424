"""Bordered band matrices: LU, solves from either side and products, in time proportional to the size.

    [ band    right  ]   interior rows
    [ bottom  corner ]   border rows

The interior is factorised as a band (LAPACK gbtrf); the border follows by block elimination.
"""

from functools import cached_property

import numpy as np
from scipy.linalg import lapack

_BAND = {"f": (lapack.dgbtrf, lapack.dgbtrs), "c": (lapack.zgbtrf, lapack.zgbtrs)}


class Bordered:
    """A stack of bordered band matrices of one shape, in one array `flat` (..., entries).

    `band` (..., interior, 2 lower + upper + 1) holds the columns of the band as LAPACK's gbtrf wants them:
    entry (row, column) at [column, lower + upper + row - column], the first `lower` places being room for
    fill. `right` is (..., interior, border), `bottom` (..., border, interior + border).
    """

    def __init__(self, flat, interior, border, lower, upper):
        self.flat = flat
        self.interior, self.border, self.lower, self.upper = interior, border, lower, upper
        shapes = (interior, 2 * lower + upper + 1), (interior, border), (border, interior + border)
        first, second = interior * (2 * lower + upper + 1), interior * border
        parts = flat[..., :first], flat[..., first: first + second], flat[..., first + second:]
        self.band, self.right, self.bottom = (
            part.reshape(part.shape[:-1] + shape) for part, shape in zip(parts, shapes, strict=True))

    @classmethod
    def from_entries(cls, count, interior, border, entries):
        """Build a stack of `count` matrices from entries (part, rows, columns, values), summed where they meet."""
        inside = [(p, *_where((r < interior) & (c < interior), r, c, v)) for p, r, c, v in entries]
        shifts = np.concatenate([[0], *(r - c for _, r, c, _ in inside)])
        lower, upper = int(shifts.max()), int(-shifts.min())
        total = interior * (2 * lower + upper + 1 + border) + border * (interior + border)
        stack = cls(np.zeros((count, total), np.result_type(*(v for *_, v in entries))), interior, border, lower, upper)
        for part, rows, columns, values in inside:
            np.add.at(stack.band[part], (columns, lower + upper + rows - columns), values)
        for part, rows, columns, values in entries:
            r, c, v = _where((rows < interior) & (columns >= interior), rows, columns, values)
            np.add.at(stack.right[part], (r, c - interior), v)
            r, c, v = _where(rows >= interior, rows, columns, values)
            np.add.at(stack.bottom[part], (r - interior, c), v)
        return stack

    def combine(self, weights):
        """Return sum_p weights[..., p] * part p: one matrix, or one per point."""
        return self._like(weights @ self.flat)

    def squared(self):
        """Return the stack of squared moduli of the entries."""
        return self._like(np.abs(self.flat) ** 2)

    def _like(self, flat):
        return Bordered(flat, self.interior, self.border, self.lower, self.upper)

    def left(self, y):
        """Return y^T times each matrix of a stack (points, ...) with its own row y (points, size)."""
        inner, border = y[:, : self.interior], y[:, self.interior:]
        banded = (self.band[..., self.lower:] * self._windows(inner)).sum(axis=-1)
        beside = np.einsum("ni,nib->nb", inner, self.right)
        return np.concatenate([banded, beside], axis=1) + np.einsum("nb,nbs->ns", border, self.bottom)

    def left_all(self, y):
        """Return every row y (points, size) times every matrix of the stack: (points, parts, size)."""
        inner, border = y[:, : self.interior], y[:, self.interior:]
        windows = self._windows(inner).transpose(1, 2, 0)
        banded = self._by_column @ windows  # (interior, parts, points)
        beside = np.einsum("ni,pib->npb", inner, self.right)
        product = np.concatenate([banded.transpose(2, 1, 0), beside], axis=2)
        return product + np.einsum("nb,pbs->nps", border, self.bottom)

    @cached_property
    def _by_column(self):
        """The band without the room for fill as (interior, parts, width)."""
        return np.ascontiguousarray(self.band[..., self.lower:].transpose(1, 0, 2))

    def _windows(self, inner):
        """Sliding windows (points, interior, width): the rows that meet each column of the band; not copied."""
        width = self.lower + self.upper + 1
        padded = np.zeros((len(inner), self.interior + width - 1), inner.dtype)
        padded[:, self.upper: self.upper + self.interior] = inner
        return np.ndarray((len(inner), self.interior, width), padded.dtype, padded, 0,
                          (*padded.strides, padded.itemsize))

    def dense(self):
        """Return a single matrix in full."""
        interior = self.interior
        full = np.zeros((interior + self.border,) * 2, self.flat.dtype)
        for shift in range(-self.upper, self.lower + 1):
            columns = np.arange(max(0, -shift), min(interior, interior - shift))
            full[columns + shift, columns] = self.band[columns, self.lower + self.upper + shift]
        full[:interior, interior:] = self.right
        full[interior:] = self.bottom
        return full


class Entries:
    """Few non-zero entries of a stack of square matrices, ordered for products from either side."""

    def __init__(self, entries, size):
        """`entries` yields (part, rows, columns, values)."""
        lists = [(np.full(len(rows), part), rows, columns, values) for part, rows, columns, values in entries]
        joined = [np.concatenate(arrays) for arrays in zip(*lists, strict=True)] if lists else [np.zeros(0, int)] * 4
        part, rows, columns, values = joined
        self._size = size
        self._by_row = _grouped(rows, columns, part, values)
        self._by_column = _grouped(columns, rows, part, values)

    def combine(self, weights):
        """Return sum_p weights[..., p] * part p, for products `matrix @ x` and `y @ matrix`."""
        orders = self._by_row, self._by_column
        return _Sparse(*((*places, weights[..., part] * values) for *places, part, values in orders), self._size)


class _Sparse:
    __array_ufunc__ = None  # let `array @ matrix` come to us

    def __init__(self, by_row, by_column, size):
        self._by_row, self._by_column, self._size = by_row, by_column, size

    def __matmul__(self, x):
        return self._sum(x, *self._by_row)

    def __rmatmul__(self, y):
        return self._sum(y, *self._by_column)

    def _sum(self, vector, places, starts, across, values):
        """Products of each vector (..., size) with its own matrix."""
        total = np.zeros((*vector.shape[:-1], self._size), np.result_type(vector, values))
        if len(starts):
            total[..., places] = np.add.reduceat(values * vector[..., across], starts, axis=-1)
        return total

    def dense(self):
        places, starts, columns, values = self._by_row
        full = np.zeros((self._size, self._size), values.dtype)
        counts = np.diff(np.append(starts, len(values)))
        np.add.at(full, (np.repeat(places, counts), columns), values)
        return full


def _grouped(places, across, part, values):
    """Sort by place: the distinct places, where each begins, and the rest in that order."""
    order = np.argsort(places, kind="stable")
    distinct, starts = np.unique(places[order], return_index=True)
    return distinct, starts, across[order], part[order], values[order]


class Factors:
    """LU factors of a stack (points, ...) of bordered matrices; overwrites their bands.

    Raises numpy's LinAlgError where a pivot vanishes.
    """

    def __init__(self, stack):
        factor, self._solve = _BAND[stack.flat.dtype.kind]
        self._interior, self._lower, self._upper = stack.interior, stack.lower, stack.upper
        self._factors = []
        for band in stack.band:
            lu, pivots, info = factor(band.T, stack.lower, stack.upper, overwrite_ab=True)
            if info:
                raise np.linalg.LinAlgError("singular interior")
            self._factors.append((lu, pivots))
        self._bottom = stack.bottom[..., : self._interior]
        self._coupled = self._inner(stack.right)
        self._border = np.linalg.inv(stack.bottom[..., self._interior:] - self._bottom @ self._coupled)

    def solve(self, f):
        """Return z (points, size) with M z = f for each matrix M."""
        inner = self._inner(f[:, : self._interior])
        border = _times(self._border, f[:, self._interior:] - _times(self._bottom, inner))
        return np.concatenate([inner - _times(self._coupled, border), border], axis=1)

    def solve_left(self, g):
        """Return z (points, size) with z^T M = g^T (no conjugation)."""
        inner, border = g[:, : self._interior], g[:, self._interior:]
        border = _times(border - _times(inner, self._coupled), self._border)
        return np.concatenate([self._inner(inner - _times(border, self._bottom), trans=1), border], axis=1)

    def _inner(self, right, trans=0):
        """Solve with the bands: right is (points, interior) or (points, interior, several)."""
        result = np.empty(right.shape, np.result_type(right, self._factors[0][0]))
        for i, (lu, pivots) in enumerate(self._factors):
            result[i] = self._solve(lu, self._lower, self._upper, right[i], pivots, trans=trans)[0]
        return result


def _times(left, right):
    """Products of each matrix and vector of two stacks, in either order."""
    if left.ndim > right.ndim:
        return (left @ right[..., None])[..., 0]
    return (left[:, None] @ right)[:, 0]


def _where(mask, *arrays):
    return tuple(array[mask] for array in arrays)
