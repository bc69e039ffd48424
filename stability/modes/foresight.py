"""Modes that a walk is likely to meet, from those that it met in a flow that is nearly the same.

Walks of such flows take the same steps for the most part. So the modes at the wavenumbers of one are refined for the
other all at once, which costs a third of solving for each in turn; its walk then takes them where it comes to them,
judged as if it had found them itself: what is foreseen saves work and decides nothing.
"""

import numpy as np

_CLOSE = 0.05  # largest relative distance of a rate from the one expected, if the walk knows what to expect


class Foresight:
    """Modes of the flow of a `solver` next to those `known`, {k: mode}, of another flow."""

    def __init__(self, solver, known):
        solver.prepare(np.array(list(known)))
        self._likely = {mode.k: mode for mode in _refined(solver, list(known.values()))}

    def at(self, k, rate, part=_CLOSE):
        """The mode foreseen at k if its rate is this one to a small part of it, or None."""
        mode = self._likely.get(k)
        return mode if mode and abs(mode.rate - rate) < part * abs(rate) else None


def _refined(solver, known):
    for degree in sorted({mode.degree for mode in known}):
        group = [mode for mode in known if mode.degree == degree]
        if group[0].x.shape != (solver.pencil(degree).size,):
            return
        vectors = [np.array([getattr(mode, name) for mode in group]) for name in ("x", "y")]
        modes = solver.solve_many([mode.k for mode in group], None, vectors, degree)
        yield from (mode for mode in modes if mode)
