"""Critical values: where the largest growth rate over k changes sign, all of them in a range of the parameter.

A nose, growth = d growth / dk = 0 at a finite k, is refined by Newton in (log k, value) from where a ridge of
`studies.ridges` crosses zero; the long-wave threshold, where a in growth = a k^2 changes sign as k -> 0, from its own
bracket: with sigma = k rate, a is the real part of d rate / dk at k = 0, where the scaled equations are regular.
"""

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, replace
from math import exp, log
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import ModeLost, ParameterError
from ..modes.response import error_of_zero
from ..status import RESOLVED, Status, is_resolved, unresolved
from .ridges import BUDGET, Landscape, narrowed

if TYPE_CHECKING:
    from ..modes.mode import Mode
    from .plane import Plane, Point
    from .ridges import Crest, LongWaves

_ITERATIONS = 20
_SETTLED = 1e-4  # step of the rough Newton iteration below which its last Jacobian serves at full accuracy
_POLISH = 8
_STRIDE = 1e-4  # in log k, to difference the gradient
_LARGEST = 0.4  # step of Newton in log k, and relative in the parameter
_ASTRAY = 0.1  # largest way in the logarithm of the value from where the ridge crosses zero
_SCATTER = 4.0  # error of a slope in units of its change when the vectors are refined once more (measured)
_VALUE_TOLERANCE = 1e-9  # relative error of a value that is accepted as resolved whatever the tolerance of sigma
_BOTH = "all modes, where the flow is ill posed the surface mode"
_SAME = 1e-6  # relative distance of two values, and of their k, that are one
_SAME_K = 1e-3  # that of their wavenumbers, which a flat crest leaves open
_ITSELF = 0.05  # distance in log k within which a crest is the one that is neutral
_POLISHED = 1e-9  # step in log k at which a nose is settled at full accuracy: its error in growth is the square
_THRESHOLD = 1e-7  # relative error of a long-wave threshold that is accepted: its slopes have no better bars


@dataclass(frozen=True)
class Zero:
    """A value of zero growth at wavenumber k (0: long waves), with the errors of both; `mode` has its eigenvalue.

    `rise` is positive where growth sets in as the value rises, negative where it ends.
    """

    k: float
    value: float
    mode: "Mode"
    error: float
    k_error: float
    status: Status
    rise: float
    data_error: float | None = None  # standard error of the value from that of a measured base flow


@dataclass(frozen=True)
class Found:
    """Critical values, the first met from the stable side in front; then zeros of crests where other waves grow.

    `why` says why there is none, `remark` what has not been looked at.
    """

    boundaries: tuple
    inner: tuple
    why: str | None
    remark: str | None = None


def critical_zeros(land: Landscape, long_wave: bool) -> Found:
    """Return the critical values of a landscape, or its long-wave thresholds alone."""
    thresholds = [_threshold(*pair) for pair in land.thresholds()]
    if long_wave:
        why = None if thresholds else f"{land.flow}: no long-wave threshold in {land.vary} {_range(land)}"
        return Found(_ordered(thresholds, [bool(one.a <= one.spread) for one in land.long_waves]), (), why)
    land.scan()
    zeros = [*thresholds, *_noses(land), *_beside_thresholds(land, thresholds)]
    zeros = [zero for rank, zero in enumerate(zeros) if not any(_near(zero, other) for other in zeros[:rank])]
    inner = [zero for zero in zeros if _inside(land, zero, zeros) or _others_grow(land, zero)]
    stable = [not column.grows and not column.trouble for column in land.columns]
    boundaries = _doubted(land, _ordered([zero for zero in zeros if zero not in inner], stable))
    remark = "crests where another one grows were not all followed" if land.spent > BUDGET else None
    return Found(boundaries, _ordered(inner, stable), None if boundaries else _why_none(land), remark)


def _noses(land: Landscape) -> Iterator[Any]:
    for a, b in land.crossings():
        crest = narrowed(a.point.plane, a, b)
        plane = land.planes[crest.point.plane.half]
        try:
            yield nose(plane, crest)
        except (ModeLost, ParameterError) as reason:
            yield Zero(crest.point.k, crest.value, crest.point.mode, abs(a.value - b.value), abs(a.point.k - b.point.k),
                       unresolved(reason), (b.growth - a.growth) * (b.value - a.value))


def _beside_thresholds(land: Any, thresholds: Any) -> Iterator[Any]:
    """Noses of long waves that grow already at the threshold of infinitely long ones: no ridge leads so close."""
    for threshold in thresholds:
        for crest in land.column(threshold.value).crests.get(0, []):
            if crest.point.k < land.search[0] and land.grows(crest.point):
                with suppress(ModeLost, ParameterError):
                    yield nose(land.planes[0], crest)


def nose(plane: "Plane", crest: "Crest") -> "Zero":
    """The `Zero` near a crest: Newton on growth = d growth / d log k = 0, at last with full accuracy."""
    point, rough = crest.point, crest.point.plane
    for _ in range(_ITERATIONS):
        jacobian = _jacobian(rough, point)
        step = -np.linalg.solve(jacobian, _equations(point)[0])
        if not abs(log(point.value / crest.value)) < _ASTRAY:
            raise ModeLost(f"{point.mode.flow}: no nose of the neutral curve is near {plane.vary} = {crest.value:.6g}")
        largest = max(abs(step[0]), abs(step[1]) / (abs(point.value) or 1.0))
        if largest < _SETTLED:
            break
        step = step * min(1.0, _LARGEST / largest)
        point = rough.move(point, point.k * exp(step[0]), point.value + float(step[1]))
    else:
        raise ModeLost(f"{point.mode.flow}: Newton's method for the nose of the neutral curve does not settle "
                       f"(k = {point.k:.6g}, {plane.vary} = {point.value:.6g})")
    point = plane.adopt(point)
    for _ in range(_POLISH):
        step = -np.linalg.solve(jacobian, _equations(point)[0])
        point = plane.move(point, point.k * exp(step[0]), point.value + float(step[1]))
        again = plane.adopt(point)
        scatter = _SCATTER * abs(again.mode.slope - point.mode.slope)
        point = again
        if abs(point.growth) < point.mode.error and abs(step[0]) < _POLISHED:
            break
    bend = jacobian[1, 0] * point.k**plane.power
    error = (point.mode.error + abs(point.growth)) / abs(point.by_value.real)
    k_error = point.k * (point.k * (point.mode.slope_error + scatter) + abs(point.by_k)) / abs(bend)
    return zero_at(point, error, k_error, plane)


def _equations(point: "Point") -> tuple[np.ndarray, ...]:
    """growth / k^power and its derivative in log k, which vanish at the nose; and the derivatives of the first.

    With the power of the long-wave growth they do not vanish everywhere at k = 0.
    """
    power = point.plane.power
    scale = point.k**-power
    gradient = scale * (point.gradient - np.array([power * point.growth, 0.0]))
    return np.array([scale * point.growth, gradient[0]]), gradient


def _jacobian(plane: "Plane", point: "Point") -> np.ndarray:
    """Of the two equations in (log k, value): the second row by a difference along k."""
    beside = plane.move(point, point.k * exp(_STRIDE), point.value)
    first, second = (_equations(at)[1] for at in (point, beside))
    return np.array([first, (second - first) / _STRIDE])


def zero_at(point: "Point", error: float, k_error: float, plane: "Plane") -> "Zero":
    """The `Zero` at a point, resolved where the error of its value is small."""
    status = point.mode.status
    if is_resolved(status) and not error <= max(plane.accuracy.tolerance, _VALUE_TOLERANCE) * abs(point.value):
        status = unresolved(f"error {error:.1e} of {plane.vary} exceeds tolerance")
    slope = point.by_value.real
    return Zero(point.k, point.value, point.mode, float(error), float(k_error), status, slope,
                error_of_zero(plane.solver(point.value), point.mode, slope))


def _threshold(one: "LongWaves", other: "LongWaves") -> "Zero":
    """The `Zero` between two neighbouring values of opposite sign of a."""
    slope = (other.a - one.a) / (other.value - one.value)
    best = min(one, other, key=lambda known: abs(known.a))
    error = (abs(best.a) + best.spread) / abs(slope)
    status = RESOLVED if error <= _THRESHOLD * abs(best.value) else unresolved(f"error {error:.1e} exceeds tolerance")
    return Zero(0.0, best.value, best.mode, float(error), 0.0, status, slope)


def _near(zero: "Zero", other: "Zero") -> bool:
    return abs(zero.value - other.value) <= _SAME * abs(zero.value) + zero.error + other.error \
        and abs(zero.k - other.k) <= _SAME_K * max(zero.k, other.k)


def _inside(land: Landscape, zero: "Zero", zeros: "list[Zero]") -> bool:
    """Whether something grows on both sides of a zero: what sets in and what ends, counted from a stable column."""
    stable = next((column.value for column in land.columns if not column.grows and not column.trouble), None)
    if stable is None:
        return False
    between = [other for other in zeros if min(stable, zero.value) < other.value < max(stable, zero.value)]
    side = 1 if zero.value > stable else -1
    growing = sum(side * int(np.sign(other.rise)) for other in between)
    return growing > 0 and growing + side * int(np.sign(zero.rise)) > 0


def _others_grow(land: Any, zero: Any) -> Any:
    """Whether waves grow at a value besides those that are neutral there."""
    waves = land.long_wave(zero.value)
    if zero.k and waves and waves.a > waves.spread:
        return True
    column = land.column(zero.value)
    for crests in column.crests.values():
        for crest in crests:
            itself = zero.k and abs(log(crest.point.k / zero.k)) < _ITSELF
            if not itself and land.grows(crest.point, abs(crest.point.by_value.real) * zero.error):
                return True
    return False


def _ordered(zeros: list[Any], stable: list[bool]) -> tuple[Any, ...]:
    """The first met from the stable side in front: from below unless the upper end of what is `stable` alone is."""
    down = bool(stable) and stable[-1] and not stable[0]
    return tuple(sorted(zeros, key=lambda zero: zero.value, reverse=down))


def _doubted(land: Landscape, zeros: "tuple[Zero]") -> "tuple[Zero]":
    """The zeros, the first one doubtful where a column on its stable side could not be judged."""
    if not zeros:
        return zeros
    first, *others = zeros
    stable = [column for column in land.columns if not column.grows and not column.trouble]
    if not stable:
        return zeros
    side = np.sign(first.value - stable[0].value)
    doubtful = [column for column in land.columns if column.trouble and side * (first.value - column.value) > 0]
    if doubtful and is_resolved(first.status):
        first = replace(first, status=unresolved(f"others may come first: at {land.vary} = {doubtful[0].value:.4g}, "
                                                 f"{doubtful[0].trouble}"))
    return first, *others


def _why_none(land: Any) -> Any:
    doubtful = [column for column in land.columns if column.trouble]
    growing = [column.grows for column in land.columns]
    if doubtful:
        return f"{land.flow}: {land.vary} = {doubtful[0].value:.4g}: {doubtful[0].trouble}"
    if not growing:
        return f"{land.flow}: there is no such flow for {land.vary} {_range(land)}"
    if len(set(growing)) > 1:
        place = growing.index(not growing[0])
        pair = (land.columns[i].value for i in (place - 1, place))
        return f"{land.flow}: growth sets in between {land.vary} = " \
               f"{' and '.join(f'{value:.4g}' for value in pair)}, but no crest of it can be followed"
    kind = "unstable" if growing[0] else "stable"
    modes = {"leading": "all modes", "surface": "the surface mode"}.get("".join(land.modes), _BOTH)
    return f"{land.flow}: {kind} at every {land.vary} {_range(land)}, k from {land.search[0]:g} to " \
           f"{land.search[1]:g}, {modes}; try another range"


def _range(land: Any) -> Any:
    return f"from {land.values[0]:g} to {land.values[-1]:g}" if land.values else \
        f"from {land.span[0]:g} to {land.span[1]:g}"

