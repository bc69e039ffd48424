"""What every result can do: print and draw itself, write itself to a file, be a sequence of its rows."""

import os
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from ..status import is_resolved, is_stable
from .symbols import title_of
from .text import Row, header_of, html_table, render, table, whole_file

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_HEAD, _TAIL = 4, 2  # rows shown of a long table
Target = str | os.PathLike[str]


class Record:
    """Base of the results: frozen dataclasses with a `flow`. A subclass gives its `rows`, `dimension` and `panels`.

    A result is a sequence of its rows: `len(result)`, `result[0]`, `result[-3:]`, `for row in result`; the name of a
    column gives that as an array, `result["growth_rate"]`.

    `method` and `settings` say how it was computed. Units are those of the columns (`output.columns`). Raises
    KeyError, with the columns there are, for a name that is none.

    >>> from stability import dispersion, flows
    >>> result = dispersion(flows.Vortex(), [1.0, 2.0])
    >>> len(result), result[-1]["k"], result["k"].tolist(), result.header()["flow"]
    (2, 2.0, [1.0, 2.0], 'vortex')
    """

    flow: Any
    method: str = "collocation"
    settings: Mapping[str, Any] = {}  # what the method was told, {name: text or number}

    @property
    def dimension(self) -> str:
        """Name of the dimension along which the columns lie."""
        raise NotImplementedError

    @property
    def dimensions(self) -> tuple[str, ...]:
        """Names of all dimensions of the columns: those of a map are several, each with a column of its own."""
        return (self.dimension,)

    @property
    def swept(self) -> tuple[str | None, ...]:
        """Names of the parameters that vary from row to row: no property of the whole."""
        return ()

    @property
    def bounded(self) -> str:
        """What the column `error` bounds."""
        return "sigma"

    def rows(self) -> list[Row]:
        """Return the table that the command line prints, as dicts with the same keys; None where there is no number."""
        raise NotImplementedError

    def columns(self) -> dict[str, np.ndarray]:
        """Return the arrays of a netCDF file, (count,) along `dimension`; complex ones are written in two parts."""
        return columns_of(self.rows())

    def notes(self) -> list[str]:
        """Return what else there is to know of the result, a sentence each."""
        return []

    def about(self) -> dict[str, Any]:
        """Return what the result was asked for besides the flow, {name: text or number}."""
        return {}

    @property
    def title(self) -> str:
        """The flow and its fixed parameters as symbols, above a figure."""
        return title_of(self.flow, self.swept) + self.subtitle

    @property
    def subtitle(self) -> str:
        """What the title of a figure adds to the flow."""
        return ""

    def panels(self) -> tuple[Any, ...]:
        """Return what a figure of the result shows, a `stability.output.panels.Panel` (or Grid) for each quantity."""
        raise NotImplementedError

    def plot(self, ax: "Axes | None" = None, quantity: str | None = None, *, label: str | None = None,
             **line_options: Any) -> "Axes":
        """Draw one quantity (the first of `panels`, by default) into the matplotlib Axes `ax`, or a new one; return it.

        Successive results on the same axes take successive colours. `line_options` are those of matplotlib's lines
        (color, linestyle, linewidth ...). Raises ParameterError, with the names there are, for another quantity.

        >>> from matplotlib.figure import Figure
        >>> from stability import dispersion, flows
        >>> axes = Figure().add_subplot()
        >>> for slope in 25.0, 35.0:
        ...     _ = dispersion(flows.Vortex(slope_deg=slope), [0.1, 1.0]).plot(axes, "growth_rate", label=f"{slope:g}")
        >>> len(axes.lines) >= 2
        True
        """
        from . import plots

        return plots.plot(self.panels(), ax, quantity, label, **line_options)

    def header(self) -> dict[str, Any]:
        """Return flow, fixed parameters, method, version, what was asked for, settings, and notes if there are any."""
        return header_of(self.flow, self.method, {**self.about(), **self.settings}, self.notes(), self.swept)

    def to_csv(self, path: Target) -> None:
        """Write the rows as CSV, flow and parameters as comments; raises ParameterError where that cannot be done.

        >>> from stability import dispersion, flows
        >>> dispersion(flows.Vortex(), [1.0]).to_csv("one.csv")
        >>> from pathlib import Path
        >>> Path("one.csv").read_text().splitlines()[0]
        '# flow: vortex'
        """
        self._write(path, "to_csv", render("csv", self.header(), self.rows()).encode())

    def to_json(self, path: Target) -> None:
        """Write header and rows as JSON; raises ParameterError where that cannot be done.

        >>> from stability import dispersion, flows, load
        >>> dispersion(flows.Vortex(), [1.0]).to_json("one.json")
        >>> load("one.json").header()["mode"]
        'surface'
        """
        self._write(path, "to_json", render("json", self.header(), self.rows()).encode())

    def to_netcdf(self, path: Target) -> None:
        """Write the columns as netCDF 3, missing numbers as nan; raises ParameterError where that cannot be done.

        >>> from stability import dispersion, flows, load
        >>> dispersion(flows.Vortex(), [1.0]).to_netcdf("one.nc")
        >>> load("one.nc")["k"].tolist()
        [1.0]
        """
        from .netcdf import encode  # scipy.io is slow to import

        self._write(path, "to_netcdf", encode(self))

    def to_pandas(self) -> Any:
        """Return the rows as a pandas DataFrame, the header in its `attrs`; raises ImportError without pandas."""
        from .frames import to_pandas

        return to_pandas(self)

    def to_xarray(self) -> Any:
        """Return what a netCDF file holds as an xarray Dataset; raises ImportError without xarray."""
        from .frames import to_xarray

        return to_xarray(self)

    def __len__(self) -> int:
        return len(self.rows())

    def __bool__(self) -> bool:
        return True

    def __iter__(self) -> Iterator[Row]:
        return iter(self.rows())

    def __getitem__(self, place: Any) -> Any:
        if not isinstance(place, str):
            return self.rows()[place]
        columns = self.columns()
        if place not in columns:
            raise KeyError(f"{place}; there are {', '.join(columns)}")
        return columns[place]

    def _write(self, path: Target, name: str, content: bytes) -> None:
        with whole_file(path, name) as temporary:
            temporary.write_bytes(content)

    def _summary(self) -> list[Row]:
        """The rows that `repr` shows: those that cost nothing to compute."""
        return self.rows()

    def _heading(self, rows: list[Row]) -> str:
        resolved, stable = (sum(test(row["status"]) for row in rows) for test in (is_resolved, is_stable))
        about = "".join(f", {name} {value}" for name, value in self.about().items())
        title = f"{type(self).__name__} of {self.flow}{about}: {resolved} of {len(rows)} resolved"
        return title + (f", {stable} stable" if stable else "")

    def __repr__(self) -> str:
        rows = self._summary()
        title = self._heading(rows)
        if not rows:
            return title
        if len(rows) <= _HEAD + _TAIL + 1:
            return f"{title}\n{table(rows)}".rstrip()
        lines = table(rows[:_HEAD] + rows[-_TAIL:]).splitlines()
        return "\n".join([title, *lines[:_HEAD + 1], "...", *lines[_HEAD + 1:]])

    def _repr_html_(self) -> str:
        """The same as a table of a notebook."""
        rows = self._summary()
        if len(rows) <= _HEAD + _TAIL + 1:
            return html_table(self._heading(rows), rows)
        return html_table(self._heading(rows), rows[:_HEAD] + rows[-_TAIL:], _HEAD)


def columns_of(rows: list[Row]) -> dict[str, np.ndarray]:
    """Arrays (rows,) of the rows; nan for None among numbers."""
    table = {name: [row[name] for row in rows] for name in rows[0]}
    return {name: np.array([np.nan if value is None else value for value in values])
            for name, values in table.items() if not any(isinstance(value, list) for value in values)}
