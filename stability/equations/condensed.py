"""A pencil without the unknowns that two equations of each layer give outright: half of them, and an eighth of the LU.

Continuity and momentum across are solved for the slopes of w and n, and contain nothing else of them but w in the
latter: coefficient j of either, times 2, is what row j - 1 of its equation says. With these unknowns E, the others R
(v, t and the border) and

    A - rate B  =  [ P  F ]  rows of E,    P = 2 + N,  N taking w to the rows of n,
                   [ G  H ]  rows of R,

the eigenvalues are those of S = H - G P^{-1} F: P^{-1} = 1/2 - N/4 is a polynomial in the symbols and in the rate. N
has the rate, but what it multiplies, continuity, has none, nor has G: S is linear in it as well, a smaller pencil, with
products of the parts as its parts. Vectors of S are continued to E by P x_E = -F x_R and y_E P = -y_R G.

Where the blocks of layers are full this takes much less work. Bands stay bands, since integrals and products with short
series are; what it takes to form S then pays at many wavenumbers.
"""

from collections.abc import Iterator
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.sparse import csr_array

from ..numerics.arithmetic import Arithmetic
from ..numerics.blocks import whole
from ..numerics.stack import Lines, Stack
from .combination import Combination
from .layer import FIELDS

if TYPE_CHECKING:
    from .pencil import Layout

_GIVEN = tuple(FIELDS.index(name) for name in ("w", "n"))  # in this order: the equation of the second has the first
_PIVOT = 2.0  # d phi_j / ds = 2 T_{j-1}

Key = tuple[int, int, tuple[int, ...]]  # a group of rows, one of columns, and the parts whose product is the weight


def condensable(layout: "Layout") -> bool:
    """Whether the equations of a layout give w and n outright, and S is linear in the rate."""
    structure = layout.structure
    given = {name: number for number, name in enumerate(structure.unknowns[:structure.fields])
             if number % len(FIELDS) in _GIVEN}
    own = {number: name for name, number in given.items()}
    return all(_outright(own[number], row.terms) if number in own else
               not any("rate" in monomial and unknown.partition("@")[0] in given for unknown, monomial, _ in row.terms)
               for number, row in enumerate(structure.rows))


def _outright(field: str, terms: Any) -> bool:
    """Whether an equation gives a field: its slope stands alone, as residuals have it, and the field nowhere else."""
    slopes = [(unknown, monomial, tuple(support)) for unknown, monomial, support in terms if unknown.endswith("'")]
    return slopes == [(f"{field}'", (), (0,))] and field not in (unknown for unknown, *_ in terms)


def sparing(layout: "Layout") -> bool:
    """Whether a layout is condensed and the rate is then in half of the equations that have it.

    That is so where the equations of v do without n, which brings the rate along.
    """
    structure = layout.structure
    fields = [unknown.rpartition(".")[2] for unknown in structure.unknowns[:structure.fields]]
    free = [row for row, field in zip(structure.rows, fields, strict=False) if field == FIELDS[0]]
    return condensable(layout) and not any(
        "rate" in monomial or unknown.rpartition(".")[2].strip("'") == FIELDS[_GIVEN[1]] for row in free
        for unknown, monomial, _ in row.terms)


class Groups:
    """The rows and columns of a layout by field: a group for each, of those in its interior, and the border behind.

    `row`, `column` (size,) are the groups of all rows and columns, `row_place`, `column_place` (size,) their places in
    them; `sizes` (groups,) are those of the groups, and `given` (groups,) tells which are E.
    """

    def __init__(self, layout: "Layout") -> None:
        structure = layout.structure
        border = structure.fields
        numbers = np.arange(border + 1)
        self.given = np.isin(numbers % len(FIELDS), _GIVEN) & (numbers < border)
        self.sizes = np.full(border + 1, layout.size - layout.interior)
        self.row, self.column = (np.full(layout.size, border) for _ in range(2))
        self.row_place, self.column_place = (np.maximum(np.arange(layout.size) - layout.interior, 0) for _ in range(2))
        for number in range(border):
            for group, place, places in ((self.row, self.row_place, layout.rows[structure.rows[number].name]),
                                         (self.column, self.column_place, layout.columns[structure.unknowns[number]])):
                inside = places[places < layout.interior]
                group[inside], place[inside] = number, np.arange(len(inside))
            self.sizes[number] = len(inside)

    def sorted(self, group: np.ndarray, place: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The rows (or columns) of R, as they lie in the layout, and those of E, group by group."""
        order = np.lexsort((place, group))
        return np.flatnonzero(~self.given[group]), order[self.given[group[order]]]

    def within(self, group: np.ndarray, kept: np.ndarray) -> list[np.ndarray]:
        """Where the rows (or columns) of each group lie among those that are kept."""
        return [np.flatnonzero(group[kept] == number) for number in range(len(self.sizes))]


class Arrangement:
    """What the condensed pencils of one layout have in common: where entries lie before.

    `kept_rows`, `kept_columns` (kept,) and `given_rows`, `given_columns` (given,) are the places of R and E in vectors;
    `rows`, `columns` and `both` tell where the entries in the rows, in the columns, and of N lie: those are `in_rows`,
    `in_columns` and `in_both` of the entries of the layout.
    """

    def __init__(self, layout: "Layout") -> None:
        self.structure, self.size = layout.structure, layout.size
        self.groups = groups = Groups(layout)
        part, row, column = layout.entries()
        count = len(self.structure.parts)
        self.kept_rows, self.given_rows = groups.sorted(groups.row, groups.row_place)
        self.kept_columns, self.given_columns = groups.sorted(groups.column, groups.column_place)
        self.in_rows = np.flatnonzero(groups.given[groups.row[row]])
        self.in_columns = np.flatnonzero(groups.given[groups.column[column]])
        where = np.zeros(layout.size, int)
        where[self.given_rows] = np.arange(len(self.given_rows))
        self.rows = Lines(part[self.in_rows], where[row[self.in_rows]], column[self.in_rows], count,
                          (len(self.given_rows), layout.size))
        given = groups.given[groups.row[row]] & groups.given[groups.column[column]]
        self.in_both = np.flatnonzero(given & (groups.row[row] != groups.column[column]))
        at_row = where[row[self.in_both]]
        where[self.given_columns] = np.arange(len(self.given_columns))
        self.columns = Lines(part[self.in_columns], row[self.in_columns], where[column[self.in_columns]], count,
                             (layout.size, len(self.given_columns)))
        self.both = Lines(part[self.in_both], at_row, where[column[self.in_both]], count,
                          (len(self.given_rows), len(self.given_columns)))
        self._place(part, row, column)

    def _place(self, part: np.ndarray, row: np.ndarray, column: np.ndarray) -> None:
        """Full blocks for every pair of groups and part: where they begin, and which entries add to them."""
        groups, count = self.groups, len(self.structure.parts)
        number = len(groups.sizes)
        keys, block = np.unique((groups.row[row] * number + groups.column[column]) * count + part, return_inverse=True)
        pairs, parts = keys // count, keys % count
        shapes = groups.sizes[np.array([pairs // number, pairs % number])]
        starts = np.concatenate(([0], np.cumsum(shapes.prod(axis=0))))
        target = starts[block] + groups.row_place[row] * shapes[1][block] + groups.column_place[column]
        self._sum = csr_array((np.ones(len(target)), (target, np.arange(len(target)))), (starts[-1], len(target)))
        self._blocks = [((pair // number, pair % number, (one,)), slice(first, last), shape)
                        for pair, one, first, last, shape in zip(
                            *(array.tolist() for array in (pairs, parts, starts[:-1], starts[1:], shapes.T)),
                            strict=True)]

    def blocks(self, value: np.ndarray) -> Iterator[tuple[Key, np.ndarray]]:
        """Yield the blocks of a pencil whose entries in the layout have these values."""
        flat = self._sum @ value
        yield from ((key, flat[where].reshape(shape)) for key, where, shape in self._blocks)

    @cached_property
    def reduced(self) -> "Reduced":
        """Where the entries of S lie, of all pencils: told by one whose values and products are not 0 by chance."""
        return Reduced(self, _condensed(self, 1 + np.random.default_rng(1).random(self._sum.shape[1])))


class Reduced:
    """Where the entries of condensed pencils lie, `blocks` like those of one of them one after the other, row by row.

    `factors` (parts, 3) are the parts of the pencil whose product is a part of S, a number beyond them standing for 1;
    parts from `first_b` on have the rate. `entries` are those of the blocks, one behind the other, that are not 0
    by structure; `stack`, `places` and `b` tell where they, those of the bordered matrix and those with the rate,
    `carrying`, lie. The rate is in `rate_rows` of the `size`.
    """

    def __init__(self, arrangement: Arrangement, blocks: dict[Key, np.ndarray]) -> None:
        structure, groups, keys = arrangement.structure, arrangement.groups, list(blocks)
        names = {product: tuple(sorted(name for one in product for name in structure.parts[one]))
                 for *_, product in keys}
        parts = sorted(set(names.values()), key=lambda names: ("rate" in names, names))
        self.first_b = sum("rate" not in one for one in parts)
        self.carriers = np.arange(len(parts)) >= self.first_b
        products = [next(product for product, name in names.items() if name == one) for one in parts]
        most = max(map(len, products))
        self.factors = np.array([[*one, *[len(structure.parts)] * (most - len(one))] for one in products])
        pattern = [block != 0 for block in blocks.values()]
        self.entries = np.flatnonzero(np.concatenate([block.ravel() for block in pattern]))
        rows_of = groups.within(groups.row, arrangement.kept_rows)
        columns_of = groups.within(groups.column, arrangement.kept_columns)
        entries = []
        for (row, column, product), (i, j) in zip(keys, map(np.nonzero, pattern), strict=True):
            entries.append((np.full(len(i), parts.index(names[product])), rows_of[row][i], columns_of[column][j]))
        part, rows, columns = (np.concatenate(one) for one in zip(*entries, strict=True))
        size, border = len(arrangement.kept_rows), int(groups.sizes[-1])
        self.stack = Lines(part, rows, columns, len(parts), (size, size))
        self.places = whole(part, rows, columns, len(parts), size - border, border)
        self.size, self.carrying = size, np.flatnonzero(part >= self.first_b)
        self.rate_rows = np.unique(rows[self.carrying])
        self.b = Lines(part[self.carrying], rows[self.carrying], columns[self.carrying], len(parts), (size, size))


class Condensed(Combination):
    """The condensed form S of a pencil whose entries in the layout have these values.

    It has the `stack`, `powers`, `factors`, `b_products` and `arithmetic` of a pencil, for weights of its own parts;
    the rate is in `rate_rows` of the `size`.
    """

    def __init__(self, arrangement: Arrangement, value: np.ndarray) -> None:
        self._arrangement = arrangement
        blocks = _condensed(arrangement, value)
        self._where = arrangement.reduced
        self.first_b, self.size, self.rate_rows = self._where.first_b, self._where.size, self._where.rate_rows
        self._value = np.concatenate([block.ravel() for block in blocks.values()])[self._where.entries]
        self._carried = self._value[self._where.carrying]
        self._rows = Stack(arrangement.rows, value[arrangement.in_rows])
        self._columns = Stack(arrangement.columns, value[arrangement.in_columns])
        self._both = Stack(arrangement.both, value[arrangement.in_both])

    @property
    def arithmetic(self) -> Arithmetic:
        return Arithmetic(self)  # nothing is kept: what refers to itself would outlive its use

    def weights(self, value: np.ndarray) -> np.ndarray:
        """The weights of its parts, (parts, ...), for those of the parts of the pencil."""
        return np.concatenate((value, np.ones((1, *value.shape[1:]))))[self._where.factors].prod(axis=1)

    def restricted(self, x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The parts R of vectors x and y (without conjugation)."""
        return x[self._arrangement.kept_columns], y[self._arrangement.kept_rows]

    def continued(self, weights: np.ndarray, x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Vectors of the pencil from x_R and y_R, for the weights of its parts times powers of the rate."""
        arrangement, rows, columns, both = self._arrangement, self._rows, self._columns, self._both
        full_x, full_y = (np.zeros((arrangement.size, *x.shape[1:]), vector.dtype) for vector in (x, y))
        full_x[arrangement.kept_columns], full_y[arrangement.kept_rows] = x, y
        given_x = rows.total(rows.spread(weights), rows.times(full_x)) / -_PIVOT
        given_y = columns.total_left(columns.spread(weights), full_y) / -_PIVOT
        in_both = both.spread(weights)
        full_x[arrangement.given_columns] = given_x - both.total(in_both, both.times(given_x)) / _PIVOT
        full_y[arrangement.given_rows] = given_y - both.total_left(in_both, given_y) / _PIVOT
        return full_x, full_y


def _condensed(arrangement: Arrangement, value: np.ndarray) -> dict[Key, np.ndarray]:
    """The blocks of S."""
    given = arrangement.groups.given
    found: dict[Key, np.ndarray] = {}
    says: dict[int, list[Any]] = {}  # the rows of E: blocks beside the slopes
    rest = []
    for (row, column, product), block in arrangement.blocks(value):
        if given[row] and row != column:
            says.setdefault(row, []).append((column, product, block / _PIVOT))
        elif not given[row]:
            rest.append((row, column, product, block))
    solved = {row: _solved(row, says, given) for row in says}
    for row, column, product, block in rest:
        if not given[column]:
            _add(found, (row, column, product), block)
            continue
        for (end, other), one in solved[column].items():
            _add(found, (row, end, _times(product, other)), -(block @ one))
    return found


def _solved(row: int, says: dict[int, list[Any]], given: np.ndarray) -> dict[Any, np.ndarray]:
    """P^{-1} F in the rows of a group of E: {(group of columns, parts): block}."""
    found: dict[Any, np.ndarray] = {}
    for column, product, block in says[row]:
        if not given[column]:
            _add(found, (column, product), block)
            continue
        for (end, other), one in _solved(column, says, given).items():
            _add(found, (end, _times(product, other)), -(block @ one))
    return found


def _times(one: tuple[int, ...], other: tuple[int, ...]) -> tuple[int, ...]:
    return tuple(sorted((*one, *other)))


def _add(total: dict[Any, np.ndarray], key: Any, block: np.ndarray) -> None:
    total[key] = total[key] + block if key in total else block
