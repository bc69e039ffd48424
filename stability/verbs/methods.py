"""The options that choose how a surface mode is computed: collocation, or continuation by solve_bvp."""

from ..errors import ParameterError
from ..specs import parse_spec

METHODS = ("collocation", "bvp", "bvp-thesis")


def method_options(verb):
    verb.add_argument("--method", default=METHODS[0], metavar="METHOD",
                      help=f"{', '.join(METHODS)} (default {METHODS[0]}); bvp is continuation by scipy's solve_bvp, "
                           "bvp-thesis the setting of Cawthorn's thesis: residual 1e-3, vortex with --delta, "
                           "the fluid over a dune cut at 100/k")
    verb.add_argument("--delta", metavar="D",
                      help="pressure on the free surface of vortex with bvp-thesis, default 0.01")


def method_of(arguments, flow, tolerance):
    """Arguments for `stability.continuation`, or None for collocation."""
    if arguments.method not in METHODS:
        raise ParameterError(f"--method: must be one of {', '.join(METHODS)} (got {arguments.method!r})")
    if arguments.delta is not None and arguments.method != "bvp-thesis":
        raise ParameterError("--delta: only --method bvp-thesis regularises the free surface")
    if arguments.method == "collocation":
        return None
    from ..thesis import THESIS_RESIDUAL, thesis_setting

    if arguments.method == "bvp":
        return {"tolerance": tolerance}
    delta = None if arguments.delta is None else float(parse_spec(arguments.delta, "--delta")[0])
    return {"residual": THESIS_RESIDUAL, "setting": thesis_setting(flow, delta)}
