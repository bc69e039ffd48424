"""The Bickley jet in unbounded fluid."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from stability.flows import Flow, Layer, Profile, parameter

CLUSTER = 0.1  # of the heights at the centreline


@dataclass(frozen=True)
class Bickley(Flow):
    """Sinuous perturbations of U = sech^2 z: w is even, so that u and n vanish on the centreline z = 0.

    The fluid above the cut moves without vorticity: what viscosity makes there decays like exp(-lambda z),
    lambda^2 = k^2 + Re sigma.
    """

    name: ClassVar[str] = "bickley"
    title: ClassVar[str] = "plane jet, sinuous modes"
    scales: ClassVar[str] = "length: of U = sech^2 z; velocity: on the centreline; Re: of both"
    wavenumber: ClassVar[float] = 0.2

    Re: float = parameter(10.0, 0, look=(1.0, 100.0), meaning="Reynolds number of length and centreline velocity")
    cut: float = parameter(100.0, 0, meaning="height at which the domain is cut")

    def layers(self, names):
        def profile(s):
            z = self.cut * (CLUSTER * s + (1 - CLUSTER) * s**3)
            return Profile(dz=self.cut * (CLUSTER + 3 * (1 - CLUSTER) * s**2), U=1 / np.cosh(z) ** 2,
                           eta=1 / self.Re, beta=1 / self.Re)

        return (Layer("fluid", profile),)

    def conditions(self, edges, names):
        centreline, far = edges.fluid
        k = names.k
        return centreline.v, centreline.n, far.v + k * far.w, far.t - 2 / self.Re * k**2 * far.w
