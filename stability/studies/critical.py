"""Critical points: the values of one parameter at which the largest growth rate over all wavenumbers changes sign.

They are sought by `studies.thresholds`; here they are results.
"""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from math import inf
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ..checks import check_flag, check_range
from ..errors import NotResolved, naming
from ..flows.base import check_flow, check_parameter_name, span_of
from ..modes.accuracy import DEGREES, TOLERANCE, check_accuracy
from ..numerics.threads import one_thread
from ..output.panels import OTHERS, POINTS, WAVENUMBER, Axis, Curve, Panel, scale_of, swept_curves
from ..output.record import Record
from ..output.symbols import axis_label, symbol_of, value_text
from ..output.text import Row, measured
from ..status import Status, as_inside, is_resolved, unresolved
from .ridges import Landscape
from .thresholds import critical_zeros

if TYPE_CHECKING:
    from ..flows import Flow
    from ..modes.accuracy import Accuracy


class ZeroGrowth(Record):
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


def value_axis(result: ZeroGrowth) -> Axis:
    """The axis of the values that were solved for."""
    return Axis(result.vary, f"{symbol_of(result.flow, result.vary)} at zero growth")


@dataclass(frozen=True, repr=False)
class NeutralPoint(ZeroGrowth):
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
    status: Status
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
        return (Panel(WAVENUMBER, value_axis(self), tuple(curves), limits=limits),)

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
class NeutralSweep(ZeroGrowth):
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
                     for y, name, bars in ((value_axis(self), "value", "error"),
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
    accuracy = check_accuracy(tolerance, max_degree)
    for flow in flows:
        yield _critical(landscape_of(flow, vary, span, search, accuracy), long_wave)


def landscape_of(flow: "Flow", vary: str, span: Any, search: Any, accuracy: "Accuracy") -> Landscape:
    check_parameter_name(flow, vary)
    span = span_of(flow, vary) if span is None else check_range(span, "span")
    search = None if search is None else check_range(search, "search")
    return Landscape(flow, vary, span, search, accuracy)


@one_thread
def _critical(land: Landscape, long_wave: bool) -> "NeutralPoint":
    settings = {**settings_of(land), **({"long_wave": "yes"} if long_wave else {})}
    found = critical_zeros(land, long_wave)
    points = [point_of(land, zero, settings) for zero in found.boundaries]
    points += [replace(point, status=as_inside(point.status)) for point in
               (point_of(land, zero, settings) for zero in found.inner)]
    if found.boundaries:
        return replace(points[0], others=tuple(points[1:]), remark=found.remark)
    nothing = no_point(land.flow, land.vary, 0.0 if long_wave else None, found.why)
    return replace(nothing, settings=settings, others=tuple(points), remark=found.remark)


def settings_of(land: Landscape) -> dict[str, Any]:
    """What a result depends on besides flow and parameter."""
    return {"range": f"{land.span[0]:g} .. {land.span[1]:g}", "search": f"{land.search[0]:g} .. {land.search[1]:g}",
            **land.planes[0].accuracy.settings}


def point_of(land: Any, zero: Any, settings: Any) -> Any:
    flow = land.planes[0].flow_at(zero.value)
    return NeutralPoint(flow, land.vary, zero.k, zero.value, zero.mode.phase_speed, zero.error, zero.k_error,
                        zero.status, settings, data_error=zero.data_error)


def no_point(flow: Any, vary: Any, k: Any, why: Any) -> Any:
    return NeutralPoint(flow, vary, k, None, None, None, None, unresolved(why))
