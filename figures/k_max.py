"""The fastest growing wavenumber of dunes against Re, with both limits of the fluid: k_max versus Re.

Unbounded fluid and lids at three depths. As Re -> 0 an unbounded fluid gives k_max ~ kappa sqrt(Re); at small Re
and shallow depth no wave grows at all. Run time: about 15 s.
"""

from dataclasses import replace

import numpy as np
from style import BLUE, GREEN, GREY, ORANGE, RED, main, plt

from stability import flows
from stability.optimum import k_max_sweep

DEPTHS = {np.inf: BLUE, 20.0: GREEN, 5.0: ORANGE, 2.0: RED}


def compute(fast):
    Re = np.geomspace(1e-3, 1e4, 15 if fast else 141)
    rows = []
    for depth in DEPTHS:
        for optimum in k_max_sweep(replace(flows.Dune(depth=depth), Re=value) for value in Re):
            rows += [(depth, optimum.flow.Re, m.k, m.growth_rate, m.error, rank)
                     for rank, m in enumerate(optimum.maxima)]
    return dict(zip(("depth", "Re", "k_max", "growth_rate", "error", "rank"), np.array(rows).T, strict=True))


def draw(data):
    figure, axes = plt.subplots(1, 2, figsize=(6.8, 3.1))
    for depth, colour in DEPTHS.items():
        best = (data["depth"] == depth) & (data["rank"] == 0)
        label = "unbounded fluid" if np.isinf(depth) else f"lid at {depth:g} d"
        for axis, key in zip(axes, ("k_max", "growth_rate"), strict=True):
            axis.loglog(data["Re"][best], data[key][best], color=colour, label=label)
    best = (data["depth"] == np.inf) & (data["rank"] == 0)
    Re, k = data["Re"][best], data["k_max"][best]
    small = Re < 0.1
    axes[0].loglog(Re[small], k[0] * np.sqrt(Re[small] / Re[0]), ":", color=GREY, label=r"$\propto$ Re$^{1/2}$")
    axes[0].set(xlabel="Re", ylabel="fastest growing wavenumber $k_{max}$")
    axes[1].set(xlabel="Re", ylabel="its growth rate")
    axes[0].legend(fontsize=8)
    figure.suptitle(r"dunes: shields 2, $\mu_1$ 0.4, $b$ 1", fontsize=9, color=GREY)
    return figure


if __name__ == "__main__":
    main(__file__, compute, draw)
