"""The fastest growing wavenumber of dunes and its growth rate over Shields ratio and Reynolds number.

Unbounded fluid, b = 1. Above mu1 = 0.4: k_max jumps (red) from the long viscous waves, k ~ sqrt(Re), to waves as short
as the bed is deep. Every bed is ill posed (C > 0) next to its yield surface, below the dashed line throughout, but no
internal mode is ahead of the surface mode at k_max. Below mu1 = 0.7: where cells are cross-hatched one is, so that the
dunes computed would not be seen; the short waves on top belong to a second ill-posed strip, below the surface, and not
all of them are resolved.
"""

import numpy as np
from style import GREY, RED, main, plt

from stability import flows
from stability.modes.short_waves import well_posedness
from stability.output.mapplots import HATCHES, branch_changes, hatch, jumps, mesh, states
from stability.studies.map import parameter_map
from stability.studies.pool import cores

Re = 0.1, 1e4
GRIDS = {0.4: (60, 3.0), 0.7: (24, 2.0)}  # {mu1: (points along each axis, largest excess Shields ratio)}
LEAST = 0.02  # excess Shields ratio


def compute(fast):
    maps = [one_map(mu1, 8 if fast else count, 1.0 if fast else most) for mu1, (count, most) in GRIDS.items()]
    return {name: np.concatenate([one[name] for one in maps]) for name in maps[0]}


def one_map(mu1, count, most):
    excess = np.geomspace(LEAST, most, count)
    found = parameter_map(flows.Dune(mu1=mu1), {"shields": 1 + excess, "Re": np.geomspace(*Re, count)}, workers=cores())
    columns = {"mu1": np.full(found.request.size, mu1)}
    columns |= dict(zip(("shields", "Re"), (grid.ravel() for grid in np.meshgrid(*found.axes.values(), indexing="ij")),
                        strict=True))
    columns |= {name: found[name].ravel() for name in found.results}
    columns["jump_above"], columns["jump_right"] = (
        np.pad(change, [(0, found.request.shape[i] - change.shape[i]) for i in (0, 1)]).ravel().astype(int)
        for change in branch_changes(found))
    columns["ill_posed_share"] = np.repeat([ill_posed_share(mu1, value) for value in found.axes["shields"]], count)
    return columns


def ill_posed_share(mu1, shields):
    """The part of the bed's depth where C > 0."""
    strips = well_posedness(flows.Dune(mu1=mu1, shields=shields)).strips
    return sum(strip.high - strip.low for strip in strips) / (shields - 1)


def draw(data):
    figure, axes = plt.subplots(len(GRIDS), 2, figsize=(7.2, 6.4), layout="constrained")
    for row, mu1 in zip(axes, GRIDS, strict=True):
        here = np.isclose(data["mu1"], mu1)
        shields, values = np.unique(data["shields"][here]), np.unique(data["Re"][here])
        grid = {name: column[here].reshape(len(shields), len(values)) for name, column in data.items()}
        whole = (shields - 1)[grid["ill_posed_share"][:, 0] > 1 - 1e-6]
        for axis, name, label in zip(row, ("k_max", "growth_rate"), ("fastest growing $k_{max}$", "its growth rate"),
                                     strict=True):
            image = mesh(axis, values, shields - 1, grid[name])
            figure.colorbar(image, ax=axis, label=label)
            for state, where in states(grid["status"]).items():
                hatch(axis, values, shields - 1, where, HATCHES[state])
            jumps(axis, values, shields - 1, grid["jump_above"][:-1], grid["jump_right"][:, :-1])
            axis.axhline(whole.max(), color="w", linestyle="--", linewidth=1.0)
            axis.set_title(rf"$\mu_1$ = {mu1}", fontsize=9)
            axis.set(xlabel="Re", ylabel=r"excess Shields ratio $\theta - 1$" if name == "k_max" else "",
                     yscale="log")
    legend(figure, [state for state, where in states(data["status"]).items() if where.any()])
    return figure


def legend(figure, hatched):
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    handles = [Line2D([], [], color=RED, label="jump between branches"),
               Line2D([], [], color=GREY, linestyle="--", label="below: $C > 0$ throughout the bed"),
               *(Patch(facecolor="none", hatch=HATCHES[state], label=state) for state in hatched)]
    figure.legend(handles=handles, loc="outside lower center", ncols=2, fontsize=8)


if __name__ == "__main__":
    main(__file__, compute, draw)
