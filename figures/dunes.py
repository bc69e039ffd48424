"""Dunes in both limits of the fluid: the thesis's figure 4.6.

Left an unbounded fluid (boundary layer), right a fluid under a lid (shallow viscous); from above phase speed,
growth rate, and the fastest growing wavenumber against Re. Dashed: the long-wave expansions to the first term of
growth, k^{4/3} (4.81), (4.82) on the left and A k^2 (4.84), (4.85) on the right, both derived by `asymptotics`.
The thesis does not print its parameters: these are the defaults (shields 2, mu1 0.4, b 1, Re 10) and depth 2.
"""

from dataclasses import replace

import numpy as np
from style import BLUE, GREY, RED, main, plt

from asymptotics import expand
from stability import dispersion, flows
from stability.studies.kmax import k_max_sweep

BEDS = {"unbounded": flows.Dune(), "shallow": flows.Dune(depth=2.0)}
LIMITS = {"unbounded": ("boundary-layer", "4/3"), "shallow": ("shallow", 2)}


def compute(fast):
    count = 21 if fast else 101
    data = {"k": np.geomspace(1e-3, 4, count), "Re": np.geomspace(0.1, 1e4, count)}
    for name, flow in BEDS.items():
        relation, limit = dispersion(flow, data["k"]), expansion(name)(data["k"])
        data |= {f"{name}_growth_rate": relation.growth_rate, f"{name}_phase_speed": relation.phase_speed,
                 f"{name}_error": relation.error, f"{name}_limit_growth": limit.real,
                 f"{name}_limit_speed": -limit.imag / data["k"]}
        found = list(k_max_sweep(replace(flow, Re=value) for value in data["Re"]))
        data |= {f"{name}_k_max": np.array([optimum.k_max for optimum in found]),
                 f"{name}_k_max_error": np.array([optimum.error for optimum in found])}
    return data


def expansion(name):
    """The long-wave expansion of sigma as a numeric function of k."""
    flow, (regime, order) = BEDS[name], LIMITS[name]
    given = {"shields": flow.shields, "mu1": flow.mu1, "b": flow.b, "Re": flow.Re}
    if np.isfinite(flow.depth):
        given["depth"] = flow.depth
    return expand("dune", regime=regime, order=order, **given).function()


def draw(data):
    figure, axes = plt.subplots(3, 2, figsize=(6.4, 7.2))
    k = data["k"]
    for column, (name, title) in enumerate((("unbounded", "boundary layer: unbounded fluid"),
                                            ("shallow", "shallow viscous: lid at depth 2"))):
        top, middle, bottom = axes[:, column]
        top.plot(k, data[f"{name}_phase_speed"], color=BLUE, label="collocation")
        top.plot(k, data[f"{name}_limit_speed"], "--", color=RED, label="long-wave limit")
        top.set(title=title, ylabel=r"phase speed $c_r$" if not column else "", ylim=(0, None), xlim=(0, 4))
        top.title.set_fontsize(9)
        _growth(middle, data, name, column)
        bottom.plot(data["Re"], data[f"{name}_k_max"], color=BLUE)
        bottom.set(xscale="log", yscale="log", xlabel="Re", ylabel="fastest growing $k_{max}$" if not column else "")
    axes[0, 0].legend()
    figure.suptitle("dunes: shields 2, $\\mu_1$ 0.4, $b$ 1, Re 10 (defaults; the thesis prints none)",
                    fontsize=9, color=GREY)
    return figure


def _growth(axis, data, name, column):
    k, growth, limit = data["k"], data[f"{name}_growth_rate"], data[f"{name}_limit_growth"]
    axis.axhline(0, color=GREY, linewidth=0.6)
    axis.plot(k, growth, color=BLUE)
    axis.set(xlabel="wavenumber $k d$", ylabel=r"growth rate $\sigma_r$" if not column else "", xlim=(0, 4),
             ylim=(-0.35, 0.35))
    inset = axis.inset_axes((0.16, 0.13, 0.38, 0.36))
    rising = growth > 0
    inset.loglog(k[rising], growth[rising], color=BLUE)
    for place in (axis, inset):
        place.plot(k, limit, "--", color=RED)
    inset.set_ylim(growth[0] / 2, 2)
    inset.tick_params(labelsize=6)


if __name__ == "__main__":
    main(__file__, compute, draw)
