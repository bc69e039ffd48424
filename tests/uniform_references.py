"""Multi-precision eigenvalues of flows in which the inertial number is uniform, under any friction law.

    rollwave(law, slope_deg, Fr2, k, guess)           waves down an inclined plane
    plane_shear(law, inertial, inertia, k, guess)     grains between plates, without gravity

`law` is a name in `FRICTION` and its parameters, as a tuple. All that enters of it are mu and e = I mu'(I), the
derivative by differences of many digits.
"""

import mpmath as mp
from references import _det, _grains, _root


def _regularised(I, mu1, mu2, I0, alpha, mu_inf):  # noqa: E741
    def upper(I):  # noqa: E741
        return (mu1 * I0 + mu2 * I + mu_inf * I**2) / (I0 + I)

    def C(I):  # noqa: E741
        r = I * mp.diff(upper, I) / upper(I)
        return 4 * r**2 - 4 * r + upper(I) ** 2 * (1 - r / 2) ** 2

    low = mp.mpf(10) ** -9
    while C(low * 2) > 0:
        low *= 2
    join = mp.findroot(C, (low, 2 * low), solver="anderson", tol=mp.mpf(10) ** -(2 * mp.mp.dps))
    if join <= I:
        return upper(I)
    return mp.sqrt(alpha / (mp.log(join / I) + alpha / upper(join) ** 2))


FRICTION = {
    "linear": lambda x, mu1, b: mu1 * (1 + b * x),
    "power": lambda x, mu1, b, n: mu1 * (1 + b * x**n),
    "saturating": lambda x, mu1, mu2, I0: mu1 + (mu2 - mu1) / (1 + I0 / x),
    "regularised": _regularised,
}


def _of(law):
    name, *parameters = law
    numbers = [mp.mpf(one) for one in parameters]
    return lambda I: FRICTION[name](I, *numbers)  # noqa: E741


def rollwave(law, slope_deg, Fr2, k, guess, digits=30, radius=1e-3):
    """Roll waves: `references.rollwave` with e = I mu'(I) at mu = tan(slope) from the law."""
    def determinant(sigma):
        mu, k_, F = mp.tan(mp.radians(mp.mpf(slope_deg))), mp.mpf(k), mp.mpf(Fr2)
        e = _slope_at(_of(law), mu)
        first, error1 = _grains(sigma, k_, F, mu, e, (0, sigma + 2j * k_ / 3, mu, -1))
        second, error2 = _grains(sigma, k_, F, mu, e, (1, 0, 0, 0))
        return _det(first, error1, second, error2)

    return _root(determinant, guess, digits, radius)


def _slope_at(friction, mu):
    """e at a friction coefficient."""
    low = high = mp.mpf(1)
    while friction(low) > mu:
        low /= 2
    while friction(high) < mu:
        high *= 2
    I = mp.findroot(lambda I: friction(I) - mu, (low, high), solver="anderson",  # noqa: E741
                    tol=mp.mpf(10) ** -(2 * mp.mp.dps - 10))
    return I * mp.diff(friction, I)


def plane_shear(law, inertial, inertia, k, guess, digits=30, radius=1e-3):
    """Grains between rigid plates at z = 0 and 1: U = z, p = 1, so that with S = sigma + i k z

        w' = -i k u,    u' = (t - (mu - e/2) q)/e - i k w,    q = -n - 2 i k mu u,
        t' = rho (S u + w) - i k n + 4 k^2 mu u,              n' = rho S w - i k t :

    entire functions of z. On the plates u = w = 0.
    """
    def determinant(sigma):
        with mp.extraprec(60):  # of differences
            mu, I = _of(law)(mp.mpf(inertial)), mp.mpf(inertial)  # noqa: E741
            e = I * mp.diff(_of(law), I)
        one, other = (_sheared(mu, e, mp.mpf(inertia), mp.mpf(k), sigma, start) for start in ((1, 0), (0, 1)))
        lost = max(one[2] * abs(other[0]), one[2] * abs(other[1]), other[2] * abs(one[0]), other[2] * abs(one[1]))
        return one[0] * other[1] - one[1] * other[0], mp.mag(lost) - mp.mp.prec + 10

    return _root(determinant, guess, digits, radius)


def _sheared(mu, e, rho, k, sigma, start):
    """u and w on the upper plate of the solution with t, n = start on the lower one, and its largest term."""
    state = [mp.mpc(0), mp.mpc(0), mp.mpc(start[0]), mp.mpc(start[1])]
    total, before, largest, j, quiet = state[:2], (0, 0), mp.mpf(1), 0, 0
    while quiet < 6:
        u, w, t, n = state
        q = -n - 2j * k * mu * u
        slopes = ((t - (mu - e / 2) * q) / e - 1j * k * w, -1j * k * u,
                  rho * (sigma * u + 1j * k * before[0] + w) - 1j * k * n + 4 * k**2 * mu * u,
                  rho * (sigma * w + 1j * k * before[1]) - 1j * k * t)
        before, j = state[:2], j + 1
        state = [one / j for one in slopes]
        total = [sum(pair) for pair in zip(total, state[:2], strict=True)]
        size = max(map(abs, state))
        largest, quiet = max(largest, size), quiet + 1 if size < mp.ldexp(1, -mp.mp.prec) else 0
    return *total, largest
