"""Whether an internal mode of an ill-posed flow grows faster than a mode that is followed.

The spectrum at one k may still converge: waves across an ill-posed strip cannot be shorter than it is thick. Internal
modes then grow ever faster with k, while the slow surface mode need not notice: it is not what one would see.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ..modes.accuracy import DEGREES
from ..modes.dense import finite_rates
from ..modes.short_waves import ill_posed_somewhere, ill_posed_strips
from ..modes.solver import Solver
from ..numerics.threads import one_thread

if TYPE_CHECKING:
    from ..modes.mode import Mode
    from .dispersion import DispersionRelation

_CHECK_DEGREE = 16, 96  # least and largest of the look for a faster mode; between them that of the surface mode
_FASTER = 1e-6  # relative excess of growth that counts as faster
_DOUBT = 10  # times its error bar that a mode may grow faster than it seems: rivals have no bars of their own
_SETTLED = 1e-4  # relative difference of two degrees that counts as converged


@dataclass(frozen=True)
class Outgrown:
    """From wavenumber `k` on another mode grows faster than the surface mode, by the spectra of two `degrees`.

    It grows at `rate` there, None where the two differ.
    """

    k: float
    rate: float | None
    degrees: tuple
    strips: tuple

    def __str__(self) -> str:
        pace = f"({self.rate:.6g})" if self.rate is not None else \
            f"that degrees {' and '.join(map(str, self.degrees))} do not resolve"
        return (f"an internal mode {pace} outgrows the surface mode from k = {self.k:.6g} on: "
                f"{'; '.join(map(str, self.strips))}")


@one_thread
def outgrown(relation: "DispersionRelation") -> Any:
    """Where another mode outgrows a surface-mode `DispersionRelation`: an `Outgrown`, or None.

    Well-posed flows are not searched. Assumes that internal modes, once ahead, stay ahead as k rises: the
    wavenumbers of the relation are bisected.
    """
    modes = sorted(relation.modes, key=lambda mode: mode.k)
    if not (modes and relation.mode == "surface" and ill_posed_somewhere(relation.flow)):
        return None
    solver = Solver(relation.flow)
    rates = {}
    below, above = -1, len(modes)
    middle = len(modes) - 1
    while above - below > 1:
        rates[middle] = faster(solver, modes[middle])
        below, above = (middle, above) if rates[middle] is None else (below, middle)
        middle = (below + above) // 2
    if above == len(modes):
        return None
    degrees, (coarse, fine) = zip(*rates[above].items(), strict=True)
    rate = fine if abs(fine - coarse) < _SETTLED * abs(fine) else None
    return Outgrown(modes[above].k, rate, degrees, ill_posed_strips(relation.flow))


def faster(solver: Solver, mode: "Mode") -> Any:
    """Leading growth rates {degree: rate} at two degrees if both exceed that of this mode, else None.

    A degree that does not resolve the mode itself would miss its rivals.
    """
    threshold = mode.growth_rate + _FASTER * abs(mode.sigma) + _DOUBT * mode.error
    rung = DEGREES.index(min(max(mode.degree, _CHECK_DEGREE[0]), _CHECK_DEGREE[1]))
    rates = {}
    for degree in (DEGREES[rung], DEGREES[rung + 2]):
        rates[degree] = leading_rate(solver, mode.k, degree)
        if rates[degree] <= threshold:
            return None
    return rates


def leading_rate(solver: Solver, k: float, degree: int) -> float:
    """Largest growth rate of all modes at one degree, whatever its error."""
    return float(solver.width(k) * finite_rates(solver, degree, solver.symbols(k))[0].real)
