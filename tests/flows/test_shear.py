"""Flows of any velocity: published critical points, error bars against independent computations, edges at infinity."""

import json
import os
import pickle
from dataclasses import replace

import elements
import numpy as np
import pytest
import shear_samples
import sheared
from numpy.polynomial import legendre
from twins import table

from stability import dispersion, flows, k_max, parameter_map, spectrum
from stability.cli import main
from stability.errors import NotResolved, NotSmooth, ParameterError
from stability.flows import stretch
from stability.modes.solver import Solver
from stability.studies.critical import critical
from stability.studies.neutral import neutral_curve

OPEN = {"bottom": "decay", "top": "decay"}
BRUTE_FORCE = bool(os.environ.get("STABILITY_BRUTE_FORCE"))
TABLE = {int(row["seed"]): row for row in table("recomputed_shear")}
SEEDS = list(TABLE) if BRUTE_FORCE else [seed for seed in TABLE if seed % 20 == 0]
SHEAR_LAYER = 0.4366493344311722303  # growth over k of U = tanh z, Re 100, k 0.4, from spectral elements
BLASIUS = 0.36412128993779585930 + 0.0079625053677670986j  # c at Re 998, k 0.308, from a power series
BLASIUS_CRITICAL = 519.0601174518, 0.30377094  # recomputed; 519.4 and 0.303 in print
JET_CRITICAL = 4.0169964458, 0.17277792  # recomputed; 4.02 and 0.17 in print


def run(capsys, *arguments):
    """Status, table as a list of dicts, header and errors of a command."""
    status = main([*arguments, "--json"])
    out, err = capsys.readouterr()
    found = json.loads(out) if out else {"rows": []}
    return status, found.pop("rows"), found, err


def jet(z):
    return 1 / np.cosh(np.clip(z, -300, 300)) ** 2


def solved(flow, k, c):
    return Solver(flow).solve(k, -1j * c, None, 96)


# -- known numbers ---------------------------------------------------------------------------------------


def test_named_velocities_are_those_of_the_flows_that_have_them():
    mine, other = (spectrum(flow, 1.0, 3).sigma for flow in (flows.Shear(Re=1e4), flows.Poiseuille(Re=1e4)))
    np.testing.assert_allclose(mine, other, rtol=1e-12)


def test_blasius_is_the_similarity_solution():
    z = np.linspace(0, 12, 400)
    named = flows.Shear("blasius", top="decay").profile
    for mine, exact in zip((named.U(z), named.dU(z)), sheared.blasius(z)[:2], strict=True):
        np.testing.assert_allclose(mine, exact, atol=4e-15)


def test_unbounded_fluids_against_independent_computations():
    mode = solved(flows.Shear("tanh", **OPEN), 0.4, 0.4363j)
    assert abs(mode.c - 1j * SHEAR_LAYER) <= mode.error / 0.4 < 1e-12
    mode = solved(flows.Shear("blasius", Re=998.0, top="decay"), 0.308, 0.364 + 0.008j)
    assert abs(mode.c - BLASIUS) <= mode.error / 0.308 < 1e-12


def test_upside_down_is_the_same():
    below = solved(flows.Shear("blasius", Re=998.0, top="decay"), 0.308, BLASIUS)
    above = solved(flows.Shear(lambda z: sheared.blasius(-z)[0], Re=998.0, bottom="decay", z_high=0.0), 0.308, BLASIUS)
    assert abs(below.sigma - above.sigma) <= below.error + above.error < 1e-11


def test_critical_point_of_the_boundary_layer(capsys):
    """Against spectral elements: growth at this point is 1e-16."""
    status, (row,), header, err = run(capsys, "critical", "shear", "--profile", "blasius", "--top", "decay", "--vary",
                                      "Re", "--range", "450:600", "--search", "0.25:0.36")
    assert (status, err) == (0, "")
    assert "data_error" not in row
    assert abs(row["Re"] - BLASIUS_CRITICAL[0]) < 1e-8
    assert row["k"] == pytest.approx(BLASIUS_CRITICAL[1], abs=1e-8)
    assert header["parameters"]["profile"] == "blasius"
    sigma = elements.growth(lambda z: sheared.blasius(z)[0], lambda z: sheared.blasius(z)[2], 0, 12, row["Re"],
                            row["k"], -0.1205j, ("wall", "decay"))
    assert abs(sigma.real) < 1e-13


def test_critical_point_of_the_jet():
    point = critical(flows.Shear("bickley", **OPEN), "Re", span=(3.8, 4.3), search=(0.16, 0.19))
    assert abs(point.value - JET_CRITICAL[0]) <= point.error + 5e-11
    assert point.k == pytest.approx(JET_CRITICAL[1], abs=1e-8)
    assert (f"{point.value:.2f}", f"{point.k:.2f}") == ("4.02", "0.17")
    sigma = elements.growth(lambda z: sheared.jet(z)[0], lambda z: sheared.jet(z)[2], -22, 22, point.value, point.k,
                            -0.00749j, ("decay", "decay"))
    assert abs(sigma.real) < 1e-14


def test_the_shear_layer_approaches_its_inviscid_maximum():
    """0.1897 at k 0.4449; the difference falls as 1/Re."""
    found = [k_max(flows.Shear("tanh", Re=Re, **OPEN), search=(0.4, 0.5)) for Re in (500.0, 1000.0, 2000.0)]
    growth = np.array([one.growth_rate for one in found])
    slopes = (growth[1:] - growth[:-1]) / (1 / np.array([1000, 2000]) - 1 / np.array([500, 1000]))
    assert slopes[0] == pytest.approx(slopes[1], rel=0.02)
    assert growth[2] - slopes[1] / 2000 == pytest.approx(0.1897, abs=5e-5)
    assert 2 * found[2].k_max - found[1].k_max == pytest.approx(0.4449, abs=1e-4)


@pytest.mark.parametrize("seed", SEEDS)
def test_error_bars_of_random_velocities(seed):
    row = TABLE[seed]
    flow, k = shear_samples.draw(seed)
    exact = complex(float(row["sigma_real"]), float(row["sigma_imag"]))
    mode = min(spectrum(flow, k, 1, strict=False).modes, key=lambda one: abs(one.sigma - exact))
    assert abs(mode.sigma - exact) <= mode.error + float(row["error"]) + 1e-17
    assert mode.error < 1e-8 * abs(mode.sigma)


def test_a_velocity_that_is_wrong_by_one_percent_is_seen():
    mode = solved(flows.Shear(lambda z: 1.01 * np.tanh(z), **OPEN), 0.4, 0.4363j)
    assert abs(mode.c - 1j * SHEAR_LAYER) > 1e6 * mode.error


# -- cuts ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("flow", "k", "c"), [
    (flows.Shear("bickley", Re=4.02, **OPEN), 0.17, 0.0424), (flows.Shear("tanh", Re=100.0, **OPEN), 0.05, 0.8275j),
    (flows.Shear("blasius", Re=520.0, top="decay"), 0.3, 0.3956)])
def test_twice_as_far_a_cut_changes_nothing_beyond_the_bar(flow, k, c, monkeypatch):
    first = solved(flow, k, c)
    monkeypatch.setattr(stretch, "REACH", 1.9 * stretch.REACH)
    monkeypatch.setattr(stretch, "LEAST", 1.9 * stretch.LEAST)
    flows.shear._base.cache_clear()
    second = solved(flow, k, first.c)
    flows.shear._base.cache_clear()
    assert abs(first.sigma - second.sigma) <= first.error + second.error < 1e-12


@pytest.mark.parametrize("share", [0.05, 0.1, 0.15])
def test_what_a_near_cut_neglects_is_in_the_bar(share, monkeypatch):
    """Too near by far: the bar grows with the error, and is at most a hundred times as large."""
    flow = flows.Shear("bickley", Re=4.02, **OPEN)
    exact = solved(flow, 0.17, 0.0424)
    monkeypatch.setattr(stretch, "REACH", share * stretch.REACH)
    monkeypatch.setattr(stretch, "LEAST", 1.0)
    flows.shear._base.cache_clear()
    near = solved(flow, 0.17, exact.c)
    flows.shear._base.cache_clear()
    wrong = abs(near.sigma - exact.sigma)
    assert 1e-12 < wrong <= near.error + exact.error < 100 * wrong


def test_without_the_share_of_the_cut_the_bar_fails(monkeypatch):
    flow = flows.Shear("bickley", Re=4.02, **OPEN)
    exact = solved(flow, 0.17, 0.0424)
    monkeypatch.setattr(stretch, "REACH", 0.1 * stretch.REACH)
    monkeypatch.setattr(stretch, "LEAST", 1.0)
    monkeypatch.setattr("stability.modes.solver.neglected", lambda *_: 0.0)
    flows.shear._base.cache_clear()
    near = solved(flow, 0.17, exact.c)
    flows.shear._base.cache_clear()
    assert abs(near.sigma - exact.sigma) > 100 * near.error


def test_the_continuous_spectrum_is_no_list_of_modes():
    flow = flows.Shear("tanh", **OPEN)
    found = spectrum(flow, 0.4, 3, strict=False)
    assert found.status == ("resolved",)
    assert "continuous spectrum" in str(found.doubt)
    assert found.notes()
    with pytest.raises(NotResolved, match="1 of 3 modes are found"):
        spectrum(flow, 0.4, 3)


# -- functions, edges ------------------------------------------------------------------------------------


def test_functions_are_as_good_as_names():
    named, given = (solved(flows.Shear(one, Re=50.0, **OPEN), 0.6, 0.32 + 0.2j) for one in ("bickley", jet))
    assert abs(named.sigma - given.sigma) <= named.error + given.error < 1e-12


def test_free_edges_are_lids_without_stress():
    """The shear layer between lids at -10 and 10, in the table of `sheared`."""
    (row,) = [row for row in table("recomputed_base_flows") if row["flow"] == "shear_layer"]
    flow = flows.Shear("tanh", Re=float(row["Re"]), bottom="free", top="free", z_low=-10.0, z_high=10.0)
    mode = solved(flow, float(row["k"]), 0.4363j)
    assert abs(mode.c - complex(float(row["c_real"]), float(row["c_imag"]))) <= mode.error / mode.k < 1e-12


def test_it_is_a_value():
    flow = flows.Shear(jet, Re=50.0, **OPEN)
    again = pickle.loads(pickle.dumps(flow))
    assert (again, hash(again)) == (flow, hash(flow))
    assert flow != replace(flow, Re=60.0)
    assert replace(flow, Re=60.0).profile is flow.profile
    with pytest.raises(ParameterError, match="cannot be sent to other processes"):
        pickle.dumps(flows.Shear(lambda z: jet(z), **OPEN))


def test_functions_are_told_apart_by_their_values():
    texts = {flows.Shear(one, **OPEN).stated()["profile"] for one in (jet, lambda z: jet(z), lambda z: 2 * jet(z))}
    assert len({text.partition("(")[2] for text in texts}) == 2


@pytest.mark.parametrize(("arguments", "message"), [
    ({"profile": "tanh"}, "bottom must be decay, or its height given: 'tanh' has no edge there"),
    ({"profile": "tanh", "z_low": -1, "z_high": -2}, "z_low must be below z_high"),
    ({"profile": "poiseuille", "top": "decay"}, "top = decay: poiseuille has a wall or a free edge there"),
    ({"profile": "blasius", "bottom": "decay", "top": "decay"}, "bottom = decay: blasius has a wall"),
    ({"profile": "blasius", "top": "decay", "z_low": -1}, r"z_low must lie in \[0, inf\] for 'blasius'"),
    ({"profile": "tanh", "top": "decay", "bottom": "decay", "z_high": 3}, "z_high = 3, but top = decay"),
    ({"profile": np.sin, "top": "decay", "z_low": 0}, "U does not reach a limit"),
    ({"profile": np.exp, "top": "decay", "z_low": 0}, "U does not reach a limit"),
    ({"profile": lambda z: 1.0, "z_low": 0, "z_high": 1}, "must return a real number for each"),
    ({"profile": lambda z: z / None, "z_low": 0, "z_high": 1}, "fails for an array of .* TypeError"),
    ({"profile": 3.0}, "must be one of poiseuille, bickley, tanh, blasius, the path of a CSV file"),
    ({"profile": "bickly"}, r"cannot be read: No such file or directory \(did you mean 'bickley'\?\)"),
    ({"top": "open"}, "top must be one of wall, free, decay"),
    ({"z_low": "x"}, r"z_low must be a number in \[-inf, inf\]"),
    ({"profile": ([0, 1], [0, 1])}, "a table needs 8"),
])
def test_bad_input(arguments, message):
    with pytest.raises(ParameterError, match=message) as refusal:
        flows.Shear(**arguments)
    assert "\n" not in str(refusal.value)


def test_rough_functions_are_refused():
    with pytest.raises(NotSmooth, match="U is not smooth near z = "):
        spectrum(flows.Shear(np.abs, z_low=-1.0, z_high=1.2), 1.0)
    with pytest.raises(NotSmooth, match="U is nan near z = "):
        spectrum(flows.Shear(lambda z: np.where(np.abs(z) < 0.1, np.nan, z), z_low=-1.0, z_high=1.0), 1.0)


# -- the response to the base flow -----------------------------------------------------------------------


def integral(mode, change, low, high, count=400):
    x, weights = legendre.leggauss(count)
    z = low + (high - low) * (x + 1) / 2
    return complex((mode.base_flow_sensitivity(z) * change(z)) @ weights) * (high - low) / 2


@pytest.mark.parametrize(("flow", "low", "high"), [
    (flows.Poiseuille(Re=3000.0), -1, 1), (flows.Couette(Re=200.0), -1, 1), (flows.Shear(Re=3000.0), -1, 1),
    (flows.Shear("bickley", Re=50.0, **OPEN), -20, 20)], ids=["poiseuille", "couette", "shear", "jet"])
def test_a_moving_frame_shifts_the_wave_speed(flow, low, high):
    """delta U = 1: delta sigma = -i k."""
    mode = spectrum(flow, 0.9, 1).modes[0]
    assert abs(integral(mode, np.ones_like, low, high) + 0.9j) < 1e-9


@pytest.mark.parametrize("change", [jet, lambda z: np.exp(-((z - 1) ** 2)), lambda z: (z + 0.3) * jet(z)])
def test_the_response_is_the_difference_of_two_flows(change):
    size, k = 1e-4, 0.6
    walls = {"z_low": -3.0, "z_high": 3.0, "Re": 50.0}
    mode = spectrum(flows.Shear("bickley", **walls), k, 1).modes[0]
    low, high = (solved(flows.Shear(lambda z, a=a: jet(z) + a * change(z), **walls), k, mode.c).sigma
                 for a in (-size, size))
    difference = (high - low) / (2 * size)
    assert abs(integral(mode, change, -3, 3) - difference) < 1e-7 * abs(difference)
    assert abs(integral(mode, lambda z: 1.01 * change(z), -3, 3) - difference) > 1e-3 * abs(difference)


def test_the_response_holds_where_the_fluid_is_unbounded():
    """U times 1 + a, against the difference of two flows of other Reynolds numbers."""
    k, size = 0.6, 1e-4
    mode = spectrum(flows.Shear("bickley", Re=50.0, **OPEN), k, 1).modes[0]
    two = [(1 + a) * solved(flows.Shear("bickley", Re=50.0 * (1 + a), **OPEN), k, mode.c).sigma for a in (-size, size)]
    assert abs(integral(mode, jet, -20, 20) - (two[1] - two[0]) / (2 * size)) < 1e-7


def test_the_response_is_even_where_the_flow_is():
    z = np.array([[-0.7, 0.7], [-0.2, 0.2]])
    S = spectrum(flows.Poiseuille(Re=3000.0), 1.0, 1).modes[0].base_flow_sensitivity(z)
    np.testing.assert_allclose(S[:, 0], S[:, 1], rtol=1e-12)
    whole = spectrum(flows.Shear(Re=3000.0), 1.0, 1).modes[0].base_flow_sensitivity(z)
    np.testing.assert_allclose(S, whole, rtol=1e-8)


@pytest.mark.parametrize(("flow", "message"), [
    (flows.Film(), "conditions at a displaced surface"), (flows.Dune(), "conditions at a displaced surface"),
    (flows.Vortex(), "conditions at a displaced surface")])
def test_the_response_is_refused_where_U_enters_otherwise(flow, message):
    with pytest.raises(ParameterError, match=message):
        spectrum(flow, 1.0, 1).modes[0].base_flow_sensitivity(0.5)


def test_the_response_is_refused_outside_and_drawn():
    from matplotlib.figure import Figure

    mode = spectrum(flows.Shear("blasius", Re=600.0, top="decay"), 0.3, 1).modes[0]
    with pytest.raises(ParameterError, match="z must lie in the layers"):
        mode.base_flow_sensitivity(-0.1)
    axis = mode.plot_base_flow_sensitivity(Figure().subplots())
    assert [line.get_label() for line in axis.get_lines()[1:3]] == ["growth rate", "frequency"]
    assert axis.get_lines()[1].get_ydata().max() < 20


# -- the verbs -------------------------------------------------------------------------------------------


def test_all_verbs_know_it(capsys, tmp_path):
    commands = [["dispersion", "shear", "--k", "0.5,1"], ["spectrum", "shear", "--k", "1", "--modes", "3"],
                ["kmax", "shear", "--Re", "1e4", "--search", "0.9:1.1"], ["sensitivity", "shear", "--k", "1"],
                ["neutral", "shear", "--vary", "Re", "--k", "1", "--range", "5000:7000"]]
    for command in commands:
        status, rows, header, err = run(capsys, *command)
        assert (status, err, header["parameters"]["profile"]) == (0, "", "poiseuille"), command
        assert all("data_error" not in row for row in rows)
    assert main(["map", "shear", "--over", "Re=100,200", "--k", "1", "-o", str(tmp_path / "map.csv"), "--quiet"]) == 0
    assert "data_error" not in (tmp_path / "map.csv").read_text()


def test_neutral_values_at_a_wavenumber_are_those_of_poiseuille():
    mine, other = (neutral_curve(flow, "Re", 1.0, span=(5000, 7000)).points[0] for flow in
                   (flows.Shear(), flows.Poiseuille()))
    assert abs(mine.value - other.value) <= mine.error + other.error


def test_sweeps_leave_out_what_is_no_number(capsys):
    assert main(["kmax", "shear", "--over", "profile=1,2"]) == 2
    assert "shear has no parameter 'profile'" in capsys.readouterr().err
    with pytest.raises(ParameterError, match="no numeric parameter 'top' to vary; it has Re, z_low, z_high"):
        critical(flows.Shear(), "top")


def test_maps_share_it_among_processes():
    found = parameter_map(flows.Shear(np.cos, z_low=-1.0, z_high=1.0), {"Re": [20.0, 40.0]}, k=[0.5], workers=2)
    alone = dispersion(flows.Shear(np.cos, Re=40.0, z_low=-1.0, z_high=1.0), 0.5)
    assert found["growth_rate"][1, 0] == alone.growth_rate[0]
