"""The names of the flows, known without loading them: a flow costs sympy."""

from pathlib import Path
from pkgutil import iter_modules


def names() -> list[str]:
    return sorted(module.name for module in iter_modules([str(Path(__file__).with_name("flows"))]))
