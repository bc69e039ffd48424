"""Eigenvalues of the Orr-Sommerfeld equation in extended precision, by spectral elements; exact conditions outside.

    w'' = f + k^2 w,    f'' = (k^2 + Re (sigma + i k U)) f - i k Re U'' w

for w and the vorticity f, each with its slope, between walls (w = w' = 0), free edges (w = f = 0) or uniform fluid that
reaches to infinity: there f' = -+ lambda f and w' = -+ (k w + f / (lambda + k)), lambda^2 = k^2 + Re (sigma + i k U).
Newton's iteration in (fields, sigma) takes its residuals in extended precision (19 digits). It shares nothing with the
package: values at points for series, many short elements for one stretched layer, vorticity for stresses, U'' for U',
and conditions that depend on sigma for ones that do not.
"""

import numpy as np
from scipy.sparse import block_diag, bmat, coo_matrix, csc_matrix, vstack
from scipy.sparse.linalg import splu

_STEPS = 30
_LAST = 1e-17  # change of sigma below which the iteration may end
FIELDS = 4  # w, w', f, f'


class Elements:
    """Points (elements, order + 1) between two heights, and the differentiation matrix of each element."""

    def __init__(self, low, high, count, order):
        angle = np.arange(order + 1, dtype=np.longdouble) * (4 * np.arctan(np.longdouble(1)) / order)
        x = -np.cos(angle)
        ends = np.linspace(np.longdouble(low), np.longdouble(high), count + 1)
        self.half = (ends[1] - ends[0]) / 2
        self.z = (ends[:-1] + self.half)[:, None] + self.half * x
        self.slope = _differentiation(x) / self.half


def _differentiation(x):
    """D with (D f)_i = f'(x_i) at Chebyshev points, rows summing to 0."""
    count = len(x)
    weight = (-1.0) ** np.arange(count) * np.where(np.isin(np.arange(count), (0, count - 1)), 0.5, 1.0)
    gap = x[:, None] - x + np.eye(count)
    matrix = weight[None, :] / weight[:, None] / gap
    np.fill_diagonal(matrix, 0)
    np.fill_diagonal(matrix, -matrix.sum(axis=1))
    return matrix


def growth(U, ddU, low, high, Re, k, guess, edges, count=40, order=24):
    """Return sigma (clongdouble) next to the guess; `edges` are two of "wall", "free", "decay".

    U and U'' take and return longdouble arrays. Raises ArithmeticError where the iteration does not end.
    """
    mesh = Elements(low, high, count, order)
    k, Re = np.longdouble(k), np.longdouble(Re)
    problem = _Problem(mesh, U(mesh.z), ddU(mesh.z), Re, k, edges)
    sigma = np.clongdouble(guess)
    x = problem.start(sigma)
    before = np.inf
    for step in range(_STEPS):
        residual, by_sigma = problem.residual(x, sigma), problem.by_sigma(x, sigma)
        if step < 4:
            factors, pivot = problem.factors(sigma), int(np.argmax(np.abs(x)))
        along, ahead = (factors.solve(np.asarray(part, dtype=complex)) for part in (residual, by_sigma))
        change = along[pivot] / ahead[pivot]  # keeps the largest value as it is
        x = x - along + np.clongdouble(change) * ahead
        sigma = sigma - np.clongdouble(change)
        if step > 5 and abs(change) < max(_LAST, before / 2) and abs(change) < 1e-15:
            return sigma
        before = abs(change)
    raise ArithmeticError(f"no eigenvalue near {guess}: last step {abs(change):.1e}")


class _Problem:
    """The equations in each element, values that meet between elements, and conditions at the edges.

    Unknowns are (elements, fields, points); rows are the four equations at all points but the first of each element,
    then those that meet or hold at that point (two at each edge of the fluid).
    """

    def __init__(self, mesh, U, ddU, Re, k, edges):
        self.mesh, self.U, self.ddU, self.Re, self.k, self.edges = mesh, U, ddU, Re, k, edges
        self.shape = (len(U), FIELDS, U.shape[1])

    def coefficients(self, sigma):
        inertia = self.Re * (sigma + 1j * self.k * self.U)
        return self.k**2 + inertia, -1j * self.k * self.Re * self.ddU

    def residual(self, x, sigma):
        fields = x.reshape(self.shape)
        w, dw, f, df = (fields[:, index] for index in range(FIELDS))
        along, across = self.coefficients(sigma)
        rest = [w @ self.mesh.slope.T - dw, dw @ self.mesh.slope.T - f - self.k**2 * w, f @ self.mesh.slope.T - df,
                df @ self.mesh.slope.T - along * f - across * w]
        inner = np.stack(rest, axis=1)[:, :, 1:].ravel()
        meet = (fields[1:, :, 0] - fields[:-1, :, -1]).ravel()
        return np.concatenate((inner, meet, self.conditions(fields[0, :, 0], -1, sigma, self.edges[0], self.U[0, 0]),
                               self.conditions(fields[-1, :, -1], 1, sigma, self.edges[1], self.U[-1, -1])))

    def conditions(self, fields, side, sigma, kind, U):
        w, dw, f, df = fields
        if kind == "wall":
            return np.array([w, dw])
        if kind == "free":
            return np.array([w, f])
        fall = np.sqrt(self.k**2 + self.Re * (sigma + 1j * self.k * U))
        return np.array([df + side * fall * f, dw + side * (self.k * w + f / (fall + self.k))])

    def by_sigma(self, x, sigma):
        fields = x.reshape(self.shape)
        inner = np.zeros((self.shape[0], FIELDS, self.shape[2] - 1), np.clongdouble)
        inner[:, 3] = -self.Re * fields[:, 2, 1:]
        step = np.clongdouble(1e-9) * abs(sigma)
        ends = []
        for end, side in ((0, -1), (-1, 1)):
            at = fields[end, :, end]
            two = [self.conditions(at, side, sigma + way * step, self.edges[end], self.U[end, end]) for way in (1, -1)]
            ends.append((two[0] - two[1]) / (2 * step))
        return np.concatenate((inner.ravel(), np.zeros((self.shape[0] - 1) * FIELDS), *ends))

    def factors(self, sigma):
        """Sparse factors of the derivative of the residual in the fields, in double precision."""
        along, across = (np.asarray(one, dtype=complex)[:, 1:, None] for one in self.coefficients(sigma))
        slope, eye = np.asarray(self.mesh.slope, dtype=float)[1:], np.eye(self.shape[2])[1:]
        blocks = [bmat([[slope, -eye, None, None], [-float(self.k) ** 2 * eye, slope, -eye, None],
                        [None, None, slope, -eye], [-b * eye, None, -a * eye, slope]])
                  for a, b in zip(along, across, strict=True)]
        return splu(csc_matrix(vstack([block_diag(blocks), self._border(sigma)])))

    def _border(self, sigma):
        """Rows of what meets between elements, and of the conditions at both edges."""
        count, _, points = self.shape
        place = np.arange(count * FIELDS * points).reshape(self.shape)
        rows = [(place[index + 1, field, 0], place[index, field, -1]) for index in range(count - 1)
                for field in range(FIELDS)]
        entries = [(row, column, value) for row, pair in enumerate(rows)
                   for column, value in zip(pair, (1, -1), strict=True)]
        for end, side, first in ((0, -1, len(rows)), (-1, 1, len(rows) + 2)):
            for field, unit in enumerate(np.eye(FIELDS, dtype=np.clongdouble)):
                values = self.conditions(unit, side, sigma, self.edges[end], self.U[end, end])
                entries += [(first + row, place[end, field, end], complex(value)) for row, value in enumerate(values)]
        row, column, value = zip(*entries, strict=True)
        return coo_matrix((value, (row, column)), shape=(len(rows) + 4, place.size))

    def start(self, sigma):
        """Fields by inverse iteration from random ones."""
        factors, size = self.factors(sigma), int(np.prod(self.shape))
        x = np.random.default_rng(1).standard_normal(size).astype(complex)
        for _ in range(4):
            x = factors.solve(np.asarray(self.by_sigma(x.astype(np.clongdouble), sigma), dtype=complex))
            x /= x[np.argmax(np.abs(x))]
        return x.astype(np.clongdouble)

