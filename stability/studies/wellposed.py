"""Where a flow's own model fails: ill-posed strips of its layers, and the internal modes that live there.

In a layer whose short waves grow without bound (`flows.rheology`) the spectrum at one k may still
converge: waves across the strip cannot be shorter than it is thick. Its internal modes then grow ever faster with k,
and beyond some k no degree resolves them. The slow surface mode need not notice, but it is not what one would see.
"""

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from ..modes.short_waves import LOOKED_AT, WellPosedness, well_posedness
from ..modes.solver import Solver
from ..numerics.threads import one_thread
from ..output.panels import LINE, WAVENUMBER, Axis, Band, Curve, Panel
from ..output.record import Record
from ..output.text import Row
from ..status import INTERRUPTED, RESOLVED, unresolved
from .dispersion import dispersion
from .outgrown import leading_rate

GROWTH_DEGREES = (16, 24, 32, 48, 64)

_SETTLED = 1e-4  # relative difference of two degrees that counts as converged


@dataclass(frozen=True, eq=False)
class Growth:
    """Largest growth rate of all modes at wavenumber k, by degree (degrees,), and that of the surface mode, or None."""

    k: float
    degrees: tuple
    rates: np.ndarray
    surface: float | None

    @property
    def settled(self) -> bool:
        """Whether the last two degrees agree."""
        return abs(self.rates[-1] - self.rates[-2]) <= _SETTLED * abs(self.rates[-1])


@one_thread
def growth_with_degree(flow: Any, k: Any, degrees: Any = GROWTH_DEGREES) -> Any:
    """Return the `Growth` at each wavenumber: does the spectrum converge, does an internal mode outgrow the surface?"""
    solver = Solver(flow)
    wavenumbers = np.unique(np.asarray(k, dtype=float))
    surface = {}
    if flow.has_surface_mode():
        found = dispersion(flow, wavenumbers, strict=False)
        surface = {mode.k: mode.growth_rate for mode in found.modes}
    return tuple(Growth(value, tuple(degrees), np.array([leading_rate(solver, value, degree) for degree in degrees]),
                        surface.get(value)) for value in wavenumbers.tolist())


@dataclass(frozen=True, repr=False)
class IllPosedness(Record):
    """Where a flow is ill posed, `layers`, and the largest `growth` of all modes; `table` has the rows asked for.

    `flow` is what was asked about. Units are those of the columns. Writing raises ParameterError where a file cannot be
    written.

    >>> from stability import flows
    >>> found = ill_posedness(flows.RollWave(slope_deg=32.6), 3)
    >>> found.dimension, [row["ill_posed"] for row in found]
    ('point', ['yes', 'yes', 'yes'])
    """

    flow: Any
    layers: WellPosedness
    growth: tuple[Growth, ...]
    table: tuple[Row, ...] = field(hash=False)

    @property
    def dimension(self) -> str:
        return "k" if "k" in self.table[0] else "point"

    def rows(self) -> list[Row]:
        return list(self.table)

    def panels(self) -> tuple[Panel, ...]:
        return _layers_panel(self.layers), _growth_panel(self.growth)

    def notes(self) -> list[str]:
        return [f"{self.flow}: {strip}" for strip in self.layers.strips]


def _layers_panel(found: WellPosedness) -> Panel:
    """C through the layers, ill-posed strips tinted."""
    layer = np.array(found.layer)
    curves = [Curve(found.C[layer == name], found.height[layer == name], name) for name in dict.fromkeys(found.layer)]
    curves = [replace(curve, label=None) for curve in curves] if len(curves) == 1 else curves
    return Panel(Axis("C", "$C$, ill posed where $C > 0$"), Axis("height", "height in the layer"), tuple(curves),
                 zero="x", bands=tuple(Band(strip.low, strip.high, "y") for strip in found.strips))


def _growth_panel(growth: "tuple[Growth, ...]") -> Panel:
    """Largest growth rate against k, fainter the lower the degree, and that of the surface mode."""
    k, rates = np.array([one.k for one in growth]), np.array([one.rates for one in growth])
    count = len(growth[0].degrees)
    curves = [Curve(k, rates[:, place], f"degree {degree}", LINE, of=0 if place else None,
                    fade=0.25 + 0.75 * place / (count - 1)) for place, degree in enumerate(growth[0].degrees)]
    surface = np.array([(one.k, one.surface) for one in growth if one.surface is not None]).reshape(-1, 2)
    if len(surface):
        curves.append(Curve(surface[:, 0], surface[:, 1], "surface mode"))
    return Panel(replace(WAVENUMBER, scale="log"),
                 Axis("growth_rate", r"largest growth rate $\sigma_r$", "symlog"), tuple(curves), zero="y")


def ill_posedness(flow: Any, points: int = LOOKED_AT, growth: tuple[Growth, ...] = (),
                  wavenumbers: np.ndarray | None = None) -> IllPosedness:
    """Return the `IllPosedness` of a flow: rows of C at `points` of each layer, or of `growth` at the `wavenumbers`."""
    layers = well_posedness(flow)
    rows = _layer_rows(well_posedness(flow, points)) if wavenumbers is None else \
        _growth_rows(growth, sorted(set(wavenumbers.tolist())))
    return IllPosedness(flow, layers, growth, tuple(rows))


def _layer_rows(found: WellPosedness) -> list[dict[str, Any]]:
    columns = zip(found.layer, found.height.tolist(), found.C.tolist(), found.short_waves.tolist(), found.ill.tolist(),
                  strict=True)
    return [{"layer": layer, "height": height, "C": C, "short_waves": growth, "ill_posed": "yes" if ill else "no",
             "status": RESOLVED} for layer, height, C, growth, ill in columns]


def _growth_rows(growth: "tuple[Growth, ...]", wavenumbers: list[float]) -> list[dict[str, float]]:
    rows = [_growth_row(one) for one in growth]
    return rows + [dict.fromkeys(rows[0]) | {"k": k, "status": INTERRUPTED} for k in wavenumbers[len(rows):]]


def _growth_row(growth: Any) -> Any:
    """Largest growth rates by degree; no number where the last two degrees disagree is called a result."""
    columns = {f"degree_{degree}": float(rate) for degree, rate in zip(growth.degrees, growth.rates, strict=True)}
    status = RESOLVED if growth.settled else unresolved(f"unresolved: still moves at degree {growth.degrees[-1]}")
    return {"k": growth.k, "surface_mode": growth.surface, **columns, "status": status}
