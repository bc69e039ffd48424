"""The flows, by name."""

from .base import Flow
from .couette import Couette
from .dune import Dune
from .film import Film
from .poiseuille import Poiseuille
from .rollwave import RollWave
from .two_layer_couette import TwoLayerCouette
from .vortex import Vortex

FLOWS = {flow.name: flow for flow in (Vortex, Dune, RollWave, Film, TwoLayerCouette, Poiseuille, Couette)}

__all__ = ["FLOWS", "Couette", "Dune", "Film", "Flow", "Poiseuille", "RollWave", "TwoLayerCouette", "Vortex"]
