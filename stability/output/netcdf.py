"""A result as a netCDF 3 file: every column a variable along the dimension of the result, self-describing."""

import io
from collections.abc import Iterator
from dataclasses import fields
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.io import netcdf_file

from .columns import SCALES, column, known

if TYPE_CHECKING:
    from .record import Record

CONVENTION = ("normal mode exp(i k x + sigma t): positive growth_rate = Re sigma is unstable; "
              "c = i sigma / k, positive phase_speed = Re c is downstream")
_RENAMED = {"mode": "mode_followed"}  # scipy's file object has an attribute `mode` of its own


def encode(record: "Record") -> bytes:
    """Return the content of the file."""
    buffer = io.BytesIO()
    with netcdf_file(buffer, "w") as file:
        for name, value in attributes_of(record).items():
            setattr(file, _RENAMED.get(name, name), _attribute(value))
        for variable in variables_of(record):
            _add(file, *variable)
        file.flush()
        return buffer.getvalue()


def attributes_of(record: "Record") -> dict[str, Any]:
    """Return what belongs to the whole file: title, parameters, header, scales and convention."""
    header = record.header()
    return {"title": f"{type(record).__name__} of {record.flow.title}", **header.pop("parameters"),
            **{name: "\n".join(value) if name == "notes" else value for name, value in header.items()},
            "scales": f"{record.flow.scales}; {SCALES}", "convention": CONVENTION}


def variables_of(record: "Record") -> Iterator[tuple[str, tuple[str, ...], np.ndarray, dict[str, str]]]:
    """Yield name, dimensions, values and attributes of every variable; complex columns are two of them."""
    for name, values in record.columns().items():
        for part, numbers in _real(name, values):
            own = (part,) if part in record.dimensions else record.dimensions
            units = {} if numbers.dtype.kind == "U" else {"units": "1"}  # in `scale`, from the scales of the file
            dimensions = (*own, "maximum")[:numbers.ndim]
            yield part, dimensions, numbers, {**_about(record, name, part), **units}


def _attribute(value: Any) -> Any:
    """Text as bytes in UTF-8, numbers in double precision: the writer would take single."""
    return value.encode() if isinstance(value, str) else np.float64(value)


def _real(name: str, values: np.ndarray) -> list[tuple[str, np.ndarray]]:
    if not np.iscomplexobj(values):
        return [(name, values)]
    return [(f"{name}_real", values.real), (f"{name}_imag", values.imag)]


def _about(record: "Record", name: str, part: str) -> dict[str, str]:
    """The attributes of a variable: parameters explain themselves, other columns are explained in `columns`."""
    parameters = {item.name: item.metadata["meaning"] for item in fields(record.flow)}
    if name in parameters:
        meaning, scale = parameters[name], ""
    elif known(name):
        meaning, scale = column(name, "map", record.bounded)
    else:
        meaning, scale = name, ""
    long_name = meaning if part == name else f"{meaning}, {'real' if part.endswith('real') else 'imaginary'} part"
    return {"long_name": long_name, **({"scale": scale} if scale else {})}


def _add(file: netcdf_file, name: str, dimensions: tuple[str, ...], values: np.ndarray, about: dict[str, str]) -> None:
    """Add a variable; texts have one more dimension, of their characters."""
    if values.dtype.kind == "U":
        values, dimensions = _characters(values), (*dimensions, f"{name}_length")
    for dimension, length in zip(dimensions, values.shape, strict=True):
        if dimension not in file.dimensions:
            file.createDimension(dimension, length)
    variable = file.createVariable(name, {"f": "d", "i": "i", "S": "c"}[values.dtype.kind], dimensions)
    variable[:] = values
    variable.long_name = about["long_name"].encode()
    if values.dtype.kind == "S":
        variable._Encoding = b"utf-8"
    for key in ("units", "scale"):
        if key in about:
            setattr(variable, key, about[key].encode())


def _characters(texts: np.ndarray) -> np.ndarray:
    encoded = np.char.encode(texts, "utf-8")
    width = max(1, encoded.dtype.itemsize)
    return encoded.astype(f"S{width}").view("S1").reshape(*texts.shape, width)
