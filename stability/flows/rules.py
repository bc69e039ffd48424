"""What the declaration of a parameter admits: a range of numbers, a choice of names, or a table. Needs no numerics.

A declaration is the field of a class (`flows.base`) or a `flows.declaration.Parameter`: with a `name` and `metadata`.
"""

from collections.abc import Mapping, Sequence
from math import isfinite
from typing import Any

from ..checks import LARGEST, as_number, check_options, in_double_precision, shown
from ..errors import ParameterError


def numeric(item: Any) -> bool:
    """Whether a parameter is a number, that can be swept, varied and differenced: no name and no table."""
    return not {"options", "table"} & item.metadata.keys()


def allowed(rule: Mapping[str, Any]) -> str:
    """The admissible values in words: `(1, inf)` is open, `[0, inf]` admits its ends, `a | b` is a choice."""
    if "options" in rule:
        return " | ".join(rule["options"])
    if "table" in rule:
        return str(rule["kinds"])
    low = "-inf" if rule["low"] is None else f"{rule['low']:g}"
    high = "inf" if rule["high"] is None else f"{rule['high']:g}"
    closed = rule["closed"] or rule["unbounded"] and rule["low"] is None
    return f"{'[' if closed else '('}{low}, {high}{']' if rule['unbounded'] else ')'}"


def check_parameter(flow: str, item: Any, value: Any) -> Any:
    """Return the value as a float (or one of the options), or raise a `ParameterError` that says why not."""
    rule = item.metadata
    if "options" in rule:
        return check_options(f"{flow}: {item.name}", value, rule["options"])
    if "table" in rule:
        return rule["read"](f"{flow}: {item.name}", value)
    number = as_number(value)
    if number is None:
        raise ParameterError(f"{flow}: {item.name} must be a number in {allowed(rule)} (got {shown(value)})")
    inside = (rule["low"] is None or number > rule["low"] or rule["closed"] and number == rule["low"]) \
        and (rule["high"] is None or number < rule["high"])
    if not inside or not (isfinite(number) or rule["unbounded"] and (number > 0 or rule["low"] is None)):
        reason = f": {rule['reason']}" if rule["reason"] else ""
        raise ParameterError(f"{flow}: {item.name} must lie in {allowed(rule)}{reason} (got {number:g})")
    if isfinite(number) and not in_double_precision(number):
        raise ParameterError(f"{flow}: {item.name} must lie between {1 / LARGEST:g} and {LARGEST:g} for double "
                             f"precision: change the scales (got {number:g})")
    return number


def check_varied(flow: str, items: Sequence[Any], name: Any) -> str:
    """Return `name` if it is that of a numeric parameter among the items of a flow, else raise a ParameterError."""
    known = [item.name for item in items if numeric(item)]
    if not (isinstance(name, str) and name in known):
        raise ParameterError(f"{flow} has no numeric parameter {shown(name)} to vary; it has {', '.join(known)}")
    return name
