"""CSV with comments above its columns, `# key: value` as results are written, read back with the types of its cells."""

import csv
import io
import json
from math import isnan
from pathlib import Path
from typing import Any

from ..checks import check_file_name
from ..errors import ParameterError

_MARK = "\ufeff"  # of the byte order, which some programs write first


def read_csv(path: Any, name: str) -> tuple[dict[str, Any], dict[str, list[Any]]]:
    """Return header {key: value} of the lines `# key: value`, and columns {name: values}, None where a cell is empty.

    A column is of numbers, or, where one cell is no number, of texts.
    """
    path = check_file_name(path, f"{name}: path")
    return parse_csv(text_of(read_bytes(path, name), path, name), path, name)


def read_bytes(path: Any, name: Any) -> Any:
    try:
        return Path(path).read_bytes()
    except OSError as reason:
        raise ParameterError(f"{name}: cannot read {path!r}: {reason.strerror}") from None


def text_of(content: Any, path: Any, name: Any) -> Any:
    try:
        return content.decode("utf-8").removeprefix(_MARK)
    except UnicodeDecodeError:
        raise ParameterError(f"{name}: {path!r} is neither text nor netCDF 3") from None


def parse_csv(text: Any, path: Any, name: Any) -> Any:
    lines = [line for line in io.StringIO(text, newline="") if line.strip()]
    comments = [line[1:].strip().partition(": ") for line in lines if line.startswith("#")]
    header = {key.strip(): _one(value) for key, colon, value in comments if colon}
    cells = list(csv.reader((line for line in lines if not line.startswith("#")), skipinitialspace=True))
    if len(cells) < 2:
        raise ParameterError(f"{name}: {path!r} has no rows below the names of its columns")
    names, *rows = cells
    for number, row in enumerate(rows, 1):
        if len(row) != len(names):
            raise ParameterError(f"{name}: {path!r}: row {number} has {len(row)} cells, and there are {len(names)} "
                                 "columns")
    if len(set(names)) < len(names):
        raise ParameterError(f"{name}: {path!r} has two columns of the same name")
    return header, {key.strip(): _typed(values) for key, values in zip(names, zip(*rows, strict=True), strict=True)}


def _one(cell: Any) -> Any:
    return _typed([cell])[0]


def _typed(cells: Any) -> Any:
    """The cells of a column as integers, floats, lists or texts, whichever all of them are; None where one is empty."""
    for kind in (int, float, _list):
        try:
            return [None if cell.strip() == "" else no_nan(kind(cell)) for cell in cells]
        except ValueError:
            continue
    return list(cells)


def no_nan(value: Any) -> Any:
    return None if isinstance(value, float) and isnan(value) else value


def _list(cell: Any) -> Any:
    if not cell.startswith("["):
        raise ValueError(cell)
    return json.loads(cell)
