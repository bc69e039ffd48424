"""Write all pages: those of text in `pages/`, those of tables, and the reference, by pdoc."""

import argparse
import re
import shutil
import sys
import warnings
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from pkgutil import walk_packages
from types import ModuleType
from typing import Any

from .. import __version__
from .tables import columns_page, commands_page, figures, flows_page, gallery_page, modules_page

ROOT = Path(__file__).resolve().parents[2]
PAGES = Path(__file__).parent / "pages"
PACKAGES = "stability", "asymptotics"
_LEFT_OUT = re.compile(r"\.(docs|verbs|cli|__main__)\b")  # what is no library
_ALL = "stability", "stability.flows", "asymptotics"  # import what they offer when it is asked for
_HEADING = re.compile(r'<h1 class="modulename">.*?</h1>', re.S)  # pages of text have their own
_LINK = re.compile(r'(?:href|src)="([^"#?]+)')


def main(words: list[str] | None = None) -> int:
    """Write the documentation; return 0, or 1 with a line that says why not."""
    parser = argparse.ArgumentParser(prog="python -m stability.docs", description=__doc__)
    parser.add_argument("--out", type=Path, default=ROOT / "build" / "docs", metavar="DIR", help="default: build/docs")
    target = parser.parse_args(words).out
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            count = build(target)
    except ModuleNotFoundError as reason:
        return _fail(f"{reason}; pip install '.[docs]'")
    except (OSError, Warning, ValueError, RuntimeError) as reason:
        return _fail(reason)
    print(f"{count} pages in {target}")
    return 0


def _fail(reason: Any) -> Any:
    print(f"stability.docs: {reason}", file=sys.stderr)
    return 1


def build(target: Path) -> int:
    """Write all pages into the folder, in place of what was there; return how many.

    Raises ModuleNotFoundError without pdoc, ValueError for a link that leads nowhere.
    """
    import pdoc.doc
    import pdoc.render

    pdoc.render.configure(math=True, footer_text=f"granular-stability {__version__}", show_source=False,
                          include_undocumented=False)
    modules = {name: pdoc.doc.Module(import_module(name)) for name in _names()}
    texts = {name: pdoc.doc.Module(_module(name, text)) for name, text in _texts(modules).items()}
    if target.exists():
        shutil.rmtree(target)
    for name, module in {**modules, **texts}.items():
        page = target / f"{name.replace('.', '/')}.html"
        page.parent.mkdir(parents=True, exist_ok=True)
        html = pdoc.render.html_module(module, modules)
        page.write_text(_HEADING.sub("", html) if name in texts else html, encoding="utf-8")
    (target / "search.js").write_text(pdoc.render.search_index({**texts, **modules}), encoding="utf-8")
    _copy_figures(target / "figures")
    check_links(target)
    return len(modules) + len(texts)


def _names() -> Iterator[str]:
    """The modules of the reference, with what they import late in place."""
    for name in _ALL:
        module = import_module(name)
        vars(module).update({item: getattr(module, item) for item in module.__all__})
    for package in PACKAGES:
        names = [module.name for module in walk_packages(import_module(package).__path__, f"{package}.")]
        yield from (package, *(name for name in names if not _LEFT_OUT.search(name)))


def _texts(modules: Any) -> dict[str, str]:
    """{name: Markdown} of the pages that are no modules; `modules` are those of the reference."""
    written = {page.stem: page.read_text(encoding="utf-8") for page in sorted(PAGES.glob("*.md"))}
    return {**written, "flows": flows_page(), "columns": columns_page(), "commands": commands_page(),
            "gallery": gallery_page(ROOT / "figures"), "modules": modules_page(modules)}


def _module(name: str, text: str) -> ModuleType:
    """A page as the docstring of a module of its own, so that it looks like all others."""
    module = ModuleType(name, text)
    module.__all__ = []  # type: ignore[attr-defined]
    return module


def _copy_figures(folder: Path) -> None:
    folder.mkdir()
    for image in figures(ROOT / "figures"):
        for path in (image, image.with_suffix(".py"), image.with_suffix(".csv")):
            shutil.copy(path, folder)


def check_links(folder: Path) -> None:
    """Raise ValueError for a link or image of the pages in the folder that leads nowhere within it."""
    lost = [f"{page.relative_to(folder)}: {link}" for page in sorted(folder.rglob("*.html"))
            for link in _LINK.findall(page.read_text(encoding="utf-8"))
            if not re.match(r"[a-z]+:|//|[$]{", link) and not (page.parent / link).exists()]
    if lost:
        raise ValueError(f"links that lead nowhere: {'; '.join(lost[:10])}")
