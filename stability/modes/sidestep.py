"""A step in the parameters: modes of a flow from those of one that is all but the same, without a walk.

Two ways lead from the long waves of a flow to a mode of another: along k and then in the parameters, or first in the
parameters and then along k, as a walk does. Both end at the same mode unless two modes meet in between. Near a point
where they do rates are a + sqrt(b), a and b analytic in k and the parameters with b = 0 there: at a distance d of it a
walk takes steps of no more than a few d, and the second order of what a change of the parameters by w makes is
w / (4 d) of the first. So nothing is met where all steps of the walk were long, the parameters change by much less than
those, and the rates to first order. Real modes are left to walks, since they meet wherever their rates are equal.
"""

from typing import TYPE_CHECKING, Any

from ..errors import ModeLost
from ..numerics.refine import quotient

if TYPE_CHECKING:
    from .mode import Mode
    from .solver import Solver

_LONG = 0.1  # shortest step of a walk, in log k, from whose modes one steps; measured: none is wrong from 0.05 on ...
_SHARE = 0.2  # ... and largest change of the logarithms of parameters, in its units; nor with five times as much
_SMALL = 0.4  # largest relative change of a rate
_BEND = 0.05  # largest departure of a change from its first order, relative
_FLAT = 1e-6  # departure, relative to the rate, that is never refused
_OVERLAP = 0.02  # largest deviation of the overlap from 1


def near_enough(way: float, shortest: float) -> bool:
    """Whether flows are all but the same whose parameters differ by `way`, in their logarithms, where the shortest step
    of a walk is this long."""
    return shortest >= _LONG and way <= _SHARE * shortest


def sidestepped(solver: "Solver", near: "list[Mode]") -> "dict[float, Mode] | None":
    """Return {k: mode} of the flow of a `solver` next to the modes `near` of another; None if any of them is unsure."""
    found = {}
    for old in near:
        mode = _step(solver, old)
        if mode is None:
            return None
        found[old.k] = mode
    return found


def _step(solver: "Solver", old: "Mode") -> "Mode | None":
    pencil, weights = solver.pencil(old.degree), solver.weights(old.k)
    if pencil.real or old.x.shape != (pencil.size,):
        return None
    guess = quotient(pencil, weights, old.x, old.y)
    if not small(guess, old):
        return None
    try:
        mode = solver.solve(old.k, guess, (old.degree, old.x, old.y))
    except ModeLost:
        return None
    return mode if solver.fits(mode) and straight(mode, guess, old) and overlapping(solver, mode, old) else None


def small(guess: complex, old: "Mode") -> bool:
    """Whether the rate changes by a small part of itself."""
    return abs(guess - old.rate) <= _SMALL * abs(old.rate)


def straight(mode: "Mode", guess: complex, old: "Mode") -> bool:
    """Whether the rate changes as its first order says."""
    return abs(mode.rate - guess) <= _BEND * abs(guess - old.rate) + _FLAT * abs(old.rate)


def overlapping(solver: Any, mode: "Mode", old: "Mode") -> bool:
    """Whether the eigenvectors of both modes are biorthogonal partners."""
    return abs(solver.overlap(old, mode) - 1) < _OVERLAP
