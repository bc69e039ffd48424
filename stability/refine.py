"""Two-sided inverse iteration with Rayleigh quotient, for many wavenumbers of one pencil at once.

One LU factorisation of A - rate B near an eigenvalue serves both eigenvectors x and y. The two-sided
Rayleigh quotient is then wrong only by the product of their errors, and the pair (y, x) yields

    d sigma / d anything = - y^H (d residual matrix) x / (y^H B x),

hence the slope in k, the truncation error (y against the residual beyond the truncation) and the
rounding error (y against a random rounding of every matrix entry). Arrays lead with the axis of points.
"""

from dataclasses import dataclass, fields

import numpy as np

from .bordered import Factors
from .errors import ModeLost

_EPS = np.finfo(float).eps
_TINY = np.finfo(float).tiny
_FACTORISATIONS = 12


@dataclass(frozen=True)
class Eigen:
    """Eigenvalues of a pencil at several points: arrays (points,), vectors (points, size).

    `rate` with its `slope` in k; `truncation`, the standard deviation `rounding` and the `spread` from
    uncertain symbols, all in units of the rate; `x`, `y` right and left vectors with y^H B x = 1, and
    `bx` = B x, `by` = y^H B; `settled` tells where the quotient is converged to rounding.
    """

    rate: np.ndarray
    slope: np.ndarray
    truncation: np.ndarray
    rounding: np.ndarray
    spread: np.ndarray
    x: np.ndarray
    y: np.ndarray
    bx: np.ndarray
    by: np.ndarray
    settled: np.ndarray

    def at(self, index):
        """Return the eigenvalue of one point."""
        return Eigen(*(getattr(self, field.name)[index] for field in fields(self)))


def refine(pencil, weights, rate, x=None, y=None, bars=True):
    """Iterate from one `rate` (and vectors (size,), if known) until the quotient has settled; raise ModeLost if not."""
    start = np.random.default_rng(1).standard_normal(pencil.size)
    x, y, rate = (np.array([value]) for value in (start if x is None else x, start if y is None else y, rate))
    for _ in range(_FACTORISATIONS):
        eigen = refine_many(pencil, weights, rate, x, y, bars)
        if not np.isfinite(eigen.rate[0]):
            break
        if eigen.settled[0]:
            return eigen.at(0)
        rate, x, y = eigen.rate, eigen.x, eigen.y
    raise ModeLost(f"inverse iteration near rate {complex(rate[0]):.6g} did not settle")


def refine_many(pencil, weights, rate, x, y, bars=True):
    """Refine eigenvalues at many points with one factorisation each; `weights` are those of the points.

    Without `bars` the rounding is left at 0: a rough look does not need it.
    """
    y = y.conj()  # y^H, row vectors, from here on
    if pencil.real and not np.any(np.imag(rate)):
        rate, x, y = rate.real, x.real, y.real
    b = pencil.b(weights)
    factors = _factors(pencil, weights, rate)
    x, x_error = _iterate(lambda rows: factors.solve(b @ rows), x)
    y, y_error = _iterate(lambda rows: factors.solve_left(rows @ b), y)
    settled = (x_error * y_error < 0.1 * _EPS) & (np.maximum(x_error, y_error) < 1e-6)
    return _quotient(pencil, weights, x, y, b, settled, bars)


def _factors(pencil, weights, rate):
    for _ in range(3):
        try:
            return Factors(pencil.shifted(weights, rate))
        except np.linalg.LinAlgError:  # a rate is an eigenvalue to the last bit
            rate = rate * (1 + 4 * _EPS) + _TINY
    raise ModeLost(f"the equations are singular near the rates {complex(rate.min()):.6g} .. {complex(rate.max()):.6g}")


def _iterate(step, vectors):
    """Two inverse iterations with one factorisation; return the vectors and an estimate of their errors.

    Vectors are scaled by one component. The second step shrinks what the first one changed by the
    ratio of the distances to the wanted and the next eigenvalue, and so will the next.
    """
    points = np.arange(len(vectors))
    pivot = np.argmax(np.abs(vectors), axis=1)
    start, first = (rows / rows[points, pivot, None] for rows in (vectors, step(vectors)))
    second = step(first)
    second = second / second[points, pivot, None]
    change = _norm(second - first)
    ratio = change / (_norm(first - start) + _TINY)
    return second, np.minimum(1.0, ratio) * change / _norm(second) + _EPS


def _norm(rows):
    return np.sqrt((np.abs(rows) ** 2).sum(axis=1))


def _quotient(pencil, weights, x, y, b, settled, bars):
    """Rayleigh quotients of the pairs (y row vectors), with slope in k and errors."""
    first = pencil.first_b
    c = (pencil.matrices.left_all(y) * x[:, None]).sum(axis=2)  # (points, parts)
    value = weights.value * c
    norm = -value[:, first:].sum(axis=1)  # y B x
    rate = value[:, :first].sum(axis=1) / norm
    power = pencil.powers(rate)
    y = y / norm[:, None]
    slope = (weights.slope * c * power).sum(axis=1) / norm
    spread = (weights.spread * np.abs(c * power)).sum(axis=1) / np.abs(norm)
    variance = np.zeros(len(x))
    if bars:
        entries = pencil.squares.combine(np.abs(weights.value * power) ** 2)
        variance += (entries.left(np.abs(y) ** 2) * np.abs(x) ** 2).sum(axis=1)  # of matrix entries
        variance += (np.abs(value * power) ** 2).sum(axis=1) / np.abs(norm) ** 2  # of the weights, common to a part
    beyond = np.abs(pencil.beyond(weights.value * power, x)).reshape(len(x), len(pencil.last), -1).sum(axis=2)
    truncation = (beyond * np.abs(y[:, pencil.last]).max(axis=2)).sum(axis=1)
    return Eigen(rate, slope, truncation, _EPS * np.sqrt(variance), spread, x, y.conj(), b @ x, y @ b, settled)
