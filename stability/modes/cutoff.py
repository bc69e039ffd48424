"""What it does to a mode that an unbounded fluid is cut.

A condition at a cut lacks what depends on the growth rate in no linear way (`Flow.left_out`). To first order it
changes the rate by y^H times what is left out: that joins the error bar, twice. Modes of the continuous spectrum of the
unbounded fluid do not fall off towards the cut: where it lies makes them discrete, and what is left out is as large as
they are.
"""

from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np

from ..equations.layer import FIELDS
from ..numerics import chebyshev

if TYPE_CHECKING:
    from .solver import Solver

_SAFETY = 2.0
_UNBOUND = 1e-3  # effect of the cut, relative to sigma, from which on a mode that decays is taken for the cut's own


def neglected(solver: "Solver", k: Any, degree: int, eigen: Any) -> Any:
    """Bound of the error of sigma from what the conditions at cuts leave out."""
    pencil, flow = solver.pencil(degree), solver.flow
    names = SimpleNamespace(k=k, rate=complex(eigen.rate))
    sigma, total = solver.width(k) * complex(eigen.rate), 0.0
    edges = SimpleNamespace(**{name: tuple(_edge(pencil, name, end, eigen.x) for end in (0, 1))
                               for name in dict.fromkeys(field.partition(".")[0]
                                                         for field in solver.assembly.system.fields)})
    for index, lacking in flow.left_out(edges, names, k, sigma).items():
        total += abs(eigen.y[pencil.rows["conditions"][index]] * lacking)
    return float(_SAFETY * solver.width(k) * total)


def _edge(pencil: Any, layer: Any, end: Any, x: Any) -> Any:
    """The fields of a mode at an edge of a layer."""
    ends = chebyshev.at(np.array([float(end)]), pencil.degree)[0]
    return SimpleNamespace(**{field: ends @ pencil.field(x, f"{layer}.{field}") for field in FIELDS})


def belongs_to_cut(solver: "Solver", mode: Any) -> Any:
    """Whether a mode decays and would not be there, or elsewhere, without a cut."""
    flow = solver.flow
    if not flow.unbounded or mode.growth_rate >= 0:
        return False
    lacking = neglected(solver, mode.k, mode.degree, mode)
    return not flow.bound(mode.k, mode.sigma) or lacking > _UNBOUND * abs(mode.sigma)
