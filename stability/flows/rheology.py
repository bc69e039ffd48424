"""The condition for the equations of motion of a friction law mu(I) to be well posed. Laws: `stability.flows.laws`.

With r = I mu'/mu and tau = mu(I) p, I ~ (shear rate)/sqrt(p), the viscosities of `equations.layer` are

    eta = mu p / (shear rate),    beta = r eta,    alpha = mu (1 - r/2).

Perturbations exp(i k (x cos a + z sin a)) that are short against everything else grow at the rate

    lambda = -(eta k^2/rho) [(1 - r) s^2 - alpha s + r] / (1 - alpha s),    s = sin 2a,

so that they grow without bound as k -> inf where the quadratic has a root in 0 < s < 1. Its discriminant is
the C of Barker, Schaeffer, Bohorquez & Gray (J. Fluid Mech. 779, 2015, 794-818):

    C = 4 r^2 - 4 r + mu^2 (1 - r/2)^2,

well posed where C <= 0, ill posed where C > 0 and r < 1/2, which is where the saturating law has its C > 0.
Above r = 1/2 (rapid flow by the linear law) the root lies beyond s = 1, and C > 0 does no harm, until
alpha > 1 makes the denominator vanish first.
"""

from math import inf
from typing import Any

import numpy as np

_ROUNDING = 1e-14  # of the terms of C
_ANGLES = np.linspace(-1, 1, 401)  # s = sin 2a, odd number: includes 0


def condition(r: np.ndarray, alpha: np.ndarray) -> np.ndarray:
    """C from r = beta/eta = I mu'/mu and alpha = mu (1 - r/2); ill posed where positive.

    >>> from stability.flows.laws import Saturating
    >>> law = Saturating(mu1=0.4, mu2=0.6, I0=0.3)
    >>> bool(law_condition(law, 0.1) < 0 < law_condition(law, 1e-3))
    True
    """
    return 4 * r * (r - 1) + alpha**2


def ill_posed(r: np.ndarray, alpha: np.ndarray) -> np.ndarray:
    """True where short waves of some direction grow without bound: numbers or arrays.

    What is rounding is not: the regularised law is neutral where its branches meet, C(I1) = 0.
    """
    excess = condition(r, alpha)
    root = 2 * r / np.maximum(alpha + np.sqrt(np.maximum(excess, 0)), 1e-300)
    return ((excess > _ROUNDING * (np.abs(r) + alpha**2)) & (root < 1)) | (alpha > 1)


def law_condition(law: Any, I: Any) -> Any:  # noqa: E741
    """C of a friction law at the inertia number I, a number or an array."""
    mu = law.mu(I)
    r = I * law.slope(I) / mu
    return condition(r, mu * (1 - r / 2))


def well_posed_band(law: Any, low: Any = 1e-6, high: Any = 1e6) -> Any:
    """Interval of I on which C <= 0, as (start, stop); None if C > 0 for all low < I < high.

    >>> from math import radians, tan
    >>> from stability.flows.laws import Saturating
    >>> start, stop = well_posed_band(Saturating(tan(radians(20.9)), tan(radians(32.76)), 0.279))
    >>> f"{start:.10f} {stop:.10f}"
    '0.0193500919 0.8522658149'
    """
    grid = np.geomspace(low, high, 2401)
    inside = np.flatnonzero(law_condition(law, grid) <= 0)
    if not len(inside):
        return None
    first, last = inside[0], inside[-1]
    return (_root(law, grid[first - 1], grid[first]) if first else 0.0,
            _root(law, grid[last], grid[last + 1]) if last + 1 < len(grid) else inf)


def short_wave_growth(eta: Any, r: Any, alpha: Any, rho: Any = 1.0) -> Any:
    """Largest lambda / k^2 over the direction of short waves; inf where the pressure equation is not elliptic.

    Arguments are numbers or arrays (points,). Positive where `ill_posed`.
    """
    eta, r, alpha, rho = (np.asarray(value, dtype=float)[..., None] for value in (eta, r, alpha, rho))
    elliptic = np.abs(alpha) < 1
    numerator = (1 - r) * _ANGLES**2 - alpha * _ANGLES + r
    with np.errstate(invalid="ignore"):  # an infinite viscosity leaves neutral directions neutral
        rate = -eta / rho * numerator / np.where(elliptic, 1 - alpha * _ANGLES, 1)
    return np.where(elliptic[..., 0], np.nanmax(rate, axis=-1) + 0.0, inf)


def _root(law: Any, low: Any, high: Any) -> Any:
    """The zero of C between two inertia numbers, by bisection to rounding."""
    rising = law_condition(law, high) > 0
    for _ in range(200):
        middle = 0.5 * (low + high)
        if middle in (low, high):
            break
        low, high = (low, middle) if (law_condition(law, middle) > 0) == rising else (middle, high)
    return float(middle)
