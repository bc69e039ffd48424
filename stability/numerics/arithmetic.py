"""What refining an eigenvalue takes of a pencil: inverse iterations from either side, and products of its parts.

`refine` says what is iterated and judges it; how the numbers come about is said here, with numpy and scipy, and in
`kernel`, compiled. Vectors are arrays (size,) at one point and (size, points) at many, weights (parts,) and
(parts, points), rates numbers and (points,). A left vector is y^H.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..errors import ModeLost
from .stack import square

_EPS = np.finfo(float).eps
_TINY = np.finfo(float).tiny
_OFF = 0.0, 4 * _EPS, 64 * _EPS, 1024 * _EPS  # relative distances from a rate at which its matrix is factorised


@dataclass(slots=True)
class Iterated:
    """Right and left `vectors` after two inverse iterations, or four, and their last `steps`.

    `sizes` (3, 2, ...) are those of the last step but one, the last step and the vector of either. Vectors are scaled
    by one component. `uneven` tells where the matrix needs scales: at many points nothing holds there. The eigenvalue
    less the rate is the inverse of `ahead`, by which the last iteration has made that component larger; None where
    nobody asks for it.
    """

    vectors: tuple[np.ndarray, ...]
    steps: tuple[np.ndarray, ...]
    sizes: np.ndarray
    uneven: Any
    ahead: Any = None

    @property
    def arrays(self) -> tuple[np.ndarray, ...]:
        """All that iterating once more makes anew at many points."""
        return *self.vectors, *self.steps, self.sizes, self.ahead


class Arithmetic:
    """The numbers of one `pencil`, with numpy and scipy: all points at once."""

    def __init__(self, pencil: Any) -> None:
        self._pencil = pencil

    def iterate(self, weights: np.ndarray, rate: Any, x: np.ndarray, y: np.ndarray, accuracy: float) -> "Iterated":
        """Two inverse iterations from either side with one factorisation of A - rate B, and two more with the same one
        where those are about to make the vectors as accurate as they shall be.

        At one point raises ModeLost where it stays singular, however slightly the rate is changed.
        """
        factors = self._pencil.factors(weights, rate) if np.ndim(rate) else self.factors(weights, rate)
        last = self._iterated(factors, weights, x, y)
        lacking = nearly(last.sizes, accuracy)
        if not np.any(lacking):
            return last
        if np.all(lacking):
            return self._iterated(factors, weights, *last.vectors)
        again = self._iterated(factors.at(lacking), weights[:, lacking], *(one[:, lacking] for one in last.vectors))
        for whole, part in zip(last.arrays, again.arrays, strict=True):
            whole[..., lacking] = part
        return last

    def _iterated(self, factors: Any, weights: np.ndarray, x: np.ndarray, y: np.ndarray) -> "Iterated":
        """Two inverse iterations from either side."""
        right, left = self._pencil.b_products(weights)
        x, dx, x_sizes, ahead = _iterated(right, factors.solve, x)
        y, dy, y_sizes, _ = _iterated(left, factors.solve_left, y)
        return Iterated((x, y), (dx, dy), np.array((x_sizes, y_sizes)).swapaxes(0, 1), factors.uneven, ahead)

    def factors(self, weights: np.ndarray, rate: Any) -> Any:
        """LU factors of A - rate B at one point, next to the rate where that is an eigenvalue to the last bits."""
        for off in _OFF:
            try:
                return self._pencil.factors(weights, rate * (1 + off) + _TINY * bool(off))
            except np.linalg.LinAlgError:
                continue
        raise ModeLost(f"the equations are singular near the rate {complex(rate):.6g}")

    def brackets(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """y^T part x for every part: (parts,) or (parts, points)."""
        return self.pairs(x, y)[0]

    def pairs(self, x: np.ndarray, y: np.ndarray, *steps: np.ndarray) -> np.ndarray:
        """The `brackets` of x and y, and with `steps` dx and dy of dx and y, and of x and dy: (1 or 3, parts, ...)."""
        stack = self._pencil.stack
        products = stack.times(x)
        pairs = [(y, products), *([(y, stack.times(steps[0])), (steps[1], products)] if steps else [])]
        return np.array([stack.brackets(*pair) for pair in pairs])

    def changes(self, x: np.ndarray, y: np.ndarray, dx: np.ndarray, dy: np.ndarray) -> tuple[np.ndarray, ...]:
        """The `pairs` (3, parts, ...), and with them the sums of |y_i entry_ij x_j|^2 of every part, (parts, ...)."""
        return self.pairs(x, y, dx, dy), self._pencil.stack.squares(y, x)

    def beyond(self, weights: np.ndarray, x: np.ndarray) -> np.ndarray:
        """The rows beyond the truncation, weights times parts, times x: (rows,) or (rows, points)."""
        tail = self._pencil.tail
        return tail.total(tail.spread(weights), tail.times(x))


def _iterated(b: Callable[..., Any], solve: Callable[..., Any], vector: np.ndarray) -> tuple[Any, ...]:
    """Two inverse iterations from one side; the vector, its last step, the sizes of both steps and of it, and by how
    much the last iteration has made its largest component larger."""
    pivot = np.abs(vector).argmax(axis=0)
    if vector.ndim > 1:
        pivot = pivot, np.arange(vector.shape[1])
    first = solve(b(vector))
    start, first = vector * (1 / vector[pivot]), first * (1 / first[pivot])
    second = solve(b(first))
    ahead = second[pivot]
    second = second * (1 / ahead)
    last = second - first
    return second, last, (size_of(first - start), size_of(last), size_of(second)), ahead


def nearly(sizes: np.ndarray, accuracy: float) -> Any:
    """Whether vectors whose steps and own `sizes` (3, 2, ...) are these are less accurate than they shall be, and two
    more iterations would do: each shrinks the error by the ratio of the last steps."""
    before, last, size = sizes
    shrinks = last / np.maximum(np.maximum(before, last), _TINY)
    error = last * shrinks / size
    return (error.max(axis=0) >= accuracy) & ((error * shrinks**2).max(axis=0) < accuracy)


def size_of(vectors: np.ndarray) -> Any:
    """Lengths of vectors (size, points), or of one (size,)."""
    return np.sqrt(square(vectors).sum(axis=0) if vectors.ndim > 1 else np.vdot(vectors, vectors).real)
