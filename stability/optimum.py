"""The fastest growing wavenumber: a global look along the surface mode, then Newton on d sigma_r / dk = 0.

The look starts in the long-wave regime, where growth is a power of k, and follows the mode with its
analytic slope in steps that its predictor can vouch for; a maximum lies wherever the slope turns from
positive to negative. Every one found is refined, because the largest can change branch.
"""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from math import exp, log
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from .checks import check_flag, check_wavenumbers, shown
from .errors import ModeLost, NotResolved, ParameterError, naming
from .flows.base import check_flow
from .mode import Mode
from .output import Row
from .record import Record
from .solver import DEGREES, TOLERANCE, Assembly, Solver, check_accuracy
from .status import RESOLVED, STABLE, is_outgrown, is_resolved
from .threads import one_thread
from .tracking import follow, surface_mode, survey
from .wellposed import flag_outgrown, well_posedness

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from .flows import Flow

SEARCH = (1e-2, 100.0)  # default range of k; the lower end moves down until growth is a power law
_ROUGH = 1e-4  # tolerance of the global look: small systems find the brackets
_STEP = 0.5  # largest of the global look, in log k
_DECAYED = 10.0  # the look ends once the mode has decayed over this factor in k ...
_SHORT = 10.0  # ... and waves are this short: a second branch may grow where the first has decayed
_ITERATIONS = 20


@dataclass(frozen=True)
class Maximum:
    """A local maximum of the growth rate: `error` bounds the absolute error of k."""

    k: float
    error: float
    mode: Mode

    @property
    def growth_rate(self) -> float:
        return self.mode.growth_rate


@dataclass(frozen=True, repr=False)
class Optimum(Record):
    """All local maxima of the growth rate of the surface mode, by decreasing growth rate.

    `status` is "resolved" or says why there is none; `k_max`, `growth_rate`, `phase_speed` and
    `error` (of k_max) belong to the first and raise NotResolved if there is none.
    """

    flow: Any
    maxima: tuple[Maximum, ...]
    status: str
    settings: Mapping[str, Any] = field(default_factory=dict, compare=False)
    dimension: ClassVar[str] = "flow"
    bounded: ClassVar[str] = "k_max"

    @property
    def best(self) -> Maximum:
        if not self.maxima:
            raise NotResolved(naming(self.flow, self.status))
        return self.maxima[0]

    @property
    def k_max(self) -> float:
        return self.best.k

    @property
    def error(self) -> float:
        return self.best.error

    @property
    def growth_rate(self) -> float:
        return self.best.growth_rate

    @property
    def phase_speed(self) -> float:
        return self.best.mode.phase_speed

    def plot(self, ax: "Axes | None" = None) -> "Axes":
        """Mark the maxima at (k, growth rate) in the matplotlib Axes `ax`, or in a new one; return it."""
        from . import plots

        return plots.maxima(self, plots.axes_or_new(ax))

    def rows(self) -> list[Row]:
        numbers = {name: getattr(self, name) if self.maxima else None
                   for name in ("k_max", "growth_rate", "phase_speed", "error")}
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

    def plot(self, ax: "Axes | None" = None, quantity: str = "k_max") -> "Axes":
        """Draw k_max or growth_rate against the swept parameter into the matplotlib Axes `ax`, or a new one; return it.

        Local maxima that are not the largest are drawn too.
        """
        from . import plots

        return plots.optima(self, plots.axes_or_new(ax), quantity)

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
        faster = [optimum.flow for optimum in self.optima if is_outgrown(optimum.status)]
        if not faster:
            return []
        where = f" at {len(faster)} of {len(self.optima)} values of {self.over}, first here" if self.over else ""
        strips = "; ".join(map(str, well_posedness(faster[0]).strips))
        return [naming(faster[0], f"an internal mode outgrows the surface mode at k_max{where}: {strips}")]

    def about(self) -> dict[str, Any]:
        return {"over": self.over} if self.over else {}

    def _swept(self, optimum: Optimum) -> Row:
        return {self.over: getattr(optimum.flow, self.over)} if self.over else {}


def k_max(flow: "Flow", search: tuple[float, float] = SEARCH, *, tolerance: float = TOLERANCE,
          max_degree: int = DEGREES[-1], strict: bool = True) -> Optimum:
    """Return the `Optimum` of a flow: where the growth rate of its surface mode is largest.

    Only maxima with positive growth rate count: a flow that decays everywhere has none. Raises
    NotResolved if there is none; with strict=False the record says so in `status`.
    """
    strict = check_flag("strict", strict)
    (optimum,) = k_max_sweep([check_flow(flow)], search, tolerance=tolerance, max_degree=max_degree)
    if strict and not is_resolved(optimum.status):
        raise NotResolved(naming(flow, optimum.status))
    return optimum


def k_max_sweep(flows: "Iterable[Flow]", search: tuple[float, float] = SEARCH, *, tolerance: float = TOLERANCE,
                max_degree: int = DEGREES[-1]) -> Iterator[Optimum]:
    """Yield the `Optimum` of each flow in turn; what failed is in its status.

    Flows with the same equations share their matrices (dunes at different Re, say).
    """
    tolerance, max_degree = check_accuracy(tolerance, max_degree)
    search = check_search(search)
    yield from flag_outgrown(_optima(flows, search, tolerance, max_degree))


def _optima(flows, search, tolerance, max_degree):
    assembly = None
    for flow in flows:
        optimum, assembly = _optimum(flow, search, tolerance, max_degree, assembly)
        yield optimum


def check_search(search):
    """Return a range of wavenumbers as (low, high), or raise a ParameterError."""
    wavenumbers = check_wavenumbers(search, "search").tolist()
    if len(wavenumbers) != 2 or not wavenumbers[0] < wavenumbers[1]:
        raise ParameterError(f"search: give a range of wavenumbers (low, high) (got {shown(search)})")
    return wavenumbers


def check_surface_mode(flow):
    """Raise a ParameterError where the flow has no surface mode: the maxima are those of its growth rate."""
    if not flow.has_surface_mode():
        raise ParameterError(f"{flow.name} has no slow surface mode, and k_max is that of the surface mode; ask for "
                             "growth rates at given wavenumbers (dispersion), or for a neutral curve")


@one_thread
def _optimum(flow, search, tolerance, max_degree, assembly):
    check_surface_mode(flow)
    assembly = assembly.serving(flow) if assembly else Assembly(flow)
    solver = Solver(flow, tolerance, max_degree, assembly)
    look = solver.rough(_ROUGH)
    try:
        modes, status = _look(look, *search)
        maxima = [_refine(solver, left, right) for left, right in zip(modes, modes[1:], strict=False)
                  if _growth_slope(left) > 0 >= _growth_slope(right)]
    except ModeLost as reason:
        maxima, status = [], str(reason)
    maxima = sorted((m for m in maxima if m.growth_rate > 0), key=lambda m: -m.growth_rate)
    settings = {"tolerance": tolerance, "max_degree": max_degree}
    return Optimum(flow, tuple(maxima), _status(maxima, status, search), settings), assembly


def _status(maxima, status, search):
    if not is_resolved(status):
        return status
    if not maxima:
        return f"{STABLE}: no waves grow for k up to {search[1]:g}"
    return maxima[0].mode.status


def _look(solver, low, high):
    """Modes along k from the long-wave regime to where the mode has decayed for good, and a status."""
    modes = [_power_law_start(solver, low)]
    growing = modes[0].k
    try:
        for mode in survey(solver, modes[0], high, _STEP):
            modes.append(mode)
            growing = mode.k if mode.growth_rate > 0 else growing
            if mode.k > max(_DECAYED * growing, _SHORT):
                break
    except ModeLost as reason:
        return modes, str(reason)
    if _growth_slope(modes[-1]) > 0 and modes[-1].growth_rate > 0:
        return modes, f"growth still rises at k = {modes[-1].k:g}, the end of the search"
    return modes, RESOLVED


def _power_law_start(solver, k):
    """The surface mode at a k so small that growth is a power of k there and a decade below: no maximum lies lower."""
    above = None
    for _ in range(8):
        mode = surface_mode(solver, k)
        if not 0.9 < mode.k * _growth_slope(mode) / mode.growth_rate < 2.5:
            above = None
        elif above:
            return above
        else:
            above = mode
        k = mode.k / 10
    raise ModeLost(f"{solver.flow}: growth follows no power of k down to k = {k:.1e}")


def _growth_slope(mode):
    return mode.slope.real


def _refine(solver, low, high):
    """Newton on the analytic slope between two modes that bracket a maximum, safeguarded by the bracket."""
    curvature = (_growth_slope(high) - _growth_slope(low)) / (high.k - low.k)
    for _ in range(_ITERATIONS):
        k = _slope_zero(low, high)
        near = low if abs(k - low.k) < abs(k - high.k) else high
        path = follow(solver, near, [k])
        if path.lost:
            raise path.lost
        mode = path.modes[0]
        slope = _growth_slope(mode)
        if abs(mode.k - near.k) > 1e-6 * mode.k:
            curvature = (slope - _growth_slope(near)) / (mode.k - near.k)
        low, high = (mode, high) if slope > 0 else (low, mode)
        if abs(slope) < 1e-13 * abs(curvature) * mode.k or high.k - low.k < 1e-14 * mode.k:
            break
    return Maximum(mode.k, float((abs(slope) + mode.slope_error) / abs(curvature)), mode)


def _slope_zero(low, high):
    """Zero of the growth slope between two modes, from the cubic through values and slopes in log k.

    Where one end is much nearer the zero, a Newton step from it with the secant curvature.
    """
    a, b = low.k * _growth_slope(low), high.k * _growth_slope(high)
    h = log(high.k / low.k)
    if min(abs(a), abs(b)) < 1e-3 * max(abs(a), abs(b)):
        t = a / (a - b)
    else:
        secant = (high.growth_rate - low.growth_rate) / h
        roots = np.roots((3 * (a + b - 2 * secant), 2 * (3 * secant - 2 * a - b), a))
        inside = [root.real for root in roots if abs(root.imag) < 1e-12 and 0 < root.real < 1]
        t = inside[0] if len(inside) == 1 else a / (a - b)
    return low.k * exp(t * h)
