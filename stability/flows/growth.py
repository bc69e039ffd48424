"""How the series of the layers of a creeping flow grow as waves become short: those of deep layers by far most.

Without inertia a perturbation exp(i k (x + m z)) obeys, from the equations of `equations.layer`,

    r (m^2 - 1)^2 - 2 a m^3 + 4 m^2 - 2 a m = 0,    r = I mu'/mu,    a = mu (1 - r/2).

The slower the grains the smaller is r, and two of the roots are near m = a/r: the shorter waves. A series has nearly as
many terms as that of the velocity, and more by two thirds of the radians by which such waves turn (measured). Where
inertia matters others turn by (k rho U/beta)^(1/2) times the height, with the rise of U across the layer: as k grows
slow ones overtake those, which only keep a layer from being taken for one with few waves.
"""

from functools import lru_cache
from math import ceil
from typing import Any

import numpy as np

_NODES = 16
_TURN = 0.65  # terms over radians
_PART, _STEP, _LEAST = 0.8, 4, 20  # terms of fields over those of the velocity; multiples of them, and the least


@lru_cache(maxsize=1)
def nodes() -> tuple[np.ndarray, np.ndarray]:
    """Points in 0 < s < 1 at which a layer is looked at, and weights of an integral over s."""
    places, weights = np.polynomial.legendre.leggauss(_NODES)
    return (1 + places) / 2, weights / 2


def turning(heights: Any, mu: Any, inertial: Any, slope: Any) -> float:
    """Radians over k by which these waves turn across a layer: `heights` are dz/ds, `mu` the friction and `slope`
    mu'(I), at the `nodes`."""
    return float(nodes()[1] @ (heights * (mu**2 / (inertial * slope) - mu / 2)))


def swaying(heights: Any, density: float, rise: float, viscosity: Any) -> float:
    """Radians over k^(1/2) by which waves with inertia turn across a layer whose velocity grows by `rise`: `heights`
    are dz/ds and `viscosity` beta at the `nodes`."""
    return float(nodes()[1] @ (heights * np.sqrt(density * rise / viscosity)))


def growths(lengths: list[int], slow: list[float], swift: list[float]) -> list[tuple[int, float]]:
    """`Layer.growth` of layers in whose series of the velocity there are so many terms, with these phases of waves
    without and with inertia."""
    most = max(slow)
    return [(max(_LEAST, _STEP * ceil(_PART * length / _STEP)), _TURN * min(max(one, other), most))
            for length, one, other in zip(lengths, slow, swift, strict=True)]
