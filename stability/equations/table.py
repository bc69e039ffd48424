"""Where the matrices of a system have entries, up to a degree: those of a smaller system are among them.

The equations are written in Chebyshev coefficients, in which neither an entry nor its place depends on the degree:
one table serves every degree below its own. Entries are linear in the coefficients of the equations: it serves every
flow with the same structure, too.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.sparse import csr_array

from ..numerics import chebyshev

if TYPE_CHECKING:
    from .system import Structure

_TAIL = 8  # least number of coefficients kept beyond the truncation, per equation


class Table:
    """Entries of the equations and conditions of a system of this `structure`, as arrays (entries,).

    An entry multiplies column `column` of the unknown number `unknown` (fields first, then surfaces) in row `row`
    of the equation number `equation` (conditions after the equations) and belongs to `part`: an index into the parts
    of the structure. Every equation has `tail` rows beyond a degree: as many as its coefficients have terms, or
    products with the last unknowns would go unseen.
    """

    def __init__(self, structure: "Structure", degree: int) -> None:
        self.structure, self.degree, self.tail = structure, degree, max(_TAIL, structure.longest)
        blocks, start = [], 0
        for number, row in enumerate(structure.rows):
            places = self._equation if number < structure.equations else self._condition
            for unknown, monomial, support in row.terms:
                name, *entries, index, weight = places(unknown, support)
                blocks.append((*np.broadcast_arrays(structure.parts.index(monomial), number,
                                                    structure.unknowns.index(name), *entries), start + index, weight))
                start += len(support)
        *where, index, weight = (np.concatenate(arrays, axis=-1) for arrays in zip(*blocks, strict=True))
        self.part, self.equation, self.unknown, self.row, self.column = (one.astype(np.int32) for one in where)
        entry = np.broadcast_to(np.arange(len(self.part)), index.shape)
        used = weight != 0
        self._map = csr_array((weight[used], (entry[used], index[used])), (len(self.part), start))

    def _equation(self, unknown: str, support: Sequence[int]) -> tuple[Any, ...]:
        """Name, row, column, and which coefficients add with which weight to the entries of a term."""
        most = self.degree + self.tail + max(row.extra for row in self.structure.rows)
        row, column, index, weight = chebyshev.cells(support, unknown.endswith("'"), most, self.degree)
        place = np.zeros(support[-1] + 1, int)
        place[list(support)] = np.arange(len(support))
        return unknown.rstrip("'"), row, column, place[index], weight

    def _condition(self, unknown: str, support: tuple[int]) -> tuple[Any, ...]:
        name, _, end = unknown.partition("@")
        value = chebyshev.at(float(end), self.degree)[0] if end else np.ones(1)
        few = np.zeros((chebyshev.FEW, len(value)))
        few[0] = value
        return name, np.zeros(len(value), int), np.arange(len(value)), np.zeros(few.shape, int), few

    def values(self, coefficients: Any) -> Any:
        """The entries of a system with these coefficients (those of `System.coefficients`), (entries,)."""
        return self._map @ coefficients
