"""The equations and conditions of a flow, written out once: which coefficient multiplies which unknown.

Independent of any resolution. Terms are kept as (unknown, monomial, series): the Chebyshev series in s
multiplies the unknown (or its s-derivative, marked ') and a product of scalar symbols such as k^2 rate.
"""

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np

from . import chebyshev
from .errors import ConditionCount
from .forms import symbol
from .layer import FIELDS, residuals

_EQUATIONS = ("shear rate", "continuity", "momentum along", "momentum across")
_SAMPLES = 96  # points that carry the base flow: its series is then exact to rounding


@dataclass(frozen=True)
class Equation:
    """One first-order equation: its terms, and how many rows it takes beyond the degree."""

    name: str
    terms: tuple
    extra: int


class System:
    """All `equations` and `conditions` of a flow, with the names of its `unknowns` and `surfaces`."""

    def __init__(self, flow):
        names = SimpleNamespace(k=symbol("k"), rate=symbol("rate"),
                                **{name: symbol(name) for name in (*flow.functions, *flow.surfaces)})
        layers = flow.layers(names)
        self.fields = tuple(f"{layer.name}.{field}" for layer in layers for field in FIELDS)
        self.surfaces = tuple(flow.surfaces)
        self.equations = tuple(equation for layer in layers for equation in self._equations(layer, names, flow.order))
        edges = SimpleNamespace(**{layer.name: tuple(_edge(layer, end) for end in (0, 1)) for layer in layers})
        self.conditions = tuple(self._terms(form) for form in flow.conditions(edges, names))
        self.dynamic_layers = sum(not layer.steady for layer in layers)
        _check_count(flow, layers, len(self.conditions))

    @property
    def pattern(self):
        """Which unknowns and monomials meet in each equation and condition, whatever their coefficients: hashable."""
        rows = *((equation.extra, equation.terms) for equation in self.equations), *((0, t) for t in self.conditions)
        return tuple((extra, tuple(term[:2] for term in terms)) for extra, terms in rows)

    def __eq__(self, other):
        return _same(self.equations, other.equations) and _same(self.conditions, other.conditions)

    __hash__ = None  # type: ignore[assignment]

    def _equations(self, layer, names, order):
        fields = [symbol(f"{layer.name}.{field}") for field in FIELDS]
        slopes = [symbol(f"{layer.name}.{field}'") for field in FIELDS]
        rate = 0.0 if layer.steady else names.rate
        forms = residuals(layer.profile(chebyshev.points(_SAMPLES)), names.k, rate, fields, slopes, order)
        for name, form in zip(_EQUATIONS, forms, strict=True):
            yield Equation(f"{layer.name}: {name}", self._terms(form), layer.singular if name == "shear rate" else 0)

    def _terms(self, form):
        """Split every term of a form into its one unknown, its monomial and its series."""
        terms = []
        for names, coefficient in form.terms.items():
            if not np.any(coefficient):
                continue
            unknowns = [name for name in names if name.rstrip("'").partition("@")[0] in self.fields + self.surfaces]
            if len(unknowns) != 1:
                raise ValueError(f"an equation must be linear in the unknowns: got {'*'.join(names) or 'a constant'}")
            monomial = tuple(name for name in names if name != unknowns[0])
            terms.append((unknowns[0], monomial, _series(coefficient)))
        return tuple(terms)


def _same(one, other):
    """Equality of nested tuples whose leaves may be arrays."""
    if isinstance(one, np.ndarray):
        return np.array_equal(one, other)
    if isinstance(one, Equation):
        return one.name == other.name and one.extra == other.extra and _same(one.terms, other.terms)
    if isinstance(one, tuple):
        return len(one) == len(other) and all(_same(a, b) for a, b in zip(one, other, strict=True))
    return one == other


def _edge(layer, end):
    return SimpleNamespace(**{field: symbol(f"{layer.name}.{field}@{end}") for field in FIELDS})


def _series(coefficient):
    """T-coefficients of a coefficient given at the sample points, or of a number; real if it is real."""
    value = np.asarray(coefficient)
    value = value if np.any(value.imag) else value.real
    return chebyshev.coefficients(value) if value.ndim else np.atleast_1d(value)


def _check_count(flow, layers, given):
    """Each layer needs one condition per equation, less one per singular edge; each surface one more."""
    needed = sum(4 - layer.singular for layer in layers) + len(flow.surfaces)
    if given != needed:
        parts = [f"{4 - layer.singular} for {layer.name}" for layer in layers]
        parts += [f"1 for {surface}" for surface in flow.surfaces]
        raise ConditionCount(f"{flow.name}: expected {needed} conditions ({', '.join(parts)}), got {given}")
