"""Solve a linear stability problem order by order in a small gauge, by exact integration.

With kappa = i k, sigma = kappa * speed and the normal velocity divided by kappa, the first-order system of
`linearise` reads  y' = M(x; kappa, speed) y  in a coordinate x that makes M rational. In the gauge
epsilon, kappa = epsilon^q, fields and speed are power series. M at epsilon = 0 is (up to reordering) strictly
triangular, so that order m is a chain of integrals of orders < m; the conditions then fix one constant per
equation and the next coefficient of the speed.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import sympy as sp
from sympy.polys.matrices import DomainMatrix

from . import linearise
from .fields import Field, FieldSpace

kappa, speed = sp.symbols("kappa speed")
FIELDS = tuple(str(symbol) for symbol in linearise.FIELDS)


class NotTriangular(ValueError):
    """The system at epsilon = 0 cannot be solved by successive integration."""


class ConditionsMiscounted(ValueError):
    """As many conditions as unknowns are needed."""


class OrderNotKnown(ValueError):
    """A given series (the response of the fluid) ends before the order that is asked for."""


@dataclass(frozen=True)
class Layer:
    """One layer of the flow: its system in the coordinate x and the functions that solve it.

    matrix   of d(w/kappa, u, t, n)/dx in x, kappa and speed (see `long_wave`)
    poles    numbers where M, or an integral of it, has a pole
    origin   the edge where all logarithms are taken to vanish
    logs     {(pole, point): symbol} for log((x - pole)/(origin - pole)) at the other edge
    """

    name: str
    x: sp.Symbol
    matrix: sp.Matrix
    poles: tuple[int, ...] = ()
    origin: int | None = None
    logs: Mapping[tuple[int, sp.Expr], sp.Symbol] = field(default_factory=dict)

    def at(self, point: Any, values: sp.Expr) -> sp.Expr:
        """Write w, u, t, n in a condition as the values of this layer's fields at `point`."""
        return values.subs({symbol: edge_value(self.name, symbol.name, point) for symbol in linearise.FIELDS})


def edge_value(layer: str, name: str, point: Any) -> sp.Symbol:
    return _EdgeValue(layer, name, sp.sympify(point))


class _EdgeValue(sp.Symbol):
    """The value of a field at an edge."""

    def __new__(cls, layer: str, name: str, point: Any) -> "_EdgeValue":
        symbol = super().__new__(cls, f"{name}@{layer}({point})")
        symbol.where = (layer, name, point)
        return symbol


def long_wave(expression: Any, scale: Mapping[str, int] | None = None) -> Any:
    """Write k = -i kappa, sigma = kappa speed, w = kappa w (and field = kappa^scale field) in a matrix or condition."""
    scale = {"w": 1, **(scale or {})}
    powers = [kappa ** scale.get(name, 0) for name in FIELDS]
    substitution = {linearise.k: -sp.I * kappa, linearise.sigma: kappa * speed}
    if isinstance(expression, sp.MatrixBase):
        expression = expression.subs(substitution)
        return sp.Matrix(4, 4, lambda i, j: expression[i, j] * powers[j] / powers[i])
    return sp.expand(expression.subs(substitution).subs(
        {symbol: symbol * power for symbol, power in zip(linearise.FIELDS, powers, strict=True)}, simultaneous=True))


class Hierarchy:
    """Coefficients of `speed` in powers of epsilon, each computed once, when first asked for.

    layers       the layers of the flow
    conditions   expressions that vanish, linear in the layers' edge values (`Layer.at`) and in the
                 amplitude s0, polynomial in kappa, speed and the given series
    q            kappa = epsilon^q
    given        {symbol: coefficients of epsilon^0, epsilon^1, ...} for functions of k known beforehand
    eigenvalue   False for a forced problem, where there is no speed to find
    """

    def __init__(self, layers: Sequence[Layer], conditions: Sequence[sp.Expr], q: int = 1,
                 given: Mapping[sp.Symbol, Sequence[sp.Expr]] | None = None, eigenvalue: bool = True) -> None:
        self.q, self.given, self.eigenvalue = q, dict(given or {}), eigenvalue
        self.domain = _domain(layers, conditions, self.given)
        self.layers = {layer.name: _SolvableLayer(layer, self.domain) for layer in layers}
        self._conditions = [self._terms(condition) for condition in conditions]
        self._speed: list = []
        unknowns = sum(len(layer.names) for layer in self.layers.values()) + eigenvalue
        if len(conditions) != unknowns:
            raise ConditionsMiscounted(f"expected {unknowns} conditions for layers {list(self.layers)}, "
                                       f"got {len(conditions)}")
        self._inverse = DomainMatrix(self._unknown_columns(), (unknowns, unknowns), self.domain).inv().to_list()

    def speed(self, order: int) -> sp.Expr:
        """Coefficient of epsilon^order in speed = sigma/(i k)."""
        self._solve(order)
        return self.domain.to_sympy(self._speed[order])

    def edge(self, symbol: sp.Symbol, order: int) -> sp.Expr:
        """Coefficient of epsilon^order of an edge value."""
        self._solve(order)
        return self.domain.to_sympy(self._edge(symbol, order))

    # -- one order -------------------------------------------------------------------------------

    def _solve(self, order: int) -> None:
        while len(self._speed) <= order:
            self._next_order()

    def _next_order(self) -> None:
        order = len(self._speed)
        for symbol, coefficients in self.given.items():
            if order >= len(coefficients):
                raise OrderNotKnown(f"order {order} needs more terms of {symbol} than the {len(coefficients)} given")
        self._speed.append(self.domain.zero)
        for layer in self.layers.values():
            layer.particular(order, self.q, self._speed)
        right = [-self._residual(condition, order) for condition in self._conditions]
        solution = [sum((a * b for a, b in zip(row, right, strict=True)), self.domain.zero) for row in self._inverse]
        if self.eigenvalue:
            self._speed[order] = solution.pop()
        for layer in self.layers.values():
            count = len(layer.names)
            layer.add_homogeneous(order, solution[:count])
            solution = solution[count:]

    def _residual(self, condition: dict[tuple[Any, ...], Any], order: int) -> Any:
        """The part of a condition at this order, with the fields and speeds found so far."""
        total = self.domain.zero
        for (target, speed_power, shift), c in condition.items():
            if shift > order:
                continue
            if speed_power == 0:
                total += c * self._edge(target, order - shift)
            else:
                total += c * sum((self._speed[a] * self._edge(target, order - shift - a)
                                  for a in range(order - shift + 1)), self.domain.zero)
        return total

    def _edge(self, target: "_EdgeValue | None", order: int) -> Any:
        if target is None:
            return self.domain.one if order == 0 else self.domain.zero
        layer, name, point = target.where
        return self.layers[layer].solution[order][name].at(self.domain.from_sympy(point))

    def _unknown_columns(self) -> list[list[Any]]:
        """Matrix of the conditions at epsilon = 0 acting on the constants of integration and the speed."""
        rows = []
        for condition in self._conditions:
            row = [self._leading(condition, layer, j) for layer in self.layers.values()
                   for j in range(len(layer.names))]
            if self.eigenvalue:
                row.append(condition.get((None, 1, 0), self.domain.zero))
            rows.append(row)
        return rows

    def _leading(self, condition: dict[tuple[Any, ...], Any], layer: "_SolvableLayer", j: int) -> Any:
        total = self.domain.zero
        for (target, speed_power, shift), c in condition.items():
            if target is not None and shift == 0 and target.where[0] == layer.name:
                if speed_power:
                    raise NotTriangular(f"speed multiplies {target} at leading order; only the amplitude may")
                _, name, point = target.where
                total += c * layer.homogeneous[j][name].at(self.domain.from_sympy(point))
        return total

    def _terms(self, condition: sp.Expr) -> dict:
        """{(edge value or None for the amplitude, power of speed, power of epsilon): coefficient}."""
        targets = sorted((s for s in condition.free_symbols if isinstance(s, _EdgeValue)), key=str)
        series = {symbol: sum(c * _epsilon**j for j, c in enumerate(coefficients))
                  for symbol, coefficients in self.given.items()}
        condition = sp.expand(condition * kappa**4)  # rescaled fields bring negative powers; only relative ones matter
        expression = sp.expand(condition.subs(series).subs(kappa, _epsilon**self.q))
        poly = sp.Poly(expression, _epsilon, speed, linearise.amplitude, *targets)
        lowest = min(powers[0] for powers in poly.monoms())
        terms = {}
        for (power, speed_power, _, *which), c in poly.terms():
            target = targets[which.index(1)] if 1 in which else None
            terms[target, speed_power, power - lowest] = self.domain.from_sympy(c)
        return terms


_epsilon = sp.Dummy("epsilon")


class _SolvableLayer:
    """A layer's expanded system, its solutions at epsilon = 0, and the solution so far."""

    def __init__(self, layer: Layer, domain: Any) -> None:
        self.name, self.names = layer.name, FIELDS
        logs = {(pole, domain.from_sympy(sp.sympify(point))): domain.from_sympy(value)
                for (pole, point), value in layer.logs.items()}
        self.space = FieldSpace(domain, layer.poles, layer.origin, logs)
        self.blocks = self._expand(layer)
        self.order_of_integration = self._triangular_order()
        self.homogeneous = [self._integrate({name: self.space.zero() for name in self.names}, {unit: domain.one})
                            for unit in self.names]
        self.solution: list[dict[str, Field]] = []

    def _expand(self, layer: Layer) -> dict:
        """{(power of kappa, power of speed): {(row, column): Field}}"""
        blocks: dict = {}
        for i, row in enumerate(self.names):
            for j, column in enumerate(self.names):
                entry = sp.expand(layer.matrix[i, j])
                if entry == 0:
                    continue
                for (a, b), c in sp.Poly(entry, kappa, speed).terms():
                    blocks.setdefault((a, b), {})[row, column] = self.space.from_sympy(c, layer.x)
        if any(a == 0 and b for a, b in blocks):
            raise NotTriangular(f"layer {self.name}: speed appears in the equations at leading order")
        return blocks

    def _triangular_order(self) -> list[str]:
        leading, ordered = self.blocks.get((0, 0), {}), []
        while len(ordered) < len(self.names):
            ready = [name for name in self.names if name not in ordered
                     and all(column in ordered for row, column in leading if row == name)]
            if not ready:
                raise NotTriangular(f"layer {self.name}: at leading order the fields depend on each other in a circle; "
                                    "rescale one of them (long_wave(..., scale=...))")
            ordered += ready
        return ordered

    def _integrate(self, forcing: dict[str, Field], constants: Mapping) -> dict[str, Field]:
        """Solve y' = M_0 y + forcing with the given constants of integration."""
        result: dict[str, Field] = {}
        for name in self.order_of_integration:
            slope = forcing[name]
            for (row, column), entry in self.blocks.get((0, 0), {}).items():
                if row == name:
                    slope = slope + result[column] * entry
            result[name] = slope.integral()
            if name in constants:
                result[name] = result[name] + self.space.constant(constants[name])
        return result

    def particular(self, order: int, q: int, speeds: Sequence) -> None:
        """Append the solution at this order without constants of integration."""
        forcing = {name: self.space.zero() for name in self.names}
        for (power, speed_power), block in self.blocks.items():
            if power == 0:
                continue
            for a in range(order - q * power + 1 if speed_power else 1):
                before = order - q * power - a
                if before < 0:
                    continue
                for (row, column), entry in block.items():
                    term = self.solution[before][column] * entry
                    forcing[row] = forcing[row] + (term * speeds[a] if speed_power else term)
        self.solution.append(self._integrate(forcing, {}))

    def add_homogeneous(self, order: int, constants: Sequence) -> None:
        fields = self.solution[order]
        for constant, solution in zip(constants, self.homogeneous, strict=True):
            for name in self.names:
                fields[name] = fields[name] + solution[name] * constant


def _domain(layers: Any, conditions: Any, given: Any) -> Any:
    """Rational functions, with rational coefficients, of every parameter."""
    symbols = set().union(*(condition.free_symbols for condition in conditions))
    for layer in layers:
        symbols |= layer.matrix.free_symbols - {layer.x}
        symbols |= {s for (_, point), value in layer.logs.items()
                    for s in sp.Tuple(point, value).free_symbols}
    for coefficients in given.values():
        symbols |= set().union(*(sp.sympify(c).free_symbols for c in coefficients))
    points = {s for symbol in symbols if isinstance(symbol, _EdgeValue)
              for s in symbol.where[2].free_symbols}
    symbols = {s for s in symbols if not isinstance(s, _EdgeValue)} | points
    symbols -= {kappa, speed, linearise.amplitude, linearise.z, *given}
    return sp.QQ.frac_field(*sorted(symbols, key=str)) if symbols else sp.QQ
