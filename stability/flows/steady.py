"""Steady granular shear flows of the thesis's chapter 2 under any friction law: plates and pile.

Stresses in equilibrium fix friction mu = (shear stress)/(pressure), the law the inertial number, and this the shear
rate U' = I sqrt(p); the velocity follows by quadrature to rounding. beta = p mu' I/U' and alpha = mu - I mu'/2.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import atan, degrees
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ..equations.layer import Layer, Profile
from ..numerics.angles import tan_deg
from . import bed as beds
from .base import parameter
from .equilibrium import Equilibrium, Saturated, Steady, sheared_layers

if TYPE_CHECKING:
    from ..equations.forms import Form


@dataclass(frozen=True)
class PlaneShear(Saturated):
    """Perturbations exp(i k x + sigma t) of grains sheared between rigid plates without gravity, U = z: thesis (2.1).

    Pressure and shear rate are uniform, and so are all coefficients. u = w = 0 on the plates.

    Scales: see `scales`. Raises ParameterError for a parameter outside its range.

    >>> from stability.studies.base import base_flow
    >>> base_flow(PlaneShear(), 3).U.tolist()
    [0.0, 0.5, 1.0]
    """

    name: ClassVar[str] = "plane_shear"
    title: ClassVar[str] = "plane shear of grains between plates, without gravity"
    scales: ClassVar[str] = "length: distance of the plates; velocity: that of the upper plate; stress: pressure"

    inertial: float = parameter(0.1, 0, look=(1e-3, 10.0), meaning="inertial number I: (shear rate) d/sqrt(p/density)")
    inertia: float = parameter(1.0, 0, look=(1e-3, 1e4), meaning="density (plate velocity)^2 / pressure, (I l/d)^2")

    def layers(self, names: Any) -> Any:
        law, number = self.law, self.inertial
        mu, e = float(law.mu(number)), number * float(law.slope(number))
        return (Layer("grains", lambda s: Profile(dz=1.0, rho=self.inertia, U=s, dU=1.0, eta=mu, beta=e,
                                                  alpha=mu - e / 2)),)

    def conditions(self, edges: Any, names: Any) -> "tuple[Form, Form, Form, Form]":
        lower, upper = edges.grains
        return lower.v, lower.w, upper.v, upper.w

    def state(self, layer: Any, z: Any, base: Any) -> Any:
        return {**super().state(layer, z, base), "pressure": 1.0, "inertial_number": self.inertial}


@dataclass(frozen=True)
class Plate(Saturated):
    """Perturbations exp(i k x + sigma t) of grains under a rough heavy plate that is dragged along: thesis (2.35).

    The same base flow as the bed of `dune`, in units of the depth of grains z0 that weighs as much as the plate. The
    plate is rigid: a wave displaces it neither up nor along, u = w = 0 at z = 0. At the yield surface w = 0: where it
    moves is of second order, as U' = 0 there. Under a law without yield stress a rigid floor holds the creeping bed.

    Scales: see `scales`. Raises ParameterError for a parameter outside its range.

    >>> from stability.studies.base import base_flow
    >>> profiles = base_flow(Plate(), 3)
    >>> float(profiles.U[0]), bool(profiles.U[2] > 0)
    (0.0, True)
    """

    name: ClassVar[str] = "plate"
    title: ClassVar[str] = "grains under a dragged heavy plate"
    scales: ClassVar[str] = ("length: z0 = plate pressure / (density g); velocity: z0 sqrt(g z0) / d, in the thesis "
                             "I0 times that; stress: plate pressure")

    shields: float = parameter(1.2, 1, look=(1.01, 20.0), meaning="shear stress on the plate over yield stress there",
                               reason="at or below 1 the bed does not yield")
    grains: float = parameter(10.0, 0, look=(1.0, 1e3), meaning="z0 in grain diameters; inertia is its square")

    def __post_init__(self) -> None:
        super().__post_init__()
        beds.check(self.law, self.name, self.shields)

    @classmethod
    def extras(cls, law: Any) -> Any:
        return beds.creep_parameter(law, surface="plate")

    @property
    def _pieces(self) -> Any:
        return beds.pieces(self.law, self.shields, getattr(self, "creep", 0.0))

    @property
    def bottom(self) -> float:  # type: ignore[override]
        return beds.lowest(self.law, self.shields, getattr(self, "creep", 0.0))

    def layers(self, names: Any) -> Any:
        return beds.layers(self.law, self.shields, getattr(self, "creep", 0.0), self.grains**2)

    def conditions(self, edges: Any, names: Any) -> "tuple[Form, Form, Form]":
        plate = edges.bed[1]
        return *beds.below(edges, len(self._pieces), self.law.yields), plate.v, plate.w

    def state(self, layer: str, z: np.ndarray, base: Profile) -> dict[str, Any]:
        return {"U": base.U, "dU": base.dU, "shear_stress": self.law.rest * self.shields, "pressure": 1 - z,
                "inertial_number": base.dU / np.sqrt(1 - z)}

    def remarks(self) -> list[str]:
        kind = "yield surface" if self.law.yields else "rigid floor"
        return [f"{kind} at z = {self.bottom:.10g}", f"plate velocity {self._pieces[-1].top:.10g}"]


@dataclass(frozen=True)
class Pile(Steady):
    """Flow on a deep pile between side walls, averaged across: mu(I) = tan(slope) - mu_wall h, h the depth: (2.28).

    Without yield stress grains creep, and a rigid floor holds them where the inertial number has fallen to `creep` of
    that at the surface.

    Scales: see `scales`. A base flow alone: waves raise ParameterError, as do parameters outside their range.

    >>> from stability.studies.base import base_flow
    >>> float(base_flow(Pile(), 3).U[0])  # at rest below
    0.0
    """

    name: ClassVar[str] = "pile"
    title: ClassVar[str] = "flow on a deep pile between side walls"
    scales: ClassVar[str] = ("length: width W between the walls; velocity: W sqrt(g cos(slope) W) / d; "
                             "stress: density g cos(slope) W")
    why: ClassVar[str] = ("friction of the side walls turns with the motion of a wave and rises with its pressure, "
                          "forces that the layers here lack")

    slope_deg: float = parameter(28.0, 0, 90, look=(1.0, 89.0), meaning="inclination of the surface, degrees")
    mu_wall: float = parameter(0.3, 0, look=(0.01, 2.0), meaning="friction coefficient of the side walls")

    def __post_init__(self) -> None:
        super().__post_init__()
        low, high = self.law.range
        self._within("slope_deg", self.mu, low, high, f"({degrees(atan(low)):.6g}, {degrees(atan(high)):.6g})")

    @property
    def mu(self) -> float:
        return float(tan_deg(self.slope_deg))

    @classmethod
    def extras(cls, law: Any) -> Any:
        return beds.creep_parameter(law, "floor of the pile", "surface", "inertial number")

    @property
    def slowest(self) -> float:
        """Friction where the grains are at rest, or on the floor."""
        creep = getattr(self, "creep", 0.0)
        return self.law.start if self.law.yields else float(self.law.mu(creep * self.law.inverse(self.mu)))

    @property
    def depth(self) -> float:
        """Of the flowing layer."""
        return (self.mu - self.slowest) / self.mu_wall

    @property
    def bottom(self) -> float:  # type: ignore[override]
        return -self.depth

    def layers(self, names: Any) -> Any:
        self.base_only(names)
        law = self.law
        inner = sorted((one for one in ((self.mu - float(law.mu(number))) / self.mu_wall for number in law.breaks)
                        if 0 < one < self.depth), reverse=True)
        ends = [self.depth, *inner, 0.0]
        names = [f"pile_{number}" for number in range(len(ends) - 1, 1, -1)] + ["pile"]
        return tuple(sheared_layers(law, [(name, self._part(low, high)) for name, low, high in
                                          zip(names, ends, ends[1:], strict=False)]))

    def _part(self, low: float, high: float) -> Callable[..., Any]:
        """In root = sqrt(depth): the surface is a smooth end of the velocity then."""
        law, start, end = self.law, np.sqrt(low), np.sqrt(high)

        def state(s: np.ndarray) -> Equilibrium:
            root = end + (start - end) * (1 - s)
            above = (start - end) * s * (start + root) + (self.depth - low)  # height above the bottom
            inertial = law.beyond(self.mu_wall * above + (self.slowest - law.start))
            stress = (self.mu - self.mu_wall * root**2) * root**2
            return Equilibrium(2 * (start - end) * root, root**2, stress, inertial)

        return state

    def state(self, layer: str, z: np.ndarray, base: Profile) -> dict[str, np.ndarray]:
        depth = np.maximum(-z, 0)
        mu = self.mu - self.mu_wall * depth
        return {"U": base.U, "dU": base.dU, "shear_stress": mu * depth, "pressure": depth,
                "inertial_number": self.law.beyond(np.maximum(mu - self.law.start, 0))}

    def remarks(self) -> list[str]:
        return [f"depth of the flowing layer {self.depth:.10g}",
                f"surface velocity {float(self.layers(None)[-1].profile(np.array([1.0])).U[0]):.10g}"]
