"""The response of a mode to its base flow as a density over the height, S(z): see `modes.response`."""

from typing import Any

import numpy as np
from numpy.polynomial import chebyshev as C
from numpy.polynomial import legendre as L

from ..numerics import chebyshev
from ..output.panels import Axis, Curve, Panel
from .eigenfunction import Eigenfunction
from .response import check_base_flow
from .solver import Solver

_FAINT = 1e-3  # of the largest sensitivity to the base flow: less is not drawn
_WINDOW = 6  # coefficients of an adjoint function among which the largest is taken for their size


def density(mode: Any, z: Any) -> Any:
    """Return S(z), complex and of the shape of z: delta sigma = integral of S delta U dz, delta U' included.

    Raises ParameterError outside the layers, and for flows in which U enters in other ways as well.
    """
    check_base_flow(mode.flow)
    solver = Solver(mode.flow)
    function = Eigenfunction(mode)
    degree = next((degree for degree in solver.degrees if degree >= 2 * mode.degree), solver.degrees[-1])
    mode = solver.solve(mode.k, mode.rate, (mode.degree, mode.x, mode.y), degree, glance=True)
    heights, parts = function.placed(z)
    found = np.zeros(heights.size, complex)
    for index, here, s in parts:
        found[here] = _density(solver, mode, index, s)
    return found.reshape(heights.shape)


def panel(mode: Any) -> Any:
    """Real and imaginary part of S against z, where they matter."""
    curves: list[Curve] = []
    for part in Eigenfunction(mode).profiles():
        S, again = density(mode, part.z), bool(curves)
        matters = np.abs(S) > _FAINT * np.abs(S).max()
        curves += [Curve(values[matters], part.z[matters], None if again else name, of=number if again else None)
                   for number, (name, values) in enumerate((("growth rate", S.real), ("frequency", S.imag)))]
    return Panel(Axis("S", rf"$\delta\sigma/\delta U(z)$ at $k$ = {mode.k:g}"), Axis("z", "height $z$"), tuple(curves),
                 zero="x")


def _density(solver: Solver, mode: Any, index: Any, s: Any) -> Any:
    """S at the points s of a layer: the momentum equations against their adjoint functions, w' = dz v used."""
    pencil, layer = solver.pencil(mode.degree), solver.flow.layers(None)[index]
    base, k, width = layer.profile(s), mode.k, solver.width(mode.k)
    values = chebyshev.at(s, mode.degree)
    v, w = (values @ pencil.field(mode.x, f"{layer.name}.{field}") for field in ("v", "w"))
    along, across = (_adjoint(pencil.adjoint(mode.y, f"{layer.name}: momentum {row}")) for row in ("along", "across"))
    x = 2 * s - 1
    slope = 2 * L.legval(x, L.legder(along)).conj() / base.dz
    return -1j * k * width * base.rho * (2 * v * L.legval(x, along).conj() + width * w * L.legval(x, across).conj()
                                         + w * slope)


def _adjoint(y: Any) -> Any:
    """Legendre coefficients of the function f with y^H r = integral of conj(f) r ds for the T-coefficients r.

    The last of them are not those of f: they go with rows that no smooth residual feels. They grow from where those of
    f have fallen to.
    """
    count = len(y)
    nodes, weights = L.leggauss(count)
    norms = 2 * np.arange(count) + 1  # of integrals over s of squares: 1 / norm
    change = (L.legvander(nodes, count - 1) * norms).T @ (weights[:, None] / 2 * C.chebvander(nodes, count - 1))
    series = norms * np.linalg.solve(change.T, y)
    size = np.lib.stride_tricks.sliding_window_view(np.abs(series), _WINDOW).max(axis=1)
    return series[: int(np.argmin(size)) + _WINDOW // 2]
