"""A result that has been read from a file: header, rows and figure, without what it was computed from."""

from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from typing import Any

import numpy as np

from ..errors import ParameterError
from ..status import RESOLVED
from .mapplots import states
from .panels import (
    BARS,
    ELASTICITY,
    GROWTH_AT_K_MAX,
    GROWTH_RATE,
    K_MAX,
    LINE,
    MARKED,
    PARAMETER,
    PHASE_SPEED,
    POINTS,
    WAVENUMBER,
    Axis,
    Curve,
    Grid,
    Panel,
    scale_of,
    swept_curves,
)
from .record import Record
from .symbols import axis_label, symbol, symbol_of, title_of, value_text
from .text import Row

_FIRST = "flow", "method", "version"
_AXES = {axis.name: axis for axis in (WAVENUMBER, GROWTH_RATE, PHASE_SPEED, K_MAX, ELASTICITY, PARAMETER)}
_SPECIAL = (  # columns that a table of this kind has, what is drawn: x, y, a curve for each value of, kind
    ({"elasticity", "parameter"}, "elasticity", "parameter", None, BARS),
    ({"seconds", "method"}, "seconds", "error", "method", MARKED),
    ({"C", "height"}, "C", "height", "layer", LINE),
    ({"condition", "phase_speed"}, "phase_speed", "growth_rate", "k", POINTS),
)
_DRAWN = "k_max", "growth_rate", "phase_speed", "k"  # columns of which two are drawn, beside the one solved for


@dataclass(frozen=True, repr=False, eq=False)
class Stored(Record):
    """Header and rows of a file; `stability.load` makes them.

    It equals a result, and another one of these, with the same header, columns and rows; notes do not count, which CSV
    does not keep, nor does the order of the columns.

    `about_it` is the header as it was read, `table` the rows (dicts). Units are those of the columns that were written.
    Asking for `flow` where the file names an unknown one gives its name; drawing three axes raises ParameterError.

    >>> from stability import flows, load, spectrum
    >>> spectrum(flows.Vortex(), 1.0, 2).to_json("two.json")
    >>> stored = load("two.json")
    >>> stored.flow, len(stored), stored["growth_rate"].shape
    (Vortex(slope_deg=30.0, Fr2=0.1), 2, (2,))
    """

    about_it: Mapping[str, Any] = field(repr=False)
    table: tuple[Row, ...] = field(repr=False)

    @cached_property
    def flow(self) -> Any:  # type: ignore[override]
        """The flow with the parameters of the header, its defaults for the swept ones; its name where it is unknown."""
        from ..flows import FLOWS
        from ..flows.laws import find_law

        name = self.about_it["flow"]
        if name not in FLOWS:
            return name
        try:
            flow: Any = FLOWS[name]
            if "law" in self.about_it:
                flow = flow.under(find_law(str(self.about_it["law"])))
            known = {item.name for item in fields(flow)}
            return flow(**{key: value for key, value in self.about_it.items() if key in known})
        except ParameterError:  # the defaults of the swept ones do not go with the others
            return name

    @property
    def method(self) -> str:  # type: ignore[override]
        return str(self.about_it["method"])

    @property
    def dimension(self) -> str:
        return "row"

    def rows(self) -> list[Row]:
        return [dict(row) for row in self.table]

    def notes(self) -> list[str]:
        return list(self.about_it.get("notes", ()))

    def header(self) -> dict[str, Any]:
        """Return the header of the result, parameters of a flow that is known apart."""
        names = [] if isinstance(self.flow, str) else ["law", *(item.name for item in fields(self.flow))]
        others = {key: value for key, value in self.about_it.items() if key not in _FIRST and key not in names}
        first = {key: self.about_it[key] for key in _FIRST if key in self.about_it}
        return {"flow": first.pop("flow"), "parameters": {key: self.about_it[key] for key in names
                                                          if key in self.about_it}, **first, **others}

    @property
    def title(self) -> str:
        if isinstance(self.flow, str):
            return self.flow
        return title_of(self.flow, [item.name for item in fields(self.flow) if item.name not in self.about_it])

    def _heading(self, rows: list[Row]) -> str:
        return super()._heading(rows) if "status" in rows[0] else f"Stored result of {self.flow}"

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Record):
            return NotImplemented
        return _flat(self.header()) == _flat(other.header()) and self.rows() == _plain_rows(other.rows())

    def __hash__(self) -> int:
        return hash((self.about_it["flow"], len(self.table)))

    # -- the figure ----------------------------------------------------------------------------------------

    def panels(self) -> tuple[Any, ...]:
        """What the figure of the result shows, as far as the table knows it."""
        names, header = set(self.table[0]), self.about_it
        for columns, x, y, each, kind in _SPECIAL:
            if columns <= names:
                return (Panel(self._axis(x), self._axis(y), self._curves(x, y, each, kind)),)
        over = str(header.get("over", "k")).split(", ")
        if "quantity" in header:
            return tuple(self._grid(over, y) for y in self._drawn(over))
        x = over[0] if over[0] in names else next(iter(self.table[0]))
        return tuple(Panel(replace(self._axis(x), scale=scale_of(self._numbers(x))), self._axis(y),
                           self._curves(x, y, header.get("each"), MARKED if "over" in header else LINE),
                           zero="y" if y == "growth_rate" and x == "k" else "") for y in self._drawn([x]))

    def _drawn(self, but: Any) -> Any:
        found = [name for name in (self.about_it.get("vary"), *_DRAWN) if name in self.table[0] and name not in but]
        return found[:2] or [name for name in self.table[0] if isinstance(self.table[0][name], float)][1:2]

    def _numbers(self, name: Any, rows: Any = None) -> Any:
        values = [row[name] for row in (self.table if rows is None else rows)]
        return np.array([np.nan if value is None else value for value in values], dtype=float)

    def _curves(self, x: Any, y: Any, each: Any, kind: Any) -> Any:
        """A curve for each value of the column `each`, or a single one."""
        curves: list[Curve] = []
        for value in dict.fromkeys(row[each] for row in self.table) if each else (None,):
            rows = [row for row in self.table if (each is None or row[each] == value) and row[x] is not None]
            label = None if each is None else str(value) if isinstance(value, str) else \
                f"{self._symbol(each)} = {value_text(value)}"
            if kind == BARS:
                names = np.array([self._symbol(row[y]) for row in rows])
                curves.append(Curve(self._numbers(x, rows), names, label, kind))
                continue
            status = tuple(row.get("status", RESOLVED) for row in rows)
            curves += swept_curves(self._numbers(x, rows), self._numbers(y, rows),
                                   f"{self._symbol(x)} = {value_text(float('inf'))}", label, kind, status=status)
        return tuple(curves)

    def _grid(self, axes: Any, quantity: Any) -> Any:
        places = [np.array(list(dict.fromkeys(row[name] for row in self.table)), dtype=float) for name in axes]
        if len(axes) > 2:
            raise ParameterError(f"only maps over one or two axes are drawn (this one has {', '.join(axes)})")
        shape = [len(values) for values in places]
        status = np.array([row["status"] for row in self.table], dtype=str).reshape(shape)
        return Grid(tuple((self._axis(name), values) for name, values in zip(axes, places, strict=True)),
                    self._axis(quantity), self._numbers(quantity).reshape(shape), states(status),
                    signed=quantity == "growth_rate")

    def _axis(self, name: Any) -> Any:
        if name == "growth_rate" and "k_max" in self.table[0]:
            return GROWTH_AT_K_MAX
        if name == self.about_it.get("vary"):
            return Axis(name, f"{self._symbol(name)} at zero growth")
        known = isinstance(self.flow, str) or name not in [item.name for item in fields(self.flow)]
        return _AXES.get(name) or Axis(name, symbol(name) if known else axis_label(self.flow, name))

    def _symbol(self, name: Any) -> Any:
        return symbol(name) if isinstance(self.flow, str) else symbol_of(self.flow, name)


def _flat(header: Any) -> Any:
    """A header with parameters among the rest, and without notes."""
    parameters = header.get("parameters", {})
    return {**parameters, **{key: value for key, value in header.items() if key not in ("parameters", "notes")}}


def _plain_rows(rows: Any) -> Any:
    return [{key: [list(pair) for pair in value] if isinstance(value, list) else value for key, value in row.items()}
            for row in rows]

