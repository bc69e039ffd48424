"""The options that choose how a surface mode is computed: collocation, or continuation by solve_bvp."""

import argparse
from typing import TYPE_CHECKING, Any

from ..errors import ParameterError
from .specs import parse_one

if TYPE_CHECKING:
    from ..flows.base import Flow

METHODS = ("collocation", "bvp", "bvp-thesis")
_UNUSED = {"collocation": set(), "bvp": {"max_degree"}, "bvp-thesis": {"tolerance", "max_degree"}}


def method_options(verb: Any) -> None:
    verb.add_argument("--method", default=METHODS[0], metavar="METHOD",
                      help=f"{', '.join(METHODS)} (default {METHODS[0]}); bvp is continuation by scipy's solve_bvp, "
                           "bvp-thesis the setting of Cawthorn's thesis: residual 1e-3, vortex with --delta, "
                           "the fluid over a dune cut at 100/k")
    verb.add_argument("--delta", metavar="D",
                      help="pressure on the free surface of vortex with bvp-thesis, default 0.01")


def bvp_settings(bvp: Any, options: Any = None) -> Any:
    """What the method of `method_of` is told, for the header of its results; `options` are those of collocation."""
    if bvp is None:
        return options
    if "setting" not in bvp:
        return bvp
    delta = getattr(bvp["setting"](1.0), "delta", None)
    return {"residual": bvp["residual"]} | ({} if delta is None else {"delta": delta})


def check_method(arguments: argparse.Namespace) -> None:
    """Raise a ParameterError where the options of `method_options` contradict each other or the others."""
    if arguments.method not in METHODS:
        raise ParameterError(f"--method: must be one of {', '.join(METHODS)} (got {arguments.method!r})")
    if arguments.delta is not None and arguments.method != "bvp-thesis":
        raise ParameterError("--delta: only --method bvp-thesis regularises the free surface")
    for option in sorted(_UNUSED[arguments.method] & arguments.given):
        raise ParameterError(f"--{option.replace('_', '-')}: --method {arguments.method} does not use it; leave it out")
    _delta(arguments)


def _delta(arguments: argparse.Namespace) -> float | None:
    return None if arguments.delta is None else parse_one(arguments.delta, "--delta")


def method_of(arguments: argparse.Namespace, flow: "Flow", tolerance: float) -> dict[str, Any] | None:
    """Arguments for `bvp.continuation`, or None for collocation."""
    if arguments.method == "collocation":
        return None
    from ..bvp.thesis import THESIS_RESIDUAL, thesis_setting

    if arguments.method == "bvp":
        return {"tolerance": tolerance}
    return {"residual": THESIS_RESIDUAL, "setting": thesis_setting(flow, _delta(arguments))}
