"""The folders of `stability` and the arrows between them: a folder imports only folders above it in `FOLDERS`.

Imports inside functions count: they save start-up time, not order. Imports for annotations alone (under TYPE_CHECKING)
are never executed; they may close a circle, but not point upward.
"""

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PACKAGE = ROOT / "stability"
FOLDERS = "", "numerics", "equations", "flows", "output", "modes", "bvp", "studies", "cli", "docs"
LAZY = {"", "__main__", "flows"}  # packages that import what they offer when it is asked for; the way in
DOORS = {  # from method to what it opens: a Mode is what these start from, and offers them
    ("modes.mode", "modes.eigenfunction"),
    ("modes.mode", "modes.velocity_response"),
    ("modes.mode", "studies.sensitivity"),
}


def modules(package):
    """{dotted name below the package: its file}; "" is the package."""
    return {name_of(file.relative_to(package)): file for file in package.rglob("*.py")}


def name_of(file):
    parts = file.with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def arrows(package):
    """(from, to, annotation only) of every import of one module of the package by another."""
    files = modules(package)
    for name, file in files.items():
        tree = ast.parse(file.read_text())
        hints = {id(inner) for node in ast.walk(tree) if isinstance(node, ast.If) and "TYPE_CHECKING" in
                 ast.dump(node.test) for inner in ast.walk(node)}
        home = name.split(".") if file.stem == "__init__" else name.split(".")[:-1]
        for node in ast.walk(tree):
            for target in targets(node, [part for part in home if part], files):
                yield name, target, id(node) in hints


def targets(node, home, files):
    """The modules that an import statement names, be it relative or of `stability`."""
    if isinstance(node, ast.ImportFrom) and (node.level or (node.module or "").split(".")[0] == "stability"):
        start = home[:len(home) - node.level + 1] if node.level else []
        below = (node.module or "").split(".")[0 if node.level else 1:]
        module = ".".join([*start, *(part for part in below if part)])
        for alias in node.names:
            inner = f"{module}.{alias.name}".lstrip(".")
            yield inner if inner in files else module
    elif isinstance(node, ast.Import):
        yield from (alias.name[10:] for alias in node.names if f"{alias.name}.".startswith("stability."))


def folder(name):
    first = name.split(".")[0]
    return first if first in FOLDERS else ""


def upward(package):
    found = {(name, target) for name, target, _ in arrows(package)
             if name not in LAZY and FOLDERS.index(folder(target)) > FOLDERS.index(folder(name))}
    return found - DOORS


def circles(package):
    """Modules from which imports lead back to themselves, with the doors closed."""
    graph: dict[str, set[str]] = {}
    for name, target, hint in arrows(package):
        if not hint and name not in LAZY and name != target and target and (name, target) not in DOORS:
            graph.setdefault(name, set()).add(target)
    return {name for name in graph if name in reach(graph, name)}


def reach(graph, start):
    seen: set[str] = set()
    left = list(graph.get(start, ()))
    while left:
        name = left.pop()
        if name not in seen:
            seen.add(name)
            left += graph.get(name, ())
    return seen


def test_no_import_points_upward():
    assert not upward(PACKAGE)


def test_no_circle_of_imports():
    assert not circles(PACKAGE)


def test_every_door_is_used():
    assert {(name, target) for name, target, _ in arrows(PACKAGE)} >= DOORS


def test_every_module_has_its_folder():
    outside = {name for name in modules(PACKAGE) if folder(name) == ""}
    assert outside == {"", "__main__", "checks", "errors", "status"}


@pytest.mark.parametrize("line", ["from ..modes.mode import Mode", "from stability.modes import mode",
                                  "def late():\n    from ..studies import base", "import stability.cli.command"])
def test_an_arrow_upward_is_seen(tmp_path, line):
    for name in modules(PACKAGE):
        file = tmp_path / f"{name.replace('.', '/')}.py"
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(line if name == "equations.system" else "")
    assert len(upward(tmp_path)) == 1


def test_a_circle_is_seen(tmp_path):
    (tmp_path / "modes").mkdir()
    (tmp_path / "modes" / "a.py").write_text("def late():\n    from . import b")
    (tmp_path / "modes" / "b.py").write_text("from .a import late")
    assert circles(tmp_path) == {"modes.a", "modes.b"}


LINES, BODY = 350, 40  # of a file, of a function with its docstring


def too_long(source):
    """What exceeds the limits in one file, {name: lines}; "" is the file."""
    functions = [node for node in ast.walk(ast.parse(source))
                 if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)]
    lengths = [(node.name, node.end_lineno - node.lineno + 1) for node in functions]
    found = {name: length for name, length in lengths if length > BODY}
    whole = len(source.splitlines())
    return found | ({"": whole} if whole > LINES else {})


@pytest.mark.parametrize("package", ["stability", "asymptotics"])
def test_no_file_and_no_function_is_long(package):
    long = {str(file.relative_to(ROOT)): too_long(file.read_text()) for file in (ROOT / package).rglob("*.py")}
    assert not {name: found for name, found in long.items() if found}


@pytest.mark.parametrize(("source", "names"), [
    ("x = 1\n" * LINES, set()), ("x = 1\n" * (LINES + 1), {""}),
    ("def short():\n" + "    x = 1\n" * (BODY - 1), set()),
    ("def long():\n" + "    x = 1\n" * BODY + "def long():\n    pass\n", {"long"}),
    ("class A:\n    async def long(self):\n" + "        x = 1\n" * BODY, {"long"})])
def test_what_is_long_is_seen(source, names):
    assert set(too_long(source)) == names


FOREIGN = {  # private names of argparse, matplotlib's sliders, scipy's netCDF and sympy: they offer no public ones
    "_SubParsersAction", "_actions", "_check_value", "_group_actions", "_option_string_actions", "_subparsers",
    "_handle", "_Encoding", "_attributes", "_to_mpmath", "_exit"}


def private(source):
    """Private names of others that a file uses: imported, or taken from anything but what it defines itself."""
    tree = ast.parse(source)
    found = {alias.name for node in ast.walk(tree) if isinstance(node, ast.ImportFrom) for alias in node.names}
    for node in ast.walk(tree):
        own = isinstance(node, ast.Attribute) and ast.unparse(node.value) in ("self", "cls", "super()")
        if isinstance(node, ast.Attribute) and not own:
            found.add(node.attr)
    own = {node.attr for node in ast.walk(tree) if isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Store)}
    own |= {node.name for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)}
    return {name for name in found if name.startswith("_") and not name.startswith("__")} - own - FOREIGN


@pytest.mark.parametrize("package", ["stability", "asymptotics"])
def test_no_file_needs_the_private_names_of_another(package):
    used = {str(file.relative_to(ROOT)): private(file.read_text()) for file in (ROOT / package).rglob("*.py")}
    assert not {name: found for name, found in used.items() if found}


@pytest.mark.parametrize(("source", "names"), [
    ("from .a import _b", {"_b"}), ("from . import a\nx = a._b", {"_b"}), ("x = y.z()._b", {"_b"}),
    ("from .a import __version__, b", set()), ("class A:\n    def f(self):\n        return self._b", set()),
    ("class A:\n    def __init__(self):\n        self._b = 1\n\n    def f(self, it):\n        return it._b", set())])
def test_a_private_name_is_seen(source, names):
    assert private(source) == names


SAME = {"add", "main", "profile"}  # of every verb, of both programs, the base flow in a module: one thing each


def defined(source):
    """The public names that a module defines."""
    for node in ast.parse(source).body:
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            yield node.name
        elif isinstance(node, ast.Assign):
            yield from (name.id for target in node.targets for name in ast.walk(target) if isinstance(name, ast.Name))


def test_a_public_name_means_one_thing():
    places: dict[str, list[str]] = {}
    for file in PACKAGE.rglob("*.py"):
        for name in defined(file.read_text()):
            if not name.startswith("_") and name not in SAME:
                places.setdefault(name, []).append(str(file.relative_to(PACKAGE)))
    assert not {name: found for name, found in places.items() if len(found) > 1}
