"""Standard streams of a program that was started with some of them closed, as by `>&-`, or loses them on the way."""

import os
import sys
from contextlib import suppress
from errno import EBADF
from typing import Any


class Closed:
    """Stands for standard output where that is closed: what is written fails, and so does the flush after it."""

    encoding = "utf-8"

    def __init__(self) -> None:
        self._written = False

    def write(self, text: Any) -> None:
        self._written = True
        self.flush()

    def flush(self) -> None:
        if self._written:
            raise OSError(EBADF, "it is closed")

    def isatty(self) -> Any:
        return False


def open_streams() -> None:
    """Put something in the place of streams that are closed; of their numbers no file of ours then gets one."""
    for stream in (sys.stdin, sys.stdout):
        if stream is None:
            os.open(os.devnull, os.O_RDWR)
    if sys.stdout is None:
        sys.stdout = Closed()
    if sys.stderr is None:
        sys.stderr = open(os.devnull, "w")  # noqa: SIM115 - to the end of the program


def output_closed() -> bool:
    """Whether nothing can be written to standard output."""
    return isinstance(sys.stdout, Closed)


def drop_output() -> None:
    """Forget what is still to be written to standard output: at the end of the program it would fail again."""
    if output_closed():
        sys.stdout = open(os.devnull, "w")  # noqa: SIM115
        return
    with suppress(OSError):  # a stream without a number, as in a notebook
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def say(line: str) -> None:
    """Print a line on standard error; where that fails, nobody reads it."""
    with suppress(OSError):
        print(line, file=sys.stderr, flush=True)
        return
    with suppress(OSError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stderr.fileno())


def terminal_width() -> int | None:
    """Columns of the terminal that standard output is, None where it is none."""
    if not sys.stdout.isatty():
        return None
    from shutil import get_terminal_size  # slow to import

    return get_terminal_size().columns


def put(text: str) -> None:
    """Write text to standard output, and notice now if nobody reads it."""
    sys.stdout.write(text)
    sys.stdout.flush()
