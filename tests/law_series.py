"""Power series in integers, and what a friction law makes of that of mu: those of I and of mu'(I)."""

from fractions import Fraction
from operator import mul

import mpmath as mp

SPARE = 160  # bits: inertial numbers of creeping grains fall to 1e-20, and slopes of friction rise as far


class Series:
    """Truncated power series, arithmetic with numbers and with each other: integers in units of 2**-bits.

    Far faster than floating point; `SPARE` bits more than the working precision make up for small coefficients.
    """

    def __init__(self, units, bits):
        self.units, self.bits = list(units), bits

    @classmethod
    def of(cls, numbers):
        bits = mp.mp.prec + SPARE
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
        tilt = 2 * self.mu_inf * self.I0  # of the root in `inertial`, whose zeros are its branch points
        bend = mp.sqrt(mp.mpc(tilt * (tilt - 2 * (self.mu2 - self.rest))))
        self.breaks, self.poles = (self.join,), (self.mu2 - tilt + bend, self.mu2 - tilt - bend)

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
