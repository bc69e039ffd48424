"""A truncated expansion of the growth rate, with its parameters, as formulas and as a fast function of k.

    sigma = sum of c_p g^p,  g the gauge (usually k), p rational, c_p exact in the parameters
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import Any

import sympy as sp

k = sp.Symbol("k", positive=True)
_ROUNDING = 1e-14  # relative part of a coefficient that is none


class StillSymbolic(ValueError):
    """A number is asked for while a parameter has no value."""


@dataclass(frozen=True)
class Expansion:
    """Terms of a quantity (the complex growth rate sigma, unless `quantity` says otherwise) in powers of a gauge.

    terms        {power: exact coefficient}, in increasing order; a power that is known to vanish is 0
    next_power   power of the first term left out: the order at which the error must fall
    parameters   {name: value, or None while symbolic}
    wavenumber   k, in terms of the gauge if that varies it
    step         distance between successive powers; None takes it from those that there are

    `flow` and `regime` name what was expanded, in the `gauge`, a symbol. Units are the scales of the flow. Raises
    StillSymbolic for unknown parameters and where a number is asked for too early, KeyError for a power without a
    coefficient.

    >>> from asymptotics import expand
    >>> law = expand("vortex", order=2)
    >>> law.with_parameters(slope_deg=45).coefficient(2), law.next_power
    (-2/5, 4)
    >>> law.truncated(2).values(), expand("vortex", slope_deg=45, order=4).truncated(2).next_power
    ({2: None}, 4)
    """

    flow: str
    regime: str
    terms: Mapping[sp.Rational, sp.Expr]
    next_power: sp.Rational
    parameters: Mapping[str, sp.Expr | None]
    gauge: sp.Symbol = k
    quantity: str = "sigma"
    wavenumber: sp.Expr = k
    step: sp.Rational | None = None

    @cached_property
    def spacing(self) -> sp.Rational:
        """Distance between successive powers."""
        powers = sorted([*self.terms, self.next_power])
        return self.step or gcd_of([after - before for before, after in pairwise(powers)])

    @cached_property
    def alternates(self) -> bool:
        """Whether coefficients of even powers are real and those of odd ones imaginary: sigma(-k) = conj sigma(k)."""
        values = self.values()
        return self.gauge == k and all(p.is_integer and vanishes(c, "real" if p % 2 else "imag")
                                       for p, c in values.items())

    @property
    def next_powers(self) -> dict[str, sp.Rational]:
        """Power of the first term left out in the real and in the imaginary part."""
        late = {"real": self.next_power % 2, "imag": 1 - self.next_power % 2} if self.alternates else {}
        return {part: self.next_power + late.get(part, 0) for part in ("real", "imag")}

    @cached_property
    def expression(self) -> sp.Expr:
        """The sum of the terms."""
        return sp.Add(*(c * self.gauge**power for power, c in self.terms.items()), evaluate=True)

    @property
    def growth_rate(self) -> sp.Expr:
        """Real part of sigma."""
        return self._part(sp.re)

    @property
    def phase_speed(self) -> sp.Expr:
        """Real part of i sigma/k: positive downstream."""
        return self._part(lambda c: -sp.im(c) / self.wavenumber)

    def coefficient(self, power: Any) -> sp.Expr:
        """The exact coefficient of a power; raises KeyError where there is none."""
        return self.terms[sp.Rational(power)]

    def values(self) -> dict[sp.Rational, complex | None]:
        """The coefficients as numbers; None while a parameter is symbolic."""
        return {power: _number(c) for power, c in self.terms.items()}

    def with_parameters(self, **values: Any) -> "Expansion":
        """The same expansion with numbers (or expressions) for some of its parameters.

        Raises StillSymbolic for a parameter that it has not.
        """
        unknown = set(values) - set(self.parameters)
        if unknown:
            raise StillSymbolic(f"{self.flow}, regime {self.regime}, has no parameter {', '.join(sorted(unknown))}; "
                                f"it has {', '.join(self.parameters)}")
        exact = {name: sp.nsimplify(value, rational=True) for name, value in values.items()}
        substitution = {symbol: exact[symbol.name] for symbol in self._symbols if symbol.name in exact}
        terms = {power: c.subs(substitution) for power, c in self.terms.items()}
        return replace(self, terms=terms, parameters={**self.parameters, **exact},
                       wavenumber=self.wavenumber.subs(substitution))

    def truncated(self, power: Any) -> "Expansion":
        """Only the terms up to `power`; the next one that does not vanish sets the order of the error.

        Raises TypeError where `power` is no number.
        """
        power = sp.Rational(power)
        left_out = [p for p, c in self.terms.items() if p > power and c != 0]
        terms = {p: c for p, c in self.terms.items() if p <= power}
        return replace(self, terms=terms, next_power=min([*left_out, self.next_power]))

    def derivative(self) -> "Expansion":
        """The slope of the sum in the gauge; raises nothing.

        >>> from asymptotics import expand
        >>> print(expand("film").derivative().terms[0])
        -2*I
        """
        terms = {power - 1: power * c for power, c in self.terms.items() if power != 0}
        return replace(self, terms=terms, next_power=self.next_power - 1)

    def function(self, **values: Any) -> Callable[[Any], Any]:
        """A numpy function of the gauge (shape in, same shape out, complex), all parameters being numbers.

        >>> from asymptotics.flows import vortex
        >>> sigma = vortex.long_wave_law().function(slope_deg=45, Fr2=0)
        >>> print(f"{sigma(0.1).real:.7f}")
        -0.0039536

        Raises StillSymbolic while a parameter has no value.
        """
        import numpy as np

        coefficients = self.with_parameters(**values).values()
        missing = [name for name, value in self.parameters.items() if value is None and name not in values]
        if any(c is None for c in coefficients.values()):
            raise StillSymbolic(f"the expansion still depends on {', '.join(missing)}; "
                                f"give values, e.g. {missing[0]}=1")
        pairs = [(c, float(power)) for power, c in coefficients.items()]

        def series(gauge: Any) -> Any:
            gauge = np.asarray(gauge, dtype=float)
            return sum((c * gauge**power for c, power in pairs), np.zeros_like(gauge, dtype=complex))

        return series

    @property
    def _symbols(self) -> list[sp.Symbol]:
        free = set().union(*(c.free_symbols for c in self.terms.values()))
        return sorted(free, key=str)

    def _part(self, part: Any) -> sp.Expr:
        return sp.Add(*(part(sp.expand_complex(c) if c.is_Number else c) * self.gauge**power
                        for power, c in self.terms.items()))


def vanishes(coefficient: complex | None, part: str) -> bool:
    """Whether the real or imaginary part ("real", "imag") of a coefficient is but rounding."""
    return coefficient is not None and abs(getattr(coefficient, part)) <= _ROUNDING * abs(coefficient)


def gcd_of(steps: Any) -> sp.Rational:
    """The largest rational number of which all the given ones are multiples."""
    return sp.Rational(sp.igcd(*(step.p for step in steps), 0), sp.ilcm(*(step.q for step in steps), 1))


def power_of_i(power: Any) -> sp.Expr:
    """i^power on the principal branch, as cos + i sin."""
    angle = sp.pi * sp.Rational(power) / 2
    return sp.cos(angle) + sp.I * sp.sin(angle)


def _number(expression: sp.Expr) -> complex | None:
    return None if expression.free_symbols else complex(expression.evalf(20))
