"""Annular shear of grains around a turning cylinder: thesis 2.1.2, its rotation rate at a thin shear layer.

Lengths are scaled with the radius of the cylinder, pressure with that of the grains at rest, p0, velocities with
sqrt(p0/density); gamma = sqrt(volume fraction) r0/d. Beyond the yield radius Ry = 1 + delta nothing moves, and

    dP/dR = R Omega^2,    mu(I) R^2 P = mu1 Ry^2,    R dOmega/dR = -gamma I sqrt(P),    P = 1, Omega = 0 at Ry.

Omega ~ delta^2 makes P = 1 + O(delta^5), which changes Omega at order delta^6 only.
"""

from functools import cache
from typing import Any

import sympy as sp

from ..parameters import Parameter
from ..series import Expansion
from ..thin import DEFAULTS as USUAL
from ..thin import FRICTION, NAMES, delta, inertial_number, layer_law, mu1, rising, y
from ..thin import LATEX as PRINTED
from . import Regime

SUMMARY = "annular shear of grains: rotation rate of the cylinder"

PARAMETERS = (*FRICTION,
              Parameter("gamma", "sqrt(volume fraction) r0/d", sp.Integer(0), remedy="give a positive number"))
DEFAULTS = {**USUAL, "gamma": "10"}
LATEX = {**PRINTED, "gamma": r"\gamma"}

gamma = sp.Symbol("gamma", positive=True)


@cache
def rotation(order: Any = 4) -> Expansion:
    """Omega(1) = Gamma_0 delta^2/(lambda - 1) + ..., Gamma_0 = I0 gamma, lambda = mu2/mu1: (2.11) and the next orders.

    >>> rotation(2).with_parameters(mu1="1/4", mu2="1/2", I0=1, gamma=3).coefficient(2)
    3
    """
    Ry, R = 1 + delta, 1 + delta * (1 - y)
    integrand = delta * gamma * inertial_number(mu1 * Ry**2 / R**2) / R
    return layer_law("annulus", integrand, order, "rotation rate", (*NAMES, "gamma"))


REGIMES = {
    "quasi-static": Regime("sheared layer of thickness delta -> 0: (2.11)", (*NAMES, "gamma"), rotation,
                           default=sp.Integer(4), available=sp.Integer(5), lowest=sp.Integer(2),
                           beyond="the centrifugal pressure is felt", accepts=rising),
}
