"""Plane Poiseuille flow: pressure-driven flow between two plates (Orszag 1971)."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

from ..equations.layer import Layer, Profile
from .base import Flow, parameter

if TYPE_CHECKING:
    import numpy as np

    from ..equations.forms import Form


@dataclass(frozen=True)
class Poiseuille(Flow):
    """Perturbations exp(i k x + sigma t) of U = 1 - z^2 between plates at z = -1 and z = 1: Orr-Sommerfeld.

    $$ (U - c) (w'' - k^2 w) - U'' w = (w'''' - 2 k^2 w'' + k^4 w) / (i k Re) $$

    Source: Orszag (1971). Scales: see `scales`. Raises ParameterError for a parameter outside its range.

    >>> from stability import spectrum
    >>> print(f"{spectrum(Poiseuille(Re=1e4), 1.0, 1).modes[0].c:.8f}")
    0.23752649+0.00373967j
    """

    name: ClassVar[str] = "poiseuille"
    title: ClassVar[str] = "plane Poiseuille flow between two plates"
    scales: ClassVar[str] = ("length: half the distance of the plates; velocity: on the centreline; "
                             "Re: half-width * centreline speed / kinematic viscosity")
    bottom: ClassVar[float] = -1.0

    Re: float = parameter(1e4, 0, look=(10.0, 1e5), meaning="Reynolds number of half-width and centreline speed")

    def layers(self, names: Any) -> tuple[Layer]:
        return (Layer("fluid", lambda s: profile(s, self.Re)),)

    def conditions(self, edges: Any, names: Any) -> "tuple[Form, ...]":
        """No slip."""
        bottom, top = edges.fluid
        return bottom.v, bottom.w, top.v, top.w

    def halves(self) -> Any:
        """Modes with w even or odd about the centreline; a flow derived from this one stays whole."""
        return (EvenPoiseuille(self.Re), OddPoiseuille(self.Re)) if type(self) is Poiseuille else (self,)


@dataclass(frozen=True)
class EvenPoiseuille(Poiseuille):
    """The modes of plane Poiseuille flow with an even normal velocity (the unstable one is among them)."""

    reflection: ClassVar[int] = 1

    def conditions(self, edges: Any, names: Any) -> "tuple[Form, ...]":
        """No slip, on one plate: what holds there holds on the other one by symmetry."""
        _, top = edges.fluid
        return top.v, top.w

    def halves(self) -> Any:
        return (self,)


@dataclass(frozen=True)
class OddPoiseuille(EvenPoiseuille):
    """The modes of plane Poiseuille flow with an odd normal velocity."""

    reflection: ClassVar[int] = -1


def profile(s: "np.ndarray", Re: float) -> Profile:
    """U = 1 - z^2 for -1 <= z <= 1."""
    z = 2 * s - 1
    return Profile(dz=2.0, U=1 - z**2, dU=-2 * z, eta=1 / Re, beta=1 / Re)
