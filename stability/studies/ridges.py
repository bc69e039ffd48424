"""Where the crests of growth over k change sign as a parameter varies: over a whole range of it.

At a few values of the parameter, the columns, every crest is sought (`modes.crests`). Each is then followed to the
next column as a ridge, by steps in the parameter with the crest settled at each: growth and its derivative there tell
whether the ridge crosses zero on the way, and where. A crest that no ridge has reached is followed back. Long waves
are a crest of their own: the sign of a in growth = a k^2 as k -> 0.
"""

from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from math import exp, log
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import ModeLost, ParameterError
from ..modes.crest import middle_of
from ..modes.crests import ROUGH, crest_mode, look, search_of, surface_look
from ..modes.surface import surface_mode
from ..numerics.walker import Pace, Walker, towards
from .plane import Plane, Point

if TYPE_CHECKING:
    from ..flows.base import Flow
    from ..modes.accuracy import Accuracy
    from ..modes.mode import Mode

_COLUMN = 0.7  # spacing of the columns, in the logarithm of the parameter
_FEWEST = 12  # columns
_TRIED = 300  # values at which it is asked whether the flow exists
_PACE = Pace(0.25, 0.25, 1e-5)  # of a ridge, in the logarithm of the parameter
BUDGET = 150  # steps along ridges where another one grows
_FAILURES = 20  # steps of a ridge that may be refused
_HALVINGS = 3  # of one step in k and the parameter: what needs more is refused
_SHIFT = 0.3  # largest way in log k that a crest may be from where it is expected
_SETTLED = 1e-4  # step in log k within which a crest is settled
_SETTLINGS = 10
_STRIDE = 1e-3  # in log k, to find the curvature of a crest
_SAME = 0.03, 0.01  # distance in log k, and of sigma relative, within which two crests are one
_BISECTIONS = 60
_CLOSE = 1e-6  # relative width in the parameter at which Newton's method takes over
_NARROW = 1e-12  # relative width of the bracket of a long-wave threshold that is left to rounding
_INNER = 0.02, 0.05  # parts of a bracket at either end that a secant does not step into: of a threshold, of a ridge
_DOUBT = 5  # times the rough error of a growth rate within which its sign is asked of the full accuracy
_LONG = 1e-9  # wavenumber that stands for 0
_LONG_ERROR = 32.0  # error of d rate/dk there in units of the error of the rate (measured: up to 18)
_LOWER = 0.5  # part of a rate that growth of lower order than k^2 leaves as k -> 0


@dataclass(frozen=True)
class Crest:
    """A point where growth is largest over k, and its curvature `bend` < 0 there, in log k."""

    point: Point
    bend: float

    @property
    def growth(self) -> float:
        return self.point.growth

    @property
    def value(self) -> float:
        return self.point.value

    @property
    def trend(self) -> float:
        """Derivative of the growth at the crest in the logarithm of the parameter."""
        return self.point.trend


@dataclass(frozen=True)
class Section:
    """What is known at one value of the parameter: crests by symmetry class, and whether anything `grows`.

    Where nothing does, `trouble` says why something may have been overlooked, or is None.
    """

    value: float
    crests: dict
    grows: bool
    trouble: str | None


@dataclass(frozen=True)
class LongWaves:
    """Growth = a k^2 as k -> 0 at a value: `a` with its error `spread`, and the mode."""

    value: float
    a: float
    spread: float
    mode: "Mode"


class Landscape:
    """Growth over k and one parameter of a flow: `columns` at the values of a `span`; `search` bounds k.

    `modes` collects which were looked at, "leading" meaning all of them and "surface" that one alone; `spent` counts
    the steps along ridges where another one grows.
    """

    def __init__(self, flow: "Flow", vary: str, span: tuple[float, ...], search: Any, accuracy: "Accuracy") -> None:
        self.flow, self.vary, self.span = flow, vary, span
        self.search = search or search_of(flow, crest_mode(flow))
        halves = range(len(flow.halves()))
        self.planes = [Plane(flow, vary, accuracy, half) for half in halves]
        self.rough = [plane.rough(ROUGH) for plane in self.planes]
        self.columns, self.modes, self.spent = [], set(), 0

    def scan(self) -> None:
        """Fill the columns."""
        self.columns = [column for value in self.values if (column := self.column(value))]

    @cached_property
    def values(self) -> list[float]:
        """Values of the parameter from end to end of that part of the span in which the flow exists."""
        low, high = self.span
        there = [value for value in np.geomspace(low, high, _TRIED).tolist() if self._exists(value)]
        if not there:
            return []
        low, high = there[0], there[-1]
        return np.geomspace(low, high, max(_FEWEST, 2 + int(log(high / low) / _COLUMN))).tolist()

    def _exists(self, value: float) -> bool:
        try:
            return bool(self.planes[0].flow_at(value))
        except ParameterError:
            return False

    def column(self, value: float) -> "Section | None":
        """The `Column` at a value; None where the flow does not exist."""
        try:
            mode = crest_mode(self.planes[0].flow_at(value))
        except ParameterError:
            return None
        self.modes.add(mode)
        if self.flow.decays:
            return Section(value, {}, False, None)
        crests, trouble, grows = {}, None, False
        for half, plane in enumerate(self.rough):
            solver, found = plane.solver(value), []
            for kind in self._looks(mode):
                try:
                    seen = kind(solver, *self.search)
                except ModeLost as reason:
                    trouble = trouble or str(reason)
                    continue
                trouble = trouble or seen.trouble
                found += _crests(plane, value, seen.brackets)
                grows = grows or any(self.grows(plane.point(end.k, value, end)) for side in seen.ends for end in side)
            crests[half] = _distinct(found)
            grows = grows or any(self.grows(crest.point) for crest in crests[half])
        return Section(value, crests, grows, None if grows else trouble)

    def grows(self, point: Point, at_least: float = 0.0) -> bool:
        """Whether growth at a point exceeds a number by more than its error, computed properly where that is close."""
        doubt = _DOUBT * point.mode.error
        if abs(point.growth - at_least) > doubt:
            return point.growth > at_least
        mode = self.planes[point.plane.half].adopt(point).mode
        return mode.growth_rate > at_least + mode.error

    def _looks(self, mode: str) -> list[Callable[..., Any]]:
        """What is looked at: the surface mode, and all modes."""
        return [kind for kind, wanted in ((surface_look, self.flow.has_surface_mode()),
                                          (look, mode == "leading")) if wanted]

    def crossings(self) -> Iterator[Any]:
        """Yield pairs of neighbouring crests of a ridge (a, b) with growth of opposite signs, over the whole span."""
        for half, plane in enumerate(self.rough):
            for left, right in pairwise(self.columns):
                ways = self._ways(plane, left.crests.get(half, []), right.crests.get(half, []), left.value, right.value)
                for a, b in (pair for way in ways for pair in _changes(plane, way)):
                    if max(a.point.k, b.point.k) <= self.search[1]:
                        yield a, b

    def _ways(self, plane: Plane, left: list[Any], right: list[Any], low: float, high: float) -> Iterator[Any]:
        """Ridges between two columns, lists of crests: forwards, the highest first, and backwards where none arrived.

        Where the highest grows all the way, whatever the others do is of less interest, and within `BUDGET`.
        """
        arrived, covered = [], False
        for crest, value in [*((crest, high) for crest in _by_growth(left)), *((crest, low) for crest in right)]:
            if value == low and any(_one(crest, other) for other in arrived) or covered and self.spent > BUDGET:
                continue
            way = [crest, *ridge(plane, crest, value)]
            self.spent += len(way) * covered
            arrived += way[-1:] if way[-1].value == high else []
            covered = covered or way[-1].value == value and all(self.grows(one.point) for one in way)
            yield way

    @cached_property
    def long_waves(self) -> "list[LongWaves]":
        """What is known of long waves at the values."""
        return [one for value in self.values if (one := self.long_wave(value))]

    def thresholds(self) -> "Iterator[tuple[LongWaves, LongWaves]]":
        """Yield pairs of neighbouring `LongWaves` with a of opposite signs."""
        for one, other in pairwise(self.long_waves):
            if one.a * other.a < 0:
                yield self._narrowed(one, other)

    def long_wave(self, value: float) -> "LongWaves | None":
        """The `LongWaves` at a value, or None where growth is of lower order or the mode is lost."""
        if not self.flow.has_surface_mode():
            return None
        with suppress(ModeLost, ParameterError):
            return _long_wave(self.planes[0], value)
        return None

    def _narrowed(self, one: "LongWaves", other: "LongWaves") -> "tuple[LongWaves, LongWaves]":
        """A bracket of the threshold so narrow that its middle is right to rounding."""
        for _ in range(_BISECTIONS):
            share = float(np.clip(one.a / (one.a - other.a), _INNER[0], 1 - _INNER[0]))
            new = self.long_wave(one.value + share * (other.value - one.value))
            if new is None:
                break
            one, other = (new, other) if new.a * other.a < 0 else (one, new)
            if abs(new.a) <= new.spread or abs(one.value - other.value) < _NARROW * abs(one.value):
                break
        return one, other


def _long_wave(plane: Plane, value: float) -> "LongWaves":
    solver = plane.solver(value)
    mode = surface_mode(solver, _LONG)
    if abs(mode.rate.real) > _LOWER * mode.k * abs(mode.rate_slope.real) + abs(mode.k * mode.rate_slope.real) \
            + 4 * mode.error / solver.width(mode.k):
        raise ModeLost("growth is of lower order than k^2")
    rung = solver.degrees.index(mode.degree)
    ahead = [solver.solve(mode.k, mode.rate, (mode.degree, mode.x, mode.y), degree)
             for degree in solver.degrees[rung + 1: rung + 3]]
    slopes = [other.rate_slope.real for other in (mode, *ahead)]
    spread = abs(slopes[-1] - slopes[-2]) + _LONG_ERROR * mode.error / solver.width(mode.k)
    return LongWaves(value, slopes[-1], spread, mode)


def _crests(plane: Plane, value: float, brackets: list[Any]) -> Iterator[Any]:
    for left, right in brackets:
        with suppress(ModeLost):
            mode, bend = middle_of(plane.solver(value), left, right)
            yield settle(plane, plane.point(mode.k, value, mode), bend)


def _distinct(crests: list[Any]) -> list[Any]:
    kept = []
    for one in crests:
        if not any(_one(one, other) for other in kept):
            kept.append(one)
    return kept


def _one(one: "Crest", other: "Crest") -> bool:
    a, b = one.point, other.point
    return abs(log(a.k / b.k)) < _SAME[0] and abs(a.mode.sigma - b.mode.sigma) < _SAME[1] * abs(a.mode.sigma)


def settle(plane: Plane, point: Point, bend: float) -> "Crest":
    """The `Crest` next to a point, by secants of the slope in log k; raises ModeLost where there is none near."""
    start = point
    for _ in range(_SETTLINGS):
        if not bend < 0:
            beside = plane.move(point, point.k * exp(_STRIDE), point.value, _HALVINGS)
            bend = (beside.by_k - point.by_k) / _STRIDE
        step = -point.by_k / bend
        if not bend < 0 or abs(log(point.k / start.k) + step) > _SHIFT:
            break
        if abs(step) < _SETTLED:
            return Crest(point, bend)
        new = plane.move(point, point.k * exp(step), point.value, _HALVINGS)
        bend, point = (new.by_k - point.by_k) / step, new
    raise ModeLost(f"{point.mode.flow}: growth has no crest near k = {start.k:.6g}")


def ridge(plane: Plane, crest: "Crest", value: float) -> Iterator[Any]:
    """Yield crests from one to the one at another value; ends early where the ridge does."""
    walk, refused = _Ridge(plane, crest), 0
    while walk.now.value != value and not walk.stuck and refused <= _FAILURES:
        if walk.stride(*towards(walk.now.value, value, walk.step)):
            yield walk.now
        else:
            refused += 1


class _Ridge(Walker):
    """A crest followed along the parameter; `drift` is the slope of its log k."""

    def __init__(self, plane: Plane, crest: "Crest") -> None:
        super().__init__(_PACE)
        self.plane, self.now, self.drift = plane, crest, 0.0

    def correct(self, to: float, guess: Any) -> "Crest | None":
        return _ahead(self.plane, self.now, to, self.drift)

    def accept(self, to: float, new: "Crest") -> None:
        self.drift = log(new.point.k / self.now.point.k) / log(new.value / self.now.value)
        self.now = new


def _ahead(plane: Plane, now: "Crest", value: float, drift: float) -> "Crest | None":
    """The crest at another value, or None where it is not found near to where it should be."""
    try:
        guess = now.point.k * exp(drift * log(value / now.value))
        return settle(plane, plane.move(now.point, guess, value, _HALVINGS), now.bend)
    except (ModeLost, ParameterError):
        return None


def _by_growth(crests: list[Any]) -> list[Any]:
    return sorted(crests, key=lambda crest: -crest.growth)


def _changes(plane: Any, way: Any) -> Iterator[Any]:
    for a, b in pairwise(way):
        if a.growth * b.growth <= 0:
            yield a, b
        elif may_turn(a, b):
            middle = _ahead(plane, a, (a.value * b.value) ** 0.5, 0.0)
            if middle is not None:
                yield from _changes(plane, [a, middle]) if middle.growth * a.growth <= 0 else ()
                yield from _changes(plane, [middle, b]) if middle.growth * b.growth <= 0 else ()


def may_turn(a: Any, b: Any) -> bool:
    """Whether growth of one sign at both ends may change it in between, by its tangents."""
    h = log(b.value / a.value)
    nearest = (a.growth + a.trend * h / 2, b.growth - b.trend * h / 2)
    return a.trend * b.trend < 0 and min(one * np.sign(a.growth) for one in nearest) < 0


def narrowed(plane: Plane, a: "Crest", b: "Crest") -> "Crest":
    """The crest of a ridge nearest to zero growth between two of opposite sign."""
    for _ in range(_BISECTIONS):
        share = 0.5 if a.growth == b.growth else \
            float(np.clip(a.growth / (a.growth - b.growth), _INNER[1], 1 - _INNER[1]))
        new = _ahead(plane, min(a, b, key=lambda one: abs(one.growth)), a.value * (b.value / a.value) ** share, 0.0)
        if new is None:
            new = _ahead(plane, max(a, b, key=lambda one: abs(one.growth)), (a.value * b.value) ** 0.5, 0.0)
        if new is None:
            break
        a, b = (new, b) if new.growth * b.growth <= 0 else (a, new)
        if abs(log(a.value / b.value)) < _CLOSE or abs(new.growth) <= new.point.mode.error:
            break
    return min(a, b, key=lambda one: abs(one.growth))
