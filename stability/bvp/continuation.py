"""Continuation with `scipy.integrate.solve_bvp`: one boundary-value problem per point, the last solution its guess.

This is how Cawthorn's thesis computes (4.1.4, 4.2.4); `bvp.thesis` has its own choice of problem. It is
here to be compared with: `stability.dispersion` is faster and more accurate, and its error bar is sharper.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from math import exp, log
from typing import TYPE_CHECKING, Any

import numpy as np

from ..checks import check_wavenumbers
from ..errors import ModeLost, NotResolved
from ..modes.accuracy import TOLERANCE
from ..modes.crests import SEARCH
from ..modes.eigenvalue import Eigenvalue, Eigenvalues
from ..numerics.threads import one_thread
from ..numerics.walker import Pace, Walker, towards
from ..status import RESOLVED, Status, unresolved
from .problem import Problem, Solution, solve

if TYPE_CHECKING:
    from ..flows.base import Flow

_RESIDUALS = (1e-4, 1e-6, 1e-7, 1e-8)  # tolerances of solve_bvp tried in turn
_STEP_NODES = 100  # a step that needs more than these beyond its mesh has a bad guess
_START_NODES = 17
_PACE = Pace(0.2, 0.2, 4e-3)  # in log of the parameter
_CHANGE = 0.1  # largest relative difference between predictor and corrector
_NUDGE = 1e-3  # in log of the parameter, for slopes
_BEND = 0.07  # error of the trapezoidal rule for a step, relative to its largest slope
_BEND_FLOOR = 1e-3
_STEPS = 400
_LONG_WAVE = 0.03  # agreement of the first mode with the long-wave limit
_STARTS = 12  # wavenumbers, each a quarter of the last, at which the long-wave limit is tried: 4^-12 of the first
_LEAST_FACTOR, _NO_CHANGE = 0.7, 1e-6  # of the step length after one that was taken; a change too small to divide by
_ROUNDING = 1e-16  # least relative error of sigma
_FAINT = 1e-12  # a field so much smaller than all together has no relative change of its own
_IDLE = 50  # below this part of the residual allowed an interval can be doubled: errors of order 4 rise by 16
_BRACKET_STEP = 0.25  # of the look for maxima, in log k
_K_ACCURACY = 1e-7  # of the bounded minimisation, relative to k


@dataclass(frozen=True)
class BoundaryMode(Eigenvalue):
    """An eigenvalue found by solve_bvp.

    `error` is the change of sigma when every mesh interval is halved; sigma is that of the finer mesh, in
    error by about a fifteenth of it. It says nothing of a bias of the problem itself (delta, a cut fluid).
    """

    flow: Any
    k: float
    sigma: complex
    error: float
    nodes: int
    unknowns: int
    status: Status


@dataclass(frozen=True)
class Continuation(Eigenvalues):
    """Points along k or along a parameter; `lost` maps each value that was not reached to the reason."""

    points: tuple
    lost: dict = field(hash=False)

    @property
    def modes(self) -> Any:
        return self.points

    @property
    def k(self) -> Any:
        return self._of_each("k")



def continue_in_k(flow: "Flow", k: np.ndarray, *, tolerance: float = TOLERANCE, residual: float | None = None,
                  guess: Any = None, setting: Any = None) -> "Continuation":
    """Follow the surface mode of a flow through wavenumbers k by solve_bvp: a `Continuation`.

    Each point is refined until its error is below `tolerance` |sigma|, or solved once with solve_bvp's
    tolerance `residual`. `guess` is sigma at the smallest k, for flows without a long-wave limit. `setting` maps k to
    the flow that is solved (`thesis.thesis_setting`).
    """
    return _joined(steps_in_k(flow, k, tolerance=tolerance, residual=residual, guess=guess, setting=setting))


def steps_in_k(flow: "Flow", k: np.ndarray, *, tolerance: float = TOLERANCE, residual: float | None = None,
               guess: Any = None, setting: Callable[..., Any] | None = None) -> Iterator[Any]:
    """Yield the result of `continue_in_k` point by point, and at last what is lost."""
    setting = setting or (lambda k: flow)
    wavenumbers = np.unique(check_wavenumbers(k))
    effort = _effort(tolerance, residual)
    try:
        walk = _ParameterWalk(lambda k: (setting(k), k), *_start(setting, wavenumbers[0], guess, effort[1][0]), effort)
    except ModeLost as reason:
        yield Continuation((), dict.fromkeys(wavenumbers.tolist(), str(reason)))
    else:
        yield from _walk_through(walk, wavenumbers.tolist())


@one_thread
def continue_in(flow: Any, name: Any, values: Any, k: Any, *, tolerance: Any = TOLERANCE, residual: Any = None) -> Any:
    """Follow the surface mode at fixed k through a monotone sequence of positive values of a parameter.

    The first point is reached from the long-wave limit. Arguments and result as for `continue_in_k`; `lost`
    has the parameter's values as keys.
    """
    values = [float(value) for value in values]
    effort = _effort(tolerance, residual)
    first = replace(flow, **{name: values[0]})
    walk = _ParameterWalk(lambda k: (first, k), *_start(lambda k: first, k, None, effort[1][0]), effort)
    try:
        walk.to(k)
    except ModeLost as reason:
        return Continuation((), dict.fromkeys(values, str(reason)))
    walk.move(lambda value: (replace(flow, **{name: value}), k), values[0])
    return _joined(_walk_through(walk, values))


@dataclass(frozen=True)
class BoundedMaximum:
    """The largest growth rate along k and where; `error` bounds the absolute error of k."""

    k: float
    error: float
    mode: BoundaryMode

    @property
    def growth_rate(self) -> Any:
        return self.mode.growth_rate


@one_thread
def bounded_maximum(flow: Any, search: Any = SEARCH, *, tolerance: Any = TOLERANCE, residual: Any = None,
                    setting: Any = None) -> Any:
    """Return the `BoundedMaximum` of the first maximum of growth met along k, by bounded minimisation.

    What the thesis does with fminbnd: values only, so that k is known to the square root of the accuracy
    of sigma. Raises NotResolved if growth rises to no maximum within `search`.
    """
    from scipy.optimize import minimize_scalar

    setting = setting or (lambda k: flow)
    effort = _effort(tolerance, residual)
    walk = _ParameterWalk(lambda k: (setting(k), k), *_start(setting, search[0], None, effort[1][0]), effort)
    low, high = search
    wavenumbers = np.geomspace(low, high, int(log(high / low) / _BRACKET_STEP) + 1)
    growth = []
    for k in wavenumbers:
        growth.append(walk.to(float(k)).sigma.real)
        if len(growth) > 2 and growth[-2] > max(0, growth[-3], growth[-1]):
            break
    else:
        raise NotResolved(f"{flow}: growth has no positive maximum for k in [{search[0]:g}, {search[1]:g}]")
    bracket = wavenumbers[len(growth) - 3], wavenumbers[len(growth) - 1]
    found = minimize_scalar(lambda k: -walk.to(float(k)).sigma.real, bounds=bracket, method="bounded",
                            options={"xatol": _K_ACCURACY * bracket[0]})
    best = walk.point(float(found.x))
    a, middle, c = (growth[i] for i in (-3, -2, -1))
    curvature = abs(a - 2 * middle + c) / (log(bracket[1] / bracket[0]) / 2) ** 2
    width = (2 * max(best.error, _ROUNDING * abs(best.sigma)) / curvature) ** 0.5
    return BoundedMaximum(best.k, float(best.k * (width + _K_ACCURACY)), best)


def _effort(tolerance: float, residual: float | None) -> tuple[Any, ...]:
    """Accepted relative error of sigma, and the tolerances of solve_bvp to try for it."""
    return (np.inf, (residual,)) if residual else (tolerance, _RESIDUALS)


@one_thread
def _start(setting: Callable[..., Any], k: float, guess: Any, residual: float) -> "tuple[Solution, float]":
    """First solution and its k: at a k so small that the long-wave limit holds, or at the guess."""
    for _ in range(_STARTS):
        flow = setting(k)
        sigma = flow.long_wave(np.array([k]))[0] if guess is None else guess
        found = _cold(flow, k, sigma, residual)
        if found and (guess is not None or abs(found.problem.width * found.rate / sigma - 1) < _LONG_WAVE):
            return found, k
        if guess is not None:
            break
        k = k / 4
    raise ModeLost(f"{setting(k)}: solve_bvp finds no mode near the "
                   f"{'long-wave limit' if guess is None else 'guess'} at k = {k:.3g}")


def _cold(flow: Any, k: Any, sigma: Any, residual: Any) -> Any:
    """Solve with the rate held at the guess for the fields, then for all."""
    problem = Problem(flow, k)
    mesh = np.linspace(0, 1, _START_NODES)
    parameters = np.zeros(max(1, len(flow.surfaces)), complex)
    parameters[0] = sigma / problem.width
    rough = solve(problem, mesh, np.zeros((problem.size, len(mesh)), complex), parameters, residual, frozen=True)
    return rough and solve(problem, rough.mesh, rough.fields(rough.mesh), rough.parameters, residual)


def _walk_through(walk: "_ParameterWalk", values: list[float]) -> Iterator[Any]:
    for done, value in enumerate(values):
        try:
            yield Continuation((walk.point(value),), {})
        except ModeLost as reason:
            yield Continuation((), dict.fromkeys(values[done:], str(reason)))
            return


def _joined(parts: Any) -> Any:
    parts = list(parts)
    return Continuation(tuple(point for part in parts for point in part.points),
                        {value: reason for part in parts for value, reason in part.lost.items()})


class _ParameterWalk(Walker):
    """A walk along k or a parameter: `family` maps its value to (flow, k)."""

    checks = ("changes_little", "bends_little")

    def __init__(self, family: Callable[..., Any], start: "Solution", value: float, effort: tuple[Any, ...]) -> None:
        super().__init__(_PACE)
        self.tolerance, self.residuals = effort
        self.now = start
        self.move(family, value)

    def move(self, family: Any, value: Any) -> None:
        """Go on along another parameter, which has this value now."""
        self.family, self.value, self.slope = family, value, None
        self.before: tuple[float, Solution] | None = None

    @property
    def sigma(self) -> complex:
        return self.now.problem.width * self.now.rate

    def to(self, value: float) -> "_ParameterWalk":
        """Reach the value with solve_bvp's coarsest tolerance, in steps short enough for the predictor."""
        for _ in range(_STEPS):
            if log(value / self.value) == 0:
                return self
            to, _ = towards(self.value, value, self.step)
            if not self.stride(to, abs(log(to / self.value))) and self.stuck:
                raise self._lost(self.failure)
        raise self._lost(f"{_STEPS} steps did not reach {value:g}")

    @one_thread
    def point(self, value: Any) -> Any:
        """Reach the value, then tighten solve_bvp's tolerance until halving the mesh moves sigma little enough."""
        self.to(value)
        problem, coarse = self.now.problem, self.now
        for i, residual in enumerate(self.residuals):
            if i:
                coarse = solve(problem, coarse.mesh, coarse.fields(coarse.mesh), coarse.parameters, residual)
            mesh = coarse and _halved(coarse.mesh)
            fine = coarse and solve(problem, mesh, coarse.fields(mesh), coarse.parameters, residual)
            if not fine:
                raise self._lost(f"solve_bvp fails at tolerance {residual:g}")
            error = abs(fine.rate - coarse.rate)
            if error <= self.tolerance * abs(fine.rate):
                break
            coarse = fine
        status = RESOLVED if error <= self.tolerance * abs(fine.rate) else \
            unresolved(f"error {problem.width * error:.1e} exceeds tolerance with {len(fine.mesh)} nodes")
        sigma = problem.width * fine.rate
        return BoundaryMode(problem.flow, problem.k, complex(sigma), float(problem.width * error), len(fine.mesh),
                     fine.spline.c.shape[-1] * len(fine.mesh), status)

    def foresee(self, to: float) -> tuple[np.ndarray, ...]:
        """Mesh, and fields and parameters on it extrapolated in the logarithm of the value."""
        mesh = _thinned(self.now, self.residuals[0])
        return mesh, *self._predict(to, mesh)

    def correct(self, to: float, guess: tuple[np.ndarray, ...]) -> "Solution":
        self.failure, self.ahead = "solve_bvp fails at the next step", to
        found = self._corrected(to, *guess)
        if found:
            self.failure, self.slope_ahead = "the next step lands on another mode", None
            self.change = self._change(found, *guess)
        return found

    def changes_little(self, new: "Solution", guess: tuple[np.ndarray, ...]) -> bool:
        """Whether what was found is what was foreseen."""
        return self.change < _CHANGE

    def bends_little(self, new: Any, guess: Any) -> Any:
        """Whether the slopes at both ends explain the step: it has not jumped across an avoided crossing."""
        if self.slope is None:
            self.slope = self._slope(self.now, self.value)
        ahead = self.slope_ahead = self._slope(new, self.ahead)
        if self.slope is None or ahead is None:
            return False
        length = log(self.ahead / self.value)
        miss = abs(new.rate - self.now.rate - length * (self.slope + ahead) / 2)
        return miss < _BEND * abs(length) * max(abs(self.slope), abs(ahead)) + _BEND_FLOOR * abs(new.rate)

    def factor(self, new: "Solution", guess: tuple[np.ndarray, ...]) -> float:
        return min(2.0, max(_LEAST_FACTOR, (0.5 * _CHANGE / (self.change + _NO_CHANGE)) ** 0.5))

    def accept(self, to: Any, new: Any) -> None:
        self.before, self.now, self.value, self.slope = (self.value, self.now), new, to, self.slope_ahead

    def _corrected(self, value: Any, mesh: Any, fields: Any, parameters: Any) -> Any:
        problem = Problem(*self.family(value))
        return solve(problem, mesh, fields, parameters, self.residuals[0], nodes=_STEP_NODES + len(mesh))

    def _predict(self, value: float, mesh: np.ndarray) -> tuple[np.ndarray, ...]:
        """Fields and parameters extrapolated in the logarithm of the value."""
        fields, parameters = self.now.fields(mesh), self.now.parameters
        if self.before is None:
            return fields, parameters
        old_value, old = self.before
        ratio = log(value / self.value) / log(self.value / old_value)
        return (fields + ratio * (fields - old.fields(mesh)),
                parameters + ratio * (parameters - old.parameters))

    def _change(self, found: "Solution", mesh: np.ndarray, fields: np.ndarray, parameters: np.ndarray) -> float:
        """Largest relative difference between what was predicted and what was found."""
        now = found.fields(mesh)
        moved = np.linalg.norm(now - fields, axis=1) / np.linalg.norm(now, axis=1).clip(_FAINT * np.linalg.norm(now))
        return max(abs(found.rate - parameters[0]) / abs(found.rate), np.max(moved))

    def _slope(self, solution: Any, value: Any) -> Any:
        """d rate / d log(value) by a second solve next to the first; None if it fails."""
        near = self._corrected(value * exp(_NUDGE), solution.mesh, solution.fields(solution.mesh), solution.parameters)
        return near and (near.rate - solution.rate) / _NUDGE

    def _lost(self, why: Any) -> Any:
        flow, k = self.now.problem.flow, self.now.problem.k
        return ModeLost(f"{flow}: bvp gives up after k = {k:.6g}, sigma = {self.sigma:.6g}: {why}")


def _halved(mesh: np.ndarray) -> np.ndarray:
    return np.sort(np.concatenate((mesh, (mesh[1:] + mesh[:-1]) / 2)))


def _thinned(solution: "Solution", residual: float) -> np.ndarray:
    """The mesh without every second node, where the residual allows intervals twice as long."""
    mesh, size = solution.mesh, solution.residuals
    inner = np.arange(1, len(mesh) - 1, 2)
    idle = inner[np.maximum(size[inner - 1], size[inner]) < residual / _IDLE]
    return mesh if len(mesh) - len(idle) < _START_NODES else np.delete(mesh, idle)
