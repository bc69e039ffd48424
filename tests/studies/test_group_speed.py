"""Group speed -Im d sigma/dk of a dispersion relation: against 44 digits, limits, files and figures; with its bar."""

import csv
import json
import os

import mpmath as mp
import numpy as np
import pytest
import references
from matplotlib.figure import Figure
from scipy.io import netcdf_file

from stability import dispersion, flows
from stability.bvp.continuation import continue_in_k
from stability.cli import main

DIGITS = {"digits": 44, "radius": 1e-6}


def vortex(flow, k, sigma):
    return references.vortex(flow.slope_deg, flow.Fr2, k, sigma, **DIGITS)


def dune(flow, k, sigma):
    return references.dune(2.0, 0.4, 1.0, 10.0, mp.mpf(flow.depth), k, sigma, **DIGITS)


def film(flow, k, sigma):
    return references.film(flow.Re, flow.slope_deg, flow.We, k, sigma, **DIGITS)


def poiseuille(flow, k, sigma):
    return references.poiseuille(flow.Re, k, sigma, **DIGITS)


CASES = [(flows.Vortex(Fr2=5.0), 1.0, vortex), (flows.Dune(), 1.0, dune), (flows.Dune(depth=2.0), 0.05, dune),
         (flows.Film(Re=50.0), 0.3, film), (flows.Poiseuille(Re=1e4), 1.0, poiseuille),
         (flows.Poiseuille(Re=123.98407543280724), 2.507, poiseuille)]


def reference(mode, eigenvalue, flow):
    """d sigma/dk as a difference of 44-digit eigenvalues."""
    with mp.workdps(60):
        k, slope, h = mp.mpf(mode.k), mp.mpc(mode.slope), mp.mpf(2)**-40
        ends = [eigenvalue(flow, k * (1 + side * h), mp.mpc(mode.sigma) + side * slope * k * h) for side in (-1, 1)]
        return (ends[1] - ends[0]) / (2 * k * h)


@pytest.mark.parametrize(("flow", "k", "eigenvalue"), CASES, ids=lambda one: getattr(one, "__name__", str(one)))
def test_group_speed_is_that_of_the_reference(flow, k, eigenvalue):
    (mode,) = dispersion(flow, k).modes
    slope = reference(mode, eigenvalue, flow)
    assert abs(mode.group_speed + float(slope.imag)) <= mode.group_error
    assert float(abs(mp.mpc(mode.slope) - slope)) <= mode.group_error
    assert mode.group_error < 1e-7 * abs(mode.slope)


def test_the_bar_knows_of_the_vectors():
    """Refined until the rate is right to rounding, vectors may be wrong by 1e-9, and so is the slope then."""
    flow, k, eigenvalue = CASES[-1]
    (mode,) = dispersion(flow, k).modes
    wrong = float(abs(mp.mpc(mode.slope) - reference(mode, eigenvalue, flow)))
    assert 1000 * mode.slope_error < wrong <= mode.group_error < 100 * wrong


def test_long_waves_on_a_film_travel_at_twice_the_surface_speed():
    """c = 2 - a k^2 and so d(k c)/dk = 2 - 3 a k^2."""
    (row,) = dispersion(flows.Film(), 1e-3)
    assert row["group_speed"] == pytest.approx(2.0, abs=1e-3)
    assert (2 - row["group_speed"]) / (2 - row["phase_speed"]) == pytest.approx(3.0, rel=1e-3)


def test_what_does_not_travel_has_no_group_speed():
    assert dispersion(flows.Vortex(), [0.1, 1.0]).group_speed.tolist() == [0.0, 0.0]


def test_group_speed_is_the_slope_of_the_frequency():
    """omega = k c, from neighbouring phase speeds."""
    relation = dispersion(flows.Dune(), [0.999, 1.0, 1.001])
    omega = relation.k * relation.phase_speed
    assert relation.group_speed[1] == pytest.approx((omega[2] - omega[0]) / 0.002, rel=1e-6)


def test_it_stands_in_every_file_and_in_the_figure(tmp_path):
    for ending in ("csv", "json", "nc"):
        assert main(["dispersion", "dune", "--k", "0.5,1", "-o", str(tmp_path / f"x.{ending}"), "--quiet"]) == 0
    found = dispersion(flows.Dune(), [0.5, 1.0])
    lines = [line for line in (tmp_path / "x.csv").read_text().splitlines() if not line.startswith("#")]
    table, content = list(csv.DictReader(lines)), json.loads((tmp_path / "x.json").read_text())["rows"]
    with netcdf_file(tmp_path / "x.nc", mmap=False) as file:
        for name in ("group_speed", "group_error"):
            values = getattr(found, name).tolist()
            assert [float(row[name]) for row in table] == [row[name] for row in content] == values
            assert file.variables[name][:].tolist() == values
        assert file.variables["group_speed"].scale == b"V"
    axis = found.plot(Figure().add_subplot(), "group_speed")
    assert axis.lines[-1].get_ydata().tolist() == found.group_speed.tolist()
    assert axis.get_ylabel() == "group speed $c_g$"
    (bars,) = [panel.curves[0].y_error for panel in found.panels() if panel.y.name == "group_speed"]
    assert bars.tolist() == found.group_error.tolist()


def test_values_alone_give_none(capsys):
    assert not hasattr(continue_in_k(flows.Vortex(), [1.0]).points[0], "slope")
    assert main(["dispersion", "vortex", "--k", "1", "--method", "bvp", "--json"]) == 0
    assert not {"group_speed", "group_error"} & json.loads(capsys.readouterr().out)["rows"][0].keys()


@pytest.mark.skipif("STABILITY_BRUTE_FORCE" not in os.environ, reason="minutes")
def test_bars_of_random_group_speeds_hold():
    """In more than 99.5 % of the points."""
    rng, inside = np.random.default_rng(11), []
    for _ in range(1000):
        flow = flows.Film(Re=float(np.exp(rng.uniform(-2, 6))), slope_deg=rng.uniform(5, 85)) if len(inside) % 2 else \
            flows.Vortex(slope_deg=rng.uniform(5, 60), Fr2=float(np.exp(rng.uniform(-4, 2))))
        eigenvalue = film if len(inside) % 2 else vortex
        for mode in dispersion(flow, float(np.exp(rng.uniform(-4, 2.5))), strict=False).modes:
            inside.append(abs(mp.mpc(mode.slope) - reference(mode, eigenvalue, flow)) <= mode.group_error)
    assert np.mean(inside) > 0.995
