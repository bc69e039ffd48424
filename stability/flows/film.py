"""A liquid film falling down an inclined plane (Benjamin 1957, Yih 1963)."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

from ..equations.layer import Layer, Profile
from ..numerics.angles import cot_deg
from .base import Flow, parameter

if TYPE_CHECKING:
    import numpy as np


@dataclass(frozen=True)
class Film(Flow):
    """Perturbations exp(i k x + sigma t) of U = 2 z - z^2 on 0 <= z <= 1: Orr-Sommerfeld with a free surface.

    Steady flow fixes gravity in these scales: its component down the slope is 2/Re, across it 2 cot(slope)/Re.

    $$ (U - c) (w'' - k^2 w) - U'' w = (w'''' - 2 k^2 w'' + k^4 w) / (i k Re) $$

    Source: Yih (1963), Benjamin (1957). Scales: see `scales`. Raises ParameterError for a parameter outside its range.

    >>> from stability import dispersion
    >>> f"{dispersion(Film(), 1e-5).phase_speed[0]:.6f}"  # twice the surface speed
    '2.000000'
    """

    name: ClassVar[str] = "film"
    title: ClassVar[str] = "liquid film falling down an inclined plane"
    scales: ClassVar[str] = ("length: depth of the film; velocity: at its surface; "
                             "Re: depth * surface speed / kinematic viscosity, 3/2 of the one on the mean speed; "
                             "We: surface tension / (density * surface speed^2 * depth)")
    surfaces: ClassVar[tuple[str, ...]] = ("s0",)

    Re: float = parameter(10.0, 0, look=(1e-3, 2e4), meaning="Reynolds number of depth and surface speed")
    slope_deg: float = parameter(30.0, 0, 180, look=(5e-3, 175.0), symbol=r"\alpha",
                                 meaning="inclination of the plane, degrees; beyond 90 the film hangs")
    We: float = parameter(0.0, 0, closed=True, look=(1e-5, 1e3),
                          meaning="surface tension / (density * surface speed^2 * depth)")

    def layers(self, names: Any) -> tuple[Layer]:
        return (Layer("liquid", lambda s: profile(s, self.Re)),)

    def conditions(self, edges: Any, names: Any) -> tuple[Any, ...]:
        """No slip on the plane; on the displaced surface no shear stress and the pressure of surface tension.

        The base stresses there are s0 times their slopes across the film, -2 and -2 cot(slope) in viscous units.
        """
        s0 = names.s0
        wall, surface = edges.liquid
        return (
            wall.v,
            wall.w,
            surface.t + 2j * s0,
            surface.n + (2 * self.cot_slope + self.Re * self.We * names.k**2) * s0,
            (names.rate + 1j) * s0 - surface.w,
        )

    def long_wave(self, k: "np.ndarray") -> "np.ndarray":
        """sigma = -2 i k: waves of twice the surface speed, Yih (1963)."""
        return -2j * k

    def state(self, layer: Any, z: Any, base: Any) -> Any:
        """Pressure of the weight across the film, 2 cot(slope) (1 - z) / Re."""
        return {**super().state(layer, z, base), "pressure": 2 * self.cot_slope * (1 - z) / self.Re}

    @property
    def cot_slope(self) -> float:
        return float(cot_deg(self.slope_deg))


def profile(s: "np.ndarray", Re: float) -> Profile:
    """Stresses in viscous units, viscosity * surface speed / depth."""
    return Profile(dz=1.0, U=2 * s - s**2, dU=2 - 2 * s, rho=Re, eta=1.0, beta=1.0, stress=1 / Re)
