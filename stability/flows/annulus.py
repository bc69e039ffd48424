"""Annular shear of grains without gravity, inner cylinder turning: the thesis's (2.2)-(2.6), under any friction law.

The torque mu R^2 P = mu1 Ry^2 is uniform, P' = R Omega^2 and R Omega' = -Gamma I sqrt(P). Where the law yields, the
grains are at rest beyond Ry, with P = 1 and Omega = 0 there; others creep, and are held by a rigid outer cylinder
where the shear rate has fallen to a given fraction of that on the inner one, with P = 1 and Omega = 0 on it. Where the
slope of the law jumps, at an inertial number, the layer is divided; P says at which radius that is.

Solved by iteration: friction from the last P, Omega and P by integrating inwards. Points are doubled until all series
have ended; where friction rises as another power of I than the first, they crowd at the yield radius.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, ClassVar

import numpy as np
from numpy.polynomial import chebyshev as C

from ..equations.layer import Layer, Profile
from ..errors import ParameterError
from ..numerics import chebyshev
from .base import parameter
from .bed import creep_parameter
from .equilibrium import Steady
from .law import Law

_POINTS, _ROUNDS = (64, 128, 256), 400
_CROWDED = 8  # power of the distance from the yield radius
_SETTLED = 4e-15  # change of the profiles at which the iteration has ended
_ENDED = 1e-14  # of the largest coefficient, the last quarter of a series that has ended


@dataclass(frozen=True)
class Annulus(Steady):
    """Grains between a turning cylinder R = 1 and the yield radius Ry = 1 + thickness; at rest beyond.

    Under a law without yield stress friction falls to `rest` at Ry, and the grains creep up to a rigid outer cylinder.

    Scales: see `scales`. A base flow alone: waves raise ParameterError, as do parameters outside their range.

    >>> from stability.studies.base import base_flow
    >>> profiles = base_flow(Annulus(), 3)
    >>> profiles.z.round(12).tolist(), abs(float(profiles.U[-1])) < 1e-12  # at rest beyond the yield radius
    ([1.0, 1.05, 1.1], True)
    """

    name: ClassVar[str] = "annulus"
    title: ClassVar[str] = "annular shear of grains around a turning cylinder"
    scales: ClassVar[str] = ("length: radius r0 of the cylinder; velocity: sqrt(p0/density); "
                             "stress: p0, the pressure of the grains at rest; the thesis's Gamma_0 = I0 Gamma")
    bottom: ClassVar[float] = 1.0
    why: ClassVar[str] = "its stream lines are circles, not those of a parallel layer"

    thickness: float = parameter(0.1, 0, look=(1e-3, 1.0), meaning="thickness Ry - 1 of the sheared layer: the torque")
    gamma: float = parameter(10.0, 0, look=(0.1, 1e3), meaning="sqrt(volume fraction) r0/d; thesis: Gamma_0 over I0")

    def __post_init__(self) -> None:
        super().__post_init__()
        if not self.law.rest > 0:
            raise ParameterError(f"{self.name}: law {self.law.name} has no yield stress to measure the torque by: give "
                                 "it a property rest, the friction coefficient at the radius 1 + thickness")
        _ = self._solved

    @classmethod
    def extras(cls, law: Any) -> Any:
        return creep_parameter(law, "outer cylinder", "inner one")

    @property
    def _solved(self) -> "tuple[_Part]":
        return _solution(self.law, self.thickness, self.gamma, getattr(self, "creep", 0.0))

    def layers(self, names: Any) -> Any:
        self.base_only(names)
        return tuple(Layer("grains" if not number else f"grains_{number + 1}", self._profile(part))
                     for number, part in enumerate(self._solved))

    def _profile(self, part: "_Part") -> Callable[..., Any]:
        law, gamma = self.law, self.gamma

        def profile(s: np.ndarray) -> Profile:
            P = C.chebval(2 * s - 1, part.pressure)
            R, inertial, stress = part.ring.at(law, s, P)
            rate = gamma * inertial * np.sqrt(P)
            spin = C.chebval(2 * s - 1, part.omega)
            with np.errstate(divide="ignore", invalid="ignore"):
                slope = law.slope(inertial)
                return Profile(dz=part.ring.stretch(s), U=R * spin, dU=spin - rate, eta=stress / rate,
                               beta=slope * np.sqrt(P) / gamma, alpha=stress / P - inertial * slope / 2)

        return profile

    def state(self, layer: str, z: np.ndarray, base: Profile) -> dict[str, np.ndarray]:
        part = self._solved[int(layer.partition("_")[2] or 1) - 1]
        s = part.ring.place(z)
        P = C.chebval(2 * s - 1, part.pressure)
        R, inertial, stress = part.ring.at(self.law, s, P)
        return {"U": base.U, "dU": base.dU, "shear_stress": stress, "pressure": P, "inertial_number": inertial,
                "angular_velocity": base.U / R}

    @property
    def rotation(self) -> float:
        """Angular velocity of the cylinder."""
        return float(C.chebval(-1.0, self._solved[0].omega))

    def remarks(self) -> list[str]:
        kind = "yield radius" if self.law.yields else "no yield stress: radius of the rigid outer cylinder"
        return [f"{kind} {self._solved[-1].ring.outer:.10g}",
                f"angular velocity of the cylinder {self.rotation:.10g}",
                "U: azimuthal velocity, dU: its slope in R; z: R"]


@dataclass(frozen=True)
class _Ring:
    """Radii between two at which the law is smooth."""

    inner: float
    outer: float
    Ry: float
    torque: float
    slowest: float  # friction at the outer and at the inner edge, where the slope of the law jumps there
    fastest: float
    crowd: int = 1

    def stretch(self, s: np.ndarray) -> np.ndarray:
        return (self.outer - self.inner) * self.crowd * (1 - s) ** (self.crowd - 1)

    def place(self, R: np.ndarray) -> np.ndarray:
        return 1 - np.maximum((self.outer - R) / (self.outer - self.inner), 0) ** (1 / self.crowd)

    def at(self, law: Law, s: Any, P: Any) -> tuple[Any, Any, Any]:
        """R, I and shear stress; where the law yields, mu - mu(0) = mu(0) (Ry^2 - R^2 P)/(R^2 P), P = 1 - (1 - P)."""
        inside = (self.outer - self.inner) * (1 - s) ** self.crowd
        R = self.outer - inside
        stress = self.torque / R**2
        if law.yields:
            excess = (inside + self.Ry - self.outer) * (R + self.Ry) + R**2 * (1 - P)
            high = np.maximum(self.torque / self.Ry**2 * excess / (R**2 * P), 0)
            return R, law.beyond(np.clip(high, self.slowest - law.start, self.fastest - law.start)), stress
        return R, law.beyond(np.clip(stress / P, self.slowest, self.fastest)), stress


@dataclass(frozen=True)
class _Part:
    """A ring with T-coefficients of Omega and P."""

    ring: _Ring
    omega: Any
    pressure: Any

    def ended(self) -> bool:
        return all(np.abs(one[-len(one) // 4:]).max() <= _ENDED * np.abs(one).max()
                   for one in (self.omega, self.pressure))


@lru_cache(maxsize=128)
def _solution(law: Law, delta: float, gamma: float, creep: float) -> "tuple[_Part]":
    """The parts from within."""
    for crowd in (1, _CROWDED) if law.yields else (1,):
        for count in _POINTS:
            parts = _iterated(law, delta, gamma, creep, count, crowd)
            if all(part.ended() for part in parts):
                return parts
    raise ParameterError(f"annulus: the shear rate under law {law.name} is not smooth: friction must rise smoothly "
                         "with I")


def _iterated(law: Any, delta: Any, gamma: Any, creep: Any, count: Any, crowd: Any) -> Any:
    """The parts with series of `count` terms, once they do not change any more."""
    s = chebyshev.points(count)
    parts, before = (), np.zeros(1)
    for _ in range(_ROUNDS):
        rings = _rings(law, delta, creep, crowd, parts)
        if rings is None:
            break
        parts = _inwards(law, gamma, s, rings, parts)
        spins = np.concatenate([part.omega for part in parts])
        if len(spins) == len(before) and np.abs(spins - before).max() <= _SETTLED * np.abs(spins).max():
            return parts
        before = spins
    raise ParameterError(f"annulus: no steady flow found at thickness = {delta:g}, gamma = {gamma:g}: friction would "
                         f"exceed {law.range[1]:g}, that of law {law.name}, on the cylinder; take a smaller thickness "
                         "or gamma")


def _rings(law: Law, delta: float, creep: float, crowd: int, parts: tuple[Any, ...]) -> "list[_Ring] | None":
    """The rings from within, at the pressure of the last round; None where the law has no such friction."""
    Ry = 1 + delta
    torque = law.rest * Ry**2
    centre = float(C.chebval(-1.0, parts[0].pressure)) if parts else 1.0
    if not (centre > 0 and torque / centre < law.range[1]):
        return None
    fastest = float(law.inverse(torque / centre))
    slowest = 0.0 if law.yields else creep * fastest * np.sqrt(centre)
    outer = Ry if law.yields else float(np.sqrt(torque / law.mu(slowest)))
    jumps = sorted(one for one in law.breaks if slowest < one < fastest)
    numbers = [np.inf, *reversed(jumps), slowest]
    radii = [1.0, *(_radius(float(law.mu(one)), torque, outer, parts) for one in reversed(jumps)), outer]
    frictions = [law.range[1] if one == np.inf else float(law.mu(one)) if one else law.start for one in numbers]
    return [_Ring(inner, end, Ry, torque, low, np.nextafter(high, 0) if np.isfinite(high) else high,
                  crowd if end == outer else 1)
            for inner, end, high, low in zip(radii, radii[1:], frictions, frictions[1:], strict=False)]


def _radius(mu: Any, torque: Any, outer: Any, parts: Any) -> Any:
    """Where friction is mu: R^2 P(R) = torque/mu, by bisection, P rises outwards."""
    low, high = 1.0, outer
    while low < (middle := (low + high) / 2) < high:
        low, high = (middle, high) if middle**2 * _pressure(parts, middle) < torque / mu else (low, middle)
    return high


def _pressure(parts: Any, R: Any) -> Any:
    for part in parts:
        if part.ring.outer >= R:
            return float(C.chebval(2 * part.ring.place(R) - 1, part.pressure))
    return 1.0


def _inwards(law: Any, gamma: Any, s: Any, rings: Any, parts: Any) -> Any:
    """The next parts: Omega and P are integrated from the outermost edge, where they are 0 and 1."""
    found, omega, pressure = [], 0.0, 1.0
    old = parts if len(parts) == len(rings) else [None] * len(rings)
    for ring, last in zip(reversed(rings), reversed(old), strict=True):
        P = C.chebval(2 * s - 1, last.pressure) if last else np.ones(len(s))
        R, inertial, _ = ring.at(law, s, P)
        spin = _integral(gamma * inertial * np.sqrt(P) / R * ring.stretch(s))
        spin[0] += omega
        push = -_integral(R * C.chebval(2 * s - 1, spin) ** 2 * ring.stretch(s))
        push[0] += pressure
        omega, pressure = (float(C.chebval(-1.0, one)) for one in (spin, push))
        found.append(_Part(ring, spin, push))
    return tuple(reversed(found))


def _integral(values: np.ndarray) -> np.ndarray:
    """T-coefficients of the integral from s to 1 of a function given at the points."""
    return -C.chebint(chebyshev.transform(values), lbnd=1) / 2
