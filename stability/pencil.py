"""From a system of equations to matrices: the pencil A(k) - rate B(k) at one degree.

A and B are sums of constant matrices times products of scalar symbols (k, and whatever else the flow
declares as a function of k). They are assembled once for a degree; values, k-derivatives and the
sensitivity to a symbol then cost a few products. Rows are T-coefficients of the residuals: 0 .. degree-1
of a first-order equation, one more where its leading coefficient vanishes at an edge, then the
conditions. The coefficients beyond (the tail) are what the truncated series fails to satisfy; they
measure the truncation error.
"""

from dataclasses import dataclass
from math import prod

import numpy as np

from . import chebyshev

_TAIL = 8  # coefficients kept beyond the truncation, per equation


@dataclass(frozen=True)
class Weights:
    """Scalars that multiply the constant matrices at one wavenumber: each array has shape (parts,).

    `slope` is d value / dk; `spread` is the uncertainty of the value where a symbol has one.
    """

    value: np.ndarray
    slope: np.ndarray
    spread: np.ndarray


class Pencil:
    """Constant matrices of A(k) - rate B(k) for one system and degree, and where its unknowns lie.

    The residual of the equations is (A - rate B) x. Attributes: `stack` (parts, size, size), `tail`
    (parts, tail rows, size), `squares` = |stack|^2; the parts from `first_b` on carry the rate and belong
    to -B. `columns` and `rows` map unknowns and equations to slices; `last` (equations, 2) are the last
    two rows of each equation; `real` tells whether all matrices are real.
    """

    def __init__(self, system, degree):
        self.degree = degree
        lengths = dict.fromkeys(system.fields, degree + 1) | dict.fromkeys(system.surfaces, 1)
        self.columns = _slices(lengths)
        self.rows = _slices({equation.name: degree + equation.extra for equation in system.equations}
                            | {"conditions": len(system.conditions)})
        self.size = sum(lengths.values())
        equations = [self.rows[equation.name] for equation in system.equations]
        self.last = np.array([[rows.stop - 2, rows.stop - 1] for rows in equations])
        blocks = [*self._equation_blocks(system), *self._condition_blocks(system)]
        self.parts = tuple(sorted({block[0] for block in blocks}, key=lambda part: ("rate" in part, part)))
        self.first_b = sum("rate" not in part for part in self.parts)
        full = self._fill(blocks)
        self.stack = np.ascontiguousarray(full[:, : self.size])
        self.tail = np.ascontiguousarray(full[:, self.size:])
        self.squares = np.abs(self.stack) ** 2
        self.real = np.isrealobj(self.stack)
        self._factors = tuple(tuple(name for name in part if name != "rate") for part in self.parts)

    def _equation_blocks(self, system):
        """Yield (monomial, rows, columns, matrix) of every term, main rows and tail rows."""
        values, slopes = chebyshev.basis(self.degree)
        for index, equation in enumerate(system.equations):
            rows = self.rows[equation.name]
            count = rows.stop - rows.start
            tail = slice(self.size + index * _TAIL, self.size + (index + 1) * _TAIL)
            for unknown, monomial, series in equation.terms:
                left = chebyshev.product(series, count + _TAIL, self.degree + 1)
                matrix = left @ (slopes if unknown.endswith("'") else values)
                columns = self.columns[unknown.rstrip("'")]
                yield monomial, rows, columns, matrix[:count]
                yield monomial, tail, columns, matrix[count:]

    def _condition_blocks(self, system):
        ends = chebyshev.at(np.array([0.0, 1.0]), self.degree)
        for row, terms in enumerate(system.conditions, self.rows["conditions"].start):
            for unknown, monomial, series in terms:
                name, _, end = unknown.partition("@")
                yield monomial, row, self.columns[name], series[0] * (ends[int(end)] if end else np.ones(1))

    def _fill(self, blocks):
        height = self.size + len(self.last) * _TAIL
        dtype = np.result_type(*(block[3] for block in blocks))
        full = np.zeros((len(self.parts), height, self.size), dtype)
        for monomial, rows, columns, matrix in blocks:
            full[self.parts.index(monomial), rows, columns] += matrix
        return full

    def weights(self, symbols):
        """Return the `Weights` for symbols {name: (value, slope, error)} at one wavenumber."""
        value, slope, spread = [], [], []
        for names in self._factors:
            factors = [symbols[name] for name in names]
            others = [prod(g[0] for g in factors[:i] + factors[i + 1:]) for i in range(len(factors))]
            value.append(prod(f[0] for f in factors))
            slope.append(sum(o * f[1] for o, f in zip(others, factors, strict=True)))
            spread.append(sum(abs(o) * f[2] for o, f in zip(others, factors, strict=True)))
        return Weights(np.array(value), np.array(slope), np.array(spread))

    def apply(self, stack, x):
        """Return every part of `stack` (parts, rows, size) times x: shape (parts, rows)."""
        return (stack.reshape(-1, self.size) @ x).reshape(len(self.parts), -1)

    def pair(self, weights):
        """Return the dense matrices A and B, each (size, size)."""
        flat, first = self.stack.reshape(len(self.parts), -1), self.first_b
        a, b = weights.value[:first] @ flat[:first], weights.value[first:] @ flat[first:]
        return a.reshape(self.size, -1), -b.reshape(self.size, -1)


def _slices(lengths):
    slices, start = {}, 0
    for name, length in lengths.items():
        slices[name] = slice(start, start + length)
        start += length
    return slices
