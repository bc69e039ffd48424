"""The pages of the documentation: examples and commands run, links lead somewhere, tables are whole."""

import doctest
import re
import shlex
import subprocess
import sys
from pathlib import Path

import matplotlib
import numpy as np
import pytest

from stability.cli import main
from stability.cli.verbs import VERBS
from stability.docs.build import PAGES, ROOT, build, check_links
from stability.docs.tables import columns_page, commands_page, figures, flows_page, gallery_page
from stability.flows import FLOWS
from stability.output.columns import BY_VERB

TEXTS = {page.stem: page.read_text(encoding="utf-8") for page in PAGES.glob("*.md")}
BIN = Path(sys.executable).parent


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder with the files that the pages speak of."""
    monkeypatch.chdir(tmp_path)
    matplotlib.use("agg")
    (program,) = re.findall(r"```python\n(.*?)```", TEXTS["howto_own_flow"], re.S)
    (tmp_path / "channel.py").write_text(program)
    z = np.linspace(-1, 1, 41)
    table = "\n".join(f"{height},{speed},0.001" for height, speed in zip(z, 1 - z**2, strict=True))
    (tmp_path / "jet.csv").write_text(f"z,U,U_error\n{table}\n")
    return tmp_path


def lines_of_shell():
    return [(name, line) for name, text in TEXTS.items() for block in re.findall(r"```sh\n(.*?)```", text, re.S)
            for line in block.splitlines()]


@pytest.mark.parametrize("name", [name for name in sorted(TEXTS) if ">>>" in TEXTS[name]])
def test_examples_of_a_page(folder, name):
    text = re.sub(r"```.*?```", "", TEXTS[name], flags=re.S)
    test = doctest.DocTestParser().get_doctest(text, {}, name, name, 0)
    told = []
    result = doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE).run(test, out=told.append)
    assert result.attempted > 0
    assert not result.failed, "".join(told)


def test_commands_of_the_pages(folder, capsys):
    """In the order of a page: a command may read what the one before it wrote."""
    for name, line in lines_of_shell():
        if "|" in line or ">" in line:
            done = subprocess.run(["bash", "-c", f'set -eo pipefail; PATH="{BIN}:$PATH"; {line}'], capture_output=True,
                                  text=True)
            assert done.returncode == 0, (name, line, done.stderr)
        else:
            program, *words = shlex.split(line)
            assert (program, main(words)) == ("stability", 0), (name, line, capsys.readouterr().err)
    assert {path.name for path in folder.glob("*.svg")} == {"dunes.svg", "vortices.svg", "map.svg"}


def test_tables_of_the_pages_are_whole():
    assert all(f"## {name}: " in flows_page() for name in FLOWS)
    assert all(f"\n## {verb}\n" in columns_page() for verb in BY_VERB)
    assert all(f"\n## stability {verb}\n" in commands_page() for verb in VERBS)
    gallery = gallery_page(ROOT / "figures")
    assert all(f'src="figures/{image.name}"' in gallery for image in figures(ROOT / "figures"))


@pytest.mark.parametrize("name", sorted(TEXTS))
def test_formulas_are_closed(name):
    text = re.sub(r"```.*?```|`[^`]*`", "", TEXTS[name], flags=re.S)
    displayed = re.findall(r"\$\$(.*?)\$\$", text, re.S)
    inline = re.sub(r"\$\$.*?\$\$", "", text, flags=re.S)
    assert "$$" not in inline
    assert inline.count("$") % 2 == 0
    for formula in (*displayed, *re.findall(r"\$(.*?)\$", inline, re.S)):
        assert formula.count("{") == formula.count("}"), formula
        assert formula.count(r"\left") == formula.count(r"\right"), formula


def test_a_figure_without_its_script_is_refused(tmp_path):
    with pytest.raises(FileNotFoundError, match="no figures in"):
        figures(tmp_path)
    (tmp_path / "a.png").touch()
    with pytest.raises(FileNotFoundError, match=r"script of a\.png is missing"):
        figures(tmp_path)
    (tmp_path / "a.py").write_text("x = 1\n")
    with pytest.raises(ValueError, match="has no docstring"):
        gallery_page(tmp_path)


def test_a_link_that_leads_nowhere_is_refused(tmp_path):
    (tmp_path / "a.html").write_text('<a href="b.html#c">b</a> <a href="https://x.org/d">d</a> <a href="#e">e</a>')
    with pytest.raises(ValueError, match=r"a\.html: b\.html"):
        check_links(tmp_path)
    (tmp_path / "b.html").touch()
    check_links(tmp_path)


@pytest.mark.skipif("not config.getoption('-k')", reason="built by .ci/run; ask for it with -k build")
def test_build(tmp_path):
    pytest.importorskip("pdoc")
    assert build(tmp_path / "docs") > 50
    assert "MathJax" in (tmp_path / "docs" / "theory.html").read_text()
