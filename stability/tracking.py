"""Following one mode along k: predictor, corrector, and the refusal to jump to another mode.

The predictor extrapolates the rate (cubic, from values and slopes at two points) and the vectors
(linear) in log k. A step is accepted when the new and old eigenvectors are biorthogonal partners,
y_old^H B x_new * y_new^H B x_old near 1 (between different modes the product vanishes), and when the rates
and slopes at its two ends fit one smooth curve.
"""

from contextlib import suppress
from dataclasses import dataclass
from math import copysign, exp, log

import numpy as np

from .errors import ModeLost, StepsExhausted
from .solver import transfer

_FIRST_STEP = 0.3  # in log k
_LARGEST_STEP = 0.6
_SMALLEST_STEP = 1e-8
_PREDICTION = 0.05  # relative error of the predictor at which the step length is kept
_BEND = 0.1  # largest departure of a step from the mean of its end slopes, relative
_OVERLAP = 0.4  # largest deviation of the overlap from 1
_STEPS, _STRETCH = 1000, 100  # attempts, and after how many of them it is asked whether those left can suffice
_BLIND = 100  # attempts in a row that the largest degree does not resolve
_TRUST = 0.01  # largest relative error of a mode from which a walk goes on
_GRID = 0.05  # spacing in log k of the wavenumbers that a survey lands on
_FEW = 3  # wavenumbers that are walked to one by one
_MANY = 8  # wavenumbers between two nodes that are refined one by one
_STRIDE = 2.0  # of n more than these every _STRIDE sqrt(n)-th becomes a node first
_DRIFT = 0.05  # largest relative difference of a refined rate from its interpolation
_TRIES, _LIKELY = 16, 4  # wavenumbers at which the long-wave limit is sought, and those that mostly suffice
_AGREEMENT = 0.03  # of the surface mode with its long-wave limit, in value and in slope


@dataclass(frozen=True)
class Collision:
    """Two real modes meeting at k (growth rates equal there), or a pair splitting into two."""

    k: float
    sigma: float
    becomes: str  # "pair" or "real"

    def __str__(self):
        outcome = "a complex pair (the one travelling downstream is followed)" if self.becomes == "pair" else \
            "two real modes (the less damped one is followed)"
        return f"two modes collide at k = {self.k:.6g}, sigma = {self.sigma:.6g}, and become {outcome}"


@dataclass(frozen=True)
class Path:
    """Modes at the wavenumbers asked for, in that order, and the collisions met on the way.

    `lost` says why the mode could not be followed, if it could not; the modes then end before it.
    """

    modes: tuple
    collisions: tuple
    lost: ModeLost | None = None


def surface_mode(solver, k):
    """Return the slow surface mode at a small wavenumber <= k, where it obeys its long-wave limit.

    Value and logarithmic slope must both agree: another mode can meet one of them by chance.
    """
    tried = k / 5.0 ** np.arange(_TRIES)
    limits, ahead = np.split(solver.flow.long_wave(np.concatenate((tried, 1.01 * tried))), 2)
    exponents = np.log(ahead / limits) / log(1.01)
    solver.prepare(tried[:_LIKELY])
    for k, limit, exponent in zip(tried.tolist(), limits, exponents, strict=True):
        def agrees(mode, limit=limit, exponent=exponent):
            return abs(mode.sigma / limit - 1) < _AGREEMENT \
                and abs(mode.k * mode.slope / mode.sigma - exponent) < _AGREEMENT

        with suppress(ModeLost):
            mode = solver.solve(k, limit / solver.width(k), glance=True)
            if agrees(mode):
                mode = solver.solve(k, mode.rate, (mode.degree, mode.x, mode.y))
                if agrees(mode):
                    return mode
    raise ModeLost(f"{solver.flow}: no mode obeys the long-wave limit down to k = {k:.1e}")


def follow(solver, start, wavenumbers):
    """Follow the mode `start` through `wavenumbers`, a monotone sequence leading away from start.k.

    A walk sets its own steps; the wavenumbers asked for are then interpolated between them and refined
    all at once. The few that do not settle at once are reached by a walk of their own.
    """
    wavenumbers = np.asarray(wavenumbers, dtype=float)
    walk = _Walk(solver, start)
    try:
        if len(wavenumbers) <= _FEW:
            modes = [walk.to(k) for k in wavenumbers.tolist()]
        else:
            walk.grid = np.sort(wavenumbers)
            walk.to(float(wavenumbers[-1]))
            modes = _between(solver, walk.segments, wavenumbers)
        return Path(tuple(modes), tuple(walk.collisions))
    except ModeLost as reason:
        reached = wavenumbers[np.abs(np.log(wavenumbers / start.k)) <= abs(log(walk.now.k / start.k))]
        return Path(tuple(_between(solver, walk.segments, reached)), tuple(walk.collisions), reason)


def _between(solver, segments, wavenumbers):
    """Modes at `wavenumbers`, within the walk that visited `segments` (lists of modes without a collision).

    Where many are asked for between two nodes, a few of them become nodes first; the others then share
    factorisations.
    """
    found, gaps = {}, {}
    for k, (nodes, index) in zip(wavenumbers.tolist(), _intervals(segments, wavenumbers), strict=True):
        exact = [node for node in nodes[index: index + 2] if node.k == k]
        if exact or len(nodes) == 1:
            found[k] = exact[0] if exact else _Walk(solver, nodes[0]).to(k)
        else:
            gaps.setdefault((id(nodes), index), (nodes, index, []))[2].append(k)
    first, second = [], []
    for nodes, index, inside in gaps.values():
        coarse = inside if len(inside) <= _MANY else inside[:: int(_STRIDE * len(inside) ** 0.5)]
        first += [(nodes, index, [k]) for k in coarse]
    found |= _refined(solver, first)
    for nodes, _, inside in gaps.values():
        finer = sorted([*nodes, *(found[k] for k in inside if k in found)], key=lambda node: node.k)
        missing, rest = [k for k in inside if k not in found], {}
        for k, (_, place) in zip(missing, _intervals([finer], missing), strict=True):
            rest.setdefault(place, []).append(k)
        second += [(finer, place, ks) for place, ks in rest.items()]
    found |= _refined(solver, second)
    return [found[k] for k in wavenumbers.tolist()]


def _refined(solver, groups):
    """{k: mode} for groups (nodes, index, wavenumbers between nodes index and index + 1), refined together.

    Each group shares a factorisation; what does not settle next to its interpolation is walked to.
    """
    batches, found = {}, {}
    for nodes, index, inside in groups:
        batches.setdefault(max(nodes[index].degree, nodes[index + 1].degree), []).append((nodes, index, inside))
    for degree, batch in batches.items():
        guesses = [_interpolate(solver, nodes, index, np.log(inside), degree) for nodes, index, inside in batch]
        modes = iter(solver.solve_many([inside for *_, inside in batch], guesses, degree))
        for (nodes, index, inside), (rates, *_) in zip(batch, guesses, strict=True):
            for k, rate, mode in zip(inside, rates, modes, strict=False):
                near = mode is not None and abs(mode.rate - rate) < _DRIFT * (abs(rate) + abs(nodes[index].rate - rate))
                found[k] = mode if near else _Walk(solver, nodes[index]).to(k)
    return found


def _intervals(segments, wavenumbers):
    """For each wavenumber the segment that contains it, or the one that ends nearest to it, and the node before it."""
    logs, t = [np.log([node.k for node in nodes]) for nodes in segments], np.log(wavenumbers)
    outside = np.array([np.maximum(np.maximum(ends.min() - t, t - ends.max()), 0) for ends in logs])
    places = []
    for at, which, far in zip(t, outside.argmin(axis=0).tolist(), outside.min(axis=0), strict=True):
        nodes, ends = segments[which], logs[which]
        if far:
            places.append(([min(nodes[0], nodes[-1], key=lambda node, at=at: abs(log(node.k) - at))], 0))
            continue
        side = 1 if ends[-1] >= ends[0] else -1
        index = int(np.searchsorted(side * ends, side * at, side="right")) - 1
        places.append((nodes, min(max(index, 0), max(len(nodes) - 2, 0))))
    return places


def _interpolate(solver, nodes, index, t, degree):
    """Rates (cubic, values and slopes of two nodes) and vectors (cubic, four nodes) at log k = t (points,)."""
    here, there = nodes[index], nodes[index + 1]
    h = log(there.k / here.k)
    u = (t - log(here.k)) / h
    rise = there.rate - here.rate
    a, b = h * here.k * here.rate_slope - rise, rise - h * there.k * there.rate_slope
    rates = here.rate + u * rise + u * (1 - u) * (a * (1 - u) + b * u)
    first = min(max(index - 1, 0), max(len(nodes) - 4, 0))
    used = nodes[first: first + 4]
    times = np.array([log(node.k) for node in used])
    weights = np.array([np.prod([(t - times[j]) / (times[i] - times[j]) for j in range(len(used)) if j != i], axis=0)
                        for i in range(len(used))])
    vectors = [transfer(solver, (node.degree, node.x, node.y), degree) for node in used]
    return rates, *(_blend(weights, rows, index - first) for rows in zip(*vectors, strict=True))


def _blend(weights, vectors, reference):
    """Weighted sums (points, size) of eigenvectors, each first given the scale of the one at `reference`."""
    base = vectors[reference]
    size = np.vdot(base, base)
    return weights.T @ np.array([size / np.vdot(base, vector) * vector for vector in vectors])


def survey(solver, start, end, step):
    """Yield the modes that a walk from `start` to wavenumber `end` visits, at most `step` apart in log k."""
    walk = _Walk(solver, start, step)
    walk.grid = np.geomspace(start.k, end, max(2, int(abs(log(end / start.k)) / _GRID)))
    solver.prepare(walk.grid)
    for _ in walk.steps(end):
        yield walk.now


class _Walk:
    """The state of a walk along k: the last two modes, the step in log k, the collisions so far."""

    def __init__(self, solver, start, largest=_LARGEST_STEP):
        self.solver = solver
        self.before, self.now = None, start
        self.step, self.largest = min(_FIRST_STEP, largest), largest
        self.collisions = []
        self.segments = [[start]]
        self.grid = None  # rising wavenumbers to land on, where functions of k are known beforehand

    def to(self, k):
        for _ in self.steps(k):
            pass
        return self.now

    def steps(self, k):
        """Step to wavenumber k, pausing after every attempt that moved."""
        behind, blind = self.now.k, 0
        for attempt in range(_STEPS):
            gap, last = log(k / self.now.k), self.now
            if gap == 0:
                return
            if attempt and attempt % _STRETCH == 0:
                if abs(log(last.k / behind)) * (_STEPS - attempt) < abs(gap) * _STRETCH:
                    break
                behind = last.k
            blind = 0 if self.solver.resolves(last) else blind + 1
            if blind > _BLIND:
                raise self._lost(f"degree {last.degree} does not resolve it any more", StepsExhausted)
            self._advance(k if abs(gap) <= self.step else self._land(self.now.k * exp(copysign(self.step, gap))))
            if self.now is not last:
                yield
        raise self._lost(f"{_STEPS} steps do not reach k = {k:g}", StepsExhausted)

    def _land(self, k):
        """The last grid point before k, if that is not much nearer, else k."""
        if self.grid is None:
            return k
        before = float(self.grid[max(np.searchsorted(self.grid, k) - 1, 0)])
        return before if (self.now.k * k) ** 0.5 < before < k else k

    def _advance(self, k):
        """Take one step to k, or shorten the step, or cross a collision."""
        length = abs(log(k / self.now.k))
        rate, vectors = self._predict(k)
        try:
            mode = self.solver.solve(k, rate, vectors, self.solver.next_degree(self.now))
            fits = self._trusted(mode) and self._same_kind(mode) and self._smooth(mode)
            deviation = abs(self.solver.overlap(self.now, mode) - 1) if fits else np.inf
        except ModeLost:
            deviation = np.inf
        if deviation < _OVERLAP:
            self._accept(mode)
            miss = abs(mode.rate - rate) / (abs(mode.rate) + abs(mode.k * mode.rate_slope)) + 1e-12
            factor = min(2.0, max(0.5, (_PREDICTION / miss) ** 0.25))
            self.step = min(self.largest, max(length, self.step if length < self.step else 0) * factor)
            return
        self.step = length / 3
        if self.step < 0.02 and self._cross(k):
            return
        if self.step < _SMALLEST_STEP:
            raise self._lost(f"no mode overlaps its neighbour at k = {k:.6g}")

    def _trusted(self, mode):
        """Whether the mode is resolved well enough to be followed, if not to the tolerance."""
        return mode.error <= max(_TRUST, self.solver.tolerance) * abs(mode.sigma)

    def _smooth(self, mode):
        """Whether the rates and slopes at both ends of the step belong to one smooth curve in log k."""
        h, rise = log(mode.k / self.now.k), mode.rate - self.now.rate
        a, b = (h * end.k * end.rate_slope for end in (self.now, mode))
        return abs(rise - (a + b) / 2) <= _BEND * (abs(rise) + abs(a) + abs(b)) + 1e-9 * abs(mode.rate)

    def _same_kind(self, mode):
        """Real stays real and complex stays complex, unless a collision has been found."""
        real = abs(mode.rate.imag) < 1e-10 * abs(mode.rate)
        return not self.solver.pencil(mode.degree).real or real == (self.now.rate.imag == 0)

    def _accept(self, mode):
        self.before, self.now = self.now, mode
        self.segments[-1].append(mode)

    def _lost(self, why, kind=ModeLost):
        return kind(f"{self.solver.flow}: the mode is lost at k = {self.now.k:.6g}, "
                    f"sigma = {self.now.sigma:.6g}: {why}")

    def _predict(self, k):
        """Extrapolate rate and vectors to k from the last two modes."""
        now, before = self.now, self.before
        t = log(k / now.k)
        slope = now.k * now.rate_slope
        vectors = (now.degree, now.x, now.y)
        if before is None:
            return now.rate + slope * t, vectors
        h = log(now.k / before.k)
        secant = (now.rate - before.rate) / h
        bend = (slope - secant) / h
        twist = (slope + before.k * before.rate_slope - 2 * secant) / h**2
        rate = now.rate + t * (slope + t * (bend + twist * (t + h)))
        x, y = transfer(self.solver, (before.degree, before.x, before.y), now.degree)
        return rate, (now.degree, _extrapolate(now.x, x, t / h), _extrapolate(now.y, y, t / h))

    def _cross(self, k):
        """Step across a collision of two real modes (or of a conjugate pair) just ahead; True if there is one.

        Near it rate = m(k) +- sqrt(q(k)) with m and q smooth and q = 0 at the collision.
        """
        now, before = self.now, self.before
        if before is None or not self.solver.pencil(now.degree).real:
            return False
        slope = now.rate_slope
        if now.rate.imag == 0:
            ahead = _zero(before.k, before.rate_slope.real**-2, now.k, slope.real**-2)
            middle = now.rate.real + 2 * (ahead - now.k) * slope.real
            half = -1j * abs(now.rate.real - middle)
        else:
            ahead = now.k - now.rate.imag / (2 * slope.imag)
            middle = now.rate.real + (ahead - now.k) * slope.real
            half = abs(now.rate.imag)
        reach = (k - now.k) / (ahead - now.k)
        if not 1 < reach < 1e6:
            return False
        distance = min(abs(k - ahead), max(abs(ahead - now.k), 1e-4 * ahead))
        beyond = ahead + copysign(distance, k - ahead)
        guess = middle + half * (distance / abs(ahead - now.k)) ** 0.5
        try:
            mode = self.solver.solve(beyond, guess, (now.degree, now.x, now.y))
        except ModeLost:
            return False
        if abs(mode.rate - guess) > 0.5 * abs(guess - middle):
            return False
        self.collisions.append(self._pin(now if now.rate.imag else mode, "real" if now.rate.imag else "pair"))
        self.before, self.now = None, mode
        self.segments.append([mode])
        self.step = abs(log(beyond / now.k))
        return True


    def _pin(self, pair, becomes):
        """Place the collision by Newton on Im(rate)^2 = 0, from the complex side, ever nearer to it."""
        for nearness in (1e-3, 1e-5):
            k = pair.k - pair.rate.imag / (2 * pair.rate_slope.imag)
            near = k + copysign(nearness * k, pair.k - k)
            if abs(near - k) < abs(pair.k - k):
                shrink = ((near - k) / (pair.k - k)) ** 0.5
                middle = pair.rate.real + (k - pair.k) * pair.rate_slope.real
                pair = self.solver.solve(near, complex(middle, shrink * pair.rate.imag), (pair.degree, pair.x, pair.y))
        k = pair.k - pair.rate.imag / (2 * pair.rate_slope.imag)
        rate = pair.rate.real + (k - pair.k) * pair.rate_slope.real
        return Collision(k, float(self.solver.width(k) * rate), becomes)


def _extrapolate(now, before, ratio):
    """Linear extrapolation of vectors, the older one first given the scale of the newer."""
    scale = np.vdot(before, now) / np.vdot(before, before)
    return now + ratio * (now - scale * before)


def _zero(x0, f0, x1, f1):
    """Where the straight line through two points vanishes."""
    return x1 - f1 * (x1 - x0) / (f1 - f0) if f1 != f0 else np.inf
