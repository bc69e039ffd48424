"""Growth rate of longitudinal vortices: the thesis's figure 4.3 (Fr2 = 0.1, slope 30 degrees).

The curve decays for every k, touches its long-wave limit -2 k^2 / (5 tan slope) as k -> 0, and has its minimum
near k = 2.3 ("typically near k = 2" in the thesis).
"""

import numpy as np
from style import BLUE, GREY, RED, main, plt

from stability import dispersion, flows

FLOW = flows.Vortex(slope_deg=30.0, Fr2=0.1)


def compute(fast):
    k = np.geomspace(1e-2, 10, 40 if fast else 200)
    relation = dispersion(FLOW, k)
    return {"k": k, "growth_rate": relation.growth_rate, "error": relation.error, "long_wave": FLOW.long_wave(k)}


def draw(data):
    figure, axis = plt.subplots(figsize=(4.6, 3.4))
    k, growth, limit = data["k"], data["growth_rate"], data["long_wave"]
    axis.axhline(0, color=GREY, linewidth=0.6)
    axis.plot(k, growth, color=BLUE, label="collocation")
    near = limit > -0.62
    axis.plot(k[near], limit[near], "--", color=RED, label=r"$-2k^2/(5\tan\theta)$")
    axis.set(xlabel="wavenumber $k h$", ylabel=r"growth rate $\sigma$", xlim=(0, 10), ylim=(-0.62, 0.03))
    axis.legend(loc="lower right", bbox_to_anchor=(1.0, 0.05))
    lowest = np.argmin(growth)
    axis.plot(k[lowest], growth[lowest], "o", color=BLUE, markersize=3.5)
    axis.annotate(f"minimum near $k$ = {k[lowest]:.1f}", (k[lowest], growth[lowest]), (6, -12), fontsize=8,
                  textcoords="offset points")
    axis.set_title(r"longitudinal vortices, $\theta$ = 30$^\circ$, Fr$^2$ = 0.1", fontsize=9)
    inset = axis.inset_axes((0.42, 0.64, 0.42, 0.28))
    inset.loglog(k, -growth, color=BLUE)
    inset.loglog(k, -limit, "--", color=RED)
    inset.set(xlim=(1e-2, 10), ylim=(3e-5, 3), yticks=(1e-4, 1e-2, 1))
    inset.set_ylabel(r"$-\sigma$", fontsize=8, labelpad=1)
    inset.tick_params(labelsize=7)
    return figure


if __name__ == "__main__":
    main(__file__, compute, draw)
