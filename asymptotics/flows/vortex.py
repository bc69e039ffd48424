"""Longitudinal vortices: waves across a granular layer that flows down a plane (thesis 4.1).

Lengths are scaled with the depth, pressure with the weight of the layer, velocity so that U' = sqrt(1 - z);
Fr2 is the thesis's (4.6). sigma does not depend on the friction law, only on the slope and Fr2.
"""

from functools import cache
from typing import Any

import sympy as sp

from ..hierarchy import Hierarchy, Layer, long_wave
from ..linearise import FIELDS, Linearisation, y, z
from ..parameters import Parameter
from ..series import Expansion, power_of_i
from . import Regime

SUMMARY = "longitudinal vortices on an inclined plane (waves across the flow)"

PARAMETERS = (
    Parameter("slope_deg", "inclination of the plane in degrees", sp.Integer(0), sp.Integer(90),
              remedy="a plane that carries a flow slopes by more than 0 and less than 90 degrees"),
    Parameter("Fr2", "squared Froude number (4.6)", sp.Integer(0), closed=True,
              remedy="it is a square: give 0 or more"),
    Parameter("delta", "pressure on the surface, in layer weights", sp.Integer(0),
              remedy="the pressure condition needs a positive pressure; without it use --regime long-wave"),
)

DEFAULTS = {"slope_deg": "30", "Fr2": "0.1"}
LATEX = {"slope": r"\alpha", "Fr": r"\mathrm{Fr}", "delta": r"\delta"}

tan_slope, Fr2, mu1, mu2 = sp.symbols("tan_slope Fr2 mu1 mu2", positive=True)
delta = sp.Symbol("delta", positive=True)
zeta = sp.Symbol("zeta", positive=True)
NONE = sp.Integer(0)
_ROOTS = sp.symbols("root_top root_bottom", positive=True)  # sqrt(delta), sqrt(1 + delta)


def friction(number: sp.Expr) -> sp.Expr:
    """mu(I)/... of (1.11), with I measured in units of its value in the base flow, where mu = tan(slope)."""
    return mu1 + (mu2 - mu1) / (1 + (mu2 - tan_slope) / ((tan_slope - mu1) * number))


@cache
def linear_flow(pressure: Any = NONE) -> Linearisation:
    """Waves across the flow under the base state (4.10), or (4.26)-(4.27) with a pressure on the surface."""
    depth = 1 + pressure
    return Linearisation(
        velocity=sp.Rational(2, 3) * (depth ** sp.Rational(3, 2) - (depth - z) ** sp.Rational(3, 2)),
        pressure=depth - z,
        viscosity=lambda rate, p: friction(rate / sp.sqrt(p)) * p / rate,
        inertia=Fr2,
        force=(tan_slope, sp.Integer(0), sp.Integer(-1)),
        across=True,
    )


def surface_conditions(pressure: Any = NONE) -> list[sp.Expr]:
    """No stress but the pressure, along y and z, and the kinematic condition, on the displaced surface."""
    flow = linear_flow(pressure)
    traction = flow.traction()
    return [traction[1] - pressure * sp.diff(flow.surface, y), traction[2] + pressure, flow.kinematic]


def hierarchy(pressure: Any, top: sp.Expr, bottom: sp.Expr) -> Hierarchy:
    """Orders in kappa = i k; fields are polynomials in zeta = sqrt(1 + pressure - z), from `top` to `bottom`."""
    flow, height = linear_flow(pressure), bottom**2 - zeta**2
    layer = Layer("grains", zeta, long_wave(flow.system(1 + pressure - zeta**2)).subs(pressure, top**2)
                  * sp.diff(height, zeta))
    conditions = [layer.at(top, long_wave(flow.surface_condition(condition, 1)))
                  for condition in surface_conditions(pressure)]
    conditions += [layer.at(bottom, FIELDS[0]), layer.at(bottom, FIELDS[1])]
    return Hierarchy([layer], conditions)


@cache
def _free_surface() -> Hierarchy:
    return hierarchy(NONE, sp.Integer(0), sp.Integer(1))


@cache
def _loaded_surface() -> Hierarchy:
    return hierarchy(delta, *_ROOTS)


@cache
def long_wave_law(order: Any = 6) -> Expansion:
    """sigma = -2 k^2/(5 tan slope) + ... (4.25), in even powers of k."""
    return _even_expansion("long-wave", _free_surface(), order, {"slope_deg": None, "Fr2": None}, {})


@cache
def loaded_law(order: Any = 2) -> Expansion:
    """The same with pressure delta on the surface (4.26)-(4.30)."""
    roots = dict(zip(_ROOTS, (sp.sqrt(delta), sp.sqrt(1 + delta)), strict=True))
    return _even_expansion("delta", _loaded_surface(), order, {"slope_deg": None, "Fr2": None, "delta": None}, roots)


def _even_expansion(regime: str, hierarchy: Hierarchy, order: Any, parameters: dict[str, None],
                    names: dict[Any, Any]) -> Expansion:
    slope = {tan_slope: sp.tan(sp.pi * sp.Symbol("slope_deg", positive=True) / 180)}
    powers = [sp.Integer(power) for power in range(2, int(order) + 1, 2)]
    terms = {power: sp.factor(hierarchy.speed(power - 1) * power_of_i(power)).subs(names).subs(slope)
             for power in powers}
    return Expansion("vortex", regime, terms, powers[-1] + 2, parameters)


_LONG = "the coefficients fill pages"

REGIMES = {
    "long-wave": Regime("k -> 0, free surface (4.25)", ("slope_deg", "Fr2"), long_wave_law,
                        default=sp.Integer(6), available=sp.Integer(20), beyond=_LONG,
                        lowest=sp.Integer(2), step=sp.Integer(2)),
    "delta": Regime("k -> 0, pressure delta on the surface (4.30)", ("slope_deg", "Fr2", "delta"), loaded_law,
                    default=sp.Integer(2), available=sp.Integer(6), beyond=_LONG,
                    lowest=sp.Integer(2), step=sp.Integer(2)),
}
