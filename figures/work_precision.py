"""Error against time of every method on three eigenvalues: which method for 3, 8 or 13 digits.

Vortices (slope 30 degrees, Fr2 0.1, k 2) and dunes (shields 2, mu1 0.4, b 1, Re 10, k 1) against power series in
30-digit arithmetic, plane Poiseuille flow (Re 1e4, k 1) against a recomputed 24-digit value that agrees with the
published 0.23752649 + 0.00373967 i (Orszag 1971). Errors are relative. Times are CPU times per eigenvalue of a sweep
of 201 wavenumbers, everything included; dense solves of textbook collocation gain nothing from a sweep and are timed
alone. The thin dashed curve is the error that the collocation method itself reports. Run time: about 4 minutes on
one core, 20 s with --fast; ratios of times are worth more than times.
"""

import platform
import sys
from contextlib import contextmanager
from importlib.metadata import version
from pathlib import Path

import numpy as np
from style import BLUE, GREEN, GREY, ORANGE, RED, main, plt

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))
import competitors  # noqa: E402
import references  # noqa: E402

from stability import flows
from stability.bvp import problem as bvp
from stability.flows.wavy_wall import response  # noqa: E402
from stability.numerics.threads import one_thread  # noqa: E402
from stability.studies.compare import Reference, compare, target, timed  # noqa: E402

POISEUILLE = -1j * (0.237526488820470107446579 + 0.00373967062297940993222j)
FLOOR = 2.0**-53  # half a unit in the last place: errors below are drawn there
DIGITS = (3, 8, 13)
PURPLE = "#7d3c98"
STYLES = {
    "collocation": (BLUE, "o", "collocation, this package"),
    "bvp": (RED, "s", "solve_bvp continuation, this package"),
    "bvp numerical": (RED, "x", "the same, solve_bvp's own numerical Jacobians"),
    "bvp-thesis": (ORANGE, "D", "the thesis's setting of it"),
    "textbook": (GREEN, "^", "textbook collocation in $z$, dense eig"),
    "textbook cut 20": (GREEN, "v", "textbook, fluid cut at $20/k$ instead of $100/k$"),
    "textbook closed-form fluid": (PURPLE, "<", "textbook, this package's closed-form fluid"),
    "textbook delta 1e-2": (GREY, "v", r"textbook, $\delta$ = 10$^{-2}$"),
    "textbook delta 1e-4": (GREY, ">", r"textbook, $\delta$ = 10$^{-4}$"),
}


@one_thread
def compute(fast):
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
    names = ("problem", "method", "setting", "error", "reported", "seconds", "unknowns")
    machine = f"{platform.machine()}, one thread, Python {platform.python_version()}"
    versions = ", ".join(f"{name} {version(name)}" for name in ("granular-stability", "numpy", "scipy"))
    return {**dict(zip(names, zip(*rows, strict=True), strict=True)),
            "machine": [machine] * len(rows), "versions": [versions] * len(rows)}


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
    problem, method = np.array(data["problem"]), np.array(data["method"])
    columns = {name: np.array(data[name], dtype=float) for name in ("error", "reported", "seconds")}
    panels = list(dict.fromkeys(data["problem"]))
    figure, axes = plt.subplots(1, len(panels), figsize=(9.2, 4.3), sharey=True, sharex=True)
    for axis, panel in zip(axes, panels, strict=True):
        for name, (color, marker, label) in STYLES.items():
            rows = (problem == panel) & (method == name)
            if not np.any(rows):
                continue
            seconds, error, reported = (columns[key][rows] for key in ("seconds", "error", "reported"))
            axis.loglog(seconds, np.maximum(error, FLOOR), color=color, marker=marker, markersize=3.5, linewidth=1.1,
                        label=label, zorder=3 if name == "collocation" else 2)
            if name == "collocation":
                axis.loglog(seconds, np.maximum(reported, FLOOR), "--", color=color, linewidth=0.8,
                            label="error that it reports")
        for digits in DIGITS:
            axis.axhline(10.0**-digits, color=GREY, linewidth=0.5, linestyle=":", zorder=1)
            axis.text(1.0, 10.0**-digits, f"{digits} digits", fontsize=7, color=GREY, ha="right", va="bottom",
                      transform=axis.get_yaxis_transform())
        axis.set_title(panel, fontsize=9)
        axis.set_xlabel("CPU seconds per eigenvalue")
    axes[0].set(ylabel=r"relative error of $\sigma$", ylim=(FLOOR / 3, 3))
    handles = {label: handle for axis in axes for handle, label in zip(*axis.get_legend_handles_labels(), strict=True)}
    figure.legend(handles.values(), handles.keys(), loc="outside lower center", ncols=3, fontsize=7.5)
    return figure


if __name__ == "__main__":
    main(__file__, compute, draw)
