"""Granular flow down a rough inclined plane: thesis 2.1.4, its flux as a power of its depth H.

Lengths are scaled with d / sqrt(volume fraction) and velocities with the root of that length times g cos(slope), so
that mu(I) = tan(slope) everywhere, U' = I sqrt(H - z), U(0) = 0.
"""

from functools import cache
from typing import Any

import sympy as sp

from ..parameters import Parameter
from ..series import Expansion
from ..thin import DEFAULTS as USUAL
from ..thin import FRICTION, NAMES, inertial_number, rising
from ..thin import LATEX as PRINTED
from . import Regime

SUMMARY = "granular flow down an inclined plane: its flux"

PARAMETERS = (
    *FRICTION,
    Parameter("slope_deg", "inclination in degrees, between those of mu1 and mu2", sp.Integer(0), sp.Integer(90),
              remedy="there is steady flow between atan(mu1) and atan(mu2)"),
)
DEFAULTS = {**USUAL, "slope_deg": "28"}
LATEX = {**PRINTED, "slope": r"\theta"}

H, z = sp.symbols("H z", positive=True)
slope_deg = sp.Symbol("slope_deg", positive=True)


@cache
def flux(order: Any = "9/2") -> Expansion:
    """Q = (2/5) I(tan slope) H^(5/2) exactly, (2.47): the next orders vanish.

    >>> flux().with_parameters(mu1="1/2", mu2=2, I0=3, slope_deg=45).coefficient("5/2")
    3/5
    """
    number = inertial_number(sp.tan(sp.pi * slope_deg / 180))
    profile = sp.Rational(2, 3) * (H ** sp.Rational(3, 2) - (H - z) ** sp.Rational(3, 2))
    exact = sp.integrate(profile, (z, 0, H))
    power, coefficient = sp.Rational(5, 2), sp.simplify(exact / H ** sp.Rational(5, 2))
    count = int(sp.Rational(order) - power) + 1
    terms = {power + step: number * coefficient if not step else sp.Integer(0) for step in range(count)}
    return Expansion("incline", "quasi-static", terms, power + count, dict.fromkeys((*NAMES, "slope_deg")), gauge=H,
                     quantity="flux")


REGIMES = {
    "quasi-static": Regime("any depth H: (2.47)", (*NAMES, "slope_deg"), flux, default=sp.Rational(9, 2),
                           available=sp.Rational(9, 2), beyond="all orders vanish", lowest=sp.Rational(5, 2),
                           accepts=rising),
}
