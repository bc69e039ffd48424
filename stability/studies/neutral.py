"""Neutral stability: where the growth rate vanishes, in a parameter and in the wavenumber.

`critical` finds the values of one parameter at which the largest growth rate over all wavenumbers changes sign
(`stability.critical`), `neutral_curve` those at which a mode is neutral at given wavenumbers (`studies.crossings`).
The line through those is followed by arclength through the plane of k and the parameter, past its turning points.
"""

from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, fields, replace
from math import exp, inf
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ..checks import check_flag, check_range, check_wavenumbers, shown
from ..errors import ModeLost, NotResolved, ParameterError, naming
from ..flows.base import check_flow, numeric, span_of
from ..modes.solver import DEGREES, TOLERANCE, check_accuracy
from ..numerics.threads import one_thread
from ..output.panels import DOTS, OTHERS, PHASE_SPEED, POINTS, WAVENUMBER, Axis, Curve, Panel, scale_of, swept_curves
from ..output.record import Record
from ..output.symbols import axis_label, symbol_of, value_text
from ..output.text import Row, measured
from ..status import inside, is_resolved
from .crossings import zeros_at
from .ridges import Landscape
from .thresholds import critical_zeros

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from ..flows import Flow

_ROUGH = 1e-5  # tolerance of the arclength continuation
_ITERATIONS = 20
_LARGEST = 0.4  # step of Newton in log k, and relative in the parameter
_ARC = 0.02, 0.25  # first and largest step along the curve, in log k and log value
_TURN = 0.15  # angle between neighbouring tangents at which the step is kept
_POINTS = 400
_MARGIN = 1.15  # factor in k beyond the range asked for within which the curve may turn back
_DRAWN = 0.03  # distance from a curve, in log k and log value, within which a point lies on it


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

    def _value_axis(self) -> Axis:
        return Axis(self.vary, f"{symbol_of(self.flow, self.vary)} at zero growth")


@dataclass(frozen=True, repr=False)
class NeutralPoint(_ZeroGrowth):
    """A value of the parameter `vary` at which a mode neither grows nor decays.

    `k` is its wavenumber (0: long-wave threshold), `error` and `k_error` bound the absolute errors of `value`
    and `k` (k_error is 0 where k was given); `status` is "resolved" or says what failed, and then the other
    numbers may be None. `others` are further values in the range that was searched: where the largest growth rate
    changes sign again, or, with "; inside" in their status, where a crest of growth does while other waves grow.
    `data_error` is the standard error of `value` from that of a measured base flow, None where nothing was measured.

    `flow` and `vary` are what was asked for, `settings` range, tolerance and the like, `remark` a note of the model.
    Units: `value`, `error` and `data_error` those of the parameter, `k` and `k_error` 1/L, `phase_speed` V. Writing
    raises ParameterError where a file cannot be written.

    >>> from stability import critical, flows
    >>> point = critical(flows.Film(slope_deg=45.0), "Re", span=(1.0, 1.5), long_wave=True)
    >>> f"{point.value:.10f}", point.k, point.status  # Yih (1963): (5/4) cot(slope)
    ('1.2500000000', 0.0, 'resolved')
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
    others: "tuple[NeutralPoint, ...]" = field(default=(), repr=False)
    remark: str | None = field(default=None, repr=False)
    data_error: float | None = field(default=None, repr=False)
    dimension: ClassVar[str] = "point"

    def panels(self) -> tuple[Panel, ...]:
        """(k, value), as in the figure of a curve, and the further values."""
        known = [point for point in (self, *self.others) if point.k is not None and point.value is not None]
        k, value, k_error, error = (np.array([getattr(point, name) for point in known], dtype=float)
                                    for name in ("k", "value", "k_error", "error"))
        status = tuple(point.status for point in known)
        first = int(self.value is not None)
        curves = [Curve(k[:first], value[:first], None, POINTS, k_error[:first], error[:first], None, status[:first])]
        if len(known) > first:
            curves.append(Curve(k[first:], value[first:], "further values", OTHERS, k_error[first:], error[first:], 0,
                                status[first:]))
        limits = {"xlim": (0, 2 * k.max() or 1), "ylim": sorted((0, 2 * value.max() or 1))} if known else {}
        return (Panel(WAVENUMBER, self._value_axis(), tuple(curves), limits=limits),)

    def rows(self) -> list[Row]:
        return [{**{name: value for name, value in point.row().items() if name != "status"}, "k_error": point.k_error,
                 "status": point.status} for point in (self, *self.others)]

    def notes(self) -> list[str]:
        return [naming(self.flow, self.remark)] if self.remark else []

    def row(self) -> Row:
        """Return the row of this point in the table of a curve."""
        return {"k": self.k, self.vary: self.value, "phase_speed": self.phase_speed, "error": self.error,
                **{name: getattr(self, name) for name in measured(self.flow)}, "status": self.status}


@dataclass(frozen=True, repr=False)
class NeutralCurve(_ZeroGrowth):
    """Neutral points at the wavenumbers asked for, by increasing value at each, and the `trace` (points, 2)
    of (k, value) along the whole curve from one end to the other.

    `flow` and `vary` are what was asked for, `points` (points,) are `NeutralPoint` records, `settings` range and
    tolerance. Values have the units of the parameter, k is in 1/L. Writing raises ParameterError where a file cannot be
    written.

    >>> from stability import flows, neutral_curve
    >>> curve = neutral_curve(flows.Poiseuille(), "Re", [1.0])
    >>> [f"{point.value:.4f}" for point in curve.points]
    ['5814.8288', '31956.4510']
    >>> curve.trace.shape[1]
    2
    """

    flow: Any
    vary: str
    points: tuple[NeutralPoint, ...]
    trace: np.ndarray = field(compare=False)
    settings: Mapping[str, Any] = field(default_factory=dict, compare=False)
    dimension: ClassVar[str] = "point"

    def panels(self) -> tuple[Panel, ...]:
        """The value and the phase speed on the neutral curve against k."""
        known = [point for point in self.points if point.value is not None]
        status = tuple(point.status for point in known)
        x = replace(WAVENUMBER, scale=scale_of(self.trace[:, 0]))
        k, value, error, speed = (np.array([getattr(point, name) for point in known], dtype=float)
                                  for name in ("k", "value", "error", "phase_speed"))
        curve = Curve(*self.trace.T), Curve(k, value, None, DOTS, None, error, 0, status)
        return (Panel(x, replace(self._value_axis(), scale=scale_of(self.trace[:, 1])), curve),
                Panel(x, PHASE_SPEED, (Curve(k, speed, None, POINTS, status=status),)))

    def rows(self) -> list[Row]:
        return [point.row() for point in self.points]


@dataclass(frozen=True, repr=False)
class NeutralSweep(_ZeroGrowth):
    """The critical point of every flow of a sweep over the parameter `over` of `flow`.

    `flow`, `vary` and `over` are what was asked for, `points` (flows,) are `NeutralPoint` records, units as there.
    Writing raises ParameterError where a file cannot be written.

    >>> from stability import critical, flows
    >>> film = flows.Film()
    >>> points = (critical(film, "Re", span=(1.0, 3.0), long_wave=True),)
    >>> NeutralSweep(film, "Re", "slope_deg", points)["Re"].round(6).tolist()  # (5/4) cot(30 deg)
    [2.165064]
    """

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

    def panels(self) -> tuple[Panel, ...]:
        """The value and the wavenumber of zero growth against the swept parameter."""
        known = [point for point in self.points if point.value is not None]
        x = [getattr(point.flow, self.over) for point in known]
        symbol = symbol_of(self.flow, self.over)
        scale = scale_of([getattr(point.flow, self.over) for point in self.points])
        axis = Axis(self.over, axis_label(self.flow, self.over), scale)
        status = tuple(point.status for point in known)
        level = f"{symbol} = {value_text(inf)}"
        return tuple(Panel(axis, y, swept_curves(x, [getattr(point, name) for point in known], level, status=status,
                                                 y_error=np.array([getattr(point, bars) for point in known])))
                     for y, name, bars in ((self._value_axis(), "value", "error"),
                                           (replace(WAVENUMBER, label="wavenumber $k$ (0: long waves)"), "k",
                                            "k_error")))

    def rows(self) -> list[Row]:
        return [{self.over: getattr(point.flow, self.over), **point.row()} for point in self.points]

    def about(self) -> dict[str, Any]:
        return {**super().about(), "over": self.over}


def critical(flow: "Flow", vary: str, *, span: tuple[float, float] | None = None,
             search: tuple[float, float] | None = None, long_wave: bool = False, tolerance: float = TOLERANCE,
             max_degree: int = DEGREES[-1], strict: bool = True) -> NeutralPoint:
    """Return the `NeutralPoint` at which the largest growth rate over k is zero as `vary` varies.

    All values in the `span` (low, high) of the parameter are sought, whatever value the flow has, by the growth of all
    modes over `search` = (low, high) in k; of ill-posed flows by that of the surface mode. Without a span it is what
    the flow says (`stability flows FLOW`). The first value that is met from the stable side is returned, with the
    others in `others`. `long_wave` asks for the threshold as k -> 0 alone, even where waves of finite length grow on
    its stable side. Raises NotResolved if there is none; with strict=False the record says so in `status`.

    >>> from stability.flows import Film
    >>> point = critical(Film(slope_deg=45.0), "Re", span=(0.5, 5.0))
    >>> f"{point.value:.9f} at k = {point.k:g}"
    '1.250000000 at k = 0'

    `span` and the value have the units of the parameter, `search` and k are in 1/L. Raises ParameterError for what is
    no flow, parameter or range.
    """
    strict, long_wave = check_flag("strict", strict), check_flag("long_wave", long_wave)
    (point,) = critical_sweep([check_flow(flow)], vary, span=span, search=search, long_wave=long_wave,
                              tolerance=tolerance, max_degree=max_degree)
    if strict and not is_resolved(point.status):
        raise NotResolved(point.status)
    return point


def critical_sweep(flows: "Iterable[Flow]", vary: str, *, span: tuple[float, float] | None = None,
                   search: tuple[float, float] | None = None, long_wave: bool = False, tolerance: float = TOLERANCE,
                   max_degree: int = DEGREES[-1]) -> Iterator[NeutralPoint]:
    """Yield `critical` of each flow in turn; what failed is in its status."""
    tolerance, max_degree = check_accuracy(tolerance, max_degree)
    for flow in flows:
        yield _critical(_landscape(flow, vary, span, search, tolerance, max_degree), long_wave)


def _landscape(flow, vary, span, search, tolerance, max_degree):
    check_parameter_name(flow, vary)
    span = span_of(flow, vary) if span is None else check_range(span, "span")
    search = None if search is None else check_range(search, "search")
    return Landscape(flow, vary, span, search, tolerance, max_degree)


@one_thread
def _critical(land, long_wave):
    settings = {**_settings(land), **({"long_wave": "yes"} if long_wave else {})}
    found = critical_zeros(land, long_wave)
    points = [_record(land, zero, settings) for zero in found.boundaries]
    points += [replace(point, status=inside(point.status)) for point in
               (_record(land, zero, settings) for zero in found.inner)]
    if found.boundaries:
        return replace(points[0], others=tuple(points[1:]), remark=found.remark)
    nothing = _nothing(land.flow, land.vary, 0.0 if long_wave else None, found.why)
    return replace(nothing, settings=settings, others=tuple(points), remark=found.remark)


def _settings(land):
    """What a result depends on besides flow and parameter."""
    plane = land.planes[0]
    return {"range": f"{land.span[0]:g} .. {land.span[1]:g}", "search": f"{land.search[0]:g} .. {land.search[1]:g}",
            "tolerance": plane.tolerance,
            "max_degree": plane.max_degree}


def check_parameter_name(flow: "Flow", name: str) -> str:
    """Return `name` if it is a numeric parameter of the flow, else raise a ParameterError."""
    known = [item.name for item in fields(flow) if numeric(item)]
    if not (isinstance(name, str) and name in known):
        raise ParameterError(f"{flow.name} has no numeric parameter {shown(name)} to vary; it has {', '.join(known)}")
    return name


def _record(land, zero, settings):
    flow = land.planes[0].flow_at(zero.value)
    return NeutralPoint(flow, land.vary, zero.k, zero.value, zero.mode.phase_speed, zero.error, zero.k_error,
                        zero.status, settings, data_error=zero.data_error)


def _nothing(flow, vary, k, why):
    return NeutralPoint(flow, vary, k, None, None, None, None, why)


def neutral_curve(flow: "Flow", vary: str, k: "ArrayLike", *, span: tuple[float, float] | None = None,
                  tolerance: float = TOLERANCE, max_degree: int = DEGREES[-1]) -> NeutralCurve:
    """Return the `NeutralCurve` of a flow: at each wavenumber of k, all values of `vary` in the `span` at which a mode
    is neutral.

    A wavenumber without such a value keeps one point without numbers, whose status says so. What is found at one does
    not depend on the others.

    `k` (points,) is in 1/L, values and `span` have the units of the parameter. Raises ParameterError for what is no
    flow, parameter, wavenumber or range.

    >>> from stability import flows
    >>> curve = neutral_curve(flows.Poiseuille(), "Re", [1.02054744928533], span=(5700.0, 5900.0))
    >>> f"{curve.points[0].value:.4f}"  # the nose of the curve: Orszag (1971) has 5772.22
    '5772.2218'
    """
    return joined(list(neutral_parts(flow, vary, k, span=span, tolerance=tolerance, max_degree=max_degree)))


def neutral_parts(flow: "Flow", vary: str, k: "ArrayLike", *, span: tuple[float, float] | None = None,
                  tolerance: float = TOLERANCE, max_degree: int = DEGREES[-1]) -> Iterator[NeutralCurve]:
    """Yield the curve of `neutral_curve` with the points of one wavenumber at a time: `joined` puts them together."""
    wavenumbers = check_wavenumbers(k)
    tolerance, max_degree = check_accuracy(tolerance, max_degree)
    land = _landscape(check_flow(flow), vary, span, None, tolerance, max_degree)
    settings = {name: value for name, value in _settings(land).items() if name != "search"}
    drawn = np.empty((0, 2))
    for wavenumber in wavenumbers.tolist():
        points, lines = one_thread(_at_wavenumber)(land, wavenumber, settings, drawn, wavenumbers.min(),
                                                   wavenumbers.max())
        drawn = np.concatenate((drawn, *lines))
        yield NeutralCurve(flow, vary, points, np.concatenate((np.empty((0, 2)), *lines)), settings)


def joined(parts: list[NeutralCurve]) -> NeutralCurve:
    """Return the parts as one curve."""
    return replace(parts[0], points=tuple(point for part in parts for point in part.points),
                   trace=np.concatenate([part.trace for part in parts]))


def _at_wavenumber(land, k, settings, drawn, low, high):
    """The neutral points at one wavenumber, and the curves through those that lie on none that is drawn yet."""
    zeros, trouble, grows = zeros_at(land, k)
    points = [_record(land, zero, settings) for zero in zeros]
    if trouble:
        value, reason = next(iter(trouble.items()))
        doubt = f"others may be missing: at {land.vary} = {value:.4g}, {reason}"
        points = [replace(point, status=doubt) if is_resolved(point.status) else point for point in points]
    if not points:
        kind = "a mode grows" if grows == {True} else "all modes decay"
        why = f"the neutral curve does not reach k = {k:g}: {kind} at every {land.vary} from {land.span[0]:g} to " \
              f"{land.span[1]:g}"
        points = [_nothing(land.flow, land.vary, k, doubt if trouble else why)]
    lines = []
    for zero in zeros:
        if not _drawn(np.concatenate((drawn, *lines)), k, zero.value):
            with suppress(ModeLost, ParameterError, np.linalg.LinAlgError):
                lines.append(_trace(land, zero, low, high))
    return tuple(points), lines


def _drawn(lines, k, value):
    return bool(len(lines)) and float(np.nanmin(np.abs(np.log(lines / (k, value))).max(axis=1))) < _DRAWN


def _trace(land, zero, low, high):
    """Points (points + 1, 2) along the neutral curve through a zero, from end to end; a row of nan ends it."""
    (half,) = (index for index, flow in enumerate(land.planes[0].flow_at(zero.value).halves())
               if flow == zero.mode.flow)
    plane = land.planes[half].rough(_ROUGH)
    start = plane.adopt(land.planes[half].point(zero.k, zero.value, zero.mode))
    back, ahead = (_walk(plane, start, side, low, high, land.span) for side in (-1, 1))
    return np.array([*((point.k, point.value) for point in (*reversed(back[1:]), *ahead)), (np.nan, np.nan)])


def _walk(plane, start, side, low, high, span):
    """Follow the curve by arclength until it leaves low <= k <= high or the span, or as far as the mode can be
    followed."""
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
        if leaving or not span[0] <= new.value <= span[1]:
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
