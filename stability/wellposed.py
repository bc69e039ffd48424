"""Where a flow's own model fails: ill-posed strips of its layers, and the internal modes that live there.

In a layer whose short waves grow without bound (`stability.rheology`) the spectrum at one k may still
converge: waves across the strip cannot be shorter than it is thick. Its internal modes then grow ever faster with k,
and beyond some k no degree resolves them. The slow surface mode need not notice, but it is not what one would see.
"""

from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import numpy as np

from . import status
from .dense import finite_rates
from .relation import dispersion
from .rheology import condition, ill_posed, short_wave_growth
from .solver import DEGREES as RUNGS
from .solver import Solver
from .spectra import Spectrum
from .threads import one_thread

POINTS = 201
DEGREES = (16, 24, 32, 48, 64)

_CHECK_DEGREE = 16, 96  # least and largest of the look for a faster mode; between them that of the surface mode
_FASTER = 1e-6  # relative excess of growth that counts as faster
_INSIDE = 1e-9  # distance from an edge, in s, at which a limit is taken
_SETTLED = 1e-4  # relative difference of two degrees that counts as converged


@dataclass(frozen=True)
class Strip:
    """An ill-posed part of a layer: from `low` to `high` above the layer's lower edge."""

    layer: str
    low: float
    high: float

    def __str__(self):
        return f"{self.layer} is ill posed between heights {self.low:.4g} and {self.high:.4g} above its lower edge"


@dataclass(frozen=True, eq=False)
class WellPosedness:
    """C and the growth of short waves through the sheared layers of a flow.

    Arrays have shape (points,), layer after layer from below: `layer` name, `height` above its lower
    edge, `C`, `short_waves` = largest lambda / k^2 and `ill` = whether it is positive. `strips` are the
    ill-posed parts.
    """

    flow: Any
    layer: tuple
    height: np.ndarray
    C: np.ndarray
    short_waves: np.ndarray
    ill: np.ndarray
    strips: tuple

    @property
    def ill_posed(self):
        return bool(self.strips)


@dataclass(frozen=True, eq=False)
class Growth:
    """Largest growth rate of all modes at wavenumber k, by degree (degrees,), and that of the surface mode, or None."""

    k: float
    degrees: tuple
    rates: np.ndarray
    surface: float | None

    @property
    def settled(self):
        """Whether the last two degrees agree."""
        return abs(self.rates[-1] - self.rates[-2]) <= _SETTLED * abs(self.rates[-1])


@one_thread
def well_posedness(flow, points=POINTS):
    """Return the `WellPosedness` of a flow, at `points` points of each of its layers.

    >>> from stability import flows
    >>> well_posedness(flows.RollWave(slope_deg=28.0)).ill_posed
    False
    """
    parts, strips = [], []
    for layer in flow.layers(numbers(flow)):
        s = (1 - np.cos(np.pi * np.arange(points) / (points - 1))) / 2
        height = layer.height(s)
        ratio, alpha, eta, rho = _coefficients(layer, s)
        ill = ill_posed(ratio, alpha)
        parts.append((np.full(points, layer.name), height, condition(ratio, alpha),
                      short_wave_growth(eta, ratio, alpha, rho), ill))
        strips += _strips(layer, s, ill)
    names, *arrays = (np.concatenate(column) for column in zip(*parts, strict=True))
    return WellPosedness(flow, tuple(names.tolist()), *arrays, tuple(strips))


def ill_posed_somewhere(flow, points=POINTS):
    """Whether some layer of the flow is ill posed at one of as many heights."""
    s = (1 - np.cos(np.pi * np.arange(points) / (points - 1))) / 2
    coefficients = (_coefficients(layer, s) for layer in flow.layers(numbers(flow)))
    return any(np.any(ill_posed(ratio, alpha)) for ratio, alpha, *_ in coefficients)


@one_thread
def growth_with_degree(flow, k, degrees=DEGREES):
    """Return the `Growth` at each wavenumber: does the spectrum converge, does an internal mode outgrow the surface?"""
    solver = Solver(flow)
    wavenumbers = np.unique(np.asarray(k, dtype=float))
    surface = {}
    if flow.has_surface_mode():
        found = dispersion(flow, wavenumbers, strict=False)
        surface = {mode.k: mode.growth_rate for mode in found.modes}
    return tuple(Growth(value, tuple(degrees), np.array([_leading(solver, value, degree) for degree in degrees]),
                        surface.get(value)) for value in wavenumbers.tolist())


@dataclass(frozen=True)
class Outgrown:
    """From wavenumber `k` on another mode grows faster than the surface mode, by the spectra of two `degrees`.

    It grows at `rate` there, None where the two differ.
    """

    k: float
    rate: float | None
    degrees: tuple
    strips: tuple

    def __str__(self):
        pace = f"({self.rate:.6g})" if self.rate is not None else \
            f"that degrees {' and '.join(map(str, self.degrees))} do not resolve"
        return (f"an internal mode {pace} outgrows the surface mode from k = {self.k:.6g} on: "
                f"{'; '.join(map(str, self.strips))}")


def notes_on(spectra: list[Spectrum]) -> list[str]:
    """What an ill-posed flow does to its spectra: modes that do not converge, internal modes that lead it."""
    flow = spectra[0].flow
    strips = well_posedness(flow).strips
    if not strips:
        return []
    notes = [f"{flow}, k = {one.k:g}: the spectrum does not converge; {'; '.join(map(str, strips))}"
             for one in spectra if not all(status.is_resolved(mode.status) for mode in one.modes)]
    wavenumbers = [one.k for one in spectra]
    faster = outgrown(dispersion(flow, wavenumbers, strict=False)) if flow.has_surface_mode() else None
    return [*notes, f"{flow}: {faster}"] if faster else notes


@one_thread
def outgrown(relation):
    """Where another mode outgrows a surface-mode `DispersionRelation`: an `Outgrown`, or None.

    Well-posed flows are not searched. Assumes that internal modes, once ahead, stay ahead as k rises: the
    wavenumbers of the relation are bisected.
    """
    modes = sorted(relation.modes, key=lambda mode: mode.k)
    strips = well_posedness(relation.flow).strips if modes and relation.mode == "surface" else ()
    if not strips:
        return None
    solver = Solver(relation.flow)
    rates = {}
    below, above = -1, len(modes)
    middle = len(modes) - 1
    while above - below > 1:
        rates[middle] = faster(solver, modes[middle])
        below, above = (middle, above) if rates[middle] is None else (below, middle)
        middle = (below + above) // 2
    if above == len(modes):
        return None
    degrees, (coarse, fine) = zip(*rates[above].items(), strict=True)
    return Outgrown(modes[above].k, fine if abs(fine - coarse) < _SETTLED * abs(fine) else None, degrees, strips)


def faster(solver, mode):
    """Leading growth rates {degree: rate} at two degrees if both exceed that of this mode, else None.

    A degree that does not resolve the mode itself would miss its rivals.
    """
    threshold = mode.growth_rate + _FASTER * abs(mode.sigma) + 10 * mode.error
    rung = RUNGS.index(min(max(mode.degree, _CHECK_DEGREE[0]), _CHECK_DEGREE[1]))
    rates = {}
    for degree in (RUNGS[rung], RUNGS[rung + 2]):
        rates[degree] = _leading(solver, mode.k, degree)
        if rates[degree] <= threshold:
            return None
    return rates


def _leading(solver, k, degree):
    return float(solver.width(k) * finite_rates(solver, degree, solver.symbols(k))[0].real)


def numbers(flow):
    """Stand-ins for the symbols that a flow's layers may use: heights only, which C does not depend on."""
    return SimpleNamespace(k=1.0, rate=0.0, **dict.fromkeys((*flow.functions, *flow.surfaces), 1.0))


def _coefficients(layer, s):
    """beta / eta, alpha, eta and rho at the points s, as arrays; the limit where an edge gives 0/0."""
    with np.errstate(divide="ignore", invalid="ignore"):
        at, inside = (np.array([np.broadcast_to(value, s.shape)
                                for value in (base.beta / base.eta, base.alpha, base.eta, base.rho)], dtype=float)
                      for base in (layer.base(s), layer.base(np.clip(s, _INSIDE, 1 - _INSIDE))))
    return np.where(np.isnan(at), inside, at)


def _strips(layer, s, ill):
    """The ill-posed intervals between points of either kind, their ends bisected."""
    changes = np.flatnonzero(ill[1:] != ill[:-1])
    ends = [_edge(layer, s[i], s[i + 1], ill[i]) for i in changes]
    ends = ([0.0] if ill[0] else []) + ends + ([1.0] if ill[-1] else [])
    heights = layer.height(np.array(ends)) if ends else []
    return [Strip(layer.name, float(low), float(high))
            for low, high in zip(heights[::2], heights[1::2], strict=True)]


def _edge(layer, low, high, ill_below):
    for _ in range(60):
        middle = (low + high) / 2
        ratio, alpha, _, _ = _coefficients(layer, np.array([middle]))
        low, high = (middle, high) if ill_posed(ratio, alpha)[0] == ill_below else (low, middle)
    return middle
