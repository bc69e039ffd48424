"""Continuation by solve_bvp against collocation, power series and asymptotics."""

import json
from math import radians, tan

import numpy as np
import pytest
import references

from stability import dispersion, flows, k_max
from stability.bvp import continuation
from stability.bvp.continuation import (
    bounded_maximum,
    continue_in,
    continue_in_k,
)
from stability.bvp.thesis import RegularisedVortex, thesis_setting
from stability.cli import main
from stability.equations.layer import Layer
from stability.errors import NotResolved, ParameterError
from stability.numerics.walker import Pace

WAVENUMBERS = np.geomspace(1e-2, 5, 4)
GIVEN_UP = {"vortex": 12, "dune": 4}  # of 80 points each, with the seed below


def random_flow(name, rng):
    if name == "vortex":
        return flows.Vortex(slope_deg=rng.uniform(15, 45), Fr2=10 ** rng.uniform(-2, 1))
    return flows.Dune(shields=1 + 10 ** rng.uniform(-1, 0.5), mu1=rng.uniform(0.2, 0.7), b=10 ** rng.uniform(-0.5, 0.5),
                      Re=10 ** rng.uniform(-1, 3), depth=rng.choice([np.inf, 3.0, 30.0]))


@pytest.mark.parametrize("name", ["vortex", "dune"])
def test_both_methods_agree_at_random_parameters(name):
    """To 1e-8 at 20 sets each; the points where bvp gives up are few, say why, and never in between."""
    rng = np.random.default_rng(3)
    lost = 0
    for _ in range(20):
        flow = random_flow(name, rng)
        found = continue_in_k(flow, WAVENUMBERS, tolerance=1e-9)
        exact = dispersion(flow, WAVENUMBERS, strict=False)
        known = dict(zip(exact.k, exact.sigma, strict=True))
        for point in found.points:
            assert point.status == "resolved"
            assert abs(point.sigma - known[point.k]) < 1e-8 * abs(point.sigma), (flow, point.k)
        assert [*(point.k for point in found.points), *found.lost] == WAVENUMBERS.tolist()
        assert all("bvp gives up after k = " in reason for reason in found.lost.values())
        if name == "vortex":
            assert bool(found.lost) == bool(exact.collisions)
        lost += len(found.lost)
    assert lost <= GIVEN_UP[name]


@pytest.mark.parametrize(("flow", "k", "reference"), [
    (flows.Vortex(slope_deg=30.0, Fr2=0.1), 2.0, references.vortex),
    (flows.Dune(shields=2.0, mu1=0.4, b=1.0, Re=10.0), 1.0, references.dune),
])
def test_error_bar_holds_at_every_tolerance(flow, k, reference):
    parameters = {name: value for name, value in vars(flow).items() if name != "fluid"}
    exact = complex(reference(**parameters, k=k, guess=dispersion(flow, k).sigma[0]))
    for residual in (1e-3, 1e-5, 1e-7):
        (point,) = continue_in_k(flow, [k], residual=residual).points
        assert abs(point.sigma - exact) < point.error
    assert point.error < 1e-9 * abs(exact)


def test_one_percent_in_a_coefficient_is_seen(monkeypatch):
    """The agreement is not empty: a viscosity 1 % too large is far outside it."""
    flow = flows.Vortex()
    profile = flow.layers(None)[0].profile

    def wrong(self, names):
        def thicker(s):
            base = profile(s)
            return type(base)(**{**vars(base), "eta": 1.01 * base.eta})

        return (Layer("grains", thicker),)

    exact = dispersion(flow, 2.0).sigma[0]
    monkeypatch.setattr(flows.Vortex, "layers", wrong)
    (point,) = continue_in_k(flow, [2.0]).points
    assert abs(point.sigma - exact) > 1e-3 * abs(exact)


@pytest.mark.parametrize("flow", [flows.Dune(fluid="layer"), flows.RollWave(), flows.Film()])
def test_other_flows(flow):
    found = continue_in_k(flow, [0.1, 1.0])
    np.testing.assert_allclose(found.sigma, dispersion(flow, [0.1, 1.0]).sigma, rtol=1e-8)


def test_flow_without_surface_mode_needs_a_guess():
    flow = flows.Poiseuille(Re=1e4)
    published = -1j * (0.23752649 + 0.00373967j)  # Orszag (1971)
    (point,) = continue_in_k(flow, [1.0], guess=1.01 * published).points
    assert abs(point.sigma - published) < 1e-8
    with pytest.raises(ParameterError, match="no slow surface mode"):
        continue_in_k(flow, [1.0])


def test_continuation_in_a_parameter():
    values = [1.0, 3.0, 100.0]
    found = continue_in(flows.Dune(), "Re", values, k=1.0)
    exact = [dispersion(flows.Dune(Re=value), 1.0).sigma[0] for value in values]
    np.testing.assert_allclose(found.sigma, exact, rtol=1e-8)


def test_maximum_by_bounded_minimisation():
    flow = flows.Dune()
    found, exact = bounded_maximum(flow), k_max(flow)
    assert abs(found.k - exact.k_max) < found.error < 1e-3
    assert found.growth_rate == pytest.approx(exact.growth_rate, rel=1e-9)
    with pytest.raises(NotResolved, match="no positive maximum"):
        bounded_maximum(flows.Vortex())


@pytest.mark.parametrize("delta", [1e-1, 1e-2, 1e-3])
def test_regularised_vortex_obeys_lubrication_theory(delta):
    """(4.30) with -4 delta^{5/2} for its half-integer term, which is misprinted."""
    k, T = 1e-3, tan(radians(30.0))
    half = 4 / (15 * T) * (-4 * delta**2.5 + 1.5 * (1 + delta) ** 2.5 - 5 * delta * (1 + delta) ** 1.5
                           + 7.5 * delta**2 * (1 + delta) ** 0.5)
    (point,) = continue_in_k(flows.Vortex(), [k], setting=thesis_setting(flows.Vortex(), delta)).points
    assert point.sigma.real == pytest.approx(-half * k**2, rel=3e-6)


def test_thesis_setting_cuts_the_fluid_of_dunes_only_if_unbounded():
    assert thesis_setting(flows.Dune())(0.5).depth == 200
    assert thesis_setting(flows.Dune(depth=3.0))(0.5).depth == 3
    assert thesis_setting(flows.Vortex(Fr2=2.0), 1e-3)(1.0) == RegularisedVortex(Fr2=2.0, delta=1e-3)
    with pytest.raises(ParameterError, match="has none"):
        thesis_setting(flows.Dune(), 1e-3)
    with pytest.raises(ParameterError, match="computes vortex and dune"):
        thesis_setting(flows.Film())


def test_command(capsys):
    assert main(["dispersion", "vortex", "--k", "2,0.5", "--method", "bvp", "--json"]) == 0
    result = json.loads(capsys.readouterr().out)
    assert result["method"] == "bvp"
    assert [row["k"] for row in result["rows"]] == [2.0, 0.5]
    exact = dispersion(flows.Vortex(), [2.0, 0.5])
    np.testing.assert_allclose([row["growth_rate"] for row in result["rows"]], exact.growth_rate, rtol=1e-9)


def test_command_reports_where_it_gives_up(capsys):
    assert main(["dispersion", "vortex", "--Fr2", "2", "--k", "0.1,1", "--method", "bvp", "--json"]) == 3
    captured = capsys.readouterr()
    rows = json.loads(captured.out)["rows"]
    assert [row["status"] for row in rows] == ["resolved", "lost"]
    assert "bvp gives up after k = " in captured.err


def test_command_in_the_setting_of_the_thesis(capsys):
    assert main(["kmax", "dune", "--method", "bvp-thesis", "--json"]) == 0
    (row,) = json.loads(capsys.readouterr().out)["rows"]
    exact = k_max(flows.Dune())
    assert row["k_max"] == pytest.approx(exact.k_max, rel=1e-3)
    assert row["growth_rate"] == pytest.approx(exact.growth_rate, rel=1e-5)


@pytest.mark.parametrize(("words", "message"), [
    (["--method", "shooting"], "--method: must be one of"),
    (["--delta", "0.1"], "only --method bvp-thesis"),
    (["--method", "bvp-thesis", "--delta", "-1"], "--delta"),
    (["--method", "bvp", "--mode", "most-unstable"], "follows the surface mode only"),
])
def test_command_refuses_bad_input(words, message, capsys):
    assert main(["dispersion", "vortex", "--k", "1", *words]) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err.count("\n") == 1
    assert message in captured.err


def test_collocation_imports_no_bvp_solver():
    import subprocess
    import sys

    code = ("import sys; from stability.cli import main; main(['dispersion', 'vortex', '--k', '1']); "
            "sys.exit('scipy.integrate' in sys.modules)")
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, check=False).returncode == 0


CLOSE, NEAR = flows.Vortex(slope_deg=21.215735, Fr2=0.77673), flows.Vortex(slope_deg=21.2, Fr2=0.76)


@pytest.mark.parametrize(("flow", "checks", "keeps"), [
    (CLOSE, ("changes_little", "bends_little"), True), (CLOSE, (), False),
    (NEAR, ("bends_little",), True), (NEAR, ("changes_little",), True), (NEAR, (), False)])
def test_each_check_of_a_step_keeps_the_mode_by_itself(monkeypatch, flow, checks, keeps):
    """Near k = 1 two real modes of these flows pass close to each other: long unchecked steps cross over."""
    exact = dispersion(flow, 2.0).sigma[0]
    monkeypatch.setattr(continuation, "_PACE", Pace(0.5, 0.5, 4e-3))
    monkeypatch.setattr(continuation._ParameterWalk, "checks", checks)
    (point,) = continue_in_k(flow, [2.0]).points
    assert (abs(point.sigma - exact) < 1e-8 * abs(exact)) == keeps
