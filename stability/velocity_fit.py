"""A smooth velocity through a table, linear in its values, so that their errors pass through it.

U(z) is a series of Chebyshev polynomials of z between edges, and of tanh((z - centre) / L) where the fluid is
unbounded: that is constant far away. Coefficients are those of weighted least squares,

    c = P U_i,    P = (A^T W A)^-1 A^T W,    W = diag(1 / error_i^2),    covariance P diag(error_i^2) P^T.

The number of terms (and L) are the data's choice: those of the least Bayesian information criterion, of the residuals
that each point has about the fit through all others, so that a fit through every point gains nothing by it. Where no
errors are given they are the scatter about the fit: that of a table without noise is what interpolation leaves open.
"""

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.polynomial import chebyshev as C

from .errors import ParameterError

_WIDTHS = 2.5, 3.3, 4.5, 6.0, 8.0  # extent of the table over L
_MOST = 60  # terms
_CONDITION = 300.0  # of the least-squares problem: beyond, values between the points are no longer theirs
_LIMIT = 0.05  # of the change of U, within which the last value of a table must have come to its limit
_EPS = np.finfo(float).eps


@dataclass(frozen=True, eq=False)
class Smoothed:
    """U(z) = sum_j c_j T_j(x), x = (z - centre) / L, or 2 tanh((z - centre) / L) + shift over 1 + |shift|.

    `coefficients` (terms,) and their `covariance` (terms, terms); `scatter` is the root mean square about the fit, in
    units of the errors where those are given; `shift` is -1, 0 or 1: unbounded above, on both sides, below.
    """

    low: float
    high: float
    centre: float
    L: float
    mapped: bool
    shift: int
    coefficients: np.ndarray
    covariance: np.ndarray
    scatter: float
    points: int
    limits: tuple[float | None, float | None]

    @property
    def data(self) -> "Smoothed":
        """Measured values: this."""
        return self

    def U(self, z: np.ndarray) -> np.ndarray:
        return self.basis(z) @ self.coefficients

    def dU(self, z: np.ndarray) -> np.ndarray:
        return self.slopes(z) @ self.coefficients

    def basis(self, z: np.ndarray) -> np.ndarray:
        """What each coefficient adds to U at heights z, (points, terms)."""
        return C.chebvander(self._x(z)[0], len(self.coefficients) - 1)

    def slopes(self, z: np.ndarray) -> np.ndarray:
        """What each coefficient adds to dU/dz, (points, terms)."""
        x, dx = self._x(z)
        terms = len(self.coefficients)
        slopes = np.zeros((len(x), terms))
        if terms > 1:
            slopes[:, 1:] = C.chebvander(x, terms - 2) @ C.chebder(np.eye(terms)[:, 1:])
        return slopes * dx[:, None]

    def error(self, z: np.ndarray) -> np.ndarray:
        """Standard error of U at heights z."""
        basis = self.basis(np.atleast_1d(z))
        return np.sqrt(np.einsum("ij,jk,ik->i", basis, self.covariance, basis))

    def _x(self, z):
        """x in [-1, 1] and dx/dz."""
        z = np.atleast_1d(np.asarray(z, dtype=float))
        if not self.mapped:
            return (z - self.centre) / self.L, np.full(z.shape, 1 / self.L)
        t = np.tanh((z - self.centre) / self.L)
        share = 1 + abs(self.shift)
        return share * t + self.shift, share * (1 - t) * (1 + t) / self.L


@lru_cache(maxsize=64)
def smoothed(table: Any, below: bool, above: bool, name: str) -> Smoothed:
    """Return the fit through a `Table` of a fluid that is unbounded `below` or `above`, or has edges at its ends.

    Raises ParameterError, beginning with `name`, where a table of an unbounded fluid ends before U has come to rest.
    """
    z, U = np.array(table.z), np.array(table.U)
    weights = None if table.U_error is None else 1 / np.array(table.U_error)
    best = min((_fit(z, U, weights, shape) for shape in _shapes(z, below, above)), key=lambda found: found[0])
    _, shape, c, P, scatter, spread = best
    covariance = (P * spread**2) @ P.T
    ends = tuple(_limit(table, c, shape, end, name) if open_ else None for end, open_ in ((-1, below), (1, above)))
    return Smoothed(table.low, table.high, *shape, c, covariance, scatter, len(z), ends)


def _shapes(z, below, above):
    """(centre, L, mapped, shift) of the candidates."""
    extent = z[-1] - z[0]
    if not below and not above:
        return [((z[0] + z[-1]) / 2, extent / 2, False, 0)]
    if below and above:
        return [((z[0] + z[-1]) / 2, extent / 2 / width, True, 0) for width in _WIDTHS]
    return [(z[0], extent / width, True, -1) if above else (z[-1], extent / width, True, 1) for width in _WIDTHS]


def _fit(z, U, weights, shape):
    """The best number of terms for a shape: (criterion, shape, coefficients, P, scatter, errors of the points)."""
    n, scale = len(z), np.ptp(U)
    weight = np.ones(n) if weights is None else weights
    empty = Smoothed(z[0], z[-1], *shape, np.zeros(min(_MOST, n // 2)), np.zeros((0, 0)), 0.0, n, (None, None))
    rows, right = empty.basis(z) * weight[:, None], U * weight
    q, r = np.linalg.qr(rows)  # nested: the first columns are those of every smaller fit
    rounding = 4 * _EPS * scale * float(np.max(weight))
    best = None
    for terms in range(2, rows.shape[1] + 1):
        if terms > 2 and np.linalg.cond(r[:terms, :terms]) > _CONDITION * np.linalg.cond(r[:2, :2]):
            break
        part = q[:, :terms]
        rest = right - part @ (part.T @ right)
        free = np.maximum(1 - (part**2).sum(axis=1), 1e-3)  # one minus the leverage
        square = max(float(np.mean((rest / free) ** 2)), rounding**2)
        criterion = n * (np.log(square) if weights is None else square) + terms * np.log(n)
        if best is None or criterion < best[0]:
            scatter = max(float(np.sqrt(np.mean(rest**2 / free))), rounding)
            best = criterion, terms, scatter
    criterion, terms, scatter = best
    P = np.linalg.solve(r[:terms, :terms], q[:, :terms].T) * weight
    return criterion, shape, P @ U, P, scatter, np.full(n, scatter) if weights is None else 1 / weight


def _limit(table, c, shape, end, name):
    """U far beyond an end of the table, which must have come near it."""
    values = C.chebval([-1.0, 1.0], c)
    limit, last = float(values[0 if end < 0 else 1]), table.U[0 if end < 0 else -1]
    rest = abs(last - limit) / np.ptp(table.U)
    error = max(table.U_error or (0.0,)) / np.ptp(table.U)
    if rest > _LIMIT + 4 * error:
        edge, z = ("top", table.high) if end > 0 else ("bottom", table.low)
        raise ParameterError(f"{name}: {edge} = decay, but at the end of {table!r}, z = {z:.6g}, U still differs by "
                             f"{100 * rest:.0f} % of its change from where it seems to go ({limit:.4g}): a longer table "
                             "is needed, or a wall or a free edge")
    return limit
