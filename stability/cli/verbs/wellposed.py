"""stability wellposed: where a flow's own equations are ill posed, and how its fastest modes grow with k."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ...checks import check_integer
from ...modes.short_waves import WellPosedness, well_posedness
from ...output.panels import LINE, WAVENUMBER, Axis, Band, Curve, Panel
from ...output.record import Record
from ...output.text import Row
from ...status import INTERRUPTED, RESOLVED
from ...studies.wellposed import growth_with_degree
from ..common import add_verb, collect, flow_of, report
from ..specs import parse_spec

_POINTS = "21"
_WAVENUMBERS = "1:100:9"  # of the second panel of the figure


def add(verbs):
    add_verb(verbs, "wellposed", _run, "stability wellposed dune --shields 1.05 --mu1 0.7 --k 1,3,10,30,100",
             _k_option, _points_option)


def _k_option(verb):
    verb.add_argument("--k", metavar="SPEC",
                      help="wavenumbers: report the largest growth rate of all modes there, by Chebyshev degree, "
                           "instead of C through the layer")


def _points_option(verb):
    verb.add_argument("--points", default=_POINTS, metavar="N", help=f"points of each layer (default {_POINTS})")


def _run(arguments):
    flow = flow_of(arguments)
    count = check_integer(arguments.points, "--points", 2, 100_000)
    wavenumbers = parse_spec(arguments.k, "--k") if arguments.k else None

    def compute():
        layers = well_posedness(flow)
        growth = ()
        if wavenumbers is not None or arguments.plot:
            growth = _growth(arguments, flow, parse_spec(_WAVENUMBERS, "") if wavenumbers is None else wavenumbers)
        rows = _layer_rows(well_posedness(flow, count)) if wavenumbers is None else \
            _growth_rows(growth, sorted(set(wavenumbers.tolist())))
        return _Answer(flow, layers, growth, tuple(rows))

    return report(arguments, compute)


@dataclass(frozen=True, repr=False)
class _Answer(Record):
    """The rows that are asked for, and all that the figure shows."""

    flow: Any
    layers: WellPosedness
    growth: tuple
    table: tuple[Row, ...]

    @property
    def dimension(self):
        return "k" if "k" in self.table[0] else "point"

    def rows(self):
        return list(self.table)

    def panels(self):
        return _layers_panel(self.layers), _growth_panel(self.growth)

    def notes(self):
        return [f"{self.flow}: {strip}" for strip in self.layers.strips]


def _layers_panel(found):
    """C through the layers, ill-posed strips tinted."""
    layer = np.array(found.layer)
    curves = [Curve(found.C[layer == name], found.height[layer == name], name) for name in dict.fromkeys(found.layer)]
    curves = [replace(curve, label=None) for curve in curves] if len(curves) == 1 else curves
    return Panel(Axis("C", "$C$, ill posed where $C > 0$"), Axis("height", "height in the layer"), tuple(curves),
                 zero="x", bands=tuple(Band(strip.low, strip.high, "y") for strip in found.strips))


def _growth_panel(growth):
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


def _growth(arguments, flow, wavenumbers):
    growth = (one for k in sorted(set(wavenumbers.tolist())) for one in growth_with_degree(flow, k))
    return tuple(collect(arguments, growth, len(wavenumbers), lambda done: []))


def _layer_rows(found):
    columns = zip(found.layer, found.height.tolist(), found.C.tolist(), found.short_waves.tolist(), found.ill.tolist(),
                  strict=True)
    return [{"layer": layer, "height": height, "C": C, "short_waves": growth, "ill_posed": "yes" if ill else "no",
             "status": RESOLVED} for layer, height, C, growth, ill in columns]


def _growth_rows(growth, wavenumbers):
    rows = [_growth_row(one) for one in growth]
    return rows + [dict.fromkeys(rows[0]) | {"k": k, "status": INTERRUPTED} for k in wavenumbers[len(rows):]]


def _growth_row(growth):
    """Largest growth rates by degree; no number where the last two degrees disagree is called a result."""
    columns = {f"degree_{degree}": float(rate) for degree, rate in zip(growth.degrees, growth.rates, strict=True)}
    status = RESOLVED if growth.settled else f"unresolved: still moves at degree {growth.degrees[-1]}"
    return {"k": growth.k, "surface_mode": growth.surface, **columns, "status": status}
