"""A flow as a boundary-value problem for `scipy.integrate.solve_bvp`, with the rate as unknown parameter.

The equations of `equations.layer` are solved for the slopes, y' = (M0 + rate M1) y on 0 <= s <= 1 with
all layers side by side. scipy's line search squares without conjugating, so that complex problems are split into
real and imaginary parts. A yield surface at s = 0 enters as solve_bvp's singular term S y / s; a free surface is
regular in the flow's own map.
"""

from dataclasses import dataclass
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.polynomial import chebyshev as C
from scipy.integrate import solve_bvp

from ..equations.layer import FIELDS, residuals, resolved
from ..errors import ParameterError

if TYPE_CHECKING:
    from ..equations.layer import Layer, Profile
    from ..flows.base import Flow
    from ..numerics.smooth import Fit

_NODES = 20_000
_SHEAR_STRESS = 2  # index of t(0) among the edge values
_NOTHING = 1e-10  # a coefficient of the singular term that is rounding
_KEPT = 5  # meshes whose matrices are kept: those of one call of solve_bvp
_INSIDE = np.array([0.2, 0.7])


class Problem:
    """One flow at one wavenumber as y' = (M0 + rate M1) y + S y / s with conditions, for solve_bvp.

    The unknowns are the fields of all layers (size,), complex. `real` tells that all matrices are real; if not,
    real parts come first and imaginary parts after. The first surface has amplitude 1; without a
    surface `pivot`, an index into the edge values (y(0), y(1)), does. The parameters are the rate and
    the amplitudes of other surfaces.
    """

    def __init__(self, flow: "Flow", k: float, pivot: int = _SHEAR_STRESS) -> None:
        self.flow, self.k, self.pivot = flow, float(k), pivot
        self.width = k ** (1 + flow.order)
        self.functions = {name: value[0][0] for name, value in flow.evaluate(np.array([self.k])).items()}
        self.layers = flow.layers(self._names(0.0, ()))
        self.size = len(FIELDS) * len(self.layers)
        self.singular = np.zeros((self.size, self.size), complex)
        self._remainders = {i: self._split(i) for i, layer in enumerate(self.layers) if layer.singular}
        self.conditions = self._conditions()
        self.real = not any(np.any(part.imag) for part in (*self.conditions, self.singular, self._evaluate(_INSIDE)))
        self._seen = {}

    def _names(self, rate: float, surfaces: Any) -> Any:
        return SimpleNamespace(k=self.k, rate=rate, **self.functions,
                               **dict(zip(self.flow.surfaces, surfaces, strict=False)))

    def _regular(self, index: int, s: np.ndarray) -> np.ndarray:
        """M0 and M1 of a layer at the points s, (2, 4, 4, points); their limits where an edge gives 0/0."""
        layer = self.layers[index]
        with np.errstate(divide="ignore", invalid="ignore"):
            matrices = self._layer(layer, layer.base(s), s)
        open_ = ~np.all(np.isfinite(matrices), axis=(0, 1, 2))
        if np.any(open_):
            matrices[..., open_] = self._series(index, 0).at(s[open_]).reshape(2, 4, 4, -1)
        return matrices

    def _series(self, index: int, power: int) -> "Fit":
        """Series of the entries of M0 and M1 of a layer times this power of s."""
        layer = self.layers[index]
        return resolved(self.flow, self.layers, index, together=True, coefficients=lambda base, s:
                        (s**power * self._layer(layer, base, s)).reshape(-1, len(s)))

    def _layer(self, layer: "Layer", base: "Profile", s: np.ndarray) -> np.ndarray:
        zero, unit = np.zeros(4), np.eye(4)

        def residual(rate: float, fields: np.ndarray, slopes: np.ndarray) -> np.ndarray:
            found = residuals(base, self.k, 0.0 if layer.steady else rate, fields, slopes, self.flow.order)
            return np.array([np.broadcast_to(part, s.shape) for part in found], complex)

        leading = np.array([residual(0.0, zero, unit[j])[j] for j in range(4)])
        constant, total = (-np.array([residual(rate, unit[j], zero) for j in range(4)]) for rate in (0.0, 1.0))
        return np.array([constant, total - constant]).swapaxes(1, 2) / leading[:, None]

    def _split(self, index: Any) -> Any:
        """Series of a layer whose shear-rate equation is singular at s = 0, less S / s; S is stored."""
        layer, fit = self.layers[index], self._series(index, 1)
        series = np.zeros((fit.length, len(fit.series)), complex)
        for column, one in zip(series.T, fit.series, strict=True):
            column[:len(one)] = one
        at_edge = C.chebval(-1.0, series)
        start = len(FIELDS) * index
        block = slice(start, start + len(FIELDS))
        self.singular[block, block] = at_edge.reshape(2, 4, 4)[0]
        if layer.singular > 1 or np.max(np.abs(at_edge.reshape(2, 4, 4)[1])) > _NOTHING:
            raise ParameterError(f"{self.flow.name}: solve_bvp takes one singular edge, at s = 0 of a layer")
        series[0] -= at_edge
        quotients = [C.chebdiv(column, [0.5, 0.5])[0] for column in series.T]
        remainder = np.zeros((max(map(len, quotients)), len(quotients)), complex)
        for place, quotient in enumerate(quotients):
            remainder[:len(quotient), place] = quotient
        return remainder

    def _evaluate(self, s: np.ndarray) -> np.ndarray:
        matrices = np.zeros((2, self.size, self.size, len(s)), complex)
        for i in range(len(self.layers)):
            block = slice(4 * i, 4 * i + 4)
            if i in self._remainders:
                matrices[:, block, block] = C.chebval(2 * s - 1, self._remainders[i]).reshape(2, 4, 4, -1)
            else:
                matrices[:, block, block] = self._regular(i, s)
        return matrices

    def matrices(self, s: np.ndarray) -> np.ndarray:
        """M0 and M1 without the singular term, (2, size, size, points); kept for the meshes of this solve."""
        key = s.tobytes()
        if key not in self._seen:
            self._seen = dict(list(self._seen.items())[-_KEPT:]) | {key: self._evaluate(s)}
        return self._seen[key]

    def _conditions(self) -> tuple[np.ndarray, ...]:
        """C0 and C1 of the conditions (C0 + rate C1) (y(0), y(1), surfaces) = 0, and of regularity."""
        n, surfaces = self.size, len(self.flow.surfaces)
        names = [layer.name for layer in self.layers]

        def probe(rate: float, values: np.ndarray) -> tuple[Any, ...]:
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
class Solution:
    """What solve_bvp found: mesh, complex fields as a function of s, rate and surfaces, and the problem."""

    problem: Problem
    mesh: np.ndarray
    spline: Any
    parameters: np.ndarray
    residuals: np.ndarray

    @property
    def rate(self) -> complex:
        return self.parameters[0]

    def fields(self, s: Any) -> Any:
        return _join(self.spline(s), self.problem.real)


def solve(problem: Any, mesh: Any, fields: Any, parameters: Any, residual: Any, frozen: Any = False,
          nodes: Any = _NODES) -> Any:
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
    return Solution(problem, found.x, found.sol, parameters, found.rms_residuals)


class _Split:
    """The functions that solve_bvp calls, in real and imaginary parts."""

    def __init__(self, problem: "Problem", parameters: np.ndarray, frozen: bool) -> None:
        self.problem, self.frozen, self.rate = problem, frozen, parameters[0]
        self.singular = _block(problem.singular, problem.real) if np.any(problem.singular) else None
        constant, linear = problem.conditions
        rows = np.arange(len(constant))
        if frozen:
            moving = np.flatnonzero(np.any(linear, axis=1))
            rows = np.delete(rows, moving[0] if len(moving) and problem.flow.surfaces else len(rows) - 1)
        self.constant, self.linear = constant[rows], linear[rows]

    def _values(self, p: Any) -> tuple[Any, ...]:
        """The rate and the amplitudes of all surfaces."""
        p = _join(np.asarray(p), self.problem.real)
        rate, others = (self.rate, p) if self.frozen else (p[0], p[1:])
        return rate, np.concatenate(([1.0], others)) if self.problem.flow.surfaces else np.zeros(0)

    def slopes(self, x: np.ndarray, y: np.ndarray, p: Any = ()) -> np.ndarray:
        constant, linear = self.problem.matrices(x)
        rate, _ = self._values(p)
        fields = _join(y, self.problem.real)
        return _part(np.einsum("ijm,jm->im", constant + rate * linear, fields), self.problem.real)

    def slopes_jacobian(self, x: np.ndarray, y: np.ndarray, p: Any = ()) -> Any:
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

    def conditions(self, ya: np.ndarray, yb: np.ndarray, p: Any = ()) -> np.ndarray:
        real = self.problem.real
        rate, surfaces = self._values(p)
        values = np.concatenate((_join(ya, real), _join(yb, real), surfaces))
        left = (self.constant + rate * self.linear) @ values
        if not len(surfaces):
            left = np.append(left, values[self.problem.pivot] - 1)
        return _part(left, real)

    def conditions_jacobian(self, ya: np.ndarray, yb: np.ndarray, p: Any = ()) -> tuple[Any, ...]:
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


def _join(values: np.ndarray, real: bool) -> np.ndarray:
    """Real and imaginary halves (2 size, ...) as complex (size, ...)."""
    half = len(values) // 2
    return values if real else values[:half] + 1j * values[half:]


def _part(values: np.ndarray, real: bool) -> np.ndarray:
    return values.real if real else np.concatenate((values.real, values.imag))


def _block(matrix: np.ndarray, real: bool) -> np.ndarray:
    """Complex matrices (rows, columns, ...) acting on real and imaginary halves."""
    if real:
        return matrix.real
    return np.concatenate((np.concatenate((matrix.real, -matrix.imag), axis=1),
                           np.concatenate((matrix.imag, matrix.real), axis=1)))


def _columns(index: int, count: int, real: bool) -> list[int]:
    return [index] if real else [index, count // 2 + index]
