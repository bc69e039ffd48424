"""From a system of equations to matrices: the pencil A(k) - rate B(k) at one degree.

A and B are sums of constant matrices times products of scalar symbols (k, and whatever else the flow
declares as a function of k). They are assembled once for a degree; values, k-derivatives and the
sensitivity to a symbol then cost a few products. Rows are T-coefficients of the residuals: 0 .. degree-1
of a first-order equation, one more where its leading coefficient vanishes at an edge, then the
conditions. The coefficients beyond (the tail) are what the truncated series fails to satisfy; they
measure the truncation error.

Coefficient j of a field stands opposite row j - 1 of its equation, the fields of a layer interleaved, so that
the matrices are banded. What has no row opposite (constants of integration, surfaces) and the conditions
form the border.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from ..numerics import chebyshev
from ..numerics.arithmetic import Arithmetic
from ..numerics.blocks import Blocks, placed
from ..numerics.kernel.compiled import Compiled, Packed
from ..numerics.kernel.library import library
from ..numerics.stack import Lines, Stack
from .combination import Combination
from .condensed import Arrangement, Condensed, condensable
from .layer import FIELDS

if TYPE_CHECKING:
    from .system import Structure, System
    from .table import Table

_CONDENSED = 16, 96  # degrees for which it pays to condense full blocks for one eigenvalue
_MANY = 300, 2e-3  # points times terms for which it pays to condense anything: at least, and by the cube of the terms
_ENDS = 4  # terms of a series, twice so many before them: they tell how fast it falls
_LAST = 4  # rows of an equation whose left vector bounds that of the tail: the last two alone feel the truncation


@dataclass(frozen=True)
class Weights:
    """Scalars that multiply the constant matrices: arrays (parts,) at one wavenumber, (parts, points) at several.

    `slope` is d value / dk; `spread` is the uncertainty of the value where a symbol has one.
    """

    value: np.ndarray
    slope: np.ndarray
    spread: np.ndarray


def weights_of(structure: "Structure", symbols: dict[str, tuple[Any, ...]]) -> "Weights":
    """Return the `Weights` of the parts for symbols {name: (value, slope, error)}, numbers other than 0 or arrays."""
    value, slope, spread = np.array([symbols[name] for name in structure.symbols]).swapaxes(0, 1)
    exponents = structure.powers
    product = np.prod(value ** exponents.reshape(*exponents.shape, *[1] * (value.ndim - 1)), axis=1)
    return Weights(product, product * (exponents @ (slope / value)),
                   np.abs(product) * (exponents @ np.abs(spread / value)))


class Layout:
    """Where unknowns and entries of the matrices of one degree lie, from a `table` of the structure that reaches it.

    Attributes: `size` rows and columns, of which `interior` are banded; `columns` and `rows` map unknowns and equations
    to index arrays of their coefficients, `orders` to the numbers of those; `last` (equations, 4) are the last rows of
    each equation, `ends` (3, fields, 4) the last columns of each field behind those before them; `tails` rows lie
    beyond. `stack`, `tail`, `b` and `places` tell where the entries of A - rate B, of the rows beyond, of B and of the
    bordered matrix lie; `inside`, `beyond` and `carrying`, which entries of the table those are; `carriers` (parts,),
    which parts are of B, and `sides` the first of A and the first of B.
    """

    def __init__(self, table: "Table", degree: int, structure: "Structure") -> None:
        self.table, self.structure, self.degree, self._common = table, structure, degree, {}
        columns, rows = self._maps = self._place(table)
        within = (table.column <= degree) & (table.row < rows.shape[1])
        places = rows[table.equation, np.where(within, table.row, 0)]
        kept = np.flatnonzero(within & (places >= 0) & (columns[table.unknown, np.where(within, table.column, 0)] >= 0))
        part, row, column = (table.part[kept], rows[table.equation[kept], table.row[kept]],
                             columns[table.unknown[kept], table.column[kept]])
        here, count = row < self.size, len(self.structure.parts)
        carries = here & (part >= self.structure.first_b)
        self.inside, self.beyond, self.carrying = (kept[some].astype(np.int32) for some in (here, ~here, carries))
        self.stack = Lines(part[here], row[here], column[here], count, (self.size, self.size))
        self.places = placed(part[here], row[here], column[here], count, self.interior, self.size - self.interior)
        self.tail = Lines(part[~here], row[~here] - self.size, column[~here], count,
                          (self.tails, self.size))
        self.b = Lines(part[carries], row[carries], column[carries], count, (self.size, self.size))
        self.rate_rows = np.unique(row[carries])
        self.carriers, self.sides = np.arange(count) >= self.structure.first_b, np.array((0, self.structure.first_b))

    def entries(self) -> tuple[np.ndarray, ...]:
        """Part, row and column of the entries `inside`."""
        table, (columns, rows) = self.table, self._maps
        return (table.part[self.inside], rows[table.equation[self.inside], table.row[self.inside]],
                columns[table.unknown[self.inside], table.column[self.inside]])

    @cached_property
    def arrangement(self) -> Arrangement | None:
        """How its pencils are condensed; None where they are not."""
        return Arrangement(self) if condensable(self) else None

    def common(self, other: "Layout") -> tuple[tuple[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]:
        """Which columns, and which rows, it has in common with another degree: for each, where here and where there."""
        if other.degree not in self._common:
            self._common[other.degree] = tuple(_common(*pair) for pair in
                                               ((self.columns, other.columns), (self.rows, other.rows)))
        return self._common[other.degree]

    def _place(self, table: "Table") -> tuple[np.ndarray, ...]:
        """Number unknowns and rows: interior interleaved layer by layer, then the border, then the tails.

        Returns the places of columns (unknowns, degree + 1) and of rows (equations and conditions, ...).
        """
        structure, width = self.structure, self.degree + 1
        equations, conditions = structure.rows[:structure.equations], len(structure.rows) - structure.equations
        extra = np.array([equation.extra for equation in equations])
        used = np.zeros((len(structure.unknowns), width), bool)
        self.degrees = np.repeat(structure.degrees(self.degree), len(FIELDS)).tolist()
        for unknown, (first, degree) in enumerate(zip(structure.first, self.degrees, strict=True)):
            used[unknown, first: degree + 1: structure.stride] = True
        used[structure.fields:, 0] = True
        field, j = np.nonzero(used[: structure.fields])
        opposite = j >= 1 - extra[field]
        field, j = field[opposite], j[opposite]
        order = np.lexsort((field % len(FIELDS), j, field // len(FIELDS)))
        field, j, self.interior = field[order], j[order], len(order)
        columns = np.full(used.shape, -1)
        columns[field, j] = np.arange(self.interior)
        free = used & (columns < 0)
        self.size = self.interior + int(free.sum())
        columns[free] = np.arange(self.interior, self.size)
        rows = np.full((len(extra) + conditions, width + int(extra.max()) + table.tail), -1)
        rows[field, j - 1 + extra[field]] = np.arange(self.interior)
        rows[len(extra):, 0] = np.arange(self.interior, self.interior + conditions)
        self.orders = {name: np.flatnonzero(mask) for name, mask in zip(structure.unknowns, used, strict=True)}
        self.columns = {name: places[self.orders[name]] for name, places in
                        zip(structure.unknowns, columns, strict=True)}
        ends = [self.columns[name] for name in structure.unknowns[:structure.fields]]
        few = min(_ENDS, *(len(places) // 3 for places in ends))
        self.ends = np.array([places[-3 * few:].reshape(3, few) for places in ends]).swapaxes(0, 1)
        self._name_rows(equations, rows)
        return columns, rows

    def _name_rows(self, equations: tuple[Any, ...], rows: np.ndarray) -> None:
        """Tell apart the rows of each equation, and number those beyond the degree."""
        structure, tails = self.structure, np.arange(-(-self.table.tail // self.structure.stride))
        self.rows, self.tails = {"conditions": rows[len(equations):, 0]}, len(tails) * len(equations)
        for i, (equation, first, degree) in enumerate(zip(equations, structure.first, self.degrees, strict=True)):
            orders = np.arange(structure.stride - 1 - first, degree + equation.extra, structure.stride)
            self.orders[equation.name], self.rows[equation.name] = orders, rows[i, orders]
            rows[i, orders[-1] + structure.stride * (1 + tails)] = self.size + i * len(tails) + tails
        self.last = np.array([self.rows[equation.name][-_LAST:] for equation in equations])


def _common(one: dict[str, np.ndarray], other: dict[str, np.ndarray]) -> tuple[np.ndarray, ...]:
    """Places here and there of what two maps from names to index arrays have in common."""
    counts = {name: min(len(places), len(other[name])) for name, places in one.items()}
    return tuple(np.concatenate([side[name][:count] for name, count in counts.items()]) for side in (one, other))


class Pencil(Combination):
    """Constant matrices of A(k) - rate B(k): entries that lie where `layout` says, with values (entries of its table,).

    The residual of the equations is (A - rate B) x. Attributes of the layout are those of the pencil; `stack` and
    `tail` are its rows and the rows beyond; `cuts` tell what was left out of the coefficients of `system`, none where
    that is rounding; `real` tells whether all matrices are real.
    """

    def __init__(self, layout: "Layout", values: np.ndarray, system: "System") -> None:
        self.layout, self._values = layout, values
        self.degree, self.parts, self.first_b = layout.degree, layout.structure.parts, layout.structure.first_b
        self.size, self.columns, self.rows, self.last = layout.size, layout.columns, layout.rows, layout.last
        self.rate_rows = layout.rate_rows
        self.real = np.isrealobj(values)
        self.cuts = [(self.parts.index(monomial), unknown, self.rows[equation.name], bound)
                     for equation in system.equations for unknown, monomial, bound in equation.cuts]

    def weights(self, symbols: dict[str, tuple[Any, ...]]) -> "Weights":
        """Return the `Weights` for symbols {name: (value, slope, error)}, non-zero numbers or arrays (points,)."""
        return weights_of(self.layout.structure, symbols)

    def field(self, x: np.ndarray, unknown: str) -> np.ndarray:
        """All coefficients of a field in right vectors (size, ...), (degree + 1, ...)."""
        return self._filled(x[self.columns[unknown]], unknown, self.degree + 1)

    def adjoint(self, y: np.ndarray, equation: str) -> np.ndarray:
        """All coefficients of what multiplies the residuals of an equation in left vectors (size, ...), (rows, ...)."""
        return self._filled(y[self.rows[equation]], equation, self.layout.orders[equation][-1] + 1)

    def _filled(self, coefficients: np.ndarray, name: str, count: int) -> np.ndarray:
        if len(coefficients) == count:
            return coefficients
        full = np.zeros((count, *coefficients.shape[1:]), coefficients.dtype)
        full[self.layout.orders[name]] = coefficients
        return full

    def cut(self, weights: Any, y: Any, x: Any) -> Any:
        """Bound on what series left out change y^T (A - rate B) x, (points,); `weights` (parts, points) of the parts.

        The T-coefficients of a residual are integrals over the angle: y^T times those of g is the mean of Y g with
        Y = y_0 + 2 (y_1 T_1 + y_2 T_2 + ...). With a coefficient of the unknown f wrong by delta at most, it is wrong
        by delta times the mean of |Y f|.
        """
        total = np.zeros(x.shape[1:])
        for part, unknown, rows, bound in self.cuts:
            series = chebyshev.basis(self.degree)[int(unknown.endswith("'"))] @ self.field(x, unknown.rstrip("'"))
            adjoint = 2 * y[rows]
            adjoint[0] /= 2
            total += bound * np.abs(weights[part]) * np.mean(self._sizes(adjoint) * self._sizes(series), axis=-1)
        return total

    def _sizes(self, series: Any) -> Any:
        """Moduli of T-series (terms, points) at Chebyshev points (last axis), twice as many as there are terms."""
        padded = np.zeros((*series.shape[1:], 2 * self.degree + 2), series.dtype)
        padded[..., :len(series)] = series.T
        return np.abs(chebyshev.values(padded))

    @property
    def arithmetic(self) -> Arithmetic:
        """By compiled code where there is any."""
        kernel = library()  # nothing is kept: a pencil that refers to itself would outlive its use
        return Compiled(self, kernel) if kernel else Arithmetic(self)

    @cached_property
    def packed(self) -> Packed:
        return Packed(self.stack, self.layout.places, len(self.parts), self.first_b)

    @cached_property
    def packed_tail(self) -> Packed:
        return Packed(self.tail, self.layout.places, len(self.parts), self.first_b)

    @cached_property
    def tail(self) -> Stack:
        return Stack(self.layout.tail, self._values[self.layout.beyond])

    @cached_property
    def condensed(self) -> Condensed | None:
        """The same eigenproblem with half the unknowns, where that pays even for a single eigenvalue."""
        full = isinstance(self.layout.places, Blocks) and _CONDENSED[0] <= self.degree <= _CONDENSED[1]
        return self.shortened if full else None

    @cached_property
    def shortened(self) -> Condensed | None:
        """The same eigenproblem with half the unknowns, whether that pays or not; None where there is none."""
        arrangement = self.layout.arrangement
        return Condensed(arrangement, self._value) if arrangement else None

    def condensed_for(self, points: int) -> Condensed | None:
        """The `condensed` form where it pays for factors at so many points."""
        terms = self.degree // self.layout.structure.stride
        worthwhile = "shortened" in vars(self) or points * terms > _MANY[0] + _MANY[1] * terms**3
        return self.shortened if worthwhile else self.condensed

    def iterated(self, points: int) -> Condensed | None:
        """The `condensed` form where it pays for eigenvalues at so many points: compiled code gains nothing from it."""
        return self.condensed if library() else self.condensed_for(points)

    @property
    def _where(self) -> Layout:  # type: ignore[override]
        return self.layout

    @property
    def _value(self) -> np.ndarray:  # type: ignore[override]
        return self._values[self.layout.inside]

    @property
    def _carried(self) -> np.ndarray:  # type: ignore[override]
        return self._values[self.layout.carrying]

    def pair(self, weights: Any) -> Any:
        """Return A and B in full, each (size, size)."""
        carries = self.layout.carriers
        return self.stack.full(weights.value * ~carries), -self.stack.full(weights.value * carries)
