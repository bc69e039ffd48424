"""Two liquids between sliding plates: the instability due to viscosity stratification (Yih 1967)."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

from ..equations.layer import Layer, Profile
from .base import Flow, parameter

if TYPE_CHECKING:
    import numpy as np


@dataclass(frozen=True)
class TwoLayerCouette(Flow):
    """Perturbations exp(i k x + sigma t) of two liquids sheared by the upper plate, -n <= z <= 0 and 0 <= z <= 1.

    With viscosity ratio m and depth ratio n (lower over upper) the shear rates are 1/(m+n) below and
    m/(m+n) above the interface, which moves at n/(m+n).

    Source: Yih (1967); Charru and Hinch (2000). Scales: see `scales`. Raises ParameterError for a parameter outside its
    range.

    >>> from stability import dispersion
    >>> flow = TwoLayerCouette()
    >>> bool(abs(dispersion(flow, 1e-4).sigma[0] / flow.long_wave(1e-4) - 1) < 1e-3)
    True
    """

    name: ClassVar[str] = "two_layer_couette"
    title: ClassVar[str] = "two liquids in plane Couette flow"
    scales: ClassVar[str] = ("length: depth of the upper liquid; velocity: of the upper plate, the lower is at rest; "
                             "Re: length * velocity / kinematic viscosity of the upper liquid; "
                             "ratios: lower liquid over upper; gravity: g * length / velocity^2; "
                             "tension: surface tension / (density of the upper liquid * velocity^2 * length)")
    surfaces: ClassVar[tuple[str, ...]] = ("s0",)

    viscosity_ratio: float = parameter(2.0, 0, look=(0.02, 50.0),
                                       meaning="viscosity of the lower liquid over that of the upper")
    depth_ratio: float = parameter(1.0, 0, look=(0.05, 20.0),
                                   meaning="depth of the lower liquid over that of the upper")
    density_ratio: float = parameter(1.0, 0, closed=True, look=(0.1, 10.0),
                                     meaning="density of the lower liquid over that of the upper")
    Re: float = parameter(10.0, 0, look=(0.1, 1e4), meaning="Reynolds number of the upper liquid and the plate speed")
    gravity: float = parameter(0.0, 0, closed=True, look=(1e-3, 1e2),
                               meaning="g * depth / speed^2 of the upper liquid and plate")
    tension: float = parameter(0.0, 0, closed=True, look=(1e-3, 1e2),
                               meaning="surface tension / (density * speed^2 * depth)")

    @property
    def bottom(self) -> Any:  # type: ignore[override]
        return -self.depth_ratio

    def layers(self, names: Any) -> tuple[Layer, Layer]:
        m, n = self.viscosity_ratio, self.depth_ratio
        return (
            Layer("lower", lambda s: profile(s, n, 0.0, 1 / (m + n), m, self.density_ratio, self.Re),
                  steady=self.density_ratio == 0),
            Layer("upper", lambda s: profile(s, 1.0, self.interface_speed, m / (m + n), 1.0, 1.0, self.Re)),
        )

    def state(self, layer: Any, z: Any, base: Any) -> Any:
        """Pressure of the weight above, in units of the density of the upper liquid times the squared plate speed."""
        above = -self.density_ratio * z if layer == "lower" else -z
        return {**super().state(layer, z, base), "pressure": self.gravity * (1 + above)}

    def conditions(self, edges: Any, names: Any) -> tuple[Any, ...]:
        """No slip; velocities and stresses meet on the displaced interface, which moves with the liquids.

        The jump of the shear rate displaces the velocity, that of the density and surface tension the pressure.
        """
        m, n, s0 = self.viscosity_ratio, self.depth_ratio, names.s0
        wall, below = edges.lower
        above, plate = edges.upper
        stiffness = self.Re * ((self.density_ratio - 1) * self.gravity + self.tension * names.k**2)
        return (
            wall.v,
            wall.w,
            above.v - below.v - 1j * (m - 1) / (m + n) * s0,
            above.w - below.w,
            above.t - below.t,
            above.n - below.n - stiffness * s0,
            (names.rate + 1j * self.interface_speed) * s0 - below.w,
            plate.v,
            plate.w,
        )

    def long_wave(self, k: "np.ndarray") -> "np.ndarray":
        """sigma = -i k (n/(m+n) + c0) with Yih's (1967) c0, relative to the interface."""
        m, n = self.viscosity_ratio, self.depth_ratio
        c0 = 2 * m * n**2 * (m - 1) * (n + 1) / ((m + n) * (m**2 + 4 * m * n**3 + 6 * m * n**2 + 4 * m * n + n**4))
        return -1j * k * (self.interface_speed + c0)

    @property
    def interface_speed(self) -> float:
        return self.depth_ratio / (self.viscosity_ratio + self.depth_ratio)


def profile(s: "np.ndarray", depth: float, speed: float, shear_rate: float, viscosity: float, density: float,
            Re: float) -> Profile:
    """Linear shear above the speed at s = 0; stresses in units of those of the upper liquid at unit shear rate."""
    U = speed + shear_rate * depth * s
    return Profile(dz=depth, U=U, dU=shear_rate, rho=density * Re, eta=viscosity, beta=viscosity, stress=1 / Re)
