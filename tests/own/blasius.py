"""The boundary layer on a plate, taken as parallel."""

from dataclasses import dataclass
from functools import lru_cache
from typing import ClassVar

import numpy as np
from scipy.integrate import quad, solve_ivp

from stability.flows import Flow, Layer, Profile, parameter

WALL = 0.46959998836101330451  # f''(0) of f''' + f f'' = 0, f' = 1 far away: Blasius 1908
EDGE = 10.0  # in units of the similarity variable: there f' = 1 to 1e-19


@lru_cache(maxsize=1)
def similarity():
    """The solution f, f', f'', and the displacement thickness, in units of the similarity variable."""
    found = solve_ivp(lambda _, f: (f[1], f[2], -f[0] * f[2]), (0, EDGE), (0, 0, WALL), "DOP853", dense_output=True,
                      rtol=1e-13, atol=1e-15).sol
    return found, quad(lambda x: 1 - found(x)[1], 0, EDGE, epsabs=1e-13)[0]


@dataclass(frozen=True)
class Blasius(Flow):
    """Perturbations exp(i k x + sigma t) of the similarity solution, as if it did not change downstream."""

    name: ClassVar[str] = "blasius"
    title: ClassVar[str] = "boundary layer on a plate"
    scales: ClassVar[str] = "length: displacement thickness; velocity: of the free stream; Re: of both"
    wavenumber: ClassVar[float] = 0.3

    Re: float = parameter(1000.0, 0, look=(100.0, 5e3), meaning="Reynolds number of the displacement thickness")
    cut: float = parameter(12.0, 6, meaning="height at which the domain is cut", reason="the layer ends at 6")

    def layers(self, names):
        f, thickness = similarity()

        def profile(s):
            x = np.minimum(self.cut * s * thickness, EDGE)
            return Profile(dz=self.cut, U=f(x)[1], eta=1 / self.Re, beta=1 / self.Re)

        return (Layer("fluid", profile),)

    def conditions(self, edges, names):
        wall, far = edges.fluid
        k = names.k
        return wall.v, wall.w, far.v + k * far.w, far.t - 2 / self.Re * k**2 * far.w
