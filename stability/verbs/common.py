"""What the verbs share: flows and their flags, common options, and the report of a result."""

import argparse
import os
from dataclasses import fields, replace
from difflib import get_close_matches
from pathlib import Path

from ..errors import ParameterError
from ..flows import FLOWS
from ..flows.base import allowed, numeric
from ..output import check_writable, render, terminal_width, whole_file, write
from ..solver import DEGREES, TOLERANCE, check_accuracy
from ..specs import parse_spec
from ..status import INTERRUPTED, is_settled
from ..streams import output_closed, say
from .progress import Bar

SPEC = "a number, a list a,b,c, or a range a:b:n (log-spaced) or a:b:n:lin"
INTERRUPTED_STATUS = 130  # of the command
FORMS = {".csv": "csv", ".json": "json", ".nc": "netcdf"}  # that the ending of a file stands for
_FOREIGN = {  # endings of forms that we do not write: a table under such a name would mislead
    ".xls", ".xlsx", ".ods", ".tsv", ".h5", ".hdf", ".hdf5", ".cdf", ".nc4", ".parquet", ".feather", ".arrow", ".orc",
    ".avro", ".npy", ".npz", ".mat", ".pkl", ".pickle", ".zarr", ".db", ".sqlite", ".sqlite3", ".jsonl", ".ndjson",
    ".xml", ".yaml", ".yml", ".toml", ".htm", ".html", ".md", ".tex", ".doc", ".docx", ".dta", ".sav", ".rds",
    ".fits", ".vtk", ".vtu", ".png", ".pdf", ".svg", ".jpg", ".jpeg", ".gif", ".eps", ".ps", ".tif", ".tiff", ".webp",
    ".zip", ".gz", ".bz2", ".xz", ".zst", ".tar",
}
_PLOTS = (".png", ".pdf", ".svg")
_NUMBER = "V"  # metavar of a numeric parameter of a flow
_JOIN = "join values with commas"
_REMEDIES = {"SPEC": _JOIN, "NAME=SPEC": f"{_JOIN}, and sweep several parameters with: stability map"}  # by metavar


def add_verb(verbs, name, run, summary, example, *options):
    """Add a verb that takes a flow, its parameters, the common options and whatever `options` add."""
    verb = verbs.add_parser(name, help=summary, description=summary[0].upper() + summary[1:] + ".",
                            epilog=f"example: {example}", add_help=False)
    verb.add_argument("flow", metavar="FLOW", help=f"one of {', '.join(FLOWS)}")
    for option in options:
        option(verb)
    form = verb.add_mutually_exclusive_group()
    form.add_argument("--csv", dest="form", action="store_const", const="csv", help="comma-separated values")
    form.add_argument("--json", dest="form", action="store_const", const="json", help="JSON")
    verb.add_argument("-o", "--output", metavar="FILE",
                      help="write there instead of standard output; .csv, .json and .nc (netCDF) in that form")
    verb.add_argument("--plot", metavar="FILE", help="draw the result: .png, .pdf or .svg")
    verb.add_argument("--quiet", action="store_true", help="no progress and no warnings on standard error")
    verb.add_argument("-h", "--help", action=_Help, help="show this help and exit")
    verb.set_defaults(run=run, form="table", parameters=_add_parameters(verb))


class _Help(argparse.Action):
    """Print the help of a verb, with the parameters of the flow that has been named before, if any."""

    def __init__(self, option_strings, dest, help):
        super().__init__(option_strings, argparse.SUPPRESS, nargs=0, default=argparse.SUPPRESS, help=help)

    def __call__(self, parser, namespace, values, option_string=None):
        flow, group = FLOWS.get(namespace.flow), namespace.parameters
        if flow:
            texts = {flag(item): f"{item.metadata['meaning']}; {allowed(item.metadata)}, default {item.default}"
                     for item in fields(flow)}
            group.title, group.description = f"parameters of {flow.name}", flow.title
            for action in group._group_actions:
                action.help = texts.get(action.option_strings[0], argparse.SUPPRESS)
        parser.print_help()
        parser.exit()


class Once(argparse.Action):
    """Store a value, and in `given` that it was given: twice is refused, or the first value would get lost."""

    def __call__(self, parser, namespace, values, option_string=None):
        if self.dest in namespace.given:
            raise ParameterError(f"{option_string}: given twice, with {getattr(namespace, self.dest)!r} and "
                                 f"{values!r}; {self._remedy(parser, getattr(namespace, self.dest), values)}")
        setattr(namespace, self.dest, values)
        namespace.given |= {self.dest}

    def _remedy(self, parser, *values):
        if self.metavar == _NUMBER:
            sweep = "--over" if "--over" in parser.format_usage() else "stability map --over"
            return f"sweep it with: {sweep} {self.dest.partition(' ')[2]}={','.join(values)}"
        return _REMEDIES.get(str(self.metavar), "give it once")


def _add_parameters(verb):
    """Add a flag for every parameter of every flow, and return their group; `_Help` shows those of one flow."""
    group = verb.add_argument_group("parameters of the flow", f"listed by: {verb.prog} FLOW --help")
    for name, item in {item.name: item for flow in FLOWS.values() for item in fields(flow)}.items():
        for spelling in dict.fromkeys((flag(item), f"--{name}")):
            group.add_argument(spelling, dest=f"parameter {name}", help=argparse.SUPPRESS,
                               metavar=_metavar(item))
    return group


def _metavar(item):
    return _NUMBER if numeric(item) else "FILE" if "table" in item.metadata else "NAME"


def flag(item):
    """Command-line flag of a parameter."""
    return "--" + item.name.replace("_", "-")


def nearest_flag(arguments, unknown):
    """A hint at the parameter that an unknown option may stand for."""
    flow = FLOWS.get(getattr(arguments, "flow", ""))
    return _nearest(unknown.partition("=")[0], [flag(item) for item in fields(flow)] if flow else ())


def k_option(verb):
    verb.add_argument("--k", required=True, metavar="SPEC", help=f"wavenumbers: {SPEC}")


def accuracy_options(verb):
    """Options of the verbs that compute with `options_of`."""
    verb.add_argument("--tolerance", metavar="T", default=str(TOLERANCE),
                      help="relative error of sigma accepted as resolved")
    verb.add_argument("--max-degree", metavar="N", default=str(DEGREES[-1]), help="largest Chebyshev degree tried")


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
    known = [item.name for item in fields(flow) if numeric(item)]
    if name not in known:
        raise ParameterError(f"--over: {flow.name} has no parameter {name!r}{_nearest(name, known)}; "
                             f"it has {', '.join(known)}")
    (item,) = (item for item in fields(flow) if item.name == name)
    return name, parse_spec(spec, f"--over {name}", False, item.metadata["unbounded"]).tolist()


def options_of(arguments):
    tolerance, max_degree = check_accuracy(arguments.tolerance, arguments.max_degree, ("--tolerance", "--max-degree"))
    return {"tolerance": tolerance, "max_degree": max_degree}


def report(arguments, compute):
    """Check where output goes, compute a Record, write it; return the exit status."""
    form = check_files(arguments)
    result = compute()
    rows, header = result.rows(), result.header()
    missing = [row for row in rows if row["status"] == INTERRUPTED]
    failed = [row for row in rows if not is_settled(row["status"]) and row["status"] != INTERRUPTED]
    if not arguments.quiet:
        for note in header.get("notes", ()):
            say(f"stability: {note}")
        if failed:
            say(f"stability: {len(failed)} of {len(rows)} rows are not resolved: see status")
        if missing:
            say(f"stability: interrupted: {len(missing)} of {len(rows)} rows are not computed")
    if form == "netcdf":
        from ..netcdf import encode  # scipy.io is slow to import

        content = encode(result)
    else:
        content = render(form, header, rows, terminal_width() if arguments.output is None else None).encode()
    try:
        _deliver(arguments.output, content)
    except ParameterError:  # the results then go where they can be read, as text
        write(render("csv", header, rows) if form == "netcdf" else content.decode(), None)
        raise
    if arguments.plot is not None:
        from ..plots import draw  # matplotlib takes longer to import than most results to compute

        with whole_file(arguments.plot, "--plot") as temporary:
            draw(result, temporary)
    return INTERRUPTED_STATUS if missing else 3 if failed else 0


def check_files(arguments):
    """Before the work, not after it: can its results be written? Return in which form."""
    if arguments.output is not None:
        check_writable(arguments.output, "-o")
    elif output_closed():
        raise ParameterError("cannot write to standard output: it is closed; write to a file with -o FILE")
    if arguments.plot is not None:
        if not arguments.plot.endswith(_PLOTS):
            raise ParameterError(f"--plot: the file must end in {', '.join(_PLOTS)} (got {arguments.plot!r})")
        check_writable(arguments.plot, "--plot")
        if arguments.output is not None and os.path.realpath(arguments.output) == os.path.realpath(arguments.plot):
            raise ParameterError(f"--plot: {arguments.plot!r} is the file of -o too; give each its own")
    return form_of(arguments)


def form_of(arguments):
    """The form asked for, or the one that the ending of the file stands for."""
    ending = Path(arguments.output or "").suffix.lower()
    if ending in _FOREIGN:
        raise ParameterError(f"-o: {ending} cannot be written; {', '.join(FORMS)} are known, .txt and no ending give a "
                             f"table (got {arguments.output!r})")
    form = FORMS.get(ending, arguments.form)
    if arguments.form not in ("table", form):
        raise ParameterError(f"-o: --{arguments.form} contradicts the ending of {arguments.output!r}; leave it out, "
                             "or end the file otherwise")
    return form


def _deliver(output, content):
    """Write the result to the file of -o, or to standard output."""
    if output is None:
        write(content.decode(), None)
        return
    with whole_file(output, "-o") as temporary:
        temporary.write_bytes(content)


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


def _nearest(name, known):
    match = get_close_matches(name, known, 1)
    return f" (did you mean {match[0]!r}?)" if match else ""
