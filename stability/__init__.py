"""Linear stability of granular and viscous shear flows: spectra with error bars.

>>> from stability import dispersion, flows
>>> relation = dispersion(flows.Vortex(slope_deg=30.0, Fr2=0.1), [2.0])
>>> f"{relation.growth_rate[0]:.8f}"
'-0.45293027'
"""

__version__ = "0.1.0"

from . import flows
from .errors import ModeLost, NotResolved, ParameterError, StabilityError
from .mode import Mode
from .optimum import Optimum, k_max
from .relation import DispersionRelation, dispersion
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
    "dispersion",
    "flows",
    "k_max",
    "spectrum",
]
