"""Expansions as numbers, and as they are printed."""

import io
import json
import re
from dataclasses import fields

import numpy as np
import pytest

from asymptotics import cli, expand, flows
from stability import dispersion, load
from stability.flows import FLOWS, Dune, Film
from stability.flows.laws import LAWS


def run(capsys, *arguments):
    status = cli.main(list(arguments))
    return status, *capsys.readouterr()


WAVES = [name for name in flows.names() if set(flows.load(name).REGIMES) != {"quasi-static"}]
STEADY = {"plate": "plate", "chute": "chute", "annulus": "annulus", "incline": "rollwave"}  # and their scenes


def test_steady_flows_have_the_defaults_of_their_scenes(capsys):
    assert {*WAVES, *STEADY} == set(flows.names())
    for name, scene in STEADY.items():
        theirs = {item.name: item.default for item in fields(FLOWS[scene])}
        ours = flows.load(name).DEFAULTS
        assert {key: float(value) for key, value in ours.items() if key in theirs} == \
            {key: theirs[key] for key in ours if key in theirs}
        status, out, err = run(capsys, "evaluate", name, "--k", "1")
        assert (status, out, err.count("\n")) == (2, "", 1)


@pytest.mark.parametrize("name", WAVES)
def test_defaults_are_those_of_the_numerics(name):
    """The two programs share no code: that they mean the same flow when nothing is said is checked here."""
    scenes = [FLOWS[name], *(FLOWS[name].under(LAWS[law]) for law in getattr(flows.load(name), "LAWS", ())[1:])]
    theirs = {item.name: item.default for scene in scenes for item in fields(scene) if "options" not in item.metadata}
    assert {key: float(value) for key, value in flows.load(name).DEFAULTS.items()} == theirs


@pytest.mark.parametrize("name", WAVES)
def test_numbers_are_near_those_of_dispersion(tmp_path, capsys, name):
    status, out, err = run(capsys, "evaluate", name, "--k", "1e-5:1e-4:3", "--csv")
    path = tmp_path / "series.csv"
    path.write_text(out)
    series = load(path)
    relation = dispersion(FLOWS[name](), series["k"])
    assert (status, err) == (0, "")
    assert list(series.rows()[0]) == list(relation.rows()[0])
    sigma = series["growth_rate"] - 1j * series["k"] * series["phase_speed"]
    off = np.abs(sigma / relation.sigma - 1)
    assert off.max() < 1e-2
    assert off[0] <= off[-1] + 1e-14
    assert np.all(abs(series["group_speed"] - relation.group_speed) <= 3e-2 * abs(relation.group_speed) + 1e-12)
    assert {row["status"].partition(";")[0].partition("^")[0] for row in series} == {"series to k"}


def test_every_form_holds_the_same_numbers(capsys):
    words = "evaluate", "dune", "--depth", "2", "--Re", "5", "--k", "0.01,0.1", "--order", "1"
    table = [line.split()[:3] for line in run(capsys, *words)[1].splitlines()[1:]]
    found = json.loads(run(capsys, *words, "--json")[1])
    assert found["parameters"] == {"shields": 2.0, "mu1": 0.4, "b": 1.0, "Re": 5.0, "depth": 2.0}
    assert (found["regime"], found["order"]) == ("shallow", "1")
    law = expand("dune", "shallow", 1, shields=2, mu1=0.4, b=1, Re=5, depth=2).function()
    for row, cells in zip(found["rows"], table, strict=True):
        assert complex(row["growth_rate"], -row["k"] * row["phase_speed"]) == pytest.approx(complex(law(row["k"])))
        assert [float(cell) for cell in cells] == pytest.approx([row["k"], row["growth_rate"], row["phase_speed"]])
    twin = expand("dune", "shallow", 1, shields=2.02, mu1=0.4, b=1, Re=5, depth=2).function()
    assert abs(complex(twin(0.1)) - complex(law(0.1))) > 1e-3


@pytest.mark.parametrize(("arguments", "words"), [
    (("dune", "--k", "0:10:5"), "--k: a range of wavenumbers starts above 0 (got '0:10:5'); take 0.01:10:5"),
    (("dune", "--k", "0,1"), "--k: values must be positive (got 0)"),
    (("dune", "--k", "1:2"), "--k: a range is a:b:n or a:b:n:lin"),
    (("dune", "--k", "x"), "--k: not a finite number: 'x'"),
    (("dune", "--k", "2:1:3"), "--k: a range must rise"),
    (("dune", "--k", "1:2:1"), "--k: the number of points must be an integer from 2"),
    (("dune", "--k", "1", "--regime", "small-Re"), "regime small-Re is a series in Re, not in k"),
    (("vortex", "--k", "1", "--regime", "delta"), "regime delta needs --delta: there is no default"),
    (("dune",), "--k"),
])
def test_bad_input_is_one_line(capsys, arguments, words):
    status, out, err = run(capsys, "evaluate", *arguments)
    assert (status, out, len(err.splitlines())) == (2, "", 1)
    assert words in err


def test_expand_takes_defaults_when_asked_for_numbers(capsys):
    _, out, _ = run(capsys, "expand", "film", "--numbers", "--Re", "20", "--json")
    found = json.loads(out)
    assert found["parameters"] == {"Re": 20.0, "slope_deg": Film().slope_deg, "We": 0.0}
    assert all(term["value"] is not None for term in found["terms"])
    status, _, err = run(capsys, "expand", "dune", "--regime", "small-Re", "--numbers")
    assert (status, err) == (2, "asymptotics: regime small-Re needs --kappa: there is no default\n")
    assert expand("dune", numbers=True).values()[2].real == pytest.approx(-0.6331649788706)


@pytest.mark.parametrize("flow", flows.names())
def test_every_symbol_that_is_printed_is_explained(capsys, flow):
    for regime in flows.load(flow).REGIMES:
        _, out, _ = run(capsys, "expand", flow, "--regime", regime)
        terms, _, legend = out.partition("\n\n")
        names = set(re.findall(r"(?<![\d.])[A-Za-z_]\w*", terms.partition("\n")[2])) - {"sqrt", "tan", "cot", "pi"}
        told = {line.partition(":")[0].partition("(")[0] for line in legend.splitlines()[1:]}
        assert names <= told | {"sigma"}, names - told
        assert "sigma = sum of coefficient * " in legend


def test_an_unbounded_fluid_in_R_is_explained(capsys):
    _, out, _ = run(capsys, "expand", "dune", "--regime", "small-Re")
    assert "R(kappa, 1, oo): response of the fluid's shear stress to a wavy wall" in out
    assert "oo: infinity" in out


@pytest.mark.parametrize("flow", flows.names())
def test_latex_has_the_symbols_of_print(capsys, flow):
    for regime in flows.load(flow).REGIMES:
        _, out, _ = run(capsys, "expand", flow, "--regime", regime, "--latex")
        assert not re.search(r"shields|mu1|mu2|_deg|deg|Fr2|viscosity|depth", out), out
        assert not re.search(r"\^\{?\d+\}?\^", out)
    if flow == "dune":
        assert r"\theta" in out or r"\mathrm{Re}" in out


def test_latex_of_the_shallow_limit(capsys):
    _, out, _ = run(capsys, "expand", "dune", "--regime", "shallow", "--order", "1", "--latex")
    assert out.splitlines()[1] == (r"\sigma_{1} &= - \frac{8 i \theta \left(\sqrt{\theta} - 1\right)^{2} "
                                   r"\left(\sqrt{\theta} + 2\right)}{3 b h} \\")
    assert Dune().shields == 2.0
    assert io.StringIO(out).readline().startswith("% ")
