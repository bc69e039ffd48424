"""The derivative of a mode with respect to a parameter of its flow, from its left and right vectors.

d rate / d p = y^H (dA/dp - rate dB/dp) x. The coefficients of the equations are differenced in p (relative
step 1e-5), before anything cancels, so the result is good to 7 digits or more: enough for Newton.
"""

from dataclasses import replace
from math import prod

import numpy as np

from . import chebyshev
from .errors import ParameterError
from .system import System

_STEP = 1e-5
_CENTRAL = {-1: -0.5, 1: 0.5}
_FORWARD = {0: -1.5, 1: 2.0, 2: -0.5}


def parameter_slope(solver, mode, name):
    """Return d sigma / d name of a mode of `solver.flow`, at fixed wavenumber."""
    weights, flows = _neighbours(solver.flow, name)
    systems = [System(flow) for flow in flows]
    tables = [_symbols(flow, mode) for flow in (solver.flow, *flows)]
    pencil, here = solver.pencil(mode.degree), solver.assembly.system
    slope = 0.0
    for equation, *versions in zip(here.equations, *(system.equations for system in systems), strict=True):
        terms = _changes(weights, equation.terms, [version.terms for version in versions], tables)
        slope += _in_equation(pencil, mode, pencil.rows[equation.name], terms)
    for row, terms, *versions in zip(pencil.rows["conditions"], here.conditions,
                                     *(system.conditions for system in systems), strict=True):
        slope += _in_condition(pencil, mode, row, _changes(weights, terms, versions, tables))
    return solver.width(mode.k) * slope


def _symbols(flow, mode):
    """Values of k, rate and the flow's functions of k."""
    functions = flow.evaluate(np.array([mode.k]))
    return {"k": mode.k, "rate": mode.rate, **{name: parts[0][0] for name, parts in functions.items()}}


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


def _changes(weights, terms, versions, tables):
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


def _in_equation(pencil, mode, rows, terms):
    """y^H times the terms of one equation."""
    total = 0.0
    for unknown, factor, series in terms:
        _, row, column, values = chebyshev.entries([series], [unknown.endswith("'")], len(rows), pencil.degree)
        places = pencil.columns[unknown.rstrip("'")][column]
        total += factor * (mode.y.conj()[rows[row]] * values) @ mode.x[places]
    return total


def _in_condition(pencil, mode, row, terms):
    total = 0.0
    for unknown, factor, series in terms:
        name, _, end = unknown.partition("@")
        values = mode.x[pencil.columns[name]]
        edge = chebyshev.at(float(end), pencil.degree)[0] if end else np.ones(1)
        total += factor * series[0] * mode.y[row].conj() * (edge @ values)
    return total


def _padded(series, length):
    return np.concatenate((series, np.zeros(length - len(series))))
