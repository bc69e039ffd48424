"""The equations of a layer with symbols for its profile: which products of these multiply which unknown.

They are written out once for all profiles. Of a given one each coefficient is then a sum of one or two products.
"""

from functools import lru_cache
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np

from .forms import Form, variable
from .layer import FIELDS, residuals

if TYPE_CHECKING:
    from .layer import Profile

_UNKNOWNS = *FIELDS, *(f"{field}'" for field in FIELDS)
_FACTORS = "dz", "eta", "rho", "U", "dU", "alpha", "g", "dg", "clear"  # of the profile
_INVERSE = "1/beta"  # equations divide by nothing else

Place = tuple[int, str, tuple[str, ...]]  # an equation, an unknown of a layer or its slope, a product of other symbols


class _Divisor:
    """What may only be divided by."""

    def __rtruediv__(self, number: Any) -> Form:
        return number * variable(_INVERSE)


def coefficients(base: "Profile", order: int, steady: bool) -> dict[Place, Any]:
    """Return {place: coefficient} of the residuals for a profile, arrays over its points or numbers.

    `order` is a of the scaling; the equations of a `steady` layer have no rate. What is 0 throughout is left out.
    """
    values = {name: getattr(base, name) for name in _FACTORS}
    values[_INVERSE] = np.divide(1.0, base.beta)
    none = {name for name, value in values.items() if isinstance(value, float) and not value}
    found: dict[Place, Any] = {}
    for (equation, unknown, symbols), terms in _template(order, steady):
        for number, factors in terms:
            if not none.isdisjoint(factors):
                continue
            product = number
            for name in factors:
                product = product * values[name]
            for more, one in product.terms.items() if isinstance(product, Form) else (((), product),):
                place = equation, unknown, tuple(sorted(symbols + more)) if more else symbols
                found[place] = found[place] + one if place in found else one
    return found


@lru_cache(maxsize=8)
def _template(order: int, steady: bool) -> tuple[tuple[Place, tuple[tuple[complex, tuple[str, ...]], ...]], ...]:
    """For each place the numbers and the factors of its products."""
    base = SimpleNamespace(beta=_Divisor(), **{name: variable(name) for name in _FACTORS})
    forms = residuals(base, variable("k"), 0.0 if steady else variable("rate"), [variable(name) for name in FIELDS],
                      [variable(f"{name}'") for name in FIELDS], order)
    found: dict[Place, list[Any]] = {}
    for equation, form in enumerate(forms):
        for names, number in form.terms.items():
            (unknown,) = (name for name in names if name in _UNKNOWNS)
            factors = tuple(name for name in names if name in (*_FACTORS, _INVERSE))
            symbols = tuple(name for name in names if name in ("k", "rate"))
            if number:
                found.setdefault((equation, unknown, symbols), []).append((number, factors))
    return tuple((place, tuple(terms)) for place, terms in found.items())
