"""The derivative of a mode with respect to a parameter of its flow, from its left and right vectors.

d rate / d p = y^H (dA/dp - rate dB/dp) x. The coefficients of the equations are differenced in p (relative
step 1e-5), before anything cancels, so the result is good to about 10 digits.
"""

from dataclasses import replace
from math import prod

import numpy as np

from . import chebyshev
from .errors import ParameterError
from .mode import Solver
from .system import System

_STEP = 1e-5
_CENTRAL = {-1: -0.5, 1: 0.5}
_FORWARD = {0: -1.5, 1: 2.0, 2: -0.5}


def parameter_slope(solver, mode, name):
    """Return d sigma / d name of a mode of `solver.flow`, at fixed wavenumber."""
    weights, flows = _neighbours(solver.flow, name)
    systems = [System(flow) for flow in flows]
    pencil = solver.pencil(mode.degree)
    symbols = {key: value[0] for key, value in solver.symbols(mode.k).items()} | {"rate": mode.rate}
    slope = sum(part(pencil, mode, symbols, weights, systems) for part in (_in_equations, _in_conditions))
    if solver.flow.functions:
        slope += _through_functions(solver, mode, weights, flows)
    return solver.width(mode.k) * slope


def _neighbours(flow, name):
    """Weights (points,) of a difference formula in the parameter, and the flows at its points."""
    value = getattr(flow, name)
    step = _STEP * (abs(value) or 1.0)
    for stencil in (_CENTRAL, _FORWARD):
        try:
            flows = [replace(flow, **{name: value + offset * step}) for offset in stencil]
        except ParameterError:
            continue
        return np.array(list(stencil.values())) / step, flows
    raise ParameterError(f"{flow.name}: {name} = {value:g} lies too close to the end of its range to be varied")


def _in_equations(pencil, mode, symbols, weights, systems):
    slope = 0.0
    for versions in zip(*(system.equations for system in systems), strict=True):
        rows = pencil.rows[versions[0].name]
        for unknown, monomial, series in _changes(weights, [equation.terms for equation in versions]):
            row, column, values = chebyshev.entries(series, len(rows), pencil.degree, unknown.endswith("'"))
            places = pencil.columns[unknown.rstrip("'")][column]
            slope += prod(symbols[key] for key in monomial) * (mode.y.conj()[rows[row]] * values) @ mode.x[places]
    return slope


def _in_conditions(pencil, mode, symbols, weights, systems):
    ends = chebyshev.at(np.array([0.0, 1.0]), pencil.degree)
    slope = 0.0
    for row, *versions in zip(pencil.rows["conditions"], *(system.conditions for system in systems), strict=True):
        for unknown, monomial, series in _changes(weights, versions):
            name, _, end = unknown.partition("@")
            values = mode.x[pencil.columns[name]]
            at_edge = ends[int(end)] @ values if end else values[0]
            slope += prod(symbols[key] for key in monomial) * series[0] * mode.y[row].conj() * at_edge
    return slope


def _changes(weights, versions):
    """Terms whose series differ between versions of an equation, with the derivative of the series.

    The weights add up to 0: only the difference from the first version counts.
    """
    tables = [{term[:2]: term[2] for term in terms} for terms in versions]
    length = max((len(series) for table in tables for series in table.values()), default=1)
    for key in dict.fromkeys(key for table in tables for key in table):
        first, *others = (_padded(table.get(key, np.zeros(1)), length) for table in tables)
        change = sum(weight * (other - first) for weight, other in zip(weights[1:], others, strict=True))
        if np.any(change):
            yield *key, change


def _padded(series, length):
    return np.concatenate((series, np.zeros(length - len(series))))


def _through_functions(solver, mode, weights, flows):
    """The part that comes from the flow's functions of k."""
    pencil = solver.pencil(mode.degree)
    values = [pencil.weights(Solver(flow, assembly=solver.assembly).symbols(mode.k)).value for flow in flows]
    parts = pencil.matrices.left(mode.y.conj()) @ mode.x
    return (weights @ np.array(values) * pencil.powers(mode.rate)) @ parts
