"""All methods on one eigenvalue: values, reported errors, and the command."""

import csv
import json
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from stability import flows
from stability.cli import main
from stability.compare import compare, reference, target, timed, wavenumbers
from stability.flows import FLOWS


@pytest.fixture(autouse=True)
def short(monkeypatch):
    """Fewer and shorter measurements: these tests are about values."""
    module = sys.modules["stability.compare"]
    monkeypatch.setattr(module, "_SECONDS", 0.0)
    monkeypatch.setattr(module, "_REPEATS", 1)
    monkeypatch.setattr(module, "POINTS", 5)
    monkeypatch.setattr(module, "COLLOCATION_DEGREES", (8, 16, 32))
    monkeypatch.setattr(module, "DENSE_DEGREES", (8, 16, 32))
    monkeypatch.setattr(module, "RESIDUALS", (1e-3, 1e-6))
    monkeypatch.setattr(module, "THESIS_RESIDUALS", (1e-3,))


@pytest.mark.parametrize(("flow", "k"), [(flows.Vortex(), 2.0), (flows.Dune(), 1.0)])
def test_reported_errors_hold_and_collocation_is_exact(flow, k):
    found = compare(flow, k, ("collocation", "dense", "bvp"))
    assert found.reference.source == "power series in 30-digit arithmetic"
    assert found.failed == ()
    for one in found.measurements:
        assert one.reported is None or one.error <= one.reported
        assert one.seconds > 0
    best = {one.method: one.error for one in found.measurements}
    assert best["collocation"] < 1e-15 * 3
    assert best["dense"] < 1e-13
    assert best["bvp"] < 1e-9


def test_bias_of_the_thesis_setting_does_not_go_away():
    (one,) = compare(flows.Vortex(), 2.0, ("bvp-thesis",)).measurements
    assert one.reported < 1e-3 * one.error
    assert one.error > 5e-3


POISEUILLE = -1j * (0.237526488820470107446579 + 0.00373967062297940993222j)  # Re 1e4, k 1


@pytest.mark.parametrize("flow", FLOWS.values())
def test_every_flow_has_an_independent_reference(flow):
    mode = target(flow(), 1.0)
    known = reference(flow(), 1.0, mode)
    assert known.source == "power series in 30-digit arithmetic"
    assert abs(known.sigma - mode.sigma) < mode.error


def test_where_the_independent_reference_gives_up_collocation_is_named(monkeypatch):
    def give_up(Re, k, guess):
        raise ArithmeticError("too many bits")

    module = sys.modules["stability.compare"]
    monkeypatch.setattr(module, "_references", lambda: SimpleNamespace(poiseuille=give_up))
    flow = flows.Poiseuille(Re=1e4)
    known = reference(flow, 1.0, target(flow, 1.0))
    assert known.source.startswith("collocation at degree")
    assert abs(known.sigma - POISEUILLE) < known.error


def test_failures_are_listed():
    found = compare(flows.Poiseuille(Re=1e4), 1.0, ("collocation", "bvp-thesis"))
    assert all(method == "collocation" for method, _ in found.failed)
    assert [one.setting for one in found.measurements][-1] == "degree 32"


def test_sweep_has_the_wavenumber_in_its_middle():
    values = wavenumbers(0.7)
    assert values[len(values) // 2] == 0.7
    np.testing.assert_allclose(np.diff(np.log(values)), np.log(values[1] / values[0]), rtol=1e-9)


def test_timed_returns_value_and_shortest_time():
    value, seconds = timed(lambda: 7)
    assert value == 7
    assert 0 < seconds < 0.1


def test_command(capsys, tmp_path):
    picture = tmp_path / "compare.png"
    assert main(["compare", "vortex", "--k", "2", "--json", "--plot", str(picture)]) == 0
    captured = capsys.readouterr()
    rows = json.loads(captured.out)["rows"]
    assert {row["method"] for row in rows} == {"collocation", "dense", "bvp", "bvp-thesis"}
    assert "reference: sigma = -0.452930272740044" in captured.err
    assert picture.stat().st_size > 10_000


def test_command_takes_one_wavenumber(capsys):
    assert main(["compare", "vortex", "--k", "1,2"]) == 2
    assert "one wavenumber" in capsys.readouterr().err


def time_to(rows, problem, method, error):
    """Shortest time of a method of the chart that is in error by no more than this; None if it never is."""
    return min((float(row["seconds"]) for row in rows if (row["problem"], row["method"]) == (problem, method)
                and float(row["error"]) <= error), default=None)


@pytest.mark.parametrize("problem", ["vortices", "dunes"])
def test_the_chart_says_which_method_to_use_for_nine_digits(problem):
    """A hundred times faster than bvp; the textbook's script never gets there, and is slower where it is best."""
    path = Path(__file__).resolve().parents[1] / "figures" / "work_precision.csv"
    rows = list(csv.DictReader(path.read_text(encoding="utf-8").splitlines()))
    ours = time_to(rows, problem, "collocation", 1e-9)
    assert time_to(rows, problem, "bvp", 1e-9) > 100 * ours
    assert time_to(rows, problem, "textbook", 1e-9) is None
    best = min(float(row["error"]) for row in rows if (row["problem"], row["method"]) == (problem, "textbook"))
    assert time_to(rows, problem, "textbook", best) > 10 * ours
