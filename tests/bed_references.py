"""Multi-precision eigenvalues of dunes under any friction law, from the power series of the law itself.

    dune(law, shields, Re, depth, k, guess, creep)    `law` is a class of `law_series` and its parameters
    plate(law, shields, inertia, k, guess, creep)     grains under a dragged plate
    chute(law, plug, inertia, k, guess, creep)        grains between vertical walls: a shear zone

A bed of pressure p = 1 - z obeys mu(I) p = tau, so that in x, the depth below some height, the functions of the
equations are power series made of that of I(p): what the law contributes is `inertial`, the series of I about a given
pressure, and `slope`, that of mu'(I). Nothing is shared with the package: no zeta, no weights, no quadrature.

With S = sigma + i k U, g = U' and p' = -1 (' = d/dz), small changes u, w of velocity, t and n of stress obey

    w' = -i k u,       u' = (t - alpha q)/beta - i k w,      q = -n - 2 i k (tau/g) u,
    t' = rho (S u + g w) - i k n + 4 k^2 (tau/g) u,          n' = rho S w - i k t,
    beta = mu' sqrt(p),      alpha = tau/p - I mu'/2.

With u = g v the first edge of a bed with a yield surface is a regular singular point, g = 0: series in y, the height
above it, have the bounded solutions; w = 0 there. A creeping bed begins on its floor, v = w = 0, and is expanded about
one height after the other. On the bed q = s, t = -tau R s, w = S s.
"""

from fractions import Fraction
from functools import cache
from operator import mul
from typing import NamedTuple

import mpmath as mp
from law_series import SPARE, Series
from references import Fixed, _response, _root

_RATIO = mp.mpf("0.4")  # step over the radius of convergence, as far as that is estimated


def dune(law, shields, Re, depth, k, guess, creep=None, digits=30, radius=1e-3):
    """The root next to `guess`; `law` is a class and its parameters, as a tuple."""
    wall = cache(lambda prec: _response(k, Re, depth))

    def conditions(state, tau, speed, sigma):
        v, w, t, n = state
        q = -n - 2j * k * tau * v
        return t + tau * wall(mp.mp.prec) * q, w - (sigma + 1j * k * speed) * q

    return _root(_determinant(_bed(law, shields, creep), mp.mpf(k), 1, conditions), guess, digits, radius)


def plate(law, shields, inertia, k, guess, creep=None, digits=30, radius=1e-3):
    """The root next to `guess` of grains under a rigid plate: u = w = 0 there."""
    return _root(_determinant(_bed(law, shields, creep), mp.mpf(k), mp.mpf(inertia), lambda state, *_: state[:2]),
                 guess, digits, radius)


def chute(law, plug, inertia, k, guess, creep=None, digits=30, radius=1e-3):
    """The root next to `guess` of grains between the plug, or a rigid core, and a wall: u = w = 0 on both."""
    kind, *parameters = law

    @cache
    def walk(prec):
        made = kind(*parameters)
        return made, None, list(_inside_out(made, mp.mpf(plug) / made.rest, creep and mp.mpf(creep)))

    def conditions(state, *_):
        return state[:2]

    # the wall is at rest, and the plug moves
    def determinant(sigma):
        with mp.extraprec(40):
            fall = mp.fsum(mp.fsum(base.U.c) for _, base in walk(mp.mp.prec)[2])
            return _determinant(walk, mp.mpf(k), mp.mpf(inertia), conditions)(sigma - 1j * mp.mpf(k) * fall)

    return _root(determinant, guess, digits, radius)


def _inside_out(law, pressure, creep):
    """Yield (step, equations) from the plug or the core to the wall, x = 1; x = pressure mu."""
    def at(x):
        mu = Series.of([x / pressure])
        mu.slow = bool(law.breaks) and x < law.breaks[0] * pressure
        return law.inertial(mu).c[0]

    x = pressure * law.rest
    if not law.yields:
        low = mp.mpf(1)
        while at(low) > creep * at(mp.mpf(1)):
            low -= mp.mpf("0.02")
        x = mp.findroot(lambda x: mp.log(at(x) / (creep * at(mp.mpf(1)))), (low, low + mp.mpf("0.02")),
                        solver="anderson", tol=mp.mpf(10) ** (-mp.mp.dps + 5))
    for end in [*sorted(mu * pressure for mu in law.breaks if x < mu * pressure < 1), mp.mpf(1)]:
        while x < end:
            slow = bool(law.breaks) and end <= law.breaks[0] * pressure
            at_rest = x - law.rest * pressure
            radius = min([x, *(abs(pole * pressure - x) for pole in law.poles),
                          *([abs(at_rest)] if at_rest and not slow else [])])
            step = min(end - x, _RATIO * radius * (mp.mpf("0.3") if slow else 1))
            zeros = [mp.mpf(0)] * (_terms() - 2)
            tau = Series.of([x, step, *zeros])
            yield step, Equations.of(law, tau * (1 / pressure), Series.of([pressure, mp.mpf(0), *zeros]), tau, -1, slow,
                                     step)
            x += step


def _bed(law, shields, creep):
    """The function of the precision that returns (law, shear stress on top, [(step, series)]), once for each."""
    kind, *parameters = law

    @cache
    def walk(prec):
        made = kind(*parameters)
        tau = made.rest * mp.mpf(shields)
        return made, tau, list(_steps(made, tau, creep and mp.mpf(creep)))

    return walk


def _determinant(walk, k, rho, conditions):
    """The determinant of two `conditions` at the end of a walk, a function of sigma."""
    def determinant(sigma):
        with mp.extraprec(40):
            law, tau, steps = walk(mp.mp.prec)
            states, speed, largest = _climbed(law, steps, k, rho, sigma)
            one, other = (conditions(state, tau, speed, sigma) for state in states)
            D = one[0] * other[1] - one[1] * other[0]
            lost = max(largest[0] * max(map(abs, other)), largest[1] * max(map(abs, one)))
        return D, mp.mag(lost) - mp.mp.prec - 24  # of 40 bits more

    return determinant


def _steps(law, tau, creep):
    """Yield (step, series) from the bottom of the bed to its surface."""
    pressure = _bottom(law, tau, creep)
    ends = sorted((tau / mu for mu in law.breaks), reverse=True)
    for end in [*(p for p in ends if 1 < p < pressure), mp.mpf(1)]:
        while pressure > end:
            slow = not law.yields and pressure + end > 2 * tau / law.breaks[0]
            rest = tau / law.rest - pressure  # where g = 0 solutions are singular, but on the first edge
            radius = min([pressure, *(abs(pressure - tau / pole) for pole in law.poles),
                          *([abs(rest)] if rest and not slow else [])])
            step = min(pressure - end, _RATIO * radius * (mp.mpf("0.3") if slow else 1))
            yield step, _coefficients(law, tau, pressure, slow, step)
            pressure -= step


def _climbed(law, steps, k, rho, sigma):
    """The states (v, w, t, n) that two solutions have at the end, the velocity there over that at the start, and the
    largest term of each solution."""
    start = (None, mp.mpf(0)) if law.yields else (mp.mpf(0), mp.mpf(0))
    states, speed = [(*start, mp.mpf(t), mp.mpf(n)) for t, n in ((1, 0), (0, 1))], mp.mpf(0)
    largest = [mp.mpf(1), mp.mpf(1)]
    for number, (step, base) in enumerate(steps):
        singular = law.yields and not number
        found = [_advance(base, k, rho, sigma, speed, state, step, singular) for state in states]
        states = [state for state, _ in found]
        largest = [max(pair) for pair in zip(largest, (size for _, size in found), strict=True)]
        speed += mp.fsum(base.U.c)
    return states, speed, largest


def _bottom(law, tau, creep):
    """Pressure at the yield surface, or where the shear rate is `creep` times that on the bed."""
    if law.yields:
        return tau / law.rest

    def rate(p):
        mu = Series.of([tau / p])
        mu.slow = tau / p < law.join
        return law.inertial(mu).c[0] * mp.sqrt(p)

    top = rate(mp.mpf(1))
    high = mp.mpf(1)
    while rate(high) > creep * top:
        high += mp.mpf("0.05")
    return mp.findroot(lambda p: mp.log(rate(p) / (creep * top)), (high - mp.mpf("0.05"), high), solver="anderson",
                       tol=mp.mpf(10) ** (-mp.mp.dps + 5))


def _terms():
    return int(mp.mp.prec / -mp.log(_RATIO, 2)) + 12


def _coefficients(law, tau, pressure, slow, step):
    """The equations in Y, the height over the step."""
    zeros = [mp.mpf(0)] * (_terms() - 2)
    p = Series.of([pressure, -step, *zeros])
    mu = p.power(-1) * tau
    return Equations.of(law, mu, p, Series.of([tau, mp.mpf(0), *zeros]), 1, slow, step)


class Equations(NamedTuple):
    """Series in the distance over the step; `way` is -1 where the velocity falls with it."""

    g: Series
    dg: Series
    loss: Series  # step/beta
    press: Series  # step alpha/beta
    twist: Series  # tau times that
    U: Series
    tau: Series
    way: int

    @classmethod
    def of(cls, law, mu, p, tau, way, slow, step):
        mu.slow = slow
        inertial, slope, root = law.inertial(mu), law.slope(mu), p.power(Fraction(1, 2))
        g = inertial * root
        if law.yields and abs(g.units[0]) < 1 << (SPARE + 10):
            g.units[0] = 0
        beta = slope * root
        press = (mu - inertial * slope / 2) / beta * (way * step)
        return cls(g, g.slope(), beta.power(-1) * step, press, press * tau, g.integral() * (way * step), tau, way)


class _Column:
    """A complex power series in integers of units 2**-bits, and its product with real ones given backwards."""

    def __init__(self, first, bits):
        self.bits, self.re, self.im = bits, [], []
        self.append(Fixed(int(mp.ldexp(mp.re(first), bits)), int(mp.ldexp(mp.im(first), bits)), bits))

    def append(self, x):
        self.re.append(x.re)
        self.im.append(x.im)

    def last(self):
        return Fixed(self.re[-1], self.im[-1], self.bits)

    def times(self, backwards, j):
        """Coefficient j of the product; coefficients that are not known yet do not count."""
        start = len(backwards) - 1 - j
        part = backwards[start:start + len(self.re)]
        return Fixed(sum(map(mul, part, self.re)) >> self.bits, sum(map(mul, part, self.im)) >> self.bits, self.bits)

    def number(self):
        return mp.mpc(*(mp.ldexp(sum(part), -self.bits) for part in (self.re, self.im)))


def _advance(base, k, rho, sigma, speed, state, step, singular):
    """The state (v, w, t, n) a step further, u = g v, and the largest term."""
    bits = mp.mp.prec + 40

    def fixed(x):
        x = mp.mpmathify(x)
        return Fixed(int(mp.ldexp(x.real, bits)), int(mp.ldexp(x.imag, bits)), bits)

    g, dg, loss, press, twist, U, tau = ([int(mp.ldexp(x, bits)) for x in one.c] for one in base[:7])
    terms = len(g)
    first = list(state)
    if singular:  # order 0 of g v' + g' v = (t - alpha q)/beta - i k w: g_0 = 0, and w = 0
        first[0] = (base.loss.c[0] * state[2] + base.press.c[0] * state[3]) / (
            base.dg.c[0] - 2j * k * base.twist.c[0])
    v, w, t, n = (_Column(x, bits) for x in first)
    gv = _Column(0, bits)
    gv.re, gv.im = [], []
    g_, dg_, loss_, press_, twist_, U_, tau_ = (one[::-1] for one in (g, dg, loss, press, twist, U, tau))
    ik, ik2, rate, drag, h, wave = map(fixed, (
        1j * k * step, 2j * k, rho * (sigma + 1j * k * speed) * step, 4 * k**2 * step, base.way * rho * step,
        1j * k * rho * step))

    def shear(m):
        """Coefficient m of what g v' is, as far as v is known."""
        known = t.times(loss_, m) + n.times(press_, m) + ik2 * v.times(twist_, m) - ik * w.last()
        return known - v.times(dg_, m) - _slopes(v, g_, m)

    for j in range(terms - 2):
        gv.append(v.times(g_, j))
        u, lift = gv.last(), w.times(g_, j)
        Su = rate * u + wave * gv.times(U_, j)
        Sw = rate * w.last() + wave * w.times(U_, j)
        old_t, old_n = t.last(), n.last()
        known = None if singular else shear(j)
        w.append(-1 * (ik * u) // (j + 1))
        t.append((Su + h * lift - ik * old_n + drag * v.times(tau_, j)) // (j + 1))
        n.append((Sw - ik * old_t) // (j + 1))
        if singular:  # order j + 1: v_{j+1} multiplies (j + 1) g_1 + g'_0 - 2 i k tau press_0
            m = j + 1
            v.append(shear(m) / (Fixed(m * g[1] + dg[0], 0, bits) - ik2 * Fixed(twist[0], 0, bits)))
        else:
            v.append(known / Fixed((j + 1) * g[0], 0, bits))
    sides = [side for column in (v, w, t, n) for side in (column.re, column.im)]
    largest = max(abs(x) for side in sides for x in side)
    tail = max(abs(x) for side in sides for x in side[-4:]) << (mp.mp.prec - 16)  # what is cut off counts as rounding
    return [column.number() for column in (v, w, t, n)], mp.ldexp(max(largest, tail), -bits)


def _slopes(v, g_, m):
    """Coefficient m of g v', as far as v is known."""
    start = len(g_) - 1 - m
    part = g_[start:start + len(v.re) - 1]
    return Fixed(*(sum(map(mul, part, [i * x for i, x in enumerate(side)][1:])) >> v.bits for side in (v.re, v.im)),
                 v.bits)
