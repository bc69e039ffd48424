"""Dispersion relations sigma(k): the surface mode followed from its long-wave limit, or the most unstable mode."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from .errors import ModeLost, ParameterError
from .mode import DEGREES, TOLERANCE, Solver, check_wavenumbers, require
from .spectra import leading_modes
from .threads import one_thread
from .tracking import follow, surface_mode

MODES = ("surface", "most-unstable")


@dataclass(frozen=True)
class DispersionRelation:
    """sigma(k) of one mode. Arrays have shape (points,), in the order of k.

    `lost` maps wavenumbers at which the mode could not be followed to the reason (only with
    strict=False); they are left out of the arrays. `collisions` lists the mergers met on the way.
    """

    flow: Any
    mode: str
    modes: tuple
    lost: dict
    collisions: tuple

    @property
    def k(self):
        return np.array([mode.k for mode in self.modes])

    @property
    def sigma(self):
        """Complex growth rates."""
        return np.array([mode.sigma for mode in self.modes])

    @property
    def growth_rate(self):
        return self.sigma.real

    @property
    def phase_speed(self):
        return np.array([mode.phase_speed for mode in self.modes])

    @property
    def slope(self):
        """d sigma / dk."""
        return np.array([mode.slope for mode in self.modes])

    @property
    def error(self):
        """Bounds of the absolute error of sigma."""
        return np.array([mode.error for mode in self.modes])

    @property
    def status(self):
        return tuple(mode.status for mode in self.modes)


@one_thread
def dispersion(flow, k, mode="surface", *, tolerance=TOLERANCE, max_degree=DEGREES[-1], strict=True):
    """Return the `DispersionRelation` of a flow at wavenumbers k, a number or a sequence in any order.

    mode="surface" follows the slow surface mode from its long-wave limit; "most-unstable" takes the
    leading mode of the spectrum at each k. `tolerance` bounds error / |sigma|. Raises NotResolved or
    ModeLost; with strict=False the record says in `status` and `lost` what failed.
    """
    wavenumbers = check_wavenumbers(k)
    if mode not in MODES:
        raise ParameterError(f"mode must be one of {', '.join(MODES)} (got {mode!r})")
    solver = Solver(flow, tolerance, max_degree)
    solver.prepare(wavenumbers)
    walk = _surface if mode == "surface" else _most_unstable
    found, lost, collisions = walk(solver, np.unique(wavenumbers))
    if strict:
        for reason in lost.values():
            raise ModeLost(reason)
        for point in found.values():
            require(point)
    return DispersionRelation(flow, mode, tuple(found[value] for value in wavenumbers.tolist() if value in found), lost,
                              tuple(collisions))


def _surface(solver, wavenumbers):
    try:
        path = follow(solver, surface_mode(solver, wavenumbers[0]), wavenumbers)
    except ModeLost as reason:
        return {}, dict.fromkeys(wavenumbers.tolist(), str(reason)), ()
    found = {mode.k: mode for mode in path.modes}
    return found, {k: path.lost for k in wavenumbers.tolist() if k not in found}, path.collisions


def _most_unstable(solver, wavenumbers):
    found, lost = {}, {}
    for k in wavenumbers.tolist():
        leading = leading_modes(solver, k, 1)
        if leading:
            found[k] = leading[0]
        else:
            lost[k] = f"{solver.flow}: no mode settles at k = {k:g}"
    return found, lost, ()
