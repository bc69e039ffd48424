"""Worker processes of our own: they leave Ctrl-C to the parent, and end with it however it ends.

A fresh process imports everything anew. One that is forked from this one has it all at once, but only a process of a
single thread can be forked safely: that of the command, which begins `without_threads`, is one.
"""

import gc
import os
import signal
import sys
import threading
from collections.abc import Iterator
from concurrent.futures import BrokenExecutor, ProcessPoolExecutor
from contextlib import contextmanager, suppress
from multiprocessing import get_context
from typing import Any

from threadpoolctl import threadpool_limits

from ..errors import ParameterError, WorkersLost

_THREADS = "OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"
GUARD = 'a script needs `if __name__ == "__main__":` around what it does, and cannot come from standard input'


def cores() -> int:
    """How many cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def without_threads() -> None:
    """Have BLAS start no threads when it is imported: it is not to use any, and they forbid to fork."""
    if "numpy" not in sys.modules:
        for name in _THREADS:
            os.environ[name] = "1"


def _alone() -> bool:
    """Whether this process has a single thread, those of libraries counted, as far as the system tells."""
    try:
        return len(os.listdir("/proc/self/task")) == 1
    except OSError:
        return False


@contextmanager
def processes(workers: int, may_fork: bool) -> Iterator[Any]:
    """Yield a pool of `workers` processes; whatever they still do at the end of the block is dropped.

    They are fresh ones unless this process `may_fork` and can.
    Each holds one end of a pipe whose other end is ours alone. When that closes, because the block ends or because
    this process was killed, they end at once. Raises WorkersLost at the end of a block in which none of them began.
    """
    forked = may_fork and _alone()
    if not forked and getattr(sys.modules["__main__"], "__file__", None) == "<stdin>":
        raise ParameterError(f"workers: each process runs the script anew: {GUARD}")
    if forked:
        gc.freeze()  # what the processes share is not to be copied because it was looked through
    context = get_context("fork" if forked else "spawn")
    theirs, ours = context.Pipe(duplex=False)
    pool, first = ProcessPoolExecutor(workers, context, _begin, (theirs, ours if forked else None)), []
    try:
        with _deaf(), suppress(BrokenExecutor):
            for _ in range(workers):
                first.append(pool.submit(_nothing))  # starts a process
        yield pool
    finally:
        ours.close()
        pool.shutdown()
        theirs.close()
    if all(task.exception() for task in first):
        raise WorkersLost(f"no worker process began: {GUARD}")


@contextmanager
def _deaf() -> Iterator[Any]:
    """Block Ctrl-C here and, inherited, for good in the processes started meanwhile: they must not print tracebacks."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _begin(lifeline: Any, other_end: Any) -> None:
    if other_end is not None:
        other_end.close()  # a copy, which would keep the pipe open when that of the parent is gone
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with, args=(lifeline,), daemon=True).start()
    threadpool_limits(1, user_api="blas")


def _end_with(lifeline: Any) -> None:
    """Wait until the other end of the pipe is gone; nothing is ever sent."""
    try:
        lifeline.recv_bytes()
    except (EOFError, OSError):
        os._exit(0)


def _nothing() -> None:
    pass
