"""Growth of dunes: a mu(I) granular bed sheared by a viscous fluid (Cawthorn's thesis, section 4.2)."""

from dataclasses import dataclass
from math import inf, isinf, sqrt
from typing import Any, ClassVar

import numpy as np

from ..equations.layer import Layer, Profile
from . import bed as beds
from . import wavy_wall
from .base import choice, parameter
from .granular import Granular
from .law import Law
from .laws import Linear


@dataclass(frozen=True)
class Dune(Granular):
    """Perturbations exp(i k x + sigma t) of a granular bed under a fluid in linear shear.

    The bed (4.64)-(4.70) flows between its yield surface z = 1 - shields and the interface z = 0. The
    fluid (4.59)-(4.63) adjusts at once to the shape of the bed, as over a rigid wall. It enters by the
    closed form of its wall stress, or (`fluid="layer"`) as a second layer of the same eigenproblem.

    Any friction law may take the place of (4.48): `law=Saturating(...)`, see `stability.flows.laws`. Where it has no
    yield stress, a rigid floor holds the creeping bed.

    Source: Cawthorn's thesis, section 4.2. Scales: see `scales`. Raises ParameterError for a parameter outside its
    range.

    >>> from stability import dispersion
    >>> print(f"{dispersion(Dune(), 1.0).sigma[0]:.12f}")  # 30-digit Frobenius series
    0.234339971634-1.009151053991j
    """

    name: ClassVar[str] = "dune"
    title: ClassVar[str] = "dunes on a granular bed sheared by a viscous fluid"
    scales: ClassVar[str] = ("length: grain diameter d; time: sqrt(d/g'); granular velocity: sqrt(g' d); "
                             "Re: fluid shear rate * d^2 / viscosity; depth: fluid depth / d")
    surfaces: ClassVar[tuple[str, ...]] = ("s0",)

    shields: float = parameter(2.0, 1, look=(1.01, 20.0), symbol=r"\theta",
                               meaning="fluid shear stress over the yield stress of the bed, thesis (4.54)",
                               reason="at or below 1 the bed does not yield")
    mu1: float = parameter(0.4, 0, look=(0.05, 2.0), meaning="static friction coefficient, thesis (4.48)")
    b: float = parameter(1.0, 0, look=(0.05, 20.0), meaning="rate coefficient of friction mu1 (1 + b I), thesis (4.48)")
    Re: float = parameter(10.0, 0, look=(1e-3, 1e4),
                          meaning="Reynolds number of the fluid on the grain scale, thesis (4.39)")
    depth: float = parameter(inf, 0, look=(0.1, 1e3), symbol="h",
                             meaning="fluid depth in grain diameters; inf: unbounded fluid", unbounded=True)
    fluid: str = choice("closed-form", "layer", meaning="wall stress in closed form, or a second layer")

    def __post_init__(self) -> None:
        super().__post_init__()
        if not self._linear:
            beds.check(self.law, self.name, self.shields)

    @classmethod
    def extras(cls, law: type[Law]) -> dict[Any, Any]:
        return beds.creep_parameter(law)

    @property
    def functions(self) -> Any:  # type: ignore[override]
        if self.fluid == "closed-form":
            return ("R",)
        return ("H",) if isinf(self.depth) else ()

    @property
    def bottom(self) -> float:  # type: ignore[override]
        return beds.lowest(self.law, self.shields, self._creep)

    def evaluate(self, k: np.ndarray) -> dict[Any, Any]:
        if self.fluid == "closed-form":
            response = wavy_wall.response(k, self.Re, self.depth)
            return {"R": (response.value, response.derivative, response.error)}
        return {"H": _vorticity_depth(k, self.Re)} if isinf(self.depth) else {}

    def layers(self, names: Any) -> tuple[Any, ...]:
        if self._linear:
            bed: tuple[Layer, ...] = (
                Layer("bed", lambda s: bed_profile(s, self._excess, self.mu1, self.b), singular=1),)
        else:
            bed = beds.layers(self.law, self.shields, self._creep)
        if self.fluid == "closed-form":
            return bed
        height = names.H if isinf(self.depth) else self.depth
        return *bed, Layer("fluid", lambda s: fluid_profile(s, height, self.Re), steady=True)

    def conditions(self, edges: Any, names: Any) -> tuple[Any, ...]:
        """No flow below the yield surface; pressure of a monolayer and fluid stress on the moving interface."""
        k, s0 = names.k, names.s0
        surface, stress = edges.bed[1], self._stress
        normal_strain = 2 * k * stress * surface.v  # p + n: 2 eta times the strain rate
        bed = (
            *self._below(edges),
            normal_strain - surface.n - s0,
            (names.rate + 1j * self._surface_speed) * s0 - surface.w,
        )
        if self.fluid == "closed-form":
            return (*bed, surface.t - 1j * stress * names.R * s0)
        wall, top = edges.fluid
        return (*bed, surface.t - stress * wall.t, wall.v - 1j * s0, wall.w, *self._far(top, k))

    def _below(self, edges: Any) -> tuple[Any, ...]:
        """No flow at the yield surface, no slip on a floor; all is continuous where the slope of the law jumps."""
        if self._linear:
            return (edges.bed[0].w,)
        return beds.below(edges, len(self._pieces), self.law.yields)

    def _far(self, top: Any, k: float) -> tuple[float, ...]:
        """No slip on a lid; irrotational decay exp(-k z) above the vorticity of an unbounded fluid."""
        if isinf(self.depth):
            return top.v + k * top.w, top.t - 2 * k**2 * top.w
        return top.v, top.w

    def long_wave(self, k: np.ndarray) -> np.ndarray:
        """sigma = i k (2 shields / 3 b) (r - 1)^2 (r + 2) R, r = sqrt(shields): thesis (4.81), (4.84) for any R.

        Under any law sigma = i k shields dQ/d(shields) R: the bed adapts at once to the stress shields (1 - R s0), and
        its flux Q to its bed; over a floor it flows faster where it is higher, too.
        """
        response = wavy_wall.response(k, self.Re, self.depth).value
        if not self._linear:
            slope, over_floor = beds.flux_slopes(self.law, self.shields, self._creep)
            return 1j * k * (self.shields * slope * response - over_floor)
        return 2j * k * self.shields / (3 * self.b) * self._excess**2 * (self._excess + 3) * response

    def state(self, layer: str, z: np.ndarray, base: Profile) -> dict[str, Any]:
        """In the bed the shear stress is uniform and the pressure the weight above; I from the friction law (4.48)."""
        if layer == "fluid":
            return super().state(layer, z, base)
        pressure = 1 - z
        inertial = np.maximum(self.shields / pressure - 1, 0) / self.b if self._linear else base.dU / np.sqrt(pressure)
        return {**super().state(layer, z, base), "shear_stress": self._stress, "pressure": pressure,
                "inertial_number": inertial}

    def remarks(self) -> list[str]:
        bottom = f"yield surface at z = {self.bottom:.10g}: no flow below" if self.law.yields else \
            f"no yield stress: rigid floor at z = {self.bottom:.10g}"
        return [bottom,
                f"interface at z = 0, velocity {self._surface_speed:.10g}"]

    @property
    def _linear(self) -> bool:
        return self.friction is Linear

    @property
    def _stress(self) -> float:
        """Shear stress on the bed, in units of the pressure on it."""
        return self.mu1 * self.shields if self._linear else self.law.rest * self.shields

    @property
    def _creep(self) -> float:
        return getattr(self, "creep", 0.0)

    @property
    def _pieces(self) -> Any:
        return beds.pieces(self.law, self.shields, self._creep)

    @property
    def _excess(self) -> float:
        """sqrt(shields) - 1 without cancellation."""
        return (self.shields - 1) / (sqrt(self.shields) + 1)

    @property
    def _surface_speed(self) -> float:
        if not self._linear:
            return self._pieces[-1].top
        return 2 * self._excess**2 * (2 * self._excess + 3) / (3 * self.b)


def bed_profile(s: np.ndarray, excess: float, mu1: float, b: float) -> Profile:
    """Base state in zeta = sqrt(1 - z), from r = sqrt(shields) = 1 + excess at the yield surface to 1.

    Velocity gradient (r^2 - zeta^2) / (b zeta), thesis (4.52), pressure zeta^2, friction law (4.48). The
    velocity is u = U' v, so that the equations have a regular singular point at the yield surface.
    """
    r = 1 + excess
    depth = excess * s  # r - zeta
    zeta = r - depth
    shear_rate = depth * (r + zeta) / (b * zeta)
    return Profile(
        dz=2 * excess * zeta,
        U=2 * depth**2 * (3 * r - depth) / (3 * b),
        dU=shear_rate,
        eta=mu1 * r**2 / shear_rate,
        beta=mu1 * b * zeta,
        alpha=mu1 * (r**2 + zeta**2) / (2 * zeta**2),
        g=shear_rate,
        dg=excess * (r**2 + zeta**2) / (b * zeta**2),
        clear=zeta**2,
    )


def fluid_profile(s: np.ndarray, height: float, Re: float) -> Profile:
    """Newtonian fluid in linear shear U = z, 0 <= z <= height; stresses in units of the base shear stress."""
    return Profile(dz=height, U=height * s, dU=1.0, rho=Re, eta=1.0, beta=1.0, stress=1 / Re)


def _vorticity_depth(k: Any, Re: Any) -> Any:
    """Height above which the vorticity over a wavy wall is below rounding, and its slope in k.

    The vorticity is an Airy function: it decays like exp(-k z) and like exp(-(sqrt(2)/3) |f z|^{3/2}),
    |f|^3 = k Re; either exponent reaches 40 at the height returned.
    """
    a, c = k / 50, (k * Re) ** (1 / 3) / 25
    height = (a**3 + c**3) ** (-1 / 3)
    slope = -(height**4) * (a**3 + c**3 / 3) / k
    return height, slope, np.zeros_like(height)
