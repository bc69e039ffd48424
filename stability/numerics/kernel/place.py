"""Where the compiled kernel is kept, and what it is made of."""

import os
import platform
import sys
from functools import lru_cache
from hashlib import blake2b
from importlib.util import find_spec
from pathlib import Path

from ...errors import ParameterError

SWITCH = "STABILITY_KERNEL"  # environment variable: off, or the folder where the kernel is kept
OFF = "off"
SOURCES = tuple(Path(__file__).parent / name for name in ("kernel.c", "sides.h", "factors.h", "numbers.h"))
FLAGS = "-O3", "-ffp-contract=off", "-shared", "-fPIC"  # and no more: the same digits on every machine


def kernel_folders() -> list[Path]:
    """Where the kernel may be kept: beside its source if that can be written, else where the user's caches are."""
    given = os.environ.get(SWITCH)
    if given:
        if not os.path.isabs(given):
            raise ParameterError(f"{SWITCH} must be {OFF} or an absolute path, that of the folder where the compiled "
                                 f"kernel is kept (got {given!r})")
        return [Path(given)]
    base = os.environ.get("LOCALAPPDATA" if os.name == "nt" else "XDG_CACHE_HOME")
    caches = Path(base) if base else Path.home() / ".cache"
    return [Path(__file__).parent / "__pycache__", caches / "granular-stability"]


@lru_cache(maxsize=1)
def kernel_name() -> str:
    """The name of the file tells all that it is made of: another version has another."""
    source = b"".join(path.read_bytes() for path in SOURCES)
    digest = blake2b(source + repr((FLAGS, sys.platform, platform.machine())).encode(), digest_size=8)
    return f"kernel-{digest.hexdigest()}.{'dll' if os.name == 'nt' else 'so'}"


def kernel_found() -> Path | None:
    """The kernel of this version, where there is one."""
    return next((path for folder in kernel_folders() if (path := folder / kernel_name()).exists()), None)


def compiler_installed() -> bool:
    """Whether the compiler of the extra `fast` is."""
    return find_spec("ziglang") is not None
