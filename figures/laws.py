"""How much the linear law (4.48) costs: fastest dunes against Re under three laws of equal slope.

Shields ratios 1.2 and 1.5, mu1 = 0.4: linear with b = 1; saturating with mu2 = 0.8, I0 = 1, which has the same slope
mu1 b at I = 0; the regularised law with the same numbers, whose upper branch is that law (and mu_inf = 0.05).
Wavenumber of the fastest surface mode and its growth rate. Close to yield (4.48) costs little: at shields 1.2 the
saturating law has k_max larger by up to 6.5 % and growth by 17 to 23 %; at 1.5 by 15 to 55 % and 72 to 126 %.
"""

import numpy as np
from style import BLUE, GREEN, RED, main, plt

from stability.flows import Dune, Linear, Regularised, Saturating
from stability.studies.kmax import k_max_sweep

LAWS = {"linear": (Linear(0.4, 1.0), BLUE), "saturating": (Saturating(0.4, 0.8, 1.0), GREEN),
        "regularised": (Regularised(0.4, 0.8, 1.0), RED)}
TICKS = (0.2, 0.5, 1.0, 2.0)
SHIELDS = {1.2: "--", 1.5: "-"}


def compute(fast):
    columns = {name: [] for name in ("law", "shields", "Re", "k_max", "growth_rate", "status")}
    Re = np.geomspace(0.1, 1e4, 6 if fast else 31)
    for name, (law, _) in LAWS.items():
        for shields in SHIELDS:
            beds = [Dune(shields=shields, law=law, Re=float(value)) for value in Re]
            for value, found in zip(Re, k_max_sweep(beds, mode="surface"), strict=True):
                k, growth = (found.k_max, found.growth_rate) if found.maxima else (np.nan, np.nan)
                row = (name, shields, value, k, growth, found.status)
                for column, entry in zip(columns.values(), row, strict=True):
                    column.append(entry)
    return columns


def draw(data):
    columns = {name: np.array(values) for name, values in data.items()}
    figure, axes = plt.subplots(1, 2, figsize=(7.2, 3.2), layout="constrained")
    for name, (_, colour) in LAWS.items():
        for shields, style in SHIELDS.items():
            rows = (columns["law"] == name) & (columns["shields"].astype(float) == shields)
            for axis, quantity in zip(axes, ("k_max", "growth_rate"), strict=True):
                axis.loglog(columns["Re"][rows].astype(float), columns[quantity][rows].astype(float), style,
                            color=colour, label=f"{name}, $\\theta$ = {shields:g}")
    axes[0].set(xlabel="Re", ylabel="fastest growing wavenumber $k_{max} d$", yticks=TICKS, yticklabels=TICKS)
    axes[0].minorticks_off()
    axes[1].set(xlabel="Re", ylabel=r"its growth rate $\times \sqrt{d/g'}$")
    axes[1].legend(fontsize=7)
    return figure


if __name__ == "__main__":
    main(__file__, compute, draw)
