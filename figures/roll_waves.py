"""Roll waves: threshold against slope, and neutral curves, of the mu(I) model beside the depth-averaged theory.

Left: the long-wave threshold F_c^2 = (4/25)(4 - 6 t^2 + 3 e0 t), met to 12 digits, and the true onset: where that is
lower, waves of finite length grow first (below 22 degrees, next to the ill-posed slopes, ever shorter ones).
Depth-averaged theory (Gray & Edwards 2014) has F_c = 2/3 at every slope.
Right: neutral wavenumbers, with the depth-averaged cutoff (k h)^2 = (9/4) e0 (3F - 2)/t; cf. Forterre (2006),
figure 4.1 (b, c) of Cawthorn's thesis. Glass beads: mu1 = tan 20.9, mu2 = tan 32.76 deg.
"""

import numpy as np
from style import BLUE, GREEN, GREY, ORANGE, RED, main, plt

from stability import flows
from stability.studies.critical import critical_sweep
from stability.studies.neutral import neutral_curve

SLOPES = {22.0: BLUE, 24.0: GREEN, 26.0: ORANGE, 29.0: RED}
WELL_POSED = 21.7435874, 30.0686769  # slopes between which the model is well-posed at every depth (Barker et al. 2015)
DEPTH_AVERAGED = 2 / 3


def compute(fast):
    slopes = np.linspace(22.0, 30.0, 8 if fast else 41)
    rows = []
    for long_wave, kind in ((True, "long-wave threshold"), (False, "onset")):
        sweep = (flows.RollWave(slope_deg=float(slope), Fr2=3.0) for slope in slopes)
        rows += [(kind, point.flow.slope_deg, point.k, point.flow.froude)
                 for point in critical_sweep(sweep, "Fr2", span=(1.0, 10.0), long_wave=long_wave)
                 if point.status == "resolved"]
    for slope in SLOPES:
        flow = flows.RollWave(slope_deg=slope, Fr2=3.0)
        curve = neutral_curve(flow, "Fr2", np.array([0.02, 1.3]))
        rows += [("neutral curve", slope, k, 0.4 * np.sqrt(Fr2)) for k, Fr2 in curve.trace]
        froude = np.linspace(DEPTH_AVERAGED, 2.5, 20 if fast else 80)
        cutoff = np.sqrt(2.25 * flow.e0 * (3 * froude - 2) / flow.mu)
        rows += [("depth-averaged cutoff", slope, k, F) for k, F in zip(cutoff, froude, strict=True)]
    return dict(zip(("kind", "slope_deg", "k", "F"), map(np.array, zip(*rows, strict=True)), strict=True))


def draw(data):
    figure, (left, right) = plt.subplots(1, 2, figsize=(6.8, 3.1))
    for kind, style in (("long-wave threshold", {"color": GREY, "linestyle": "--"}), ("onset", {"color": BLUE})):
        rows = data["kind"] == kind
        left.plot(data["slope_deg"][rows], data["F"][rows], label=kind, **style)
    left.axhline(DEPTH_AVERAGED, color=RED, linestyle=":", label="depth-averaged: 2/3")
    left.set(xlabel="slope, degrees", ylabel=r"$F$ = mean speed / $\sqrt{g h \cos\theta}$", xlim=WELL_POSED)
    left.legend(fontsize=8)
    for slope, colour in SLOPES.items():
        for kind, line, label in (("neutral curve", "-", f"{slope:g} deg"), ("depth-averaged cutoff", ":", None)):
            rows = (data["kind"] == kind) & (data["slope_deg"] == slope)
            right.plot(data["F"][rows], data["k"][rows], line, color=colour, label=label)
    right.plot([], [], ":", color=GREY, label="depth-averaged")
    right.set(xlabel="$F$", ylabel="neutral wavenumber $k h$", xlim=(0.55, 1.6), ylim=(0, 1.2))
    right.legend(fontsize=8)
    return figure


if __name__ == "__main__":
    main(__file__, compute, draw)
