"""stability kmax: the fastest growing wavenumber, over a parameter."""

from ..errors import StabilityError
from ..optimum import Optima, Optimum, check_surface_mode, k_max_sweep
from ..status import INTERRUPTED
from .common import SPEC, accuracy_options, add_verb, collect, flow_of, options_of, report, sweep_of
from .methods import method_of, method_options, settings_of


def add(verbs):
    add_verb(verbs, "kmax", _run, "the fastest growing wavenumber, over a parameter",
             "stability kmax dune --over Re=0.1:1e4:41 --plot kmax.png", _over_option, method_options,
             accuracy_options)


def _over_option(verb):
    verb.add_argument("--over", metavar="NAME=SPEC", help=f"parameter to sweep and its values: {SPEC}")


def _run(arguments):
    flow, options = flow_of(arguments), options_of(arguments)
    check_surface_mode(flow)
    name, sweep = sweep_of(arguments, flow)
    bvps = [method_of(arguments, one, options["tolerance"]) for one in sweep]

    def compute():
        optima = k_max_sweep(sweep, **options) if bvps[0] is None else map(_bounded, sweep, bvps)
        found = collect(arguments, optima, len(sweep),
                        lambda done: [Optimum(one, (), INTERRUPTED) for one in sweep[done:]])
        return Optima(flow, name, tuple(found), arguments.method)

    return report(arguments, compute)


def _bounded(flow, bvp):
    """The optimum of a flow by bounded minimisation over solve_bvp's growth rates; the first maximum only."""
    from ..continuation import bounded_maximum

    settings = settings_of(bvp)
    try:
        found = bounded_maximum(flow, **bvp)
    except StabilityError as reason:
        return Optimum(flow, (), str(reason), settings)
    return Optimum(flow, (found,), found.mode.status, settings)
