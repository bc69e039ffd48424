"""Longitudinal vortices in granular flow down an inclined plane (Cawthorn's thesis, section 4.1)."""

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from ..equations.layer import Layer, Profile
from ..numerics.angles import tan_deg
from .base import Flow, parameter


@dataclass(frozen=True)
class Vortex(Flow):
    """Cross-slope perturbations exp(i k y + sigma t) of mu(I) flow down a rough plane.

    The fourth-order subsystem (4.14), (4.15), (4.17), (4.19)-(4.21). The down-slope velocity (4.13),
    (4.18) is slaved to it: it adds no surface mode and feeds nothing back, so it is left out, and the
    friction law enters through mu = tan(slope) alone. All coefficients are real.

    Source: Cawthorn's thesis, section 4.1. Scales: see `scales`. Raises ParameterError for a parameter outside its
    range.

    >>> from stability import dispersion
    >>> f"{dispersion(Vortex(slope_deg=30.0, Fr2=0.1), 2.0).growth_rate[0]:.12f}"  # 30-digit power series
    '-0.452930272740'
    """

    name: ClassVar[str] = "vortex"
    title: ClassVar[str] = "longitudinal vortices in granular flow down an inclined plane"
    scales: ClassVar[str] = ("length: depth h of the layer; velocity: I(tan slope) sqrt(phi g h cos slope) h/d; "
                             "time: h over velocity; Fr2: velocity^2 / (g h cos slope), thesis (4.6)")
    order: ClassVar[int] = 1
    decays: ClassVar[bool] = True  # nothing feeds the energy of motion and raised surface
    surfaces: ClassVar[tuple[str, ...]] = ("s0",)

    slope_deg: float = parameter(30.0, 0, 90, look=(1.0, 89.0), symbol=r"\alpha",
                                 meaning="inclination of the plane, degrees")
    Fr2: float = parameter(0.1, 0, look=(1e-3, 1e3), symbol=r"\mathrm{Fr}^2",
                           meaning="squared Froude number, thesis (4.6)")

    def layers(self, names: Any) -> tuple[Layer]:
        return (Layer("grains", lambda s: profile(s, self.mu, self.Fr2)),)

    def conditions(self, edges: Any, names: Any) -> tuple[Any, ...]:
        """No slip on the plane; no stress on the displaced surface, which moves with the grains."""
        wall, surface = edges.grains
        return (
            wall.v,
            wall.w,
            surface.t,
            surface.n + names.s0,
            names.rate * names.s0 - surface.w,
        )

    def long_wave(self, k: np.ndarray) -> np.ndarray:
        """sigma = -2 k^2 / (5 tan slope), thesis (4.25)."""
        return -2 * k**2 / (5 * self.mu)

    def state(self, layer: Any, z: Any, base: Any) -> Any:
        """The flow down the slope, U = (2/3) (1 - (1 - z)^{3/2}) as in `rollwave`; the perturbations do not feel it."""
        zeta = np.sqrt(np.maximum(1 - z, 0))
        return {"U": 2 * (1 - zeta**3) / 3, "dU": zeta, "shear_stress": self.mu * zeta**2, "pressure": zeta**2}

    def remarks(self) -> Any:
        return ["U, dU: down the slope; the inertial number is uniform, that at which mu(I) = tan slope"]

    @property
    def mu(self) -> float:
        return float(tan_deg(self.slope_deg))


def profile(s: np.ndarray, mu: float, Fr2: float) -> Profile:
    """Base state in zeta = sqrt(1 - z) = 1 - s: every coefficient of the equations is a polynomial.

    Effective and tangent viscosity across the slope are both mu p / shear rate = mu sqrt(1 - z).
    """
    zeta = 1 - s
    return Profile(dz=2 * zeta, rho=Fr2, eta=mu * zeta, beta=mu * zeta)
