"""What a flow declares, as text: title, scales, parameters. Those of this package are known without importing numerics.

    python -m stability.flows.declaration

writes `declared.py` anew after a declaration has changed; a test compares it with the classes.
"""

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from .catalogue import FLOWS, find

if TYPE_CHECKING:
    from .base import Flow

_FILE = Path(__file__).with_name("declared.py")
_ABOVE = '''"""What the flows of this package declare; written by `python -m stability.flows.declaration`."""

DECLARED = {
'''


class Parameter(NamedTuple):
    """A parameter of a flow in words: its name, default, admissible values, and meaning with its units."""

    name: str
    default: str
    allowed: str
    meaning: str


class Declaration(NamedTuple):
    """What a flow declares; `scales` are those of length, velocity and stress."""

    name: str
    title: str
    scales: str
    parameters: tuple[Parameter, ...]


def declared(name: str) -> Declaration:
    """Return what the flow of this name declares; raises ParameterError, as `find` does, where there is none.

    Scales and units are those that the flow states.

    >>> declared("film").parameters[0].default
    '10.0'
    """
    from .declared import DECLARED

    if name in DECLARED and FLOWS.is_shipped(name):
        title, scales, parameters = DECLARED[name]
        return Declaration(name, title, scales, tuple(Parameter(*texts) for texts in parameters))
    return declaration_of(find(name))


def declaration_of(flow: "type[Flow]") -> Declaration:
    """What the class declares."""
    from dataclasses import fields

    from .base import allowed

    parameters = (Parameter(item.name, str(item.default), allowed(item.metadata), _meaning(flow, item))
                  for item in fields(flow))
    return Declaration(flow.name, flow.title, flow.scales, tuple(parameters))


def _meaning(flow: Any, item: Any) -> str:
    """What a parameter means, and where neutral values of it are looked for."""
    from .base import numeric, span_of

    if not numeric(item):
        return item.metadata["meaning"]
    low, high = span_of(flow, item.name)
    return f"{item.metadata['meaning']}; searched from {low:g} to {high:g}"


def written(flows: "Iterable[type[Flow]]") -> str:
    """The text of `declared.py`."""
    lines = []
    for name, title, scales, parameters in map(declaration_of, flows):
        lines += [f"    {name!r}: (", f"        {title!r},", f"        {scales!r},", "        ("]
        lines += [f"            {tuple(texts)!r}," for texts in parameters]
        lines += ["        ),", "    ),"]
    return _ABOVE + "\n".join(line + "  # noqa: E501" * (len(line) > 120) for line in lines) + "\n}\n"


if __name__ == "__main__":
    _FILE.write_text(written(FLOWS[name] for name in FLOWS), encoding="utf-8")
