"""Sums of constant sparse matrices, each times a scalar that varies from point to point.

Vectors are the columns of arrays (size, points): one product serves all points, whatever their scalars.
"""

from collections.abc import Callable
from functools import cached_property
from typing import Any

import numpy as np
from scipy.sparse import csc_array, csr_array

_BLOCK = 24  # lines
_ENOUGH = 4, 5000  # points and entries from which on it pays to make a real matrix of a complex one


class Lines:
    """Where the entries part, row, column (entries,) of `parts` matrices of a `shape` (rows, columns) lie.

    They are kept as one sparse matrix with a line for every (part, row) that is not empty; `part` and `row` (lines,)
    tell which it is.
    """

    def __init__(self, part: np.ndarray, row: np.ndarray, column: np.ndarray, parts: int,
                 shape: tuple[int, ...]) -> None:
        key = part * shape[0] + (shape[0] - 1 - row)  # small coefficients first: sums lose less to rounding
        self._order = np.argsort(key, kind="stable").astype(np.int32)
        key = key[self._order]
        first = np.flatnonzero(np.diff(key, prepend=-1))
        self.part, self.row = key[first] // shape[0], shape[0] - 1 - key[first] % shape[0]
        self._places = csr_array((np.zeros(len(key)), column[self._order], np.append(first, len(key))),
                                 (len(first), shape[1]))
        self._parts, self.rows = parts, shape[0]
        self._apart: tuple[np.ndarray, Any] | None = None

    def matrix(self, value: np.ndarray) -> Any:
        """The sparse matrix (lines, columns) of entries with these values (entries,)."""
        return with_data(self._places, value[self._order])

    def real(self, data: np.ndarray) -> Any:
        """The real matrix [re im] of entries with this complex `data`, in the order of the lines, or re where no entry
        is imaginary; None where one has both parts."""
        imaginary = data.imag != 0
        if np.any(imaginary & (data.real != 0)):
            return None
        if self._apart is None or not np.array_equal(self._apart[0], imaginary):  # all with this structure are alike
            self._apart = imaginary, self._doubled(imaginary) if imaginary.any() else self._places
        return with_data(self._apart[1], data.real + data.imag)

    def _doubled(self, imaginary: np.ndarray) -> Any:
        (rows, columns), places = self._places.shape, self._places
        return csr_array((places.data, places.indices + (columns * imaginary).astype(places.indices.dtype),
                          places.indptr), (rows, 2 * columns))

    @cached_property
    def addresses(self) -> tuple[int, ...]:
        """Of part, row, first entry and columns of the lines, as integers of C: compiled code reads them there."""
        self._in_c = [np.ascontiguousarray(index, np.intc) for index in
                      (self.part, self.row, self._places.indptr, self._places.indices)]
        return tuple(index.ctypes.data for index in self._in_c)

    def to_rows(self, values: np.ndarray) -> np.ndarray:
        """Sums of the values (lines, ...) of each row, (rows, ...)."""
        if self._by_row is not None:
            if values.ndim > 1 and np.iscomplexobj(values):
                return (self._by_row @ np.ascontiguousarray(values).view(float)).view(complex)
            return self._by_row @ values
        total = np.zeros((self.rows, *values.shape[1:]), values.dtype)
        total[self.row] = values
        return total

    @cached_property
    def _by_row(self) -> Any:
        """Matrix (rows, lines) that sums the lines of each row, None where there is at most one."""
        count = len(self.row)
        if len(np.unique(self.row)) == count:
            return None
        return csc_array((np.ones(count), self.row, np.arange(count + 1)), (self.rows, count))

    def to_parts(self, values: np.ndarray) -> np.ndarray:
        """Sums of the values (lines, ...) of each part, (parts, ...), a block of lines at a time.

        Partial sums stay short: one sum over all lines would lose a digit to rounding at a large degree.
        """
        blocks, firsts, parts = self._by_part
        total = np.zeros((self._parts, *values.shape[1:]), values.dtype)
        total[parts] = np.add.reduceat(np.add.reduceat(values, blocks), firsts)
        return total

    @cached_property
    def _by_part(self) -> tuple[np.ndarray, ...]:
        """First lines of the blocks, first blocks of the parts that have any, and which parts those are."""
        parts = np.unique(self.part)
        starts = np.searchsorted(self.part, parts)
        blocks = np.unique(np.concatenate([starts, np.arange(0, len(self.part), _BLOCK)]))
        return blocks, np.searchsorted(blocks, starts), parts


class Stack:
    """Matrices whose entries lie where `lines` says and have the values `value` (entries,)."""

    def __init__(self, lines: "Lines", value: np.ndarray) -> None:
        self.lines, self._matrix = lines, lines.matrix(value)

    @property
    def data(self) -> np.ndarray:
        """The values in the order of the lines, (entries,)."""
        return self._matrix.data

    @cached_property
    def _transposed(self) -> Any:
        return self._matrix.T

    @cached_property
    def _real(self) -> Any:
        """The real matrix [re im], or re: M x = [re im] [x; i x] has the same digits and takes a third of the time."""
        return self.lines.real(self._matrix.data) if np.iscomplexobj(self._matrix.data) else self._matrix

    def _apart(self, vectors: np.ndarray) -> bool:
        """Whether products with these are those of a real matrix."""
        many = vectors.ndim > 1 and vectors.shape[1] >= _ENOUGH[0] and self._matrix.nnz >= _ENOUGH[1]
        return many and np.iscomplexobj(vectors) and self._real is not None

    @cached_property
    def _squares(self) -> Any:
        return with_data(self._matrix, square(self._matrix.data))

    def full(self, weights: np.ndarray) -> np.ndarray:
        """The sum of the parts times weights (parts,), (rows, columns)."""
        return self.lines.to_rows(self.spread(weights)[:, None] * self._matrix.toarray())

    def times(self, x: np.ndarray) -> np.ndarray:
        """Products of every part with x: (lines, points), for the methods below."""
        if not self._apart(x):
            return self._matrix @ x
        both = np.empty((self._real.shape[1], x.shape[1]), complex)
        both[:len(x)] = x
        if len(both) > len(x):
            np.multiply(x, 1j, out=both[len(x):])
        return (self._real @ both.view(float)).view(complex)

    def spread(self, weights: np.ndarray) -> np.ndarray:
        """Weights (parts, points) of the lines: (lines, points), for the methods below."""
        return weights[self.lines.part]

    def total(self, spread: np.ndarray, products: np.ndarray) -> np.ndarray:
        """Sum over the parts, weights times products with x: (rows, points)."""
        return self.lines.to_rows(spread * products)

    def total_left(self, spread: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Sum over the parts, weights times y^T part: (columns, points)."""
        weighted = spread * y[self.lines.row]
        if not self._apart(weighted):
            return self._transposed @ weighted
        count, both = self._matrix.shape[1], (self._real.T @ np.ascontiguousarray(weighted).view(float)).view(complex)
        return both[:count] + 1j * both[count:] if len(both) > count else both

    def summed(self, weights: np.ndarray) -> tuple[Callable[..., Any], ...]:
        """Products of the sum of the parts, times weights (parts, ...), with vectors: functions of x, and of y."""
        spread = self.spread(weights)
        return lambda x: self.total(spread, self.times(x)), lambda y: self.total_left(spread, y)

    def brackets(self, y: np.ndarray, products: np.ndarray) -> np.ndarray:
        """y^T part x for every part: (parts, points)."""
        return self.lines.to_parts(y[self.lines.row] * products)

    def squares(self, y: np.ndarray, x: np.ndarray) -> Any:
        """Sums over the entries of every part of |y_i entry_ij x_j|^2: (parts, points)."""
        return self.lines.to_parts(square(y)[self.lines.row] * (self._squares @ square(x)))


def with_data(matrix: Any, data: np.ndarray) -> Any:
    """A sparse matrix with entries in the same places; what holds these was checked when the other was made."""
    other = object.__new__(type(matrix))
    other.__dict__.update(matrix.__dict__, data=data)
    return other


def square(z: Any) -> Any:
    """|z|^2, without the root that abs takes."""
    return z.real**2 + z.imag**2 if np.iscomplexobj(z) else z**2
