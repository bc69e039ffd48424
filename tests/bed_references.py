"""Multi-precision eigenvalues of dunes under any friction law, from the power series of the law itself.

    dune(law, shields, Re, depth, k, guess, creep)    `law` is one of the classes below with its parameters
    plate(law, shields, inertia, k, guess, creep)     grains under a dragged plate

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

import mpmath as mp
from references import Fixed, _response, _root

_RATIO = mp.mpf("0.4")  # step over the radius of convergence, as far as that is estimated
_SPARE = 160  # bits: inertial numbers of creeping grains fall to 1e-20, and slopes of friction rise as far


class Series:
    """Truncated power series, arithmetic with numbers and with each other: integers in units of 2**-bits.

    Far faster than floating point; `_SPARE` bits more than the working precision make up for small coefficients.
    """

    def __init__(self, units, bits):
        self.units, self.bits = list(units), bits

    @classmethod
    def of(cls, numbers):
        bits = mp.mp.prec + _SPARE
        return cls((_units(one, bits) for one in numbers), bits)

    @property
    def c(self):
        """The coefficients as numbers of the working precision."""
        return [mp.ldexp(one, -self.bits) for one in self.units]

    def _other(self, other):
        if isinstance(other, Series):
            return other.units
        return [_units(other, self.bits)] + [0] * (len(self.units) - 1)

    def _new(self, units):
        return Series(units, self.bits)

    def __add__(self, other):
        return self._new(a + b for a, b in zip(self.units, self._other(other), strict=True))

    def __sub__(self, other):
        return self._new(a - b for a, b in zip(self.units, self._other(other), strict=True))

    def __mul__(self, other):
        if not isinstance(other, Series):
            factor = _units(other, self.bits)
            return self._new((a * factor) >> self.bits for a in self.units)
        a, back = self.units, other.units[::-1]
        return self._new(sum(map(mul, a, back[len(a) - 1 - j:])) >> self.bits for j in range(len(a)))

    def __truediv__(self, other):
        if not isinstance(other, Series):
            return self * (1 / mp.mpf(other))
        found, b = [], other.units
        for j in range(len(b)):
            found.append(((self.units[j] << self.bits) - sum(map(mul, found, b[j:0:-1]))) // b[0])
        return self._new(found)

    def power(self, q):
        """By c d(f^q) = q f^q dc, c_0 not 0; q is a Fraction."""
        c, q = self.units, Fraction(q)
        with mp.workprec(self.bits + 20):
            found = [_units(mp.ldexp(c[0], -self.bits) ** (mp.mpf(q.numerator) / q.denominator), self.bits)]
        for j in range(1, len(c)):
            total = sum((q.numerator * i - q.denominator * (j - i)) * c[i] * found[j - i] for i in range(1, j + 1))
            found.append(total // (q.denominator * j * c[0]))
        return self._new(found)

    def exp(self):
        c = [i * one for i, one in enumerate(self.units)]
        with mp.workprec(self.bits + 20):
            found = [_units(mp.exp(mp.ldexp(self.units[0], -self.bits)), self.bits)]
        for j in range(1, len(c)):
            found.append((sum(map(mul, found, c[j:0:-1])) >> self.bits) // j)
        return self._new(found)

    def slope(self):
        return self._new([j * a for j, a in enumerate(self.units)][1:] + [0])

    def integral(self):
        return self._new([0] + [a // (j + 1) for j, a in enumerate(self.units[:-1])])


def _units(number, bits):
    return int(mp.ldexp(mp.mpmathify(number), bits))


class Linear:
    def __init__(self, mu1, b):
        self.rest, self.b = mp.mpf(mu1), mp.mpf(b)
        self.yields, self.breaks, self.poles = True, (), ()

    def inertial(self, mu):
        return (mu / self.rest - 1) / self.b

    def slope(self, mu):
        return mu * 0 + self.rest * self.b


class Saturating:
    def __init__(self, mu1, mu2, I0):
        self.rest, self.mu2, self.I0 = mp.mpf(mu1), mp.mpf(mu2), mp.mpf(I0)
        self.yields, self.breaks, self.poles = True, (), (self.mu2,)

    def inertial(self, mu):
        return (mu - self.rest) * self.I0 / (mu * -1 + self.mu2)

    def slope(self, mu):
        left = mu * -1 + self.mu2
        return left * left / ((self.mu2 - self.rest) * self.I0)


class Regularised:
    def __init__(self, mu1, mu2, I0, alpha, mu_inf):
        self.rest, self.mu2, self.I0, self.alpha, self.mu_inf = map(mp.mpf, (mu1, mu2, I0, alpha, mu_inf))
        self.yields = False
        low, high = mp.mpf(10) ** -9, None
        for _ in range(400):
            high = low * mp.mpf("1.1")
            if self._C(high) <= 0:
                break
            low = high
        self.I1 = mp.findroot(self._C, (low, high), solver="anderson", tol=mp.mpf(10) ** -60)
        self.join = self._upper(self.I1)
        self.A = self.I1 * mp.exp(self.alpha / self.join**2)
        self.breaks, self.poles = (self.join,), (self.mu2,)

    def _upper(self, I):  # noqa: E741
        return (self.rest * self.I0 + self.mu2 * I + self.mu_inf * I**2) / (self.I0 + I)

    def _C(self, I):  # noqa: E741
        mu, slope = self._upper(I), mp.diff(self._upper, I)
        r = I * slope / mu
        return 4 * r**2 - 4 * r + mu**2 * (1 - r / 2) ** 2

    def inertial(self, mu):
        """mu is a series about a value on either branch: the last argument of `slow` decides."""
        if mu.slow:
            return ((mu * mu).power(-1) * -self.alpha).exp() * self.A
        fall, rise = mu * -1 + self.mu2, (mu - self.rest) * self.I0
        root = (fall * fall + rise * (4 * self.mu_inf)).power(Fraction(1, 2))
        return (root - fall) / (2 * self.mu_inf)

    def slope(self, mu):
        inertial = self.inertial(mu)
        if mu.slow:
            return mu * mu * mu / (inertial * (2 * self.alpha))
        below = inertial + self.I0
        return (inertial * (inertial + 2 * self.I0) * self.mu_inf + (self.mu2 - self.rest) * self.I0) / (below * below)


def dune(law, shields, Re, depth, k, guess, creep=None, digits=30, radius=1e-3):
    """The root next to `guess`; `law` is a class above and its parameters, as a tuple."""
    wall = cache(lambda prec: _response(k, Re, depth))

    def conditions(state, tau, speed, sigma):
        v, w, t, n = state
        q = -n - 2j * k * tau * v
        return t + tau * wall(mp.mp.prec) * q, w - (sigma + 1j * k * speed) * q

    return _root(_determinant(law, shields, creep, mp.mpf(k), 1, conditions), guess, digits, radius)


def plate(law, shields, inertia, k, guess, creep=None, digits=30, radius=1e-3):
    """The root next to `guess` of grains under a rigid plate: u = w = 0 there."""
    return _root(_determinant(law, shields, creep, mp.mpf(k), mp.mpf(inertia), lambda state, *_: state[:2]), guess,
                 digits, radius)


def _determinant(law, shields, creep, k, rho, conditions):
    """The determinant of two `conditions` on top of a bed, a function of sigma."""
    kind, *parameters = law

    @cache
    def steps(prec):
        """The law's part of the work, once for each precision."""
        made = kind(*parameters)
        tau = made.rest * mp.mpf(shields)
        return made, tau, list(_steps(made, tau, creep and mp.mpf(creep)))

    def determinant(sigma):
        with mp.extraprec(40):
            states, tau, speed = _climbed(*steps(mp.mp.prec), k, rho, sigma)
            one, other = (conditions(state, tau, speed, sigma) for state in states)
            D = one[0] * other[1] - one[1] * other[0]
        return D, mp.mag(D) - mp.mp.prec if D else -mp.mp.prec

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


def _climbed(law, tau, walk, k, rho, sigma):
    """The states (v, w, t, n) that two solutions have on top of a bed, its shear stress, and the velocity there."""
    start = (None, mp.mpf(0)) if law.yields else (mp.mpf(0), mp.mpf(0))
    states, speed = [(*start, mp.mpf(t), mp.mpf(n)) for t, n in ((1, 0), (0, 1))], mp.mpf(0)
    for number, (step, base) in enumerate(walk):
        singular = law.yields and not number
        states = [_advance(base, tau, k, rho, sigma, speed, state, step, singular) for state in states]
        speed += mp.fsum(base[4].c)
    return states, tau, speed


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


def _coefficients(law, tau, pressure, slow, step):
    """Series in Y, the height over the step: g, and what the equations are made of."""
    terms = int(mp.mp.prec / -mp.log(_RATIO, 2)) + 12
    p = Series.of([pressure, -step] + [mp.mpf(0)] * (terms - 2))
    mu = p.power(-1) * tau
    mu.slow = slow
    inertial, slope, root = law.inertial(mu), law.slope(mu), p.power(Fraction(1, 2))
    g = inertial * root
    if law.yields and abs(g.units[0]) < 1 << (_SPARE + 10):
        g.units[0] = 0
    dg = g.slope()
    beta = slope * root
    return g, dg, beta.power(-1) * step, (mu - inertial * slope / 2) / beta * step, g.integral() * step


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


def _advance(base, tau, k, rho, sigma, speed, state, step, singular):
    """The state (v, w, t, n) a step higher: u = g v."""
    bits = mp.mp.prec + 40

    def fixed(x):
        x = mp.mpmathify(x)
        return Fixed(int(mp.ldexp(x.real, bits)), int(mp.ldexp(x.imag, bits)), bits)

    g, dg, loss, press, U = ([int(mp.ldexp(x, bits)) for x in one.c] for one in base)
    terms = len(g)
    first = list(state)
    if singular:  # order 0 of g v' + g' v = (t - alpha q)/beta - i k w: g_0 = 0, and w = 0
        first[0] = (base[2].c[0] * state[2] + base[3].c[0] * state[3]) / (
            base[1].c[0] - base[3].c[0] * 2j * k * tau)
    v, w, t, n = (_Column(x, bits) for x in first)
    gv = _Column(0, bits)
    gv.re, gv.im = [], []
    g_, dg_, loss_, press_, U_ = (one[::-1] for one in (g, dg, loss, press, U))
    ik, twist, rate, drag, h, wave = map(fixed, (
        1j * k * step, 2j * k * tau, rho * (sigma + 1j * k * speed) * step, 4 * k**2 * tau * step, rho * step,
        1j * k * rho * step))
    for j in range(terms - 2):
        gv.append(v.times(g_, j))
        u, lift, slip = gv.last(), w.times(g_, j), v.last()
        Su = rate * u + wave * gv.times(U_, j)
        Sw = rate * w.last() + wave * w.times(U_, j)
        old_t, old_n, old_w = t.last(), n.last(), w.last()
        if not singular:
            known = t.times(loss_, j) + n.times(press_, j) + twist * v.times(press_, j) - ik * old_w
            known = known - v.times(dg_, j) - _slopes(v, g_, j)
        w.append(-1 * (ik * u) // (j + 1))
        t.append((Su + h * lift - ik * old_n + drag * slip) // (j + 1))
        n.append((Sw - ik * old_t) // (j + 1))
        if singular:  # order j + 1: v_{j+1} multiplies (j + 1) g_1 + g'_0 - 2 i k tau press_0
            m = j + 1
            known = t.times(loss_, m) + n.times(press_, m) + twist * v.times(press_, m) - ik * w.last()
            known = known - v.times(dg_, m) - _slopes(v, g_, m)
            v.append(known / (Fixed(m * g[1] + dg[0], 0, bits) - twist * Fixed(press[0], 0, bits)))
        else:
            v.append(known / Fixed((j + 1) * g[0], 0, bits))
    return [column.number() for column in (v, w, t, n)]


def _slopes(v, g_, m):
    """Coefficient m of g v', as far as v is known."""
    start = len(g_) - 1 - m
    part = g_[start:start + len(v.re) - 1]
    return Fixed(*(sum(map(mul, part, [i * x for i, x in enumerate(side)][1:])) >> v.bits for side in (v.re, v.im)),
                 v.bits)
