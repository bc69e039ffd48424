"""The flows, by name, and all that a flow of one's own is written with.

    from stability.flows import Flow, Layer, Profile, choice, parameter
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from .catalogue import FLOWS, find, register

if TYPE_CHECKING:
    from ..equations.layer import Layer, Profile
    from .annulus import Annulus
    from .base import Flow, choice, parameter
    from .chute import Chute
    from .couette import Couette
    from .dune import Dune
    from .film import Film
    from .law import Law
    from .laws import Linear, PowerLaw, Regularised, Saturating
    from .poiseuille import Poiseuille
    from .rollwave import RollWave
    from .shear import Shear
    from .steady import Pile, PlaneShear, Plate
    from .two_layer_couette import TwoLayerCouette
    from .vortex import Vortex

__all__ = ["FLOWS", "Annulus", "Chute", "Couette", "Dune", "Film", "Flow", "Law", "Layer", "Linear", "Pile",
           "PlaneShear", "Plate", "Poiseuille", "PowerLaw", "Profile", "Regularised", "RollWave", "Saturating", "Shear",
           "TwoLayerCouette", "Vortex", "choice", "find", "parameter", "register"]

_LATER = {
    "Annulus": ".annulus", "Chute": ".chute", "Pile": ".steady", "PlaneShear": ".steady", "Plate": ".steady",
    "Couette": ".couette", "Dune": ".dune", "Film": ".film", "Flow": ".base", "Law": ".law",
    "Layer": "..equations.layer", "Linear": ".laws", "PowerLaw": ".laws", "Regularised": ".laws", "Saturating": ".laws",
    "Poiseuille": ".poiseuille", "Profile": "..equations.layer", "RollWave": ".rollwave", "Shear": ".shear",
    "TwoLayerCouette": ".two_layer_couette", "Vortex": ".vortex", "choice": ".base", "parameter": ".base",
}


def __getattr__(name: str) -> Any:
    """Import what is asked for: the command line knows the names of the flows before it needs any numerics."""
    if name not in _LATER:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(_LATER[name], __name__), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
