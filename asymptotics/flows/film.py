"""A liquid film that falls down an inclined plane (Benjamin 1957, Yih 1963).

Lengths are scaled with the depth of the film, velocities with the one at its surface, so that U = 2 z - z^2;
steady flow then fixes gravity: 2/Re down the slope, 2 cot(slope)/Re across it. Re is on depth and surface speed,
We = surface tension/(density * surface speed^2 * depth).
"""

from functools import cache
from typing import Any

import sympy as sp

from ..hierarchy import Hierarchy, Layer, long_wave
from ..linearise import FIELDS, Linearisation, x, z
from ..parameters import Parameter
from ..series import Expansion, power_of_i
from . import Regime

SUMMARY = "liquid film falling down an inclined plane"

PARAMETERS = (
    Parameter("Re", "Reynolds number of depth and surface speed", sp.Integer(0), remedy="give a positive number"),
    Parameter("slope_deg", "inclination of the plane in degrees; beyond 90 the film hangs", sp.Integer(0),
              sp.Integer(180), remedy="a film falls down a plane that slopes by more than 0 and less than 180 degrees"),
    Parameter("We", "surface tension/(density * surface speed^2 * depth)", sp.Integer(0), closed=True,
              remedy="surface tension is not negative: give 0 or more"),
)

DEFAULTS = {"Re": "10", "slope_deg": "30", "We": "0"}
LATEX = {"Re": r"\mathrm{Re}", "slope": r"\alpha", "We": r"\mathrm{We}"}

Re, We = sp.symbols("Re We", positive=True)
cot_slope = sp.Symbol("cot_slope")


@cache
def linear_flow() -> Linearisation:
    """Waves down the slope on Nusselt's film."""
    return Linearisation(
        velocity=2 * z - z**2,
        pressure=2 * cot_slope / Re * (1 - z),
        viscosity=lambda rate, p: 1 / Re,
        force=(2 / Re, sp.Integer(0), -2 * cot_slope / Re),
    )


def surface_conditions() -> list[sp.Expr]:
    """On the displaced surface no shear stress, the pressure of surface tension, and the kinematic condition."""
    flow = linear_flow()
    traction = flow.traction()
    return [traction[0], traction[2] - We * sp.diff(flow.surface, x, 2), flow.kinematic]


@cache
def hierarchy() -> Hierarchy:
    """Orders in kappa = i k; fields are polynomials in z."""
    flow = linear_flow()
    layer = Layer("liquid", z, long_wave(flow.system()))
    conditions = [layer.at(1, long_wave(flow.surface_condition(condition, 1))) for condition in surface_conditions()]
    conditions += [layer.at(0, FIELDS[0]), layer.at(0, FIELDS[1])]
    return Hierarchy([layer], conditions)


@cache
def long_wave_law(order: Any = 4) -> Expansion:
    """sigma = -2 i k + (8/15) (Re - (5/4) cot slope) k^2 + ...

    >>> long_wave_law(2).with_parameters(Re=1, slope_deg=45).coefficient(2)
    -2/15
    """
    powers = [sp.Integer(power) for power in range(1, int(order) + 1)]
    terms = {power: _named(hierarchy().speed(power - 1)) * power_of_i(power) for power in powers}
    return Expansion("film", "long-wave", terms, powers[-1] + 1, dict.fromkeys(("Re", "slope_deg", "We")))


@cache
def critical_Re() -> sp.Expr:
    """Re above which long waves grow, (5/4) cot slope: negative where the film hangs.

    >>> critical_Re()
    5*cot(pi*slope_deg/180)/4
    """
    (threshold,) = sp.solve(hierarchy().speed(1), Re)
    return _named(threshold)


def _named(coefficient: sp.Expr) -> sp.Expr:
    """Write the slope in degrees."""
    return sp.factor(coefficient).subs(cot_slope, sp.cot(sp.pi * sp.Symbol("slope_deg", positive=True) / 180))


REGIMES = {
    "long-wave": Regime("k -> 0 (Yih 1963)", ("Re", "slope_deg", "We"), long_wave_law, default=sp.Integer(4),
                        available=sp.Integer(10), beyond="the coefficients fill pages"),
}
