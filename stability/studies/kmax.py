"""The fastest growing wavenumber, as a result: every maximum that `modes.crests` finds, the largest first."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from math import inf
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ..checks import check_flag, check_options, check_range
from ..errors import ModeLost, NotResolved, naming
from ..flows.base import check_flow
from ..modes.accuracy import DEGREES, TOLERANCE, check_accuracy
from ..modes.crest import Maximum, crest
from ..modes.crests import crest_mode, look, may_grow, search_of, surface_look
from ..modes.listing import listed
from ..modes.short_waves import Strip, ill_posed_strips
from ..modes.solver import Assembly, Solver
from ..numerics.threads import one_thread
from ..output.panels import (
    GROWTH_AT_K_MAX,
    GROWTH_RATE,
    K_MAX,
    OTHERS,
    POINTS,
    WAVENUMBER,
    Axis,
    Curve,
    Panel,
    scale_of,
    swept_curves,
)
from ..output.record import Record
from ..output.symbols import axis_label, symbol_of, value_text
from ..output.text import Row, measured
from ..status import Kind, Status, as_outgrown, is_outgrown, is_resolved, unresolved
from .choices import CREST_MODES
from .outgrown import faster

if TYPE_CHECKING:
    from ..flows import Flow

_OTHERS = "other local maxima"  # in figures
_ONE = 1e-9, 1e-6  # relative distances of k, beyond the errors, and of sigma within which two maxima are one


@dataclass(frozen=True, repr=False)
class Optimum(Record):
    """Local maxima of growth rates over k, by decreasing growth rate: of the mode that `settings` names.

    `status` is "resolved" or says why there is none; `k_max`, `growth_rate`, `phase_speed` and
    `error` (of k_max) belong to the first and raise NotResolved if there is none.

    `flow` is what was asked about, `maxima` are `Maximum` records with `k`, `error`, `growth_rate`, `mode` and
    `status`; `settings` has search, mode and tolerance, `strips` are the ill-posed parts of the flow where it is
    outgrown. Units: `k_max` and `error` 1/L, `growth_rate` V/L,
    `phase_speed` V.

    >>> from stability import flows, k_max
    >>> best = k_max(flows.Dune())
    >>> f"{best.k_max:.7f} {best.growth_rate:.7f} {best.phase_speed:.4f}", best.error < 1e-10, best.status
    ('0.8492020 0.2390205 1.0151', True, 'resolved')
    """

    flow: Any
    maxima: tuple[Maximum, ...]
    status: Status
    settings: Mapping[str, Any] = field(default_factory=dict, compare=False)
    strips: tuple[Strip, ...] = field(default=(), compare=False)
    dimension: ClassVar[str] = "flow"
    bounded: ClassVar[str] = "k_max"

    @property
    def best(self) -> Maximum:
        """The largest of the `maxima`; raises NotResolved if there is none."""
        if not self.maxima:
            raise NotResolved(naming(self.flow, self.status))
        return self.maxima[0]

    @property
    def k_max(self) -> float:
        """Its wavenumber, 1/L."""
        return self.best.k

    @property
    def error(self) -> float:
        """Bound of the absolute error of `k_max`, 1/L."""
        return self.best.error

    @property
    def growth_rate(self) -> float:
        """The largest growth rate, V/L."""
        return self.best.growth_rate

    @property
    def phase_speed(self) -> float:
        """The phase speed at `k_max`, V."""
        return self.best.mode.phase_speed

    def panels(self) -> tuple[Panel, ...]:
        """The maxima at (k, growth rate): the largest, and the others."""
        k, growth, error = (np.array([getattr(one, name) for one in self.maxima], dtype=float)
                            for name in ("k", "growth_rate", "error"))
        best = Curve(k[:1], growth[:1], None, POINTS, error[:1], status=(self.status,) * len(k[:1]))
        others = Curve(k[1:], growth[1:], _OTHERS, OTHERS, error[1:], of=0)
        return (Panel(WAVENUMBER, GROWTH_RATE, (best, others) if len(k) > 1 else (best,)),)

    @property
    def data_error(self) -> float | None:
        """Standard error of k_max from that of a measured base flow."""
        return self.best.data_error

    @property
    def growth_data_error(self) -> float | None:
        """That of the growth rate at k_max."""
        return self.best.mode.data_error

    def rows(self) -> list[Row]:
        numbers = {name: getattr(self, name) if self.maxima else None
                   for name in ("k_max", "growth_rate", "phase_speed", "error",
                                *measured(self.flow, "growth_data_error"))}
        return [{**numbers, "maxima": [[one.k, one.growth_rate] for one in self.maxima], "status": self.status}]

    def columns(self) -> dict[str, np.ndarray]:
        return Optima(self.flow, None, (self,)).columns()

    def notes(self) -> list[str]:
        return Optima(self.flow, None, (self,)).notes()


@dataclass(frozen=True, repr=False)
class Optima(Record):
    """The `Optimum` of every flow of a sweep over the parameter `over` of `flow`; a single one if `over` is None.

    >>> from dataclasses import replace
    >>> from stability import flows
    >>> bed = flows.Dune()
    >>> found = Optima(bed, "Re", tuple(k_max_sweep(replace(bed, Re=Re) for Re in (1.0, 10.0))))
    >>> [f"{optimum.k_max:.6f}" for optimum in found.optima]
    ['0.584606', '0.849202']

    `flow`, `over` and `method` are what was asked for, `optima` (flows,) the answers. Units are those of `Optimum`; an
    optimum without maxima raises NotResolved when it is asked for its numbers, rows hold None there.
    """

    flow: Any
    over: str | None
    optima: tuple[Optimum, ...]
    method: str = "collocation"
    bounded: ClassVar[str] = "k_max"

    @property
    def dimension(self) -> str:
        return self.over or "flow"

    @property
    def swept(self) -> tuple[str | None, ...]:
        return (self.over,)

    @property
    def settings(self) -> Mapping[str, Any]:  # type: ignore[override]
        return self.optima[0].settings

    def panels(self) -> tuple[Panel, ...]:
        """k_max and its growth rate against the swept parameter, with the local maxima that are not the largest."""
        name = self.over or ""
        symbol = symbol_of(self.flow, name) if name else ""
        level = f"{symbol} = {value_text(inf)}"
        x = [getattr(optimum.flow, name) if name else 0.0 for optimum in self.optima]
        scale = scale_of(x)
        pairs = [(value, one) for value, one in zip(x, self.optima, strict=True) if one.maxima]
        others = [(value, one) for value, optimum in pairs for one in optimum.maxima[1:]]
        panels = []
        for y, field_name, bars in (K_MAX, "k", "error"), (GROWTH_AT_K_MAX, "growth_rate", None):
            curves = swept_curves([value for value, _ in pairs],
                                  [getattr(one.maxima[0], field_name) for _, one in pairs], level,
                                  y_error=np.array([one.maxima[0].error for _, one in pairs]) if bars else None,
                                  status=tuple(one.status for _, one in pairs))
            if others:
                curves += swept_curves([value for value, _ in others],
                                       [getattr(one, field_name) for _, one in others], level, _OTHERS, OTHERS, of=0)
            panels.append(Panel(Axis(name or "flow", axis_label(self.flow, name) if name else "", scale),
                                replace(y, scale=scale if pairs else "linear"), curves))
        return tuple(panels)

    def rows(self) -> list[Row]:
        return [{**self._swept(optimum), **row} for optimum in self.optima for row in optimum.rows()]

    def columns(self) -> dict[str, np.ndarray]:
        """Return the columns of the rows, sigma at k_max, and all maxima as arrays (optima, maximum) if any."""
        most = max(len(optimum.maxima) for optimum in self.optima)
        maxima = np.full((2, len(self.optima), most), np.nan)
        sigma = np.full(len(self.optima), complex(np.nan, np.nan))
        for index, optimum in enumerate(self.optima):
            for rank, one in enumerate(optimum.maxima):
                maxima[:, index, rank] = one.k, one.growth_rate
            if optimum.maxima:
                sigma[index] = optimum.best.mode.sigma
        columns = {**super().columns(), "sigma": sigma}
        return {**columns, "maxima_k": maxima[0], "maxima_growth_rate": maxima[1]} if most else columns

    def notes(self) -> list[str]:
        ahead = [optimum for optimum in self.optima if is_outgrown(optimum.status)]
        if not ahead:
            return []
        where = f" at {len(ahead)} of {len(self.optima)} values of {self.over}, first here" if self.over else ""
        strips = "; ".join(map(str, ahead[0].strips))
        why = f": {strips}" if strips else ""
        return [naming(ahead[0].flow, f"an internal mode outgrows the surface mode at k_max{where}{why}")]

    def about(self) -> dict[str, Any]:
        return {"over": self.over} if self.over else {}

    def _swept(self, optimum: Optimum) -> Row:
        return {self.over: getattr(optimum.flow, self.over)} if self.over else {}


def k_max(flow: "Flow", search: tuple[float, float] | None = None, mode: str | None = None, *,
          tolerance: float = TOLERANCE, max_degree: int = DEGREES[-1], strict: bool = True) -> Optimum:
    """Return the `Optimum` of a flow: where the growth rate is largest, `search` = (low, high) bounding k.

    mode="leading" takes the fastest of all modes (the default where the flow is well posed), "surface" the slow
    surface mode alone (the default of ill-posed flows, whose internal modes grow without bound). Without a search it
    reaches to waves much shorter than the layers, and for a surface mode its lower end moves down until growth is a
    power of k. Only maxima with positive growth rate count: a flow that decays everywhere has none. Raises
    NotResolved if there is none; with strict=False the record says so in `status`.

    Wavenumbers are in 1/L, growth rates in V/L. Raises ParameterError for what is no flow, range or mode.

    >>> from stability import flows
    >>> best = k_max(flows.Dune(shields=2.0, Re=10.0))
    >>> f"{best.k_max:.7f}, growth rate {best.growth_rate:.7f}"
    '0.8492020, growth rate 0.2390205'
    """
    strict = check_flag("strict", strict)
    (optimum,) = k_max_sweep([check_flow(flow)], search, mode, tolerance=tolerance, max_degree=max_degree)
    if strict and not is_resolved(optimum.status):
        raise NotResolved(naming(flow, optimum.status))
    return optimum


def k_max_sweep(flows: "Iterable[Flow]", search: tuple[float, float] | None = None, mode: str | None = None, *,
                tolerance: float = TOLERANCE, max_degree: int = DEGREES[-1]) -> Iterator[Optimum]:
    """Yield the `Optimum` of each flow in turn; what failed is in its status.

    Flows with the same equations share their matrices (dunes at different Re, say).
    """
    accuracy = check_accuracy(tolerance, max_degree)
    search = None if search is None else check_range(search, "search")
    mode = None if mode is None else check_options("mode", mode, CREST_MODES)
    assembly = None
    for flow in flows:
        assembly = assembly.serving(flow) if assembly else Assembly(flow)
        yield _optimum(Solver(flow, accuracy, assembly), search, mode or crest_mode(flow))


@one_thread
def _optimum(solver: Any, search: Any, mode: Any) -> Any:
    if mode == "surface" and not solver.flow.has_surface_mode():
        solver.flow.long_wave(1.0)  # says so
    low, high = search or search_of(solver.flow, mode)
    settings = {"mode": mode, **solver.accuracy.settings}
    if solver.flow.decays:
        return Optimum(solver.flow, (), _stable("leading", high), settings)
    try:
        looks = [surface_look(solver, low, high, growing=True)] if solver.flow.has_surface_mode() else []
        looks += [look(solver, low, high)] if mode == "leading" else []
    except ModeLost as reason:
        return Optimum(solver.flow, (), unresolved(reason), settings)
    found, lost = _maxima(solver, [pair for one in looks for pair in one.brackets])
    inside = [one for one in found if search is None or low <= one.k <= high]
    maxima = _distinct(sorted(inside, key=lambda one: -one.growth_rate))
    doubt = lost or (_outdone(solver, maxima[0]) if maxima and mode == "leading" else None)
    status = doubt or _status(solver, looks, found, maxima, mode, low, high)
    strips = ()
    if mode == "surface" and maxima and faster(solver, maxima[0].mode):
        status, strips = as_outgrown(status), ill_posed_strips(solver.flow)
    return Optimum(solver.flow, tuple(maxima), status, settings, strips)


def _maxima(solver: Any, brackets: Any) -> Any:
    """The positive maxima in the brackets, and why the mode is lost in one of them, or None."""
    solvers, found, lost = {half.flow: half for half in solver.halves}, [], None
    for left, right in brackets:
        if may_grow(left, right):
            try:
                found.append(crest(solvers[left.flow], left, right))
            except ModeLost as reason:
                lost = unresolved(reason)
    return [maximum for maximum in found if maximum.growth_rate > 0], lost


def _outdone(solver: Solver, best: Maximum) -> Any:
    """Why the largest maximum may not be the answer by the complete list of modes at its wavenumber, or None."""
    try:
        known = listed(solver, best.k, 1)
    except ModeLost as reason:
        return unresolved(reason)
    first = known.modes[0]
    if first.growth_rate > best.growth_rate + first.error + best.mode.error:
        return unresolved(f"another mode grows at {first.growth_rate:.6g} at k = {best.k:.6g}")
    return None if known.sure else known.status[0]


def _properly(solver: Solver, mode: Any) -> Any:
    """A mode of a rough look with full accuracy."""
    (half,) = (half for half in solver.halves if half.flow == mode.flow)
    return half.refined(mode)


def _distinct(maxima: list[Maximum]) -> list[Maximum]:
    kept = []
    for one in maxima:
        if not any(abs(one.k - other.k) <= one.error + other.error + _ONE[0] * one.k
                   and abs(one.mode.sigma - other.mode.sigma) <= _ONE[1] * abs(one.mode.sigma) for other in kept):
            kept.append(one)
    return kept


def _status(solver: Any, looks: Any, found: Any, maxima: Any, mode: Any, low: Any, high: Any) -> Any:
    """Whether the largest maximum is known to be the answer, or why not."""
    trouble = [one.trouble for one in looks if one.trouble]
    if trouble:
        return unresolved(trouble[0])
    best = maxima[0].growth_rate if maxima else 0.0
    ends = [[_properly(solver, node) for one in looks for node in one.ends[side] if node.growth_rate > best]
            for side in (0, 1)]
    below = [node for node in ends[0] if node.slope.real < 0 and node.growth_rate > best + node.error]
    above = [node for node in ends[1] if node.slope.real > 0 and node.growth_rate > best + node.error]
    outside = [one for one in found if one not in maxima and one.growth_rate > best]
    if above:
        return unresolved(f"growth still rises at k = {high:g}, the end of the search")
    if outside or below:
        larger = min([*outside, *below], key=lambda one: one.k)
        return unresolved(f"growth is larger at k = {larger.k:.6g}, outside of the search")
    return maxima[0].status if maxima else _stable(mode, high)


def _stable(mode: str, high: float) -> Status:
    which = "the surface mode does not grow" if mode == "surface" else "no waves grow"
    return Status(Kind.STABLE, f"{which} for k up to {high:g}")
