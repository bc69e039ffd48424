"""What a flow declares, as text: title, scales, parameters. Those of this package are known without importing numerics.

    python -m stability.flows.declaration

writes `declared.py` anew after a declaration has changed; a test compares it with the classes.
"""

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from .catalogue import FLOWS, find
from .rules import allowed, numeric

if TYPE_CHECKING:
    from .base import Flow

_FILE = Path(__file__).with_name("declared.py")
_ABOVE = '''"""What the flows of this package declare; written by `python -m stability.flows.declaration`."""

DECLARED = {
'''
_RULES = "meaning", "low", "high", "closed", "unbounded", "reason", "options", "table", "kinds"  # that need no numerics


class Parameter(NamedTuple):
    """A parameter of a flow: its name, default as text, the rules that values obey with their meaning and units, and
    where neutral values of it are looked for."""

    name: str
    default: str
    metadata: Mapping[str, Any]
    searched: str

    @property
    def allowed(self) -> str:
        """The admissible values in words."""
        return allowed(self.metadata)

    @property
    def meaning(self) -> str:
        return str(self.metadata["meaning"])


class Declaration(NamedTuple):
    """What a flow declares; `scales` are those of length, velocity and stress, `takes_law` whether friction laws."""

    name: str
    title: str
    scales: str
    takes_law: bool
    parameters: tuple[Parameter, ...]


def declared(name: str) -> Declaration:
    """Return what the flow of this name declares; raises ParameterError, as `find` does, where there is none.

    Scales and units are those that the flow states.

    >>> declared("film").parameters[0].default
    '10.0'
    """
    from .declared import DECLARED

    if name in DECLARED and FLOWS.is_shipped(name):
        title, scales, takes_law, parameters = DECLARED[name]
        return Declaration(name, title, scales, takes_law, tuple(Parameter(*parts) for parts in parameters))
    return declaration_of(find(name))


def declaration_of(flow: "type[Flow]") -> Declaration:
    """What the class declares."""
    from dataclasses import fields

    parameters = (Parameter(item.name, str(item.default), _rules(item), _searched(flow, item)) for item in fields(flow))
    return Declaration(flow.name, flow.title, flow.scales, hasattr(flow, "under"), tuple(parameters))


def _rules(item: Any) -> dict[str, Any]:
    return {name: item.metadata[name] for name in _RULES if name in item.metadata}


def _searched(flow: Any, item: Any) -> str:
    """Where neutral values of a parameter are looked for, "" where it has none."""
    from .base import span_of

    return "{:g} to {:g}".format(*span_of(flow, item.name)) if numeric(item) else ""


def written(flows: "Iterable[type[Flow]]") -> str:
    """The text of `declared.py`."""
    lines = []
    for name, title, scales, takes_law, parameters in map(declaration_of, flows):
        lines += [f"    {name!r}: (", *(f"        {part!r}," for part in (title, scales, takes_law)), "        ("]
        lines += [f"            {tuple(parts)!r}," for parts in parameters]
        lines += ["        ),", "    ),"]
    return _ABOVE + "\n".join(line + "  # noqa: E501" * (len(line) > 120) for line in lines) + "\n}\n"


if __name__ == "__main__":
    _FILE.write_text(written(FLOWS[name] for name in FLOWS), encoding="utf-8")
