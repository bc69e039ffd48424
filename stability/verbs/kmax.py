"""stability kmax: the fastest growing wavenumber, over a parameter."""

from ..optimum import k_max_sweep
from .common import SPEC, add_verb, flow_of, options_of, progress, report, sweep_of


def add(verbs):
    add_verb(verbs, "kmax", _run, "the fastest growing wavenumber, over a parameter",
             "stability kmax dune --over Re=0.1:1e4:41 --plot kmax.png", _over_option)


def _over_option(verb):
    verb.add_argument("--over", metavar="NAME=SPEC", help=f"parameter to sweep and its values: {SPEC}")


def _run(arguments):
    flow, options = flow_of(arguments), options_of(arguments)
    name, sweep = sweep_of(arguments, flow)

    def compute():
        found = []
        for optimum in k_max_sweep(sweep, **options):
            found.append(optimum)
            progress(arguments, len(found), len(sweep))
        return [_row(name, optimum) for optimum in found], (name, found), []

    return report(arguments, flow, compute)


def _row(name, optimum):
    row = {name: getattr(optimum.flow, name)} if name else {}
    best = optimum if optimum.maxima else None
    for key in ("k_max", "growth_rate", "phase_speed", "error"):
        row[key] = getattr(best, key) if best else None
    return {**row, "maxima": [[m.k, m.growth_rate] for m in optimum.maxima], "status": optimum.status}
