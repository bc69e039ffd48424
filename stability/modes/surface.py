"""Where the slow surface mode starts: in waves so long that it obeys the limit that its flow states."""

from collections.abc import Iterator
from dataclasses import replace
from math import exp, log, log10
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import ModeLost, ParameterError
from ..flows.sources import shipped
from .branch import Branch, rough_solver
from .tracking import PACE

if TYPE_CHECKING:
    from ..flows.base import Flow
    from .mode import Mode
    from .solver import Solver

_FIRST, _APART, _TRIES = 10**-1.75, 0.75, 30  # where the long-wave limit is sought: so many decades apart
LAWFUL = replace(PACE, first=PACE.largest)  # of a mode that obeys a law where it starts
_AGREEMENT = 0.03  # of the surface mode with its long-wave limit, in value and in slope
_CONFIRMED = 3  # wavenumbers in a row, each a part of the last, at which it must agree
LOOKS = tuple(10 ** (log10(_FIRST) - _APART * look) for look in range(_CONFIRMED))  # the first at which it is sought
_NO_FARTHER = 1.5, 1e-3  # factor in its distance from the limit that each may have over the one before, and a floor
_TENDS, _CLOSE = 0.5, 1e-3  # limit of the difference over that at the last of them where a law is wrong; its accuracy
AHEAD = log(1.01)  # way in log k over which the local power of a long-wave limit is taken
_GLANCE = 0.3  # relative distance of a rate from a long-wave limit at which a mode that is foreseen may be meant


def surface_branch(solver: "Solver", known: "dict[float, Mode] | None" = None) -> "Branch":
    """Return the branch of the slow surface mode of `solver.flow`; raise ModeLost where it has no long-wave limit.

    `known` are modes of a flow that is nearly the same, {k: mode}.
    """
    rough, seen = rough_solver(solver, known), []
    return Branch(solver, surface_mode(rough, seen=seen), rough, seen, pace=LAWFUL)


def surface_mode(solver: "Solver", highest: float = _FIRST, seen: list[Any] | None = None) -> "Mode":
    """Return the slow surface mode at a wavenumber <= `highest` from which on it obeys its long-wave limit.

    Value and logarithmic slope must agree there, and again at a sixth and a thirtieth of it, no worse: another mode can
    meet one of them by chance. The list `seen` collects what was looked at.
    """
    agreeing = []
    for k, limit, exponent in _laws(solver, highest):
        mode, distance = _glance(solver, k, limit, exponent, agreeing[-1][0] if agreeing else None)
        if mode and seen is not None:
            seen.append(mode)
        if agreeing and not distance < max(_NO_FARTHER[0] * agreeing[-1][1], _NO_FARTHER[1]):
            agreeing = []
        if distance < _AGREEMENT:
            agreeing.append((mode, distance, limit, exponent))
        if len(agreeing) == _CONFIRMED:
            start, _, *law = agreeing[0]
            mode = start if solver.fits(start) else solver.refined(start)
            if _distance(mode, *law) < _AGREEMENT:
                _check_law(solver.flow, agreeing)
                return mode
            agreeing = []
    if not shipped(type(solver.flow)):
        raise ParameterError(f"{solver.flow.name}: long_wave contradicts the equations: no mode obeys it, in value "
                             f"and slope, down to k = {k:.1e}")
    raise ModeLost(f"{solver.flow}: no mode obeys the long-wave limit down to k = {k:.1e}")


def _laws(solver: "Solver", highest: float) -> Iterator[Any]:
    """Yield the wavenumbers that are tried, from the highest down, with the long-wave limit and its exponent."""
    tried = np.array([10 ** (log10(highest) - _APART * look) for look in range(_TRIES)])
    for first in range(0, _TRIES, _CONFIRMED):
        few = tried[first: first + _CONFIRMED]
        if not solver.foresight:
            solver.prepare(few)
        limits, ahead = law_ahead(solver.flow, few)
        yield from zip(few.tolist(), limits, np.log(ahead / limits) / AHEAD, strict=True)


def law_ahead(flow: "Flow", k: np.ndarray) -> list[np.ndarray]:
    """The long-wave limit at wavenumbers k (points,), and `AHEAD` of there: how it changes tells its powers of k."""
    return np.split(np.asarray(flow.long_wave(np.concatenate((k, exp(AHEAD) * k))), dtype=complex), 2)


def _check_law(flow: "Flow", agreeing: list[tuple[Any, ...]]) -> None:
    """Refuse a law, given by a flow from elsewhere, to which the mode does not tend.

    Its relative difference from the law falls like a power of k, by the same factor from each wavenumber to the next:
    what is left of it in the end follows from three of them.
    """
    if shipped(type(flow)):  # derived and proved
        return
    first, middle, last = (mode.sigma / limit - 1 for mode, _, limit, _ in agreeing)
    bend = first + last - 2 * middle
    left = (first * last - middle**2) / bend if abs(bend) > _CLOSE * abs(last) else last
    if abs(left) > max(_TENDS * abs(last), _CLOSE):
        mode, _, limit, _ = agreeing[-1]
        raise ParameterError(f"{flow.name}: long_wave contradicts the equations: at k = {mode.k:.1e} it is "
                             f"{limit:.6g}, the mode {mode.sigma:.6g}, and comes no closer as k falls")


def _glance(solver: Any, k: Any, limit: Any, exponent: Any, above: Any = None) -> Any:
    """The mode next to the long-wave limit, and how far from it, relative; None and infinity where none settles.

    `above` is the one that was found at the wavenumber before, if any.
    """
    vectors, rate = (above.degree, above.x, above.y) if above else None, limit / solver.width(k)
    try:
        mode = solver.foreseen(k, rate, _GLANCE) or solver.solve(k, rate, vectors, glance=True)
    except ModeLost:
        return None, np.inf
    return mode, _distance(mode, limit, exponent)


def _distance(mode: "Mode", limit: complex, exponent: complex) -> float:
    return max(abs(mode.sigma / limit - 1), abs(mode.k * mode.slope / mode.sigma - exponent))
