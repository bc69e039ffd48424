"""Linear stability of granular and viscous shear flows: spectra with error bars.

>>> from stability import dispersion, flows
>>> relation = dispersion(flows.Vortex(slope_deg=30.0, Fr2=0.1), [2.0])
>>> f"{relation.growth_rate[0]:.8f}"
'-0.45293027'
"""

__version__ = "0.1.0"

from importlib import import_module
from typing import TYPE_CHECKING, Any

from . import flows
from .errors import ModeLost, NotResolved, ParameterError, StabilityError
from .mode import Mode
from .optimum import Optimum, k_max
from .relation import DispersionRelation, dispersion
from .spectra import Spectrum, spectrum

if TYPE_CHECKING:
    from .maps import parameter_map
    from .neutral import critical, neutral_curve
    from .sensitivity import sensitivities

__all__ = [
    "DispersionRelation",
    "Mode",
    "ModeLost",
    "NotResolved",
    "Optimum",
    "ParameterError",
    "Spectrum",
    "StabilityError",
    "critical",
    "dispersion",
    "flows",
    "k_max",
    "neutral_curve",
    "parameter_map",
    "sensitivities",
    "spectrum",
]

_LATER = {"critical": "neutral", "neutral_curve": "neutral", "parameter_map": "maps", "sensitivities": "sensitivity"}


def __getattr__(name: str) -> Any:
    """Import what most uses do without when it is asked for."""
    if name not in _LATER:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f".{_LATER[name]}", __name__), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *_LATER})
