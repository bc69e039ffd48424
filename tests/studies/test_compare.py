"""All methods on one eigenvalue: values, reported errors, and the command."""

import csv
import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import references

from stability import flows
from stability.cli import main
from stability.cli.verbs import compare as verb
from stability.flows import FLOWS
from stability.studies.compare import Reference, compare, comparisons, reference, target, timed, wavenumbers


@pytest.fixture(autouse=True)
def short(monkeypatch):
    """Fewer and shorter measurements: these tests are about values."""
    module = sys.modules["stability.studies.compare"]
    monkeypatch.setattr(module, "_SECONDS", 0.0)
    monkeypatch.setattr(module, "_REPEATS", 1)
    monkeypatch.setattr(module, "SWEEP_POINTS", 5)
    monkeypatch.setattr(module, "COLLOCATION_DEGREES", (8, 16, 32))
    monkeypatch.setattr(module, "DENSE_DEGREES", (8, 16, 32))
    monkeypatch.setattr(module, "RESIDUALS", (1e-3, 1e-6))
    monkeypatch.setattr(module, "THESIS_RESIDUALS", (1e-3,))


def independent(flow, k, mode):
    """The 30-digit value of a mode as a Reference."""
    parameters = {name: value for name, value in vars(flow).items() if name != "fluid"}
    value = complex(getattr(references, flow.name)(**parameters, k=k, guess=mode.sigma))
    return Reference(value, abs(value) * 1e-16, "power series in 30-digit arithmetic")


@pytest.mark.parametrize(("flow", "k"), [(flows.Vortex(), 2.0), (flows.Dune(), 1.0)])
def test_reported_errors_hold_and_collocation_is_exact(flow, k):
    found = compare(flow, k, ("collocation", "dense", "bvp"), known=independent(flow, k, target(flow, k)))
    assert found.failed == found.skipped == found.pending == ()
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


@pytest.mark.parametrize("flow", [flow for name, flow in FLOWS.items() if hasattr(references, name)])
def test_every_flow_has_an_independent_reference(flow):
    mode = target(flow(), 1.0)
    known = independent(flow(), 1.0, mode)
    assert abs(known.sigma - mode.sigma) < mode.error


def test_the_reference_is_collocation_unless_told_otherwise():
    flow = flows.Poiseuille(Re=1e4)
    known = reference(target(flow, 1.0))
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
    assert "reference: sigma = -0.45293027274004" in captured.err
    assert picture.stat().st_size > 10_000


def test_ctrl_c_keeps_what_is_measured(capsys, monkeypatch):
    def stopped(*arguments, **options):
        for count, found in enumerate(comparisons(*arguments, **options)):
            if count == 5:  # the first of the dense ones is under way
                raise KeyboardInterrupt
            yield found

    monkeypatch.setattr(sys.modules["stability.studies.compare"], "comparisons", stopped)
    assert main(["compare", "vortex", "--k", "2", "--json", "--quiet"]) == 130
    rows = json.loads(capsys.readouterr().out)["rows"]
    assert [(row["method"], row["status"]) for row in rows] == [
        *[("collocation", "resolved")] * 3, ("dense", "resolved"),
        *((name, "interrupted") for name in ("dense", "bvp", "bvp-thesis"))]


def test_the_time_is_kept():
    """Nothing is begun that would take too long: what was left out is said."""
    found = compare(flows.Vortex(), 2.0, budget=0.0)
    assert found.measurements == ()
    assert len(found.skipped) == 3 + 3 + 2 + 1
    assert found.notes()[-1] == "bvp-thesis, residual 0.001: not measured, the time is up"
    assert verb._BUDGET < 20


def test_nothing_comes_from_the_tests():
    code = ("import sys; from stability.studies.compare import compare; from stability import flows; "
            "compare(flows.Vortex(), 2.0, budget=0.0); print([n for n in sys.modules if 'references' in n])")
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "[]\n"


def test_command_takes_one_wavenumber(capsys):
    assert main(["compare", "vortex", "--k", "1,2"]) == 2
    assert "one wavenumber" in capsys.readouterr().err


def time_to(rows, problem, method, error, question="sweep"):
    """Shortest time of a method of the chart that is in error by no more than this; None if it never is."""
    return min((float(row["seconds"]) for row in rows if float(row["error"]) <= error and
                (row["problem"], row["method"], row["question"]) == (problem, method, question)), default=None)


@pytest.mark.parametrize("problem", ["vortices", "dunes"])
def test_the_chart_says_which_method_to_use_for_nine_digits(problem):
    """A hundred times faster than bvp; the textbook's script never gets there, and is slower where it is best."""
    path = Path(__file__).resolve().parents[2] / "figures" / "work_precision.csv"
    rows = list(csv.DictReader(path.read_text(encoding="utf-8").splitlines()))
    ours = time_to(rows, problem, "collocation", 1e-9)
    assert time_to(rows, problem, "bvp", 1e-9) > 100 * ours
    assert time_to(rows, problem, "textbook", 1e-9) is None
    best = min(float(row["error"]) for row in rows if (row["problem"], row["method"]) == (problem, "textbook"))
    assert time_to(rows, problem, "textbook", best) > 10 * ours
