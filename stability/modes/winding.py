"""How many eigenvalues lie above a line in the plane of rates: the argument principle, asked of band factors first."""

from collections.abc import Callable
from itertools import pairwise
from math import pi
from typing import Any

import numpy as np

_SIDE = 6, 2, 2, 2  # points along the line and along the other sides of the contour
_TURN = 1.0  # largest turn (radians) between neighbouring points of the contour
_FLAT = 0.1  # total turn (radians) below which a list is complete: rounding would leave no such balance
_HALVINGS = 12  # of a stretch of the contour


def winding(solver: Any, degree: Any, k: Any, known: Any, line: Any) -> Any:
    """How often the determinant over (rate - known) turns around the rates above the line."""
    pencil = solver.pencil(degree)
    weights = pencil.weights(solver.symbols(k))
    condensed = pencil.condensed_for(sum(_SIDE))
    inner, own = (condensed, condensed.weights(weights.value)) if condensed else (pencil, weights.value)
    banded = _turns(lambda rates: _banded_phases(inner, own, np.array(rates)), known, line, 0)
    if banded is not None and abs(banded) < _FLAT:
        return 0
    a, b = pencil.pair(weights)
    return round(_turns(lambda rates: [_phase(a - rate * b) for rate in rates], known, line, _HALVINGS) / (2 * pi))


def _banded_phases(pencil: Any, weights: np.ndarray, rates: np.ndarray) -> np.ndarray:
    """The determinants at these rates over their moduli, from band factors; but for a sign where it is condensed."""
    factors = pencil.factors(weights, rates)
    return np.where(factors.uneven, [pencil.factors(weights, rate).phase() if uneven else 0 for rate, uneven in
                                     zip(rates.tolist(), factors.uneven, strict=True)], factors.phases())


def _phase(matrix: Any) -> Any:
    """The determinant over its modulus, rows and columns brought to similar sizes first."""
    for axis in (1, 0):
        matrix = matrix / np.abs(matrix).max(axis=axis, keepdims=True)
    return np.linalg.slogdet(matrix)[0]


def _turns(phases: Any, known: Any, line: Any, halvings: Any) -> Any:
    """The angle by which phase / (that of the product of rate - known) turns along the contour; `phases` of a list.

    None where it turns too much between neighbouring points, unless stretches may be halved.
    """
    def turns(rates: list[complex]) -> list[complex]:
        away = np.array(rates)[:, None] - known
        return (np.asarray(phases(rates)) * np.prod((away / np.abs(away)).conj(), axis=1)).tolist()

    corners = _corners(known, line)
    points = np.concatenate([np.linspace(a, b, count, endpoint=False)
                             for (a, b), count in zip(pairwise([*corners, corners[0]]), _SIDE, strict=True)]).tolist()
    points.append(points[0])
    values = turns(points[:-1])
    values.append(values[0])
    total = 0.0
    for (a, b), (u, v) in zip(pairwise(points), pairwise(values), strict=True):
        if not halvings and abs(np.angle(v / u)) > _TURN:
            return None
        total += _turned(turns, a, b, u, v, halvings)
    return total


def _corners(known: np.ndarray, line: float) -> tuple[complex, ...]:
    """Corners of the contour, counterclockwise from the upper end of the line: with room for what is not known."""
    above = known[known.real > line]
    low, high, right = above.imag.min(initial=0), above.imag.max(initial=0), above.real.max(initial=line)
    room = max(high - low, right - line, 0.1 * abs(line))
    return (complex(line, high + room), complex(line, low - room), complex(right + room, low - room),
            complex(right + room, high + room))


def _turned(turns: Callable[..., Any], a: complex, b: complex, u: complex, v: complex, halvings: int) -> float:
    """The angle by which the phase turns from u at a to v at b, halving the way until it turns little at a time."""
    angle = float(np.angle(v / u))
    if abs(angle) < _TURN or not halvings:
        return angle
    middle = (a + b) / 2
    (value,) = turns([middle])
    return _turned(turns, a, middle, u, value, halvings - 1) + _turned(turns, middle, b, value, v, halvings - 1)
