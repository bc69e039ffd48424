"""Results read back from the files that were written of them: CSV, JSON or netCDF, known by their content."""

import io
import json
from itertools import product
from math import isnan
from typing import Any

import numpy as np

from ..checks import check_file_name
from ..errors import ParameterError
from ..status import status_of
from .csv_text import no_nan, parse_csv, read_bytes, text_of
from .stored import Stored

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
    content = read_bytes(name, "load")
    if content.startswith(_NETCDF):
        return _netcdf(content)
    text = text_of(content, name, "load")
    if text.lstrip().startswith("{"):
        return _json(text, name)
    header, columns = parse_csv(text, name, "load")
    if "flow" not in header or "method" not in header:
        raise ParameterError(f"load: {name!r} is no result: it has no lines `# flow: ...` and `# method: ...` above "
                             "its columns")
    return Stored(header, _rows(columns))


def _rows(columns: Any) -> Any:
    rows = (dict(zip(columns, values, strict=True)) for values in zip(*columns.values(), strict=True))
    return tuple(map(_told, rows))


def _told(row: Any) -> Any:
    """A row with its status as one, not as a text."""
    return {**row, "status": status_of(row["status"])} if isinstance(row.get("status"), str) else row


# -- JSON ------------------------------------------------------------------------------------------------


def _json(text: Any, path: Any) -> Any:
    try:
        content = json.loads(text)
    except ValueError as reason:
        raise ParameterError(f"load: {path!r} is no JSON: {reason}") from None
    if not isinstance(content, dict) or not isinstance(content.get("rows"), list) or "flow" not in content:
        raise ParameterError(f"load: {path!r} is no result: it has no flow and rows")
    header = _infinite({key: value for key, value in content.items() if key != "rows"})
    parameters = _infinite(header.pop("parameters", {}))
    first = {key: header.pop(key) for key in ("flow", "method", "version") if key in header}
    return Stored({**first, **parameters, **header}, tuple(_told(_infinite(row)) for row in content["rows"]))


def _infinite(values: Any) -> Any:
    """JSON has no infinity: it is written as a string."""
    return {key: _INFINITE.get(value, value) if isinstance(value, str) else value for key, value in values.items()}


# -- netCDF ----------------------------------------------------------------------------------------------


def _netcdf(content: Any) -> Any:
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


def _columns(variables: Any, main: Any) -> Any:
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
            columns[name] = [no_nan(value) for value in values.ravel().tolist()]
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


def _before_last(columns: Any, name: Any, values: Any) -> Any:
    """The columns with one more before the status."""
    *others, last = columns.items()
    return {**dict(others), name: values, last[0]: last[1]} if last[0] == "status" else {**columns, name: values}


def _variable(variable: Any) -> Any:
    """Dimensions and values; of texts without that of their characters."""
    values = variable[:]
    if values.dtype.kind != "S":
        return variable.dimensions, np.array(values)
    texts = [b"".join(text).rstrip(b"\0").decode() for text in values.reshape(-1, values.shape[-1])]
    return variable.dimensions[:-1], np.array(texts, dtype=object).reshape(values.shape[:-1])


def _scalar(value: Any) -> Any:
    if isinstance(value, bytes):
        return value.decode()
    return float(np.asarray(value).ravel()[0])
