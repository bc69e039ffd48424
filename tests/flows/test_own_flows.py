"""Flows from files outside the package: what they give, and what is wrong with them in one line."""

import json
import pickle
import re
import subprocess
import sys
from pathlib import Path
from typing import ClassVar

import pytest

from stability import cli, dispersion, flows, spectrum
from stability.cli.command import parser_of
from stability.cli.verbs import VERBS
from stability.errors import ParameterError
from stability.flows import contract, sources

FILES = Path(__file__).parents[1] / "own"
JET = (FILES / "jet.py").read_text()
FILE = f"{FILES / 'jet.py'}:Bickley"
QUICK = ("--k", "0.2", "--mode", "leading")


def run(capsys, *words):
    status = cli.main([str(word) for word in words])
    captured = capsys.readouterr()
    return status, captured.out, captured.err


@pytest.fixture
def file(tmp_path):
    """Write the file of the jet with changes; return its name for the command line."""
    def written(*changes, name="jet.py", cls="Bickley"):
        text = JET
        for before, after in changes:
            assert before in text
            text = text.replace(before, after)
        path = tmp_path / name
        path.write_text(text)
        return f"{path}:{cls}"

    return written


# -- from anywhere --------------------------------------------------------------------------------------

def test_a_file_answers_like_a_class_of_the_package(capsys):
    status, out, err = run(capsys, "dispersion", FILE, "--Re", "20", *QUICK, "--json")
    assert (status, err) == (0, "")
    result = json.loads(out)
    assert result["source"] == "jet.py:Bickley"
    assert re.fullmatch("sha256:[0-9a-f]{16}", result["digest"])
    assert result["parameters"] == {"Re": 20.0, "cut": 100.0}
    mode = spectrum(flows.find(FILE)(Re=20.0), 0.2, 1).modes[0]
    assert result["rows"][0]["growth_rate"] == pytest.approx(mode.growth_rate, abs=1e-12)


def test_parameters_may_come_before_the_flow(capsys):
    assert run(capsys, "dispersion", "--Re", "20", "--csv", FILE, *QUICK)[1] == \
        run(capsys, "dispersion", FILE, "--Re=20", *QUICK, "--csv")[1]


def test_modules_are_known_by_their_names(capsys, monkeypatch):
    monkeypatch.syspath_prepend(str(FILES))
    status, out, _ = run(capsys, "dispersion", "jet:Bickley", *QUICK, "--csv")
    assert status == 0
    assert "# source: jet:Bickley" in out
    assert run(capsys, "dispersion", FILE, *QUICK, "--csv")[1].splitlines()[-1] == out.splitlines()[-1]


def test_installed_packages_offer_flows(capsys, monkeypatch, tmp_path):
    package = tmp_path / "jets-1.0.dist-info"
    package.mkdir()
    (package / "METADATA").write_text("Name: jets\nVersion: 1.0\n")
    (package / "entry_points.txt").write_text("[stability.flows]\njet = plane_jets:Bickley\nbroken = nowhere:Jet\n")
    (tmp_path / "plane_jets.py").write_text(JET)
    monkeypatch.syspath_prepend(str(tmp_path))
    assert run(capsys, "dispersion", "jet", *QUICK)[0] == 0
    assert "plane jet, sinuous modes" in run(capsys, "flows", "jet")[1]
    status, _, err = run(capsys, "dispersion", "jett", *QUICK)
    assert (status, "(did you mean 'jet'?)" in err) == (2, True)
    status, _, err = run(capsys, "dispersion", "broken", *QUICK)
    assert (status, err.count("\n")) == (2, 1)
    assert "entry point broken: there is no module nowhere" in err


def test_registered_flows_are_known_by_name(capsys, monkeypatch):
    jet = flows.find(FILE)
    monkeypatch.setattr(flows.catalogue.FLOWS, "_known", dict(flows.FLOWS._known))
    assert flows.register(jet) is jet
    assert run(capsys, "dispersion", "bickley", *QUICK)[0] == 0
    with pytest.raises(ParameterError, match="the name 'bickley' belongs to Bickley"):
        flows.register(type("Other", (jet,), {}))


def test_help_and_flows_know_the_parameters(capsys):
    with pytest.raises(SystemExit):
        cli.main(["kmax", FILE, "--help"])
    assert "height at which the domain is cut" in " ".join(capsys.readouterr().out.split())
    status, out, _ = run(capsys, "flows", FILE)
    assert status == 0
    assert "bickley: plane jet, sinuous modes" in out
    assert "--cut" in out


def test_workers_find_the_file(capsys, tmp_path):
    out = tmp_path / "map.csv"
    assert run(capsys, "map", FILE, "--over", "Re=10,20", "--over", "cut=100,120", "--k", "0.2", "-o", out,
               "--workers", "2")[0] == 0
    assert out.read_text().count("resolved") == 4
    assert "# source: jet.py:Bickley" in out.read_text()


def test_a_map_is_not_resumed_with_another_version(capsys, tmp_path, file):
    name, out = file(), tmp_path / "map.csv"
    command = "map", name, "--over", "Re=10,20", "--k", "0.2", "-o", out, "--workers", "1"
    request = parser_of([str(word) for word in command]).parse_args([str(word) for word in command])
    from stability.cli.verbs.map import _request
    from stability.studies.map import carry_out

    carry_out(_request(request)(), journal=f"{out}.partial")
    file(("cosh(z) ** 2", "cosh(z) ** 4"))
    status, _, err = run(capsys, *command)
    assert (status, err.count("\n")) == (2, 1)
    assert "digest" in err
    assert not out.exists()


def test_two_versions_of_a_file_are_two_classes(file):
    before = flows.find(file())
    assert flows.find(file()) is before
    after = flows.find(file(("CLUSTER = 0.1", "CLUSTER = 0.2")))
    assert after is not before
    assert sources.origin(after)["digest"] != sources.origin(before)["digest"]


def test_the_digest_covers_the_modules_beside_the_file(file, tmp_path):
    beside = tmp_path / "shape_of_a_jet.py"
    beside.write_text("CLUSTER = 0.1\n")
    name = file(("CLUSTER = 0.1  # of the heights at the centreline", "import shape_of_a_jet\n\n"
                 "CLUSTER = shape_of_a_jet.CLUSTER"))
    before = sources.origin(flows.find(name))["digest"]
    beside.write_text("CLUSTER = 0.2\n")
    code = f"from stability.flows import find, sources; print(sources.origin(find({name!r}))['digest'])"
    after = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.strip()
    assert after != before
    assert re.fullmatch("sha256:[0-9a-f]{16}", after)


def test_flows_from_files_are_pickled(file):
    name = file()
    flow = flows.find(name)(Re=7.0)
    sent = pickle.dumps(flow)
    assert pickle.loads(sent) == flow
    file(("cosh(z) ** 2", "cosh(z) ** 4"))
    with pytest.raises(ParameterError, match="has changed while it was in use"):
        pickle.loads(sent)


# -- what is wrong --------------------------------------------------------------------------------------

RE = re.search("    Re: float = .*", JET)[0]
FIELD = "eta=1 / self.Re"
U = "U=1 / np.cosh(z) ** 2"
RETURN = "return centreline.v, centreline.n, far.v + k * far.w, far.t - 2 / self.Re * k**2 * far.w"
FUNCTION = '''    functions: ClassVar = ("F",)

    def evaluate(self, k):
        return {}

    def layers'''
BROKEN = {  # changes of the file, and what the line says
    "syntax": ([(RE, "    Re: float =")], r"jet\.py, line 26: invalid syntax"),
    "import": ([("import numpy as np", "import numpyy as np")], r"jet\.py, line 6: ModuleNotFoundError: .*numpyy"),
    "failure": ([("CLUSTER = 0.1", "CLUSTER = 1 / 0")], r"jet\.py, line 10: ZeroDivisionError"),
    "exit": ([("CLUSTER = 0.1", "raise SystemExit(1)")], r"jet\.py, line 10: SystemExit"),
    "no flow": ([("class Bickley(Flow)", "class Bickley")], "Bickley is no flow: derive the class from stability"),
    "name": ([('    name: ClassVar[str] = "bickley"\n', "")], 'no name: add name: ClassVar.str. = "bickley"'),
    "name of two words": ([('= "bickley"', '= "plane jet"')], r"line 14: Bickley\.name: must be a word.*'plane jet'"),
    "layers": ([("def layers", "def layer")], r"Bickley has no layers: define layers\(self, names\)"),
    "conditions": ([("def conditions", "def edges")], "Bickley has no conditions"),
    "plain field": ([(RE, "    Re: float = 10.0")], r"line 14: Bickley\.Re: declare it as a parameter, Re: float = "
                    r"parameter\(10\.0, meaning"),
    "field without default": ([(RE, "    Re: float")], r"Bickley\.Re: declare it as a parameter"),
    "without a type": ([("Re: float = ", "Re = ")], r"Bickley\.Re: parameters carry a type"),
    "without dataclass": ([("@dataclass(frozen=True)\n", "")], r"write @dataclass\(frozen=True\) above the class"),
    "option": ([("    cut: float", "    mode: float")], r"Bickley\.mode: .* an option of the command line"),
    "symbol": ([("    cut: float", "    rate: float")], r"Bickley\.rate: .* a symbol"),
    "attribute": ([("    cut: float", "    order: float")], r"Bickley\.order: .* an attribute of flows"),
    "heading": ([("    cut: float", "    scales: float")], r"Bickley\.scales: .* a heading of results"),
    "tuple of letters": ([("    wavenumber", '    surfaces: ClassVar = "s0"\n    wavenumber')],
                         r"Bickley\.surfaces: must be a tuple of names"),
    "order": ([("    wavenumber", "    order: ClassVar = 2\n    wavenumber")], r"Bickley\.order: must be one of 0, 1"),
    "arguments": ([("def conditions(self, edges, names)", "def conditions(self, edges)")],
                  r"Bickley\.conditions: takes \(self, edges, names\) \(got \(self, edges\)\)"),
    "too few conditions": ([(RETURN, "return far.v, far.w")], "expected 4 conditions .4 for fluid.*, got 2"),
    "no tuple of conditions": ([(RETURN, "return far.v")], r"conditions\(edges, names\) must return a tuple"),
    "a number as condition": ([(RETURN, "return centreline.v, centreline.n, far.v, 0.0")],
                              "condition 4 has no unknown"),
    "the same condition twice": ([(RETURN, "return centreline.v, centreline.n, far.v, 2 * far.v")],
                                 "conditions 3 and 4 say the same"),
    "nonlinear condition": ([("far.v + k * far.w", "far.v * far.w")], "must be linear in the unknowns"),
    "quadratic in the rate": ([("far.v + k * far.w", "names.rate**2 * far.v")],
                              "linear in the unknowns and in the rate"),
    "negative power": ([("k**2", "k**-1")], r"jet\.py, line 40 \(conditions\): TypeError: a power of a symbol"),
    "wrong layer": ([("edges.fluid", "edges.water")], r"jet\.py, line 38 \(conditions\): AttributeError"),
    "no tuple of layers": ([("return (Layer(", "return (Layer("), ('profile),)', 'profile))')],
                           r"layers\(names\) must return a tuple of Layers"),
    "no profile": ([("return Profile(", "return dict(")], "its profile must return a Profile"),
    "failing profile": ([("1 / np.cosh(z)", "1 / np.coshh(z)")], r"jet\.py, line 32 \(profile\): AttributeError"),
    "dU = 0": ([(U, f"{U}, dU=0.0")],
               r"layer fluid: dU contradicts the slope of U in z: at z = \S+ it is 0, the slope "),
    "sign of dU": ([(U, f"{U}, dU=2 * np.tanh(z) / np.cosh(z) ** 2")], "dU contradicts the slope of U in z"),
    "dU per s": ([(U, f"{U}, dU=-2 * np.tanh(z) / np.cosh(z)**2 * self.cut * (CLUSTER + 3 * (1 - CLUSTER) * s**2)")],
                 "dU contradicts the slope of U in z"),
    "dU off by a millionth": ([(U, f"{U}, dU=-2.000002 * np.tanh(z) / np.cosh(z) ** 2")], "dU contradicts the slope"),
    "dg": ([(U, f"{U}, g=1 + s, dg=2.0")], "dg contradicts the slope of g in s: at z = .* it is 2, the slope 1"),
    "dz of the other sign": ([("dz=self.cut", "dz=-self.cut")], r"dz must be positive, s = 0 is below: it is -"),
    "eta < 0": ([(FIELD, "eta=-1 / self.Re")], r"layer fluid: eta must be positive: it is -0\.1 at z = "),
    "beta changes sign": ([("beta=1 / self.Re", "beta=0.5 - s")], r"beta must be positive: it is -.* at z = "),
    "rho < 0": ([(U, f"{U}, rho=-1.0")], "rho must not be negative: it is -1 at z = "),
    "clear has a zero": ([(U, f"{U}, clear=s - 0.5")], "clear must not change its sign"),
    "nan": ([(U, "U=np.where(s < 0.5, np.nan, s)")], "U is nan"),
    "infinite": ([(FIELD, "eta=np.inf")], "eta is inf|eta must"),
    "shape": ([(U, "U=np.zeros(3)")], r"U has the shape \(3,\)"),
    "complex": ([(U, "U=1j / np.cosh(z) ** 2")], "U is complex"),
    "kink": ([(U, "U=np.abs(s - 0.3)")], "U is not smooth near z = "),
    "functions": ([("    def layers", FUNCTION)], r"evaluate\(k\) must return .* functions F .got none"),
    "slope in k": ([("    def layers", FUNCTION.replace("{}", '{"F": (k**2, k, 0 * k)}'))],
                   r"the slope of F in k contradicts its values: at k = \S+ it is 0\.1, differences give 0\.2"),
    "triple": ([("    def layers", FUNCTION.replace("{}", '{"F": (k, 1 + 0 * k)}'))], "must be .value, slope, error."),
    "error of a function": ([("    def layers", FUNCTION.replace("{}", '{"F": (k, 1 + 0 * k, k - 2)}'))],
                            "F must be finite, its error not negative"),
}


@pytest.mark.parametrize("case", BROKEN)
def test_what_is_broken_is_one_line(capsys, file, case):
    changes, message = BROKEN[case]
    status, out, err = run(capsys, "dispersion", file(*changes), *QUICK)
    assert (status, out, err.count("\n")) == (2, "", 1), err
    assert re.search(message, err), err
    assert "Traceback" not in err


@pytest.mark.parametrize(("name", "message"), [
    ("{}", "name the class of the flow: .*jet.py:Class; its flows: Bickley"),
    ("{}:", "name the class of the flow"),
    ("{}:Jet", "there is no Jet in it; its flows: Bickley"),
    ("{}:np", "numpy is no flow"),
    ("nothing.py:Jet", "nothing.py: cannot be read: No such file or directory"),
    ("nothing:Jet", "there is no module nothing; a file is named path/to/file.py:Jet"),
    ("json:Jet", "json: there is no Jet in it; it has no flows"),
    ("vrtex", r"unknown flow 'vrtex' .did you mean 'vortex'\?.; .* a flow of your own is named path/to/file.py:Class"),
])
def test_wrong_names(capsys, file, name, message):
    status, out, err = run(capsys, "dispersion", name.format(file().rpartition(":")[0]), *QUICK)
    assert (status, out, err.count("\n")) == (2, "", 1), err
    assert re.search(message, err), err


class _Film(flows.Film):
    """A film whose long-wave limit is multiplied by a factor, a class that is none of the package."""

    factor: ClassVar[float] = 1.0

    def long_wave(self, k):
        return self.factor * super().long_wave(k)


def test_the_long_wave_limit_is_compared():
    assert dispersion(_Film(), 0.5).growth_rate[0] == dispersion(flows.Film(), 0.5).growth_rate[0]
    for factor, said in ((1.01, r"at k = \S+ it is .*, the mode .*, and comes no closer"), (1.5, "no mode obeys it")):
        wrong = type("_Wrong", (_Film,), {"factor": factor})
        with pytest.raises(ParameterError, match=f"film: long_wave contradicts the equations: {said}"):
            dispersion(wrong(), 0.5)


@pytest.mark.parametrize("name", list(flows.FLOWS))
def test_the_flows_of_the_package_keep_the_contract(name):
    for flow in (flows.FLOWS[name](), *flows.FLOWS[name]().halves()):
        contract.verify(flow)


def test_no_parameter_can_be_named_like_an_option():
    taken = {action.dest for verb in VERBS for action in parser_of([verb])._subparsers._group_actions[0].choices[
        verb]._actions}
    assert taken - {"parameters"} <= contract.OPTIONS
