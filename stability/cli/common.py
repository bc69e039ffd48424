"""What the verbs share: common options, and the report of a result."""

import argparse
import os
from collections.abc import Callable, Iterator
from math import degrees
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..checks import as_number
from ..errors import ParameterError
from ..modes.accuracy import DEGREES, TOLERANCE, check_accuracy
from ..output.columns import explained
from ..status import is_interrupted, is_settled
from .asked import add_parameters, given
from .names import FLOW, flag_of
from .plotting import look_of, plot_options
from .progress import Bar
from .streams import output_closed, put, say, terminal_width
from .verbs import VERBS

if TYPE_CHECKING:
    from ..modes.accuracy import Accuracy

SPEC = "a number, a list a,b,c, or a range a:b:n (log-spaced) or a:b:n:lin"
INTERRUPTED_STATUS = 130  # of the command
FORMS = {".csv": "csv", ".json": "json", ".nc": "netcdf"}  # that the ending of a file stands for
_TEXT = "", ".txt"  # endings of a table
_RADIANS = 1.6  # degrees: a smaller slope may be one in radians, of which a right angle has 1.57
_PLOTS = (".png", ".pdf", ".svg")


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
    verb.set_defaults(run=run, form="table", complete=add_parameters)


def _output_options(verb: Any) -> None:
    form = verb.add_mutually_exclusive_group()
    form.add_argument("--csv", dest="form", action="store_const", const="csv", help="comma-separated values")
    form.add_argument("--json", dest="form", action="store_const", const="json", help="JSON")
    verb.add_argument("-o", "--output", metavar="FILE",
                      help="write there instead of standard output; .csv, .json and .nc (netCDF) in that form")
    plot_options(verb)


def k_option(verb: Any) -> None:
    verb.add_argument("--k", required=True, metavar="SPEC", help=f"wavenumbers: {SPEC}")


def accuracy_options(verb: Any) -> None:
    """Options of the verbs that compute with `options_of`."""
    verb.add_argument("--tolerance", metavar="T", default=str(TOLERANCE),
                      help="relative error of sigma accepted as resolved")
    verb.add_argument("--max-degree", metavar="N", default=str(DEGREES[-1]), help="largest Chebyshev degree tried")


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
    from ..output.text import render, whole_file

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
    for name, text in given(arguments).items():
        value = as_number(text) if name.endswith("_deg") else None
        if value is not None and 0 < value < _RADIANS:
            yield (f"{name} = {value:g} is an angle in degrees; if it is meant in radians, give "
                   f"{flag_of(name)} {degrees(value):.6g}")


def check_files(arguments: argparse.Namespace) -> str:
    """Before the work, not after it: can its results be written? Return in which form."""
    from ..output.text import check_writable

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
    from ..output.text import whole_file

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
