"""How a mode answers to a small change of its base flow, and so to the errors of a measured one.

U enters the momentum equations through convection i k U and the shear U'. With the left vector y,

    delta sigma = y^H (delta A) x / (y^H B x) = sum_m on_U(s_m) delta U(s_m) + on_dU(s_m) delta U'(s_m)

at Chebyshev points s_m, exactly for what the series hold; or, with U' integrated by parts, as the integral of a
density S(z) delta U(z) dz. Where U is a fit, linear in its data, delta U = sum_j delta c_j phi_j(z) and the covariance
of the c_j gives the standard error of sigma, and of all that follows from it.
"""

from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.polynomial import chebyshev as C

from ..errors import ModeLost, ParameterError
from ..flows.base import check_flow
from ..numerics import chebyshev

if TYPE_CHECKING:
    from .mode import Mode
    from .solver import Solver

_POINTS = 33  # at which it is asked whether a fluid is Newtonian
_STEP = 1e-3  # in log k, of the difference that gives d/dk of a response


@dataclass(frozen=True, eq=False)
class ShearResponse:
    """What multiplies changes of U and of dU/dz at the points s (points,) of a layer in the change of sigma."""

    s: np.ndarray
    on_U: np.ndarray
    on_dU: np.ndarray
    slope: np.ndarray  # dz/ds


def check_base_flow(flow: Any) -> None:
    """Raise a ParameterError where U does not enter the equations through convection alone."""
    check_flow(flow)
    if flow.surfaces:
        raise ParameterError(f"{flow.name}: the sensitivity to the base flow is known for flows between fixed edges; "
                             f"here U enters the conditions at a displaced surface ({', '.join(flow.surfaces)}) too")
    if flow.order:
        raise ParameterError(f"{flow.name}: U does not enter the equations: perturbations across the flow are not "
                             "convected")
    points = chebyshev.points(_POINTS)
    for layer in flow.layers(None):
        base = layer.profile(points)
        if np.any(base.alpha) or np.ptp(base.eta) or np.any(base.eta != base.beta):
            raise ParameterError(f"{flow.name}: layer {layer.name} is no Newtonian fluid: there U' enters the "
                                 "viscosity too, which this sensitivity leaves out")


def shear_response(solver: "Solver", k: Any, degree: int, eigen: Any) -> Any:
    """Return the `Weights` of the one layer of a flow for an eigenvalue at k, with vectors of this degree."""
    pencil, (layer,) = solver.pencil(degree), solver.flow.layers(None)
    count = degree + solver.assembly.system.longest + 8  # products are then summed exactly
    s = chebyshev.points(count)
    base, width = layer.profile(s), solver.width(k)
    v, w = (_values(chebyshev.basis(degree)[0] @ pencil.field(eigen.x, f"{layer.name}.{field}"), count)
            for field in ("v", "w"))
    along, across = (_values(_doubled(pencil.adjoint(eigen.y.conj(), f"{layer.name}: momentum {row}")), count)
                     for row in ("along", "across"))
    scale = 1j * k * width * base.rho * base.dz / count
    return ShearResponse(s, -scale * (along * v + width * across * w), scale * along * w,
                   np.broadcast_to(base.dz, s.shape))


def _doubled(y: Any) -> Any:
    """The function whose mean product with a series over the angle is y times its coefficients."""
    return np.concatenate((y[:1], 2 * y[1:]))


def _values(series: Any, count: Any) -> Any:
    return chebyshev.values(np.concatenate((series, np.zeros(count - len(series), series.dtype))))


def gradient(solver: "Solver", k: Any, degree: int, eigen: Any) -> Any:
    """Return d sigma / d c_j (terms,) in the coefficients of the fit of a flow with `data`."""
    known = shear_response(solver, k, degree, eigen)
    z = solver.flow.heights(known.s)
    data = solver.flow.data
    return known.on_U @ data.basis(z) + known.on_dU @ data.slopes(z)


def standard_error(data: Any, slopes: Any) -> Any:
    """Standard error of a quantity with these real slopes (terms,) in the coefficients of a fit."""
    return float(np.sqrt(max(slopes @ data.covariance @ slopes, 0.0)))


def data_error(solver: "Solver", k: Any, degree: int, eigen: Any) -> Any:
    """Standard error of the growth rate from the errors of the data; None where there are no data."""
    if solver.flow.data is None:
        return None
    return standard_error(solver.flow.data, gradient(solver, k, degree, eigen).real)


def of_mode(solver: "Solver", mode: Any) -> Any:
    """`gradient` of a mode."""
    return gradient(solver, mode.k, mode.degree, mode)


def error_of_maximum(solver: "Solver", mode: "Mode") -> Any:
    """Standard error of the wavenumber at which the growth of a mode is largest; None without data.

    There d growth/dk = 0 whatever U is: dk = -(d^2 growth / dk dc) dc / (d^2 growth / dk^2).
    """
    if solver.flow.data is None:
        return None
    try:
        low, high = (_beside(solver, mode, side * _STEP) for side in (-1, 1))
    except ModeLost:
        return None
    bend = (high.slope - low.slope).real
    mixed = (of_mode(solver, high) - of_mode(solver, low)).real
    return standard_error(solver.flow.data, mixed / bend)


def error_of_zero(solver: "Solver", mode: "Mode", by_value: float) -> Any:
    """Standard error of the value at which growth is 0 (and largest over k, where k is free), given its slope there."""
    if solver.flow.data is None:
        return None
    return standard_error(solver.flow.data, of_mode(solver, mode).real / by_value)


def _beside(solver: "Solver", mode: Any, step: Any) -> Any:
    k = mode.k * np.exp(step)
    return solver.solve(k, mode.rate + (k - mode.k) * mode.rate_slope, (mode.degree, mode.x, mode.y))


def spread_of(solver: "Solver", k: Any, degree: int, eigen: Any, cut: Any) -> Any:
    """Bound of the change of sigma where U is a series that leaves out `cut` at most, and U' its slope."""
    known = shear_response(solver, k, degree, eigen)
    on_U = known.on_U + _differences(len(known.s)).T @ (known.on_dU / known.slope)
    return float(cut * np.abs(on_U).sum())


@lru_cache(maxsize=8)
def _differences(count: Any) -> Any:
    """Matrix (count, count) from values at Chebyshev points to those of d/ds."""
    series = chebyshev.transform(np.eye(count)).T  # terms by points
    slopes = np.vstack((2 * C.chebder(series), np.zeros((1, count))))
    return chebyshev.values(slopes.T).T
