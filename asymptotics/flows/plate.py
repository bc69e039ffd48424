"""Grains under a heavy plate that is dragged along: thesis 2.2.1, velocity of the plate just above yield.

Lengths are scaled with the depth z0 of grains that weighs as much as the plate, velocities with z0 sqrt(g z0)/d, so
that mu(I) (1 - Z) = mu1 (1 + delta), U' = I sqrt(1 - Z), and U = 0 at Z = -delta, the yield surface: (2.35).
"""

from functools import cache
from typing import Any

import sympy as sp

from ..series import Expansion
from ..thin import DEFAULTS as USUAL
from ..thin import FRICTION, NAMES, delta, inertial_number, layer_law, mu1, rising, y
from ..thin import LATEX as PRINTED
from . import Regime

SUMMARY = "grains under a dragged plate: its velocity"

PARAMETERS = FRICTION
DEFAULTS, LATEX = USUAL, PRINTED


@cache
def plate_velocity(order: Any = 4) -> Expansion:
    """U(0) = I0 delta^2 / (2 (lambda - 1)) + ..., lambda = mu2/mu1: (2.38) and the next orders.

    >>> plate_velocity(2).with_parameters(mu1="2/5", mu2="16/25", I0=1).coefficient(2)
    5/6
    """
    Z = -delta * y
    integrand = delta * inertial_number(mu1 * (1 + delta) / (1 - Z)) * sp.sqrt(1 - Z)
    return layer_law("plate", integrand, order, "plate velocity")


REGIMES = {
    "quasi-static": Regime("stress 1 + delta times that at yield, delta -> 0: (2.38)", NAMES, plate_velocity,
                           default=sp.Integer(4), available=sp.Integer(8), beyond="the coefficients fill pages",
                           lowest=sp.Integer(2), accepts=rising),
}
