"""Following one mode along k: predictor, corrector, and the refusal to jump to another mode.

The predictor extrapolates the rate (cubic, from values and slopes at two points) and the vectors
(linear) in log k. A step is accepted when the new and old eigenvectors are biorthogonal partners,
y_old^H B x_new * y_new^H B x_old near 1 (between different modes the product vanishes), and when the rates
and slopes at its two ends fit one smooth curve. The next one is as long as the errors of the predicted rate and the
turn of the vectors let expect that it is accepted.
"""

from dataclasses import dataclass
from math import ceil, copysign, exp, floor, log, log2, log10
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import ModeLost
from ..numerics.walker import Pace, Walker, towards
from .solver import transfer

if TYPE_CHECKING:
    from .mode import Mode
    from .solver import Solver

_RUNGS = 4, 48  # per decade, of the ladders that a walk without an end lands on: on the first one by its largest steps
_ON = 1e-6  # distance from a rung, in those between two, that is none
_LARGEST_STEP = log(10) / _RUNGS[0]  # in log k
_CLOSE = 0.02  # step below which a collision is looked for, and a rough walk goes on with full accuracy
_NARROW = 5e-3  # step that tells of another mode near by
PACE = Pace(0.3, _LARGEST_STEP, 1e-8)
_PREDICTION = 0.05  # relative error of the predictor at which the step length is kept
_LIKELY = 0.05  # largest relative distance of a mode that is foreseen from where it is expected
_ORDER, _EXACT = 4, 1e-12  # of the error of the predictor in the step; an error too small to divide by
_FLAT = 1e-9  # bend of a step, relative to the rate, that is never refused: rates need not be exact on a rough walk
_REAL = 1e-10  # largest imaginary part, relative, of a rate that is real but for rounding
_FARTHEST, _BEYOND = 1e6, 1e-4  # lengths of the last step within which a collision is crossed; least way behind it
_NEARNESS = 1e-3, 1e-5  # relative distances at which a collision is placed by Newton: its error is their square
_BEND = 0.1  # largest departure of a step from the mean of its end slopes, relative
_OVERLAP, _TURN = 0.4, 0.35  # largest deviation of the overlap from 1, and the one at which the step length is kept
_STEPS, _STRETCH = 1000, 100  # attempts, and after how many of them it is asked whether those left can suffice
_LEAST_WAY = 0.1  # least way in log k in every _STRETCH attempts of a walk that has no end
_BLIND = 100  # attempts in a row that the largest degree does not resolve
_TRUST = 0.01  # largest relative error of a mode from which a walk goes on


@dataclass(frozen=True)
class Collision:
    """Two real modes meeting at k (growth rates equal there), or a pair splitting into two."""

    k: float
    sigma: float
    becomes: str  # "pair" or "real"

    def __str__(self) -> str:
        outcome = "a complex pair (the one travelling downstream is followed)" if self.becomes == "pair" else \
            "two real modes (the less damped one is followed)"
        return f"two modes collide at k = {self.k:.6g}, sigma = {self.sigma:.6g}, and become {outcome}"


@dataclass(frozen=True)
class Encounter:
    """Where two modes nearly meet: steps as short as `step`, in log k, are needed at k to tell which goes on."""

    k: float
    step: float

    def __str__(self) -> str:
        return (f"two modes nearly meet at k = {self.k:.6g}: which of them goes on is told by steps of {self.step:.1g} "
                "relative, and may be the other at slightly different parameters")


class Walk(Walker):
    """The state of a walk along k: the last two modes, the step in log k, the collisions so far.

    `segments` lists the modes visited, a new list after each collision. Where steps get short the walk goes on with
    the solver `closer`, if there is one. The first step, and the largest, are those of `pace`.
    """

    checks = ("trusted", "same_kind", "smooth", "overlaps")

    def __init__(self, solver: "Solver", start: "Mode", closer: "Solver | None" = None, pace: Pace = PACE) -> None:
        super().__init__(pace)
        self.solver, self.closer = solver, closer
        self.before: Mode | None = None
        self.now = start
        self.shortest = self.step, start.k
        self.collisions = []
        self.segments = [[start]]
        self._attempts, self._blind, self._behind, self._turn = 0, 0, start.k, 0.0

    def to(self, k: float) -> "Mode":
        """Step to wavenumber k."""
        attempts, behind = 0, self.now.k
        while gap := log(k / self.now.k):
            if attempts and attempts % _STRETCH == 0:
                if abs(log(self.now.k / behind)) * (_STEPS - attempts) < abs(gap) * _STRETCH:
                    raise self._lost(f"{_STEPS} steps do not reach k = {k:g}")
                behind = self.now.k
            attempts += 1
            self._watch()
            self._advance(towards(self.now.k, k, self.step)[0])
        return self.now

    def beyond(self, k: float) -> None:
        """Step on until wavenumber k lies behind, by the same steps whichever it is."""
        side = copysign(1.0, log(k / self.segments[0][0].k))
        if self.solver.flow.functions and not self.solver.foresight:
            self.solver.prepare(np.array(_likely(self.now.k, k, side * self.step)))
        while side * log(k / self.now.k) > 0:
            if self._attempts and self._attempts % _STRETCH == 0:
                if abs(log(self.now.k / self._behind)) < _LEAST_WAY:
                    raise self._lost(f"{_STRETCH} steps took it from k = {self._behind:.6g} no further")
                self._behind = self.now.k
            self._attempts += 1
            self._watch()
            self._advance(_rung(self.now.k, side * self.step))

    @property
    def encounter(self) -> "Encounter | None":
        """Where the steps were shortest, an `Encounter`, if so short that another mode must have been near."""
        step, k = self.shortest
        collided = any(abs(log(one.k / k)) < _LARGEST_STEP for one in self.collisions)  # that is told as such
        return Encounter(k, step) if step < _NARROW and not collided else None

    def _watch(self) -> None:
        """Give up where the largest degree has not resolved the mode for long."""
        self._blind = 0 if self.solver.resolves(self.now) else self._blind + 1
        if self._blind > _BLIND:
            raise self._lost(f"degree {self.now.degree} does not resolve it any more")

    def _advance(self, k: float) -> None:
        """Take one step to k, or shorten the step, or cross a collision."""
        if self.stride(k, abs(log(k / self.now.k))):
            return
        self.shortest = min(self.shortest, (self.step, self.now.k))
        if self.step < _CLOSE and self.closer:
            self._look_closer()
            return
        if self.step < _CLOSE and self._cross(k):
            return
        if self.stuck:
            raise self._lost(f"no mode overlaps its neighbour at k = {k:.6g}")

    def correct(self, to: float, guess: complex) -> "Mode":
        return self.solver.foreseen(to, guess, _LIKELY) or self.solver.solve(
            to, guess, self._vectors(to), self.solver.next_degree(self.now))

    def factor(self, new: "Mode", guess: complex) -> float:
        miss = abs(new.rate - guess) / (abs(new.rate) + abs(new.k * new.rate_slope)) + _EXACT
        steady = _TURN / (self._turn + _EXACT)  # to be the square of the factor: so goes the overlap with the step
        return min(2.0, max(0.5, (_PREDICTION / miss) ** (1 / _ORDER)), 2 ** (floor(log2(steady)) / 2))

    def accept(self, to: Any, new: Any) -> None:
        self.before, self.now = self.now, new
        self.segments[-1].append(new)

    def _look_closer(self) -> None:
        """Go on from here with full accuracy."""
        self.solver, self.closer = self.closer or self.solver, None
        now = self.solver.solve(self.now.k, self.now.rate, (self.now.degree, self.now.x, self.now.y))
        self.segments[-1][-1] = self.now = now

    def trusted(self, mode: "Mode", guess: complex) -> bool:
        """Whether the mode is resolved well enough to be followed, if not to the tolerance."""
        return mode.error <= max(_TRUST, self.solver.tolerance) * abs(mode.sigma)

    def smooth(self, mode: "Mode", guess: complex) -> bool:
        """Whether the rates and slopes at both ends of the step belong to one smooth curve in log k."""
        h, rise = log(mode.k / self.now.k), mode.rate - self.now.rate
        a, b = (h * end.k * end.rate_slope for end in (self.now, mode))
        return abs(rise - (a + b) / 2) <= _BEND * (abs(rise) + abs(a) + abs(b)) + _FLAT * abs(mode.rate)

    def same_kind(self, mode: "Mode", guess: complex) -> bool:
        """Real stays real and complex stays complex, unless a collision has been found."""
        real = abs(mode.rate.imag) < _REAL * abs(mode.rate)
        return not self.solver.pencil(mode.degree).real or real == (self.now.rate.imag == 0)

    def overlaps(self, mode: "Mode", guess: complex) -> bool:
        """Whether the new and the old eigenvectors are biorthogonal partners."""
        self._turn = abs(self.solver.overlap(self.now, mode) - 1)
        return self._turn < _OVERLAP

    def _lost(self, why: Any) -> Any:
        return ModeLost(f"{self.solver.flow}: the mode is lost at k = {self.now.k:.6g}, "
                        f"sigma = {_told(self.now):.6g}: {why}")

    def foresee(self, k: float) -> complex:
        """Extrapolate the rate to k from the last two modes."""
        now, before = self.now, self.before
        t = log(k / now.k)
        slope = now.k * now.rate_slope
        if before is None:
            return now.rate + slope * t
        h = log(now.k / before.k)
        secant = (now.rate - before.rate) / h
        bend = (slope - secant) / h
        twist = (slope + before.k * before.rate_slope - 2 * secant) / h**2
        return now.rate + t * (slope + t * (bend + twist * (t + h)))

    def _vectors(self, k: float) -> tuple[int, np.ndarray, np.ndarray]:
        """Degree and vectors, extrapolated to k like the rate."""
        now, before = self.now, self.before
        if before is None:
            return now.degree, now.x, now.y
        ratio = log(k / now.k) / log(now.k / before.k)
        x, y = transfer(self.solver, (before.degree, before.x, before.y), now.degree)
        return now.degree, _extrapolate(now.x, x, ratio), _extrapolate(now.y, y, ratio)

    def _cross(self, k: float) -> bool:
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
        if not 1 < reach < _FARTHEST:
            return False
        distance = min(abs(k - ahead), max(abs(ahead - now.k), _BEYOND * ahead))
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

    def _pin(self, pair: Any, becomes: Any) -> Any:
        """Place the collision by Newton on Im(rate)^2 = 0, from the complex side, ever nearer to it."""
        for nearness in _NEARNESS:
            k = pair.k - pair.rate.imag / (2 * pair.rate_slope.imag)
            near = k + copysign(nearness * k, pair.k - k)
            if abs(near - k) < abs(pair.k - k):
                shrink = ((near - k) / (pair.k - k)) ** 0.5
                middle = pair.rate.real + (k - pair.k) * pair.rate_slope.real
                pair = self.solver.solve(near, complex(middle, shrink * pair.rate.imag), (pair.degree, pair.x, pair.y))
        k = pair.k - pair.rate.imag / (2 * pair.rate_slope.imag)
        rate = pair.rate.real + (k - pair.k) * pair.rate_slope.real
        return Collision(k, float(self.solver.width(k) * rate), becomes)


def _rung(k: float, step: float) -> float:
    """The wavenumber a step in log k away, or the last rung of a ladder before it if that is not much nearer."""
    ahead = k * exp(step)
    for rungs in _RUNGS:
        index = log10(ahead) * rungs
        rung = 10 ** ((floor(index + _ON) if step > 0 else ceil(index - _ON)) / rungs)
        if abs(log(rung / k)) > 0.5 * abs(step) and (rung - k) * step > 0:
            return rung
    return ahead


def _told(mode: "Mode") -> complex:
    """Its sigma, parts within the error left out: they are noise."""
    real, imag = (0.0 if abs(part) <= mode.error else part for part in (mode.sigma.real, mode.sigma.imag))
    return complex(real, imag)


def _likely(start: float, end: float, step: float) -> list[float]:
    """The wavenumbers that a walk comes to on its way if every step is as long as it may be."""
    found = []
    while (end - start) * step > 0:
        start = _rung(start, step)
        found.append(start)
        step = copysign(min(2 * abs(step), _LARGEST_STEP), step)
    return found


def _extrapolate(now: np.ndarray, before: np.ndarray, ratio: float) -> np.ndarray:
    """Linear extrapolation of vectors, the older one first given the scale of the newer."""
    scale = np.vdot(before, now) / np.vdot(before, before)
    return now + ratio * (now - scale * before)


def _zero(x0: Any, f0: Any, x1: Any, f1: Any) -> Any:
    """Where the straight line through two points vanishes."""
    return x1 - f1 * (x1 - x0) / (f1 - f0) if f1 != f0 else np.inf
