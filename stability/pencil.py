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

import numpy as np

from . import chebyshev
from .bordered import Bordered, Entries
from .layer import FIELDS

_TAIL = 8  # coefficients kept beyond the truncation, per equation


@dataclass(frozen=True)
class Weights:
    """Scalars that multiply the constant matrices: arrays (parts,), or (points, parts) at several wavenumbers.

    `slope` is d value / dk; `spread` is the uncertainty of the value where a symbol has one.
    """

    value: np.ndarray
    slope: np.ndarray
    spread: np.ndarray


class Pencil:
    """Constant matrices of A(k) - rate B(k) for one system and degree, and where its unknowns lie.

    The residual of the equations is (A - rate B) x. Attributes: `matrices`, a stack of `parts`; those from
    `first_b` on carry the rate and belong to -B; `squares`, their squared moduli; `columns` and `rows` map
    unknowns and equations to index arrays; `last` (equations, 2) are the last two rows of each equation;
    `real` tells whether all matrices are real.
    """

    def __init__(self, system, degree):
        self.degree = degree
        self._place(system)
        blocks = [*self._equation_blocks(system), *self._condition_blocks(system)]
        self.parts = tuple(sorted({block[0] for block in blocks}, key=lambda part: ("rate" in part, part)))
        self.first_b = sum("rate" not in part for part in self.parts)
        self._symbols = tuple(sorted({name for part in self.parts for name in part} - {"rate"}))
        self._powers = np.array([[part.count(name) for name in self._symbols] for part in self.parts])
        entries = [(self.parts.index(monomial), *entry) for monomial, *entry in blocks]
        self._split_tail(entries, len(system.equations))
        main = [(part, *_where(rows < self.size, rows, columns, values)) for part, rows, columns, values in entries]
        self.matrices = Bordered.from_entries(len(self.parts), self.interior, self.size - self.interior, main)
        self.squares = self.matrices.squared()
        self._b = Entries([entry for entry in main if entry[0] >= self.first_b], self.size)
        self.real = np.isrealobj(self.matrices.flat)

    def _place(self, system):
        """Number unknowns and rows: interior interleaved layer by layer, then the border."""
        keys, width = [], self.degree + 1
        for index, (field, equation) in enumerate(zip(system.fields, system.equations, strict=True)):
            layer, place = divmod(index, len(FIELDS))
            keys += [(layer, j, place, field, j + equation.extra - 1, equation.name)
                     for j in range(1 - equation.extra, width)]
        self.interior = len(keys)
        self.columns = {field: np.full(width, -1) for field in system.fields}
        self.rows = {equation.name: np.full(self.degree + equation.extra, -1) for equation in system.equations}
        for position, (_, j, _, field, row, equation) in enumerate(sorted(keys)):
            self.columns[field][j] = position
            self.rows[equation][row] = position
        self.size = self.interior
        for name in (*system.fields, *system.surfaces):
            free = self.columns.setdefault(name, np.full(1, -1)) < 0
            self.columns[name][free] = self.size
            self.size += int(free.sum())
        self.rows["conditions"] = np.arange(self.interior, self.interior + len(system.conditions))
        self.last = np.array([self.rows[equation.name][-2:] for equation in system.equations])

    def _equation_blocks(self, system):
        """Yield (monomial, rows, columns, values) of every term; the tail of an equation follows the main rows."""
        for index, equation in enumerate(system.equations):
            tail = self.size + index * _TAIL + np.arange(_TAIL)
            places = np.concatenate((self.rows[equation.name], tail))
            for unknown, monomial, series in equation.terms:
                rows, columns, values = chebyshev.entries(series, len(places), self.degree, unknown.endswith("'"))
                yield monomial, places[rows], self.columns[unknown.rstrip("'")][columns], values

    def _condition_blocks(self, system):
        ends = chebyshev.at(np.array([0.0, 1.0]), self.degree)
        for row, terms in zip(self.rows["conditions"], system.conditions, strict=True):
            for unknown, monomial, series in terms:
                name, _, end = unknown.partition("@")
                columns = self.columns[name]
                values = series[0] * (ends[int(end)] if end else np.ones(1))
                yield monomial, np.full(len(columns), row), columns, values

    def _split_tail(self, entries, equations):
        """Keep the tail rows: `tail` (parts, tail rows, columns) on the few `tail_columns` that reach them."""
        tails = [(part, *_where(rows >= self.size, rows - self.size, columns, values))
                 for part, rows, columns, values in entries]
        self.tail_columns = np.unique(np.concatenate([columns for _, _, columns, _ in tails]))
        shape = (len(self.parts), equations * _TAIL, len(self.tail_columns))
        self.tail = np.zeros(shape, np.result_type(*(values for *_, values in entries)))
        for part, rows, columns, values in tails:
            np.add.at(self.tail[part], (rows, np.searchsorted(self.tail_columns, columns)), values)

    def weights(self, symbols):
        """Return the `Weights` for symbols {name: (value, slope, error)}, non-zero numbers or arrays (points,)."""
        table = np.array([symbols[name] for name in self._symbols])  # (symbols, 3) or (symbols, 3, points)
        value, slope, spread = (table[:, i].T for i in range(3))
        product = np.prod(value[..., None, :] ** self._powers, axis=-1)
        return Weights(product, product * (slope / value @ self._powers.T),
                       np.abs(product) * (np.abs(spread / value) @ self._powers.T))

    def shifted(self, weights, rate):
        """Return A - rate B as a bordered band matrix."""
        return self.matrices.combine(weights.value * self.powers(rate))

    def b(self, weights):
        """Return B as a sparse matrix with products from either side."""
        return self._b.combine(-weights.value)

    def beyond(self, weights, x):
        """Return the residuals of x (points, size) in the tail rows, for weights (points, parts) of the parts."""
        parts = self.tail @ x[:, self.tail_columns].T  # (parts, tail rows, points)
        return (weights.T[:, None] * parts).sum(axis=0).T

    def powers(self, rate):
        """Factor of every part in the residual: 1 in A, the rate in B; shape of rate, then (parts,)."""
        return np.where(np.arange(len(self.parts)) < self.first_b, 1.0, np.asarray(rate)[..., None])

    def pair(self, weights):
        """Return A and B in full, each (size, size)."""
        return self.shifted(weights, 0.0).dense(), self.b(weights).dense()


def _where(mask, *arrays):
    return tuple(array[mask] for array in arrays)
