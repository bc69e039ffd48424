"""The equations and conditions of a flow, written out once: which coefficient multiplies which unknown.

Independent of any resolution. Terms are kept as (unknown, monomial, series): the Chebyshev series in s
multiplies the unknown (or its s-derivative, marked ') and a product of scalar symbols such as k^2 rate.
"""

from cmath import isfinite
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from math import ceil, log2
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np

from ..checks import shown
from ..errors import ConditionCount, ParameterError
from .forms import Form, variable
from .layer import FIELDS, ODD_WITH_W, resolved
from .template import coefficients

if TYPE_CHECKING:
    from .layer import Layer, Profile

_PROPORTIONAL = 1e-12  # relative difference of ratios that is rounding: two conditions that say the same
_FEW = 8  # terms of a series up to which each of them counts
_MANY = 3  # layers from which on longer series have lengths that others share: their blocks are full anyway
_LENGTHS, _STEP = (16, 32), 4  # those lengths, and how far apart they are beyond
_LEAST, _STEPS = 0.35, 2  # of growths over the largest: the smallest that is told apart, and steps in an octave
_SYMMETRIC = 1e-13  # largest coefficient of the wrong parity, relative, in a layer that is its own mirror image
_EQUATIONS = ("shear rate", "continuity", "momentum along", "momentum across")


@dataclass(frozen=True)
class Equation:
    """One first-order equation: its terms, and how many rows it takes beyond the degree.

    `cuts` are (unknown, monomial, bound) of the terms whose series leave out more than rounding.
    """

    name: str
    terms: tuple
    extra: int
    cuts: tuple = ()


@dataclass(frozen=True)
class EquationRow:
    """An equation or a condition, whatever its coefficients: terms (unknown, monomial, indices that may not be 0)."""

    name: str
    extra: int
    terms: tuple


@dataclass(frozen=True)
class Structure:
    """What systems have in common that differ in numbers alone: `rows` of the `equations` and then of the conditions.

    The first `fields` of the `unknowns` are fields, the others surfaces; `longest` is that of `System`. `parts` are the
    monomials, those from `first_b` on with the rate; `powers` (parts, symbols) counts the other `symbols` in them.
    Where w has a `reflection`, 1 or -1, of the T-coefficients of every field and residual either the even or the odd
    ones vanish; it is 0 where all count. `growths` (layers,) are those of `Layer`, their
    second numbers relative to the largest.
    """

    unknowns: tuple
    fields: int
    equations: int
    longest: int
    rows: tuple
    reflection: int = 0
    growths: tuple[tuple[int, float] | None, ...] = ()

    @cached_property
    def plain(self) -> "Structure":
        """The same without the growths: tables of entries do not depend on them."""
        return _the_one(replace(self, growths=(None,) * len(self.growths)))

    @property
    def stride(self) -> int:
        """From one coefficient that counts to the next."""
        return 2 if self.reflection else 1

    @cached_property
    def first(self) -> tuple[int, ...]:
        """The first coefficient that counts of each field; of its equation it is the other one, 0 or 1."""
        return tuple(int(self.reflection * ODD_WITH_W[field % len(FIELDS)] < 0) for field in range(self.fields))

    def degrees(self, degree: int) -> list[int]:
        """That of each layer where none has a larger one than this `degree`: all are for waves equally short."""
        short = min((max(degree - plain, 0) / more for plain, more in filter(None, self.growths)), default=0.0)
        return [min(degree, ceil(growth[0] + growth[1] * short)) if growth else degree for growth in self.growths]

    def __hash__(self) -> int:
        return self._hash

    @cached_property
    def _hash(self) -> int:
        return hash((self.unknowns, self.rows, self.reflection, self.growths))

    @cached_property
    def parts(self) -> tuple[Any, ...]:
        return tuple(sorted({monomial for row in self.rows for _, monomial, _ in row.terms},
                            key=lambda monomial: ("rate" in monomial, monomial)))

    @cached_property
    def first_b(self) -> int:
        return sum("rate" not in part for part in self.parts)

    @cached_property
    def symbols(self) -> tuple[Any, ...]:
        return tuple(sorted({name for part in self.parts for name in part} - {"rate"}))

    @cached_property
    def powers(self) -> np.ndarray:
        return np.array([[part.count(name) for name in self.symbols] for part in self.parts])


class System:
    """All `equations` and `conditions` of a flow, with the names of its `unknowns` and `surfaces`.

    A `twin` is the system of another symmetry class of the same layer: its equations are those of this one.
    """

    def __init__(self, flow: Any, twin: "System | None" = None) -> None:
        names = SimpleNamespace(k=variable("k"), rate=variable("rate"),
                                **{name: variable(name) for name in (*flow.functions, *flow.surfaces)})
        layers = flow.layers(names)
        self.fields = tuple(f"{layer.name}.{field}" for layer in layers for field in FIELDS)
        self.surfaces, self.reflection = tuple(flow.surfaces), flow.reflection
        self.equations: tuple[Equation, ...] = twin.equations if twin else tuple(
            equation for index in range(len(layers)) for equation in self._equations(flow, layers, index))
        edges = SimpleNamespace(**{layer.name: tuple(_edge(layer, end) for end in (0, 1)) for layer in layers})
        given = flow.conditions(edges, names)
        _check_conditions(flow, given)
        self.conditions = tuple(self._terms(form) for form in given)
        self.dynamic = tuple(not layer.steady for layer in layers)
        self._growths = tuple(layer.growth for layer in layers)
        self.growths = _relative(self._growths)
        _check_count(flow, layers, len(self.conditions))
        if self.reflection and not twin:
            self.equations = _mirrored(flow, layers, self.equations)

    @property
    def pattern(self) -> tuple[Any, ...]:
        """Which unknowns and monomials meet in each equation and condition, whatever their coefficients: hashable."""
        rows = tuple((row.extra, tuple(term[:2] for term in row.terms)) for row in self.structure.rows)
        return self.reflection, *rows

    @cached_property
    def structure(self) -> "Structure":
        """The `Structure` of the equations."""
        rows = *((one.name, one.extra, one.terms) for one in self.equations), *(("", 0, one) for one in self.conditions)
        terms = tuple(EquationRow(name, extra, tuple((unknown, monomial, _support(series))
                                                     for unknown, monomial, series in terms))
                      for name, extra, terms in rows)
        return _the_one(Structure((*self.fields, *self.surfaces), len(self.fields), len(self.equations), self.longest,
                                  terms, self.reflection, self.growths))

    @cached_property
    def coefficients(self) -> np.ndarray:
        """All Chebyshev coefficients that may not be 0, term by term in the order of the structure."""
        rows = *(equation.terms for equation in self.equations), *self.conditions
        return np.concatenate([series[_places(series)] for terms in rows for *_, series in terms])

    def __eq__(self, other: Any) -> Any:
        alike = (self.reflection, self.growths) == (other.reflection, other.growths)
        return alike and _same(self.equations, other.equations) and _same(self.conditions, other.conditions)

    __hash__ = None  # type: ignore[assignment]

    def likely_degree(self, k: float) -> float:
        """What the layers that tell how their series grow are likely to need at wavenumber k; 0 where none does."""
        return max((plain + more * k for plain, more in filter(None, self._growths)), default=0.0)

    @property
    def longest(self) -> int:
        """Terms of the longest series."""
        return max(len(series) for equation in self.equations for *_, series in equation.terms)

    def _equations(self, flow: Any, layers: tuple[Any, ...], index: int) -> Iterator[Any]:
        layer, keys = layers[index], []

        def given(base: "Profile", s: np.ndarray) -> list[Any]:
            found = coefficients(base, flow.order, layer.steady)
            keys[:] = found
            return list(found.values())

        fit = resolved(flow, layers, index, given)
        cuts, longest = fit.cut.tolist(), max(map(len, fit.series)) if len(layers) >= _MANY else 0
        for equation, name in enumerate(_EQUATIONS):
            here = [(*self._split((f"{layer.name}.{unknown}", *symbols)), _rounded(series, longest), cut)
                    for (index, unknown, symbols), series, cut in zip(keys, fit.series, cuts, strict=True)
                    if index == equation and (len(series) > 1 or series[0])]
            yield Equation(f"{layer.name}: {name}", tuple(term[:3] for term in here),
                           layer.singular if name == "shear rate" else 0,
                           tuple((unknown, monomial, cut) for unknown, monomial, _, cut in here if cut))

    def _terms(self, form: Form) -> tuple[Any, ...]:
        """Split every term of a condition into its one unknown, its monomial and its number as a series."""
        return tuple((*self._split(names), _series(number)) for names, number in form.terms.items() if number)

    def _split(self, names: tuple[Any, ...]) -> tuple[Any, ...]:
        return _split(names, self.fields + self.surfaces)


@lru_cache(maxsize=4096)
def _split(names: tuple[str, ...], known: tuple[str, ...]) -> tuple[str, tuple[str, ...]]:
    """The one unknown among the names of a product, and the monomial of the others."""
    unknowns = [name for name in names if name.rstrip("'").partition("@")[0] in known]
    if len(unknowns) != 1 or names.count("rate") > 1:
        raise ParameterError("equations and conditions must be linear in the unknowns and in the rate: got "
                             f"{'*'.join(names) or 'a constant'}")
    return unknowns[0], tuple(name for name in names if name != unknowns[0])


def _relative(growths: tuple[tuple[int, float] | None, ...]) -> tuple[tuple[int, float] | None, ...]:
    """The growths of layers for waves equally short, roughly: flows that are nearly the same are to have the same."""
    most = max((growth[1] for growth in filter(None, growths)), default=0.0)
    return tuple(growth and (growth[0], _roughly(growth[1] / most)) for growth in growths)


def _roughly(share: float) -> float:
    """One of a few numbers that is not smaller."""
    return 2 ** (ceil(_STEPS * log2(max(share, _LEAST))) / _STEPS)


def _same(one: Any, other: Any) -> bool:
    """Equality of nested tuples whose leaves may be arrays."""
    if isinstance(one, np.ndarray):
        return np.array_equal(one, other)
    if isinstance(one, Equation):
        alike = (one.name, one.extra, one.cuts) == (other.name, other.extra, other.cuts)
        return alike and _same(one.terms, other.terms)
    if isinstance(one, tuple):
        return len(one) == len(other) and all(_same(a, b) for a, b in zip(one, other, strict=True))
    return one == other


def _edge(layer: "Layer", end: int) -> Any:
    return SimpleNamespace(**{field: variable(f"{layer.name}.{field}@{end}") for field in FIELDS})


@lru_cache(maxsize=64)
def _the_one(structure: Structure) -> Structure:
    """Of equal structures always the same object: what knows its hash and is compared by identity is found at once."""
    return structure


def _rounded(series: np.ndarray, longest: int) -> np.ndarray:
    """The series, with zeros up to a length that others share: that of the `longest` of a layer, where that is short.

    Flows whose series differ by a few terms then have one structure. Not so where `longest` is 0.
    """
    if len(series) <= _FEW or not longest:
        return series
    length = longest if longest <= _LENGTHS[-1] else len(series)
    rounded = np.zeros(next((most for most in _LENGTHS if length <= most), -(-length // _STEP) * _STEP), series.dtype)
    rounded[:len(series)] = series
    return rounded


def _places(series: np.ndarray) -> Any:
    """Where the terms of a series are that may not be 0: of a long one all, or all of one parity."""
    if len(series) <= _FEW:
        return series.nonzero()[0]
    even, odd = series[0] or series[::2].any(), series[1] or series[1::2].any()
    return slice(int(not even), len(series), 1 if even and odd else 2)


def _support(series: np.ndarray) -> "tuple[int, ...] | range":
    """The indices of these terms."""
    places = _places(series)
    return range(*places.indices(len(series))) if isinstance(places, slice) else tuple(places.tolist())


def _series(number: complex) -> np.ndarray:
    """A number as a series of one term; real if it is real."""
    return np.array([number if number.imag else number.real])


def _check_conditions(flow: Any, given: tuple[Any, ...]) -> None:
    """Conditions are different forms with finite coefficients; their numbers in messages count from 1."""
    if not isinstance(given, tuple | list):
        raise ParameterError(f"{flow.name}: conditions(edges, names) must return a tuple (got {shown(given)})")
    seen: list[dict[tuple[Any, ...], Any]] = []
    for number, form in enumerate(given, 1):
        if not isinstance(form, Form) or not any(form.terms.values()):
            raise ParameterError(f"{flow.name}: condition {number} has no unknown: it is to be a sum such as "
                                 f"edge.v + names.k * edge.w, that is 0 (got {shown(getattr(form, 'terms', form))})")
        for names, coefficient in form.terms.items():
            if not (isinstance(coefficient, int | float | complex) and isfinite(coefficient)) and (
                    np.shape(coefficient) or not np.isfinite(coefficient)):
                raise ParameterError(f"{flow.name}: condition {number}: the coefficient of {'*'.join(names)} must be a "
                                     f"finite number (got {shown(coefficient)})")
        terms = {names: value for names, value in form.terms.items() if value}
        for other, before in enumerate(seen, 1):
            if before.keys() == terms.keys() and _proportional(before, terms):
                raise ParameterError(f"{flow.name}: conditions {other} and {number} say the same")
        seen.append(terms)


def _proportional(one: dict[tuple[Any, ...], Any], other: dict[tuple[Any, ...], Any]) -> bool:
    ratios = [complex(other[names] / value) for names, value in one.items()]
    return all(abs(ratio - ratios[0]) <= _PROPORTIONAL * abs(ratios[0]) for ratio in ratios)


def _mirrored(flow: Any, layers: tuple[Any, ...], equations: tuple["Equation", ...]) -> tuple["Equation", ...]:
    """The equations of a layer that is its own mirror image, coefficients of the wrong parity (rounding) left out."""
    if len(layers) > 1 or layers[0].singular or any(equation.cuts for equation in equations):
        raise ParameterError(f"{flow.name}: reflection = {flow.reflection} is for a flow of one layer without a yield "
                             "surface, whose profile is smooth: use reflection = 0")
    return tuple(replace(equation, terms=tuple(
        (unknown, monomial, _of_parity(flow, series, ODD_WITH_W[index] * ODD_WITH_W[FIELDS.index(
            unknown.rstrip("'").rpartition(".")[2])] * (1 if unknown.endswith("'") else -1)))
        for unknown, monomial, series in equation.terms)) for index, equation in enumerate(equations))


def _of_parity(flow: Any, series: np.ndarray, parity: int) -> np.ndarray:
    """The series without its even coefficients, or its odd ones where the parity is 1; they must be rounding."""
    kept = series.copy()
    kept[int(parity > 0):: 2] = 0
    if np.abs(series - kept).max() > _SYMMETRIC * np.abs(series).max():
        raise ParameterError(f"{flow.name}: reflection = {flow.reflection}, but the layer is not its own mirror image: "
                             "use reflection = 0 or a profile that is even about the middle of the layer")
    return kept


def _check_count(flow: Any, layers: tuple[Any, ...], given: int) -> None:
    """Each layer needs one condition per equation, less one per singular edge; each surface one more.

    Of a layer that is its own mirror image only the conditions at the upper edge are given.
    """
    whole = 2 if flow.reflection else 4
    needed = sum(whole - layer.singular for layer in layers) + len(flow.surfaces)
    if given != needed:
        parts = [f"{whole - layer.singular} for {layer.name}" for layer in layers]
        parts += [f"1 for {surface}" for surface in flow.surfaces]
        raise ConditionCount(f"{flow.name}: expected {needed} conditions ({', '.join(parts)}), got {given}")
