"""Two-sided inverse iteration with Rayleigh quotient: one mode from a guess, or many wavenumbers at once.

One LU factorisation of A - rate B near an eigenvalue serves both eigenvectors x and y. The two-sided
Rayleigh quotient is then wrong only by the product of their errors, and the pair (y, x) yields

    d sigma / d anything = - y^H (d residual matrix) x / (y^H B x),

hence the slope in k, the truncation error (y against the residual beyond the truncation) and the
rounding error (y against a random rounding of every matrix entry).

Neighbouring wavenumbers share a factorisation M: the iteration x - M^{-1} (A - rate B) x, with the matrices of each
wavenumber and its current quotient, converges to the eigenvector of that wavenumber (Neumaier 1985). Vectors are the
columns of arrays (size, points) here.
"""

from dataclasses import dataclass, fields, replace
from functools import lru_cache

import numpy as np

from .errors import ModeLost
from .stack import square

_EPS = np.finfo(float).eps
_TINY = np.finfo(float).tiny
_FACTORISATIONS = 12
_SWEEPS = 12  # of the shared iteration
_VECTOR = 1e-9  # error of a vector, and so of the slope, that is accepted
_OFFSET = 1e-3  # of a shared factorisation from its rate: it must not be singular


@dataclass(frozen=True)
class Eigen:
    """Eigenvalues of a pencil at several points, arrays (points,) and vectors (points, size), or at a single one.

    `rate` with its `slope` in k; `truncation`, the standard deviation `rounding` and the `spread` from
    uncertain symbols and coefficients, all in units of the rate; `x`, `y` right and left vectors with y^H B x = 1;
    `settled` tells where the quotient is converged to rounding.
    """

    rate: np.ndarray
    slope: np.ndarray
    truncation: np.ndarray
    rounding: np.ndarray
    spread: np.ndarray
    x: np.ndarray
    y: np.ndarray
    settled: np.ndarray

    def split(self):
        """Return the eigenvalues of the points, each on its own."""
        return [Eigen(*values) for values in zip(*(getattr(self, field.name) for field in fields(self)), strict=True)]


def refine(pencil, weights, rate, x=None, y=None, bars=True):
    """Iterate from a `rate` (and vectors (size,), if known) until the quotient has settled; raise ModeLost if not.

    `weights` are those of one point, (parts,); so are all arrays here and in the result, without an axis of points.
    """
    x, y = (_start(pencil.size) if vector is None else vector for vector in (x, y))
    y = y.conj()  # y^H from here on
    for _ in range(_FACTORISATIONS):
        if pencil.real and not np.imag(rate):
            rate, x, y = np.real(rate), x.real, y.real
        factors = _factors(pencil, weights.value, rate)
        x, x_error = _iterate(lambda v, f=factors: f.solve(pencil.b(weights.value, v)), x)
        y, y_error = _iterate(lambda v, f=factors: f.solve_left(pencil.b_left(weights.value, v)), y)
        settled = _settled(x_error, y_error)
        if settled:
            found = _quotient(pencil, weights, x, y, settled, bars)
            return _twice(pencil, weights, found, bars) if factors.uneven else found
        rate = _rate(pencil, weights.value * pencil.stack.brackets(y, pencil.stack.times(x)))
        if not np.isfinite(rate):
            break
    raise ModeLost(f"inverse iteration near rate {complex(rate):.6g} did not settle")


def _twice(pencil, weights, found, bars):
    """The eigenvalue of uneven matrices by steps with the residual too; the difference joins its error.

    Small unknowns beside large ones get few digits from a factorisation alone. Where those steps do not settle, since
    other modes are too near, it stays as it was found.
    """
    (again,) = refine_many(pencil, weights.alone(), np.array([found.rate]), found.x[None], found.y[None],
                           [slice(0, 1)], bars).split()
    return replace(again, spread=again.spread + abs(again.rate - found.rate)) if again.settled else found


@lru_cache(maxsize=32)
def _start(size):
    """Where to start without a better guess: a random vector (size,)."""
    return np.random.default_rng(1).standard_normal(size)


def refine_many(pencil, weights, rate, x, y, groups, bars=True):
    """Refine good guesses of rates (points,) and vectors (points, size) at many points, whose `weights` are given.

    `groups` are slices of neighbouring points: each shares the factorisation of its middle. Without `bars` the
    rounding is left at 0: a rough look does not need it.
    """
    x, y = x.T, y.conj().T
    if pencil.real and not np.any(np.imag(rate)):
        rate, x, y = rate.real, x.real, y.real
    x, y = np.ascontiguousarray(x), np.ascontiguousarray(y)
    middles = [(group.start + group.stop) // 2 for group in groups]
    factors = [_factors(pencil, weights.value[:, i], rate[i] * (1 + _OFFSET)) for i in middles]
    project = _Projection(pencil, weights.value[:, middles], x[:, middles], y[:, middles])
    stack, x_change, y_change = pencil.stack, np.zeros(len(rate)), np.zeros(len(rate))
    for _ in range(_SWEEPS):
        products = stack.times(x)
        rate = _rate(pencil, weights.value * stack.brackets(y, products))
        spread = stack.spread(weights.value * pencil.powers(rate))
        right, left = stack.total(spread, products), stack.total_left(spread, y)
        solved = [project(i, f.solve(right[:, group]), f.solve_left(left[:, group]))
                  for i, (f, group) in enumerate(zip(factors, groups, strict=True))]
        dx, dy = (np.concatenate(parts, axis=1) for parts in zip(*solved, strict=True))
        x, y = x - dx, y - dy
        x_change, x_error = _converging(dx, x, x_change)
        y_change, y_error = _converging(dy, y, y_change)
        settled = _settled(x_error, y_error)
        if np.all(settled):
            break
    return _quotient(pencil, weights, x, y, settled, bars)


class _Projection:
    """Takes out of steps what lies along the eigenvectors x, y (size, groups) of the middles of groups.

    The shared factorisations are nearly singular, and a step with them is mostly that: a change of scale.
    """

    def __init__(self, pencil, weights, x, y):
        self._bx, self._by = pencil.b(weights, x), pencil.b_left(weights, y)
        norm = (self._by * x).sum(axis=0)
        self._x, self._y = x / norm, y / norm

    def __call__(self, group, dx, dy):
        along_x, along_y = self._by[:, group] @ dx, self._bx[:, group] @ dy
        return dx - np.outer(self._x[:, group], along_x), dy - np.outer(self._y[:, group], along_y)


def _factors(pencil, weights, rate):
    for _ in range(3):
        try:
            return pencil.factors(weights, rate)
        except np.linalg.LinAlgError:  # the rate is an eigenvalue to the last bit
            rate = rate * (1 + 4 * _EPS) + _TINY
    raise ModeLost(f"the equations are singular near the rate {complex(rate):.6g}")


def _iterate(step, vector):
    """Two inverse iterations with one factorisation; return the vector and an estimate of its error.

    Vectors are scaled by one component. The second step shrinks what the first one changed by the
    ratio of the distances to the wanted and the next eigenvalue, and so will the next.
    """
    pivot = np.argmax(np.abs(vector))
    start, first = (v / v[pivot] for v in (vector, step(vector)))
    second = step(first)
    second = second / second[pivot]
    change, error = _converging(second - first, second, _size(first - start) / _size(second))
    return second, error


def _converging(step, vectors, before):
    """Relative length of the last step, and the error left, given the length of the step before."""
    change = _size(step) / _size(vectors)
    return change, change**2 / np.maximum(np.maximum(change, before), _TINY) + _EPS


def _settled(x_error, y_error):
    """Whether the quotient of two vectors with these errors is right to rounding, and its slope nearly so."""
    return (x_error * y_error < 0.1 * _EPS) & (np.maximum(x_error, y_error) < _VECTOR)


def _size(vectors):
    return np.sqrt(square(vectors).sum(axis=0))


def _rate(pencil, value):
    """Rayleigh quotients from the brackets of all parts (parts, points)."""
    return -value[: pencil.first_b].sum(axis=0) / value[pencil.first_b:].sum(axis=0)


def _quotient(pencil, weights, x, y, settled, bars):
    """Rayleigh quotients of the pairs (y^H, x), (size, points) or of one (size,), with slope in k and errors."""
    stack, first = pencil.stack, pencil.first_b
    products = stack.times(x)
    brackets = stack.brackets(y, products)
    value = weights.value * brackets
    norm = -value[first:].sum(axis=0)  # y B x
    rate = value[:first].sum(axis=0) / norm
    power = pencil.powers(rate)
    y = y / norm
    slope = (weights.slope * brackets * power).sum(axis=0) / norm
    spread = (weights.spread * np.abs(brackets * power)).sum(axis=0) / np.abs(norm)
    if pencil.cuts:
        spread += pencil.cut(weights.value * power, y, x)
    variance = np.zeros(norm.shape)
    if bars:
        variance += (square(weights.value * power) * stack.squares(y, x)).sum(axis=0)  # of matrix entries
        variance += square(value * power).sum(axis=0) / square(norm)  # of the weights, common to a part
    tail = np.abs(pencil.tail.total(pencil.tail.spread(weights.value * power), pencil.tail.times(x)))
    beyond = tail.reshape(len(pencil.last), -1, *norm.shape).sum(axis=1)
    truncation = (beyond * np.abs(y[pencil.last]).max(axis=1)).sum(axis=0)
    vectors = (np.ascontiguousarray(rows.T) for rows in (x, y.conj()))
    return Eigen(rate, slope, truncation, _EPS * np.sqrt(variance), spread, *vectors, settled)
