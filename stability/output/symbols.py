"""Parameters as they are printed: symbols and values in mathtext, for labels and titles of figures.

A flow gives a symbol with a parameter where its name is not one: `shields` is theta in print.
"""

import re
from collections.abc import Collection
from dataclasses import fields
from math import inf
from typing import Any

_GREEK = {"alpha", "beta", "gamma", "delta", "epsilon", "zeta", "eta", "theta", "kappa", "lambda", "mu", "nu", "xi",
          "pi", "rho", "sigma", "tau", "phi", "chi", "psi", "omega"}
_DEGREES = "_deg"  # ending of the name of an angle
_UPRIGHT = 3  # letters of the longest name that is a symbol, as Re and We are


def symbol_of(flow: Any, name: str) -> str:
    """Return the symbol of a parameter of a flow: what the flow says, or what its name looks like.

    >>> from stability import flows
    >>> symbol_of(flows.Dune(), "shields"), symbol_of(flows.Dune(), "mu1"), symbol_of(flows.Dune(), "Re")
    ('$\\\\theta$', '$\\\\mu_1$', '$\\\\mathrm{Re}$')
    """
    (given,) = [item.metadata.get("symbol") for item in fields(flow) if item.name == name] or (None,)
    return f"${given}$" if given else symbol(name)


def symbol(name: str) -> str:
    """Return a name as a symbol: Greek letters by their names, a number at the end as an index; long names as words."""
    letters, index = re.fullmatch(r"(.*?)_?(\d*)", name).groups()  # type: ignore[union-attr]
    if letters in _GREEK:
        letter = rf"\{letters}"
    elif len(letters) == 1:
        letter = letters
    elif letters.isalpha() and len(letters) <= _UPRIGHT:
        letter = rf"\mathrm{{{letters}}}"
    else:
        return name.replace("_", " ")
    return f"${letter}_{{{index}}}$" if len(index) > 1 else f"${letter}_{index}$" if index else f"${letter}$"


def value_text(value: Any) -> str:
    """Return a value of a parameter in few digits."""
    if not isinstance(value, (int, float)):
        return str(value)
    if value == inf:
        return r"$\infty$"
    text = f"{value:.6g}"
    mantissa, _, exponent = text.partition("e")
    power = rf"$10^{{{int(exponent)}}}$" if exponent else ""
    return text if not exponent else power if mantissa == "1" else rf"{mantissa}$\times${power}"


def assigned(flow: Any, name: str, value: Any = None) -> str:
    """Return "symbol = value" of a parameter, by default with the value that the flow has."""
    unit = "\N{DEGREE SIGN}" if name.endswith(_DEGREES) else ""
    return f"{symbol_of(flow, name)} = {value_text(getattr(flow, name) if value is None else value)}{unit}"


def axis_label(flow: Any, name: str) -> str:
    """Return what an axis over a parameter is labelled with: its symbol, and its unit if it has one."""
    return symbol_of(flow, name) + (" (degrees)" if name.endswith(_DEGREES) else "")


def title_of(flow: Any, swept: Collection[str | None] = ()) -> str:
    """Return the name of a flow with its parameters but the swept ones; names that are the default are left out."""
    known = [item for item in fields(flow) if item.name not in swept]
    shown = [assigned(flow, item.name) if "low" in item.metadata else f"{item.name} {getattr(flow, item.name)}"
             for item in known if "low" in item.metadata or getattr(flow, item.name) != item.default]
    return f"{flow.name.replace('_', ' ')}: {', '.join(shown)}" if shown else flow.name.replace("_", " ")
