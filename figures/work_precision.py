"""Error against time of every method on three eigenvalues: which method for 3, 8 or 13 digits.

Vortices (slope 30 degrees, Fr2 0.1, k 2) and dunes (shields 2, mu1 0.4, b 1, Re 10, k 1) against power series in
30-digit arithmetic, plane Poiseuille flow (Re 1e4, k 1) against a recomputed 24-digit value that agrees with the
published 0.23752649 + 0.00373967 i (Orszag 1971). Errors are relative. Times in the upper row are CPU times per
eigenvalue of a sweep of 201 wavenumbers, everything included; dense solves of textbook collocation gain nothing from a
sweep and are timed alone. The pale curves are those of the compiled kernel, measured where there is a C compiler. The
thin dashed curve is the error that the collocation method itself reports. The lower row asks for a single eigenvalue of
a flow that nothing is known of (full curves), and for one eigenvalue of each flow in a loop over 21 values of a
parameter (dotted curves, time for each): this package by the tolerance asked for, solve_bvp by its residual, even modes
by a Galerkin script, and the packages dmsuite and Dedalus 3 (in the loop by its sparse solver, next to the eigenvalue
before) where they are installed, else as they were measured last (columns machine and versions).
"""

import csv
import os
import platform
import sys
from contextlib import contextmanager, suppress
from dataclasses import replace
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from style import BLUE, GREEN, GREY, ORANGE, RED, main, plt

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))
import competitors  # noqa: E402
import references  # noqa: E402

from stability import dispersion, flows  # noqa: E402
from stability.bvp import problem as bvp  # noqa: E402
from stability.bvp.continuation import continue_in, continue_in_k  # noqa: E402
from stability.flows.wavy_wall import response  # noqa: E402
from stability.modes import memory  # noqa: E402
from stability.numerics.kernel.build import NoKernel, build_kernel  # noqa: E402
from stability.numerics.kernel.library import library  # noqa: E402
from stability.numerics.kernel.place import OFF, SWITCH  # noqa: E402
from stability.numerics.threads import one_thread  # noqa: E402
from stability.studies.compare import Reference, compare, target, timed  # noqa: E402

POISEUILLE = -1j * (0.237526488820470107446579 + 0.00373967062297940993222j)
FLOOR = 2.0**-53  # half a unit in the last place: errors below are drawn there
DIGITS = (3, 8, 13)
PURPLE = "#7d3c98"
LOOPS = {"vortex": ("slope_deg", 20.0, 40.0), "dune": ("shields", 1.5, 2.5), "poiseuille": ("Re", 8e3, 1.2e4)}
VALUES = 21  # of the parameter, the flow itself in the middle
TOLERANCES = (1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12)
RESIDUALS = (1e-3, 1e-4, 1e-5, 1e-6)
PEERS = "dmsuite", "dedalus"
COMPILED = "collocation compiled"
STYLES = {
    "collocation": (BLUE, "o", "collocation, this package"),
    COMPILED: ("#7fb3d5", "o", "collocation, this package with the extra fast"),
    "bvp": (RED, "s", "solve_bvp continuation, this package"),
    "bvp numerical": (RED, "x", "the same, solve_bvp's own numerical Jacobians"),
    "bvp-thesis": (ORANGE, "D", "the thesis's setting of it"),
    "textbook": (GREEN, "^", "textbook collocation in $z$, dense eig"),
    "textbook cut 20": (GREEN, "v", "textbook, fluid cut at $20/k$ instead of $100/k$"),
    "textbook closed-form fluid": (PURPLE, "<", "textbook, this package's closed-form fluid"),
    "textbook delta 1e-2": (GREY, "v", r"textbook, $\delta$ = 10$^{-2}$"),
    "textbook delta 1e-4": (GREY, ">", r"textbook, $\delta$ = 10$^{-4}$"),
    "even Galerkin": (PURPLE, "P", "Galerkin script for even modes"),
    "dmsuite": (ORANGE, "*", "dmsuite (Weideman & Reddy 2000)"),
    "dedalus": (RED, "h", "Dedalus 3 (Burns et al. 2020)"),
}


@one_thread
def compute(fast):
    with TemporaryDirectory() as room, carrier(OFF):
        return measure(fast, kernel_folder(room))


def measure(fast, kernel):
    problems = (("vortices", flows.Vortex(slope_deg=30.0, Fr2=0.1), 2.0, None),
                ("dunes", flows.Dune(shields=2.0, mu1=0.4, b=1.0, Re=10.0), 1.0, None),
                ("plane Poiseuille", flows.Poiseuille(Re=1e4), 1.0, POISEUILLE))
    rows = []
    for panel, flow, k, exact in problems:
        exact = independent(flow, k) if exact is None else exact
        known = Reference(exact, abs(exact) * 1e-16, "multi-precision")
        found = compare(flow, k, ("collocation",) if fast else ("collocation", "bvp", "bvp-thesis"), known=known)
        rows += [(panel, *row) for row in measured(found, exact)]
        if not fast:
            with numerical_jacobians():
                rows += [(panel, "bvp numerical", *row[1:]) for row in measured(compare(flow, k, ("bvp",)), exact)]
        rows += [(panel, *row) for row in textbook(flow, k, exact, 32 if fast else 128)]
        asked = single(flow, k, fast) if exact != POISEUILLE else [*single(flow, k, fast), *scripts(flow, k, fast)]
        rows += [(panel, *row) for row in judged(asked, exact)]
        if kernel:
            with carrier(kernel):
                found = [*measured(compare(flow, k, ("collocation",), known=known), exact),
                         *judged(single(flow, k, True), exact)]
            rows += [(panel, COMPILED, *row[1:]) for row in found]
    names = ("problem", "method", "setting", "error", "reported", "seconds", "unknowns", "question")
    machine = f"{platform.machine()}, one thread, Python {platform.python_version()}"
    versions = ", ".join(f"{name} {installed(name)}" for name in ("granular-stability", "numpy", "scipy"))
    peers = {name: f"{versions}, {name} {installed(name)}" for name in PEERS}
    rows = [(*row, "sweep") if len(row) < len(names) else row for row in rows]
    data = {**dict(zip(names, zip(*rows, strict=True), strict=True)), "machine": [machine] * len(rows),
            "versions": [peers.get(row[1], versions) for row in rows]}
    return {name: [*data[name], *kept] for name, kept in measured_before(data, kernel).items()}


@contextmanager
def carrier(folder):
    """The compiled kernel in a folder, or none."""
    before = os.environ.get(SWITCH)
    os.environ[SWITCH] = str(folder)
    library.cache_clear()
    try:
        yield
    finally:
        os.environ.pop(SWITCH) if before is None else os.environ.update({SWITCH: before})
        library.cache_clear()


def kernel_folder(room):
    """The folder, with the compiled kernel made in it; None where that fails."""
    with carrier(room), suppress(NoKernel):
        build_kernel()
        return room
    return None


def installed(package):
    """Its version, or an empty text."""
    try:
        return version(package)
    except PackageNotFoundError:
        return ""


def measured_before(names, kernel):
    """Columns of the rows of what is not installed, in the file that is there."""
    path = Path(__file__).with_suffix(".csv")
    with open(path, encoding="utf-8", newline="") as file:
        rows = [row for row in csv.DictReader(file) if row["method"] in PEERS and not installed(row["method"]) or
                row["method"] == COMPILED and not kernel]
    return {name: [row[name] for row in rows] for name in names}


def loop(flow):
    """The flows of the loop, this one in their middle, the name of their parameter and its values."""
    name, low, high = LOOPS[flow.name]
    values = np.linspace(low, high, VALUES)
    values[VALUES // 2] = getattr(flow, name)
    return [replace(flow, **{name: float(value)}) for value in values], name, values


def single(flow, k, fast):
    """(method, setting, sigma, error that it reports, seconds, unknowns, question) of this package's own methods."""
    for tolerance in TOLERANCES:
        def alone(one=flow, tolerance=tolerance):
            return dispersion(one, k, tolerance=tolerance, strict=False).modes[0]

        def new(alone=alone):
            memory.forget()
            return alone()

        def each(alone=alone):
            memory.forget()
            return [alone(one) for one in loop(flow)[0]]

        mode, seconds = timed(new)
        modes, whole = timed(each)
        for question, found, time in ("single", mode, seconds), ("loop", modes[VALUES // 2], whole / VALUES):
            yield "collocation", f"tolerance {tolerance:g}", found.sigma, found.error, time, len(found.x), question
    if fast or not flow.has_surface_mode():
        return
    _, name, values = loop(flow)
    for residual in RESIDUALS:
        found, seconds = timed(lambda: continue_in_k(flow, [k], residual=residual))  # noqa: B023
        along, whole = timed(lambda: continue_in(flow, name, values, k, residual=residual))  # noqa: B023
        for question, part, time in ("single", found, seconds), ("loop", along, whole / VALUES):
            point = part.points[0 if question == "single" else VALUES // 2]
            yield "bvp", f"residual {residual:g}", point.sigma, point.error, time, point.nodes, question


def scripts(flow, k, fast):
    """The same of what was written for plane Poiseuille flow alone; dense solves take as long in a loop."""
    for n in (8, 12, 16, 20, 24, 32, 48, 64)[:: 2 if fast else 1]:
        points = [(one.Re, k) for one in loop(flow)[0]]
        found, seconds = timed(lambda: competitors.EvenGalerkin(n).followed([(flow.Re, k)]))  # noqa: B023
        along, whole = timed(lambda: competitors.EvenGalerkin(n).followed(points))  # noqa: B023
        for question, c, time in ("single", found[0], seconds), ("loop", along[VALUES // 2], whole / VALUES):
            yield "even Galerkin", f"n {n}", -1j * k * c, np.nan, time, n, question
    for n in (32, 40, 48, 56, 64, 80, 96)[:: 2 if fast else 1]:
        if installed("dmsuite"):
            values, seconds = timed(lambda: competitors.poiseuille_dmsuite(flow.Re, k, n))  # noqa: B023
            yield "dmsuite", f"n {n}", values, np.nan, seconds, n, "single"
        if installed("dedalus"):
            values, seconds = timed(lambda: competitors.poiseuille_dedalus(flow.Re, k, n))  # noqa: B023
            yield "dedalus", f"n {n}", values, np.nan, seconds, n, "single"
            along, whole = timed(lambda: dedalus_loop(points, n))  # noqa: B023
            yield "dedalus", f"n {n}", along[VALUES // 2], np.nan, whole / VALUES, n, "loop"


def dedalus_loop(points, n):
    """The eigenvalue at each of the points (Re, k), each next to the one before, the first next to the exact one."""
    found = [POISEUILLE]
    for Re, k in points:
        found.append(competitors.poiseuille_dedalus(Re, k, n, found[-1])[0])
    return found[1:]


def judged(found, exact):
    """Rows with the relative error in place of sigma, that of the nearest of several."""
    for method, setting, sigma, reported, *others in found:
        yield method, setting, np.min(np.abs(sigma - exact)) / abs(exact), reported / abs(exact), *others


def independent(flow, k):
    """The eigenvalue by power series in 30-digit arithmetic."""
    parameters = {name: value for name, value in vars(flow).items() if name != "fluid"}
    return complex(getattr(references, flow.name)(**parameters, k=k, guess=target(flow, k).sigma))


def measured(found, exact):
    for one in found.measurements:
        yield (one.method, one.setting, abs(one.sigma - exact) / abs(exact), one.reported / abs(exact), one.seconds,
               one.unknowns)


@contextmanager
def numerical_jacobians():
    """solve_bvp as it is called by default: without the Jacobians of the equations and conditions."""
    original = bvp.solve_bvp

    def plain(*arguments, fun_jac, bc_jac, **options):
        return original(*arguments, **options)

    bvp.solve_bvp = plain
    try:
        yield
    finally:
        bvp.solve_bvp = original


def textbook(flow, k, exact, largest):
    """Rows of the competitors on one flow: method, setting, error, no reported error, seconds, unknowns."""
    if flow.name == "vortex":
        solvers = {name: (lambda n, delta=delta: competitors.vortex(flow.slope_deg, flow.Fr2, k, n, delta), 2)
                   for name, delta in (("textbook", 0.0), ("textbook delta 1e-2", 1e-2), ("textbook delta 1e-4", 1e-4))}
    elif flow.name == "dune":
        bed = flow.shields, flow.mu1, flow.b, flow.Re, k
        solvers = {"textbook": (lambda n: competitors.dune(*bed, n), 4),
                   "textbook cut 20": (lambda n: competitors.dune(*bed, n, cut=20.0), 4),
                   "textbook closed-form fluid": (
                       lambda n: competitors.dune(*bed, n, R=complex(response(k, flow.Re).value)), 2)}
    else:
        solvers = {"textbook": (lambda n: competitors.poiseuille(flow.Re, k, n), 1)}
    for name, (solve, size) in solvers.items():
        for n in (n for n in (8, 12, 16, 24, 32, 48, 64, 96, 128) if n <= largest):
            values, seconds = timed(lambda: solve(n))  # noqa: B023
            error = np.min(np.abs(values - exact)) / abs(exact)
            yield name, f"n {n}", error, np.nan, seconds, size * n


def draw(data):
    panels = list(dict.fromkeys(data["problem"]))
    figure, axes = plt.subplots(2, len(panels), figsize=(9.2, 7.4), sharey=True, sharex=True)
    for upper, lower, panel in zip(*axes, panels, strict=True):
        curves(upper, data, panel, "sweep")
        dense = [name for name in STYLES if name.startswith("textbook")]
        curves(lower, data, panel, "sweep", dense)
        curves(lower, data, panel, "single")
        curves(lower, data, panel, "loop", linestyle=":")
        for axis in (upper, lower):
            for digits in DIGITS:
                axis.axhline(10.0**-digits, color=GREY, linewidth=0.5, linestyle=":", zorder=1)
                if panel == panels[-1]:
                    axis.text(1.02, 10.0**-digits, f"{digits} digits", fontsize=7, color=GREY, va="center",
                              transform=axis.get_yaxis_transform())
        upper.set_title(panel, fontsize=9)
        lower.set_xlabel("CPU seconds per eigenvalue")
    for axis, which in zip(axes[:, 0], ("a sweep over wavenumbers", "one alone; dotted: in a loop over a parameter"),
                           strict=True):
        axis.set(ylabel=r"relative error of $\sigma$" f"\n{which}", ylim=(FLOOR / 3, 3))
    handles = {label: handle for axis in axes.ravel() for handle, label in
               zip(*axis.get_legend_handles_labels(), strict=True)}
    figure.legend(handles.values(), handles.keys(), loc="outside lower center", ncols=3, fontsize=7.5)
    return figure


def curves(axis, data, panel, question, names=tuple(STYLES), linestyle="-"):
    """Draw error against time of the methods of these names."""
    columns = {name: np.array(data[name], dtype=float) for name in ("error", "reported", "seconds")}
    here = (np.array(data["problem"]) == panel) & (np.array(data["question"]) == question)
    for name in names:
        color, marker, label = STYLES[name]
        rows = here & (np.array(data["method"]) == name)
        if not np.any(rows):
            continue
        seconds, error, reported = (columns[key][rows] for key in ("seconds", "error", "reported"))
        axis.loglog(seconds, np.maximum(error, FLOOR), color=color, marker=marker, markersize=3.5, linewidth=1.1,
                    linestyle=linestyle, label=label if linestyle == "-" else None,
                    zorder=3 if name == "collocation" else 2)
        if name == "collocation" and question == "sweep":
            axis.loglog(seconds, np.maximum(reported, FLOOR), "--", color=color, linewidth=0.8,
                        label="error that it reports")


if __name__ == "__main__":
    main(__file__, compute, draw)
