"""The line of zero growth in the plane of k and one parameter, followed by arclength past its turning points.

Several zeros may lie on one curve, and curves of different modes may cross: a zero lies on a curve that is drawn if the
mode of that curve, moved from there to the zero, is the mode that is neutral there.
"""

from contextlib import suppress
from math import exp
from typing import TYPE_CHECKING

import numpy as np

from ..errors import ModeLost, ParameterError
from ..numerics.walker import Pace, Walker

if TYPE_CHECKING:
    from .plane import Plane, Point
    from .ridges import Landscape
    from .thresholds import Zero

_ROUGH = 1e-5  # tolerance of the arclength continuation
_ITERATIONS = 20
_LARGEST = 0.4  # step of Newton in log k, and relative in the parameter
_PACE = Pace(0.02, 0.15, 1e-5, 2.0)  # along the curve, in log k and log value
_TURN = 0.1  # angle between neighbouring tangents at which the step is kept: chords look smooth
_STRAIGHT = 1e-9  # a turn too small to divide by
_PLACED = 1e-3  # of the first step: a Newton step so short ends on the curve
_POINTS = 400
_MARGIN = 1.15  # factor in k beyond the range asked for within which the curve may turn back
_DRAWN = 0.02  # distance from a line, in log k and log value, within which a point may lie on it: chords leave 0.004
_ONE = 0.5  # largest deviation of the overlap of one mode with itself from 1; that of two modes is 0


class Line:
    """A piece of a neutral curve of one symmetry class: its `points` from end to end, one and the same if closed."""

    def __init__(self, points: "list[Point]") -> None:
        self.points = points
        self._places = np.array([_place(point) for point in (*points, points[-1])])

    @property
    def trace(self) -> np.ndarray:
        """(k, value) of the points, shape (points + 1, 2); a row of nan ends it."""
        return np.array([*((point.k, point.value) for point in self.points), (np.nan, np.nan)])

    def passes(self, point: "Point") -> bool:
        """Whether a neutral point lies on this line: near it in the plane, and of its mode when that is moved there."""
        plane = self.points[0].plane
        if point.plane.half != plane.half:
            return False
        starts, along = self._places[:-1], np.diff(self._places, axis=0)
        way = _place(point) - starts
        share = np.clip((way * along).sum(axis=1) / np.maximum((along**2).sum(axis=1), _STRAIGHT**2), 0, 1)
        gaps = np.hypot(*(way - share[:, None] * along).T)
        nearest = int(gaps.argmin())
        if gaps[nearest] > _DRAWN:
            return False
        try:
            moved = plane.move(self.points[nearest], point.k, point.value)
        except (ModeLost, ParameterError):
            return False
        return abs(plane.solver(point.value).overlap(moved.mode, point.mode) - 1) < _ONE


def _place(point: "Point") -> np.ndarray:
    return np.log((point.k, point.value))


def lines_through(land: "Landscape", zeros: "list[Zero]", drawn: list[Line], low: float, high: float) -> list[Line]:
    """The neutral curves through zeros, low <= k <= high, each once, without those that are drawn."""
    lines: list[Line] = []
    for zero in zeros:
        with suppress(ModeLost, ParameterError, np.linalg.LinAlgError):
            start = _start(land, zero)
            if not any(line.passes(start) for line in (*drawn, *lines)):
                lines.append(_trace(start, [*drawn, *lines], low, high, land.span))
    return lines


def _start(land: "Landscape", zero: "Zero") -> "Point":
    """A zero in the rough plane of its symmetry class."""
    (half,) = (index for index, flow in enumerate(land.planes[0].flow_at(zero.value).halves())
               if flow == zero.mode.flow)
    return land.planes[half].rough(_ROUGH).adopt(land.planes[half].point(zero.k, zero.value, zero.mode))


def _trace(start: "Point", drawn: list[Line], low: float, high: float, span: tuple[float, ...]) -> Line:
    """The neutral curve through a point, from end to end."""
    start = _project(start.plane, start)
    ahead = _walk(start, 1, drawn, low, high, span)
    back = () if ahead.closed else _walk(start, -1, drawn, low, high, span).points[1:]
    return Line([*reversed(back), *ahead.points])


def _walk(start: "Point", side: int, drawn: list[Line], low: float, high: float, span: tuple[float, ...]) -> "_Contour":
    """Follow the curve by arclength until it leaves low <= k <= high or the span, comes back to its start or to a line
    that is drawn, or as far as the mode can be followed."""
    walk = _Contour(start, side)
    while len(walk.points) < _POINTS and not (walk.stuck or walk.closed):
        if not walk.stride(walk.step, walk.step):
            continue
        new = walk.points[-1]
        leaving = new.k * _MARGIN < low and walk.tangent[0] < 0 or new.k > high * _MARGIN and walk.tangent[0] > 0
        if leaving or not span[0] <= new.value <= span[1] or any(line.passes(new) for line in drawn):
            break
    return walk


class _Contour(Walker):
    """The line of zero growth followed by arclength in (log k, log value)."""

    checks = ("turns_little",)
    failures = (ModeLost, ParameterError)

    def __init__(self, start: "Point", side: int) -> None:
        super().__init__(_PACE)
        self.plane, self.points, self.closed, self.turned = start.plane, [start], False, 0.0
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
        ahead = self._ahead(new)
        self.turned += self._turn(new) * np.sign(self.tangent[0] * ahead[1] - self.tangent[1] * ahead[0])
        self.tangent = ahead
        start, last = self.points[0], self.points[-1]
        self.closed = abs(self.turned) > np.pi and Line([last, new]).passes(start)
        self.points.append(start if self.closed else new)

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
