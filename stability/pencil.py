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

import numpy as np

from . import chebyshev
from .bordered import Bordered, Factors
from .layer import FIELDS
from .stack import Stack

_LAST = 4  # rows of an equation whose left vector bounds that of the tail: the last two alone feel the truncation


@dataclass(frozen=True)
class Weights:
    """Scalars that multiply the constant matrices: arrays (parts,) at one wavenumber, (parts, points) at several.

    `slope` is d value / dk; `spread` is the uncertainty of the value where a symbol has one.
    """

    value: np.ndarray
    slope: np.ndarray
    spread: np.ndarray


class Pencil:
    """Constant matrices of A(k) - rate B(k) for one degree, from a `table` that reaches it, and where unknowns lie.

    The residual of the equations is (A - rate B) x. Attributes: `parts`, monomials; those from `first_b` on carry
    the rate and belong to -B; `stack` and `tail`, their `size` rows and the rows beyond; `columns` and `rows` map
    unknowns and equations to index arrays; `last` (equations, 4) are the last rows of each equation; `cuts` tell what
    was left out of coefficients, none where that is rounding; `real` tells whether all matrices are real.
    """

    def __init__(self, table, degree):
        self.degree, self.parts, self.first_b, self._tail = degree, table.parts, table.first_b, table.tail
        self._symbols = tuple(sorted({name for part in self.parts for name in part} - {"rate"}))
        self._powers = np.array([[part.count(name) for name in self._symbols] for part in self.parts])
        columns, rows = self._place(table)
        reach = np.array([degree + equation.extra + table.tail for equation in table.system.equations]
                         + [1] * len(table.system.conditions))
        kept = (table.column <= degree) & (table.row < reach[table.equation])
        entries = (table.part[kept], rows[table.equation[kept], table.row[kept]],
                   columns[table.unknown[kept], table.column[kept]], table.value[kept])
        self._entries, self._beyond = (tuple(array[side] for array in entries) for side in
                                       (entries[1] < self.size, entries[1] >= self.size))
        self.stack = Stack(*self._entries, len(self.parts), (self.size, self.size))
        self.real = np.isrealobj(table.value)
        self.cuts = [(self.parts.index(monomial), unknown, self.rows[equation.name], bound)
                     for equation in table.system.equations for unknown, monomial, bound in equation.cuts]

    def _place(self, table):
        """Number unknowns and rows: interior interleaved layer by layer, then the border, then the tails.

        Returns the places of columns (unknowns, degree + 1) and of rows (equations and conditions, ...).
        """
        system, width = table.system, self.degree + 1
        extra = np.array([equation.extra for equation in system.equations])
        field, j = (index.ravel() for index in np.indices((len(system.fields), width)))
        opposite = j >= 1 - extra[field]
        field, j = field[opposite], j[opposite]
        order = np.lexsort((field % len(FIELDS), j, field // len(FIELDS)))
        field, j, self.interior = field[order], j[order], len(order)
        columns = np.full((len(table.unknowns), width), -1)
        columns[field, j] = np.arange(self.interior)
        used = np.arange(width) < np.where(np.arange(len(columns)) < len(system.fields), width, 1)[:, None]
        free = used & (columns < 0)
        self.size = self.interior + int(free.sum())
        columns[free] = np.arange(self.interior, self.size)
        rows = np.full((len(extra) + len(system.conditions), width + int(extra.max()) + table.tail), -1)
        rows[field, j - 1 + extra[field]] = np.arange(self.interior)
        rows[len(extra):, 0] = np.arange(self.interior, self.interior + len(system.conditions))
        self.columns = {name: places[mask] for name, places, mask in zip(table.unknowns, columns, used, strict=True)}
        self.rows = {equation.name: rows[i, : self.degree + equation.extra]
                     for i, equation in enumerate(system.equations)}
        self.rows["conditions"] = rows[len(extra):, 0]
        self.last = np.array([self.rows[equation.name][-_LAST:] for equation in system.equations])
        for i, count in enumerate(self.degree + extra):
            rows[i, count: count + table.tail] = self.size + i * table.tail + np.arange(table.tail)
        return columns, rows

    def weights(self, symbols):
        """Return the `Weights` for symbols {name: (value, slope, error)}, non-zero numbers or arrays (points,)."""
        value, slope, spread = np.array([symbols[name] for name in self._symbols]).swapaxes(0, 1)
        powers = self._powers.reshape(*self._powers.shape, *[1] * (value.ndim - 1))
        product = np.prod(value ** powers, axis=1)
        return Weights(product, product * (self._powers @ (slope / value)),
                       np.abs(product) * (self._powers @ np.abs(spread / value)))

    def powers(self, rate):
        """Factor of every part in the residual: 1 in A, the rate in B; (parts,) then the shape of rate."""
        powers = np.ones((len(self.parts), *np.shape(rate)), np.result_type(rate, float))
        powers[self.first_b:] = rate
        return powers

    def cut(self, weights, y, x):
        """Bound on what series left out change y^T (A - rate B) x, (points,); `weights` (parts, points) of the parts.

        The T-coefficients of a residual are integrals over the angle: y^T times those of g is the mean of Y g with
        Y = y_0 + 2 (y_1 T_1 + y_2 T_2 + ...). With a coefficient of the unknown f wrong by delta at most, it is wrong
        by delta times the mean of |Y f|.
        """
        total = np.zeros(x.shape[1:])
        for part, unknown, rows, bound in self.cuts:
            series = chebyshev.basis(self.degree)[int(unknown.endswith("'"))] @ x[self.columns[unknown.rstrip("'")]]
            adjoint = 2 * y[rows]
            adjoint[0] /= 2
            total += bound * np.abs(weights[part]) * np.mean(self._sizes(adjoint) * self._sizes(series), axis=-1)
        return total

    def _sizes(self, series):
        """Moduli of T-series (terms, points) at Chebyshev points (last axis), twice as many as there are terms."""
        padded = np.zeros((*series.shape[1:], 2 * self.degree + 2), series.dtype)
        padded[..., :len(series)] = series.T
        return np.abs(chebyshev.values(padded))

    @cached_property
    def tail(self):
        part, row, column, value = self._beyond
        return Stack(part, row - self.size, column, value, len(self.parts), (self._tail * len(self.last), self.size))

    @cached_property
    def _b(self):
        carries = self._entries[0] >= self.first_b
        part, row, column, value = (array[carries] for array in self._entries)
        return Stack(part, row, column, -value, len(self.parts), (self.size, self.size))

    def b(self, weights, x):
        """Return B x, (size, points) or (size,), for weights (parts, points) or (parts,) of the parts."""
        return self._b.total(self._b.spread(weights), self._b.times(x))

    def b_left(self, weights, y):
        """Return y^T B, (size, points) or (size,)."""
        return self._b.total_left(self._b.spread(weights), y)

    @cached_property
    def rate_rows(self):
        """The rows of B that are not empty."""
        part, row, *_ = self._entries
        return np.unique(row[part >= self.first_b])

    def factors(self, weights, rate):
        """Return LU factors of A - rate B for weights (parts,) of the parts."""
        return Factors(self._bordered, weights * self.powers(rate))

    @cached_property
    def _bordered(self):
        return Bordered(*self._entries, len(self.parts), self.interior, self.size - self.interior)

    def pair(self, weights):
        """Return A and B in full, each (size, size)."""
        part, row, column, value = self._entries
        value = value * weights.value[part]
        full = np.zeros((2, self.size, self.size), value.dtype)
        carries = part >= self.first_b
        np.add.at(full, (carries.astype(int), row, column), np.where(carries, -value, value))
        return full[0], full[1]
