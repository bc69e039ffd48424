"""Answers that claim more than one eigenvalue: the fastest of all waves, all neutral values, complete lists.

Against values by Taylor shooting in ball arithmetic (all digits given are good), against multi-precision references and
against `bruteforce.py`, an implementation that shares nothing with the package.
"""

import csv
import os
from collections import defaultdict
from dataclasses import fields, replace
from pathlib import Path

import mpmath as mp
import numpy as np
import pytest
import references
from twins import table

from stability import NotResolved, dispersion, flows, k_max, spectrum
from stability.flows import FLOWS
from stability.modes import dense, listing
from stability.modes.accuracy import Accuracy
from stability.modes.solver import Solver
from stability.modes.surface import surface_branch
from stability.studies.critical import critical
from stability.studies.neutral import neutral_curve
from stability.studies.plane import Plane

FILM, TWO = flows.Film, flows.TwoLayerCouette
THIN = FILM(Re=8500.0, slope_deg=1 / 120)  # a nearly horizontal film: its shear mode grows first

FASTEST = [
    (TWO(viscosity_ratio=0.3, depth_ratio=0.6, density_ratio=3.0, tension=0.1, Re=200.0), 1.44251169302539820,
     0.0163795545896191067),
    (THIN, 2.86080312333323103, 1.66972369613340542e-4),
    (FILM(Re=10000.0, slope_deg=1.0), 0.9694334387601672, 0.0042986799494699),
]


@pytest.mark.parametrize(("flow", "k", "growth"), FASTEST, ids=str)
def test_the_fastest_wave_is_the_fastest_of_all_modes(flow, k, growth):
    best = k_max(flow)
    assert abs(best.k_max - k) <= best.error < 1e-10
    assert abs(best.growth_rate - growth) <= best.maxima[0].mode.error + 1e-16


def test_a_surface_maximum_has_a_bar_that_holds():
    """Of the film at Re 10000 and 1 degree; a bracket that is narrowed from one side only never gets there."""
    surface = next(one for one in k_max(FILM(Re=10000.0, slope_deg=1.0)).maxima if one.k < 0.6)
    assert abs(surface.k - 0.5016668443015915) <= surface.error < 1e-10


@pytest.mark.parametrize(("flow", "k", "growth"), [
    (TWO(viscosity_ratio=0.3, density_ratio=2.0, Re=1000.0), 41.53, 0.0391415),
    (TWO(viscosity_ratio=0.3, density_ratio=3.0, Re=300.0), 28.2, 0.0396494),
    (TWO(viscosity_ratio=0.3, density_ratio=3.0, Re=1000.0), 50.4, 0.0396812),
    (TWO(viscosity_ratio=0.5, density_ratio=2.0, Re=1000.0), 41.5, 0.0198562),
    (TWO(viscosity_ratio=0.038489146353539366, depth_ratio=4.046690310318767, Re=4105.985859493489), 28.69, 0.01466),
    (FILM(slope_deg=0.006, Re=11000.0), 2.95, 3.758e-4),
    (flows.Dune(shields=1.02, Re=1e-8), 1.59e-4, 7.095e-13),
    (TWO(viscosity_ratio=0.5, density_ratio=3.0, Re=1000.0, depth_ratio=0.11), 80.0, 0.052),
], ids=str)
def test_growth_that_was_overlooked(flow, k, growth):
    """Dense values at a wavenumber near the maximum: short waves, shear modes, a second viscous regime."""
    best = k_max(flow)
    assert best.growth_rate >= growth * (1 - 1e-3)
    assert best.k_max == pytest.approx(k, rel=0.1)


def test_a_maximum_outside_of_the_search_is_no_answer():
    with pytest.raises(NotResolved, match=r"growth is larger at k = 0\.849202, outside of the search"):
        k_max(flows.Dune(), (1.0, 1.0001))
    inside = k_max(flows.Dune(), (0.5, 1.0))
    assert inside.k_max == pytest.approx(0.8492020357, abs=1e-10)


def test_a_message_does_not_say_no_waves_where_it_means_one_mode():
    assert "the surface mode does not grow" in k_max(THIN, mode="surface", strict=False).status
    assert k_max(THIN, mode="surface", strict=False).maxima == ()
    with pytest.raises(NotResolved, match="no waves grow"):
        k_max(flows.Poiseuille(Re=5000.0))


def test_flows_without_a_surface_mode_have_a_fastest_wave():
    """Plane Poiseuille flow at Re 1e4: no wave on a fine scan of the whole spectrum is faster."""
    best = k_max(flows.Poiseuille())
    scan = max(spectrum(flows.Poiseuille(), k, 1).growth_rate[0] for k in np.linspace(0.7, 1.15, 46))
    assert best.growth_rate >= scan
    assert scan == pytest.approx(best.growth_rate, rel=1e-3)


ZEROS = [
    (replace(THIN, Re=10000.0), "Re", 8370.097174989859180, 2.892371613947937515),
    (replace(THIN, Re=3.0), "Re", 8370.097174989859180, 2.892371613947937515),
    (TWO(viscosity_ratio=0.29, depth_ratio=0.67, density_ratio=2.28, gravity=1.0, tension=0.1, Re=4000.0), "Re",
     3512.48761647507009, 2.393077746149276),
    (FILM(slope_deg=0.1), "Re", 716.1812609, 0.00276),
]


@pytest.mark.parametrize(("flow", "vary", "value", "k"), ZEROS, ids=str)
def test_critical_values_do_not_depend_on_the_value_of_the_flow(flow, vary, value, k):
    point = critical(flow, vary)
    assert abs(point.value - value) <= point.error + 0.5e-7 * (k < 0.01)
    assert abs(point.k - k) <= point.k_error + 0.5e-5 * (k < 0.01)
    assert all(other.status.endswith("inside") for other in point.others)


def test_long_waves_of_a_nearly_horizontal_film():
    """Infinitely long ones from 1.25 cot(slope) on (Yih 1963, Benjamin 1957), very long ones a little before."""
    point = critical(FILM(slope_deg=0.01, Re=3000.0), "Re")
    threshold = next(other for other in point.others if other.k == 0)
    assert threshold.value == pytest.approx(1.25 * FILM(slope_deg=0.01).cot_slope, rel=1e-11)
    assert threshold.value - 1 < point.value < threshold.value
    assert critical(FILM(slope_deg=0.01), "Re", long_wave=True).value == pytest.approx(threshold.value, rel=1e-11)


def test_unstable_on_both_sides_is_not_critical():
    """Waves of k 38 .. 150 grow at every depth ratio; crests cross zero at 0.127 and elsewhere all the same."""
    flow = TWO(viscosity_ratio=0.5, density_ratio=3.0, Re=1000.0)
    point = critical(flow, "depth_ratio", span=(0.08, 0.2), strict=False)
    assert point.value is None
    assert "unstable at every depth_ratio from 0.08 to 0.2" in point.status
    assert any(other.value == pytest.approx(0.12704870176, rel=1e-9) for other in point.others)


def test_stable_names_ranges_and_modes():
    with pytest.raises(NotResolved, match="stable at every Re from 10 to 100, k from 0.5 to 2, all modes"):
        critical(flows.Poiseuille(), "Re", span=(10.0, 100.0), search=(0.5, 2.0))


def test_all_branches_at_one_wavenumber_whatever_else_is_asked():
    alone = neutral_curve(flows.Poiseuille(), "Re", 0.9).points
    among = [point for point in neutral_curve(flows.Poiseuille(), "Re", [0.9, 1.05, 1.2]).points if point.k == 0.9]
    assert [point.value for point in alone] == [point.value for point in among]
    assert [round(point.value, 2) for point in alone] == [6965.26, 77841.68]
    film = neutral_curve(replace(THIN, Re=8000.0), "Re", 2.5, span=(5e3, 2e4)).points
    assert any(abs(point.value - 9587.34903586459969) <= point.error for point in film)


# Lists

WALL = 0.04879177482725466775895 - 0.01487702371164566346842j, 0.04879177482725466764710 - 0.01487702371164566352263j
LISTED = [
    (1e5, 20.0, 14, [0.9879750882528796116379 - 0.0119116114812347218j]),
    (1e5, 20.0, 30, WALL),
    (1e4, 12.0, 14, [0.1188259156143299693723 - 0.0392965179382484329j,
                     0.1188259156082221327155 - 0.0392965179403242382j]),
]


@pytest.mark.parametrize(("Re", "k", "count", "speeds"), LISTED)
def test_lists_have_every_mode_as_often_as_it_is_there(Re, k, count, speeds):
    """Even and odd modes of plane Poiseuille flow far closer to each other than 1e-9, and many bars apart."""
    found = spectrum(flows.Poiseuille(Re=Re), k, count, strict=False)
    for speed in speeds:
        nearest = min(found.modes, key=lambda mode: abs(mode.c - speed))
        assert abs(nearest.c - speed) <= nearest.error / k
    assert sum(abs(mode.c - speeds[0]) < 1e-9 for mode in found.modes) == len(speeds)


def test_fewer_modes_than_asked_for_are_not_given_without_a_word():
    """Rounding does not leave 40 modes of plane Couette flow at Re 1e4 that can be told apart."""
    found = spectrum(flows.Couette(Re=1e4), 1.0, 40, strict=False)
    assert len(found.modes) < 40
    assert found.status[-1] != "resolved"
    assert any(f"{len(found.modes)} of 40 modes are found" in note for note in found.notes())
    with pytest.raises(NotResolved):
        spectrum(flows.Couette(Re=1e4), 1.0, 40)


def test_a_mode_that_the_dense_solver_drops_is_missed(monkeypatch):
    """At every degree alike, so that two degrees agree: the determinant counts one more."""
    def drop(solver, degree, symbols, complete=dense.finite_rates):
        return np.delete(complete(solver, degree, symbols), 2)

    monkeypatch.setattr(listing, "finite_rates", drop)
    found = spectrum(flows.Film(), 1.0, 6, strict=False)
    assert all("the determinant counts +1" in status for status in found.status)


def test_a_mode_that_the_dense_solver_doubles_is_noticed(monkeypatch):
    def double(solver, degree, symbols, complete=dense.finite_rates):
        rates = complete(solver, degree, symbols)
        return np.insert(rates, 2, rates[2] * (1 + 1e-9))

    monkeypatch.setattr(listing, "finite_rates", double)
    found = spectrum(flows.Film(), 1.0, 6, strict=False)
    assert all(status.startswith("others may be missing") for status in found.status)
    assert len({mode.sigma for mode in found.modes}) == len(found.modes)


# Against brute force

SHARE = int(os.environ.get("STABILITY_BRUTE_FORCE", "8"))  # every so many-th case; 1: all of them
PARAMETERS = ("slope_deg", "Re", "We", "Fr2", "viscosity_ratio", "depth_ratio", "density_ratio", "gravity", "tension")


def flow_of(row):
    return FLOWS[row["flow"]](**{name: float(row[name]) for name in PARAMETERS if row[name]})


def sampled(name):
    cases = defaultdict(list)
    for row in table(name):
        cases[row["flow"], row["case"]].append(row)
    chosen = list(cases.items())[::SHARE]
    return [pytest.param(rows, id=" ".join(key)) for key, rows in chosen]


@pytest.mark.parametrize("rows", sampled("bruteforce_kmax"))
def test_fastest_waves_by_brute_force(rows):
    (row,) = rows
    best = k_max(flow_of(row), strict=False)
    if row["status"] == "stable":  # on k >= 1e-3
        assert best.status.startswith("stable: no waves grow") or best.maxima[0].k < 1e-3
        return
    size = abs(complex(float(row["growth_rate"]), float(row["frequency"])))
    assert best.status == "resolved"
    assert best.growth_rate == pytest.approx(float(row["growth_rate"]), abs=1e-10 * size + 10 * float(row["error"]))
    assert best.k_max == pytest.approx(float(row["k_max"]), rel=1e-4)


@pytest.mark.parametrize("rows", sampled("bruteforce_critical")[::2 if SHARE > 1 else 1])
def test_critical_values_by_brute_force(rows):
    first = rows[0]
    span = float(first["low"]), float(first["high"])
    found = critical(flow_of(first), first["vary"], span=span, search=(1e-2, 100.0), strict=False)
    ours = sorted(point.value for point in (found, *found.others)
                  if point.value is not None and not point.status.endswith("inside"))
    values = sorted(float(row["value"]) for row in rows if row["value"])
    assert ours == pytest.approx(values, rel=1e-7)
    assert values or first["status"] in found.status


@pytest.mark.parametrize("rows", sampled("bruteforce_spectrum"))
def test_lists_by_brute_force(rows):
    """One to one down to where the shorter of the two lists ends; brute force keeps fewer digits than its bars say."""
    kept = defaultdict(list)
    for row in rows:
        kept[row["parity"]].append((complex(float(row["growth_rate"]), float(row["frequency"])), float(row["error"])))
    floor = max(min(sigma.real for sigma, _ in modes) for modes in kept.values())
    known = [one for modes in kept.values() for one in modes]
    found = spectrum(flow_of(rows[0]), float(rows[0]["k"]), 20, strict=False)
    sure = [mode for mode, status in zip(found.modes, found.status, strict=True) if not status.startswith("others")]
    lowest = max([floor, min((mode.growth_rate for mode in sure), default=np.inf)])

    def near(mode, sigma, error):
        return abs(mode.sigma - sigma) <= mode.error + 1e3 * error + 1e-9 * abs(sigma)

    for mode in sure:
        assert mode.growth_rate < floor or any(near(mode, *one) for one in known)
    for sigma, error in known:
        clearly = sigma.real > lowest + 1e3 * error + 1e-9 * abs(sigma)
        assert not clearly or any(near(mode, sigma, error) for mode in sure)
    assert len({mode.sigma for mode in sure}) == len(sure)


# Bars

@pytest.mark.parametrize("seed", range(3))
def test_bars_of_k_max_hold(seed):
    """The slope of the growth rate at k_max by a difference in 32 digits, over the curvature, is within the bar."""
    rng = np.random.default_rng(seed)
    for flow in (FILM(Re=float(np.exp(rng.uniform(3, 9))), slope_deg=rng.uniform(1, 80)),
                 TWO(viscosity_ratio=float(np.exp(rng.uniform(-2, 2))), density_ratio=rng.uniform(1, 4), Re=200.0,
                     tension=0.01),
                 flows.Dune(shields=rng.uniform(1.2, 3), Re=float(np.exp(rng.uniform(-2, 5)))),
                 flows.Poiseuille(Re=rng.uniform(6e3, 3e4))):
        for one in k_max(flow, strict=False).maxima[:2]:
            assert abs(_offset(flow, one)) <= one.error <= 1e-8 * one.k


def _offset(flow, one):
    parameters = {item.name: getattr(flow, item.name) for item in fields(flow) if item.name != "fluid"}
    mp.mp.dps = 50
    k = mp.mpf(one.k)
    h = k * mp.mpf(2) ** -16
    growth = [getattr(references, flow.name)(**parameters, k=k + j * h, guess=one.mode.sigma, digits=32).real
              for j in (-2, -1, 0, 1, 2)]
    slope = (growth[0] - 8 * growth[1] + 8 * growth[3] - growth[4]) / (12 * h)
    return float(slope * h**2 / (growth[1] - 2 * growth[2] + growth[3]))


@pytest.mark.parametrize(("flow", "k"), [(flows.Vortex(), 2.0), (flows.Dune(), 1.0), (FILM(), 1.0), (TWO(), 1.0),
                                         (flows.RollWave(), 0.5), (flows.Poiseuille(), 1.0)], ids=str)
def test_asking_for_more_never_gives_less(flow, k):
    """Errors and bars do not rise as the tolerance falls or the largest degree rises, but for rounding."""
    exact = dispersion(flow, k, tolerance=1e-13, strict=False)
    sigma, rounding = exact.sigma[0], 4 * exact.error[0]
    looser = np.inf, np.inf
    for tolerance in (1e-2, 1e-4, 1e-6, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13):
        found = dispersion(flow, k, tolerance=tolerance, strict=False)
        now = abs(found.sigma[0] - sigma), found.error[0]
        assert now[0] <= looser[0] + rounding
        assert now[1] <= looser[1] + rounding
        looser = now
    degrees = [spectrum(flow, k, 1, max_degree=degree, strict=False).error[0] for degree in (48, 96, 192)]
    assert degrees[1] <= degrees[0] + rounding
    assert degrees[2] <= degrees[1] + rounding


def test_without_the_overlap_a_walk_would_jump(monkeypatch):
    """The check of slopes switched off: the overlap alone keeps to the mode, and without it another one is reached."""
    flow = flows.Dune(shields=9.65, Re=0.25)
    right = dispersion(flow, 8.1).sigma[0]
    monkeypatch.setattr("stability.modes.tracking._BEND", 1e9)
    assert dispersion(flow, 8.1).sigma[0] == pytest.approx(right, rel=1e-9)
    monkeypatch.setattr("stability.modes.tracking._OVERLAP", 1e9)
    assert abs(dispersion(flow, 8.1).sigma[0] - right) > 1e-3 * abs(right)


def test_without_the_overlap_a_move_in_a_parameter_would_jump(monkeypatch):
    """Two modes of plane Poiseuille flow, from Re 1e4 to 20 at once, arrive as one unless each keeps to itself."""
    plane = Plane(flows.Poiseuille(), "Re", Accuracy())
    first, second = (plane.point(1.0, 1e4, plane.solver(1e4).solve(1.0, rate, None, 96))
                     for rate in (-0.03518658 - 0.96464251j, -0.06325157 - 0.93635178j))
    assert abs(plane.move(first, 1.0, 20.0).mode.sigma - plane.move(second, 1.0, 20.0).mode.sigma) > 1
    monkeypatch.setattr("stability.studies.plane._OVERLAP", 1e9)
    assert abs(plane.move(first, 1.0, 20.0).mode.sigma - plane.move(second, 1.0, 20.0).mode.sigma) < 1e-9


def test_nodes_of_a_branch_do_not_depend_on_what_is_asked():
    branches = [surface_branch(Solver(flows.Dune())) for _ in range(2)]
    branches[0].at([0.3, 0.5])
    for branch in branches:
        branch.reach(2.0)
    assert [node.k for part in branches[0].segments for node in part] == \
        [node.k for part in branches[1].segments for node in part]


def test_the_tables_are_those_of_the_program():
    """Each table says by which command it was made, and holds as many cases."""
    counts = {"kmax": 200, "critical": 208, "spectrum": 150}
    folder = Path(__file__).parents[1] / "tables"
    for kind, count in counts.items():
        text = (folder / f"bruteforce_{kind}.csv").read_text(encoding="utf-8")
        assert f"tests/bruteforce.py {kind}" in text.splitlines()[0]
        rows = csv.DictReader(line for line in text.splitlines() if not line.startswith("#"))
        assert len({(row["flow"], row["case"]) for row in rows}) == count
