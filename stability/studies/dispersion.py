"""Dispersion relations sigma(k): the surface mode followed from its long-wave limit, or the most unstable mode."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ..checks import check_flag, check_options, check_wavenumbers
from ..errors import ModeLost, naming
from ..flows.base import check_flow
from ..modes.accuracy import DEGREES, TOLERANCE, check_accuracy
from ..modes.branch import Branch, rough_solver
from ..modes.eigenvalue import Eigenvalues
from ..modes.listing import leading_modes, listed
from ..modes.memory import beside, branch_of
from ..modes.mode import Mode, require
from ..modes.short_waves import ill_posed_somewhere, ill_posed_strips
from ..modes.solver import Solver
from ..modes.surface import surface_branch
from ..modes.tracking import PACE, Collision, Encounter
from ..numerics.threads import one_thread
from ..output.panels import GROWTH_RATE, LINE, PHASE_SPEED, POINTS, WAVENUMBER, Axis, Curve, Panel, scale_of
from ..output.record import Record
from ..output.text import Row, measured
from ..status import INTERRUPTED, LOST, Status, as_outgrown, is_resolved
from .choices import MODES
from .outgrown import Outgrown, outgrown

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from ..flows import Flow

GROUP_SPEED = Axis("group_speed", "group speed $c_g$")

_NOT_LOOKED = "the flow is ill posed; whether an internal mode outgrows the surface mode is told with rivals=True"
_PACE = replace(PACE, first=0.25)  # of a mode that begins at waves as long as the flow is thick: vectors turn faster
_PORTION = 200  # wavenumbers followed before what is done is handed over


@dataclass(frozen=True, repr=False)
class DispersionRelation(Eigenvalues, Record):
    """sigma(k) of one mode. Arrays have shape (points,), in the order of k.

    `lost` maps wavenumbers at which the mode could not be followed to the reason (only with
    strict=False); they are left out of the arrays, not of the rows. `collisions` lists the mergers met on the
    way, `encounters` the near ones, `asked` all wavenumbers in the order asked for. `rival` tells from where on an
    internal mode of an ill-posed flow grows faster, None where none does or it was not looked for; `remarks` are what
    else the model says of itself.

    `flow` and `mode` are what was asked for, `modes` (points,) hold a `Mode` each, `method` and `settings` say how they
    were computed. Units, L and V being the scales of the flow: `k` 1/L, `sigma`, `growth_rate` and `error` V/L, `slope`
    and `phase_speed` V. Writing raises ParameterError where a file cannot be written, `["name"]` KeyError.

    >>> from stability import dispersion, flows
    >>> relation = dispersion(flows.Vortex(slope_deg=45.0), [1e-3, 2e-3])
    >>> (relation.growth_rate / relation.k**2).round(5).tolist()  # thesis (4.25): -2/5
    [-0.4, -0.4]
    >>> len(relation), relation[0]["status"]
    (2, 'resolved')
    """

    flow: Any
    mode: str
    modes: tuple[Mode, ...]
    lost: dict[float, str] = field(hash=False)
    collisions: tuple[Collision, ...]
    asked: tuple[float, ...] = ()
    method: str = "collocation"
    settings: Mapping[str, Any] = field(default_factory=dict, compare=False)
    encounters: tuple[Encounter, ...] = ()
    rival: Outgrown | None = field(default=None, compare=False)
    remarks: tuple[str, ...] = field(default=(), compare=False)
    dimension: ClassVar[str] = "k"

    @property
    def k(self) -> np.ndarray:
        """Wavenumbers of the modes (points,), 1/L."""
        return self._of_each("k")

    @property
    def slope(self) -> np.ndarray:
        """d sigma / dk."""
        return self._of_each("slope")

    @property
    def status(self) -> tuple[Status, ...]:
        """"resolved", or what failed, of each mode; and whether another one outgrows it."""
        return tuple(map(self._status, self.modes))

    def _status(self, mode: Mode) -> Status:
        return as_outgrown(mode.status) if self.rival and mode.k >= self.rival.k else mode.status

    @property
    def subtitle(self) -> str:
        return f"; {self.mode} mode"

    @property
    def group_speed(self) -> np.ndarray:
        """Real parts of the group velocity d omega/dk = i d sigma/dk, V."""
        return self._of_each("group_speed")

    @property
    def group_error(self) -> np.ndarray:
        """Bounds of the absolute error of the group speed."""
        return self._of_each("group_error")

    def panels(self) -> tuple[Panel, ...]:
        """Growth rate, phase speed and group speed against k."""
        modes = sorted(self.modes, key=lambda mode: mode.k)
        k, error = (np.array([getattr(mode, name) for mode in modes], dtype=float) for name in ("k", "error"))
        quantities = [(GROWTH_RATE, error), (PHASE_SPEED, error / k)]
        if self._differentiated:
            quantities.append((GROUP_SPEED, np.array([mode.group_error for mode in modes], dtype=float)))
        status = tuple(map(self._status, modes))
        x = replace(WAVENUMBER, scale=scale_of(k))
        kind = LINE if len(k) > 1 else POINTS
        return tuple(Panel(x, y, (Curve(k, np.array([getattr(mode, y.name) for mode in modes]), kind=kind,
                                        y_error=bars, status=status),), zero="y" if y is GROWTH_RATE else "")
                     for y, bars in quantities)

    @property
    def _differentiated(self) -> bool:
        """Whether d sigma/dk is known: solve_bvp gives values alone."""
        return self.method == "collocation"

    def rows(self) -> list[Row]:
        return [self._row(k, mode) for k, mode in self._points()]

    def columns(self) -> dict[str, np.ndarray]:
        columns = super().columns()
        missing = np.isnan(columns["growth_rate"].astype(float))
        for name in ("sigma", "slope"):
            values = [getattr(mode, name, np.nan) for _, mode in self._points()]
            columns[name] = np.where(missing, complex(np.nan, np.nan), np.array(values, dtype=complex))
        return columns

    def notes(self) -> list[str]:
        met = {str(event) for event in (*self.collisions, *self.encounters)}
        notes = sorted(met | set(self.lost.values()) - {INTERRUPTED})
        return [*notes, *self.remarks]

    def about(self) -> dict[str, Any]:
        return {"mode": self.mode}

    def _points(self) -> "list[tuple[float, Mode | None]]":
        """Every wavenumber asked for with its mode, None where that was lost."""
        found = {mode.k: mode for mode in self.modes}
        return [(k, found.get(k)) for k in self.asked or (*self.k.tolist(), *self.lost)]

    def _row(self, k: float, mode: Any) -> Row:
        """Without numbers where the mode is lost, or where the most unstable one is not resolved: that is no result."""
        resolution = "degree" if self._differentiated else "nodes"
        refused = mode is None or self.mode == "most-unstable" and not is_resolved(mode.status)
        slopes = ("group_speed", "group_error") if self._differentiated else ()
        names = "growth_rate", "phase_speed", "error", *slopes, *measured(self.flow)
        numbers = {name: None if refused else getattr(mode, name) for name in names}
        return {"k": k, **numbers, resolution: getattr(mode, resolution, None),
                "status": self._status(mode) if mode else self._lost(k)}

    def _lost(self, k: float) -> Status:
        status = INTERRUPTED if self.lost.get(k) == INTERRUPTED else LOST
        return as_outgrown(status) if self.rival and k >= self.rival.k else status


def dispersion(flow: "Flow", k: "ArrayLike", mode: str | None = None, *, tolerance: float = TOLERANCE,
               max_degree: int = DEGREES[-1], strict: bool = True, rivals: bool = False) -> DispersionRelation:
    """Return the `DispersionRelation` of a flow at wavenumbers k, a number or a sequence in any order.

    mode="surface" follows the slow surface mode from its long-wave limit (the default where the flow has
    one), "leading" follows the mode that is the least stable one at the wavenumber of the flow, 1 unless it says
    otherwise (the default elsewhere), and "most-unstable" takes the least stable mode of the spectrum at each k. A
    mode that is followed is the same one at a wavenumber whatever else is asked for. `tolerance` bounds the error
    relative to |sigma|. Raises NotResolved or ModeLost; with strict=False the record says in `status` and `lost` what
    failed. With `rivals` it also says from where on an internal mode of an ill-posed flow outgrows the surface mode: it
    takes dense spectra to know.

    Wavenumbers are in 1/L, growth rates in V/L, L and V being the scales of the flow; ParameterError is raised for what
    is no flow, wavenumber or mode.

    >>> from stability import flows
    >>> relation = dispersion(flows.Poiseuille(Re=1e4), 1.0)
    >>> print(f"{relation.modes[0].c:.10f}")  # Orszag (1971): 0.23752649 + 0.00373967i
    0.2375264888+0.0037396706j
    """
    strict, rivals = check_flag("strict", strict), check_flag("rivals", rivals)
    parts = list(dispersion_parts(flow, k, mode, tolerance=tolerance, max_degree=max_degree))
    relation = judged(joined_relation(parts, check_wavenumbers(k).tolist()), rivals)
    if strict:
        for reason in relation.lost.values():
            raise ModeLost(reason)
        for point in relation.modes:
            require(point)
    return relation


def dispersion_parts(flow: "Flow", k: "ArrayLike", mode: str | None = None, *, tolerance: float = TOLERANCE,
                     max_degree: int = DEGREES[-1]) -> Iterator[DispersionRelation]:
    """Yield the relation of `dispersion`, not strict, a portion of k at a time: `joined` puts them together."""
    check_flow(flow)
    wavenumbers = check_wavenumbers(k)
    mode = default_mode(flow) if mode is None else check_options("mode", mode, MODES)
    accuracy = check_accuracy(tolerance, max_degree)
    walk = {"surface": _surface, "leading": _leading, "most-unstable": _most_unstable}[mode]
    portions, step = walk(Solver(flow, accuracy), np.unique(wavenumbers)), one_thread(next)
    while portion := step(portions, None):
        found, lost, met = portion
        collisions = tuple(event for event in met if isinstance(event, Collision))
        encounters = tuple(event for event in met if isinstance(event, Encounter))
        yield DispersionRelation(flow, mode, tuple(found.values()), lost, collisions, encounters=encounters,
                                 settings=accuracy.settings)


def joined_relation(parts: list[DispersionRelation], asked: list[float]) -> DispersionRelation:
    """Return the parts as one relation at the wavenumbers `asked`, in that order."""
    found = {mode.k: mode for part in parts for mode in part.modes}
    lost: dict[float, str] = {}
    for part in parts:
        lost |= {k: reason for k, reason in part.lost.items() if k not in found and k not in lost}
    collisions = tuple(collision for part in parts for collision in part.collisions)
    encounters = tuple(encounter for part in parts for encounter in part.encounters)
    return replace(parts[0], modes=tuple(found[k] for k in asked if k in found), lost=lost, collisions=collisions,
                   encounters=encounters, asked=tuple(asked))


def judged(relation: DispersionRelation, rivals: bool = True) -> DispersionRelation:
    """Return the relation with what the model says of itself: the flow is ill posed, or a surface mode is outgrown.

    Whether it is takes dense spectra, and is looked at where `rivals` is true.
    """
    flow = relation.flow
    if relation.method != "collocation" or not ill_posed_somewhere(flow):
        return relation
    if relation.mode != MODES[0]:
        return replace(relation, remarks=tuple(naming(flow, str(strip)) for strip in ill_posed_strips(flow)))
    if not rivals:
        return replace(relation, remarks=(naming(flow, _NOT_LOOKED),))
    rival = outgrown(relation)
    return replace(relation, rival=rival, remarks=(naming(flow, str(rival)),) if rival else ())


def default_mode(flow: "Flow") -> str:
    """The mode that a dispersion relation follows unless told otherwise."""
    return "surface" if flow.has_surface_mode() else "leading"


# Each walk yields ({k: mode}, {k: why it is lost}, collisions and encounters) of a few wavenumbers at a time.


def _surface(solver: Solver, wavenumbers: np.ndarray) -> Iterator[Any]:
    """Follow the surface mode from its long-wave limit, or step to it from a flow that is all but the same."""
    found = beside(solver, surface_branch, wavenumbers.tolist())
    if found:
        yield found, {}, ()
    else:
        yield from _followed(solver, surface_branch, wavenumbers)


def _leading(solver: Solver, wavenumbers: np.ndarray) -> Iterator[Any]:
    """Follow the mode that leads at the flow's own wavenumber."""
    yield from _followed(solver, leading_branch, wavenumbers)


def _followed(solver: Solver, start: Callable[..., Any], wavenumbers: np.ndarray) -> Iterator[Any]:
    told = set()
    try:
        with branch_of(solver, start, wavenumbers) as branch:
            for first in range(0, len(wavenumbers), _PORTION):
                found, lost = branch.at(wavenumbers[first: first + _PORTION])
                met = [event for event in (*branch.collisions, *branch.encounters) if event not in told]
                told |= set(met)
                yield found, lost, tuple(met)
    except ModeLost as reason:
        yield {}, dict.fromkeys(wavenumbers.tolist(), str(reason)), ()


def leading_branch(solver: Solver, known: Any = None) -> Branch:
    """Return the branch of the mode that leads at `flow.wavenumber`, within its symmetry class on half the domain.

    Of two that lead together, the one that travels downstream faster. `known` are modes of a flow that is nearly the
    same, {k: mode}.
    """
    rivals = listed(solver, solver.flow.wavenumber, 1).modes
    best = max(mode.growth_rate - mode.error for mode in rivals)
    mode = max((mode for mode in rivals if mode.growth_rate + mode.error >= best), key=lambda mode: mode.phase_speed)
    (half,) = (half for half in solver.halves if half.flow == mode.flow)
    return Branch(half, mode, rough_solver(half, known), final=True, pace=_PACE)


def _most_unstable(solver: Solver, wavenumbers: Any) -> Iterator[Any]:
    for k in wavenumbers.tolist():
        try:
            (mode,) = leading_modes(solver, k, 1)
            yield {k: mode}, {}, ()
        except ModeLost as reason:
            yield {}, {k: str(reason)}, ()
