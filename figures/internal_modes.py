"""Where internal modes of the ill-posed bed outgrow the surface mode of dunes: a map over (shields, k).

Unbounded fluid, b = 1, Re = 10, two friction coefficients. The friction law (4.48) is ill posed next to every yield
surface; where the strip is thick against the wavelength, modes inside it grow faster than the surface mode that the
thesis follows. Colour: growth rate of the fastest mode where that is not the surface mode; hatched: where two degrees
disagree about it, so that there is no converged growth rate at all. Lines: the cutoff and the maximum of the surface
mode, both computed as if nothing were wrong.
"""

import numpy as np
from style import BLUE, GREY, main, plt

from stability import dispersion, flows
from stability.modes.dense import finite_rates
from stability.modes.solver import Solver
from stability.numerics.threads import one_thread

MU1 = (0.4, 0.7)
DEGREES = (32, 48)
AGREEMENT = 1e-3


@one_thread
def compute(fast):
    excess = np.geomspace(0.02, 4, 12 if fast else 40)
    k = np.geomspace(0.3, 60, 16 if fast else 44)
    degrees = (24, 32) if fast else DEGREES
    columns = {name: [] for name in ("mu1", "shields", "k", "surface", "fastest", "settled")}
    for mu1 in MU1:
        for shields in 1 + excess:
            flow = flows.Dune(shields=float(shields), mu1=mu1)
            relation = dispersion(flow, k, strict=False)
            surface = dict(zip(relation.k.tolist(), relation.growth_rate.tolist(), strict=True))
            solver = Solver(flow)
            solver.prepare(k)
            for value in k.tolist():
                coarse, fine = (value * finite_rates(solver, degree, solver.symbols(value))[0].real
                                for degree in degrees)
                row = (mu1, shields, value, surface.get(value, np.nan), fine,
                       int(abs(fine - coarse) < AGREEMENT * abs(fine)))
                for column, entry in zip(columns.values(), row, strict=True):
                    column.append(entry)
    return columns


def draw(data):
    from matplotlib.colors import LogNorm

    columns = {name: np.array(values, dtype=float) for name, values in data.items()}
    figure, axes = plt.subplots(1, len(MU1), figsize=(7.2, 3.3), sharex=True, sharey=True)
    for axis, mu1 in zip(axes, MU1, strict=True):
        rows = columns["mu1"] == mu1
        shields, k = (np.unique(columns[name][rows]) for name in ("shields", "k"))
        surface, fastest, settled = (columns[name][rows].reshape(len(shields), len(k)).T
                                     for name in ("surface", "fastest", "settled"))
        ahead = fastest > surface + 1e-6 * np.abs(surface)
        ahead |= np.isnan(surface)
        growing = np.where(ahead & (fastest > 0), fastest, np.nan)
        image = axis.pcolormesh(shields - 1, k, growing, norm=LogNorm(1e-1, 1e6), cmap="YlOrRd", shading="nearest",
                                rasterized=True)
        axis.contourf(shields - 1, k, np.where(settled == 1, 0.0, 1.0), levels=[0.5, 1.5], colors="none",
                      hatches=["////"])
        leading = np.where(ahead, np.nan, surface)
        axis.contour(shields - 1, k, leading, levels=[0.0], colors=BLUE, linewidths=1.2)
        axis.plot(shields - 1, [fastest_wavenumber(k, column) for column in surface.T], "--", color=BLUE, linewidth=1.0)
        axis.set(xscale="log", yscale="log", xlabel="excess Shields ratio $\\theta - 1$")
        axis.set_title(rf"$\mu_1$ = {mu1}", fontsize=9)
    axes[0].set_ylabel("wavenumber $k d$")
    axes[0].plot([], [], color=BLUE, label="surface mode: neutral")
    axes[0].plot([], [], "--", color=BLUE, label="surface mode: fastest")
    axes[0].fill_between([], [], hatch="////", facecolor="none", edgecolor=GREY, label="degrees disagree")
    axes[0].legend(loc="lower right", fontsize=7)
    figure.colorbar(image, ax=axes, label=r"growth rate of the internal mode", extend="both")
    return figure


def fastest_wavenumber(k, growth):
    """The first maximum of the growth rate along k, by a parabola in log k."""
    inner = np.flatnonzero((growth[1:-1] > growth[:-2]) & (growth[1:-1] > growth[2:]))
    if not len(inner):
        return np.nan
    a, b, c = growth[inner[0]: inner[0] + 3]
    return k[inner[0] + 1] * (k[1] / k[0]) ** (0.5 * (a - c) / (a - 2 * b + c))


if __name__ == "__main__":
    main(__file__, compute, draw)
