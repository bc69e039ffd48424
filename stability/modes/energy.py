"""The energy of a perturbation, and the condition number of an eigenvalue in its norm.

The state of a flow is the velocity (u, w) in its layers and the amplitudes s of its surfaces, with the norm

    |q|^2 = sum over layers of the integral of rho (|u|^2 + |w|^2) dz + sum over surfaces of |s|^2.

The left vector of a mode holds its adjoint state: y^H B x is the inner product of the two. The condition
number |adjoint| |q| / |(adjoint, q)| >= 1 is how much faster sigma moves under a perturbation of the
equations than it would for a normal operator.
"""

from dataclasses import dataclass
from functools import lru_cache
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.polynomial import chebyshev as C
from numpy.polynomial import legendre as L

from ..equations.layer import resolved
from ..numerics import chebyshev
from .solver import Solver

if TYPE_CHECKING:
    from ..equations.layer import Profile
    from ..equations.pencil import Pencil
    from ..equations.system import System

_RULES = 16  # of quadrature that are kept, for degrees in use: some megabytes at most
_SPARE = 24  # Gauss nodes beyond the degree: 3 are enough for the flows of this package


@dataclass(frozen=True)
class Energy:
    """Matrices (values, size) that turn the vectors x and y of a pencil into arrays whose 2-norm is the energy norm.

    `state @ x` holds the velocities at Gauss points and the amplitudes, `adjoint @ y` those of the adjoint state;
    their inner product is y^H B x / `width`.

    Raises nothing. Units: the square of a velocity times a length, in the scales of the flow.

    >>> from stability import flows
    >>> from stability.modes.solver import Solver
    >>> norm = energy(Solver(flows.Couette()), 1.0, 16)
    >>> norm.state.shape[1] == norm.adjoint.shape[1]
    True
    """

    state: np.ndarray
    adjoint: np.ndarray
    width: float


def energy(solver: Solver, k: float, degree: int) -> "Energy":
    """Return the `Energy` of the vectors of one degree at wavenumber k.

    `k` is in 1/L. Raises what the profiles of the flow raise, such as NotSmooth.

    >>> from stability import flows
    >>> from stability.modes.solver import Solver
    >>> energy(Solver(flows.Couette()), 1.0, 16).width > 0
    True
    """
    flow, pencil = solver.flow, solver.pencil(degree)
    symbols = {name: value[0] for name, value in solver.symbols(k).items()}
    layers = flow.layers(SimpleNamespace(**symbols))
    stretch, width = k**flow.order, solver.width(k)
    state, adjoint = [], []
    for index, layer in enumerate(layers):
        if layer.steady:
            continue
        length = resolved(flow, layers, index, _densities).length
        nodes, weights = _gauss(degree, length)
        base = layer.base(nodes)
        root = np.sqrt(weights * np.abs(base.stress * base.rho * base.dz))
        values = _values(degree, length)
        for field, row, size in (("v", "along", stretch * base.g), ("w", "across", width)):
            name, equation = f"{layer.name}.{field}", f"{layer.name}: momentum {row}"
            orders, rows = pencil.layout.orders[name], pencil.layout.orders[equation]
            state.append(_spread(pencil, pencil.columns[name], (root * size)[:, None] * values[:, orders]))
            dual = _dual(degree, length, rows[-1] + 1)[:, rows]
            unit = (1j / stretch if field == "v" else 1) / base.stress
            adjoint.append(_spread(pencil, pencil.rows[equation], unit * root[:, None] * dual))
            state[-1] = state[-1] * (1j if field == "v" else 1)
    for surface in flow.surfaces:
        state.append(_spread(pencil, pencil.columns[surface], np.ones((1, 1))))
        adjoint.append(_kinematic(solver.assembly.system, pencil, surface) / width)
    return Energy(np.vstack(state), np.vstack(adjoint), width)


def condition_numbers(modes: tuple[Any, ...], solver: Solver | None = None) -> np.ndarray:
    """Return the condition numbers (modes,) of eigenvalues of one flow, or of its symmetry classes, in the energy norm.

    `solver` is that of the flow, if there is one already.

    They are numbers without units, 1 for a normal operator. Raises nothing of its own.

    >>> from stability import flows, spectrum
    >>> [row["condition"] >= 1 for row in spectrum(flows.Couette(), 1.0, 2)]
    [True, True]
    """
    solvers: dict = {half.flow: half for half in solver.halves} if solver else {}
    norms: dict = {}
    found = []
    for mode in modes:
        if mode.flow not in solvers:
            solvers[mode.flow] = Solver(mode.flow)
        key = mode.flow, mode.k, mode.degree
        if key not in norms:
            norms[key] = energy(solvers[mode.flow], mode.k, mode.degree)
        norm = norms[key]
        found.append(norm.width * np.linalg.norm(norm.state @ mode.x) * np.linalg.norm(norm.adjoint @ mode.y))
    return np.array(found)


def _densities(base: "Profile", s: np.ndarray) -> tuple[Any, ...]:
    """What squares of velocities are multiplied by in the energy of a state and of its adjoint."""
    density = base.rho * base.dz
    return base.stress * density * base.g**2, base.stress * density, density / base.stress


@lru_cache(maxsize=_RULES)
def _gauss(degree: int, length: int) -> tuple[np.ndarray, ...]:
    """Nodes and weights on 0 <= s <= 1, enough for squares of series times a density of this many terms."""
    nodes, weights = L.leggauss(degree + max(_SPARE, length // 2 + 1))
    return (1 + nodes) / 2, weights / 2


@lru_cache(maxsize=_RULES)
def _values(degree: int, length: int) -> np.ndarray:
    """The Chebyshev polynomials up to a degree at those nodes, (nodes, degree + 1)."""
    return chebyshev.at(_gauss(degree, length)[0], degree)


@lru_cache(maxsize=_RULES)
def _dual(degree: int, length: int, count: int) -> np.ndarray:
    """Matrix (nodes, count) from y to the function f at the nodes with y^H r = integral of conj(f) r, r in T_j."""
    nodes, weights = _gauss(degree, length)
    legendre = L.legvander(2 * nodes - 1, count - 1) * np.sqrt(2 * np.arange(count) + 1)
    change = legendre.T @ (weights[:, None] * C.chebvander(2 * nodes - 1, count - 1))
    return np.linalg.solve(change, legendre.T).T


def _spread(pencil: "Pencil", places: np.ndarray, block: np.ndarray) -> np.ndarray:
    full = np.zeros((len(block), pencil.size), block.dtype)
    full[:, places] = block
    return full


def _kinematic(system: "System", pencil: "Pencil", surface: str) -> np.ndarray:
    """The rows (1, size) of y that multiply rate * surface in B, with their factors."""
    factors = np.zeros((1, pencil.size))
    for row, terms in zip(pencil.rows["conditions"], system.conditions, strict=True):
        factors[0, row] -= sum(series[0] for unknown, monomial, series in terms
                               if unknown == surface and monomial == ("rate",))
    return factors
