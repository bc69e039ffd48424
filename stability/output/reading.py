"""Results read back from the files that were written of them: CSV, JSON or netCDF, known by their content."""

import csv
import io
import json
from itertools import product
from math import isnan
from pathlib import Path
from typing import Any

import numpy as np

from ..checks import check_file_name
from ..errors import ParameterError
from .stored import Stored

_MARK = "\ufeff"  # of the byte order, which some programs write first
_NETCDF = b"CDF"
_PARTS = "_real", "_imag"
_LIST = "maximum"  # dimension of a list in each row
_OF_FILE = ("title", "scales", "convention")  # attributes of a file that are no header
_RENAMED = {"mode_followed": "mode"}
_INFINITE = {"inf": float("inf"), "-inf": float("-inf")}


def load(path: Any) -> Stored:
    """Return the `Stored` result of a file that a result or a command has written, as CSV, JSON or netCDF.

    It equals the result: the same header (notes apart, which CSV does not keep), columns and rows. Raises
    ParameterError where the file cannot be read, or is none of these.

    >>> from stability import dispersion, flows, load
    >>> relation = dispersion(flows.Vortex(), [0.1, 1.0])
    >>> relation.to_csv("/tmp/relation.csv")
    >>> load("/tmp/relation.csv") == relation
    True

    Units are those of the columns, `output.columns` explains them.
    """
    name = check_file_name(path, "load: path")
    content = _bytes(name, "load")
    if content.startswith(_NETCDF):
        return _netcdf(content)
    text = _text(content, name, "load")
    if text.lstrip().startswith("{"):
        return _json(text, name)
    header, columns = _csv(text, name, "load")
    if "flow" not in header or "method" not in header:
        raise ParameterError(f"load: {name!r} is no result: it has no lines `# flow: ...` and `# method: ...` above "
                             "its columns")
    return Stored(header, _rows(columns))


def read_csv(path: Any, name: str) -> tuple[dict[str, Any], dict[str, list[Any]]]:
    """Return header {key: value} of the lines `# key: value`, and columns {name: values}, None where a cell is empty.

    A column is of numbers, or, where one cell is no number, of texts.
    """
    path = check_file_name(path, f"{name}: path")
    return _csv(_text(_bytes(path, name), path, name), path, name)


def _bytes(path, name):
    try:
        return Path(path).read_bytes()
    except OSError as reason:
        raise ParameterError(f"{name}: cannot read {path!r}: {reason.strerror}") from None


def _text(content, path, name):
    try:
        return content.decode("utf-8").removeprefix(_MARK)
    except UnicodeDecodeError:
        raise ParameterError(f"{name}: {path!r} is neither text nor netCDF 3") from None


def _rows(columns):
    return tuple(dict(zip(columns, values, strict=True)) for values in zip(*columns.values(), strict=True))


# -- CSV -------------------------------------------------------------------------------------------------


def _csv(text, path, name):
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


def _one(cell):
    return _typed([cell])[0]


def _typed(cells):
    """The cells of a column as integers, floats, lists or texts, whichever all of them are; None where one is empty."""
    for kind in (int, float, _list):
        try:
            return [None if cell.strip() == "" else _no_nan(kind(cell)) for cell in cells]
        except ValueError:
            continue
    return list(cells)


def _no_nan(value):
    return None if isinstance(value, float) and isnan(value) else value


def _list(cell):
    if not cell.startswith("["):
        raise ValueError(cell)
    return json.loads(cell)


# -- JSON ------------------------------------------------------------------------------------------------


def _json(text, path):
    try:
        content = json.loads(text)
    except ValueError as reason:
        raise ParameterError(f"load: {path!r} is no JSON: {reason}") from None
    if not isinstance(content, dict) or not isinstance(content.get("rows"), list) or "flow" not in content:
        raise ParameterError(f"load: {path!r} is no result: it has no flow and rows")
    header = _infinite({key: value for key, value in content.items() if key != "rows"})
    parameters = _infinite(header.pop("parameters", {}))
    first = {key: header.pop(key) for key in ("flow", "method", "version") if key in header}
    return Stored({**first, **parameters, **header}, tuple(_infinite(row) for row in content["rows"]))


def _infinite(values):
    """JSON has no infinity: it is written as a string."""
    return {key: _INFINITE.get(value, value) if isinstance(value, str) else value for key, value in values.items()}


# -- netCDF ----------------------------------------------------------------------------------------------


def _netcdf(content):
    from scipy.io import netcdf_file  # slow to import

    with netcdf_file(io.BytesIO(content), mmap=False) as file:
        header = {_RENAMED.get(key, key): _scalar(value) for key, value in file._attributes.items()
                  if key not in _OF_FILE}
        variables = {name: _variable(variable) for name, variable in file.variables.items()}
    if "flow" not in header:
        raise ParameterError("load: the netCDF file is no result: it has no attribute flow")
    if "notes" in header:
        header["notes"] = header["notes"].split("\n")
    shapes = [dimensions for dimensions, _ in variables.values() if _LIST not in dimensions]
    main = max(shapes, key=len)
    return Stored(header, _rows(_columns(variables, main)))


def _columns(variables, main):
    """Columns as long as the table: those along one axis of a grid are repeated over the others."""
    places = {name: values.tolist() for name, (dimensions, values) in variables.items() if dimensions == (name,)}
    columns: dict[str, list[Any]] = {}
    lists: dict[str, list[Any]] = {}
    for name, (dimensions, values) in variables.items():
        if name.endswith(_PARTS) and all(name[:-len(_PARTS[0])] + part in variables for part in _PARTS):
            continue  # complex numbers, which a table does not show
        if _LIST in dimensions:
            lists[name] = values.tolist()
        elif dimensions == main:
            columns[name] = [_no_nan(value) for value in values.ravel().tolist()]
        elif len(main) > 1:
            grid = product(*(places[axis] for axis in main))
            columns[name] = [point[main.index(name)] for point in grid]
    if not lists and "k_max" in columns and "maxima" not in columns:
        return _before_last(columns, "maxima", [[] for _ in columns["k_max"]])  # none has any
    if lists:
        prefix, = {name.partition("_")[0] for name in lists}
        pairs = [[[first, second] for first, second in zip(*both, strict=True) if not isnan(first)]
                 for both in zip(*lists.values(), strict=True)]
        columns = _before_last(columns, prefix, pairs)
    return columns


def _before_last(columns, name, values):
    """The columns with one more before the status."""
    *others, last = columns.items()
    return {**dict(others), name: values, last[0]: last[1]} if last[0] == "status" else {**columns, name: values}


def _variable(variable):
    """Dimensions and values; of texts without that of their characters."""
    values = variable[:]
    if values.dtype.kind != "S":
        return variable.dimensions, np.array(values)
    texts = [b"".join(text).rstrip(b"\0").decode() for text in values.reshape(-1, values.shape[-1])]
    return variable.dimensions[:-1], np.array(texts, dtype=object).reshape(values.shape[:-1])


def _scalar(value):
    if isinstance(value, bytes):
        return value.decode()
    return float(np.asarray(value).ravel()[0])
