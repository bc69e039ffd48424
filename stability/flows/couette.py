"""Plane Couette flow: two plates sliding past each other."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

from ..equations.layer import Layer, Profile
from .base import Flow, parameter

if TYPE_CHECKING:
    import numpy as np

    from ..equations.forms import Form


@dataclass(frozen=True)
class Couette(Flow):
    """Perturbations exp(i k x + sigma t) of U = z between plates at z = -1 and z = 1: Orr-Sommerfeld.

    Reflection in the centre turns the mode of wave speed c into that of -conj(c): modes come in pairs.

    $$ (U - c) (w'' - k^2 w) - U'' w = (w'''' - 2 k^2 w'' + k^4 w) / (i k Re) $$

    Source: the Orr-Sommerfeld equation; values recomputed in multi-precision. Scales: see `scales`. Raises
    ParameterError for a parameter outside its range.

    >>> from stability import spectrum
    >>> mode = spectrum(Couette(Re=1000.0), 1.0, 1).modes[0]  # one of a pair
    >>> f"{abs(mode.c.real):.12f} {mode.c.imag:.12f}"
    '0.605342996005 -0.119230198438'
    """

    name: ClassVar[str] = "couette"
    title: ClassVar[str] = "plane Couette flow between two plates"
    scales: ClassVar[str] = ("length: half the distance of the plates; velocity: half their difference in speed; "
                             "Re: half-width * half the speed difference / kinematic viscosity")
    bottom: ClassVar[float] = -1.0

    Re: float = parameter(1000.0, 0, look=(10.0, 1e4),
                          meaning="Reynolds number of half-width and half the wall speed difference")

    def layers(self, names: Any) -> tuple[Layer]:
        return (Layer("fluid", lambda s: profile(s, self.Re)),)

    def conditions(self, edges: Any, names: Any) -> "tuple[Form, Form, Form, Form]":
        """No slip."""
        bottom, top = edges.fluid
        return bottom.v, bottom.w, top.v, top.w


def profile(s: "np.ndarray", Re: float) -> Profile:
    return Profile(dz=2.0, U=2 * s - 1, dU=1.0, eta=1 / Re, beta=1 / Re)
