"""Branches that were followed are kept for a while: who asks about the same flow again goes on from there.

A walk takes the same steps whatever is asked, so that a branch taken up again is the one that would be followed anew.
Only those are kept that have met nothing, no collision, near meeting or end: what is met is told by the call that
meets it, and the next one is to meet it too; and of those only what takes little memory. Who uses a branch has it
alone: another thread follows its own.
"""

from collections import OrderedDict
from contextlib import contextmanager
from threading import Lock

KEPT = 8  # branches, some megabytes each

_branches: OrderedDict = OrderedDict()
_lock = Lock()


@contextmanager
def branch_of(solver, make):
    """Lend the branch that `make(solver)` returns, one that was followed before if there is one."""
    key = make, type(solver.flow), solver.flow, solver.tolerance, solver.degrees[-1], solver.bars
    try:
        with _lock:
            branch = _branches.pop(key, None)
    except TypeError:  # a flow that cannot be hashed
        yield make(solver)
        return
    branch = branch or make(solver)
    yield branch
    if branch.uneventful and branch.solver.assembly.small:
        with _lock:
            _branches[key] = branch
            while len(_branches) > KEPT:
                _branches.popitem(last=False)


def forget():
    """Keep nothing of what was followed."""
    with _lock:
        _branches.clear()
