"""Flux of a granular bed under uniform shear stress, and what it says of long waves under any friction law.

Lengths are scaled with the grain diameter d, velocities with sqrt(g' d), pressure with that on the bed: p = 1 - z,
mu(I) p = mu1 shields and U' = I sqrt(p), from the yield surface p = shields to the bed p = 1. Waves much longer than
the bed is deep find it in this equilibrium with the stress mu1 shields (1 - R s0) of the fluid. Volume is conserved,
ds0/dt + dQ/dx = 0, with the flux

    Q = int U dz = int_1^shields (p - 1) I sqrt(p) dp,        sigma = i k shields dQ/d(shields) R + ...

I vanishes at the yield surface: that it moves adds nothing to dQ/d(shields). The flux does not know how high the bed
lies, and its inertia and slope are smaller by the order of k.
"""

from collections.abc import Callable

import sympy as sp

from .thin import mu1

shields = sp.Symbol("shields", positive=True)
_zeta, _top, _pole, _ratio = sp.symbols("zeta r a nu", positive=True)  # a = nu r, nu^2 = mu1/mu2


def flux_slope(inertial_number: Callable[[sp.Expr], sp.Expr], largest: sp.Expr | None = None) -> sp.Expr:
    """dQ/d(shields) of a law given by its inverse, I as a rational function of mu, and by its largest friction.

    In zeta = sqrt(p) the integrand is rational and even, with poles +-a where friction would be the largest.

    >>> flux_slope(lambda mu: mu / mu1 - 1)
    2*(sqrt(shields) - 1)**2*(sqrt(shields) + 2)/3
    """
    change = sp.diff(inertial_number(mu1 * shields / _zeta**2), shields)
    place = {} if largest is None else {shields: _pole**2 * largest / mu1}
    integrand = sp.cancel(sp.together((change * 2 * _zeta**2 * (_zeta**2 - 1)).subs(place)))
    residue = sp.factor(sp.cancel(integrand * (_zeta - _pole) ** 2).diff(_zeta).subs(_zeta, _pole))
    logarithm = residue * (1 / (_zeta - _pole) - 1 / (_zeta + _pole))
    regular = sp.integrate(sp.apart(sp.cancel(integrand - logarithm), _zeta), _zeta)
    ends = [sp.factor(one.subs(_pole, _top * _ratio)) for one in
            (regular.subs(_zeta, _top) - regular.subs(_zeta, 1), residue)]
    slope = ends[0] + ends[1] * sp.log((1 - _ratio) * (1 + _top * _ratio) / ((1 + _ratio) * (1 - _top * _ratio)))
    return slope.subs({_top: sp.sqrt(shields), _ratio: sp.sqrt(mu1 / (largest or 1))})
