"""A smooth velocity through a table, linear in its values, so that their errors pass through it.

U(z) is a series of Chebyshev polynomials of z between edges, and of tanh((z - centre) / L) where the fluid is
unbounded: those are constant far away. Coefficients are those of weighted least squares,

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

from ..errors import ParameterError

_WIDTHS = 2.5, 3.3, 4.5, 6.0, 8.0  # distance from the centre to the end of the table over L
_CENTRES = 0.0, 0.25  # of a fluid with one edge, and the middle: way from the edge over the extent of the table
_MOST = 60  # terms
_CONDITION = 300.0  # of the least-squares problem: beyond, values between the points are no longer theirs
_LIMIT = 0.05  # of the change of U, within which the last value of a table must have come to its limit
_SLOPE = 0.6  # of the change of U over the extent of a table: the largest slope at an end where it comes to rest,
_PART = 0.15  # that is in this part of the table
_ALIKE, _CLOSE = 10.0, 1e-6  # scatter of a fit over the least of all, and beyond it, up to which it may serve
_EPS = np.finfo(float).eps


@dataclass(frozen=True)
class Shape:
    """How x, from -1 to 1, depends on z between `low` and `high`: linear, or linear in tanh((z - centre) / L)."""

    low: float
    high: float
    centre: float | None
    L: float

    def x(self, z: Any) -> Any:
        """x and dx/dz at heights z."""
        z = np.atleast_1d(np.asarray(z, dtype=float))
        if self.centre is None:
            middle, half = (self.low + self.high) / 2, (self.high - self.low) / 2
            return (z - middle) / half, np.full(z.shape, 1 / half)
        t, low, high = (np.tanh((height - self.centre) / self.L) for height in (z, self.low, self.high))
        half = (high - low) / 2
        return (t - (low + high) / 2) / half, (1 - t) * (1 + t) / (self.L * half)


@dataclass(frozen=True, eq=False)
class Smoothed:
    """U(z) = sum_j c_j T_j(x), with x from -1 to 1 between the ends of the fluid.

    `coefficients` (terms,) and their `covariance` (terms, terms); `scatter` is the root mean square about the fit, in
    units of the errors where those are given; `shape` says how x depends on z.
    """

    low: float
    high: float
    shape: "Shape"
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
        return C.chebvander(self.shape.x(z)[0], len(self.coefficients) - 1)

    def slopes(self, z: np.ndarray) -> np.ndarray:
        """What each coefficient adds to dU/dz, (points, terms)."""
        x, dx = self.shape.x(z)
        terms = len(self.coefficients)
        slopes = np.zeros((len(x), terms))
        if terms > 1:
            slopes[:, 1:] = C.chebvander(x, terms - 2) @ C.chebder(np.eye(terms)[:, 1:])
        return slopes * dx[:, None]

    def error(self, z: np.ndarray) -> np.ndarray:
        """Standard error of U at heights z."""
        basis = self.basis(np.atleast_1d(z))
        return np.sqrt(np.einsum("ij,jk,ik->i", basis, self.covariance, basis))


@lru_cache(maxsize=64)
def smoothed(table: Any, below: bool, above: bool, name: str) -> Smoothed:
    """Return the fit through a `Table` of a fluid that is unbounded `below` or `above`, or has edges at its ends.

    Raises ParameterError, beginning with `name`, where a table of an unbounded fluid ends before U has come to rest.
    """
    z, U = np.array(table.z), np.array(table.U)
    weights = None if table.U_error is None else 1 / np.array(table.U_error)
    fits = sorted((_fit(z, U, weights, shape) for shape in _shapes(z, below, above)), key=lambda found: found[0])
    closest = _ALIKE * min(found[4] for found in fits) + _CLOSE * (1.0 if weights is not None else np.ptp(U))
    moving = any(_moves(z, U, side) for side, open_ in ((0, below), (-1, above)) if open_)
    at_rest = [found for found in fits if found[4] <= closest and _rest(table, found[2], below, above) <= 0]
    if moving or not at_rest:
        raise _no_limit(table, fits[0][2], below, above, name)
    _, shape, c, P, scatter, spread = at_rest[0]
    low, high = C.chebval([-1.0, 1.0], c).tolist()
    return Smoothed(table.low, table.high, shape, c, (P * spread**2) @ P.T, scatter, len(z),
                    (low if below else None, high if above else None))


def _shapes(z: Any, below: Any, above: Any) -> Any:
    """The candidates: for an unbounded fluid, several centres and lengths L."""
    low, high = z[0], z[-1]
    if not below and not above:
        return [Shape(low, high, None, 1.0)]
    centres = [(low + high) / 2]
    if not (below and above):
        centres += [low + share * (high - low) if above else high - share * (high - low) for share in _CENTRES]
    return [Shape(-np.inf if below else low, np.inf if above else high, centre,
                  min(abs(end - centre) for end, open_ in ((low, below), (high, above)) if open_) / width)
            for centre in centres for width in _WIDTHS]


def _fit(z: Any, U: Any, weights: Any, shape: Any) -> Any:
    """The best number of terms for a shape: (criterion, shape, coefficients, P, scatter, errors of the points)."""
    n, scale = len(z), np.ptp(U)
    weight = np.ones(n) if weights is None else weights
    rows, right = C.chebvander(shape.x(z)[0], min(_MOST, n // 2) - 1) * weight[:, None], U * weight
    q, r = np.linalg.qr(rows)  # nested: the first columns are those of every smaller fit
    rounding = 4 * _EPS * scale * float(np.max(weight))
    best: Any = None
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


def _rest(table: Any, c: Any, below: Any, above: Any) -> Any:
    """By how much more than is allowed U still changes beyond the open ends of a table, over its whole change."""
    limits, change = C.chebval([-1.0, 1.0], c), np.ptp(table.U)
    way = [abs(table.U[side] - limits[side]) * open_ for side, open_ in ((0, below), (-1, above))]
    return max(way) / change - _LIMIT - 4 * max(table.U_error or (0.0,)) / change


def _moves(z: Any, U: Any, side: Any) -> Any:
    """Whether a line through the last part of a table is steep, beyond its own standard error."""
    count = max(4, int(_PART * len(z)))
    here = slice(0, count) if side == 0 else slice(-count, None)
    x = z[here] - z[here].mean()
    slope = float(x @ U[here] / (x @ x))
    rest = U[here] - U[here].mean() - slope * x
    error = float(np.sqrt(rest @ rest / (count - 2) / (x @ x)))
    return abs(slope) - 4 * error > _SLOPE * np.ptp(U) / (z[-1] - z[0])


def _no_limit(table: Any, c: Any, below: Any, above: Any, name: Any) -> Any:
    sides = [side for side, open_ in ((0, below), (-1, above)) if open_]
    limits = C.chebval([-1.0, 1.0], c)
    side = max(sides, key=lambda side: abs(table.U[side] - limits[side]))
    return ParameterError(f"{name}: {'top' if side else 'bottom'} = decay, but {table!r} ends at z = "
                          f"{table.z[side]:.6g} with U = {table.U[side]:.4g}, far from where it seems to go "
                          f"({limits[side]:.4g}): a longer table is needed, or a wall or a free edge")
