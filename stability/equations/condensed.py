"""A pencil without the unknowns that two equations of each layer give outright: half of them, and an eighth of the work.

Continuity and momentum across are solved for the slopes of w and n, of which they contain nothing else but w in the
latter: coefficient j of either is what row j - 1 of its equation says, times a number. With these unknowns E, the
others R (v, t and the border) and

    [ P  F ]  rows of E,    P = diag(d) + N,  N taking w to the rows of n,
    [ G  H ]  rows of R,

the eigenvalues are those of S = H - G P^{-1} F: P^{-1} = 1/d - (1/d) N (1/d) is a polynomial in the symbols and in the
rate, and N alone has the rate where F has none, so that S is linear in the rate as well: a smaller pencil, with more
parts. Where blocks are full it takes much less work. Vectors of S are continued to E by x_E = -P^{-1} F x_R and
y_E = -y_R G P^{-1}.
"""

from collections.abc import Iterator
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.sparse import csr_array

from ..numerics.blocks import Blocks
from ..numerics.bordered import Bordered, Factors, ManyFactors
from ..numerics.stack import Lines, Stack
from .layer import FIELDS

if TYPE_CHECKING:
    from .pencil import Layout, Pencil, Weights

_GIVEN = "w", "n"  # in this order: the equation of the second contains the first
_PLACES = tuple(FIELDS.index(name) for name in _GIVEN)
_SWEEPS = len(_GIVEN)  # after which P is inverted


def condensable(layout: "Layout") -> bool:
    """Whether its equations give w and n outright."""
    rows, structure = layout.structure.rows, layout.structure
    return all(_given(structure.unknowns[number], rows[number].terms, first, number)
               for first in range(0, structure.fields, len(FIELDS))
               for number in (first + place for place in _PLACES))


def _given(field: str, terms: Any, first: int, number: int) -> bool:
    slopes = [(unknown, monomial, tuple(support)) for unknown, monomial, support in terms if unknown.endswith("'")]
    return slopes == [(f"{field}'", (), (0,))] and field not in (unknown for unknown, *_ in terms)


class Groups:
    """The rows and columns of a `layout` by field: groups of those of its interior, and the border as the last one.

    `row`, `column` (size,) are the groups, `place` those of either within them, and `sizes` (groups,) their sizes.
    """

    def __init__(self, layout: "Layout") -> None:
        structure = layout.structure
        count = structure.fields
        self.row, self.column = (np.full(layout.size, count) for _ in range(2))
        self.row_place, self.column_place = (np.maximum(np.arange(layout.size) - layout.interior, 0) for _ in range(2))
        self.sizes = np.zeros(count + 1, int)
        for number in range(count):
            inside = [places[places < layout.interior] for places in (
                layout.rows[structure.rows[number].name], layout.columns[structure.unknowns[number]])]
            for group, place, places in zip((self.row, self.column), (self.row_place, self.column_place), inside,
                                            strict=True):
                group[places], place[places] = number, np.arange(len(places))
            self.sizes[number] = len(inside[0])
        self.sizes[count] = layout.size - layout.interior
        self.given = np.isin(np.arange(count + 1) % len(FIELDS), _PLACES) & (np.arange(count + 1) < count)


class Arrangement:
    """What condensed pencils of one layout have in common: where entries lie before and after.

    `kept_rows`, `kept_columns` (kept,) and `given_rows`, `given_columns` (given,) are the places in the full vectors.
    """

    def __init__(self, layout: "Layout") -> None:
        self.layout, self.groups = layout, (groups := Groups(layout))
        part, row, column = layout.entries()
        self._blocks(part, row, column)
        order = np.lexsort((groups.row_place, groups.row))
        self.given_rows = order[groups.given[groups.row[order]]]
        self.kept_rows = order[~groups.given[groups.row[order]]]
        order = np.lexsort((groups.column_place, groups.column))
        self.given_columns = order[groups.given[groups.column[order]]]
        self.kept_columns = order[~groups.given[groups.column[order]]]
        self.starts = np.cumsum(np.where(groups.given, 0, groups.sizes)) - np.where(groups.given, 0, groups.sizes)
        where = np.zeros(layout.size, int)
        count = len(layout.structure.parts)
        where[self.given_rows] = np.arange(len(self.given_rows))
        self.in_rows = np.flatnonzero(groups.given[groups.row[row]])
        self.rows = Lines(part[self.in_rows], where[row[self.in_rows]], column[self.in_rows], count,
                          (len(self.given_rows), layout.size))
        where[self.given_columns] = np.arange(len(self.given_columns))
        self.in_columns = np.flatnonzero(groups.given[groups.column[column]])
        self.columns = Lines(part[self.in_columns], row[self.in_columns], where[column[self.in_columns]], count,
                             (layout.size, len(self.given_columns)))
        self.known: Any = None

    def _blocks(self, part: np.ndarray, row: np.ndarray, column: np.ndarray) -> None:
        """Full blocks for every pair of groups and part: where they begin, and how entries add to them."""
        groups, count = self.groups, len(self.layout.structure.parts)
        key = (groups.row[row] * len(groups.sizes) + groups.column[column]) * count + part
        keys, block = np.unique(key, return_inverse=True)
        pairs, parts = keys // count, keys % count
        shapes = groups.sizes[np.array([pairs // len(groups.sizes), pairs % len(groups.sizes)])]
        starts = np.concatenate(([0], np.cumsum(shapes.prod(axis=0))))
        target = starts[block] + groups.row_place[row] * shapes[1][block] + groups.column_place[column]
        self._sum = csr_array((np.ones(len(target)), (target, np.arange(len(target)))), (starts[-1], len(target)))
        self._pieces = [(int(pair) // len(groups.sizes), int(pair) % len(groups.sizes), int(one),
                         slice(first, last), tuple(shape)) for pair, one, first, last, shape in
                        zip(pairs, parts, starts[:-1], starts[1:], shapes.T.tolist(), strict=True)]

    def blocks(self, value: np.ndarray) -> Iterator[tuple[int, int, int, np.ndarray]]:
        """Yield (group of rows, group of columns, part, block) for entries with these values."""
        flat = self._sum @ value
        yield from ((row, column, part, flat[where].reshape(shape)) for row, column, part, where, shape in self._pieces)

    def reduced(self, keys: list[tuple[int, int, tuple[int, ...]]]) -> "Reduced":
        """Where the blocks lie that are left, those of these pairs of groups and products of parts."""
        if self.known is None or self.known.keys != keys:
            self.known = Reduced(self, keys)
        return self.known


class Reduced:
    """Where the entries of condensed pencils lie, blocks with these `keys`, row by row."""

    def __init__(self, arrangement: Arrangement, keys: list[tuple[int, int, tuple[int, ...]]]) -> None:
        self.keys, structure = keys, arrangement.layout.structure
        sizes, starts = arrangement.groups.sizes, arrangement.starts
        names = {product: tuple(sorted(name for one in product for name in structure.parts[one]))
                 for *_, product in keys}
        monomials = sorted(set(names.values()), key=lambda names: ("rate" in names, names))
        self.products = [next(product for product, own in names.items() if own == one) for one in monomials]
        self.first_b = sum("rate" not in one for one in monomials)
        parts, rows, columns = [], [], []
        for row, column, product in keys:
            shape = sizes[row], sizes[column]
            here = np.indices(shape).reshape(2, -1)
            rows.append(starts[row] + here[0])
            columns.append(starts[column] + here[1])
            parts.append(np.full(here.shape[1], monomials.index(names[product])))
        part, row, column = (np.concatenate(one) for one in (parts, rows, columns))
        size, border = len(arrangement.kept_rows), int(sizes[-1])
        self.places = Blocks(part, row, column, len(monomials), size - border, border)
        self.stack = Lines(part, row, column, len(monomials), (size, size))
        self.carrying = np.flatnonzero(part >= self.first_b)
        self.b = Lines(part[self.carrying], row[self.carrying], column[self.carrying], len(monomials), (size, size))
        longest = max(map(len, self.products))
        self.factors = np.array([[*product, *[len(structure.parts)] * (longest - len(product))]
                                 for product in self.products])


class Condensed:
    """The condensed form of a `pencil`: `factors` and `b_products` are those of S, for `weights` of its own parts."""

    def __init__(self, pencil: "Pencil", value: np.ndarray) -> None:
        self._arrangement = arrangement = pencil.layout.arrangement
        blocks = _condensed(arrangement, value)
        self._places = arrangement.reduced(list(blocks))
        self.first_b = self._places.first_b
        self._value = np.concatenate([block.ravel() for block in blocks.values()])
        self._rows = Stack(arrangement.rows, value[arrangement.in_rows])
        self._columns = Stack(arrangement.columns, value[arrangement.in_columns])

    def weights(self, weights: "Weights") -> "Weights":
        """The `Weights` of the parts of S for those of the parts of the pencil; their spread is left out."""
        factors, one = self._places.factors, np.ones((1, *weights.value.shape[1:]))
        value = np.concatenate((weights.value, one))[factors].prod(axis=1)
        slopes = np.concatenate((weights.slope / weights.value, 0 * one))[factors].sum(axis=1)
        return replace(weights, value=value, slope=value * slopes, spread=0 * value)

    @cached_property
    def _bordered(self) -> Bordered:
        return Bordered(self._places.places, self._value)

    @cached_property
    def stack(self) -> Stack:
        """All parts of S as sparse matrices."""
        return Stack(self._places.stack, self._value)

    def powers(self, rate: Any) -> np.ndarray:
        """Factor of every part in S: 1, or the rate; (parts,) then the shape of rate."""
        powers = np.ones((len(self._places.products), *np.shape(rate)), np.result_type(rate, float))
        powers[self.first_b:] = rate
        return powers

    @cached_property
    def _b(self) -> Stack:
        return Stack(self._places.b, -self._value[self._places.carrying])

    def b_products(self, weights: np.ndarray) -> Any:
        """The products of B with vectors from either side."""
        return self._b.summed(weights)

    def factors(self, weights: np.ndarray, rate: Any) -> Any:
        """LU factors of S."""
        kind = ManyFactors if np.ndim(rate) else Factors
        return kind(self._bordered, weights * self.powers(rate))

    def restricted(self, x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The parts R of vectors, of x and of y (without conjugation)."""
        return x[self._arrangement.kept_columns], y[self._arrangement.kept_rows]

    def continued(self, weights: np.ndarray, x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Vectors of the pencil from those of S, x_R and y_R, for the weights of its parts times powers of the rate."""
        arrangement, rows, columns = self._arrangement, self._rows, self._columns
        full_x, full_y = (np.zeros((arrangement.layout.size, *x.shape[1:]), x.dtype) for _ in range(2))
        full_x[arrangement.kept_columns], full_y[arrangement.kept_rows] = x, y
        in_rows, in_columns = rows.spread(weights), columns.spread(weights)
        for _ in range(_SWEEPS):
            full_x[arrangement.given_columns] -= rows.total(in_rows, rows.times(full_x)) / 2
            full_y[arrangement.given_rows] -= columns.total_left(in_columns, full_y) / 2
        return full_x, full_y


def _condensed(arrangement: Arrangement, value: np.ndarray) -> dict[Any, np.ndarray]:
    """The blocks of S, {(group of rows, group of columns, parts whose product is their weight): block}."""
    given, total = arrangement.groups.given, {}
    within: dict[int, list[Any]] = {}  # of the given rows: what they say of the given unknowns
    rest = []
    for row, column, part, block in arrangement.blocks(value):
        if given[row]:
            within.setdefault(row, []).append((column, (part,), block))
        elif given[column]:
            rest.append((row, column, (part,), block))
        else:
            total[row, column, (part,)] = block
    solved = {row: _solved(row, within, given) for row in within}
    for row, column, product, block in rest:
        for (end, other), says in solved[column].items():
            _add(total, (row, end, tuple(sorted((*product, *other)))), -(block @ says))
    return total


def _solved(row: int, within: dict[int, list[Any]], given: np.ndarray) -> dict[Any, np.ndarray]:
    """P^{-1} F of a given row: {(group of columns, parts): block}."""
    found: dict[Any, np.ndarray] = {}
    for column, product, block in within[row]:
        if column == row:
            continue
        if not given[column]:
            _add(found, (column, product), block / 2)
            continue
        for (end, other), says in _solved(column, within, given).items():
            _add(found, (end, tuple(sorted((*product, *other)))), -(block @ says) / 2)
    return found


def _add(total: dict[Any, np.ndarray], key: Any, block: np.ndarray) -> None:
    total[key] = total[key] + block if key in total else block
