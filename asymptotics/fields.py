"""Functions of one coordinate that exact integration of the orders produces.

A field is a sum of terms  c x^n,  c (x - q)^-m  and the same times log((x - q)/(x0 - q)), with q one of a
few known numbers (the poles) and c in a sympy domain of rational functions of the parameters. Such sums
are closed under addition, under products with log-free ones, and (as long as no dilogarithm appears)
under integration; nothing here is ever simplified, because partial fractions are a normal form.
"""

from collections import defaultdict
from dataclasses import dataclass, field
from math import comb
from typing import Any

import sympy as sp


class NotElementary(ArithmeticError):
    """An integral needs more than one logarithm: a dilogarithm, or a squared logarithm."""


class NotRegular(ArithmeticError):
    """A field is asked for its value at one of its poles."""


@dataclass(frozen=True)
class FieldSpace:
    """Where fields live: the domain of coefficients, the poles, and the point where every logarithm vanishes.

    logs   {(pole, point): element} values of log((x - q)/(origin - q)) at other points, as domain elements
    """

    domain: Any
    poles: tuple[int, ...] = ()
    origin: int | None = None
    logs: dict = field(default_factory=dict, hash=False)

    def zero(self) -> "Field":
        return Field(self, {})

    def constant(self, value: Any) -> "Field":
        return Field(self, {(None, 0, None): self.domain.convert(value)})

    def from_sympy(self, expression: sp.Expr, x: sp.Symbol) -> "Field":
        """Read a rational function of x whose denominator vanishes at the poles only."""
        numerator, denominator = sp.fraction(sp.cancel(expression))
        result = self._polynomial(numerator, x)
        denominator = sp.Poly(denominator, x)
        for pole in self.poles:
            while denominator.degree() > 0 and denominator.eval(pole) == 0:
                denominator = sp.quo(denominator, sp.Poly(x - pole, x))
                result = result * Field(self, {(pole, -1, None): self.domain.one})
        if denominator.degree() > 0:
            raise NotElementary(f"{expression} has a pole that is not among {self.poles}")
        return result * self.domain.from_sympy(1 / denominator.as_expr())

    def _polynomial(self, expression: sp.Expr, x: sp.Symbol) -> "Field":
        terms = sp.Poly(expression, x).terms()
        return Field(self, {(None, n, None): self.domain.from_sympy(c) for (n,), c in terms if c != 0})


@dataclass(frozen=True)
class Field:
    """terms: {(pole or None, power, pole of the logarithm or None): coefficient}; no coefficient is zero."""

    space: FieldSpace
    terms: dict

    def __bool__(self) -> bool:
        return bool(self.terms)

    def __add__(self, other: "Field") -> "Field":
        return _collect(self.space, [*self.terms.items(), *other.terms.items()])

    def __neg__(self) -> "Field":
        return self * -self.space.domain.one

    def __sub__(self, other: "Field") -> "Field":
        return self + -other

    def __mul__(self, other: Any) -> "Field":
        """Product with a domain element, or with a field (at most one factor has logarithms)."""
        if not isinstance(other, Field):
            return _collect(self.space, [(key, c * other) for key, c in self.terms.items()])
        products = []
        for (pole, power, log), c in self.terms.items():
            for (pole2, power2, log2), c2 in other.terms.items():
                if log is not None and log2 is not None:
                    raise NotElementary("product of two logarithms")
                kept = log2 if log is None else log
                products += [((*key, kept), c * c2 * weight)
                             for key, weight in _product(self.space.domain, (pole, power), (pole2, power2))]
        return _collect(self.space, products)

    def integral(self) -> "Field":
        """An antiderivative (which one is of no importance: constants are fixed by conditions)."""
        total = self.space.zero()
        for (pole, power, log), c in self.terms.items():
            if power == -1 and log is not None:
                raise NotElementary(f"the integral of log(x - {log})/(x - {pole}) is not a rational function times "
                                    "a logarithm; no closed form at this order")
            primitive = Field(self.space, {_primitive(pole, power): self.space.domain.one})
            if power != -1:
                primitive = primitive * self.space.domain.from_sympy(sp.Rational(1, power + 1))
            if log is not None:
                primitive = _by_parts(primitive, log)
            total = total + primitive * c
        return total

    def at(self, point: Any) -> Any:
        """Value at a point of the domain; a pole there must have cancelled."""
        domain = self.space.domain
        point, total = domain.convert(point), domain.zero
        for (pole, power, log), c in self.terms.items():
            factor = self._log_at(log, point) if log is not None else domain.one
            base = point - domain.convert(0 if pole is None else pole)
            if factor == 0:
                continue
            if base == 0 and power < 0:
                raise NotRegular(f"a term (x - {pole})^{power} remains at x = {pole}")
            total += c * factor * _power(domain, base, power)
        return total

    def _log_at(self, log: int, point: Any) -> Any:
        if point == self.space.domain.convert(self.space.origin):
            return self.space.domain.zero
        return self.space.logs[log, point]


def _power(domain: Any, base: Any, power: int) -> Any:
    if power == 0:
        return domain.one  # sympy's ring elements refuse 0**0
    return base**power if power > 0 else domain.one / base**-power


def _collect(space: FieldSpace, terms: list[Any]) -> Field:
    total = defaultdict(lambda: space.domain.zero)
    for key, c in terms:
        total[key] += c
    return Field(space, {key: c for key, c in total.items() if c != 0})


def _primitive(pole: int | None, power: int) -> tuple[Any, ...]:
    return (None, 0, pole) if power == -1 else (pole, power + 1, None)


def _by_parts(primitive: Field, log: int) -> Field:
    """Integral of f log(x - q) given the integral F of f:  F log(x - q) - integral of F/(x - q)."""
    space = primitive.space
    with_log = Field(space, {(pole, power, log): c for (pole, power, _), c in primitive.terms.items()})
    return with_log - (primitive * Field(space, {(log, -1, None): space.domain.one})).integral()


def _product(domain: Any, first: tuple[Any, ...], second: tuple[Any, ...]) -> list[tuple[Any, ...]]:
    """Partial fractions of (x - q)^a (x - q')^b as [((pole, power), weight)]; a pole None means q = 0, a >= 0."""
    (q, a), (q2, b) = first, second
    if a >= 0 and b >= 0:
        return [((None, a + b), domain.one)]
    if a < 0 and b < 0 and q != q2:
        return _two_poles(domain, q, -a, q2, -b)
    if a < 0 and b < 0:
        return [((q, a + b), domain.one)]
    if a < 0:
        q, a, b = q, b, a
    else:
        q, a, b = q2, a, b
    # x^a (x - q)^b with x = (x - q) + q
    terms = []
    for j in range(a + 1):
        weight = comb(a, j) * q ** (a - j)
        if weight == 0:
            continue
        if j + b < 0:
            terms.append(((q, j + b), domain.convert(weight)))
        else:
            terms += [((None, i), domain.convert(weight * comb(j + b, i) * (-q) ** (j + b - i)))
                      for i in range(j + b + 1) if (-q) ** (j + b - i) != 0]
    return terms


def _two_poles(domain: Any, q: int, a: int, q2: int, b: int) -> list[tuple[Any, ...]]:
    """Partial fractions of (x - q)^-a (x - q2)^-b, from the Taylor series of each factor at the other's pole."""
    def half(at: int, power: int, other: int, other_power: int) -> list[tuple[Any, ...]]:
        gap = sp.Integer(at - other)
        return [((at, j - power), domain.from_sympy(sp.binomial(-other_power, j) * gap ** (-other_power - j)))
                for j in range(power)]

    return half(q, a, q2, b) + half(q2, b, q, a)
