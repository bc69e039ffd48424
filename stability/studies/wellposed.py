"""Where a flow's own model fails: ill-posed strips of its layers, and the internal modes that live there.

In a layer whose short waves grow without bound (`flows.rheology`) the spectrum at one k may still
converge: waves across the strip cannot be shorter than it is thick. Its internal modes then grow ever faster with k,
and beyond some k no degree resolves them. The slow surface mode need not notice, but it is not what one would see.
"""

from dataclasses import dataclass

import numpy as np

from ..modes.solver import Solver
from ..numerics.threads import one_thread
from .dispersion import dispersion
from .outgrown import leading_rate

DEGREES = (16, 24, 32, 48, 64)

_SETTLED = 1e-4  # relative difference of two degrees that counts as converged


@dataclass(frozen=True, eq=False)
class Growth:
    """Largest growth rate of all modes at wavenumber k, by degree (degrees,), and that of the surface mode, or None."""

    k: float
    degrees: tuple
    rates: np.ndarray
    surface: float | None

    @property
    def settled(self):
        """Whether the last two degrees agree."""
        return abs(self.rates[-1] - self.rates[-2]) <= _SETTLED * abs(self.rates[-1])


@one_thread
def growth_with_degree(flow, k, degrees=DEGREES):
    """Return the `Growth` at each wavenumber: does the spectrum converge, does an internal mode outgrow the surface?"""
    solver = Solver(flow)
    wavenumbers = np.unique(np.asarray(k, dtype=float))
    surface = {}
    if flow.has_surface_mode():
        found = dispersion(flow, wavenumbers, strict=False)
        surface = {mode.k: mode.growth_rate for mode in found.modes}
    return tuple(Growth(value, tuple(degrees), np.array([leading_rate(solver, value, degree) for degree in degrees]),
                        surface.get(value)) for value in wavenumbers.tolist())
