"""The one model: plane perturbations of a sheared layer, as four first-order equations.

With normal mode exp(i k x + sigma t) and z normal to the flow, the perturbations of velocity
(u, w), shear stress t and normal stress n obey

    w' = -i k u
    u' = (t - alpha p) / beta - i k w,                p = -n - 2 i k eta u
    t' = rho [(sigma + i k U) u + U' w] - i k n + 4 k^2 eta u
    n' = rho  (sigma + i k U) w - i k t

where rho is the inertia coefficient, eta = tau / U' the effective viscosity, beta = d tau / d U' the
tangent viscosity and alpha = d tau / d p the pressure sensitivity of the shear stress tau(U', p). No
derivative of a base-flow coefficient but U' appears, which keeps the equations regular at a free surface.

The unknowns are scaled by their long-wave orders, so that nothing cancels as k -> 0:

    u = i k^a g v,    w = k^(1+a) w^,    t = i k^a t^,    n = n^,    sigma = k^(1+a) rate

with a = 0 for perturbations along the flow and a = 1 for perturbations across it (U = alpha = 0). The
weight g(z) is 1 except where the velocity gradient itself vanishes (yield surface: g = U').
Without convection (U = 0, alpha = 0) all coefficients are real.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.polynomial import chebyshev as C

from . import chebyshev

FIELDS = ("v", "w", "t", "n")

_SAMPLES = 64  # points that carry the slope of the map


@dataclass(frozen=True)
class Profile:
    """Base flow at the points s of a layer: arrays of the shape of s, or numbers.

    `dz` is the slope dz/ds of the map from 0 <= s <= 1 to the layer; `dg` is dg/ds. The shear-rate
    equation is multiplied by `clear`, so that its coefficients become polynomials and its matrix banded.
    `rho`, `eta`, `beta` and the unknown stresses are in units of `stress`: viscous flows measure them by their
    viscosity, or else all stresses would be enormous beside the velocities at small Re.
    """

    dz: Any
    eta: Any
    beta: Any
    rho: Any = 1.0
    U: Any = 0.0
    dU: Any = 0.0
    alpha: Any = 0.0
    g: Any = 1.0
    dg: Any = 0.0
    clear: Any = 1.0
    stress: Any = 1.0


@dataclass(frozen=True)
class Layer:
    """A layer between two edges, s = 0 below and s = 1 above.

    `profile(s)` returns its base flow. `singular` is the number of edges at which the leading
    coefficient of the shear-rate equation vanishes: each replaces one condition (the bounded
    solution is the one that the series can represent). `steady` drops the time derivative.
    """

    name: str
    profile: Callable[..., Profile]
    singular: int = 0
    steady: bool = False

    def height(self, s: np.ndarray) -> np.ndarray:
        """Distance of the points 0 <= s <= 1 from the lower edge: the integral of dz/ds."""
        points = chebyshev.points(_SAMPLES)
        slope = np.broadcast_to(np.asarray(self.profile(points).dz, dtype=float), points.shape)
        integral = C.chebint(chebyshev.coefficients(slope), lbnd=-1) / 2
        return C.chebval(2 * s - 1, integral)


def residuals(base, k, rate, fields, slopes, order):
    """Return the residuals of the four equations (shear rate, continuity, momentum along and across).

    `fields` and `slopes` are (v, w, t, n) and their s-derivatives; `order` is a of the scaling.
    All arithmetic is plain: arrays, forms, mpmath numbers and sympy symbols go through it.
    """
    v, w, t, n = fields
    dv, dw, dt, dn = slopes
    width = k ** (1 + order)
    convection = base.rho * (width * rate + 1j * k * base.U)
    u = base.g * v
    p = 2 * width * (base.eta * u) - n
    return (
        base.clear * (base.g * dv + base.dg * v - base.dz / base.beta * (t + 1j * base.alpha * p)
                      + base.dz * (k**2 * w)),
        dw - base.dz * u,
        dt - base.dz * (convection * u - 1j * base.rho * base.dU * (k * w) - k ** (1 - order) * n
                        + 4 * k**2 * (base.eta * u)),
        dn - base.dz * (width * (convection * w + t)),
    )
