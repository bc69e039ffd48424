"""The least stable modes at one wavenumber, as a result."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ..checks import check_flag, check_integer, check_wavenumber
from ..errors import NotResolved
from ..flows.base import check_flow
from ..modes.accuracy import DEGREES, TOLERANCE, Accuracy, check_accuracy
from ..modes.eigenvalue import Eigenvalues
from ..modes.energy import condition_numbers
from ..modes.listing import listed
from ..modes.mode import Mode, require
from ..modes.short_waves import ill_posed_somewhere, ill_posed_strips
from ..modes.solver import Solver
from ..numerics.threads import one_thread
from ..output.panels import GROWTH_RATE, PHASE_SPEED, POINTS, Curve, Panel
from ..output.record import Record
from ..output.text import Row, measured
from ..status import INTERRUPTED, Status, is_resolved
from .choices import MOST_MODES
from .dispersion import dispersion

if TYPE_CHECKING:
    from ..flows import Flow



@dataclass(frozen=True, repr=False)
class Spectrum(Eigenvalues, Record):
    """The least stable modes of a flow at wavenumber k, sorted by decreasing growth rate.

    None is missing down to the last one, and none is there twice; or `status` says where that is not sure, and `doubt`
    why.

    `flow`, `k` and `settings` are what was asked for, `modes` (modes,) hold a `Mode` each; arrays are (modes,), as are
    the condition numbers of the eigenvalues in the energy norm, `condition`. `remarks` are what the model says of
    itself. Units: `sigma`, `growth_rate`, `error` V/L, `phase_speed` V, `condition` is a number. Writing raises
    ParameterError where a file cannot be written.

    >>> from stability import flows, spectrum
    >>> found = spectrum(flows.Couette(Re=1000.0), 1.0, 2)
    >>> sorted(found.phase_speed.round(6).tolist())  # in pairs, by symmetry
    [-0.605343, 0.605343]
    """

    flow: Any
    k: float
    modes: tuple[Mode, ...]
    settings: Mapping[str, Any] = field(default_factory=dict, compare=False)
    status: tuple[Status, ...] = ()  # type: ignore[assignment]
    doubt: str | None = None
    condition: tuple[float, ...] = field(default=(), compare=False)
    remarks: tuple[str, ...] = field(default=(), compare=False)
    dimension: ClassVar[str] = "mode"

    def panels(self) -> tuple[Panel, ...]:
        return _panels([self])

    def rows(self) -> list[Row]:
        """Return a row of each mode; `condition` is the condition number of the eigenvalue in the energy norm."""
        return [{**{name: row[name] for name in row if name != "status"}, "condition": number, "status": row["status"]}
                for row, number in zip(self._summary(), self.condition, strict=True)]

    def columns(self) -> dict[str, np.ndarray]:
        return {**super().columns(), "sigma": self.sigma, "slope": np.array([mode.slope for mode in self.modes])}

    def notes(self) -> list[str]:
        return [*_doubts([self]), *self.remarks]

    def about(self) -> dict[str, Any]:
        return {"k": self.k}

    def _summary(self) -> list[Row]:
        names = ("k", "growth_rate", "phase_speed", "error", *measured(self.flow), "degree")
        return [{**{name: getattr(mode, name) for name in names}, "status": status}
                for mode, status in zip(self.modes, self.status, strict=True)]


@dataclass(frozen=True, repr=False)
class Spectra(Record):
    """The spectra of a flow at several wavenumbers; those of the wavenumbers in `missing` were not computed."""

    flow: Any
    spectra: tuple[Spectrum, ...]
    missing: tuple[float, ...] = ()
    remarks: tuple[str, ...] = field(default=(), compare=False)
    dimension: ClassVar[str] = "mode"

    @property
    def settings(self) -> Mapping[str, Any]:  # type: ignore[override]
        return self.spectra[0].settings

    def panels(self) -> tuple[Panel, ...]:
        return _panels(self.spectra)

    def rows(self) -> list[Row]:
        rows = [row for one in self.spectra for row in one.rows()]
        return rows + [dict.fromkeys(rows[0]) | {"k": k, "status": INTERRUPTED} for k in self.missing]

    def notes(self) -> list[str]:
        return [*_doubts(self.spectra), *self.remarks]


def _panels(spectra: Any) -> Any:
    """Growth rates against phase speeds, a curve for each wavenumber."""
    curves = [Curve(one.phase_speed, one.growth_rate, f"$k$ = {one.k:g}", POINTS, one.error / one.k, one.error,
                    status=one.status) for one in spectra]
    return (Panel(PHASE_SPEED, GROWTH_RATE, tuple(curves), zero="y"),)


def _doubts(spectra: Any) -> list[Any]:
    return [f"{one.flow}, k = {one.k:g}: {one.doubt}" for one in spectra if one.doubt]


def ill_posed_remarks(spectra: Sequence[Spectrum], rivals: bool = True) -> tuple[str, ...]:
    """What an ill-posed flow does to its spectra: modes that do not converge, internal modes that lead it.

    The latter takes time, and is looked at where `rivals` is true.
    """
    flow = spectra[0].flow
    if not ill_posed_somewhere(flow):
        return ()
    moving = [one.k for one in spectra if not all(is_resolved(mode.status) for mode in one.modes)]
    strips = "; ".join(map(str, ill_posed_strips(flow))) if moving else ""
    notes = [f"{flow}, k = {k:g}: the spectrum does not converge; {strips}" for k in moving]
    if not (rivals and flow.has_surface_mode()):
        return tuple(notes)
    faster = dispersion(flow, [one.k for one in spectra], strict=False, rivals=True).rival
    return (*notes, f"{flow}: {faster}") if faster else tuple(notes)


def spectrum(flow: "Flow", k: float, modes: int = 10, *, tolerance: float = TOLERANCE, max_degree: int = DEGREES[-1],
             strict: bool = True, rivals: bool = False) -> Spectrum:
    """Return the `modes` least stable modes at wavenumber k, each refined to its own degree with an error bar.

    Symmetry classes are solved apart, and the modes above the last one are counted by the argument principle (see
    `modes.listing`). Raises NotResolved if one of them is not resolved within `max_degree` or others may be
    missing; with strict=False the status says so instead. With `rivals` a note tells whether an internal mode of an
    ill-posed flow outgrows the surface mode.

    `k` is in 1/L, growth rates in V/L. Raises ParameterError for what is no flow, wavenumber or number of modes.

    >>> from stability import flows
    >>> print(spectrum(flows.Poiseuille(Re=1e4), 1.0, 3).growth_rate.round(8))  # Orszag (1971): 0.00373967 leads
    [ 0.00373967 -0.03516728 -0.03518658]
    """
    strict, rivals = check_flag("strict", strict), check_flag("rivals", rivals)
    k, modes = check_wavenumber(k), check_integer(modes, "modes", 1, MOST_MODES)
    (found,) = spectra(check_flow(flow), [k], modes, check_accuracy(tolerance, max_degree))
    if strict:
        for mode in found.modes:
            require(mode)
        if found.doubt:
            raise NotResolved(f"{flow}, k={k:g}: {found.doubt}")
    return replace(found, remarks=ill_posed_remarks([found], rivals))


def spectra(flow: "Flow", wavenumbers: Sequence[float], modes: int, accuracy: Accuracy) -> Iterator[Spectrum]:
    """Yield the `Spectrum` at each wavenumber, not strict and without remarks (`ill_posed_remarks`)."""
    for k in wavenumbers:
        yield _spectrum(Solver(flow, accuracy), k, modes)


@one_thread
def _spectrum(solver: Solver, k: float, count: int) -> "Spectrum":
    found = listed(solver, k, count)
    modes = found.modes[:count]
    return Spectrum(solver.flow, k, modes, solver.accuracy.settings, found.status[:count],
                    found.doubt if found.sure < count else None, tuple(condition_numbers(modes, solver).tolist()))
