"""Figures of maps: lines over one axis, colours over two; jumps between branches drawn, doubtful points hatched.

An infinite value of a parameter is drawn as one more cell, set apart, beside the finite ones.
"""

from typing import Any

import numpy as np

from .checks import check_options
from .errors import ParameterError
from .plots import BLUE, DISPERSION, GREY, NEUTRAL, OPTIMA, RED
from .status import is_outgrown, is_settled, is_stable

HATCHES = {"not resolved": "////", "stable": "..", "outgrown by an internal mode": "xxxx"}
_SIGNED, _RISING = "RdBu_r", "viridis"
_DECADES = 20.0  # ratio of values beyond which their logarithm is shown
_FEW, _MANY = (2, 5), (1.5, 2, 3, 5, 7)  # ticks between powers of ten
_LEAST_SHADE = 1e-2  # of the largest: below, colours of signed values are linear


def draw_map(found, figure):
    """Draw a Map over one or two axes into an empty figure: the quantity, and what belongs to it."""
    axes = figure.subplots(1, 2)
    for axis, column in zip(axes, labels(found), strict=True):
        panel(found, axis, column)
    _legend(figure, found, states(found["status"]))


def panel(found, axis, column):
    """Draw one result of a Map over one or two axes into a matplotlib Axes; return it."""
    names = list(found.axes)
    if len(names) > 2:
        raise ParameterError(f"only maps over one or two axes are drawn (this one has {', '.join(names)})")
    column = check_options("quantity", column, found.results[:-1])
    label, doubtful = labels(found).get(column, column), states(found["status"])
    if len(names) == 1:
        _lines(axis, found, column, doubtful)
        axis.set(xlabel=_symbol(names[0]), ylabel=label)
    else:
        _colours(axis, found, column, label, doubtful)
        axis.set(xlabel=_symbol(names[1]), ylabel=_symbol(names[0]))
    return axis


def states(status):
    """Which points are to be hatched, {state: array shaped as the status}."""
    settled, stable, outgrown = (np.vectorize(test, otypes=[bool])(status) for test in
                                 (is_settled, is_stable, is_outgrown))
    return dict(zip(HATCHES, (~settled, stable, outgrown), strict=True))


def labels(found):
    """The two results that are drawn, with their labels."""
    if found.quantity == "k_max":
        return OPTIMA
    if found.quantity == "neutral":
        return {found.request.vary: f"{found.request.vary} {NEUTRAL['value']}", "k": "wavenumber $k$ (0: long waves)"}
    return DISPERSION


def _legend(figure, found, doubtful):
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    handles: list[Any] = [Patch(facecolor="none", edgecolor="k", hatch=HATCHES[name], label=name)
               for name, where in doubtful.items() if where.any()]
    if found.quantity == "k_max" and len(found.axes) == 2 and any(part.any() for part in branch_changes(found)):
        handles.append(Line2D([], [], color=RED, label="jump between branches"))
    if handles:
        figure.legend(handles=handles, loc="outside lower center", ncols=len(handles), fontsize=8)


def _lines(axis, found, column, doubtful):
    (values,), y = found.axes.values(), found[column]
    order = np.argsort(values, kind="stable")
    x, y = _places(values)[order], y[order]
    gaps = np.isinf(values[order])[1:]
    if f"second_{column}" in found.results:
        second = found[f"second_{column}"][order]
        if np.isfinite(second).any():
            axis.plot(x, second, ".", color=RED, markersize=4, label="second maximum")
            axis.legend()
    if found.quantity == "k_max":
        gaps = gaps | branch_changes(found)[0]
    axis.plot(*(np.insert(part, gaps.nonzero()[0] + 1, np.nan) for part in (x, y)), ".-", color=BLUE, markersize=4)
    _scale(axis, "x", x)
    axis.set_yscale("log" if _spans_decades(y) else "linear")
    edges = cell_edges(x)
    for name, where in doubtful.items():
        for index in where[order].nonzero()[0]:
            axis.axvspan(edges[index], edges[index + 1], facecolor="none", edgecolor=GREY, hatch=HATCHES[name],
                         linewidth=0)
    axis.margins(x=0)
    _set_infinity_apart(axis, "x", values, GREY, 0.6)


def _colours(axis, found, column, label, doubtful):
    y, x = (_places(values) for values in found.axes.values())
    image = mesh(axis, x, y, found[column])
    axis.figure.colorbar(image, ax=axis, label=label)
    for name, where in doubtful.items():
        hatch(axis, x, y, where, HATCHES[name])
    if found.quantity == "k_max":
        jumps(axis, x, y, *branch_changes(found))
    rows, columns = (np.argsort(values, kind="stable")[:np.isfinite(values).sum()] for values in found.axes.values())
    if column == "growth_rate" and image.get_cmap().name == _SIGNED and min(len(rows), len(columns)) > 1:
        axis.contour(x[columns], y[rows], found[column][np.ix_(rows, columns)], levels=[0.0], colors="k",
                     linewidths=0.8)
    for which, values in zip("yx", found.axes.values(), strict=True):
        _set_infinity_apart(axis, which, values, "w", 3.0)


def mesh(axis, x, y, values):
    """Colour the cells around the points of a grid, values (len(y), len(x)); nan stays white. Return the image."""
    from matplotlib.colors import LogNorm, Normalize, SymLogNorm

    known = values[np.isfinite(values)]
    signed = known.size and known.min() < 0 < known.max()
    if signed:
        most = np.abs(known).max()
        norm = SymLogNorm(_LEAST_SHADE * most, vmin=-most, vmax=most) if _spans_decades(np.abs(known)) else \
            Normalize(-most, most)
    else:
        norm = LogNorm() if _spans_decades(known) else Normalize()
    rows, columns = np.argsort(y, kind="stable"), np.argsort(x, kind="stable")
    image = axis.pcolormesh(cell_edges(x[columns]), cell_edges(y[rows]),
                            np.ma.masked_invalid(values[np.ix_(rows, columns)]), norm=norm,
                            cmap=_SIGNED if signed else _RISING, rasterized=True)
    _scale(axis, "x", x)
    _scale(axis, "y", y)
    return image


def _places(values):
    """Where the values are drawn: infinity as far beyond the largest of the others as its cell is wide."""
    finite = np.unique(values[np.isfinite(values)])
    if not len(finite):
        return np.zeros_like(values)
    edge = cell_edges(finite)[-1]
    beyond = edge**2 / finite[-1] if is_logarithmic(finite) else 2 * edge - finite[-1]
    return np.where(np.isinf(values), beyond, values)


def _set_infinity_apart(axes, which, values, color, width):
    """Draw a line before the cell of infinity, which has a tick of its own; the others end there."""
    if not np.isinf(values).any():
        return
    places = np.unique(_places(values))
    low, edge, high = cell_edges(places)[[0, -2, -1]]
    axes.set(**{f"{which}lim": (low, high)})
    {"x": axes.axvline, "y": axes.axhline}[which](edge, color=color, linewidth=width)
    axis = {"x": axes.xaxis, "y": axes.yaxis}[which]
    for minor in (True, False):
        ticks = [tick for tick in axis.get_ticklocs(minor=minor) if low <= tick < edge]
        labels = (axis.get_minor_formatter() if minor else axis.get_major_formatter()).format_ticks(ticks)
        if not minor:
            ticks, labels = [*ticks, places[-1]], [*labels, r"$\infty$"]
        axis.set_ticks(ticks, labels, minor=minor)


def _scale(axes, which, values):
    """Logarithmic where the values are; plain numbers where they span no decades."""
    from matplotlib.ticker import LogLocator, StrMethodFormatter

    if is_logarithmic(values):
        axes.set(**{f"{which}scale": "log"})
        if not _spans_decades(values):
            axis = {"x": axes.xaxis, "y": axes.yaxis}[which]
            axis.set_major_formatter(StrMethodFormatter("{x:g}"))
            axis.set_minor_locator(LogLocator(subs=_FEW if max(values) > 5 * min(values) else _MANY))
            axis.set_minor_formatter(StrMethodFormatter("{x:g}"))


def hatch(axis, x, y, where, pattern, color="k"):
    """Hatch the cells around the points `where` (len(y), len(x)) is true."""
    from matplotlib.collections import PolyCollection

    rows, columns = np.argsort(y, kind="stable"), np.argsort(x, kind="stable")
    right, top = cell_edges(x[columns]), cell_edges(y[rows])
    cells = [[(right[j], top[i]), (right[j + 1], top[i]), (right[j + 1], top[i + 1]), (right[j], top[i + 1])]
             for i, j in np.argwhere(where[np.ix_(rows, columns)])]
    if cells:
        axis.add_collection(PolyCollection(cells, facecolor="none", edgecolor=color, hatch=pattern, linewidth=0),
                            autolim=False)


def jumps(axis, x, y, along_y, along_x, color=RED):
    """Draw the cell edges across which the branch changes: `along_y` (len(y) - 1, len(x)), `along_x` alike."""
    from matplotlib.collections import LineCollection

    right, top = cell_edges(np.sort(x)), cell_edges(np.sort(y))
    across = [[(right[j], top[i + 1]), (right[j + 1], top[i + 1])] for i, j in np.argwhere(along_y)]
    up = [[(right[j + 1], top[i]), (right[j + 1], top[i + 1])] for i, j in np.argwhere(along_x)]
    axis.add_collection(LineCollection(across + up, colors=color, linewidths=1.4, capstyle="projecting"),
                        autolim=False)


def branch_changes(found):
    """For each axis of a map of k_max, between which neighbours k_max jumps to another branch, axes sorted.

    That is where the maximum of one point continues the second maximum of its neighbour better than its first.
    """
    order = np.ix_(*(np.argsort(values, kind="stable") for values in found.axes.values()))
    with np.errstate(invalid="ignore"):
        first, second = (np.log(found[name][order]) for name in ("k_max", "second_k_max"))
        changes = []
        for axis in range(first.ndim):
            (a, b), (c, d) = (_neighbours(values, axis) for values in (first, second))
            near = np.abs(a - b)
            changes.append((np.abs(a - d) < near) | (np.abs(b - c) < near))
    return changes


def _neighbours(values, axis):
    count = values.shape[axis]
    return np.take(values, range(count - 1), axis), np.take(values, range(1, count), axis)


def cell_edges(values):
    """Edges (count + 1,) of cells around sorted values, half-way between them, in the logarithm where that is even."""
    if is_logarithmic(values):
        return np.exp(cell_edges(np.log(values)))
    if len(values) == 1:
        return values[0] + np.array([-0.5, 0.5])
    middle = (values[1:] + values[:-1]) / 2
    return np.concatenate(([2 * values[0] - middle[0]], middle, [2 * values[-1] - middle[-1]]))


def is_logarithmic(values):
    """Whether the steps of the sorted values are more even in the logarithm."""
    values = np.sort(values)
    if len(values) < 3 or values[0] <= 0:
        return False
    return np.ptp(np.diff(np.log(values))) / np.log(values[-1] / values[0]) < \
        np.ptp(np.diff(values)) / (values[-1] - values[0]) * (1 - 1e-9)


def _spans_decades(values):
    known = values[np.isfinite(values)]
    return known.size > 0 and known.min() > 0 and known.max() > _DECADES * known.min()


def _symbol(name):
    return f"${name}$" if len(name) == 1 else name
