"""Dispersion relations sigma(k): the surface mode followed from its long-wave limit, or the most unstable mode."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from .errors import ModeLost, ParameterError
from .mode import DEGREES, TOLERANCE, Solver, check_wavenumbers, require
from .spectra import converged_rates, leading_modes, polished
from .threads import one_thread
from .tracking import follow, surface_mode

MODES = ("surface", "leading", "most-unstable")

_ROUGH = 1e-4  # tolerance of the way to the first wavenumber
_CLOSE = 1e-2  # relative distance of leading rates within which both are computed properly


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
def dispersion(flow, k, mode=None, *, tolerance=TOLERANCE, max_degree=DEGREES[-1], strict=True):
    """Return the `DispersionRelation` of a flow at wavenumbers k, a number or a sequence in any order.

    mode="surface" follows the slow surface mode from its long-wave limit (the default where the flow has
    one), "leading" follows the least stable mode of the smallest k (the default elsewhere), and
    "most-unstable" takes the least stable mode of the spectrum at each k. `tolerance` bounds error / |sigma|.
    Raises NotResolved or ModeLost; with strict=False the record says in `status` and `lost` what failed.
    """
    wavenumbers = check_wavenumbers(k)
    mode = mode or default_mode(flow)
    if mode not in MODES:
        raise ParameterError(f"mode must be one of {', '.join(MODES)} (got {mode!r})")
    solver = Solver(flow, tolerance, max_degree)
    solver.prepare(wavenumbers)
    walk = {"surface": _surface, "leading": _leading, "most-unstable": _most_unstable}[mode]
    found, lost, collisions = walk(solver, np.unique(wavenumbers))
    if strict:
        for reason in lost.values():
            raise ModeLost(reason)
        for point in found.values():
            require(point)
    return DispersionRelation(flow, mode, tuple(found[value] for value in wavenumbers.tolist() if value in found), lost,
                              tuple(collisions))


def default_mode(flow):
    """The mode that a dispersion relation follows unless told otherwise."""
    return "surface" if flow.has_surface_mode() else "leading"


def _surface(solver, wavenumbers):
    """Follow the surface mode, roughly on the way from its long-wave limit to the first wavenumber."""
    k = wavenumbers[0]
    rough = solver.rough(_ROUGH)
    try:
        way = follow(rough, surface_mode(rough, k), [k])
        if way.lost or way.collisions:  # a close look is needed
            return _followed(solver, wavenumbers, surface_mode(solver, k))
        (near,) = way.modes
        return _followed(solver, wavenumbers, solver.solve(k, near.rate, (near.degree, near.x, near.y)))
    except ModeLost as reason:
        return {}, dict.fromkeys(wavenumbers.tolist(), str(reason)), ()


def _leading(solver, wavenumbers):
    """Follow the leading mode within its symmetry class, on half the domain where the flow has one."""
    k = float(wavenumbers[0])
    try:
        halves = [solver if half == solver.flow else Solver(half, solver.tolerance, solver.degrees[-1])
                  for half in solver.flow.halves()]
        dense = [converged_rates(half, k, 1) for half in halves]
        best = max(rates[0].real for rates, _ in dense)
        rivals = [(polished(half, k, 1, *found)[0], half) for half, found in zip(halves, dense, strict=True)
                  if found[0][0].real > best - _CLOSE * abs(found[0][0])]
        first, solver = max(rivals, key=lambda rival: rival[0].growth_rate)
        solver.prepare(wavenumbers)
        return _followed(solver, wavenumbers, first)
    except ModeLost as reason:
        return {}, dict.fromkeys(wavenumbers.tolist(), str(reason)), ()


def _followed(solver, wavenumbers, first):
    path = follow(solver, first, wavenumbers)
    found = {mode.k: mode for mode in path.modes}
    return found, {k: path.lost for k in wavenumbers.tolist() if k not in found}, path.collisions


def _most_unstable(solver, wavenumbers):
    found, lost = {}, {}
    for k in wavenumbers.tolist():
        try:
            (found[k],) = leading_modes(solver, k, 1)
        except ModeLost as reason:
            lost[k] = str(reason)
    return found, lost, ()
