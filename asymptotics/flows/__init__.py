"""The flows, one file each. A file dropped into this folder is a flow: it defines

    SUMMARY      one line
    PARAMETERS   tuple of `Parameter`
    REGIMES      {name: Regime}

and nothing else needs to know about it.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from importlib import import_module
from pkgutil import iter_modules

import sympy as sp

from ..parameters import BadParameter, Parameter
from ..series import Expansion


class NoSuchFlow(LookupError):
    """The name is not a flow, or not a regime of it."""


@dataclass(frozen=True)
class Regime:
    """One limit of one flow.

    expand      the expansion up to a given power of the gauge
    default     the highest power that is computed unless asked otherwise
    available   the highest power that has a closed form, or None
    lowest      the power of the leading term
    step        distance between successive powers
    accepts     says why a set of parameter values does not belong to the regime, or returns ""
    """

    summary: str
    parameters: tuple[str, ...]
    expand: Callable[[sp.Rational], Expansion]
    default: sp.Rational
    available: sp.Rational | None = None
    lowest: sp.Rational = sp.Integer(1)
    step: sp.Rational = sp.Integer(1)
    accepts: Callable[[Mapping], str] = lambda values: ""


def names() -> list[str]:
    return sorted(module.name for module in iter_modules(__path__))


def load(name: str):
    """The module of a flow."""
    if name not in names():
        raise NoSuchFlow(f"no flow {name!r}; the flows are {', '.join(names())}")
    return import_module(f"{__name__}.{name}")


def regime_for(flow, name: str | None, values: Mapping) -> str:
    """The regime called `name`, or the first that accepts the values."""
    if name is not None and name not in flow.REGIMES:
        raise NoSuchFlow(f"no regime {name!r}; the regimes are {', '.join(flow.REGIMES)}")
    candidates = [name] if name else list(flow.REGIMES)
    reasons = [flow.REGIMES[candidate].accepts(values) for candidate in candidates]
    for candidate, reason in zip(candidates, reasons):
        if not reason:
            return candidate
    raise BadParameter(reasons[0])


def expand(flow_name: str, regime: str | None = None, order=None, **values) -> Expansion:
    """Expansion of sigma for a flow; parameters that are not given stay symbols.

    >>> expand("vortex", slope_deg=45).coefficient(2)
    -2/5
    """
    flow = load(flow_name)
    known: dict[str, Parameter] = {parameter.name: parameter for parameter in flow.PARAMETERS}
    for name in values:
        if name not in known:
            raise BadParameter(f"{flow_name} has no parameter {name}; it has {', '.join(known)}")
    exact = {name: known[name].read(value) for name, value in values.items()}
    chosen = regime_for(flow, regime, exact)
    limit = flow.REGIMES[chosen]
    expansion = limit.expand(_power(order, chosen, limit))
    return expansion.with_parameters(**{name: value for name, value in exact.items() if name in limit.parameters})


def _power(order, name: str, regime: Regime) -> sp.Rational:
    try:
        power = sp.Rational(str(order)) if order is not None else regime.default
    except (TypeError, ValueError, ZeroDivisionError):
        raise BadParameter(f"order must be a power such as 2 or 4/3, got {order!r}") from None
    highest = sp.oo if regime.available is None else regime.available
    if not regime.lowest <= power <= highest:
        raise BadParameter(f"order must be between {regime.lowest} and {highest} for regime {name}, got {power}: "
                           + ("the first term has that power" if power < regime.lowest else
                              "beyond it the integrals are not elementary (dilogarithms)"))
    return power
