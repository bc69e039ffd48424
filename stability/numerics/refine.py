"""Two-sided inverse iteration with Rayleigh quotient: one mode from a guess, or many wavenumbers at once.

One LU factorisation of A - rate B near an eigenvalue serves both eigenvectors x and y. The two-sided
Rayleigh quotient is then wrong only by the product of their errors, and the pair (y, x) yields

    d sigma / d anything = - y^H (d residual matrix) x / (y^H B x),

hence the slope in k, the truncation error (y against the residual beyond the truncation) and the
rounding error (y against a random rounding of every matrix entry).

At many wavenumbers each has its own factorisation and all else is done together: vectors are the columns of arrays
(size, points) then, and plain (size,) at one.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, fields, replace
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import ModeLost
from .stack import square

if TYPE_CHECKING:
    from .bordered import Factors

_EPS = np.finfo(float).eps
_TINY = np.finfo(float).tiny
_FACTORISATIONS = 12
_ROUNDS = 3  # of factorisations at many points
_CORRECTIONS = 12
VECTOR = 1e-9  # error of a vector, and so of the slope, that is accepted
_OFFSET = 1e-3  # of a factorisation for corrections from its rate: it must not be singular


@dataclass(frozen=True, slots=True)
class Eigen:
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

    def split(self) -> "list[Eigen]":
        """Return the eigenvalues of the points, each on its own."""
        columns = {field.name: getattr(self, field.name) for field in fields(self)}
        columns |= {name: columns[name].tolist() for name in ("truncation", "rounding", "spread", "settled")}  # cheaper
        return [Eigen(*values) for values in zip(*columns.values(), strict=True)]


def refine(pencil: Any, weights: Any, rate: complex, x: np.ndarray | None = None, y: np.ndarray | None = None,
           bars: bool = True, accuracy: float = VECTOR) -> "Eigen":
    """Iterate from a `rate` (and vectors (size,), if known) until the quotient has settled; raise ModeLost if not.

    `weights` are those of one point, (parts,); so are all arrays in the result, without an axis of points. Vectors are
    wrong by `accuracy` at most, the rate by its square: less is right for a rough look.
    """
    x, y = (_start(pencil.size) if vector is None else vector for vector in (x, y))
    y, b = y.conj(), pencil.b_products(weights.value)  # y^H from here on
    for _ in range(_FACTORISATIONS):
        if pencil.real and not np.imag(rate):
            rate, x, y = np.real(rate), x.real, y.real
        factors = _factors(pencil, weights.value, rate)
        x, y, steps, settled = _iterate(b, factors, x, y, accuracy)
        if settled:
            found = _quotient(pencil, weights, x, y, steps, settled, bars)
            return _twice(pencil, weights, found, bars) if factors.uneven else found
        rate = _rate(pencil, weights.value * pencil.stack.brackets(y, pencil.stack.times(x)))
        if not np.isfinite(rate):
            break
    raise ModeLost(f"inverse iteration near rate {complex(rate):.6g} did not settle")


def refine_many(pencil: Any, weights: Any, rate: np.ndarray | None, x: np.ndarray, y: np.ndarray, bars: bool = True,
                accuracy: float = VECTOR) -> "Eigen":
    """Refine good guesses of rates (points,) and vectors (points, size) at many points, whose `weights` are given.

    Without `bars` the rounding is left at 0: a rough look does not need it. Without a rate the quotient of the vectors
    is the guess.
    """
    x, y = x.T, y.conj().T
    if rate is None:
        rate = _rate(pencil, weights.value * pencil.stack.brackets(y, pencil.stack.times(x)))
    if pencil.real and not np.any(np.imag(rate)):
        rate, x, y = rate.real, x.real, y.real
    x, y = (np.ascontiguousarray(vectors, np.result_type(vectors, rate)) for vectors in (x, y))
    steps = [(np.zeros_like(vectors), np.zeros(len(rate))) for vectors in (x, y)]
    settled, left = np.zeros(len(rate), bool), np.arange(len(rate))
    for _ in range(_ROUNDS):
        value = weights.value[:, left]
        factors = pencil.factors(value, rate[left])
        x[:, left], y[:, left], last, settled[left] = _iterate(
            pencil.b_products(value), factors, x[:, left], y[:, left], accuracy)
        for (step, share), (new, part) in zip(steps, last, strict=True):
            step[:, left], share[left] = new, part
        settled[left] &= ~factors.uneven
        rate = _rate(pencil, weights.value * pencil.stack.brackets(y, pencil.stack.times(x)))
        left = left[~settled[left] & ~factors.uneven]
        if not len(left):
            break
    return _quotient(pencil, weights, x, y, steps, settled, bars)


def _iterate(b: tuple[Callable[..., Any], ...], factors: Any, x: np.ndarray, y: np.ndarray,
             accuracy: float) -> tuple[Any, ...]:
    """Two inverse iterations from either side; return vectors, their last steps, and whether the quotient is settled.

    `b` are the products with B from the right and from the left.
    """
    x, x_step, x_error = _iterated(b[0], factors.solve, x)
    y, y_step, y_error = _iterated(b[1], factors.solve_left, y)
    return x, y, (x_step, y_step), _settled(x_error, y_error, accuracy)


def _iterated(b: Callable[..., Any], solve: Callable[..., Any], vector: np.ndarray) -> tuple[Any, ...]:
    """Two inverse iterations with one factorisation; return the vector, the last step, and an estimate of the error.

    The step comes with the share of it that steps to come would make.

    Vectors are scaled by one component. The second step shrinks what the first one changed by the
    ratio of the distances to the wanted and the next eigenvalue, and so will the next.
    """
    pivot = np.abs(vector).argmax(axis=0)
    if vector.ndim > 1:
        pivot = pivot, np.arange(vector.shape[1])
    first = solve(b(vector))
    start, first = vector * (1 / vector[pivot]), first * (1 / first[pivot])
    second = solve(b(first))
    second = second * (1 / second[pivot])
    last = second - first
    change, error = _converging(last, second, _size(first - start) / _size(second))
    return second, (last, error / np.maximum(change, _TINY)), error


def _twice(pencil: Any, weights: Any, found: "Eigen", bars: bool) -> "Eigen":
    """The eigenvalue of uneven matrices by steps with the residual too; the difference joins its error.

    Small unknowns beside large ones get few digits from a factorisation alone. Where those steps do not settle, since
    other modes are too near, it stays as it was found.
    """
    again = _corrected(pencil, weights, found, bars)
    return replace(again, spread=again.spread + abs(again.rate - found.rate)) if again.settled else found


def _corrected(pencil: Any, weights: Any, found: "Eigen", bars: bool) -> "Eigen":
    """The eigenvalue by the iteration x - M^{-1} (A - rate B) x with one factorisation M near it (Neumaier 1985).

    M is nearly singular and a step with it mostly lies along the eigenvector: a change of scale, which is taken out.
    """
    value, stack, rate, x, y = weights.value, pencil.stack, found.rate, found.x, found.y.conj()
    if pencil.real and not np.imag(rate):
        rate, x, y = np.real(rate), x.real, y.real
    factors = _factors(pencil, value, rate * (1 + _OFFSET))
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
        x_change, x_error = _converging(dx, x, x_change)
        y_change, y_error = _converging(dy, y, y_change)
        settled = _settled(x_error, y_error)
        if settled:
            break
    steps = (dx, x_error / max(x_change, _TINY)), (dy, y_error / max(y_change, _TINY))
    return _quotient(pencil, weights, x, y, steps, settled, bars)


@lru_cache(maxsize=32)
def _start(size: int) -> np.ndarray:
    """Where to start without a better guess: a random vector (size,)."""
    return np.random.default_rng(1).standard_normal(size)


def _factors(pencil: Any, weights: np.ndarray, rate: Any) -> "Factors":
    for _ in range(3):
        try:
            return pencil.factors(weights, rate)
        except np.linalg.LinAlgError:  # the rate is an eigenvalue to the last bit
            rate = rate * (1 + 4 * _EPS) + _TINY
    raise ModeLost(f"the equations are singular near the rate {complex(rate):.6g}")


def _converging(step: np.ndarray, vectors: np.ndarray, before: Any) -> tuple[Any, ...]:
    """Relative length of the last step, and the error left, given the length of the step before."""
    change = _size(step) / _size(vectors)
    return change, change**2 / np.maximum(np.maximum(change, before), _TINY) + _EPS


def _settled(x_error: Any, y_error: Any, accuracy: float = VECTOR) -> Any:
    """Whether two vectors with these errors are right to `accuracy`: their quotient then is to its square."""
    return np.maximum(x_error, y_error) < accuracy


def _size(vectors: np.ndarray) -> Any:
    return np.sqrt(square(vectors).sum(axis=0) if vectors.ndim > 1 else np.vdot(vectors, vectors).real)


def _rate(pencil: Any, value: np.ndarray) -> Any:
    """Rayleigh quotients from the brackets of all parts (parts, points)."""
    return -value[: pencil.first_b].sum(axis=0) / value[pencil.first_b:].sum(axis=0)


def _quotient(pencil: Any, weights: Any, x: np.ndarray, y: np.ndarray, steps: Any, settled: Any, bars: bool) -> "Eigen":
    """Rayleigh quotients of the pairs (y^H, x), (size, points) or of one (size,), with slope in k and errors.

    `steps` are the last ones of both vectors, with the shares of them that steps to come would make.
    """
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
    variance, scatter, left = (np.zeros(norm.shape) for _ in range(3))
    if bars:
        for (_, share), change in zip(steps, _changes(pencil, weights, slope, power, (y, products), (
                steps[0][0], steps[1][0] / norm)), strict=True):
            scatter, left = scatter + change, left + share * change
        variance += stack.squares(weights.value * power, y, x)  # of matrix entries
        variance += square(value * power).sum(axis=0) / square(norm)  # of the weights, common to a part
    tail = np.abs(pencil.tail.total(pencil.tail.spread(weights.value * power), pencil.tail.times(x)))
    beyond = tail.reshape(len(pencil.last), -1, *norm.shape).sum(axis=1)
    truncation = (beyond * np.abs(y[pencil.last]).max(axis=1)).sum(axis=0)
    right, adjoint = (np.ascontiguousarray(rows.T) for rows in (x, y.conj()))
    return Eigen(rate, slope, truncation, _EPS * np.sqrt(variance), spread, scatter, left, right, adjoint, settled)


def _changes(pencil: Any, weights: Any, slope: Any, power: Any, pair: Any, steps: Any) -> Iterator[Any]:
    """Yield what steps dx and dy of the vectors of a `pair` (y, products with x), y B x = 1, do to the slope in k.

    With s = y L' x / (y B x), where L' is the derivative of A - rate B in k at a fixed rate, a change of x by dx makes
    ds = y (L' - s B) dx, and one of y the same from the left. The rate does not change, to first order.
    """
    (y, products), (dx, dy), stack = pair, steps, pencil.stack
    for brackets in (stack.brackets(y, stack.times(dx)), stack.brackets(dy, products)):
        shift = (weights.value * brackets)[pencil.first_b:].sum(axis=0)  # -y B dx
        yield np.abs((weights.slope * brackets * power).sum(axis=0) + slope * shift)
