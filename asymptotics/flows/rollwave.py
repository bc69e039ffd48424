"""Roll waves: waves along a granular layer that flows down a plane (Forterre 2006; thesis 4.0).

Scaled like the vortices, with U = (2/3)(1 - (1-z)^{3/2}); Fr2 is the thesis's (4.6), and the Froude number on
the mean speed is F = (2/5) sqrt(Fr2). Of the friction law only t = tan(slope), its value in the base flow, and
e0 = (mu2 - t)(t - mu1)/(mu2 - mu1), its slope I mu'(I) there (4.16), have an effect.
"""

from collections.abc import Mapping
from functools import cache
from typing import Any

import sympy as sp

from ..hierarchy import Hierarchy, Layer, long_wave
from ..linearise import FIELDS, Linearisation, z
from ..parameters import Parameter
from ..series import Expansion, power_of_i
from . import Regime
from .vortex import Fr2, friction, mu1, mu2, tan_slope

SUMMARY = "roll waves in granular flow down an inclined plane (waves along the flow)"

LAWS = ("saturating",)  # the friction law, as files of results name it

PARAMETERS = (
    Parameter("slope_deg", "inclination of the plane in degrees", sp.Integer(0), sp.Integer(90),
              remedy="a plane that carries a flow slopes by more than 0 and less than 90 degrees"),
    Parameter("Fr2", "squared Froude number (4.6)", sp.Integer(0), remedy="give a positive number"),
    Parameter("mu1", "friction at rest", sp.Integer(0), remedy="a friction coefficient is positive"),
    Parameter("mu2", "friction of rapid flow", sp.Integer(0), remedy="a friction coefficient is positive"),
)

DEFAULTS = {"slope_deg": "28", "Fr2": "4", "mu1": "0.3818628674187188", "mu2": "0.6434683848584607"}
LATEX = {"slope": r"\alpha", "Fr": r"\mathrm{Fr}", "mu1": r"\mu_1", "mu2": r"\mu_2"}

e0 = sp.Symbol("e0", positive=True)
zeta = sp.Symbol("zeta", positive=True)
_E0 = (mu2 - tan_slope) * (tan_slope - mu1) / (mu2 - mu1)
_MU2 = (mu1 * e0 - tan_slope * (tan_slope - mu1)) / (e0 - tan_slope + mu1)  # mu2 of a given e0


@cache
def linear_flow() -> Linearisation:
    """Waves down the slope under the base state (4.10), with the friction law (1.11)."""
    return Linearisation(
        velocity=sp.Rational(2, 3) * (1 - (1 - z) ** sp.Rational(3, 2)),
        pressure=1 - z,
        viscosity=lambda rate, p: friction(rate / sp.sqrt(p)) * p / rate,
        inertia=Fr2,
        force=(tan_slope, sp.Integer(0), sp.Integer(-1)),
    )


def surface_conditions() -> list[sp.Expr]:
    """No stress on the displaced surface, along x and z, and the kinematic condition."""
    flow = linear_flow()
    traction = flow.traction()
    return [traction[0], traction[2], flow.kinematic]


@cache
def hierarchy() -> Hierarchy:
    """Orders in kappa = i k; fields are polynomials in zeta = sqrt(1 - z)."""
    flow, height = linear_flow(), 1 - zeta**2
    matrix = flow.system(height).subs(mu2, _MU2).applyfunc(sp.cancel)
    layer = Layer("grains", zeta, long_wave(matrix) * sp.diff(height, zeta))
    conditions = [layer.at(0, long_wave(flow.surface_condition(condition, 1))) for condition in surface_conditions()]
    conditions += [layer.at(1, FIELDS[0]), layer.at(1, FIELDS[1])]
    return Hierarchy([layer], conditions)


@cache
def long_wave_law(order: Any = 4) -> Expansion:
    """sigma = -i k + ([Fr2/10 - 2/5 + (3/5) t^2]/e0 - (3/10) t) k^2 + ...

    >>> long_wave_law(2).with_parameters(slope_deg=45, Fr2=2, mu1="1/2", mu2="3/2").coefficient(2)
    13/10
    """
    powers = [sp.Integer(power) for power in range(1, int(order) + 1)]
    terms = {power: _named(hierarchy().speed(power - 1)) * power_of_i(power) for power in powers}
    return Expansion("rollwave", "long-wave", terms, powers[-1] + 1,
                     dict.fromkeys(("slope_deg", "Fr2", "mu1", "mu2")))


@cache
def critical_Fr2() -> sp.Expr:
    """Fr2 above which long waves grow, 4 - 6 t^2 + 3 e0 t, as a function of slope_deg, mu1, mu2.

    >>> values = {"slope_deg": 45, "mu1": sp.Rational(1, 2), "mu2": sp.Rational(3, 2)}
    >>> critical_Fr2().subs({symbol: values[symbol.name] for symbol in critical_Fr2().free_symbols})
    -5/4
    """
    (threshold,) = sp.solve(hierarchy().speed(1), Fr2)
    return _named(sp.expand(threshold))


def critical_froude() -> sp.Expr:
    """The same for F, the mean speed over sqrt(g h cos slope): F_c^2 = (4/25) (4 - 6 t^2 + 3 e0 t)."""
    return sp.Rational(2, 5) * sp.sqrt(critical_Fr2())


def _named(coefficient: sp.Expr) -> sp.Expr:
    """Write the slope in degrees, and e0 with the friction law."""
    slope = sp.tan(sp.pi * sp.Symbol("slope_deg", positive=True) / 180)
    return sp.factor(coefficient).subs(e0, _E0).subs(tan_slope, slope)


def _between(values: Mapping[Any, Any]) -> str:
    """A steady flow needs mu1 < tan(slope) < mu2."""
    low, high = values.get("mu1", sp.Integer(0)), values.get("mu2", sp.oo)
    if not low < high:
        return (f"mu1 must be less than mu2, got mu1 = {float(low):g} and mu2 = {float(high):g}: "
                "friction must grow with the shear rate")
    if "slope_deg" not in values or low < sp.tan(sp.pi * values["slope_deg"] / 180) < high:
        return ""
    limits = ", ".join(f"{float(sp.atan(mu) * 180 / sp.pi):g}" for mu in (low, high))
    return (f"slope_deg must lie between atan(mu1) and atan(mu2), ({limits}), got {float(values['slope_deg']):g}: "
            "no steady flow elsewhere")


REGIMES = {
    "long-wave": Regime("k -> 0", ("slope_deg", "Fr2", "mu1", "mu2"), long_wave_law, default=sp.Integer(4),
                        available=sp.Integer(8), beyond="the coefficients fill pages", accepts=_between),
}
