"""Between the nodes of a walk: where a wavenumber lies among them, and what rate and vectors to begin with there."""

from math import log
from typing import TYPE_CHECKING, Any

import numpy as np

from .solver import transfer

if TYPE_CHECKING:
    from .mode import Mode
    from .solver import Solver

_NODES = 4  # through which polynomials are laid


def intervals(segments: "list[list[Mode]]", wavenumbers: list[float]) -> list[tuple[Any, ...]]:
    """For each wavenumber the segment that contains it, or the one that ends nearest to it, and the node before it."""
    logs, t = [np.log([node.k for node in nodes]) for nodes in segments], np.log(wavenumbers)
    outside = np.array([np.maximum(np.maximum(ends.min() - t, t - ends.max()), 0) for ends in logs])
    before = [np.clip(np.searchsorted(ends, t, side="right") - 1, 0, max(len(ends) - 2, 0)).tolist() for ends in logs]
    nearest, gaps = outside.argmin(axis=0).tolist(), outside.min(axis=0).tolist()
    places = []
    for number, (which, far) in enumerate(zip(nearest, gaps, strict=True)):
        nodes, ends = segments[which], logs[which]
        if far:
            places.append(([nodes[0 if abs(ends[0] - t[number]) < abs(ends[-1] - t[number]) else -1]], 0))
        else:
            places.append((nodes, before[which][number]))
    return places


def hermite(nodes: "list[Mode]", index: int, t: Any) -> Any:
    """The cubic through rates and slopes of a node and the next one at log k = t, a number or (points,)."""
    here, there = nodes[index], nodes[index + 1]
    h = log(there.k / here.k)
    u = (t - log(here.k)) / h
    rise = there.rate - here.rate
    a, b = h * here.k * here.rate_slope - rise, rise - h * there.k * there.rate_slope
    return here.rate + u * rise + u * (1 - u) * (a * (1 - u) + b * u)


def interpolated(solver: "Solver", nodes: "list[Mode]", index: int, t: np.ndarray,
                 degree: int) -> tuple[np.ndarray, ...]:
    """Rates and vectors at log k = t (points,) by the polynomials through a few nodes, of rates with their slopes too.

    With the Lagrange polynomials l_i, 1 at node i and 0 at the others, those are the sums over the nodes of l_i times
    the vectors and of l_i^2 (r_i + (t - t_i) (r_i' - 2 l_i'(t_i) r_i)).
    """
    first = min(max(index - 1, 0), max(len(nodes) - _NODES, 0))
    used = nodes[first: first + _NODES]
    times, eye = np.log([node.k for node in used]), np.eye(len(used))
    distances = times[:, None] - times + eye
    ratios = (t - times[:, None]) / distances[..., None]
    ratios[np.diag_indices(len(used))] = 1.0
    weights = ratios.prod(axis=1)
    rates, slopes = np.array([(node.rate, node.k * node.rate_slope) for node in used]).T[..., None]
    bends = slopes - 2 * (1 / distances - eye).sum(axis=1)[:, None] * rates
    vectors = [transfer(solver, (node.degree, node.x, node.y), degree) for node in used]
    return ((weights**2 * (rates + (t - times[:, None]) * bends)).sum(axis=0),
            *(_blend(weights, rows, index - first) for rows in zip(*vectors, strict=True)))


def _blend(weights: np.ndarray, vectors: tuple[Any, ...], reference: int) -> np.ndarray:
    """Weighted sums (points, size) of eigenvectors, each first given the scale of the one at `reference`."""
    base = vectors[reference]
    size = np.vdot(base, base)
    return weights.T @ np.array([size / np.vdot(base, vector) * vector for vector in vectors])
