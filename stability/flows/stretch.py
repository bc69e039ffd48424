"""Where the points of a layer lie: evenly between two edges, or ever farther apart towards infinity.

An unbounded fluid is cut far above and below its sheared part. With z = centre + A sinh(B x) the points lie as in a
bounded layer where the fluid is sheared, A being about half its thickness, and farther apart beyond, where
perturbations fall like exponentials. A cut a thousand times as far away then takes but twice as many points.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import asinh, isfinite
from typing import Any

import numpy as np

from ..errors import ParameterError
from ..numerics.smooth import Rough, fit

_CANDIDATES = 0.7, 1.0, 1.4, 2.0, 2.8, 4.0  # A over the spread of the sheared part
_EDGE = 0.01  # of the change of U at which its sheared part ends
_ROUNDING = 4 * np.finfo(float).eps  # of the change of U, within which it has reached its limit
_DOUBLINGS = 40  # of the height up to which a limit is sought
_AGREEING = 3  # values at the largest heights that must be one
_GRID = 4000  # heights among which the sheared part is sought
REACH = 250.0  # of the cut beyond the sheared part, in half thicknesses, over the square root of their Reynolds number
_VISCOUS = 0.0625  # added to that Reynolds number: the cut is at most a thousand half thicknesses away
LEAST = 25.0  # and at least so many
_USUAL = 200.0  # so many where the shape of the map is chosen, whatever the Reynolds number


@dataclass(frozen=True)
class Stretch:
    """The map z(s) of a layer, 0 <= s <= 1: z = low + (high - low) s, or with A > 0 centre + A sinh(first + rise s)."""

    low: float
    high: float
    centre: float = 0.0
    A: float = 0.0
    first: float = 0.0
    rise: float = 1.0

    def z(self, s: Any) -> Any:
        """Heights of the points s."""
        if not self.A:
            return self.low + (self.high - self.low) * s
        return self.centre + self.A * np.sinh(self.first + self.rise * s)

    def slope(self, s: Any) -> Any:
        """dz/ds."""
        if not self.A:
            return self.high - self.low
        return self.A * self.rise * np.cosh(self.first + self.rise * s)


@dataclass(frozen=True)
class Sheared:
    """Where a fluid of velocity U(z) is sheared: `core` (low, high), to 1 % of its change, and `ends`, to rounding.

    An end that is an edge of the fluid stays there. `middle` is the mean height and `spread` the standard deviation of
    heights weighted by |U'|.
    """

    core: tuple[float, float]
    ends: tuple[float, float]
    change: float
    middle: float
    spread: float


def limit(U: Callable[..., np.ndarray], start: float, side: int, name: str) -> float:
    """Return the value that U reaches far above (side 1) or below (-1) a height; raises ParameterError where none is.

    Values at the last of doubling distances (up to where they are finite) must agree to rounding.
    """
    far = start + side * 2.0 ** np.arange(-2, _DOUBLINGS)
    values = U(far)
    far, values = (array[: _finite(values)] for array in (far, values))
    change = float(np.ptp(values)) if len(values) else 0.0
    scale = max(change, float(np.abs(values).max(initial=0.0)))
    same = np.abs(values - values[-1:]) <= _ROUNDING * scale
    if len(values) >= _AGREEING and same[-_AGREEING:].all():
        return float(values[-1])
    values, far = (np.append(np.full(2, np.nan), array) for array in (values, far))
    edge = "top" if side > 0 else "bottom"
    raise ParameterError(f"{name}: {edge} = decay, but U does not reach a limit there (U = {values[-2]:.6g} and "
                         f"{values[-1]:.6g} at z = {far[-2]:.3g} and {far[-1]:.3g}): give a wall or a free edge")


def _finite(values: Any) -> Any:
    """How many values there are before the first that is not finite."""
    wrong = np.flatnonzero(~np.isfinite(values))
    return int(wrong[0]) if len(wrong) else len(values)


def sheared(U: Callable[..., np.ndarray], low: float, high: float, limits: Sequence[float | None]) -> Sheared:
    """Return where a fluid between two edges (or -inf, inf) is sheared, U having the `limits` at those at infinity."""
    z = _heights(low, high)
    values = U(z)
    change = float(np.ptp(values)) or float(np.abs(values).max()) or 1.0
    core, ends = [low, high], [low, high]
    for side, end in ((0, limits[0]), (1, limits[1])):
        if end is not None:
            away = np.abs(values - end)
            core[side] = _last(z, away > _EDGE * change, side)
            ends[side] = _last(z, away > _ROUNDING * change, side)
    heights, weights = (z[1:] + z[:-1]) / 2, np.abs(np.diff(values))
    weights = np.where((heights > ends[0]) & (heights < ends[1]), weights, 0.0)  # no rounding from far away
    weights = weights / (weights.sum() or 1.0)
    middle = float(weights @ heights)
    spread = float(np.sqrt(weights @ (heights - middle) ** 2))
    middle = round(middle / (spread or 1.0), 6) * (spread or 1.0)  # parity stays exact
    return Sheared((core[0], core[1]), (ends[0], ends[1]), change, middle, spread or 1.0)


def _heights(low: Any, high: Any) -> Any:
    """Heights through the fluid: evenly between edges, at all distances from z = 0 or from an edge without."""
    if isfinite(low) and isfinite(high):
        return np.linspace(low, high, _GRID)
    far = np.sinh(np.linspace(0, 30, _GRID)) * 1e-3
    if isfinite(low) or isfinite(high):
        return low + far if isfinite(low) else (high - far)[::-1]
    return np.concatenate((-far[:0:-1], far))


def _last(z: Any, differs: Any, side: Any) -> Any:
    """The first (side 0) or last (side 1) height at which something differs from its limit."""
    where = np.flatnonzero(differs)
    if not len(where):
        return float(z[0] if side == 0 else z[-1]) if np.isfinite(z[[0, -1]]).all() and len(z) == _GRID else 0.0
    return float(z[max(where[0] - 1, 0)] if side == 0 else z[min(where[-1] + 1, len(z) - 1)])


def stretched(U: Callable[..., np.ndarray], part: Sheared, low: float, high: float, Re: float) -> Stretch:
    """Return the map of a fluid between two edges, cut where one is at infinity.

    The cut lies where U has reached its limit and so far beyond that vorticity falls by 1e-16 on the way and back, with
    vorticity ~ exp(-z sqrt(i k Re (U - c))) for k Re (U - c) down to 1e-2 per half thickness.
    """
    if isfinite(low) and isfinite(high):
        return Stretch(low, high)
    both = not isfinite(low) and not isfinite(high)
    half = (part.core[1] - part.core[0]) / (2 if both else 1) or 1.0
    reach = half * max(LEAST, REACH / (Re * part.change * half + _VISCOUS) ** 0.5)
    centre, A = _best(U, part, low, high, _USUAL * half)
    return _sinh(centre, A, *_cut(part, low, high, reach))


def _cut(part: Any, low: Any, high: Any, reach: Any) -> Any:
    """Both edges of the layer."""
    return low if isfinite(low) else part.ends[0] - reach, high if isfinite(high) else part.ends[1] + reach


def _sinh(centre: Any, A: Any, low: Any, high: Any) -> Any:
    first = asinh((low - centre) / A)
    return Stretch(low, high, centre, A, first, asinh((high - centre) / A) - first)


def _best(U: Any, part: Any, low: Any, high: Any, reach: Any) -> Any:
    """The centre and the A with which the series of U is shortest."""
    edge = low if isfinite(low) else high if isfinite(high) else part.middle
    lengths = {}
    for centre in dict.fromkeys((part.middle, edge)):
        for share in _CANDIDATES:
            way = _sinh(centre, share * part.spread, *_cut(part, low, high, reach))
            try:
                lengths[centre, share * part.spread] = fit(lambda s, way=way: U(way.z(s))[None]).length
            except Rough:
                continue
    return min(lengths, key=lengths.__getitem__, default=(part.middle, part.spread))
