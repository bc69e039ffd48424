"""Sums of constant sparse matrices, each times a scalar that varies from point to point.

Vectors are the columns of arrays (size, points): one product serves all points, whatever their scalars.
"""

import numpy as np
from scipy.sparse import csc_array, csr_array


class Stack:
    """`parts` matrices of shape (rows, columns), from entries part, row, column, value (entries,).

    Kept as one sparse matrix with a line for every (part, row) that is not empty; `part` and `row` (lines,) tell
    which it is.
    """

    def __init__(self, part, row, column, value, parts, shape):
        key = part * shape[0] + (shape[0] - 1 - row)  # small coefficients first: sums lose less to rounding
        order = np.argsort(key, kind="stable")
        key = key[order]
        first = np.flatnonzero(np.diff(key, prepend=-1))
        self.part, self.row = key[first] // shape[0], shape[0] - 1 - key[first] % shape[0]
        count = len(first)
        starts = np.append(first, len(key))
        self._lines = csr_array((value[order], column[order], starts), (count, shape[1]))
        self._lines_t = self._lines.T
        self._squares = csr_array((np.abs(self._lines.data) ** 2, self._lines.indices, starts), (count, shape[1]))
        ones, each = np.ones(count), np.arange(count + 1)
        self._by_row = csc_array((ones, self.row, each), (shape[0], count))
        self._by_part = csr_array((ones, each[:-1], np.searchsorted(self.part, np.arange(parts + 1))), (parts, count))

    def times(self, x):
        """Products of every part with x: (lines, points), for the methods below."""
        return self._lines @ x

    def total(self, weights, products):
        """Sum over the parts, weights (parts, points) times products with x: (rows, points)."""
        return self._by_row @ (weights[self.part] * products)

    def total_left(self, weights, y):
        """Sum over the parts, weights times y^T part: (columns, points)."""
        return self._lines_t @ (weights[self.part] * y[self.row])

    def brackets(self, y, products):
        """y^T part x for every part: (parts, points)."""
        return self._by_part @ (y[self.row] * products)

    def squares(self, y, x):
        """Sum over the entries of each part of |y_i entry_ij x_j|^2: (parts, points)."""
        return self._by_part @ (np.abs(y[self.row]) ** 2 * (self._squares @ np.abs(x) ** 2))
