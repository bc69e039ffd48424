"""One mode as a function of k, the same whoever asks: its nodes, and what is read off between them.

A branch is the mode that a walk visits which leads away from its start by steps of its own. The start and the
steps depend on the flow alone, never on the wavenumbers asked for: those lie between two nodes of the walk, and
are refined from their interpolation. So a wavenumber asked for alone has the mode that it has in any company.
"""

from itertools import pairwise
from math import copysign, log
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import ModeLost
from .foresight import Foresight
from .interpolation import hermite, interpolated, intervals
from .solver import transfer
from .tracking import PACE, Walk

if TYPE_CHECKING:
    from ..numerics.walker import Pace
    from .mode import Mode
    from .solver import Solver

_ROUGH = 1e-4  # tolerance of the walk; what is asked for is refined to full accuracy
_SURE = 0.5  # part of the rounding of one mode that others have as well
_BESIDE = 1 + 1e-9  # factor of a rate where its matrix is not singular, if it is one of a little larger degree
_RISE = 0.9  # of the rise of a degree that is foreseen: what is needed is mostly a little less (measured)
_FEW = 3  # wavenumbers between two nodes that are refined one by one
_DRIFT = 0.01  # largest relative difference of a refined rate from its interpolation
_TINY = np.finfo(float).tiny
_ASTRAY = 0.5  # largest deviation of the overlap with the next node from 1


class Branch:
    """The mode `start` followed to any wavenumber; `solver` refines what is asked for, `rough` walks.

    `lost` maps a side, 1 for rising k and -1 for falling k, to the reason why the walk ended there, `answers` the last
    wavenumbers asked for, if few, to their modes. `seen` are modes that were looked at before the start was found;
    `final` tells that the start is as `solver` has it; `pace` is that of the walks.
    """

    def __init__(self, solver: "Solver", start: "Mode", rough: "Solver | None" = None, seen: Any = (),
                 final: bool = False, pace: "Pace" = PACE) -> None:
        self.solver, self.start, self._seen, self._final = solver, start, seen, final
        self._rough = rough or solver.rough(_ROUGH)
        self._walks = {side: Walk(self._rough, start, solver, pace) for side in (1, -1)}
        self.answers: dict[float, Mode] = {}
        self._rounding = _common_rounding(start) if final else 0.0  # relative, of a mode that was refined
        self.lost = {}

    @property
    def collisions(self) -> tuple[Any, ...]:
        """The collisions met so far, by rising k."""
        return tuple(sorted((one for walk in self._walks.values() for one in walk.collisions), key=lambda one: one.k))

    @property
    def encounters(self) -> tuple[Any, ...]:
        """Where another mode nearly met this one so far, by rising k."""
        return tuple(walk.encounter for walk in self._walks.values() if walk.encounter)[::-1]

    @property
    def uneventful(self) -> bool:
        """Whether no other mode was met and nothing lost so far."""
        return not (self.collisions or self.encounters or self.lost)

    @property
    def segments(self) -> "list[list[Mode]]":
        """Lists of nodes by rising k, without a collision inside."""
        down, up = self._walks[-1].segments, self._walks[1].segments
        whole = [*down[0][:0:-1], *up[0]]
        return [*(part[::-1] for part in down[:0:-1]), whole, *up[1:]]

    @property
    def shortest_step(self) -> float:
        """Of the walks, in log k; first steps count where there is no other, since nothing told their length."""
        steps = [[abs(log(b.k / a.k)) for a, b in pairwise(walk.segments[0])] for walk in self._walks.values()]
        return min((step for taken in steps for step in taken[1:] or taken), default=0.0)

    @property
    def known(self) -> "dict[float, Mode]":
        """{k: mode} of all that was computed on the way, roughly, and of the last answers to few wavenumbers."""
        return {mode.k: mode for part in (self.answers.values(), self._seen, *self.segments) for mode in part}

    def reach(self, k: float) -> bool:
        """Walk until k lies behind; return whether it does."""
        side = self._side(k)
        walk = self._walks[side]
        if side * log(k / walk.now.k) > 0 and side not in self.lost:
            try:
                walk.beyond(k)
            except ModeLost as reason:
                self.lost[side] = reason
        return side * log(k / walk.now.k) <= 0

    def why_lost(self, k: Any) -> Any:
        """Why the walk does not reach k."""
        return str(self.lost[self._side(k)])

    def at(self, wavenumbers: np.ndarray) -> "tuple[dict[float, Mode], dict[Any, Any]]":
        """Return {k: mode} at the wavenumbers reached, and {k: reason} at the others."""
        wavenumbers = np.asarray(wavenumbers, dtype=float).tolist()
        for k in (min(wavenumbers), max(wavenumbers)):
            self.reach(k)
        low, high = self._walks[-1].now.k, self._walks[1].now.k
        reached = [k for k in wavenumbers if low <= k <= high]
        found, lost = {}, {k: self.why_lost(k) for k in wavenumbers if not low <= k <= high}
        if reached:
            self.solver.prepare(np.array(reached))
        for k, mode in self._together(reached).items():
            if isinstance(mode, ModeLost):
                lost[k] = str(mode)
            else:
                found[k] = mode
        if len(found) <= _FEW:
            self.answers = found
        return found, lost

    def _side(self, k: float) -> int:
        return int(copysign(1, log(k / self.start.k)))

    def _between(self, nodes: Any, index: Any, k: Any, known: Any = None) -> Any:
        """The mode at k next to its interpolation, or by a walk from the node before; the reason where it is lost.

        `known` is one near by that is resolved, if there is one: it tells which degree to try.
        """
        near = nodes[index]
        if self._final and near is self.start and k == near.k:
            return near
        try:
            if len(nodes) > 1 and k != near.k:
                rate = hermite(nodes, index, log(k))
                seen = self._rough.foreseen(k, rate, _DRIFT)
                guess = seen or self._interpolated(nodes, index, k, rate)
                degree = None if seen else self._likely_degree(k, nodes[index: index + 2], known)
                mode = self._solved(k, guess.rate, (guess.degree, guess.x, guess.y), degree)
                if mode and _near(mode, near, rate) and abs(self.solver.overlap(near, mode) - 1) < _ASTRAY:
                    return mode
            mode = self._solved(near.k, near.rate, (near.degree, near.x, near.y)) or near
            return mode if k == near.k else Walk(self.solver, mode).to(k)
        except ModeLost as reason:
            return reason

    def _interpolated(self, nodes: "list[Mode]", index: int, k: float, rate: complex) -> Any:
        """A rate with degree and vectors to begin with at k."""
        degree = max(node.degree for node in nodes[index: index + 2])
        _, (x,), (y,) = interpolated(self.solver, nodes, index, np.log([k]), degree)
        return SimpleNamespace(rate=rate, degree=degree, x=x, y=y)

    def _likely_degree(self, k: float, nodes: "list[Mode]", known: "Mode | None") -> int:
        """The degree to try first at k, between nodes."""
        degrees = [self.solver.next_degree(known) if known else self.solver.expected_degree(k)]
        return max([*degrees, *(self.solver.likely_degree(node) for node in nodes)])

    def _solved(self, k: float, rate: complex, vectors: tuple[int, np.ndarray, np.ndarray],
                degree: int | None = None) -> "Mode | None":
        try:
            return self.solver.solve(k, rate, vectors, degree)
        except ModeLost:
            return None

    def _together(self, wavenumbers: list[float]) -> "dict[float, Mode]":
        """Modes at many wavenumbers, next to the interpolation between the nodes of the walk; at a few, one by one."""
        wavenumbers = sorted(wavenumbers)
        places = list(zip(wavenumbers, intervals(self.segments, wavenumbers), strict=True))
        found: dict[float, Any] = self._interpolating(places) if len(places) > _FEW else {}
        last = None
        for k, (nodes, index) in places:
            mode = found[k] = found.get(k) or self._between(nodes, index, k, last)
            last = last if isinstance(mode, ModeLost) else mode
        return found

    def _interpolating(self, places: list[Any]) -> "dict[float, Mode]":
        """{k: mode} of what settles next to the interpolation, at `places` (k, (nodes of the walk, index of the one
        before)), all that take the same degree together."""
        found: dict[float, Any] = {}
        if not self._rounding:
            k, (nodes, index) = places[len(places) // 2]
            mode = found[k] = self._between(nodes, index, k)
            self._rounding = 0.0 if isinstance(mode, ModeLost) else _common_rounding(mode)
        gaps: dict[Any, Any] = {}
        for k, (nodes, index) in places:
            if k not in found and len(nodes) > 1 and k != nodes[index].k:
                gaps.setdefault((id(nodes), index), (nodes, index, []))[-1].append(k)
        batches: dict[int, list[Any]] = {}
        for nodes, index, inside in gaps.values():
            degrees = self._degrees(nodes[index: index + 2], inside)
            for degree in dict.fromkeys(degrees):
                some = [k for k, own in zip(inside, degrees, strict=True) if own == degree]
                batches.setdefault(degree, []).append((nodes, index, some))
        for degree, batch in batches.items():
            found |= self._refined(degree, batch)
        return found

    def _degrees(self, ends: "list[Mode]", inside: list[float]) -> list[int]:
        """The degrees to try between two nodes, as long as what either needs lets expect."""
        needs = [node.degree + _RISE * (self.solver.needed(node, self._rounding) - node.degree) for node in ends]
        needed = np.interp(np.log(inside), np.log([node.k for node in ends]), needs)
        rungs = np.searchsorted(self.solver.degrees, np.maximum(needed, min(node.degree for node in ends)))
        return np.array(self.solver.degrees)[np.minimum(rungs, len(self.solver.degrees) - 1)].tolist()

    def _refined(self, degree: int, batch: list[Any]) -> "dict[float, Mode]":
        """{k: mode} of what settles at this degree, or the one it takes, next to the interpolation; of gaps (nodes of
        the walk, index of one, wavenumbers behind it) where that is the mode of the node before."""
        guesses = [interpolated(self.solver, nodes, index, np.log(inside), degree) for nodes, index, inside in batch]
        rates, *vectors = (np.concatenate(parts) for parts in zip(*guesses, strict=True))
        wavenumbers = [k for *_, inside in batch for k in inside]
        before = [nodes[index] for nodes, index, inside in batch for _ in inside]
        least = min(node.degree for nodes, index, _ in batch for node in nodes[index: index + 2])
        settled, found = self._settled(wavenumbers, rates, vectors, degree, before, least), {}
        for nodes, index, inside in batch:
            first = settled.get(inside[0])
            if first and abs(self.solver.overlap(nodes[index], first) - 1) < _ASTRAY:
                found |= {k: settled[k] for k in inside if k in settled}
        return found

    def _settled(self, wavenumbers: list[float], rates: np.ndarray, vectors: Any, degree: int, nodes: "list[Mode]",
                 known: int) -> "dict[float, Mode]":
        """{k: mode} of what settles near its guess, at this degree or the one it takes, with `nodes` before; the
        vectors have coefficients up to the degree `known`."""
        modes = self.solver.solve_many(wavenumbers, rates, vectors, degree, known)
        near = [one for one in zip(wavenumbers, modes, nodes, rates, strict=True) if one[1] and _near(*one[1:])]
        found, lacking = {}, {}
        for k, mode, node, _ in near:
            if self.solver.fits(mode) or degree == self.solver.degrees[-1]:
                found[k] = mode
            else:
                lacking.setdefault(self.solver.likely_degree(mode), []).append((mode, node))
        for higher, pairs in lacking.items():
            again = [transfer(self.solver, (degree, mode.x, mode.y), higher) for mode, _ in pairs]
            found |= self._settled([mode.k for mode, _ in pairs], np.array([mode.rate * _BESIDE for mode, _ in pairs]),
                                   [np.array(rows) for rows in zip(*again, strict=True)], higher,
                                   [node for _, node in pairs], degree)
        return found


def _common_rounding(mode: "Mode") -> float:
    """What rounding does to other modes on the branch at least, relative to their rates."""
    return _SURE * mode.rounding / max(abs(mode.sigma), _TINY)


def _near(mode: "Mode", node: "Mode", rate: complex) -> bool:
    """Whether a mode is where the interpolation of its rate from `node` and the next one expects it."""
    return abs(mode.rate - rate) < _DRIFT * (abs(rate) + abs(node.rate - rate))


def rough_solver(solver: Any, known: Any = None) -> Any:
    """Return the solver of a walk; `known` are modes of a flow that is nearly the same, {k: mode}."""
    rough = solver.rough(_ROUGH)
    if known:
        rough.foresight = Foresight(rough, known)
    return rough
