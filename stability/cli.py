"""The command `stability`: one verb per question, data on stdout, one clear line on stderr when it fails.

Exit status: 0 done and resolved; 2 bad usage or input; 3 computed, but unresolved or lost; 130 interrupted.
"""

import argparse
import os
import sys
from contextlib import ExitStack
from dataclasses import fields
from difflib import get_close_matches

from . import __version__
from .dispersion import MODES, dispersion
from .errors import ParameterError, StabilityError
from .flows import FLOWS
from .flows.base import allowed
from .mode import DEGREES, TOLERANCE
from .optimum import k_max_sweep
from .output import render, whole_file, write
from .specs import parse_spec
from .spectrum import spectrum

_SPEC = "a number, a list a,b,c, or a range a:b:n (log-spaced) or a:b:n:lin"
_PLOTS = (".png", ".pdf", ".svg")


def main(argv=None):
    """Run the command line; return the exit status."""
    try:
        arguments = _parser().parse_args(argv)
        return arguments.run(arguments)
    except ParameterError as reason:
        return _fail(reason, 2)
    except StabilityError as reason:
        return _fail(reason, 3)
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 141
    except KeyboardInterrupt:
        return _fail("interrupted", 130)


def _fail(reason, status):
    print(f"stability: {reason}", file=sys.stderr)
    return status


class _Parser(argparse.ArgumentParser):
    def error(self, message):
        raise ParameterError(f"{message} (see: {self.prog} --help)")


def _parser():
    parser = _Parser(prog="stability", description="Linear stability of granular and viscous shear flows.",
                     epilog="example: stability dispersion dune --shields 2 --k 1e-2:10:50", allow_abbrev=False)
    parser.add_argument("--version", action="version", version=f"stability {__version__}")
    verbs = parser.add_subparsers(metavar="VERB", required=True, parser_class=_Parser)
    _flows_verb(verbs)
    _verb(verbs, "spectrum", _spectrum, "the least stable modes at one wavenumber",
          "stability spectrum vortex --k 2 --modes 5", _k_option, _modes_option)
    _verb(verbs, "dispersion", _dispersion, "growth rate and phase speed over wavenumbers",
          "stability dispersion dune --Re 100 --k 1e-2:10:50 --plot dune.png", _k_option, _mode_option)
    _verb(verbs, "kmax", _kmax, "the fastest growing wavenumber, over a parameter",
          "stability kmax dune --over Re=0.1:1e4:41 --plot kmax.png", _over_option)
    return parser


def _flows_verb(verbs):
    verb = verbs.add_parser("flows", help="flows, parameters, defaults, ranges, scales", allow_abbrev=False,
                            epilog="example: stability flows dune")
    verb.add_argument("flow", nargs="?", metavar="FLOW", help=f"one of {', '.join(FLOWS)}")
    verb.set_defaults(run=_flows)


def _verb(verbs, name, run, summary, example, *options):
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
    verb.add_argument("--tolerance", metavar="T", default=str(TOLERANCE), help="relative error of sigma accepted as resolved")
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


def _k_option(verb):
    verb.add_argument("--k", required=True, metavar="SPEC", help=f"wavenumbers: {_SPEC}")


def _modes_option(verb):
    verb.add_argument("--modes", default="10", metavar="M", help="how many modes (default 10)")


def _mode_option(verb):
    verb.add_argument("--mode", default=MODES[0], metavar="MODE", help=f"{' or '.join(MODES)} (default {MODES[0]})")


def _over_option(verb):
    verb.add_argument("--over", metavar="NAME=SPEC", help=f"parameter to sweep and its values: {_SPEC}")


# --- verbs ---------------------------------------------------------------------------------------


def _flows(arguments):
    chosen = [_flow_class(arguments.flow)] if arguments.flow else FLOWS.values()
    write("\n".join(_describe(flow) for flow in chosen), None)
    return 0


def _describe(flow):
    rows = [(flag(item), str(item.default), allowed(item.metadata), item.metadata["meaning"]) for item in fields(flow)]
    widths = [max(len(row[i]) for row in rows) for i in range(3)]
    lines = ["  " + "  ".join((*(cell.ljust(w) for cell, w in zip(row, widths, strict=False)), row[3])) for row in rows]
    return "\n".join([f"{flow.name}: {flow.title}", *(f"  {part}" for part in flow.scales.split("; ")), *lines, ""])


def _spectrum(arguments):
    flow, options = _flow(arguments), _options(arguments)
    count = _integer(arguments.modes, "--modes", 1, 200)
    wavenumbers = parse_spec(arguments.k, "--k")

    def compute():
        found = [spectrum(flow, k, count, strict=False, **options) for k in wavenumbers]
        return [_row(mode) for one in found for mode in one.modes], found, []

    return _report(arguments, flow, compute)


def _dispersion(arguments):
    flow, options = _flow(arguments), _options(arguments)
    wavenumbers = parse_spec(arguments.k, "--k")
    if arguments.mode not in MODES:
        raise ParameterError(f"--mode: must be one of {', '.join(MODES)} (got {arguments.mode!r})")

    def compute():
        relation = dispersion(flow, wavenumbers, arguments.mode, strict=False, **options)
        found = {mode.k: mode for mode in relation.modes}
        rows = [_row(found[k]) if k in found else _lost_row(k) for k in wavenumbers.tolist()]
        notes = sorted({str(collision) for collision in relation.collisions} | set(relation.lost.values()))
        return rows, relation, notes

    return _report(arguments, flow, compute)


def _kmax(arguments):
    flow, options = _flow(arguments), _options(arguments)
    name, sweep = _sweep(arguments, flow)

    def compute():
        found = []
        for optimum in k_max_sweep(sweep, **options):
            found.append(optimum)
            _progress(arguments, len(found), len(sweep))
        return [_kmax_row(name, optimum) for optimum in found], (name, found), []

    return _report(arguments, flow, compute)


def _row(mode):
    return {"k": mode.k, "growth_rate": mode.growth_rate, "phase_speed": mode.phase_speed, "error": mode.error,
            "degree": mode.degree, "status": mode.status}


def _lost_row(k):
    return {"k": k, "growth_rate": None, "phase_speed": None, "error": None, "degree": None, "status": "lost"}


def _kmax_row(name, optimum):
    row = {name: getattr(optimum.flow, name)} if name else {}
    best = optimum if optimum.maxima else None
    for key in ("k_max", "growth_rate", "phase_speed", "error"):
        row[key] = getattr(best, key) if best else None
    return {**row, "maxima": [[m.k, m.growth_rate] for m in optimum.maxima], "status": optimum.status}


def _report(arguments, flow, compute):
    """Check where output goes, compute, write it; return the exit status."""
    with ExitStack() as stack:
        out = stack.enter_context(whole_file(arguments.output, "-o")) if arguments.output else None
        plot = _plot_file(arguments, stack)
        rows, result, notes = compute()
        header = {"flow": flow.name, "parameters": {item.name: getattr(flow, item.name) for item in fields(flow)},
                  "method": "collocation", "version": __version__}
        if notes:
            header["notes"] = notes
        if plot:
            from .plots import draw  # matplotlib takes longer to import than most results to compute

            draw(result, plot)
        failed = [row for row in rows if row["status"] != "resolved"]
        if not arguments.quiet:
            for note in notes:
                print(f"stability: {note}", file=sys.stderr)
            if failed:
                print(f"stability: {len(failed)} of {len(rows)} rows are not resolved; see their status", file=sys.stderr)
        write(render(arguments.form, header, rows), out)
    return 3 if failed else 0


def _progress(arguments, done, total):
    if sys.stderr.isatty() and not arguments.quiet:
        print(f"\r{done}/{total}", end="" if done < total else "\r\033[K", file=sys.stderr, flush=True)


# --- input ---------------------------------------------------------------------------------------


def _flow_class(name):
    if name not in FLOWS:
        raise ParameterError(f"unknown flow {name!r}{_nearest(name, FLOWS)}; flows: {', '.join(FLOWS)}")
    return FLOWS[name]


def _flow(arguments):
    """The flow with the parameters given as flags."""
    flow = _flow_class(arguments.flow)
    known = {item.name for item in fields(flow)}
    given = {key.partition(" ")[2]: value for key, value in vars(arguments).items()
             if key.startswith("parameter ") and value is not None}
    for name in given:
        if name not in known:
            raise ParameterError(f"{flow.name} has no parameter {name}; it has {', '.join(sorted(known))}")
    return flow(**given)


def _sweep(arguments, flow):
    """The swept parameter's name (or None) and the flows of the sweep."""
    if arguments.over is None:
        return None, [flow]
    name, _, spec = arguments.over.partition("=")
    name = name.replace("-", "_")
    known = [item.name for item in fields(flow) if "options" not in item.metadata]
    if name not in known:
        raise ParameterError(f"--over: {flow.name} has no parameter {name!r}{_nearest(name, known)}; it has {', '.join(known)}")
    from dataclasses import replace

    return name, [replace(flow, **{name: value}) for value in parse_spec(spec, f"--over {name}", False).tolist()]


def _options(arguments):
    tolerance = parse_spec(arguments.tolerance, "--tolerance")[0]
    if not 1e-15 <= tolerance <= 0.1:
        raise ParameterError(f"--tolerance: must lie in [1e-15, 0.1] (got {tolerance:g})")
    return {"tolerance": tolerance,
            "max_degree": _integer(arguments.max_degree, "--max-degree", DEGREES[0], DEGREES[-1])}


def _integer(text, name, low, high):
    value = int(text) if text.isdecimal() else None
    if value is None or not low <= value <= high:
        raise ParameterError(f"{name}: must be an integer from {low} to {high} (got {text!r})")
    return value


def _plot_file(arguments, stack):
    if not arguments.plot:
        return None
    if not arguments.plot.endswith(_PLOTS):
        raise ParameterError(f"--plot: the file must end in {', '.join(_PLOTS)} (got {arguments.plot!r})")
    return stack.enter_context(whole_file(arguments.plot, "--plot"))


def _nearest(name, known):
    match = get_close_matches(name, known, 1)
    return f" (did you mean {match[0]!r}?)" if match else ""
