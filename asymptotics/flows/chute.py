"""Grains falling between rough vertical walls, with a plug: thesis 2.1.3, flux at thin shear zones.

Lengths are scaled with the half-width L, velocities with L sqrt(g L)/d. The plug is |x| < W = 1 - delta, pressure is
W/mu1 and mu(I) = mu1 x/W, so that -v' = I sqrt(W/mu1), v(1) = 0, and the flux from wall to wall is -2 int x v' dx.
"""

from functools import cache
from typing import Any

import sympy as sp

from ..series import Expansion
from ..thin import DEFAULTS as USUAL
from ..thin import FRICTION, NAMES, delta, inertial_number, layer_law, mu1, rising, y
from ..thin import LATEX as PRINTED
from . import Regime

SUMMARY = "grains falling between vertical walls: their flux"

PARAMETERS = FRICTION
DEFAULTS, LATEX = USUAL, PRINTED


@cache
def flux(order: Any = 4) -> Expansion:
    """Q = I0/sqrt(mu1) delta^2/(lambda - 1) + ..., lambda = mu2/mu1: (2.22) and the next orders.

    >>> flux(2).with_parameters(mu1="1/4", mu2="1/2", I0=1).coefficient(2)
    2
    """
    W, x = 1 - delta, 1 - delta * (1 - y)
    integrand = 2 * delta * x * inertial_number(mu1 * x / W) * sp.sqrt(W / mu1)
    return layer_law("chute", integrand, order, "flux")


REGIMES = {
    "quasi-static": Regime("shear zones of thickness delta -> 0: (2.22)", NAMES, flux, default=sp.Integer(4),
                           available=sp.Integer(8), beyond="the coefficients fill pages", lowest=sp.Integer(2),
                           accepts=rising),
}
