"""Small-parameter expansions of linear stability problems, derived exactly from the nonlinear equations.

>>> from asymptotics import expand
>>> expand("vortex", slope_deg=45, order=2).growth_rate
-2*k**2/5
"""

__version__ = "0.1.0"

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .flows import expand
    from .leading import assert_limit
    from .limits import assert_order
    from .series import Expansion

__all__ = ["Expansion", "assert_limit", "assert_order", "expand"]

_LATER = {"Expansion": "series", "assert_limit": "leading", "assert_order": "limits", "expand": "flows",
          "flows": "flows"}


def __getattr__(name: str) -> Any:
    """Import what is asked for: the command begins at once, and can be interrupted while it imports."""
    if name not in _LATER:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    module = import_module(f".{_LATER[name]}", __name__)
    return module if name == "flows" else getattr(module, name)
