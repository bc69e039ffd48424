"""The line of zero growth in the plane of k and one parameter, followed by arclength past its turning points."""

from math import exp
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import ModeLost, ParameterError
from ..numerics.walker import Pace, Walker

if TYPE_CHECKING:
    from .plane import Plane, Point

_ROUGH = 1e-5  # tolerance of the arclength continuation
_ITERATIONS = 20
_LARGEST = 0.4  # step of Newton in log k, and relative in the parameter
_PACE = Pace(0.02, 0.25, 1e-5, 2.0)  # along the curve, in log k and log value
_TURN = 0.15  # angle between neighbouring tangents at which the step is kept
_STRAIGHT = 1e-9  # a turn too small to divide by
_PLACED = 1e-3  # of the first step: a Newton step so short ends on the curve
_POINTS = 400
_MARGIN = 1.15  # factor in k beyond the range asked for within which the curve may turn back
_DRAWN = 0.03  # distance from a curve, in log k and log value, within which a point lies on it


def passes(lines: np.ndarray, k: float, value: float) -> bool:
    return bool(len(lines)) and float(np.nanmin(np.abs(np.log(lines / (k, value))).max(axis=1))) < _DRAWN


def trace(land: Any, zero: Any, low: Any, high: Any) -> Any:
    """Points (points + 1, 2) along the neutral curve through a zero, from end to end; a row of nan ends it."""
    (half,) = (index for index, flow in enumerate(land.planes[0].flow_at(zero.value).halves())
               if flow == zero.mode.flow)
    plane = land.planes[half].rough(_ROUGH)
    start = plane.adopt(land.planes[half].point(zero.k, zero.value, zero.mode))
    back, ahead = (_walk(plane, start, side, low, high, land.span) for side in (-1, 1))
    return np.array([*((point.k, point.value) for point in (*reversed(back[1:]), *ahead)), (np.nan, np.nan)])


def _walk(plane: "Plane", start: "Point", side: int, low: float, high: float, span: tuple[float, ...]) -> "list[Point]":
    """Follow the curve by arclength until it leaves low <= k <= high or the span, or as far as the mode can be
    followed."""
    walk = _Contour(plane, _project(plane, start), side)
    while len(walk.points) < _POINTS and not walk.stuck:
        if not walk.stride(walk.step, walk.step):
            continue
        new = walk.points[-1]
        leaving = new.k * _MARGIN < low and walk.tangent[0] < 0 or new.k > high * _MARGIN and walk.tangent[0] > 0
        if leaving or not span[0] <= new.value <= span[1]:
            break
    return walk.points


class _Contour(Walker):
    """The line of zero growth followed by arclength in (log k, log value)."""

    checks = ("turns_little",)
    failures = (ModeLost, ParameterError)

    def __init__(self, plane: "Plane", start: "Point", side: int) -> None:
        super().__init__(_PACE)
        self.plane, self.points = plane, [start]
        tangent = _tangent(start)
        self.tangent = side * tangent * np.sign(tangent[0])

    def foresee(self, to: float) -> tuple[float, ...]:
        now = self.points[-1]
        return now.k * exp(to * self.tangent[0]), now.value * exp(to * self.tangent[1])

    def correct(self, to: float, guess: tuple[float, ...]) -> "Point":
        return _project(self.plane, self.plane.move(self.points[-1], *guess))

    def turns_little(self, new: "Point", guess: tuple[float, ...]) -> bool:
        return self._turn(new) <= 2 * _TURN

    def factor(self, new: "Point", guess: tuple[float, ...]) -> float:
        return min(2.0, _TURN / max(self._turn(new), _STRAIGHT))

    def accept(self, to: float, new: "Point") -> None:
        self.points.append(new)
        self.tangent = self._ahead(new)

    def _ahead(self, new: "Point") -> np.ndarray:
        """The tangent at a point, in the direction of the walk."""
        direction = _tangent(new)
        return direction if direction @ self.tangent > 0 else -direction

    def _turn(self, new: "Point") -> float:
        """The angle between the tangents here and at a point."""
        return np.arccos(min(1.0, self._ahead(new) @ self.tangent))


def _scaled_gradient(point: "Point") -> np.ndarray:
    """Gradient of the growth rate in (log k, log value)."""
    return point.gradient * (1.0, point.value)


def _tangent(point: "Point") -> np.ndarray:
    across = _scaled_gradient(point)
    return np.array([-across[1], across[0]]) / np.hypot(*across)


def _project(plane: "Plane", point: "Point") -> "Point":
    """The point of the curve next to this one, by Newton steps along the gradient."""
    for _ in range(_ITERATIONS):
        gradient = _scaled_gradient(point)
        step = -point.growth * gradient / (gradient @ gradient)
        if np.hypot(*step) > _LARGEST:
            raise ModeLost("the neutral curve is not near")
        if np.hypot(*step) < _PLACED * _PACE.first:
            return point
        point = plane.move(point, point.k * exp(step[0]), point.value * exp(step[1]))
    raise ModeLost("the neutral curve is not near")
