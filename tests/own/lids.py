"""The Bickley jet between lids without stress, as briefly as it can be written."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from stability.flows import Flow, Layer, Profile, parameter


@dataclass(frozen=True)
class Jet(Flow):
    """Perturbations of U = sech^2 z between lids at z = -10 and z = 10: w = 0, no shear stress."""

    name: ClassVar[str] = "jet_between_lids"
    bottom: ClassVar[float] = -10.0

    Re: float = parameter(100.0, 0, meaning="Reynolds number")

    def layers(self, names):
        return (Layer("fluid", lambda s: Profile(dz=20.0, U=np.cosh(20 * s - 10) ** -2, eta=1 / self.Re,
                                                 beta=1 / self.Re)),)

    def conditions(self, edges, names):
        low, high = edges.fluid
        return low.w, low.t, high.w, high.t
