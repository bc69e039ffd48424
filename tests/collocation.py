"""Eigenvalues of the Orr-Sommerfeld equation in extended precision, by a method of its own.

    i k ((U - c)(w'' - k^2 w) - U'' w) = (w'''' - 2 k^2 w'' + k^4 w) / Re

with w = w' = 0 on walls, w = w'' = 0 on lids without stress, or w ~ exp(-k z) far above. The unknown is the fourth
derivative: w is four times its integral, which keeps the matrices well conditioned; the equation holds at Chebyshev
points. Newton's iteration takes its residuals in extended precision (19 digits) and its steps in double precision. It
shares nothing with the package: one equation of the fourth order for four of the first, collocation for series, U''
for U', other arithmetic.
"""

import numpy as np
from scipy.linalg import lu_factor, lu_solve

_STEPS = 40
_REST = 1e-15  # change of c below which the iteration goes on only while steps halve


def wave_speed(U, ddU, low, high, Re, k, guess, count, edge="wall"):
    """Return c (clongdouble) next to the guess from `count` points; U(z) and ddU(z) take and return longdouble arrays.

    The `edge` is a "wall", or "slip" at either end, or a wall below and "far" above.

    Raises ArithmeticError where the iteration does not end.
    """
    a, b = _matrices(U, ddU, low, high, Re, k, count, edge)
    c = np.clongdouble(guess)
    rough = lu_factor((a - c * b).astype(complex))
    x = np.random.default_rng(1).standard_normal(len(a)).astype(complex)
    for _ in range(4):
        x = lu_solve(rough, b.astype(complex) @ x)
        x /= x[np.argmax(np.abs(x))]
    pivot, x = int(np.argmax(np.abs(x))), x.astype(np.clongdouble)
    before = np.inf
    for step in range(_STEPS):
        if step in (0, 3, 6):
            jacobian = lu_factor(_bordered(a - c * b, b @ x, pivot))
        change = lu_solve(jacobian, np.append(-((a - c * b) @ x), 0).astype(complex))
        x, c = x + change[:-1], c + change[-1]
        if step > 6 and before / 2 < abs(change[-1]) < _REST:
            return c
        before = abs(change[-1])
    raise ArithmeticError(f"no eigenvalue near {guess}: last step {abs(change[-1]):.1e}")


def _bordered(matrix, column, pivot):
    full = np.zeros((len(matrix) + 1, len(matrix) + 1), complex)
    full[:-1, :-1], full[:-1, -1], full[-1, pivot] = matrix, -column, 1
    return full


def _matrices(U, ddU, low, high, Re, k, count, edge):
    """A and B, (count + 4, count + 4), of A x = c B x; x are T-coefficients of w'''' and integration constants."""
    scale = np.longdouble(high - low) / 2
    order = np.arange(count + 4)
    angles = (2 * np.arange(count) + 1)[:, None] * order % (4 * count)
    inside = np.cos(angles * (4 * np.arctan(np.longdouble(1)) / (2 * count)))
    edges = np.array([(-1.0) ** order, np.ones(count + 4)], np.longdouble)
    powers = _integrals(count, scale)
    fields = [inside @ matrix for matrix in powers]  # w, w', w'', w''', w''''
    z = low + (inside[:, 1] + 1) * scale
    velocity, bend = U(z)[:, None], ddU(z)[:, None]
    k = np.longdouble(k)
    vorticity = fields[2] - k**2 * fields[0]
    viscous = (fields[4] - 2 * k**2 * fields[2] + k**4 * fields[0]) / np.longdouble(Re)
    walls = np.vstack([edges @ powers[derivative] for derivative in (0, 2 if edge == "slip" else 1)])
    if edge == "far":
        walls[1::2] = edges[1] @ (powers[1] + k * powers[0]), edges[1] @ (powers[2] - k**2 * powers[0])
    a = np.vstack([velocity * vorticity - bend * fields[0] + 1j * viscous / k, walls])
    return a, np.vstack([vorticity, 0 * walls]).astype(np.clongdouble)


def _integrals(count, scale):
    """T-coefficients of w and of its four derivatives, each (count + 4, count + 4), from the unknowns."""
    highest = np.zeros((count + 4, count + 4), np.longdouble)
    highest[:count, :count] = np.eye(count)
    found = [highest]
    for constant in range(4):
        below, last = np.zeros_like(highest), found[0]
        doubled = np.vstack([2 * last[:1], last[1:], np.zeros((1, count + 4))])
        m = np.arange(1, count + 4)[:, None]
        below[1:] = (doubled[:-2] - doubled[2:]) / (2 * m) * scale
        below[0, count + constant] = 1
        found.insert(0, below)
    return found
