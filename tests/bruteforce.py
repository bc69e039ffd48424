"""Brute force: all eigenvalues of sheared layers at two degrees, dense scans for the fastest and the critical wave.

    python tests/bruteforce.py kmax|critical|spectrum [--cases N] [--seed S] [--flow NAME] [-o FILE]

They write the tables `tests/tables/bruteforce_*.csv`, row by row; case j of a flow depends on the seed and j alone.
Nothing here is taken from the package: numpy and scipy only. `tests/studies/test_bruteforce.py` compares them with
known values.

Normal mode exp(i k x + sigma t), growth rate Re sigma.

Viscous layers and vortices (Galerkin). With the stream function phi, u = phi', w = -i k phi, and tests of the same kind
(chi real) the momentum equations, multiplied by the conjugate test velocity and integrated over the layer, leave

    rho integral (sigma + i k U)(phi' chi' + k^2 phi chi) - i k U' phi chi'
        + integral eta [4 k^2 phi' chi' + (phi'' + k^2 phi)(chi'' + k^2 chi)] = [t chi' + i k n chi] over the boundary:

no pressure and no condition on a free edge, whose stresses t, n enter by the amplitude s of the displaced surface, and
a kinetic energy that is positive definite: no spurious or infinite eigenvalue. phi'' is a Legendre series, integrated
twice from the wall; functions that vanish with their slope at both ends are those whose phi'' is orthogonal to 1 and z.

Roll waves (collocation). The friction depends on the pressure, which cannot be removed. In zeta = sqrt(1 - z), from the
surface 0 to the wall 1, unknowns are u' and n' at Chebyshev points; w, the shear stress and all else follow by
integration from the edge where they are known, so that there is no other condition and nothing is differentiated. Dunes
likewise, with u = (shear rate) v, which leaves one condition: the friction at the yield surface.
"""
import argparse
import csv
import os
import warnings
from functools import cache
from math import radians, tan

import numpy as np
from numpy.polynomial import chebyshev, legendre
from scipy.linalg import lu_factor, lu_solve
from scipy.special import airye, eval_legendre

HERE = os.path.dirname(os.path.abspath(__file__))
MOST = 480  # highest degree of a layer


class Unresolved(ArithmeticError):
    """Two degrees do not agree."""


# --- Legendre forms on -1 <= x <= 1 ----------------------------------------------------------------------------------

@cache
def _twice_integrated():
    """Gauss points and weights; f'' = normalised P_j (j = 0 .. MOST), f' and f, which vanish at x = -1."""
    x, weights = legendre.leggauss(MOST + 12)
    P = np.array([eval_legendre(j, x) for j in range(MOST + 3)])
    return x, weights, *_integrals(P, x)


def _integrals(P, x):
    j = np.arange(MOST + 1)[:, None]
    scale = np.sqrt(j + 0.5)
    below, below2 = np.vstack([-1 + 0 * x, P[:-1]]), np.vstack([0 * x, 0 * x, P[:-2]])  # P_{j-1}, P_{j-2}
    n = MOST + 1
    first = (P[1:n + 1] - below[:n]) / (2 * j + 1)
    second = ((P[2:n + 2] - P[:n]) / (2 * j + 3) - (P[:n] - below2[:n]) / np.where(j > 0, 2 * j - 1, 1)) / (2 * j + 1)
    second[0] = (x + 1) ** 2 / 2
    second[1] = (x**3 - 3 * x - 2) / 6
    return scale * P[:n], scale * first, scale * second


@cache
def _forms(name):
    """Integrals of products of basis functions (rows: test) with the weights 1, x, x^2; and edge values at x = 1.

    clamped: all f that vanish with f' at x = -1.   hinged: value and slope functions of x = 1, then the bubbles.
    """
    x, weights, d2, d1, d0 = _twice_integrated()
    ends = np.array([1.0])
    _, e1, e0 = _integrals(np.ones((MOST + 3, 1)), ends)
    if name == "hinged":
        cubic = {"value": np.array([0.5, 0.75, 0, -0.25]), "slope": np.array([-0.25, -0.25, 0.25, 0.25])}
        head = [[np.polynomial.polynomial.polyval(x, np.polynomial.polynomial.polyder(c, m)) for c in cubic.values()]
                for m in (2, 1, 0)]
        d2, d1, d0 = (np.vstack([h, f[2:]]) for h, f in zip(head, (d2, d1, d0), strict=True))
    forms = {}
    for power in range(3):
        wx = weights * x**power
        forms["M1", power] = (d1 * wx) @ d1.T  # f' g'
        forms["M0", power] = (d0 * wx) @ d0.T
    forms["D"] = (d2 * weights) @ d2.T
    forms["X"] = (d0 * weights) @ d2.T
    forms["X"] = forms["X"] + forms["X"].T
    forms["C0"] = (d1 * weights) @ d0.T  # test f', trial g
    forms["C1"] = (d1 * (weights * x)) @ d0.T
    forms["value"], forms["slope"] = e0[:, 0], e1[:, 0]
    return forms


def _layer(name, index, half, jac, U, rho, eta):
    """Powers of k of (K, M) of a layer on the chosen basis functions: sigma M + K. U = U0 + U1 x + U2 x^2 in x."""
    forms = _forms(name)
    grid = np.ix_(index, index)

    def pick(key):
        return forms[key][grid]

    U1 = np.array([U[1], 2 * U[2]]) * jac  # dU/dz = U1[0] + U1[1] x
    mass1, mass0 = half * jac**2 * pick(("M1", 0)), half * pick(("M0", 0))
    flux1 = half * jac**2 * sum(U[p] * pick(("M1", p)) for p in range(3))
    flux0 = half * sum(U[p] * pick(("M0", p)) for p in range(3))
    tilt = half * jac * (U1[0] * pick("C0") + U1[1] * pick("C1"))
    K = [eta * half * jac**4 * pick("D"), 1j * rho * (flux1 - tilt),
         eta * (half * jac**2 * pick("X") + 4 * mass1), 1j * rho * flux0, eta * mass0]
    return K, [rho * mass1, 0 * mass1, rho * mass0]


def stepped(degree):
    """Few degrees, a tenth apart, so that matrices serve again."""
    return min(MOST, int(np.exp(np.ceil(np.log(degree) * 10) / 10)))


class Problem:
    """A(k) x = sigma B(k) x with matrix polynomials in k, at any degree."""

    def pencil(self, degree):
        """(A_p, B_p) lists of matrices, coefficients of k^p."""
        raise NotImplementedError

    def at(self, k, degree):
        """A, B, dA/dk, dB/dk."""
        known = self.__dict__.setdefault("_pencils", {})
        if degree not in known:
            if len(known) > 40:
                known.clear()
            known[degree] = self.pencil(degree)
        A, B = known[degree]
        return (sum(k**p * M for p, M in enumerate(A)), sum(k**p * M for p, M in enumerate(B)),
                sum(p * k**(p - 1) * M for p, M in enumerate(A) if p),
                sum(p * k**(p - 1) * M for p, M in enumerate(B) if p))

    def degree(self, k, level):
        """Degree that should do for k; `level` raises it."""
        half, speed, viscosity = self.size
        reach = half * np.sqrt(k**2 + k * speed / viscosity)
        return stepped((12 + 6 * np.sqrt(reach)) * 1.3**level)

    def shift(self, k):
        """A point to the right of the spectrum, for a shift and invert."""
        return k * (0.3 * self.span - 0.5j * self.span) + 0.1 * min(1, k)


class Plates(Problem):
    """u = w = 0 at z = -1 and z = 1, U given; parity 0 even phi, 1 odd phi, None both."""

    def __init__(self, Re, U, parity=None):
        self.Re, self.U, self.parity = Re, U, parity
        self.size = 1.0, 1.0, 1 / Re
        self.span = 1.0

    def shift(self, k):
        centre = 0.5 if self.U[2] else 0
        return k * (0.3 - 1j * centre)

    def pencil(self, degree):
        index = np.arange(2, degree + 1)
        if self.parity is not None:
            index = index[index % 2 == self.parity]
        K, M = _layer("clamped", index, 1.0, 1.0, self.U, 1.0, 1 / self.Re)
        return [-m for m in K], M


def poiseuille(Re, parity=None):
    return Plates(Re, (1.0, 0.0, -1.0), parity)


def couette(Re):
    return Plates(Re, (0.0, 1.0, 0.0))


def cot_deg(angle):
    return tan(radians(90 - angle)) if angle > 45 else 1 / tan(radians(angle))


class Film(Problem):
    """U = 2 z - z^2 on 0 <= z <= 1. Surface: t = 2 s/Re, n = -(2 cot/Re + We k^2) s, sigma s = -i k (phi + s)."""

    def __init__(self, Re, slope_deg, We=0.0):
        self.Re, self.cot, self.We = Re, cot_deg(slope_deg), We
        self.size = 0.5, 1.0, 1 / Re
        self.span = 1.0

    def shift(self, k):
        return k * (0.3 - 0.7j) + 0.05 * min(1, k)

    def pencil(self, degree):
        index = np.arange(degree + 1)
        K, M = _layer("clamped", index, 0.5, 2.0, (0.75, 0.5, -0.25), 1.0, 1 / self.Re)
        forms = _forms("clamped")
        value, slope = forms["value"][index], 2 * forms["slope"][index]
        n = len(index)
        A = [np.zeros((n + 1, n + 1), complex) for _ in range(5)]
        B = [np.zeros((n + 1, n + 1)) for _ in range(3)]
        for a, b in zip(A, K, strict=True):
            a[1:, 1:] = -b
        for a, b in zip(B, M, strict=True):
            a[1:, 1:] = b
        A[0][1:, 0] = 2 / self.Re * slope
        A[1][1:, 0] = -1j * 2 * self.cot / self.Re * value
        A[3][1:, 0] = -1j * self.We * value
        A[1][0, 1:] = -1j * value
        A[1][0, 0] = -1j
        B[0][0, 0] = 1
        return A, B


class TwoLayer(Problem):
    """Wall at z = -n, interface z = 0, plate at z = 1. Unknowns: s, phi(0), the common total slope, bubbles.

    The displaced interface keeps phi' + U' s on both sides; n below less n above is -((r-1) gravity + tension k^2) s.
    """

    def __init__(self, viscosity_ratio, depth_ratio, density_ratio, Re, gravity=0.0, tension=0.0):
        self.m, self.n, self.r, self.Re = viscosity_ratio, depth_ratio, density_ratio, Re
        self.gravity, self.tension = gravity, tension
        self.span = 1.0
        self.speed = self.n / (self.m + self.n)

    def degree(self, k, level):
        lower = self.n / 2 * np.sqrt(k**2 + k * self.Re * self.r / self.m * max(self.speed, 0.1))
        upper = 0.5 * np.sqrt(k**2 + k * self.Re * max(1 - self.speed, 0.1))
        return tuple(stepped((10 + 6 * np.sqrt(x)) * 1.3**level) for x in (lower, upper))

    def pencil(self, degree):
        m, n, r, nu = self.m, self.n, self.r, 1 / self.Re
        low, high = (np.arange(d + 1) for d in degree)
        shear_low, shear_high, c = 1 / (m + n), m / (m + n), self.speed
        layers = ((low, n / 2, 2 / n, (c / 2, c / 2, 0.0), r, m * nu, shear_low),
                  (high, 0.5, -2.0, ((1 + c) / 2, (c - 1) / 2, 0.0), 1.0, nu, shear_high))
        total = 1 + 2 + len(low) - 2 + len(high) - 2
        A = [np.zeros((total, total), complex) for _ in range(5)]
        B = [np.zeros((total, total)) for _ in range(3)]
        start = 3
        for index, half, jac, U, rho, eta, shear in layers:
            K, M = _layer("hinged", index, half, jac, U, rho, eta)
            size = len(index)
            place = np.r_[1, 2, start:start + size - 2]
            start += size - 2
            scale = np.ones(size)
            scale[1] = 1 / jac
            for target, blocks, sign in (A, K, -1), (B, M, 1):
                for a, b in zip(target, blocks, strict=True):
                    a[np.ix_(place, place)] += sign * scale[:, None] * b * scale
                    a[place, 0] += sign * scale * b[:, 1] * (-shear / jac)
        A[1][1, 0] += -1j * (r - 1) * self.gravity
        A[3][1, 0] += -1j * self.tension
        A[1][0, 1] = -1j
        A[1][0, 0] = -1j * c
        B[0][0, 0] = 1
        return A, B


class Vortex(Problem):
    """zeta = sqrt(1 - z) = (1 - x)/2, eta = mu zeta, dz = -2 zeta dzeta, U = 0. Real: w = k phi, u = i phi_z.

    phi_z = f is a polynomial in zeta, f = 0 at the wall x = -1, phi = integral of f dz; phi_zz = -f_zeta/(2 zeta).
    Surface: t = 0, n = -s, sigma s = k phi.
    """

    def __init__(self, slope_deg, Fr2):
        self.mu, self.Fr2 = tan(radians(slope_deg)), Fr2
        self.size = 0.5, 0.0, 1.0
        self.span = 0.0

    def degree(self, k, level):
        return stepped((14 + 6 * np.sqrt(k)) * 1.3**level)

    def shift(self, k):
        return 0.3 * k / (1 + k) + 0j

    def pencil(self, degree):
        x, weights, d2, d1, _ = _twice_integrated()
        # f with f_x = P_j; phi = integral of f zeta dx, since dz = zeta dx, by Gauss rules on [-1, x]
        zeta = (1 - x) / 2
        f, fx = d1[:degree + 1], d2[:degree + 1]
        phi, top = self._phi(degree)
        w = weights * zeta  # dz
        M = [self.Fr2 * (f * w) @ f.T, 0, self.Fr2 * (phi * w) @ phi.T]
        # mu zeta phi_zz phi_zz dz, phi_zz = f_x / zeta
        K = [self.mu * (fx * weights) @ fx.T, 0, 4 * self.mu * (f * w * zeta) @ f.T, 0,
             self.mu * (phi * w * zeta) @ phi.T]
        cross = self.mu * (fx * w) @ phi.T
        K[2] = K[2] + cross + cross.T
        n = degree + 1
        A = [np.zeros((n + 1, n + 1)) for _ in range(5)]
        B = [np.zeros((n + 1, n + 1)) for _ in range(3)]
        for a, b in zip(A, K, strict=True):
            a[1:, 1:] = -np.asarray(b)
        for a, b in zip(B, M, strict=True):
            a[1:, 1:] = b
        A[1][1:, 0] = -top
        A[1][0, 1:] = top
        B[0][0, 0] = 1
        return A, B

    def _phi(self, degree):
        """phi at the Gauss points and at the surface, from the Legendre series of zeta f."""
        x, _, d2, d1, d0 = _twice_integrated()
        _, s1, s0 = _integrals(np.ones((MOST + 3, 1)), np.array([1.0]))
        # integral from -1 of (1 - x)/2 f: by parts (1 - x)/2 g + (1/2) integral of g, g = d0
        n = degree + 1
        j = np.arange(MOST + 3)
        P = np.array([eval_legendre(i, x) for i in range(MOST + 3)])
        g3, top3 = np.empty((n, len(x))), np.empty(n)
        for i in range(n):
            series = np.zeros(i + 1)
            series[i] = np.sqrt(i + 0.5)
            cubic = legendre.legint(series, 3, lbnd=-1)
            g3[i] = cubic @ P[:len(cubic)] if len(cubic) <= len(j) else legendre.legval(x, cubic)
            top3[i] = cubic.sum()
        return (1 - x) / 2 * d0[:n] + g3 / 2, top3 / 2


# --- Chebyshev collocation in integrated form ------------------------------------------------------------------------

@cache
def _integration(n):
    """Chebyshev points of [0, 1]; integrals from 0 and to 1 at those points (minus sign included), and over [0, 1]."""
    x = np.cos(np.pi * (np.arange(n)[::-1] + 0.5) / n)
    V = chebyshev.chebvander(x, n)
    to_series = 2 / n * V[:, :n].T
    to_series[0] /= 2
    into = np.zeros((n + 1, n))
    for j in range(n):
        into[:j + 2, j] = chebyshev.chebint(np.eye(n)[j, :j + 1], 1, lbnd=-1)
    primitive = V @ into @ to_series / 2
    whole = into.sum(axis=0) @ to_series / 2
    return (x + 1) / 2, primitive, primitive - whole, whole


class Powers:
    """Matrix polynomial in k."""

    __array_ufunc__ = None  # matrix @ polynomial comes here

    def __init__(self, terms):
        self.terms = terms

    def __add__(self, other):
        terms = dict(self.terms)
        for p, M in other.terms.items():
            terms[p] = terms[p] + M if p in terms else M
        return Powers(terms)

    def __sub__(self, other):
        return self + -1 * other

    def __rmul__(self, factor):
        return Powers({p: factor * M for p, M in self.terms.items()})

    def __rmatmul__(self, matrix):
        return Powers({p: matrix @ M for p, M in self.terms.items()})

    def up(self, factor=1.0, power=1):
        """Times factor k^power."""
        return Powers({p + power: factor * M for p, M in self.terms.items()})

    def rows(self, weights):
        return Powers({p: weights[:, None] * M for p, M in self.terms.items()})

    def dense(self, most):
        like = next(iter(self.terms.values()))
        return [self.terms.get(p, np.zeros_like(like)) for p in range(most + 1)]


class RollWave(Problem):
    """Unknowns u', n' at n Chebyshev points of zeta and s; ' = d/dzeta, mu = tan(slope), e = I mu'(I).

    u = int_1 u', w = int_1 2 i k zeta u, n = -s + int_0 n', p = -n - 2 i k mu zeta u,
    t = (mu - e/2) p - (e/2)(u' - 2 i k zeta w): constitutive law. Then, with S = Fr2 (sigma + i k U),

        t = mu s + int_0 -2 zeta (S u + Fr2 zeta w - i k n + 4 k^2 mu zeta u),   n' = -2 zeta (S w - i k t),
        (sigma + 2 i k/3) s = w.
    """

    mu1, mu2 = tan(radians(20.9)), tan(radians(32.76))

    def __init__(self, slope_deg, Fr2, mu1=None, mu2=None):
        mu1, mu2 = mu1 or self.mu1, mu2 or self.mu2
        self.mu, self.Fr2 = tan(radians(slope_deg)), Fr2
        self.e = (mu2 - self.mu) * (self.mu - mu1) / (mu2 - mu1)
        self.size = 0.5, 1.0, max(self.e, 0.02) / max(Fr2, 0.1)
        self.span = 2 / 3

    def degree(self, k, level):
        reach = 0.5 * np.sqrt(16 * k**2 + 4 * k * self.Fr2 / self.e)
        return stepped((14 + 6.5 * np.sqrt(reach)) * 1.3**level)

    def pencil(self, degree):
        n, mu, e, F = degree, self.mu, self.e, self.Fr2
        zeta, from0, from1, whole = _integration(n)
        zero = np.zeros((n, n), complex)
        one, column = np.eye(n), np.ones((n, 1))
        du = Powers({0: np.hstack([one, zero, 0 * column])})
        dn = Powers({0: np.hstack([zero, one, 0 * column])})
        s = Powers({0: np.hstack([zero, zero, column])})
        U = 2 / 3 * (1 - zeta**3)
        u = from1 @ du
        w = (from1 @ u.rows(2j * zeta)).up()
        normal = from0 @ dn - s
        p = -1 * normal - u.rows(mu * zeta).up(2j)
        t = (mu - e / 2) * p - (e / 2) * (du - w.rows(zeta).up(2j))
        x_A = u.rows(F * U).up(1j) + w.rows(F * zeta) - normal.up(1j) + u.rows(4 * mu * zeta).up(1, 2)
        z_A = w.rows(F * U).up(1j) - t.up(1j)
        shear_A = mu * s + from0 @ x_A.rows(-2 * zeta) - t
        shear_B = from0 @ u.rows(2 * F * zeta)
        normal_A = z_A.rows(-2 * zeta) - dn
        normal_B = w.rows(2 * F * zeta)
        surface_w = (-whole[None, :] @ u.rows(2j * zeta)).up()
        last = np.zeros((1, 2 * n + 1), complex)
        last[0, -1] = 1
        kinematic_A = surface_w - Powers({1: 2j / 3 * last})
        A = [np.vstack(x) for x in zip(*(y.dense(4) for y in (shear_A, normal_A, kinematic_A)), strict=True)]
        B = [np.vstack(x) for x in zip(*(y.dense(1) for y in (shear_B, normal_B, Powers({0: last}))), strict=True)]
        return A, B


class Dune(Problem):
    """Bed between the yield surface zeta = r = sqrt(shields) and the interface zeta = 1 under an unbounded fluid.

    With theta = shields, u = (theta - zeta^2)/(b zeta) v: continuity, friction and momentum read, ' = d/dzeta,

        w' = 2 i k (theta - zeta^2)/b v,    w = 0 at r,    p = -n - 2 i k mu1 theta v,    S = sigma + i k U,
        t = mu1/(2 zeta^2) [(theta + zeta^2)(v + p) + 2 i k b zeta^3 w - zeta (theta - zeta^2) v'],
        t' = -2/b (theta - zeta^2)(S v + w) - 2 zeta (4 k^2 mu1 theta v - i k n),    t = -mu1 theta R s at 1,
        n' = -2 zeta (S w - i k t),    p = s and (sigma + i k U) s = w at 1.

    Unknowns: v' and n' at n points, v at r, s. The friction at r itself, where v' drops out, is the equation for v(r).
    """

    def __init__(self, shields, mu1, b, Re):
        self.shields, self.mu1, self.b, self.Re = shields, mu1, b, Re
        self.r = np.sqrt(shields)
        self.speed = 2 / (3 * b) * (self.r - 1) ** 2 * (2 * self.r + 1)
        self.span = self.speed

    def degree(self, k, level):
        reach = (self.shields - 1) / 2 * (k + 0.5 * np.sqrt(k))
        return stepped((22 + 8 * np.sqrt(reach)) * 1.3**level)

    def shift(self, k):
        return 0.2 * min(k, 1) + k * self.span * (0.3 - 0.5j)

    def at(self, k, degree):
        known = self.__dict__.setdefault("_pencils", {})
        if degree not in known:
            known[degree] = self.pencil(degree)
        A, B, C = known[degree]
        h = 1e-4 * k
        R = wall_response(k, self.Re)
        dR = (8 * (wall_response(k + h, self.Re) - wall_response(k - h, self.Re))
              - wall_response(k + 2 * h, self.Re) + wall_response(k - 2 * h, self.Re)) / (12 * h)
        return (sum(k**p * M for p, M in enumerate(A)) + R * C, sum(k**p * M for p, M in enumerate(B)),
                sum(p * k**(p - 1) * M for p, M in enumerate(A) if p) + dR * C,
                sum(p * k**(p - 1) * M for p, M in enumerate(B) if p))

    def pencil(self, degree):
        n, r, theta, mu1, b = degree, self.r, self.shields, self.mu1, self.b
        x, from0, from1, whole = _integration(n)  # x = 0 at the interface, 1 at the yield surface
        length = r - 1
        x = np.r_[x, 1.0]  # and the yield surface itself
        zeta = 1 + length * x
        depth = length * (1 - x)  # r - zeta
        slack = depth * (r + zeta)
        U = 2 / (3 * b) * depth**2 * (2 * r + zeta)
        down = length * np.vstack([from0, whole])  # integrals from the interface
        up = length * np.vstack([from1, np.zeros(n)])  # from the yield surface
        size = 2 * n + 2
        unit = np.eye(size, dtype=complex)
        ones = np.ones((n + 1, 1))
        dv, dn, v_r, s = (Powers({0: M}) for M in (unit[:n], unit[n:2 * n], unit[2 * n:2 * n + 1], unit[2 * n + 1:]))
        v = up @ dv + ones @ v_r
        top_v = v_r - length * whole[None, :] @ dv
        flow = v.rows(2j * slack / b).up()
        w = up[:, :] @ _inner(flow, n)
        top_w = -length * whole[None, :] @ _inner(flow, n)
        normal = down @ dn + ones @ (-1 * s - top_v.up(2j * mu1 * theta))
        p = -1 * normal - v.up(2j * mu1 * theta)
        lifted = np.vstack([np.eye(n), np.zeros(n)]) @ dv  # times slack, which is 0 at the yield surface
        t = ((v + p).rows(theta + zeta**2) + w.rows(2j * b * zeta**3).up() - lifted.rows(zeta * slack)) \
            .rows(mu1 / (2 * zeta**2))
        x_A = (v.rows(U).up(1j) + w).rows(-2 / b * slack) - v.rows(2 * zeta).up(4 * mu1 * theta, 2) \
            + normal.rows(2 * zeta).up(1j)
        shear_A = down @ _inner(x_A, n) - t
        shear_B = down @ _inner(v.rows(2 / b * slack), n)
        normal_A = _inner((w.rows(U).up(1j) - t.up(1j)).rows(-2 * zeta), n) - dn
        normal_B = _inner(w.rows(2 * zeta), n)
        kinematic_A = top_w - s.up(1j * self.speed)
        A = [np.vstack(y) for y in zip(*(z.dense(5) for z in (shear_A, normal_A, kinematic_A)), strict=True)]
        B = [np.vstack(y) for y in zip(*(z.dense(2) for z in (shear_B, normal_B, s)), strict=True)]
        C = np.zeros((size, size))
        C[:n + 1, -1] = -mu1 * theta
        return A, B, C


def _inner(powers, n):
    """Rows at the first n points."""
    return Powers({p: M[:n] for p, M in powers.terms.items()})


def wall_response(k, Re):
    """-Ai(x0) / integral_0^inf Ai(x0 + f z) exp(-k z) dz, f = (i k Re)^(1/3), x0 = k^2/f^2, by panels of points."""
    f = (k * Re) ** (1 / 3) * np.exp(1j * np.pi / 6)
    x0 = (k / f) ** 2
    x, weights = legendre.leggauss(40)
    total, z, panel = 0, 0.0, 0.5 / (k + abs(f))
    while True:
        points = z + panel * (x + 1) / 2
        at = x0 + f * points
        values = airye(at)[0] * np.exp(-2 / 3 * at * np.sqrt(at) + 2 / 3 * x0 * np.sqrt(x0) - k * points)
        part = panel / 2 * weights @ values
        total += part
        z += panel
        if abs(part) < 1e-18 * abs(total):
            return -airye(x0)[0] / total


# --- eigenvalues -----------------------------------------------------------------------------------------------------

def eigenvalues(problem, k, degree):
    """All finite eigenvalues at one degree, by decreasing growth rate, unpolished."""
    A, B, _, _ = problem.at(k, degree)
    shift = problem.shift(k)
    inverse = np.linalg.eigvals(np.linalg.solve(A - shift * B, B.astype(complex)))
    size = np.abs(inverse)
    inverse = inverse[size > 1e-9 * size.max()]
    sigma = shift + 1 / inverse
    return sigma[np.argsort(-sigma.real)]


def polish(problem, k, degree, guess, steps=3):
    """Two-sided Rayleigh quotient next to the guess: sigma, d sigma/dk, rounding error."""
    A, B, dA, dB = problem.at(k, degree)
    sigma = guess
    rng = np.random.default_rng(1)
    n = len(A)
    x, y = rng.standard_normal(n) + 0j, rng.standard_normal(n) + 0j
    for _ in range(steps):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # a singular matrix is what we are after
            lu = lu_factor(A - sigma * B, check_finite=False)
            if not np.abs(np.diag(lu[0])).min() > 0:
                lu = lu_factor(A - sigma * (1 + 1e-14) * B, check_finite=False)
        for _ in range(2):
            x = lu_solve(lu, B @ x, check_finite=False)
            y = lu_solve(lu, B.T @ y, trans=1, check_finite=False)
            x /= np.abs(x).max()
            y /= np.abs(y).max()
        old, weight = sigma, y @ B @ x
        sigma = (y @ A @ x) / weight
        if abs(sigma - old) < 1e-13 * abs(sigma):
            break
    if not np.isfinite(sigma):
        raise Unresolved(f"k = {k:g}: inverse iteration failed next to {guess:g}")
    rounding = 2e-16 * (np.abs(y) @ (np.abs(A) @ np.abs(x) + abs(sigma) * (np.abs(B) @ np.abs(x)))) / abs(weight)
    return sigma, (y @ dA @ x - sigma * (y @ dB @ x)) / weight, rounding


def leading(problem, k, margin=0.02, most=6, tolerance=1e-7):
    """Leading modes [(sigma, d sigma/dk)]: the first and all near-neutral ones, each agreed on by two degrees.

    Eigenvalues of one degree are recomputed at the next; the degree rises until those among the first `most` agree.
    """
    for level in range(7):
        degree, higher = problem.degree(k, level), problem.degree(k, level + 1)
        sigmas = eigenvalues(problem, k, degree)
        near = [s for i, s in enumerate(sigmas[:most]) if i == 0 or s.real > -margin * abs(s)]
        modes = []
        for guess in near:
            try:
                sigma, slope, _ = polish(problem, k, higher, guess, steps=2)
            except Unresolved:
                sigma = complex(np.nan)
                break
            if abs(sigma - guess) > tolerance * abs(guess) + 1e-9 * k:
                break
            if all(abs(sigma - m[0]) > 1e-9 * abs(sigma) for m in modes):
                modes.append((sigma, slope))
        else:
            return modes
        if higher == degree:
            break
    raise Unresolved(f"k = {k:g}: {guess:g} at degree {degree}, {sigma:g} at {higher}")


def exact(problem, k, guess, tolerance=1e-10):
    """(sigma, d sigma/dk, error) of the mode next to the guess, the difference of two degrees in the error."""
    level, old = 1, None
    while True:
        sigma, slope, rounding = polish(problem, k, problem.degree(k, level), guess)
        if old is not None:
            error = abs(sigma - old) + rounding
            if error <= max(tolerance * max(abs(sigma.real), 1e-3 * abs(sigma)), 3 * rounding):
                return sigma, slope, error
            if problem.degree(k, level) == problem.degree(k, level + 1):
                raise Unresolved(f"k = {k:g}: {old:g} and {sigma:g}")
        old = guess = sigma
        level += 1


# --- the fastest wave ------------------------------------------------------------------------------------------------

class Scan:
    """Largest growth rate over all modes and a range of k, from points and the slopes of near-neutral modes there.

    An interval is halved while one of its modes, going on 1.5 times as steeply as at an end, would pass the largest
    growth rate so far.
    """

    def __init__(self, problem, ks, floor=2e-15):
        self.problem, self.ks, self.floor = problem, list(ks), floor
        self.points, self.unresolved, self.best = {}, [], (0.0, None, None, None)

    def look(self, k):
        try:
            modes = leading(self.problem, k)
        except Unresolved:
            self.unresolved.append(k)
            modes = []
        self.points[k] = modes
        for sigma, slope in modes:
            if sigma.real > max(self.best[0], self.floor * abs(sigma)):
                self.best = sigma.real, k, sigma, slope
        return modes

    def bound(self, low, high):
        step = np.log(high / low) * 1.5
        bounds = [s.real + d.real * low * step for s, d in self.points[low] if d.real > 0]
        bounds += [s.real - d.real * high * step for s, d in self.points[high] if d.real < 0]
        return max(bounds, default=-np.inf)

    def run(self, sign_only=False, narrowest=1e-3, hint=()):
        """Scan; with `sign_only` stop at the first growing wave. Returns whether one grows."""
        for k in hint:
            self.look(k)
            if sign_only and self.best[1]:
                return True
        for k in self.ks:
            if k not in self.points:
                self.look(k)
            if sign_only and self.best[1]:
                return True
        while True:
            ks = sorted(self.points)
            wanted = [(low, high) for low, high in zip(ks, ks[1:], strict=False) if high / low > 1 + narrowest
                      and self.bound(low, high) > self.best[0] * (1 + 1e-9) + self.floor * low]
            if not wanted or len(ks) > 2000:
                return self.best[1] is not None
            for low, high in wanted:
                self.look(float(np.sqrt(low * high)))
                if sign_only and self.best[1]:
                    return True


def summit(problem, k, sigma, slope, low, high, tolerance=1e-10):
    """Follow a mode to the nearest maximum of its growth rate: k, sigma, error; k = low or high if it lies there."""
    def gradient(log_k, known):
        """(log k, k dg/dk, sigma, slope, error), predicted from a known point."""
        k, k_old = np.exp(log_k), np.exp(known[0])
        sigma, slope, error = exact(problem, k, known[2] + known[3] * (k - k_old))
        return log_k, k * slope.real, sigma, slope, error

    here = gradient(np.log(k), (np.log(k), 0, sigma, slope))
    bounds, step = np.log([low, high]), 0.01
    other = None
    for _ in range(400):
        if here[1] == 0:
            return np.exp(here[0]), here[2], here[4]
        target = min(max(here[0] + step * np.sign(here[1]), bounds[0]), bounds[1])
        if target == here[0]:
            return np.exp(target), here[2], here[4]
        other = gradient(target, here)
        if other[1] * here[1] <= 0:
            break
        here, step = other, min(step * 1.3, 0.1)
    else:
        raise Unresolved("no maximum")
    a, b = here, other
    for i in range(60):  # regula falsi, every third step a bisection
        middle = (a[0] + b[0]) / 2 if i % 3 == 2 else a[0] - a[1] * (b[0] - a[0]) / (b[1] - a[1])
        c = gradient(middle, min(a, b, key=lambda x: abs(x[0] - middle)))
        ends = [x for x in (a, b) if x[1] * c[1] <= 0]
        if not ends or c[1] == 0:
            return np.exp(c[0]), c[2], c[4]
        a, b = c, ends[0]
        if abs(a[0] - b[0]) < tolerance or abs(c[1]) * abs(a[0] - b[0]) < 1e-13 * abs(c[2].real):
            break
    best = min(a, b, key=lambda x: abs(x[1]))
    return np.exp(best[0]), best[2], best[4]


KS = np.geomspace(1e-3, 100, 121)


def fastest(problem, ks=KS):
    """(status, k_max, sigma, error, unresolved k) of the fastest wave over all modes and low <= k <= high."""
    scan = Scan(problem, ks)
    if not scan.run():
        return "stable", None, None, None, scan.unresolved
    _, k, sigma, slope = scan.best
    k, sigma, error = summit(problem, k, sigma, slope, ks[0], ks[-1])
    status = "falls" if k <= ks[0] * (1 + 1e-12) else "rises" if k >= ks[-1] * (1 - 1e-12) else "maximum"
    return status, k, sigma, error, scan.unresolved


# --- cases -----------------------------------------------------------------------------------------------------------

def _log(rng, low, high):
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def _sometimes(rng, low, high):
    return _log(rng, low, high) if rng.random() < 0.5 else 0.0


def _film(rng, slope=(0.005, 90), Re=(10, 2e4)):
    return {"slope_deg": _log(rng, *slope), "Re": _log(rng, *Re), "We": _sometimes(rng, 1e-4, 1)}


def _two_layer(rng):
    """Half of them with gravity, half with tension."""
    return {"viscosity_ratio": _log(rng, 0.05, 20), "depth_ratio": _log(rng, 0.1, 10),
            "density_ratio": float(rng.uniform(1, 5)), "Re": _log(rng, 1, 2e3),
            "gravity": _sometimes(rng, 1e-2, 10), "tension": _sometimes(rng, 1e-3, 1)}


def _rollwave(rng):
    return {"slope_deg": float(rng.uniform(21.75, 30.06)), "Fr2": _log(rng, 0.1, 50)}


MAKE = {"film": Film, "two_layer_couette": TwoLayer, "rollwave": RollWave, "vortex": Vortex, "couette": couette,
        "poiseuille": poiseuille, "dune": Dune}
PARAMETERS = ("slope_deg", "Re", "We", "Fr2", "viscosity_ratio", "depth_ratio", "density_ratio", "gravity", "tension")


def cases(table, flow, number, seed):
    """Parameters of cases 0 .. number - 1 of a flow."""
    draw = {"kmax": {"film": _film, "two_layer_couette": _two_layer, "rollwave": _rollwave},
            "critical": {"film": lambda rng: _film(rng, slope=(0.005, 10)), "two_layer_couette": _two_layer,
                         "rollwave": _rollwave}}[table][flow]
    for j in range(number):
        yield j, draw(np.random.default_rng([seed, sum(map(ord, table + flow)), j]))


class Table:
    """CSV written row by row, after a header of comments."""

    def __init__(self, path, comments, columns):
        self.columns, self.path = columns, path
        with open(path, "w", encoding="utf-8") as file:
            file.writelines(f"# {line}\n" for line in comments)
            file.write(",".join(columns) + "\n")

    def add(self, row):
        with open(self.path, "a", encoding="utf-8") as file:
            csv.writer(file, lineterminator="\n").writerow(_shown(row.get(c)) for c in self.columns)


def _shown(value):
    if value is None:
        return ""
    return repr(float(value)) if isinstance(value, float) else str(value)


def write_kmax(path, numbers, seed):
    table = Table(path, (
        "source: tests/bruteforce.py kmax: all modes at two degrees (Galerkin, or collocation in integrated form), "
        f"{len(KS)} log-spaced k and more wherever a near-neutral mode might pass the largest growth rate",
        "table: fastest growing wave over all modes and 1e-3 <= k <= 100, exp(i k x + sigma t); status maximum, stable "
        "(no wave grows), rises (growth still rises at k = 100), falls (it falls from k = 1e-3 on)",
        "scaling: that of the flows; roll waves with mu1 = tan 20.9 deg, mu2 = tan 32.76 deg",
        "digits: error bounds |sigma| by two degrees and rounding; k_max to about the square root of error/growth or "
        "better; unresolved: number of scanned k without agreement, damped ones counted",
        "known misprints: none"),
        ("flow", "case", *PARAMETERS, "status", "k_max", "growth_rate", "frequency", "error", "unresolved"))
    for flow, number in numbers.items():
        for case, parameters in cases("kmax", flow, number, seed):
            row = {"flow": flow, "case": case, **parameters}
            try:
                status, k, sigma, error, missed = fastest(MAKE[flow](**parameters))
            except Unresolved as problem:
                row |= {"status": f"unresolved: {problem}"}
            else:
                row |= {"status": status, "unresolved": len(missed)}
                if k:
                    row |= {"k_max": float(k), "growth_rate": float(sigma.real), "frequency": float(sigma.imag),
                            "error": float(f"{error:.1e}")}
            table.add(row)


# --- thresholds ------------------------------------------------------------------------------------------------------

WIDE = np.r_[np.geomspace(1e-6, 1e-2, 17)[:-1], np.geomspace(1e-2, 100, 49)]  # 0 < k <= 100 down to long waves
VARY = {"film": ("Re", 1.0, 2e4), "two_layer_couette": ("Re", 1.0, 4e3), "rollwave": ("Fr2", 0.05, 50.0)}


class Critical:
    """Values of one parameter at which the largest growth rate over all modes and 0 < k <= 100 changes sign."""

    def __init__(self, make, name, low, high, fixed, values=31):
        self.make, self.name, self.fixed = make, name, fixed
        self.grid = [float(p) for p in np.geomspace(low, high, values)]
        self.hint, self.unresolved = None, 0

    def problem(self, p):
        return self.make(**{**self.fixed, self.name: p})

    def look(self, p, all_of_them=False):
        """Scan at one value of the parameter, up to the first growing wave or all of it."""
        scan = Scan(self.problem(p), WIDE)
        scan.run(not all_of_them, hint=[self.hint] if self.hint else ())
        self.unresolved += len(scan.unresolved)
        if scan.best[1]:
            self.hint = scan.best[1]
        return scan

    def grows(self, p):
        return self.look(p).best[1] is not None

    def run(self):
        """(list of (value, k, sigma, error), whether waves grow at the lowest value)."""
        signs = [self.grows(p) for p in self.grid]
        found = []
        for a, b, before, after in zip(self.grid, self.grid[1:], signs, signs[1:], strict=False):
            if before != after:
                found.append((*(self.edge(b, a) if after else self.edge(a, b)), 1 if after else -1))
        return found, signs[0]

    def edge(self, unstable, stable):
        """(value, k, relative error) where the last growing wave ends between an unstable and a stable value."""
        for halving in range(60):
            if halving % 4 == 3 or abs(unstable / stable - 1) < 1e-6:
                for attempt in (self.long_waves, self.wave):
                    try:
                        p, k, error = attempt(unstable, stable)
                    except (Unresolved, ValueError):
                        continue
                    beyond = p * (1 + 3e-9 * np.sign(stable - unstable))
                    if not self.grows(beyond):
                        return p, k, error
                    if (beyond - unstable) * (stable - beyond) > 0:
                        unstable = beyond
            middle = float(np.sqrt(unstable * stable))
            if self.grows(middle):
                unstable = middle
            else:
                stable = middle
            if abs(unstable / stable - 1) < 1e-10:
                return middle, self.hint, 1e-10
        raise Unresolved("no threshold")

    def long_waves(self, unstable, stable):
        """Threshold of the growth rate over k^2 as k -> 0 between the two values."""
        most = max(unstable, stable)
        problem = self.problem(most)
        k = 1e-4 / most if self.name == "Re" else 1e-5
        if isinstance(problem, TwoLayer):
            k /= max(1, problem.r / problem.m) * max(1, problem.n) ** 2

        def growth(p, k):
            problem = self.problem(p)
            sigma = leading(problem, k)[0][0]
            return exact(problem, k, sigma)[0].real / k**2

        roots = []
        for wave in (k, 2 * k):
            ends = [growth(p, wave) for p in (unstable, stable)]
            if not ends[0] > 0 > ends[1]:
                raise ValueError("long waves do not change sign here")
            roots.append(root(lambda p, wave=wave: growth(p, wave), unstable, stable, *ends))
        p = (4 * roots[0] - roots[1]) / 3
        return p, 0.0, abs(roots[1] / roots[0] - 1) / 100 + 1e-11

    def wave(self, unstable, stable):
        """Follow the fastest wave from the unstable value to where its largest growth rate vanishes."""
        scan = self.look(unstable, all_of_them=True)
        _, k, sigma, slope = scan.best
        k, sigma, error = summit(scan.problem, k, sigma, slope, WIDE[0], WIDE[-1])
        states = {unstable: (k, sigma)}
        errors = {}

        def height(p):
            near = min(states, key=lambda q: abs(q - p))
            k, sigma = states[near]
            problem = self.problem(p)
            sigma, slope, _ = exact(problem, k, sigma)
            k, sigma, errors[p] = summit(problem, k, sigma, slope, WIDE[0], WIDE[-1])
            if k < 2e-6:
                raise ValueError("a long wave")
            states[p] = k, sigma
            return sigma.real

        lowest = height(stable)
        if lowest > 0:
            raise ValueError("the wave grows on")
        p = root(height, unstable, stable, states[unstable][1].real, lowest)
        last = min(states, key=lambda q: abs(q - p))
        slope = abs(states[unstable][1].real - lowest) / abs(unstable - stable)
        return p, float(states[last][0]), errors[last] / (slope * p)


def root(function, a, b, fa, fb, tolerance=3e-12):
    """Zero of a function between a and b, where it has opposite signs: regula falsi (Illinois)."""
    kept = 0
    for _ in range(80):
        c = b - fb * (b - a) / (fb - fa)
        fc = function(c)
        if fc == 0:
            return c
        if (fc > 0) == (fa > 0):
            a, fa = c, fc
            if kept == 1:
                fb /= 2
            kept = 1
        else:
            b, fb = c, fc
            if kept == 2:
                fa /= 2
            kept = 2
        if abs(a - b) < tolerance * abs(c) or abs(fc) * abs(b - a) < tolerance * abs(c) * abs(fb - fa) * 0.1:
            return c
    return c


def write_critical(path, numbers, seed):
    table = Table(path, (
        f"source: tests/bruteforce.py critical: scans of all modes over {len(WIDE)} and more k at 31 log-spaced values "
        "of the parameter, each change of sign followed to the root",
        "table: all values of a parameter at which the largest growth rate over all modes and 0 < k <= 100 (1e-6 <= k "
        "in the scans) changes sign, exp(i k x + sigma t); one row each, or one that says stable or unstable for the "
        "whole range; turns +1: unstable above, -1: below; k 0: long waves, k 100: at the end of that range; the "
        "varied parameter is left empty among the parameters",
        "scaling: that of the flows; roll waves with mu1 = tan 20.9 deg, mu2 = tan 32.76 deg",
        "digits: relative error bound of the value in error; k to about half as many digits; unresolved: number of "
        "scanned (value, k) without agreement of two degrees",
        "known misprints: none"),
        ("flow", "case", *PARAMETERS, "vary", "low", "high", "status", "value", "k", "turns", "error", "unresolved"))
    for flow, number in numbers.items():
        vary, low, high = VARY[flow]
        for case, parameters in cases("critical", flow, number, seed):
            parameters.pop(vary)
            row = {"flow": flow, "case": case, **parameters, "vary": vary, "low": low, "high": high}
            search = Critical(MAKE[flow], vary, low, high, parameters)
            try:
                found, unstable = search.run()
            except Unresolved as problem:
                table.add(row | {"status": f"unresolved: {problem}", "unresolved": search.unresolved})
                continue
            row["unresolved"] = search.unresolved
            if not found:
                table.add(row | {"status": "unstable" if unstable else "stable"})
            for p, k, error, turns in found:
                table.add(row | {"status": "threshold", "value": float(p), "k": float(k), "turns": turns,
                                 "error": float(f"{error:.1e}")})


# --- spectra ---------------------------------------------------------------------------------------------------------

def leading_spectrum(problem, k, most=30, agreement=1e-8):
    """([(sigma, error)] by decreasing growth rate, why the list ends): as long as two high degrees agree.

    The dense eigenvalues of both degrees are recomputed one by one; each must stay where it is, all must be different,
    and no other eigenvalue of either degree may lie above the last one listed.
    """
    more = most if getattr(problem, "parity", None) is None else 2 * most
    degrees = [np.minimum(MOST, np.asarray(problem.degree(k, level)) + int(level * more)) for level in (2, 3.2)]
    degrees = [tuple(map(int, degree)) if degree.ndim else int(degree) for degree in degrees]
    lists = [eigenvalues(problem, k, degree)[:3 * most + 10] for degree in degrees]
    found, end = [], "enough"
    for guess in lists[1]:
        if len(found) == most:
            break
        try:
            fine, _, rounding = polish(problem, k, degrees[1], guess)
            coarse, _, _ = polish(problem, k, degrees[0], fine)
        except Unresolved:
            end = "inverse iteration"
            break
        error = abs(fine - coarse) + rounding
        if rounding > agreement * abs(fine):
            end = "rounding"
            break
        if error > agreement * abs(fine) or abs(fine - guess) > 1e-3 * abs(fine):
            end = "degrees disagree"
            break
        if any(abs(fine - other) <= 10 * (error + bar) for other, bar in found):
            end = "no two distinct modes"
            break
        found.append((fine, error))
    found.sort(key=lambda mode: (-round(mode[0].real, 12), mode[0].imag))
    while found:  # the same number above the last one at either degree
        last = found[-1][0]
        level = last.real + 1e-6 * abs(last)
        if all(sum(x.real > level for x in values) <= sum(s.real > level for s, _ in found) for values in lists):
            break
        found.pop()
        end = "numbers of modes differ"
    return found, end


def _spectrum_case(flow, rng):
    k = _log(rng, 0.05, 30)
    if flow in ("poiseuille", "couette"):
        return {"Re": _log(rng, 10, 3e5)}, k
    if flow == "film":
        return _film(rng, slope=(0.01, 90), Re=(1, 3e5)), k
    if flow == "two_layer_couette":
        return _two_layer(rng) | {"Re": _log(rng, 1, 1e4)}, k
    if flow == "rollwave":
        return _rollwave(rng), k
    return {"slope_deg": float(rng.uniform(5, 80)), "Fr2": _log(rng, 1e-2, 50)}, k


def write_spectrum(path, numbers, seed):
    table = Table(path, (
        "source: tests/bruteforce.py spectrum: dense eigenvalues at two high degrees, each polished by two-sided "
        "Rayleigh quotients at both",
        "table: leading modes by growth rate, exp(i k x + sigma t), one row per mode; plane Poiseuille flow by class, "
        "parity 0: even w, 1: odd w; listed: modes of the case in the table, complete from the top; end: why the list "
        "ends there: enough (30 modes), rounding (error bar of the next above 1e-8 |sigma|), degrees disagree, no two "
        "distinct modes (dense eigenvalues blurred by rounding), numbers of modes differ",
        "scaling: that of the flows; roll waves with mu1 = tan 20.9 deg, mu2 = tan 32.76 deg",
        "digits: error bounds |sigma|; modes of equal growth rate in the order of their frequencies",
        "known misprints: none"),
        ("flow", "case", *PARAMETERS, "k", "parity", "listed", "end", "rank", "growth_rate", "frequency", "error"))
    for flow, number in numbers.items():
        for case in range(number):
            parameters, k = _spectrum_case(flow, np.random.default_rng([seed, sum(map(ord, "spectrum" + flow)), case]))
            for parity in (0, 1) if flow == "poiseuille" else (None,):
                problem = MAKE[flow](**parameters) if parity is None else poiseuille(**parameters, parity=parity)
                found, end = leading_spectrum(problem, k)
                row = {"flow": flow, "case": case, **parameters, "k": k, "parity": parity, "listed": len(found),
                       "end": end}
                if not found:
                    table.add(row)
                for rank, (sigma, error) in enumerate(found, 1):
                    table.add(row | {"rank": rank, "growth_rate": float(sigma.real), "frequency": float(sigma.imag),
                                     "error": float(f"{error:.1e}")})


NUMBERS = {"kmax": {"film": 80, "two_layer_couette": 80, "rollwave": 40},
           "critical": {"film": 100, "two_layer_couette": 63, "rollwave": 45},
           "spectrum": dict.fromkeys(("vortex", "film", "two_layer_couette", "rollwave", "poiseuille", "couette"), 25)}
WRITE = {"kmax": write_kmax, "critical": write_critical, "spectrum": write_spectrum}


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("table", choices=[*WRITE])
    parser.add_argument("--cases", type=int, help="cases of each flow (default: as many as in the table kept)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--flow", help="this flow alone")
    parser.add_argument("-o", help="file (default: tests/tables/bruteforce_TABLE.csv)")
    given = parser.parse_args()
    numbers = {flow: given.cases or number for flow, number in NUMBERS[given.table].items()
               if given.flow in (None, flow)}
    WRITE[given.table](given.o or os.path.join(HERE, "tables", f"bruteforce_{given.table}.csv"), numbers, given.seed)


if __name__ == "__main__":
    main()
