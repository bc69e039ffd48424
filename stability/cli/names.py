"""What flows and parameters are called on the command line."""

from ..flows import FLOWS

FLOW = f"one of {', '.join(FLOWS)}, or your own: path/to/file.py:Class or package.module:Class"


def flag_of(name: str) -> str:
    """Command-line flag of a parameter."""
    return "--" + name.replace("_", "-")
