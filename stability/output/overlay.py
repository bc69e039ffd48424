"""Points of a CSV file, laid over a figure: measurements with their errors, or a curve that a program computed."""

import os
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..errors import ParameterError
from .csv_text import read_csv
from .panels import LINE, POINTS, Curve

_ERRORS = "{}_error", "{}_err", "error_{}", "{}_sd"  # names of a column with the error of another one
_BOUNDED = "k_max", "growth_rate"  # what the column `error` bounds, the first that there is


@dataclass(frozen=True, eq=False)
class Overlay:
    """Columns {name: array (rows,)} of a file, by name. What says in its header how it was computed is a line.

    `bounded` names what the column `error` belongs to, None for whatever is drawn upwards.
    """

    source: str
    columns: dict[str, Any]
    label: str | None
    computed: bool
    bounded: str | None = None

    def fits(self, panel: Any) -> bool:
        """Whether the file has what the panel shows."""
        return panel.x.name in self.columns and panel.y.name in self.columns

    def curve(self, panel: Any) -> Curve:
        """The points as a curve of the panel; rows without a number are left out."""
        x, y = self.columns[panel.x.name], self.columns[panel.y.name]
        known = _numbers(x) & _numbers(y)
        if not known.any():
            raise ParameterError(f"--overlay: {self.source} has no row with numbers in {panel.x.name} and "
                                 f"{panel.y.name}")
        bars = [None if error is None else np.abs(error[known].astype(float)) for error in
                (self._error(panel.x.name, False), self._error(panel.y.name, True))]
        order = np.argsort(x[known], kind="stable")
        kind = LINE if self.computed else POINTS
        parts = [x[known][order], y[known][order], *(None if bar is None else bar[order] for bar in bars)]
        return Curve(parts[0], parts[1], self.label, kind, parts[2], parts[3])

    def _error(self, name: Any, upwards: Any) -> Any:
        names = [pattern.format(name) for pattern in _ERRORS]
        names += ["error"] if name == self.bounded or self.bounded is None and upwards else []
        found = next((self.columns[one] for one in names if one in self.columns), None)
        return found if found is not None and found.dtype.kind == "f" else None


def _numbers(column: Any) -> Any:
    return np.isfinite(column) if column.dtype.kind == "f" else np.ones(len(column), dtype=bool)


def read_overlay(text: str, name: str = "--overlay") -> Overlay:
    """Return the overlay of FILE or FILE:LABEL; raises ParameterError where the file cannot be read."""
    path, label = _parts(text)
    header, columns = read_csv(path, name)
    arrays = {key: _column(values) for key, values in columns.items()}
    if not any(column.dtype.kind == "f" for column in arrays.values()):
        raise ParameterError(f"{name}: {path!r} has no column of numbers; give CSV with the names of the columns above")
    bounded = header.get("vary") or next((one for one in _BOUNDED if one in arrays), None)
    return Overlay(repr(path), arrays, label, "method" in header, bounded)


def _parts(text: Any) -> Any:
    """The file and the label of FILE:LABEL; a colon may belong to the name of the file."""
    if os.path.exists(text) or ":" not in text:
        return text, os.path.basename(text).rpartition(".")[0] or os.path.basename(text)
    places = [place for place, letter in enumerate(text) if letter == ":"]
    place = next((place for place in reversed(places) if os.path.exists(text[:place])), places[0])
    return text[:place], text[place + 1:] or None


def _column(values: Any) -> Any:
    """An array of a column: numbers with nan where there is none, or texts."""
    if all(value is None or isinstance(value, (int, float)) for value in values):
        return np.array([np.nan if value is None else value for value in values], dtype=float)
    return np.array([str(value) for value in values])
