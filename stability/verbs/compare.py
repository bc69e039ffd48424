"""stability compare: all methods on one eigenvalue, their errors and times."""

from ..specs import parse_one
from .common import add_verb, flow_of, report
from .progress import Bar


def add(verbs):
    add_verb(verbs, "compare", _run, "stability compare vortex --k 2 --plot compare.png",
             _k_option)


def _k_option(verb):
    verb.add_argument("--k", required=True, metavar="K", help="wavenumber")


def _run(arguments):
    flow = flow_of(arguments)
    k = parse_one(arguments.k, "--k", "wavenumber")

    def compute():
        from ..compare import compare

        bar = Bar(arguments.quiet)
        try:
            return compare(flow, k, report=bar)
        finally:
            bar.clear()

    return report(arguments, compute)
