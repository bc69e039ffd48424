"""Two-sided inverse iteration with Rayleigh quotient: one mode from a guess, or many wavenumbers at once.

One LU factorisation of A - rate B near an eigenvalue serves both eigenvectors x and y. The two-sided
Rayleigh quotient is then wrong only by the product of their errors, and the pair (y, x) yields

    d sigma / d anything = - y^H (d residual matrix) x / (y^H B x),

hence the slope in k, the truncation error (y against the residual beyond the truncation) and the
rounding error (y against a random rounding of every matrix entry).

At many wavenumbers each has its own factorisation and all else is done together: vectors are the columns of arrays
(size, points) then, and plain (size,) at one.
"""

from functools import lru_cache
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..errors import ModeLost
from .arithmetic import size_of

if TYPE_CHECKING:
    from .arithmetic import Iterated

_EPS = np.finfo(float).eps
_TINY = np.finfo(float).tiny
_FACTORISATIONS = 12
_ROUNDS = 3  # of factorisations at many points
_CORRECTIONS = 12
VECTOR = 1e-9  # error of a vector, and so of the slope, that is accepted
_ALONE = 80, 40  # degree from which on a single eigenvalue is sought in what is condensed of a pencil: that takes a
# while, and pays where vectors are to be so accurate that several factorisations are likely
_sum = np.add.reduce  # over the parts
_OFFSET = 1e-3  # of a factorisation for corrections from its rate: it must not be singular


class Eigen(NamedTuple):
    """Eigenvalues of a pencil at several points, arrays (points,) and vectors (points, size), or at a single one.

    `rate` with its `slope` in k, `scatter` being what the last step of the vectors did to that and `left` what steps to
    come would do; `truncation`, the standard deviation `rounding` and the `spread` from uncertain symbols and
    coefficients, all in units of the rate; `x`, `y` right and left vectors with y^H B x = 1; `settled` tells where the
    quotient is converged to rounding.
    """

    rate: Any  # complex or real, an array or a number: as all numbers of it
    slope: Any
    truncation: np.ndarray
    rounding: np.ndarray
    spread: np.ndarray
    scatter: np.ndarray
    left: np.ndarray
    x: np.ndarray
    y: np.ndarray
    settled: np.ndarray

    def widened(self, by: Any) -> "Eigen":
        """Return the same with a larger spread."""
        return self._replace(spread=self.spread + by)

    def split(self) -> "list[Eigen]":
        """Return the eigenvalues of the points, each on its own."""
        columns = [values.tolist() if values.ndim == 1 else values for values in self]  # plain numbers are cheaper
        return [Eigen(*values) for values in zip(*columns, strict=True)]


def refine(pencil: Any, weights: Any, rate: complex, x: np.ndarray | None = None, y: np.ndarray | None = None,
           bars: bool = True, accuracy: float = VECTOR) -> "Eigen":
    """Iterate from a `rate` (and vectors (size,), if known) until the quotient has settled; raise ModeLost if not.

    `weights` are those of one point, (parts,); so are all arrays in the result, without an axis of points. Vectors are
    wrong by `accuracy` at most, the rate by its square: less is right for a rough look.
    """
    x, y = (_start(pencil.size) if vector is None else vector for vector in (x, y))
    pays = pencil.degree >= _ALONE[accuracy < VECTOR]
    inner, own, x, y = _inside(pencil.condensed if pays else None, pencil, weights, x, y.conj())
    arithmetic = inner.arithmetic
    for _ in range(_FACTORISATIONS):
        if pencil.real and not np.imag(rate):
            rate, x, y = np.real(rate), x.real, y.real
        last = arithmetic.iterate(own, rate, x, y, accuracy)
        x, y = last.vectors
        shares, settled = _judged(last, accuracy)
        if settled:
            inside = None if inner is pencil else (inner, rate + 1 / last.ahead)
            found = _quotient(pencil, weights, x, y, last.steps, shares, settled, bars, inside)
            return _twice(pencil, weights, found, bars) if last.uneven else found
        rate = _rate(inner, own * arithmetic.brackets(x, y))
        if not np.isfinite(rate):
            break
    raise ModeLost(f"inverse iteration near rate {complex(rate):.6g} did not settle")


def refine_many(pencil: Any, weights: Any, rate: np.ndarray | None, x: np.ndarray, y: np.ndarray, bars: bool = True,
                accuracy: float = VECTOR) -> "Eigen":
    """Refine good guesses of rates (points,) and vectors (points, size) at many points, whose `weights` are given.

    Without `bars` the rounding is left at 0: a rough look does not need it. Without a rate the quotient of the vectors
    is the guess.
    """
    inner, own, x, y = _inside(pencil.iterated(len(x)), pencil, weights, x.T, y.conj().T)
    arithmetic = inner.arithmetic
    if rate is None:
        rate = _rate(inner, own * arithmetic.brackets(x, y))
    if pencil.real and not np.any(np.imag(rate)):
        rate, x, y = rate.real, x.real, y.real
    x, y = (np.ascontiguousarray(vectors, np.result_type(vectors, rate)) for vectors in (x, y))
    steps, shares = (np.zeros_like(x), np.zeros_like(y)), np.zeros((2, len(rate)))
    settled, left = np.zeros(len(rate), bool), np.arange(len(rate))
    found = np.array(rate, x.dtype)
    for _ in range(_ROUNDS):
        last = arithmetic.iterate(own[:, left], rate[left], x[:, left], y[:, left], accuracy)
        parts, settled[left] = _judged(last, accuracy)
        if inner is not pencil:
            found[left] = rate[left] + 1 / last.ahead
        for whole, part in zip((x, y, *steps, shares), (*last.vectors, *last.steps, parts), strict=True):
            whole[..., left] = part
        settled[left] &= ~last.uneven
        left = left[~settled[left] & ~last.uneven]
        if not len(left):
            break
        rate = _rate(inner, own * arithmetic.brackets(x, y))
    return _quotient(pencil, weights, x, y, steps, shares, settled, bars, None if inner is pencil else (inner, found))


def quotient(pencil: Any, weights: Any, x: np.ndarray, y: np.ndarray) -> complex:
    """The Rayleigh quotient of vectors x, y (size,) at one point: with those of a mode of nearly the same pencil it is
    the rate to first order in the difference."""
    return _rate(pencil, weights.value * pencil.arithmetic.brackets(x, y.conj()))


def _inside(condensed: Any, pencil: Any, weights: Any, x: np.ndarray, y: np.ndarray) -> tuple[Any, ...]:
    """Where iterations take place, the pencil or what is `condensed` of it, with values of its weights and the vectors
    there."""
    if condensed is None:
        return pencil, weights.value, x, y
    return condensed, condensed.weights(weights.value), *condensed.restricted(x, y)


def _judged(last: "Iterated", accuracy: float) -> tuple[Any, ...]:
    """The shares (2, ...) of the last steps of both vectors that steps to come would make, and whether the quotient is
    settled.

    The second step shrinks what the first one changed by the ratio of the distances to the wanted and the next
    eigenvalue, and so will the next.
    """
    first, step, size = last.sizes
    change, error = _converging(step / size, first / size)
    return error / np.maximum(change, _TINY), _settled(error[0], error[1], accuracy)


def _twice(pencil: Any, weights: Any, found: "Eigen", bars: bool) -> "Eigen":
    """The eigenvalue of uneven matrices by steps with the residual too; the difference joins its error.

    Small unknowns beside large ones get few digits from a factorisation alone. Where those steps do not settle, since
    other modes are too near, it stays as it was found.
    """
    again = _corrected(pencil, weights, found, bars)
    return again.widened(abs(again.rate - found.rate)) if again.settled else found


def _corrected(pencil: Any, weights: Any, found: "Eigen", bars: bool) -> "Eigen":
    """The eigenvalue by the iteration x - M^{-1} (A - rate B) x with one factorisation M near it (Neumaier 1985).

    M is nearly singular and a step with it mostly lies along the eigenvector: a change of scale, which is taken out.
    """
    value, stack, rate, x, y = weights.value, pencil.stack, found.rate, found.x, found.y.conj()
    if pencil.real and not np.imag(rate):
        rate, x, y = np.real(rate), x.real, y.real
    factors = pencil.arithmetic.factors(value, rate * (1 + _OFFSET))
    bx, by = (product(vector) for product, vector in zip(pencil.b_products(value), (x, y), strict=True))
    along_x, along_y = x / (by @ x), y / (by @ x)
    x_change = y_change = x_error = y_error = 0.0
    for _ in range(_CORRECTIONS):
        products = stack.times(x)
        rate = _rate(pencil, value * stack.brackets(y, products))
        spread = stack.spread(value * pencil.powers(rate))
        dx, dy = factors.solve(stack.total(spread, products)), factors.solve_left(stack.total_left(spread, y))
        dx, dy = dx - along_x * (by @ dx), dy - along_y * (bx @ dy)
        x, y = x - dx, y - dy
        x_change, x_error = _converging(size_of(dx) / size_of(x), x_change)
        y_change, y_error = _converging(size_of(dy) / size_of(y), y_change)
        settled = _settled(x_error, y_error)
        if settled:
            break
    shares = np.array([x_error / max(x_change, _TINY), y_error / max(y_change, _TINY)])
    return _quotient(pencil, weights, x, y, (dx, dy), shares, settled, bars)


@lru_cache(maxsize=32)
def _start(size: int) -> np.ndarray:
    """Where to start without a better guess: a random vector (size,)."""
    return np.random.default_rng(1).standard_normal(size)


def _converging(change: Any, before: Any) -> tuple[Any, ...]:
    """Relative length of the last step, and the error left, given the length of the step before."""
    return change, change**2 / np.maximum(np.maximum(change, before), _TINY) + _EPS


def _settled(x_error: Any, y_error: Any, accuracy: float = VECTOR) -> Any:
    """Whether two vectors with these errors are right to `accuracy`: their quotient then is to its square."""
    return np.maximum(x_error, y_error) < accuracy


def _rate(pencil: Any, value: np.ndarray) -> Any:
    """Rayleigh quotients from the brackets of all parts (parts, points)."""
    return -_sum(value[: pencil.first_b]) / _sum(value[pencil.first_b:])


def _quotient(pencil: Any, weights: Any, x: np.ndarray, y: np.ndarray, steps: Any, shares: Any, settled: Any,
              bars: bool, inside: Any = None) -> "Eigen":
    """Rayleigh quotients of the pairs (y^H, x), (size, points) or of one (size,), with slope in k and errors.

    `steps` are the last ones of both vectors, with the `shares` of them that steps to come would make. With `inside`,
    what is condensed of the pencil and rates that are right but for the error of one vector, all are those of that.
    """
    arithmetic, squares = pencil.arithmetic, None
    if inside:
        inner, rate = inside
        own = weights.value * pencil.powers(rate)
        x, y = inner.continued(own, x, y)
        steps = inner.continued(own, *steps) if bars else ()
    brackets, squares = arithmetic.changes(x, y, *steps) if bars else (arithmetic.brackets(x, y)[None], None)
    rate, norm, slope, change = _slopes(weights, brackets, pencil.layout.sides)
    power, size = pencil.powers(rate), abs(norm)
    y, weighted = y / norm, weights.value * power
    spread = _sum(weights.spread * abs(brackets[0] * power)) / size
    if bars and pencil.cuts:
        spread += pencil.cut(weighted, y, x)
    scatter = left = rounding = np.zeros(norm.shape)
    if bars:
        scatter, left = _sum(change), _sum(shares * change)
        variance = abs(weighted) ** 2 * (squares + abs(brackets[0]) ** 2)  # of entries, of weights common to a part
        rounding = _EPS * np.sqrt(_sum(variance)) / size
    tail = abs(arithmetic.beyond(weighted, x)).reshape(len(pencil.last), -1, *norm.shape)
    truncation = _sum(tail.sum(axis=1) * abs(y[pencil.last]).max(axis=1))
    right, adjoint = (np.ascontiguousarray(rows.T) for rows in (x, y.conj()))
    return Eigen(rate, slope, truncation, rounding, spread, scatter, left, right, adjoint, settled)


def _slopes(weights: Any, brackets: np.ndarray, sides: np.ndarray) -> tuple[Any, ...]:
    """The rate, y B x, the slope s and what steps of the vectors do to that, None without any.

    `brackets` (1 or 3, parts, ...) are those of x and y, of dx and y, and of x and dy. The slope is
    s = y L' x / (y B x), where L' is the derivative of A - rate B in k at a fixed rate: a change of x by dx makes
    ds = y (L' - s B) dx / (y B x), and one of y the same from the left. The rate does not change, to first order.
    """
    products = np.array((weights.value, weights.slope))[:, None] * brackets
    of_value, of_slope = np.add.reduceat(products, sides, axis=2)  # sums over the parts of A, of -B
    norm = -of_value[0, 1]  # y B x
    rate = of_value[0, 0] / norm
    slopes = (of_slope[:, 0] + rate * of_slope[:, 1]) / norm
    change = abs(slopes[1:] + slopes[0] * of_value[1:, 1] / norm) if len(slopes) > 1 else None
    return rate, norm, slopes[0], change
