"""The derivative of a mode with respect to a parameter of its flow, from its left and right vectors.

d sigma / d p = y^H (dA/dp - rate dB/dp) x in units of sigma / rate: two products with the matrices of the
differentiated equations. Their coefficients are differenced in p (five points, relative step 1e-3), before
anything cancels, so the result is good to about 11 digits.
"""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np

from .errors import ParameterError
from .mode import Solver
from .pencil import Pencil
from .system import Equation, System

_STEP = 1e-3
_CENTRAL = {-2: 1 / 12, -1: -2 / 3, 1: 2 / 3, 2: -1 / 12}
_FORWARD = {0: -25 / 12, 1: 4.0, 2: -3.0, 3: 4 / 3, 4: -1 / 4}


def parameter_slope(solver, mode, name):
    """Return d sigma / d name of a mode of `solver.flow`, at fixed wavenumber."""
    weights, flows = _neighbours(solver.flow, name)
    changes = Pencil(_difference(weights, [System(flow) for flow in flows]), mode.degree)
    slope = _product(mode, changes, changes.weights(solver.symbols(mode.k)).value)
    if solver.flow.functions:
        slope += _through_functions(solver, mode, weights, flows)
    return solver.width(mode.k) * slope


def _product(mode, pencil, values):
    """y^H (A - rate B) x for the parts weighted with `values`."""
    return (values * pencil.powers(mode.rate)) @ (pencil.matrices.left(mode.y.conj()) @ mode.x)


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


def _difference(weights, systems):
    """The weighted sum of systems that differ in their coefficients only."""
    first = systems[0]
    equations = tuple(
        Equation(equation.name, _sum(weights, [system.equations[i].terms for system in systems]), equation.extra)
        for i, equation in enumerate(first.equations))
    conditions = tuple(_sum(weights, [system.conditions[i] for system in systems])
                       for i in range(len(first.conditions)))
    return SimpleNamespace(fields=first.fields, surfaces=first.surfaces, equations=equations, conditions=conditions)


def _sum(weights, versions):
    """Sum of weight * terms; the weights of a derivative add up to 0, so only what differs from the first counts."""
    tables = [{term[:2]: term[2] for term in terms} for terms in versions]
    keys = dict.fromkeys(key for table in tables for key in table)
    length = max((len(series) for table in tables for series in table.values()), default=1)
    total = []
    for key in keys:
        first, *others = (_padded(table.get(key, np.zeros(1)), length) for table in tables)
        total.append((*key, sum(weight * (other - first) for weight, other in zip(weights[1:], others, strict=True))))
    return tuple(total)


def _padded(series, length):
    return np.concatenate((series, np.zeros(length - len(series))))


def _through_functions(solver, mode, weights, flows):
    """The part of d rate / d p that comes from the flow's functions of k."""
    pencil = solver.pencil(mode.degree)
    values = [pencil.weights(Solver(flow, assembly=solver.assembly).symbols(mode.k)).value for flow in flows]
    return _product(mode, pencil, weights @ np.array(values))
