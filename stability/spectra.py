"""All modes at one wavenumber: the dense problem with its infinite eigenvalues deflated, then polished.

Only the momentum and kinematic rows of B are non-zero. With B = E B_r (E picks those rows) and
G = B_r (A - shift B)^{-1} E, the finite eigenvalues are rate = shift + 1/theta for the non-zero
eigenvalues theta of G. The infinite ones, defective in the pencil because pressure only enforces
continuity, become semisimple zeros of G. How many are finite follows from the structure alone, so that
nothing is filtered by size.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from scipy.linalg import qr

from .checks import check_flag, check_integer, check_wavenumber
from .eigenvalue import Eigenvalues
from .errors import ModeLost
from .flows.base import check_flow
from .mode import Mode, require
from .output import Row
from .record import Record
from .solver import DEGREES, TOLERANCE, Solver, check_accuracy
from .status import INTERRUPTED
from .threads import one_thread

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from .flows import Flow

MOST = 200  # modes that can be asked for

_LARGEST = 1300  # unknowns of a dense problem
_SPARE = 10  # eigenvalues beside twice the number asked for that are tried
_SHIFT = 0.01 - 0.013j  # tried when the pencil is singular at rate 0
_SINGULAR = 1e14  # ratio of the two largest theta above which rate 0 is taken for an eigenvalue
_FIRST = 6  # rung of the degrees at which a look starts
_SMALL = 10  # degree of the pencil whose finite eigenvalues are counted


@dataclass(frozen=True, repr=False)
class Spectrum(Eigenvalues, Record):
    """The least stable modes of a flow at wavenumber k, sorted by decreasing growth rate."""

    flow: Any
    k: float
    modes: tuple[Mode, ...]
    settings: Mapping[str, Any] = field(default_factory=dict, compare=False)
    dimension: ClassVar[str] = "mode"

    def plot(self, ax: "Axes | None" = None) -> "Axes":
        """Draw growth rates against phase speeds into the matplotlib Axes `ax`, or a new one; return it."""
        from . import plots

        return plots.spectra([self], plots.axes_or_new(ax))

    def rows(self) -> list[Row]:
        """Return a row of each mode; `condition` is the condition number of the eigenvalue in the energy norm."""
        from .energy import condition_numbers

        numbers = condition_numbers(self.modes).tolist()
        return [{**{name: row[name] for name in row if name != "status"}, "condition": number, "status": row["status"]}
                for row, number in zip(self._summary(), numbers, strict=True)]

    def columns(self) -> dict[str, np.ndarray]:
        return {**super().columns(), "sigma": self.sigma, "slope": np.array([mode.slope for mode in self.modes])}

    def notes(self) -> list[str]:
        from .wellposed import notes_on

        return notes_on([self])

    def about(self) -> dict[str, Any]:
        return {"k": self.k}

    def _summary(self) -> list[Row]:
        names = ("k", "growth_rate", "phase_speed", "error", "degree", "status")
        return [{name: getattr(mode, name) for name in names} for mode in self.modes]


@dataclass(frozen=True, repr=False)
class Spectra(Record):
    """The spectra of a flow at several wavenumbers; those of the wavenumbers in `missing` were not computed."""

    flow: Any
    spectra: tuple[Spectrum, ...]
    missing: tuple[float, ...] = ()
    dimension: ClassVar[str] = "mode"

    @property
    def settings(self) -> Mapping[str, Any]:  # type: ignore[override]
        return self.spectra[0].settings

    def plot(self, ax: "Axes | None" = None) -> "Axes":
        """Draw growth rates against phase speeds, a colour for each wavenumber, into `ax` or new Axes; return them."""
        from . import plots

        return plots.spectra(self.spectra, plots.axes_or_new(ax))

    def rows(self) -> list[Row]:
        rows = [row for one in self.spectra for row in one.rows()]
        return rows + [dict.fromkeys(rows[0]) | {"k": k, "status": INTERRUPTED} for k in self.missing]

    def notes(self) -> list[str]:
        from .wellposed import notes_on

        return notes_on(list(self.spectra))


def dense_degrees(solver, first, step=1):
    """Degrees for dense problems, from rung `first` on, as far as one takes no longer than about a second."""
    layers = len(solver.assembly.system.fields)
    affordable = [degree for degree in solver.degrees if degree * layers <= _LARGEST] or solver.degrees[:1]
    return affordable[first::step] or affordable[-1:]


def finite_rates(solver, degree, symbols):
    """Return the finite eigenvalues of the pencil of this degree, all of them, by decreasing real part."""
    pencil, count = solver.pencil(degree), _finite_count(solver, degree)
    theta, shift = _theta(pencil, pencil.weights(symbols).value, count)
    rates = shift + 1 / theta[:count]
    rates = rates[np.isfinite(rates)]
    if not len(rates):
        raise ModeLost(f"{solver.flow}: no eigenvalue at degree {degree} is a number in double precision")
    return rates[np.argsort(-rates.real)]


def _theta(pencil, weights, rank=None):
    """Eigenvalues of G by decreasing size, and the shift; only `rank` of them if G is known to have that rank."""
    rows = pencil.rate_rows
    columns = np.zeros((pencil.size, len(rows)))
    columns[rows, np.arange(len(rows))] = 1
    theta = np.zeros(0)
    for shift in (0.0, _SHIFT):
        try:
            response = pencil.factors(weights, shift).solve(columns)
            theta = _eigenvalues(pencil.b(weights[:, None], response)[rows], rank)
        except np.linalg.LinAlgError:  # singular, or not finite
            continue
        theta = theta[np.argsort(-np.abs(theta))]
        if np.abs(theta[0]) < _SINGULAR * np.abs(theta[1:2]).sum():
            break
    return theta, shift


def _eigenvalues(g, rank):
    """Eigenvalues of g; the non-zero ones alone from g = q r, which has those of r q."""
    if rank is None or rank >= len(g):
        return np.linalg.eigvals(g)
    q, r, order = qr(g, pivoting=True, check_finite=False)
    return np.linalg.eigvals(r[:rank] @ q[order, :rank])


def _finite_count(solver, degree):
    """How many eigenvalues are finite: one per degree for every layer that carries the rate, plus a constant."""
    system = solver.assembly.system
    return _smallest_count(_Structure(system.pattern, solver.assembly)) + (degree - _SMALL) * system.dynamic_layers


@dataclass(frozen=True)
class _Structure:
    """What the number of finite eigenvalues depends on, and an assembly that has it."""

    pattern: tuple
    assembly: Any = field(compare=False)


@lru_cache(maxsize=32)
def _smallest_count(structure):
    """Finite eigenvalues at the smallest degree: read off the gap in theta with all symbols 1."""
    small = structure.assembly.pencil(_SMALL)
    sizes = np.abs(_theta(small, np.ones(len(small.parts)))[0])
    return int(np.argmin(sizes[1:] / np.maximum(sizes[:-1], np.finfo(float).tiny))) + 1


@one_thread
def spectrum(flow: "Flow", k: float, modes: int = 10, *, tolerance: float = TOLERANCE, max_degree: int = DEGREES[-1],
             strict: bool = True) -> Spectrum:
    """Return the `modes` least stable modes at wavenumber k, each refined to its own degree with an error bar.

    The degree of the dense problem is raised until those modes no longer move. Raises NotResolved if
    one of them is not resolved within `max_degree`; with strict=False its status says so instead.
    """
    strict = check_flag("strict", strict)
    k, modes = check_wavenumber(k), check_integer(modes, "modes", 1, MOST)
    tolerance, max_degree = check_accuracy(tolerance, max_degree)
    solver = Solver(check_flow(flow), tolerance, max_degree)
    found = leading_modes(solver, k, modes)
    if strict:
        for mode in found:
            require(mode)
    return Spectrum(flow, k, tuple(found), {"tolerance": tolerance, "max_degree": max_degree})


def leading_modes(solver, k, count):
    """Return the `count` least stable modes, polished; unresolved ones carry that status.

    Raises ModeLost where none of them settles.
    """
    return polished(solver, k, count, *converged_rates(solver, k, count))


def polished(solver, k, count, rates, degree):
    """Refine the first `count` of the dense eigenvalues of a degree that lead to modes."""
    found = []
    for rate in rates[: 2 * count + _SPARE]:
        mode = _polish(solver, k, rate, degree)
        if mode is not None and not any(_same(mode, other) for other in found):
            found.append(mode)
        if len(found) == count:
            break
    if not found:
        raise ModeLost(f"{solver.flow}: no mode settles at k = {k:g}")
    return sorted(found, key=lambda mode: -mode.growth_rate)


def converged_rates(solver, k, count):
    """Finite rates at the first degree at which the leading `count` agree with the degree before, and that degree."""
    previous = None
    for degree in dense_degrees(solver, _FIRST, 2):
        rates = finite_rates(solver, degree, solver.symbols(k))
        if previous is not None:
            lead = rates[:count]
            drift = np.abs(lead[:, None] - previous).min(axis=1)
            if len(lead) == count and np.all(drift < 1e-4 * np.abs(lead)):
                break
        previous = rates
    return rates, degree


def _polish(solver, k, rate, degree):
    """Refine one dense eigenvalue; None if the iteration leaves it."""
    try:
        mode = solver.solve(k, rate, None, degree)
    except ModeLost:
        return None
    return mode if abs(mode.rate - rate) < 0.05 * abs(rate) else None


def _same(mode, other):
    return abs(mode.sigma - other.sigma) <= 1e-9 * abs(mode.sigma) + mode.error + other.error
