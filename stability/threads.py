"""How we compute: with one BLAS thread, and silent where numbers overflow.

On matrices of size 100 a second thread waits longer than it works. What has overflowed is not finite, and what is not
finite is never called resolved: no warning has to say so.
"""

from functools import lru_cache, wraps

import numpy as np
from threadpoolctl import ThreadpoolController


def one_thread(function):
    """Run `function` with one BLAS thread and without floating-point warnings; the caller's settings are restored."""

    @wraps(function)
    def limited(*arguments, **options):
        with _controller().limit(limits=1, user_api="blas"), np.errstate(all="ignore"):
            return function(*arguments, **options)

    return limited


@lru_cache(maxsize=1)
def _controller():
    return ThreadpoolController()
