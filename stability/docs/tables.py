"""Pages made of what the package knows of itself: flows, columns, commands, and the figures with their docstrings."""

import ast
from dataclasses import fields
from pathlib import Path
from typing import Any

from ..cli.command import parser_of
from ..cli.verbs import VERBS
from ..flows import FLOWS
from ..flows.base import span_of
from ..flows.rules import allowed, numeric
from ..output.columns import BY_VERB, PARAMETERS, SCALES, column

_IMAGE = '<img src="figures/{0}" alt="{0}" style="max-width: 100%">'


def flows_page() -> str:
    """Every flow: title, scales, and a table of its parameters."""
    parts = ["# Flows", "", "Parameters are keyword arguments of the class and flags of the command line; neutral "
             "values of a parameter are looked for in its range of search."]
    for name, flow in FLOWS.items():
        parts += ["", f"## {name}: {flow.title}", "", f"`stability.flows.{flow.__name__}`. Scales: {flow.scales}.", "",
                  "| parameter | meaning | range | default | searched |", "|---|---|---|---|---|"]
        parts += [_row(item.name, item.metadata["meaning"], allowed(item.metadata), item.default, _searched(flow, item))
                  for item in fields(flow)]
    return "\n".join(parts)


def _searched(flow: Any, item: Any) -> Any:
    return "{:g} to {:g}".format(*span_of(flow, item.name)) if numeric(item) else "-"


def columns_page() -> str:
    """Every column of every verb, with its units."""
    parts = ["# Columns of results", "", f"What the verbs print and files hold. {SCALES}.", "",
             "CSV and JSON begin with flow, parameters, method and settings; netCDF files carry the same meanings as "
             "`long_name` and `scale` of every variable, complex numbers as two of them."]
    for verb, names in BY_VERB.items():
        parts += ["", f"## {verb}", "", "| column | meaning | units |", "|---|---|---|"]
        parts += [_row(name if name == PARAMETERS else f"`{name}`", *column(name, verb)) for name in names]
    return "\n".join(parts)


def commands_page() -> str:
    """The help of every verb, as the command prints it."""
    parts = ["# Commands", "", "`stability VERB FLOW --help` adds the parameters of the flow."]
    for verb in VERBS:
        parser = parser_of([verb])
        group: Any = parser._subparsers
        verbs: Any = next(action.choices for action in group._group_actions)
        parts += ["", f"## stability {verb}", "", "```text", verbs[verb].format_help().rstrip(), "```"]
    return "\n".join(parts)


def modules_page(modules: Any) -> str:
    """All modules of the reference, {name: pdoc's}, with the first line of their docstrings."""
    lines = [f"- [{name}]({name.replace('.', '/')}.html): {module.docstring.partition(chr(10))[0]}"
             for name, module in modules.items()]
    return "\n".join(["# Modules", "", *lines])


def _row(*cells: Any) -> str:
    return f"| {' | '.join(str(cell).replace('|', chr(92) + '|') for cell in cells)} |"


def figures(folder: Path) -> list[Path]:
    """The images of the gallery in the folder `figures/`, each with the script of its name. Raises FileNotFoundError
    where there are none, or a script is missing."""
    images = sorted(folder.glob("*.png"))
    if not images:
        raise FileNotFoundError(f"no figures in {folder}: build the documentation from a checkout of the repository")
    for image in images:
        if not image.with_suffix(".py").exists():
            raise FileNotFoundError(f"{image.with_suffix('.py')}: the script of {image.name} is missing")
    return images


def gallery_page(folder: Path) -> str:
    """Every figure with the docstring of its script, which is not run."""
    parts = ["# Gallery", "", "Each figure is drawn by the script beside it, `python figures/NAME.py --out .`, which "
             "writes the plotted numbers as CSV too."]
    for image in figures(folder):
        script = image.with_suffix(".py")
        text = ast.get_docstring(ast.parse(script.read_text(encoding="utf-8")))
        if not text:
            raise ValueError(f"{script}: has no docstring, which is its text in the gallery")
        title, _, rest = text.partition("\n")
        parts += ["", f"## {image.stem}", "", f"**{title}**", "", _IMAGE.format(image.name), "",
                  rest.strip(), "", f"[{script.name}](figures/{script.name}), "
                  f"[{image.stem}.csv](figures/{image.stem}.csv)"]
    return "\n".join(parts)
