"""A result as a netCDF 3 file: every column a variable along the dimension of the result, self-describing."""

import io
from collections.abc import Iterator
from dataclasses import fields
from typing import Any

import numpy as np
from scipy.io import netcdf_file

from .record import Record

CONVENTION = ("normal mode exp(i k x + sigma t): positive growth_rate = Re sigma is unstable; "
              "c = i sigma / k, positive phase_speed = Re c is downstream")
MEANINGS = {
    "k": "wavenumber",
    "k_max": "wavenumber of the largest growth rate",
    "growth_rate": "real part of the complex growth rate sigma",
    "phase_speed": "real part of the complex wave speed i sigma / k",
    "sigma": "complex growth rate",
    "slope": "derivative of sigma with respect to k",
    "degree": "Chebyshev degree",
    "condition": "condition number of the eigenvalue in the energy norm",
    "status": "resolved, or what failed",
    "parameter": "parameter of the flow, or k",
    "value": "value of the parameter",
    "d_growth_rate": "derivative of the growth rate with respect to the parameter",
    "d_phase_speed": "derivative of the phase speed with respect to the parameter",
    "elasticity": "relative change of the growth rate per relative change of the parameter",
    "growth_error": "bound of the absolute error of sigma",
    "k_error": "bound of the absolute error of k",
    "growth_data_error": "standard error of the growth rate from the errors of the measured base flow",
    "maxima": "number of local maxima of the growth rate",
    "second_k_max": "wavenumber of the second largest maximum of the growth rate",
    "second_growth_rate": "growth rate of the second largest maximum",
    "maxima_k": "wavenumbers of all local maxima of the growth rate",
    "maxima_growth_rate": "growth rates of all local maxima",
}

_RENAMED = {"mode": "mode_followed"}  # scipy's file object has an attribute `mode` of its own


def encode(record: Record) -> bytes:
    """Return the content of the file."""
    buffer = io.BytesIO()
    with netcdf_file(buffer, "w") as file:
        for name, value in attributes_of(record).items():
            setattr(file, _RENAMED.get(name, name), _plain(value))
        for variable in variables_of(record):
            _add(file, *variable)
        file.flush()
        return buffer.getvalue()


def attributes_of(record: Record) -> dict[str, Any]:
    """Return what belongs to the whole file: title, parameters, header, scales and convention."""
    header = record.header()
    return {"title": f"{type(record).__name__} of {record.flow.title}", **header.pop("parameters"),
            **{name: "\n".join(value) if name == "notes" else value for name, value in header.items()},
            "scales": record.flow.scales, "convention": CONVENTION}


def variables_of(record: Record) -> Iterator[tuple[str, tuple[str, ...], np.ndarray, dict[str, str]]]:
    """Yield name, dimensions, values and attributes of every variable; complex columns are two of them."""
    for name, values in record.columns().items():
        for part, numbers in _real(name, values):
            own = (part,) if part in record.dimensions else record.dimensions
            units = {} if numbers.dtype.kind == "U" else {"units": "1"}  # the scales are an attribute of the file
            dimensions = (*own, "maximum")[:numbers.ndim]
            yield part, dimensions, numbers, {"long_name": _meaning(record, name, part), **units}


def _plain(value: Any) -> Any:
    """Text as bytes in UTF-8, numbers in double precision: the writer would take single."""
    return value.encode() if isinstance(value, str) else np.float64(value)


def _real(name: str, values: np.ndarray) -> list[tuple[str, np.ndarray]]:
    if not np.iscomplexobj(values):
        return [(name, values)]
    return [(f"{name}_real", values.real), (f"{name}_imag", values.imag)]


def _meaning(record: Record, name: str, part: str) -> str:
    parameters = {item.name: item.metadata["meaning"] for item in fields(record.flow)}
    of = "the growth rate" if record.bounded == "sigma" else record.bounded
    meaning = {**parameters, **MEANINGS, "error": f"bound of the absolute error of {record.bounded}",
               "data_error": f"standard error of {of} from that of the measured base flow"}.get(name, name)
    return meaning if part == name else f"{meaning}, {'real' if part.endswith('real') else 'imaginary'} part"


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
    else:
        variable.units = about["units"].encode()


def _characters(texts: np.ndarray) -> np.ndarray:
    encoded = np.char.encode(texts, "utf-8")
    width = max(1, encoded.dtype.itemsize)
    return encoded.astype(f"S{width}").view("S1").reshape(*texts.shape, width)
