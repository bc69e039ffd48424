"""The rows of a piece of a map: what `studies` have to say at neighbouring points of its grid."""

from collections.abc import Iterator
from itertools import islice
from typing import TYPE_CHECKING, Any

from .. import status
from ..errors import StabilityError
from ..flows.sources import faults
from ..modes.memory import apart
from .dispersion import dispersion
from .kmax import k_max_sweep

if TYPE_CHECKING:
    from .kmax import Optimum
    from .request import GridPiece


def compute(piece: "GridPiece", attempt: int = 0) -> list[list[float]]:
    """Return the rows of a piece: a list with the values of the columns for each point.

    `attempt` does nothing: it tells an engine that remembers calls by their arguments that this is another one.
    """
    with faults(), apart():
        return [list(row) for row in _ROWS[piece.quantity](piece)]


def _k_max_rows(piece: "GridPiece") -> Iterator[Any]:
    def sweep(flows: Any) -> Any:
        return k_max_sweep(flows, **piece.accuracy.settings)

    for found in _each(sweep, piece.flows):
        yield _nothing(piece, found) if isinstance(found, str) else _optimum_row(found)


def _optimum_row(optimum: "Optimum") -> tuple[Any, ...]:
    if not optimum.maxima:
        return *[None] * (5 if optimum.flow.data is None else 7), 0, None, None, optimum.status
    second = optimum.maxima[1] if len(optimum.maxima) > 1 else None
    errors = () if optimum.flow.data is None else (optimum.data_error, optimum.growth_data_error)
    return (optimum.k_max, optimum.growth_rate, optimum.phase_speed, optimum.error, *errors, optimum.best.mode.error,
            len(optimum.maxima), second and second.k, second and second.growth_rate, optimum.status)


def _growth_rate_rows(piece: Any) -> Iterator[Any]:
    def sweep(flows: Any) -> Iterator[Any]:
        for flow in flows:
            yield dispersion(flow, piece.k, strict=False, rivals=True, **piece.accuracy.settings)

    for found in _each(sweep, piece.flows):
        if isinstance(found, str):
            yield from [_nothing(piece, found)] * len(piece.k)
        else:
            yield from _relation_rows(piece, found)


def _relation_rows(piece: Any, relation: Any) -> Iterator[Any]:
    modes = {mode.k: (mode, state) for mode, state in zip(relation.modes, relation.status, strict=True)}
    for k in piece.k:
        if k not in modes:
            yield _nothing(piece, status.Status(status.Kind.LOST, relation.lost[k]))
            continue
        mode, state = modes[k]
        yield mode.growth_rate, mode.phase_speed, mode.error, *_data_error(relation.flow, mode), mode.degree, state


def _neutral_rows(piece: Any) -> Iterator[Any]:
    from .critical import critical_sweep

    def sweep(flows: Any) -> Any:
        return critical_sweep(flows, piece.vary, **piece.accuracy.settings)

    for found in _each(sweep, piece.flows):
        if isinstance(found, str):
            yield _nothing(piece, found)
        else:
            yield (found.value, found.k, found.phase_speed, found.error, *_data_error(found.flow, found), found.k_error,
                   found.status)


def _data_error(flow: Any, result: Any) -> Any:
    return () if flow.data is None else (result.data_error,)


def _nothing(piece: Any, why: Any) -> Any:
    return *[None] * (piece.width - 1), status.status_of(why)


def _each(sweep: Any, flows: Any) -> Any:
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
