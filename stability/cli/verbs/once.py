"""Options that are given once. No numerics here: the parser needs this before anything is asked."""

import argparse
from typing import Any

from ...errors import ParameterError

NUMBER = "V"  # metavar of a numeric parameter of a flow

_JOIN = "join values with commas"
_REMEDIES = {"SPEC": _JOIN, "NAME=SPEC": f"{_JOIN}, and sweep several parameters with: stability map"}  # by metavar


class Once(argparse.Action):
    """Store a value, and in `given` that it was given: twice is refused, or the first value would get lost."""

    def __call__(self, parser: Any, namespace: Any, values: Any, option_string: Any = None) -> None:
        if self.dest in namespace.given:
            raise ParameterError(f"{option_string}: given twice, with {getattr(namespace, self.dest)!r} and "
                                 f"{values!r}; {self._remedy(parser, getattr(namespace, self.dest), values)}")
        setattr(namespace, self.dest, values)
        namespace.given |= {self.dest}

    def _remedy(self, parser: Any, *values: Any) -> Any:
        if self.metavar == NUMBER:
            known = [option for option in ("--over", "--each") if option in parser._option_string_actions]
            sweep = known[0] if known else "stability map --over"
            return f"sweep it with: {sweep} {self.dest.partition(' ')[2]}={','.join(values)}"
        return _REMEDIES.get(str(self.metavar), "give it once")
