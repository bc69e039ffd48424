"""Making the compiled kernel: once, by the compiler that the extra `fast` brings, or by a C compiler that there is.

It is written whole or not at all; how many processes want it at the same time does not matter.
"""

import os
import shlex
import shutil
import sys
from contextlib import suppress
from pathlib import Path
from subprocess import DEVNULL, Popen, TimeoutExpired, run
from tempfile import NamedTemporaryFile, TemporaryDirectory
from time import time

from ...errors import StabilityError
from .place import FLAGS, SOURCES, SWITCH, compiler_installed, kernel_folders, kernel_name

_PATIENCE = 600.0  # seconds after which somebody who is making it is not any more
_PACKAGES = Path(__file__).parents[3]  # where this package lies
_LONGEST = 300.0  # seconds that a compiler may take


class NoKernel(StabilityError):
    """The kernel could not be made."""


def build_kernel() -> Path:
    """Make the kernel in the first folder that can be written; return the file. Raises NoKernel where that fails."""
    for folder in kernel_folders():
        with suppress(OSError):
            folder.mkdir(parents=True, exist_ok=True)
            with NamedTemporaryFile(dir=folder, prefix="kernel-", delete=False) as whole:
                pass
            break
    else:
        raise NoKernel(f"none of its folders can be written ({', '.join(map(str, kernel_folders()))}): "
                       f"{SWITCH}=FOLDER names another")
    made = Path(whole.name)
    try:
        with TemporaryDirectory() as room:
            shutil.copyfile(_compiled(Path(room)), made)
        made.chmod(0o755)
        return made.replace(folder / kernel_name())
    except OSError as failure:
        raise NoKernel(f"{folder} cannot be written: {failure.strerror}") from None
    finally:
        made.unlink(missing_ok=True)
        _mark(folder).unlink(missing_ok=True)


def _compiled(room: Path) -> Path:
    target = room / kernel_name()
    command = [*_compiler(), *FLAGS, "-o", str(target), str(SOURCES[0]), "-lm"]
    caches = {name: str(room) for name in ("ZIG_GLOBAL_CACHE_DIR", "ZIG_LOCAL_CACHE_DIR")}  # many megabytes, used once
    try:
        done = run(command, capture_output=True, text=True, env=os.environ | caches, timeout=_LONGEST)
    except TimeoutExpired:
        raise NoKernel(f"{shlex.join(command)} took more than {_LONGEST:g} s") from None
    if done.returncode or not target.exists():
        raise NoKernel(f"{shlex.join(command)} failed: {(done.stderr.strip() or 'no output').splitlines()[0]}")
    return target


def _compiler() -> list[str]:
    if compiler_installed():
        return [sys.executable, "-P", "-m", "ziglang", "cc", "-mcpu=baseline"]
    named = shlex.split(os.environ.get("CC", "cc"))
    if named and shutil.which(named[0]):
        return named
    raise NoKernel("no compiler: pip install 'granular-stability[fast]' brings one; the one named by CC serves too")


def build_meanwhile() -> None:
    """Have it made by another process, for those to come, unless that was begun before: it is at work or has failed."""
    for folder in kernel_folders():
        with suppress(OSError):
            folder.mkdir(parents=True, exist_ok=True)
            if _claimed(_mark(folder)):
                command = [sys.executable, "-P", "-m", __package__, "--meanwhile"]  # not what is named so where we are
                path = os.pathsep.join(filter(None, (str(_PACKAGES), os.environ.get("PYTHONPATH"))))
                child = Popen(command, stdin=DEVNULL, stdout=DEVNULL, stderr=DEVNULL, start_new_session=True,
                              env=os.environ | {"PYTHONPATH": path})
                child.returncode = 0  # it may outlive us, and nobody is to be warned of that
            return


def built_meanwhile() -> None:
    """What that process does. A failure is kept beside where the kernel would be: it is not tried again and again."""
    with suppress(AttributeError, OSError):
        os.nice(10)
    try:
        build_kernel()
    except NoKernel as failure:
        for folder in kernel_folders():
            with suppress(OSError):
                _mark(folder).write_text(f"{failure}\n")
                return


def _mark(folder: Path) -> Path:
    """The file that says that the kernel is being made there, or why that failed."""
    return folder / f"{kernel_name()}.wanted"


def _claimed(mark: Path) -> bool:
    """Whether we are the first to want it, or those who did have ended without a word."""
    with suppress(FileExistsError):
        mark.touch(exist_ok=False)
        return True
    state = mark.stat()
    if state.st_size or time() - state.st_mtime < _PATIENCE:
        return False
    mark.touch()
    return True
