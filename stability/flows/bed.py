"""A granular bed sheared from above by a uniform stress, under any friction law: the thesis's dragged plate (2.35).

Shear stress tau and pressure p = 1 - z fix friction, mu(I) = tau/p, and so the shear rate U' = I sqrt(p): lengths in
units of (pressure on the bed)/(its weight per volume), in which p = 1 on the bed, velocities as in the scene. Where
the law has a yield stress, the bed is at rest below p = tau/mu(0); elsewhere it creeps at all depths, and is held by a
rigid floor where the shear rate has fallen to a given fraction of that at the surface. Heights of a bed that yields are
told by zeta, those of a creeping one by ln I.

In zeta = sqrt(p), with e = I mu'(I): beta = mu' zeta, alpha = tau/zeta^2 - e/2, and with the weight g = U' = I zeta

    dg/dzeta = I - 2 tau/(zeta^2 mu').

Times mu' the equation of the shear rate is g v' mu' ~ e v' zeta: regular where the grains come to rest.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.polynomial import chebyshev as C

from ..equations.layer import FIELDS, Layer, Profile
from ..errors import ParameterError
from ..numerics.chebyshev import at_points
from ..numerics.smooth import Rough, fit
from .base import parameter
from .growth import growths, nodes, swaying, turning
from .law import Law

_REST = 1e-8  # inertial number at which friction of a law with a yield stress is to rise linearly
_NODES = 96  # of quadrature over a piece
_PIECES = 3  # of a creeping layer, at least
_SECTIONS, _ROUNDS = 128, 8  # parts of a range of heights one of which has the floor, and how often it is divided
_DEEPEST = 1e6  # zeta of a floor
_LINEAR = 1e-3  # disagreement of its slope there with that at twice the number


@dataclass(frozen=True)
class Sinking:
    """Heights of part of a bed that yields, by how far zeta has fallen from that at its lower edge.

    Friction that has a largest value mu2 sends I to infinity at zeta = a, a^2 = tau/mu2, just above the bed maybe:
    zeta - a falls exponentially, so that the pole becomes an entire function of s.
    """

    depth: float  # zeta at the yield surface less that at the lower edge
    zeta: float  # at the lower edge
    span: float  # of zeta

    def at(self, law: Law, tau: float, s: Any) -> tuple[Any, Any, Any, Any]:
        """zeta, I, -dzeta/ds and mu'(I) at the points s."""
        zeta, inertial, stretch = self._at(law, tau, s)
        return zeta, inertial, stretch, law.slope(inertial)

    def _at(self, law: Law, tau: float, s: Any) -> tuple[Any, Any, Any]:
        top, span = law.range[1], self.span
        if not np.isfinite(top):
            zeta, depth = self.zeta - span * s, self.depth + span * s
            return zeta, law.beyond(self._excess(law, zeta, depth)), span + 0 * s
        pole = np.sqrt(tau / top)
        gap = self.zeta - pole
        rate = np.log1p(-span / gap)
        left = gap * np.exp(rate * s)  # zeta - a
        zeta, depth = pole + left, self.depth - gap * np.expm1(rate * s)
        lack = top * left * (zeta + pole) / zeta**2
        return zeta, law.between(self._excess(law, zeta, depth), lack), -rate * left

    def _excess(self, law: Law, zeta: np.ndarray, depth: np.ndarray) -> np.ndarray:
        """Friction over that at rest."""
        return law.start * depth * (2 * zeta + depth) / zeta**2


@dataclass(frozen=True)
class Creeping:
    """Heights of part of a bed without yield stress, by ln I: nothing but mu(I) and its slope is asked for.

    The shear rate falls by orders of magnitude, evenly so in s, and states of rest lie at infinity.
    """

    low: float  # I at the lower edge
    high: float

    def at(self, law: Law, tau: float, s: Any) -> tuple[Any, Any, Any, Any]:
        """zeta, I, -dzeta/ds and mu'(I) at the points s."""
        fall = np.log(self.high / self.low)
        inertial = np.maximum(self.low * np.exp(fall * s), self.low)
        inertial = np.minimum(inertial, np.nextafter(self.high, 0))  # this side of breaks
        mu = law.mu(inertial)
        zeta, slope = np.sqrt(tau / mu), law.slope(inertial)
        return zeta, inertial, zeta * slope * inertial * fall / (2 * mu), slope


@dataclass(frozen=True)
class Piece:
    """Part of the bed between two heights at which the law is smooth, or a piece of such a part, with its velocity."""

    heights: Sinking | Creeping
    singular: bool  # whether its lower edge is the yield surface
    low: float  # velocity at the lower edge
    series: Any  # of the velocity above it
    phases: tuple[float, float]  # of waves without and with inertia, where grains creep

    def velocity(self, s: Any) -> Any:
        """U at the points s; it rises from the lower edge."""
        many = isinstance(s, np.ndarray) and s.ndim == 1
        above = at_points(s, self.series) if many else C.chebval(2 * s - 1, self.series)
        return self.low + np.maximum(above, 0.0)

    @property
    def top(self) -> float:
        return float(self.velocity(1.0))


@lru_cache(maxsize=512)
def pieces(law: Law, shields: float, creep: float) -> tuple[Piece, ...]:
    """The parts of the bed from below, with their velocities by quadrature to rounding."""
    tau = law.rest * shields
    parts: Any = _yielding(law, tau, shields) if law.yields else _creeping(law, tau, creep)
    found: list[Piece] = []
    for heights, series in zip(parts, _velocities(law, tau, parts), strict=True):
        low = found[-1].top if found else 0.0
        phases = (0.0, 0.0) if law.yields else _phases(law, tau, heights, float(C.chebval(1.0, series)))
        found.append(Piece(heights, law.yields and not found, low, series, phases))
    return tuple(found)


def _phases(law: Law, tau: float, heights: "Creeping", rise: float) -> tuple[float, float]:
    """Of waves without and with inertia, for a density of 1, across a piece where the velocity grows by `rise`."""
    zeta, inertial, stretch, slope = heights.at(law, tau, nodes()[0])
    return (turning(2 * zeta * stretch, tau / zeta**2, inertial, slope),
            swaying(2 * zeta * stretch, 1.0, rise, slope * zeta))


def _yielding(law: Law, tau: float, shields: float) -> "list[Sinking]":
    """The parts of a bed from its yield surface up."""
    bottom = float(np.sqrt(tau / law.start))
    inner = (float(np.sqrt(tau / law.mu(one))) for one in law.breaks if 0 < one < np.inf)
    edges = [bottom, *sorted((zeta for zeta in inner if 1 < zeta < bottom), reverse=True), 1.0]
    found = [Sinking(bottom - low, low, low - high) for low, high in zip(edges, edges[1:], strict=False)]
    exact = (shields - 1) / (np.sqrt(shields) + 1)  # sqrt(shields) - 1 without cancellation
    return found if len(found) > 1 else [Sinking(0.0, bottom, exact)]


def _creeping(law: Any, tau: Any, creep: Any) -> Any:
    """The parts of a bed from where its shear rate, I zeta = I sqrt(tau/mu), is `creep` times that on top."""
    surface = float(law.inverse(tau))

    def slow(number: Any) -> Any:
        return number * np.sqrt(tau / law.mu(number)) < creep * surface

    low, high = np.log(creep * surface / _DEEPEST), np.log(surface)
    if not slow(np.exp(low)):
        raise ParameterError(f"law {law.name}: friction falls too fast as I -> 0 for creep = {creep:g}: the floor "
                             f"lies {_DEEPEST:g} lengths deep; raise creep")
    for _ in range(_ROUNDS):  # down to rounding
        grid = np.linspace(low, high, _SECTIONS + 1)
        last = np.count_nonzero(slow(np.exp(grid[:-1]))) - 1
        low, high = grid[max(last, 0): last + 2]
    bottom = float(np.exp(high))
    edges = [bottom, *sorted(one for one in law.breaks if bottom < one < surface), surface]
    return [Creeping(slow, fast) for slow, fast in pairwise(divided(edges))]


def divided(edges: list[float]) -> list[float]:
    """The inertial numbers between which a creeping layer has its pieces, from those between which its law is smooth.

    Rapid flow, the last of those parts, is divided by even factors into what is left of three pieces: one series over
    all of it would be long. The number of pieces depends on no parameter, so that modes of one flow resemble those of
    the next.
    """
    low, high = edges[-2:]
    count = max(1, _PIECES + 2 - len(edges))
    return [*edges[:-2], *(low * (high / low) ** (number / count) for number in range(count)), high]


def _velocities(law: Law, tau: float, parts: "list[Sinking] | list[Creeping]") -> list[np.ndarray]:
    """T-coefficients of the velocities over those at the lower edges: antiderivatives of the series of I zeta dz/ds."""
    def slopes(s: np.ndarray) -> np.ndarray:
        states = (heights.at(law, tau, s) for heights in parts)
        return np.array([2 * stretch * zeta**2 * inertial + 0 * s for zeta, inertial, stretch, _ in states])

    try:
        found = fit(slopes)
    except Rough as rough:
        raise ParameterError(f"law {law.name}: the shear rate of the bed is not smooth near s = {rough.s:.4g}: "
                             "friction must rise smoothly with I, linearly from rest, and the stress stay clear of its "
                             "largest value") from None
    return [C.chebint(series, lbnd=-1) / 2 for series in found.series]


def profile(law: Law, tau: float, piece: Piece, inertia: float = 1.0) -> Callable[[Any], Profile]:
    """Return the base state of a piece as a function of s."""
    scale = float(piece.heights.at(law, tau, np.array([1.0]))[3][0]) if law.yields else 1.0

    def at(s: np.ndarray) -> Profile:
        zeta, inertial, stretch, slope = piece.heights.at(law, tau, s)
        with np.errstate(divide="ignore", invalid="ignore"):
            shear_rate = inertial * zeta
            dg = stretch * (2 * tau / (zeta**2 * slope) - inertial)
            eta = tau / shear_rate
        return Profile(
            dz=2 * stretch * zeta,
            rho=inertia,
            U=piece.velocity(s),
            dU=shear_rate,
            eta=eta,
            beta=slope * zeta,
            alpha=tau / zeta**2 - inertial * slope / 2,
            g=shear_rate,
            dg=dg,
            clear=slope / scale * zeta**4 if law.yields else 1.0,
        )

    return at


def layers(law: Law, shields: float, creep: float, inertia: float = 1.0) -> tuple[Layer, ...]:
    """The layers of the bed from below; the uppermost is called bed, those below it bed_2, bed_3 ..."""
    tau, parts = law.rest * shields, pieces(law, shields, creep)
    names = [f"bed_{number}" for number in range(len(parts), 1, -1)] + ["bed"]
    grow: Any = [None] * len(parts) if law.yields else growths(
        [len(piece.series) for piece in parts], [piece.phases[0] for piece in parts],
        [np.sqrt(inertia) * piece.phases[1] for piece in parts])
    return tuple(Layer(name, profile(law, tau, piece, inertia), singular=int(piece.singular), growth=growth)
                 for name, piece, growth in zip(names, parts, grow, strict=True))


def below(edges: Any, count: int, yields: bool) -> tuple:
    """Conditions below the top of a bed of `count` pieces: no flow at the yield surface, no slip on a floor.

    All is continuous where the slope of the law jumps: stresses and shear rate of the base flow are.
    """
    parts = [getattr(edges, "bed" if not number else f"bed_{number + 1}") for number in range(count)]
    bottom = parts[-1][0]
    return (*([] if yields else [bottom.v]), bottom.w, *joints(parts[::-1]))


def joints(parts: list) -> list:
    """All fields are continuous from part to part, pairs of edges in the order of s."""
    return [getattr(before[1], name) - getattr(after[0], name)
            for before, after in zip(parts, parts[1:], strict=False) for name in FIELDS]


def creep_parameter(law: type[Law], floor: str = "floor of the bed", surface: str = "interface",
                    what: str = "shear rate") -> dict[str, Any]:
    """The parameter that says where a rigid floor holds grains under a law without yield stress, {} for others."""
    return {} if law.yields else {"creep": parameter(
        1e-6, 1e-9, 0.5, look=(1e-8, 1e-2), reason="the floor must hold the grains, and rounding leaves it no more",
        meaning=f"{what} at the rigid {floor} over that at the {surface}; the law has no yield stress")}


@lru_cache(maxsize=512)
def flux_slopes(law: Law, shields: float, creep: float) -> tuple[float, float]:
    """Return dQ/d(shields) of the flux Q of grains, and dQ/dh, of the height h of the bed over a rigid floor.

    Q is the integral of (p - 1) U' over p, and mu'(I) dI = d(tau/p), so that dQ/d(shields) is the integral of
    (p - 1) rest/(sqrt(p) mu'): what the stress at the yield surface adds vanishes with U'. Over a floor a bed higher
    by h has (p - 1) U' there more.
    """
    tau, total = law.rest * shields, 0.0
    parts = pieces(law, shields, creep)
    nodes, weights = _quadrature()
    for piece in parts:
        zeta, _, stretch, slope = piece.heights.at(law, tau, nodes)
        total += float(weights @ (stretch * (zeta**2 - 1) * law.rest / slope))
    if law.yields:
        return total, 0.0
    zeta, inertial, *_ = parts[0].heights.at(law, tau, 0.0)
    return total, float((zeta**2 - 1) * inertial * zeta)


@lru_cache(maxsize=1)
def _quadrature() -> tuple[np.ndarray, np.ndarray]:
    """Points in 0 < s < 1, and twice the weights of an integral over s."""
    nodes, weights = np.polynomial.legendre.leggauss(_NODES)
    return (1 + nodes) / 2, weights


def lowest(law: Law, shields: float, creep: float) -> float:
    """z of the yield surface, or of the floor."""
    if law.yields:
        return 1 - shields
    return float(1 - pieces(law, shields, creep)[0].heights.at(law, law.rest * shields, 0.0)[0] ** 2)


def check(law: Law, name: str, shields: float) -> None:
    """Raise ParameterError where the bed cannot bear the stress, or its law has no regular yield surface."""
    if not law.rest > 0:
        raise ParameterError(f"{name}: law {law.name} has no yield stress to measure shields by: give it a property "
                             "rest, the friction coefficient that shields = 1 stands for")
    low, high = law.range
    tau = law.rest * shields
    if not low < tau < high:
        raise ParameterError(f"{name}: shields must lie in (1, {high / law.rest:.6g}): friction of law {law.name} "
                             f"cannot exceed {high:g}, no steady flow beyond; give a smaller one (got {shields:g})")
    check_rest(law, name)


def check_rest(law: Law, name: str) -> None:
    """Raise ParameterError where the shear rate has no power series at the yield surface."""
    if not linear_from_rest(law):
        raise ParameterError(f"{name}: law {law.name}: friction must rise linearly with I from rest, or the shear rate "
                             "has no power series at the yield surface; take a law with a slope at I = 0")


@lru_cache(maxsize=256)
def linear_from_rest(law: Law) -> bool:
    """Whether friction rises linearly with I from rest, if there is a friction at rest."""
    if not law.yields:
        return True
    slopes = [float(law.slope(one)) for one in (_REST, 2 * _REST)]
    return bool(slopes[0] > 0 and abs(slopes[1] / slopes[0] - 1) < _LINEAR)
