"""Where growth rates are largest over k: every crest of every mode that matters.

The surface mode is followed from long waves to the end of the search, and a crest lies wherever the slope of its
growth turns from positive to negative. Other modes are looked for at neighbouring wavenumbers: all that decay no
faster than `_DEPTH` times the waves travel are taken from dense spectra whose completeness is checked, and followed
to both neighbours; a crest lies where the slope turns on the way.
"""

from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from itertools import pairwise
from math import ceil, log
from typing import TYPE_CHECKING, Any

import numpy as np

from ..equations.layer import numbers
from ..errors import ModeLost
from ..flows.sources import shipped
from ..numerics import chebyshev
from .listing import near_neutral, same
from .memory import branch_of
from .short_waves import ill_posed_somewhere
from .surface import AHEAD, law_ahead, surface_branch
from .tracking import Walk

if TYPE_CHECKING:
    from ..flows.base import Flow
    from .branch import Branch
    from .mode import Mode
    from .solver import Solver

SEARCH = 1e-2, 100.0  # range of k; with a surface mode its lower end moves down until growth is a power of k
ROUGH = 1e-4  # tolerance of the look: small systems find the brackets
_FINER = 1e-7  # where the sign of a slope is in doubt

_SHORT = 20.0  # wavenumber times thickness of a layer up to which growth is looked for at least
_STEP = 0.3  # of the look at other modes, in log k
_DEPTH = 0.05  # damping of the modes that are followed, as a wave speed over the spread of speeds
_POINTS = 32  # at which that spread is taken
_FIT, _CLEARLY = 0.3, 0.1  # departure of two modes from one curve, relative to its size and to that of other pairs
_DECADE = 10.0
_DECADES = 16  # below the search in which the long-wave regime is sought
_VANISHING = 1e-9  # wavenumber that stands for 0
_AGREEMENT = 0.03  # of the mode there with the long-wave limit
_POWERS = 0.9, 2.5  # of k, between which growth lies there
_SHARE = 0.1  # of growth in the limit that makes it of that order
_FACTOR, _CHANGE = 1.5, 0.3  # of growth, and in its power, from what it is there, in long waves
_REGIME = 0.02  # change of the local power of the long-wave law in a decade that its own regimes differ by
_UNEVEN = 0.2  # departure of growth between two nodes from the mean of its end slopes beyond which they get a middle
_FINEST = 6  # halvings of a stretch between two nodes
_AUDIBLE = 1.5  # times its error that a slope of growth must have, or the mode is computed properly
_NOISE = 5.0  # times its error that a difference or slope of growth must have to be judged by


def crest_mode(flow: "Flow") -> str:
    """Whose crests are meant unless told otherwise: those of all modes, "leading", or in ill-posed flows "surface"."""
    if not flow.has_surface_mode():
        return "leading"
    return "surface" if ill_posed_somewhere(flow) else "leading"


def search_of(flow: "Flow", mode: str) -> tuple[float, ...]:
    """The range of k that is searched unless told otherwise: up to waves short beside the thinnest layer."""
    if mode != "leading":
        return SEARCH
    thinnest = min(float(layer.height(np.array(1.0))) for layer in flow.layers(numbers(flow)))
    return SEARCH[0], max(SEARCH[1], _SHORT / thinnest)


@dataclass(frozen=True)
class Outlook:
    """What was seen along k: `brackets`, pairs of modes with a crest in between; `ends`, modes at both ends of the
    search; `trouble`, why something may have been overlooked, or None."""

    brackets: list
    ends: tuple[list, list]
    trouble: str | None


def surface_look(solver: "Solver", low: float, high: float, growing: bool = False) -> "Outlook":
    """Look along the surface mode, from where growth is a power of k to k = high; `low` bounds where that is sought.

    Where only `growing` crests are wanted, there is no look between nodes that decay clearly. Raises ModeLost where
    there is no such regime.
    """
    rough, finer = solver.rough(ROUGH), solver.rough(_FINER)
    with branch_of(solver, surface_branch, [high]) as branch:
        start = _long_waves(branch, low)
        lost = None if branch.reach(high) else branch.why_lost(high)
        nodes = [node for part in branch.segments for node in part if start <= node.k]
    inside = sum(node.k < high for node in nodes)
    nodes, wanted = nodes[: inside + 1], set()
    for index, (a, b) in enumerate(pairwise(nodes)):
        if not growing or not _decays(a, b):
            wanted |= {index, index + 1}
    nodes = [_heard(finer, node) if index in wanted else node for index, node in enumerate(nodes)]
    brackets = [pair for index, (a, b) in enumerate(pairwise(nodes)) if {index, index + 1} <= wanted
                for pair in _brackets(rough, a, b)]
    return Outlook(brackets, (nodes[:1], [] if lost else nodes[-1:]), lost)


def look(solver: "Solver", low: float, high: float) -> "Outlook":
    """Look at every mode that decays slowly or grows, low <= k <= high, each symmetry class by itself."""
    parts = [_look(half, low, high) for half in solver.halves]
    trouble = [part.trouble for part in parts if part.trouble]
    first, last = ([mode for part in parts for mode in part.ends[side]] for side in (0, 1))
    return Outlook([pair for part in parts for pair in part.brackets], (first, last), trouble[0] if trouble else None)


def _look(solver: "Solver", low: float, high: float) -> "Outlook":
    high = min(high, solver.flow.shortest())
    if not low < high:
        return Outlook([], ([], []), None)
    grid = np.geomspace(low, high, 1 + max(1, ceil(log(high / low) / _STEP))).tolist()
    rough, rung, columns, trouble = solver.rough(ROUGH), 0, [], None
    depth = depth_of(solver.flow)
    for k in grid:
        try:
            modes, rung = near_neutral(rough, k, depth(k), rung)
            columns.append(modes)
        except ModeLost as reason:
            trouble = trouble or str(reason)
            columns.append(None)
    brackets = [pair for here, there in pairwise(columns) if here is not None and there is not None
                for nodes in _ways(rough, here, there) for a, b in pairwise(nodes) for pair in _brackets(rough, a, b)]
    return Outlook(brackets, (columns[0] or [], columns[-1] or []), trouble)


def depth_of(flow: "Flow") -> Callable[..., Any]:
    """The decay rate, in units of the rates, down to which modes are looked at, as a function of k.

    In terms of wave speeds: `_DEPTH` of the differences of speed, or the thickness of a viscous layer in these units
    where that is less: no wave speed changes by more within a step.
    """
    points = chebyshev.points(_POINTS)
    bases = [layer.base(points) for layer in flow.layers(numbers(flow)) if not layer.steady]
    speed = float(np.ptp(np.concatenate([np.broadcast_to(base.U, points.shape) for base in bases]))) or 1.0
    viscosity = min(float(np.mean(base.beta / base.rho)) for base in bases)
    return lambda k: speed * min(_DEPTH, (viscosity / (k * speed)) ** (1 / 3))


def _ways(solver: "Solver", here: list[Any], there: list[Any]) -> Iterator[Any]:
    """Nodes by rising k of every mode from one wavenumber to the next: both ends where rates and slopes leave no doubt
    which belong together, else as followed there, or back where none arrived."""
    pairs = _partners(here, there)
    yield from pairs
    known = [mode for pair in pairs for mode in pair]
    arrived = []
    for start in here:
        if there and start not in known:
            with suppress(ModeLost):
                walk = Walk(solver, start)
                arrived.append(walk.to(there[0].k))
                yield [node for part in walk.segments for node in part]
    for start in there:
        if here and start not in known and not any(same(start, mode) for mode in arrived):
            with suppress(ModeLost):
                walk = Walk(solver, start)
                walk.to(here[0].k)
                yield [node for part in walk.segments for node in part][::-1]


def _partners(here: list[Any], there: list[Any]) -> list[Any]:
    """Pairs of modes at two wavenumbers whose rates and slopes fit one curve, and no other pair nearly as well."""
    if not here or not there:
        return []
    h = log(there[0].k / here[0].k)
    (a, b), (u, v) = (np.array([(mode.rate, h * mode.k * mode.rate_slope) for mode in modes]).T
                      for modes in (here, there))
    bend = np.abs(u - a[:, None] - (b[:, None] + v) / 2)  # of every pair (here, there)
    size = np.abs(u - a[:, None]) + np.abs(b[:, None]) + np.abs(v)
    pairs = []
    for i, j in enumerate(bend.argmin(axis=1).tolist()):
        rivals = np.concatenate((np.delete(bend[i], j), np.delete(bend[:, j], i)))
        if bend[i, j] < _FIT * size[i, j] and np.all(bend[i, j] < _CLEARLY * rivals):
            pairs.append([here[i], there[j]])
    return pairs


def _heard(solver: "Solver", node: "Mode") -> "Mode":
    """The node, computed by a finer solver where its slope of growth does not stand out from its error."""
    if abs(node.slope.real) > _AUDIBLE * node.slope_error:
        return node
    return solver.refined(node)


def _brackets(solver: "Solver", left: "Mode", right: "Mode", halvings: int = _FINEST) -> list[Any]:
    """Pairs of modes between two nodes with a crest in between, halving what is too uneven to judge by its ends."""
    a, b = (mode.k * mode.slope.real for mode in (left, right))
    h, rise = log(right.k / left.k), right.growth_rate - left.growth_rate
    size = abs(rise) + h * (abs(a) + abs(b))
    if halvings and abs(rise - h * (a + b) / 2) > _UNEVEN * size and size > _NOISE * (left.error + right.error):
        with suppress(ModeLost):
            middle = Walk(solver, left).to((left.k * right.k) ** 0.5)
            return [*_brackets(solver, left, middle, halvings - 1), *_brackets(solver, middle, right, halvings - 1)]
    return [(left, right)] if a > 0 >= b else []


def may_grow(left: "Mode", right: "Mode") -> bool:
    """Whether growth between the two ends of a bracket may exceed 0, by generous tangents."""
    a, b = (mode.k * mode.slope.real for mode in (left, right))
    h = log(right.k / left.k)
    return max(left.growth_rate + h * a, right.growth_rate - h * b) > 0


def _decays(left: "Mode", right: "Mode") -> bool:
    """Whether growth between two nodes is so far below 0 that slopes at both ends, taken upwards, do not reach it."""
    h = log(right.k / left.k)
    rises = (h * mode.k * (abs(mode.slope.real) + _AUDIBLE * mode.slope_error) for mode in (left, right))
    return max(left.growth_rate + left.error, right.growth_rate + right.error) + sum(rises) < 0


def _long_waves(branch: "Branch", low: float) -> float:
    """A wavenumber <= low from which down, for a decade, growth is what it is as k -> 0: no crest lies lower."""
    k = _last_regime(branch.solver.flow, low)
    growth, power = _as_k_vanishes(branch, k)
    finer = branch.solver.rough(_FINER)
    for _ in range(_DECADES):
        if not branch.reach(k / _DECADE):
            raise ModeLost(branch.why_lost(k / _DECADE))
        nodes = [_heard(finer, node) for part in branch.segments for node in part if k / _DECADE < node.k <= k]
        if nodes and all(_FACTOR > node.growth_rate / growth(node.k) > 1 / _FACTOR and
                         abs(node.k * node.slope.real / node.growth_rate - power) < _CHANGE for node in nodes):
            return max(node.k for node in nodes)
        k /= _DECADE
    raise ModeLost(f"{branch.solver.flow}: growth follows no power of k down to k = {k:.1e}")


def _as_k_vanishes(branch: "Branch", k: float) -> tuple[Callable[..., Any], float]:
    """Growth as a power of k, (function of k, the power), at a wavenumber far below k.

    It is that of the law where growth is of its order, else that of the mode there.
    """
    solver, start = branch.solver, branch.start
    k = min(_VANISHING, k / _DECADE**3)
    limit, ahead = (complex(law[0]) for law in law_ahead(solver.flow, np.array([k])))
    if abs(limit.real) > _SHARE * abs(limit) and shipped(type(solver.flow)):
        growth, power = limit.real, log(ahead.real / limit.real) / AHEAD
    else:
        mode = solver.solve(k, limit / solver.width(k), (start.degree, start.x, start.y))
        growth, power = mode.growth_rate, k * mode.slope.real / mode.growth_rate if mode.growth_rate else 0.0
        if abs(mode.sigma / limit - 1) > _AGREEMENT:
            power = 0.0
    if not _POWERS[0] < power < _POWERS[1]:
        raise ModeLost(f"{solver.flow}: growth follows no power of k at k = {k:.1e}")
    return lambda other: growth * (other / k) ** power, power


def _last_regime(flow: "Flow", low: float) -> float:
    """The largest wavenumber low / 10^j below which the long-wave law keeps its powers of k."""
    k = low / _DECADE ** np.arange(_DECADES)
    with np.errstate(all="ignore"):
        here, ahead = law_ahead(flow, k)
        powers = np.array([np.log(np.abs(part(ahead) / part(here))) / AHEAD for part in (np.real, np.imag)])
    powers = np.where(np.isfinite(powers), powers, 0.0)
    changed = np.flatnonzero(np.any(np.abs(np.diff(powers, axis=1)) > _REGIME, axis=0))
    return float(k[changed[-1] + 1 if len(changed) else 0])
