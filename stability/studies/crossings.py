"""The values of a parameter at which a mode is neutral at one wavenumber: all of them in a range.

At a few values, the columns, all modes near zero growth are taken from dense spectra of two degrees that agree. Each is
followed to the next column, or back where none arrived; growth and its derivative on the way tell where it crosses
zero. In an ill-posed flow it is the surface mode that is asked about, at each value the one followed from long waves.
"""

from collections.abc import Iterator
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import ModeLost, ParameterError
from ..modes.crests import crest_mode, depth_of
from ..modes.listing import near_neutral
from ..modes.memory import branch_of
from ..modes.surface import surface_branch
from ..numerics.walker import Pace, Walker, towards
from .ridges import Landscape, may_turn
from .thresholds import zero_at

if TYPE_CHECKING:
    from .plane import Plane, Point
    from .thresholds import Zero

_PACE = Pace(0.25, 0.25, 1e-4)  # in the logarithm of the parameter
_SAME = 1e-3  # relative distance of sigma within which two modes are one
_ITERATIONS = 60
_INNER = 0.01  # part of a bracket at either end that a secant does not step into
_LAST_DIGIT = 1e-15  # relative step of Newton that is rounding


def zeros_at(land: Landscape, k: float) -> "tuple[list[Zero], dict[Any, Any], set[Any]]":
    """Return the `Zero`s at wavenumber k by increasing value, the traces of why none is known, and whether any grows.

    The traces are {value: reason} of the columns that could not be computed.
    """
    zeros, trouble, grows = [], {}, set()
    for half, plane in enumerate(land.rough):
        columns = []
        for value in land.values:
            try:
                modes = _modes(plane, k, value)
            except ParameterError:
                continue
            except ModeLost as reason:
                trouble[value], modes = str(reason), []
            grows |= {point.growth > 0 for point in modes} or {False}
            columns.append((value, modes))
        for pair in pairwise(columns):
            zeros += [_refined(land.planes[half], a, b) for a, b in _changes(plane, *pair)]
    return sorted(zeros, key=lambda zero: zero.value), trouble, grows


def _modes(plane: "Plane", k: float, value: float) -> list[Any]:
    """Points at k of the modes that matter at a value."""
    solver = plane.solver(value)
    if crest_mode(plane.flow_at(value)) == "surface":
        with branch_of(solver, surface_branch, [k]) as branch:
            found, lost = branch.at([k])
        if lost:
            raise ModeLost(lost[k])
        modes = found.values()
    else:
        modes, _ = near_neutral(solver, k, depth_of(solver.flow)(k), 0)
    return [plane.point(k, value, mode) for mode in modes]


def _changes(plane: Any, left: Any, right: Any) -> Iterator[Any]:
    """Pairs of neighbouring points of opposite growth between two columns (value, points)."""
    (low, here), (high, there) = left, right
    arrived = []
    for start in here:
        way = [start, *follow(plane, start, high)]
        if way[-1].value == high:
            arrived.append(way[-1])
        yield from _turns(plane, way)
    for start in there:
        if not any(_one(start, other) for other in arrived):
            yield from _turns(plane, [start, *follow(plane, start, low)])


def _one(a: "Point", b: "Point") -> bool:
    return abs(a.mode.sigma - b.mode.sigma) < _SAME * abs(a.mode.sigma)


def follow(plane: "Plane", start: "Point", value: float) -> Iterator[Any]:
    """Yield points of the mode from one value to another; ends early where it is lost."""
    walk = _AtOneWavenumber(plane, start)
    while walk.now.value != value and not walk.stuck:
        if walk.stride(*towards(walk.now.value, value, walk.step)):
            yield walk.now


class _AtOneWavenumber(Walker):
    """A mode followed along the parameter."""

    failures = (ModeLost, ParameterError)

    def __init__(self, plane: "Plane", start: "Point") -> None:
        super().__init__(_PACE)
        self.plane, self.now = plane, start

    def correct(self, to: float, guess: Any) -> "Point":
        return self.plane.move(self.now, self.now.k, to)

    def accept(self, to: float, new: "Point") -> None:
        self.now = new


def _turns(plane: Any, way: Any) -> Iterator[Any]:
    for a, b in pairwise(way):
        if a.growth * b.growth <= 0:
            yield a, b
        elif may_turn(a, b):
            middle = plane.move(a, a.k, (a.value * b.value) ** 0.5)
            if middle.growth * a.growth <= 0:
                yield a, middle
                yield middle, b


def _refined(plane: "Plane", a: "Point", b: "Point") -> "Zero":
    """The `Zero` between two points of opposite growth: secants kept inside, at last with full accuracy."""
    a, b = plane.adopt(a), plane.adopt(b)
    for _ in range(_ITERATIONS):
        share = float(np.clip(a.growth / (a.growth - b.growth), _INNER, 1 - _INNER)) if a.growth != b.growth else 0.5
        near = min(a, b, key=lambda point: abs(point.growth))
        newton = near.value - near.growth / near.by_value.real
        inside = min(a.value, b.value) < newton < max(a.value, b.value)
        new = plane.move(near, near.k, newton if inside else a.value * (b.value / a.value) ** share)
        a, b = (new, b) if new.growth * b.growth <= 0 else (a, new)
        if abs(new.growth) < 0.5 * new.mode.error or abs(newton - near.value) < _LAST_DIGIT * abs(near.value):
            break
    best = min(a, b, key=lambda point: abs(point.growth))
    return zero_at(best, (best.mode.error + abs(best.growth)) / abs(best.by_value.real), 0.0, plane)

