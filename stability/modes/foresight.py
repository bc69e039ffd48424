"""Modes that a walk is likely to meet, from those that it met in a flow that is nearly the same.

Walks of such flows take the same steps for the most part. So the modes at the wavenumbers of one are refined for the
other all at once, which costs a third of solving for each in turn; its walk then takes them where it comes to them,
judged as if it had found them itself: what is foreseen saves work and decides nothing.
"""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from .solver import transfer

if TYPE_CHECKING:
    from .mode import Mode
    from .solver import Solver

_SIMILAR = 2.2  # largest ratio of degrees that are made the same


class Foresight:
    """Modes of the flow of a `solver` next to those `known`, {k: mode}, of another flow."""

    def __init__(self, solver: "Solver", known: "dict[float, Mode]") -> None:
        solver.prepare(np.array(list(known)))
        self._likely = {mode.k: mode for mode in _refined(solver, list(known.values()))}

    def at(self, k: float, rate: complex, part: float) -> "Mode | None":
        """The mode foreseen at k if its rate is this one to a small part of it, or None."""
        mode = self._likely.get(k)
        return mode if mode and abs(mode.rate - rate) < part * abs(rate) else None


def _refined(solver: "Solver", known: "list[Mode]") -> Iterator[Any]:
    for degree, group in _groups(known):
        if group[0].x.shape != (solver.pencil(group[0].degree).size,):
            return
        vectors = [np.array(vectors) for vectors in zip(*(
            transfer(solver, (mode.degree, mode.x, mode.y), degree) for mode in group), strict=True)]
        modes = solver.solve_many([mode.k for mode in group], None, vectors, degree)
        yield from (mode for mode in modes if mode)


def _groups(modes: "list[Mode]") -> list[tuple[Any, ...]]:
    """Modes that are refined together, each group with the largest degree among its own: similar ones share it."""
    groups: dict[int, list[Mode]] = {}
    for mode in sorted(modes, key=lambda mode: -mode.degree):
        top = next((degree for degree in groups if degree <= _SIMILAR * mode.degree), mode.degree)
        groups.setdefault(top, []).append(mode)
    return list(groups.items())
