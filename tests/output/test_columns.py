"""Every column is explained, in one place that the help of the verbs, netCDF files and the reference share."""

import json
import subprocess
import sys
from dataclasses import fields

import pytest
from scipy.io import netcdf_file

from stability import flows
from stability.cli import main
from stability.cli.verbs import VERBS
from stability.output import netcdf
from stability.output.columns import ANY_DEGREE, BY_VERB, COLUMNS, PARAMETERS, column, known
from stability.studies.base import base_flow
from stability.studies.compare import Comparison, Measurement, Reference

QUESTIONS = [
    "base dune --points 3", "base two_layer_couette --points 3", "spectrum vortex --k 1 --modes 2",
    "spectrum vortex --k 1,2 --modes 1", "dispersion vortex --k 1,2", "dispersion vortex --k 1 --method bvp",
    "dispersion dune --k 1 --each depth=5,inf", "kmax dune --over Re=1,10", "kmax vortex",
    "neutral film --vary Re --over We=0,1 --long-wave", "neutral film --vary Re --k 0.1",
    "critical film --vary Re --long-wave",
    "sensitivity vortex --k 1", "wellposed vortex --points 5", "wellposed vortex --k 1,2",
]
MAPS = ["--over depth=5", "--over depth=5 --k 1,2", "--over shields=2 --vary Re"]
WITHOUT_ROWS = {"flows", "explore"}


def missing(names, verb, flow):
    """The columns of a verb that its list has not, or that nothing explains."""
    own = {item.name for item in fields(flows.find(flow))}
    names = [ANY_DEGREE if name.startswith("degree_") else name for name in names if name not in own]
    return [name for name in names if name not in BY_VERB[verb] or not column(name, verb).meaning]


@pytest.mark.parametrize("question", QUESTIONS)
def test_every_column_of_every_verb_is_explained(capsys, question):
    verb, flow, *_ = question.split()
    main([*question.split(), "--json", "--quiet"])
    rows = json.loads(capsys.readouterr().out)["rows"]
    assert missing(rows[0], verb, flow) == []


@pytest.mark.parametrize("options", MAPS)
def test_every_column_of_maps_is_explained(tmp_path, options):
    target = tmp_path / "map.json"
    main(["map", "dune", *options.split(), "-o", str(target), "--quiet", "--workers", "1"])
    assert missing(json.loads(target.read_text())["rows"][0], "map", "dune") == []


def test_every_column_of_every_base_flow_is_explained():
    for name, flow in flows.FLOWS.items():
        assert missing(base_flow(flow(), 3)[0], "base", name) == []


def test_every_column_of_a_comparison_is_explained():
    """Those of a measurement, and of a method that was still to come: no need to measure."""
    flow, one = flows.Vortex(), Measurement("bvp", "tol 1e-3", -1 + 0j, 1e-9, None, 0.1, 100)
    rows = Comparison(flow, 1.0, Reference(-1 + 0j, 0.0, "known"), (one,), (), ("collocation",)).rows()
    assert len(rows) == 2
    assert all(missing(row, "compare", "vortex") == [] for row in rows)


def test_what_a_flow_with_measured_data_adds_is_explained():
    assert all("data_error" in BY_VERB[verb] for verb in ("spectrum", "dispersion", "kmax", "neutral", "critical"))
    assert "growth_data_error" in BY_VERB["kmax"]
    assert column("data_error").units == "V/L"


def test_an_unknown_column_is_found():
    assert missing(["k", "invented"], "dispersion", "dune") == ["invented"]
    assert missing(["k", "k_max"], "dispersion", "dune") == ["k_max"]
    with pytest.raises(KeyError):
        column("invented")


def test_every_verb_has_its_columns_and_shows_them(capsys):
    assert set(BY_VERB) | WITHOUT_ROWS == set(VERBS)
    for verb, names in BY_VERB.items():
        assert all(known(name) or name == PARAMETERS for name in names)
        with pytest.raises(SystemExit):
            main([verb, "--help"])
        text = capsys.readouterr().out
        assert "columns:" in text
        for name in names:
            assert f"  {name} " in text
            assert str(column(name, verb)) in text


def test_none_is_explained_for_nothing():
    """What no verb has is what only files have: complex numbers in two parts, lists as arrays."""
    shown = {name for names in BY_VERB.values() for name in names}
    assert set(COLUMNS) - shown == {"sigma", "slope", "maxima_k", "maxima_growth_rate"}


@pytest.mark.parametrize("question", ["dispersion vortex --k 1,2", "kmax dune --over Re=1,10",
                                      "critical film --vary Re --long-wave"])
def test_netcdf_says_the_same(tmp_path, question):
    verb, target = question.split()[0], tmp_path / "x.nc"
    main([*question.split(), "-o", str(target), "--quiet"])
    with netcdf_file(target, mmap=False) as file:
        assert b"L, V, S" in file.scales
        for name in ("k", "k_max", "growth_rate", "phase_speed", "status"):
            if name in file.variables:
                assert file.variables[name].long_name.decode() == column(name, verb).meaning
                assert getattr(file.variables[name], "scale", b"").decode() == column(name, verb).units
        bounded = {"dispersion": "sigma", "kmax": "k_max", "critical": "Re"}[verb]
        assert file.variables["error"].long_name.decode() == f"bound of the absolute error of {bounded}"
        assert file.variables["error"].units == b"1"
    assert not hasattr(netcdf, "MEANINGS")


def test_the_meanings_need_no_numerics():
    code = "import sys, stability.output.columns; print('numpy' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True).stdout == "False\n"
