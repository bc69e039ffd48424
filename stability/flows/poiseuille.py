"""Plane Poiseuille flow: pressure-driven flow between two plates (Orszag 1971)."""

from dataclasses import dataclass
from typing import ClassVar

from ..layer import Layer, Profile
from .base import Flow, parameter


@dataclass(frozen=True)
class Poiseuille(Flow):
    """Perturbations exp(i k x + sigma t) of U = 1 - z^2 between plates at z = -1 and z = 1: Orr-Sommerfeld."""

    name: ClassVar[str] = "poiseuille"
    title: ClassVar[str] = "plane Poiseuille flow between two plates"
    scales: ClassVar[str] = ("length: half the distance of the plates; velocity: on the centreline; "
                             "Re: half-width * centreline speed / kinematic viscosity")

    Re: float = parameter(1e4, 0, meaning="Reynolds number of half-width and centreline speed")

    def layers(self, names):
        return (Layer("fluid", lambda s: profile(s, self.Re)),)

    def conditions(self, edges, names):
        """No slip."""
        bottom, top = edges.fluid
        return bottom.v, bottom.w, top.v, top.w


def profile(s, Re):
    z = 2 * s - 1
    return Profile(dz=2.0, U=1 - z**2, dU=-2 * z, eta=1 / Re, beta=1 / Re)
