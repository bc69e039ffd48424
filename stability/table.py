"""All matrix entries of a system up to a degree: those of a smaller system are among them.

The equations are written in Chebyshev coefficients, in which neither an entry nor its place depends on the degree:
one table serves every degree below its own.
"""

import numpy as np

from . import chebyshev

_TAIL = 8  # least number of coefficients kept beyond the truncation, per equation


class Table:
    """Entries of the equations and conditions of `system`, as arrays (entries,).

    Entry `value` multiplies column `column` of the unknown number `unknown` (fields first, then surfaces) in row `row`
    of the equation number `equation` (conditions after the equations) and belongs to `part`: an index into the
    monomials `parts`, of which those from `first_b` on carry the rate. Every equation has `tail` rows beyond a degree:
    as many as its coefficients have terms, or products with the last unknowns would go unseen.
    """

    def __init__(self, system, degree):
        self.system, self.degree, self.tail = system, degree, max(_TAIL, system.longest)
        self.unknowns = (*system.fields, *system.surfaces)
        rows = [terms for _, terms in self._rows()]
        self.parts = tuple(sorted({term[1] for terms in rows for term in terms}, key=lambda m: ("rate" in m, m)))
        self.first_b = sum("rate" not in part for part in self.parts)
        blocks = self._equation_entries(), self._condition_entries()
        self.part, self.equation, self.row, self.unknown, self.column, self.value = (
            np.concatenate(arrays) for arrays in zip(*blocks, strict=True))

    def _rows(self):
        """Index and terms of every equation, then of every condition."""
        return enumerate([*(equation.terms for equation in self.system.equations), *self.system.conditions])

    def _equation_entries(self):
        terms = [(index, *term) for index, equation in enumerate(self.system.equations) for term in equation.terms]
        most = self.degree + self.tail + max(equation.extra for equation in self.system.equations)
        term, row, column, value = chebyshev.entries(
            [series for *_, series in terms], [unknown.endswith("'") for _, unknown, *_ in terms], most, self.degree)
        part, equation, unknown = np.array([(self.parts.index(monomial), index, self._number(name))
                                            for index, name, monomial, _ in terms]).T
        return part[term], equation[term], row, unknown[term], column, value

    def _condition_entries(self):
        ends = chebyshev.at(np.array([0.0, 1.0]), self.degree)
        blocks = []
        for index, terms in enumerate(self.system.conditions, len(self.system.equations)):
            for unknown, monomial, series in terms:
                name, _, end = unknown.partition("@")
                values = series[0] * (ends[int(end)] if end else np.ones(1))
                columns = np.arange(len(values))
                blocks.append(np.broadcast_arrays(self.parts.index(monomial), index, 0, self._number(name), columns,
                                                  values))
        return tuple(np.concatenate(arrays) for arrays in zip(*blocks, strict=True))

    def _number(self, unknown):
        return self.unknowns.index(unknown.rstrip("'"))
