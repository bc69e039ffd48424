"""Pressure-driven flow between two plates of which one moves."""

from dataclasses import dataclass
from typing import ClassVar

from stability.flows import Flow, Layer, Profile, parameter


@dataclass(frozen=True)
class CouettePoiseuille(Flow):
    """Perturbations exp(i k x + sigma t) of U = 1 - z^2 + speed (1 + z) / 2 between plates at z = -1 and z = 1."""

    name: ClassVar[str] = "couette_poiseuille"
    title: ClassVar[str] = "plane Couette-Poiseuille flow"
    scales: ClassVar[str] = "length: half the distance of the plates; velocity: of the pressure-driven part"
    bottom: ClassVar[float] = -1.0

    Re: float = parameter(1e4, 0, look=(1e3, 1e5), meaning="Reynolds number")
    speed: float = parameter(0.1, meaning="velocity of the upper plate")

    def layers(self, names):
        def profile(s):
            z = 2 * s - 1
            return Profile(dz=2.0, U=1 - z**2 + self.speed * (1 + z) / 2, eta=1 / self.Re, beta=1 / self.Re)

        return (Layer("fluid", profile),)

    def conditions(self, edges, names):
        lower, upper = edges.fluid
        return lower.v, lower.w, upper.v, upper.w
