"""The flows, one file each. A file dropped into this folder is a flow: it defines

    SUMMARY      one line
    PARAMETERS   tuple of `Parameter`
    DEFAULTS     {name of a parameter: text}, what it is where numbers are asked for and none is given
    LATEX        {name of a parameter: how it is printed}; of an angle the name without _deg, of a square its root
    REGIMES      {name: Regime}

and nothing else needs to know about it.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from importlib import import_module
from typing import Any

import sympy as sp

from ..catalogue import names
from ..errors import BadParameter, NoSuchFlow
from ..parameters import Parameter
from ..series import Expansion


@dataclass(frozen=True)
class Regime:
    """One limit of one flow.

    expand      the expansion up to a given power of the gauge
    default     the highest power that is computed unless asked otherwise
    available   the highest power offered, and `beyond`, why no higher one
    lowest      the power of the leading term
    step        distance between successive powers
    ignores     parameters of the flow that have no effect here
    accepts     says why a set of parameter values does not belong to the regime, or returns ""
    numbers     parameters whose values, where given, are put in before the orders are solved, as keywords of `expand`
    """

    summary: str
    parameters: tuple[str, ...]
    expand: Callable[..., Expansion]
    default: sp.Rational
    available: sp.Rational
    beyond: str = "its integrals are not elementary (dilogarithms)"
    lowest: sp.Rational = sp.Integer(1)
    step: sp.Rational = sp.Integer(1)
    ignores: tuple[str, ...] = ()
    accepts: Callable[[Mapping], str] = lambda values: ""
    numbers: tuple[str, ...] = ()

    def refusal(self, name: str, values: Mapping) -> str:
        """Why the values do not belong to this regime; empty if they do."""
        foreign = [value for value in values if value not in (*self.parameters, *self.ignores)]
        if foreign:
            return f"regime {name} takes no {', '.join(foreign)}; it takes {', '.join(self.parameters)}"
        return self.accepts(values)


def load(name: str) -> Any:
    """The module of a flow."""
    if name not in names():
        raise NoSuchFlow(f"no flow {name!r}; the flows are {', '.join(names())}")
    return import_module(f"{__name__}.{name}")


def regime_for(flow: Any, name: str | None, values: Mapping) -> str:
    """The regime called `name`, or the first that accepts the values."""
    if name is not None and name not in flow.REGIMES:
        raise NoSuchFlow(f"no regime {name!r}; the regimes are {', '.join(flow.REGIMES)}")
    candidates = [name] if name else list(flow.REGIMES)
    reasons = [flow.REGIMES[candidate].refusal(candidate, values) for candidate in candidates]
    for candidate, reason in zip(candidates, reasons, strict=True):
        if not reason:
            return candidate
    raise BadParameter(reasons[0])


def expand(flow_name: str, regime: str | None = None, order: Any = None, *, numbers: bool = False,
           **values: Any) -> Expansion:
    """Expansion of sigma for a flow; parameters that are not given stay symbols, or with `numbers` are the defaults.

    >>> expand("vortex", slope_deg=45).coefficient(2)
    -2/5

    Growth rates and wavenumbers are in the scales of the flow, angles in degrees. Raises NoSuchFlow for an unknown flow
    or regime, BadParameter for a parameter, value or order that it does not take.
    """
    flow = load(flow_name)
    known: dict[str, Parameter] = {parameter.name: parameter for parameter in flow.PARAMETERS}
    for name in values:
        if name not in known:
            raise BadParameter(f"{flow_name} has no parameter {name}; it has {', '.join(known)}")
    exact = {name: known[name].read(value) for name, value in values.items()}
    chosen = regime_for(flow, regime, exact)
    limit = flow.REGIMES[chosen]
    if numbers:
        exact = {name: known[name].read(flow.DEFAULTS[name]) for name in limit.parameters
                 if name in flow.DEFAULTS} | exact
        if reason := limit.refusal(chosen, exact):
            raise BadParameter(reason)
    beforehand = {name: exact[name] for name in limit.numbers if name in exact}
    expansion = replace(limit.expand(_power(order, chosen, limit), **beforehand), step=limit.step)
    return expansion.with_parameters(**{name: value for name, value in exact.items() if name in limit.parameters})


def _power(order: Any, name: str, regime: Regime) -> sp.Rational:
    try:
        power = sp.Rational(str(order)) if order is not None else regime.default
    except (TypeError, ValueError, ZeroDivisionError):
        raise BadParameter(f"order must be a power such as 2 or 4/3, got {order!r}") from None
    if power < regime.lowest:
        raise BadParameter(f"order must be at least {regime.lowest} for regime {name}, got {power}: "
                           "that is the power of the first term")
    if power > regime.available:
        raise BadParameter(f"order must be at most {regime.available} for regime {name}, got {power}: "
                           f"beyond it {regime.beyond}")
    return power
