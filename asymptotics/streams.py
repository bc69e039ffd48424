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


def drop_output() -> None:
    """Forget what is still to be written to standard output: at the end of the program it would fail again."""
    if isinstance(sys.stdout, Closed):
        sys.stdout = open(os.devnull, "w")  # noqa: SIM115
        return
    with suppress(OSError):  # a stream without a number, as in a notebook
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def say(line: Any) -> None:
    """Print a line on standard error; where that fails, nobody reads it."""
    with suppress(OSError):
        print(line, file=sys.stderr, flush=True)
        return
    with suppress(OSError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stderr.fileno())
