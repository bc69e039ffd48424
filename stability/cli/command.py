"""The command `stability`: one verb per question, data on stdout, one clear line on stderr when it fails.

Exit status: 0 done and resolved; 2 bad usage or input; 3 computed, but unresolved or lost; 130 interrupted.
"""

import argparse
import sys
from importlib import import_module
from typing import Any, NoReturn

from .. import __version__
from ..errors import ParameterError, StabilityError
from ..flows.sources import faults
from .streams import drop_output, open_streams, say


def main(argv: list[str] | None = None) -> int | None:
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


def _run(words: list[str]) -> int:
    parser = parser_of(words)
    try:
        arguments, unknown = parser.parse_known_args(words)
    except ParameterError:
        for option in _strange(parser, words):  # what is missing may be what is misspelt
            hint = _near(parser, words, option)
            if hint:
                raise _unknown(option, hint) from None
        raise
    if unknown:
        from .asked import nearest_flag

        raise _unknown(unknown[0], _near(parser, words, unknown[0]) or nearest_flag(arguments, unknown[0]))
    return arguments.run(arguments)


def _unknown(text: str, hint: str) -> ParameterError:
    kind = "option" if text.startswith("-") else "argument"
    return ParameterError(f"unknown {kind} {text!r}{hint}; see --help, and for parameters: stability flows FLOW")


def _near(parser: "_Parser", words: list[str], option: str) -> str:
    """A hint at the option of the verb that is meant, if one is near."""
    from .asked import nearest_option

    return nearest_option(option, _options(parser, words))


def _options(parser: "_Parser", words: list[str]) -> list[str]:
    """The options of the verb that is asked for."""
    verbs = next(action.choices for action in parser._actions if isinstance(action, argparse._SubParsersAction))
    return list(verbs[words[0]]._option_string_actions) if words and words[0] in verbs else []


def _strange(parser: Any, words: Any) -> Any:
    """Options that the verb has not."""
    known = _options(parser, words)
    return [text for text in words[1:] if known and text.startswith("--") and len(text) > 2
            and text.partition("=")[0] not in known]


def _fail(reason: Any, status: Any) -> Any:
    say(f"stability: {reason}")
    return status


class _Parser(argparse.ArgumentParser):
    """Errors as exceptions; no value is given twice; examples in one line, to be copied."""

    def __init__(self, **options: Any) -> None:
        from .verbs.once import Once

        super().__init__(formatter_class=argparse.RawDescriptionHelpFormatter, allow_abbrev=False, **options)
        for action in (None, "store"):
            self.register("action", action, Once)
        self.set_defaults(given=frozenset())

    def _check_value(self, action: Any, value: str) -> None:
        if isinstance(action, argparse._SubParsersAction) and value not in action.choices:
            from ..flows.catalogue import nearest

            raise ParameterError(f"unknown verb {value!r}{nearest(value, action.choices)}; verbs: "
                                 f"{', '.join(action.choices)}")
        super()._check_value(action, value)

    def error(self, message: str) -> NoReturn:
        raise ParameterError(f"{message} (see: {self.prog} --help)")

    def exit(self, status: int = 0, message: str | None = None) -> NoReturn:
        sys.stdout.flush()  # of the help: where nobody reads it, say so in `main`
        super().exit(status, message)


def parser_of(words: list[str]) -> "_Parser":
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
