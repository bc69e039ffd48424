"""Grains that fall between rough vertical walls, in the middle as a plug: thesis (2.16), and waves in a shear zone.

The pressure is uniform (Janssen), p = plug/rest, and the shear stress x, the distance from the middle: mu(I) = rest
x/plug. A wave exp(i k X + sigma t) along the walls finds the plug rigid. A rigid strip that has no end can be carried
along but neither bent nor turned, and what a wave does to it adds up to nothing over a wavelength: its velocity stays
that of the base flow. The yield surface, where the rate of strain vanishes, moves to x = plug + s, s = rest p' - t' by
the yield condition; the velocity there, U(plug + s) + u' = U(plug) + O(s^2) + u', stays that of the plug. So u = w = 0
at x = plug, a regular singular point as U' = 0 there. The two shear zones know nothing of each other, and each
eigenvalue of one is that of the other. Gravity is uniform and drops out.

Under a law without yield stress all grains creep; where the shear rate has fallen to a given fraction of that at the
walls they are taken as a rigid core.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import pairwise
from typing import Any, ClassVar

import numpy as np

from ..equations.forms import Form
from ..equations.layer import Layer, Profile
from . import bed as beds
from .base import parameter
from .equilibrium import Equilibrium, Saturated, sheared_layers
from .law import Law


@dataclass(frozen=True)
class Zone:
    """Distances x from the middle, outer > x > inner, at which the law is smooth; `unit` is x over friction."""

    outer: float
    inner: float
    unit: float
    edge: float  # x of the plug

    def at(self, law: Law, s: Any) -> tuple[Any, Any, Any]:
        """x, I and -dx/ds at the points s, from the wall inwards."""
        width = self.outer - self.inner
        beyond = width * (1 - s) + (self.inner - self.edge)
        return self.outer - width * s, law.beyond(beyond / self.unit), width + 0 * s


@dataclass(frozen=True)
class CreepingLayer:
    """The same where the grains creep, by ln I, which falls evenly from `fast` to `slow`."""

    fast: float
    slow: float
    unit: float

    def at(self, law: Law, s: Any) -> tuple[Any, Any, Any]:
        """x, I and -dx/ds at the points s."""
        fall = np.log(self.fast / self.slow)
        inertial = np.clip(self.fast * np.exp(-fall * s), self.slow, np.nextafter(self.fast, 0))  # this side of breaks
        return self.unit * law.mu(inertial), inertial, self.unit * law.slope(inertial) * inertial * fall


@lru_cache(maxsize=256)
def zones(law: Law, plug: float, creep: float) -> "tuple[Zone | CreepingLayer, ...]":
    """The layers from the wall to the plug, or to a rigid core: those of a creeping flow have short series."""
    unit = plug / law.rest
    wall = float(law.inverse(1 / unit))
    if law.yields:
        inner = (unit * float(law.mu(one)) for one in law.breaks)
        ends = [1.0, *sorted((x for x in inner if plug < x < 1), reverse=True), plug]
        return tuple(Zone(outer, inside, unit, plug) for outer, inside in pairwise(ends))
    core = creep * wall
    ends = beds.divided([core, *sorted(one for one in law.breaks if core < one < wall), wall])
    return tuple(CreepingLayer(fast, slow, unit) for fast, slow in pairwise(ends[::-1]))


@dataclass(frozen=True)
class Chute(Saturated):
    """Perturbations exp(i k x + sigma t) of grains that fall between rough vertical walls, in the middle as a plug.

    The pressure is uniform, the shear stress is the distance from the middle. z is that from a wall. A wave moves
    neither plug nor walls, u = w = 0 there, so that the two shear zones have the same modes, each by itself.

    Source: thesis (2.16). Scales: see `scales`. Raises ParameterError for a parameter outside its range, and for waves
    under a law whose friction does not rise linearly from rest.

    >>> from stability.studies.base import base_flow
    >>> float(base_flow(Chute(), 3).shear_stress[0])  # at the wall
    1.0
    """

    name: ClassVar[str] = "chute"
    title: ClassVar[str] = "grains falling between vertical walls, with a plug"
    scales: ClassVar[str] = ("length: half-width L; velocity: L sqrt(g L) / d, in the thesis I0 times that; "
                             "stress: density g L")

    plug: float = parameter(0.8, 0, 1, look=(0.05, 0.99), meaning="half-width W of the plug over that of the chute: "
                            "mu1 pressure / (density g L)", reason="at or above 1 nothing flows")
    grains: float = parameter(10.0, 0, look=(1.0, 1e3), meaning="L in grain diameters; inertia is its square")

    def __post_init__(self) -> None:
        super().__post_init__()
        low, high = self.law.range
        self._within("plug", self.law.rest / self.plug, low, high, f"({self.law.rest / high:.6g}, 1)")

    @classmethod
    def extras(cls, law: Any) -> Any:
        return beds.creep_parameter(law, "core", "wall")

    def layers(self, names: Any) -> Any:
        law, zones = self.law, self._zones
        labels = ["shear" if not number else f"shear_{number + 1}" for number in range(len(zones))]
        found = sheared_layers(law, [(label, self._state(zone)) for label, zone in zip(labels, zones, strict=True)],
                               self.grains**2)
        if not beds.linear_from_rest(law):
            if isinstance(getattr(names, "k", None), Form):
                beds.check_rest(law, self.name)
            return tuple(found)
        return tuple(Layer(one.name, self._weighted(one.profile, zone), int(law.yields and zone is zones[-1]),
                           growth=one.growth)
                     for one, zone in zip(found, zones, strict=True))

    @property
    def _zones(self) -> Any:
        """From the wall to the plug."""
        return zones(self.law, self.plug, getattr(self, "creep", 0.0))

    def _state(self, zone: "Zone") -> Callable[[Any], Equilibrium]:
        law = self.law

        def state(s: np.ndarray) -> Equilibrium:
            x, inertial, stretch = zone.at(law, s)
            return Equilibrium(stretch, zone.unit, x, inertial)

        return state

    def _weighted(self, profile: Callable[[Any], Profile], zone: "Zone") -> Callable[[Any], Profile]:
        """The profile with u = U' v, its shear-rate equation times mu' where the law yields: cf. `bed`."""
        law, root = self.law, np.sqrt(zone.unit)
        scale = float(law.slope(zone.at(law, np.array([0.0]))[1])[0])

        def at(s: np.ndarray) -> Profile:
            base, (_, inertial, stretch) = profile(s), zone.at(law, s)
            with np.errstate(divide="ignore", invalid="ignore"):
                slope = law.slope(inertial)
                dg = -root * stretch / (zone.unit * slope)
            return replace(base, g=base.dU, dg=dg, clear=slope / scale if law.yields else 1.0)

        return at

    def conditions(self, edges: Any, names: Any) -> Any:
        parts = [getattr(edges, "shear" if not number else f"shear_{number + 1}") for number in range(len(self._zones))]
        wall, core = parts[0][0], parts[-1][1]
        return wall.v, wall.w, core.w, *([] if self.law.yields else [core.v]), *beds.joints(parts)

    def state(self, layer: str, z: np.ndarray, base: Profile) -> dict[str, Any]:
        pressure = self.plug / self.law.rest
        return {"U": base.U, "dU": base.dU, "shear_stress": 1 - z, "pressure": pressure,
                "inertial_number": base.dU / np.sqrt(pressure)}

    @property
    def core(self) -> float:
        """Half-width of the plug, or of the rigid core of grains that creep."""
        return float(self._zones[-1].at(self.law, np.array([1.0]))[0][0])

    @property
    def plug_velocity(self) -> float:
        layers = self.layers(None)
        return float(layers[-1].profile(np.array([1.0])).U[0])

    @property
    def flux(self) -> float:
        """Integral of the velocity from wall to wall."""
        total = self.core * self.plug_velocity
        nodes, weights = np.polynomial.legendre.leggauss(128)
        for layer in self.layers(None):
            base = layer.profile((1 + nodes) / 2)
            total += float(weights @ np.broadcast_to(base.U * base.dz, nodes.shape)) / 2
        return 2 * total

    def remarks(self) -> list[str]:
        kind = "plug" if self.law.yields else "no yield stress: rigid core"
        return [f"{kind} of half-width {self.core:.10g}, velocity {self.plug_velocity:.10g}",
                f"thickness of a shear zone {1 - self.core:.10g}",
                f"flux from wall to wall {self.flux:.10g}", "z: distance from a wall"]
