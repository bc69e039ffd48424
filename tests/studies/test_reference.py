"""The reference is complete: every public name says units or scales, what it raises, and shows itself in an example."""

import doctest
import importlib
import inspect
import pkgutil
import re
from dataclasses import fields, is_dataclass

import matplotlib
import mpmath as mp
import pytest

import asymptotics
import stability
from stability import flows
from stability.modes import energy, short_waves
from stability.output import columns, record, stored
from stability.studies import base, compare, critical, explore, neutral, sensitivity
from stability.studies import kmax as optimum
from stability.studies import map as maps

UNITS = re.compile(r"\b(scales?|units?|1/L|V/L|columns?|degrees)\b", re.I)
RAISES = re.compile(r"\b(raise[sd]?|raising)\b", re.I)  # what can raise nothing says "Raises nothing"
SHAPES = re.compile(r"\((points|modes|heights|flows|size|values|parameters|count)\b[^)]*\)|shape of|two of them")
ARRAYS = {"DispersionRelation", "Spectrum", "BaseFlow", "WellPosedness", "Map", "NeutralCurve", "Mode",
          "base_flow", "neutral_curve", "explore", "Optima", "Sensitivities"}  # what takes or holds arrays
RECORDS = {"DispersionRelation": stability.DispersionRelation, "Mode": stability.Mode, "Optimum": optimum.Optimum,
           "Optima": optimum.Optima, "Spectrum": stability.Spectrum, "NeutralPoint": critical.NeutralPoint,
           "NeutralCurve": neutral.NeutralCurve, "NeutralSweep": critical.NeutralSweep,
           "Sensitivities": sensitivity.Sensitivities, "Map": maps.Map, "BaseFlow": base.BaseFlow,
           "Stored": stored.Stored, "Record": record.Record, "Comparison": compare.Comparison,
           "WellPosedness": short_waves.WellPosedness, "Expansion": asymptotics.Expansion}
FUNCTIONS = {"base_flow": base.base_flow, "explore": explore.explore, "compare": compare.compare,
             "well_posedness": short_waves.well_posedness, "energy": energy.energy, "Energy": energy.Energy,
             "condition_numbers": energy.condition_numbers, "column": columns.column, "known": columns.known,
             "explained": columns.explained, "FLOWS": type(flows.FLOWS)}


def public():
    """{name: object} of all that has to be complete."""
    modules = (stability, flows, asymptotics)
    listed = {name: getattr(module, name) for module in modules for name in module.__all__}
    return {**{name: value for name, value in listed.items() if callable(value)}, **RECORDS, **FUNCTIONS}


def lacks(name, value):
    """What the docstring of a public name lacks: a list of words."""
    text = inspect.getdoc(value) or ""
    found = {"example": ">>>" in text, "units": UNITS.search(text), "errors": RAISES.search(text),
             "shapes": name not in ARRAYS or SHAPES.search(text)}
    return [what for what, there in found.items() if not there]


def members_lacking(value):
    """The fields of a record that its docstring does not name, and the methods and properties without one."""
    text = " ".join(inspect.getdoc(one) or "" for one in value.__mro__[:-1])
    names = [item.name for item in fields(value)] if is_dataclass(value) else []
    unnamed = [name for name in names if not re.search(rf"\b{name}\b", text)]
    methods = [name for name in dir(value) if not name.startswith("_") and name not in names]
    return unnamed + [name for name in methods if not _documented(value, name)]


def _documented(value, name):
    """A docstring of its own or of what it overrides; with arguments, what is raised as well."""
    found = inspect.getattr_static(value, name)
    if not (callable(found) or isinstance(found, property) or hasattr(found, "func")):
        return True  # a plain constant of the class
    text = inspect.getdoc(getattr(found, "func", found)) or inspect.getdoc(getattr(value, name)) or ""
    bare = not callable(found) or len(inspect.signature(found).parameters) < 2
    return bool(text) and (bare or bool(RAISES.search(text)))


def test_no_public_name_lacks_anything():
    assert {name: lack for name, value in public().items() if (lack := lacks(name, value))} == {}


def test_no_member_of_a_record_lacks_anything():
    assert {name: lack for name, value in RECORDS.items() if (lack := members_lacking(value))} == {}
    assert members_lacking(flows.Flow) == []


def test_what_is_lacking_is_found():
    def bare(k):
        """Return k."""

    class Empty(record.Record):
        """Nothing."""

        def ask(self, k):
            """Return k."""

        def rest(self):
            pass

    assert lacks("bare", bare) == ["example", "units", "errors"]
    assert lacks("BaseFlow", bare)[-1] == "shapes"
    assert members_lacking(Empty) == ["ask", "rest"]


def examples():
    """The doctests of all modules, each once."""
    finder, found = doctest.DocTestFinder(recurse=True), {}
    names = [name for package in (stability, asymptotics) for _, name, _ in
             pkgutil.walk_packages(package.__path__, f"{package.__name__}.") if not name.endswith("__main__")]
    for module in map(importlib.import_module, ("stability", "asymptotics", *sorted(names))):
        for test in finder.find(module, module.__name__):
            if test.examples:
                found[test.name] = test
    return found


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("name", examples())
def test_example(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    matplotlib.use("agg")
    runner = doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE)
    told = []
    with mp.workdps(15):  # whatever other tests have left it at
        result = runner.run(examples()[name], out=told.append)
    assert result.attempted > 0
    assert not result.failed, "".join(told)


REFUSED = {
    "well_posedness": lambda: short_waves.well_posedness("dune"),
    "compare: flow": lambda: compare.compare("dune", 1.0),
    "compare: methods": lambda: compare.compare(flows.Vortex(), 1.0, ["guess"]),
    "base_flow": lambda: base.base_flow("dune"),
    "explore": lambda: explore.explore("dune"),
    "dispersion": lambda: stability.dispersion("dune", 1.0),
    "spectrum": lambda: stability.spectrum("dune", 1.0),
    "k_max": lambda: stability.k_max("dune"),
    "critical": lambda: stability.critical("dune", "Re"),
    "neutral_curve": lambda: stability.neutral_curve("dune", "Re", 1.0),
    "parameter_map": lambda: stability.parameter_map("dune", {"Re": [1.0]}),
    "load": lambda: stability.load("no such file.csv"),
    "find": lambda: flows.find("no such flow"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_none_raises_what_the_reference_says(name):
    with pytest.raises(stability.ParameterError):
        REFUSED[name]()


def test_expansions_raise_what_the_reference_says():
    law = asymptotics.expand("vortex", order=2)
    with pytest.raises(KeyError):
        law.coefficient(17)
    with pytest.raises(TypeError):
        law.truncated("two")
    with pytest.raises(ValueError, match="still depends"):
        law.function()
