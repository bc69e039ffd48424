"""Dunes: a granular bed under a sheared fluid (thesis 4.2).

Lengths are scaled with the grain diameter d, velocities in the bed with sqrt(g' d), so that U is (4.52);
Re is the fluid's, on shear rate and grain diameter. The fluid enters only through its response R to the
wavy bed (`asymptotics.fluid`). With r = sqrt(shields) and xi = sqrt(1 - z)/r, running from 1/r at the
interface to 1 at the yield surface, all coefficients are rational with poles at 0, -1 and 1.
"""

from functools import cache
from typing import Any

import sympy as sp

from .. import bed, fluid, thin
from ..hierarchy import Hierarchy, Layer, long_wave
from ..linearise import FIELDS, Linearisation, x, z
from ..parameters import Parameter
from ..series import Expansion, power_of_i
from ..series import k as wavenumber
from . import Regime

SUMMARY = "dunes: a granular bed under a sheared fluid"

LAWS = ("linear", "saturating")  # the friction laws, as files of results name them, the usual one first

PARAMETERS = (
    Parameter("shields", "applied stress over yield stress", sp.Integer(1),
              remedy="below 1 the bed does not yield; give a value above 1"),
    Parameter("mu1", "static friction coefficient", sp.Integer(0), remedy="a friction coefficient is positive"),
    Parameter("b", "slope of the friction law (4.48)", sp.Integer(0), remedy="friction must grow with the shear rate"),
    Parameter("mu2", "friction of rapid flow, saturating law (1.11) only", sp.Integer(0),
              remedy="a friction coefficient is positive"),
    Parameter("I0", "inertial number half-way between mu1 and mu2, saturating law only", sp.Integer(0),
              remedy="give a positive number"),
    Parameter("Re", "Reynolds number of the grain, (4.39)", sp.Integer(0), remedy="give a positive number"),
    Parameter("depth", "depth of the fluid in grain diameters", sp.Integer(0), infinite=True,
              remedy="give a positive depth, or inf for an unbounded fluid"),
    Parameter("k", "wavenumber (regime near-yield only)", sp.Integer(0), remedy="give a positive wavenumber"),
    Parameter("kappa", "k/sqrt(Re) (regime small-Re only)", sp.Integer(0), remedy="give a positive number"),
)

DEFAULTS = {"shields": "2", "mu1": "0.4", "b": "1", "Re": "10", "depth": "inf",
            **{name: thin.DEFAULTS[name] for name in ("mu2", "I0")}}
LATEX = {"shields": r"\theta", "mu1": r"\mu_1", "mu2": r"\mu_2", "I0": "I_0", "Re": r"\mathrm{Re}", "depth": "h",
         "kappa": r"\kappa", "delta": r"\delta"}

r, mu1, b, shields, xi = sp.symbols("r mu1 b shields xi", positive=True)
R = sp.Symbol("R")
_LOGS = sp.symbols("log_0 log_1")


@cache
def linear_bed() -> Linearisation:
    """Waves on the sheared bed (4.50)-(4.53), friction law (4.48)."""
    rest = sp.sqrt(1 - z)
    return Linearisation(
        velocity=2 / (3 * b) * (2 * r**3 - 3 * r**2 * rest + rest**3),
        pressure=1 - z,
        viscosity=lambda rate, p: mu1 * (1 + b * rate / sp.sqrt(p)) * p / rate,
        force=(sp.Integer(0), sp.Integer(0), sp.Integer(-1)),
    )


def interface_conditions() -> list[sp.Expr]:
    """Pressure of a monolayer (4.46), the fluid's shear stress (4.45), the kinematic condition (4.44)."""
    bed = linear_bed()
    traction = bed.traction()
    tangential = traction[0] + sp.diff(bed.surface, x) * traction[2]
    return [bed.full_pressure - 1, tangential - mu1 * r**2 * (1 - R * bed.surface), bed.kinematic]


@cache
def layer() -> Layer:
    bed, height = linear_bed(), 1 - r**2 * xi**2
    logs = {(0, 1 / r): _LOGS[0], (-1, 1 / r): _LOGS[1]}
    return Layer("bed", xi, long_wave(bed.system(height)) * sp.diff(height, xi), (0, -1, 1), 1, logs)


@cache
def conditions() -> tuple[sp.Expr, ...]:
    interface = [layer().at(1 / r, long_wave(linear_bed().surface_condition(condition, 0)))
                 for condition in interface_conditions()]
    return (*interface, layer().at(1, FIELDS[0]), layer().at(1, FIELDS[1]))


def hierarchy(response: tuple[Any, ...], q: int) -> Hierarchy:
    """Orders in epsilon, (i k) = epsilon^q, for R = sum of response[m] epsilon^m."""
    return Hierarchy([layer()], conditions(), q, {R: response})


# -- the expansions ------------------------------------------------------------------------------------

_R_SHALLOW = sp.symbols("R_0 R_1")
_R_LAYER = tuple(sp.Symbol(f"R_{m}") if m % 2 else sp.Integer(0) for m in range(6))


@cache
def _shallow_hierarchy() -> Hierarchy:
    return hierarchy(_R_SHALLOW, 1)


@cache
def _layer_hierarchy() -> Hierarchy:
    return hierarchy(_R_LAYER, 3)


@cache
def shallow(order: Any = 2) -> Expansion:
    """Fluid under a lid, k depth << 1: (4.84), and the coefficient A of (4.85).

    >>> A = shallow().with_parameters(shields="3/2", depth=10, mu1="2/5", b=1, Re="1/10").coefficient(2)
    >>> print(A.evalf(12))
    -0.0207561449483
    """
    response = {symbol: fluid.shallow_coefficient(m) for m, symbol in enumerate(_R_SHALLOW)}
    terms = {sp.Integer(m + 1): _named(_shallow_hierarchy().speed(m), response) * power_of_i(m + 1)
             for m in range(int(order))}
    parameters = dict.fromkeys(("shields", "mu1", "b", "Re", "depth"))
    return Expansion("dune", "shallow", terms, sp.Integer(int(order) + 1), parameters)


@cache
def boundary_layer(order: Any = 2) -> Expansion:
    """Unbounded fluid, k^2 << Re: (4.81), (4.82), a power 5/3 that vanishes, and the first corrections."""
    response = {symbol: fluid.boundary_layer_coefficient(m) for m, symbol in enumerate(_R_LAYER) if m % 2}
    powers = [sp.Rational(m + 3, 3) for m in range(1, int(3 * order) - 2)]
    terms = {power: _named(_layer_hierarchy().speed(int(3 * power) - 3), response) * power_of_i(power)
             for power in powers}
    following = max(powers[-1] + sp.Rational(1, 3), sp.Integer(2))
    return Expansion("dune", "boundary-layer", terms, following, dict.fromkeys(("shields", "mu1", "b", "Re")))


@cache
def leading_flux() -> sp.Expr:
    """a in sigma = i k a R + O(k^2): (2 shields/(3 b)) (shields^{3/2} - 3 shields^{1/2} + 2)."""
    return _named(sp.diff(_shallow_hierarchy().speed(0), _R_SHALLOW[0]), {})


@cache
def bed_damping() -> sp.Expr:
    """B in sigma = i k a R - B k^2 + ... where R -> 0: the bed on its own decays like -B k^2."""
    return _named(_shallow_hierarchy().speed(1).subs(dict.fromkeys(_R_SHALLOW, 0)), {})


@cache
def neutral_Re() -> sp.Expr:
    """Re on the curve A = 0 of the shallow regime, as a function of shields, depth, mu1, b: stable below it.

    >>> values = dict(shields=sp.Rational(3, 2), depth=10, mu1=sp.Rational(2, 5), b=1)
    >>> curve = neutral_Re()
    >>> print(curve.subs({s: values[s.name] for s in curve.free_symbols}).evalf(10))
    0.1382290062
    """
    R0, R1 = _R_SHALLOW
    rest = _named(_shallow_hierarchy().speed(1).subs(R1, 0), {R0: fluid.shallow_coefficient(0)})
    return -rest / (leading_flux() * fluid.shallow_coefficient(1) / fluid.Re)


@cache
def small_Re(order: Any = 1) -> Expansion:
    """Unbounded fluid, Re -> 0 with k = kappa sqrt(Re): sigma = Re (i a kappa R(kappa, 1, oo) - B kappa^2) + ...

    There R is of the order of k, so the bed answers to it and to its own slope at the same order.
    """
    kappa = sp.Symbol("kappa", positive=True)
    response = fluid.WallResponse(kappa, 1, sp.oo)
    coefficient = sp.I * leading_flux() * kappa * response - bed_damping() * kappa**2
    return Expansion("dune", "small-Re", {sp.Integer(1): coefficient}, sp.Rational(3, 2),
                     dict.fromkeys(("shields", "mu1", "b", "kappa")), gauge=fluid.Re,
                     wavenumber=kappa * sp.sqrt(fluid.Re))


def small_Re_maximum(shields: float, mu1: float, digits: int = 15) -> Any:
    """kappa of the fastest growth as Re -> 0, where k_max ~ kappa sqrt(Re) (an mpmath number).

    It maximises F(kappa) - (B/a) kappa^2, F = -kappa Im R(kappa, 1, oo), so it depends on shields and mu1 only:
    a and B are both proportional to 1/b. F'(kappa)/kappa falls from infinity to 0, so there is one maximum
    for every B/a > 0, that is for every shields > 1.

    >>> print(small_Re_maximum(1.5, 0.4))
    0.362362096410806
    """
    import mpmath as mp

    names = {symbol.name: symbol for symbol in (bed_damping() / leading_flux()).free_symbols}
    values = {names["shields"]: sp.Rational(str(shields)), names["mu1"]: sp.Rational(str(mu1))}
    ratio = sp.cancel(bed_damping() * b / (leading_flux() * b)).subs(values).evalf(digits + 10)

    def slope(log_kappa: Any) -> Any:
        kappa = mp.exp(log_kappa)
        growth = mp.diff(lambda q: -q * fluid.response(q, 1, digits=digits + exact).imag, kappa)
        return growth / (2 * kappa) - mp.mpf(ratio)

    exact = 3 * (digits + 8)  # mp.diff raises the precision threefold
    with mp.workdps(digits + 8):
        low = high = mp.mpf(0)
        while slope(low) < 0:
            low -= 1
        while slope(high) > 0:
            high += 1
        found = mp.exp(mp.findroot(slope, (low, high), solver="anderson", tol=mp.mpf(10) ** (-2 * digits)))
    with mp.workdps(digits):
        return +found


@cache
def near_yield(order: Any = 2) -> Expansion:
    """shields = 1 + delta, delta -> 0 at fixed k: sigma = i k R(k, Re, depth) delta^2/(2 b) + ..."""
    coefficient = sp.I * wavenumber * fluid.WallResponse(wavenumber, fluid.Re, fluid.depth) / (2 * b)
    return Expansion("dune", "near-yield", {sp.Integer(2): coefficient}, sp.Integer(3),
                     dict.fromkeys(("b", "Re", "depth", "k")), gauge=sp.Symbol("delta", positive=True))


@cache
def saturating_flux() -> sp.Expr:
    """a in sigma = i k a R + ... under the saturating law (1.11): shields dQ/d(shields) of `bed`."""
    return bed.shields * bed.flux_slope(thin.inertial_number, thin.mu2)


@cache
def saturating(order: Any = "4/3") -> Expansion:
    """Saturating friction, unbounded fluid, k^2 << Re: the bed in equilibrium with (4.71), as in (4.81).

    >>> law = saturating().with_parameters(shields="7/5", mu1="2/5", mu2="3/5", I0="3/10", Re=10)
    >>> print(f"{law.values()[sp.Rational(4, 3)]:.10f}")
    0.1502189896-0.2601869223j
    """
    power = sp.Rational(4, 3)
    coefficient = saturating_flux() * fluid.boundary_layer_coefficient(1) * power_of_i(power)
    return Expansion("dune", "saturating", {power: coefficient}, sp.Integer(2), dict.fromkeys((*_SATURATING, "Re")))


@cache
def saturating_shallow(order: Any = 1) -> Expansion:
    """Saturating friction, fluid under a lid, k depth << 1: as (4.84)."""
    coefficient = saturating_flux() * fluid.shallow_coefficient(0) * sp.I
    return Expansion("dune", "saturating-shallow", {sp.Integer(1): coefficient}, sp.Integer(2),
                     dict.fromkeys((*_SATURATING, "depth")))


def _named(coefficient: sp.Expr, response: dict[Any, Any]) -> sp.Expr:
    """Write r and the logarithms with shields, factor by factor, and put the response's coefficients in."""
    numerator, denominator = sp.fraction(coefficient)
    letters = sorted({*_LOGS, *_R_LAYER[1::2], *_R_SHALLOW, b, mu1}, key=str)
    logs = {_LOGS[0]: -sp.log(shields) / 2, _LOGS[1]: sp.log((1 + 1 / sp.sqrt(shields)) / 2)}
    total = sp.Integer(0)
    for powers, c in sp.Poly(numerator, *letters).terms():
        monomial = sp.Mul(*(letter**power for letter, power in zip(letters, powers, strict=True)))
        total += sp.factor(c * monomial / denominator).subs({**logs, **response})
    return total.subs(r, sp.sqrt(shields))


def _needs_depth(values: Any) -> str:
    return "regime shallow needs a finite depth, e.g. --depth 10" if values.get("depth") == sp.oo else ""


def _unbounded(values: Any) -> str:
    depth = values.get("depth", sp.oo)
    return "" if depth == sp.oo else f"depth must be inf here, got {depth}: with a lid use --regime shallow"


def _saturates(values: Any) -> str:
    """Why there is no such bed under the saturating law."""
    ratio = values["mu2"] / values["mu1"] if {"mu1", "mu2"} <= set(values) else sp.oo
    beyond = f"shields must be less than mu2/mu1 = {ratio}, got {values.get('shields')}: friction cannot exceed mu2"
    return thin.rising(values) or (beyond if values.get("shields", 0) >= ratio else "")


_BED = ("shields", "mu1", "b")
_SATURATING = ("shields", "mu1", "mu2", "I0")
_LEADING = "only the leading order is known"

REGIMES = {
    "boundary-layer": Regime("unbounded fluid, k -> 0 with k^2 << Re (4.81)", (*_BED, "Re"), boundary_layer,
                             default=sp.Integer(2), available=sp.Rational(8, 3), lowest=sp.Rational(4, 3),
                             step=sp.Rational(1, 3),
                             ignores=("depth",), accepts=_unbounded),
    "shallow": Regime("fluid under a lid, k depth -> 0 (4.84)", (*_BED, "Re", "depth"), shallow,
                      default=sp.Integer(2), available=sp.Integer(2), accepts=_needs_depth),
    "small-Re": Regime("unbounded fluid, Re -> 0 with k = kappa sqrt(Re)", (*_BED, "kappa"), small_Re,
                       default=sp.Integer(1), available=sp.Integer(1),
                       beyond=_LEADING, ignores=("depth",), accepts=_unbounded),
    "near-yield": Regime("shields = 1 + delta, delta -> 0 at fixed k", ("b", "Re", "depth", "k"), near_yield,
                         default=sp.Integer(2), available=sp.Integer(2), beyond=_LEADING, lowest=sp.Integer(2),
                         ignores=("mu1",)),
    "saturating": Regime("friction law (1.11), unbounded fluid, k -> 0 with k^2 << Re", (*_SATURATING, "Re"),
                         saturating, default=sp.Rational(4, 3), available=sp.Rational(4, 3), beyond=_LEADING,
                         lowest=sp.Rational(4, 3), ignores=("depth",),
                         accepts=lambda values: _unbounded(values) or _saturates(values)),
    "saturating-shallow": Regime("friction law (1.11), fluid under a lid, k depth -> 0", (*_SATURATING, "depth"),
                                 saturating_shallow, default=sp.Integer(1), available=sp.Integer(1), beyond=_LEADING,
                                 ignores=("Re",), accepts=lambda values: _needs_depth(values) or _saturates(values)),
}
