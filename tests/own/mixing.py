"""The shear layer between two streams, in unbounded fluid."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from stability.flows import Flow, Layer, Profile, parameter

CLUSTER = 0.1  # of the heights at the centre


@dataclass(frozen=True)
class Tanh(Flow):
    """Perturbations of U = tanh z; beyond the cuts the fluid moves without vorticity."""

    name: ClassVar[str] = "tanh"
    title: ClassVar[str] = "shear layer between two streams"
    scales: ClassVar[str] = "length: of U = tanh z; velocity: half the difference of the streams; Re: of both"
    wavenumber: ClassVar[float] = 0.4

    Re: float = parameter(100.0, 0, look=(1.0, 1e3), meaning="Reynolds number")
    cut: float = parameter(30.0, 0, meaning="height at which the domain is cut, above and below")

    @property
    def bottom(self):
        return -self.cut

    def layers(self, names):
        def profile(s):
            x = 2 * s - 1
            z = self.cut * (CLUSTER * x + (1 - CLUSTER) * x**3)
            return Profile(dz=2 * self.cut * (CLUSTER + 3 * (1 - CLUSTER) * x**2), U=np.tanh(z),
                           eta=1 / self.Re, beta=1 / self.Re)

        return (Layer("fluid", profile),)

    def conditions(self, edges, names):
        k, (low, high) = names.k, edges.fluid
        shear = 2 / self.Re * k**2
        return low.v - k * low.w, low.t - shear * low.w, high.v + k * high.w, high.t - shear * high.w
