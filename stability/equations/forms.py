"""Polynomials in named symbols: how equations and conditions are written down once, on paper's terms.

The residual of an equation is a `Form`: a sum of coefficients (numbers, or arrays over the points
of a layer) times products of symbols, one of which is an unknown. A flow writes
`(rate + 1j * U) * s0 - w`; the pencil reads off which coefficient multiplies which unknown and
which power of `k`. The same functions accept plain numbers, mpmath numbers or sympy symbols.
"""

from typing import Any


class Form:
    """Sum of coefficient * product of symbols; `terms` maps sorted symbol names to coefficients."""

    __array_ufunc__ = None  # let `array * form` come to us
    __slots__ = ("terms",)

    def __init__(self, terms: dict[tuple[Any, ...], Any]) -> None:
        self.terms = terms

    def __add__(self, other: Any) -> "Form":
        total = dict(self.terms)
        for names, coefficient in _form(other).terms.items():
            total[names] = total[names] + coefficient if names in total else coefficient
        return Form(total)

    def __mul__(self, other: Any) -> "Form":
        if not isinstance(other, Form):
            return Form({names: value * other for names, value in self.terms.items()})
        total: dict[tuple[Any, ...], Any] = {}
        for right, b in other.terms.items():
            for left, a in self.terms.items():
                names = tuple(sorted(left + right)) if left and right else left or right
                total[names] = total[names] + a * b if names in total else a * b
        return Form(total)

    def __neg__(self) -> "Form":
        return self * -1.0

    def __sub__(self, other: "Form") -> "Form":
        return self + -_form(other)

    def __rsub__(self, other: Any) -> Any:
        return -self + other

    def __truediv__(self, number: Any) -> Any:
        return self * (1 / number)

    def __pow__(self, power: int) -> "Form":
        if not isinstance(power, int) or power < 0:
            raise TypeError(f"a power of a symbol must be 0, 1, 2 ... (got {power!r})")
        product = Form({(): 1.0})
        for _ in range(power):
            product = product * self
        return product

    __radd__ = __add__
    __rmul__ = __mul__


def variable(name: str) -> "Form":
    """Return the form that is this symbol."""
    return Form({(name,): 1.0})


def _form(value: Any) -> "Form":
    return value if isinstance(value, Form) else Form({(): value})
