r"""The shear stress that a sheared fluid exerts on a wavy wall (thesis 4.59-4.63).

The fluid U = z above a rigid wall z = s0 exp(i k x), unbounded or under a lid at z = depth; lengths are
scaled with the grain diameter, velocities with shear rate times grain diameter, and Re belongs to them.
The perturbation of the velocity gradient at the wall is -R s0. R is derived here

    boundary layer   k^2 << Re, unbounded: powers of (i k)^{1/3}       (4.71)
    shallow          k depth << 1, k Re depth^2 << 1: powers of i k    (4.83)
    short waves      k^2 >> Re: powers of Re/k^2

and evaluated at any k in multiple precision by `response`.
"""

from fractions import Fraction
from functools import cache
from math import factorial
from typing import Any

import sympy as sp

from .hierarchy import Hierarchy, Layer, edge_value, long_wave
from .linearise import FIELDS, Linearisation, amplitude, x, z
from .series import Expansion, power_of_i

Re, depth = sp.symbols("Re depth", positive=True)


@cache
def fluid() -> Linearisation:
    """Linear shear over a wall, fast compared with the wall's own motion (4.32-4.40)."""
    return Linearisation(velocity=z, pressure=sp.Integer(0), viscosity=lambda rate, pressure: 1 / Re, quasi_steady=True)


def wall_conditions() -> list[sp.Expr]:
    """No slip on the displaced wall: (4.60), (4.61) as velocities."""
    flow = fluid()
    return [flow.surface_condition(flow.full_velocity[component], 0) for component in (0, 2)]


@cache
def wall_shear() -> sp.Expr:
    """Velocity gradient along the displaced wall, to first order, in terms of w, u, t, n."""
    flow = fluid()
    traction, slope = flow.traction(), sp.diff(flow.surface, x)
    tangential = Re * (traction[0] + slope * traction[2])
    return flow.surface_condition(tangential - 1, 0)


@cache
def _shallow_hierarchy() -> Hierarchy:
    # the pressure gradient n' ~ 1/k drives the flow, so n is 1/kappa times a series
    scale = {"n": -1}
    layer = Layer("fluid", z, long_wave(fluid().system(), scale))
    conditions = [layer.at(0, long_wave(condition, scale)) for condition in wall_conditions()]
    conditions += [layer.at(depth, FIELDS[0]), layer.at(depth, FIELDS[1])]
    return Hierarchy([layer], conditions, eigenvalue=False)


@cache
def shallow_coefficient(order: int) -> sp.Expr:
    """Coefficient of (i k)^order in R."""
    hierarchy = _shallow_hierarchy()
    stress = hierarchy.edge(edge_value("fluid", "t", 0), order)
    displaced = wall_shear().coeff(amplitude) if order == 0 else 0
    return sp.factor(-wall_shear().coeff(FIELDS[2]) * stress - displaced)


@cache
def shallow(order: Any = 3) -> Expansion:
    """R = -4/depth - i k depth^2 Re/30 + ... as a series in k."""
    terms = {sp.Integer(m): shallow_coefficient(m) * power_of_i(m) for m in range(int(order) + 1)}
    return Expansion("fluid", "shallow", terms, sp.Integer(int(order) + 1), {"Re": None, "depth": None}, quantity="R")


# -- unbounded fluid ---------------------------------------------------------------------------------
#
# The vorticity Psi'' - k^2 Psi solves Omega'' = (k^2 + i k Re z) Omega, so it is Ai(q^2 + f z) with
# f = (i k Re)^{1/3}, q = k/f. The kinematic conditions on the wall give the integral of Omega e^{-kz} as -1:
#     R = -f Ai(q^2)/J(q),   J(q) = integral over s > 0 of Ai(q^2 + s) e^{-q s},
# and differentiating under the integral  J' = 2 q^2 J + Ai'(q^2) - q Ai(q^2),  J(0) = 1/3.

_AI = 1 / (3 ** sp.Rational(2, 3) * sp.gamma(sp.Rational(2, 3)))
_AI_PRIME = -(3 ** sp.Rational(1, 6)) * sp.gamma(sp.Rational(2, 3)) / (2 * sp.pi)


@cache
def airy_taylor(n: int) -> sp.Expr:
    """Coefficient of s^n in Ai(s), from Ai'' = s Ai."""
    if n < 0 or n == 2:
        return sp.Integer(0)
    if n < 2:
        return (_AI, _AI_PRIME)[n]
    return airy_taylor(n - 3) / (n * (n - 1))


@cache
def _integral_taylor(n: int) -> sp.Expr:
    """Coefficient of q^n in J(q)."""
    if n <= 0:
        return sp.Rational(1, 3) if n == 0 else sp.Integer(0)
    m = n - 1
    slope = 2 * _integral_taylor(m - 2)
    if m % 2 == 0:
        slope += (m // 2 + 1) * airy_taylor(m // 2 + 1)
    elif m >= 1:
        slope -= airy_taylor((m - 1) // 2)
    return slope / n


@cache
def ratio_taylor(n: int) -> sp.Expr:
    """Coefficient of q^n in Ai(q^2)/J(q)."""
    top = airy_taylor(n // 2) if n % 2 == 0 else sp.Integer(0)
    rest = sum(ratio_taylor(j) * _integral_taylor(n - j) for j in range(n))
    return sp.powsimp(sp.expand(3 * (top - rest)))


@cache
def boundary_layer_coefficient(order: int) -> sp.Expr:
    """Coefficient of (i k)^{order/3} in R: only order = 1, 3, 5, ... differ from zero."""
    if order % 2 == 0:
        return sp.Integer(0)
    n = (order - 1) // 2
    # f q^n = k^n f^{1-n} and k = -i (i k)
    return -ratio_taylor(n) * (-sp.I) ** n * Re ** sp.Rational(1 - n, 3)


@cache
def boundary_layer(terms: Any = 3) -> Expansion:
    """R = -(3^{1/3}/Gamma(2/3)) (i k Re)^{1/3} - 9 k/(2 pi sqrt 3) + ... as a series in k."""
    powers = [sp.Rational(2 * n + 1, 3) for n in range(terms + 1)]
    found = {power: sp.expand(boundary_layer_coefficient(int(3 * power)) * power_of_i(power)) for power in powers[:-1]}
    return Expansion("fluid", "boundary-layer", found, powers[-1], {"Re": None}, quantity="R")


def short_wave_coefficient(n: int) -> sp.Expr:
    """Coefficient of (Re/k^2)^n in R/k.

    In y = k z the vorticity solves Omega'' - Omega = i lambda y Omega, lambda = Re/k^2: at each order i^n
    times a polynomial times e^{-y}; the integral of Omega e^{-y} is -1.
    """
    wall = _short_wave_vorticity(n)[0]
    return sp.I**n * sp.Rational(wall.numerator, wall.denominator)


@cache
def _short_wave_vorticity(n: int) -> tuple[Fraction, ...]:
    """Coefficients of the polynomial factor P of the vorticity at order n:  P'' - 2 P' = y P_{n-1}."""
    if n == 0:
        return (Fraction(-2),)
    source = [Fraction(0), *_short_wave_vorticity(n - 1)]
    slope = [Fraction(0)] * (len(source) + 1)
    for j in reversed(range(len(source))):
        slope[j] = ((j + 1) * slope[j + 1] - source[j]) / 2
    rest = [c / (j + 1) for j, c in enumerate(slope[:-1])]
    moment = sum((c * Fraction(factorial(j), 2 ** (j + 1)) for j, c in enumerate(rest, 1)), Fraction(0))
    return (-2 * moment, *rest)


@cache
def short_waves(terms: Any = 2) -> Expansion:
    """R = -2 k - i Re/(2 k) + ... in falling powers of k."""
    found = {sp.Integer(1 - 2 * n): short_wave_coefficient(n) * Re**n for n in range(terms)}
    return Expansion("fluid", "short-waves", found, sp.Integer(1 - 2 * terms), {"Re": None}, quantity="R")


# -- numbers -------------------------------------------------------------------------------------------


def response(k: Any, Re: Any, depth: Any = float("inf"), digits: int = 16) -> Any:
    """R at one k > 0, as an mpmath complex number good to about `digits` digits.

    >>> print(response(1, 100, digits=15))
    (-5.19067837951101 - 2.42321348776854j)
    """
    import mpmath

    if depth != float("inf"):
        return _lid_response(mpmath, k, Re, depth, digits)
    if Re * (digits + 10) < k * k / 2:  # its smallest term is about exp(-(4/3) k^2/Re)
        return _short_wave_sum(mpmath, k, Re, digits)
    return _unbounded_response(mpmath, k, Re, digits)


class WallResponse(sp.Function):
    """R(k, Re, depth) in formulas: a symbol until all three are numbers, then `response`."""

    nargs = 3

    def _eval_evalf(self, prec: int) -> Any:
        if any(argument.free_symbols for argument in self.args):
            return None
        digits = max(16, int(prec / 3.3) + 2)
        k, Re, depth = (float("inf") if argument == sp.oo else argument._to_mpmath(prec + 10) for argument in self.args)
        value = response(k, Re, depth, digits)
        return sp.Float(value.real, digits) + sp.I * sp.Float(value.imag, digits)

    def _sympystr(self, printer: Any) -> str:
        return f"R({', '.join(printer.doprint(argument) for argument in self.args)})"

    def _latex(self, printer: Any) -> Any:
        return f"R({', '.join(printer.doprint(argument) for argument in self.args)})"


def _short_wave_sum(mp: Any, k: Any, Re: Any, digits: int) -> Any:
    """The short-wave series, an asymptotic one, up to terms below the digits asked for."""
    with mp.workdps(digits + 10):
        ratio, total, n = mp.mpf(Re) / mp.mpf(k) ** 2, mp.mpc(0), 0
        term = mp.mpc(1)
        while abs(term) > mp.mpf(10) ** -(digits + 5):
            wall = _short_wave_vorticity(n)[0]
            term = mp.mpf(wall.numerator) / wall.denominator * (mp.j * ratio) ** n
            total, n = total + term, n + 1
        total *= k
    return total


def _unbounded_response(mp: Any, k: Any, Re: Any, digits: int) -> Any:
    """Taylor series of Ai(q^2) and J(q), with enough digits for their cancellation."""
    with mp.workdps(int(digits + 20 + 1.2 * float(k) ** 2 / float(Re))):
        f = mp.root(mp.mpc(0, mp.mpf(k) * mp.mpf(Re)), 3)
        q = mp.mpf(k) / f
        value, slope = mp.airyai(0), mp.airyai(0, derivative=1)
        airy = [value, slope, mp.mpf(0)]
        integral = [mp.mpf(1) / 3]
        total, power, quiet, m = mp.mpc(integral[0]), mp.mpc(1), 0, 0
        while quiet < 6:
            half = m // 2
            while len(airy) <= half + 1:
                n = len(airy)
                airy.append(airy[n - 3] / (n * (n - 1)))
            source = (half + 1) * airy[half + 1] if m % 2 == 0 else -airy[half]
            integral.append((source + (2 * integral[m - 2] if m >= 2 else 0)) / (m + 1))
            power *= q
            term = integral[-1] * power
            total += term
            quiet, m = (quiet + 1 if abs(term) <= mp.eps * abs(total) else 0), m + 1
        return -f * mp.airyai(q * q) / total


def _lid_response(mp: Any, k: Any, Re: Any, depth: Any, digits: int) -> Any:
    """Two Taylor series for the vorticity, combined so that Psi = Psi' = 0 at the lid."""
    growth = float(k * depth + (2 / 3) * (k * Re) ** 0.5 * depth**1.5)
    with mp.workdps(int(digits + 20 + growth)):
        k, Re, h = mp.mpf(k), mp.mpf(Re), mp.mpf(depth)
        first = _stream_function(mp, k, Re, h, (1, 0), 0)
        second = _stream_function(mp, k, Re, h, (0, 1), 0)
        wall = _stream_function(mp, k, Re, h, (0, 0), 1)
        rows = mp.matrix([[first[0], second[0]], [first[1], second[1]]])
        value, _ = mp.lu_solve(rows, mp.matrix([-wall[0], -wall[1]]))
    return value


def _stream_function(mp: Any, k: Any, Re: Any, h: Any, vorticity: tuple[int, ...], slope: int) -> tuple[Any, ...]:
    """Psi and Psi' at z = h from Psi(0) = 0, Psi'(0) = slope and the vorticity's value and slope at the wall."""
    omega = [mp.mpc(vorticity[0]), mp.mpc(vorticity[1])]
    psi = [mp.mpc(0), mp.mpc(slope)]
    value, derivative, power, quiet, n = mp.mpc(slope) * h, mp.mpc(slope), h, 0, 0
    while quiet < 6 and n < 100000:
        before = omega[n - 1] if n else 0
        omega.append((k * k * omega[n] + mp.j * k * Re * before) / ((n + 2) * (n + 1)))
        psi.append((omega[n] + k * k * psi[n]) / ((n + 2) * (n + 1)))
        derivative += (n + 2) * psi[-1] * power
        power *= h
        value += psi[-1] * power
        small = abs(psi[-1] * power) * (n + 2) <= mp.eps * (abs(value) + abs(derivative) * h)
        quiet, n = (quiet + 1 if small else 0), n + 1
    return value, derivative
