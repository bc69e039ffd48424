"""What the verbs share: flows and their flags, common options, and the report of a result."""

import argparse
import os
from collections.abc import Callable, Iterator
from dataclasses import fields, replace
from math import degrees
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..checks import as_number
from ..errors import ParameterError
from ..flows import find
from ..flows.base import allowed, check_flow, numeric
from ..flows.catalogue import nearest
from ..modes.accuracy import DEGREES, TOLERANCE, check_accuracy
from ..output.columns import explained
from ..output.text import check_writable, render, whole_file
from ..status import is_interrupted, is_settled
from .names import FLOW, flag_of
from .plotting import look_of, plot_options
from .progress import Bar
from .specs import parse_spec
from .streams import output_closed, put, say, terminal_width
from .verbs import VERBS
from .verbs.once import NUMBER

if TYPE_CHECKING:
    from ..flows.base import Flow
    from ..modes.accuracy import Accuracy

SPEC = "a number, a list a,b,c, or a range a:b:n (log-spaced) or a:b:n:lin"
INTERRUPTED_STATUS = 130  # of the command
FORMS = {".csv": "csv", ".json": "json", ".nc": "netcdf"}  # that the ending of a file stands for
_TEXT = "", ".txt"  # endings of a table
_RADIANS = 1.6  # degrees: a smaller slope may be one in radians, of which a right angle has 1.57
_PLOTS = (".png", ".pdf", ".svg")
LAW = ("friction law: linear, saturating, regularised, power, or your own: path/to/file.py:Class; its parameters are "
       "listed by: --law NAME --help")


def add_verb(verbs: Any, name: str, run: Callable[..., Any], example: str, *options: Callable[..., Any]) -> None:
    """Add a verb that takes a flow, its parameters, the common options and whatever `options` add."""
    add_bare_verb(verbs, name, run, example, *options, _output_options)


def add_bare_verb(verbs: Any, name: str, run: Callable[..., Any], example: str, *options: Callable[..., Any]) -> None:
    """Add a verb that takes a flow, its parameters and `options`, and writes no result."""
    summary = VERBS[name]
    verb = verbs.add_parser(name, help=summary, description=summary[0].upper() + summary[1:] + ".",
                            epilog=f"{explained(name)}\n\nexample: {example}".lstrip(), add_help=False,
                            usage=f"stability {name} FLOW [options]")
    verb.add_argument("flow", metavar="FLOW", help=FLOW)
    for option in options:
        option(verb)
    verb.add_argument("--quiet", action="store_true", help="no progress and no warnings on standard error")
    verb.add_argument("-h", "--help", action="help", help="show this help and exit")
    verb.set_defaults(run=run, form="table", complete=_add_parameters)


def _output_options(verb: Any) -> None:
    form = verb.add_mutually_exclusive_group()
    form.add_argument("--csv", dest="form", action="store_const", const="csv", help="comma-separated values")
    form.add_argument("--json", dest="form", action="store_const", const="json", help="JSON")
    verb.add_argument("-o", "--output", metavar="FILE",
                      help="write there instead of standard output; .csv, .json and .nc (netCDF) in that form")
    plot_options(verb)


def _add_parameters(verb: Any, words: list[str]) -> None:
    """Add a flag for every parameter of the flow that the words name."""
    name = _flow_named(verb, words)
    if name is None:
        verb.add_argument_group("parameters of the flow", f"listed by: {verb.prog} FLOW --help")
        return
    flow = _class_of(name, _law_named(words))
    group = verb.add_argument_group(f"parameters of {flow.name}", flow.title)
    if hasattr(flow, "under"):
        group.add_argument("--law", metavar="NAME", help=LAW)
    for item in fields(flow):
        text = f"{item.metadata['meaning']}; {allowed(item.metadata)}, default {item.default}".replace("%", "%%")
        for spelling in dict.fromkeys((flag(item), f"--{item.name}")):
            group.add_argument(spelling, dest=f"parameter {item.name}", metavar=_metavar(item),
                               help=text if spelling == flag(item) else argparse.SUPPRESS)


def _flow_named(verb: Any, words: list[str]) -> str | None:
    """The first of the words that is no option and no value of one; an option that is unknown yet takes a value."""
    value_follows = False
    for word in words:
        if value_follows:
            value_follows = False
        elif not word.startswith("-") or word == "-":
            return word
        else:
            option = verb._option_string_actions.get(word)
            long = word.startswith("--") and "=" not in word
            value_follows = option.nargs != 0 if option else long
    return None


def _metavar(item: Any) -> str:
    return NUMBER if numeric(item) else "FILE" if "table" in item.metadata else "NAME"


def _law_named(words: list[str]) -> str | None:
    """The friction law that the words name, or None; an abbreviated or missing value is left to the parser."""
    for word, following in zip(words, [*words[1:], None], strict=True):
        if word == "--law" or word.startswith("--law="):
            return word.partition("=")[2] if "=" in word else following
    return None


def _class_of(name: str, law: str | None) -> Any:
    """The class of flows with this name, under the friction law if one is named."""
    flow = find(name)
    if law is None or not hasattr(flow, "under"):
        return flow
    from ..flows.laws import find_law

    return flow.under(find_law(law))


def flag(item: Any) -> str:
    """Command-line flag of a parameter."""
    return flag_of(item.name)


def nearest_flag(arguments: argparse.Namespace, unknown: Any) -> Any:
    """A hint at the parameter that an unknown option may stand for."""
    if not getattr(arguments, "flow", None):
        return ""
    flow = _class_of(arguments.flow, getattr(arguments, "law", None))
    flags = [flag(item) for item in fields(flow)]
    return nearest(unknown.partition("=")[0], flags) or f"; {flow.name} has {', '.join(flags) or 'no parameters'}"


def nearest_option(unknown: str, known: list[str]) -> str:
    """A hint at the option of a verb that an unknown one may stand for, in the other case of letters first."""
    name = unknown.partition("=")[0]
    same = [option for option in known if option.lower() == name.lower()]
    return nearest(same[0], same) if same else nearest(name, known)


def k_option(verb: Any) -> None:
    verb.add_argument("--k", required=True, metavar="SPEC", help=f"wavenumbers: {SPEC}")


def accuracy_options(verb: Any) -> None:
    """Options of the verbs that compute with `options_of`."""
    verb.add_argument("--tolerance", metavar="T", default=str(TOLERANCE),
                      help="relative error of sigma accepted as resolved")
    verb.add_argument("--max-degree", metavar="N", default=str(DEGREES[-1]), help="largest Chebyshev degree tried")


def flow_of(arguments: argparse.Namespace) -> "Flow":
    """The flow with the parameters given as flags."""
    given = {key.partition(" ")[2]: value for key, value in vars(arguments).items()
             if key.startswith("parameter ") and value is not None}
    flow = _class_of(arguments.flow, getattr(arguments, "law", None))(**given)
    return check_flow(flow)


def sweep_of(arguments: argparse.Namespace, flow: "Flow") -> tuple[Any, ...]:
    """The swept parameter's name (or None) and the flows of the sweep."""
    if arguments.over is None:
        return None, [flow]
    name, values = swept_values(arguments.over, flow)
    return name, [replace(flow, **{name: value}) for value in values]


def swept_values(text: str, flow: "Flow", option: str = "--over") -> tuple[str, list[float]]:
    """The parameter and its values of NAME=SPEC."""
    name, _, spec = text.partition("=")
    name = name.replace("-", "_")
    known = [item.name for item in fields(flow) if numeric(item)]
    if name not in known:
        raise ParameterError(f"{option}: {flow.name} has no parameter {name!r}{nearest(name, known)}; "
                             f"it has {', '.join(known)}")
    (item,) = (item for item in fields(flow) if item.name == name)
    return name, parse_spec(spec, f"{option} {name}", False, item.metadata["unbounded"]).tolist()


def accuracy_of(arguments: argparse.Namespace) -> "Accuracy":
    """The accuracy asked for by `accuracy_options`."""
    return check_accuracy(arguments.tolerance, arguments.max_degree, ("--tolerance", "--max-degree"))


def options_of(arguments: argparse.Namespace) -> dict[str, Any]:
    """The same as keyword arguments."""
    return accuracy_of(arguments).settings


def report(arguments: argparse.Namespace, compute: Callable[..., Any]) -> int:
    """Check where output goes, compute a Record, write it; return the exit status."""
    form = check_files(arguments)
    result = compute()
    rows, header = result.rows(), result.header()
    missing = [row for row in rows if is_interrupted(row["status"])]
    failed = [row for row in rows if not is_settled(row["status"]) and not is_interrupted(row["status"])]
    if not arguments.quiet:
        for note in _radians(arguments):
            say(f"stability: {note}")
        for note in header.get("notes", ()):
            say(f"stability: {note}")
        if failed:
            say(f"stability: {len(failed)} of {len(rows)} rows are not resolved: see status")
        if missing:
            say(f"stability: interrupted: {len(missing)} of {len(rows)} rows are not computed")
    if form == "netcdf":
        from ..output.netcdf import encode  # scipy.io is slow to import

        content = encode(result)
    else:
        content = render(form, header, rows, terminal_width() if arguments.output is None else None).encode()
    try:
        _deliver(arguments.output, content)
    except ParameterError:  # the results then go where they can be read, as text
        put(render("csv", header, rows) if form == "netcdf" else content.decode())
        raise
    if arguments.plot is not None:
        from ..output.plots import draw  # matplotlib takes longer to import than most results to compute

        with whole_file(arguments.plot, "--plot") as temporary:
            for note in draw(result, temporary, look_of(arguments)):
                say(f"stability: {note}")
    return INTERRUPTED_STATUS if missing else 3 if failed else 0


def _radians(arguments: argparse.Namespace) -> Iterator[Any]:
    """A hint where an angle in degrees is so small that it may have been meant in radians."""
    given = {key.partition(" ")[2]: value for key, value in vars(arguments).items()
             if key.startswith("parameter ") and value is not None}
    for name, text in given.items():
        value = as_number(text) if name.endswith("_deg") else None
        if value is not None and 0 < value < _RADIANS:
            yield (f"{name} = {value:g} is an angle in degrees; if it is meant in radians, give "
                   f"{flag_of(name)} {degrees(value):.6g}")


def check_files(arguments: argparse.Namespace) -> str:
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
    look_of(arguments)
    return form_of(arguments)


def form_of(arguments: argparse.Namespace) -> str:
    """The form asked for, or the one that the ending of the file stands for."""
    ending = Path(arguments.output or "").suffix.lower()
    if ending not in (*FORMS, *_TEXT):
        raise ParameterError(f"-o: {ending} cannot be written; {', '.join(FORMS)} are known, .txt and no ending give a "
                             f"table (got {arguments.output!r})")
    form = FORMS.get(ending, arguments.form)
    if arguments.form not in ("table", form):
        raise ParameterError(f"-o: --{arguments.form} contradicts the ending of {arguments.output!r}; leave it out, "
                             "or end the file otherwise")
    return form


def _deliver(output: str | None, content: bytes) -> None:
    """Write the result to the file of -o, or to standard output."""
    if output is None:
        put(content.decode())
        return
    with whole_file(output, "-o") as temporary:
        temporary.write_bytes(content)


def collect(arguments: argparse.Namespace, results: Any, total: int, rest: Callable[..., Any],
            size: Callable[..., Any] = lambda result: 1) -> list[Any]:
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
