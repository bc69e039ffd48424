"""Thin shear layers of steady granular flows: their flux or velocity in powers of the driving just above yield.

A layer of thickness ~ delta is stretched to 0 < y < 1 and the steady equations are expanded in delta; nothing but their
integrals over y is left, all of polynomials. The friction law is mu = mu1 + (mu2 - mu1) I/(I0 + I), thesis (1.11).
"""

from collections.abc import Mapping
from functools import cache
from typing import Any

import sympy as sp

from .parameters import Parameter
from .series import Expansion

mu1, mu2, I0 = sp.symbols("mu1 mu2 I0", positive=True)
delta, y = sp.symbols("delta y", positive=True)

FRICTION = (
    Parameter("mu1", "friction at rest", sp.Integer(0), remedy="a friction coefficient is positive"),
    Parameter("mu2", "friction of rapid flow, above mu1", sp.Integer(0), remedy="a friction coefficient is positive"),
    Parameter("I0", "inertial number half-way between them", sp.Integer(0), remedy="give a positive number"),
)
NAMES = ("mu1", "mu2", "I0")
DEFAULTS = {"mu1": "0.3818628674187188", "mu2": "0.6434683848584607", "I0": "0.279"}  # glass beads: tan of 20.9, 32.76
LATEX = {"mu1": r"\mu_1", "mu2": r"\mu_2", "I0": "I_0", "delta": r"\delta"}


def rising(values: Mapping[Any, Any]) -> str:
    """Why the friction coefficients given do not belong to a law; empty if they do."""
    low, high = values.get("mu1"), values.get("mu2")
    return f"mu2 must exceed mu1, got {high} and {low}" if low and high and not low < high else ""


@cache
def _inverse() -> tuple[sp.Expr, sp.Symbol]:
    number, mu = sp.symbols("number mu", positive=True)
    (found,) = sp.solve(sp.Eq(mu1 + (mu2 - mu1) * number / (I0 + number), mu), number)
    return found, mu


def inertial_number(mu: sp.Expr) -> sp.Expr:
    """I at which friction is mu.

    >>> inertial_number(mu1)
    0
    """
    found, symbol = _inverse()
    return sp.factor(found).subs(symbol, mu)


def layer_law(flow: str, integrand: sp.Expr, order: Any, quantity: str, names: tuple[str, ...] = NAMES) -> Expansion:
    """Expansion in delta of the integral over 0 < y < 1 of an integrand that begins with delta^2."""
    terms, derivative = {}, integrand
    for power in range(int(order) + 1):
        coefficient = sp.cancel(sp.together(derivative.subs(delta, 0))) / sp.factorial(power)
        integral = sp.factor(sp.integrate(sp.expand(coefficient), (y, 0, 1)))
        if power > 1:
            terms[sp.Integer(power)] = integral
        elif integral != 0:
            raise ArithmeticError(f"{flow}: the layer begins with delta^{power}, not with delta^2")
        derivative = sp.diff(derivative, delta)
    return Expansion(flow, "quasi-static", terms, sp.Integer(int(order) + 1), dict.fromkeys(names), gauge=delta,
                     quantity=quantity)
