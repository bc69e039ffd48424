"""What the verbs share: flows and their flags, common options, and the report of a result."""

import sys
from contextlib import ExitStack
from dataclasses import fields, replace
from difflib import get_close_matches

from ..errors import INTERRUPTED, ParameterError
from ..flows import FLOWS
from ..flows.base import allowed
from ..mode import DEGREES, TOLERANCE, check_accuracy
from ..output import header_of, render, whole_file, write
from ..specs import parse_spec
from .progress import Bar

SPEC = "a number, a list a,b,c, or a range a:b:n (log-spaced) or a:b:n:lin"
RESOLVED = "resolved"  # the status of a good row begins with it
INTERRUPTED_STATUS = 130  # of the command
_DONE = (RESOLVED, "no derivative")  # or with this, where there is none to compute
_PLOTS = (".png", ".pdf", ".svg")


def add_verb(verbs, name, run, summary, example, *options):
    """Add a verb that takes a flow, its parameters, the common options and whatever `options` add."""
    verb = verbs.add_parser(name, help=summary, description=summary[0].upper() + summary[1:] + ".",
                            epilog=f"example: {example}", allow_abbrev=False)
    verb.add_argument("flow", metavar="FLOW", help=f"one of {', '.join(FLOWS)}")
    for option in options:
        option(verb)
    for flow in FLOWS.values():
        group = verb.add_argument_group(f"parameters of {flow.name}")
        for item in fields(flow):
            if flag(item) not in verb._option_string_actions:
                group.add_argument(flag(item), dest=f"parameter {item.name}", metavar="V",
                                   help=f"{item.metadata['meaning']}; {allowed(item.metadata)}, default {item.default}")
    verb.add_argument("--tolerance", metavar="T", default=str(TOLERANCE),
                      help="relative error of sigma accepted as resolved")
    verb.add_argument("--max-degree", metavar="N", default=str(DEGREES[-1]), help="largest Chebyshev degree tried")
    form = verb.add_mutually_exclusive_group()
    form.add_argument("--csv", dest="form", action="store_const", const="csv", help="comma-separated values")
    form.add_argument("--json", dest="form", action="store_const", const="json", help="JSON")
    verb.add_argument("-o", "--output", metavar="FILE", help="write there instead of standard output")
    verb.add_argument("--plot", metavar="FILE", help="draw the result: .png, .pdf or .svg")
    verb.add_argument("--quiet", action="store_true", help="no progress and no warnings on standard error")
    verb.set_defaults(run=run, form="table")


def flag(item):
    """Command-line flag of a parameter."""
    return "--" + item.name.replace("_", "-")


def k_option(verb):
    verb.add_argument("--k", required=True, metavar="SPEC", help=f"wavenumbers: {SPEC}")


def flow_class(name):
    if name not in FLOWS:
        raise ParameterError(f"unknown flow {name!r}{_nearest(name, FLOWS)}; flows: {', '.join(FLOWS)}")
    return FLOWS[name]


def flow_of(arguments):
    """The flow with the parameters given as flags."""
    flow = flow_class(arguments.flow)
    known = {item.name for item in fields(flow)}
    given = {key.partition(" ")[2]: value for key, value in vars(arguments).items()
             if key.startswith("parameter ") and value is not None}
    for name in given:
        if name not in known:
            raise ParameterError(f"{flow.name} has no parameter {name}; it has {', '.join(sorted(known))}")
    return flow(**given)


def sweep_of(arguments, flow):
    """The swept parameter's name (or None) and the flows of the sweep."""
    if arguments.over is None:
        return None, [flow]
    name, values = swept_values(arguments.over, flow)
    return name, [replace(flow, **{name: value}) for value in values]


def swept_values(text, flow):
    """The parameter and its values of NAME=SPEC."""
    name, _, spec = text.partition("=")
    name = name.replace("-", "_")
    known = [item.name for item in fields(flow) if "options" not in item.metadata]
    if name not in known:
        raise ParameterError(f"--over: {flow.name} has no parameter {name!r}{_nearest(name, known)}; "
                             f"it has {', '.join(known)}")
    return name, parse_spec(spec, f"--over {name}", False).tolist()


def options_of(arguments):
    tolerance, max_degree = check_accuracy(arguments.tolerance, arguments.max_degree, ("--tolerance", "--max-degree"))
    return {"tolerance": tolerance, "max_degree": max_degree}


def report(arguments, flow, compute, swept=()):
    """Check where output goes, compute, write it; return the exit status.

    The header leaves out the parameters that are `swept`.
    """
    with ExitStack() as stack:
        out = stack.enter_context(whole_file(arguments.output, "-o")) if arguments.output else None
        plot = _plot_file(arguments, stack)
        rows, result, notes = compute()
        header = header_of(flow, getattr(arguments, "method", "collocation"), notes, swept)
        if plot:
            from ..plots import draw  # matplotlib takes longer to import than most results to compute

            draw(result, plot)
        missing = [row for row in rows if row["status"] == INTERRUPTED]
        failed = [row for row in rows if not row["status"].startswith((*_DONE, INTERRUPTED))]
        if not arguments.quiet:
            for note in notes:
                print(f"stability: {note}", file=sys.stderr)
            if failed:
                print(f"stability: {len(failed)} of {len(rows)} rows are not resolved: see status", file=sys.stderr)
            if missing:
                print(f"stability: interrupted: {len(missing)} of {len(rows)} rows are not computed", file=sys.stderr)
        if arguments.form == "netcdf":
            result.to_netcdf(out)
        else:
            write(render(arguments.form, header, rows), out)
    return INTERRUPTED_STATUS if missing else 3 if failed else 0


def collect(arguments, results, total, rest, size=lambda result: 1):
    """Return the results of a sweep of `total` points as a list, `size` points each, with progress on the way.

    What is done is kept after Ctrl-C: `rest(points done)` then gives what stands for the others.
    """
    found, done, bar = [], 0, Bar(arguments.quiet)
    try:
        for result in results:
            found.append(result)
            done += size(result)
            bar(done, total)
    except KeyboardInterrupt:
        if not found:
            raise
        found += rest(done)
    finally:
        bar.clear()
    return found


def _plot_file(arguments, stack):
    if not arguments.plot:
        return None
    check_plot(arguments.plot)
    return stack.enter_context(whole_file(arguments.plot, "--plot"))


def check_plot(path):
    if not path.endswith(_PLOTS):
        raise ParameterError(f"--plot: the file must end in {', '.join(_PLOTS)} (got {path!r})")


def _nearest(name, known):
    match = get_close_matches(name, known, 1)
    return f" (did you mean {match[0]!r}?)" if match else ""
