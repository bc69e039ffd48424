"""The derivative of a mode with respect to a parameter of its flow, from its left and right vectors.

d rate / d p = y^H (dA/dp - rate dB/dp) x. The coefficients of the equations are differenced in p (relative
step 1e-5), before anything cancels, so the result is good to 7 digits or more: enough for Newton.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, fields, replace
from math import isinf, prod
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ..equations.system import System
from ..errors import ParameterError
from ..flows.rules import numeric
from ..modes.eigenfunction import sharpened
from ..modes.mode import Mode
from ..modes.solver import Solver
from ..numerics import chebyshev
from ..output.panels import BARS, ELASTICITY, PARAMETER, Curve, Panel
from ..output.record import Record
from ..output.symbols import symbol_of, value_text
from ..output.text import Row
from ..status import Kind, Status, is_resolved, unresolved

if TYPE_CHECKING:
    from ..flows.base import Flow

_STEP = 1e-5
_STENCILS = {-1: -0.5, 1: 0.5}, {0: -1.5, 1: 2.0, 2: -0.5}, {0: 1.5, -1: -2.0, -2: 0.5}  # offsets: weights
_SAFETY = 2.0  # the errors of two slopes may cancel in part
_ROUNDING = 1.0  # error of a slope in units of the rounding of sigma over the step (measured)
_EIGENVALUE = 4.0  # error of a slope in units of error of sigma / parameter, as `Mode.slope_error` has it for k
_TOLERANCE = 1e-3  # error of a slope relative to itself, or to sigma / parameter, accepted as resolved


@dataclass(frozen=True)
class Slope:
    """d sigma / d parameter at its `value`, `error` a bound of its absolute error; None where there is none."""

    parameter: str
    value: float
    slope: complex | None
    error: float | None
    status: Status


@dataclass(frozen=True, repr=False)
class Sensitivities(Record):
    """The slopes of the complex growth rate of a mode in every numeric parameter of its flow, and in "k".

    `flow` and `mode` are what was asked about, `slopes` (parameters + 1,) are `Slope` records with `parameter`,
    `value`, `slope`, `error` and `status`, k first; `settings` say how the mode was found. Units: V/L over those of the
    parameter; an elasticity is a number. Writing raises ParameterError where a file cannot be written.

    >>> from stability import dispersion, flows, sensitivities
    >>> found = sensitivities(dispersion(flows.Vortex(), 1e-3).modes[0])
    >>> {row["parameter"]: round(row["elasticity"], 4) for row in found[:2]}  # of -2 k^2 / (5 tan slope)
    {'k': 2.0, 'slope_deg': -1.2092}
    """

    flow: Any
    mode: Mode
    slopes: tuple[Slope, ...]
    settings: Mapping[str, Any] = field(default_factory=dict, compare=False)
    dimension: ClassVar[str] = "parameter"
    bounded: ClassVar[str] = "the derivative of sigma"

    @property
    def k(self) -> float:
        """Wavenumber of the mode, 1/L."""
        return self.mode.k

    @property
    def subtitle(self) -> str:
        return f"; $k$ = {value_text(self.k)}"

    def panels(self) -> tuple[Panel, ...]:
        """Relative changes of the growth rate per relative change of every parameter, as bars."""
        rows = [row for row in self.rows() if row["elasticity"] is not None]
        names = ["$k$" if row["parameter"] == "k" else symbol_of(self.flow, row["parameter"]) for row in rows]
        bars = Curve(np.array([row["elasticity"] for row in rows]), np.array(names), kind=BARS)
        return (Panel(ELASTICITY, PARAMETER, (bars,), zero="x",
                      limits={"ylim": (len(rows) - 0.5, -0.5)}),)

    def rows(self) -> list[Row]:
        """Return a row of each parameter; `elasticity` is the relative change of the growth rate for its own."""
        return [self._row(one) for one in self.slopes]

    def about(self) -> dict[str, Any]:
        return {"k": self.k}

    def _row(self, one: Slope) -> Row:
        row: Row = {"parameter": one.parameter, "value": one.value, "d_growth_rate": None, "d_phase_speed": None,
                    "elasticity": None, "error": one.error, "status": one.status}
        if one.slope is None:
            return row
        speed = (1j * one.slope - (self.mode.c if one.parameter == "k" else 0)) / self.k
        growth = self.mode.growth_rate
        elasticity = one.value * one.slope.real / growth + 0.0 if growth else None
        return {**row, "d_growth_rate": one.slope.real, "d_phase_speed": speed.real + 0.0, "elasticity": elasticity}


def sensitivities(mode: Mode) -> Sensitivities:
    """Return the slopes of a mode in k and in every numeric parameter, each at the others fixed, with error bars.

    Each is complex, in V/L over the units of the parameter. A slope that cannot be found raises nothing:
    its status says why.

    >>> from stability import dispersion, flows
    >>> in_k = sensitivities(dispersion(flows.Vortex(slope_deg=45.0), 1e-3).modes[0]).slopes[0]
    >>> f"{in_k.slope.real:.3e}"  # of -2 k^2 / 5: -4 k / 5
    '-8.000e-04'
    """
    solver = Solver(mode.flow)
    refined = sharpened(solver, mode)
    error = _SAFETY * abs(refined.slope - mode.slope) + mode.slope_error
    in_k = _slope(mode, "k", mode.k, refined.slope, error)
    names = [item.name for item in fields(mode.flow) if numeric(item)]
    return Sensitivities(mode.flow, mode, (in_k, *(_in_parameter(solver, mode, refined, name) for name in names)))


def _in_parameter(solver: Solver, mode: Mode, refined: Mode, name: str) -> Slope:
    """The slope from sharpened vectors; that from those of the mode, with twice the step, bounds its error."""
    value = getattr(mode.flow, name)
    if isinf(value):
        return Slope(name, value, None, None, Status(Kind.NO_DERIVATIVE, f"{name} is infinite"))
    try:
        fine = parameter_slope(solver, refined, name)
        coarse = parameter_slope(solver, mode, name, 2 * _STEP)
    except ParameterError as reason:
        return Slope(name, value, None, None, Status(Kind.NO_DERIVATIVE, str(reason)))
    scale = abs(value) or 1.0
    error = (_EIGENVALUE * mode.error + _ROUNDING * mode.rounding / _STEP) / scale
    return _slope(mode, name, value, complex(fine), _SAFETY * abs(fine - coarse) + error)


def _slope(mode: Mode, name: str, value: float, slope: complex, error: float) -> Slope:
    status = mode.status
    if is_resolved(status) and error > _TOLERANCE * max(abs(slope), abs(mode.sigma) / (abs(value) or 1.0)):
        status = unresolved(f"error {error:.1e} exceeds tolerance")
    return Slope(name, value, slope, float(error), status)


def parameter_slope(solver: Solver, mode: Mode, name: str, step: float = _STEP) -> complex:
    """Return d sigma / d name of a mode of `solver.flow`, at fixed wavenumber; `step` is relative to its value."""
    return Derivative(solver, name, step)(mode)


class Derivative:
    """d sigma / d name of modes of `solver.flow`, at fixed wavenumber: the differenced equations serve all of them.

    Raises ParameterError where the value lies too close to the ends of its range.
    """

    def __init__(self, solver: Solver, name: str, step: float = _STEP) -> None:
        self._solver = solver
        self._weights, self._flows = _neighbours(solver.flow, name, step)
        self._systems = [System(flow) for flow in self._flows]

    def __call__(self, mode: Mode) -> complex:
        solver = self._solver
        tables = [_symbols(flow, mode) for flow in (solver.flow, *self._flows)]
        pencil, here = solver.pencil(mode.degree), solver.assembly.system
        slope = 0.0
        for equation, *versions in zip(here.equations, *(system.equations for system in self._systems), strict=True):
            terms = _changes(self._weights, equation.terms, [version.terms for version in versions], tables)
            slope += _in_equation(pencil, mode, equation.name, terms)
        for row, terms, *versions in zip(pencil.rows["conditions"], here.conditions,
                                         *(system.conditions for system in self._systems), strict=True):
            slope += _in_condition(pencil, mode, row, _changes(self._weights, terms, versions, tables))
        return solver.width(mode.k) * slope


def _symbols(flow: "Flow", mode: Mode) -> dict[str, Any]:
    """Values of k, rate and the flow's functions of k."""
    functions = flow.evaluate(np.array([mode.k]))
    return {"k": mode.k, "rate": mode.rate, **{name: parts[0][0] for name, parts in functions.items()}}


def _neighbours(flow: "Flow", name: str, step: float) -> "tuple[np.ndarray, list[Flow]]":
    """Weights (points,) of a difference formula in the parameter, and the flows at its points."""
    value = getattr(flow, name)
    step = step * (abs(value) or 1.0)
    for stencil in _STENCILS:
        try:
            flows = [replace(flow, **{name: value + offset * step}) for offset in stencil]
        except ParameterError:
            continue
        return np.array(list(stencil.values())) / step, flows
    raise ParameterError(f"{flow.name}: {name} = {value:g} lies too close to the end of its range to be varied")


def _changes(weights: Any, terms: Any, versions: Any, tables: Any) -> Iterator[Any]:
    """Yield (unknown, factor, series) of the derivative of an equation: of its coefficients, then of its functions.

    `tables` are the values of the symbols here and in each version. The weights add up to 0: only differences
    from the first version count.
    """
    here, *others = tables
    series = [{term[:2]: term[2] for term in version} for version in versions]
    length = max((len(values) for version in series for values in version.values()), default=1)
    for unknown, monomial in dict.fromkeys(key for version in series for key in version):
        first, *rest = (_padded(version.get((unknown, monomial), np.zeros(1)), length) for version in series)
        change = sum(weight * (other - first) for weight, other in zip(weights[1:], rest, strict=True))
        if np.any(change):
            yield unknown, prod(here[key] for key in monomial), change
    for unknown, monomial, values in terms:
        first, *rest = (prod(table[key] for key in monomial) for table in others)
        change = sum(weight * (other - first) for weight, other in zip(weights[1:], rest, strict=True))
        if change:
            yield unknown, change, values


def _in_equation(pencil: Any, mode: Any, equation: str, terms: Any) -> Any:
    """y^H times the terms of one equation."""
    total, left = 0.0, pencil.adjoint(mode.y.conj(), equation)
    for unknown, factor, series in terms:
        _, row, column, values = chebyshev.entries([series], [unknown.endswith("'")], len(left), pencil.degree)
        total += factor * (left[row] * values) @ pencil.field(mode.x, unknown.rstrip("'"))[column]
    return total


def _in_condition(pencil: Any, mode: Any, row: Any, terms: Any) -> Any:
    total = 0.0
    for unknown, factor, series in terms:
        name, _, end = unknown.partition("@")
        value = chebyshev.at(float(end), pencil.degree)[0] @ pencil.field(mode.x, name) if end else (
            mode.x[pencil.columns[name]][0])
        total += factor * series[0] * mode.y[row].conj() * value
    return total


def _padded(series: np.ndarray, length: int) -> np.ndarray:
    return np.concatenate((series, np.zeros(length - len(series))))
