"""Tables of a velocity: read once, checked, and told apart by a digest of what was read."""

import csv
import os
from dataclasses import dataclass
from difflib import get_close_matches
from hashlib import sha256
from typing import Any

import numpy as np

from ..checks import as_file_name, as_number, flat, shown
from ..errors import ParameterError

DIGEST = 12  # hexadecimal digits of a digest that are shown

LEAST_ROWS = 8  # points of a table
_MOST = 100_000
_LARGEST = 50_000_000  # bytes of a file
_COLUMNS = ("z", "U", "U_error")


@dataclass(frozen=True)
class DataTable:
    """Values U at heights z, both tuples (points,) by rising z, and their standard errors U_error, or None.

    `name` is the path of the file they were read from, `digest` the beginning of the sha256 of what was read.
    """

    name: str
    z: tuple[float, ...]
    U: tuple[float, ...]
    U_error: tuple[float, ...] | None
    digest: str
    limits = None, None

    @property
    def low(self) -> float:
        return self.z[0]

    @property
    def high(self) -> float:
        return self.z[-1]

    def __repr__(self) -> str:
        return f"{self.name!r} (sha256 {self.digest})"

    def text(self, heights: np.ndarray) -> str:
        """What tells it from others in a file."""
        return f"{self.name} (sha256 {self.digest})"


def from_arrays(name: str, z: Any, U: Any, U_error: Any = None) -> DataTable:
    """Return the table of arrays of equal length; raises ParameterError that begins with `name`."""
    columns = [_numbers(f"{name}: {key}", values) for key, values in zip(_COLUMNS, (z, U, U_error), strict=True)
               if values is not None]
    if len({len(column) for column in columns}) > 1:
        lengths = ", ".join(f"{len(column)} {key}" for key, column in zip(_COLUMNS, columns, strict=False))
        raise ParameterError(f"{name}: z, U and U_error must be arrays of one length (got {lengths})")
    digest = sha256(b"".join(column.tobytes() for column in columns)).hexdigest()[:DIGEST]
    return _table(name, f"table of {len(columns[0])} points", columns, digest, [""] * len(columns[0]))


def from_file(name: str, path: Any, names: list[str]) -> DataTable:
    """Return the table of a CSV file with a header row, columns z, U and perhaps U_error, comments after #.

    Raises ParameterError that begins with `name`; `names` are what else might have been meant.
    """
    text = as_file_name(path)
    if text is None:
        raise ParameterError(f"{name} must be the name of a file (got {shown(path)})")
    where = f"{name}: {shown(text)}"
    try:
        with open(text, "rb") as file:
            content = file.read(_LARGEST + 1)
    except OSError as reason:
        match = get_close_matches(text, names, 1)
        hint = f" (did you mean {match[0]!r}?)" if match else ""
        raise ParameterError(f"{where} cannot be read: {reason.strerror}{hint}; known profiles: "
                             f"{', '.join(names)}") from None
    if len(content) > _LARGEST:
        raise ParameterError(f"{where}: has over {_LARGEST // 10**6} million bytes: it is no table of a velocity")
    try:
        lines = content.decode("utf-8-sig").splitlines()
    except UnicodeDecodeError:
        raise ParameterError(f"{where}: is no text in UTF-8") from None
    columns, places = _columns(where, lines)
    return _table(where, os.fspath(text), columns, sha256(content).hexdigest()[:DIGEST], places)


def _columns(where: Any, lines: Any) -> Any:
    """The columns z, U (and U_error) as arrays, and where each row stands."""
    rows = [(number, [cell.strip() for cell in next(csv.reader([line]), [])])
            for number, line in enumerate((line.partition("#")[0] for line in lines), 1) if line.strip()]
    header = rows[0][1] if rows else []
    for key in _COLUMNS[:2]:
        if header.count(key) != 1:
            raise ParameterError(f"{where}: needs one column {key} in its header row, z,U or z,U,U_error "
                                 f"(got {shown(','.join(header))})")
    wanted = [key for key in _COLUMNS if key in header]
    if header.count(_COLUMNS[2]) > 1:
        raise ParameterError(f"{where}: has two columns {_COLUMNS[2]}")
    table = []
    for number, cells in rows[1:]:
        if len(cells) != len(header):
            raise ParameterError(f"{where}, line {number}: has {len(cells)} cells under {len(header)} columns")
        values = [as_number(cells[header.index(key)]) for key in wanted]
        if None in values:
            wrong = wanted[values.index(None)]
            raise ParameterError(f"{where}, line {number}: {wrong} must be a number "
                                 f"(got {shown(cells[header.index(wrong)])})")
        table.append(values)
    return list(np.array(table, dtype=float).reshape(-1, len(wanted)).T), [f", line {number}" for number, _ in rows[1:]]


def _numbers(name: Any, values: Any) -> Any:
    numbers = [as_number(value) for value in flat(values, name)]
    if None in numbers:
        raise ParameterError(f"{name} must be numbers (got {shown(flat(values, name)[numbers.index(None)])})")
    return np.array(numbers, dtype=float)


def _table(where: Any, name: Any, columns: Any, digest: Any, places: Any) -> Any:
    """The table of checked columns, by rising z."""
    z, U, *errors = columns
    if not LEAST_ROWS <= len(z) <= _MOST:
        raise ParameterError(f"{where}: a table needs {LEAST_ROWS} to {_MOST} points (got {len(z)})")
    for key, column in zip(_COLUMNS, columns, strict=False):
        wrong = np.flatnonzero(~np.isfinite(column) | (np.abs(column) > 1e20))
        if len(wrong):
            raise ParameterError(f"{where}{places[wrong[0]]}: {key} must be a finite number (got {column[wrong[0]]:g})")
    steps = np.diff(z)
    wrong = np.flatnonzero(steps * np.sign(steps[0] or 1.0) <= 0)
    if len(wrong):
        a, b = z[wrong[0]: wrong[0] + 2]
        kind = "is repeated" if a == b else f"follows {a:.6g}"
        raise ParameterError(f"{where}{places[wrong[0] + 1]}: z must rise (or fall) from row to row "
                             f"(z = {b:.6g} {kind})")
    if errors:
        wrong = np.flatnonzero(errors[0] < 0)
        if len(wrong):
            raise ParameterError(f"{where}{places[wrong[0]]}: U_error must not be negative "
                                 f"(got {errors[0][wrong[0]]:g})")
        if not errors[0].all():
            if errors[0].any():
                raise ParameterError(f"{where}{places[np.flatnonzero(errors[0] == 0)[0]]}: U_error is 0 here and not "
                                     "elsewhere: give every error, or leave the column out")
            errors = []
    if not np.ptp(U):
        raise ParameterError(f"{where}: U is {U[0]:g} at every z: there is no shear")
    order = slice(None, None, 1 if steps[0] > 0 else -1)
    z, U, *errors = (tuple(column[order].tolist()) for column in (z, U, *errors))
    return DataTable(name, z, U, errors[0] if errors else None, digest)
