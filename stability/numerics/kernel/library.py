"""The compiled kernel, loaded if there is one: in a fraction of a millisecond, once in a process.

A process in which it was not found goes on without it to its end, so that the digits of an answer do not depend on when
it was asked for; where the extra `fast` is installed another one makes it meanwhile.
"""

import ctypes
import os
import sys
from functools import lru_cache
from pathlib import Path
from typing import Any

from .place import OFF, SWITCH, compiler_installed, kernel_found

_COUNT, _PLACE, _REAL = ctypes.c_long, ctypes.c_void_p, ctypes.c_double


class LinesInC(ctypes.Structure):
    """What kernel.c calls Lines."""

    _fields_ = [*((name, _COUNT) for name in ("interior", "border", "lower", "upper", "parts", "first_part", "lines",
                                              "first_line")),
                *((name, _PLACE) for name in ("part", "row", "start", "column", "re", "im"))]


_FUNCTIONS = {"iterate": (ctypes.c_int, _COUNT, _REAL, _REAL, *5 * (_PLACE,)),
              "brackets": (None, _COUNT, *6 * (_PLACE,)), "beyond": (None, _COUNT, _COUNT, *3 * (_PLACE,))}


@lru_cache(maxsize=1)
def library() -> Any:
    """The functions of kernel.c, or None; raises ParameterError where the environment variable says what it cannot."""
    if os.environ.get(SWITCH) == OFF:
        return None
    path = kernel_found()
    if path:
        return loaded(path)
    if sys.executable and compiler_installed():
        from .build import build_meanwhile  # and what that imports, only then

        build_meanwhile()
    return None


def loaded(path: Path) -> Any:
    """The functions of the kernel in a file, None where this machine cannot load it."""
    try:
        kernel = ctypes.CDLL(str(path))
    except OSError:
        return None
    for name, (result, *arguments) in _FUNCTIONS.items():
        for kind in ("real", "complex"):
            function = getattr(kernel, f"{name}_{kind}")
            function.restype, function.argtypes = result, [ctypes.POINTER(LinesInC), *arguments]
    return kernel
