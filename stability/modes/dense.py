"""All finite eigenvalues of a pencil: the dense problem with its infinite ones deflated.

Only the momentum and kinematic rows of B are non-zero. With B = E B_r (E picks those rows) and
G = B_r (A - shift B)^{-1} E, the finite eigenvalues are rate = shift + 1/theta for the non-zero
eigenvalues theta of G. The infinite ones, defective in the pencil because pressure only enforces
continuity, become semisimple zeros of G. How many are finite follows from the structure alone, so that
nothing is filtered by size.
"""

from dataclasses import dataclass, field
from functools import lru_cache
from typing import TYPE_CHECKING, Any
from weakref import proxy

import numpy as np
from scipy.linalg import lapack

from ..equations.condensed import sparing
from ..equations.layer import FIELDS
from ..errors import ModeLost

if TYPE_CHECKING:
    from .solver import Solver

_LARGEST = 1300  # unknowns of a dense problem
_SHIFT = 0.01 - 0.013j  # tried when the pencil is singular at rate 0
_SINGULAR = 1e14  # ratio of the two largest theta above which rate 0 is taken for an eigenvalue
_QR = {"f": (lapack.dgeqp3, lapack.dormqr), "c": (lapack.zgeqp3, lapack.zunmqr)}
_WORK = 32  # columns that LAPACK treats at once
_SMALL = 10  # degree of the pencil whose finite eigenvalues are counted


def dense_degrees(solver: "Solver", first: int, step: int = 1) -> list[int]:
    """Degrees for dense problems, from rung `first` on, as far as one takes no longer than about a second."""
    affordable = [degree for degree in solver.degrees if unknowns(solver, degree) <= _LARGEST] or solver.degrees[:1]
    chosen = list(affordable[first::step])
    return chosen if chosen[-1:] == list(affordable[-1:]) else [*chosen, affordable[-1]]


def unknowns(solver: "Solver", degree: int) -> int:
    """How many there are at a degree, roughly."""
    structure = solver.assembly.system.structure
    return len(FIELDS) * sum(structure.degrees(degree)) // structure.stride


def finite_rates(solver: "Solver", degree: int, symbols: dict[str, tuple[Any, ...]]) -> np.ndarray:
    """Return the finite eigenvalues of the pencil of this degree, all of them, by decreasing real part."""
    pencil, count = solver.pencil(degree), _finite_count(solver, degree)
    weights = pencil.weights(symbols)
    if sparing(pencil.layout) and (short := pencil.shortened):  # hardly more rows than `count` have the rate there
        theta, shift = _theta(short, short.weights(weights.value))
    else:
        theta, shift = _theta(pencil, weights.value, count)
    rates = shift + 1 / theta[:count]
    rates = rates[np.isfinite(rates)]
    if not len(rates):
        raise ModeLost(f"{solver.flow}: no eigenvalue at degree {degree} is a number in double precision")
    return rates[np.argsort(-rates.real)]


def _theta(pencil: Any, weights: Any, rank: Any = None) -> Any:
    """Eigenvalues of G by decreasing size, and the shift; only `rank` of them if G is known to have that rank."""
    rows = pencil.rate_rows
    columns = np.zeros((pencil.size, len(rows)))
    columns[rows, np.arange(len(rows))] = 1
    theta = np.zeros(0)
    for shift in (0.0, _SHIFT):
        try:
            response = pencil.factors(weights, shift).solve(columns)
            theta = _eigenvalues(pencil.b_products(weights[:, None])[0](response)[rows], rank)
        except np.linalg.LinAlgError:  # singular, or not finite
            continue
        theta = theta[np.argsort(-np.abs(theta))]
        if np.abs(theta[0]) < _SINGULAR * np.abs(theta[1:2]).sum():
            break
    return theta, shift


def _eigenvalues(g: np.ndarray, rank: int | None) -> np.ndarray:
    """Eigenvalues of g; the non-zero ones alone from g = q r, which has those of r q: of both `rank` lines count."""
    if rank is None or rank >= len(g):
        return np.linalg.eigvals(g)
    count = len(g)
    factor, times = _QR[g.dtype.kind]
    reflectors, order, scales, *_ = factor(g, lwork=_WORK * (count + 1))
    r = np.zeros((rank, count), g.dtype, order="F")
    r[:, order - 1] = np.triu(reflectors[:rank])
    return np.linalg.eigvals(times("R", "N", reflectors[:, :rank], scales[:rank], r, lwork=_WORK * count)[0][:, :rank])


def _finite_count(solver: "Solver", degree: int) -> int:
    """How many eigenvalues are finite: one per coefficient for every layer that carries the rate, plus a constant."""
    system = solver.assembly.system
    stride = system.structure.stride
    small = _SMALL + (degree - _SMALL) % stride
    count = smallest_count(Pattern(system.pattern, small, proxy(solver.assembly)))
    more = zip(system.dynamic, system.structure.degrees(degree), strict=True)
    return count + sum((own - small) // stride for dynamic, own in more if dynamic)


@dataclass(frozen=True)
class Pattern:
    """What the number of finite eigenvalues depends on, and an assembly that has it: a proxy, to keep no matrices."""

    pattern: tuple
    degree: int
    assembly: Any = field(compare=False)


@lru_cache(maxsize=32)
def smallest_count(structure: "Pattern") -> int:
    """Finite eigenvalues at a small degree: read off the gap in theta with all symbols 1."""
    small = structure.assembly.generic(structure.degree)
    sizes = np.abs(_theta(small, np.ones(len(small.parts)))[0])
    return int(np.argmin(sizes[1:] / np.maximum(sizes[:-1], np.finfo(float).tiny))) + 1
