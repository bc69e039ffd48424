"""Seeded random flows and wavenumbers over the ranges in which the solver is held to its error bars."""

import numpy as np
import references

from stability import flows


def vortices(count, seed):
    """Yield (flow, k) for longitudinal vortices."""
    rng = np.random.default_rng(seed)
    for _ in range(count):
        flow = flows.Vortex(slope_deg=rng.uniform(5, 45), Fr2=_log(rng, 1e-3, 50))
        yield flow, _log(rng, 1e-3, 30)


def dunes(count, seed):
    """Yield (flow, k) for dunes, every other one with a lid."""
    rng = np.random.default_rng(seed)
    for index in range(count):
        flow = flows.Dune(shields=rng.uniform(1.05, 4), mu1=rng.uniform(0.2, 0.7), b=_log(rng, 0.3, 3),
                          Re=_log(rng, 0.05, 3e3), depth=rng.uniform(2, 20) if index % 2 else np.inf)
        yield flow, _log(rng, 1e-3, 8)


def reference(flow, k, sigma):
    """The multi-precision eigenvalue next to sigma."""
    if isinstance(flow, flows.Vortex):
        return references.vortex(flow.slope_deg, flow.Fr2, k, sigma)
    return references.dune(flow.shields, flow.mu1, flow.b, flow.Re, flow.depth, k, sigma)


def _log(rng, low, high):
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))
