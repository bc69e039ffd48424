"""Pieces of a map computed in this process, in processes of our own or on any executor, whatever fails meanwhile."""

from collections.abc import Callable, Iterator
from concurrent.futures import BrokenExecutor, as_completed
from typing import TYPE_CHECKING, Any

from ..errors import WorkersLost
from .pieces import compute
from .pool import GUARD, processes

if TYPE_CHECKING:
    from .request import GridPiece

_ROUNDS = 3  # in a row without a finished piece: then the executor is given up


def compute_all(pieces: Any, executor: Any, workers: Any, may_fork: bool) -> Any:
    """Yield (piece, rows) as pieces finish."""
    workers = min(workers, len(pieces))
    if executor is not None:
        return _in_rounds(pieces, lambda: _Lent(executor))
    if workers > 1:
        return _in_rounds(pieces, lambda: processes(workers, may_fork))
    return ((piece, compute(piece)) for piece in pieces)


class _Lent:
    """Somebody else's executor: left running at the end, without what it has not begun of our work."""

    def __init__(self, executor: Any) -> None:
        self._executor, self._futures = executor, []

    def submit(self, *call: Any) -> Any:
        self._futures.append(self._executor.submit(*call))
        return self._futures[-1]

    def __enter__(self) -> Any:
        return self

    def __exit__(self, *failure: Any) -> None:
        for future in self._futures:
            future.cancel()


def _in_rounds(pieces: "list[GridPiece]", open_executor: Callable[..., Any]) -> Iterator[Any]:
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


def _round(executor: Any, pieces: Any, attempt: Any) -> Iterator[Any]:
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


def _given_up(failure: Any) -> Any:
    if isinstance(failure, BrokenExecutor):
        return WorkersLost(f"worker processes ended {_ROUNDS} times before they finished anything: {GUARD}; or memory "
                           "is short: try fewer workers")
    return failure
