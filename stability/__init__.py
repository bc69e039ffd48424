"""Linear stability of granular and viscous shear flows: spectra with error bars.

>>> from stability import dispersion, flows
>>> relation = dispersion(flows.Vortex(slope_deg=30.0, Fr2=0.1), [2.0])
>>> f"{relation.growth_rate[0]:.8f}"
'-0.45293027'
"""

__version__ = "0.1.0"

from importlib import import_module
from typing import TYPE_CHECKING, Any

from .errors import ModeLost, NotResolved, ParameterError, StabilityError

if TYPE_CHECKING:
    from . import flows
    from .maps import parameter_map
    from .mode import Mode
    from .neutral import critical, neutral_curve
    from .optimum import Optimum, k_max
    from .reading import load
    from .relation import DispersionRelation, dispersion
    from .sensitivity import sensitivities
    from .spectra import Spectrum, spectrum

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
    "load",
    "neutral_curve",
    "parameter_map",
    "sensitivities",
    "spectrum",
]

_LATER = {
    "DispersionRelation": "relation", "Mode": "mode", "Optimum": "optimum", "Spectrum": "spectra",
    "critical": "neutral", "dispersion": "relation", "flows": "flows", "k_max": "optimum", "load": "reading",
    "neutral_curve": "neutral",
    "parameter_map": "maps", "sensitivities": "sensitivity", "spectrum": "spectra",
}


def __getattr__(name: str) -> Any:
    """Import what is asked for: the commands begin at once, and can be interrupted while they import."""
    if name not in _LATER:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    module = import_module(f".{_LATER[name]}", __name__)
    return module if name == "flows" else getattr(module, name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
