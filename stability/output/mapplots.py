"""Figures of grids: lines over one axis, colours over two; jumps between branches drawn, doubtful points hatched.

An infinite value of a parameter is drawn as one more cell, set apart, beside the finite ones.
"""

from typing import Any

import numpy as np

from ..status import is_outgrown, is_settled, is_stable
from .panels import Grid
from .spacing import is_logarithmic, spans_decades
from .style import GREY, RED

HATCHES = {"not resolved": "////", "stable": "..", "outgrown by an internal mode": "xxxx"}
_SIGNED, _RISING = "RdBu_r", "viridis"
_FEW_TICKS, _MANY = (2, 5), (1.5, 2, 3, 5, 7)  # ticks between powers of ten
_LEAST_SHADE = 1e-2  # of the largest: below, colours of signed values are linear


def draw_grid(axis: Any, grid: Grid, line_options: dict[Any, Any]) -> None:
    """Draw a Grid over one or two axes into a matplotlib Axes."""
    if len(grid.axes) == 1:
        _lines(axis, grid, line_options)
    else:
        _colours(axis, grid)
    axis.set(xlabel=grid.x.label, ylabel=grid.y.label)


def states(status: np.ndarray) -> dict[str, np.ndarray]:
    """Which points are to be hatched, {state: array shaped as the status}."""
    settled, stable, outgrown = (np.vectorize(test, otypes=[bool])(status) for test in
                                 (is_settled, is_stable, is_outgrown))
    return dict(zip(HATCHES, (~settled, stable, outgrown), strict=True))


def legend_of(grid: Grid) -> tuple[list[Any], ...]:
    """Handles and labels of what is marked in a figure of grids: doubtful points, and jumps over two axes."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    handles: list[Any] = [Patch(facecolor="none", edgecolor="k", hatch=HATCHES[name], label=name)
                          for name, where in grid.states.items() if where.any()]
    if grid.jumps is not None and len(grid.axes) == 2 and any(part.any() for part in grid.jumps):
        handles.append(Line2D([], [], color=RED, label="jump between branches"))
    return handles, [handle.get_label() for handle in handles]


def _lines(axis: Any, grid: Any, line_options: Any) -> None:
    (_, values), = grid.axes
    y = grid.values
    order = np.argsort(values, kind="stable")
    x, y = _places(values)[order], y[order]
    gaps = np.isinf(values[order])[1:]
    if grid.second is not None and np.isfinite(grid.second).any():
        axis.plot(x, grid.second[order], ".", color=RED, markersize=4, label="second maximum")
    if grid.jumps is not None:
        gaps = gaps | grid.jumps[0]
    style = {"linestyle": "-", "marker": ".", "markersize": 4, **line_options}
    axis.plot(*(np.insert(part, gaps.nonzero()[0] + 1, np.nan) for part in (x, y)), **style)
    _scale(axis, "x", x)
    axis.set_yscale("log" if spans_decades(y) else "linear")
    edges = cell_edges(x)
    for name, where in grid.states.items():
        for index in where[order].nonzero()[0]:
            axis.axvspan(edges[index], edges[index + 1], facecolor="none", edgecolor=GREY, hatch=HATCHES[name],
                         linewidth=0)
    axis.margins(x=0)
    _set_infinity_apart(axis, "x", values, GREY, 0.6)


def _colours(axis: Any, grid: Grid) -> None:
    sides = [values for _, values in grid.axes]
    y, x = (_places(values) for values in sides)
    image = mesh(axis, x, y, grid.values)
    axis.figure.colorbar(image, ax=axis, label=grid.quantity.label)
    for name, where in grid.states.items():
        hatch(axis, x, y, where, HATCHES[name])
    if grid.jumps is not None:
        jumps(axis, x, y, *grid.jumps)
    rows, columns = (np.argsort(values, kind="stable")[:np.isfinite(values).sum()] for values in sides)
    if grid.signed and image.get_cmap().name == _SIGNED and min(len(rows), len(columns)) > 1:
        axis.contour(x[columns], y[rows], grid.values[np.ix_(rows, columns)], levels=[0.0], colors="k",
                     linewidths=0.8)
    for which, values in zip("yx", sides, strict=True):
        _set_infinity_apart(axis, which, values, "w", 3.0)


def mesh(axis: Any, x: np.ndarray, y: np.ndarray, values: np.ndarray) -> Any:
    """Colour the cells around the points of a grid, values (len(y), len(x)); nan stays white. Return the image."""
    from matplotlib.colors import LogNorm, Normalize, SymLogNorm

    known = values[np.isfinite(values)]
    signed = known.size and known.min() < 0 < known.max()
    if signed:
        most = np.abs(known).max()
        norm = SymLogNorm(_LEAST_SHADE * most, vmin=-most, vmax=most) if spans_decades(np.abs(known)) else \
            Normalize(-most, most)
    else:
        norm = LogNorm() if spans_decades(known) else Normalize()
    rows, columns = np.argsort(y, kind="stable"), np.argsort(x, kind="stable")
    image = axis.pcolormesh(cell_edges(x[columns]), cell_edges(y[rows]),
                            np.ma.masked_invalid(values[np.ix_(rows, columns)]), norm=norm,
                            cmap=_SIGNED if signed else _RISING, rasterized=True)
    _scale(axis, "x", x)
    _scale(axis, "y", y)
    return image


def _places(values: np.ndarray) -> np.ndarray:
    """Where the values are drawn: infinity as far beyond the largest of the others as its cell is wide."""
    finite = np.unique(values[np.isfinite(values)])
    if not len(finite):
        return np.zeros_like(values)
    edge = cell_edges(finite)[-1]
    beyond = edge**2 / finite[-1] if is_logarithmic(finite) else 2 * edge - finite[-1]
    return np.where(np.isinf(values), beyond, values)


def _set_infinity_apart(axes: Any, which: str, values: np.ndarray, color: str, width: float) -> None:
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


def _scale(axes: Any, which: str, values: np.ndarray) -> None:
    """Logarithmic where the values are; plain numbers where they span no decades."""
    from matplotlib.ticker import LogLocator, StrMethodFormatter

    if is_logarithmic(values):
        axes.set(**{f"{which}scale": "log"})
        if not spans_decades(values):
            axis = {"x": axes.xaxis, "y": axes.yaxis}[which]
            axis.set_major_formatter(StrMethodFormatter("{x:g}"))
            axis.set_minor_locator(LogLocator(subs=_FEW_TICKS if max(values) > 5 * min(values) else _MANY))
            axis.set_minor_formatter(StrMethodFormatter("{x:g}"))


def hatch(axis: Any, x: np.ndarray, y: np.ndarray, where: np.ndarray, pattern: str, color: str = "k") -> None:
    """Hatch the cells around the points `where` (len(y), len(x)) is true."""
    from matplotlib.collections import PolyCollection

    rows, columns = np.argsort(y, kind="stable"), np.argsort(x, kind="stable")
    right, top = cell_edges(x[columns]), cell_edges(y[rows])
    cells = [[(right[j], top[i]), (right[j + 1], top[i]), (right[j + 1], top[i + 1]), (right[j], top[i + 1])]
             for i, j in np.argwhere(where[np.ix_(rows, columns)])]
    if cells:
        axis.add_collection(PolyCollection(cells, facecolor="none", edgecolor=color, hatch=pattern, linewidth=0),
                            autolim=False)


def jumps(axis: Any, x: Any, y: Any, along_y: Any, along_x: Any, color: Any = RED) -> None:
    """Draw the cell edges across which the branch changes: `along_y` (len(y) - 1, len(x)), `along_x` alike."""
    from matplotlib.collections import LineCollection

    right, top = cell_edges(np.sort(x)), cell_edges(np.sort(y))
    across = [[(right[j], top[i + 1]), (right[j + 1], top[i + 1])] for i, j in np.argwhere(along_y)]
    up = [[(right[j + 1], top[i]), (right[j + 1], top[i + 1])] for i, j in np.argwhere(along_x)]
    axis.add_collection(LineCollection(across + up, colors=color, linewidths=1.4, capstyle="projecting"),
                        autolim=False)


def branch_changes(found: Any) -> list[np.ndarray]:
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


def _neighbours(values: np.ndarray, axis: int) -> tuple[np.ndarray, ...]:
    count = values.shape[axis]
    return np.take(values, range(count - 1), axis), np.take(values, range(1, count), axis)


def cell_edges(values: np.ndarray) -> np.ndarray:
    """Edges (count + 1,) of cells around sorted values, half-way between them, in the logarithm where that is even."""
    if is_logarithmic(values):
        return np.exp(cell_edges(np.log(values)))
    if len(values) == 1:
        return values[0] + np.array([-0.5, 0.5])
    middle = (values[1:] + values[:-1]) / 2
    return np.concatenate(([2 * values[0] - middle[0]], middle, [2 * values[-1] - middle[-1]]))
