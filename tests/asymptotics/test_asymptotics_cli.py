"""The command line: what it prints, how it refuses, and its meeting with `stability` in a pipe."""

import io
import json
import os
import subprocess
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest
import sympy as sp

from asymptotics import __version__ as asymptotics_version
from asymptotics import assert_order, cli, expand, flows
from asymptotics.comparison import OrderMismatch
from asymptotics.errors import TooFewPoints
from stability import __version__ as stability_version
from stability import dispersion
from stability.cli import main as stability
from stability.flows import Dune, Film, RollWave, TwoLayerCouette, Vortex

ROOT = Path(__file__).parents[2]
A = ["expand", "dune", "--regime", "shallow", "--shields", "1.5", "--depth", "10", "--mu1", "0.4", "--b", "1"]


def run(capsys, *arguments):
    status = cli.main(list(arguments))
    out, err = capsys.readouterr()
    return status, out, err


def refused(capsys, *arguments):
    """The one line on standard error of a command that must be refused."""
    status, out, err = run(capsys, *arguments)
    assert status == 2
    assert out == ""
    assert len(err.splitlines()) == 1
    assert err.startswith("asymptotics: ")
    return err


def test_json_with_numbers(capsys):
    status, out, _ = run(capsys, *A, "--Re", "0.1", "--json")
    record = json.loads(out)
    assert status == 0
    assert list(record) == ["flow", "regime", "gauge", "parameters", "terms", "growth_rate", "phase_speed"]
    assert (record["flow"], record["regime"], record["gauge"]) == ("dune", "shallow", "k")
    assert record["parameters"] == {"shields": 1.5, "mu1": 0.4, "b": 1.0, "Re": 0.1, "depth": 10.0}
    terms = {term["power"]: term for term in record["terms"]}
    assert terms["2"]["value"] == pytest.approx([-0.0207561449, 0], abs=5e-11)
    assert complex(sp.sympify(terms["2"]["coefficient"]).evalf()) == pytest.approx(complex(*terms["2"]["value"]))
    k = sp.Symbol("k")
    assert float(sp.sympify(record["growth_rate"]).subs(k, 0.1)) == pytest.approx(-0.000207561449, rel=1e-8)
    assert float(sp.sympify(record["phase_speed"])) == pytest.approx(0.06515307716504658)


def test_json_with_symbols(capsys):
    _, out, _ = run(capsys, "expand", "dune", "--regime", "boundary-layer", "--Re", "1", "--json")
    record = json.loads(out)
    assert record["parameters"] == {"shields": None, "mu1": None, "b": None, "Re": 1.0}
    assert [term["power"] for term in record["terms"]] == ["4/3", "5/3", "2"]
    assert record["terms"][0]["value"] is None
    assert record["terms"][1]["value"] == [0.0, 0.0]


@pytest.mark.parametrize("flow", flows.names())
def test_every_regime_is_written_in_every_form(capsys, flow):
    for regime in flows.load(flow).REGIMES:
        for form in ([], ["--json"], ["--latex"]):
            status, out, err = run(capsys, "expand", flow, "--regime", regime, *form)
            assert (status, err) == (0, "")
            assert out.strip()


def test_order_and_default_regime(capsys):
    _, out, _ = run(capsys, "expand", "vortex", "--order", "4", "--slope-deg", "45", "--Fr2", "0", "--json")
    record = json.loads(out)
    assert [(term["power"], term["coefficient"]) for term in record["terms"]] == [("2", "-2/5"), ("4", "38/81")]
    assert expand("dune", depth=5).regime == "shallow"
    assert expand("dune", depth="inf").regime == expand("dune").regime == "boundary-layer"
    assert expand("vortex", delta=0.1).regime == "delta"


@pytest.mark.parametrize(("arguments", "words"), [
    (["expand", "dune", "--shields", "0.8"], ["shields", "> 1", "0.8", "yield"]),
    (["expand", "dune", "--shields", "nan"], ["shields", "nan"]),
    (["expand", "dune", "--shields", "inf"], ["shields", "inf"]),
    (["expand", "dune", "--Re", "abc"], ["Re", "abc", "--Re"]),
    (["expand", "dune", "--Re", "-3"], ["Re", "> 0", "-3"]),
    (["expand", "vortex", "--slope-deg", "90"], ["slope_deg", "90"]),
    (["expand", "vortex", "--shields", "2"], ["no parameter shields", "slope_deg"]),
    (["expand", "vortx"], ["vortx", "did you mean 'vortex'"]),
    (["expand", "dune", "--regime", "deep"], ["deep", "boundary-layer"]),
    (["expand", "dune", "--regime", "shallow", "--depth", "inf"], ["depth", "finite"]),
    (["expand", "dune", "--regime", "boundary-layer", "--depth", "3"], ["depth", "inf", "shallow"]),
    (["expand", "dune", "--regime", "boundary-layer", "--kappa", "3"], ["kappa", "boundary-layer"]),
    (["expand", "dune", "--order", "3"], ["order", "8/3", "3", "dilogarithms"]),
    (["expand", "dune", "--order", "1"], ["order", "4/3", "1"]),
    (["expand", "dune", "--order", "two"], ["order", "two"]),
    (["expand", "vortex", "--order", "99"], ["order", "99"]),
    (["expand", "film", "--slope-deg", "180"], ["slope_deg", "< 180", "180"]),
    (["expand", "film", "--Fr2", "1"], ["no parameter Fr2", "Re, slope_deg, We"]),
    (["expand", "rollwave", "--mu1", "0.5", "--mu2", "0.4"], ["mu1 must be less than mu2", "0.4"]),
    (["expand", "rollwave", "--mu1", "0.4", "--mu2", "0.6", "--slope-deg", "33"], ["slope_deg", "30.9638", "33"]),
    (["expand", "two_layer_couette", "--order", "3"], ["order 3", "viscosity_ratio, depth_ratio, density_ratio"]),
    (["expand", "two_layer_couete"], ["did you mean 'two_layer_couette'"]),
    (["expand", "dune", "--shield", "2"], ["unknown option '--shield'", "did you mean '--shields'"]),
    (["flows", "dune", "film"], ["unknown argument 'film'"]),
    (["expand"], ["FLOW", "--help"]),
    ([], ["VERB", "--help"]),
    (["expand", "dune", "--Re", "3", "--Re", "4"], ["--Re: given twice, with '3' and '4'"]),
    (["expand", "vortex", "--slope_deg", "30", "--slope-deg", "31"], ["--slope-deg: given twice"]),
    (["check", "vortex", "--tolerance", "0.1", "--tolerance", "0.2"], ["--tolerance: given twice"]),
    (["expand", "dune", "--json", "--latex"], ["--latex"]),
    (["flows", "film2"], ["film2", "dune"]),
    (["check", "dune", "/no/such/file"], ["/no/such/file", "stability dispersion"]),
    (["check", "dune", str(ROOT)], [str(ROOT)]),
])
def test_bad_input_is_one_line(capsys, arguments, words):
    line = refused(capsys, *arguments)
    assert all(word in line for word in words), line


# -- check ------------------------------------------------------------------------------------------------


def piped(capsys, monkeypatch, numerics, *arguments):
    assert stability(["dispersion", *numerics, "--csv"]) == 0
    monkeypatch.setattr(sys, "stdin", io.StringIO(capsys.readouterr().out))
    return run(capsys, "check", *arguments)


@pytest.mark.parametrize(("numerics", "flow"), [
    (["dune", "--depth", "10", "--Re", "1", "--k", "1e-6:1e-4:7"], "dune"),
    (["dune", "--Re", "3", "--k", "1e-8:1e-6:9"], "dune"),
    (["vortex", "--k", "1e-2:1:13"], "vortex"),
    (["film", "--k", "1e-4:1e-2:7"], "film"),
    (["film", "--slope-deg", "120", "--We", "2", "--k", "1e-4:1e-2:7"], "film"),
    (["rollwave", "--k", "1e-4:1e-2:7"], "rollwave"),
    (["two_layer_couette", "--k", "1e-3:1e-1:7"], "two_layer_couette"),
    (["two_layer_couette", "--depth-ratio", "0.7", "--density-ratio", "1.5", "--gravity", "3", "--k", "1e-4:1e-2:7"],
     "two_layer_couette"),
])
def test_the_two_programs_meet_in_a_pipe(capsys, monkeypatch, numerics, flow):
    status, out, err = piped(capsys, monkeypatch, numerics, flow)
    assert (status, err) == (0, "")
    assert "agrees with the expected" in out.splitlines()[-1]


@pytest.mark.parametrize(("numerics", "wrong"), [
    (["dune", "--depth", "10", "--Re", "1", "--k", "1e-6:1e-4:7"],
     (["--Re", "1.01"], ["--b", "1.01"], ["--shields", "2.02"])),
    (["film", "--k", "1e-4:1e-2:7"], (["--Re", "10.1"], ["--slope-deg", "30.3"], ["--We", "1"])),
    (["rollwave", "--k", "1e-4:1e-2:7"], (["--Fr2", "4.04"], ["--slope-deg", "28.28"], ["--mu1", "0.3857"])),
    (["two_layer_couette", "--k", "1e-6:1e-4:7"], (["--Re", "10.1"], ["--viscosity-ratio", "2.02"])),
])
def test_a_wrong_parameter_is_found(capsys, monkeypatch, numerics, wrong):
    for flags in wrong:
        status, out, err = piped(capsys, monkeypatch, numerics, numerics[0], *flags)
        assert status == 3
        assert len(err.splitlines()) == 1
        assert "differs from the expected" in err
        assert "slope" in out.splitlines()[0]


@pytest.mark.parametrize(("text", "words"), [
    ("", ["column", "k"]),
    ("k,growth_rate\n1,2\n", ["phase_speed"]),
    ("k,growth_rate,phase_speed\n1,x,3\n", ["numbers"]),
    ("k,growth_rate,phase_speed\n", ["four small wavenumbers"]),
    ("# flow: vortex\nk,growth_rate,phase_speed\n1,2,3\n", ["vortex", "dune"]),
    ("k,growth_rate,phase_speed\n1e-3,2,3\n", ["--shields"]),
    ("# shields: 0.5\nk,growth_rate,phase_speed\n1e-3,2,3\n", ["shields", "> 1"]),
    ("# shields: 2\n# mu1: 0.4\n# b: 1\n# Re: 1\nk,growth_rate,phase_speed\n1e-3,2,3\n", ["4 are needed"]),
])
def test_bad_numerics_are_one_line(capsys, monkeypatch, text, words):
    monkeypatch.setattr(sys, "stdin", io.StringIO(text))
    line = refused(capsys, "check", "dune")
    assert all(word in line for word in words), line


def test_options_of_check(capsys, monkeypatch):
    assert "tolerance" in refused(capsys, *two_rows(monkeypatch), "--tolerance", "-1")
    assert "--k-max" in refused(capsys, *two_rows(monkeypatch), "--k-max", "x")
    assert "takes no shields" in refused(capsys, *two_rows(monkeypatch), "--regime", "near-yield")


def two_rows(monkeypatch):
    text = "# shields: 2\n# mu1: 0.4\n# b: 1\n# Re: 1\nk,growth_rate,phase_speed\n1e-3,2,3\n1e-2,2,3\n"
    monkeypatch.setattr(sys, "stdin", io.StringIO(text))
    return ["check", "dune"]


LINES = {"film": ["film", "--k", "1e-3:1e-1:9", "--csv"], "vortex": ["vortex", "--k", "1e-2:1:9", "--csv"]}


def numerics(capsys, flow):
    assert stability(["dispersion", *LINES[flow]]) == 0
    return capsys.readouterr().out


def checked(capsys, monkeypatch, text, *arguments):
    monkeypatch.setattr(sys, "stdin", io.StringIO(text))
    return run(capsys, "check", *arguments)


def reform(text, row):
    """Numerics with their rows changed: `row(number, cells)` gives cells."""
    comments = [line for line in text.splitlines() if line.startswith("#")]
    header, *rows = [line.split(",") for line in text.splitlines() if not line.startswith("#")]
    lines = [header, *(row(number, cells) for number, cells in enumerate(rows))]
    return "\n".join([*comments, *(",".join(cells) for cells in lines)]) + "\n"


@pytest.mark.parametrize("change", [
    lambda text: "\ufeff" + text, lambda text: text.replace("\n", "\r\n"), lambda text: text.replace(",", ", "),
    lambda text: text.replace(",", " ,\t "), lambda text: text.replace("\n", "\n\n"),
], ids=["byte-order mark", "CRLF", "spaces", "tabs", "empty lines"])
def test_numerics_written_by_other_programs(capsys, monkeypatch, tmp_path, change):
    text = numerics(capsys, "vortex")
    usual = checked(capsys, monkeypatch, text, "vortex")
    assert checked(capsys, monkeypatch, change(text), "vortex") == usual
    (tmp_path / "x.csv").write_bytes(change(text).encode())
    assert run(capsys, "check", "vortex", str(tmp_path / "x.csv")) == usual
    assert usual[0] == 0


@pytest.mark.parametrize("text", ["", "\ufeff", "\r\n", "# flow: dune\n"])
def test_an_empty_file_is_refused(capsys, monkeypatch, text):
    monkeypatch.setattr(sys, "stdin", io.StringIO(text))
    assert "is empty: it has no column k, growth_rate" in refused(capsys, "check", "dune")


def test_rows_that_are_not_used_are_counted(capsys, monkeypatch):
    """Not resolved, or not a number: 2 and 1 of 9."""
    def spoil(number, cells):
        if number in (3, 4):
            return [cells[0], *[""] * (len(cells) - 2), "lost: no mode"]
        return [cells[0], "nan", *cells[2:]] if number == 5 else cells

    text = numerics(capsys, "film")
    k = [line.split(",")[0] for line in text.splitlines() if line[0].isdigit()]
    status, out, err = checked(capsys, monkeypatch, reform(text, spoil), "film", "--order", "2")
    assert status == 0
    assert err == (f"asymptotics: 2 of 9 rows left out: not resolved, first at k = {k[3]}\n"
                   f"asymptotics: 1 of 7 points left out: not a number, first at k = {float(k[5]):g}\n")
    assert "6 points" in out.splitlines()[-1]
    outgrown = reform(text, lambda number, cells: [*cells[:-1], "resolved; outgrown"])
    assert checked(capsys, monkeypatch, outgrown, "film", "--order", "2")[2] == ""


def test_growth_rates_alone_are_judged_as_real_part(capsys, monkeypatch):
    text = numerics(capsys, "film")
    alone = reform(text, lambda number, cells: [*cells[:2], cells[3]]).replace(
        "k,growth_rate,phase_speed,error,group_speed,group_error,degree,status", "k,growth_rate,error")
    status, out, _ = checked(capsys, monkeypatch, alone, "film", "--order", "2")
    assert status == 0
    assert "agrees with the expected 4.0000" in out.splitlines()[-1]
    assert (status, out) == checked(capsys, monkeypatch, text, "film", "--order", "2", "--part", "real")[:2]
    wrong = reform(alone, lambda number, cells: [cells[0], repr(float(cells[1]) * 1.005), *cells[2:]])
    status, out, err = checked(capsys, monkeypatch, wrong, "film", "--order", "2")
    assert status == 3
    assert "the coefficient of k^2 differs by" in err
    assert "column phase_speed, which --part imag needs" in _refusal(capsys, monkeypatch, alone, "--part", "imag")


def _refusal(capsys, monkeypatch, text, *arguments):
    monkeypatch.setattr(sys, "stdin", io.StringIO(text))
    return refused(capsys, "check", "film", *arguments)


def test_a_wrong_growth_rate_does_not_hide_behind_the_phase(capsys, monkeypatch):
    assert stability(["dispersion", "film", "--slope-deg", "45", "--k", "0.01:0.3:20", "--csv"]) == 0
    text = capsys.readouterr().out
    wrong = reform(text, lambda number, cells: [
        cells[0], repr(float(cells[1]) + 0.005 * 14 / 3 * float(cells[0]) ** 2), *cells[2:]])
    for numbers, status in ((text, 0), (wrong, 3)):
        found, out, err = checked(capsys, monkeypatch, numbers, "film", "--order", "2")
        assert found == status, out
    assert err.startswith("asymptotics: observed order 4.1679 of the real part differs from the expected 4.0000: the "
                          "coefficient of k^2 differs by 0.02")
    assert out.splitlines()[0] == "# " + err.removeprefix("asymptotics: ").strip()
    assert out.splitlines()[1].split() == ["k", "numeric", "series", "error", "slope"]
    assert len(out.splitlines()) == 2 + 20


# -- the same verdict, whoever asks -------------------------------------------------------------------------

SAMPLES = {
    "film": ("film", None, {"Re": 2.0, "slope_deg": 45.0, "We": 0.5}, 0.1),
    "rollwave": ("rollwave", None, {"slope_deg": 28.0, "Fr2": 4.0, "mu1": 0.38, "mu2": 0.64}, 0.03),
    "two_layer_couette": ("two_layer_couette", None, {
        "viscosity_ratio": 2.0, "depth_ratio": 0.7, "density_ratio": 1.5, "Re": 0.2, "gravity": 1.0,
        "tension": 1.0}, 0.3),
    "vortex": ("vortex", None, {"slope_deg": 30.0, "Fr2": 0.1}, 0.5),
    "shallow": ("dune", "shallow", {"shields": 1.5, "mu1": 0.4, "b": 1.0, "Re": 1.0, "depth": 10.0}, 1e-4),
    "boundary-layer": ("dune", "boundary-layer", {"shields": 1.5, "mu1": 0.4, "b": 1.0, "Re": 1.0}, 1e-6),
}
KINDS = {"film": Film, "rollwave": RollWave, "two_layer_couette": TwoLayerCouette, "vortex": Vortex, "dune": Dune}


def perturbed(sample, rng):
    """Numerics of a flow, some of them wrong in a coefficient, noisy, unresolved or beyond the series."""
    flow, regime, values, highest = SAMPLES[sample]
    k = np.geomspace(0.01, 1, int(rng.integers(4, 14))) * highest * 10 ** rng.uniform(-0.3, 1.0)
    relation = dispersion(KINDS[flow](**values), k)
    law = expand(flow, regime, **values)
    sigma, error = relation.sigma.copy(), relation.error.copy()
    if rng.random() < 0.6:
        power, coefficient = list(law.values().items())[rng.integers(len(law.terms))]
        sigma += 10 ** rng.uniform(-4, -1) * rng.choice([1, 1j, coefficient]) * k ** float(power)
    if rng.random() < 0.3:
        error += 1e-6 * abs(sigma)
        sigma += 1e-6 * abs(sigma) * (rng.uniform(-1, 1, len(k)) + 1j * rng.uniform(-1, 1, len(k))) / 2
    if rng.random() < 0.2:
        sigma[rng.integers(len(k))] = np.nan
    return law, k, sigma, error


def asserted(*arguments, **options):
    """What `assert_order` says, as an exit status and a line."""
    try:
        return 0, assert_order(*arguments, **options).verdict
    except OrderMismatch as mismatch:
        return 3, mismatch.comparison.verdict
    except TooFewPoints as refusal:
        return 2, str(refusal)


@pytest.mark.parametrize("sample", SAMPLES)
def test_the_command_and_the_assertion_say_the_same(capsys, monkeypatch, sample):
    flow, regime, values, _ = SAMPLES[sample]
    rng, found = np.random.default_rng(list(sample.encode())), []
    for _ in range(35):
        law, k, sigma, error = perturbed(sample, rng)
        part, tolerance = str(rng.choice(["both", "both", "real", "imag"])), float(rng.choice([0.05, 0.1]))
        growth, speed = sigma.real, -sigma.imag / k
        rows = zip(k.tolist(), growth.tolist(), speed.tolist(), error.tolist(), strict=True)
        text = "".join([*(f"# {name}: {value}\n" for name, value in values.items()),
                        "k,growth_rate,phase_speed,error\n", *(",".join(map(repr, row)) + "\n" for row in rows)])
        options = [*(["--regime", regime] if regime else []), "--part", part, "--tolerance", str(tolerance)]
        status, out, err = checked(capsys, monkeypatch, text, flow, *options)
        said = out.splitlines()[-1].removeprefix("# ") if status == 0 else err.splitlines()[-1].partition(": ")[2]
        assert (status, said) == asserted(growth - 1j * k * speed, law, k, error=error, part=part, tolerance=tolerance)
        found.append(status)
    assert {0, 3} <= set(found)


# -- as a program -------------------------------------------------------------------------------------------


def program(*arguments, **options):
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    return subprocess.run([sys.executable, "-m", "asymptotics", *arguments], cwd=ROOT, env=environment, check=False,
                          capture_output=True, text=True, **options)


def test_as_a_program():
    assert program("--version").stdout.startswith("asymptotics ")
    listing = program("flows")
    assert listing.returncode == 0
    assert all(name in listing.stdout for name in ("vortex", "dune", "--slope-deg", "--Fr2", "near-yield"))
    failed = program("expand", "dune", "--shields", "1")
    assert (failed.returncode, failed.stdout, len(failed.stderr.splitlines())) == (2, "", 1)


def test_both_programs_have_the_version_of_the_package():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    assert program("--version").stdout == f"asymptotics {project['version']}\n"
    assert project["version"] == asymptotics_version == stability_version


@pytest.mark.parametrize("verb", ["flows", "expand", "check"])
def test_help_has_an_example(verb):
    text = program(verb, "--help").stdout
    assert "example: " in text
    assert f"asymptotics {verb}" in text.splitlines()[-1]


def test_help_lists_the_parameters_of_the_flow_that_is_named():
    general, vortex = program("expand", "--help").stdout, program("expand", "vortex", "--help").stdout
    assert "--Fr2" not in general
    assert "asymptotics expand FLOW --help" in general
    assert "--Fr2 V" in vortex
    assert "--shields" not in vortex


@pytest.mark.skipif(sys.platform == "win32", reason="needs a pseudo-terminal")
@pytest.mark.parametrize("arguments", [["flows", "dune"], ["expand", "dune", "--regime", "shallow"]])
def test_lines_are_no_wider_than_the_terminal(arguments):
    import pty

    near, far = pty.openpty()
    command = [sys.executable, "-m", "asymptotics", *arguments]
    subprocess.run(command, cwd=ROOT, env={**os.environ, "COLUMNS": "60"}, stdout=far, check=True)
    os.close(far)
    shown = os.read(near, 100_000).decode().replace("\r", "")
    whole = program(*arguments).stdout
    assert max(map(len, shown.splitlines())) <= 60 < max(map(len, whole.splitlines()))
    assert shown.split() == whole.split()


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="needs /dev/full")
def test_a_full_disk_is_one_line():
    done = subprocess.run(["bash", "-c", f"{sys.executable} -m asymptotics flows > /dev/full"], cwd=ROOT, check=False,
                          capture_output=True, text=True)
    assert done.returncode == 2
    assert done.stderr == "asymptotics: cannot write to standard output: No space left on device\n"


def test_a_broken_pipe_is_quiet():
    command = f"{sys.executable} -m asymptotics flows | true"
    done = subprocess.run(["bash", "-c", command], cwd=ROOT, env={**os.environ, "PYTHONPATH": str(ROOT)}, check=False,
                          capture_output=True, text=True)
    assert done.stderr == ""


def test_interruption(monkeypatch, capsys):
    def interrupted(arguments):
        raise KeyboardInterrupt

    monkeypatch.setattr(cli, "_flows", interrupted)
    assert cli.main(["flows"]) == 130
    assert capsys.readouterr().err == "asymptotics: interrupted\n"


@pytest.mark.parametrize(("command", "imported"), [
    ("--help", ""), ("expand --help", ""), ("check -h", ""), ("expand dunes", ""), ("flows dunes", ""), ("", ""),
    ("flows", "sympy"), ("flows dune", "sympy"), ("expand dune --help", "sympy"), ("expand dune --shieldz 3", "sympy"),
    ("expand dune --shields 1/2", "sympy"), ("evaluate dune --k 0", "sympy"), ("evaluate dune --k 1:0:3", "sympy"),
    ("check dune --tolerance 0 x.csv", "sympy")])
def test_what_is_imported(command, imported):
    """For help and slips at most sympy, and that only where a flow is named."""
    script = ("import sys; from contextlib import suppress; from asymptotics.cli import main\n"
              f"with suppress(SystemExit): main({command.split()})\n"
              "print(*sorted({'sympy', 'numpy', 'scipy', 'matplotlib'} & set(sys.modules)))")
    done = subprocess.run([sys.executable, "-c", script], cwd=ROOT, capture_output=True, text=True, check=True,
                          env={**os.environ, "PYTHONPATH": str(ROOT)})
    assert done.stdout.splitlines()[-1] == imported


def test_neither_package_imports_the_other():
    for package, other in (("asymptotics", "stability"), ("stability", "asymptotics")):
        for source in (ROOT / package).rglob("*.py"):
            lines = source.read_text().splitlines()
            assert not [line for line in lines if line.strip().startswith((f"import {other}", f"from {other}"))]
