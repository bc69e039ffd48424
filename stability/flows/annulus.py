"""Annular shear of grains without gravity, inner cylinder turning: the thesis's (2.2)-(2.6), under any friction law."""

from dataclasses import dataclass
from functools import lru_cache
from typing import ClassVar

import numpy as np
from numpy.polynomial import chebyshev as C

from ..equations.layer import Layer, Profile
from ..errors import ParameterError
from ..numerics import chebyshev
from .base import parameter
from .steady import Steady

_POINTS, _ROUNDS = 96, 400
_SETTLED = 4e-15  # change of the profiles at which the iteration has ended


@dataclass(frozen=True)
class Annulus(Steady):
    """Grains between a turning cylinder R = 1 and the yield radius Ry = 1 + thickness; at rest beyond.

    The torque is mu R^2 P = mu1 Ry^2, the centrifugal pressure P' = R Omega^2, the shear rate
    R Omega' = -Gamma I sqrt(P), with P = 1 and Omega = 0 at Ry.

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

    def __post_init__(self):
        super().__post_init__()
        if not self.law.yields or self.law.breaks:
            raise ParameterError(f"{self.name}: law {self.law.name} has no yield stress or no smooth slope: there is "
                                 "no yield radius; take a law that is smooth and yields")
        _ = self._solved

    @property
    def _solved(self):
        return _solution(self.law, self.thickness, self.gamma)

    def layers(self, names):
        self.base_only(names)
        omega, pressure = self._solved
        law, delta, gamma = self.law, self.thickness, self.gamma

        def profile(s):
            R, P, inertial, stress = _local(law, delta, s, C.chebval(2 * s - 1, pressure))
            rate = gamma * inertial * np.sqrt(P)
            spin = C.chebval(2 * s - 1, omega)
            with np.errstate(divide="ignore", invalid="ignore"):
                slope = law.slope(inertial)
                return Profile(dz=delta, U=R * spin, dU=spin - rate, eta=stress / rate, beta=slope * np.sqrt(P) / gamma,
                               alpha=stress / P - inertial * slope / 2)

        return (Layer("grains", profile),)

    def state(self, layer, z, base):
        _, pressure = self._solved
        s = (z - 1) / self.thickness
        R, P, inertial, stress = _local(self.law, self.thickness, s, C.chebval(2 * s - 1, pressure))
        return {"U": base.U, "dU": base.dU, "shear_stress": stress, "pressure": P, "inertial_number": inertial,
                "angular_velocity": base.U / R}

    @property
    def rotation(self):
        """Angular velocity of the cylinder."""
        return float(C.chebval(-1.0, self._solved[0]))

    def remarks(self):
        return [f"yield radius {1 + self.thickness:.10g}", f"angular velocity of the cylinder {self.rotation:.10g}",
                "U: azimuthal velocity, dU: its slope in R; z: R"]


def _local(law, delta, s, P):
    """R, P, I and shear stress: mu - mu(0) = mu(0) (Ry^2 - R^2 P)/(R^2 P), P = 1 - (1 - P)."""
    R = 1 + delta * s
    below = delta * (1 - s)
    excess = below * (R + 1 + delta) + R**2 * (1 - P)
    stress = law.start * (1 + delta) ** 2 / R**2
    return R, P, law.beyond(np.maximum(law.start * excess / (R**2 * P), 0)), stress


@lru_cache(maxsize=128)
def _solution(law, delta, gamma):
    """T-coefficients of Omega and P over the layer, by iterated integration from the yield radius."""
    s = chebyshev.points(_POINTS)
    x, P, before = 2 * s - 1, np.ones(_POINTS), np.zeros(_POINTS)
    for _ in range(_ROUNDS):
        R, P, inertial, stress = _local(law, delta, s, P)
        if not (P > 0).all() or not (stress / P < law.range[1]).all():
            break
        omega = _inwards(gamma * inertial * np.sqrt(P) / R * delta)
        spin = C.chebval(x, omega)
        pressure = -_inwards(R * spin**2 * delta)
        pressure[0] += 1
        P = C.chebval(x, pressure)
        change = np.abs(spin - before).max()
        if change <= _SETTLED * np.abs(spin).max():
            return omega, pressure
        before = spin
    raise ParameterError(f"annulus: no steady flow found at thickness = {delta:g}, gamma = {gamma:g}: friction would "
                         f"exceed {law.range[1]:g}, that of law {law.name}, on the cylinder; take a smaller thickness "
                         "or gamma")


def _inwards(values):
    """T-coefficients of the integral from s to 1 of a function given at the points."""
    series = C.chebint(chebyshev.transform(values), lbnd=1) / 2
    return -series
