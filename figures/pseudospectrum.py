"""Pseudospectrum of plane Poiseuille flow at Re 1e4, k 1, in the energy norm: where a small change moves c.

Contours of epsilon = 1 / |resolvent| in the plane of the wave speed c: equations changed by epsilon can have an
eigenvalue anywhere inside. Dots: eigenvalues, with condition numbers up to 1e7 where the branches meet, which is
why double precision keeps 14 digits of the unstable mode and 8 of those. Cf. Reddy, Schmid & Henningson (1993),
SIAM J. Appl. Math. 53, 15. The resolvent is computed from the left and right energies of the pencil, compressed to
the part of the spectrum drawn.
"""

import numpy as np
from scipy.linalg import schur
from style import RED, main, plt

from stability import flows, spectrum
from stability.modes.accuracy import Accuracy
from stability.modes.energy import condition_numbers, energy
from stability.modes.solver import Solver

FLOW, K, DEGREE = flows.Poiseuille(Re=1e4), 1.0, 128
CENTRE = 0.5 - 0.4j  # of the part of the plane of c that is drawn
RADIUS = 1.6  # eigenvalues further away do not matter there


def compute(fast):
    speeds, rates = np.linspace(0, 1.05, 30 if fast else 106), np.linspace(-1, 0.1, 30 if fast else 111)
    triangular = _compressed()
    c_r, c_i = (grid.ravel() for grid in np.meshgrid(speeds, rates))
    identity = np.eye(len(triangular))
    epsilon = [np.linalg.svd(triangular - (c - CENTRE) * identity, compute_uv=False)[-1] for c in c_r + 1j * c_i]
    modes = spectrum(FLOW, K, 40, strict=False).modes
    c = np.array([mode.c for mode in modes])
    kind = np.repeat(["resolvent", "eigenvalue"], (len(epsilon), len(c)))
    value = np.concatenate([epsilon, condition_numbers(modes)])
    return {"kind": kind, "c_r": np.append(c_r, c.real), "c_i": np.append(c_i, c.imag), "epsilon_or_condition": value}


def _compressed():
    """Triangular matrix with c - CENTRE on its diagonal whose resolvent has the energy norm of the flow's."""
    solver = Solver(FLOW, Accuracy(max_degree=DEGREE))
    pencil, norm = solver.pencil(DEGREE), energy(solver, K, DEGREE)
    a, b = pencil.pair(pencil.weights(solver.symbols(K)))
    basis, _ = np.linalg.qr(norm.adjoint[:, np.any(norm.adjoint, axis=0)])
    forcing = norm.width * norm.adjoint.conj().T @ basis
    response = basis.conj().T @ norm.state @ np.linalg.solve(a + 1j * CENTRE * b, forcing)  # rate = -i c
    form, _, count = schur(response, output="complex", sort=lambda theta: abs(theta) > 1 / RADIUS)
    return 1j * np.linalg.inv(form[:count, :count])


def draw(data):
    figure, axis = plt.subplots(figsize=(4.6, 3.8))
    grid, modes = data["kind"] == "resolvent", data["kind"] == "eigenvalue"
    columns = len(np.unique(data["c_r"][grid]))
    c_r, c_i, epsilon = (data[key][grid].reshape(-1, columns) for key in ("c_r", "c_i", "epsilon_or_condition"))
    lines = axis.contour(c_r, c_i, np.log10(epsilon), levels=np.arange(-8, 0), cmap="viridis", linewidths=0.9)
    axis.clabel(lines, fontsize=6, fmt="%d")
    axis.plot(data["c_r"][modes], data["c_i"][modes], ".", color=RED, markersize=4)
    axis.axhline(0, color="k", linewidth=0.5)
    axis.set(xlabel="$c_r$", ylabel="$c_i$", xlim=(0, 1.05), ylim=(-1, 0.1),
             title=r"$\log_{10}\,\epsilon$, plane Poiseuille flow, Re $10^4$, $k$ 1")
    return figure


if __name__ == "__main__":
    main(__file__, compute, draw)
