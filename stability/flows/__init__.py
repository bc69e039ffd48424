"""The flows, by name."""

from .base import Flow
from .couette import Couette
from .dune import Dune
from .film import Film
from .poiseuille import Poiseuille
from .rollwave import RollWave
from .shear import Shear
from .two_layer_couette import TwoLayerCouette
from .vortex import Vortex

FLOWS = {flow.name: flow for flow in (Vortex, Dune, RollWave, Film, TwoLayerCouette, Poiseuille, Couette, Shear)}

__all__ = ["FLOWS", "Couette", "Dune", "Film", "Flow", "Poiseuille", "RollWave", "Shear", "TwoLayerCouette", "Vortex"]
