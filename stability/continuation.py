"""Continuation with `scipy.integrate.solve_bvp`: one boundary-value problem per point, the last solution its guess.

The equations of `stability.layer` are solved for the slopes, y' = (M0 + rate M1) y on 0 <= s <= 1 with
all layers side by side, and the rate is an unknown parameter. scipy's line search squares without
conjugating, so that complex problems are split into real and imaginary parts. A yield surface at s = 0 enters as
solve_bvp's singular term S y / s; a free surface is regular in the flow's own map.

This is how Cawthorn's thesis computes (4.1.4, 4.2.4); `thesis_setting` is its own choice of problem. It is
here to be compared with: `stability.dispersion` is faster and more accurate, and its error bar is sharper.
"""

from dataclasses import dataclass, fields, replace
from math import exp, isinf, log, radians, tan
from types import SimpleNamespace
from typing import Any, ClassVar

import numpy as np
from numpy.polynomial import chebyshev as C
from scipy.integrate import solve_bvp

from . import chebyshev
from .checks import check_wavenumbers
from .errors import ModeLost, NotResolved, ParameterError
from .flows import Dune, Vortex
from .flows.base import parameter
from .layer import FIELDS, Layer, Profile, residuals
from .mode import TOLERANCE
from .optimum import SEARCH
from .threads import one_thread

THESIS_RESIDUAL = 1e-3  # default tolerance of bvp4c and of solve_bvp
THESIS_DELTA = 0.01  # grain size over depth of the layer
THESIS_DEPTH = 100.0  # depth of the fluid times k, where it stands for an unbounded fluid


_RESIDUALS = (1e-4, 1e-6, 1e-7, 1e-8)  # tolerances of solve_bvp tried in turn
_NODES = 20_000
_STEP_NODES = 100  # a step that needs more than these beyond its mesh has a bad guess
_START_NODES = 17
_FIRST_STEP = 0.2  # in log of the parameter
_LARGEST_STEP = 0.2
_SMALLEST_STEP = 4e-3
_CHANGE = 0.1  # largest relative difference between predictor and corrector
_NUDGE = 1e-3  # in log of the parameter, for slopes
_BEND = 0.07  # error of the trapezoidal rule for a step, relative to its largest slope
_BEND_FLOOR = 1e-3
_STEPS = 400
_SHEAR_STRESS = 2  # index of t(0) among the edge values
_SAMPLES = 96
_INSIDE = np.array([0.2, 0.7])
_LONG_WAVE = 0.03  # agreement of the first mode with the long-wave limit
_BRACKET_STEP = 0.25  # of the look for maxima, in log k
_K_ACCURACY = 1e-7  # of the bounded minimisation, relative to k


@dataclass(frozen=True)
class Point:
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
    status: str

    @property
    def growth_rate(self):
        return self.sigma.real

    @property
    def c(self):
        """Complex wave speed i sigma / k."""
        return 1j * self.sigma / self.k

    @property
    def phase_speed(self):
        return self.c.real + 0.0  # no negative zero


@dataclass(frozen=True)
class Continuation:
    """Points along k or along a parameter; `lost` maps each value that was not reached to the reason."""

    points: tuple
    lost: dict

    @property
    def k(self):
        return np.array([point.k for point in self.points])

    @property
    def sigma(self):
        return np.array([point.sigma for point in self.points])

    @property
    def error(self):
        return np.array([point.error for point in self.points])

    @property
    def growth_rate(self):
        return self.sigma.real

    @property
    def phase_speed(self):
        return np.array([point.phase_speed for point in self.points])


@dataclass(frozen=True)
class RegularisedVortex(Vortex):
    """Vortices under the pressure `delta` of a monolayer of grains, in the coordinate z: thesis (4.26)-(4.29).

    The term i k c delta W of (4.28) is kept as printed, although a load normal to the surface gives none.
    """

    title: ClassVar[str] = "longitudinal vortices with a delta-regularised free surface"

    delta: float = parameter(THESIS_DELTA, 0, meaning="pressure on the free surface, thesis (4.26)")

    def layers(self, names):
        mu = tan(radians(self.slope_deg))

        def profile(s):
            viscosity = mu * np.sqrt(1 + self.delta - s)
            return Profile(dz=1.0, rho=self.Fr2, eta=viscosity, beta=viscosity)

        return (Layer("grains", profile),)

    def conditions(self, edges, names):
        no_slip, no_flow, stress, pressure, kinematic = super().conditions(edges, names)
        load = self.delta * names.k**2 * names.rate * edges.grains[1].w
        return no_slip, no_flow, stress - load, pressure, kinematic

    def long_wave(self, k):
        """sigma = -(k^2 / tan slope) int_0^1 (1-z)^2 (1+delta-z)^{-1/2} dz, what (4.30) should say."""
        low, high = self.delta**0.5, (1 + self.delta) ** 0.5
        integral = 2 / 5 * high**5 - 4 / 3 * self.delta * high**3 + 2 * self.delta**2 * high - 16 / 15 * low**5
        return -(k**2) / tan(radians(self.slope_deg)) * integral


def thesis_setting(flow, delta=None):
    """Return k -> flow as the thesis set it up: delta-regularised vortices, dunes under a lid at 100/k.

    Raises ParameterError for other flows, and for a `delta` that the flow has no use for.
    """
    if isinstance(flow, Vortex):
        parameters = {item.name: getattr(flow, item.name) for item in fields(flow)}
        regularised = RegularisedVortex(**parameters, delta=THESIS_DELTA if delta is None else delta)
        return lambda k: regularised
    if delta is not None:
        raise ParameterError(f"--delta regularises the free surface of vortex; {flow.name} has none")
    if isinstance(flow, Dune):
        return lambda k: replace(flow, fluid="layer", depth=THESIS_DEPTH / k if isinf(flow.depth) else flow.depth)
    raise ParameterError(f"--method bvp-thesis: the thesis computes vortex and dune, not {flow.name}")


class Problem:
    """One flow at one wavenumber as y' = (M0 + rate M1) y + S y / s with conditions, for solve_bvp.

    The unknowns are the fields of all layers (size,), complex. `real` tells that all matrices are real; if not,
    real parts come first and imaginary parts after. The first surface has amplitude 1; without a
    surface `pivot`, an index into the edge values (y(0), y(1)), does. The parameters are the rate and
    the amplitudes of other surfaces.
    """

    def __init__(self, flow, k, pivot=_SHEAR_STRESS):
        self.flow, self.k, self.pivot = flow, float(k), pivot
        self.width = k ** (1 + flow.order)
        self.functions = {name: value[0][0] for name, value in flow.evaluate(np.array([self.k])).items()}
        self.layers = flow.layers(self._names(0.0, ()))
        self.size = len(FIELDS) * len(self.layers)
        self.singular = np.zeros((self.size, self.size), complex)
        self._remainders = {i: self._split(layer) for i, layer in enumerate(self.layers) if layer.singular}
        self.conditions = self._conditions()
        self.real = not any(np.any(part.imag) for part in (*self.conditions, self.singular, self._evaluate(_INSIDE)))
        self._seen = {}

    def _names(self, rate, surfaces):
        return SimpleNamespace(k=self.k, rate=rate, **self.functions,
                               **dict(zip(self.flow.surfaces, surfaces, strict=False)))

    def _regular(self, layer, s):
        """M0 and M1 of a layer at the points s, (2, 4, 4, points); their limits where an edge gives 0/0."""
        with np.errstate(divide="ignore", invalid="ignore"):
            matrices = self._layer(layer, s)
        open_ = ~np.all(np.isfinite(matrices), axis=(0, 1, 2))
        if np.any(open_):
            series = chebyshev.coefficients(self._layer(layer, chebyshev.points(_SAMPLES)).reshape(-1, _SAMPLES).T)
            matrices[..., open_] = C.chebval(2 * s[open_] - 1, series).reshape(2, 4, 4, -1)
        return matrices

    def _layer(self, layer, s):
        base = layer.profile(s)
        zero, unit = np.zeros(4), np.eye(4)

        def residual(rate, fields, slopes):
            found = residuals(base, self.k, 0.0 if layer.steady else rate, fields, slopes, self.flow.order)
            return np.array([np.broadcast_to(part, s.shape) for part in found], complex)

        leading = np.array([residual(0.0, zero, unit[j])[j] for j in range(4)])
        constant, total = (-np.array([residual(rate, unit[j], zero) for j in range(4)]) for rate in (0.0, 1.0))
        return np.array([constant, total - constant]).swapaxes(1, 2) / leading[:, None]

    def _split(self, layer):
        """Series of a layer whose shear-rate equation is singular at s = 0, less S / s; S is stored."""
        s = chebyshev.points(_SAMPLES)
        series = chebyshev.coefficients((s * self._layer(layer, s)).reshape(-1, _SAMPLES).T)
        at_edge = C.chebval(-1.0, series)
        start = len(FIELDS) * self.layers.index(layer)
        block = slice(start, start + len(FIELDS))
        self.singular[block, block] = at_edge.reshape(2, 4, 4)[0]
        if layer.singular > 1 or np.max(np.abs(at_edge.reshape(2, 4, 4)[1])) > 1e-10:
            raise ParameterError(f"{self.flow.name}: solve_bvp takes one singular edge, at s = 0 of a layer")
        series[0] -= at_edge
        quotients = [C.chebdiv(column, [0.5, 0.5])[0] for column in series.T]
        remainder = np.zeros((max(map(len, quotients)), len(quotients)), complex)
        for column, quotient in enumerate(quotients):
            remainder[:len(quotient), column] = quotient
        return remainder

    def _evaluate(self, s):
        matrices = np.zeros((2, self.size, self.size, len(s)), complex)
        for i, layer in enumerate(self.layers):
            block = slice(4 * i, 4 * i + 4)
            if i in self._remainders:
                matrices[:, block, block] = C.chebval(2 * s - 1, self._remainders[i]).reshape(2, 4, 4, -1)
            else:
                matrices[:, block, block] = self._regular(layer, s)
        return matrices

    def matrices(self, s):
        """M0 and M1 without the singular term, (2, size, size, points); kept for the meshes of this solve."""
        key = s.tobytes()
        if key not in self._seen:
            self._seen = dict(list(self._seen.items())[-5:]) | {key: self._evaluate(s)}
        return self._seen[key]

    def _conditions(self):
        """C0 and C1 of the conditions (C0 + rate C1) (y(0), y(1), surfaces) = 0, and of regularity."""
        n, surfaces = self.size, len(self.flow.surfaces)
        names = [layer.name for layer in self.layers]

        def probe(rate, values):
            lower, upper = values[:n].reshape(-1, 4), values[n: 2 * n].reshape(-1, 4)
            edges = {name: tuple(SimpleNamespace(**dict(zip(FIELDS, edge[i], strict=True))) for edge in (lower, upper))
                     for i, name in enumerate(names)}
            return self.flow.conditions(SimpleNamespace(**edges), self._names(rate, values[2 * n:]))

        unit = np.eye(2 * n + surfaces)
        constant, total = (np.array([probe(rate, row) for row in unit], complex).T for rate in (0.0, 1.0))
        regular = [4 * i for i in self._remainders]
        smooth = np.zeros((len(regular), 2 * n + surfaces), complex)
        smooth[:, :n] = self.singular[regular]
        return np.vstack((constant, smooth)), np.vstack((total - constant, 0 * smooth))


@dataclass(frozen=True)
class _Solution:
    """What solve_bvp found: mesh, complex fields as a function of s, rate and surfaces, and the problem."""

    problem: Problem
    mesh: np.ndarray
    spline: Any
    parameters: np.ndarray
    residuals: np.ndarray

    @property
    def rate(self):
        return self.parameters[0]

    def fields(self, s):
        return _join(self.spline(s), self.problem.real)


def _solve(problem, mesh, fields, parameters, residual, frozen=False, nodes=_NODES):
    """Solve for fields and parameters from a guess (complex, fields (size, nodes)); None where solve_bvp fails.

    With `frozen` the rate stays as given, and one condition is left out: the kinematic one, or the
    last if the flow has no surface.
    """
    system = _Split(problem, parameters, frozen)
    guess = _part(parameters[frozen:], problem.real)
    with np.errstate(all="ignore"):
        found = solve_bvp(system.slopes, system.conditions, mesh, _part(fields, problem.real), guess,
                          S=system.singular, fun_jac=system.slopes_jacobian, bc_jac=system.conditions_jacobian,
                          tol=residual, max_nodes=nodes)
    if not found.success or not np.all(np.isfinite(found.y)):
        return None
    parameters = np.concatenate((parameters[:frozen], _join(found.p, problem.real) if len(guess) else []))
    return _Solution(problem, found.x, found.sol, parameters, found.rms_residuals)


class _Split:
    """The functions that solve_bvp calls, in real and imaginary parts."""

    def __init__(self, problem, parameters, frozen):
        self.problem, self.frozen, self.rate = problem, frozen, parameters[0]
        self.singular = _block(problem.singular, problem.real) if np.any(problem.singular) else None
        constant, linear = problem.conditions
        rows = np.arange(len(constant))
        if frozen:
            moving = np.flatnonzero(np.any(linear, axis=1))
            rows = np.delete(rows, moving[0] if len(moving) and problem.flow.surfaces else len(rows) - 1)
        self.constant, self.linear = constant[rows], linear[rows]

    def _values(self, p):
        """The rate and the amplitudes of all surfaces."""
        p = _join(np.asarray(p), self.problem.real)
        rate, others = (self.rate, p) if self.frozen else (p[0], p[1:])
        return rate, np.concatenate(([1.0], others)) if self.problem.flow.surfaces else np.zeros(0)

    def slopes(self, x, y, p=()):
        constant, linear = self.problem.matrices(x)
        rate, _ = self._values(p)
        fields = _join(y, self.problem.real)
        return _part(np.einsum("ijm,jm->im", constant + rate * linear, fields), self.problem.real)

    def slopes_jacobian(self, x, y, p=()):
        real = self.problem.real
        constant, linear = self.problem.matrices(x)
        rate, surfaces = self._values(p)
        by_fields = _block(constant + rate * linear, real)
        if not len(p):
            return by_fields
        by_p = np.zeros((len(by_fields), len(p), len(x)))
        if not self.frozen:
            by_rate = np.einsum("ijm,jm->im", linear, _join(y, real))
            by_p[:, _columns(0, len(p), real)] = _block(by_rate[:, None], real)
        return by_fields, by_p

    def conditions(self, ya, yb, p=()):
        real = self.problem.real
        rate, surfaces = self._values(p)
        values = np.concatenate((_join(ya, real), _join(yb, real), surfaces))
        left = (self.constant + rate * self.linear) @ values
        if not len(surfaces):
            left = np.append(left, values[self.problem.pivot] - 1)
        return _part(left, real)

    def conditions_jacobian(self, ya, yb, p=()):
        real, n = self.problem.real, self.problem.size
        rate, surfaces = self._values(p)
        values = np.concatenate((_join(ya, real), _join(yb, real), surfaces))
        matrix = self.constant + rate * self.linear
        by_rate = self.linear @ values
        if not len(surfaces):
            matrix = np.vstack((matrix, np.eye(2 * n)[self.problem.pivot]))
            by_rate = np.append(by_rate, 0)
        columns = ([] if self.frozen else [by_rate]) + list(matrix[:, 2 * n + 1:].T)
        parts = _block(matrix[:, :n], real), _block(matrix[:, n: 2 * n], real)
        if not columns:
            return parts
        return *parts, _block(np.array(columns).T, real)


def _join(values, real):
    """Real and imaginary halves (2 size, ...) as complex (size, ...)."""
    half = len(values) // 2
    return values if real else values[:half] + 1j * values[half:]


def _part(values, real):
    return values.real if real else np.concatenate((values.real, values.imag))


def _block(matrix, real):
    """Complex matrices (rows, columns, ...) acting on real and imaginary halves."""
    if real:
        return matrix.real
    return np.concatenate((np.concatenate((matrix.real, -matrix.imag), axis=1),
                           np.concatenate((matrix.imag, matrix.real), axis=1)))


def _columns(index, count, real):
    return [index] if real else [index, count // 2 + index]


def continue_in_k(flow, k, *, tolerance=TOLERANCE, residual=None, guess=None, setting=None):
    """Follow the surface mode of a flow through wavenumbers k by solve_bvp: a `Continuation`.

    Each point is refined until its error is below `tolerance` |sigma|, or solved once with solve_bvp's
    tolerance `residual`. `guess` is sigma at the smallest k, for flows without a long-wave limit. `setting` maps k to
    the flow that is solved (`thesis_setting`).
    """
    return _joined(steps_in_k(flow, k, tolerance=tolerance, residual=residual, guess=guess, setting=setting))


def steps_in_k(flow, k, *, tolerance=TOLERANCE, residual=None, guess=None, setting=None):
    """Yield the result of `continue_in_k` point by point, and at last what is lost."""
    setting = setting or (lambda k: flow)
    wavenumbers = np.unique(check_wavenumbers(k))
    effort = _effort(tolerance, residual)
    try:
        walk = _Walk(lambda k: (setting(k), k), *_start(setting, wavenumbers[0], guess, effort[1][0]), effort)
    except ModeLost as reason:
        yield Continuation((), dict.fromkeys(wavenumbers.tolist(), str(reason)))
    else:
        yield from _walk_through(walk, wavenumbers.tolist())


@one_thread
def continue_in(flow, name, values, k, *, tolerance=TOLERANCE, residual=None):
    """Follow the surface mode at fixed k through a monotone sequence of positive values of a parameter.

    The first point is reached from the long-wave limit. Arguments and result as for `continue_in_k`; `lost`
    has the parameter's values as keys.
    """
    values = [float(value) for value in values]
    effort = _effort(tolerance, residual)
    first = replace(flow, **{name: values[0]})
    walk = _Walk(lambda k: (first, k), *_start(lambda k: first, k, None, effort[1][0]), effort)
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
    mode: Point

    @property
    def growth_rate(self):
        return self.mode.growth_rate


@one_thread
def bounded_maximum(flow, search=SEARCH, *, tolerance=TOLERANCE, residual=None, setting=None):
    """Return the `BoundedMaximum` of the first maximum of growth met along k, by bounded minimisation.

    What the thesis does with fminbnd: values only, so that k is known to the square root of the accuracy
    of sigma. Raises NotResolved if growth rises to no maximum within `search`.
    """
    from scipy.optimize import minimize_scalar

    setting = setting or (lambda k: flow)
    effort = _effort(tolerance, residual)
    walk = _Walk(lambda k: (setting(k), k), *_start(setting, search[0], None, effort[1][0]), effort)
    wavenumbers = np.geomspace(*search, int(log(search[1] / search[0]) / _BRACKET_STEP) + 1)
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
    width = (2 * max(best.error, 1e-16 * abs(best.sigma)) / curvature) ** 0.5
    return BoundedMaximum(best.k, float(best.k * (width + _K_ACCURACY)), best)


def _effort(tolerance, residual):
    """Accepted relative error of sigma, and the tolerances of solve_bvp to try for it."""
    return (np.inf, (residual,)) if residual else (tolerance, _RESIDUALS)


@one_thread
def _start(setting, k, guess, residual):
    """First solution and its k: at a k so small that the long-wave limit holds, or at the guess."""
    for _ in range(12):
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


def _cold(flow, k, sigma, residual):
    """Solve with the rate held at the guess for the fields, then for all."""
    problem = Problem(flow, k)
    mesh = np.linspace(0, 1, _START_NODES)
    parameters = np.zeros(max(1, len(flow.surfaces)), complex)
    parameters[0] = sigma / problem.width
    rough = _solve(problem, mesh, np.zeros((problem.size, len(mesh)), complex), parameters, residual, frozen=True)
    return rough and _solve(problem, rough.mesh, rough.fields(rough.mesh), rough.parameters, residual)


def _walk_through(walk, values):
    for done, value in enumerate(values):
        try:
            yield Continuation((walk.point(value),), {})
        except ModeLost as reason:
            yield Continuation((), dict.fromkeys(values[done:], str(reason)))
            return


def _joined(parts):
    parts = list(parts)
    return Continuation(tuple(point for part in parts for point in part.points),
                        {value: reason for part in parts for value, reason in part.lost.items()})


class _Walk:
    """A walk along k or a parameter: `family` maps its value to (flow, k)."""

    def __init__(self, family, start, value, effort):
        self.tolerance, self.residuals = effort
        self.step = _FIRST_STEP
        self.now = start
        self.move(family, value)

    def move(self, family, value):
        """Go on along another parameter, which has this value now."""
        self.family, self.value, self.before, self.slope = family, value, None, None

    @property
    def sigma(self):
        return self.now.problem.width * self.now.rate

    def to(self, value):
        """Reach the value with solve_bvp's coarsest tolerance, in steps short enough for the predictor."""
        for _ in range(_STEPS):
            gap = log(value / self.value)
            if gap == 0:
                return self
            self._advance(value if abs(gap) <= self.step else self.value * exp(np.sign(gap) * self.step))
        raise self._lost(f"{_STEPS} steps did not reach {value:g}")

    @one_thread
    def point(self, value):
        """Reach the value, then tighten solve_bvp's tolerance until halving the mesh moves sigma little enough."""
        self.to(value)
        problem, coarse = self.now.problem, self.now
        for i, residual in enumerate(self.residuals):
            if i:
                coarse = _solve(problem, coarse.mesh, coarse.fields(coarse.mesh), coarse.parameters, residual)
            mesh = coarse and _halved(coarse.mesh)
            fine = coarse and _solve(problem, mesh, coarse.fields(mesh), coarse.parameters, residual)
            if not fine:
                raise self._lost(f"solve_bvp fails at tolerance {residual:g}")
            error = abs(fine.rate - coarse.rate)
            if error <= self.tolerance * abs(fine.rate):
                break
            coarse = fine
        status = "resolved" if error <= self.tolerance * abs(fine.rate) else \
            f"error {problem.width * error:.1e} exceeds tolerance with {len(fine.mesh)} nodes"
        sigma = problem.width * fine.rate
        return Point(problem.flow, problem.k, complex(sigma), float(problem.width * error), len(fine.mesh),
                     fine.spline.c.shape[-1] * len(fine.mesh), status)

    def _advance(self, value):
        """Take one step to the value, or shorten the step."""
        length = abs(log(value / self.value))
        mesh = _thinned(self.now, self.residuals[0])
        fields, parameters = self._predict(value, mesh)
        found = self._corrected(value, mesh, fields, parameters)
        change = self._change(found, mesh, fields, parameters) if found else np.inf
        slope = self._slope(found, value) if change < _CHANGE else None
        if slope is not None and self._bends_little(found, slope, log(value / self.value)):
            self.before, self.now, self.value, self.slope = (self.value, self.now), found, value, slope
            factor = min(2.0, max(0.7, (0.5 * _CHANGE / (change + 1e-6)) ** 0.5))
            self.step = min(_LARGEST_STEP, max(length, self.step if length < self.step else 0) * factor)
            return
        self.step = length / 3
        if self.step < _SMALLEST_STEP:
            raise self._lost("the next step lands on another mode" if found else "solve_bvp fails at the next step")

    def _corrected(self, value, mesh, fields, parameters):
        problem = Problem(*self.family(value))
        return _solve(problem, mesh, fields, parameters, self.residuals[0], nodes=_STEP_NODES + len(mesh))

    def _predict(self, value, mesh):
        """Fields and parameters extrapolated in the logarithm of the value."""
        fields, parameters = self.now.fields(mesh), self.now.parameters
        if self.before is None:
            return fields, parameters
        old_value, old = self.before
        ratio = log(value / self.value) / log(self.value / old_value)
        return (fields + ratio * (fields - old.fields(mesh)),
                parameters + ratio * (parameters - old.parameters))

    def _change(self, found, mesh, fields, parameters):
        """Largest relative difference between what was predicted and what was found."""
        now = found.fields(mesh)
        moved = np.linalg.norm(now - fields, axis=1) / np.linalg.norm(now, axis=1).clip(1e-12 * np.linalg.norm(now))
        return max(abs(found.rate - parameters[0]) / abs(found.rate), np.max(moved))

    def _slope(self, solution, value):
        """d rate / d log(value) by a second solve next to the first; None if it fails."""
        near = self._corrected(value * exp(_NUDGE), solution.mesh, solution.fields(solution.mesh), solution.parameters)
        return near and (near.rate - solution.rate) / _NUDGE

    def _bends_little(self, found, slope, length):
        """True if the slopes at both ends explain the step: it has not jumped across an avoided crossing."""
        if self.slope is None:
            self.slope = self._slope(self.now, self.value)
        if self.slope is None:
            return False
        miss = abs(found.rate - self.now.rate - length * (self.slope + slope) / 2)
        return miss < _BEND * abs(length) * max(abs(self.slope), abs(slope)) + _BEND_FLOOR * abs(found.rate)

    def _lost(self, why):
        flow, k = self.now.problem.flow, self.now.problem.k
        return ModeLost(f"{flow}: bvp gives up after k = {k:.6g}, sigma = {self.sigma:.6g}: {why}")


def _halved(mesh):
    return np.sort(np.concatenate((mesh, (mesh[1:] + mesh[:-1]) / 2)))


def _thinned(solution, residual):
    """The mesh without every second node, where the residual allows intervals twice as long."""
    mesh, size = solution.mesh, solution.residuals
    inner = np.arange(1, len(mesh) - 1, 2)
    idle = inner[np.maximum(size[inner - 1], size[inner]) < residual / 50]
    return mesh if len(mesh) - len(idle) < _START_NODES else np.delete(mesh, idle)
