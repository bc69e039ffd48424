"""What a regularised friction law cures: growth of all modes against wavenumber, dunes and roll waves.

Saturating law beside that of Barker & Gray (2017) with alpha 1.9, mu_inf 0.05, I0 = 0.279. Dunes: mu1 0.5, mu2 0.8,
shields 1.05, Re 10; roll waves: glass beads (mu1 = tan 20.9 deg, mu2 = tan 32.76 deg), 32.6 deg, Fr2 4. Upper panels: C
through the layer, ill posed where positive. Lower panels: largest growth rate of all modes, for the saturating law by
degrees 48 and 96 (where they part the spectrum does not converge), for the regularised law that of `spectrum`, which
vouches for it. In the bed the leap at k = 13.1 is the first internal mode, which crosses zero there while it oscillates
at 3e4: it is converged, and so are those that follow.
"""

import numpy as np
from style import BLUE, GREY, RED, main, plt

from stability import spectrum
from stability.flows import Dune, Regularised, RollWave, Saturating
from stability.modes.dense import finite_rates
from stability.modes.short_waves import well_posedness
from stability.modes.solver import Solver
from stability.status import is_resolved

LAWS = {"saturating": Saturating, "regularised": Regularised}
DEGREES = (48, 96)
LEAP, CLOSE = 1.0, 0.02  # growth rates of neighbours between which others are looked for, and how close those may be
SCENES = {"dunes": lambda law: Dune(shields=1.05, law=law(0.5, 0.8)),
          "roll waves": lambda law: RollWave(slope_deg=32.6, law=law())}


def compute(fast):
    columns = {name: [] for name in ("scene", "law", "quantity", "x", "y")}

    def add(*row):
        for column, value in zip(columns.values(), row, strict=True):
            column.append(value)

    for scene, make in SCENES.items():
        for name, law in LAWS.items():
            flow = make(law)
            found = well_posedness(flow, 101)
            bottom = float(flow.bottom)
            for layer in dict.fromkeys(found.layer):
                rows = np.array(found.layer) == layer
                for height, C in zip(found.height[rows], found.C[rows], strict=True):
                    add(scene, name, "C", float(bottom + height), float(C))
                bottom += float(found.height[rows].max())
            for k, rates in filled(growth_of(flow, name), np.geomspace(0.3, 40, 8 if fast else 32).tolist()):
                for quantity, rate in rates.items():
                    add(scene, name, quantity, k, rate)
    return columns


def growth_of(flow, law):
    """The function of k that says how fast the modes grow, {quantity: rate}."""
    solver = Solver(flow)

    def dense(k):
        return {f"growth at degree {degree}": float(finite_rates(solver, degree, solver.symbols(k))[0].real
                                                    * solver.width(k)) for degree in DEGREES}

    def listed(k):
        found = spectrum(flow, k, 1, strict=False)  # whose status says whether another mode may lead
        sure = bool(found.modes) and is_resolved(found.status[0])
        return {"growth": float(found.growth_rate[0]) if sure else np.nan}

    return listed if law == "regularised" else dense


def filled(growth, wavenumbers):
    """(k, rates) in order, with further wavenumbers where growth changes sign by a leap."""
    found = [(k, growth(k)) for k in wavenumbers]
    index = 0
    while index + 1 < len(found):
        (low, before), (high, after) = found[index], found[index + 1]
        ends = [list(rates.values())[-1] for rates in (before, after)]
        if min(ends) < 0 < max(ends) and max(ends) - min(ends) > LEAP and high - low > CLOSE:
            found.insert(index + 1, ((low + high) / 2, growth((low + high) / 2)))
        else:
            index += 1
    return found


def draw(data):
    columns = {name: np.array(values) for name, values in data.items()}
    figure, axes = plt.subplots(2, 2, figsize=(7.2, 5.6), layout="constrained")
    for column, scene in enumerate(SCENES):
        for law, colour in zip(LAWS, (RED, BLUE), strict=True):
            def of(quantity, law=law, scene=scene):
                rows = (columns["scene"] == scene) & (columns["law"] == law) & (columns["quantity"] == quantity)
                return columns["x"][rows].astype(float), columns["y"][rows].astype(float)

            heights, C = of("C")
            axes[0, column].plot(C, heights, color=colour, label=law)
            curves = [("growth", "-")] if law == "regularised" else \
                [(f"growth at degree {degree}", style) for degree, style in zip(DEGREES, ("--", "-"), strict=True)]
            for quantity, style in curves:
                axes[1, column].plot(*of(quantity), style, color=colour,
                                     label=quantity.replace("growth", law).replace(" at", ","))
        axes[0, column].axvline(0, color=GREY, linewidth=0.6)
        axes[0, column].set(xlabel="$C$ (ill posed where positive)", ylabel="height $z$", title=scene)
        axes[1, column].set(xscale="log", xlabel="wavenumber $k$", ylabel="largest growth rate of all modes")
        axes[1, column].set_yscale("symlog", linthresh=0.1)
        axes[1, column].set_ylim(-3, None)
    axes[0, 0].legend(fontsize=7)
    axes[1, 1].legend(fontsize=7)
    return figure


if __name__ == "__main__":
    main(__file__, compute, draw)
