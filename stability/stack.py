"""Sums of constant sparse matrices, each times a scalar that varies from point to point.

Vectors are the columns of arrays (size, points): one product serves all points, whatever their scalars.
"""

from functools import cached_property

import numpy as np
from scipy.sparse import csc_array, csr_array

_BLOCK = 24  # lines


class Lines:
    """Where the entries part, row, column (entries,) of `parts` matrices of a `shape` (rows, columns) lie.

    They are kept as one sparse matrix with a line for every (part, row) that is not empty; `part` and `row` (lines,)
    tell which it is.
    """

    def __init__(self, part, row, column, parts, shape):
        key = part * shape[0] + (shape[0] - 1 - row)  # small coefficients first: sums lose less to rounding
        self._order = np.argsort(key, kind="stable")
        key = key[self._order]
        first = np.flatnonzero(np.diff(key, prepend=-1))
        self.part, self.row = key[first] // shape[0], shape[0] - 1 - key[first] % shape[0]
        self._column, self._starts = column[self._order], np.append(first, len(key))
        self._shape = len(first), shape[1]
        self._parts, self._rows = parts, shape[0]

    def matrix(self, value):
        """The sparse matrix (lines, columns) of entries with these values (entries,)."""
        return csr_array((value[self._order], self._column, self._starts), self._shape)

    @cached_property
    def by_row(self):
        """Matrix (rows, lines) that sums the lines of each row."""
        count = len(self.row)
        return csc_array((np.ones(count), self.row, np.arange(count + 1)), (self._rows, count))

    @cached_property
    def by_part(self):
        """Matrices (blocks, lines) and (parts, blocks) that sum the lines of each part, a block of them at a time.

        Partial sums stay short: one sum over all lines would lose a digit to rounding at a large degree.
        """
        starts = np.searchsorted(self.part, np.arange(self._parts + 1))
        blocks = np.unique(np.concatenate([starts, np.arange(0, starts[-1], _BLOCK)]))
        return _sums(blocks), _sums(np.searchsorted(blocks, starts))


class Stack:
    """Matrices whose entries lie where `lines` says and have the values `value` (entries,)."""

    def __init__(self, lines, value):
        self._lines, self._matrix = lines, lines.matrix(value)

    @cached_property
    def _transposed(self):
        return self._matrix.T

    @cached_property
    def _squares(self):
        matrix = self._matrix
        return csr_array((square(matrix.data), matrix.indices, matrix.indptr), matrix.shape)

    def times(self, x):
        """Products of every part with x: (lines, points), for the methods below."""
        return self._matrix @ x

    def spread(self, weights):
        """Weights (parts, points) of the lines: (lines, points), for the methods below."""
        return weights[self._lines.part]

    def total(self, spread, products):
        """Sum over the parts, weights times products with x: (rows, points)."""
        return self._lines.by_row @ (spread * products)

    def total_left(self, spread, y):
        """Sum over the parts, weights times y^T part: (columns, points)."""
        return self._transposed @ (spread * y[self._lines.row])

    def brackets(self, y, products):
        """y^T part x for every part: (parts, points)."""
        return self._of_parts(y[self._lines.row] * products)

    def squares(self, y, x):
        """Sum over the entries of each part of |y_i entry_ij x_j|^2: (parts, points)."""
        return self._of_parts(square(y)[self._lines.row] * (self._squares @ square(x)))

    def _of_parts(self, lines):
        lines_to_blocks, blocks_to_parts = self._lines.by_part
        return blocks_to_parts @ (lines_to_blocks @ lines)


def _sums(starts):
    """Matrix that sums the numbers from each start up to the next, (starts - 1, numbers)."""
    return csr_array((np.ones(starts[-1]), np.arange(starts[-1]), starts), (len(starts) - 1, starts[-1]))


def square(z):
    """|z|^2, without the root that abs takes."""
    return z.real**2 + z.imag**2 if np.iscomplexobj(z) else z**2
