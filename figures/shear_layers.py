"""Thin shear layers: thickness against driving, with the quasi-static laws beside them.

The thesis's figures 2.3(b) (annular shear, rotation rate against thickness; lambda = 1.4), 2.4(c) (chute, flux), 2.8(b)
(profiles under a dragged plate; lambda = 1.6) and 2.9(a) (its velocity). Saturating friction mu1 = 0.4, mu2 = lambda
mu1, velocities in units of I0 as in the thesis. Leading terms (2.11), (2.22), (2.38) dashed; dotted the sums of three
orders, which `asymptotics` derives from the steady equations.
"""

import numpy as np
from style import BLUE, GREEN, GREY, RED, main, plt

from asymptotics import expand
from stability.errors import ParameterError
from stability.flows import Annulus, Chute, Plate, Saturating
from stability.studies.base import base_flow

MU1, I0 = 0.4, 0.3
COLOURS = (BLUE, GREEN, RED)
GAMMA0 = (1.0, 5.0, 14.7)
RATIOS = (1.5, 1.6, 1.8)
PROFILES = (1.1, 1.2, 1.3)
STYLES = {"law": "--", "three_orders": ":"}


def law(ratio):
    return Saturating(MU1, ratio * MU1, I0)


def approaching(limit, count):
    """Thicknesses up to nearly the limit at which friction is mu2, dense there."""
    return limit * (1 - np.linspace(0.995, 0.1, count) ** 3)


def series(flow, ratio, scale, **more):
    """Leading term and sum of three orders in delta, divided by a scale: two functions."""
    whole = expand(flow, mu1=MU1, mu2=ratio * MU1, I0=I0, **more)
    return [lambda delta, one=one: float(one.function()(delta).real) / scale for one in (whole.truncated(2), whole)]


def compute(fast):
    columns = {name: [] for name in ("panel", "curve", "x", "y", "law", "three_orders")}

    def add(panel, curve, x, y, *laws):
        row = (panel, float(curve), float(x), float(y), *(laws or (np.nan, np.nan)))
        for column, value in zip(columns.values(), row, strict=True):
            column.append(value)

    count = 12 if fast else 60
    for gamma0 in GAMMA0:
        laws = series("annulus", 1.4, 1.0, gamma=gamma0 / I0)
        for delta in approaching(1.4**0.5 - 1, count):
            try:
                rotation = Annulus(thickness=delta, gamma=gamma0 / I0, law=law(1.4)).rotation
            except ParameterError:
                break
            add("annulus", gamma0, rotation, delta, *(one(delta) for one in laws))
    for ratio in RATIOS:
        laws = series("chute", ratio, I0 / MU1**0.5)
        for delta in approaching(1 - 1 / ratio, count):
            flux = Chute(plug=1 - delta, law=law(ratio)).flux * MU1**0.5 / I0
            add("chute", ratio, flux, delta, *(one(delta) for one in laws))
        laws = series("plate", ratio, I0)
        for delta in approaching(ratio - 1, count):
            speed = base_flow(Plate(shields=1 + delta, law=law(ratio)), 2).U[-1] / I0
            add("plate", ratio, speed, 1 + delta, *(one(delta) for one in laws))
    for shields in PROFILES:
        found = base_flow(Plate(shields=shields, law=law(1.6)))
        for speed, height in zip(found.U / I0, found.z, strict=True):
            add("profile", shields, speed, height)
    return columns


def draw(data):
    columns = {name: np.array(values) for name, values in data.items()}
    figure, axes = plt.subplots(2, 2, figsize=(7.2, 5.6), layout="constrained")
    panels = {"annulus": (axes[0, 0], r"rotation rate $\Omega_0$", r"thickness $\delta$", r"$\Gamma_0$"),
              "chute": (axes[0, 1], r"flux $Q/Q_0$", r"thickness $\delta$", r"$\lambda$"),
              "profile": (axes[1, 0], r"velocity $U$", r"height $Z$", r"$\theta$"),
              "plate": (axes[1, 1], r"plate velocity $U_0$", r"stress $\theta$", r"$\lambda$")}
    for name, (axis, xlabel, ylabel, symbol) in panels.items():
        rows = columns["panel"] == name
        for colour, curve in zip(COLOURS, np.unique(columns["curve"][rows]), strict=True):
            here = rows & (columns["curve"] == curve)
            axis.plot(columns["x"][here], columns["y"][here], color=colour, label=f"{symbol} = {curve:g}")
            if name != "profile":
                for name_of, style in STYLES.items():
                    axis.plot(columns[name_of][here], columns["y"][here], style, color=colour, linewidth=0.8)
        axis.set(xlabel=xlabel, ylabel=ylabel, xlim=(0, {"annulus": 1.0, "chute": 1.0, "plate": 1.5}.get(name)))
        axis.legend(fontsize=7, loc="lower right")
    for label, style in zip(("leading order", "three orders"), STYLES.values(), strict=True):
        axes[0, 0].plot([], [], style, color=GREY, linewidth=0.8, label=label)
    axes[0, 0].legend(fontsize=7, loc="lower right")
    return figure


if __name__ == "__main__":
    main(__file__, compute, draw)
