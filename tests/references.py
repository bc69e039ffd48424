"""Multi-precision eigenvalues of sheared layers, from power series.

    vortex(slope_deg, Fr2, k, guess)                 cross-slope waves on an inclined granular layer
    rollwave(slope_deg, Fr2, mu1, mu2, k, guess)     down-slope waves on the same
    dune(shields, mu1, b, Re, depth, k, guess)       granular bed under a sheared fluid
    wall_response(k, Re, depth)                      shear stress of that fluid on a wavy wall
    poiseuille(Re, k, guess), couette(Re, k, guess)  viscous flow between plates at z = -1 and z = 1
    film(Re, slope_deg, We, k, guess)                viscous film on an inclined plane
    two_layer_couette(viscosity_ratio, depth_ratio, density_ratio, Re, gravity, tension, k, guess)

Normal mode exp(i k x + sigma t); `guess` is an approximate sigma. The eigenvalue functions return the root
next to it to `digits` significant digits of |sigma|, and raise ArithmeticError if there is none within
`radius * |guess|`, or if it takes more than `_MOST_BITS` bits or `_MOST_TERMS` terms. Parameters are taken exactly:
0.4 is the binary number nearest 0.4, mpf("0.4") is 2/5.

With zeta = sqrt(1 - z), the surface of the inclined granular layer is an ordinary point and the solution is
entire; the yield surface of the bed, zeta = sqrt(shields), is a regular singular point with a three-parameter
bounded family, whose series converge for 0 < zeta < 2 sqrt(shields). Viscous layers obey the Orr-Sommerfeld
equation, whose solutions are entire. Each layer then leaves two unknown coefficients and two conditions at its
other edge, whose determinant is a function of sigma alone. At large Reynolds numbers the two solutions grow alike and
their determinant is a small difference: that costs bits, nothing else.
"""
import cmath
from functools import cache
from itertools import count, islice

import mpmath as mp

_MOST_BITS = 4000
_MOST_TERMS = 8000


class Fixed:
    """Complex number in units of 2**-bits: its sums are exact, its products rounded, both far faster than mpc's."""

    __slots__ = "re", "im", "bits"

    def __init__(self, re, im, bits):
        self.re, self.im, self.bits = re, im, bits

    @classmethod
    def of(cls, x):
        """Round a number to the working precision, mp.prec bits after the point."""
        x = mp.mpmathify(x)
        return cls(int(mp.ldexp(x.real, mp.mp.prec)), int(mp.ldexp(x.imag, mp.mp.prec)), mp.mp.prec)

    def number(self):
        return mp.mpc(mp.ldexp(self.re, -self.bits), mp.ldexp(self.im, -self.bits))

    def length(self):
        return max(self.re.bit_length(), self.im.bit_length())

    def __add__(self, other):
        return Fixed(self.re + other.re, self.im + other.im, self.bits)

    def __sub__(self, other):
        return Fixed(self.re - other.re, self.im - other.im, self.bits)

    def __mul__(self, other):
        a, b, c, d = self.re, self.im, other.re, other.im
        return Fixed((a * c - b * d) >> self.bits, (a * d + b * c) >> self.bits, self.bits)

    def __rmul__(self, integer):
        return Fixed(integer * self.re, integer * self.im, self.bits)

    def __truediv__(self, other):
        a, b, c, d = self.re, self.im, other.re, other.im
        norm = c * c + d * d
        return Fixed(((a * c + b * d) << self.bits) // norm, ((b * c - a * d) << self.bits) // norm, self.bits)

    def __floordiv__(self, integer):
        return Fixed(self.re // integer, self.im // integer, self.bits)

    def shifted(self, factor, shift):
        return Fixed((self.re * factor) >> shift, (self.im * factor) >> shift, self.bits)


def _total(terms, power=1):
    """Sum tuples of series terms until six in a row are down to rounding, which grows like j^power at most.

    Returns the sums as mpmath numbers, and log2 of their rounding error: a rounding in an early term grows
    with the later ones, hence the largest term.
    """
    total, longest, quiet = next(terms), 0, 0
    bits = total[0].bits
    for j, term in enumerate(islice(terms, _MOST_TERMS), 1):
        total = [a + b for a, b in zip(total, term, strict=True)]
        length = max(a.length() for a in term)
        longest, quiet = max(longest, length), quiet + 1 if length <= 6 + power * j.bit_length() else 0
        if quiet == 6:
            return [a.number() for a in total], max(longest - bits, 0) - bits + power * j.bit_length() + 6
    raise ArithmeticError(f"power series not converged after {_MOST_TERMS} terms")


def _det(first, error1, second, error2):
    """Determinant of two columns known to 2^error1 and 2^error2, and log2 of its own error."""
    (a, c), (b, d) = first, second
    return a * d - b * c, 1 + max(error1 + mp.mag(abs(b) + abs(d)), error2 + mp.mag(abs(a) + abs(c)))


def _root(determinant, guess, digits, radius):
    """Secant iteration for determinant(sigma) -> (value, log2 of its rounding error), then a check at more bits."""
    guess = sigma = mp.mpc(guess)
    prec = int(3.33 * digits) + 64
    with mp.workprec(prec):
        accuracy, start = mp.mpf(10) ** -(digits + 1), 1 + mp.mpf(10) ** -9
    for _ in range(8):
        with mp.workprec(prec):
            old = sigma * start
            f_old = determinant(old)[0]
            for _ in range(20):
                f, rounding = determinant(sigma)
                slope = (f - f_old) / (sigma - old)
                short = rounding - mp.mag(slope * sigma * accuracy) if slope else prec  # no accurate digit at all
                if short > 0:
                    break
                old, f_old = sigma, f
                sigma -= f / slope
                if abs(sigma - guess) > radius * abs(guess):
                    raise ArithmeticError(f"no root within {radius} of {mp.nstr(guess)}: reached {mp.nstr(sigma)}")
                if abs(sigma - old) < accuracy * abs(sigma):
                    break
            else:
                raise ArithmeticError(f"secant iteration from {mp.nstr(guess)} not converged")
        if short > 0:
            prec += short + 24
            if prec > _MOST_BITS:
                raise ArithmeticError(f"root near {mp.nstr(guess)} takes {prec} bits")
            continue
        with mp.workprec(prec + prec // 4):
            if abs(determinant(sigma)[0] / slope) > 10 * accuracy * abs(sigma):
                raise ArithmeticError(f"root {mp.nstr(sigma)} moves when the precision is raised")
        with mp.workdps(digits + 3):
            return +sigma
    raise ArithmeticError(f"determinant near {mp.nstr(guess)} has no accurate digit at {prec} bits")


def vortex(slope_deg, Fr2, k, guess, digits=30, radius=1e-3):
    """Growth rate of cross-slope waves on a granular inclined plane, thesis (4.14)-(4.20) without U.

    Let T = tan(slope), s = Fr2 sigma/T, and scale u -> i u, t -> i T t, n -> T n. Then, with ' = d/dzeta,

        u' = -2 t + 2 zeta k w,        t' = -2 zeta (s u - k n + 4 zeta k^2 u),
        w' = -2 zeta k u,              n' = -2 zeta (s w + k t).

    Surface zeta = 0, of amplitude T: t = 0, n = -1, w = sigma T. Wall zeta = 1: u = w = 0.
    """
    def series(s, k, *start):
        u, w, t, n = ([0 * s, 0 * s, x] for x in start)
        k2 = k * k
        for j in count(1):
            yield u[-1], w[-1], t[-1], n[-1]
            after = (k * w[-2] - t[-1], -1 * (k * u[-2]),
                     k * n[-2] - s * u[-2] - 4 * (k2 * u[-3]), -1 * (s * w[-2] + k * t[-2]))
            u, w, t, n = ([f[1], f[2], 2 * x // j] for f, x in zip((u, w, t, n), after, strict=True))

    def determinant(sigma):
        T = mp.tan(mp.radians(mp.mpf(slope_deg)))
        s, kk, zero, one, w0 = map(Fixed.of, (mp.mpf(Fr2) * sigma / T, mp.mpf(k), 0, 1, sigma * T))
        (u1, w1, _, _), e1 = _total(series(s, kk, zero, w0, zero, -1 * one))
        (u2, w2, _, _), e2 = _total(series(s, kk, one, zero, zero, zero))
        return _det((u1, w1), e1, (u2, w2), e2)

    return _root(determinant, guess, digits, radius)


def rollwave(slope_deg, Fr2, mu1, mu2, k, guess, digits=30, radius=1e-3):
    """Growth rate of down-slope waves on a granular inclined plane with the saturating friction law mu(I).

    Stresses are tau_ij = (mu(I) p/g) (d_i u_j + d_j u_i), g the shear rate, I ~ g/sqrt(p). On the base flow
    g = zeta, p = zeta^2, U = (2/3)(1 - zeta^3), mu = tan(slope), zeta = sqrt(1 - z), small changes give, with
    e = I mu'(I) = (mu2 - mu)(mu - mu1)/(mu2 - mu1),

        shear stress   t = mu p + e zeta^2 (g/zeta - p/(2 zeta^2)),    g = du/dz + i k w  the change of shear rate,
        normal stress  n = -p + 2 mu zeta dw/dz                        across the layer, its opposite sign along it,

    and momentum and continuity, with S = Fr2 (sigma + i k U), d/dz = -(1/(2 zeta)) d/dzeta and ' = d/dzeta,

        w' = 2 i k zeta u,     u' = (2/e)((mu - e/2) p - t) + 2 i k zeta w,     p = -n - 2 i k mu zeta u,
        t' = -2 zeta (S u + Fr2 zeta w - i k n + 4 k^2 mu zeta u),     n' = -2 zeta (S w - i k t).

    Surface zeta = 0, displaced by s into base stresses mu (1 - z) and z - 1: t = mu s, n = -s,
    w = (sigma + 2 i k/3) s. Wall zeta = 1: u = w = 0.
    """
    def determinant(sigma):
        k_, F = mp.mpf(k), mp.mpf(Fr2)
        mu, low, high = mp.tan(mp.radians(mp.mpf(slope_deg))), mp.mpf(mu1), mp.mpf(mu2)
        e = (high - mu) * (mu - low) / (high - low)
        first, error1 = _grains(sigma, k_, F, mu, e, (0, sigma + 2j * k_ / 3, mu, -1))
        second, error2 = _grains(sigma, k_, F, mu, e, (1, 0, 0, 0))
        return _det(first, error1, second, error2)

    return _root(determinant, guess, digits, radius)


def _grains(sigma, k, F, mu, e, start):
    """(u, w) of `rollwave` at the wall from (u, w, t, n) at the surface, and log2 of their error."""
    stiff = 2 * (mu - e / 2) / e
    rate, wave, speed, lift, drag, press, ik, loss = map(Fixed.of, (
        -2 * F * (sigma + 2j * k / 3), 2j * k, 4j * k * F / 3, -2 * F, -8 * k**2 * mu, -stiff, 2j * k, -2 / e))
    tilt = Fixed.of(-2j * k * mu * stiff)

    def series():
        u, w, t, n = ([0 * x, 0 * x, 0 * x, 0 * x, x] for x in map(Fixed.of, start))
        for j in count(1):
            yield u[-1], w[-1]
            after = (press * n[-1] + loss * t[-1] + tilt * u[-2] + wave * w[-2],
                     wave * u[-2],
                     rate * u[-2] + speed * u[-5] + lift * w[-3] + ik * n[-2] + drag * u[-3],
                     rate * w[-2] + speed * w[-5] + ik * t[-2])
            u, w, t, n = ([*f[1:], x // j] for f, x in zip((u, w, t, n), after, strict=True))

    return _total(series())


def dune(shields, mu1, b, Re, depth, k, guess, digits=30, radius=1e-3):
    """Growth rate of waves on a granular bed under a sheared fluid, thesis (4.59)-(4.70).

    Let a^2 = shields, zeta = a (1 - x), s = 1 - x, g = 1 - 2 i k mu1 a^2, U = (2 a^3/3b) x^2 (3 - x), and scale
    u = U' v, w = -(2 i k a^3/b) W, t = (mu1/2) T, so that p = -n - (1 - g) v. Then, with ' = d/dx,

        W' = x (2 - x) v
        T' = x (2 - x) A + s B,    A = (4 a^3/(b mu1)) [(sigma + i k U) v + w],    B = 16 k^2 a^4 v - (4 i k a^2/mu1) n
        n' = s C,                  C = 2 a^2 [(sigma + i k U) w - i k t]
        x (1 - x) (2 - x) v' = n - g v + s^2 Q,                    Q = n - g v + T - 4 k^2 a^4 s W.

    Yield surface x = 0: W = 0 and v bounded. Interface x = 1 - 1/a: T + 2 shields R p = 0, w = (sigma + i k U) p.
    """
    @cache
    def response(prec):
        return _response(k, Re, depth)

    def determinant(sigma):
        return _bed(sigma, response(mp.mp.prec), *(mp.mpf(x) for x in (shields, mu1, b, k)))

    return _root(determinant, guess, digits, radius)


def _bed(sigma, R, shields, mu1, b, k):
    """Determinant of the interface conditions of `dune`, and log2 of its error."""
    a = mp.sqrt(shields)
    U = 2 * (a - 1)**2 * (2 * a + 1) / (3 * b)
    columns = []
    for n0, T0 in (1, 0), (0, 1):
        (v, W, T, n), rounding = _total(_bed_series(sigma, a, mu1, b, k, n0, T0))
        p = -n - 2j * k * mu1 * shields * v
        columns += [(T + 2 * shields * R * p, -2j * a**3 / b * W - (sigma / k + 1j * U) * p), rounding]
    D, rounding = _det(*columns)
    largest = (1 + 2 * shields * abs(R)) * (1 + a**3 / b + abs(sigma / k) + U) * (1 + 2 * k * mu1 * shields)
    return D, rounding + mp.mag(largest)


def _bed_series(sigma, a, mu1, b, k, n0, T0):
    """Terms (v, W, T, n)_j x^j at the interface, for n = n0 and T = T0 at the yield surface."""
    drag, wave, speed = 4 * a**3 / (b * mu1), -2j * k * a**3 / b, 2j * k * a**3 / (3 * b)
    drag_sigma, drag_speed, drag_w = (Fixed.of(drag * x) for x in (sigma, speed, wave))
    lift_sigma, lift_speed, lift_t = (Fixed.of(2 * a**2 * x) for x in (wave * sigma, wave * speed, -0.5j * k * mu1))
    push_v, push_n, tilt = (Fixed.of(x) for x in (16 * k**2 * a**4, -4j * k * a**2 / mu1, 4 * k**2 * a**4))
    g, x, one, zero = (Fixed.of(x) for x in (1 - 2j * k * mu1 * a**2, 1 - 1 / a, 1, 0))
    W, T, n = [zero] * 4, [zero] * 3 + [T0 * one], [zero] * 3 + [n0 * one]
    v = [zero] * 3 + [(2 * n[-1] + T[-1]) / (2 * g)]
    A, B, C, Q = ([zero] * 2 for _ in range(4))
    power, shift = 1, 0                                   # x^j = power / 2^shift, to full relative precision
    for j in count(1):
        yield [f[-1].shifted(power, shift) for f in (v, W, T, n)]
        A.append(drag_sigma * v[-1] + drag_speed * (3 * v[-3] - v[-4]) + drag_w * W[-1])
        B.append(push_v * v[-1] + push_n * n[-1])
        C.append(lift_sigma * W[-1] + lift_speed * (3 * W[-3] - W[-4]) + lift_t * T[-1])
        Q.append(n[-1] - g * v[-1] + T[-1] - tilt * (W[-1] - W[-2]))
        W.append((2 * v[-2] - v[-3]) // j)
        T.append((2 * A[-2] - A[-3] + B[-1] - B[-2]) // j)
        n.append((C[-1] - C[-2]) // j)
        v.append((2 * n[-1] + T[-1] - tilt * (W[-1] - W[-2]) - 2 * Q[-1] + Q[-2]
                  + 3 * (j - 1) * v[-1] - (j - 2) * v[-2]) / (2 * (j * one + g)))
        power, shift = power * x.re, shift + x.bits
        excess = max(power.bit_length() - x.bits, 0)
        power, shift = power >> excess, shift - excess


def wall_response(k, Re, depth=mp.inf, digits=30):
    """Shear-stress response R = Psi''(0) of sheared fluid to a wavy wall of amplitude 1, thesis (4.59)-(4.63)."""
    with mp.workdps(digits + 5):
        first = _response(k, Re, depth)
    with mp.workdps(digits + 20):
        if abs(_response(k, Re, depth) - first) > abs(first) * mp.mpf(10) ** -digits:
            raise ArithmeticError(f"wall response at k={k}, Re={Re}, depth={depth} moves when the precision is raised")
    return first


def _response(k, Re, depth):
    """R at the working precision.

    q = Psi'' - k^2 Psi obeys q'' = (k^2 + i k Re z) q, so Psi = sinh(k z)/k + R A + S B, where A is forced by a q
    that decays from 1 at the wall and B by one that decays from 1 at the lid. Outside its layer each is a sum
    of exp(k z) and exp(-k z), and both amplitudes of Psi must vanish at the lid; or the first, without a lid.
    """
    k, depth, gradient = mp.mpf(k), mp.mpf(depth), 1j * mp.mpf(k) * mp.mpf(Re)
    lost = 0.7 * (mp.mp.prec + 20)
    if 2 * k * depth > lost:
        return -1 / _layer(k, k * k, gradient, lost / (2 * k), lost)[0]
    with mp.workprec(mp.mp.prec + 2 * max(0, -mp.mag(k * depth))):
        up, down = _layer(k, k * k, gradient, depth, lost)
        lid_up, lid_down = _layer(k, k * k + gradient * depth, -gradient, depth, lost)
        lid_down *= mp.exp(-2 * k * depth)
        return (lid_down - lid_up) / (up * lid_up - down * lid_down)


def _layer(k, start, gradient, depth, lost):
    """Amplitudes exp(-+k z) (A' +- k A) beyond the layer, where A'' - k^2 A = q, A(0) = A'(0) = 0, q(0) = 1.

    q'' = (start + gradient z) q vanishes at the end of the layer: at `depth`, or sooner, where q exp(-k z) has
    fallen to exp(-lost). The second amplitude need not be resolved better, as it comes with exp(-2 k depth).
    """
    def decay(z):
        first, last = cmath.sqrt(start), cmath.sqrt(start + gradient * z)
        return (2 / 3 * z * (first**2 + first * last + last**2) / (first + last)).real + float(k) * z

    near, L = 0.0, float(depth)
    while L - near > 0.01 * L:
        middle = (near + L) / 2
        near, L = (near, middle) if decay(middle) > lost else (middle, L)
    L = min(mp.mpf(L), depth)
    growth = L * mp.sqrt(abs(start) + abs(gradient) * L) + 2 * k * L
    with mp.workprec(mp.mp.prec + int(growth / mp.ln2) + 20):
        scaled = start * L**2, gradient * L**3, (k * L)**2
        (q1, p1, d1), (q2, p2, d2) = _forced(*scaled, 1, 0), _forced(*scaled, 0, 1)
        A, dA = L**2 * (p1 - q1 / q2 * p2), L * (d1 - q1 / q2 * d2)
        return mp.exp(-k * L) * (dA + k * A), mp.exp(k * L) * (dA - k * A)


def _forced(start, gradient, k2, value, slope):
    """q, A and A' at z = 1, from q and q' at z = 0, for q'' = (start + gradient z) q and A'' - k2 A = q."""
    def series(start, gradient, k2, one):
        q, A = [0 * one, value * one, slope * one], [0 * one, 0 * one]
        for j in count():
            yield q[1], A[0], j * A[0]
            q, A = ([q[1], q[2], (start * q[1] + gradient * q[0]) // ((j + 1) * (j + 2))],
                    [A[1], (k2 * A[0] + q[1]) // ((j + 1) * (j + 2))])

    return _total(series(*map(Fixed.of, (start, gradient, k2, 1))))[0]


def poiseuille(Re, k, guess, digits=30, radius=1e-3):
    """Growth rate of waves on U = 1 - z^2 between plates at z = -1 and z = 1, where u = w = 0.

    U is even, so that phi is either even or odd: series from the centreline, and phi = phi' = 0 on one plate.
    """
    def determinant(sigma):
        flow = _Viscous(sigma, k, Re, 1, (1, 0, -1))
        even, odd = (_determinant(*zip(*(flow.at_end(*start) for start in starts), strict=True), rows=_stuck)
                     for starts in (((1, 0, 0, 0), (0, 0, 1, 0)), ((0, 1, 0, 0), (0, 0, 0, 1))))
        return even[0] * odd[0], 1 + max(even[1] + mp.mag(odd[0]), odd[1] + mp.mag(even[0]))

    return _root(determinant, guess, digits, radius)


def shear(profile, Re, bottom, top, z_low, z_high, k, guess, digits=30, radius=1e-3):
    """Growth rate of waves on a known velocity between walls: of plane Poiseuille flow alone.

    Raises ArithmeticError for the others; `elements` has references for them.
    """
    if (profile.text(None), bottom, top, z_low, z_high) != ("poiseuille", "wall", "wall", -mp.inf, mp.inf):
        raise ArithmeticError(f"no power series for {profile!r} between {bottom} and {top}")
    return poiseuille(Re, k, guess, digits, radius)


def couette(Re, k, guess, digits=30, radius=1e-3):
    """Growth rate of waves on U = z between plates at z = -1 and z = 1, where u = w = 0: series from z = -1."""
    def determinant(sigma):
        flow = _Viscous(sigma, k, Re, 2, (-1, 2, 0))
        return _determinant(*zip(*map(flow.from_wall, (0, 1)), strict=True), rows=_stuck)

    return _root(determinant, guess, digits, radius)


def film(Re, slope_deg, We, k, guess, digits=30, radius=1e-3):
    """Growth rate of waves on a viscous film, U = 2 z - z^2, between a plane at z = 0 and a free surface at z = 1.

    The surface is displaced by s into the shear stress 2 (1 - z)/Re and pressure 2 cot(slope) (1 - z)/Re of the base
    flow, (sigma + i k) s = w = -i k phi, and its curvature asks for the pressure We k^2 s inside. With S = sigma + i k,

        shear stress:   phi'' + k^2 phi - 2 s = 0,
        i k pressure:   (phi''' - 3 k^2 phi')/Re - S phi' - i k G s = 0,    G = 2 cot(slope)/Re + We k^2.

    Without s, S (phi'' + k^2 phi) + 2 i k phi = 0, and its multiple taken off the other one leaves no root S = 0.
    """
    def determinant(sigma):
        k_, nu = mp.mpf(k), 1 / mp.mpf(Re)
        S = sigma + 1j * k_
        G = 2 * nu * mp.cot(mp.radians(mp.mpf(slope_deg))) + mp.mpf(We) * k_**2
        flow = _Viscous(sigma, k, Re, 1, (0, 2, -1))

        def surface(f, df, ddf, dddf):
            shear = ddf + k_**2 * f
            return S * shear + 2j * k_ * f, 2 * nu * (dddf - 3 * k_**2 * df) - 2 * S * df - 1j * k_ * G * shear

        return _determinant(*zip(*map(flow.from_wall, (0, 1)), strict=True), rows=surface)

    return _root(determinant, guess, digits, radius)


def two_layer_couette(viscosity_ratio, depth_ratio, density_ratio, Re, gravity, tension, k, guess, digits=30,
                      radius=1e-3):
    """Growth rate of waves on two liquids between a plate at rest at z = -n and one of speed 1 at z = 1.

    The upper liquid has density 1 and viscosity 1/Re, the lower one density r and viscosity m/Re; the base flow has the
    shear rates U' = 1/(m + n) below and m/(m + n) above the interface z = 0, which is displaced by s. With
    S = sigma + i k n/(m + n), and [.] what the lower side has more than the upper one,

        [phi] = 0,    [phi' + U' s] = 0,    [viscosity (phi'' + k^2 phi)] = 0,    S s = -i k phi,
        [viscosity (phi''' - 3 k^2 phi') - density (S phi' - i k U' phi)] = i k ((r - 1) gravity + tension k^2) s,

    the last one i k times pressure and viscous normal stress, with the base pressure of both sides at z = s.
    """
    def determinant(sigma):
        m, n, r, k_ = (mp.mpf(x) for x in (viscosity_ratio, depth_ratio, density_ratio, k))
        S, nu = sigma + 1j * k_ * n / (m + n), 1 / mp.mpf(Re)
        weight = (r - 1) * mp.mpf(gravity) + mp.mpf(tension) * k_**2
        lower = _Viscous(sigma, k, r / (m * nu), n, (0, n / (m + n), 0))
        upper = _Viscous(sigma, k, Re, 1, (1, -m / (m + n), 0))

        def sides(density, viscosity, gradient, side):
            """Contributions to the five conditions of a solution on one side, `side` = 1 below and -1 above."""
            def rows(f, df, ddf, dddf):
                df, dddf = side * df, side * dddf  # the upper series runs downwards
                load = viscosity * (dddf - 3 * k_**2 * df) - density * (S * df - 1j * k_ * gradient * f)
                kinematic = 1j * k_ * f if side > 0 else 0
                return [side * x for x in (f, df, viscosity * (ddf + k_**2 * f), load, kinematic)]
            return rows

        below, above = sides(r, m * nu, 1 / (m + n), 1), sides(1, nu, m / (m + n), -1)
        columns, errors = [], []
        for flow, rows in (lower, below), (upper, above):
            for which in 0, 1:
                column, error = flow.from_wall(which)
                columns.append(rows(*column))
                errors.append(error + _gain(rows))
        interface = [0, (1 - m) / (m + n), 0, -1j * k_ * weight, S]
        return _determinant([*columns, interface], [*errors, -mp.mp.prec - 60])

    return _root(determinant, guess, digits, radius)


class _Viscous:
    """Solutions of the Orr-Sommerfeld equation across one viscous layer, 0 <= x <= 1 with z = depth x or reversed.

    Stream function phi: u = dphi/dz, w = -i k phi. The curl of the momentum equations is, with ' = d/dz,

        (sigma + i k U) (phi'' - k^2 phi) - i k U'' phi = (1/Re) (phi'''' - 2 k^2 phi'' + k^4 phi),

    U = U0 + U1 x + U2 x^2. Derivatives in x are those in z times powers of depth.
    """

    def __init__(self, sigma, k, Re, depth, U):
        sigma, k, Re, self.depth = mp.mpc(sigma), mp.mpf(k), mp.mpf(Re), mp.mpf(depth)
        K2 = (k * self.depth)**2
        A, B, C = (Re * self.depth**2 * x for x in (sigma + 1j * k * U[0], 1j * k * U[1], 1j * k * U[2]))
        self._terms = [Fixed.of(x) for x in (2 * K2 + A, B, C, -(K2**2 + K2 * A + 2 * C), -K2 * B, -K2 * C)]

    def from_wall(self, which):
        """Solution with phi = phi' = 0 at x = 0 and either phi'' or phi''' = 1 there, as from `at_end`."""
        return self.at_end(0, 0, 1 - which, which)

    def at_end(self, *start):
        """(phi, phi', phi'', phi''') at x = 1, in z, from those in x at x = 0; and log2 of the error."""
        (f, df, ddf, dddf), error = _total(self._series(*start), power=3)
        d = self.depth
        return (f, df / d, ddf / d**2, dddf / d**3), error + max(0, -3 * mp.mag(d) + 3)

    def _series(self, f, df, ddf, dddf):
        A, B, C, D, E, F = self._terms
        zero, a = 0 * A, [Fixed.of(x) for x in (f, df, mp.mpf(ddf) / 2, mp.mpf(dddf) / 6)]
        a = [zero, zero, *a]
        for j in count():
            f = a[2]
            yield f, j * f, (j * (j - 1)) * f, (j * (j - 1) * (j - 2)) * f
            total = ((j + 2) * (j + 1)) * (A * a[4]) + ((j + 1) * j) * (B * a[3]) + (j * (j - 1)) * (C * a[2]) \
                + D * a[2] + E * a[1] + F * a[0]
            a = [*a[1:], total // ((j + 4) * (j + 3) * (j + 2) * (j + 1))]


def _stuck(f, df, ddf, dddf):
    """No slip: phi = phi' = 0."""
    return f, df


def _determinant(columns, errors, rows=None):
    """Determinant of columns known to 2^errors, after `rows` of each if given; and log2 of its own error."""
    if rows:
        columns, errors = [rows(*column) for column in columns], [error + _gain(rows) for error in errors]
    sizes = [mp.mag(sum(map(abs, column))) for column in columns]
    with mp.workprec(mp.mp.prec + 60):
        value = mp.det(mp.matrix(columns))
    return value, sum(sizes) + max(error - size for error, size in zip(errors, sizes, strict=True)) + 3


def _gain(rows):
    """log2 of the factor by which linear `rows` of four numbers can enlarge an error."""
    return mp.mag(sum(abs(x) for unit in mp.eye(4).tolist() for x in rows(*unit)))
