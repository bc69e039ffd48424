"""Branches that were followed are kept for a while: who asks about the same flow again goes on from there, and who asks
about one that is nearly the same foresees from them what a walk will meet, or, if it is all but the same, steps from
their answers to its own.

A walk takes the same steps whatever is asked, so that a branch taken up again is the one that would be followed anew.
Only those are kept that have met nothing, no collision, near meeting or end: what is met is told by the call that
meets it, and the next one is to meet it too; and of those only what takes little memory. Who uses a branch has it
alone: another thread follows its own.
"""

from collections import OrderedDict
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import fields
from math import inf, log
from threading import Lock
from typing import TYPE_CHECKING, Any

import numpy as np

from ..flows.sources import shipped
from .sidestep import near_enough, sidestepped
from .surface import LOOKS

if TYPE_CHECKING:
    from ..flows.base import Flow
    from .branch import Branch
    from .mode import Mode
    from .solver import Solver

KEPT = 8  # branches, some megabytes each ...
_MOST = 4_000_000  # ... and entries of all their matrices, some 30 bytes each
_AHEAD = 20  # wavenumbers asked for whose functions of k are evaluated with those of the first modes looked at
_NEAR = 0.8  # largest distance of flows, in the logarithms of their parameters, whose branches resemble one another

_branches: OrderedDict = OrderedDict()
_kept: ContextVar = ContextVar("branches", default=_branches)
_lock = Lock()


@contextmanager
def branch_of(solver: "Solver", make: Callable[..., Any], wavenumbers: Any) -> Iterator[Any]:
    """Lend the branch that `make(solver, known)` returns, one that was followed before if there is one.

    `known` are modes of a flow that is nearly the same, {k: mode}, up to the `wavenumbers` that are asked for, or None.
    """
    key = _key(solver, make)
    try:
        with _lock:
            branch = _kept.get().pop(key, None)
            near = None if branch else _nearest(*key)[1]
            known = near and near.known
    except TypeError:  # a flow that cannot be hashed
        yield make(solver, None)
        return
    if known:
        known = _up_to(max(wavenumbers), known)
    if not branch and solver.halves == (solver,):  # else those of the halves matter
        solver.prepare(np.array([*(known or LOOKS), *wavenumbers[:_AHEAD]]))
    branch = branch or make(solver, known)
    yield branch
    if branch.uneventful and branch.solver.assembly.small:
        with _lock:
            branches = _kept.get()
            branches[key] = branch
            while len(branches) > KEPT or len(branches) > 1 and _entries(branches) > _MOST:
                branches.popitem(last=False)


def beside(solver: "Solver", make: Callable[..., Any], wavenumbers: list[float]) -> "dict[float, Mode] | None":
    """Return {k: mode} by a step from the answers of a branch of `make` of a flow that is all but the same, or None."""
    key, branches = _key(solver, make), _kept.get()
    if not shipped(type(solver.flow)):  # their laws are checked on the way
        return None
    try:
        with _lock:
            way, near = (inf, None) if key in branches else _nearest(*key)
            if near is None or not near_enough(way, near.shortest_step):
                return None
            answers = near.answers
            if not answers.keys() >= set(wavenumbers):
                return None
            branches.move_to_end(_key(near.solver, make))
    except TypeError:  # a flow that cannot be hashed
        return None
    return sidestepped(solver, [answers[k] for k in wavenumbers])


def _key(solver: "Solver", make: Callable[..., Any]) -> tuple[Any, ...]:
    return solver.flow, type(solver.flow), make, solver.tolerance, solver.degrees[-1], solver.bars


def _entries(branches: OrderedDict) -> int:
    return sum(branch.solver.assembly.entries for branch in branches.values())


def _nearest(flow: "Flow", *others: Any) -> "tuple[float, Branch | None]":
    """The nearest branch of the same kind that is kept, and how far its flow is; None where none is near."""
    near, least = None, _NEAR
    for (other, *key), branch in _kept.get().items():
        if key == list(others) and (way := _distance(flow, other)) < least:
            near, least = branch, way
    return least, near


def _up_to(k: float, known: "dict[float, Mode]") -> "dict[float, Mode]":
    """What is known up to the first wavenumber beyond k."""
    beyond = min((other for other in known if other > k), default=inf)
    return {other: mode for other, mode in known.items() if other <= beyond}


def _distance(one: "Flow", other: "Flow") -> float:
    """Between two flows that differ in positive numbers alone: the sum of the moduli of log ratios."""
    total = 0.0
    for item in fields(one):
        a, b = getattr(one, item.name), getattr(other, item.name)
        if a is not b and a != b:
            if not (isinstance(a, float) and isinstance(b, float) and 0 < a < inf and 0 < b < inf):
                return inf
            total += abs(log(a / b))
    return total


@contextmanager
def apart() -> Iterator[Any]:
    """Remember nothing in here of what was before, nor afterwards of what was here: digits depend on no other work."""
    token = _kept.set(OrderedDict())
    try:
        yield
    finally:
        _kept.reset(token)


def forget() -> None:
    """Keep nothing of what was followed."""
    with _lock:
        _kept.get().clear()
