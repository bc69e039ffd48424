"""The command `stability`: one verb per question, data on stdout, one clear line on stderr when it fails.

Exit status: 0 done and resolved; 2 bad usage or input; 3 computed, but unresolved or lost; 130 interrupted.
"""

import argparse
import sys
from importlib import import_module

from . import __version__
from .errors import ParameterError, StabilityError
from .flows.sources import faults
from .streams import drop_output, open_streams, say


def main(argv=None):
    """Run the command line; return the exit status."""
    open_streams()
    try:
        with faults():
            return _run(sys.argv[1:] if argv is None else [str(word) for word in argv])
    except ParameterError as reason:
        return _fail(reason, 2)
    except StabilityError as reason:
        return _fail(reason, 3)
    except BrokenPipeError:
        drop_output()
        return 141
    except OSError as reason:  # output files report their own; this is the stream
        drop_output()
        return _fail(f"cannot write to standard output: {reason.strerror}", 2)
    except KeyboardInterrupt:
        return _fail("interrupted", 130)


def _run(words):
    arguments, unknown = _parser(words).parse_known_args(words)
    if unknown:
        from .verbs.common import nearest_flag

        kind = "option" if unknown[0].startswith("-") else "argument"
        raise ParameterError(f"unknown {kind} {unknown[0]!r}{nearest_flag(arguments, unknown[0])}; "
                             "see --help, and for parameters: stability flows FLOW")
    return arguments.run(arguments)


def _fail(reason, status):
    say(f"stability: {reason}")
    return status


class _Parser(argparse.ArgumentParser):
    """Errors as exceptions; no value is given twice; examples in one line, to be copied."""

    def __init__(self, **options):
        from .verbs.common import Once

        super().__init__(formatter_class=argparse.RawDescriptionHelpFormatter, allow_abbrev=False, **options)
        for action in (None, "store"):
            self.register("action", action, Once)
        self.set_defaults(given=frozenset())

    def error(self, message):
        raise ParameterError(f"{message} (see: {self.prog} --help)")

    def exit(self, status=0, message=None):
        sys.stdout.flush()  # of the help: where nobody reads it, say so in `main`
        super().exit(status, message)


def _parser(words):
    """The parser of the verb that is named, with the parameters of the flow that is named; of other verbs the name."""
    from .verbs import VERBS

    parser = _Parser(prog="stability", description="Linear stability of granular and viscous shear flows.",
                     epilog="example: stability dispersion dune --shields 2 --k 1e-2:10:50")
    parser.add_argument("--version", action="version", version=f"stability {__version__}")
    verbs = parser.add_subparsers(metavar="VERB", required=True, parser_class=_Parser)
    named = next((word for word in words if not word.startswith("-")), None)
    for verb, summary in VERBS.items():
        if verb == named:
            import_module(f".verbs.{verb}", __package__).add(verbs)
            verbs.choices[verb].get_default("complete")(verbs.choices[verb], words[words.index(verb) + 1:])
        else:
            verbs.add_parser(verb, help=summary, add_help=False)
    return parser
