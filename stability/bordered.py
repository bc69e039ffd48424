"""LU factors of bordered band matrices, in time proportional to the size.

    [ band    right  ]   interior rows
    [ bottom  corner ]   border rows

The interior is factorised as a band (LAPACK gbtrf); the border follows by block elimination.
"""

import numpy as np
from scipy.linalg import lapack
from scipy.sparse import csr_array

_BAND = {"f": (lapack.dgbtrf, lapack.dgbtrs), "c": (lapack.zgbtrf, lapack.zgbtrs)}


class Bordered:
    """The layout of a sum of sparse matrices times scalars, from entries part, row, column, value (entries,).

    The band is stored by columns as LAPACK's gbtrf wants it: entry (row, column) at [column, lower + upper + row -
    column], the first `lower` places being room for fill; behind it `right` and then `bottom` with the corner.
    """

    def __init__(self, part, row, column, value, parts, interior, border):
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
        self._spread = csr_array((value, (place, part)), (self._starts[3], parts))

    def blocks(self, weights):
        """Return band, right and bottom of the sum of the parts times weights (parts,)."""
        flat = self._spread @ weights
        return tuple(flat[start: stop].reshape(shape) for start, stop, shape in
                     zip(self._starts[:-1], self._starts[1:], self._shapes, strict=True))


class Factors:
    """LU factors of the sum of the parts of a `Bordered` times weights (parts,).

    Raises numpy's LinAlgError where a pivot vanishes.
    """

    def __init__(self, bordered, weights):
        band, right, bottom = bordered.blocks(weights)
        factor, self._solve = _BAND[band.dtype.kind]
        self._interior, self._lower, self._upper = bordered.interior, bordered.lower, bordered.upper
        self._lu, self._pivots, info = factor(band.T, self._lower, self._upper, overwrite_ab=True)
        if info:
            raise np.linalg.LinAlgError("singular interior")
        self._bottom = bottom[:, : self._interior]
        self._coupled = self._inner(right)
        self._border = np.linalg.inv(bottom[:, self._interior:] - self._bottom @ self._coupled)

    def solve(self, f):
        """Return z with M z = f, (size, points)."""
        inner = self._inner(f[: self._interior])
        border = self._border @ (f[self._interior:] - self._bottom @ inner)
        return np.concatenate([inner - self._coupled @ border, border])

    def solve_left(self, g):
        """Return z with z^T M = g^T (no conjugation), (size, points)."""
        inner, border = g[: self._interior], g[self._interior:]
        border = self._border.T @ (border - self._coupled.T @ inner)
        return np.concatenate([self._inner(inner - self._bottom.T @ border, trans=1), border])

    def _inner(self, right, trans=0):
        return self._solve(self._lu, self._lower, self._upper, right, self._pivots, trans=trans)[0]
