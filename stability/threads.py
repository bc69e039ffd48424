"""One BLAS thread while we compute: on matrices of size 100 a second thread waits longer than it works."""

from functools import lru_cache, wraps

from threadpoolctl import ThreadpoolController


def one_thread(function):
    """Run `function` with BLAS limited to one thread; the caller's setting is restored afterwards."""

    @wraps(function)
    def limited(*arguments, **options):
        with _controller().limit(limits=1, user_api="blas"):
            return function(*arguments, **options)

    return limited


@lru_cache(maxsize=1)
def _controller():
    return ThreadpoolController()
