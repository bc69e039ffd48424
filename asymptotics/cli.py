"""The command `asymptotics`: expansions on standard output, one clear line on standard error when it fails.

Exit status: 0 done; 2 bad usage or input; 3 `check` found another order than expected; 130 interrupted.
"""

import argparse
import shutil
import sys
from textwrap import wrap
from typing import TYPE_CHECKING, Any

from . import __version__
from .catalogue import names
from .errors import BadParameter, NoSuchFlow, TooFewPoints
from .reading import read_csv, source
from .specs import BadSpec, parse_spec
from .streams import drop_output, open_streams, say
from .usage import BadUsage, Help, Parser, add_parameters, nearest, positive

if TYPE_CHECKING:
    from .series import Expansion

VERBS = ("flows", "expand", "evaluate", "check")
_INDENT = " " * 8  # of what is left of a line wider than the terminal


def main(argv: list[str] | None = None) -> int:
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


def _run(argv: list[str]) -> int:
    try:
        arguments, unknown = _parser(argv).parse_known_args(argv)
        if unknown:
            raise BadUsage(f"unknown {'option' if unknown[0].startswith('-') else 'argument'} {unknown[0]!r}"
                           f"{_nearest_flag(arguments, unknown[0])}; see --help, and for parameters: asymptotics flows")
        return arguments.run(arguments)
    except BadUsage as reason:
        return _fail(reason, 2)
    except (BadParameter, NoSuchFlow, TooFewPoints) as reason:
        return _fail(reason.args[0], 2)


def _fail(reason: Any, status: int) -> int:
    say(f"asymptotics: {reason}")
    return status


def _parser(argv: list[str]) -> Parser:
    parser = Parser(prog="asymptotics", description="Long-wave and other limits of granular shear flows, exactly.",
                    epilog="example: asymptotics expand dune --regime shallow --shields 1.5 --depth 10")
    parser.add_argument("--version", action="version", version=f"asymptotics {__version__}")
    verbs = parser.add_subparsers(metavar="VERB", required=True, parser_class=Parser)
    verb = verbs.add_parser("flows", help="flows, their parameters and regimes",
                            epilog="example: asymptotics flows dune")
    verb.add_argument("flow", nargs="?", metavar="FLOW", help="one flow only")
    verb.set_defaults(run=_flows)
    for verb in (_add_expand(verbs), _add_evaluate(verbs), _add_check(verbs)):
        verb.add_argument("--order", metavar="M", help="highest power of the gauge, e.g. 2 or 4/3")
        verb.add_argument("--regime", metavar="NAME", help="which limit (see: asymptotics flows)")
        verb.add_argument("-h", "--help", action=Help, help="show this help and exit")
        if argv and argv[0] in VERBS[1:]:
            add_parameters(verb, _flags_are_needed(argv[1:]))
    return parser


def _flags_are_needed(words: list[str]) -> bool:
    """Whether these words, after a verb, can have parameters of a flow among them."""
    flows = names()
    return any(word in flows or word.startswith("-") and word not in ("-h", "--help") for word in words)


def _add_expand(verbs: Any) -> Parser:
    verb = verbs.add_parser("expand", help="expansion of the growth rate", add_help=False,
                            epilog="example: asymptotics expand vortex --order 4 --slope-deg 30")
    verb.add_argument("flow", metavar="FLOW", help="one of those that are listed by: asymptotics flows")
    _add_forms(verb, latex="LaTeX formulas", json="JSON")
    verb.add_argument("--numbers", action="store_true", help="defaults for parameters that are not given")
    verb.set_defaults(run=_expand)
    return verb


def _add_evaluate(verbs: Any) -> Parser:
    verb = verbs.add_parser("evaluate", help="the expansion as numbers, in the columns of `stability dispersion`",
                            add_help=False, epilog="example: asymptotics evaluate dune --k 0.01:0.1:9 --csv")
    verb.add_argument("flow", metavar="FLOW", help="one of those that are listed by: asymptotics flows")
    verb.add_argument("--k", required=True, metavar="SPEC",
                      help="wavenumbers: a number, a list a,b,c, or a range a:b:n (log-spaced) or a:b:n:lin")
    _add_forms(verb, csv="comma-separated values", json="JSON")
    verb.set_defaults(run=_evaluate)
    return verb


def _add_check(verbs: Any) -> Parser:
    verb = verbs.add_parser("check", help="compare with numbers written by `stability dispersion ... --csv`",
                            add_help=False,
                            epilog="example: stability dispersion dune --k 1e-6:1e-4:9 --csv | asymptotics check dune")
    verb.add_argument("flow", metavar="FLOW", help="the flow that the numbers belong to")
    verb.add_argument("file", nargs="?", default="-", metavar="CSV", help="file, or - for standard input")
    verb.add_argument("--tolerance", default="0.05", metavar="T", help="allowed difference of the orders")
    verb.add_argument("--part", choices=("real", "imag", "both"), default="both",
                      help="real: growth rates only; imag: phase speeds only; both: each by itself")
    verb.add_argument("--k-max", metavar="K", help="leave out larger wavenumbers (default: those beyond two decades)")
    verb.set_defaults(run=_check)
    return verb


def _add_forms(verb: Parser, **forms: str) -> None:
    """Flags of the forms that output can have, {name: help}; one of them at most."""
    group = verb.add_mutually_exclusive_group()
    for name, meaning in forms.items():
        group.add_argument(f"--{name}", dest="form", action="store_const", const=name, help=meaning)


# -- verbs -----------------------------------------------------------------------------------------------


def _flows(arguments: argparse.Namespace) -> int:
    chosen = [arguments.flow] if arguments.flow else names()
    print(_folded("\n".join(_describe(name, _load(name)) for name in chosen)))
    return 0


def _describe(name: str, flow: Any) -> str:
    lines = [f"{name}: {flow.SUMMARY}"]
    width = max(12, *(len(parameter.flag) for parameter in flow.PARAMETERS))
    lines += [f"  {parameter.flag:{width}} {parameter.range:22} {parameter.meaning}" for parameter in flow.PARAMETERS]
    lines += [f"  --regime {regime:15} {limit.summary}; parameters {', '.join(limit.parameters)}; "
              f"order {limit.lowest} to {limit.available}, default {limit.default}"
              for regime, limit in flow.REGIMES.items()]
    return "\n".join(lines)


def _expand(arguments: argparse.Namespace) -> int:
    flow = _load(arguments.flow)
    from .flows import expand

    expansion = expand(arguments.flow, arguments.regime, arguments.order, numbers=arguments.numbers,
                       **_given(arguments))
    if arguments.numbers:
        _need_numbers(expansion)
    from . import printing

    meanings = {parameter.name: parameter.meaning for parameter in flow.PARAMETERS}
    writer = {"json": printing.as_json, "latex": lambda one: printing.latex(one, flow.LATEX),
              None: lambda one: _folded(printing.table(one, meanings))}[arguments.form]
    print(writer(expansion))
    return 0


def _need_numbers(expansion: "Expansion") -> None:
    missing = [name for name, value in expansion.parameters.items() if value is None]
    if missing:
        raise BadUsage(f"regime {expansion.regime} needs {', '.join('--' + name for name in missing)}: there is no "
                       "default")


def _evaluate(arguments: argparse.Namespace) -> int:
    _load(arguments.flow)
    try:
        k = parse_spec(arguments.k, "--k")
    except BadSpec as reason:
        raise BadUsage(reason) from None
    from . import printing
    from .flows import expand

    expansion = expand(arguments.flow, arguments.regime, arguments.order, numbers=True, **_given(arguments))
    if expansion.gauge.name != "k":
        raise BadUsage(f"regime {expansion.regime} is a series in {expansion.gauge}, not in k: evaluate takes a regime "
                       "in powers of k; see asymptotics expand for its coefficients")
    _need_numbers(expansion)
    text = printing.numbers(expansion, k, arguments.form)
    print(text if arguments.form else _folded(text))
    return 0


def _check(arguments: argparse.Namespace) -> int:
    flow = _load(arguments.flow)
    tolerance, largest = positive(arguments.tolerance, "--tolerance"), None
    if arguments.k_max is not None:
        largest = positive(arguments.k_max, "--k-max")
    from .flows import expand
    from .limits import OrderMismatch, assert_order

    header, columns, left_out = read_csv(arguments.file)
    if header.get("flow", arguments.flow) != arguments.flow:
        raise BadUsage(f"{source(arguments.file)} holds the flow {header['flow']}, asked for {arguments.flow}; "
                       f"run: asymptotics check {header['flow']}")
    laws = getattr(flow, "LAWS", ())
    if laws and header.get("law", laws[0]) not in laws:
        raise BadUsage(f"{source(arguments.file)} holds friction law {header['law']}; the expansions of "
                       f"{arguments.flow} are those of law {' and '.join(laws)}")
    parameters = {parameter.name for parameter in flow.PARAMETERS}
    values = {name: value for name, value in header.items() if name in parameters} | _given(arguments)
    expansion = expand(arguments.flow, arguments.regime, arguments.order, **values)
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


def _sigma(columns: Any, arguments: argparse.Namespace) -> Any:
    """The complex growth rate, and which part of it is known and asked for."""
    if "phase_speed" in columns:
        return columns["growth_rate"] - 1j * columns["k"] * columns["phase_speed"], arguments.part
    if arguments.part == "imag":
        raise BadUsage(f"{source(arguments.file)} has no column phase_speed, which --part imag needs")
    return columns["growth_rate"], "real"


def _judge(comparison: Any) -> int:
    """Print a comparison, what fails with the verdict first; return the exit status."""
    verdict, table = f"# {comparison.verdict}", comparison.table()
    print(*((table, verdict) if comparison.agrees else (verdict, table)), sep="\n")
    return 0 if comparison.agrees else _fail(comparison.verdict, 3)


# -- input -----------------------------------------------------------------------------------------------


def _load(name: str) -> Any:
    if name not in names():
        raise BadUsage(f"unknown flow {name!r}{nearest(name, names())}; flows: {', '.join(names())}")
    from . import flows

    return flows.load(name)


def _nearest_flag(arguments: argparse.Namespace, unknown: str) -> str:
    name = getattr(arguments, "flow", None)
    known = [parameter.flag for parameter in _load(name).PARAMETERS] if name in names() else []
    return nearest(unknown.partition("=")[0], known)


def _given(arguments: argparse.Namespace) -> dict[str, str]:
    return {key.partition(" ")[2]: value for key, value in vars(arguments).items()
            if key.startswith("parameter ") and value is not None}


# -- output ----------------------------------------------------------------------------------------------


def _folded(text: str) -> str:
    """Lines no wider than the terminal that standard output is, where they can be broken at spaces."""
    if not sys.stdout.isatty():
        return text
    width = shutil.get_terminal_size().columns
    return "\n".join(part for line in text.splitlines()
                     for part in wrap(line, width, subsequent_indent=_INDENT, break_long_words=False,
                                      break_on_hyphens=False) or [line])
