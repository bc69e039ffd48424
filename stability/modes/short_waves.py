"""Whether the equations of a flow are well posed: C and the growth of short waves through its layers.

In a layer whose short waves grow without bound (`flows.rheology`) the model itself fails.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from ..equations.layer import numbers
from ..flows.base import check_flow
from ..flows.rheology import condition, ill_posed, short_wave_growth
from ..numerics.threads import one_thread

if TYPE_CHECKING:
    from ..equations.layer import Layer
    from ..flows.base import Flow

LOOKED_AT = 201  # heights of a layer at which C is looked at

_INSIDE = 1e-9  # distance from an edge, in s, at which a limit is taken
_PARTS, _CUTS = 64, 9  # 64^9 = 2^54 parts of an interval: as many as double precision tells apart
_REMEMBERED = 64  # flows, of which it is known whether they are ill posed


@dataclass(frozen=True)
class Strip:
    """An ill-posed part of a layer: from `low` to `high` above the layer's lower edge."""

    layer: str
    low: float
    high: float

    def __str__(self) -> str:
        return f"{self.layer} is ill posed between heights {self.low:.4g} and {self.high:.4g} above its lower edge"


@dataclass(frozen=True, eq=False)
class WellPosedness:
    """C and the growth of short waves through the sheared layers of a flow.

    Arrays have shape (points,), layer after layer from below: `layer` name, `height` above its lower
    edge, `C`, `short_waves` = largest lambda / k^2 and `ill` = whether it is positive. `strips` are the
    ill-posed parts.

    `flow` is what was asked about. Units: `height` L, `C` a number, `short_waves` V L. Raises nothing.

    >>> from stability import flows
    >>> found = well_posedness(flows.RollWave(slope_deg=32.6), 3)
    >>> found.ill_posed, found.C.shape, len(found.strips)
    (True, (3,), 1)
    """

    flow: Any
    layer: tuple
    height: np.ndarray
    C: np.ndarray
    short_waves: np.ndarray
    ill: np.ndarray
    strips: tuple

    @property
    def ill_posed(self) -> Any:
        """Whether short waves grow without bound anywhere."""
        return bool(self.strips)


@one_thread
def well_posedness(flow: "Flow", points: int = LOOKED_AT) -> "WellPosedness":
    """Return the `WellPosedness` of a flow, at `points` points of each of its layers.

    >>> from stability import flows
    >>> well_posedness(flows.RollWave(slope_deg=28.0)).ill_posed
    False

    In the scales of the flow: heights in L, the growth of short waves over k^2 in V L. Raises ParameterError for what
    is no flow.
    """
    parts, strips = [], []
    s = _points(points)
    for layer in check_flow(flow).layers(numbers(flow)):
        height = layer.height(s)
        ratio, alpha, eta, rho = _coefficients(layer, s)
        ill = ill_posed(ratio, alpha)
        parts.append((np.full(points, layer.name), height, condition(ratio, alpha),
                      short_wave_growth(eta, ratio, alpha, rho), ill))
        strips += _strips(layer, s, ill)
    names, heights, conditions, growths, ills = (np.concatenate(column) for column in zip(*parts, strict=True))
    return WellPosedness(flow, tuple(names.tolist()), heights, conditions, growths, ills, tuple(strips))


def ill_posed_strips(flow: Any, points: Any = LOOKED_AT) -> Any:
    """Return the ill-posed `Strip`s of a flow, as far as they show at as many heights of each layer."""
    return tuple(strip for layer, ill in _looked_at(flow, points) if ill.any()
                 for strip in _strips(layer, _points(points), ill))


def ill_posed_somewhere(flow: "Flow", points: int = LOOKED_AT) -> bool:
    """Whether some layer of the flow is ill posed at one of as many heights."""
    try:
        hash(flow)
    except TypeError:
        return _somewhere(flow, points)
    return _remembered(flow, points)


def _somewhere(flow: "Flow", points: int) -> bool:
    return any(ill.any() for _, ill in _looked_at(flow, points))


_remembered = lru_cache(maxsize=_REMEMBERED)(_somewhere)


@lru_cache(maxsize=8)
def _points(count: int) -> np.ndarray:
    """Points (count,) of a layer from edge to edge, dense near the edges."""
    return (1 - np.cos(np.pi * np.arange(count) / (count - 1))) / 2


def _looked_at(flow: "Flow", points: int) -> Iterator[Any]:
    """Each layer, and where it is ill posed (points,)."""
    for layer in flow.layers(numbers(flow)):
        ratio, alpha, *_ = _coefficients(layer, _points(points))
        yield layer, ill_posed(ratio, alpha)


def _coefficients(layer: "Layer", s: np.ndarray) -> np.ndarray:
    """beta / eta, alpha, eta and rho at the points s, as arrays; the limit where an edge gives 0/0."""
    at = _given(layer, s)
    limitless = np.isnan(at)
    return np.where(limitless, _given(layer, np.clip(s, _INSIDE, 1 - _INSIDE)), at) if limitless.any() else at


def _given(layer: "Layer", s: np.ndarray) -> np.ndarray:
    values = np.empty((4, len(s)))
    with np.errstate(divide="ignore", invalid="ignore"):
        base = layer.base(s)
        for row, value in zip(values, (np.divide(base.beta, base.eta), base.alpha, base.eta, base.rho), strict=True):
            row[:] = value
    return values


def _strips(layer: "Layer", s: np.ndarray, ill: np.ndarray) -> list[Any]:
    """The ill-posed intervals between points of either kind, their ends bisected."""
    changes = np.flatnonzero(ill[1:] != ill[:-1])
    ends = [_edge(layer, s[i], s[i + 1], ill[i]) for i in changes]
    ends = ([0.0] if ill[0] else []) + ends + ([1.0] if ill[-1] else [])
    heights = layer.height(np.array(ends)) if ends else []
    return [Strip(layer.name, float(low), float(high))
            for low, high in zip(heights[::2], heights[1::2], strict=True)]


def _edge(layer: "Layer", low: float, high: float, ill_below: bool) -> float:
    """Where a layer changes its kind between two points: the interval is cut into parts until rounding."""
    for _ in range(_CUTS):
        s = np.linspace(low, high, _PARTS + 1)
        ratio, alpha, *_ = _coefficients(layer, s)
        other = int(np.argmax(ill_posed(ratio, alpha)[1:] != ill_below)) + 1
        low, high = s[other - 1], s[other]
    return (low + high) / 2
