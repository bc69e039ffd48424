"""What may be asked for, by name and number, and whether it makes sense together: known before anything is imported."""

from collections.abc import Collection
from typing import Any

from ..checks import check_options
from ..errors import ParameterError

MODES = ("surface", "leading", "most-unstable")  # of `dispersion`
CREST_MODES = ("surface", "leading")  # of `k_max`
QUANTITIES = ("k_max", "growth_rate", "neutral")  # of a map
HEIGHTS, MOST_HEIGHTS = 41, 100_000  # heights of a layer: usual, largest number
MOST_MODES = 200  # modes that can be asked for
MOST_WORKERS = 1000
_MOST_AXES = 3


def usual_quantity(k: Any, vary: Any) -> str:
    """The quantity of a map that is meant where none is named."""
    return "neutral" if vary is not None else "k_max" if k is None else "growth_rate"


def check_quantity(quantity: Any, axes: Collection[str], k: Any, vary: Any) -> str:
    """Return the quantity of a map over parameters, or raise a ParameterError where it contradicts k and `vary`."""
    quantity = check_options("quantity", quantity, QUANTITIES)
    if not 1 <= len(axes) <= _MOST_AXES:
        raise ParameterError(f"over: a map has one to {_MOST_AXES} swept parameters (got {len(axes)})")
    for name, value, owner, meaning in (("k", k, "growth_rate", "wavenumbers"),
                                        ("vary", vary, "neutral", "a parameter to solve for")):
        if (value is not None) != (quantity == owner):
            raise ParameterError(f"{name}: " + (f"quantity {quantity} takes none, only {owner} does"
                                                if value is not None else f"quantity {owner} needs {meaning}"))
    if vary in axes:
        raise ParameterError(f"vary: {vary} is the parameter to solve for; sweep another one")
    return quantity
