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
    from .modes.mode import Mode
    from .output.reading import load
    from .studies.critical import critical
    from .studies.dispersion import DispersionRelation, dispersion
    from .studies.kmax import Optimum, k_max
    from .studies.map import parameter_map
    from .studies.neutral import neutral_curve
    from .studies.sensitivity import sensitivities
    from .studies.spectrum import Spectrum, spectrum

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
    "DispersionRelation": "studies.dispersion",
    "Mode": "modes.mode",
    "Optimum": "studies.kmax",
    "Spectrum": "studies.spectrum",
    "critical": "studies.critical",
    "dispersion": "studies.dispersion",
    "flows": "flows",
    "k_max": "studies.kmax",
    "load": "output.reading",
    "neutral_curve": "studies.neutral",
    "parameter_map": "studies.map",
    "sensitivities": "studies.sensitivity",
    "spectrum": "studies.spectrum",
}


def __getattr__(name: str) -> Any:
    """Import what is asked for: the commands begin at once, and can be interrupted while they import."""
    if name not in _LATER:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    module = import_module(f".{_LATER[name]}", __name__)
    return module if name == "flows" else getattr(module, name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
