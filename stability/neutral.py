"""Neutral stability: where the growth rate vanishes, in a parameter and in the wavenumber.

`critical` finds the value of one parameter at which the largest growth rate over all wavenumbers is zero.
Either a nose, growth = d growth / dk = 0 at a finite k, by Newton in (log k, value); or the long-wave
threshold, where the coefficient a of growth = a k^2 + O(k^4) changes sign: with sigma = k rate, a is the
real part of d rate / dk at k = 0, where the scaled equations are regular. `neutral_curve` follows
growth = 0 through the plane of k and the parameter by arclength, past its turning points.
"""

from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, fields, replace
from math import exp, log
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from .checks import check_flag, check_wavenumbers, shown
from .errors import ModeLost, NotResolved, ParameterError
from .flows.base import check_flow
from .output import Row
from .plane import Plane
from .record import Record
from .solver import DEGREES, TOLERANCE, check_accuracy
from .status import RESOLVED, is_resolved
from .threads import one_thread
from .branch import surface_mode

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import ArrayLike

    from .flows import Flow

_ROUGH = 1e-5  # tolerance of the first Newton steps and of the arclength continuation
_LONG = 1e-9  # wavenumber that stands for 0
_LONG_ERROR = 32.0  # error of d rate/dk there in units of the error of the rate (measured: up to 18)
_ITERATIONS = 20
_SETTLED = 1e-4  # step of the rough Newton iteration below which its last Jacobian serves at full accuracy
_POLISH = 6
_ASTRAY = 4.0  # factor in the value beyond which Newton's method is not trusted
_STRIDE = 1e-4  # in log k, to difference the gradient
_LARGEST = 0.4  # step of Newton in log k, and relative in the parameter
_ARC = 0.02, 0.25  # first and largest step along the curve, in log k and log value
_TURN = 0.15  # angle between neighbouring tangents at which the step is kept
_POINTS = 400
_MARGIN = 1.15  # factor in k beyond the range asked for within which the curve may turn back
_SPAN = 1e4  # the continuation ends where the value has changed by this factor


class _ZeroGrowth(Record):
    """Base of what solves for the parameter `vary`."""

    vary: str

    @property
    def bounded(self) -> str:
        return self.vary

    @property
    def swept(self) -> tuple[str | None, ...]:
        return (self.vary,)

    def about(self) -> dict[str, Any]:
        return {"vary": self.vary}


@dataclass(frozen=True, repr=False)
class NeutralPoint(_ZeroGrowth):
    """A value of the parameter `vary` at which a mode neither grows nor decays.

    `k` is its wavenumber (0: long-wave threshold), `error` and `k_error` bound the absolute errors of `value`
    and `k` (k_error is 0 where k was given); `status` is "resolved" or says what failed, and then the other
    numbers may be None.
    """

    flow: Any
    vary: str
    k: float | None
    value: float | None
    phase_speed: float | None
    error: float | None
    k_error: float | None
    status: str
    settings: Mapping[str, Any] = field(default_factory=dict, compare=False, repr=False)
    dimension: ClassVar[str] = "flow"

    def plot(self, ax: "Axes | None" = None) -> "Axes":
        """Mark (k, value) in the matplotlib Axes `ax`, that of a `NeutralCurve` say, or in a new one; return it."""
        from . import plots

        return plots.neutral_point(self, plots.axes_or_new(ax))

    def rows(self) -> list[Row]:
        row = self.row()
        status = row.pop("status")
        return [{**row, "k_error": self.k_error, "status": status}]

    def row(self) -> Row:
        """Return the row of this point in the table of a curve."""
        return {"k": self.k, self.vary: self.value, "phase_speed": self.phase_speed, "error": self.error,
                "status": self.status}


@dataclass(frozen=True, repr=False)
class NeutralCurve(_ZeroGrowth):
    """Neutral points at the wavenumbers asked for, by increasing value at each, and the `trace` (points, 2)
    of (k, value) along the whole curve from one end to the other."""

    flow: Any
    vary: str
    points: tuple[NeutralPoint, ...]
    trace: np.ndarray = field(compare=False)
    settings: Mapping[str, Any] = field(default_factory=dict, compare=False)
    dimension: ClassVar[str] = "point"

    def plot(self, ax: "Axes | None" = None, quantity: str = "value") -> "Axes":
        """Draw value or phase_speed against k into the matplotlib Axes `ax`, or a new one; return it."""
        from . import plots

        return plots.neutral_curve(self, plots.axes_or_new(ax), quantity)

    def rows(self) -> list[Row]:
        return [point.row() for point in self.points]


@dataclass(frozen=True, repr=False)
class NeutralSweep(_ZeroGrowth):
    """The critical point of every flow of a sweep over the parameter `over` of `flow`."""

    flow: Any
    vary: str
    over: str
    points: tuple[NeutralPoint, ...]

    @property
    def dimension(self) -> str:
        return self.over

    @property
    def settings(self) -> Mapping[str, Any]:  # type: ignore[override]
        return self.points[0].settings

    @property
    def swept(self) -> tuple[str | None, ...]:
        return self.over, *super().swept

    def plot(self, ax: "Axes | None" = None, quantity: str = "value") -> "Axes":
        """Draw value or k against the swept parameter into the matplotlib Axes `ax`, or a new one; return it."""
        from . import plots

        return plots.neutral_sweep(self, plots.axes_or_new(ax), quantity)

    def rows(self) -> list[Row]:
        return [{self.over: getattr(point.flow, self.over), **point.row()} for point in self.points]

    def about(self) -> dict[str, Any]:
        return {**super().about(), "over": self.over}


def critical(flow: "Flow", vary: str, *, long_wave: bool = False, tolerance: float = TOLERANCE,
             max_degree: int = DEGREES[-1], strict: bool = True) -> NeutralPoint:
    """Return the `NeutralPoint` at which the largest growth rate over k is zero as `vary` varies.

    The search starts from the value that the flow has. `long_wave` asks for the threshold as k -> 0, even
    where waves of finite length grow on its stable side. Raises NotResolved if there is no such value near it;
    with strict=False the record says so in `status`.

    >>> from stability.flows import Film
    >>> point = critical(Film(slope_deg=45.0), "Re")
    >>> f"{point.value:.9f} at k = {point.k:g}"
    '1.250000000 at k = 0'
    """
    strict, long_wave = check_flag("strict", strict), check_flag("long_wave", long_wave)
    (point,) = critical_sweep([check_flow(flow)], vary, long_wave=long_wave, tolerance=tolerance, max_degree=max_degree)
    if strict and not is_resolved(point.status):
        raise NotResolved(point.status)
    return point


def critical_sweep(flows: "Iterable[Flow]", vary: str, *, long_wave: bool = False, tolerance: float = TOLERANCE,
                   max_degree: int = DEGREES[-1]) -> Iterator[NeutralPoint]:
    """Yield `critical` of each flow in turn, starting from the value found last; what failed is in its status."""
    tolerance, max_degree = check_accuracy(tolerance, max_degree)
    settings = {"tolerance": tolerance, "max_degree": max_degree, **({"long_wave": "yes"} if long_wave else {})}
    last = None
    for flow in flows:
        check_parameter_name(flow, vary)
        if last is not None:
            with suppress(ParameterError):
                flow = replace(flow, **{vary: last.value})
        point = _critical(flow, vary, tolerance, max_degree, long_wave)
        last = point if point.value is not None else last
        yield replace(point, settings=settings)


def check_parameter_name(flow: "Flow", name: str) -> str:
    """Return `name` if it is a numeric parameter of the flow, else raise a ParameterError."""
    known = [item.name for item in fields(flow) if "options" not in item.metadata]
    if not (isinstance(name, str) and name in known):
        raise ParameterError(f"{flow.name} has no numeric parameter {shown(name)} to vary; it has {', '.join(known)}")
    return name


@one_thread
def _critical(flow, vary, tolerance, max_degree, long_wave=False):
    plane = Plane(flow, vary, tolerance, max_degree)
    rough = plane.rough(_ROUGH)
    try:
        threshold = _long_wave_threshold(plane)
        if long_wave:
            return threshold or _nothing(flow, vary, 0.0, f"{flow}: no long-wave threshold in {vary}")
        if threshold is None:
            return _search(plane, rough, getattr(flow, vary))
        beyond = rough.most_unstable(threshold.value)
        return _search(plane, rough, threshold.value, beyond) if beyond else threshold
    except ModeLost as reason:
        return _nothing(flow, vary, None, str(reason))


def _search(plane, rough, value, point=None):
    """The nose next to `value`; from between a stable and an unstable value where Newton's method needs it."""
    with suppress(ModeLost, ParameterError, np.linalg.LinAlgError):
        nose = _nose(plane, rough, point or rough.near_largest(value))
        if rough.most_unstable(nose.value, nose.k) is None:
            return nose
    return _nose(plane, rough, rough.near_largest(rough.bracket(value)))


def _nose(plane, rough, point):
    """The nose near `point`: Newton on growth = d growth / d log k = 0, at last with full accuracy."""
    first = point
    for _ in range(_ITERATIONS):
        if first.value and not 1 / _ASTRAY < point.value / first.value < _ASTRAY:
            raise ModeLost(f"{first.mode.flow}: no nose of the neutral curve is near {plane.vary} = {first.value:.6g}")
        jacobian = _jacobian(rough, point)
        step = -np.linalg.solve(jacobian, _equations(rough, point)[0])
        largest = max(abs(step[0]), abs(step[1]) / (abs(point.value) or 1.0))
        if largest < _SETTLED:
            break
        step = step * min(1.0, _LARGEST / largest)
        point = rough.move(point, point.k * exp(step[0]), point.value + float(step[1]))
    else:
        raise ModeLost(f"{point.mode.flow}: Newton's method for the nose of the neutral curve does not settle "
                       f"(k = {point.k:.6g}, {plane.vary} = {point.value:.6g})")
    for _ in range(_POLISH):
        point = plane.move(point, point.k * exp(step[0]), point.value + float(step[1]))
        step = -np.linalg.solve(jacobian, _equations(rough, point)[0])
        if abs(point.growth) < point.mode.error and abs(step[0]) < 1e-9:
            break
    bend = jacobian[1, 0] * point.k**rough.power
    error = (point.mode.error + abs(point.growth)) / abs(point.by_value.real)
    k_error = point.k * (point.k * point.mode.slope_error + abs(point.gradient[0])) / abs(bend)
    return _record(point, plane.vary, error, k_error, plane.tolerance)


def _equations(plane, point):
    """growth / k^power and its derivative in log k, which vanish at the nose; and the derivatives of the first.

    With the power of the long-wave growth they do not vanish everywhere at k = 0.
    """
    scale = point.k**-plane.power
    gradient = scale * (point.gradient - np.array([plane.power * point.growth, 0.0]))
    return np.array([scale * point.growth, gradient[0]]), gradient


def _jacobian(plane, point):
    """Of the two equations in (log k, value): the second row by a difference along k."""
    beside = plane.move(point, point.k * exp(_STRIDE), point.value)
    first, second = (_equations(plane, at)[1] for at in (point, beside))
    return np.array([first, (second - first) / _STRIDE])


def _record(point, vary, error, k_error, tolerance):
    status = point.mode.status
    if is_resolved(status) and not error <= max(tolerance, 1e-9) * abs(point.value):
        status = f"error {error:.1e} of {vary} exceeds tolerance"
    return NeutralPoint(point.mode.flow, vary, point.k, point.value, point.mode.phase_speed, float(error),
                        float(k_error), status)


def _nothing(flow, vary, k, why):
    return NeutralPoint(flow, vary, k, None, None, None, None, why)


def _long_wave_threshold(plane):
    """The long-wave threshold next to the value of the flow, or None."""
    if not plane.flow.has_surface_mode():
        return None
    value = getattr(plane.flow, plane.vary)
    try:
        old, new = (_long_wave_growth(plane, v) for v in (value, value * 1.01 if value else 0.01))
        for _ in range(_ITERATIONS):
            slope = (new[1] - old[1]) / (new[0] - old[0])
            if slope == 0:
                return None
            step, limit = -new[1] / slope, 0.5 * abs(new[0]) or 1.0
            old, new = new, _long_wave_growth(plane, new[0] + float(np.clip(step, -limit, limit)))
            if abs(new[0] - old[0]) < 1e-7 * abs(new[0]) or abs(new[1]) <= new[2]:
                break
        else:
            return None
    except (ModeLost, ParameterError):
        return None
    value, growth, spread, mode = new
    error = (abs(growth) + spread) / abs(slope)
    return NeutralPoint(mode.flow, plane.vary, 0.0, value, mode.phase_speed, float(error), 0.0, RESOLVED)


def _long_wave_growth(plane, value):
    """(value, coefficient a of growth = a k^2 as k -> 0, its spread between two degrees, the mode)."""
    solver = plane.solver(value)
    mode = surface_mode(solver, _LONG)
    if abs(mode.rate.real) > 1e-6 * abs(mode.rate):
        raise ModeLost("growth is of lower order than k^2")
    rung = solver.degrees.index(mode.degree)
    ahead = [solver.solve(mode.k, mode.rate, (mode.degree, mode.x, mode.y), degree)
             for degree in solver.degrees[rung + 1: rung + 3]]
    slopes = [other.rate_slope.real for other in (mode, *ahead)]
    return value, slopes[-1], abs(slopes[-1] - slopes[-2]) + _LONG_ERROR * mode.error / solver.width(mode.k), mode


def neutral_curve(flow: "Flow", vary: str, k: "ArrayLike", *, tolerance: float = TOLERANCE,
                  max_degree: int = DEGREES[-1]) -> NeutralCurve:
    """Return the `NeutralCurve` through the critical point: at each wavenumber of k, all its values of `vary`.

    A wavenumber that the curve does not reach keeps one point without numbers, whose status says so.
    Raises NotResolved where there is no critical point to start from.
    """
    return joined(list(neutral_parts(flow, vary, k, tolerance=tolerance, max_degree=max_degree)))


def neutral_parts(flow: "Flow", vary: str, k: "ArrayLike", *, tolerance: float = TOLERANCE,
                  max_degree: int = DEGREES[-1]) -> Iterator[NeutralCurve]:
    """Yield the curve of `neutral_curve` with the points of one wavenumber at a time: `joined` puts them together."""
    check_parameter_name(check_flow(flow), vary)
    wavenumbers = check_wavenumbers(k)
    tolerance, max_degree = check_accuracy(tolerance, max_degree)
    origin = _critical(flow, vary, tolerance, max_degree)
    if origin.value is None:
        raise NotResolved(origin.status)
    plane = Plane(flow, vary, tolerance, max_degree)
    trace = one_thread(_trace)(plane.rough(_ROUGH), origin, min(wavenumbers), max(wavenumbers))
    line = np.array([(point.k, point.value) for point in trace])
    for wavenumber in wavenumbers.tolist():
        yield NeutralCurve(flow, vary, _crossings(plane, trace, wavenumber), line,
                           {"tolerance": tolerance, "max_degree": max_degree})


def joined(parts: list[NeutralCurve]) -> NeutralCurve:
    """Return the parts as one curve."""
    return replace(parts[0], points=tuple(point for part in parts for point in part.points))


@one_thread
def _crossings(plane, trace, k):
    """The neutral points at one wavenumber, by increasing value; one that says so where there are none."""
    found = [_at_wavenumber(plane, a, b, k) for a, b in zip(trace, trace[1:], strict=False)
             if (a.k - k) * (b.k - k) <= 0 and b.k != k]
    none = _nothing(plane.flow, plane.vary, k, f"the neutral curve does not reach k = {k:g}")
    return tuple(sorted(found, key=lambda point: point.value or 0.0) or [none])


def _trace(plane, origin, low, high):
    """Points along the neutral curve through `origin`, from end to end."""
    if origin.k == 0:
        start = plane.leading(0.5 * min(low, 0.02), origin.value)
        return _walk(plane, start, 1, 0.0, high)
    start = plane.leading(origin.k, origin.value)
    back, ahead = (_walk(plane, start, side, low, high) for side in (-1, 1))
    return [*reversed(back[1:]), *ahead]


def _walk(plane, start, side, low, high):
    """Follow the curve by arclength until it leaves low <= k <= high, or as far as the mode can be followed."""
    points, step = [_project(plane, start)], _ARC[0]
    tangent = _tangent(points[0])
    tangent = side * tangent * np.sign(tangent[0])
    while len(points) < _POINTS:
        now = points[-1]
        ahead = now.k * exp(step * tangent[0]), now.value * exp(step * tangent[1])
        try:
            new = _project(plane, plane.move(now, *ahead))
        except (ModeLost, ParameterError):
            new = None
        turn = np.inf
        if new is not None:
            direction = _tangent(new)
            direction = direction if direction @ tangent > 0 else -direction
            turn = np.arccos(min(1.0, direction @ tangent))
        if turn > 2 * _TURN:
            step /= 2
            if step < 1e-5:
                break
            continue
        points.append(new)
        tangent, step = direction, min(_ARC[1], step * min(2.0, _TURN / max(turn, 1e-9)))
        leaving = new.k * _MARGIN < low and tangent[0] < 0 or new.k > high * _MARGIN and tangent[0] > 0
        if leaving or abs(log(new.value / start.value)) > log(_SPAN):
            break
    return points


def _scaled_gradient(point):
    """Gradient of the growth rate in (log k, log value)."""
    return point.gradient * (1.0, point.value)


def _tangent(point):
    across = _scaled_gradient(point)
    return np.array([-across[1], across[0]]) / np.hypot(*across)


def _project(plane, point):
    """The point of the curve next to this one, by Newton steps along the gradient."""
    for _ in range(_ITERATIONS):
        gradient = _scaled_gradient(point)
        step = -point.growth * gradient / (gradient @ gradient)
        if np.hypot(*step) > _LARGEST:
            raise ModeLost("the neutral curve is not near")
        if np.hypot(*step) < 1e-3 * _ARC[0]:
            return point
        point = plane.move(point, point.k * exp(step[0]), point.value * exp(step[1]))
    raise ModeLost("the neutral curve is not near")


def _at_wavenumber(plane, left, right, k):
    """The neutral point at k between two neighbours on the curve, by Newton in the value."""
    share = log(k / left.k) / log(right.k / left.k)
    near = left if share < 0.5 else right
    try:
        point = plane.move(near, k, left.value * (right.value / left.value) ** share)
        for _ in range(_ITERATIONS):
            step = -point.growth / point.by_value.real
            if abs(point.growth) < 0.5 * point.mode.error or abs(step) < 1e-14 * abs(point.value):
                break
            step = float(np.clip(step, -0.2 * abs(point.value), 0.2 * abs(point.value)))
            point = plane.move(point, k, point.value + step)
    except (ModeLost, ParameterError) as reason:
        return _nothing(plane.flow, plane.vary, k, str(reason))
    error = (point.mode.error + abs(point.growth)) / abs(point.by_value.real)
    return _record(point, plane.vary, error, 0.0, plane.tolerance)
