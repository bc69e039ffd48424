"""Maps: one quantity over a grid of one to three parameters, computed in pieces on any executor."""

from collections.abc import Callable, Mapping
from concurrent.futures import Executor
from contextlib import closing, nullcontext
from dataclasses import dataclass, field, replace
from itertools import product
from os import PathLike
from typing import TYPE_CHECKING, Any

import numpy as np

from .. import status
from ..checks import check_file_name, check_integer, check_options, shown
from ..errors import ParameterError
from ..modes.accuracy import DEGREES, TOLERANCE, check_accuracy
from ..output.panels import GROWTH_AT_K_MAX, GROWTH_RATE, K_MAX, PHASE_SPEED, WAVENUMBER, Axis, Grid
from ..output.record import Record
from ..output.symbols import axis_label, symbol_of
from ..output.text import Row
from .choices import MOST_WORKERS, usual_quantity
from .dispersion import default_mode
from .journal import Journal
from .request import Request
from .rounds import compute_all

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import ArrayLike

    from ..flows import Flow

_DRAWN_AXES = 2


@dataclass(frozen=True, repr=False)
class Map(Record):
    """Results of a `Request` at every point of its grid; `map[name]` is a column shaped by the axes, or an axis.

    Columns hold nan where there is no number; `status` then says why. `table` (points, columns) holds None there.
    `damaged` counts the lines of the journal that could not be used; what they alone held was computed again.

    `request` is what was asked for: flow, axes, quantity. Units are those of the columns: `stability map --help` lists
    them, or `output.columns`. Raises KeyError for a name that is no column, ParameterError where a file cannot be
    written.

    >>> from stability import flows, parameter_map
    >>> found = parameter_map(flows.Vortex(), {"slope_deg": [30.0, 45.0]}, k=[1e-3, 2e-3])
    >>> found["growth_rate"].shape, str(found["status"][0, 0]), bool(found.resolved.all())
    ((2, 2), 'resolved', True)
    """

    request: Request
    table: tuple[tuple[Any, ...], ...] = field(repr=False)
    damaged: int = field(default=0, compare=False)

    @property
    def flow(self) -> Any:  # type: ignore[override]
        """The flow whose parameters are swept."""
        return self.request.flow

    @property
    def quantity(self) -> str:
        """"k_max", "growth_rate" or "neutral"."""
        return self.request.quantity

    @property
    def axes(self) -> dict[str, np.ndarray]:
        """{name: values (count,)}, outermost first."""
        return self.request.axes

    @property
    def results(self) -> tuple[str, ...]:
        """Names of the results at each point; the last is the status."""
        return self.request.results

    @property
    def dimension(self) -> str:
        """The outermost axis."""
        return self.dimensions[0]

    @property
    def dimensions(self) -> tuple[str, ...]:
        return tuple(self.axes)

    @property
    def bounded(self) -> str:
        return {"k_max": "k_max", "growth_rate": "sigma", "neutral": self.request.vary or ""}[self.quantity]

    def __getitem__(self, name: Any) -> Any:
        if not isinstance(name, str):
            return super().__getitem__(name)
        if name in self.axes:
            return self.axes[name]
        if name not in self.results:
            raise KeyError(f"{name}; this map has {', '.join((*self.axes, *self.results))}")
        values = [row[self.results.index(name)] for row in self.table]
        return np.array(values, dtype=str if name == "status" else float).reshape(self.request.shape)

    @property
    def resolved(self) -> np.ndarray:
        """Which points are resolved, in the shape of the axes."""
        return np.vectorize(status.is_resolved, otypes=[bool])(self["status"])

    def rows(self) -> list[Row]:
        """One dict for each point, the last axis fastest."""
        axes = self.axes
        return [dict(zip((*axes, *self.results), (*point, *results), strict=True))
                for point, results in zip(product(*(values.tolist() for values in axes.values())), self.table,
                                          strict=True)]

    def columns(self) -> dict[str, np.ndarray]:
        """Return axes (count,) and results, shaped by the axes; nan where there is no number."""
        return {**self.axes, **{name: self[name] for name in self.results}}

    def about(self) -> dict[str, Any]:
        about = {"quantity": self.quantity, "over": ", ".join(self.axes)}
        return about if self.request.vary is None else {**about, "vary": self.request.vary}

    @property
    def swept(self) -> tuple[str | None, ...]:
        return (*self.request.over, self.request.vary)

    @property
    def settings(self) -> dict[str, Any]:  # type: ignore[override]
        request = self.request
        mode = {"mode": default_mode(self.flow)} if self.quantity == "growth_rate" else {}
        return {**mode, **request.accuracy.settings}

    def panels(self) -> tuple[Grid, ...]:
        """The two results that are drawn unless told otherwise."""
        return tuple(self._grid(axis) for axis in _DRAWN[self.quantity](self))

    def plot(self, ax: "Axes | None" = None, quantity: str | None = None, *, label: str | None = None,
             **line_options: Any) -> "Axes":
        """Draw a result (the first, by default) over one or two axes into the matplotlib Axes `ax`, or a new one.

        Units are those of the columns. Raises ParameterError for a quantity it has not and for three axes.

        >>> from matplotlib.figure import Figure
        >>> from stability import flows, parameter_map
        >>> found = parameter_map(flows.Vortex(), {"slope_deg": [30.0, 45.0]}, k=[1.0, 2.0])
        >>> found.plot(Figure().add_subplot(), "phase_speed").get_xlabel()[:10]
        'wavenumber'
        """
        from ..output import plots

        name = self.results[0] if quantity is None else check_options("quantity", quantity, self.results[:-1])
        known = {axis.name: axis for axis in _DRAWN[self.quantity](self)}
        options = line_options if label is None else {"label": label, **line_options}
        return plots.plot([self._grid(known.get(name, Axis(name, name)))], ax, None, None, **options)

    def _grid(self, quantity: Axis) -> Grid:
        if len(self.axes) > _DRAWN_AXES:
            raise ParameterError(f"only maps over one or two axes are drawn (this one has {', '.join(self.axes)})")
        from ..output.mapplots import branch_changes, states

        second = f"second_{quantity.name}"
        axes = [(Axis(name, WAVENUMBER.label if name == "k" else axis_label(self.flow, name)), values)
                for name, values in self.axes.items()]
        return Grid(tuple(axes), quantity, self[quantity.name], states(self["status"]),
                    branch_changes(self) if self.quantity == "k_max" else None,
                    self[second] if second in self.results else None, quantity.name == "growth_rate")


_DRAWN = {  # the results that a figure shows
    "k_max": lambda found: (K_MAX, GROWTH_AT_K_MAX),
    "growth_rate": lambda found: (GROWTH_RATE, PHASE_SPEED),
    "neutral": lambda found: (Axis(found.request.vary, f"{symbol_of(found.flow, found.request.vary)} at zero growth"),
                              replace(WAVENUMBER, label="wavenumber $k$ (0: long waves)")),
}


def parameter_map(flow: "Flow", over: "Mapping[str, ArrayLike]", quantity: str | None = None, *,
                  k: "ArrayLike | None" = None, vary: str | None = None, executor: Executor | None = None,
                  workers: int = 1, journal: str | PathLike[str] | None = None,
                  report: Callable[[int, int], object] | None = None, tolerance: float = TOLERANCE,
                  max_degree: int = DEGREES[-1]) -> Map:
    """Return the `Map` of a quantity over one to three parameters, `over` = {name: values}.

    "k_max" (the default) is the fastest growing wavenumber with its growth rate, as `k_max` has it, "growth_rate"
    (the default with wavenumbers `k`, the innermost axis then) that of the mode that `dispersion` follows, "neutral"
    (the default with `vary`) the critical value of `vary`, as `critical` has it. What
    fails says so in its status.

    Work is done in this process, in `workers` processes of our own (a script then needs `if __name__ == "__main__":`
    around what it does, and cannot come from standard input), or on any `concurrent.futures.Executor`, where pieces
    that fail are submitted again. `journal` names a file that keeps finished pieces: the same call resumes from it;
    delete it once the map is stored. Lines of it that are damaged are computed again, and counted in `damaged` of the
    map. `report(done, total)` is called as points are done.

    >>> from stability import flows
    >>> found = parameter_map(flows.Dune(), {"shields": [1.5, 2.0], "Re": [10.0, 100.0]})
    >>> f"{found['k_max'][1, 0]:.7f}"
    '0.8492020'

    Columns have the units of `stability map --help`. Raises ParameterError where the request makes no map (names,
    values, wavenumbers that do not fit together) and WorkersLost where processes end again and again.
    """
    quantity = usual_quantity(k, vary) if quantity is None else quantity
    request = Request(flow, over, quantity, k, vary, check_accuracy(tolerance, max_degree))
    return carry_out(request, executor=executor, workers=workers, journal=journal, report=report)


def carry_out(request: Any, *, executor: Any = None, workers: Any = 1, journal: Any = None, report: Any = None,
              may_fork: bool = False) -> Any:
    """Return the `Map` of a request; see `parameter_map`. Workers are forked from this process if they may."""
    workers = _check_means(executor, workers, journal)
    pieces, report = request.pieces(), report or (lambda done, total: None)
    with _journal(request, pieces, journal) if journal is not None else nullcontext() as kept:
        done = dict(kept.done) if kept else {}
        left = [piece for piece in pieces if piece.index not in done]
        count = request.size - sum(piece.points for piece in left)
        report(count, request.size)
        with closing(compute_all(left, executor, workers, may_fork)) as finished:
            for piece, rows in finished:
                if kept:
                    kept.add(piece.index, rows)
                done[piece.index] = rows
                count += piece.points
                report(count, request.size)
    table = tuple((*row[:-1], status.status_of(row[-1])) for piece in pieces for row in done[piece.index])
    return Map(request, table, kept.damaged if kept else 0)


def points_kept(request: Any, journal: Any) -> int:
    """Return how many points of a request its journal holds: what was written, whether or not it was counted."""
    pieces = request.pieces()
    with _journal(request, pieces, journal) as kept:
        return sum(pieces[index].points for index in kept.done)


def _journal(request: Any, pieces: Any, path: Any) -> Journal:
    return Journal(path, request.description(), [(piece.points, len(request.results)) for piece in pieces])


def _check_means(executor: Any, workers: int, journal: Any) -> int:
    """Return the number of workers, or raise a ParameterError where a map cannot be computed with this."""
    if executor is not None and not callable(getattr(executor, "submit", None)):
        raise ParameterError(f"executor must be a concurrent.futures.Executor (got {shown(executor)})")
    if journal is not None:
        check_file_name(journal, "journal")
    return check_integer(workers, "workers", 1, MOST_WORKERS)
