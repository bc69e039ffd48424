"""All methods on one eigenvalue: what each returns, how wrong it is, how long it takes.

Times are CPU times per eigenvalue of a short sweep around the wavenumber, everything included: what is set up once,
the way from the long-wave limit, error bars where a method has them. A dense solve gains nothing from its
neighbours and is timed alone. Each time is the shortest of several runs.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from math import inf
from time import monotonic, process_time
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ..checks import check_options
from ..errors import ModeLost, ParameterError
from ..flows.base import check_flow
from ..modes.accuracy import DEGREES, Accuracy
from ..modes.branch import Branch
from ..modes.dense import finite_rates
from ..modes.solver import Solver
from ..modes.surface import LAWFUL, surface_mode
from ..numerics.threads import one_thread
from ..output.panels import MARKED, THIN, Axis, Curve, Panel
from ..output.record import Record
from ..output.symbols import value_text
from ..output.text import Row
from ..status import INTERRUPTED, RESOLVED
from .dispersion import dispersion
from .spectrum import spectrum

if TYPE_CHECKING:
    from ..flows.base import Flow
    from ..modes.mode import Mode

COLLOCATION_DEGREES = tuple(degree for degree in DEGREES if degree <= 128)
DENSE_DEGREES = (8, 12, 16, 24, 32, 48, 64, 96, 128)
RESIDUALS = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8)
THESIS_RESIDUALS = (1e-3, 1e-4, 1e-5)
SWEEP_POINTS, SPAN = 201, 2.0  # of the sweep, from k / SPAN to k * SPAN

_SECONDS = 0.15  # spent on repeating each measurement, at least
_REPEATS = 3
_SLOWER = 2.0  # time of a measurement over that of the one before it, as it is expected
_ABSENT = object()  # there is no such method for this flow
_LOST = 0.5  # relative error beyond which a method has found another mode


@dataclass(frozen=True)
class Reference:
    """The eigenvalue that errors are measured against, with its own error and where it comes from."""

    sigma: complex
    error: float
    source: str


@dataclass(frozen=True)
class Measurement:
    """One method at one resolution: `error` is absolute, `reported` the method's own bound or None."""

    method: str
    setting: str
    sigma: complex
    error: float
    reported: float | None
    seconds: float
    unknowns: int


@dataclass(frozen=True, repr=False)
class Comparison(Record):
    """All measurements of one problem. `failed` lists (method, setting) without a usable result, `skipped` those that
    there was no time for; `pending` are methods that were still to come when it was stopped.

    `flow`, `k` (1/L) and `reference` say what was computed, `measurements` are `Measurement` records: `error` in V/L,
    `seconds` of CPU time. Writing raises ParameterError where a file cannot be written.

    >>> from stability import flows
    >>> one = Measurement("collocation", "degree 12", -1 + 0j, 1e-15, 2e-15, 1e-3, 52)
    >>> Comparison(flows.Vortex(), 1.0, Reference(-1 + 0j, 0.0, "exact"), (one,), ())["seconds"].tolist()
    [0.001]
    """

    flow: Any
    k: float
    reference: Reference
    measurements: tuple
    failed: tuple
    pending: tuple = ()
    skipped: tuple = ()
    dimension: ClassVar[str] = "measurement"

    def rows(self) -> list[Row]:
        return [{"method": one.method, "setting": one.setting, "growth_rate": one.sigma.real,
                 "frequency": one.sigma.imag, "error": one.error, "reported": one.reported, "seconds": one.seconds,
                 "unknowns": one.unknowns, "status": RESOLVED} for one in self.measurements] + \
            [{"method": method, "setting": "-", "growth_rate": None, "frequency": None, "error": None, "reported": None,
              "seconds": None, "unknowns": None, "status": INTERRUPTED} for method in self.pending]

    def notes(self) -> list[str]:
        known = self.reference
        return [f"reference: sigma = {known.sigma:.15g}, {known.source}",
                *(f"{method}, {setting}: no result" for method, setting in self.failed),
                *(f"{method}, {setting}: not measured, the time is up" for method, setting in self.skipped)]

    def about(self) -> dict[str, Any]:
        return {"k": self.k}

    @property
    def subtitle(self) -> str:
        return f"; $k$ = {value_text(self.k)}"

    def panels(self) -> tuple[Panel, ...]:
        """Relative error against time, a curve for each method; thin what it reports."""
        scale, floor = abs(self.reference.sigma), np.finfo(float).eps / 2  # errors below are drawn there
        curves: list[Curve] = []
        for method in MEASURED:
            rows = [one for one in self.measurements if one.method == method]
            if not rows:
                continue
            seconds = np.array([one.seconds for one in rows])
            curves.append(Curve(seconds, np.maximum([one.error / scale for one in rows], floor), method, MARKED))
            if rows[0].reported is not None:
                reported = np.maximum([(one.reported or 0.0) / scale for one in rows], floor)
                curves.append(Curve(seconds, reported, None, THIN, of=len(curves) - 1))
        return (Panel(Axis("seconds", "CPU seconds per eigenvalue", "log"),
                      Axis("relative_error", "relative error (thin: reported)", "log"), tuple(curves)),)


def compare(flow: Any, k: Any, methods: Any = None, report: Any = None, *, known: Any = None, points: Any = None,
            budget: Any = inf) -> Any:
    """Return the `Comparison` of the methods of this package at wavenumber k, or of those named in `methods`.

    Errors are measured against the `Reference` `known`, by default collocation's own value. `points` (odd) are those of
    each sweep. After `budget` seconds nothing is begun that would take longer than what is left. `report(done, total)`
    is called on the way.

    `k` is in 1/L, errors in V/L, times in seconds. Raises ParameterError for what is no flow, wavenumber or method.

    >>> from stability import flows
    >>> found = compare(flows.Vortex(), 1.0, ["collocation"], points=3)
    >>> {row["method"] for row in found}
    {'collocation'}
    """
    for found in comparisons(flow, k, methods, report, known=known, points=points, budget=budget):  # noqa: B007
        pass
    return found


def comparisons(flow: Any, k: Any, methods: Any = None, report: Any = None, *, known: Any = None, points: Any = None,
                budget: Any = inf) -> Iterator[Any]:
    """Yield the comparison of `compare` as it grows: before the first measurement, and after each."""
    begun = monotonic()
    chosen = [check_options("methods", name, tuple(MEASURED)) for name in (MEASURED if methods is None else methods)]
    mode = one_thread(target)(check_flow(flow), k)
    known = known or reference(mode)
    total = sum(len(settings()) for settings, _ in (MEASURED[name] for name in chosen))
    found = Comparison(flow, float(k), known, (), (), tuple(chosen))
    yield found
    count = 0
    for name in chosen:
        settings, method = MEASURED[name]
        last = 0.0
        for setting in settings():
            count += 1
            now = monotonic()
            label = _label(setting)
            if now - begun + _SLOWER * last > budget:
                found = replace(found, skipped=(*found.skipped, (name, label)))
            else:
                measure: Any = one_thread(method)
                result = measure(flow, mode, setting, points or SWEEP_POINTS)
                found, last = _with(found, name, label, result), monotonic() - now
            if report:
                report(count, total)
            yield replace(found, pending=found.pending[1:] if setting == settings()[-1] else found.pending)
        found = replace(found, pending=found.pending[1:])


def _label(setting: float) -> str:
    return f"degree {setting}" if isinstance(setting, int) else f"residual {setting:g}"


def _with(found: "Comparison", name: str, label: str, result: tuple[Any, ...]) -> "Comparison":
    """The comparison with the result of one more measurement, or with its failure."""
    known = found.reference
    if result is _ABSENT:
        return found
    if result is None or abs(result[0] - known.sigma) > _LOST * abs(known.sigma):
        return replace(found, failed=(*found.failed, (name, label)))
    sigma, reported, seconds, unknowns = result
    one = Measurement(name, label, sigma, abs(sigma - known.sigma), reported, seconds, unknowns)
    return replace(found, measurements=(*found.measurements, one))


def target(flow: "Flow", k: float) -> "Mode":
    """The mode that is compared: the surface mode, or the most unstable one of a flow without."""
    if flow.has_surface_mode():
        return dispersion(flow, k).modes[0]
    return spectrum(flow, k, 1).modes[0]


def reference(mode: "Mode") -> "Reference":
    """Collocation's own value of a mode, at the degree that its tolerance asks for."""
    return Reference(mode.sigma, mode.error, f"collocation at degree {mode.degree}, error below {mode.error:.1e}")


def timed(function: Callable[..., Any]) -> tuple[Any, ...]:
    """Return the value of function() and its shortest CPU time in seconds."""
    best, spent = inf, 0.0
    while spent < _SECONDS or best == inf:
        for _ in range(_REPEATS):
            start = process_time()
            value = function()
            seconds = process_time() - start
            best, spent = min(best, seconds), spent + seconds
            if spent > _SECONDS:
                break
    return value, best


def _collocation(flow: "Flow", mode: "Mode", degree: int, points: int) -> tuple[complex, float, float, int] | None:
    """This package's own method at one degree: the mode followed through the sweep from where it starts."""
    try:
        found, seconds = timed(lambda: _followed(flow, mode, degree, points))
    except ModeLost:
        return None
    return found.sigma, found.error, seconds / points, len(found.x)


def _followed(flow: "Flow", mode: "Mode", degree: int, points: int) -> "Mode":
    """The mode at mode.k after a sweep at one degree, all included."""
    solver = Solver(flow, Accuracy(1.0, degree))
    rough = solver.rough(1.0)
    solver.degrees = rough.degrees = (degree,)
    sweep = wavenumbers(mode.k, points)
    solver.prepare(sweep)
    if flow.has_surface_mode():
        branch = Branch(solver, surface_mode(rough), rough, pace=LAWFUL)
    else:
        branch = Branch(solver, rough.solve(sweep[0], _guess(mode, sweep[0])), rough)
    found, lost = branch.at(sweep)
    for reason in lost.values():
        raise ModeLost(reason)
    return found[mode.k]


def _guess(mode: Any, k: Any) -> Any:
    """Rate of a mode at another wavenumber, from its slope."""
    return mode.rate + (k - mode.k) * mode.rate_slope


def wavenumbers(k: float, points: int | None = None) -> np.ndarray:
    """The sweep, with k in its middle."""
    points = points or SWEEP_POINTS
    values = np.geomspace(k / SPAN, k * SPAN, points)
    values[points // 2] = k
    return values


def _dense(flow: "Flow", mode: "Mode", degree: int, points: int) -> tuple[complex, None, float, int]:
    """All modes at once: the dense eigenvalue problem of the same matrices, unrefined."""
    solver = Solver(flow)
    symbols = solver.symbols(mode.k)
    rates, seconds = timed(lambda: finite_rates(solver, degree, symbols))
    nearest = rates[np.argmin(np.abs(rates - mode.rate))]
    return complex(solver.width(mode.k) * nearest), None, seconds, solver.pencil(degree).size


def _bvp(flow: Any, mode: Any, residual: Any, points: Any) -> Any:
    """Continuation by solve_bvp through the sweep, at one tolerance of solve_bvp."""
    return _continued(flow, mode, residual, None, points)


def _bvp_thesis(flow: Any, mode: Any, residual: Any, points: Any) -> Any:
    """The thesis's setting, from its own tolerance on; the bias of the problem stays."""
    from ..bvp.thesis import thesis_setting

    try:
        setting = thesis_setting(flow)
    except ParameterError:
        return _ABSENT
    return _continued(flow, mode, residual, setting, points)


def _continued(flow: "Flow", mode: "Mode", residual: float, setting: Any,
               points: int) -> tuple[complex, float, float, int] | None:
    from ..bvp.continuation import continue_in_k

    sweep = wavenumbers(mode.k, points)
    start = None if flow.has_surface_mode() else _guess(mode, sweep[0]) * sweep[0] ** (1 + flow.order)
    found, seconds = timed(lambda: continue_in_k(flow, sweep, residual=residual, guess=start, setting=setting))
    if found.lost:
        return None
    point = found.points[points // 2]
    return point.sigma, point.error, seconds / points, point.unknowns


MEASURED = {  # settings, read when asked for, and the measurement of one
    "collocation": (lambda: COLLOCATION_DEGREES, _collocation),
    "dense": (lambda: DENSE_DEGREES, _dense),
    "bvp": (lambda: RESIDUALS, _bvp),
    "bvp-thesis": (lambda: THESIS_RESIDUALS, _bvp_thesis),
}
