"""The command `asymptotics`: expansions on standard output, one clear line on standard error when it fails.

Exit status: 0 done; 2 bad usage or input; 3 `check` found another order than expected; 130 interrupted.
"""

import argparse
import shutil
import sys
from difflib import get_close_matches
from textwrap import wrap

from . import __version__
from .streams import drop_output, open_streams, say

VERBS = ("flows", "expand", "evaluate", "check")
_REMEDY = "give the output of stability dispersion ... --csv"
_MARK = "\ufeff"  # of the byte order, which some programs write first
_INDENT = " " * 8  # of what is left of a line wider than the terminal


class BadUsage(ValueError):
    """What the command line asks for cannot be done."""


class _Parser(argparse.ArgumentParser):
    """Errors as exceptions; no value is given twice; examples in one line, to be copied."""

    def __init__(self, **options):
        super().__init__(formatter_class=argparse.RawDescriptionHelpFormatter, allow_abbrev=False, **options)
        for action in (None, "store"):
            self.register("action", action, _Once)
        self.set_defaults(given=frozenset())

    def error(self, message):
        raise BadUsage(f"{message} (see: {self.prog} --help)")

    def exit(self, status=0, message=None):
        sys.stdout.flush()  # of the help: where nobody reads it, say so in `main`
        super().exit(status, message)


class _Once(argparse.Action):
    """Store a value, and in `given` that it was given: twice is refused, or the first value would get lost."""

    def __call__(self, parser, namespace, values, option_string=None):
        if self.dest in namespace.given:
            raise BadUsage(f"{option_string}: given twice, with {getattr(namespace, self.dest)!r} and {values!r}; "
                           "give it once")
        setattr(namespace, self.dest, values)
        namespace.given |= {self.dest}


class _Help(argparse.Action):
    """Print the help of a verb, with the parameters of the flow that has been named before, if any."""

    def __init__(self, option_strings, dest, help):
        super().__init__(option_strings, argparse.SUPPRESS, nargs=0, default=argparse.SUPPRESS, help=help)

    def __call__(self, parser, namespace, values, option_string=None):
        from . import flows

        group = namespace.parameters
        if namespace.flow in flows.names():
            flow = flows.load(namespace.flow)
            texts = {parameter.flag: f"{parameter.meaning}, {parameter.range}" for parameter in flow.PARAMETERS}
            group.title, group.description = f"parameters of {namespace.flow}", flow.SUMMARY
            for action in group._group_actions:
                action.help = texts.get(action.option_strings[0], argparse.SUPPRESS)
        parser.print_help()
        parser.exit()


def main(argv=None) -> int:
    """Run the command line; return the exit status."""
    argv = sys.argv[1:] if argv is None else argv
    open_streams()
    try:
        status = _run(argv)
        sys.stdout.flush()
        return status
    except BrokenPipeError:
        drop_output()
        return 141
    except OSError as reason:  # input files report their own; this is the stream
        drop_output()
        return _fail(f"cannot write to standard output: {reason.strerror}", 2)
    except KeyboardInterrupt:
        return _fail("interrupted", 130)


def _run(argv) -> int:
    try:
        arguments, unknown = _parser(argv).parse_known_args(argv)
        if unknown:
            raise BadUsage(f"unknown {'option' if unknown[0].startswith('-') else 'argument'} {unknown[0]!r}"
                           f"{_nearest_flag(arguments, unknown[0])}; see --help, and for parameters: asymptotics flows")
        return arguments.run(arguments)
    except BadUsage as reason:
        return _fail(reason, 2)
    except (ValueError, LookupError) as reason:
        from .flows import NoSuchFlow
        from .limits import TooFewPoints
        from .parameters import BadParameter

        if isinstance(reason, (BadParameter, NoSuchFlow, TooFewPoints)):
            return _fail(reason.args[0], 2)
        raise


def _fail(reason, status: int) -> int:
    say(f"asymptotics: {reason}")
    return status


def _parser(argv) -> _Parser:
    parser = _Parser(prog="asymptotics", description="Long-wave and other limits of granular shear flows, exactly.",
                     epilog="example: asymptotics expand dune --regime shallow --shields 1.5 --depth 10")
    parser.add_argument("--version", action="version", version=f"asymptotics {__version__}")
    verbs = parser.add_subparsers(metavar="VERB", required=True, parser_class=_Parser)
    verb = verbs.add_parser("flows", help="flows, their parameters and regimes",
                            epilog="example: asymptotics flows dune")
    verb.add_argument("flow", nargs="?", metavar="FLOW", help="one flow only")
    verb.set_defaults(run=_flows)
    expand = verbs.add_parser("expand", help="expansion of the growth rate", add_help=False,
                              epilog="example: asymptotics expand vortex --order 4 --slope-deg 30")
    expand.add_argument("flow", metavar="FLOW", help="one of those that are listed by: asymptotics flows")
    expand.set_defaults(run=_expand)
    form = expand.add_mutually_exclusive_group()
    form.add_argument("--latex", dest="form", action="store_const", const="latex", help="LaTeX formulas")
    form.add_argument("--json", dest="form", action="store_const", const="json", help="JSON")
    expand.add_argument("--numbers", action="store_true", help="defaults for parameters that are not given")
    evaluate = verbs.add_parser("evaluate", help="the expansion as numbers, in the columns of `stability dispersion`",
                                add_help=False, epilog="example: asymptotics evaluate dune --k 0.01:0.1:9 --csv")
    evaluate.add_argument("flow", metavar="FLOW", help="one of those that are listed by: asymptotics flows")
    evaluate.add_argument("--k", required=True, metavar="SPEC",
                          help="wavenumbers: a number, a list a,b,c, or a range a:b:n (log-spaced) or a:b:n:lin")
    form = evaluate.add_mutually_exclusive_group()
    form.add_argument("--csv", dest="form", action="store_const", const="csv", help="comma-separated values")
    form.add_argument("--json", dest="form", action="store_const", const="json", help="JSON")
    evaluate.set_defaults(run=_evaluate)
    check = verbs.add_parser("check", help="compare with numbers written by `stability dispersion ... --csv`",
                             add_help=False,
                             epilog="example: stability dispersion dune --k 1e-6:1e-4:9 --csv | asymptotics check dune")
    check.add_argument("flow", metavar="FLOW", help="the flow that the numbers belong to")
    check.add_argument("file", nargs="?", default="-", metavar="CSV", help="file, or - for standard input")
    check.add_argument("--tolerance", default="0.05", metavar="T", help="allowed difference of the orders")
    check.add_argument("--part", choices=("real", "imag", "both"), default="both",
                       help="real: growth rates only; imag: phase speeds only; both: each by itself")
    check.add_argument("--k-max", metavar="K", help="leave out larger wavenumbers (default: those beyond two decades)")
    check.set_defaults(run=_check)
    for verb in (expand, evaluate, check):
        verb.add_argument("--order", metavar="M", help="highest power of the gauge, e.g. 2 or 4/3")
        verb.add_argument("--regime", metavar="NAME", help="which limit (see: asymptotics flows)")
        verb.add_argument("-h", "--help", action=_Help, help="show this help and exit")
        if argv and argv[0] in VERBS[1:]:
            _add_parameters(verb)
    return parser


def _add_parameters(verb) -> None:
    """Flags of every flow: a flow is a module that costs sympy, so only when a verb needs them."""
    from . import flows

    group = verb.add_argument_group("parameters of the flow", f"listed by: {verb.prog} FLOW --help")
    known = {parameter.flag: parameter.name for name in flows.names() for parameter in flows.load(name).PARAMETERS}
    for flag, name in known.items():
        for spelling in dict.fromkeys((flag, f"--{name}")):
            if spelling in verb._option_string_actions:
                continue  # the wavenumbers of evaluate
            group.add_argument(spelling, dest=f"parameter {name}", metavar="V", help=argparse.SUPPRESS)
    verb.set_defaults(parameters=group)


# -- verbs -----------------------------------------------------------------------------------------------


def _flows(arguments) -> int:
    from . import flows

    chosen = [arguments.flow] if arguments.flow else flows.names()
    print(_folded("\n".join(_describe(name, _load(name)) for name in chosen)))
    return 0


def _describe(name: str, flow) -> str:
    lines = [f"{name}: {flow.SUMMARY}"]
    width = max(12, *(len(parameter.flag) for parameter in flow.PARAMETERS))
    lines += [f"  {parameter.flag:{width}} {parameter.range:22} {parameter.meaning}" for parameter in flow.PARAMETERS]
    lines += [f"  --regime {regime:15} {limit.summary}; parameters {', '.join(limit.parameters)}; "
              f"order {limit.lowest} to {limit.available}, default {limit.default}"
              for regime, limit in flow.REGIMES.items()]
    return "\n".join(lines)


def _expand(arguments) -> int:
    from . import flows, printing

    flow = _load(arguments.flow)
    expansion = flows.expand(arguments.flow, arguments.regime, arguments.order, numbers=arguments.numbers,
                             **_given(arguments))
    if arguments.numbers:
        _need_numbers(expansion)
    meanings = {parameter.name: parameter.meaning for parameter in flow.PARAMETERS}
    writer = {"json": printing.as_json, "latex": lambda one: printing.latex(one, flow.LATEX),
              None: lambda one: _folded(printing.table(one, meanings))}[arguments.form]
    print(writer(expansion))
    return 0


def _need_numbers(expansion) -> None:
    missing = [name for name, value in expansion.parameters.items() if value is None]
    if missing:
        raise BadUsage(f"regime {expansion.regime} needs {', '.join('--' + name for name in missing)}: there is no "
                       "default")


def _evaluate(arguments) -> int:
    from . import flows, printing
    from .specs import BadSpec, parse_spec

    _load(arguments.flow)
    try:
        k = parse_spec(arguments.k, "--k")
    except BadSpec as reason:
        raise BadUsage(reason) from None
    expansion = flows.expand(arguments.flow, arguments.regime, arguments.order, numbers=True, **_given(arguments))
    if expansion.gauge.name != "k":
        raise BadUsage(f"regime {expansion.regime} is a series in {expansion.gauge}, not in k: evaluate takes a regime "
                       "in powers of k; see asymptotics expand for its coefficients")
    _need_numbers(expansion)
    text = printing.numbers(expansion, k, arguments.form)
    print(text if arguments.form else _folded(text))
    return 0


def _check(arguments) -> int:
    from . import flows
    from .limits import OrderMismatch, assert_order

    _load(arguments.flow)
    tolerance, largest = _positive(arguments.tolerance, "--tolerance"), None
    if arguments.k_max is not None:
        largest = _positive(arguments.k_max, "--k-max")
    header, columns, left_out = _read_csv(arguments.file)
    if header.get("flow", arguments.flow) != arguments.flow:
        raise BadUsage(f"{_source(arguments.file)} holds the flow {header['flow']}, asked for {arguments.flow}; "
                       f"run: asymptotics check {header['flow']}")
    laws = getattr(flows.load(arguments.flow), "LAWS", ())
    if laws and header.get("law", laws[0]) not in laws:
        raise BadUsage(f"{_source(arguments.file)} holds friction law {header['law']}; the expansions of "
                       f"{arguments.flow} are those of law {' and '.join(laws)}")
    names = {parameter.name for parameter in flows.load(arguments.flow).PARAMETERS}
    values = {name: value for name, value in header.items() if name in names} | _given(arguments)
    expansion = flows.expand(arguments.flow, arguments.regime, arguments.order, **values)
    missing = [name for name, value in expansion.parameters.items() if value is None]
    if expansion.gauge.name != "k" or missing:
        problem = f"needs {', '.join('--' + name for name in missing)}" if missing else "is not a series in k"
        raise BadUsage(f"regime {expansion.regime} {problem}: "
                       "check takes a regime in powers of k with all parameters given")
    sigma, part = _sigma(columns, arguments)
    try:
        comparison = assert_order(sigma, expansion, columns["k"], part=part, error=columns["error"], largest=largest,
                                  tolerance=tolerance)
    except OrderMismatch as mismatch:
        comparison = mismatch.comparison
    for note in (*left_out, *comparison.left_out):
        say(f"asymptotics: {note}")
    return _judge(comparison)


def _sigma(columns, arguments):
    """The complex growth rate, and which part of it is known and asked for."""
    if "phase_speed" in columns:
        return columns["growth_rate"] - 1j * columns["k"] * columns["phase_speed"], arguments.part
    if arguments.part == "imag":
        raise BadUsage(f"{_source(arguments.file)} has no column phase_speed, which --part imag needs")
    return columns["growth_rate"], "real"


def _judge(comparison) -> int:
    """Print a comparison, what fails with the verdict first; return the exit status."""
    verdict, table = f"# {comparison.verdict}", comparison.table()
    print(*((table, verdict) if comparison.agrees else (verdict, table)), sep="\n")
    return 0 if comparison.agrees else _fail(comparison.verdict, 3)


# -- input -----------------------------------------------------------------------------------------------


def _load(name: str):
    from . import flows

    if name not in flows.names():
        raise BadUsage(f"unknown flow {name!r}{_nearest(name, flows.names())}; flows: {', '.join(flows.names())}")
    return flows.load(name)


def _nearest_flag(arguments, unknown: str) -> str:
    from . import flows

    name = getattr(arguments, "flow", None)
    known = [parameter.flag for parameter in flows.load(name).PARAMETERS] if name in flows.names() else []
    return _nearest(unknown.partition("=")[0], known)


def _nearest(name: str, known) -> str:
    match = get_close_matches(name, known, 1)
    return f" (did you mean {match[0]!r}?)" if match else ""


def _given(arguments) -> dict[str, str]:
    return {key.partition(" ")[2]: value for key, value in vars(arguments).items()
            if key.startswith("parameter ") and value is not None}


def _positive(text: str, flag: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not value > 0:
        raise BadUsage(f"{flag} must be a positive number, got {text!r}; write it like {flag} 0.05")
    return value


def _source(name: str) -> str:
    return "standard input" if name == "-" else name


def _read_csv(name: str):
    """Header {key: text} from `# key: value` lines, columns {name: array (rows,)}, and what has been left out."""
    import csv

    lines = [line for line in _read(name).removeprefix(_MARK).splitlines() if line.strip()]
    comments = [line[1:].partition(":") for line in lines if line.startswith("#")]
    header = {key.strip(): value.strip() for key, _, value in comments}
    names, *rows = [[cell.strip() for cell in row] for row in csv.reader(
        (line for line in lines if not line.startswith("#")), skipinitialspace=True)] or [[]]
    if absent := [column for column in ("k", "growth_rate") if column not in names]:
        empty = "" if names else "is empty: it "
        raise BadUsage(f"{_source(name)} {empty}has no column {', '.join(absent)}; {_REMEDY}")
    return header, *_columns(name, names, [dict(zip(names, row, strict=False)) for row in rows])


def _read(name: str) -> str:
    if name == "-" and sys.stdin is None:
        raise BadUsage("cannot read standard input: it is closed; give the name of a file")
    try:
        with (open(name, encoding="utf-8", newline="") if name != "-" else _keep_open(sys.stdin)) as stream:
            return stream.read()
    except (OSError, ValueError) as reason:
        why = getattr(reason, "strerror", None) or ("not text" if isinstance(reason, UnicodeError) else "no such name")
        raise BadUsage(f"cannot read {_source(name)}: {why}; give a file written by stability dispersion ... --csv"
                       ) from None


def _columns(name: str, names, rows):
    """Numbers of the resolved rows; the phase speed where there is one, the error 0 where there is none."""
    import numpy as np

    from .limits import FEWEST

    resolved = [row for row in rows if row.get("status", "resolved").startswith("resolved")]
    wanted = [column for column in ("k", "growth_rate", "phase_speed") if column in names]
    if "phase_speed" not in names and len(resolved) < FEWEST:
        raise BadUsage(f"{_source(name)} has no column phase_speed, and of growth rates alone {FEWEST} are needed "
                       f"(got {len(resolved)} resolved); {_REMEDY}")
    try:
        columns = {column: np.array([float(row[column]) for row in resolved]) for column in wanted}
        columns["error"] = np.array([abs(float(row.get("error") or 0)) for row in resolved])
    except (KeyError, ValueError):
        raise BadUsage(f"{_source(name)}: a row is not numbers; {_REMEDY}") from None
    if not (columns["k"] > 0).any() or (columns["k"] <= 0).any():
        raise BadUsage(f"{_source(name)} has no resolved row with k > 0, or one with another k; give at least four "
                       "small wavenumbers")
    others = [row["k"] for row in rows if row not in resolved]
    return columns, [f"{len(others)} of {len(rows)} rows left out: not resolved, first at k = {k}" for k in others[:1]]


class _keep_open:
    """A stream that its `with` block does not close."""

    def __init__(self, stream):
        self.stream = stream

    def __enter__(self):
        return self.stream

    def __exit__(self, *_):
        return None


# -- output ----------------------------------------------------------------------------------------------


def _folded(text: str) -> str:
    """Lines no wider than the terminal that standard output is, where they can be broken at spaces."""
    if not sys.stdout.isatty():
        return text
    width = shutil.get_terminal_size().columns
    return "\n".join(part for line in text.splitlines()
                     for part in wrap(line, width, subsequent_indent=_INDENT, break_long_words=False,
                                      break_on_hyphens=False) or [line])
