"""Results as the tables of other packages, which are imported only when asked for."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .record import Record


def to_pandas(record: "Record") -> Any:
    """Return the rows as a DataFrame, missing numbers as nan; its `attrs` are the header."""
    pandas = _package("pandas", "to_pandas")
    frame = pandas.DataFrame(record.rows())
    for name, values in record.columns().items():
        if name in frame and values.dtype.kind in "fi" and values.ndim == 1 and len(values) == len(frame):
            frame[name] = values  # missing numbers as nan, not as objects
    frame.attrs.update(record.header())
    return frame


def to_xarray(record: "Record") -> Any:
    """Return the variables and attributes of the netCDF file as a Dataset."""
    from .netcdf import attributes_of, variables_of

    xarray = _package("xarray", "to_xarray")
    variables = {name: (dimensions, values, about) for name, dimensions, values, about in variables_of(record)}
    places = {name: variables.pop(name) for name in [*variables] if name in record.dimensions}
    return xarray.Dataset(variables, coords=places, attrs=attributes_of(record))


def _package(name: str, method: str) -> Any:
    try:
        return import_module(name)
    except ModuleNotFoundError as reason:
        if reason.name != name:
            raise
        raise ModuleNotFoundError(f"{method}: {name} is not installed; install it with: pip install {name}",
                                  name=name) from None
