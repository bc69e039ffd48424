"""How we compute: with one BLAS thread, and silent where numbers overflow.

On matrices of size 100 a second thread waits longer than it works. What has overflowed is not finite, and what is not
finite is never called resolved: no warning has to say so.
"""

from collections.abc import Callable
from functools import lru_cache, wraps
from typing import ParamSpec, TypeVar

import numpy as np
from threadpoolctl import ThreadpoolController

_Arguments = ParamSpec("_Arguments")
_Result = TypeVar("_Result")


def one_thread(function: Callable[_Arguments, _Result]) -> Callable[_Arguments, _Result]:
    """Run `function` with one BLAS thread and without floating-point warnings; the caller's settings are restored."""

    @wraps(function)
    def limited(*arguments: _Arguments.args, **options: _Arguments.kwargs) -> _Result:
        with _controller().limit(limits=1, user_api="blas"), np.errstate(all="ignore"):
            return function(*arguments, **options)

    return limited


@lru_cache(maxsize=1)
def _controller():
    return ThreadpoolController()
