"""The flows, by name."""

from .base import Flow
from .dune import Dune
from .vortex import Vortex

FLOWS = {flow.name: flow for flow in (Vortex, Dune)}

__all__ = ["FLOWS", "Dune", "Flow", "Vortex"]
