"""How we compute: with one BLAS thread, and silent where numbers overflow.

On matrices of size 100 a second thread waits longer than it works. What has overflowed is not finite, and what is not
finite is never called resolved: no warning has to say so.
"""

from collections.abc import Callable
from functools import lru_cache, wraps
from threading import Lock
from typing import Any, ParamSpec, TypeVar

import numpy as np
import threadpoolctl

_Arguments = ParamSpec("_Arguments")
_Result = TypeVar("_Result")


def one_thread(function: Callable[_Arguments, _Result]) -> Callable[_Arguments, _Result]:
    """Run `function` with one BLAS thread and without floating-point warnings; the caller's settings are restored.

    The number of BLAS threads belongs to the whole process: it is restored once no thread is in such a function.
    """

    @wraps(function)
    def limited(*arguments: _Arguments.args, **options: _Arguments.kwargs) -> _Result:
        with _ONE, np.errstate(all="ignore"):
            return function(*arguments, **options)

    return limited


class _Shared:
    """One BLAS thread, set by the first that enters and lifted by the last that leaves, in whatever threads."""

    def __init__(self) -> None:
        self._lock, self._inside = Lock(), 0

    def __enter__(self) -> None:
        with self._lock:
            if not self._inside:
                self._limit = _unclaimed(lambda: _controller().limit(limits=1, user_api="blas"))
            self._inside += 1

    def __exit__(self, *failure: Any) -> None:
        with self._lock:
            self._inside -= 1
            if not self._inside:
                _unclaimed(self._limit.restore_original_limits)


_ONE = _Shared()


def _unclaimed(change: Callable[..., Any]) -> Any:
    """Make a change to the number of threads that any other thread may undo.

    Since version 3.8 of threadpoolctl the first thread that sets the number claims it; others do nothing, silently.
    """
    release = getattr(getattr(threadpoolctl, "OpenBLASController", None), "clear_controlling_thread", None)
    if release is None:
        return change()
    release(force=True)
    try:
        return change()
    finally:
        release(force=True)


@lru_cache(maxsize=1)
def _controller() -> Any:
    return threadpoolctl.ThreadpoolController()
