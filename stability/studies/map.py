"""Maps: one quantity over a grid of one to three parameters, computed in pieces on any executor.

A piece is a fixed part of the grid, a stretch of its innermost parameter, so that results depend neither on the
number of workers nor on the order in which they finish, nor on interruptions.
"""

from collections.abc import Callable, Mapping
from concurrent.futures import BrokenExecutor, Executor, as_completed
from contextlib import closing, nullcontext
from dataclasses import dataclass, field, fields, replace
from itertools import islice, product
from math import prod
from os import PathLike
from typing import TYPE_CHECKING, Any

import numpy as np

from .. import status
from ..checks import check_file_name, check_integer, check_options, check_wavenumbers, flat, shown
from ..errors import ParameterError, StabilityError, WorkersLost
from ..flows.base import check_flow, check_parameter
from ..flows.sources import faults, origin
from ..modes.memory import apart
from ..modes.solver import DEGREES, TOLERANCE, check_accuracy
from ..output.panels import GROWTH_AT_K_MAX, GROWTH_RATE, K_MAX, PHASE_SPEED, WAVENUMBER, Axis, Grid
from ..output.record import Record
from ..output.symbols import axis_label, symbol_of
from ..output.text import Row, measured
from .dispersion import default_mode, dispersion
from .journal import Journal
from .kmax import k_max_sweep
from .neutral import check_parameter_name, critical_sweep
from .outgrown import outgrown
from .pool import GUARD, MOST_WORKERS, processes

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import ArrayLike

    from ..flows import Flow

QUANTITIES = ("k_max", "growth_rate", "neutral")

_COLUMNS = {
    "k_max": ("k_max", "growth_rate", "phase_speed", "error", "growth_error", "maxima", "second_k_max",
              "second_growth_rate", "status"),
    "growth_rate": ("growth_rate", "phase_speed", "error", "degree", "status"),
    "neutral": ("k", "phase_speed", "error", "k_error", "status"),  # headed by the parameter that is solved for
}
_PIECE = {"k_max": 4, "growth_rate": 1, "neutral": 16}  # flows of a piece, neighbours along the innermost parameter
_MOST_AXES = 3
_DRAWN_AXES = 2
_MOST_POINTS = 1_000_000
_ROUNDS = 3  # in a row without a finished piece: then the executor is given up


@dataclass(frozen=True)
class Request:
    """What a map is asked for: `over` {parameter: values}, the first outermost; k belongs to "growth_rate", `vary` to
    "neutral". Raises ParameterError where that makes no map."""

    flow: Any
    over: Any = field(hash=False)
    quantity: str
    k: Any = None
    vary: str | None = None
    tolerance: float = TOLERANCE
    max_degree: int = DEGREES[-1]

    def __post_init__(self):
        check_flow(self.flow)
        self._set(quantity=check_options("quantity", self.quantity, QUANTITIES))
        tolerance, max_degree = check_accuracy(self.tolerance, self.max_degree)
        self._set(tolerance=tolerance, max_degree=max_degree)
        if not isinstance(self.over, Mapping):
            raise ParameterError(f"over must be a dict {{parameter: values}} (got {shown(self.over)})")
        if not 1 <= len(self.over) <= _MOST_AXES:
            raise ParameterError(f"over: a map has one to {_MOST_AXES} swept parameters (got {len(self.over)})")
        self._set(over={name: self._values(name, values) for name, values in self.over.items()})
        self._check_quantity()
        if self.k is not None:
            self._set(k=tuple(check_wavenumbers(self.k).tolist()))
        if not 1 <= self.size <= _MOST_POINTS:
            raise ParameterError(f"over: a map has 1 to {_MOST_POINTS} points (got {self.size}): coarsen or split it")

    def _set(self, **values):
        for name, value in values.items():
            object.__setattr__(self, name, value)

    def _values(self, name, values):
        check_parameter_name(self.flow, name)
        (item,) = (item for item in fields(self.flow) if item.name == name)
        return tuple(check_parameter(self.flow.name, item, value) for value in flat(values, f"over: {name}"))

    def _check_quantity(self):
        for name, owner, meaning in (("k", "growth_rate", "wavenumbers"),
                                     ("vary", "neutral", "a parameter to solve for")):
            given = getattr(self, name) is not None
            if given != (self.quantity == owner):
                raise ParameterError(f"{name}: " + (f"quantity {self.quantity} takes none, only {owner} does" if given
                                                    else f"quantity {owner} needs {meaning}"))
        if self.vary is not None:
            check_parameter_name(self.flow, self.vary)
        if self.vary in self.over:
            raise ParameterError(f"vary: {self.vary} is the parameter to solve for; sweep another one")

    @property
    def axes(self):
        """{name: values (count,)}, outermost first; k is the innermost."""
        axes = self.over if self.k is None else {**self.over, "k": self.k}
        return {name: np.array(values) for name, values in axes.items()}

    @property
    def shape(self):
        return tuple(len(values) for values in self.axes.values())

    @property
    def size(self):
        """How many points there are."""
        return prod(self.shape)

    @property
    def results(self):
        """Names of the results at each point; the last is the status."""
        names = list(_COLUMNS[self.quantity])
        place = names.index("error") + 1
        names[place:place] = measured(self.flow, *(("growth_data_error",) if self.quantity == "k_max" else ()))
        return (() if self.vary is None else (self.vary,)) + tuple(names)

    def pieces(self):
        """The pieces of the grid, in its order."""
        *outer, (name, inner) = self.over.items()
        lines = product(*(values for _, values in outer))
        stretches = [inner[first: first + _PIECE[self.quantity]]
                     for first in range(0, len(inner), _PIECE[self.quantity])]
        names = (*(outer_name for outer_name, _ in outer), name)
        return tuple(Piece(index, self.quantity, tuple(self._at(names, (*line, value)) for value in stretch), self.k,
                           self.vary, self.tolerance, self.max_degree, len(self.results))
                     for index, (line, stretch) in enumerate(product(lines, stretches)))

    def _at(self, names, values):
        """The flow at a point, or the reason (a string) why there is none."""
        try:
            return replace(self.flow, **dict(zip(names, values, strict=True)))
        except ParameterError as reason:
            return str(reason)

    def description(self):
        """All that the results depend on, as plain values."""
        from .. import __version__

        fixed = {name: value for name, value in self.flow.stated().items() if name not in self.over}
        return {"version": __version__, "flow": self.flow.name, **origin(type(self.flow)), "parameters": fixed,
                "over": [[name, list(values)] for name, values in self.over.items()], "quantity": self.quantity,
                "k": self.k and list(self.k), "vary": self.vary, "tolerance": self.tolerance,
                "max_degree": self.max_degree}


@dataclass(frozen=True)
class Piece:
    """Neighbouring points that are computed together: a flow, or why there is none (a string), at each."""

    index: int
    quantity: str
    flows: tuple
    k: tuple | None
    vary: str | None
    tolerance: float
    max_degree: int
    width: int  # results of a point

    @property
    def points(self):
        return len(self.flows) * len(self.k or (None,))


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
        return {**mode, "tolerance": float(request.tolerance), "max_degree": request.max_degree}

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
    request = Request(flow, over, quantity, k, vary, tolerance, max_degree)
    return carry_out(request, executor=executor, workers=workers, journal=journal, report=report)


def usual_quantity(k, vary):
    """The quantity that is meant where none is named."""
    return "neutral" if vary is not None else "k_max" if k is None else "growth_rate"


def carry_out(request, *, executor=None, workers=1, journal=None, report=None):
    """Return the `Map` of a request; see `parameter_map`."""
    workers = _check_means(executor, workers, journal)
    pieces, report = request.pieces(), report or (lambda done, total: None)
    shapes = [(piece.points, len(request.results)) for piece in pieces]
    with Journal(journal, request.description(), shapes) if journal is not None else nullcontext() as kept:
        done = dict(kept.done) if kept else {}
        left = [piece for piece in pieces if piece.index not in done]
        count = request.size - sum(piece.points for piece in left)
        report(count, request.size)
        with closing(_compute_all(left, executor, workers)) as finished:
            for piece, rows in finished:
                if kept:
                    kept.add(piece.index, rows)
                done[piece.index] = rows
                count += piece.points
                report(count, request.size)
    table = tuple(tuple(row) for piece in pieces for row in done[piece.index])
    return Map(request, table, kept.damaged if kept else 0)


def _check_means(executor, workers, journal):
    """Return the number of workers, or raise a ParameterError where a map cannot be computed with this."""
    if executor is not None and not callable(getattr(executor, "submit", None)):
        raise ParameterError(f"executor must be a concurrent.futures.Executor (got {shown(executor)})")
    if journal is not None:
        check_file_name(journal, "journal")
    return check_integer(workers, "workers", 1, MOST_WORKERS)


def _compute_all(pieces, executor, workers):
    """Yield (piece, rows) as pieces finish."""
    workers = min(workers, len(pieces))
    if executor is not None:
        return _in_rounds(pieces, lambda: _Lent(executor))
    if workers > 1:
        return _in_rounds(pieces, lambda: processes(workers))
    return ((piece, compute(piece)) for piece in pieces)


class _Lent:
    """Somebody else's executor: left running at the end, without what it has not begun of our work."""

    def __init__(self, executor):
        self._executor, self._futures = executor, []

    def submit(self, *call):
        self._futures.append(self._executor.submit(*call))
        return self._futures[-1]

    def __enter__(self):
        return self

    def __exit__(self, *failure):
        for future in self._futures:
            future.cancel()


def _in_rounds(pieces, open_executor):
    """Compute the pieces; those lost with their worker are computed again in the next round, on a new executor."""
    left, fruitless, attempt = {piece.index: piece for piece in pieces}, 0, 0
    while left:
        before, failure = len(left), None
        with open_executor() as executor:
            for piece, rows, reason in _round(executor, tuple(left.values()), attempt):
                if reason is None:
                    del left[piece.index]
                    yield piece, rows
                else:
                    failure = reason
        attempt += 1
        fruitless = fruitless + 1 if len(left) == before else 0
        if fruitless == _ROUNDS:
            raise _given_up(failure)


def _round(executor, pieces, attempt):
    """Submit the pieces; yield (piece, rows, None) or (piece, None, exception) as they end."""
    futures = {}
    try:
        for piece in pieces:
            futures[executor.submit(compute, piece, attempt)] = piece
    except BrokenExecutor as reason:  # while it was being filled
        yield None, None, reason
    for future in as_completed(futures):
        try:
            yield futures[future], future.result(), None
        except Exception as reason:  # whatever an engine raises for a lost worker
            yield futures[future], None, reason


def _given_up(failure):
    if isinstance(failure, BrokenExecutor):
        return WorkersLost(f"worker processes ended {_ROUNDS} times before they finished anything: {GUARD}; or memory "
                           "is short: try fewer workers")
    return failure


def compute(piece, attempt=0):
    """Return the rows of a piece: a list with the values of the columns for each point.

    `attempt` does nothing: it tells an engine that remembers calls by their arguments that this is another one.
    """
    with faults(), apart():
        return [list(row) for row in _ROWS[piece.quantity](piece)]


def _k_max_rows(piece):
    def sweep(flows):
        return k_max_sweep(flows, tolerance=piece.tolerance, max_degree=piece.max_degree)

    for found in _each(sweep, piece.flows):
        yield _nothing(piece, found) if isinstance(found, str) else _optimum_row(found)


def _optimum_row(optimum):
    if not optimum.maxima:
        return *[None] * (5 if optimum.flow.data is None else 7), 0, None, None, optimum.status
    second = optimum.maxima[1] if len(optimum.maxima) > 1 else None
    errors = () if optimum.flow.data is None else (optimum.data_error, optimum.growth_data_error)
    return (optimum.k_max, optimum.growth_rate, optimum.phase_speed, optimum.error, *errors, optimum.best.mode.error,
            len(optimum.maxima), second and second.k, second and second.growth_rate, optimum.status)


def _growth_rate_rows(piece):
    def sweep(flows):
        for flow in flows:
            yield dispersion(flow, piece.k, strict=False, tolerance=piece.tolerance, max_degree=piece.max_degree)

    for found in _each(sweep, piece.flows):
        if isinstance(found, str):
            yield from [_nothing(piece, found)] * len(piece.k)
        else:
            yield from _relation_rows(piece, found)


def _relation_rows(piece, relation):
    modes = {mode.k: mode for mode in relation.modes}
    faster = outgrown(relation)
    for k in piece.k:
        if k not in modes:
            yield _nothing(piece, f"lost: {relation.lost[k]}")
            continue
        mode = modes[k]
        state = status.outgrown(mode.status) if faster and k >= faster.k else mode.status
        yield mode.growth_rate, mode.phase_speed, mode.error, *_data_error(relation.flow, mode), mode.degree, state


def _neutral_rows(piece):
    def sweep(flows):
        return critical_sweep(flows, piece.vary, tolerance=piece.tolerance, max_degree=piece.max_degree)

    for found in _each(sweep, piece.flows):
        if isinstance(found, str):
            yield _nothing(piece, found)
        else:
            yield (found.value, found.k, found.phase_speed, found.error, *_data_error(found.flow, found), found.k_error,
                   found.status)


def _data_error(flow, result):
    return () if flow.data is None else (result.data_error,)


def _nothing(piece, why):
    return *[None] * (piece.width - 1), why


def _each(sweep, flows):
    """What `sweep(flows)` yields for each flow, in order, or a string that says why there is nothing."""
    found = [flow if isinstance(flow, str) else None for flow in flows]
    left = [index for index, flow in enumerate(flows) if not isinstance(flow, str)]
    while left:
        try:
            for result in islice(sweep([flows[index] for index in left]), len(left)):
                found[left.pop(0)] = result
        except StabilityError as reason:
            found[left.pop(0)] = str(reason)
    return found


_ROWS = {"k_max": _k_max_rows, "growth_rate": _growth_rate_rows, "neutral": _neutral_rows}
