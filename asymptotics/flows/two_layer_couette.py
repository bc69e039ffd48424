"""Two liquids between sliding plates: the wave on their interface (Yih 1967).

Lengths are scaled with the depth of the upper liquid, velocities with the speed of the upper plate (the lower
one is at rest), Re is on both and the upper liquid's viscosity; ratios are lower over upper liquid. With m and n
for viscosity_ratio and depth_ratio, the shear rates are 1/(m+n) below and m/(m+n) above the interface at z = 0,
which moves at n/(m+n).
"""

from functools import cache
from typing import Any

import sympy as sp

from ..errors import BadParameter
from ..hierarchy import Hierarchy, Layer, long_wave
from ..linearise import FIELDS, Linearisation, x, z
from ..parameters import Parameter
from ..series import Expansion, power_of_i
from . import Regime

SUMMARY = "two liquids in plane Couette flow (waves on the interface)"

PARAMETERS = (
    Parameter("viscosity_ratio", "viscosity of the lower liquid over that of the upper", sp.Integer(0),
              remedy="give a positive ratio"),
    Parameter("depth_ratio", "depth of the lower liquid over that of the upper", sp.Integer(0),
              remedy="give a positive ratio"),
    Parameter("density_ratio", "density of the lower liquid over that of the upper", sp.Integer(0), closed=True,
              remedy="give 0 or more"),
    Parameter("Re", "Reynolds number of the upper liquid and the plate speed", sp.Integer(0),
              remedy="give a positive number"),
    Parameter("gravity", "g * depth/speed^2 of the upper liquid and plate", sp.Integer(0), closed=True,
              remedy="turn the flow over for the other sign: give 0 or more"),
    Parameter("tension", "surface tension/(density * speed^2 * depth)", sp.Integer(0), closed=True,
              remedy="surface tension is not negative: give 0 or more"),
)

DEFAULTS = {"viscosity_ratio": "2", "depth_ratio": "1", "density_ratio": "1", "Re": "10", "gravity": "0",
            "tension": "0"}
LATEX = {"viscosity_ratio": "m", "depth_ratio": "n", "density_ratio": "r", "Re": r"\mathrm{Re}", "gravity": "g",
         "tension": "S"}

RATIOS = tuple(parameter.name for parameter in PARAMETERS[:3])
SYMBOLS = m, n, density, Re, gravity, tension = tuple(parameter.symbol for parameter in PARAMETERS)
_SCALE = {"n": -1}

# In what follows velocities are relative to the interface and in units of depth times the lower shear rate 1/(m+n),
# stresses in units of the upper liquid's viscosity times that rate: the systems then have no denominators.
SHEARS = {"lower": sp.Integer(1), "upper": m}
VISCOSITIES = {"lower": m, "upper": sp.Integer(1)}
INERTIAS = {"lower": density * Re, "upper": Re}
_UNITS = {Re: Re / (m + n), gravity: gravity * (m + n) ** 2, tension: tension * (m + n) ** 2}


@cache
def linear_flow(name: str) -> Linearisation:
    """Waves on one of the liquids; the pressure is measured from that on the flat interface."""
    weight = INERTIAS[name] * gravity
    return Linearisation(
        velocity=SHEARS[name] * z,
        pressure=-weight * z,
        viscosity=lambda rate, p: VISCOSITIES[name],
        inertia=INERTIAS[name],
        force=(sp.Integer(0), sp.Integer(0), -weight),
    )


@cache
def matrix(name: str) -> sp.Matrix:
    return long_wave(linear_flow(name).system(), _SCALE)


@cache
def shared(name: str) -> tuple[sp.Expr, ...]:
    """What the displaced interface has in common with both liquids, as one of them has it: velocities and tractions.

    The common shear stress of the base flow is taken off; surface tension is counted to the lower liquid.
    """
    flow = linear_flow(name)
    traction = flow.traction()
    capillary = Re * tension * sp.diff(flow.surface, x, 2) if name == "lower" else 0
    values = (flow.full_velocity[0], flow.full_velocity[2], traction[0] - m, traction[2] - capillary)
    return tuple(flow.surface_condition(value, 0) for value in values)


@cache
def hierarchy(**values: Any) -> Hierarchy:
    """Orders in kappa = i k; fields are polynomials in z. Parameters given as numbers make the orders cheap."""
    known = _in_units(values)
    both = {name: Layer(name, z, matrix(name).subs(known)) for name in SHEARS}

    def edge(name: str, height: Any, condition: Any) -> Any:
        return both[name].at(sp.sympify(height).subs(known), long_wave(condition.subs(known), _SCALE))

    upper, lower = ([edge(name, 0, value) for value in shared(name)] for name in ("upper", "lower"))
    kinematic = linear_flow("lower").surface_condition(linear_flow("lower").kinematic, 0)
    conditions = [above - below for above, below in zip(upper, lower, strict=True)] + [edge("lower", 0, kinematic)]
    conditions += [edge(name, wall, field) for name, wall in (("lower", -n), ("upper", 1)) for field in FIELDS[:2]]
    return Hierarchy(list(both.values()), conditions)


def _in_units(values: dict[Any, Any]) -> dict[sp.Symbol, sp.Expr]:
    """The ratios given, and of the other parameters given those whose units are numbers then."""
    given = {symbol: values[symbol.name] for symbol in SYMBOLS if symbol.name in values}
    scaled = {symbol: _UNITS.get(symbol, symbol).subs(given) for symbol in given}
    return {symbol: value for symbol, value in scaled.items() if value.is_number}


@cache
def long_wave_law(order: Any = 2, **values: Any) -> Expansion:
    """sigma = -i k (n/(m+n) + c0) + k^2 (...), with c0 of Yih (1967); surface tension enters with k^4.

    >>> long_wave_law(1).with_parameters(viscosity_ratio=2, depth_ratio=1).phase_speed
    41/99
    """
    exact = {name: sp.nsimplify(value, rational=True) for name, value in values.items()}
    missing = [name for name in RATIOS if name not in exact]
    if order > 2 and missing:
        raise BadParameter(f"order {order} needs numbers for {', '.join(missing)}: with symbols its coefficient "
                           "fills pages; give them, or --order 2")
    powers = [sp.Integer(power) for power in range(1, int(order) + 1)]
    terms = {power: sp.factor(_speed(power - 1, exact)) * power_of_i(power) for power in powers}
    parameters = {symbol.name: exact.get(symbol.name) for symbol in SYMBOLS}
    return Expansion("two_layer_couette", "long-wave", terms, powers[-1] + 1, parameters)


def _speed(order: int, values: dict[Any, Any]) -> sp.Expr:
    """Coefficient of the speed, in the scales of the flow and with the lower plate at rest."""
    relative = hierarchy(**values).speed(order).subs(_UNITS, simultaneous=True) / (m + n)
    speed = relative - n / (m + n) if order == 0 else relative
    return speed.subs({symbol: values[symbol.name] for symbol in SYMBOLS if symbol.name in values})


REGIMES = {
    "long-wave": Regime("k -> 0 (Yih 1967)", tuple(parameter.name for parameter in PARAMETERS), long_wave_law,
                        default=sp.Integer(2), available=sp.Integer(4), beyond="the coefficients fill pages",
                        numbers=tuple(parameter.name for parameter in PARAMETERS)),
}
