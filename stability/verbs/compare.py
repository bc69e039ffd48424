"""stability compare: all methods on one eigenvalue, their errors and times."""

from ..specs import parse_one
from ..status import RESOLVED
from .common import add_verb, flow_of, report
from .progress import Bar


def add(verbs):
    add_verb(verbs, "compare", _run, "all methods on one eigenvalue: values, errors, times",
             "stability compare vortex --k 2 --plot compare.png", _k_option)


def _k_option(verb):
    verb.add_argument("--k", required=True, metavar="K", help="wavenumber")


def _run(arguments):
    flow = flow_of(arguments)
    k = parse_one(arguments.k, "--k", "wavenumber")

    def compute():
        from ..compare import compare

        bar = Bar(arguments.quiet)
        try:
            found = compare(flow, k, report=bar)
        finally:
            bar.clear()
        known = found.reference
        notes = [f"reference: sigma = {known.sigma:.15g}, {known.source}",
                 *(f"{method}, {setting}: no result" for method, setting in found.failed)]
        return [_row(one) for one in found.measurements], found, notes

    return report(arguments, flow, compute)


def _row(one):
    return {"method": one.method, "setting": one.setting, "growth_rate": one.sigma.real, "frequency": one.sigma.imag,
            "error": one.error, "reported": one.reported, "seconds": one.seconds, "unknowns": one.unknowns,
            "status": RESOLVED}
