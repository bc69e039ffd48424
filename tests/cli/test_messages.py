"""What the command line says to a slip: what was meant, and what would do."""

import json
import re
import subprocess
import sys
from argparse import Namespace
from dataclasses import fields

import numpy as np
import pytest

from stability import ParameterError
from stability.cli import main
from stability.cli.asked import checked, swept
from stability.cli.verbs import VERBS
from stability.flows.catalogue import FLOWS
from stability.flows.declaration import declared
from stability.flows.rules import check_parameter


@pytest.mark.parametrize(("words", "said"), [
    ("dipersion dune --k 1", "unknown verb 'dipersion' (did you mean 'dispersion'?); verbs: flows, "),
    ("dispersion dune --K 1", "unknown option '--K' (did you mean '--k'?)"),
    ("dispersion dune --K=1", "unknown option '--K=1' (did you mean '--k'?)"),
    ("kmax dune --ovr Re=1,2", "unknown option '--ovr' (did you mean '--over'?)"),
    ("dispersion dune --k 1 --shield 2", "unknown option '--shield' (did you mean '--shields'?)"),
    ("dispersion dune --k 1 --re 2", "unknown option '--re' (did you mean '--Re'?)"),
    ("dispersion dune", "the following arguments are required: --k"),
    ("dispersion dune --k 0:10:5", "--k: a logarithmic range starts above 0 (got '0:10:5'); 0.01:10:5 would do"),
    ("dispersion dune --k 0:4:5:lin", "--k: a range of positive values starts above 0 (got '0:4:5:lin'); "
                                      "0.004:4:5:lin would do"),
    ("kmax film --over We=0:2:5", "--over We: a logarithmic range starts above 0 (got '0:2:5'); 0.002:2:5, or "
                                  "0:2:5:lin for equal steps would do"),
])
def test_a_slip_is_answered_with_what_is_meant(capsys, words, said):
    assert main(words.split()) == 2
    out, err = capsys.readouterr()
    assert (out, len(err.splitlines())) == ("", 1)
    assert said in err


@pytest.mark.parametrize(("slope", "hint"), [("0.5", "28.6479"), ("1.5", "85.9437"), ("1.7", None), ("30", None)])
def test_a_slope_that_may_be_in_radians_is_noted(capsys, slope, hint):
    for quiet in ([], ["--quiet"]):
        assert main(["dispersion", "vortex", "--k", "1", "--slope-deg", slope, *quiet]) == 0
        err = "".join(line for line in capsys.readouterr().err.splitlines(True) if "collide" not in line)
        expected = f"stability: slope_deg = {slope} is an angle in degrees; if it is meant in radians, give --slope-deg"
        assert err == ("" if quiet or hint is None else f"{expected} {hint}\n")


def test_what_grows_at_every_value_says_so(capsys):
    assert main(["critical", "film", "--vary", "Re", "--slope-deg", "120", "--range", "1:3"]) in (0, 3)
    out = capsys.readouterr().out
    assert "unstable at every Re from 1 to 3" in out


NEEDED = {"spectrum": "--k 1", "dispersion": "--k 1", "neutral": "--vary Re --k 1", "critical": "--vary Re",
          "map": "--over Re=1,2 -o x.csv", "sensitivity": "--k 1", "compare": "--k 1"}
HEAVY = "numpy", "scipy", "matplotlib", "sympy"


def slips(verb):
    """Command lines of a verb that are refused, each with a slip of its own."""
    film = [verb, "film", *NEEDED.get(verb, "").split()]
    yield from ([verb], [verb, "fun"], [*film, "--nonsense"], [*film, "--slope-degree=30"], [*film, "more"],
                [*film, "--Re"], [*film, "--Re", "-1"], [*film, "--Re", "x"], [*film, "--slope-deg", "180"],
                [*film, "--Re", "1", "--Re", "2"], [*film, "--law", "linear"])
    for option, *values in (("--k", "0", "x", "2:1:5"), ("--tolerance", "5"), ("--max-degree", "3"), ("--mode", "odd"),
                            ("--over", "Fr=1", "Re=x", "Re=-1,2"), ("--each", "Re=", "slope_deg=1,200"),
                            ("--method", "odd"), ("--delta", "1"), ("--vary", "Fr"), ("--range", "3"),
                            ("--search", "2:1"), ("--workers", "0"), ("--quantity", "odd"), ("--points", "x"),
                            ("--modes", "0"), ("--port", "x"), ("-o", "x.odd", "none/x.csv"), ("--plot", "x.odd"),
                            ("--size", "1x1"), ("--plot x.png --size", "1"), ("--plot x.png --log", "z")):
        at = film.index(option) if option in film else len(film)
        yield from ([*film[:at], *option.split(), value, *film[at + 2:]] for value in values)


@pytest.fixture(scope="module")
def answers(tmp_path_factory):
    """{words: (status, output, errors, heavy packages imported so far)} of one process that asks them all."""
    asked = [["--help"], ["--version"], ["dance"], [], ["flows"], ["flows", "dune"], ["flows", "fun"]]
    asked += [[verb, flow, "--help"] for verb in VERBS for flow in ("", *FLOWS) if flow or verb != "flows"]
    asked += [words for verb in VERBS if verb != "flows" for words in slips(verb)]
    asked = [[word for word in words if word] for words in asked]
    code = f"""
import io, json, sys
from contextlib import redirect_stderr, redirect_stdout
from stability.cli import main
for words in json.load(sys.stdin):
    out, err = io.StringIO(), io.StringIO()
    with redirect_stdout(out), redirect_stderr(err):
        try:
            status = main(words)
        except SystemExit as end:
            status = end.code
    heavy = [name for name in {HEAVY} if name in sys.modules]
    print(json.dumps([status, out.getvalue(), err.getvalue(), heavy]))
"""
    done = subprocess.run([sys.executable, "-c", code], input=json.dumps(asked), capture_output=True, text=True,
                          check=True, cwd=tmp_path_factory.mktemp("slips"))
    return {tuple(words): json.loads(line) for words, line in zip(asked, done.stdout.splitlines(), strict=True)}


def test_help_and_slips_import_no_numerics(answers):
    """Of every verb and every flow of the package."""
    first = next(((words, heavy) for words, (*_, heavy) in answers.items() if heavy), None)
    assert first is None
    assert len(answers) > 400


def test_slips_are_refused_in_one_line(answers):
    for words, (status, out, err, _) in answers.items():
        if words[-1:] == ("--help",):
            assert (status, err) == (0, "")
            assert out.startswith("usage: stability ")
        elif words not in {("--version",), ("flows",), ("flows", "dune")}:
            assert (status, out, err.count("\n")) == (2, "", 1), words
            assert err.startswith("stability: ")


@pytest.mark.parametrize("name", FLOWS)
def test_values_are_refused_as_the_class_refuses_them(name):
    for item in declared(name).parameters:
        for value in ("x", "nan", "inf", "-inf", "-1", "0", "1e30", "1e-30", "odd"):
            said = []
            for ask in (lambda: checked(Namespace(flow=name, **{f"parameter {item.name}": value})),  # noqa: B023
                        lambda: check_parameter(name, fields_of(name)[item.name], value)):  # noqa: B023
                try:
                    ask()
                    said.append(None)
                except ParameterError as reason:
                    said.append(str(reason))
            assert said[0] == said[1] or "table" in item.metadata


def fields_of(name):
    return {item.name: item for item in fields(FLOWS[name])}


def test_values_of_a_sweep_are_refused_at_the_first_that_is_not_admissible():
    flow = declared("film")
    for text, value in (("slope_deg=20,200,300", "200"), ("slope_deg=100:200:3:lin", "200"),
                        ("slope_deg=100:300:5:lin", "200"), ("Re=-2:2:5:lin", "-2"), ("slope_deg=100:400:3", "200")):
        with pytest.raises(ParameterError, match=re.escape(f"(got {value})")):
            swept(text, flow)
    assert swept("slope_deg=20:160:3", flow)[1].array.tolist() == np.geomspace(20, 160, 3).tolist()
