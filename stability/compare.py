"""All methods on one eigenvalue: what each returns, how wrong it is, how long it takes.

Times are CPU times per eigenvalue of a short sweep around the wavenumber, everything included: what is set up once,
the way from the long-wave limit, error bars where a method has them. A dense solve gains nothing from its
neighbours and is timed alone. Each time is the shortest of several runs.
"""

import importlib.util
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from math import inf
from pathlib import Path
from time import process_time
from typing import Any, ClassVar

import numpy as np

from .branch import Branch, surface_mode
from .dense import finite_rates
from .errors import ModeLost, ParameterError
from .output import Row
from .record import Record
from .relation import dispersion
from .solver import DEGREES, Solver
from .spectra import spectrum
from .status import RESOLVED
from .threads import one_thread

COLLOCATION_DEGREES = tuple(degree for degree in DEGREES if degree <= 128)
DENSE_DEGREES = (8, 12, 16, 24, 32, 48, 64, 96, 128)
RESIDUALS = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8)
THESIS_RESIDUALS = (1e-3, 1e-4, 1e-5)
POINTS, SPAN = 201, 2.0  # of the sweep, from k / SPAN to k * SPAN

_SECONDS = 0.15  # spent on repeating each measurement, at least
_REPEATS = 3
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
    """All measurements of one problem. `failed` lists (method, setting) without a usable result."""

    flow: Any
    k: float
    reference: Reference
    measurements: tuple
    failed: tuple
    dimension: ClassVar[str] = "measurement"

    def rows(self) -> list[Row]:
        return [{"method": one.method, "setting": one.setting, "growth_rate": one.sigma.real,
                 "frequency": one.sigma.imag, "error": one.error, "reported": one.reported, "seconds": one.seconds,
                 "unknowns": one.unknowns, "status": RESOLVED} for one in self.measurements]

    def notes(self) -> list[str]:
        known = self.reference
        return [f"reference: sigma = {known.sigma:.15g}, {known.source}",
                *(f"{method}, {setting}: no result" for method, setting in self.failed)]

    def about(self) -> dict[str, Any]:
        return {"k": self.k}


@one_thread
def compare(flow, k, methods=None, report=None):
    """Return the `Comparison` of the methods of this package at wavenumber k, or of those named in `methods`."""
    chosen = METHODS if methods is None else {name: METHODS[name] for name in methods}
    mode = target(flow, k)
    known = reference(flow, k, mode)
    found, failed = [], []
    for count, (name, method) in enumerate(chosen.items(), 1):
        for setting, result in method(flow, mode):
            if result is None or abs(result[0] - known.sigma) > _LOST * abs(known.sigma):
                failed.append((name, setting))
            else:
                sigma, reported, seconds, unknowns = result
                found.append(Measurement(name, setting, sigma, abs(sigma - known.sigma), reported, seconds, unknowns))
        if report:
            report(count, len(chosen))
    return Comparison(flow, float(k), known, tuple(found), tuple(failed))


def target(flow, k):
    """The mode that is compared: the surface mode, or the most unstable one of a flow without."""
    if flow.has_surface_mode():
        return dispersion(flow, k).modes[0]
    return spectrum(flow, k, 1).modes[0]


def reference(flow, k, mode):
    """The independent 30-digit value where this flow has one (in a checkout with its tests), else collocation's own."""
    module = _references()
    parameters = {name: value for name, value in vars(flow).items() if name != "fluid"}
    if module and hasattr(module, flow.name) and "scene" not in vars(type(flow)):  # it knows the usual laws alone
        with suppress(ArithmeticError):  # it takes too many digits, or the mode is not resolved
            value = complex(getattr(module, flow.name)(**parameters, k=k, guess=mode.sigma))
            return Reference(value, abs(value) * 1e-16, "power series in 30-digit arithmetic")
    return Reference(mode.sigma, mode.error, f"collocation at degree {mode.degree}")


@cache
def _references():
    path = Path(__file__).resolve().parents[1] / "tests" / "references.py"
    if not path.exists():
        return None
    spec = importlib.util.spec_from_file_location("references", path)
    assert spec
    assert spec.loader
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def timed(function):
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


def _collocation(flow, mode):
    """This package's own method at one degree: the mode followed through the sweep from where it starts."""
    for degree in COLLOCATION_DEGREES:
        try:
            found, seconds = timed(lambda: _followed(flow, mode, degree))  # noqa: B023
        except ModeLost:
            yield f"degree {degree}", None
            continue
        yield f"degree {degree}", (found.sigma, found.error, seconds / POINTS, len(found.x))


def _followed(flow, mode, degree):
    """The mode at mode.k after a sweep at one degree, all included."""
    solver = Solver(flow, 1.0, degree)
    solver.degrees = (degree,)
    sweep = wavenumbers(mode.k)
    solver.prepare(sweep)
    first = sweep[0]
    start = surface_mode(solver, first) if flow.has_surface_mode() else solver.solve(first, _guess(mode, first))
    found, lost = Branch(solver, start, rough=solver).at(sweep)
    for reason in lost.values():
        raise ModeLost(reason)
    return found[mode.k]


def _guess(mode, k):
    """Rate of a mode at another wavenumber, from its slope."""
    return mode.rate + (k - mode.k) * mode.rate_slope


def wavenumbers(k):
    """The sweep, with k in its middle."""
    values = np.geomspace(k / SPAN, k * SPAN, POINTS)
    values[POINTS // 2] = k
    return values


def _dense(flow, mode):
    """All modes at once: the dense eigenvalue problem of the same matrices, unrefined."""
    solver = Solver(flow)
    symbols = solver.symbols(mode.k)
    for degree in DENSE_DEGREES:
        rates, seconds = timed(lambda: finite_rates(solver, degree, symbols))  # noqa: B023
        nearest = rates[np.argmin(np.abs(rates - mode.rate))]
        yield f"degree {degree}", (complex(solver.width(mode.k) * nearest), None, seconds, solver.pencil(degree).size)


def _bvp(flow, mode):
    """Continuation by solve_bvp through the sweep, at several tolerances of solve_bvp."""
    yield from _continued(flow, mode, RESIDUALS, None)


def _bvp_thesis(flow, mode):
    """The thesis's setting, from its own tolerance on; the bias of the problem stays."""
    from .thesis import thesis_setting

    try:
        setting = thesis_setting(flow)
    except ParameterError:
        return
    yield from _continued(flow, mode, THESIS_RESIDUALS, setting)


def _continued(flow, mode, residuals, setting):
    from .continuation import continue_in_k

    sweep = wavenumbers(mode.k)
    start = None if flow.has_surface_mode() else _guess(mode, sweep[0]) * sweep[0] ** (1 + flow.order)
    for residual in residuals:
        found, seconds = timed(lambda: continue_in_k(flow, sweep, residual=residual, guess=start,  # noqa: B023
                                                     setting=setting))
        if found.lost:
            yield f"residual {residual:g}", None
            continue
        point = found.points[POINTS // 2]
        yield f"residual {residual:g}", (point.sigma, point.error, seconds / POINTS, point.unknowns)


METHODS = {"collocation": _collocation, "dense": _dense, "bvp": _bvp, "bvp-thesis": _bvp_thesis}
