"""The fastest growing wavenumber of dunes against Re, with its limits at small and at large Re.

Unbounded fluid, and lids at three depths. The dashed and dotted limits of an unbounded fluid owe nothing to the
matrices behind the solid curves.

Small Re: k_max ~ kappa sqrt(Re) and its growth rate ~ Re, from `asymptotics expand dune --regime small-Re`.

Large Re: k_max ~ a Re^(1/8) and its growth rate ~ c Re^(1/4). The fluid is in its boundary-layer limit,
R = -(3^(1/3)/Gamma(2/3)) (i k Re)^(1/3), and moves a skin of depth 1/k where viscosity balances inertia,
sigma ~ k^2; the surface rises at sigma s0 = w ~ t/k with the stress t ~ R s0, so that k^3 ~ (k Re)^(1/3).
Convection, the weight s0 and the changes of the base flow within the skin are smaller by a factor k ~ Re^(1/8)
or more: the limit is approached slowly. With fields exp(k m z), sigma = k^2 L and eta, beta, alpha of the surface
the equations of the bed give

    beta (m^2 + 1)^2 - L (m^2 - 1) - 4 eta m^2 + 2 i alpha m (L + eta - eta m^2) = 0,
    p / k w = 2 m (eta m^2 - eta - L)/(m^2 + 1),    t / k w = i ((m^2 - 1) L + 4 eta m^2)/(m^2 + 1).

The two roots with Re m > 0 combine to p = 0; the kinematic condition k^2 L s0 = w then leaves
k^(8/3) = G(L) Re^(1/3), and sigma = k^2 L is largest, along real k, where Re(d sigma / dk) = 0. Here a = 0.7475 and
c = 0.4590; at Re = 1e8 the curves are 1.8 % and 6 % below, at 1e16 0.3 % and 0.5 %.
"""

from dataclasses import replace

import numpy as np
from scipy.optimize import root
from scipy.special import gamma
from style import BLUE, GREEN, GREY, ORANGE, RED, main, plt

from asymptotics import expand
from asymptotics.flows.dune import small_Re_maximum
from stability import flows
from stability.studies.kmax import k_max_sweep

BED = flows.Dune()
DEPTHS = {np.inf: BLUE, 20.0: GREEN, 5.0: ORANGE, 2.0: RED}
LIDS_END = 1e4  # beyond this Re no lid is felt
QUANTITIES = "k_max", "growth_rate"
POWERS = {("small Re", "k_max"): (1 / 2, "Re$^{1/2}$"), ("small Re", "growth_rate"): (1, "Re"),
          ("large Re", "k_max"): (1 / 8, "Re$^{1/8}$"), ("large Re", "growth_rate"): (1 / 4, "Re$^{1/4}$")}


def compute(fast):
    Re = np.geomspace(1e-4, 1e8, 25 if fast else 145)
    rows = []
    for depth in DEPTHS:
        sweep = Re if np.isinf(depth) else Re[Re < LIDS_END]
        for optimum in k_max_sweep(replace(BED, depth=depth, Re=value) for value in sweep):
            rows += [("collocation", depth, optimum.flow.Re, m.k, m.growth_rate, m.error, rank)
                     for rank, m in enumerate(optimum.maxima)]
    for name, law in (("small Re", small_Re(BED)), ("large Re", large_Re(BED))):
        rows += [(name, np.inf, value, *law(value), 0.0, 0) for value in Re]
    names = ("method", "depth", "Re", "k_max", "growth_rate", "error", "rank")
    return {name: np.array(column) for name, column in zip(names, zip(*rows, strict=True), strict=True)}


def small_Re(bed):
    """k_max and its growth rate as Re -> 0, a function of Re."""
    kappa = float(small_Re_maximum(bed.shields, bed.mu1))
    growth = expand("dune", "small-Re", shields=bed.shields, mu1=bed.mu1, b=bed.b, kappa=kappa).values()[1].real
    return lambda Re: (kappa * Re**0.5, growth * Re)


def large_Re(bed):
    """k_max and its growth rate as Re -> inf, a function of Re."""
    eta, beta = bed.mu1 * bed.shields * bed.b / (bed.shields - 1), bed.mu1 * bed.b
    alpha = bed.mu1 * (bed.shields + 1) / 2
    load = bed.mu1 * bed.shields * 3 ** (1 / 3) / gamma(2 / 3) * np.exp(1j * np.pi / 6)

    def G(L):
        m = np.roots([beta, -2j * alpha * eta, 2 * beta - L - 4 * eta, 2j * alpha * (L + eta), beta + L])
        m = m[np.argsort(-m.real)][:2]
        p = 2 * m * (eta * m**2 - eta - L) / (m**2 + 1)
        t = 1j * ((m**2 - 1) * L + 4 * eta * m**2) / (m**2 + 1)
        return load * (p[1] - p[0]) / (t[0] * p[1] - t[1] * p[0]) / L

    def conditions(parts):
        L = complex(*parts)
        low, high = ((G(at) ** 0.375, at) for at in (L * (1 - 1e-5), L * (1 + 1e-5)))
        slope = (high[0] ** 2 * high[1] - low[0] ** 2 * low[1]) / (high[0] - low[0])
        return np.angle(G(L)), slope.real / abs(slope)

    found = root(conditions, (1.0, -1.0), tol=1e-10)
    assert found.success, found.message
    L = complex(*found.x)
    k = G(L).real ** 0.375
    return lambda Re: (k * Re**0.125, k**2 * L.real * Re**0.25)


def draw(data):
    figure, axes = plt.subplots(1, 2, figsize=(6.8, 3.1))
    numerical = data["method"] == "collocation"
    for depth, colour in reversed(DEPTHS.items()):
        best = numerical & (data["depth"] == depth) & (data["rank"] == 0)
        label = "unbounded fluid" if np.isinf(depth) else f"lid at {depth:g} d"
        for axis, key in zip(axes, QUANTITIES, strict=True):
            axis.loglog(data["Re"][best], data[key][best], color=colour, label=label)
    for axis, key in zip(axes, QUANTITIES, strict=True):
        limits = [_limit(axis, data, key, *one) for one in (("small Re", "--", data["Re"] < 10),
                                                            ("large Re", ":", data["Re"] > 0.1))]
        axis.legend(handles=limits, fontsize=8, loc="upper left")
        axis.margins(y=0.12)
    for axis, label in zip(axes, ("fastest growing wavenumber $k_{max}$", "its growth rate"), strict=True):
        axis.set(xlabel="Re", ylabel=label)
    axes[0].add_artist(axes[0].get_legend())  # a second one would replace it
    axes[0].legend(handles=axes[0].get_lines()[: len(DEPTHS)], fontsize=8, loc="lower right")
    figure.suptitle(r"dunes: shields 2, $\mu_1$ 0.4, $b$ 1", fontsize=9, color=GREY)
    return figure


def _limit(axis, data, key, name, style, part):
    """Draw a limit of the unbounded fluid, labelled with its coefficient."""
    rows = (data["method"] == name) & part
    Re, values = data["Re"][rows], data[key][rows]
    power, label = POWERS[name, key]
    return axis.loglog(Re, values, style, color=GREY, label=f"{values[0] / Re[0]**power:.3g} {label}")[0]


if __name__ == "__main__":
    main(__file__, compute, draw)
