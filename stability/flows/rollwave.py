"""Roll waves in granular flow down an inclined plane (Forterre 2006; Cawthorn's thesis, section 4.0)."""

from dataclasses import dataclass
from fractions import Fraction
from math import atan, degrees, radians, sqrt, tan
from typing import TYPE_CHECKING, Any, ClassVar

from ..equations.layer import Layer, Profile
from ..errors import ParameterError
from ..numerics.angles import tan_deg
from .base import parameter
from .granular import Granular
from .laws import Saturating

if TYPE_CHECKING:
    import numpy as np


@dataclass(frozen=True)
class RollWave(Granular):
    """Down-slope perturbations exp(i k x + sigma t) of mu(I) flow, mu = (mu1 I0 + mu2 I)/(I0 + I), on a rough plane.

    The base flow is U = (2/3)(1 - (1-z)^{3/2}); the friction law enters through mu = tan(slope) and
    e0 = I mu'(I) = (mu2 - mu)(mu - mu1)/(mu2 - mu1), thesis (4.16). Any friction law may take its place,
    `law=Regularised(...)`: the inertial number is uniform.

    Source: Forterre (2006); thesis, section 4.1. Scales: see `scales`. Raises ParameterError for a parameter outside
    its range.

    >>> from stability import dispersion
    >>> print(f"{dispersion(RollWave(), 1e-5).phase_speed[0]:.6f}")  # 5/2 of the mean speed 2/5
    1.000000
    """

    friction = Saturating
    unit: ClassVar[dict[str, float]] = {"I0": 1.0}
    name: ClassVar[str] = "rollwave"
    title: ClassVar[str] = "roll waves in granular flow down an inclined plane"
    scales: ClassVar[str] = ("length: depth h of the layer; velocity: I(tan slope) sqrt(phi g h cos slope) h/d; "
                             "time: h over velocity; Fr2: velocity^2 / (g h cos slope), thesis (4.6); "
                             "Forterre's Froude number, mean speed / sqrt(g h cos slope): 0.4 sqrt(Fr2)")
    surfaces: ClassVar[tuple[str, ...]] = ("s0",)

    slope_deg: float = parameter(28.0, 0, 90, look=(1.0, 89.0), symbol=r"\alpha",
                                 meaning="inclination of the plane, degrees, between those of mu1 and mu2")
    Fr2: float = parameter(4.0, 0, look=(1e-3, 1e3), symbol=r"\mathrm{Fr}^2",
                           meaning="squared Froude number, thesis (4.6)")
    mu1: float = parameter(tan(radians(20.9)), 0, look=(0.05, 2.0), meaning="friction at rest")
    mu2: float = parameter(tan(radians(32.76)), 0, look=(0.05, 2.0), meaning="friction of rapid flow")

    def __post_init__(self) -> None:
        super().__post_init__()
        low, high = self.law.range
        if not low < self.mu < high:
            ends = "atan(mu1) and atan(mu2)" if self.friction is Saturating else f"the ends of law {self.law.name}"
            raise ParameterError(f"{self.name}: slope_deg must lie between {ends}, "
                                 f"({degrees(atan(low)):g}, {degrees(atan(high)):g}): "
                                 f"no steady flow elsewhere (got {self.slope_deg:g})")

    def layers(self, names: Any) -> tuple[Layer]:
        return (Layer("grains", lambda s: profile(s, self.mu, self.e0, self.Fr2)),)

    def conditions(self, edges: Any, names: Any) -> tuple[Any, ...]:
        """No slip on the plane; no stress on the displaced surface, where the base shear stress is -mu s0."""
        s0 = names.s0
        wall, surface = edges.grains
        return (
            wall.v,
            wall.w,
            surface.t + 1j * self.mu * s0,
            surface.n + s0,
            (names.rate + 2j / 3) * s0 - surface.w,
        )

    def long_wave(self, k: "np.ndarray") -> "np.ndarray":
        """sigma = -i k: waves of 5/2 of the mean speed."""
        return -1j * k

    def state(self, layer: Any, z: Any, base: Any) -> Any:
        """Pressure 1 - z; the inertial number is uniform, I / I0 = (mu - mu1) / (mu2 - mu)."""
        return {**super().state(layer, z, base), "pressure": 1 - z, "inertial_number": self.inertial_number}

    def remarks(self) -> Any:
        return ["inertial_number in units of I0 of the friction law"] if self.unit else []

    @property
    def inertial_number(self) -> Any:
        """In units of I0 where that is no parameter."""
        return float(self.law.inverse(self.mu))

    @property
    def mu(self) -> float:
        return float(tan_deg(self.slope_deg))

    @property
    def e0(self) -> float:
        """I mu'(I); of the saturating law (mu2 - mu)(mu - mu1)/(mu2 - mu1) without cancellation."""
        if self.friction is not Saturating:
            return self.inertial_number * float(self.law.slope(self.inertial_number))
        mu, mu1, mu2 = tan_deg(self.slope_deg), Fraction(self.mu1), Fraction(self.mu2)
        return float((mu2 - mu) * (mu - mu1) / (mu2 - mu1))

    @property
    def froude(self) -> Any:
        """Forterre's Froude number: mean speed over sqrt(g h cos slope)."""
        return 0.4 * sqrt(self.Fr2)


def profile(s: "np.ndarray", mu: float, e0: float, Fr2: float) -> Profile:
    """Base state in zeta = sqrt(1 - z) = 1 - s: every coefficient of the equations is a polynomial."""
    zeta = 1 - s
    return Profile(dz=2 * zeta, rho=Fr2, U=2 * (1 - zeta**3) / 3, dU=zeta, eta=mu * zeta, beta=e0 * zeta,
                   alpha=mu - e0 / 2)
